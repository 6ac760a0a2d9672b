!> Unit test of deck_loads: degrees of freedom of supports, forces, pressures, tractions and volume loads, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_loads
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_loads, only: DISTRIBUTED_PRESSURE, DISTRIBUTED_GRAVITY, DISTRIBUTED_CENTRIFUGAL, DISTRIBUTED_BODY_FORCE, &
    DISTRIBUTED_TRACTION
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;11,0,0,2;' // &
    '12,1,0,2;13,1,1,2;14,0,1,2;90,5,5,5;91,0,3,0;92,1,3,0;93,1,4,0;94,0,4,0;*ELEMENT, TYPE=C3D8, ELSET=E;' // &
    '1,1,2,3,4,5,6,7,8;2,5,6,7,8,11,12,13,14;*ELEMENT, TYPE=CAX4, ELSET=A;3,91,92,93,94;*MATERIAL, NAME=M;*ELASTIC;1.,0.;' // &
    '*DENSITY;2.;*MATERIAL, NAME=LIGHT;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;*SOLID SECTION, ELSET=A, MATERIAL=' // &
    'LIGHT;*NSET, NSET=TOP;11,12,13,14;*SURFACE, NAME=UP;2,S2;1,S1;*SURFACE, NAME=DOTS, TYPE=NODE;TOP;' // &
    '*AMPLITUDE, NAME=R;0.,0.,1.,1.;*RIGID BODY, NSET=TOP, REF NODE=90;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_supports()
  call check_forces()
  call check_pressures()
  call check_volumes()
  call check_errors()
  call suite%finish()

