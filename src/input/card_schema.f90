!> Schema of keyword cards and the check of parameters against it.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_card_schema
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, deck_messages_type
  use amontons_containers, only: name_table_type, edit_distance
  use amontons_text, only: name_key, count_words, nth_word, is_one_of, joined_words, parse_integer, parse_real, NUMBER_OK, &
    NEWLINE
  implicit none
  private
  public :: card_table_type, card_entry_type, parameter_schema_type, find_entry, match_parameters, render_card_table, suggest_card
  public :: describe_field_variables
  public :: has_parameter, parameter_text, parameter_word, list_parameters
  public :: SCOPE_MODEL, SCOPE_STEP, SCOPE_BOTH, ENTRY_SUPPORTED, ENTRY_IGNORED, ENTRY_REJECTED
  public :: VALUE_NONE, VALUE_NAME, VALUE_TEXT, VALUE_INTEGER, VALUE_REAL, VALUE_WORD, VALUE_OPTIONAL_WORD, VALUE_OPTIONAL_REAL

  integer, parameter :: SCOPE_MODEL = 1, SCOPE_STEP = 2, SCOPE_BOTH = 3        !< where a card is allowed
  integer, parameter :: ENTRY_SUPPORTED = 1         !< read and obeyed
  integer, parameter :: ENTRY_IGNORED = 2        !< cannot change the solution: read past, with a note
  integer, parameter :: ENTRY_REJECTED = 3      !< an error with its own message
  integer, parameter :: VALUE_NONE = 0          !< without value
  integer, parameter :: VALUE_NAME = 1          !< name of a set, surface, ...
  integer, parameter :: VALUE_TEXT = 2          !< anything
  integer, parameter :: VALUE_INTEGER = 3
  integer, parameter :: VALUE_REAL = 4
  integer, parameter :: VALUE_WORD = 5          !< one of a list
  integer, parameter :: VALUE_OPTIONAL_WORD = 6 !< alone, or one of a list
  integer, parameter :: VALUE_OPTIONAL_REAL = 7 !< alone, or a number

  integer, parameter :: MIN_ABBREVIATION_LENGTH = 3

  !> One parameter of a card.
  type :: parameter_schema_type
    character(:), allocatable :: name           !< as printed: 'PRESSURE-OVERCLOSURE'
    integer :: kind = VALUE_NONE                !< VALUE_...
    integer :: status = ENTRY_SUPPORTED
    character(:), allocatable :: allowed        !< words separated by |
    character(:), allocatable :: refused        !< words rejected with the message
    character(:), allocatable :: default        !< 'required', or the value by default
    character(:), allocatable :: description       !< what it does; for rejected ones the message
    character(:), allocatable :: message        !< for rejected words
  end type parameter_schema_type

  !> One card.
  type :: card_entry_type
    character(:), allocatable :: keyword        !< as printed: 'END STEP'
    character(:), allocatable :: key            !< squeezed: 'ENDSTEP'
    integer :: scope = SCOPE_MODEL                 !< IN_...
    character(:), allocatable :: parent         !< keys of the cards whose blocks it belongs to, separated by |; empty: none
    integer :: status = ENTRY_SUPPORTED
    character(:), allocatable :: description       !< what it does; for rejected ones the message
    character(:), allocatable :: data           !< its data lines in words; empty: no data lines
    character(:), allocatable :: dialects       !< where the two dialects differ; empty: nowhere
    integer :: n_options = 0
    type(parameter_schema_type), allocatable :: options(:)
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
    procedure :: reject_words
    procedure :: add_dialect_note
  end type card_table_type

