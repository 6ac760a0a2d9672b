!> Proximal regularization (K + s diag K) du = R for unsupported bodies and for snap-through at limit points.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, section [proximal_step]. The tangent is singular where a body does not touch its master yet. For
!! one iteration the diagonal of K is scaled up:
!!
!!     (K + s diag K) du = R.
!!
!! The direction is then finite. The shift s is the least tried with which the step length stays within its limit: first contact
!! and some distance beyond. The residual does not contain s, so a converged state is in equilibrium without it.
module amontons_proximal_step
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_extent
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_relative_position
  use amontons_contact_pairs, only: current_row
  use amontons_contact_subproblem, only: solve_contact_subproblem
  use amontons_equilibrium, only: equilibrium_type, evaluate_equilibrium, max_components, nodal_norms, OUTCOME_OK, &
    OUTCOME_LINEAR_SOLVER
  use amontons_newton_step, only: solve_newton_step, set_proximal_shift
  implicit none
  private
  public :: is_motion_unrestrained, find_proximal_step, find_snap_through_step

  real(DP), parameter :: MIN_PROXIMAL_SHIFT = 1.0e-9_DP         !< least s, tried first [-]
  real(DP), parameter :: MAX_PROXIMAL_SHIFT = 1.0_DP             !< largest s [-]
  real(DP), parameter :: MAX_APPROACH_RATIO = 10.0_DP          !< largest step over the distance to first contact [-]
  real(DP), parameter :: MAX_STEP_EDGES = 2.5_DP         !< largest step in edges of the master [-]
  real(DP), parameter :: MAX_LENGTH_EXCESS = 2.0_DP           !< factor by which a direction may exceed its limit [-]
  integer, parameter :: MAX_SHIFT_TRIALS = 6
  real(DP), parameter :: INITIAL_SNAP_SHIFT = 1.0e-3_DP    !< first s of snap-through [-]
  real(DP), parameter :: SNAP_SHIFT_RATIO = 6.0_DP       !< ratio of consecutive trial values of s [-]

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


  !> Proximal step: s is raised until the step length stays within `allowed_step_length`, also after the contact subproblem.
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
    shift = max(MIN_PROXIMAL_SHIFT, shift)
    insufficient_shift = 0.0_DP
    do attempt = 1, MAX_SHIFT_TRIALS
      call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.true.)   ! the subproblem moved contact
      if (outcome /= OUTCOME_OK) return
      call set_proximal_shift(system, model, state%new, shift)
      call solve_newton_step(system, model, step, state, du, outcome, error)
      if (allocated(error)) return
      if (outcome == OUTCOME_LINEAR_SOLVER .and. shift < MAX_PROXIMAL_SHIFT) then
        shift = min(MAX_PROXIMAL_SHIFT, 1.0e3_DP * shift)
        cycle
      end if
      if (outcome /= OUTCOME_OK) return
      excess = maxval(nodal_norms(system, du, 1)) / allowed_step_length(system, model, state, du)
      if (excess <= MAX_LENGTH_EXCESS .or. attempt == MAX_SHIFT_TRIALS) then
        call solve_contact_subproblem(system, model, step, state, du, predicted_slaves, error)
        if (allocated(error)) return
        excess = maxval(nodal_norms(system, du, 1)) / allowed_step_length(system, model, state, du)
      end if
      if (excess <= MAX_LENGTH_EXCESS .or. shift >= MAX_PROXIMAL_SHIFT) exit
      insufficient_shift = shift
      shift = min(MAX_PROXIMAL_SHIFT, shift * excess)
    end do
    shift = max(shift * min(1.0_DP, excess), sqrt(shift * insufficient_shift))
    if (.not. allocated(predicted_slaves)) predicted_slaves = state%new%slaves
  end subroutine find_proximal_step


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
    shift = merge(max(MIN_PROXIMAL_SHIFT, shift / SNAP_SHIFT_RATIO), INITIAL_SNAP_SHIFT, shift > 0.0_DP)
    do
      call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.true.)
      if (outcome /= OUTCOME_OK) return
      call set_proximal_shift(system, model, state%new, shift)
      call solve_newton_step(system, model, step, state, du, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) return
      call solve_contact_subproblem(system, model, step, state, du, predicted_slaves, error)
      if (allocated(error)) return
      if (system%is_subproblem_solved .or. shift >= MAX_PROXIMAL_SHIFT) exit
      shift = min(MAX_PROXIMAL_SHIFT, SNAP_SHIFT_RATIO * shift)
    end do
  end subroutine find_snap_through_step


  !> Limit of the step length: MAX_APPROACH_RATIO times the distance to first contact, at most MAX_STEP_EDGES edges, so that slave
  !! nodes stay within the search radius [length].
  real(DP) function allowed_step_length(system, model, state, du) result(allowed_length)
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    type(contact_row_type) :: row
    real(DP) :: approach, contact_fraction
    integer :: s
    allowed_length = MAX_STEP_EDGES * minval(system%contact%edge)
    contact_fraction = huge(1.0_DP)
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%facet == 0 .or. slave%status /= STATUS_OPEN) cycle
        call current_row(system%contact, slave, row)
        approach = -dot_product(slave%normal, evaluate_relative_position(row, du))
        if (approach > 0.0_DP) contact_fraction = min(contact_fraction, max(slave%gap, &
          1.0e-3_DP * system%contact%edge(slave%pair)) / approach)
      end associate
    end do
    allowed_length = min(allowed_length, merge(MAX_APPROACH_RATIO, 1.0_DP, &
      system%is_schur_active) * contact_fraction * maxval(nodal_norms(system, du, 1)))
    allowed_length = max(allowed_length, 1.0e-6_DP * mesh_extent(model%mesh))
  end function allowed_step_length

end module amontons_proximal_step
