!> Topology of a faceted surface: neighbours, feature edges, vertices, and the stars from which averaged normals are formed.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The normal of a surface of flat or bilinear facets jumps at every edge, and a slave node at an edge then has no solution. A
!! continuous normal at a node of a facet is averaged over the facets around the node that belong to the same smooth piece of
!! surface. Such a piece at a node is called a *vertex* here, its facets the *star* of the vertex. Facets that meet in a smooth edge
!! share the vertices of both its ends; facets that meet in a crease (feature angle) do not, unless the crease ends there. So a
!! normal formed vertex by vertex is the same from both sides of a smooth edge and jumps at a crease. This topology is fixed in the
!! reference configuration; amontons_surface_projection forms the normals.
!!
!! In the plane a facet is a line of 2 or 3 nodes. Its "edges" are its two ends, its second tangent is e_z, and xi(2) is unused; all
!! else is as in space.
module amontons_facets
  use amontons_kinds, only: DP, PI
  use amontons_containers, only: list_groups, owners_of_entries, sort_ascending
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_element_kinds, only: element_kind, facet_kind, facet_kind_type, element_kind_type, FACET_LINE2, FACET_LINE3, &
    MAX_FACE_NODES
  use amontons_mesh, only: mesh_type
  use amontons_tensor, only: cross_product
  use amontons_shape_functions, only: facet_shapes
  use amontons_analytic_profiles, only: analytic_profile_type
  implicit none
  private
  public :: facets_type, build_facets, facet_nodes, facet_tangents, facet_label, n_facet_corners, is_line_facet, is_hidden_behind, &
    is_unseen, is_absent_facet, facet_centre
  public :: EDGE_FREE, EDGE_SMOOTH, EDGE_CONVEX, EDGE_CONCAVE

  integer, parameter :: EDGE_FREE = 0         !< no facet across
  integer, parameter :: EDGE_SMOOTH = 1       !< the normals of both sides differ by less than the feature angle
  integer, parameter :: EDGE_CONVEX = 2       !< a convex crease, as the edge of a box
  integer, parameter :: EDGE_CONCAVE = 3      !< a concave crease, as between two walls

  real(DP), parameter :: DEFAULT_FEATURE_ANGLE = PI / 4   !< default feature angle: a sharper edge is a crease [rad]

  !> The facets of one surface. Edge k of a facet runs from its corner k to the next corner; edge k of a line is its corner k alone.
  !! Unused edges (the 4th of a triangle, the 3rd and 4th of a line) are free.
  type :: facets_type
    integer :: n = 0
    integer, allocatable :: kind(:)           !< (n) FACET_... of element_kinds
    integer, allocatable :: first(:)          !< (n + 1) start of a facet's nodes in nodes(:) and vertex(:)
    integer, allocatable :: nodes(:)          !< mesh nodes of all facets: corners, then mid-sides, right-handed outward
    integer, allocatable :: element(:)        !< (n) element index of each facet
    integer, allocatable :: face(:)           !< (n) its face number 1 to 6
    integer, allocatable :: neighbour(:, :)   !< (4, n) facet across each edge; 0: none
    integer, allocatable :: edge(:, :)        !< (4, n) EDGE_...
    real(DP), allocatable :: edge_length(:)   !< (n) mean length of the edges, reference configuration [length]
    real(DP), allocatable :: max_depth(:)     !< (n) points deeper behind a facet do not see it; unallocated: no limit [length]
    integer, allocatable :: at_first(:)       !< (n_nodes + 1) self contact: start of a node's facets in at(:)
    integer, allocatable :: at(:)             !< facets at each node of the mesh
    integer, allocatable :: unseen_first(:)   !< (n_nodes + 1) self contact: start of a node's facets in unseen(:)
    integer, allocatable :: unseen(:)         !< facets that a node of the surface cannot touch (amontons_self_contact_visibility)
    logical, allocatable :: is_absent(:)      !< (n) of removed elements, which touch nothing; unallocated: none
    logical :: is_faceted = .false.           !< each facet has vertices of its own: the normal jumps at every edge
    integer, allocatable :: vertex(:)         !< vertex of each entry of nodes(:)
    integer :: n_vertices = 0
    real(DP), allocatable :: symmetry_projector(:, :, :)  !< (3, 3, n_vertices) projects a normal into its symmetry planes; else
                                                          !! unity
    integer, allocatable :: star_first(:)     !< (n_vertices + 1) start of a vertex's star
    integer, allocatable :: star_facet(:)     !< facets of all stars
    integer, allocatable :: star_local(:)     !< local node number of the vertex's node in that facet
    integer, allocatable :: stencil_first(:)  !< (n + 1) start of a facet's stencil
    integer, allocatable :: stencil(:)        !< mesh nodes on which a facet's points and normals depend: own, then others
    type(analytic_profile_type), allocatable :: profile  !< an analytic surface: the facets are its pieces, their nodes the
                                                         !! carriers; without vertices and stencils
  end type facets_type

  !> Facets at each mesh node: entries of facets%nodes by node.
  type :: incidence_type
    integer, allocatable :: first(:)          !< (n_nodes + 1)
    integer, allocatable :: entry(:)          !< index into facets%nodes, ascending by node
    integer, allocatable :: owner(:)          !< facet of each entry of facets%nodes
  end type incidence_type

