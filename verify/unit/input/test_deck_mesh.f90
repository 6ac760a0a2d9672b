!> Unit test of deck_mesh: nodes given again, kinds by type and dialect, sections, leftovers of mesh generators, and refusals.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_mesh
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_deck_mesh, only: is_in_family
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_element_kinds, only: KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, KIND_C3D8R, KIND_C3D10, KIND_CPE4, KIND_CPE4_FULL, &
    KIND_CPS4, &
    KIND_T3D2, FAMILY_SOLID, FAMILY_TRUSS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '*MATERIAL, NAME=M;' &
    // '*ELASTIC;1.,0.;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;', CUBE = ', ELSET=E;1,1,2,3,4,5,6,7,8;', &
    SECTION = '*SOLID SECTION, ELSET=E, MATERIAL=M;', SOLID = '*ELEMENT, TYPE=C3D8' // CUBE // SECTION
  type(suite_type) :: suite
  type(model_type) :: model
  call suite%that('families', is_in_family(KIND_C3D8, FAMILY_SOLID) .and. .not. is_in_family(KIND_C3D8, FAMILY_TRUSS) .and. &
    .not. is_in_family(0, FAMILY_SOLID))
  call check_nodes()
  call check_kinds()
  call check_rows()
  call check_sections()
  call check_leftovers()
  call check_errors()
  call suite%finish()

