!> Unit test of amontons_deck_cap: the constants of a cap, and rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_cap
  use amontons_kinds, only: DP, PI
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;'
  type(suite_type) :: suite
  character(*), parameter :: ELASTIC = '*ELASTIC;1000.,.3;', CAP = '*CAP PLASTICITY;3.,35.,.4,.002,.1,1.;', &
    HARDENING = '*CAP HARDENING;20.,0.;60.,.02;'
  type(model_type) :: model
  character(:), allocatable :: text

  call read(ELASTIC // CAP // HARDENING, model, text)
  call suite%that('a cap: ' // text, text == '')
  associate (material => model%materials(1))
    call suite%that('flags', material%has_cap .and. material%is_unsymmetric .and. material%n_history > 0)
    call suite%near('constants', norm2(material%cone%value(:, 1) - [35 * PI / 180, 3.0_DP, 0.4_DP, 0.002_DP, 0.1_DP]), 0.0_DP, &
      1.0e-14_DP)
    call suite%near('hardening', material%isotropic_hardening(1)%stress(2), 60.0_DP, 0.0_DP)
  end associate
  call read(ELASTIC // '*CAP PLASTICITY;3.,35.,.4;' // HARDENING, model, text)
  call suite%that('blank fields: ' // text, text == '')
  call reject(ELASTIC // '*CAP PLASTICITY;3.,35.,.4,.002,.1,.8;' // HARDENING, 'K must be 1')
  call reject(ELASTIC // '*CAP PLASTICITY;0.,0.,.4,.002,.1;' // HARDENING, 'must not both be 0')
  call reject(ELASTIC // '*CAP PLASTICITY;3.,80.,.4,.002,.1;' // HARDENING, 'friction angle must be')
  call reject(ELASTIC // '*CAP PLASTICITY;3.,35.,0.,.002,.1;' // HARDENING, 'R must be positive')
  call reject(ELASTIC // '*CAP PLASTICITY;3.,35.,.4,-.002,.1;' // HARDENING, 'initial volumetric')
  call reject(ELASTIC // '*CAP PLASTICITY;3.,35.,.4,.002,1.;' // HARDENING, 'alpha')
  call reject(ELASTIC // '*CAP PLASTICITY;3.,70.,.4,.002,.9;' // HARDENING, 'would have no cap')
  call reject(ELASTIC // CAP, 'needs both')
  call reject(ELASTIC // HARDENING, 'needs both')
  call reject(ELASTIC // CAP // CAP // HARDENING, 'has a law of yield before')
  call reject(ELASTIC // CAP // '*CAP HARDENING;20.,0.;10.,.02;', 'must not decrease')
  call reject(ELASTIC // CAP // '*CAP HARDENING;0.,0.;10.,.02;', 'must be positive')
  call reject(ELASTIC // '*DRUCKER PRAGER;30.,1.,30.;' // HARDENING, 'HARDENING of another law')
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

end program test_deck_cap
