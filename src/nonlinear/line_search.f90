!> Line search: step length along a direction by the one-step formula, global or nodal, safeguarded by the merit function.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! J. Mitchell, A simple one step line search for use in quasi-static solid mechanics contact calculations, 7th US
!! National Congress on Computational Mechanics, 2003. With the direction d and one extra residual,
!!
!!     alpha = - d'R(u) / d'(R(u + d) - R(u))                                                                (LS)
!!
!! The sums run over all unknowns (ALL), over the slave nodes (GLOBAL), or alpha belongs to each node (NODAL). The slip
!! scenarios of the nodes are determined in every mode.
module amontons_line_search
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, LINE_SEARCH_NONE, LINE_SEARCH_ALL, LINE_SEARCH_GLOBAL, LINE_SEARCH_NODAL, &
    LINE_SEARCH_AUTO
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_surfaces, only: is_compliant
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_NONE, NODE_OVERRIDE_STICK_ONCE
  use amontons_friction_slip_scenarios, only: slip_result_type, slip_controls_type, classify_slip_scenarios, &
    find_bounded_step_length, &
    STATUS_BALANCED
  use amontons_tangent_solution, only: solve_roughly
  use amontons_tunnelling_check, only: largest_sliding
  use amontons_sparse, only: multiply, multiply_transpose
  use amontons_equilibrium, only: equilibrium_type, configuration_type, save_configuration, evaluate_equilibrium, &
    directional_residual, max_components, &
    nodal_norms, OUTCOME_OK
  implicit none
  private
  public :: line_search_report_type, perform_line_search, MERIT_DECREASE_RATIO

  real(DP), parameter :: TOL_PRESCRIBED = 1.0e-13_DP      !< remaining prescribed displacement over the largest displacement that
                                                          !! counts as zero [-]
  real(DP), parameter :: MERIT_DECREASE_RATIO = 1.0_DP - 1.0e-9_DP   !< merits whose ratio is not below this are equal up to
                                                                     !! rounding [-]
  real(DP), parameter :: MAX_MERIT_GROWTH = 1.0_DP / MERIT_DECREASE_RATIO   !< AUTO accepts the full step if the merit grows by no
                                                                            !! more than this factor [-]

  real(DP), parameter :: MAX_SLOPE_RATIO = 0.8_DP         !< slope of the energy at the end of a shortened step over that at its
                                                          !! start [-]
  integer, parameter :: MAX_MINIMUM_EVALUATIONS = 10      !< of a shortened step; then the last one is taken

  !> The result of the search.
  type :: line_search_report_type
    real(DP) :: step_length = 1                    !< of the whole step; for NODAL the mean over the nodes that moved [-]
    logical :: is_whole_step = .true.              !< all unknowns moved by the full step
    logical :: is_displacement_complete = .true.                 !< all prescribed displacements are reached
    real(DP) :: correction = 0                     !< largest change of a displacement [length]
    integer :: n_scenario(4) = 0
    integer :: n_slip_converged = 0                      !< slave nodes slipping in equilibrium
    logical :: is_rejected = .false.                !< all lengths increase the merit too much: the iterate is unchanged
    logical :: is_ascent_direction = .false.                 !< d'R(u) < 0: K is not positive along the direction
    integer :: n_newly_opened = 0, n_closed = 0          !< slave nodes, from the last iterate to this one
  end type line_search_report_type

  !> The start of the search.
  type, extends(configuration_type) :: search_start_type
    type(slave_state_type), allocatable :: predicted_slaves(:)      !< the slaves for the evaluation of the full step
    real(DP) :: pair = 0                           !< d'R(u)
    real(DP) :: d_load = 0                         !< change of the load factor along d [-]
    logical :: is_merit_comparable = .false.             !< the prescribed displacements were complete at u
  end type search_start_type

