!> Increment control (steps, increments, cut-backs) and the verdict on iterates.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_increment_control
  use amontons_kinds, only: DP
  use amontons_controls, only: controls_type
  use amontons_failure, only: failure_type, FAILURE_USER_ROUTINE, FAILURE_CREEP
  use amontons_steps, only: step_type
  use amontons_convergence, only: convergence_measures_type, assess_convergence, VERDICT_CONTINUE, VERDICT_CONVERGED, &
    VERDICT_DIVERGES, VERDICT_TOO_SLOW
  use amontons_increment_control, only: increment_control_type, attempt_effort_type, begin_stepping, propose_increment, &
    accept_increment, reject_increment, OUTCOME_CONTINUE, OUTCOME_STEP_DONE, OUTCOME_CUT_BACK, OUTCOME_GIVE_UP
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_ten_tenths()
  call check_growth_and_cuts()
  call check_given_cuts()
  call check_step()
  call check_verdicts()
  call suite%finish()

contains

  !> Ten increments of 0.1 end exactly at 1, without an eleventh sliver.
  subroutine check_ten_tenths()
    type(increment_control_type) :: stepping
    type(step_type) :: step
    integer :: i, outcome
    real(DP) :: dt
    step%dt_initial = 0.1_DP
    step%dt_max = 0.1_DP
    call begin_stepping(stepping, step)
    do i = 1, 10
      dt = propose_increment(stepping, step)
      call accept_increment(stepping, step, dt, attempt_effort_type(4), outcome)
      call suite%that('continues until the tenth', outcome == merge(OUTCOME_STEP_DONE, OUTCOME_CONTINUE, i == 10))
    end do
    call suite%near('the step ends at its end', stepping%step_time, 1.0_DP, 0.0_DP)
    call begin_stepping(stepping, step)
    call suite%that('second step', stepping%step == 2)
  end subroutine check_ten_tenths


  subroutine check_growth_and_cuts()
    type(increment_control_type) :: stepping
    type(step_type) :: step
    integer :: i, outcome
    step%dt_initial = 0.1_DP
    step%dt_min = 0.01_DP
    step%dt_max = 0.2_DP
    call begin_stepping(stepping, step)
    call accept_increment(stepping, step, 0.1_DP, attempt_effort_type(3), outcome)
    call suite%near('one fast increment is not enough', stepping%dt, 0.1_DP, 1.0e-15_DP)
    call accept_increment(stepping, step, 0.1_DP, attempt_effort_type(3), outcome)
    call suite%near('two fast ones: grow by d_d', stepping%dt, 0.15_DP, 1.0e-15_DP)
    call accept_increment(stepping, step, 0.15_DP, attempt_effort_type(3), outcome)
    call suite%near('not above the largest allowed', stepping%dt, 0.2_DP, 1.0e-15_DP)
    call accept_increment(stepping, step, 0.2_DP, attempt_effort_type(step%controls%i_l + 1), outcome)
    call suite%near('slow: shrink by d_b', stepping%dt, 0.15_DP, 1.0e-15_DP)
    call reject_increment(stepping, step, 0.15_DP, VERDICT_DIVERGES, failure_type(), outcome)
    call suite%that('cut back', outcome == OUTCOME_CUT_BACK .and. stepping%attempt == 2)
    call suite%near('by d_f', stepping%dt, 0.0375_DP, 1.0e-15_DP)
    call reject_increment(stepping, step, 0.0375_DP, VERDICT_TOO_SLOW, failure_type(), outcome)
    call suite%near('by d_c', stepping%dt, 0.01875_DP, 1.0e-15_DP)
    call reject_increment(stepping, step, 0.01875_DP, VERDICT_DIVERGES, failure_type(), outcome)
    call suite%near('once to the least allowed', stepping%dt, 0.01_DP, 1.0e-15_DP)
    call reject_increment(stepping, step, 0.01_DP, VERDICT_DIVERGES, failure_type(), outcome)
    call suite%that('then give up', outcome == OUTCOME_GIVE_UP)
    step%dt_min = 0.0_DP
    call begin_stepping(stepping, step)
    do i = 1, step%controls%i_a
      call reject_increment(stepping, step, 0.1_DP, VERDICT_DIVERGES, failure_type(), outcome)
      call suite%that('i_a cut-backs are allowed', outcome == OUTCOME_CUT_BACK)
    end do
    call reject_increment(stepping, step, 0.1_DP, VERDICT_DIVERGES, failure_type(), outcome)
    call suite%that('not one more', outcome == OUTCOME_GIVE_UP)
    step%is_direct = .true.
    call begin_stepping(stepping, step)
    call reject_increment(stepping, step, 0.1_DP, VERDICT_DIVERGES, failure_type(), outcome)
    call suite%that('DIRECT never cuts', outcome == OUTCOME_GIVE_UP)
  end subroutine check_growth_and_cuts


  !> User routines and CETOL say how long the next attempt is, and CETOL how much an increment may grow; it cuts back without a
  !! limit of attempts.
  subroutine check_given_cuts()
    type(increment_control_type) :: stepping
    type(step_type) :: step
    integer :: i, outcome
    step%dt_initial = 0.1_DP
    step%dt_min = 1.0e-9_DP
    call begin_stepping(stepping, step)
    call reject_increment(stepping, step, 0.1_DP, VERDICT_DIVERGES, failure_type(FAILURE_USER_ROUTINE, number=0.7_DP), outcome)
    call suite%near('by PNEWDT', stepping%dt, 0.07_DP, 1.0e-15_DP)
    do i = 1, 2 * step%controls%i_a
      call reject_increment(stepping, step, 0.1_DP, VERDICT_DIVERGES, failure_type(FAILURE_CREEP, number=2.0_DP), outcome)
      call suite%that('creep cuts back again', outcome == OUTCOME_CUT_BACK)
    end do
    call suite%near('by d_a and the excess', stepping%dt, 0.1_DP * 0.85_DP / 2, 1.0e-15_DP)
    call reject_increment(stepping, step, 1.0e-9_DP, VERDICT_DIVERGES, failure_type(FAILURE_CREEP, number=2.0_DP), outcome)
    call suite%that('down to the least increment', outcome == OUTCOME_GIVE_UP)
    call grow(0.2_DP, 1.5_DP)
    call grow(0.8_DP, 0.85_DP / 0.8_DP)
    call grow(1.0_DP, 1.0_DP)
  end subroutine check_given_cuts


  !> Two fast increments whose creep differs by a part of CETOL.
  subroutine grow(ratio, factor)
    real(DP), intent(in) :: ratio, factor          !< of CETOL, and the expected growth [-]
    type(increment_control_type) :: stepping
    type(step_type) :: step
    integer :: i, outcome
    step%dt_initial = 0.1_DP
    call begin_stepping(stepping, step)
    do i = 1, 2
      call accept_increment(stepping, step, 0.1_DP, attempt_effort_type(3, creep_ratio=ratio), outcome)
    end do
    call suite%near('growth by creep', stepping%dt, factor * 0.1_DP, 1.0e-15_DP)
  end subroutine grow


  !> Besides the iterations, active-set cycles count, and after a failed attempt also mispredicted contact.
  subroutine check_step()
    type(increment_control_type) :: stepping
    type(step_type) :: step
    integer :: outcome
    step%dt_initial = 0.01_DP
    call begin_stepping(stepping, step)
    call accept_increment(stepping, step, 0.01_DP, attempt_effort_type(3), outcome)
    call accept_increment(stepping, step, 0.01_DP, attempt_effort_type(3, n_cycles_treated=1), outcome)
    call suite%near('not after cycles', stepping%dt, 0.01_DP, 1.0e-15_DP)
    call accept_increment(stepping, step, 0.01_DP, attempt_effort_type(3), outcome)
    call suite%near('two without cycles are required', stepping%dt, 0.01_DP, 1.0e-15_DP)
    call accept_increment(stepping, step, 0.01_DP, attempt_effort_type(5, n_status_changes=2), outcome)
    call suite%near('statuses may change where nothing failed', stepping%dt, 0.015_DP, 1.0e-15_DP)
    call reject_increment(stepping, step, 0.015_DP, VERDICT_TOO_SLOW, failure_type(), outcome)
    call accept_increment(stepping, step, 0.0075_DP, attempt_effort_type(5, n_status_changes=2), outcome)
    call accept_increment(stepping, step, 0.0075_DP, attempt_effort_type(5, n_status_changes=2), outcome)
    call suite%near('not where an attempt failed', stepping%dt, 0.0075_DP, 1.0e-15_DP)
    call accept_increment(stepping, step, 0.0075_DP, attempt_effort_type(4, n_status_changes=2), outcome)
    call accept_increment(stepping, step, 0.0075_DP, attempt_effort_type(5), outcome)
    call suite%near('but when contact is as predicted, or soon is', stepping%dt, 0.01125_DP, 1.0e-15_DP)
    call begin_stepping(stepping, step)
    call accept_increment(stepping, step, 0.01_DP, attempt_effort_type(5, n_status_changes=2), outcome)
    call accept_increment(stepping, step, 0.01_DP, attempt_effort_type(5, n_status_changes=2), outcome)
    call suite%near('a new step knows of no failure', stepping%dt, 0.015_DP, 1.0e-15_DP)
  end subroutine check_step


  subroutine check_verdicts()
    type(controls_type) :: controls
    type(convergence_measures_type) :: progress
    progress = convergence_measures_type(iteration=3, residual=[5.0e-7_DP, 1.0e-2_DP, 1.0_DP], &
      correction=[1.0e-3_DP, 1.0_DP])
    call suite%that('estimated correction 5e-7', assess_convergence(controls, progress) == VERDICT_CONVERGED)
    progress%is_whole_step = .false.
    call suite%that('no estimate after a damped step', assess_convergence(controls, progress) == VERDICT_CONTINUE)
    progress%correction = 5.0e-7_DP
    call suite%that('small correction', assess_convergence(controls, progress) == VERDICT_CONVERGED)
    progress%is_displacement_complete = .false.
    call suite%that('supports have still way to go', assess_convergence(controls, progress) == VERDICT_CONTINUE)
    progress%is_displacement_complete = .true.
    progress%gap = 2.0e-9_DP
    call suite%that('a gap is left', assess_convergence(controls, progress) == VERDICT_CONTINUE)
    progress = convergence_measures_type(iteration=1, residual=[1.0e-10_DP, 0.0_DP, 0.0_DP], correction=1.0_DP)
    call suite%that('a linear problem needs one iteration', assess_convergence(controls, progress) == VERDICT_CONVERGED)
    progress = convergence_measures_type(iteration=9, residual=[3.0_DP, 2.0_DP, 1.0_DP], correction=1.0_DP)
    call suite%that('grows twice', assess_convergence(controls, progress) == VERDICT_DIVERGES)
    progress%iteration = 8
    call suite%that('not judged before i_0', assess_convergence(controls, progress) == VERDICT_CONTINUE)
    progress = convergence_measures_type(iteration=13, residual=[0.9_DP, 0.95_DP, 1.0_DP], correction=1.0_DP)
    call suite%that('too slow', assess_convergence(controls, progress) == VERDICT_TOO_SLOW)
    progress = convergence_measures_type(iteration=24, residual=[1.0e-3_DP, 1.0e-1_DP, 1.0_DP], correction=1.0_DP)
    call suite%that('out of iterations', assess_convergence(controls, progress) == VERDICT_TOO_SLOW)
  end subroutine check_verdicts

end program test_increment_control
