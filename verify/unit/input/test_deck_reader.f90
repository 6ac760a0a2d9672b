!> Unit test of deck_reader: fields with defaults and their messages, nodes and elements by number or set, amplitudes, names.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_reader
  use amontons_kinds, only: DP, NAME_LENGTH
  use amontons_cards, only: data_row_type, parameter_type, open_cards_text, next_row
  use amontons_card_schema, only: find_entry, parameter_word, has_parameter
  use amontons_card_table, only: make_card_table
  use amontons_deck_reader, only: reader_type, open_card, report_note, read_real, read_integer, check_n_fields, check_no_data, &
    read_user_constants, nodes_of_field, elements_of_field, find_amplitude, check_name, is_card
  use amontons_mesh, only: mesh_type, set_type
  use amontons_model, only: DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  type(suite_type) :: suite
  call check_fields()
  call check_constants()
  call check_nodes()
  call check_elements()
  call check_amplitudes()
  call check_names()
  call suite%finish()

contains

  !> A reader at the first row of the first card; lines end with a semicolon.
  subroutine start(text, reader, parameters, row)
    character(*), intent(in) :: text
    type(reader_type), intent(out) :: reader
    type(parameter_type), allocatable, intent(out) :: parameters(:)
    type(data_row_type), intent(out) :: row
    integer :: i
    logical :: is_short
    call open_cards_text(deck_lines(text), 'deck', reader%cards, reader%messages)
    call make_card_table(reader%table)
    do i = 1, reader%cards%n_cards
      call find_entry(reader%table, reader%cards%cards(i)%key, reader%cards%cards(i)%entry, is_short)
    end do
    call open_card(reader, 1, parameters, row)
  end subroutine start


  !> The last message holds a piece of text; n messages in all.
  subroutine expect(reader, n, piece)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: n
    character(*), intent(in) :: piece
    character(:), allocatable :: text
    logical :: is_warning
    integer :: line
    text = 'none'
    if (reader%messages%n > 0) call reader%messages%get(reader%messages%n, line, is_warning, text)
    call suite%that('messages: ' // text, reader%messages%n == n .and. index(text, piece) > 0)
  end subroutine expect


  !> Reals and integers: there, missing, by default, and what is none.
  subroutine check_fields()
    type(reader_type) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP) :: value
    integer :: whole
    logical :: is_ok
    call start('*NODE, SYST=C;1,2.5,,1 2,nan,x,3.5,,9;', reader, parameters, row)
    call suite%that('abbreviations are expanded', parameter_word(parameters, 'SYSTEM', 'R') == 'C')
    call suite%that('keyword', is_card(reader, 1, 'NODE') .and. .not. is_card(reader, 1, 'NSET'))
    call suite%that('row', next_row(reader%cards, row))
    is_ok = .true.
    call read_integer(reader, row, 1, 'label', whole, is_ok)
    call read_real(reader, row, 2, 'x', value, is_ok, 7.0_DP)
    call suite%that('values', whole == 1 .and. abs(value - 2.5_DP) <= 0 .and. is_ok)
    call read_real(reader, row, 3, 'y', value, is_ok, 7.0_DP)
    call read_integer(reader, row, 3, 'y', whole, is_ok, 8)
    call suite%that('defaults', abs(value - 7.0_DP) <= 0 .and. whole == 8 .and. is_ok .and. reader%messages%n == 0)
    call read_real(reader, row, 3, 'y', value, is_ok)
    call suite%that('a missing real', .not. is_ok)
    call expect(reader, 1, 'Field 3 (y) is missing; it must be a real number.')
    call read_real(reader, row, 4, 'z', value, is_ok, 1.0_DP)
    call expect(reader, 2, '''1 2''; it must be a real number; a comma parts two numbers')
    call read_real(reader, row, 5, 'z', value, is_ok)
    call expect(reader, 3, 'is nan; it must be a finite number')
    is_ok = .true.
    call read_integer(reader, row, 6, 'n', whole, is_ok, 1)
    call suite%that('a word is no integer, whatever the default', .not. is_ok)
    call expect(reader, 4, 'Field 6 (n) is ''x''; it must be an integer.')
    call read_integer(reader, row, 7, 'n', whole, is_ok)
    call expect(reader, 5, '''3.5''; it must be an integer')
    call read_integer(reader, row, 8, 'n', whole, is_ok)
    call expect(reader, 6, 'Field 8 (n) is missing; it must be an integer.')
    call check_n_fields(reader, row, 9)
    call suite%that('nine are nine', reader%messages%n == 6)
    call check_n_fields(reader, row, 8)
    call expect(reader, 7, 'This line has 9 values; at most 8')
    call check_no_data(reader, row)
    call expect(reader, 8, 'takes no data here')
    call report_note(reader, 0, 'A note.')
    call suite%that('a note is no error', reader%messages%n == 9 .and. reader%messages%n_errors == 8)
  end subroutine check_fields


  !> Constants in lines of eight: all, with blanks, too few, too many.
  subroutine check_constants()
    type(reader_type) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP) :: ten(10), two(2)
    ten = 0
    call start('*USER MATERIAL, CONSTANTS=10;1,2,3,4,5,,7,8;9,10;', reader, parameters, row)
    call read_user_constants(reader, 1, row, 'CONSTANTS', ten)
    call suite%near('ten constants, one blank', maxval(abs(ten - real([1, 2, 3, 4, 5, 0, 7, 8, 9, 10], DP))), 0.0_DP, 0.0_DP)
    call suite%that('no message', reader%messages%n == 0)
    ten = 0
    call start('*USER MATERIAL, CONSTANTS=10;1,2,3,4,5,6,7,8;', reader, parameters, row)
    call read_user_constants(reader, 1, row, 'CONSTANTS', ten)
    call expect(reader, 1, 'CONSTANTS is 10, but the data lines hold only 8')
    two = 0
    call start('*USER MATERIAL, CONSTANTS=2;1,2,3;', reader, parameters, row)
    call read_user_constants(reader, 1, row, 'CONSTANTS', two)
    call expect(reader, 1, 'at most 2')
    call check_temperature()
  end subroutine check_constants


  !> Constants of CalculiX, which a temperature may follow: in the line or in the next one. Of a second set the first line counts.
  subroutine check_temperature()
    type(reader_type) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP) :: two(2), eight(8)
    two = 0
    call start('*USER MATERIAL, CONSTANTS=2;1,2,293.;', reader, parameters, row)
    reader%dialect = DIALECT_CALCULIX
    call read_user_constants(reader, 1, row, 'CONSTANTS', two)
    call suite%near('constants before a temperature', norm2(two - real([1, 2], DP)), 0.0_DP, 0.0_DP)
    eight = 0
    call start('*USER MATERIAL, CONSTANTS=8;1,2,3,4,5,6,7,8;293.;', reader, parameters, row)
    reader%dialect = DIALECT_CALCULIX
    call read_user_constants(reader, 1, row, 'CONSTANTS', eight)
    call suite%near('the temperature in a line of its own', norm2(eight - real([1, 2, 3, 4, 5, 6, 7, 8], DP)), 0.0_DP, 0.0_DP)
    call suite%that('no message', reader%messages%n == 0)
    call start('*USER MATERIAL, CONSTANTS=2;1,2,293.;3,4,393.;', reader, parameters, row)
    reader%dialect = DIALECT_CALCULIX
    call read_user_constants(reader, 1, row, 'CONSTANTS', two)
    call expect(reader, 1, 'give one set of 2')
    call start('*USER MATERIAL, CONSTANTS=2;1,2,293.,4;', reader, parameters, row)
    reader%dialect = DIALECT_CALCULIX
    call read_user_constants(reader, 1, row, 'CONSTANTS', two)
    call expect(reader, 1, 'at most 3')
    call start('*SURFACE INTERACTION, PROPERTIES=2;1,2,3;', reader, parameters, row)
    reader%dialect = DIALECT_CALCULIX
    call read_user_constants(reader, 1, row, 'PROPERTIES', two)
    call expect(reader, 1, 'at most 2')
  end subroutine check_temperature


  !> By number or set; unknown, empty, and a near name.
  subroutine check_nodes()
    type(reader_type) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    type(mesh_type) :: mesh
    integer, allocatable :: nodes(:)
    integer :: k
    logical :: is_ok, is_new
    call start('*BOUNDARY;20,top,21,tip,,;', reader, parameters, row)
    call reader%node_labels%build([10, 20, 30])
    call reader%node_sets%add('Top', k, is_new)
    mesh%node_sets = [set_type('Top', [3, 1])]
    is_ok = next_row(reader%cards, row)
    call nodes_of_field(reader, mesh, row, 1, nodes, is_ok)
    call suite%that('by number', is_ok .and. size(nodes) == 1 .and. nodes(1) == 2)
    call nodes_of_field(reader, mesh, row, 2, nodes, is_ok)
    call suite%that('by set, in its order', is_ok .and. size(nodes) == 2 .and. all(nodes == [3, 1]))
    call nodes_of_field(reader, mesh, row, 3, nodes, is_ok)
    call suite%that('unknown number', .not. is_ok .and. size(nodes) == 0)
    call expect(reader, 1, 'no node or node set ''21''')
    call nodes_of_field(reader, mesh, row, 4, nodes, is_ok)
    call expect(reader, 2, 'did you mean TOP?')
    call nodes_of_field(reader, mesh, row, 5, nodes, is_ok)
    call expect(reader, 3, 'Field 5 must name a node or a node set; it is empty.')
  end subroutine check_nodes


  !> The same of elements; sets with elements that were dropped, and such elements.
  subroutine check_elements()
    type(reader_type) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    type(mesh_type) :: mesh
    integer, allocatable :: elements(:)
    integer :: k
    logical :: is_ok, is_new
    call start('*DLOAD;5,bulk,mixed,6,7,,8;', reader, parameters, row)
    call reader%element_labels%build([5])
    call reader%draft_element_labels%build([5, 6])
    call reader%element_sets%add('bulk', k, is_new)
    call reader%element_sets%add('mixed', k, is_new)
    reader%has_omitted_elements = [.false., .true.]
    mesh%element_sets = [set_type('bulk', [1]), set_type('mixed', [1])]
    is_ok = next_row(reader%cards, row)
    call elements_of_field(reader, mesh, row, 1, elements, is_ok)
    call suite%that('by number', is_ok .and. size(elements) == 1 .and. reader%messages%n == 0)
    call elements_of_field(reader, mesh, row, 2, elements, is_ok)
    call suite%that('by set', is_ok .and. size(elements) == 1 .and. reader%messages%n == 0)
    call elements_of_field(reader, mesh, row, 3, elements, is_ok)
    call suite%that('a set with others', .not. is_ok)
    call expect(reader, 1, 'holds elements that are no solids')
    call elements_of_field(reader, mesh, row, 4, elements, is_ok)
    call expect(reader, 2, 'The element 6 is no solid')
    call elements_of_field(reader, mesh, row, 5, elements, is_ok)
    call expect(reader, 3, 'no element or element set ''7''')
    call elements_of_field(reader, mesh, row, 6, elements, is_ok)
    call expect(reader, 4, 'it is empty')
    reader%has_unsupported_kinds = .true.
    call elements_of_field(reader, mesh, row, 4, elements, is_ok)
    call elements_of_field(reader, mesh, row, 3, elements, is_ok)
    call suite%that('the cause was reported before', reader%messages%n == 4 .and. .not. is_ok)
  end subroutine check_elements


  !> By name; a copy with a delay counts before.
  subroutine check_amplitudes()
    type(reader_type) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: a, k
    logical :: is_new
    call start('*CLOAD, AMPLITUDE=ramp;*CLOAD, AMPLITUDE=none;*CLOAD;', reader, parameters, row)
    call reader%amplitudes%add('first', k, is_new)
    call reader%amplitudes%add('RAMP', k, is_new)
    call find_amplitude(reader, 1, parameters, a)
    call suite%that('second of the list', a == 2)
    reader%delayed_amplitude = [5, 0, 0]
    call find_amplitude(reader, 1, parameters, a)
    call suite%that('its delayed copy', a == 5)
    call open_card(reader, 2, parameters, row)
    call find_amplitude(reader, 2, parameters, a)
    call suite%that('unknown', a == 0)
    call expect(reader, 1, 'no amplitude ''none''')
    call open_card(reader, 3, parameters, row)
    call find_amplitude(reader, 3, parameters, a)
    call suite%that('none named', a == 0 .and. reader%messages%n == 1 .and. .not. has_parameter(parameters, 'AMPLITUDE'))
  end subroutine check_amplitudes


  !> Names of the greatest length, alone and of an instance.
  subroutine check_names()
    type(reader_type) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    character(*), parameter :: LONG = repeat('x', NAME_LENGTH)
    call start('*NSET, NSET=A;1;', reader, parameters, row)
    call check_name(reader, 1, LONG)
    call check_name(reader, 1, LONG // '.' // LONG)
    call suite%that('both may be so long', reader%messages%n == 0)
    call check_name(reader, 1, LONG // 'x')
    call expect(reader, 1, 'has more than')
    call check_name(reader, 1, 'A.' // LONG // 'x')
    call suite%that('the name in an instance', reader%messages%n == 2)
    call check_name(reader, 1, LONG // 'x.A')
    call suite%that('the name of the instance', reader%messages%n == 3)
  end subroutine check_names

end program test_deck_reader
