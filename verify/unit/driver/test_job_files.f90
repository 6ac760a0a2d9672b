!> Unit test of job_files: files of the cube appear with their data, the checkpoint restores a job, and goes at its end.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_job_files
  use check, only: suite_type
  use samples, only: deck_lines
  use amontons_analysis, only: analysis_type, start_analysis, advance_analysis, solve_increment, finish_analysis
  use amontons_errors, only: error_type
  use amontons_job_files, only: describe_result_files, is_at_end
  use amontons_kinds, only: DP
  use amontons_logger, only: logger_type
  use amontons_model, only: job_options_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-9_DP
  character(*), parameter :: JOB = 'test_job_files_cube'
  character(6), parameter :: ENDINGS(*) = [character(6) :: 'vtkhdf', 'sta', 'cvg', 'res', 'dat', 'frd']
  type(suite_type) :: suite
  type(logger_type) :: logger                          ! never opened: quiet

  call remove_files()
  call check_files()
  call check_resumed()
  call check_refusals()
  call remove_files()
  call suite%finish()

contains

  include 'sample_cube.inc'

  !> Starts the cube with files in the current folder, with *RESTART, WRITE or without.
  subroutine start(analysis, error, is_resumed, has_states, outdir)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    logical, intent(in) :: is_resumed, has_states
    character(*), intent(in), optional :: outdir
    character(*), parameter :: CARD = '*RESTART, WRITE'
    type(job_options_type) :: options
    character(:), allocatable :: deck
    integer :: at
    deck = cube_deck()
    at = index(deck, CARD)
    if (.not. has_states) deck = deck(:at - 1) // '** no states' // deck(at + len(CARD):)
    options%deck_text = deck
    options%has_files = .true.
    options%is_guarded = .true.
    options%is_resumed = is_resumed
    options%n_threads = 1
    options%job = JOB
    options%outdir = '.'
    if (present(outdir)) options%outdir = outdir
    call start_analysis(analysis, options, logger, error)
  end subroutine start


  !> Whether a file of the job exists.
  logical function has_file(ending)
    character(*), intent(in) :: ending
    inquire (file=JOB // '.' // ending, exist=has_file)
  end function has_file


  !> Lines of .sta that hold numbers only.
  integer function n_rows()
    character(200) :: line
    integer :: unit, status
    n_rows = 0
    open (newunit=unit, file=JOB // '.sta', status='old', action='read', iostat=status)
    do while (status == 0)
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (verify(trim(adjustl(line)), '0123456789.+-eE UAS') > 0 .or. len_trim(line) == 0) cycle
      n_rows = n_rows + 1
    end do
    close (unit)
  end function n_rows


  !> Removes what the test leaves.
  subroutine remove_files()
    integer :: i, unit, status
    character(7), parameter :: ALL_ENDINGS(*) = [character(7) :: ENDINGS, 'restart']
    do i = 1, size(ALL_ENDINGS)
      open (newunit=unit, file=JOB // '.' // trim(ALL_ENDINGS(i)), status='old', iostat=status)
      if (status == 0) close (unit, status='delete')
    end do
  end subroutine remove_files


  !> All files from the start, one row of .sta for each commit, none before; no checkpoint after the end.
  subroutine check_files()
    type(analysis_type) :: analysis
    type(error_type), allocatable :: error
    character(:), allocatable :: text
    logical :: is_done
    integer :: i, states
    call start(analysis, error, .false., .true.)
    call suite%that('files are open', .not. allocated(error) .and. analysis%has_files)
    do i = 1, 4
      call suite%that('it exists: ' // ENDINGS(i), has_file(trim(ENDINGS(i))))
    end do
    call suite%that('a checkpoint before the first increment', has_file('restart'))
    call suite%that('no .frd was requested', .not. has_file('frd'))
    text = describe_result_files(analysis)
    call suite%that('the description', index(text, JOB // '.vtkhdf') > 0 .and. index(text, JOB // '.res') > 0 .and. &
      index(text, '.frd') == 0 .and. index(text, '.dat') == 0)
    call advance_analysis(analysis, logger, is_done, error)
    states = int(analysis%restart_file%end)
    call suite%that('a state is kept', states > 0 .and. analysis%restart_file%last > 0)
    call advance_analysis(analysis, logger, is_done, error)
    call suite%that('and the next', int(analysis%restart_file%end) > states)
    i = 2
    do while (.not. is_at_end(analysis) .and. i < 20)
      call advance_analysis(analysis, logger, is_done, error)
      i = i + 1
    end do
    call suite%that('six increments', i == 6 .and. .not. allocated(error))
    call suite%that('the checkpoint is there until the end', has_file('restart'))
    call finish_analysis(analysis, logger, error)
    call suite%that('and kept with *RESTART, WRITE', has_file('restart'))
    call suite%that('the results are not', has_file('vtkhdf'))
    call suite%that('six rows of .sta', n_rows() == 6)
  end subroutine check_files


  !> A job left after three commits and a try continues after the third commit.
  subroutine check_resumed()
    type(analysis_type) :: analysis, resumed
    type(error_type), allocatable :: error
    logical :: is_done
    integer :: i
    call start(analysis, error, .false., .false.)
    do i = 1, 3
      call advance_analysis(analysis, logger, is_done, error)
    end do
    analysis%is_trial = .true.
    call solve_increment(analysis, logger, huge(1.0_DP), error)
    call finish_analysis(analysis, logger, error)
    call suite%that('a job that is not at its end keeps its checkpoint', has_file('restart'))
    call suite%that('without an error', .not. allocated(error))
    call start(resumed, error, .true., .false.)
    call suite%that('resumed', .not. allocated(error))
    if (allocated(error)) return
    call suite%near('after the third commit', resumed%stepping%total_time, 0.75_DP, TOL)
    call suite%near('its displacement', resumed%state%old%u(3, 7), 0.0075_DP, TOL)
    call suite%that('its files are those of that commit', n_rows() == 3)
    do i = 1, 3
      call advance_analysis(resumed, logger, is_done, error)
    end do
    call suite%that('at its end', is_at_end(resumed) .and. .not. allocated(error))
    call finish_analysis(resumed, logger, error)
    call suite%that('six rows again', n_rows() == 6)
    call suite%that('and no checkpoint', .not. has_file('restart'))
  end subroutine check_resumed


  !> A folder that is not there, a checkpoint that is not there.
  subroutine check_refusals()
    type(analysis_type) :: nowhere, never
    type(error_type), allocatable :: error
    call start(nowhere, error, .false., .true., '/nonexistent/folder')
    call suite%that('no folder', allocated(error) .and. .not. nowhere%is_open)
    call start(never, error, .true., .true.)
    call suite%that('no checkpoint', allocated(error) .and. .not. never%is_open)
  end subroutine check_refusals

end program test_job_files
