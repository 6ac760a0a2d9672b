!> Unit test of contact_coarse_space: two chains with springs between them and one oblique contact row, against dense matrices.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_coarse_space
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, sparse_sum
  use amontons_factorization, only: FACTOR_OK
  use amontons_dense, only: solve_small
  use amontons_constraints, only: constraints_type, reset_constraints, prescribe_unknown, &
    eliminate_constraints
  use amontons_reduced_system, only: reduced_system_type, factorise_reduced_system
  use amontons_contact_coarse_space, only: coarse_space_type, coarse_rows_type, build_coarse_space, update_coarse_space, &
    apply_coarse_correction
  use check, only: suite_type
  use samples, only: dense_of, add_oblique_row, make_chain_mesh
  implicit none
  integer, parameter :: N_NODES = 12, HALF = 6, N = 3 * N_NODES, SLAVE = 9, MASTER = 3, N_PATCHES = 2
  real(DP), parameter :: MU = 0.3_DP
  type(suite_type) :: suite
  type(sparse_type), target :: K, D_R, D_u, rows, directions
  type(sparse_type) :: S
  type(constraints_type), target :: base, whole
  type(mesh_type) :: mesh
  integer, allocatable, target :: unknown_of(:)
  logical :: is_slave(N_NODES)
  call make_chains()
  call make_rows()
  call check_correction()
  call check_none()
  call suite%finish()

