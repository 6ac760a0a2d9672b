!> Tests of column singletons: means of two, chains of them, cycles that stay, small pivots, null vectors of a ladder of means.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_column_singletons
  use amontons_kinds, only: DP
  use amontons_column_singletons, only: find_column_singletons, solve_column_singletons
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_chain(suite)
  call check_cycle(suite)
  call check_small_pivot(suite)
  call check_many_means(suite)
  call suite%finish()

contains

  !> x3 = (x1 + x2)/2 and x4 = (x3 + x2)/2: x4 goes first, which leaves x3 in one row.
  subroutine check_chain(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: FIRST(*) = [1, 4, 7], COLUMN(*) = [3, 1, 2, 4, 3, 2]
    real(DP), parameter :: VALUE(*) = [1.0_DP, -0.5_DP, -0.5_DP, 1.0_DP, -0.5_DP, -0.5_DP]
    integer, allocatable :: columns(:), rows(:)
    real(DP) :: x(4)
    call find_column_singletons(FIRST, COLUMN, VALUE, 0.6_DP, columns, rows)
    call suite%that('chain: both rows are taken', size(rows) == 2)
    call suite%that('chain: in their order', all(columns == [4, 3]) .and. all(rows == [2, 1]))
    x = [2.0_DP, 6.0_DP, 0.0_DP, 0.0_DP]
    call solve_column_singletons(FIRST, COLUMN, VALUE, columns, rows, x)
    call suite%near('chain: the means', norm2(x - [2.0_DP, 6.0_DP, 4.0_DP, 5.0_DP]), 0.0_DP, 1.0e-15_DP)
  end subroutine check_chain


  !> Three differences around a cycle: each column has two rows, nothing is taken.
  subroutine check_cycle(suite)
    type(suite_type), intent(inout) :: suite
    integer, allocatable :: columns(:), rows(:)
    call find_column_singletons([1, 3, 5, 7], [1, 2, 2, 3, 3, 1], [1.0_DP, -1.0_DP, 1.0_DP, -1.0_DP, 1.0_DP, -1.0_DP], 0.1_DP, &
      columns, rows)
    call suite%that('cycle: nothing is taken', size(columns) == 0 .and. size(rows) == 0)
    call find_column_singletons([1, 1], [integer ::], [real(DP) ::], 0.1_DP, columns, rows)
    call suite%that('an empty row: nothing is taken', size(columns) == 0)
  end subroutine check_cycle


  !> A column of 1e-3 in a row of 1 is no pivot; two columns of one row: one is taken.
  subroutine check_small_pivot(suite)
    type(suite_type), intent(inout) :: suite
    integer, allocatable :: columns(:), rows(:)
    call find_column_singletons([1, 3, 4], [1, 2, 2], [1.0e-3_DP, 1.0_DP, 1.0_DP], 0.1_DP, columns, rows)
    call suite%that('a small entry is no pivot', size(columns) == 0)
    call find_column_singletons([1, 3], [1, 2], [1.0_DP, 1.0_DP], 0.1_DP, columns, rows)
    call suite%that('one column for a row', all(columns == [1]) .and. size(rows) == 1)
  end subroutine check_small_pivot


  !> A ladder of means, each of the two before it: all rows are taken, and the null vector fulfils all rows.
  subroutine check_many_means(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: N = 500
    integer :: first(N + 1), column(3 * N), i
    real(DP) :: value(3 * N), x(N + 2), worst
    integer, allocatable :: columns(:), rows(:)
    first = [(3 * i + 1, i=0, N)]
    do i = 1, N
      column(3 * i - 2:3 * i) = [i + 2, i + 1, i]
      value(3 * i - 2:3 * i) = [1.0_DP, -0.5_DP, -0.5_DP]
    end do
    call find_column_singletons(first, column, value, 0.6_DP, columns, rows)
    call suite%that('ladder: all rows are taken', size(rows) == N)
    x = 0.0_DP
    x(1) = 1.0_DP
    call solve_column_singletons(first, column, value, columns, rows, x)
    worst = maxval([(abs(dot_product(value(3 * i - 2:3 * i), x(column(3 * i - 2:3 * i)))), i=1, N)])
    call suite%near('ladder: every row is fulfilled', worst, 0.0_DP, 1.0e-15_DP)
    call suite%near('ladder: its end is 1/3', x(N + 2), 1.0_DP / 3.0_DP, 1.0e-14_DP)
  end subroutine check_many_means

end program test_column_singletons
