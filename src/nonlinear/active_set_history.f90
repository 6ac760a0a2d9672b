!> Forensics: what the slave nodes did in the last iterations: cycles by hashing, flips, and who left the master.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_active_set_history
  use amontons_kinds, only: DP, I64
  use amontons_state, only: slave_type, STATUS_OPEN, STATUS_STICK
  implicit none
  private
  public :: forensics_type, note_slaves, find_cycle, cycle_nodes, is_flip, left_nodes, jumped_nodes, story_of, &
    least_merit, last_facet, n_changed_since_first, most_held, DEPTH

  integer, parameter :: DEPTH = 8                  !< iterations whose nodes are kept
  integer, parameter :: MOST = 128                 !< iterations whose hashes are kept
  integer(I64), parameter :: MODULUS = 1099511627689_I64   !< a prime below 2**40: no product overflows
  integer(I64), parameter :: FACTOR = 1000003_I64
  real(DP), parameter :: DEEP = 0.5_DP             !< a penetration beyond this part of an edge [-]
  real(DP), parameter :: SHALLOW = 0.1_DP          !< that was less than this part in the iteration before is a jump [-]

  !> What the slave nodes were in the last iterations of an attempt; the newest comes first.
  type :: forensics_type
    integer :: n = 0                               !< iterations noted, the start counted
    integer(I64) :: hash(MOST) = 0
    integer, allocatable :: status(:, :)           !< (n_slaves, DEPTH) STATUS_...
    integer, allocatable :: scenario(:, :)         !< (n_slaves, DEPTH)
    integer, allocatable :: facet(:, :)            !< (n_slaves, DEPTH)
    real(DP), allocatable :: gap(:, :)             !< (n_slaves, DEPTH) [length]
    real(DP) :: merit(DEPTH) = 0                   !< [force]
  end type forensics_type

