!> Card form: what an entry of the card table looks like, and how a card of a deck is compared with it.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_card_schema
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, remarks_type
  use amontons_containers, only: name_table_type, letters_apart
  use amontons_text, only: squeezed, count_words, nth_word, is_one_of, joined_words, parse_integer, parse_real, NUMBER_OK, &
    NEWLINE
  implicit none
  private
  public :: card_table_type, card_entry_type, option_type, find_entry, match_parameters, render_table, hint_at_cards
  public :: has_parameter, parameter_text, parameter_word
  public :: IN_MODEL, IN_STEP, IN_BOTH, STATUS_USED, STATUS_NOTED, STATUS_REFUSED
  public :: VALUE_NONE, VALUE_NAME, VALUE_TEXT, VALUE_INTEGER, VALUE_REAL, VALUE_WORD, VALUE_OPTIONAL_WORD, VALUE_OPTIONAL_REAL

  integer, parameter :: IN_MODEL = 1, IN_STEP = 2, IN_BOTH = 3        !< where a card may stand
  integer, parameter :: STATUS_USED = 1         !< read and obeyed
  integer, parameter :: STATUS_NOTED = 2        !< cannot change the solution: read past, with a note
  integer, parameter :: STATUS_REFUSED = 3      !< an error with its own message
  integer, parameter :: VALUE_NONE = 0          !< stands alone
  integer, parameter :: VALUE_NAME = 1          !< name of a set, surface, ...
  integer, parameter :: VALUE_TEXT = 2          !< anything
  integer, parameter :: VALUE_INTEGER = 3
  integer, parameter :: VALUE_REAL = 4
  integer, parameter :: VALUE_WORD = 5          !< one of a list
  integer, parameter :: VALUE_OPTIONAL_WORD = 6 !< alone, or one of a list
  integer, parameter :: VALUE_OPTIONAL_REAL = 7 !< alone, or a number

  integer, parameter :: SHORTEST_ABBREVIATION = 3

  !> One parameter of a card.
  type :: option_type
    character(:), allocatable :: name           !< as printed: 'PRESSURE-OVERCLOSURE'
    integer :: kind = VALUE_NONE                !< VALUE_...
    integer :: status = STATUS_USED
    character(:), allocatable :: allowed        !< words separated by |
    character(:), allocatable :: refused        !< words that get the message
    character(:), allocatable :: default        !< 'required', or what holds without it
    character(:), allocatable :: sentence       !< what it does; for refused ones the message
    character(:), allocatable :: message        !< for refused words
  end type option_type

  !> One card.
  type :: card_entry_type
    character(:), allocatable :: keyword        !< as printed: 'END STEP'
    character(:), allocatable :: key            !< squeezed: 'ENDSTEP'
    integer :: where = IN_MODEL                 !< IN_...
    character(:), allocatable :: parent         !< key of the card whose block it belongs to; empty if none
    integer :: status = STATUS_USED
    character(:), allocatable :: sentence       !< what it does; for refused ones the message
    character(:), allocatable :: data           !< its data lines in words; empty: it has none
    character(:), allocatable :: dialects       !< where the two dialects differ; empty: nowhere
    integer :: n_options = 0
    type(option_type), allocatable :: options(:)
  end type card_entry_type

  !> All cards.
  type :: card_table_type
    integer :: n = 0
    type(card_entry_type), allocatable :: entries(:)
    type(name_table_type), private :: names
  contains
    procedure :: card => add_card
    procedure :: cards_with => add_cards_with
    procedure :: option => add_option
    procedure :: refuse_words
    procedure :: differ
  end type card_table_type

