!> Unit test of amontons_polygon_clipping: cuts against a count of sample points, rules by monomials, and inverse maps.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_polygon_clipping
  use amontons_kinds, only: DP
  use amontons_polygon_clipping, only: clip_polygon, signed_polygon_area, set_polygon_quadrature, find_polygon_excess, &
    find_flat_coordinates, MAX_POLYGON_CORNERS, MAX_CUT_POINTS
  use amontons_shape_functions, only: facet_shapes, facet_node_coordinates
  use amontons_element_kinds, only: facet_kind, facet_kind_type, MAX_FACE_NODES, FACET_TRI3, FACET_QUAD8
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: SQUARE(2, 4) = reshape([real(DP) :: 0, 0, 2, 0, 2, 2, 0, 2], [2, 4])
  call check_area()
  call check_symmetric_cut()
  call check_lines()
  call check_edge_on_edge()
  call check_rules()
  call check_rectangle()
  call check_inverse()
  call suite%finish()

contains

  subroutine check_area()
    real(DP) :: beyond
    integer :: edge
    call suite%near('counter-clockwise', signed_polygon_area(SQUARE), 4.0_DP, 0.0_DP)
    call suite%near('clockwise', signed_polygon_area(SQUARE(:, 4:1:-1)), -4.0_DP, 0.0_DP)
    call suite%near('far from the origin', signed_polygon_area(SQUARE + 1.0e6_DP), 4.0_DP, 1.0e-9_DP)
    call find_polygon_excess(SQUARE, [1.0_DP, -0.5_DP], beyond, edge)
    call suite%near('below', beyond, 0.5_DP, 1.0e-15_DP)
    call suite%that('the first edge', edge == 1)
    call find_polygon_excess(SQUARE, [0.3_DP, 1.0_DP], beyond, edge)
    call suite%near('inside', beyond, -0.3_DP, 1.0e-15_DP)
    call suite%that('nearest to the fourth edge', edge == 4)
  end subroutine check_area


  !> The cut of A by B is that of B by A, and each of its corners is in both.
  subroutine check_symmetric_cut()
    real(DP) :: triangle(2, 3), cut(2, MAX_POLYGON_CORNERS), other(2, MAX_POLYGON_CORNERS), beyond
    integer :: n, m, k, edge, turn
    do turn = 0, 11
      triangle = 1.3_DP
      do k = 1, 3
        triangle(:, k) = triangle(:, k) + 1.4_DP * [cos(2.1_DP * real(k, DP) + 0.5_DP * real(turn, DP)), &
          sin(2.1_DP * real(k, DP) + 0.5_DP * real(turn, DP))]
      end do
      call clip_polygon(triangle, SQUARE, cut, n)
      call clip_polygon(SQUARE, triangle, other, m)
      call suite%that('something in common', n >= 3 .and. m == n)
      call suite%near('the same either way', signed_polygon_area(cut(:, :n)), signed_polygon_area(other(:, :m)), 1.0e-14_DP)
      do k = 1, n
        call find_polygon_excess(SQUARE, cut(:, k), beyond, edge)
        call suite%that('in the square', beyond < 1.0e-14_DP)
        call find_polygon_excess(triangle, cut(:, k), beyond, edge)
        call suite%that('in the triangle', beyond < 1.0e-14_DP)
      end do
    end do
  end subroutine check_symmetric_cut


  !> Each edge of a cut knows the line that it lies on: of the subject, or of the window.
  subroutine check_lines()
    real(DP) :: cut(2, MAX_POLYGON_CORNERS), a(2), b(2), p(2), window(2, 4)
    integer :: lines(MAX_POLYGON_CORNERS), n, k, q
    window = SQUARE + 0.5_DP
    window(:, 2) = window(:, 2) + [0.3_DP, 0.2_DP]
    call clip_polygon(SQUARE, window, cut, n, lines)
    call suite%that('a cut of four corners', n == 4)
    do k = 1, n
      if (lines(k) <= 4) then
        a = SQUARE(:, modulo(lines(k) - 2, 4) + 1)
        b = SQUARE(:, lines(k))
      else
        a = window(:, lines(k) - 4)
        b = window(:, modulo(lines(k) - 4, 4) + 1)
      end if
      do q = 0, 1
        p = cut(:, modulo(k - 1 - q, n) + 1) - a
        call suite%near('on its line', p(1) * (b(2) - a(2)) - p(2) * (b(1) - a(1)), 0.0_DP, 1.0e-13_DP)
      end do
    end do
    call suite%that('two lines of each', count(lines(:n) > 4) == 2)
  end subroutine check_lines


  !> Edges that rounding alone parts: the whole face, no splinter, or nothing.
  subroutine check_edge_on_edge()
    real(DP) :: cut(2, MAX_POLYGON_CORNERS), shifted(2, 4), area
    integer :: n
    shifted = SQUARE
    shifted(1, :) = shifted(1, :) + 1.0e-14_DP
    call clip_polygon(SQUARE, shifted, cut, n)
    call suite%that('the same square but for rounding', n == 4)
    call suite%near('all of it', signed_polygon_area(cut(:, :n)), 4.0_DP, 1.0e-12_DP)
    shifted(1, :) = SQUARE(1, :) + 2 - 1.0e-14_DP
    call clip_polygon(SQUARE, shifted, cut, n)
    area = 0
    if (n >= 3) area = signed_polygon_area(cut(:, :n))
    call suite%near('side by side: no area', area, 0.0_DP, 1.0e-12_DP)
    call clip_polygon(SQUARE, SQUARE + 5, cut, n)
    call suite%that('far away', n < 3)
  end subroutine check_edge_on_edge


  !> Monomials up to the degree of the rule, over a pentagon, against the formula by Green's theorem along its edges.
  subroutine check_rules()
    real(DP) :: pentagon(2, 5), point(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS), barycentric(2, MAX_CUT_POINTS), total
    integer :: corner(MAX_CUT_POINTS), n, order, i, j, k, degree
    do k = 1, 5
      pentagon(:, k) = [2 * cos(1.2566370614359172_DP * real(k, DP)), sin(1.2566370614359172_DP * real(k, DP))] + 0.3_DP
    end do
    do order = 1, 6
      degree = merge(4, 2 * order - 2, order <= 3)
      call set_polygon_quadrature(pentagon, .false., order, n, point, weight, corner, barycentric)
      do i = 0, degree
        do j = 0, degree - i
          total = sum(weight(:n) * point(1, :n)**i * point(2, :n)**j)
          call suite%near('a monomial', total, exact_moment(pentagon, i, j), 1.0e-12_DP * max(1.0_DP, abs(total)))
        end do
      end do
      call suite%that('weights are positive', all(weight(:n) > 0))
      do k = 1, n
        call suite%near('barycentric', norm2(pentagon(:, 1) + barycentric(1, k) * (pentagon(:, corner(k)) - pentagon(:, 1)) &
          + barycentric(2, k) * (pentagon(:, corner(k) + 1) - pentagon(:, 1)) - point(:, k)), 0.0_DP, 1.0e-14_DP)
      end do
    end do
  end subroutine check_rules


  !> The integral of x^i y^j: x^(i+1)/(i+1) y^j dy along the edges, by Gauss with six points.
  function exact_moment(corners, i, j) result(total)
    real(DP), intent(in) :: corners(:, :)
    integer, intent(in) :: i, j
    real(DP) :: total, a(2), b(2), p(2)
    real(DP), parameter :: G(3) = [0.238619186083197_DP, 0.661209386466265_DP, 0.932469514203152_DP]
    real(DP), parameter :: W(3) = [0.467913934572691_DP, 0.360761573048139_DP, 0.171324492379170_DP]
    integer :: k, q, s
    total = 0
    do k = 1, size(corners, 2)
      a = corners(:, k)
      b = corners(:, modulo(k, size(corners, 2)) + 1)
      do q = 1, 3
        do s = -1, 1, 2
          p = 0.5_DP * (a + b) + real(s, DP) * G(q) * 0.5_DP * (b - a)
          total = total + W(q) * 0.5_DP * (b(2) - a(2)) * p(1)**(i + 1) / real(i + 1, DP) * p(2)**j
        end do
      end do
    end do
  end function exact_moment


  !> Along a line a rule of order n is exact to degree 2 n - 1.
  subroutine check_rectangle()
    real(DP) :: corners(2, 4), point(2, MAX_CUT_POINTS), weight(MAX_CUT_POINTS)
    integer :: n, order, degree
    corners = reshape([0.5_DP, -0.5_DP, 2.0_DP, -0.5_DP, 2.0_DP, 0.5_DP, 0.5_DP, 0.5_DP], [2, 4])
    do order = 1, 6
      call set_polygon_quadrature(corners, .true., order, n, point, weight)
      do degree = 0, 2 * order - 1
        call suite%near('a power along a line', sum(weight(:n) * point(1, :n)**degree), &
          (2.0_DP**(degree + 1) - 0.5_DP**(degree + 1)) / real(degree + 1, DP), 1.0e-12_DP * 2.0_DP**degree)
      end do
    end do
  end subroutine check_rectangle


  !> From natural coordinates to the plane and back, on distorted facets.
  subroutine check_inverse()
    type(facet_kind_type) :: shape
    real(DP) :: nodes(2, MAX_FACE_NODES), flat(2, MAX_FACE_NODES), xi(2), found(2), N(MAX_FACE_NODES), at(2)
    real(DP) :: dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), slopes(2, MAX_FACE_NODES)
    integer :: kind, i
    do kind = FACET_TRI3, FACET_QUAD8
      shape = facet_kind(kind)
      call facet_node_coordinates(kind, nodes)
      do i = 1, shape%n_nodes
        flat(:, i) = [2 * nodes(1, i) + 0.3_DP * nodes(2, i) + 0.05_DP * sin(3.0_DP * real(i, DP)), &
          1.5_DP * nodes(2, i) + 0.05_DP * cos(5.0_DP * real(i, DP)) + 4]
      end do
      xi = [0.23_DP, 0.41_DP]
      call facet_shapes(kind, xi, N, dN, ddN)
      at = matmul(flat(:, :shape%n_nodes), N(:shape%n_nodes))
      call find_flat_coordinates(kind, flat(:, :shape%n_nodes), at, found, N, slopes)
      call suite%near('natural coordinates', norm2(found - xi), 0.0_DP, 1.0e-13_DP)
      call suite%near('shape functions there', norm2(matmul(flat(:, :shape%n_nodes), N(:shape%n_nodes)) - at), 0.0_DP, &
        1.0e-13_DP)
      call suite%near('slopes there', norm2(slopes - dN), 0.0_DP, 1.0e-12_DP)
    end do
  end subroutine check_inverse

end program test_polygon_clipping
