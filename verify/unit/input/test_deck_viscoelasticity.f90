!> Unit test of amontons_deck_viscoelasticity: Prony series, long-term and instantaneous constants, and rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_viscoelasticity
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;*ELEMENT,ELSET=E,TYPE='
  character(*), parameter :: ELEMENT_LINE = ';1,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;'
  type(suite_type) :: suite
  character(*), parameter :: SERIES = '*VISCOELASTIC,TIME=PRONY;.3,.2,.5;.4,.1,7.;'
  type(model_type) :: model
  character(:), allocatable :: text
  real(DP) :: G, K

  call read('*ELASTIC,MODULI=INSTANTANEOUS;200.,.3;' // SERIES, model, text)
  call suite%that('instantaneous: ' // text, text == '')
  associate (material => model%materials(1))
    call suite%near('E', material%youngs_modulus, 200.0_DP, 0.0_DP)
    call suite%near('second term', norm2(material%prony(:, 2) - [0.4_DP, 0.1_DP, 7.0_DP]), 0.0_DP, 0.0_DP)
    call suite%that('state', material%n_inner == 21 .and. material%inner_first == 16 .and. material%n_history == 36 .and. .not. &
      material%is_linear_isotropic)
  end associate
  call read(SERIES // '*ELASTIC;200.,.3;', model, text)
  call suite%that('long term: ' // text, text == '')
  G = 200 / 2.6_DP / 0.3_DP
  K = 200 / 1.2_DP / 0.7_DP
  call suite%near('E', model%materials(1)%youngs_modulus, 9 * K * G / (3 * K + G), 1.0e-10_DP)
  call suite%near('nu', model%materials(1)%poissons_ratio, (3 * K - 2 * G) / (6 * K + 2 * G), 1.0e-12_DP)
  call read('*HYPERELASTIC,OGDEN,N=2;3.,2.,6.,4.,.1,0.;' // SERIES, model, text)
  call suite%that('rubber: ' // text, text == '')
  call suite%near('Ogden', norm2(model%materials(1)%elastic%value(:, 1) - [10.0_DP, 2.0_DP, 20.0_DP, 4.0_DP, 0.07_DP, 0.0_DP]), &
    0.0_DP, 1.0e-12_DP)
  call read('*HYPERELASTIC,MOONEY-RIVLIN;3.,6.,.1;' // SERIES, model, text)
  call suite%near('Mooney', norm2(model%materials(1)%elastic%value(:, 1) - [10.0_DP, 20.0_DP, 0.07_DP]), 0.0_DP, 1.0e-12_DP)
  call reject('*ELASTIC;200.,.3;*VISCOELASTIC,TIME=PRONY;.6,.2,.5;.4,.1,7.;', 'less than 1')
  call reject('*ELASTIC;200.,.3;*VISCOELASTIC,TIME=PRONY;.6,.2,0.;', 'tau above 0')
  call reject('*ELASTIC;200.,.3;*VISCOELASTIC,TIME=PRONY;-.6,.2,1.;', 'g and k of 0 or more')
  call reject('*ELASTIC;200.,.3;*VISCOELASTIC,TIME=PRONY;', 'a data line for each term')
  call reject('*ELASTIC;200.,.3;*PLASTIC;1.,0.;' // SERIES, 'beside plasticity or creep')
  call reject('*HYPERFOAM;1.,2.,.1;' // SERIES, 'other than isotropic')
  call reject('*ELASTIC;200.,.3;' // SERIES // SERIES, 'has a law of stress before')
  call reject('*ELASTIC;200.,.3;' // SERIES, 'LONG TERM is of *STATIC', 'VISCO,LONG TERM')
  call reject('*ELASTIC;200.,.3;*DENSITY;1.;' // SERIES, 'relax in *VISCO steps alone', 'DYNAMIC,APPLICATION=QUASI-STATIC')
  call reject('*ELASTIC;200.,.3;' // SERIES, 'hourglass stiffness', 'STATIC,LONG TERM', 'C3D8R')
  call reject('*ELASTIC;200.,.3;' // SERIES, 'hourglass stiffness', 'VISCO', 'C3D8R')
  call read('*ELASTIC;200.,.3;' // SERIES, model, text, 'STATIC', 'C3D8R')
  call suite%that('at once: ' // text, text == '')
  call suite%finish()

contains

  !> Reads the cards of a material M; the text of the first error, '' without.
  subroutine read(cards, model, first_error, procedure, element)
    character(*), intent(in) :: cards
    type(model_type), intent(out) :: model
    character(:), allocatable, intent(out) :: first_error
    character(*), intent(in), optional :: procedure   !< in place of STATIC
    character(*), intent(in), optional :: element     !< in place of C3D8
    character(:), allocatable :: card, kind
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    card = 'STATIC'
    kind = 'C3D8'
    if (present(element)) kind = element
    if (present(procedure)) card = procedure
    call read_deck_text(deck_lines(START // kind // ELEMENT_LINE // cards // &
      '*SOLID SECTION,ELSET=E,MATERIAL=M;*STEP;*' // card // ';*END STEP;'), options, model, diagnostics, error)
    first_error = ''
    do i = diagnostics%n_items, 1, -1
      if (.not. diagnostics%items(i)%is_warning) first_error = diagnostics%items(i)%text
    end do
  end subroutine read


  !> Cards that are rejected with some words.
  subroutine reject(cards, words, procedure, element)
    character(*), intent(in) :: cards, words
    character(*), intent(in), optional :: procedure, element
    type(model_type) :: model
    character(:), allocatable :: text
    call read(cards, model, text, procedure, element)
    call suite%that(words // ' in: ' // text, index(text, words) > 0)
  end subroutine reject

end program test_deck_viscoelasticity
