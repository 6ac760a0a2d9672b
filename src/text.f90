!> Text: numbers from text and to text, and words compared as a deck compares them.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_text
  use amontons_kinds, only: DP, I64
  implicit none
  private
  public :: upper_case, squeezed, is_one_of, nth_word, count_words, text_of, joined_words, plural, is_blank
  public :: parse_integer, parse_real, NUMBER_OK, NUMBER_EMPTY, NUMBER_BAD, NUMBER_NOT_FINITE
  public :: BLANK_CHARACTERS, NEWLINE

  integer, parameter :: NUMBER_OK = 0            !< a number
  integer, parameter :: NUMBER_EMPTY = 1         !< nothing but blanks
  integer, parameter :: NUMBER_BAD = 2           !< not a number of the kind asked for, or too large an integer
  integer, parameter :: NUMBER_NOT_FINITE = 3    !< NaN, infinity, or 1e301 and more

  character(1), parameter :: NEWLINE = achar(10)
  character(3), parameter :: BLANK_CHARACTERS = ' ' // achar(9) // achar(13)   !< blank, tab, carriage return

  integer, parameter :: MAX_DECIMAL_EXPONENT = 301     !< 1e301 and more is refused
  integer, parameter :: EXACT_DIVISOR = 18             !< 10**18 is the largest power of ten in a 64-bit integer
  integer(I64), parameter :: LONG_POWERS(0:EXACT_DIVISOR) = [1_I64, 10_I64, 100_I64, 1000_I64, 10000_I64, 100000_I64, &
    1000000_I64, 10000000_I64, 100000000_I64, 1000000000_I64, 10000000000_I64, 100000000000_I64, 1000000000000_I64, &
    10000000000000_I64, 100000000000000_I64, 1000000000000000_I64, 10000000000000000_I64, 100000000000000000_I64, &
    1000000000000000000_I64]
  integer, parameter :: EXACT_POWER = 22               !< 10**22 is the largest exact power of ten in double precision
  integer(I64), parameter :: EXACT_MANTISSA = 9007199254740992_I64   !< 2**53
  real(DP), parameter :: POWERS(0:EXACT_POWER) = [1.0e0_DP, 1.0e1_DP, 1.0e2_DP, 1.0e3_DP, 1.0e4_DP, 1.0e5_DP, &
    1.0e6_DP, 1.0e7_DP, 1.0e8_DP, 1.0e9_DP, 1.0e10_DP, 1.0e11_DP, 1.0e12_DP, 1.0e13_DP, 1.0e14_DP, 1.0e15_DP, &
    1.0e16_DP, 1.0e17_DP, 1.0e18_DP, 1.0e19_DP, 1.0e20_DP, 1.0e21_DP, 1.0e22_DP]

  !> A number as text for a message.
  interface text_of
    module procedure text_of_integer, text_of_long, text_of_real
  end interface text_of

