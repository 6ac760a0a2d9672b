!> Unit test of library: the verbs on one cube with a known answer: the force on TOP is 1000 times its displacement.
!! SPDX-License-Identifier: GPL-3.0-or-later
module letter_counter
  use amontons_library, only: log_sink_type
  implicit none
  private
  public :: memory_type

  !> Counts the letters that a job says.
  type, extends(log_sink_type) :: memory_type
    integer, pointer :: n_letters => null()
  contains
    procedure :: write_lines
  end type memory_type

contains

  subroutine write_lines(self, text)
    class(memory_type), intent(inout) :: self
    character(*), intent(in) :: text
    self%n_letters = self%n_letters + len(text)
  end subroutine write_lines

end module letter_counter

program test_library
  use check, only: suite_type
  use samples, only: deck_lines
  use letter_counter, only: memory_type
  use amontons_kinds, only: DP
  use amontons_text, only: NEWLINE
  use amontons_errors, only: EXIT_USAGE, EXIT_DECK
  use amontons_library, only: job_type, job_options_type, error_type, sparse_type, open_job, advance_job, &
    advance_job_to, try_job, begin_job, iterate_job, commit_job, rollback_job, finish_job, close_job, is_job_done, get_values, &
    set_values, get_names, get_matrix, VERDICT_CONTINUE, VERDICT_CONVERGED
  implicit none
  real(DP), parameter :: TOL = 1.0e-9_DP

  type(suite_type) :: suite

  call check_open()
  call check_advance()
  call check_advance_to()
  call check_try()
  call check_iterations()
  call check_set()
  call check_matrix()
  call suite%finish()

