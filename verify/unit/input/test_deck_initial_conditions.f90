!> Unit test of deck_initial_conditions: axes of sections, values at points by element, temperatures over the steps.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_initial_conditions
  use amontons_kinds, only: DP, PI
  use amontons_deck, only: read_deck_text
  use amontons_deck_initial_conditions, only: active_temperatures_type, init_temperatures, get_step_temperatures, &
    truncate_temperatures
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_loads, only: temperature_type
  use amontons_materials, only: SYSTEM_RECTANGULAR, SYSTEM_CYLINDRICAL, HISTORY_PEEQ, HISTORY_INELASTIC, HISTORY_BACK
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;11,0,0,2;' // &
    '12,1,0,2;13,1,1,2;14,0,1,2;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;2,5,6,7,8,11,12,13,14;*ELSET, ELSET=B;2;' // &
    '*MATERIAL, NAME=M;*ELASTIC;1.,0.;*PLASTIC;1.,0.;*NSET, NSET=TOP;11,12;*AMPLITUDE, NAME=A;0.,0.,1.,.5;*AMPLITUDE, NAME=T,' // &
    'TIME=TOTAL TIME;0.,0.,10.,1.;*ORIENTATION, NAME=O;0,1,0,-1,0,0;3,90.;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: SECTION = '*SOLID SECTION, ELSET=E, MATERIAL=M;', INITIAL = SECTION // '*INITIAL CONDITIONS, TYPE='
  type(suite_type) :: suite
  type(model_type) :: model
  call check_axes()
  call check_points()
  call check_variables()
  call check_temperatures()
  call check_early_end()
  call check_errors()
  call suite%finish()

