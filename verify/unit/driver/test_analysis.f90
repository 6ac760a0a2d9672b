!> Unit test of analysis: steps, commits and rollbacks of the cube; records and works; errors that leave the last commit.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_analysis
  use check, only: suite_type
  use samples, only: deck_lines
  use amontons_analysis, only: analysis_type, start_analysis, advance_analysis, solve_increment, begin_trial, iterate_trial, &
    commit_analysis, rollback_analysis, finish_analysis, is_at_end
  use amontons_convergence, only: VERDICT_CONTINUE, VERDICT_CONVERGED
  use amontons_errors, only: error_type, EXIT_DECK, EXIT_NOT_CONVERGED
  use amontons_kinds, only: DP
  use amontons_logger, only: logger_type
  use amontons_model, only: job_options_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-9_DP
  type(suite_type) :: suite
  type(logger_type) :: logger                          ! never opened: quiet

  call check_steps()
  call check_rollback()
  call check_iterations()
  call check_errors()
  call suite%finish()

contains

  include 'sample_cube.inc'

  !> Starts the deck, with a piece of its text changed.
  subroutine start(analysis, error, old, new)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    character(*), intent(in), optional :: old, new
    type(job_options_type) :: options
    character(:), allocatable :: deck
    integer :: at
    deck = cube_deck()
    if (present(old)) then
      at = index(deck, old)
      if (at == 0) error stop 'the piece is not in the deck'
      deck = deck(:at - 1) // new // deck(at + len(old):)
    end if
    options%deck_text = deck
    options%has_files = .false.
    options%n_threads = 1
    call start_analysis(analysis, options, logger, error)
  end subroutine start


  !> Time and the committed displacement of node 7.
  subroutine expect_place(name, analysis, time)
    character(*), intent(in) :: name
    type(analysis_type), intent(in) :: analysis
    real(DP), intent(in) :: time
    call suite%near(name // ': time', analysis%stepping%total_time, time, TOL)
    call suite%near(name // ': time of the state', analysis%state%old%total_time, time, TOL)
    call suite%near(name // ': displacement', analysis%state%old%u(3, 7), 0.01_DP * time, TOL)
  end subroutine expect_place


  !> All increments of both steps; the work of each is the area under its force.
  subroutine check_steps()
    type(analysis_type) :: analysis
    type(error_type), allocatable :: error
    logical :: is_done
    integer :: i
    call start(analysis, error)
    call suite%that('started', .not. allocated(error) .and. .not. is_at_end(analysis) .and. analysis%is_step_start)
    do i = 1, 6
      call advance_analysis(analysis, logger, is_done, error)
      call suite%that('the end is reported', is_done .eqv. i == 6)
      call expect_place('increment', analysis, merge(0.25_DP * real(i, DP), real(i - 3, DP), i <= 4))
      call suite%that('the end of a step is reported', analysis%is_step_start .eqv. (i == 4 .or. i == 6))
      call suite%near('work', analysis%state%old%external_work, 500 * (0.01_DP * analysis%stepping%total_time)**2, TOL)
    end do
    call suite%that('records', analysis%n_records == 6 .and. analysis%n_committed == 6)
    call suite%that('all converged', all(analysis%records(:6)%is_converged))
    call suite%that('steps of the records', all(analysis%records(:6)%step == [1, 1, 1, 1, 2, 2]))
    call suite%that('increments of the records', all(analysis%records(:6)%increment == [1, 2, 3, 4, 1, 2]))
    call suite%near('times of the records', maxval(abs(analysis%records(:6)%total_time - [0.25_DP, 0.5_DP, 0.75_DP, 1.0_DP, &
      2.0_DP, 3.0_DP])), 0.0_DP, TOL)
    call advance_analysis(analysis, logger, is_done, error)
    call suite%that('nothing after the end', is_done .and. .not. allocated(error) .and. analysis%n_records == 6)
    call finish_analysis(analysis, logger, error)
    call suite%that('finished', .not. allocated(error))
  end subroutine check_steps


  !> What is solved without a commit is dropped bitwise; what is committed is not; an increment ends where it must.
  subroutine check_rollback()
    type(analysis_type) :: analysis
    type(error_type), allocatable :: error
    real(DP), allocatable :: stress(:, :)
    logical :: is_done
    call start(analysis, error)
    call advance_analysis(analysis, logger, is_done, error)
    stress = analysis%state%old%stress
    call solve_increment(analysis, logger, 0.4_DP, error)
    call expect_place('until 0.4', analysis, 0.4_DP)
    call suite%that('not committed', analysis%n_records == 2 .and. analysis%n_committed == 1)
    call solve_increment(analysis, logger, huge(1.0_DP), error)
    call suite%that('two of them', analysis%n_records == 3 .and. analysis%n_committed == 1)
    call rollback_analysis(analysis, error)
    call expect_place('dropped', analysis, 0.25_DP)
    call suite%that('dropped bitwise', all(abs(analysis%state%old%stress - stress) <= 0))
    call suite%that('its records too', analysis%n_records == 1)
    call solve_increment(analysis, logger, 0.4_DP, error)
    call commit_analysis(analysis, logger, error)
    call rollback_analysis(analysis, error)
    call expect_place('kept', analysis, 0.4_DP)
    call suite%that('a commit of two records', analysis%n_committed == 2)
    call rollback_analysis(analysis, error)
    call expect_place('kept twice', analysis, 0.4_DP)
    do while (.not. analysis%is_step_start)
      call advance_analysis(analysis, logger, is_done, error)
    end do
    call solve_increment(analysis, logger, huge(1.0_DP), error)
    call suite%that('into step 2', analysis%stepping%step == 2)
    call rollback_analysis(analysis, error)
    call suite%that('back to the end of step 1', analysis%stepping%step == 1 .and. analysis%is_step_start)
    call expect_place('back', analysis, 1.0_DP)
  end subroutine check_rollback


  !> One iteration at a time.
  subroutine check_iterations()
    type(analysis_type) :: analysis
    type(error_type), allocatable :: error
    integer :: verdict, n
    call start(analysis, error)
    call begin_trial(analysis, 0.3_DP, error)
    call suite%that('one record', analysis%n_records == 1)
    call suite%near('nothing is accepted', analysis%stepping%total_time, 0.0_DP, TOL)
    n = 0
    verdict = VERDICT_CONTINUE
    do while (verdict == VERDICT_CONTINUE .and. n < 10)
      call iterate_trial(analysis, logger, verdict, error)
      n = n + 1
    end do
    call suite%that('converged', verdict == VERDICT_CONVERGED .and. analysis%records(1)%n_iterations == n)
    call expect_place('accepted', analysis, 0.3_DP)
  end subroutine check_iterations


  !> A faulty deck; and more increments than INC allows.
  subroutine check_errors()
    type(analysis_type) :: faulty, short
    type(error_type), allocatable :: error
    logical :: is_done
    integer :: i
    call start(faulty, error, '*ELASTIC', '*NONSENSE')
    call suite%that('a faulty deck', allocated(error))
    if (allocated(error)) call suite%that('its code', error%code == EXIT_DECK)
    call start(short, error, 'INC=20', 'INC=2')
    do i = 1, 3
      call advance_analysis(short, logger, is_done, error)
      if (allocated(error)) exit
    end do
    call suite%that('more increments than INC', i == 2 .and. allocated(error))
    if (allocated(error)) call suite%that('its code', error%code == EXIT_NOT_CONVERGED .and. index(error%message, 'INC') > 0)
    call expect_place('what converged is kept', short, 0.5_DP)
  end subroutine check_errors

end program test_analysis
