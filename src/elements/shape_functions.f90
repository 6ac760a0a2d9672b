!> Shape functions, quadrature rules and extrapolation matrices of elements and facets.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Natural coordinates: hexahedra -1..1 in xi, eta, zeta; tetrahedra 0..1 with node 1 at the origin; wedges 0..1 in the
!! triangle (xi, eta), -1..1 along zeta; plane quadrilaterals and triangles as their facets, trusses -1..1 in xi, the rest
!! zero. Integration points are ordered as CalculiX prints them: xi fastest, then eta, then zeta.
module amontons_shape_functions
  use amontons_kinds, only: DP
  use amontons_beam_rules, only: set_beam_rule, extrapolate_beam, extrapolate_beam_trilinearly, GAUSS_2, GAUSS_3
  use amontons_element_kinds, only: element_kind, element_kind_type, opposite_node, KIND_C3D4, KIND_C3D6, KIND_C3D8, &
    KIND_C3D8_FULL, KIND_C3D8I, KIND_COH2D4, KIND_COH3D6, KIND_COH3D8, KIND_C3D8R, KIND_CSS8, KIND_CSS6, KIND_C3D10, KIND_C3D15, &
    KIND_C3D15_LAYER, KIND_C3D20, KIND_C3D20R, KIND_CPS3, KIND_CPS4R, KIND_CPE3, KIND_CPE4R, KIND_CAX3, KIND_CAX4R, &
    KIND_CAX_SHELL, KIND_T3D3, KIND_BEAM_RECT, KIND_BEAM_PIPE, KIND_BEAM_BOX, KIND_BEAM_KRONROD, FACET_TRI3, FACET_QUAD4, &
    FACET_TRI6, FACET_QUAD8, FACET_LINE2, FACET_LINE3, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, MAX_FACE_NODES
  use amontons_tensor, only: solve_normal_equations
  implicit none
  private
  public :: shape_functions, quadrature, spread_body_force, node_coordinates, extrapolation_matrix, choose_face_rule, &
    facet_shapes, facet_quadrature, facet_node_coordinates, MAX_FACET_POINTS

  integer, parameter :: RULE_TRI1 = 7, RULE_QUAD1 = 8, RULE_LINE1 = 9   !< rules of one point, beside those of the facet kinds
  real(DP), parameter :: SIMPSON(5) = [real(DP) :: 1, 4, 2, 4, 1] / 6   !< five heights of shells, with points on both faces
  integer, parameter :: MAX_FACET_POINTS = 9       !< most integration points of a facet

  ! Corners of the hexahedron, then the middles of its edges, as signs.
  real(DP), parameter :: HEXAHEDRON_NODES(3, 20) = reshape([real(DP) :: &
    -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1, &
    0, -1, -1, 1, 0, -1, 0, 1, -1, -1, 0, -1, 0, -1, 1, 1, 0, 1, 0, 1, 1, -1, 0, 1, &
    -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], [3, 20])
  real(DP), parameter :: TETRAHEDRON_NODES(3, 10) = reshape([real(DP) :: 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, &
    0.5_DP, 0, 0, 0.5_DP, 0.5_DP, 0, 0, 0.5_DP, 0, 0, 0, 0.5_DP, 0.5_DP, 0, 0.5_DP, 0, 0.5_DP, 0.5_DP], [3, 10])
  real(DP), parameter :: WEDGE_NODES(3, 15) = reshape([real(DP) :: &
    0, 0, -1, 1, 0, -1, 0, 1, -1, 0, 0, 1, 1, 0, 1, 0, 1, 1, &
    0.5_DP, 0, -1, 0.5_DP, 0.5_DP, -1, 0, 0.5_DP, -1, 0.5_DP, 0, 1, 0.5_DP, 0.5_DP, 1, 0, 0.5_DP, 1, &
    0, 0, 0, 1, 0, 0, 0, 1, 0], [3, 15])
  real(DP), parameter :: QUAD_NODES(2, 8) = reshape([real(DP) :: &
    -1, -1, 1, -1, 1, 1, -1, 1, 0, -1, 1, 0, 0, 1, -1, 0], [2, 8])
  real(DP), parameter :: TRIANGLE_NODES(2, 6) = reshape([real(DP) :: &
    0, 0, 1, 0, 0, 1, 0.5_DP, 0, 0.5_DP, 0.5_DP, 0, 0.5_DP], [2, 6])

  ! The two corners of each mid-side node.
  integer, parameter :: TETRAHEDRON_EDGES(2, 5:10) = reshape([1, 2, 2, 3, 3, 1, 1, 4, 2, 4, 3, 4], [2, 6])
  integer, parameter :: WEDGE_EDGES(2, 7:15) = reshape([1, 2, 2, 3, 3, 1, 4, 5, 5, 6, 6, 4, 1, 4, 2, 5, 3, 6], [2, 9])

  ! Four points of a tetrahedron, degree 2. P. C. Hammer, A. H. Stroud, MTAC 10 (1956) 137-139.
  real(DP), parameter :: TETRA_A = (5 - sqrt(5.0_DP)) / 20, TETRA_B = (5 + 3 * sqrt(5.0_DP)) / 20
  ! Six points of a triangle, degree 4. G. R. Cowper, Gaussian quadrature formulas for triangles,
  ! Int. J. Numer. Meth. Engng 7 (1973) 405-408.
  real(DP), parameter :: COWPER_A = 0.44594849091596489_DP, COWPER_B = 0.09157621350977074_DP
  real(DP), parameter :: COWPER_WA = 0.11169079483900573_DP, COWPER_WB = 0.054975871827660934_DP

