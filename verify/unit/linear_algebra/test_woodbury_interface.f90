!> Unit test of woodbury_interface: solutions of S - B A - M X against LAPACK, weakly supported bodies, springs that are too stiff,
!! and bitwise equal results for any number of threads.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_woodbury_interface
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_dense, only: solve_small, DENSE_OK
  use amontons_woodbury_interface, only: woodbury_type, contact_springs_type, invert_interface_stiffness, &
    factorise_spring_coupling, solve_woodbury
  use check, only: suite_type
  use samples, only: dense_of
  implicit none
  type(suite_type) :: suite
  integer :: k
  call random_seed(put=[(29 * k, k=1, 64)])
  call test_solution('small', 12, 2, 1.0_DP)
  call test_solution('stiff', 60, 15, 300.0_DP)
  call test_solution('weak numbers', 60, 15, 1.0_DP, size=1.0e-12_DP)
  call test_solution('strong numbers', 60, 15, 1.0_DP, size=1.0e18_DP)
  call test_solution('large', 500, 140, 3.0_DP)
  call test_limits()
  call test_threads()
  call suite%finish()

contains

  !> A well supported body: L, D with S = L L' - D positive, S about `size`.
  subroutine make_body(n, size, triangle, shift)
    integer, intent(in) :: n
    real(DP), intent(in) :: size
    real(DP), intent(out) :: triangle(:, :), shift(:)
    integer :: i
    call random_number(triangle)
    triangle = (triangle - 0.5_DP) * sqrt(size / real(n, DP))
    do i = 1, n
      triangle(:i - 1, i) = 0.0_DP
      triangle(i, i) = sqrt(2.0_DP * size)
    end do
    shift = 0.3_DP * size
  end subroutine make_body


  !> Springs between three unknowns and two others, followed by six, with moving forces; unsymmetric.
  subroutine make_springs(n, m, stiffness, springs)
    integer, intent(in) :: n, m                    !< unknowns, springs (three columns each)
    real(DP), intent(in) :: stiffness
    type(contact_springs_type), intent(out) :: springs
    call random_matrix(n, 3 * m, 1.0_DP, springs%force_distribution)
    call random_matrix(3 * m, n, -stiffness, springs%spring_tangent)
    call random_matrix(n, 2 * m, 0.05_DP * stiffness, springs%distribution_change)
    call random_matrix(2 * m, n, 0.3_DP, springs%projection_gradient)
  end subroutine make_springs


  !> Five entries a row or a column, whichever gives more.
  subroutine random_matrix(n_rows, n_columns, size, matrix)
    integer, intent(in) :: n_rows, n_columns
    real(DP), intent(in) :: size
    type(sparse_type), intent(out) :: matrix
    type(error_type), allocatable :: error
    integer :: row(5 * max(n_rows, n_columns)), column(5 * max(n_rows, n_columns)), i
    real(DP) :: value(5 * max(n_rows, n_columns))
    call random_number(value)
    row = [(1 + mod(7 * i + i / 11, n_rows), i=1, ubound(row, 1))]
    column = [(1 + mod(i, n_columns), i=1, ubound(row, 1))]
    call sparse_from_triplets(n_rows, n_columns, row, column, size * value, matrix, error)
  end subroutine random_matrix


  !> The residual of the solution meets the limit, down to rounding, and the solution is LAPACK's.
  subroutine test_solution(name, n, m, stiffness, size)
    character(*), intent(in) :: name
    integer, intent(in) :: n, m
    real(DP), intent(in) :: stiffness              !< of the springs over that of the body [-]
    real(DP), intent(in), optional :: size         !< of the body's [force/length]; 1 without it
    type(woodbury_type) :: woodbury
    type(contact_springs_type) :: springs
    type(error_type), allocatable :: error
    real(DP) :: triangle(n, n), shift(n), J(n, n), r(n), x(n), exact(n), unit
    real(DP), parameter :: ALLOWED(3) = [1.0e-2_DP, 1.0e-6_DP, 1.0e-11_DP]
    integer :: i, status
    logical :: is_fit
    unit = 1.0_DP
    if (present(size)) unit = size
    call make_body(n, unit, triangle, shift)
    call make_springs(n, m, stiffness * unit, springs)
    J = matmul(triangle, transpose(triangle)) - matmul(dense_of(springs%force_distribution), dense_of(springs%spring_tangent)) &
      - matmul(dense_of(springs%distribution_change), dense_of(springs%projection_gradient))
    do i = 1, n
      J(i, i) = J(i, i) - shift(i)
    end do
    call random_number(r)
    r = r / norm2(r)
    call solve_small(J, r, exact, status)
    call suite%that(name // ': the matrix is regular', status == DENSE_OK)
    call invert_interface_stiffness(woodbury, triangle, shift, error)
    call suite%that(name // ': inverted', woodbury%has_inverse .and. .not. allocated(error))
    call factorise_spring_coupling(woodbury, springs, is_fit, error)
    call suite%that(name // ': coupled', is_fit .and. .not. allocated(error))
    do i = 1, 3
      x = r
      call solve_woodbury(woodbury, triangle, shift, ALLOWED(i), x, error)
      call suite%near(name // ': the residual', norm2(matmul(J, x) - r), 0.0_DP, 1.01_DP * ALLOWED(i))
    end do
    call suite%near(name // ': the solution', norm2(x - exact) / norm2(exact), 0.0_DP, 1.0e-7_DP)
  end subroutine test_solution


  !> An unsupported body has no inverse; springs of ten thousand times its stiffness exceed single precision.
  subroutine test_limits()
    integer, parameter :: N = 30
    type(woodbury_type) :: woodbury
    type(contact_springs_type) :: springs
    type(error_type), allocatable :: error
    real(DP) :: triangle(N, N), shift(N)
    logical :: is_fit
    call make_body(N, 1.0_DP, triangle, shift)
    triangle(N, :) = triangle(N - 1, :)
    shift = 0.0_DP
    call invert_interface_stiffness(woodbury, triangle, shift, error)
    call suite%that('a mechanism has no inverse', .not. (woodbury%has_inverse .or. allocated(error)))
    call make_body(N, 1.0_DP, triangle, shift)
    call invert_interface_stiffness(woodbury, triangle, shift, error)
    call make_springs(N, 8, 1.0e5_DP, springs)
    call factorise_spring_coupling(woodbury, springs, is_fit, error)
    call suite%that('springs that are too stiff', .not. (is_fit .or. allocated(error)))
    call make_springs(N, 8, 1.0_DP, springs)
    call factorise_spring_coupling(woodbury, springs, is_fit, error)
    call suite%that('soft ones after them', is_fit)
  end subroutine test_limits


  !> Bitwise equal results with threads.
  subroutine test_threads()
    use omp_lib, only: omp_set_num_threads, omp_get_max_threads
    integer, parameter :: N = 900, M = 170
    type(woodbury_type), allocatable :: woodbury
    type(contact_springs_type) :: springs
    type(error_type), allocatable :: error
    real(DP), allocatable :: triangle(:, :), shift(:), r(:), x(:), first(:)
    integer :: n_threads, before
    logical :: is_fit
    allocate (triangle(N, N), shift(N), r(N), x(N), first(N))
    call make_body(N, 1.0_DP, triangle, shift)
    call make_springs(N, M, 1.0_DP, springs)
    call random_number(r)
    before = omp_get_max_threads()
    do n_threads = 1, 3
      call omp_set_num_threads(n_threads)
      allocate (woodbury)
      call invert_interface_stiffness(woodbury, triangle, shift, error)
      call factorise_spring_coupling(woodbury, springs, is_fit, error)
      x = r
      call solve_woodbury(woodbury, triangle, shift, 1.0e-6_DP, x, error)
      if (n_threads == 1) first = x
      call suite%that('threads: the same bits', is_fit .and. all(abs(x - first) <= 0.0_DP))
      deallocate (woodbury)
    end do
    call omp_set_num_threads(before)
  end subroutine test_threads

end program test_woodbury_interface
