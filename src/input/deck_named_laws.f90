!> Laws of flow, and elasticity in the stretch, that CalculiX takes by the name of the material, to the constants of materials.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_named_laws
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type
  use amontons_card_schema, only: parameter_text
  use amontons_crystal_plasticity, only: N_CRYSTAL_CONSTANTS, N_CRYSTAL_STATE, N_CRYSTAL_CREEP_STATE
  use amontons_deck_elasticity, only: check_isotropic, check_definite, is_law_by_name, law_of_name
  use amontons_deck_property_tables, only: read_table
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, is_card
  use amontons_linear_viscoplasticity, only: N_LINEAR_STATE
  use amontons_materials, only: material_type, property_table_type, ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC, &
    INELASTIC_CRYSTAL, INELASTIC_CRYSTAL_CREEP, INELASTIC_LINEAR, CREEP_NONE, CREEP_TIME_HARDENING, RATE_NONE, &
    USER_STATE
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_text, only: upper_case, to_text, parse_integer, NUMBER_OK
  implicit none
  private
  public :: is_named_law, read_named_law, set_inner_history, check_steps_of_law, is_creep_by_name

  !> Names of materials begin with these words; a longer one counts before its beginning.
  character(22), parameter :: NAMES(7) = [character(22) :: 'SINGLE_CRYSTAL_CREEP', 'SINGLE_CRYSTAL', 'ANISO_PLAS', 'ANISO_CREEP', &
    'LIN_EL_COROT', 'UNDO_NLGEOM_LIN_ISO_EL', 'UNDO_NLGEOM_LIN_EL']
  integer, parameter :: CRYSTAL_CREEP = 1, CRYSTAL = 2, ANISO_PLAS = 3, ANISO_CREEP = 4, ISOTROPIC_STRETCH = 6
  character(*), parameter :: NO_LAW = 'IDEAL_GAS'

  real(DP), parameter :: CALCULIX_CREEP(3) = [1.0e-10_DP, 5.0_DP, 0.0_DP]   !< A, n, m of the routine CREEP that CalculiX comes with