contains

  !> Adds a card; the following options belong to it.
  subroutine add_card(self, keyword, where, sentence, data, parent, status)
    class(card_table_type), intent(inout) :: self
    character(*), intent(in) :: keyword
    integer, intent(in) :: where                 !< IN_...
    character(*), intent(in) :: sentence
    character(*), intent(in), optional :: data   !< data lines in words; absent: none
    character(*), intent(in), optional :: parent !< keywords of the cards whose blocks it belongs to, separated by |
    integer, intent(in), optional :: status      !< default ENTRY_SUPPORTED
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
      entry%key = name_key(keyword)
      entry%scope = where
      entry%description = sentence
      entry%data = ''
      if (present(data)) entry%data = data
      entry%dialects = ''
      entry%parent = ''
      if (present(parent)) entry%parent = name_key(parent)
      if (present(status)) entry%status = status
      allocate (entry%options(0))
    end associate
  end subroutine add_card


  !> Adds the difference between the two dialects to the last card.
  subroutine add_dialect_note(self, sentence)
    class(card_table_type), intent(inout) :: self
    character(*), intent(in) :: sentence
    self%entries(self%n)%dialects = sentence
  end subroutine add_dialect_note


  !> Adds several cards that share status and message.
  subroutine add_cards_with(self, status, keywords, sentence)
    class(card_table_type), intent(inout) :: self
    integer, intent(in) :: status                !< ENTRY_IGNORED or ENTRY_REJECTED
    character(*), intent(in) :: keywords         !< separated by |
    character(*), intent(in) :: sentence
    integer :: i
    do i = 1, count_words(keywords)
      call self%card(nth_word(keywords, i), SCOPE_BOTH, sentence, data='anything', status=status)
    end do
  end subroutine add_cards_with


  !> Adds a parameter to the last card.
  subroutine add_option(self, name, kind, sentence, allowed, default, status)
    class(card_table_type), intent(inout) :: self
    character(*), intent(in) :: name             !< one name, or several separated by | that share all the rest
    integer, intent(in) :: kind                  !< VALUE_...
    character(*), intent(in) :: sentence
    character(*), intent(in), optional :: allowed   !< words separated by |
    character(*), intent(in), optional :: default   !< 'required', or the value by default
    integer, intent(in), optional :: status      !< default ENTRY_SUPPORTED
    type(parameter_schema_type) :: option
    integer :: i
    option%kind = kind
    option%description = sentence
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


  !> Rejects values of the last parameter that exist in other programs but not here.
  subroutine reject_words(self, words, message)
    class(card_table_type), intent(inout) :: self
    character(*), intent(in) :: words            !< separated by |
    character(*), intent(in) :: message
    associate (entry => self%entries(self%n))
      entry%options(entry%n_options)%refused = words
      entry%options(entry%n_options)%message = message
    end associate
  end subroutine reject_words


  !> DEPENDENCIES of a card whose tables may be over a field variable.
  subroutine describe_field_variables(table)
    type(card_table_type), intent(inout) :: table
    call table%option('DEPENDENCIES', VALUE_INTEGER, 'Number of field variables behind the temperature; one column may ' // &
      'change in a table.', default='0')
  end subroutine describe_field_variables


  !> The names of all cards and parameters, 'STEP,' and 'STEP,NLGEOM', to distinguish continuations of keyword lines from data.
  subroutine list_parameters(table, names)
    type(card_table_type), intent(in) :: table
    type(name_table_type), intent(out) :: names
    integer :: i, k, position
    logical :: is_new
    do i = 1, table%n
      call names%add(table%entries(i)%key // ',', position, is_new)
      do k = 1, table%entries(i)%n_options
        call names%add(table%entries(i)%key // ',' // table%entries(i)%options(k)%name, position, is_new)
      end do
    end do
  end subroutine list_parameters


  !> The entry of a keyword: exact, or its unique abbreviation; 0: unknown keyword.
  subroutine find_entry(table, key, position, is_abbreviated)
    type(card_table_type), intent(in) :: table
    character(*), intent(in) :: key              !< squeezed keyword
    integer, intent(out) :: position
    logical, intent(out) :: is_abbreviated
    integer :: i
    is_abbreviated = .false.
    position = table%names%find(key)
    if (position > 0 .or. len(key) < MIN_ABBREVIATION_LENGTH) return
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


  !> Compares the parameters of a card with its entry: expands abbreviations in place and, if messages are requested, reports
  !! unknown, duplicate, missing and rejected ones and wrong values.
  subroutine match_parameters(entry, parameters, line, is_lenient, messages)
    type(card_entry_type), intent(in) :: entry
    type(parameter_type), intent(inout) :: parameters(:)
    integer, intent(in) :: line                  !< line of the card
    logical, intent(in) :: is_lenient            !< an unknown parameter is a note only, as in CalculiX
    type(deck_messages_type), intent(inout), optional :: messages
    type(deck_messages_type) :: ignored
    integer :: i, position
    logical :: is_abbreviated
    if (.not. present(messages)) then
      do i = 1, size(parameters)
        call find_option(entry, parameters(i)%key, position, is_abbreviated)
        if (position > 0) call expand_parameter(entry%options(position), parameters(i), line, ignored)
      end do
      return
    end if
    do i = 1, size(parameters)
      call find_option(entry, parameters(i)%key, position, is_abbreviated)
      if (position == 0) then
        call messages%add(line, unknown_parameter_text(entry, parameters(i)%key), is_warning=is_lenient)
        cycle
      end if
      if (is_abbreviated) call messages%add(line, 'The parameter ' // parameters(i)%key // ' is taken as ' // &
        entry%options(position)%name // '; abbreviations are better written out.', is_warning=.true.)
      call expand_parameter(entry%options(position), parameters(i), line, messages)
      call check_value(entry, entry%options(position), parameters(i), line, messages)
      if (any([(parameters(position)%key == parameters(i)%key, position=1, i - 1)])) call messages%add(line, &
        'The parameter ' // parameters(i)%key // ' appears twice on this card.')
    end do
    call check_required(entry, parameters, line, messages)
  end subroutine match_parameters


  !> The option of a name: exact, or its unique abbreviation, or the first of those if the others begin with it; 0: unknown
  !! name.
  subroutine find_option(entry, key, position, is_abbreviated)
    type(card_entry_type), intent(in) :: entry
    character(*), intent(in) :: key
    integer, intent(out) :: position
    logical, intent(out) :: is_abbreviated
    integer :: i
    is_abbreviated = .false.
    do position = 1, entry%n_options
      if (name_key(entry%options(position)%name) == key) return
    end do
    position = 0
    if (len(key) < MIN_ABBREVIATION_LENGTH) return
    do i = 1, entry%n_options
      if (.not. starts_with(name_key(entry%options(i)%name), key)) cycle
      if (position > 0) then
        if (starts_with(name_key(entry%options(i)%name), name_key(entry%options(position)%name))) cycle   ! FREQUENCYF
      end if
      is_abbreviated = position == 0
      if (position > 0) exit
      position = i
    end do
    if (.not. is_abbreviated) position = 0
  end subroutine find_option


  !> Expands the name of a parameter, and its value if that abbreviates a word of a list.
  subroutine expand_parameter(option, parameter, line, messages)
    type(parameter_schema_type), intent(in) :: option
    type(parameter_type), intent(inout) :: parameter
    integer, intent(in) :: line
    type(deck_messages_type), intent(inout) :: messages
    character(:), allocatable :: words, word
    integer :: i, n_found
    parameter%key = name_key(option%name)
    if (option%kind /= VALUE_WORD .and. option%kind /= VALUE_OPTIONAL_WORD) return
    words = option%allowed
    if (option%refused /= '') words = words // '|' // option%refused
    if (parameter%text == '' .or. is_one_of(parameter%text, words)) return
    n_found = 0
    word = ''
    do i = 1, count_words(words)
      if (.not. starts_with(name_key(nth_word(words, i)), name_key(parameter%text))) cycle
      n_found = n_found + 1
      word = nth_word(words, i)
    end do
    if (n_found /= 1 .or. len(name_key(parameter%text)) < MIN_ABBREVIATION_LENGTH) return
    call messages%add(line, 'The value ' // parameter%text // ' of ' // option%name // ' is taken as ' // word // &
      '; abbreviations are better written out.', is_warning=.true.)
    parameter%text = word
  end subroutine expand_parameter


  !> Reports a parameter that is noted or rejected, and an invalid value.
  subroutine check_value(entry, option, parameter, line, messages)
    type(card_entry_type), intent(in) :: entry
    type(parameter_schema_type), intent(in) :: option
    type(parameter_type), intent(in) :: parameter
    integer, intent(in) :: line
    type(deck_messages_type), intent(inout) :: messages
    integer :: status, whole
    real(DP) :: number
    if (option%status == ENTRY_REJECTED) then
      call messages%add(line, 'The parameter ' // option%name // ' of *' // entry%keyword // ' is not supported. ' // &
        option%description)
      return
    else if (option%status == ENTRY_IGNORED) then
      if (option%description /= '') call messages%add(line, 'The parameter ' // option%name // ' has no effect. ' // &
        option%description, is_warning=.true.)
      return
    end if
    status = NUMBER_OK
    if (option%kind == VALUE_NONE) then
      if (parameter%has_value) call messages%add(line, 'The parameter ' // option%name // ' takes no value.')
      return
    else if (parameter%text == '') then
      if (.not. any(option%kind == [VALUE_OPTIONAL_WORD, VALUE_OPTIONAL_REAL])) &
        call messages%add(line, 'The parameter ' // option%name // &
        ' needs a value: ' // parameter_syntax(option) // '.')
      return
    end if
    if (option%kind == VALUE_INTEGER) call parse_integer(parameter%text, whole, status)
    if (any(option%kind == [VALUE_REAL, VALUE_OPTIONAL_REAL])) call parse_real(parameter%text, number, status)
    if (status /= NUMBER_OK) call messages%add(line, 'The value ' // parameter%text // ' of ' // option%name // &
      ' is not a number of the form ' // parameter_syntax(option) // '.')
    if (option%kind == VALUE_WORD .or. option%kind == VALUE_OPTIONAL_WORD) call check_word(option, parameter, line, &
      messages)
  end subroutine check_value


  !> Reports a word that is not in the list.
  subroutine check_word(option, parameter, line, messages)
    type(parameter_schema_type), intent(in) :: option
    type(parameter_type), intent(in) :: parameter
    integer, intent(in) :: line
    type(deck_messages_type), intent(inout) :: messages
    if (is_one_of(parameter%text, option%allowed)) return
    if (is_one_of(parameter%text, option%refused)) then
      call messages%add(line, option%name // '=' // parameter%text // ' is not supported. ' // option%message)
    else
      call messages%add(line, 'The value ' // parameter%text // ' of ' // option%name // ' is not known; allowed is ' &
        // joined_words(option%allowed) // '.')
    end if
  end subroutine check_word


  !> Reports missing required parameters. A refused parameter may stand in place of one: then its message is enough.
  subroutine check_required(entry, parameters, line, messages)
    type(card_entry_type), intent(in) :: entry
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(in) :: line
    type(deck_messages_type), intent(inout) :: messages
    integer :: i
    if (any([(entry%options(i)%status == ENTRY_REJECTED .and. has_parameter(parameters, entry%options(i)%name), &
      i=1, entry%n_options)])) return
    do i = 1, entry%n_options
      associate (option => entry%options(i))
        if (option%default /= 'required') cycle
        if (has_parameter(parameters, option%name)) cycle
        call messages%add(line, 'The card *' // entry%keyword // ' needs the parameter ' // parameter_syntax(option) // '.')
      end associate
    end do
  end subroutine check_required


  !> How the sentence about a card that is not known ends: with the one that was meant, if one is near, or with the comma that is
  !! missing after it (*ELEMENT TYPE=C3D8).
  function suggest_card(table, key) result(text)
    type(card_table_type), intent(in) :: table
    character(*), intent(in) :: key
    character(:), allocatable :: text
    integer :: i, begun
    begun = 0
    do i = 1, table%n
      if (index(key, '=') == 0 .or. .not. starts_with(key, table%entries(i)%key)) cycle
      if (len(table%entries(i)%key) > begun) begun = len(table%entries(i)%key)
      if (len(table%entries(i)%key) == begun) text = '; a comma is missing after *' // table%entries(i)%keyword // '.'
    end do
    if (begun > 0) return
    i = table%names%nearest(key)
    text = '.'
    if (i > 0) text = '; did you mean *' // table%entries(i)%keyword // '?'
  end function suggest_card


  !> The message for a parameter that the card does not have.
  function unknown_parameter_text(entry, key) result(text)
    type(card_entry_type), intent(in) :: entry
    character(*), intent(in) :: key
    character(:), allocatable :: text, list
    integer :: i
    list = ''
    do i = 1, entry%n_options
      if (entry%options(i)%status /= ENTRY_SUPPORTED) cycle
      if (list /= '') list = list // '|'
      list = list // parameter_syntax(entry%options(i))
    end do
    text = 'The card *' // entry%keyword // ' has no parameter ' // key
    do i = 1, entry%n_options
      if (entry%options(i)%status == ENTRY_SUPPORTED .and. edit_distance(key, trim(entry%options(i)%name)) <= max(1, &
        len(key) / 3)) &
        text = text // ' (did you mean ' // trim(entry%options(i)%name) // '?)'
    end do
    if (list == '') then
      text = text // '; it takes none.'
    else
      text = text // '; allowed is ' // joined_words(list) // '.'
    end if
  end function unknown_parameter_text


  !> A parameter as it is written: NSET=name, DIRECT, OP=MOD/NEW.
  function parameter_syntax(option) result(text)
    type(parameter_schema_type), intent(in) :: option
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
  end function parameter_syntax


  !> Whether a parameter is given (names expanded, see match_parameters).
  pure function has_parameter(parameters, name) result(is_given)
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name
    logical :: is_given
    integer :: i
    is_given = .true.
    do i = 1, size(parameters)
      if (parameters(i)%key == name_key(name)) return
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
      if (parameters(i)%key == name_key(name)) text = parameters(i)%text
    end do
  end function parameter_text


  !> The value of a parameter squeezed; the default if it is not given.
  pure function parameter_word(parameters, name, default) result(word)
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name
    character(*), intent(in) :: default          !< squeezed
    character(:), allocatable :: word
    word = name_key(parameter_text(parameters, name))
    if (word == '') word = default
  end function parameter_word


  !> The whole table as readable text.
  subroutine render_card_table(table, text)
    type(card_table_type), intent(in) :: table
    character(:), allocatable, intent(out) :: text
    character(:), allocatable :: last
    integer :: i
    text = ''
    do i = 1, table%n
      if (table%entries(i)%status == ENTRY_SUPPORTED) call render_card(table, table%entries(i), text)
    end do
    text = text // 'Cards read past with a note, because they cannot change the solution:' // NEWLINE
    last = ''
    do i = 1, table%n
      if (table%entries(i)%status == ENTRY_IGNORED) call render_line(table%entries(i), last, text)
    end do
    text = text // NEWLINE // 'Cards refused with a message:' // NEWLINE
    last = ''
    do i = 1, table%n
      if (table%entries(i)%status == ENTRY_REJECTED) call render_line(table%entries(i), last, text)
    end do
  end subroutine render_card_table


  !> One supported card.
  subroutine render_card(table, entry, text)
    type(card_table_type), intent(in) :: table
    type(card_entry_type), intent(in) :: entry
    character(:), allocatable, intent(inout) :: text
    character(*), parameter :: SCOPE_TEXTS(3) = ['in the model        ', 'in a step           ', 'in the model or step']
    integer :: i, k
    text = text // '*' // entry%keyword // '  (' // trim(SCOPE_TEXTS(entry%scope))
    do k = 1, count_words(entry%parent)
      i = table%names%find(nth_word(entry%parent, k))
      if (i > 0) text = text // trim(merge(', after', ' or    ', k == 1)) // ' *' // table%entries(i)%keyword
    end do
    text = text // ')' // NEWLINE // '    ' // entry%description // NEWLINE
    do i = 1, entry%n_options
      call render_option(entry%options(i), text)
    end do
    if (entry%data /= '') text = text // '    data lines: ' // entry%data // NEWLINE
    if (entry%dialects /= '') text = text // '    dialects: ' // entry%dialects // NEWLINE
    text = text // NEWLINE
  end subroutine render_card


  !> One parameter.
  subroutine render_option(option, text)
    type(parameter_schema_type), intent(in) :: option
    character(:), allocatable, intent(inout) :: text
    text = text // '    ' // parameter_syntax(option)
    if (option%default == 'required') then
      text = text // ' (required)'
    else if (option%default /= '') then
      text = text // ' (default ' // option%default // ')'
    end if
    if (option%status == ENTRY_IGNORED) text = text // ': no effect.'
    if (option%status == ENTRY_REJECTED) text = text // ': refused.'
    if (option%status == ENTRY_SUPPORTED) text = text // ':'
    if (option%description /= '') text = text // ' ' // option%description
    if (option%refused /= '') text = text // ' Refused: ' // joined_words(option%refused) // '. ' // option%message
    text = text // NEWLINE
  end subroutine render_option


  !> One card that is noted or rejected; cards with the same sentence share a paragraph.
  subroutine render_line(entry, last, text)
    type(card_entry_type), intent(in) :: entry
    character(:), allocatable, intent(inout) :: last   !< sentence of the card before
    character(:), allocatable, intent(inout) :: text
    if (entry%description /= last) text = text // entry%description // NEWLINE
    text = text // '    *' // entry%keyword // NEWLINE
    last = entry%description
  end subroutine render_line

end module amontons_card_schema
