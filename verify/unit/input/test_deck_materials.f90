!> Unit test of amontons_deck_materials and amontons_deck_initial_conditions: the result of each card, and rejected forms.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_materials
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_materials, only: ELASTIC_HYPER, ELASTIC_FOAM, &
    HYPER_POLYNOMIAL, HYPER_OGDEN, HYPER_ARRUDA_BOYCE, CREEP_TIME_HARDENING, CREEP_STRAIN_HARDENING, &
    SYSTEM_CYLINDRICAL, HISTORY_PEEQ, HISTORY_INELASTIC, HISTORY_BACK
  use amontons_model, only: model_type, job_options_type, DIALECT_CALCULIX, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: NODES = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;'
  character(*), parameter :: MATERIAL = '*MATERIAL,NAME=M;', SECTION = '*SOLID SECTION,ELSET=E,MATERIAL=M;'
  character(*), parameter :: STEEL = MATERIAL // '*ELASTIC;200.,.3;'
  character(*), parameter :: STEP = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite

  call check_plain()
  call check_expansion()
  call check_plastic()
  call check_creep()
  call check_rubber()
  call check_axes()
  call check_initial()
  call check_temperatures()
  call suite%finish()

contains

  !> Reads a deck; a semicolon ends a line.
  subroutine read(text, model, diagnostics, error, dialect)
    character(*), intent(in) :: text
    type(model_type), intent(out) :: model
    type(diagnostic_list_type), intent(out) :: diagnostics
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in) :: dialect
    type(job_options_type) :: options
    options%dialect = dialect
    call read_deck_text(deck_lines(text), options, model, diagnostics, error)
  end subroutine read


  !> Reads a valid deck.
  subroutine good(text, model, dialect)
    character(*), intent(in) :: text
    type(model_type), intent(out) :: model
    integer, intent(in), optional :: dialect
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i, d
    d = DIALECT_ABAQUS
    if (present(dialect)) d = dialect
    call read(text, model, diagnostics, error, d)
    call suite%that('read: ' // text(len(NODES):), .not. allocated(error))
    do i = 1, diagnostics%n_items
      if (.not. diagnostics%items(i)%is_warning) call suite%that(diagnostics%items(i)%text, .false.)
    end do
  end subroutine good


  !> Reads a deck that must be rejected with a message that contains a given piece of text.
  subroutine bad(text, piece)
    character(*), intent(in) :: text, piece
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    logical :: is_reported
    integer :: i
    call read(text, model, diagnostics, error, DIALECT_ABAQUS)
    is_reported = .false.
    do i = 1, diagnostics%n_items
      if (.not. diagnostics%items(i)%is_warning) is_reported = is_reported .or. index(diagnostics%items(i)%text, piece) > 0
    end do
    call suite%that('refused: ' // piece, allocated(error) .and. is_reported)
  end subroutine bad


  subroutine check_plain()
    type(model_type) :: model
    call good(NODES // STEEL // SECTION // STEP, model)
    call suite%that('plain', model%materials(1)%is_linear_isotropic .and. model%materials(1)%n_history == 0)
    call good(NODES // MATERIAL // '*ELASTIC;200.,.3,0.;100.,.2,50.;' // SECTION // STEP, model)
    call suite%that('a table is not plain', .not. model%materials(1)%is_linear_isotropic)
    call bad(NODES // MATERIAL // '*DENSITY;1.,0.;-2.,10.;*ELASTIC;1.,.3;' // SECTION // STEP, 'must be positive')
    call bad(NODES // MATERIAL // SECTION // STEP, 'has no *ELASTIC')
  end subroutine check_plain


  subroutine check_expansion()
    type(model_type) :: model
    character(*), parameter :: WARM = '*INITIAL CONDITIONS,TYPE=TEMPERATURE;ALL,20.;'
    call good(NODES // STEEL // '*EXPANSION,ZERO=10.;1e-5,0.;2e-5,100.;' // SECTION // WARM // STEP, model)
    call suite%that('expansion is not plain', .not. model%materials(1)%is_linear_isotropic)
    call suite%near('ZERO', model%materials(1)%expansion_reference, 10.0_DP, 0.0_DP)
    call suite%near('initial temperature', minval(model%initial_temperature), 20.0_DP, 0.0_DP)
    call good(NODES // STEEL // '*EXPANSION;1e-5;' // SECTION // STEP, model)
    call suite%that('without temperatures it is', model%materials(1)%is_linear_isotropic)
    call good(NODES // STEEL // '*EXPANSION,TYPE=ORTHO;1.,2.,3.,0.;' // SECTION // WARM // STEP, model)
    call suite%that('three coefficients', size(model%materials(1)%expansion%value, 1) == 3)
    call bad(NODES // MATERIAL // '*HYPERELASTIC,NEO HOOKE;1.,.1;*EXPANSION,TYPE=ORTHO;1.,2.,3.,0.;' // SECTION // STEP, &
      'anisotropic expansion')
  end subroutine check_expansion


  subroutine check_plastic()
    type(model_type) :: model
    call good(NODES // STEEL // '*PLASTIC;1.,0.,0.;2.,.1,0.;.5,0.,100.;' // SECTION // STEP, model)
    associate (material => model%materials(1))
      call suite%that('two curves', size(material%isotropic_hardening) == 2 .and. .not. allocated(material%kinematic_hardening))
      call suite%near('the second', material%isotropic_hardening(2)%stress(1), 0.5_DP, 0.0_DP)
      call suite%that('history', material%n_history == HISTORY_INELASTIC + 5 .and. .not. material%is_linear_isotropic)
    end associate
    call good(NODES // MATERIAL // '*ELASTIC,TYPE=ORTHO;5.,1.,5.,1.,1.,5.,2.,2.;2.;*PLASTIC;1.,0.;' // SECTION // STEP, model)
    call bad(NODES // MATERIAL // '*ELASTIC,TYPE=ORTHO;5.,1.,5.,1.,1.,5.,2.,2.;2.;*PLASTIC,HARDENING=KINEMATIC;1.,0.;2.,1.;' // &
      SECTION // STEP, 'isotropic hardening is')
    call good(NODES // STEEL // '*PLASTIC,HARDENING=COMBINED;1.,0.;2.,.1;*CYCLIC HARDENING;1.,0.;' // SECTION // STEP, &
      model)
    call suite%that('combined', allocated(model%materials(1)%isotropic_hardening) &
      .and. allocated(model%materials(1)%kinematic_hardening))
    call suite%that('its history', model%materials(1)%n_history == HISTORY_BACK + 5)
    call good(NODES // MATERIAL // '*DEFORMATION PLASTICITY;190.,.34,9.,12.,.45;' // SECTION // STEP, model)
    call suite%that('deformation plasticity', model%materials(1)%has_deformation_plasticity)
    call bad(NODES // STEEL // '*PLASTIC;' // SECTION // STEP, 'needs data')
    call bad(NODES // STEEL // '*PLASTIC;1.,.1;' // SECTION // STEP, 'first point')
    call bad(NODES // STEEL // '*PLASTIC;1.,0.;2.,.1;3.,.1;' // SECTION // STEP, 'ascend')
    call bad(NODES // STEEL // '*PLASTIC;0.,0.;' // SECTION // STEP, 'yield stress must be positive')
    call bad(NODES // STEEL // '*PLASTIC;1.,0.,50.;1.,0.,20.;' // SECTION // STEP, 'temperatures of the hardening')
    call bad(NODES // STEEL // '*PLASTIC,HARDENING=USER;1.,0.;' // SECTION // STEP, 'HARDENING=USER is not supported')
    call bad(NODES // MATERIAL // '*HYPERELASTIC,NEO HOOKE;1.,.1;*PLASTIC;1.,0.;' // SECTION // STEP, 'give one')
    call bad(NODES // MATERIAL // '*DEFORMATION PLASTICITY;190.,.34,9.,.5,.45;' // SECTION // STEP, 'at least 1')
  end subroutine check_plastic


  subroutine check_creep()
    type(model_type) :: model
    character(*), parameter :: VISCO = '*STEP;*VISCO,CETOL=1e-4;.1,1.;*END STEP;'
    call good(NODES // STEEL // '*CREEP;1e-10,5.,0.;' // SECTION // STEP // VISCO, model)
    call suite%that('creep by time', model%materials(1)%creep_law == CREEP_TIME_HARDENING)
    call suite%that('VISCO', .not. model%steps(1)%has_creep .and. model%steps(2)%has_creep)
    call good(NODES // STEEL // '*CREEP,LAW=STRAIN;1e-10,5.,-.5;' // SECTION // STEP, model)
    call suite%that('creep by strain', model%materials(1)%creep_law == CREEP_STRAIN_HARDENING)
    call bad(NODES // STEEL // '*CREEP;1e-10,5.,.5;' // SECTION // STEP, 'm above -1')
    call bad(NODES // STEEL // '*PLASTIC,HARDENING=KINEMATIC;1.,0.;*CREEP;1.,5.,0.;' // SECTION // STEP, 'kinematic')
  end subroutine check_creep


  subroutine check_rubber()
    type(model_type) :: model
    call good(NODES // MATERIAL // '*HYPERELASTIC,NEO HOOKE;2.,.5;' // SECTION // STEP, model)
    call suite%that('neo-Hooke', model%materials(1)%elastic_kind == ELASTIC_HYPER .and. &
      model%materials(1)%hyper_kind == HYPER_POLYNOMIAL)
    call expect(model, 'neo-Hooke', [2.0_DP, 0.0_DP, 0.5_DP])
    call good(NODES // MATERIAL // '*HYPERELASTIC,NEO HOOKE;2.,0.;' // SECTION // STEP, model)
    call expect(model, 'D1 = 0', [2.0_DP, 0.0_DP, 0.025_DP])
    call good(NODES // MATERIAL // '*HYPERELASTIC,MOONEY-RIVLIN;2.,1.,.5;' // SECTION // STEP, model)
    call expect(model, 'Mooney-Rivlin', [2.0_DP, 1.0_DP, 0.5_DP])
    call good(NODES // MATERIAL // '*HYPERELASTIC,YEOH;1.,2.,3.,4.,5.,6.;' // SECTION // STEP, model)
    call expect(model, 'Yeoh', [1.0_DP, 0.0_DP, 2.0_DP, 0.0_DP, 0.0_DP, 3.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 4.0_DP, 5.0_DP, 6.0_DP])
    call good(NODES // MATERIAL // '*HYPERELASTIC,REDUCED POLYNOMIAL,N=2;1.,2.,4.,5.;' // SECTION // STEP, model)
    call expect(model, 'reduced polynomial', [1.0_DP, 0.0_DP, 2.0_DP, 0.0_DP, 0.0_DP, 4.0_DP, 5.0_DP])
    call good(NODES // MATERIAL // '*HYPERELASTIC,POLYNOMIAL,N=2;1.,2.,3.,4.,5.,6.,7.;' // SECTION // STEP, model)
    call expect(model, 'polynomial', [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP, 7.0_DP])
    call good(NODES // MATERIAL // '*HYPERELASTIC,OGDEN,N=3;1.,2.,3.,4.,5.,6.,7.,8.;9.,10.;' // SECTION // STEP, model)
    call suite%that('Ogden', model%materials(1)%hyper_kind == HYPER_OGDEN .and. model%materials(1)%hyper_order == 3)
    call expect(model, 'Ogden', [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP, 7.0_DP, 8.0_DP, 9.0_DP])
    call good(NODES // MATERIAL // '*HYPERELASTIC,ARRUDA-BOYCE;1.,2.,3.;' // SECTION // STEP, model)
    call suite%that('Arruda-Boyce', model%materials(1)%hyper_kind == HYPER_ARRUDA_BOYCE)
    call good(NODES // MATERIAL // '*HYPERFOAM,N=2;1.,2.,3.,4.,.1,.2;' // SECTION // STEP, model)
    call suite%that('foam', model%materials(1)%elastic_kind == ELASTIC_FOAM)
    call bad(NODES // MATERIAL // '*HYPERELASTIC,OGDEN;1.,0.,.1;' // SECTION // STEP, 'alpha must not be zero')
    call bad(NODES // MATERIAL // '*HYPERELASTIC,NEO HOOKE;-1.,.1;' // SECTION // STEP, 'shear modulus at rest')
    call bad(NODES // MATERIAL // '*HYPERELASTIC,NEO HOOKE;1.,-.1;' // SECTION // STEP, 'D1 must not be negative')
    call bad(NODES // MATERIAL // '*HYPERELASTIC,POLYNOMIAL,N=4;1.,-.1;' // SECTION // STEP, 'N must be')
    call bad(NODES // MATERIAL // '*HYPERELASTIC,ARRUDA-BOYCE;1.,0.,3.;' // SECTION // STEP, 'locking stretch')
    call bad(NODES // MATERIAL // '*HYPERFOAM;1.,2.,.5;' // SECTION // STEP, 'less than 0.5')
    call bad(NODES // MATERIAL // '*HYPERFOAM;1.,0.,.1;' // SECTION // STEP, 'alpha must not be zero')
    call bad(NODES // MATERIAL // '*HYPERFOAM;-1.,1.,.1;' // SECTION // STEP, 'shear modulus at rest')
  end subroutine check_rubber


  !> The constants of the first material.
  subroutine expect(model, name, values)
    type(model_type), intent(in) :: model
    character(*), intent(in) :: name
    real(DP), intent(in) :: values(:)
    call suite%that(name // ': number of constants', size(model%materials(1)%elastic%value, 1) == size(values))
    call suite%near(name, maxval(abs(model%materials(1)%elastic%value(:, 1) - values)), 0.0_DP, 1e-15_DP)
  end subroutine expect


  subroutine check_axes()
    type(model_type) :: model
    character(*), parameter :: LOCAL = '*SOLID SECTION,ELSET=E,MATERIAL=M,ORIENTATION=O;'
    call good(NODES // STEEL // '*ORIENTATION,NAME=O;0.,1.,0.,-1.,0.,0.;3,30.;' // LOCAL // STEP, model)
    call suite%that('orientation of the element', all(model%element_orientation == [1]))
    call suite%near('angle', model%orientations(1)%rotation_angle, acos(-1.0_DP) / 6, 1e-15_DP)
    call good(NODES // STEEL // '*ORIENTATION,NAME=O,SYSTEM=CYLINDRICAL;0.,0.,0.,0.,0.,1.;' // LOCAL // STEP, model)
    call suite%that('cylindrical', model%orientations(1)%system == SYSTEM_CYLINDRICAL)
    call good(NODES // STEEL // '*DISTRIBUTION,NAME=D;,1.,0.,0.,0.,1.,0.;1,0.,0.,1.,1.,0.,0.;*ORIENTATION,NAME=O;D;' // &
      LOCAL // STEP, model)
    call suite%near('distribution', model%orientations(model%element_orientation(1))%a(3), 1.0_DP, 0.0_DP)
    call bad(NODES // STEEL // LOCAL // STEP, 'no orientation ''O''')
    call bad(NODES // STEEL // '*ORIENTATION,NAME=O;D;' // LOCAL // STEP, 'no distribution ''D''')
    call bad(NODES // STEEL // '*ORIENTATION,NAME=O;1.,0.,0.,2.,0.,0.;' // LOCAL // STEP, 'give no axes')
    call bad(NODES // STEEL // '*ORIENTATION,NAME=O;1.,0.,0.,0.,1.,0.;4,1.;' // LOCAL // STEP, 'must be 1, 2 or 3')
    call bad(NODES // STEEL // '*ORIENTATION,NAME=O;1.,0.,0.,0.,1.,0.;*ORIENTATION,NAME=O;1.,0.,0.,0.,1.,0.;' // &
      LOCAL // STEP, 'defined twice')
    call bad(NODES // STEEL // '*ORIENTATION,NAME=O;' // LOCAL // STEP, 'needs a data line')
  end subroutine check_axes


  subroutine check_initial()
    type(model_type) :: model
    call good(NODES // STEEL // SECTION // '*INITIAL CONDITIONS,TYPE=STRESS;E,1.,2.,3.,4.,5.,6.;' // STEP, model)
    call suite%near('stress: 13 and 23 change places', maxval(abs(model%initial_stress(:, 8) - [1.0_DP, 2.0_DP, 3.0_DP, &
      4.0_DP, 6.0_DP, 5.0_DP])), 0.0_DP, 0.0_DP)
    call suite%that('then history is kept', model%materials(1)%n_history == 8 .and. .not. model%materials(1)%is_linear_isotropic)
    call good(NODES // STEEL // SECTION // '*INITIAL CONDITIONS,TYPE=PLASTIC STRAIN;1,3,1.,2.,3.,4.,5.,6.;' // STEP, &
      model, DIALECT_CALCULIX)
    call suite%near('plastic strain of one point', sum(model%initial_history(HISTORY_INELASTIC, :)), 1.0_DP, 0.0_DP)
    call suite%near('the third', model%initial_history(HISTORY_INELASTIC + 5, 3), 5.0_DP, 0.0_DP)
    call good(NODES // STEEL // SECTION // '*INITIAL CONDITIONS,TYPE=HARDENING;E,.5,1.,2.,3.,4.,5.,6.;' // STEP, model)
    call suite%near('hardening: PEEQ', model%initial_history(HISTORY_PEEQ, 1), 0.5_DP, 0.0_DP)
    call suite%near('hardening: back stress', model%initial_history(HISTORY_BACK, 1), 1.0_DP, 0.0_DP)
    call bad(NODES // STEEL // SECTION // '*INITIAL CONDITIONS,TYPE=VELOCITY;1,1,1.;' // STEP, 'starts at rest')
    call bad(NODES // STEEL // SECTION // '*INITIAL CONDITIONS,TYPE=STRESS,USER;' // STEP, 'USER')
  end subroutine check_initial


  !> Temperatures over steps: ramps from the last value, amplitudes, OP=NEW.
  subroutine check_temperatures()
    type(model_type) :: model
    character(*), parameter :: START = NODES // STEEL // SECTION // '*INITIAL CONDITIONS,TYPE=TEMPERATURE;ALL,20.;' // &
      '*AMPLITUDE,NAME=A;0.,0.,1.,2.;'
    character(*), parameter :: S = '*STEP;*STATIC;'
    call good(START // S // '*TEMPERATURE;1,100.;*END STEP;' // S // '*TEMPERATURE;2,50.;*END STEP;' // S // &
      '*TEMPERATURE,OP=NEW;2,10.;*END STEP;', model)
    call suite%that('one node in each step', size(model%steps(1)%temperatures) == 1 .and. &
      size(model%steps(2)%temperatures) == 1 .and. size(model%steps(3)%temperatures) == 2)
    call suite%near('starts from the initial one', model%steps(1)%temperatures(1)%start, 20.0_DP, 0.0_DP)
    call suite%near('ends', model%steps(1)%temperatures(1)%end, 100.0_DP, 0.0_DP)
    call suite%near('OP=NEW: back', model%steps(3)%temperatures(1)%end, 20.0_DP, 0.0_DP)
    call suite%near('OP=NEW: from', model%steps(3)%temperatures(1)%start, 100.0_DP, 0.0_DP)
    call suite%near('given again: from', model%steps(3)%temperatures(2)%start, 50.0_DP, 0.0_DP)
    call good(START // S // '*TEMPERATURE,AMPLITUDE=A;1,100.;*END STEP;' // '*STEP,AMPLITUDE=STEP;*STATIC;' // &
      '*TEMPERATURE;1,50.;*END STEP;' // S // '*TEMPERATURE;1,60.;*END STEP;', model)
    call suite%that('amplitude', model%steps(1)%temperatures(1)%amplitude == 1)
    call suite%near('at once', model%steps(2)%temperatures(1)%start, 50.0_DP, 0.0_DP)
    call suite%near('from what it was', model%steps(3)%temperatures(1)%start, 50.0_DP, 0.0_DP)
    call bad(START // S // '*TEMPERATURE;99,50.;*END STEP;', 'no node')
    call bad(START // S // '*TEMPERATURE,USER;*END STEP;', 'Give the values')
  end subroutine check_temperatures

end program test_deck_materials
