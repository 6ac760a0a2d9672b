!> Element and facet kinds: nodes, integration points, faces, VTK types.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Node and face numbering follow Abaqus and CalculiX; VTK uses the same node order for all kinds here.
module amontons_element_kinds
  implicit none
  private
  public :: element_kind_type, facet_kind_type, element_kind, kind_family, facet_kind, is_of_revolution, face_index, &
    element_kind_by_name, has_midsides
  public :: KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, KIND_C3D10, KIND_C3D20, KIND_C3D20R
  public :: KIND_C3D8I, KIND_C3D8R, KIND_C3D15, KIND_C3D15_LAYER, KIND_CSS8, KIND_CSS6
  public :: KIND_BEAM_RECT, KIND_BEAM_PIPE, KIND_BEAM_BOX, KIND_BEAM_CIRC, KIND_BEAM_KRONROD
  public :: KIND_CPS3, KIND_CPS4, KIND_CPS4R, KIND_CPS6, KIND_CPS8, KIND_CPS8R
  public :: KIND_CPE3, KIND_CPE4, KIND_CPE4_FULL, KIND_CPE4R, KIND_CPE6, KIND_CPE8, KIND_CPE8R
  public :: KIND_CAX3, KIND_CAX4, KIND_CAX4_FULL, KIND_CAX4R, KIND_CAX6, KIND_CAX8, KIND_CAX8R, KIND_CAX_SHELL
  public :: KIND_CPS4I, KIND_CPE4I, KIND_CAX4I
  public :: KIND_T3D2, KIND_T3D3, KIND_SPRINGA, KIND_SPRING1, KIND_SPRING2, KIND_GAPUNI, KIND_MASS, KIND_R2D2, KIND_RAX2, KIND_USER
  public :: KIND_S3, KIND_S4, KIND_S4R, KIND_S6, KIND_S8, KIND_S8R, KIND_M3D3, KIND_M3D6, KIND_M3D8R, &
    KIND_B31, KIND_B31R, KIND_B32, KIND_B32R, KIND_SAX1, KIND_SAX2
  public :: KIND_COH2D4, KIND_COHAX4, KIND_COH3D6, KIND_COH3D8
  public :: N_KINDS, N_DECK_KINDS, N_SOLID_KINDS
  public :: FAMILY_SOLID, FAMILY_PLANE_STRESS, FAMILY_PLANE_STRAIN, FAMILY_AXISYMMETRIC, FAMILY_TRUSS, FAMILY_SPRING, &
    FAMILY_MASS, FAMILY_SHELL, FAMILY_MEMBRANE, FAMILY_BEAM, FAMILY_RIGID, FAMILY_USER, FAMILY_COHESIVE, is_structural_family, &
    has_faces_in_space, is_membrane, is_two_sided, is_one_point, has_modes, is_cohesive, opposite_node
  public :: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, FACET_LINE2, FACET_LINE3
  public :: MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, MAX_ELEMENT_AMPLITUDES, MAX_FACE_NODES, N_CIRCLE_SECTORS

  integer, parameter :: KIND_C3D4 = 1         !< linear tetrahedron, 1 point
  integer, parameter :: KIND_C3D6 = 2         !< linear wedge, 2 points
  integer, parameter :: KIND_C3D8 = 3         !< trilinear hexahedron, 8 points, mean dilatation
  integer, parameter :: KIND_C3D8_FULL = 4    !< trilinear hexahedron, 8 points, plain full integration (calculix dialect)
  integer, parameter :: KIND_C3D10 = 5        !< quadratic tetrahedron, 4 points
  integer, parameter :: KIND_C3D20 = 6        !< quadratic serendipity hexahedron, 27 points
  integer, parameter :: KIND_C3D20R = 7       !< the same, 8 points
  integer, parameter :: KIND_C3D8I = 8        !< trilinear hexahedron, 8 points, nine incompatible modes
  integer, parameter :: KIND_C3D8R = 9        !< trilinear hexahedron, 1 point, hourglass stiffness
  integer, parameter :: KIND_C3D15 = 10       !< quadratic wedge, 9 points
  integer, parameter :: KIND_CSS8 = 11        !< solid-shell hexahedron: assumed strains, 2x2 points at five heights
  integer, parameter :: KIND_CSS6 = 12        !< solid-shell wedge: the same, three points at five heights
  integer, parameter :: KIND_BEAM_RECT = 13    !< 20 nodes around a beam, two places of points along it: 3x3 over the rectangle
  integer, parameter :: KIND_BEAM_PIPE = 14    !< ... 8 on a circle
  integer, parameter :: KIND_BEAM_BOX = 15     !< ... 3 on each of four walls
  integer, parameter :: KIND_BEAM_CIRC = 16    !< ... 4 and 8 on two circles
  integer, parameter :: KIND_BEAM_KRONROD = 17   !< ... 5x5 over a rectangle or a circle of curved sides (calculix dialect)
  integer, parameter :: KIND_C3D15_LAYER = 18   !< quadratic wedge, 6 points: a layer of a composite S6 (calculix dialect)
  integer, parameter :: N_SOLID_KINDS = 18    !< the kinds up to here are three-dimensional solids
  integer, parameter :: KIND_CPS3 = 19        !< plane stress: triangle, 1 point
  integer, parameter :: KIND_CPS4 = 20        !< quadrilateral, 4 points
  integer, parameter :: KIND_CPS4R = 21       !< quadrilateral, 1 point, hourglass stiffness
  integer, parameter :: KIND_CPS6 = 22        !< quadratic triangle, 3 points
  integer, parameter :: KIND_CPS8 = 23        !< quadratic quadrilateral, 9 points
  integer, parameter :: KIND_CPS8R = 24       !< the same, 4 points
  integer, parameter :: KIND_CPE3 = 25        !< plane strain: the same six shapes ...
  integer, parameter :: KIND_CPE4 = 26        !< ... with mean dilatation
  integer, parameter :: KIND_CPE4_FULL = 27   !< ... without (calculix dialect)
  integer, parameter :: KIND_CPE4R = 28
  integer, parameter :: KIND_CPE6 = 29
  integer, parameter :: KIND_CPE8 = 30
  integer, parameter :: KIND_CPE8R = 31
  integer, parameter :: KIND_CAX3 = 32        !< axisymmetric about y, x is the radius: the same
  integer, parameter :: KIND_CAX4 = 33        !< ... with mean dilatation
  integer, parameter :: KIND_CAX4_FULL = 34   !< ... without (calculix dialect)
  integer, parameter :: KIND_CAX4R = 35
  integer, parameter :: KIND_CAX6 = 36
  integer, parameter :: KIND_CAX8 = 37
  integer, parameter :: KIND_CAX8R = 38
  integer, parameter :: KIND_CPS4I = 39       !< quadrilaterals, 4 points, incompatible modes: plane stress, four
  integer, parameter :: KIND_CPE4I = 40       !< ... plane strain, four
  integer, parameter :: KIND_CAX4I = 41       !< ... axisymmetric, four and one of the hoop strain
  integer, parameter :: KIND_CAX_SHELL = 42   !< of a shell: two places along it, five heights
  integer, parameter :: KIND_M3D3 = 43        !< membranes in space: triangle, 1 point
  integer, parameter :: KIND_M3D6 = 46        !< 44: M3D4, 45: M3D4R, both with 4 points; 46: quadratic triangle, 3 points
  integer, parameter :: KIND_M3D8R = 48       !< 47: M3D8, 9 points; 48: the same, 4 points
  integer, parameter :: KIND_T3D2 = 49        !< straight truss, 1 point
  integer, parameter :: KIND_T3D3 = 50        !< curved truss, 2 points; here the nodes are the ends, then the middle
  integer, parameter :: KIND_SPRINGA = 51     !< spring along the line between two nodes
  integer, parameter :: KIND_SPRING1 = 52     !< spring between a node and the ground, in one direction
  integer, parameter :: KIND_SPRING2 = 53     !< spring between two nodes, in one direction of each
  integer, parameter :: KIND_GAPUNI = 54      !< gap between two nodes, in one direction
  integer, parameter :: KIND_MASS = 55        !< point mass
  integer, parameter :: KIND_R2D2 = 56        !< rigid edge in the plane: a face on both sides, no stiffness
  integer, parameter :: KIND_RAX2 = 57        !< the same of a body of revolution
  integer, parameter :: KIND_USER = 58        !< of *USER ELEMENT: its nodes are those of the deck, its stiffness is UEL's
  integer, parameter :: KIND_COH2D4 = 59      !< cohesive elements: two edges in the plane that face each other
  integer, parameter :: KIND_COHAX4 = 60      !< the same of a body of revolution
  integer, parameter :: KIND_COH3D6 = 61      !< two triangles in space
  integer, parameter :: KIND_COH3D8 = 62      !< two quadrilaterals
  integer, parameter :: N_KINDS = 62
  ! Kinds of a deck only: the reader expands them into solids (folder expansion).
  integer, parameter :: KIND_S3 = 63          !< shells
  integer, parameter :: KIND_S4 = 64
  integer, parameter :: KIND_S4R = 65
  integer, parameter :: KIND_S6 = 66
  integer, parameter :: KIND_S8 = 67
  integer, parameter :: KIND_S8R = 68
  integer, parameter :: KIND_B31 = 69         !< beams
  integer, parameter :: KIND_B31R = 70
  integer, parameter :: KIND_B32 = 71         !< end, middle, end
  integer, parameter :: KIND_B32R = 72
  integer, parameter :: KIND_SAX1 = 73        !< axisymmetric shells
  integer, parameter :: KIND_SAX2 = 74        !< end, middle, end
  integer, parameter :: N_DECK_KINDS = 74
  integer, parameter :: N_CIRCLE_SECTORS = 180   !< of two degrees in the circle of CalculiX's axisymmetric elements

  ! Families: in which displacements an element has stiffness.
  integer, parameter :: FAMILY_SOLID = 1, FAMILY_PLANE_STRESS = 2, FAMILY_PLANE_STRAIN = 3, FAMILY_AXISYMMETRIC = 4, &
    FAMILY_MEMBRANE = 5, FAMILY_TRUSS = 6, FAMILY_SPRING = 7, FAMILY_MASS = 8, FAMILY_SHELL = 9, FAMILY_BEAM = 10, &
    FAMILY_RIGID = 11, FAMILY_USER = 12, FAMILY_COHESIVE = 13

  ! Edges are the facets of plane and axisymmetric elements.
  integer, parameter :: FACET_TRI3 = 1, FACET_QUAD4 = 2, FACET_TRI6 = 3, FACET_QUAD8 = 4, FACET_LINE2 = 5, &
    FACET_LINE3 = 6

  integer, parameter :: MODES_SHAPE = 7               !< of plane_kind: incompatible modes
  character(3), parameter :: PLANE_PREFIX(KIND_CPS4I:KIND_CAX4I) = ['CPS', 'CPE', 'CAX']
  integer, parameter :: MAX_ELEMENT_NODES = 20        !< most nodes of an element
  integer, parameter :: MAX_ELEMENT_POINTS = 50       !< most integration points of an element
  integer, parameter :: MAX_ELEMENT_AMPLITUDES = 27   !< most numbers that an element keeps beside the history of its points
  integer, parameter :: MAX_FACE_NODES = 8    !< most nodes of a face

  !> One kind of element.
  type :: element_kind_type
    character(8) :: name = ''                 !< name in a deck
    integer :: family = FAMILY_SOLID          !< FAMILY_...
    integer :: n_nodes = 0
    integer :: n_points = 0                   !< integration points, ordered as CalculiX prints them (xi fastest)
    integer :: n_faces = 0
    integer :: vtk_type = 0
    logical :: is_mean_dilatation = .false.   !< B-bar, F-bar
    integer :: face_kind(6) = 0               !< FACET_... of faces S1 to S6
    integer :: face_nodes(MAX_FACE_NODES, 6) = 0   !< local nodes, outward by the right-hand rule: corners, then mid-sides
  end type element_kind_type

  !> One kind of face (a facet of a surface).
  type :: facet_kind_type
    integer :: n_nodes = 0
    integer :: n_corners = 0
  end type facet_kind_type

