!> Unit test of amontons_segment_derivatives: derivatives of the integrals over the cuts of two grids, against differences.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_segment_derivatives
  use amontons_errors, only: error_type
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_facets, only: facets_type, build_facets, facet_nodes
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_mortar_segmentation, only: projection_plane_type, segmentation_type, build_segmentation, build_projection_plane, &
    build_projection_planes
  use amontons_polygon_clipping, only: signed_polygon_area
  use amontons_segment_derivatives, only: facet_derivatives_type, facet_outline_type, differentiate_segmentation, &
    differentiate_plane_normal, build_facet_outline, differentiate_edge, MAX_CUT_COORDINATES
  use amontons_element_kinds, only: KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D20, FACET_TRI3, FACET_QUAD4, FACET_TRI6, &
    FACET_QUAD8, &
    MAX_FACE_NODES
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: NX = 3, NY = 2
  integer :: kind
  do kind = FACET_TRI3, FACET_QUAD8
    call check_derivatives(kind)
    call check_edges(kind)
  end do
  call suite%finish()

contains

  include 'sample_surfaces.inc'
  include 'sample_grids.inc'

  !> Derivatives of shares and master integrals by all coordinates, on curved grids, against central differences.
  subroutine check_derivatives(kind)
    integer, intent(in) :: kind
    type(facets_type) :: slave, master
    type(facet_search_type) :: search
    type(segmentation_type) :: segmentation
    type(facet_derivatives_type) :: at_x, plus, minus
    real(DP), allocatable :: x(:, :), y(:, :)
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: f, i, k, c
    call make_grids(kind, .false., slave, master, x, search)
    f = slave%n / 2
    call build_segmentation(slave, f, 1.0_DP, master, build_projection_planes(master, x), search, x, 0.5_DP, segmentation)
    call suite%that('several segments', segmentation%n > 1)
    call differentiate_segmentation(slave, f, master, x, segmentation, at_x)
    do k = 1, size(at_x%nodes)
      do i = 1, 3
        c = 3 * (k - 1) + i
        y = x
        y(i, at_x%nodes(k)) = x(i, at_x%nodes(k)) + STEP
        call build_segmentation(slave, f, 1.0_DP, master, build_projection_planes(master, y), search, y, 0.5_DP, segmentation)
        call differentiate_segmentation(slave, f, master, y, segmentation, plus)
        y(i, at_x%nodes(k)) = x(i, at_x%nodes(k)) - STEP
        call build_segmentation(slave, f, 1.0_DP, master, build_projection_planes(master, y), search, y, 0.5_DP, segmentation)
        call differentiate_segmentation(slave, f, master, y, segmentation, minus)
        if (size(plus%nodes) /= size(at_x%nodes) .or. size(minus%nodes) /= size(at_x%nodes)) then
          call suite%that('the same masters beside it', .false.)
          cycle
        end if
        call suite%near('derivative of the shares', norm2((plus%share - minus%share) / (2 * STEP) &
          - at_x%d_slave_integrals(:, c)), 0.0_DP, 1.0e-7_DP)
        call suite%near('derivative of the master integrals', norm2((plus%master_integrals - minus%master_integrals) &
          / (2 * STEP) - at_x%d_master_integrals(:, :, c)), 0.0_DP, 1.0e-7_DP)
      end do
    end do
    call suite%that('they are not zero', norm2(at_x%d_slave_integrals) > 0.1_DP)
  end subroutine check_derivatives


  !> How the plane turns, and how an edge in it moves across itself, against differences.
  subroutine check_edges(kind)
    integer, intent(in) :: kind
    type(facets_type) :: slave, master
    type(facet_search_type) :: search
    type(projection_plane_type) :: plane, moved
    type(facet_outline_type) :: outline
    real(DP), allocatable :: x(:, :), y(:, :)
    real(DP) :: d_normal(MAX_CUT_COORDINATES, 2), across(2), rate(MAX_CUT_COORDINATES), at(2), turn(2)
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: n, nodes(MAX_FACE_NODES), k, i, c
    call make_grids(kind, .false., slave, master, x, search)
    call build_projection_plane(slave, 2, x, plane)
    d_normal = differentiate_plane_normal(slave, 2, x, plane)
    call facet_nodes(slave, 2, n, nodes)
    do k = 1, n
      do i = 1, 3
        c = 3 * (k - 1) + i
        y = x
        y(i, nodes(k)) = x(i, nodes(k)) + STEP
        call build_projection_plane(slave, 2, y, moved)
        turn = matmul(transpose(plane%axes), moved%normal - plane%normal) / STEP
        call suite%near('the normal turns', norm2(turn - d_normal(c, :)), 0.0_DP, 1.0e-5_DP)
      end do
    end do
    call build_facet_outline(slave, 2, x, plane, d_normal, 0, .false., outline)
    call suite%that('an outline', outline%n == n .and. signed_polygon_area(outline%corners(:, :outline%n_corners)) > 0)
    at = 0.5_DP * (outline%corners(:, 1) + outline%corners(:, 2))
    call differentiate_edge(outline, 3 * n, 1, 2, at, across, rate)
    call suite%near('across the edge', dot_product(across, outline%corners(:, 2) - outline%corners(:, 1)), 0.0_DP, 1.0e-14_DP)
    call suite%that('nodes that are not of the edge alone do not move it in the plane', norm2(rate(:3 * n)) > 0.1_DP)
  end subroutine check_edges

end program test_segment_derivatives
