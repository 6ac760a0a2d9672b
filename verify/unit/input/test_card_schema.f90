!> Unit test of card_schema on a table of its own: abbreviations, kinds of values, messages, suggestions, the table as text.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_card_schema
  use amontons_card_schema, only: card_table_type, find_entry, match_parameters, render_card_table, suggest_card, &
    has_parameter, parameter_text, parameter_word, SCOPE_MODEL, SCOPE_STEP, SCOPE_BOTH, ENTRY_IGNORED, ENTRY_REJECTED, &
    VALUE_NONE, VALUE_NAME, VALUE_TEXT, VALUE_INTEGER, VALUE_REAL, VALUE_WORD, VALUE_OPTIONAL_WORD, VALUE_OPTIONAL_REAL
  use amontons_cards, only: cards_type, parameter_type, deck_messages_type, open_cards_text, read_parameters
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(card_table_type) :: table
  call make_table()
  call check_entries()
  call check_values()
  call check_names()
  call check_suggestions()
  call check_text()
  call suite%finish()

contains

  !> Two cards with a common beginning, one of them with a parameter of each kind; an ignored and a rejected card.
  subroutine make_table()
    call table%card('LOAD', SCOPE_STEP, 'Loads.', data='node, value')
    call table%option('NAME', VALUE_NAME, 'A name.', default='required')
    call table%option('TEXT', VALUE_TEXT, 'A text.')
    call table%option('COUNT', VALUE_INTEGER, 'A number.', default='1')
    call table%option('FACTOR', VALUE_REAL, 'A factor.')
    call table%option('SMOOTH', VALUE_NONE, 'A flag.')
    call table%option('TYPE', VALUE_WORD, 'A word.', allowed='FORCE|MOMENT|MOMENTUM')
    call table%reject_words('HEAT', 'There is no heat here.')
    call table%option('SWITCH', VALUE_OPTIONAL_WORD, 'May have a word.', allowed='ON|OFF')
    call table%option('LIMIT', VALUE_OPTIONAL_REAL, 'May have a number.')
    call table%option('OLD', VALUE_TEXT, 'It changes nothing.', status=ENTRY_IGNORED)
    call table%option('HIDDEN|SECRET', VALUE_TEXT, 'Not here.', status=ENTRY_REJECTED)
    call table%add_dialect_note('They differ.')
    call table%card('LOAD CASE', SCOPE_MODEL, 'Cases.', parent='LOAD')
    call table%card('PIECE', SCOPE_BOTH, 'Pieces.', parent='LOAD|LOAD CASE')
    call table%cards_with(ENTRY_IGNORED, 'PREPRINT|PLOT', 'It prints nothing.')
    call table%cards_with(ENTRY_REJECTED, 'SHELL', 'There are no shells.')
    call table%card('LOAD', SCOPE_BOTH, 'A card of the same name does not replace the first.')
  end subroutine make_table


  !> Entries by name and unique abbreviation of three letters or more.
  subroutine check_entries()
    integer :: i
    logical :: is_short
    call suite%that('six cards, the second LOAD is none', table%n == 6 .and. table%entries(1)%scope == SCOPE_STEP)
    call find_entry(table, 'LOAD', i, is_short)
    call suite%that('exact before longer ones', i == 1 .and. .not. is_short)
    call find_entry(table, 'LOADC', i, is_short)
    call suite%that('abbreviation', i == 2 .and. is_short)
    call find_entry(table, 'LOA', i, is_short)
    call suite%that('two cards begin so', i == 0 .and. .not. is_short)
    call find_entry(table, 'SH', i, is_short)
    call suite%that('two letters are too few', i == 0)
    call find_entry(table, 'SHE', i, is_short)
    call suite%that('three are enough', i == 6 .and. is_short)
    call find_entry(table, 'SHELLS', i, is_short)
    call suite%that('longer than the name', i == 0)
    call suite%that('parent is a key', table%entries(2)%parent == 'LOAD' .and. table%entries(2)%key == 'LOADCASE')
    call suite%that('two parameters in one call', table%entries(1)%n_options == 11 .and. &
      table%entries(1)%options(11)%name == 'SECRET' .and. table%entries(1)%options(11)%status == ENTRY_REJECTED)
  end subroutine check_entries


  !> The parameters of a card LOAD against the table; all messages, joined.
  subroutine match(text, parameters, messages, all_texts, is_lenient)
    character(*), intent(in) :: text
    type(parameter_type), allocatable, intent(out) :: parameters(:)
    type(deck_messages_type), intent(out) :: messages
    character(:), allocatable, intent(out) :: all_texts
    logical, intent(in), optional :: is_lenient
    type(cards_type) :: cards
    character(:), allocatable :: one
    integer :: i, line
    logical :: is_warning, is_soft
    is_soft = .false.
    if (present(is_lenient)) is_soft = is_lenient
    call open_cards_text('*LOAD,' // text, 'deck', cards, messages)
    call read_parameters(cards, cards%cards(1), parameters)
    call match_parameters(table%entries(1), parameters, 7, is_soft, messages)
    all_texts = ''
    do i = 1, messages%n
      call messages%get(i, line, is_warning, one)
      call suite%that('line of a message', line == 7)
      all_texts = all_texts // one
    end do
  end subroutine match


  !> Expects numbers of errors and notes, and a piece of text.
  subroutine expect(text, n_errors, n_notes, piece, is_lenient)
    character(*), intent(in) :: text, piece
    integer, intent(in) :: n_errors, n_notes
    logical, intent(in), optional :: is_lenient
    type(parameter_type), allocatable :: parameters(:)
    type(deck_messages_type) :: messages
    character(:), allocatable :: reported
    call match(text, parameters, messages, reported, is_lenient)
    call suite%that(text // ': counts; ' // reported, messages%n_errors == n_errors .and. messages%n == n_errors + n_notes)
    call suite%that(text // ': ' // reported, index(reported, piece) > 0 .or. piece == '')
  end subroutine expect


  !> Each kind of value, right and wrong.
  subroutine check_values()
    call expect('NAME=A', 0, 0, '')
    call expect('TEXT=b', 1, 0, '*LOAD needs the parameter NAME=name')
    call expect('NAME', 1, 0, 'NAME needs a value: NAME=name')
    call expect('NAME=A,COUNT=2', 0, 0, '')
    call expect('NAME=A,COUNT=2.5', 1, 0, '2.5 of COUNT is not a number of the form COUNT=integer')
    call expect('NAME=A,FACTOR=2.5', 0, 0, '')
    call expect('NAME=A,FACTOR=two', 1, 0, 'FACTOR=real')
    call expect('NAME=A,SMOOTH', 0, 0, '')
    call expect('NAME=A,SMOOTH=YES', 1, 0, 'SMOOTH takes no value')
    call expect('NAME=A,TYPE=force', 0, 0, '')
    call expect('NAME=A,TYPE=HEAT', 1, 0, 'TYPE=HEAT is not supported. There is no heat here.')
    call expect('NAME=A,TYPE=COLD', 1, 0, 'COLD of TYPE is not known; allowed is FORCE')
    call expect('NAME=A,SWITCH', 0, 0, '')
    call expect('NAME=A,SWITCH=OFF', 0, 0, '')
    call expect('NAME=A,SWITCH=DIM', 1, 0, 'DIM of SWITCH')
    call expect('NAME=A,LIMIT', 0, 0, '')
    call expect('NAME=A,LIMIT=x', 1, 0, 'LIMIT[=real]')
    call expect('NAME=A,OLD=x', 0, 1, 'OLD has no effect. It changes nothing.')
    call expect('NAME=A,HIDDEN=x', 1, 0, 'HIDDEN of *LOAD is not supported. Not here.')
  end subroutine check_values


  !> Names: abbreviations of parameters and words, unknown ones, repetitions.
  subroutine check_names()
    type(parameter_type), allocatable :: parameters(:)
    type(deck_messages_type) :: messages
    character(:), allocatable :: reported
    call match('NAME=Part 1,FAC=3.,TYP=FOR', parameters, messages, reported)
    call suite%that('three abbreviations: ' // reported, messages%n == 3 .and. messages%n_errors == 0)
    call suite%that('expanded', has_parameter(parameters, 'FACTOR') .and. parameter_word(parameters, 'TYPE', 'X') == 'FORCE')
    call suite%that('as written', parameter_text(parameters, 'NAME') == 'Part 1' .and. parameter_text(parameters, 'LIMIT') == '')
    call suite%that('default', parameter_word(parameters, 'SWITCH', 'ON') == 'ON' .and. .not. has_parameter(parameters, 'SWITCH'))
    call expect('NAME=A,TYPE=MOM', 1, 0, 'MOM of TYPE is not known')         ! two words begin so
    call expect('NAME=A,TYPE=MOMENT', 0, 0, '')                              ! the whole word counts before MOMENTUM
    call expect('NAME=A,NAME=B', 1, 0, 'NAME appears twice')
    call expect('NAME=A,FACTR=1.', 1, 0, 'did you mean FACTOR?')
    call expect('NAME=A,FACTR=1.', 0, 1, 'has no parameter FACTR', is_lenient=.true.)
    call expect('NAME=A,ZZZZZ=1.', 1, 0, 'has no parameter ZZZZZ; allowed is NAME=name')
  end subroutine check_names


  !> The end of the sentence about an unknown card.
  subroutine check_suggestions()
    call suite%that('near', suggest_card(table, 'SHALL') == '; did you mean *SHELL?')
    call suite%that('far', suggest_card(table, 'QUITEDIFFERENT') == '.')
    call suite%that('a comma is missing', suggest_card(table, 'LOADNAME=A') == '; a comma is missing after *LOAD.')
    call suite%that('after the longer card', suggest_card(table, 'LOADCASENAME=A') == '; a comma is missing after *LOAD CASE.')
  end subroutine check_suggestions


  !> The table as text.
  subroutine check_text()
    character(:), allocatable :: text
    integer :: noted, refused
    call render_card_table(table, text)
    call suite%that('card', index(text, '*LOAD  (in a step)') == 1)
    call suite%that('its block', index(text, '*LOAD CASE  (in the model, after *LOAD)') > 0)
    call suite%that('its blocks', index(text, '*PIECE  (in the model or step, after *LOAD or *LOAD CASE)') > 0)
    call suite%that('required', index(text, 'NAME=name (required): A name.') > 0)
    call suite%that('default', index(text, 'COUNT=integer (default 1): A number.') > 0)
    call suite%that('words', index(text, 'TYPE=FORCE/MOMENT/MOMENTUM: A word. Refused: HEAT. There is no heat here.') > 0)
    call suite%that('refused parameter', index(text, 'HIDDEN=text: refused. Not here.') > 0)
    call suite%that('data', index(text, 'data lines: node, value') > 0)
    call suite%that('dialects', index(text, 'dialects: They differ.') > 0)
    noted = index(text, 'Cards read past with a note')
    refused = index(text, 'Cards refused')
    call suite%that('sections', noted > 0 .and. index(text, '    *PLOT') > noted .and. index(text, '    *PLOT') < refused &
      .and. index(text, '    *SHELL') > refused)
    call suite%that('a shared sentence stands once', index(text, 'It prints nothing.') == &
      index(text, 'It prints nothing.', back=.true.))
  end subroutine check_text

end program test_card_schema
