!> Derivatives of segment geometry, quadrature points and mortar integrals with respect to the nodal coordinates.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 7. All integrals are functions of the nodal positions of the slave facet and of the master
!! facets that it intersects: the corners of the intersections are crossings of two edges, and the integration points move with the
!! corners. The derivatives follow by the chain rule in that order (M. Puso, T. Laursen, Comput. Methods Appl. Mech. Engrg. 193
!! (2004) 601-629). The frame of the slave facet rotates with its normal alone: rotations and translations within its own plane
!! change no integral.
module amontons_segment_derivatives
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: facet_kind, facet_kind_type, MAX_FACE_NODES
  use amontons_shape_functions, only: facet_shapes
  use amontons_facets, only: facets_type, facet_nodes, is_line_facet
  use amontons_polygon_clipping, only: clip_polygon, signed_polygon_area, set_polygon_quadrature, MAX_POLYGON_CORNERS, &
    MAX_CUT_POINTS
  use amontons_dense, only: invert_small, DENSE_OK
  use amontons_dual_shape_functions, only: find_full_dual_fraction, transform_shape_functions, transform_nodal_positions, &
    is_transformed
  use amontons_mortar_segmentation, only: projection_plane_type, mortar_segment_type, segmentation_type, project_on_plane, &
    project_facet_corners, find_depth, choose_quadrature_order
  implicit none
  private
  public :: facet_derivatives_type, facet_outline_type, differentiate_segmentation, differentiate_plane_normal, &
    build_facet_outline, differentiate_edge, MAX_CUT_COORDINATES

  integer, parameter :: MAX_CUT_COORDINATES = 6 * MAX_FACE_NODES  !< coordinates on which one intersection depends
  integer, parameter :: MAX_INTEGRALS = (MAX_FACE_NODES * (3 * MAX_FACE_NODES + 3)) / 2   !< over one intersection

  !> The integrals over one slave facet and their derivatives with respect to the coordinates of its nodes and of its masters'.
  type :: facet_derivatives_type
    logical :: is_made = .false.
    integer :: n_slave = 0                         !< nodes of the facet, the first of nodes(:)
    integer, allocatable :: nodes(:)               !< (n) then those of its masters, each once
    real(DP), allocatable :: share(:)              !< (n_slave) integral of N~_j [length^2]
    real(DP), allocatable :: master_integrals(:, :)  !< (n_slave, n) integral of phi_j N_i; zero for the slave's own nodes
                                                     !! [length^2]
    real(DP), allocatable :: d_slave_integrals(:, :)         !< (n_slave, 3 n) [length]
    real(DP), allocatable :: d_master_integrals(:, :, :)      !< (n_slave, n, 3 n) [length]
  end type facet_derivatives_type

  !> A facet in the projection plane, with derivatives with respect to the 3 (n_slave + n_master) coordinates of slave and master.
  type :: facet_outline_type
    integer :: kind = 0                            !< FACET_...
    integer :: n = 0                               !< nodes
    integer :: first = 0                           !< nodes before them among those of slave and master
    real(DP) :: x(3, MAX_FACE_NODES) = 0           !< [length]
    real(DP) :: flat(2, MAX_FACE_NODES) = 0        !< positions of the nodes in the plane [length]
    real(DP) :: height(MAX_FACE_NODES) = 0         !< of the nodes above it [length]
    real(DP) :: axes(3, 2) = 0                     !< of the plane; the second is unused for a line
    real(DP) :: d_flat(MAX_CUT_COORDINATES, 2, MAX_FACE_NODES) = 0     !< of the nodal positions [-]
    integer :: n_corners = 0
    real(DP) :: corners(2, 4) = 0                  !< counter-clockwise in the plane [length]
    integer :: node(4) = 0                         !< of each corner
  end type facet_outline_type

  !> A facet at an integration point, and how its natural coordinates follow from the position in the plane.
  type :: facet_point_type
    real(DP) :: shapes(MAX_FACE_NODES) = 0         !< N [-]
    real(DP) :: slopes(MAX_FACE_NODES, 2) = 0      !< dN/dxi [-]
    real(DP) :: inverse(2, 2) = 0                  !< dxi/dat [1/length]
    real(DP) :: height = 0                         !< above the plane [length]
  end type facet_point_type

  !> An integration point: both facets there, its weight, and the slopes of the weight's factor of the curved face.
  type :: segment_point_type
    type(facet_point_type) :: own, front           !< on the slave and on the master
    real(DP) :: basis(MAX_FACE_NODES) = 0          !< N~ of the slave [-]
    real(DP) :: basis_slopes(MAX_FACE_NODES, 2) = 0   !< dN~/dxi [-]
    real(DP) :: at(2) = 0                          !< in the plane [length]
    real(DP) :: flat_weight = 0                    !< in the plane [length^2]
    real(DP) :: factor = 1                         !< the weight over that in the plane [-]
    real(DP) :: by_xi(2) = 0                       !< slopes of the factor: by the natural coordinates on the slave [-]
    real(DP) :: by_normal(2) = 0                   !< by the rotation of the normal [-]
    real(DP) :: by_own(3, MAX_FACE_NODES) = 0      !< by the slave's nodes [1/length]
  end type segment_point_type

  !> The slopes of all integrals over an intersection with respect to what it consists of.
  type :: intersection_slopes_type
    real(DP), allocatable :: by_corner(:, :, :)    !< (integrals, 2, corners of the intersection)
    real(DP), allocatable :: by_normal(:, :)       !< (integrals, 2) rotation of the normal towards the axes
    real(DP), allocatable :: by_own(:, :, :)       !< (integrals, 3, nodes of the slave)
    real(DP), allocatable :: by_own_flat(:, :, :), by_front_flat(:, :, :)   !< (integrals, 2, nodes) positions in the plane
  end type intersection_slopes_type

  !> Sums over the integration points of a facet, with the basis functions e (N~ or 1, y), and their derivatives.
  type :: basis_integrals_type
    integer :: n = 0                               !< functions of the basis
    logical :: is_full = .true.  !< the basis is N~; else 1 and y, the position relative to the middle over the unit
    real(DP) :: middle(2) = 0, unit = 1            !< [length]
    real(DP), allocatable :: gram(:, :)            !< (n, n) integral of e e'
    real(DP), allocatable :: cross(:, :)           !< (n, n_nodes) integral of e N_i
    real(DP), allocatable :: d_gram(:, :, :)       !< (n, n, 3 n_nodes)
    real(DP), allocatable :: d_cross(:, :, :)      !< (n, n_nodes, 3 n_nodes)
  end type basis_integrals_type

