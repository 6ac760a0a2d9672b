!> Flexible GMRES and conjugate gradients with a general operator and preconditioner.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Both measure the true residual b - A x in the 2-norm; conjugate gradients also in the norm of the preconditioner, if a direction
!! may be inexact (`energy_tolerance`). Sums have a fixed order: results repeat bitwise. Nothing they return is ever NaN: after a
!! breakdown, x is the best iterate so far. Both work on parts of vectors, too, if the operator completes sums over its part to sums
!! over all of them (`complete`).
!! References: Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., SIAM 2003, sec. 6.5, 6.7, 9.4;
!! Sleijpen and van der Vorst, Computing 56 (1996) 141 (residuals computed anew);
!! Saad, SIAM J. Sci. Comput. 14 (1993) 461 (flexible GMRES); Giraud and Langou, IMA J. Numer. Anal. 22 (2002) 521.
module amontons_krylov
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER
  use amontons_sparse, only: sparse_type, multiply_symmetric
  implicit none
  private
  public :: operator_type, matrix_operator_type
  public :: krylov_options_type, krylov_report_type, gmres, conjugate_gradients
  public :: KRYLOV_CONVERGED, KRYLOV_MAX_ITERATIONS, KRYLOV_STAGNATED, KRYLOV_INDEFINITE, KRYLOV_NOT_FINITE

  integer, parameter :: KRYLOV_CONVERGED = 0    !< the residual is within the tolerance
  integer, parameter :: KRYLOV_MAX_ITERATIONS = 1     !< iteration limit reached
  integer, parameter :: KRYLOV_STAGNATED = 2    !< no direction lowers the residual any more: singular, or rounding
  integer, parameter :: KRYLOV_INDEFINITE = 3   !< conjugate gradients found a direction of zero or negative curvature
  integer, parameter :: KRYLOV_NOT_FINITE = 4   !< the operator, the preconditioner or b gave NaN or an infinity

  real(DP), parameter :: MAX_CYCLE_REDUCTION = 0.99_DP     !< a cycle that reduces the residual by less has stagnated

  integer, parameter :: SUM_LENGTH = 65536             !< of the parts of a scalar product; threads share longer vectors
  real(DP), parameter :: UPDATE_RATIO = 1.0e-4_DP    !< fall of the residual after which conjugate gradients compute it anew [-]

  real(DP), parameter :: SMALL_DRIFT = 0.1_DP        !< drift over the residual of the recurrence: up to it the next iterations
                                                     !! still reduce the true residual [-]

  real(DP), parameter :: TOL_ROUNDING = 64 * epsilon(1.0_DP)   !< a vector below this fraction of another one is rounding

  real(DP), parameter :: TOL_DEPENDENT_VECTOR = 1.0e-8_DP  !< sine of an angle too small to be useful: half of the digits

  !> A linear map of n numbers to n numbers.
  type, abstract :: operator_type
  contains
    procedure(apply_interface), deferred :: apply
    procedure :: complete => complete_sum
    procedure :: correct => leave_uncorrected
  end type operator_type

  abstract interface
    !> y = A x.
    subroutine apply_interface(self, x, y)
      import :: operator_type, DP
      class(operator_type), intent(inout) :: self   !< may hold workspace and counters
      real(DP), intent(in) :: x(:)                  !< (n)
      real(DP), intent(out) :: y(:)                 !< (n)
    end subroutine apply_interface
  end interface

  !> A symmetric matrix as an operator.
  type, extends(operator_type) :: matrix_operator_type
    type(sparse_type), pointer :: matrix => null()  !< upper triangle, not owned
  contains
    procedure :: apply => apply_matrix
  end type matrix_operator_type

  !> Stopping criteria. The residual must fall below max(tolerance |b|, absolute_tolerance).
  type :: krylov_options_type
    real(DP) :: tolerance = 1.0e-8_DP       !< of |b| [-]
    real(DP) :: absolute_tolerance = 0                   !< absolute tolerance [as b]
    integer :: max_iterations = 200
    integer :: restart = 100                !< most vectors kept by gmres
    real(DP) :: energy_tolerance = 0        !< conjugate gradients also end where r'z, the square of the residual in the norm
                                            !! of the preconditioner, is less than this squared times that of the start [-]
  end type krylov_options_type

  !> The outcome of a solution.
  type :: krylov_report_type
    integer :: status = KRYLOV_CONVERGED    !< KRYLOV_...
    integer :: n_iterations = 0             !< applications of the preconditioner
    real(DP) :: residual = 0                !< |b - A x| / |b|, recomputed at the end [-]
  end type krylov_report_type

  !> The vectors and the small least-squares problem of one cycle of GMRES.
  type :: gmres_cycle_type
    real(DP), allocatable :: v(:, :)        !< (n, m + 1) orthonormal
    real(DP), allocatable :: z(:, :)        !< (n, m) preconditioned
    real(DP), allocatable :: h(:, :)        !< (m + 1, m) Hessenberg matrix, made triangular by rotations
    real(DP), allocatable :: c(:), s(:)     !< (m) cosines and sines of the rotations
    real(DP), allocatable :: g(:)           !< (m + 1) rotated right-hand side; |g(k + 1)| is the residual after k steps
  end type gmres_cycle_type

