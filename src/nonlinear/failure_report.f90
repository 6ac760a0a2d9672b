!> Diagnosis of an increment that did not converge: failure code, worst nodes, remedy.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `amontons_failure_messages` makes the sentences of a failure.
!!
!! | reason | found by | remedy |
!! |---|---|---|
!! | MATERIAL | an inverted element, or a material law without a solution | smaller increments |
!! | LINEAR SOLVER | a singular matrix, or a force that is not finite | constraints, numbers of the deck |
!! | CONSTRAINTS | constraints that follow the motion contradict each other | supports, equations |
!! | FREE BODY | a direction of many times the size of the model, and supports alone do not hold all bodies | supports |
!! | LEFT MASTER | closed slave nodes left their master | a larger master |
!! | CYCLE, STICK-SLIP FLIP | the hash of all slave nodes recurs | smaller increments, a finer master |
!! | PENETRATION JUMP | the penetration of a slave node jumps | smaller increments |
!! | LIMIT POINT | stiffness not positive with contact unchanged, or newly singular | prescribed displacements |
!! | LIMIT POINT ... first at node | the last contact subproblems remained unsolved | prescribed displacements, damping |
!! | SLOW | none of these | smaller increments |
module amontons_failure_report
  use amontons_kinds, only: DP
  use amontons_failure, only: failure_type, family_of, FAILURE_NONE, FAILURE_MATERIAL, FAILURE_SINGULAR, FAILURE_NOT_FINITE, &
    FAILURE_CONSTRAINTS, FAILURE_FREE_PUSHED, FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, FAILURE_FREE_MOTION, FAILURE_LEFT_MASTER, &
    FAILURE_CYCLE, FAILURE_FLIP, FAILURE_UNSETTLED, FAILURE_PASSED_THROUGH, FAILURE_DEEP, FAILURE_LIMIT_POINT, &
    FAILURE_CONTACT_LIMIT, FAILURE_GROWING, FAILURE_SLOW, FAMILY_FREE_BODY, FAMILY_LEFT_MASTER, FAMILY_PENETRATION, &
    FAMILY_LIMIT_POINT, FAMILY_MATERIAL, FAMILY_SLOW
  use amontons_failure_messages, only: failure_name, remedy_words, node_list, is_same_failure
  use amontons_iteration_records, only: increment_record_type, REPORT_LINE_LENGTH
  use amontons_element_kinds, only: has_modes, MAX_ELEMENT_AMPLITUDES
  use amontons_model, only: model_type
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_EXTENDED
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_text, only: to_text
  use amontons_model_check_bodies, only: bodies_type, find_bodies, body_name
  use amontons_model_check_motion, only: find_free_motion
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_pairs, only: current_row
  use amontons_active_set_history, only: most_constrained_status, find_cycle, cycling_slaves, is_stick_slip_flip, &
    slaves_off_master, suddenly_deep_slaves, status_trace
  use amontons_convergence, only: VERDICT_DIVERGES
  use amontons_creep_accuracy, only: check_creep
  use amontons_globalization, only: is_repeatedly_unsolved, STEP_KIND_NEWTON
  use amontons_newton, only: newton_type
  use amontons_equilibrium, only: equilibrium_type, OUTCOME_OK, OUTCOME_ELEMENT, OUTCOME_LINEAR_SOLVER, OUTCOME_NOT_FINITE, &
    OUTCOME_UNSUPPORTED, OUTCOME_TUNNELLING, OUTCOME_CONSTRAINTS
  implicit none
  private
  public :: find_failure, describe_failure, summarize_attempts, describe_edge_events, describe_events, is_always_unsupported

  real(DP), parameter :: MAX_HOURGLASS_FLOW = 0.05_DP    !< of the work of an increment: more is said [-]
  integer, parameter :: N_WORST_NODES = 10               !< nodes listed
  integer, parameter :: N_MODE_NODES = 5                 !< nodes listed of a mode, or of the contact of an element

