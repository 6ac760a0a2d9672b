!> State and field readers shared by all card readers.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_reader
  use amontons_kinds, only: DP, NAME_LENGTH
  use amontons_cards, only: cards_type, data_row_type, parameter_type, deck_messages_type, read_parameters, field_integer, &
    field_real, field_text, start_rows, next_row
  use amontons_card_schema, only: card_table_type, has_parameter, match_parameters, parameter_text
  use amontons_containers, only: name_table_type, label_table_type, integer_list_type
  use amontons_mesh, only: mesh_type
  use amontons_model, only: DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_text, only: to_text, name_key, parse_real, plural, NUMBER_OK, NUMBER_EMPTY, NUMBER_NOT_FINITE
  implicit none
  private
  public :: reader_type, time_list_type, open_card, report_error, report_note, read_real, read_integer, read_tolerance, &
    check_n_fields, check_no_data
  public :: has_decimal_comma, DECIMAL_COMMA_TEXT, VALUES_PER_LINE
  public :: support_dofs, read_user_constants, nodes_of_field, elements_of_field, find_amplitude, check_name, is_card, &
    count_cards

  character(*), parameter :: DECIMAL_COMMA_TEXT = 'This looks like decimal commas: a comma parts two numbers, and a point is ' // &
    'the decimal mark (0.3). If the numbers are meant as they are, put blanks after all commas.'

  integer, parameter :: VALUES_PER_LINE = 8    !< values of a data line

  !> The times of a TIME POINTS card.
  type :: time_list_type
    logical :: is_total_time = .false.           !< TIME=TOTAL TIME
    real(DP), allocatable :: times(:)            !< ascending [time]
  end type time_list_type

  !> The state of reading one deck.
  type :: reader_type
    type(cards_type) :: cards
    type(card_table_type) :: table
    type(deck_messages_type) :: messages
    integer :: dialect = DIALECT_ABAQUS          !< DIALECT_ABAQUS or DIALECT_CALCULIX
    integer :: truncated_step = 0                      !< a step ended early by a restart; 0: none
    real(DP) :: truncated_time = 0                     !< at its end [step time]
    integer, allocatable :: delayed_amplitude(:) !< (n_cards) amplitude of a card with TIME DELAY, 0
    integer, allocatable :: step_of_card(:)      !< (n_cards) step of a card; 0: the model
    type(name_table_type) :: node_sets, element_sets, surfaces, materials, interactions, amplitudes, time_names
    type(time_list_type), allocatable :: time_lists(:)
    type(label_table_type) :: node_labels, element_labels
    type(label_table_type) :: draft_element_labels       !< all elements of the deck, also those that are no solids
    integer, allocatable :: submodel_of(:)       !< (n_nodes) SUBMODEL card of a node, 0: none; unallocated: there are none
    logical :: has_bad_submodels = .false.       !< errors in the nodes of SUBMODEL cards were reported; consequences are not
    logical, allocatable :: node_set_repeats(:)      !< (node sets) the deck names a member more than once
    logical, allocatable :: element_set_repeats(:)   !< (element sets) the same
    logical, allocatable :: has_omitted_elements(:)     !< (element sets) it contains dropped elements that are not solids
    integer, allocatable :: omitted_first(:)        !< (n + 1) start of each dropped element, in omitted_nodes
    integer, allocatable :: omitted_nodes(:)
    integer, allocatable :: omitted_of_draft(:)     !< (elements of the deck) number among the dropped, 0
    type(integer_list_type), allocatable :: omitted_of_set(:)   !< (element sets) their dropped members
    logical :: has_decimal_commas = .false.          !< nodes whose commas look like decimal commas were reported
    integer, allocatable :: bad_user_kinds(:)    !< numbers of the types whose USER ELEMENT card has errors; 0: one without a number
    logical :: has_unsupported_kinds = .false.       !< unsupported element kinds were reported; consequences are not
  end type reader_type

