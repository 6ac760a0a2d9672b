!> Mortar: the rows of a slave surface from integrals over the parts of its faces that face the master: inv(D) M.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Mortar". Each slave facet is cut with the master facets in front of it, projected on the plane
!! through the slave facet (M. Puso, T. Laursen, Comput. Methods Appl. Mech. Engrg. 193 (2004) 601-629). With dual functions phi_j
!! (B. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989-1012; `dual`) D is diagonal and a row needs no equations to be solved:
!!
!!     d_j = x^_j - sum M_ji x_i / D_j,    D_j = integral of N~_j,    M_ji = integral of phi_j N_i (at the master)
module amontons_mortar
  use amontons_kinds, only: DP, PI
  use amontons_errors, only: error_type
  use amontons_tensor, only: cross_product
  use amontons_topology, only: facet_kind, facet_kind_type, FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, FACET_LINE3, &
    MAX_FACE_NODES
  use amontons_mesh, only: mesh_type
  use amontons_shapes, only: facet_shapes
  use amontons_facets, only: facets_type, build_facets, facet_nodes, facet_tangents, is_line
  use amontons_areas, only: depth_of
  use amontons_search, only: search_type, near_facets
  use amontons_gap, only: vertex_normal
  use amontons_polygons, only: clip_polygon, polygon_area, polygon_points, MAX_CORNERS, MAX_CUT_POINTS
  use amontons_dual, only: is_transformed, transform_shapes, transform_nodes, whole_share, dual_functions, ALPHA
  use amontons_rows, only: contact_row_type
  implicit none
  private
  public :: mortar_type, place_type, create_mortar, unite_shares, integrate_mortar, merge_rows, n_own_nodes, search_margin, &
    turned_with

  real(DP), parameter :: FACING = 0.2_DP           !< a master facet is in front if its normal is this much against the slave's [-]
  real(DP), parameter :: COVERED = 1.0e-3_DP       !< a slave node with less of its area in front of the master has no row [-]
  real(DP), parameter :: NOTHING = 1.0e-9_DP       !< with less than this it does not count at all [-]
  real(DP), parameter :: OVERLAP = 1.0e-6_DP       !< segments that overlap by more of the facet lie one behind the other [-]
  real(DP), parameter :: SLIVER = 1.0e-10_DP       !< cuts smaller than this part of the facet are nothing [-]
  real(DP), parameter :: AFFINE = 1.0e-9_DP        !< a square whose corners miss a parallelogram by less than this part is one [-]
  integer, parameter :: MOST_ITERATIONS = 20       !< of Newton for the natural coordinates of a point

  !> Where a slave node is against its master.
  type :: place_type
    integer :: facet = 0                           !< master facet that takes the largest part; 0: nothing is in front
    integer :: vertex = 0                          !< vertex of the slave surface whose facets touch
    logical :: is_thin = .false.                   !< so little is in front that the node has no row; it counts where rows merge
    logical :: is_merged = .false.                 !< the row went into that of another pair
    real(DP) :: whole = 0                          !< area of the node if all of it were covered [length^2]
    real(DP) :: xi(2) = 0                          !< middle of what the node has on that facet, natural coordinates [-]
    real(DP) :: area = 0                           !< D_j [length^2]
    real(DP) :: normal(3) = 0                      !< unit normal, out of the master: that of the slave's vertex turned round
  end type place_type

  !> The slave surface of a pair with its rows.
  type :: mortar_type
    logical :: is_made = .false.                   !< the rows were integrated
    type(facets_type) :: slave
    integer, allocatable :: nodes(:)               !< (n) slave nodes
    type(place_type), allocatable :: places(:)     !< (n)
    type(contact_row_type), allocatable :: rows(:)      !< (n) as they touch now
    type(contact_row_type), allocatable :: origins(:)   !< (n) against their origins
    real(DP), allocatable :: origin_normal(:, :)   !< (3, n) the normal when they touched there
    real(DP), allocatable :: depth(:)              !< (n_facets) of slave lines: thickness [length], -1: the full circle; else 1
    integer, allocatable, private :: first(:)      !< (n + 1) start of a slave node's vertices in vertices(:)
    integer, allocatable, private :: vertices(:)
    integer, allocatable :: corners(:, :)          !< (2, n) the corners beside a mid-side node, else 0
  end type mortar_type

  !> A flat frame through a slave facet.
  type :: plane_type
    real(DP) :: origin(3) = 0                      !< [length]
    real(DP) :: axes(3, 2) = 0                     !< unit vectors in the plane
    real(DP) :: normal(3) = 0                      !< unit vector, out of the slave
    real(DP) :: depth = 1                          !< of a line: thickness [length], -1: the full circle
  end type plane_type

  !> The part that a slave and a master facet have in common.
  type :: segment_type
    integer :: slave = 0                           !< facet
    integer :: master = 0                          !< facet; 0: nothing in common
    integer :: first = 0, last = 0                 !< its points
    real(DP) :: block(MAX_FACE_NODES, MAX_FACE_NODES) = 0   !< integral of phi_j N_i [length^2]
    real(DP) :: share(MAX_FACE_NODES) = 0          !< integral of N~_j [length^2]
    real(DP) :: centre(2) = 0                      !< mean natural coordinates on the master facet [-]
    integer :: n = 0                               !< corners of the cut
    real(DP) :: cut(2, MAX_CORNERS) = 0            !< in the plane of the slave facet [length]
    real(DP) :: distance = 0                       !< mean, positive where the facets are apart [length]
  end type segment_type

  !> The segments of a whole slave surface.
  type :: cuts_type
    integer :: n = 0
    type(segment_type), allocatable :: segments(:) !< those of a slave facet side by side, facet after facet
    integer, allocatable :: first(:)               !< (n_facets + 1) start of a slave facet's segments
    real(DP), allocatable :: area(:)               !< (n_vertices) what is covered of a vertex [length^2]
    real(DP), allocatable :: whole(:)              !< (n_vertices) all of it [length^2]
  end type cuts_type

  !> Points of the integral over one slave facet.
  type :: points_type
    integer :: n = 0
    real(DP), allocatable :: weight(:)             !< [length^2]
    real(DP), allocatable :: at(:, :)              !< (2, :) in the plane [length]
    real(DP), allocatable :: on_slave(:, :)        !< (MAX_FACE_NODES, :) N~_j [-]
    real(DP), allocatable :: on_master(:, :)       !< (MAX_FACE_NODES, :) N_i [-]
  end type points_type

