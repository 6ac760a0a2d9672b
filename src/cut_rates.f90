!> Cut rates: how the integrals over the cuts of a slave facet, and the rows made of them, change when the nodes move.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Mortar". Everything is a function of the places of the nodes of the slave facet and of the
!! master facets that it is cut with: corners of the cuts are where two of their edges cross, and points of the integrals go with
!! the corners. The derivatives follow from each other in that order (M. Puso, T. Laursen, Comput. Methods Appl. Mech. Engrg. 193
!! (2004) 601-629). The frame of the slave facet is turned with its normal alone: what it turns or moves within its own
!! plane changes no integral.
module amontons_cut_rates
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_topology, only: facet_kind, facet_kind_type, MAX_FACE_NODES
  use amontons_shapes, only: facet_shapes
  use amontons_facets, only: facets_type, facet_nodes, is_line
  use amontons_search, only: search_type
  use amontons_polygons, only: clip_polygon, polygon_area, polygon_points, MAX_CORNERS, MAX_CUT_POINTS
  use amontons_dense, only: solve_small, DENSE_OK
  use amontons_dual, only: full_part, transform_shapes, transform_nodes
  use amontons_segments, only: plane_type, segment_type, cover_type, find_segments, lay_plane, in_plane, corners_in, depth_at, &
    order_for, natural_place
  use amontons_rows, only: contact_row_type
  use amontons_mortar, only: mortar_type, start_row, take_parts, fading
  implicit none
  private
  public :: facet_rates_type, row_rates_type, differentiate_row

  integer, parameter :: MOST = 6 * MAX_FACE_NODES  !< coordinates on which one cut depends

  !> The integrals over one slave facet and their derivatives by the coordinates of its nodes and of its masters'.
  type :: facet_rates_type
    logical :: is_made = .false.
    integer :: n_slave = 0                         !< nodes of the facet, the first of nodes(:)
    integer, allocatable :: nodes(:)               !< (n) then those of its masters, each once
    real(DP), allocatable :: share(:)              !< (n_slave) integral of N~_j [length^2]
    real(DP), allocatable :: block(:, :)           !< (n_slave, n) integral of phi_j N_i; zero for the slave's own nodes [length^2]
    real(DP), allocatable :: d_share(:, :)         !< (n_slave, 3 n) [length]
    real(DP), allocatable :: d_block(:, :, :)      !< (n_slave, n, 3 n) [length]
  end type facet_rates_type

  !> How a row changes.
  type :: row_rates_type
    integer, allocatable :: nodes(:)               !< (n) those of the row, then all others that it depends on
    real(DP), allocatable :: d_weights(:, :, :)    !< (n_weights, 3, n) dw_k/dx_j [1/length]
    real(DP), allocatable :: d_area(:, :)          !< (3, n) [length]
    real(DP), allocatable :: d_factor(:, :)        !< (3, n) of the logarithm of the factor of the row's shares [1/length]
  end type row_rates_type

  !> Where a facet is in the plane of the cut, and how that changes with the coordinates of slave and master, (3, n_slave +
  !! n_master).
  type :: outline_type
    integer :: kind = 0                            !< FACET_...
    integer :: n = 0                               !< nodes
    integer :: first = 0                           !< nodes before them among those of slave and master
    real(DP) :: x(3, MAX_FACE_NODES) = 0           !< [length]
    real(DP) :: d_flat(2, MOST, MAX_FACE_NODES) = 0     !< of the places of the nodes in the plane [-]
    integer :: n_corners = 0
    real(DP) :: corners(2, 4) = 0                  !< counter-clockwise in the plane [length]
    integer :: node(4) = 0                         !< of each corner
  end type outline_type

  !> A point of the integrals and its derivatives.
  type :: point_rates_type
    real(DP) :: weight = 0                         !< [length^2]
    real(DP) :: at(2) = 0                          !< in the plane [length]
    real(DP) :: on_slave(MAX_FACE_NODES) = 0       !< N~_j [-]
    real(DP) :: on_master(MAX_FACE_NODES) = 0      !< N_i [-]
    real(DP) :: d_weight(MOST) = 0
    real(DP) :: d_at(2, MOST) = 0
    real(DP) :: d_on_slave(MAX_FACE_NODES, MOST) = 0
    real(DP) :: d_on_master(MAX_FACE_NODES, MOST) = 0
  end type point_rates_type

  !> Sums over the points of a facet: with e the functions of the basis (N~ or 1, y), and all derivatives.
  type :: sums_type
    integer :: n = 0                               !< functions of the basis
    logical :: is_full = .true.                    !< the basis is N~; else 1 and y, the place from the middle over the unit
    real(DP) :: middle(2) = 0, unit = 1            !< [length]
    real(DP), allocatable :: gram(:, :)            !< (n, n) integral of e e'
    real(DP), allocatable :: cross(:, :)           !< (n, n_nodes) integral of e N_i
    real(DP), allocatable :: d_gram(:, :, :)       !< (n, n, 3 n_nodes)
    real(DP), allocatable :: d_cross(:, :, :)      !< (n, n_nodes, 3 n_nodes)
  end type sums_type

  !> How the part changes that a slave node gives to others.
  type :: fade_type
    integer :: node = 0                            !< mesh node
    integer, allocatable :: at(:)                  !< (n) places of nodes of slave and master facet among those of the row
    real(DP), allocatable :: rate(:, :)            !< (3, n) [1/length]
  end type fade_type

