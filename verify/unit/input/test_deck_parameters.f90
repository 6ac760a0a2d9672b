!> Unit test of deck_parameters: values of expressions as the deck receives them, the order of lines, and what has no value.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_parameters
  use check, only: suite_type
  use samples, only: deck_lines
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=ALL;1,0,0,0;2,1,0,0;3,0,1,0;4,0,0,1;*ELEMENT, TYPE=C3D4, ELSET=E;' // &
    '1,1,2,3,4;' // &
    '*SOLID SECTION, ELSET=E, MATERIAL=M;*MATERIAL, NAME=M;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;1,1;*BOUNDARY;ALL,1,3;*END STEP;'
  type(suite_type) :: suite

  call check_values()
  call check_troubles()
  call suite%finish()

contains

  include 'sample_deck.inc'

  !> The modulus of a material that is the parameter e.
  subroutine expect_value(lines, expected)
    character(*), intent(in) :: lines
    real(DP), intent(in) :: expected
    type(model_type) :: model
    call expect_read('*PARAMETER;' // lines // ';*ELASTIC;<e>,0;', model)
    call suite%near(lines, model%materials(1)%youngs_modulus, expected, 1.0e-12_DP * abs(expected))
  end subroutine expect_value


  !> Python's arithmetic.
  subroutine check_values()
    call expect_value('e = 210', 210.0_DP)
    call expect_value('e = 2 + 3*4', 14.0_DP)
    call expect_value('e = (2 + 3)*4', 20.0_DP)
    call expect_value('e = 10 - 3 - 2', 5.0_DP)
    call expect_value('e = 64/8/2', 4.0_DP)
    call expect_value('e = 2**3**2', 512.0_DP)
    call expect_value('e = 10 + -2**2', 6.0_DP)
    call expect_value('e = 2**-1 + 1', 1.5_DP)
    call expect_value('b_1 = 4;e = 2*b_1 + b_1', 12.0_DP)
    call expect_value('b = 4;b = 5;e = b', 5.0_DP)
    call expect_value('e = 7  # a remark', 7.0_DP)
    call expect_value('e = 6/3', 2.0_DP)
    call expect_value('e = 7/2', 3.0_DP)
    call expect_value('e = 7/2.', 3.5_DP)
    call expect_value('e = 10 + -7/2', 6.0_DP)
    call expect_value('n = 7;m = -2;e = 10 + n/m', 6.0_DP)
    call expect_value('e = 7/2*2', 6.0_DP)
    call expect_value('e = 1 + 2**-1/2', 1.25_DP)
    call expect_value('e = sqrt(2.)**2', 2.0_DP)
    call expect_value('p = atan(1.);e = 4*sin(2*p)**2 + abs(-cos (4*p))', 5.0_DP)
    call expect_value('e = exp(log(3.)) + log10(100) + tan(0) + asin(0) + acos(1)', 5.0_DP)
    call expect_value('e = cosh(1.)**2 - sinh(1.)**2 + tanh(0)', 1.0_DP)
    call expect_value('sin = 2;e = sin + abs(-3)', 5.0_DP)
  end subroutine check_values


  !> Each has one message.
  subroutine check_troubles()
    call expect_message('*PARAMETER;e = 3/2;*ELASTIC;<e>,0;', 'e 3/2 is rounded down to 1, because both are integers', &
      is_note=.true.)
    call expect_message('*PARAMETER;e = 3/0.;*ELASTIC;1,0;', 'divides by zero')
    call expect_message('*PARAMETER;e = b;b = 1;*ELASTIC;1,0;', 'no parameter ''b''')
    call expect_message('*ELASTIC;<e>,0;*PARAMETER;e = 1;', 'no parameter ''e''')
    call expect_message('*PARAMETER;e = 1;*ELASTIC;<e,0;', 'which is missing')
    call expect_message('*PARAMETER;e = (1 + 2;*ELASTIC;1,0;', 'not closed')
    call expect_message('*PARAMETER;e = (-2)**0.5;*ELASTIC;1,0;', 'negative number')
    call expect_message('*PARAMETER;e = 1e300*1e300;*ELASTIC;1,0;', 'not finite')
    call expect_message('*PARAMETER;e = 1 $ 2;*ELASTIC;1,0;', 'not understood')
    call expect_message('*PARAMETER;1e = 2;*ELASTIC;1,0;', 'letters, digits')
    call expect_message('*PARAMETER;e = ;*ELASTIC;1,0;', 'is missing')
  end subroutine check_troubles

end program test_deck_parameters
