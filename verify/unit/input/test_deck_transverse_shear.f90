!> Unit test of amontons_deck_transverse_shear: materials of shells, layers and stiffnesses of beams, and rejected cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_transverse_shear
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_materials, only: ELASTIC_ANISOTROPIC
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=N;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;*MATERIAL, NAME=M;*ELASTIC;100.,0.25;' // &
    '*ELEMENT, TYPE=S4, ELSET=S;1,1,2,3,4;'
  character(*), parameter :: STEP_PART = '*STEP, NLGEOM=NO;*STATIC;*BOUNDARY;1,1,6;*END STEP;'
  character(*), parameter :: SHEET = '*SHELL SECTION, ELSET=S, MATERIAL=M;0.5;', CARD = '*TRANSVERSE SHEAR STIFFNESS;'
  character(*), parameter :: BEAM = '*ELEMENT,TYPE=B31,ELSET=B;30,1,2;*BEAM SECTION,ELSET=B,MATERIAL=M,SECTION='
  type(suite_type) :: suite
  type(model_type) :: model
  call check_shells()
  call check_layers()
  call check_beams()
  call check_errors()
  call suite%finish()

contains

  !> One layer: G = K/h; the rest is that of the material, which stays for others.
  subroutine check_shells()
    call expect_read(SHEET // CARD // '4.,6.,1.;', model)
    call suite%that('another material', size(model%materials) == 2 .and. all(model%mesh%material == 2))
    call suite%that('anisotropic', model%materials(2)%elastic_kind == ELASTIC_ANISOTROPIC)
    associate (D => model%materials(2)%elastic%value(:, 1))
      call suite%near('membrane', norm2(D([1, 2, 3, 4, 6, 10]) - [real(DP) :: 120, 40, 120, 40, 120, 40]), 0.0_DP, 1.0e-11_DP)
      call suite%near('shear', norm2(D([15, 20, 21]) - [real(DP) :: 8, 2, 12]), 0.0_DP, 1.0e-12_DP)
      call suite%near('no other', norm2(D([7, 8, 9, 11, 12, 13, 14, 16, 17, 18, 19])), 0.0_DP, 0.0_DP)
    end associate
    call expect_read(SHEET // '*HOURGLASS STIFFNESS;1.;' // CARD // '4.,6.,1.;', model)
    call suite%that('behind a card without effect', size(model%materials) == 2)
    call expect_read(SHEET // CARD // ',6.;', model)
    call suite%near('K11 as K22', norm2(model%materials(2)%elastic%value([15, 20, 21], 1) - [real(DP) :: 12, 0, 12]), 0.0_DP, &
      1.0e-12_DP)
    call expect_read(SHEET, model)
    call suite%that('without the card', size(model%materials) == 1)
  end subroutine check_shells


  !> Two equal layers, one at 90 degrees: G = K/h over the share of two layers of constant stress, which is 1 as for one.
  subroutine check_layers()
    integer :: k
    call expect_read('*SHELL SECTION, ELSET=S, COMPOSITE;0.25,,M,0.;0.25,,M,90.;' // CARD // '4.,6.,1.;', model)
    call suite%that('materials of the layers', size(model%materials) == 3 .and. all(model%mesh%material == [2, 3]))
    call suite%near('the first', norm2(model%materials(2)%elastic%value([15, 20, 21], 1) - [real(DP) :: 8, 2, 12]), 0.0_DP, &
      1.0e-10_DP)
    call suite%near('the turned one', norm2(model%materials(3)%elastic%value([15, 20, 21], 1) - [real(DP) :: 12, -2, 8]), 0.0_DP, &
      1.0e-10_DP)
    call expect_read('*SHELL GENERAL SECTION, ELSET=S;60.,20.,40.,0.,0.,10.,0.,0.;0.,20.,0.,0.,0.,6.6666666666666667,' // &
      '13.333333333333333,0.;0.,0.,0.,0.,3.3333333333333333;' // CARD // '4.,6.;', model)
    do k = 2, 6                                    ! five equal layers: 5/6 and a little more
      call suite%near('by stiffness', norm2(model%materials(k)%elastic%value([15, 21], 1) - [4.0_DP, 6.0_DP] / 2 * 1.16128_DP), &
        0.0_DP, 1.0e-7_DP)
    end do
  end subroutine check_layers


  !> K23 is first and belongs to direction 2.
  subroutine check_beams()
    call expect_read(SHEET // BEAM // 'L;.3,.2,.01,.01;0.,1.,0.;' // CARD // '7.,5.,SCF;', model)
    call suite%near('stiffnesses', norm2(model%user_elements%properties(1)%section%shear - [real(DP) :: 5, 7]), 0.0_DP, 0.0_DP)
    call expect_read(SHEET // BEAM // 'L;.3,.2,.01,.01;0.,1.,0.;' // CARD // '0.,5.,0.3;', model)
    call suite%near('K23 as K13', norm2(model%user_elements%properties(1)%section%shear - [real(DP) :: 5, 5]), 0.0_DP, 0.0_DP)
  end subroutine check_beams


  !> What is refused.
  subroutine check_errors()
    call expect_message(SHEET // CARD // '4.,6.,5.;', 'larger than the square')
    call expect_message(SHEET // CARD // '0.,0.;', 'K11 and K22 must be positive')
    call expect_message(SHEET // CARD // 'x;', 'K11')
    call expect_message(SHEET // CARD // '4.;' // CARD // '4.;', 'must be directly below')
    call expect_message(SHEET // '*TRANSVERSE SHEAR STIFFNESS;', 'The data line is missing')
    call expect_message(SHEET // CARD // '4.;', 'CalculiX has no *TRANSVERSE SHEAR STIFFNESS', DIALECT_CALCULIX)
    call expect_message('*SHELL SECTION, ELSET=S, COMPOSITE;0.25,,M,O;' // CARD // '4.;*ORIENTATION, NAME=O;1.,0.,0.,0.,1.,0.;', &
      'the layers take angles')
    call expect_message('*MATERIAL, NAME=E;*SHELL SECTION, ELSET=S, MATERIAL=E;0.5;' // CARD // '4.,6.;', 'has no *ELASTIC card')
    call expect_message(SHEET // BEAM // 'RECT;.1,.1;0.,1.,0.;' // CARD // '4.;', 'whose shear stiffness is that of their material')
    call expect_message(SHEET // BEAM // 'L;.3,.2,.01,.01;0.,1.,0.;' // CARD // '4.,4.,-1.;', 'is not negative')
    call expect_message('*ELEMENT, TYPE=S8R, ELSET=S;2,1,2,3,4,11,12,13,14;*NODE;11,.5,0,0;12,1,.5,0;13,.5,1,0;14,0,.5,0;' // &
      '*SHELL SECTION, ELSET=S, COMPOSITE;0.25,,M;' // CARD // '4.;', 'give each group a section of its own')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_transverse_shear
