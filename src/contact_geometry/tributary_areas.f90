!> Tributary areas and area vectors of slave nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_tributary_areas
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: element_kind, facet_kind, element_kind_type, facet_kind_type, is_cohesive, is_of_revolution, &
    FACET_LINE2, &
    FACET_TRI3, FACET_QUAD4, MAX_FACE_NODES
  use amontons_mesh, only: mesh_type
  use amontons_surfaces, only: surface_type
  use amontons_shape_functions, only: facet_shapes, facet_quadrature
  implicit none
  private
  public :: find_mean_edge_length, nodal_area_fractions
  public :: element_faces_type, add_nodal_face_areas, integrate_face_area, integrate_nodal_areas, out_of_plane_depth, &
    find_slave_faces, sum_nodal_areas

  !> Faces of elements.
  type :: element_faces_type
    integer, allocatable :: element(:)             !< (n)
    integer, allocatable :: face(:)                !< (n) number in the element
  end type element_faces_type

contains

  !> Adds the areas of the nodes of one face: those of its linear face to the corners, recording the corners of its mid-side nodes;
  !! under a compliant law a share of the area to each node.
  subroutine add_nodal_face_areas(mesh, e, face, is_compliant, area_vector, area, corners)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, face
    logical, intent(in) :: is_compliant                 !< the law is compliant
    real(DP), intent(inout) :: area_vector(:, :), area(:)   !< (3, n_nodes), (n_nodes) [length^2]
    integer, intent(inout) :: corners(:, :)        !< (2, n_nodes) corners of a mid-side node, else 0
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    integer :: nodes(MAX_FACE_NODES), m, n, q, i, n_points
    real(DP) :: x(3, MAX_FACE_NODES), xi(2, 9), w(9), N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    real(DP) :: a(3)
    integer, parameter :: LINEAR_FACET(2:4) = [FACET_LINE2, FACET_TRI3, FACET_QUAD4]
    kind = element_kind(mesh%kind(e))
    shape = facet_kind(kind%face_kind(face))
    m = shape%n_corners
    n = shape%n_nodes
    nodes(:n) = mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(:n, face))
    if (is_compliant) then
      call add_nodal_areas(mesh, e, mesh%coordinates, kind%face_kind(face), nodes(:n), area_vector, area)
      return
    end if
    x(:, :m) = mesh%coordinates(:, nodes(:m))
    call facet_quadrature(LINEAR_FACET(m), n_points, xi, w)
    do q = 1, n_points
      call facet_shapes(LINEAR_FACET(m), xi(:, q), N_i, dN, ddN)
      a = cross_product(matmul(x(:, :m), dN(1, :m)), second_tangent(x(:, :m), N_i(:m), dN(2, :m), out_of_plane_depth(mesh, &
        e))) * w(q)
      do i = 1, m
        area_vector(:, nodes(i)) = area_vector(:, nodes(i)) + N_i(i) * a
        area(nodes(i)) = area(nodes(i)) + N_i(i) * norm2(a)
      end do
    end do
    do i = m + 1, n
      corners(:, nodes(i)) = [nodes(i - m), nodes(mod(i - m, m) + 1)]
    end do
  end subroutine add_nodal_face_areas


  !> Adds the shares of a face's area to its nodes.
  subroutine add_nodal_areas(mesh, e, x, kind, nodes, area_vector, area)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates of the mesh [length]
    integer, intent(in) :: kind                    !< FACET_...
    integer, intent(in) :: nodes(:)
    real(DP), intent(inout) :: area_vector(:, :), area(:)
    type(facet_kind_type) :: shape
    real(DP) :: a(3), size_of
    shape = facet_kind(kind)
    call integrate_face_area(x(:, nodes), kind, out_of_plane_depth(mesh, e), a, size_of)
    area_vector(:, nodes) = area_vector(:, nodes) + spread(a, 2, size(nodes))
    area(nodes) = area(nodes) + size_of * nodal_area_fractions(shape%n_corners, size(nodes))
  end subroutine add_nodal_areas


  !> Depth of the faces of a plane element: its thickness, of a cohesive one its width, or -1 for the full circle. Unused in space.
  pure real(DP) function out_of_plane_depth(mesh, e) result(depth)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element
    depth = mesh%section_value(e)
    if (is_cohesive(mesh%kind(e))) depth = depth / mesh%cohesive(1, e)
    if (is_of_revolution(mesh%kind(e))) depth = -1.0_DP
  end function out_of_plane_depth


  !> The second tangent of a face; that of an edge is e_z times the thickness, or times 2 pi x.
  pure function second_tangent(x, N_i, dN_2, depth) result(tangent)
    real(DP), intent(in) :: x(:, :)                !< (3, n) nodes of the face [length]
    real(DP), intent(in) :: N_i(:), dN_2(:)        !< (n) shape functions and their derivatives by xi(2) [-]
    real(DP), intent(in) :: depth                  !< from out_of_plane_depth [length]
    real(DP) :: tangent(3)
    tangent = matmul(x, dN_2)
    if (any(abs(dN_2) > 0.0_DP)) return
    tangent(3) = depth
    if (depth < 0.0_DP) tangent(3) = 2 * PI * dot_product(x(1, :), N_i)
  end function second_tangent


  !> Area of a face, as a vector and as a number.
  subroutine integrate_face_area(x, kind, depth, vector, area)
    real(DP), intent(in) :: x(:, :)                !< (3, :) of its nodes [length]
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: depth                  !< of an edge, from out_of_plane_depth [length]
    real(DP), intent(out) :: vector(3)             !< [length^2]
    real(DP), intent(out) :: area                  !< [length^2]
    real(DP) :: xi(2, 9), w(9), N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), a(3)
    integer :: q, n, n_points
    n = size(x, 2)
    vector = 0.0_DP
    area = 0.0_DP
    call facet_quadrature(kind, n_points, xi, w)
    do q = 1, n_points
      call facet_shapes(kind, xi(:, q), N_i, dN, ddN)
      a = cross_product(matmul(x, dN(1, :n)), second_tangent(x, N_i(:n), dN(2, :n), depth)) * w(q)
      vector = vector + a
      area = area + norm2(a)
    end do
  end subroutine integrate_face_area


  !> The integrals of the shape functions over a face: the nodal shares of a uniform pressure.
  pure function integrate_nodal_areas(x, kind, depth) result(areas)
    real(DP), intent(in) :: x(:, :)                !< (3, n) of its nodes [length]
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: depth                  !< of an edge, from out_of_plane_depth [length]
    real(DP) :: areas(size(x, 2))                  !< [length^2]
    real(DP) :: xi(2, 9), w(9), N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: q, n, n_points
    n = size(x, 2)
    areas = 0.0_DP
    call facet_quadrature(kind, n_points, xi, w)
    do q = 1, n_points
      call facet_shapes(kind, xi(:, q), N_i, dN, ddN)
      areas = areas + w(q) * norm2(cross_product(matmul(x, dN(1, :n)), second_tangent(x, N_i(:n), dN(2, :n), depth))) * N_i(:n)
    end do
  end function integrate_nodal_areas


  !> The faces of a slave surface. For a node-based surface, as in CalculiX: all outer faces with one of its nodes, except edges of
  !! plane elements, which CalculiX does not find after expanding them.
  subroutine find_slave_faces(mesh, surface, is_calculix, faces)
    type(mesh_type), intent(in) :: mesh
    type(surface_type), intent(in) :: surface
    logical, intent(in) :: is_calculix             !< .false.: include edges
    type(element_faces_type), intent(out) :: faces
    logical, allocatable :: is_slave(:), is_outer(:)
    integer, allocatable :: last(:), before(:)     ! of the faces found, by their smallest node
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    integer :: nodes(MAX_FACE_NODES), e, f, j, n, low
    if (.not. surface%is_node_based) then
      faces%element = surface%element
      faces%face = surface%face
      return
    end if
    allocate (is_slave(mesh%n_nodes), source=.false.)
    allocate (last(mesh%n_nodes), source=0)
    is_slave(surface%nodes) = .true.
    allocate (faces%element(0), faces%face(0), before(0), is_outer(0))
    do e = 1, mesh%n_elements
      if (.not. any(is_slave(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)))) cycle
      kind = element_kind(mesh%kind(e))
      do f = 1, kind%n_faces
        shape = facet_kind(kind%face_kind(f))
        n = shape%n_corners
        if (is_calculix .and. n == 2) cycle
        nodes(:n) = mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(:n, f))
        low = minval(nodes(:n))
        j = last(low)
        do while (j > 0)
          if (is_same_face(mesh, faces%element(j), faces%face(j), nodes(:n))) exit
          j = before(j)
        end do
        if (j > 0) is_outer(j) = .false.
        if (j > 0) cycle
        faces%element = [faces%element, e]
        faces%face = [faces%face, f]
        is_outer = [is_outer, any(is_slave(nodes(:n)))]
        before = [before, last(low)]
        last(low) = size(before)
      end do
    end do
    faces%element = pack(faces%element, is_outer)
    faces%face = pack(faces%face, is_outer)
  end subroutine find_slave_faces


  !> Whether a face has the given corners.
  pure logical function is_same_face(mesh, e, f, corners)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, f                    !< element and face number
    integer, intent(in) :: corners(:)
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    integer :: i
    kind = element_kind(mesh%kind(e))
    shape = facet_kind(kind%face_kind(f))
    is_same_face = shape%n_corners == size(corners)
    if (.not. is_same_face) return
    is_same_face = all([(any(corners == mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(i, f))), i=1, size(corners))])
  end function is_same_face


  !> Adds the shares of all faces to their nodes.
  subroutine sum_nodal_areas(mesh, surface, x, area_vector, area, is_absent)
    type(mesh_type), intent(in) :: mesh
    type(element_faces_type), intent(in) :: surface
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(inout) :: area_vector(:, :), area(:)   !< (3, n_nodes), (n_nodes) [length^2]
    logical, intent(in), optional :: is_absent(:)  !< (n_elements) their faces do not count
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    integer :: nodes(MAX_FACE_NODES), f, n
    do f = 1, size(surface%element)
      if (present(is_absent)) then
        if (is_absent(surface%element(f))) cycle
      end if
      kind = element_kind(mesh%kind(surface%element(f)))
      shape = facet_kind(kind%face_kind(surface%face(f)))
      n = shape%n_nodes
      nodes(:n) = mesh%nodes(mesh%first(surface%element(f)) - 1 + kind%face_nodes(:n, surface%face(f)))
      call add_nodal_areas(mesh, surface%element(f), x, kind%face_kind(surface%face(f)), nodes(:n), area_vector, area)
    end do
  end subroutine sum_nodal_areas


  !> The mean edge of the faces of a surface; for a node-based surface a default [length].
  pure real(DP) function find_mean_edge_length(mesh, surface, otherwise) result(edge)
    type(mesh_type), intent(in) :: mesh
    type(surface_type), intent(in) :: surface
    real(DP), intent(in) :: otherwise              !< [length]
    type(element_kind_type) :: entry
    type(facet_kind_type) :: shape
    real(DP) :: total
    integer :: f, k, n, n_edges, nodes(MAX_FACE_NODES)
    edge = otherwise
    total = 0.0_DP
    n_edges = 0
    do f = 1, size(surface%element)
      entry = element_kind(mesh%kind(surface%element(f)))
      shape = facet_kind(entry%face_kind(surface%face(f)))
      n = shape%n_corners
      nodes(:n) = mesh%nodes(mesh%first(surface%element(f)) - 1 + entry%face_nodes(:n, surface%face(f)))
      do k = 1, merge(1, n, n == 2)
        total = total + norm2(mesh%coordinates(:, nodes(modulo(k, n) + 1)) - mesh%coordinates(:, nodes(k)))
        n_edges = n_edges + 1
      end do
    end do
    if (n_edges > 0) edge = total / real(n_edges, DP)
  end function find_mean_edge_length


  !> Fractions of a face's area at its nodes, as in CalculiX: none is negative.
  pure function nodal_area_fractions(n_corners, n_nodes) result(share)
    integer, intent(in) :: n_corners, n_nodes
    real(DP) :: share(n_nodes)                     !< [-]
    share = 1.0_DP / real(n_corners, DP)
    if (n_nodes == n_corners) return
    select case (n_corners)
    case (2)                                       ! an edge of 3 nodes becomes a face of 8 in CalculiX
      share = [0.26_DP, 0.26_DP, 0.48_DP]
    case (3)
      share = [0.003_DP, 0.003_DP, 0.003_DP, 0.997_DP, 0.997_DP, 0.997_DP] / 3.0_DP
    case default
      share = 0.24_DP
      share(:4) = 0.01_DP
    end select
  end function nodal_area_fractions

end module amontons_tributary_areas