contains

  !> The integrals over a slave facet and their derivatives. Cost: points of the integrals times coordinates times functions.
  subroutine differentiate_segmentation(slave, f, master, x, segmentation, derivatives)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f                       !< slave facet
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    type(segmentation_type), intent(in) :: segmentation          !< its segmentation there
    type(facet_derivatives_type), intent(out) :: derivatives
    type(facet_derivatives_type) :: other
    type(facet_outline_type) :: own
    real(DP) :: d_normal(MAX_CUT_COORDINATES, 2), d_area(MAX_CUT_COORDINATES), area, d_cover, part, slope
    integer :: i
    derivatives%is_made = .true.
    call collect_nodes(slave, f, master, segmentation%segments(:segmentation%n), derivatives)
    if (segmentation%n == 0) return
    if (sum(segmentation%points%weight(:segmentation%points%n)) <= 0.0_DP) return
    d_normal = differentiate_plane_normal(slave, f, x, segmentation%plane)
    call build_facet_outline(slave, f, x, segmentation%plane, d_normal, 0, .false., own)
    call differentiate_area(own, segmentation%plane, area, d_area)
    call find_full_dual_fraction(slave%kind(f), sum(segmentation%points%weight(:segmentation%points%n)) / area, part, slope)
    if (part < 1.0_DP) other = derivatives
    if (part < 1.0_DP) call differentiate_basis(own, master, x, segmentation, d_normal, sqrt(area), .false., other)
    if (part > 0.0_DP) call differentiate_basis(own, master, x, segmentation, d_normal, sqrt(area), .true., derivatives)
    if (part >= 1.0_DP) return
    if (part > 0.0_DP) then
      associate (covered => sum(derivatives%share))
        do i = 1, 3 * size(derivatives%nodes)
          d_cover = sum(derivatives%d_slave_integrals(:, i))
          if (i <= 3 * derivatives%n_slave) d_cover = d_cover - covered / area * d_area(i)
          other%d_master_integrals(:, :, i) = part * derivatives%d_master_integrals(:, :, &
            i) + (1 - part) * other%d_master_integrals(:, :, i) &
            + slope / area * d_cover * (derivatives%master_integrals - other%master_integrals)
        end do
      end associate
      other%master_integrals = part * derivatives%master_integrals + (1 - part) * other%master_integrals
    end if
    derivatives = other
  end subroutine differentiate_segmentation


  !> The area of a slave facet in its plane, times the depth of a line, with derivatives with respect to the coordinates of its
  !! nodes.
  pure subroutine differentiate_area(own, plane, area, d_area)
    type(facet_outline_type), intent(in) :: own
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(out) :: area                  !< [length^2]
    real(DP), intent(out) :: d_area(MAX_CUT_COORDINATES)          !< [length]
    real(DP) :: across(2), flat, depth
    integer :: k, before, next, i
    flat = signed_polygon_area(own%corners(:, :own%n_corners))
    depth = find_depth(plane, plane%origin)
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


  !> The integrals with the dual functions of one basis, N~ or the linear functions of the position.
  subroutine differentiate_basis(own, master, x, segmentation, d_normal, unit, is_full, derivatives)
    type(facet_outline_type), intent(in) :: own
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    type(segmentation_type), intent(in) :: segmentation
    real(DP), intent(in) :: d_normal(MAX_CUT_COORDINATES, 2)
    real(DP), intent(in) :: unit                   !< unit of the position [length]
    logical, intent(in) :: is_full
    type(facet_derivatives_type), intent(inout) :: derivatives
    type(basis_integrals_type) :: integrals
    integer :: k
    associate (w => segmentation%points%weight(:segmentation%points%n))
      integrals%middle = matmul(segmentation%points%at(:, :segmentation%points%n), w) / sum(w)
    end associate
    integrals%unit = unit
    integrals%is_full = is_full
    call initialize_integrals(merge(derivatives%n_slave, 3, is_full), size(derivatives%nodes), integrals)
    do k = 1, segmentation%n
      if (all(segmentation%points%weight(segmentation%segments(k)%first:segmentation%segments(k)%last) <= 0.0_DP)) cycle
      call add_segment_integrals(own, master, x, segmentation, k, d_normal, derivatives, integrals)
    end do
    call solve_dual_integrals(own, derivatives, integrals)
  end subroutine differentiate_basis


  !> The nodes on which the integrals depend.
  pure subroutine collect_nodes(slave, f, master, segments, derivatives)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: f
    type(mortar_segment_type), intent(in) :: segments(:)
    type(facet_derivatives_type), intent(inout) :: derivatives
    integer :: k, i, n, nodes(MAX_FACE_NODES)
    call facet_nodes(slave, f, derivatives%n_slave, nodes)
    derivatives%nodes = nodes(:derivatives%n_slave)
    do k = 1, size(segments)
      call facet_nodes(master, segments(k)%master, n, nodes)
      do i = 1, n
        if (all(derivatives%nodes /= nodes(i))) derivatives%nodes = [derivatives%nodes, nodes(i)]
      end do
    end do
    n = size(derivatives%nodes)
    allocate (derivatives%share(derivatives%n_slave), derivatives%master_integrals(derivatives%n_slave, n), source=0.0_DP)
    allocate (derivatives%d_slave_integrals(derivatives%n_slave, 3 * n), derivatives%d_master_integrals(derivatives%n_slave, n, &
      3 * n), source=0.0_DP)
  end subroutine collect_nodes


  !> Sums of a basis of n functions, initialized to zero.
  pure subroutine initialize_integrals(n, n_nodes, integrals)
    integer, intent(in) :: n, n_nodes
    type(basis_integrals_type), intent(inout) :: integrals
    integrals%n = n
    allocate (integrals%gram(n, n), integrals%cross(n, n_nodes), source=0.0_DP)
    allocate (integrals%d_gram(n, n, 3 * n_nodes), integrals%d_cross(n, n_nodes, 3 * n_nodes), source=0.0_DP)
  end subroutine initialize_integrals


  !> The rotation of the plane's normal towards its axes, per coordinate of the slave's nodes.
  pure function differentiate_plane_normal(slave, f, x, plane) result(d_normal)
    type(facets_type), intent(in) :: slave
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(projection_plane_type), intent(in) :: plane
    real(DP) :: d_normal(MAX_CUT_COORDINATES, 2), side(3, 2), sign_of(2, 4), unit(3), d_m(3), length
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
    d_normal = 0.0_DP
    if (length <= 0.0_DP) return
    do i = 1, shape%n_corners
      do a = 1, 3
        unit = 0.0_DP
        unit(a) = 1.0_DP
        d_m = sign_of(1, i) * cross_product(unit, side(:, 2)) + sign_of(2, i) * cross_product(side(:, 1), unit)
        d_normal(3 * (i - 1) + a, :) = matmul(d_m, plane%axes) / length
      end do
    end do
    if (is_line_facet(slave%kind(f))) d_normal(:, 2) = 0.0_DP
  end function differentiate_plane_normal


  !> Adds one intersection to all sums. The slopes with respect to the corners of the intersection, the nodes and the normal are
  !! summed over the points; the derivatives of these by the coordinates are the same for all points and come last.
  subroutine add_segment_integrals(own, master, x, segmentation, k, d_normal, derivatives, integrals)
    type(facet_outline_type), intent(in) :: own
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    type(segmentation_type), intent(in) :: segmentation
    integer, intent(in) :: k                       !< segment
    real(DP), intent(in) :: d_normal(MAX_CUT_COORDINATES, 2)
    type(facet_derivatives_type), intent(inout) :: derivatives
    type(basis_integrals_type), intent(inout) :: integrals
    type(facet_outline_type) :: front
    type(segment_point_type) :: point
    type(intersection_slopes_type) :: slopes
    real(DP) :: cut(2, MAX_POLYGON_CORNERS), d_cut(MAX_CUT_COORDINATES, 2, MAX_POLYGON_CORNERS), at(2, MAX_CUT_POINTS), &
      weight(MAX_CUT_POINTS), barycentric(2, MAX_CUT_POINTS)
    real(DP), allocatable :: values(:)             ! (integrals)
    integer :: lines(MAX_POLYGON_CORNERS), corner(MAX_CUT_POINTS), n, q, n_points, nd, n_own, n_front
    associate (g => segmentation%segments(k)%master, first => segmentation%segments(k)%first, plane => segmentation%plane)
      call build_facet_outline(master, g, x, plane, d_normal, own%n, .true., front)
      n_own = own%n
      n_front = front%n
      nd = 3 * (n_own + n_front)
      call clip_polygon(own%corners(:, :own%n_corners), front%corners(:, :front%n_corners), cut, n, lines)
      call differentiate_corners(own, front, nd, lines, n, cut, d_cut)
      call set_polygon_quadrature(cut(:, :n), is_line_facet(own%kind), max(choose_quadrature_order(own%kind, own%corners), &
        choose_quadrature_order(front%kind, front%corners)), n_points, at, weight, corner, barycentric)
      q = (integrals%n * (integrals%n + 1)) / 2 + integrals%n * n_front + n_own
      allocate (values(q), slopes%by_corner(q, 2, n), slopes%by_normal(q, 2), slopes%by_own(q, 3, n_own), &
        slopes%by_own_flat(q, 2, n_own), slopes%by_front_flat(q, 2, n_front), source=0.0_DP)
      do q = 1, n_points
        point%at = at(:, q)
        point%flat_weight = weight(q)
        call place_point(own, front, plane, segmentation%points%xi(:, first + q - 1), segmentation%points%eta(:, first + q - 1), &
          point)
        call add_point_slopes(point, [1, corner(q), corner(q) + 1], cut, barycentric(:, q), integrals, values, slopes)
      end do
      call scatter_integrals(own, front, master, g, values, assemble_derivatives(own, front, d_cut(:nd, :, :n), d_normal(:nd, :), &
        slopes), derivatives, integrals)
    end associate
  end subroutine add_segment_integrals


  !> Adds the integrands at a point, and their slopes.
  pure subroutine add_point_slopes(point, triangle, cut, barycentric, integrals, values, slopes)
    type(segment_point_type), intent(in) :: point
    integer, intent(in) :: triangle(3)             !< corners of the intersection around the point
    real(DP), intent(in) :: cut(2, MAX_POLYGON_CORNERS), barycentric(2)   !< their positions; the point's at the last two [-]
    type(basis_integrals_type), intent(in) :: integrals
    real(DP), intent(inout) :: values(:)           !< (integrals)
    type(intersection_slopes_type), intent(inout) :: slopes
    real(DP), dimension(MAX_INTEGRALS, 2) :: by_xi, by_eta, by_at, own, front
    real(DP) :: integrand(MAX_INTEGRALS), a(2), b(2), share, part(3), by_weight(2, 3)
    integer :: c, i, first, last, n
    call evaluate_integrands(point, size(slopes%by_own, 3), size(slopes%by_front_flat, 3), integrals, integrand, by_xi, by_eta, &
      by_at)
    n = size(values)
    values = values + point%flat_weight * point%factor * integrand(:n)
    first = (integrals%n * (integrals%n + 1)) / 2 + 1          ! only e_j N_i depend on the master
    last = n - size(slopes%by_own, 3)
    do c = 1, 2
      by_xi(:n, c) = by_xi(:n, c) + point%flat_weight * point%by_xi(c) * integrand(:n)
    end do
    do c = 1, 2
      own(:n, c) = point%own%inverse(1, c) * by_xi(:n, 1) + point%own%inverse(2, c) * by_xi(:n, 2)
      front(first:last, c) = point%front%inverse(1, c) * by_eta(first:last, 1) + point%front%inverse(2, c) * by_eta(first:last, 2)
      by_at(:n, c) = by_at(:n, c) + own(:n, c)
      by_at(first:last, c) = by_at(first:last, c) + front(first:last, c)
      slopes%by_normal(:, c) = slopes%by_normal(:, c) + point%own%height * own(:n, c) &
        + point%flat_weight * point%by_normal(c) * integrand(:n)
      slopes%by_normal(first:last, c) = slopes%by_normal(first:last, c) + point%front%height * front(first:last, c)
      do i = 1, size(slopes%by_own, 3)
        slopes%by_own_flat(:, c, i) = slopes%by_own_flat(:, c, i) - point%own%shapes(i) * own(:n, c)
      end do
      do i = 1, size(slopes%by_front_flat, 3)
        slopes%by_front_flat(first:last, c, i) = slopes%by_front_flat(first:last, c, i) &
          - point%front%shapes(i) * front(first:last, c)
      end do
    end do
    do i = 1, size(slopes%by_own, 3)
      do c = 1, 3
        slopes%by_own(:, c, i) = slopes%by_own(:, c, i) + point%flat_weight * point%by_own(c, i) * integrand(:n)
      end do
    end do
    a = cut(:, triangle(2)) - cut(:, 1)
    b = cut(:, triangle(3)) - cut(:, 1)
    share = point%flat_weight * point%factor / (a(1) * b(2) - a(2) * b(1))   ! of twice the area of the triangle
    part = [1 - sum(barycentric), barycentric]
    by_weight = share * reshape([a(2) - b(2), b(1) - a(1), b(2), -b(1), -a(2), a(1)], [2, 3])
    do i = 1, 3
      do c = 1, 2
        slopes%by_corner(:, c, triangle(i)) = slopes%by_corner(:, c, triangle(i)) + part(i) * by_at(:n, c) &
          + by_weight(c, i) * integrand(:n)
      end do
    end do
  end subroutine add_point_slopes


  !> All integrands at a point, and the slopes of the weighted ones: e_j e_l for j up to l, then e_j N_i, then N~_j.
  pure subroutine evaluate_integrands(point, n_own, n_front, integrals, integrand, by_xi, by_eta, by_at)
    type(segment_point_type), intent(in) :: point
    integer, intent(in) :: n_own, n_front
    type(basis_integrals_type), intent(in) :: integrals
    real(DP), intent(out) :: integrand(MAX_INTEGRALS)
    real(DP), dimension(MAX_INTEGRALS, 2), intent(out) :: by_xi, by_eta, by_at   !< by_eta: of e_j N_i alone
    real(DP) :: basis(MAX_FACE_NODES), e_xi(MAX_FACE_NODES, 2), e_at(MAX_FACE_NODES, 2), weight
    integer :: c, k, m, n
    m = integrals%n
    weight = point%flat_weight * point%factor
    e_at = 0.0_DP
    if (integrals%is_full) then
      basis = point%basis
      e_xi = weight * point%basis_slopes
    else
      basis(:3) = [1.0_DP, (point%at - integrals%middle) / integrals%unit]
      e_xi = 0.0_DP
      e_at(2, 1) = weight / integrals%unit
      e_at(3, 2) = weight / integrals%unit
    end if
    n = 0
    do k = 1, m
      integrand(n + 1:n + k) = basis(k) * basis(:k)
      do c = 1, 2
        by_xi(n + 1:n + k, c) = basis(k) * e_xi(:k, c) + e_xi(k, c) * basis(:k)
        by_at(n + 1:n + k, c) = basis(k) * e_at(:k, c) + e_at(k, c) * basis(:k)
      end do
      n = n + k
    end do
    do k = 1, n_front
      integrand(n + 1:n + m) = point%front%shapes(k) * basis(:m)
      do c = 1, 2
        by_xi(n + 1:n + m, c) = point%front%shapes(k) * e_xi(:m, c)
        by_at(n + 1:n + m, c) = point%front%shapes(k) * e_at(:m, c)
        by_eta(n + 1:n + m, c) = weight * point%front%slopes(k, c) * basis(:m)
      end do
      n = n + m
    end do
    integrand(n + 1:n + n_own) = point%basis(:n_own)
    by_xi(n + 1:n + n_own, :) = weight * point%basis_slopes(:n_own, :)
    by_at(n + 1:n + n_own, :) = 0.0_DP
  end subroutine evaluate_integrands


  !> The derivatives of all integrals by the coordinates.
  pure function assemble_derivatives(own, front, d_cut, d_normal, slopes) result(d_values)
    type(facet_outline_type), intent(in) :: own, front
    real(DP), intent(in) :: d_cut(:, :, :), d_normal(:, :)     !< (coordinates, 2, corners), (coordinates, 2)
    type(intersection_slopes_type), intent(in) :: slopes
    real(DP) :: d_values(size(slopes%by_normal, 1), size(d_cut, 1))
    integer :: c, i, j
    d_values = matmul(slopes%by_normal, transpose(d_normal))
    do i = 1, size(d_cut, 3)
      do c = 1, 2
        do j = 1, size(d_cut, 1)
          d_values(:, j) = d_values(:, j) + d_cut(j, c, i) * slopes%by_corner(:, c, i)
        end do
      end do
    end do
    do i = 1, own%n
      j = 3 * (own%first + i - 1)
      d_values(:, j + 1:j + 3) = d_values(:, j + 1:j + 3) + slopes%by_own(:, :, i) &
        + matmul(slopes%by_own_flat(:, :, i), transpose(own%axes))
    end do
    do i = 1, front%n
      j = 3 * (front%first + i - 1)
      d_values(:, j + 1:j + 3) = d_values(:, j + 1:j + 3) + matmul(slopes%by_front_flat(:, :, i), transpose(front%axes))
    end do
  end function assemble_derivatives


  !> Adds the integrals over one intersection and their derivatives to the sums.
  pure subroutine scatter_integrals(own, master_outline, master, g, values, d_values, derivatives, integrals)
    type(facet_outline_type), intent(in) :: own, master_outline
    type(facets_type), intent(in) :: master
    integer, intent(in) :: g                       !< master facet
    real(DP), intent(in) :: values(:)              !< (n_integrals)
    real(DP), intent(in) :: d_values(:, :)         !< (n_integrals, coordinates)
    type(facet_derivatives_type), intent(inout) :: derivatives
    type(basis_integrals_type), intent(inout) :: integrals
    integer :: map(2 * MAX_FACE_NODES), nodes(MAX_FACE_NODES), at(MAX_CUT_COORDINATES), i, j, k, n
    call facet_nodes(master, g, n, nodes)
    map(:own%n) = [(i, i=1, own%n)]
    map(own%n + 1:own%n + n) = [(findloc(derivatives%nodes, nodes(i), dim=1), i=1, n)]
    do i = 1, size(d_values, 2)
      at(i) = 3 * (map((i + 2) / 3) - 1) + modulo(i - 1, 3) + 1
    end do
    n = 0
    do k = 1, integrals%n
      do j = 1, k
        n = n + 1
        call add_to(integrals%gram(j, k), integrals%d_gram(j, k, :))
        if (j < k) call add_to(integrals%gram(k, j), integrals%d_gram(k, j, :))
      end do
    end do
    do k = 1, master_outline%n
      do j = 1, integrals%n
        n = n + 1
        call add_to(integrals%cross(j, map(own%n + k)), integrals%d_cross(j, map(own%n + k), :))
      end do
    end do
    do j = 1, own%n
      n = n + 1
      call add_to(derivatives%share(j), derivatives%d_slave_integrals(j, :))
    end do

  contains

    !> The integral n and its derivatives.
    pure subroutine add_to(value, d_value)
      real(DP), intent(inout) :: value, d_value(:)
      integer :: c
      value = value + values(n)
      do c = 1, size(d_values, 2)
        d_value(at(c)) = d_value(at(c)) + d_values(n, c)
      end do
    end subroutine add_to

  end subroutine scatter_integrals


  !> A facet in the projection plane; the master's corners run in the opposite sense.
  pure subroutine build_facet_outline(facets, f, x, plane, d_normal, first, is_front, outline)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: x(:, :)
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(in) :: d_normal(MAX_CUT_COORDINATES, 2)
    integer, intent(in) :: first
    logical, intent(in) :: is_front
    type(facet_outline_type), intent(out) :: outline
    integer :: i, a, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, outline%n, nodes)
    outline%kind = facets%kind(f)
    outline%first = first
    outline%axes = plane%axes
    if (is_line_facet(outline%kind)) outline%axes(:, 2) = 0.0_DP
    do i = 1, outline%n
      outline%x(:, i) = x(:, nodes(i))
      outline%flat(:, i) = project_on_plane(plane, outline%x(:, i))
      outline%height(i) = dot_product(plane%normal, outline%x(:, i) - plane%origin)
      outline%d_flat(:, :, i) = -outline%height(i) * d_normal
      do a = 1, 3
        associate (rate => outline%d_flat(3 * (first + i - 1) + a, :, i))
          rate = rate + outline%axes(a, :)
        end associate
      end do
    end do
    call project_facet_corners(plane, facets, f, x, outline%corners, outline%n_corners)
    outline%node = [1, 2, 3, 4]
    if (is_line_facet(outline%kind)) outline%node = [1, 2, 2, 1]
    if (.not. is_front) return
    associate (m => outline%n_corners)
      outline%corners(:, :m) = outline%corners(:, m:1:-1)
      outline%node(:m) = outline%node(m:1:-1)
    end associate
  end subroutine build_facet_outline


  !> The derivatives of the corners of the intersection: each is the crossing of two edges.
  pure subroutine differentiate_corners(own, master_outline, nd, lines, n, cut, d_cut)
    type(facet_outline_type), intent(in) :: own, master_outline
    integer, intent(in) :: nd                      !< coordinates
    integer, intent(in) :: lines(MAX_POLYGON_CORNERS), n
    real(DP), intent(in) :: cut(2, MAX_POLYGON_CORNERS)
    real(DP), intent(out) :: d_cut(MAX_CUT_COORDINATES, 2, MAX_POLYGON_CORNERS)
    real(DP) :: across(2, 2), displacement_rate(MAX_CUT_COORDINATES, 2), det
    integer :: k
    do k = 1, n
      call differentiate_line(own, master_outline, nd, lines(k), cut(:, k), across(:, 1), displacement_rate(:, 1))
      call differentiate_line(own, master_outline, nd, lines(modulo(k, n) + 1), cut(:, k), across(:, 2), displacement_rate(:, 2))
      det = across(1, 1) * across(2, 2) - across(2, 1) * across(1, 2)
      if (abs(det) > 1.0e-9_DP) then
        d_cut(:nd, 1, k) = (across(2, 2) * displacement_rate(:nd, 1) - across(2, 1) * displacement_rate(:nd, 2)) / det
        d_cut(:nd, 2, k) = (across(1, 1) * displacement_rate(:nd, 2) - across(1, 2) * displacement_rate(:nd, 1)) / det
      else                                         ! both edges on one line
        d_cut(:nd, 1, k) = across(1, 1) * displacement_rate(:nd, 1)
        d_cut(:nd, 2, k) = across(2, 1) * displacement_rate(:nd, 1)
      end if
    end do
  end subroutine differentiate_corners


  !> The direction normal to an edge, and the edge's derivative along it at a point of the edge.
  pure subroutine differentiate_line(own, master_outline, nd, line, at, across, displacement_rate)
    type(facet_outline_type), intent(in) :: own, master_outline
    integer, intent(in) :: nd, line
    real(DP), intent(in) :: at(2)                  !< [length]
    real(DP), intent(out) :: across(2)             !< unit vector
    real(DP), intent(out) :: displacement_rate(MAX_CUT_COORDINATES)           !< [-]
    integer :: a
    if (line <= own%n_corners) then
      call differentiate_edge(own, nd, modulo(line - 2, own%n_corners) + 1, line, at, across, displacement_rate)
    else
      a = line - own%n_corners
      call differentiate_edge(master_outline, nd, a, modulo(a, master_outline%n_corners) + 1, at, across, displacement_rate)
    end if
  end subroutine differentiate_line


  !> The same for the edge between two corners of an outline.
  pure subroutine differentiate_edge(outline, nd, a, b, at, across, displacement_rate)
    type(facet_outline_type), intent(in) :: outline
    integer, intent(in) :: nd, a, b                !< coordinates; corners
    real(DP), intent(in) :: at(2)                  !< [length]
    real(DP), intent(out) :: across(2), displacement_rate(MAX_CUT_COORDINATES)
    real(DP) :: edge(2), part
    edge = outline%corners(:, b) - outline%corners(:, a)
    part = dot_product(edge, at - outline%corners(:, a)) / max(dot_product(edge, edge), tiny(1.0_DP))
    across = [edge(2), -edge(1)] / max(norm2(edge), tiny(1.0_DP))
    displacement_rate = 0.0_DP
    associate (d_a => outline%d_flat(:nd, :, outline%node(a)), d_b => outline%d_flat(:nd, :, outline%node(b)))
      displacement_rate(:nd) = across(1) * ((1 - part) * d_a(:, 1) + part * d_b(:, 1)) + across(2) * ((1 - part) * d_a(:, &
        2) + part * d_b(:, 2))
    end associate
  end subroutine differentiate_edge


  !> Both facets at a point, and the factor of its weight.
  pure subroutine place_point(own, front, plane, xi, eta, point)
    type(facet_outline_type), intent(in) :: own, front
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(in) :: xi(2), eta(2)          !< on the slave and on the master [-]
    type(segment_point_type), intent(inout) :: point
    real(DP) :: ddN(3, MAX_FACE_NODES)
    call place_on_facet(front, eta, point%front, ddN)
    call place_on_facet(own, xi, point%own, ddN)
    call differentiate_factor(own, plane, ddN, point)
    point%basis = point%own%shapes
    point%basis_slopes = point%own%slopes
    call transform_shape_functions(own%kind, point%basis)
    call transform_shape_functions(own%kind, point%basis_slopes(:, 1))
    call transform_shape_functions(own%kind, point%basis_slopes(:, 2))
  end subroutine place_point


  !> A facet at natural coordinates: J d_xi = d_at - sum N_k d_flat_k.
  pure subroutine place_on_facet(outline, xi, point, ddN)
    type(facet_outline_type), intent(in) :: outline
    real(DP), intent(in) :: xi(2)                  !< [-]
    type(facet_point_type), intent(out) :: point
    real(DP), intent(out) :: ddN(3, MAX_FACE_NODES)
    real(DP) :: dN(2, MAX_FACE_NODES), J(2, 2), det
    integer :: i
    call facet_shapes(outline%kind, xi, point%shapes, dN, ddN)
    point%slopes = transpose(dN)
    point%height = dot_product(outline%height(:outline%n), point%shapes(:outline%n))
    J = 0.0_DP
    do i = 1, outline%n
      J(:, 1) = J(:, 1) + outline%flat(:, i) * dN(1, i)
      J(:, 2) = J(:, 2) + outline%flat(:, i) * dN(2, i)
    end do
    if (is_line_facet(outline%kind)) J = reshape([J(1, 1), 0.0_DP, 0.0_DP, 1.0_DP], [2, 2])
    det = J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)
    if (abs(det) <= tiny(1.0_DP)) then
      point%slopes = 0.0_DP
      return
    end if
    point%inverse = reshape([J(2, 2), -J(2, 1), -J(1, 2), J(1, 1)], [2, 2]) / det
    if (is_line_facet(outline%kind)) point%inverse(2, :) = 0.0_DP
  end subroutine place_on_facet


  !> The ratio of the slave's face area to that in the plane, times the depth of a line, as in the segmentation, and its slopes.
  pure subroutine differentiate_factor(own, plane, ddN, point)
    type(facet_outline_type), intent(in) :: own
    type(projection_plane_type), intent(in) :: plane
    real(DP), intent(in) :: ddN(3, MAX_FACE_NODES) !< on the slave
    type(segment_point_type), intent(inout) :: point
    real(DP) :: t(3, 2), second(3, 3), normal(3), by_normal(3), by_t(3, 2), along, length, depth
    integer :: k
    associate (m => own%n, N => point%own%shapes(:own%n), dN => point%own%slopes(:own%n, :))
      t = 0.0_DP
      second = 0.0_DP
      do k = 1, m
        t(:, 1) = t(:, 1) + dN(k, 1) * own%x(:, k)
        t(:, 2) = t(:, 2) + dN(k, 2) * own%x(:, k)
        second(:, 1) = second(:, 1) + ddN(1, k) * own%x(:, k)
        second(:, 2) = second(:, 2) + ddN(2, k) * own%x(:, k)
        second(:, 3) = second(:, 3) + ddN(3, k) * own%x(:, k)
      end do
      if (is_line_facet(own%kind)) t(:, 2) = [0.0_DP, 0.0_DP, 1.0_DP]
      normal = cross_product(t(:, 1), t(:, 2))
      length = norm2(normal)
      along = max(dot_product(normal, plane%normal), 0.1_DP * length)
      depth = find_depth(plane, [dot_product(own%x(1, :m), N), 0.0_DP, 0.0_DP])
      point%factor = length / along * depth
      by_normal = normal / (length * along) - length / along**2 * plane%normal     ! of length/along
      point%by_normal = -depth * length / along**2 * [dot_product(normal, plane%axes(:, 1)), dot_product(normal, plane%axes(:, 2))]
      if (along <= 0.1_DP * length) then
        by_normal = 0.0_DP
        point%by_normal = 0.0_DP
      end if
      by_t(:, 1) = depth * cross_product(t(:, 2), by_normal)
      by_t(:, 2) = depth * cross_product(by_normal, t(:, 1))
      if (is_line_facet(own%kind)) by_t(:, 2) = 0.0_DP
      point%by_xi = [dot_product(by_t(:, 1), second(:, 1)) + dot_product(by_t(:, 2), second(:, 3)), &
        dot_product(by_t(:, 1), second(:, 3)) + dot_product(by_t(:, 2), second(:, 2))]
      do k = 1, m
        point%by_own(:, k) = dN(k, 1) * by_t(:, 1) + dN(k, 2) * by_t(:, 2)
      end do
      if (plane%depth >= 0.0_DP) return
      point%by_xi = point%by_xi + 2 * PI * length / along * matmul(own%x(1, :m), dN)
      point%by_own(1, :m) = point%by_own(1, :m) + 2 * PI * length / along * N
    end associate
  end subroutine differentiate_factor


  !> M_ji = d_j l_j' inv(G) C_i with l_j the unit vectors (the basis N~) or (1, y_j).
  subroutine solve_dual_integrals(own, derivatives, integrals)
    type(facet_outline_type), intent(in) :: own
    type(facet_derivatives_type), intent(inout) :: derivatives
    type(basis_integrals_type), intent(in) :: integrals
    real(DP), allocatable :: head(:, :), solved(:, :), by_share(:, :), inverse(:, :), unit(:, :)
    real(DP) :: rest(integrals%n, size(derivatives%nodes)), displacement_rate(derivatives%n_slave, size(derivatives%nodes))
    real(DP) :: flat(2, derivatives%n_slave), d_flat(2, derivatives%n_slave)
    integer :: i, j, k, m, n, status
    n = derivatives%n_slave
    m = integrals%n
    allocate (head(n, m), unit(m, m), inverse(m, m), source=0.0_DP)
    do i = 1, m
      unit(i, i) = 1.0_DP
    end do
    call invert_small(integrals%gram, inverse, status)
    if (status /= DENSE_OK) then                   ! degenerate narrow part: constants, as in amontons_dual_shape_functions
      call solve_constant_dual(derivatives, integrals)
      return
    end if
    if (integrals%is_full) head = unit
    if (.not. integrals%is_full) then
      flat = own%flat(:, :n)
      call transform_nodal_positions(own%kind, flat)
      head(:, 1) = 1.0_DP
      head(:, 2:) = (transpose(flat) - spread(integrals%middle, 1, n)) / integrals%unit
    end if
    solved = matmul(inverse, integrals%cross)
    by_share = matmul(head, solved)
    head = matmul(head, inverse)
    derivatives%master_integrals = spread(derivatives%share, 2, size(derivatives%nodes)) * by_share
    do i = 1, 3 * size(derivatives%nodes)
      rest = integrals%d_cross(:, :, i)
      do k = 1, m
        do j = 1, m
          rest(j, :) = rest(j, :) - integrals%d_gram(j, k, i) * solved(k, :)
        end do
      end do
      displacement_rate = matmul(head, rest)
      if (.not. integrals%is_full .and. i <= 3 * n) then
        d_flat = own%d_flat(i, :, :n)
        call transform_nodal_positions(own%kind, d_flat)
        displacement_rate = displacement_rate + matmul(transpose(d_flat) / integrals%unit, solved(2:, :))
      end if
      do k = 1, size(derivatives%nodes)
        derivatives%d_master_integrals(:, k, i) = derivatives%d_slave_integrals(:, i) * by_share(:, &
          k) + derivatives%share * displacement_rate(:, k)
      end do
    end do
  end subroutine solve_dual_integrals


  !> phi_j = d_j/(sum of all): M_ji = d_j C_i/G with the constant alone.
  pure subroutine solve_constant_dual(derivatives, integrals)
    type(facet_derivatives_type), intent(inout) :: derivatives
    type(basis_integrals_type), intent(in) :: integrals
    integer :: i, j
    if (integrals%is_full) return
    do i = 1, size(derivatives%nodes)
      derivatives%master_integrals(:, i) = derivatives%share * integrals%cross(1, i) / integrals%gram(1, 1)
      do j = 1, 3 * size(derivatives%nodes)
        derivatives%d_master_integrals(:, i, j) = (derivatives%d_slave_integrals(:, j) * integrals%cross(1, &
          i) + derivatives%share * (integrals%d_cross(1, i, j) &
          - integrals%cross(1, i) * integrals%d_gram(1, 1, j) / integrals%gram(1, 1))) / integrals%gram(1, 1)
      end do
    end do
  end subroutine solve_constant_dual

end module amontons_segment_derivatives
