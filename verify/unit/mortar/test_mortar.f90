!> Tests of polygon clipping, of dual functions on parts of faces, and of the rows built from them.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_mortar
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: facet_kind, facet_kind_type, KIND_C3D8, KIND_C3D20, FACET_TRI3, FACET_QUAD4, FACET_TRI6, &
    FACET_QUAD8, MAX_FACE_NODES
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_shape_functions, only: facet_shapes, facet_node_coordinates, node_coordinates
  use amontons_facets, only: facets_type, build_facets, facet_nodes
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_contact_constraint_rows, only: evaluate_relative_position
  use amontons_mortar, only: mortar_type, create_mortar, integrate_mortar, find_search_margin
  use amontons_surface_projection, only: evaluate_vertex_normal, evaluate_vertex_derivative
  use amontons_polygon_clipping, only: clip_polygon, signed_polygon_area, set_polygon_quadrature, find_polygon_excess, &
    MAX_POLYGON_CORNERS, MAX_CUT_POINTS
  use amontons_dual_shape_functions, only: transform_shape_functions, transform_nodal_positions, nodal_integral_fractions, &
    evaluate_dual_functions
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: SQUARE(2, 4) = reshape([0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 1.0_DP], [2, 4])
  call check_cuts()
  call check_rules()
  call check_duals(FACET_TRI3, 'triangle')
  call check_duals(FACET_QUAD4, 'square')
  call check_duals(FACET_TRI6, 'quadratic triangle')
  call check_duals(FACET_QUAD8, 'quadratic square')
  call check_normal()
  call check_overhang(KIND_C3D8, 8, 'C3D8', 0.3_DP, .false., 2)
  call check_overhang(KIND_C3D8, 8, 'C3D8', 0.93_DP, .false., 4)
  call check_overhang(KIND_C3D8, 8, 'C3D8', 0.8_DP, .false., 2)
  call check_overhang(KIND_C3D8, 8, 'C3D8, in touch', 0.8_DP, .true., 4)
  call check_overhang(KIND_C3D8, 8, 'C3D8, in touch', 0.4_DP, .true., 4)
  call check_overhang(KIND_C3D20, 20, 'C3D20', 0.3_DP, .false., 3)
  call check_overhang(KIND_C3D20, 20, 'C3D20', 0.8_DP, .false., 5)
  call check_overhang(KIND_C3D8, 8, 'C3D8, beside the master', 0.85_DP, .false., 2)
  call check_overhang(KIND_C3D8, 8, 'C3D8, over it before', 0.85_DP, .false., 4, reaches=0.2_DP)
  call check_overhang(KIND_C3D8, 8, 'C3D8, far beside it by now', 0.75_DP, .false., 2, reaches=0.2_DP)
  call check_overhang(KIND_C3D8, 8, 'C3D8, beside it before', 0.95_DP, .false., 2, reaches=0.0_DP)
  call check_crease(0.02_DP, 0.9_DP, 1)
  call check_crease(0.3_DP, 0.9_DP, 3)
  call check_crease(0.3_DP, 1.1_DP, 3)
  call check_crease(0.02_DP, 0.2_DP, 3)
  call check_beside(.true.)
  call check_beside(.false.)
  call check_sliver(1.0e-4_DP)
  call check_sliver(1.0e-6_DP)
  call check_apart()
  call suite%finish()

