!> Increment control: automatic time incrementation and cut-back.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Rules and names of the controls: CONTROLS, PARAMETERS=TIME INCREMENTATION (doc/manual).
module amontons_increment_control
  use amontons_kinds, only: DP
  use amontons_steps, only: step_type, next_time_point, TOL_STOP_TIME
  use amontons_convergence, only: VERDICT_DIVERGES
  use amontons_failure, only: failure_type, FAILURE_USER_ROUTINE, FAILURE_CREEP
  implicit none
  private
  public :: increment_control_type, attempt_effort_type, &
    begin_stepping, propose_increment, accept_increment, reject_increment, can_cut_back
  public :: OUTCOME_CONTINUE, OUTCOME_STEP_DONE, OUTCOME_CUT_BACK, OUTCOME_GIVE_UP

  integer, parameter :: OUTCOME_CONTINUE = 0           !< after an accepted increment: the step continues
  integer, parameter :: OUTCOME_STEP_DONE = 1              !< the end of the step is reached
  integer, parameter :: OUTCOME_CUT_BACK = 2               !< after a failed attempt: try again with the smaller increment
  integer, parameter :: OUTCOME_GIVE_UP = 3                !< no smaller increment is allowed

  !> Effort of a converged attempt.
  type :: attempt_effort_type
    integer :: n_iterations = 0
    integer :: n_status_changes = 0                    !< slave nodes whose status changed after the first iteration
    integer :: n_cycles_treated = 0                        !< active-set cycles that were treated
    real(DP) :: creep_ratio = 0                        !< difference of creep strains over CETOL [-]
  end type attempt_effort_type

  !> Position of the job in time. Times are committed times.
  type :: increment_control_type
    integer :: step = 0                            !< index into model%steps
    integer :: increment = 0                       !< number of the increment, counted from 1 in each step
    integer :: attempt = 1                         !< number of the attempt at this increment
    real(DP) :: step_time = 0                      !< [time]
    real(DP) :: total_time = 0                     !< [time]
    real(DP) :: dt = 0                             !< proposed for the next increment [time]
    integer :: n_fast_increments = 0                          !< consecutive increments that converged within i_g iterations
    logical :: has_failed = .false.                !< an attempt failed in this step
  end type increment_control_type

