!> Unit test of deck_test_data: test cards to constants in their places, notes and errors.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_test_data
  use amontons_deck, only: read_deck_text
  use amontons_deck_test_data, only: hyperelastic_powers
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*SOLID SECTION, ELSET=E, MATERIAL=M;*BOUNDARY;1,1;*MATERIAL, NAME=M;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  call check_powers()
  call check_constants()
  call check_errors()
  call suite%finish()

contains

  !> 10, 01, 20, 11, 02, 30, ...
  subroutine check_powers()
    call suite%that('powers', all(hyperelastic_powers(2) == reshape([1, 0, 0, 1, 2, 0, 1, 1, 0, 2], [2, 5])))
    call suite%that('powers of order 3', all(hyperelastic_powers(3) == reshape([1, 0, 0, 1, 2, 0, 1, 1, 0, 2, 3, 0, 2, 1, 1, 2, &
      0, 3], [2, 9])))
  end subroutine check_powers


  !> Points of C10 = 0.5, C20 = 0.1 at strains of 1 and -0.5: T = 2 (l - l^-2) (C10 + 2 C20 (I1 - 3)).
  subroutine check_constants()
    type(model_type) :: model
    call expect_read('*HYPERELASTIC, REDUCED POLYNOMIAL, N=2, TEST DATA INPUT, POISSON=.49;*UNIAXIAL TEST DATA;' // &
      points_of(0.5_DP, 0.1_DP), model)
    associate (value => model%materials(1)%elastic%value(:, 1))
      call suite%near('C10', value(1), 0.5_DP, 1.0e-9_DP)
      call suite%near('C01', value(2), 0.0_DP, 0.0_DP)
      call suite%near('C20', value(3), 0.1_DP, 1.0e-9_DP)
      call suite%near('D1 of a ratio', value(6), 3 * (1 - 0.98_DP) / (1 * 1.49_DP), 1.0e-8_DP)
      call suite%near('D2', value(7), 0.0_DP, 0.0_DP)
    end associate
    call expect_message('*HYPERELASTIC, NEO HOOKE, TEST DATA INPUT, POISSON=.49;*UNIAXIAL TEST DATA;' // &
      points_of(0.5_DP, 0.0_DP), 'The test data give C10 = 0.5', is_note=.true.)
    call expect_message('*HYPERELASTIC, YEOH, TEST DATA INPUT, POISSON=.49;*UNIAXIAL TEST DATA;1.,.5;1.2,1.;1.,1.5;3.,2.;', &
      'falls with the stretch', is_note=.true.)
  end subroutine check_constants


  !> Data lines of three points.
  function points_of(C10, C20) result(rows)
    real(DP), intent(in) :: C10, C20
    character(:), allocatable :: rows
    real(DP), parameter :: STRETCHES(3) = [0.5_DP, 1.0_DP, 2.0_DP]
    character(64) :: row
    integer :: i
    rows = ''
    do i = 1, 3
      associate (l => STRETCHES(i))
        write (row, '(es24.16, ",", f5.2, ";")') 2 * (l - 1 / l**2) * (C10 + 2 * C20 * (l**2 + 2 / l - 3)), l - 1
      end associate
      rows = rows // trim(row)
    end do
  end function points_of


  !> What is refused.
  subroutine check_errors()
    character(*), parameter :: NEO = '*HYPERELASTIC, NEO HOOKE, TEST DATA INPUT;'
    call expect_message(NEO // '*UNIAXIAL TEST DATA;', 'cannot be found from 0 points')
    call expect_message(NEO // '1.,0.;*UNIAXIAL TEST DATA;1.,1.;', 'the data lines are those of')
    call expect_message(NEO // '*UNIAXIAL TEST DATA;1.,-.5;', 'the same sign')
    call expect_message(NEO // '*UNIAXIAL TEST DATA;-1.,-1.;', 'above -1')
    call expect_message('*HYPERELASTIC, NEO HOOKE, TEST DATA INPUT, POISSON=.6;*UNIAXIAL TEST DATA;1.,1.;', 'at most 0.5')
    call expect_message('*HYPERELASTIC, OGDEN, TEST DATA INPUT;*UNIAXIAL TEST DATA;1.,1.;', 'constants of polynomials')
    call expect_message('*HYPERELASTIC, MOONEY-RIVLIN, TEST DATA INPUT;*PLANAR TEST DATA;1.,1.;2.,2.;', 'do not determine')
    call expect_message('*HYPERELASTIC, NEO HOOKE;1.,.1;*UNIAXIAL TEST DATA;1.,1.;', 'must be directly below')
    call expect_message(NEO // '*UNIAXIAL TEST DATA;1.,1.;', 'CalculiX has no TEST DATA', DIALECT_CALCULIX)
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_test_data
