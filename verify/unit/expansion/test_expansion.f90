!> Unit test of amontons_expansion: nodes of the deck and solids keep their numbers, and elements without a normal are reported.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_expansion
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use amontons_element_kinds, only: KIND_C3D8, KIND_CSS8
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;11,0,0,0;12,1,0,0;13,1,1,0;14,0,1,0;15,0,0,1;16,1,0,1;17,1,1,1;18,0,1,1;' // &
    '*MATERIAL, NAME=M;*ELASTIC;100.,0.3;*ELEMENT, TYPE=C3D8, ELSET=S;7,11,12,13,14,15,16,17,18;*SOLID SECTION, ELSET=S, ' // &
    'MATERIAL=M;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  call expect_read('*ELEMENT, TYPE=S4, ELSET=E;9,15,16,17,18;*SHELL SECTION, ELSET=E, MATERIAL=M;.1;', model)
  call suite%that('kinds', all(model%mesh%kind == [KIND_C3D8, KIND_CSS8]) .and. all(model%mesh%element_label == [7, 9]))
  call suite%that('nodes of the solid', all(model%mesh%nodes(:8) == [1, 2, 3, 4, 5, 6, 7, 8]))
  call suite%that('eight nodes more', model%mesh%n_nodes == 16 .and. all(model%mesh%node_label(:8) == [11, 12, 13, 14, 15, 16, &
    17, 18]) .and. minval(model%mesh%nodes(9:)) == 9)
  call suite%that('points', model%mesh%n_points == 28)
  call expect_message('*NODE;21,0,0,5;22,1,0,5;23,2,0,5;*ELEMENT, TYPE=S3, ELSET=E;9,21,22,23;' // &
    '*SHELL SECTION, ELSET=E, MATERIAL=M;.1;', 'has no normal')
  call suite%finish()

contains

  include 'sample_deck.inc'

end program test_expansion
