!> Unit test of deck_surfaces: amplitudes of each definition, faces and nodes of surfaces, equations over sets and in local axes.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_surfaces
  use amontons_kinds, only: DP, PI
  use amontons_deck, only: read_deck_text
  use amontons_deck_surfaces, only: face_number
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_loads, only: amplitude_value
  use amontons_text, only: NEWLINE
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;11,0,0,2;' // &
    '12,1,0,2;13,1,1,2;14,0,1,2;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;2,5,6,7,8,11,12,13,14;' // &
    '*MATERIAL, NAME=M;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;*NSET, NSET=LOW;1,2,3,4;*NSET, NSET=UP;11,12,13,14;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  call check_heading()
  call check_tables()
  call check_formulas()
  call check_delay()
  call check_faces()
  call check_equations()
  call check_errors()
  call suite%finish()

contains

  !> Lines of HEADING without comments and blank ones.
  subroutine check_heading()
    type(model_type) :: model
    call expect_read('*HEADING;  One block;** no text;;on another;', model)
    call suite%that('heading', model%heading == 'One block' // NEWLINE // 'on another')
  end subroutine check_heading


  !> The factor of the only amplitude at a time.
  subroutine expect_factor(text, time, factor, tolerance)
    character(*), intent(in) :: text
    real(DP), intent(in) :: time, factor
    real(DP), intent(in), optional :: tolerance
    type(model_type) :: model
    real(DP) :: limit
    limit = 1.0e-14_DP                           ! rounding of numbers of size 10
    if (present(tolerance)) limit = tolerance
    call expect_read(text, model)
    call suite%near(text, amplitude_value(model%amplitudes(1), time), factor, limit)
  end subroutine expect_factor


  !> TABULAR, SMOOTH STEP and EQUALLY SPACED, and their shifts.
  subroutine check_tables()
    type(model_type) :: model
    call expect_factor('*AMPLITUDE, NAME=A;0.,0.,2.,4.;4.,0.;', 3.0_DP, 2.0_DP)
    call expect_factor('*AMPLITUDE, NAME=A, SHIFTX=1., SHIFTY=10.;0.,0.,2.,4.;', 2.0_DP, 12.0_DP)
    call expect_factor('*AMPLITUDE, NAME=A, DEFINITION=SMOOTH STEP;0.,0.,1.,32.;', 0.25_DP, 32 * 0.103515625_DP)
    call expect_factor('*AMPLITUDE, NAME=A, DEFINITION=EQUALLY SPACED, FIXED INTERVAL=.5, BEGIN=1.;0.,3.,5.;', 1.75_DP, 4.0_DP)
    call expect_read('*AMPLITUDE, NAME=A, TIME=TOTAL TIME, VALUE=ABSOLUTE;0.,1.;', model)
    call suite%that('total time, absolute', model%amplitudes(1)%is_total_time .and. model%amplitudes(1)%is_absolute)
    call expect_read('*AMPLITUDE, NAME=A, VALUE=ABSOLUTE;0.,1.;', model, DIALECT_CALCULIX)
    call suite%that('factors in CalculiX', .not. model%amplitudes(1)%is_absolute)
  end subroutine check_tables


  !> PERIODIC, MODULATED, DECAY; the properties of UAMP.
  subroutine check_formulas()
    type(model_type) :: model
    call expect_factor('*AMPLITUDE, NAME=A, DEFINITION=PERIODIC;2,3.,1.,.5;1.,2.,3.,4.;', 1 + PI / 6, 0.5_DP + 2.0_DP - 3.0_DP)
    call expect_factor('*AMPLITUDE, NAME=A, DEFINITION=PERIODIC;1,3.,1.,.5;1.,2.;', 0.9_DP, 0.5_DP)
    call expect_factor('*AMPLITUDE, NAME=A, DEFINITION=MODULATED;1.,4.,.5,3.,1.;', 0.5_DP + PI / 2, 1.0_DP - 4.0_DP)
    call expect_factor('*AMPLITUDE, NAME=A, DEFINITION=DECAY;1.,4.,.5,2.;', 2.5_DP, 1 + 4 * exp(-1.0_DP))
    call expect_read('*AMPLITUDE, NAME=A, DEFINITION=USER, PROPERTIES=2, VARIABLES=3;5.,6.;', model)
    associate (a => model%amplitudes(1))
      call suite%that('by UAMP', a%is_user .and. a%is_total_time .and. a%n_svars == 3 .and. size(a%props) == 2)
      call suite%near('properties', a%props(2), 6.0_DP, 0.0_DP)
    end associate
  end subroutine check_formulas


  !> TIME DELAY: a copy whose times are later.
  subroutine check_delay()
    type(model_type) :: model
    character(*), parameter :: TABLE = '*AMPLITUDE, NAME=A;0.,0.,1.,2.;'
    call expect_read(TABLE, model, step='*STEP;*STATIC;*CLOAD, AMPLITUDE=A, TIME DELAY=.5;1,1,1.;*CLOAD, AMPLITUDE=A;2,1,1.;' // &
      '*END STEP;')
    call suite%that('a copy', size(model%amplitudes) == 2 .and. all(model%steps(1)%concentrated%amplitude == [2, 1]))
    call suite%near('later', amplitude_value(model%amplitudes(2), 1.0_DP), 1.0_DP, 1.0e-15_DP)
    call suite%near('the first is unchanged', amplitude_value(model%amplitudes(1), 1.0_DP), 2.0_DP, 1.0e-15_DP)
    call expect_message(TABLE, 'TIME DELAY needs an AMPLITUDE', step='*STEP;*STATIC;*CLOAD, TIME DELAY=1.;1,1,1.;*END STEP;')
    call expect_message('*AMPLITUDE, NAME=A, DEFINITION=DECAY;1.,4.,.5,2.;', 'a later t0', &
      step='*STEP;*STATIC;*CLOAD, AMPLITUDE=A, TIME DELAY=1.;1,1,1.;*END STEP;')
  end subroutine check_delay


  !> Faces by number and free faces, each once; their nodes ascend; nodes by set; faces inside give a note.
  subroutine check_faces()
    type(model_type) :: model
    call suite%that('labels', face_number(' s3 ', 'S') == 3 .and. face_number('P6', 'P') == 6)
    call suite%that('no labels', face_number('S7', 'S') == 0 .and. face_number('S0', 'S') == 0 .and. &
      face_number('P1', 'S') == 0 .and. face_number('S12', 'S') == 0 .and. face_number('', 'S') == 0)
    call expect_read('*SURFACE, NAME=S;2,S2;1,S1;2,S2;', model)
    associate (s => model%surfaces(1))
      call suite%that('each once', size(s%face) == 2 .and. all(s%element == [2, 1]) .and. &
        all(s%face == [2, 1]) .and. .not. s%is_node_based)
      call suite%that('nodes ascend', all(model%mesh%node_label(s%nodes) == [1, 2, 3, 4, 11, 12, 13, 14]))
    end associate
    call expect_read('*SURFACE, NAME=S;E;', model)
    call suite%that('free faces', size(model%surfaces(1)%face) == 10 .and. size(model%surfaces(1)%nodes) == 12)
    call expect_read('*SURFACE, NAME=S, TYPE=NODE;14;LOW;1;', model)
    call suite%that('nodes', model%surfaces(1)%is_node_based .and. size(model%surfaces(1)%element) == 0 .and. &
      all(model%mesh%node_label(model%surfaces(1)%nodes) == [1, 2, 3, 4, 14]))
    call expect_message('*SURFACE, NAME=S;1,S2;1,S1;', 'faces inside the body, 1 of 2', is_note=.true.)
    call expect_read('*SURFACE, NAME=S, TYPE=NODE;LOW;*SURFACE, NAME=S;1,S1;', model, DIALECT_CALCULIX)
    call suite%that('faces first, nodes renamed', size(model%surfaces) == 2 .and. .not. model%surfaces(1)%is_node_based .and. &
      model%surfaces(2)%name == 'S (nodes)')
  end subroutine check_faces


  !> Terms in several rows, sets node by node and with one node, terms that are added, terms in local axes.
  subroutine check_equations()
    type(model_type) :: model
    call expect_read('*EQUATION;3;UP,1,2.,LOW,2,-1.;;5,3,4.;', model)
    call suite%that('four', size(model%equations) == 4)
    associate (equation => model%equations(3))
      call suite%that('third of each set, and the node', all(model%mesh%node_label(equation%node) == [13, 3, 5]) .and. &
        all(equation%dof == [1, 2, 3]))
      call suite%near('coefficients', maxval(abs(equation%coefficient - [2.0_DP, -1.0_DP, 4.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call expect_read('*EQUATION;3;1,1,1.,2,1,5.,1,1,2.;', model)
    call suite%that('two terms', size(model%equations(1)%node) == 2)
    call suite%near('sum', model%equations(1)%coefficient(1), 3.0_DP, 0.0_DP)
    call expect_read('*TRANSFORM, NSET=UP;3,4,0,-4,3,0;*EQUATION;2;11,1,2.,1,3,1.;', model)
    associate (equation => model%equations(1))
      call suite%that('local x', size(equation%dof) == 3 .and. equation%deck_dof == 1)
      call suite%near('in global axes', maxval(abs(equation%coefficient - [1.2_DP, 1.6_DP, 1.0_DP])), 0.0_DP, 1.0e-15_DP)
    end associate
  end subroutine check_equations


  !> What is refused.
  subroutine check_errors()
    call expect_message('*AMPLITUDE, NAME=A, DEFINITION=PERIODIC;2,3.,1.,.5;1.,2.;', 'PERIODIC needs the number')
    call expect_message('*AMPLITUDE, NAME=A, DEFINITION=MODULATED;1.,4.,.5,3.;', 'MODULATED needs')
    call expect_message('*AMPLITUDE, NAME=A, DEFINITION=DECAY;1.,4.,.5,0.;', 'a positive td')
    call expect_message('*AMPLITUDE, NAME=A, DEFINITION=DECAY;1.,4.;', 'at least 4 numbers')
    call expect_message('*AMPLITUDE, NAME=A, DEFINITION=DECAY, SHIFTX=1.;1.,4.,.5,2.;', 'shift tables')
    call expect_message('*AMPLITUDE, NAME=A, DEFINITION=EQUALLY SPACED;1.,2.;', 'needs a positive FIXED INTERVAL')
    call expect_message('*AMPLITUDE, NAME=A, BEGIN=1.;0.,1.;', 'belong to DEFINITION=EQUALLY SPACED')
    call expect_message('*AMPLITUDE, NAME=A;1.,1.;1.,2.;', 'must ascend')
    call expect_message('*AMPLITUDE, NAME=A;1.,1.,2.;', 'odd number')
    call expect_message('*SURFACE, NAME=S;E,S9;', 'S1 to S6')
    call expect_message('*SURFACE, NAME=S;*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I;S;', 'has no faces')
    call expect_message('*SURFACE, NAME=S, TYPE=NODE;LOW;*SURFACE, NAME=S;1,S1;', 'defined twice')
    call expect_message('*EQUATION;2;UP,1,1.,LOWER,1,1.;', 'no node or node set ''LOWER''')
    call expect_message('*NSET, NSET=T;1,2,3;*EQUATION;2;UP,1,1.,T,1,1.;', 'same number of nodes')
    call expect_message('*EQUATION;2;1,1,1.,2,1,1.,3,1,1.;', 'at most 2 terms')
    call expect_message('*EQUATION;2;1,1,1.;', 'only 1 term')
    call expect_message('*EQUATION;2;1,1,0.,2,1,1.;', 'coefficient of the first term is zero')
    call expect_message('', 'before the first step', step='*STEP;*STATIC;*EQUATION;2;1,1,1.,2,1,1.;*END STEP;')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_surfaces