contains

  !> Reads the parameters of a card (names complete; errors were reported by the check of the cards) and sets
  !! the cursor before its data.
  subroutine open_card(reader, c, parameters, row)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), allocatable, intent(out) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    call read_parameters(reader%cards, reader%cards%cards(c), parameters)
    associate (card => reader%cards%cards(c))
      call match_parameters(reader%table%entries(card%entry), parameters, card%line, .true.)
      call start_rows(card, row)
    end associate
  end subroutine open_card


  !> Whether a card has this keyword.
  pure function is_card(reader, c, key) result(is_so)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: key              !< squeezed keyword
    logical :: is_so
    is_so = .false.
    if (reader%cards%cards(c)%entry > 0) is_so = reader%table%entries(reader%cards%cards(c)%entry)%key == key
  end function is_card


  !> The number of cards of a keyword.
  pure integer function count_cards(reader, key)
    type(reader_type), intent(in) :: reader
    character(*), intent(in) :: key              !< squeezed keyword
    integer :: c
    count_cards = 0
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, key)) count_cards = count_cards + 1
    end do
  end function count_cards


  !> Reports an error.
  subroutine report_error(reader, line, text)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< line of the deck; 0: none
    character(*), intent(in) :: text
    call reader%messages%add(line, text)
  end subroutine report_error


  !> Reports a note.
  subroutine report_note(reader, line, text)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< line of the deck; 0: none
    character(*), intent(in) :: text
    call reader%messages%add(line, text, is_warning=.true.)
  end subroutine report_note


  !> Reads a real field or reports an error.
  subroutine read_real(reader, row, i, what, value, is_ok, default)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i                     !< field
    character(*), intent(in) :: what             !< its name in messages
    real(DP), intent(out) :: value
    logical, intent(inout) :: is_ok              !< set to .false. on trouble, else untouched
    real(DP), intent(in), optional :: default    !< value of an empty field; without it the field must be there
    integer :: status
    call field_real(reader%cards, row, i, value, status)
    if (status == NUMBER_OK) return
    if (status == NUMBER_EMPTY .and. present(default)) then
      value = default
      return
    end if
    is_ok = .false.
    if (status == NUMBER_EMPTY) then
      call report_error(reader, row%line, 'Field ' // to_text(i) // ' (' // what // &
        ') is missing; it must be a real number.')
    else if (status == NUMBER_NOT_FINITE) then
      call report_error(reader, row%line, 'Field ' // to_text(i) // ' (' // what // ') is ' // &
        field_text(reader%cards, row, i) // '; it must be a finite number.')
    else
      call report_error(reader, row%line, 'Field ' // to_text(i) // ' (' // what // ') is ''' // &
        field_text(reader%cards, row, i) // '''; it must be a real number' // suggest_commas(field_text(reader%cards, row, i)))
    end if
  end subroutine read_real


  !> The number format, for a field with more than one value.
  pure function suggest_commas(field) result(hint)
    character(*), intent(in) :: field
    character(:), allocatable :: hint
    hint = '.'
    if (index(trim(adjustl(field)), ' ') > 0) hint = '; a comma parts two numbers, and a point is the decimal mark.'
  end function suggest_commas


  !> Reads an integer field or reports an error.
  subroutine read_integer(reader, row, i, what, value, is_ok, default)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i                     !< field
    character(*), intent(in) :: what             !< its name in messages
    integer, intent(out) :: value
    logical, intent(inout) :: is_ok              !< set to .false. on trouble, else untouched
    integer, intent(in), optional :: default     !< value of an empty field; without it the field must be there
    integer :: status
    call field_integer(reader%cards, row, i, value, status)
    if (status == NUMBER_OK) return
    if (status == NUMBER_EMPTY .and. present(default)) then
      value = default
      return
    end if
    is_ok = .false.
    if (status == NUMBER_EMPTY) then
      call report_error(reader, row%line, 'Field ' // to_text(i) // ' (' // what // ') is missing; it must be an integer.')
    else
      call report_error(reader, row%line, 'Field ' // to_text(i) // ' (' // what // ') is ''' // &
        field_text(reader%cards, row, i) // '''; it must be an integer.')
    end if
  end subroutine read_integer


  !> A parameter that is a tolerance; reports a negative one.
  subroutine read_tolerance(reader, c, parameters, name, value)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name
    real(DP), intent(inout) :: value             !< unchanged if the card does not give it
    real(DP) :: given
    integer :: status
    if (.not. has_parameter(parameters, name)) return
    call parse_real(parameter_text(parameters, name), given, status)
    if (status /= NUMBER_OK) return              ! the check of the cards reports it
    if (given < 0) call report_error(reader, reader%cards%cards(c)%line, name // ' must not be negative: it is 0 or more.')
    value = max(0.0_DP, given)
  end subroutine read_tolerance


  !> The constants of a user routine, in lines of eight; reports too few and too many. In CalculiX's form the temperature of the
  !! constants of UMAT may follow them; other constants at another temperature are refused.
  subroutine read_user_constants(reader, c, row, count_name, constants)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row         !< before its data lines
    character(*), intent(in) :: count_name       !< parameter with their number, for messages
    real(DP), intent(inout) :: constants(:)      !< zero on input, for blank fields
    real(DP), allocatable :: values(:)           !< and the temperature
    integer :: n, i, k
    logical :: is_ok
    n = size(constants)
    values = [constants, 0.0_DP]
    if (reader%dialect /= DIALECT_CALCULIX .or. count_name /= 'CONSTANTS') values = constants
    i = 0
    is_ok = .true.
    do while (next_row(reader%cards, row) .and. is_ok)
      if (i >= n .and. n < size(values) .and. row%n > size(values) - i) then
        call report_error(reader, row%line, 'The constants of UMAT depend on nothing here: give one set of ' // to_text(n) // &
          ', and what depends on the temperature to the routine, which is given TEMP.')
        exit
      end if
      call check_n_fields(reader, row, min(VALUES_PER_LINE, size(values) - i))
      do k = 1, min(VALUES_PER_LINE, size(values) - i)
        call read_real(reader, row, k, 'constant', values(i + k), is_ok, 0.0_DP)
      end do
      i = i + min(VALUES_PER_LINE, size(values) - i)
    end do
    constants = values(:n)
    if (i < n .and. is_ok) call report_error(reader, reader%cards%cards(c)%line, count_name // ' is ' // to_text(n) // &
      ', but the data lines hold only ' // to_text(i) // ', eight in each.')
  end subroutine read_user_constants


  !> Reports fields beyond the last one that is read.
  subroutine check_n_fields(reader, row, n)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: n                     !< fields that are read
    character(:), allocatable :: hint
    if (row%n <= n) return
    hint = '.'
    if (has_decimal_comma(reader%cards, row, is_mixed=.false.)) hint = '; a comma parts two numbers, and a point is the decimal ' &
      // 'mark.'
    call report_error(reader, row%line, 'This line has ' // plural(row%n, 'value') // '; at most ' // to_text(n) // &
      ' are allowed here' // hint)
  end subroutine check_n_fields


  !> Whether two fields of a row look like one number with a decimal comma: digits, a comma and digits without a blank.
  pure logical function has_decimal_comma(cards, row, is_mixed) result(has_one)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    logical, intent(in) :: is_mixed              !< only if a blank follows another comma of the row, or it ends with one
    integer :: i
    logical :: has_blank
    has_blank = .not. is_mixed
    has_one = .false.
    do i = 1, row%n - 1
      if (row%first(i) > row%last(i) .or. row%first(i + 1) > row%last(i + 1)) cycle
      if (row%first(i + 1) > row%last(i) + 2) then
        has_blank = .true.
        cycle
      end if
      associate (left => cards%text(row%first(i):row%last(i)), right => cards%text(row%first(i + 1):row%last(i + 1)))
        if (verify(left, '+-0123456789') > 0 .or. verify(right, '0123456789eEdD+-') > 0) cycle
        has_one = has_one .or. scan(right(1:1), '0123456789') == 1
      end associate
    end do
    has_one = has_one .and. has_blank
  end function has_decimal_comma


  !> Reports data lines of a card that takes none.
  subroutine check_no_data(reader, row)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row            !< a row that should not be there
    call report_error(reader, row%line, 'The card above takes no data here; this line is not understood.')
  end subroutine check_no_data


  !> The node or the nodes of the node set named by a field; reports an unknown name.
  subroutine nodes_of_field(reader, mesh, row, i, nodes, is_ok)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i                     !< field
    integer, allocatable, intent(out) :: nodes(:)   !< indices; of size 0 on trouble
    logical, intent(inout) :: is_ok              !< set to .false. on trouble, else untouched
    integer :: label, status, found
    call field_integer(reader%cards, row, i, label, status)
    if (status == NUMBER_OK) then
      found = reader%node_labels%find(label)
      if (found > 0) nodes = [found]
    else if (status /= NUMBER_EMPTY) then
      found = reader%node_sets%find(field_text(reader%cards, row, i))
      if (found > 0) nodes = mesh%node_sets(found)%members
    end if
    if (allocated(nodes)) then
      if (size(nodes) == 0) call report_note(reader, row%line, 'The node set ''' // field_text(reader%cards, row, i) // &
        ''' has no members.')
      return
    end if
    allocate (nodes(0))
    is_ok = .false.
    if (status == NUMBER_EMPTY) then
      call report_error(reader, row%line, 'Field ' // to_text(i) // ' must name a node or a node set; it is empty.')
    else
      call report_error(reader, row%line, 'There is no node or node set ''' // field_text(reader%cards, row, i) // '''' // &
        reader%node_sets%suggest(field_text(reader%cards, row, i)))
    end if
  end subroutine nodes_of_field


  !> The element or the elements of the element set named by a field; reports an unknown name.
  subroutine elements_of_field(reader, mesh, row, i, elements, is_ok)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i                     !< field
    integer, allocatable, intent(out) :: elements(:)   !< indices; of size 0 on trouble
    logical, intent(inout) :: is_ok              !< set to .false. on trouble, else untouched
    integer :: label, status, found, i_layer
    found = 0
    call field_integer(reader%cards, row, i, label, status)
    if (status == NUMBER_OK) then
      found = reader%element_labels%find(label)
      if (found > 0) elements = found - 1 + [(i_layer, i_layer=1, n_layers_from(mesh, found))]
    else if (status /= NUMBER_EMPTY) then
      found = reader%element_sets%find(field_text(reader%cards, row, i))
      if (found > 0) elements = mesh%element_sets(found)%members
      if (found > 0) then
        if (reader%has_omitted_elements(found)) is_ok = .false.
        if (reader%has_omitted_elements(found) .and. .not. reader%has_unsupported_kinds) call report_error(reader, row%line, &
          'The element set ''' // field_text(reader%cards, row, i) // ''' holds elements that are no solids; name ' // &
          'solid elements only.')
      end if
    end if
    if (allocated(elements)) then
      if (size(elements) == 0 .and. is_ok) call report_note(reader, row%line, 'The element set ''' // &
        field_text(reader%cards, row, i) // ''' has no members.')
      return
    end if
    allocate (elements(0))
    is_ok = .false.
    if (status == NUMBER_EMPTY) then
      call report_error(reader, row%line, 'Field ' // to_text(i) // ' must name an element or an element set; it is empty.')
    else if (status == NUMBER_OK .and. reader%draft_element_labels%find(label) > 0) then
      if (.not. reader%has_unsupported_kinds) call report_error(reader, row%line, 'The element ' // to_text(label) // &
        ' is no solid; name solid elements only.')
    else
      call report_error(reader, row%line, 'There is no element or element set ''' // &
        field_text(reader%cards, row, i) // '''' // reader%element_sets%suggest(field_text(reader%cards, row, i)))
    end if
  end subroutine elements_of_field


  !> The number of layers of an element, which follow it.
  pure integer function n_layers_from(mesh, e) result(n)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                     !< the first layer
    n = 1
    if (.not. allocated(mesh%layer)) return
    do while (e + n <= mesh%n_elements)
      if (mesh%layer(e + n) /= n + mesh%layer(e)) exit
      n = n + 1
    end do
  end function n_layers_from


  !> The amplitude named by a card; 0: none named, or after an error.
  subroutine find_amplitude(reader, c, parameters, amplitude)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(out) :: amplitude
    character(:), allocatable :: name
    amplitude = 0
    name = parameter_text(parameters, 'AMPLITUDE')
    if (name == '') return
    amplitude = reader%amplitudes%find(name)
    if (amplitude == 0) call report_error(reader, reader%cards%cards(c)%line, 'There is no amplitude ''' // name // '''.')
    if (.not. allocated(reader%delayed_amplitude)) return
    if (reader%delayed_amplitude(c) > 0) amplitude = reader%delayed_amplitude(c)
  end subroutine find_amplitude


  !> Reports a name that is too long.
  subroutine check_name(reader, c, name)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: name
    character(:), allocatable :: key
    integer :: dot
    key = name_key(name)
    dot = index(key, '.')                        ! INSTANCE.NAME of a deck with parts: both may be so long
    if (max(dot - 1, len(key) - dot) > NAME_LENGTH) call report_error(reader, reader%cards%cards(c)%line, 'The name ''' // name &
      // ''' has more than ' // to_text(NAME_LENGTH) // ' characters.')
  end subroutine check_name


  !> The degrees of freedom that a word of BOUNDARY such as PINNED or XSYMM fixes; none: unknown word.
  pure function support_dofs(word) result(is_fixed)
    character(*), intent(in) :: word
    logical :: is_fixed(6)
    is_fixed = .false.
    select case (name_key(word))
    case ('ENCASTRE')
      is_fixed = .true.
    case ('PINNED')
      is_fixed(:3) = .true.
    case ('XSYMM')
      is_fixed([1, 5, 6]) = .true.
    case ('YSYMM')
      is_fixed([2, 4, 6]) = .true.
    case ('ZSYMM')
      is_fixed([3, 4, 5]) = .true.
    case ('XASYMM')
      is_fixed([2, 3, 4]) = .true.
    case ('YASYMM')
      is_fixed([1, 3, 5]) = .true.
    case ('ZASYMM')
      is_fixed([1, 2, 6]) = .true.
    case default                                   ! unknown: none
    end select
  end function support_dofs

end module amontons_deck_reader