contains

  !> Systems of coordinates; nodes given again count once, in CalculiX at their later place.
  subroutine check_nodes()
    call expect_read(SOLID // '*NODE, SYSTEM=C;20,2.,90.,5.;*NODE, SYSTEM=S;21,2.,0.,90.;', model)
    call suite%near('cylindrical', maxval(abs(model%mesh%coordinates(:, 9) - [0.0_DP, 2.0_DP, 5.0_DP])), 0.0_DP, 1.0e-15_DP)
    call suite%near('spherical', maxval(abs(model%mesh%coordinates(:, 10) - [0.0_DP, 0.0_DP, 2.0_DP])), 0.0_DP, 1.0e-15_DP)
    call expect_message(SOLID // '*NODE;8,0,1,1;', '1 node more than once, 0 of them with other coordinates', is_note=.true.)
    call expect_read(SOLID // '*NODE;8,0,1,1.5;20,7,7,7;', model, DIALECT_CALCULIX)
    call suite%that('eight and one', model%mesh%n_nodes == 9 .and. model%mesh%node_label(9) == 20)
    call suite%near('the later place', model%mesh%coordinates(3, 8), 1.5_DP, 0.0_DP)
    call suite%near('and the node after it', model%mesh%coordinates(1, 9), 7.0_DP, 0.0_DP)
    call expect_message(SOLID // '*NODE;8,0,1,1.5;', 'defined twice, here at another place')
  end subroutine check_nodes


  !> The kind of one cube by the word of TYPE.
  subroutine expect_kind(type, kind, dialect)
    character(*), intent(in) :: type
    integer, intent(in) :: kind
    integer, intent(in), optional :: dialect
    call expect_read('*ELEMENT, TYPE=' // type // CUBE // SECTION, model, dialect)
    call suite%that(type, model%mesh%kind(1) == kind)
  end subroutine expect_kind


  !> Types, types with letters that are taken off, full integration in CalculiX.
  subroutine check_kinds()
    call expect_kind('C3D8', KIND_C3D8)
    call expect_kind('c3d8', KIND_C3D8_FULL, DIALECT_CALCULIX)
    call expect_kind('C3D8R', KIND_C3D8R, DIALECT_CALCULIX)
    call expect_kind('C3D8H', KIND_C3D8)
    call expect_kind('C3D8RH', KIND_C3D8R)
    call expect_kind('C3D8T', KIND_C3D8)
    call expect_message('*ELEMENT, TYPE=C3D8H' // CUBE // SECTION, 'C3D8H are taken as C3D8.', is_note=.true.)
    call expect_read('*NODE;11,.5,0,0;12,.5,.5,0;13,0,.5,0;14,0,0,.5;15,.5,0,.5;16,0,.5,.5;*ELEMENT, TYPE=C3D10M, ELSET=E;' // &
      '1,1,2,4,5,11,12,13,14,15,16;' // SECTION, model)
    call suite%that('modified tetrahedron', model%mesh%kind(1) == KIND_C3D10)
    call expect_read('*ELEMENT, TYPE=CPE4, ELSET=E;1,1,2,3,4;' // SECTION, model)
    call suite%that('plane', model%mesh%kind(1) == KIND_CPE4)
    call expect_read('*ELEMENT, TYPE=CPE4, ELSET=E;1,1,2,3,4;' // SECTION, model, DIALECT_CALCULIX)
    call suite%that('plane, in full', model%mesh%kind(1) == KIND_CPE4_FULL)
  end subroutine check_kinds


  !> Nodes over several rows; the extra nodes of an old C3D8I.
  subroutine check_rows()
    call expect_read('*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,;6,7;8;' // SECTION, model)
    call suite%that('three rows', all(model%mesh%nodes == [1, 2, 3, 4, 5, 6, 7, 8]))
    call expect_read('*ELEMENT, TYPE=C3D8I, ELSET=E;1,1,2,3,4,5,6,7,8,1,2,3;' // SECTION, model)
    call suite%that('extra nodes', model%mesh%kind(1) == KIND_C3D8I .and. size(model%mesh%nodes) == 8)
    call expect_message(SOLID // '*ELEMENT, TYPE=C3D8, ELSET=E;2,1,2,3,4,5,6,7,8,1;', 'has 9 nodes; its kind has 8')
    call expect_message('*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,7;' // SECTION, 'degenerate: node 7')
    call expect_message('*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,77;' // SECTION, 'There is no node 77.')
    call expect_message(SOLID // '*ELEMENT, TYPE=C3D8, ELSET=E;1,8,7,6,5,4,3,2,1;', 'element 1 is defined twice')
  end subroutine check_rows


  !> Thickness and cross-section; the later section counts.
  subroutine check_sections()
    character(*), parameter :: PLANE = '*ELEMENT, TYPE=CPS4, ELSET=E;1,1,2,3,4;', TRUSS = '*ELEMENT, TYPE=T3D2, ELSET=T;2,1,7;'
    call expect_read(PLANE // SECTION // '.25;' // TRUSS // '*SOLID SECTION, ELSET=T, MATERIAL=M;3.;', model)
    call suite%that('kinds', all(model%mesh%kind == [KIND_CPS4, KIND_T3D2]))
    call suite%near('thickness, area', maxval(abs(model%mesh%section_value - [0.25_DP, 3.0_DP])), 0.0_DP, 0.0_DP)
    call expect_read(PLANE // SECTION, model)
    call suite%near('1 by default', model%mesh%section_value(1), 1.0_DP, 0.0_DP)
    call expect_message(PLANE // SECTION // '0.;', 'must be positive')
    call expect_message(SOLID // '*MATERIAL, NAME=N;*ELASTIC;2.,0.;*SOLID SECTION, ELSET=E, MATERIAL=N;', &
      '1 element had another material', is_note=.true.)
    call expect_message('*ELEMENT, TYPE=C3D8' // CUBE // '*SOLID SECTION, ELSET=F, MATERIAL=M;*ELSET, ELSET=F;', 'no section')
  end subroutine check_sections


  !> Faces and lines of the body without a section are left out; with a node of their own they are an error.
  subroutine check_leftovers()
    call expect_message('*ELEMENT, TYPE=S4, ELSET=F;11,1,2,3,4;' // SOLID, '1 element that is a line or face', is_note=.true.)
    call expect_read('*ELEMENT, TYPE=CPS4, ELSET=F;11,1,2,3,4;*ELEMENT, TYPE=T3D2, ELSET=L;12,1,2;' // SOLID // &
      '*SURFACE, NAME=S;F;', model)
    call suite%that('the body alone', model%mesh%n_elements == 1 .and. model%mesh%element_label(1) == 1)
    call suite%that('its sets', size(model%mesh%element_sets(1)%members) == 0)
    call suite%that('the face below the leftover', model%surfaces(1)%element(1) == 1 .and. model%surfaces(1)%face(1) == 1)
    call expect_message('*NODE;20,9,9,9;*ELEMENT, TYPE=CPS4, ELSET=F;11,1,2,3,20;' // SOLID, 'no section')
    call expect_message('*ELEMENT, TYPE=CPS4, ELSET=F;11,1,2,3,4;*ELEMENT, TYPE=CPS4, ELSET=E;1,1,2,3,4;' // SECTION, &
      'no section')
    call expect_message('*ELEMENT, TYPE=DASHPOTA, ELSET=F;11,1,7;' // SOLID, 'Dashpots resist rates', DIALECT_CALCULIX, &
      is_note=.true.)
    call expect_message('*ELEMENT, TYPE=DASHPOTA, ELSET=F;11,1,7;' // SOLID, 'leave the dashpots out')
  end subroutine check_leftovers


  !> Types that are not supported, each with its replacement; empty decks.
  subroutine check_errors()
    call expect_message(SOLID // '*ELEMENT, TYPE=C3D8P, ELSET=F;11,1,2,3,4,5,6,7,8;', 'Use C3D8, which has a mean dilatation')
    call expect_message(SOLID // '*NODE;20,9,9,9;*ELEMENT, TYPE=S4R, ELSET=F;11,1,2,3,20;', 'no section')
    call expect_message(SOLID // '*ELEMENT, TYPE=CPE5, ELSET=F;11,1,2,3,4,5;*SOLID SECTION, ELSET=F, MATERIAL=M;', &
      'Plane kinds have')
    call expect_message(SOLID // '*ELEMENT, TYPE=GAPCYL, ELSET=F;11,1,7;', 'Use GAPUNI')
    call expect_message('', 'no *ELEMENT card with data')
    call expect_message(SOLID // '*SOLID SECTION, ELSET=E, MATERIAL=X;', 'no material ''X''')
    call expect_message(SOLID // '*ELEMENT, TYPE=C3D8, ELSET=E;x,1,2,3,4,5,6,7,8;', 'number of the element')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_mesh
