!> Integration points on the intersections of slave and master faces, for face-to-face penalty contact.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 8. The nodes of a slave face and of the master faces in front of it are projected on a
!! plane normal to the mean normal of the slave face; the polygons are intersected there. Each intersection is divided into
!! triangles about the mean of its corners, in the natural coordinates of the slave face, and each triangle has a rule of seven
!! points that is exact for degree 5 (J. Radon, Monatsh. Math. 52 (1948) 286-300). The master point of an integration point is the
!! nearest point of the master face.
!!
!! A line of a plane model is extruded to a face of depth 1, or of a wedge of two degrees if axisymmetric, and is intersected like
!! the solid into which CalculiX expands it.
module amontons_face_intersection_points
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, FACET_LINE2, MAX_FACE_NODES, N_CIRCLE_SECTORS
  use amontons_shape_functions, only: facet_shapes, facet_node_coordinates
  use amontons_facets, only: is_absent_facet, facets_type, facet_nodes, facet_tangents, is_line_facet
  use amontons_facet_search, only: facet_search_type, find_near_facets
  use amontons_mortar_segmentation, only: MIN_FACING_COSINE, MAX_SEGMENT_OVERLAP, MIN_SEGMENT_AREA
  use amontons_polygon_clipping, only: find_flat_coordinates, clip_polygon, signed_polygon_area, MAX_POLYGON_CORNERS
  implicit none
  private
  public :: facing_point_type, find_facing_points, evaluate_face_normal

  integer, parameter :: MAX_PROJECTION_ITERATIONS = 30       !< of Newton's method for the natural coordinates of a point
  real(DP), parameter :: MIN_TRIANGLE_AREA = 1.0e-4_DP  !< triangles with less area in natural coordinates are omitted, as in
                                                        !! CalculiX [-]
  real(DP), parameter :: HALF_WEDGE_ANGLE = PI / N_CIRCLE_SECTORS   !< of the solid into which CalculiX expands an axisymmetric
                                                                    !! element [rad]
  integer, parameter :: N_TRIANGLE_POINTS = 7                 !< points in a triangle

  !> One integration point of a slave face and its master point.
  type :: facing_point_type
    integer :: slave = 0                           !< facet
    integer :: master = 0                          !< facet
    real(DP) :: at(2) = 0  !< natural coordinates on the slave facet; for a line the second one is along its depth [-]
    real(DP) :: xi(2) = 0                          !< natural coordinates on the master facet [-]
    real(DP) :: area = 0                           !< [length^2]
  end type facing_point_type

  !> Geometry of a face in space.
  type :: face_geometry_type
    integer :: kind = 0                            !< FACET_... of a face with area
    integer :: n = 0                               !< nodes
    integer :: first = 1                           !< corner at which its outline begins in CalculiX's numbering
    real(DP) :: x(3, MAX_FACE_NODES) = 0           !< [length]
    real(DP) :: origin(3) = 0                      !< of the plane through it [length]
    real(DP) :: axes(3, 2) = 0                     !< unit vectors in the plane
    real(DP) :: normal(3) = 0                      !< mean unit normal
  end type face_geometry_type

  !> Intersection of a slave face with one master face.
  type :: face_cut_type
    integer :: master = 0                          !< facet
    integer :: n = 0                               !< corners
    real(DP) :: corners(2, MAX_POLYGON_CORNERS) = 0        !< in the plane of the slave face [length]
    real(DP) :: distance = 0                       !< from its middle to the master face, along the normal [length]
  end type face_cut_type

