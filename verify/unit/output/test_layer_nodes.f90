!> Unit test of layer_nodes: which nodes are copied, their places and numbers.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_layer_nodes
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: KIND_C3D6
  use amontons_layer_nodes, only: separate_layers
  use amontons_mesh, only: mesh_type
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_stack()
  call suite%finish()

contains

  !> Two wedges side by side in the lower layer, two in the upper one, and a solid on a node of the interface.
  subroutine check_stack()
    type(mesh_type) :: mesh, layered
    integer, allocatable :: origin(:)
    integer :: i
    mesh%n_nodes = 14
    mesh%n_elements = 5
    mesh%node_label = [(10 * i, i=1, 14)]
    mesh%coordinates = reshape([(real(i, DP), i=1, 42)], [3, 14])
    mesh%layer = [1, 1, 2, 2, 1]
    mesh%kind = spread(KIND_C3D6, 1, 5)
    mesh%first = [1, 7, 13, 19, 25, 31]
    mesh%nodes = [1, 2, 3, 5, 6, 7, 1, 3, 4, 5, 7, 8, 5, 6, 7, 9, 10, 11, 5, 7, 8, 9, 11, 12, 13, 14, 1, 2, 3, 5]
    call separate_layers(mesh, layered, origin)
    call suite%that('copies', layered%n_nodes == 18)
    call suite%that('origin', all(origin == [(i, i=1, 14), 5, 6, 7, 8]))
    call suite%that('lower layer and solid', all(layered%nodes([(i, i=1, 12), (i, i=25, 30)]) == mesh%nodes([(i, i=1, 12), &
      (i, i=25, 30)])))
    call suite%that('upper layer', all(layered%nodes(13:24) == [15, 16, 17, 9, 10, 11, 15, 17, 18, 9, 11, 12]))
    call suite%that('numbers', all(layered%node_label(15:) == [141, 142, 143, 144]))
    call suite%near('places', maxval(abs(layered%coordinates(:, 15:) - mesh%coordinates(:, 5:8))), 0.0_DP, 0.0_DP)
  end subroutine check_stack

end program test_layer_nodes
