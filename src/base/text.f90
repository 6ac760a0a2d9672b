!> String handling: words, numbers to text and back, reading text files.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Rows of numbers in the columns of a .frd file are formatted by text_shim.c, ten times as fast as by formatted writes. The six
!! digits are correctly rounded: the same characters as by the format (' -1', i10, 1p, 6e12.5).
!!
!! File contents are normalized. A byte order mark is removed. UTF-16, which some editors and shells of Windows write, becomes
!! single bytes. Lines that end with carriage returns alone get line feeds. (A carriage return before a line feed counts as blank.)
module amontons_text
  use amontons_kinds, only: DP, I64
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
  implicit none
  private
  public :: upper_case, name_key, is_one_of, nth_word, count_words, to_text, joined_words, plural, verb, is_blank
  public :: parse_integer, parse_real, NUMBER_OK, NUMBER_EMPTY, NUMBER_INVALID, NUMBER_NOT_FINITE
  public :: BLANK_CHARACTERS, NEWLINE
  public :: format_value_rows, place_integer
  public :: read_text_file, read_relative_file

  integer, parameter :: NUMBER_OK = 0            !< a number
  integer, parameter :: NUMBER_EMPTY = 1         !< nothing but blanks
  integer, parameter :: NUMBER_INVALID = 2           !< not a number of the requested kind, or too large an integer
  integer, parameter :: NUMBER_NOT_FINITE = 3    !< NaN, infinity, or 1e301 and more

  character(1), parameter :: NEWLINE = achar(10)
  character(3), parameter :: BLANK_CHARACTERS = ' ' // achar(9) // achar(13)   !< blank, tab, carriage return

  integer, parameter :: MAX_DECIMAL_EXPONENT = 301     !< 1e301 and more is rejected
  integer, parameter :: MAX_INTEGER_POWER = 18             !< 10**18 is the largest power of ten in a 64-bit integer
  integer(I64), parameter :: INTEGER_POWERS_OF_TEN(0:MAX_INTEGER_POWER) = [1_I64, 10_I64, 100_I64, 1000_I64, 10000_I64, &
    100000_I64, &
    1000000_I64, 10000000_I64, 100000000_I64, 1000000000_I64, 10000000000_I64, 100000000000_I64, 1000000000000_I64, &
    10000000000000_I64, 100000000000000_I64, 1000000000000000_I64, 10000000000000000_I64, 100000000000000000_I64, &
    1000000000000000000_I64]
  integer, parameter :: MAX_EXACT_POWER = 22               !< 10**22 is the largest exact power of ten in double precision
  integer(I64), parameter :: MAX_EXACT_MANTISSA = 9007199254740992_I64   !< 2**53
  real(DP), parameter :: REAL_POWERS_OF_TEN(0:MAX_EXACT_POWER) = [1.0e0_DP, 1.0e1_DP, 1.0e2_DP, 1.0e3_DP, 1.0e4_DP, 1.0e5_DP, &
    1.0e6_DP, 1.0e7_DP, 1.0e8_DP, 1.0e9_DP, 1.0e10_DP, 1.0e11_DP, 1.0e12_DP, 1.0e13_DP, 1.0e14_DP, 1.0e15_DP, &
    1.0e16_DP, 1.0e17_DP, 1.0e18_DP, 1.0e19_DP, 1.0e20_DP, 1.0e21_DP, 1.0e22_DP]

  !> A number as text for a message.
  interface to_text
    module procedure text_of_integer, text_of_long, text_of_real
  end interface to_text

  interface
    subroutine put_rows(labels, values, width, n, text) bind(C, name='amontons_put_rows')
      import :: c_char, c_double, c_int
      integer(c_int), intent(in) :: labels(*)
      real(c_double), intent(in) :: values(*)
      integer(c_int), value :: width, n
      character(kind=c_char), intent(out) :: text(*)
    end subroutine put_rows
  end interface

  integer(I64), parameter :: READ_BLOCK_SIZE = 16777216_I64   !< bytes read at once
  character(2), parameter :: BOM_UTF16_LE = char(255) // char(254), BOM_UTF16_BE = char(254) // char(255)   !< UTF-16 BOM
  character(3), parameter :: BOM_UTF8 = char(239) // char(187) // char(191)   !< mark of UTF-8

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


  !> The text in upper case without blanks and quotation marks: names and keywords are compared in this form.
  pure function name_key(string) result(key)
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
  end function name_key


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


  !> Whether a list 'A|B|C' contains a word, compared without case and blanks.
  pure function is_one_of(word, list) result(is_member)
    character(*), intent(in) :: word
    character(*), intent(in) :: list             !< words separated by |
    logical :: is_member
    integer :: i
    is_member = .true.
    do i = 1, count_words(list)
      if (name_key(nth_word(list, i)) == name_key(word)) return
    end do
    is_member = .false.
  end function is_one_of


  !> A list 'A|B|C' as text: 'A, B or C'.
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
    text = to_text(n) // ' ' // noun
    if (n /= 1) text = text // 's'
  end function plural


  !> The form of a verb (or of any word) that agrees with a number: verb(1, 'has', 'have') is 'has'.
  pure function verb(n, one, several) result(text)
    integer, intent(in) :: n
    character(*), intent(in) :: one, several
    character(:), allocatable :: text
    text = several
    if (n == 1) text = one
  end function verb


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
      text = strip_trailing_zeros(trim(adjustl(buffer)))
    else
      write (buffer, '(es24.5e3)') value
      buffer = adjustl(buffer)
      power = index(buffer, 'E')
      text = strip_trailing_zeros(buffer(:power - 1)) // 'E' // shorten_exponent(buffer(power + 1:))
    end if
  end function text_of_real


  !> Removes trailing zeros: 1.50000 becomes 1.5 and 3.0000 becomes 3.
  pure function strip_trailing_zeros(digits) result(text)
    character(*), intent(in) :: digits           !< with a decimal point
    character(:), allocatable :: text
    integer :: n
    n = verify(digits, '0', back=.true.)
    if (digits(n:n) == '.') n = n - 1
    text = digits(:n)
    if (text == '' .or. text == '-') text = '0'
  end function strip_trailing_zeros


  !> Removes leading zeros of an exponent: +007 becomes 7 and -006 becomes -6.
  pure function shorten_exponent(digits) result(text)
    character(*), intent(in) :: digits           !< sign and three digits
    character(:), allocatable :: text
    integer :: power
    read (digits, '(i5)') power
    text = text_of_integer(power)
  end function shorten_exponent


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
    status = NUMBER_INVALID
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
  !! 1990); else a long division of integers does; all other numbers are read by the compiler's library. NaN, infinity
  !! and magnitudes of 1e301 and more are rejected.
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
      if (is_nonfinite_word(field(first:last))) status = NUMBER_NOT_FINITE
      return
    end if
    if (mantissa == 0) return
    if (magnitude > MAX_DECIMAL_EXPONENT) then
      status = NUMBER_NOT_FINITE
    else if (magnitude < -MAX_DECIMAL_EXPONENT) then
      return                                     ! underflow: zero
    else if (is_exact .and. mantissa <= MAX_EXACT_MANTISSA .and. abs(power) <= MAX_EXACT_POWER) then
      value = real(mantissa, DP)
      if (power < 0) value = value / REAL_POWERS_OF_TEN(-power)
      if (power > 0) value = value * REAL_POWERS_OF_TEN(power)
      if (field(first:first) == '-') value = -value
    else if (is_exact .and. power <= 0 .and. power >= -MAX_INTEGER_POWER) then
      value = rounded_quotient(mantissa, INTEGER_POWERS_OF_TEN(-power))
      if (field(first:first) == '-') value = -value
    else
      call read_by_runtime(field(first:last), mark, value, status)
    end if
  end subroutine parse_real


  !> A quotient of integers, correctly rounded: long division, several bits at a time, until all bits of a real, a rounding
  !! bit and one more are known; a nonzero remainder sets the last bit, so that it is not taken for a tie.
  pure function rounded_quotient(numerator, divisor) result(value)
    integer(I64), intent(in) :: numerator        !< positive
    integer(I64), intent(in) :: divisor          !< 1 to 10**18
    real(DP) :: value
    integer(I64) :: whole, rest
    integer :: shift, n_bits
    whole = numerator / divisor
    rest = numerator - whole * divisor
    n_bits = min(8, leadz(divisor) - 1)          ! remainder < divisor: remainder * 2**n_bits does not overflow
    shift = 0
    do while (whole < 2 * MAX_EXACT_MANTISSA)
      rest = shiftl(rest, n_bits)
      whole = shiftl(whole, n_bits) + rest / divisor
      rest = modulo(rest, divisor)
      shift = shift + n_bits
    end do
    if (rest /= 0) whole = ior(whole, 1_I64)
    value = scale(real(whole, DP), -shift)
  end function rounded_quotient


  !> Gathers sign, digits and point.
  pure subroutine scan_mantissa(field, mark, mantissa, power, n_digits, is_exact)
    character(*), intent(in) :: field            !< without blanks around it
    integer, intent(out) :: mark                 !< first character after the digits
    integer(I64), intent(out) :: mantissa        !< the digits without the point, at most 18 of them
    integer, intent(out) :: power                !< power of ten that belongs to the mantissa
    integer, intent(out) :: n_digits             !< digits seen; 0: not a number
    logical, intent(out) :: is_exact             !< no digit was dropped
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
    integer, intent(out) :: status               !< NUMBER_OK or NUMBER_INVALID
    integer :: exponent, start
    status = NUMBER_INVALID
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
        status = NUMBER_INVALID
        return
      end if
    end if
    status = NUMBER_OK
    exponent = max(-100000, min(100000, exponent))
    power = power + exponent
    magnitude = power + min(n_digits, 18)
  end subroutine scan_exponent


  !> Reads a number by the compiler's library: slow, always correct.
  pure subroutine read_by_runtime(field, mark, value, status)
    character(*), intent(in) :: field            !< a number that has passed the scan
    integer, intent(in) :: mark                  !< where the exponent starts, or after the end
    real(DP), intent(out) :: value
    integer, intent(out) :: status               !< NUMBER_OK or NUMBER_INVALID
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
      status = NUMBER_INVALID
    end if
  end subroutine read_by_runtime


  !> NaN, Inf, Infinity with or without a sign.
  pure function is_nonfinite_word(field) result(is_word)
    character(*), intent(in) :: field            !< without blanks around it
    logical :: is_word
    character(:), allocatable :: word
    word = upper_case(field)
    if (scan(word(1:1), '+-') == 1) word = word(2:)
    is_word = word == 'NAN' .or. word == 'INF' .or. word == 'INFINITY'
    if (len(word) >= 4) is_word = is_word .or. word(:4) == 'NAN('
  end function is_nonfinite_word


  !> Whether a character is a blank, a tab or a carriage return.
  pure function is_blank(character) result(is_so)
    character(1), intent(in) :: character
    logical :: is_so
    is_so = character == ' ' .or. character == achar(9) .or. character == achar(13)
  end function is_blank


  !> The range of a field without surrounding blanks; first > last if the field is blank.
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


  !> Writes an integer at the right of a field, as an edit descriptor does but in a tenth of its time; asterisks if it is too long.
  pure subroutine place_integer(number, field)
    integer, intent(in) :: number
    character(*), intent(out) :: field
    integer :: k, rest
    field = ' '
    rest = number                                    ! its remainders have its sign: -huge - 1 has no counterpart
    do k = len(field), 1, -1
      field(k:k) = achar(iachar('0') + abs(mod(rest, 10)))
      rest = rest / 10
      if (rest == 0) exit
    end do
    if (rest == 0 .and. number >= 0) return
    if (rest == 0 .and. k > 1) then
      field(k - 1:k - 1) = '-'
    else
      do k = 1, len(field)
        field(k:k) = '*'
      end do
    end if
  end subroutine place_integer


  !> Rows of ' -1', a label in ten columns and values in twelve each, separated by line ends. Values above 9.9e99 are limited
  !! to it, values below 1e-99 become 0: the exponent has two digits.
  function format_value_rows(labels, values) result(text)
    integer, intent(in) :: labels(:)               !< (n) positive
    real(DP), intent(in) :: values(:, :)           !< (width, n) no NaN
    character(:), allocatable :: text
    allocate (character((14 + 12 * size(values, 1)) * size(labels)) :: text)
    if (size(labels) == 0) return
    call put_rows(labels, values, size(values, 1), size(labels), text)
    text = text(:len(text) - 1)
  end function format_value_rows


  !> Reads a whole file.
  subroutine read_text_file(path, text, is_read)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    integer :: unit, iostat
    integer(I64) :: n
    inquire (file=path, exist=is_read)
    if (.not. is_read) return
    is_read = .false.
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=iostat)
    if (iostat /= 0) return
    inquire (unit=unit, size=n, iostat=iostat)
    if (iostat == 0 .and. n > 0 .and. n < huge(n)) then
      call read_blocks(unit, n, text, is_read)
    else if (iostat == 0) then
      call read_bytes(unit, text, is_read)
    end if
    close (unit, iostat=iostat)
    is_read = is_read .and. iostat == 0
    if (is_read) call normalize_encoding(text)
  end subroutine read_text_file


  !> Reads a file whose size is known.
  subroutine read_blocks(unit, n, text, is_read)
    integer, intent(in) :: unit
    integer(I64), intent(in) :: n                !< its size [bytes]
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    integer :: iostat
    integer(I64) :: first, last
    allocate (character(n) :: text)
    do first = 1, n, READ_BLOCK_SIZE
      last = min(n, first + READ_BLOCK_SIZE - 1)
      read (unit, iostat=iostat) text(first:last)
      if (iostat /= 0) exit
    end do
    is_read = iostat == 0
  end subroutine read_blocks


  !> Reads a file of unknown size (a pipe) to its end.
  subroutine read_bytes(unit, text, is_read)
    integer, intent(in) :: unit
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    character(:), allocatable :: larger
    character(1) :: byte
    integer :: iostat
    integer(I64) :: n
    allocate (character(4096) :: text)
    n = 0
    do
      read (unit, iostat=iostat) byte
      if (iostat /= 0) exit
      if (n == len(text, I64)) then
        allocate (character(2 * n) :: larger)
        larger(:n) = text
        call move_alloc(larger, text)
      end if
      n = n + 1
      text(n:n) = byte
    end do
    is_read = is_iostat_end(iostat)
    text = text(:n)
  end subroutine read_bytes


  !> Normalizes text to single bytes without byte order mark, with line feeds at line ends.
  pure subroutine normalize_encoding(text)
    character(:), allocatable, intent(inout) :: text
    integer(I64) :: i
    if (len(text) < 3) return
    if (text(:3) == BOM_UTF8) then
      text = text(4:)
    else if (text(:2) == BOM_UTF16_LE .or. text(:2) == BOM_UTF16_BE) then
      text = decode_utf16(text, merge(1_I64, 0_I64, text(:2) == BOM_UTF16_BE))
    end if
    if (scan(text, NEWLINE) > 0) return
    do i = 1, len(text, I64)
      if (text(i:i) == achar(13)) text(i:i) = NEWLINE
    end do
  end subroutine normalize_encoding


  !> Converts UTF-16 after its byte order mark to one byte for each character; non-ASCII characters become question marks.
  pure function decode_utf16(text, low) result(plain)
    character(*), intent(in) :: text
    integer(I64), intent(in) :: low              !< position of the low byte in a pair: 0 or 1
    character(:), allocatable :: plain
    integer(I64) :: i, n
    n = len(text, I64) / 2 - 1
    allocate (character(n) :: plain)
    do i = 1, n
      plain(i:i) = text(2 * i + 1 + low:2 * i + 1 + low)
      if (iachar(text(2 * i + 2 - low:2 * i + 2 - low)) /= 0 .or. iachar(plain(i:i)) > 127) plain(i:i) = '?'
    end do
  end function decode_utf16


  !> Reads a file named in another one: relative to that one first, then the path as written.
  subroutine read_relative_file(including, path, text, is_read)
    character(*), intent(in) :: including        !< path of the including file
    character(:), allocatable, intent(inout) :: path   !< as written; as opened on return
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    character(:), allocatable :: beside
    is_read = .false.
    if (path(1:1) /= '/') then
      beside = including(:index(including, '/', back=.true.)) // path
      call read_text_file(beside, text, is_read)
    end if
    if (is_read) then
      path = beside
    else
      call read_text_file(path, text, is_read)
    end if
  end subroutine read_relative_file

end module amontons_text
