!> Line search: how far to go along a direction: the one-step formula, global or node by node, guarded by the merit.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! J. Mitchell, A simple one step line search for use in quasi-static solid mechanics contact calculations, 7th US
!! National Congress on Computational Mechanics, 2003. With the direction d and one extra residual,
!!
!!     alpha = - d'R(u) / d'(R(u + d) - R(u))                                                                (LS)
!!
!! The sums run over all unknowns (ALL), over the slave nodes (GLOBAL), or alpha belongs to each node (NODAL). The slip
!! scenarios of the nodes are found in every mode.
module amontons_line_search
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, SEARCH_NONE, SEARCH_ALL, SEARCH_GLOBAL, SEARCH_NODAL, SEARCH_AUTO
  use amontons_state, only: state_type, slave_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_surfaces, only: is_compliant
  use amontons_node_overrides, only: NODE_OVERRIDE_NONE, NODE_OVERRIDE_STICK_ONCE
  use amontons_slip_scenarios, only: slip_verdict_type, slip_controls_type, classify_slip_scenarios, guarded_length, STATUS_BALANCED
  use amontons_tunnelling_check, only: farthest_travel
  use amontons_sparse, only: multiply, multiply_transpose
  use amontons_schur_interface, only: apply_condensed
  use amontons_reduced_system, only: apply_reduced
  use amontons_equilibrium, only: system_type, place_type, place_of, evaluate, residual_pair, components_of, &
    sizes_of, TROUBLE_NONE
  implicit none
  private
  public :: search_type, search_line

  integer, parameter :: MOST_HALVINGS = 4
  real(DP), parameter :: ARRIVED = 1.0e-13_DP      !< of the largest displacement: a prescribed one that misses less is there [-]
  real(DP), parameter :: MOST_TRAVEL = 1.2_DP      !< facets that a slave node may travel in one iteration while supports move [-]
  real(DP), parameter :: NEARER = 0.75_DP          !< the next correction over this one where the imbalance may rise [-]
  real(DP), parameter :: REFUSED = 10.0_DP         !< AUTO goes no step if even the best makes the merit grow by more than this [-]
  real(DP), parameter :: SIZABLE = 1.0e-2_DP       !< and leaves it larger than this part of the largest force [-]
  real(DP), parameter :: LESS = 1.0_DP - 1.0e-9_DP   !< of a merit: what is not below this is the same but for rounding [-]
  real(DP), parameter :: MERIT_GROWTH = 1.0_DP / LESS   !< AUTO takes the full step if the merit does not grow by more than this [-]

  !> What the search did.
  type :: search_type
    real(DP) :: step_length = 1                    !< of the whole step; for NODAL the mean over the nodes that moved [-]
    logical :: is_whole_step = .true.              !< every unknown moved by the whole direction
    logical :: is_arrived = .true.                 !< the prescribed displacements have all arrived
    real(DP) :: correction = 0                     !< largest change of a displacement [length]
    integer :: n_scenario(4) = 0
    integer :: n_balanced = 0                      !< slave nodes that slip in balance
    logical :: is_refused = .false.                !< all lengths were far worse than none: the iterate is where it was
    logical :: is_uphill = .false.                 !< the direction goes against the imbalance: K is not positive along it
    integer :: n_opened = 0, n_closed = 0          !< slave nodes, from the iterate before to this one
  end type search_type

  !> Where the search started.
  type, extends(place_type) :: start_type
    type(slave_type), allocatable :: ahead(:)      !< the slaves for the end of the whole direction
    real(DP) :: pair = 0                           !< d'R(u)
    logical :: is_comparable = .false.             !< no prescribed displacement was missing at u
  end type start_type

