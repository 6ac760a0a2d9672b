!> Unit test of krylov: convergence in the steps that theory allows, true residuals, and every exit; never NaN.
!! SPDX-License-Identifier: GPL-3.0-or-later
module krylov_samples
  use amontons_kinds, only: DP
  use amontons_factorization, only: cholesky_type, solve
  use amontons_krylov, only: operator_type
  implicit none
  private
  public :: dense_operator_type, factor_operator_type, identity_type

  !> A dense matrix as an operator that counts.
  type, extends(operator_type) :: dense_operator_type
    real(DP), allocatable :: a(:, :)
    integer :: n_applied = 0
  contains
    procedure :: apply => apply_dense
  end type dense_operator_type

  !> The inverse of a factorised matrix.
  type, extends(operator_type) :: factor_operator_type
    type(cholesky_type), pointer :: factor => null()
  contains
    procedure :: apply => apply_factor
  end type factor_operator_type

  !> No preconditioner; it counts too.
  type, extends(operator_type) :: identity_type
    integer :: n_applied = 0
  contains
    procedure :: apply => apply_identity
  end type identity_type

contains

  subroutine apply_dense(self, x, y)
    class(dense_operator_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)
    real(DP), intent(out) :: y(:)
    y = matmul(self%a, x)
    self%n_applied = self%n_applied + 1
  end subroutine apply_dense


  subroutine apply_identity(self, x, y)
    class(identity_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)
    real(DP), intent(out) :: y(:)
    y = x
    self%n_applied = self%n_applied + 1
  end subroutine apply_identity


  !> y = A^-1 x.
  subroutine apply_factor(self, x, y)
    class(factor_operator_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)
    real(DP), intent(out) :: y(:)
    call solve(self%factor, x, y)
  end subroutine apply_factor

end module krylov_samples

program test_krylov
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_factorization, only: cholesky_type, analyse, factorise
  use amontons_krylov, only: matrix_operator_type, krylov_options_type, krylov_report_type, &
    gmres, conjugate_gradients, KRYLOV_CONVERGED, KRYLOV_MAX_ITERATIONS, KRYLOV_STAGNATED, KRYLOV_INDEFINITE, &
    KRYLOV_NOT_FINITE
  use krylov_samples, only: dense_operator_type, factor_operator_type, identity_type
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(identity_type) :: identity
  type(error_type), allocatable :: error
  integer, parameter :: SIZES(4) = [1, 2, 5, 100]
  integer :: k
  call random_seed(put=[(7 * k, k=1, 64)])
  do k = 1, size(SIZES)
    call test_gmres(SIZES(k))
    call test_gradients(SIZES(k))
  end do
  call test_factor()
  call test_friction()
  call test_guesses()
  call test_singular()
  call test_exits()
  call suite%finish()

