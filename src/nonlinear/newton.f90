!> One increment by Newton's method: predictor, iterations, verdict, tunnelling check and rigid-motion check.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md.
module amontons_newton
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_extent
  use amontons_model, only: model_type
  use amontons_controls, only: globalization_controls_type, controls_type, newton_controls_type
  use amontons_steps, only: step_type, LINE_SEARCH_AUTO, SOLVER_GRADIENTS
  use amontons_iteration_records, only: iteration_record_type
  use amontons_state, only: state_type, STATUS_OPEN
  use amontons_tunnelling_check, only: largest_sliding, find_tunnelled_slave
  use amontons_active_set_history, only: active_set_history_type, record_active_set
  use amontons_active_set_cycling, only: break_cycle, release_frozen_nodes
  use amontons_convergence, only: convergence_measures_type, assess_convergence, assess_early, assess_growth, n_counted, &
    VERDICT_CONTINUE, VERDICT_DIVERGES, VERDICT_CONVERGED, VERDICT_TOO_SLOW
  use amontons_line_search, only: line_search_report_type, perform_line_search
  use amontons_globalization, only: globalization_type, trial_step_type, choose_step, STEP_KIND_NEWTON, STEP_KIND_PROXIMAL, &
    STEP_KIND_SNAP_THROUGH
  use amontons_contact_rounds, only: contact_rounds_type, perform_round, round_controls
  use amontons_equilibrium, only: equilibrium_type, begin_increment, evaluate_equilibrium, residual_sizes, &
    max_components, update_midside_constraints, &
    OUTCOME_OK, OUTCOME_ELEMENT, OUTCOME_UNSUPPORTED, OUTCOME_TUNNELLING
  use amontons_newton_step, only: set_proximal_shift
  use amontons_boundary_conditions, only: support_powers
  implicit none
  private
  public :: newton_type, begin_newton, choose_descent, iterate

  real(DP), parameter :: MIN_FORCE_CHANGE = 1.0e-3_DP    !< of loads that turn back, by their work on a motion [-]

  !> State of Newton's method within an increment.
  type :: newton_type
    type(convergence_measures_type) :: measures
    type(iteration_record_type) :: record          !< of the last iteration
    integer :: outcome = OUTCOME_OK
    integer :: farthest_node = 0                        !< node of the largest displacement: proximal step or limit exceeded
    integer :: tunnelled_node = 0                    !< the node that passed through its master
    logical :: can_be_cut_back = .false.                !< a shorter increment is possible: a hopeless attempt may end early
    type(globalization_type) :: globalization                    !< kind of the last step, and consecutive unsolved subproblems
    integer :: most_closed = 0                     !< closed slave nodes of an iterate of the attempt, at most
    real(DP), allocatable :: direction(:, :)       !< (3, n_nodes) of the last step [length]
    real(DP) :: approach = 0                       !< sum of the lengths of the steps that moved a loose body [length]
    integer :: n_ascent_directions = 0                        !< iterations with an ascent direction of the merit
    integer :: n_cycles_treated = 0                        !< active-set cycles that were treated
    integer :: n_shifted = 0                       !< factorizations before this attempt that needed a shift
    type(active_set_history_type) :: active_set_history
    type(contact_rounds_type) :: rounds            !< of conjugate gradients
    real(DP) :: largest_attempt_force = 0                   !< largest force of the attempt [force]
    real(DP) :: force_scale = 0                    !< largest bulk force at starts of increments and force at ends [force]
  end type newton_type

