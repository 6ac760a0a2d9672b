!> Unit test of deck_output: requests of prints and files over steps and dialects, time points, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_output
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_steps, only: PRINT_NODE, PRINT_ELEMENT, PRINT_CONTACT, PRINT_SECTION, FRD_DISP, FRD_FORC, FRD_STRESS, FRD_ERROR, &
    FRD_TOSTRAIN, FRD_CONTACT, FRD_PE
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;*NODE;' // &
    '91,0,3,0;' // &
    '92,1,3,0;93,1,4,0;94,0,4,0;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*ELEMENT, TYPE=CAX4, ELSET=A;3,91,92,93,94;' // &
    '*MATERIAL, NAME=M;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;*SOLID SECTION, ELSET=A, MATERIAL=M;*NSET, NSET=N;' // &
    '1,2;' // &
    '*SURFACE, NAME=F;1,S1;*SURFACE, NAME=RING;3,S1;*SURFACE, NAME=DOTS, TYPE=NODE;N;*BOUNDARY;1,1;'
  character(*), parameter :: STEP_PART = '*STEP, NLGEOM;*STATIC;.1,2.;*END STEP;'
  character(*), parameter :: S = '*STEP, NLGEOM;*STATIC;.1,2.;', END = '*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_prints()
  call check_steps()
  call check_frequencies()
  call check_fields()
  call check_times()
  call check_errors()
  call suite%finish()