contains

  !> Reads the cards of one step.
  subroutine read_step(cards)
    character(*), intent(in) :: cards
    call expect_read('', model, step='*STEP;*STATIC;' // cards // '*END STEP;')
  end subroutine read_step


  !> Reads a step with one message.
  subroutine expect(cards, piece, is_note)
    character(*), intent(in) :: cards, piece
    logical, intent(in), optional :: is_note
    call expect_message('', piece, step='*STEP;*STATIC;' // cards // '*END STEP;', is_note=is_note)
  end subroutine expect


  !> The degrees of freedom that a word fixes.
  subroutine expect_word(word, dofs)
    character(*), intent(in) :: word
    integer, intent(in) :: dofs(:)
    call read_step('*BOUNDARY;1,' // word // ';')
    call suite%that(word, size(model%steps(1)%prescribed) == size(dofs))
    if (size(model%steps(1)%prescribed) == size(dofs)) call suite%that(word // ': directions', &
      all(model%steps(1)%prescribed%dof == dofs))
  end subroutine expect_word


  !> Words, ranges, rotations of reference nodes and of others, values given twice, FIXED and USER.
  subroutine check_supports()
    call expect_word('ENCASTRE', [1, 2, 3])
    call expect_word('PINNED', [1, 2, 3])
    call expect_word('XSYMM', [1])
    call expect_word('YSYMM', [2])
    call expect_word('ZSYMM', [3])
    call expect_word('XASYMM', [2, 3])
    call expect_word('YASYMM', [1, 3])
    call expect_word('ZASYMM', [1, 2])
    call expect_word('2', [2])
    call expect_word('2,3', [2, 3])
    call read_step('*BOUNDARY, AMPLITUDE=R;1,1,2,.5;90,3,5,.25;')
    associate (p => model%steps(1)%prescribed)
      call suite%that('rotations are displacements of another node', size(p) == 5 .and. all(p%dof == [1, 2, 3, 1, 2]) .and. &
        p(3)%node == 13 .and. all(p(4:)%node == model%rotation_of(13)))
      call suite%near('values', maxval(abs(p%end - [0.5_DP, 0.5_DP, 0.25_DP, 0.25_DP, 0.25_DP])), 0.0_DP, 0.0_DP)
      call suite%that('amplitude', all(p%amplitude == 1))
    end associate
    call read_step('*BOUNDARY, FIXED;1,1;*BOUNDARY, USER;2,1;')
    call suite%that('fixed, by DISP', all(model%steps(1)%prescribed%is_held .eqv. [.true., .false.]) .and. &
      all(model%steps(1)%prescribed%is_user .eqv. [.false., .true.]))
    call expect('*BOUNDARY;1,4,6;', 'are passed over', is_note=.true.)
    call expect('*BOUNDARY;1,4,4,.5;', 'have no rotations')
    call expect('*BOUNDARY;1,1,1,.5;1,1,1,.25;', '1 displacement of this step had another value', is_note=.true.)
    call expect('*BOUNDARY, USER, FIXED;1,1;', 'without AMPLITUDE or FIXED')
    call expect('*BOUNDARY;1,11,11,5.;', '*TEMPERATURE prescribes')
    call expect('*BOUNDARY;1,0,2;', 'not above the last')
    call expect('*BOUNDARY;1,1,7;', 'not above the last')
    call expect('*BOUNDARY;1,GLUED;', 'it is ''GLUED''')
  end subroutine check_supports


  !> Forces and moments.
  subroutine check_forces()
    call read_step('*CLOAD;TOP,2,3.;11,2,1.;90,6,5.;')
    associate (f => model%steps(1)%concentrated)
      call suite%that('four forces and a moment', size(f) == 5 .and. all(f(:4)%node == [9, 10, 11, 12]) .and. &
        all(f(:4)%dof == 2) .and. f(5)%node == model%rotation_of(13) .and. f(5)%dof == 3)
      call suite%near('values', maxval(abs(f%end - [4.0_DP, 3.0_DP, 3.0_DP, 3.0_DP, 5.0_DP])), 0.0_DP, 0.0_DP)
      call suite%near('from zero', maxval(abs(f%start)), 0.0_DP, 0.0_DP)
    end associate
    call expect('*CLOAD;1,5,1.;', 'take no moments')
    call expect('*CLOAD;1,0,1.;', 'of a moment 4, 5 or 6')
  end subroutine check_forces


  !> Pressure on faces and surfaces, by DLOAD; traction with its direction of length 1.
  subroutine check_pressures()
    call read_step('*DLOAD;E,P2,3.;2,P2,1.;')
    associate (d => model%steps(1)%distributed)
      call suite%that('faces', size(d) == 2 .and. all(d%element == [1, 2]) .and. all(d%face == 2) .and. &
        all(d%kind == DISTRIBUTED_PRESSURE))
      call suite%near('they add up', maxval(abs(d%end - [3.0_DP, 4.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call read_step('*DSLOAD;UP,P,3.;')
    call suite%that('faces of a surface', all(model%steps(1)%distributed%element == [2, 1]) .and. &
      all(model%steps(1)%distributed%face == [2, 1]))
    call read_step('*DLOAD;1,P3NU,3.;')
    call suite%that('by DLOAD', model%steps(1)%distributed(1)%is_user .and. model%steps(1)%distributed(1)%face == 3)
    call read_step('*DLOAD;1,TRVEC3NU,3.;1,TRSHR3NU,2.,0,0,5;')
    associate (d => model%steps(1)%distributed)
      call suite%that('by UTRACLOAD', size(d) == 2 .and. all(d%kind == DISTRIBUTED_TRACTION) .and. all(d%is_user) .and. &
        all(d%face == 3) .and. all(d%surface == 0) .and. (d(1)%is_shear .neqv. d(2)%is_shear))
      call suite%near('its direction, not projected', norm2(d(1)%direction + d(2)%direction - [0.0_DP, 0.0_DP, 1.0_DP]), 0.0_DP, &
        0.0_DP)
    end associate
    call read_step('*DSLOAD;UP,TRVECNU;')
    call suite%that('by UTRACLOAD on a surface', all(model%steps(1)%distributed%is_user) .and. &
      all(model%steps(1)%distributed%surface > 0))
    call read_step('*DLOAD;2,TRVEC1,5.,0,3,4;2,TRSHR2,1.,0,1,0;')
    associate (d => model%steps(1)%distributed)
      call suite%that('traction on faces of elements', size(d) == 2 .and. all(d%kind == DISTRIBUTED_TRACTION) .and. &
        all(d%element == 2) .and. all(d%face == [1, 2]))
      call suite%near('its direction', maxval(abs(d(1)%direction - [0.0_DP, 0.6_DP, 0.8_DP])), 0.0_DP, 1.0e-15_DP)
    end associate
    call read_step('*DSLOAD, FOLLOWER=NO, CONSTANT RESULTANT=YES;UP,TRVEC,5.,0,3,4;')
    associate (d => model%steps(1)%distributed)
      call suite%that('traction', size(d) == 2 .and. all(d%kind == DISTRIBUTED_TRACTION) .and. all(d%face == [2, 1]) .and. &
        .not. any(d%is_follower))
      call suite%near('unit direction', maxval(abs(d(2)%direction - [0.0_DP, 0.6_DP, 0.8_DP])), 0.0_DP, 1.0e-15_DP)
      call suite%near('magnitude', d(2)%end, 5.0_DP, 0.0_DP)
    end associate
    call read_step('*DSLOAD, FOLLOWER=NO, CONSTANT RESULTANT=YES;UP,TRSHR,5.,1,1,1;UP,TRVEC,2.,1,1,1;')
    associate (d => model%steps(1)%distributed)
      call suite%that('shear traction beside another one', size(d) == 4 .and. count(abs(d%end - 5) <= 0) == 2)
      call suite%near('unit vector', norm2(d(2)%direction), 1.0_DP, 1.0e-15_DP)
      call suite%near('along the face', maxval(abs(d(1)%direction - [sqrt(0.5_DP), sqrt(0.5_DP), 0.0_DP])), 0.0_DP, 1.0e-15_DP)
    end associate
    call read_step('*DSLOAD;UP,TRVEC,5.,0,3,4;')
    call suite%that('turns with its face', all(model%steps(1)%distributed%is_follower))
    call read_step('*DSLOAD, FOLLOWER=NO;UP,TRVEC,5.,0,3,4;')
    call suite%that('or changes with its area', all(model%steps(1)%distributed%is_follower))
  end subroutine check_pressures


  !> Gravity, rotation, forces per volume.
  subroutine check_volumes()
    call read_step('*DLOAD;E,GRAV,9.,0,0,-2;E,CENTRIF,4.,1,2,3,0,5,0;1,BY,7.;')
    associate (d => model%steps(1)%distributed)
      call suite%that('five', size(d) == 5 .and. all(d%kind == [DISTRIBUTED_GRAVITY, DISTRIBUTED_GRAVITY, &
        DISTRIBUTED_CENTRIFUGAL, DISTRIBUTED_CENTRIFUGAL, DISTRIBUTED_BODY_FORCE]))
      call suite%near('down', maxval(abs(d(2)%direction - [0.0_DP, 0.0_DP, -1.0_DP])), 0.0_DP, 0.0_DP)
      call suite%near('axis', maxval(abs([d(3)%point, d(3)%direction] - [1.0_DP, 2.0_DP, 3.0_DP, 0.0_DP, 1.0_DP, 0.0_DP])), &
        0.0_DP, 0.0_DP)
      call suite%near('square of the velocity', d(3)%end, 4.0_DP, 0.0_DP)
      call suite%near('along y', maxval(abs(d(5)%direction - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call read_step('*DLOAD;A,BX,1.;')
    call suite%that('without a density', size(model%steps(1)%distributed) == 1)
    call read_step('*DLOAD;,BX,1.;')
    call suite%that('on the whole model', size(model%steps(1)%distributed) == 3)
    call expect('*DLOAD;A,GRAV,9.,0,-1,0;', '''LIGHT'' has no *DENSITY')
    call expect('*DLOAD;E,GRAV,9.;', 'direction must not be zero')
    call expect('*DLOAD;E,CENTRIF,-1.,0,0,0,0,1,0;', 'is not negative')
    call expect('*DLOAD;A,CENTRIF,1.,1,0,0,0,1,0;', 'turn about the y axis')
  end subroutine check_volumes


  !> What is refused.
  subroutine check_errors()
    call expect('*DLOAD;A,P6,1.;', 'takes no load P6')
    call expect('*DLOAD;E,PRESS,1.;', 'it is ''PRESS''')
    call expect('*DSLOAD;UP,P1,1.;', 'TRVEC, a force')
    call expect('*DSLOAD;E,P,1.;', 'is a set of elements')
    call expect('*DLOAD;A,TRVEC1NU,1.,0,1,0;', 'UTRACLOAD is for the faces of solids')
    call expect('*DLOAD, AMPLITUDE=R;1,TRVEC1NU,1.,0,1,0;', 'The routine UTRACLOAD gives the whole load')
    call expect('*DLOAD;1,TRVEC7,1.,0,0,1;', 'takes no load TRVEC7')
    call expect('*DSLOAD;NIX,P,1.;', 'no surface ''NIX''')
    call expect('*DSLOAD;DOTS,P,1.;', 'made of nodes')
    call expect('*DSLOAD;UP,TRVEC,1.;', 'direction must not be zero')
    call expect('*DSLOAD;UP,TRSHR,1.,0,0,2;', 'is normal to face')
    call expect('*DSLOAD, FOLLOWER=NO;UP,P,1.;', 'a pressure follows its face')
    call expect('*DLOAD, AMPLITUDE=R;1,P1NU,1.;', 'AMPLITUDE must not be given with P1NU')
    call expect('*DLOAD;A,P1NU,1.;', 'for the faces of solids')
    call expect_message('', 'needs FOLLOWER=NO', step='*STEP, NLGEOM;*STATIC;*DSLOAD;UP,TRVEC,1.,1,0,0;*END STEP;')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_loads