contains

  !> Chains of the nodes 1 to 6 and 7 to 12 with springs between node i and i + 6. Each chain has one fixed unknown.
  subroutine make_chains()
    type(error_type), allocatable :: error
    integer :: i
    call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, N - 3)], [(i, i=1, N), (i + 3, i=1, N - 3)], &
      [(5.0_DP + 0.1_DP * real(mod(i, 4), DP), i=1, N), (merge(0.0_DP, -2.0_DP, (i + 2) / 3 == HALF), i=1, N - 3)], K, error)
    call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, N / 2)], [(i, i=1, N), (i + N / 2, i=1, N / 2)], &
      [(3.0_DP, i=1, N), (-3.0_DP, i=1, N / 2)], S, error)
    call fix_unknowns(base)
    call eliminate_constraints(base)
    call fix_unknowns(whole)
    call add_oblique_row(SLAVE, MASTER, MU, whole, D_R, D_u)
    call make_chain_mesh([(real(i, DP) + 0.3_DP * real(mod(i, 5), DP), i=1, N)], mesh)
    is_slave = [(i > HALF, i=1, N_NODES)]
  end subroutine make_chains


  !> Fixes one unknown of a master node and one of a slave node.
  subroutine fix_unknowns(constraints)
    type(constraints_type), intent(inout) :: constraints
    call reset_constraints(constraints, N)
    call prescribe_unknown(constraints, 2, 0.0_DP)
    call prescribe_unknown(constraints, N, 0.0_DP)
  end subroutine fix_unknowns


  !> A = e_p - T_p of the unknown p that contact makes dependent, and D' = a'/(a a').
  subroutine make_rows()
    type(error_type), allocatable :: error
    real(DP) :: T(N, whole%n_free), A(N), own(3)
    integer :: p, i
    allocate (unknown_of(whole%n_free))
    do i = 1, N
      if (whole%free_of(i) > 0) unknown_of(whole%free_of(i)) = i
    end do
    p = findloc(base%owner == 0 .and. whole%owner > 0, .true., dim=1)
    T = dense_of(whole%transformation)
    A = 0.0_DP
    A(unknown_of) = -T(p, :)
    A(p) = A(p) + 1.0_DP
    own = A(3 * SLAVE - 2:3 * SLAVE)
    call sparse_from_triplets(1, N, [(1, i=1, N)], [(i, i=1, N)], A, rows, error)
    call sparse_from_triplets(1, N, [1, 1, 1], [3 * SLAVE - 2, 3 * SLAVE - 1, 3 * SLAVE], own / dot_product(own, own), directions, &
      error)
  end subroutine make_rows


  !> J = T' ((1 + D_R E) K - D_u) T: the condensation E leaves out the reactions of fixed unknowns.
  pure function tangent() result(J)
    real(DP) :: J(whole%n_free, whole%n_free), T(N, whole%n_free), stiffness(N, N), condensed(N, N)
    integer :: i
    T = dense_of(whole%transformation)
    stiffness = dense_of(K, is_symmetric=.true.)
    condensed = stiffness
    do i = 1, N
      if (base%free_of(i) == 0) condensed(i, :) = 0.0_DP
    end do
    J = matmul(transpose(T), matmul(stiffness + matmul(dense_of(D_R), condensed) - dense_of(D_u), T))
  end function tangent


  !> R Pi g: Pi moves the slave node onto the row.
  pure function projected(g) result(x)
    real(DP), intent(in) :: g(N)
    real(DP) :: x(whole%n_free), moved(N), A(1, N), D(1, N)
    A = dense_of(rows)
    D = dense_of(directions)
    moved = g - D(1, :) * dot_product(A(1, :), g)
    x = moved(unknown_of)
  end function projected


  !> The displacements W = inv(K + S) S e for each slave node and axis, of which the patches take sums.
  function displacements() result(w)
    real(DP) :: w(N, N / 2), matrix(N, N), loads(N, N / 2)
    integer :: i, status
    loads = 0.0_DP
    do i = 1, N / 2
      loads(N / 2 + i, i) = 1.0_DP
    end do
    matrix = dense_of(S, is_symmetric=.true.)
    loads = matmul(matrix, loads)
    matrix = matrix + dense_of(K, is_symmetric=.true.)
    do i = 1, N
      if (base%free_of(i) > 0) cycle
      matrix(i, :) = 0.0_DP
      matrix(:, i) = 0.0_DP
      matrix(i, i) = 1.0_DP
      loads(i, :) = 0.0_DP
    end do
    call solve_small(matrix, loads, w, status)
  end function displacements


  !> g lies in the span of W; d is what J R Pi g leaves, and is orthogonal to R Pi W.
  subroutine check_correction()
    type(coarse_space_type) :: space
    type(reduced_system_type) :: robin
    type(error_type), allocatable :: error
    real(DP) :: d(whole%n_free), before(whole%n_free), g(N), w(N, N / 2), sums(N, 6)
    integer :: i, status, axis
    logical :: is_corrected
    call factorise_reduced_system(robin, sparse_sum(K, 1.0_DP, S), .true., base, mesh, status, error)
    call suite%that('factor', status == FACTOR_OK .and. .not. allocated(error))
    call build_coarse_space(space, robin, S, base, mesh%coordinates, is_slave, N_PATCHES)
    call suite%that('two patches', space%n == 6)
    call update_coarse_space(space, coarse_rows_type(K, rows, directions, D_R, D_u, whole%transformation, base%free_of, unknown_of))
    before = [(sin(real(i * i, DP)), i=1, whole%n_free)]
    d = before
    call apply_coarse_correction(space, d, g, is_corrected)
    call suite%that('a correction', is_corrected .and. maxval(abs(d - before)) > 0.1_DP)
    call suite%near('d = d - J R Pi g', maxval(abs(before - matmul(tangent(), projected(g)) - d)), 0.0_DP, 1.0e-5_DP)
    w = displacements()
    do axis = 1, 3                                 ! the nodes are in line: the patches are 7 to 9 and 10 to 12
      sums(:, axis) = w(:, axis) + w(:, 3 + axis) + w(:, 6 + axis)
      sums(:, 3 + axis) = w(:, 9 + axis) + w(:, 12 + axis) + w(:, 15 + axis)
    end do
    call suite%near('orthogonal', maxval([(abs(dot_product(projected(sums(:, i)), d)), i=1, 6)]), 0.0_DP, 1.0e-5_DP)
    d = 0.0_DP
    call apply_coarse_correction(space, d, g, is_corrected)
    call suite%that('no residual, no correction', .not. is_corrected .and. all(abs(g) <= 0.0_DP))
  end subroutine check_correction


  !> With as many patches as nodes there is no coarse space, and nothing is corrected.
  subroutine check_none()
    type(coarse_space_type) :: space
    type(reduced_system_type) :: robin
    type(error_type), allocatable :: error
    real(DP) :: d(whole%n_free), g(N)
    integer :: status
    logical :: is_corrected
    call factorise_reduced_system(robin, sparse_sum(K, 1.0_DP, S), .true., base, mesh, status, error)
    call build_coarse_space(space, robin, S, base, mesh%coordinates, is_slave, HALF)
    call update_coarse_space(space, coarse_rows_type(K, rows, directions, D_R, D_u, whole%transformation, base%free_of, unknown_of))
    d = 1.0_DP
    call apply_coarse_correction(space, d, g, is_corrected)
    call suite%that('no coarse space', space%n == 0 .and. .not. is_corrected .and. all(abs(d - 1.0_DP) <= 0.0_DP))
  end subroutine check_none

end program test_contact_coarse_space
