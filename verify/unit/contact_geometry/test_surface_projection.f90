!> Tests of the surface projection: smooth normal, walk over edges and borders, and all derivatives.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_surface_projection
  use amontons_kinds, only: DP, PI
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, KIND_C3D6, KIND_C3D8, KIND_C3D10, &
    KIND_C3D20
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_facets, only: facets_type, build_facets
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_surface_projection, only: projection_type, gap_derivatives_type, track_projection, find_projection, &
    evaluate_gap_derivatives, &
    evaluate_facet_point, evaluate_vertex_normal, find_edge_excess, measure_thickness, find_clearance, &
    PROJECTION_INSIDE, PROJECTION_OUTSIDE
  use check, only: suite_type
  use samples, only: evaluate_smooth_normal
  implicit none
  type(suite_type) :: suite
  integer :: kind
  do kind = FACET_TRI3, FACET_QUAD8
    call check_flat(suite, kind)
    call check_rays(suite, kind)
    call check_cylinder(suite, kind, 1.0_DP)
    call check_cylinder(suite, kind, -1.0_DP)
    call check_continuity(suite, kind)
    call check_derivatives(suite, kind)
  end do
  call check_excess(suite)
  call check_free_edges(suite)
  call check_ridge(suite)
  call check_valley(suite)
  call check_find(suite)
  call check_collapsed(suite)
  call check_far(suite)
  call check_faceted(suite)
  call check_thickness(suite)
  call check_hook_thickness(suite)
  call suite%finish()

