!> CREEP to the law of a material: constants, or the routine CREEP of the user.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_creep
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: parameter_word
  use amontons_deck_property_tables, only: read_table
  use amontons_deck_reader, only: reader_type, open_card, report_error
  use amontons_materials, only: material_type, ELASTIC_ISOTROPIC, CREEP_TIME_HARDENING, CREEP_STRAIN_HARDENING, CREEP_USER
  use amontons_text, only: to_text
  use amontons_user_routines, only: USER_NAME_LENGTH
  implicit none
  private
  public :: read_creep, check_user_creep

contains

  !> CREEP.
  subroutine read_creep(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    select case (parameter_word(parameters, 'LAW', 'TIME'))
    case ('USER')
      material%creep_law = CREEP_USER
      if (next_row(reader%cards, row)) call report_error(reader, row%line, 'LAW=USER has no data: the routine CREEP holds its ' // &
        'constants.')
      if (allocated(material%creep%value)) deallocate (material%creep%value, material%creep%temperature)
      return
    case ('STRAIN')
      material%creep_law = CREEP_STRAIN_HARDENING
    case default
      material%creep_law = CREEP_TIME_HARDENING
    end select
    call read_table(reader, c, 3, material%creep, is_ok)
    if (.not. is_ok) return
    if (any(material%creep%value(1, :) <= 0) .or. any(material%creep%value(2, :) <= 0) .or. &
      any(material%creep%value(3, :) <= -1) .or. any(material%creep%value(3, :) > 0)) call report_error(reader, &
      reader%cards%cards(c)%line, 'Creep needs A and n positive, and m above -1 and not above 0.')
  end subroutine read_creep


  !> Reports what the routine CREEP is not given, or does not go with.
  subroutine check_user_creep(reader, line, n_fields, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    integer, intent(in) :: n_fields              !< field variables of the deck
    type(material_type), intent(in) :: material
    character(:), allocatable :: who
    if (material%creep_law /= CREEP_USER) return
    who = 'The material ''' // material%name // ''' '
    if (material%elastic_kind /= ELASTIC_ISOTROPIC) call report_error(reader, line, who // 'has *CREEP, LAW=USER with an ' // &
      'elasticity that is not isotropic, which is not supported; give E and nu.')
    if (n_fields > 0 .or. material%is_user_field .or. material%n_statev > 0) call report_error(reader, line, who // &
      'has *CREEP, LAW=USER in a deck with field variables, or with *DEPVAR: the routine CREEP is given neither PREDEF nor STATEV.')
    if (len(material%name) > USER_NAME_LENGTH) call report_error(reader, line, who // 'has a name of more than ' // &
      to_text(USER_NAME_LENGTH) // ' letters, which user routines cannot be given.')
  end subroutine check_user_creep

end module amontons_deck_creep
