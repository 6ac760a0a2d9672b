!> Failure report: why an increment did not converge: the code of the failure, the worst nodes, and what a person can do.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Words of a failure are made in `failure_words`.
!!
!! | reason | found by | advice |
!! |---|---|---|
!! | MATERIAL | an element turned inside out, or a material gave no answer | smaller increments |
!! | LINEAR SOLVER | no direction, or a force that is not finite | constraints, numbers of the deck |
!! | CONSTRAINTS | constraints that follow the motion contradict each other | supports, equations |
!! | FREE BODY | a direction of many times the size of the model, and supports alone do not hold all bodies | supports |
!! | LEFT MASTER | closed slave nodes ran off their master | a larger master |
!! | CYCLE, STICK-SLIP FLIP | the hash of all slave nodes returns | smaller increments, a finer master |
!! | PENETRATION JUMP | a slave node went deep inside at once | smaller increments |
!! | LIMIT POINT | the stiffness is not positive while contact rests, or is singular and was not before | drive by displacement |
!! | LIMIT POINT ... first at node | contact does not settle along the last directions | drive by displacement, damp |
!! | SLOW | none of these | smaller increments |
module amontons_failure_report
  use amontons_kinds, only: DP
  use amontons_failure, only: failure_type, family_of, FAILURE_NONE, FAILURE_MATERIAL, FAILURE_SINGULAR, FAILURE_NOT_FINITE, &
    FAILURE_CONSTRAINTS, FAILURE_FREE_PUSHED, FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, FAILURE_FREE_MOTION, FAILURE_LEFT_MASTER, &
    FAILURE_CYCLE, FAILURE_FLIP, FAILURE_UNSETTLED, FAILURE_PASSED_THROUGH, FAILURE_DEEP, FAILURE_LIMIT_POINT, &
    FAILURE_CONTACT_LIMIT, FAILURE_GROWING, FAILURE_SLOW, FAMILY_FREE_BODY, FAMILY_LEFT_MASTER, FAMILY_PENETRATION
  use amontons_failure_words, only: failure_name, remedy_words, node_list, is_same_failure
  use amontons_iteration_records, only: increment_record_type, STORY_LENGTH
  use amontons_model, only: model_type
  use amontons_state, only: state_type, slave_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_model_check_motion, only: find_free_motion
  use amontons_active_set_history, only: most_held, find_cycle, cycle_nodes, is_flip, left_nodes, jumped_nodes, story_of
  use amontons_convergence, only: VERDICT_DIVERGES
  use amontons_globalization, only: is_lost, COURSE_NEWTON
  use amontons_newton, only: newton_type
  use amontons_equilibrium, only: system_type, TROUBLE_NONE, TROUBLE_ELEMENT, TROUBLE_SOLVER, TROUBLE_NOT_FINITE, &
    TROUBLE_FREE, TROUBLE_THROUGH, TROUBLE_CONSTRAINTS
  implicit none
  private
  public :: find_failure, failure_lines, failed_attempts, edge_lines, is_free_for_good

  integer, parameter :: N_WORST = 10               !< nodes listed
  integer, parameter :: N_FREE = 4                 !< attempts that find a free body, each shorter: the next would not hold it

