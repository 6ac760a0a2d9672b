!> Unit test of amontons_deck_property_tables: what tables and curves are over, lines of eight values, and rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_property_tables
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;'
  character(*), parameter :: REST = '*SOLID SECTION,ELSET=E,MATERIAL=M;*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite

  call check_tables()
  call check_curves()
  call check_rejected()
  call suite%finish()

contains

  !> Reads a deck with a material; the text of the first error, '' without.
  subroutine read(cards, model, first_error)
    character(*), intent(in) :: cards
    type(model_type), intent(out) :: model
    character(:), allocatable, intent(out) :: first_error
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    options%dialect = DIALECT_ABAQUS
    call read_deck_text(deck_lines(START // cards // REST), options, model, diagnostics, error)
    first_error = ''
    do i = diagnostics%n_items, 1, -1
      if (.not. diagnostics%items(i)%is_warning) first_error = diagnostics%items(i)%text
    end do
  end subroutine read


  !> Records of more than eight values continue; a table is over the temperature or over the field variable that changes.
  subroutine check_tables()
    type(model_type) :: model
    character(:), allocatable :: text
    call read('*ELASTIC,TYPE=ORTHO;9.,1.,8.,1.,1.,7.,3.,2.;1.,5.;', model, text)
    call suite%that('nine constants in two lines', text == '')
    call suite%near('ninth constant', model%materials(1)%elastic%value(9, 1), 1.0_DP, 0.0_DP)
    call suite%near('its temperature', model%materials(1)%elastic%temperature(1), 5.0_DP, 0.0_DP)
    call read('*ELASTIC,DEPENDENCIES=2;100.,.3,20.,0.,7.;200.,.3,20.,0.,9.;', model, text)
    call suite%that('two field variables', text == '')
    call suite%that('the second one counts', model%materials(1)%elastic%variable == 2)
    call suite%near('its values', maxval(abs(model%materials(1)%elastic%temperature - [7.0_DP, 9.0_DP])), 0.0_DP, 0.0_DP)
  end subroutine check_tables


  !> A new temperature starts a new curve.
  subroutine check_curves()
    type(model_type) :: model
    character(:), allocatable :: text
    call read('*ELASTIC;100.,.3;*PLASTIC;1.,0.,0.;2.,.1,0.;3.,0.,50.;', model, text)
    call suite%that('two curves', text == '' .and. size(model%materials(1)%isotropic_hardening) == 2)
    call suite%near('second temperature', model%materials(1)%isotropic_hardening(2)%temperature, 50.0_DP, 0.0_DP)
    call suite%that('points of the first', size(model%materials(1)%isotropic_hardening(1)%stress) == 2)
  end subroutine check_curves


  !> Rejected tables.
  subroutine check_rejected()
    call bad('*ELASTIC;100.,.3,50.;200.,.3,0.;', 'must ascend')
    call bad('*ELASTIC,DEPENDENCIES=1;100.,.3,0.,0.;200.,.3,10.,1.;', 'one column')
    call bad('*ELASTIC,TYPE=ORTHO;9.,1.,8.;', 'constants')
    call bad('*ELASTIC;100.,.3;*PLASTIC;1.,0.1;', 'first point')
    call bad('*ELASTIC;100.,.3;*PLASTIC;-1.,0.;', 'must be positive')
    call bad('*ELASTIC;100.,.3;*PLASTIC;', 'needs data')
  end subroutine check_rejected


  !> A deck with an error whose text contains some words.
  subroutine bad(cards, words)
    character(*), intent(in) :: cards, words
    type(model_type) :: model
    character(:), allocatable :: text
    call read(cards, model, text)
    call suite%that(cards // ' is rejected: ' // text, index(text, words) > 0)
  end subroutine bad

end program test_deck_property_tables