contains

  !> Whether CalculiX has such a law for a name.
  pure logical function is_named_law(name)
    character(*), intent(in) :: name
    is_named_law = law_of_name(name, NAMES) > 0 .or. index(upper_case(name), NO_LAW) == 1
  end function is_named_law


  !> Whether a material creeps as ANISO_CREEP.
  pure logical function is_creep_by_name(material)
    type(material_type), intent(in) :: material
    is_creep_by_name = .false.
    if (law_of_name(material%name, NAMES) /= ANISO_CREEP .or. .not. allocated(material%creep%value)) return
    is_creep_by_name = all(abs(material%creep%value(:, 1) - CALCULIX_CREEP) <= 0)
  end function is_creep_by_name


  !> USER MATERIAL of such a name.
  subroutine read_named_law(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(property_table_type) :: given
    integer :: law, n
    logical :: is_ok
    law = law_of_name(material%name, NAMES)
    if (material%has_elastic .or. material%creep_law /= CREEP_NONE) call report_error(reader, reader%cards%cards(c)%line, &
      'The material ''' // material%name // ''' has a law of stress before this card; give one.')
    material%has_elastic = .true.                ! errors of the card are reported below
    if (law == 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'The material ''' // material%name // ''' is a gas for CalculiX, by ' &
        // 'its name; gases are not supported. Give the pressure as a *DLOAD, a *USER MATERIAL with LIBRARY=, or another name.')
      return
    end if
    select case (law)
    case (CRYSTAL)
      n = 3 + 2 * N_CRYSTAL_CONSTANTS
    case (CRYSTAL_CREEP)
      n = 7
    case (ANISO_PLAS)
      n = 15
    case (ANISO_CREEP)
      n = 9
    case default
      n = n_elastic_constants(reader, c, law)
    end select
    if (n == 0) return
    if (.not. is_number_right(reader, c, material%name, n)) return
    call read_table(reader, c, n, given, is_ok)
    if (.not. is_ok) return
    material%elastic%temperature = given%temperature
    material%elastic%variable = given%variable
    if (law >= ANISO_CREEP) then
      material%elastic%value = given%value
      call set_elasticity(reader, c, law, material)
    else
      call set_flow(reader, c, law, given, material)
    end if
    if (material%elastic_kind /= ELASTIC_ISOTROPIC) call check_definite(reader, c, material)
  end subroutine read_named_law


  !> Whether CONSTANTS is the number of the law.
  logical function is_number_right(reader, c, name, n)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: name
    integer, intent(in) :: n
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: k, status
    call open_card(reader, c, parameters, row)
    call parse_integer(parameter_text(parameters, 'CONSTANTS'), k, status)
    is_number_right = status == NUMBER_OK .and. k == n
    if (.not. is_number_right) call report_error(reader, reader%cards%cards(c)%line, 'CONSTANTS must be ' // to_text(n) // &
      ' for a material ''' // name // ''', whose law CalculiX takes by its name.')
  end function is_number_right


  !> CONSTANTS of an elasticity: 2, 9 or 21; 0: another number, which is reported.
  integer function n_elastic_constants(reader, c, law) result(n)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: law
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: status
    call open_card(reader, c, parameters, row)
    call parse_integer(parameter_text(parameters, 'CONSTANTS'), n, status)
    if (status == NUMBER_OK .and. (n == 2 .or. (law /= ISOTROPIC_STRETCH .and. (n == 9 .or. n == 21)))) return
    n = 0
    call report_error(reader, reader%cards%cards(c)%line, 'CONSTANTS must be 2 (E and nu)' // trim(merge(repeat(' ', 38), &
      ', 9 (orthotropic) or 21 (anisotropic) ', law == ISOTROPIC_STRETCH)) // ' for a material of this name.')
  end function n_elastic_constants


  !> Elasticity in the stretch, or with CalculiX's creep.
  subroutine set_elasticity(reader, c, law, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: law
    type(material_type), intent(inout) :: material
    integer :: i
    material%is_corotational = law > ANISO_CREEP
    select case (size(material%elastic%value, 1))
    case (2)
      material%elastic_kind = ELASTIC_ISOTROPIC
      do i = 1, size(material%elastic%temperature)
        call check_isotropic(reader, c, material%elastic%value(:, i))
      end do
      material%youngs_modulus = material%elastic%value(1, 1)
      material%poissons_ratio = material%elastic%value(2, 1)
    case (9)
      material%elastic_kind = ELASTIC_ORTHOTROPIC
    case default
      material%elastic_kind = ELASTIC_ANISOTROPIC
    end select
    if (law /= ANISO_CREEP) return
    material%creep_law = CREEP_TIME_HARDENING
    material%creep = property_table_type([0.0_DP], reshape(CALCULIX_CREEP, [3, 1]))
    call report_note(reader, reader%cards%cards(c)%line, 'The material ''' // material%name // ''' creeps at the rate 1e-10 q^5, ' &
      // 'by the routine CREEP that CalculiX comes with. For another rate give *ELASTIC, TYPE=ORTHO and *CREEP.')
  end subroutine set_elasticity


  !> Refuses steps in which a law is not meant: UNDO_NLGEOM_LIN_ISO_EL without NLGEOM, where CalculiX takes another strain (forces
  !! differ by a tenth at 20 per cent), and laws of rates in RIKS, whose times are lengths of its arc.
  subroutine check_steps_of_law(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer :: m, c
    do m = 1, size(model%materials)
      if (.not. any(model%mesh%material == m)) cycle
      associate (material => model%materials(m))
        do c = 1, reader%cards%n_cards
          if (.not. is_card(reader, c, 'STEP')) cycle
          associate (step => model%steps(reader%step_of_card(c)))
            if (.not. step%is_nlgeom .and. material%is_corotational .and. law_of_name(material%name, NAMES) == ISOTROPIC_STRETCH) &
              call report_error(reader, reader%cards%cards(c)%line, 'The law of the material ''' // material%name // &
              ''' is for steps with NLGEOM alone. Give *STEP, NLGEOM, or the name LIN_EL_COROT, or *ELASTIC.')
            if (step%is_riks .and. material%rate_law /= RATE_NONE) call report_error(reader, reader%cards%cards(c)%line, &
              'The material ''' // material%name // ''' yields at a rate, and a RIKS step has no time. Give *STATIC without RIKS.')
            if (step%is_riks .and. any(material%inelastic_law == [INELASTIC_CRYSTAL, INELASTIC_CRYSTAL_CREEP])) &
              call report_error(reader, reader%cards%cards(c)%line, 'The crystal ''' // material%name // ''' slips at a rate, ' // &
              'and a RIKS step has no time. Give *STATIC without RIKS.')
          end associate
        end do
      end associate
    end do
  end subroutine check_steps_of_law


  !> The laws of flow.
  subroutine set_flow(reader, c, law, given, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: law
    type(property_table_type), intent(in) :: given
    type(material_type), intent(inout) :: material
    integer :: line, i, k
    character(:), allocatable :: who
    line = reader%cards%cards(c)%line
    who = 'The material ''' // material%name // ''' '
    material%elastic_kind = ELASTIC_ORTHOTROPIC
    material%inelastic%temperature = given%temperature
    material%inelastic%variable = given%variable
    if (law == ANISO_PLAS) then
      material%inelastic_law = INELASTIC_LINEAR
      material%elastic%value = given%value(:9, :)
      material%inelastic%value = given%value(10:, :)
      associate (x => material%inelastic%value)
        if (any(x(:3, :) < 0)) call report_error(reader, line, who // &
          'needs a yield stress and two hardening moduli of 0 or more (constants 10 to 12).')
        if (any(.not. abs(x(4, :)) > 0) .or. any(x(4, :) > 0 .and. .not. x(5, :) > 0)) call report_error(reader, line, who // &
          'needs A and n above 0 (constants 13 and 14) in the rate A t^m (overstress)^n, or A below 0 for none of it.')
      end associate
      return
    end if
    material%inelastic_law = merge(INELASTIC_CRYSTAL, INELASTIC_CRYSTAL_CREEP, law == CRYSTAL)
    material%elastic%value = given%value([1, 2, 1, 2, 2, 1, 3, 3, 3], :)   ! a cubic crystal
    material%inelastic%value = given%value(4:, :)
    k = size(material%inelastic%value, 1) / 2      ! of a family
    associate (x => material%inelastic%value)
      do i = 0, k, k
        if (any(.not. x(i + 1, :) > 0) .or. any(.not. x(i + 2, :) >= 1)) call report_error(reader, line, who // &
          'needs K above 0 and n of 1 or more (constants ' // to_text(i + 4) // ' and ' // to_text(i + 5) // ').')
        if (law == CRYSTAL) then
          if (any(x(i + 3:i + 4, :) < 0) .or. any(x(i + 6:i + 7, :) < 0) .or. any(x(i + 9, :) < 0)) call report_error(reader, &
            line, who // 'needs c, d, delta, r0 and b of 0 or more (constants ' // to_text(i + 6) // ' to ' // to_text(i + 12) &
            // ').')
        end if
      end do
    end associate
  end subroutine set_flow


  !> The state variables of a law of flow: those of CalculiX in their order, DEPVAR of them at least.
  subroutine set_inner_history(reader, line, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    type(material_type), intent(inout) :: material
    integer :: n
    select case (material%inelastic_law)
    case (INELASTIC_CRYSTAL)
      n = N_CRYSTAL_STATE
    case (INELASTIC_CRYSTAL_CREEP)
      n = N_CRYSTAL_CREEP_STATE
    case (INELASTIC_LINEAR)
      n = N_LINEAR_STATE
    case default                                   ! ANISO_CREEP has seven in CalculiX; here they are those of creep
      if (reader%dialect == DIALECT_CALCULIX .and. (is_named_law(material%name) .or. is_law_by_name(material%name)) .and. .not. &
        (material%is_user .or. material%is_user_field)) material%n_statev = 0
      return
    end select
    if (material%n_statev > 0 .and. material%n_statev < n) call report_error(reader, line, 'The material ''' // material%name // &
      ''' has ' // to_text(n) // ' state variables; its *DEPVAR names only ' // to_text(material%n_statev) // '.')
    material%n_statev = max(n, material%n_statev)
    material%inner_first = USER_STATE
    material%n_inner = material%n_statev
  end subroutine set_inner_history

end module amontons_deck_named_laws