contains

  !> Builds the facets of a surface: neighbours, kinds of edges, vertices, stars and stencils. Cost: linear.
  !!
  !! Errors: an element or face that does not exist, a facet without area, facets of opposite orientation or listed twice, an edge
  !! with more than two facets.
  subroutine build_facets(mesh, element, face, facets, error, feature_angle, is_faceted)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element(:)                     !< (n) element index of each facet
    integer, intent(in) :: face(:)                        !< (n) its face number
    type(facets_type), intent(out) :: facets
    type(error_type), allocatable, intent(out) :: error
    real(DP), intent(in), optional :: feature_angle       !< [rad], default DEFAULT_FEATURE_ANGLE
    logical, intent(in), optional :: is_faceted           !< as facets%is_faceted; default .false.
    type(incidence_type) :: incidence
    real(DP) :: angle
    angle = DEFAULT_FEATURE_ANGLE
    if (present(feature_angle)) angle = feature_angle
    if (present(is_faceted)) facets%is_faceted = is_faceted
    call collect_facets(mesh, element, face, facets, error)
    if (allocated(error)) return
    call set_edge_lengths(mesh, facets, error)
    if (allocated(error)) return
    call find_incidence(facets, mesh%n_nodes, incidence)
    call find_neighbours(mesh, incidence, facets, error)
    if (allocated(error)) return
    call classify_edges(mesh%coordinates, angle, facets)
    call find_vertices(incidence, facets)
    call collect_stars(incidence, facets)
    call collect_stencils(mesh%n_nodes, facets)
  end subroutine build_facets


  !> The nodes of one facet; the first n are set.
  pure subroutine facet_nodes(facets, f, n, nodes)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                         !< facet
    integer, intent(out) :: n                        !< number of its nodes
    integer, intent(out) :: nodes(MAX_FACE_NODES)    !< their mesh indices
    n = facets%first(f + 1) - facets%first(f)
    nodes(:n) = facets%nodes(facets%first(f):facets%first(f + 1) - 1)
    nodes(n + 1:) = 0
  end subroutine facet_nodes


  !> The tangents x,1 and x,2 of a facet at natural coordinates; their cross product points out of the body.
  pure subroutine facet_tangents(facets, x, f, xi, tangents)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                  !< (3, n_nodes) coordinates [length]
    integer, intent(in) :: f                         !< facet
    real(DP), intent(in) :: xi(2)                    !< natural coordinates [-]
    real(DP), intent(out) :: tangents(3, 2)          !< [length]
    real(DP) :: N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: n, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, n, nodes)
    call facet_shapes(facets%kind(f), xi, N_i, dN, ddN)
    tangents = matmul(x(:, nodes(:n)), transpose(dN(:, :n)))
    if (is_line_facet(facets%kind(f))) tangents(3, 2) = 1
  end subroutine facet_tangents


  !> Whether a point behind a facet is too deep to see it.
  pure logical function is_hidden_behind(facets, f, gap)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                         !< facet
    real(DP), intent(in) :: gap                      !< distance in front of it [length]
    is_hidden_behind = .false.
    if (allocated(facets%max_depth)) is_hidden_behind = gap < -facets%max_depth(f)
  end function is_hidden_behind


  !> Whether a facet is of a removed element.
  pure logical function is_absent_facet(facets, f)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                         !< facet; 0: none, which is not
    is_absent_facet = .false.
    if (allocated(facets%is_absent) .and. f > 0) is_absent_facet = facets%is_absent(f)
  end function is_absent_facet


  !> Whether a node cannot touch a facet: that of a removed element; in self contact one near it on the surface or behind it in the
  !! material.
  pure logical function is_unseen(facets, node, f)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: node                      !< of the mesh
    integer, intent(in) :: f                         !< facet
    is_unseen = is_absent_facet(facets, f)
    if (is_unseen) return
    if (allocated(facets%unseen)) is_unseen = any(facets%unseen(facets%unseen_first(node):facets%unseen_first(node + 1) - 1) == f)
  end function is_unseen


  !> 'element 12 face S3', with the user's element label.
  function facet_label(mesh, facets, f) result(label)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                         !< facet
    character(:), allocatable :: label
    character(40) :: text
    write (text, '(a,i0,a,i0)') 'element ', mesh%element_label(facets%element(f)), ' face S', facets%face(f)
    label = trim(text)
  end function facet_label


  !> Kinds and nodes of the facets, from the element faces.
  subroutine collect_facets(mesh, element, face, facets, error)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element(:), face(:)
    type(facets_type), intent(inout) :: facets
    type(error_type), allocatable, intent(out) :: error
    type(element_kind_type) :: solid
    type(facet_kind_type) :: plane
    integer :: f, e, start
    facets%n = size(element)
    allocate (facets%kind(facets%n), facets%first(facets%n + 1), facets%nodes(MAX_FACE_NODES * facets%n))
    facets%element = element
    facets%face = face
    facets%first(1) = 1
    do f = 1, facets%n
      call check_face(mesh, element(f), face(f), error)
      if (allocated(error)) return
      solid = element_kind(mesh%kind(element(f)))
      facets%kind(f) = solid%face_kind(face(f))
      plane = facet_kind(facets%kind(f))
      start = facets%first(f)
      e = mesh%first(element(f)) - 1
      facets%nodes(start:start + plane%n_nodes - 1) = mesh%nodes(e + solid%face_nodes(:plane%n_nodes, face(f)))
      facets%first(f + 1) = start + plane%n_nodes
    end do
    facets%nodes = facets%nodes(:facets%first(facets%n + 1) - 1)
  end subroutine collect_facets


  !> An error if the element or the face does not exist.
  subroutine check_face(mesh, element, face, error)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element, face
    type(error_type), allocatable, intent(out) :: error
    type(element_kind_type) :: solid
    character(160) :: text
    if (element < 1 .or. element > mesh%n_elements) then
      write (text, '(a,i0,a,i0,a)') 'A surface names element index ', element, ', but the mesh has 1 to ', &
        mesh%n_elements, '.'
      call set_error(error, EXIT_SETUP, trim(text))
      return
    end if
    solid = element_kind(mesh%kind(element))
    if (face >= 1 .and. face <= solid%n_faces) return
    if (solid%n_faces == 0) then
      write (text, '(a,i0,3a)') 'Contact needs faces of solids or edges of plane elements; element ', &
        mesh%element_label(element), ' of type ', trim(solid%name), ' has neither.'
      call set_error(error, EXIT_SETUP, trim(text))
      return
    end if
    write (text, '(a,i0,3a,i0,a,i0,a)') 'Element ', mesh%element_label(element), ' of type ', trim(solid%name), &
      ' has faces S1 to S', solid%n_faces, ', not S', face, '.'
    call set_error(error, EXIT_SETUP, trim(text))
  end subroutine check_face


  !> Mean edge lengths; an error for a facet without area.
  subroutine set_edge_lengths(mesh, facets, error)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(inout) :: facets
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: total, tangents(3, 2), normal(3)
    integer :: f, k, n_corners, a, b
    allocate (facets%edge_length(facets%n))
    do f = 1, facets%n
      n_corners = n_facet_corners(facets%kind(f))
      total = 0
      do k = 1, n_corners
        call edge_nodes(facets, f, k, a, b)
        if (is_line_facet(facets%kind(f))) b = facets%nodes(facets%first(f) + 2 - k)
        total = total + norm2(mesh%coordinates(:, b) - mesh%coordinates(:, a))
      end do
      facets%edge_length(f) = total / real(n_corners, DP)
      call facet_tangents(facets, mesh%coordinates, f, facet_centre(facets%kind(f)), tangents)
      normal = cross_product(tangents(:, 1), tangents(:, 2))
      if (norm2(normal) > 1.0e-12_DP * facets%edge_length(f)**merge(1, 2, is_line_facet(facets%kind(f)))) cycle
      call set_error(error, EXIT_SETUP, 'The face of ' // facet_label(mesh, facets, f) // ' has no area: it ' // &
        'cannot be part of a contact surface. Merge or remove the collapsed face.')
      return
    end do
  end subroutine set_edge_lengths


  !> For each mesh node its entries in facets%nodes.
  subroutine find_incidence(facets, n_nodes, incidence)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: n_nodes                   !< number of mesh nodes
    type(incidence_type), intent(out) :: incidence
    call list_groups(facets%nodes, n_nodes, incidence%first, incidence%entry)
    incidence%owner = owners_of_entries(facets%first(:facets%n + 1))
  end subroutine find_incidence


  !> The facet across each edge: it runs through the same two corners in the opposite sense. Lines join end to end.
  subroutine find_neighbours(mesh, incidence, facets, error)
    type(mesh_type), intent(in) :: mesh
    type(incidence_type), intent(in) :: incidence
    type(facets_type), intent(inout) :: facets
    type(error_type), allocatable, intent(out) :: error
    integer :: f, k, i, entry, other, a, b, direction, branch_facets(3)
    allocate (facets%neighbour(4, facets%n), source=0)
    do f = 1, facets%n
      do k = 1, n_facet_corners(facets%kind(f))
        call edge_nodes(facets, f, k, a, b)
        if (a == b .and. .not. is_line_facet(facets%kind(f))) cycle
        do i = incidence%first(a), incidence%first(a + 1) - 1
          entry = incidence%entry(i)
          other = incidence%owner(entry)
          if (other == f) cycle
          direction = find_edge_direction(facets, other, entry - facets%first(other) + 1, b)
          if (is_line_facet(facets%kind(f))) direction = find_end_direction(facets, other, entry - facets%first(other) + 1, k)
          if (direction == 0) cycle
          if (direction > 0) call set_orientation_error(mesh, facets, f, other, error)
          branch_facets = [f, other, facets%neighbour(k, f)]
          if (direction < 0 .and. branch_facets(3) /= 0) call set_branch_error(mesh, facets, branch_facets, error)
          if (allocated(error)) return
          facets%neighbour(k, f) = other
        end do
      end do
    end do
  end subroutine find_neighbours


  !> +1 if the facet runs from its local node to node b along an edge, -1 if from b to the local node, else 0.
  pure function find_edge_direction(facets, f, local, b) result(direction)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f, local                  !< facet, and local number of a node of it
    integer, intent(in) :: b                         !< a mesh node
    integer :: direction
    integer :: n_corners, start
    n_corners = n_facet_corners(facets%kind(f))
    start = facets%first(f) - 1
    direction = 0
    if (local > n_corners) return
    if (facets%nodes(start + previous_corner(local, n_corners)) == b) direction = -1
    if (facets%nodes(start + modulo(local, n_corners) + 1) == b) direction = 1
  end function find_edge_direction


  !> For lines: +1 if the facet has its own corner k at the common node, -1 if its other end, 0 if it does not end there.
  pure function find_end_direction(facets, f, local, k) result(direction)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f, local                  !< facet, and local number of the common node in it
    integer, intent(in) :: k                         !< corner of the line whose neighbour is searched
    integer :: direction
    direction = 0
    if (local <= 2 .and. is_line_facet(facets%kind(f))) direction = merge(1, -1, local == k)
  end function find_end_direction


  !> The error of two facets that run along an edge in the same sense.
  subroutine set_orientation_error(mesh, facets, f, other, error)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f, other
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_SETUP, 'The surface is not oriented: ' // facet_label(mesh, facets, f) // ' and ' // &
      facet_label(mesh, facets, other) // ' share an edge, but the normal of one points to the other side (or ' // &
      'they are the same face). Check the node order of the elements and the face numbers of the surface.')
  end subroutine set_orientation_error


  !> The error of three facets at an edge.
  subroutine set_branch_error(mesh, facets, branch_facets, error)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: branch_facets(3)                  !< facets
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_SETUP, 'An edge of the surface has more than two faces: ' // &
      facet_label(mesh, facets, branch_facets(1)) // ', ' // facet_label(mesh, facets, branch_facets(2)) // ' and ' // &
      facet_label(mesh, facets, branch_facets(3)) // '. A contact surface may not branch: split it into two surfaces.')
  end subroutine set_branch_error


  !> Smooth edge or crease, by the reference normals of both sides at the middle of the edge.
  pure subroutine classify_edges(x, angle, facets)
    real(DP), intent(in) :: x(:, :)                  !< (3, n_nodes) reference coordinates [length]
    real(DP), intent(in) :: angle                    !< feature angle [rad]
    type(facets_type), intent(inout) :: facets
    real(DP) :: own_normal(3), other_normal(3)
    integer :: f, k, other
    allocate (facets%edge(4, facets%n), source=EDGE_FREE)
    do f = 1, facets%n
      do k = 1, n_facet_corners(facets%kind(f))
        other = facets%neighbour(k, f)
        if (other == 0) cycle
        own_normal = edge_normal(facets, x, f, k)
        other_normal = edge_normal(facets, x, other, findloc(facets%neighbour(:, other), f, dim=1))
        if (dot_product(own_normal, other_normal) > cos(angle)) then
          facets%edge(k, f) = EDGE_SMOOTH
        else if (dot_product(cross_product(own_normal, other_normal), edge_vector(facets, x, f, k)) < 0) then
          facets%edge(k, f) = EDGE_CONCAVE
        else
          facets%edge(k, f) = EDGE_CONVEX
        end if
      end do
    end do
  end subroutine classify_edges


  !> Numbers the vertices: at each node one for each group of facets connected by smooth edges at this node.
  subroutine find_vertices(incidence, facets)
    type(incidence_type), intent(in) :: incidence
    type(facets_type), intent(inout) :: facets
    integer, allocatable :: stack(:)
    integer :: k, entry, next, side, n
    allocate (facets%vertex(size(facets%nodes)), source=0)
    allocate (stack(size(facets%nodes)))
    facets%n_vertices = 0
    do k = 1, size(facets%nodes)
      if (facets%vertex(k) /= 0) cycle
      facets%n_vertices = facets%n_vertices + 1
      facets%vertex(k) = facets%n_vertices
      n = 1
      stack(1) = k
      do while (n > 0)
        entry = stack(n)
        n = n - 1
        do side = 1, 2
          next = find_entry_across_edge(facets, incidence, entry, side)
          if (next == 0) cycle
          if (facets%vertex(next) /= 0) cycle
          facets%vertex(next) = facets%n_vertices
          n = n + 1
          stack(n) = next
        end do
      end do
    end do
  end subroutine find_vertices


  !> The entry of the same node in the facet across one of the node's edges, if that edge is smooth; else 0.
  pure function find_entry_across_edge(facets, incidence, entry, side) result(next)
    type(facets_type), intent(in) :: facets
    type(incidence_type), intent(in) :: incidence
    integer, intent(in) :: entry                     !< of facets%nodes
    integer, intent(in) :: side                      !< 1 or 2: a corner has two edges, a mid-side node one
    integer :: next
    integer :: f, local, n_corners, k, other
    f = incidence%owner(entry)
    local = entry - facets%first(f) + 1
    n_corners = n_facet_corners(facets%kind(f))
    next = 0
    if (is_line_facet(facets%kind(f))) then                ! a corner has its own end, the middle node none
      if (side == 2 .or. local > 2) return
      k = local
    else if (local > n_corners) then
      k = local - n_corners
    else if (side == 1) then
      k = local
    else
      k = previous_corner(local, n_corners)
    end if
    if (facets%edge(k, f) /= EDGE_SMOOTH .or. facets%is_faceted) return
    other = facets%neighbour(k, f)
    local = findloc(facets%nodes(facets%first(other):facets%first(other + 1) - 1), facets%nodes(entry), dim=1)
    if (local > 0) next = facets%first(other) + local - 1
  end function find_entry_across_edge


  !> The stars: for each vertex its facets, ascending, and the local number of the node in them.
  subroutine collect_stars(incidence, facets)
    type(incidence_type), intent(in) :: incidence
    type(facets_type), intent(inout) :: facets
    integer, allocatable :: entry(:)
    call list_groups(facets%vertex, facets%n_vertices, facets%star_first, entry)
    facets%star_facet = incidence%owner(entry)
    facets%star_local = entry - facets%first(facets%star_facet) + 1
  end subroutine collect_stars


  !> The stencils: for each facet the nodes of all facets in the stars of its vertices.
  subroutine collect_stencils(n_nodes, facets)
    integer, intent(in) :: n_nodes                   !< number of mesh nodes
    type(facets_type), intent(inout) :: facets
    integer, allocatable :: seen(:), list(:)
    integer :: f, k, s, own, n
    allocate (seen(n_nodes), source=0)
    allocate (facets%stencil_first(facets%n + 1))
    allocate (list(4 * size(facets%nodes) + 64))
    n = 0
    do f = 1, facets%n
      facets%stencil_first(f) = n + 1
      call add_nodes(facets, f, f, seen, list, n)
      own = n
      do k = facets%first(f), facets%first(f + 1) - 1
        do s = facets%star_first(facets%vertex(k)), facets%star_first(facets%vertex(k) + 1) - 1
          call add_nodes(facets, facets%star_facet(s), f, seen, list, n)
        end do
      end do
      call sort_ascending(list(own + 1:n))
    end do
    facets%stencil_first(facets%n + 1) = n + 1
    facets%stencil = list(:n)
  end subroutine collect_stencils


  !> Appends the nodes of a facet that are not marked yet; the list grows when it is full.
  pure subroutine add_nodes(facets, f, mark, seen, list, n)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f, mark
    integer, intent(inout) :: seen(:)                !< (n_nodes) last mark of each node
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: n                      !< length of the list
    integer, allocatable :: longer(:)
    integer :: k, node
    if (n + MAX_FACE_NODES > size(list)) then
      allocate (longer(2 * size(list)))
      longer(:n) = list(:n)
      call move_alloc(longer, list)
    end if
    do k = facets%first(f), facets%first(f + 1) - 1
      node = facets%nodes(k)
      if (seen(node) == mark) cycle
      seen(node) = mark
      n = n + 1
      list(n) = node
    end do
  end subroutine add_nodes


  !> Unit normal of a facet at the middle of an edge, or at the centre if it vanishes there.
  pure function edge_normal(facets, x, f, k) result(normal)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                  !< (3, n_nodes) coordinates [length]
    integer, intent(in) :: f, k                      !< facet and edge
    real(DP) :: normal(3)
    real(DP), parameter :: TRIANGLE_EDGE_MIDPOINTS(2, 3) = reshape([0.5_DP, 0.0_DP, 0.5_DP, 0.5_DP, 0.0_DP, 0.5_DP], [2, 3])
    real(DP), parameter :: QUAD_EDGE_MIDPOINTS(2, 4) = reshape(real([0, -1, 1, 0, 0, 1, -1, 0], DP), [2, 4])
    real(DP) :: tangents(3, 2)
    if (is_line_facet(facets%kind(f))) then
      call facet_tangents(facets, x, f, [real(2 * k - 3, DP), 0.0_DP], tangents)
    else if (n_facet_corners(facets%kind(f)) == 3) then
      call facet_tangents(facets, x, f, TRIANGLE_EDGE_MIDPOINTS(:, k), tangents)
    else
      call facet_tangents(facets, x, f, QUAD_EDGE_MIDPOINTS(:, k), tangents)
    end if
    normal = cross_product(tangents(:, 1), tangents(:, 2))
    if (norm2(normal) <= 1.0e-12_DP * facets%edge_length(f)**merge(1, 2, is_line_facet(facets%kind(f)))) then
      call facet_tangents(facets, x, f, facet_centre(facets%kind(f)), tangents)
      normal = cross_product(tangents(:, 1), tangents(:, 2))
    end if
    normal = normal / norm2(normal)
  end function edge_normal


  !> The direction of an edge; that of a line's end is e_z at its second, -e_z at its first corner.
  pure function edge_vector(facets, x, f, k) result(vector)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                  !< (3, n_nodes) coordinates [length]
    integer, intent(in) :: f, k                      !< facet and edge
    real(DP) :: vector(3)
    integer :: a, b
    if (is_line_facet(facets%kind(f))) then
      vector = [0.0_DP, 0.0_DP, real(2 * k - 3, DP)]
    else
      call edge_nodes(facets, f, k, a, b)
      vector = x(:, b) - x(:, a)
    end if
  end function edge_vector


  !> The mesh nodes at both ends of an edge; twice the same node for a line.
  pure subroutine edge_nodes(facets, f, k, a, b)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f, k                      !< facet and edge
    integer, intent(out) :: a, b                     !< from a to b
    integer :: start
    start = facets%first(f) - 1
    a = facets%nodes(start + k)
    b = facets%nodes(start + modulo(k, n_facet_corners(facets%kind(f))) + 1)
    if (is_line_facet(facets%kind(f))) b = a
  end subroutine edge_nodes


  !> The corner before a corner.
  pure function previous_corner(local, n_corners) result(previous)
    integer, intent(in) :: local, n_corners
    integer :: previous
    previous = modulo(local - 2, n_corners) + 1
  end function previous_corner


  !> Number of corners of a facet kind.
  pure function n_facet_corners(kind) result(n)
    integer, intent(in) :: kind                      !< FACET_...
    integer :: n
    type(facet_kind_type) :: entry
    entry = facet_kind(kind)
    n = entry%n_corners
  end function n_facet_corners


  !> Is a facet kind a line in the plane?
  elemental logical function is_line_facet(kind)
    integer, intent(in) :: kind                      !< FACET_...
    is_line_facet = kind == FACET_LINE2 .or. kind == FACET_LINE3
  end function is_line_facet


  !> The natural coordinates of a facet's centre.
  pure function facet_centre(kind) result(xi)
    integer, intent(in) :: kind                      !< FACET_...
    real(DP) :: xi(2)
    xi = merge(1.0_DP / 3.0_DP, 0.0_DP, n_facet_corners(kind) == 3)
  end function facet_centre

end module amontons_facets
