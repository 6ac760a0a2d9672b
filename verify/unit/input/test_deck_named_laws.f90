!> Unit test of amontons_deck_named_laws: constants of each law by the name of the material, state variables, rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_named_laws
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_deck_named_laws, only: is_named_law
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_materials, only: ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, INELASTIC_CRYSTAL, INELASTIC_CRYSTAL_CREEP, &
    INELASTIC_LINEAR, CREEP_TIME_HARDENING
  use amontons_model, only: model_type, job_options_type, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL,NAME='
  character(*), parameter :: CRYSTAL = '2.E5,1.3E5,1.E5,300.,6.,5.E4,700.,.6;20.,80.,40.,15.,450.,4.,2.E4,300.;1.,0.,60.,-15.,8.;'
  character(*), parameter :: ORTHO = '5.E5,1.6E5,5.E5,1.6E5,1.6E5,5.E5,1.3E5,1.3E5;1.3E5,'
  type(suite_type) :: suite

  call suite%that('names', is_named_law('single_crystal_creep_A') .and. is_named_law('IDEAL_GAS') .and. &
    .not. is_named_law('A_SINGLE_CRYSTAL'))
  call check_laws()
  call check_steps()
  call check_rejected()
  call suite%finish()

contains

  !> Reads the cards of a material; the text of the first error, '' without.
  subroutine read(name, cards, model, first_error, is_small, procedure)
    character(*), intent(in) :: name, cards
    type(model_type), intent(out) :: model
    character(:), allocatable, intent(out) :: first_error
    logical, intent(in), optional :: is_small    !< without NLGEOM
    character(*), intent(in), optional :: procedure
    character(:), allocatable :: card
    type(job_options_type) :: options
    logical :: is_nlgeom
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    is_nlgeom = .true.
    if (present(is_small)) is_nlgeom = .not. is_small
    card = 'STATIC'
    if (present(procedure)) card = procedure
    options%dialect = DIALECT_CALCULIX
    call read_deck_text(deck_lines(START // name // ';' // cards // '*SOLID SECTION,ELSET=E,MATERIAL=' // name // &
      ';*STEP' // trim(merge(',NLGEOM', '       ', is_nlgeom)) // ';*' // card // &
      ';*BOUNDARY;1,1,1,1.;*END STEP;'), options, model, diagnostics, error)
    first_error = ''
    do i = diagnostics%n_items, 1, -1
      if (.not. diagnostics%items(i)%is_warning) first_error = diagnostics%items(i)%text
    end do
  end subroutine read


  !> What each law makes of its constants.
  subroutine check_laws()
    type(model_type) :: model
    character(:), allocatable :: text
    call read('SINGLE_CRYSTAL', '*DEPVAR;60;*USER MATERIAL,CONSTANTS=21;' // CRYSTAL, model, text)
    call suite%that('crystal: ' // text, text == '')
    associate (material => model%materials(1))
      call suite%that('crystal', material%inelastic_law == INELASTIC_CRYSTAL .and. material%elastic_kind == ELASTIC_ORTHOTROPIC &
        .and. material%n_inner == 60 .and. material%is_unsymmetric)
      call suite%near('cubic', norm2(material%elastic%value(:, 1) - 1.0e5_DP * [2.0_DP, 1.3_DP, 2.0_DP, 1.3_DP, 1.3_DP, 2.0_DP, &
        1.0_DP, 1.0_DP, 1.0_DP]), 0.0_DP, 1.0e-9_DP)
      call suite%near('its last constant', material%inelastic%value(18, 1), 8.0_DP, 0.0_DP)
    end associate
    call read('SINGLE_CRYSTAL_CREEP', '*USER MATERIAL,CONSTANTS=7;2.E5,1.3E5,1.E5,1.E3,5.,1.E3,4.;', model, text)
    call suite%that('crystal creep: ' // text, text == '' .and. model%materials(1)%inelastic_law == INELASTIC_CRYSTAL_CREEP .and. &
      model%materials(1)%n_statev == 24 .and. .not. model%materials(1)%is_unsymmetric)
    call read('ANISO_PLAS_A', '*USER MATERIAL,CONSTANTS=15;' // ORTHO // '10.,2.,3.,-1.,1.,0.;*DEPVAR;20;', model, text)
    call suite%that('plastic: ' // text, text == '' .and. model%materials(1)%inelastic_law == INELASTIC_LINEAR .and. &
      model%materials(1)%n_inner == 20)
    call suite%near('yield stress', model%materials(1)%inelastic%value(1, 1), 10.0_DP, 0.0_DP)
    call read('ANISO_CREEP', '*USER MATERIAL,CONSTANTS=9;' // ORTHO // ';*DEPVAR;7;', model, text)
    call suite%that('creep: ' // text, text == '' .and. model%materials(1)%creep_law == CREEP_TIME_HARDENING .and. &
      model%materials(1)%n_statev == 0)
    call read('LIN_EL_COROT', '*USER MATERIAL,CONSTANTS=9;' // ORTHO // ';', model, text)
    call suite%that('stretch: ' // text, text == '' .and. model%materials(1)%is_corotational .and. &
      model%materials(1)%elastic_kind == ELASTIC_ORTHOTROPIC)
    call read('UNDO_NLGEOM_LIN_ISO_EL', '*USER MATERIAL,CONSTANTS=2;2.E5,.3;', model, text)
    call suite%that('isotropic stretch: ' // text, text == '' .and. model%materials(1)%is_corotational .and. &
      model%materials(1)%elastic_kind == ELASTIC_ISOTROPIC .and. .not. model%materials(1)%is_linear_isotropic)
  end subroutine check_laws


  !> The law that CalculiX has under NLGEOM alone; the others are the same without it.
  subroutine check_steps()
    character(*), parameter :: CARDS = '*USER MATERIAL,CONSTANTS=2;2.E5,.3;'
    type(model_type) :: model
    character(:), allocatable :: text
    call read('UNDO_NLGEOM_LIN_ISO_EL', CARDS, model, text, is_small=.true.)
    call suite%that('without NLGEOM: ' // text, index(text, 'for steps with NLGEOM alone') > 0)
    call read('UNDO_NLGEOM_LIN_EL', CARDS, model, text, is_small=.true.)
    call suite%that('the same as LIN_EL_COROT: ' // text, text == '')
    call read('SINGLE_CRYSTAL', '*USER MATERIAL,CONSTANTS=21;' // CRYSTAL, model, text, procedure='STATIC,RIKS')
    call suite%that('path: ' // text, index(text, 'slips at a rate') > 0)
  end subroutine check_steps


  !> Each fault has its sentence.
  subroutine check_rejected()
    call reject('SINGLE_CRYSTAL', '*USER MATERIAL,CONSTANTS=20;' // CRYSTAL, 'CONSTANTS must be 21')
    call reject('SINGLE_CRYSTAL', '*USER MATERIAL,CONSTANTS=21;' // CRYSTAL // '*DEPVAR;24;', 'has 60 state variables')
    call reject('SINGLE_CRYSTAL', '*USER MATERIAL,CONSTANTS=21;' // CRYSTAL // '*PLASTIC;10.,0.;', 'by its name')
    call reject('SINGLE_CRYSTAL_CREEP', '*USER MATERIAL,CONSTANTS=7;2.E5,1.3E5,1.E5,0.,5.,1.E3,4.;', 'needs K above 0')
    call reject('SINGLE_CRYSTAL_CREEP', '*USER MATERIAL,CONSTANTS=7;2.E5,1.3E5,1.E5,1.,5.,1.E3,.5;', 'n of 1 or more')
    call reject('SINGLE_CRYSTAL_CREEP', '*USER MATERIAL,CONSTANTS=7;1.E5,1.3E5,1.E5,1.,5.,1.E3,4.;', 'not positive definite')
    call reject('ANISO_PLAS', '*USER MATERIAL,CONSTANTS=15;' // ORTHO // '-10.,2.,3.,-1.,1.,0.;', 'yield stress')
    call reject('ANISO_PLAS', '*USER MATERIAL,CONSTANTS=15;' // ORTHO // '10.,2.,3.,0.,1.,0.;', 'A and n above 0')
    call reject('UNDO_NLGEOM_LIN_ISO_EL', '*USER MATERIAL,CONSTANTS=9;' // ORTHO // ';', 'CONSTANTS must be 2')
    call reject('LIN_EL_COROT', '*USER MATERIAL,CONSTANTS=2;2.E5,.5;', 'Poisson')
    call reject('LIN_EL_COROT', '*USER MATERIAL,CONSTANTS=2;2.E5,.3;*ELASTIC;1.E5,.3;', 'has a law of stress before')
    call reject('SINGLE_CRYSTAL', '*USER MATERIAL,CONSTANTS=21;' // CRYSTAL // '*ELASTIC;1.E5,.3;', 'has a law of stress before')
    call reject('ANISO_CREEP', '*USER MATERIAL,CONSTANTS=9;' // ORTHO // ';*CREEP;1.E-5,2.,0.;', 'has a law of stress before')
    call reject('ANISO_CREEP', '*CREEP;1.E-5,2.,0.;*USER MATERIAL,CONSTANTS=9;' // ORTHO // ';', 'has a law of stress before')
    call reject('ANISO_CREEP', '*USER MATERIAL,CONSTANTS=9;' // ORTHO // ';*PLASTIC;10.,0.;', 'beside creep by its name')
    call reject('IDEAL_GAS', '*USER MATERIAL,CONSTANTS=1;287.;', 'gases are not supported')
  end subroutine check_rejected


  !> Cards that are rejected with some words.
  subroutine reject(name, cards, words)
    character(*), intent(in) :: name, cards, words
    type(model_type) :: model
    character(:), allocatable :: text
    call read(name, cards, model, text)
    call suite%that(words // ' in: ' // text, index(text, words) > 0)
  end subroutine reject

end program test_deck_named_laws
