!> A mesh for output in which the layers of composite shells share no nodes, so that each has the stresses of its own material.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_layer_nodes
  use amontons_mesh, only: mesh_type
  implicit none
  private
  public :: separate_layers

contains

  !> Copies of the nodes that a layer shares with one below it, at the end of the mesh and with numbers above all others.
  !! The mesh is for output alone: sets and what follows from connections stay those of the original. Cost: linear.
  pure subroutine separate_layers(mesh, layered, origin)
    type(mesh_type), intent(in) :: mesh
    type(mesh_type), intent(out) :: layered
    integer, allocatable, intent(out) :: origin(:)   !< (n_nodes of layered) node of the mesh
    integer, allocatable :: copies(:)
    integer :: copy(mesh%n_nodes), layer_of(mesh%n_nodes), l, e, i, k, n
    allocate (copies(size(mesh%nodes)))
    layered = mesh
    layer_of = 0
    n = 0
    do l = 1, maxval(mesh%layer, dim=1)
      copy = 0
      do e = 1, mesh%n_elements
        if (mesh%layer(e) /= l) cycle
        do i = mesh%first(e), mesh%first(e + 1) - 1
          k = mesh%nodes(i)
          if (layer_of(k) == 0) layer_of(k) = l
          if (layer_of(k) == l) cycle
          if (copy(k) == 0) then
            n = n + 1
            copies(n) = k
            copy(k) = mesh%n_nodes + n
          end if
          layered%nodes(i) = copy(k)
        end do
      end do
    end do
    origin = [(i, i=1, mesh%n_nodes), copies(:n)]
    layered%n_nodes = size(origin)
    layered%coordinates = mesh%coordinates(:, origin)
    layered%node_label = [mesh%node_label, (maxval(mesh%node_label) + i, i=1, n)]
  end subroutine separate_layers

end module amontons_layer_nodes
