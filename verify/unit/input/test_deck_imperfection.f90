!> Unit test of amontons_deck_imperfection: offsets in the three systems, nodes and sets, sums, and rejected cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_imperfection
  use amontons_kinds, only: DP, PI
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '*NSET,NSET=TOP;5,6,7,8;*ELEMENT,TYPE=C3D8,ELSET=E;7,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;*ELASTIC;100.,.3;' // &
    '*SOLID SECTION,ELSET=E,MATERIAL=M;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*BOUNDARY;1,1,3;*END STEP;'
  real(DP), parameter :: TINY = 1e-15_DP         !< rounding of coordinates of size one
  type(suite_type) :: suite
  type(model_type) :: model
  call check_systems()
  call check_sums()
  call check_errors()
  call suite%finish()

contains

  !> Cartesian, cylindrical and spherical offsets; coordinates that are not given stay.
  subroutine check_systems()
    call expect_read('*IMPERFECTION;7,.1,-.2,.3;', model)
    call suite%near('Cartesian', norm2(place(7) - [1.1_DP, 0.8_DP, 1.3_DP]), 0.0_DP, TINY)
    call suite%near('the others', norm2(place(6) - [1.0_DP, 0.0_DP, 1.0_DP]), 0.0_DP, 0.0_DP)
    call expect_read('*IMPERFECTION,SYSTEM=C;6,.5,90.,.25;', model)
    call suite%near('cylindrical', norm2(place(6) - [0.0_DP, 1.5_DP, 1.25_DP]), 0.0_DP, TINY)
    call expect_read('*IMPERFECTION,SYSTEM=S;3,1.,0.,90.;7,.1;', model)
    call suite%near('spherical: above the plane', norm2(place(3) - [0.0_DP, 0.0_DP, 1 + sqrt(2.0_DP)]), 0.0_DP, 4 * TINY)
    call suite%near('spherical: outward', norm2(place(7) - (1 + 0.1_DP / sqrt(3.0_DP))), 0.0_DP, 4 * TINY)
    call expect_read('*IMPERFECTION,SYSTEM=C;3,0.,45.;', model)
    call suite%near('an angle in degrees', atan2(model%mesh%coordinates(2, 3), model%mesh%coordinates(1, 3)), PI / 2, TINY)
  end subroutine check_systems


  !> Node sets; rows and cards of one node add up.
  subroutine check_sums()
    call expect_read('*IMPERFECTION;TOP,0.,0.,.5;5,,,.25;*IMPERFECTION;5,.125;', model)
    call suite%near('rows and cards', norm2(place(5) - [0.125_DP, 0.0_DP, 1.75_DP]), 0.0_DP, TINY)
    call suite%near('a set', norm2(place(8) - [0.0_DP, 1.0_DP, 1.5_DP]), 0.0_DP, TINY)
  end subroutine check_sums


  !> What is refused.
  subroutine check_errors()
    call expect_message('*IMPERFECTION,FILE=job,STEP=1;1,.01;', 'Modes are not read')
    call expect_message('*IMPERFECTION;', 'has no data')
    call expect_message('*IMPERFECTION;9,.1;', '9')
    call expect_message('*IMPERFECTION;X,.1;', 'X')
    call expect_message('*IMPERFECTION;1,a;', 'offset 1')
    call expect_message('*IMPERFECTION;1,.1,.1,.1,.1;', 'at most 4')
    call expect_message('*IMPERFECTION,SYSTEM=C;5,.1;', 'on the z axis')
    call expect_message('*IMPERFECTION,SYSTEM=Q;6,.1;', 'SYSTEM')
    call expect_message('*IMPERFECTION;1,.1;', 'CalculiX has no *IMPERFECTION', DIALECT_CALCULIX)
  end subroutine check_errors


  !> The place of a node; its number is its index.
  function place(i)
    integer, intent(in) :: i
    real(DP) :: place(3)
    place = model%mesh%coordinates(:, i)
  end function place


  include 'sample_deck.inc'

end program test_deck_imperfection