contains

  !> Orientation of a section with its turn; of a distribution by element.
  subroutine check_axes()
    call expect_read(SECTION // '*SOLID SECTION, ELSET=B, MATERIAL=M, ORIENTATION=O;', model)
    associate (o => model%orientations(1))
      call suite%that('of the second element', all(model%element_orientation == [0, 1]) .and. o%system == SYSTEM_RECTANGULAR)
      call suite%near('points', maxval(abs([o%a, o%b] - [0.0_DP, 1.0_DP, 0.0_DP, -1.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
      call suite%that('turns about its third axis', o%rotation_axis == 3)
      call suite%near('by 90 degrees', o%rotation_angle, PI / 2, 1.0e-15_DP)
    end associate
    call expect_read('*SOLID SECTION, ELSET=E, MATERIAL=M, ORIENTATION=P;*ORIENTATION, NAME=P, SYSTEM=CYLINDRICAL;D;' // &
      '*DISTRIBUTION, NAME=D, LOCATION=ELEMENT;,0,0,0,0,0,1;2,1,0,0,1,0,1;', model)
    call suite%that('one for each line', size(model%orientations) == 4 .and. all(model%element_orientation == [3, 4]))
    call suite%that('all of one system', all(model%orientations(2:)%system == SYSTEM_CYLINDRICAL))
    call suite%near('of element 2', model%orientations(4)%a(1), 1.0_DP, 0.0_DP)
    call expect_read('*SOLID SECTION, ELSET=E, MATERIAL=M, ORIENTATION=P;*ORIENTATION, NAME=P;D;3,T;' // &
      '*DISTRIBUTION, NAME=D, LOCATION=ELEMENT;,1,0,0,0,1,0;2,0,1,0,1,0,0;*DISTRIBUTION, NAME=T;,30.;2,90.;', model)
    associate (o => model%orientations(model%element_orientation))
      call suite%near('angles', norm2(o%rotation_angle - [PI / 6, PI / 2]), 0.0_DP, 1.0e-15_DP)
      call suite%that('about their axis, with axes of their own', all(o%rotation_axis == 3) .and. o(2)%a(2) > 0)
    end associate
    call expect_message(SECTION // '*ORIENTATION, NAME=P;1,0,0,0,1,0;3,Q;', 'no distribution ''Q''')
    call expect_message('*SOLID SECTION, ELSET=E, MATERIAL=M, ORIENTATION=P;*ORIENTATION, NAME=P;1,0,0,0,1,0;3,T;' // &
      '*DISTRIBUTION, NAME=T;,x;', 'angle')
    call expect_message(SECTION // '*ORIENTATION, NAME=P;1,0,0,2,0,0;', 'give no axes')
    call expect_message(SECTION // '*ORIENTATION, NAME=P, SYSTEM=CYLINDRICAL;1,0,0,1,0,0;', 'give no axes')
    call expect_message(SECTION // '*ORIENTATION, NAME=P;1,0,0,0,1,0;4,5.;', 'must be 1, 2 or 3')
    call expect_message(SECTION // '*ORIENTATION, NAME=P;Q;', 'no distribution ''Q''')
    call expect_message(SECTION // '*ORIENTATION, NAME=P;', 'coordinates of two points')
    call expect_message(SECTION // '*ORIENTATION, NAME=o;1,0,0,0,1,0;', 'defined twice')
    call expect_message('*SOLID SECTION, ELSET=E, MATERIAL=M, ORIENTATION=Q;', 'no orientation ''Q''')
  end subroutine check_axes


  !> Stress, plastic strain, hardening: shears 12 13 23 of the deck are stored as 12 23 13; points by number in CalculiX.
  subroutine check_points()
    call expect_read(INITIAL // 'STRESS;2,1.,2.,3.,4.,5.,6.;', model)
    call suite%near('stress', maxval(abs(model%initial_stress(:, 16) - [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 6.0_DP, 5.0_DP])), 0.0_DP, &
      0.0_DP)
    call suite%near('the other element has none', maxval(abs(model%initial_stress(:, :8))), 0.0_DP, 0.0_DP)
    call expect_read(INITIAL // 'STRESS;2,3,1.,2.,3.,4.,5.,6.;', model, DIALECT_CALCULIX)
    call suite%near('at one point', model%initial_stress(1, 11), 1.0_DP, 0.0_DP)
    call suite%near('at no other', sum(abs(model%initial_stress(1, :))), 1.0_DP, 0.0_DP)
    call expect_read(INITIAL // 'PLASTIC STRAIN;1,1.,2.,3.,4.,5.,6.;', model)
    call suite%near('plastic strain', maxval(abs(model%initial_history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5, 8) - [1.0_DP, &
      2.0_DP, 3.0_DP, 4.0_DP, 6.0_DP, 5.0_DP])), 0.0_DP, 0.0_DP)
    call expect_read(INITIAL // 'HARDENING;B,.5,1.,2.,3.,4.,5.,6.;', model)
    call suite%near('equivalent plastic strain', model%initial_history(HISTORY_PEEQ, 9), 0.5_DP, 0.0_DP)
    call suite%near('back stress', maxval(abs(model%initial_history(HISTORY_BACK:HISTORY_BACK + 5, 9) - [1.0_DP, 2.0_DP, 3.0_DP, &
      4.0_DP, 6.0_DP, 5.0_DP])), 0.0_DP, 0.0_DP)
    call expect_message(INITIAL // 'STRESS;2,9,1.,2.,3.,4.,5.,6.;', 'has no integration point 9; it has 8', DIALECT_CALCULIX)
    call expect_message(INITIAL // 'DISPLACEMENT;', 'have no effect', is_note=.true.)
  end subroutine check_points


  !> SOLUTION: seven values, then eight in a line, as many as DEPVAR says.
  subroutine check_variables()
    character(*), parameter :: USER = '*MATERIAL, NAME=U;*USER MATERIAL, CONSTANTS=1;1.;*DEPVAR;9;' // &
      '*SOLID SECTION, ELSET=E, MATERIAL=U;*INITIAL CONDITIONS, TYPE=SOLUTION'
    integer :: i
    call expect_read(USER // ';2,1,2,3,4,5,6,7;8,9;', model)
    call suite%near('nine values', maxval(abs(model%initial_statev(:, 9) - [(real(i, DP), i=1, 9)])), 0.0_DP, 0.0_DP)
    call suite%near('of element 2 alone', maxval(abs(model%initial_statev(:, 8))), 0.0_DP, 0.0_DP)
    call expect_read(USER // ', USER;', model)
    call suite%that('SDVINI', model%has_sdvini)
    call expect_message(USER // ';2,1,2,3,4,5,6,7;8,9,10;', 'at most 2')
    call expect_message(INITIAL // 'SOLUTION;2;', 'has no *DEPVAR')
    call expect_message(INITIAL // 'STRESS, USER;', 'USER goes with TYPE=SOLUTION')
  end subroutine check_variables


  !> The temperature of a node in a step.
  subroutine expect_temperature(name, step, node, start, end)
    character(*), intent(in) :: name
    integer, intent(in) :: step, node              !< index of the node
    real(DP), intent(in) :: start, end
    integer :: i
    associate (t => model%steps(step)%temperatures)
      i = findloc(t%node, node, dim=1)
      call suite%that(name // ' is there', i > 0)
      if (i == 0) return
      call suite%near(name // ': start', t(i)%start, start, 1.0e-14_DP)
      call suite%near(name // ': end', t(i)%end, end, 1.0e-14_DP)
    end associate
  end subroutine expect_temperature


  !> From the initial temperature, from the last one, back to the initial one, at once, by amplitudes.
  subroutine check_temperatures()
    character(*), parameter :: STEP = '*STEP;*STATIC;', DONE = '*END STEP;'
    call expect_read(INITIAL // 'TEMPERATURE;TOP,20.;', model, step=STEP // '*TEMPERATURE;11,50.;1,7.;' // DONE // STEP // &
      '*TEMPERATURE;11,80.;' // DONE // STEP // '*TEMPERATURE, OP=NEW;' // DONE // &
      '*STEP, AMPLITUDE=STEP;*STATIC;*TEMPERATURE;11,5.;' // DONE)
    call suite%near('initial', model%initial_temperature(10), 20.0_DP, 0.0_DP)
    call expect_temperature('from the initial one', 1, 9, 20.0_DP, 50.0_DP)
    call expect_temperature('from zero', 1, 1, 0.0_DP, 7.0_DP)
    call expect_temperature('from the last one', 2, 9, 50.0_DP, 80.0_DP)
    call suite%that('a node that keeps its temperature is in no list', size(model%steps(2)%temperatures) == 1)
    call expect_temperature('back', 3, 9, 80.0_DP, 20.0_DP)
    call expect_temperature('back to zero', 3, 1, 7.0_DP, 0.0_DP)
    call expect_temperature('at once', 4, 9, 5.0_DP, 5.0_DP)
    call expect_read(SECTION, model, step=STEP // '*TEMPERATURE, AMPLITUDE=A;1,40.;*TEMPERATURE, AMPLITUDE=T;2,30.;' // DONE // &
      STEP // '*TEMPERATURE;1,0.;' // DONE)
    call expect_temperature('half of it was reached', 2, 1, 20.0_DP, 0.0_DP)
    call suite%that('total time continues', any(model%steps(2)%temperatures%node == 2 .and. &
      model%steps(2)%temperatures%amplitude == 2))
  end subroutine check_temperatures


  !> A step that ends after a quarter.
  subroutine check_early_end()
    type(active_temperatures_type) :: thermal
    type(temperature_type), allocatable :: list(:)
    call init_temperatures(model, thermal)
    thermal%loads = [temperature_type(start=10.0_DP, end=50.0_DP, node=1), temperature_type(start=10.0_DP, end=50.0_DP, node=2, &
      amplitude=1)]
    thermal%n = 2
    call truncate_temperatures(thermal, 0.25_DP)
    call get_step_temperatures(thermal, list)
    call suite%near('a quarter of the way; an amplitude is untouched', abs(list(1)%end - 20) + abs(list(2)%end - 50), 0.0_DP, &
      0.0_DP)
  end subroutine check_early_end


  !> What is refused.
  subroutine check_errors()
    call expect_message(INITIAL // 'TEMPERATURE;Q,20.;', 'no node or node set ''Q''')
    call expect_message(INITIAL // 'STRESS;Q,1.,2.,3.,4.,5.,6.;', 'no element or element set ''Q''')
    call expect_message(INITIAL // 'TEMPERATURE;TOP,warm;', 'must be a real number')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_initial_conditions