contains

  !> Areas of intersections with closed forms.
  subroutine check_cuts()
    real(DP) :: cut(2, MAX_POLYGON_CORNERS), other(2, 4), triangle(2, 3), distance
    integer :: n
    other = SQUARE + 0.25_DP
    call clip_polygon(SQUARE, other, cut, n)
    call suite%near('two squares', signed_polygon_area(cut(:, :n)), 0.5625_DP, 1.0e-14_DP)
    triangle = reshape([0.5_DP, -1.0_DP, 2.0_DP, 0.5_DP, 0.5_DP, 2.0_DP], [2, 3])
    call clip_polygon(SQUARE, triangle, cut, n)
    call suite%near('a triangle over a square', signed_polygon_area(cut(:, :n)), 0.5_DP, 1.0e-14_DP)
    triangle = reshape([0.0_DP, 0.0_DP, 1.0_DP, 0.5_DP, 0.0_DP, 1.0_DP], [2, 3])
    call clip_polygon(triangle, SQUARE, cut, n)
    call suite%near('a triangle inside', signed_polygon_area(cut(:, :n)), 0.5_DP, 1.0e-14_DP)
    call clip_polygon(SQUARE, SQUARE + 1.5_DP, cut, n)
    call suite%that('nothing in common', n < 3)
    other = SQUARE
    other(1, :) = other(1, :) + 1
    call clip_polygon(SQUARE, other, cut, n)
    if (n >= 3) call suite%near('a common edge has no area', signed_polygon_area(cut(:, :n)), 0.0_DP, 1.0e-14_DP)
    if (n < 3) call suite%that('a common edge has no area', .true.)
    call find_polygon_excess(SQUARE, [1.5_DP, 0.2_DP], distance, n)
    call suite%near('beyond the edge of a square', distance, 0.5_DP, 1.0e-14_DP)
    call suite%that('beyond its second edge', n == 2)
    call find_polygon_excess(SQUARE, [0.9_DP, 0.2_DP], distance, n)
    call suite%near('within a square', distance, -0.1_DP, 1.0e-14_DP)
  end subroutine check_cuts


  !> x^a y^b over the unit square is 1/((a + 1)(b + 1)), up to the degree of the order.
  subroutine check_rules()
    real(DP) :: at(2, MAX_CUT_POINTS), w(MAX_CUT_POINTS), place(2, MAX_CUT_POINTS)
    integer :: order, n, a, b, degree, corner(MAX_CUT_POINTS)
    do order = 3, 6
      call set_polygon_quadrature(SQUARE, .false., order, n, at, w)
      degree = merge(4, 2 * order - 2, order == 3)
      do a = 0, degree
        do b = 0, degree - a
          call suite%near('a polynomial', dot_product(w(:n), at(1, :n)**a * at(2, :n)**b), 1.0_DP / real((a + 1) * (b + 1), DP), &
            1.0e-14_DP)
        end do
      end do
      do a = 1, 2                                  ! along a line, from any first corner of the rectangle
        call set_polygon_quadrature(cshift(SQUARE, a, dim=2), .true., order, n, at, w, corner, place)
        call suite%that('the points of a line', n == 2 * order)
        do degree = 0, 2 * order - 1
          call suite%near('a polynomial along a line', dot_product(w(:n), at(1, :n)**degree), 1.0_DP / real(degree + 1, DP), &
            1.0e-14_DP)
        end do
        call suite%near('and across', dot_product(w(:n), at(2, :n)**2), 1.0_DP / 3, 1.0e-14_DP)
        do b = 1, n
          associate (k => corner(b), v => cshift(SQUARE, a, dim=2))
            call suite%near('its place in a triangle', norm2(v(:, 1) + place(1, b) * (v(:, k) - v(:, 1)) &
              + place(2, b) * (v(:, k + 1) - v(:, 1)) - at(:, b)), 0.0_DP, 1.0e-14_DP)
          end associate
        end do
      end do
    end do
  end subroutine check_rules


  !> On a part of a facet the duals are biorthogonal to its functions and add up to 1; on a sliver they reproduce linear functions.
  subroutine check_duals(kind, name)
    integer, intent(in) :: kind
    character(*), intent(in) :: name
    real(DP) :: at(2, MAX_CUT_POINTS), w(MAX_CUT_POINTS), shapes(MAX_FACE_NODES, MAX_CUT_POINTS), nodes(2, MAX_FACE_NODES)
    real(DP) :: dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), phi(MAX_FACE_NODES, MAX_CUT_POINTS), d(MAX_FACE_NODES)
    real(DP) :: share(MAX_FACE_NODES), f(MAX_CUT_POINTS)
    type(facet_kind_type) :: shape
    integer :: n, q, i, j, n_points, part
    shape = facet_kind(kind)
    n = shape%n_nodes
    call facet_node_coordinates(kind, nodes)       ! the facet in its own natural coordinates
    call transform_nodal_positions(kind, nodes(:, :n))
    do part = 1, 3                                 ! whole, a half, a sliver
      if (shape%n_corners == 3) then
        call set_polygon_quadrature(part_of(SQUARE(:, [1, 2, 4]), part), .false., 6, n_points, at, w)
      else
        call set_polygon_quadrature(part_of(2 * SQUARE - 1, part), .false., 6, n_points, at, w)
      end if
      do q = 1, n_points
        call facet_shapes(kind, at(:, q), shapes(:, q), dN, ddN)
        call transform_shape_functions(kind, shapes(:, q))
      end do
      call evaluate_dual_functions(kind, merge(0.5_DP, 4.0_DP, shape%n_corners == 3), nodes(:, :n), w(:n_points), at(:, &
        :n_points), &
        shapes(:n, :n_points), phi(:n, :n_points), d(:n))
      call suite%near(name // ': the sum of the duals', maxval(abs(sum(phi(:n, :n_points), dim=1) - 1)), 0.0_DP, 1.0e-10_DP)
      if (part == 1) then
        share = nodal_integral_fractions(kind)
        call suite%near(name // ': integrals of a whole facet', maxval(abs(d(:n) - share(:n) * sum(w(:n_points)))), 0.0_DP, &
          1.0e-13_DP)
        call suite%that(name // ': all positive', all(d(:n) > 0))
      end if
      do i = 1, n
        do j = 1, n
          if (part == 3) exit
          call suite%near(name // ': biorthogonal', sum(w(:n_points) * phi(i, :n_points) * shapes(j, :n_points)), &
            merge(d(i), 0.0_DP, i == j), 1.0e-11_DP)
        end do
        f(:n_points) = 1 + 2 * at(1, :n_points) - 3 * at(2, :n_points)
        call suite%near(name // ': linear functions', sum(w(:n_points) * phi(i, :n_points) * f(:n_points)), &
          d(i) * (1 + 2 * nodes(1, i) - 3 * nodes(2, i)), 1.0e-11_DP)
      end do
    end do
  end subroutine check_duals


  !> A polygon, a large part of it, and a strip of a hundredth along its first edge.
  pure function part_of(corners, part) result(cut)
    real(DP), intent(in) :: corners(:, :)
    integer, intent(in) :: part
    real(DP) :: cut(2, size(corners, 2))
    real(DP) :: rest
    cut = corners
    rest = merge(0.6_DP, 0.01_DP, part == 2)
    if (part == 1) return
    if (size(corners, 2) == 4) then
      cut(:, 3:4) = corners(:, 2:1:-1) + rest * (corners(:, 3:4) - corners(:, 2:1:-1))
    else
      cut(:, 3) = corners(:, 1) + rest * (corners(:, 3) - corners(:, 1))
    end if
  end function part_of


  !> The derivative of a vertex normal against central differences, on a bent face of a quadratic hexahedron.
  subroutine check_normal()
    type(mesh_type) :: mesh
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    real(DP), allocatable :: d_n(:, :, :), x(:, :)
    real(DP) :: xi(3, 20), m(3, 2), difference(3)
    integer, allocatable :: nodes(:)
    integer :: i, j, k, side
    real(DP), parameter :: H = 1.0e-6_DP
    mesh%n_nodes = 20
    mesh%n_elements = 1
    mesh%kind = [KIND_C3D20]
    mesh%material = [1]
    mesh%first = [1, 21]
    mesh%nodes = [(i, i=1, 20)]
    mesh%element_label = [1]
    mesh%node_label = mesh%nodes
    allocate (mesh%node_sets(0), mesh%element_sets(0))
    call node_coordinates(KIND_C3D20, xi)
    mesh%coordinates = xi
    mesh%coordinates(3, :) = mesh%coordinates(3, :) + 0.2_DP * xi(1, :)**2 - 0.1_DP * xi(1, :) * xi(2, :)
    call finalize_mesh(mesh)
    call build_facets(mesh, [1], [2], facets, error)
    call suite%that('facets', .not. allocated(error))
    if (allocated(error)) return
    x = mesh%coordinates
    call evaluate_vertex_derivative(facets, x, facets%vertex(1), nodes, d_n)
    do i = 1, size(nodes)
      do k = 1, 3
        do side = 1, 2
          x = mesh%coordinates
          x(k, nodes(i)) = x(k, nodes(i)) + merge(H, -H, side == 1)
          m(:, side) = evaluate_vertex_normal(facets, x, facets%vertex(1))
          m(:, side) = m(:, side) / norm2(m(:, side))
        end do
        difference = (m(:, 1) - m(:, 2)) / (2 * H)
        do j = 1, 3
          call suite%near('derivative of a vertex normal', d_n(j, k, i), difference(j), 1.0e-8_DP)
        end do
      end do
    end do
  end subroutine check_normal


  !> A slave face over the square (0, 1) x (0, 1), of which a master at the distance 0.1 covers x < cover: as many rows as nodes
  !! over the master, each at that distance, and the forces of a pressure of 1 are the integrals of the N_k over the covered part.
  subroutine check_overhang(kind, n, name, cover, has_touched, n_rows, reaches)
    integer, intent(in) :: kind, n                 !< of the elements, with n nodes
    character(*), intent(in) :: name
    real(DP), intent(in) :: cover                  !< [length]
    logical, intent(in) :: has_touched             !< all slave nodes were closed at the start of the increment
    integer, intent(in) :: n_rows
    real(DP), intent(in), optional :: reaches  !< excess limit of all slave nodes from earlier in the increment; else a new
                                               !! increment [-]
    type(mesh_type) :: mesh
    type(mortar_type) :: mortar
    type(facets_type) :: master
    type(facet_search_type) :: search
    type(error_type), allocatable :: error
    real(DP) :: xi(3, 20), at(2, MAX_CUT_POINTS), w(MAX_CUT_POINTS), N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES)
    real(DP) :: ddN(3, MAX_FACE_NODES), expected(40), force(40), first_moment, by_arms, cut(2, 4)
    integer :: i, k, q, n_points, n_own, nodes(MAX_FACE_NODES)
    mesh%n_nodes = 2 * n
    mesh%n_elements = 2
    mesh%kind = [kind, kind]
    mesh%material = [1, 1]
    mesh%first = [1, n + 1, 2 * n + 1]
    mesh%nodes = [(i, i=1, 2 * n)]
    mesh%element_label = [1, 2]
    mesh%node_label = mesh%nodes
    allocate (mesh%node_sets(0), mesh%element_sets(0))
    call node_coordinates(kind, xi)
    allocate (mesh%coordinates(3, 2 * n))
    mesh%coordinates(:, :n) = 0.5_DP * (xi(:, :n) + 1)
    mesh%coordinates(:, n + 1:) = mesh%coordinates(:, :n)
    mesh%coordinates(1, n + 1:) = cover - 2 * (1 - mesh%coordinates(1, n + 1:))
    mesh%coordinates(2, n + 1:) = 3 * mesh%coordinates(2, n + 1:) - 1
    mesh%coordinates(3, n + 1:) = mesh%coordinates(3, n + 1:) - 1.1_DP
    call finalize_mesh(mesh)
    call build_facets(mesh, [1], [1], master, error)
    call facet_nodes(master, 1, n_own, nodes)
    call create_mortar(mesh, [1], [1], nodes(:n_own), mortar, error)
    call build_facets(mesh, [2], [2], master, error)
    call build_facet_search(master, mesh%coordinates, find_search_margin(mortar, 1.0_DP), search)
    mortar%was_closed = has_touched
    if (present(reaches)) mortar%excess_limits = reaches
    call integrate_mortar(mortar, master, search, .not. present(reaches), mesh%coordinates, 1.0_DP)
    call suite%that(name // ': they stay so', count(mortar%excess_limits > 0.1_DP) == n_rows .and. &
      count(mortar%excess_limits < 0.1_DP) == n_own - n_rows)
    cut = SQUARE                                   ! in natural coordinates of the face, which runs along y first or along x
    expected = 0.0_DP
    cut(1, 2:3) = cover
    call set_polygon_quadrature(cut, .false., 6, n_points, at, w)
    do q = 1, n_points
      call facet_shapes(mortar%slave%kind(1), place_on(mesh%coordinates(:2, nodes(:4)), at(:, q)), N_i, dN, ddN)
      expected(nodes(:n_own)) = expected(nodes(:n_own)) + w(q) * N_i(:n_own)
    end do
    force = 0.0_DP
    first_moment = 0.0_DP
    by_arms = 0.0_DP
    call suite%that(name // ': nodes over the master', count(mortar%places%facet > 0) == n_rows)
    do i = 1, n_own
      associate (row => mortar%rows(i), place => mortar%places(i))
        if (place%facet == 0) cycle
        by_arms = by_arms + place%area * (mesh%coordinates(1, mortar%nodes(i)) + place%force_arm(1))
        call suite%near(name // ': weights of a row', sum(row%weights), 0.0_DP, 1.0e-12_DP)
        call suite%near(name // ': distance', norm2(evaluate_relative_position(row, mesh%coordinates) - [0.0_DP, 0.0_DP, &
          0.1_DP]), 0.0_DP, &
          1.0e-10_DP)
        do k = 1, size(row%nodes)
          if (row%nodes(k) <= n) force(row%nodes(k)) = force(row%nodes(k)) + row%weights(k) * place%area
          if (row%nodes(k) <= n) first_moment = first_moment + row%weights(k) * place%area * mesh%coordinates(1, row%nodes(k))
        end do
      end associate
    end do
    call suite%near(name // ': area', sum(mortar%places%area, mask=mortar%places%facet > 0), cover, 1.0e-12_DP)
    call suite%near(name // ': forces of a uniform pressure', maxval(abs(force - expected)), 0.0_DP, 1.0e-12_DP)
    call suite%near(name // ': their place', first_moment, 0.5_DP * cover**2, 1.0e-12_DP)
    if (kind == KIND_C3D8) call suite%near(name // ': their place by the arms', by_arms, 0.5_DP * cover**2, 1.0e-12_DP)
  end subroutine check_overhang


  !> A facet whose nodes stay open keeps the segmentation of the last whole call, and no other.
  subroutine check_apart()
    type(mesh_type) :: mesh
    type(mortar_type) :: mortar
    type(facets_type) :: master
    type(facet_search_type) :: search
    type(error_type), allocatable :: error
    real(DP) :: xi(3, 20), near(3, 16), beside(3, 16)
    integer :: i
    logical, parameter :: ALL_APART(4) = .true., ONE_NEAR(4) = [.true., .true., .false., .true.]
    mesh%n_nodes = 16
    mesh%n_elements = 2
    mesh%kind = spread(KIND_C3D8, 1, 2)
    mesh%material = [1, 1]
    mesh%first = [1, 9, 17]
    mesh%nodes = [(i, i=1, 16)]
    mesh%element_label = [1, 2]
    mesh%node_label = mesh%nodes
    allocate (mesh%node_sets(0), mesh%element_sets(0))
    call node_coordinates(KIND_C3D8, xi)
    near(:, :8) = 0.5_DP * (xi(:, :8) + 1)
    near(:, 9:) = 3 * near(:, :8) - 1
    near(3, 9:) = near(3, :8) - 1.1_DP
    beside = near
    beside(1, :8) = beside(1, :8) + 3
    mesh%coordinates = near
    call finalize_mesh(mesh)
    call create_mortar(mesh, [1], [1], [1, 2, 3, 4], mortar, error)
    call build_facets(mesh, [2], [2], master, error)
    call build_facet_search(master, near, find_search_margin(mortar, 1.0_DP), search)
    call integrate_mortar(mortar, master, search, .true., near, 1.0_DP)
    call suite%that('apart: over the master', all(mortar%places%facet > 0))
    call integrate_mortar(mortar, master, search, .false., beside, 1.0_DP, ALL_APART)
    call suite%that('apart: the segmentation is kept', mortar%cuts%covers(1)%n == 1)
    call integrate_mortar(mortar, master, search, .false., beside, 1.0_DP, ONE_NEAR)
    call suite%that('one node near: segmented', mortar%cuts%covers(1)%n == 0)
    call integrate_mortar(mortar, master, search, .false., near, 1.0_DP, ALL_APART)
    call suite%that('apart, but not of the last whole call: segmented', mortar%cuts%covers(1)%n == 1)
    call integrate_mortar(mortar, master, search, .false., near, 1.0_DP)
    call integrate_mortar(mortar, master, search, .false., beside, 1.0_DP, ALL_APART)
    call suite%that('apart again: kept', mortar%cuts%covers(1)%n == 1)
    call integrate_mortar(mortar, master, search, .false., beside, 1.0_DP)
    call suite%that('a whole call at the same coordinates: segmented', mortar%cuts%covers(1)%n == 0)
  end subroutine check_apart


  !> The natural coordinates of a point of the square (0, 1) x (0, 1), whose corners are given.
  pure function place_on(corners, at) result(xi)
    real(DP), intent(in) :: corners(2, 4), at(2)
    real(DP) :: xi(2), a(2), b(2)
    a = corners(:, 2) - corners(:, 1)
    b = corners(:, 4) - corners(:, 1)
    xi = 2 * [dot_product(a, at - corners(:, 1)), dot_product(b, at - corners(:, 1))] - 1
  end function place_on


  !> A cube over a horizontal master at the distance 0.1, beside a vertical one as high as `cover`: the nodes of the edge between
  !! them belong to the nearer one, unless its covered fraction is less than half of the other's.
  subroutine check_crease(distance, cover, axis)
    real(DP), intent(in) :: distance               !< of the vertical master [length]
    real(DP), intent(in) :: cover                  !< its height [length]
    integer, intent(in) :: axis                    !< of the normal of that side
    type(mesh_type) :: mesh
    type(mortar_type) :: mortar
    type(facets_type) :: master
    type(facet_search_type) :: search
    type(error_type), allocatable :: error
    real(DP) :: xi(3, 20), gap
    integer :: i
    mesh%n_nodes = 24
    mesh%n_elements = 3
    mesh%kind = spread(KIND_C3D8, 1, 3)
    mesh%material = [1, 1, 1]
    mesh%first = [1, 9, 17, 25]
    mesh%nodes = [(i, i=1, 24)]
    mesh%element_label = [1, 2, 3]
    mesh%node_label = mesh%nodes
    allocate (mesh%node_sets(0), mesh%element_sets(0))
    call node_coordinates(KIND_C3D8, xi)
    allocate (mesh%coordinates(3, 24))
    mesh%coordinates(:, :8) = 0.5_DP * (xi(:, :8) + 1)
    mesh%coordinates(:, 9:16) = 3 * mesh%coordinates(:, :8) - 1                  ! the horizontal master
    mesh%coordinates(3, 9:16) = mesh%coordinates(3, :8) - 1.1_DP
    mesh%coordinates(:, 17:) = 3 * mesh%coordinates(:, :8) - 1                   ! the vertical master
    mesh%coordinates(1, 17:) = mesh%coordinates(1, :8) + 1 + distance
    mesh%coordinates(3, 17:) = cover - 2 * (1 - mesh%coordinates(3, :8))
    call finalize_mesh(mesh)
    call create_mortar(mesh, [1, 1], [1, 4], [1, 2, 3, 4, 6, 7], mortar, error)
    call build_facets(mesh, [2, 3], [2, 6], master, error)
    call build_facet_search(master, mesh%coordinates, find_search_margin(mortar, 1.0_DP), search)
    call integrate_mortar(mortar, master, search, .true., mesh%coordinates, 1.0_DP)
    do i = 2, 3
      gap = dot_product(mortar%places(i)%normal, evaluate_relative_position(mortar%rows(i), mesh%coordinates))
      call suite%that('normal at an edge', maxloc(abs(mortar%places(i)%normal), dim=1) == axis)
      call suite%near('gap at an edge', gap, merge(distance, 0.1_DP, axis == 1), 1.0e-12_DP)
    end do
  end subroutine check_crease


  !> The mesh of n elements C3D8, each the unit cube initially.
  subroutine lay_cubes(n, mesh)
    integer, intent(in) :: n
    type(mesh_type), intent(out) :: mesh
    real(DP) :: xi(3, 20)
    integer :: i
    mesh%n_nodes = 8 * n
    mesh%n_elements = n
    mesh%kind = spread(KIND_C3D8, 1, n)
    mesh%material = spread(1, 1, n)
    mesh%first = [(8 * i + 1, i=0, n)]
    mesh%nodes = [(i, i=1, 8 * n)]
    mesh%element_label = [(i, i=1, n)]
    mesh%node_label = mesh%nodes
    allocate (mesh%node_sets(0), mesh%element_sets(0))
    call node_coordinates(KIND_C3D8, xi)
    allocate (mesh%coordinates(3, 8 * n), source=reshape([(0.5_DP * (xi(:, :8) + 1), i=1, n)], [3, 8 * n]))
  end subroutine lay_cubes


  !> A slave square lies obliquely over the edge y = 0 of two masters, (-1, 0) and (0, 1) along x, its corner beyond the edge and
  !! beside the second one. It moves along x until it intersects the second master: the corner has been near it before, so that
  !! nothing jumps.
  subroutine check_beside(is_soft)
    logical, intent(in) :: is_soft                 !< the law is compliant
    real(DP), parameter :: HERE = 0.05_DP          !< start of the intersection with the second master [length]
    type(mesh_type) :: mesh
    type(mortar_type) :: mortar
    type(facets_type) :: master
    type(facet_search_type) :: search
    type(error_type), allocatable :: error
    real(DP) :: area(4, 2), gap(4, 2), corner(2)
    integer :: i, k, n_cut(2)
    call lay_cubes(3, mesh)
    mesh%coordinates(1, 9:16) = mesh%coordinates(1, 9:16) - 1
    mesh%coordinates(3, 9:) = mesh%coordinates(3, 9:) - 1.1_DP
    call finalize_mesh(mesh)
    corner = [0.05_DP, -0.05_DP]
    do i = 1, 8
      mesh%coordinates(:2, i) = corner + matmul(reshape([-0.8_DP, 0.4_DP, -0.4_DP, -0.8_DP], [2, 2]), mesh%coordinates(:2, i))
    end do
    call build_facets(mesh, [2, 3], [2, 2], master, error)
    call create_mortar(mesh, [1], [1], [1, 2, 3, 4], mortar, error)
    mortar%is_compliant = is_soft
    call build_facet_search(master, mesh%coordinates, find_search_margin(mortar, 1.0_DP), search)
    do k = 1, 2
      mesh%coordinates(1, :8) = mesh%coordinates(1, :8) + merge(HERE - 1.0e-4_DP, 2.0e-4_DP, k == 1)
      call integrate_mortar(mortar, master, search, .true., mesh%coordinates, 1.0_DP)
      n_cut(k) = mortar%cuts%covers(1)%n
      area(:, k) = mortar%places%area
      gap(:, k) = [(dot_product(mortar%places(i)%normal, evaluate_relative_position(mortar%rows(i), mesh%coordinates)), i=1, 4)]
    end do
    call suite%that('beside a master: it comes to be cut', n_cut(1) == 1 .and. n_cut(2) == 2)
    call suite%that('beside a master: the corner has a row', area(1, 1) > 1.0e-3_DP)
    call suite%near('beside a master: areas', maxval(abs(area(:, 2) - area(:, 1))), 0.0_DP, 2.0e-4_DP)
    call suite%near('beside a master: gaps', maxval(abs(gap(:, 2) - gap(:, 1))), 0.0_DP, 2.0e-4_DP)
  end subroutine check_beside


  !> Under a compliant law a slave face has its rows also if almost none of it is over the master: a force proportional to the area
  !! is not cut off.
  subroutine check_sliver(cover)
    real(DP), intent(in) :: cover                  !< of the face's length [length]
    type(mesh_type) :: mesh
    type(mortar_type) :: mortar
    type(facets_type) :: master
    type(facet_search_type) :: search
    type(error_type), allocatable :: error
    integer :: i
    call lay_cubes(2, mesh)
    mesh%coordinates(1, 9:) = cover - 2 * (1 - mesh%coordinates(1, 9:))
    mesh%coordinates(2, 9:) = 3 * mesh%coordinates(2, 9:) - 1
    mesh%coordinates(3, 9:) = mesh%coordinates(3, 9:) - 1.1_DP
    call finalize_mesh(mesh)
    call build_facets(mesh, [2], [2], master, error)
    call create_mortar(mesh, [1], [1], [1, 2, 3, 4], mortar, error)
    mortar%is_compliant = .true.
    call build_facet_search(master, mesh%coordinates, find_search_margin(mortar, 1.0_DP), search)
    call integrate_mortar(mortar, master, search, .true., mesh%coordinates, 1.0_DP)
    call suite%near('a sliver: area', sum(mortar%places%area, mask=.not. mortar%places%is_barely_covered), cover, 1.0e-8_DP * cover)
    do i = 1, 4
      associate (place => mortar%places(i))
        if (place%facet == 0) cycle
        call suite%near('a sliver: gap', dot_product(place%normal, evaluate_relative_position(mortar%rows(i), mesh%coordinates)), &
          0.1_DP, &
          1.0e-8_DP)
      end associate
    end do
  end subroutine check_sliver

end program test_mortar
