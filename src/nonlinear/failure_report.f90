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
  use amontons_text, only: text_of
  use amontons_iteration_records, only: increment_record_type, STORY_LENGTH
  use amontons_model, only: model_type
  use amontons_node_overrides, only: NODE_OVERRIDE_EXTENDED
  use amontons_state, only: state_type, slave_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_model_check_motion, only: free_motion
  use amontons_active_set_history, only: most_held, find_cycle, cycle_nodes, is_flip, left_nodes, jumped_nodes, story_of
  use amontons_convergence, only: VERDICT_DIVERGES
  use amontons_globalization, only: is_lost, COURSE_NEWTON
  use amontons_newton, only: newton_type
  use amontons_equilibrium, only: system_type, TROUBLE_NONE, TROUBLE_ELEMENT, TROUBLE_SOLVER, TROUBLE_NOT_FINITE, &
    TROUBLE_FREE, TROUBLE_THROUGH
  implicit none
  private
  public :: failure_reason, failure_lines, failed_attempts, edge_lines, is_free_for_good

  integer, parameter :: N_WORST = 10               !< nodes listed
  integer, parameter :: N_NAMED = 8                !< nodes named in the reason
  integer, parameter :: N_FREE = 4                 !< attempts that find a free body, each shorter: the next would not hold it
  character(*), parameter :: LIMIT_POINT = 'LIMIT POINT: the stiffness is not positive: the structure buckles, snaps ' // &
    'through, or softens.'

