!> Cut rates: how the integrals over the cuts of a slave facet change when the nodes move.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Mortar". Everything is a function of the places of the nodes of the slave facet and of the
!! master facets that it is cut with: corners of the cuts are where two of their edges cross, and points of the integrals go with
!! the corners. The derivatives follow from each other in that order (M. Puso, T. Laursen, Comput. Methods Appl. Mech. Engrg. 193
!! (2004) 601-629). The frame of the slave facet is turned with its normal alone: what it turns or moves within its own
!! plane changes no integral.
module amontons_segment_derivatives
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_topology, only: facet_kind, facet_kind_type, MAX_FACE_NODES
  use amontons_shape_functions, only: facet_shapes
  use amontons_facets, only: facets_type, facet_nodes, is_line
  use amontons_polygon_clipping, only: clip_polygon, polygon_area, polygon_points, MAX_CORNERS, MAX_CUT_POINTS
  use amontons_dense, only: solve_small, DENSE_OK
  use amontons_dual_shape_functions, only: full_part, transform_shapes, transform_nodes
  use amontons_mortar_segmentation, only: plane_type, segment_type, cover_type, in_plane, corners_in, depth_at, order_for
  implicit none
  private
  public :: facet_rates_type, outline_type, differentiate_cuts, turn_of, lay_outline, move_edge, MOST

  integer, parameter :: MOST = 6 * MAX_FACE_NODES  !< coordinates on which one cut depends
  integer, parameter :: MOST_WAYS = 7              !< in which an integrand changes: weight, xi, eta, at

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

  !> Where a facet is in the plane of the cut, and how that changes with the coordinates of slave and master, 3 (n_slave +
  !! n_master) of them.
  type :: outline_type
    integer :: kind = 0                            !< FACET_...
    integer :: n = 0                               !< nodes
    integer :: first = 0                           !< nodes before them among those of slave and master
    real(DP) :: x(3, MAX_FACE_NODES) = 0           !< [length]
    real(DP) :: flat(2, MAX_FACE_NODES) = 0        !< places of the nodes in the plane [length]
    real(DP) :: height(MAX_FACE_NODES) = 0         !< of the nodes above it [length]
    real(DP) :: axes(3, 2) = 0                     !< of the plane; the second is no direction of a line
    real(DP) :: d_flat(MOST, 2, MAX_FACE_NODES) = 0     !< of the places of the nodes [-]
    integer :: n_corners = 0
    real(DP) :: corners(2, 4) = 0                  !< counter-clockwise in the plane [length]
    integer :: node(4) = 0                         !< of each corner
  end type outline_type

  !> A point of the integrals and how it changes with the coordinates. The integrands are functions of xi, eta and `at`.
  type :: point_rates_type
    real(DP) :: weight = 0                         !< [length^2]
    real(DP) :: at(2) = 0                          !< in the plane [length]
    real(DP) :: xi(2) = 0, eta(2) = 0              !< natural coordinates on slave and master [-]
    real(DP) :: on_slave(0:2, MAX_FACE_NODES) = 0  !< N~_j and its derivatives by xi [-]
    real(DP) :: on_master(0:2, MAX_FACE_NODES) = 0 !< N_i and its derivatives by eta [-]
    real(DP) :: d_weight(MOST) = 0
    real(DP) :: d_xi(MOST, 2) = 0, d_eta(MOST, 2) = 0, d_at(MOST, 2) = 0
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

