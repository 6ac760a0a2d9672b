!> Unit test of two_level_preconditioner: an exact factor without fill, an exact coarse space, symmetry, domains of threads,
!! iterations independent of the length of a bar.
!! SPDX-License-Identifier: GPL-3.0-or-later
module iterative_samples
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_krylov, only: operator_type, matrix_operator_type, krylov_options_type, krylov_report_type, conjugate_gradients
  use amontons_two_level_preconditioner, only: two_level_preconditioner_type, build_coarse_space, factorise_two_level, &
    apply_preconditioner, apply_deflated, correct_in_coarse_space
  implicit none
  private
  public :: two_level_type, chain, bar, iterations_of

  !> The preconditioner with its matrix as an operator.
  type, extends(operator_type) :: two_level_type
    type(two_level_preconditioner_type) :: self
    type(sparse_type), pointer :: matrix => null()
    logical :: is_deflated = .false.               !< one level after the other
  contains
    procedure :: apply => apply_two_level
    procedure :: correct => correct_two_level
  end type two_level_type

contains

  subroutine apply_two_level(self, x, y)
    class(two_level_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)
    real(DP), intent(out) :: y(:)
    if (self%is_deflated) then
      call apply_deflated(self%self, self%matrix, x, y)
    else
      call apply_preconditioner(self%self, self%matrix, x, y)
    end if
  end subroutine apply_two_level


  subroutine correct_two_level(self, r, z)
    class(two_level_type), intent(inout) :: self
    real(DP), intent(in) :: r(:)
    real(DP), intent(out) :: z(:)
    z = 0
    if (self%is_deflated) call correct_in_coarse_space(self%self, r, z)
  end subroutine correct_two_level


  !> Springs in a row, the first fixed to the ground: tridiagonal, so that the Cholesky factor has no fill.
  subroutine chain(n, matrix)
    integer, intent(in) :: n
    type(sparse_type), intent(out) :: matrix
    type(error_type), allocatable :: error
    integer :: row(2 * n - 1), column(2 * n - 1), i
    real(DP) :: value(2 * n - 1)
    row = [(i, i=1, n), (i, i=1, n - 1)]
    column = [(i, i=1, n), (i + 1, i=1, n - 1)]
    value = 2.0_DP
    value(n) = 1.0_DP
    value(n + 1:) = -1.0_DP
    call sparse_from_triplets(n, n, row, column, value, matrix, error)
  end subroutine chain


  !> A square bar of nodes m x m x length, joined along edges and diagonals of the faces by springs in their own direction
  !! (a truss: it has the six rigid body motions), and fixed at one end.
  subroutine bar(m, length, matrix, axis, place, part)
    integer, intent(in) :: m, length
    type(sparse_type), intent(out) :: matrix
    integer, allocatable, intent(out) :: axis(:)
    real(DP), allocatable, intent(out) :: place(:, :)
    integer, allocatable, intent(out) :: part(:)   !< one every eight layers
    type(error_type), allocatable :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer, parameter :: ALONG(3, 9) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 1, -1, 0, 1, 0, 1, 1, 0, -1, 0, 1, 1, &
      0, 1, -1], [3, 9])
    integer :: x, y, z, k, a, b, i, j, n
    real(DP) :: d(3)
    n = 0
    allocate (row(400 * m * m * length), column(400 * m * m * length), value(400 * m * m * length))
    do z = 0, length
      do y = 1, m
        do x = 1, m
          do k = 1, 9
            associate (x2 => x + ALONG(1, k), y2 => y + ALONG(2, k), z2 => z + ALONG(3, k))
              if (min(x2, y2) < 1 .or. max(x2, y2) > m .or. z2 < 0 .or. z2 > length) cycle
              d = real(ALONG(:, k), DP) / norm2(real(ALONG(:, k), DP))
              a = 3 * (x - 1 + m * (y - 1 + m * (z - 1)))         ! the layer z = 0 is the ground: not positive
              b = 3 * (x2 - 1 + m * (y2 - 1 + m * (z2 - 1)))
              do i = 1, 3
                do j = 1, 3
                  if (a >= 0 .and. i <= j) call add(a + i, a + j, d(i) * d(j))
                  if (b >= 0 .and. i <= j) call add(b + i, b + j, d(i) * d(j))
                  if (min(a, b) >= 0 .and. a < b) call add(a + i, b + j, -d(i) * d(j))
                  if (min(a, b) >= 0 .and. b < a) call add(b + j, a + i, -d(i) * d(j))
                end do
              end do
            end associate
          end do
        end do
      end do
    end do
    call sparse_from_triplets(3 * m * m * length, 3 * m * m * length, row(:n), column(:n), value(:n), matrix, error)
    axis = [(1 + mod(i - 1, 3), i=1, 3 * m * m * length)]
    allocate (place(3, size(axis)))
    do i = 1, size(axis)
      k = (i - 1) / 3
      place(:, i) = real([mod(k, m), mod(k / m, m), k / m**2], DP)
    end do
    part = [(1 + (i - 1) / (3 * m * m * 8), i=1, size(axis))]
  contains
    subroutine add(r, c, v)
      integer, intent(in) :: r, c
      real(DP), intent(in) :: v
      n = n + 1
      row(n) = r
      column(n) = c
      value(n) = v
    end subroutine add
  end subroutine bar


  !> Iterations of conjugate gradients to 1e-8 for the bar under a force on its end, with and without the parts.
  integer function iterations_of(length, has_parts, width, is_deflated) result(n)
    integer, intent(in) :: length
    logical, intent(in) :: has_parts
    integer, intent(in), optional :: width         !< nodes across; default 4
    logical, intent(in), optional :: is_deflated   !< one level after the other
    type(sparse_type), target :: matrix
    type(matrix_operator_type) :: operator
    type(two_level_type) :: preconditioner
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    type(error_type), allocatable :: error
    integer, allocatable :: axis(:), part(:)
    real(DP), allocatable :: place(:, :), b(:), x(:)
    logical :: is_broken
    integer :: m
    m = 4
    if (present(width)) m = width
    call bar(m, length, matrix, axis, place, part)
    operator%matrix => matrix
    preconditioner%matrix => matrix
    if (present(is_deflated)) preconditioner%is_deflated = is_deflated
    if (has_parts) call build_coarse_space(preconditioner%self, part, axis, place, maxval(part))
    call factorise_two_level(preconditioner%self, matrix, is_broken, error)
    allocate (b(matrix%n_rows), x(matrix%n_rows), source=0.0_DP)
    b(matrix%n_rows) = 1
    b(matrix%n_rows - 2) = 1
    options%max_iterations = 5000
    call conjugate_gradients(operator, preconditioner, b, x, options, report)
    n = merge(report%n_iterations, huge(1), report%status == 0 .and. .not. is_broken)
  end function iterations_of