contains

  !> Moves the trial state along the direction and evaluates it there.
  subroutine search_line(system, model, step, du, ahead, state, search, trouble)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction d [length]
    type(slave_type), intent(in) :: ahead(:)       !< the memory of the slave nodes with which u + d is evaluated
    type(state_type), intent(inout) :: state       !< in: evaluated at u; out: evaluated at the new iterate
    type(search_type), intent(out) :: search
    integer, intent(out) :: trouble                !< TROUBLE_... if no step length gives a sound configuration
    type(start_type) :: start
    type(slip_verdict_type), allocatable :: verdicts(:)
    start%place_type = place_of(system, state)
    start%ahead = ahead
    start%pair = residual_pair(system, du)
    start%is_comparable = has_arrived(system, state%new%u)
    call first_step(system, model, step, du, start, state, search, trouble)
    if (trouble /= TROUBLE_NONE) return
    call classify(system, step, start, search, verdicts)
    select case (step%line_search)
    case (SEARCH_ALL)
      call try_length(guarded_length(start%pair, residual_pair(system, du) - start%pair, controls_of(system, step)))
    case (SEARCH_GLOBAL)
      call try_length(guarded_length(sum(verdicts%numerator), sum(verdicts%denominator), controls_of(system, step)))
    case (SEARCH_NODAL)
      call try_nodal(system, model, step, start, verdicts, state, search, trouble)
    case (SEARCH_AUTO)
      call back_track(system, model, step, du, start, state, search, trouble)
    end select
    call note_scenarios(verdicts, state%new%slaves)
    search%n_opened = count(start%slaves%status /= STATUS_OPEN .and. state%new%slaves%status == STATUS_OPEN)
    search%n_closed = count(start%slaves%status == STATUS_OPEN .and. state%new%slaves%status /= STATUS_OPEN)
    search%correction = maxval(components_of(system, state%new%u - start%u, 1))
    search%is_arrived = start%is_comparable .or. search%is_whole_step
    search%is_uphill = start%is_comparable .and. start%pair < 0.0_DP

  contains

    !> Takes another length if it lowers the merit against the full step.
    subroutine try_length(alpha)
      real(DP), intent(in) :: alpha
      real(DP) :: full
      if (abs(alpha - 1.0_DP) < 1.0e-3_DP .or. .not. start%is_comparable) return
      full = system%merit
      call go(system, model, step, start, start%u + alpha * du, .false., state, trouble)
      if (trouble == TROUBLE_NONE .and. system%merit <= full) then
        search%step_length = alpha
        search%is_whole_step = .false.
      else
        call go(system, model, step, start, start%u + du, .true., state, trouble)
      end if
    end subroutine try_length

  end subroutine search_line


  !> Whether no prescribed displacement is missing, but for rounding.
  pure logical function has_arrived(system, u)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    has_arrived = maxval(abs(system%base%offset)) <= ARRIVED * maxval(abs(u))
  end function has_arrived


  !> The full step, or the longest half, quarter, ... that leaves no element inverted. While supports move, no slave node
  !! travels more than MOST_TRAVEL facets: its gap and weights are linearised where it is, unless contact has settled ahead.
  subroutine first_step(system, model, step, du, start, state, search, trouble)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: du(:, :)
    type(start_type), intent(in) :: start
    type(state_type), intent(inout) :: state
    type(search_type), intent(inout) :: search
    integer, intent(out) :: trouble
    real(DP) :: longest
    integer :: halving
    longest = 1.0_DP
    if (.not. start%is_comparable .and. .not. system%is_settled) &
      longest = MOST_TRAVEL / max(MOST_TRAVEL, farthest_travel(system%contact, model, start%slaves, du))
    do halving = 0, MOST_HALVINGS
      search%step_length = longest * 0.5_DP**halving
      call go(system, model, step, start, start%u + search%step_length * du, search%step_length == 1.0_DP, state, trouble)
      if (trouble == TROUBLE_NONE) exit
    end do
    search%is_whole_step = search%step_length == 1.0_DP
  end subroutine first_step


  !> Evaluates a configuration, starting from the contact memory of the iterate.
  subroutine go(system, model, step, start, u, is_whole, state, trouble)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(start_type), intent(in) :: start
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    logical, intent(in) :: is_whole                !< the end of the whole direction
    type(state_type), intent(inout) :: state
    integer, intent(out) :: trouble
    state%new%u = u
    state%new%slaves = start%slaves
    if (is_whole) state%new%slaves = start%ahead
    call evaluate(system, model, step, state, trouble, is_frozen=.false.)
  end subroutine go


  !> Tolerances and bounds of the slip scenarios and of all step lengths.
  pure type(slip_controls_type) function controls_of(system, step) result(controls)
    type(system_type), intent(in) :: system
    type(step_type), intent(in) :: step
    controls%balance = step%controls%r_n
    controls%force_zero = step%controls%r_n * system%largest_force
    controls%alpha_min = step%controls%s_min
    controls%alpha_max = step%controls%s_max
  end function controls_of


  !> Status and scenario of every slave node between the iterate and the full step.
  pure subroutine classify(system, step, start, search, verdicts)
    type(system_type), intent(in) :: system        !< evaluated after the full step
    type(step_type), intent(in) :: step
    type(start_type), intent(in) :: start
    type(search_type), intent(inout) :: search
    type(slip_verdict_type), allocatable, intent(out) :: verdicts(:)   !< (n_slaves)
    real(DP), allocatable :: d(:, :)               ! (3, n_slaves) [length]
    integer :: s, scenario
    allocate (verdicts(size(start%view)), d(3, size(start%view)))
    do s = 1, size(start%view)
      d(:, s) = system%contact%view(s)%slip - start%view(s)%slip
    end do
    call classify_slip_scenarios(start%view, system%contact%view, d, controls_of(system, step), verdicts)
    search%n_balanced = count(verdicts%status == STATUS_BALANCED)
    search%n_scenario = [(count(verdicts%scenario == scenario), scenario=1, 4)]
  end subroutine classify


  !> The scenario of each node that this iteration moved by one; the others show that of an earlier iteration.
  pure subroutine note_scenarios(verdicts, slaves)
    type(slip_verdict_type), intent(in) :: verdicts(:)   !< (n_slaves)
    type(slave_type), intent(inout) :: slaves(:)   !< (n_slaves)
    where (verdicts%scenario > 0) slaves%scenario = verdicts%scenario
  end subroutine note_scenarios


  !> Each slipping node goes its own part of its tangential increment, if that lowers the merit against the full step. A node whose
  !! step is cut at zero slip is set to stick there.
  subroutine try_nodal(system, model, step, start, verdicts, state, search, trouble)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(start_type), intent(in) :: start
    type(slip_verdict_type), intent(in) :: verdicts(:)
    type(state_type), intent(inout) :: state
    type(search_type), intent(inout) :: search
    integer, intent(out) :: trouble
    type(start_type) :: nodal
    real(DP), allocatable :: u_full(:, :), u(:, :)
    real(DP) :: full
    integer :: s
    trouble = TROUBLE_NONE
    if (.not. start%is_comparable .or. .not. any(verdicts%scenario > 0)) return
    full = system%merit
    u_full = state%new%u
    u = u_full
    nodal = start
    do s = 1, size(verdicts)
      if (verdicts(s)%status /= STATUS_SLIP) cycle
      associate (node => start%slaves(s)%node)
        u(:, node) = u(:, node) + (verdicts(s)%alpha - 1.0_DP) * (system%contact%view(s)%slip - start%view(s)%slip)
      end associate
      if (verdicts(s)%becomes_stick) call set_to_stick(system, nodal%slaves(s))
    end do
    call go(system, model, step, nodal, u, .false., state, trouble)
    where (state%new%slaves%overrides%status == NODE_OVERRIDE_STICK_ONCE) state%new%slaves%overrides%status = NODE_OVERRIDE_NONE
    if (trouble == TROUBLE_NONE .and. system%merit <= full) then
      search%step_length = sum(verdicts%alpha, mask=verdicts%status == STATUS_SLIP) &
        / real(count(verdicts%status == STATUS_SLIP), DP)
      search%is_whole_step = .false.
    else
      call go(system, model, step, start, u_full, .true., state, trouble)
    end if
  end subroutine try_nodal


  !> A slave node of exact contact sticks in the next evaluation. (A law, or a routine of the user, decides by itself.)
  pure subroutine set_to_stick(system, slave)
    type(system_type), intent(in) :: system
    type(slave_type), intent(inout) :: slave
    associate (law => system%contact%laws(slave%pair))
      if (is_compliant(law) .or. law%is_user_friction) return
    end associate
    slave%status = STATUS_STICK
    slave%overrides%status = NODE_OVERRIDE_STICK_ONCE
  end subroutine set_to_stick


  !> AUTO: the full step if the merit does not grow, if nothing touches, or if contact has settled ahead and the next correction
  !! is shorter: the imbalance of slender bodies has to rise first, since bending them stretches them. Else (LS) over all unknowns,
  !! then halves, down to the least length of the line search; the best is taken, if it is not far worse than where the search
  !! began.
  subroutine back_track(system, model, step, du, start, state, search, trouble)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: du(:, :)
    type(start_type), intent(in) :: start
    type(state_type), intent(inout) :: state
    type(search_type), intent(inout) :: search
    integer, intent(out) :: trouble
    real(DP) :: alpha, here, best, best_merit
    integer :: halving
    trouble = TROUBLE_NONE
    if (system%carry > 0.0_DP .and. system%is_settled) return   ! a body on its way to its master: nothing pushes back yet
    if (all(start%slaves%status == STATUS_OPEN) .and. all(state%new%slaves%status == STATUS_OPEN)) return   ! as without contact
    if (.not. start%is_comparable .or. system%merit <= MERIT_GROWTH * start%merit) return
    if (system%is_settled) then
      if (next_correction(system) <= NEARER * length_of(system, du)) return
    end if
    best = search%step_length
    best_merit = system%merit
    here = best
    alpha = min(0.5_DP * best, guarded_length(start%pair, residual_pair(system, du) - start%pair, controls_of(system, step)))
    do halving = 1, MOST_HALVINGS
      if (alpha < step%controls%s_min) exit
      call go(system, model, step, start, start%u + alpha * du, .false., state, trouble)
      here = alpha
      if (trouble == TROUBLE_NONE .and. system%merit < LESS * best_merit) then
        best = alpha
        best_merit = system%merit
      end if
      if (best_merit <= MERIT_GROWTH * start%merit .or. alpha <= step%controls%s_min) exit
      alpha = max(0.5_DP * alpha, step%controls%s_min)
    end do
    search%is_refused = system%is_condensed .and. best_merit > REFUSED * start%merit .and. &
      best_merit > max(SIZABLE, step%controls%r_n) * system%largest_force
    if (search%is_refused) best = 0.0_DP
    if (best /= here) call go(system, model, step, start, start%u + best * du, best == 1.0_DP, state, trouble)
    search%is_whole_step = best == 1.0_DP
    search%step_length = best
  end subroutine back_track


  !> The length of the correction that the factor at hand gives for the imbalance as it is: the natural level of P. Deuflhard
  !! (Newton Methods for Nonlinear Problems, Springer 2004, section 3.3). It is in displacements, and does not see what stiff parts
  !! do for a moment. Cost: one solution.
  real(DP) function next_correction(system) result(length)
    type(system_type), intent(inout) :: system     !< evaluated where the direction ends
    real(DP), allocatable :: b(:), v(:), flat(:)
    associate (whole => system%whole)
      allocate (b(whole%n_free), v(whole%n_free), flat(whole%n_unknowns))
      call multiply_transpose(whole%map, reshape(system%residual, [whole%n_unknowns]), b)
      if (system%is_condensed) then
        call apply_condensed(system%condensed, b, v)
      else
        call apply_reduced(system%reduced, b, v)
      end if
      call multiply(whole%map, v, flat)
    end associate
    length = length_of(system, reshape(flat, [3, size(flat) / 3]))
  end function next_correction


  !> The length of a direction over all nodes.
  pure real(DP) function length_of(system, du) result(length)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    length = norm2(sizes_of(system, du, 1))
  end function length_of

end module amontons_line_search
