!> Mid-side nodes of quadratic slave faces under exact node-to-surface contact: which of them follow the corners of their edges.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 5, "Quadratic slave faces". A mid-side node follows the mean of its corners where one of
!! them is closed. Beside open corners it is free, so that a surface that touches nothing is as soft as without contact.
module amontons_midside_constraints
  use amontons_state, only: slave_state_type, STATUS_OPEN
  implicit none
  private
  public :: midsides_type, append_midsides, hold_all_midsides, begin_midsides, update_midsides

  !> The mid-side nodes of the slave faces of all pairs, and those that follow their corners now.
  type :: midsides_type
    integer, allocatable :: nodes(:, :)            !< (3, n) mid-side node and its two corners; once for each pair
    integer, allocatable :: slaves(:, :)           !< (2, n) slaves at these corners in the pair
    logical, allocatable :: is_held(:)             !< (n) it follows its corners
    logical, allocatable :: was_released(:)        !< (n) it was released in this attempt at an increment, and is not again
    integer, allocatable :: held(:, :)             !< (3, :) the nodes that follow, each once, and their corners
  end type midsides_type

contains

  !> Adds the mid-side nodes of one pair.
  pure subroutine append_midsides(midsides, nodes, slaves)
    type(midsides_type), intent(inout) :: midsides
    integer, intent(in) :: nodes(:, :)             !< (3, n) mid-side node and its two corners
    integer, intent(in) :: slaves(:, :)            !< (2, n) slaves at the corners
    integer :: n
    if (.not. allocated(midsides%nodes)) allocate (midsides%nodes(3, 0), midsides%slaves(2, 0))
    n = size(midsides%nodes, 2) + size(nodes, 2)
    midsides%nodes = reshape([midsides%nodes, nodes], [3, n])
    midsides%slaves = reshape([midsides%slaves, slaves], [2, n])
    midsides%was_released = spread(.false., 1, n)
    call hold_all_midsides(midsides)
  end subroutine append_midsides


  !> Lets all of them follow, whatever the contact, as for what is prepared once for a step.
  pure subroutine hold_all_midsides(midsides)
    type(midsides_type), intent(inout) :: midsides
    midsides%is_held = spread(.true., 1, size(midsides%nodes, 2))
    call list_held(midsides)
  end subroutine hold_all_midsides


  !> Start of an attempt at an increment: those beside closed corners follow.
  pure subroutine begin_midsides(midsides, slaves, is_changed)
    type(midsides_type), intent(inout) :: midsides
    type(slave_state_type), intent(in) :: slaves(:)
    logical, intent(out) :: is_changed             !< other nodes follow than before
    midsides%was_released = .false.
    call set_held(midsides, are_beside_closed(midsides, slaves), is_changed)
  end subroutine begin_midsides


  !> After convergence: those beside corners that have closed follow; those beside corners that have opened are released, each once
  !! in an attempt, so that a corner that closes again by the release does not open and close for ever.
  pure subroutine update_midsides(midsides, slaves, is_changed)
    type(midsides_type), intent(inout) :: midsides
    type(slave_state_type), intent(in) :: slaves(:)
    logical, intent(out) :: is_changed             !< other nodes follow than before: the equilibrium is to be found again
    logical :: is_wanted(size(midsides%is_held)), is_released(size(midsides%is_held))
    is_wanted = are_beside_closed(midsides, slaves)
    is_released = midsides%is_held .and. .not. is_wanted .and. .not. midsides%was_released
    midsides%was_released = midsides%was_released .or. is_released
    call set_held(midsides, (midsides%is_held .or. is_wanted) .and. .not. is_released, is_changed)
  end subroutine update_midsides


  !> Sets those that follow.
  pure subroutine set_held(midsides, is_held, is_changed)
    type(midsides_type), intent(inout) :: midsides
    logical, intent(in) :: is_held(:)              !< (n)
    logical, intent(out) :: is_changed
    integer, allocatable :: before(:, :)
    is_changed = any(is_held .neqv. midsides%is_held)
    if (.not. is_changed) return
    before = midsides%held
    midsides%is_held = is_held
    call list_held(midsides)
    is_changed = size(before, 2) /= size(midsides%held, 2)
    if (.not. is_changed) is_changed = any(before /= midsides%held)
  end subroutine set_held


  !> Which mid-side nodes have a closed corner in their pair.
  pure function are_beside_closed(midsides, slaves) result(is_beside)
    type(midsides_type), intent(in) :: midsides
    type(slave_state_type), intent(in) :: slaves(:)
    logical :: is_beside(size(midsides%nodes, 2))
    integer :: i, k
    is_beside = .false.
    do i = 1, size(is_beside)
      do k = 1, 2                                  ! a corner that is a mid-side node of a finer face is no slave
        if (midsides%slaves(k, i) > 0) is_beside(i) = is_beside(i) .or. slaves(midsides%slaves(k, i))%status /= STATUS_OPEN
      end do
    end do
  end function are_beside_closed


  !> Lists the nodes that follow, in their order, each once.
  pure subroutine list_held(midsides)
    type(midsides_type), intent(inout) :: midsides
    logical :: is_listed(size(midsides%nodes, 2))
    logical, allocatable :: is_found(:)            ! by node
    integer :: i
    allocate (is_found(maxval([0, midsides%nodes(1, :)])), source=.false.)
    do i = 1, size(is_listed)
      is_listed(i) = midsides%is_held(i) .and. .not. is_found(midsides%nodes(1, i))
      if (is_listed(i)) is_found(midsides%nodes(1, i)) = .true.
    end do
    midsides%held = reshape(pack(midsides%nodes, spread(is_listed, 1, 3)), [3, count(is_listed)])
  end subroutine list_held

end module amontons_midside_constraints
