!> Rounds of contact around nonlinear conjugate gradients: forces or statuses are held inside, then contact is evaluated in full.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/conjugate_gradients.md. A round
!!
!! 1. makes C and c of the constraints, and the preconditioner,
!! 2. moves supports by c,
!! 3. solves the equilibrium with the friction limits held (amontons_nonlinear_conjugate_gradients),
!! 4. evaluates contact in full: the residual is that of the true laws, and Newton's verdict holds.
!!
!! As long as statuses change, rounds are augmented: springs beside the forces held find the statuses inside the iteration. Then
!! the closed nodes are eliminated, with their statuses held. The residual of a round is reduced only as far as the error of what
!! is held.
module amontons_contact_rounds
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_surfaces, only: is_compliant
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_NONE, NODE_OVERRIDE_FROZEN
  use amontons_model, only: model_type
  use amontons_controls, only: controls_type, gradient_controls_type
  use amontons_steps, only: step_type
  use amontons_iteration_records, only: PHASE_FACTOR, PHASE_KRYLOV
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN, STATUS_SLIP
  use amontons_anderson_acceleration, only: anderson_type, accelerate, forget_iterates
  use amontons_contact_pairs, only: contact_type
  use amontons_convergence, only: convergence_measures_type
  use amontons_line_search, only: line_search_report_type
  use amontons_equilibrium, only: equilibrium_type, evaluate_equilibrium, max_components, OUTCOME_OK, OUTCOME_ELEMENT, &
    OUTCOME_NOT_FINITE
  use amontons_newton_step, only: linearize_equilibrium
  use amontons_conjugate_gradient_preconditioner, only: gradient_preconditioner_type, update_gradient_preconditioner
  use amontons_nonlinear_conjugate_gradients, only: gradient_report_type, solve_held_equilibrium, evaluate_held
  implicit none
  private
  public :: contact_rounds_type, perform_round, round_controls, comparable_iterations

  real(DP), parameter :: FAR_FROM_EQUILIBRIUM = 0.1_DP   !< residual of a start whose forces are arbitrary, over the largest force
                                                         !! [-]

  !> Memory of the rounds of an attempt.
  type :: contact_rounds_type
    type(gradient_preconditioner_type) :: preconditioner
    real(DP) :: least_force = 0                    !< with which residuals are compared at least [force]
    integer :: n_rounds = 0
    integer :: n_iterations = 0                    !< conjugate gradients
    integer :: n_frozen = 0                        !< nodes whose status was frozen
    integer :: n_unstable = 0                      !< rounds without a minimum under the friction that was held
    logical :: is_unchanged = .false.                !< no status changed at the end of the last round
    logical :: is_augmented = .false.              !< the last round was augmented
    logical :: is_interrupted = .false.            !< a body moved freely in the last round, or touched
    type(anderson_type) :: acceleration            !< of the friction held
    real(DP), allocatable :: held(:, :)            !< (3, n_slaves) friction held in the last round [force]
    real(DP), allocatable :: limit(:)              !< (n_slaves) friction limits held in the last augmented round [force]
    integer, allocatable :: status(:)              !< (n_slaves) at the start of that round
    integer, allocatable :: n_flips(:)             !< (n_slaves) changes between stick and slip
  end type contact_rounds_type

