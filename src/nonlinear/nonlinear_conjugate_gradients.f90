!> Nonlinear preconditioned conjugate gradients with the one-step line search: equilibrium while contact is held.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/conjugate_gradients.md. Statuses, constraint rows and the friction of slipping nodes are constant, so that
!! r = C'R is the gradient of an energy. It needs residuals only, no tangent:
!!
!!     d = inv(M) r + beta d,    beta = max(0, z'(r - r_old) / z_old'r_old)                  (Polak, Ribiere)
!!     alpha = - d'R(u) / d'(R(u + d) - R(u))                     (one-step formula of the slides, repeated where it overshoots)
!!
!! Source of the step lengths: J. Mitchell, A simple one step line search for use in quasi-static solid mechanics contact
!! calculations, 7th US National Congress on Computational Mechanics, 2003.
module amontons_nonlinear_conjugate_gradients
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_extent
  use amontons_model, only: model_type
  use amontons_controls, only: gradient_controls_type
  use amontons_steps, only: step_type, LINE_SEARCH_NONE, LINE_SEARCH_GLOBAL, LINE_SEARCH_NODAL
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN, STATUS_SLIP
  use amontons_slave_node_overrides, only: gives_way
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_relative_position
  use amontons_contact_pairs, only: current_row
  use amontons_sparse, only: multiply, multiply_transpose
  use amontons_friction_slip_scenarios, only: slip_state_type, slip_result_type, slip_controls_type, classify_slip_scenarios, &
    find_bounded_step_length
  use amontons_equilibrium, only: equilibrium_type, evaluate_equilibrium, largest_above_rounding, OUTCOME_OK, OUTCOME_ELEMENT, &
    OUTCOME_NOT_FINITE
  use amontons_conjugate_gradient_preconditioner, only: gradient_preconditioner_type, apply_gradient_preconditioner
  implicit none
  private
  public :: gradient_report_type, solve_held_equilibrium, evaluate_held

  real(DP), parameter :: TOL_FORCE_ROUNDING = 1.0e-13_DP   !< rounding level of a residual, over the force at the start [-]
  real(DP), parameter :: TOL_CURVATURE = 1.0e-10_DP   !< curvature along d over that of the preconditioner, below which a body is
                                                   !! free along d [-]

  real(DP), parameter :: SUFFICIENT_DECREASE = 0.5_DP   !< of |d'r| after which a length that overshot is good enough [-]

  !> The result of a solution with contact held.
  type :: gradient_report_type
    integer :: n_iterations = 0
    integer :: outcome = OUTCOME_OK
    integer :: n_scenario(4) = 0                   !< slave nodes in scenario I to IV, in the first iteration
    integer :: n_capped = 0                        !< lengths that were cut at zero slip, in all iterations
    real(DP) :: step_length = 1                    !< mean length over the iterations; of the slave nodes where they have their own
    logical :: is_interrupted = .false.            !< a body moves freely, or penetrates deeply: contact has to be evaluated anew
    logical :: is_unstable = .false.               !< the residual grows along a direction: there is no minimum nearby
  end type gradient_report_type

  !> The iteration: vectors over the free unknowns, and the point that they belong to.
  type :: iteration_type
    real(DP), allocatable :: r(:), z(:), d(:), r_old(:)   !< (n_free) gradient, preconditioned gradient, direction
    real(DP), allocatable :: u(:, :)               !< (3, n_nodes) the iterate [length]
    real(DP), allocatable :: residual(:, :)        !< (3, n_nodes) R at the iterate [force]
    real(DP) :: descent = 0                        !< z'r of the last iteration [energy]
    real(DP) :: least_descent = huge(1.0_DP)       !< the least so far, when it last fell to a quarter [energy]
    integer :: n_idle = 0                          !< iterations since
    real(DP) :: metric = 0                         !< d'M d [energy]
    real(DP) :: scale = 1                          !< trial length along d: the last length [-]
    logical, allocatable :: is_bulk(:)             !< (n_free) not of a slipping slave node; not allocated: one length for all
    integer :: n_interpolated = 0                  !< residuals interpolated since the last evaluation
    integer :: n_trusted = 0                       !< so many may be interpolated in succession
    type(slave_state_type), allocatable :: slaves(:)   !< (n_slaves) at the start of the round: statuses
  end type iteration_type

