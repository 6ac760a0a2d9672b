!> Warnings of slips that a deck survives: decimal commas, keywords without a star, sets without members.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_traps
  use amontons_cards, only: data_row_type, parameter_type, next_row, field_text
  use amontons_card_schema, only: find_entry, parameter_text, ENTRY_SUPPORTED
  use amontons_deck_reader, only: reader_type, open_card, report_note, has_decimal_comma, DECIMAL_COMMA_TEXT
  use amontons_mesh, only: mesh_type
  use amontons_text, only: name_key, is_one_of
  implicit none
  private
  public :: report_traps

  character(*), parameter :: BULK_CARDS = 'NODE|ELEMENT'      !< many lines, each of which begins with a number
  character(*), parameter :: REAL_CARDS = 'ELASTIC|DENSITY|EXPANSION|PLASTIC|CREEP|FRICTION|SURFACEBEHAVIOR|STATIC|VISCO|' // &
    'AMPLITUDE|HYPERELASTIC|HYPERFOAM|SOLIDSECTION'
  character(*), parameter :: CONSTANT_CARDS = 'DENSITY|EXPANSION|FRICTION'     !< one number, then those it depends on
  character(*), parameter :: WORD_CARDS = 'HEADING|MPC'       !< their data may begin with a keyword
  character(*), parameter :: WORDS = 'DENSITY'                !< keywords that are also variables of OUTPUT cards

contains

  !> Reports the slips of all cards. All names must be read.
  subroutine report_traps(reader, mesh)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    character(:), allocatable :: key
    integer :: c
    do c = 1, reader%cards%n_cards
      if (reader%cards%cards(c)%entry == 0) cycle
      associate (entry => reader%table%entries(reader%cards%cards(c)%entry))
        if (entry%status /= ENTRY_SUPPORTED) cycle
        key = entry%key
      end associate
      call open_card(reader, c, parameters, row)
      if (.not. is_one_of(key, 'NODE|ELEMENT|NSET|ELSET')) call report_empty_sets(reader, mesh, c, parameters)
      if (is_one_of(key, BULK_CARDS) .and. reader%messages%n_errors == 0 .or. is_one_of(key, WORD_CARDS)) cycle
      do while (next_row(reader%cards, row))
        if (is_one_of(key, REAL_CARDS)) call report_decimal_commas(reader, row, is_one_of(key, CONSTANT_CARDS))
        call report_missing_star(reader, row, c)
      end do
    end do
  end subroutine report_traps


  !> Reports a line whose commas look like decimal commas.
  subroutine report_decimal_commas(reader, row, is_constant)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    logical, intent(in) :: is_constant           !< a line of two integers is one number with a decimal comma
    logical :: is_suspect
    is_suspect = has_decimal_comma(reader%cards, row, is_mixed=.true.)
    if (.not. is_suspect .and. is_constant .and. row%n == 2) is_suspect = has_decimal_comma(reader%cards, row, is_mixed=.false.)
    if (is_suspect) call report_note(reader, row%line, DECIMAL_COMMA_TEXT)
  end subroutine report_decimal_commas


  !> Reports a data line that begins with a keyword, which is no name of the deck.
  subroutine report_missing_star(reader, row, c)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: c                     !< card of the line
    character(:), allocatable :: key
    integer :: position
    logical :: is_abbreviated
    if (row%n == 0) return
    key = name_key(field_text(reader%cards, row, 1))
    if (scan(key // ' ', 'ABCDEFGHIJKLMNOPQRSTUVWXYZ') /= 1 .or. is_one_of(key, WORDS)) return
    call find_entry(reader%table, key, position, is_abbreviated)
    if (position == 0 .or. is_abbreviated) return
    if (reader%node_sets%find(key) + reader%element_sets%find(key) + reader%surfaces%find(key) > 0) return
    call report_note(reader, row%line, 'This line begins with the keyword ' // reader%table%entries(position)%keyword // &
      ' without its star; it counts as data of *' // reader%table%entries(reader%cards%cards(c)%entry)%keyword // '.')
  end subroutine report_missing_star


  !> Reports sets without members that a card names by NSET or ELSET.
  subroutine report_empty_sets(reader, mesh, c, parameters)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    character(:), allocatable :: name
    integer :: s
    name = parameter_text(parameters, 'NSET')
    s = reader%node_sets%find(name)
    if (s > 0) then
      if (size(mesh%node_sets(s)%members) == 0) call report_note(reader, reader%cards%cards(c)%line, 'The node set ''' // name // &
        ''' has no members.')
    end if
    name = parameter_text(parameters, 'ELSET')
    s = reader%element_sets%find(name)
    if (s > 0) then
      if (size(mesh%element_sets(s)%members) == 0 .and. .not. reader%has_omitted_elements(s)) call report_note(reader, &
        reader%cards%cards(c)%line, 'The element set ''' // name // ''' has no members.')
    end if
  end subroutine report_empty_sets

end module amontons_deck_traps
