!> Unit test of cards, card_schema and card_table: text to cards, rows, fields, includes; the table and its error messages.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_cards
  use amontons_kinds, only: DP
  use amontons_card_schema, only: card_table_type, find_entry, match_parameters, has_parameter, parameter_text, &
    parameter_word, list_parameters
  use amontons_containers, only: name_table_type
  use amontons_card_table, only: make_card_table, list_cards
  use amontons_cards, only: cards_type, parameter_type, data_row_type, deck_messages_type, open_cards, open_cards_text, &
    publish_messages, read_parameters, start_rows, next_row, field_text, field_integer, field_real, is_empty_field, &
    line_text, has_open_keyword_line
  use amontons_errors, only: diagnostic_list_type, error_type, EXIT_IO
  use amontons_text, only: NEWLINE, NUMBER_OK, NUMBER_EMPTY, to_text
  use check, only: suite_type
  implicit none
  character(*), parameter :: NL = NEWLINE
  type(suite_type) :: suite
  call test_cutting(suite)
  call test_continuation(suite)
  call test_parameters(suite)
  call test_rows(suite)
  call test_wide_rows(suite)
  call test_line_ends(suite)
  call test_includes(suite)
  call test_include_trouble(suite)
  call test_table(suite)
  call test_matching(suite)
  call test_many_remarks(suite)
  call suite%finish()

