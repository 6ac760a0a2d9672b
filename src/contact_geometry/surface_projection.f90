!> Gap: projection of a slave node on the master along its smooth normal, the gap, and all derivatives of both.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The projection is the ray along the interpolated normal (doc/theory/contact.md):
!!
!!     x_s = x_m(xi) + g n(xi),   x_m = sum N_i x_i,   n = s/|s|,   s = sum N_i n_i
!!     n_i = m_i/|m_i|,   m_i = sum over the star of vertex i of A_0 (x,1 x x,2) there,   A_0 area of the natural facet
!!
!! with the unknowns xi and g. Point and normal are continuous over smooth edges, so the projection is too, and there
!! are no dead zones between facets. A master that is a profile is handed on to `analytic`. `x` is always the array of the
!! coordinates of all mesh nodes, (3, n_nodes).
module amontons_surface_projection
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product, invert
  use amontons_topology, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, MAX_FACE_NODES
  use amontons_shape_functions, only: facet_shapes, facet_node_coordinates
  use amontons_facets, only: facets_type, facet_nodes, facet_tangents, is_line, EDGE_FREE, EDGE_SMOOTH, EDGE_CONVEX, EDGE_CONCAVE
  use amontons_facet_search, only: search_type, near_facets
  use amontons_analytic_master, only: projection_type, gap_derivative_type, PROJECT_ON, PROJECT_OFF, PROJECT_FAILED, &
    project_on_profile, find_on_profile, profile_derivative
  implicit none
  private
  public :: projection_type, gap_derivative_type
  public :: project_point, find_projection, gap_derivative, fixed_point, vertex_normal, smooth_normal, &
    vertex_derivative, excess_over_edges
  public :: PROJECT_ON, PROJECT_OFF, PROJECT_FAILED

  real(DP), parameter :: EXTENSION_ZONE = 0.1_DP       !< a node this far beyond a free edge is on, over facet length [-]
  real(DP), parameter :: ON_EDGE = 1.0e-8_DP      !< a node this little beyond any edge is on the facet, same unit [-]
  real(DP), parameter :: KEEPING = 1.0e-3_DP      !< where normals jump at edges a facet keeps a node that is this little beyond [-]
  real(DP), parameter :: FARTHEST = 0.6_DP        !< the Newton iteration is kept within this excess, the same unit [-]
  real(DP), parameter :: LONGEST_STEP = 0.5_DP    !< longest step of a natural coordinate, in lengths of the facet [-]
  real(DP), parameter :: SAME = 1.0e-9_DP         !< distances that differ by less than this part of an edge: equal [-]
  real(DP), parameter :: NEARLY_DONE = 1.0e-8_DP  !< steps this small that do not shrink any more are rounding [-]
  real(DP), parameter :: COLLAPSED = 1.0e-12_DP   !< smallest vertex normal, over the length squared [-]
  integer, parameter :: MOST_ITERATIONS = 40      !< of Newton on one facet
  integer, parameter :: MOST_STEPS = 400          !< longest walk, in facets

  !> One facet in one configuration.
  type :: frame_type
    integer :: kind = 0                          !< FACET_...
    integer :: n = 0                             !< nodes
    integer :: nodes(MAX_FACE_NODES) = 0
    real(DP) :: x(3, MAX_FACE_NODES) = 0         !< their coordinates [length]
    real(DP) :: m(3, MAX_FACE_NODES) = 0         !< their vertex normals, area weighted [length^2]
    real(DP) :: normal(3, MAX_FACE_NODES) = 0    !< their unit vertex normals [-]
    real(DP) :: size = 1                         !< a length of the facet [length]
  end type frame_type

  !> Point, normal and their slopes at natural coordinates of a frame.
  type :: place_type
    real(DP) :: N(MAX_FACE_NODES) = 0            !< shape functions [-]
    real(DP) :: dN(2, MAX_FACE_NODES) = 0        !< their slopes [-]
    real(DP) :: x(3) = 0                         !< x_m [length]
    real(DP) :: normal(3) = 0                    !< n [-]
    real(DP) :: length = 0                       !< |s| [-]
    real(DP) :: dx(3, 2) = 0                     !< x_m,1 and x_m,2 [length]
    real(DP) :: dn_dxi(3, 2) = 0                 !< n,1 and n,2 [-]
  end type place_type

