!> Clipping of convex polygons, quadrature over the result, and the inverse map of planar facets.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_polygon_clipping
  use amontons_kinds, only: DP, PI
  use amontons_element_kinds, only: FACET_TRI3, FACET_TRI6, FACET_QUAD4, FACET_LINE2, MAX_FACE_NODES
  use amontons_shape_functions, only: facet_quadrature, facet_shapes, MAX_FACET_POINTS
  use amontons_facets, only: is_line_facet
  implicit none
  private
  public :: clip_polygon, signed_polygon_area, set_polygon_quadrature, find_polygon_excess, find_flat_coordinates
  public :: MAX_POLYGON_CORNERS, MAX_CUT_POINTS

  integer, parameter :: MAX_POLYGON_CORNERS = 16           !< an intersection of polygons with up to 8 and 4 corners has fewer
  real(DP), parameter :: TOL_ON_POLYGON_EDGE = 1.0e-11_DP  !< a corner nearer to an edge than this fraction of the polygon's size is
                                                           !! on the edge [-]
  integer, parameter :: MAX_INVERSE_ITERATIONS = 30       !< of Newton's method for the natural coordinates of a point
  real(DP), parameter :: TOL_INVERSE = 1.0e-8_DP           !< its last step: what remains is of the size of its square [-]
  integer, parameter :: MAX_RULE_POINTS = 25             !< points of the finest rule on a triangle
  integer, parameter :: MAX_CUT_POINTS = MAX_RULE_POINTS * (MAX_POLYGON_CORNERS - 2)   !< points of an integral over an intersection

  ! Rules on a triangle by order: 12, 16 and 25 points for degrees 6, 8 and 10. D. A. Dunavant, Int. J. Numer. Methods Engrg. 21
  ! (1985) 1129-1148, to all digits. Weights over the area of the triangle, coordinates by area.
  real(DP), parameter :: CENTROID_WEIGHT(4:6) = [0.0_DP, 0.1443156076777877_DP, 0.09081799038275107_DP]
  integer, parameter :: N_ORBITS_3(4:6) = [2, 3, 2], N_ORBITS_6(4:6) = [1, 1, 3]   ! orbits of three and of six points
  real(DP), parameter :: ORBITS_3(2, 3, 4:6) = reshape([real(DP) :: &
    0.11678627572637935_DP, 0.24928674517091043_DP, 0.05084490637020682_DP, 0.06308901449150223_DP, 0, 0, &
    0.09509163426728431_DP, 0.4592925882927235_DP, 0.10321737053471806_DP, 0.17056930775176057_DP, &
    0.03245849762319802_DP, 0.05054722831703094_DP, &
    0.03672595775646817_DP, 0.4855776333836564_DP, 0.045321059435527916_DP, 0.10948157548503733_DP, 0, 0], &
    [2, 3, 3])                                     ! weight, coordinate of two corners
  real(DP), parameter :: ORBITS_6(3, 3, 4:6) = reshape([real(DP) :: &
    0.08285107561837358_DP, 0.05314504984481695_DP, 0.3103524510337844_DP, 0, 0, 0, 0, 0, 0, &
    0.02723031417443519_DP, 0.008394777409958238_DP, 0.2631128296346369_DP, 0, 0, 0, 0, 0, 0, &
    0.0727579168454189_DP, 0.14170721941488254_DP, 0.3079398387641201_DP, &
    0.02832724253105828_DP, 0.025003534762687383_DP, 0.24667256063990417_DP, &
    0.009421666963732945_DP, 0.009540815400299267_DP, 0.06680325101220098_DP], [3, 3, 3])   ! weight, two coordinates