contains

  !> Moves the trial state along the direction and evaluates it there.
  subroutine perform_line_search(system, model, step, du, predicted_slaves, state, report, outcome, d_load)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction d [length]
    type(slave_state_type), intent(in) :: predicted_slaves(:)       !< the slave states with which u + d is evaluated
    type(state_type), intent(inout) :: state       !< in: evaluated at u; out: evaluated at the new iterate
    type(line_search_report_type), intent(out) :: report
    integer, intent(out) :: outcome                !< OUTCOME_... if no step length gives a valid configuration
    real(DP), intent(in), optional :: d_load       !< change of the load factor along d, in a RIKS step [-]
    type(search_start_type) :: start
    type(slip_result_type), allocatable :: verdicts(:)
    real(DP) :: length
    start%configuration_type = save_configuration(system, state)
    start%predicted_slaves = predicted_slaves
    if (present(d_load)) start%d_load = d_load
    start%pair = directional_residual(system, du)
    start%is_merit_comparable = is_displacement_complete(system, state%new%u)
    call try_full_step(system, model, step, du, start, state, report, outcome)
    if (outcome /= OUTCOME_OK) return
    call classify_slave_nodes(system, step, start, report, verdicts)
    select case (merge(LINE_SEARCH_NONE, step%line_search, step%is_riks))   ! a shorter step would leave the arc
    case (LINE_SEARCH_ALL)
      call try_length(length_over_all())
    case (LINE_SEARCH_GLOBAL)
      call try_length(find_bounded_step_length(sum(verdicts%numerator), sum(verdicts%denominator), controls_of(system, step)))
    case (LINE_SEARCH_NODAL)
      call try_nodal_lengths(system, model, step, start, verdicts, state, report, outcome)
    case (LINE_SEARCH_AUTO)
      if (any([start%slaves%status, state%new%slaves%status] /= STATUS_OPEN)) then
        call backtrack(system, model, step, du, start, state, report, outcome)
      else if (is_minimum_passed(system, model, step, du, start)) then
        length = length_over_all()
        if (length > step%controls%s_min) then
          call try_length(length)
        else
          call seek_minimum(system, model, step, du, start, state, report, outcome)
        end if
      end if
    end select
    call note_scenarios(verdicts, state%new%slaves)
    report%n_newly_opened = count(start%slaves%status /= STATUS_OPEN .and. state%new%slaves%status == STATUS_OPEN)
    report%n_closed = count(start%slaves%status == STATUS_OPEN .and. state%new%slaves%status /= STATUS_OPEN)
    report%correction = maxval(max_components(system, state%new%u - start%u, 1))
    report%is_displacement_complete = start%is_merit_comparable .or. report%is_whole_step
    report%is_ascent_direction = start%is_merit_comparable .and. start%pair < 0.0_DP

  contains

    !> (LS) over all unknowns.
    pure real(DP) function length_over_all()
    length_over_all = find_bounded_step_length(start%pair, directional_residual(system, du) - start%pair, controls_of(system, step))
    end function length_over_all

    !> Accepts another length if its merit does not exceed that of the full step.
    subroutine try_length(alpha)
      real(DP), intent(in) :: alpha
      real(DP) :: full_merit
      if (abs(alpha - 1.0_DP) < step%controls%line_search%min_length_change .or. .not. start%is_merit_comparable) return
      full_merit = system%merit
      call evaluate_trial(system, model, step, start, start%u + alpha * du, .false., state, outcome)
      if (outcome == OUTCOME_OK .and. system%merit <= full_merit) then
        report%step_length = alpha
        report%is_whole_step = .false.
      else
        call evaluate_trial(system, model, step, start, start%u + du, .true., state, outcome)
      end if
    end subroutine try_length

  end subroutine perform_line_search


  !> Whether the prescribed displacements are complete up to rounding.
  pure logical function is_displacement_complete(system, u)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    is_displacement_complete = maxval(abs(system%base%offset)) <= TOL_PRESCRIBED * maxval(abs(u))
  end function is_displacement_complete


  !> The full step, or the longest half, quarter, ... that leaves no element inverted. While supports move, no slave node
  !! slides by more than max_sliding facets, since its gap and weights are linearised at u, unless the contact subproblem is solved.
  subroutine try_full_step(system, model, step, du, start, state, report, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: du(:, :)
    type(search_start_type), intent(in) :: start
    type(state_type), intent(inout) :: state
    type(line_search_report_type), intent(inout) :: report
    integer, intent(out) :: outcome
    real(DP) :: max_length, max_sliding             ! [-], facets [-]
    integer :: halving
    max_length = 1.0_DP
    max_sliding = step%controls%line_search%max_sliding
    if (.not. start%is_merit_comparable .and. .not. system%is_subproblem_solved) &
      max_length = max_sliding / max(max_sliding, largest_sliding(system%contact, model, start%slaves, du))
    do halving = 0, step%controls%line_search%max_halvings
      report%step_length = max_length * 0.5_DP**halving
      state%new%load_factor = start%load_factor + report%step_length * start%d_load
      call evaluate_trial(system, model, step, start, start%u + report%step_length * du, report%step_length == 1.0_DP, state, &
        outcome)
      if (outcome == OUTCOME_OK) exit
    end do
    report%is_whole_step = report%step_length == 1.0_DP
  end subroutine try_full_step


  !> Evaluates a configuration, starting from the slave states of the iterate.
  subroutine evaluate_trial(system, model, step, start, u, is_full_step, state, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(search_start_type), intent(in) :: start
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    logical, intent(in) :: is_full_step                !< the end of the full step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome
    state%new%u = u
    state%new%slaves = start%slaves
    if (is_full_step) state%new%slaves = start%predicted_slaves
    call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.false.)
  end subroutine evaluate_trial


  !> Tolerances and bounds of the slip scenarios and of the step lengths.
  pure type(slip_controls_type) function controls_of(system, step) result(controls)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    controls%slip_tolerance = step%controls%r_n
    controls%force_zero = step%controls%r_n * system%largest_force
    controls%alpha_min = step%controls%s_min
    controls%alpha_max = step%controls%s_max
  end function controls_of


  !> Status and scenario of every slave node between the iterate and the full step.
  pure subroutine classify_slave_nodes(system, step, start, report, verdicts)
    type(equilibrium_type), intent(in) :: system        !< evaluated after the full step
    type(step_type), intent(in) :: step
    type(search_start_type), intent(in) :: start
    type(line_search_report_type), intent(inout) :: report
    type(slip_result_type), allocatable, intent(out) :: verdicts(:)   !< (n_slaves)
    real(DP), allocatable :: d(:, :)               ! (3, n_slaves) [length]
    integer :: s, scenario
    allocate (verdicts(size(start%slip_data)), d(3, size(start%slip_data)))
    do s = 1, size(start%slip_data)
      d(:, s) = system%contact%slip_data(s)%slip - start%slip_data(s)%slip
    end do
    call classify_slip_scenarios(start%slip_data, system%contact%slip_data, d, controls_of(system, step), verdicts)
    report%n_slip_converged = count(verdicts%status == STATUS_BALANCED)
    report%n_scenario = [(count(verdicts%scenario == scenario), scenario=1, 4)]
  end subroutine classify_slave_nodes


  !> Records the scenario of each node to which this iteration applied one; the others keep that of an earlier iteration.
  pure subroutine note_scenarios(verdicts, slaves)
    type(slip_result_type), intent(in) :: verdicts(:)   !< (n_slaves)
    type(slave_state_type), intent(inout) :: slaves(:)   !< (n_slaves)
    where (verdicts%scenario > 0) slaves%scenario = verdicts%scenario
  end subroutine note_scenarios


  !> Each slipping node has its own length along its tangential increment, if the merit is then smaller than that of the full step.
  !! A node whose step is cut at zero slip sticks there.
  subroutine try_nodal_lengths(system, model, step, start, verdicts, state, report, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(search_start_type), intent(in) :: start
    type(slip_result_type), intent(in) :: verdicts(:)
    type(state_type), intent(inout) :: state
    type(line_search_report_type), intent(inout) :: report
    integer, intent(out) :: outcome
    type(search_start_type) :: nodal
    real(DP), allocatable :: u_full(:, :), u(:, :)
    real(DP) :: full_merit
    integer :: s
    outcome = OUTCOME_OK
    if (.not. start%is_merit_comparable .or. .not. any(verdicts%scenario > 0)) return
    full_merit = system%merit
    u_full = state%new%u
    u = u_full
    nodal = start
    do s = 1, size(verdicts)
      if (verdicts(s)%status /= STATUS_SLIP) cycle
      associate (node => start%slaves(s)%node)
        u(:, node) = u(:, node) + (verdicts(s)%alpha - 1.0_DP) * (system%contact%slip_data(s)%slip - start%slip_data(s)%slip)
      end associate
      if (verdicts(s)%becomes_stick) call set_to_stick(system, nodal%slaves(s))
    end do
    call evaluate_trial(system, model, step, nodal, u, .false., state, outcome)
    where (state%new%slaves%overrides%status == NODE_OVERRIDE_STICK_ONCE) state%new%slaves%overrides%status = NODE_OVERRIDE_NONE
    if (outcome == OUTCOME_OK .and. system%merit <= full_merit) then
      report%step_length = sum(verdicts%alpha, mask=verdicts%status == STATUS_SLIP) &
        / real(count(verdicts%status == STATUS_SLIP), DP)
      report%is_whole_step = .false.
    else
      call evaluate_trial(system, model, step, start, u_full, .true., state, outcome)
    end if
  end subroutine try_nodal_lengths


  !> A slave node of exact contact sticks in the next evaluation. (A compliant law or user routine determines the status itself.)
  pure subroutine set_to_stick(system, slave)
    type(equilibrium_type), intent(in) :: system
    type(slave_state_type), intent(inout) :: slave
    associate (law => system%contact%laws(slave%pair))
      if (is_compliant(law) .or. law%is_user_friction) return
    end associate
    slave%status = STATUS_STICK
    slave%overrides%status = NODE_OVERRIDE_STICK_ONCE
  end subroutine set_to_stick


  !> Whether the full step went far beyond the minimum of the energy along d because a material flows: the merit grew, and the slope
  !! d'R at its end has the other sign and is steeper than at its start. The tangent of a material that flows is too soft for what
  !! unloads along d.
  pure logical function is_minimum_passed(system, model, step, du, start) result(is_passed)
    type(equilibrium_type), intent(in) :: system   !< evaluated after the full step
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction d [length]
    type(search_start_type), intent(in) :: start
    real(DP) :: slope                              ! d'R(u + d) [energy]
    slope = directional_residual(system, du)
    is_passed = any(model%materials%n_history > 0) .and. system%proximal_shift <= 0.0_DP .and. start%is_merit_comparable .and. &
      system%merit > max(MAX_MERIT_GROWTH * start%merit, step%controls%r_n * system%largest_force) .and. &
      start%pair > 0.0_DP .and. slope < -start%pair
  end function is_minimum_passed


  !> (LS) over all unknowns, repeated between the lengths on both sides of the minimum of the energy along d, until the slope there
  !! is below that at the start. A side that stays twice counts half of its slope (Illinois), so that both sides move. The full step
  !! stays if a shorter one cannot be evaluated.
  !! Sources: H. Matthies and G. Strang, Int. J. Numer. Meth. Engng 14 (1979) 1613; M. A. Crisfield, Non-linear Finite Element
  !! Analysis of Solids and Structures, vol. 1, Wiley 1991, section 9.2 (a slack tolerance of 0.8).
  subroutine seek_minimum(system, model, step, du, start, state, report, outcome)
    type(equilibrium_type), intent(inout) :: system    !< in: evaluated after the full step, where the slope is negative
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction d, which descends at u [length]
    type(search_start_type), intent(in) :: start
    type(state_type), intent(inout) :: state
    type(line_search_report_type), intent(inout) :: report
    integer, intent(out) :: outcome
    real(DP) :: lengths(2), slopes(2), slope, full   ! before and behind the minimum [-]; [energy]; [-]
    integer :: evaluation, side, last_side
    full = report%step_length
    lengths = [0.0_DP, full]
    slopes = [start%pair, directional_residual(system, du)]
    last_side = 0
    do evaluation = 1, MAX_MINIMUM_EVALUATIONS
      report%step_length = lengths(1) + (lengths(2) - lengths(1)) * slopes(1) / (slopes(1) - slopes(2))
      call evaluate_trial(system, model, step, start, start%u + report%step_length * du, .false., state, outcome)
      if (outcome /= OUTCOME_OK) exit
      slope = directional_residual(system, du)
      if (abs(slope) <= MAX_SLOPE_RATIO * start%pair) exit
      side = merge(1, 2, slope > 0.0_DP)
      lengths(side) = report%step_length
      slopes(side) = slope
      if (side == last_side) slopes(3 - side) = 0.5_DP * slopes(3 - side)
      last_side = side
    end do
    if (outcome == OUTCOME_OK) then
      report%is_whole_step = .false.
    else
      report%step_length = full
      call evaluate_trial(system, model, step, start, start%u + full * du, report%is_whole_step, state, outcome)
    end if
  end subroutine seek_minimum


  !> AUTO with contact: the full step if the merit does not grow, or if the contact subproblem is solved and the next correction is
  !! shorter: in slender bodies bending first causes stretching, which increases the imbalance. Else (LS) over all
  !! unknowns, then halves, down to the least length of the line search. The best length is accepted unless it increases the merit
  !! too much.
  subroutine backtrack(system, model, step, du, start, state, report, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: du(:, :)
    type(search_start_type), intent(in) :: start
    type(state_type), intent(inout) :: state
    type(line_search_report_type), intent(inout) :: report
    integer, intent(out) :: outcome
    real(DP) :: alpha, here, best_length, best_merit
    integer :: halving
    outcome = OUTCOME_OK
    if (system%proximal_shift > 0.0_DP .and. system%is_subproblem_solved) return   ! an unsupported body moving to its master: no
    ! contact force yet
    if (.not. start%is_merit_comparable .or. system%merit <= MAX_MERIT_GROWTH * start%merit) return
    if (system%is_subproblem_solved) then
      if (next_correction_length(system) <= &
        step%controls%line_search%natural_monotonicity_ratio * direction_norm(system, du)) return
    end if
    best_length = report%step_length
    best_merit = system%merit
    here = best_length
    alpha = min(0.5_DP * best_length, find_bounded_step_length(start%pair, directional_residual(system, du) - start%pair, &
      controls_of(system, step)))
    do halving = 1, step%controls%line_search%max_halvings
      if (alpha < step%controls%s_min) exit
      call evaluate_trial(system, model, step, start, start%u + alpha * du, .false., state, outcome)
      here = alpha
      if (outcome == OUTCOME_OK .and. system%merit < MERIT_DECREASE_RATIO * best_merit) then
        best_length = alpha
        best_merit = system%merit
      end if
      if (best_merit <= MAX_MERIT_GROWTH * start%merit .or. alpha <= step%controls%s_min) exit
      alpha = max(0.5_DP * alpha, step%controls%s_min)
    end do
    report%is_rejected = system%has_interface_solver .and. &
      best_merit > step%controls%line_search%rejected_merit_growth * start%merit .and. &
      best_merit > max(step%controls%line_search%min_rejected_residual, step%controls%r_n) * system%largest_force
    if (report%is_rejected) best_length = 0.0_DP
    if (best_length /= here) call evaluate_trial(system, model, step, start, start%u + best_length * du, best_length == 1.0_DP, &
      state, outcome)
    report%is_whole_step = best_length == 1.0_DP
    report%step_length = best_length
  end subroutine backtrack


  !> The norm of the simplified Newton correction, by the present factor at the present imbalance: the natural level function of
  !! P. Deuflhard (Newton Methods for Nonlinear Problems, Springer 2004, section 3.3). It measures displacements, so that transient
  !! forces in stiff parts have little weight. Cost: one solution.
  real(DP) function next_correction_length(system) result(length)
    type(equilibrium_type), intent(inout) :: system     !< evaluated at the end of the direction
    real(DP), allocatable :: b(:), v(:), flat(:)
    associate (constraints => system%constraints)
      allocate (b(constraints%n_free), v(constraints%n_free), flat(constraints%n_unknowns))
      call multiply_transpose(constraints%transformation, reshape(system%residual, [constraints%n_unknowns]), b)
      call solve_roughly(system, b, v)
      call multiply(constraints%transformation, v, flat)
    end associate
    length = direction_norm(system, reshape(flat, [3, size(flat) / 3]))
  end function next_correction_length


  !> The norm of a direction over all nodes.
  pure real(DP) function direction_norm(system, du) result(length)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    length = norm2(nodal_norms(system, du, 1))
  end function direction_norm

end module amontons_line_search
