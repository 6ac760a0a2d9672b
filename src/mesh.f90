!> Mesh: nodes, elements and named sets; what the user drew, frozen after reading.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_mesh
  use amontons_kinds, only: DP
  use amontons_topology, only: element_kind, kind_type, MAX_NODES
  implicit none
  private
  public :: mesh_type, set_type, finish_mesh, element_nodes

  !> A named list of nodes or elements.
  type :: set_type
    character(:), allocatable :: name        !< as the user wrote it
    integer, allocatable :: members(:)       !< indices into the mesh, not labels; order kept, no duplicates
  end type set_type

  !> Nodes and elements by index 1 to n; labels are the user's numbers.
  type :: mesh_type
    integer :: n_nodes = 0
    integer :: n_elements = 0
    integer :: n_points = 0                        !< integration points of all elements
    integer, allocatable :: node_label(:)          !< (n_nodes)
    real(DP), allocatable :: coordinates(:, :)     !< (3, n_nodes) reference coordinates X [length]
    integer, allocatable :: element_label(:)       !< (n_elements)
    integer, allocatable :: kind(:)                !< (n_elements) KIND_... of topology
    integer, allocatable :: first(:)               !< (n_elements + 1) start of an element's nodes in nodes(:)
    integer, allocatable :: nodes(:)               !< node indices of all elements, one after the other
    integer, allocatable :: point_first(:)         !< (n_elements + 1) start of an element's integration points
    integer, allocatable :: material(:)            !< (n_elements) index into model%materials; 0: no section
    type(set_type), allocatable :: node_sets(:)
    type(set_type), allocatable :: element_sets(:)
  end type mesh_type

contains

  !> Fills what follows from the kinds: first integration point of each element, and totals.
  subroutine finish_mesh(mesh)
    type(mesh_type), intent(inout) :: mesh   !< with n_elements and kind(:) set
    type(kind_type) :: entry
    integer :: e
    if (allocated(mesh%point_first)) deallocate (mesh%point_first)
    allocate (mesh%point_first(mesh%n_elements + 1))
    mesh%point_first(1) = 1
    do e = 1, mesh%n_elements
      entry = element_kind(mesh%kind(e))
      mesh%point_first(e + 1) = mesh%point_first(e) + entry%n_points
    end do
    mesh%n_points = mesh%point_first(mesh%n_elements + 1) - 1
  end subroutine finish_mesh


  !> The node indices of one element; the first n are set.
  pure subroutine element_nodes(mesh, e, n, nodes)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element index
    integer, intent(out) :: n                      !< number of its nodes
    integer, intent(out) :: nodes(MAX_NODES)       !< their indices
    n = mesh%first(e + 1) - mesh%first(e)
    nodes(:n) = mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)
    nodes(n + 1:) = 0
  end subroutine element_nodes

end module amontons_mesh
