!> Unit test of amontons_deck_collapsed_elements: hexahedra in all positions as wedges and tetrahedra, quadrilaterals as triangles,
!! their volume, their faces by the numbers of the deck, and invalid ones.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_collapsed_elements
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_element, only: evaluate_element_volume
  use amontons_element_kinds, only: element_kind, element_kind_type, KIND_C3D4, KIND_C3D6, KIND_C3D10, KIND_C3D15, KIND_CPS3, &
    KIND_CPE6, KIND_CAX3, KIND_M3D6, KIND_COH3D6
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_mesh, only: numbered_face, face_number_here
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use amontons_text, only: to_text
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  !> The corners of a unit cube, and the middles between all of them: of i and j < i node 10 i + j.
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '21,.5,0,0;31,.5,.5,0;32,1,.5,0;41,0,.5,0;42,.5,.5,0;43,.5,1,0;51,0,0,.5;52,.5,0,.5;53,.5,.5,.5;54,0,.5,.5;61,.5,0,.5;' // &
    '62,1,0,.5;63,1,.5,.5;64,.5,.5,.5;65,.5,0,1;71,.5,.5,.5;72,1,.5,.5;73,1,1,.5;74,.5,1,.5;75,.5,.5,1;76,1,.5,1;' // &
    '*MATERIAL,NAME=M;*ELASTIC;100.,.3;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*BOUNDARY;1,1,3;*END STEP;'
  character(*), parameter :: SOLID = '*SOLID SECTION,ELSET=E,MATERIAL=M;'
  integer, parameter :: EDGES(2, 12) = reshape([1, 2, 2, 3, 3, 4, 4, 1, 5, 6, 6, 7, 7, 8, 8, 5, 1, 5, 2, 6, 3, 7, 4, 8], [2, 12])
  integer, parameter :: SIDES(4, 6) = reshape([1, 2, 3, 4, 5, 8, 7, 6, 1, 5, 6, 2, 2, 6, 7, 3, 3, 7, 8, 4, 4, 8, 5, 1], [4, 6])
  integer, parameter :: WEDGE(8) = [1, 2, 3, 3, 5, 6, 7, 7], TETRAHEDRON(8) = [1, 2, 3, 3, 5, 5, 5, 5]
  type(suite_type) :: suite
  type(model_type) :: model
  call check_positions()
  call check_plane_kinds()
  call check_layers()
  call check_errors()
  call suite%finish()

