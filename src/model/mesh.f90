!> Nodes, elements and sets of the model; fixed after reading.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_mesh
  use amontons_kinds, only: DP
  use amontons_containers, only: find_root, unite_trees
  use amontons_element_kinds, only: element_kind, element_kind_type, facet_kind_type, facet_kind, MAX_ELEMENT_NODES, &
    KIND_SPRINGA, FAMILY_SOLID, &
    FAMILY_MEMBRANE, FAMILY_TRUSS, FAMILY_SPRING, FAMILY_MASS, FAMILY_PLANE_STRESS, FAMILY_PLANE_STRAIN, FAMILY_AXISYMMETRIC, &
    FAMILY_RIGID, FAMILY_USER, FAMILY_COHESIVE, has_faces_in_space, face_index
  use amontons_tensor, only: cross_product
  implicit none
  private
  public :: mesh_type, set_type, finalize_mesh, element_nodes, wall_ratios, append_node, append_nodes, append_node_copies, &
    mesh_extent, find_connected_nodes, replace_element_nodes, mean_face_normal, face_number_here, numbered_face, N_NUMBERED_FACES

  integer, parameter :: N_NUMBERED_FACES = 6     !< most faces of an element in a deck

  !> A named list of nodes or elements.
  type :: set_type
    character(:), allocatable :: name        !< name as written by the user
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
    integer, allocatable :: kind(:)                !< (n_elements) KIND_... of element_kinds
    integer, allocatable :: first(:)               !< (n_elements + 1) start of an element's nodes in nodes(:)
    integer, allocatable :: nodes(:)               !< node indices of all elements, one after the other
    integer, allocatable :: point_first(:)         !< (n_elements + 1) start of an element's integration points
    integer, allocatable :: material(:)            !< (n_elements) index into model%materials; 0: no section
    real(DP), allocatable :: section_value(:)            !< (n_elements) thickness [length], cross-section [length^2], spring
    !< constant [force/length] or mass [mass], by the kind; else 1
    real(DP), allocatable :: walls(:, :)           !< (4, n_elements) hollow beams: thickness of the walls over the dimension, see
                                                   !! module beam_rules, full beams of C3D8I 1/2; unallocated: there are none [-]
    real(DP), allocatable :: cohesive(:, :)        !< (2, n_elements) cohesive elements: thickness of their strains [length],
                                                   !! viscosity of their damage [time]; unallocated: there are none
    integer, allocatable :: directions(:, :)       !< (2, n_elements) directions of SPRING1, SPRING2; else 0
    integer, allocatable :: section(:)             !< (n_elements) number of its SECTION card (or the like) in the deck; 0: none
    integer, allocatable :: spring(:)              !< (n_elements) index into model%springs, 0: constant of section; unallocated: 0
    logical, allocatable :: is_auxiliary(:)         !< (n_nodes) it has no displacement but a rotation vector or a pre-tension
    logical, allocatable :: has_elements(:)        !< (n_nodes)
    logical, allocatable :: is_expanded(:)         !< (nodes of the deck) node of shells or beams, which moves with those into which
                                                   !! it expands; unallocated: there are none
    logical, allocatable :: is_shell(:)            !< (n_elements) a solid into which a shell expands, CSS6: into which alone;
                                                   !! unallocated: there are none
    integer, allocatable :: layer(:)               !< (n_elements) layer of a shell from its bottom; 1: the only one, or no shell
    logical, allocatable :: is_in_plane(:)                !< (n_elements) a truss whose nodes stay in the plane z = 0; may be absent
    logical, allocatable :: user_directions(:, :)   !< (3, size(nodes)) displacements that a user element stiffens at its node;
                                                   !! unallocated: there are none
    logical, allocatable :: is_unstiffened(:, :)          !< (3, n_nodes) has elements, but none has stiffness in this direction
    integer, allocatable :: face_places(:, :)      !< (N_NUMBERED_FACES, n_elements) number here of each face or edge of the deck,
                                                   !! 0: it is a line or a point; unallocated: no element has repeated nodes there
    type(set_type), allocatable :: node_sets(:)
    type(set_type), allocatable :: element_sets(:)
  end type mesh_type