contains

  !> Solves A x = b for a general A by restarted flexible GMRES, preconditioned from the right.
  !> Cost of an iteration: one application of each operator, and k vector operations in the k-th.
  subroutine gmres(operator, preconditioner, b, x, options, report, error)
    class(operator_type), intent(inout) :: operator         !< A
    class(operator_type), intent(inout) :: preconditioner   !< an approximate inverse of A; may change between calls
    real(DP), intent(in) :: b(:)                            !< (n)
    real(DP), intent(inout) :: x(:)                         !< (n) in: first guess; out: solution
    type(krylov_options_type), intent(in) :: options
    type(krylov_report_type), intent(out) :: report
    type(error_type), allocatable, intent(out) :: error
    type(gmres_cycle_type) :: basis
    real(DP) :: r(size(b)), best(size(b)), target_residual, size_of_b, size_of_r, before
    call check_trivial_solution(operator, b, x, options, r, size_of_b, target_residual, report)
    if (report%status /= KRYLOV_MAX_ITERATIONS) return
    call allocate_cycle(basis, size(b), min(options%restart, options%max_iterations), error)
    if (.not. allocated(basis%g)) return
    before = length_of(operator, r)
    do while (report%status == KRYLOV_MAX_ITERATIONS .and. report%n_iterations < options%max_iterations)
      best = x
      call run_gmres_cycle(operator, preconditioner, r, target_residual, options, basis, x, report)
      if (report%status == KRYLOV_NOT_FINITE) exit
      call residual_of(operator, b, x, r)
      size_of_r = length_of(operator, r)
      call check_stagnation(size_of_r, target_residual, before, report)
      if (size_of_r > before) x = best                        ! by rounding only
      before = min(size_of_r, before)
    end do
    report%residual = before / size_of_b
  end subroutine gmres


  !> First residual, and the trivial cases. Status KRYLOV_MAX_ITERATIONS means: iterate.
  subroutine check_trivial_solution(operator, b, x, options, r, size_of_b, target_residual, report)
    class(operator_type), intent(inout) :: operator
    real(DP), intent(in) :: b(:)
    real(DP), intent(inout) :: x(:)
    type(krylov_options_type), intent(in) :: options
    real(DP), intent(out) :: r(:)                           !< b - A x
    real(DP), intent(out) :: size_of_b, target_residual                !< |b| and the residual to reach
    type(krylov_report_type), intent(out) :: report
    real(DP) :: size_of_r
    size_of_b = length_of(operator, b)
    target_residual = options%absolute_tolerance
    r = b
    if (ieee_is_finite(size_of_b)) target_residual = max(options%tolerance * size_of_b, options%absolute_tolerance)
    if (.not. ieee_is_finite(size_of_b)) then
      report%status = KRYLOV_NOT_FINITE
      x = 0
      report%residual = 1
    else if (size_of_b <= options%absolute_tolerance) then
      x = 0
    else
      report%status = KRYLOV_MAX_ITERATIONS
      call check_initial_guess(operator, b, size_of_b, x, r)
      size_of_r = length_of(operator, r)
      report%residual = size_of_r / size_of_b
      if (size_of_r <= target_residual) report%status = KRYLOV_CONVERGED
    end if
  end subroutine check_trivial_solution


  !> The residual of the first guess. A guess that is not finite, or is worse than zero, is replaced by 0.
  subroutine check_initial_guess(operator, b, size_of_b, x, r)
    class(operator_type), intent(inout) :: operator
    real(DP), intent(in) :: b(:)
    real(DP), intent(in) :: size_of_b                       !< |b|
    real(DP), intent(inout) :: x(:)
    real(DP), intent(out) :: r(:)                           !< b - A x
    real(DP) :: length
    logical :: is_useful
    r = b
    length = length_of(operator, x)
    is_useful = ieee_is_finite(length)
    if (is_useful) is_useful = length > 0
    if (is_useful) then
      call residual_of(operator, b, x, r)
      length = length_of(operator, r)
      is_useful = ieee_is_finite(length)
      if (is_useful) is_useful = length <= size_of_b
    end if
    if (is_useful) return
    x = 0
    r = b
  end subroutine check_initial_guess


  !> Allocates the vectors of GMRES. The system assigns memory only when the vectors are first written.
  subroutine allocate_cycle(basis, n, m, error)
    type(gmres_cycle_type), intent(out) :: basis
    integer, intent(in) :: n                                !< unknowns
    integer, intent(in) :: m                                !< iterations before a restart
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    allocate (basis%v(n, m + 1), stat=status)
    if (status == 0) allocate (basis%z(n, m), stat=status)
    if (status /= 0) call set_error(error, EXIT_SOLVER, 'Not enough memory for the vectors of GMRES.')
    if (status == 0) allocate (basis%h(m + 1, m), basis%c(m), basis%s(m), basis%g(m + 1))
  end subroutine allocate_cycle


  !> One cycle: builds the basis until the residual is small or the basis is full, and corrects x.
  subroutine run_gmres_cycle(operator, preconditioner, r, target_residual, options, basis, x, report)
    class(operator_type), intent(inout) :: operator, preconditioner
    real(DP), intent(in) :: r(:)                            !< b - A x
    real(DP), intent(in) :: target_residual
    type(krylov_options_type), intent(in) :: options
    type(gmres_cycle_type), intent(inout) :: basis
    real(DP), intent(inout) :: x(:)
    type(krylov_report_type), intent(inout) :: report
    real(DP) :: length, whole
    integer :: k, n_steps
    n_steps = 0
    basis%g = 0
    basis%g(1) = length_of(operator, r)
    basis%v(:, 1) = r / basis%g(1)
    do k = 1, size(basis%c)
      if (report%n_iterations == options%max_iterations .or. abs(basis%g(k)) <= target_residual) exit
      call preconditioner%apply(basis%v(:, k), basis%z(:, k))
      call operator%apply(basis%z(:, k), basis%v(:, k + 1))
      report%n_iterations = report%n_iterations + 1
      call orthogonalise(operator, basis, k, whole, length)
      if (.not. ieee_is_finite(length)) then
        report%status = KRYLOV_NOT_FINITE
        exit
      end if
      call apply_givens_rotations(basis, k)
      if (abs(basis%h(k, k)) <= TOL_DEPENDENT_VECTOR * whole) exit     ! A z is linearly dependent: singular, or time to restart
      n_steps = k
      if (.not. length > 0) exit                            ! the space is complete: the solution lies in it
      basis%v(:, k + 1) = basis%v(:, k + 1) / length
    end do
    call update_solution(operator, basis, n_steps, x)
  end subroutine run_gmres_cycle


  !> Modified Gram-Schmidt of v(k + 1) against the earlier vectors, repeated if digits cancelled ("twice is
  !> enough"). Fills column k of h. A length at rounding level of the vector becomes 0.
  subroutine orthogonalise(operator, basis, k, whole, length)
    class(operator_type), intent(inout) :: operator
    type(gmres_cycle_type), intent(inout) :: basis
    integer, intent(in) :: k
    real(DP), intent(out) :: whole                          !< length of the vector
    real(DP), intent(out) :: length                         !< length of the orthogonal remainder
    real(DP) :: before, overlap
    integer :: pass, i
    basis%h(:, k) = 0
    whole = length_of(operator, basis%v(:, k + 1))
    length = whole
    if (.not. ieee_is_finite(whole)) return
    do pass = 1, 2
      before = length
      do i = 1, k
        overlap = inner(operator, basis%v(:, i), basis%v(:, k + 1))
        basis%v(:, k + 1) = basis%v(:, k + 1) - overlap * basis%v(:, i)
        basis%h(i, k) = basis%h(i, k) + overlap
      end do
      length = length_of(operator, basis%v(:, k + 1))
      if (length > 0.7_DP * before) exit
    end do
    if (length <= TOL_ROUNDING * whole) length = 0
    basis%h(k + 1, k) = length
  end subroutine orthogonalise


  !> Applies the earlier rotations to column k of h and a new one that eliminates h(k + 1, k).
  pure subroutine apply_givens_rotations(basis, k)
    type(gmres_cycle_type), intent(inout) :: basis
    integer, intent(in) :: k
    real(DP) :: upper, radius
    integer :: i
    associate (h => basis%h, c => basis%c, s => basis%s, g => basis%g)
      do i = 1, k - 1
        upper = c(i) * h(i, k) + s(i) * h(i + 1, k)
        h(i + 1, k) = -s(i) * h(i, k) + c(i) * h(i + 1, k)
        h(i, k) = upper
      end do
      radius = hypot(h(k, k), h(k + 1, k))
      c(k) = 1
      s(k) = 0
      if (radius > 0) then
        c(k) = h(k, k) / radius
        s(k) = h(k + 1, k) / radius
      end if
      h(k, k) = radius
      h(k + 1, k) = 0
      g(k + 1) = -s(k) * g(k)
      g(k) = c(k) * g(k)
    end associate
  end subroutine apply_givens_rotations


  !> Adds to x the combination of the preconditioned vectors with the smallest residual.
  subroutine update_solution(operator, basis, n_steps, x)
    class(operator_type), intent(inout) :: operator
    type(gmres_cycle_type), intent(in) :: basis
    integer, intent(in) :: n_steps
    real(DP), intent(inout) :: x(:)
    real(DP) :: y(n_steps), correction(size(x))
    integer :: k
    do k = n_steps, 1, -1
      y(k) = (basis%g(k) - dot_product(basis%h(k, k + 1:n_steps), y(k + 1:))) / basis%h(k, k)
    end do
    correction = 0
    do k = 1, n_steps
      correction = correction + y(k) * basis%z(:, k)
    end do
    if (ieee_is_finite(length_of(operator, correction))) x = x + correction
  end subroutine update_solution


  !> Solves A x = b with A symmetric positive definite by preconditioned conjugate gradients. The true residual decides; where no
  !> direction lowers it any more, the status is KRYLOV_STAGNATED.
  subroutine conjugate_gradients(operator, preconditioner, b, x, options, report)
    class(operator_type), intent(inout) :: operator         !< A
    class(operator_type), intent(inout) :: preconditioner   !< symmetric positive definite, as the inverse of A
    real(DP), intent(in) :: b(:)                            !< (n)
    real(DP), intent(inout) :: x(:)                         !< (n) in: first guess; out: solution
    type(krylov_options_type), intent(in) :: options
    type(krylov_report_type), intent(out) :: report
    real(DP) :: r(size(b)), target_residual, size_of_b
    call check_trivial_solution(operator, b, x, options, r, size_of_b, target_residual, report)
    if (report%status /= KRYLOV_MAX_ITERATIONS) return
    call run_cg_iterations(operator, preconditioner, b, target_residual, options, r, x, report)
    if (report%status == KRYLOV_NOT_FINITE) return
    report%residual = length_of(operator, r) / size_of_b
  end subroutine conjugate_gradients


  !> Convergence verdict on a cycle by its true residual.
  pure subroutine check_stagnation(residual, target_residual, before, report)
    real(DP), intent(in) :: residual                        !< after the cycle
    real(DP), intent(in) :: target_residual                            !< residual to reach
    real(DP), intent(in) :: before                          !< residual before the cycle
    type(krylov_report_type), intent(inout) :: report
    if (residual <= target_residual) then
      report%status = KRYLOV_CONVERGED
    else if (report%status == KRYLOV_MAX_ITERATIONS .and. residual >= MAX_CYCLE_REDUCTION * before) then
      report%status = KRYLOV_STAGNATED
    end if
  end subroutine check_stagnation


  !> Conjugate gradients until the residual is small or at rounding level, or a breakdown occurs. The residual of the recurrence
  !! drifts from b - A x by rounding. Whenever it has fallen by UPDATE_RATIO, b - A x takes its place, and the directions continue.
  !! The change of x since then is summed by itself, without the rounding of x. So the drift at an update is the rounding of A x:
  !! no smaller residual can be reached.
  subroutine run_cg_iterations(operator, preconditioner, b, target_residual, options, r, x, report)
    class(operator_type), intent(inout) :: operator, preconditioner
    real(DP), intent(in) :: b(:)
    real(DP), intent(in) :: target_residual
    type(krylov_options_type), intent(in) :: options
    real(DP), intent(inout) :: r(:)                         !< b - A x
    real(DP), intent(inout) :: x(:)
    type(krylov_report_type), intent(inout) :: report
    real(DP), dimension(size(r)) :: z, p, a_p, dx, r_old
    real(DP) :: rho, rho_old, rho_start, energy, alpha, size_of_r, drift
    real(DP) :: largest                                     ! residual since the last update
    logical :: is_end                                       ! by the recurrence no smaller residual is needed or can be reached
    call correct_start(operator, preconditioner, r, dx, rho_start)
    p = 0
    r_old = 0
    rho_old = 1
    drift = 0
    size_of_r = length_of(operator, r)
    largest = size_of_r
    do while (report%n_iterations < options%max_iterations)
      if (size_of_r <= max(target_residual, drift, UPDATE_RATIO * largest)) then
        is_end = size_of_r <= max(target_residual, drift)
        call update_residual(operator, b, dx, x, r, drift)
        if (is_end .and. drift > SMALL_DRIFT * size_of_r) report%status = KRYLOV_STAGNATED
        size_of_r = length_of(operator, r)
        largest = size_of_r
        if (size_of_r <= target_residual) report%status = KRYLOV_CONVERGED
        if (report%status /= KRYLOV_MAX_ITERATIONS) return
      end if
      call preconditioner%apply(r, z)
      report%n_iterations = report%n_iterations + 1
      rho = inner(operator, r, z)
      if (report%n_iterations == 1) rho_start = rho_start + rho
      if (rho > 0 .and. rho <= options%energy_tolerance**2 * rho_start) then
        x = x + dx
        report%status = KRYLOV_CONVERGED
        return
      end if
      call renew_direction(z, (rho - inner(operator, r_old, z)) / rho_old, p)
      call operator%apply(p, a_p)
      energy = inner(operator, p, a_p)
      if (.not. (ieee_is_finite(rho) .and. ieee_is_finite(energy))) then
        report%status = KRYLOV_NOT_FINITE
      else if (rho <= 0 .or. energy <= 0) then
        report%status = KRYLOV_INDEFINITE
      end if
      if (report%status /= KRYLOV_MAX_ITERATIONS) exit
      alpha = rho / energy
      call step_along(p, a_p, alpha, dx, r, r_old)
      rho_old = rho
      size_of_r = length_of(operator, r)
      largest = max(largest, size_of_r)
    end do
    call update_residual(operator, b, dx, x, r, drift)
    if (length_of(operator, r) <= target_residual) report%status = KRYLOV_CONVERGED
  end subroutine run_cg_iterations


  !> p = z + beta p.
  subroutine renew_direction(z, beta, p)
    real(DP), intent(in) :: z(:)                            !< (n)
    real(DP), intent(in) :: beta
    real(DP), intent(inout) :: p(:)                         !< (n)
    integer :: i
    !$omp parallel do schedule(static) if (size(p) > SUM_LENGTH)
    do i = 1, size(p)
      p(i) = z(i) + beta * p(i)
    end do
    !$omp end parallel do
  end subroutine renew_direction


  !> A step of length alpha along p: its change of x, and the residual before and after it.
  subroutine step_along(p, a_p, alpha, dx, r, r_old)
    real(DP), intent(in) :: p(:), a_p(:)                    !< (n) p and A p
    real(DP), intent(in) :: alpha
    real(DP), intent(inout) :: dx(:), r(:)                  !< (n)
    real(DP), intent(out) :: r_old(:)                       !< (n)
    integer :: i
    !$omp parallel do schedule(static) if (size(p) > SUM_LENGTH)
    do i = 1, size(p)
      dx(i) = dx(i) + alpha * p(i)
      r_old(i) = r(i)
      r(i) = r(i) - alpha * a_p(i)
    end do
    !$omp end parallel do
  end subroutine step_along


  !> The change of x in the subspace of the preconditioner, and the residual after it.
  subroutine correct_start(operator, preconditioner, r, dx, energy)
    class(operator_type), intent(inout) :: operator, preconditioner
    real(DP), intent(inout) :: r(:)
    real(DP), intent(out) :: dx(:)                          !< 0 without a subspace
    real(DP), intent(out) :: energy                         !< square of its length in the norm of A
    real(DP) :: change(size(r))
    call preconditioner%correct(r, dx)
    energy = inner(operator, r, dx)
    if (.not. (ieee_is_finite(energy) .and. energy > 0)) then
      dx = 0
      energy = 0
    else
      call operator%apply(dx, change)
      r = r - change
    end if
  end subroutine correct_start


  !> Adds the change to x, which becomes zero, and computes r = b - A x.
  subroutine update_residual(operator, b, dx, x, r, drift)
    class(operator_type), intent(inout) :: operator
    real(DP), intent(in) :: b(:)
    real(DP), intent(inout) :: dx(:), x(:)
    real(DP), intent(inout) :: r(:)                         !< in: by the recurrence
    real(DP), intent(out) :: drift                          !< norm of the change of r
    x = x + dx
    call operator%apply(x, dx)
    dx = b - dx
    drift = length_of(operator, dx - r)
    r = dx
    dx = 0
  end subroutine update_residual


  !> r = b - A x.
  subroutine residual_of(operator, b, x, r)
    class(operator_type), intent(inout) :: operator
    real(DP), intent(in) :: b(:), x(:)
    real(DP), intent(out) :: r(:)
    call operator%apply(x, r)
    r = b - r
  end subroutine residual_of


  !> A sum over this part of a vector, completed to the sum over all parts: the sum itself for a whole vector.
  subroutine complete_sum(self, sum)
    class(operator_type), intent(inout) :: self
    real(DP), intent(inout) :: sum
    associate (unused => self, kept => sum)
    end associate
  end subroutine complete_sum


  !> z: the solution for r in a subspace that a preconditioner solves first; here there is none.
  subroutine leave_uncorrected(self, r, z)
    class(operator_type), intent(inout) :: self
    real(DP), intent(in) :: r(:)                            !< (n)
    real(DP), intent(out) :: z(:)                           !< (n)
    associate (unused => self, also => r)
    end associate
    z = 0
  end subroutine leave_uncorrected


  !> The scalar product of vectors on which an operator acts.
  function inner(operator, x, y) result(product)
    class(operator_type), intent(inout) :: operator
    real(DP), intent(in) :: x(:), y(:)
    real(DP) :: product
    product = dot(x, y)
    call operator%complete(product)
  end function inner


  !> Their 2-norm.
  function length_of(operator, x) result(length)
    class(operator_type), intent(inout) :: operator
    real(DP), intent(in) :: x(:)
    real(DP) :: length
    length = sqrt(inner(operator, x, x))
  end function length_of


  !> The scalar product: the sum, in their order, of those of parts of a fixed length. So it does not depend on the number of
  !! threads, which share the parts.
  function dot(x, y) result(product)
    real(DP), intent(in) :: x(:), y(:)                      !< (n)
    real(DP) :: product
    real(DP) :: part((size(x) + SUM_LENGTH - 1) / SUM_LENGTH)
    integer :: k, low, high
    !$omp parallel do schedule(static) private(low, high) if (size(part) > 1)
    do k = 1, size(part)
      low = (k - 1) * SUM_LENGTH + 1
      high = min(k * SUM_LENGTH, size(x))
      part(k) = dot_in_four(x(low:high), y(low:high))
    end do
    !$omp end parallel do
    product = sum(part)
  end function dot


  !> The scalar product in four interleaved sums: the order is fixed, and additions do not wait for each other.
  pure function dot_in_four(x, y) result(product)
    real(DP), intent(in) :: x(:), y(:)                      !< (n)
    real(DP) :: product
    real(DP) :: part(4)
    integer :: k, n
    n = size(x) - mod(size(x), 4)
    part = 0
    do k = 1, n, 4
      part = part + x(k:k + 3) * y(k:k + 3)
    end do
    product = (part(1) + part(2)) + (part(3) + part(4))
    do k = n + 1, size(x)
      product = product + x(k) * y(k)
    end do
  end function dot_in_four


  !> y = A x.
  subroutine apply_matrix(self, x, y)
    class(matrix_operator_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                            !< (n)
    real(DP), intent(out) :: y(:)                           !< (n)
    call multiply_symmetric(self%matrix, x, y)
  end subroutine apply_matrix

end module amontons_krylov
