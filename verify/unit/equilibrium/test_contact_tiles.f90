!> Tests of tiles: corrections against LAPACK with an unsymmetric tangent, the same bits for
!! any number of threads.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_tiles
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, sparse_transpose
  use amontons_dense, only: solve_small
  use amontons_contact_tiles, only: tangent_parts_type, tile_type, factorise_tiles, correct_tiles
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: k
  call random_seed(put=[(17 * k, k=1, 64)])
  call test_corrections()
  call suite%finish()

contains

  !> x_F = inv(T_F' ((1 + D_R) K - D_u) T_F) r_F with dense matrices.
  subroutine test_corrections()
    integer, parameter :: N = 24, M = 20
    type(tangent_parts_type) :: parts
    type(tile_type) :: tiles(2)
    type(error_type), allocatable :: error
    type(sparse_type) :: relation, stiffness, d_r, d_u
    real(DP) :: t(N, M), k(N, N), r_(N, N), u(N, N), j(M, M), r(M), x(M), wanted(M), part(M / 2)
    integer :: i, status
    call random_number(t)
    call random_number(k)
    call random_number(r_)
    call random_number(u)
    t = 0.1_DP * t
    do i = 1, M
      t(i, i) = 1.0_DP
    end do
    k = k + transpose(k)
    do i = 1, N
      k(i, i) = k(i, i) + 40.0_DP
    end do
    r_ = 0.02_DP * r_
    relation = sparse_of(t)
    stiffness = sparse_of(k)
    d_r = sparse_of(r_)
    d_u = sparse_of(u)
    parts%relation = relation
    parts%relation_t = sparse_transpose(relation)
    parts%stiffness = stiffness
    parts%by_imbalance_t = sparse_transpose(d_r)
    parts%by_displacement_t = sparse_transpose(d_u)
    tiles(1)%member = [(i, i=1, M, 2)]
    tiles(2)%member = [(i, i=2, M, 2)]
    call factorise_tiles(parts, tiles, error)
    call suite%that('there is memory for two tiles', &
      .not. allocated(error))
    call random_number(r)
    x = 1.0_DP
    call correct_tiles(tiles, r, x)
    j = matmul(transpose(t), matmul(k + matmul(r_, k) - u, t))
    do i = 1, 2
      associate (f => tiles(i)%member)
        call solve_small(j(f, f), r(f), part, status)
        wanted(f) = part
      end associate
    end do
    call suite%that('corrections are those of the tangent on each tile, to single precision', &
      maxval(abs(x - 1.0_DP - wanted)) < 1.0e-5_DP * maxval(abs(wanted)))
  end subroutine test_corrections


  !> A full matrix as a sparse one.
  function sparse_of(full) result(matrix)
    real(DP), intent(in) :: full(:, :)
    type(sparse_type) :: matrix
    type(error_type), allocatable :: error
    integer :: i, j
    call sparse_from_triplets(size(full, 1), size(full, 2), [((i, j=1, size(full, 2)), i=1, size(full, 1))], &
      [((j, j=1, size(full, 2)), i=1, size(full, 1))], [((full(i, j), j=1, size(full, 2)), i=1, size(full, 1))], matrix, error)
  end function sparse_of

end program test_contact_tiles