contains

  !> Finds the cause of a failed attempt.
  function find_failure(model, system, state, newton, verdict) result(failure)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    integer, intent(in) :: verdict                 !< VERDICT_... of the last iteration
    type(failure_type) :: failure
    logical :: is_unsupported                             ! proximal steps failed, and supports alone do not hold all bodies
    is_unsupported = newton%farthest_node > 0 .and. (newton%globalization%n_proximal > newton%globalization%n_snap_through &
      .or. newton%outcome == OUTCOME_UNSUPPORTED)
    if (has_inertia(model, state)) is_unsupported = .false.
    if (is_unsupported) is_unsupported = .not. is_held_by_supports(model, system, state)
    if (is_unsupported .and. newton%globalization%step_kind /= STEP_KIND_NEWTON .and. newton%globalization%n_snap_through == 0 &
      .and. &
      any(newton%outcome == [OUTCOME_OK, OUTCOME_LINEAR_SOLVER])) then
      failure = unsupported_body_sentence(model, state, newton)
      return
    end if
    select case (newton%outcome)
    case (OUTCOME_ELEMENT)
      failure = failure_type(FAILURE_MATERIAL, [model%mesh%element_label(max(1, system%failed_element))])
    case (OUTCOME_LINEAR_SOLVER)
      failure%code = FAILURE_SINGULAR
      if (state%old%total_time > 0.0_DP .and. system%n_shifted > newton%n_shifted) failure%code = FAILURE_LIMIT_POINT
      if (size(state%new%slaves) == 0 .or. any(state%new%slaves%status /= STATUS_OPEN)) return
      if (.not. is_held_by_supports(model, system, state)) failure%code = FAILURE_FREE_OPEN
    case (OUTCOME_CONSTRAINTS)
      failure%code = FAILURE_CONSTRAINTS
      failure%detail = system%conflict%message
    case (OUTCOME_NOT_FINITE)
      failure%code = FAILURE_NOT_FINITE
    case (OUTCOME_UNSUPPORTED)
      failure = failure_type(FAILURE_FREE_FLYING, [model%mesh%node_label(max(1, newton%farthest_node))])
      if (.not. is_unsupported) failure = failure_type(FAILURE_LIMIT_POINT)
    case (OUTCOME_TUNNELLING)
      failure = failure_type(FAILURE_PASSED_THROUGH, [model%mesh%node_label(newton%tunnelled_node)])
    case default
      failure = failure_of_iterations(model, system, state, newton, is_unsupported)
      if (failure%code == FAILURE_NONE) failure%code = merge(FAILURE_GROWING, FAILURE_SLOW, verdict == VERDICT_DIVERGES)
    end select
  end function find_failure


  !> Whether inertia holds all bodies.
  pure logical function has_inertia(model, state)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    has_inertia = .false.
    if (state%new%step > 0) has_inertia = model%steps(state%new%step)%is_dynamic
  end function has_inertia


  !> Cause of non-convergence where all iterations could be evaluated; FAILURE_NONE if unknown.
  function failure_of_iterations(model, system, state, newton, is_unsupported) result(failure)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    logical, intent(in) :: is_unsupported                 !< proximal steps failed, and supports alone do not hold all bodies
    type(failure_type) :: failure
    failure = failure_of_contact(model, system, state, newton)
    if (is_repeatedly_unsolved(newton%globalization) .and. newton%n_ascent_directions <= 1 .and. &
      all(family_of(failure) /= [FAMILY_LEFT_MASTER, FAMILY_PENETRATION])) failure = diagnose_contact_limit(model, system, state)
    if (failure%code == FAILURE_NONE .and. (system%n_shifted > newton%n_shifted .or. newton%n_ascent_directions > 1 .or. &
      newton%globalization%n_proximal > newton%globalization%n_snap_through)) failure%code = FAILURE_LIMIT_POINT
    if (is_unsupported .and. (family_of(failure) /= FAMILY_LEFT_MASTER .or. newton%measures%n_approaching > 1)) &
      failure = unsupported_body_sentence(model, state, newton)
    if (has_inertia(model, state)) return
    if (all(family_of(failure) /= [FAMILY_FREE_BODY, FAMILY_LEFT_MASTER, FAMILY_PENETRATION])) &
      call diagnose_free_motion(model, system, state, newton, failure)
  end function failure_of_iterations


  !> Whether all bodies are supported without contact. Large displacements then come from a stiffness that is not positive.
  logical function is_held_by_supports(model, system, state) result(is_supported)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(slave_state_type) :: open_slaves(size(state%new%slaves))
    character(:), allocatable :: unused
    logical :: is_free
    open_slaves = state%new%slaves
    open_slaves%status = STATUS_OPEN
    call find_free_motion(model, system%contact, open_slaves, state%new%step, is_free, unused)
    is_supported = .not. is_free
  end function is_held_by_supports


  !> Limit point of contact: the closed nodes where contact is lost first, if any.
  function diagnose_contact_limit(model, system, state) result(failure)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(failure_type) :: failure
    failure = failure_type(FAILURE_CONTACT_LIMIT, labels_of(model, state%new%slaves, unbalanced_slaves(system, state)), &
      n_slipping=n_all_slipping(state))
  end function diagnose_contact_limit


  !> A body that even the most constrained contact of the last iterations leaves free is the cause, whatever the statuses did.
  subroutine diagnose_free_motion(model, system, state, newton, failure)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    type(failure_type), intent(inout) :: failure
    character(:), allocatable :: motion
    type(slave_state_type) :: constrained_slaves(size(state%new%slaves))
    integer :: s
    logical :: is_free
    if (size(constrained_slaves) == 0 .or. .not. allocated(newton%active_set_history%status)) return
    constrained_slaves = state%new%slaves
    do s = 1, size(constrained_slaves)
      call most_constrained_status(newton%active_set_history, s, constrained_slaves(s)%status, constrained_slaves(s)%facet)
    end do
    call find_free_motion(model, system%contact, constrained_slaves, state%new%step, is_free, motion)
    if (.not. is_free) return
    failure = failure_type(FAILURE_FREE_MOTION)
    failure%detail = motion
  end subroutine diagnose_free_motion


  !> Failure of a body that needed proximal steps until the end.
  function unsupported_body_sentence(model, state, newton) result(failure)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    type(failure_type) :: failure
    failure = failure_type(FAILURE_FREE_PUSHED, [model%mesh%node_label(newton%farthest_node)], n_slipping=n_all_slipping(state))
  end function unsupported_body_sentence


  !> Number of closed slave nodes if there are several and all slip; else 0.
  pure integer function n_all_slipping(state) result(n)
    type(state_type), intent(in) :: state
    n = count(state%new%slaves%status == STATUS_SLIP)
    if (n == 1 .or. any(state%new%slaves%status == STATUS_STICK)) n = 0
  end function n_all_slipping


  !> Cause within contact; FAILURE_NONE if contact is not the cause.
  function failure_of_contact(model, system, state, newton) result(failure)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    type(failure_type) :: failure
    integer, allocatable :: slaves(:)
    integer :: length
    if (size(state%new%slaves) == 0) return
    slaves = slaves_off_master(state%old%slaves, state%new%slaves)
    length = find_cycle(newton%active_set_history)
    if (size(slaves) > 0 .and. length == 0) then
      failure%code = FAILURE_LEFT_MASTER
    else if (length > 0) then
      slaves = cycling_slaves(newton%active_set_history, length)
      failure%code = merge(FAILURE_FLIP, FAILURE_CYCLE, is_stick_slip_flip(newton%active_set_history, length, slaves))
      failure%length = length
    else
      slaves = suddenly_deep_slaves(newton%active_set_history, state%new%slaves, system%contact%edge)
      if (size(slaves) > 0) then
        failure%code = FAILURE_DEEP
      else if (system%contact%n_changed > 0) then
        slaves = cycling_slaves(newton%active_set_history, 2)
        failure%code = FAILURE_UNSETTLED
      end if
    end if
    failure%labels = labels_of(model, state%new%slaves, slaves)
  end function failure_of_contact


  !> Closed slave nodes with at least half of their largest imbalance.
  function unbalanced_slaves(system, state) result(slaves)
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    integer, allocatable :: slaves(:)              !< indices
    real(DP) :: imbalance(size(state%new%slaves))    ! [force]
    integer :: s
    imbalance = [(norm2(system%residual(:, state%new%slaves(s)%node)), s=1, size(imbalance))]
    where (state%new%slaves%status == STATUS_OPEN) imbalance = 0.0_DP
    slaves = pack([(s, s=1, size(imbalance))], imbalance > 0.0_DP .and. imbalance >= 0.5_DP * maxval(imbalance))
  end function unbalanced_slaves


  !> The labels of the nodes of some slaves.
  pure function labels_of(model, all_slaves, slaves) result(labels)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: all_slaves(:)
    integer, intent(in) :: slaves(:)               !< indices
    integer :: labels(size(slaves))
    labels = model%mesh%node_label(all_slaves(slaves)%node)
  end function labels_of


  !> Failure report: the ten worst nodes with their contact status in the last iterations, and the remedy.
  function describe_failure(model, system, state, newton, failure) result(lines)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    type(failure_type), intent(in) :: failure      !< of find_failure
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    character(REPORT_LINE_LENGTH) :: line
    real(DP), allocatable :: imbalance(:)
    integer :: i, n
    allocate (lines(0))
    if (newton%outcome /= OUTCOME_ELEMENT) then
      write (line, '(a,i0,a,es10.3,a,es10.3,a)') 'After ', newton%measures%iteration, &
        ' iterations the largest imbalance is ', max(newton%measures%residual(0), newton%measures%residual_at_gap), &
        ' of the largest force, the correction ', newton%measures%correction(0), '.'
      lines = [line, [character(REPORT_LINE_LENGTH) :: 'Nodes with the largest imbalance:']]
      imbalance = norm2(system%residual, dim=1)
      do i = 1, min(N_WORST_NODES, model%mesh%n_nodes)
        n = maxloc(imbalance, dim=1)
        if (imbalance(n) <= 0.0_DP) exit
        write (line, '(a,i0,a,es10.3,a)') '  node ', model%mesh%node_label(n), ': imbalance ', imbalance(n), &
          contact_text(model, state, newton, n)
        lines = [lines, line]
        imbalance(n) = -1.0_DP
      end do
    end if
    select case (family_of(failure))
    case (FAMILY_FREE_BODY)
      lines = [lines, describe_bodies(model, state)]
    case (FAMILY_LIMIT_POINT)
      lines = [lines, describe_mode(model, newton)]
    case (FAMILY_MATERIAL)
      lines = [lines, describe_pressure(model, system, state)]
    end select
    line = 'Remedy: ' // remedy_words(failure)
    if (system%may_soften .and. any(family_of(failure) == [FAMILY_SLOW, FAMILY_LIMIT_POINT])) then
      line = 'Remedy: a viscosity of the damage (*SECTION CONTROLS, VISCOSITY) of a thousandth of the step or less, more elements'
      lines = [lines, line]
      line = '  along the cohesive zone, or a lower strength of the cohesive law.'
    else if (any(model%materials%cutoff_sign /= 0) .and. any(family_of(failure) == [FAMILY_SLOW, FAMILY_LIMIT_POINT])) then
      line = 'Remedy: the size of increments does not matter to *NO TENSION and *NO COMPRESSION. Take Abaqus''s criteria and more'
      lines = [lines, line]
      line = '  iterations (*CONTROLS, PARAMETERS=FIELD: 5e-3, 1e-2; PARAMETERS=TIME INCREMENTATION: 40, 40, , 60), not C3D8I.'
    else if (any(model%materials%cutoff_sign /= 0) .and. family_of(failure) == FAMILY_MATERIAL .and. &
      any(has_modes(model%mesh%kind))) then
      line = 'Remedy: the incompatible modes of C3D8I, CPS4I, CPE4I and CAX4I often have no solution with *NO TENSION and'
      lines = [lines, line]
      line = '  *NO COMPRESSION. Take C3D8, C3D8R or C3D20R, in the plane CPS4, CPE4, CAX4; B32 in place of B31.'
    end if
    lines = [lines, line]
  end function describe_failure


  !> The bodies that moved farthest in the attempt, at least half as far as the farthest: distance, and their closed slave nodes.
  function describe_bodies(model, state) result(lines)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    character(REPORT_LINE_LENGTH) :: line
    type(bodies_type) :: bodies
    real(DP), allocatable :: distance(:)           ! (n_bodies) [length]
    integer, allocatable :: slave_body(:)
    integer :: b, i, n
    call find_bodies(model, model%equations, state%new%step, bodies)
    allocate (lines(0), distance(bodies%n))
    distance = 0.0_DP
    do i = 1, model%mesh%n_nodes
      b = bodies%of_node(i)
      if (b > 0) distance(b) = max(distance(b), norm2(state%new%u(:, i) - state%old%u(:, i)))
    end do
    if (bodies%n < 2 .or. .not. maxval(distance) > 0.0_DP) return
    slave_body = bodies%of_node(state%new%slaves%node)
    n = count(distance >= 0.5_DP * maxval(distance))
    lines = [character(REPORT_LINE_LENGTH) :: 'Bodies that moved farthest in this attempt (' // to_text(n) // '):']
    do i = 1, min(N_WORST_NODES, n)
      b = maxloc(distance, dim=1)
      write (line, '(3a,es10.3,4a)') '  ', body_name(model, bodies%list(b)), ': ', distance(b), ', closed slave nodes: ', &
        to_text(count(slave_body == b .and. state%new%slaves%status /= STATUS_OPEN)), ' of ', to_text(count(slave_body == b))
      lines = [lines, line]
      distance(b) = -1.0_DP
    end do
  end function describe_bodies


  !> The mode of a limit point: the direction of the last step, which the softest motion dominates near a singular tangent; its
  !! largest nodes, over the largest displacement.
  function describe_mode(model, newton) result(lines)
    type(model_type), intent(in) :: model
    type(newton_type), intent(in) :: newton
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    character(REPORT_LINE_LENGTH) :: line
    real(DP), allocatable :: length(:)             ! (n_nodes) [length]
    real(DP) :: largest
    integer :: i, n
    allocate (lines(0))
    if (.not. allocated(newton%direction)) return
    length = norm2(newton%direction, dim=1)
    where (model%mesh%is_auxiliary) length = 0.0_DP
    largest = maxval(length)
    if (.not. (largest > 0.0_DP .and. largest <= huge(1.0_DP))) return
    lines = [character(REPORT_LINE_LENGTH) :: 'Mode (direction of the last step over its largest displacement):']
    do i = 1, min(N_MODE_NODES, size(length))
      n = maxloc(length, dim=1)
      if (length(n) <= 0.0_DP) exit
      write (line, '(a,i0,a,3f7.3)') '  node ', model%mesh%node_label(n), ': ', newton%direction(:, n) / largest
      lines = [lines, line]
      length(n) = 0.0_DP
    end do
  end function describe_mode


  !> The contact that presses an inverted element: the closed slave nodes whose forces act on its nodes.
  function describe_pressure(model, system, state) result(lines)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state          !< at the failed evaluation: statuses are those before it
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    character(REPORT_LINE_LENGTH) :: line
    type(contact_row_type) :: row
    integer :: s, e, i
    allocate (lines(0))
    e = system%failed_element
    if (e < 1) return
    associate (nodes => model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1), slaves => state%new%slaves)
      do s = 1, size(slaves)
        if (slaves(s)%status == STATUS_OPEN .or. slaves(s)%facet == 0) cycle
        call current_row(system%contact, slaves(s), row)
        if (.not. any([(any(nodes == row%nodes(i)), i=1, size(row%nodes))])) cycle
        write (line, '(a,i0,3a,es10.3)') '  slave node ', model%mesh%node_label(slaves(s)%node), ' of pair ', &
          trim(model%pairs(slaves(s)%pair)%name), ': force ', norm2(slaves(s)%force)
        lines = [lines, line]
        if (size(lines) == N_MODE_NODES) exit
      end do
    end associate
    if (size(lines) > 0) lines = [character(REPORT_LINE_LENGTH) :: 'Contact presses the element:', lines, &
      'There a finer mesh, C3D8I, a hybrid or reduced element, or *STATIC, STABILIZE may help.']
  end function describe_pressure


  !> Failures of the attempts at the last increment in one line; empty for a single attempt. Consecutive equal ones appear once.
  function summarize_attempts(records) result(line)
    type(increment_record_type), intent(in) :: records(:)   !< the last one is of the last attempt
    character(REPORT_LINE_LENGTH) :: line
    integer :: i, n, before
    line = ''
    before = 0
    n = size(records)
    if (n < 2) return
    if (records(n)%attempt < 2) return
    do i = max(1, n - records(n)%attempt + 1), n
      if (records(i)%failure%code == FAILURE_NONE) cycle
      if (before > 0) then
        if (is_same_failure(records(before)%failure, records(i)%failure)) cycle
      end if
      line = trim(line) // ', ' // failure_name(records(i)%failure)
      before = i
    end do
    line = 'Its attempts failed by ' // trim(line(3:)) // '.'
  end function summarize_attempts


  !> Whether the last n_attempts attempts at an increment, each shorter, all failed by a free body.
  pure logical function is_always_unsupported(records, n_attempts) result(is_free)
    type(increment_record_type), intent(in) :: records(:)   !< the last one is of the last attempt
    integer, intent(in) :: n_attempts              !< max_unsupported_attempts of the controls
    integer :: i, n
    n = size(records)
    is_free = n >= n_attempts
    if (is_free) is_free = records(n)%attempt >= n_attempts
    if (.not. is_free) return
    do i = n - n_attempts + 1, n
      is_free = is_free .and. family_of(records(i)%failure) == FAMILY_FREE_BODY
    end do
  end function is_always_unsupported


  !> Report after an increment: slave nodes that left their master in it, or for which its edge was extended; empty if none.
  function describe_edge_events(model, state) result(lines)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state          !< converged, not yet committed
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    integer, allocatable :: slaves(:)
    integer :: s
    allocate (lines(0))
    if (size(state%new%slaves) == 0) return
    slaves = pack([(s, s=1, size(state%new%slaves))], state%new%slaves%overrides%edge == NODE_OVERRIDE_EXTENDED .and. &
      state%old%slaves%overrides%edge /= NODE_OVERRIDE_EXTENDED)
    if (size(slaves) > 0) lines = [character(REPORT_LINE_LENGTH) :: 'Slave ' // node_list(labels_of(model, state%new%slaves, &
      slaves)) // &
      ' left the master and returned in a cycle: the facet at its edge is extended for them.']
    slaves = slaves_off_master(state%old%slaves, state%new%slaves)
    if (size(slaves) > 0) lines = [character(REPORT_LINE_LENGTH) :: lines, 'Slave ' // &
      node_list(labels_of(model, state%new%slaves, slaves)) // ' ran off the master surface in this increment: nothing ' // &
      'holds them there.']
  end function describe_edge_events


  !> What is said of a converged increment: slave nodes beyond an edge, and hourglass stresses that the law does not hold.
  function describe_events(model, state) result(lines)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state          !< converged, not yet committed, its works summed
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    type(failure_type) :: unused
    real(DP) :: missed, taken, ratio
    lines = describe_edge_events(model, state)
    associate (step => model%steps(max(1, state%new%step)))
      if (step%is_direct) then
        call check_creep(model, step, state, ratio, unused)
        if (ratio > 1) lines = [character(REPORT_LINE_LENGTH) :: lines, '*WARNING: the creep strains by the conditions at the ' // &
          'end and at the start of the increment differ by ' // to_text(0.01_DP * real(nint(100 * ratio), DP)) // ' CETOL; ' // &
          'DIRECT keeps its length.']
      end if
    end associate
    associate (old => state%old, new => state%new)
      if (size(new%modes) == 0) return
      missed = sum(new%modes(MAX_ELEMENT_AMPLITUDES, :) - old%modes(MAX_ELEMENT_AMPLITUDES, :))
      taken = abs(new%plastic_work - old%plastic_work) + abs(new%strain_energy - old%strain_energy)
    end associate
    if (missed > MAX_HOURGLASS_FLOW * taken) lines = [character(REPORT_LINE_LENGTH) :: lines, '*WARNING: one-point elements ' // &
      'had hourglass stresses that the material does not hold; their work is ' // to_text(nint(100 * missed / taken)) // &
      ' % of that of this increment.', &
      'Take smaller increments, more elements across the bending, or C3D8I, CPS4I, CPE4I, CAX4I.']
  end function describe_events


  !> Contact of a node: pair, gap, and status in the last iterations.
  function contact_text(model, state, newton, node) result(sentence)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    integer, intent(in) :: node
    character(:), allocatable :: sentence
    character(10) :: gap
    integer :: s
    sentence = ''
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%node /= node) cycle
        write (gap, '(es10.3)') slave%gap
        sentence = ', pair ' // model%pairs(slave%pair)%name // ', gap ' // trim(adjustl(gap)) // ': ' // &
          trim(status_trace(newton%active_set_history, s))
      end associate
    end do
  end function contact_text

end module amontons_failure_report
