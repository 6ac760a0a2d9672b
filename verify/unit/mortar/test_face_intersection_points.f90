!> Tests of the integration points on facing surfaces: integrals over the intersections, master points, and normals.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_face_intersection_points
  use amontons_kinds, only: DP, PI
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D20, KIND_CAX4, FACET_TRI3, FACET_QUAD4, FACET_TRI6, &
    FACET_QUAD8, MAX_FACE_NODES
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_shape_functions, only: facet_shapes
  use amontons_facets, only: facets_type, build_facets, facet_nodes
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_face_intersection_points, only: facing_point_type, find_facing_points, evaluate_face_normal
  use amontons_contact_integration_points, only: nearest_point
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_integrals(FACET_TRI3, 'triangles')
  call check_integrals(FACET_QUAD4, 'squares')
  call check_integrals(FACET_TRI6, 'quadratic triangles')
  call check_integrals(FACET_QUAD8, 'quadratic squares')
  call check_order()
  call check_fold()
  call check_wedge()
  call check_normal(FACET_QUAD4)
  call check_normal(FACET_QUAD8)
  call check_normal(FACET_TRI6)
  call check_nearest()
  call suite%finish()

contains

  !> A unit square above one shifted by (0.3, 0.2) and 0.1 below, normals opposed: the intersection is 0.7 by 0.8.
  subroutine two_sheets(kind, mesh, slave, master)
    integer, intent(in) :: kind                    !< FACET_...
    type(mesh_type), intent(out) :: mesh
    type(facets_type), intent(out) :: slave, master
    type(error_type), allocatable :: error
    real(DP) :: grid(3, 9)
    integer, allocatable :: corners(:, :), element(:), face(:)
    integer :: i, j, n
    grid = reshape([((0.5_DP * real(i, DP), 0.5_DP * real(j, DP), 0.0_DP, i=0, 2), j=0, 2)], [3, 9])
    select case (kind)                             ! numbers of the grid: 7 8 9 over 4 5 6 over 1 2 3
    case (FACET_TRI3)
      corners = reshape([1, 3, 9, 1, 9, 7], [3, 2])
    case (FACET_QUAD4)
      corners = reshape([1, 3, 9, 7], [4, 1])
    case (FACET_TRI6)
      corners = reshape([1, 3, 9, 2, 6, 5, 1, 9, 7, 5, 8, 4], [6, 2])
    case default
      corners = reshape([1, 3, 9, 7, 2, 6, 8, 4], [8, 1])
    end select
    n = size(corners, 2)
    corners = reshape([turned(corners), corners + 9], [size(corners, 1), 2 * n])
    call mesh_of_facets(kind, reshape([grid, grid + spread([0.3_DP, 0.2_DP, -0.1_DP], 2, 9)], [3, 18]), corners, mesh, element, &
      face)
    call build_facets(mesh, element(:n), face(:n), slave, error)
    if (.not. allocated(error)) call build_facets(mesh, element(n + 1:), face(n + 1:), master, error)
    if (allocated(error)) call suite%that('facets: ' // error%message, .false.)
  end subroutine two_sheets


  !> The same facets seen from below: corners in the opposite sense, mid-side nodes between them.
  pure function turned(corners) result(other)
    integer, intent(in) :: corners(:, :)
    integer :: other(size(corners, 1), size(corners, 2))
    integer :: m
    m = size(corners, 1)
    select case (m)
    case (3, 4)
      other = corners(m:1:-1, :)
    case (6)
      other = corners([3, 2, 1, 5, 4, 6], :)
    case default
      other = corners([4, 3, 2, 1, 7, 6, 5, 8], :)
    end select
  end function turned


  !> All points of a slave surface against a master.
  subroutine find(mesh, slave, master, depth, points, n)
    type(mesh_type), intent(in) :: mesh
    type(facets_type), intent(in) :: slave, master
    real(DP), intent(in) :: depth
    type(facing_point_type), allocatable, intent(out) :: points(:)
    integer, intent(out) :: n
    type(facet_search_type) :: search
    call build_facet_search(master, mesh%coordinates, 5.0_DP, search)
    call find_facing_points(slave, spread(depth, 1, slave%n), master, search, mesh%coordinates, 3.0_DP, points, n)
  end subroutine find


  !> Position of a point of a facet.
  pure function place(facets, mesh, f, xi) result(x)
    type(facets_type), intent(in) :: facets
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: f
    real(DP), intent(in) :: xi(2)
    real(DP) :: x(3), N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: n, nodes(MAX_FACE_NODES)
    call facet_nodes(facets, f, n, nodes)
    call facet_shapes(facets%kind(f), xi, N_i, dN, ddN)
    x = matmul(mesh%coordinates(:, nodes(:n)), N_i(:n))
  end function place


  !> Polynomials up to degree 5 over the intersection; the master point is straight below.
  subroutine check_integrals(kind, name)
    integer, intent(in) :: kind
    character(*), intent(in) :: name
    type(mesh_type) :: mesh
    type(facets_type) :: slave, master
    type(facing_point_type), allocatable :: points(:)
    real(DP) :: x(3), below(3), total, worst
    integer :: n, a, b, q
    call two_sheets(kind, mesh, slave, master)
    call find(mesh, slave, master, 1.0_DP, points, n)
    worst = 0.0_DP
    do q = 1, n
      x = place(slave, mesh, points(q)%slave, points(q)%at)
      below = place(master, mesh, points(q)%master, points(q)%xi)
      worst = max(worst, norm2(x - below - [0.0_DP, 0.0_DP, 0.1_DP]))
    end do
    call suite%near(name // ': the point in front', worst, 0.0_DP, 1.0e-12_DP)
    do a = 0, 5
      do b = 0, 5 - a
        total = 0.0_DP
        do q = 1, n
          x = place(slave, mesh, points(q)%slave, points(q)%at)
          total = total + points(q)%area * x(1)**a * x(2)**b
        end do
        call suite%near(name // ': integral of a polynomial', total, (1 - 0.3_DP**(a + 1)) / real(a + 1, DP) &
          * (1 - 0.2_DP**(b + 1)) / real(b + 1, DP), 1.0e-13_DP)
      end do
    end do
  end subroutine check_integrals


  !> The order of the points: four triangles about the middle of the intersection, in each the centre first, then near its corners.
  subroutine check_order()
    type(mesh_type) :: mesh
    type(facets_type) :: slave, master
    type(facing_point_type), allocatable :: points(:)
    real(DP) :: x(3)
    integer :: n
    call two_sheets(FACET_QUAD4, mesh, slave, master)
    call find(mesh, slave, master, 1.0_DP, points, n)
    call suite%that('four triangles of seven points', n == 28)
    x = place(slave, mesh, 1, points(2)%at)        ! the second point is nearest to the middle of the intersection
    call suite%near('second point', norm2(x(:2) - [0.65_DP, 0.6_DP]), &
      minval([(near_middle(slave, mesh, points(n)%at), n=1, 28)]), 1.0e-14_DP)
  end subroutine check_order


  !> Distance from the middle of the intersection.
  real(DP) function near_middle(slave, mesh, at) result(distance)
    type(facets_type), intent(in) :: slave
    type(mesh_type), intent(in) :: mesh
    real(DP), intent(in) :: at(2)
    real(DP) :: x(3)
    x = place(slave, mesh, 1, at)
    distance = norm2(x(:2) - [0.65_DP, 0.6_DP])
  end function near_middle


  !> Two masters one behind the other: only the nearer one counts.
  subroutine check_fold()
    type(mesh_type) :: mesh
    type(facets_type) :: slave, master
    type(facing_point_type), allocatable :: points(:)
    type(error_type), allocatable :: error
    real(DP) :: grid(3, 4), x(3, 12)
    integer, allocatable :: element(:), face(:)
    integer :: n
    grid = reshape([0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP], [3, 4])
    x(:, :4) = grid
    x(:, 5:8) = grid
    x(:, 9:) = grid
    x(3, 5:8) = -0.5_DP
    x(3, 9:) = -0.1_DP
    call mesh_of_facets(FACET_QUAD4, x, reshape([4, 3, 2, 1, 5, 6, 7, 8, 9, 10, 11, 12], [4, 3]), mesh, element, face)
    call build_facets(mesh, element(:1), face(:1), slave, error)
    if (.not. allocated(error)) call build_facets(mesh, element(2:), face(2:), master, error)
    if (allocated(error)) call suite%that('facets: ' // error%message, .false.)
    call find(mesh, slave, master, 1.0_DP, points, n)
    call suite%that('the nearer master', all(points(:n)%master == 2))
    call suite%near('its area', sum(points(:n)%area), 1.0_DP, 1.0e-13_DP)
  end subroutine check_fold


  !> Edges of axisymmetric elements: the area is that of the ring pi (1.75^2 - 1.25^2), the moment of r that of r^2.
  subroutine check_wedge()
    type(mesh_type) :: mesh
    type(facets_type) :: slave, master
    type(facing_point_type), allocatable :: points(:)
    type(error_type), allocatable :: error
    real(DP) :: moment, r
    integer :: n, q
    mesh%n_nodes = 8
    mesh%n_elements = 2
    mesh%coordinates = reshape([1.0_DP, 0.0_DP, 0.0_DP, 1.75_DP, 0.0_DP, 0.0_DP, 1.75_DP, 1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, &
      1.25_DP, 1.0_DP, 0.0_DP, 2.0_DP, 1.0_DP, 0.0_DP, 2.0_DP, 2.0_DP, 0.0_DP, 1.25_DP, 2.0_DP, 0.0_DP], [3, 8])
    mesh%node_label = [(n, n=1, 8)]
    mesh%element_label = [1, 2]
    mesh%kind = [KIND_CAX4, KIND_CAX4]
    mesh%first = [1, 5, 9]
    mesh%nodes = [(n, n=1, 8)]
    call finalize_mesh(mesh)
    call build_facets(mesh, [2], [1], slave, error)
    if (.not. allocated(error)) call build_facets(mesh, [1], [3], master, error)
    if (allocated(error)) call suite%that('facets: ' // error%message, .false.)
    call find(mesh, slave, master, -1.0_DP, points, n)
    moment = 0.0_DP
    do q = 1, n
      r = 1.25_DP + 0.375_DP * (points(q)%at(1) + 1)
      moment = moment + points(q)%area * r
    end do
    call suite%near('ring: area', sum(points(:n)%area), PI * (1.75_DP**2 - 1.25_DP**2), 1.0e-12_DP)
    call suite%near('ring: moment', moment, 2 * PI / 3 * (1.75_DP**3 - 1.25_DP**3), 1.0e-12_DP)
  end subroutine check_wedge


  !> The normal of an oblique plane face: the cross product of its edges.
  subroutine check_normal(kind)
    integer, intent(in) :: kind
    type(mesh_type) :: mesh
    type(facets_type) :: master
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP) :: n(3)
    call flat_grid(kind, 2, 1, mesh, element, face)
    call shake(mesh, 0.0_DP, 0.0_DP)
    call fold(mesh, -1.0_DP, 0.3_DP)
    call build_facets(mesh, element, face, master, error)
    if (allocated(error)) call suite%that('facets: ' // error%message, .false.)
    n = evaluate_face_normal(master, mesh%coordinates, 1, [0.3_DP, 0.2_DP])
    call suite%near('normal of a face', norm2(n - [sin(0.3_DP), 0.0_DP, cos(0.3_DP)]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_normal


  !> Of two equally near points, on the two sides of a diagonal, the first, independent of rounding.
  subroutine check_nearest()
    real(DP), parameter :: AT(2) = [0.3_DP, 0.3_DP], FAR(2) = [0.9_DP, 0.8_DP]
    real(DP) :: pair(2, 2)
    integer :: i
    pair = reshape([0.1_DP, 0.4_DP, 0.4_DP, 0.1_DP], [2, 2])
    do i = -2, 2
      pair(1, 2) = 0.4_DP + real(i, DP) * 1.0e-15_DP
      call suite%that('the first of equally near points', nearest_point(reshape([FAR, pair], [2, 3]), AT) == 2)
    end do
    pair(1, 2) = 0.4_DP - 1.0e-6_DP
    call suite%that('the nearer of two points', nearest_point(reshape([FAR, pair], [2, 3]), AT) == 3)
    call suite%that('no point', nearest_point(pair(:, :0), AT) == 0)
  end subroutine check_nearest


  include 'sample_surfaces.inc'

end program test_face_intersection_points