contains

  !> One sentence: why the attempt failed. It begins with a word in capitals that programs can look for.
  function failure_reason(model, system, state, newton, verdict) result(reason)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    integer, intent(in) :: verdict                 !< VERDICT_... of the last iteration
    character(:), allocatable :: reason
    logical :: is_away                             ! a body was carried in vain, and supports alone do not hold all bodies
    is_away = newton%farthest > 0 .and. (newton%course%n_carried > newton%course%n_snapped .or. newton%trouble == TROUBLE_FREE)
    if (is_away) is_away = .not. is_held_by_supports(model, system, state)
    if (is_away .and. newton%course%now /= COURSE_NEWTON .and. newton%course%n_snapped == 0 .and. &
      any(newton%trouble == [TROUBLE_NONE, TROUBLE_SOLVER])) then
      reason = free_body(model, state, newton)
      return
    end if
    select case (newton%trouble)
    case (TROUBLE_ELEMENT)
      reason = 'MATERIAL: element ' // text_of(model%mesh%element_label(max(1, system%trouble_item))) // &
        ' turned inside out, or its material found no answer.'
    case (TROUBLE_SOLVER)
      reason = 'LINEAR SOLVER: the stiffness matrix is singular: a body is free to move, or the structure has buckled.'
      if (state%old%total_time > 0.0_DP .and. system%n_shifted > newton%n_shifted) reason = LIMIT_POINT   ! it was stable before
      if (size(state%new%slaves) > 0 .and. all(state%new%slaves%status == STATUS_OPEN)) reason = &
        'FREE BODY: no slave node touches its master any more, and nothing else holds a body.'
    case (TROUBLE_NOT_FINITE)
      reason = 'LINEAR SOLVER: a force is not finite.'
    case (TROUBLE_FREE)
      reason = 'FREE BODY: nothing holds a body against its load; it would fly off at node ' // &
        text_of(model%mesh%node_label(max(1, newton%farthest))) // '.'
      if (.not. is_away) reason = LIMIT_POINT
    case (TROUBLE_THROUGH)
      reason = 'PENETRATION JUMP: node ' // text_of(model%mesh%node_label(newton%gone_through)) // &
        ' passed through its master within the increment.'
    case default
      reason = contact_reason(model, system, state, newton)
      if (is_lost(newton%course) .and. newton%n_uphill <= 1 .and. index(reason, 'LEFT') == 0 .and. index(reason, 'PENE') == 0) &
        reason = limit_of_contact(model, system, state)
      if (reason == '' .and. (system%n_shifted > newton%n_shifted .or. newton%n_uphill > 1 .or. &
        newton%course%n_carried > newton%course%n_snapped)) reason = LIMIT_POINT
      if (is_away .and. index(reason, 'LEFT') == 0) reason = free_body(model, state, newton)
      if (index(reason, 'FREE') == 0 .and. index(reason, 'LEFT') == 0 .and. index(reason, 'PENE') == 0) &
        call look_for_free_motion(model, system, state, newton, reason)
      if (reason == '' .and. verdict == VERDICT_DIVERGES) &
        reason = 'SLOW: the force imbalance grows from iteration to iteration.'
      if (reason == '') reason = 'SLOW: the force imbalance does not fall any more.'
    end select
  end function failure_reason


  !> Whether no body could move if nothing touched: one that seems to fly off is led there by a stiffness that is not positive.
  logical function is_held_by_supports(model, system, state) result(is_held)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(slave_type) :: apart(size(state%new%slaves))
    apart = state%new%slaves
    apart%status = STATUS_OPEN
    is_held = free_motion(model, system%contact, apart, state%new%step) == ''
  end function is_held_by_supports


  !> Contact that finds no balance: where it lets go, if any node is still closed.
  function limit_of_contact(model, system, state) result(reason)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    character(:), allocatable :: reason
    integer, allocatable :: slaves(:)
    reason = 'LIMIT POINT: contact finds no balance near by: it lets go faster than the bodies follow'
    slaves = unbalanced_slaves(system, state)
    if (size(slaves) > 0) reason = reason // ', first at ' // names_of(model, state%new%slaves, slaves)
    reason = reason // '.' // all_slip(state, 'if nothing else holds a body, friction does not.')
  end function limit_of_contact


  !> A body that the contact of the last iterations does not hold is the reason, whatever the statuses did meanwhile.
  subroutine look_for_free_motion(model, system, state, newton, reason)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(:), allocatable, intent(inout) :: reason
    character(:), allocatable :: motion
    type(slave_type) :: held(size(state%new%slaves))
    integer :: s
    if (size(held) == 0 .or. .not. allocated(newton%forensics%status)) return
    held = state%new%slaves
    do s = 1, size(held)
      call most_held(newton%forensics, s, held(s)%status, held(s)%facet)
    end do
    motion = free_motion(model, system%contact, held, state%new%step)
    if (motion /= '') reason = 'FREE BODY: where contact is left, the ' // motion // ': nothing else holds it.'
  end subroutine look_for_free_motion


  !> A body that had to be carried again and again.
  function free_body(model, state, newton) result(reason)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(:), allocatable :: reason
    reason = 'FREE BODY: nothing holds a body against its load, wherever it goes; it went farthest at node ' // &
      text_of(model%mesh%node_label(newton%farthest)) // '.' // all_slip(state, 'friction does not hold it.')
  end function free_body


  !> A sentence if all closed slave nodes slip; else nothing.
  function all_slip(state, what) result(words)
    type(state_type), intent(in) :: state
    character(*), intent(in) :: what               !< follows from it
    character(:), allocatable :: words
    integer :: n
    words = ''
    n = count(state%new%slaves%status == STATUS_SLIP)
    if (n > 1 .and. .not. any(state%new%slaves%status == STATUS_STICK)) words = ' All ' // text_of(n) // &
      ' closed slave nodes slip: ' // what
  end function all_slip


  !> A reason that contact gives; empty if it gives none.
  function contact_reason(model, system, state, newton) result(reason)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(:), allocatable :: reason
    integer, allocatable :: slaves(:)
    integer :: length
    reason = ''
    if (size(state%new%slaves) == 0) return
    slaves = left_nodes(state%old%slaves, state%new%slaves)
    length = find_cycle(newton%forensics)
    if (size(slaves) > 0 .and. length == 0) then
      reason = 'LEFT MASTER: ' // names_of(model, state%new%slaves, slaves) // ' ran off the master surface.'
      return
    end if
    if (length > 0) then
      slaves = cycle_nodes(newton%forensics, length)
      reason = 'CYCLE of length ' // text_of(length) // ' at ' // names_of(model, state%new%slaves, slaves) // '.'
      if (is_flip(newton%forensics, length, slaves)) reason = 'STICK-SLIP FLIP of length ' // text_of(length) // ' at ' // &
        names_of(model, state%new%slaves, slaves) // '.'
      return
    end if
    slaves = jumped_nodes(newton%forensics, state%new%slaves, system%contact%edge)
    if (size(slaves) > 0) then
      reason = 'PENETRATION JUMP: ' // names_of(model, state%new%slaves, slaves) // ' went deep into the master at once.'
    else if (system%contact%n_changed > 0) then
      slaves = cycle_nodes(newton%forensics, 2)
      reason = 'CONTACT UNSETTLED: status or facet still changes at ' // names_of(model, state%new%slaves, slaves) // '.'
    end if
  end function contact_reason


  !> The closed slave nodes that are least in balance: those with at least half of the largest imbalance among them.
  function unbalanced_slaves(system, state) result(slaves)
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    integer, allocatable :: slaves(:)              !< indices
    real(DP) :: size_of(size(state%new%slaves))    ! [force]
    integer :: s
    size_of = [(norm2(system%residual(:, state%new%slaves(s)%node)), s=1, size(size_of))]
    where (state%new%slaves%status == STATUS_OPEN) size_of = 0.0_DP
    slaves = pack([(s, s=1, size(size_of))], size_of > 0.0_DP .and. size_of >= 0.5_DP * maxval(size_of))
  end function unbalanced_slaves


  !> The labels of slave nodes: the first of them, and how many more.
  function names_of(model, all_slaves, slaves) result(names)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: all_slaves(:)
    integer, intent(in) :: slaves(:)               !< indices
    character(:), allocatable :: names
    integer :: i
    names = 'node'
    if (size(slaves) /= 1) names = 'nodes'
    do i = 1, min(size(slaves), N_NAMED)
      if (i > 1) names = names // ','
      names = names // ' ' // text_of(model%mesh%node_label(all_slaves(slaves(i))%node))
    end do
    if (size(slaves) > N_NAMED) names = names // ' and ' // text_of(size(slaves) - N_NAMED) // ' more'
  end function names_of


  !> What a person can look at and do: the ten worst nodes with their contact in the last iterations, and one sentence.
  function failure_lines(model, system, state, newton, reason) result(lines)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    character(*), intent(in) :: reason             !< of failure_reason
    character(STORY_LENGTH), allocatable :: lines(:)
    character(STORY_LENGTH) :: line
    real(DP), allocatable :: size_of(:)
    integer :: i, n
    allocate (lines(0))
    if (newton%trouble /= TROUBLE_ELEMENT) then
      write (line, '(a,i0,a,es10.3,a,es10.3,a)') 'After ', newton%progress%iteration, &
        ' iterations the largest imbalance is ', max(newton%progress%residual(0), newton%progress%law), &
        ' of the largest force, the correction ', newton%progress%correction, '.'
      lines = [line, [character(STORY_LENGTH) :: 'Nodes with the largest imbalance:']]
      size_of = norm2(system%residual, dim=1)
      do i = 1, min(N_WORST, model%mesh%n_nodes)
        n = maxloc(size_of, dim=1)
        if (size_of(n) <= 0.0_DP) exit
        write (line, '(a,i0,a,es10.3,a)') '  node ', model%mesh%node_label(n), ': imbalance ', size_of(n), &
          contact_words(model, state, newton, n)
        lines = [lines, line]
        size_of(n) = -1.0_DP
      end do
    end if
    line = 'Remedy: ' // advice(reason)
    lines = [lines, line]
  end function failure_lines


  !> By what the attempts at the last increment failed, in a line; empty if there was one.
  function failed_attempts(records) result(line)
    type(increment_record_type), intent(in) :: records(:)   !< the last one is of the last attempt
    character(STORY_LENGTH) :: line
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
  end function failed_attempts


  !> Whether the last attempts at an increment, each shorter than the one before, all found a body that nothing holds.
  pure logical function is_free_for_good(records) result(is_free)
    type(increment_record_type), intent(in) :: records(:)   !< the last one is of the last attempt
    integer :: i, n
    n = size(records)
    is_free = n >= N_FREE
    if (is_free) is_free = records(n)%attempt >= N_FREE
    if (.not. is_free) return
    do i = n - N_FREE + 1, n
      is_free = is_free .and. index(records(i)%reason, 'FREE BODY') == 1
    end do
  end function is_free_for_good


  !> What is told after an increment of slave nodes that ran off their master in it, or keep to its edge; nothing if there are none.
  function edge_lines(model, state) result(lines)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state          !< converged, not yet committed
    character(STORY_LENGTH), allocatable :: lines(:)
    integer, allocatable :: slaves(:)
    integer :: s
    allocate (lines(0))
    if (size(state%new%slaves) == 0) return
    slaves = pack([(s, s=1, size(state%new%slaves))], state%new%slaves%overrides%edge == NODE_OVERRIDE_EXTENDED .and. &
      state%old%slaves%overrides%edge /= NODE_OVERRIDE_EXTENDED)
    if (size(slaves) > 0) lines = [character(STORY_LENGTH) :: 'Slave ' // names_of(model, state%new%slaves, slaves) // &
      ' went off the master and back in a cycle: the facet at the edge reaches farther for them.']
    slaves = left_nodes(state%old%slaves, state%new%slaves)
    if (size(slaves) > 0) lines = [character(STORY_LENGTH) :: lines, 'Slave ' // names_of(model, state%new%slaves, slaves) // &
      ' ran off the master surface in this increment: nothing holds them there.']
  end function edge_lines


  !> What contact says of a node: pair, gap, and what it was in the last iterations.
  function contact_words(model, state, newton, node) result(words)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    integer, intent(in) :: node
    character(:), allocatable :: words
    character(10) :: gap
    integer :: s
    words = ''
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%node /= node) cycle
        write (gap, '(es10.3)') slave%gap
        words = ', pair ' // model%pairs(slave%pair)%name // ', gap ' // trim(adjustl(gap)) // ': ' // &
          trim(story_of(newton%forensics, s))
      end associate
    end do
  end function contact_words


  !> One sentence of advice for a reason.
  pure function advice(reason) result(words)
    character(*), intent(in) :: reason
    character(:), allocatable :: words
    select case (reason(:index(reason // ' ', ' ') - 1))
    case ('MATERIAL:')
      words = 'smaller increments, a better shaped mesh there, or a smaller load.'
    case ('LINEAR')
      words = 'look for bodies or nodes that nothing holds, and for numbers in the deck that are out of scale.'
    case ('FREE')
      words = 'hold the body by supports, or let it touch from the start (ADJUST); friction alone holds only what is pressed.'
    case ('LEFT')
      words = 'make the master surface larger there, swap slave and master, or check the direction of the motion.'
    case ('CYCLE', 'STICK-SLIP', 'CONTACT')
      words = 'smaller increments (first and third number after *STATIC), or a master that is finer or smoother at these nodes.'
    case ('PENETRATION')
      words = 'smaller increments, so that a node moves less than half an edge of the master in each.'
    case ('LIMIT')
      words = 'prescribe displacements instead of forces beyond this load, or damp the step (*STATIC, STABILIZE).'
    case default
      words = 'smaller increments (the first number after *STATIC; the third is the least allowed).'
    end select
  end function advice

end module amontons_failure_report