contains

  !> Shape functions of an element and their derivatives by the natural coordinates; entries past its nodes are zero.
  !! Reference: O. C. Zienkiewicz, R. L. Taylor, J. Z. Zhu, The finite element method, 7th ed., chapter 6.
  pure subroutine shape_functions(kind, xi, N, dN)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(in) :: xi(3)                  !< natural coordinates [-]
    real(DP), intent(out) :: N(MAX_ELEMENT_NODES)          !< values [-]
    real(DP), intent(out) :: dN(3, MAX_ELEMENT_NODES)      !< derivatives by xi, eta, zeta [-]
    N = 0
    dN = 0
    select case (kind)
    case (KIND_C3D4)
      N(:4) = [1 - xi(1) - xi(2) - xi(3), xi(1), xi(2), xi(3)]
      dN(:, :4) = reshape([real(DP) :: -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 4])
    case (KIND_C3D6, KIND_CSS6)
      call wedge6_shapes(xi, N(:6), dN(:, :6))
    case (KIND_C3D15, KIND_C3D15_LAYER)
      call wedge15_shapes(xi, N(:15), dN(:, :15))
    case (KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, KIND_C3D8R, KIND_CSS8)
      call trilinear_shapes(xi, N(:8), dN(:, :8))
    case (KIND_C3D10)
      call tet10_shapes(xi, N(:10), dN(:, :10))
    case (KIND_C3D20, KIND_C3D20R, KIND_BEAM_RECT:KIND_BEAM_KRONROD)
      call hex20_shapes(xi, N, dN)
    case (KIND_CPS3:KIND_T3D3)
      call embedded_shapes(kind, xi, N, dN)
    case (KIND_COH2D4:KIND_COH3D8)
      call cohesive_shapes(kind, xi, N, dN)
    case default                                   ! unknown kind: nothing is set
    end select
  end subroutine shape_functions


  !> Plane kinds and trusses have the shapes of facets.
  pure subroutine embedded_shapes(kind, xi, N, dN)
    integer, intent(in) :: kind                    !< a plane kind or a truss
    real(DP), intent(in) :: xi(3)
    real(DP), intent(inout) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    real(DP) :: along(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    call facet_shapes(facet_shape_kind(kind), xi(:2), N(:MAX_FACE_NODES), along, ddN)
    dN(:2, :MAX_FACE_NODES) = along
  end subroutine embedded_shapes


  !> Cohesive elements: the middle between the two faces.
  pure subroutine cohesive_shapes(kind, xi, N, dN)
    integer, intent(in) :: kind                    !< KIND_COH...
    real(DP), intent(in) :: xi(3)
    real(DP), intent(inout) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    real(DP) :: shape(MAX_FACE_NODES), along(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    type(element_kind_type) :: entry
    integer :: a, opposite
    entry = element_kind(kind)
    call facet_shapes(entry%face_kind(1), xi(:2), shape, along, ddN)
    do a = 1, entry%n_points
      opposite = opposite_node(kind, a)
      N([a, opposite]) = 0.5_DP * shape(a)
      dN(:2, a) = 0.5_DP * along(:, a)
      dN(:2, opposite) = 0.5_DP * along(:, a)
    end do
  end subroutine cohesive_shapes


  !> Cohesive elements: a point at each pair of nodes, with the share of the face that a node of it has.
  pure subroutine cohesive_rule(kind, n, xi, w)
    integer, intent(in) :: kind                    !< KIND_COH...
    integer, intent(out) :: n
    real(DP), intent(inout) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    n = entry%n_points
    call facet_node_coordinates(entry%face_kind(1), xi(:2, :MAX_FACE_NODES))
    w(:n) = merge(1.0_DP / 6, 1.0_DP, kind == KIND_COH3D6)
  end subroutine cohesive_rule


  !> The facet kind that has the shape of a plane kind or of a truss.
  pure function facet_shape_kind(kind) result(facet)
    integer, intent(in) :: kind                    !< a plane kind or a truss
    integer :: facet
    type(element_kind_type) :: entry
    integer, parameter :: OF_NODES(2:8) = [FACET_LINE2, FACET_TRI3, FACET_QUAD4, 0, FACET_TRI6, 0, FACET_QUAD8]
    entry = element_kind(kind)
    facet = merge(FACET_LINE3, OF_NODES(entry%n_nodes), kind == KIND_T3D3)
  end function facet_shape_kind


  !> N = 1/8 (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta).
  pure subroutine trilinear_shapes(xi, N, dN)
    real(DP), intent(in) :: xi(3)
    real(DP), intent(out) :: N(8), dN(3, 8)
    real(DP) :: x, y, z
    integer :: a
    do a = 1, 8
      x = 1 + HEXAHEDRON_NODES(1, a) * xi(1)
      y = 1 + HEXAHEDRON_NODES(2, a) * xi(2)
      z = 1 + HEXAHEDRON_NODES(3, a) * xi(3)
      N(a) = 0.125_DP * x * y * z
      dN(1, a) = 0.125_DP * HEXAHEDRON_NODES(1, a) * y * z
      dN(2, a) = 0.125_DP * HEXAHEDRON_NODES(2, a) * x * z
      dN(3, a) = 0.125_DP * HEXAHEDRON_NODES(3, a) * x * y
    end do
  end subroutine trilinear_shapes


  !> Corners: the trilinear function times (xi_a xi + eta_a eta + zeta_a zeta - 2); mid-sides: a parabola on the edge.
  pure subroutine hex20_shapes(xi, N, dN)
    real(DP), intent(in) :: xi(3)
    real(DP), intent(out) :: N(20), dN(3, 20)
    real(DP) :: s(3), f(3), df(3), t
    integer :: a
    do a = 1, 8
      s = HEXAHEDRON_NODES(:, a)
      f = 1 + s * xi
      t = f(1) + f(2) + f(3) - 5
      N(a) = 0.125_DP * f(1) * f(2) * f(3) * t
      dN(1, a) = 0.125_DP * s(1) * f(2) * f(3) * (t + f(1))
      dN(2, a) = 0.125_DP * s(2) * f(1) * f(3) * (t + f(2))
      dN(3, a) = 0.125_DP * s(3) * f(1) * f(2) * (t + f(3))
    end do
    do a = 9, 20
      s = HEXAHEDRON_NODES(:, a)
      f = merge(1 - xi**2, 1 + s * xi, abs(s) < 0.5_DP)
      df = merge(-2 * xi, s, abs(s) < 0.5_DP)
      N(a) = 0.25_DP * f(1) * f(2) * f(3)
      dN(1, a) = 0.25_DP * df(1) * f(2) * f(3)
      dN(2, a) = 0.25_DP * f(1) * df(2) * f(3)
      dN(3, a) = 0.25_DP * f(1) * f(2) * df(3)
    end do
  end subroutine hex20_shapes


  !> Area coordinate of the triangle times 1/2 (1 + zeta_a zeta).
  pure subroutine wedge6_shapes(xi, N, dN)
    real(DP), intent(in) :: xi(3)
    real(DP), intent(out) :: N(6), dN(3, 6)
    real(DP), parameter :: BARYCENTRIC_GRADIENT(2, 3) = reshape([real(DP) :: -1, -1, 1, 0, 0, 1], [2, 3])
    real(DP) :: area(3), z
    integer :: a, corner
    area = [1 - xi(1) - xi(2), xi(1), xi(2)]
    do a = 1, 6
      corner = 1 + mod(a - 1, 3)
      z = WEDGE_NODES(3, a)
      N(a) = 0.5_DP * area(corner) * (1 + z * xi(3))
      dN(:2, a) = 0.5_DP * BARYCENTRIC_GRADIENT(:, corner) * (1 + z * xi(3))
      dN(3, a) = 0.5_DP * area(corner) * z
    end do
  end subroutine wedge6_shapes


  !> Corners: 1/2 L (1 + z_a z)(2 L - 2 + z_a z); mid-sides of the triangles: 2 L_i L_j (1 + z_a z); between them:
  !! L (1 - z^2); with the area coordinates L and z = zeta.
  pure subroutine wedge15_shapes(xi, N, dN)
    real(DP), intent(in) :: xi(3)
    real(DP), intent(out) :: N(15), dN(3, 15)
    real(DP), parameter :: BARYCENTRIC_GRADIENT(2, 3) = reshape([real(DP) :: -1, -1, 1, 0, 0, 1], [2, 3])
    real(DP) :: area(3), z, s
    integer :: a, i, j
    area = [1 - xi(1) - xi(2), xi(1), xi(2)]
    z = xi(3)
    do a = 1, 6
      i = 1 + mod(a - 1, 3)
      s = WEDGE_NODES(3, a)
      N(a) = 0.5_DP * area(i) * (1 + s * z) * (2 * area(i) - 2 + s * z)
      dN(:2, a) = 0.5_DP * BARYCENTRIC_GRADIENT(:, i) * (1 + s * z) * (4 * area(i) - 2 + s * z)
      dN(3, a) = 0.5_DP * area(i) * s * (2 * area(i) - 1 + 2 * s * z)
    end do
    do a = 7, 12
      i = 1 + mod(WEDGE_EDGES(1, a) - 1, 3)
      j = 1 + mod(WEDGE_EDGES(2, a) - 1, 3)
      s = WEDGE_NODES(3, a)
      N(a) = 2 * area(i) * area(j) * (1 + s * z)
      dN(:2, a) = 2 * (BARYCENTRIC_GRADIENT(:, i) * area(j) + area(i) * BARYCENTRIC_GRADIENT(:, j)) * (1 + s * z)
      dN(3, a) = 2 * area(i) * area(j) * s
    end do
    do a = 13, 15
      i = a - 12
      N(a) = area(i) * (1 - z * z)
      dN(:2, a) = BARYCENTRIC_GRADIENT(:, i) * (1 - z * z)
      dN(3, a) = -2 * area(i) * z
    end do
  end subroutine wedge15_shapes


  !> Corners: L (2 L - 1); mid-sides: 4 L_i L_j, with the volume coordinates L.
  pure subroutine tet10_shapes(xi, N, dN)
    real(DP), intent(in) :: xi(3)
    real(DP), intent(out) :: N(10), dN(3, 10)
    real(DP), parameter :: BARYCENTRIC_GRADIENT(3, 4) = reshape([real(DP) :: -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 4])
    real(DP) :: volume(4)
    integer :: a, i, j
    volume = [1 - xi(1) - xi(2) - xi(3), xi(1), xi(2), xi(3)]
    do a = 1, 4
      N(a) = volume(a) * (2 * volume(a) - 1)
      dN(:, a) = BARYCENTRIC_GRADIENT(:, a) * (4 * volume(a) - 1)
    end do
    do a = 5, 10
      i = TETRAHEDRON_EDGES(1, a)
      j = TETRAHEDRON_EDGES(2, a)
      N(a) = 4 * volume(i) * volume(j)
      dN(:, a) = 4 * (BARYCENTRIC_GRADIENT(:, i) * volume(j) + volume(i) * BARYCENTRIC_GRADIENT(:, j))
    end do
  end subroutine tet10_shapes


  !> Integration points and weights of an element. The weights add up to the volume of the parent element.
  !!
  !!   C3D4 1 point (degree 1), C3D6 2 points, C3D8, C3D8I and C3D20R 2x2x2 (degree 3 each way), C3D8R 1 point,
  !!   C3D10 4 points (degree 2), C3D15 3 points times 3 (degree 2 in the triangle, 5 along it),
  !!   C3D20 3x3x3 (degree 5 each way), CSS8 and CSS6 2x2 and 3 points at five heights; plane
  !!   kinds: triangles 1 or 3 points, quadrilaterals 1, 2x2 or 3x3, axisymmetric shells two at five heights; trusses 1 or 2;
  !!   beams: module beam_rules
  pure subroutine quadrature(kind, n, xi, w, walls)
    integer, intent(in) :: kind                    !< KIND_...
    integer, intent(out) :: n                      !< number of points
    real(DP), intent(out) :: xi(3, MAX_ELEMENT_POINTS)     !< natural coordinates [-], zero past n
    real(DP), intent(out) :: w(MAX_ELEMENT_POINTS)         !< weights [-], zero past n
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam; absent: all other elements [-]
    real(DP) :: flat(2, MAX_FACET_POINTS), weight(MAX_FACET_POINTS)
    integer :: n_flat
    xi = 0
    w = 0
    n = 0
    select case (kind)
    case (KIND_C3D4)
      n = 1
      xi(:, 1) = 0.25_DP
      w(1) = 1.0_DP / 6
    case (KIND_C3D10)
      n = 4
      xi(:, :4) = TETRA_A
      xi(1, 2) = TETRA_B
      xi(2, 3) = TETRA_B
      xi(3, 4) = TETRA_B
      w(:4) = 1.0_DP / 24
    case (KIND_C3D6)
      n = 2
      xi(:2, :2) = 1.0_DP / 3
      xi(3, :2) = [-GAUSS_2, GAUSS_2]
      w(:2) = 0.5_DP
    case (KIND_C3D15)
      n = 9
      call wedge_rule([-GAUSS_3, 0.0_DP, GAUSS_3], [5.0_DP, 8.0_DP, 5.0_DP] / 9, xi, w)
    case (KIND_C3D15_LAYER)
      n = 6
      call wedge_rule([-GAUSS_2, GAUSS_2], [1.0_DP, 1.0_DP], xi, w)
    case (KIND_C3D8R)
      n = 1
      w(1) = 8
    case (KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, KIND_C3D20R)
      n = 8
      call tensor_product_rule([-GAUSS_2, GAUSS_2], [1.0_DP, 1.0_DP], xi, w)
    case (KIND_C3D20)
      n = 27
      call tensor_product_rule([-GAUSS_3, 0.0_DP, GAUSS_3], [5.0_DP, 8.0_DP, 5.0_DP] / 9, xi, w)
    case (KIND_CSS8)
      n = 20
      call facet_quadrature(FACET_QUAD4, n_flat, flat, weight)
      call layered_rule(flat(:, :n_flat), weight(:n_flat), xi, w)
    case (KIND_CSS6)
      n = 15
      call set_triangle_orbit(1.0_DP / 6, 1.0_DP / 6, flat(:, :3), weight(:3))
      call layered_rule(flat(:, :3), weight(:3), xi, w)
    case (KIND_CPS3:KIND_T3D3)
      call embedded_rule(kind, n, xi, w)
    case (KIND_COH2D4:KIND_COH3D8)
      call cohesive_rule(kind, n, xi, w)
    case (KIND_BEAM_RECT:KIND_BEAM_KRONROD)
      call set_beam_rule(kind, walls_or_none(walls), n, xi, w)
    case default                                   ! unknown kind: nothing is set
    end select
  end subroutine quadrature


  !> Consistent nodal forces of a body force on an element whose points have these volumes. Adds to force.
  pure subroutine spread_body_force(kind, n_nodes, volumes, b, force)
    integer, intent(in) :: kind                    !< KIND_...
    integer, intent(in) :: n_nodes
    real(DP), intent(in) :: volumes(:)             !< of the points [length^3]
    real(DP), intent(in) :: b(3)                   !< force per reference volume [force/length^3]
    real(DP), intent(inout) :: force(:, :)         !< (3, nodes) [force]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    integer :: m, p, a
    call quadrature(kind, m, xi, w)
    do p = 1, m
      call shape_functions(kind, xi(:, p), N, dN)
      do a = 1, n_nodes
        force(:, a) = force(:, a) + (N(a) * volumes(p)) * b
      end do
    end do
  end subroutine spread_body_force


  !> The walls of a hollow beam; absent: a full section.
  pure function walls_or_none(walls) result(given)
    real(DP), intent(in), optional :: walls(4)
    real(DP) :: given(4)
    given = 0.5_DP
    if (present(walls)) given = walls
  end function walls_or_none


  !> The points of a face at five heights by Simpson's rule, which has points on both faces and gives the full plastic moment
  !! of a plate exactly.
  pure subroutine layered_rule(flat, weight, xi, w)
    real(DP), intent(in) :: flat(:, :)             !< (2, points) of the face
    real(DP), intent(in) :: weight(:)
    real(DP), intent(inout) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    integer :: k, m
    m = size(weight)
    do k = 1, 5
      xi(:2, m * (k - 1) + 1:m * k) = flat
      xi(3, m * (k - 1) + 1:m * k) = 0.5_DP * real(k - 3, DP)
      w(m * (k - 1) + 1:m * k) = SIMPSON(k) * weight
    end do
  end subroutine layered_rule


  !> Three points of the triangle at some heights.
  pure subroutine wedge_rule(z, weight_z, xi, w)
    real(DP), intent(in) :: z(:), weight_z(:)      !< heights and their weights
    real(DP), intent(inout) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    real(DP) :: flat(2, 3), weight(3)
    integer :: k
    call set_triangle_orbit(1.0_DP / 6, 1.0_DP / 6, flat, weight)
    do k = 1, size(z)
      xi(:2, 3 * k - 2:3 * k) = flat
      xi(3, 3 * k - 2:3 * k) = z(k)
      w(3 * k - 2:3 * k) = weight * weight_z(k)
    end do
  end subroutine wedge_rule


  !> The rules of plane kinds and trusses, by their number of points.
  pure subroutine embedded_rule(kind, n, xi, w)
    integer, intent(in) :: kind                    !< a plane kind or a truss
    integer, intent(out) :: n
    real(DP), intent(inout) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    type(element_kind_type) :: entry
    real(DP) :: flat(2, MAX_FACET_POINTS), weight(MAX_FACET_POINTS)
    integer :: k
    entry = element_kind(kind)
    n = entry%n_points
    if (kind == KIND_CAX_SHELL) then               ! two places along it at five heights
      xi(1, :n) = [(-GAUSS_2, GAUSS_2, k=1, 5)]
      xi(2, :n) = [(0.5_DP * real(k - 3, DP) * [1.0_DP, 1.0_DP], k=1, 5)]
      w(:n) = [(SIMPSON(k) * [1.0_DP, 1.0_DP], k=1, 5)]
      return
    end if
    flat = 0
    select case (facet_shape_kind(kind))
    case (FACET_LINE2, FACET_LINE3)
      weight(:n) = 2 / real(n, DP)
      if (n == 2) flat(1, :2) = [-GAUSS_2, GAUSS_2]
    case (FACET_TRI3)
      flat(:, 1) = 1.0_DP / 3
      weight(1) = 0.5_DP
    case (FACET_TRI6)
      call set_triangle_orbit(1.0_DP / 6, 1.0_DP / 6, flat(:, :3), weight(:3))
    case default
      weight(1) = 4
      if (n == 4) call facet_quadrature(FACET_QUAD4, n, flat, weight)
      if (n == 9) call facet_quadrature(FACET_QUAD8, n, flat, weight)
    end select
    xi(:2, :n) = flat(:, :n)
    w(:n) = weight(:n)
  end subroutine embedded_rule


  !> CalculiX's quadrature rule of an element face, a facet kind or RULE_...; it has fewer points than the default rule
  !! on wedges, on triangles, and on elements of reduced integration.
  pure integer function choose_face_rule(kind, facet, is_calculix) result(rule)
    integer, intent(in) :: kind                    !< KIND_... of the element
    integer, intent(in) :: facet                   !< FACET_... of the face
    logical, intent(in) :: is_calculix             !< .false.: the rule of the facet's own kind
    rule = facet
    if (.not. is_calculix) return
    select case (kind)
    case (KIND_C3D4)
      rule = RULE_TRI1
    case (KIND_C3D6)
      rule = merge(RULE_TRI1, RULE_QUAD1, facet == FACET_TRI3)
    case (KIND_C3D8R)
      rule = RULE_QUAD1
    case (KIND_C3D10)
      rule = FACET_TRI3
    case (KIND_C3D15, KIND_C3D15_LAYER)
      rule = merge(FACET_TRI3, FACET_QUAD4, facet == FACET_TRI6)
    case (KIND_C3D20R)
      rule = FACET_QUAD4
    case (KIND_CPS3, KIND_CPS4R, KIND_CPE3, KIND_CPE4R, KIND_CAX3, KIND_CAX4R)
      rule = RULE_LINE1
    end select
  end function choose_face_rule


  !> The product rule on the cube, xi fastest.
  pure subroutine tensor_product_rule(x, weight, xi, w)
    real(DP), intent(in) :: x(:)                   !< points on the line
    real(DP), intent(in) :: weight(:)              !< their weights
    real(DP), intent(inout) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    integer :: i, j, k, p
    p = 0
    do k = 1, size(x)
      do j = 1, size(x)
        do i = 1, size(x)
          p = p + 1
          xi(:, p) = [x(i), x(j), x(k)]
          w(p) = weight(i) * weight(j) * weight(k)
        end do
      end do
    end do
  end subroutine tensor_product_rule


  !> Natural coordinates of the nodes of an element.
  pure subroutine node_coordinates(kind, xi)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(out) :: xi(3, MAX_ELEMENT_NODES)      !< [-], zero past its nodes
    real(DP) :: flat(2, MAX_FACE_NODES), at(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    integer :: n, a
    xi = 0
    select case (kind)
    case (KIND_C3D4)
      xi(:, :4) = TETRAHEDRON_NODES(:, :4)
    case (KIND_C3D10)
      xi(:, :10) = TETRAHEDRON_NODES
    case (KIND_C3D6, KIND_CSS6)
      xi(:, :6) = WEDGE_NODES(:, :6)
    case (KIND_C3D15, KIND_C3D15_LAYER)
      xi(:, :15) = WEDGE_NODES
    case (KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, KIND_C3D8R, KIND_CSS8)
      xi(:, :8) = HEXAHEDRON_NODES(:, :8)
    case (KIND_C3D20, KIND_C3D20R, KIND_BEAM_RECT:KIND_BEAM_KRONROD)
      xi = HEXAHEDRON_NODES
    case (KIND_CPS3:KIND_T3D3)
      call facet_node_coordinates(facet_shape_kind(kind), flat)
      xi(:2, :MAX_FACE_NODES) = flat
    case (KIND_COH2D4:KIND_COH3D8)
      call cohesive_rule(kind, n, at, w)
      xi(:, [(a, opposite_node(kind, a), a=1, n)]) = at(:, [(a, a, a=1, n)])
    case default                                   ! unknown kind: nothing is set
    end select
  end subroutine node_coordinates


  !> Extrapolation matrix from the integration points to the nodes, as in CalculiX: nodes = matrix * points.
  !!
  !! | kind            | to the corners                                      | to the mid-side nodes |
  !! |-----------------|-----------------------------------------------------|-----------------------|
  !! | C3D4            | the one value                                       |                       |
  !! | C3D6            | linear through the 2 points                         |                       |
  !! | C3D8            | trilinear through the 8 points                      |                       |
  !! | C3D20R          | trilinear through the 8 points                      | mean of the 2 corners |
  !! | CSS8, CSS6      | bilinear or linear through the points of their face |                       |
  !! | C3D10           | linear through the 4 points                         | mean of the 2 corners |
  !! | C3D15           | linear through 3 points, linear fit over the heights | mean of the 2 corners |
  !! | C3D20           | least squares fit of the 20 shape functions to the 27 points            | the same    |
  !! | one point       | the one value                                       | the same              |
  !! | plane           | linear through 3 points, bilinear through 4 points  | mean of the 2 corners |
  !! | plane, 9 points | least squares fit of the 8 shape functions          | the same              |
  !! | plane shell     | linear through the 2 points of its height           | the same              |
  !! | T3D3            | linear through 2 points                             | mean of the 2 ends    |
  !! | cohesive        | the value of the point at the pair of nodes         |                       |
  !! | beams           | least squares fit, see `extrapolate_beam`           | the same              |
  !!
  !! With `is_calculix` beams are extrapolated by `extrapolate_beam_trilinearly`, C3D15 of a layer by `extrapolate_layer_wedge`.
  pure subroutine extrapolation_matrix(kind, matrix, n_nodes, n_points, walls, is_calculix)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(out) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)   !< [-], zero past n_nodes, n_points
    integer, intent(out) :: n_nodes, n_points
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam; absent: all other elements [-]
    logical, intent(in), optional :: is_calculix   !< as CalculiX does it; default .false.
    type(element_kind_type) :: entry
    integer :: a
    logical :: is_as_there
    is_as_there = .false.
    if (present(is_calculix)) is_as_there = is_calculix
    entry = element_kind(kind)
    n_nodes = entry%n_nodes
    n_points = entry%n_points
    matrix = 0
    select case (kind)
    case (KIND_C3D6)
      matrix(:6, 1) = 0.5_DP * (1 - WEDGE_NODES(3, :6) / GAUSS_2)
      matrix(:6, 2) = 0.5_DP * (1 + WEDGE_NODES(3, :6) / GAUSS_2)
    case (KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, KIND_C3D20R)
      call extrapolate_trilinear(n_nodes, matrix)
    case (KIND_CSS8, KIND_CSS6)
      call extrapolate_layers(n_nodes, n_points, matrix)
    case (KIND_C3D10)
      call extrapolate_tetrahedron(matrix)
    case (KIND_C3D15)
      call extrapolate_wedge([-GAUSS_3, 0.0_DP, GAUSS_3], matrix)
    case (KIND_C3D15_LAYER)
      if (is_as_there) then
        call extrapolate_layer_wedge(matrix)
      else
        call extrapolate_wedge([-GAUSS_2, GAUSS_2], matrix)
      end if
    case (KIND_C3D20)
      call extrapolate_serendipity(kind, n_nodes, n_points, matrix)
    case (KIND_CPS3:KIND_T3D3)
      call extrapolate_embedded(kind, n_nodes, n_points, matrix)
    case (KIND_COH2D4:KIND_COH3D8)
      do a = 1, n_points
        matrix([a, opposite_node(kind, a)], a) = 1
      end do
    case (KIND_BEAM_RECT:KIND_BEAM_KRONROD)
      if (is_as_there .and. any(kind == [KIND_BEAM_PIPE, KIND_BEAM_BOX, KIND_BEAM_KRONROD])) then
        call extrapolate_beam_trilinearly(kind, walls_or_none(walls), HEXAHEDRON_NODES, matrix)
      else
        call extrapolate_beam(kind, walls_or_none(walls), HEXAHEDRON_NODES, matrix)
      end if
    case default
      if (n_points == 1) matrix(:n_nodes, 1) = 1
    end select
  end subroutine extrapolation_matrix


  !> Solid shells: the nodes of a face from the points on it.
  pure subroutine extrapolate_layers(n_nodes, n_points, matrix)
    integer, intent(in) :: n_nodes, n_points       !< 8, 20 or 6, 15
    real(DP), intent(inout) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), area(3)
    integer :: a, p, m, top
    m = n_points / 5
    top = 4 * m
    if (n_nodes == 8) call facet_quadrature(FACET_QUAD4, m, xi, w)
    do a = 1, n_nodes / 2
      if (n_nodes == 8) then
        matrix(a, :4) = [(0.25_DP * product(1 + xi(:, p) * QUAD_NODES(:, a) / GAUSS_2**2), p=1, 4)]
      else
        area = merge(1.0_DP, 0.0_DP, a == [1, 2, 3])
        matrix(a, :3) = 2 * area - 1.0_DP / 3
      end if
      matrix(a + n_nodes / 2, top + 1:top + m) = matrix(a, :m)
    end do
  end subroutine extrapolate_layers


  !> Linear in the triangle through three points, times a linear least squares fit over the heights, whose sum is 0.
  pure subroutine extrapolate_wedge(z, matrix)
    real(DP), intent(in) :: z(:)                   !< heights of the points [-]
    real(DP), intent(inout) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    real(DP) :: area(3)
    integer :: a, i, k
    do a = 1, 15
      area = [1 - WEDGE_NODES(1, a) - WEDGE_NODES(2, a), WEDGE_NODES(1, a), WEDGE_NODES(2, a)]
      do k = 1, size(z)
        do i = 1, 3
          matrix(a, 3 * k - 3 + i) = (2 * area(i) - 1.0_DP / 3) &
            * (1 / real(size(z), DP) + WEDGE_NODES(3, a) * z(k) / sum(z**2))
        end do
      end do
    end do
  end subroutine extrapolate_wedge


  !> The C3D15 of a layer by the weights of CalculiX, which are exact for constant values alone: the value of a corner is that of
  !! its point plus a quarter of the difference to each other point, of the second and third corner to each other's alone. Source:
  !! CalculiX 2.20, extrapolate.f.
  pure subroutine extrapolate_layer_wedge(matrix)
    real(DP), intent(inout) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    real(DP), parameter :: OVER_TRIANGLE(3, 3) = reshape([1.5_DP, 0.0_DP, 0.0_DP, -0.25_DP, 1.25_DP, -0.25_DP, -0.25_DP, &
      -0.25_DP, 1.25_DP], [3, 3])                  ! (corner, point)
    real(DP) :: area(3), height
    integer :: a, i, k
    do a = 1, 15                                   ! at the middle of an edge the mean of its ends
      area = [1 - WEDGE_NODES(1, a) - WEDGE_NODES(2, a), WEDGE_NODES(1, a), WEDGE_NODES(2, a)]
      do k = 1, 2
        height = real(2 * k - 3, DP) * WEDGE_NODES(3, a) / GAUSS_2
        do i = 1, 3
          matrix(a, 3 * k - 3 + i) = 0.5_DP * (1 + height) * dot_product(area, OVER_TRIANGLE(:, i))
        end do
      end do
    end do
  end subroutine extrapolate_layer_wedge


  !> The plane kinds and trusses. A linear or bilinear function is, on an edge's middle, the mean of the corners.
  pure subroutine extrapolate_embedded(kind, n_nodes, n_points, matrix)
    integer, intent(in) :: kind                    !< a plane kind or a truss
    integer, intent(in) :: n_nodes, n_points
    real(DP), intent(inout) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    real(DP) :: at(3, MAX_ELEMENT_NODES), xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), area(3)
    integer :: a, p, n, height
    call node_coordinates(kind, at)
    call quadrature(kind, n, xi, w)
    do a = 1, n_nodes
      select case (n_points)
      case (2)
        matrix(a, :2) = 0.5_DP * (1 + xi(1, :2) * at(1, a) / GAUSS_2**2)
      case (3)
        area = [1 - at(1, a) - at(2, a), at(1, a), at(2, a)]
        matrix(a, :3) = 2 * area - 1.0_DP / 3
      case (4)
        matrix(a, :4) = [(0.25_DP * product(1 + xi(:2, p) * at(:2, a) / GAUSS_2**2), p=1, 4)]
      case (10)
        height = 3 + nint(2 * at(2, a))
        matrix(a, 2 * height - 1:2 * height) = 0.5_DP * (1 + [-1.0_DP, 1.0_DP] * at(1, a) / GAUSS_2)
      case default
        matrix(a, 1) = 1
      end select
    end do
    if (n_points == 9) call extrapolate_serendipity(kind, n_nodes, n_points, matrix)
  end subroutine extrapolate_embedded


  !> Trilinear through the points of the 2x2x2 rule. A trilinear function is, on an edge's middle, the mean of the
  !! corners.
  pure subroutine extrapolate_trilinear(n_nodes, matrix)
    integer, intent(in) :: n_nodes
    real(DP), intent(inout) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    integer, parameter :: NEAREST_CORNER(8) = [1, 2, 4, 3, 5, 6, 8, 7]   ! the corner next to each point
    integer :: a, p
    do p = 1, 8
      do a = 1, n_nodes
        matrix(a, p) = 0.125_DP * product(1 + HEXAHEDRON_NODES(:, NEAREST_CORNER(p)) * HEXAHEDRON_NODES(:, a) / GAUSS_2)
      end do
    end do
  end subroutine extrapolate_trilinear


  !> Linear through the four points; the matrix TETRA_A + (TETRA_B - TETRA_A) delta inverted in closed form.
  pure subroutine extrapolate_tetrahedron(matrix)
    real(DP), intent(inout) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    integer :: a
    matrix(:4, :4) = -TETRA_A / (TETRA_B - TETRA_A)
    do a = 1, 4
      matrix(a, a) = (1 - TETRA_A) / (TETRA_B - TETRA_A)
    end do
    do a = 5, 10
      matrix(a, :4) = 0.5_DP * (matrix(TETRAHEDRON_EDGES(1, a), :4) + matrix(TETRAHEDRON_EDGES(2, a), :4))
    end do
  end subroutine extrapolate_tetrahedron


  !> Least squares fit of the shape functions to the points: (N N^T)^-1 N, by Cholesky.
  pure subroutine extrapolate_serendipity(kind, n_nodes, n_points, matrix)
    integer, intent(in) :: kind                    !< KIND_C3D20 or a square of eight nodes and nine points
    integer, intent(in) :: n_nodes, n_points
    real(DP), intent(inout) :: matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), shapes(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), dN(3, &
      MAX_ELEMENT_NODES)
    integer :: p, n
    shapes = 0
    call quadrature(kind, n, xi, w)
    do p = 1, n_points
      call shape_functions(kind, xi(:, p), shapes(:, p), dN)
    end do
    call solve_normal_equations(shapes(:n_nodes, :n_points))
    matrix = shapes
  end subroutine extrapolate_serendipity


  !> Shape functions of a facet with first and second derivatives; entries past its nodes are zero.
  pure subroutine facet_shapes(facet_kind, xi, N, dN, ddN)
    integer, intent(in) :: facet_kind              !< FACET_...
    real(DP), intent(in) :: xi(2)                  !< triangles 0..1, node 1 at the origin; squares and edges -1..1 [-]
    real(DP), intent(out) :: N(MAX_FACE_NODES)     !< values [-]
    real(DP), intent(out) :: dN(2, MAX_FACE_NODES) !< derivatives by xi(1), xi(2) [-]
    real(DP), intent(out) :: ddN(3, MAX_FACE_NODES)   !< second derivatives 11, 22, 12 [-]
    N = 0
    dN = 0
    ddN = 0
    select case (facet_kind)
    case (FACET_TRI3)
      N(:3) = [1 - xi(1) - xi(2), xi(1), xi(2)]
      dN(:, :3) = reshape([real(DP) :: -1, -1, 1, 0, 0, 1], [2, 3])
    case (FACET_QUAD4)
      call bilinear_shapes(xi, N(:4), dN(:, :4), ddN(:, :4))
    case (FACET_TRI6)
      call tri6_shapes(xi, N(:6), dN(:, :6), ddN(:, :6))
    case (FACET_QUAD8)
      call quad8_shapes(xi, N, dN, ddN)
    case (FACET_LINE2)
      N(:2) = 0.5_DP * [1 - xi(1), 1 + xi(1)]
      dN(1, :2) = [-0.5_DP, 0.5_DP]
    case (FACET_LINE3)
      N(:3) = [0.5_DP * xi(1) * (xi(1) - 1), 0.5_DP * xi(1) * (xi(1) + 1), 1 - xi(1)**2]
      dN(1, :3) = [xi(1) - 0.5_DP, xi(1) + 0.5_DP, -2 * xi(1)]
      ddN(1, :3) = [1.0_DP, 1.0_DP, -2.0_DP]
    case default                                   ! unknown kind: nothing is set
    end select
  end subroutine facet_shapes


  !> N = 1/4 (1 + xi_a xi)(1 + eta_a eta).
  pure subroutine bilinear_shapes(xi, N, dN, ddN)
    real(DP), intent(in) :: xi(2)
    real(DP), intent(out) :: N(4), dN(2, 4), ddN(3, 4)
    real(DP) :: x, y
    integer :: a
    do a = 1, 4
      x = 1 + QUAD_NODES(1, a) * xi(1)
      y = 1 + QUAD_NODES(2, a) * xi(2)
      N(a) = 0.25_DP * x * y
      dN(:, a) = 0.25_DP * [QUAD_NODES(1, a) * y, x * QUAD_NODES(2, a)]
      ddN(:, a) = [0.0_DP, 0.0_DP, 0.25_DP * QUAD_NODES(1, a) * QUAD_NODES(2, a)]
    end do
  end subroutine bilinear_shapes


  !> Corners: L (2 L - 1); mid-sides: 4 L_i L_j, with the area coordinates L.
  pure subroutine tri6_shapes(xi, N, dN, ddN)
    real(DP), intent(in) :: xi(2)
    real(DP), intent(out) :: N(6), dN(2, 6), ddN(3, 6)
    real(DP), parameter :: BARYCENTRIC_GRADIENT(2, 3) = reshape([real(DP) :: -1, -1, 1, 0, 0, 1], [2, 3])
    integer, parameter :: EDGES(2, 4:6) = reshape([1, 2, 2, 3, 3, 1], [2, 3])
    real(DP) :: area(3), p(2), q(2)
    integer :: a
    area = [1 - xi(1) - xi(2), xi(1), xi(2)]
    do a = 1, 3
      p = BARYCENTRIC_GRADIENT(:, a)
      N(a) = area(a) * (2 * area(a) - 1)
      dN(:, a) = p * (4 * area(a) - 1)
      ddN(:, a) = 4 * [p(1) * p(1), p(2) * p(2), p(1) * p(2)]
    end do
    do a = 4, 6
      p = BARYCENTRIC_GRADIENT(:, EDGES(1, a))
      q = BARYCENTRIC_GRADIENT(:, EDGES(2, a))
      N(a) = 4 * area(EDGES(1, a)) * area(EDGES(2, a))
      dN(:, a) = 4 * (p * area(EDGES(2, a)) + q * area(EDGES(1, a)))
      ddN(:, a) = 4 * [2 * p(1) * q(1), 2 * p(2) * q(2), p(1) * q(2) + p(2) * q(1)]
    end do
  end subroutine tri6_shapes


  !> The serendipity functions of the square.
  pure subroutine quad8_shapes(xi, N, dN, ddN)
    real(DP), intent(in) :: xi(2)
    real(DP), intent(out) :: N(8), dN(2, 8), ddN(3, 8)
    real(DP) :: s, t, x, y
    integer :: a
    do a = 1, 8
      s = QUAD_NODES(1, a)
      t = QUAD_NODES(2, a)
      x = 1 + s * xi(1)
      y = 1 + t * xi(2)
      if (a <= 4) then
        N(a) = 0.25_DP * x * y * (x + y - 3)
        dN(:, a) = 0.25_DP * [s * y * (2 * x + y - 3), t * x * (x + 2 * y - 3)]
        ddN(:, a) = 0.25_DP * [2 * s * s * y, 2 * t * t * x, s * t * (2 * x + 2 * y - 3)]
      else if (abs(s) < 0.5_DP) then
        N(a) = 0.5_DP * (1 - xi(1)**2) * y
        dN(:, a) = [-xi(1) * y, 0.5_DP * (1 - xi(1)**2) * t]
        ddN(:, a) = [-y, 0.0_DP, -xi(1) * t]
      else
        N(a) = 0.5_DP * x * (1 - xi(2)**2)
        dN(:, a) = [0.5_DP * s * (1 - xi(2)**2), -xi(2) * x]
        ddN(:, a) = [0.0_DP, -x, -xi(2) * s]
      end if
    end do
  end subroutine quad8_shapes


  !> Integration points and weights of a facet, enough to integrate N times the normal of any (curved) facet exactly.
  !!
  !!   tri3 3 points (degree 2), quad4 2x2 (degree 3 each way), tri6 6 points (degree 4), quad8 3x3 (degree 5 each way);
  !!   edges: 2 points (degree 3), 3 points (degree 5), enough for N times the normal times the radius too
  pure subroutine facet_quadrature(facet_kind, n, xi, w)
    integer, intent(in) :: facet_kind              !< FACET_... or a rule of choose_face_rule
    integer, intent(out) :: n                      !< number of points
    real(DP), intent(out) :: xi(2, MAX_FACET_POINTS)   !< natural coordinates [-], zero past n
    real(DP), intent(out) :: w(MAX_FACET_POINTS)   !< weights [-], zero past n; sum 1/2 (triangles), 4 (squares), 2 (edges)
    real(DP), parameter :: GAUSS_3_POINTS(3) = [-GAUSS_3, 0.0_DP, GAUSS_3]
    real(DP), parameter :: GAUSS_3_WEIGHTS(3) = [5.0_DP, 8.0_DP, 5.0_DP] / 9
    integer :: p, i, j
    xi = 0
    w = 0
    n = 0
    select case (facet_kind)
    case (RULE_TRI1)
      n = 1
      xi(:, 1) = 1.0_DP / 3
      w(1) = 0.5_DP
    case (RULE_QUAD1)
      n = 1
      w(1) = 4
    case (RULE_LINE1)
      n = 1
      w(1) = 2
    case (FACET_TRI3)
      n = 3
      call set_triangle_orbit(1.0_DP / 6, 1.0_DP / 6, xi(:, 1:3), w(1:3))
    case (FACET_TRI6)
      n = 6
      call set_triangle_orbit(COWPER_A, COWPER_WA, xi(:, 1:3), w(1:3))
      call set_triangle_orbit(COWPER_B, COWPER_WB, xi(:, 4:6), w(4:6))
    case (FACET_QUAD4)
      n = 4
      xi(1, :4) = GAUSS_2 * QUAD_NODES(1, [1, 2, 4, 3])
      xi(2, :4) = GAUSS_2 * QUAD_NODES(2, [1, 2, 4, 3])
      w(:4) = 1
    case (FACET_QUAD8)
      n = 9
      do p = 1, n
        i = 1 + mod(p - 1, 3)
        j = 1 + (p - 1) / 3
        xi(:, p) = [GAUSS_3_POINTS(i), GAUSS_3_POINTS(j)]
        w(p) = GAUSS_3_WEIGHTS(i) * GAUSS_3_WEIGHTS(j)
      end do
    case (FACET_LINE2)
      n = 2
      xi(1, :2) = [-GAUSS_2, GAUSS_2]
      w(:2) = 1
    case (FACET_LINE3)
      n = 3
      xi(1, :3) = GAUSS_3_POINTS
      w(:3) = GAUSS_3_WEIGHTS
    case default                                   ! unknown kind: nothing is set
    end select
  end subroutine facet_quadrature


  !> The three points of a triangle with area coordinates a, a, 1 - 2 a.
  pure subroutine set_triangle_orbit(a, weight, xi, w)
    real(DP), intent(in) :: a, weight
    real(DP), intent(out) :: xi(2, 3), w(3)
    xi = a
    xi(1, 2) = 1 - 2 * a
    xi(2, 3) = 1 - 2 * a
    w = weight
  end subroutine set_triangle_orbit


  !> Natural coordinates of the nodes of a facet.
  pure subroutine facet_node_coordinates(facet_kind, xi)
    integer, intent(in) :: facet_kind              !< FACET_...
    real(DP), intent(out) :: xi(2, MAX_FACE_NODES) !< [-], zero past its nodes
    xi = 0
    select case (facet_kind)
    case (FACET_TRI3)
      xi(:, :3) = TRIANGLE_NODES(:, :3)
    case (FACET_TRI6)
      xi(:, :6) = TRIANGLE_NODES
    case (FACET_QUAD4)
      xi(:, :4) = QUAD_NODES(:, :4)
    case (FACET_QUAD8)
      xi = QUAD_NODES
    case (FACET_LINE2, FACET_LINE3)
      xi(1, :2) = [-1.0_DP, 1.0_DP]
    case default                                   ! unknown kind: nothing is set
    end select
  end subroutine facet_node_coordinates

end module amontons_shape_functions
