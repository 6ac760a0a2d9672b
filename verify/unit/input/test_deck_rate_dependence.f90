!> Unit test of amontons_deck_rate_dependence: the three laws of rates, and rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_rate_dependence
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_materials, only: RATE_NONE, RATE_POWER, RATE_RATIO, RATE_CURVES, law_name
  use amontons_model, only: model_type, job_options_type
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;*ELASTIC;1000.,.3;'
  character(*), parameter :: PLASTIC = '*PLASTIC;10.,0.;20.,.1;', POWER = '*RATE DEPENDENT;40.,5.;', &
    RATIO = '*RATE DEPENDENT,TYPE=YIELD RATIO;1.,.01;1.2,1.;1.3,10.;'
  type(suite_type) :: suite
  type(model_type) :: model
  character(:), allocatable :: text

  call check_laws()
  call check_rejected()
  call suite%finish()

contains

  !> What the cards give.
  subroutine check_laws()
    call read(PLASTIC // '*RATE DEPENDENT,TYPE=POWER LAW;40.,5.,20.;50.,4.,100.;', model, text)
    call suite%that('a power law: ' // text, text == '' .and. model%materials(1)%rate_law == RATE_POWER)
    call suite%near('D and n', norm2(model%materials(1)%rate_power%value(:, 2) - [50.0_DP, 4.0_DP]), 0.0_DP, 0.0_DP)
    call suite%that('its name', index(law_name(model%materials(1)), 'plastic, rate-dependent') > 0)
    call read(RATIO // PLASTIC, model, text)
    call suite%that('a table: ' // text, text == '' .and. model%materials(1)%rate_law == RATE_RATIO)
    call suite%that('constant below its first rate', all(abs(model%materials(1)%rate_ratio(1)%strain - [0.0_DP, 0.01_DP, 1.0_DP, &
      10.0_DP]) <= 0) .and. all(abs(model%materials(1)%rate_ratio(1)%stress(:2) - 1) <= 0))
    call read('*PLASTIC,RATE=10.;14.,0.;24.,.1;' // PLASTIC // '*PLASTIC,RATE=1.;12.,0.;22.,.1;', model, text)
    associate (material => model%materials(1))
      call suite%that('curves: ' // text, text == '' .and. material%rate_law == RATE_CURVES)
      call suite%near('their rates', norm2(material%rate_curves%rate - [0.0_DP, 1.0_DP, 10.0_DP]), 0.0_DP, 0.0_DP)
      call suite%near('the static one', material%isotropic_hardening(1)%stress(2), 20.0_DP, 0.0_DP)
      call suite%near('the last', material%rate_curves(3)%curves(1)%stress(1), 14.0_DP, 0.0_DP)
    end associate
    call read(PLASTIC // '*PLASTIC,RATE=1.;12.,0.;20.,.1;', model, text)
    call suite%that('a static curve first: ' // text, text == '' .and. size(model%materials(1)%rate_curves) == 2)
    call read('*PLASTIC,RATE=1.;12.,0.;', model, text)
    call suite%that('one curve is no law of rates: ' // text, text == '' .and. model%materials(1)%rate_law == RATE_NONE)
  end subroutine check_laws


  !> Each error.
  subroutine check_rejected()
    character(*), parameter :: STEEL = PLASTIC // POWER
    call reject(POWER, 'has *RATE DEPENDENT but no *PLASTIC')
    call reject(STEEL // POWER, 'has *RATE DEPENDENT before')
    call reject(PLASTIC // '*RATE DEPENDENT;0.,5.;', 'D and n must be positive')
    call reject(PLASTIC // '*RATE DEPENDENT;', 'needs a data line')
    call reject(PLASTIC // '*RATE DEPENDENT,TYPE=YIELD RATIO;.9,0.;1.1,1.;', 'at least 1')
    call reject(PLASTIC // '*RATE DEPENDENT,TYPE=YIELD RATIO;1.,0.;1.2,1.;1.1,2.;', 'must not decrease with the rate')
    call reject(PLASTIC // '*RATE DEPENDENT,TYPE=YIELD RATIO;1.,0.;1.2,0.;', 'plastic strain rates of a hardening curve must')
    call reject('*PLASTIC,RATE=-1.;12.,0.;', 'RATE must be')
    call reject('*PLASTIC,RATE=1.;12.,0.;*PLASTIC,RATE=1.;13.,0.;', 'of this rate before')
    call reject('*PLASTIC,RATE=1.;12.,x;', 'plastic strain')
    call reject(PLASTIC // '*PLASTIC,RATE=1.;12.,0.;15.,.1;', 'at the plastic strain 0.1')
    call reject(STEEL // '*PLASTIC,RATE=1.;12.,0.;22.,.1;', 'both *RATE DEPENDENT and *PLASTIC, RATE')
    call reject('*PLASTIC,HARDENING=KINEMATIC,RATE=1.;12.,0.;', 'RATE goes with HARDENING=ISOTROPIC')
    call reject('*PLASTIC,HARDENING=KINEMATIC;12.,0.;' // POWER, 'kinematic hardening with a yield stress')
    call reject('*DRUCKER PRAGER;30.,1.,30.;*DRUCKER PRAGER HARDENING;10.,0.;' // POWER, 'rates count for *PLASTIC alone')
    call reject(STEEL // '*CREEP;1.E-9,3.,0.;', 'has *CREEP beside a yield stress')
    call reject(STEEL // '*VISCOELASTIC,TIME=PRONY;.1,.1,1.;', 'beside plasticity')
    call reject(STEEL, 'has no time', step='*STATIC,RIKS;*CLOAD;7,1,1.;')
    call reject(PLASTIC // '*PLASTIC,RATE=1.;12.,0.;22.,.1;', 'cannot be changed', &
      step='*STATIC;*CHANGE MATERIAL,NAME=M;*CHANGE PLASTIC;5.,0.;')
    call reject(STEEL, 'CalculiX has no yield stress over the rate', first='** dialect: calculix;')
    call reject('*PLASTIC,RATE=1.;12.,0.;', 'CalculiX has no yield stress over the rate', first='** dialect: calculix;')
  end subroutine check_rejected


  !> Reads the cards of a material M; the text of the first error, '' without.
  subroutine read(cards, model, first_error, step, first)
    character(*), intent(in) :: cards
    type(model_type), intent(out) :: model
    character(:), allocatable, intent(out) :: first_error
    character(*), intent(in), optional :: step, first    !< cards of the step, and before all
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    character(:), allocatable :: deck, kind_of_step
    integer :: i
    kind_of_step = '*STATIC;'
    if (present(step)) kind_of_step = step
    deck = START
    if (present(first)) deck = first // START
    call read_deck_text(deck_lines(deck // cards // '*SOLID SECTION,ELSET=E,MATERIAL=M;*STEP;' // kind_of_step // '*END STEP;'), &
      options, model, diagnostics, error)
    first_error = ''
    do i = diagnostics%n_items, 1, -1
      if (.not. diagnostics%items(i)%is_warning) first_error = diagnostics%items(i)%text
    end do
  end subroutine read


  !> Cards that are rejected with some words.
  subroutine reject(cards, words, step, first)
    character(*), intent(in) :: cards, words
    character(*), intent(in), optional :: step, first    !< as above
    type(model_type) :: model
    character(:), allocatable :: text
    call read(cards, model, text, step, first)
    call suite%that(words // ' in: ' // text, index(text, words) > 0)
  end subroutine reject

end program test_deck_rate_dependence
