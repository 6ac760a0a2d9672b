!> Tokenizer of the deck: includes, keyword cards, data rows, fields, and messages with file and line.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The whole deck is one text; lines, cards and fields are positions in it, so that reading makes no copies.
module amontons_cards
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: diagnostic_list_type, error_type, set_error, EXIT_IO
  use amontons_containers, only: name_table_type, sort_integers
  use amontons_text, only: read_text_file, read_relative_file, name_key, to_text, is_blank, BLANK_CHARACTERS, NEWLINE, &
    parse_integer, &
    parse_real
  implicit none
  private
  public :: cards_type, parameter_type, data_row_type, deck_messages_type
  public :: open_cards, open_cards_text, publish_messages, line_text, read_parameters
  public :: start_deck_text, append_line, find_cards, start_rows, next_row, field_text, field_integer, field_real, is_empty_field
  public :: has_open_keyword_line

  integer, parameter :: MAX_INCLUDE_DEPTH = 32          !< includes within includes
  integer, parameter :: MAX_LISTED_ERRORS = 200        !< errors listed one by one

  !> A file of the deck.
  type :: file_type
    character(:), allocatable :: path
    integer :: parent = 0                       !< file that includes it; 0: the main file
    integer :: parent_line = 0                  !< line there
  end type file_type

  !> One keyword card: positions in the list of lines.
  type :: card_type
    character(:), allocatable :: key            !< keyword, squeezed: 'ENDSTEP'
    integer :: line = 0                         !< its keyword line
    integer :: data_first = 0                   !< line after the keyword line and its continuations
    integer :: data_last = 0                    !< line before the next card
    integer :: entry = 0                        !< index into the card table, set by who checks
  end type card_type

  !> One parameter of a card as the user wrote it.
  type :: parameter_type
    character(:), allocatable :: key            !< squeezed name
    character(:), allocatable :: text           !< value without blanks around it and quotation marks
    logical :: has_value = .false.
  end type parameter_type

  !> The cursor over the data rows of a card, and the fields of the present row.
  type :: data_row_type
    integer :: line = 0                         !< present line
    integer :: n = 0                            !< fields up to the last one that is not empty
    logical :: has_trailing_comma = .false.
    integer(I64), allocatable :: first(:)       !< field i is text(first(i):last(i)), blanks trimmed
    integer(I64), allocatable :: last(:)
    integer, private :: next = 0
    integer, private :: end = 0
  end type data_row_type

  !> Messages of the reader by line of the deck; sorted only on publication.
  type :: deck_message_type
    integer :: line = 0
    logical :: is_warning = .false.
    character(:), allocatable :: text
  end type deck_message_type

  type :: deck_messages_type
    integer :: n = 0
    integer :: n_errors = 0
    type(deck_message_type), allocatable, private :: items(:)
  contains
    procedure :: add => add_message
    procedure :: get => get_message
  end type deck_messages_type

  !> The deck as text, lines, cards.
  type :: cards_type
    character(:), allocatable :: text           !< all lines, includes in place, each ended by a newline
    integer(I64) :: text_length = 0                  !< used part of it
    integer :: n_lines = 0
    integer(I64), allocatable :: line_start(:)  !< first character of each line
    integer, allocatable :: line_length(:)      !< without newline and carriage return
    integer, allocatable :: line_file(:)        !< index into files
    integer, allocatable :: line_number(:)      !< line in that file, from 1
    type(file_type), allocatable :: files(:)
    integer :: n_cards = 0
    type(card_type), allocatable :: cards(:)
    integer :: first_card_line = 0              !< 0: no card at all
    type(name_table_type) :: known_parameters   !< 'STEP,' and 'STEP,NLGEOM' for each card and parameter; empty: not known
  end type cards_type

