!> Tests of the exterior: free faces, bodies, patches and measures of cubes, with and without nodes that count as one.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_exterior_surface
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8, KIND_CPE4
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_facets, only: facets_type, build_facets
  use amontons_exterior_surface, only: exterior_type, build_exterior, measure_faces, depths_below, reached_depth
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: NO_DUPLICATES(2, 0) = reshape([integer ::], [2, 0])
  call check_row_of_cubes(suite)
  call check_absent_element(suite)
  call check_duplicates(suite)
  call check_bend(suite)
  call check_plane(suite)
  call suite%finish()

contains

  !> Three cubes 1 x 1 x 0.5 in a row along x; the third has nodes of its own, at a distance.
  subroutine make_cubes(gap, mesh)
    real(DP), intent(in) :: gap                    !< before the third cube [length]
    type(mesh_type), intent(out) :: mesh
    integer :: i, base
    mesh%n_nodes = 20
    mesh%n_elements = 3
    allocate (mesh%coordinates(3, 20))
    do i = 0, 4                                    ! five sections of four nodes
      base = 4 * i
      mesh%coordinates(1, base + 1:base + 4) = [1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP] * (real(i, DP) - merge(1.0_DP - gap, 0.0_DP, i > 2))
      mesh%coordinates(2, base + 1:base + 4) = [0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP]
      mesh%coordinates(3, base + 1:base + 4) = [0.0_DP, 0.0_DP, 0.5_DP, 0.5_DP]
    end do
    mesh%kind = [KIND_C3D8, KIND_C3D8, KIND_C3D8]
    mesh%first = [1, 9, 17, 25]
    mesh%nodes = [(i, i=1, 8), (i, i=5, 12), (i, i=13, 20)]
    mesh%element_label = [1, 2, 3]
    mesh%node_label = [(i, i=1, 20)]
    call finalize_mesh(mesh)
  end subroutine make_cubes


  !> Two joined cubes have ten free faces, the single one six; sides of joined cubes in a plane are one patch.
  subroutine check_row_of_cubes(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(exterior_type) :: exterior
    type(facets_type) :: facets
    type(error_type), allocatable :: error
    integer :: f
    call make_cubes(0.25_DP, mesh)
    call build_exterior(mesh, spread(.false., 1, 3), NO_DUPLICATES, exterior)
    call suite%that('free faces', exterior%n == 16)
    call suite%that('bodies', exterior%n_bodies == 2)
    call suite%that('body of the joined cubes', all(exterior%body == merge(1, 2, exterior%element < 3)))
    call suite%that('bodies of elements', all(exterior%body_of_element == [1, 1, 2]))
    call suite%that('patches: six sides of each', exterior%n_patches == 12)
    call suite%near('sum of the areas', sum(exterior%area), 7.0_DP + 4.0_DP, 1.0e-14_DP)
    call suite%near('closed surface', maxval(abs(matmul(exterior%normal, exterior%area))), 0.0_DP, 1.0e-14_DP)
    call suite%near('outward', minval([(dot_product(exterior%normal(:, f), exterior%centre(:, f) &
      - merge([1.0_DP, 0.5_DP, 0.25_DP], [2.75_DP, 0.5_DP, 0.25_DP], exterior%body(f) == 1)), f=1, 16)]), 0.25_DP, 1.0e-14_DP)
    do f = 1, exterior%n
      call suite%near('depth', exterior%depth(f), merge(0.5_DP, 1.0_DP, abs(exterior%normal(3, f)) > 0.5_DP), 1.0e-14_DP)
    end do
    call build_facets(mesh, exterior%element, exterior%face, facets, error)
    call suite%that('facets', .not. allocated(error))
    call suite%near('depths below facets', maxval(abs(depths_below(mesh, facets) - exterior%depth)), 0.0_DP, 1.0e-14_DP)
    call suite%near('reached by an element', reached_depth(0.5_DP, 2.0_DP, 0.1_DP), 0.5_DP, 0.0_DP)
    call suite%near('reached by a long edge', reached_depth(0.5_DP, 2.0_DP, 0.7_DP), 0.7_DP, 0.0_DP)
    call suite%near('not through the body', reached_depth(0.5_DP, 2.0_DP, 7.0_DP), 2.0_DP, 0.0_DP)
    mesh%coordinates(3, :) = 2 * mesh%coordinates(3, :)
    call measure_faces(mesh, mesh%coordinates, exterior)
    call suite%near('depth of the stretched cubes', maxval(abs(exterior%depth - 1.0_DP)), 0.0_DP, 1.0e-14_DP)
  end subroutine check_row_of_cubes


  !> Without the second cube the first one has six free faces; elements out of the model belong to no body.
  subroutine check_absent_element(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(exterior_type) :: exterior
    call make_cubes(0.25_DP, mesh)
    call build_exterior(mesh, [.false., .true., .false.], NO_DUPLICATES, exterior)
    call suite%that('free faces without an element', exterior%n == 12 .and. all(exterior%element /= 2))
    call suite%that('no body', exterior%body_of_element(2) == 0)
  end subroutine check_absent_element


  !> Nodes on both sides of a cut count as one: the faces of the cut are no free faces, and the halves are one body.
  subroutine check_duplicates(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(exterior_type) :: exterior
    call make_cubes(0.0_DP, mesh)
    call build_exterior(mesh, spread(.false., 1, 3), reshape([9, 13, 10, 14, 11, 15, 12, 16], [2, 4]), exterior)
    call suite%that('free faces of the cut row', exterior%n == 14)
    call suite%that('one body', exterior%n_bodies == 1)
    call suite%that('six patches', exterior%n_patches == 6)
  end subroutine check_duplicates


  !> A row bent by 30 degrees keeps its patches, one bent by 50 degrees has a crease at the bend.
  subroutine check_bend(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(exterior_type) :: exterior
    real(DP), parameter :: DEGREE = acos(-1.0_DP) / 180
    real(DP) :: angle
    integer :: i
    do i = 0, 1
      angle = real(30 + 20 * i, DP) * DEGREE
      call make_cubes(3.0_DP, mesh)
      mesh%coordinates(1, 9:12) = 1 + cos(angle) - mesh%coordinates(3, 9:12) * sin(angle)
      mesh%coordinates(3, 9:12) = sin(angle) + mesh%coordinates(3, 9:12) * cos(angle)
      call build_exterior(mesh, spread(.false., 1, 3), NO_DUPLICATES, exterior)
      call suite%that('patches of the bent row', maxval(exterior%patch, mask=exterior%body == 1) == merge(6, 8, i == 0))
    end do
  end subroutine check_bend


  !> A square of plane elements: four free edges, measured by their length.
  subroutine check_plane(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(exterior_type) :: exterior
    mesh%n_nodes = 4
    mesh%n_elements = 1
    mesh%coordinates = reshape(real([0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0], DP), [3, 4])
    mesh%kind = [KIND_CPE4]
    mesh%first = [1, 5]
    mesh%nodes = [1, 2, 3, 4]
    mesh%element_label = [1]
    mesh%node_label = [1, 2, 3, 4]
    call finalize_mesh(mesh)
    call build_exterior(mesh, [.false.], NO_DUPLICATES, exterior)
    call suite%that('edges', exterior%n == 4 .and. exterior%n_patches == 4)
    call suite%near('lengths', maxval(abs(exterior%area - real([2, 1, 2, 1], DP))), 0.0_DP, 1.0e-14_DP)
    call suite%near('normal of the right edge', norm2(exterior%normal(:, 2) - real([1, 0, 0], DP)), 0.0_DP, 1.0e-14_DP)
    call suite%near('depths', maxval(abs(exterior%depth - real([1, 2, 1, 2], DP))), 0.0_DP, 1.0e-14_DP)
  end subroutine check_plane

end program test_exterior_surface
