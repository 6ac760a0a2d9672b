!> Projection of a slave node on the smoothed master surface along its interpolated normal, the gap, and their derivatives.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The projection is the ray along the interpolated normal (doc/theory/contact.md):
!!
!!     x_s = x_m(xi) + g n(xi),   x_m = sum N_i x_i,   n = s/|s|,   s = sum N_i n_i
!!     n_i = m_i/|m_i|,   m_i = sum over the star of vertex i of A_0 (x,1 x x,2) there,   A_0 area of the natural facet
!!
!! with the unknowns xi and g. Point and normal are continuous over smooth edges, hence also the projection: there are no dead zones
!! between facets. Masters that are profiles are projected in amontons_analytic_master. `x` is always the array of the coordinates
!! of all mesh nodes, (3, n_nodes).
module amontons_surface_projection
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product, skew_matrix, invert
  use amontons_element_kinds, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, MAX_FACE_NODES
  use amontons_shape_functions, only: facet_shapes, facet_node_coordinates
  use amontons_facets, only: facets_type, facet_nodes, facet_tangents, n_facet_corners, is_line_facet, is_hidden_behind, &
    is_unseen, EDGE_FREE
  use amontons_facet_crossing, only: distance_along
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  use amontons_analytic_master, only: projection_type, gap_derivatives_type, PROJECTION_INSIDE, PROJECTION_OUTSIDE, &
    PROJECTION_FAILED, &
    project_on_profile, find_profile_projection, evaluate_profile_derivative
  implicit none
  private
  public :: projection_type, gap_derivatives_type
  public :: MIN_OPPOSED_COSINE
  public :: track_projection, find_projection, evaluate_gap_derivatives, evaluate_facet_point, evaluate_vertex_normal, &
    evaluate_vertex_derivative, find_edge_excess, measure_thickness, find_clearance, &
    find_facet_distance
  public :: PROJECTION_INSIDE, PROJECTION_OUTSIDE, PROJECTION_FAILED

  real(DP), parameter :: EXTENSION_ZONE = 0.1_DP       !< extension zone beyond a free edge, over facet length [-]
  real(DP), parameter :: FACET_BOX_MARGIN = 2.0_DP * EXTENSION_ZONE   !< of the box of a facet, over its largest side [-]
  real(DP), parameter :: TOL_ON_EDGE = 1.0e-8_DP  !< tolerance beyond any edge within which a node is on the facet, same unit [-]
  real(DP), parameter :: EDGE_HYSTERESIS = 1.0e-3_DP  !< a facet keeps a node up to this excess where normals jump at edges, same
                                                      !! unit [-]
  real(DP), parameter :: MAX_NEWTON_EXCESS = 0.6_DP        !< bound of the Newton iterates beyond the facet, same unit [-]
  real(DP), parameter :: MAX_NATURAL_STEP = 0.5_DP    !< longest step of a natural coordinate, in lengths of the facet [-]
  real(DP), parameter :: TOL_EQUAL_DISTANCE = 1.0e-9_DP         !< distances are equal within this fraction of an edge [-]
  real(DP), parameter :: TOL_STAGNATION = 1.0e-8_DP  !< steps below this that no longer decrease are at rounding level [-]
  real(DP), parameter :: MIN_VERTEX_NORMAL = 1.0e-12_DP   !< smallest vertex normal, over the length squared [-]
  real(DP), parameter :: MIN_OPPOSED_COSINE = 0.2_DP  !< self contact: of the slave's normal and the opposite of the master's [-]
  integer, parameter :: MAX_NEWTON_ITERATIONS = 40      !< of Newton's method on one facet
  integer, parameter :: MAX_WALK_FACETS = 400          !< longest walk over neighbouring facets

  !> One facet in one configuration.
  type :: facet_geometry_type
    integer :: kind = 0                          !< FACET_...
    integer :: n = 0                             !< nodes
    integer :: nodes(MAX_FACE_NODES) = 0
    real(DP) :: x(3, MAX_FACE_NODES) = 0         !< their coordinates [length]
    real(DP) :: m(3, MAX_FACE_NODES) = 0         !< their vertex normals, area weighted [length^2]
    real(DP) :: normal(3, MAX_FACE_NODES) = 0    !< their unit vertex normals [-]
    real(DP) :: size = 1                         !< a length of the facet [length]
  end type facet_geometry_type

  !> Point, normal and their derivatives at natural coordinates of a facet.
  type :: surface_point_type
    real(DP) :: N(MAX_FACE_NODES) = 0            !< shape functions [-]
    real(DP) :: dN(2, MAX_FACE_NODES) = 0        !< their slopes [-]
    real(DP) :: x(3) = 0                         !< x_m [length]
    real(DP) :: normal(3) = 0                    !< n [-]
    real(DP) :: length = 0                       !< |s| [-]
    real(DP) :: dx(3, 2) = 0                     !< x_m,1 and x_m,2 [length]
    real(DP) :: dn_dxi(3, 2) = 0                 !< n,1 and n,2 [-]
  end type surface_point_type

