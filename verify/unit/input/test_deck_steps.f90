!> Unit test of deck_steps: times, controls, what lasts over steps, changes of elements, materials and equations, refusals.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_steps
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_steps, only: LINE_SEARCH_NODAL, LINE_SEARCH_AUTO, TANGENT_LAGGED, TANGENT_EXACT, SOLVER_ITERATIVE, SOLVER_AUTO, &
    INTERFACE_SKIN, INTERFACE_AUTO
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;11,0,0,2;' // &
    '12,1,0,2;13,1,1,2;14,0,1,2;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;2,5,6,7,8,11,12,13,14;*ELSET, ELSET=B;2;' // &
    '*MATERIAL, NAME=M;*ELASTIC;1.,0.;*MATERIAL, NAME=X;*ELASTIC;2.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;' // &
    '*BOUNDARY;1,1;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: S = '*STEP;*STATIC;', END = '*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_times()
  call check_lasting()
  call check_total_time()
  call check_controls()
  call check_damping()
  call check_perturbation()
  call check_elements()
  call check_materials()
  call check_equations()
  call check_nlgeom()
  call suite%finish()

contains

  !> The four times of a step.
  subroutine expect_times(data, times)
    character(*), intent(in) :: data
    real(DP), intent(in) :: times(4)               !< first increment, length, least, largest
    call expect_read('', model, step='*STEP;*STATIC;' // data // END)
    associate (t => model%steps(1))
      call suite%near('times of ' // data, maxval(abs([t%dt_initial, t%period, t%dt_min, t%dt_max] - times)), 0.0_DP, 1.0e-18_DP)
    end associate
  end subroutine expect_times


  !> STATIC: given and default times, and those that contradict each other.
  subroutine check_times()
    call expect_times('.25,2.,.125,.5;', [0.25_DP, 2.0_DP, 0.125_DP, 0.5_DP])
    call expect_times('', [1.0_DP, 1.0_DP, 1.0e-6_DP, 1.0_DP])
    call expect_times('.5;', [0.5_DP, 1.0_DP, 1.0e-6_DP, 1.0_DP])
    call expect_times(',4.;', [4.0_DP, 4.0_DP, 4.0e-6_DP, 4.0_DP])
    call expect_times('1.,2.,,.5;', [0.5_DP, 2.0_DP, 2.0e-6_DP, 0.5_DP])
    call expect_times('.1,2.,.5;', [0.1_DP, 2.0_DP, 0.1_DP, 2.0_DP])
    call expect_message('', 'is longer than the step', step='*STEP;*STATIC;3.,2.;' // END)
    call expect_message('', 'must be positive', step='*STEP;*STATIC;.5,2.,-1.;' // END)
    call expect_message('', '1 is taken', step='*STEP;*STATIC;.5,-2.;' // END, is_note=.true.)
    call expect_message('', 'no *STATIC, *VISCO or *DYNAMIC card', step='*STEP;' // END)
    call expect_message('', 'INC must be at least 1', step='*STEP, INC=0;*STATIC;' // END)
    call expect_message('', 'there is no *STEP card', step='*NSET, NSET=Q;1;')
    call expect_read('', model, step='*STEP, INC=7;A title;of two lines;*STATIC, DIRECT, SOLVER=ITERATIVE SCALING;.25;' // END)
    associate (t => model%steps(1))
      call suite%that('words', t%title == 'A title of two lines' .and. t%max_increments == 7 .and. t%is_direct .and. t%solver == &
        SOLVER_ITERATIVE .and. t%number == 1)
    end associate
  end subroutine check_times


  !> NLGEOM, controls and the line search last; INC, times and DIRECT do not.
  subroutine check_lasting()
    call expect_read('*CONTROLS, PARAMETERS=GAP;.125;', model, &
      step='*STEP, NLGEOM, INC=7;*VISCO;.25,2.;*LINE SEARCH, TYPE=NODAL, ' // &
      'DIRECTION=LAGGED, INTERFACE=SKIN;' // END // S // END // '*STEP, NLGEOM=NO;*STATIC;*LINE SEARCH, TYPE=AUTO;*CONTROLS, ' // &
      'RESET;' // END)
    associate (t => model%steps)
      call suite%that('NLGEOM', all(t%is_nlgeom .eqv. [.true., .true., .false.]))
      call suite%that('line search', all(t%line_search == [LINE_SEARCH_NODAL, LINE_SEARCH_NODAL, LINE_SEARCH_AUTO]) .and. &
        all(t%direction == [TANGENT_LAGGED, TANGENT_LAGGED, TANGENT_EXACT]) .and. &
        all(t%interface == [INTERFACE_SKIN, INTERFACE_SKIN, INTERFACE_AUTO]))
      call suite%that('creep', all(t%has_creep .eqv. [.true., .false., .false.]))
      call suite%that('increments', all(t%max_increments == [7, 100, 100]) .and. all(t%solver == SOLVER_AUTO))
      call suite%near('length', maxval(abs(t%period - [2.0_DP, 1.0_DP, 1.0_DP])), 0.0_DP, 0.0_DP)
      call suite%near('controls, and reset', abs(t(2)%controls%gap_tolerance - 0.125_DP) + abs(t(3)%controls%gap_tolerance - &
        1.0e-9_DP), 0.0_DP, 0.0_DP)
    end associate
  end subroutine check_lasting


  !> TIME RESET and TOTAL TIME AT START.
  subroutine check_total_time()
    call expect_read('', model, step='*STEP;*STATIC;.5,2.;' // END // '*STEP;*STATIC, TIME RESET;.5,.5;' // END // &
      '*STEP;*STATIC, TOTAL TIME AT START=10.;1.,1.;' // END // S // END)
    associate (t => model%steps)
      call suite%that('set', all(t%is_total_time_set .eqv. [.false., .true., .true., .false.]))
      call suite%near('at the start', maxval(abs(t%clock - [0.0_DP, 1.5_DP, 10.0_DP, 11.0_DP])), 0.0_DP, 0.0_DP)
    end associate
  end subroutine check_total_time


  !> CONTROLS in the slots of CalculiX: blank fields keep their values.
  subroutine check_controls()
    call expect_read('', model, step=S // '*CONTROLS, PARAMETERS=TIME INCREMENTATION;1,2,3,4,5,6,,7;.1,.2,.3,,,,2.;' // &
      '*CONTROLS, PARAMETERS=FIELD;.5,,,,.75,,,.25;*CONTROLS, PARAMETERS=LINE SEARCH;,2.,.5;' // END)
    associate (c => model%steps(1)%controls)
      call suite%that('counts', all([c%i_0, c%i_r, c%i_p, c%i_c, c%i_l, c%i_g, c%i_a] == [1, 2, 3, 4, 5, 6, 7]))
      call suite%near('factors', maxval(abs([c%d_f, c%d_c, c%d_b, c%d_d] - [0.1_DP, 0.2_DP, 0.3_DP, 2.0_DP])), 0.0_DP, 0.0_DP)
      call suite%near('tolerances', maxval(abs([c%r_n, c%c_n, c%r_p, c%r_l] - [0.5_DP, 1.0e-6_DP, 0.75_DP, 0.25_DP])), 0.0_DP, &
        0.0_DP)
      call suite%near('lengths', abs(c%s_max - 2) + abs(c%s_min - 0.5_DP), 0.0_DP, 0.0_DP)
    end associate
    call expect_controls('TIME INCREMENTATION;0;', 'at least 1')
    call expect_controls('TIME INCREMENTATION;4;1.;', 'must be 0 < DF < 1')
    call expect_controls('TIME INCREMENTATION;4;,,,,,,.5;', 'DD >= 1')
    call expect_controls('FIELD;0.;', 'tolerances must be positive')
    call expect_controls('LINE SEARCH;,.25,.5;', '0 < s min <= s max')
    call expect_controls('GAP;0.;', 'penetration allowed must be positive')
    call expect_message('', '*CONTROLS needs PARAMETERS', step=S // '*CONTROLS;' // END)
  end subroutine check_controls


  !> Controls that are refused.
  subroutine expect_controls(data, piece)
    character(*), intent(in) :: data, piece
    call expect_message('', piece, step=S // '*CONTROLS, PARAMETERS=' // data // END)
  end subroutine expect_controls


  !> STABILIZE: fraction, factor, continued; ignored in CalculiX.
  subroutine check_damping()
    call expect_read('', model, step='*STEP;*STATIC, STABILIZE;' // END // '*STEP;*STATIC, STABILIZE=.5, FACTOR=3., CONTINUE;' // &
      END // S // END)
    associate (t => model%steps)
      call suite%near('fractions', maxval(abs(t%dissipated_fraction - [2.0e-4_DP, 0.5_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
      call suite%near('factor', maxval(abs(t%damping_factor - [0.0_DP, 3.0_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
      call suite%that('continued', all(t%is_damping_continued .eqv. [.false., .true., .false.]))
    end associate
    call expect_message('', 'must not be negative', step='*STEP;*STATIC, STABILIZE=-1.;' // END)
    call expect_message('', 'STABILIZE has no effect', DIALECT_CALCULIX, step='*STEP;*STATIC, STABILIZE;' // END, is_note=.true.)
  end subroutine check_damping


  !> PERTURBATION: its loads end with it.
  subroutine check_perturbation()
    character(*), parameter :: LINEAR = '*STEP, PERTURBATION;*STATIC;'
    call expect_read('', model, step=LINEAR // '*CLOAD;7,1,5.;' // END // LINEAR // &
      '*CLOAD;8,1,3.;' // END)
    call suite%that('both', all(model%steps%is_perturbation))
    call suite%that('the second has its own load alone', size(model%steps(2)%concentrated) == 1)
    if (size(model%steps(2)%concentrated) == 1) call suite%that('at its node', model%steps(2)%concentrated(1)%node == 8 .and. &
      .not. abs(model%steps(2)%concentrated(1)%start) > 0)
    call expect_message('', 'not supported after a general step', step=S // END // LINEAR // &
      END)
  end subroutine check_perturbation


  !> MODEL CHANGE of elements: removed, added without strain, added with strain.
  subroutine check_elements()
    character(*), parameter :: CHANGE = '*MODEL CHANGE, TYPE=ELEMENT, '
    call expect_read('', model, step=S // CHANGE // 'REMOVE;B;' // END // S // CHANGE // 'ADD;B;' // END // S // CHANGE // &
      'REMOVE;1;' // END // S // CHANGE // 'ADD=WITH STRAIN;1;' // END)
    associate (t => model%steps)
      call suite%that('out', all(t(1)%is_inactive .eqv. [.false., .true.]) .and. .not. any(t(2)%is_inactive))
      call suite%that('new', all(t(2)%is_reactivated .eqv. [.false., .true.]))
      call suite%that('as it was', .not. any(t(4)%is_inactive) .and. .not. any(t(4)%is_reactivated))
    end associate
    call expect_message('', 'No element is left', step=S // CHANGE // 'REMOVE;E;' // END)
    call expect_message('', 'either ADD or REMOVE', step=S // CHANGE // ';B;' // END)
    call expect_message('', 'needs data lines', step=S // CHANGE // 'REMOVE;' // END)
    call expect_message('', '1 element had not been taken out', step=S // CHANGE // 'ADD;B;' // END, is_note=.true.)
    call expect_message('', 'no element or element set ''Q''', step=S // CHANGE // 'REMOVE;Q;' // END)
  end subroutine check_elements


  !> CHANGE SOLID SECTION and CHANGE MATERIAL: another material, a changed copy.
  subroutine check_materials()
    character(*), parameter :: SOFT = '*MATERIAL, NAME=P;*ELASTIC;1.,0.;*PLASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=P;'
    call expect_read(SOFT, model, step=S // '*CHANGE SOLID SECTION, ELSET=B, MATERIAL=X;' // END // S // &
      '*CHANGE MATERIAL, NAME=P;*CHANGE PLASTIC;5.,0.;' // END)
    associate (t => model%steps)
      call suite%that('in step 1', all(t(1)%material == [3, 2]))
      call suite%that('a copy in step 2', size(model%materials) == 4 .and. all(t(2)%material == [4, 2]))
      call suite%near('its curve', model%materials(4)%isotropic_hardening(1)%stress(1), 5.0_DP, 0.0_DP)
      call suite%near('that of the model stays', model%materials(3)%isotropic_hardening(1)%stress(1), 1.0_DP, 0.0_DP)
    end associate
    call expect_message('', 'no element set ''Q''', step=S // '*CHANGE SOLID SECTION, ELSET=Q, MATERIAL=X;' // END)
    call expect_message('', 'no material ''Q''', step=S // '*CHANGE SOLID SECTION, ELSET=B, MATERIAL=Q;' // END)
    call expect_message('', 'no material ''Q''', step=S // '*CHANGE MATERIAL, NAME=Q;' // END)
    call expect_message('', 'has no *PLASTIC', step=S // '*CHANGE MATERIAL, NAME=X;*CHANGE PLASTIC;5.,0.;' // END)
    call expect_message('*ELEMENT, TYPE=SPRINGA, ELSET=A;9,1,7;*SPRING, ELSET=A;;1.;', 'Springs and masses have no material', &
      step=S // '*CHANGE SOLID SECTION, ELSET=A, MATERIAL=X;' // END)
  end subroutine check_materials


  !> EQUATION, REMOVE: those whose first term is named, or all.
  subroutine check_equations()
    character(*), parameter :: TWO = '*EQUATION;2;6,1,1.,2,1,-1.;2;6,3,1.,2,3,-1.;'
    call expect_read(TWO, model, step=S // END // S // '*EQUATION, REMOVE;6,1,2;' // END)
    call suite%that('the first ends with step 1', model%equations(1)%last_step == 1 .and. model%equations(2)%last_step > 2)
    call expect_read(TWO, model, step=S // END // S // END // S // '*EQUATION, REMOVE=ALL;' // END)
    call suite%that('both end with step 2', all(model%equations%last_step == 2))
    call expect_message(TWO, 'none is removed', step=S // '*EQUATION, REMOVE;2,1;' // END, is_note=.true.)
  end subroutine check_equations


  !> CalculiX: rubber, lines and planes of MPC turn NLGEOM on.
  subroutine check_nlgeom()
    call expect_message('*MPC;STRAIGHT,1,3,13;', 'turns NLGEOM on', DIALECT_CALCULIX, is_note=.true.)
    call expect_read('*MPC;STRAIGHT,1,3,13;', model, DIALECT_CALCULIX)
    call suite%that('by an MPC', model%steps(1)%is_nlgeom)
    call expect_read('*MPC;STRAIGHT,1,3,13;', model)
    call suite%that('not in the abaqus dialect', .not. model%steps(1)%is_nlgeom)
    call expect_read('*MPC;TIE,13,3;', model, DIALECT_CALCULIX)
    call suite%that('not by a linear one', .not. model%steps(1)%is_nlgeom)
  end subroutine check_nlgeom


  include 'sample_deck.inc'

end program test_deck_steps
