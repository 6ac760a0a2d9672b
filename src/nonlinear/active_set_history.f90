!> History of the active set over the last iterations: hashing, cycle detection, diagnosis of flips and penetration jumps.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_active_set_history
  use amontons_kinds, only: DP, I64
  use amontons_state, only: slave_state_type, STATUS_OPEN, STATUS_STICK
  implicit none
  private
  public :: active_set_history_type, record_active_set, find_cycle, is_cycle_repeated, cycling_slaves, is_stick_slip_flip, &
    slaves_off_master, suddenly_deep_slaves, status_trace, find_least_merit, last_facet, count_changed_statuses, &
    most_constrained_status, HISTORY_DEPTH

  integer, parameter :: HISTORY_DEPTH = 8                  !< iterations with stored nodes
  integer, parameter :: MAX_HASHES = 128                 !< iterations with stored hashes
  integer(I64), parameter :: HASH_MODULUS = 1099511627689_I64   !< a prime below 2**40: no product overflows
  integer(I64), parameter :: HASH_FACTOR = 1000003_I64
  real(DP), parameter :: DEEP_PENETRATION = 0.5_DP             !< least penetration after a jump, over an edge [-]
  real(DP), parameter :: SHALLOW_PENETRATION = 0.1_DP          !< largest penetration before a jump, over an edge [-]

  !> Slave nodes in the last iterations of an attempt, newest first.
  type :: active_set_history_type
    integer :: n = 0                               !< iterations recorded, including the start
    integer(I64) :: hash(MAX_HASHES) = 0
    integer, allocatable :: status(:, :)           !< (n_slaves, HISTORY_DEPTH) STATUS_...
    integer, allocatable :: scenario(:, :)         !< (n_slaves, HISTORY_DEPTH)
    integer, allocatable :: facet(:, :)            !< (n_slaves, HISTORY_DEPTH)
    real(DP), allocatable :: gap(:, :)             !< (n_slaves, HISTORY_DEPTH) [length]
    real(DP) :: merit(HISTORY_DEPTH) = 0                   !< [force]
  end type active_set_history_type