contains

  !> Adds a card; the options that follow belong to it.
  subroutine add_card(self, keyword, where, sentence, data, parent, status)
    class(card_table_type), intent(inout) :: self
    character(*), intent(in) :: keyword
    integer, intent(in) :: where                 !< IN_...
    character(*), intent(in) :: sentence
    character(*), intent(in), optional :: data   !< data lines in words; absent: none
    character(*), intent(in), optional :: parent !< keyword of the card whose block it belongs to
    integer, intent(in), optional :: status      !< default STATUS_USED
    type(card_entry_type), allocatable :: larger(:)
    integer :: position
    logical :: is_new
    if (.not. allocated(self%entries)) allocate (self%entries(256))
    call self%names%add(keyword, position, is_new)
    if (.not. is_new) return
    if (self%n == size(self%entries)) then
      allocate (larger(2 * self%n))
      larger(:self%n) = self%entries
      call move_alloc(larger, self%entries)
    end if
    self%n = self%n + 1
    associate (entry => self%entries(self%n))
      entry%keyword = keyword
      entry%key = squeezed(keyword)
      entry%where = where
      entry%sentence = sentence
      entry%data = ''
      if (present(data)) entry%data = data
      entry%dialects = ''
      entry%parent = ''
      if (present(parent)) entry%parent = squeezed(parent)
      if (present(status)) entry%status = status
      allocate (entry%options(0))
    end associate
  end subroutine add_card


  !> Says of the last card where the two dialects differ.
  subroutine differ(self, sentence)
    class(card_table_type), intent(inout) :: self
    character(*), intent(in) :: sentence
    self%entries(self%n)%dialects = sentence
  end subroutine differ


  !> Adds several cards that share status and message.
  subroutine add_cards_with(self, status, keywords, sentence)
    class(card_table_type), intent(inout) :: self
    integer, intent(in) :: status                !< STATUS_NOTED or STATUS_REFUSED
    character(*), intent(in) :: keywords         !< separated by |
    character(*), intent(in) :: sentence
    integer :: i
    do i = 1, count_words(keywords)
      call self%card(nth_word(keywords, i), IN_BOTH, sentence, data='anything', status=status)
    end do
  end subroutine add_cards_with


  !> Adds a parameter to the last card.
  subroutine add_option(self, name, kind, sentence, allowed, default, status)
    class(card_table_type), intent(inout) :: self
    character(*), intent(in) :: name             !< one name, or several separated by | that share all the rest
    integer, intent(in) :: kind                  !< VALUE_...
    character(*), intent(in) :: sentence
    character(*), intent(in), optional :: allowed   !< words separated by |
    character(*), intent(in), optional :: default   !< 'required', or what holds without it
    integer, intent(in), optional :: status      !< default STATUS_USED
    type(option_type) :: option
    integer :: i
    option%kind = kind
    option%sentence = sentence
    option%allowed = ''
    if (present(allowed)) option%allowed = allowed
    option%default = ''
    if (present(default)) option%default = default
    if (present(status)) option%status = status
    option%refused = ''
    option%message = ''
    do i = 1, count_words(name)
      option%name = nth_word(name, i)
      self%entries(self%n)%options = [self%entries(self%n)%options, option]
      self%entries(self%n)%n_options = self%entries(self%n)%n_options + 1
    end do
  end subroutine add_option


  !> Names values of the last parameter that exist in other programs but not here.
  subroutine refuse_words(self, words, message)
    class(card_table_type), intent(inout) :: self
    character(*), intent(in) :: words            !< separated by |
    character(*), intent(in) :: message
    associate (entry => self%entries(self%n))
      entry%options(entry%n_options)%refused = words
      entry%options(entry%n_options)%message = message
    end associate
  end subroutine refuse_words


  !> The entry of a keyword: exact, or the only one that it abbreviates; 0 if there is none.
  subroutine find_entry(table, key, position, is_abbreviated)
    type(card_table_type), intent(in) :: table
    character(*), intent(in) :: key              !< squeezed keyword
    integer, intent(out) :: position
    logical, intent(out) :: is_abbreviated
    integer :: i
    is_abbreviated = .false.
    position = table%names%find(key)
    if (position > 0 .or. len(key) < SHORTEST_ABBREVIATION) return
    do i = 1, table%n
      if (.not. starts_with(table%entries(i)%key, key)) cycle
      is_abbreviated = position == 0
      if (position > 0) exit
      position = i
    end do
    if (.not. is_abbreviated) position = 0
  end subroutine find_entry


  !> Whether a word starts with another one.
  pure function starts_with(word, beginning) result(does_so)
    character(*), intent(in) :: word, beginning
    logical :: does_so
    does_so = len(word) >= len(beginning)
    if (does_so) does_so = word(:len(beginning)) == beginning
  end function starts_with


  !> Compares the parameters of a card with its entry: expands abbreviations in place and, if remarks are wanted, tells
  !! unknown, doubled, missing, refused ones and wrong values.
  subroutine match_parameters(entry, parameters, line, is_lenient, remarks)
    type(card_entry_type), intent(in) :: entry
    type(parameter_type), intent(inout) :: parameters(:)
    integer, intent(in) :: line                  !< line of the card
    logical, intent(in) :: is_lenient            !< an unknown parameter is a note only, as in CalculiX
    type(remarks_type), intent(inout), optional :: remarks
    type(remarks_type) :: ignored
    integer :: i, position
    logical :: is_abbreviated
    if (.not. present(remarks)) then
      do i = 1, size(parameters)
        call find_option(entry, parameters(i)%key, position, is_abbreviated)
        if (position > 0) call expand_parameter(entry%options(position), parameters(i), line, ignored)
      end do
      return
    end if
    do i = 1, size(parameters)
      call find_option(entry, parameters(i)%key, position, is_abbreviated)
      if (position == 0) then
        call remarks%add(line, unknown_parameter(entry, parameters(i)%key), is_warning=is_lenient)
        cycle
      end if
      if (is_abbreviated) call remarks%add(line, 'The parameter ' // parameters(i)%key // ' is taken as ' // &
        entry%options(position)%name // '; abbreviations are better written out.', is_warning=.true.)
      call expand_parameter(entry%options(position), parameters(i), line, remarks)
      call check_value(entry, entry%options(position), parameters(i), line, remarks)
      if (any([(parameters(position)%key == parameters(i)%key, position=1, i - 1)])) call remarks%add(line, &
        'The parameter ' // parameters(i)%key // ' stands twice on this card.')
    end do
    call check_required(entry, parameters, line, remarks)
  end subroutine match_parameters


  !> The option of a name: exact, or the only one that it abbreviates, or the first of those if the others begin with it; 0 if there
  !! is none.
  subroutine find_option(entry, key, position, is_abbreviated)
    type(card_entry_type), intent(in) :: entry
    character(*), intent(in) :: key
    integer, intent(out) :: position
    logical, intent(out) :: is_abbreviated
    integer :: i
    is_abbreviated = .false.
    do position = 1, entry%n_options
      if (squeezed(entry%options(position)%name) == key) return
    end do
    position = 0
    if (len(key) < SHORTEST_ABBREVIATION) return
    do i = 1, entry%n_options
      if (.not. starts_with(squeezed(entry%options(i)%name), key)) cycle
      if (position > 0) then
        if (starts_with(squeezed(entry%options(i)%name), squeezed(entry%options(position)%name))) cycle   ! FREQUENCYF
      end if
      is_abbreviated = position == 0
      if (position > 0) exit
      position = i
    end do
    if (.not. is_abbreviated) position = 0
  end subroutine find_option


  !> Puts the full name of a parameter, and of its value where that is an abbreviated word of a list.
  subroutine expand_parameter(option, parameter, line, remarks)
    type(option_type), intent(in) :: option
    type(parameter_type), intent(inout) :: parameter
    integer, intent(in) :: line
    type(remarks_type), intent(inout) :: remarks
    character(:), allocatable :: words, word
    integer :: i, n_found
    parameter%key = squeezed(option%name)
    if (option%kind /= VALUE_WORD .and. option%kind /= VALUE_OPTIONAL_WORD) return
    words = option%allowed
    if (option%refused /= '') words = words // '|' // option%refused
    if (parameter%text == '' .or. is_one_of(parameter%text, words)) return
    n_found = 0
    word = ''
    do i = 1, count_words(words)
      if (.not. starts_with(squeezed(nth_word(words, i)), squeezed(parameter%text))) cycle
      n_found = n_found + 1
      word = nth_word(words, i)
    end do
    if (n_found /= 1 .or. len(squeezed(parameter%text)) < SHORTEST_ABBREVIATION) return
    call remarks%add(line, 'The value ' // parameter%text // ' of ' // option%name // ' is taken as ' // word // &
      '; abbreviations are better written out.', is_warning=.true.)
    parameter%text = word
  end subroutine expand_parameter


  !> Tells a parameter that is noted or refused, and a value that does not fit.
  subroutine check_value(entry, option, parameter, line, remarks)
    type(card_entry_type), intent(in) :: entry
    type(option_type), intent(in) :: option
    type(parameter_type), intent(in) :: parameter
    integer, intent(in) :: line
    type(remarks_type), intent(inout) :: remarks
    integer :: status, whole
    real(DP) :: number
    if (option%status == STATUS_REFUSED) then
      call remarks%add(line, 'The parameter ' // option%name // ' of *' // entry%keyword // ' is not supported. ' // &
        option%sentence)
      return
    else if (option%status == STATUS_NOTED) then
      if (option%sentence /= '') call remarks%add(line, 'The parameter ' // option%name // ' has no effect. ' // &
        option%sentence, is_warning=.true.)
      return
    end if
    status = NUMBER_OK
    if (option%kind == VALUE_NONE) then
      if (parameter%has_value) call remarks%add(line, 'The parameter ' // option%name // ' takes no value.')
      return
    else if (parameter%text == '') then
      if (.not. any(option%kind == [VALUE_OPTIONAL_WORD, VALUE_OPTIONAL_REAL])) &
        call remarks%add(line, 'The parameter ' // option%name // &
        ' needs a value: ' // form_of(option) // '.')
      return
    end if
    if (option%kind == VALUE_INTEGER) call parse_integer(parameter%text, whole, status)
    if (any(option%kind == [VALUE_REAL, VALUE_OPTIONAL_REAL])) call parse_real(parameter%text, number, status)
    if (status /= NUMBER_OK) call remarks%add(line, 'The value ' // parameter%text // ' of ' // option%name // &
      ' is not a number of the form ' // form_of(option) // '.')
    if (option%kind == VALUE_WORD .or. option%kind == VALUE_OPTIONAL_WORD) call check_word(option, parameter, line, &
      remarks)
  end subroutine check_value


  !> Tells a word that is not in the list.
  subroutine check_word(option, parameter, line, remarks)
    type(option_type), intent(in) :: option
    type(parameter_type), intent(in) :: parameter
    integer, intent(in) :: line
    type(remarks_type), intent(inout) :: remarks
    if (is_one_of(parameter%text, option%allowed)) return
    if (is_one_of(parameter%text, option%refused)) then
      call remarks%add(line, option%name // '=' // parameter%text // ' is not supported. ' // option%message)
    else
      call remarks%add(line, 'The value ' // parameter%text // ' of ' // option%name // ' is not known; allowed is ' &
        // joined_words(option%allowed) // '.')
    end if
  end subroutine check_word


  !> Tells required parameters that are missing.
  subroutine check_required(entry, parameters, line, remarks)
    type(card_entry_type), intent(in) :: entry
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(in) :: line
    type(remarks_type), intent(inout) :: remarks
    integer :: i
    do i = 1, entry%n_options
      associate (option => entry%options(i))
        if (option%default /= 'required') cycle
        if (has_parameter(parameters, option%name)) cycle
        call remarks%add(line, 'The card *' // entry%keyword // ' needs the parameter ' // form_of(option) // '.')
      end associate
    end do
  end subroutine check_required


  !> How the sentence about a card that is not known ends: with the one that was meant, if one is near, or with the comma that is
  !! missing after it (*ELEMENT TYPE=C3D8).
  function hint_at_cards(table, key) result(text)
    type(card_table_type), intent(in) :: table
    character(*), intent(in) :: key
    character(:), allocatable :: text
    character(*), parameter :: ASKED = '; did you mean '
    integer :: i, begun
    begun = 0
    do i = 1, table%n
      if (index(key, '=') == 0 .or. .not. starts_with(key, table%entries(i)%key)) cycle
      if (len(table%entries(i)%key) > begun) begun = len(table%entries(i)%key)
      if (len(table%entries(i)%key) == begun) text = '; a comma is missing after *' // table%entries(i)%keyword // '.'
    end do
    if (begun > 0) return
    text = table%names%hint(key)
    if (index(text, ASKED) /= 1) then
      text = '.'
      return
    end if
    do i = 1, table%n
      if (text(len(ASKED) + 1:) /= table%entries(i)%key // '?') cycle
      text = ASKED // '*' // table%entries(i)%keyword // '?'
      return
    end do
  end function hint_at_cards


  !> The message for a parameter that the card does not have.
  function unknown_parameter(entry, key) result(text)
    type(card_entry_type), intent(in) :: entry
    character(*), intent(in) :: key
    character(:), allocatable :: text, list
    integer :: i
    list = ''
    do i = 1, entry%n_options
      if (entry%options(i)%status /= STATUS_USED) cycle
      if (list /= '') list = list // '|'
      list = list // form_of(entry%options(i))
    end do
    text = 'The card *' // entry%keyword // ' has no parameter ' // key
    do i = 1, entry%n_options
      if (entry%options(i)%status == STATUS_USED .and. letters_apart(key, trim(entry%options(i)%name)) <= max(1, len(key) / 3)) &
        text = text // ' (did you mean ' // trim(entry%options(i)%name) // '?)'
    end do
    if (list == '') then
      text = text // '; it takes none.'
    else
      text = text // '; allowed is ' // joined_words(list) // '.'
    end if
  end function unknown_parameter


  !> A parameter as it is written: NSET=name, DIRECT, OP=MOD/NEW.
  function form_of(option) result(text)
    type(option_type), intent(in) :: option
    character(:), allocatable :: text, words
    integer :: i
    words = option%allowed
    do i = 1, len(words)
      if (words(i:i) == '|') words(i:i) = '/'
    end do
    select case (option%kind)
    case (VALUE_NAME)
      text = option%name // '=name'
    case (VALUE_TEXT)
      text = option%name // '=text'
    case (VALUE_INTEGER)
      text = option%name // '=integer'
    case (VALUE_REAL)
      text = option%name // '=real'
    case (VALUE_WORD)
      text = option%name // '=' // words
    case (VALUE_OPTIONAL_WORD)
      text = option%name // '[=' // words // ']'
    case (VALUE_OPTIONAL_REAL)
      text = option%name // '[=real]'
    case default
      text = option%name
    end select
  end function form_of


  !> Whether a parameter is given (names matched, see match_parameters).
  pure function has_parameter(parameters, name) result(is_given)
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name
    logical :: is_given
    integer :: i
    is_given = .true.
    do i = 1, size(parameters)
      if (parameters(i)%key == squeezed(name)) return
    end do
    is_given = .false.
  end function has_parameter


  !> The value of a parameter as written; empty if it is not given.
  pure function parameter_text(parameters, name) result(text)
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(parameters)
      if (parameters(i)%key == squeezed(name)) text = parameters(i)%text
    end do
  end function parameter_text


  !> The value of a parameter squeezed; the default if it is not given.
  pure function parameter_word(parameters, name, default) result(word)
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name
    character(*), intent(in) :: default          !< squeezed
    character(:), allocatable :: word
    word = squeezed(parameter_text(parameters, name))
    if (word == '') word = default
  end function parameter_word


  !> The whole table as text for a person.
  subroutine render_table(table, text)
    type(card_table_type), intent(in) :: table
    character(:), allocatable, intent(out) :: text
    character(:), allocatable :: last
    integer :: i
    text = ''
    do i = 1, table%n
      if (table%entries(i)%status == STATUS_USED) call render_card(table, table%entries(i), text)
    end do
    text = text // 'Cards read past with a note, because they cannot change the solution:' // NEWLINE
    last = ''
    do i = 1, table%n
      if (table%entries(i)%status == STATUS_NOTED) call render_line(table%entries(i), last, text)
    end do
    text = text // NEWLINE // 'Cards refused with a message:' // NEWLINE
    last = ''
    do i = 1, table%n
      if (table%entries(i)%status == STATUS_REFUSED) call render_line(table%entries(i), last, text)
    end do
  end subroutine render_table


  !> One card that is read and obeyed.
  subroutine render_card(table, entry, text)
    type(card_table_type), intent(in) :: table
    type(card_entry_type), intent(in) :: entry
    character(:), allocatable, intent(inout) :: text
    character(*), parameter :: PLACES(3) = ['in the model        ', 'in a step           ', 'in the model or step']
    integer :: i
    text = text // '*' // entry%keyword // '  (' // trim(PLACES(entry%where))
    i = table%names%find(entry%parent)
    if (i > 0) text = text // ', after *' // table%entries(i)%keyword
    text = text // ')' // NEWLINE // '    ' // entry%sentence // NEWLINE
    do i = 1, entry%n_options
      call render_option(entry%options(i), text)
    end do
    if (entry%data /= '') text = text // '    data lines: ' // entry%data // NEWLINE
    if (entry%dialects /= '') text = text // '    dialects: ' // entry%dialects // NEWLINE
    text = text // NEWLINE
  end subroutine render_card


  !> One parameter.
  subroutine render_option(option, text)
    type(option_type), intent(in) :: option
    character(:), allocatable, intent(inout) :: text
    text = text // '    ' // form_of(option)
    if (option%default == 'required') then
      text = text // ' (required)'
    else if (option%default /= '') then
      text = text // ' (default ' // option%default // ')'
    end if
    if (option%status == STATUS_NOTED) text = text // ': no effect.'
    if (option%status == STATUS_REFUSED) text = text // ': refused.'
    if (option%status == STATUS_USED) text = text // ':'
    if (option%sentence /= '') text = text // ' ' // option%sentence
    if (option%refused /= '') text = text // ' Refused: ' // joined_words(option%refused) // '. ' // option%message
    text = text // NEWLINE
  end subroutine render_option


  !> One card that is noted or refused; those that share a sentence share a paragraph.
  subroutine render_line(entry, last, text)
    type(card_entry_type), intent(in) :: entry
    character(:), allocatable, intent(inout) :: last   !< sentence of the card before
    character(:), allocatable, intent(inout) :: text
    if (entry%sentence /= last) text = text // entry%sentence // NEWLINE
    text = text // '    *' // entry%keyword // NEWLINE
    last = entry%sentence
  end subroutine render_line

end module amontons_card_schema