contains

  !> Keywords without blanks, comments skipped; lines of stars from gmsh are comments.
  subroutine test_cutting(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    call open_cards_text('** comment' // NL // '  * N O D E , nset=A' // NL // '1,0,0,0' // NL // &
      '******* E L E M E N T S *************' // NL // NL // '2,1,0,0' // NL // '*End Step' // NL // '*', 'deck', &
      cards, messages)
    call suite%that('three cards', cards%n_cards == 3)
    call suite%that('keyword squeezed', cards%cards(1)%key == 'NODE' .and. cards%cards(2)%key == 'ENDSTEP')
    call suite%that('star alone', cards%cards(3)%key == '')
    call suite%that('card lines', cards%cards(1)%line == 2 .and. cards%cards(1)%data_first == 3 .and. &
      cards%cards(1)%data_last == 6)
    call suite%that('line as written', line_text(cards, 2) == '  * N O D E , nset=A' .and. line_text(cards, 0) == '')
    call open_cards_text('', 'deck', cards, messages)
    call suite%that('empty deck', cards%n_cards == 0 .and. cards%n_lines == 0)
  end subroutine test_cutting


  !> A trailing comma continues the keyword line, but not into numbers or the next card; where the parameters of the cards are
  !! known, not into a line without any of them.
  subroutine test_continuation(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(card_table_type) :: table
    type(name_table_type) :: names
    type(deck_messages_type) :: messages
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    call open_cards_text('*ELEMENT, TYPE=C3D8,' // NL // '** in between' // NL // ' ELSET=E1,' // NL // 'OTHER' // NL &
      // '1,2,3' // NL // '*NODE,' // NL // ' -1,2,3' // NL // '*STEP,' // NL // '*STATIC,', 'deck', cards, messages)
    call suite%that('continued card', cards%cards(1)%data_first == 5 .and. cards%cards(1)%data_last == 5)
    call read_parameters(cards, cards%cards(1), parameters)
    call suite%that('three parameters', size(parameters) == 3)
    call suite%that('the last of them', parameters(3)%key == 'OTHER' .and. .not. parameters(3)%has_value)
    call suite%that('a number is data', cards%cards(2)%data_first == 7)
    call suite%that('the next card is a card', cards%n_cards == 4 .and. cards%cards(3)%key == 'STEP')
    call make_card_table(table)
    call list_parameters(table, names)
    call open_cards_text('*BOUNDARY,' // NL // 'AB,1,1,0' // NL // '*BOUNDARY,' // NL // 'AB,' // NL // '*BOUNDARY,' // NL // &
      'OP=NEW' // NL // 'AB,1' // NL // '*STEP,' // NL // 'nlgeom , PERTURBATION,' // NL // 'INC=3' // NL // '*NSET,NSET=A,' // &
      NL // 'GENERATE' // NL // '1,2' // NL // '*STEP,' // NL // 'NLGEOM,AB' // NL // '*NO CARD,' // NL // 'AB', &
      'deck', cards, messages, names)
    call suite%that('data or continuation', all(cards%cards(:cards%n_cards)%data_first - cards%cards(:cards%n_cards)%line == &
      [1, 1, 2, 3, 2, 1, 2]))
    call suite%that('open keyword lines', all([(has_open_keyword_line(cards, cards%cards(i)), i=1, cards%n_cards)] .eqv. &
      [.true., .true., .false., .false., .false., .true., .false.]))
  end subroutine test_continuation


  !> Names without case and blanks, values as written, quotation marks protect commas.
  subroutine test_parameters(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(parameter_type), allocatable :: parameters(:)
    call open_cards_text('*Surface, n a m e = My Surf(2) ,, small Sliding, TITLE="a, b = c", EMPTY=', 'deck', cards, &
      messages)
    call read_parameters(cards, cards%cards(1), parameters)
    call suite%that('four parameters', size(parameters) == 4)
    call suite%that('value as written', parameters(1)%key == 'NAME' .and. parameters(1)%text == 'My Surf(2)')
    call suite%that('flag', parameters(2)%key == 'SMALLSLIDING' .and. .not. parameters(2)%has_value)
    call suite%that('quoted value', parameters(3)%text == 'a, b = c')
    call suite%that('empty value', parameters(4)%has_value .and. parameters(4)%text == '')
    call suite%that('has_parameter', has_parameter(parameters, 'SMALL SLIDING') .and. .not. has_parameter(parameters, &
      'X'))
    call suite%that('parameter_text', parameter_text(parameters, 'NAME') == 'My Surf(2)' .and. &
      parameter_text(parameters, 'X') == '')
    call suite%that('parameter_word', parameter_word(parameters, 'NAME', 'D') == 'MYSURF(2)' .and. &
      parameter_word(parameters, 'X', 'D') == 'D')
  end subroutine test_parameters


  !> Fields: blanks trimmed, empty ones in between, trailing commas, a row of commas.
  subroutine test_rows(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(data_row_type) :: row
    integer :: value, status
    real(DP) :: number
    call open_cards_text('*CARD' // NL // ' 1 , Set A ,, 2.5e0 , ' // NL // '** no row' // NL // NL // ',,' // NL // &
      '"quoted",7', 'deck', cards, messages)
    call start_rows(cards%cards(1), row)
    call suite%that('first row', next_row(cards, row))
    call suite%that('its fields', row%n == 4 .and. row%line == 2 .and. row%has_trailing_comma)
    call field_integer(cards, row, 1, value, status)
    call suite%that('an integer', value == 1 .and. status == NUMBER_OK)
    call suite%that('a name', field_text(cards, row, 2) == 'Set A')
    call suite%that('an empty field', is_empty_field(row, 3) .and. is_empty_field(row, 9) .and. &
      field_text(cards, row, 9) == '')
    call field_integer(cards, row, 3, value, status)
    call suite%that('an empty integer', status == NUMBER_EMPTY)
    call field_real(cards, row, 4, number, status)
    call suite%near('a real', number, 2.5_DP, 0.0_DP)
    call field_real(cards, row, 5, number, status)
    call suite%that('a missing real', status == NUMBER_EMPTY)
    call suite%that('a row of commas is a row', next_row(cards, row))
    call suite%that('without fields', row%n == 0 .and. row%line == 5)
    call suite%that('third row', next_row(cards, row))
    call suite%that('quotation marks go', field_text(cards, row, 1) == 'quoted' .and. .not. row%has_trailing_comma)
    call suite%that('no more rows', .not. next_row(cards, row))
  end subroutine test_rows


  !> A row may have any number of fields.
  subroutine test_wide_rows(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(data_row_type) :: row
    integer :: value, status
    call open_cards_text('*CARD' // NL // repeat('1,', 199) // '200', 'deck', cards, messages)
    call start_rows(cards%cards(1), row)
    call suite%that('wide row', next_row(cards, row))
    call suite%that('all fields', row%n == 200)
    call field_integer(cards, row, 200, value, status)
    call suite%that('its last field', value == 200)
  end subroutine test_wide_rows


  !> Carriage returns and tabs are blanks; the last line needs no end.
  subroutine test_line_ends(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(data_row_type) :: row
    character(2), parameter :: CRLF = achar(13) // achar(10)
    call open_cards_text('*NODE' // CRLF // '1,' // achar(9) // '2' // achar(9) // CRLF // '3, 4' // achar(13), &
      'deck', cards, messages)
    call suite%that('keyword without carriage return', cards%cards(1)%key == 'NODE')
    call suite%that('lines without carriage return', line_text(cards, 3) == '3, 4')
    call start_rows(cards%cards(1), row)
    call suite%that('row', next_row(cards, row))
    call suite%that('its field', field_text(cards, row, 2) == '2')
  end subroutine test_line_ends


  !> Included text is in place, searched beside the including file first; messages name the chain of files.
  subroutine test_includes(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    character(:), allocatable :: folder
    folder = temporary_folder()
    call write_file(folder // '/amontons_cards_main.inp', '*NODE' // NL // '*Include,' // NL // &
      ' input = amontons_cards_part.inp' // NL // '3,0,0,0' // NL)
    call write_file(folder // '/amontons_cards_part.inp', '1,0,0,0' // NL // '2,0,0,0')
    call open_cards(folder // '/amontons_cards_main', cards, messages, error)
    call suite%that('.inp is found', .not. allocated(error))
    call suite%that('one card with all rows', cards%n_cards == 1 .and. cards%n_lines == 6)
    call suite%that('the card became a comment', line_text(cards, 2) == '** *Include,')
    call suite%that('included line', line_text(cards, 4) == '1,0,0,0' .and. cards%line_number(4) == 1)
    call suite%that('line after it', line_text(cards, 6) == '3,0,0,0' .and. cards%line_number(6) == 4)
    call messages%add(5, 'Wrong.')
    call messages%add(2, 'Odd.', is_warning=.true.)
    call publish_messages(cards, messages, diagnostics)
    call suite%that('remarks in order', diagnostics%n_items == 2 .and. diagnostics%items(1)%is_warning)
    call suite%that('file and line', diagnostics%items(2)%line == 2 .and. &
      index(diagnostics%items(2)%file, 'amontons_cards_part.inp') > 0)
    call suite%that('chain', index(diagnostics%items(2)%text, 'included from') > 0 .and. &
      index(diagnostics%items(2)%text, 'main.inp, line 2') > 0)
    call suite%that('card as written', diagnostics%items(2)%card == '2,0,0,0')
    call delete_file(folder // '/amontons_cards_main.inp')
    call delete_file(folder // '/amontons_cards_part.inp')
  end subroutine test_includes


  !> A missing file, a file that includes itself, a card without a name.
  subroutine test_include_trouble(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(error_type), allocatable :: error
    character(:), allocatable :: folder
    folder = temporary_folder()
    call open_cards(folder // '/amontons_no_such_deck', cards, messages, error)
    call suite%that('no deck is an error', allocated(error))
    if (allocated(error)) call suite%that('of input and output', error%code == EXIT_IO)
    call open_cards_text('*INCLUDE' // NL // '*INCLUDE, INPUT=/amontons/no/such/file' // NL // '*INCLUDES, INPUT=x', &
      'deck', cards, messages)
    call suite%that('two errors, and INCLUDES is another card', messages%n_errors == 2 .and. cards%n_cards == 1)
    call write_file(folder // '/amontons_cards_a.inp', '*INCLUDE, INPUT=amontons_cards_b.inp' // NL)
    call write_file(folder // '/amontons_cards_b.inp', '*INCLUDE, INPUT=amontons_cards_a.inp' // NL)
    call open_cards(folder // '/amontons_cards_a.inp', cards, messages, error)
    call suite%that('a circle is reported once', messages%n_errors == 3 .and. .not. allocated(error))
    call delete_file(folder // '/amontons_cards_a.inp')
    call delete_file(folder // '/amontons_cards_b.inp')
  end subroutine test_include_trouble


  !> The table finds keywords and abbreviations, and lists itself.
  subroutine test_table(suite)
    type(suite_type), intent(inout) :: suite
    type(card_table_type) :: table
    character(:), allocatable :: text
    integer :: position
    logical :: is_short
    call make_card_table(table)
    call find_entry(table, 'ENDSTEP', position, is_short)
    call suite%that('END STEP', position > 0 .and. .not. is_short)
    call suite%that('its name', table%entries(position)%keyword == 'END STEP')
    call find_entry(table, 'EQUAT', position, is_short)
    call suite%that('a unique abbreviation', position > 0 .and. is_short)
    call find_entry(table, 'CONT', position, is_short)
    call suite%that('an ambiguous abbreviation', position == 0 .and. .not. is_short)
    call find_entry(table, 'NONSENSE', position, is_short)
    call suite%that('an unknown card', position == 0)
    call list_cards(text)
    call suite%that('the list has used cards', index(text, '*CONTACT PAIR  (in the model)') > 0)
    call suite%that('and options', index(text, 'INTERACTION=name (required)') > 0)
    call suite%that('and noted and refused ones', index(text, '*PREPRINT') > 0 .and. index(text, '*PLASTIC') > 0)
  end subroutine test_table


  !> Parameters against the table: each kind of mistake.
  subroutine test_matching(suite)
    type(suite_type), intent(inout) :: suite
    call expect_match(suite, '*NSET, NSET=A', 0, 0)
    call expect_match(suite, '*NSET', 1, 0)
    call expect_match(suite, '*NSET, NSET=', 1, 0)
    call expect_match(suite, '*NSET, NSET=A, NSET=B', 1, 0)
    call expect_match(suite, '*NSET, NSET=A, NONSENSE', 1, 0)
    call expect_match(suite, '*NSET, NSET=A, GENERATE=YES', 1, 0)
    call expect_match(suite, '*NSET, NSET=A, GENER', 0, 1)
    call expect_match(suite, '*NSET, NSET=A, UNSORTED', 0, 0)
    call expect_match(suite, '*ELEMENT, TYPE=C3D8, INPUT=P', 1, 0)
    call expect_match(suite, '*ELASTIC, TYPE=ISO', 0, 0)
    call expect_match(suite, '*ELASTIC, TYPE=ISOTR', 0, 1)
    call expect_match(suite, '*ELASTIC, TYPE=LAMINA', 0, 0)
    call expect_match(suite, '*ELASTIC, TYPE=COUPLED TRACTION', 1, 0)
    call expect_match(suite, '*ELASTIC, TYPE=NONSENSE', 1, 0)
    call expect_match(suite, '*STEP, NLGEOM', 0, 0)
    call expect_match(suite, '*STEP, nlgeom = no, INC=50', 0, 0)
    call expect_match(suite, '*STEP, NLGEOM=MAYBE', 1, 0)
    call expect_match(suite, '*STEP, INC=1.5', 1, 0)
    call expect_match(suite, '*STEP, UNSYMM=YES, NAME=Step-1', 0, 1)
    call expect_match(suite, '*STEP, PERTURBATION', 0, 0)
    call expect_match(suite, '*LINE SEARCH, TYPE=NODAL', 0, 0)
    call expect_match(suite, '*LINE SEARCH', 1, 0)
    call expect_match(suite, '*CONTACT PAIR, INTERACTION=I, TYPE=MORTAR', 0, 0)
    call expect_match(suite, '*CONTACT PAIR, INTERACTION=I, TYPE=MASSLESS', 1, 0)
  end subroutine test_matching


  !> Counts the errors and notes of one card.
  subroutine expect_match(suite, line, n_errors, n_notes)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: line
    integer, intent(in) :: n_errors, n_notes
    type(card_table_type) :: table
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(parameter_type), allocatable :: parameters(:)
    integer :: position
    logical :: is_short
    call make_card_table(table)
    call open_cards_text(line, 'deck', cards, messages)
    call find_entry(table, cards%cards(1)%key, position, is_short)
    call read_parameters(cards, cards%cards(1), parameters)
    call match_parameters(table%entries(position), parameters, 1, .false., messages)
    call suite%that(line // ' errors ' // to_text(messages%n_errors) // ', remarks ' // to_text(messages%n), &
      messages%n_errors == n_errors .and. messages%n == n_errors + n_notes)
  end subroutine expect_match


  !> Of very many errors the first are listed, all are counted.
  subroutine test_many_remarks(suite)
    type(suite_type), intent(inout) :: suite
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(diagnostic_list_type) :: diagnostics
    integer :: i
    call open_cards_text(repeat('1' // NL, 5000), 'deck', cards, messages)
    do i = 1, 5000
      call messages%add(i, 'Wrong.')
    end do
    call messages%add(0, 'In general.')
    call publish_messages(cards, messages, diagnostics)
    call suite%that('all are counted', diagnostics%n_errors == 5001)
    call suite%that('few are listed', diagnostics%n_items == 201)
    call suite%that('the last says so', index(diagnostics%items(201)%text, 'More errors') > 0)
  end subroutine test_many_remarks


  !> The folder for files of tests.
  function temporary_folder() result(folder)
    character(:), allocatable :: folder
    character(1000) :: value
    integer :: status
    call get_environment_variable('TMPDIR', value, status=status)
    folder = '/tmp'
    if (status == 0 .and. value /= '') folder = trim(value)
  end function temporary_folder


  subroutine write_file(path, text)
    character(*), intent(in) :: path, text
    integer :: unit
    open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', action='write')
    write (unit) text
    close (unit)
  end subroutine write_file


  subroutine delete_file(path)
    character(*), intent(in) :: path
    integer :: unit
    open (newunit=unit, file=path)
    close (unit, status='delete')
  end subroutine delete_file

end program test_cards
