!> Unit test of amontons_deck_foundations: faces of solids, shells and membranes, and rejected cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_foundations
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '*ELEMENT,TYPE=C3D8,ELSET=E;7,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;*ELASTIC;100.,.3;*SOLID SECTION,ELSET=E,MATERIAL=M;'
  character(*), parameter :: SHEET = '*ELEMENT,TYPE=S4,ELSET=S;20,5,6,7,8;*SHELL SECTION,ELSET=S,MATERIAL=M;.1;'
  character(*), parameter :: LAYERS = '*ELEMENT,TYPE=S4,ELSET=S;20,5,6,7,8;*SHELL SECTION,ELSET=S,COMPOSITE;.1,,M;.1,,M;'
  character(*), parameter :: SKIN = '*ELEMENT,TYPE=M3D4,ELSET=S;20,5,6,7,8;*MEMBRANE SECTION,ELSET=S,MATERIAL=M;.1;'
  character(*), parameter :: BEAM = '*ELEMENT,TYPE=B31,ELSET=B;30,1,2;*BEAM SECTION,ELSET=B,MATERIAL=M,SECTION=RECT;.1,.1;0.,1.,0.;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*BOUNDARY;1,1,2;*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_faces()
  call check_errors()
  call suite%finish()

contains

  !> Elements, faces and stiffnesses.
  subroutine check_faces()
    call expect_read('*FOUNDATION;E,F3,2.5;7,F1,4.;', model)
    call suite%that('two faces', size(model%foundations) == 2)
    call suite%that('of the element', all(model%foundations%element == 1) .and. all(model%foundations%face == [3, 1]))
    call suite%near('their stiffness', norm2(model%foundations%stiffness - [2.5_DP, 4.0_DP]), 0.0_DP, 0.0_DP)
    call expect_read(SHEET // '*FOUNDATION;S,F,1.;', model)
    call suite%that('a shell', size(model%foundations) == 1 .and. model%foundations(1)%face == 1)
    call expect_read(LAYERS // '*FOUNDATION;S,F,1.;', model)
    call suite%that('its lowest layer', size(model%foundations) == 1 .and. model%mesh%layer(model%foundations(1)%element) == 1)
    call expect_read(SKIN // '*FOUNDATION;S,F,1.;', model)
    call suite%that('a membrane', size(model%foundations) == 1)
  end subroutine check_faces


  !> What is refused.
  subroutine check_errors()
    call expect_message('*FOUNDATION;E,F7,1.;', 'takes no foundation F7')
    call expect_message('*FOUNDATION;E,F,1.;', 'takes no foundation F')
    call expect_message(SHEET // '*FOUNDATION;S,F1,1.;', 'takes no foundation F1')
    call expect_message(BEAM // '*FOUNDATION;B,FX,1.;', 'SPRING1')
    call expect_message('*FOUNDATION;E,F1,0.;', 'must be positive')
    call expect_message('*FOUNDATION;E,F1;', 'stiffness of the foundation')
    call expect_message('*FOUNDATION;X,F1,1.;', 'X')
    call expect_message('*FOUNDATION;E,F1,1.;', 'CalculiX has no *FOUNDATION', DIALECT_CALCULIX)
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_foundations