contains

  !> The part of a polygon inside a convex one, edge by edge (Sutherland and Hodgman, Comm. ACM 17 (1974) 32-42). Corners within
  !! rounding of an edge are on the edge: otherwise rounding would decide how coincident edges of faces intersect.
  pure subroutine clip_polygon(subject, window, cut, n, lines)
    real(DP), intent(in) :: subject(:, :)          !< (2, :) corners, counter-clockwise [length]
    real(DP), intent(in) :: window(:, :)           !< (2, :) corners of a convex polygon, counter-clockwise [length]
    real(DP), intent(out) :: cut(2, MAX_POLYGON_CORNERS)   !< corners of the intersection, the first n are set [length]
    integer, intent(out) :: n                      !< less than 3: the polygons do not intersect
    integer, intent(out), optional :: lines(MAX_POLYGON_CORNERS)   !< the line of the edge before each corner: j: before corner j of
                                                   !< the subject; size(subject, 2) + k: after corner k of the window
    real(DP) :: previous(2, MAX_POLYGON_CORNERS), side(MAX_POLYGON_CORNERS), a(2), edge(2), extent
    integer :: line(MAX_POLYGON_CORNERS), line_before(MAX_POLYGON_CORNERS), k, i, j, m, window_line
    n = size(subject, 2)
    line = [(k, k=1, MAX_POLYGON_CORNERS)]
    extent = norm2(maxval(subject, dim=2) - minval(subject, dim=2))
    cut(:, :n) = subject
    cut(:, n + 1:) = 0.0_DP
    do k = 1, size(window, 2)
      a = window(:, k)
      edge = window(:, modulo(k, size(window, 2)) + 1) - a
      m = n
      previous = cut
      line_before = line
      window_line = size(subject, 2) + k
      do i = 1, m
        side(i) = edge(1) * (previous(2, i) - a(2)) - edge(2) * (previous(1, i) - a(1))   ! positive: inside
        if (abs(side(i)) <= TOL_ON_POLYGON_EDGE * extent * norm2(edge)) side(i) = 0.0_DP
      end do
      n = 0
      do j = 1, m                                  ! each corner after the intersection points since the last one
        i = modulo(j - 2, m) + 1
        if ((side(i) > 0.0_DP .and. side(j) < 0.0_DP) .or. (side(i) < 0.0_DP .and. side(j) > 0.0_DP)) &
          call append_corner(previous(:, i) + side(i) / (side(i) - side(j)) * (previous(:, j) - previous(:, i)), &
            merge(window_line, line_before(j), side(i) < 0.0_DP), cut, line, n)
        if (side(j) >= 0.0_DP) call append_corner(previous(:, j), merge(window_line, line_before(j), side(j) <= 0.0_DP .and. &
          side(i) < 0.0_DP), cut, line, n)
      end do
      if (n < 3) exit
    end do
    if (present(lines)) lines = line
  end subroutine clip_polygon


  !> Appends a corner; a polygon that is not convex could have too many.
  pure subroutine append_corner(corner, line_of_edge, cut, line, n)
    real(DP), intent(in) :: corner(2)              !< [length]
    integer, intent(in) :: line_of_edge            !< before the corner
    real(DP), intent(inout) :: cut(2, MAX_POLYGON_CORNERS)
    integer, intent(inout) :: line(MAX_POLYGON_CORNERS)
    integer, intent(inout) :: n
    if (n == MAX_POLYGON_CORNERS) return
    n = n + 1
    cut(:, n) = corner
    line(n) = line_of_edge
  end subroutine append_corner


  !> Area of a polygon, positive if its corners run counter-clockwise.
  pure real(DP) function signed_polygon_area(corners) result(area)
    real(DP), intent(in) :: corners(:, :)          !< (2, :) [length]
    real(DP) :: a(2), b(2)
    integer :: k
    area = 0.0_DP
    do k = 2, size(corners, 2) - 1
      a = corners(:, k) - corners(:, 1)
      b = corners(:, k + 1) - corners(:, 1)
      area = area + 0.5_DP * (a(1) * b(2) - a(2) * b(1))
    end do
  end function signed_polygon_area


  !> The largest distance of a point beyond the edges of a convex polygon; negative inside.
  pure subroutine find_polygon_excess(corners, point, beyond, edge)
    real(DP), intent(in) :: corners(:, :)          !< (2, :) counter-clockwise [length]
    real(DP), intent(in) :: point(2)               !< [length]
    real(DP), intent(out) :: beyond                !< [length]
    integer, intent(out) :: edge                   !< the corner at which that edge begins
    real(DP) :: along(2), r(2), distance
    integer :: k
    beyond = -huge(1.0_DP)
    edge = 1
    do k = 1, size(corners, 2)
      along = corners(:, modulo(k, size(corners, 2)) + 1) - corners(:, k)
      r = point - corners(:, k)
      if (norm2(along) <= 0.0_DP) cycle
      distance = (along(2) * r(1) - along(1) * r(2)) / norm2(along)
      if (distance <= beyond) cycle
      beyond = distance
      edge = k
    end do
  end subroutine find_polygon_excess


  !> Points and weights of an integral over a convex polygon, triangle by triangle from its first corner. Over the rectangle of a
  !! line, whose functions are constant across it: a Gauss rule along the line and two points across.
  !!
  !! Exact for polynomials of degree 4 with order 3 or less (6 points in a triangle, G. R. Cowper, Int. J. Numer. Methods Engrg. 7
  !! (1973) 405-408); with a higher order n for those of degree 2n - 2, along a line for degree 2n - 1 with any order n.
  pure subroutine set_polygon_quadrature(corners, is_rectangle, order, n, point, weight, corner, barycentric)
    real(DP), intent(in) :: corners(:, :)          !< (2, :) counter-clockwise [length]
    logical, intent(in) :: is_rectangle                 !< the polygon is the rectangle of a line
    integer, intent(in) :: order                   !< at most 6
    integer, intent(out) :: n
    real(DP), intent(out) :: point(2, MAX_CUT_POINTS)   !< the first n are set [length]
    real(DP), intent(out) :: weight(MAX_CUT_POINTS)     !< the first n are set [length^2]
    integer, intent(out), optional :: corner(MAX_CUT_POINTS)     !< k of the triangle 1, k, k + 1 that contains the point
    real(DP), intent(out), optional :: barycentric(2, MAX_CUT_POINTS)  !< barycentric coordinates of the point at k and k + 1 [-]
    real(DP) :: xi(2, MAX_RULE_POINTS), w(MAX_RULE_POINTS), a(2), b(2), twice
    integer :: k, q, n_rule
    if (is_rectangle .and. size(corners, 2) == 4) then
      call set_rectangle_quadrature(corners, order, n, point, weight, corner, barycentric)
      return
    end if
    if (order > 3) then
      call set_triangle_rule(order, n_rule, xi, w)
    else
      call facet_quadrature(FACET_TRI6, n_rule, xi(:, :MAX_FACET_POINTS), w(:MAX_FACET_POINTS))
    end if
    n = 0
    do k = 2, size(corners, 2) - 1
      a = corners(:, k) - corners(:, 1)
      b = corners(:, k + 1) - corners(:, 1)
      twice = a(1) * b(2) - a(2) * b(1)
      if (twice <= 0.0_DP) cycle
      do q = 1, n_rule
        n = n + 1
        point(:, n) = corners(:, 1) + xi(1, q) * a + xi(2, q) * b
        weight(n) = w(q) * twice
        if (present(corner)) corner(n) = k
        if (present(barycentric)) barycentric(:, n) = xi(:, q)
      end do
    end do
  end subroutine set_polygon_quadrature


  !> The same over a rectangle with sides along the axes, the first along the line. All points are expressed in its first triangle,
  !! also those outside it.
  pure subroutine set_rectangle_quadrature(corners, order, n, point, weight, corner, barycentric)
    real(DP), intent(in) :: corners(2, 4)          !< counter-clockwise [length]
    integer, intent(in) :: order
    integer, intent(out) :: n
    real(DP), intent(out) :: point(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS)
    integer, intent(out), optional :: corner(MAX_CUT_POINTS)
    real(DP), intent(out), optional :: barycentric(2, MAX_CUT_POINTS)
    real(DP) :: x(order), w(order), y(2), v(2), a(2), b(2), area, part(2)
    integer :: i, j
    n = 0
    a = corners(:, 2) - corners(:, 1)
    b = corners(:, 4) - corners(:, 1)
    area = a(1) * b(2) - a(2) * b(1)
    if (area <= 0.0_DP) return
    call set_gauss_rule(x, w)
    call set_gauss_rule(y, v)
    do j = 1, 2
      do i = 1, order
        n = n + 1
        part = [x(i), y(j)]                        ! coordinates along a and b
        if (abs(a(1)) < abs(a(2))) part = part([2, 1])
        point(:, n) = corners(:, 1) + part(1) * a + part(2) * b
        weight(n) = w(i) * v(j) * area
        if (present(corner)) corner(n) = 2
        if (present(barycentric)) barycentric(:, n) = [part(1) - part(2), part(2)]   ! of a and of the diagonal a + b
      end do
    end do
  end subroutine set_rectangle_quadrature


  !> The rule of an order on the triangle (0, 0), (1, 0), (0, 1).
  pure subroutine set_triangle_rule(order, n, xi, w)
    integer, intent(in) :: order                   !< 4 to 6
    integer, intent(out) :: n                      !< points
    real(DP), intent(out) :: xi(2, MAX_RULE_POINTS)   !< the first n are set [-]
    real(DP), intent(out) :: w(MAX_RULE_POINTS)    !< the first n are set; sum 1/2 [-]
    real(DP) :: c
    integer :: k
    n = 1
    xi(:, 1) = 1.0_DP / 3
    w(1) = 0.5_DP * CENTROID_WEIGHT(order)
    if (w(1) <= 0.0_DP) n = 0
    do k = 1, N_ORBITS_3(order)
      associate (a => ORBITS_3(2, k, order))
        xi(:, n + 1:n + 3) = reshape([a, a, 1 - 2 * a, a, a, 1 - 2 * a], [2, 3])
      end associate
      w(n + 1:n + 3) = 0.5_DP * ORBITS_3(1, k, order)
      n = n + 3
    end do
    do k = 1, N_ORBITS_6(order)
      associate (a => ORBITS_6(2, k, order), b => ORBITS_6(3, k, order))
        c = 1 - a - b
        xi(:, n + 1:n + 6) = reshape([a, b, b, a, a, c, c, a, b, c, c, b], [2, 6])
      end associate
      w(n + 1:n + 6) = 0.5_DP * ORBITS_6(1, k, order)
      n = n + 6
    end do
  end subroutine set_triangle_rule


  !> The Gauss-Legendre rule on (0, 1): Newton for the zeros of the Legendre polynomial.
  pure subroutine set_gauss_rule(x, a)
    real(DP), intent(out) :: x(:)                  !< (n) points [-]
    real(DP), intent(out) :: a(:)                  !< (n) weights, sum 1 [-]
    real(DP) :: z, p(0:2), slope
    integer :: i, k, n, iteration
    n = size(x)
    do i = 1, n
      z = cos(PI * (real(i, DP) - 0.25_DP) / (real(n, DP) + 0.5_DP))
      do iteration = 1, 10
        p = [0.0_DP, 0.0_DP, 1.0_DP]
        do k = 1, n
          p(0:1) = p(1:2)
          p(2) = (real(2 * k - 1, DP) * z * p(1) - real(k - 1, DP) * p(0)) / real(k, DP)
        end do
        slope = real(n, DP) * (z * p(2) - p(1)) / (z**2 - 1)
        z = z - p(2) / slope
        if (abs(p(2)) <= 2 * epsilon(1.0_DP)) exit
      end do
      x(i) = 0.5_DP * (1 - z)
      a(i) = 1 / ((1 - z**2) * slope**2)
    end do
  end subroutine set_gauss_rule


  !> The natural coordinates of a point in a planar facet, with the shape functions there. A line is extruded.
  pure subroutine find_flat_coordinates(kind, flat, at, xi, N, dN)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: flat(:, :)             !< (2, n) nodes of the facet in the plane [length]
    real(DP), intent(in) :: at(2)                  !< the point [length]
    real(DP), intent(out) :: xi(2)                 !< [-]
    real(DP), intent(out) :: N(MAX_FACE_NODES)     !< [-]
    real(DP), intent(out) :: dN(2, MAX_FACE_NODES)  !< derivatives of N by xi [-]
    real(DP) :: ddN(3, MAX_FACE_NODES), a(2), b(2)
    select case (kind)
    case (FACET_TRI3)
      call invert_bilinear(at - flat(:, 1), flat(:, 2) - flat(:, 1), flat(:, 3) - flat(:, 1), [0.0_DP, 0.0_DP], xi)
    case (FACET_QUAD4)
      a = 0.25_DP * (flat(:, 2) - flat(:, 1))
      b = 0.25_DP * (flat(:, 3) - flat(:, 4))
      call invert_bilinear(at - 0.25_DP * (flat(:, 1) + flat(:, 2) + flat(:, 3) + flat(:, 4)), a + b, &
        0.25_DP * (flat(:, 3) + flat(:, 4) - flat(:, 1) - flat(:, 2)), b - a, xi)
    case (FACET_LINE2)
      call invert_bilinear([at(1) - 0.5_DP * (flat(1, 1) + flat(1, 2)), 0.0_DP], [0.5_DP * (flat(1, 2) - flat(1, 1)), 0.0_DP], &
        [0.0_DP, 1.0_DP], [0.0_DP, 0.0_DP], xi)
    case default
      call invert_map(kind, flat, at, xi)
    end select
    call facet_shapes(kind, xi, N, dN, ddN)
  end subroutine find_flat_coordinates


  !> Solves a xi + b eta + c xi eta = r by Newton's method; without c the first step ends it.
  pure subroutine invert_bilinear(r, a, b, c, xi)
    real(DP), intent(in) :: r(2), a(2), b(2), c(2)   !< [length]
    real(DP), intent(out) :: xi(2)                   !< [-]
    real(DP) :: step(2)
    integer :: iteration
    xi = 0.0_DP
    do iteration = 1, MAX_INVERSE_ITERATIONS
      step = find_inverse_step(a + c * xi(2), b + c * xi(1), r - a * xi(1) - (b + c * xi(1)) * xi(2))
      xi = xi + step
      if (maxval(abs(step)) < TOL_INVERSE) exit
    end do
  end subroutine invert_bilinear


  !> The same for facets of any kind, by their shape functions.
  pure subroutine invert_map(kind, flat, at, xi)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: flat(:, :), at(2)      !< [length]
    real(DP), intent(out) :: xi(2)                 !< [-]
    real(DP) :: x(2, size(flat, 2)), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), J(2, 2), step(2)
    integer :: iteration
    x = flat
    if (is_line_facet(kind)) x(2, :) = at(2)
    xi = merge(1.0_DP / 3, 0.0_DP, kind == FACET_TRI3 .or. kind == FACET_TRI6)
    do iteration = 1, MAX_INVERSE_ITERATIONS
      call facet_shapes(kind, xi, N, dN, ddN)
      J = matmul(x, transpose(dN(:, :size(x, 2))))
      if (is_line_facet(kind)) J(2, 2) = 1.0_DP
      step = find_inverse_step(J(:, 1), J(:, 2), at - matmul(x, N(:size(x, 2))))
      xi = xi + step
      if (maxval(abs(step)) < TOL_INVERSE) exit
    end do
  end subroutine invert_map


  !> A Newton step of at most 1: solves a step_1 + b step_2 = r; zero where a and b are parallel.
  pure function find_inverse_step(a, b, r) result(step)
    real(DP), intent(in) :: a(2), b(2), r(2)       !< [length]
    real(DP) :: step(2), det                       ! [-]
    det = a(1) * b(2) - b(1) * a(2)
    step = 0.0_DP
    if (abs(det) <= tiny(1.0_DP)) return
    step = [b(2) * r(1) - b(1) * r(2), a(1) * r(2) - a(2) * r(1)] / det
    step = step / max(maxval(abs(step)), 1.0_DP)
  end function find_inverse_step

end module amontons_polygon_clipping
