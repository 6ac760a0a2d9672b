!> Unit test of amontons_deck_creep: constants of creep, the routine of the user, and rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_creep
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_materials, only: CREEP_TIME_HARDENING, CREEP_STRAIN_HARDENING, CREEP_USER
  use amontons_model, only: model_type, job_options_type
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;'
  character(*), parameter :: ELASTIC = '*ELASTIC;1000.,.3;', USER = '*CREEP,LAW=USER;'
  type(suite_type) :: suite
  type(model_type) :: model
  character(:), allocatable :: text

  call read(ELASTIC // '*CREEP;1.E-9,3.,-.2;', model, text)
  call suite%that('constants: ' // text, text == '' .and. model%materials(1)%creep_law == CREEP_TIME_HARDENING)
  call suite%near('n', model%materials(1)%creep%value(2, 1), 3.0_DP, 0.0_DP)
  call read(ELASTIC // '*CREEP,LAW=STRAIN;1.E-9,3.,-.2;', model, text)
  call suite%that('strain hardening: ' // text, text == '' .and. model%materials(1)%creep_law == CREEP_STRAIN_HARDENING)
  call read(ELASTIC // USER, model, text)
  call suite%that('a routine: ' // text, text == '' .and. model%materials(1)%creep_law == CREEP_USER .and. .not. &
    allocated(model%materials(1)%creep%value))
  call suite%that('its history', model%materials(1)%n_history > 0)
  call reject(ELASTIC // '*CREEP;1.E-9,3.,.2;', 'not above 0')
  call reject(ELASTIC // USER // '1.E-9,3.,0.;', 'LAW=USER has no data')
  call reject('*ELASTIC,TYPE=ENGINEERING CONSTANTS;1000.,900.,800.,.3,.3,.3,400.,300.;350.;' // USER, 'elasticity that is not iso')
  call reject(ELASTIC // USER // '*DEPVAR;2;', 'DEPVAR')
  call reject(ELASTIC // USER // '*USER DEFINED FIELD;', 'neither PREDEF nor STATEV')
  call reject(ELASTIC // USER // '*PLASTIC,HARDENING=KINEMATIC;1.,0.;', 'kinematic hardening')
  call suite%finish()

contains

  !> Reads the cards of a material M; the text of the first error, '' without.
  subroutine read(cards, model, first_error)
    character(*), intent(in) :: cards
    type(model_type), intent(out) :: model
    character(:), allocatable, intent(out) :: first_error
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    call read_deck_text(deck_lines(START // cards // '*SOLID SECTION,ELSET=E,MATERIAL=M;*STEP;*STATIC;*END STEP;'), options, &
      model, diagnostics, error)
    first_error = ''
    do i = diagnostics%n_items, 1, -1
      if (.not. diagnostics%items(i)%is_warning) first_error = diagnostics%items(i)%text
    end do
  end subroutine read


  !> Cards that are rejected with some words.
  subroutine reject(cards, words)
    character(*), intent(in) :: cards, words
    type(model_type) :: model
    character(:), allocatable :: text
    call read(cards, model, text)
    call suite%that(words // ' in: ' // text, index(text, words) > 0)
  end subroutine reject

end program test_deck_creep