contains

  !> A hexahedron has 24 positions: quarter turns about z and x lead to all of them.
  subroutine check_positions()
    integer, parameter :: ABOUT_Z(8) = [2, 3, 4, 1, 6, 7, 8, 5], ABOUT_X(8) = [4, 3, 7, 8, 1, 2, 6, 5]
    integer :: position(8), i, j
    position = [1, 2, 3, 4, 5, 6, 7, 8]
    do i = 1, 12
      do j = 1, 4
        call check_solid('C3D8', WEDGE(position), KIND_C3D6, 0.5_DP)
        call check_solid('C3D8R', TETRAHEDRON(position), KIND_C3D4, 1.0_DP / 6)
        call check_solid('C3D20', WEDGE(position), KIND_C3D15, 0.5_DP)
        call check_solid('C3D20R', TETRAHEDRON(position), KIND_C3D10, 1.0_DP / 6)
        position = position(ABOUT_Z)
      end do
      position = position(ABOUT_X)
      if (modulo(i, 3) == 0) position = position(ABOUT_Z)
    end do
  end subroutine check_positions


  !> One solid: its kind, its volume, and that each face has the corners of the face with this number in the deck.
  subroutine check_solid(type, corners, kind, volume)
    character(*), intent(in) :: type
    integer, intent(in) :: corners(8)
    integer, intent(in) :: kind
    real(DP), intent(in) :: volume
    type(element_kind_type) :: entry
    real(DP) :: found
    integer :: f, k, status, m
    call expect_read('*ELEMENT,TYPE=' // type // ',ELSET=E;7' // nodes_text(corners, type(4:4) == '2') // ';' // SOLID, model)
    call suite%that(type // nodes_text(corners, .false.), model%mesh%kind(1) == kind)
    entry = element_kind(kind)
    m = merge(4, 6, kind == KIND_C3D4 .or. kind == KIND_C3D10)
    associate (mesh => model%mesh)
      call evaluate_element_volume(kind, mesh%coordinates(:, mesh%nodes), 1.0_DP, found, status)
      call suite%near('volume', found, volume, 1.0e-14_DP)
      do f = 1, 6
        k = numbered_face(mesh, 1, f)
        if (k == 0) then
          call suite%that('a face that is a line', n_different(corners(SIDES(:, f))) < 3)
          cycle
        end if
        associate (there => mesh%node_label(mesh%nodes(pack(entry%face_nodes(:, k), entry%face_nodes(:, k) > 0 .and. &
                                                             entry%face_nodes(:, k) <= m))))
          call suite%that('corners of a face', all([(any(there == corners(SIDES(status, f))), status=1, 4)]))
          call suite%that('no other corners', size(there) == n_different(corners(SIDES(:, f))))
        end associate
      end do
    end associate
  end subroutine check_solid


  !> Nodes of an element in its deck.
  function nodes_text(corners, is_quadratic) result(text)
    integer, intent(in) :: corners(8)
    logical, intent(in) :: is_quadratic
    character(:), allocatable :: text
    integer :: i, a(2)
    text = ''
    do i = 1, 8
      text = text // ',' // to_text(corners(i))
    end do
    if (.not. is_quadratic) return
    do i = 1, 12
      a = corners(EDGES(:, i))
      text = text // ',' // to_text(merge(a(1), 10 * maxval(a) + minval(a), a(1) == a(2)))
    end do
  end function nodes_text


  !> Different numbers in a list.
  pure integer function n_different(list)
    integer, intent(in) :: list(:)
    integer :: i
    n_different = count([(.not. any(list(:i - 1) == list(i)), i=1, size(list))])
  end function n_different


  !> Plane elements and membranes: triangles with their edges.
  subroutine check_plane_kinds()
    call expect_read('*ELEMENT,TYPE=CPS4R,ELSET=E;7,1,2,3,3;' // SOLID, model)
    call suite%that('CPS3', model%mesh%kind(1) == KIND_CPS3 .and. all(model%mesh%nodes == [1, 2, 3]))
    call suite%that('its edges', numbered_face(model%mesh, 1, 1) == 1 .and. numbered_face(model%mesh, 1, 2) == 2 .and. &
      numbered_face(model%mesh, 1, 3) == 0 .and. numbered_face(model%mesh, 1, 4) == 3)
    call expect_read('*ELEMENT,TYPE=CPE8R,ELSET=E;7,1,1,2,3,1,21,32,31;' // SOLID, model)
    call suite%that('CPE6', model%mesh%kind(1) == KIND_CPE6)
    call suite%that('its nodes', all(model%mesh%node_label(model%mesh%nodes) == [2, 3, 1, 32, 31, 21]))
    call suite%that('its edges', numbered_face(model%mesh, 1, 1) == 0 .and. numbered_face(model%mesh, 1, 2) == 3 .and. &
      numbered_face(model%mesh, 1, 3) == 1 .and. numbered_face(model%mesh, 1, 4) == 2)
    call expect_read('*ELEMENT,TYPE=CAX4,ELSET=E;7,1,2,2,3;' // SOLID, model)
    call suite%that('CAX3', model%mesh%kind(1) == KIND_CAX3)
    call expect_read('*ELEMENT,TYPE=M3D8,ELSET=E;7,1,2,3,3,21,32,3,31;*MEMBRANE SECTION,ELSET=E,MATERIAL=M;.1;', model)
    call suite%that('M3D6', model%mesh%kind(1) == KIND_M3D6)
    call expect_read('*ELEMENT,TYPE=S4,ELSET=E;7,1,2,3,3;*SHELL SECTION,ELSET=E,MATERIAL=M;.1;', model)
    call suite%that('an edge of a shell', face_number_here(model%mesh, 1, 4) == 3)
    call expect_message('*ELEMENT,TYPE=S4,ELSET=E;7,1,2,3,3;*SHELL SECTION,ELSET=E,MATERIAL=M;.1;', 'is taken as S3', &
      is_note=.true.)
  end subroutine check_plane_kinds


  !> Cohesive elements keep their direction: edges across the layer may not vanish.
  subroutine check_layers()
    character(*), parameter :: GLUE = '*MATERIAL,NAME=G;*ELASTIC,TYPE=TRACTION;1.,1.,1.;*COHESIVE SECTION,ELSET=E,MATERIAL=G,' // &
      'RESPONSE=TRACTION SEPARATION;'
    call expect_read('*ELEMENT,TYPE=COH3D8,ELSET=E;7,1,2,3,3,5,6,7,7;' // GLUE, model)
    call suite%that('COH3D6', model%mesh%kind(1) == KIND_COH3D6)
    call expect_message('*ELEMENT,TYPE=COH3D8,ELSET=E;7,1,2,3,4,1,2,7,8;' // GLUE, 'degenerate: node 1')
  end subroutine check_layers


  !> Elements that stay degenerate.
  subroutine check_errors()
    call expect_message('*ELEMENT,TYPE=C3D8,ELSET=E;7,1,2,3,4,5,5,5,5;' // SOLID, 'degenerate: node 5')
    call expect_message('*ELEMENT,TYPE=C3D8,ELSET=E;7,1,2,3,4,5,6,7,7;' // SOLID, 'degenerate: node 7')
    call expect_message('*ELEMENT,TYPE=CPS4,ELSET=E;7,1,2,1,3;' // SOLID, 'degenerate: node 1')
    call expect_message('*ELEMENT,TYPE=CPS3,ELSET=E;7,1,2,2;' // SOLID, 'degenerate: node 2')
    call expect_message('*ELEMENT,TYPE=CPE8,ELSET=E;7,1,2,3,3,21,32,43,31;' // SOLID, 'degenerate: node 3')
    call expect_message('*ELEMENT,TYPE=C3D20,ELSET=E;7,1,2,3,3,5,6,7,7,21,32,3,31,65,76,7,75,51,62,73,74;' // SOLID, &
      'degenerate: node 3')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_collapsed_elements
