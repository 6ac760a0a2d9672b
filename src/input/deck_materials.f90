!> Material cards to material parameters, and their consistency.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_materials
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word, ENTRY_REJECTED
  use amontons_deck_cap, only: read_cap, read_cap_hardening, is_cap_complete
  use amontons_deck_creep, only: read_creep, check_user_creep
  use amontons_deck_cohesive, only: read_damage, check_damage
  use amontons_deck_elasticity, only: read_elastic, read_law_by_name, is_law_by_name, check_isotropic
  use amontons_deck_named_laws, only: is_named_law, read_named_law, set_inner_history, is_creep_by_name
  use amontons_deck_property_tables, only: read_table, read_curves
  use amontons_deck_rate_dependence, only: read_rate_dependent, read_isotropic_plastic, complete_rate_dependence
  use amontons_deck_test_data, only: fit_hyperelastic, check_test_place
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_user_constants, is_card, count_cards, &
    check_name, check_no_data
  use amontons_deck_viscoelasticity, only: read_viscoelastic, complete_viscoelastic
  use amontons_elasticity, only: elasticity_matrix
  use amontons_plasticity, only: is_inelastic
  use amontons_materials, only: material_type, property_table_type, hardening_curve_type, LAW_HENCKY, LAW_SAINT_VENANT, &
    ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC, ELASTIC_HYPER, ELASTIC_FOAM, is_linear_elastic, &
    HYPER_POLYNOMIAL, HYPER_OGDEN, HYPER_ARRUDA_BOYCE, MAX_HYPER_ORDER, CONE_COMPRESSION, CONE_TENSION, CONE_SHEAR, &
    CONE_COHESION, YIELD_RATIO, YIELD_MOHR_COULOMB, CREEP_NONE, INELASTIC_NONE, INELASTIC_CRYSTAL, HISTORY_INELASTIC, &
    HISTORY_BACK, HISTORY_STRETCH, MAX_HISTORY, USER_STATE, user_field_place
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_traction_separation, only: N_COHESIVE_STATE
  use amontons_user_routines, only: USER_NAME_LENGTH
  use amontons_viscoelasticity, only: n_viscoelastic_state
  use amontons_text, only: upper_case, to_text, parse_integer, parse_real, NUMBER_OK
  implicit none
  private
  public :: read_materials, add_section_material, add_anisotropic_material, add_sheared_material, finalize_materials, read_plastic

  integer, parameter :: MAX_STATEV = 100000

