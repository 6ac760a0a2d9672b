!> Unit test of deck_springs: constants, curves and axes of springs, gaps, masses, ropes, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_springs
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_element_kinds, only: KIND_SPRINGA, KIND_GAPUNI
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;9,2,9,9;' // &
    '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL, NAME=M;*ELASTIC;50.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: SPRINGA = '*ELEMENT, TYPE=SPRINGA, ELSET=A;11,1,5;12,2,6;'
  character(*), parameter :: ONE = '*ELEMENT, TYPE=SPRING1, ELSET=S;13,3;', TWO = '*ELEMENT, TYPE=SPRING2, ELSET=T;14,3,4;'
  character(*), parameter :: GAP = '*ELEMENT, TYPE=GAPUNI, ELSET=G;15,1,5;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_constants()
  call check_curves()
  call check_axes()
  call check_gaps()
  call check_ropes()
  call check_errors()
  call suite%finish()

contains

  !> Constant of a section, over the temperature, in directions; the mass.
  subroutine check_constants()
    call expect_read(SPRINGA // '*SPRING, ELSET=A;;7.;', model)
    call suite%near('constant of both', maxval(abs(model%mesh%section_value(2:3) - 7)), 0.0_DP, 0.0_DP)
    call suite%that('no law of its own', .not. allocated(model%mesh%spring) .or. size(model%springs) == 0)
    call expect_read(SPRINGA // '*SPRING, ELSET=A;7.,,0.;5.,,100.;', model)
    associate (s => model%springs(1))
      call suite%that('a law', size(model%springs) == 1 .and. all(model%mesh%spring == [0, 1, 1]))
      call suite%near('over the temperature', maxval(abs([s%constant%value(1, :), s%constant%temperature] - [7.0_DP, 5.0_DP, &
        0.0_DP, 100.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call expect_read(ONE // '*SPRING, ELSET=S;2;4.;' // TWO // '*SPRING, ELSET=T;1,3;6.;', model)
    call suite%that('directions', all(model%mesh%directions(:, 2) == [2, 0]) .and. all(model%mesh%directions(:, 3) == [1, 3]))
    call suite%near('constants', maxval(abs(model%mesh%section_value(2:3) - [4.0_DP, 6.0_DP])), 0.0_DP, 0.0_DP)
    call expect_read('*ELEMENT, TYPE=MASS, ELSET=P;21,9;*MASS, ELSET=P;2.5;', model)
    call suite%near('mass', model%mesh%section_value(2), 2.5_DP, 0.0_DP)
  end subroutine check_constants


  !> NONLINEAR: force over elongation, a table for each temperature.
  subroutine check_curves()
    call expect_read(SPRINGA // '*SPRING, ELSET=A, NONLINEAR;-1.,-2.;0.,0.;3.,1.;0.,0.,50.;6.,1.,50.;', model)
    associate (f => model%springs(1)%force)
      call suite%that('two tables', size(f) == 2 .and. size(f(1)%strain) == 3 .and. size(f(2)%strain) == 2)
      call suite%near('elongations', maxval(abs(f(1)%strain - [-2.0_DP, 0.0_DP, 1.0_DP])), 0.0_DP, 0.0_DP)
      call suite%near('forces', maxval(abs(f(1)%stress - [-1.0_DP, 0.0_DP, 3.0_DP])), 0.0_DP, 0.0_DP)
      call suite%near('the hotter one', f(2)%stress(2) + f(2)%temperature, 56.0_DP, 0.0_DP)
    end associate
  end subroutine check_curves


  !> ORIENTATION: directions are those of its axes.
  subroutine check_axes()
    call expect_read('*ORIENTATION, NAME=O;0,1,0,-1,0,0;' // TWO // '*SPRING, ELSET=T, ORIENTATION=O;1,3;6.;', model)
    associate (s => model%springs(1))
      call suite%near('axis at the first node', maxval(abs(s%axes(:, 1) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, 1.0e-15_DP)
      call suite%near('axis at the second', maxval(abs(s%axes(:, 2) - [0.0_DP, 0.0_DP, 1.0_DP])), 0.0_DP, 1.0e-15_DP)
    end associate
    call suite%that('no global direction', all(model%mesh%directions(:, 2) == 0))
  end subroutine check_axes


  !> GAP: clearance, direction, stiffness; CalculiX has the same defaults without a note.
  subroutine check_gaps()
    call expect_read(GAP // '*GAP, ELSET=G;.5,0,0,2,,100.,.25;', model)
    associate (s => model%springs(1))
      call suite%that('a gap', s%is_gap .and. model%mesh%kind(2) == KIND_GAPUNI)
      call suite%near('numbers', maxval(abs([s%clearance, s%stiffness, s%open_force, s%axes(3, 1)] - [0.5_DP, 100.0_DP, 0.25_DP, &
        2.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call suite%that('along z', all(model%mesh%directions(:, 2) == 3))
    call expect_read(GAP // '*GAP, ELSET=G;.5,1,1;', model, DIALECT_CALCULIX)
    call suite%that('along no axis', all(model%mesh%directions(:, 2) == 0))
    call suite%near('default', model%springs(1)%stiffness, 1.0e12_DP, 0.0_DP)
    call expect_message(GAP // '*GAP, ELSET=G;.5,0,0,1;', 'A closed gap is a spring', is_note=.true.)
  end subroutine check_gaps


  !> MPC DIST: a rope of stiffness 1e4 E L whose length is the first coordinate of the last node.
  subroutine check_ropes()
    call expect_read('*MPC;DIST,1,1,1,3,3,3,9;', model)
    associate (s => model%springs(1))
      call suite%that('an element more', model%mesh%n_elements == 2 .and. model%mesh%kind(2) == KIND_SPRINGA .and. &
        model%mesh%element_label(2) == 2 .and. all(model%mesh%nodes(9:10) == [1, 3]))
      call suite%that('a rope', s%is_distance_limit .and. s%length_node == 9)
      call suite%near('slack', s%clearance, 2 - sqrt(2.0_DP), 1.0e-15_DP)
      call suite%near('stiffness', s%stiffness, 1.0e4_DP * 50.0_DP * sqrt(2.0_DP), 1.0e-9_DP)
    end associate
    call expect_message('*MPC;DIST,1,1,1,5,5,5;', 'DIST needs')
    call expect_message('*NODE;10,.5,0,0;*MPC;DIST,1,1,1,5,5,5,10;', 'not farther than the distance')
  end subroutine check_ropes


  !> What is refused.
  subroutine check_errors()
    call expect_message(SPRINGA // '*SPRING, ELSET=A;5.,,9.;5.,,3.;', 'must ascend')
    call expect_message(SPRINGA // '*SPRING, ELSET=A;', 'data are missing')
    call expect_message(SPRINGA // '*SPRING, ELSET=A, NONLINEAR;1.,1.;2.,1.;', 'elongations of a spring must ascend')
    call expect_message(SPRINGA // '*SPRING, ELSET=A, NONLINEAR;1.,1.,5.;2.,1.,4.;', 'temperatures of a spring must ascend')
    call expect_message(ONE // '*SPRING, ELSET=S;4;4.;', 'direction 1, 2 or 3')
    call expect_message('*ORIENTATION, NAME=O, SYSTEM=CYLINDRICAL;0,0,0,0,0,1;' // TWO // &
      '*SPRING, ELSET=T, ORIENTATION=O;1,2;6.;', 'must be rectangular')
    call expect_message(GAP // '*GAP, ELSET=G;.5,0,0,1,,-1.;', 'must be positive', dialect=DIALECT_CALCULIX)
    call expect_message(GAP // '*GAP, ELSET=G;', 'clearance and direction')
    call expect_message('*ELEMENT, TYPE=MASS, ELSET=P;21,9;*MASS, ELSET=P;', 'the mass')
    call expect_message(SPRINGA // '*SPRING, ELSET=A;5.;*MASS, ELSET=A;1.;', 'no mass')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_springs
