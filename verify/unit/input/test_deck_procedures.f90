!> Unit test of deck_procedures: the data line of RIKS, its defaults, and what a step that follows a path cannot have.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_procedures
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '*NSET, NSET=SIX;6;*NSET, NSET=TWO;5,6;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*AMPLITUDE, NAME=A;0.,0.,1.,1.;' // &
    '*MATERIAL, NAME=M;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;*BOUNDARY;1,1,3;2,2,3;4,3;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: RIKS = '*STEP, NLGEOM;*STATIC, RIKS;', LOAD = '*CLOAD;7,3,2.;', END = '*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_data()
  call check_monitored()
  call check_refusals()
  call suite%finish()

contains

  !> The arcs and the largest load factor of a RIKS step.
  subroutine expect_arcs(data, arcs)
    character(*), intent(in) :: data
    real(DP), intent(in) :: arcs(5)                !< first, whole, least, largest, load factor
    call expect_read('', model, step=RIKS // data // LOAD // END)
    associate (t => model%steps(1))
      call suite%that('RIKS is read', t%is_riks)
      call suite%that('arcs of ' // data, all(abs([t%dt_initial, t%period, t%dt_min, t%dt_max, t%path_end%load_factor] - arcs) <= &
        1.0e-15_DP * arcs))
    end associate
  end subroutine expect_arcs


  !> Given and default arcs.
  subroutine check_data()
    real(DP), parameter :: NONE = huge(1.0_DP)
    call expect_arcs('', [1.0_DP, 1.0_DP, 1.0e-5_DP, NONE, NONE])
    call expect_arcs('.25,2.;', [0.25_DP, 2.0_DP, 2.0e-5_DP, NONE, NONE])
    call expect_arcs('.25,2.,.125,.5,3.;', [0.25_DP, 2.0_DP, 0.125_DP, 0.5_DP, 3.0_DP])
    call suite%that('no node is monitored', .not. allocated(model%steps(1)%path_end%nodes))
    call expect_read('', model, step='*STEP;*STATIC;' // LOAD // END // RIKS // '.1;*CLOAD;7,3,4.;' // END)
    call suite%that('RIKS does not last', (.not. model%steps(1)%is_riks) .and. model%steps(2)%is_riks)
    call suite%near('RIKS: loads start where the step before ended', model%steps(2)%concentrated(1)%start, 2.0_DP, 1.0e-15_DP)
  end subroutine check_data


  !> The node whose displacement ends the step.
  subroutine check_monitored()
    call expect_read('', model, step=RIKS // '.1,,,,,6,2,-0.5;' // LOAD // END)
    associate (limit => model%steps(1)%path_end)
      call suite%that('monitored: node, direction, value', all(limit%nodes == [6]) .and. limit%dof == 2 .and. &
        abs(limit%displacement + 0.5_DP) <= 0)
    end associate
    call expect_read('', model, step=RIKS // '.1,,,,,SIX,1,1.;' // LOAD // END)
    call suite%that('monitored: a set of one', all(model%steps(1)%path_end%nodes == [6]))
    call expect_message('', 'One node is monitored; the set has 2', step=RIKS // '.1,,,,,TWO,1,1.;' // LOAD // END)
    call expect_message('', 'must be 1 to 3', step=RIKS // '.1,,,,,6,4,1.;' // LOAD // END)
    call expect_message('', 'must be 1 to 3', step=RIKS // '.1,,,,,6,,1.;' // LOAD // END)
    call expect_message('', 'needs its degree of freedom and the displacement', step=RIKS // '.1,,,,,6,1;' // LOAD // END)
    call expect_message('', 'proportionality factor must be positive', step=RIKS // '.1,,,,-1.;' // LOAD // END)
  end subroutine check_monitored


  !> Each with its line; all of a step at once.
  subroutine check_refusals()
    call expect_message('', 'No load changes in this RIKS step', step=RIKS // END)
    call expect_message('', 'No step can follow a RIKS step', step=RIKS // LOAD // END // '*STEP;*STATIC;' // END)
    call expect_message('', 'RIKS and STABILIZE exclude each other', step='*STEP;*STATIC, RIKS, STABILIZE;' // LOAD // END)
    call expect_message('', 'without PERTURBATION', step='*STEP, PERTURBATION;*STATIC, RIKS;' // LOAD // END)
    call expect_message('', 'without PERTURBATION', step='*STEP;*VISCO, RIKS;' // LOAD // END)
    call expect_message('', 'needs the matrix', step='*STEP;*STATIC, RIKS, SOLVER=CONJUGATE GRADIENTS;' // LOAD // END)
    call expect_message('', 'leave out AMPLITUDE=STEP', step='*STEP, AMPLITUDE=STEP;*STATIC, RIKS;' // LOAD // END)
    call expect_message('', 'follows an AMPLITUDE', step=RIKS // '*CLOAD, AMPLITUDE=A;7,3,2.;' // END)
    call expect_message('', 'Temperatures do not change', step=RIKS // LOAD // '*TEMPERATURE;7,20.;' // END)
    call expect_message('*TIME POINTS, NAME=T;.5;', 'TIME POINTS have no meaning', step=RIKS // LOAD // &
      '*NODE PRINT, NSET=SIX, TIME POINTS=T;U;' // END)
  end subroutine check_refusals


  include 'sample_deck.inc'

end program test_deck_procedures
