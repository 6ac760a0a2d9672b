!> Tests of the BLAS and LAPACK interfaces: each called once with a known answer, so that a wrong order or kind of arguments shows.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_blas_lapack
  use amontons_kinds, only: DP, SP
  use amontons_blas_lapack, only: dgetrf, dlaswp, dtrsm, dgemm, dgetrs, dpotrf, dpotri, dgemv, sgetrf, slaswp, strsm, sgemm, &
    sgetrs, spotrf, spotri, sgemv, dgesv, dgecon, dsyev, dgelsd
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: A(2, 2) = reshape([1.0_DP, 4.0_DP, 2.0_DP, 3.0_DP], [2, 2])   ! rows 1 2, 4 3: determinant -5
  real(DP), parameter :: S(2, 2) = reshape([4.0_DP, 2.0_DP, 2.0_DP, 5.0_DP], [2, 2])   ! L = 2 0, 1 2; inverse 5 -2, -2 4 over 16
  call check_double(suite)
  call check_single(suite)
  call check_products(suite)
  call check_spectra(suite)
  call check_least_squares(suite)
  call check_singular(suite)
  call suite%finish()

contains

  !> LU with its exchange of rows, its parts and its solution; Cholesky and the inverse.
  subroutine check_double(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: lu(2, 2), b(2, 1), l(2, 2)
    integer :: pivots(2), info
    lu = A
    call dgetrf(2, 2, lu, 2, pivots, info)
    call suite%that('dgetrf: the larger row first', info == 0 .and. pivots(1) == 2)
    call suite%near('dgetrf: product of the pivots', lu(1, 1) * lu(2, 2), 5.0_DP, 1.0e-14_DP)
    b(:, 1) = [5.0_DP, 10.0_DP]                    ! x = 1, 2
    call dgetrs('N', 2, 1, lu, 2, pivots, b, 2, info)
    call suite%near('dgetrs', norm2(b(:, 1) - [1.0_DP, 2.0_DP]), 0.0_DP, 1.0e-14_DP)
    b(:, 1) = [5.0_DP, 10.0_DP]
    call dlaswp(1, b, 2, 1, 2, pivots, 1)
    call suite%near('dlaswp', b(1, 1), 10.0_DP, 0.0_DP)
    call dtrsm('L', 'L', 'N', 'U', 2, 1, 1.0_DP, lu, 2, b, 2)
    call dtrsm('L', 'U', 'N', 'N', 2, 1, 1.0_DP, lu, 2, b, 2)
    call suite%near('dtrsm', norm2(b(:, 1) - [1.0_DP, 2.0_DP]), 0.0_DP, 1.0e-14_DP)
    l = S
    call dpotrf('L', 2, l, 2, info)
    call suite%near('dpotrf', abs(l(1, 1) - 2) + abs(l(2, 1) - 1) + abs(l(2, 2) - 2), 0.0_DP, 1.0e-14_DP)
    call dpotri('L', 2, l, 2, info)
    call suite%near('dpotri', abs(l(1, 1) - 0.3125_DP) + abs(l(2, 1) + 0.125_DP) + abs(l(2, 2) - 0.25_DP), 0.0_DP, 1.0e-14_DP)
    lu = A
    b(:, 1) = [5.0_DP, 10.0_DP]
    call dgesv(2, 1, lu, 2, pivots, b, 2, info)
    call suite%near('dgesv', norm2(b(:, 1) - [1.0_DP, 2.0_DP]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_double


  !> The same in single precision.
  subroutine check_single(suite)
    type(suite_type), intent(inout) :: suite
    real(SP) :: lu(2, 2), b(2, 1), l(2, 2), c(2, 2)
    integer :: pivots(2), info
    real(DP), parameter :: TOLERANCE = 10 * real(epsilon(1.0_SP), DP)
    lu = real(A, SP)
    call sgetrf(2, 2, lu, 2, pivots, info)
    b(:, 1) = [5.0_SP, 10.0_SP]
    call sgetrs('N', 2, 1, lu, 2, pivots, b, 2, info)
    call suite%near('sgetrs', real(norm2(b(:, 1) - [1.0_SP, 2.0_SP]), DP), 0.0_DP, TOLERANCE)
    b(:, 1) = [5.0_SP, 10.0_SP]
    call slaswp(1, b, 2, 1, 2, pivots, 1)
    call strsm('L', 'L', 'N', 'U', 2, 1, 1.0_SP, lu, 2, b, 2)
    call strsm('L', 'U', 'N', 'N', 2, 1, 1.0_SP, lu, 2, b, 2)
    call suite%near('strsm', real(norm2(b(:, 1) - [1.0_SP, 2.0_SP]), DP), 0.0_DP, TOLERANCE)
    l = real(S, SP)
    call spotrf('L', 2, l, 2, info)
    call spotri('L', 2, l, 2, info)
    call suite%near('spotri', real(abs(l(1, 1) - 0.3125_SP) + abs(l(2, 1) + 0.125_SP), DP), 0.0_DP, TOLERANCE)
    c = 1.0_SP
    call sgemm('T', 'N', 2, 2, 2, 2.0_SP, real(A, SP), 2, real(S, SP), 2, -1.0_SP, c, 2)
    call suite%near('sgemm', real(norm2(c - real(2 * matmul(transpose(A), S) - 1, SP)), DP), 0.0_DP, 1.0e-5_DP)
    b(:, 1) = 1.0_SP
    call sgemv('T', 2, 2, 2.0_SP, real(A, SP), 2, [1.0_SP, 3.0_SP], 1, -1.0_SP, b, 1)
    call suite%near('sgemv', real(norm2(b(:, 1) - [25.0_SP, 21.0_SP]), DP), 0.0_DP, 1.0e-5_DP)
  end subroutine check_single


  !> alpha A'B + beta C and alpha A'x + beta y.
  subroutine check_products(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: c(2, 2), y(2)
    c = 1.0_DP
    call dgemm('T', 'N', 2, 2, 2, 2.0_DP, A, 2, S, 2, -1.0_DP, c, 2)
    call suite%near('dgemm', norm2(c - (2 * matmul(transpose(A), S) - 1)), 0.0_DP, 1.0e-13_DP)
    y = 1.0_DP
    call dgemv('T', 2, 2, 2.0_DP, A, 2, [1.0_DP, 3.0_DP], 1, -1.0_DP, y, 1)
    call suite%near('dgemv', norm2(y - [25.0_DP, 21.0_DP]), 0.0_DP, 1.0e-13_DP)
  end subroutine check_products


  !> Eigenvalues and the condition.
  subroutine check_spectra(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: matrix(2, 2), w(2), work(100), rcond
    integer :: info, iwork(16), pivots(2)
    matrix = S
    call dsyev('V', 'L', 2, matrix, 2, w, work, size(work), info)
    call suite%near('dsyev: (9 -+ sqrt(17)) / 2', norm2(w - (9 + [-sqrt(17.0_DP), sqrt(17.0_DP)]) / 2), 0.0_DP, 1.0e-13_DP)
    call suite%near('dsyev: vectors', norm2(matmul(S, matrix) - matrix * spread(w, 1, 2)), 0.0_DP, 1.0e-13_DP)
    matrix = A
    call dgetrf(2, 2, matrix, 2, pivots, info)
    call dgecon('1', 2, matrix, 2, 5.0_DP, rcond, work, iwork, info)
    call suite%near('dgecon: 1 / (5 * 7/5)', rcond, 1.0_DP / 7, 1.0e-13_DP)
  end subroutine check_spectra


  !> A line through three points, and the least of all solutions where there are many.
  subroutine check_least_squares(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: matrix(3, 2), b(3, 1), values(2), work(5000)
    integer :: rank, info, iwork(500)
    matrix(:, 1) = 1.0_DP
    matrix(:, 2) = [0.0_DP, 1.0_DP, 2.0_DP]
    b(:, 1) = [1.0_DP, 2.0_DP, 6.0_DP]             ! 0.5 + 2.5 x
    call dgelsd(3, 2, 1, matrix, 3, b, 3, values, 1.0e-12_DP, rank, work, size(work), iwork, info)
    call suite%that('dgelsd: rank', rank == 2 .and. info == 0)
    call suite%near('dgelsd', norm2(b(:2, 1) - [0.5_DP, 2.5_DP]), 0.0_DP, 1.0e-13_DP)
    matrix = 1.0_DP
    b(:, 1) = 4.0_DP
    call dgelsd(3, 2, 1, matrix, 3, b, 3, values, 1.0e-12_DP, rank, work, size(work), iwork, info)
    call suite%that('dgelsd: rank 1', rank == 1)
    call suite%near('dgelsd: the shortest', norm2(b(:2, 1) - 2.0_DP), 0.0_DP, 1.0e-13_DP)
  end subroutine check_least_squares


  !> What has no factor is reported, with the place.
  subroutine check_singular(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: matrix(2, 2)
    integer :: pivots(2), info
    matrix = 1.0_DP
    call dgetrf(2, 2, matrix, 2, pivots, info)
    call suite%that('dgetrf: the second pivot is zero', info == 2)
    matrix = -S
    call dpotrf('L', 2, matrix, 2, info)
    call suite%that('dpotrf: not positive', info == 1)
  end subroutine check_singular

end program test_blas_lapack
