!> History of the active set: cycle detection by hashing, stick-slip flips, lost masters, penetration jumps, and the status trace.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_active_set_history
  use amontons_kinds, only: DP
  use amontons_state, only: slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_active_set_history, only: active_set_history_type, record_active_set, find_cycle, is_cycle_repeated, &
    cycling_slaves, is_stick_slip_flip, slaves_off_master, suddenly_deep_slaves, status_trace
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_cycle()
  call check_repeated_cycle()
  call check_converged_set()
  call check_nodes()
  call suite%finish()

contains

  !> Three nodes: the second alternates between stick and slip, the third also changes its facet every third iteration.
  subroutine check_cycle()
    type(active_set_history_type) :: history
    type(slave_state_type) :: slaves(3)
    integer :: i
    slaves%pair = 1
    slaves%facet = [4, 5, 6]
    slaves%status = STATUS_STICK
    do i = 1, 6
      slaves(2)%status = merge(STATUS_STICK, STATUS_SLIP, mod(i, 2) == 0)
      slaves(2)%scenario = 2
      call record_active_set(history, slaves, 1.0_DP)
    end do
    call suite%that('flip: of length 2', find_cycle(history) == 2)
    call suite%that('flip: one node', size(cycling_slaves(history, 2)) == 1)
    call suite%that('flip: the second', all(cycling_slaves(history, 2) == 2))
    call suite%that('flip: stick and slip alone', is_stick_slip_flip(history, 2, cycling_slaves(history, 2)))
    call suite%that('flip: its story', status_trace(history, 2) == 'stick-II slip-II stick-II slip-II stick-II' .or. &
      status_trace(history, 2) == 'slip-II stick-II slip-II stick-II slip-II')
    history = active_set_history_type()
    do i = 1, 8
      slaves(2)%status = STATUS_STICK
      slaves(3)%facet = 6 + mod(i, 3)
      call record_active_set(history, slaves, 1.0_DP)
    end do
    call suite%that('cycle: of length 3', find_cycle(history) == 3)
    call suite%that('cycle: the third node', all(cycling_slaves(history, 3) == 3))
    call suite%that('cycle: no flip', .not. is_stick_slip_flip(history, 3, [3]))
  end subroutine check_cycle


  !> Twice through a cycle of two or three iterations with a merit that does not fall; not once, and not with a merit that falls.
  subroutine check_repeated_cycle()
    type(active_set_history_type) :: history
    type(slave_state_type) :: slaves(2)
    integer :: length, i
    slaves%pair = 1
    slaves%status = STATUS_STICK
    do length = 2, 4
      history = active_set_history_type()
      do i = 0, 2 * length
        slaves%facet = 1 + mod(i, length)
        call record_active_set(history, slaves, 1.0_DP)
        call suite%that('repeated: after two cycles, if they are stored', is_cycle_repeated(history, 0.9_DP) .eqv. &
          (i == 2 * length .and. length < 4))
      end do
    end do
    history = active_set_history_type()
    do i = 0, 4
      slaves%facet = 1 + mod(i, 2)
      call record_active_set(history, slaves, 0.9_DP**i)
    end do
    call suite%that('repeated: the merit falls', .not. is_cycle_repeated(history, 0.9_DP))
    call suite%that('repeated: it falls by less', is_cycle_repeated(history, 0.6_DP))
  end subroutine check_repeated_cycle


  !> Neither a constant active set nor one that never recurs is a cycle; the facet of an open node does not count.
  subroutine check_converged_set()
    type(active_set_history_type) :: history
    type(slave_state_type) :: slaves(2)
    integer :: i
    slaves%pair = 1
    do i = 1, 5
      slaves%facet = i
      call record_active_set(history, slaves, 1.0_DP)
    end do
    call suite%that('converged set: open nodes wander', find_cycle(history) == 0)
    history = active_set_history_type()
    slaves%status = STATUS_SLIP
    do i = 1, 5
      slaves%facet = i
      call record_active_set(history, slaves, 1.0_DP)
    end do
    call suite%that('never back', find_cycle(history) == 0)
  end subroutine check_converged_set


  !> Nodes that leave their master and nodes with a penetration jump.
  subroutine check_nodes()
    type(active_set_history_type) :: history
    type(slave_state_type) :: before(3), after(3)
    before%pair = 1
    before%facet = 1
    before%status = [STATUS_STICK, STATUS_OPEN, STATUS_SLIP]
    after = before
    after%facet = [0, 0, 1]
    call suite%that('left: the closed one', all(slaves_off_master(before, after) == [1]) .and. size(slaves_off_master(before, &
      after)) == 1)
    before%gap = [0.1_DP, -0.3_DP, 0.0_DP]
    call record_active_set(history, before, 1.0_DP)
    call suite%that('jump: needs two iterations', size(suddenly_deep_slaves(history, before, [1.0_DP])) == 0)
    after%facet = 1
    after%gap = [-0.7_DP, -0.7_DP, -0.2_DP]
    call record_active_set(history, after, 1.0_DP)
    call suite%that('jump: the first', all(suddenly_deep_slaves(history, after, [1.0_DP]) == [1]))
    call suite%that('jump: alone', size(suddenly_deep_slaves(history, after, [1.0_DP])) == 1)
  end subroutine check_nodes

end program test_active_set_history
