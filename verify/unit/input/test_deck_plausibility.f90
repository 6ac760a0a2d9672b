!> Unit test of deck_plausibility: decimal commas, keywords without a star, sets without members; no note where all is well.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_plausibility
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*NSET, NSET=NONE;*ELSET, ELSET=NONE;*NSET, NSET=STATIC;1;' // &
    '*SOLID SECTION, ELSET=E, MATERIAL=M;*BOUNDARY;1,1;STATIC,2;*MATERIAL, NAME=M;*ELASTIC;210000,0;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;1,1;*END STEP;'
  character(*), parameter :: S = '*STEP;*STATIC;1,1;', END = '*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  type(diagnostic_list_type) :: diagnostics
  type(error_type), allocatable :: error
  call read_sample('*PLASTIC;200,0;300,1;*DENSITY;7.8e-9,20;', model, diagnostics, error)
  call suite%that('integers and names are no slips', .not. allocated(error) .and. diagnostics%n_items == 0)
  call expect_read('*DENSITY;7.8e-9;', model)
  call expect_message('*DENSITY;7,8e-9;', 'decimal commas', is_note=.true.)
  call expect_message('', 'decimal commas', step='*STEP;*STATIC;0,1, 1;*END STEP;', is_note=.true.)
  call expect_message('*NODE;9, 0,5, 0,5, 2,0;', 'decimal commas', is_note=.true.)
  call expect_message('', 'keyword EL FILE without its star', step=S // '*NODE PRINT, NSET=STATIC;U;EL FILE;' // END, &
    is_note=.true.)
  call expect_message('', 'node set ''NONE'' has no members', step=S // '*CLOAD;NONE,1,1.;' // END, is_note=.true.)
  call expect_message('', 'node set ''NONE'' has no members', step=S // '*NODE PRINT, NSET=NONE;U;' // END, is_note=.true.)
  call expect_message('', 'element set ''NONE'' has no members', step=S // '*EL PRINT, ELSET=NONE;S;' // END, is_note=.true.)
  call suite%finish()

contains

  include 'sample_deck.inc'

end program test_deck_plausibility
