!> Failure: why an increment did not converge: the reason, the worst nodes, and what a person can do.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! | reason | found by | advice |
!! |---|---|---|
!! | MATERIAL | an element turned inside out, or a material gave no answer | smaller increments |
!! | LINEAR SOLVER | no direction, or a force that is not finite | constraints, numbers of the deck |
!! | FREE BODY | a direction of many times the size of the model, and supports alone do not hold all bodies | supports |
!! | LEFT MASTER | closed slave nodes ran off their master | a larger master |
!! | CYCLE, STICK-SLIP FLIP | the hash of all slave nodes returns | smaller increments, a finer master |
!! | PENETRATION JUMP | a slave node went deep inside at once | smaller increments |
!! | LIMIT POINT | the stiffness is not positive while contact rests, or is singular and was not before | drive by displacement |
!! | LIMIT POINT ... first at node | contact does not settle along the last directions | drive by displacement, damp |
!! | SLOW | none of these | smaller increments |
module amontons_failure_report
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_iteration_records, only: increment_record_type, REPORT_LINE_LENGTH
  use amontons_model, only: model_type
  use amontons_node_overrides, only: NODE_OVERRIDE_EXTENDED
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_model_check_motion, only: describe_free_motion
  use amontons_active_set_history, only: most_constrained_status, find_cycle, cycling_slaves, is_stick_slip_flip, &
    slaves_off_master, suddenly_deep_slaves, status_trace
  use amontons_convergence, only: VERDICT_DIVERGES
  use amontons_globalization, only: is_repeatedly_unsolved, STEP_KIND_NEWTON
  use amontons_newton, only: newton_type
  use amontons_equilibrium, only: equilibrium_type, OUTCOME_OK, OUTCOME_ELEMENT, OUTCOME_LINEAR_SOLVER, OUTCOME_NOT_FINITE, &
    OUTCOME_UNSUPPORTED, OUTCOME_TUNNELLING
  implicit none
  private
  public :: diagnose_failure, describe_failure, summarize_attempts, describe_edge_events, is_always_unsupported

  integer, parameter :: N_WORST_NODES = 10               !< nodes listed
  integer, parameter :: MAX_NAMED_NODES = 8                !< nodes named in the reason
  integer, parameter :: MIN_UNSUPPORTED_ATTEMPTS = 4                 !< attempts that find a free body, each shorter: the next
                                                                     !! would not hold it
  character(*), parameter :: LIMIT_POINT_SENTENCE = 'LIMIT POINT: the stiffness is not positive: the structure buckles, snaps ' // &
    'through, or softens.'

