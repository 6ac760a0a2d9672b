!> Unit test of amontons_tributary_areas: areas of faces and their shares at nodes, slave faces and mean edges.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_tributary_areas
  use amontons_kinds, only: DP, PI
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_surfaces, only: surface_type
  use amontons_element_kinds, only: KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D20, FACET_TRI3, FACET_QUAD4, FACET_TRI6, &
    FACET_QUAD8, &
    FACET_LINE2, FACET_LINE3, element_kind, element_kind_type, facet_kind, facet_kind_type
  use amontons_tributary_areas, only: find_mean_edge_length, nodal_area_fractions, element_faces_type, add_nodal_face_areas, &
    integrate_face_area, integrate_nodal_areas, out_of_plane_depth, find_slave_faces, sum_nodal_areas
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: kind
  call check_fractions()
  call check_faces()
  call check_lines()
  do kind = FACET_TRI3, FACET_QUAD8
    call check_grid(kind)
  end do
  call check_slave_faces()
  call suite%finish()

contains

  include 'sample_surfaces.inc'

  !> Shares add up to 1, corners alike, mid-sides alike.
  subroutine check_fractions()
    integer, parameter :: CORNERS(6) = [2, 2, 3, 3, 4, 4], NODES(6) = [2, 3, 3, 6, 4, 8]
    integer :: i
    do i = 1, 6
      associate (share => nodal_area_fractions(CORNERS(i), NODES(i)))
        call suite%near('shares', sum(share), 1.0_DP, 1.0e-14_DP)
        call suite%that('positive', all(share > 0))
        call suite%that('corners alike', all(share(:CORNERS(i)) == share(1)))
      end associate
    end do
  end subroutine check_fractions


  !> A tilted rectangle: vector and number; nodal integrals of a quadratic square pull on the corners.
  subroutine check_faces()
    real(DP) :: x(3, 8), vector(3), area, shares(8)
    integer :: i
    x(:, :4) = reshape([real(DP) :: 0, 0, 0, 2, 0, 0, 2, 3, 4, 0, 3, 4], [3, 4])
    call integrate_face_area(x(:, :4), FACET_QUAD4, 1.0_DP, vector, area)
    call suite%near('area', area, 10.0_DP, 1.0e-13_DP)
    call suite%near('vector', norm2(vector - [0.0_DP, -8.0_DP, 6.0_DP]), 0.0_DP, 1.0e-13_DP)
    do i = 1, 4
      x(:, 4 + i) = 0.5_DP * (x(:, i) + x(:, modulo(i, 4) + 1))
    end do
    shares = integrate_nodal_areas(x, FACET_QUAD8, 1.0_DP)
    call suite%near('corners of a quadratic square', norm2(shares(:4) + 10.0_DP / 12), 0.0_DP, 1.0e-13_DP)
    call suite%near('its mid-sides', norm2(shares(5:) - 10.0_DP / 3), 0.0_DP, 1.0e-13_DP)
    call integrate_face_area(x(:, :3), FACET_TRI3, 1.0_DP, vector, area)
    call suite%near('a triangle', area, 5.0_DP, 1.0e-13_DP)
    shares(:3) = integrate_nodal_areas(x(:, :3), FACET_TRI3, 1.0_DP)
    call suite%near('thirds', norm2(shares(:3) - 5.0_DP / 3), 0.0_DP, 1.0e-13_DP)
  end subroutine check_faces


  !> Edges: a thickness, or the full circle about y.
  subroutine check_lines()
    real(DP) :: x(3, 3), vector(3), area, shares(3)
    x = reshape([real(DP) :: 1, 0, 0, 3, 0, 0, 2, 0, 0], [3, 3])
    call integrate_face_area(x(:, :2), FACET_LINE2, 0.5_DP, vector, area)
    call suite%near('an edge with its thickness', area, 1.0_DP, 1.0e-14_DP)
    call suite%near('its vector is across', abs(vector(2)), 1.0_DP, 1.0e-14_DP)
    call integrate_face_area(x(:, :2), FACET_LINE2, -1.0_DP, vector, area)
    call suite%near('a ring', area, 8 * PI, 1.0e-13_DP)
    shares(:2) = integrate_nodal_areas(x(:, :2), FACET_LINE2, -1.0_DP)
    call suite%near('more at the outer node', shares(2) - shares(1), 2 * PI * 2 * 2 / 6.0_DP, 1.0e-13_DP)
    shares = integrate_nodal_areas(x, FACET_LINE3, 1.0_DP)
    call suite%near('Simpson', norm2(shares - [1.0_DP, 1.0_DP, 4.0_DP] / 3), 0.0_DP, 1.0e-14_DP)
  end subroutine check_lines


  !> The shares of all nodes of a grid are its area, by both ways; quadratic faces note the corners of their mid-sides.
  subroutine check_grid(kind)
    integer, intent(in) :: kind
    type(mesh_type) :: mesh
    type(element_faces_type) :: faces
    integer, allocatable :: element(:), face(:), corners(:, :)
    real(DP), allocatable :: area_vector(:, :), area(:)
    integer :: f, i
    logical :: is_quadratic, is_compliant
    call flat_grid(kind, 3, 2, mesh, element, face)
    is_quadratic = kind == FACET_TRI6 .or. kind == FACET_QUAD8
    allocate (area_vector(3, mesh%n_nodes), area(mesh%n_nodes), corners(2, mesh%n_nodes))
    is_compliant = .false.
    do i = 1, 2
      area_vector = 0
      area = 0
      corners = 0
      do f = 1, size(element)
        call add_nodal_face_areas(mesh, element(f), face(f), is_compliant, area_vector, area, corners)
      end do
      call suite%near('the whole area', sum(area), 6.0_DP, 1.0e-13_DP)
      call suite%near('up', norm2(sum(area_vector, 2)), sum(area_vector(3, :)), 1.0e-13_DP)
      if (.not. is_compliant) call suite%near('the vector of the whole', sum(area_vector(3, :)), 6.0_DP, 1.0e-13_DP)
      call suite%that('mid-sides note their corners', any(corners > 0) .eqv. (is_quadratic .and. .not. is_compliant))
      is_compliant = .true.
    end do
    call suite%that('no share without a face', area(mesh%n_nodes) == 0)
    faces%element = element
    faces%face = face
    area_vector = 0
    area = 0
    call sum_nodal_areas(mesh, faces, 2 * mesh%coordinates, area_vector, area)
    call suite%near('at other coordinates', sum(area), 24.0_DP, 1.0e-12_DP)
    call fold(mesh, 1.0_DP, 0.7_DP)
    area = 0
    call sum_nodal_areas(mesh, faces, mesh%coordinates, area_vector, area)
    call suite%near('a fold keeps the area', sum(area), 6.0_DP, 1.0e-12_DP)
    call shake(mesh, 0.1_DP, 0.02_DP)
    area = 0
    call sum_nodal_areas(mesh, faces, mesh%coordinates, area_vector, area)
    call suite%near('a curved surface: the areas of its faces', sum(area), sum_of_faces(mesh, faces), 1.0e-12_DP)
  end subroutine check_grid


  !> The areas of all faces, one by one.
  function sum_of_faces(mesh, faces) result(total)
    type(mesh_type), intent(in) :: mesh
    type(element_faces_type), intent(in) :: faces
    type(element_kind_type) :: entry
    type(facet_kind_type) :: shape
    real(DP) :: total, vector(3), area
    integer, allocatable :: nodes(:)
    integer :: f
    total = 0
    do f = 1, size(faces%element)
      entry = element_kind(mesh%kind(faces%element(f)))
      shape = facet_kind(entry%face_kind(faces%face(f)))
      nodes = mesh%nodes(mesh%first(faces%element(f)) - 1 + entry%face_nodes(:shape%n_nodes, faces%face(f)))
      call integrate_face_area(mesh%coordinates(:, nodes), entry%face_kind(faces%face(f)), 1.0_DP, vector, area)
      total = total + area
    end do
  end function sum_of_faces


  !> Faces of a surface as they are; of nodes all outer faces with one of them; the mean edge.
  subroutine check_slave_faces()
    type(mesh_type) :: mesh
    type(surface_type) :: surface
    type(element_faces_type) :: faces
    integer, allocatable :: element(:), face(:)
    call flat_grid(FACET_QUAD4, 2, 1, mesh, element, face)
    surface%element = element
    surface%face = face
    call find_slave_faces(mesh, surface, .false., faces)
    call suite%that('as given', all(faces%element == element) .and. all(faces%face == face))
    mesh%coordinates(2, :) = 3 * mesh%coordinates(2, :)
    call suite%near('mean of 1 and 3', find_mean_edge_length(mesh, surface, 77.0_DP), 2.0_DP, 1.0e-14_DP)
    call suite%near('the depth of a face', out_of_plane_depth(mesh, 1), out_of_plane_depth(mesh, 2), 0.0_DP)
    surface%is_node_based = .true.
    surface%nodes = [1]
    surface%element = [integer ::]
    surface%face = [integer ::]
    call suite%near('of nodes the other length', find_mean_edge_length(mesh, surface, 77.0_DP), 77.0_DP, 0.0_DP)
    call find_slave_faces(mesh, surface, .true., faces)
    call suite%that('a node at a corner of one element', size(faces%element) > 0 .and. all(faces%element == 1))
    call suite%that('its top is among its faces', any(faces%face == face(1)))
  end subroutine check_slave_faces

end program test_tributary_areas
