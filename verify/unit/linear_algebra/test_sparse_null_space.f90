!> Tests of the sparse null space: chains and nets of springs with known motions, and the dense way on the same matrix.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_sparse_null_space
  use amontons_kinds, only: DP
  use amontons_null_space, only: find_null_space
  use amontons_sparse_null_space, only: find_sparse_null_vectors
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_chain(suite)
  call check_nets(suite)
  call check_against_dense(suite)
  call check_no_rows(suite)
  call suite%finish()

contains

  !> Appends a spring of the stiffness 1/2 k**2 between two columns, or from one to the ground (b = 0).
  subroutine add_spring(a, b, k, first, column, value)
    integer, intent(in) :: a, b
    real(DP), intent(in) :: k
    integer, allocatable, intent(inout) :: first(:), column(:)
    real(DP), allocatable, intent(inout) :: value(:)
    column = [column, a]
    value = [value, k * sqrt(0.5_DP)]
    if (b > 0) then
      column = [column, b]
      value = [value, -k * sqrt(0.5_DP)]
    end if
    first = [first, size(column) + 1]
  end subroutine add_spring


  !> A chain in a mixed order: a free one has one motion, one that is held at an end has none. Its last pivot is 1/m.
  subroutine check_chain(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: M = 401
    integer, allocatable :: first(:), column(:)
    real(DP), allocatable :: value(:), vectors(:, :)
    integer :: n, i
    first = [1]
    allocate (column(0), value(0))
    do i = 1, M - 1                                ! 150 has no common factor with 401: a permutation
      call add_spring(1 + mod(150 * i, M), 1 + mod(150 * (i + 1), M), 1.0_DP, first, column, value)
    end do
    call find_sparse_null_vectors(first, column, value, M, 1.0e-10_DP, n, vectors)
    call suite%that('chain: a free one has a motion', n == 1)
    call suite%near('chain: it moves as a whole', maxval(abs(vectors(:, 1) / vectors(1, 1) - 1.0_DP)), 0.0_DP, 1.0e-10_DP)
    call add_spring(1 + mod(150 * 400, M), 0, 1.0_DP, first, column, value)
    call find_sparse_null_vectors(first, column, value, M, 1.0e-10_DP, n, vectors)
    call suite%that('chain: a held one has none', n == 0)
  end subroutine check_chain


  !> Two nets of 20 x 20 places: each moves as a whole. A spring that is too weak does not change
  !! that, one that counts does.
  subroutine check_nets(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: L = 20
    integer, allocatable :: first(:), column(:)
    real(DP), allocatable :: value(:), vectors(:, :)
    integer :: n, i, j, net, here
    first = [1]
    allocate (column(0), value(0))
    do net = 0, 1
      do j = 1, L
        do i = 1, L
          here = net * L**2 + (j - 1) * L + i
          if (i < L) call add_spring(here, here + 1, 0.7_DP, first, column, value)
          if (j < L) call add_spring(here, here + L, 0.7_DP, first, column, value)
        end do
      end do
    end do
    call add_spring(L**2, 2 * L**2, 1.0e-6_DP, first, column, value)
    call find_sparse_null_vectors(first, column, value, 2 * L**2, 1.0e-10_DP, n, vectors)
    call suite%that('nets: each has a motion', n == 2)
    do i = 1, n
      call suite%near('nets: the first as a whole', maxval(vectors(:L**2, i)) - minval(vectors(:L**2, i)), 0.0_DP, 1.0e-9_DP)
      call suite%near('nets: the second as a whole', maxval(vectors(L**2 + 1:, i)) - minval(vectors(L**2 + 1:, i)), 0.0_DP, &
        1.0e-9_DP)
    end do
    call add_spring(L**2, 2 * L**2, 0.1_DP, first, column, value)
    call find_sparse_null_vectors(first, column, value, 2 * L**2, 1.0e-10_DP, n, vectors)
    call suite%that('nets: joined they have one', n == 1)
    call suite%near('nets: they move together', maxval(vectors(:, 1)) - minval(vectors(:, 1)), 0.0_DP, 1.0e-9_DP)
  end subroutine check_nets


  !> Rows of four entries at mixed places, fewer than columns: as many vectors as the eigenvalues of the dense Gram matrix say, each
  !! of which the matrix maps to zero.
  subroutine check_against_dense(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: M = 240, N_ROWS = 225
    integer :: first(N_ROWS + 1), column(4 * N_ROWS), n, n_dense, r, i
    real(DP) :: value(4 * N_ROWS), a(N_ROWS, M), scale(M)
    real(DP), allocatable :: vectors(:, :), eigenvectors(:, :)
    a = 0.0_DP
    do r = 1, N_ROWS + 1
      first(r) = 4 * r - 3
    end do
    do r = 1, N_ROWS
      do i = 0, 3
        column(first(r) + i) = 1 + mod(7 * r + 53 * i + i * mod(r, 5), M)
        value(first(r) + i) = sin(real(11 * r + 5 * i, DP))
        a(r, column(first(r) + i)) = value(first(r) + i)
      end do
    end do
    scale = [(norm2(a(:, i)), i=1, M)]
    scale = merge(1.0_DP / scale, 1.0_DP, scale > 0.0_DP)
    value = value * scale(column)
    do i = 1, M
      a(:, i) = a(:, i) * scale(i)
    end do
    allocate (eigenvectors(M, M))
    call find_null_space(matmul(transpose(a), a), 1.0e-10_DP, n_dense, eigenvectors)
    call find_sparse_null_vectors(first, column, value, M, 1.0e-10_DP, n, vectors)
    call suite%that('mixed rows: as many vectors as by eigenvalues', n == n_dense .and. n >= M - N_ROWS)
    do i = 1, n
      vectors(:, i) = vectors(:, i) / norm2(vectors(:, i))
    end do
    call suite%near('mixed rows: mapped to zero', maxval(abs(matmul(a, vectors))), 0.0_DP, 1.0e-8_DP)
    eigenvectors(:n, :n) = matmul(transpose(vectors), matmul(eigenvectors(:, :n), matmul(transpose(eigenvectors(:, :n)), vectors)))
    call suite%near('mixed rows: in the space of the eigenvectors', maxval(abs([(eigenvectors(i, i), i=1, n)] - 1.0_DP)), 0.0_DP, &
      1.0e-8_DP)
  end subroutine check_against_dense


  !> Without rows every unit vector is a motion.
  subroutine check_no_rows(suite)
    type(suite_type), intent(inout) :: suite
    real(DP), allocatable :: vectors(:, :)
    integer :: n
    call find_sparse_null_vectors([1], [integer ::], [real(DP) ::], 3, 1.0e-10_DP, n, vectors)
    call suite%that('no rows: all vectors', n == 3)
    call suite%near('no rows: the unit vectors', sum(abs(vectors)), 3.0_DP, 0.0_DP)
  end subroutine check_no_rows

end program test_sparse_null_space
