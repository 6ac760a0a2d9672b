!> Tests of motion rows: rows on the motions of bodies, the motions that one row gives, and the null space of a cluster.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_motion_rows
  use amontons_kinds, only: DP
  use amontons_containers, only: integer_list_type
  use amontons_motion_rows, only: bases_type, rows_type, motion_matrix_type, allocate_rows, end_row, build_matrix, &
    find_scaled_null_space
  use check, only: suite_type
  implicit none
  integer, parameter :: N_BODIES = 130             !< the cluster is larger than what is left to the dense matrix
  type(suite_type) :: suite
  type(bases_type) :: bases
  type(rows_type) :: rows
  call make_train(bases, rows)
  call check_rows(suite, rows)
  call check_null_space(suite, bases, rows)
  call suite%finish()

contains

  !> Bodies in a row that can move along x and turn about x, the last one held: two rows couple neighbours, the second more weakly.
  !! The coupling of the last two may be open at the start.
  subroutine make_train(bases, rows)
    type(bases_type), intent(out) :: bases
    type(rows_type), intent(out) :: rows
    integer :: b, k
    allocate (bases%n(N_BODIES), source=2)
    allocate (bases%motion(6, 6, N_BODIES), source=0.0_DP)
    bases%motion(1, 1, :) = 1.0_DP
    bases%motion(4, 2, :) = 1.0_DP
    bases%n(N_BODIES) = 0
    call allocate_rows(N_BODIES, rows)
    do b = 1, N_BODIES - 1
      do k = 1, 2
        rows%work(3 * k - 2, b) = 1.0_DP / real(k, DP)
        rows%work(3 * k - 2, b + 1) = -1.0_DP / real(k, DP)
        rows%touched(:2) = [b, b + 1]
        rows%n_touched = 2
        call end_row(bases, b == N_BODIES - 1, rows)
      end do
    end do
  end subroutine make_train


  !> A body that is held has no entry; a row ends with an empty work row.
  subroutine check_rows(suite, rows)
    type(suite_type), intent(inout) :: suite
    type(rows_type), intent(in) :: rows
    call suite%that('rows: two for each pair of neighbours', rows%n == 2 * (N_BODIES - 1))
    call suite%that('rows: one entry in those to the body that is held', rows%n_entries == 2 * rows%n - 2)
    call suite%near('rows: nothing is left of the current one', maxval(abs(rows%work)), 0.0_DP, 0.0_DP)
  end subroutine check_rows


  !> With the last coupling nothing moves; without it the train moves along x and turns about x as a whole. The singletons are put
  !! back into the cluster, so that the sparse way has all of it.
  subroutine check_null_space(suite, bases, rows)
    type(suite_type), intent(inout) :: suite
    type(bases_type), intent(in) :: bases
    type(rows_type), intent(in) :: rows
    type(motion_matrix_type) :: matrix
    type(integer_list_type) :: rows_of
    real(DP), allocatable :: vectors(:, :)
    integer :: n, i, k
    do k = 1, 2
      call build_matrix(bases, rows, k == 2, matrix)
      call suite%that('matrix: two motions of each body that is not held', size(matrix%place) == 2 * (N_BODIES - 1))
      if (k == 1) call suite%that('matrix: from a held end on, one row gives each motion', all(matrix%is_solved_row))
      matrix%place = [(i, i=1, size(matrix%place))]
      rows_of = integer_list_type()
      do i = 1, rows%n - merge(2, 0, k == 2)
        call rows_of%add(i)
      end do
      call find_scaled_null_space(matrix, rows_of, [(2, i=1, N_BODIES - 1)], 1.0e-10_DP, n, vectors)
      call suite%that('null space: free only without the last coupling', n == merge(2, 0, k == 2))
    end do
    do i = 1, n
      call suite%near('null space: the largest value is 1', maxval(abs(vectors(:, i))), 1.0_DP, 1.0e-14_DP)
      call suite%near('null space: all move alike', maxval(vectors(1::2, i)) - minval(vectors(1::2, i)), 0.0_DP, 1.0e-10_DP)
      call suite%near('null space: all turn alike', maxval(vectors(2::2, i)) - minval(vectors(2::2, i)), 0.0_DP, 1.0e-10_DP)
    end do
  end subroutine check_null_space

end program test_motion_rows
