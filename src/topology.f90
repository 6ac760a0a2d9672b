!> Topology: the element and facet kinds as tables: names, nodes, integration points, faces, VTK numbers.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Node and face numbering are those of Abaqus and CalculiX; VTK orders the nodes of all kinds here the same way.
module amontons_topology
  implicit none
  private
  public :: kind_type, facet_kind_type, element_kind, facet_kind, kind_of_name
  public :: KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, KIND_C3D10, KIND_C3D20, KIND_C3D20R, N_KINDS
  public :: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8
  public :: MAX_NODES, MAX_POINTS, MAX_FACE_NODES

  integer, parameter :: KIND_C3D4 = 1         !< linear tetrahedron, 1 point
  integer, parameter :: KIND_C3D6 = 2         !< linear wedge, 2 points
  integer, parameter :: KIND_C3D8 = 3         !< trilinear hexahedron, 8 points, mean dilatation
  integer, parameter :: KIND_C3D8_FULL = 4    !< trilinear hexahedron, 8 points, plain full integration (calculix dialect)
  integer, parameter :: KIND_C3D10 = 5        !< quadratic tetrahedron, 4 points
  integer, parameter :: KIND_C3D20 = 6        !< quadratic serendipity hexahedron, 27 points
  integer, parameter :: KIND_C3D20R = 7       !< the same, 8 points
  integer, parameter :: N_KINDS = 7

  integer, parameter :: FACET_TRI3 = 1, FACET_QUAD4 = 2, FACET_TRI6 = 3, FACET_QUAD8 = 4

  integer, parameter :: MAX_NODES = 20        !< most nodes of an element
  integer, parameter :: MAX_POINTS = 27       !< most integration points of an element
  integer, parameter :: MAX_FACE_NODES = 8    !< most nodes of a face

  !> One kind of element.
  type :: kind_type
    character(8) :: name = ''                 !< name in a deck
    integer :: n_nodes = 0
    integer :: n_points = 0                   !< integration points, ordered as CalculiX prints them (xi fastest)
    integer :: n_faces = 0
    integer :: vtk_type = 0
    logical :: is_mean_dilatation = .false.   !< B-bar, F-bar
    integer :: face_kind(6) = 0               !< FACET_... of faces S1 to S6
    integer :: face_nodes(MAX_FACE_NODES, 6) = 0   !< local nodes, outward by the right-hand rule: corners, then mid-sides
  end type kind_type

  !> One kind of face (a facet of a surface).
  type :: facet_kind_type
    integer :: n_nodes = 0
    integer :: n_corners = 0
  end type facet_kind_type

contains

  !> The table entry of an element kind.
  pure function element_kind(kind) result(entry)
    integer, intent(in) :: kind               !< KIND_...
    type(kind_type) :: entry
    select case (kind)
    case (KIND_C3D4)
      entry = tetrahedron('C3D4', 4, 1, 10)
    case (KIND_C3D10)
      entry = tetrahedron('C3D10', 10, 4, 24)
    case (KIND_C3D6)
      entry = wedge()
    case (KIND_C3D8)
      entry = hexahedron('C3D8', 8, 8, 12)
      entry%is_mean_dilatation = .true.
    case (KIND_C3D8_FULL)
      entry = hexahedron('C3D8', 8, 8, 12)
    case (KIND_C3D20)
      entry = hexahedron('C3D20', 20, 27, 25)
    case (KIND_C3D20R)
      entry = hexahedron('C3D20R', 20, 8, 25)
    end select
  end function element_kind


  !> The table entry of a facet kind.
  pure function facet_kind(kind) result(entry)
    integer, intent(in) :: kind               !< FACET_...
    type(facet_kind_type) :: entry
    integer, parameter :: NODES(4) = [3, 4, 6, 8], CORNERS(4) = [3, 4, 3, 4]
    entry%n_nodes = NODES(kind)
    entry%n_corners = CORNERS(kind)
  end function facet_kind


  !> The element kind of a name in upper case; 0 if there is none. C3D8 gives the mean-dilatation kind.
  pure function kind_of_name(name) result(kind)
    character(*), intent(in) :: name          !< e.g. 'C3D8'
    integer :: kind
    type(kind_type) :: entry
    do kind = 1, N_KINDS
      entry = element_kind(kind)
      if (entry%name == name) return
    end do
    kind = 0
  end function kind_of_name


  !> Entries of the tetrahedra.
  pure function tetrahedron(name, n_nodes, n_points, vtk_type) result(entry)
    character(*), intent(in) :: name
    integer, intent(in) :: n_nodes, n_points, vtk_type
    type(kind_type) :: entry
    entry = kind_type(name=name, n_nodes=n_nodes, n_points=n_points, n_faces=4, vtk_type=vtk_type)
    entry%face_kind(:4) = merge(FACET_TRI3, FACET_TRI6, n_nodes == 4)
    ! The manuals name the faces 1-2-3, 1-4-2, 2-4-3, 3-4-1, as seen from inside: here they are turned outward.
    entry%face_nodes(:3, :4) = reshape([1, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4], [3, 4])
    if (n_nodes == 10) entry%face_nodes(4:6, :4) = reshape([7, 6, 5, 5, 9, 8, 6, 10, 9, 7, 8, 10], [3, 4])
  end function tetrahedron


  !> Entry of the wedge.
  pure function wedge() result(entry)
    type(kind_type) :: entry
    entry = kind_type(name='C3D6', n_nodes=6, n_points=2, n_faces=5, vtk_type=13)
    entry%face_kind(:5) = [FACET_TRI3, FACET_TRI3, FACET_QUAD4, FACET_QUAD4, FACET_QUAD4]
    entry%face_nodes(:4, :5) = reshape([1, 3, 2, 0, 4, 5, 6, 0, 1, 2, 5, 4, 2, 3, 6, 5, 3, 1, 4, 6], [4, 5])
  end function wedge


  !> Entries of the hexahedra.
  pure function hexahedron(name, n_nodes, n_points, vtk_type) result(entry)
    character(*), intent(in) :: name
    integer, intent(in) :: n_nodes, n_points, vtk_type
    type(kind_type) :: entry
    entry = kind_type(name=name, n_nodes=n_nodes, n_points=n_points, n_faces=6, vtk_type=vtk_type)
    entry%face_kind(:6) = merge(FACET_QUAD4, FACET_QUAD8, n_nodes == 8)
    entry%face_nodes(:4, :6) = reshape([1, 4, 3, 2, 5, 6, 7, 8, 1, 2, 6, 5, 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8], [4, 6])
    if (n_nodes == 20) entry%face_nodes(5:8, :6) = reshape([12, 11, 10, 9, 13, 14, 15, 16, 9, 18, 13, 17, &
      10, 19, 14, 18, 11, 20, 15, 19, 12, 17, 16, 20], [4, 6])
  end function hexahedron

end module amontons_topology
