!> Unit test of amontons_deck_cohesive: sections and laws of cohesive elements, and rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_cohesive
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_materials, only: ELASTIC_TRACTION, SOFTENING_TABULAR, MIX_BENZEGGAGH_KENANE, MIX_POWER_LAW
  use amontons_model, only: model_type, job_options_type
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: NODES = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,.1;6,1,0,.1;7,1,1,.1;' // &
    '8,0,1,.1;*ELEMENT,TYPE=COH3D8,ELSET=E;1,1,2,3,4,5,6,7,8;'
  character(*), parameter :: LAW = '*MATERIAL,NAME=M;*ELASTIC,TYPE=TRACTION;1000.,500.;', START = '*DAMAGE INITIATION,' // &
    'CRITERION=QUADS;10.,8.;', FALL = '*DAMAGE EVOLUTION,TYPE=ENERGY;0.3;', SECTION = &
    '*COHESIVE SECTION,ELSET=E,MATERIAL=M,RESPONSE=TRACTION SEPARATION'
  type(suite_type) :: suite
  type(model_type) :: model
  character(:), allocatable :: text

  call read(LAW // START // FALL // SECTION // ';', model, text)
  call suite%that('a cohesive law: ' // text, text == '')
  associate (material => model%materials(1))
    call suite%that('its kind', material%elastic_kind == ELASTIC_TRACTION .and. allocated(material%damage))
    call suite%near('second shear as the first', norm2(material%elastic%value(:, 1) - [1000.0_DP, 500.0_DP, 500.0_DP]), 0.0_DP, &
      0.0_DP)
    call suite%near('limits', norm2(material%damage%initiation%value(:, 1) - [10.0_DP, 8.0_DP, 8.0_DP]), 0.0_DP, 0.0_DP)
    call suite%that('criterion', material%damage%is_quadratic .and. .not. material%damage%is_of_strain)
    call suite%that('history', material%n_inner == 3 .and. material%n_history == material%inner_first + 2)
    call suite%that('unsymmetric', material%is_unsymmetric)
  end associate
  call suite%near('thickness', model%mesh%cohesive(1, 1), 1.0_DP, 0.0_DP)
  call read(LAW // START // FALL // SECTION // ',THICKNESS=GEOMETRY;', model, text)
  call suite%near('thickness of the mesh', model%mesh%cohesive(1, 1), 0.1_DP, 1.0e-15_DP)
  call read(LAW // START // FALL // '*SECTION CONTROLS,NAME=C,VISCOSITY=0.02;1.,1.;' // SECTION // ',CONTROLS=C;0.5,;', model, text)
  call suite%that('controls: ' // text, text == '')
  call suite%near('thickness and viscosity', norm2(model%mesh%cohesive(:, 1) - [0.5_DP, 0.02_DP]), 0.0_DP, 1.0e-15_DP)
  call suite%near('value of the section', model%mesh%section_value(1), 0.5_DP, 0.0_DP)
  call read(LAW // START // '*DAMAGE EVOLUTION,TYPE=ENERGY,MIXED MODE BEHAVIOR=BK,POWER=2.;.3,.9,.9;*DAMAGE STABILIZATION;' // &
    '0.1;' // SECTION // ';', model, text)
  call suite%that('Benzeggagh and Kenane', model%materials(1)%damage%mode_mix == MIX_BENZEGGAGH_KENANE)
  call suite%near('viscosity', model%materials(1)%damage%viscosity, 0.1_DP, 0.0_DP)
  call read(LAW // START // '*DAMAGE EVOLUTION,TYPE=ENERGY,MIXED MODE BEHAVIOR=POWER LAW,POWER=1.;.3,.9,.9;' // SECTION // ';', &
    model, text)
  call suite%that('power law', model%materials(1)%damage%mode_mix == MIX_POWER_LAW)
  call read(LAW // START // '*DAMAGE EVOLUTION,TYPE=DISPLACEMENT,SOFTENING=TABULAR;0.,0.;.5,.01;1.,.03;' // SECTION // ';', model, &
    text)
  call suite%that('table: ' // text, text == '' .and. model%materials(1)%damage%softening == SOFTENING_TABULAR)
  call suite%near('its rows', model%materials(1)%damage%table(1, 2), 0.01_DP, 0.0_DP)
  call reject(LAW // SECTION // ',CONTROLS=C;', 'There are no *SECTION CONTROLS')
  call reject(LAW // SECTION // ';0.,;', 'must be positive')
  call reject(LAW // START // '*DAMAGE EVOLUTION,TYPE=ENERGY;0.01;' // SECTION // ';', 'not above that stored')
  call reject(LAW // START // '*DAMAGE EVOLUTION,TYPE=ENERGY;-1.;' // SECTION // ';', 'must be positive')
  call reject(LAW // FALL // SECTION // ';', 'without *DAMAGE INITIATION')
  call reject(LAW // START // START // FALL // SECTION // ';', 'has *DAMAGE INITIATION before')
  call reject(LAW // START // '*DAMAGE EVOLUTION,TYPE=ENERGY,MIXED MODE BEHAVIOR=BK;.3,.9,.9;' // SECTION // ';', 'need POWER')
  call reject(LAW // START // '*DAMAGE EVOLUTION,TYPE=DISPLACEMENT,MIXED MODE BEHAVIOR=BK,POWER=2;.3;' // SECTION // ';', &
    'give TYPE=ENERGY')
  call reject(LAW // START // '*DAMAGE EVOLUTION,TYPE=ENERGY,SOFTENING=TABULAR;0.,0.;1.,.1;' // SECTION // ';', &
    'needs TYPE=DISPLACEMENT')
  call reject(LAW // START // '*DAMAGE EVOLUTION,TYPE=DISPLACEMENT,SOFTENING=TABULAR;0.,0.;.5,.01;.4,.02;' // SECTION // ';', &
    'damage does not fall')
  call reject('*MATERIAL,NAME=M;*ELASTIC,TYPE=TRACTION;1000.,-500.;' // SECTION // ';', 'must be positive')
  call reject('*MATERIAL,NAME=M;*ELASTIC;1000.,.3;' // SECTION // ';', 'which is not a cohesive law')
  call reject('*MATERIAL,NAME=M;*ELASTIC;1000.,.3;' // START // SECTION // ';', 'damage is one of cohesive elements')
  call reject(LAW // '*SOLID SECTION,ELSET=E,MATERIAL=M;', 'cohesive elements a *COHESIVE SECTION')
  call reject(LAW, 'no *COHESIVE SECTION names')
  call suite%finish()

contains

  !> Reads the cards of a material and a section; the text of the first error, '' without.
  subroutine read(cards, model, first_error)
    character(*), intent(in) :: cards
    type(model_type), intent(out) :: model
    character(:), allocatable, intent(out) :: first_error
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    call read_deck_text(deck_lines(NODES // cards // '*STEP;*STATIC;*END STEP;'), options, model, diagnostics, error)
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

end program test_deck_cohesive
