!> Columns of a sparse matrix that one row alone has: they follow from that row once the others are known.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_column_singletons
  use amontons_kinds, only: DP
  implicit none
  private
  public :: find_column_singletons, solve_column_singletons

contains

  !> Takes columns with one entry and the rows of these entries out of A x = 0, again and again until none is left.
  !!
  !! A null vector of what is left continues in one way to a null vector of A: each row taken gives its column. An entry that
  !! is a small part of its row is no pivot. Cost: linear in the entries.
  subroutine find_column_singletons(first, column, value, min_part, solved_columns, solved_rows)
    integer, intent(in) :: first(:)                !< (n_rows + 1) start of each row
    integer, intent(in) :: column(:)               !< (n_entries)
    real(DP), intent(in) :: value(:)               !< (n_entries)
    real(DP), intent(in) :: min_part               !< of a pivot, over the largest value of its row [-]
    integer, allocatable, intent(out) :: solved_columns(:), solved_rows(:)   !< pairs, in the order in which they are taken
    integer :: n_left(0:maxval([0, column]))       ! rows that still have the column
    integer :: row_sum(0:ubound(n_left, 1))        ! sum of their numbers: the row itself where one is left
    integer :: queue(size(column))
    integer :: n_queued, n_taken, next, r, c, i, pivot
    n_left = 0
    row_sum = 0
    do r = 1, size(first) - 1
      do i = first(r), first(r + 1) - 1
        n_left(column(i)) = n_left(column(i)) + 1
        row_sum(column(i)) = row_sum(column(i)) + r
      end do
    end do
    n_queued = 0
    do c = 1, ubound(n_left, 1)
      if (n_left(c) /= 1) cycle
      n_queued = n_queued + 1
      queue(n_queued) = c
    end do
    allocate (solved_columns(size(first) - 1), solved_rows(size(first) - 1))
    n_taken = 0
    next = 0
    do while (next < n_queued)
      next = next + 1
      c = queue(next)
      if (n_left(c) /= 1) cycle                    ! its row has gone with another column
      r = row_sum(c)
      associate (in_row => column(first(r):first(r + 1) - 1), values => value(first(r):first(r + 1) - 1))
        pivot = findloc(in_row, c, dim=1)
        if (abs(values(pivot)) < min_part * maxval(abs(values))) cycle
        n_taken = n_taken + 1
        solved_columns(n_taken) = c
        solved_rows(n_taken) = r
        do i = 1, size(in_row)
          n_left(in_row(i)) = n_left(in_row(i)) - 1
          row_sum(in_row(i)) = row_sum(in_row(i)) - r
          if (n_left(in_row(i)) /= 1) cycle
          n_queued = n_queued + 1
          queue(n_queued) = in_row(i)
        end do
      end associate
    end do
    solved_columns = solved_columns(:n_taken)
    solved_rows = solved_rows(:n_taken)
  end subroutine find_column_singletons


  !> Continues a null vector of the rest to the columns taken, the last one first.
  pure subroutine solve_column_singletons(first, column, value, solved_columns, solved_rows, x)
    integer, intent(in) :: first(:)                !< (n_rows + 1)
    integer, intent(in) :: column(:)               !< (n_entries)
    real(DP), intent(in) :: value(:)               !< (n_entries)
    integer, intent(in) :: solved_columns(:), solved_rows(:)
    real(DP), intent(inout) :: x(:)                !< (n_columns) set but for the columns taken
    real(DP) :: pivot, total
    integer :: k, i
    do k = size(solved_columns), 1, -1
      pivot = 0.0_DP
      total = 0.0_DP
      do i = first(solved_rows(k)), first(solved_rows(k) + 1) - 1
        if (column(i) == solved_columns(k)) then
          pivot = value(i)
        else
          total = total + value(i) * x(column(i))
        end if
      end do
      x(solved_columns(k)) = -total / pivot
    end do
  end subroutine solve_column_singletons

end module amontons_column_singletons
