!> Globalization: chooses between the Newton step, the proximal step and the snap-through step.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, section [globalization]. `globalization_type` holds all memory of the steps of an attempt: the
!! number of consecutive unsolved contact subproblems, rejection of the last step, and the last shifts.
module amontons_globalization
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_model, only: model_type
  use amontons_controls, only: globalization_controls_type
  use amontons_steps, only: step_type, LINE_SEARCH_AUTO
  use amontons_state, only: state_type, slave_state_type
  use amontons_contact_subproblem, only: solve_contact_subproblem
  use amontons_proximal_step, only: is_motion_unrestrained, find_proximal_step, find_snap_through_step
  use amontons_equilibrium, only: equilibrium_type, OUTCOME_OK, OUTCOME_LINEAR_SOLVER
  use amontons_newton_step, only: solve_newton_step
  implicit none
  private
  public :: globalization_type, trial_step_type, delay_snap_through, choose_step, is_repeatedly_unsolved
  public :: STEP_KIND_NEWTON, STEP_KIND_PROXIMAL, STEP_KIND_SNAP_THROUGH

  integer, parameter :: STEP_KIND_NEWTON = 0          !< direction of K
  integer, parameter :: STEP_KIND_PROXIMAL = 1           !< direction of K + s diag K: a body is not supported yet
  integer, parameter :: STEP_KIND_SNAP_THROUGH = 2            !< the same, from one equilibrium to the next past a limit point

  integer, parameter :: UNSOLVED_LIMIT_NONE = 0, UNSOLVED_LIMIT_INFINITE = huge(1)   !< unsolved_limit

  !> Memory of the steps of an attempt.
  type :: globalization_type
    integer :: step_kind = STEP_KIND_NEWTON                 !< STEP_KIND_... of the last iteration
    integer :: n_proximal = 0                       !< iterations with a proximal or snap-through step
    integer :: n_snap_through = 0                       !< of them, those with a snap-through step
    logical :: is_rejected = .false.                !< the line search found no acceptable length of the last direction
    integer, private :: n_unsolved = 0               !< last consecutive unsolved contact subproblems
    integer, private :: unsolved_limit = UNSOLVED_LIMIT_NONE         !< snap-through steps start beyond so many of them
    real(DP), private :: proximal_shift = 0          !< s to try first in the next proximal step [-]
    real(DP), private :: snap_shift = 0             !< s of the last snap-through step [-]
  end type globalization_type

  !> Step of an iteration.
  type :: trial_step_type
    real(DP), allocatable :: du(:, :)              !< (3, n_nodes) [length]
    real(DP) :: d_load = 0                         !< change of the load factor along it, in a RIKS step [-]
    type(slave_state_type), allocatable :: predicted_slaves(:)      !< (n_slaves) predicted contact state at its end
  end type trial_step_type

contains

  !> Delays snap-through steps until several subproblems remained unsolved: the increment can be cut back instead.
  pure subroutine delay_snap_through(strategy, controls)
    type(globalization_type), intent(inout) :: strategy
    type(globalization_controls_type), intent(in) :: controls
    strategy%unsolved_limit = controls%max_unsolved
  end subroutine delay_snap_through


  !> Whether more than one contact subproblem remained unsolved.
  pure logical function is_repeatedly_unsolved(strategy)
    type(globalization_type), intent(in) :: strategy
    is_repeatedly_unsolved = max(strategy%n_unsolved, strategy%n_snap_through) > 1
  end function is_repeatedly_unsolved


  !> Chooses the step. After more than `unsolved_limit` consecutive unsolved subproblems it takes a snap-through step. It skips the
  !! Newton step if the line search rejected the last one.
  subroutine choose_step(strategy, system, model, step, state, trial_step, outcome, error)
    type(globalization_type), intent(inout) :: strategy
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< evaluated at u, in and out
    type(trial_step_type), intent(out) :: trial_step
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    logical :: is_newton_skipped
    outcome = OUTCOME_OK
    allocate (trial_step%du, mold=state%new%u)
    is_newton_skipped = strategy%is_rejected .and. strategy%unsolved_limit < UNSOLVED_LIMIT_INFINITE
    strategy%is_rejected = .false.
    if (is_newton_skipped) then
      strategy%n_unsolved = max(strategy%n_unsolved, strategy%unsolved_limit) + 1
    else
      call try_newton_step(strategy, system, model, step, state, trial_step, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) return
      strategy%n_unsolved = merge(strategy%n_unsolved + 1, 0, is_step_unsolved(strategy, system, step))
    end if
    if (strategy%n_unsolved > strategy%unsolved_limit) call take_snap_through_step(strategy, system, model, step, state, &
      trial_step, outcome, error)
  end subroutine choose_step


  !> Newton step with its contact subproblem; the proximal step instead where a body is not supported.
  subroutine try_newton_step(strategy, system, model, step, state, trial_step, outcome, error)
    type(globalization_type), intent(inout) :: strategy
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< evaluated at u, in and out
    type(trial_step_type), intent(inout) :: trial_step
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    logical :: is_unrestrained
    call solve_newton_step(system, model, step, state, trial_step%du, outcome, error, trial_step%d_load)
    if (allocated(error)) return
    is_unrestrained = is_motion_unrestrained(system, model, trial_step%du, outcome)
    if (outcome == OUTCOME_OK .and. .not. is_unrestrained) then
      call solve_contact_subproblem(system, model, step, state, trial_step%du, trial_step%predicted_slaves, error, &
        trial_step%d_load)
      if (allocated(error)) return
      is_unrestrained = is_motion_unrestrained(system, model, trial_step%du, outcome)   ! slip may leave a body unsupported
    end if
    if (is_unrestrained .and. step%is_riks) outcome = OUTCOME_LINEAR_SOLVER   ! a shorter arc may keep the bodies together
    if (outcome /= OUTCOME_OK .and. step%is_riks) return
    strategy%step_kind = merge(STEP_KIND_PROXIMAL, STEP_KIND_NEWTON, is_unrestrained)
    if (is_unrestrained) call find_proximal_step(system, model, step, state, strategy%proximal_shift, trial_step%du, &
      trial_step%predicted_slaves, outcome, error)
  end subroutine try_newton_step


  !> Snap-through step. If its contact subproblem remains unsolved too, the attempt takes no further one.
  subroutine take_snap_through_step(strategy, system, model, step, state, trial_step, outcome, error)
    type(globalization_type), intent(inout) :: strategy
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< evaluated at u, in and out
    type(trial_step_type), intent(inout) :: trial_step
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    call find_snap_through_step(system, model, step, state, strategy%snap_shift, trial_step%du, trial_step%predicted_slaves, &
      outcome, error)
    strategy%unsolved_limit = merge(UNSOLVED_LIMIT_NONE, UNSOLVED_LIMIT_INFINITE, system%is_subproblem_solved)
    strategy%step_kind = STEP_KIND_SNAP_THROUGH
    strategy%n_snap_through = strategy%n_snap_through + 1
  end subroutine take_snap_through_step


  !> Whether the contact subproblem of the Newton step remained unsolved.
  pure logical function is_step_unsolved(strategy, system, step)
    type(globalization_type), intent(in) :: strategy
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    is_step_unsolved = .not. step%is_riks .and. step%line_search == LINE_SEARCH_AUTO .and. system%has_interface_solver .and. &
      .not. system%is_subproblem_solved .and. &
      strategy%step_kind == STEP_KIND_NEWTON .and. size(system%contact%slip_data) > 0
  end function is_step_unsolved

end module amontons_globalization
