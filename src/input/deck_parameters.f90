!> PARAMETER: numbers with names, and their values in place of <name> in all later lines.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The substitution works on the text, before all other cards are read, line by line in the order of the deck: a line may name
!! earlier parameters only. Expressions are those of Python's arithmetic: + - * / **, parentheses, signs, functions of one number.
module amontons_deck_parameters
  use amontons_kinds, only: DP
  use amontons_cards, only: cards_type, parameter_type, deck_messages_type, start_deck_text, append_line, find_cards, line_text, &
    read_parameters
  use amontons_containers, only: name_table_type
  use amontons_text, only: name_key, parse_real, to_text, NUMBER_OK
  implicit none
  private
  public :: substitute_parameters

  integer, parameter :: MAX_EXACT_INTEGER = huge(1)     !< larger results are written as reals
  character(*), parameter :: LETTERS = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_'
  character(*), parameter :: DIGITS = '0123456789'
  character(5), parameter :: FUNCTIONS(*) = [character(5) :: 'sqrt', 'exp', 'log', 'log10', 'sin', 'cos', 'tan', 'asin', 'acos', &
    'atan', 'sinh', 'cosh', 'tanh', 'abs']

  !> A number of an expression.
  type :: value_type
    real(DP) :: number = 0
    logical :: is_integer = .true.               !< written without a decimal point
  end type value_type

  !> The parameters so far.
  type :: scope_type
    type(name_table_type) :: names
    type(value_type), allocatable :: values(:)
  end type scope_type

  !> An expression and the place in it.
  type :: expression_type
    character(:), allocatable :: text
    integer :: next = 1                          !< the next character
    character(:), allocatable :: trouble         !< what is wrong; empty: nothing
    character(:), allocatable :: note            !< what a reader may not expect; empty: nothing
  end type expression_type