contains

  !> Follows a point from a facet over the neighbours to where it is now.
  !!
  !! It walks over smooth edges and valleys. At a free edge, or a crease that sticks out, the facet reaches up to a
  !! tenth of its length beyond itself (as Abaqus's extension zone); past that the walk tries the other side of a ridge,
  !! else the point is OFF. On anything but ON, f is the last facet looked at. A point that keeps to an edge may be given a longer
  !! extension.
  pure subroutine project_point(facets, x, point, f, xi, g, n, status, extension)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer, intent(inout) :: f                  !< facet where the walk starts; out: where it ends
    real(DP), intent(out) :: xi(2)               !< natural coordinates [-]
    real(DP), intent(out) :: g                   !< gap [length]
    real(DP), intent(out) :: n(3)                !< unit normal [-]
    integer, intent(out) :: status               !< PROJECT_...
    real(DP), intent(in), optional :: extension  !< over the length of the facet, if more than a tenth [-]
    type(projection_type) :: here, previous
    real(DP) :: excess(4), reach
    integer :: step, edge, before
    reach = EXTENSION_ZONE
    if (present(extension)) reach = max(reach, extension)
    if (allocated(facets%profile)) then
      call project_on_profile(facets, x, point, f, here)
      f = here%facet
      xi = here%xi
      g = here%gap
      n = here%normal
      status = here%status
      return
    end if
    before = 0
    do step = 1, MOST_STEPS
      here = project_on_facet(facets, x, point, f)
      excess = excess_over_edges(facets%kind(f), here%xi)
      call choose_edge(facets, f, excess, reach, here%status, edge)
      if (edge == 0) exit
      if (facets%neighbour(edge, f) == before) then
        here = nearer_of_two(facets, x, point, here, previous, reach)
        exit
      end if
      before = f
      previous = here
      f = facets%neighbour(edge, f)
    end do
    if (step > MOST_STEPS) here%status = PROJECT_FAILED
    f = here%facet
    xi = here%xi
    g = here%gap
    n = here%normal
    status = here%status
  end subroutine project_point


  !> The projection of a point that has none yet: of all facets near it that hold it, the one with the shortest way.
  !!
  !! The way is the gap, and beyond an edge (extension zone) also the length beyond it. Facets that face the slave go
  !! before those that do not. Between equal ways the lowest facet number is taken. After: status ON, or
  !! OFF with facet 0 if there is none within max_distance. Before: the margin of the search is at least max_distance.
  pure subroutine find_projection(facets, search, x, point, max_distance, projection, slave_normal)
    type(facets_type), intent(in) :: facets
    type(search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(in) :: max_distance         !< largest |g| [length]
    type(projection_type), intent(out) :: projection
    real(DP), intent(in), optional :: slave_normal(3)   !< out of the slave; zero: unknown [-]
    type(projection_type) :: candidate
    integer, allocatable :: list(:)
    real(DP) :: way, shortest, least, same_way
    integer :: i, n, nearest
    logical :: is_facing, has_facing
    projection%status = PROJECT_OFF
    if (allocated(facets%profile)) then
      call find_on_profile(facets, x, point, max_distance, projection)
      return
    end if
    shortest = huge(1.0_DP)
    least = huge(1.0_DP)
    has_facing = .false.
    nearest = 0
    call near_facets(search, point, list, n)
    do i = 1, n
      candidate = project_on_facet(facets, x, point, list(i))
      if (candidate%status /= PROJECT_ON) cycle
      same_way = SAME * facets%edge_length(list(i))
      way = way_to_facet(facets, candidate)
      if (way < least - same_way) nearest = list(i)
      least = min(way, least)
      if (abs(candidate%gap) > max_distance .or. .not. holds_point(facets, candidate)) cycle
      is_facing = faces_slave(candidate%normal, slave_normal)
      if (has_facing .and. .not. is_facing) cycle
      if ((has_facing .eqv. is_facing) .and. way > shortest - same_way) then
        if (.not. facets%is_faceted .or. way > shortest + same_way) cycle
        if (middle_distance(facets, x, list(i), point) >= middle_distance(facets, x, projection%facet, point) - same_way) cycle
      end if
      has_facing = is_facing
      shortest = way
      projection = candidate
    end do
    if (projection%facet == 0 .and. nearest > 0) call walk_from(facets, x, point, max_distance, nearest, projection)
  end subroutine find_projection


  !> The distance of a point from the nearest centre of the triangles of a facet. Of facets that hold a point equally well CalculiX
  !! takes the one of the nearest triangle, and divides a square between its second and fourth corner as it numbers them.
  pure real(DP) function middle_distance(facets, x, f, point) result(distance)
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
      if (facets%face(f) == 1) at = reshape([1, 2, 3, 1, 3, 4], [3, 2])   ! there it begins at another corner
    else if (is_line(facets%kind(f))) then
      at = reshape([1, 2, 2, 1, 1, 2], [3, 2])
    end if
    distance = min(norm2(sum(x(:, nodes(at(:, 1))), dim=2) / 3 - point), norm2(sum(x(:, nodes(at(:, 2))), dim=2) / 3 - point))
  end function middle_distance


  !> The projection from a facet that is near but does not hold the point; stays as it is if that leads nowhere.
  pure subroutine walk_from(facets, x, point, max_distance, f, projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(in) :: max_distance         !< largest |g| [length]
    integer, intent(in) :: f                     !< facet
    type(projection_type), intent(inout) :: projection
    type(projection_type) :: found
    found%facet = f
    call project_point(facets, x, point, found%facet, found%xi, found%gap, found%normal, found%status)
    if (found%status == PROJECT_ON .and. abs(found%gap) <= max_distance) projection = found
  end subroutine walk_from


  !> The exact derivatives of xi, g and n at a projection (any g).
  !!
  !! The equation of the ray differentiated, with A = x_m,xi + g n,xi and the normal at fixed xi written dn|xi:
  !!
  !!     A dxi + n dg = dx_s - sum N_i dx_i - g dn|xi,    dn = dn|xi + n,xi dxi
  pure subroutine gap_derivative(facets, x, f, xi, g, derivative)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: f                     !< facet
    real(DP), intent(in) :: xi(2)                !< natural coordinates of the projection [-]
    real(DP), intent(in) :: g                    !< gap [length]
    type(gap_derivative_type), intent(out) :: derivative
    type(frame_type) :: frame
    type(place_type) :: place
    real(DP) :: inverse(3, 3), det, b(3, 3)
    integer :: j, i
    if (allocated(facets%profile)) then
      call profile_derivative(facets, x, f, xi, g, derivative)
      return
    end if
    call make_frame(facets, x, f, frame)
    call evaluate(frame, xi, place)
    call start_derivative(facets, f, frame, place, derivative)
    call add_normal_derivatives(facets, x, f, frame, place, derivative)
    call invert(reshape([place%dx + g * place%dn_dxi, place%normal], [3, 3]), inverse, det)
    derivative%d_xi_slave = inverse(:2, :)
    derivative%d_gap_slave = inverse(3, :)
    derivative%d_n_slave = matmul(place%dn_dxi, inverse(:2, :))
    do j = 1, derivative%n_nodes
      b = -g * derivative%d_n(:, :, j)
      if (j <= derivative%n_weights) then
        do i = 1, 3
          b(i, i) = b(i, i) - derivative%weights(j)
        end do
      end if
      derivative%d_xi(:, :, j) = matmul(inverse(:2, :), b)
      derivative%d_gap(:, j) = matmul(inverse(3, :), b)
      derivative%d_n(:, :, j) = derivative%d_n(:, :, j) + matmul(place%dn_dxi, derivative%d_xi(:, :, j))
    end do
  end subroutine gap_derivative


  !> Where a material point of the master is now.
  pure subroutine fixed_point(facets, x, f, xi, xm)
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
  end subroutine fixed_point


  !> The area-weighted normal of a vertex: the sum over its star.
  pure function vertex_normal(facets, x, vertex, is_whole) result(m)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: vertex                !< number of the vertex, as in facets%vertex
    logical, intent(in), optional :: is_whole    !< .true.: with the parts that a plane of symmetry takes away
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
    if (allocated(facets%in_plane)) m = matmul(facets%in_plane(:, :, vertex), m)
  end function vertex_normal


  !> The derivative of the unit normal of a vertex by the nodes of its star: dn = (1 - n n')/|m| dm.
  pure subroutine vertex_derivative(facets, x, vertex, nodes, d_n)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: vertex                !< number of the vertex, as in facets%vertex
    integer, allocatable, intent(out) :: nodes(:)       !< (n) nodes of the star, each once
    real(DP), allocatable, intent(out) :: d_n(:, :, :)  !< (3, 3, n) dn/dx_j [1/length]
    type(gap_derivative_type) :: derivative
    real(DP) :: m(3)
    integer :: s, n, k, own(MAX_FACE_NODES)
    allocate (nodes(0))
    do s = facets%star_first(vertex), facets%star_first(vertex + 1) - 1
      call facet_nodes(facets, facets%star_facet(s), n, own)
      do k = 1, n
        if (.not. any(nodes == own(k))) nodes = [nodes, own(k)]
      end do
    end do
    m = vertex_normal(facets, x, vertex)
    derivative%nodes = nodes
    allocate (derivative%d_n(3, 3, size(nodes)), source=0.0_DP)
    do s = facets%star_first(vertex), facets%star_first(vertex + 1) - 1
      call add_star_facet(facets, x, facets%star_facet(s), facets%star_local(s), projector(m / norm2(m)) / norm2(m), &
        derivative)
    end do
    call move_alloc(derivative%d_n, d_n)
  end subroutine vertex_derivative


  !> The unit normal n(xi) of the smooth surface.
  pure subroutine smooth_normal(facets, x, f, xi, n)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: f                     !< facet
    real(DP), intent(in) :: xi(2)                !< natural coordinates [-]
    real(DP), intent(out) :: n(3)                !< [-]
    type(frame_type) :: frame
    type(place_type) :: place
    call make_frame(facets, x, f, frame)
    call evaluate(frame, xi, place)
    n = place%normal
  end subroutine smooth_normal


  !> How far a point is beyond each edge, in lengths of the facet across that edge; negative inside. Edge 4 of a
  !! triangle, edges 3 and 4 of a line: -1.
  pure function excess_over_edges(kind, xi) result(excess)
    integer, intent(in) :: kind                  !< FACET_...
    real(DP), intent(in) :: xi(2)                !< natural coordinates [-]
    real(DP) :: excess(4)
    if (is_triangle(kind)) then
      excess = [-xi(2), xi(1) + xi(2) - 1, -xi(1), -1.0_DP]
    else if (is_line(kind)) then
      excess = [0.5_DP * (-1 - xi(1)), 0.5_DP * (xi(1) - 1), -1.0_DP, -1.0_DP]
    else
      excess = 0.5_DP * [-1 - xi(2), xi(1) - 1, xi(2) - 1, -1 - xi(1)]
    end if
  end function excess_over_edges


  !> The edge over which the walk goes on; 0 if it ends here, and then the status says how.
  pure subroutine choose_edge(facets, f, excess, extension, status, edge)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                     !< facet
    real(DP), intent(in) :: excess(4)            !< over its edges [-]
    real(DP), intent(in) :: extension            !< how far the facet reaches beyond itself [-]
    integer, intent(inout) :: status             !< of the projection on this facet; out: OFF beyond the extension zone
    integer, intent(out) :: edge
    logical :: is_out(4), is_open(4)
    real(DP) :: kept                               ! how far beyond an edge it stays here though the master goes on there [-]
    integer :: k
    edge = 0
    kept = merge(KEEPING, ON_EDGE, facets%is_faceted)
    if (facets%is_faceted .and. extension > EXTENSION_ZONE) kept = extension
    do k = 1, 4
      is_open(k) = facets%edge(k, f) == EDGE_SMOOTH .or. facets%edge(k, f) == EDGE_CONCAVE
    end do
    is_out = excess > kept
    if (any(is_out .and. is_open)) then
      edge = maxloc(excess, dim=1, mask=is_out .and. is_open)
    else if (any(excess > extension)) then
      is_out = is_out .and. facets%edge(:, f) == EDGE_CONVEX
      if (any(is_out)) edge = maxloc(excess, dim=1, mask=is_out)
      if (status == PROJECT_ON) status = PROJECT_OFF
    end if
  end subroutine choose_edge


  !> A walk came straight back: the point is beyond the common edge on both sides (a valley from below, a ridge from
  !! above). The side where it is less beyond holds it if that is within the extension zone.
  pure function nearer_of_two(facets, x, point, one, two, extension) result(nearer)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    type(projection_type), intent(in) :: one, two
    real(DP), intent(in) :: extension            !< how far a facet reaches beyond itself [-]
    type(projection_type) :: nearer
    real(DP) :: beyond(2)
    beyond(1) = maxval(excess_over_edges(facets%kind(one%facet), one%xi))
    beyond(2) = maxval(excess_over_edges(facets%kind(two%facet), two%xi))
    if (one%status == PROJECT_FAILED) beyond(1) = huge(1.0_DP)
    if (two%status == PROJECT_FAILED) beyond(2) = huge(1.0_DP)
    nearer = two
    if (beyond(1) < beyond(2) .or. (.not. beyond(2) < beyond(1) .and. one%facet < two%facet)) nearer = one
    if (facets%is_faceted .and. abs(beyond(1) - beyond(2)) <= SAME) then
      nearer = two
      if (middle_distance(facets, x, one%facet, point) < middle_distance(facets, x, two%facet, point)) nearer = one
    end if
    if (nearer%status == PROJECT_FAILED) return
    nearer%status = merge(PROJECT_ON, PROJECT_OFF, minval(beyond) <= extension)
  end function nearer_of_two


  !> Does the facet by itself hold the point: inside, or in the extension zone of a free edge or of a ridge?
  pure function holds_point(facets, projection) result(holds)
    type(facets_type), intent(in) :: facets
    type(projection_type), intent(in) :: projection
    logical :: holds
    real(DP) :: excess(4)
    integer :: f
    f = projection%facet
    excess = excess_over_edges(facets%kind(f), projection%xi)
    holds = all(excess <= ON_EDGE .or. &
      (excess <= EXTENSION_ZONE .and. (facets%edge(:, f) == EDGE_FREE .or. facets%edge(:, f) == EDGE_CONVEX)))
  end function holds_point


  !> The length of the way from a point to a facet: the gap, and what the projection is beyond an edge.
  pure function way_to_facet(facets, projection) result(way)
    type(facets_type), intent(in) :: facets
    type(projection_type), intent(in) :: projection
    real(DP) :: way                              !< [length]
    real(DP) :: beyond
    beyond = max(maxval(excess_over_edges(facets%kind(projection%facet), projection%xi)), 0.0_DP)
    way = hypot(projection%gap, beyond * facets%edge_length(projection%facet))
  end function way_to_facet


  !> Do the normals of master and slave face each other? Without a slave normal they do.
  pure function faces_slave(normal, slave_normal) result(faces)
    real(DP), intent(in) :: normal(3)            !< of the master [-]
    real(DP), intent(in), optional :: slave_normal(3)
    logical :: faces
    faces = .true.
    if (.not. present(slave_normal)) return
    faces = dot_product(normal, slave_normal) < 0 .or. all(abs(slave_normal) <= 0)
  end function faces_slave


  !> The projection of a point on one facet, extended beyond its edges: Newton on the ray, 3 equations.
  !!
  !! Start: the closest point of the plane through the centre. Steps are limited, and halved while the residual rises.
  !! A point so far beyond an edge that the facet's extension means nothing ends at the border (FARTHEST) with its xi
  !! there: enough to know which edge to cross. Status ON or FAILED.
  pure function project_on_facet(facets, x, point, f) result(projection)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: point(3)             !< x_s [length]
    integer, intent(in) :: f                     !< facet
    type(projection_type) :: projection
    type(frame_type) :: frame
    type(place_type) :: place
    real(DP) :: xi(2), g, step(3), moved, before, tolerance
    integer :: iteration
    logical :: is_at_border, was_at_border
    call make_frame(facets, x, f, frame)
    call start_projection(frame, point, xi, g)
    call evaluate(frame, xi, place)
    projection%facet = f
    tolerance = max(1.0e-12_DP, 16 * epsilon(1.0_DP) * maxval(abs(point)) / frame%size)
    was_at_border = .false.
    before = huge(1.0_DP)
    do iteration = 1, MOST_ITERATIONS
      call newton_step(frame, point, g, place, step)
      call limit_step(frame%kind, xi, step, is_at_border)
      call take_step(frame, point, step, xi, g, place)
      if (is_at_border .and. was_at_border) exit
      was_at_border = is_at_border
      moved = max(maxval(abs(step(:2))), abs(step(3)) / frame%size)
      if (is_at_border) cycle
      if (moved <= tolerance .or. (moved <= NEARLY_DONE .and. moved >= 0.5_DP * before)) exit
      before = moved
    end do
    if (iteration <= MOST_ITERATIONS) projection%status = PROJECT_ON
    projection%xi = xi
    projection%gap = g
    projection%normal = place%normal
  end function project_on_facet


  !> The Newton step of the ray equation; zero where its matrix is singular (the centre of curvature).
  pure subroutine newton_step(frame, point, g, place, step)
    type(frame_type), intent(in) :: frame
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(in) :: g                    !< gap [length]
    type(place_type), intent(in) :: place
    real(DP), intent(out) :: step(3)             !< of xi and g
    real(DP) :: inverse(3, 3), det
    call invert(reshape([place%dx + g * place%dn_dxi, place%normal], [3, 3]), inverse, det)
    step = matmul(inverse, point - place%x - g * place%normal)
    if (abs(det) > 1.0e-10_DP * area_scale(frame)) return
    step(:2) = 0
    step(3) = dot_product(place%normal, point - place%x) - g
  end subroutine newton_step


  !> Shortens a step that is too long or leads too far beyond the facet.
  pure subroutine limit_step(kind, xi, step, is_at_border)
    integer, intent(in) :: kind                  !< FACET_...
    real(DP), intent(in) :: xi(2)                !< [-]
    real(DP), intent(inout) :: step(3)           !< of xi and g
    logical, intent(out) :: is_at_border         !< the step ends at the border and wanted to go on
    real(DP) :: longest, excess(4), wanted(4), part
    integer :: k
    longest = maxval(abs(step(:2))) * merge(1.0_DP, 0.5_DP, is_triangle(kind))
    if (longest > LONGEST_STEP) step = step * LONGEST_STEP / longest
    excess = excess_over_edges(kind, xi)
    wanted = excess_over_edges(kind, xi + step(:2))
    part = 1
    do k = 1, 4
      if (wanted(k) <= max(FARTHEST, excess(k))) cycle
      part = min(part, max(FARTHEST - excess(k), 0.0_DP) / (wanted(k) - excess(k)))
    end do
    is_at_border = part < 1
    step = part * step
  end subroutine limit_step


  !> Takes a step, halved (at most four times) while the distance from the ray rises.
  pure subroutine take_step(frame, point, step, xi, g, place)
    type(frame_type), intent(in) :: frame
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(inout) :: step(3)           !< of xi and g; out: as taken
    real(DP), intent(inout) :: xi(2), g
    type(place_type), intent(inout) :: place
    real(DP) :: before
    integer :: halving
    before = norm2(point - place%x - g * place%normal)
    do halving = 0, 4
      call evaluate(frame, xi + step(:2), place)
      if (norm2(point - place%x - (g + step(3)) * place%normal) <= before + 1.0e-12_DP * frame%size) exit
      if (halving < 4) step = 0.5_DP * step
    end do
    xi = xi + step(:2)
    g = g + step(3)
  end subroutine take_step


  !> Where Newton starts: the closest point on the plane through the facet's centre, brought back to the facet.
  pure subroutine start_projection(frame, point, xi, g)
    type(frame_type), intent(in) :: frame
    real(DP), intent(in) :: point(3)             !< x_s [length]
    real(DP), intent(out) :: xi(2)               !< [-]
    real(DP), intent(out) :: g                   !< [length]
    type(place_type) :: place
    real(DP) :: inverse(3, 3), det, normal(3), step(3)
    xi = merge(1.0_DP / 3.0_DP, 0.0_DP, is_triangle(frame%kind))
    call evaluate(frame, xi, place)
    normal = cross_product(place%dx(:, 1), place%dx(:, 2))
    normal = normal / max(norm2(normal), tiny(1.0_DP))
    call invert(reshape([place%dx, normal], [3, 3]), inverse, det)
    step = matmul(inverse, point - place%x)
    if (is_triangle(frame%kind)) then
      xi = min(max(xi + step(:2), 0.0_DP), 1.0_DP)
      if (sum(xi) > 1) xi = xi / sum(xi)
    else
      xi = min(max(step(:2), -1.0_DP), 1.0_DP)
    end if
    call evaluate(frame, xi, place)
    g = dot_product(place%normal, point - place%x)
  end subroutine start_projection


  !> Coordinates and vertex normals of a facet's nodes. A node whose star has no area there (the tip of a collapsed
  !! facet) has no normal: the others give it.
  pure subroutine make_frame(facets, x, f, frame)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    integer, intent(in) :: f                     !< facet
    type(frame_type), intent(out) :: frame
    real(DP) :: length
    integer :: i
    frame%kind = facets%kind(f)
    frame%size = facets%edge_length(f)
    call facet_nodes(facets, f, frame%n, frame%nodes)
    do i = 1, frame%n
      frame%x(:, i) = x(:, frame%nodes(i))
      frame%m(:, i) = vertex_normal(facets, x, facets%vertex(facets%first(f) + i - 1))
      length = norm2(frame%m(:, i))
      if (length > COLLAPSED * area_scale(frame)) then
        frame%normal(:, i) = frame%m(:, i) / length
      else
        frame%m(:, i) = 0
      end if
    end do
  end subroutine make_frame


  !> Point, normal and slopes at natural coordinates.
  pure subroutine evaluate(frame, xi, place)
    type(frame_type), intent(in) :: frame
    real(DP), intent(in) :: xi(2)                !< [-]
    type(place_type), intent(out) :: place
    real(DP) :: s(3), ddN(3, MAX_FACE_NODES), slope(3)
    integer :: k
    call facet_shapes(frame%kind, xi, place%N, place%dN, ddN)
    place%x = matmul(frame%x, place%N)
    s = matmul(frame%normal, place%N)
    place%length = max(norm2(s), tiny(1.0_DP))
    place%normal = s / place%length
    do k = 1, 2
      place%dx(:, k) = matmul(frame%x, place%dN(k, :))
      if (k == 2 .and. is_line(frame%kind)) place%dx(3, k) = 1
      slope = matmul(frame%normal, place%dN(k, :)) / place%length
      place%dn_dxi(:, k) = slope - dot_product(place%normal, slope) * place%normal
    end do
  end subroutine evaluate


  !> Nodes, weights and room for the derivatives. A node that a collapsed facet names twice gets both weights.
  pure subroutine start_derivative(facets, f, frame, place, derivative)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                     !< facet
    type(frame_type), intent(in) :: frame
    type(place_type), intent(in) :: place
    type(gap_derivative_type), intent(inout) :: derivative
    integer :: i, j, n
    derivative%nodes = facets%stencil(facets%stencil_first(f):facets%stencil_first(f + 1) - 1)
    n = size(derivative%nodes)
    derivative%n_nodes = n
    derivative%n = place%normal
    do i = 1, frame%n
      derivative%n_weights = max(derivative%n_weights, findloc(derivative%nodes, frame%nodes(i), dim=1))
    end do
    allocate (derivative%weights(derivative%n_weights), derivative%d_weights(2, derivative%n_weights), source=0.0_DP)
    allocate (derivative%d_gap(3, n), derivative%d_xi(2, 3, n), derivative%d_n(3, 3, n), source=0.0_DP)
    do i = 1, frame%n
      j = findloc(derivative%nodes, frame%nodes(i), dim=1)
      derivative%weights(j) = derivative%weights(j) + place%N(i)
      derivative%d_weights(:, j) = derivative%d_weights(:, j) + place%dN(:, i)
    end do
  end subroutine start_derivative


  !> Adds dn|xi, the derivative of the normal at fixed xi, to d_n: through the vertex normals to all nodes of the stars.
  !!
  !!     dn|xi = (1 - n n')/|s| sum N_i dn_i,   dn_i = (1 - n_i n_i')/|m_i| dm_i,
  !!     dm_i  = sum over the star, sum over j, A_0 (N_j,2 [x,1]x - N_j,1 [x,2]x) dx_j
  pure subroutine add_normal_derivatives(facets, x, f, frame, place, derivative)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    integer, intent(in) :: f                     !< facet
    type(frame_type), intent(in) :: frame
    type(place_type), intent(in) :: place
    type(gap_derivative_type), intent(inout) :: derivative
    real(DP) :: project(3, 3), to_vertex(3, 3), length
    integer :: i, v, s
    project = projector(place%normal) / place%length
    do i = 1, frame%n
      length = norm2(frame%m(:, i))
      if (length <= 0) cycle
      to_vertex = matmul(project, projector(frame%normal(:, i))) * (place%N(i) / length)
      v = facets%vertex(facets%first(f) + i - 1)
      if (allocated(facets%in_plane)) to_vertex = matmul(to_vertex, facets%in_plane(:, :, v))
      do s = facets%star_first(v), facets%star_first(v + 1) - 1
        call add_star_facet(facets, x, facets%star_facet(s), facets%star_local(s), to_vertex, derivative)
      end do
    end do
  end subroutine add_normal_derivatives


  !> One facet of a star: to_vertex times the derivative of its A_0 (x,1 x x,2) at one of its nodes.
  pure subroutine add_star_facet(facets, x, f, local, to_vertex, derivative)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
    integer, intent(in) :: f, local              !< facet of the star, local number of the vertex's node
    real(DP), intent(in) :: to_vertex(3, 3)      !< d n|xi / d m_i [1/length^2]
    type(gap_derivative_type), intent(inout) :: derivative
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
        matmul(to_vertex, skew(dN(2, i) * tangents(:, 1) - dN(1, i) * tangents(:, 2)))
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


  !> [a]x, the matrix with [a]x b = a x b.
  pure function skew(a) result(matrix)
    real(DP), intent(in) :: a(3)
    real(DP) :: matrix(3, 3)
    matrix = reshape([0.0_DP, a(3), -a(2), -a(3), 0.0_DP, a(1), a(2), -a(1), 0.0_DP], [3, 3])
  end function skew


  !> A size that areas of a facet are compared with; a line is one deep [length^2].
  pure real(DP) function area_scale(frame)
    type(frame_type), intent(in) :: frame
    area_scale = frame%size**2
    if (is_line(frame%kind)) area_scale = frame%size
  end function area_scale


  !> Area of a facet kind in natural coordinates; length of a line.
  pure function natural_area(kind) result(area)
    integer, intent(in) :: kind                  !< FACET_...
    real(DP) :: area
    area = merge(0.5_DP, 4.0_DP, is_triangle(kind))
    if (is_line(kind)) area = 2.0_DP
  end function natural_area


  !> Is a facet kind a triangle?
  pure function is_triangle(kind) result(is)
    integer, intent(in) :: kind                  !< FACET_...
    logical :: is
    is = kind == FACET_TRI3 .or. kind == FACET_TRI6
  end function is_triangle

end module amontons_surface_projection