contains

  !> One round. After it the state is evaluated in full at the new iterate.
  subroutine perform_round(rounds, system, model, step, measures, state, report, outcome, error)
    type(contact_rounds_type), intent(inout) :: rounds
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(convergence_measures_type), intent(in) :: measures   !< at the start of the round
    type(state_type), intent(inout) :: state       !< in: evaluated in full at u; out: at the new iterate
    type(line_search_report_type), intent(out) :: report
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    type(gradient_report_type) :: inner
    type(slave_state_type), allocatable :: slaves(:)
    real(DP), allocatable :: u(:, :)
    real(DP) :: reduction
    logical :: is_augmented
    u = state%new%u
    slaves = state%new%slaves
    rounds%n_rounds = rounds%n_rounds + 1
    is_augmented = .not. rounds%is_unchanged .and. any(.not. is_compliant(system%contact%laws))
    if (rounds%n_rounds == 1) is_augmented = is_augmented .and. measures%residual(0) > FAR_FROM_EQUILIBRIUM
    reduction = find_reduction(rounds, step, max(measures%residual(0), measures%residual_at_gap, largest_gap_force(system, &
      slaves) / max(system%largest_force, rounds%least_force, tiny(1.0_DP))), sets_origins(system, state))
    if (rounds%n_rounds == 1 .and. measures%residual(0) > FAR_FROM_EQUILIBRIUM) &
      call keep_friction(system%contact, state%old%slaves, state%new%slaves)
    call hold_friction(rounds, step%controls%gradients, system%contact, state%new%slaves)
    if (is_augmented) call hold_forces(rounds, system%contact, state%new%slaves)
    rounds%is_augmented = is_augmented
    call solve_portions(rounds, system, model, step, reduction, state, inner, outcome, error)
    rounds%n_iterations = rounds%n_iterations + inner%n_iterations
    if (inner%is_unstable .and. any(system%contact%held_limit > 0.0_DP)) rounds%n_unstable = rounds%n_unstable + 1
    deallocate (system%contact%held_friction)
    if (is_augmented) deallocate (system%contact%held_normal_force)
    if (outcome == OUTCOME_OK .and. .not. allocated(error) .and. inner%is_interrupted) &
      call freeze_closed(slaves, state%new%slaves, .true.)
    if (outcome == OUTCOME_OK .and. .not. allocated(error)) &
      call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.false.)
    if (inner%is_interrupted) call freeze_closed(slaves, state%new%slaves, .false.)
    deallocate (system%contact%held_limit)
    if (allocated(error) .or. outcome /= OUTCOME_OK) return
    system%n_evaluations = system%n_evaluations + 1
    rounds%is_unchanged = system%contact%n_changed == 0
    if (.not. is_augmented) call freeze_cycling_nodes(rounds, step%controls%gradients, system, slaves, state%new%slaves)
    report%step_length = inner%step_length
    report%n_scenario = inner%n_scenario
    report%correction = maxval(max_components(system, state%new%u - u, 1))
    report%n_newly_opened = count(slaves%status /= STATUS_OPEN .and. state%new%slaves%status == STATUS_OPEN)
    report%n_closed = count(slaves%status == STATUS_OPEN .and. state%new%slaves%status /= STATUS_OPEN)
    rounds%is_interrupted = inner%is_interrupted
  end subroutine perform_round


  !> The residual at which a round ends, over the largest force: a fraction of that at its start.
  pure real(DP) function find_reduction(rounds, step, residual, is_origin_set) result(reduction)
    type(contact_rounds_type), intent(in) :: rounds
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: residual               !< at its start, or c g of a closed node, over the largest force [-]
    logical, intent(in) :: is_origin_set           !< nodes may close, and their slip counts from where they do
    associate (controls => step%controls%gradients)
      if (rounds%n_rounds == 1) then
        reduction = merge(controls%origin_reduction, controls%first_reduction, is_origin_set)
      else
        reduction = min(controls%first_reduction, controls%reduction * residual)
      end if
      reduction = max(reduction, controls%least_share * step%controls%r_l)
    end associate
  end function find_reduction


  !> The largest force that would close the gap of a node of exact contact: an augmented round leaves gaps.
  pure real(DP) function largest_gap_force(system, slaves) result(force)
    type(equilibrium_type), intent(in) :: system
    type(slave_state_type), intent(in) :: slaves(:)   !< (n_slaves)
    force = maxval([0.0_DP, pack(slaves%stiffness * abs(slaves%gap), slaves%status /= STATUS_OPEN .and. &
      .not. is_compliant(system%contact%laws(slaves%pair)))])
  end function largest_gap_force


  !> Whether nodes with friction may close in this round.
  pure logical function sets_origins(system, state)
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    integer :: s
    sets_origins = .false.
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%status /= STATUS_OPEN .or. slave%facet == 0) cycle
        sets_origins = system%contact%laws(slave%pair)%friction > 0.0_DP .or. system%contact%laws(slave%pair)%is_user_friction
      end associate
      if (sets_origins) return
    end do
  end function sets_origins


  !> In the first round the nodes that slipped in the last increment keep their friction, where the extrapolated start is far from
  !! equilibrium: its forces are arbitrary where the place of contact moves.
  pure subroutine keep_friction(contact, old, slaves)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: old(:)   !< (n_slaves) committed
    type(slave_state_type), intent(inout) :: slaves(:)   !< (n_slaves)
    integer :: s
    do s = 1, size(slaves)
      if (slaves(s)%status == STATUS_SLIP .and. old(s)%status == STATUS_SLIP .and. .not. &
        is_compliant(contact%laws(slaves(s)%pair))) slaves(s)%shear = old(s)%shear
    end do
  end subroutine keep_friction


  !> After an interrupted round, which is not in equilibrium, nodes may close but closed ones keep their status.
  pure subroutine freeze_closed(before, slaves, is_frozen)
    type(slave_state_type), intent(in) :: before(:)
    type(slave_state_type), intent(inout) :: slaves(:)   !< (n_slaves)
    logical, intent(in) :: is_frozen
    integer :: s
    do s = 1, size(slaves)
      if (before(s)%status == STATUS_OPEN .or. before(s)%overrides%status /= NODE_OVERRIDE_NONE) cycle
      slaves(s)%overrides%status = merge(NODE_OVERRIDE_FROZEN, NODE_OVERRIDE_NONE, is_frozen)
    end do
  end subroutine freeze_closed


  !> Moves supports and closed nodes by c, in portions where elements would invert, and solves after each of them.
  subroutine solve_portions(rounds, system, model, step, reduction, state, inner, outcome, error)
    type(contact_rounds_type), intent(inout) :: rounds
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: reduction              !< [-]
    type(state_type), intent(inout) :: state
    type(gradient_report_type), intent(out) :: inner
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    type(slave_state_type), allocatable :: slaves(:)
    integer :: portion
    logical :: is_whole
    do portion = 1, step%controls%gradients%max_portions
      call linearize_round(rounds, system, model, step, portion == 1, state, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) return
      if (portion == 1) slaves = state%new%slaves
      call move_supports(system, model, step, slaves, state, is_whole, outcome)
      if (outcome /= OUTCOME_OK) return
      call solve_held_equilibrium(system, model, step, rounds%preconditioner, merge(reduction, &
        step%controls%gradients%portion_reduction, is_whole), &
        rounds%least_force, step%controls%gradients%max_iterations - rounds%n_iterations - inner%n_iterations, state, inner)
      outcome = inner%outcome
      if (outcome /= OUTCOME_OK .or. is_whole .or. inner%is_interrupted) return
    end do
    outcome = OUTCOME_ELEMENT
  end subroutine solve_portions


  !> Holds the friction limits, and the friction of the slipping nodes: that of the last full evaluation, accelerated while the
  !! statuses stay the same. A friction larger than `max_excess` times the limit is shortened.
  subroutine hold_friction(rounds, controls, contact, slaves)
    type(contact_rounds_type), intent(inout) :: rounds
    type(gradient_controls_type), intent(in) :: controls
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: slaves(:)   !< (n_slaves) evaluated in full
    real(DP) :: limit
    real(DP), allocatable :: next(:)
    integer, allocatable :: slipping(:)
    integer :: s
    allocate (contact%held_friction(3, size(slaves)), source=0.0_DP)
    slipping = pack([(s, s=1, size(slaves))], slaves%status == STATUS_SLIP)
    do s = 1, size(slaves)
      if (slaves(s)%status == STATUS_SLIP) contact%held_friction(:, s) = slaves(s)%shear
    end do
    if (rounds%is_unchanged .and. .not. rounds%is_augmented .and. size(slipping) > 0) then
      allocate (next(3 * size(slipping)))
      call accelerate(rounds%acceleration, reshape(rounds%held(:, slipping), [3 * size(slipping)]), &
        reshape(contact%held_friction(:, slipping), [3 * size(slipping)]), next)
      do s = 1, size(slipping)
        limit = controls%max_excess * norm2(slaves(slipping(s))%shear)
        associate (friction => contact%held_friction(:, slipping(s)))
          friction = next(3 * s - 2:3 * s)
          if (norm2(friction) > limit) friction = limit / norm2(friction) * friction
        end associate
      end do
    else
      call forget_iterates(rounds%acceleration)
    end if
    rounds%held = contact%held_friction
    contact%held_limit = merge(norm2(contact%held_friction, dim=1), contact%slip_data%limit, slaves%status == STATUS_SLIP .and. &
      .not. is_compliant(contact%laws(slaves%pair)))
  end subroutine hold_friction


  !> Augments the contact forces of the last evaluation in this round. After an augmented round the forces of open nodes that it
  !! pressed count as well, and a node that it changed between stick and slip has the mean of the last two limits: where friction
  !! changes its own limit by more than itself, the node would change for ever.
  pure subroutine hold_forces(rounds, contact, slaves)
    type(contact_rounds_type), intent(inout) :: rounds   !< of the last round
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: slaves(:)   !< (n_slaves) evaluated in full
    logical :: has_changed
    integer :: s
    allocate (contact%held_normal_force(size(slaves)), source=0.0_DP)
    do s = 1, size(slaves)
      if (is_compliant(contact%laws(slaves(s)%pair))) cycle
      if (slaves(s)%status /= STATUS_OPEN .or. rounds%is_augmented) contact%held_normal_force(s) = &
        merge(contact%slip_data(s)%N, max(contact%slip_data(s)%N, 0.0_DP), slaves(s)%is_bilateral)
      contact%held_friction(:, s) = slaves(s)%shear
      contact%held_limit(s) = merge(0.0_DP, contact%slip_data(s)%limit, slaves(s)%status == STATUS_OPEN)
      has_changed = rounds%is_augmented .and. slaves(s)%status /= STATUS_OPEN
      if (has_changed) has_changed = all(rounds%status(s) /= [STATUS_OPEN, slaves(s)%status])
      if (has_changed) contact%held_limit(s) = 0.5_DP * (contact%held_limit(s) + rounds%limit(s))
    end do
    rounds%limit = contact%held_limit
    rounds%status = slaves%status
  end subroutine hold_forces


  !> K or its nodal blocks, C with c, and the preconditioner.
  subroutine linearize_round(rounds, system, model, step, is_first_portion, state, outcome, error)
    type(contact_rounds_type), intent(inout) :: rounds
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_first_portion
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    call linearize_equilibrium(system, model, step, state, outcome, error)
    if (allocated(error) .or. outcome /= OUTCOME_OK) return
    call update_gradient_preconditioner(rounds%preconditioner, system, model, step, rounds%n_rounds == 1 .and. is_first_portion, &
      outcome, error)
  end subroutine linearize_round


  !> Adds c, or the largest half, quarter, ... of it that leaves no element inverted.
  subroutine move_supports(system, model, step, slaves, state, is_whole, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(slave_state_type), intent(in) :: slaves(:)   !< (n_slaves) their statuses
    type(state_type), intent(inout) :: state
    logical, intent(out) :: is_whole
    integer, intent(out) :: outcome                !< OUTCOME_...
    real(DP), allocatable :: u(:, :), c(:, :)
    integer :: cut
    u = state%new%u
    c = reshape(system%constraints%offset, shape(u))
    do cut = 0, step%controls%gradients%max_cuts
      call evaluate_held(system, model, step, slaves, u + 0.5_DP**cut * c, state, outcome)
      if (outcome /= OUTCOME_ELEMENT .and. outcome /= OUTCOME_NOT_FINITE) exit
    end do
    is_whole = cut == 0
  end subroutine move_supports


  !> Ends cycling: a node of exact contact that changes too often between stick and slip keeps its status until all else is in
  !! equilibrium; then it is released once (amontons_active_set_cycling).
  pure subroutine freeze_cycling_nodes(rounds, controls, system, before, slaves)
    type(contact_rounds_type), intent(inout) :: rounds
    type(gradient_controls_type), intent(in) :: controls
    type(equilibrium_type), intent(in) :: system
    type(slave_state_type), intent(in) :: before(:)   !< (n_slaves) at the start of the round
    type(slave_state_type), intent(inout) :: slaves(:)   !< (n_slaves) at its end
    integer :: s
    if (allocated(rounds%n_flips)) then
      if (size(rounds%n_flips) /= size(slaves)) deallocate (rounds%n_flips)
    end if
    if (.not. allocated(rounds%n_flips)) allocate (rounds%n_flips(size(slaves)), source=0)
    do s = 1, size(slaves)
      if (before(s)%status == STATUS_OPEN .or. slaves(s)%status == STATUS_OPEN .or. before(s)%status == slaves(s)%status) cycle
      rounds%n_flips(s) = rounds%n_flips(s) + 1
      if (rounds%n_flips(s) < controls%max_flips .or. is_compliant(system%contact%laws(slaves(s)%pair))) cycle
      if (slaves(s)%overrides%status /= NODE_OVERRIDE_NONE) cycle
      slaves(s)%overrides%status = NODE_OVERRIDE_FROZEN
      rounds%n_frozen = rounds%n_frozen + 1
    end do
  end subroutine freeze_cycling_nodes


  !> The controls of a step with rounds in place of Newton iterations: their rate is linear, so that more are allowed.
  pure type(controls_type) function round_controls(step) result(controls)
    type(step_type), intent(in) :: step
    controls = step%controls
    associate (most => step%controls%gradients%max_rounds)
      controls%i_0 = most
      controls%i_r = most / 3
      controls%i_p = most
      controls%i_c = most
    end associate
  end function round_controls


  !> The Newton iterations that as large a share of an attempt's limit are, for the size of the next increment.
  pure integer function comparable_iterations(step, n_rounds) result(n)
    type(step_type), intent(in) :: step
    integer, intent(in) :: n_rounds
    n = ceiling(real(n_rounds * step%controls%i_c, DP) / real(step%controls%gradients%max_rounds, DP))
  end function comparable_iterations

end module amontons_contact_rounds
