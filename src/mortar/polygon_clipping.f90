!> Clipping of convex polygons, quadrature over the result, and the inverse map of planar facets.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_polygon_clipping
  use amontons_kinds, only: DP, PI
  use amontons_element_kinds, only: FACET_TRI3, FACET_TRI6, MAX_FACE_NODES
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
  integer, parameter :: MAX_RULE_POINTS = 36             !< points of the finest rule on a triangle
  integer, parameter :: MAX_CUT_POINTS = MAX_RULE_POINTS * (MAX_POLYGON_CORNERS - 2)   !< points of an integral over an intersection

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
  !! (1973) 405-408); with a higher order n for those of degree 2n - 2 (n x n points: the square collapsed to the triangle), along a
  !! line for degree 2n - 1 with any order n.
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
      call set_collapsed_rule(order, n_rule, xi, w)
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


  !> A rule on the triangle (0, 0), (1, 0), (0, 1) from two Gauss rules: exact for degree 2 order - 2.
  pure subroutine set_collapsed_rule(order, n, xi, w)
    integer, intent(in) :: order
    integer, intent(out) :: n                      !< order * order
    real(DP), intent(out) :: xi(:, :)              !< (2, :) the first n are set [-]
    real(DP), intent(out) :: w(:)                  !< the first n are set; sum 1/2 [-]
    real(DP) :: x(order), a(order)
    integer :: i, j
    call set_gauss_rule(x, a)
    n = 0
    do j = 1, order
      do i = 1, order
        n = n + 1
        xi(:, n) = [x(i) * (1 - x(j)), x(j)]
        w(n) = a(i) * a(j) * (1 - x(j))
      end do
    end do
  end subroutine set_collapsed_rule


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
      end do
      x(i) = 0.5_DP * (1 - z)
      a(i) = 1 / ((1 - z**2) * slope**2)
    end do
  end subroutine set_gauss_rule


  !> The natural coordinates of a point in a planar facet: Newton's method, two equations. A line is extruded.
  pure subroutine find_flat_coordinates(kind, flat, at, xi, N)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: flat(:, :)             !< (2, n) nodes of the facet in the plane [length]
    real(DP), intent(in) :: at(2)                  !< the point [length]
    real(DP), intent(out) :: xi(2)                 !< [-]
    real(DP), intent(out) :: N(MAX_FACE_NODES)     !< shape functions there [-]
    real(DP) :: x(2, size(flat, 2)), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), J(2, 2), r(2), step(2), det
    integer :: iteration
    x = flat
    if (is_line_facet(kind)) x(2, :) = at(2)
    xi = merge(1.0_DP / 3, 0.0_DP, kind == FACET_TRI3 .or. kind == FACET_TRI6)
    do iteration = 1, MAX_INVERSE_ITERATIONS
      call facet_shapes(kind, xi, N, dN, ddN)
      r = at - matmul(x, N(:size(x, 2)))
      J = matmul(x, transpose(dN(:, :size(x, 2))))
      if (is_line_facet(kind)) J(2, 2) = 1.0_DP
      det = J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)
      if (abs(det) <= tiny(1.0_DP)) return
      step = [J(2, 2) * r(1) - J(1, 2) * r(2), J(1, 1) * r(2) - J(2, 1) * r(1)] / det
      if (maxval(abs(step)) > 1.0_DP) step = step / maxval(abs(step))
      xi = xi + step
      if (maxval(abs(step)) < 1.0e-13_DP) exit
    end do
    call facet_shapes(kind, xi, N, dN, ddN)
  end subroutine find_flat_coordinates

end module amontons_polygon_clipping
