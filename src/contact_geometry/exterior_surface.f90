!> Exterior of the mesh: the faces that no other element shares, with the body, the smooth patch and the geometry of each.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Two faces are the same if their corners are; nodes on both sides of a pre-tension section count as one. A *body* is a set of
!! elements with faces that are connected by nodes. Membranes and rigid edges do not count. A *patch* is a piece of the exterior
!! without a crease: faces are connected across an edge that exactly two of them have, if their normals differ by less than the
!! feature angle.
!! Cost: linear.
module amontons_exterior_surface
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_containers, only: find_root, unite_trees
  use amontons_element_kinds, only: element_kind, element_kind_type, facet_kind, facet_kind_type, is_two_sided, MAX_FACE_NODES
  use amontons_mesh, only: mesh_type
  use amontons_facets, only: facets_type, facet_nodes, n_facet_corners
  implicit none
  private
  public :: exterior_type, build_exterior, measure_faces, depths_below, common_depth, reached_depth, is_thin, has_area

  real(DP), parameter :: FEATURE_ANGLE = PI / 4            !< a sharper edge is a crease [rad]
  integer, parameter :: MAX_FACE_CORNERS = 4
  real(DP), parameter :: THIN_RATIO = 1.0e-5_DP             !< depth over the edge: no depth; rigid elements have 1e-6 [-]

  !> The exterior faces.
  type :: exterior_type
    integer :: n = 0
    integer :: n_bodies = 0
    integer :: n_patches = 0
    integer, allocatable :: element(:), face(:)    !< (n) element index and number of the face in it
    integer, allocatable :: first(:)               !< (n + 1) start of a face's nodes in nodes(:)
    integer, allocatable :: nodes(:)               !< corners, then mid-sides, outward by the right-hand rule
    integer, allocatable :: n_corners(:)           !< (n)
    integer, allocatable :: body(:)                !< (n) numbered in the order of the faces
    integer, allocatable :: patch(:)               !< (n) numbered in the order of the faces
    integer, allocatable :: body_of_element(:)     !< (n_elements) 0: an element without faces
    real(DP), allocatable :: centre(:, :)          !< (3, n) mean of the corners [length]
    real(DP), allocatable :: normal(:, :)          !< (3, n) outward unit normal of the mean plane; 0: no area [-]
    real(DP), allocatable :: box(:, :, :)          !< (3, 2, n) lower and upper corner [length]
    real(DP), allocatable :: edge_length(:)        !< (n) of the longest edge [length]
    real(DP), allocatable :: area(:)               !< (n) [length^2]; of an edge of a plane element its length
    real(DP), allocatable :: depth(:)              !< (n) of the element below the face [length]
    real(DP), allocatable :: thickness(:)          !< (n) of the body below the face, if measured (`body_thickness`) [length]
    real(DP), allocatable :: height(:)             !< (n) of the surface in contact above the face; 0 from `build_exterior` [length]
    real(DP), allocatable :: x(:, :)               !< (3, n_nodes) coordinates at which it is measured [length]
  end type exterior_type

