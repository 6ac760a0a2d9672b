!> Unit test of amontons_deck_elasticity: constants of each kind, laws by the name of the material, and rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_elasticity
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_deck_elasticity, only: is_law_by_name
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_materials, only: ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC, ELASTIC_TENSION_ONLY, &
    ELASTIC_COMPRESSION_ONLY, ELASTIC_CIARLET, ELASTIC_FIBRES
  use amontons_model, only: model_type, job_options_type, DIALECT_CALCULIX, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL,NAME='
  type(suite_type) :: suite

  call check_kinds()
  call check_compliance()
  call check_names()
  call check_rejected()
  call suite%finish()

contains

  !> Reads the cards of a material M, or of another name under the calculix dialect; the text of the first error, '' without.
  subroutine read(cards, model, first_error, name)
    character(*), intent(in) :: cards
    type(model_type), intent(out) :: model
    character(:), allocatable, intent(out) :: first_error
    character(*), intent(in), optional :: name
    character(:), allocatable :: named
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    named = 'M'
    options%dialect = DIALECT_ABAQUS
    if (present(name)) then
      named = name
      options%dialect = DIALECT_CALCULIX
    end if
    call read_deck_text(deck_lines(START // named // ';' // cards // '*SOLID SECTION,ELSET=E,MATERIAL=' // named // &
      ';*STEP;*STATIC;*END STEP;'), options, model, diagnostics, error)
    first_error = ''
    do i = diagnostics%n_items, 1, -1
      if (.not. diagnostics%items(i)%is_warning) first_error = diagnostics%items(i)%text
    end do
  end subroutine read


  !> The constants of each kind.
  subroutine check_kinds()
    type(model_type) :: model
    character(:), allocatable :: text
    real(DP) :: e, nu
    call read('*ELASTIC;200.,.3,0.;100.,.2,50.;', model, text)
    call suite%near('table', maxval(abs(model%materials(1)%elastic%value(:, 2) - [100.0_DP, 0.2_DP])), 0.0_DP, 0.0_DP)
    call read('*ELASTIC,TYPE=ORTHO;9.,1.,8.,2.,3.,7.,4.,5.;6.,20.;', model, text)
    call suite%that('ORTHO', model%materials(1)%elastic_kind == ELASTIC_ORTHOTROPIC)
    call suite%near('D2323', model%materials(1)%elastic%value(9, 1), 6.0_DP, 0.0_DP)
    call suite%near('its temperature', model%materials(1)%elastic%temperature(1), 20.0_DP, 0.0_DP)
    e = 200
    nu = 0.3_DP
    call read('*ELASTIC,TYPE=ENGINEERING CONSTANTS;200.,200.,200.,.3,.3,.3,70.,71.;72.;', model, text)
    associate (D => model%materials(1)%elastic%value(:, 1))
      call suite%near('constants: D1111', D(1), e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), 1e-12_DP)
      call suite%near('constants: D1122 ... D2233', maxval(abs(D([2, 4, 5]) - e * nu / ((1 + nu) * (1 - 2 * nu)))), &
        0.0_DP, 1e-12_DP)
      call suite%near('constants: G', maxval(abs(D(7:) - [70.0_DP, 71.0_DP, 72.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call read('*ELASTIC,TYPE=ANISO;9.,1.,8.,2.,3.,7.,0.,0.;0.,4.,0.,0.,0.,0.,5.,0.;0.,0.,0.,0.,' // &
      '6.;', model, text)
    call suite%that('ANISO', model%materials(1)%elastic_kind == ELASTIC_ANISOTROPIC)
  end subroutine check_kinds


  !> Three different moduli: the nine D are the inverse of the compliance.
  subroutine check_compliance()
    type(model_type) :: model
    character(:), allocatable :: text
    real(DP) :: C(3, 3), S(3, 3), unit(3, 3)
    call read('*ELASTIC,TYPE=ENGINEERING CONSTANTS;100.,50.,20.,.2,.3,.1,7.,8.;9.;', model, text)
    associate (D => model%materials(1)%elastic%value(:, 1))
      C = reshape([D(1), D(2), D(4), D(2), D(3), D(5), D(4), D(5), D(6)], [3, 3])
    end associate
    S = reshape([1 / 100.0_DP, -0.002_DP, -0.003_DP, -0.002_DP, 1 / 50.0_DP, -0.002_DP, -0.003_DP, -0.002_DP, &
      1 / 20.0_DP], [3, 3])
    unit = 0
    unit(1, 1) = 1
    unit(2, 2) = 1
    unit(3, 3) = 1
    call suite%near('compliance', maxval(abs(matmul(C, S) - unit)), 0.0_DP, 1e-12_DP)
  end subroutine check_compliance


  !> Names that begin with the words of CalculiX, in its dialect only.
  subroutine check_names()
    type(model_type) :: model
    character(:), allocatable :: text
    call suite%that('names', is_law_by_name('Tension_only_foil') .and. is_law_by_name('CIARLET_EL') .and. &
      .not. is_law_by_name('STEEL') .and. .not. is_law_by_name('MY_CIARLET_EL'))
    call read('*USER MATERIAL,CONSTANTS=2;200.,2.;', model, text, 'TENSION_ONLY')
    call suite%that('tension only', text == '' .and. model%materials(1)%elastic_kind == ELASTIC_TENSION_ONLY)
    call read('*USER MATERIAL,CONSTANTS=2;200.,2.;', model, text, 'COMPRESSION_ONLY')
    call suite%that('compression only', text == '' .and. model%materials(1)%elastic_kind == ELASTIC_COMPRESSION_ONLY)
    call read('*USER MATERIAL,CONSTANTS=2;200.,.3;', model, text, 'CIARLET_EL')
    call suite%that('Ciarlet', text == '' .and. model%materials(1)%elastic_kind == ELASTIC_CIARLET .and. &
      .not. model%materials(1)%is_user)
    call read('*USER MATERIAL,CONSTANTS=2;200.,.3;', model, text, 'LIN_ISO_EL')
    call suite%that('isotropic', text == '' .and. model%materials(1)%elastic_kind == ELASTIC_ISOTROPIC .and. &
      model%materials(1)%is_linear_isotropic)
    call suite%near('its modulus', model%materials(1)%youngs_modulus, 200.0_DP, 0.0_DP)
    call read('*USER MATERIAL,CONSTANTS=10;2.,0.,1.,0.,3.,4.,0.,1.;5.,6.;', model, text, 'ELASTIC_FIBER')
    call suite%that('fibres', text == '' .and. model%materials(1)%elastic_kind == ELASTIC_FIBRES)
    call suite%near('D1 by default', model%materials(1)%elastic%value(2, 1), 1 / 40.0_DP, 1e-15_DP)
    call suite%near('k2 of the second', model%materials(1)%elastic%value(10, 1), 6.0_DP, 0.0_DP)
  end subroutine check_names


  !> Constants out of bounds.
  subroutine check_rejected()
    call bad('*ELASTIC,TYPE=ORTHO;9.,1.,8.,2.,3.,7.,4.,5.;', 'only 8 are there')
    call bad('*ELASTIC,TYPE=ORTHO;1.,2.,1.,0.,0.,1.,4.,5.;6.;', 'definite')
    call bad('*ELASTIC,TYPE=ENGINEERING CONSTANTS;1.,1.,1.,.9,.9,.9,1.,1.;1.;', &
      'not positive')
    call bad('*ELASTIC,TYPE=ENGINEERING CONSTANTS;0.,1.,1.,.1,.1,.1,1.,1.;1.;', &
      'must be positive')
    call bad('*USER MATERIAL,CONSTANTS=2;1.,0.;', 'largest stress', 'TENSION_ONLY')
    call bad('*USER MATERIAL,CONSTANTS=2;1.,.5;', 'less than 0.5', 'CIARLET_EL')
    call bad('*USER MATERIAL,CONSTANTS=7;1.,0.,1.,0.,1.,1.,1.;', '6, 10, 14 or 18', 'ELASTIC_FIBER')
    call bad('*USER MATERIAL,CONSTANTS=6;0.,0.,1.,0.,1.,1.;', 'positive C1', 'ELASTIC_FIBER')
    call bad('*USER MATERIAL,CONSTANTS=6;1.,0.,1.,1.,1.,1.;', 'fibre 1 is longer', 'ELASTIC_FIBER')
    call bad('*USER MATERIAL,CONSTANTS=10;1.,0.,1.,0.,1.,1.,1.,0.;-1.,0.;', 'of fibre 2 must', 'ELASTIC_FIBER')
    call bad('*ELASTIC;1.,.3;*USER MATERIAL,CONSTANTS=2;1.,.3;', 'law of stress before', 'CIARLET_EL')
  end subroutine check_rejected


  !> A material with an error whose text contains some words.
  subroutine bad(cards, words, name)
    character(*), intent(in) :: cards, words
    character(*), intent(in), optional :: name
    type(model_type) :: model
    character(:), allocatable :: text
    call read(cards, model, text, name)
    call suite%that(cards // ' is rejected: ' // text, index(text, words) > 0)
  end subroutine bad

end program test_deck_elasticity