contains

  !> Notes the slave nodes after an iteration, or at the start. Cost: linear in the slave nodes.
  pure subroutine note_slaves(forensics, slaves, merit)
    type(forensics_type), intent(inout) :: forensics
    type(slave_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: merit                  !< [force]
    integer :: n
    n = size(slaves)
    if (.not. allocated(forensics%status)) then
      allocate (forensics%status(n, DEPTH), forensics%scenario(n, DEPTH), forensics%facet(n, DEPTH), source=0)
      allocate (forensics%gap(n, DEPTH), source=0.0_DP)
    end if
    forensics%n = forensics%n + 1
    forensics%status(:, 2:) = forensics%status(:, :DEPTH - 1)
    forensics%scenario(:, 2:) = forensics%scenario(:, :DEPTH - 1)
    forensics%facet(:, 2:) = forensics%facet(:, :DEPTH - 1)
    forensics%gap(:, 2:) = forensics%gap(:, :DEPTH - 1)
    forensics%status(:, 1) = slaves%status
    forensics%scenario(:, 1) = slaves%scenario
    forensics%facet(:, 1) = slaves%facet
    forensics%gap(:, 1) = slaves%gap
    forensics%merit = [merit, forensics%merit(:DEPTH - 1)]
    forensics%hash(2:) = forensics%hash(:MOST - 1)
    forensics%hash(1) = hash_of(slaves)
  end subroutine note_slaves


  !> A number that is the same for the same pairs, facets and statuses of all slave nodes, and else almost surely not.
  pure integer(I64) function hash_of(slaves) result(hash)
    type(slave_type), intent(in) :: slaves(:)
    integer :: s
    hash = 1
    do s = 1, size(slaves)
      hash = modulo(hash * FACTOR + int(slaves(s)%pair, I64), MODULUS)
      hash = modulo(hash * FACTOR + int(slaves(s)%status, I64), MODULUS)
      if (slaves(s)%status == STATUS_OPEN) cycle   ! where an open node would touch does not matter
      hash = modulo(hash * FACTOR + int(slaves(s)%facet, I64), MODULUS)
    end do
  end function hash_of


  !> The length of the cycle in which the iterations go: after so many all slave nodes are what they were; 0: none.
  pure integer function find_cycle(forensics) result(length)
    type(forensics_type), intent(in) :: forensics
    integer :: k
    length = 0
    if (forensics%n < 3) return
    if (forensics%hash(1) == forensics%hash(2)) return
    do k = 2, min(forensics%n, MOST) - 1
      if (forensics%hash(1 + k) == forensics%hash(1)) exit
    end do
    if (k < min(forensics%n, MOST)) length = k
  end function find_cycle


  !> The slave nodes whose status or facet changed in the last iterations: indices into the slaves.
  pure function cycle_nodes(forensics, length) result(slaves)
    type(forensics_type), intent(in) :: forensics
    integer, intent(in) :: length                  !< iterations looked at
    integer, allocatable :: slaves(:)
    logical, allocatable :: is_in(:)
    integer :: k, s
    allocate (is_in(size(forensics%status, 1)), source=.false.)
    do k = 2, min(length + 1, DEPTH, forensics%n)
      is_in = is_in .or. forensics%status(:, k) /= forensics%status(:, 1) .or. &
        (forensics%facet(:, k) /= forensics%facet(:, 1) .and. forensics%status(:, 1) /= STATUS_OPEN)
    end do
    slaves = pack([(s, s=1, size(is_in))], is_in)
  end function cycle_nodes


  !> How many slave nodes have another status than after the first iteration; of longer attempts than are remembered, than in the
  !! first iteration that is.
  pure integer function n_changed_since_first(forensics) result(n)
    type(forensics_type), intent(in) :: forensics
    n = 0
    if (forensics%n > 2) n = count(forensics%status(:, 1) /= forensics%status(:, min(forensics%n - 1, DEPTH)))
  end function n_changed_since_first


  !> The iteration of the least merit among the last ones, counted back from 1, the newest.
  pure integer function least_merit(forensics, length) result(best)
    type(forensics_type), intent(in) :: forensics
    integer, intent(in) :: length                  !< iterations looked at
    best = minloc(forensics%merit(:min(length, DEPTH)), dim=1)
  end function least_merit


  !> The facet on which a slave node was last; 0: on none.
  pure integer function last_facet(forensics, s) result(facet)
    type(forensics_type), intent(in) :: forensics
    integer, intent(in) :: s
    integer :: k
    facet = 0
    do k = 1, min(forensics%n, DEPTH)
      if (facet == 0) facet = forensics%facet(s, k)
    end do
  end function last_facet


  !> The firmest status of a slave node in the last iterations, and the facet on which it was then; open: facet 0.
  pure subroutine most_held(forensics, s, status, facet)
    type(forensics_type), intent(in) :: forensics
    integer, intent(in) :: s
    integer, intent(out) :: status                 !< STATUS_...
    integer, intent(out) :: facet
    integer :: k
    status = STATUS_OPEN
    facet = 0
    do k = 1, min(forensics%n, DEPTH / 2)
      if (forensics%facet(s, k) == 0 .or. forensics%status(s, k) == STATUS_OPEN .or. status == STATUS_STICK) cycle
      status = forensics%status(s, k)
      facet = forensics%facet(s, k)
    end do
  end subroutine most_held


  !> Whether nothing but stick and slip changes among some slave nodes.
  pure logical function is_flip(forensics, length, slaves)
    type(forensics_type), intent(in) :: forensics
    integer, intent(in) :: length                  !< iterations looked at
    integer, intent(in) :: slaves(:)
    integer :: k
    is_flip = size(slaves) > 0
    do k = 1, min(length, DEPTH, forensics%n)
      is_flip = is_flip .and. all(forensics%status(slaves, k) /= STATUS_OPEN) .and. &
        all(forensics%facet(slaves, k) == forensics%facet(slaves, 1))
    end do
  end function is_flip


  !> The slave nodes that were closed at the last commit and have no master any more.
  pure function left_nodes(committed, slaves) result(left)
    type(slave_type), intent(in) :: committed(:), slaves(:)
    integer, allocatable :: left(:)
    integer :: s
    left = pack([(s, s=1, size(slaves))], committed%status /= STATUS_OPEN .and. slaves%facet == 0)
  end function left_nodes


  !> The slave nodes that were outside or hardly inside in the iteration before and are deep inside now.
  pure function jumped_nodes(forensics, slaves, edge) result(jumped)
    type(forensics_type), intent(in) :: forensics
    type(slave_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: edge(:)                !< (n_pairs) longest edge of the master [length]
    integer, allocatable :: jumped(:)
    integer :: s
    allocate (jumped(0))
    if (forensics%n < 2) return
    jumped = pack([(s, s=1, size(slaves))], forensics%facet(:, 1) > 0 .and. forensics%gap(:, 1) < -DEEP * edge(slaves%pair) &
      .and. forensics%gap(:, 2) > -SHALLOW * edge(slaves%pair))
  end function jumped_nodes


  !> What a slave node was in the last iterations, the newest last: open, stick, slip with its scenario.
  pure function story_of(forensics, s) result(story)
    type(forensics_type), intent(in) :: forensics
    integer, intent(in) :: s
    character(60) :: story
    character(5), parameter :: STATUS_NAMES(0:2) = ['open ', 'stick', 'slip ']
    character(4), parameter :: SCENARIO_NAMES(0:4) = ['    ', '-I  ', '-II ', '-III', '-IV ']
    integer :: k
    story = ''
    do k = min(forensics%n, 5), 1, -1
      story = trim(story) // ' ' // trim(STATUS_NAMES(forensics%status(s, k)))
      if (forensics%status(s, k) /= STATUS_OPEN) story = trim(story) // trim(SCENARIO_NAMES(forensics%scenario(s, k)))
    end do
    story = adjustl(story)
  end function story_of

end module amontons_active_set_history
