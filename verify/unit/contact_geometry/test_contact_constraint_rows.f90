!> Unit test of amontons_contact_constraint_rows: weights of a facet, relative positions, forces and imbalances of rows.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_constraint_rows
  use amontons_contact_constraint_rows, only: contact_row_type, fill_facet_row, evaluate_facet_weights, &
    evaluate_relative_position, evaluate_row_imbalance, distribute_row_force
  use amontons_errors, only: error_type
  use amontons_facets, only: facets_type, build_facets
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_element_kinds, only: KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D20, FACET_TRI3, FACET_QUAD4, FACET_TRI6, &
    FACET_QUAD8, &
    MAX_FACE_NODES
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: kind
  do kind = FACET_TRI3, FACET_QUAD8
    call check_facet_row(kind)
  end do
  call check_imbalance()
  call suite%finish()

contains

  include 'sample_surfaces.inc'

  !> A node above a facet: its relative position is the gap vector, the weights add up to zero, forces balance.
  subroutine check_facet_row(kind)
    integer, intent(in) :: kind
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(contact_row_type) :: row
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP), allocatable :: force(:, :)
    real(DP) :: d(3), place(3), weights(MAX_FACE_NODES), d_weights(2, MAX_FACE_NODES), moved(MAX_FACE_NODES)
    real(DP), parameter :: LAMBDA(3) = [2.0_DP, -3.0_DP, 5.0_DP], STEP = 1.0e-6_DP, XI(2) = [0.3_DP, 0.2_DP]
    integer :: n, nodes(MAX_FACE_NODES), node
    call flat_grid(kind, 2, 1, mesh, element, face)
    call shake(mesh, 0.1_DP, 0.02_DP)
    call fold(mesh, 0.5_DP, 0.3_DP)
    call build_facets(mesh, element, face, facets, error)
    call suite%that('facets', .not. allocated(error))
    node = mesh%n_nodes                            ! the dummy node stands for a slave
    call evaluate_facet_weights(facets, 2, XI, n, nodes, weights, d_weights)
    place = matmul(mesh%coordinates(:, nodes(:n)), weights(:n))
    call suite%near('weights of a facet', sum(weights(:n)), 1.0_DP, 1.0e-14_DP)
    call evaluate_facet_weights(facets, 2, XI + [0.0_DP, STEP], n, nodes, moved, d_weights)
    call suite%near('slope', norm2((moved(:n) - weights(:n)) / STEP - d_weights(2, :n)), 0.0_DP, 1.0e-5_DP)
    call fill_facet_row(facets, 2, XI, node, row)
    call suite%that('the slave and the facet', size(row%nodes) == n + 1 .and. count(row%nodes == node) == 1)
    call suite%near('weights of a row', sum(row%weights), 0.0_DP, 1.0e-14_DP)
    mesh%coordinates(:, node) = place + [0.1_DP, 0.2_DP, 0.7_DP]
    d = evaluate_relative_position(row, mesh%coordinates)
    call suite%near('relative position', norm2(d - [0.1_DP, 0.2_DP, 0.7_DP]), 0.0_DP, 1.0e-14_DP)
    allocate (force(3, mesh%n_nodes), source=1.0_DP)
    call distribute_row_force(row, LAMBDA, force)
    call suite%near('at the slave', norm2(force(:, node) - 1 - LAMBDA), 0.0_DP, 1.0e-14_DP)
    call suite%near('action and reaction', norm2(sum(force - 1, 2)), 0.0_DP, 1.0e-13_DP)
    call suite%near('the moment about z', sum((force(2, nodes(:n)) - 1) * mesh%coordinates(1, nodes(:n)) &
      - (force(1, nodes(:n)) - 1) * mesh%coordinates(2, nodes(:n))), place(2) * LAMBDA(1) - place(1) * LAMBDA(2), 1.0e-13_DP)
    call suite%near('imbalance of the slave alone', norm2(evaluate_row_imbalance(row, mesh%coordinates) &
      - mesh%coordinates(:, node)), 0.0_DP, 0.0_DP)
  end subroutine check_facet_row


  !> A row with several slave nodes.
  subroutine check_imbalance()
    type(contact_row_type) :: row
    real(DP) :: R(3, 4)
    integer :: i
    row%nodes = [1, 2]
    row%weights = [1.0_DP, -1.0_DP]
    row%imbalance_nodes = [4, 2]
    row%imbalance_weights = [0.75_DP, 0.25_DP]
    R = reshape([(real(i, DP), i=1, 12)], [3, 4])
    call suite%near('sum of b R', norm2(evaluate_row_imbalance(row, R) - [8.5_DP, 9.5_DP, 10.5_DP]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_imbalance

end program test_contact_constraint_rows
