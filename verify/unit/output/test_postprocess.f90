!> Postprocessing: averages of elements at shared nodes, exact linear fields, volumes.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_postprocess
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: element_kind, element_kind_type, KIND_C3D10, KIND_C3D20, KIND_C3D20R, KIND_C3D8, &
    KIND_C3D8_FULL, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, KIND_BEAM_RECT
  use amontons_mesh, only: element_nodes, finalize_mesh, mesh_type
  use amontons_shape_functions, only: node_coordinates, quadrature, shape_functions
  use amontons_postprocess, only: average_at_nodes, integration_point_volumes
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite

  call test_averages(suite)
  call test_linear_field(suite)
  call test_volumes(suite)
  call suite%finish()

contains

  !> Two bricks that share a face, each with its own constant: the mean on the face, the constant elsewhere; a node without
  !! elements gets 0.
  subroutine test_averages(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    real(DP) :: values(2, 16), averages(2, 13)
    mesh%n_nodes = 13
    mesh%n_elements = 2
    mesh%kind = [KIND_C3D8, KIND_C3D8_FULL]
    mesh%first = [1, 9, 17]
    mesh%nodes = [1, 2, 3, 4, 5, 6, 7, 8, 5, 6, 7, 8, 9, 10, 11, 12]
    call finalize_mesh(mesh)
    values(1, :8) = 1
    values(1, 9:) = 5
    values(2, :8) = -2
    values(2, 9:) = 0
    call average_at_nodes(mesh, spread(.false., 1, mesh%n_elements), values, averages)
    call suite%near('first brick alone', maxval(abs(averages(1, :4) - 1)), 0.0_DP, 1.0e-14_DP)
    call suite%near('shared face, 1st component', maxval(abs(averages(1, 5:8) - 3)), 0.0_DP, 1.0e-14_DP)
    call suite%near('shared face, 2nd component', maxval(abs(averages(2, 5:8) + 1)), 0.0_DP, 1.0e-14_DP)
    call suite%near('second brick alone', maxval(abs(averages(1, 9:12) - 5)), 0.0_DP, 1.0e-14_DP)
    call suite%near('node of no element', averages(1, 13), 0.0_DP, 0.0_DP)
  end subroutine test_averages


  !> A linear field is exact at the nodes, if the points of the kind can represent it.
  subroutine test_linear_field(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: KINDS(5) = [KIND_C3D8, KIND_C3D8_FULL, KIND_C3D10, KIND_C3D20, KIND_C3D20R]
    type(mesh_type) :: mesh
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), x(3)
    real(DP), allocatable :: values(:, :), averages(:, :), expected(:)
    integer :: i, p
    do i = 1, size(KINDS)
      call make_mesh(KINDS(i), mesh)
      allocate (values(1, mesh%n_points), averages(1, mesh%n_nodes))
      call quadrature(KINDS(i), p, xi, w)
      do p = 1, mesh%n_points
        call shape_functions(KINDS(i), xi(:, p), N, dN)
        x = matmul(mesh%coordinates, N(:mesh%n_nodes))
        values(1, p) = linear(x)
      end do
      expected = [(linear(mesh%coordinates(:, p)), p=1, mesh%n_nodes)]
      call average_at_nodes(mesh, spread(.false., 1, mesh%n_elements), values, averages)
      call suite%near('linear field, kind ' // achar(48 + KINDS(i)), &
        maxval(abs(averages(1, :) - expected)), 0.0_DP, 1.0e-13_DP)
      deallocate (values, averages)
    end do
  end subroutine test_linear_field


  pure function linear(x) result(value)
    real(DP), intent(in) :: x(3)
    real(DP) :: value
    value = 1 + 2 * x(1) - 3 * x(2) + 0.5_DP * x(3)
  end function linear


  !> The volumes of the points add up to that of the element, sheared and stretched: |det| times the parent's.
  subroutine test_volumes(suite)
    type(suite_type), intent(inout) :: suite
    real(DP), parameter :: PARENT(KIND_BEAM_RECT) = [1 / 6.0_DP, 1.0_DP, 8.0_DP, 8.0_DP, &
      1 / 6.0_DP, 8.0_DP, 8.0_DP, 8.0_DP, 8.0_DP, 1.0_DP, 8.0_DP, 1.0_DP, 8.0_DP]
    type(mesh_type) :: mesh
    type(element_kind_type) :: entry
    real(DP) :: volumes(MAX_ELEMENT_POINTS)
    integer :: kind, n
    do kind = 1, KIND_BEAM_RECT
      call make_mesh(kind, mesh)
      call integration_point_volumes(mesh, 1, n, volumes)
      entry = element_kind(kind)
      call suite%that('number of points', n == entry%n_points)
      call suite%near('volume, kind ' // achar(48 + kind), sum(volumes(:n)), 6 * PARENT(kind), 1.0e-13_DP)
      call suite%that('nothing past the points', all(abs(volumes(n + 1:)) <= 0))
    end do
  end subroutine test_volumes


  !> One element, its parent sheared and stretched to the 6-fold volume.
  subroutine make_mesh(kind, mesh)
    integer, intent(in) :: kind
    type(mesh_type), intent(out) :: mesh
    real(DP), parameter :: MAP(3, 3) = reshape([real(DP) :: &
      1, 0, 0, 0.3_DP, 2, 0, -0.2_DP, 0.4_DP, 3], [3, 3])
    real(DP) :: xi(3, MAX_ELEMENT_NODES)
    type(element_kind_type) :: entry
    integer :: i
    entry = element_kind(kind)
    call node_coordinates(kind, xi)
    mesh%n_nodes = entry%n_nodes
    mesh%n_elements = 1
    mesh%coordinates = matmul(MAP, xi(:, :entry%n_nodes))
    mesh%kind = [kind]
    mesh%first = [1, entry%n_nodes + 1]
    mesh%nodes = [(i, i=1, entry%n_nodes)]
    call finalize_mesh(mesh)
  end subroutine make_mesh

end program test_postprocess
