!> Interfaces of the BLAS and LAPACK routines in use.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A module that works in one precision renames them (getrf => dgetrf), so that `dense.inc` serves both.
!! Reference: Anderson et al., LAPACK Users' Guide, 3rd ed., SIAM 1999.
module amontons_blas_lapack
  use amontons_kinds, only: DP, SP
  implicit none
  private
  public :: dgetrf, dlaswp, dtrsm, dgemm, dgetrs, dpotrf, dpotri, dgemv
  public :: sgetrf, slaswp, strsm, sgemm, sgetrs, spotrf, spotri, sgemv
  public :: dgesv, dgecon, dsyev, dgelsd, dgeqp3, dormqr

  interface
    subroutine dgetrf(m, n, a, lda, ipiv, info)
      import :: DP
      integer, intent(in) :: m, n, lda
      real(DP), intent(inout) :: a(lda, *)
      integer, intent(out) :: ipiv(*), info
    end subroutine dgetrf

    subroutine dlaswp(n, a, lda, k1, k2, ipiv, incx)
      import :: DP
      integer, intent(in) :: n, lda, k1, k2, ipiv(*), incx
      real(DP), intent(inout) :: a(lda, *)
    end subroutine dlaswp

    subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
      import :: DP
      character(1), intent(in) :: side, uplo, transa, diag
      integer, intent(in) :: m, n, lda, ldb
      real(DP), intent(in) :: alpha, a(lda, *)
      real(DP), intent(inout) :: b(ldb, *)
    end subroutine dtrsm

    subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
      import :: DP
      character(1), intent(in) :: transa, transb
      integer, intent(in) :: m, n, k, lda, ldb, ldc
      real(DP), intent(in) :: alpha, a(lda, *), b(ldb, *), beta
      real(DP), intent(inout) :: c(ldc, *)
    end subroutine dgemm

    subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
      import :: DP
      character(1), intent(in) :: trans
      integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
      real(DP), intent(in) :: a(lda, *)
      real(DP), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
    end subroutine dgetrs

    subroutine dpotrf(uplo, n, a, lda, info)
      import :: DP
      character(1), intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(DP), intent(inout) :: a(lda, *)
      integer, intent(out) :: info
    end subroutine dpotrf

    subroutine dpotri(uplo, n, a, lda, info)
      import :: DP
      character(1), intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(DP), intent(inout) :: a(lda, *)
      integer, intent(out) :: info
    end subroutine dpotri

    subroutine dgemv(trans, m, n, alpha, a, lda, x, incx, beta, y, incy)
      import :: DP
      character(1), intent(in) :: trans
      integer, intent(in) :: m, n, lda, incx, incy
      real(DP), intent(in) :: alpha, beta, a(lda, *), x(*)
      real(DP), intent(inout) :: y(*)
    end subroutine dgemv

    subroutine sgetrf(m, n, a, lda, ipiv, info)
      import :: SP
      integer, intent(in) :: m, n, lda
      real(SP), intent(inout) :: a(lda, *)
      integer, intent(out) :: ipiv(*), info
    end subroutine sgetrf

    subroutine slaswp(n, a, lda, k1, k2, ipiv, incx)
      import :: SP
      integer, intent(in) :: n, lda, k1, k2, ipiv(*), incx
      real(SP), intent(inout) :: a(lda, *)
    end subroutine slaswp

    subroutine strsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
      import :: SP
      character(1), intent(in) :: side, uplo, transa, diag
      integer, intent(in) :: m, n, lda, ldb
      real(SP), intent(in) :: alpha, a(lda, *)
      real(SP), intent(inout) :: b(ldb, *)
    end subroutine strsm

    subroutine sgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
      import :: SP
      character(1), intent(in) :: transa, transb
      integer, intent(in) :: m, n, k, lda, ldb, ldc
      real(SP), intent(in) :: alpha, a(lda, *), b(ldb, *), beta
      real(SP), intent(inout) :: c(ldc, *)
    end subroutine sgemm

    subroutine sgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
      import :: SP
      character(1), intent(in) :: trans
      integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
      real(SP), intent(in) :: a(lda, *)
      real(SP), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
    end subroutine sgetrs

    subroutine spotrf(uplo, n, a, lda, info)
      import :: SP
      character(1), intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(SP), intent(inout) :: a(lda, *)
      integer, intent(out) :: info
    end subroutine spotrf

    subroutine spotri(uplo, n, a, lda, info)
      import :: SP
      character(1), intent(in) :: uplo
      integer, intent(in) :: n, lda
      real(SP), intent(inout) :: a(lda, *)
      integer, intent(out) :: info
    end subroutine spotri

    subroutine sgemv(trans, m, n, alpha, a, lda, x, incx, beta, y, incy)
      import :: SP
      character(1), intent(in) :: trans
      integer, intent(in) :: m, n, lda, incx, incy
      real(SP), intent(in) :: alpha, beta, a(lda, *), x(*)
      real(SP), intent(inout) :: y(*)
    end subroutine sgemv

    subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
      import :: DP
      integer, intent(in) :: n, nrhs, lda, ldb
      real(DP), intent(inout) :: a(lda, *), b(ldb, *)
      integer, intent(out) :: ipiv(*), info
    end subroutine dgesv

    subroutine dgecon(norm, n, a, lda, anorm, rcond, work, iwork, info)
      import :: DP
      character(1), intent(in) :: norm
      integer, intent(in) :: n, lda
      real(DP), intent(in) :: a(lda, *), anorm
      real(DP), intent(out) :: rcond, work(*)
      integer, intent(out) :: iwork(*), info
    end subroutine dgecon

    subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
      import :: DP
      character(1), intent(in) :: jobz, uplo
      integer, intent(in) :: n, lda, lwork
      real(DP), intent(inout) :: a(lda, *)
      real(DP), intent(out) :: w(*), work(*)
      integer, intent(out) :: info
    end subroutine dsyev

    subroutine dgelsd(m, n, nrhs, a, lda, b, ldb, s, rcond, rank, work, lwork, iwork, info)
      import :: DP
      integer, intent(in) :: m, n, nrhs, lda, ldb, lwork
      real(DP), intent(inout) :: a(lda, *), b(ldb, *)
      real(DP), intent(in) :: rcond
      real(DP), intent(out) :: s(*), work(*)
      integer, intent(out) :: rank, iwork(*), info
    end subroutine dgelsd

    subroutine dgeqp3(m, n, a, lda, jpvt, tau, work, lwork, info)
      import :: DP
      integer, intent(in) :: m, n, lda, lwork
      real(DP), intent(inout) :: a(lda, *)
      integer, intent(inout) :: jpvt(*)
      real(DP), intent(out) :: tau(*), work(*)
      integer, intent(out) :: info
    end subroutine dgeqp3

    subroutine dormqr(side, trans, m, n, k, a, lda, tau, c, ldc, work, lwork, info)
      import :: DP
      character(1), intent(in) :: side, trans
      integer, intent(in) :: m, n, k, lda, ldc, lwork
      real(DP), intent(in) :: a(lda, *), tau(*)
      real(DP), intent(inout) :: c(ldc, *)
      real(DP), intent(out) :: work(*)
      integer, intent(out) :: info
    end subroutine dormqr
  end interface

end module amontons_blas_lapack
