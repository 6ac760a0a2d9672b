!> Unit test of deck_contact: laws with their defaults in both dialects, pairs, clearances, and their changes in steps.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_contact
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_surfaces, only: BEHAVIOR_HARD, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED, &
    BEHAVIOR_USER, ROUGH_FRICTION, NO_SHEAR_LIMIT
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;11,0,0,1;' // &
    '12,1,0,1;13,1,1,1;14,0,1,1;15,0,0,2;16,1,0,2;17,1,1,2;18,0,1,2;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;' // &
    '2,11,12,13,14,15,16,17,18;*MATERIAL, NAME=M;*ELASTIC;70000.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;' // &
    '*SURFACE, NAME=LOW;1,S2;*SURFACE, NAME=UP;2,S1;*NSET, NSET=N;11,12;*SURFACE, NAME=DOTS, TYPE=NODE;N;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: LAW = '*SURFACE INTERACTION, NAME=I;', PAIR = '*CONTACT PAIR, INTERACTION=I;UP,LOW;'
  character(*), parameter :: BEHAVIOR = '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE='
  type(suite_type) :: suite
  call check_hard()
  call check_no_separation()
  call check_linear()
  call check_tables()
  call check_friction()
  call check_user_laws()
  call check_pairs()
  call check_clearance()
  call check_steps()
  call check_errors()
  call suite%finish()