contains

  !> The number here of a face, or edge of a shell, by its number in the deck; 0: it is a line or a point.
  pure integer function face_number_here(mesh, e, number) result(here)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element
    integer, intent(in) :: number                  !< in the deck; 0: none
    here = number
    if (.not. allocated(mesh%face_places) .or. number < 1) return
    if (e <= size(mesh%face_places, 2)) here = mesh%face_places(number, e)
  end function face_number_here


  !> The face of an element by its number in the deck; 0: none.
  pure integer function numbered_face(mesh, e, number) result(face)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element
    integer, intent(in) :: number                  !< n of Sn, Pn, Fn; 0: none
    face = face_index(mesh%kind(e), face_number_here(mesh, e, number))
  end function numbered_face


  !> Sets what follows from the kinds: first integration point of each element, totals, and displacements without
  !! stiffness; missing section values are 1.
  subroutine finalize_mesh(mesh)
    type(mesh_type), intent(inout) :: mesh   !< with n_elements, kind(:), first(:) and nodes(:) set
    type(element_kind_type) :: entry
    integer :: e, kind
    if (allocated(mesh%point_first)) deallocate (mesh%point_first)
    allocate (mesh%point_first(mesh%n_elements + 1))
    mesh%point_first(1) = 1
    kind = 0
    do e = 1, mesh%n_elements
      if (mesh%kind(e) /= kind) entry = element_kind(mesh%kind(e))
      kind = mesh%kind(e)
      mesh%point_first(e + 1) = mesh%point_first(e) + entry%n_points
    end do
    mesh%n_points = mesh%point_first(mesh%n_elements + 1) - 1
    if (.not. allocated(mesh%section_value)) allocate (mesh%section_value(mesh%n_elements), source=1.0_DP)
    if (.not. allocated(mesh%section)) allocate (mesh%section(mesh%n_elements), source=0)
    if (.not. allocated(mesh%directions)) allocate (mesh%directions(2, mesh%n_elements), source=0)
    if (allocated(mesh%is_unstiffened)) deallocate (mesh%is_unstiffened)
    if (allocated(mesh%has_elements)) deallocate (mesh%has_elements)
    allocate (mesh%has_elements(mesh%n_nodes), mesh%is_unstiffened(3, mesh%n_nodes), source=.false.)
    if (.not. allocated(mesh%is_auxiliary)) allocate (mesh%is_auxiliary(mesh%n_nodes), source=.false.)
    if (allocated(mesh%nodes)) call find_unstiffened_dofs(mesh)
  end subroutine finalize_mesh


  !> Gives the elements other nodes. Those of user elements stay, and with them the displacements that they stiffen.
  subroutine replace_element_nodes(mesh, first, nodes)
    type(mesh_type), intent(inout) :: mesh
    integer, intent(in) :: first(:)              !< (n_elements + 1)
    integer, intent(in) :: nodes(:)
    logical, allocatable :: directions(:, :)
    type(element_kind_type) :: entry
    integer :: e
    if (allocated(mesh%user_directions)) then
      allocate (directions(3, size(nodes)), source=.false.)
      do e = 1, mesh%n_elements
        entry = element_kind(mesh%kind(e))
        if (entry%family == FAMILY_USER) directions(:, first(e):first(e + 1) - 1) = &
          mesh%user_directions(:, mesh%first(e):mesh%first(e + 1) - 1)
      end do
      call move_alloc(directions, mesh%user_directions)
    end if
    mesh%first = first
    mesh%nodes = nodes
  end subroutine replace_element_nodes


  !> Displacements without stiffness from any element of their node: the third of a node of plane elements (regardless of springs or
  !! trusses), those across a spring of one direction, those of a node with point masses only. A node without elements has none.
  subroutine find_unstiffened_dofs(mesh)
    type(mesh_type), intent(inout) :: mesh
    logical, allocatable :: is_used(:)
    type(element_kind_type) :: entry
    logical :: is_plane
    integer :: e, i, kind
    allocate (is_used(0:mesh%n_nodes), source=.false.)   ! 0: node missing in the deck; its error is reported elsewhere
    is_used(mesh%nodes) = .true.
    mesh%has_elements = is_used(1:)
    mesh%is_unstiffened = spread(mesh%has_elements, 1, 3)
    if (allocated(mesh%is_expanded)) mesh%is_unstiffened(:, :size(mesh%is_expanded)) = &
      mesh%is_unstiffened(:, :size(mesh%is_expanded)) .and. .not. spread(mesh%is_expanded, 1, 3)
    kind = 0
    do e = 1, mesh%n_elements
      if (mesh%kind(e) /= kind) entry = element_kind(mesh%kind(e))
      kind = mesh%kind(e)
      do i = mesh%first(e), mesh%first(e + 1) - 1
        if (mesh%nodes(i) == 0) cycle
        associate (is_idle => mesh%is_unstiffened(:, mesh%nodes(i)))
          if (entry%family == FAMILY_USER) then
            is_idle = is_idle .and. .not. mesh%user_directions(:, i)
          else
            is_idle = is_idle .and. .not. stiffened_directions(mesh, e, i - mesh%first(e) + 1, entry%family)
          end if
        end associate
      end do
    end do
    kind = 0
    do e = 1, mesh%n_elements
      if (mesh%kind(e) /= kind) entry = element_kind(mesh%kind(e))
      kind = mesh%kind(e)
      is_plane = any(entry%family == [FAMILY_PLANE_STRESS, FAMILY_PLANE_STRAIN, FAMILY_AXISYMMETRIC, FAMILY_RIGID])
      if (entry%family == FAMILY_COHESIVE) is_plane = .not. has_faces_in_space(kind)
      if (allocated(mesh%is_in_plane)) is_plane = is_plane .or. mesh%is_in_plane(e)
      if (.not. is_plane) cycle
      do i = mesh%first(e), mesh%first(e + 1) - 1
        if (mesh%nodes(i) > 0) mesh%is_unstiffened(3, mesh%nodes(i)) = .true.
      end do
    end do
    if (.not. allocated(mesh%user_directions)) return
    do i = 1, size(mesh%nodes)                       ! the third displacement may be another field in a plane model
      if (mesh%nodes(i) > 0 .and. mesh%user_directions(3, i)) mesh%is_unstiffened(3, mesh%nodes(i)) = .false.
    end do
  end subroutine find_unstiffened_dofs


  !> The displacements in which an element has stiffness at one of its nodes.
  pure function stiffened_directions(mesh, e, a, family) result(resists)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, a                    !< element, its local node
    integer, intent(in) :: family                  !< FAMILY_...
    logical :: resists(3)
    select case (family)
    case (FAMILY_COHESIVE)
      resists = [.true., .true., has_faces_in_space(mesh%kind(e))]
    case (FAMILY_SOLID, FAMILY_MEMBRANE, FAMILY_TRUSS)
      resists = .true.
    case (FAMILY_MASS)
      resists = .false.
    case (FAMILY_SPRING)
      resists = .true.
      if (mesh%kind(e) == KIND_SPRINGA .or. mesh%directions(1, e) == 0) return
      resists = .false.
      if (mesh%directions(a, e) > 0) resists(mesh%directions(a, e)) = .true.
    case default
      resists = [.true., .true., .false.]
    end select
  end function stiffened_directions


  !> Appends a node without elements at a position; its label is one above the largest.
  subroutine append_node(mesh, x, node)
    type(mesh_type), intent(inout) :: mesh         !< finished
    real(DP), intent(in) :: x(3)                   !< [length]
    integer, intent(out) :: node                   !< its index
    real(DP), allocatable :: coordinates(:, :)
    logical, allocatable :: is_idle(:, :)
    node = mesh%n_nodes + 1
    allocate (coordinates(3, node), is_idle(3, node))
    coordinates(:, :mesh%n_nodes) = mesh%coordinates
    coordinates(:, node) = x
    is_idle(:, :mesh%n_nodes) = mesh%is_unstiffened
    is_idle(:, node) = .false.
    call move_alloc(coordinates, mesh%coordinates)
    call move_alloc(is_idle, mesh%is_unstiffened)
    mesh%is_auxiliary = [mesh%is_auxiliary, .false.]
    mesh%has_elements = [mesh%has_elements, .false.]
    mesh%node_label = [mesh%node_label, maxval(mesh%node_label) + 1]
    mesh%n_nodes = node
  end subroutine append_node


  !> Appends nodes without elements; their labels follow the largest. Cost: linear.
  subroutine append_nodes(mesh, x)
    type(mesh_type), intent(inout) :: mesh         !< finished
    real(DP), intent(in) :: x(:, :)                !< (3, n) positions; they become n_nodes + 1, ... in this order [length]
    integer :: i, n
    n = size(x, 2)
    mesh%coordinates = reshape([mesh%coordinates, x], [3, mesh%n_nodes + n])
    mesh%is_unstiffened = reshape([mesh%is_unstiffened, spread(spread(.false., 1, 3), 2, n)], [3, mesh%n_nodes + n])
    mesh%is_auxiliary = [mesh%is_auxiliary, spread(.false., 1, n)]
    mesh%has_elements = [mesh%has_elements, spread(.false., 1, n)]
    mesh%node_label = [mesh%node_label, maxval(mesh%node_label) + [(i, i=1, n)]]
    mesh%n_nodes = mesh%n_nodes + n
  end subroutine append_nodes


  !> The diagonal of the bounding box of the mesh [length].
  pure real(DP) function mesh_extent(mesh)
    type(mesh_type), intent(in) :: mesh
    mesh_extent = norm2(maxval(mesh%coordinates, dim=2) - minval(mesh%coordinates, dim=2))
  end function mesh_extent


  !> Appends copies of nodes at the same positions. Cost: linear.
  subroutine append_node_copies(mesh, nodes)
    type(mesh_type), intent(inout) :: mesh         !< finished
    integer, intent(in) :: nodes(:)                !< their copies become n_nodes + 1, ... in this order
    integer :: n_before
    n_before = mesh%n_nodes
    call append_nodes(mesh, mesh%coordinates(:, nodes))
    mesh%is_unstiffened(:, n_before + 1:) = mesh%is_unstiffened(:, nodes)
  end subroutine append_node_copies


  !> The node indices of one element; the first n are set.
  pure subroutine element_nodes(mesh, e, n, nodes)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element index
    integer, intent(out) :: n                      !< number of its nodes
    integer, intent(out) :: nodes(MAX_ELEMENT_NODES)       !< their indices
    n = mesh%first(e + 1) - mesh%first(e)
    nodes(:n) = mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)
    nodes(n + 1:) = 0
  end subroutine element_nodes


  !> The walls of an element: thickness over the dimension; zero if it is no hollow beam.
  pure function wall_ratios(mesh, e) result(walls)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element index
    real(DP) :: walls(4)                           !< [-]
    walls = 0
    if (allocated(mesh%walls)) walls = mesh%walls(:, e)
  end function wall_ratios


  !> Bodies: nodes that elements connect, directly or through other nodes, numbered in the order of their first elements.
  !! Method: union-find. Cost: linear.
  subroutine find_connected_nodes(mesh, of_node, n, is_absent)
    type(mesh_type), intent(in) :: mesh
    integer, allocatable, intent(out) :: of_node(:)   !< (n_nodes) body from 1; 0: no element has the node
    integer, intent(out) :: n                      !< bodies
    logical, intent(in), optional :: is_absent(:)  !< (n_elements) these elements connect nothing
    integer, allocatable :: parent(:)
    logical, allocatable :: is_present(:), has_element(:)
    integer :: e, i, k, root
    allocate (is_present(mesh%n_elements), source=.true.)
    if (present(is_absent)) is_present = .not. is_absent
    parent = [(i, i=1, mesh%n_nodes)]
    allocate (of_node(mesh%n_nodes), source=0)
    allocate (has_element(mesh%n_nodes), source=.false.)
    do e = 1, mesh%n_elements
      if (.not. is_present(e)) cycle
      root = find_root(parent, mesh%nodes(mesh%first(e)))
      do k = mesh%first(e), mesh%first(e + 1) - 1
        has_element(mesh%nodes(k)) = .true.
        if (parent(mesh%nodes(k)) == root) cycle   ! of most nodes of a large body
        call unite_trees(parent, root, mesh%nodes(k))
        root = find_root(parent, root)
      end do
    end do
    n = 0
    do e = 1, mesh%n_elements
      if (.not. is_present(e)) cycle
      i = find_root(parent, mesh%nodes(mesh%first(e)))
      if (of_node(i) > 0) cycle
      n = n + 1
      of_node(i) = n
    end do
    do i = 1, mesh%n_nodes
      if (has_element(i)) of_node(i) = of_node(find_root(parent, i))
    end do
  end subroutine find_connected_nodes


  !> The mean unit normal of a face by its corners; of an edge within the plane.
  pure function mean_face_normal(mesh, e, face) result(normal)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, face                 !< element, number of its face
    real(DP) :: normal(3)
    type(element_kind_type) :: entry
    type(facet_kind_type) :: facet
    real(DP) :: x(3, 4)
    integer :: n
    entry = element_kind(mesh%kind(e))
    facet = facet_kind(entry%face_kind(face))
    n = facet%n_corners
    x(:, :n) = mesh%coordinates(:, mesh%nodes(mesh%first(e) - 1 + entry%face_nodes(:n, face)))
    if (n == 2) then
      normal = [x(2, 2) - x(2, 1), x(1, 1) - x(1, 2), 0.0_DP]
    else
      normal = cross_product(x(:, 3) - x(:, 1), x(:, n) - x(:, 2))
      if (n == 3) normal = cross_product(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))
    end if
    normal = normal / norm2(normal)
  end function mean_face_normal

end module amontons_mesh
