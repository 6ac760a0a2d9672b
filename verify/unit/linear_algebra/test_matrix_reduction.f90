!> Unit test of the reduction C'KC: against the product of the dense matrices, as a ratio to the rounding error that theory allows.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_matrix_reduction
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, EXIT_INTERNAL
  use amontons_sparse, only: sparse_type, sparse_from_triplets, full_from_upper
  use amontons_matrix_reduction, only: reduction_type, analyse_reduction, reduce_matrix
  use check, only: suite_type
  use samples, only: dense_of
  implicit none
  type(suite_type) :: suite
  integer, parameter :: SIZES(5) = [1, 2, 5, 40, 100]
  integer :: k
  call random_seed(put=[(17 * k, k=1, 64)])
  do k = 1, size(SIZES)
    call test_reduction(SIZES(k), (2 * SIZES(k) + 2) / 3)
  end do
  call test_reduction(6, 0)
  call test_idle(40, 27)
  call test_errors()
  call suite%finish()

contains

  !> A random symmetric matrix with its diagonal and about three other entries a row, as upper triangle and dense.
  subroutine random_symmetric(n, sparse, dense)
    integer, intent(in) :: n
    type(sparse_type), intent(out) :: sparse
    real(DP), allocatable, intent(out) :: dense(:, :)
    type(error_type), allocatable :: error
    real(DP) :: dice(n, n)
    integer :: i, j
    integer, allocatable :: row(:), column(:)
    allocate (dense(n, n))
    call random_number(dense)
    call random_number(dice)
    row = [((pack([i], i == j .or. dice(i, j) * real(n, DP) < 3.0_DP), i=1, j), j=1, n)]
    column = [((pack([j], i == j .or. dice(i, j) * real(n, DP) < 3.0_DP), i=1, j), j=1, n)]
    call sparse_from_triplets(n, n, row, column, [(dense(row(i), column(i)), i=1, size(row))], sparse, error)
    dense = dense_of(full_from_upper(sparse))
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


  !> Rows of C empty, with one entry (1 or another number, columns shared), and with several.
  subroutine random_relation(n, m, relation, dense)
    integer, intent(in) :: n, m
    type(sparse_type), intent(out) :: relation
    real(DP), allocatable, intent(out) :: dense(:, :)
    type(error_type), allocatable :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    real(DP) :: dice(7)
    integer :: i, k, width
    allocate (row(0), column(0), value(0))
    do i = 1, n
      call random_number(dice)
      width = merge(int(5 * dice(1)), int(2 * dice(1)), dice(2) < 0.3_DP)
      if (m == 0) width = 0
      do k = 1, width
        row = [row, i]
        column = [column, 1 + int(real(m, DP) * dice(2 + k))]
        value = [value, merge(1.0_DP, dice(1) - 0.5_DP * real(k, DP), width == 1 .and. dice(7) < 0.8_DP)]
      end do
    end do
    call sparse_from_triplets(n, m, row, column, value, relation, error)
    dense = dense_of(relation)
  end subroutine random_relation


  subroutine test_reduction(n, m)
    integer, intent(in) :: n, m
    type(sparse_type) :: k, c, a
    type(reduction_type) :: reduction
    type(error_type), allocatable :: error
    real(DP), allocatable :: dense_k(:, :), dense_c(:, :), expected(:, :)
    real(DP) :: largest
    integer :: round, i
    call random_symmetric(n, k, dense_k)
    call random_relation(n, m, c, dense_c)
    call analyse_reduction(k, c, reduction, a, error)
    call suite%that('reduction: no error', .not. allocated(error))
    call suite%that('reduction: diagonal first', all(a%column(a%first(:m)) == [(i, i=1, m)]))
    do round = 1, 3
      call reduce_matrix(reduction, k, c, a, error)
      call suite%that('reduction: values without error', .not. allocated(error))
      call suite%that('reduction: sorted', is_sorted(a))
      expected = matmul(transpose(dense_c), matmul(dense_k, dense_c))
      largest = maxval([1.0_DP, abs(expected)])
      if (m > 0) call suite%near('reduction: C''KC of the dense matrices', &
        maxval(abs(upper_part(expected) - dense_of(a))), 0.0_DP, 0.5_DP * epsilon(1.0_DP) * real(n + 2, DP) * largest)
      call random_number(k%value)            ! new values in the same patterns
      call random_number(c%value)
      if (round == 2) c%value(::3) = 0       ! places of zero entries stay
      dense_k = dense_of(full_from_upper(k))
      dense_c = dense_of(c)
    end do
  end subroutine test_reduction


  !> Unknowns without stiffness add nothing, not even to the pattern: the same product, from fewer entries.
  subroutine test_idle(n, m)
    integer, intent(in) :: n, m
    type(sparse_type) :: k, c, a, whole
    type(reduction_type) :: reduction
    type(error_type), allocatable :: error
    real(DP), allocatable :: dense_k(:, :), dense_c(:, :), expected(:, :)
    logical :: is_idle(n)
    integer :: i, p
    call random_symmetric(n, k, dense_k)
    call random_relation(n, m, c, dense_c)
    is_idle = [(mod(i, 3) == 0, i=1, n)]
    do i = 1, n
      do p = k%first(i), k%first(i + 1) - 1
        if (is_idle(i) .or. is_idle(k%column(p))) k%value(p) = 0
      end do
    end do
    dense_k = dense_of(full_from_upper(k))
    call analyse_reduction(k, c, reduction, whole, error)
    call analyse_reduction(k, c, reduction, a, error, is_idle)
    call suite%that('idle unknowns: fewer entries', size(a%column) < size(whole%column))
    call suite%that('idle unknowns: diagonal first', all(a%column(a%first(:m)) == [(i, i=1, m)]))
    call reduce_matrix(reduction, k, c, a, error)
    call suite%that('idle unknowns: no error', .not. allocated(error))
    expected = matmul(transpose(dense_c), matmul(dense_k, dense_c))
    call suite%near('idle unknowns: C''KC of the dense matrices', maxval(abs(upper_part(expected) - dense_of(a))), 0.0_DP, &
      0.5_DP * epsilon(1.0_DP) * real(n + 2, DP) * max(1.0_DP, maxval(abs(expected))))
  end subroutine test_idle


  !> The upper triangle of a matrix, 0 below.
  function upper_part(a) result(part)
    real(DP), intent(in) :: a(:, :)
    real(DP) :: part(size(a, 1), size(a, 2))
    integer :: j
    part = 0
    do j = 1, size(a, 2)
      part(:min(j, size(a, 1)), j) = a(:min(j, size(a, 1)), j)
    end do
  end function upper_part


  subroutine test_errors()
    type(sparse_type) :: a, c, r
    type(reduction_type) :: reduction
    type(error_type), allocatable :: error
    call sparse_from_triplets(3, 3, [1, 2, 3], [1, 2, 3], [1.0_DP, 1.0_DP, 1.0_DP], a, error)
    call sparse_from_triplets(2, 2, [1, 2], [1, 2], [1.0_DP, 1.0_DP], c, error)
    call analyse_reduction(a, c, reduction, r, error)
    call expect_error('matrix and relation of different sizes', error)
    call analyse_reduction(c, c, reduction, r, error)
    call reduce_matrix(reduction, a, c, r, error)
    call expect_error('a reduction of another pattern', error)
  end subroutine test_errors


  subroutine expect_error(what, error)
    character(*), intent(in) :: what
    type(error_type), allocatable, intent(in) :: error
    call suite%that('error reported: ' // what, allocated(error))
    if (allocated(error)) call suite%that('internal: ' // what, error%code == EXIT_INTERNAL)
  end subroutine expect_error

end program test_matrix_reduction