contains

  !> HARD is exact, or in CalculiX linear with 50 E and a tension of E/70000.
  subroutine check_hard()
    type(model_type) :: model
    call expect_read(LAW, model)
    call suite%that('without a behavior', model%interactions(1)%behavior == BEHAVIOR_HARD .and. .not. &
      abs(model%interactions(1)%friction) > 0)
    call expect_read(LAW // BEHAVIOR // 'HARD;', model, DIALECT_CALCULIX)
    associate (i => model%interactions(1))
      call suite%that('linear in CalculiX', i%behavior == BEHAVIOR_LINEAR)
      call suite%near('50 E', i%stiffness, 3.5e6_DP, 1.0e-9_DP)
      call suite%near('E/70000', i%tension_limit, 1.0_DP, 1.0e-12_DP)
      call suite%near('reach', i%cutoff_clearance, 1.0e-3_DP, 0.0_DP)
    end associate
    call expect_message('*MATERIAL, NAME=R;*ELASTIC;10.,0.;*ELSET, ELSET=R;2;*SOLID SECTION, ELSET=R, MATERIAL=R;' // LAW // &
      BEHAVIOR // 'HARD;', 'Bodies pull at each other by up to 1', DIALECT_CALCULIX, is_note=.true.)
  end subroutine check_hard


  !> NO SEPARATION of hard contact, until a step lets surfaces part; no other law has it.
  subroutine check_no_separation()
    type(model_type) :: model
    character(*), parameter :: KEPT = '*SURFACE BEHAVIOR, NO SEPARATION'
    call expect_read(LAW // KEPT // ';', model)
    call suite%that('no separation', model%interactions(1)%has_no_separation .and. model%interactions(1)%behavior == BEHAVIOR_HARD)
    call expect_read(LAW // KEPT // ', PRESSURE-OVERCLOSURE=HARD, PENALTY;', model)
    call suite%that('as Abaqus/CAE writes it', model%interactions(1)%has_no_separation)
    call expect_read(LAW // '*SURFACE BEHAVIOR;', model)
    call suite%that('not by default', .not. model%interactions(1)%has_no_separation)
    call expect_message(LAW // KEPT // ', PRESSURE-OVERCLOSURE=LINEAR;9.;', 'LINEAR has no pressure in tension')
    call expect_message(LAW // KEPT // ', PRESSURE-OVERCLOSURE=EXPONENTIAL;.1,9.;', 'EXPONENTIAL has no pressure in tension')
    call expect_message(LAW // KEPT // ';', 'CalculiX does not know NO SEPARATION', DIALECT_CALCULIX)
  end subroutine check_no_separation


  !> LINEAR and TIED: numbers, and what is taken where they are missing.
  subroutine check_linear()
    type(model_type) :: model
    call expect_read(LAW // BEHAVIOR // 'LINEAR;9.,2.,.5;', model)
    associate (i => model%interactions(1))
      call suite%near('K, tension, reach', maxval(abs([i%stiffness, i%tension_limit, i%cutoff_clearance] - &
        [9.0_DP, 2.0_DP, 0.5_DP])), 0.0_DP, 0.0_DP)
    end associate
    call expect_read(LAW // BEHAVIOR // 'LINEAR;9.,,.5;', model)
    call suite%that('no tension: nothing outside contact', .not. model%interactions(1)%cutoff_clearance > 0 .and. &
      .not. model%interactions(1)%tension_limit > 0)
    call expect_read(LAW // BEHAVIOR // 'LINEAR;9.;', model, DIALECT_CALCULIX)
    call suite%near('its default of tension', model%interactions(1)%tension_limit, 1.0_DP, 1.0e-12_DP)
    call suite%near('and of reach', model%interactions(1)%cutoff_clearance, 1.0e-3_DP, 0.0_DP)
    call expect_read(LAW // BEHAVIOR // 'LINEAR;', model)
    call suite%near('K by default', model%interactions(1)%stiffness, 3.5e6_DP, 1.0e-9_DP)
    call expect_read(LAW // BEHAVIOR // 'TIED;9.;', model)
    call suite%that('tied', model%interactions(1)%behavior == BEHAVIOR_TIED)
    call suite%near('sticks as it presses', model%interactions(1)%stick_slope, 9.0_DP, 0.0_DP)
    call expect_read(LAW // BEHAVIOR // 'TIED;9.;*FRICTION;.3,4.;', model, DIALECT_CALCULIX)
    call suite%near('with a stick slope of its own', model%interactions(1)%stick_slope, 4.0_DP, 0.0_DP)
  end subroutine check_linear


  !> EXPONENTIAL, TABULAR, and the stick slope that follows from them: a hundredth of their steepest slope.
  subroutine check_tables()
    type(model_type) :: model
    character(*), parameter :: TABLE = 'TABULAR;0.,-.5;1.,0.;5.,1.;7.,2.;'
    call expect_read(LAW // BEHAVIOR // 'EXPONENTIAL;.1,20.;*FRICTION;.2;', model)
    call suite%that('exponential', model%interactions(1)%behavior == BEHAVIOR_EXPONENTIAL)
    call suite%near('stick slope', model%interactions(1)%stick_slope, 0.01_DP * 20 * log(100.0_DP) / 0.1_DP, 1.0e-12_DP)
    call expect_read(LAW // BEHAVIOR // TABLE // '*FRICTION;.2;', model)
    associate (i => model%interactions(1))
      call suite%that('table', i%behavior == BEHAVIOR_TABULAR .and. size(i%table_pressure) == 4)
      call suite%near('acts before bodies touch', i%clearance, 0.5_DP, 0.0_DP)
      call suite%near('stick slope', i%stick_slope, 0.04_DP, 1.0e-15_DP)
    end associate
    call expect_message(LAW // BEHAVIOR // TABLE, 'begins before bodies touch', DIALECT_CALCULIX, is_note=.true.)
    call expect_read(LAW // BEHAVIOR // TABLE // '*FRICTION;.2;', model, DIALECT_CALCULIX)
    call suite%near('half of E in CalculiX', model%interactions(1)%stick_slope, 3.5e4_DP, 0.0_DP)
  end subroutine check_tables


  !> Coefficient, limit, rough surfaces; the second value by dialect.
  subroutine check_friction()
    type(model_type) :: model
    call expect_read(LAW // '*FRICTION, TAUMAX=7.;.25;', model)
    call suite%near('mu', model%interactions(1)%friction, 0.25_DP, 0.0_DP)
    call suite%near('limit', model%interactions(1)%shear_limit, 7.0_DP, 0.0_DP)
    call expect_read(LAW // '*FRICTION, ROUGH;', model)
    call suite%that('rough', model%interactions(1)%friction >= ROUGH_FRICTION .and. model%interactions(1)%shear_limit >= &
      NO_SHEAR_LIMIT)
    call expect_read(LAW // BEHAVIOR // 'LINEAR;9.,1.;*FRICTION;.25,3.;', model, DIALECT_CALCULIX)
    call suite%near('stick slope', model%interactions(1)%stick_slope, 3.0_DP, 0.0_DP)
    call expect_message(LAW // '*FRICTION;.25,3.;', 'slip rate')
    call expect_message(LAW // '*FRICTION;.25,-3.;', 'must not be negative', DIALECT_CALCULIX)
    call expect_message(LAW // '*FRICTION;.25,3.;', 'sticking is enforced exactly', DIALECT_CALCULIX, is_note=.true.)
  end subroutine check_friction


  !> FRIC and UINTER: properties in lines of eight, state variables.
  subroutine check_user_laws()
    type(model_type) :: model
    call expect_read(LAW // '*FRICTION, USER, PROPERTIES=9, DEPVAR=2;1,2,3,4,5,6,7,8;9;', model)
    associate (i => model%interactions(1))
      call suite%that('FRIC', i%is_user_friction .and. .not. i%friction > 0 .and. i%n_statev == 2 .and. size(i%props) == 9)
      call suite%near('properties', maxval(abs(i%props - [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP, 7.0_DP, 8.0_DP, &
        9.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call expect_read('*SURFACE INTERACTION, NAME=I, USER, PROPERTIES=1, DEPVAR=3;1.;4.;', model)
    call suite%that('UINTER', model%interactions(1)%behavior == BEHAVIOR_USER .and. model%interactions(1)%n_statev == 3)
    call suite%near('the property below the thickness', model%interactions(1)%props(1), 4.0_DP, 0.0_DP)
    call expect_message(LAW // '*FRICTION, USER, PROPERTIES=9;1,2,3,4,5,6,7,8;', 'hold only 8')
    call expect_message('*SURFACE INTERACTION, NAME=I, USER;*FRICTION;.1;', 'UINTER gives friction too')
    call expect_message('*SURFACE INTERACTION, NAME=I, USER;' // BEHAVIOR // 'HARD;', 'UINTER gives the pressure too')
  end subroutine check_user_laws


  !> Types of pairs, several in a card, ADJUST by distance and by nodes.
  subroutine check_pairs()
    type(model_type) :: model
    call expect_read(LAW // '*CONTACT PAIR, INTERACTION=I, SMALL SLIDING, ADJUST=.5;DOTS,LOW;UP,LOW;', model)
    call suite%that('two', size(model%pairs) == 2 .and. all(model%pairs%slave == [3, 2]) .and. all(model%pairs%master == 1))
    call suite%that('of the card', all(model%pairs%is_small_sliding) .and. all(model%pairs%has_adjust) .and. &
      .not. any(model%pairs%is_mortar))
    call suite%near('distance', model%pairs(2)%adjust, 0.5_DP, 0.0_DP)
    call suite%that('name', model%pairs(1)%name == 'DOTS / LOW')
    call expect_read(LAW // '*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE, ADJUST=N;UP,LOW;', model)
    call suite%that('mortar, nodes', model%pairs(1)%is_mortar .and. all(model%mesh%node_label(model%pairs(1)%adjust_nodes) == &
      [11, 12]) .and. .not. model%pairs(1)%has_point_contact)
    call expect_read(LAW // BEHAVIOR // 'LINEAR;9.,1.;*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE;UP,LOW;', model, &
      DIALECT_CALCULIX)
    call suite%that('springs of points in CalculiX', model%pairs(1)%has_point_contact)
    call expect_read(LAW // BEHAVIOR // 'LINEAR;9.,1.;*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE;UP,LOW;', model)
    call suite%that('mortar integrals else', .not. model%pairs(1)%has_point_contact)
    call expect_read(LAW // '*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE;UP,LOW;', model, DIALECT_CALCULIX)
    call suite%that('but not where contact is exact', .not. model%pairs(1)%has_point_contact)
    call expect_message(LAW // '*FRICTION, USER;' // BEHAVIOR // 'LINEAR;9.,1.;*CONTACT PAIR, INTERACTION=I, ' // &
      'TYPE=SURFACE TO SURFACE;UP,LOW;', 'belong to slave nodes', DIALECT_CALCULIX, is_note=.true.)
  end subroutine check_pairs


  !> CLEARANCE: exact laws and mortar pairs; CalculiX ignores it with springs at nodes.
  subroutine check_clearance()
    type(model_type) :: model
    character(*), parameter :: GAP = '*CLEARANCE, SLAVE=UP, MASTER=LOW, VALUE=.125;'
    call expect_read(LAW // PAIR // GAP, model)
    call suite%that('clearance', model%pairs(1)%has_clearance)
    call suite%near('its value', model%pairs(1)%clearance, 0.125_DP, 0.0_DP)
    call expect_message(LAW // BEHAVIOR // 'LINEAR;9.,1.;' // PAIR // GAP, 'CLEARANCE has no effect', DIALECT_CALCULIX, &
      is_note=.true.)
    call expect_message(LAW // '*CONTACT PAIR, INTERACTION=I, ADJUST=.1;UP,LOW;' // GAP, 'both ADJUST and CLEARANCE')
    call expect_message(LAW // PAIR // '*CLEARANCE, SLAVE=LOW, MASTER=UP, VALUE=1.;', 'no contact pair of the slave ''LOW''')
  end subroutine check_clearance


  !> Changes last; an interference is for its step alone.
  subroutine check_steps()
    type(model_type) :: model
    character(*), parameter :: NEW = '*CHANGE FRICTION, INTERACTION=I;*FRICTION;.5;'
    call expect_read(LAW // '*FRICTION;.25;' // PAIR, model, step='*STEP;*STATIC;*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE;' // &
      'UP,LOW;*END STEP;*STEP;*STATIC;' // NEW // '*MODEL CHANGE, TYPE=CONTACT PAIR, ADD;UP,LOW;*CONTACT INTERFERENCE;' // &
      'UP,LOW,.1;*END STEP;*STEP;*STATIC;*CONTACT INTERFERENCE, SHRINK;UP,LOW;*END STEP;')
    call suite%that('removed, added', model%steps(1)%is_removed(1) .and. .not. model%steps(2)%is_removed(1) .and. &
      .not. model%steps(3)%is_removed(1))
    call suite%that('no change in step 1', .not. allocated(model%steps(1)%interactions))
    call suite%near('in step 2', model%steps(2)%interactions(1)%friction, 0.5_DP, 0.0_DP)
    call suite%near('and after it', model%steps(3)%interactions(1)%friction, 0.5_DP, 0.0_DP)
    call suite%near('the model keeps its own', model%interactions(1)%friction, 0.25_DP, 0.0_DP)
    call suite%near('interference', model%steps(2)%interference(1), 0.1_DP, 0.0_DP)
    call suite%that('shrink fit', model%steps(3)%is_shrink_fit(1) .and. .not. model%steps(3)%interference(1) > 0 .and. &
      .not. model%steps(2)%is_shrink_fit(1))
    call expect_message(LAW // PAIR, 'a HARD interaction to a compliant one', &
      step='*STEP;*STATIC;*CHANGE SURFACE BEHAVIOR, INTERACTION=I;' // BEHAVIOR // 'LINEAR;5.;*END STEP;')
    call expect_message(LAW // PAIR, 'no surface interaction ''J''', &
      step='*STEP;*STATIC;*CHANGE FRICTION, INTERACTION=J;*FRICTION;.5;*END STEP;')
    call expect_message(LAW // PAIR, 'either ADD or REMOVE', &
      step='*STEP;*STATIC;*MODEL CHANGE, TYPE=CONTACT PAIR, ADD, REMOVE;UP,LOW;*END STEP;')
    call expect_message(LAW // '*FRICTION, USER, DEPVAR=1;' // PAIR, 'cannot change DEPVAR', &
      step='*STEP;*STATIC;*CHANGE FRICTION, INTERACTION=I;*FRICTION, USER, DEPVAR=2;*END STEP;')
    call expect_message(LAW // PAIR, 'needs data lines', step='*STEP;*STATIC;*CONTACT INTERFERENCE;*END STEP;')
  end subroutine check_steps


  !> What is refused.
  subroutine check_errors()
    call expect_message(LAW // BEHAVIOR // 'EXPONENTIAL;0.,1.;', 'positive gap c0')
    call expect_message(LAW // BEHAVIOR // 'EXPONENTIAL;', 'c0, p0')
    call expect_message(LAW // BEHAVIOR // 'TABULAR;', 'TABULAR needs data lines')
    call expect_message(LAW // BEHAVIOR // 'TABULAR;0.,0.;1.,0.;', 'must ascend')
    call expect_message(LAW // '*CONTACT PAIR, INTERACTION=I;UP,DOTS;', 'a master needs element faces')
    call expect_message(LAW // '*CONTACT PAIR, INTERACTION=I;', 'needs a data line')
    call expect_message(LAW // '*CONTACT PAIR, INTERACTION=I, ADJUST=-1.;UP,LOW;', 'must be a distance')
    call expect_message(LAW // '*CONTACT PAIR, INTERACTION=I, ADJUST=Q;UP,LOW;', 'or a node set')
    call expect_message(LAW // '*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE;DOTS,LOW;', 'made of nodes', &
      is_note=.true.)
    call expect_message(LAW // '*CONTACT PAIR, INTERACTION=J;UP,LOW;', 'no surface interaction ''J''')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_contact