contains

  !> Evaluates all PARAMETER cards and writes their values into the deck; a deck without them is unchanged.
  subroutine substitute_parameters(cards, messages)
    type(cards_type), intent(inout) :: cards
    type(deck_messages_type), intent(inout) :: messages
    type(cards_type) :: changed
    type(scope_type) :: scope
    integer :: c, line
    do c = 1, cards%n_cards
      if (cards%cards(c)%key == 'PARAMETER') exit
    end do
    if (c > cards%n_cards .or. messages%n_errors > 0) return
    call start_deck_text(changed)
    changed%files = cards%files
    allocate (scope%values(0))
    do line = 1, cards%cards(1)%line - 1
      call append_line(changed, line_text(cards, line), cards%line_file(line), cards%line_number(line))
    end do
    do c = 1, cards%n_cards
      if (cards%cards(c)%key == 'PARAMETER') call read_parameter_card(cards, c, scope, messages)
      call copy_card(cards, c, scope, messages, changed)
    end do
    if (messages%n_errors > 0) return             ! the old text stays, for the messages
    call find_cards(changed, cards%known_parameters)
    cards = changed
  end subroutine substitute_parameters


  !> The lines of a card with the values of the parameters; those of PARAMETER become comments.
  subroutine copy_card(cards, c, scope, messages, changed)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(scope_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(cards_type), intent(inout) :: changed
    character(:), allocatable :: text
    integer :: line
    do line = cards%cards(c)%line, cards%cards(c)%data_last
      text = line_text(cards, line)
      if (cards%cards(c)%key == 'PARAMETER') then
        text = '** ' // text
      else if (cards%cards(c)%key /= 'HEADING' .and. index(adjustl(text), '**') /= 1 .and. index(text, '<') > 0) then
        call write_values(line, scope, messages, text)
      end if
      call append_line(changed, text, cards%line_file(line), cards%line_number(line))
    end do
  end subroutine copy_card


  !> Replaces each <name> of a line.
  subroutine write_values(line, scope, messages, text)
    integer, intent(in) :: line
    type(scope_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    character(:), allocatable, intent(inout) :: text
    character(:), allocatable :: name
    integer :: first, last, position
    first = index(text, '<')
    do while (first > 0)
      last = first - 1 + index(text(first:), '>')
      if (last < first) then
        call messages%add(line, 'The name of a parameter ends with ''>'', which is missing here.')
        return
      end if
      name = text(first + 1:last - 1)
      position = scope%names%find(name)
      if (position == 0) then
        call messages%add(line, 'There is no parameter ''' // name // ''' before this line' // scope%names%suggest(name))
        return
      end if
      text = text(:first - 1) // value_text(scope%values(position)) // text(last + 1:)
      first = index(text, '<')
    end do
  end subroutine write_values


  !> A number as the deck takes it.
  pure function value_text(value) result(text)
    type(value_type), intent(in) :: value
    character(:), allocatable :: text
    character(26) :: buffer
    if (value%is_integer .and. abs(value%number) <= real(MAX_EXACT_INTEGER, DP)) then
      text = to_text(nint(value%number))
    else
      write (buffer, '(es24.16e3)') value%number
      text = trim(adjustl(buffer))
    end if
  end function value_text


  !> The lines `name = expression` of a PARAMETER card; semicolons part statements of one line.
  subroutine read_parameter_card(cards, c, scope, messages)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(scope_type), intent(inout) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: text
    integer :: line, last
    call read_parameters(cards, cards%cards(c), parameters)
    if (size(parameters) > 0) call messages%add(cards%cards(c)%line, 'The parameter ' // parameters(1)%key // ' of *PARAMETER ' // &
      'is not supported; its data lines are: name = expression.')
    do line = cards%cards(c)%data_first, cards%cards(c)%data_last
      text = line_text(cards, line)
      if (index(text, '#') > 0) text = text(:index(text, '#') - 1)
      if (index(adjustl(text), '**') == 1) cycle
      do while (name_key(text) /= '')              ! Python's statements: one line may have several
        last = index(text // ';', ';')
        if (name_key(text(:last - 1)) /= '') call define_parameter(text(:last - 1), line, scope, messages)
        text = text(min(last + 1, len(text) + 1):)
      end do
    end do
  end subroutine read_parameter_card


  !> One line `name = expression`.
  subroutine define_parameter(text, line, scope, messages)
    character(*), intent(in) :: text
    integer, intent(in) :: line
    type(scope_type), intent(inout) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(expression_type) :: expression
    type(value_type) :: value
    character(:), allocatable :: name
    integer :: equal, position
    logical :: is_new
    equal = index(text, '=')
    name = trim(adjustl(text(:max(equal - 1, 0))))
    if (name == '' .or. verify(name, LETTERS // DIGITS) > 0 .or. scan(name // ' ', LETTERS) /= 1) then
      call messages%add(line, 'A line of *PARAMETER is: name = expression, with a name of letters, digits and underscores.')
      return
    end if
    expression%text = text(equal + 1:)
    expression%trouble = ''
    expression%note = ''
    call evaluate_sum(scope, expression, value)
    call skip_blanks(expression)
    if (expression%trouble == '' .and. expression%next <= len(expression%text)) expression%trouble = &
      'what begins with ''' // expression%text(expression%next:expression%next) // ''' is not understood; known are numbers, ' // &
      'earlier parameters, + - * / **, parentheses and functions'
    if (expression%trouble == '' .and. .not. abs(value%number) <= huge(1.0_DP)) expression%trouble = 'it is not finite'
    if (expression%trouble /= '') then
      call messages%add(line, 'The expression of ' // name // ' has no value: ' // expression%trouble // '.')
      return
    end if
    if (expression%note /= '') call messages%add(line, 'In the expression of ' // name // ' ' // expression%note, is_warning=.true.)
    call scope%names%add(name, position, is_new)
    if (is_new) then
      scope%values = [scope%values, value]
    else
      scope%values(position) = value
    end if
  end subroutine define_parameter


  !> Products with + and - between them.
  recursive subroutine evaluate_sum(scope, expression, value)
    type(scope_type), intent(in) :: scope
    type(expression_type), intent(inout) :: expression
    type(value_type), intent(out) :: value
    type(value_type) :: term
    character(:), allocatable :: operator
    call evaluate_product(scope, expression, value)
    do while (takes_operator(expression, ['+ ', '- '], operator))
      call evaluate_product(scope, expression, term)
      value%is_integer = value%is_integer .and. term%is_integer
      value%number = value%number + merge(term%number, -term%number, operator == '+')
    end do
  end subroutine evaluate_sum


  !> Powers with * and / between them. The quotient of integers is rounded down, with a note.
  !! Source: Abaqus/CAE User's Guide, "Entering expressions": 3/2 is 1, 3./2 is 1.5 (Python's rule up to version 2).
  recursive subroutine evaluate_product(scope, expression, value)
    type(scope_type), intent(in) :: scope
    type(expression_type), intent(inout) :: expression
    type(value_type), intent(out) :: value
    type(value_type) :: factor
    character(:), allocatable :: operator
    call evaluate_power(scope, expression, value)
    do while (takes_operator(expression, ['* ', '/ '], operator))
      call evaluate_power(scope, expression, factor)
      if (operator == '*') then
        value%number = value%number * factor%number
      else if (.not. abs(factor%number) > 0) then
        if (expression%trouble == '') expression%trouble = 'it divides by zero'
      else
        if (value%is_integer .and. factor%is_integer .and. abs(modulo(value%number, factor%number)) > 0) then
          expression%note = value_text(value) // '/' // value_text(factor) // ' is rounded down'
          value%number = anint((value%number - modulo(value%number, factor%number)) / factor%number)
          expression%note = expression%note // ' to ' // value_text(value) // ', because both are integers; with a decimal ' // &
            'point (3./2) it is not.'
        else
          value%number = value%number / factor%number
        end if
      end if
      value%is_integer = value%is_integer .and. factor%is_integer
    end do
  end subroutine evaluate_product


  !> A sign and a power: the sign is outside of the power, a sign of the exponent within.
  recursive subroutine evaluate_power(scope, expression, value)
    type(scope_type), intent(in) :: scope
    type(expression_type), intent(inout) :: expression
    type(value_type), intent(out) :: value
    real(DP), parameter :: MAX_INTEGER_EXPONENT = 1.0e4_DP
    type(value_type) :: exponent
    character(:), allocatable :: operator
    if (takes_operator(expression, ['+ ', '- '], operator)) then
      call evaluate_power(scope, expression, value)
      if (operator == '-') value%number = -value%number
      return
    end if
    call evaluate_operand(scope, expression, value)
    if (.not. takes_operator(expression, ['**'], operator)) return
    call evaluate_power(scope, expression, exponent)
    value%is_integer = value%is_integer .and. exponent%is_integer .and. exponent%number >= 0
    if (exponent%is_integer .and. abs(exponent%number) < MAX_INTEGER_EXPONENT) then
      value%number = value%number**nint(exponent%number)
    else if (value%number < 0) then
      if (expression%trouble == '') expression%trouble = 'a power of a negative number has an exponent with a decimal point'
    else
      value%number = value%number**exponent%number
    end if
  end subroutine evaluate_power


  !> A number, a parameter, a function, or an expression in parentheses.
  recursive subroutine evaluate_operand(scope, expression, value)
    type(scope_type), intent(in) :: scope
    type(expression_type), intent(inout) :: expression
    type(value_type), intent(out) :: value
    character(:), allocatable :: word
    integer :: status, position
    call skip_blanks(expression)
    if (expression%trouble /= '') return
    if (index(expression%text(expression%next:), '(') == 1) then
      expression%next = expression%next + 1
      call evaluate_sum(scope, expression, value)
      call skip_blanks(expression)
      if (expression%trouble == '' .and. index(expression%text(expression%next:), ')') /= 1) expression%trouble = &
        'a parenthesis is not closed'
      expression%next = expression%next + 1
      return
    end if
    word = next_word(expression)
    expression%next = expression%next + len(word)
    if (scan(word // ' ', LETTERS) == 1) then
      call skip_blanks(expression)
      if (any(word == FUNCTIONS) .and. index(expression%text(expression%next:), '(') == 1) then
        call evaluate_operand(scope, expression, value)
        if (expression%trouble == '') call apply_function(word, value, expression%trouble)
        return
      end if
      position = scope%names%find(word)
      if (position > 0) value = scope%values(position)
      if (position == 0) expression%trouble = 'there is no parameter ''' // word // ''' before this line'
      return
    end if
    value%is_integer = verify(word, DIGITS) == 0
    call parse_real(word, value%number, status)
    if (status /= NUMBER_OK) expression%trouble = 'a number or a parameter is missing in ''' // &
      trim(adjustl(expression%text)) // ''''
  end subroutine evaluate_operand


  !> The function of a number; angles are in radians.
  pure subroutine apply_function(name, value, trouble)
    character(*), intent(in) :: name
    type(value_type), intent(inout) :: value
    character(:), allocatable, intent(inout) :: trouble   !< '': it has a value
    logical :: is_defined
    associate (x => value%number)
      select case (name)
      case ('sqrt')
        is_defined = x >= 0.0_DP
      case ('log', 'log10')
        is_defined = x > 0.0_DP
      case ('asin', 'acos')
        is_defined = abs(x) <= 1.0_DP
      case default
        is_defined = .true.
      end select
      if (.not. is_defined) then
        trouble = name // ' has no value here'
        return
      end if
      select case (name)
      case ('sqrt')
        x = sqrt(x)
      case ('exp')
        x = exp(x)
      case ('log')
        x = log(x)
      case ('log10')
        x = log10(x)
      case ('sin')
        x = sin(x)
      case ('cos')
        x = cos(x)
      case ('tan')
        x = tan(x)
      case ('asin')
        x = asin(x)
      case ('acos')
        x = acos(x)
      case ('atan')
        x = atan(x)
      case ('sinh')
        x = sinh(x)
      case ('cosh')
        x = cosh(x)
      case ('tanh')
        x = tanh(x)
      case ('abs')
        x = abs(x)
      end select
    end associate
    value%is_integer = value%is_integer .and. name == 'abs'
  end subroutine apply_function


  !> The name or the number that begins here, with the sign of its exponent; empty if none does.
  pure function next_word(expression) result(word)
    type(expression_type), intent(in) :: expression
    character(:), allocatable :: word
    integer :: last
    logical :: is_number
    last = expression%next - 1
    associate (text => expression%text)
      is_number = scan(text(last + 1:), LETTERS) /= 1
      do while (last < len(text))
        if (scan(text(last + 1:last + 1), LETTERS // DIGITS // '.') == 0) then
          if (.not. is_number .or. scan(text(last + 1:last + 1), '+-') == 0 .or. last < expression%next) exit
          if (scan(text(last:last), 'eEdD') == 0) exit
        end if
        last = last + 1
      end do
      word = text(expression%next:last)
    end associate
  end function next_word


  !> Steps over one of these operators, if it is next. '*' is not the beginning of '**'.
  logical function takes_operator(expression, operators, operator) result(does_so)
    type(expression_type), intent(inout) :: expression
    character(*), intent(in) :: operators(:)     !< of two letters, or of one and a blank
    character(:), allocatable, intent(out) :: operator
    integer :: k
    operator = ''
    call skip_blanks(expression)
    does_so = .false.
    if (expression%trouble /= '') return
    associate (rest => expression%text(expression%next:))
      do k = 1, size(operators)
        if (index(rest, trim(operators(k))) /= 1) cycle
        if (operators(k) == '* ' .and. index(rest, '**') == 1) cycle
        operator = trim(operators(k))
        does_so = .true.
      end do
    end associate
    expression%next = expression%next + len(operator)
  end function takes_operator


  !> Steps over blanks.
  subroutine skip_blanks(expression)
    type(expression_type), intent(inout) :: expression
    do while (expression%next <= len(expression%text))
      if (scan(expression%text(expression%next:expression%next), ' ' // achar(9)) == 0) return
      expression%next = expression%next + 1
    end do
  end subroutine skip_blanks

end module amontons_deck_parameters
