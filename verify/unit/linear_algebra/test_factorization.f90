!> Unit test of factorization: residual ratios, bitwise repeatability, and every status of a factorization.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_factorization
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, EXIT_INTERNAL, EXIT_SOLVER
  use amontons_sparse, only: sparse_type, sparse_from_triplets, full_from_upper, multiply, multiply_symmetric
  use amontons_factorization, only: cholesky_type, lu_type, analyse, factorise, solve, estimate_memory, lu_factorise, lu_solve, &
    elimination_order, trailing_block, choose_blas_kernels, &
    FACTOR_OK, FACTOR_NOT_POSITIVE, FACTOR_NEARLY_SINGULAR, FACTOR_NOT_FINITE, TOL_PIVOT
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: SIZES(5) = [1, 2, 5, 10, 22]
  integer :: k
  call random_seed(put=[(11 * k, k=1, 64)])
  do k = 1, size(SIZES)
    call test_cholesky(SIZES(k))
    call test_lu(SIZES(k))
  end do
  call test_kernels()
  call test_repeat()
  call test_full()
  call test_shift()
  call test_two_factors()
  call test_breakdown()
  call test_singular()
  call test_not_finite()
  call test_empty()
  call test_errors()
  call test_lu_exits()
  call suite%finish()

contains

  !> The 7-point Laplacian of an n x n x n grid with random coefficients, upper triangle. Grounded: positive definite.
  subroutine laplacian(n, is_grounded, matrix)
    integer, intent(in) :: n
    logical, intent(in) :: is_grounded         !< else each row sums to 0
    type(sparse_type), intent(out) :: matrix
    type(error_type), allocatable :: error
    integer, parameter :: MAX_PER_ROW = 4
    integer :: row(MAX_PER_ROW * n**3), column(MAX_PER_ROW * n**3), i, d, k, other, step(3)
    real(DP) :: value(MAX_PER_ROW * n**3), diagonal(n**3), dice
    step = [1, n, n**2]
    diagonal = merge(0.01_DP, 0.0_DP, is_grounded)
    k = 0
    do i = 1, n**3
      do d = 1, 3
        if (mod((i - 1) / step(d), n) == n - 1) cycle
        other = i + step(d)
        call random_number(dice)
        k = k + 1
        row(k) = i
        column(k) = other
        value(k) = -0.5_DP - dice
        diagonal([i, other]) = diagonal([i, other]) - value(k)
      end do
    end do
    row(k + 1:k + n**3) = [(i, i=1, n**3)]
    column(k + 1:k + n**3) = [(i, i=1, n**3)]
    value(k + 1:k + n**3) = diagonal
    k = k + n**3
    call sparse_from_triplets(n**3, n**3, row(:k), column(:k), value(:k), matrix, error)
  end subroutine laplacian


  !> |b - A x| over |A| |x| n eps in the largest norm; LAPACK's tests require less than about 30.
  real(DP) function ratio(full, x, b)
    type(sparse_type), intent(in) :: full      !< both triangles
    real(DP), intent(in) :: x(:), b(:)
    real(DP) :: residual(size(b)), norm
    integer :: i
    call multiply(full, x, residual)
    norm = maxval([(sum(abs(full%value(full%first(i):full%first(i + 1) - 1))), i=1, full%n_rows)])
    ratio = maxval(abs(residual - b)) / (norm * maxval(abs(x)) * real(size(b), DP) * epsilon(1.0_DP))
  end function ratio


  subroutine test_cholesky(n)
    integer, intent(in) :: n
    type(sparse_type) :: matrix, full
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    real(DP) :: b(n**3, 9), x(n**3, 9), y(n**3)
    integer :: status, i
    call laplacian(n, .true., matrix)
    full = full_from_upper(matrix)
    call random_number(b)
    call analyse(factor, matrix, error=error)
    call suite%that('cholesky: analysed', .not. allocated(error) .and. .not. factor%is_ready)
    call suite%that('cholesky: memory known', estimate_memory(factor) > 0)
    call suite%that('cholesky: entries known', nint(factor%n_entries) >= size(matrix%column))
    call factorise(factor, matrix, status, error=error)
    call suite%that('cholesky: status', status == FACTOR_OK .and. factor%is_ready .and. .not. allocated(error))
    call suite%that('cholesky: pivots', factor%pivot_ratio > TOL_PIVOT .and. factor%pivot_ratio <= 1 + 1.0e-14_DP)
    call solve(factor, b(:, 1), y)
    call suite%near('cholesky: ratio', ratio(full, y, b(:, 1)), 0.0_DP, 10.0_DP)
    call solve(factor, b, x)
    call suite%near('cholesky: ratio of the last of several', ratio(full, x(:, 9), b(:, 9)), 0.0_DP, 10.0_DP)
    call analyse(factor, matrix, [(i, i=n**3, 1, -1)], error)
    call factorise(factor, matrix, status, error=error)
    call solve(factor, b(:, 1), y)
    call suite%near('cholesky: ratio with a given order', ratio(full, y, b(:, 1)), 0.0_DP, 10.0_DP)
    matrix%value = 4 * matrix%value            ! L doubles, without rounding
    call factorise(factor, matrix, status, error=error)
    call solve(factor, 4 * b(:, 1), x(:, 1))
    call suite%near('cholesky: new values in the old pattern', maxval(abs(x(:, 1) - y)), 0.0_DP, 0.0_DP)
  end subroutine test_cholesky


  !> A processor with AVX2 never uses OpenBLAS's kernels for unknown processors; the choice is the same when repeated.
  subroutine test_kernels()
    character(:), allocatable :: name, again
    character(8192) :: line
    integer :: unit, status
    logical :: is_modern
    call choose_blas_kernels(name)
    call choose_blas_kernels(again)
    call suite%that('kernels: chosen once', name == again)
    is_modern = .false.
    open (newunit=unit, file='/proc/cpuinfo', status='old', action='read', iostat=status)
    do while (status == 0)
      read (unit, '(a)', iostat=status) line
      if (status == 0 .and. index(line, 'flags') == 1) is_modern = index(line, ' avx2 ') > 0 .and. index(line, ' fma ') > 0
    end do
    call get_environment_variable('OPENBLAS_CORETYPE', status=status)
    if (is_modern .and. status /= 0) call suite%that('kernels: not those for unknown processors', name /= 'Prescott')
  end subroutine test_kernels


  !> The same matrix twice in one factor and once in another: the same bits, for one thread and for more, which agree to rounding.
  subroutine test_repeat()
    use omp_lib, only: omp_set_num_threads, omp_get_max_threads
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor, other
    type(error_type), allocatable :: error
    real(DP), allocatable :: b(:), x(:), again(:), alone(:)
    integer :: status, n_threads, before
    call laplacian(20, .true., matrix)
    allocate (b(matrix%n_rows), x(matrix%n_rows), again(matrix%n_rows), alone(matrix%n_rows))
    call random_number(b)
    before = omp_get_max_threads()
    do n_threads = 1, 3
      call omp_set_num_threads(n_threads)
      call analyse(factor, matrix, error=error)
      call factorise(factor, matrix, status, error=error)
      call solve(factor, b, x)
      if (n_threads == 1) alone = x
      call factorise(factor, matrix, status, error=error)
      call solve(factor, b, again)
      call suite%that('the same factor: bitwise', all(abs(x - again) <= 0))
      call analyse(other, matrix, error=error)
      call factorise(other, matrix, status, error=error)
      call solve(other, b, again)
      call suite%that('another factor: bitwise', all(abs(x - again) <= 0))
      call suite%near('threads agree', maxval(abs(x - alone)), 0.0_DP, 1.0e-12_DP * maxval(abs(alone)))
      call omp_set_num_threads(1)
      call solve(factor, b, again)
      call suite%near('a factor of more threads serves one', maxval(abs(again - alone)), 0.0_DP, 1.0e-12_DP * maxval(abs(alone)))
      call suite%that('large enough for threads', factor%n_operations > 3.0e7_DP)
      call test_broken_together(n_threads)
    end do
    call omp_set_num_threads(before)
  end subroutine test_repeat


  !> A matrix that is indefinite in its last elimination steps, where threads work together, or in its first.
  subroutine test_broken_together(n_threads)
    use omp_lib, only: omp_set_num_threads
    integer, intent(in) :: n_threads
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    integer, allocatable :: order(:)
    integer :: status, k
    call omp_set_num_threads(n_threads)
    call laplacian(16, .true., matrix)
    call analyse(factor, matrix, error=error)
    allocate (order(matrix%n_rows))
    call elimination_order(factor, order)
    do k = 1, size(order), size(order) - 1
      associate (diagonal => matrix%value(matrix%first(order(k))))
        diagonal = -diagonal
        call factorise(factor, matrix, status, error=error)
        call suite%that('broken: reported', status == FACTOR_NOT_POSITIVE .and. .not. factor%is_ready)
        call suite%that('broken: where', factor%min_pivot_unknown == order(k))
        diagonal = -diagonal
      end associate
    end do
    call factorise(factor, matrix, status, error=error)
    call suite%that('broken: whole again', status == FACTOR_OK)
  end subroutine test_broken_together


  !> A full matrix is one supernode, cut into panels: L L' is the matrix, for any number of threads.
  subroutine test_full()
    use omp_lib, only: omp_set_num_threads, omp_get_max_threads
    integer, parameter :: N = 1100
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    real(DP), allocatable :: a(:, :), l(:, :)
    real(DP) :: x(N)
    integer :: i, status, n_threads, before
    allocate (a(N, N), l(N, N))
    call random_number(x)
    call random_number(a)
    a = a + transpose(a)
    do i = 1, N
      a(i, i) = 2.0_DP * N
    end do
    matrix%n_rows = N
    matrix%n_columns = N
    matrix%first = [(1 + (i - 1) * N - (i - 1) * (i - 2) / 2, i=1, N + 1)]
    matrix%column = [([(status, status=i, N)], i=1, N)]
    matrix%value = [(a(i, i:), i=1, N)]
    before = omp_get_max_threads()
    do n_threads = 1, 3
      call omp_set_num_threads(n_threads)
      call analyse(factor, matrix, [(i, i=1, N)], error)
      call factorise(factor, matrix, status, error=error)
      call suite%that('full: status', status == FACTOR_OK .and. .not. allocated(error))
      call suite%that('full: cut into panels', factor%n_supernodes > 1)
      call trailing_block(factor, l)
      call suite%near('full: product of the triangles', maxval(abs(matmul(l, matmul(x, l)) - matmul(a, x))), 0.0_DP, &
        4 * N * N * epsilon(1.0_DP))
    end do
    call omp_set_num_threads(before)
  end subroutine test_full


  subroutine test_shift()
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    real(DP) :: b(125), x(125), y(125), shift(125)
    integer :: status
    call laplacian(5, .false., matrix)
    call random_number(shift)
    call random_number(x)
    call multiply_symmetric(matrix, x, b)
    b = b + shift * x
    call analyse(factor, matrix, error=error)
    call factorise(factor, matrix, status, shift, error)
    call solve(factor, b, y)
    call suite%that('shift: makes a singular matrix definite', status == FACTOR_OK)
    call suite%near('shift: solution', maxval(abs(x - y)), 0.0_DP, 1.0e-12_DP)
  end subroutine test_shift


  !> Two factors exist side by side; a copy is empty and changes neither.
  subroutine test_two_factors()
    type(sparse_type) :: small, large
    type(cholesky_type) :: first, second, third
    type(error_type), allocatable :: error
    real(DP) :: b(64), x(64), y(64)
    integer :: status
    call laplacian(4, .true., small)
    call laplacian(6, .true., large)
    b = 1
    call analyse(first, small, error=error)
    call factorise(first, small, status, error=error)
    call solve(first, b, x)
    call analyse(second, large, error=error)
    call factorise(second, large, status, error=error)
    third = first
    call suite%that('a copy is empty', .not. third%is_ready .and. third%n_unknowns == 0)
    third = second
    call solve(first, b, y)
    call suite%that('another factor does not disturb the first', all(abs(x - y) <= 0))
    second = third
    call suite%that('overwritten by an empty one', .not. second%is_ready)
  end subroutine test_two_factors


  !> Not positive definite: the unknown is reported, and the factor can be used again for another matrix.
  subroutine test_breakdown()
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    real(DP) :: b(1000), x(1000), good
    integer :: status
    call laplacian(10, .true., matrix)
    b = 1
    call analyse(factor, matrix, error=error)
    good = matrix%value(matrix%first(333))
    matrix%value(matrix%first(333)) = -100
    call factorise(factor, matrix, status, error=error)
    call suite%that('indefinite: reported', status == FACTOR_NOT_POSITIVE .and. .not. allocated(error))
    call suite%that('indefinite: not ready', .not. factor%is_ready)
    call suite%that('indefinite: where', factor%min_pivot_unknown == 333)
    matrix%value(matrix%first(333)) = good
    call factorise(factor, matrix, status, error=error)
    call solve(factor, b, x)
    call suite%that('indefinite: and then definite', status == FACTOR_OK)
    call suite%near('indefinite: and then solved, ratio', ratio(full_from_upper(matrix), x, b), 0.0_DP, 10.0_DP)
  end subroutine test_breakdown


  !> An unsupported grid: the last pivot is at rounding level, of either sign; a hinge as small as it is harmless.
  subroutine test_singular()
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    integer :: status, k
    logical :: is_reported
    is_reported = .true.
    do k = 1, 10
      call laplacian(4, .false., matrix)
      call analyse(factor, matrix, error=error)
      call factorise(factor, matrix, status, error=error)
      is_reported = is_reported .and. (status == FACTOR_NEARLY_SINGULAR .or. status == FACTOR_NOT_POSITIVE)
    end do
    call suite%that('singular: reported ten times', is_reported)
    call sparse_from_triplets(2, 2, [1, 2], [1, 2], [1.0e12_DP, 1.0e-12_DP], matrix, error)
    call analyse(factor, matrix, error=error)
    call factorise(factor, matrix, status, error=error)
    call suite%that('small beside large is not singular', status == FACTOR_OK)
    call sparse_from_triplets(2, 2, [1, 1, 2], [1, 2, 2], [1.0_DP, 1.0_DP, 1.0_DP + epsilon(1.0_DP)], matrix, error)
    call analyse(factor, matrix, [1, 2], error)
    call factorise(factor, matrix, status, error=error)
    call suite%that('a pivot of one rounding: nearly singular', status == FACTOR_NEARLY_SINGULAR)
    call suite%that('a pivot of one rounding: where', factor%min_pivot_unknown == 2)
    call suite%that('nearly singular: ready all the same', factor%is_ready)
  end subroutine test_singular


  subroutine test_not_finite()
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(lu_type) :: lu
    type(error_type), allocatable :: error
    integer :: status
    call laplacian(3, .true., matrix)
    call analyse(factor, matrix, error=error)
    matrix%value(20) = ieee_value(1.0_DP, ieee_quiet_nan)
    call factorise(factor, matrix, status, error=error)
    call suite%that('NaN: reported', status == FACTOR_NOT_FINITE .and. .not. factor%is_ready .and. .not. allocated(error))
    call lu_factorise(lu, matrix, status, error)
    call suite%that('NaN: reported by LU', status == FACTOR_NOT_FINITE .and. .not. lu%is_ready .and. .not. allocated(error))
    matrix%value(20) = ieee_value(1.0_DP, ieee_positive_inf)
    call factorise(factor, matrix, status, error=error)
    call suite%that('infinity: reported', status == FACTOR_NOT_FINITE)
  end subroutine test_not_finite


  !> All unknowns fixed: an empty matrix.
  subroutine test_empty()
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(lu_type) :: lu
    type(error_type), allocatable :: error
    real(DP) :: nothing(0), x(0)
    integer :: status
    call sparse_from_triplets(0, 0, [integer ::], [integer ::], [real(DP) ::], matrix, error)
    call analyse(factor, matrix, error=error)
    call factorise(factor, matrix, status, error=error)
    call solve(factor, nothing, x)
    call suite%that('no unknowns: fine', status == FACTOR_OK .and. factor%is_ready .and. .not. allocated(error))
    call lu_factorise(lu, matrix, status, error)
    call lu_solve(lu, nothing, x)
    call suite%that('no unknowns: fine for LU', status == FACTOR_OK .and. .not. allocated(error))
  end subroutine test_empty


  subroutine test_errors()
    integer, parameter :: N = 70000
    type(sparse_type) :: matrix
    type(cholesky_type) :: factor
    type(error_type), allocatable :: error
    integer :: status, k
    call laplacian(2, .true., matrix)
    call analyse(factor, matrix, error=error)
    call laplacian(3, .true., matrix)
    call factorise(factor, matrix, status, error=error)
    call expect_error('another matrix than the one analysed', EXIT_INTERNAL, error)
    call analyse(factor, matrix, [(1, k=1, 27)], error)
    call expect_error('an order that is no permutation', EXIT_INTERNAL, error)
    ! An arrow whose head is eliminated first fills the whole triangle: 2.45 thousand million entries.
    call sparse_from_triplets(N, N, [(1, k=2, N), (k, k=1, N)], [(k, k=2, N), (k, k=1, N)], [(1.0_DP, k=2, 2 * N)], matrix, &
                       error)
    call analyse(factor, matrix, [(k, k=1, N)], error)
    call expect_error('a factor too large to be counted', EXIT_SOLVER, error)
    call analyse(factor, matrix, error=error)
    call suite%that('the arrow in a good order is small', factor%n_entries < 2.5_DP * real(N, DP))
  end subroutine test_errors


  subroutine expect_error(what, code, error)
    character(*), intent(in) :: what
    integer, intent(in) :: code
    type(error_type), allocatable, intent(in) :: error
    call suite%that('error reported: ' // what, allocated(error))
    if (allocated(error)) call suite%that('code of the error: ' // what, error%code == code)
  end subroutine expect_error


  !> An unsymmetric matrix: the grid with random numbers in both triangles.
  subroutine test_lu(n)
    integer, intent(in) :: n
    type(sparse_type) :: matrix, full
    type(lu_type) :: lu
    type(error_type), allocatable :: error
    real(DP) :: b(n**3), x(n**3), dice(7 * n**3)
    integer :: status, round
    call laplacian(n, .true., matrix)
    full = full_from_upper(matrix)
    do round = 1, 2                            ! the second time with the analysis of the first
      call random_number(b)
      call random_number(dice)
      full%value = full%value + 0.3_DP * (dice(:size(full%value)) - 0.5_DP)
      call lu_factorise(lu, full, status, error)
      call suite%that('lu: status', status == FACTOR_OK .and. lu%is_ready .and. .not. allocated(error))
      call lu_solve(lu, b, x)
      call suite%near('lu: ratio', ratio(full, x, b), 0.0_DP, 10.0_DP)
    end do
    call suite%that('lu: memory reported', lu%megabytes > 0)
    call lu_factorise(lu, transposed(full), status, error)
    call lu_solve(lu, b, x)
    call suite%near('lu: another pattern or matrix, ratio', ratio(transposed(full), x, b), 0.0_DP, 10.0_DP)
  end subroutine test_lu


  !> The transpose, with one more entry so that the pattern is another.
  function transposed(a) result(b)
    type(sparse_type), intent(in) :: a
    type(sparse_type) :: b
    type(error_type), allocatable :: error
    integer :: row(size(a%column)), i
    do i = 1, a%n_rows
      row(a%first(i):a%first(i + 1) - 1) = i
    end do
    call sparse_from_triplets(a%n_rows, a%n_rows, [a%column, 1], [row, a%n_rows], [a%value, 0.1_DP], b, error)
  end function transposed


  subroutine test_lu_exits()
    type(sparse_type) :: matrix
    type(lu_type) :: lu, copy
    type(error_type), allocatable :: error
    real(DP) :: x(2)
    integer :: status
    call sparse_from_triplets(2, 2, [1, 1, 2, 2], [1, 2, 1, 2], [1.0_DP, 2.0_DP, 2.0_DP, 4.0_DP], matrix, error)
    call lu_factorise(lu, matrix, status, error)
    call suite%that('lu: singular reported', status == FACTOR_NEARLY_SINGULAR .and. .not. lu%is_ready)
    call sparse_from_triplets(2, 2, [1, 2], [1, 1], [1.0_DP, 2.0_DP], matrix, error)
    call lu_factorise(lu, matrix, status, error)
    call suite%that('lu: an empty column reported', status == FACTOR_NEARLY_SINGULAR .and. .not. allocated(error))
    call sparse_from_triplets(2, 2, [1, 2], [2, 1], [4.0_DP, 2.0_DP], matrix, error)
    call lu_factorise(lu, matrix, status, error)
    call lu_solve(lu, [4.0_DP, 6.0_DP], x)
    call suite%near('lu: pivots where the diagonal is 0, first', x(1), 3.0_DP, 0.0_DP)
    call suite%near('lu: pivots where the diagonal is 0, second', x(2), 1.0_DP, 0.0_DP)
    copy = lu
    call suite%that('lu: a copy is empty', .not. copy%is_ready)
    call sparse_from_triplets(2, 3, [1, 2], [2, 1], [4.0_DP, 2.0_DP], matrix, error)
    call lu_factorise(lu, matrix, status, error)
    call expect_error('LU of a matrix that is not square', EXIT_INTERNAL, error)
  end subroutine test_lu_exits

end program test_factorization
