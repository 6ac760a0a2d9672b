!> Tests of lines as facets: neighbours and kinds of their ends, projection, walk, and all derivatives.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_line_facets
  use amontons_kinds, only: DP, PI
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_CPE4, KIND_CPE8, KIND_T3D2, element_kind, element_kind_type
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_facets, only: facets_type, build_facets, EDGE_FREE, EDGE_SMOOTH, EDGE_CONVEX, EDGE_CONCAVE
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_surface_projection, only: projection_type, gap_derivatives_type, track_projection, find_projection, &
    evaluate_gap_derivatives, &
    evaluate_facet_point, find_edge_excess, PROJECTION_INSIDE, PROJECTION_OUTSIDE
  use check, only: suite_type
  use samples, only: evaluate_smooth_normal
  implicit none
  integer, parameter :: KINDS(2) = [KIND_CPE4, KIND_CPE8]
  type(suite_type) :: suite
  integer :: i
  call check_ends()
  call check_errors()
  do i = 1, 2
    call check_rays(KINDS(i))
    call check_circle(KINDS(i))
    call check_derivatives(KINDS(i))
  end do
  call check_corners()
  call suite%finish()

contains

  !> Elements along a line of points from right to left, so that the normals point up; each has its edge S1 there.
  subroutine chain(kind, points, mesh, facets, error)
    integer, intent(in) :: kind
    real(DP), intent(in) :: points(:, :)             !< (2, :) corners, for CPE8 with the middles between them
    type(mesh_type), intent(out) :: mesh
    type(facets_type), intent(out) :: facets
    type(error_type), allocatable, intent(out) :: error
    type(element_kind_type) :: entry
    integer :: n, e, each, f
    entry = element_kind(kind)
    each = merge(2, 1, kind == KIND_CPE8)
    n = (size(points, 2) - 1) / each
    mesh%n_nodes = size(points, 2) + 1
    mesh%n_elements = n
    allocate (mesh%coordinates(3, mesh%n_nodes), source=0.0_DP)
    mesh%coordinates(:2, :size(points, 2)) = points
    mesh%coordinates(2, mesh%n_nodes) = -100.0_DP
    mesh%node_label = [(f, f=1, mesh%n_nodes)]
    mesh%element_label = [(100 + f, f=1, n)]
    mesh%kind = spread(kind, 1, n)
    mesh%first = [(1 + entry%n_nodes * (f - 1), f=1, n + 1)]
    allocate (mesh%nodes(entry%n_nodes * n), source=mesh%n_nodes)
    do e = 1, n
      f = entry%n_nodes * (e - 1)
      mesh%nodes(f + 1:f + 2) = each * (e - 1) + [1, 1 + each]
      if (each == 2) mesh%nodes(f + 5) = 2 * e
    end do
    call finalize_mesh(mesh)
    call build_facets(mesh, [(f, f=1, n)], spread(1, 1, n), facets, error)
  end subroutine chain


  !> A wavy line of 6 edges with a crease of the given angle in its middle.
  subroutine wavy(kind, angle, mesh, facets)
    integer, intent(in) :: kind
    real(DP), intent(in) :: angle                    !< [rad]
    type(mesh_type), intent(out) :: mesh
    type(facets_type), intent(out) :: facets
    type(error_type), allocatable :: error
    real(DP), allocatable :: points(:, :)
    real(DP) :: x
    integer :: i, each
    each = merge(2, 1, kind == KIND_CPE8)
    allocate (points(2, 6 * each + 1))
    do i = 1, size(points, 2)
      x = 3.0_DP - real(i - 1, DP) / real(each, DP)
      points(:, i) = [x + 0.04_DP * sin(7.0_DP * real(i, DP)), 0.2_DP * cos(1.3_DP * x)]
      if (x < 0.0_DP) points(2, i) = points(2, i) + x * tan(angle)
    end do
    call chain(kind, points, mesh, facets, error)
    if (allocated(error)) error stop 'the sample line is bad'
  end subroutine wavy


  !> Neighbours and the kinds of ends: smooth, convex, concave and free.
  subroutine check_ends()
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    real(DP), parameter :: POINTS(2, 5) = reshape([real(DP) :: 4, 0, 3, 0, 2, 0, 2, 1, 1, 1], [2, 5])
    call chain(KIND_CPE4, POINTS, mesh, facets, error)
    call suite%that('ends: built', .not. allocated(error))
    call suite%that('ends: neighbours', all(facets%neighbour == &
      reshape([0, 2, 0, 0, 1, 3, 0, 0, 2, 4, 0, 0, 3, 0, 0, 0], [4, 4])))
    call suite%that('ends: kinds', all(facets%edge(:2, :) == reshape([EDGE_FREE, EDGE_SMOOTH, EDGE_SMOOTH, EDGE_CONCAVE, &
      EDGE_CONCAVE, EDGE_CONVEX, EDGE_CONVEX, EDGE_FREE], [2, 4])))
    call suite%that('ends: no others', all(facets%edge(3:, :) == EDGE_FREE))
    call suite%near('ends: length', facets%edge_length(2), 1.0_DP, 1.0e-14_DP)
    call suite%that('ends: stencil of the second reaches its smooth neighbour only', &
      facets%stencil_first(3) - facets%stencil_first(2) == 3)
    call suite%that('excess', all(abs(find_edge_excess(facets%kind(1), [1.2_DP, 9.0_DP]) - &
      [-1.1_DP, 0.1_DP, -1.0_DP, -1.0_DP]) < 1.0e-14_DP))
  end subroutine check_ends


  !> Errors: an edge without length, edges of opposite orientation, three at a node, and a truss.
  subroutine check_errors()
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    call chain(KIND_CPE4, reshape([real(DP) :: 1, 0, 1, 0, 0, 0], [2, 3]), mesh, facets, error)
    call suite%that('an edge without length', allocated(error))
    call chain(KIND_CPE4, reshape([real(DP) :: 2, 0, 1, 0, 0, 0], [2, 3]), mesh, facets, error)
    mesh%nodes(5:6) = [3, 2]
    call build_facets(mesh, [1, 2], [1, 1], facets, error)
    call suite%that('edges against each other', allocated(error))
    call chain(KIND_CPE4, reshape([real(DP) :: 3, 0, 2, 0, 1, 0, 0, 1], [2, 4]), mesh, facets, error)
    mesh%nodes(9:10) = [2, 4]
    call build_facets(mesh, [1, 2, 3], [1, 1, 1], facets, error)
    call suite%that('three edges at a node', allocated(error))
    mesh%kind(1) = KIND_T3D2
    call build_facets(mesh, [1], [1], facets, error)
    call suite%that('a truss', allocated(error))
    if (allocated(error)) call suite%that('a truss: the message', index(error%message, 'neither') > 0)
  end subroutine check_errors


  !> A point on the ray of a known projection is found again: by a walk from the far end, and by the search.
  subroutine check_rays(kind)
    integer, intent(in) :: kind
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: found
    real(DP), parameter :: GAPS(3) = [0.0_DP, 0.2_DP, -0.15_DP]
    real(DP) :: xi(2), expected(2), g, n(3), xm(3), error
    integer :: goal, i, f, status, n_wrong
    call wavy(kind, 0.2_DP, mesh, facets)
    call build_facet_search(facets, mesh%coordinates, 0.5_DP, search)
    error = 0
    n_wrong = 0
    do goal = 1, facets%n
      do i = 1, 9
        expected = [-1.0_DP + 0.2_DP * real(i, DP), 0.0_DP]
        call evaluate_facet_point(facets, mesh%coordinates, goal, expected, xm)
        call evaluate_smooth_normal(facets, mesh%coordinates, goal, expected, n)
        xm = xm + GAPS(1 + modulo(i, 3)) * n
        f = merge(1, facets%n, goal > 3)
        call track_projection(facets, mesh%coordinates, xm, f, xi, g, n, status)
        call find_projection(facets, search, mesh%coordinates, xm, 0.5_DP, found)
        if (f /= goal .or. status /= PROJECTION_INSIDE .or. found%facet /= goal) n_wrong = n_wrong + 1
        error = max(error, norm2(xi - expected), abs(g - GAPS(1 + modulo(i, 3))), norm2(found%xi - expected))
      end do
    end do
    call suite%that('rays: every one is found', n_wrong == 0)
    call suite%near('rays: place and gap', error, 0.0_DP, 1.0e-11_DP)
  end subroutine check_rays


  !> A closed circle of 24 edges: at the nodes the smooth normal is the radius, and the gap that of the circle.
  subroutine check_circle(kind)
    integer, intent(in) :: kind
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    real(DP), allocatable :: points(:, :)
    real(DP) :: angle, worst, n(3), xi(2), g
    integer :: i, f, each, status
    each = merge(2, 1, kind == KIND_CPE8)
    allocate (points(2, 24 * each + 1))
    do i = 1, size(points, 2)
      angle = 2 * PI * real(i - 1, DP) / real(24 * each, DP)
      points(:, i) = [cos(angle), sin(angle)]
    end do
    call chain(kind, points, mesh, facets, error)
    mesh%nodes(mesh%first(24) + 1) = 1              ! closed
    call build_facets(mesh, [(f, f=1, 24)], spread(1, 1, 24), facets, error)
    call suite%that('circle: all ends are smooth', count(facets%edge == EDGE_SMOOTH) == 48)
    worst = 0
    do i = 1, 24
      angle = 2 * PI * real(i, DP) / 24.0_DP
      f = 1 + modulo(i - 4, 24)
      call track_projection(facets, mesh%coordinates, 1.1_DP * [cos(angle), sin(angle), 0.0_DP], f, xi, g, n, status)
      worst = max(worst, norm2(n - [cos(angle), sin(angle), 0.0_DP]), abs(g - 0.1_DP))
    end do
    call suite%near('circle: gap and normal from 45 degrees away', worst, 0.0_DP, 1.0e-12_DP)
  end subroutine check_circle


  !> Beyond a free end, beyond a convex crease, in a concave one.
  subroutine check_corners()
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    real(DP), parameter :: POINTS(2, 5) = reshape([real(DP) :: 4, 0, 3, 0, 2, 0, 2, 1, 1, 1], [2, 5])
    real(DP) :: xi(2), g, n(3)
    integer :: f, status
    call chain(KIND_CPE4, POINTS, mesh, facets, error)
    f = 1
    call track_projection(facets, mesh%coordinates, [4.09_DP, 0.2_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('free end: a tenth beyond is on', status == PROJECTION_INSIDE .and. f == 1)
    call track_projection(facets, mesh%coordinates, [4.11_DP, 0.2_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('free end: farther is off', status == PROJECTION_OUTSIDE)
    f = 2
    call track_projection(facets, mesh%coordinates, [1.95_DP, 0.5_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('valley: the wall takes over', f == 3 .and. status == PROJECTION_INSIDE)
    call suite%near('valley: gap to the wall', g, -0.05_DP, 1.0e-13_DP)
    f = 3
    call track_projection(facets, mesh%coordinates, [1.5_DP, 1.3_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('ridge: over it', f == 4 .and. status == PROJECTION_INSIDE)
    call suite%near('ridge: gap to the top', g, 0.3_DP, 1.0e-13_DP)
  end subroutine check_corners


  !> All derivatives against central differences, at smooth points and next to a crease.
  subroutine check_derivatives(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: GAPS(3) = [0.0_DP, 0.15_DP, -0.1_DP], H = 2.0e-5_DP
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(gap_derivatives_type) :: exact
    real(DP) :: worst, drift, xi(2), point(3), n(3), values(6), moved(3)
    integer :: c, f, i, j, k
    worst = 0
    drift = 0
    do c = 0, 1
      call wavy(kind, 1.1_DP * real(c, DP), mesh, facets)
      do f = 1, facets%n
        do i = 1, 3
          xi = [-0.7_DP + 0.45_DP * real(i, DP), 0.0_DP]
          associate (x => mesh%coordinates)
            call evaluate_facet_point(facets, x, f, xi, point)
            call evaluate_smooth_normal(facets, x, f, xi, n)
            point = point + GAPS(i) * n
            call evaluate_gap_derivatives(facets, x, f, xi, GAPS(i), exact)
            do k = 1, 2
              moved = 0
              moved(k) = H
              values = (at(facets, x, point + moved, f) - at(facets, x, point - moved, f)) / (2 * H)
              worst = max(worst, norm2(values - [exact%d_xi_slave(:, k), exact%d_gap_slave(k), exact%d_n_slave(:, k)]))
              do j = 1, exact%n_nodes
                values = (at(facets, nudged(x, exact%nodes(j), k, H), point, f) - &
                  at(facets, nudged(x, exact%nodes(j), k, -H), point, f)) / (2 * H)
                worst = max(worst, norm2(values - [exact%d_xi(:, k, j), exact%d_gap(k, j), exact%d_n(:, k, j)]))
              end do
            end do
          end associate
          drift = max(drift, norm2(exact%d_gap_slave + sum(exact%d_gap, 2)))
        end do
      end do
    end do
    call suite%near('derivatives against central differences', worst, 0.0_DP, 2.0e-7_DP)
    call suite%near('a translation changes nothing', drift, 0.0_DP, 1.0e-12_DP)
  end subroutine check_derivatives


  !> xi, gap and normal of a point that stays on its facet.
  function at(facets, x, point, f) result(values)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :), point(3)
    integer, intent(in) :: f
    real(DP) :: values(6), xi(2), g, n(3)
    integer :: facet, status
    facet = f
    call track_projection(facets, x, point, facet, xi, g, n, status)
    if (facet /= f) error stop 'a point of the derivative test left its facet'
    values = [xi, g, n]
  end function at


  function nudged(x, node, k, h) result(y)
    real(DP), intent(in) :: x(:, :), h
    integer, intent(in) :: node, k
    real(DP), allocatable :: y(:, :)
    allocate (y, source=x)
    y(k, node) = y(k, node) + h
  end function nudged

end program test_line_facets
