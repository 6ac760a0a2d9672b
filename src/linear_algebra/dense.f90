!> Dense linear algebra: LU, Cholesky inverse, eigenvalues, least squares.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Arguments are copied, never overwritten. LAPACK deliberately produces NaN when it probes the machine: floating-point traps
!! are masked around its calls. Reference: Anderson et al., LAPACK Users' Guide, 3rd ed., SIAM 1999.
module amontons_dense
  use, intrinsic :: ieee_arithmetic, only: ieee_all, ieee_get_status, ieee_is_finite, ieee_set_halting_mode, &
    ieee_set_status, ieee_status_type
  use amontons_kinds, only: DP, WP => DP
  use amontons_blas_lapack, only: getrf => dgetrf, laswp => dlaswp, trsm => dtrsm, gemm => dgemm, getrs => dgetrs, &
    potrf => dpotrf, potri => dpotri, gemv => dgemv, dgesv, dgecon, dsyev, dgelsd
  implicit none
  private
  public :: solve_small, invert_small, solve_symmetric_eigen, least_squares
  public :: factorise_dense, solve_dense, find_matrix_scales, is_rank_deficient, multiply_triangular, triangular_product, invert_spd
  public :: multiply_dense_transpose
  public :: DENSE_OK, DENSE_SINGULAR, DENSE_FAILED, MIN_THREADED_SIZE, BLOCK_COLUMNS

  integer, parameter :: DENSE_OK = 0
  integer, parameter :: DENSE_SINGULAR = 1     !< no unique solution
  integer, parameter :: MIN_THREADED_SIZE = 400    !< smallest matrix for threads [unknowns]
  integer, parameter :: BLOCK_COLUMNS = 96             !< columns of a task

  integer, parameter :: DENSE_FAILED = 2       !< NaN or infinity in the matrix, or the iteration did not converge

  real(DP), parameter :: TOL_SCALAR_PIVOT = 32 * epsilon(1.0_DP)   !< a pivot relative to its column, of a matrix of one unknown [-]

  !> A x = b for one or several right-hand sides.
  interface solve_small
    module procedure solve_vector, solve_matrix
  end interface solve_small