contains

  !> Facets of the slave surface, its nodes, and what belongs to each of them whatever the configuration.
  subroutine create_mortar(mesh, element, face, nodes, mortar, error)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: element(:), face(:)     !< of the slave surface
    integer, intent(in) :: nodes(:)                !< all its nodes, each once
    type(mortar_type), intent(out) :: mortar
    type(error_type), allocatable, intent(out) :: error
    integer :: of_node(mesh%n_nodes), k, n
    call build_facets(mesh, element, face, mortar%slave, error)
    if (allocated(error)) return
    allocate (mortar%depth(mortar%slave%n), source=1.0_DP)
    do k = 1, mortar%slave%n
      if (is_line(mortar%slave%kind(k))) mortar%depth(k) = depth_of(mesh, element(k))
    end do
    n = size(nodes)
    mortar%nodes = nodes
    allocate (mortar%places(n), mortar%rows(n), mortar%origins(n))
    of_node = 0
    of_node(nodes) = [(k, k=1, n)]
    call collect_vertices(mortar, of_node)
    call collect_shares(mortar, of_node)
    mortar%origins = mortar%rows
    allocate (mortar%origin_normal(3, n), source=0.0_DP)
  end subroutine create_mortar


  !> A vector turned as a normal turned, about the axis that is normal to both: R v with R n_0 = n.
  pure function turned_with(v, from, to) result(turned)
    real(DP), intent(in) :: v(3)
    real(DP), intent(in) :: from(3), to(3)         !< n_0 and n, unit vectors that are not opposite
    real(DP) :: turned(3), c
    c = dot_product(from, to)
    turned = v
    if (c <= -0.999_DP) return
    turned = v - dot_product(from + to, v) / (1 + c) * (from + to) + 2 * dot_product(from, v) * to
  end function turned_with


  !> How far from the middle of a slave facet its master facets may be.
  pure real(DP) function search_margin(mortar, reach) result(margin)
    type(mortar_type), intent(in) :: mortar
    real(DP), intent(in) :: reach                  !< largest gap that matters [length]
    margin = reach + maxval(mortar%slave%edge_length)
  end function search_margin


  !> The vertices of each slave node: more than one on a crease of the slave surface.
  subroutine collect_vertices(mortar, of_node)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: of_node(:)              !< (n_nodes) place among the slave nodes
    integer :: node_of(mortar%slave%n_vertices), k, v, n
    integer, allocatable :: next(:)
    do k = 1, size(mortar%slave%nodes)
      node_of(mortar%slave%vertex(k)) = of_node(mortar%slave%nodes(k))
    end do
    n = size(mortar%nodes)
    allocate (mortar%first(n + 1), source=0)
    allocate (mortar%vertices(size(node_of)))
    do v = 1, size(node_of)
      mortar%first(node_of(v) + 1) = mortar%first(node_of(v) + 1) + 1
    end do
    mortar%first(1) = 1
    do k = 1, n
      mortar%first(k + 1) = mortar%first(k + 1) + mortar%first(k)
    end do
    next = mortar%first
    do v = 1, size(node_of)
      mortar%vertices(next(node_of(v))) = v
      next(node_of(v)) = next(node_of(v)) + 1
    end do
  end subroutine collect_vertices


  !> The slave nodes whose imbalance makes that of a row: with the transformed basis a corner has shares of the mid-sides beside it.
  subroutine collect_shares(mortar, of_node)
    type(mortar_type), intent(inout) :: mortar
    integer, intent(in) :: of_node(:)              !< (n_nodes) place among the slave nodes
    type(facet_kind_type) :: shape
    integer :: f, i, k, n, side, nodes(MAX_FACE_NODES), ends(2)
    allocate (mortar%corners(2, size(mortar%nodes)), source=0)
    do k = 1, size(mortar%nodes)
      mortar%rows(k)%own = [mortar%nodes(k)]
      mortar%rows(k)%shares = [1.0_DP]
      mortar%rows(k)%nodes = [mortar%nodes(k)]
      mortar%rows(k)%weights = [1.0_DP]
    end do
    do f = 1, mortar%slave%n
      call facet_nodes(mortar%slave, f, n, nodes)
      shape = facet_kind(mortar%slave%kind(f))
      if (.not. is_transformed(mortar%slave%kind(f))) cycle
      do i = 1, n - shape%n_corners
        side = of_node(nodes(shape%n_corners + i))
        ends = of_node([nodes(i), nodes(modulo(i, shape%n_corners) + 1)])
        if (mortar%corners(1, side) > 0) cycle
        mortar%corners(:, side) = mortar%nodes(ends)
        mortar%rows(side)%shares = [1 - 2 * ALPHA]
        do k = 1, 2
          mortar%rows(ends(k))%own = [mortar%rows(ends(k))%own, mortar%nodes(side)]
          mortar%rows(ends(k))%shares = [mortar%rows(ends(k))%shares, ALPHA]
        end do
      end do
    end do
  end subroutine collect_shares


  !> Slave surfaces that share nodes have one transformed basis: a corner has shares of the mid-sides beside it on all of them.
  subroutine unite_shares(mortars, n_nodes)
    type(mortar_type), intent(inout) :: mortars(:)
    integer, intent(in) :: n_nodes
    integer, allocatable :: sides(:, :)            ! (3, n) mid-side node and its corners
    integer, allocatable :: own(:)
    logical :: is_listed(n_nodes), is_shared(n_nodes)
    integer :: p, k, n
    is_listed = .false.
    allocate (sides(3, sum([(size(mortars(p)%nodes), p=1, size(mortars))])))
    n = 0
    do p = 1, size(mortars)
      do k = 1, size(mortars(p)%nodes)
        if (mortars(p)%corners(1, k) == 0 .or. is_listed(mortars(p)%nodes(k))) cycle
        is_listed(mortars(p)%nodes(k)) = .true.
        n = n + 1
        sides(:, n) = [mortars(p)%nodes(k), mortars(p)%corners(:, k)]
      end do
    end do
    is_listed = .false.
    is_shared = .false.
    do p = 1, size(mortars)
      where (is_listed(mortars(p)%nodes)) is_shared(mortars(p)%nodes) = .true.
      is_listed(mortars(p)%nodes) = .true.
    end do
    do p = 1, size(mortars)
      do k = 1, size(mortars(p)%nodes)
        associate (node => mortars(p)%nodes(k))
          if (.not. is_shared(node) .or. mortars(p)%corners(1, k) > 0) cycle
          own = pack(sides(1, :n), sides(2, :n) == node .or. sides(3, :n) == node)
          mortars(p)%rows(k)%own = [node, own]
          mortars(p)%rows(k)%shares = [1.0_DP, spread(ALPHA, 1, size(own))]
        end associate
      end do
    end do
  end subroutine unite_shares


  !> Nodes of the slave side at the head of a row.
  elemental integer function n_own_nodes(mortar, k) result(n)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: k                       !< row
    n = merge(3, 1, mortar%corners(1, k) > 0)
  end function n_own_nodes


  !> One row in place of two of the same slave node against masters that lie side by side, or of slave surfaces that do: the means
  !! of both by their areas, of which one may be negative (the transformed functions of corners are so in places). The second
  !! row is gone.
  subroutine merge_rows(a, i, b, j)
    type(mortar_type), intent(inout) :: a, b       !< two pairs
    integer, intent(in) :: i, j                    !< rows of the same node, both with a master in front
    integer, allocatable :: nodes(:)
    real(DP), allocatable :: weights(:)
    real(DP) :: share
    integer :: k, at, n
    n = n_own_nodes(a, i)
    if (abs(a%places(i)%area + b%places(j)%area) <= NOTHING * a%places(i)%whole) return
    share = b%places(j)%area / (a%places(i)%area + b%places(j)%area)
    nodes = a%rows(i)%nodes
    weights = [a%rows(i)%weights(:n), (1 - share) * a%rows(i)%weights(n + 1:)]
    do k = n + 1, size(b%rows(j)%nodes)
      at = findloc(nodes, b%rows(j)%nodes(k), dim=1)
      if (at > 0) then
        weights(at) = weights(at) + share * b%rows(j)%weights(k)
      else
        nodes = [nodes, b%rows(j)%nodes(k)]
        weights = [weights, share * b%rows(j)%weights(k)]
      end if
    end do
    a%rows(i)%nodes = nodes
    a%rows(i)%weights = weights
    associate (place => a%places(i), other => b%places(j))
      place%normal = (1 - share) * place%normal + share * other%normal
      place%normal = place%normal / norm2(place%normal)
      place%area = place%area + other%area
      place%whole = max(place%whole, other%whole)
      place%is_thin = place%area <= COVERED * place%whole
      other = place_type(is_merged=.true.)
    end associate
  end subroutine merge_rows


  !> Places and rows of all slave nodes in a configuration. Cost: linear in the segments.
  subroutine integrate_mortar(mortar, master, search, x, reach)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    type(search_type), intent(in) :: search        !< of the master's facets, with at least `search_margin`
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    real(DP), intent(in) :: reach                  !< facets farther apart do not see each other [length]
    type(cuts_type) :: cuts
    integer :: f
    allocate (cuts%segments(64), cuts%first(mortar%slave%n + 1))
    allocate (cuts%area(mortar%slave%n_vertices), cuts%whole(mortar%slave%n_vertices), source=0.0_DP)
    do f = 1, mortar%slave%n
      cuts%first(f) = cuts%n + 1
      call cut_facet(mortar%slave, f, mortar%depth(f), master, search, x, reach, cuts)
    end do
    cuts%first(mortar%slave%n + 1) = cuts%n + 1
    call fill_rows(mortar, master, x, cuts)
    mortar%is_made = .true.
  end subroutine integrate_mortar


  !> The segments of one slave facet.
  subroutine cut_facet(slave, f, depth, master, search, x, reach, cuts)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f                       !< slave facet
    real(DP), intent(in) :: depth                  !< of a line, as mortar%depth
    type(search_type), intent(in) :: search
    real(DP), intent(in) :: x(:, :), reach
    type(cuts_type), intent(inout) :: cuts
    type(plane_type) :: plane
    type(points_type) :: points
    type(segment_type) :: segment
    real(DP) :: corners(2, 4), size_of
    integer, allocatable :: list(:)
    integer :: k, k_own, n_list, n_own, nodes(MAX_FACE_NODES), v(MAX_FACE_NODES), before
    call facet_nodes(slave, f, n_own, nodes)
    v(:n_own) = slave%vertex(slave%first(f):slave%first(f + 1) - 1)
    call lay_plane(slave, f, x, plane)
    plane%depth = depth
    call corners_in(plane, slave, f, x, corners, k_own)
    size_of = polygon_area(corners(:, :k_own)) * depth_at(plane, plane%origin)
    cuts%whole(v(:n_own)) = cuts%whole(v(:n_own)) + size_of * share_of(slave%kind(f), n_own)
    call near_facets(search, plane%origin, list, n_list)
    before = cuts%n
    do k = 1, n_list
      call cut_with(slave, f, master, list(k), x, reach, plane, points, segment)
      if (segment%master == 0) cycle
      if (cuts%n == size(cuts%segments)) cuts%segments = [cuts%segments, cuts%segments]
      cuts%n = cuts%n + 1
      cuts%segments(cuts%n) = segment
    end do
    if (cuts%n == before) return
    call drop_behind(cuts%segments(before + 1:cuts%n), polygon_area(corners(:, :k_own)), points)
    call integrate_segments(slave, f, x, plane, size_of, points, cuts%segments(before + 1:cuts%n))
    do k = before + 1, cuts%n
      cuts%area(v(:n_own)) = cuts%area(v(:n_own)) + cuts%segments(k)%share(:n_own)
    end do
  end subroutine cut_facet


  !> Where masters lie one behind the other (a fold), the nearest takes the place: what overlaps with a nearer one is dropped.
  subroutine drop_behind(segments, area, points)
    type(segment_type), intent(inout) :: segments(:)   !< of one slave facet
    real(DP), intent(in) :: area                   !< of the slave facet in its plane [length^2]
    type(points_type), intent(inout) :: points     !< those of dropped segments lose their weight
    logical :: is_done(size(segments)), is_kept(size(segments))
    real(DP) :: common(2, MAX_CORNERS), covered
    integer :: i, j, k, n
    covered = 0.0_DP
    do i = 1, size(segments)
      covered = covered + polygon_area(segments(i)%cut(:, :segments(i)%n))
    end do
    if (covered <= (1 + OVERLAP) * area) return
    is_done = .false.
    is_kept = .false.
    do k = 1, size(segments)
      i = minloc(abs(segments%distance), dim=1, mask=.not. is_done)
      is_done(i) = .true.
      is_kept(i) = .true.
      do j = 1, size(segments)
        if (.not. is_kept(j) .or. j == i) cycle
        call clip_polygon(segments(i)%cut(:, :segments(i)%n), segments(j)%cut(:, :segments(j)%n), common, n)
        if (n >= 3) is_kept(i) = is_kept(i) .and. polygon_area(common(:, :n)) <= OVERLAP * area
      end do
      if (.not. is_kept(i)) points%weight(segments(i)%first:segments(i)%last) = 0.0_DP
    end do
  end subroutine drop_behind


  !> The depth of a line at a point: its thickness, or the length of the circle; 1 for faces.
  pure real(DP) function depth_at(plane, point) result(depth)
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: point(3)               !< [length]
    depth = plane%depth
    if (depth < 0.0_DP) depth = 2 * PI * point(1)
  end function depth_at


  !> The first n parts of a whole facet that its functions take.
  pure function share_of(kind, n) result(share)
    integer, intent(in) :: kind, n
    real(DP) :: share(n), all_of(MAX_FACE_NODES)
    all_of = whole_share(kind)
    share = all_of(:n)
  end function share_of


  !> The plane through the middle of the corners of a facet, normal to its mean normal. A line's plane stands across the model.
  pure subroutine lay_plane(facets, f, x, plane)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(plane_type), intent(out) :: plane
    type(facet_kind_type) :: shape
    integer :: n, m, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, n, nodes)
    shape = facet_kind(facets%kind(f))
    m = shape%n_corners
    plane%origin = sum(x(:, nodes(:m)), dim=2) / real(m, DP)
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
  end subroutine lay_plane


  !> A point in the coordinates of the plane.
  pure function in_plane(plane, point) result(p)
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: point(3)               !< [length]
    real(DP) :: p(2)                               !< [length]
    p = matmul(point - plane%origin, plane%axes)
  end function in_plane


  !> The corners of a facet in the coordinates of a plane; a line is a rectangle of depth 1.
  pure subroutine corners_in(plane, facets, f, x, corners, n)
    type(plane_type), intent(in) :: plane
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
      corners(:, i) = in_plane(plane, x(:, nodes(i)))
    end do
    if (n > 2) return
    n = 4
    corners(2, :2) = 0.0_DP
    corners(:, 3) = [corners(1, 2), 1.0_DP]
    corners(:, 4) = [corners(1, 1), 1.0_DP]
  end subroutine corners_in


  !> Cuts a slave facet with one master facet and appends the points of the cut. After: segment%master = 0 if there is none.
  subroutine cut_with(slave, f, master, g, x, reach, plane, points, segment)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f, g                    !< slave and master facet
    real(DP), intent(in) :: x(:, :), reach
    type(plane_type), intent(in) :: plane
    type(points_type), intent(inout) :: points
    type(segment_type), intent(out) :: segment
    type(plane_type) :: other
    real(DP) :: own(2, 4), front(2, 4), cut(2, MAX_CORNERS), at(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS)
    integer :: n, m, k, q, before
    call lay_plane(master, g, x, other)
    if (dot_product(other%normal, plane%normal) > -FACING) return
    call corners_in(plane, slave, f, x, own, n)
    call corners_in(plane, master, g, x, front, m)
    front(:, :m) = front(:, m:1:-1)                ! seen from the slave it runs the other way round
    if (any(minval(own(:, :n), dim=2) > maxval(front(:, :m), dim=2))) return
    if (any(maxval(own(:, :n), dim=2) < minval(front(:, :m), dim=2))) return
    call clip_polygon(own(:, :n), front(:, :m), cut, k)
    if (k < 3) return
    if (polygon_area(cut(:, :k)) <= SLIVER * polygon_area(own(:, :n))) return
    call polygon_points(cut(:, :k), max(order_for(slave%kind(f), own), order_for(master%kind(g), front)), q, at, weight)
    before = points%n
    segment%slave = f
    segment%master = g
    segment%first = before + 1
    segment%n = k
    segment%cut = cut
    call append_points(slave, master, x, plane, at(:, :q), weight(:q), points, segment)
    segment%last = points%n
    if (abs(segment%distance) <= reach) return
    points%n = before
    segment = segment_type()
  end subroutine cut_with


  !> The order of the rule that a facet wants. Its functions are polynomials in the plane for triangles with straight edges and for
  !! parallelograms, and the rule is exact; else they are not, and the error falls fast with the order.
  pure integer function order_for(kind, corners) result(order)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: corners(2, 4)          !< in the plane [length]
    logical :: is_skew
    is_skew = norm2(corners(:, 1) - corners(:, 2) + corners(:, 3) - corners(:, 4)) > AFFINE * norm2(corners(:, 3) - corners(:, 1))
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
  end function order_for


  !> The points of a cut with the functions of both facets there, and their mean distance, positive where the facets are apart.
  subroutine append_points(slave, master, x, plane, at, weight, points, segment)
    type(facets_type), intent(in) :: slave, master
    real(DP), intent(in) :: x(:, :)
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: at(:, :), weight(:)    !< (2, n), (n) in the plane
    type(points_type), intent(inout) :: points
    type(segment_type), intent(inout) :: segment   !< in: its facets; out: centre, distance
    real(DP) :: xi(2), eta(2), N(MAX_FACE_NODES), M(MAX_FACE_NODES), tangents(3, 2), normal(3)
    integer :: q, n_slave, n_master, nodes(MAX_FACE_NODES), fronts(MAX_FACE_NODES)
    call facet_nodes(slave, segment%slave, n_slave, nodes)
    call facet_nodes(master, segment%master, n_master, fronts)
    call reserve(points, points%n + size(weight))
    do q = 1, size(weight)
      call natural_place(slave%kind(segment%slave), plane, x(:, nodes(:n_slave)), at(:, q), xi, N)
      call natural_place(master%kind(segment%master), plane, x(:, fronts(:n_master)), at(:, q), eta, M)
      call facet_tangents(slave, x, segment%slave, xi, tangents)
      normal = cross_product(tangents(:, 1), tangents(:, 2))
      points%n = points%n + 1
      points%at(:, points%n) = at(:, q)
      points%weight(points%n) = weight(q) * norm2(normal) / max(dot_product(normal, plane%normal), 0.1_DP * norm2(normal)) &
        * depth_at(plane, matmul(x(:, nodes(:n_slave)), N(:n_slave)))
      points%on_master(:, points%n) = M
      segment%distance = segment%distance + weight(q) * dot_product(plane%normal, matmul(x(:, fronts(:n_master)), M(:n_master)) &
        - matmul(x(:, nodes(:n_slave)), N(:n_slave)))
      segment%centre = segment%centre + weight(q) * eta
      call transform_shapes(slave%kind(segment%slave), N)
      points%on_slave(:, points%n) = N
    end do
    segment%centre = segment%centre / sum(weight)
    segment%distance = segment%distance / sum(weight)
  end subroutine append_points


  !> Room for n points.
  pure subroutine reserve(points, n)
    type(points_type), intent(inout) :: points
    integer, intent(in) :: n
    real(DP), allocatable :: longer(:), wider(:, :)
    integer :: room, m
    m = points%n
    if (.not. allocated(points%weight)) then
      allocate (points%weight(0), points%at(2, 0), points%on_slave(MAX_FACE_NODES, 0), points%on_master(MAX_FACE_NODES, 0))
    end if
    if (n <= size(points%weight)) return
    room = max(n, 2 * size(points%weight), 128)
    allocate (longer(room))
    longer(:m) = points%weight(:m)
    call move_alloc(longer, points%weight)
    allocate (wider(2, room))
    wider(:, :m) = points%at(:, :m)
    call move_alloc(wider, points%at)
    allocate (wider(MAX_FACE_NODES, room))
    wider(:, :m) = points%on_slave(:, :m)
    call move_alloc(wider, points%on_slave)
    allocate (wider(MAX_FACE_NODES, room))
    wider(:, :m) = points%on_master(:, :m)
    call move_alloc(wider, points%on_master)
  end subroutine reserve


  !> The natural coordinates of the point of a facet that is over a point of the plane: Newton, two equations.
  pure subroutine natural_place(kind, plane, x, at, xi, N)
    integer, intent(in) :: kind                    !< FACET_...
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: x(:, :)                !< (3, n) nodes of the facet [length]
    real(DP), intent(in) :: at(2)                  !< in the plane [length]
    real(DP), intent(out) :: xi(2)                 !< [-]
    real(DP), intent(out) :: N(MAX_FACE_NODES)     !< shape functions there [-]
    real(DP) :: flat(2, size(x, 2)), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), J(2, 2), r(2), step(2), det
    integer :: i, iteration
    do i = 1, size(x, 2)
      flat(:, i) = in_plane(plane, x(:, i))
    end do
    xi = merge(1.0_DP / 3, 0.0_DP, kind == FACET_TRI3 .or. kind == FACET_TRI6)
    if (is_line(kind)) flat(2, :) = at(2)
    do iteration = 1, MOST_ITERATIONS
      call facet_shapes(kind, xi, N, dN, ddN)
      r = at - matmul(flat, N(:size(x, 2)))
      J = matmul(flat, transpose(dN(:, :size(x, 2))))
      if (is_line(kind)) J(2, 2) = 1.0_DP
      det = J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)
      if (abs(det) <= tiny(1.0_DP)) return
      step = [J(2, 2) * r(1) - J(1, 2) * r(2), J(1, 1) * r(2) - J(2, 1) * r(1)] / det
      if (maxval(abs(step)) > 1.0_DP) step = step / maxval(abs(step))
      xi = xi + step
      if (maxval(abs(step)) < 1.0e-13_DP) exit
    end do
    call facet_shapes(kind, xi, N, dN, ddN)
  end subroutine natural_place


  !> The integrals of all segments of one slave facet, with the dual functions of what they cover together.
  subroutine integrate_segments(slave, f, x, plane, area, points, segments)
    type(facets_type), intent(in) :: slave
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: area                   !< of the slave facet [length^2]
    type(points_type), intent(in) :: points
    type(segment_type), intent(inout) :: segments(:)
    real(DP), allocatable :: phi(:, :)
    real(DP) :: at_node(2, MAX_FACE_NODES), d(MAX_FACE_NODES)
    integer :: n, i, k, q, nodes(MAX_FACE_NODES)
    call facet_nodes(slave, f, n, nodes)
    do i = 1, n
      at_node(:, i) = in_plane(plane, x(:, nodes(i)))
    end do
    call transform_nodes(slave%kind(f), at_node(:, :n))
    allocate (phi(n, points%n))
    associate (w => points%weight, N_j => points%on_slave, N_i => points%on_master)
      call dual_functions(slave%kind(f), area, at_node(:, :n), w(:points%n), points%at(:, :points%n), N_j(:n, :points%n), &
        phi, d(:n))
      do k = 1, size(segments)
        do q = segments(k)%first, segments(k)%last
          segments(k)%share(:n) = segments(k)%share(:n) + w(q) * N_j(:n, q)
          do i = 1, MAX_FACE_NODES
            segments(k)%block(:n, i) = segments(k)%block(:n, i) + w(q) * N_i(i, q) * phi(:, q)
          end do
        end do
      end do
    end associate
  end subroutine integrate_segments


  !> Places and rows of all slave nodes from the segments of the facets around them.
  subroutine fill_rows(mortar, master, x, cuts)
    type(mortar_type), intent(inout) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    type(cuts_type), intent(in) :: cuts
    integer, allocatable :: at(:)                  ! (n_nodes) place in the row that is filled, 0 outside
    real(DP) :: m(3)
    integer :: j, v
    allocate (at(size(x, 2)), source=0)
    do j = 1, size(mortar%nodes)
      associate (vertices => mortar%vertices(mortar%first(j):mortar%first(j + 1) - 1), place => mortar%places(j))
        place = place_type()
        call start_row(mortar%nodes(j), mortar%corners(:, j), mortar%rows(j))
        if (size(vertices) == 0) cycle
        v = vertices(maxloc(cuts%area(vertices), dim=1))
        if (abs(cuts%area(v)) <= NOTHING * cuts%whole(v)) cycle
        m = vertex_normal(mortar%slave, x, v)
        if (norm2(m) <= 0.0_DP) cycle
        place%vertex = v
        place%area = cuts%area(v)
        place%whole = cuts%whole(v)
        place%is_thin = place%area <= COVERED * place%whole
        place%normal = -m / norm2(m)
        call add_masters(mortar%slave, master, cuts, at, place, mortar%rows(j))
      end associate
    end do
  end subroutine fill_rows


  !> The slave's part of a row: x^_j.
  pure subroutine start_row(node, corners, row)
    integer, intent(in) :: node, corners(2)
    type(contact_row_type), intent(inout) :: row
    if (corners(1) == 0) then
      row%nodes = [node]
      row%weights = [1.0_DP]
    else
      row%nodes = [node, corners]
      row%weights = [1.0_DP, -ALPHA, -ALPHA] / (1 - 2 * ALPHA)
    end if
  end subroutine start_row


  !> The master's part of a row: -M_ji / D_j, in the order in which the segments bring the nodes.
  subroutine add_masters(slave, master, cuts, at, place, row)
    type(facets_type), intent(in) :: slave, master
    type(cuts_type), intent(in) :: cuts
    integer, intent(inout) :: at(:)                !< (n_nodes) 0; left so
    type(place_type), intent(inout) :: place
    type(contact_row_type), intent(inout) :: row
    real(DP), allocatable :: weights(:)
    integer, allocatable :: nodes(:)
    real(DP) :: largest
    integer :: s, k, n, f
    n = 0
    do s = slave%star_first(place%vertex), slave%star_first(place%vertex + 1) - 1
      f = slave%star_facet(s)
      n = n + MAX_FACE_NODES * (cuts%first(f + 1) - cuts%first(f))
    end do
    allocate (nodes(n))
    allocate (weights(n), source=0.0_DP)
    n = 0
    largest = -huge(1.0_DP)
    do s = slave%star_first(place%vertex), slave%star_first(place%vertex + 1) - 1
      f = slave%star_facet(s)
      do k = cuts%first(f), cuts%first(f + 1) - 1
        call add_segment(master, cuts%segments(k), slave%star_local(s), at, n, nodes, weights)
        if (cuts%segments(k)%share(slave%star_local(s)) <= largest) cycle
        largest = cuts%segments(k)%share(slave%star_local(s))
        place%facet = cuts%segments(k)%master
        place%xi = cuts%segments(k)%centre
      end do
    end do
    at(nodes(:n)) = 0
    row%nodes = [row%nodes, nodes(:n)]
    row%weights = [row%weights, -weights(:n) / place%area]
  end subroutine add_masters


  !> Adds what one segment gives to M of a slave node.
  pure subroutine add_segment(master, segment, local, at, n, nodes, weights)
    type(facets_type), intent(in) :: master
    type(segment_type), intent(in) :: segment
    integer, intent(in) :: local                   !< local number of the slave node in the segment's slave facet
    integer, intent(inout) :: at(:)                !< (n_nodes) place in nodes(:) or 0
    integer, intent(inout) :: n                    !< entries so far
    integer, intent(inout) :: nodes(:)
    real(DP), intent(inout) :: weights(:)          !< M_ji [length^2]
    integer :: own(MAX_FACE_NODES), i, n_own
    call facet_nodes(master, segment%master, n_own, own)
    do i = 1, n_own
      if (at(own(i)) == 0) then
        n = n + 1
        nodes(n) = own(i)
        at(own(i)) = n
      end if
      weights(at(own(i))) = weights(at(own(i))) + segment%block(local, i)
    end do
  end subroutine add_segment

end module amontons_mortar