contains

  !> One sentence: why the attempt failed. It begins with a word in capitals that programs can look for.
  function diagnose_failure(model, system, state, newton, verdict) result(reason)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    integer, intent(in) :: verdict                 !< VERDICT_... of the last iteration
    character(:), allocatable :: reason
    logical :: is_unsupported                             ! a body was carried in vain, and supports alone do not hold all bodies
    is_unsupported = newton%farthest_node > 0 .and. (newton%globalization%n_proximal > newton%globalization%n_snap_through &
      .or. newton%outcome == OUTCOME_UNSUPPORTED)
    if (is_unsupported) is_unsupported = .not. is_held_by_supports(model, system, state)
    if (is_unsupported .and. newton%globalization%step_kind /= STEP_KIND_NEWTON .and. newton%globalization%n_snap_through == 0 &
      .and. &
      any(newton%outcome == [OUTCOME_OK, OUTCOME_LINEAR_SOLVER])) then
      reason = unsupported_body_sentence(model, state, newton)
      return
    end if
    select case (newton%outcome)
    case (OUTCOME_ELEMENT)
      reason = 'MATERIAL: element ' // to_text(model%mesh%element_label(max(1, system%failed_element))) // &
        ' turned inside out, or its material found no answer.'
    case (OUTCOME_LINEAR_SOLVER)
      reason = 'LINEAR SOLVER: the stiffness matrix is singular: a body is free to move, or the structure has buckled.'
      if (state%old%total_time > 0.0_DP .and. system%n_shifted > newton%n_shifted) reason = LIMIT_POINT_SENTENCE   ! it was stable
                                                                                                                   ! before
      if (size(state%new%slaves) > 0 .and. all(state%new%slaves%status == STATUS_OPEN)) reason = &
        'FREE BODY: no slave node touches its master any more, and nothing else holds a body.'
    case (OUTCOME_NOT_FINITE)
      reason = 'LINEAR SOLVER: a force is not finite.'
    case (OUTCOME_UNSUPPORTED)
      reason = 'FREE BODY: nothing holds a body against its load; it would fly off at node ' // &
        to_text(model%mesh%node_label(max(1, newton%farthest_node))) // '.'
      if (.not. is_unsupported) reason = LIMIT_POINT_SENTENCE
    case (OUTCOME_TUNNELLING)
      reason = 'PENETRATION JUMP: node ' // to_text(model%mesh%node_label(newton%tunnelled_node)) // &
        ' passed through its master within the increment.'
    case default
      reason = diagnose_contact(model, system, state, newton)
      if (is_repeatedly_unsolved(newton%globalization) .and. newton%n_ascent_directions <= 1 .and. index(reason, &
        'LEFT') == 0 .and. index(reason, 'PENE') == 0) &
        reason = diagnose_contact_limit(model, system, state)
      if (reason == '' .and. (system%n_shifted > newton%n_shifted .or. newton%n_ascent_directions > 1 .or. &
        newton%globalization%n_proximal > newton%globalization%n_snap_through)) reason = LIMIT_POINT_SENTENCE
      if (is_unsupported .and. index(reason, 'LEFT') == 0) reason = unsupported_body_sentence(model, state, newton)
      if (index(reason, 'FREE') == 0 .and. index(reason, 'LEFT') == 0 .and. index(reason, 'PENE') == 0) &
        call diagnose_free_motion(model, system, state, newton, reason)
      if (reason == '' .and. verdict == VERDICT_DIVERGES) &
        reason = 'SLOW: the force imbalance grows from iteration to iteration.'
      if (reason == '') reason = 'SLOW: the force imbalance does not fall any more.'
    end select
  end function diagnose_failure


  !> Whether no body could move if nothing touched: one that seems to fly off is led there by a stiffness that is not positive.
  logical function is_held_by_supports(model, system, state) result(is_supported)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(slave_state_type) :: open_slaves(size(state%new%slaves))
    open_slaves = state%new%slaves
    open_slaves%status = STATUS_OPEN
    is_supported = describe_free_motion(model, system%contact, open_slaves, state%new%step) == ''
  end function is_held_by_supports


  !> Contact that finds no balance: where it lets go, if any node is still closed.
  function diagnose_contact_limit(model, system, state) result(reason)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    character(:), allocatable :: reason
    integer, allocatable :: slaves(:)
    reason = 'LIMIT POINT: contact finds no balance near by: it lets go faster than the bodies follow'
    slaves = unbalanced_slaves(system, state)
    if (size(slaves) > 0) reason = reason // ', first at ' // node_list(model, state%new%slaves, slaves)
    reason = reason // '.' // all_slip_sentence(state, 'if nothing else holds a body, friction does not.')
  end function diagnose_contact_limit


  !> A body that the contact of the last iterations does not hold is the reason, whatever the statuses did meanwhile.
  subroutine diagnose_free_motion(model, system, state, newton, reason)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(:), allocatable, intent(inout) :: reason
    character(:), allocatable :: motion
    type(slave_state_type) :: constrained_slaves(size(state%new%slaves))
    integer :: s
    if (size(constrained_slaves) == 0 .or. .not. allocated(newton%active_set_history%status)) return
    constrained_slaves = state%new%slaves
    do s = 1, size(constrained_slaves)
      call most_constrained_status(newton%active_set_history, s, constrained_slaves(s)%status, constrained_slaves(s)%facet)
    end do
    motion = describe_free_motion(model, system%contact, constrained_slaves, state%new%step)
    if (motion /= '') reason = 'FREE BODY: where contact is left, the ' // motion // ': nothing else holds it.'
  end subroutine diagnose_free_motion


  !> A body that had to be carried again and again.
  function unsupported_body_sentence(model, state, newton) result(reason)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(:), allocatable :: reason
    reason = 'FREE BODY: nothing holds a body against its load, wherever it goes; it went farthest at node ' // &
      to_text(model%mesh%node_label(newton%farthest_node)) // '.' // all_slip_sentence(state, 'friction does not hold it.')
  end function unsupported_body_sentence


  !> A sentence if all closed slave nodes slip; else nothing.
  function all_slip_sentence(state, consequence) result(sentence)
    type(state_type), intent(in) :: state
    character(*), intent(in) :: consequence               !< follows from it
    character(:), allocatable :: sentence
    integer :: n
    sentence = ''
    n = count(state%new%slaves%status == STATUS_SLIP)
    if (n > 1 .and. .not. any(state%new%slaves%status == STATUS_STICK)) sentence = ' All ' // to_text(n) // &
      ' closed slave nodes slip: ' // consequence
  end function all_slip_sentence


  !> A reason that contact gives; empty if it gives none.
  function diagnose_contact(model, system, state, newton) result(reason)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(:), allocatable :: reason
    integer, allocatable :: slaves(:)
    integer :: length
    reason = ''
    if (size(state%new%slaves) == 0) return
    slaves = slaves_off_master(state%old%slaves, state%new%slaves)
    length = find_cycle(newton%active_set_history)
    if (size(slaves) > 0 .and. length == 0) then
      reason = 'LEFT MASTER: ' // node_list(model, state%new%slaves, slaves) // ' ran off the master surface.'
      return
    end if
    if (length > 0) then
      slaves = cycling_slaves(newton%active_set_history, length)
      reason = 'CYCLE of length ' // to_text(length) // ' at ' // node_list(model, state%new%slaves, slaves) // '.'
      if (is_stick_slip_flip(newton%active_set_history, length, slaves)) reason = 'STICK-SLIP FLIP of length ' // to_text(length) &
        // ' at ' // &
        node_list(model, state%new%slaves, slaves) // '.'
      return
    end if
    slaves = suddenly_deep_slaves(newton%active_set_history, state%new%slaves, system%contact%edge)
    if (size(slaves) > 0) then
      reason = 'PENETRATION JUMP: ' // node_list(model, state%new%slaves, slaves) // ' went deep into the master at once.'
    else if (system%contact%n_changed > 0) then
      slaves = cycling_slaves(newton%active_set_history, 2)
      reason = 'CONTACT UNSETTLED: status or facet still changes at ' // node_list(model, state%new%slaves, slaves) // '.'
    end if
  end function diagnose_contact


  !> The closed slave nodes that are least in balance: those with at least half of the largest imbalance among them.
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


  !> The labels of slave nodes: the first of them, and how many more.
  function node_list(model, all_slaves, slaves) result(names)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: all_slaves(:)
    integer, intent(in) :: slaves(:)               !< indices
    character(:), allocatable :: names
    integer :: i
    names = 'node'
    if (size(slaves) /= 1) names = 'nodes'
    do i = 1, min(size(slaves), MAX_NAMED_NODES)
      if (i > 1) names = names // ','
      names = names // ' ' // to_text(model%mesh%node_label(all_slaves(slaves(i))%node))
    end do
    if (size(slaves) > MAX_NAMED_NODES) names = names // ' and ' // to_text(size(slaves) - MAX_NAMED_NODES) // ' more'
  end function node_list


  !> What a person can look at and do: the ten worst nodes with their contact in the last iterations, and one sentence.
  function describe_failure(model, system, state, newton, reason) result(lines)
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(*), intent(in) :: reason             !< of diagnose_failure
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    character(REPORT_LINE_LENGTH) :: line
    real(DP), allocatable :: imbalance(:)
    integer :: i, n
    allocate (lines(0))
    if (newton%outcome /= OUTCOME_ELEMENT) then
      write (line, '(a,i0,a,es10.3,a,es10.3,a)') 'After ', newton%measures%iteration, &
        ' iterations the largest imbalance is ', max(newton%measures%residual(0), newton%measures%residual_at_gap), &
        ' of the largest force, the correction ', newton%measures%correction, '.'
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
    line = 'Remedy: ' // remedy_for(reason)
    lines = [lines, line]
  end function describe_failure


  !> By what the attempts at the last increment failed, in a line; empty if there was one.
  function summarize_attempts(records) result(line)
    type(increment_record_type), intent(in) :: records(:)   !< the last one is of the last attempt
    character(REPORT_LINE_LENGTH) :: line
    character(:), allocatable :: reason, before
    integer :: i, n
    line = ''
    before = ''
    n = size(records)
    if (n < 2) return
    if (records(n)%attempt < 2) return
    do i = max(1, n - records(n)%attempt + 1), n
      if (.not. allocated(records(i)%reason)) cycle
      reason = records(i)%reason
      reason = trim(reason(:index(reason // ':', ':') - 1))
      reason = reason(:verify(reason, '.', back=.true.))
      if (reason /= before) line = trim(line) // ', ' // reason
      before = reason
    end do
    line = 'Its attempts failed by ' // trim(line(3:)) // '.'
  end function summarize_attempts


  !> Whether the last attempts at an increment, each shorter than the one before, all found a body that nothing holds.
  pure logical function is_always_unsupported(records) result(is_free)
    type(increment_record_type), intent(in) :: records(:)   !< the last one is of the last attempt
    integer :: i, n
    n = size(records)
    is_free = n >= MIN_UNSUPPORTED_ATTEMPTS
    if (is_free) is_free = records(n)%attempt >= MIN_UNSUPPORTED_ATTEMPTS
    if (.not. is_free) return
    do i = n - MIN_UNSUPPORTED_ATTEMPTS + 1, n
      is_free = is_free .and. index(records(i)%reason, 'FREE BODY') == 1
    end do
  end function is_always_unsupported


  !> What is told after an increment of slave nodes that ran off their master in it, or keep to its edge; nothing if there are none.
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
    if (size(slaves) > 0) lines = [character(REPORT_LINE_LENGTH) :: 'Slave ' // node_list(model, state%new%slaves, slaves) // &
      ' went off the master and back in a cycle: the facet at the edge reaches farther for them.']
    slaves = slaves_off_master(state%old%slaves, state%new%slaves)
    if (size(slaves) > 0) lines = [character(REPORT_LINE_LENGTH) :: lines, 'Slave ' // node_list(model, state%new%slaves, &
      slaves) // &
      ' ran off the master surface in this increment: nothing holds them there.']
  end function describe_edge_events


  !> What contact says of a node: pair, gap, and what it was in the last iterations.
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


  !> One sentence of advice for a reason.
  pure function remedy_for(reason) result(sentence)
    character(*), intent(in) :: reason
    character(:), allocatable :: sentence
    select case (reason(:index(reason // ' ', ' ') - 1))
    case ('MATERIAL:')
      sentence = 'smaller increments, a better shaped mesh there, or a smaller load.'
    case ('LINEAR')
      sentence = 'look for bodies or nodes that nothing holds, and for numbers in the deck that are out of scale.'
    case ('FREE')
      sentence = 'hold the body by supports, or let it touch from the start (ADJUST); friction alone holds only what is pressed.'
    case ('LEFT')
      sentence = 'make the master surface larger there, swap slave and master, or check the direction of the motion.'
    case ('CYCLE', 'STICK-SLIP', 'CONTACT')
      sentence = 'smaller increments (first and third number after *STATIC), or a master that is finer or smoother at these nodes.'
    case ('PENETRATION')
      sentence = 'smaller increments, so that a node moves less than half an edge of the master in each.'
    case ('LIMIT')
      sentence = 'prescribe displacements instead of forces beyond this load, or damp the step (*STATIC, STABILIZE).'
    case default
      sentence = 'smaller increments (the first number after *STATIC; the third is the least allowed).'
    end select
  end function remedy_for

end module amontons_failure_report