contains

  !> Starts the next step.
  pure subroutine begin_stepping(stepping, step)
    type(increment_control_type), intent(inout) :: stepping
    type(step_type), intent(in) :: step
    stepping%step = stepping%step + 1
    stepping%increment = 1
    stepping%attempt = 1
    stepping%step_time = 0.0_DP
    if (step%is_total_time_set) stepping%total_time = step%clock
    stepping%dt = min(step%dt_initial, step%period)
    stepping%n_fast_increments = 0
    stepping%has_failed = .false.
  end subroutine begin_stepping


  !> Length of the next attempt: the proposed one, shortened to end at a time point or at the end of the step [time].
  pure real(DP) function propose_increment(stepping, step) result(dt)
    type(increment_control_type), intent(in) :: stepping
    type(step_type), intent(in) :: step
    real(DP) :: time_left
    dt = stepping%dt
    if (step%is_riks) return                       ! the path ends elsewhere
    time_left = next_time_point(step, stepping%step_time) - stepping%step_time
    if (dt >= time_left - TOL_STOP_TIME * step%period) dt = time_left
  end function propose_increment


  !> Accepts a converged increment: advances the time and adapts the length of the next increment.
  pure subroutine accept_increment(stepping, step, dt, effort, outcome, is_path_done)
    type(increment_control_type), intent(inout) :: stepping
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: dt                     !< length of the increment [time]
    type(attempt_effort_type), intent(in) :: effort
    integer, intent(out) :: outcome                !< OUTCOME_STEP_DONE or OUTCOME_CONTINUE
    logical, intent(in), optional :: is_path_done  !< of a RIKS step: the increment ends it
    logical :: is_done
    stepping%total_time = stepping%total_time + dt
    stepping%step_time = stepping%step_time + dt
    if (step%is_riks) then
      is_done = .false.
      if (present(is_path_done)) is_done = is_path_done
    else
      if (abs(step%period - stepping%step_time) <= TOL_STOP_TIME * step%period) stepping%step_time = step%period
      is_done = stepping%step_time >= step%period
    end if
    if (.not. step%is_direct) call adapt_increment(stepping, step, effort)
    stepping%attempt = 1
    outcome = OUTCOME_STEP_DONE
    if (is_done) return
    stepping%increment = stepping%increment + 1
    outcome = OUTCOME_CONTINUE
  end subroutine accept_increment


  !> Adapts the length of the next increment. It grows after two consecutive fast increments, as far as CETOL allows, and shrinks
  !! after a slow one. It does not grow after active-set cycles. In a step with a failed attempt it does not grow either where
  !! statuses changed after the first iteration and convergence took more than max_quick_iterations iterations.
  pure subroutine adapt_increment(stepping, step, effort)
    type(increment_control_type), intent(inout) :: stepping
    type(step_type), intent(in) :: step
    type(attempt_effort_type), intent(in) :: effort
    logical :: is_fast, is_contact_predicted
    real(DP) :: growth
    is_contact_predicted = effort%n_status_changes == 0 .or. &
      effort%n_iterations <= step%controls%increments%max_quick_iterations
    is_fast = effort%n_iterations <= step%controls%i_g .and. effort%n_cycles_treated == 0 .and. (is_contact_predicted &
      .or. .not. stepping%has_failed)
    stepping%n_fast_increments = merge(stepping%n_fast_increments + 1, 0, is_fast)
    if (effort%n_iterations > step%controls%i_l) then
      stepping%dt = max(step%dt_min, step%controls%d_b * stepping%dt)
    else if (stepping%n_fast_increments >= step%controls%increments%min_fast_increments) then
      growth = step%controls%d_d
      if (effort%creep_ratio * growth > step%controls%d_a) growth = max(1.0_DP, step%controls%d_a / effort%creep_ratio)
      stepping%dt = min(step%dt_max, growth * stepping%dt)
    end if
  end subroutine adapt_increment


  !> Whether an attempt that fails can be repeated with a smaller increment, more than once.
  pure logical function can_cut_back(stepping, step, dt)
    type(increment_control_type), intent(in) :: stepping
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: dt                     !< length of the attempt [time]
    can_cut_back = .not. step%is_direct .and. stepping%attempt < step%controls%i_a .and. step%controls%d_f * dt > step%dt_min
  end function can_cut_back


  !> Rejects a failed attempt: cut back, or give up with DIRECT, after i_a cut-backs, or at the minimum increment. A user routine
  !! and CETOL say how much shorter the next attempt is; CETOL may cut back more often, since each attempt comes nearer.
  pure subroutine reject_increment(stepping, step, dt, verdict, failure, outcome)
    type(increment_control_type), intent(inout) :: stepping
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: dt                     !< length of the attempt [time]
    integer, intent(in) :: verdict                 !< VERDICT_...
    type(failure_type), intent(in) :: failure
    integer, intent(out) :: outcome                !< OUTCOME_CUT_BACK or OUTCOME_GIVE_UP
    outcome = OUTCOME_GIVE_UP
    if (step%is_direct .or. (stepping%attempt > step%controls%i_a .and. failure%code /= FAILURE_CREEP)) return
    stepping%has_failed = .true.
    select case (failure%code)
    case (FAILURE_USER_ROUTINE)
      stepping%dt = dt * failure%number
    case (FAILURE_CREEP)
      stepping%dt = dt * step%controls%d_a / failure%number
    case default
      stepping%dt = dt * merge(step%controls%d_f, step%controls%d_c, verdict == VERDICT_DIVERGES)
    end select
    if (stepping%dt < step%dt_min) then
      if (dt <= step%dt_min * (1.0_DP + TOL_STOP_TIME)) return
      stepping%dt = step%dt_min
    end if
    stepping%n_fast_increments = 0
    stepping%attempt = stepping%attempt + 1
    outcome = OUTCOME_CUT_BACK
  end subroutine reject_increment

end module amontons_increment_control