contains

  include 'sample_surfaces.inc'

  !> Facets with normals of their own: a node over the corner of four squares projects on the one whose triangle is nearest, with
  !! the normal of this square. Squares are divided from their second to their fourth corner, so that the node over their corner (1,
  !! 1) is nearest to the first and the last of the four, and a little above it to the last.
  subroutine check_faceted(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: place
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP), parameter :: LEAN = 0.1_DP
    real(DP) :: xi(2), g, n(3)
    integer :: f, status
    call flat_grid(FACET_QUAD4, 2, 2, mesh, element, face)
    call shake(mesh, 0.0_DP, 0.0_DP)
    call fold(mesh, 1.0_DP, LEAN)
    call build_facets(mesh, element, face, facets, error, is_faceted=.true.)
    call build_facet_search(facets, mesh%coordinates, 1.0_DP, search)
    call find_projection(facets, search, mesh%coordinates, [1.0_DP, 1.01_DP, -1.0e-9_DP], 0.5_DP, place)
    call suite%that('over an edge: the square with the nearest triangle', place%facet == 4)
    call suite%near('over an edge: its normal', norm2(place%normal - [sin(LEAN), 0.0_DP, cos(LEAN)]), 0.0_DP, 1.0e-12_DP)
    call find_projection(facets, search, mesh%coordinates, [1.0_DP, 0.99_DP, -1.0e-9_DP], 0.5_DP, place)
    call suite%that('below it: the first one', place%facet == 1)
    call suite%near('below it: its normal', norm2(place%normal - [0.0_DP, 0.0_DP, 1.0_DP]), 0.0_DP, 1.0e-12_DP)
    f = 1
    call track_projection(facets, mesh%coordinates, [1.2_DP, 0.5_DP, 0.0_DP], f, xi, g, n, status)
    call suite%that('a walk over the edge', f == 2 .and. status == PROJECTION_INSIDE)
    call suite%near('the normal there', norm2(n - [sin(LEAN), 0.0_DP, cos(LEAN)]), 0.0_DP, 1.0e-12_DP)
  end subroutine check_faceted


  !> Two sides of a sheet of thickness 0.1, and the same without the lower side.
  subroutine check_thickness(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP), allocatable :: coordinates(:, :), thickness(:)
    integer :: corners(4, 4), k
    coordinates = reshape([(real(mod(k, 3), DP), real(mod(k / 3, 2), DP), -0.1_DP * real(k / 6, DP), k=0, 11)], [3, 12])
    corners = reshape([1, 2, 5, 4, 2, 3, 6, 5, 7, 10, 11, 8, 8, 11, 12, 9], [4, 4])
    call mesh_of_facets(FACET_QUAD4, coordinates, corners, mesh, element, face)
    call build_facets(mesh, element, face, facets, error)
    allocate (thickness(4))
    call measure_thickness(facets, mesh%coordinates, 0.5_DP, thickness)
    call suite%near('a sheet: its thickness', maxval(abs(thickness - 0.1_DP)), 0.0_DP, 1.0e-12_DP)
    call build_facets(mesh, element(:2), face(:2), facets, error)
    call measure_thickness(facets, mesh%coordinates, 0.5_DP, thickness(:2))
    call suite%that('one side: none', all(thickness(:2) >= huge(1.0_DP)))
  end subroutine check_thickness


  !> The head of a hook: what lies behind its steep back flank is the front flank, and below a part of the top the back flank, whose
  !! normals oppose by cosines of 0.3 and 0.2. Expected: the rays from their middles meet the lines of those sides.
  subroutine check_hook_thickness(suite)
    type(suite_type), intent(inout) :: suite
    real(DP), parameter :: LINE(2, 7) = reshape([0.0_DP, 0.0_DP, 0.2_DP, -1.0_DP, 0.8_DP, -1.0_DP, 3.0_DP, 0.3_DP, 3.0_DP, 1.2_DP, &
      0.2_DP, 1.2_DP, 0.0_DP, 1.2_DP], [2, 7])
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP) :: coordinates(3, 14), thickness(7), t
    integer :: corners(4, 7), k
    do k = 1, 7
      coordinates(:, k) = [LINE(:, k), 0.0_DP]
      coordinates(:, 7 + k) = [LINE(:, k), 1.0_DP]
      corners(:, k) = [k, mod(k, 7) + 1, mod(k, 7) + 8, k + 7]
    end do
    call mesh_of_facets(FACET_QUAD4, coordinates, corners, mesh, element, face)
    call build_facets(mesh, element, face, facets, error, is_faceted=.true.)
    call measure_thickness(facets, mesh%coordinates, 9.0_DP, thickness)
    t = 0.64_DP / 0.86_DP                        ! (0.1, -0.5) + s (1, 0.2) = (0.8, -1) + t (2.2, 1.3)
    call suite%near('behind the back flank', thickness(1), (0.7_DP + 2.2_DP * t) * sqrt(1.04_DP), 1.0e-12_DP)
    call suite%near('below the top, beside the back flank', thickness(6), 1.7_DP, 1.0e-12_DP)
    call suite%near('above the land', thickness(2), 2.2_DP, 1.0e-12_DP)
  end subroutine check_hook_thickness


  !> A surface of 4 x 3 cells: waves of height `wave`, perturbed nodes, folded at x = 2 (a crease if the angle is large).
  subroutine make_surface(kind, wave, noise, angle, mesh, facets)
    integer, intent(in) :: kind
    real(DP), intent(in) :: wave, noise, angle
    type(mesh_type), intent(out) :: mesh
    type(facets_type), intent(out) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    call flat_grid(kind, 4, 3, mesh, element, face)
    call shake(mesh, wave, noise)
    call fold(mesh, 2.03_DP, angle)
    call build_facets(mesh, element, face, facets, error)
    if (allocated(error)) error stop 'the sample surface is bad'
  end subroutine make_surface


  !> A point inside a facet, number i of a sequence that fills it.
  pure function place_inside(kind, i) result(xi)
    integer, intent(in) :: kind, i
    real(DP) :: xi(2), u(2)
    u = modulo([0.754877666_DP, 0.569840291_DP] * real(i, DP), 1.0_DP)
    if (kind == FACET_TRI3 .or. kind == FACET_TRI6) then
      if (sum(u) > 1) u = 1 - u
      xi = u
    else
      xi = 2 * u - 1
    end if
  end function place_inside


  !> On a plane gap and projection have closed forms.
  subroutine check_flat(suite, kind)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    real(DP) :: xi(2), g, n(3), xm(3)
    real(DP), parameter :: POINT(3) = [2.3_DP, 1.6_DP, 0.37_DP]
    integer :: f, status
    call make_surface(kind, 0.0_DP, 0.0_DP, 0.0_DP, mesh, facets)
    f = 1
    call track_projection(facets, mesh%coordinates, POINT, f, xi, g, n, status)
    call suite%that('plane: on', status == PROJECTION_INSIDE)
    call suite%near('plane: gap', g, 0.37_DP, 1.0e-14_DP)
    call suite%near('plane: normal', n(3), 1.0_DP, 1.0e-14_DP)
    call evaluate_facet_point(facets, mesh%coordinates, f, xi, xm)
    call suite%near('plane: foot', norm2(xm - [POINT(1), POINT(2), 0.0_DP]), 0.0_DP, 1.0e-13_DP)
    f = facets%n
    call track_projection(facets, mesh%coordinates, POINT - [0.0_DP, 0.0_DP, 1.0_DP], f, xi, g, n, status)
    call suite%near('plane: penetration', g, -0.63_DP, 1.0e-14_DP)
  end subroutine check_flat


  !> A point on the ray of a known projection is found again from every corner of the surface: facet, point and gap.
  subroutine check_rays(suite, kind)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: found
    real(DP) :: xi(2), expected(2), g, n(3), xm(3), error, gap
    integer :: f, i, status, goal, n_wrong
    logical :: is_clear
    real(DP), parameter :: GAPS(3) = [0.0_DP, 0.2_DP, -0.15_DP]
    call make_surface(kind, 0.2_DP, 0.03_DP, 0.3_DP, mesh, facets)
    call build_facet_search(facets, mesh%coordinates, 0.5_DP, search)
    error = 0
    n_wrong = 0
    is_clear = .true.
    do goal = 1, facets%n
      do i = 1, 12
        expected = place_inside(kind, i + goal)
        gap = GAPS(1 + modulo(i, 3))
        call evaluate_facet_point(facets, mesh%coordinates, goal, expected, xm)
        call evaluate_smooth_normal(facets, mesh%coordinates, goal, expected, n)
        f = merge(1, facets%n, modulo(i, 2) == 0)
        call track_projection(facets, mesh%coordinates, xm + gap * n, f, xi, g, n, status)
        if (f /= goal .or. status /= PROJECTION_INSIDE) n_wrong = n_wrong + 1
        if (f == goal) error = max(error, norm2(xi - expected), abs(g - gap))
        call evaluate_smooth_normal(facets, mesh%coordinates, goal, expected, n)
        call find_projection(facets, search, mesh%coordinates, xm + gap * n, 0.5_DP, found)
        is_clear = is_clear .and. find_clearance(facets, search, mesh%coordinates, xm + gap * n, 0.5_DP) <= abs(gap)
        if (found%facet /= goal .or. found%status /= PROJECTION_INSIDE) n_wrong = n_wrong + 1
        if (found%facet == goal) error = max(error, norm2(found%xi - expected), abs(found%gap - gap))
      end do
    end do
    call suite%that('rays: every one is found', n_wrong == 0)
    call suite%near('rays: place and gap', error, 0.0_DP, 1.0e-12_DP)
    call suite%that('rays: no gap is smaller than the clearance', is_clear)
    call suite%near('rays: far away the clearance is the reach', find_clearance(facets, search, mesh%coordinates, &
      [0.0_DP, 0.0_DP, 9.0_DP], 0.5_DP), 0.5_DP, 1.0e-15_DP)
  end subroutine check_rays


  !> Half a cylinder of radius 1 in facets of 15 degrees, seen from outside (side 1) or inside (-1): far points are
  !! found from 45 degrees away, and at the nodes the smooth normal is the radius (triangles: nearly).
  subroutine check_cylinder(suite, kind, side)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    real(DP), intent(in) :: side
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP), parameter :: GAPS(3) = [0.4_DP, 0.0_DP, -0.4_DP]
    real(DP) :: angle, expected(2), xi(2), g, n(3), xm(3), worst, turned
    integer :: i, f, goal, status, n_wrong, cell, cells
    call flat_grid(kind, 12, 2, mesh, element, face)
    do i = 1, mesh%n_nodes - 1
      angle = mesh%coordinates(1, i) * PI / 12
      mesh%coordinates(:, i) = [sin(angle), 0.3_DP * mesh%coordinates(2, i), side * cos(angle)]
    end do
    call build_facets(mesh, element, face, facets, error)
    cells = facets%n / 24                            ! facets per cell; the walk starts 3 cells away
    worst = 0
    n_wrong = 0
    do goal = 1, facets%n
      do i = 1, 6
        expected = place_inside(kind, i + goal)
        call evaluate_facet_point(facets, mesh%coordinates, goal, expected, xm)
        call evaluate_smooth_normal(facets, mesh%coordinates, goal, expected, n)
        cell = (goal - 1) / cells
        f = 1 + cells * (12 * (cell / 12) + min(max(modulo(cell, 12) + merge(3, -3, modulo(i, 2) == 0), 0), 11))
        call track_projection(facets, mesh%coordinates, xm + GAPS(1 + modulo(i, 3)) * n, f, xi, g, n, status)
        if (f /= goal .or. status /= PROJECTION_INSIDE) n_wrong = n_wrong + 1
        if (f == goal) worst = max(worst, norm2(xi - expected), abs(g - GAPS(1 + modulo(i, 3))))
      end do
    end do
    call suite%that('cylinder: every one is found', n_wrong == 0)
    call suite%near('cylinder: place and gap', worst, 0.0_DP, 1.0e-11_DP)
    f = facets%n / 2 - merge(1, 0, kind == FACET_TRI3 .or. kind == FACET_TRI6)
    call evaluate_facet_point(facets, mesh%coordinates, f, corner(kind, 1), xm)
    call evaluate_smooth_normal(facets, mesh%coordinates, f, corner(kind, 1), n)
    turned = norm2(n - side * [xm(1), 0.0_DP, xm(3)])
    call suite%near('cylinder: normal at a node', turned, 0.0_DP, 0.05_DP)
  end subroutine check_cylinder


  !> At a smooth edge gap and normal are the same from both sides, and a point a little beyond changes the facet.
  subroutine check_continuity(suite, kind)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    real(DP) :: jump
    integer :: f, k, n_edges, n_wrong
    call make_surface(kind, 0.2_DP, 0.03_DP, 0.3_DP, mesh, facets)
    jump = 0
    n_edges = 0
    n_wrong = 0
    do f = 1, facets%n
      do k = 1, merge(3, 4, kind == FACET_TRI3 .or. kind == FACET_TRI6)
        if (facets%neighbour(k, f) < f) cycle
        call cross_edge(mesh, facets, f, k, jump, n_wrong)
        n_edges = n_edges + 1
      end do
    end do
    call suite%that('continuity: edges looked at', n_edges >= 17)
    call suite%that('continuity: every point is on its own side', n_wrong == 0)
    call suite%near('continuity: jump at an edge', jump, 0.0_DP, 1.0e-12_DP)
  end subroutine check_continuity


  !> One edge: the point above it from both sides, and points 1e-7 to its left and right.
  subroutine cross_edge(mesh, facets, f, k, jump, n_wrong)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f, k
    real(DP), intent(inout) :: jump
    integer, intent(inout) :: n_wrong
    real(DP) :: xi(2), inner(2), n(3), probe(6, 2), point(3), within(3)
    integer :: here, there, side
    xi = 0.3_DP * corner(facets%kind(f), k) + 0.7_DP * corner(facets%kind(f), k + 1)
    inner = xi + 1.0e-3_DP * (corner(facets%kind(f), k + 2) - corner(facets%kind(f), k + 1))
    associate (x => mesh%coordinates)
      call evaluate_facet_point(facets, x, f, xi, point)
      call evaluate_facet_point(facets, x, f, inner, within)
      call evaluate_smooth_normal(facets, x, f, xi, n)
      within = (within - point) * 1.0e-7_DP / norm2(within - point)
      point = point + 0.1_DP * n
      here = f
      there = facets%neighbour(k, f)
      probe(:, 1) = values_at(facets, x, point, here)
      probe(:, 2) = values_at(facets, x, point, there)
      jump = max(jump, norm2(probe(3:, 1) - probe(3:, 2)), norm2(probe(4:, 1) - n))
      if (here /= f .or. there /= facets%neighbour(k, f)) n_wrong = n_wrong + 1
      do side = 1, 2
        here = merge(f, facets%neighbour(k, f), side == 2)
        probe(:, side) = values_at(facets, x, point + real(3 - 2 * side, DP) * within, here)
        if (here /= merge(f, facets%neighbour(k, f), side == 1)) n_wrong = n_wrong + 1
      end do
      if (norm2(probe(3:, 1) - probe(3:, 2)) > 1.0e-6_DP) n_wrong = n_wrong + 1
    end associate
  end subroutine cross_edge


  !> xi, g and n of the projection of a point, and in f its last facet; huge unless inside.
  function values_at(facets, x, point, f) result(values)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :), point(3)
    integer, intent(inout) :: f
    real(DP) :: values(6)
    integer :: status
    call track_projection(facets, x, point, f, values(1:2), values(3), values(4:6), status)
    if (status /= PROJECTION_INSIDE) values = huge(1.0_DP)
  end function values_at


  pure function corner(kind, k) result(xi)
    integer, intent(in) :: kind, k
    real(DP) :: xi(2)
    real(DP), parameter :: TRIANGLE(2, 3) = reshape(real([0, 0, 1, 0, 0, 1], DP), [2, 3])
    real(DP), parameter :: SQUARE(2, 4) = reshape(real([-1, -1, 1, -1, 1, 1, -1, 1], DP), [2, 4])
    if (kind == FACET_TRI3 .or. kind == FACET_TRI6) then
      xi = TRIANGLE(:, modulo(k - 1, 3) + 1)
    else
      xi = SQUARE(:, modulo(k - 1, 4) + 1)
    end if
  end function corner


  !> All derivatives against central differences: smooth and creased surface, gap zero, positive, negative, inside and
  !! near edges.
  subroutine check_derivatives(suite, kind)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind
    real(DP), parameter :: GAPS(3) = [0.0_DP, 0.15_DP, -0.1_DP], ANGLES(2) = [0.3_DP, 1.2_DP]
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    real(DP) :: xi(2), worst, drift
    integer :: i, a, j, f, last
    character(20) :: name
    write (name, '(a,i0)') 'kind ', kind
    worst = 0
    drift = 0
    do a = 1, 2
      call make_surface(kind, 0.2_DP, 0.05_DP, ANGLES(a), mesh, facets)
      last = facets%n
      do i = 1, 3
        do j = 1, 4
          f = 1 + modulo(5 * j + 7 * i, last)
          xi = place_inside(kind, i + 3 * j)
          if (j == 4) xi = 0.997_DP * (0.4_DP * corner(kind, 2) + 0.6_DP * corner(kind, 3)) + &
            0.003_DP * corner(kind, 1)
          call compare_derivative(mesh, facets, f, xi, GAPS(i), worst, drift)
        end do
      end do
    end do
    call suite%near(trim(name) // ': derivatives against central differences', worst, 0.0_DP, 1.0e-7_DP)
    call suite%near(trim(name) // ': a translation changes nothing', drift, 0.0_DP, 1.0e-12_DP)
  end subroutine check_derivatives


  !> One point: the largest difference over the slave node and all stencil nodes, and the sum of all derivatives.
  subroutine compare_derivative(mesh, facets, f, xi, gap, worst, drift)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f
    real(DP), intent(in) :: xi(2), gap
    real(DP), intent(inout) :: worst, drift
    type(gap_derivatives_type) :: exact
    real(DP) :: point(3), n(3), moved(3), values(6)
    real(DP), parameter :: H = 2.0e-5_DP
    integer :: j, k
    associate (x => mesh%coordinates)
      call evaluate_facet_point(facets, x, f, xi, point)
      call evaluate_smooth_normal(facets, x, f, xi, n)
      point = point + gap * n
      call evaluate_gap_derivatives(facets, x, f, xi, gap, exact)
      worst = max(worst, norm2(exact%n - n))
      do k = 1, 3
        moved = 0
        moved(k) = H
        values = (on_facet(facets, x, point + moved, f) - on_facet(facets, x, point - moved, f)) / (2 * H)
        values = values - [exact%d_xi_slave(:, k), exact%d_gap_slave(k), exact%d_n_slave(:, k)]
        worst = max(worst, norm2(values))
        do j = 1, exact%n_nodes
          values = (on_facet(facets, nudged(x, exact%nodes(j), k, H), point, f) - &
            on_facet(facets, nudged(x, exact%nodes(j), k, -H), point, f)) / (2 * H)
          values = values - [exact%d_xi(:, k, j), exact%d_gap(k, j), exact%d_n(:, k, j)]
          worst = max(worst, norm2(values))
        end do
      end do
    end associate
    drift = max(drift, norm2(exact%d_gap_slave + sum(exact%d_gap, 2)), norm2(exact%d_xi_slave + sum(exact%d_xi, 3)), &
      norm2(exact%d_n_slave + sum(exact%d_n, 3)))
  end subroutine compare_derivative


  !> The same, and it must stay on facet f.
  function on_facet(facets, x, point, f) result(values)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :), point(3)
    integer, intent(in) :: f
    real(DP) :: values(6)
    integer :: facet
    facet = f
    values = values_at(facets, x, point, facet)
    if (facet /= f) error stop 'a point of the derivative test left its facet'
  end function on_facet


  function nudged(x, node, k, h) result(y)
    real(DP), intent(in) :: x(:, :), h
    integer, intent(in) :: node, k
    real(DP), allocatable :: y(:, :)
    allocate (y, source=x)
    y(k, node) = y(k, node) + h
  end function nudged


  subroutine check_excess(suite)
    type(suite_type), intent(inout) :: suite
    call suite%that('excess of a square', &
      all(abs(find_edge_excess(FACET_QUAD4, [1.2_DP, -1.4_DP]) - [0.2_DP, 0.1_DP, -1.2_DP, -1.1_DP]) < 1.0e-14_DP))
    call suite%that('excess of a triangle', &
      all(abs(find_edge_excess(FACET_TRI6, [1.2_DP, -0.1_DP]) - [0.1_DP, 0.1_DP, -1.2_DP, -1.0_DP]) < 1.0e-14_DP))
  end subroutine check_excess


  !> A node on a free edge, slightly outside, and a tenth of the facet outside is inside the extension zone; farther it is not.
  subroutine check_free_edges(suite)
    type(suite_type), intent(inout) :: suite
    real(DP), parameter :: BEYOND(6) = [0.0_DP, 1.0e-9_DP, 0.09_DP, 0.11_DP, 0.55_DP, 5.0_DP]
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: found
    real(DP) :: xi(2), g, n(3), point(3)
    integer :: i, f, status, wanted, kind
    do kind = FACET_TRI3, FACET_QUAD8
      call make_surface(kind, 0.0_DP, 0.0_DP, 0.0_DP, mesh, facets)
      call build_facet_search(facets, mesh%coordinates, 0.2_DP, search)
      do i = 1, 6
        wanted = merge(PROJECTION_INSIDE, PROJECTION_OUTSIDE, i <= 3)
        point = [2.4_DP, -BEYOND(i), 0.01_DP]
        f = facets%n
        call track_projection(facets, mesh%coordinates, point, f, xi, g, n, status)
        call suite%that('beyond a free edge: walk', status == wanted)
        call suite%that('beyond a free edge: it walked there', any(facets%neighbour(:, f) == 0))
        call find_projection(facets, search, mesh%coordinates, point, 0.2_DP, found)
        call suite%that('beyond a free edge: find', found%status == wanted)
        if (i > 3) cycle
        call suite%near('beyond a free edge: gap', g, 0.01_DP, 1.0e-14_DP)
        call suite%near('beyond a free edge: found gap', found%gap, 0.01_DP, 1.0e-14_DP)
      end do
      point = [4.05_DP, 3.05_DP, -0.01_DP]
      f = 1
      call track_projection(facets, mesh%coordinates, point, f, xi, g, n, status)
      call suite%that('beyond two free edges', status == PROJECTION_INSIDE .and. abs(g + 0.01_DP) < 1.0e-14_DP)
    end do
  end subroutine check_free_edges


  !> A convex crease: the other side takes over beyond it; beyond both the nearer one, within a tenth of its length.
  subroutine check_ridge(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP) :: xi(2), g, n(3)
    integer :: f, status
    call flat_grid(FACET_QUAD4, 2, 1, mesh, element, face)
    call fold(mesh, 1.0_DP, PI / 2)
    call build_facets(mesh, element, face, facets, error)
    f = 1
    call track_projection(facets, mesh%coordinates, [1.02_DP, 0.5_DP, 0.05_DP], f, xi, g, n, status)
    call suite%that('ridge: beyond both sides the nearer one', &
      status == PROJECTION_INSIDE .and. f == 1 .and. abs(g - 0.05_DP) < 1.0e-14_DP)
    call track_projection(facets, mesh%coordinates, [1.05_DP, 0.5_DP, 0.02_DP], f, xi, g, n, status)
    call suite%that('ridge: nearer to the other side', &
      status == PROJECTION_INSIDE .and. f == 2 .and. abs(g - 0.05_DP) < 1.0e-14_DP)
    f = 1
    call track_projection(facets, mesh%coordinates, [1.05_DP, 0.5_DP, -0.3_DP], f, xi, g, n, status)
    call suite%that('ridge: beside the body, not behind its top', &
      status == PROJECTION_INSIDE .and. f == 2 .and. abs(g - 0.05_DP) < 1.0e-14_DP)
    f = 2
    call track_projection(facets, mesh%coordinates, [0.95_DP, 0.5_DP, 0.05_DP], f, xi, g, n, status)
    call suite%that('ridge: above the body, not behind its side', &
      status == PROJECTION_INSIDE .and. f == 1 .and. abs(g - 0.05_DP) < 1.0e-14_DP)
    f = 1
    call track_projection(facets, mesh%coordinates, [1.15_DP, 0.5_DP, -0.3_DP], f, xi, g, n, status)
    call suite%that('ridge: farther out', &
      status == PROJECTION_INSIDE .and. f == 2 .and. abs(g - 0.15_DP) < 1.0e-14_DP)
    call suite%near('ridge: its normal', n(1), 1.0_DP, 1.0e-14_DP)
    f = 1
    call track_projection(facets, mesh%coordinates, [1.15_DP, 0.5_DP, 0.05_DP], f, xi, g, n, status)
    call suite%that('ridge: the extension of the other side', status == PROJECTION_INSIDE .and. f == 2)
    f = 1
    call track_projection(facets, mesh%coordinates, [1.15_DP, 0.5_DP, 0.15_DP], f, xi, g, n, status)
    call suite%that('ridge: off beyond both', status == PROJECTION_OUTSIDE)
  end subroutine check_ridge


  !> A concave crease: the node changes sides at the crease; deep under it the nearer side keeps it.
  subroutine check_valley(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    type(facet_search_type) :: search
    type(projection_type) :: found
    integer, allocatable :: element(:), face(:)
    real(DP) :: xi(2), g, n(3)
    integer :: f, status
    call flat_grid(FACET_QUAD4, 2, 1, mesh, element, face)
    call fold(mesh, 1.0_DP, -PI / 2)
    call build_facets(mesh, element, face, facets, error)
    f = 1
    call track_projection(facets, mesh%coordinates, [0.95_DP, 0.5_DP, 0.1_DP], f, xi, g, n, status)
    call suite%that('valley: the floor', status == PROJECTION_INSIDE .and. f == 1 .and. abs(g - 0.1_DP) < 1.0e-14_DP)
    call track_projection(facets, mesh%coordinates, [1.01_DP, 0.5_DP, 0.1_DP], f, xi, g, n, status)
    call suite%that('valley: into the wall', status == PROJECTION_INSIDE .and. f == 2 .and. abs(g + 0.01_DP) < 1.0e-14_DP)
    call track_projection(facets, mesh%coordinates, [1.02_DP, 0.5_DP, -0.01_DP], f, xi, g, n, status)
    call suite%that('valley: the corner from below', &
      status == PROJECTION_INSIDE .and. f == 2 .and. abs(g + 0.02_DP) < 1.0e-14_DP)
    call track_projection(facets, mesh%coordinates, [1.2_DP, 0.5_DP, -0.2_DP], f, xi, g, n, status)
    call suite%that('valley: too deep', status == PROJECTION_OUTSIDE)
    call build_facet_search(facets, mesh%coordinates, 0.5_DP, search)
    call find_projection(facets, search, mesh%coordinates, [1.02_DP, 0.5_DP, -0.01_DP], 0.5_DP, found)
    call suite%that('valley: found from below', found%status == PROJECTION_INSIDE .and. abs(found%gap) < 0.021_DP)
  end subroutine check_valley


  !> The first projection: nearest side of a plate, side that faces the slave, largest distance, lowest facet of equals.
  subroutine check_find(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    type(facet_search_type) :: search
    type(projection_type) :: found
    integer, allocatable :: element(:), face(:)
    real(DP), parameter :: UP(3) = [0.0_DP, 0.0_DP, 1.0_DP]
    real(DP) :: x(3, 8)
    x = reshape(real([0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0, 0, 0, -1, 2, 0, -1, 2, 2, -1, 0, 2, -1], DP), [3, 8])
    call mesh_of_facets(FACET_QUAD4, x, reshape([1, 2, 3, 4, 5, 8, 7, 6], [4, 2]), mesh, element, face)
    call build_facets(mesh, element, face, facets, error)
    call build_facet_search(facets, mesh%coordinates, 2.0_DP, search)
    associate (y => mesh%coordinates)
      call find_projection(facets, search, y, [0.5_DP, 0.7_DP, -0.6_DP], 2.0_DP, found)
      call suite%that('plate: nearest side', found%facet == 2 .and. abs(found%gap + 0.4_DP) < 1.0e-14_DP)
      call find_projection(facets, search, y, [0.5_DP, 0.7_DP, -0.6_DP], 2.0_DP, found, -UP)
      call suite%that('plate: the side that faces the slave', &
        found%facet == 1 .and. abs(found%gap + 0.6_DP) < 1.0e-14_DP)
      call find_projection(facets, search, y, [0.5_DP, 0.7_DP, -0.6_DP], 2.0_DP, found, 0 * UP)
      call suite%that('plate: an unknown slave normal', found%facet == 2)
      call find_projection(facets, search, y, [0.5_DP, 0.7_DP, 0.3_DP], 0.5_DP, found, UP)
      call suite%that('plate: one that does not face is better than none', found%facet == 1)
      call find_projection(facets, search, y, [0.5_DP, 0.7_DP, -0.6_DP], 0.3_DP, found)
      call suite%that('plate: nothing within the distance', found%facet == 0 .and. found%status == PROJECTION_OUTSIDE)
      call find_projection(facets, search, y, [9.0_DP, 0.7_DP, 0.0_DP], 2.0_DP, found)
      call suite%that('plate: nothing near', found%facet == 0 .and. found%status == PROJECTION_OUTSIDE)
    end associate
    call make_surface(FACET_QUAD4, 0.0_DP, 0.0_DP, 0.0_DP, mesh, facets)
    call build_facet_search(facets, mesh%coordinates, 0.5_DP, search)
    call find_projection(facets, search, mesh%coordinates, [1.0_DP, 1.0_DP, 0.25_DP], 0.5_DP, found)
    call suite%that('grid: lowest of four equals', found%facet == 1)
  end subroutine check_find


  !> A collapsed square: projection and derivatives exist, the double node has both weights.
  subroutine check_collapsed(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    type(gap_derivatives_type) :: derivative
    integer, allocatable :: element(:), face(:)
    real(DP) :: x(3, 5), xi(2), worst, drift
    x = 0.05_DP * reshape(real([0, 0, 0, 20, 0, 2, 20, 20, 0, 0, 20, 1, 40, 4, 0], DP), [3, 5])
    call mesh_of_facets(FACET_QUAD4, x, reshape([1, 2, 3, 4, 2, 5, 3, 3], [4, 2]), mesh, element, face)
    call build_facets(mesh, element, face, facets, error)
    worst = 0
    drift = 0
    xi = [0.2_DP, -0.1_DP]
    call compare_derivative(mesh, facets, 2, xi, 0.05_DP, worst, drift)
    call suite%near('collapsed: derivatives', worst, 0.0_DP, 1.0e-7_DP)
    call suite%near('collapsed: translation', drift, 0.0_DP, 1.0e-12_DP)
    call evaluate_gap_derivatives(facets, mesh%coordinates, 2, xi, 0.05_DP, derivative)
    call suite%that('collapsed: three nodes have weight', derivative%n_weights == 3)
    call suite%near('collapsed: weights', derivative%weights(3), 0.5_DP * (1 + xi(2)), 1.0e-14_DP)
    call suite%near('collapsed: their sum', sum(derivative%weights), 1.0_DP, 1.0e-14_DP)
  end subroutine check_collapsed


  !> The vertex normal is the area vector of its star; the status reports a missing projection.
  subroutine check_far(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    real(DP) :: m(3), xi(2), g, n(3)
    integer :: f, status, kind
    do kind = FACET_TRI3, FACET_QUAD8
      call make_surface(kind, 0.0_DP, 0.0_DP, 0.0_DP, mesh, facets)
      m = evaluate_vertex_normal(facets, mesh%coordinates, facets%vertex(facets%first(1)))
      call suite%near('vertex normal of a plane', m(3), 1.0_DP, 1.0e-13_DP)
      call make_surface(kind, 0.2_DP, 0.03_DP, 0.3_DP, mesh, facets)
      f = 1
      call track_projection(facets, mesh%coordinates, [300.0_DP, 200.0_DP, 500.0_DP], f, xi, g, n, status)
      call suite%that('far away: not on', status /= PROJECTION_INSIDE)
      call suite%that('far away: numbers are numbers', abs(g) < 1.0e9_DP .and. all(abs(xi) < 10))
    end do
  end subroutine check_far

end program test_surface_projection
