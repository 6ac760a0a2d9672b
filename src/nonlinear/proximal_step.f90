!> Proximal regularization (K + s diag K) du = R for unsupported bodies and for snap-through at limit points.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, section [proximal_step]. The tangent is singular where a body does not touch its master yet. For
!! one iteration the diagonal of K is scaled up:
!!
!!     (K + s diag K) du = R.
!!
!! The direction is then finite. The shift s is the least tried with which the step stays within its trust region and its contact
!! subproblem is solved. The residual does not contain s, so a converged state is in equilibrium without it.
module amontons_proximal_step
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_extent
  use amontons_model, only: model_type
  use amontons_controls, only: globalization_controls_type
  use amontons_steps, only: step_type, LINE_SEARCH_AUTO
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_relative_position
  use amontons_contact_pairs, only: current_row, SEARCH_RADIUS_RATIO
  use amontons_contact_subproblem, only: solve_contact_subproblem
  use amontons_equilibrium, only: equilibrium_type, evaluate_equilibrium, max_components, nodal_norms, OUTCOME_OK, &
    OUTCOME_LINEAR_SOLVER
  use amontons_newton_step, only: solve_newton_step, set_proximal_shift
  implicit none
  private
  public :: is_motion_unrestrained, find_proximal_step, find_snap_through_step