end module iterative_samples

program test_two_level_preconditioner
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, multiply_symmetric
  use amontons_two_level_preconditioner, only: build_coarse_space, offer_corner_space, factorise_two_level
!$ use omp_lib, only: omp_set_num_threads
  use iterative_samples, only: two_level_type, chain, bar, iterations_of
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call test_exact()
  call test_symmetry()
  call test_motions()
  call test_coarse_space()
  call test_deflation()
  call test_corners()
  call test_domains()
  call test_length()
  call test_broken()
  call suite%finish()

contains

  !> Without fill the incomplete factor is the factor, to the digits of single precision; a longer or shorter chain may follow.
  !! Rounding of U by 6e-8 acts as springs of 1.2e-7 to the ground at x = i, and moves the end of the chain by up to the sum of i**2
  !! times that, a third of n**3.
  subroutine test_exact()
    integer, parameter :: LENGTHS(*) = [50, 80, 30]
    type(two_level_type) :: m
    type(sparse_type), target :: a
    real(DP), allocatable :: x(:), b(:)
    integer :: i, k, n
    logical :: is_broken
    type(error_type), allocatable :: error
    do k = 1, size(LENGTHS)
      n = LENGTHS(k)
      call chain(n, a)
      m%matrix => a
      call factorise_two_level(m%self, a, is_broken, error)
      allocate (x(n), b(n), source=0.0_DP)
      b(n) = 1                                      ! a force on the end: every spring stretches by 1
      call m%apply(b, x)
      call suite%that('chain: a factor', .not. is_broken)
      call suite%that('chain: no fill, the exact answer', maxval(abs(x - [(real(i, DP), i=1, n)])) < real(n, DP)**3 / 3 * 1.2e-7_DP)
      deallocate (x, b)
    end do
  end subroutine test_exact


  !> x'My = y'Mx and x'Mx > 0: conjugate gradients may use it.
  subroutine test_symmetry()
    type(two_level_type) :: m
    type(sparse_type), target :: a
    integer, allocatable :: axis(:), part(:)
    real(DP), allocatable :: place(:, :), x(:), y(:), mx(:), my(:)
    integer :: i
    logical :: is_broken
    type(error_type), allocatable :: error
    call bar(3, 20, a, axis, place, part)
    m%matrix => a
    call build_coarse_space(m%self, part, axis, place, maxval(part))
    call factorise_two_level(m%self, a, is_broken, error)
    x = [(sin(real(i, DP)), i=1, a%n_rows)]
    y = [(cos(3.0_DP * real(i, DP)), i=1, a%n_rows)]
    allocate (mx, my, mold=x)
    call m%apply(x, mx)
    call m%apply(y, my)
    call suite%that('bar: symmetric', abs(dot_product(x, my) - dot_product(y, mx)) < 1.0e-8_DP * norm2(x) * norm2(my))
    call suite%that('bar: positive', dot_product(x, mx) > 0 .and. dot_product(y, my) > 0)
  end subroutine test_symmetry


  !> The columns of Z are orthonormal, and the coarse matrix has an inverse.
  subroutine test_motions()
    type(two_level_type) :: m
    type(sparse_type), target :: a
    integer, allocatable :: axis(:), part(:)
    real(DP), allocatable :: place(:, :)
    real(DP) :: gram(6, 6)
    integer :: i, j
    logical :: is_broken
    type(error_type), allocatable :: error
    call bar(3, 20, a, axis, place, part)
    part(size(part)) = maxval(part) + 1             ! a part of one unknown: it has one motion only
    call build_coarse_space(m%self, part, axis, place, maxval(part))
    call factorise_two_level(m%self, a, is_broken, error)
    gram = 0
    do i = 1, size(part)
      if (part(i) /= 1) cycle
      do j = 1, 6
        gram(:, j) = gram(:, j) + real(m%self%motion(:, i), DP) * real(m%self%motion(j, i), DP)
      end do
    end do
    do j = 1, 6
      gram(j, j) = gram(j, j) - 1
    end do
    call suite%that('motions of a part: orthonormal in single precision', maxval(abs(gram)) < real(epsilon(1.0), DP))
    call suite%that('a part with one motion: the second level stands', m%self%has_coarse_space)
  end subroutine test_motions


  !> The coarse correction is exact for displacements of the coarse space: Z inv(Z'AZ) Z' A Z c = Z c.
  subroutine test_coarse_space()
    real(DP), parameter :: C(6) = [1.0_DP, -2.0_DP, 0.5_DP, 3.0_DP, 1.5_DP, -1.0_DP]
    type(two_level_type) :: both, one
    type(sparse_type), target :: a
    integer, allocatable :: axis(:), part(:)
    real(DP), allocatable :: place(:, :), x(:), f(:), z(:), z1(:)
    integer :: i
    logical :: is_broken
    type(error_type), allocatable :: error
    call bar(3, 40, a, axis, place, part)
    both%matrix => a
    one%matrix => a
    call build_coarse_space(both%self, part, axis, place, maxval(part))
    call factorise_two_level(both%self, a, is_broken, error)
    call factorise_two_level(one%self, a, is_broken, error)
    x = [(dot_product(real(both%self%motion(:, i), DP), C) * real(part(i), DP), i=1, a%n_rows)]
    allocate (f, z, z1, mold=x)
    call multiply_symmetric(a, x, f)
    call both%apply(f, z)
    call one%apply(f, z1)
    call suite%that('coarse space: exact for its own displacements', norm2(z - z1 - x) < 1.0e-3_DP * norm2(x))   ! single precision
  end subroutine test_coarse_space


  !> One level after the other: what is left of a residual has nothing in the coarse space, Z'(r - A z) = 0 for each r;
  !! displacements of the coarse space are found before the first iteration; and conjugate gradients need fewer iterations than for
  !! the sum.
  subroutine test_deflation()
    type(two_level_type) :: m
    type(sparse_type), target :: a
    integer, allocatable :: axis(:), part(:)
    real(DP), allocatable :: place(:, :), x(:), r(:), z(:), product(:), left(:)
    integer :: i
    logical :: is_broken
    type(error_type), allocatable :: error
    call bar(3, 40, a, axis, place, part)
    m%matrix => a
    m%is_deflated = .true.
    call build_coarse_space(m%self, part, axis, place, maxval(part))
    call factorise_two_level(m%self, a, is_broken, error)
    r = [(sin(real(i, DP)), i=1, a%n_rows)]
    allocate (z, product, left, mold=r)
    call m%apply(r, z)
    call multiply_symmetric(a, z, product)
    call m%correct(r - product, left)
    call m%correct(r, product)
    call suite%that('deflation: nothing is left in the coarse space', norm2(left) < 1.0e-3_DP * norm2(product))
    x = [(real(m%self%motion(1, i), DP) * real(part(i), DP), i=1, a%n_rows)]
    call multiply_symmetric(a, x, r)
    call m%correct(r, z)
    call suite%that('deflation: the coarse space first', norm2(z - x) < 1.0e-3_DP * norm2(x))
    call suite%that('deflation: fewer iterations', &
      4 * iterations_of(40, .true., is_deflated=.true.) <= 3 * iterations_of(40, .true.))
    m%self%has_coarse_space = .false.
    call m%correct(r, z)
    call suite%that('deflation: none without a second level', all(abs(z) <= 0.0_DP))
  end subroutine test_deflation


  !> Quadratic bars of stiffness 1 in a row under a force of 1 on the end: u = x is linear, so that both terms of the
  !! preconditioner, U'U = A without fill and P'AP, give it, together 2 x. With corners for the most part P is not taken.
  subroutine test_corners()
    integer, parameter :: N = 40                   ! bars; unknowns: middle and end of each
    type(two_level_type) :: m
    type(sparse_type), target :: a
    type(error_type), allocatable :: error
    integer :: ends(2, 2 * N), row(5 * N - 2), column(5 * N - 2), e, i, k
    real(DP) :: value(5 * N - 2), b(2 * N), z(2 * N)
    logical :: is_broken
    do e = 1, N
      ends(:, 2 * e - 1) = [2 * e - 2, 2 * e]
      ends(:, 2 * e) = 2 * e
    end do
    row = [(i, i=1, 2 * N), (i, i=1, 2 * N - 1), (2 * i, i=1, N - 1)]
    column = [(i, i=1, 2 * N), (i + 1, i=1, 2 * N - 1), (2 * i + 2, i=1, N - 1)]
    value = [((merge(16.0_DP, 14.0_DP, k == 1), k=1, 2), i=1, N), (-8.0_DP, i=1, 2 * N - 1), (1.0_DP, i=1, N - 1)] / 3.0_DP
    value(2 * N) = 7.0_DP / 3.0_DP
    call sparse_from_triplets(2 * N, 2 * N, row, column, value, a, error)
    m%matrix => a
    call offer_corner_space(m%self, ends)
    call factorise_two_level(m%self, a, is_broken, error)
    call suite%that('the corners serve', .not. is_broken .and. m%self%has_coarse_space .and. &
      allocated(m%self%interpolation%first))
    b = 0
    b(2 * N) = 1
    call m%apply(b, z)
    call suite%near('both terms give the linear displacement', maxval(abs(z - [(real(i, DP), i=1, 2 * N)])), 0.0_DP, &
      1.0e-5_DP * real(2 * N, DP))
    ends(:, 1) = 1
    call offer_corner_space(m%self, ends)
    call suite%that('more corners than half are not coarse', .not. allocated(m%self%interpolation%first))
  end subroutine test_corners


  !> On two threads U has two domains: the preconditioner stays symmetric, with hardly more iterations, and repeats bitwise.
  subroutine test_domains()
    type(two_level_type) :: m
    type(sparse_type), target :: a
    integer, allocatable :: axis(:), part(:)
    real(DP), allocatable :: place(:, :), x(:), y(:), mx(:), my(:), again(:)
    integer :: i, n_one, n_two
    logical :: is_broken
    type(error_type), allocatable :: error
    n_one = iterations_of(128, .true., 10)
!$  call omp_set_num_threads(2)
    n_two = iterations_of(128, .true., 10)
    call suite%that('two domains: hardly more iterations', n_two <= n_one + n_one / 16 + 1)
    call bar(10, 128, a, axis, place, part)
    m%matrix => a
    call build_coarse_space(m%self, part, axis, place, maxval(part))
    call factorise_two_level(m%self, a, is_broken, error)
!$  call suite%that('two threads: two domains', m%self%incomplete%n_domains == 2)
    x = [(sin(real(i, DP)), i=1, a%n_rows)]
    y = [(cos(3.0_DP * real(i, DP)), i=1, a%n_rows)]
    allocate (mx, my, again, mold=x)
    call m%apply(x, mx)
    call m%apply(y, my)
    call m%apply(x, again)
    call suite%that('two domains: symmetric', abs(dot_product(x, my) - dot_product(y, mx)) < 1.0e-7_DP * norm2(x) * norm2(my))
    call suite%that('two domains: the same again', all(abs(mx - again) <= 0.0_DP))
!$  call omp_set_num_threads(1)
  end subroutine test_domains


  !> A slender bar of twice the length needs hardly more iterations: the coarse space represents the smooth motion.
  subroutine test_length()
    integer :: short, long, alone
    short = iterations_of(64, .true.)
    long = iterations_of(128, .true.)
    alone = iterations_of(128, .false.)
    call suite%that('bar of twice the length: hardly more iterations', 10 * long < 13 * short)
    call suite%that('without the parts: many times more', alone > 4 * long)
  end subroutine test_length


  !> A matrix far from positive definite is rejected, a nearly definite one gets a shift.
  subroutine test_broken()
    type(two_level_type) :: m
    type(sparse_type), target :: a
    logical :: is_broken
    type(error_type), allocatable :: error
    call chain(50, a)
    a%value(a%first(:50)) = -1
    call factorise_two_level(m%self, a, is_broken, error)
    call suite%that('negative diagonal: broken', is_broken)
    call chain(50, a)
    a%value(a%first(25)) = 0.9_DP
    call factorise_two_level(m%self, a, is_broken, error)
    call suite%that('indefinite by little: a shift', .not. is_broken .and. m%self%incomplete%shift > 0)
  end subroutine test_broken

end program test_two_level_preconditioner