contains

  !> Records the slave nodes after an iteration, or at the start. Cost: linear in the slave nodes.
  pure subroutine record_active_set(history, slaves, merit)
    type(active_set_history_type), intent(inout) :: history
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: merit                  !< [force]
    integer :: n
    n = size(slaves)
    if (.not. allocated(history%status)) then
      allocate (history%status(n, HISTORY_DEPTH), history%scenario(n, HISTORY_DEPTH), history%facet(n, HISTORY_DEPTH), source=0)
      allocate (history%gap(n, HISTORY_DEPTH), source=0.0_DP)
    end if
    history%n = history%n + 1
    history%status(:, 2:) = history%status(:, :HISTORY_DEPTH - 1)
    history%scenario(:, 2:) = history%scenario(:, :HISTORY_DEPTH - 1)
    history%facet(:, 2:) = history%facet(:, :HISTORY_DEPTH - 1)
    history%gap(:, 2:) = history%gap(:, :HISTORY_DEPTH - 1)
    history%status(:, 1) = slaves%status
    history%scenario(:, 1) = slaves%scenario
    history%facet(:, 1) = slaves%facet
    history%gap(:, 1) = slaves%gap
    history%merit = [merit, history%merit(:HISTORY_DEPTH - 1)]
    history%hash(2:) = history%hash(:MAX_HASHES - 1)
    history%hash(1) = hash_active_set(slaves)
  end subroutine record_active_set


  !> Hash of pairs, facets and statuses of all slave nodes; collisions are improbable.
  pure integer(I64) function hash_active_set(slaves) result(hash)
    type(slave_state_type), intent(in) :: slaves(:)
    integer :: s
    hash = 1
    do s = 1, size(slaves)
      hash = modulo(hash * HASH_FACTOR + int(slaves(s)%pair, I64), HASH_MODULUS)
      hash = modulo(hash * HASH_FACTOR + int(slaves(s)%status, I64), HASH_MODULUS)
      if (slaves(s)%status == STATUS_OPEN) cycle   ! the facet of an open node does not count
      hash = modulo(hash * HASH_FACTOR + int(slaves(s)%facet, I64), HASH_MODULUS)
    end do
  end function hash_active_set


  !> Length of the cycle: number of iterations since all slave nodes were the same; 0: no cycle.
  pure integer function find_cycle(history) result(length)
    type(active_set_history_type), intent(in) :: history
    integer :: k
    length = 0
    if (history%n < 3) return
    if (history%hash(1) == history%hash(2)) return
    do k = 2, min(history%n, MAX_HASHES) - 1
      if (history%hash(1 + k) == history%hash(1)) exit
    end do
    if (k < min(history%n, MAX_HASHES)) length = k
  end function find_cycle


  !> Whether the last iterations passed twice through the same cycle without a smaller merit.
  pure logical function is_cycle_repeated(history, stagnation_ratio)
    type(active_set_history_type), intent(in) :: history
    real(DP), intent(in) :: stagnation_ratio       !< least ratio of the merits that is no decrease [-]
    integer :: k
    k = find_cycle(history)
    is_cycle_repeated = k > 0 .and. 2 * k < min(history%n, HISTORY_DEPTH)
    if (is_cycle_repeated) is_cycle_repeated = history%hash(1 + 2 * k) == history%hash(1) .and. &
      history%merit(1) >= stagnation_ratio * history%merit(1 + 2 * k)
  end function is_cycle_repeated


  !> The slave nodes whose status or facet changed in the last iterations: indices into the slaves.
  pure function cycling_slaves(history, length) result(slaves)
    type(active_set_history_type), intent(in) :: history
    integer, intent(in) :: length                  !< iterations looked at
    integer, allocatable :: slaves(:)
    logical, allocatable :: is_in(:)
    integer :: k, s
    allocate (is_in(size(history%status, 1)), source=.false.)
    do k = 2, min(length + 1, HISTORY_DEPTH, history%n)
      is_in = is_in .or. history%status(:, k) /= history%status(:, 1) .or. &
        (history%facet(:, k) /= history%facet(:, 1) .and. history%status(:, 1) /= STATUS_OPEN)
    end do
    slaves = pack([(s, s=1, size(is_in))], is_in)
  end function cycling_slaves


  !> Number of slave nodes whose status differs from that after the first iteration, or, in attempts longer than HISTORY_DEPTH,
  !! from that of the oldest iteration stored.
  pure integer function count_changed_statuses(history) result(n)
    type(active_set_history_type), intent(in) :: history
    n = 0
    if (history%n > 2) n = count(history%status(:, 1) /= history%status(:, min(history%n - 1, HISTORY_DEPTH)))
  end function count_changed_statuses


  !> Iteration of the least merit among the last ones; 1: the newest.
  pure integer function find_least_merit(history, length) result(best)
    type(active_set_history_type), intent(in) :: history
    integer, intent(in) :: length                  !< iterations looked at
    best = minloc(history%merit(:min(length, HISTORY_DEPTH)), dim=1)
  end function find_least_merit


  !> Last facet of a slave node; 0: none.
  pure integer function last_facet(history, s) result(facet)
    type(active_set_history_type), intent(in) :: history
    integer, intent(in) :: s
    integer :: k
    facet = 0
    do k = 1, min(history%n, HISTORY_DEPTH)
      if (facet == 0) facet = history%facet(s, k)
    end do
  end function last_facet


  !> Most constrained status of a slave node in the last iterations (stick, slip, open) and its facet then; open: facet 0.
  pure subroutine most_constrained_status(history, s, status, facet)
    type(active_set_history_type), intent(in) :: history
    integer, intent(in) :: s
    integer, intent(out) :: status                 !< STATUS_...
    integer, intent(out) :: facet
    integer :: k
    status = STATUS_OPEN
    facet = 0
    do k = 1, min(history%n, HISTORY_DEPTH / 2)
      if (history%facet(s, k) == 0 .or. history%status(s, k) == STATUS_OPEN .or. status == STATUS_STICK) cycle
      status = history%status(s, k)
      facet = history%facet(s, k)
    end do
  end subroutine most_constrained_status


  !> Whether some slave nodes change between stick and slip only.
  pure logical function is_stick_slip_flip(history, length, slaves)
    type(active_set_history_type), intent(in) :: history
    integer, intent(in) :: length                  !< iterations looked at
    integer, intent(in) :: slaves(:)
    integer :: k
    is_stick_slip_flip = size(slaves) > 0
    do k = 1, min(length, HISTORY_DEPTH, history%n)
      is_stick_slip_flip = is_stick_slip_flip .and. all(history%status(slaves, k) /= STATUS_OPEN) .and. &
        all(history%facet(slaves, k) == history%facet(slaves, 1))
    end do
  end function is_stick_slip_flip


  !> Slave nodes that were closed at the last commit and have no facet now.
  pure function slaves_off_master(committed, slaves) result(lost)
    type(slave_state_type), intent(in) :: committed(:), slaves(:)
    integer, allocatable :: lost(:)
    integer :: s
    lost = pack([(s, s=1, size(slaves))], committed%status /= STATUS_OPEN .and. slaves%facet == 0)
  end function slaves_off_master


  !> Slave nodes with a penetration jump: at most SHALLOW_PENETRATION one iteration ago, more than DEEP_PENETRATION now.
  pure function suddenly_deep_slaves(history, slaves, edge) result(deep)
    type(active_set_history_type), intent(in) :: history
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: edge(:)                !< (n_pairs) longest edge of the master [length]
    integer, allocatable :: deep(:)
    integer :: s
    allocate (deep(0))
    if (history%n < 2) return
    deep = pack([(s, s=1, size(slaves))], history%facet(:, 1) > 0 .and. history%gap(:, 1) < -DEEP_PENETRATION * edge(slaves%pair) &
      .and. history%gap(:, 2) > -SHALLOW_PENETRATION * edge(slaves%pair))
  end function suddenly_deep_slaves


  !> Status of a slave node in the last five iterations, newest last: open, stick, slip with its scenario.
  pure function status_trace(history, s) result(trace)
    type(active_set_history_type), intent(in) :: history
    integer, intent(in) :: s
    character(60) :: trace
    character(5), parameter :: STATUS_NAMES(0:2) = ['open ', 'stick', 'slip ']
    character(4), parameter :: SCENARIO_NAMES(0:4) = ['    ', '-I  ', '-II ', '-III', '-IV ']
    integer :: k
    trace = ''
    do k = min(history%n, 5), 1, -1
      trace = trim(trace) // ' ' // trim(STATUS_NAMES(history%status(s, k)))
      if (history%status(s, k) /= STATUS_OPEN) trace = trim(trace) // trim(SCENARIO_NAMES(history%scenario(s, k)))
    end do
    trace = adjustl(trace)
  end function status_trace

end module amontons_active_set_history