contains

  !> The integrals over a slave facet and how they change. Cost: points of the integrals times coordinates times functions.
  subroutine differentiate_cuts(slave, f, depth, master, search, x, reach, rates)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f                       !< slave facet
    real(DP), intent(in) :: depth                  !< of a line, as mortar%depth
    type(search_type), intent(in) :: search        !< of the master's facets
    real(DP), intent(in) :: x(:, :), reach         !< as `find_segments`
    type(facet_rates_type), intent(out) :: rates
    type(cover_type) :: cover
    type(facet_rates_type) :: other
    type(outline_type) :: own
    real(DP) :: turn(2, MOST), d_area(MOST), area, d_cover, part, slope
    integer :: i
    rates%is_made = .true.
    call find_segments(slave, f, depth, master, search, x, reach, cover)
    call gather_nodes(slave, f, master, cover%segments(:cover%n), rates)
    if (cover%n == 0) return
    if (sum(cover%points%weight(:cover%points%n)) <= 0.0_DP) return
    turn = turn_of(slave, f, x, cover%plane)
    call lay_outline(slave, f, x, cover%plane, turn, 0, .false., own)
    call differentiate_area(own, cover%plane, area, d_area)
    call full_part(slave%kind(f), sum(cover%points%weight(:cover%points%n)) / area, part, slope)
    other = rates
    if (part < 1.0_DP) call differentiate_basis(slave, f, master, x, cover, turn, sqrt(area), .false., other)
    if (part > 0.0_DP) call differentiate_basis(slave, f, master, x, cover, turn, sqrt(area), .true., rates)
    if (part >= 1.0_DP) return
    if (part > 0.0_DP) then
      associate (covered => sum(rates%share))
        do i = 1, 3 * size(rates%nodes)
          d_cover = sum(rates%d_share(:, i))
          if (i <= 3 * rates%n_slave) d_cover = d_cover - covered / area * d_area(i)
          other%d_block(:, :, i) = part * rates%d_block(:, :, i) + (1 - part) * other%d_block(:, :, i) &
            + slope / area * d_cover * (rates%block - other%block)
        end do
      end associate
      other%block = part * rates%block + (1 - part) * other%block
    end if
    rates = other
  end subroutine differentiate_cuts


  !> The area of a slave facet in its plane, times the depth of a line, and how it changes with the coordinates of its nodes.
  pure subroutine differentiate_area(own, plane, area, d_area)
    type(outline_type), intent(in) :: own
    type(plane_type), intent(in) :: plane
    real(DP), intent(out) :: area                  !< [length^2]
    real(DP), intent(out) :: d_area(MOST)          !< [length]
    real(DP) :: across(2), flat, depth
    integer :: k, before, next, i
    flat = polygon_area(own%corners(:, :own%n_corners))
    depth = depth_at(plane, plane%origin)
    area = flat * depth
    d_area = 0.0_DP
    do k = 1, own%n_corners                        ! 2 A = sum of x_k times (y_next - y_before)
      before = modulo(k - 2, own%n_corners) + 1
      next = modulo(k, own%n_corners) + 1
      across = 0.5_DP * [own%corners(2, next) - own%corners(2, before), own%corners(1, before) - own%corners(1, next)]
      do i = 1, 3 * own%n
        d_area(i) = d_area(i) + depth * dot_product(across, own%d_flat(:, i, own%node(k)))
      end do
    end do
    if (plane%depth >= 0.0_DP) return
    d_area([1, 4]) = d_area([1, 4]) + PI * flat    ! the origin is the middle of the two corners of a line
  end subroutine differentiate_area


  !> The integrals with the dual functions of one basis, N~ or the linear functions of the place.
  subroutine differentiate_basis(slave, f, master, x, cover, turn, unit, is_full, rates)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(cover_type), intent(in) :: cover
    real(DP), intent(in) :: turn(2, MOST)
    real(DP), intent(in) :: unit                   !< of the place [length]
    logical, intent(in) :: is_full
    type(facet_rates_type), intent(inout) :: rates
    type(sums_type) :: sums
    integer :: k
    associate (w => cover%points%weight(:cover%points%n))
      sums%middle = matmul(cover%points%at(:, :cover%points%n), w) / sum(w)
    end associate
    sums%unit = unit
    sums%is_full = is_full
    call begin_sums(merge(rates%n_slave, 3, is_full), size(rates%nodes), sums)
    do k = 1, cover%n
      if (all(cover%points%weight(cover%segments(k)%first:cover%segments(k)%last) <= 0.0_DP)) cycle
      call add_cut(slave, f, master, cover%segments(k)%master, x, cover%plane, turn, rates, sums)
    end do
    call finish_blocks(slave, f, x, cover%plane, turn, rates, sums)
  end subroutine differentiate_basis


  !> The nodes on which the integrals depend.
  pure subroutine gather_nodes(slave, f, master, segments, rates)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f
    type(segment_type), intent(in) :: segments(:)
    type(facet_rates_type), intent(inout) :: rates
    integer :: k, i, n, nodes(MAX_FACE_NODES)
    call facet_nodes(slave, f, rates%n_slave, nodes)
    rates%nodes = nodes(:rates%n_slave)
    do k = 1, size(segments)
      call facet_nodes(master, segments(k)%master, n, nodes)
      do i = 1, n
        if (all(rates%nodes /= nodes(i))) rates%nodes = [rates%nodes, nodes(i)]
      end do
    end do
    n = size(rates%nodes)
    allocate (rates%share(rates%n_slave), rates%block(rates%n_slave, n), source=0.0_DP)
    allocate (rates%d_share(rates%n_slave, 3 * n), rates%d_block(rates%n_slave, n, 3 * n), source=0.0_DP)
  end subroutine gather_nodes


  !> Sums of a basis of n functions, empty.
  pure subroutine begin_sums(n, n_nodes, sums)
    integer, intent(in) :: n, n_nodes
    type(sums_type), intent(inout) :: sums
    sums%n = n
    allocate (sums%gram(n, n), sums%cross(n, n_nodes), source=0.0_DP)
    allocate (sums%d_gram(n, n, 3 * n_nodes), sums%d_cross(n, n_nodes, 3 * n_nodes), source=0.0_DP)
  end subroutine begin_sums


  !> How the plane's normal turns towards its axes, by the coordinates of the slave's nodes.
  pure function turn_of(slave, f, x, plane) result(turn)
    type(facets_type), intent(in) :: slave
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(plane_type), intent(in) :: plane
    real(DP) :: turn(2, MOST), side(3, 2), sign_of(2, 4), unit(3), d_m(3), length
    type(facet_kind_type) :: shape
    integer :: i, a, n, nodes(MAX_FACE_NODES)
    call facet_nodes(slave, f, n, nodes)
    shape = facet_kind(slave%kind(f))
    sign_of = 0.0_DP                               ! normal = a x b with a, b sums of corners with these signs
    select case (shape%n_corners)
    case (2)
      sign_of(1, :2) = real([-1, 1], DP)
    case (3)
      sign_of(:, :3) = reshape(real([-1, -1, 1, 0, 0, 1], DP), [2, 3])
    case default
      sign_of = reshape(real([-1, 0, 0, -1, 1, 0, 0, 1], DP), [2, 4])
    end select
    side = matmul(x(:, nodes(:shape%n_corners)), transpose(sign_of(:, :shape%n_corners)))
    if (shape%n_corners == 2) side(:, 2) = [0.0_DP, 0.0_DP, 1.0_DP]
    length = norm2(cross_product(side(:, 1), side(:, 2)))
    turn = 0.0_DP
    if (length <= 0.0_DP) return
    do i = 1, shape%n_corners
      do a = 1, 3
        unit = 0.0_DP
        unit(a) = 1.0_DP
        d_m = sign_of(1, i) * cross_product(unit, side(:, 2)) + sign_of(2, i) * cross_product(side(:, 1), unit)
        turn(:, 3 * (i - 1) + a) = matmul(d_m, plane%axes) / length
      end do
    end do
    if (is_line(slave%kind(f))) turn(2, :) = 0.0_DP
  end function turn_of


  !> One cut's part of all sums.
  subroutine add_cut(slave, f, master, g, x, plane, turn, rates, sums)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f, g                    !< slave and master facet
    real(DP), intent(in) :: x(:, :)
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: turn(2, MOST)
    type(facet_rates_type), intent(inout) :: rates
    type(sums_type), intent(inout) :: sums
    type(outline_type) :: own, front
    type(point_rates_type) :: point
    real(DP) :: cut(2, MAX_CORNERS), d_cut(2, MOST, MAX_CORNERS), at(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS)
    real(DP) :: place(2, MAX_CUT_POINTS)
    integer :: lines(MAX_CORNERS), corner(MAX_CUT_POINTS), n, q, n_points, map(2 * MAX_FACE_NODES), nd, i, nodes(MAX_FACE_NODES)
    call lay_outline(slave, f, x, plane, turn, 0, .false., own)
    call lay_outline(master, g, x, plane, turn, own%n, .true., front)
    nd = 3 * (own%n + front%n)
    call clip_polygon(own%corners(:, :own%n_corners), front%corners(:, :front%n_corners), cut, n, lines)
    call move_corners(own, front, nd, lines, n, cut, d_cut)
    call polygon_points(cut(:, :n), max(order_for(slave%kind(f), own%corners), order_for(master%kind(g), front%corners)), &
      n_points, at, weight, corner, place)
    call facet_nodes(master, g, n, nodes)
    map(:own%n) = [(i, i=1, own%n)]
    map(own%n + 1:own%n + n) = [(findloc(rates%nodes, nodes(i), dim=1), i=1, n)]
    do q = 1, n_points
      point%at = at(:, q)
      point%weight = weight(q)
      call move_point(cut, d_cut, corner(q), place(:, q), nd, point)
      call differentiate_point(own, front, plane, turn, nd, point)
      call add_point(own%n, front%n, nd, map, point, rates, sums)
    end do
  end subroutine add_cut


  !> A facet in the plane of the cut; the master's corners run the other way round.
  pure subroutine lay_outline(facets, f, x, plane, turn, first, is_front, outline)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: turn(2, MOST)
    integer, intent(in) :: first
    logical, intent(in) :: is_front
    type(outline_type), intent(out) :: outline
    integer :: i, a, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, outline%n, nodes)
    outline%kind = facets%kind(f)
    outline%first = first
    do i = 1, outline%n
      outline%x(:, i) = x(:, nodes(i))
      outline%d_flat(:, :, i) = -dot_product(plane%normal, outline%x(:, i) - plane%origin) * turn
      do a = 1, 3
        associate (rate => outline%d_flat(:, 3 * (first + i - 1) + a, i))
          rate = rate + plane%axes(a, :)
        end associate
      end do
      if (is_line(outline%kind)) outline%d_flat(2, :, i) = 0.0_DP
    end do
    call corners_in(plane, facets, f, x, outline%corners, outline%n_corners)
    outline%node = [1, 2, 3, 4]
    if (is_line(outline%kind)) outline%node = [1, 2, 2, 1]
    if (.not. is_front) return
    associate (m => outline%n_corners)
      outline%corners(:, :m) = outline%corners(:, m:1:-1)
      outline%node(:m) = outline%node(m:1:-1)
    end associate
  end subroutine lay_outline


  !> How the corners of the cut move: each is where two edges cross.
  pure subroutine move_corners(own, front, nd, lines, n, cut, d_cut)
    type(outline_type), intent(in) :: own, front
    integer, intent(in) :: nd                      !< coordinates
    integer, intent(in) :: lines(MAX_CORNERS), n
    real(DP), intent(in) :: cut(2, MAX_CORNERS)
    real(DP), intent(out) :: d_cut(2, MOST, MAX_CORNERS)
    real(DP) :: across(2, 2), moved(MOST, 2), det
    integer :: k
    do k = 1, n
      call move_line(own, front, nd, lines(k), cut(:, k), across(:, 1), moved(:, 1))
      call move_line(own, front, nd, lines(modulo(k, n) + 1), cut(:, k), across(:, 2), moved(:, 2))
      det = across(1, 1) * across(2, 2) - across(2, 1) * across(1, 2)
      if (abs(det) > 1.0e-9_DP) then
        d_cut(1, :nd, k) = (across(2, 2) * moved(:nd, 1) - across(2, 1) * moved(:nd, 2)) / det
        d_cut(2, :nd, k) = (across(1, 1) * moved(:nd, 2) - across(1, 2) * moved(:nd, 1)) / det
      else                                         ! both edges on one line
        d_cut(1, :nd, k) = across(1, 1) * moved(:nd, 1)
        d_cut(2, :nd, k) = across(2, 1) * moved(:nd, 1)
      end if
    end do
  end subroutine move_corners


  !> The direction across an edge, and how far the edge moves along it at a point of it.
  pure subroutine move_line(own, front, nd, line, at, across, moved)
    type(outline_type), intent(in) :: own, front
    integer, intent(in) :: nd, line
    real(DP), intent(in) :: at(2)                  !< [length]
    real(DP), intent(out) :: across(2)             !< unit vector
    real(DP), intent(out) :: moved(MOST)           !< [-]
    integer :: a
    if (line <= own%n_corners) then
      call move_edge(own, nd, modulo(line - 2, own%n_corners) + 1, line, at, across, moved)
    else
      a = line - own%n_corners
      call move_edge(front, nd, a, modulo(a, front%n_corners) + 1, at, across, moved)
    end if
  end subroutine move_line


  !> The same for the edge between two corners of an outline.
  pure subroutine move_edge(outline, nd, a, b, at, across, moved)
    type(outline_type), intent(in) :: outline
    integer, intent(in) :: nd, a, b                !< coordinates; corners
    real(DP), intent(in) :: at(2)                  !< [length]
    real(DP), intent(out) :: across(2), moved(MOST)
    real(DP) :: edge(2), part
    integer :: i
    edge = outline%corners(:, b) - outline%corners(:, a)
    part = dot_product(edge, at - outline%corners(:, a)) / max(dot_product(edge, edge), tiny(1.0_DP))
    across = [edge(2), -edge(1)] / max(norm2(edge), tiny(1.0_DP))
    moved = 0.0_DP
    do i = 1, nd
      moved(i) = dot_product(across, (1 - part) * outline%d_flat(:, i, outline%node(a)) &
        + part * outline%d_flat(:, i, outline%node(b)))
    end do
  end subroutine move_edge


  !> Place and weight of a point go with the triangle in which it is.
  pure subroutine move_point(cut, d_cut, k, place, nd, point)
    real(DP), intent(in) :: cut(2, MAX_CORNERS), d_cut(2, MOST, MAX_CORNERS)
    integer, intent(in) :: k                       !< of the triangle 1, k, k + 1
    real(DP), intent(in) :: place(2)               !< parts of k and k + 1 [-]
    integer, intent(in) :: nd
    type(point_rates_type), intent(inout) :: point
    real(DP) :: a(2), b(2), d_a(2), d_b(2), twice
    integer :: i
    a = cut(:, k) - cut(:, 1)
    b = cut(:, k + 1) - cut(:, 1)
    twice = a(1) * b(2) - a(2) * b(1)
    do i = 1, nd
      d_a = d_cut(:, i, k) - d_cut(:, i, 1)
      d_b = d_cut(:, i, k + 1) - d_cut(:, i, 1)
      point%d_at(:, i) = d_cut(:, i, 1) + place(1) * d_a + place(2) * d_b
      point%d_weight(i) = point%weight / twice * (d_a(1) * b(2) - d_a(2) * b(1) + a(1) * d_b(2) - a(2) * d_b(1))
    end do
  end subroutine move_point


  !> The functions of both facets at a point, and the weight of the slave's curved face, with their derivatives.
  subroutine differentiate_point(own, front, plane, turn, nd, point)
    type(outline_type), intent(in) :: own, front
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: turn(2, MOST)
    integer, intent(in) :: nd
    type(point_rates_type), intent(inout) :: point
    real(DP) :: xi(2), d_xi(2, MOST)
    integer :: i
    call natural_place(front%kind, plane, front%x(:, :front%n), point%at, xi, point%on_master)
    call differentiate_place(front, plane, nd, xi, point%d_at, d_xi, point%d_on_master)
    call natural_place(own%kind, plane, own%x(:, :own%n), point%at, xi, point%on_slave)
    call differentiate_place(own, plane, nd, xi, point%d_at, d_xi, point%d_on_slave)
    call scale_weight(own, plane, turn, nd, xi, d_xi, point)
    call transform_shapes(own%kind, point%on_slave)
    do i = 1, nd
      call transform_shapes(own%kind, point%d_on_slave(:, i))
    end do
  end subroutine differentiate_point


  !> How the natural coordinates of a point of the plane and the functions there change: J d_xi = d_at - sum N_k d_flat_k.
  pure subroutine differentiate_place(outline, plane, nd, xi, d_at, d_xi, d_N)
    type(outline_type), intent(in) :: outline
    type(plane_type), intent(in) :: plane
    integer, intent(in) :: nd
    real(DP), intent(in) :: xi(2), d_at(2, MOST)
    real(DP), intent(out) :: d_xi(2, MOST), d_N(MAX_FACE_NODES, MOST)
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), J(2, 2), inverse(2, 2), r(2), det
    integer :: i, k
    call facet_shapes(outline%kind, xi, N, dN, ddN)
    J = 0.0_DP
    do k = 1, outline%n
      r = in_plane(plane, outline%x(:, k))
      J(:, 1) = J(:, 1) + r * dN(1, k)
      J(:, 2) = J(:, 2) + r * dN(2, k)
    end do
    if (is_line(outline%kind)) J = reshape([J(1, 1), 0.0_DP, 0.0_DP, 1.0_DP], [2, 2])
    det = J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)
    d_xi = 0.0_DP
    d_N = 0.0_DP
    if (abs(det) <= tiny(1.0_DP)) return
    inverse = reshape([J(2, 2), -J(2, 1), -J(1, 2), J(1, 1)], [2, 2]) / det
    do i = 1, nd
      r = d_at(:, i) - matmul(outline%d_flat(:, i, :outline%n), N(:outline%n))
      d_xi(:, i) = matmul(inverse, r)
      if (is_line(outline%kind)) d_xi(2, i) = 0.0_DP
      do k = 1, outline%n
        d_N(k, i) = dN(1, k) * d_xi(1, i) + dN(2, k) * d_xi(2, i)
      end do
    end do
  end subroutine differentiate_place


  !> The weight times the area of the slave's face over that in the plane, and times the depth of a line: as in `segments`.
  pure subroutine scale_weight(own, plane, turn, nd, xi, d_xi, point)
    type(outline_type), intent(in) :: own
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: turn(2, MOST)
    integer, intent(in) :: nd
    real(DP), intent(in) :: xi(2), d_xi(2, MOST)
    type(point_rates_type), intent(inout) :: point !< with N_j on the slave
    real(DP) :: scale, d_scale
    real(DP) :: N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), t(3, 2), second(3, 3), d_t(3, 2)
    real(DP) :: normal(3), d_normal(3), along, length, depth, d_along
    integer :: i, k, a
    call facet_shapes(own%kind, xi, N_i, dN, ddN)
    associate (m => own%n)
      t = matmul(own%x(:, :m), transpose(dN(:, :m)))
      second = matmul(own%x(:, :m), transpose(ddN(:, :m)))
      if (is_line(own%kind)) t(:, 2) = [0.0_DP, 0.0_DP, 1.0_DP]
      normal = cross_product(t(:, 1), t(:, 2))
      length = norm2(normal)
      along = max(dot_product(normal, plane%normal), 0.1_DP * length)
      depth = depth_at(plane, matmul(own%x(:, :m), point%on_slave(:m)))
    end associate
    scale = length / along * depth
    do i = 1, nd
      d_t(:, 1) = second(:, 1) * d_xi(1, i) + second(:, 3) * d_xi(2, i)
      d_t(:, 2) = second(:, 3) * d_xi(1, i) + second(:, 2) * d_xi(2, i)
      k = (i + 2) / 3 - own%first
      a = modulo(i - 1, 3) + 1
      if (k >= 1 .and. k <= own%n) d_t(a, :) = d_t(a, :) + dN(:, k)
      if (is_line(own%kind)) d_t(:, 2) = 0.0_DP
      d_normal = cross_product(d_t(:, 1), t(:, 2)) + cross_product(t(:, 1), d_t(:, 2))
      d_along = dot_product(d_normal, plane%normal) + dot_product(matmul(plane%axes, turn(:, i)), normal)
      if (along <= 0.1_DP * length) d_along = 0.1_DP * dot_product(normal, d_normal) / length
      d_scale = depth * (dot_product(normal, d_normal) / (length * along) - length * d_along / along**2)
      if (plane%depth < 0.0_DP) then
        d_scale = d_scale + 2 * PI * length / along * dot_product(own%x(1, :own%n), point%d_on_slave(:own%n, i))
        if (k >= 1 .and. k <= own%n .and. a == 1) d_scale = d_scale + 2 * PI * length / along * point%on_slave(k)
      end if
      point%d_weight(i) = point%d_weight(i) * scale + point%weight * d_scale
    end do
    point%weight = point%weight * scale
  end subroutine scale_weight


  !> One point's part of all sums.
  pure subroutine add_point(n_own, n_front, nd, map, point, rates, sums)
    integer, intent(in) :: n_own, n_front, nd
    integer, intent(in) :: map(:)                  !< places of the nodes of slave and master in rates%nodes
    type(point_rates_type), intent(in) :: point
    type(facet_rates_type), intent(inout) :: rates
    type(sums_type), intent(inout) :: sums
    real(DP) :: e(max(sums%n, 3)), d_e(max(sums%n, 3)), d_w
    integer :: i, j, k, at, m
    m = sums%n
    associate (w => point%weight, front => map(n_own + 1:n_own + n_front))
      if (sums%is_full) e(:m) = point%on_slave(:m)
      if (.not. sums%is_full) e = [1.0_DP, (point%at - sums%middle) / sums%unit]
      rates%share = rates%share + w * point%on_slave(:n_own)
      do j = 1, m
        sums%gram(:, j) = sums%gram(:, j) + w * e(j) * e(:m)
      end do
      do k = 1, n_front
        sums%cross(:, front(k)) = sums%cross(:, front(k)) + w * point%on_master(k) * e(:m)
      end do
      do i = 1, nd
        at = 3 * (map((i + 2) / 3) - 1) + modulo(i - 1, 3) + 1
        d_w = point%d_weight(i)
        if (sums%is_full) d_e(:m) = point%d_on_slave(:m, i)
        if (.not. sums%is_full) d_e = [0.0_DP, point%d_at(:, i) / sums%unit]
        rates%d_share(:, at) = rates%d_share(:, at) + d_w * point%on_slave(:n_own) + w * point%d_on_slave(:n_own, i)
        do j = 1, m
          sums%d_gram(:, j, at) = sums%d_gram(:, j, at) + d_w * e(j) * e(:m) + w * (d_e(j) * e(:m) + e(j) * d_e(:m))
        end do
        do k = 1, n_front
          sums%d_cross(:, front(k), at) = sums%d_cross(:, front(k), at) + (d_w * point%on_master(k) &
            + w * point%d_on_master(k, i)) * e(:m) + w * point%on_master(k) * d_e(:m)
        end do
      end do
    end associate
  end subroutine add_point


  !> M_ji = d_j l_j' inv(G) C_i with l_j the unit vectors (the basis N~) or (1, y_j).
  subroutine finish_blocks(slave, f, x, plane, turn, rates, sums)
    type(facets_type), intent(in) :: slave
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: turn(2, MOST)
    type(facet_rates_type), intent(inout) :: rates
    type(sums_type), intent(in) :: sums
    type(outline_type) :: own
    real(DP), allocatable :: head(:, :), d_head(:, :), solved(:, :), by_unit(:, :), inverse(:, :), unit(:, :)
    real(DP) :: flat(2, rates%n_slave), d_flat(2, rates%n_slave)
    integer :: i, m, n, status
    n = rates%n_slave
    m = sums%n
    allocate (head(n, m), d_head(n, m), unit(m, m), inverse(m, m), source=0.0_DP)
    do i = 1, m
      unit(i, i) = 1.0_DP
    end do
    call solve_small(sums%gram, unit, inverse, status)
    if (status /= DENSE_OK) then                   ! a needle: constants, as in `dual`
      call finish_needle(rates, sums)
      return
    end if
    call lay_outline(slave, f, x, plane, turn, 0, .false., own)
    if (sums%is_full) head = unit
    if (.not. sums%is_full) then
      do i = 1, n
        flat(:, i) = in_plane(plane, own%x(:, i))
      end do
      call transform_nodes(own%kind, flat)
      head(:, 1) = 1.0_DP
      head(:, 2:) = (transpose(flat) - spread(sums%middle, 1, n)) / sums%unit
    end if
    solved = matmul(inverse, sums%cross)
    rates%block = spread(rates%share, 2, size(rates%nodes)) * matmul(head, solved)
    do i = 1, 3 * size(rates%nodes)
      by_unit = matmul(inverse, sums%d_cross(:, :, i) - matmul(sums%d_gram(:, :, i), solved))
      d_head = 0.0_DP
      if (.not. sums%is_full .and. i <= 3 * n) then
        d_flat = own%d_flat(:, i, :n)
        call transform_nodes(own%kind, d_flat)
        d_head(:, 2:) = transpose(d_flat) / sums%unit
      end if
      rates%d_block(:, :, i) = spread(rates%d_share(:, i), 2, size(rates%nodes)) * matmul(head, solved) &
        + spread(rates%share, 2, size(rates%nodes)) * (matmul(head, by_unit) + matmul(d_head, solved))
    end do
  end subroutine finish_blocks


  !> phi_j = d_j/(sum of all): M_ji = d_j C_i/G with the constant alone.
  pure subroutine finish_needle(rates, sums)
    type(facet_rates_type), intent(inout) :: rates
    type(sums_type), intent(in) :: sums
    integer :: i, j
    if (sums%is_full) return
    do i = 1, size(rates%nodes)
      rates%block(:, i) = rates%share * sums%cross(1, i) / sums%gram(1, 1)
      do j = 1, 3 * size(rates%nodes)
        rates%d_block(:, i, j) = (rates%d_share(:, j) * sums%cross(1, i) + rates%share * (sums%d_cross(1, i, j) &
          - sums%cross(1, i) * sums%d_gram(1, 1, j) / sums%gram(1, 1))) / sums%gram(1, 1)
      end do
    end do
  end subroutine finish_needle


  !> How the row of a slave node changes with all nodes of the facets around it: as `mortar` fills it.
  subroutine differentiate_row(mortar, master, search, x, reach, j, facet_rates, rates)
    type(mortar_type), intent(in) :: mortar        !< as integrated at x
    type(facets_type), intent(in) :: master
    type(search_type), intent(in) :: search        !< of the master's facets
    real(DP), intent(in) :: x(:, :), reach         !< as for `integrate_mortar`
    integer, intent(in) :: j                       !< row, with a master in front
    type(facet_rates_type), intent(inout) :: facet_rates(:)   !< (n_facets) those of the star of its vertex are made if they are not
    type(row_rates_type), intent(out) :: rates
    real(DP), allocatable :: sum_of(:, :, :)       ! of d_j T - M_ji, which is w_k times the area
    real(DP), allocatable :: own_area(:, :)
    type(fade_type), allocatable :: fades(:)
    real(DP) :: taken(MAX_FACE_NODES), d_taken(MAX_FACE_NODES, MAX_FACE_NODES), own_share
    integer, allocatable :: at(:)
    integer :: s, f, own, i, k
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        f = slave%star_facet(s)
        if (.not. facet_rates(f)%is_made) call differentiate_cuts(slave, f, mortar%depth(f), master, search, x, reach, &
          facet_rates(f))
      end do
    end associate
    call gather_star(mortar, j, facet_rates, rates%nodes)
    call gather_fades(mortar, master, x, j, rates%nodes, fades)
    k = size(rates%nodes)
    allocate (sum_of(size(mortar%rows(j)%nodes), 3, k), rates%d_area(3, k), own_area(3, k), source=0.0_DP)
    own_share = 0.0_DP
    associate (slave => mortar%slave, row => mortar%rows(j), area => mortar%places(j)%area)
      do s = slave%star_first(mortar%places(j)%vertex), slave%star_first(mortar%places(j)%vertex + 1) - 1
        f = slave%star_facet(s)
        own = slave%star_local(s)
        if (size(facet_rates(f)%nodes) == facet_rates(f)%n_slave) cycle   ! nothing in front
        call take_parts(slave%kind(f), own, mortar%beyond(mortar%place_of(slave%first(f):slave%first(f + 1) - 1)), taken, d_taken)
        at = [(findloc(rates%nodes, facet_rates(f)%nodes(i), dim=1), i=1, size(facet_rates(f)%nodes))]
        own_share = own_share + facet_rates(f)%share(own)
        do i = 1, size(at)
          own_area(:, at(i)) = own_area(:, at(i)) + facet_rates(f)%d_share(own, 3 * i - 2:3 * i)
        end do
        call add_facet(mortar, facet_rates(f), taken, at, row, sum_of, rates%d_area)
        call add_fades(mortar, facet_rates(f), d_taken, fades, at, row, sum_of, rates%d_area)
      end do
      allocate (rates%d_weights, mold=sum_of)
      do i = 1, size(row%nodes)
        rates%d_weights(i, :, :) = (sum_of(i, :, :) - row%weights(i) * rates%d_area) / area
      end do
      rates%d_factor = rates%d_area / area
      if (.not. mortar%is_soft) rates%d_factor = rates%d_factor - own_area / own_share
    end associate
  end subroutine differentiate_row


  !> The nodes of a row, then all others of the facets around it and of their masters.
  pure subroutine gather_star(mortar, j, facet_rates, nodes)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: j
    type(facet_rates_type), intent(in) :: facet_rates(:)
    integer, allocatable, intent(out) :: nodes(:)
    integer :: s, i
    nodes = mortar%rows(j)%nodes
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        associate (others => facet_rates(slave%star_facet(s))%nodes)
          do i = 1, size(others)
            if (all(nodes /= others(i))) nodes = [nodes, others(i)]
          end do
        end associate
      end do
    end associate
  end subroutine gather_star


  !> How the parts change that nodes around a row give, with the distance of each beyond the edge of its master; nodes on which that
  !! depends are appended.
  subroutine gather_fades(mortar, master, x, j, nodes, fades)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    integer, intent(in) :: j                       !< row
    integer, allocatable, intent(inout) :: nodes(:)
    type(fade_type), allocatable, intent(out) :: fades(:)
    type(fade_type) :: fade
    integer :: s, i, k, n
    allocate (fades(0))
    if (.not. mortar%is_soft) return
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        do i = slave%first(slave%star_facet(s)), slave%first(slave%star_facet(s) + 1) - 1
          k = mortar%place_of(i)
          if (mortar%beyond(k) <= 0.0_DP .or. mortar%beyond(k) >= 1.0_DP) cycle
          if (any(fades%node == mortar%nodes(k))) cycle
          call differentiate_fade(mortar, master, x, k, fade)
          do n = 1, size(fade%at)                  ! mesh nodes to places
            if (all(nodes /= fade%at(n))) nodes = [nodes, fade%at(n)]
            fade%at(n) = findloc(nodes, fade%at(n), dim=1)
          end do
          fades = [fades, fade]
        end do
      end do
    end associate
  end subroutine gather_fades


  !> How the part that a slave node gives changes with its slave facet and the master's edge beyond which it is.
  subroutine differentiate_fade(mortar, master, x, k, fade)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    integer, intent(in) :: k                       !< slave node
    type(fade_type), intent(out) :: fade           !< at: mesh nodes
    type(outline_type) :: own, front
    type(plane_type) :: plane
    real(DP) :: turn(2, MOST), across(2), moved(MOST), rate(MOST)
    integer :: i, nd, n, nodes(MAX_FACE_NODES)
    associate (f => mortar%edges(1, k), local => mortar%edges(2, k), g => mortar%edges(3, k), edge => mortar%edges(4, k))
      call lay_plane(mortar%slave, f, x, plane)
      turn = turn_of(mortar%slave, f, x, plane)
      call lay_outline(mortar%slave, f, x, plane, turn, 0, .false., own)
      call lay_outline(master, g, x, plane, turn, own%n, .true., front)
      nd = 3 * (own%n + front%n)
      call move_edge(front, nd, edge, modulo(edge, front%n_corners) + 1, in_plane(plane, own%x(:, local)), across, moved)
      rate = 0.0_DP
      do i = 1, nd
        rate(i) = fading(mortar%beyond(k)) / mortar%slave%edge_length(f) * (dot_product(across, own%d_flat(:, i, local)) - moved(i))
      end do
      call facet_nodes(mortar%slave, f, n, nodes)
      fade%node = mortar%nodes(k)
      fade%at = nodes(:n)
      call facet_nodes(master, g, n, nodes)
      fade%at = [fade%at, nodes(:n)]
      fade%rate = reshape(rate(:nd), [3, nd / 3])
    end associate
  end subroutine differentiate_fade


  !> What one facet gives to the derivative of a row since the parts change that the row takes.
  subroutine add_fades(mortar, facet, d_taken, fades, at, row, sum_of, d_area)
    type(mortar_type), intent(in) :: mortar
    type(facet_rates_type), intent(in) :: facet
    real(DP), intent(in) :: d_taken(MAX_FACE_NODES, MAX_FACE_NODES)
    type(fade_type), intent(in) :: fades(:)
    integer, intent(in) :: at(:)                   !< places of the facet's nodes among those of the row's rates
    type(contact_row_type), intent(in) :: row
    real(DP), intent(inout) :: sum_of(:, :, :), d_area(:, :)
    type(contact_row_type) :: part
    real(DP) :: values(size(row%nodes)), rate(3)
    integer :: i, j, k, q, local, node
    do i = 1, facet%n_slave
      if (all(abs(d_taken(i, :)) <= 0.0_DP)) cycle
      node = findloc(mortar%nodes, facet%nodes(i), dim=1)
      call start_row(mortar%nodes(node), mortar%corners(:, node), part)
      values = 0.0_DP                              ! what the row has of it
      do k = 1, size(part%nodes)
        where (row%nodes == part%nodes(k)) values = values + facet%share(i) * part%weights(k)
      end do
      do k = facet%n_slave + 1, size(facet%nodes)
        if (at(k) <= size(values)) values(at(k)) = values(at(k)) - facet%block(i, k)
      end do
      do q = 1, size(fades)
        local = findloc(facet%nodes(:facet%n_slave), fades(q)%node, dim=1)
        if (local == 0) cycle
        do j = 1, size(fades(q)%at)
          rate = d_taken(i, local) * fades(q)%rate(:, j)
          d_area(:, fades(q)%at(j)) = d_area(:, fades(q)%at(j)) + facet%share(i) * rate
          sum_of(:, :, fades(q)%at(j)) = sum_of(:, :, fades(q)%at(j)) + spread(values, 2, 3) * spread(rate, 1, size(values))
        end do
      end do
    end do
  end subroutine add_fades


  !> What one facet gives to a row: d_i T_i for the functions that the row takes, less the master's part.
  subroutine add_facet(mortar, facet, taken, at, row, sum_of, d_area)
    type(mortar_type), intent(in) :: mortar
    type(facet_rates_type), intent(in) :: facet
    real(DP), intent(in) :: taken(MAX_FACE_NODES)
    integer, intent(in) :: at(:)                   !< places of the facet's nodes among those of the row's rates
    type(contact_row_type), intent(in) :: row
    real(DP), intent(inout) :: sum_of(:, :, :), d_area(:, :)
    type(contact_row_type) :: part
    integer :: i, j, k, q, node
    do i = 1, facet%n_slave
      if (taken(i) <= 0.0_DP) cycle
      node = findloc(mortar%nodes, facet%nodes(i), dim=1)
      call start_row(mortar%nodes(node), mortar%corners(:, node), part)
      do j = 1, size(facet%nodes)
        d_area(:, at(j)) = d_area(:, at(j)) + taken(i) * facet%d_share(i, 3 * j - 2:3 * j)
        do q = 1, size(part%nodes)
          k = findloc(row%nodes, part%nodes(q), dim=1)
          if (k > 0) sum_of(k, :, at(j)) = sum_of(k, :, at(j)) + taken(i) * part%weights(q) * facet%d_share(i, 3 * j - 2:3 * j)
        end do
      end do
      do k = facet%n_slave + 1, size(facet%nodes)
        q = at(k)                                  ! masters of the row stand among its nodes
        if (q > size(row%nodes)) cycle
        do j = 1, size(facet%nodes)
          sum_of(q, :, at(j)) = sum_of(q, :, at(j)) - taken(i) * facet%d_block(i, k, 3 * j - 2:3 * j)
        end do
      end do
    end do
  end subroutine add_facet

end module amontons_cut_rates
