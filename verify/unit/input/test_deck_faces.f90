!> Unit test of deck_faces on four cubes: free and shared faces, faces under dropped elements, elements on one side of a cut.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_faces
  use amontons_deck_faces, only: node_elements_type, find_free_faces, find_omitted_faces, find_side_elements, &
    count_shared_faces
  use amontons_deck_reader, only: reader_type
  use amontons_mesh, only: mesh_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(mesh_type) :: mesh
  type(node_elements_type) :: faces
  call make_cubes(mesh)
  call check_free()
  call check_shared()
  call check_omitted()
  call check_sides()
  call suite%finish()

contains

  !> Cubes 1 and 2 along x, 3 and 4 above them in y: nodes i + 3 (j - 1) + 9 (k - 1), i, j = 1..3, k = 1, 2. S1 is below, S2 above,
  !! S3 towards -y, S4 +x, S5 +y, S6 -x.
  subroutine make_cubes(mesh)
    type(mesh_type), intent(out) :: mesh
    integer :: i, j, n
    mesh%n_nodes = 18
    mesh%n_elements = 4
    mesh%kind = [KIND_C3D8, KIND_C3D8, KIND_C3D8, KIND_C3D8]
    mesh%first = [1, 9, 17, 25, 33]
    allocate (mesh%nodes(0))
    do j = 1, 2
      do i = 1, 2
        n = i + 3 * (j - 1)
        mesh%nodes = [mesh%nodes, n, n + 1, n + 4, n + 3, n + 9, n + 10, n + 13, n + 12]
      end do
    end do
  end subroutine make_cubes


  !> Of cube 1 the faces S4 and S5 are shared; of all four 16 are free.
  subroutine check_free()
    integer, allocatable :: element(:), face(:)
    type(mesh_type) :: broken
    type(node_elements_type) :: others
    call find_free_faces(faces, mesh, [1], element, face)
    call suite%that('one cube', size(face) == 4 .and. all(element == 1) .and. all(face == [1, 2, 3, 6]))
    call find_free_faces(faces, mesh, [1, 2, 3, 4], element, face)
    call suite%that('four cubes', size(face) == 16 .and. count(element == 3) == 4)
    call suite%that('of the last', all(pack(face, element == 4) == [1, 2, 4, 5]))
    broken = mesh
    broken%nodes(3) = 0
    call find_free_faces(others, broken, [1], element, face)
    call suite%that('a missing node: no faces', size(face) == 0)
    call suite%that('and none shared', count_shared_faces(others, broken, [1], [4]) == 0)
  end subroutine check_free


  !> Faces that another element has too.
  subroutine check_shared()
    call suite%that('inside', count_shared_faces(faces, mesh, [1, 2], [4, 6]) == 2)
    call suite%that('one of two', count_shared_faces(faces, mesh, [1, 1], [4, 1]) == 1)
    call suite%that('outside', count_shared_faces(faces, mesh, [1, 4], [3, 2]) == 0)
  end subroutine check_shared


  !> A quadrilateral with and without middle nodes, in another order; one on no face.
  subroutine check_omitted()
    type(reader_type) :: reader
    integer, allocatable :: element(:), face(:)
    integer :: n_without
    reader%omitted_nodes = [13, 10, 11, 14, 5, 6, 3, 2, 1, 2, 3, 4, 1, 2, 11, 9, 17, 17, 17, 17]
    reader%omitted_first = [1, 5, 9, 13, 21]
    call find_omitted_faces(reader, faces, mesh, [1, 2, 3], element, face, n_without)
    call suite%that('two faces', size(face) == 2 .and. n_without == 1)
    call suite%that('top of cube 1, bottom of cube 2', all(element == [1, 2]) .and. all(face == [2, 1]))
    reader%omitted_nodes(13:20) = [1, 2, 5, 4, 17, 17, 17, 17]
    call find_omitted_faces(reader, faces, mesh, [4], element, face, n_without)
    call suite%that('corners come before middle nodes', size(face) == 1 .and. n_without == 0 .and. face(1) == 1)
  end subroutine check_omitted


  !> A cut between left and right halves separates them; a cut of one half of the section does not.
  subroutine check_sides()
    integer, allocatable :: side(:)
    logical :: is_cut
    call find_side_elements(mesh, [1, 3], [4, 4], side, is_cut)
    call suite%that('left half', is_cut .and. size(side) == 2 .and. all(side == [1, 3]))
    call find_side_elements(mesh, [2], [6], side, is_cut)
    call suite%that('around the edge to the other side', .not. is_cut .and. any(side == 1))
    call find_side_elements(mesh, [3], [3], side, is_cut)
    call suite%that('around the other edge', .not. is_cut)
    call find_side_elements(mesh, [1, 2], [5, 5], side, is_cut)
    call suite%that('lower half', is_cut .and. size(side) == 2 .and. all(side == [1, 2]))
  end subroutine check_sides

end program test_deck_faces