contains

  !> A random unsymmetric matrix.
  function random_square(n) result(a)
    integer, intent(in) :: n
    real(DP) :: a(n, n)
    call random_number(a)
    a = a - 0.5_DP
  end function random_square


  !> A random symmetric positive definite matrix with eigenvalues of at least 1.
  function random_definite(n) result(a)
    integer, intent(in) :: n
    real(DP) :: a(n, n)
    integer :: i
    a = random_square(n)
    a = matmul(a, transpose(a))
    do i = 1, n
      a(i, i) = a(i, i) + 1
    end do
  end function random_definite


  !> |b - A x| / |b|.
  real(DP) function residual(a, x, b)
    real(DP), intent(in) :: a(:, :), x(:), b(:)
    residual = norm2(b - matmul(a, x)) / norm2(b)
  end function residual


  !> Without a preconditioner GMRES ends in at most n steps; restarted often it still converges on a definite matrix.
  subroutine test_gmres(n)
    integer, intent(in) :: n
    type(dense_operator_type) :: a
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    real(DP) :: b(n), x(n), again(n)
    a%a = random_square(n)
    call random_number(b)
    options%tolerance = 1.0e-10_DP
    x = 0
    call gmres(a, identity, b, x, options, report, error)
    call suite%that('gmres: converged', report%status == KRYLOV_CONVERGED .and. .not. allocated(error))
    call suite%that('gmres: in at most n steps', report%n_iterations <= n)
    call suite%near('gmres: true residual', residual(a%a, x, b), 0.0_DP, 1.0e-10_DP)
    call suite%near('gmres: reports the true residual', report%residual, residual(a%a, x, b), 1.0e-12_DP)
    again = 0
    call gmres(a, identity, b, again, options, report, error)
    call suite%that('gmres: bitwise the same again', all(abs(x - again) <= 0))
    a%a = random_definite(n)
    options%restart = 7
    options%max_iterations = 2000
    x = 0
    call gmres(a, identity, b, x, options, report, error)
    call suite%that('gmres restarted: converged', report%status == KRYLOV_CONVERGED)
    call suite%near('gmres restarted: true residual', residual(a%a, x, b), 0.0_DP, 1.0e-10_DP)
  end subroutine test_gmres


  subroutine test_gradients(n)
    integer, intent(in) :: n
    type(dense_operator_type) :: a
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    real(DP) :: b(n), x(n)
    a%a = random_definite(n)
    call random_number(b)
    options%tolerance = 1.0e-10_DP
    x = 0
    call conjugate_gradients(a, identity, b, x, options, report)
    call suite%that('conjugate gradients: converged', report%status == KRYLOV_CONVERGED)
    call suite%that('conjugate gradients: in about n steps', report%n_iterations <= n + n / 4)
    call suite%near('conjugate gradients: true residual', residual(a%a, x, b), 0.0_DP, 1.0e-10_DP)
    call suite%near('conjugate gradients: report it', report%residual, residual(a%a, x, b), 1.0e-12_DP)
  end subroutine test_gradients


  !> A chain of springs, fixed at one end, upper triangle.
  subroutine make_chain(n, matrix)
    integer, intent(in) :: n
    type(sparse_type), intent(out) :: matrix
    integer :: i
    call sparse_from_triplets(n, n, [(i, i=1, n), (i, i=1, n - 1)], [(i, i=1, n), (i + 1, i=1, n - 1)], &
                       [(2.0_DP, i=1, n - 1), 1.0_DP, (-1.0_DP, i=1, n - 1)], matrix, error)
  end subroutine make_chain


  !> With the factor of the matrix itself one step is enough; with an old factor a few.
  subroutine test_factor()
    integer, parameter :: N = 500
    type(sparse_type), target :: matrix
    type(cholesky_type), target :: factor
    type(matrix_operator_type) :: a
    type(factor_operator_type) :: preconditioner
    type(krylov_report_type) :: report
    real(DP) :: b(N), x(N), change(N)
    integer :: status
    call make_chain(N, matrix)
    call analyse(factor, matrix, error=error)
    call factorise(factor, matrix, status, error=error)
    a%matrix => matrix
    preconditioner%factor => factor
    call random_number(b)
    x = 0
    call gmres(a, preconditioner, b, x, krylov_options_type(), report, error)
    call suite%that('gmres with the factor: one step', report%status == KRYLOV_CONVERGED .and. report%n_iterations == 1)
    x = 0
    call conjugate_gradients(a, preconditioner, b, x, krylov_options_type(), report)
    call suite%that('gradients with the factor: one step', report%status == KRYLOV_CONVERGED .and. &
                    report%n_iterations <= 2)
    call random_number(change)
    matrix%value(matrix%first(:N)) = matrix%value(matrix%first(:N)) * (1 + 1.0e-6_DP * change)
    x = 0
    call conjugate_gradients(a, preconditioner, b, x, krylov_options_type(), report)
    call suite%that('gradients with an old factor: few steps', report%status == KRYLOV_CONVERGED .and. &
                    report%n_iterations <= 6)
  end subroutine test_factor


  !> A symmetric matrix with ten rows made unsymmetric, as friction does: the symmetric inverse leaves at most eleven
  !> different eigenvalues, so twelve steps are the most.
  subroutine test_friction()
    integer, parameter :: N = 80
    type(dense_operator_type) :: a, inverse
    type(krylov_report_type) :: report
    real(DP) :: b(N), x(N), symmetric(N, N)
    integer :: i
    symmetric = 0
    do i = 1, N
      symmetric(i, i) = 2 + real(i, DP) / N
    end do
    inverse%a = symmetric
    do i = 1, N
      inverse%a(i, i) = 1 / symmetric(i, i)
    end do
    a%a = symmetric
    a%a(:10, :) = a%a(:10, :) + 0.3_DP * reshape([(real(mod(7 * i, 11) - 5, DP) / 11, i=1, 10 * N)], [10, N])
    call random_number(b)
    x = 0
    call gmres(a, inverse, b, x, krylov_options_type(tolerance=1.0e-12_DP), report, error)
    call suite%that('friction: converged', report%status == KRYLOV_CONVERGED)
    call suite%that('friction: at most twelve steps', report%n_iterations <= 12)
    call suite%near('friction: true residual', residual(a%a, x, b), 0.0_DP, 1.0e-12_DP)
  end subroutine test_friction


  !> Good, useless and non-finite first guesses; a zero right-hand side.
  subroutine test_guesses()
    type(dense_operator_type) :: a
    type(krylov_report_type) :: report
    type(krylov_options_type) :: options
    real(DP) :: b(20), x(20), solution(20)
    a%a = random_definite(20)
    call random_number(solution)
    b = matmul(a%a, solution)
    x = solution
    call gmres(a, identity, b, x, options, report, error)
    call suite%that('a perfect guess: no step', report%status == KRYLOV_CONVERGED .and. report%n_iterations == 0)
    x = solution * (1 + 1.0e-6_DP)
    call conjugate_gradients(a, identity, b, x, options, report)
    call suite%near('a good guess: improved', residual(a%a, x, b), 0.0_DP, options%tolerance)
    x = 1.0e30_DP
    call gmres(a, identity, b, x, options, report, error)
    call suite%near('a bad guess: thrown away', residual(a%a, x, b), 0.0_DP, options%tolerance)
    x = ieee_value(1.0_DP, ieee_quiet_nan)
    call conjugate_gradients(a, identity, b, x, options, report)
    call suite%that('a guess of NaN: thrown away', all(ieee_is_finite(x)) .and. report%status == KRYLOV_CONVERGED)
    x = 1
    a%n_applied = 0
    call gmres(a, identity, 0 * b, x, options, report, error)
    call suite%that('b = 0: x = 0 without work', all(abs(x) <= 0) .and. a%n_applied == 0)
    call suite%that('b = 0: converged', report%status == KRYLOV_CONVERGED)
    options%absolute_tolerance = 2 * norm2(b)
    x = 1
    call conjugate_gradients(a, identity, b, x, options, report)
    call suite%that('b below the threshold: x = 0', all(abs(x) <= 0) .and. report%status == KRYLOV_CONVERGED)
  end subroutine test_guesses


  !> A singular matrix: solved where b is in the range, reported where it is not, with the least residual.
  subroutine test_singular()
    type(dense_operator_type) :: a
    type(krylov_report_type) :: report
    real(DP) :: b(10), x(10)
    integer :: i
    allocate (a%a(10, 10), source=0.0_DP)
    do i = 1, 9
      a%a(i, i) = real(i, DP)
    end do
    b = 1
    b(10) = 0
    x = 0
    call gmres(a, identity, b, x, krylov_options_type(), report, error)
    call suite%that('singular, b in the range: converged', report%status == KRYLOV_CONVERGED)
    b(10) = 1
    x = 0
    call gmres(a, identity, b, x, krylov_options_type(), report, error)
    call suite%that('singular, b not in the range: reported', report%status == KRYLOV_STAGNATED)
    call suite%near('singular: the least residual', report%residual, sqrt(0.1_DP), 1.0e-6_DP)
    call suite%that('singular: finite', all(ieee_is_finite(x)))
    a%a = 0
    x = 0
    call gmres(a, identity, b, x, krylov_options_type(), report, error)
    call suite%that('A = 0: reported', report%status == KRYLOV_STAGNATED .and. all(abs(x) <= 0))
    x = 0
    call conjugate_gradients(a, identity, b, x, krylov_options_type(), report)
    call suite%that('A = 0: reported by gradients', report%status == KRYLOV_INDEFINITE .and. all(abs(x) <= 0))
  end subroutine test_singular


  subroutine test_exits()
    type(dense_operator_type) :: a
    type(krylov_report_type) :: report
    real(DP) :: b(30), x(30)
    a%a = random_square(30)
    call random_number(b)
    x = 0
    call gmres(a, identity, b, x, krylov_options_type(max_iterations=5), report, error)
    call suite%that('gmres: too many', report%status == KRYLOV_MAX_ITERATIONS .and. report%n_iterations == 5)
    call suite%that('gmres: better than nothing', report%residual < 1)
    call suite%near('gmres: too many, true residual', report%residual, residual(a%a, x, b), 1.0e-12_DP)
    x = 0
    call gmres(a, identity, b, x, krylov_options_type(max_iterations=0), report, error)
    call suite%that('gmres: none allowed', report%status == KRYLOV_MAX_ITERATIONS .and. report%n_iterations == 0)
    a%a = -random_definite(30)
    x = 0
    call conjugate_gradients(a, identity, b, x, krylov_options_type(), report)
    call suite%that('gradients: indefinite', report%status == KRYLOV_INDEFINITE .and. all(ieee_is_finite(x)))
    a%a = -a%a
    x = 0
    call conjugate_gradients(a, identity, b, x, krylov_options_type(max_iterations=5), report)
    call suite%that('gradients: too many', report%status == KRYLOV_MAX_ITERATIONS .and. report%n_iterations == 5)
    a%a(3, 3) = ieee_value(1.0_DP, ieee_quiet_nan)
    x = 0
    call gmres(a, identity, b, x, krylov_options_type(), report, error)
    call suite%that('gmres: NaN reported', report%status == KRYLOV_NOT_FINITE .and. all(ieee_is_finite(x)))
    x = 0
    call conjugate_gradients(a, identity, b, x, krylov_options_type(), report)
    call suite%that('gradients: NaN reported', report%status == KRYLOV_NOT_FINITE .and. all(ieee_is_finite(x)))
    b(1) = ieee_value(1.0_DP, ieee_quiet_nan)
    call gmres(a, identity, b, x, krylov_options_type(), report, error)
    call suite%that('gmres: NaN in b reported', report%status == KRYLOV_NOT_FINITE .and. all(ieee_is_finite(x)))
  end subroutine test_exits

end program test_krylov
