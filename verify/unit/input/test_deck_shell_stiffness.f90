!> Unit test of deck_shell_stiffness: layers of a stiffness, MATERIAL and COMPOSITE of SHELL GENERAL SECTION, what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_shell_stiffness
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=N;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;*MATERIAL, NAME=M;*ELASTIC;100.,0.25;' // &
    '*ELEMENT, TYPE=S4, ELSET=S;1,1,2,3,4;'
  character(*), parameter :: STEP_PART = '*STEP, NLGEOM=NO;*STATIC;*BOUNDARY;1,1,6;*END STEP;'
  character(*), parameter :: CARD = '*SHELL GENERAL SECTION, ELSET=S'
  character(*), parameter :: BENDING = '0.,20.,0.,0.,0.,6.6666666666666667,13.333333333333333,0.;0.,0.,0.,0.,3.3333333333333333;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_sections()
  call check_errors()
  call suite%finish()

contains

  !> A homogeneous plate of thickness 2 and Q = (30, 10, 20; 5), by its numbers; as a material; of layers.
  subroutine check_sections()
    integer :: k
    call expect_read(CARD // ', DENSITY=6.;60.,20.,40.,0.,0.,10.,0.,0.;' // BENDING, model)
    call suite%that('layers', size(model%structure%sections(1)%layers) == 5 .and. model%mesh%n_elements == 5)
    call suite%near('their thickness', maxval(abs(model%structure%sections(1)%layers%thickness - 0.4_DP)), 0.0_DP, &
      1.0e-12_DP)
    call suite%that('their materials', size(model%materials) == 6)
    do k = 2, 6
      associate (material => model%materials(k))
        call suite%near('density', material%density * sum(model%structure%sections(1)%layers%thickness), 6.0_DP, 1.0e-12_DP)
        call suite%near('stiffness', norm2(material%elastic%value([1, 2, 3, 10], 1) - [30.0_DP, 10.0_DP, 20.0_DP, &
          5.0_DP]), 0.0_DP, 1.0e-9_DP)
      end associate
    end do
    call expect_read(CARD // ', MATERIAL=M;0.1;', model)
    call suite%near('as a material', model%structure%sections(1)%thickness(1), 0.1_DP, 0.0_DP)
    call expect_read(CARD // ', COMPOSITE;0.1,,M;0.2,,M;', model)
    call suite%that('composite', size(model%structure%sections(1)%layers) == 2)
  end subroutine check_sections


  !> What is refused.
  subroutine check_errors()
    character(*), parameter :: LINES = '60.,20.,40.,0.,0.,10.,0.,0.;' // BENDING
    call expect_message(CARD // ';60.,20.,40.;', 'three lines of 8, 8 and 5 numbers')
    call expect_message(CARD // ';' // LINES // '1.,2.;', 'Thermal forces')
    call expect_message(CARD // ';60.,x,40.;1.;1.;', 'stiffness of the section')
    call expect_message(CARD // ';60.,20.,40.,0.,0.,-10.,0.,0.;' // BENDING, 'positive definite')
    call expect_message(CARD // ';60.,20.,40.,0.,0.,10.,0.,0.;0.,2000.,0.,0.,0.,6.,13.,0.;0.,0.,0.,0.,3.;', 'No layers of solids')
    call expect_message(CARD // ', NODAL THICKNESS;' // LINES, 'has no NODAL THICKNESS')
    call expect_message(CARD // ', MATERIAL=M;', 'needs a data line with the thickness')
    call expect_message(CARD // ', MATERIAL=M;0.1;', 'CalculiX has no *SHELL GENERAL SECTION', DIALECT_CALCULIX)
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_shell_stiffness
