!> Mortar segmentation: intersections of a slave facet with master facets in a projection plane, and the integrals over them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 7. Each slave facet is intersected with the master facets in front of it, projected on the
!! plane through the slave facet (M. Puso, T. Laursen, Comput. Methods Appl. Mech. Engrg. 193 (2004) 601-629).
module amontons_mortar_segmentation
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: facet_kind, facet_kind_type, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, FACET_LINE3, &
    MAX_FACE_NODES
  use amontons_facets, only: facets_type, facet_nodes, n_facet_corners, is_line_facet, is_hidden_behind, is_unseen, is_absent_facet
  use amontons_facet_search, only: facet_search_type, find_near_facets
  use amontons_polygon_clipping, only: find_flat_coordinates, find_polygon_excess, clip_polygon, signed_polygon_area, &
    set_polygon_quadrature, MAX_POLYGON_CORNERS, MAX_CUT_POINTS
  use amontons_dual_shape_functions, only: transform_shape_functions, transform_nodal_positions, evaluate_dual_functions
  implicit none
  private
  public :: projection_plane_type, mortar_segment_type, segment_points_type, segmentation_type, build_segmentation, &
    build_projection_plane, build_projection_planes, project_on_plane, project_facet_corners, is_facing_plane, &
    find_depth, is_unseen_facet, integrate_segments, keep_segmentation, choose_quadrature_order
  public :: MIN_FACING_COSINE, MIN_ROW_COSINE, MAX_SEGMENT_OVERLAP, MIN_SEGMENT_AREA

  real(DP), parameter :: MIN_FACING_COSINE = 0.2_DP  !< least cosine between the slave normal and the opposite of a master normal
                                                     !! [-]
  real(DP), parameter :: MIN_ROW_COSINE = 0.5_DP     !< the same of facets in a row: dual functions are negative in parts, so that
                                                     !! steeper ones close the row while all of it is apart [-]
  real(DP), parameter :: MAX_SEGMENT_OVERLAP = 1.0e-6_DP  !< segments with a larger overlap, over the area of the facet, lie one
                                                          !! behind the other [-]
  real(DP), parameter :: MIN_SEGMENT_AREA = 1.0e-10_DP       !< smaller intersections, over the area of the facet, are ignored [-]
  real(DP), parameter :: DISTANCE_ROUNDING = 1.0e-12_DP      !< of distances, over their size [-]
  real(DP), parameter :: TOL_AFFINE = 1.0e-9_DP  !< largest deviation of a quadrilateral from a parallelogram, over its size [-]

  !> The projection plane of a slave facet.
  type :: projection_plane_type
    real(DP) :: origin(3) = 0                      !< [length]
    real(DP) :: axes(3, 2) = 0                     !< unit vectors in the plane
    real(DP) :: normal(3) = 0                      !< unit vector, out of the slave
    real(DP) :: depth = 1                          !< of a line: thickness [length], -1: the full circle
    real(DP) :: radius = 0                         !< largest distance of a corner of the facet from the origin [length]
  end type projection_plane_type

  !> Intersection of a slave and a master facet.
  type :: mortar_segment_type
    integer :: slave = 0                           !< facet
    integer :: master = 0                          !< facet; 0: no intersection
    integer :: n_master = 0                        !< its nodes
    integer :: first = 0, last = 0                 !< its points
    real(DP) :: master_integrals(MAX_FACE_NODES, MAX_FACE_NODES) = 0   !< integral of phi_j N_i [length^2]
    real(DP) :: share(MAX_FACE_NODES) = 0          !< integral of N~_j [length^2]
    real(DP) :: centre(2) = 0                      !< mean natural coordinates on the master facet [-]
    integer :: n = 0                               !< corners of the intersection
    real(DP) :: cut(2, MAX_POLYGON_CORNERS) = 0            !< in the plane of the slave facet [length]
    real(DP) :: distance = 0                       !< mean, positive where the facets are apart [length]
  end type mortar_segment_type

  !> A facet in a projection plane.
  type :: flat_facet_type
    integer :: facet = 0                           !< its number
    integer :: kind = 0                            !< FACET_...
    integer :: n = 0                               !< nodes
    real(DP) :: x(3, MAX_FACE_NODES) = 0           !< [length]
    real(DP) :: flat(2, MAX_FACE_NODES) = 0        !< in the plane [length]
    real(DP) :: height(MAX_FACE_NODES) = 0         !< above it, out of the slave [length]
    integer :: n_corners = 0
    real(DP) :: corners(2, 4) = 0                  !< as `project_facet_corners` [length]
  end type flat_facet_type

  !> Integration points over one slave facet.
  type :: segment_points_type
    integer :: n = 0
    real(DP), allocatable :: weight(:)             !< [length^2]
    real(DP), allocatable :: at(:, :)              !< (2, :) in the plane [length]
    real(DP), allocatable :: xi(:, :), eta(:, :)   !< (2, :) natural coordinates on the slave and on the master facet [-]
    real(DP), allocatable :: on_slave(:, :)        !< (MAX_FACE_NODES, :) N~_j [-]
    real(DP), allocatable :: on_master(:, :)       !< (MAX_FACE_NODES, :) N_i [-]
  end type segment_points_type

  !> Segmentation of a slave facet. After the integration the functions are not kept, to save memory.
  type :: segmentation_type
    type(projection_plane_type) :: plane
    real(DP) :: area = 0                           !< of the slave facet [length^2]
    type(segment_points_type) :: points
    integer :: n = 0
    type(mortar_segment_type), allocatable :: segments(:) !< the first n are set
  end type segmentation_type

