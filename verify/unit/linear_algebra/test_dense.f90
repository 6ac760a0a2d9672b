!> Unit test of dense: residual ratios as in LAPACK's own tests, and the exits for singular and non-finite matrices.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_dense
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_kinds, only: DP
  use amontons_dense, only: solve_small, invert_small, solve_symmetric_eigen, least_squares, invert_spd, &
    multiply_dense_transpose, multiply_triangular, factorise_dense, solve_dense, find_matrix_scales, &
    is_rank_deficient, &
    DENSE_OK, DENSE_SINGULAR, DENSE_FAILED
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: SIZES(4) = [1, 2, 5, 100]
  integer :: k
  call random_seed(put=[(13 * k, k=1, 64)])
  do k = 1, size(SIZES)
    call test_solve(SIZES(k))
    call test_eigen(SIZES(k))
  end do
  call test_known()
  call test_singular()
  call test_rank_lost()
  call test_not_finite()
  call test_least_squares()
  call test_positive()
  call test_threads()
  call suite%finish()

contains

  !> The 1-norm.
  pure real(DP) function norm_1(a)
    real(DP), intent(in) :: a(:, :)
    norm_1 = maxval([0.0_DP, sum(abs(a), 1)])
  end function norm_1


  !> The unit matrix.
  pure function unit(n) result(a)
    integer, intent(in) :: n
    real(DP) :: a(n, n)
    integer :: i
    a = 0
    do i = 1, n
      a(i, i) = 1
    end do
  end function unit


  subroutine test_solve(n)
    integer, intent(in) :: n
    real(DP) :: a(n, n), b(n, 3), x(n, 3), y(n), inverse(n, n), ratio
    integer :: status
    call random_number(a)
    call random_number(b)
    a = a - 0.5_DP
    call solve_small(a, b, x, status)
    ratio = norm_1(matmul(a, x) - b) / (norm_1(a) * norm_1(x) * real(n, DP) * epsilon(1.0_DP))
    call suite%that('solve: status', status == DENSE_OK)
    call suite%near('solve: ratio', ratio, 0.0_DP, 30.0_DP)
    call invert_small(a, inverse, status)
    call suite%that('invert: status', status == DENSE_OK)
    ratio = norm_1(matmul(a, inverse) - unit(n)) / (norm_1(a) * norm_1(inverse) * real(n, DP) * epsilon(1.0_DP))
    call suite%near('invert: ratio', ratio, 0.0_DP, 30.0_DP)
    call solve_small(a, b(:, 2), y, status)
    call suite%near('solve: one right-hand side as several', maxval(abs(y - x(:, 2))), 0.0_DP, &
                    1.0e-10_DP * maxval(abs(x)))
  end subroutine test_solve


  subroutine test_eigen(n)
    integer, intent(in) :: n
    real(DP) :: a(n, n), v(n, n), w(n), residual(n, n)
    integer :: status, j
    call random_number(a)
    a = a + transpose(a) - 1
    call solve_symmetric_eigen(a, w, v, status)
    call suite%that('eigen: status', status == DENSE_OK)
    call suite%that('eigen: ascending', all(w(2:) >= w(:n - 1)))
    residual = matmul(a, v)
    do j = 1, n
      residual(:, j) = residual(:, j) - w(j) * v(:, j)
    end do
    call suite%near('eigen: ratio', norm_1(residual) / (norm_1(a) * real(n, DP) * epsilon(1.0_DP)), 0.0_DP, 30.0_DP)
    call suite%near('eigen: orthonormal', norm_1(matmul(transpose(v), v) - unit(n)) / (real(n, DP) * epsilon(1.0_DP)), &
                    0.0_DP, 30.0_DP)
  end subroutine test_eigen


  !> Matrices with a known answer.
  subroutine test_known()
    real(DP) :: w(2), v(2, 2), x(2)
    integer :: status
    call solve_symmetric_eigen(reshape([2.0_DP, 1.0_DP, 1.0_DP, 2.0_DP], [2, 2]), w, v, status)
    call suite%near('eigenvalue 1 of [2 1; 1 2]', w(1), 1.0_DP, 1.0e-14_DP)
    call suite%near('eigenvalue 2 of [2 1; 1 2]', w(2), 3.0_DP, 1.0e-14_DP)
    call solve_small(reshape([1.0e-200_DP, 0.0_DP, 0.0_DP, 2.0e-200_DP], [2, 2]), [1.0e-200_DP, 1.0e-200_DP], x, status)
    call suite%near('small numbers are not singular', x(2), 0.5_DP, 1.0e-15_DP)
  end subroutine test_known


  subroutine test_singular()
    real(DP) :: hilbert(20, 20), hilbert_inverse(20, 20), inverse(2, 2), x(20), y(2)
    integer :: status, i, j
    call solve_small(reshape([1.0_DP, 2.0_DP, 2.0_DP, 4.0_DP], [2, 2]), [1.0_DP, 1.0_DP], y, status)
    call suite%that('singular: reported', status == DENSE_SINGULAR)
    call suite%that('singular: x is 0', all(abs(y) <= 0))
    call invert_small(reshape([1.0_DP, 2.0_DP, 2.0_DP, 4.0_DP], [2, 2]), inverse, status)
    call suite%that('inverse of a singular matrix: reported', status == DENSE_SINGULAR)
    hilbert = reshape([((1 / real(i + j - 1, DP), i=1, 20), j=1, 20)], [20, 20])
    call solve_small(hilbert, [(1.0_DP, i=1, 20)], x, status)
    call suite%that('Hilbert matrix of 20: singular to working precision', status == DENSE_SINGULAR)
    call invert_small(hilbert, hilbert_inverse, status)
    call suite%that('its inverse: reported', status == DENSE_SINGULAR .and. all(abs(hilbert_inverse) <= 0))
    call solve_small(hilbert(:6, :6), [(sum(hilbert(i, :6)), i=1, 6)], x(:6), status)
    call suite%near('Hilbert matrix of 6', maxval(abs(x(:6) - 1)), 0.0_DP, 1.0e-8_DP)
  end subroutine test_singular


  !> Points connected in pairs by springs of very different stiffness, free as a whole: singular whatever their number. Supported
  !! at one point by a spring of relative stiffness 1e-9: not singular.
  subroutine test_rank_lost()
    integer, parameter :: N(3) = [3, 60, 700]
    real(DP), allocatable :: a(:, :), lu(:, :), row(:), column(:)
    real(DP) :: draw
    integer, allocatable :: pivots(:)
    integer :: status, i, j, m, held, stiff
    logical :: is_lost
    do m = 1, size(N)
      allocate (a(N(m), N(m)), source=0.0_DP)
      allocate (pivots(N(m)), row(N(m)), column(N(m)))
      do i = 1, N(m)
        do j = 1, i - 1
          call random_number(draw)
          draw = 10.0_DP**(4.0_DP * draw - 2.0_DP)
          a(i, j) = -draw
          a(j, i) = -draw
          a(i, i) = a(i, i) + draw
          a(j, j) = a(j, j) + draw
        end do
      end do
      do stiff = 0, 1                              ! one law much stiffer than all others does not change the rank
        do held = stiff, 1
          lu = a
          lu(1, 1) = lu(1, 1) * (1.0_DP + 1.0e-9_DP * real(held, DP))
          lu(2, :) = lu(2, :) * 10.0_DP**(14 * stiff)
          call find_matrix_scales(lu, row, column)
          call factorise_dense(lu, pivots, status)
          is_lost = is_rank_deficient(lu, pivots, row, column)
          if (held == 0) call suite%that('rank: springs that nothing holds', status /= DENSE_OK .or. is_lost)
          if (held == 1) call suite%that('rank: springs that are held', status == DENSE_OK .and. .not. is_lost)
        end do
      end do
      deallocate (a, pivots, row, column)
    end do
  end subroutine test_rank_lost


  subroutine test_not_finite()
    real(DP) :: a(2, 2), x(2), v(2, 2)
    integer :: status, rank
    a = 1
    a(2, 1) = ieee_value(1.0_DP, ieee_quiet_nan)
    call solve_small(a, [1.0_DP, 1.0_DP], x, status)
    call suite%that('NaN: solve', status == DENSE_FAILED .and. all(abs(x) <= 0))
    call solve_symmetric_eigen(a, x, v, status)
    call suite%that('NaN: eigen', status == DENSE_FAILED)
    call least_squares(a, [1.0_DP, 1.0_DP], 1.0e-10_DP, x, rank, status)
    call suite%that('NaN: least squares', status == DENSE_FAILED)
  end subroutine test_not_finite


  !> The residual is orthogonal to the columns; without full rank the solution is orthogonal to the null space.
  subroutine test_least_squares()
    real(DP) :: a(8, 5), b(8), x(5)
    integer :: rank, status
    call random_number(a)
    call random_number(b)
    call least_squares(a, b, 1.0e-12_DP, x, rank, status)
    call suite%that('least squares: full rank', status == DENSE_OK .and. rank == 5)
    call suite%near('least squares: residual orthogonal', maxval(abs(matmul(transpose(a), matmul(a, x) - b))), &
                    0.0_DP, 1.0e-13_DP)
    a(:, 5) = a(:, 1) - 2 * a(:, 3)
    call least_squares(a, b, 1.0e-12_DP, x, rank, status)
    call suite%that('least squares: rank 4', rank == 4)
    call suite%near('least squares: residual orthogonal again', maxval(abs(matmul(transpose(a), matmul(a, x) - b))), &
                    0.0_DP, 1.0e-13_DP)
    call suite%near('least squares: smallest', x(1) - 2 * x(3) - x(5), 0.0_DP, 1.0e-13_DP)   ! a (1, 0, -2, 0, -1) = 0
    call least_squares(a(:2, :), b(:2), 1.0e-12_DP, x, rank, status)
    call suite%near('least squares: wide matrix solved', maxval(abs(matmul(a(:2, :), x) - b(:2))), 0.0_DP, 1.0e-13_DP)
  end subroutine test_least_squares


  !> The inverse of a positive definite matrix is its inverse, symmetric to the last bit; singular and nearly singular ones are
  !! detected. Products with transposed matrices equal those of matmul.
  subroutine test_positive()
    real(DP) :: left(9, 9), a(9, 9), inverse(9, 9), x(9), z(5), wide(9, 5)
    integer :: status
    call random_number(left)
    call random_number(x)
    call random_number(wide)
    a = matmul(left, transpose(left)) + unit(9)
    inverse = a
    call invert_spd(inverse, 1.0e-9_DP, status)
    call suite%that('positive: status', status == DENSE_OK)
    call suite%near('positive: inverse', norm_1(matmul(a, inverse) - unit(9)), 0.0_DP, 1.0e-12_DP)
    call suite%that('positive: symmetric', all(abs(inverse - transpose(inverse)) <= 0))
    call multiply_dense_transpose(wide, x, z)
    call suite%near('transposed product', maxval(abs(z - matmul(x, wide))), 0.0_DP, 1.0e-14_DP)
    a = a - unit(9)
    a(:, 9) = a(:, 8)
    a(9, :) = a(8, :)
    a(9, 9) = a(9, 9) * (1 + 1.0e-12_DP)
    call invert_spd(a, 1.0e-9_DP, status)
    call suite%that('positive: nearly singular', status == DENSE_SINGULAR)
    a = -unit(9)
    call invert_spd(a, 1.0e-9_DP, status)
    call suite%that('positive: negative', status == DENSE_SINGULAR)
  end subroutine test_positive


  !> LU and products of a matrix large enough for threads: they agree with matmul, repeat bitwise, and are equal for all numbers of
  !! threads.
  subroutine test_threads()
    use omp_lib, only: omp_set_num_threads, omp_get_max_threads
    integer, parameter :: N = 501
    real(DP), allocatable :: a(:, :), lu(:, :), again(:, :), l(:, :), x(:), y(:), z(:)
    integer :: pivots(N), pivots_again(N), status, n_threads, before, i
    allocate (a(N, N), x(N), y(N), z(N))
    call random_number(a)
    call random_number(x)
    l = a
    do i = 2, N
      l(:i - 1, i) = 0.0_DP
    end do
    before = omp_get_max_threads()
    do n_threads = 1, 3
      call omp_set_num_threads(n_threads)
      lu = a
      call factorise_dense(lu, pivots, status)
      again = a
      call factorise_dense(again, pivots_again, status)
      call suite%that('threads: LU', status == DENSE_OK)
      call suite%that('threads: the same bits', all(abs(lu - again) <= 0) .and. all(pivots == pivots_again))
      y = matmul(a, x)
      call solve_dense(lu, pivots, y)
      call suite%near('threads: solution', norm2(matmul(a, y) - matmul(a, x)) / (norm_1(a) * norm2(x) * N * epsilon(1.0_DP)), &
        0.0_DP, 30.0_DP)
      y = x
      call multiply_triangular(l, .false., y)
      call suite%near('threads: triangle', maxval(abs(y - matmul(l, x))), 0.0_DP, N * epsilon(1.0_DP) * N)
      y = x
      call multiply_triangular(l, .true., y)
      call suite%near('threads: triangle turned', maxval(abs(y - matmul(x, l))), 0.0_DP, N * epsilon(1.0_DP) * N)
      call multiply_dense_transpose(a, x, z)
      call suite%near('threads: turned', maxval(abs(z - matmul(x, a))), 0.0_DP, N * epsilon(1.0_DP) * N)
      lu = a
      lu(:, N) = 0.0_DP
      call factorise_dense(lu, pivots, status)
      call suite%that('threads: singular', status == DENSE_SINGULAR)
    end do
    call omp_set_num_threads(before)
  end subroutine test_threads

end program test_dense