contains

  !> Why the attempt failed.
  function find_failure(model, system, state, newton, verdict) result(failure)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    integer, intent(in) :: verdict                 !< VERDICT_... of the last iteration
    type(failure_type) :: failure
    logical :: is_away                             ! a body was carried in vain, and supports alone do not hold all bodies
    is_away = newton%farthest > 0 .and. (newton%course%n_carried > newton%course%n_snapped .or. newton%trouble == TROUBLE_FREE)
    if (is_away) is_away = .not. is_held_by_supports(model, system, state)
    if (is_away .and. newton%course%now /= COURSE_NEWTON .and. newton%course%n_snapped == 0 .and. &
      any(newton%trouble == [TROUBLE_NONE, TROUBLE_SOLVER])) then
      failure = free_body(model, state, newton)
      return
    end if
    select case (newton%trouble)
    case (TROUBLE_ELEMENT)
      failure = failure_type(FAILURE_MATERIAL, [model%mesh%element_label(max(1, system%trouble_item))])
    case (TROUBLE_SOLVER)
      failure%code = FAILURE_SINGULAR
      if (state%old%total_time > 0.0_DP .and. system%n_shifted > newton%n_shifted) failure%code = FAILURE_LIMIT_POINT
      if (size(state%new%slaves) > 0 .and. all(state%new%slaves%status == STATUS_OPEN)) failure%code = FAILURE_FREE_OPEN
    case (TROUBLE_CONSTRAINTS)
      failure%code = FAILURE_CONSTRAINTS
      failure%detail = system%conflict%message
    case (TROUBLE_NOT_FINITE)
      failure%code = FAILURE_NOT_FINITE
    case (TROUBLE_FREE)
      failure = failure_type(FAILURE_FREE_FLYING, [model%mesh%node_label(max(1, newton%farthest))])
      if (.not. is_away) failure = failure_type(FAILURE_LIMIT_POINT)
    case (TROUBLE_THROUGH)
      failure = failure_type(FAILURE_PASSED_THROUGH, [model%mesh%node_label(newton%gone_through)])
    case default
      failure = failure_of_iterations(model, system, state, newton, is_away)
      if (failure%code == FAILURE_NONE) failure%code = merge(FAILURE_GROWING, FAILURE_SLOW, verdict == VERDICT_DIVERGES)
    end select
  end function find_failure


  !> Why iterations without any trouble did not converge; FAILURE_NONE if nothing is known.
  function failure_of_iterations(model, system, state, newton, is_away) result(failure)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    logical, intent(in) :: is_away                 !< a body was carried in vain, and supports alone do not hold all bodies
    type(failure_type) :: failure
    failure = failure_of_contact(model, system, state, newton)
    if (is_lost(newton%course) .and. newton%n_uphill <= 1 .and. &
      all(family_of(failure) /= [FAMILY_LEFT_MASTER, FAMILY_PENETRATION])) failure = limit_of_contact(model, system, state)
    if (failure%code == FAILURE_NONE .and. (system%n_shifted > newton%n_shifted .or. newton%n_uphill > 1 .or. &
      newton%course%n_carried > newton%course%n_snapped)) failure%code = FAILURE_LIMIT_POINT
    if (is_away .and. family_of(failure) /= FAMILY_LEFT_MASTER) failure = free_body(model, state, newton)
    if (all(family_of(failure) /= [FAMILY_FREE_BODY, FAMILY_LEFT_MASTER, FAMILY_PENETRATION])) &
      call look_for_free_motion(model, system, state, newton, failure)
  end function failure_of_iterations


  !> Whether no body could move if nothing touched: one that seems to fly off is led there by a stiffness that is not positive.
  logical function is_held_by_supports(model, system, state) result(is_held)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(slave_type) :: apart(size(state%new%slaves))
    character(:), allocatable :: unused
    logical :: is_free
    apart = state%new%slaves
    apart%status = STATUS_OPEN
    call find_free_motion(model, system%contact, apart, state%new%step, is_free, unused)
    is_held = .not. is_free
  end function is_held_by_supports


  !> Contact that finds no balance: where it lets go, if any node is still closed.
  function limit_of_contact(model, system, state) result(failure)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(failure_type) :: failure
    failure = failure_type(FAILURE_CONTACT_LIMIT, labels_of(model, state%new%slaves, unbalanced_slaves(system, state)), &
      n_slipping=n_all_slipping(state))
  end function limit_of_contact


  !> A body that the contact of the last iterations does not hold is the reason, whatever the statuses did meanwhile.
  subroutine look_for_free_motion(model, system, state, newton, failure)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    type(failure_type), intent(inout) :: failure
    character(:), allocatable :: motion
    type(slave_type) :: held(size(state%new%slaves))
    integer :: s
    logical :: is_free
    if (size(held) == 0 .or. .not. allocated(newton%forensics%status)) return
    held = state%new%slaves
    do s = 1, size(held)
      call most_held(newton%forensics, s, held(s)%status, held(s)%facet)
    end do
    call find_free_motion(model, system%contact, held, state%new%step, is_free, motion)
    if (.not. is_free) return
    failure = failure_type(FAILURE_FREE_MOTION)
    failure%detail = motion
  end subroutine look_for_free_motion


  !> A body that had to be carried again and again.
  function free_body(model, state, newton) result(failure)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    type(failure_type) :: failure
    failure = failure_type(FAILURE_FREE_PUSHED, [model%mesh%node_label(newton%farthest)], n_slipping=n_all_slipping(state))
  end function free_body


  !> The number of closed slave nodes, if there are several and all slip; else 0.
  pure integer function n_all_slipping(state) result(n)
    type(state_type), intent(in) :: state
    n = count(state%new%slaves%status == STATUS_SLIP)
    if (n == 1 .or. any(state%new%slaves%status == STATUS_STICK)) n = 0
  end function n_all_slipping


  !> A reason that contact gives; FAILURE_NONE if it gives none.
  function failure_of_contact(model, system, state, newton) result(failure)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    type(failure_type) :: failure
    integer, allocatable :: slaves(:)
    integer :: length
    if (size(state%new%slaves) == 0) return
    slaves = left_nodes(state%old%slaves, state%new%slaves)
    length = find_cycle(newton%forensics)
    if (size(slaves) > 0 .and. length == 0) then
      failure%code = FAILURE_LEFT_MASTER
    else if (length > 0) then
      slaves = cycle_nodes(newton%forensics, length)
      failure%code = merge(FAILURE_FLIP, FAILURE_CYCLE, is_flip(newton%forensics, length, slaves))
      failure%length = length
    else
      slaves = jumped_nodes(newton%forensics, state%new%slaves, system%contact%edge)
      if (size(slaves) > 0) then
        failure%code = FAILURE_DEEP
      else if (system%contact%n_changed > 0) then
        slaves = cycle_nodes(newton%forensics, 2)
        failure%code = FAILURE_UNSETTLED
      end if
    end if
    failure%labels = labels_of(model, state%new%slaves, slaves)
  end function failure_of_contact


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


  !> The labels of the nodes of some slaves.
  pure function labels_of(model, all_slaves, slaves) result(labels)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: all_slaves(:)
    integer, intent(in) :: slaves(:)               !< indices
    integer :: labels(size(slaves))
    labels = model%mesh%node_label(all_slaves(slaves)%node)
  end function labels_of


  !> What a person can look at and do: the ten worst nodes with their contact in the last iterations, and one sentence.
  function failure_lines(model, system, state, newton, failure) result(lines)
    type(model_type), intent(in) :: model
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(newton_type), intent(in) :: newton
    type(failure_type), intent(in) :: failure      !< of find_failure
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
    line = 'Remedy: ' // remedy_words(failure)
    lines = [lines, line]
  end function failure_lines


  !> By what the attempts at the last increment failed, in a line; empty if there was one. Of equal ones running one is named.
  function failed_attempts(records) result(line)
    type(increment_record_type), intent(in) :: records(:)   !< the last one is of the last attempt
    character(STORY_LENGTH) :: line
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
      is_free = is_free .and. family_of(records(i)%failure) == FAMILY_FREE_BODY
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
    slaves = pack([(s, s=1, size(state%new%slaves))], state%new%slaves%extension > 0.0_DP .and. &
      state%old%slaves%extension <= 0.0_DP)
    if (size(slaves) > 0) lines = [character(STORY_LENGTH) :: 'Slave ' // node_list(labels_of(model, state%new%slaves, slaves)) // &
      ' went off the master and back in a cycle: the facet at the edge reaches farther for them.']
    slaves = left_nodes(state%old%slaves, state%new%slaves)
    if (size(slaves) > 0) lines = [character(STORY_LENGTH) :: lines, 'Slave ' // &
      node_list(labels_of(model, state%new%slaves, slaves)) // ' ran off the master surface in this increment: nothing ' // &
      'holds them there.']
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

end module amontons_failure_report
