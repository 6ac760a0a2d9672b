!> Unit test of midside_interpolation: the linear bar from the quadratic one, a dense product, ends that are fixed.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_midside_interpolation
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_midside_interpolation, only: build_midside_interpolation, project_to_corners
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call test_bar()
  call test_dense()
  call suite%finish()

contains

  !> Quadratic bars of stiffness 1 in a row, the first fixed at its end: P'AP is that of linear bars, 1 and -1 at their ends.
  subroutine test_bar()
    integer, parameter :: N = 5                    ! bars; unknowns: middle and end of each
    real(DP), parameter :: BAR(3, 3) = reshape(real([7, 1, -8, 1, 7, -8, -8, -8, 16], DP), [3, 3]) / 3.0_DP   ! end, end, middle
    real(DP) :: a(2 * N, 2 * N), linear(N, N)
    integer :: ends(2, 2 * N), unknown(3), e, i, j
    type(sparse_type) :: interpolation, coarse
    type(error_type), allocatable :: error
    a = 0
    linear = 0
    do e = 1, N
      unknown = [2 * e - 2, 2 * e, 2 * e - 1]
      do j = 1, 3
        do i = 1, 3
          if (min(unknown(i), unknown(j)) > 0) a(unknown(i), unknown(j)) = a(unknown(i), unknown(j)) + BAR(i, j)
        end do
      end do
      ends(:, 2 * e - 1) = [2 * e - 2, 2 * e]
      ends(:, 2 * e) = 2 * e
      linear(e, e) = 2
    end do
    do e = 2, N
      linear(e - 1, e) = -1
    end do
    linear(N, N) = 1
    call build_midside_interpolation(ends, interpolation)
    call suite%near('a middle between two ends', maxval(abs(dense(interpolation) - mean_of_ends(ends, N))), 0.0_DP, 0.0_DP)
    call project_to_corners(interpolation, upper(a), coarse, error)
    call suite%that('no error', .not. allocated(error))
    call suite%near('linear bars', maxval(abs(dense(coarse) - linear)), 0.0_DP, 1.0e-14_DP)
    call suite%that('the diagonal comes first', all(coarse%column(coarse%first(:N)) == [(i, i=1, N)]))
  end subroutine test_bar


  !> Any symmetric matrix, ends before, after and beside their middles, one edge with both ends fixed: the dense product.
  subroutine test_dense()
    integer, parameter :: ENDS(2, 7) = reshape([4, 6, 2, 2, 2, 4, 4, 4, 0, 0, 6, 6, 6, 0], [2, 7])
    real(DP) :: a(7, 7), p(7, 3), product(3, 3)
    integer :: i, j
    type(sparse_type) :: interpolation, coarse
    type(error_type), allocatable :: error
    do j = 1, 7
      do i = 1, 7
        a(i, j) = sin(real(i + j, DP)) + cos(real(i * j, DP))
      end do
    end do
    call build_midside_interpolation(ENDS, interpolation)
    p = mean_of_ends(ENDS, 3)
    call suite%near('means of ends', maxval(abs(dense(interpolation) - p)), 0.0_DP, 0.0_DP)
    call project_to_corners(interpolation, upper(a), coarse, error)
    product = matmul(transpose(p), matmul(a, p))
    do j = 1, 3
      product(j + 1:, j) = 0
    end do
    call suite%near('the dense product', maxval(abs(dense(coarse) - product)), 0.0_DP, 1.0e-14_DP)
  end subroutine test_dense


  !> P by its definition.
  pure function mean_of_ends(ends, n_corners) result(p)
    integer, intent(in) :: ends(:, :), n_corners
    real(DP) :: p(size(ends, 2), n_corners)
    integer, allocatable :: corners(:)
    integer :: i, k
    corners = pack([(i, i=1, size(ends, 2))], [(ends(1, i) == i, i=1, size(ends, 2))])
    do k = 1, n_corners
      p(:, k) = 0.5_DP * real(count(ends == corners(k), dim=1), DP)
    end do
  end function mean_of_ends


  !> The upper triangle as a sparse matrix.
  function upper(a) result(matrix)
    real(DP), intent(in) :: a(:, :)
    type(sparse_type) :: matrix
    type(error_type), allocatable :: error
    integer :: i, j, n
    n = size(a, 1)
    call sparse_from_triplets(n, n, [((i, j=i, n), i=1, n)], [((j, j=i, n), i=1, n)], [((a(i, j), j=i, n), i=1, n)], matrix, error)
  end function upper


  !> A sparse matrix as a dense one.
  pure function dense(matrix) result(a)
    type(sparse_type), intent(in) :: matrix
    real(DP) :: a(matrix%n_rows, matrix%n_columns)
    integer :: i, p
    a = 0
    do i = 1, matrix%n_rows
      do p = matrix%first(i), matrix%first(i + 1) - 1
        a(i, matrix%column(p)) = a(i, matrix%column(p)) + matrix%value(p)
      end do
    end do
  end function dense

end program test_midside_interpolation