contains

  !> All integration points of a slave surface, slave facet by slave facet. Cost: linear in the number of intersections.
  subroutine find_facing_points(slave, depth, master, search, x, search_distance, points, n)
    type(facets_type), intent(in) :: slave, master
    real(DP), intent(in) :: depth(:)               !< (slave%n) of lines: thickness [length], -1: the full circle; else 1
    type(facet_search_type), intent(in) :: search  !< of the master's facets; its margin is at least the search margin from the
                                                   !! middle of a slave facet
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    real(DP), intent(in) :: search_distance                  !< larger distances between facets are ignored [length]
    type(facing_point_type), allocatable, intent(out) :: points(:)   !< the first n are set
    integer, intent(out) :: n
    type(face_geometry_type) :: geometry, master_geometry
    type(face_cut_type), allocatable :: cuts(:)
    integer, allocatable :: list(:)
    integer :: f, k, n_list, n_cuts
    allocate (points(64), cuts(16))
    n = 0
    do f = 1, slave%n
      if (is_absent_facet(slave, f)) cycle
      call build_face_geometry(slave, f, x, depth(f), geometry)
      call find_near_facets(search, geometry%origin, list, n_list)
      call sort_by_element_face(master, list(:n_list))
      n_cuts = 0
      do k = 1, n_list
        call build_face_geometry(master, list(k), x, depth(f), master_geometry)
        call intersect_faces(geometry, master_geometry, list(k), search_distance, cuts, n_cuts)
      end do
      call drop_hidden_cuts(geometry, cuts, n_cuts)
      do k = 1, n_cuts
        if (cuts(k)%n < 3) cycle
        call build_face_geometry(master, cuts(k)%master, x, depth(f), master_geometry)
        call append_cut_points(geometry, f, is_line_facet(slave%kind(f)), depth(f), master_geometry, cuts(k), points, n)
      end do
    end do
  end subroutine find_facing_points


  !> The geometry of a facet, with the plane through the mean of its nodes normal to the mean of its unit normals there.
  pure subroutine build_face_geometry(facets, f, x, depth, geometry)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                       !< facet
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: depth                  !< of a line: negative is the full circle
    type(face_geometry_type), intent(out) :: geometry
    real(DP) :: xi(2, MAX_FACE_NODES), tangents(3, 2), v(3)
    integer :: i, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, geometry%n, nodes)
    geometry%kind = facets%kind(f)
    if ((geometry%kind == FACET_QUAD4 .or. geometry%kind == FACET_QUAD8) .and. facets%face(f) == 1) geometry%first = 2
    if ((geometry%kind == FACET_TRI3 .or. geometry%kind == FACET_TRI6) .and. facets%face(f) == 4) geometry%first = 2
    geometry%x(:, :geometry%n) = x(:, nodes(:geometry%n))
    if (is_line_facet(geometry%kind)) call extrude_line(geometry, depth < 0.0_DP)
    call facet_node_coordinates(geometry%kind, xi)
    do i = 1, geometry%n
      tangents = evaluate_tangents(geometry, xi(:, i))
      v = cross_product(tangents(:, 1), tangents(:, 2))
      geometry%normal = geometry%normal + v / max(norm2(v), tiny(1.0_DP))
    end do
    geometry%normal = geometry%normal / max(norm2(geometry%normal), tiny(1.0_DP))
    geometry%origin = sum(geometry%x(:, :geometry%n), dim=2) / real(geometry%n, DP)
    v = geometry%x(:, 2) - geometry%x(:, 1)
    v = v - dot_product(geometry%normal, v) * geometry%normal
    geometry%axes(:, 1) = v / max(norm2(v), tiny(1.0_DP))
    geometry%axes(:, 2) = cross_product(geometry%normal, geometry%axes(:, 1))
  end subroutine build_face_geometry


  !> Extrudes a line to a face of depth 1, or of the wedge; its first natural coordinate is unchanged.
  pure subroutine extrude_line(geometry, is_wedge)
    type(face_geometry_type), intent(inout) :: geometry
    logical, intent(in) :: is_wedge
    real(DP) :: line(3, 3), half(3)
    line = geometry%x(:, :3)
    half = 0.5_DP
    if (is_wedge) half = sin(HALF_WEDGE_ANGLE) * line(1, :)
    if (geometry%kind == FACET_LINE2) then
      geometry%kind = FACET_QUAD4
      geometry%n = 4
    else
      geometry%kind = FACET_QUAD8
      geometry%n = 8
      geometry%x(:, 5:8) = line(:, [3, 2, 3, 1])
      geometry%x(3, 5:8) = [-half(3), 0.0_DP, half(3), 0.0_DP]
    end if
    geometry%x(:, :4) = line(:, [1, 2, 2, 1])
    geometry%x(3, :4) = [-half(1), -half(2), half(2), half(1)]
  end subroutine extrude_line


  !> The tangents of a face at natural coordinates.
  pure function evaluate_tangents(geometry, xi) result(tangents)
    type(face_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: xi(2)                  !< [-]
    real(DP) :: tangents(3, 2)                     !< [length]
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    call facet_shapes(geometry%kind, xi, N, dN, ddN)
    tangents = matmul(geometry%x(:, :geometry%n), transpose(dN(:, :geometry%n)))
  end function evaluate_tangents


  !> A point of a face.
  pure function evaluate_point(geometry, xi) result(point)
    type(face_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: xi(2)                  !< [-]
    real(DP) :: point(3)                           !< [length]
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    call facet_shapes(geometry%kind, xi, N, dN, ddN)
    point = matmul(geometry%x(:, :geometry%n), N(:geometry%n))
  end function evaluate_point


  !> The nodes around a face in order: each corner and the mid-side node after it.
  pure function list_outline(geometry) result(outline)
    type(face_geometry_type), intent(in) :: geometry
    integer, allocatable :: outline(:)
    select case (geometry%kind)
    case (FACET_TRI3)
      outline = [1, 2, 3]
    case (FACET_QUAD4)
      outline = [1, 2, 3, 4]
    case (FACET_TRI6)
      outline = [1, 4, 2, 5, 3, 6]
    case default
      outline = [1, 5, 2, 6, 3, 7, 4, 8]
    end select
    outline = cshift(outline, (geometry%first - 1) * merge(2, 1, geometry%n > 4))
  end function list_outline


  !> The convex pieces of a master face in the plane: a quadratic face has one at each corner and one in the middle.
  pure subroutine list_convex_pieces(kind, pieces, n)
    integer, intent(in) :: kind                    !< FACET_... of a face with area
    integer, intent(out) :: pieces(4, 5)           !< local nodes; 0 as the fourth: a triangle
    integer, intent(out) :: n
    pieces = 0
    select case (kind)
    case (FACET_TRI3)
      n = 1
      pieces(:3, 1) = [1, 2, 3]
    case (FACET_QUAD4)
      n = 1
      pieces(:, 1) = [1, 2, 3, 4]
    case (FACET_TRI6)
      n = 4
      pieces(:3, :4) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3, 4, 5, 6], [3, 4])
    case default
      n = 5
      pieces = reshape([1, 5, 8, 0, 5, 2, 6, 0, 6, 3, 7, 0, 7, 4, 8, 0, 5, 6, 7, 8], [4, 5])
    end select
  end subroutine list_convex_pieces


  !> Local nodes of a face, numbered from the corner at which its outline begins.
  pure function renumber_nodes(geometry, nodes) result(numbered)
    type(face_geometry_type), intent(in) :: geometry
    integer, intent(in) :: nodes(:)                !< corners, then mid-sides
    integer :: numbered(size(nodes))
    integer :: m
    m = merge(3, 4, geometry%kind == FACET_TRI3 .or. geometry%kind == FACET_TRI6)
    numbered = merge(modulo(nodes + geometry%first - 2, m) + 1, m + modulo(nodes - m + geometry%first - 2, m) + 1, nodes <= m)
  end function renumber_nodes


  !> Facets in the order of elements and faces.
  pure subroutine sort_by_element_face(facets, list)
    type(facets_type), intent(in) :: facets
    integer, intent(inout) :: list(:)
    integer :: i, k, f
    do i = 2, size(list)
      f = list(i)
      do k = i - 1, 1, -1
        if (facets%element(list(k)) < facets%element(f)) exit
        if (facets%element(list(k)) == facets%element(f) .and. facets%face(list(k)) <= facets%face(f)) exit
        list(k + 1) = list(k)
      end do
      list(k + 1) = f
    end do
  end subroutine sort_by_element_face


  !> Appends the intersections of a slave face with the pieces of one master face.
  subroutine intersect_faces(geometry, master_geometry, g, search_distance, cuts, n)
    type(face_geometry_type), intent(in) :: geometry, master_geometry   !< slave, master
    integer, intent(in) :: g                       !< the master's facet
    real(DP), intent(in) :: search_distance                  !< [length]
    type(face_cut_type), allocatable, intent(inout) :: cuts(:)
    integer, intent(inout) :: n                    !< intersections so far
    type(face_cut_type) :: cut
    real(DP) :: own(2, MAX_FACE_NODES), window(2, 4)
    integer :: pieces(4, 5), n_pieces, k, m
    if (dot_product(master_geometry%normal, geometry%normal) > -MIN_FACING_COSINE) return
    own(:, :geometry%n) = project_on_plane(geometry, geometry%x(:, list_outline(geometry)))
    call list_convex_pieces(master_geometry%kind, pieces, n_pieces)
    cut%master = g
    own(2, :) = -own(2, :)                         ! seen from the master its corners run counter-clockwise
    do k = 1, n_pieces
      m = count(pieces(:, k) > 0)
      window(:, :m) = project_on_plane(geometry, master_geometry%x(:, renumber_nodes(master_geometry, pieces(:m, k))))
      window(2, :m) = -window(2, :m)
      if (any(minval(own(:, :geometry%n), dim=2) > maxval(window(:, :m), dim=2))) cycle
      if (any(maxval(own(:, :geometry%n), dim=2) < minval(window(:, :m), dim=2))) cycle
      call clip_polygon(own(:, :geometry%n), window(:, :m), cut%corners, cut%n)
      if (cut%n < 3) cycle
      if (abs(signed_polygon_area(cut%corners(:, :cut%n))) <= MIN_SEGMENT_AREA * &
        abs(signed_polygon_area(own(:, :geometry%n)))) cycle
      cut%corners(2, :) = -cut%corners(2, :)
      cut%distance = find_face_distance(geometry, master_geometry, sum(cut%corners(:, :cut%n), dim=2) / real(cut%n, DP))
      if (abs(cut%distance) > search_distance) cycle
      if (n == size(cuts)) cuts = [cuts, cuts]
      n = n + 1
      cuts(n) = cut
    end do
  end subroutine intersect_faces


  !> Points in plane coordinates of a face.
  pure function project_on_plane(geometry, x) result(p)
    type(face_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: x(:, :)                !< (3, n) [length]
    real(DP) :: p(2, size(x, 2))                   !< [length]
    p = matmul(transpose(geometry%axes), x - spread(geometry%origin, 2, size(x, 2)))
  end function project_on_plane


  !> The distance of two faces over a point of the plane of the first.
  pure real(DP) function find_face_distance(geometry, master_geometry, q) result(distance)
    type(face_geometry_type), intent(in) :: geometry, master_geometry
    real(DP), intent(in) :: q(2)                   !< in the plane of `geometry` [length]
    distance = dot_product(geometry%normal, evaluate_point(master_geometry, find_natural_coordinates(master_geometry, geometry, &
      q)) &
      - evaluate_point(geometry, find_natural_coordinates(geometry, geometry, q)))
  end function find_face_distance


  !> Resolves master faces one behind the other: intersections that overlap a nearer one are dropped (n = 0).
  subroutine drop_hidden_cuts(geometry, cuts, n_cuts)
    type(face_geometry_type), intent(in) :: geometry
    type(face_cut_type), intent(inout) :: cuts(:)
    integer, intent(in) :: n_cuts
    logical :: is_done(n_cuts), is_kept(n_cuts)
    real(DP) :: own(2, MAX_FACE_NODES), common(2, MAX_POLYGON_CORNERS), covered, area
    integer :: i, j, k, n
    own(:, :geometry%n) = project_on_plane(geometry, geometry%x(:, list_outline(geometry)))
    area = signed_polygon_area(own(:, :geometry%n))
    covered = 0.0_DP
    do i = 1, n_cuts
      covered = covered + signed_polygon_area(cuts(i)%corners(:, :cuts(i)%n))
    end do
    if (covered <= (1 + MAX_SEGMENT_OVERLAP) * area) return
    is_done = .false.
    is_kept = .false.
    do k = 1, n_cuts
      i = minloc(abs(cuts(:n_cuts)%distance), dim=1, mask=.not. is_done)
      is_done(i) = .true.
      is_kept(i) = .true.
      do j = 1, n_cuts
        if (.not. is_kept(j) .or. j == i) cycle
        call clip_polygon(cuts(i)%corners(:, :cuts(i)%n), cuts(j)%corners(:, :cuts(j)%n), common, n)
        if (n >= 3) is_kept(i) = is_kept(i) .and. signed_polygon_area(common(:, :n)) <= MAX_SEGMENT_OVERLAP * area
      end do
    end do
    where (.not. is_kept) cuts(:n_cuts)%n = 0
  end subroutine drop_hidden_cuts


  !> Appends the points of an intersection: triangles about the mean of its corners; an intersection of three corners is one
  !! triangle.
  subroutine append_cut_points(geometry, f, is_line_facet, depth, master_geometry, cut, points, n)
    type(face_geometry_type), intent(in) :: geometry, master_geometry   !< slave, master
    integer, intent(in) :: f                       !< the slave's facet
    logical, intent(in) :: is_line_facet                 !< the slave's facet is a line
    real(DP), intent(in) :: depth                  !< of a line, as in find_facing_points
    type(face_cut_type), intent(in) :: cut
    type(facing_point_type), allocatable, intent(inout) :: points(:)
    integer, intent(inout) :: n                    !< points so far
    real(DP) :: natural(2, MAX_POLYGON_CORNERS), triangle(2, 3), middle(2)
    integer :: k
    do k = 1, cut%n
      natural(:, k) = find_natural_coordinates(geometry, geometry, cut%corners(:, k))
    end do
    if (cut%n == 3) then
      call append_triangle_points(natural(:, [3, 1, 2]))
      return
    end if
    middle = find_natural_coordinates(geometry, geometry, sum(cut%corners(:, :cut%n), dim=2) / real(cut%n, DP))
    do k = 1, cut%n
      triangle(:, 1) = middle
      triangle(:, 2) = natural(:, k)
      triangle(:, 3) = natural(:, modulo(k, cut%n) + 1)
      call append_triangle_points(triangle)
    end do

  contains

    !> Seven points.
    subroutine append_triangle_points(corners)
      real(DP), intent(in) :: corners(2, 3)        !< natural coordinates [-]
      real(DP) :: share(3, N_TRIANGLE_POINTS), weight(N_TRIANGLE_POINTS), a(2), b(2), twice, tangents(3, 2)
      type(facing_point_type) :: point
      integer :: q
      a = corners(:, 2) - corners(:, 1)
      b = corners(:, 3) - corners(:, 1)
      twice = a(1) * b(2) - a(2) * b(1)
      if (twice < 2 * MIN_TRIANGLE_AREA) return
      call set_radon_rule(share, weight)
      do q = 1, N_TRIANGLE_POINTS
        point%slave = f
        point%master = cut%master
        point%at = matmul(corners, share(:, q))
        tangents = evaluate_tangents(geometry, point%at)
        point%area = 0.5_DP * twice * weight(q) * norm2(cross_product(tangents(:, 1), tangents(:, 2)))
        if (is_line_facet) point%area = point%area * merge(depth, PI / sin(HALF_WEDGE_ANGLE), depth >= 0.0_DP)
        point%xi = find_closest_coordinates(master_geometry, evaluate_point(geometry, point%at))
        if (n == size(points)) points = [points, points]
        n = n + 1
        points(n) = point
      end do
    end subroutine append_triangle_points

  end subroutine append_cut_points


  !> The seven-point rule on a triangle: area coordinates and weights, whose sum is 1.
  pure subroutine set_radon_rule(share, weight)
    real(DP), intent(out) :: share(3, N_TRIANGLE_POINTS), weight(N_TRIANGLE_POINTS)   !< [-]
    real(DP), parameter :: ROOT = sqrt(15.0_DP)
    integer, parameter :: AT(3) = [2, 1, 3]        ! the order of the last three
    integer :: k
    share(:, 1) = 1.0_DP / 3
    weight(1) = 9.0_DP / 40
    share(:, 2:4) = (6 - ROOT) / 21
    weight(2:4) = (155 - ROOT) / 1200
    share(:, 5:7) = (6 + ROOT) / 21
    weight(5:7) = (155 + ROOT) / 1200
    do k = 1, 3
      share(k, 1 + k) = (9 + 2 * ROOT) / 21
      share(AT(k), 4 + k) = (9 - 2 * ROOT) / 21
    end do
  end subroutine set_radon_rule


  !> The natural coordinates of the point of a face above a point of a plane.
  pure function find_natural_coordinates(geometry, plane, q) result(xi)
    type(face_geometry_type), intent(in) :: geometry
    type(face_geometry_type), intent(in) :: plane          !< the face that defines the plane
    real(DP), intent(in) :: q(2)                   !< in the plane [length]
    real(DP) :: xi(2)                              !< [-]
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES)
    call find_flat_coordinates(geometry%kind, project_on_plane(plane, geometry%x(:, :geometry%n)), q, xi, N, dN)
  end function find_natural_coordinates


  !> The natural coordinates of the point of a face nearest to a given point, inside the face or on its border.
  pure function find_closest_coordinates(geometry, point) result(xi)
    type(face_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: point(3)               !< [length]
    real(DP) :: xi(2)                              !< [-]
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    real(DP) :: t(3, 2), curvature(3, 3), d(3), H(2, 2), g(2), step(2), det
    integer :: iteration
    logical :: is_triangle
    is_triangle = geometry%kind == FACET_TRI3 .or. geometry%kind == FACET_TRI6
    xi = merge(1.0_DP / 3, 0.0_DP, is_triangle)
    do iteration = 1, MAX_PROJECTION_ITERATIONS
      call facet_shapes(geometry%kind, xi, N, dN, ddN)
      associate (x => geometry%x(:, :geometry%n))
        d = matmul(x, N(:geometry%n)) - point
        t = matmul(x, transpose(dN(:, :geometry%n)))
        curvature = matmul(x, transpose(ddN(:, :geometry%n)))
      end associate
      g = matmul(d, t)
      H = matmul(transpose(t), t)
      det = H(1, 1) * H(2, 2)
      H = H + reshape([dot_product(d, curvature(:, 1)), dot_product(d, curvature(:, 3)), dot_product(d, curvature(:, 3)), &
        dot_product(d, curvature(:, 2))], [2, 2])
      if (H(1, 1) <= 0.0_DP .or. H(1, 1) * H(2, 2) - H(1, 2)**2 <= 1.0e-6_DP * det) H = matmul(transpose(t), t)
      det = H(1, 1) * H(2, 2) - H(1, 2)**2
      if (det <= tiny(1.0_DP)) exit
      step = -[H(2, 2) * g(1) - H(1, 2) * g(2), H(1, 1) * g(2) - H(1, 2) * g(1)] / det
      if (maxval(abs(step)) > 1.0_DP) step = step / maxval(abs(step))
      xi = xi + step
      if (maxval(abs(step)) < 1.0e-13_DP) exit
    end do
    if (is_triangle) then
      xi = max(xi, 0.0_DP)
      if (sum(xi) > 1.0_DP) xi = xi / sum(xi)
    else
      xi = min(max(xi, -1.0_DP), 1.0_DP)
    end if
  end function find_closest_coordinates


  !> The unit normal of a facet at natural coordinates, out of the body.
  pure function evaluate_face_normal(facets, x, f, xi) result(normal)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    integer, intent(in) :: f                       !< facet
    real(DP), intent(in) :: xi(2)                  !< [-]
    real(DP) :: normal(3), t(3, 2)
    call facet_tangents(facets, x, f, xi, t)
    normal = cross_product(t(:, 1), t(:, 2))
    normal = normal / max(norm2(normal), tiny(1.0_DP))
  end function evaluate_face_normal

end module amontons_face_intersection_points