contains

  include 'sample_cube.inc'

  !> Opens the cube.
  subroutine open_cube(job)
    type(job_type), intent(inout) :: job
    type(job_options_type) :: options
    type(error_type), allocatable :: error
    options%deck_text = cube_deck()
    options%has_files = .false.
    options%n_threads = 1
    call open_job(job, options, error)
    call suite%that('the cube is opened', .not. allocated(error))
  end subroutine open_cube


  !> The error is one of use whose message contains a piece.
  subroutine expect_refusal(name, error, piece)
    character(*), intent(in) :: name, piece
    type(error_type), allocatable, intent(in) :: error
    call suite%that(name // ' is refused', allocated(error))
    if (.not. allocated(error)) return
    call suite%that(name // ': ' // error%message, error%code == EXIT_USAGE .and. index(error%message, piece) > 0)
  end subroutine expect_refusal


  !> A number, or the sum over a set.
  real(DP) function value_of(job, quantity, set)
    type(job_type), intent(in) :: job
    character(*), intent(in) :: quantity
    character(*), intent(in), optional :: set
    real(DP), allocatable :: values(:, :)
    type(error_type), allocatable :: error
    value_of = -huge(1.0_DP)
    if (present(set)) then
      call get_values(job, quantity, set, values, error)
    else
      call get_values(job, quantity, '', values, error)
    end if
    if (.not. allocated(error)) value_of = sum(values(size(values, 1), :))
  end function value_of


  !> Time, displacement of TOP and the force on it.
  subroutine expect_place(name, job, time, displacement)
    character(*), intent(in) :: name
    type(job_type), intent(in) :: job
    real(DP), intent(in) :: time, displacement
    call suite%near(name // ': time', value_of(job, 'TIME'), time, TOL)
    call suite%near(name // ': displacement', value_of(job, 'U', '7'), displacement, TOL)
    call suite%near(name // ': force', value_of(job, 'RF', 'TOP'), 1000 * displacement, 1.0e-6_DP)
  end subroutine expect_place


  !> Without a deck; with a faulty one; with a log_sink; a check only.
  subroutine check_open()
    type(job_type) :: faulty, checked, unopened
    type(job_options_type) :: options
    type(error_type), allocatable :: error
    type(memory_type) :: log_sink
    real(DP), allocatable :: values(:, :)
    character(:), allocatable :: names(:)
    allocate (log_sink%n_letters, source=0)
    call open_job(unopened, options, error)
    call expect_refusal('no deck', error, 'needs a deck')
    call get_values(unopened, 'TIME', '', values, error)
    call expect_refusal('a value of no job', error, 'has not begun')
    call get_names(unopened, 'QUANTITIES', names, error)
    call expect_refusal('names of no job', error, 'has not begun')
    call set_values(unopened, 'U3', 'TOP', [1.0_DP], error)
    call expect_refusal('setting without a job', error, 'has not begun')
    options%has_files = .false.
    options%deck_text = '*NODE' // NEWLINE // '1,0,x,0' // NEWLINE // '*NOTACARD' // NEWLINE
    call open_job(faulty, options, error, log_sink)
    call suite%that('a faulty deck', allocated(error))
    if (allocated(error)) then
      call suite%that('its code and lines', error%code == EXIT_DECK .and. index(error%message, ':2: ') > 0 .and. &
        index(error%message, ':3: ') > 0)
    end if
    call suite%that('the log_sink hears of it', log_sink%n_letters > 50)
    call suite%that('a job that failed is done', is_job_done(faulty))
    options%deck_text = cube_deck()
    options%is_check = .true.
    call open_job(checked, options, error)
    call suite%that('a checked job cannot be solved', .not. allocated(error) .and. is_job_done(checked))
    call advance_job(checked, error)
    call expect_refusal('advancing a checked job', error, 'has not begun')
  end subroutine check_open


  !> Increments of the deck, to its end.
  subroutine check_advance()
    type(job_type) :: job
    type(error_type), allocatable :: error
    integer :: n
    call open_cube(job)
    call advance_job(job, error)
    call expect_place('first increment', job, 0.25_DP, 0.0025_DP)
    n = 1
    do while (.not. is_job_done(job) .and. n < 20)
      call advance_job(job, error)
      n = n + 1
    end do
    call suite%that('six increments', n == 6)
    call expect_place('end', job, 3.0_DP, 0.03_DP)
    call advance_job(job, error)
    call expect_refusal('an increment after the end', error, 'All steps')
    call commit_job(job, error)
    call suite%that('a commit without an increment is nothing', .not. allocated(error))
    call finish_job(job, error)
    call expect_place('values of a finished job', job, 3.0_DP, 0.03_DP)
    call commit_job(job, error)
    call expect_refusal('a commit of a finished job', error, 'finished')
    call close_job(job, error)
    call suite%that('closed', .not. allocated(error))
  end subroutine check_advance


  !> To a time: the last increment ends there, steps end before, and a time that is past is nothing.
  subroutine check_advance_to()
    type(job_type) :: job
    type(error_type), allocatable :: error
    call open_cube(job)
    call advance_job_to(job, 0.6_DP, error)
    call expect_place('to 0.6', job, 0.6_DP, 0.006_DP)
    call suite%near('in three increments', value_of(job, 'INCREMENTS'), 3.0_DP, 0.0_DP)
    call advance_job_to(job, 0.3_DP, error)
    call expect_place('to the past', job, 0.6_DP, 0.006_DP)
    call advance_job_to(job, 1.5_DP, error)
    call expect_place('into step 2', job, 1.5_DP, 0.015_DP)
    call suite%near('step 2', value_of(job, 'STEP'), 2.0_DP, 0.0_DP)
    call suite%near('the rest of step 2', value_of(job, 'TIME LEFT'), 1.5_DP, TOL)
    call advance_job_to(job, ieee_nan(), error)
    call expect_refusal('to no number', error, 'finite')
    call advance_job_to(job, 100.0_DP, error)
    call suite%that('beyond the end: done', is_job_done(job) .and. .not. allocated(error))
    call expect_place('beyond the end', job, 3.0_DP, 0.03_DP)
  end subroutine check_advance_to


  !> Not a number.
  real(DP) function ieee_nan()
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    ieee_nan = ieee_value(1.0_DP, ieee_quiet_nan)
  end function ieee_nan


  !> Tries: seen, dropped, kept; cut off at the end of the step.
  subroutine check_try()
    type(job_type) :: job
    type(error_type), allocatable :: error
    call open_cube(job)
    call try_job(job, 0.0_DP, error)
    call expect_refusal('no time', error, 'positive')
    call try_job(job, 0.4_DP, error)
    call expect_place('tried', job, 0.4_DP, 0.004_DP)
    call rollback_job(job, error)
    call expect_place('dropped', job, 0.0_DP, 0.0_DP)
    call try_job(job, 0.3_DP, error)
    call try_job(job, 0.3_DP, error)
    call expect_place('tried twice', job, 0.6_DP, 0.006_DP)
    call commit_job(job, error)
    call rollback_job(job, error)
    call expect_place('kept', job, 0.6_DP, 0.006_DP)
    call try_job(job, 5.0_DP, error)
    call expect_place('cut off at the end of the step', job, 1.0_DP, 0.01_DP)
    call rollback_job(job, error)
    call expect_place('dropped again', job, 0.6_DP, 0.006_DP)
  end subroutine check_try


  !> Iteration by iteration; what must not be done between.
  subroutine check_iterations()
    type(job_type) :: job
    type(error_type), allocatable :: error
    integer :: verdict, n
    call open_cube(job)
    call iterate_job(job, verdict, error)
    call expect_refusal('an iteration without an increment', error, 'begin one')
    call begin_job(job, 0.5_DP, error)
    call suite%that('begun', .not. allocated(error))
    call advance_job(job, error)
    call expect_refusal('an increment within another', error, 'being iterated')
    call commit_job(job, error)
    call expect_refusal('a commit before convergence', error, 'cannot be committed')
    n = 0
    verdict = VERDICT_CONTINUE
    do while (verdict == VERDICT_CONTINUE .and. n < 10)
      call iterate_job(job, verdict, error)
      n = n + 1
    end do
    call suite%that('converged', verdict == VERDICT_CONVERGED)
    call expect_place('iterated', job, 0.5_DP, 0.005_DP)
    call commit_job(job, error)
    call suite%that('committed', .not. allocated(error))
    call begin_job(job, 0.2_DP, error)
    call iterate_job(job, verdict, error)
    call rollback_job(job, error)
    call expect_place('rolled back', job, 0.5_DP, 0.005_DP)
    call advance_job(job, error)
    call suite%that('a rollback ends the iteration', .not. allocated(error))
    call begin_job(job, 7.0_DP, error)
    verdict = VERDICT_CONTINUE
    n = 0
    do while (verdict == VERDICT_CONTINUE .and. n < 10)
      call iterate_job(job, verdict, error)
      n = n + 1
    end do
    call expect_place('begun beyond the end of the step', job, 1.0_DP, 0.01_DP)
  end subroutine check_iterations


  !> A value that is set is reached at the end of the increment, and remains after a rollback.
  subroutine check_set()
    type(job_type) :: job
    type(error_type), allocatable :: error
    real(DP), allocatable :: values(:, :)
    call open_cube(job)
    call set_values(job, 'NONSENSE', 'TOP', [1.0_DP], error)
    call suite%that('an unknown quantity', allocated(error))
    call advance_job(job, error)
    call set_values(job, 'U3', 'TOP', [-0.002_DP], error)
    call suite%that('set', .not. allocated(error))
    call try_job(job, 0.25_DP, error)
    call expect_place('reached', job, 0.5_DP, -0.002_DP)
    call rollback_job(job, error)
    call expect_place('rolled back', job, 0.25_DP, 0.0025_DP)
    call try_job(job, 0.5_DP, error)
    call expect_place('still set', job, 0.75_DP, -0.002_DP)
    call commit_job(job, error)
    call advance_job(job, error)
    call expect_place('held', job, 1.0_DP, -0.002_DP)
    call get_values(job, 'NONSENSE', '', values, error)
    call expect_refusal('an unknown value', error, 'NONSENSE')
  end subroutine check_set


  !> The cube at u3 = U on top: 8 free unknowns (x of 4 nodes, y of 4); all 24 with MAP and STIFFNESS.
  subroutine check_matrix()
    type(job_type) :: job
    type(error_type), allocatable :: error
    type(sparse_type) :: matrix
    real(DP), allocatable :: residual(:)
    real(DP) :: before
    call open_cube(job)
    call get_matrix(job, 'TANGENT', matrix, residual, error)
    call expect_refusal('a matrix before the first increment', error, 'no matrix yet')
    call try_job(job, 0.5_DP, error)
    before = value_of(job, 'U', 'ALL')
    call get_matrix(job, 'NONSENSE', matrix, residual, error)
    call expect_refusal('an unknown matrix', error, 'NONSENSE')
    call get_matrix(job, 'TANGENT', matrix, residual, error)
    call suite%that('tangent: 8 x 8', matrix%n_rows == 8 .and. matrix%n_columns == 8 .and. size(residual) == 8)
    call suite%near('no residual', maxval(abs(residual)), 0.0_DP, TOL)
    call get_matrix(job, 'MAP', matrix, residual, error)
    call suite%that('map: 24 x 8', matrix%n_rows == 24 .and. matrix%n_columns == 8)
    call suite%near('its entries are ones', sum(matrix%value), 8.0_DP, TOL)
    call get_matrix(job, 'STIFFNESS', matrix, residual, error)
    call suite%that('stiffness: 24 x 24', matrix%n_rows == 24 .and. matrix%n_columns == 24)
    call suite%near('its row of z at node 7 times a stretch', stretched_row(matrix, 21), 250.0_DP, 1.0e-6_DP)
    call suite%near('the job is unchanged', value_of(job, 'U', 'ALL'), before, 0.0_DP)
  end subroutine check_matrix


  !> Force in a row for u3 = z: 1000 / 4 on each node of the top.
  pure real(DP) function stretched_row(matrix, row) result(force)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: row
    integer :: k
    force = 0
    do k = int(matrix%first(row)), int(matrix%first(row + 1)) - 1
      if (any(matrix%column(k) == [15, 18, 21, 24])) force = force + matrix%value(k)
    end do
  end function stretched_row

end program test_library