contains

  !> The text in upper case (ASCII letters only).
  pure function upper_case(string) result(upper)
    character(*), intent(in) :: string
    character(len(string)) :: upper
    integer :: i
    do i = 1, len(string)
      if (string(i:i) >= 'a' .and. string(i:i) <= 'z') then
        upper(i:i) = achar(iachar(string(i:i)) - 32)
      else
        upper(i:i) = string(i:i)
      end if
    end do
  end function upper_case


  !> The text in upper case without any blank or quotation mark: how names and keywords are compared.
  pure function squeezed(string) result(key)
    character(*), intent(in) :: string
    character(:), allocatable :: key
    character(len(string)) :: kept
    integer :: i, n
    n = 0
    do i = 1, len(string)
      if (is_blank(string(i:i)) .or. string(i:i) == '"') cycle
      n = n + 1
      kept(n:n) = string(i:i)
    end do
    key = upper_case(kept(:n))
  end function squeezed


  !> The number of words in a list 'A|B|C'; 0 if it is empty.
  pure function count_words(list) result(n)
    character(*), intent(in) :: list             !< words separated by |
    integer :: n, i
    n = 0
    if (len_trim(list) == 0) return
    n = 1
    do i = 1, len_trim(list)
      if (list(i:i) == '|') n = n + 1
    end do
  end function count_words


  !> The n-th word of a list 'A|B|C'.
  pure function nth_word(list, n) result(word)
    character(*), intent(in) :: list             !< words separated by |
    integer, intent(in) :: n                     !< 1 to count_words(list)
    character(:), allocatable :: word
    integer :: i, first, last
    first = 1
    do i = 1, n - 1
      first = first + index(list(first:), '|')
    end do
    last = index(list(first:), '|')
    if (last == 0) then
      word = trim(list(first:))
    else
      word = list(first:first + last - 2)
    end if
  end function nth_word


  !> Whether a word stands in a list 'A|B|C', compared without case and blanks.
  pure function is_one_of(word, list) result(is_member)
    character(*), intent(in) :: word
    character(*), intent(in) :: list             !< words separated by |
    logical :: is_member
    integer :: i
    is_member = .true.
    do i = 1, count_words(list)
      if (squeezed(nth_word(list, i)) == squeezed(word)) return
    end do
    is_member = .false.
  end function is_one_of


  !> A list 'A|B|C' as a person writes it: 'A, B or C'.
  pure function joined_words(list) result(text)
    character(*), intent(in) :: list             !< words separated by |
    character(:), allocatable :: text
    integer :: i, n
    n = count_words(list)
    text = ''
    do i = 1, n
      if (i > 1 .and. i == n) then
        text = text // ' or '
      else if (i > 1) then
        text = text // ', '
      end if
      text = text // nth_word(list, i)
    end do
  end function joined_words


  !> '1 node', '2 nodes'.
  pure function plural(n, noun) result(text)
    integer, intent(in) :: n
    character(*), intent(in) :: noun             !< in the singular, with a regular plural
    character(:), allocatable :: text
    text = text_of(n) // ' ' // noun
    if (n /= 1) text = text // 's'
  end function plural


  !> An integer without blanks.
  pure function text_of_integer(value) result(text)
    integer, intent(in) :: value
    character(:), allocatable :: text
    character(12) :: buffer
    write (buffer, '(i0)') value
    text = trim(buffer)
  end function text_of_integer


  !> A long integer without blanks.
  pure function text_of_long(value) result(text)
    integer(I64), intent(in) :: value
    character(:), allocatable :: text
    character(21) :: buffer
    write (buffer, '(i0)') value
    text = trim(buffer)
  end function text_of_long


  !> A real in the shortest of its six-digit forms: 0.3, 210000, 1.5E-6.
  pure function text_of_real(value) result(text)
    real(DP), intent(in) :: value
    character(:), allocatable :: text
    character(24) :: buffer
    integer :: power
    if (.not. abs(value) <= huge(value)) then
      text = 'not finite'
    else if (abs(value) < tiny(value)) then
      text = '0'
    else if (abs(value) >= 1.0e-3_DP .and. abs(value) < 1.0e6_DP) then
      write (buffer, '(f16.6)') value
      text = without_zeros(trim(adjustl(buffer)))
    else
      write (buffer, '(es24.5e3)') value
      buffer = adjustl(buffer)
      power = index(buffer, 'E')
      text = without_zeros(buffer(:power - 1)) // 'E' // short_exponent(buffer(power + 1:))
    end if
  end function text_of_real


  !> 1.50000 becomes 1.5 and 3.0000 becomes 3.
  pure function without_zeros(digits) result(text)
    character(*), intent(in) :: digits           !< with a decimal point
    character(:), allocatable :: text
    integer :: n
    n = verify(digits, '0', back=.true.)
    if (digits(n:n) == '.') n = n - 1
    text = digits(:n)
    if (text == '' .or. text == '-') text = '0'
  end function without_zeros


  !> +007 becomes 7 and -006 becomes -6.
  pure function short_exponent(digits) result(text)
    character(*), intent(in) :: digits           !< sign and three digits
    character(:), allocatable :: text
    integer :: power
    read (digits, '(i5)') power
    text = text_of_integer(power)
  end function short_exponent


  !> Reads an integer: blanks around it are allowed, nothing else.
  pure subroutine parse_integer(field, value, status)
    character(*), intent(in) :: field
    integer, intent(out) :: value                !< 0 unless NUMBER_OK
    integer, intent(out) :: status               !< NUMBER_...
    integer :: i, first, last, digit
    integer(I64) :: sum
    value = 0
    call trim_bounds(field, first, last)
    status = NUMBER_EMPTY
    if (first > last) return
    status = NUMBER_BAD
    i = first
    if (field(i:i) == '+' .or. field(i:i) == '-') i = i + 1
    if (i > last) return
    sum = 0
    do i = i, last
      digit = iachar(field(i:i)) - iachar('0')
      if (digit < 0 .or. digit > 9) return
      sum = 10 * sum + int(digit, I64)
      if (sum > huge(value)) return
    end do
    if (field(first:first) == '-') sum = -sum
    value = int(sum)
    status = NUMBER_OK
  end subroutine parse_integer


  !> Reads a real: 1, 1., .5, 1e5, 1.d0, 1+5 (exponent without letter); any width, any number of digits.
  !!
  !! Method: digits are gathered in a 64-bit integer; where it and the power of ten are exact in double precision, one
  !! multiplication or division rounds correctly (W. D. Clinger, How to read floating point numbers accurately, PLDI
  !! 1990); else a long division of integers does; all other numbers go through the compiler's library. NaN, infinity
  !! and magnitudes of 1e301 and more are refused.
  pure subroutine parse_real(field, value, status)
    character(*), intent(in) :: field
    real(DP), intent(out) :: value               !< 0 unless NUMBER_OK
    integer, intent(out) :: status               !< NUMBER_...
    integer :: first, last, mark, power, n_digits, magnitude
    integer(I64) :: mantissa
    logical :: is_exact
    value = 0
    call trim_bounds(field, first, last)
    status = NUMBER_EMPTY
    if (first > last) return
    call scan_mantissa(field(first:last), mark, mantissa, power, n_digits, is_exact)
    call scan_exponent(field(first + mark - 1:last), power, magnitude, n_digits, status)
    if (status /= NUMBER_OK) then
      if (is_word_not_finite(field(first:last))) status = NUMBER_NOT_FINITE
      return
    end if
    if (mantissa == 0) return
    if (magnitude > MAX_DECIMAL_EXPONENT) then
      status = NUMBER_NOT_FINITE
    else if (magnitude < -MAX_DECIMAL_EXPONENT) then
      return                                     ! too small to matter: zero
    else if (is_exact .and. mantissa <= EXACT_MANTISSA .and. abs(power) <= EXACT_POWER) then
      value = real(mantissa, DP)
      if (power < 0) value = value / POWERS(-power)
      if (power > 0) value = value * POWERS(power)
      if (field(first:first) == '-') value = -value
    else if (is_exact .and. power <= 0 .and. power >= -EXACT_DIVISOR) then
      value = quotient(mantissa, LONG_POWERS(-power))
      if (field(first:first) == '-') value = -value
    else
      call read_by_library(field(first:last), mark, value, status)
    end if
  end subroutine parse_real


  !> A quotient of integers, correctly rounded: long division, some bits at a time, until all bits of a real, a rounding
  !! bit and one more are there; a remainder that is left sets the last bit, so that no tie is taken for one.
  pure function quotient(numerator, divisor) result(value)
    integer(I64), intent(in) :: numerator        !< positive
    integer(I64), intent(in) :: divisor          !< 1 to 10**18
    real(DP) :: value
    integer(I64) :: whole, rest
    integer :: shift, n_bits
    whole = numerator / divisor
    rest = numerator - whole * divisor
    n_bits = min(8, leadz(divisor) - 1)          ! rest < divisor: rest * 2**n_bits does not overflow
    shift = 0
    do while (whole < 2 * EXACT_MANTISSA)
      rest = shiftl(rest, n_bits)
      whole = shiftl(whole, n_bits) + rest / divisor
      rest = modulo(rest, divisor)
      shift = shift + n_bits
    end do
    if (rest /= 0) whole = ior(whole, 1_I64)
    value = scale(real(whole, DP), -shift)
  end function quotient


  !> Gathers sign, digits and point.
  pure subroutine scan_mantissa(field, mark, mantissa, power, n_digits, is_exact)
    character(*), intent(in) :: field            !< without blanks around it
    integer, intent(out) :: mark                 !< first character after the digits
    integer(I64), intent(out) :: mantissa        !< the digits without the point, at most 18 of them
    integer, intent(out) :: power                !< power of ten that belongs to the mantissa
    integer, intent(out) :: n_digits             !< digits seen; 0: not a number
    logical, intent(out) :: is_exact             !< no digit was left out
    integer :: digit
    logical :: has_point
    mantissa = 0
    power = 0
    n_digits = 0
    is_exact = .true.
    has_point = .false.
    mark = 1
    if (field(1:1) == '+' .or. field(1:1) == '-') mark = 2
    do mark = mark, len(field)
      digit = iachar(field(mark:mark)) - iachar('0')
      if (digit >= 0 .and. digit <= 9) then
        n_digits = n_digits + 1
        if (mantissa < 100000000000000000_I64) then
          mantissa = 10 * mantissa + int(digit, I64)
          if (has_point) power = power - 1
        else
          is_exact = .false.
          if (.not. has_point) power = power + 1
        end if
      else if (field(mark:mark) == '.' .and. .not. has_point) then
        has_point = .true.
      else
        return
      end if
    end do
  end subroutine scan_mantissa


  !> Adds the exponent to the power of ten and checks the form.
  pure subroutine scan_exponent(field, power, magnitude, n_digits, status)
    character(*), intent(in) :: field            !< what follows the digits, may be empty
    integer, intent(inout) :: power              !< power of ten
    integer, intent(out) :: magnitude            !< upper bound of the decimal exponent
    integer, intent(in) :: n_digits              !< digits of the mantissa
    integer, intent(out) :: status               !< NUMBER_OK or NUMBER_BAD
    integer :: exponent, start
    status = NUMBER_BAD
    magnitude = 0
    if (n_digits == 0) return
    exponent = 0
    if (len(field) > 0) then
      start = 1
      if (scan(field(1:1), 'eEdDqQ') == 1) start = 2
      if (start == 1 .and. scan(field(1:1), '+-') /= 1) return
      if (is_blank(field(len(field):)) .or. start > len(field)) return
      call parse_integer(field(start:), exponent, status)
      if (status /= NUMBER_OK .or. is_blank(field(start:start))) then
        status = NUMBER_BAD
        return
      end if
    end if
    status = NUMBER_OK
    exponent = max(-100000, min(100000, exponent))
    power = power + exponent
    magnitude = power + min(n_digits, 18)
  end subroutine scan_exponent


  !> The slow, always correct way.
  pure subroutine read_by_library(field, mark, value, status)
    character(*), intent(in) :: field            !< a number that has passed the scan
    integer, intent(in) :: mark                  !< where the exponent starts, or after the end
    real(DP), intent(out) :: value
    integer, intent(out) :: status               !< NUMBER_OK or NUMBER_BAD
    character(len(field) + 1) :: standard
    character(16) :: form
    integer :: iostat
    standard = field
    if (mark <= len(field)) then
      if (scan(field(mark:mark), '+-') == 1) then
        standard = field(:mark - 1) // 'E' // field(mark:)
      else
        standard(mark:mark) = 'E'
      end if
    end if
    write (form, '(a,i0,a)') '(f', len(standard), '.0)'
    read (standard, form, iostat=iostat) value
    status = NUMBER_OK
    if (iostat /= 0) then
      value = 0
      status = NUMBER_BAD
    end if
  end subroutine read_by_library


  !> NaN, Inf, Infinity with or without a sign.
  pure function is_word_not_finite(field) result(is_word)
    character(*), intent(in) :: field            !< without blanks around it
    logical :: is_word
    character(:), allocatable :: word
    word = upper_case(field)
    if (scan(word(1:1), '+-') == 1) word = word(2:)
    is_word = word == 'NAN' .or. word == 'INF' .or. word == 'INFINITY'
    if (len(word) >= 4) is_word = is_word .or. word(:4) == 'NAN('
  end function is_word_not_finite


  !> Whether a character is a blank, a tab or a carriage return.
  pure function is_blank(character) result(is_so)
    character(1), intent(in) :: character
    logical :: is_so
    is_so = character == ' ' .or. character == achar(9) .or. character == achar(13)
  end function is_blank


  !> The part of a field without the blanks around it; first > last if nothing is left.
  pure subroutine trim_bounds(field, first, last)
    character(*), intent(in) :: field
    integer, intent(out) :: first, last
    first = 1
    last = len(field)
    do while (last >= 1)
      if (.not. is_blank(field(last:last))) exit
      last = last - 1
    end do
    do while (first <= last)
      if (.not. is_blank(field(first:first))) exit
      first = first + 1
    end do
  end subroutine trim_bounds

end module amontons_text
