!> Unit test of assembly_plan: order of the elements, the pattern of K again after it was divided, products and diagonal.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_assembly_plan
  use amontons_assembly_plan, only: assembly_type, create_assembly, ensure_matrix, is_own_element, couple_nodes, &
    multiply_stiffness, complete_diagonal, node_diagonal, stiffness_diagonal, largest_stiffness, add_node_block
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_sparse, only: sparse_type, is_same_pattern
  use check, only: suite_type
  implicit none
  integer, parameter :: N_ELEMENTS = 900, N_NODES = 4 * N_ELEMENTS + 4
  real(DP), parameter :: BLOCK(3, 3) = reshape([4.0_DP, 1.0_DP, 0.0_DP, 1.0_DP, 5.0_DP, 2.0_DP, 0.0_DP, 2.0_DP, 6.0_DP], [3, 3])
  type(suite_type) :: suite
  type(mesh_type) :: mesh
  type(assembly_type) :: whole, deferred
  type(sparse_type) :: coupled
  type(error_type), allocatable :: error
  integer :: e, i
  logical :: is_met(N_ELEMENTS)
  real(DP) :: u(3 * N_NODES), w(3 * N_NODES)

  ! A column of hexahedra.
  mesh%n_nodes = N_NODES
  mesh%n_elements = N_ELEMENTS
  mesh%coordinates = reshape([([real([mod(i, 4) / 2, mod(mod(i, 4) + 1, 4) / 2, i / 4], DP)], i=0, N_NODES - 1)], [3, N_NODES])
  mesh%nodes = [([(4 * (e - 1) + i, i=1, 8)], e=1, N_ELEMENTS)]
  mesh%first = [(8 * e - 7, e=1, N_ELEMENTS + 1)]
  mesh%kind = spread(KIND_C3D8, 1, N_ELEMENTS)
  mesh%material = spread(1, 1, N_ELEMENTS)
  mesh%node_label = [(i, i=1, N_NODES)]
  mesh%element_label = [(e, e=1, N_ELEMENTS)]
  allocate (mesh%node_sets(0), mesh%element_sets(0))
  call finalize_mesh(mesh)

  call create_assembly(whole, mesh, error)
  call suite%that('created', .not. allocated(error))
  is_met = .false.
  is_met(whole%element_order) = .true.
  call suite%that('all elements once', all(is_met) .and. size(whole%element_order) == N_ELEMENTS)
  call suite%that('four parts', whole%n_parts == 4)
  call suite%that('of one rank', all([(is_own_element(whole, e), e=1, N_ELEMENTS)]))

  call create_assembly(deferred, mesh, error, is_deferred=.true.)
  call suite%that('deferred', .not. (allocated(error) .or. allocated(deferred%graph_first)))
  call ensure_matrix(deferred, mesh, is_divided=.true.)
  call suite%that('one rank has all', is_same_pattern(deferred%stiffness, whole%stiffness) .and. deferred%is_divided)
  call couple_nodes(mesh, coupled)
  call suite%that('nodes that elements couple', all(coupled%first == whole%graph_first) .and. &
    all(coupled%column == whole%graph_node))

  deferred%stiffness%value = 0
  call add_node_block(deferred, 7, 7, BLOCK)
  call add_node_block(deferred, 7, 9, BLOCK)
  call complete_diagonal(deferred)
  u = [(sin(real(i, DP)), i=1, size(u))]
  call multiply_stiffness(deferred, u, w)
  call suite%that('product', maxval(abs(w(19:21) - matmul(BLOCK, u(19:21) + u(25:27)))) <= 1.0e-14_DP .and. &
    maxval(abs(w(25:27) - matmul(BLOCK, u(19:21)))) <= 1.0e-14_DP .and. all(abs(w(:18)) <= 0.0_DP))
  call suite%that('diagonal', all(nint(node_diagonal(deferred, 7)) == [4, 5, 6]) .and. &
    all(abs(stiffness_diagonal(deferred) - [spread(0.0_DP, 1, 18), 4.0_DP, 5.0_DP, 6.0_DP, spread(0.0_DP, 1, 3 * N_NODES - 21)]) &
    <= 0.0_DP))
  call suite%that('largest entry', nint(largest_stiffness(deferred)) == 6)

  call ensure_matrix(deferred, mesh, is_divided=.false.)
  call suite%that('whole again', is_same_pattern(deferred%stiffness, whole%stiffness) .and. .not. deferred%is_divided .and. &
    all(abs(deferred%stiffness%value) <= 0.0_DP))
  call suite%finish()

end program test_assembly_plan