contains

  !> Intersects a slave facet with the masters in front of it; of masters one behind the other the nearest counts.
  subroutine build_segmentation(slave, f, depth, master, master_planes, search, x, search_distance, segmentation)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f                       !< slave facet
    real(DP), intent(in) :: depth                  !< of a line: as plane%depth
    type(projection_plane_type), intent(in) :: master_planes(:)   !< (master%n) at x
    type(facet_search_type), intent(in) :: search        !< of the master's facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    real(DP), intent(in) :: search_distance                  !< larger distances between facets are ignored [length]
    type(segmentation_type), intent(inout) :: segmentation   !< its arrays are used again
    type(mortar_segment_type) :: segment
    type(flat_facet_type) :: own, front
    integer, allocatable :: list(:)
    integer :: k, n_list
    segmentation%n = 0
    segmentation%points%n = 0
    if (.not. allocated(segmentation%segments)) allocate (segmentation%segments(8))
    call build_projection_plane(slave, f, x, segmentation%plane)
    segmentation%plane%depth = depth
    if (is_absent_facet(slave, f)) return
    call flatten_facet(slave, f, x, segmentation%plane, own)
    call find_near_facets(search, segmentation%plane%origin, list, n_list)
    do k = 1, n_list
      if (.not. is_facing_plane(segmentation%plane, master, list(k), master_planes(list(k)), huge(1.0_DP))) cycle
      if (is_beside(segmentation%plane, master_planes(list(k)))) cycle
      if (is_unseen_facet(slave, f, master, list(k))) cycle
      call flatten_facet(master, list(k), x, segmentation%plane, front)
      if (is_beyond_reach(own, front, segmentation%plane, search_distance)) cycle
      call intersect_facets(own, front, segmentation%plane, segmentation%points, segment)
      if (segment%master == 0) cycle
      if (abs(segment%distance) > search_distance .or. is_hidden_behind(master, list(k), segment%distance) .or. &
        is_behind_body(segment, segmentation%plane, master, master_planes, list(:n_list), x)) then
        segmentation%points%n = segment%first - 1
        cycle
      end if
      if (segmentation%n == size(segmentation%segments)) segmentation%segments = [segmentation%segments, segmentation%segments]
      segmentation%n = segmentation%n + 1
      segmentation%segments(segmentation%n) = segment
    end do
    if (segmentation%n == 0) return
    call drop_hidden_segments(segmentation%segments(:segmentation%n), signed_polygon_area(own%corners(:, :own%n_corners)), &
      segmentation%points)
  end subroutine build_segmentation


  !> Resolves masters one behind the other (a fold): segments that overlap a nearer one are dropped.
  subroutine drop_hidden_segments(segments, area, points)
    type(mortar_segment_type), intent(inout) :: segments(:)   !< of one slave facet
    real(DP), intent(in) :: area                   !< of the slave facet in its plane [length^2]
    type(segment_points_type), intent(inout) :: points     !< weights of dropped segments become zero
    logical :: is_done(size(segments)), is_kept(size(segments))
    real(DP) :: common(2, MAX_POLYGON_CORNERS), covered
    integer :: i, j, k, n
    covered = 0.0_DP
    do i = 1, size(segments)
      covered = covered + signed_polygon_area(segments(i)%cut(:, :segments(i)%n))
    end do
    if (covered <= (1 + MAX_SEGMENT_OVERLAP) * area) return
    is_done = .false.
    is_kept = .false.
    do k = 1, size(segments)
      i = minloc(abs(segments%distance), dim=1, mask=.not. is_done)
      is_done(i) = .true.
      is_kept(i) = .true.
      do j = 1, size(segments)
        if (.not. is_kept(j) .or. j == i) cycle
        call clip_polygon(segments(i)%cut(:, :segments(i)%n), segments(j)%cut(:, :segments(j)%n), common, n)
        if (n >= 3) is_kept(i) = is_kept(i) .and. signed_polygon_area(common(:, :n)) <= MAX_SEGMENT_OVERLAP * area
      end do
      if (.not. is_kept(i)) points%weight(segments(i)%first:segments(i)%last) = 0.0_DP
    end do
  end subroutine drop_hidden_segments


  !> The depth of a line at a point: its thickness, or the length of the circle; 1 for faces.
  pure real(DP) function find_depth(plane, point) result(depth)
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(in) :: point(3)               !< [length]
    depth = plane%depth
    if (depth < 0.0_DP) depth = 2 * PI * point(1)
  end function find_depth


  !> The plane through the mean of the corners of a facet, normal to its mean normal. A line's plane is perpendicular to the model.
  pure subroutine build_projection_plane(facets, f, x, plane)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(projection_plane_type), intent(out) :: plane
    type(facet_kind_type) :: shape
    integer :: i, n, m, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, n, nodes)
    shape = facet_kind(facets%kind(f))
    m = shape%n_corners
    plane%origin = sum(x(:, nodes(:m)), dim=2) / real(m, DP)
    plane%radius = maxval([(norm2(x(:, nodes(i)) - plane%origin), i=1, m)])
    if (m == 2) then
      plane%axes(:, 1) = (x(:, nodes(2)) - x(:, nodes(1))) / max(norm2(x(:, nodes(2)) - x(:, nodes(1))), tiny(1.0_DP))
      plane%axes(:, 2) = [0.0_DP, 0.0_DP, 1.0_DP]
      plane%normal = cross_product(plane%axes(:, 1), plane%axes(:, 2))
      return
    end if
    plane%normal = cross_product(x(:, nodes(3)) - x(:, nodes(1)), x(:, nodes(modulo(3, m) + 1)) - x(:, nodes(2)))
    if (m == 3) plane%normal = cross_product(x(:, nodes(2)) - x(:, nodes(1)), x(:, nodes(3)) - x(:, nodes(1)))
    plane%normal = plane%normal / max(norm2(plane%normal), tiny(1.0_DP))
    plane%axes(:, 1) = x(:, nodes(2)) - x(:, nodes(1))
    plane%axes(:, 1) = plane%axes(:, 1) - dot_product(plane%normal, plane%axes(:, 1)) * plane%normal
    plane%axes(:, 1) = plane%axes(:, 1) / max(norm2(plane%axes(:, 1)), tiny(1.0_DP))
    plane%axes(:, 2) = cross_product(plane%normal, plane%axes(:, 1))
  end subroutine build_projection_plane


  !> A point in plane coordinates.
  pure function project_on_plane(plane, point) result(p)
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(in) :: point(3)               !< [length]
    real(DP) :: p(2)                               !< [length]
    p = matmul(point - plane%origin, plane%axes)
  end function project_on_plane


  !> The corners of a facet in plane coordinates; a line is a rectangle of depth 1.
  pure subroutine project_facet_corners(plane, facets, f, x, corners, n)
    type(projection_plane_type), intent(in) :: plane
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    real(DP), intent(out) :: corners(2, 4)         !< the first n are set [length]
    integer, intent(out) :: n
    type(facet_kind_type) :: shape
    integer :: i, n_nodes, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, n_nodes, nodes)
    shape = facet_kind(facets%kind(f))
    n = shape%n_corners
    corners = 0.0_DP
    do i = 1, n
      corners(:, i) = project_on_plane(plane, x(:, nodes(i)))
    end do
    if (n == 2) call extrude_line(corners, n)
  end subroutine project_facet_corners


  !> A line as a rectangle of depth 1.
  pure subroutine extrude_line(corners, n)
    real(DP), intent(inout) :: corners(2, 4)       !< in: two corners [length]
    integer, intent(out) :: n
    n = 4
    corners(2, :2) = 0.0_DP
    corners(:, 3) = [corners(1, 2), 1.0_DP]
    corners(:, 4) = [corners(1, 1), 1.0_DP]
  end subroutine extrude_line


  !> The planes of all facets.
  pure function build_projection_planes(facets, x) result(planes)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)
    type(projection_plane_type) :: planes(facets%n)
    integer :: f
    do f = 1, facets%n
      call build_projection_plane(facets, f, x, planes(f))
    end do
  end function build_projection_planes


  !> Whether a master facet is in front of a slave's plane: its normal opposes the plane's, and its middle is within the distance.
  pure logical function is_facing_plane(plane, master, g, other, search_distance)
    type(projection_plane_type), intent(in) :: plane
    type(facets_type), intent(in) :: master
    integer, intent(in) :: g                       !< master facet
    type(projection_plane_type), intent(in) :: other         !< its plane
    real(DP), intent(in) :: search_distance                  !< from the plane [length]
    real(DP) :: distance
    distance = dot_product(other%origin - plane%origin, plane%normal)
    is_facing_plane = dot_product(other%normal, plane%normal) <= -MIN_ROW_COSINE .and. abs(distance) <= search_distance
    if (search_distance < huge(1.0_DP)) is_facing_plane = is_facing_plane .and. .not. is_hidden_behind(master, g, distance)
  end function is_facing_plane


  !> Whether a slave facet lies behind a master facet, by more than its size, but not in the body: on the way from the slave facet
  !! the body begins at another master facet. So a hook in front of a catch does not touch the catch's back.
  pure logical function is_behind_body(segment, plane, master, master_planes, list, x)
    type(mortar_segment_type), intent(in) :: segment
    type(projection_plane_type), intent(in) :: plane   !< of the slave facet
    type(facets_type), intent(in) :: master
    type(projection_plane_type), intent(in) :: master_planes(:)   !< (master%n)
    integer, intent(in) :: list(:)                 !< master facets that are near
    real(DP), intent(in) :: x(:, :)
    real(DP) :: middle(2), start(3), corners(2, 4), cosine, way, beyond
    integer :: k, n, edge
    is_behind_body = .false.
    if (segment%distance >= -2 * master_planes(segment%master)%radius .or. allocated(master%unseen)) return
    middle = sum(segment%cut(:, :segment%n), dim=2) / real(segment%n, DP)
    start = plane%origin + matmul(plane%axes, middle)
    do k = 1, size(list)
      cosine = dot_product(master_planes(list(k))%normal, plane%normal)
      if (cosine <= 0.0_DP) cycle
      way = dot_product(start - master_planes(list(k))%origin, master_planes(list(k))%normal) / cosine
      if (way <= 0.0_DP .or. way >= -segment%distance) cycle
      call project_facet_corners(plane, master, list(k), x, corners, n)
      call find_polygon_excess(corners(:, :n), middle, beyond, edge)
      is_behind_body = beyond <= 0.0_DP
      if (is_behind_body) return
    end do
  end function is_behind_body


  !> Whether the projections of two facets are certainly apart, by the circles around their corners.
  pure logical function is_beside(plane, other)
    type(projection_plane_type), intent(in) :: plane, other
    real(DP) :: d(3)
    d = other%origin - plane%origin
    d = d - dot_product(d, plane%normal) * plane%normal
    is_beside = norm2(d) > (1 + DISTANCE_ROUNDING) * (plane%radius + other%radius) + DISTANCE_ROUNDING * norm2(plane%origin)
  end function is_beside


  !> Whether a master facet is certainly farther from a slave facet than the distance that matters: the mean distance of points with
  !! positive shape functions lies between those of the nodes. (Quadratic functions have negative values.)
  pure logical function is_beyond_reach(own, front, plane, search_distance)
    type(flat_facet_type), intent(in) :: own, front          !< slave and master facet
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(in) :: search_distance                  !< [length]
    real(DP) :: limit
    is_beyond_reach = .false.
    if (own%n > n_facet_corners(own%kind) .or. front%n > n_facet_corners(front%kind)) return
    limit = search_distance + DISTANCE_ROUNDING * (search_distance + norm2(plane%origin))
    is_beyond_reach = minval(front%height(:front%n)) - maxval(own%height(:own%n)) > limit &
      .or. maxval(front%height(:front%n)) - minval(own%height(:own%n)) < -limit
  end function is_beyond_reach


  !> Self contact: whether no node of a slave facet can touch a master facet.
  pure logical function is_unseen_facet(slave, f, master, g)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f, g                    !< slave and master facet
    integer :: k
    is_unseen_facet = allocated(master%unseen)
    if (.not. is_unseen_facet) return
    do k = slave%first(f), slave%first(f + 1) - 1
      is_unseen_facet = is_unseen_facet .and. is_unseen(master, slave%nodes(k), g)
    end do
  end function is_unseen_facet


  !> Intersects a slave facet with one master facet and appends the points. After: segment%master = 0 without intersection.
  subroutine intersect_facets(own, front, plane, points, segment)
    type(flat_facet_type), intent(in) :: own, front          !< slave and master facet
    type(projection_plane_type), intent(in) :: plane
    type(segment_points_type), intent(inout) :: points
    type(mortar_segment_type), intent(out) :: segment
    real(DP) :: at(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS)
    integer :: n, q
    associate (corners => own%corners(:, :own%n_corners), window => front%corners(:, front%n_corners:1:-1))
      if (any(minval(corners, dim=2) > maxval(window, dim=2))) return
      if (any(maxval(corners, dim=2) < minval(window, dim=2))) return
      call clip_polygon(corners, window, segment%cut, n)     ! seen from the slave a master runs in the opposite sense
      if (n < 3) return
      if (signed_polygon_area(segment%cut(:, :n)) <= MIN_SEGMENT_AREA * signed_polygon_area(corners)) return
    end associate
    call set_polygon_quadrature(segment%cut(:, :n), is_line_facet(own%kind), max(choose_quadrature_order(own%kind, own%corners), &
      choose_quadrature_order(front%kind, front%corners)), q, at, weight)
    segment%slave = own%facet
    segment%master = front%facet
    segment%n_master = front%n
    segment%n = n
    segment%first = points%n + 1
    segment%last = points%n + q
    call append_segment_points(own, front, plane, at(:, :q), weight(:q), points, segment)
  end subroutine intersect_facets


  !> The quadrature order for a facet. Its functions are polynomials in the plane for triangles with straight edges and for
  !! parallelograms, and the rule is exact; otherwise they are not, and the error decreases fast with the order.
  pure integer function choose_quadrature_order(kind, corners) result(order)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: corners(2, 4)          !< in the plane [length]
    logical :: is_skew
    is_skew = norm2(corners(:, 1) - corners(:, 2) + corners(:, 3) - corners(:, 4)) > TOL_AFFINE * norm2(corners(:, &
      3) - corners(:, 1))
    select case (kind)
    case (FACET_QUAD4)
      order = merge(5, 3, is_skew)
    case (FACET_QUAD8)
      order = merge(6, 4, is_skew)
    case (FACET_TRI6, FACET_LINE3)
      order = 4
    case default
      order = 3
    end select
  end function choose_quadrature_order


  !> The points of an intersection with the functions of both facets there, and their mean distance, positive if the facets are
  !! apart.
  subroutine append_segment_points(own, front, plane, at, weight, points, segment)
    type(flat_facet_type), intent(in) :: own, front          !< slave and master facet
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(in) :: at(:, :), weight(:)    !< (2, n), (n) in the plane
    type(segment_points_type), intent(inout) :: points
    type(mortar_segment_type), intent(inout) :: segment   !< out: centre, distance
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), M(MAX_FACE_NODES), dM(2, MAX_FACE_NODES)
    integer :: q, k
    call reserve_points(points, points%n + size(weight))
    do q = 1, size(weight)
      k = points%n + q
      call find_flat_coordinates(own%kind, own%flat(:, :own%n), at(:, q), points%xi(:, k), N, dN)
      call find_flat_coordinates(front%kind, front%flat(:, :front%n), at(:, q), points%eta(:, k), M, dM)
      points%at(:, k) = at(:, q)
      points%weight(k) = weight(q) * evaluate_stretch(own, dN, plane%normal) * find_depth(plane, &
        [dot_product(own%x(1, :own%n), N(:own%n)), 0.0_DP, 0.0_DP])
      segment%distance = segment%distance + weight(q) * (dot_product(front%height(:front%n), M(:front%n)) &
        - dot_product(own%height(:own%n), N(:own%n)))
      segment%centre = segment%centre + weight(q) * points%eta(:, k)
      call transform_shape_functions(own%kind, N)
      points%on_slave(:, k) = N
      points%on_master(:, k) = M
    end do
    points%n = points%n + size(weight)
    segment%centre = segment%centre / sum(weight)
    segment%distance = segment%distance / sum(weight)
  end subroutine append_segment_points


  !> The nodes of a facet in a plane and above it.
  pure subroutine flatten_facet(facets, f, x, plane, facet)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(projection_plane_type), intent(in) :: plane
    type(flat_facet_type), intent(out) :: facet
    integer :: i, nodes(MAX_FACE_NODES)
    facet%facet = f
    facet%kind = facets%kind(f)
    call facet_nodes(facets, f, facet%n, nodes)
    do i = 1, facet%n
      facet%x(:, i) = x(:, nodes(i))
      facet%flat(:, i) = project_on_plane(plane, facet%x(:, i))
      facet%height(i) = dot_product(plane%normal, facet%x(:, i) - plane%origin)
    end do
    facet%n_corners = n_facet_corners(facet%kind)
    facet%corners(:, :facet%n_corners) = facet%flat(:, :facet%n_corners)
    if (facet%n_corners == 2) call extrude_line(facet%corners, facet%n_corners)
  end subroutine flatten_facet


  !> The area of a curved facet at a point over that in the plane.
  pure real(DP) function evaluate_stretch(facet, dN, plane_normal) result(stretch)
    type(flat_facet_type), intent(in) :: facet
    real(DP), intent(in) :: dN(2, MAX_FACE_NODES)  !< at the point [-]
    real(DP), intent(in) :: plane_normal(3)
    real(DP) :: a(3), b(3), normal(3), area
    integer :: i
    a = 0.0_DP
    b = 0.0_DP
    do i = 1, facet%n
      a = a + dN(1, i) * facet%x(:, i)
      b = b + dN(2, i) * facet%x(:, i)
    end do
    if (is_line_facet(facet%kind)) b = [0.0_DP, 0.0_DP, 1.0_DP]
    normal = cross_product(a, b)
    area = norm2(normal)
    stretch = area / max(dot_product(normal, plane_normal), 0.1_DP * area)
  end function evaluate_stretch


  !> Allocates n points.
  pure subroutine reserve_points(points, n)
    type(segment_points_type), intent(inout) :: points
    integer, intent(in) :: n
    real(DP), allocatable :: larger_values(:)
    integer :: capacity, m
    m = points%n
    if (.not. allocated(points%weight)) allocate (points%weight(0), points%at(2, 0), points%xi(2, 0), points%eta(2, 0), &
      points%on_slave(MAX_FACE_NODES, 0), points%on_master(MAX_FACE_NODES, 0))
    if (n <= size(points%weight)) return
    capacity = max(n, 2 * size(points%weight), 128)
    allocate (larger_values(capacity))
    larger_values(:m) = points%weight(:m)
    call move_alloc(larger_values, points%weight)
    call grow_columns(points%at)
    call grow_columns(points%xi)
    call grow_columns(points%eta)
    call grow_columns(points%on_slave)
    call grow_columns(points%on_master)

  contains

    !> Extends an array by columns.
    pure subroutine grow_columns(values)
      real(DP), allocatable, intent(inout) :: values(:, :)
      real(DP), allocatable :: wider(:, :)
      allocate (wider(size(values, 1), capacity))
      wider(:, :m) = values(:, :m)
      call move_alloc(wider, values)
    end subroutine grow_columns

  end subroutine reserve_points


  !> The integrals of all segments of one slave facet, with the dual functions of the covered part.
  subroutine integrate_segments(slave, f, x, plane, area, points, segments)
    type(facets_type), intent(in) :: slave
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(in) :: area                   !< of the slave facet [length^2]
    type(segment_points_type), intent(in) :: points
    type(mortar_segment_type), intent(inout) :: segments(:)
    real(DP), allocatable :: phi(:, :)
    real(DP) :: at_node(2, MAX_FACE_NODES), d(MAX_FACE_NODES)
    integer :: n, i, k, q, nodes(MAX_FACE_NODES)
    call facet_nodes(slave, f, n, nodes)
    do i = 1, n
      at_node(:, i) = project_on_plane(plane, x(:, nodes(i)))
    end do
    call transform_nodal_positions(slave%kind(f), at_node(:, :n))
    allocate (phi(n, points%n))
    associate (w => points%weight, N_j => points%on_slave, N_i => points%on_master)
      call evaluate_dual_functions(slave%kind(f), area, at_node(:, :n), w(:points%n), points%at(:, :points%n), N_j(:n, :points%n), &
        phi, d(:n))
      do k = 1, size(segments)
        do q = segments(k)%first, segments(k)%last
          segments(k)%share(:n) = segments(k)%share(:n) + w(q) * N_j(:n, q)
          do i = 1, segments(k)%n_master
            segments(k)%master_integrals(:n, i) = segments(k)%master_integrals(:n, i) + w(q) * N_i(i, q) * phi(:, q)
          end do
        end do
      end do
    end associate
  end subroutine integrate_segments


  !> Keeps what is set of a segmentation, without the functions at its points.
  pure subroutine keep_segmentation(work, kept)
    type(segmentation_type), intent(in) :: work
    type(segmentation_type), intent(inout) :: kept
    kept%plane = work%plane
    kept%area = work%area
    kept%n = work%n
    kept%segments = work%segments(:work%n)
    kept%points%n = work%points%n
    if (work%n == 0) return
    associate (n => work%points%n)
      kept%points%weight = work%points%weight(:n)
      kept%points%at = work%points%at(:, :n)
      kept%points%xi = work%points%xi(:, :n)
      kept%points%eta = work%points%eta(:, :n)
    end associate
  end subroutine keep_segmentation

end module amontons_mortar_segmentation