contains

  !> Kind, set, variables, totals and axes of each card.
  subroutine check_prints()
    call expect_read('', model, step=S // '*NODE PRINT, NSET=N, TOTALS=YES;U,RF,U;*EL PRINT, ELSET=E, TOTALS=ONLY;S,PEEQ;' // &
      '*CONTACT PRINT, NSET=N, SLAVE=F;CDISP,CSTRESS;*SECTION PRINT, SURFACE=F, NAME=X;SOF;' // END)
    associate (p => model%steps(1)%prints)
      call suite%that('kinds', size(p) == 4 .and. all(p%kind == [PRINT_NODE, PRINT_ELEMENT, PRINT_CONTACT, PRINT_SECTION]))
      call suite%that('sets', model%mesh%node_sets(p(1)%set)%name == 'N' .and. model%mesh%element_sets(p(2)%set)%name == 'E' .and. &
        model%mesh%node_sets(p(3)%set)%name == 'N' .and. p(3)%slave == 1 .and. p(3)%master == 0 .and. p(4)%set == 1)
      call suite%that('variables, each once', size(p(1)%variables) == 2 .and. all(p(1)%variables == ['U   ', 'RF  ']))
      call suite%that('by four letters', all(p(3)%variables == ['CDIS', 'CSTR']))
      call suite%that('totals', all(p%is_totals .eqv. [.true., .false., .false., .false.]) .and. &
        all(p%is_only_totals .eqv. [.false., .true., .false., .false.]))
      call suite%that('nodes in global axes', .not. p(1)%is_local)
      call suite%that('elements in their own', p(2)%is_local)
    end associate
    call expect_read('', model, DIALECT_CALCULIX, step=S // '*NODE PRINT, NSET=N;U;*NODE PRINT, NSET=N, GLOBAL=YES;U;' // END)
    call suite%that('axes of nodes in CalculiX', all(model%steps(1)%prints%is_local .eqv. [.true., .false.]))
    call expect_message('', 'The variable A is not printed', step=S // '*NODE PRINT, NSET=N;U,A;' // END, is_note=.true.)
  end subroutine check_prints


  !> The first card of a kind in a step replaces those of the steps before.
  subroutine check_steps()
    call expect_read('', model, step=S // '*NODE PRINT, NSET=N;U;*NODE PRINT, NSET=N;RF;*EL PRINT, ELSET=E;S;' // END // S // &
      END // &
      S // '*NODE PRINT, NSET=N;NT;' // END)
    call suite%that('kept', size(model%steps(2)%prints) == 3)
    call suite%that('replaced', size(model%steps(3)%prints) == 2 .and. any(model%steps(3)%prints%kind == PRINT_ELEMENT) .and. &
      count(model%steps(3)%prints%kind == PRINT_NODE) == 1)
    call suite%that('by the new one', model%steps(3)%prints(2)%variables(1) == 'NT')
  end subroutine check_steps


  !> FREQUENCY: of prints and files apart; in CalculiX the last counts for both, but for 0.
  subroutine check_frequencies()
    character(*), parameter :: CARDS = '*NODE PRINT, NSET=N, FREQUENCY=3;U;*NODE FILE, FREQUENCY=5;U;'
    call expect_read('', model, step=S // CARDS // END)
    call suite%that('apart', model%steps(1)%print_frequency == 3 .and. model%steps(1)%file_frequency == 5)
    call expect_read('', model, DIALECT_CALCULIX, step=S // CARDS // END)
    call suite%that('the last', model%steps(1)%print_frequency == 5 .and. model%steps(1)%file_frequency == 5)
    call expect_read('', model, DIALECT_CALCULIX, step=S // CARDS // '*NODE PRINT, NSET=N, FREQUENCY=0;U;' // END)
    call suite%that('no prints', model%steps(1)%print_frequency == 0 .and. model%steps(1)%file_frequency == 5)
    call expect_read('', model, DIALECT_CALCULIX, step=S // '*NODE PRINT, NSET=N, FREQUENCY=0;U;*NODE FILE, FREQUENCY=5;U;' // END)
    call suite%that('still none', model%steps(1)%print_frequency == 0 .and. model%steps(1)%file_frequency == 5)
    call expect_message('', 'FREQUENCY must not be negative', step=S // '*NODE FILE, FREQUENCY=-1;U;' // END)
  end subroutine check_frequencies


  !> The fields of the .frd file that a step requests.
  subroutine expect_fields(cards, fields, dialect)
    character(*), intent(in) :: cards
    integer, intent(in) :: fields(:)
    integer, intent(in), optional :: dialect
    integer :: i
    call expect_read('', model, dialect, step=S // cards // END)
    call suite%that('fields of ' // cards, count(model%steps(1)%frd%is_wanted) == size(fields) .and. &
      all([(model%steps(1)%frd(fields(i))%is_wanted, i=1, size(fields))]))
  end subroutine expect_fields


  !> Stress brings its error unless NOE; strains, contact; HISTORY requests nothing; a second card of a kind adds.
  subroutine check_fields()
    call expect_fields('*NODE FILE;U,RF;*EL FILE;S;', [FRD_DISP, FRD_FORC, FRD_STRESS, FRD_ERROR])
    call expect_fields('*EL FILE;S,NOE;', [FRD_STRESS])
    call expect_fields('*EL FILE;E;*EL FILE;PEEQ;', [FRD_TOSTRAIN, FRD_PE])
    call expect_fields('*CONTACT FILE;CDIS,CSTR;', [FRD_CONTACT])
    call expect_fields('*NODE OUTPUT;U;*OUTPUT, HISTORY;U;', [FRD_DISP])
    call expect_read('', model, step=S // '*NODE FILE;U,RF;*EL FILE;S;' // END // S // '*NODE FILE;RF;' // END)
    call suite%that('the first of a step replaces its kind', .not. model%steps(2)%frd(FRD_DISP)%is_wanted .and. &
      model%steps(2)%frd(FRD_FORC)%is_wanted .and. model%steps(2)%frd(FRD_STRESS)%is_wanted)
    call expect_read('', model, DIALECT_CALCULIX, step=S // '*NODE FILE, NSET=N, GLOBAL=NO;U;' // END)
    call suite%that('nodes of a set, local axes', model%steps(1)%frd(FRD_DISP)%set > 0 .and. model%steps(1)%frd(FRD_DISP)%is_local)
    call expect_message('', 'what is in neither: FOO', step=S // '*NODE FILE;U,FOO,RF3;' // END, is_note=.true.)
    call expect_message('', 'There is no node set ''Q''', DIALECT_CALCULIX, step=S // '*NODE FILE, NSET=Q;U;' // END)
  end subroutine check_fields


  !> TIME POINTS: lists and ranges, in step and total time; those outside the step are left out.
  subroutine check_times()
    character(*), parameter :: PRINT = '*NODE PRINT, NSET=N, TIME POINTS=T;U;'
    call expect_read('*TIME POINTS, NAME=T;.5,1.5,2.,3.;', model, step=S // PRINT // END)
    call suite%that('two in the step', size(model%steps(1)%print_times) == 2 .and. .not. allocated(model%steps(1)%file_times))
    call suite%near('times', maxval(abs(model%steps(1)%print_times - [0.5_DP, 1.5_DP])), 0.0_DP, 0.0_DP)
    call expect_read('*TIME POINTS, NAME=T, TIME=TOTAL TIME;.5,2.75;', model, step=S // PRINT // END // S // END)
    call suite%that('one each', size(model%steps(1)%print_times) == 1 .and. size(model%steps(2)%print_times) == 1)
    call suite%near('in step time', model%steps(2)%print_times(1), 0.75_DP, 1.0e-15_DP)
    call expect_read('*TIME POINTS, NAME=T, GENERATE;.25,1.,.5;', model, step=S // PRINT // END)
    call suite%that('with the last', size(model%steps(1)%print_times) == 3)
    call suite%near('a range', maxval(abs(model%steps(1)%print_times - [0.25_DP, 0.75_DP, 1.0_DP])), 0.0_DP, 1.0e-15_DP)
    call expect_read('*TIME POINTS, NAME=T;.5;', model, step=S // PRINT // '*NODE PRINT, NSET=N, FREQUENCY=2;U;' // END)
    call suite%that('a later FREQUENCY ends the list', .not. allocated(model%steps(1)%print_times))
    call expect_message('*TIME POINTS, NAME=T;1.,.5;', 'must ascend')
    call expect_message('*TIME POINTS, NAME=T;', 'a data line with times')
    call expect_message('*TIME POINTS, NAME=T, GENERATE;0.,1.,0.;', 'a positive distance')
    call expect_message('*TIME POINTS, NAME=T;1.;*TIME POINTS, NAME=T;1.;', 'defined twice')
    call expect_message('', 'no time points ''Q''', step=S // '*NODE PRINT, NSET=N, TIME POINTS=Q;U;' // END)
  end subroutine check_times


  !> What is refused.
  subroutine check_errors()
    call expect_message('', 'There is no node set ''Q''', step=S // '*NODE PRINT, NSET=Q;U;' // END)
    call expect_message('', 'There is no element set ''Q''', step=S // '*EL PRINT, ELSET=Q;S;' // END)
    call expect_message('', '*NODE PRINT needs NSET', DIALECT_CALCULIX, step=S // '*NODE PRINT;U;' // END, is_note=.true.)
    call expect_message('', 'There is no surface ''Q''', step=S // '*CONTACT PRINT, MASTER=Q;CDIS;' // END)
    call expect_message('', 'There is no surface ''Q''', step=S // '*SECTION PRINT, SURFACE=Q, NAME=X;SOF;' // END)
    call expect_message('', 'is one of nodes', step=S // '*SECTION PRINT, SURFACE=DOTS, NAME=X;SOF;' // END)
    call expect_message('', 'not supported for axisymmetric', step=S // '*SECTION PRINT, SURFACE=RING, NAME=X;SOF;' // END)
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_output
