!> Unit test of amontons_mortar_segmentation: planes, cuts of two grids and their integrals.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_mortar_segmentation
  use amontons_errors, only: error_type
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_facets, only: facets_type, build_facets, facet_nodes
  use amontons_kinds, only: DP, PI
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_mortar_segmentation, only: projection_plane_type, segmentation_type, build_segmentation, &
    build_projection_plane, build_projection_planes, project_on_plane, project_facet_corners, is_facing_plane, find_depth, &
    integrate_segments, choose_quadrature_order
  use amontons_polygon_clipping, only: signed_polygon_area, find_flat_coordinates
  use amontons_element_kinds, only: KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D20, FACET_TRI3, FACET_QUAD4, FACET_TRI6, &
    FACET_QUAD8, &
    MAX_FACE_NODES
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: NX = 3, NY = 2
  integer :: kind
  do kind = FACET_TRI3, FACET_QUAD8
    call check_plane(kind)
    call check_cover(kind)
  end do
  call check_order_and_depth()
  call check_body_between()
  call suite%finish()

contains

  include 'sample_surfaces.inc'
  include 'sample_grids.inc'

  !> The plane's axes are orthonormal, normal outward; a facet in its plane has its own area and natural coordinates.
  subroutine check_plane(kind)
    integer, intent(in) :: kind
    type(facets_type) :: slave, master
    type(facet_search_type) :: search
    type(projection_plane_type) :: plane
    type(projection_plane_type), allocatable :: fronts(:), others(:)
    real(DP), allocatable :: x(:, :)
    real(DP) :: Q(3, 3), corners(2, 4), xi(2), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), flat(2, MAX_FACE_NODES), p(2)
    integer :: k, n_nodes, nodes(MAX_FACE_NODES), i
    call make_grids(kind, .true., slave, master, x, search)
    call build_projection_plane(slave, 1, x, plane)
    Q(:, :2) = plane%axes
    Q(:, 3) = plane%normal
    Q = matmul(transpose(Q), Q)
    call suite%near('orthonormal', norm2(Q - reshape([(merge(1.0_DP, 0.0_DP, modulo(i, 4) == 0), i=0, 8)], [3, 3])), 0.0_DP, &
      1.0e-14_DP)
    call suite%near('up', plane%normal(3), 1.0_DP, 1.0e-14_DP)
    call project_facet_corners(plane, slave, 1, x, corners, k)
    call suite%near('the area of the facet', signed_polygon_area(corners(:, :k)), merge(0.5_DP, 1.0_DP, k == 3), 1.0e-14_DP)
    call project_facet_corners(plane, master, 1, x, corners, k)
    call suite%that('a master runs the other way or is turned', abs(signed_polygon_area(corners(:, :k))) > 0.4_DP)
    call facet_nodes(slave, 1, n_nodes, nodes)
    p = project_on_plane(plane, matmul(x(:, nodes(:3)), [0.2_DP, 0.3_DP, 0.5_DP]) + 7 * plane%normal)
    do i = 1, n_nodes
      flat(:, i) = project_on_plane(plane, x(:, nodes(i)))
    end do
    call find_flat_coordinates(kind, flat(:, :n_nodes), p, xi, N, dN)
    call suite%near('over the same point', norm2(project_on_plane(plane, matmul(x(:, nodes(:n_nodes)), N(:n_nodes))) - p), &
      0.0_DP, 1.0e-13_DP)
    fronts = build_projection_planes(master, x)
    others = build_projection_planes(slave, x)
    call suite%that('the master is in front', is_facing_plane(plane, master, 1, fronts(1), 1.0_DP))
    call suite%that('too far', .not. is_facing_plane(plane, master, 1, fronts(1), 0.01_DP))
    call suite%that('a slave is not', .not. is_facing_plane(plane, slave, 2, others(2), 1.0_DP))
  end subroutine check_plane


  !> Flat grids: the cuts of all facets add up to the common area; shares and master integrals agree with it.
  subroutine check_cover(kind)
    integer, intent(in) :: kind
    type(facets_type) :: slave, master
    type(facet_search_type) :: search
    type(segmentation_type) :: segmentation
    real(DP), allocatable :: x(:, :)
    real(DP) :: total, shares, moment(3), master_moment(3)
    integer :: f, s, n_nodes, nodes(MAX_FACE_NODES), n_master, master_nodes(MAX_FACE_NODES), i, j
    call make_grids(kind, .true., slave, master, x, search)
    total = 0
    shares = 0
    do f = 1, slave%n
      call build_segmentation(slave, f, 1.0_DP, master, build_projection_planes(master, x), search, x, 0.5_DP, segmentation)
      if (segmentation%n == 0) cycle
      call integrate_segments(slave, f, x, segmentation%plane, merge(0.5_DP, 1.0_DP, slave%first(f + 1) - slave%first(f) == 3 &
        .or. slave%first(f + 1) - slave%first(f) == 6), segmentation%points, segmentation%segments(:segmentation%n))
      call facet_nodes(slave, f, n_nodes, nodes)
      moment = 0
      master_moment = 0
      do s = 1, segmentation%n
        associate (segment => segmentation%segments(s))
          total = total + signed_polygon_area(segment%cut(:, :segment%n))
          shares = shares + sum(segment%share(:n_nodes))
          call suite%near('distance', segment%distance, 0.05_DP, 1.0e-14_DP)
          call facet_nodes(master, segment%master, n_master, master_nodes)
          do j = 1, n_nodes
            do i = 1, n_master
              master_moment = master_moment + segment%master_integrals(j, i) * x(:, master_nodes(i))
            end do
          end do
          moment = moment + sum(segment%master_integrals(:n_nodes, :n_master)) * [0.0_DP, 0.0_DP, 0.05_DP]
        end associate
      end do
      associate (points => segmentation%points)
        do i = 1, points%n
          moment = moment + points%weight(i) * (segmentation%plane%origin + matmul(segmentation%plane%axes, points%at(:, i)))
        end do
      end associate
      call suite%near('first moments over the masters', norm2(moment - master_moment), 0.0_DP, 1.0e-12_DP)
    end do
    call suite%near('the common area', total, (3 - 0.37_DP) * (2 - 0.21_DP), 1.0e-12_DP)
    call suite%near('is shared among the nodes', shares, total, 1.0e-12_DP)
  end subroutine check_cover


  !> Squares that are no parallelograms and quadratic facets need a finer rule; a line is a ring or has a thickness.
  subroutine check_order_and_depth()
    type(projection_plane_type) :: plane
    real(DP) :: corners(2, 4)
    corners = reshape([real(DP) :: 0, 0, 2, 0, 3, 1, 1, 1], [2, 4])
    associate (plain => choose_quadrature_order(FACET_QUAD4, corners))
      corners(:, 3) = [2.5_DP, 1.4_DP]
      call suite%that('a distorted square needs more points', choose_quadrature_order(FACET_QUAD4, corners) > plain)
      call suite%that('a triangle does not', choose_quadrature_order(FACET_TRI3, corners) <= plain)
    end associate
    plane%depth = 0.3_DP
    call suite%near('thickness', find_depth(plane, [2.0_DP, 1.0_DP, 0.0_DP]), 0.3_DP, 0.0_DP)
    plane%depth = -1
    call suite%near('circle', find_depth(plane, [2.0_DP, 1.0_DP, 0.0_DP]), 4 * PI, 1.0e-14_DP)
  end subroutine check_order_and_depth


  !> A slave facet that looks up, and behind it, three edges below, the lower side of a body: it is seen from within the body, but
  !! not where the body's upper side lies between; that side farther down, or beside the slave, hides nothing.
  subroutine check_body_between()
    call suite%that('in the body', n_segments(-5.0_DP, 0.0_DP) == 1)
    call suite%that('outside, above the body', n_segments(-1.0_DP, 0.0_DP) == 0)
    call suite%that('the upper side is beside it', n_segments(-1.0_DP, 1.5_DP) == 1)
  end subroutine check_body_between


  !> Masters of a unit square at z = 0: a square at z = -3 that looks down, if it is seen; and one that looks up.
  integer function n_segments(upper, beside)
    real(DP), intent(in) :: upper, beside          !< z of the one that looks up, and its shift along x
    type(mesh_type) :: mesh
    type(facets_type) :: slave, master
    type(facet_search_type) :: search
    type(segmentation_type) :: segmentation
    type(error_type), allocatable :: error
    integer, allocatable :: element(:), face(:)
    real(DP), parameter :: SQUARE(3, 4) = reshape([real(DP) :: 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], [3, 4])
    real(DP) :: x(3, 12)
    x = reshape([SQUARE, SQUARE, SQUARE], [3, 12])
    x(3, 5:8) = -3
    x(3, 9:) = upper
    x(1, 9:) = x(1, 9:) + beside
    call mesh_of_facets(FACET_QUAD4, x, reshape([1, 2, 3, 4, 8, 7, 6, 5, 9, 10, 11, 12], [4, 3]), mesh, element, face)
    call build_facets(mesh, element(:1), face(:1), slave, error)
    if (.not. allocated(error)) call build_facets(mesh, element(2:), face(2:), master, error)
    call suite%that('facets', .not. allocated(error))
    call build_facet_search(master, mesh%coordinates, 6.0_DP, search)
    call build_segmentation(slave, 1, 1.0_DP, master, build_projection_planes(master, mesh%coordinates), search, mesh%coordinates, &
      6.0_DP, segmentation)
    n_segments = segmentation%n
  end function n_segments

end program test_mortar_segmentation
