!> Partition of points by recursive bisection.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_point_partition
  use amontons_kinds, only: DP
  implicit none
  private
  public :: partition_points

contains

  !> Partitions points into parts of at most `max_points` points by recursive bisection across the longest side of the bounding box.
  !! Cost: n log(n). The parts do not depend on the number of threads. Equal coordinates are ordered by their index.
  pure subroutine partition_points(place, max_points, part, n_parts)
    real(DP), intent(in) :: place(:, :)            !< (3, n) [length]
    integer, intent(in) :: max_points
    integer, intent(out) :: part(:)                !< (n) from 1
    integer, intent(out) :: n_parts
    integer, allocatable :: order(:), first(:), last(:)
    integer :: n_open, low, high, middle, i
    n_parts = 0
    if (size(part) == 0) return
    order = [(i, i=1, size(part))]
    allocate (first(size(part) + 1), last(size(part) + 1))
    n_open = 1
    first(1) = 1
    last(1) = size(part)
    do while (n_open > 0)
      low = first(n_open)
      high = last(n_open)
      n_open = n_open - 1
      if (high - low < max_points) then
        n_parts = n_parts + 1
        part(order(low:high)) = n_parts
        cycle
      end if
      middle = (low + high) / 2
      call move_smallest(place(longest_axis(place, order(low:high)), :), middle - low + 1, order(low:high))
      first(n_open + 1:n_open + 2) = [middle + 1, low]
      last(n_open + 1:n_open + 2) = [high, middle]
      n_open = n_open + 2
    end do
  end subroutine partition_points


  !> The axis of the longest side of the bounding box of some points.
  pure integer function longest_axis(place, members) result(axis)
    real(DP), intent(in) :: place(:, :)            !< (3, n) [length]
    integer, intent(in) :: members(:)
    real(DP) :: low(3), high(3)
    integer :: i
    low = place(:, members(1))
    high = low
    do i = 2, size(members)
      low = min(low, place(:, members(i)))
      high = max(high, place(:, members(i)))
    end do
    axis = maxloc(high - low, dim=1)
  end function longest_axis


  !> Moves the members with the n smallest keys to the front: by partitions about the middle member of what is still open
  !! (quickselect). Cost: linear in the mean.
  pure subroutine move_smallest(keys, n, members)
    real(DP), intent(in) :: keys(:)                !< of all points
    integer, intent(in) :: n
    integer, intent(inout) :: members(:)
    integer :: low, high, i, j, pivot, other
    low = 1
    high = size(members)
    do while (low < high)
      pivot = members((low + high) / 2)
      i = low
      j = high
      do while (i <= j)
        do while (is_before(members(i), pivot))
          i = i + 1
        end do
        do while (is_before(pivot, members(j)))
          j = j - 1
        end do
        if (i > j) exit
        other = members(i)
        members(i) = members(j)
        members(j) = other
        i = i + 1
        j = j - 1
      end do
      if (n <= j) then
        high = j
      else if (n >= i) then
        low = i
      else
        exit
      end if
    end do

  contains

    !> Whether a point is before another one.
    pure logical function is_before(a, b)
      integer, intent(in) :: a, b
      is_before = keys(a) < keys(b) .or. (.not. keys(b) < keys(a) .and. a < b)
    end function is_before

  end subroutine move_smallest

end module amontons_point_partition