contains

  !> Finds the exterior faces of the elements present, their bodies and patches, and measures them at the reference coordinates.
  subroutine build_exterior(mesh, is_absent, node_pairs, exterior)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)            !< (n_elements)
    integer, intent(in) :: node_pairs(:, :)             !< (2, :) pairs of nodes that count as one; may be empty
    type(exterior_type), intent(out) :: exterior
    integer, allocatable :: same_node(:)
    integer :: i
    same_node = [(i, i=1, mesh%n_nodes)]
    do i = 1, size(node_pairs, 2)
      call unite_trees(same_node, node_pairs(1, i), node_pairs(2, i))
    end do
    same_node = [(find_root(same_node, i), i=1, mesh%n_nodes)]
    call find_exterior_faces(mesh, is_absent, same_node, exterior)
    call find_bodies(mesh, is_absent, same_node, exterior)
    call measure_faces(mesh, mesh%coordinates, exterior)
    allocate (exterior%height(exterior%n), source=0.0_DP)
    call find_patches(same_node, exterior)
  end subroutine build_exterior


  !> Lists the faces that only one element has.
  subroutine find_exterior_faces(mesh, is_absent, same_node, exterior)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)
    integer, intent(in) :: same_node(:)            !< (n_nodes) the node that stands for it
    type(exterior_type), intent(inout) :: exterior
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    integer, allocatable :: keys(:, :), element(:), face(:), partner(:)
    integer :: e, k, n, f, nodes(MAX_FACE_NODES)
    n = 0
    do e = 1, mesh%n_elements
      kind = element_kind(mesh%kind(e))
      if (.not. (is_absent(e) .or. is_two_sided(mesh%kind(e)))) n = n + kind%n_faces
    end do
    allocate (keys(MAX_FACE_CORNERS, n), source=0)
    allocate (element(n), face(n))
    n = 0
    do e = 1, mesh%n_elements
      kind = element_kind(mesh%kind(e))
      if (is_absent(e) .or. is_two_sided(mesh%kind(e))) cycle
      do k = 1, kind%n_faces
        n = n + 1
        shape = facet_kind(kind%face_kind(k))
        element(n) = e
        face(n) = k
        nodes(:shape%n_corners) = mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(:shape%n_corners, k))
        keys(:, n) = face_key(same_node(nodes(:shape%n_corners)))
      end do
    end do
    call match_keys(keys, size(same_node), partner)
    exterior%element = pack(element, partner == 0)
    exterior%face = pack(face, partner == 0)
    exterior%n = size(exterior%face)
    allocate (exterior%first(exterior%n + 1), exterior%n_corners(exterior%n), exterior%nodes(MAX_FACE_NODES * exterior%n))
    exterior%first(1) = 1
    do f = 1, exterior%n
      kind = element_kind(mesh%kind(exterior%element(f)))
      shape = facet_kind(kind%face_kind(exterior%face(f)))
      exterior%n_corners(f) = shape%n_corners
      exterior%first(f + 1) = exterior%first(f) + shape%n_nodes
      exterior%nodes(exterior%first(f):exterior%first(f + 1) - 1) = mesh%nodes(mesh%first(exterior%element(f)) - 1 &
        + kind%face_nodes(:shape%n_nodes, exterior%face(f)))
    end do
    exterior%nodes = exterior%nodes(:exterior%first(exterior%n + 1) - 1)
  end subroutine find_exterior_faces


  !> The corners of a face in ascending order, each once, filled up by zeros. (A collapsed quadrilateral is a triangle.)
  pure function face_key(corners) result(key)
    integer, intent(in) :: corners(:)
    integer :: key(MAX_FACE_CORNERS), i, k, n, item
    key = 0
    n = 0
    do i = 1, size(corners)
      item = corners(i)
      if (any(key(:n) == item)) cycle
      k = n + 1
      do while (k > 1)
        if (key(k - 1) <= item) exit
        key(k) = key(k - 1)
        k = k - 1
      end do
      key(k) = item
      n = n + 1
    end do
  end function face_key


  !> For each key an equal one of another position; 0: none, -1: more than one. Method: buckets by the first entry.
  subroutine match_keys(keys, n_nodes, partner)
    integer, intent(in) :: keys(:, :)              !< (:, n) the first entry from 1 to n_nodes
    integer, intent(in) :: n_nodes
    integer, allocatable, intent(out) :: partner(:)   !< (n)
    integer :: first(n_nodes + 1), next(n_nodes), order(size(keys, 2)), i, k, a, b
    allocate (partner(size(keys, 2)), source=0)
    first = 0
    do i = 1, size(keys, 2)
      first(keys(1, i) + 1) = first(keys(1, i) + 1) + 1
    end do
    first(1) = 1
    do k = 1, n_nodes
      first(k + 1) = first(k + 1) + first(k)
    end do
    next = first(:n_nodes)
    do i = 1, size(keys, 2)
      order(next(keys(1, i))) = i
      next(keys(1, i)) = next(keys(1, i)) + 1
    end do
    do k = 1, n_nodes
      do a = first(k), first(k + 1) - 2
        do b = a + 1, first(k + 1) - 1
          if (any(keys(:, order(a)) /= keys(:, order(b)))) cycle
          partner(order(a)) = merge(order(b), -1, partner(order(a)) == 0)
          partner(order(b)) = merge(order(a), -1, partner(order(b)) == 0)
        end do
      end do
    end do
  end subroutine match_keys


  !> Numbers the bodies.
  subroutine find_bodies(mesh, is_absent, same_node, exterior)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)
    integer, intent(in) :: same_node(:)
    type(exterior_type), intent(inout) :: exterior
    type(element_kind_type) :: kind
    integer, allocatable :: parent(:), number(:)
    integer :: e, i, f, root
    parent = [(i, i=1, mesh%n_nodes)]
    allocate (exterior%body_of_element(mesh%n_elements), number(mesh%n_nodes), source=0)
    do e = 1, mesh%n_elements
      kind = element_kind(mesh%kind(e))
      if (is_absent(e) .or. kind%n_faces == 0) cycle
      do i = mesh%first(e) + 1, mesh%first(e + 1) - 1
        call unite_trees(parent, same_node(mesh%nodes(mesh%first(e))), same_node(mesh%nodes(i)))
      end do
    end do
    allocate (exterior%body(exterior%n))
    do f = 1, exterior%n
      root = find_root(parent, same_node(exterior%nodes(exterior%first(f))))
      if (number(root) == 0) then
        exterior%n_bodies = exterior%n_bodies + 1
        number(root) = exterior%n_bodies
      end if
      exterior%body(f) = number(root)
    end do
    do e = 1, mesh%n_elements
      kind = element_kind(mesh%kind(e))
      if (is_absent(e) .or. kind%n_faces == 0) cycle
      exterior%body_of_element(e) = number(find_root(parent, same_node(mesh%nodes(mesh%first(e)))))
    end do
  end subroutine find_bodies


  !> Centres, normals, boxes, edges, areas and depths of the faces at coordinates x.
  pure subroutine measure_faces(mesh, x, exterior)
    type(mesh_type), intent(in) :: mesh
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    type(exterior_type), intent(inout) :: exterior
    real(DP) :: corner(3, MAX_FACE_CORNERS), area_vector(3)
    integer :: f, k, m
    if (.not. allocated(exterior%centre)) allocate (exterior%centre(3, exterior%n), exterior%normal(3, exterior%n), &
      exterior%box(3, 2, exterior%n), exterior%edge_length(exterior%n), exterior%area(exterior%n), exterior%depth(exterior%n))
    do f = 1, exterior%n
      m = exterior%n_corners(f)
      associate (nodes => exterior%nodes(exterior%first(f):exterior%first(f + 1) - 1))
        corner(:, :m) = x(:, nodes(:m))
        exterior%centre(:, f) = sum(corner(:, :m), dim=2) / real(m, DP)
        exterior%box(:, 1, f) = minval(x(:, nodes), dim=2)
        exterior%box(:, 2, f) = maxval(x(:, nodes), dim=2)
      end associate
      exterior%edge_length(f) = maxval([(norm2(corner(:, modulo(k, m) + 1) - corner(:, k)), k=1, m)])
      area_vector = face_area_vector(corner(:, :m))
      exterior%area(f) = norm2(area_vector)
      exterior%normal(:, f) = area_vector / max(exterior%area(f), tiny(1.0_DP))
      exterior%depth(f) = face_depth(mesh, x, exterior%element(f), exterior%centre(:, f), exterior%normal(:, f))
    end do
    exterior%x = x
  end subroutine measure_faces


  !> The area of a face times its outward normal; of an edge of a plane element its length.
  pure function face_area_vector(corner) result(vector)
    real(DP), intent(in) :: corner(:, :)           !< (3, 2 to 4) [length]
    real(DP) :: vector(3)                          !< [length^2]
    select case (size(corner, 2))
    case (2)
      vector = cross_product(corner(:, 2) - corner(:, 1), [0.0_DP, 0.0_DP, 1.0_DP])
    case (3)
      vector = 0.5_DP * cross_product(corner(:, 2) - corner(:, 1), corner(:, 3) - corner(:, 1))
    case default
      vector = 0.5_DP * cross_product(corner(:, 3) - corner(:, 1), corner(:, 4) - corner(:, 2))
    end select
  end function face_area_vector


  !> The depth of an element below one of its faces: twice the distance of its centre. Of a hexahedron it is the thickness, of a
  !! tetrahedron half the height.
  pure real(DP) function face_depth(mesh, x, e, centre, normal) result(depth)
    type(mesh_type), intent(in) :: mesh
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: e                       !< element
    real(DP), intent(in) :: centre(3), normal(3)   !< of the face [length], [-]
    associate (nodes => mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))
      depth = 2 * abs(dot_product(normal, centre - sum(x(:, nodes), dim=2) / real(size(nodes), DP)))
    end associate
  end function face_depth


  !> Whether an element has no depth worth the name below a face, as rigid elements.
  elemental logical function is_thin(depth, edge)
    real(DP), intent(in) :: depth                  !< [length]
    real(DP), intent(in) :: edge                   !< longest of the face [length]
    is_thin = depth < THIN_RATIO * edge
  end function is_thin


  !> Whether a face has an area worth the name. The edges of rigid elements have none: they touch nothing.
  elemental logical function has_area(n_corners, area, edge)
    integer, intent(in) :: n_corners               !< 2: an edge of a plane element, which has
    real(DP), intent(in) :: area                   !< [length^2]
    real(DP), intent(in) :: edge                   !< longest of the face [length]
    has_area = n_corners == 2 .or. area >= THIN_RATIO * edge**2
  end function has_area


  !> How deep a slave may lie behind a face and see it: the depth of the face; of a thin one half the depth of the slave, which
  !! then does not see both sides.
  elemental real(DP) function common_depth(depth, edge, slave_depth) result(seen)
    real(DP), intent(in) :: depth                  !< below the face [length]
    real(DP), intent(in) :: edge                   !< longest of the face [length]
    real(DP), intent(in) :: slave_depth            !< [length]
    seen = depth
    if (is_thin(depth, edge)) seen = max(depth, 0.5_DP * slave_depth)
  end function common_depth


  !> How deep a face of another body may reach behind a face: by the element there, or by its own longest edge, because a coarse
  !! face lies between its nodes behind many fine elements; but not through the body.
  elemental real(DP) function reached_depth(depth, thickness, other_edge) result(reached)
    real(DP), intent(in) :: depth, thickness       !< of the element and of the body below the face [length]
    real(DP), intent(in) :: other_edge             !< longest of the other face [length]
    reached = max(depth, min(thickness, other_edge))
  end function reached_depth


  !> The depths of the elements below facets, in the reference configuration [length].
  pure function depths_below(mesh, facets) result(depth)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    real(DP) :: depth(facets%n)
    real(DP) :: vector(3)
    integer :: f, n, m, nodes(MAX_FACE_NODES)
    do f = 1, facets%n
      call facet_nodes(facets, f, n, nodes)
      m = n_facet_corners(facets%kind(f))
      vector = face_area_vector(mesh%coordinates(:, nodes(:m)))
      depth(f) = face_depth(mesh, mesh%coordinates, facets%element(f), sum(mesh%coordinates(:, nodes(:m)), dim=2) / real(m, DP), &
        vector / max(norm2(vector), tiny(1.0_DP)))
    end do
  end function depths_below


  !> Numbers the patches.
  subroutine find_patches(same_node, exterior)
    integer, intent(in) :: same_node(:)
    type(exterior_type), intent(inout) :: exterior
    integer, allocatable :: keys(:, :), owner(:), partner(:), parent(:), number(:)
    integer :: f, k, n, m, a, b
    n = sum(exterior%n_corners)
    allocate (keys(2, n), owner(n))
    n = 0
    do f = 1, exterior%n
      m = exterior%n_corners(f)
      do k = 1, m
        n = n + 1
        a = same_node(exterior%nodes(exterior%first(f) + k - 1))
        b = same_node(exterior%nodes(exterior%first(f) + modulo(k, m)))
        if (m == 2) b = a                          ! the edges of a line are its ends
        keys(:, n) = [min(a, b), max(a, b)]
        owner(n) = f
      end do
    end do
    call match_keys(keys, size(same_node), partner)
    parent = [(f, f=1, exterior%n)]
    do k = 1, n
      if (partner(k) <= 0) cycle
      if (exterior%n_corners(owner(k)) > 2 .and. keys(1, k) == keys(2, k)) cycle   ! a collapsed edge
      associate (f1 => owner(k), f2 => owner(partner(k)))
        if (dot_product(exterior%normal(:, f1), exterior%normal(:, f2)) > cos(FEATURE_ANGLE)) call unite_trees(parent, f1, f2)
      end associate
    end do
    allocate (exterior%patch(exterior%n))
    allocate (number(exterior%n), source=0)
    do f = 1, exterior%n
      k = find_root(parent, f)
      if (number(k) == 0) then
        exterior%n_patches = exterior%n_patches + 1
        number(k) = exterior%n_patches
      end if
      exterior%patch(f) = number(k)
    end do
  end subroutine find_patches

end module amontons_exterior_surface
