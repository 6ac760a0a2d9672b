!> Unit test of deck_section_beams: numbers of all sections in both dialects, elements that take them, what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_section_beams
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_element_kinds, only: KIND_USER
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=N;1,0,0,0;2,1,0,0;3,2,0,0;*MATERIAL, NAME=M;*ELASTIC;100.,0.25;'
  character(*), parameter :: STEP_PART = '*STEP, NLGEOM=NO;*STATIC;*BOUNDARY;1,1,6;*END STEP;'
  character(*), parameter :: B31 = '*ELEMENT, TYPE=B31, ELSET=B;1,1,2;2,2,3;', U1 = '*USER ELEMENT, TYPE=U1, NODES=2, ' // &
    'INTEGRATION POINTS=2, MAXDOF=6;*ELEMENT, TYPE=U1, ELSET=B;1,1,2;2,2,3;'
  real(DP), parameter :: ROUNDING = 1.0e-13_DP
  type(suite_type) :: suite
  type(model_type) :: model
  call check_general()
  call check_sections()
  call check_shapes()
  call check_errors()
  call suite%finish()

contains

  !> A card with material M, its data, and direction 1 along y.
  pure function section(word, data) result(card)
    character(*), intent(in) :: word, data
    character(:), allocatable :: card
    card = '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=' // word // ';' // data // ';0,1,0;'
  end function section


  !> The same line means the moments of inertia about direction 1, 2 in Abaqus, along them in CalculiX. G = 40.
  subroutine check_general()
    call expect_read(B31 // '*BEAM GENERAL SECTION, ELSET=B, SECTION=GENERAL;2.,3.,.5,5.,7.;0,1,0;100.,40.;', model)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('E A, G J', norm2([s%axial, s%torsion] - [200.0_DP, 280.0_DP]), 0.0_DP, ROUNDING)
      call suite%near('E I', norm2([s%bending] - [300.0_DP, -50.0_DP, -50.0_DP, 500.0_DP]), 0.0_DP, 1.0e-12_DP)
      call suite%near('G A', norm2(s%shear - 80.0_DP), 0.0_DP, ROUNDING)
      call suite%near('direction', norm2(s%direction - [0.0_DP, 1.0_DP, 0.0_DP]), 0.0_DP, 0.0_DP)
    end associate
    call suite%that('elements', all(model%mesh%kind == KIND_USER) .and. size(model%user_elements%elements) == 2)
    call suite%that('rotation nodes', all(model%rotation_of(:3) > 0))
    call expect_read(U1 // section('GENERAL', '2.,3.,0.,5.,.8'), model, DIALECT_CALCULIX)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('calculix: G J', s%torsion, 40.0_DP * 8, 1.0e-12_DP)
      call suite%near('calculix: E I', norm2([s%bending] - [500.0_DP, 0.0_DP, 0.0_DP, 300.0_DP]), 0.0_DP, 1.0e-12_DP)
      call suite%near('calculix: k G A', norm2(s%shear - 64.0_DP), 0.0_DP, ROUNDING)
    end associate
  end subroutine check_general


  !> A rectangle as an I; an uneven I; a thin box; a box whose walls differ, against the sum of its four walls.
  subroutine check_sections()
    real(DP) :: area, middle
    call expect_read(B31 // section('I', '1.,2.,.6,.6,.5,.5,.6'), model)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('rectangle: area', s%axial, 120.0_DP, 1.0e-12_DP)
      call suite%near('rectangle: I', norm2([s%bending] - 100 * [0.6_DP * 8 / 12, 0.0_DP, 0.0_DP, 2 * 0.216_DP / 12]), 0.0_DP, &
        1.0e-12_DP)
      call suite%near('rectangle: centroid', norm2(s%centroid), 0.0_DP, ROUNDING)
      call suite%near('shear', norm2(s%shear - 0.44_DP * 40 * 1.2_DP), 0.0_DP, 1.0e-12_DP)
    end associate
    call expect_read(B31 // section('I', '0.,10.,6.,4.,1.,2.,.5'), model)
    area = 6.0_DP * 1 + 4.0_DP * 2 + 7.0_DP * 0.5_DP
    middle = (6.0_DP * 0.5_DP + 8.0_DP * 9 + 3.5_DP * 4.5_DP) / area
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('I: area', s%axial, 100 * area, 1.0e-11_DP)
      call suite%near('I: centroid', s%centroid(2), middle, ROUNDING)
      call suite%near('I: J', s%torsion, 40 * (6 * 1.0_DP + 4 * 8.0_DP + 7 * 0.125_DP) / 3, 1.0e-11_DP)
      call suite%near('I: about direction 1', s%bending(1, 1), 100 * (6.0_DP / 12 + 6 * (0.5_DP - middle)**2 + 4 * 8.0_DP / 12 + &
        8 * (9 - middle)**2 + 0.5_DP * 343 / 12 + 3.5_DP * (4.5_DP - middle)**2), 1.0e-10_DP)
    end associate
    call expect_read(B31 // section('BOX', '4.,6.,.2,.2,.2,.2'), model)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('box: J of Bredt', s%torsion, 40 * 4 * (3.8_DP * 5.8_DP)**2 / (2 * (3.8_DP + 5.8_DP) / 0.2_DP), 1.0e-9_DP)
      call suite%near('box: I', s%bending(1, 1), 100 * (4 * 216.0_DP - 3.6_DP * 5.6_DP**3) / 12, 1.0e-10_DP)
      call suite%near('box: centroid', norm2(s%centroid), 0.0_DP, ROUNDING)
    end associate
    call expect_read(B31 // section('BOX', '4.,6.,.2,.3,.4,.5'), model)
    associate (s => model%user_elements%properties(1)%section)
      area = 6 * 0.6_DP + 3.4_DP * 0.8_DP        ! walls at +1, -1, then at +2, -2 between them
      middle = (1.2_DP * 1.9_DP - 2.4_DP * 1.8_DP + 3.4_DP * 0.8_DP * 0.1_DP) / area
      call suite%near('walls: area', s%axial, 100 * area, 1.0e-11_DP)
      call suite%near('walls: centroid', s%centroid(1), middle, ROUNDING)
      call suite%near('walls: about direction 2', s%bending(2, 2), 100 * (6 * (0.2_DP**3 + 0.4_DP**3) / 12 + &
        0.8_DP * 3.4_DP**3 / 12 + 1.2_DP * (1.9_DP - middle)**2 + &
        2.4_DP * (1.8_DP + middle)**2 + 2.72_DP * (0.1_DP - middle)**2), 1.0e-11_DP)
    end associate
  end subroutine check_sections


  !> T, L, HEX, TRAPEZOID, ARBITRARY: the numbers reach the right place; a line of integration points is passed over.
  subroutine check_shapes()
    call expect_read(B31 // section('I', '0.,10.,0.,4.,0.,2.,.5'), model)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('T', norm2([s%axial / 100, s%centroid(2), s%shear_center(2)] - [12.0_DP, 88 / 12.0_DP, 9.0_DP]), 0.0_DP, &
        1.0e-11_DP)
    end associate
    call expect_read(B31 // section('L', '4.,6.,.5,.25') // '5,5;', model)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('L', norm2([s%axial / 100, s%torsion / 40, s%shear(1) / 40] - [3.375_DP, &
        (4 * 0.125_DP + 5.5_DP * 0.015625_DP) / 3, 3.375_DP]), 0.0_DP, 1.0e-11_DP)
      call suite%near('L: centroid', norm2(s%centroid - [2 * 1.875_DP, 1.375_DP * 3] / 3.375_DP), 0.0_DP, 1.0e-12_DP)
      call suite%that('L: a wide leg bends the other way', s%bending(1, 2) > 0)
    end associate
    call expect_read(B31 // section('HEX', '2.,.1'), model)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('HEX', s%axial / 100, 6 * 0.1_DP * (2 - 0.1_DP / sqrt(3.0_DP)), 1.0e-12_DP)
      call suite%near('HEX: shear', s%shear(1) / s%axial, 0.53_DP * 0.4_DP, 1.0e-12_DP)
    end associate
    call expect_read(B31 // section('TRAPEZOID', '3.,2.,1.,.5'), model)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('TRAPEZOID', norm2([s%axial / 100, s%centroid(2)] - [4.0_DP, 10 / 12.0_DP - 0.5_DP]), 0.0_DP, 1.0e-12_DP)
    end associate
    call expect_read(B31 // section('ARBITRARY', '3,3.,-4.,0.,-4.,.1;0.,4.,.2;3.,4.,.1'), model)
    associate (s => model%user_elements%properties(1)%section)
      call suite%near('channel', norm2([s%axial / 100, s%bending(1, 1) / 100] - [2.2_DP, 0.2_DP * 512 / 12 + 9.6_DP]), 0.0_DP, &
        1.0e-11_DP)
      call suite%near('its direction', norm2(s%direction - [0.0_DP, 1.0_DP, 0.0_DP]), 0.0_DP, 0.0_DP)
    end associate
    call expect_read(B31 // '*BEAM GENERAL SECTION, ELSET=B, SECTION=ARBITRARY;2,1.,0.,0.,0.,.1;0.,1.,.1;0,1,0;100.,40.;', model)
    call suite%near('general section', model%user_elements%properties(1)%section%axial, 20.0_DP, 1.0e-12_DP)
    call expect_read(B31 // section('THICK PIPE', '1.,.2') // '3,8;', model)
  end subroutine check_shapes


  !> What is refused.
  subroutine check_errors()
    character(*), parameter :: GENERAL = '*BEAM GENERAL SECTION, ELSET=B, SECTION=GENERAL;'
    call expect_message(B31 // section('GENERAL', '2.,3.,.5,5.,7.'), 'belongs to *BEAM GENERAL SECTION')
    call expect_message(U1 // section('GENERAL', '2.,3.,.5,5.,.8'), 'I12 must be 0', DIALECT_CALCULIX)
    call expect_message(U1 // section('I', '1.,2.,.6,.6,.5,.5,.6'), 'CalculiX has no SECTION=I', DIALECT_CALCULIX)
    call expect_message(U1, 'BEAM SECTION, SECTION=GENERAL names a set', DIALECT_CALCULIX)
    call expect_message('*USER ELEMENT, TYPE=US3, NODES=3, INTEGRATION POINTS=1, MAXDOF=6;' // B31 // &
      section('RECT', '.1,.1'), 'only the beam TYPE=U1', &
      DIALECT_CALCULIX)
    call expect_message('*ELEMENT, TYPE=B32, ELSET=B;1,1,2,3;' // section('I', '1.,2.,.6,.6,.5,.5,.6'), 'is no B31')
    call expect_message(B31 // section('GENERAL', '2.,3.,0.,5.,.8'), 'is no U1', DIALECT_CALCULIX)
    call expect_message('*ELEMENT, TYPE=B21, ELSET=B;1,1,2;' // section('BOX', '4.,6.,.2,.2,.2,.2'), 'is no B31')
    call expect_message(B31 // section('I', '1.,2.,.6,.6,1.5,.5,.6'), 'flanges must leave a web')
    call expect_message(B31 // section('I', '1.,2.,0.,0.,0.,0.,.6'), 'a T has one flange')
    call expect_message(B31 // section('I', '1.,2.,1.,0.,.1,.1,.6'), 'a T has one flange')
    call expect_message(B31 // section('BOX', '4.,6.,2.,.2,2.,.2'), 'opposite walls thinner')
    call expect_message(B31 // section('L', '4.,6.,.2,4.'), 'each leg longer than the other is thick')
    call expect_message(B31 // section('HEX', '1.,.9'), 'wall thinner than 0.866')
    call expect_message(B31 // section('TRAPEZOID', '1.,.9,0.,0.'), 'all positive, and the height of the node')
    call expect_message(B31 // section('T', '1.,.9'), 'A T is an I with one flange')
    call expect_message(B31 // section('ARBITRARY', '1,0.,0.,1.,0.,.1'), 'a single one is a RECT')
    call expect_message(B31 // '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=ARBITRARY;2,0.,0.,1.,0.,.1;', 'lines of only 1 follow')
    call expect_message(B31 // section('ARBITRARY', '2,0.,0.,1.,0.,.1;1.,0.,.1'), 'A wall has a length')
    call expect_message(B31 // section('ARBITRARY', '3,0.,0.,1.,0.,.1;1.,1.,0.;2.,2.,.1'), 'only goes back along a wall')
    call expect_message(B31 // section('ARBITRARY', '2,0.,0.,1.,0.,.1;2.,0.,.1'), 'lie on one line')
    call expect_message(B31 // section('ARBITRARY', '4,0.,0.,1.,0.,.1;1.,1.,.1;0.,0.,.1;-1.,0.,.1'), 'no fins on a cell')
    call expect_message(B31 // section('L', '4.,6.,.5,.25') // '5,x;', 'number of integration points')
    call expect_message(U1 // section('L', '4.,6.,.5,.25'), 'CalculiX has no SECTION=L', DIALECT_CALCULIX)
    call expect_message(B31 // GENERAL // '2.,3.,5.,5.,7.;0,1,0;100.,40.;', 'I11 I22 > I12^2')
    call expect_message(B31 // GENERAL // '2.,3.,0.,5.,7.;0,1,0;', 'needs a third data line')
    call expect_message(B31 // GENERAL, 'data line with the numbers of the section is missing')
    call expect_message(B31 // GENERAL // '2.,3.,0.,5.,7.;0,1,0;100.,-40.;', 'moduli must be positive')
    call expect_message(B31 // GENERAL // '2.,3.,0.,5.,7.;1,0,0;100.,40.;', 'lies along the first direction')
    call expect_message(B31 // GENERAL // '2.,3.,0.,5.,7.;0,0,0;100.,40.;', 'direction must not be zero')
    call expect_message('*MATERIAL, NAME=P;*ELASTIC;100.,.3;*PLASTIC;1.;' // B31 // &
      '*BEAM SECTION, ELSET=B, MATERIAL=P, SECTION=I;1.,2.,.6,.6,.5,.5,.6;0,1,0;', 'linear isotropic elastic')
    call expect_message(B31 // section('I', '1.,2.,.6,.6,.5,.5,.6') // '*STEP, NLGEOM;*STATIC;*END STEP;', 'small rotations')
    call expect_message(B31 // GENERAL // '2.,3.,0.,5.,7.;0,1,0;100.,40.,1E-5;*STEP;*STATIC;*TEMPERATURE;N,10.;*END STEP;', &
      'do not expand')
    call expect_message(B31 // GENERAL // '2.,3.,0.,5.,7.;0,1,0;100.,40.;*STEP;*STATIC;*DLOAD;B,GRAV,10.,0,0,-1;*END STEP;', &
      'put its weight on its nodes')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_section_beams
