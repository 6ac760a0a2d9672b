!> Unit test of incomplete_cholesky: an exact factor without fill, the product on the pattern of A, and any number of threads.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_incomplete_cholesky
  use amontons_kinds, only: DP, SP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, alike_rows
  use amontons_incomplete_cholesky, only: incomplete_cholesky_type, factorise_incomplete, apply_incomplete, discard_incomplete
  use check, only: suite_type
!$ use omp_lib, only: omp_set_num_threads
  implicit none
  type(suite_type) :: suite
  integer :: i

  call test_chain()
  call test_product(plate(), [integer ::], 'one domain')
  call test_product(plate(), stripes(2), 'two domains')
  call test_product(plate(), stripes(5), 'five domains')
  call test_product(plate_of_threes(), [integer ::], 'rows alike, one domain')
  call test_product(plate_of_threes(), threefold(stripes(2)), 'rows alike, two domains')
  call test_product(plate_of_threes(), [(merge(1, 2, mod(i, 27) < 14), i=1, 216)], 'rows alike, of two domains')
  call test_threads()
  call test_shift()
  call suite%finish()

contains

  !> A chain of springs from the ground at unknown 1 by way of m and n to m + 1, and a force on its end. The unknowns up to m are
  !! one domain, n moves to the border: there is no fill, and each spring stretches by 1.
  subroutine test_chain()
    integer, parameter :: M = 20, N = 50
    type(incomplete_cholesky_type) :: factor
    type(sparse_type) :: a
    type(error_type), allocatable :: error
    real(DP) :: b(N), x(N), exact(N)
    logical :: is_broken
    integer :: i
    call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, M - 1), M, (i, i=M + 1, N - 1)], &
      [(i, i=1, N), (i + 1, i=1, M - 1), N, (i + 1, i=M + 1, N - 1)], [(merge(1.0_DP, 2.0_DP, i == M + 1), i=1, N), &
      (-1.0_DP, i=1, N - 1)], a, error)
    call factorise_incomplete(factor, a, [(merge(1, 2, i <= M), i=1, N)], is_broken)
    b = 0
    b(M + 1) = 1
    exact = [(real(merge(i, N + M + 1 - i, i <= M), DP), i=1, N)]
    call apply_incomplete(factor, a, b, x)
    call suite%that('chain: a factor', .not. is_broken)
    call suite%that('chain: a border of one unknown', factor%first_row(4) - factor%first_row(3) == 1)
    call suite%that('chain: the exact answer', maxval(abs(x - exact)) < real(N, DP)**3 / 3 * 1.2e-7_DP)
    call discard_incomplete(factor)
  end subroutine test_chain


  !> U'U is A on the pattern of A: that is what makes the factor the incomplete one. Its inverse is symmetric.
  subroutine test_product(a, domain, name)
    type(sparse_type), intent(in) :: a
    integer, intent(in) :: domain(:)
    character(*), intent(in) :: name
    type(incomplete_cholesky_type) :: factor
    type(sparse_type) :: pattern
    real(DP), allocatable :: u(:, :), product(:, :), x(:), y(:), mx(:), my(:)
    integer, allocatable :: unknown(:)
    real(DP) :: largest
    logical :: is_broken
    integer :: i, p, n
    n = a%n_rows
    call factorise_incomplete(factor, a, domain, is_broken)
    call suite%that(name // ': a factor', .not. is_broken)
    unknown = [(i, i=1, n)]
    pattern = a
    if (factor%n_domains > 1) then
      unknown = factor%unknown
      pattern = factor%pattern
    end if
    allocate (u(n, n), source=0.0_DP)
    do i = 1, n
      u(unknown(i), unknown(i)) = 1.0_DP / real(factor%value(pattern%first(i)), DP)
      do p = pattern%first(i) + 1, pattern%first(i + 1) - 1
        u(unknown(i), unknown(pattern%column(p))) = real(factor%value(p), DP)
      end do
    end do
    product = matmul(transpose(u), u)
    largest = 0
    do i = 1, n
      do p = a%first(i), a%first(i + 1) - 1
        largest = max(largest, abs(product(i, a%column(p)) - a%value(p)))
      end do
    end do
    call suite%that(name // ': U''U = A on its pattern', largest < 1.0e-6_DP * maxval(abs(a%value)))
    call suite%that(name // ': all entries serve', size(pattern%column) == size(a%column))
    x = [(sin(real(i, DP)), i=1, n)]
    y = [(cos(3.0_DP * real(i, DP)), i=1, n)]
    allocate (mx, my, mold=x)
    call apply_incomplete(factor, a, x, mx)
    call apply_incomplete(factor, a, y, my)
    call suite%that(name // ': symmetric', abs(dot_product(x, my) - dot_product(y, mx)) < 1.0e-12_DP * norm2(x) * norm2(my))
    mx = matmul(transpose(u), matmul(u, mx))
    call suite%that(name // ': its inverse', maxval(abs(mx - x)) < 1.0e-6_DP)
  end subroutine test_product


  !> The domains decide about the digits, not the threads.
  subroutine test_threads()
    type(incomplete_cholesky_type) :: one, two
    type(sparse_type) :: a
    real(DP), allocatable :: x(:), mx(:), again(:)
    logical :: is_broken
    integer :: i
    a = plate()
    x = [(sin(real(i, DP)), i=1, a%n_rows)]
    allocate (mx, again, mold=x)
!$  call omp_set_num_threads(1)
    call factorise_incomplete(one, a, stripes(2), is_broken)
    call apply_incomplete(one, a, x, mx)
!$  call omp_set_num_threads(2)
    call factorise_incomplete(two, a, stripes(2), is_broken)
    call apply_incomplete(two, a, x, again)
    call suite%that('two domains on one and two threads: the same digits', all(abs(mx - again) <= 0.0_DP) .and. &
      all(abs(one%value - two%value) <= 0.0_SP))
!$  call omp_set_num_threads(1)
  end subroutine test_threads


  !> An indefinite plate gets a shift, also with a border; one far from positive definite has no factor.
  subroutine test_shift()
    type(incomplete_cholesky_type) :: factor
    type(sparse_type) :: a
    logical :: is_broken
    a = plate()
    a%value(a%first(:a%n_rows)) = 2.5_DP
    call factorise_incomplete(factor, a, stripes(3), is_broken)
    call suite%that('indefinite: a shift', .not. is_broken .and. factor%shift > 0)
    a%value(a%first(:a%n_rows)) = -1.0_DP
    call factorise_incomplete(factor, a, stripes(3), is_broken)
    call suite%that('negative diagonal: broken', is_broken)
  end subroutine test_shift


  !> The same springs for three coupled unknowns at each point: rows are alike by threes.
  function plate_of_threes() result(a)
    type(sparse_type) :: a, one
    real(DP), parameter :: COUPLING(3, 3) = reshape([1.0_DP, 0.3_DP, 0.1_DP, 0.3_DP, 1.2_DP, 0.2_DP, 0.1_DP, 0.2_DP, 0.9_DP], &
      [3, 3])
    type(error_type), allocatable :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, k, p, q
    one = plate()
    allocate (row(0), column(0), value(0))
    do k = 1, one%n_rows
      do p = one%first(k), one%first(k + 1) - 1
        do i = 1, 3
          do q = merge(i, 1, one%column(p) == k), 3
            row = [row, 3 * k - 3 + i]
            column = [column, 3 * one%column(p) - 3 + q]
            value = [value, one%value(p) * COUPLING(i, q)]
          end do
        end do
      end do
    end do
    call sparse_from_triplets(3 * one%n_rows, 3 * one%n_rows, row, column, value, a, error)
    a%n_alike = alike_rows(a)
  end function plate_of_threes


  !> The number of each point for its three unknowns.
  pure function threefold(of_point) result(of_unknown)
    integer, intent(in) :: of_point(:)
    integer :: of_unknown(3 * size(of_point)), k
    of_unknown = [(of_point((k + 2) / 3), k=1, 3 * size(of_point))]
  end function threefold


  !> Springs on a grid of nine by eight unknowns, held along its edges.
  function plate() result(a)
    type(sparse_type) :: a
    integer, parameter :: NX = 9, NY = 8
    type(error_type), allocatable :: error
    integer :: row(3 * NX * NY), column(3 * NX * NY), k
    real(DP) :: value(3 * NX * NY)
    logical :: is_inside(3 * NX * NY)
    do k = 1, NX * NY
      row(3 * k - 2:3 * k) = k
      column(3 * k - 2:3 * k) = [k, k + 1, k + NX]
      value(3 * k - 2:3 * k) = [4.0_DP, -1.0_DP, -1.0_DP]
      is_inside(3 * k - 2:3 * k) = [.true., mod(k, NX) > 0, k <= NX * (NY - 1)]
    end do
    call sparse_from_triplets(NX * NY, NX * NY, pack(row, is_inside), pack(column, is_inside), pack(value, is_inside), a, error)
  end function plate


  !> Domains of the plate: stripes across its numbering, the higher ones first.
  pure function stripes(n_domains) result(domain)
    integer, intent(in) :: n_domains
    integer :: domain(72)
    integer :: i
    domain = [(n_domains - (n_domains * mod(i - 1, 9)) / 9, i=1, 72)]
  end function stripes

end program test_incomplete_cholesky