contains

  !> x = A^-1 b by LU with partial pivoting.
  subroutine solve_vector(a, b, x, status)
    real(DP), intent(in) :: a(:, :)            !< (n, n)
    real(DP), intent(in) :: b(:)               !< (n)
    real(DP), intent(out) :: x(:)              !< (n) 0 if the status is not DENSE_OK
    integer, intent(out) :: status             !< DENSE_...
    real(DP) :: solution(size(b), 1)
    call solve_matrix(a, reshape(b, [size(b), 1]), solution, status)
    x = solution(:, 1)
  end subroutine solve_vector


  !> X = A^-1 B by LU with partial pivoting. Singular means: to working precision, by an estimate of the condition number.
  subroutine solve_matrix(a, b, x, status)
    real(DP), intent(in) :: a(:, :)            !< (n, n)
    real(DP), intent(in) :: b(:, :)            !< (n, columns)
    real(DP), intent(out) :: x(:, :)           !< (n, columns) 0 if the status is not DENSE_OK
    integer, intent(out) :: status             !< DENSE_...
    real(DP) :: lu(size(a, 1), size(a, 1)), work(4 * size(a, 1)), norm, condition
    integer :: pivot(size(a, 1)), iwork(size(a, 1)), n, info
    type(ieee_status_type) :: environment
    n = size(a, 1)
    lu = a
    x = b
    status = DENSE_OK
    if (n == 0) return
    if (.not. all_finite(a) .or. .not. all_finite(b)) then
      status = DENSE_FAILED
    else
      norm = maxval(sum(abs(a), 1))
      call suspend_fp_traps(environment)
      call dgesv(n, size(b, 2), lu, n, pivot, x, n, info)
      condition = 0
      if (info == 0) call dgecon('1', n, lu, n, norm, condition, work, iwork, info)
      if (.not. condition > epsilon(condition)) status = DENSE_SINGULAR
      call ieee_set_status(environment)
    end if
    if (status /= DENSE_OK) x = 0
  end subroutine solve_matrix


  !> A^-1 by LU with partial pivoting. Singular means: to working precision, by the condition number.
  subroutine invert_small(a, inverse, status)
    real(DP), intent(in) :: a(:, :)            !< (n, n)
    real(DP), intent(out) :: inverse(:, :)     !< (n, n) 0 if the status is not DENSE_OK
    integer, intent(out) :: status             !< DENSE_...
    real(DP) :: lu(size(a, 1), size(a, 1)), condition
    integer :: pivot(size(a, 1)), i, n, info
    type(ieee_status_type) :: environment
    n = size(a, 1)
    lu = a
    inverse = 0
    do i = 1, n
      inverse(i, i) = 1
    end do
    status = DENSE_OK
    if (n == 0) return
    if (.not. all_finite(a)) then
      status = DENSE_FAILED
    else
      call suspend_fp_traps(environment)
      call dgesv(n, n, lu, n, pivot, inverse, n, info)
      condition = 0
      if (info == 0) condition = 1 / (maxval(sum(abs(a), 1)) * maxval(sum(abs(inverse), 1)))
      if (.not. condition > epsilon(condition)) status = DENSE_SINGULAR
      call ieee_set_status(environment)
    end if
    if (status /= DENSE_OK) inverse = 0
  end subroutine invert_small


  !> Eigenvalues in ascending order and orthonormal eigenvectors of a symmetric matrix.
  subroutine solve_symmetric_eigen(a, values, vectors, status)
    real(DP), intent(in) :: a(:, :)            !< (n, n) the upper triangle is read
    real(DP), intent(out) :: values(:)         !< (n) ascending
    real(DP), intent(out) :: vectors(:, :)     !< (n, n) in columns
    integer, intent(out) :: status             !< DENSE_OK or DENSE_FAILED
    real(DP), allocatable :: work(:)
    type(ieee_status_type) :: environment
    integer :: n, info
    n = size(a, 1)
    vectors = a
    values = 0
    status = DENSE_OK
    if (n == 0) return
    status = DENSE_FAILED
    if (.not. all_finite(a)) return
    allocate (work(34 * n))                    ! (NB + 2) n with the usual block size NB = 32
    call suspend_fp_traps(environment)
    call dsyev('V', 'U', n, vectors, n, values, work, size(work), info)
    call ieee_set_status(environment)
    if (info == 0) status = DENSE_OK
  end subroutine solve_symmetric_eigen


  !> Least-squares solution of A x = b of minimum norm, by the singular value decomposition.
  subroutine least_squares(a, b, tolerance, x, rank, status)
    real(DP), intent(in) :: a(:, :)            !< (m, n)
    real(DP), intent(in) :: b(:)               !< (m)
    real(DP), intent(in) :: tolerance          !< singular values below this fraction of the largest count as 0 [-]
    real(DP), intent(out) :: x(:)              !< (n)
    integer, intent(out) :: rank               !< of A
    integer, intent(out) :: status             !< DENSE_OK or DENSE_FAILED
    real(DP) :: copy(size(a, 1), size(a, 2)), right(max(size(a, 1), size(a, 2)), 1)
    real(DP) :: values(min(size(a, 1), size(a, 2))), best(1)
    real(DP), allocatable :: work(:)
    integer, allocatable :: iwork(:)
    integer :: m, n, n_iwork(1), info
    type(ieee_status_type) :: environment
    m = size(a, 1)
    n = size(a, 2)
    x = 0
    rank = 0
    status = DENSE_OK
    if (size(a) == 0) return
    status = DENSE_FAILED
    if (.not. all_finite(a) .or. .not. all_finite(reshape(b, [m, 1]))) return
    copy = a
    right = 0
    right(:m, 1) = b
    call suspend_fp_traps(environment)
    call dgelsd(m, n, 1, copy, m, right, size(right), values, tolerance, rank, best, -1, n_iwork, info)
    allocate (work(nint(best(1))), iwork(n_iwork(1)))
    call dgelsd(m, n, 1, copy, m, right, size(right), values, tolerance, rank, work, size(work), iwork, info)
    call ieee_set_status(environment)
    if (info == 0) status = DENSE_OK
    if (info == 0) x = right(:n, 1)
  end subroutine least_squares


  !> Saves the floating-point state and masks all traps until it is restored.
  subroutine suspend_fp_traps(environment)
    type(ieee_status_type), intent(out) :: environment
    call ieee_get_status(environment)
    call ieee_set_halting_mode(ieee_all, .false.)
  end subroutine suspend_fp_traps


  !> Row and column scales: the largest entry of each row, and of each column after the rows are scaled. They remove the effect of
  !! stiff laws beside soft ones on the rank.
  pure subroutine find_matrix_scales(a, row, column)
    real(DP), intent(in) :: a(:, :)            !< (n, n)
    real(DP), intent(out) :: row(:)            !< (n)
    real(DP), intent(out) :: column(:)         !< (n) [-]
    integer :: k
    row = 0.0_DP
    do k = 1, size(row)
      row = max(row, abs(a(:, k)))
    end do
    do k = 1, size(row)
      column(k) = maxval(abs(a(:, k)) / max(row, tiny(1.0_DP)))
    end do
  end subroutine find_matrix_scales


  !> Whether the LU factors of factorise_dense are those of a singular matrix: a pivot is negligible relative to its row and column.
  !! The rounding error of such a pivot grows with the square root of the number of sums.
  pure logical function is_rank_deficient(lu, pivots, row, column) result(is_lost)
    real(DP), intent(in) :: lu(:, :)           !< (n, n) L and U
    integer, intent(in) :: pivots(:)           !< (n) of `factorise_dense`
    real(DP), intent(in) :: row(:), column(:)  !< of `find_matrix_scales`, for the matrix before
    real(DP) :: least, moved(size(row)), other
    integer :: k
    least = TOL_SCALAR_PIVOT * sqrt(real(size(column), DP))
    moved = row
    do k = 1, size(pivots)                     ! row exchanges of LAPACK
      other = moved(k)
      moved(k) = moved(pivots(k))
      moved(pivots(k)) = other
    end do
    is_lost = .false.
    do k = 1, size(column)
      if (.not. abs(lu(k, k)) > least * column(k) * moved(k)) is_lost = .true.
    end do
  end function is_rank_deficient


  !> Whether all entries are finite.
  pure logical function all_finite(a)
    real(DP), intent(in) :: a(:, :)
    all_finite = all(ieee_is_finite(a))
  end function all_finite


  !> x = L x, or L' x, for a lower triangle. Threads share blocks of its rows, or columns.
  subroutine multiply_triangular(l, is_transposed, x)
    real(DP), contiguous, intent(in) :: l(:, :)   !< (n, n) lower triangle, zero above
    logical, intent(in) :: is_transposed
    real(DP), contiguous, intent(inout) :: x(:)   !< (n)
    real(DP) :: y(size(x))
    integer :: n, k, last
    n = size(x)
    if (n == 0) return
    y = x
    !$omp parallel do schedule(dynamic) private(last) if(n >= MIN_THREADED_SIZE)
    do k = 1, n, BLOCK_COLUMNS
      last = min(n, k + BLOCK_COLUMNS - 1)
      call multiply_triangular_block(n, l, is_transposed, k, last, x, y)
    end do
    !$omp end parallel do
    x = y
  end subroutine multiply_triangular


  !> Entries k to last of L x, or of L' x.
  subroutine multiply_triangular_block(n, l, is_transposed, k, last, x, y)
    integer, intent(in) :: n
    real(DP), intent(in) :: l(n, n)
    logical, intent(in) :: is_transposed
    integer, intent(in) :: k, last
    real(DP), intent(in) :: x(n)
    real(DP), intent(inout) :: y(n)
    if (is_transposed) then
      call gemv('T', n - k + 1, last - k + 1, 1.0_DP, l(k, k), n, x(k), 1, 0.0_DP, y(k), 1)
    else
      call gemv('N', last - k + 1, last, 1.0_DP, l(k, 1), n, x, 1, 0.0_DP, y(k), 1)
    end if
  end subroutine multiply_triangular_block


  !> Whether threads share the work on a matrix.
  logical function is_threaded(n)
!$  use omp_lib, only: omp_get_max_threads, omp_get_level
    integer, intent(in) :: n                   !< unknowns
    is_threaded = .false.
    if (n < MIN_THREADED_SIZE) return
!$  is_threaded = omp_get_level() == 0
!$  if (is_threaded) is_threaded = omp_get_max_threads() > 1
  end function is_threaded


  include 'dense.inc'

end module amontons_dense