contains

  !> Reads a deck from a file. Tries the path as written, then with .inp appended.
  subroutine open_cards(path, cards, messages, error, known_parameters)
    character(*), intent(in) :: path
    type(cards_type), intent(out) :: cards
    type(deck_messages_type), intent(inout) :: messages
    type(error_type), allocatable, intent(out) :: error   !< EXIT_IO
    type(name_table_type), intent(in), optional :: known_parameters   !< of all cards, see find_cards
    character(:), allocatable :: text, taken
    logical :: is_read
    call start_deck_text(cards)
    taken = path
    call read_text_file(taken, text, is_read)
    if (.not. is_read) then
      taken = path // '.inp'
      call read_text_file(taken, text, is_read)
    end if
    if (.not. is_read) then
      call set_error(error, EXIT_IO, 'The deck ''' // path // ''' cannot be read, nor ''' // path // '.inp''.')
      return
    end if
    call append_file(cards, messages, taken, text, 0, 0)
    call find_cards(cards, known_parameters)
  end subroutine open_cards


  !> Takes a deck from memory; its includes are relative to the working directory.
  subroutine open_cards_text(text, name, cards, messages, known_parameters)
    character(*), intent(in) :: text
    character(*), intent(in) :: name            !< replaces the file name in messages
    type(cards_type), intent(out) :: cards
    type(deck_messages_type), intent(inout) :: messages
    type(name_table_type), intent(in), optional :: known_parameters   !< of all cards, see find_cards
    call start_deck_text(cards)
    call append_file(cards, messages, name, text, 0, 0)
    call find_cards(cards, known_parameters)
  end subroutine open_cards_text


  !> An empty deck with memory for some lines.
  subroutine start_deck_text(cards)
    type(cards_type), intent(out) :: cards
    allocate (character(65536) :: cards%text)
    allocate (cards%line_start(1024), cards%line_length(1024), cards%line_file(1024), cards%line_number(1024))
    allocate (cards%files(0))
  end subroutine start_deck_text


  !> Appends a file's lines to the deck; an INCLUDE line becomes a comment that the included lines follow.
  recursive subroutine append_file(cards, messages, path, text, parent, parent_line)
    type(cards_type), intent(inout) :: cards
    type(deck_messages_type), intent(inout) :: messages
    character(*), intent(in) :: path, text
    integer, intent(in) :: parent               !< index of the including file, 0: none
    integer, intent(in) :: parent_line          !< line number there
    integer :: here, number, mark
    integer(I64) :: first, last, n, start
    logical :: is_card, has_data
    call append_path(cards, path, parent, parent_line)
    here = size(cards%files)
    n = len(text, I64)
    first = 1
    number = 0
    do while (first <= n)
      last = line_end(text, first)
      number = number + 1
      mark = verify(text(first:last), BLANK_CHARACTERS)
      is_card = mark > 0
      start = first + int(mark, I64) - 1
      if (is_card) is_card = text(start:start) == '*'
      has_data = .false.
      if (is_card) has_data = has_input_file(card_with_continuations(text, first, last), mark)
      if (is_card) is_card = has_data .or. is_include(text(first:last), mark)
      if (is_card) then
        call include_file(cards, messages, text, here, first, last, number, has_data)
      else
        call append_line(cards, text(first:last), here, number)
      end if
      first = last + 2
    end do
  end subroutine append_file


  !> Appends a file to the list of files.
  subroutine append_path(cards, path, parent, parent_line)
    type(cards_type), intent(inout) :: cards
    character(*), intent(in) :: path
    integer, intent(in) :: parent, parent_line
    type(file_type), allocatable :: larger(:)
    integer :: n
    n = size(cards%files)
    allocate (larger(n + 1))
    larger(:n) = cards%files
    larger(n + 1)%path = path
    larger(n + 1)%parent = parent
    larger(n + 1)%parent_line = parent_line
    call move_alloc(larger, cards%files)
  end subroutine append_path


  !> Whether a line is an INCLUDE card.
  pure function is_include(line, mark) result(is_card)
    character(*), intent(in) :: line
    integer, intent(in) :: mark                 !< its first character that is not blank
    logical :: is_card
    character(:), allocatable :: key
    is_card = .false.
    if (line(mark:mark) /= '*') return
    if (scan(line, 'uU') == 0) return
    key = name_key(line)
    if (len(key) < 8) return
    is_card = key(:8) == '*INCLUDE'
    if (is_card .and. len(key) > 8) is_card = key(9:9) == ','
  end function is_include


  !> A keyword line with its continuation lines.
  pure function card_with_continuations(text, first, last) result(card)
    character(*), intent(in) :: text
    integer(I64), intent(in) :: first, last     !< of the keyword line
    character(:), allocatable :: card, line
    integer(I64) :: end_of_line
    card = text(first:last)
    end_of_line = last
    do while (is_continued(text, end_of_line, card))
      call next_line(text, end_of_line, line)
      card = card // line
    end do
  end function card_with_continuations


  !> Whether a keyword line that names a file continues: it ends with a comma, and the next line is no card and has a parameter
  !! with a value.
  pure function is_continued(text, last, card) result(is_so)
    character(*), intent(in) :: text
    integer(I64), intent(in) :: last            !< end of the keyword line so far
    character(*), intent(in) :: card            !< the keyword line so far
    logical :: is_so
    character(:), allocatable :: line
    integer(I64) :: end_of_line
    is_so = ends_with_comma(card) .and. last + 2 <= len(text, I64)
    if (.not. is_so) return
    end_of_line = last
    call next_line(text, end_of_line, line)
    is_so = scan(line, '=') > 0 .and. index(adjustl(line), '*') /= 1
  end function is_continued


  !> Whether the data lines of a card are in a file: NODE, ELEMENT, EQUATION, AMPLITUDE or IMPERFECTION with INPUT.
  pure function has_input_file(line, mark) result(has_it)
    character(*), intent(in) :: line
    integer, intent(in) :: mark                 !< its first character that is not blank
    logical :: has_it
    character(:), allocatable :: key
    integer :: comma
    has_it = .false.
    if (line(mark:mark) /= '*' .or. index(line, '=') == 0) return
    key = name_key(line)
    comma = index(key, ',')
    if (index(key, ',INPUT=') == 0) return
    has_it = any(key(:comma - 1) == [character(13) :: '*NODE', '*ELEMENT', '*EQUATION', '*AMPLITUDE', '*IMPERFECTION'])
  end function has_input_file


  !> Reads the file of an INCLUDE card or an INPUT; the continuation lines of the card are copied unchanged.
  recursive subroutine include_file(cards, messages, text, here, first, last, number, has_data)
    type(cards_type), intent(inout) :: cards
    type(deck_messages_type), intent(inout) :: messages
    character(*), intent(in) :: text             !< the including file
    integer, intent(in) :: here                  !< its index
    integer(I64), intent(in) :: first            !< start of the card's line
    integer(I64), intent(inout) :: last          !< end of it; of its last continuation on return
    integer, intent(inout) :: number             !< line number of it; of its last continuation on return
    logical, intent(in) :: has_data              !< .false.: the card becomes a comment; .true.: it stays, the file is its data
    character(:), allocatable :: card, path, included, comment
    integer :: line, line_number
    logical :: is_read
    line_number = number
    comment = '** '
    if (has_data) comment = ''
    card = text(first:last)
    call append_line(cards, comment // card, here, number)
    line = cards%n_lines
    do while (is_continued(text, last, card))
      call next_line(text, last, included)
      number = number + 1
      card = card // included
      call append_line(cards, comment // included, here, number)
    end do
    call include_path(card, path)
    if (path == '') then
      call messages%add(line, 'INCLUDE needs the name of a file: *INCLUDE, INPUT=name.')
      return
    end if
    if (is_circular(cards, here, path)) then
      call messages%add(line, 'The file ''' // path // ''' includes itself, directly or through others, or the ' // &
        'includes are deeper than ' // to_text(MAX_INCLUDE_DEPTH) // ' levels.')
      return
    end if
    call read_relative_file(cards%files(here)%path, path, included, is_read)
    if (.not. is_read) then
      call messages%add(line, 'The included file ''' // path // ''' cannot be read; it is looked for beside the ' // &
        'including file, then in the working directory.')
      return
    end if
    call append_file(cards, messages, path, included, here, line_number)
  end subroutine include_file


  !> Steps to the next line of a text.
  pure subroutine next_line(text, last, line)
    character(*), intent(in) :: text
    integer(I64), intent(inout) :: last          !< end of the present line; of the next one on return
    character(:), allocatable, intent(out) :: line
    integer(I64) :: first
    first = last + 2
    last = line_end(text, first)
    line = text(first:last)
  end subroutine next_line


  !> The position before the next newline, or of the end of the text.
  pure function line_end(text, first) result(last)
    character(*), intent(in) :: text
    integer(I64), intent(in) :: first            !< where the line starts
    integer(I64) :: last
    do last = first, len(text, I64)
      if (text(last:last) == NEWLINE) exit
    end do
    last = last - 1
  end function line_end


  !> The file name of an INCLUDE card; empty if it has none.
  subroutine include_path(card, path)
    character(*), intent(in) :: card
    character(:), allocatable, intent(out) :: path
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    path = ''
    call split_parameters(card, parameters)
    do i = 1, size(parameters)
      if (parameters(i)%key == 'INPUT' .or. parameters(i)%key == 'FILE') path = parameters(i)%text
    end do
  end subroutine include_path


  !> Whether including a file from another would be circular.
  pure function is_circular(cards, file, path) result(is_circle)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: file                  !< including file
    character(*), intent(in) :: path             !< file to be included, as written
    logical :: is_circle
    character(:), allocatable :: beside
    integer :: f, depth
    f = file
    beside = cards%files(file)%path
    beside = beside(:index(beside, '/', back=.true.)) // path
    depth = 0
    is_circle = .false.
    do while (f > 0)
      is_circle = is_circle .or. cards%files(f)%path == path .or. cards%files(f)%path == beside
      f = cards%files(f)%parent
      depth = depth + 1
    end do
    is_circle = is_circle .or. depth >= MAX_INCLUDE_DEPTH
  end function is_circular


  !> Appends one line to the text and to the list of lines.
  subroutine append_line(cards, line, file, number)
    type(cards_type), intent(inout) :: cards
    character(*), intent(in) :: line
    integer, intent(in) :: file, number
    integer :: n
    n = len(line)
    if (n > 0) then
      if (line(n:n) == achar(13)) n = n - 1
    end if
    call reserve_text(cards, int(n, I64) + 1)
    if (cards%n_lines == size(cards%line_start)) call reserve_lines(cards)
    cards%n_lines = cards%n_lines + 1
    cards%line_start(cards%n_lines) = cards%text_length + 1
    cards%line_length(cards%n_lines) = n
    cards%line_file(cards%n_lines) = file
    cards%line_number(cards%n_lines) = number
    cards%text(cards%text_length + 1:cards%text_length + int(n, I64)) = line(:n)
    cards%text_length = cards%text_length + int(n, I64) + 1
    cards%text(cards%text_length:cards%text_length) = NEWLINE
  end subroutine append_line


  !> Allocates memory for more characters.
  subroutine reserve_text(cards, n_more)
    type(cards_type), intent(inout) :: cards
    integer(I64), intent(in) :: n_more
    character(:), allocatable :: larger
    if (cards%text_length + n_more <= len(cards%text, I64)) return
    allocate (character(2*(cards%text_length + n_more)) :: larger)
    larger(:cards%text_length) = cards%text(:cards%text_length)
    call move_alloc(larger, cards%text)
  end subroutine reserve_text


  !> Doubles the memory for lines.
  subroutine reserve_lines(cards)
    type(cards_type), intent(inout) :: cards
    integer(I64), allocatable :: start(:)
    integer :: n
    n = cards%n_lines
    allocate (start(2 * n))
    start(:n) = cards%line_start
    call move_alloc(start, cards%line_start)
    call double_size(cards%line_length)
    call double_size(cards%line_file)
    call double_size(cards%line_number)
  end subroutine reserve_lines


  !> Doubles the size of an array.
  subroutine double_size(array)
    integer, allocatable, intent(inout) :: array(:)
    integer, allocatable :: larger(:)
    allocate (larger(2 * size(array)))
    larger(:size(array)) = array
    call move_alloc(larger, array)
  end subroutine double_size


  !> Cuts the lines into cards. The known parameters decide whether a line after a trailing comma continues the keyword line.
  subroutine find_cards(cards, known_parameters)
    type(cards_type), intent(inout) :: cards
    type(name_table_type), intent(in), optional :: known_parameters   !< 'STEP,' and 'STEP,NLGEOM' for each card and parameter
    type(card_type), allocatable :: larger(:)
    integer :: line, last
    if (present(known_parameters)) cards%known_parameters = known_parameters
    allocate (cards%cards(256))
    line = 1
    do while (line <= cards%n_lines)
      if (is_keyword_line(cards, line)) then
        if (cards%n_cards == size(cards%cards)) then
          allocate (larger(2 * cards%n_cards))
          larger(:cards%n_cards) = cards%cards
          call move_alloc(larger, cards%cards)
        end if
        if (cards%n_cards == 0) cards%first_card_line = line
        last = last_keyword_line(cards, line)
        cards%n_cards = cards%n_cards + 1
        cards%cards(cards%n_cards)%line = line
        cards%cards(cards%n_cards)%key = keyword_key(line_text(cards, line))
        cards%cards(cards%n_cards)%data_first = last + 1
        line = last
      end if
      if (cards%n_cards > 0) cards%cards(cards%n_cards)%data_last = line
      line = line + 1
    end do
  end subroutine find_cards


  !> Whether a line starts a card: its first character is a star and its second is not.
  pure function is_keyword_line(cards, line) result(is_keyword)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: line
    logical :: is_keyword
    integer(I64) :: first, last
    call line_bounds(cards, line, first, last)
    is_keyword = .false.
    if (first > last) return
    if (cards%text(first:first) /= '*') return
    is_keyword = .true.
    if (first < last) is_keyword = cards%text(first + 1:first + 1) /= '*'
  end function is_keyword_line


  !> The last continuation of a keyword line. A keyword line that ends with a comma continues in the next line, unless that one is
  !! a card, starts like a number or names no parameter (some decks end a keyword line with a comma).
  function last_keyword_line(cards, line) result(last_line)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: line
    integer :: last_line, next
    integer(I64) :: first, last
    last_line = line
    do
      call line_bounds(cards, last_line, first, last)
      if (cards%text(last:last) /= ',') return
      next = last_line + 1
      do while (next <= cards%n_lines)
        if (.not. is_comment_or_blank(cards, next)) exit
        next = next + 1
      end do
      if (next > cards%n_lines) return
      if (is_keyword_line(cards, next)) return
      call line_bounds(cards, next, first, last)
      if (scan(cards%text(first:first), '0123456789+-.,') == 1) return
      if (.not. has_parameters_only(cards, keyword_key(line_text(cards, line)), line_text(cards, next))) return
      last_line = next
    end do
  end function last_keyword_line


  !> Whether a line holds parameters of a card: one with a value, or none but known ones. Of an unknown card every line does.
  function has_parameters_only(cards, key, line) result(does_so)
    type(cards_type), intent(in) :: cards
    character(*), intent(in) :: key             !< keyword, squeezed
    character(*), intent(in) :: line
    logical :: does_so
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    does_so = scan(line, '=') > 0 .or. cards%known_parameters%find(key // ',') == 0
    if (does_so) return
    call split_parameters(',' // line, parameters)
    does_so = all([(cards%known_parameters%find(key // ',' // parameters(i)%key) > 0, i=1, size(parameters))])
  end function has_parameters_only


  !> Whether the keyword line of a card, with its continuations, ends with a comma.
  pure function has_open_keyword_line(cards, card) result(is_open)
    type(cards_type), intent(in) :: cards
    type(card_type), intent(in) :: card
    logical :: is_open
    is_open = ends_with_comma(keyword_text(cards, card))
  end function has_open_keyword_line


  !> The part of a line without the blanks around it; first > last if it is blank.
  pure subroutine line_bounds(cards, line, first, last)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: line
    integer(I64), intent(out) :: first, last
    first = cards%line_start(line)
    last = first + int(cards%line_length(line), I64) - 1
    call trim_positions(cards%text, first, last)
  end subroutine line_bounds


  !> Moves first and last inward past blanks.
  pure subroutine trim_positions(text, first, last)
    character(*), intent(in) :: text
    integer(I64), intent(inout) :: first, last
    do while (last >= first)
      if (.not. is_blank(text(last:last))) exit
      last = last - 1
    end do
    do while (first <= last)
      if (.not. is_blank(text(first:first))) exit
      first = first + 1
    end do
  end subroutine trim_positions


  !> Whether a line is a comment or blank.
  pure function is_comment_or_blank(cards, line) result(is_so)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: line
    logical :: is_so
    integer(I64) :: first, last
    call line_bounds(cards, line, first, last)
    is_so = first > last
    if (is_so .or. first == last) return
    is_so = cards%text(first:first + 1) == '**'
  end function is_comment_or_blank


  !> Whether the last character of a line, blanks apart, is a comma.
  pure function ends_with_comma(line) result(is_open)
    character(*), intent(in) :: line
    logical :: is_open
    integer :: last
    last = verify(line, BLANK_CHARACTERS, back=.true.)
    is_open = .false.
    if (last > 0) is_open = line(last:last) == ','
  end function ends_with_comma


  !> A line as written.
  pure function line_text(cards, line) result(text)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: line                  !< 0 gives an empty text
    character(:), allocatable :: text
    integer(I64) :: first
    text = ''
    if (line == 0) return
    first = cards%line_start(line)
    text = cards%text(first:first + int(cards%line_length(line), I64) - 1)
  end function line_text


  !> The squeezed keyword of a line, without its star, by its present name.
  pure function keyword_key(line) result(key)
    character(*), intent(in) :: line
    character(:), allocatable :: key
    integer :: comma
    comma = index(line, ',')
    if (comma == 0) comma = len(line) + 1
    key = name_key(line(index(line, '*') + 1:comma - 1))
    if (key == 'TRANSVERSESHEAR') key = 'TRANSVERSESHEARSTIFFNESS'   ! the short name that older releases of Abaqus/CAE write
  end function keyword_key


  !> A card's keyword line with its continuations.
  pure function keyword_text(cards, card) result(text)
    type(cards_type), intent(in) :: cards
    type(card_type), intent(in) :: card
    character(:), allocatable :: text
    integer :: line
    text = line_text(cards, card%line)
    do line = card%line + 1, card%data_first - 1
      if (.not. is_comment_or_blank(cards, line)) text = text // line_text(cards, line)
    end do
  end function keyword_text


  !> The parameters of a card.
  subroutine read_parameters(cards, card, parameters)
    type(cards_type), intent(in) :: cards
    type(card_type), intent(in) :: card
    type(parameter_type), allocatable, intent(out) :: parameters(:)
    call split_parameters(keyword_text(cards, card), parameters)
  end subroutine read_parameters


  !> Splits a keyword line at the commas outside quotation marks and drops the keyword.
  subroutine split_parameters(text, parameters)
    character(*), intent(in) :: text
    type(parameter_type), allocatable, intent(out) :: parameters(:)
    type(parameter_type), allocatable :: found(:)
    integer :: i, n, n_commas, first
    logical :: is_quoted
    n_commas = 0
    do i = 1, len(text)
      if (text(i:i) == ',') n_commas = n_commas + 1
    end do
    allocate (found(n_commas + 1))
    n = 0
    first = 0
    is_quoted = .false.
    do i = 1, len(text) + 1
      if (i <= len(text)) then
        if (text(i:i) == '"') is_quoted = .not. is_quoted
        if (text(i:i) /= ',' .or. is_quoted) cycle
      end if
      if (first > 0) call add_parameter(text(first:i - 1), found, n)
      first = i + 1
    end do
    parameters = found(:n)
  end subroutine split_parameters


  !> One piece NAME or NAME=VALUE between commas; an empty one is skipped.
  subroutine add_parameter(piece, found, n)
    character(*), intent(in) :: piece
    type(parameter_type), intent(inout) :: found(:)
    integer, intent(inout) :: n
    integer :: equal, first, last
    if (verify(piece, BLANK_CHARACTERS) == 0) return
    n = n + 1
    equal = index(piece, '=')
    found(n)%has_value = equal > 0
    if (equal == 0) equal = len(piece) + 1
    found(n)%key = name_key(piece(:equal - 1))
    found(n)%text = ''
    if (.not. found(n)%has_value) return
    first = equal + verify(piece(equal + 1:), BLANK_CHARACTERS // '"')
    last = verify(piece, BLANK_CHARACTERS // '"', back=.true.)
    if (first > equal .and. last >= first) found(n)%text = piece(first:last)
  end subroutine add_parameter


  !> Sets the cursor before the first data row of a card.
  pure subroutine start_rows(card, row)
    type(card_type), intent(in) :: card
    type(data_row_type), intent(inout) :: row
    row%next = card%data_first
    row%end = card%data_last
    row%line = card%line
    row%n = 0
    if (.not. allocated(row%first)) allocate (row%first(32), row%last(32))
  end subroutine start_rows


  !> Advances to the next data row; .false. at the end. Comments and blank lines are skipped; a line of commas is a row.
  function next_row(cards, row) result(is_row)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(inout) :: row
    logical :: is_row
    integer(I64) :: first, last
    is_row = .false.
    do while (row%next <= row%end)
      row%line = row%next
      row%next = row%next + 1
      call line_bounds(cards, row%line, first, last)
      if (first > last) cycle
      if (cards%text(first:first) == '*') cycle     ! only comments start with a star here
      call split_fields(cards%text, first, last, row)
      is_row = .true.
      return
    end do
  end function next_row


  !> Splits a row at its commas.
  subroutine split_fields(text, first, last, row)
    character(*), intent(in) :: text
    integer(I64), intent(in) :: first, last
    type(data_row_type), intent(inout) :: row
    integer(I64) :: start, i
    integer :: n
    n = 0
    row%n = 0
    start = first
    do i = first, last + 1
      if (i <= last) then
        if (text(i:i) /= ',') cycle
      end if
      n = n + 1
      if (n > size(row%first)) call double_fields(row)
      row%first(n) = start
      row%last(n) = i - 1
      call trim_positions(text, row%first(n), row%last(n))
      if (row%first(n) <= row%last(n)) row%n = n
      start = i + 1
    end do
    row%has_trailing_comma = text(last:last) == ','
  end subroutine split_fields


  !> Doubles the memory for fields.
  subroutine double_fields(row)
    type(data_row_type), intent(inout) :: row
    integer(I64), allocatable :: wider(:)
    integer :: n
    n = size(row%first)
    allocate (wider(2 * n))
    wider(:n) = row%first
    call move_alloc(wider, row%first)
    allocate (wider(2 * n))
    wider(:n) = row%last
    call move_alloc(wider, row%last)
  end subroutine double_fields


  !> Whether a field is missing or blank.
  pure function is_empty_field(row, i) result(is_empty)
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i
    logical :: is_empty
    is_empty = i > row%n
    if (.not. is_empty) is_empty = row%first(i) > row%last(i)
  end function is_empty_field


  !> A field as written, without quotation marks around it; empty if it is missing.
  pure function field_text(cards, row, i) result(text)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i
    character(:), allocatable :: text
    text = ''
    if (is_empty_field(row, i)) return
    text = cards%text(row%first(i):row%last(i))
    if (len(text) >= 2 .and. text(1:1) == '"') text = text(2:len(text) - 1)
  end function field_text


  !> A field as an integer.
  pure subroutine field_integer(cards, row, i, value, status)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i
    integer, intent(out) :: value
    integer, intent(out) :: status               !< NUMBER_... of text
    if (is_empty_field(row, i)) then
      call parse_integer('', value, status)
    else
      call parse_integer(cards%text(row%first(i):row%last(i)), value, status)
    end if
  end subroutine field_integer


  !> A field as a real.
  pure subroutine field_real(cards, row, i, value, status)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i
    real(DP), intent(out) :: value
    integer, intent(out) :: status               !< NUMBER_... of text
    if (is_empty_field(row, i)) then
      call parse_real('', value, status)
    else
      call parse_real(cards%text(row%first(i):row%last(i)), value, status)
    end if
  end subroutine field_real


  !> Adds a message. Cost: amortised constant.
  subroutine add_message(self, line, text, is_warning)
    class(deck_messages_type), intent(inout) :: self
    integer, intent(in) :: line                  !< line of the deck (all files counted through); 0: none
    character(*), intent(in) :: text             !< whole sentences
    logical, intent(in), optional :: is_warning  !< default .false.: an error
    type(deck_message_type), allocatable :: larger(:)
    logical :: is_note
    is_note = .false.
    if (present(is_warning)) is_note = is_warning
    if (.not. is_note) self%n_errors = self%n_errors + 1
    if (self%n > 4 * MAX_LISTED_ERRORS) return
    if (.not. allocated(self%items)) allocate (self%items(16))
    if (self%n == size(self%items)) then
      allocate (larger(2 * self%n))
      larger(:self%n) = self%items
      call move_alloc(larger, self%items)
    end if
    self%n = self%n + 1
    self%items(self%n) = deck_message_type(line, is_note, text)
  end subroutine add_message


  !> One message, in the order of creation.
  pure subroutine get_message(self, i, line, is_warning, text)
    class(deck_messages_type), intent(in) :: self
    integer, intent(in) :: i                     !< 1 to n
    integer, intent(out) :: line                 !< of the deck; 0: none
    logical, intent(out) :: is_warning
    character(:), allocatable, intent(out) :: text
    line = self%items(i)%line
    is_warning = self%items(i)%is_warning
    text = self%items(i)%text
  end subroutine get_message


  !> Hands the remarks over in the order of the deck, with file, line and the line as written. Of very many errors the
  !! first ones are listed and the others counted.
  subroutine publish_messages(cards, messages, diagnostics)
    type(cards_type), intent(in) :: cards
    type(deck_messages_type), intent(in) :: messages
    type(diagnostic_list_type), intent(inout) :: diagnostics
    integer, allocatable :: lines(:), order(:)
    integer :: i, n_listed
    if (messages%n == 0) return
    lines = [(merge(messages%items(i)%line, huge(i), messages%items(i)%line > 0), i=1, messages%n)]
    order = [(i, i=1, messages%n)]
    call sort_integers(lines, order)
    n_listed = 0
    do i = 1, messages%n
      associate (message => messages%items(order(i)))
        if (.not. message%is_warning) n_listed = n_listed + 1
        if (n_listed > MAX_LISTED_ERRORS) exit
        call publish_message(cards, message, diagnostics)
      end associate
    end do
    if (n_listed > MAX_LISTED_ERRORS) call diagnostics%add('', 0, '', 'More errors follow; only the first ' // &
      to_text(MAX_LISTED_ERRORS) // ' are listed.')
    diagnostics%n_errors = max(diagnostics%n_errors, messages%n_errors)
  end subroutine publish_messages


  !> A line as written in the deck: cards converted to comments by the reader are restored.
  pure function original_line(line) result(text)
    character(*), intent(in) :: line
    character(:), allocatable :: text
    text = line
    if (index(line, '** *') == 1) text = line(4:)
  end function original_line


  !> Publishes one message, with the chain of includes that leads to its line.
  subroutine publish_message(cards, message, diagnostics)
    type(cards_type), intent(in) :: cards
    type(deck_message_type), intent(in) :: message
    type(diagnostic_list_type), intent(inout) :: diagnostics
    character(:), allocatable :: text
    integer :: file
    if (message%line == 0) then
      call diagnostics%add(cards%files(1)%path, 0, '', message%text, message%is_warning)
      return
    end if
    text = message%text
    file = cards%line_file(message%line)
    do while (cards%files(file)%parent > 0)
      text = text // ' (included from ' // cards%files(cards%files(file)%parent)%path // ', line ' // &
        to_text(cards%files(file)%parent_line) // ')'
      file = cards%files(file)%parent
    end do
    call diagnostics%add(cards%files(cards%line_file(message%line))%path, cards%line_number(message%line), &
      original_line(line_text(cards, message%line)), text, message%is_warning)
  end subroutine publish_message

end module amontons_cards
