!> Unit test of sparse: every product against its dense equivalent, as a ratio to the rounding error that theory allows.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_sparse
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, EXIT_INTERNAL
  use amontons_sparse, only: sparse_type, sparse_from_triplets, sparse_transpose, full_from_upper, rows_of, sparse_product, &
    sparse_sum, multiply, multiply_transpose, multiply_symmetric, alike_rows
  use check, only: suite_type
  use samples, only: dense_of
  implicit none
  type(suite_type) :: suite
  integer, parameter :: SIZES(5) = [1, 2, 5, 40, 100]
  integer :: k
  call random_seed(put=[(17 * k, k=1, 64)])
  do k = 1, size(SIZES)
    call test_triplets(SIZES(k), SIZES(k) + 3)
    call test_products(SIZES(k))
  end do
  call test_large()
  call test_node_blocks(1, 1)
  call test_node_blocks(7, 3)
  call test_node_blocks(7000, 5)
  call test_errors()
  call suite%finish()

contains

  !> A random matrix of about three entries a row, with some duplicates, and its dense equivalent.
  subroutine random_matrix(n, m, sparse, dense)
    integer, intent(in) :: n, m
    type(sparse_type), intent(out) :: sparse
    real(DP), allocatable, intent(out) :: dense(:, :)
    type(error_type), allocatable :: error
    real(DP) :: place(2, 4 * n), value(4 * n)
    integer :: row(4 * n), column(4 * n), k
    call random_number(place)
    call random_number(value)
    row = 1 + int(real(n, DP) * place(1, :))
    column = 1 + int(real(m, DP) * place(2, :))
    row(n + 1:2 * n:2) = row(1:n:2)
    column(n + 1:2 * n:2) = column(1:n:2)
    value = value - 0.5_DP
    allocate (dense(n, m), source=0.0_DP)
    do k = 1, 4 * n
      dense(row(k), column(k)) = dense(row(k), column(k)) + value(k)
    end do
    call sparse_from_triplets(n, m, row, column, value, sparse, error)
    call suite%that('triplets are accepted', .not. allocated(error))
  end subroutine random_matrix


  !> A random symmetric matrix with its diagonal, as upper triangle and dense.
  subroutine random_symmetric(n, sparse, dense)
    integer, intent(in) :: n
    type(sparse_type), intent(out) :: sparse
    real(DP), allocatable, intent(out) :: dense(:, :)
    type(sparse_type) :: any_matrix
    real(DP), allocatable :: any_dense(:, :)
    type(error_type), allocatable :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, j
    call random_matrix(n, n, any_matrix, any_dense)
    dense = any_dense + transpose(any_dense)
    allocate (row(0), column(0), value(0))
    do i = 1, n
      dense(i, i) = dense(i, i) + 4
      do j = i, n
        if (i /= j .and. .not. abs(dense(i, j)) > 0) cycle
        row = [row, i]
        column = [column, j]
        value = [value, dense(i, j)]
      end do
    end do
    call sparse_from_triplets(n, n, row, column, value, sparse, error)
  end subroutine random_symmetric


  !> Columns ascend strictly in every row, and the row starts fit.
  logical function is_sorted(sparse)
    type(sparse_type), intent(in) :: sparse
    integer :: i, p
    is_sorted = sparse%first(1) == 1 .and. sparse%first(sparse%n_rows + 1) == size(sparse%column) + 1 .and. &
                size(sparse%column) == size(sparse%value)
    do i = 1, sparse%n_rows
      do p = sparse%first(i) + 1, sparse%first(i + 1) - 1
        is_sorted = is_sorted .and. sparse%column(p) > sparse%column(p - 1)
      end do
    end do
  end function is_sorted


  !> |y - M x| over n eps |M| |x|, the largest component; LAPACK's tests require less than about 30.
  real(DP) function ratio(dense, x, y)
    real(DP), intent(in) :: dense(:, :), x(:), y(:)
    real(DP) :: expected(size(y)), scale(size(y))
    integer :: k
    expected = matmul(dense, x)
    do k = 1, size(y)
      scale(k) = sum(abs(dense(k, :) * x))
    end do
    ratio = maxval(abs(y - expected) / (epsilon(1.0_DP) * real(size(x), DP) * scale + tiny(1.0_DP)))
  end function ratio


  subroutine test_triplets(n, m)
    integer, intent(in) :: n, m
    type(sparse_type) :: a, again
    real(DP), allocatable :: dense(:, :)
    call random_matrix(n, m, a, dense)
    call suite%that('triplets: sorted, no place twice', is_sorted(a))
    call suite%near('triplets: summed', maxval(abs(dense_of(a) - dense)), 0.0_DP, 0.0_DP)
    again = sparse_transpose(a)
    call suite%that('transpose: sorted', is_sorted(again))
    call suite%near('transpose', maxval(abs(dense_of(again) - transpose(dense))), 0.0_DP, 0.0_DP)
  end subroutine test_triplets


  subroutine test_products(n)
    integer, intent(in) :: n
    type(sparse_type) :: a, b, s, c
    real(DP), allocatable :: dense(:, :), dense_b(:, :), dense_s(:, :)
    real(DP) :: x(n + 3), y(n + 3)
    call random_number(x)
    call random_matrix(n, n + 3, a, dense)
    call multiply(a, x, y(:n))
    call suite%near('multiply, ratio', ratio(dense, x, y(:n)), 0.0_DP, 1.0_DP)
    call multiply_transpose(a, x(:n), y)
    call suite%near('multiply_transpose, ratio', ratio(transpose(dense), x(:n), y), 0.0_DP, 1.0_DP)
    call random_symmetric(n, s, dense_s)
    call multiply_symmetric(s, x(:n), y(:n))
    call suite%near('multiply_symmetric, ratio', ratio(dense_s, x(:n), y(:n)), 0.0_DP, 1.0_DP)
    c = full_from_upper(s)
    call suite%that('full_of: sorted', is_sorted(c))
    call suite%near('full_of', maxval(abs(dense_of(c) - dense_s)), 0.0_DP, 0.0_DP)
    call random_matrix(n, n + 3, b, dense_b)
    s = sparse_sum(a, -3.0_DP, b)
    call suite%that('sum_of: sorted', is_sorted(s))
    call suite%near('sum_of', maxval(abs(dense_of(s) - dense + 3 * dense_b)), 0.0_DP, 1.0e-14_DP)
    call random_matrix(n + 3, 2 * n, b, dense_b)
    c = sparse_product(a, b)
    call suite%that('product_of: sorted', is_sorted(c))
    c = rows_of(a, [n, 1, n])
    call suite%near('rows_of', maxval(abs(dense_of(c) - dense([n, 1, n], :))), 0.0_DP, 0.0_DP)
    c = sparse_product(a, b)
    call suite%near('product_of', maxval(abs(dense_of(c) - matmul(dense, dense_b))), 0.0_DP, 1.0e-15_DP * real(n, DP))
  end subroutine test_products


  !> Large enough for threads: against the rows of the full matrix, and bitwise the same twice.
  subroutine test_large()
    integer, parameter :: N = 20000, WIDTH = 15
    type(sparse_type) :: pattern
    type(error_type), allocatable :: error
    real(DP), dimension(N) :: x, y, again, other
    integer, allocatable :: row(:), column(:)
    integer :: i, j
    row = [((i, j=i, min(i + WIDTH - 1, N)), i=1, N)]
    column = [((j, j=i, min(i + WIDTH - 1, N)), i=1, N)]
    call sparse_from_triplets(N, N, row, column, spread(0.0_DP, 1, size(row)), pattern, error)
    call random_number(pattern%value)
    call random_number(x)
    call multiply_symmetric(pattern, x, y)
    call multiply_symmetric(pattern, x, again)
    call multiply(full_from_upper(pattern), x, other)
    call suite%that('multiply_symmetric: bitwise repeatable', all(abs(y - again) <= 0))
    call suite%near('multiply_symmetric: threads share it right', maxval(abs(y - other) / y), 0.0_DP, 1.0e-14_DP)
  end subroutine test_large


  !> Rows of nodes with the same columns, three at a time as one by one, small and large enough for threads; the first node has two
  !! rows alone.
  subroutine test_node_blocks(n_nodes, width)
    integer, intent(in) :: n_nodes, width          ! width: nodes coupled with a node, each second one
    type(sparse_type) :: matrix
    type(error_type), allocatable :: error
    real(DP), dimension(3 * n_nodes - 1) :: x, y, by_rows
    integer, allocatable :: row(:), column(:)
    integer :: node, other, r, s, n
    allocate (row(9 * n_nodes * width), column(9 * n_nodes * width))
    n = 0
    do node = 1, n_nodes
      do r = 1, 3
        do other = node, min(node + 2 * (width - 1), n_nodes), 2
          do s = merge(r, 1, other == node), 3
            if (node == 1 .and. r == 3 .or. other == 1 .and. s == 3) cycle
            n = n + 1
            row(n) = shifted(3 * (node - 1) + r)
            column(n) = shifted(3 * (other - 1) + s)
          end do
        end do
      end do
    end do
    call sparse_from_triplets(3 * n_nodes - 1, 3 * n_nodes - 1, row(:n), column(:n), spread(0.0_DP, 1, n), matrix, error)
    call random_number(matrix%value)
    call random_number(x)
    call multiply_symmetric(matrix, x, by_rows)
    matrix%n_alike = alike_rows(matrix)
    call suite%that('alike rows: all but the first node', all(int(matrix%n_alike) == [1, 1, (3 - mod(n, 3), n=0, 3 * n_nodes - 4)]))
    call multiply_symmetric(matrix, x, y)
    call suite%near('multiply_symmetric: three rows at a time', maxval(abs(y - by_rows) / by_rows), 0.0_DP, 1.0e-14_DP)

  end subroutine test_node_blocks


  !> Unknowns without the third one of the first node.
  pure integer function shifted(i)
    integer, intent(in) :: i
    shifted = i - merge(1, 0, i > 3)
  end function shifted


  subroutine test_errors()
    type(sparse_type) :: a
    type(error_type), allocatable :: error
    call sparse_from_triplets(2, 2, [1, 3], [1, 1], [1.0_DP, 1.0_DP], a, error)
    call expect_error('a row outside the matrix', error)
    call sparse_from_triplets(2, 2, [1, 2], [1, 0], [1.0_DP, 1.0_DP], a, error)
    call expect_error('a column outside the matrix', error)
    call sparse_from_triplets(2, 2, [1, 2], [1], [1.0_DP, 1.0_DP], a, error)
    call expect_error('triplets of unequal length', error)
  end subroutine test_errors


  subroutine expect_error(what, error)
    character(*), intent(in) :: what
    type(error_type), allocatable, intent(in) :: error
    call suite%that('error reported: ' // what, allocated(error))
    if (allocated(error)) call suite%that('internal: ' // what, error%code == EXIT_INTERNAL)
  end subroutine expect_error

end program test_sparse
