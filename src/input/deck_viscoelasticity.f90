!> VISCOELASTIC to the Prony series of materials, and long-term constants to instantaneous ones.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_viscoelasticity
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: parameter_word, has_parameter
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_real, check_n_fields, is_card
  use amontons_element_kinds, only: KIND_C3D8R, KIND_CPS4R, KIND_CPE4R, KIND_CAX4R
  use amontons_materials, only: material_type, ELASTIC_ISOTROPIC, ELASTIC_HYPER, HYPER_OGDEN, HYPER_ARRUDA_BOYCE, CREEP_NONE, &
    INELASTIC_NONE
  use amontons_model, only: model_type
  implicit none
  private
  public :: read_viscoelastic, complete_viscoelastic, check_viscoelastic_steps

contains

  !> VISCOELASTIC, TIME=PRONY: g, k, tau of each term.
  subroutine read_viscoelastic(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP) :: term(3)
    real(DP), allocatable :: terms(:, :)
    integer :: i, line
    logical :: is_ok
    line = reader%cards%cards(c)%line
    call open_card(reader, c, parameters, row)
    allocate (terms(3, 0))
    is_ok = .true.
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 3)
      do i = 1, 3
        call read_real(reader, row, i, 'constant', term(i), is_ok, 0.0_DP)
      end do
      if (.not. is_ok) return
      if (any(term(:2) < 0) .or. .not. term(3) > 0) then
        call report_error(reader, row%line, 'A term of the Prony series needs g and k of 0 or more and a relaxation time tau ' // &
          'above 0.')
        return
      end if
      terms = reshape([terms, term], [3, size(terms, 2) + 1])
    end do
    if (size(terms, 2) == 0) then
      call report_error(reader, line, '*VISCOELASTIC needs a data line for each term: g, k, tau.')
    else if (sum(terms(1, :)) >= 1 .or. sum(terms(2, :)) >= 1) then
      call report_error(reader, line, 'The sum of g and the sum of k must each be less than 1, so that some stiffness lasts.')
    else
      material%prony = terms
    end if
  end subroutine read_viscoelastic


  !> The constants at once, from those after a long time, unless MODULI=INSTANTANEOUS; refuses what does not go together.
  subroutine complete_viscoelastic(reader, line, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    type(material_type), intent(inout) :: material
    character(:), allocatable :: who
    integer :: i
    if (.not. allocated(material%prony)) return
    who = 'The material ''' // material%name // ''' '
    if (.not. (material%elastic_kind == ELASTIC_ISOTROPIC .or. material%elastic_kind == ELASTIC_HYPER) .or. material%is_user .or. &
      material%is_corotational .or. material%has_deformation_plasticity) then
      call report_error(reader, line, who // 'has *VISCOELASTIC with an elasticity other than isotropic *ELASTIC or ' // &
        '*HYPERELASTIC, which is not supported.')
    else if (allocated(material%isotropic_hardening) .or. allocated(material%kinematic_hardening) .or. material%creep_law /= &
      CREEP_NONE .or. material%inelastic_law /= INELASTIC_NONE .or. allocated(material%cone%value)) then
      call report_error(reader, line, who // 'has *VISCOELASTIC beside plasticity or creep, which is not supported; give one.')
    else if (material%is_user_field) then
      call report_error(reader, line, who // 'has *VISCOELASTIC beside *USER DEFINED FIELD, which is not supported.')
    else if (allocated(material%elastic%value)) then
      if (.not. is_long_term(reader, line)) return
      do i = 1, size(material%elastic%value, 2)
        call stiffen(material, 1 - sum(material%prony(1, :)), 1 - sum(material%prony(2, :)), material%elastic%value(:, i))
      end do
      if (material%elastic_kind == ELASTIC_HYPER) return
      material%youngs_modulus = material%elastic%value(1, 1)
      material%poissons_ratio = material%elastic%value(2, 1)
    end if
  end subroutine complete_viscoelastic


  !> Refuses steps in which viscoelastic materials would not relax as the card says.
  subroutine check_viscoelastic_steps(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: c, m, i
    logical :: is_relaxing, has_hourglass
    is_relaxing = .false.
    has_hourglass = .false.
    do m = 1, size(model%materials)
      if (.not. allocated(model%materials(m)%prony)) cycle
      is_relaxing = is_relaxing .or. any(model%mesh%material == m)
      has_hourglass = has_hourglass .or. any(model%mesh%material == m .and. [(any(model%mesh%kind(i) == [KIND_C3D8R, &
        KIND_CPS4R, KIND_CPE4R, KIND_CAX4R]), i=1, size(model%mesh%kind))])
    end do
    if (.not. is_relaxing) return
    do c = 1, reader%cards%n_cards
      if (has_hourglass .and. is_card(reader, c, 'STEP')) then
        associate (step => model%steps(reader%step_of_card(c)))
          if (step%has_creep .or. step%is_long_term) call report_error(reader, reader%cards%cards(c)%line, '*VISCOELASTIC ' // &
            'materials relax in this step, and the hourglass stiffness of C3D8R, CPS4R, CPE4R and CAX4R does not: bending ' // &
            'would be too stiff. Give them C3D8I, C3D20R, CPS4I, CPE4I, CAX4I or CPS8R, CPE8R, CAX8R.')
        end associate
      end if
      if (is_card(reader, c, 'DYNAMIC')) call report_error(reader, reader%cards%cards(c)%line, 'A *DYNAMIC step cannot have ' // &
        '*VISCOELASTIC materials: they relax in *VISCO steps alone. Give *VISCO for slow loads.')
      if (.not. is_card(reader, c, 'VISCO')) cycle
      call open_card(reader, c, parameters, row)
      if (has_parameter(parameters, 'LONG TERM')) call report_error(reader, reader%cards%cards(c)%line, 'LONG TERM is of ' // &
        '*STATIC; in *VISCO materials relax with the time. Leave it out, or give *STATIC, LONG TERM.')
    end do
  end subroutine check_viscoelastic_steps


  !> Whether the constants of a material are those after a long time: MODULI of its ELASTIC or HYPERELASTIC.
  logical function is_long_term(reader, line)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: c
    logical :: is_inside
    is_long_term = .true.
    is_inside = .false.
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'MATERIAL')) is_inside = reader%cards%cards(c)%line == line
      if (.not. is_inside) cycle
      if (.not. (is_card(reader, c, 'ELASTIC') .or. is_card(reader, c, 'HYPERELASTIC'))) cycle
      call open_card(reader, c, parameters, row)
      is_long_term = parameter_word(parameters, 'MODULI', 'LONGTERM') /= 'INSTANTANEOUS'
    end do
  end function is_long_term


  !> Constants of a shear modulus divided by its long-term part, and a bulk modulus divided by its own.
  pure subroutine stiffen(material, shear, bulk, constants)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: shear, bulk          !< what lasts [-]
    real(DP), intent(inout) :: constants(:)
    real(DP) :: G, K
    integer :: first
    if (material%elastic_kind == ELASTIC_ISOTROPIC) then
      G = constants(1) / (2 * (1 + constants(2))) / shear
      K = constants(1) / (3 * (1 - 2 * constants(2))) / bulk
      constants(:2) = [9 * K * G / (3 * K + G), (3 * K - 2 * G) / (6 * K + 2 * G)]
      return
    end if
    select case (material%hyper_kind)
    case (HYPER_OGDEN)
      first = 2 * material%hyper_order + 1
      constants(1:first - 1:2) = constants(1:first - 1:2) / shear
    case (HYPER_ARRUDA_BOYCE)
      first = 3
      constants(1) = constants(1) / shear
    case default
      first = material%hyper_order * (material%hyper_order + 3) / 2 + 1
      constants(:first - 1) = constants(:first - 1) / shear
    end select
    constants(first:) = constants(first:) * bulk
  end subroutine stiffen

end module amontons_deck_viscoelasticity