contains

  !> Starts an increment with the loads at its end. Predictor: extrapolate with the velocity of the previous increment; where
  !! elements fail there or the loads turn back on a flow, start from the committed displacement. Slave nodes keep their status
  !! unless they slide farther than newton%max_predicted_sliding of the controls.
  subroutine begin_newton(newton, system, model, step, is_step_start, state)
    type(newton_type), intent(inout) :: newton     !< force_scale is kept from increment to increment, all else is reset
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(inout) :: state       !< trial = committed, with the new times
    real(DP) :: dt, sliding
    logical :: is_extrapolated
    newton = newton_type(convergence_measures_type(), iteration_record_type(), active_set_history=active_set_history_type(), &
      n_shifted=system%n_shifted, &
      force_scale=newton%force_scale)
    if (system%proximal_shift > 0.0_DP) call set_proximal_shift(system, model, state%new, 0.0_DP)   ! of a failed attempt
    call begin_increment(system, model, step, is_step_start, state)
    newton%outcome = OUTCOME_ELEMENT
    if (.not. is_step_start) then
      dt = state%new%total_time - state%old%total_time
      sliding = largest_sliding(system%contact, model, state%old%slaves, dt * state%old%v)
      state%new%u = state%old%u + dt * state%old%v
      state%new%load_factor = state%old%load_factor + dt * state%old%load_rate
      call evaluate_equilibrium(system, model, step, state, newton%outcome, is_frozen= &
        sliding < step%controls%newton%max_predicted_sliding)
    end if
    is_extrapolated = newton%outcome == OUTCOME_OK
    if (is_extrapolated) is_extrapolated = .not. do_loads_turn_back(model, step, state, system%u_start)
    if (.not. is_extrapolated) then
      state%new%u = state%old%u
      state%new%load_factor = state%old%load_factor
      state%new%slaves = state%old%slaves
      call begin_increment(system, model, step, is_step_start, state)
      call evaluate_equilibrium(system, model, step, state, newton%outcome, is_frozen=.true.)
    end if
    call record_active_set(newton%active_set_history, state%new%slaves, system%merit)
    ! Forces of stiff parts are arbitrary at an extrapolated start, contact forces of a stiff law at any.
    if (.not. is_extrapolated) newton%force_scale = max(newton%force_scale, system%bulk_force)
    call record_residual(newton, system, [system%largest_residual, maxval(max_components(system, system%residual_at_gap, -1))], &
      step%controls)                           ! K may not be assembled yet
  end subroutine begin_newton


  !> Whether the loads of the increment turn back: the change of the forces, or the motion of the supports, times the velocity of
  !! the previous increment is negative by most of its parts, and a law has a history. It answers stiffly then; the motion before
  !! says nothing about that after. Forces that change by less than a thousandth of their own work follow the motion.
  pure logical function do_loads_turn_back(model, step, state, u_start) result(is_so)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state          !< evaluated with the loads at the end of the increment
    real(DP), intent(in) :: u_start(:, :)          !< (3, n_nodes) displacement at the start of the step [length]
    real(DP) :: power(size(u_start, 2))            ! of each node: no axes decide
    is_so = .false.
    if (step%is_riks .or. all(model%materials%n_history == 0)) return   ! RIKS: loads that decrease along a path lead on
    power = support_powers(model, step, state%new, u_start, state%old%u, state%old%v)
    is_so = sum(power) < -0.5_DP * sum(abs(power))
    power = sum((state%new%applied_force - state%old%applied_force) * state%old%v, dim=1)
    if (sum(abs(power)) > MIN_FORCE_CHANGE * sum(abs(sum(state%old%applied_force * state%old%v, dim=1)))) &
      is_so = is_so .or. sum(power) < -0.5_DP * sum(abs(power))
  end function do_loads_turn_back


  !> One iteration: choice of the step with its contact subproblem, line search, and verdict on the new iterate.
  subroutine iterate(newton, system, model, step, state, verdict, error)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: verdict                !< VERDICT_...; newton%outcome has the cause of a failure
    type(error_type), allocatable, intent(out) :: error
    type(trial_step_type) :: trial_step
    integer :: n_krylov, n_rounds, n_evaluations
    verdict = VERDICT_DIVERGES
    if (newton%outcome /= OUTCOME_OK) return
    n_krylov = system%n_krylov
    n_rounds = system%n_subproblem_iterations
    n_evaluations = system%n_evaluations
    if (step%solver == SOLVER_GRADIENTS) then
      call apply_round(newton, system, model, step, state, error)
    else
      system%forcing_term = forcing_term(step%controls, newton%measures)
      call choose_step(newton%globalization, system, model, step, state, trial_step, newton%outcome, error)
      if (allocated(error) .or. newton%outcome /= OUTCOME_OK) return
      call apply_trial_step(newton, system, model, step, trial_step, state)
    end if
    if (allocated(error) .or. newton%outcome /= OUTCOME_OK) return
    newton%record%n_krylov = system%n_krylov - n_krylov
    newton%record%n_subproblem_iterations = system%n_subproblem_iterations - n_rounds + system%n_evaluations - n_evaluations
    call assess_iterate(newton, system, model, step, state, verdict)
  end subroutine iterate


  !> Whether directions of the next attempt descend where the tangent is not positive, and whether they may lead to another
  !! equilibrium: with damage each node of a coarse mesh may snap, in increments however short.
  pure subroutine choose_descent(newton, system, attempt)
    type(newton_type), intent(in) :: newton
    type(equilibrium_type), intent(inout) :: system
    integer, intent(in) :: attempt                 !< at the increment, from 1
    associate (can_be_cut_back => newton%can_be_cut_back)
      system%may_snap = system%may_soften .and. (.not. can_be_cut_back .or. attempt > system%controls%newton%max_stable_attempts)
      system%seeks_descent = system%may_collapse .and. (can_be_cut_back .or. system%may_snap)
    end associate
  end subroutine choose_descent


  !> Admissible merit of the contact subproblem over that at its start: the square of the last decrease of the residual, so that
  !! Newton's quadratic convergence is kept. Source: S. C. Eisenstat, H. F. Walker, SIAM J. Sci. Comput. 17 (1996) 16-32, choice 2.
  pure real(DP) function forcing_term(controls, measures)
    type(controls_type), intent(in) :: controls
    type(convergence_measures_type), intent(in) :: measures
    forcing_term = controls%subproblem%tolerance
    if (measures%residual(0) < measures%residual(1)) forcing_term = &
      min(controls%subproblem%tolerance, max(controls%newton%min_forcing_term, (measures%residual(0) / measures%residual(1))**2))
  end function forcing_term


  !> Line search along the direction; then active set, displacements, residual and record at the new iterate.
  subroutine apply_trial_step(newton, system, model, step, trial_step, state)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(trial_step_type), intent(in) :: trial_step
    type(state_type), intent(inout) :: state       !< in: evaluated at u; out: evaluated at the new iterate
    type(line_search_report_type) :: report
    real(DP), allocatable :: u(:, :), residual(:, :)
    u = state%new%u
    residual = system%residual
    newton%direction = trial_step%du
    call perform_line_search(system, model, step, trial_step%du, trial_step%predicted_slaves, state, report, newton%outcome, &
      trial_step%d_load)
    if (report%is_ascent_direction .and. newton%measures%residual(0) > step%controls%r_n) newton%n_ascent_directions &
      = newton%n_ascent_directions + 1
    newton%globalization%is_rejected = report%is_rejected
    if (newton%globalization%step_kind /= STEP_KIND_NEWTON) call end_proximal_step(newton, system, model, state, u, residual)
    if (newton%outcome /= OUTCOME_OK) return
    call note_approach(newton, system, model, step%controls%globalization, report%correction, state)
    call record_active_set(newton%active_set_history, state%new%slaves, system%merit)
    call check_displacements(newton, system, model, step%controls%newton, state)
    if (newton%outcome /= OUTCOME_OK) return
    call record_residual(newton, system, residual_sizes(system, state%new%u), step%controls)
    call record_step(newton, system, state, report)
  end subroutine apply_trial_step


  !> One round of conjugate gradients in place of a Newton step.
  subroutine apply_round(newton, system, model, step, state, error)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< in: evaluated at u; out: evaluated at the new iterate
    type(error_type), allocatable, intent(out) :: error
    type(line_search_report_type) :: report
    real(DP), allocatable :: u(:, :), residual(:, :)
    u = state%new%u
    residual = system%residual
    newton%rounds%least_force = step%controls%newton%min_force_scale_ratio * newton%force_scale
    call perform_round(newton%rounds, system, model, step, newton%measures, state, report, newton%outcome, error)
    if (allocated(error) .or. newton%outcome /= OUTCOME_OK) return
    newton%globalization%step_kind = merge(STEP_KIND_PROXIMAL, STEP_KIND_NEWTON, newton%rounds%is_interrupted)
    if (newton%rounds%is_interrupted) then
      newton%globalization%n_proximal = newton%globalization%n_proximal + 1
      state%new%proximal_work = state%new%proximal_work + 0.5_DP * sum((residual + system%residual) * (state%new%u - u))
    end if
    call record_active_set(newton%active_set_history, state%new%slaves, system%merit)
    call check_displacements(newton, system, model, step%controls%newton, state)
    if (newton%outcome /= OUTCOME_OK) return
    call record_residual(newton, system, residual_sizes(system, state%new%u), step%controls)
    call record_step(newton, system, state, report)
  end subroutine apply_round


  !> Verdict on the iterate: residual and correction, active-set cycles, and tunnelling check.
  subroutine assess_iterate(newton, system, model, step, state, verdict)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: verdict                !< VERDICT_...
    type(controls_type) :: controls
    logical :: is_contact_active                          ! contact, not plasticity, delays convergence
    logical :: is_near_collapse                           ! the flow of a law made A lose its sign in this attempt
    controls = controls_of(step)
    is_contact_active = any(state%new%slaves%status /= STATUS_OPEN) .and. (all(model%materials%n_history == 0) .or. &
      newton%active_set_history%hash(1) /= newton%active_set_history%hash(3))   ! yielding takes iterations
    is_near_collapse = system%seeks_descent .and. system%n_shifted > newton%n_shifted .and. .not. system%may_snap
    verdict = assess_convergence(controls, newton%measures)
    if (newton%globalization%step_kind == STEP_KIND_SNAP_THROUGH .and. verdict /= VERDICT_CONVERGED &
      .and. n_counted(newton%measures) < controls%i_c) &
      verdict = VERDICT_CONTINUE                      ! the residual grows during snap-through
    if (verdict == VERDICT_CONTINUE .and. newton%rounds%n_iterations >= controls%gradients%max_iterations) &
      verdict = VERDICT_TOO_SLOW
    if (verdict == VERDICT_CONTINUE .and. newton%can_be_cut_back .and. newton%globalization%step_kind == STEP_KIND_NEWTON) then
      if (step%solver == SOLVER_GRADIENTS) then
        call assess_growth(controls%newton, newton%measures, verdict)
      else if (is_contact_active .or. is_near_collapse) then
        call assess_early(controls%newton, newton%measures, verdict)
      end if
    end if
    if (verdict == VERDICT_CONVERGED .and. system%contact%n_imposed > 0) &   ! imposed stick beyond friction: iterate again
      verdict = merge(VERDICT_CONTINUE, VERDICT_TOO_SLOW, n_counted(newton%measures) < controls%i_c)
    if (system%may_snap .and. system%reduced_system%n_shifted > 0 .and. any(verdict == [VERDICT_TOO_SLOW, VERDICT_DIVERGES]) .and. &
      newton%measures%iteration < controls%newton%max_snap_iterations) then
      newton%measures%n_renewed = newton%measures%iteration - newton%measures%n_approaching
      verdict = VERDICT_CONTINUE
    end if
    if (step%line_search == LINE_SEARCH_AUTO .or. step%solver == SOLVER_GRADIENTS) &
      call treat_cycles(newton, system, model, step, state, verdict)
    if (verdict == VERDICT_CONVERGED) call treat_midsides(newton, system, model, step, state, verdict)
    if (verdict == VERDICT_CONVERGED) call check_tunnelling(newton, system, model, controls%newton, state, verdict)
    if (verdict == VERDICT_CONVERGED) newton%force_scale = max(newton%force_scale, system%largest_force)
  end subroutine assess_iterate


  !> Mid-side nodes of slave faces follow their corners where these are closed at the converged iterate. If others did before, the
  !! iterations continue, and their limits count from here.
  subroutine treat_midsides(newton, system, model, step, state, verdict)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(inout) :: verdict
    logical :: is_changed
    call update_midside_constraints(system, model, step, state, is_changed, newton%outcome)
    if (.not. is_changed) return
    newton%rounds%is_unchanged = .false.
    verdict = VERDICT_DIVERGES
    if (newton%outcome /= OUTCOME_OK) return
    call record_residual(newton, system, residual_sizes(system, state%new%u), step%controls)
    newton%measures%n_renewed = newton%measures%iteration - newton%measures%n_approaching
    verdict = VERDICT_CONTINUE
  end subroutine treat_midsides


  !> The controls of Newton iterations, or of rounds.
  pure type(controls_type) function controls_of(step) result(controls)
    type(step_type), intent(in) :: step
    controls = step%controls
    if (step%solver == SOLVER_GRADIENTS) controls = round_controls(step)
  end function controls_of


  !> Treats active-set cycles. After convergence it releases the frozen nodes and evaluates the verdict again.
  subroutine treat_cycles(newton, system, model, step, state, verdict)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(inout) :: verdict
    type(controls_type) :: controls
    logical :: is_found, is_changed
    if (size(state%new%slaves) == 0) return
    controls = controls_of(step)
    if (verdict == VERDICT_CONVERGED) then
      call release_frozen_nodes(system%contact, model%mesh%coordinates + state%new%u, step%controls%cycling, state%new%slaves, &
        is_changed)
    else
      call break_cycle(system%contact, newton%active_set_history, step%controls%cycling, state%new%slaves, is_found, &
        is_changed)
      if (is_changed) newton%n_cycles_treated = newton%n_cycles_treated + 1
      if (is_changed .and. n_counted(newton%measures) < controls%i_c) verdict = VERDICT_CONTINUE
      if (is_found .and. .not. is_changed .and. newton%can_be_cut_back .and. verdict == VERDICT_CONTINUE) verdict = VERDICT_TOO_SLOW
    end if
    if (.not. is_changed) return
    newton%rounds%is_unchanged = .false.
    call evaluate_equilibrium(system, model, step, state, newton%outcome, is_frozen=.false.)
    call record_residual(newton, system, residual_sizes(system, state%new%u), step%controls)
    if (newton%outcome /= OUTCOME_OK) then
      verdict = VERDICT_DIVERGES
    else if (verdict == VERDICT_CONVERGED .and. (system%contact%n_changed > 0 .or. &
      newton%measures%residual(0) > step%controls%r_n)) then
      verdict = VERDICT_CONTINUE
    end if
  end subroutine treat_cycles


  !> Ends a proximal or snap-through step: removes the shift of K, adds the work of the unbalanced forces (trapezoidal rule).
  subroutine end_proximal_step(newton, system, model, state, u, residual)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) before the iteration [length]
    real(DP), intent(in) :: residual(:, :)         !< (3, n_nodes) there [force]
    newton%globalization%n_proximal = newton%globalization%n_proximal + 1
    call set_proximal_shift(system, model, state%new, 0.0_DP)
    state%new%slaves%is_in_law_range = .false.           ! positions after a proximal step are no first contact
    state%new%proximal_work = state%new%proximal_work + 0.5_DP * sum((residual + system%residual) * (state%new%u - u))
  end subroutine end_proximal_step


  !> Notes a proximal step that carries a body towards a support: it closes more slave nodes than any iterate before, or moves by a
  !! good part of an edge. The limits of the iterations do not count it, as long as the path of these steps is within that of a body
  !! that finds a support: the search for supports of many bodies in a row stays in one attempt.
  pure subroutine note_approach(newton, system, model, controls, length, state)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(globalization_controls_type), intent(in) :: controls
    real(DP), intent(in) :: length                 !< of the step [length]
    type(state_type), intent(in) :: state
    integer :: n_closed
    logical :: is_approach
    n_closed = count(state%new%slaves%status /= STATUS_OPEN)
    is_approach = newton%globalization%step_kind == STEP_KIND_PROXIMAL .and. newton%approach <= mesh_extent(model%mesh)
    if (is_approach) is_approach = n_closed > newton%most_closed .or. &
      length >= 0.5_DP * controls%max_step_edges * minval(system%contact%edge)
    newton%most_closed = max(newton%most_closed, n_closed)
    if (.not. is_approach) return
    newton%approach = newton%approach + length
    newton%measures%n_approaching = newton%measures%n_approaching + 1
  end subroutine note_approach


  !> Tunnelling check: rejects a converged iterate if a slave node passed through its master within the increment.
  subroutine check_tunnelling(newton, system, model, controls, state, verdict)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(newton_controls_type), intent(in) :: controls
    type(state_type), intent(in) :: state
    integer, intent(inout) :: verdict
    integer :: s
    s = find_tunnelled_slave(system%contact, model%mesh%coordinates + state%old%u, model%mesh%coordinates + state%new%u, &
      state%old%slaves, state%new%slaves, controls%min_crossing_steepness)
    if (s == 0) return
    newton%outcome = OUTCOME_TUNNELLING
    newton%tunnelled_node = state%new%slaves(s)%node
    verdict = VERDICT_DIVERGES
  end subroutine check_tunnelling


  !> Displacements of many times the size of the model in one increment mean an unsupported body.
  subroutine check_displacements(newton, system, model, controls, state)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(newton_controls_type), intent(in) :: controls
    type(state_type), intent(in) :: state
    real(DP) :: displacement_limit, displacement(size(state%new%u, 2))  ! [length]
    logical :: is_proximal
    displacement = max_components(system, state%new%u - state%old%u, 1)
    is_proximal = newton%globalization%step_kind /= STEP_KIND_NEWTON
    if (is_proximal) newton%farthest_node = maxloc(displacement, dim=1)
    displacement_limit = merge(controls%max_proximal_ratio, controls%max_displacement_ratio, is_proximal) &
      * mesh_extent(model%mesh)
    if (maxval(displacement) <= displacement_limit) return
    newton%outcome = OUTCOME_UNSUPPORTED
    newton%farthest_node = maxloc(displacement, dim=1)
  end subroutine check_displacements


  !> Shifts in the residual over the largest force. Residuals at rounding level are treated as zero: bodies that only touch, or
  !! move without any force, have no larger force to compare with.
  subroutine record_residual(newton, system, residual, controls)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: residual(2)            !< largest of R, and of R with compliant laws at the actual gap [force]
    type(controls_type), intent(in) :: controls
    real(DP) :: scale
    newton%largest_attempt_force = max(newton%largest_attempt_force, system%largest_force)
    scale = max(system%largest_force, controls%newton%min_force_scale_ratio * newton%force_scale, &
      controls%newton%force_rounding / controls%r_n * newton%largest_attempt_force, tiny(1.0_DP))
    newton%measures%residual = [max(residual(1) - system%force_rounding, 0.0_DP) / scale, newton%measures%residual(0:1)]
    newton%measures%residual_at_gap = max(residual(2) - system%force_rounding, 0.0_DP) / scale
    newton%measures%gap = max(system%contact%max_gap_error, system%mpc_violation)
  end subroutine record_residual


  !> Stores correction and record of the iteration.
  subroutine record_step(newton, system, state, report)
    type(newton_type), intent(inout) :: newton
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(line_search_report_type), intent(in) :: report
    real(DP) :: largest
    integer :: status
    largest = max(maxval(max_components(system, state%new%u - state%old%u, 1)), tiny(1.0_DP))
    newton%measures%iteration = newton%measures%iteration + 1
    newton%measures%correction = [report%correction / largest, newton%measures%correction(0)]
    newton%measures%is_whole_step = report%is_whole_step
    newton%measures%is_displacement_complete = report%is_displacement_complete
    associate (record => newton%record)
      record%iteration = newton%measures%iteration
      record%residual = max(newton%measures%residual(0), newton%measures%residual_at_gap)
      record%correction = newton%measures%correction(0)
      record%n_status = [(count(state%new%slaves%status == status), status=0, 2)]
      record%n_closed = record%n_status(1) + record%n_status(2)
      record%n_scenario = report%n_scenario
      record%n_slip_converged = report%n_slip_converged
      record%n_newly_opened = report%n_newly_opened
      record%n_newly_closed = report%n_closed
      record%step_length = report%step_length
      record%max_gap_error = 0.0_DP
      if (system%contact%worst_slave > 0) record%max_gap_error = &
        system%contact%max_gap_error * system%contact%edge(state%new%slaves(system%contact%worst_slave)%pair)
    end associate
  end subroutine record_step

end module amontons_newton