contains

  !> MATERIAL and the cards of its block.
  subroutine read_materials(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: line(:)
    integer :: c, m, n, n_fields
    logical :: is_new
    allocate (model%materials(count_cards(reader, 'MATERIAL')), line(count_cards(reader, 'MATERIAL')))
    n = 0
    m = 0
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'MATERIAL')) then
        call open_card(reader, c, parameters, row)
        if (parameter_text(parameters, 'NAME') == '') cycle
        call check_name(reader, c, parameter_text(parameters, 'NAME'))
        call reader%materials%add(parameter_text(parameters, 'NAME'), m, is_new)
        if (is_new) then
          n = n + 1
          line(n) = reader%cards%cards(c)%line
          model%materials(n) = new_material(parameter_text(parameters, 'NAME'), reader%dialect)
        else
          call report_error(reader, reader%cards%cards(c)%line, 'The material ''' // parameter_text(parameters, 'NAME') // &
            ''' is defined twice.')
        end if
      else if (m > 0) then
        call read_property(reader, c, model%materials(m))
      end if
    end do
    if (n < size(line)) model%materials = model%materials(:n)
    n_fields = count_field_variables(reader)
    do m = 1, size(model%materials)
      associate (material => model%materials(m))
        if (material%is_user) material%n_fields = max(n_fields, merge(1, 0, material%is_user_field))
        call check_material(reader, line(m), material)
        call check_user_creep(reader, line(m), n_fields, material)
      end associate
    end do
  end subroutine read_materials


  !> The largest number of a field variable that the deck gives; numbers that are wrong are reported where they are read.
  integer function count_field_variables(reader) result(n)
    type(reader_type), intent(inout) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer, parameter :: MOST = 1000            ! keeps a slip from filling the memory
    integer :: c, variable, status
    n = 0
    do c = 1, reader%cards%n_cards
      if (.not. (is_card(reader, c, 'FIELD') .or. is_card(reader, c, 'INITIALCONDITIONS'))) cycle
      call open_card(reader, c, parameters, row)
      if (is_card(reader, c, 'INITIALCONDITIONS') .and. parameter_word(parameters, 'TYPE', '') /= 'FIELD') cycle
      call parse_integer(parameter_word(parameters, 'VARIABLE', '1'), variable, status)
      if (status == NUMBER_OK .and. variable <= MOST) n = max(n, variable)
    end do
  end function count_field_variables


  !> One card of the block of a material.
  subroutine read_property(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    if (is_rejected_card(reader, c)) then
      if (.not. material%is_user) material%has_elastic = .true.   ! the rejected card may replace ELASTIC: no further error
      return
    end if
    if (is_repeated_law(reader%table%entries(reader%cards%cards(c)%entry)%key, material)) then
      call report_error(reader, reader%cards%cards(c)%line, 'The material ''' // material%name &
        // ''' has a law of stress before ' // &
        'this card; give one.')
      return
    end if
    select case (reader%table%entries(reader%cards%cards(c)%entry)%key)
    case ('ELASTIC')
      call read_elastic(reader, c, material)
    case ('NOCOMPRESSION')
      call read_cutoff(reader, c, 1, material)
    case ('NOTENSION')
      call read_cutoff(reader, c, -1, material)
    case ('DENSITY')
      call read_density(reader, c, material)
    case ('EXPANSION')
      call read_expansion(reader, c, material)
    case ('PLASTIC')
      material%has_plastic = .true.
      call read_plastic(reader, c, material)
    case ('RATEDEPENDENT')
      call read_rate_dependent(reader, c, material)
    case ('CYCLICHARDENING')
      material%has_plastic = .true.
      call read_curves(reader, c, material%isotropic_hardening)
    case ('DRUCKERPRAGER')
      call read_cone(reader, c, material)
    case ('DRUCKERPRAGERHARDENING')
      call read_cone_hardening(reader, c, material)
    case ('CAPPLASTICITY')
      call read_cap(reader, c, material)
    case ('CAPHARDENING')
      call read_cap_hardening(reader, c, material)
    case ('VISCOELASTIC')
      call read_viscoelastic(reader, c, material)
    case ('MOHRCOULOMB')
      call read_pyramid(reader, c, material)
    case ('MOHRCOULOMBHARDENING')
      call read_pyramid_hardening(reader, c, material)
    case ('DEFORMATIONPLASTICITY')
      call read_deformation(reader, c, material)
    case ('CREEP')
      call read_creep(reader, c, material)
    case ('HYPERELASTIC')
      call read_hyperelastic(reader, c, material)
    case ('UNIAXIALTESTDATA', 'BIAXIALTESTDATA', 'PLANARTESTDATA')
      call check_test_place(reader, c)
    case ('HYPERFOAM')
      call read_hyperfoam(reader, c, material)
    case ('USERMATERIAL')
      call read_user_material(reader, c, material)
    case ('USERDEFINEDFIELD')
      material%is_user_field = .true.
    case ('DEPVAR')
      call read_depvar(reader, c, material)
    case ('DAMAGEINITIATION', 'DAMAGEEVOLUTION', 'DAMAGESTABILIZATION')
      call read_damage(reader, c, material)
    end select
  end subroutine read_property


  !> NO COMPRESSION or NO TENSION.
  subroutine read_cutoff(reader, c, side, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: side                  !< 1: tension is carried, -1: compression
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    call open_card(reader, c, parameters, row)
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
    if (reader%dialect == DIALECT_CALCULIX) then
      call report_error(reader, reader%cards%cards(c)%line, 'CalculiX has no *NO COMPRESSION and *NO TENSION: give E and the ' // &
        'largest stress of the other side by *USER MATERIAL, CONSTANTS=2 of a material whose name begins with TENSION_ONLY or ' // &
        'COMPRESSION_ONLY.')
    else if (material%cutoff_sign /= 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'The material ''' // material%name // ''' has *NO COMPRESSION or ' // &
        '*NO TENSION before this card. One of them leaves the stress of the other sign; both leave none.')
    end if
    material%cutoff_sign = side
  end subroutine read_cutoff


  !> Whether a card defines a second stress law of a material: rubber or foam after any, UMAT after UMAT, ELASTIC
  !! after rubber.
  pure logical function is_repeated_law(key, material)
    character(*), intent(in) :: key
    type(material_type), intent(in) :: material
    select case (key)
    case ('HYPERELASTIC', 'HYPERFOAM')
      is_repeated_law = material%has_elastic
    case ('ELASTIC')
      is_repeated_law = material%is_corotational .or. material%inelastic_law /= INELASTIC_NONE .or. is_creep_by_name(material) &
        .or. .not. is_linear_elastic(material)
    case ('USERMATERIAL')
      is_repeated_law = material%is_user .or. .not. is_linear_elastic(material)
    case ('CREEP')
      is_repeated_law = is_creep_by_name(material)
    case ('VISCOELASTIC')
      is_repeated_law = allocated(material%prony)
    case default
      is_repeated_law = .false.
    end select
  end function is_repeated_law


  !> Whether a card is rejected.
  pure function is_rejected_card(reader, c) result(is_so)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    logical :: is_so
    is_so = reader%cards%cards(c)%entry == 0
    if (.not. is_so) is_so = reader%table%entries(reader%cards%cards(c)%entry)%status == ENTRY_REJECTED
  end function is_rejected_card


  !> A material with the finite-strain law of the dialect.
  pure function new_material(name, dialect) result(material)
    character(*), intent(in) :: name
    integer, intent(in) :: dialect
    type(material_type) :: material
    material%name = name
    material%law = merge(LAW_SAINT_VENANT, LAW_HENCKY, dialect == DIALECT_CALCULIX)
  end function new_material


  !> Adds a material that a section gives: isotropic and elastic.
  subroutine add_section_material(reader, c, model, elastic, density, expansion)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    type(model_type), intent(inout) :: model
    real(DP), intent(in) :: elastic(2)           !< Young's modulus [stress], Poisson's ratio [-]
    real(DP), intent(in) :: density              !< 0: none [mass/volume]
    real(DP), intent(in) :: expansion(2)         !< secant coefficient [1/temperature], 0: none, and its reference temperature
    model%materials = [model%materials, new_material('of the section in line ' // &
      to_text(reader%cards%line_number(reader%cards%cards(c)%line)), reader%dialect)]
    associate (material => model%materials(size(model%materials)))
      material%has_elastic = .true.
      material%elastic = property_table_type([0.0_DP], reshape(elastic, [2, 1]))
      material%youngs_modulus = elastic(1)
      material%poissons_ratio = elastic(2)
      material%has_density = density > 0
      material%density = density
      if (density < 0) call report_error(reader, reader%cards%cards(c)%line, 'The density must be positive.')
      material%expansion_reference = expansion(2)
      if (abs(expansion(1)) > 0) material%expansion = property_table_type([0.0_DP], reshape(expansion(:1), [1, 1]))
    end associate
  end subroutine add_section_material


  !> Adds a material that a section gives: anisotropic and elastic.
  subroutine add_anisotropic_material(reader, c, model, elastic, density)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    type(model_type), intent(inout) :: model
    real(DP), intent(in) :: elastic(21)          !< as in *ELASTIC, TYPE=ANISO [stress]
    real(DP), intent(in) :: density              !< 0: none [mass/volume]
    model%materials = [model%materials, new_material('of the section in line ' // &
      to_text(reader%cards%line_number(reader%cards%cards(c)%line)), reader%dialect)]
    associate (material => model%materials(size(model%materials)))
      material%has_elastic = .true.
      material%elastic_kind = ELASTIC_ANISOTROPIC
      material%elastic = property_table_type([0.0_DP], reshape(elastic, [21, 1]))
      material%has_density = density > 0
      material%density = density
    end associate
  end subroutine add_anisotropic_material


  !> Adds a material that is another one with given shear moduli 13, 23: linear elastic, or by UMAT, which then is a law of shells.
  subroutine add_sheared_material(model, original, G)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: original              !< index of the material
    real(DP), intent(in) :: G(2, 2)              !< of the stresses 13, 23 over their strains [stress]
    type(material_type) :: material
    real(DP), allocatable :: constants(:, :)
    real(DP) :: C(6, 6)
    integer, parameter :: DECK_ORDER(6) = [1, 2, 3, 4, 6, 5]   !< the decks order the shears 12 13 23
    integer :: i, j, k, t
    material = model%materials(original)
    if (material%is_user) then
      material%is_shell_law = .true.
      material%transverse_shear = G
      model%materials = [model%materials, material]
      return
    end if
    allocate (constants(21, size(material%elastic%value, 2)))
    do t = 1, size(constants, 2)
      C = elasticity_matrix(material%elastic_kind, material%elastic%value(:, t))
      C(:, 5:) = 0
      C(5:, :) = 0
      C(6, 6) = G(1, 1)                          ! 13
      C(5, 5) = G(2, 2)                          ! 23
      C(5, 6) = G(1, 2)
      C(6, 5) = G(1, 2)
      k = 0
      do j = 1, 6
        do i = 1, j
          k = k + 1
          constants(k, t) = C(DECK_ORDER(i), DECK_ORDER(j))
        end do
      end do
    end do
    material%elastic%value = constants
    material%elastic_kind = ELASTIC_ANISOTROPIC
    model%materials = [model%materials, material]
  end subroutine add_sheared_material


  !> Reports a material without elasticity, or with incompatible properties.
  subroutine check_material(reader, line, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    type(material_type), intent(inout) :: material
    character(:), allocatable :: who
    logical :: has_yield, is_nonlinear
    who = 'The material ''' // material%name // ''' '
    if (.not. (material%has_elastic .or. material%is_user)) call report_error(reader, line, who // 'has no *ELASTIC card.')
    call set_inner_history(reader, line, material)
    if (material%n_statev > 0 .and. .not. (material%is_user .or. material%is_user_field .or. material%inelastic_law /= &
      INELASTIC_NONE)) call report_error(reader, line, who // &
      'has *DEPVAR but no *USER MATERIAL or *USER DEFINED FIELD.')
    if (material%deletion > 0 .and. .not. material%is_user) call report_error(reader, line, who // 'has DELETE on *DEPVAR but ' // &
      'no *USER MATERIAL: the state variable that deletes a point is one of UMAT.')
    if (material%is_user .and. (material%has_elastic .or. allocated(material%isotropic_hardening) .or. &
      allocated(material%kinematic_hardening) .or. material%creep_law /= CREEP_NONE)) call report_error(reader, line, who // &
      'has *USER MATERIAL beside laws of ours; UMAT gives the whole stress.')
    if ((material%is_user .or. material%is_user_field) .and. len(material%name) > USER_NAME_LENGTH) call report_error(reader, &
      line, who // 'has a name of more than ' // to_text(USER_NAME_LENGTH) // ' letters, which user routines cannot be given.')
    if (material%inelastic_law /= INELASTIC_NONE .and. material%is_user_field) call report_error(reader, line, who // &
      'has *USER DEFINED FIELD beside a law whose state variables take the place of its STATEV, which is not supported.')
    call find_table_variable(reader, line, material)
    call check_cone(reader, line, material)
    call check_damage(reader, line, material)
    call complete_viscoelastic(reader, line, material)
    call complete_rate_dependence(reader, line, material)
    has_yield = allocated(material%isotropic_hardening) .or. allocated(material%kinematic_hardening)
    is_nonlinear = material%has_deformation_plasticity .or. material%is_corotational .or. .not. is_linear_elastic(material)
    if (material%cutoff_sign /= 0 .and. (is_nonlinear .or. has_yield .or. material%creep_law /= CREEP_NONE .or. allocated( &
      material%prony) .or. material%is_user .or. material%inelastic_law /= INELASTIC_NONE)) call report_error(reader, line, who // &
      'has *NO COMPRESSION or *NO TENSION beside a law that is not linear elastic. They are for *ELASTIC alone; soil and ' // &
      'concrete that yield are *MOHR COULOMB or *DRUCKER PRAGER.')
    if (material%inelastic_law /= INELASTIC_NONE .and. (has_yield .or. material%creep_law /= CREEP_NONE)) call report_error( &
      reader, line, who // 'has *PLASTIC or *CREEP beside a law of flow by its name; give one.')
    if (is_creep_by_name(material) .and. has_yield) call report_error(reader, line, who // 'has *PLASTIC beside creep by its ' // &
      'name; give *ELASTIC, TYPE=ORTHO, *PLASTIC and *CREEP under another name.')
    if ((has_yield .or. material%creep_law /= CREEP_NONE) .and. is_nonlinear) call report_error(reader, line, who // &
      'has both an elastic law that is not linear and *PLASTIC or *CREEP; give one.')
    if (material%creep_law /= CREEP_NONE .and. allocated(material%kinematic_hardening)) call report_error(reader, line, who // &
      'has *CREEP with kinematic hardening, which is not supported; use isotropic hardening.')
    if (allocated(material%kinematic_hardening) .and. (material%elastic_kind == ELASTIC_ORTHOTROPIC .or. &
      material%elastic_kind == ELASTIC_ANISOTROPIC)) call report_error(reader, line, who // 'has kinematic hardening with ' // &
      'anisotropic elasticity, which is not supported; isotropic hardening is.')
    if (.not. is_linear_elastic(material) .and. allocated(material%expansion%value)) then
      if (size(material%expansion%value, 1) > 1) call report_error(reader, line, who // &
        'has an elastic law that is not linear and anisotropic expansion, which is not supported.')
    end if
  end subroutine check_material


  !> What the tables of a material are over: the temperature or one field variable.
  subroutine find_table_variable(reader, line, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    type(material_type), intent(inout) :: material
    integer, allocatable :: variables(:)
    integer :: i
    allocate (variables(0))
    call add_table(material%elastic)
    call add_table(material%expansion)
    call add_table(material%deformation_plasticity)
    call add_table(material%creep)
    call add_table(material%cone)
    call add_table(material%inelastic)
    call add_table(material%rate_power)
    if (allocated(material%rate_ratio)) call add_curves(material%rate_ratio)
    if (allocated(material%rate_curves)) then
      do i = 1, size(material%rate_curves)
        call add_curves(material%rate_curves(i)%curves)
      end do
    end if
    if (allocated(material%isotropic_hardening)) call add_curves(material%isotropic_hardening)
    if (allocated(material%kinematic_hardening)) call add_curves(material%kinematic_hardening)
    if (material%density_table%variable > 0) call report_error(reader, line, 'The material ''' // material%name // &
      ''' has a density over a field variable; it may depend on the temperature alone.')
    if (size(variables) == 0) return
    material%table_variable = variables(1)
    if (any(variables /= variables(1))) call report_error(reader, line, 'The material ''' // material%name // &
      ''' has tables over the temperature and over field variables, or over different ones; all must be over the same.')

  contains

    !> Adds what a table of several records is over.
    subroutine add_table(table)
      type(property_table_type), intent(in) :: table
      if (.not. allocated(table%temperature)) return
      if (size(table%temperature) > 1) variables = [variables, table%variable]
    end subroutine add_table

    !> The same of hardening curves.
    subroutine add_curves(curves)
      type(hardening_curve_type), intent(in) :: curves(:)
      if (size(curves) > 1) variables = [variables, curves(2)%variable]
    end subroutine add_curves

  end subroutine find_table_variable


  !> USER MATERIAL: the PROPS of UMAT. CalculiX has laws of its own for some names.
  subroutine read_user_material(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: n, status
    call open_card(reader, c, parameters, row)
    if (reader%dialect == DIALECT_CALCULIX .and. .not. has_parameter(parameters, 'LIBRARY') .and. is_law_by_name(material%name)) &
      then
      call read_law_by_name(reader, c, material)
      return
    else if (reader%dialect == DIALECT_CALCULIX .and. .not. has_parameter(parameters, 'LIBRARY') .and. &
      is_named_law(material%name)) then
      call read_named_law(reader, c, material)
      return
    end if
    material%is_user = .true.
    material%is_called_in_3d = has_parameter(parameters, 'SPATIAL')
    if (has_parameter(parameters, 'LIBRARY')) material%library = parameter_text(parameters, 'LIBRARY')
    call parse_integer(parameter_text(parameters, 'CONSTANTS'), n, status)
    if (status /= NUMBER_OK .or. n < 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'CONSTANTS must be the number of the constants of UMAT, 0 or more.')
      return
    end if
    allocate (material%props(n), source=0.0_DP)
    call read_user_constants(reader, c, row, 'CONSTANTS', material%props)
  end subroutine read_user_material


  !> DEPVAR: the number of the STATEV. Lines that name them are ignored.
  subroutine read_depvar(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: n, status
    call open_card(reader, c, parameters, row)
    n = 0
    status = -1
    if (next_row(reader%cards, row)) call parse_integer(field_text(reader%cards, row, 1), n, status)
    if (status /= NUMBER_OK .or. n < 1 .or. n > MAX_STATEV) then
      call report_error(reader, reader%cards%cards(c)%line, '*DEPVAR needs the number of the variables of UMAT or USDFLD: ' // &
        '1 to ' // to_text(MAX_STATEV) // '.')
    else
      material%n_statev = n
    end if
    if (.not. has_parameter(parameters, 'DELETE')) return
    call parse_integer(parameter_text(parameters, 'DELETE'), material%deletion, status)
    if (status == NUMBER_OK .and. material%deletion >= 1 .and. material%deletion <= material%n_statev) return
    call report_error(reader, reader%cards%cards(c)%line, 'DELETE must be the number of a state variable, 1 to ' // &
      to_text(material%n_statev) // '.')
    material%deletion = 0
  end subroutine read_depvar


  !> Where the state of viscoelastic and cohesive laws begins: behind the STATEV of all.
  pure subroutine place_inner_history(materials)
    type(material_type), intent(inout) :: materials(:)
    integer :: m, n
    n = maxval([0, materials%n_statev])
    do m = 1, size(materials)
      associate (material => materials(m))
        if (allocated(material%prony)) material%n_inner = n_viscoelastic_state(size(material%prony, 2))
        if (allocated(material%damage)) material%n_inner = N_COHESIVE_STATE
        if (allocated(material%prony) .or. allocated(material%damage)) material%inner_first = merge(USER_STATE + n, &
          MAX_HISTORY + 1, n > 0)
      end associate
    end do
  end subroutine place_inner_history


  !> What follows from the whole deck: which materials are plain, and how much history the others have. Without any
  !! temperature expansion has no effect.
  subroutine finalize_materials(model)
    type(model_type), intent(inout) :: model
    logical :: has_past, has_temperature
    integer :: m, i
    has_past = allocated(model%initial_history) .or. allocated(model%initial_stress) .or. &
      any([(allocated(model%steps(i)%is_relieved), i=1, size(model%steps))])
    has_temperature = .false.
    if (allocated(model%initial_temperature)) has_temperature = .true.   ! the library may set others
    do i = 1, size(model%steps)
      if (allocated(model%steps(i)%temperatures)) has_temperature = has_temperature .or. &
        size(model%steps(i)%temperatures) > 0
    end do
    call place_inner_history(model%materials)
    do m = 1, size(model%materials)
      associate (material => model%materials(m))
        if (.not. has_temperature .and. allocated(material%expansion%value)) deallocate (material%expansion%value)
        material%n_history = 0
        if (allocated(material%isotropic_hardening) .or. material%creep_law /= CREEP_NONE .or. has_past) &
          material%n_history = HISTORY_INELASTIC + 5
        if (allocated(material%kinematic_hardening)) material%n_history = HISTORY_BACK + 5
        if (has_past .and. material%law == LAW_SAINT_VENANT .and. is_inelastic(material)) material%n_history = HISTORY_STRETCH
        if (material%n_inner > 0) material%n_history = material%inner_first + material%n_inner - 1
        material%is_linear_isotropic = material%elastic_kind == ELASTIC_ISOTROPIC .and. material%n_history == 0 .and. &
          .not. (material%is_corotational .or. material%cutoff_sign /= 0 .or. &
          allocated(material%expansion%value) .or. material%has_deformation_plasticity)
        if (allocated(material%elastic%value)) material%is_linear_isotropic = material%is_linear_isotropic .and. &
          size(material%elastic%value, 2) == 1
        if (material%is_user .or. material%is_user_field) then
          material%n_history = USER_STATE - 1 + material%n_statev
          if (material%is_user .and. material%is_user_field) material%n_history = user_field_place(material, material%n_fields) + &
            material%n_statev
          material%is_linear_isotropic = .false.
        end if
        material%is_unsymmetric = material%is_user .or. material%is_corotational .or. material%cutoff_sign /= 0 .or. &
          material%inelastic_law == INELASTIC_CRYSTAL
        if (allocated(material%damage)) material%is_unsymmetric = material%damage%has_evolution
        if (allocated(material%cone%value)) material%is_unsymmetric = material%yield_surface == YIELD_MOHR_COULOMB .or. &
          material%has_cap .or. any(material%cone%value(1, :) > material%cone%value(2, :))
      end associate
    end do
  end subroutine finalize_materials


  !> DENSITY: rho > 0 over the temperature.
  subroutine read_density(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(property_table_type) :: table
    logical :: is_ok
    material%has_density = .true.
    call read_table(reader, c, 1, table, is_ok)
    if (.not. is_ok) return
    material%density = table%value(1, 1)
    if (any(table%value(1, :) <= 0)) call report_error(reader, reader%cards%cards(c)%line, 'The density must be positive.')
    if (maxval(abs(table%value(1, :) - material%density)) > 0) material%density_table = table
  end subroutine read_density


  !> EXPANSION.
  subroutine read_expansion(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: n, status
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    select case (parameter_word(parameters, 'TYPE', 'ISO'))
    case ('ISO', 'ISOTROPIC')
      n = 1
    case ('ORTHO', 'ORTHOTROPIC')
      n = 3
    case default
      n = 6
    end select
    if (has_parameter(parameters, 'ZERO')) call parse_real(parameter_text(parameters, 'ZERO'), &
      material%expansion_reference, status)
    call read_table(reader, c, n, material%expansion, is_ok)
  end subroutine read_expansion


  !> PLASTIC, CHANGE PLASTIC.
  subroutine read_plastic(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    call open_card(reader, c, parameters, row)
    if (parameter_word(parameters, 'HARDENING', 'ISOTROPIC') == 'ISOTROPIC') then
      call read_isotropic_plastic(reader, c, material)
    else
      call read_curves(reader, c, material%kinematic_hardening)
      if (has_parameter(parameters, 'RATE')) call report_error(reader, reader%cards%cards(c)%line, &
        'RATE goes with HARDENING=ISOTROPIC alone: kinematic hardening over the rate is not supported.')
    end if
  end subroutine read_plastic


  !> DRUCKER PRAGER: friction angle, K, dilation angle in degrees. K = 0 or none is 1, as in Abaqus.
  subroutine read_cone(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(property_table_type) :: table
    real(DP), parameter :: MAX_FRICTION = 71.5_DP  ! of compression: tan(beta) < 3 [degree]
    real(DP), parameter :: MIN_RATIO = 0.778_DP    ! as in Abaqus; the least is 7/9 [-]
    real(DP), parameter :: DEGREE = PI / 180
    logical :: is_ok
    integer :: line
    line = reader%cards%cards(c)%line
    call refuse_second_cone(reader, line, material)
    call read_table(reader, c, 3, table, is_ok)
    if (.not. is_ok) return
    if (any(table%value(1, :) < 0) .or. any(table%value(1, :) > MAX_FRICTION)) call report_error(reader, line, &
      'The friction angle must be from 0 to ' // to_text(MAX_FRICTION) // ' degrees, in the plane of pressure and ' // &
      'von Mises stress.')
    where (.not. abs(table%value(2, :)) > 0) table%value(2, :) = 1
    if (any(table%value(2, :) < MIN_RATIO) .or. any(table%value(2, :) > 1)) call report_error(reader, line, &
      'K, the ratio of the yield stresses in triaxial tension and compression, must be from ' // to_text(MIN_RATIO) // &
      ' to 1 (0 or blank mean 1): a yield surface of less is not convex.')
    if (any(table%value(2, :) < 1)) material%yield_surface = YIELD_RATIO
    if (any(table%value(3, :) < 0) .or. any(table%value(3, :) > table%value(1, :))) call report_error(reader, line, &
      'The dilation angle must be from 0 to the friction angle: with more the plastic flow would give energy away.')
    material%cone%temperature = table%temperature
    material%cone%variable = table%variable
    material%cone%value = table%value([1, 3, 2], :)
    material%cone%value(:2, :) = DEGREE * material%cone%value(:2, :)
  end subroutine read_cone


  !> Reports a second card of a yield surface.
  subroutine refuse_second_cone(reader, line, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    type(material_type), intent(in) :: material
    if (allocated(material%cone%value)) call report_error(reader, line, 'The material ''' // material%name // &
      ''' has a *DRUCKER PRAGER or *MOHR COULOMB before this card; give one law of yield.')
  end subroutine refuse_second_cone


  !> MOHR COULOMB: friction and dilation angle in degrees.
  subroutine read_pyramid(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(property_table_type) :: table
    real(DP), parameter :: MAX_FRICTION = 85.0_DP  ! [degree]
    real(DP), parameter :: DEGREE = PI / 180
    real(DP) :: meridional, deviatoric             ! eccentricities [-]
    logical :: is_ok
    integer :: line, status
    line = reader%cards%cards(c)%line
    call open_card(reader, c, parameters, row)
    meridional = 0.1_DP
    deviatoric = 0
    if (has_parameter(parameters, 'ECCENTRICITY')) call parse_real(parameter_text(parameters, 'ECCENTRICITY'), meridional, status)
    if (has_parameter(parameters, 'DEVIATORIC ECCENTRICITY')) then
      call parse_real(parameter_text(parameters, 'DEVIATORIC ECCENTRICITY'), deviatoric, status)
      if (.not. (deviatoric > 0.5_DP .and. deviatoric <= 1)) call report_error(reader, line, &
        'DEVIATORIC ECCENTRICITY must be above 0.5 and at most 1: with less the flow potential is not convex.')
    end if
    if (meridional < 0) call report_error(reader, line, 'ECCENTRICITY must not be negative.')
    call refuse_second_cone(reader, line, material)
    material%yield_surface = YIELD_MOHR_COULOMB
    call read_table(reader, c, 2, table, is_ok)
    if (.not. is_ok) return
    if (any(table%value(1, :) < 0) .or. any(table%value(1, :) > MAX_FRICTION)) call report_error(reader, line, &
      'The friction angle must be from 0 to ' // to_text(MAX_FRICTION) // ' degrees.')
    if (any(table%value(2, :) < 0) .or. any(table%value(2, :) > table%value(1, :))) call report_error(reader, line, &
      'The dilation angle must be from 0 to the friction angle: with more the plastic flow would give energy away.')
    material%cone%temperature = table%temperature
    material%cone%variable = table%variable
    allocate (material%cone%value(4, size(table%value, 2)))
    material%cone%value(:2, :) = DEGREE * table%value
    material%cone%value(3, :) = deviatoric
    if (.not. deviatoric > 0) &
      material%cone%value(3, :) = (3 - sin(DEGREE * table%value(1, :))) / (3 + sin(DEGREE * table%value(1, :)))
    material%cone%value(4, :) = meridional
  end subroutine read_pyramid


  !> MOHR COULOMB HARDENING.
  subroutine read_pyramid_hardening(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    integer :: i
    material%has_cone_hardening = .true.
    material%cone_hardening = CONE_COHESION
    call read_curves(reader, c, material%isotropic_hardening)
    do i = 1, size(material%isotropic_hardening)
      if (any(material%isotropic_hardening(i)%stress <= 0)) call report_error(reader, reader%cards%cards(c)%line, &
        'The cohesion must be positive; give a soil without cohesion a small one.')
    end do
  end subroutine read_pyramid_hardening


  !> DRUCKER PRAGER HARDENING.
  subroutine read_cone_hardening(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    call open_card(reader, c, parameters, row)
    material%has_cone_hardening = .true.
    select case (parameter_word(parameters, 'TYPE', 'COMPRESSION'))
    case ('TENSION')
      material%cone_hardening = CONE_TENSION
    case ('SHEAR')
      material%cone_hardening = CONE_SHEAR
    case default
      material%cone_hardening = CONE_COMPRESSION
    end select
    call read_curves(reader, c, material%isotropic_hardening)
  end subroutine read_cone_hardening


  !> Reports an incomplete cone, or one beside what it does not go with.
  subroutine check_cone(reader, line, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    type(material_type), intent(in) :: material
    character(:), allocatable :: who, law
    who = 'The material ''' // material%name // ''' '
    law = '*DRUCKER PRAGER'
    if (material%yield_surface == YIELD_MOHR_COULOMB) law = '*MOHR COULOMB'
    if (material%has_cap) law = '*CAP PLASTICITY'
    if (allocated(material%cone%value) .neqv. material%has_cone_hardening) call report_error(reader, line, who // &
      'needs both *DRUCKER PRAGER, *MOHR COULOMB or *CAP PLASTICITY and its HARDENING (the yield stress), each once.')
    if (material%has_plastic .and. (allocated(material%cone%value) .or. material%has_cone_hardening)) call report_error(reader, &
      line, who // 'has *PLASTIC or *CYCLIC HARDENING beside ' // law // '; give one law of yield.')
    if (.not. allocated(material%cone%value)) return
    if (material%has_cone_hardening .and. (material%yield_surface == YIELD_MOHR_COULOMB .neqv. material%cone_hardening == &
      CONE_COHESION)) call report_error(reader, line, who // 'has ' // law // ' with the HARDENING of another law; give ' // &
      'that of the same law.')
    if (material%has_cone_hardening .and. material%has_cap) then
      if (.not. is_cap_complete(material)) call report_error(reader, line, who // 'has ' // law // ' with the HARDENING of ' // &
        'another law; give that of the same law.')
    end if
    if (material%elastic_kind /= ELASTIC_ISOTROPIC) call report_error(reader, line, who // &
      'has ' // law // ' with an elasticity that is not isotropic, which is not supported; give E and nu.')
    if (material%creep_law /= CREEP_NONE) call report_error(reader, line, who // 'has ' // law // ' with *CREEP, which is ' // &
      'not supported; give one of them.')
  end subroutine check_cone


  !> DEFORMATION PLASTICITY: its own E and nu.
  subroutine read_deformation(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    integer :: i
    logical :: is_ok
    material%has_elastic = .true.
    material%has_deformation_plasticity = .true.
    call read_table(reader, c, 5, material%deformation_plasticity, is_ok)
    if (.not. is_ok) return
    material%youngs_modulus = material%deformation_plasticity%value(1, 1)
    material%poissons_ratio = material%deformation_plasticity%value(2, 1)
    do i = 1, size(material%deformation_plasticity%temperature)
      call check_isotropic(reader, c, material%deformation_plasticity%value(:2, i))
      if (material%deformation_plasticity%value(3, i) <= 0 .or. material%deformation_plasticity%value(4, i) < 1 .or. &
        material%deformation_plasticity%value(5, i) <= 0) call report_error(reader, reader%cards%cards(c)%line, &
        'The yield stress and the offset must be positive and the exponent at least 1.')
    end do
  end subroutine read_deformation


  !> HYPERELASTIC: constants in the order of the kind; D1 = 0 becomes 0.1/G.
  subroutine read_hyperelastic(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(property_table_type) :: given
    integer :: order, i
    integer, allocatable :: place(:)
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    material%has_elastic = .true.
    material%elastic_kind = ELASTIC_HYPER
    material%hyper_kind = HYPER_POLYNOMIAL
    call read_order(reader, c, parameters, order)
    if (has_parameter(parameters, 'OGDEN')) then
      material%hyper_kind = HYPER_OGDEN
      place = [(i, i=1, 3 * order)]
    else if (has_parameter(parameters, 'ARRUDA-BOYCE')) then
      material%hyper_kind = HYPER_ARRUDA_BOYCE
      order = 1
      place = [1, 2, 3]
    else if (has_parameter(parameters, 'NEO HOOKE') .or. has_parameter(parameters, 'YEOH') .or. &
      has_parameter(parameters, 'REDUCED POLYNOMIAL')) then
      if (has_parameter(parameters, 'NEO HOOKE')) order = 1
      if (has_parameter(parameters, 'YEOH')) order = 3
      place = [(i * (i + 1) / 2, i=1, order), (order * (order + 3) / 2 + i, i=1, order)]
    else
      if (has_parameter(parameters, 'MOONEY-RIVLIN')) order = 1
      place = [(i, i=1, order * (order + 3) / 2 + order)]
    end if
    material%hyper_order = order
    if (has_parameter(parameters, 'TEST DATA INPUT')) then
      call fit_hyperelastic(reader, c, place, material, is_ok)
      if (.not. is_ok) return
    else
      call read_table(reader, c, size(place), given, is_ok)
      if (.not. is_ok) return
      material%elastic%temperature = given%temperature
      material%elastic%variable = given%variable
      allocate (material%elastic%value(maxval(place), size(given%temperature)), source=0.0_DP)
      material%elastic%value(place, :) = given%value
    end if
    do i = 1, size(material%elastic%temperature)
      call complete_hyperelastic(reader, c, material%hyper_kind, order, material%elastic%value(:, i))
    end do
  end subroutine read_hyperelastic


  !> N of rubber and foam.
  subroutine read_order(reader, c, parameters, order)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(out) :: order
    integer :: status, most
    order = 1
    if (has_parameter(parameters, 'N')) call parse_integer(parameter_text(parameters, 'N'), order, status)
    most = MAX_HYPER_ORDER
    if (.not. (has_parameter(parameters, 'OGDEN') .or. has_parameter(parameters, 'REDUCED POLYNOMIAL') .or. &
      is_card(reader, c, 'HYPERFOAM'))) most = 3
    if (order >= 1 .and. order <= most) return
    call report_error(reader, reader%cards%cards(c)%line, 'N must be from 1 to ' // to_text(most) // ' here.')
    order = 1
  end subroutine read_order


  !> Checks the initial shear modulus, and replaces a first volumetric constant of zero.
  subroutine complete_hyperelastic(reader, c, kind, order, constants)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    integer, intent(in) :: kind, order
    real(DP), intent(inout) :: constants(:)
    real(DP) :: G
    integer :: d, i
    select case (kind)
    case (HYPER_OGDEN)
      G = sum([(constants(2 * i - 1), i=1, order)])
      d = 2 * order + 1
      if (any([(.not. abs(constants(2 * i)) > 0, i=1, order)])) call report_error(reader, reader%cards%cards(c)%line, &
        'An exponent alpha must not be zero.')
    case (HYPER_ARRUDA_BOYCE)
      if (.not. constants(2) > 0) then
        call report_error(reader, reader%cards%cards(c)%line, 'The locking stretch lambda must be positive.')
        return
      end if
      G = constants(1) * (1 + 3 / (5 * constants(2)**2) + 99 / (175 * constants(2)**4) + 513 / (875 * &
        constants(2)**6) + 42039 / (67375 * constants(2)**8))
      d = 3
    case default
      G = 2 * (constants(1) + constants(2))
      d = order * (order + 3) / 2 + 1
    end select
    if (.not. G > 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'The shear modulus at rest must be positive; it is ' // &
        to_text(G) // '.')
    else if (constants(d) < 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'D1 must not be negative.')
    else if (.not. constants(d) > 0) then
      constants(d) = 0.1_DP / G
      call report_note(reader, reader%cards%cards(c)%line, 'D1 = 0 is taken as 0.1/G = ' // to_text(constants(d)) // &
        ', a Poisson''s ratio of 0.475: the solids here are not exactly incompressible.')
    end if
  end subroutine complete_hyperelastic


  !> HYPERFOAM.
  subroutine read_hyperfoam(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: i, k
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    material%has_elastic = .true.
    material%elastic_kind = ELASTIC_FOAM
    call read_order(reader, c, parameters, material%hyper_order)
    k = material%hyper_order
    call read_table(reader, c, 3 * k, material%elastic, is_ok)
    if (.not. is_ok) return
    do i = 1, size(material%elastic%temperature)
      associate (constants => material%elastic%value(:, i))
        if (.not. sum(constants(1:2 * k:2)) > 0) call report_error(reader, reader%cards%cards(c)%line, &
          'The shear modulus at rest must be positive.')
        if (any(.not. abs(constants(2:2 * k:2)) > 0)) call report_error(reader, reader%cards%cards(c)%line, &
          'An exponent alpha must not be zero.')
        if (any(constants(2 * k + 1:) <= -1) .or. any(constants(2 * k + 1:) >= 0.5_DP)) call report_error(reader, &
          reader%cards%cards(c)%line, 'Poisson''s ratio must be greater than -1 and less than 0.5.')
      end associate
    end do
  end subroutine read_hyperfoam

end module amontons_deck_materials
