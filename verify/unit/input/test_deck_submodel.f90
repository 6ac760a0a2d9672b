!> Unit test of deck_submodel: nodes, file and tolerances of SUBMODEL, the global step of *BOUNDARY and *TEMPERATURE, how long they
!! act, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_submodel
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: SHEET = '*NODE;11,5,0,0;12,6,0,0;13,6,1,0;14,5,1,0;*ELEMENT, TYPE=S4, ELSET=SH;2,11,12,13,14;' // &
    '*SHELL SECTION, ELSET=SH, MATERIAL=M;.1;'
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '*NSET, NSET=CUT;1,2,3,4;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL, NAME=M;*ELASTIC;50.,0.;' // &
    '*SOLID SECTION, ELSET=E, MATERIAL=M;'
  character(*), parameter :: STEP_PART = ''
  character(*), parameter :: CUT = '*SUBMODEL, INPUT=g.frd;CUT;'
  character(*), parameter :: DRIVEN = '*STEP;*STATIC;*BOUNDARY, SUBMODEL, STEP=2;CUT,1,3;*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_cards()
  call check_global_set()
  call check_propagation()
  call check_temperatures()
  call check_errors()
  call suite%finish()

contains

  !> Nodes, file and tolerances.
  subroutine check_cards()
    call expect_read(CUT // DRIVEN, model)
    associate (s => model%submodels(1))
      call suite%that('nodes and file', all(s%nodes == [1, 2, 3, 4]) .and. s%path == 'g.frd' .and. s%is_exterior_error)
    end associate
    call expect_read('*SUBMODEL, GLOBAL=g.vtkhdf, EXTERIOR TOLERANCE=.1, ABSOLUTE EXTERIOR TOLERANCE=2.;1,CUT;*SUBMODEL, ' // &
      'INPUT=h.frd, TYPE=NODE, ABSOLUTE EXTERIOR TOLERANCE=3.;8,7;' // DRIVEN, model)
    associate (s => model%submodels)
      call suite%that('two cards', size(s) == 2 .and. all(s(2)%nodes == [7, 8]) .and. s(1)%path == 'g.vtkhdf')
      call suite%near('tolerance', s(1)%exterior_tolerance, 0.1_DP, 0.0_DP)
      call suite%near('absolute', s(1)%absolute_tolerance, 2.0_DP, 0.0_DP)
      call suite%that('the absolute one alone', s(2)%exterior_tolerance > 1.0e300_DP .and. s(2)%absolute_tolerance < 4)
    end associate
    call expect_read(CUT // DRIVEN, model, DIALECT_CALCULIX)
    call suite%that('calculix: any distance', .not. model%submodels(1)%is_exterior_error)
    associate (loads => model%steps(1)%prescribed)
      call suite%that('twelve displacements of step 2', size(loads) == 12 .and. all(loads%global_step == 2) .and. &
        all(loads%is_from_current) .and. all(loads%line > 0))
    end associate
    call expect_read(CUT // '*STEP;*STATIC;*BOUNDARY, SUBMODEL, DATA SET=3, TIMESCALE;CUT,2;*END STEP;', model)
    call suite%that('data set', all(model%steps(1)%prescribed%global_step == -3) .and. all(model%steps(1)%prescribed%dof == 2) &
      .and. all(model%steps(1)%prescribed%is_time_scaled))
  end subroutine check_cards


  !> Numbers of global elements that this deck does not have, also by GENERATE.
  subroutine check_global_set()
    call expect_read('*SUBMODEL, INPUT=g.frd, GLOBAL ELSET=G;CUT;*ELSET, ELSET=G;900,17;*ELSET, ELSET=g, GENERATE;100,104,2;' // &
      DRIVEN, model)
    call suite%that('global elements', all(model%submodels(1)%global_labels == [17, 100, 102, 104, 900]))
    call expect_read('*SUBMODEL, INPUT=g.vtkhdf, GLOBAL ELSET=G;CUT;' // DRIVEN, model)
    call suite%that('a set of the file', .not. allocated(model%submodels(1)%global_labels))
    call expect_message('*SUBMODEL, INPUT=g.frd, GLOBAL ELSET=G;CUT;*ELSET, ELSET=G;E;' // DRIVEN, 'not names of sets')
    call expect_message(CUT // '*ELSET, ELSET=G;900;' // DRIVEN, 'no element 900')
  end subroutine check_global_set


  !> A driven displacement that no later step gives stays where it is; OP=NEW releases it; a value of the deck starts there.
  subroutine check_propagation()
    call expect_read(CUT // DRIVEN // '*STEP;*STATIC;*END STEP;*STEP;*STATIC;*BOUNDARY;CUT,1,1,.5;*END STEP;*STEP;*STATIC;' // &
      '*BOUNDARY, OP=NEW;CUT,1,3;*BOUNDARY, SUBMODEL, STEP=1;1,1;*END STEP;*STEP;*STATIC;*BOUNDARY, OP=NEW, SUBMODEL, STEP=3;' // &
      '1,1;*END STEP;', model)
    associate (steps => model%steps)
      call suite%that('kept', all(steps(2)%prescribed%is_held) .and. all(steps(2)%prescribed%global_step == 0))
      call suite%that('by the deck', count(.not. steps(3)%prescribed%is_held) == 4 .and. &
        all(pack(steps(3)%prescribed%is_from_current, .not. steps(3)%prescribed%is_held)))
      call suite%that('one driven again', count(steps(4)%prescribed%global_step == 1) == 1 .and. size(steps(4)%prescribed) == 12)
      call suite%that('the others released', size(steps(5)%prescribed) == 1 .and. steps(5)%prescribed(1)%global_step == 3)
    end associate
  end subroutine check_propagation


  !> Temperatures.
  subroutine check_temperatures()
    call expect_read(CUT // '*STEP;*STATIC;*TEMPERATURE, SUBMODEL, STEP=1;CUT;2,;*END STEP;*STEP;*STATIC;*TEMPERATURE;1,5.;' // &
      '*END STEP;', model)
    call suite%that('four temperatures', size(model%steps(1)%temperatures) == 4 .and. &
      all(model%steps(1)%temperatures%global_step == 1))
    call suite%that('then one', size(model%steps(2)%temperatures) == 1 .and. model%steps(2)%temperatures(1)%global_step == 0 .and. &
      model%steps(2)%temperatures(1)%is_from_current)
    call expect_message(CUT // '*STEP;*STATIC;*TEMPERATURE, SUBMODEL, STEP=1;CUT,7.;*END STEP;', 'node or node set alone')
    call expect_message(CUT // '*STEP;*STATIC;*TEMPERATURE, SUBMODEL, STEP=1;8;*END STEP;', 'belongs to no *SUBMODEL')
  end subroutine check_temperatures


  !> What is refused.
  subroutine check_errors()
    character(*), parameter :: BEGIN = '*STEP;*STATIC;', END = '*END STEP;'
    call expect_message('*SUBMODEL;CUT;' // DRIVEN, 'results of the global model are not named')
    call expect_message('*SUBMODEL, INPUT=g.frd;' // DRIVEN, 'names no nodes')
    call expect_message('*SUBMODEL, INPUT=g.frd;NOT;' // DRIVEN, 'no node or node set')
    call expect_message(CUT // '*SUBMODEL, INPUT=g.frd;4;' // DRIVEN, 'belong to another')
    call expect_message('*SUBMODEL, INPUT=g.frd, EXTERIOR TOLERANCE=-1.;CUT;' // DRIVEN, '0 or more')
    call expect_message('*SUBMODEL, INPUT=g.frd, TYPE=SURFACE;CUT;' // DRIVEN, 'Stresses are not taken')
    call expect_message(DRIVEN, 'needs a card *SUBMODEL')
    call expect_message(CUT // '*BOUNDARY, SUBMODEL, STEP=1;CUT,1,3;' // DRIVEN, 'gives values in a step')
    call expect_message(CUT // BEGIN // '*BOUNDARY, SUBMODEL;CUT,1,3;' // END, 'needs the step of the global model')
    call expect_message(CUT // BEGIN // '*BOUNDARY, SUBMODEL, STEP=0;CUT,1,3;' // END, 'counted from 1')
    call expect_message(CUT // BEGIN // '*BOUNDARY, SUBMODEL, STEP=1, DATA SET=2;CUT,1,3;' // END, 'give one of them')
    call expect_message(CUT // BEGIN // '*BOUNDARY, STEP=1;CUT,1,3;' // END, 'need the parameter SUBMODEL')
    call expect_message(CUT // '*AMPLITUDE, NAME=A;0,0,1,1;' // BEGIN // '*BOUNDARY, SUBMODEL, STEP=1, AMPLITUDE=A;CUT,1,3;' // &
      END, 'without AMPLITUDE')
    call expect_message(CUT // BEGIN // '*BOUNDARY, SUBMODEL, STEP=1;CUT,1,3,.1;' // END, 'no value')
    call expect_message(CUT // BEGIN // '*BOUNDARY, SUBMODEL, STEP=1;CUT,4;' // END, 'displacements 1 to 3')
    call expect_message(CUT // BEGIN // '*BOUNDARY, SUBMODEL, STEP=1;8,1,3;' // END, 'node 8 belongs to no')
    call expect_message(CUT // '*STEP, NLGEOM;*STATIC, RIKS;*BOUNDARY, SUBMODEL, STEP=1;CUT,1,3;' // END, 'RIKS step')
    call expect_message(CUT // '*TRANSFORM, NSET=CUT;0,1,0,1,0,0;' // DRIVEN, 'directions of its own', dialect=DIALECT_CALCULIX)
    call expect_read(CUT // '*TRANSFORM, NSET=CUT;0,1,0,1,0,0;' // DRIVEN, model)
    call expect_message(SHEET // '*SUBMODEL, INPUT=g.frd;11;' // BEGIN // '*BOUNDARY, SUBMODEL, STEP=2;11,1,3;' // END, &
      'shell or beam', DIALECT_CALCULIX)
    call expect_message(SHEET // '*SUBMODEL, INPUT=g.frd;11;' // BEGIN // '*TEMPERATURE, SUBMODEL, STEP=2;11;' // END, &
      'shells or beams')
    call expect_read(SHEET // '*SUBMODEL, INPUT=g.frd;11;' // BEGIN // '*BOUNDARY, SUBMODEL, STEP=2;11,1,6;' // END, model)
    call suite%that('rotations of a shell', count(model%steps(1)%prescribed%global_step == 2) == 6)
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_submodel