contains

  !> The integrals over a slave facet and how they change. Cost: points of the integrals times coordinates times functions.
  subroutine differentiate_cuts(slave, f, master, x, cover, rates)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f                       !< slave facet
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    type(cover_type), intent(in) :: cover          !< its cuts there
    type(facet_rates_type), intent(out) :: rates
    type(facet_rates_type) :: other
    type(outline_type) :: own
    real(DP) :: turn(MOST, 2), d_area(MOST), area, d_cover, part, slope
    integer :: i
    rates%is_made = .true.
    call gather_nodes(slave, f, master, cover%segments(:cover%n), rates)
    if (cover%n == 0) return
    if (sum(cover%points%weight(:cover%points%n)) <= 0.0_DP) return
    turn = turn_of(slave, f, x, cover%plane)
    call lay_outline(slave, f, x, cover%plane, turn, 0, .false., own)
    call differentiate_area(own, cover%plane, area, d_area)
    call full_part(slave%kind(f), sum(cover%points%weight(:cover%points%n)) / area, part, slope)
    other = rates
    if (part < 1.0_DP) call differentiate_basis(own, master, x, cover, turn, sqrt(area), .false., other)
    if (part > 0.0_DP) call differentiate_basis(own, master, x, cover, turn, sqrt(area), .true., rates)
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
        d_area(i) = d_area(i) + depth * dot_product(across, own%d_flat(i, :, own%node(k)))
      end do
    end do
    if (plane%depth >= 0.0_DP) return
    d_area([1, 4]) = d_area([1, 4]) + PI * flat    ! the origin is the middle of the two corners of a line
  end subroutine differentiate_area


  !> The integrals with the dual functions of one basis, N~ or the linear functions of the place.
  subroutine differentiate_basis(own, master, x, cover, turn, unit, is_full, rates)
    type(outline_type), intent(in) :: own
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    type(cover_type), intent(in) :: cover
    real(DP), intent(in) :: turn(MOST, 2)
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
      call add_cut(own, master, x, cover, k, turn, rates, sums)
    end do
    call finish_blocks(own, rates, sums)
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
    real(DP) :: turn(MOST, 2), side(3, 2), sign_of(2, 4), unit(3), d_m(3), length
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
        turn(3 * (i - 1) + a, :) = matmul(d_m, plane%axes) / length
      end do
    end do
    if (is_line(slave%kind(f))) turn(:, 2) = 0.0_DP
  end function turn_of


  !> One cut's part of all sums: its rates are how its points change in each way, times how the integrands change with that.
  subroutine add_cut(own, master, x, cover, k, turn, rates, sums)
    type(outline_type), intent(in) :: own
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    type(cover_type), intent(in) :: cover
    integer, intent(in) :: k                       !< segment
    real(DP), intent(in) :: turn(MOST, 2)
    type(facet_rates_type), intent(inout) :: rates
    type(sums_type), intent(inout) :: sums
    type(outline_type) :: front
    type(point_rates_type) :: point
    real(DP) :: cut(2, MAX_CORNERS), d_cut(MOST, 2, MAX_CORNERS), at(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS)
    real(DP) :: place(2, MAX_CUT_POINTS)
    real(DP), allocatable :: ways(:, :)            ! (coordinates, ways of all points)
    real(DP), allocatable :: slopes(:, :)          ! (ways of all points, integrals)
    real(DP), allocatable :: values(:)             ! (integrals)
    integer :: lines(MAX_CORNERS), corner(MAX_CUT_POINTS), n, q, n_points, nd, m, i
    associate (g => cover%segments(k)%master, first => cover%segments(k)%first, plane => cover%plane)
      call lay_outline(master, g, x, plane, turn, own%n, .true., front)
      nd = 3 * (own%n + front%n)
      call clip_polygon(own%corners(:, :own%n_corners), front%corners(:, :front%n_corners), cut, n, lines)
      call move_corners(own, front, nd, lines, n, cut, d_cut)
      call polygon_points(cut(:, :n), is_line(own%kind), max(order_for(own%kind, own%corners), order_for(front%kind, &
        front%corners)), n_points, at, weight, corner, place)
      allocate (values((sums%n * (sums%n + 1)) / 2 + sums%n * front%n + own%n), source=0.0_DP)
      m = merge(MOST_WAYS - 2, MOST_WAYS, sums%is_full)     ! N~ does not know the place
      allocate (ways(nd, m * n_points), slopes(m * n_points, size(values)))
      do q = 1, n_points
        point%at = at(:, q)
        point%weight = weight(q)
        point%xi = cover%points%xi(:, first + q - 1)
        point%eta = cover%points%eta(:, first + q - 1)
        call move_point(cut, d_cut, corner(q), place(:, q), nd, point)
        call differentiate_point(own, front, plane, turn, nd, point)
        i = m * (q - 1)
        ways(:, i + 1) = point%d_weight(:nd)
        ways(:, i + 2:i + 3) = point%d_xi(:nd, :)
        ways(:, i + 4:i + 5) = point%d_eta(:nd, :)
        if (.not. sums%is_full) ways(:, i + 6:i + 7) = point%d_at(:nd, :)
        call differentiate_integrands(own%n, front%n, point, sums, slopes(i + 1:i + m, :))
        values = values + point%weight * slopes(i + 1, :)
      end do
      call scatter_integrals(own, front, master, g, values, matmul(ways, slopes), rates, sums)
    end associate
  end subroutine add_cut


  !> All integrands at a point, and how the weighted ones change: e_j e_l for j up to l, then e_j N_i, then N~_j.
  pure subroutine differentiate_integrands(n_own, n_front, point, sums, slopes)
    integer, intent(in) :: n_own, n_front
    type(point_rates_type), intent(in) :: point
    type(sums_type), intent(in) :: sums
    real(DP), intent(out) :: slopes(:, :)          !< (n_ways, n_integrals): by the weight, xi, eta, at
    real(DP) :: on_slave(MOST_WAYS, MAX_FACE_NODES), on_master(MOST_WAYS, MAX_FACE_NODES), basis(MOST_WAYS, MAX_FACE_NODES)
    integer :: j, k, m, n
    m = size(slopes, 1)                            ! product rule; the value stands first
    on_slave = 0.0_DP
    on_slave(:3, :) = point%on_slave
    on_slave(2:3, :) = point%weight * on_slave(2:3, :)
    on_master = 0.0_DP
    on_master([1, 4, 5], :) = point%on_master
    on_master(4:5, :) = point%weight * on_master(4:5, :)
    if (sums%is_full) then
      basis = on_slave
    else
      basis = 0.0_DP
      basis(1, :3) = [1.0_DP, (point%at - sums%middle) / sums%unit]
      basis(6, 2) = point%weight / sums%unit
      basis(7, 3) = point%weight / sums%unit
    end if
    n = 0
    do k = 1, sums%n
      do j = 1, k
        slopes(:, n + j) = basis(1, j) * basis(:m, k) + basis(1, k) * basis(:m, j)
        slopes(1, n + j) = basis(1, j) * basis(1, k)
      end do
      n = n + k
    end do
    do k = 1, n_front
      do j = 1, sums%n
        slopes(:, n + j) = basis(1, j) * on_master(:m, k) + on_master(1, k) * basis(:m, j)
        slopes(1, n + j) = basis(1, j) * on_master(1, k)
      end do
      n = n + sums%n
    end do
    slopes(:, n + 1:) = on_slave(:m, :n_own)
  end subroutine differentiate_integrands


  !> Adds the integrals over one cut and their rates to the sums.
  pure subroutine scatter_integrals(own, front, master, g, values, d_values, rates, sums)
    type(outline_type), intent(in) :: own, front
    type(facets_type), intent(in) :: master
    integer, intent(in) :: g                       !< master facet
    real(DP), intent(in) :: values(:)              !< (n_integrals)
    real(DP), intent(in) :: d_values(:, :)         !< (coordinates, n_integrals)
    type(facet_rates_type), intent(inout) :: rates
    type(sums_type), intent(inout) :: sums
    integer :: map(2 * MAX_FACE_NODES), nodes(MAX_FACE_NODES), at(MOST), i, j, k, n
    call facet_nodes(master, g, n, nodes)
    map(:own%n) = [(i, i=1, own%n)]
    map(own%n + 1:own%n + n) = [(findloc(rates%nodes, nodes(i), dim=1), i=1, n)]
    do i = 1, size(d_values, 1)
      at(i) = 3 * (map((i + 2) / 3) - 1) + modulo(i - 1, 3) + 1
    end do
    n = 0
    do k = 1, sums%n
      do j = 1, k
        n = n + 1
        call add_to(sums%gram(j, k), sums%d_gram(j, k, :))
        if (j < k) call add_to(sums%gram(k, j), sums%d_gram(k, j, :))
      end do
    end do
    do k = 1, front%n
      do j = 1, sums%n
        n = n + 1
        call add_to(sums%cross(j, map(own%n + k)), sums%d_cross(j, map(own%n + k), :))
      end do
    end do
    do j = 1, own%n
      n = n + 1
      call add_to(rates%share(j), rates%d_share(j, :))
    end do

  contains

    !> The integral n and its rates.
    pure subroutine add_to(value, d_value)
      real(DP), intent(inout) :: value, d_value(:)
      integer :: c
      value = value + values(n)
      do c = 1, size(d_values, 1)
        d_value(at(c)) = d_value(at(c)) + d_values(c, n)
      end do
    end subroutine add_to

  end subroutine scatter_integrals


  !> A facet in the plane of the cut; the master's corners run the other way round.
  pure subroutine lay_outline(facets, f, x, plane, turn, first, is_front, outline)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: turn(MOST, 2)
    integer, intent(in) :: first
    logical, intent(in) :: is_front
    type(outline_type), intent(out) :: outline
    integer :: i, a, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, outline%n, nodes)
    outline%kind = facets%kind(f)
    outline%first = first
    outline%axes = plane%axes
    if (is_line(outline%kind)) outline%axes(:, 2) = 0.0_DP
    do i = 1, outline%n
      outline%x(:, i) = x(:, nodes(i))
      outline%flat(:, i) = in_plane(plane, outline%x(:, i))
      outline%height(i) = dot_product(plane%normal, outline%x(:, i) - plane%origin)
      outline%d_flat(:, :, i) = -outline%height(i) * turn
      do a = 1, 3
        associate (rate => outline%d_flat(3 * (first + i - 1) + a, :, i))
          rate = rate + outline%axes(a, :)
        end associate
      end do
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
    real(DP), intent(out) :: d_cut(MOST, 2, MAX_CORNERS)
    real(DP) :: across(2, 2), moved(MOST, 2), det
    integer :: k
    do k = 1, n
      call move_line(own, front, nd, lines(k), cut(:, k), across(:, 1), moved(:, 1))
      call move_line(own, front, nd, lines(modulo(k, n) + 1), cut(:, k), across(:, 2), moved(:, 2))
      det = across(1, 1) * across(2, 2) - across(2, 1) * across(1, 2)
      if (abs(det) > 1.0e-9_DP) then
        d_cut(:nd, 1, k) = (across(2, 2) * moved(:nd, 1) - across(2, 1) * moved(:nd, 2)) / det
        d_cut(:nd, 2, k) = (across(1, 1) * moved(:nd, 2) - across(1, 2) * moved(:nd, 1)) / det
      else                                         ! both edges on one line
        d_cut(:nd, 1, k) = across(1, 1) * moved(:nd, 1)
        d_cut(:nd, 2, k) = across(2, 1) * moved(:nd, 1)
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
    edge = outline%corners(:, b) - outline%corners(:, a)
    part = dot_product(edge, at - outline%corners(:, a)) / max(dot_product(edge, edge), tiny(1.0_DP))
    across = [edge(2), -edge(1)] / max(norm2(edge), tiny(1.0_DP))
    moved = 0.0_DP
    associate (d_a => outline%d_flat(:nd, :, outline%node(a)), d_b => outline%d_flat(:nd, :, outline%node(b)))
      moved(:nd) = across(1) * ((1 - part) * d_a(:, 1) + part * d_b(:, 1)) + across(2) * ((1 - part) * d_a(:, 2) + part * d_b(:, 2))
    end associate
  end subroutine move_edge


  !> Place and weight of a point go with the triangle in which it is.
  pure subroutine move_point(cut, d_cut, k, place, nd, point)
    real(DP), intent(in) :: cut(2, MAX_CORNERS), d_cut(MOST, 2, MAX_CORNERS)
    integer, intent(in) :: k                       !< of the triangle 1, k, k + 1
    real(DP), intent(in) :: place(2)               !< parts of k and k + 1 [-]
    integer, intent(in) :: nd
    type(point_rates_type), intent(inout) :: point
    real(DP) :: a(2), b(2), share, d_a(2), d_b(2)
    integer :: i
    a = cut(:, k) - cut(:, 1)
    b = cut(:, k + 1) - cut(:, 1)
    share = point%weight / (a(1) * b(2) - a(2) * b(1))
    do i = 1, nd
      d_a = d_cut(i, :, k) - d_cut(i, :, 1)
      d_b = d_cut(i, :, k + 1) - d_cut(i, :, 1)
      point%d_at(i, :) = d_cut(i, :, 1) + place(1) * d_a + place(2) * d_b
      point%d_weight(i) = share * (d_a(1) * b(2) - d_a(2) * b(1) + a(1) * d_b(2) - a(2) * d_b(1))
    end do
  end subroutine move_point


  !> The functions of both facets at a point, and the weight of the slave's curved face, with their derivatives.
  pure subroutine differentiate_point(own, front, plane, turn, nd, point)
    type(outline_type), intent(in) :: own, front
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: turn(MOST, 2)
    integer, intent(in) :: nd
    type(point_rates_type), intent(inout) :: point
    real(DP) :: ddN(3, MAX_FACE_NODES)
    integer :: i
    call differentiate_place(front, turn, nd, point%eta, point%d_at, point%d_eta, point%on_master, ddN)
    call differentiate_place(own, turn, nd, point%xi, point%d_at, point%d_xi, point%on_slave, ddN)
    call scale_weight(own, plane, turn, nd, ddN, point)
    do i = 0, 2
      call transform_shapes(own%kind, point%on_slave(i, :))
    end do
  end subroutine differentiate_point


  !> How the natural coordinates of a point of the plane change: J d_xi = d_at - sum N_k d_flat_k.
  pure subroutine differentiate_place(outline, turn, nd, xi, d_at, d_xi, shapes, ddN)
    type(outline_type), intent(in) :: outline
    real(DP), intent(in) :: turn(MOST, 2)
    integer, intent(in) :: nd
    real(DP), intent(in) :: xi(2), d_at(MOST, 2)
    real(DP), intent(out) :: d_xi(MOST, 2)
    real(DP), intent(out) :: shapes(0:2, MAX_FACE_NODES)   !< N and dN/dxi [-]
    real(DP), intent(out) :: ddN(3, MAX_FACE_NODES)
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), J(2, 2), r(MOST, 2), height, det
    integer :: i, k
    call facet_shapes(outline%kind, xi, N, dN, ddN)
    shapes(0, :) = N
    shapes(1:2, :) = dN
    J = matmul(outline%flat(:, :outline%n), transpose(dN(:, :outline%n)))
    if (is_line(outline%kind)) J = reshape([J(1, 1), 0.0_DP, 0.0_DP, 1.0_DP], [2, 2])
    det = J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)
    d_xi = 0.0_DP
    if (abs(det) <= tiny(1.0_DP)) then
      shapes(1:2, :) = 0.0_DP
      return
    end if
    height = dot_product(outline%height(:outline%n), N(:outline%n))
    r(:nd, :) = d_at(:nd, :) + height * turn(:nd, :)
    do k = 1, outline%n
      i = 3 * (outline%first + k - 1)
      r(i + 1:i + 3, :) = r(i + 1:i + 3, :) - N(k) * outline%axes
    end do
    d_xi(:nd, 1) = (J(2, 2) * r(:nd, 1) - J(1, 2) * r(:nd, 2)) / det
    if (is_line(outline%kind)) return
    d_xi(:nd, 2) = (J(1, 1) * r(:nd, 2) - J(2, 1) * r(:nd, 1)) / det
  end subroutine differentiate_place


  !> The weight times the area of the slave's face over that in the plane, and times the depth of a line: as in `segments`.
  pure subroutine scale_weight(own, plane, turn, nd, ddN, point)
    type(outline_type), intent(in) :: own
    type(plane_type), intent(in) :: plane
    real(DP), intent(in) :: turn(MOST, 2)
    integer, intent(in) :: nd
    real(DP), intent(in) :: ddN(3, MAX_FACE_NODES) !< on the slave
    type(point_rates_type), intent(inout) :: point !< with N_j, not N~_j on the slave
    real(DP) :: d_scale(MOST), t(3, 2), second(3, 3), normal(3), by_normal(3), by_t(3, 2), by_xi(2), along, length, depth
    integer :: i, k
    associate (m => own%n, N => point%on_slave(0, :own%n), dN => point%on_slave(1:2, :own%n))
      t = matmul(own%x(:, :m), transpose(dN))
      second = matmul(own%x(:, :m), transpose(ddN(:, :m)))
      if (is_line(own%kind)) t(:, 2) = [0.0_DP, 0.0_DP, 1.0_DP]
      normal = cross_product(t(:, 1), t(:, 2))
      length = norm2(normal)
      along = max(dot_product(normal, plane%normal), 0.1_DP * length)
      depth = depth_at(plane, matmul(own%x(:, :m), N))
      by_normal = normal / (length * along) - length / along**2 * plane%normal     ! of length/along
      if (along <= 0.1_DP * length) by_normal = 0.0_DP
      by_t(:, 1) = depth * cross_product(t(:, 2), by_normal)
      by_t(:, 2) = depth * cross_product(by_normal, t(:, 1))
      if (is_line(own%kind)) by_t(:, 2) = 0.0_DP
      by_xi = [dot_product(by_t(:, 1), second(:, 1)) + dot_product(by_t(:, 2), second(:, 3)), &
        dot_product(by_t(:, 1), second(:, 3)) + dot_product(by_t(:, 2), second(:, 2))]
      if (plane%depth < 0.0_DP) by_xi = by_xi + 2 * PI * length / along * matmul(dN, own%x(1, :m))
      d_scale(:nd) = by_xi(1) * point%d_xi(:nd, 1) + by_xi(2) * point%d_xi(:nd, 2)
      if (along > 0.1_DP * length) d_scale(:nd) = d_scale(:nd) - depth * length / along**2 &
        * matmul(turn(:nd, :), matmul(normal, plane%axes))
      do k = 1, m
        i = 3 * (own%first + k - 1)
        d_scale(i + 1:i + 3) = d_scale(i + 1:i + 3) + matmul(by_t, dN(:, k))
        if (plane%depth < 0.0_DP) d_scale(i + 1) = d_scale(i + 1) + 2 * PI * length / along * N(k)
      end do
    end associate
    point%d_weight(:nd) = point%d_weight(:nd) * (length / along * depth) + point%weight * d_scale(:nd)
    point%weight = point%weight * (length / along * depth)
  end subroutine scale_weight


  !> M_ji = d_j l_j' inv(G) C_i with l_j the unit vectors (the basis N~) or (1, y_j).
  subroutine finish_blocks(own, rates, sums)
    type(outline_type), intent(in) :: own
    type(facet_rates_type), intent(inout) :: rates
    type(sums_type), intent(in) :: sums
    real(DP), allocatable :: head(:, :), solved(:, :), by_share(:, :), inverse(:, :), unit(:, :)
    real(DP) :: rest(sums%n, size(rates%nodes)), moved(rates%n_slave, size(rates%nodes))
    real(DP) :: flat(2, rates%n_slave), d_flat(2, rates%n_slave)
    integer :: i, j, k, m, n, status
    n = rates%n_slave
    m = sums%n
    allocate (head(n, m), unit(m, m), inverse(m, m), source=0.0_DP)
    do i = 1, m
      unit(i, i) = 1.0_DP
    end do
    call solve_small(sums%gram, unit, inverse, status)
    if (status /= DENSE_OK) then                   ! a needle: constants, as in `dual`
      call finish_needle(rates, sums)
      return
    end if
    if (sums%is_full) head = unit
    if (.not. sums%is_full) then
      flat = own%flat(:, :n)
      call transform_nodes(own%kind, flat)
      head(:, 1) = 1.0_DP
      head(:, 2:) = (transpose(flat) - spread(sums%middle, 1, n)) / sums%unit
    end if
    solved = matmul(inverse, sums%cross)
    by_share = matmul(head, solved)
    head = matmul(head, inverse)
    rates%block = spread(rates%share, 2, size(rates%nodes)) * by_share
    do i = 1, 3 * size(rates%nodes)
      rest = sums%d_cross(:, :, i)
      do k = 1, m
        do j = 1, m
          rest(j, :) = rest(j, :) - sums%d_gram(j, k, i) * solved(k, :)
        end do
      end do
      moved = matmul(head, rest)
      if (.not. sums%is_full .and. i <= 3 * n) then
        d_flat = own%d_flat(i, :, :n)
        call transform_nodes(own%kind, d_flat)
        moved = moved + matmul(transpose(d_flat) / sums%unit, solved(2:, :))
      end if
      do k = 1, size(rates%nodes)
        rates%d_block(:, k, i) = rates%d_share(:, i) * by_share(:, k) + rates%share * moved(:, k)
      end do
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

end module amontons_segment_derivatives