contains

  !> Tracks the projection of a point from a facet over its neighbours to the current facet.
  !!
  !! The walk crosses smooth edges and creases. At a free edge the facet has an extension zone of a tenth of its length (as in
  !! Abaqus); beyond it the point is OUTSIDE. Unless the status is INSIDE, f is the last facet of the walk. A node with an extended
  !! edge has a larger extension.
  pure subroutine track_projection(facets, x, point, f, xi, g, n, status, extension)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer, intent(inout) :: f                  !< facet where the walk starts; out: where it ends
    real(DP), intent(out) :: xi(2)               !< natural coordinates [-]
    real(DP), intent(out) :: g                   !< gap [length]
    real(DP), intent(out) :: n(3)                !< unit normal [-]
    integer, intent(out) :: status               !< PROJECTION_...
    real(DP), intent(in), optional :: extension  !< over the length of the facet, if larger than EXTENSION_ZONE [-]
    type(projection_type) :: current_projection, previous
    real(DP) :: excess(4), reach
    integer :: step, edge, before
    reach = EXTENSION_ZONE
    if (present(extension)) reach = max(reach, extension)
    if (allocated(facets%profile)) then
      call project_on_profile(facets, x, point, f, current_projection)
      f = current_projection%facet
      xi = current_projection%xi
      g = current_projection%gap
      n = current_projection%normal
      status = current_projection%status
      return
    end if
    before = 0
    do step = 1, MAX_WALK_FACETS
      current_projection = project_on_facet(facets, x, point, f)
      excess = find_edge_excess(facets%kind(f), current_projection%xi)
      call choose_crossed_edge(facets, f, excess, reach, current_projection%status, edge)
      if (edge == 0) exit
      if (facets%neighbour(edge, f) == before) then
        current_projection = choose_nearer_projection(facets, x, point, current_projection, previous, reach)
        exit
      end if
      before = f
      previous = current_projection
      f = facets%neighbour(edge, f)
    end do
    if (step > MAX_WALK_FACETS) current_projection%status = PROJECTION_FAILED
    f = current_projection%facet
    xi = current_projection%xi
    g = current_projection%gap
    n = current_projection%normal
    status = current_projection%status
  end subroutine track_projection


  !> Finds the projection of a point without a previous one: among the facets that contain it, the one with the shortest path.
  !!
  !! The path is the gap plus, in an extension zone, the length beyond the edge. Facets that face the slave take precedence over
  !! others. Of equal paths the lowest facet number is taken. After: status INSIDE, or OUTSIDE with facet 0 if no facet is within
  !! max_distance. Before: the margin of the search is at least max_distance.
  pure subroutine find_projection(facets, search, x, point, max_distance, projection, slave_normal, own_node)
    type(facets_type), intent(in) :: facets
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(in) :: max_distance         !< largest |g| [length]
    type(projection_type), intent(out) :: projection
    real(DP), intent(in), optional :: slave_normal(3)   !< out of the slave; zero: unknown [-]
    integer, intent(in), optional :: own_node    !< self contact: the node of the surface; slave_normal is the current one
    type(projection_type), allocatable :: candidates(:)
    integer, allocatable :: list(:)
    real(DP) :: path_length, shortest, min_distance, same_path_length
    integer :: i, n, nearest
    logical :: is_facing, has_facing, is_self
    projection%status = PROJECTION_OUTSIDE
    if (allocated(facets%profile)) then
      call find_profile_projection(facets, x, point, max_distance, projection)
      return
    end if
    shortest = huge(1.0_DP)
    min_distance = huge(1.0_DP)
    has_facing = .false.
    is_self = present(own_node) .and. allocated(facets%unseen)
    nearest = 0
    call find_near_facets(search, point, list, n)
    call project_on_nearest(facets, x, point, list(:n), max_distance, candidates, slave_normal, own_node)
    do i = 1, n
      associate (candidate => candidates(i))
        if (candidate%status /= PROJECTION_INSIDE) cycle
        same_path_length = TOL_EQUAL_DISTANCE * facets%edge_length(list(i))
        path_length = find_facet_distance(facets, candidate)
        if (path_length < min_distance - same_path_length) nearest = list(i)
        min_distance = min(path_length, min_distance)
        if (.not. is_within(facets, candidate, max_distance)) cycle
        is_facing = is_facing_slave(candidate%normal, slave_normal)
        if (has_facing .and. .not. is_facing) cycle
        if ((has_facing .eqv. is_facing) .and. path_length > shortest - same_path_length) then
          if (.not. facets%is_faceted .or. path_length > shortest + same_path_length) cycle
          if (find_centre_distance(facets, x, list(i), point) >= find_centre_distance(facets, x, projection%facet, &
            point) - same_path_length) cycle
        end if
        has_facing = is_facing
        shortest = path_length
        projection = candidate
      end associate
    end do
    if (projection%facet == 0 .and. nearest > 0 .and. .not. is_self) call walk_from_facet(facets, x, point, max_distance, nearest, &
      projection)
  end subroutine find_projection


  !> Projects a point on facets in the order of the distances of their boxes, until one that faces the slave contains it: no facet
  !! whose box is farther than that path has a shorter one. The others, and those that the point does not see, have the status
  !! FAILED.
  pure subroutine project_on_nearest(facets, x, point, list, max_distance, candidates, slave_normal, own_node)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer, intent(in) :: list(:)               !< facets
    real(DP), intent(in) :: max_distance         !< largest |g| [length]
    type(projection_type), allocatable, intent(out) :: candidates(:)   !< one for each facet of the list
    real(DP), intent(in), optional :: slave_normal(3)   !< as in find_projection
    integer, intent(in), optional :: own_node
    real(DP) :: distance(size(list)), limit      ! [length]
    logical :: is_left(size(list)), is_self
    integer :: i, k
    allocate (candidates(size(list)))
    is_self = present(own_node) .and. allocated(facets%unseen)
    is_left = .true.
    do i = 1, size(list)
      if (is_self) is_left(i) = .not. is_unseen(facets, own_node, list(i))
      distance(i) = box_distance(facets, x, point, list(i))
    end do
    limit = huge(1.0_DP)
    do k = 1, count(is_left)
      i = minloc(distance, dim=1, mask=is_left)
      if (distance(i) > limit) exit
      is_left(i) = .false.
      candidates(i) = project_on_facet(facets, x, point, list(i))
      if (candidates(i)%status /= PROJECTION_INSIDE) cycle
      if (is_hidden_behind(facets, list(i), candidates(i)%gap)) candidates(i)%status = PROJECTION_FAILED
      if (is_self) then
        if (dot_product(candidates(i)%normal, slave_normal) > -MIN_OPPOSED_COSINE) candidates(i)%status = PROJECTION_FAILED
      end if
      if (candidates(i)%status /= PROJECTION_INSIDE .or. .not. is_within(facets, candidates(i), max_distance)) cycle
      if (is_facing_slave(candidates(i)%normal, slave_normal)) limit = min(limit, find_facet_distance(facets, candidates(i)) + &
        2.0_DP * TOL_EQUAL_DISTANCE * facets%edge_length(list(i)))
    end do
  end subroutine project_on_nearest


  !> Whether a projection is on its facet and near enough.
  pure logical function is_within(facets, projection, max_distance)
    type(facets_type), intent(in) :: facets
    type(projection_type), intent(in) :: projection
    real(DP), intent(in) :: max_distance         !< largest |g| [length]
    is_within = .false.
    if (abs(projection%gap) <= max_distance) is_within = is_projection_inside(facets, projection)
  end function is_within


  !> The distance that a point is certainly away from the facets that its node can touch, at most `reach`; 0: not known. Before: the
  !! margin of the search is at least the reach.
  real(DP) function find_clearance(facets, search, x, point, reach, node) result(clearance)
    type(facets_type), intent(in) :: facets
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< [length]
    real(DP), intent(in) :: reach                !< [length]
    integer, intent(in), optional :: node        !< of the mesh; self contact: facets that it cannot touch do not count
    integer, allocatable :: list(:)
    integer :: i, n
    clearance = 0.0_DP
    if (allocated(facets%profile)) return
    clearance = reach
    call find_near_facets(search, point, list, n)
    do i = 1, n
      if (present(node)) then
        if (is_unseen(facets, node, list(i))) cycle
      end if
      clearance = min(clearance, box_distance(facets, x, point, list(i)))
    end do
  end function find_clearance


  !> The distance of a point from the box of a facet, enlarged for its extension zone and its curvature: no larger than the path to
  !! it.
  pure real(DP) function box_distance(facets, x, point, f) result(distance)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer, intent(in) :: f                     !< facet
    real(DP) :: low(3), high(3), more            ! [length]
    integer :: k
    low = x(:, facets%nodes(facets%first(f)))
    high = low
    do k = facets%first(f) + 1, facets%first(f + 1) - 1
      low = min(low, x(:, facets%nodes(k)))
      high = max(high, x(:, facets%nodes(k)))
    end do
    more = FACET_BOX_MARGIN * maxval(high - low)
    distance = norm2(max(low - more - point, point - high - more, 0.0_DP))
  end function box_distance


  !> The thickness of the body below each facet, where the surface has facets on its other side too, as that of a sheet or a wedge:
  !! the way from its middle along the inward normal to the facet where it leaves the body, as gaps are measured; huge where a
  !! search with this reach finds none. Cost: one search for a facet.
  subroutine measure_thickness(facets, x, reach, thickness)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) coordinates [length]
    real(DP), intent(in) :: reach                !< of the search [length]
    real(DP), intent(out) :: thickness(:)        !< (n) [length]
    type(facet_search_type) :: search
    type(surface_point_type) :: middle(facets%n)
    type(facet_geometry_type) :: geometry
    integer, allocatable :: list(:)
    integer :: f, i, n, n_nodes, nodes(MAX_FACE_NODES), n_corners
    thickness = huge(1.0_DP)
    if (allocated(facets%profile)) return
    do f = 1, facets%n
      call build_facet_geometry(facets, x, f, geometry)
      call evaluate_surface_point(geometry, spread(merge(1.0_DP / 3.0_DP, 0.0_DP, is_triangle(facets%kind(f))), 1, 2), middle(f))
    end do
    call build_facet_search(facets, x, reach, search)
    do f = 1, facets%n
      call find_near_facets(search, middle(f)%x, list, n)
      do i = 1, n
        if (list(i) == f) cycle
        call facet_nodes(facets, list(i), n_nodes, nodes)
        n_corners = n_facet_corners(facets%kind(list(i)))
        thickness(f) = min(thickness(f), distance_along(middle(f)%x, -middle(f)%normal, middle(list(i))%normal, &
          x(:, nodes(:n_corners))))
      end do
    end do
  end subroutine measure_thickness


  !> The distance of a point from the nearest centre of the triangles of a facet. Of several facets that contain a point CalculiX
  !! takes the one with the nearest triangle; it divides a quadrilateral between its second and fourth corner in its own numbering.
  pure real(DP) function find_centre_distance(facets, x, f, point) result(distance)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    integer, intent(in) :: f                     !< facet
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer :: n, nodes(MAX_FACE_NODES), at(3, 2)
    call facet_nodes(facets, f, n, nodes)
    at(:, 1) = [1, 2, 3]
    at(:, 2) = at(:, 1)
    if (facets%kind(f) == FACET_QUAD4 .or. facets%kind(f) == FACET_QUAD8) then
      at = reshape([1, 2, 4, 2, 3, 4], [3, 2])
      if (facets%face(f) == 1) at = reshape([1, 2, 3, 1, 3, 4], [3, 2])   ! CalculiX starts this face at another corner
    else if (is_line_facet(facets%kind(f))) then
      at = reshape([1, 2, 2, 1, 1, 2], [3, 2])
    end if
    distance = min(norm2(sum(x(:, nodes(at(:, 1))), dim=2) / 3 - point), norm2(sum(x(:, nodes(at(:, 2))), dim=2) / 3 - point))
  end function find_centre_distance


  !> The projection from a facet that is near but does not contain the point; unchanged if the walk finds none.
  pure subroutine walk_from_facet(facets, x, point, max_distance, f, projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(in) :: max_distance         !< largest |g| [length]
    integer, intent(in) :: f                     !< facet
    type(projection_type), intent(inout) :: projection
    type(projection_type) :: found
    found%facet = f
    call track_projection(facets, x, point, found%facet, found%xi, found%gap, found%normal, found%status)
    if (found%status /= PROJECTION_INSIDE .or. abs(found%gap) > max_distance) return
    if (.not. is_hidden_behind(facets, found%facet, found%gap)) projection = found
  end subroutine walk_from_facet


  !> The exact derivatives of xi, g and n at a projection (any g).
  !!
  !! They follow from the differentiated ray equation, with A = x_m,xi + g n,xi and the normal at fixed xi written dn|xi:
  !!
  !!     A dxi + n dg = dx_s - sum N_i dx_i - g dn|xi,    dn = dn|xi + n,xi dxi
  pure subroutine evaluate_gap_derivatives(facets, x, f, xi, g, derivative)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: f                     !< facet
    real(DP), intent(in) :: xi(2)                !< natural coordinates of the projection [-]
    real(DP), intent(in) :: g                    !< gap [length]
    type(gap_derivatives_type), intent(out) :: derivative
    type(facet_geometry_type) :: geometry
    type(surface_point_type) :: surface_point
    real(DP) :: inverse(3, 3), det, b(3, 3)
    integer :: j, i
    if (allocated(facets%profile)) then
      call evaluate_profile_derivative(facets, x, f, xi, g, derivative)
      return
    end if
    call build_facet_geometry(facets, x, f, geometry)
    call evaluate_surface_point(geometry, xi, surface_point)
    call initialize_derivatives(facets, f, geometry, surface_point, derivative)
    call add_normal_derivatives(facets, x, f, geometry, surface_point, derivative)
    call invert(reshape([surface_point%dx + g * surface_point%dn_dxi, surface_point%normal], [3, 3]), inverse, det)
    derivative%d_xi_slave = inverse(:2, :)
    derivative%d_gap_slave = inverse(3, :)
    derivative%d_n_slave = matmul(surface_point%dn_dxi, inverse(:2, :))
    do j = 1, derivative%n_nodes
      b = -g * derivative%d_n(:, :, j)
      if (j <= derivative%n_weights) then
        do i = 1, 3
          b(i, i) = b(i, i) - derivative%weights(j)
        end do
      end if
      derivative%d_xi(:, :, j) = matmul(inverse(:2, :), b)
      derivative%d_gap(:, j) = matmul(inverse(3, :), b)
      derivative%d_n(:, :, j) = derivative%d_n(:, :, j) + matmul(surface_point%dn_dxi, derivative%d_xi(:, :, j))
    end do
  end subroutine evaluate_gap_derivatives


  !> Current position of a material point of the master.
  pure subroutine evaluate_facet_point(facets, x, f, xi, xm)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: f                     !< facet
    real(DP), intent(in) :: xi(2)                !< natural coordinates [-]
    real(DP), intent(out) :: xm(3)               !< [length]
    real(DP) :: N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: n, nodes(MAX_FACE_NODES), i
    call facet_nodes(facets, f, n, nodes)
    call facet_shapes(facets%kind(f), xi, N_i, dN, ddN)
    xm = 0
    do i = 1, n
      xm = xm + N_i(i) * x(:, nodes(i))
    end do
  end subroutine evaluate_facet_point


  !> The area-weighted normal of a vertex: the sum over its star.
  pure function evaluate_vertex_normal(facets, x, vertex, is_whole) result(m)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: vertex                !< number of the vertex, as in facets%vertex
    logical, intent(in), optional :: is_whole    !< .true.: including the parts that a symmetry plane removes
    real(DP) :: m(3)                             !< [length^2]
    real(DP) :: tangents(3, 2), xi(2, MAX_FACE_NODES)
    integer :: s, f
    m = 0
    do s = facets%star_first(vertex), facets%star_first(vertex + 1) - 1
      f = facets%star_facet(s)
      call facet_node_coordinates(facets%kind(f), xi)
      call facet_tangents(facets, x, f, xi(:, facets%star_local(s)), tangents)
      m = m + natural_area(facets%kind(f)) * cross_product(tangents(:, 1), tangents(:, 2))
    end do
    if (present(is_whole)) return
    if (allocated(facets%symmetry_projector)) m = matmul(facets%symmetry_projector(:, :, vertex), m)
  end function evaluate_vertex_normal


  !> The derivative of the unit normal of a vertex with respect to the nodes of its star: dn = (1 - n n')/|m| dm.
  pure subroutine evaluate_vertex_derivative(facets, x, vertex, nodes, d_n)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: vertex                !< number of the vertex, as in facets%vertex
    integer, allocatable, intent(out) :: nodes(:)       !< (n) nodes of the star, each once
    real(DP), allocatable, intent(out) :: d_n(:, :, :)  !< (3, 3, n) dn/dx_j [1/length]
    type(gap_derivatives_type) :: derivative
    real(DP) :: m(3)
    integer :: s, n, k, own(MAX_FACE_NODES)
    allocate (nodes(0))
    do s = facets%star_first(vertex), facets%star_first(vertex + 1) - 1
      call facet_nodes(facets, facets%star_facet(s), n, own)
      do k = 1, n
        if (.not. any(nodes == own(k))) nodes = [nodes, own(k)]
      end do
    end do
    m = evaluate_vertex_normal(facets, x, vertex)
    derivative%nodes = nodes
    allocate (derivative%d_n(3, 3, size(nodes)), source=0.0_DP)
    do s = facets%star_first(vertex), facets%star_first(vertex + 1) - 1
      call add_star_facet(facets, x, facets%star_facet(s), facets%star_local(s), projector(m / norm2(m)) / norm2(m), &
        derivative)
    end do
    call move_alloc(derivative%d_n, d_n)
  end subroutine evaluate_vertex_derivative


  !> The excess of a point beyond each edge, over the length of the facet across that edge; negative inside. Edge 4 of a triangle,
  !! edges 3 and 4 of a line: -1.
  pure function find_edge_excess(kind, xi) result(excess)
    integer, intent(in) :: kind                  !< FACET_...
    real(DP), intent(in) :: xi(2)                !< natural coordinates [-]
    real(DP) :: excess(4)
    if (is_triangle(kind)) then
      excess = [-xi(2), xi(1) + xi(2) - 1, -xi(1), -1.0_DP]
    else if (is_line_facet(kind)) then
      excess = [0.5_DP * (-1 - xi(1)), 0.5_DP * (xi(1) - 1), -1.0_DP, -1.0_DP]
    else
      excess = 0.5_DP * [-1 - xi(2), xi(1) - 1, xi(2) - 1, -1 - xi(1)]
    end if
  end function find_edge_excess


  !> The edge that the walk crosses; 0 if the walk ends here, with the status of its end.
  pure subroutine choose_crossed_edge(facets, f, excess, extension, status, edge)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                     !< facet
    real(DP), intent(in) :: excess(4)            !< over its edges [-]
    real(DP), intent(in) :: extension            !< extension zone of the facet [-]
    integer, intent(inout) :: status             !< of the projection on this facet; out: OUTSIDE beyond the extension zone
    integer, intent(out) :: edge
    logical :: is_out(4)
    real(DP) :: kept  ! excess up to which the point stays on this facet although the master continues [-]
    edge = 0
    kept = merge(EDGE_HYSTERESIS, TOL_ON_EDGE, facets%is_faceted)
    if (facets%is_faceted .and. extension > EXTENSION_ZONE) kept = extension
    is_out = excess > kept .and. facets%edge(:, f) /= EDGE_FREE
    if (any(is_out)) then
      edge = maxloc(excess, dim=1, mask=is_out)
    else if (any(excess > extension) .and. status == PROJECTION_INSIDE) then
      status = PROJECTION_OUTSIDE
    end if
  end subroutine choose_crossed_edge


  !> Chooses the facet if a walk returns over the same edge: the point is beyond the common edge on both sides (a concave crease
  !! from below, a convex one from above). The facet with the smaller excess takes it if that is within the extension zone.
  pure function choose_nearer_projection(facets, x, point, one, two, extension) result(nearer)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    type(projection_type), intent(in) :: one, two
    real(DP), intent(in) :: extension            !< extension zone of a facet [-]
    type(projection_type) :: nearer
    real(DP) :: beyond(2)
    beyond(1) = maxval(find_edge_excess(facets%kind(one%facet), one%xi))
    beyond(2) = maxval(find_edge_excess(facets%kind(two%facet), two%xi))
    if (one%status == PROJECTION_FAILED) beyond(1) = huge(1.0_DP)
    if (two%status == PROJECTION_FAILED) beyond(2) = huge(1.0_DP)
    nearer = two
    if (beyond(1) < beyond(2) .or. (.not. beyond(2) < beyond(1) .and. one%facet < two%facet)) nearer = one
    if (facets%is_faceted .and. abs(beyond(1) - beyond(2)) <= TOL_EQUAL_DISTANCE) then
      nearer = two
      if (find_centre_distance(facets, x, one%facet, point) < find_centre_distance(facets, x, two%facet, point)) nearer = one
    end if
    if (nearer%status == PROJECTION_FAILED) return
    nearer%status = merge(PROJECTION_INSIDE, PROJECTION_OUTSIDE, minval(beyond) <= extension)
  end function choose_nearer_projection


  !> Whether the facet by itself contains the point: inside, or in the extension zone of a free edge.
  pure function is_projection_inside(facets, projection) result(holds)
    type(facets_type), intent(in) :: facets
    type(projection_type), intent(in) :: projection
    logical :: holds
    real(DP) :: excess(4)
    integer :: f
    f = projection%facet
    excess = find_edge_excess(facets%kind(f), projection%xi)
    holds = all(excess <= TOL_ON_EDGE .or. (excess <= EXTENSION_ZONE .and. facets%edge(:, f) == EDGE_FREE))
  end function is_projection_inside


  !> The path length from a point to a facet: the gap plus the excess beyond an edge.
  pure function find_facet_distance(facets, projection) result(path_length)
    type(facets_type), intent(in) :: facets
    type(projection_type), intent(in) :: projection
    real(DP) :: path_length                              !< [length]
    real(DP) :: beyond
    beyond = max(maxval(find_edge_excess(facets%kind(projection%facet), projection%xi)), 0.0_DP)
    path_length = hypot(projection%gap, beyond * facets%edge_length(projection%facet))
  end function find_facet_distance


  !> Whether the normals of master and slave face each other; .true. without a slave normal.
  pure function is_facing_slave(normal, slave_normal) result(faces)
    real(DP), intent(in) :: normal(3)            !< of the master [-]
    real(DP), intent(in), optional :: slave_normal(3)
    logical :: faces
    faces = .true.
    if (.not. present(slave_normal)) return
    faces = dot_product(normal, slave_normal) < 0 .or. all(abs(slave_normal) <= 0)
  end function is_facing_slave


  !> The projection of a point on one facet, extended beyond its edges: Newton's method for the ray, 3 equations.
  !!
  !! Start: the closest point of the plane through the centre. Steps are limited, and halved while the residual rises. For a point
  !! too far beyond an edge the iteration ends at the bound MAX_NEWTON_EXCESS with xi there, which determines the edge to cross.
  !! Status INSIDE or FAILED.
  pure function project_on_facet(facets, x, point, f) result(projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer, intent(in) :: f                     !< facet
    type(projection_type) :: projection
    type(facet_geometry_type) :: geometry
    type(surface_point_type) :: surface_point
    real(DP) :: xi(2), g, step(3), moved, before, tolerance
    integer :: iteration
    logical :: is_at_border, was_at_border
    call build_facet_geometry(facets, x, f, geometry)
    call initialize_projection(geometry, point, xi, g)
    call evaluate_surface_point(geometry, xi, surface_point)
    projection%facet = f
    tolerance = max(1.0e-12_DP, 16 * epsilon(1.0_DP) * maxval(abs(point)) / geometry%size)
    was_at_border = .false.
    before = huge(1.0_DP)
    do iteration = 1, MAX_NEWTON_ITERATIONS
      call find_newton_step(geometry, point, g, surface_point, step)
      call limit_newton_step(geometry%kind, xi, step, is_at_border)
      call apply_damped_step(geometry, point, step, xi, g, surface_point)
      if (is_at_border .and. was_at_border) exit
      was_at_border = is_at_border
      moved = max(maxval(abs(step(:2))), abs(step(3)) / geometry%size)
      if (is_at_border) cycle
      if (moved <= tolerance .or. (moved <= TOL_STAGNATION .and. moved >= 0.5_DP * before)) exit
      before = moved
    end do
    if (iteration <= MAX_NEWTON_ITERATIONS) projection%status = PROJECTION_INSIDE
    projection%xi = xi
    projection%gap = g
    projection%normal = surface_point%normal
  end function project_on_facet


  !> The Newton step of the ray equation; zero where its matrix is singular (the centre of curvature).
  pure subroutine find_newton_step(geometry, point, g, surface_point, step)
    type(facet_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(in) :: g                    !< gap [length]
    type(surface_point_type), intent(in) :: surface_point
    real(DP), intent(out) :: step(3)             !< of xi and g
    real(DP) :: inverse(3, 3), det
    call invert(reshape([surface_point%dx + g * surface_point%dn_dxi, surface_point%normal], [3, 3]), inverse, det)
    step = matmul(inverse, point - surface_point%x - g * surface_point%normal)
    if (abs(det) > 1.0e-10_DP * area_scale(geometry)) return
    step(:2) = 0
    step(3) = dot_product(surface_point%normal, point - surface_point%x) - g
  end subroutine find_newton_step


  !> Limits a step that is too long or leads too far beyond the facet.
  pure subroutine limit_newton_step(kind, xi, step, is_at_border)
    integer, intent(in) :: kind                  !< FACET_...
    real(DP), intent(in) :: xi(2)                !< [-]
    real(DP), intent(inout) :: step(3)           !< of xi and g
    logical, intent(out) :: is_at_border         !< the step was cut at the bound
    real(DP) :: longest, excess(4), target_excess(4), part
    integer :: k
    longest = maxval(abs(step(:2))) * merge(1.0_DP, 0.5_DP, is_triangle(kind))
    if (longest > MAX_NATURAL_STEP) step = step * MAX_NATURAL_STEP / longest
    excess = find_edge_excess(kind, xi)
    target_excess = find_edge_excess(kind, xi + step(:2))
    part = 1
    do k = 1, 4
      if (target_excess(k) <= max(MAX_NEWTON_EXCESS, excess(k))) cycle
      part = min(part, max(MAX_NEWTON_EXCESS - excess(k), 0.0_DP) / (target_excess(k) - excess(k)))
    end do
    is_at_border = part < 1
    step = part * step
  end subroutine limit_newton_step


  !> Takes a step, halved at most four times while the distance from the ray rises.
  pure subroutine apply_damped_step(geometry, point, step, xi, g, surface_point)
    type(facet_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(inout) :: step(3)           !< of xi and g; out: as taken
    real(DP), intent(inout) :: xi(2), g
    type(surface_point_type), intent(inout) :: surface_point
    real(DP) :: before
    integer :: halving
    before = norm2(point - surface_point%x - g * surface_point%normal)
    do halving = 0, 4
      call evaluate_surface_point(geometry, xi + step(:2), surface_point)
      if (norm2(point - surface_point%x - (g + step(3)) * surface_point%normal) <= before + 1.0e-12_DP * geometry%size) exit
      if (halving < 4) step = 0.5_DP * step
    end do
    xi = xi + step(:2)
    g = g + step(3)
  end subroutine apply_damped_step


  !> Start of Newton's method: the closest point on the plane through the facet's centre, moved into the facet.
  pure subroutine initialize_projection(geometry, point, xi, g)
    type(facet_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(out) :: xi(2)               !< [-]
    real(DP), intent(out) :: g                   !< [length]
    type(surface_point_type) :: surface_point
    real(DP) :: inverse(3, 3), det, normal(3), step(3)
    xi = merge(1.0_DP / 3.0_DP, 0.0_DP, is_triangle(geometry%kind))
    call evaluate_surface_point(geometry, xi, surface_point)
    normal = cross_product(surface_point%dx(:, 1), surface_point%dx(:, 2))
    normal = normal / max(norm2(normal), tiny(1.0_DP))
    call invert(reshape([surface_point%dx, normal], [3, 3]), inverse, det)
    step = matmul(inverse, point - surface_point%x)
    if (is_triangle(geometry%kind)) then
      xi = min(max(xi + step(:2), 0.0_DP), 1.0_DP)
      if (sum(xi) > 1) xi = xi / sum(xi)
    else
      xi = min(max(step(:2), -1.0_DP), 1.0_DP)
    end if
    call evaluate_surface_point(geometry, xi, surface_point)
    g = dot_product(surface_point%normal, point - surface_point%x)
  end subroutine initialize_projection


  !> Coordinates and vertex normals of a facet's nodes. A node whose star has no area there (the tip of a collapsed facet) has none;
  !! the interpolation uses the others.
  pure subroutine build_facet_geometry(facets, x, f, geometry)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    integer, intent(in) :: f                     !< facet
    type(facet_geometry_type), intent(out) :: geometry
    real(DP) :: length
    integer :: i
    geometry%kind = facets%kind(f)
    geometry%size = facets%edge_length(f)
    call facet_nodes(facets, f, geometry%n, geometry%nodes)
    do i = 1, geometry%n
      geometry%x(:, i) = x(:, geometry%nodes(i))
      geometry%m(:, i) = evaluate_vertex_normal(facets, x, facets%vertex(facets%first(f) + i - 1))
      length = norm2(geometry%m(:, i))
      if (length > MIN_VERTEX_NORMAL * area_scale(geometry)) then
        geometry%normal(:, i) = geometry%m(:, i) / length
      else
        geometry%m(:, i) = 0
      end if
    end do
  end subroutine build_facet_geometry


  !> Point, normal and their derivatives at natural coordinates.
  pure subroutine evaluate_surface_point(geometry, xi, surface_point)
    type(facet_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: xi(2)                !< [-]
    type(surface_point_type), intent(out) :: surface_point
    real(DP) :: s(3), ddN(3, MAX_FACE_NODES), slope(3)
    integer :: k
    call facet_shapes(geometry%kind, xi, surface_point%N, surface_point%dN, ddN)
    surface_point%x = matmul(geometry%x, surface_point%N)
    s = matmul(geometry%normal, surface_point%N)
    surface_point%length = max(norm2(s), tiny(1.0_DP))
    surface_point%normal = s / surface_point%length
    do k = 1, 2
      surface_point%dx(:, k) = matmul(geometry%x, surface_point%dN(k, :))
      if (k == 2 .and. is_line_facet(geometry%kind)) surface_point%dx(3, k) = 1
      slope = matmul(geometry%normal, surface_point%dN(k, :)) / surface_point%length
      surface_point%dn_dxi(:, k) = slope - dot_product(surface_point%normal, slope) * surface_point%normal
    end do
  end subroutine evaluate_surface_point


  !> Allocates the derivatives and sets nodes and weights. A node listed twice by a collapsed facet gets both weights.
  pure subroutine initialize_derivatives(facets, f, geometry, surface_point, derivative)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                     !< facet
    type(facet_geometry_type), intent(in) :: geometry
    type(surface_point_type), intent(in) :: surface_point
    type(gap_derivatives_type), intent(inout) :: derivative
    integer :: i, j, n
    derivative%nodes = facets%stencil(facets%stencil_first(f):facets%stencil_first(f + 1) - 1)
    n = size(derivative%nodes)
    derivative%n_nodes = n
    derivative%n = surface_point%normal
    do i = 1, geometry%n
      derivative%n_weights = max(derivative%n_weights, findloc(derivative%nodes, geometry%nodes(i), dim=1))
    end do
    allocate (derivative%weights(derivative%n_weights), derivative%d_weights(2, derivative%n_weights), source=0.0_DP)
    allocate (derivative%d_gap(3, n), derivative%d_xi(2, 3, n), derivative%d_n(3, 3, n), source=0.0_DP)
    do i = 1, geometry%n
      j = findloc(derivative%nodes, geometry%nodes(i), dim=1)
      derivative%weights(j) = derivative%weights(j) + surface_point%N(i)
      derivative%d_weights(:, j) = derivative%d_weights(:, j) + surface_point%dN(:, i)
    end do
  end subroutine initialize_derivatives


  !> Adds dn|xi, the derivative of the normal at fixed xi, to d_n: through the vertex normals to all nodes of the stars.
  !!
  !!     dn|xi = (1 - n n')/|s| sum N_i dn_i,   dn_i = (1 - n_i n_i')/|m_i| dm_i,
  !!     dm_i  = sum over the star, sum over j, A_0 (N_j,2 [x,1]x - N_j,1 [x,2]x) dx_j
  pure subroutine add_normal_derivatives(facets, x, f, geometry, surface_point, derivative)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    integer, intent(in) :: f                     !< facet
    type(facet_geometry_type), intent(in) :: geometry
    type(surface_point_type), intent(in) :: surface_point
    type(gap_derivatives_type), intent(inout) :: derivative
    real(DP) :: project(3, 3), to_vertex(3, 3), length
    integer :: i, v, s
    project = projector(surface_point%normal) / surface_point%length
    do i = 1, geometry%n
      length = norm2(geometry%m(:, i))
      if (length <= 0) cycle
      to_vertex = matmul(project, projector(geometry%normal(:, i))) * (surface_point%N(i) / length)
      v = facets%vertex(facets%first(f) + i - 1)
      if (allocated(facets%symmetry_projector)) to_vertex = matmul(to_vertex, facets%symmetry_projector(:, :, v))
      do s = facets%star_first(v), facets%star_first(v + 1) - 1
        call add_star_facet(facets, x, facets%star_facet(s), facets%star_local(s), to_vertex, derivative)
      end do
    end do
  end subroutine add_normal_derivatives


  !> Contribution of one facet of a star: to_vertex times the derivative of its A_0 (x,1 x x,2) with respect to one of its nodes.
  pure subroutine add_star_facet(facets, x, f, local, to_vertex, derivative)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    integer, intent(in) :: f, local              !< facet of the star, local number of the vertex's node
    real(DP), intent(in) :: to_vertex(3, 3)      !< d n|xi / d m_i [1/length^2]
    type(gap_derivatives_type), intent(inout) :: derivative
    real(DP) :: xi(2, MAX_FACE_NODES), N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    real(DP) :: tangents(3, 2)
    integer :: n, nodes(MAX_FACE_NODES), i, j
    call facet_nodes(facets, f, n, nodes)
    call facet_node_coordinates(facets%kind(f), xi)
    call facet_shapes(facets%kind(f), xi(:, local), N_i, dN, ddN)
    call facet_tangents(facets, x, f, xi(:, local), tangents)
    do i = 1, n
      j = findloc(derivative%nodes, nodes(i), dim=1)
      derivative%d_n(:, :, j) = derivative%d_n(:, :, j) + natural_area(facets%kind(f)) * &
        matmul(to_vertex, skew_matrix(dN(2, i) * tangents(:, 1) - dN(1, i) * tangents(:, 2)))
    end do
  end subroutine add_star_facet


  !> 1 - n n'.
  pure function projector(n) result(P)
    real(DP), intent(in) :: n(3)                 !< unit vector
    real(DP) :: P(3, 3)
    integer :: i
    P = -spread(n, 2, 3) * spread(n, 1, 3)
    do i = 1, 3
      P(i, i) = P(i, i) + 1
    end do
  end function projector


  !> Reference size for areas of a facet; a line has depth one [length^2].
  pure real(DP) function area_scale(geometry)
    type(facet_geometry_type), intent(in) :: geometry
    area_scale = geometry%size**2
    if (is_line_facet(geometry%kind)) area_scale = geometry%size
  end function area_scale


  !> Area of a facet kind in natural coordinates; length of a line.
  pure function natural_area(kind) result(area)
    integer, intent(in) :: kind                  !< FACET_...
    real(DP) :: area
    area = merge(0.5_DP, 4.0_DP, is_triangle(kind))
    if (is_line_facet(kind)) area = 2.0_DP
  end function natural_area


  !> Whether a facet kind is a triangle.
  pure function is_triangle(kind) result(is)
    integer, intent(in) :: kind                  !< FACET_...
    logical :: is
    is = kind == FACET_TRI3 .or. kind == FACET_TRI6
  end function is_triangle

end module amontons_surface_projection