contains

  !> Whether a direction shows an unsupported body: the linear solver failed, the contact interface became singular in the contact
  !! subproblem, or the direction is longer than the whole model.
  logical function is_motion_unrestrained(system, model, du, outcome)
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction; read for OUTCOME_OK only [length]
    integer, intent(in) :: outcome                 !< OUTCOME_... of the direction
    real(DP) :: missing_displacement(size(du, 2))               ! of the prescribed nodes [length]
    is_motion_unrestrained = outcome == OUTCOME_LINEAR_SOLVER .and. size(system%contact%slip_data) > 0
    if (outcome /= OUTCOME_OK .or. size(system%contact%slip_data) == 0) return
    missing_displacement = max_components(system, reshape(system%base%offset, shape(du)), 1)
    is_motion_unrestrained = .not. all(nodal_norms(system, du, 1) <= mesh_extent(model%mesh) + 2.0_DP &
      * maxval(missing_displacement))   ! maxval would skip a NaN
    is_motion_unrestrained = is_motion_unrestrained .or. system%is_interface_singular
  end function is_motion_unrestrained


  !> Proximal step: s is raised until the contact subproblem is solved and the step stays within `allowed_step_length`.
  subroutine find_proximal_step(system, model, step, state, shift, du, predicted_slaves, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: shift                !< s to try first, 0: unknown; out: s to try in the next iteration [-]
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    type(slave_state_type), allocatable, intent(out) :: predicted_slaves(:)   !< (n_slaves) predicted contact state at its end
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: excess, insufficient_shift
    integer :: attempt
    logical :: is_solved                           ! contact included
    associate (limits => step%controls%globalization)
      shift = shift_rung(limits, shift)
      insufficient_shift = 0.0_DP
      do attempt = 1, limits%max_shift_trials
        call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.true.)   ! the subproblem moved contact
        if (outcome /= OUTCOME_OK) return
        call set_proximal_shift(system, model, state%new, shift)
        call solve_newton_step(system, model, step, state, du, outcome, error)
        if (allocated(error)) return
        if (outcome == OUTCOME_LINEAR_SOLVER .and. shift < limits%max_proximal_shift) then
          shift = shift_rung(limits, limits%singular_shift_factor * shift)
          cycle
        end if
        if (outcome /= OUTCOME_OK) return
        excess = maxval(nodal_norms(system, du, 1)) / allowed_step_length(system, limits, state, du)
        if (excess <= limits%max_length_excess .or. attempt == limits%max_shift_trials) then
          call solve_contact_subproblem(system, model, step, state, du, predicted_slaves, error)
          if (allocated(error)) return
          excess = maxval(nodal_norms(system, du, 1)) / allowed_step_length(system, limits, state, du)
        end if
        is_solved = excess <= limits%max_length_excess .and. (system%is_subproblem_solved .or. &
          .not. system%has_interface_solver .or. step%line_search /= LINE_SEARCH_AUTO)
        if (is_solved .or. shift >= limits%max_proximal_shift) exit
        insufficient_shift = shift
        shift = shift_rung(limits, shift * merge(excess, limits%snap_shift_ratio, excess > limits%max_length_excess))
      end do
      shift = shift_rung(limits, max(shift * min(1.0_DP, excess), sqrt(shift * insufficient_shift)))
      if (.not. allocated(predicted_slaves)) predicted_slaves = state%new%slaves
    end associate
  end subroutine find_proximal_step


  !> Nearest rung of a ladder of shifts, between the smallest and the largest. The motion of a free body is known to epsilon/s only:
  !! a shift computed from it would bring that rounding into the path of friction.
  pure real(DP) function shift_rung(limits, shift)
    type(globalization_controls_type), intent(in) :: limits
    real(DP), intent(in) :: shift                  !< [-]
    real(DP) :: bounded, rung
    bounded = max(limits%min_proximal_shift, min(shift, limits%max_proximal_shift)) / limits%max_proximal_shift
    rung = real(nint(limits%shift_rungs_per_octave * log(bounded) / log(2.0_DP)), DP)
    shift_rung = limits%max_proximal_shift * 2.0_DP**(rung / limits%shift_rungs_per_octave)
  end function shift_rung


  !> Snap-through step at a limit point: no equilibrium nearby, contact is lost unstably. s is the least tried with which the
  !! contact subproblem is solved. system%is_subproblem_solved says whether it was; the state remains at u in any case.
  subroutine find_snap_through_step(system, model, step, state, shift, du, predicted_slaves, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: shift                !< sufficient s of the previous iteration, 0: none; out: s of this one [-]
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    type(slave_state_type), allocatable, intent(out) :: predicted_slaves(:)   !< (n_slaves) predicted contact state at its end
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    associate (limits => step%controls%globalization)
      shift = merge(max(limits%min_proximal_shift, shift / limits%snap_shift_ratio), limits%initial_snap_shift, shift > 0.0_DP)
      do
        call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.true.)
        if (outcome /= OUTCOME_OK) return
        call set_proximal_shift(system, model, state%new, shift)
        call solve_newton_step(system, model, step, state, du, outcome, error)
        if (allocated(error) .or. outcome /= OUTCOME_OK) return
        call solve_contact_subproblem(system, model, step, state, du, predicted_slaves, error)
        if (allocated(error)) return
        if (system%is_subproblem_solved .or. shift >= limits%max_proximal_shift) exit
        shift = min(limits%max_proximal_shift, limits%snap_shift_ratio * shift)
      end do
    end associate
  end subroutine find_snap_through_step


  !> Limit of the step length [length]: the trust region in which the contact subproblem is a model of what the step meets. While a
  !! slave node approaches a master it is a part of an edge, so that the bodies of a chain close one after the other and no deep
  !! penetration misleads the projections. In flight it ends within the search radius less such a step.
  real(DP) function allowed_step_length(system, limits, state, du) result(allowed_length)
    type(equilibrium_type), intent(in) :: system
    type(globalization_controls_type), intent(in) :: limits
    type(state_type), intent(in) :: state
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    type(contact_row_type) :: row
    real(DP) :: approach, contact_fraction
    integer :: s
    contact_fraction = huge(1.0_DP)
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%facet == 0 .or. slave%status /= STATUS_OPEN) cycle
        call current_row(system%contact, slave, row)
        approach = -dot_product(slave%normal, evaluate_relative_position(row, du))
        if (approach > 0.0_DP) contact_fraction = min(contact_fraction, max(slave%gap, &
          limits%min_approach_gap * system%contact%edge(slave%pair)) / approach)
      end associate
    end do
    allowed_length = merge(limits%max_step_edges, SEARCH_RADIUS_RATIO - limits%max_step_edges, contact_fraction < huge(1.0_DP)) &
      * minval(system%contact%edge)
    if (contact_fraction < huge(1.0_DP) .and. .not. system%has_interface_solver) allowed_length = min(allowed_length, &
      contact_fraction * maxval(nodal_norms(system, du, 1)))   ! no contact subproblem: not beyond first contact
  end function allowed_step_length

end module amontons_proximal_step
