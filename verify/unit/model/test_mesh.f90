!> Unit test of amontons_mesh: what follows from the kinds, and nodes that come later.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_mesh
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh, element_nodes, append_node, append_node_copies, mesh_extent, &
    find_connected_nodes
  use amontons_element_kinds, only: KIND_C3D4, KIND_CPS3, KIND_T3D2, KIND_SPRING1, KIND_MASS, MAX_ELEMENT_NODES
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_finalize()
  call check_append()
  call check_bodies()
  call suite%finish()

contains

  !> A tetrahedron, a triangle, a truss, a spring to the ground, a mass, and a node of its own.
  subroutine make(mesh)
    type(mesh_type), intent(out) :: mesh
    integer :: i
    mesh%n_nodes = 10
    mesh%n_elements = 5
    mesh%node_label = [(10 * i, i=1, 10)]
    mesh%coordinates = reshape([(real(modulo(i * i, 7), DP), i=1, 30)], [3, 10])
    mesh%kind = [KIND_C3D4, KIND_CPS3, KIND_T3D2, KIND_SPRING1, KIND_MASS]
    mesh%first = [1, 5, 8, 10, 11, 12]
    mesh%nodes = [1, 2, 3, 4, 5, 6, 7, 4, 6, 9, 8]
    allocate (mesh%directions(2, 5), source=0)
    mesh%directions(1, 4) = 3
    call finalize_mesh(mesh)
  end subroutine make


  !> Points, sections, and the displacements that nothing resists.
  subroutine check_finalize()
    type(mesh_type) :: mesh
    integer :: n, nodes(MAX_ELEMENT_NODES)
    call make(mesh)
    call suite%that('points', mesh%n_points == 3 .and. all(mesh%point_first == [1, 2, 3, 4, 4, 4]))
    call suite%that('sections are 1', all(mesh%section_value == 1))
    call suite%that('nodes with elements', all(mesh%has_elements(:9)) .and. .not. mesh%has_elements(10))
    call suite%that('a solid resists all', .not. any(mesh%is_unstiffened(:, 1:4)))
    call suite%that('the plane does not resist z', mesh%is_unstiffened(3, 7) .and. .not. any(mesh%is_unstiffened(:2, 7)))
    call suite%that('a truss there changes nothing', mesh%is_unstiffened(3, 6))
    call suite%that('a spring resists along itself', all(mesh%is_unstiffened(:, 9) .eqv. [.true., .true., .false.]))
    call suite%that('a mass resists nothing', all(mesh%is_unstiffened(:, 8)))
    call suite%that('a node without elements is no such node', .not. any(mesh%is_unstiffened(:, 10)))
    call element_nodes(mesh, 3, n, nodes)
    call suite%that('nodes of an element', n == 2 .and. all(nodes(:3) == [4, 6, 0]))
  end subroutine check_finalize


  !> New nodes get new labels and no elements; copies lie where their originals do.
  subroutine check_append()
    type(mesh_type) :: mesh
    real(DP) :: before
    integer :: node
    call make(mesh)
    before = mesh_extent(mesh)
    call suite%that('an extent', before > 1)
    call append_node(mesh, [100.0_DP, 0.0_DP, 0.0_DP], node)
    call suite%that('one more', node == 11 .and. mesh%n_nodes == 11 .and. mesh%node_label(11) == 101)
    call suite%that('without elements', .not. mesh%has_elements(11) .and. .not. any(mesh%is_unstiffened(:, 11)))
    call suite%that('the extent grows', mesh_extent(mesh) > 90)
    call append_node_copies(mesh, [7, 3])
    call suite%that('two copies', mesh%n_nodes == 13 .and. all(mesh%node_label(12:) == [102, 103]))
    call suite%near('in their places', norm2(mesh%coordinates(:, 12:13) - mesh%coordinates(:, [7, 3])), 0.0_DP, 0.0_DP)
    call suite%that('nothing resists as before', all(mesh%is_unstiffened(:, 12) .eqv. mesh%is_unstiffened(:, 7)))
    call suite%that('all arrays', size(mesh%is_auxiliary) == 13 .and. size(mesh%has_elements) == 13)
  end subroutine check_append


  !> Bodies: a chain of lines in any order; without its link; without an element; nodes without elements belong to none.
  subroutine check_bodies()
    type(mesh_type) :: mesh
    integer, allocatable :: body(:)
    integer :: n
    mesh%n_nodes = 10
    mesh%n_elements = 5
    mesh%first = [1, 3, 5, 7, 9, 10]
    mesh%nodes = [8, 9, 1, 2, 3, 4, 2, 4, 5]          ! lines 8-9, 1-2, 3-4; 2-4 joins the last two; a point at 5
    call find_connected_nodes(mesh, body, n)
    call suite%that('bodies in the order of elements', n == 3 .and. all(body == [2, 2, 2, 2, 3, 0, 0, 1, 1, 0]))
    call find_connected_nodes(mesh, body, n, [.false., .false., .false., .true., .false.])
    call suite%that('without the link', n == 4 .and. all(body == [2, 2, 3, 3, 4, 0, 0, 1, 1, 0]))
    call find_connected_nodes(mesh, body, n, [.true., .false., .false., .false., .true.])
    call suite%that('absent elements', n == 1 .and. all(body == [1, 1, 1, 1, 0, 0, 0, 0, 0, 0]))
    mesh%nodes(9) = 9
    call find_connected_nodes(mesh, body, n)
    call suite%that('a point belongs to the body at its node', n == 2 .and. all(body == [2, 2, 2, 2, 0, 0, 0, 1, 1, 0]))
  end subroutine check_bodies

end program test_mesh