contains

  !> The kinds of one point whose hourglass modes have a stiffness of their own.
  elemental logical function is_one_point(kind)
    integer, intent(in) :: kind
    is_one_point = kind == KIND_C3D8R .or. kind == KIND_CPS4R .or. kind == KIND_CPE4R .or. kind == KIND_CAX4R
  end function is_one_point


  !> The kinds of incompatible modes, whose amplitudes an element eliminates.
  elemental logical function has_modes(kind)
    integer, intent(in) :: kind               !< KIND_...
    has_modes = kind == KIND_C3D8I .or. (kind >= KIND_CPS4I .and. kind <= KIND_CAX4I)
  end function has_modes


  !> The family of an element kind. Solids are found without the table: the reader needs it of each element several times.
  pure integer function kind_family(kind) result(family)
    integer, intent(in) :: kind               !< KIND_...
    type(element_kind_type) :: entry
    family = FAMILY_SOLID
    if (kind <= N_SOLID_KINDS) return
    entry = element_kind(kind)
    family = entry%family
  end function kind_family


  !> The table entry of an element kind.
  pure function element_kind(kind) result(entry)
    integer, intent(in) :: kind               !< KIND_...
    type(element_kind_type) :: entry
    select case (kind)
    case (KIND_C3D4)
      entry = tetrahedron_kind('C3D4', 4, 1, 10)
    case (KIND_C3D10)
      entry = tetrahedron_kind('C3D10', 10, 4, 24)
    case (KIND_C3D6)
      entry = wedge_kind('C3D6', 6, 2, 13)
    case (KIND_C3D15)
      entry = wedge_kind('C3D15', 15, 9, 26)
    case (KIND_C3D15_LAYER)
      entry = wedge_kind('layWedge', 15, 6, 26)   ! no deck can name it
    case (KIND_C3D8, KIND_C3D8_FULL)
      entry = hexahedron_kind('C3D8', 8, 8, 12)
      entry%is_mean_dilatation = kind == KIND_C3D8
    case (KIND_C3D20)
      entry = hexahedron_kind('C3D20', 20, 27, 25)
    case (KIND_C3D20R)
      entry = hexahedron_kind('C3D20R', 20, 8, 25)
    case (KIND_C3D8I)
      entry = hexahedron_kind('C3D8I', 8, 8, 12)
    case (KIND_C3D8R)
      entry = hexahedron_kind('C3D8R', 8, 1, 12)
    case (KIND_CSS8)
      entry = hexahedron_kind('CSS8', 8, 20, 12)
    case (KIND_CSS6)
      entry = wedge_kind('CSS6', 6, 15, 13)
    case (KIND_BEAM_RECT)                     ! no deck can name them: its words are in upper case
      entry = hexahedron_kind('rectBeam', 20, 18, 25)
    case (KIND_BEAM_PIPE)
      entry = hexahedron_kind('pipeBeam', 20, 16, 25)
    case (KIND_BEAM_BOX)
      entry = hexahedron_kind('boxBeam', 20, 24, 25)
    case (KIND_BEAM_CIRC)
      entry = hexahedron_kind('circBeam', 20, 24, 25)
    case (KIND_BEAM_KRONROD)
      entry = hexahedron_kind('kronBeam', 20, 50, 25)
    case (KIND_CPS3:KIND_CPS8R)
      entry = plane_kind('CPS', FAMILY_PLANE_STRESS, kind - KIND_CPS3 + merge(1, 0, kind >= KIND_CPS4))
    case (KIND_CPE3:KIND_CPE8R)
      entry = plane_kind('CPE', FAMILY_PLANE_STRAIN, kind - KIND_CPE3)
    case (KIND_CAX3:KIND_CAX8R)
      entry = plane_kind('CAX', FAMILY_AXISYMMETRIC, kind - KIND_CAX3)
    case (KIND_CPS4I:KIND_CAX4I)
      entry = plane_kind(PLANE_PREFIX(kind), kind - KIND_CPS4I + FAMILY_PLANE_STRESS, MODES_SHAPE)
    case (KIND_CAX_SHELL)                     ! no deck can name it
      entry = plane_kind('CAX', FAMILY_AXISYMMETRIC, KIND_CAX8 - KIND_CAX3)
      entry%name = 'axiShell'
      entry%n_points = 10
    case (KIND_T3D2)
      entry = element_kind_type(name='T3D2', family=FAMILY_TRUSS, n_nodes=2, n_points=1, vtk_type=3)
    case (KIND_T3D3)
      entry = element_kind_type(name='T3D3', family=FAMILY_TRUSS, n_nodes=3, n_points=2, vtk_type=21)
    case (KIND_SPRINGA)
      entry = element_kind_type(name='SPRINGA', family=FAMILY_SPRING, n_nodes=2, vtk_type=3)
    case (KIND_SPRING1)
      entry = element_kind_type(name='SPRING1', family=FAMILY_SPRING, n_nodes=1, vtk_type=1)
    case (KIND_SPRING2)
      entry = element_kind_type(name='SPRING2', family=FAMILY_SPRING, n_nodes=2, vtk_type=3)
    case (KIND_GAPUNI)
      entry = element_kind_type(name='GAPUNI', family=FAMILY_SPRING, n_nodes=2, vtk_type=3)
    case (KIND_MASS)
      entry = element_kind_type(name='MASS', family=FAMILY_MASS, n_nodes=1, vtk_type=1)
    case (KIND_R2D2, KIND_RAX2)               ! the normal of side 2 lies to the left of 1 to 2
      entry = element_kind_type(name='R2D2', family=FAMILY_RIGID, n_nodes=2, n_faces=2, vtk_type=3)
      if (kind == KIND_RAX2) entry%name = 'RAX2'
      entry%face_kind(:2) = FACET_LINE2
      entry%face_nodes(:2, :2) = reshape([1, 2, 2, 1], [2, 2])
    case (KIND_USER)                          ! its words in a deck are U1, U2, ...; any number of nodes
      entry = element_kind_type(name='user', family=FAMILY_USER, vtk_type=2)
    case (KIND_COH2D4:KIND_COH3D8)
      entry = cohesive_kind(kind)
    case (KIND_S3:KIND_S8R)
      entry = surface_kind('S', FAMILY_SHELL, kind - KIND_S3)
    case (KIND_M3D3:KIND_M3D8R)
      entry = surface_kind('M3D', FAMILY_MEMBRANE, kind - KIND_M3D3)
      call set_sides(kind - KIND_M3D3, entry)
    case (KIND_SAX1)
      entry = element_kind_type(name='SAX1', family=FAMILY_SHELL, n_nodes=2, vtk_type=3)
    case (KIND_SAX2)
      entry = element_kind_type(name='SAX2', family=FAMILY_SHELL, n_nodes=3, vtk_type=21)
    case (KIND_B31, KIND_B31R)
      entry = element_kind_type(name=merge('B31 ', 'B31R', kind == KIND_B31), family=FAMILY_BEAM, n_nodes=2, vtk_type=3)
    case (KIND_B32, KIND_B32R)
      entry = element_kind_type(name=merge('B32 ', 'B32R', kind == KIND_B32), family=FAMILY_BEAM, n_nodes=3, vtk_type=21)
    end select
  end function element_kind


  !> The table entry of a facet kind.
  pure function facet_kind(kind) result(entry)
    integer, intent(in) :: kind               !< FACET_...
    type(facet_kind_type) :: entry
    integer, parameter :: NODES(6) = [3, 4, 6, 8, 2, 3], CORNERS(6) = [3, 4, 3, 4, 2, 2]
    entry%n_nodes = NODES(kind)
    entry%n_corners = CORNERS(kind)
  end function facet_kind


  !> The element kind of a name in upper case; 0: unknown name. C3D8, CPE4, CAX4 give the mean-dilatation kind.
  pure function element_kind_by_name(name) result(kind)
    character(*), intent(in) :: name          !< e.g. 'C3D8'
    integer :: kind
    type(element_kind_type) :: entry
    do kind = 1, N_DECK_KINDS
      entry = element_kind(kind)
      if (entry%name == name) return
    end do
    kind = 0
  end function element_kind_by_name


  !> Entries of the tetrahedra.
  pure function tetrahedron_kind(name, n_nodes, n_points, vtk_type) result(entry)
    character(*), intent(in) :: name
    integer, intent(in) :: n_nodes, n_points, vtk_type
    type(element_kind_type) :: entry
    entry = element_kind_type(name=name, n_nodes=n_nodes, n_points=n_points, n_faces=4, vtk_type=vtk_type)
    entry%face_kind(:4) = merge(FACET_TRI3, FACET_TRI6, n_nodes == 4)
    ! The manuals number the faces 1-2-3, 1-4-2, 2-4-3, 3-4-1, as seen from inside: here they are turned outward.
    entry%face_nodes(:3, :4) = reshape([1, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4], [3, 4])
    if (n_nodes == 10) entry%face_nodes(4:6, :4) = reshape([7, 6, 5, 5, 9, 8, 6, 10, 9, 7, 8, 10], [3, 4])
  end function tetrahedron_kind


  !> Entries of the wedges.
  pure function wedge_kind(name, n_nodes, n_points, vtk_type) result(entry)
    character(*), intent(in) :: name
    integer, intent(in) :: n_nodes, n_points, vtk_type
    type(element_kind_type) :: entry
    entry = element_kind_type(name=name, n_nodes=n_nodes, n_points=n_points, n_faces=5, vtk_type=vtk_type)
    entry%face_kind(:2) = merge(FACET_TRI3, FACET_TRI6, n_nodes == 6)
    entry%face_kind(3:5) = merge(FACET_QUAD4, FACET_QUAD8, n_nodes == 6)
    entry%face_nodes(:4, :5) = reshape([1, 3, 2, 0, 4, 5, 6, 0, 1, 2, 5, 4, 2, 3, 6, 5, 3, 1, 4, 6], [4, 5])
    if (n_nodes == 6) return
    entry%face_nodes(4:6, :2) = reshape([9, 8, 7, 10, 11, 12], [3, 2])
    entry%face_nodes(5:8, 3:5) = reshape([7, 14, 10, 13, 8, 15, 11, 14, 9, 13, 12, 15], [4, 3])
  end function wedge_kind


  !> Entries of the plane and axisymmetric elements; their faces are edges, counterclockwise.
  pure function plane_kind(prefix, family, shape) result(entry)
    character(3), intent(in) :: prefix
    integer, intent(in) :: family             !< FAMILY_...
    integer, intent(in) :: shape              !< 0 to 7: triangle, quadrilateral (mean, full, 1 point), then quadratic; modes
    type(element_kind_type) :: entry
    character(2), parameter :: NAMES(0:7) = ['3 ', '4 ', '4 ', '4R', '6 ', '8 ', '8R', '4I']
    integer, parameter :: NODES(0:7) = [3, 4, 4, 4, 6, 8, 8, 4], POINTS(0:7) = [1, 4, 4, 1, 3, 9, 4, 4], &
      VTK(0:7) = [5, 9, 9, 9, 22, 23, 23, 9]
    integer :: n, i
    entry = element_kind_type(name=prefix // NAMES(shape), family=family, n_nodes=NODES(shape), n_points=POINTS(shape), &
      vtk_type=VTK(shape))
    entry%is_mean_dilatation = shape == 1
    n = merge(3, 4, NODES(shape) == 3 .or. NODES(shape) == 6)
    entry%n_faces = n
    entry%face_kind(:n) = merge(FACET_LINE2, FACET_LINE3, NODES(shape) == n)
    do i = 1, n
      entry%face_nodes(:2, i) = [i, modulo(i, n) + 1]
      if (NODES(shape) > n) entry%face_nodes(3, i) = n + i
    end do
  end function plane_kind


  !> Points and faces of the membranes: 1 is SNEG, 2 is SPOS. M3D4R has the points of M3D4.
  pure subroutine set_sides(shape, entry)
    integer, intent(in) :: shape              !< 0 to 5: 3, 4, 4R, 6, 8, 8R
    type(element_kind_type), intent(inout) :: entry
    integer, parameter :: POINTS(0:5) = [1, 4, 4, 3, 9, 4]
    integer, parameter :: FACES(0:5) = [FACET_TRI3, FACET_QUAD4, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, FACET_QUAD8]
    integer :: i, n, corners
    n = entry%n_nodes
    corners = merge(3, 4, n == 3 .or. n == 6)
    entry%n_points = POINTS(shape)
    entry%n_faces = 2
    entry%face_kind(:2) = FACES(shape)
    entry%face_nodes(:n, 2) = [(i, i=1, n)]
    entry%face_nodes(:corners, 1) = [1, (i, i=corners, 2, -1)]
    if (n > corners) entry%face_nodes(corners + 1:n, 1) = [(i, i=n, corners + 1, -1)]
  end subroutine set_sides


  !> Whether a kind is a membrane.
  elemental logical function is_membrane(kind)
    integer, intent(in) :: kind               !< KIND_...
    is_membrane = kind >= KIND_M3D3 .and. kind <= KIND_M3D8R
  end function is_membrane


  !> Whether a kind has two faces, SNEG and SPOS, on the same nodes: they hide no face of another element.
  elemental logical function is_two_sided(kind)
    integer, intent(in) :: kind               !< KIND_...
    is_two_sided = is_membrane(kind) .or. kind == KIND_R2D2 .or. kind == KIND_RAX2
  end function is_two_sided


  !> Whether the faces of a kind are surfaces in space: solids, membranes.
  elemental logical function has_faces_in_space(kind)
    integer, intent(in) :: kind               !< KIND_...
    has_faces_in_space = kind <= N_SOLID_KINDS .or. is_membrane(kind) .or. kind == KIND_COH3D6 .or. kind == KIND_COH3D8
  end function has_faces_in_space


  !> The place of a face among those of its kind, by its number in the deck; 0: none. Of cohesive edges S1 and S3 hold each other.
  elemental integer function face_index(kind, number) result(face)
    integer, intent(in) :: kind               !< KIND_...
    integer, intent(in) :: number             !< n of Sn, Pn, Fn; 0: none
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    face = number
    if (is_cohesive(kind) .and. .not. has_faces_in_space(kind)) face = findloc([1, 3], number, dim=1)
    if (face > entry%n_faces) face = 0
  end function face_index


  !> Whether a kind is a ring of a body of revolution: its faces reach around the circle.
  elemental logical function is_of_revolution(kind)
    integer, intent(in) :: kind               !< KIND_..., or 0
    is_of_revolution = kind == KIND_COHAX4
    if (kind > 0 .and. .not. is_of_revolution) is_of_revolution = kind_family(kind) == FAMILY_AXISYMMETRIC
  end function is_of_revolution


  !> Whether a kind is cohesive: two faces that hold each other by tractions over their separation.
  elemental logical function is_cohesive(kind)
    integer, intent(in) :: kind               !< KIND_...
    is_cohesive = kind >= KIND_COH2D4 .and. kind <= KIND_COH3D8
  end function is_cohesive


  !> The local node of a cohesive element that faces a node of its first half.
  elemental integer function opposite_node(kind, a) result(opposite)
    integer, intent(in) :: kind               !< KIND_COH...
    integer, intent(in) :: a                  !< 1 to half the nodes
    select case (kind)
    case (KIND_COH3D6)
      opposite = a + 3
    case (KIND_COH3D8)
      opposite = a + 4
    case default
      opposite = 5 - a
    end select
  end function opposite_node


  !> Entries of the cohesive elements. Faces are those that hold each other, S1 and S2 in space, S1 and S3 in the plane.
  pure function cohesive_kind(kind) result(entry)
    integer, intent(in) :: kind               !< KIND_COH...
    type(element_kind_type) :: entry
    entry = element_kind_type(name='COH2D4', family=FAMILY_COHESIVE, n_nodes=4, n_points=2, n_faces=2, vtk_type=9)
    entry%face_kind(:2) = FACET_LINE2
    entry%face_nodes(:2, :2) = reshape([1, 2, 3, 4], [2, 2])
    select case (kind)
    case (KIND_COHAX4)
      entry%name = 'COHAX4'
    case (KIND_COH3D6)
      entry = wedge_kind('COH3D6', 6, 3, 13)
    case (KIND_COH3D8)
      entry = hexahedron_kind('COH3D8', 8, 4, 12)
    end select
    entry%family = FAMILY_COHESIVE
    entry%n_faces = 2
    entry%face_kind(3:) = 0
    entry%face_nodes(:, 3:) = 0
  end function cohesive_kind


  !> Entries of the shells and membranes; the faces of shells are those of the solids into which they are expanded.
  pure function surface_kind(prefix, family, shape) result(entry)
    character(*), intent(in) :: prefix
    integer, intent(in) :: family             !< FAMILY_...
    integer, intent(in) :: shape              !< 0 to 5: 3, 4, 4R, 6, 8, 8R
    type(element_kind_type) :: entry
    character(2), parameter :: NAMES(0:5) = ['3 ', '4 ', '4R', '6 ', '8 ', '8R']
    integer, parameter :: NODES(0:5) = [3, 4, 4, 6, 8, 8], VTK(0:5) = [5, 9, 9, 22, 23, 23]
    entry = element_kind_type(name=prefix // trim(NAMES(shape)), family=family, n_nodes=NODES(shape), vtk_type=VTK(shape))
  end function surface_kind


  !> Whether a family is one of shells or beams, which are expanded.
  elemental logical function is_structural_family(family)
    integer, intent(in) :: family             !< FAMILY_...
    is_structural_family = family == FAMILY_SHELL .or. family == FAMILY_BEAM
  end function is_structural_family


  !> Entries of the hexahedra.
  pure function hexahedron_kind(name, n_nodes, n_points, vtk_type) result(entry)
    character(*), intent(in) :: name
    integer, intent(in) :: n_nodes, n_points, vtk_type
    type(element_kind_type) :: entry
    entry = element_kind_type(name=name, n_nodes=n_nodes, n_points=n_points, n_faces=6, vtk_type=vtk_type)
    entry%face_kind(:6) = merge(FACET_QUAD4, FACET_QUAD8, n_nodes == 8)
    entry%face_nodes(:4, :6) = reshape([1, 4, 3, 2, 5, 6, 7, 8, 1, 2, 6, 5, 2, 3, 7, 6, 3, 4, 8, 7, 4, 1, 5, 8], [4, 6])
    if (n_nodes == 20) entry%face_nodes(5:8, :6) = reshape([12, 11, 10, 9, 13, 14, 15, 16, 9, 18, 13, 17, &
      10, 19, 14, 18, 11, 20, 15, 19, 12, 17, 16, 20], [4, 6])
  end function hexahedron_kind


  !> Whether elements of a kind have nodes beside their corners.
  elemental logical function has_midsides(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: element
    type(facet_kind_type) :: face
    element = element_kind(kind)
    has_midsides = .false.
    if (element%n_faces == 0) return
    face = facet_kind(element%face_kind(1))
    has_midsides = face%n_nodes > face%n_corners
  end function has_midsides

end module amontons_element_kinds