contains

  !> Iterates until the largest residual is at most `reduction` times the largest force, or `least_force` if that is larger.
  subroutine solve_held_equilibrium(system, model, step, preconditioner, reduction, least_force, most, state, report)
    type(equilibrium_type), intent(inout) :: system    !< evaluated at u, contact held; constraints are those of the round
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(gradient_preconditioner_type), intent(in) :: preconditioner
    real(DP), intent(in) :: reduction              !< [-]
    real(DP), intent(in) :: least_force            !< [force]
    integer, intent(in) :: most                    !< iterations
    type(state_type), intent(inout) :: state       !< out: evaluated at the solution
    type(gradient_report_type), intent(inout) :: report
    type(iteration_type) :: iteration
    real(DP) :: sum_lengths, length
    integer :: n
    real(DP) :: least                              ! [force]
    call begin_iteration(system, step, state, iteration)
    least = max(least_force, TOL_FORCE_ROUNDING / reduction * system%largest_force)
    sum_lengths = 0.0_DP
    n = 0
    do
      if (is_solved(system, iteration%r, state%new%u, reduction, least)) then
        if (iteration%n_interpolated == 0) exit
        call evaluate_held(system, model, step, iteration%slaves, state%new%u, state, report%outcome)
        if (report%outcome /= OUTCOME_OK) return
        iteration%n_interpolated = 0
        call reduce_residual(system, iteration%r)
        if (is_solved(system, iteration%r, state%new%u, reduction, least)) exit
        iteration%descent = 0.0_DP
      end if
      if (n >= most .or. report%is_interrupted .or. iteration%n_idle > step%controls%gradients%max_idle) exit
      call find_direction(system, preconditioner, iteration)
      if (.not. dot_product(iteration%d, iteration%r) > 0.0_DP) exit   ! nothing is left but rounding, or not finite
      call move_along(system, model, step, iteration, state, report, n == 0, length)
      if (report%outcome /= OUTCOME_OK) return
      n = n + 1
      sum_lengths = sum_lengths + length
    end do
    if (iteration%n_interpolated > 0) call evaluate_held(system, model, step, iteration%slaves, state%new%u, state, report%outcome)
    report%n_iterations = report%n_iterations + n
    if (n > 0) report%step_length = sum_lengths / real(n, DP)
    system%n_krylov = system%n_krylov + n
  end subroutine solve_held_equilibrium


  !> Whether r above rounding level is small enough. (R has the forces of closed nodes as well, whose rows change with the round.)
  pure logical function is_solved(system, r, u, reduction, least_force)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: r(:)                   !< (n_free) [force]
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: reduction              !< [-]
    real(DP), intent(in) :: least_force            !< [force]
    real(DP) :: flat(size(u))
    flat = unpack(r, system%constraints%free_of > 0, 0.0_DP)
    is_solved = largest_above_rounding(system, reshape(flat, shape(u)), u) <= max(reduction * max(system%largest_force, &
      least_force), system%force_rounding)
  end function is_solved


  !> The vectors of the first iteration, and the unknowns of the bulk where slave nodes have their own lengths.
  subroutine begin_iteration(system, step, state, iteration)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state
    type(iteration_type), intent(out) :: iteration
    integer :: n, s, k, f
    n = system%constraints%n_free
    allocate (iteration%r(n), iteration%z(n), iteration%d(n), iteration%r_old(n), source=0.0_DP)
    call reduce_residual(system, iteration%r)
    iteration%slaves = state%new%slaves
    if (.not. any(step%line_search == [LINE_SEARCH_NONE, LINE_SEARCH_GLOBAL, LINE_SEARCH_NODAL])) return
    if (.not. any(state%new%slaves%status == STATUS_SLIP)) return
    allocate (iteration%is_bulk(n), source=.true.)
    do s = 1, size(state%new%slaves)
      if (state%new%slaves(s)%status /= STATUS_SLIP) cycle
      do k = 3 * state%new%slaves(s)%node - 2, 3 * state%new%slaves(s)%node
        f = system%constraints%free_of(k)
        if (f > 0) iteration%is_bulk(f) = .false.
      end do
    end do
    if (.not. any(iteration%is_bulk)) deallocate (iteration%is_bulk)
  end subroutine begin_iteration


  !> r = C'R.
  subroutine reduce_residual(system, r)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(out) :: r(:)                  !< (n_free) [force]
    call multiply_transpose(system%constraints%transformation, reshape(system%residual, [size(system%residual)]), r)
  end subroutine reduce_residual


  !> The next direction by Polak and Ribiere; along the preconditioned gradient where it does not descend.
  subroutine find_direction(system, preconditioner, iteration)
    type(equilibrium_type), intent(inout) :: system
    type(gradient_preconditioner_type), intent(in) :: preconditioner
    type(iteration_type), intent(inout) :: iteration
    real(DP) :: descent, beta
    call apply_gradient_preconditioner(preconditioner, system, iteration%r, iteration%z)
    descent = dot_product(iteration%z, iteration%r)
    beta = 0.0_DP
    if (iteration%descent > 0.0_DP) beta = max(0.0_DP, (descent - dot_product(iteration%z, iteration%r_old)) / iteration%descent)
    if (descent + beta * dot_product(iteration%d, iteration%r) <= 0.0_DP) beta = 0.0_DP
    iteration%metric = descent + 2.0_DP * beta * dot_product(iteration%d, iteration%r) + beta**2 * iteration%metric
    iteration%d = iteration%z + beta * iteration%d
    iteration%descent = descent
    iteration%n_idle = merge(iteration%n_idle + 1, 0, descent > 0.25_DP * iteration%least_descent)
    if (iteration%n_idle == 0) iteration%least_descent = descent
    iteration%r_old = iteration%r
  end subroutine find_direction


  !> Tries a step along d, finds the lengths, and moves there.
  subroutine move_along(system, model, step, iteration, state, report, is_first, length)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(iteration_type), intent(inout) :: iteration
    type(state_type), intent(inout) :: state
    type(gradient_report_type), intent(inout) :: report
    logical, intent(in) :: is_first                !< of the round: its scenarios are reported
    real(DP), intent(out) :: length                !< mean over the slipping slave nodes where they have their own [-]
    type(slip_state_type), allocatable :: slip_data(:)
    type(slip_result_type) :: verdicts(size(iteration%slaves))
    real(DP), allocatable :: p(:), du(:, :), flat(:), tried(:)
    real(DP) :: alpha, share
    iteration%u = state%new%u
    iteration%residual = system%residual
    slip_data = system%contact%slip_data
    allocate (flat(size(iteration%u)), tried(size(iteration%r)))
    call multiply(system%constraints%transformation, iteration%d, flat)
    du = reshape(flat, shape(iteration%u))
    call try_length(system, model, step, iteration, du, state, report%outcome)
    if (report%outcome /= OUTCOME_OK) return
    call reduce_residual(system, tried)
    call find_bulk_length(system, model, step%controls%gradients, iteration, tried, state%new%slaves, du, alpha, report)
    if (is_first .or. allocated(iteration%is_bulk)) call classify(system, step, slip_data, verdicts)
    if (is_first) report%n_scenario = [count(verdicts%scenario == 1), count(verdicts%scenario == 2), &
      count(verdicts%scenario == 3), count(verdicts%scenario == 4)]
    report%n_capped = report%n_capped + count(verdicts%becomes_stick)
    p = iteration%d
    share = 1.0_DP
    if (allocated(iteration%is_bulk) .and. alpha > 0.0_DP) then
      call scale_slave_nodes(system, step, iteration, slip_data, verdicts, alpha, p, share)
      call multiply(system%constraints%transformation, p, flat)
      du = reshape(flat, shape(iteration%u))
    end if
    call advance(system, model, step, iteration, p, iteration%scale * du, alpha, state, report)
    call reduce_residual(system, iteration%r)
    length = share * alpha * iteration%scale
    if (alpha > 0.0_DP .and. .not. report%is_interrupted) iteration%scale = alpha * iteration%scale
  end subroutine move_along


  !> Gives each slipping slave node its own length: scales its slip along the direction by that length over the length of the bulk.
  pure subroutine scale_slave_nodes(system, step, iteration, slip_data, verdicts, alpha, p, share)
    type(equilibrium_type), intent(in) :: system   !< evaluated at the end of the trial step
    type(step_type), intent(in) :: step
    type(iteration_type), intent(in) :: iteration
    type(slip_state_type), intent(in) :: slip_data(:)   !< (n_slaves) at the iterate
    type(slip_result_type), intent(in) :: verdicts(:)   !< (n_slaves)
    real(DP), intent(in) :: alpha                  !< of the bulk, over the trial step [-]
    real(DP), intent(inout) :: p(:)                !< (n_free) in: d; out: the direction of the change of u
    real(DP), intent(out) :: share                 !< mean length of the slipping nodes over that of the bulk [-]
    real(DP) :: lengths(size(verdicts)), change(3)
    integer :: s, k, f
    call find_slave_lengths(step, verdicts, alpha, lengths)
    do s = 1, size(verdicts)
      if (iteration%slaves(s)%status /= STATUS_SLIP) cycle
      change = (lengths(s) / alpha - 1.0_DP) / iteration%scale * (system%contact%slip_data(s)%slip - slip_data(s)%slip)
      do k = 1, 3
        f = system%constraints%free_of(3 * (iteration%slaves(s)%node - 1) + k)
        if (f > 0) p(f) = p(f) + change(k)
      end do
    end do
    share = 1.0_DP
    if (any(verdicts%status == STATUS_SLIP)) share = sum(lengths, mask=verdicts%status == STATUS_SLIP) / &
      (alpha * real(count(verdicts%status == STATUS_SLIP), DP))
  end subroutine scale_slave_nodes


  !> Lengths of the slipping slave nodes by *LINE SEARCH, TYPE, over the trial step. A node in balance moves with the bulk.
  pure subroutine find_slave_lengths(step, verdicts, alpha, lengths)
    type(step_type), intent(in) :: step
    type(slip_result_type), intent(in) :: verdicts(:)   !< (n_slaves)
    real(DP), intent(in) :: alpha                  !< of the bulk [-]
    real(DP), intent(out) :: lengths(:)            !< (n_slaves) [-]
    lengths = alpha
    select case (step%line_search)
    case (LINE_SEARCH_NONE)
      lengths = 1.0_DP
    case (LINE_SEARCH_GLOBAL)
      lengths = find_bounded_step_length(sum(verdicts%numerator), sum(verdicts%denominator), &
        slip_controls_type(alpha_max=step%controls%gradients%max_length))
    case (LINE_SEARCH_NODAL)
      where (verdicts%status == STATUS_SLIP) lengths = verdicts%alpha
    end select
  end subroutine find_slave_lengths


  !> Status and scenario of every slave node between the iterate and the end of the trial step.
  pure subroutine classify(system, step, slip_data, verdicts)
    type(equilibrium_type), intent(in) :: system   !< evaluated at the end of the trial step
    type(step_type), intent(in) :: step
    type(slip_state_type), intent(in) :: slip_data(:)   !< (n_slaves) at the iterate
    type(slip_result_type), intent(out) :: verdicts(:)   !< (n_slaves)
    real(DP) :: d(3, size(slip_data))              ! [length]
    integer :: s
    do s = 1, size(slip_data)
      d(:, s) = system%contact%slip_data(s)%slip - slip_data(s)%slip
    end do
    call classify_slip_scenarios(slip_data, system%contact%slip_data, d, slip_controls_type(step%controls%r_n, &
      step%controls%r_n * system%largest_force, 0.0_DP, step%controls%gradients%max_length), verdicts)
  end subroutine classify


  !> Evaluates the residual at the end of the trial step; shorter ones where elements invert.
  subroutine try_length(system, model, step, iteration, du, state, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(iteration_type), intent(inout) :: iteration
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction [length]
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome
    integer :: cut
    do cut = 0, step%controls%gradients%max_cuts
      call evaluate_held(system, model, step, iteration%slaves, iteration%u + iteration%scale * du, state, outcome)
      if (outcome /= OUTCOME_ELEMENT .and. outcome /= OUTCOME_NOT_FINITE) exit
      iteration%scale = 0.25_DP * iteration%scale
    end do
  end subroutine try_length


  !> The one-step length over the trial step. The step ends where an open node would penetrate too deeply; that of a body that
  !! nothing resists (the residual along d does not change) where it touches. Then contact has to be evaluated anew.
  subroutine find_bulk_length(system, model, controls, iteration, tried, slaves, du, alpha, report)
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(gradient_controls_type), intent(in) :: controls
    type(iteration_type), intent(in) :: iteration
    real(DP), intent(in) :: tried(:)               !< (n_free) r at the end of the trial step [force]
    type(slave_state_type), intent(in) :: slaves(:)   !< (n_slaves) there
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction [length]
    real(DP), intent(out) :: alpha                 !< [-]
    type(gradient_report_type), intent(inout) :: report
    real(DP) :: numerator, denominator, least, longest
    logical :: is_found
    least = -TOL_CURVATURE * iteration%metric * iteration%scale
    is_found = .false.
    if (allocated(iteration%is_bulk)) then
      numerator = sum(iteration%d * iteration%r, mask=iteration%is_bulk)
      denominator = sum(iteration%d * (tried - iteration%r), mask=iteration%is_bulk)
      is_found = denominator < least .and. numerator > 0.0_DP
    end if
    if (.not. is_found) then
      numerator = dot_product(iteration%d, iteration%r)
      denominator = dot_product(iteration%d, tried - iteration%r)
      is_found = denominator < least
      report%is_unstable = denominator > -least
    end if
    longest = mesh_extent(model%mesh) / max(maxval(norm2(du, dim=1)), tiny(1.0_DP))
    if (.not. (is_found .and. allocated(system%contact%held_normal_force))) call limit_penetration(system, slaves, &
      iteration%scale, du, merge(controls%max_penetration, controls%touching, is_found), longest)
    longest = longest / iteration%scale
    alpha = longest
    if (is_found) alpha = min(-numerator / denominator, controls%max_length)
    report%is_interrupted = .not. is_found .or. alpha > longest
    alpha = min(alpha, longest)
  end subroutine find_bulk_length


  !> Shortens a step so that no open slave node gets deeper than a fraction of the master's edge. Nodes that are deeper already do
  !! not count.
  subroutine limit_penetration(system, slaves, tried, du, depth, longest)
    type(equilibrium_type), intent(in) :: system
    type(slave_state_type), intent(in) :: slaves(:)   !< (n_slaves) at the end of the trial step
    real(DP), intent(in) :: tried                  !< length of the trial step along du [-]
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction [length]
    real(DP), intent(in) :: depth                  !< over the edge [-]
    real(DP), intent(inout) :: longest             !< along du [-]
    type(contact_row_type) :: row
    real(DP) :: approach, clearance
    integer :: s
    do s = 1, size(slaves)
      if (slaves(s)%facet == 0 .or. slaves(s)%status /= STATUS_OPEN .or. gives_way(slaves(s)%overrides)) cycle
      call current_row(system%contact, slaves(s), row)
      approach = -dot_product(slaves(s)%normal, evaluate_relative_position(row, du))
      clearance = slaves(s)%gap + tried * approach + depth * system%contact%edge(slaves(s)%pair)
      if (approach > 0.0_DP .and. clearance > 0.0_DP) longest = min(longest, clearance / approach)
    end do
  end subroutine limit_penetration


  !> Moves by alpha along the direction. The residual there is interpolated between those of iterate and trial step where one
  !! length holds for all unknowns and that was exact enough before, else evaluated. A length that inverts elements is cut towards
  !! the trial step, which did not.
  subroutine advance(system, model, step, iteration, p, du, alpha, state, report)
    type(equilibrium_type), intent(inout) :: system    !< evaluated at the end of the trial step
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(iteration_type), intent(inout) :: iteration
    real(DP), intent(in) :: p(:)                   !< (n_free) direction of the change of u
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) the same of all unknowns, as long as the trial step [length]
    real(DP), intent(inout) :: alpha               !< out: cut or repeated [-]
    type(state_type), intent(inout) :: state
    type(gradient_report_type), intent(inout) :: report
    real(DP), allocatable :: interpolated(:, :)
    real(DP) :: error
    integer :: cut
    report%outcome = OUTCOME_OK
    interpolated = iteration%residual + alpha * (system%residual - iteration%residual)
    if (iteration%n_interpolated < iteration%n_trusted) then
      iteration%n_interpolated = iteration%n_interpolated + 1
      state%new%u = iteration%u + alpha * du
      system%residual = interpolated
      return
    end if
    do cut = 0, step%controls%gradients%max_cuts
      call evaluate_held(system, model, step, iteration%slaves, iteration%u + alpha * du, state, report%outcome)
      if (report%outcome /= OUTCOME_ELEMENT .and. report%outcome /= OUTCOME_NOT_FINITE) exit
      alpha = 0.5_DP * (alpha + 1.0_DP)
    end do
    error = norm2(system%residual - interpolated)
    if (cut > 0 .or. allocated(iteration%is_bulk)) error = huge(1.0_DP)
    if (report%outcome == OUTCOME_OK .and. .not. report%is_interrupted) &
      call repeat_length(system, model, step, iteration, p, du, alpha, state, report%outcome)
    if (error <= step%controls%gradients%interpolation_tolerance * norm2(system%residual)) then
      iteration%n_trusted = min(step%controls%gradients%max_interpolated, 2 * iteration%n_trusted + 1)
    else
      iteration%n_trusted = 0
    end if
    iteration%n_interpolated = 0
  end subroutine advance


  !> Repeats the one-step formula between the lengths on either side of the zero of p'r, until p'r has fallen to half.
  !! A change of status bends p'r: one step may pass the zero so far that the iterates alternate for ever.
  subroutine repeat_length(system, model, step, iteration, p, du, alpha, state, outcome)
    type(equilibrium_type), intent(inout) :: system    !< evaluated at alpha
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(iteration_type), intent(in) :: iteration
    real(DP), intent(in) :: p(:)                   !< (n_free) direction of the change of u
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) the same of all unknowns, as long as the trial step [length]
    real(DP), intent(inout) :: alpha               !< [-]
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome
    real(DP) :: slope_start, slope                 ! p'r at 0 and at alpha [energy]
    real(DP) :: before, slope_before               ! the last length with p'r > 0
    real(DP) :: behind, slope_behind               ! the last length with p'r < 0, if any
    real(DP) :: r(size(iteration%r))
    integer :: n
    outcome = OUTCOME_OK
    slope_start = dot_product(p, iteration%r)
    if (slope_start <= 0.0_DP) return               ! lengths of the slave nodes' own may lead uphill
    before = 0.0_DP
    slope_before = slope_start
    behind = 0.0_DP
    slope_behind = 0.0_DP
    do n = 1, step%controls%gradients%max_cuts
      call reduce_residual(system, r)
      slope = dot_product(p, r)
      if (abs(slope) <= SUFFICIENT_DECREASE * slope_start) return
      if (slope > 0.0_DP) then
        before = alpha
        slope_before = slope
      else
        behind = alpha
        slope_behind = slope
      end if
      if (.not. slope_behind < 0.0_DP) return       ! too short: the next direction continues
      alpha = before + (behind - before) * slope_before / (slope_before - slope_behind)
      call evaluate_held(system, model, step, iteration%slaves, iteration%u + alpha * du, state, outcome)
      if (outcome /= OUTCOME_OK) return
    end do
  end subroutine repeat_length


  !> Evaluates the residual with the statuses of the start of the round and the friction that `contact` holds.
  subroutine evaluate_held(system, model, step, slaves, u, state, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(slave_state_type), intent(in) :: slaves(:)   !< (n_slaves)
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome
    state%new%u = u
    state%new%slaves = slaves
    call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.true.)
    system%n_evaluations = system%n_evaluations + 1
  end subroutine evaluate_held

end module amontons_nonlinear_conjugate_gradients
