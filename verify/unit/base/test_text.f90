!> Unit test of text and containers: numbers and words of a deck; names, labels, lists, sorting.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_text
  use amontons_kinds, only: DP
  use amontons_containers, only: name_table_type, label_table_type, integer_list_type, sort_integers
  use amontons_text, only: upper_case, name_key, is_one_of, nth_word, count_words, to_text, joined_words, plural, parse_integer, &
    parse_real, format_value_rows, place_integer, NUMBER_OK, NUMBER_EMPTY, NUMBER_INVALID, NUMBER_NOT_FINITE
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call test_words(suite)
  call test_integers(suite)
  call test_reals(suite)
  call test_real_rounding(suite)
  call test_written_numbers(suite)
  call test_names(suite)
  call test_labels(suite)
  call test_sorting(suite)
  call test_rows(suite)
  call test_known_rows(suite)
  call test_placed_integers(suite)
  call suite%finish()

contains

  !> Words are compared without case, blanks and quotation marks.
  subroutine test_words(suite)
    type(suite_type), intent(inout) :: suite
    call suite%that('upper_case', upper_case('*Node, nset=a_1') == '*NODE, NSET=A_1')
    call suite%that('squeezed', name_key(' "End ' // achar(9) // 'Step"' // achar(13)) == 'ENDSTEP')
    call suite%that('squeezed of nothing', len(name_key('')) == 0)
    call suite%that('count_words', count_words('A|B C|D') == 3 .and. count_words('') == 0 .and. count_words('A') == 1)
    call suite%that('nth_word', nth_word('A|B C|D', 2) == 'B C' .and. nth_word('A|B C|D', 3) == 'D' .and. &
      nth_word('A', 1) == 'A')
    call suite%that('is_one_of', is_one_of('bc', 'A|B C|D') .and. .not. is_one_of('b', 'A|B C|D'))
    call suite%that('nothing is one of nothing', .not. is_one_of('', ''))
    call suite%that('joined_words', joined_words('A|B|C') == 'A, B or C' .and. joined_words('A') == 'A')
    call suite%that('plural', plural(1, 'node') == '1 node' .and. plural(0, 'node') == '0 nodes')
  end subroutine test_words


  !> Integers: digits with a sign, nothing else.
  subroutine test_integers(suite)
    type(suite_type), intent(inout) :: suite
    call expect_integer(suite, '42', 42, NUMBER_OK)
    call expect_integer(suite, '  -7 ' // achar(9), -7, NUMBER_OK)
    call expect_integer(suite, '+2147483647', 2147483647, NUMBER_OK)
    call expect_integer(suite, '2147483648', 0, NUMBER_INVALID)
    call expect_integer(suite, '99999999999999999999999', 0, NUMBER_INVALID)
    call expect_integer(suite, '1.0', 0, NUMBER_INVALID)
    call expect_integer(suite, '1 2', 0, NUMBER_INVALID)
    call expect_integer(suite, '-', 0, NUMBER_INVALID)
    call expect_integer(suite, 'SET1', 0, NUMBER_INVALID)
    call expect_integer(suite, '   ', 0, NUMBER_EMPTY)
    call expect_integer(suite, '', 0, NUMBER_EMPTY)
  end subroutine test_integers


  subroutine expect_integer(suite, field, value, status)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: field
    integer, intent(in) :: value, status
    integer :: got, got_status
    call parse_integer(field, got, got_status)
    call suite%that('parse_integer ''' // field // '''', got == value .and. got_status == status)
  end subroutine expect_integer


  !> All forms of reals; invalid and non-finite numbers.
  subroutine test_reals(suite)
    type(suite_type), intent(inout) :: suite
    call expect_real(suite, '1', 1.0_DP, NUMBER_OK)
    call expect_real(suite, ' 1. ', 1.0_DP, NUMBER_OK)
    call expect_real(suite, '.5', 0.5_DP, NUMBER_OK)
    call expect_real(suite, '-0.1', -0.1_DP, NUMBER_OK)
    call expect_real(suite, '1e5', 1.0e5_DP, NUMBER_OK)
    call expect_real(suite, '1.d0', 1.0_DP, NUMBER_OK)
    call expect_real(suite, '1.D-3', 1.0e-3_DP, NUMBER_OK)
    call expect_real(suite, '1+5', 1.0e5_DP, NUMBER_OK)
    call expect_real(suite, '-1.5-3', -1.5e-3_DP, NUMBER_OK)
    call expect_real(suite, '210000', 210000.0_DP, NUMBER_OK)
    call expect_real(suite, '1e300', 1.0e300_DP, NUMBER_OK)
    call expect_real(suite, '1e-200', 1.0e-200_DP, NUMBER_OK)
    call expect_real(suite, '1e-400', 0.0_DP, NUMBER_OK)
    call expect_real(suite, '0e999', 0.0_DP, NUMBER_OK)
    call expect_real(suite, '', 0.0_DP, NUMBER_EMPTY)
    call expect_real(suite, '.', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, 'e5', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, '1e', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, '1e+', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, '1 e5', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, '1e 5', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, '1.2.3', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, '1,5', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, '1/2', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, 'abc', 0.0_DP, NUMBER_INVALID)
    call expect_real(suite, 'NaN', 0.0_DP, NUMBER_NOT_FINITE)
    call expect_real(suite, '-inf', 0.0_DP, NUMBER_NOT_FINITE)
    call expect_real(suite, 'Infinity', 0.0_DP, NUMBER_NOT_FINITE)
    call expect_real(suite, '1e308', 0.0_DP, NUMBER_NOT_FINITE)
    call expect_real(suite, '1e99999999', 0.0_DP, NUMBER_NOT_FINITE)
    call expect_real(suite, repeat('9', 400), 0.0_DP, NUMBER_NOT_FINITE)
  end subroutine test_reals


  subroutine expect_real(suite, field, value, status)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: field
    real(DP), intent(in) :: value
    integer, intent(in) :: status
    real(DP) :: got
    integer :: got_status
    call parse_real(field, got, got_status)
    call suite%that('status of real ''' // field // '''', got_status == status)
    call suite%near('parse_real ''' // field // '''', got, value, 0.0_DP)
  end subroutine expect_real


  !> Numbers are rounded as by the compiler's library: 1 to 20 digits, all magnitudes, ties included.
  subroutine test_real_rounding(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: got, expected, r(2)
    integer :: i, n, status, n_wrong
    character(40) :: field
    character(12) :: form
    n_wrong = 0
    do i = 1, 20000
      call random_number(r)
      n = modulo(i, 20)
      write (form, '(a,i0,a)') '(es40.', n, 'e3)'
      write (field, form) (r(1) - 0.5_DP) * 10.0_DP**(60 * r(2) - 30)
      if (modulo(i, 2) == 0) then
        write (form, '(a,i0,a)') '(f38.', n, ')'
        write (field, form) r(1) * 1000
      end if
      call parse_real(field, got, status)
      read (field, '(f40.0)') expected
      if (status /= NUMBER_OK .or. abs(got - expected) > 0) n_wrong = n_wrong + 1
    end do
    call suite%that('20000 numbers rounded as by the library', n_wrong == 0)
    call expect_real(suite, '9007199254740993', 9007199254740992.0_DP, NUMBER_OK)
    call expect_real(suite, '9007199254740993.0', 9007199254740992.0_DP, NUMBER_OK)
    call expect_real(suite, '9007199254740993.1', 9007199254740994.0_DP, NUMBER_OK)
    call expect_real(suite, '9007199254740992.9', 9007199254740992.0_DP, NUMBER_OK)
    call expect_real(suite, '1.2345678901234567e-01', 1.2345678901234567e-01_DP, NUMBER_OK)
    call expect_real(suite, '0.1000000000000000055511151231257827021181583404541015625', 0.1_DP, NUMBER_OK)
  end subroutine test_real_rounding


  !> Numbers in messages.
  subroutine test_written_numbers(suite)
    type(suite_type), intent(inout) :: suite
    call suite%that('text_of integer', to_text(-12) == '-12')
    call suite%that('text_of 0.3', to_text(0.3_DP) == '0.3')
    call suite%that('text_of 210000', to_text(210000.0_DP) == '210000')
    call suite%that('text_of 1.5e-6', to_text(1.5e-6_DP) == '1.5E-6')
    call suite%that('text_of -2e9', to_text(-2.0e9_DP) == '-2E9')
    call suite%that('text_of 0', to_text(0.0_DP) == '0')
  end subroutine test_written_numbers


  !> Names: numbered in the order of insertion, found in upper and lower case; many of them.
  subroutine test_names(suite)
    type(suite_type), intent(inout) :: suite
    type(name_table_type) :: table
    integer :: i, position
    logical :: is_new, is_right
    call suite%that('an empty table finds nothing', table%find('A') == 0)
    is_right = .true.
    do i = 1, 5000
      call table%add('Set-' // to_text(i), position, is_new)
      is_right = is_right .and. is_new .and. position == i
    end do
    call suite%that('5000 names are new', is_right)
    call table%add('sEt -17', position, is_new)
    call suite%that('a known name is found by add', position == 17 .and. .not. is_new .and. table%n == 5000)
    is_right = .true.
    do i = 1, 5000
      is_right = is_right .and. table%find('SET-' // to_text(i)) == i
    end do
    call suite%that('5000 names are found', is_right .and. table%find('SET-5001') == 0)
  end subroutine test_names


  !> Labels: dense ones by a direct table, sparse ones by a search; a repeated label keeps the first index.
  subroutine test_labels(suite)
    type(suite_type), intent(inout) :: suite
    type(label_table_type) :: table
    integer, allocatable :: none(:)
    call table%build([7, 5, 9, 5])
    call suite%that('dense labels', table%find(7) == 1 .and. table%find(5) == 2 .and. table%find(9) == 3)
    call suite%that('dense labels that are not there', table%find(6) == 0 .and. table%find(4) == 0 .and. &
      table%find(10) == 0 .and. table%find(-2147483647) == 0)
    call table%build([2000000000, 5, 70000, 5, 2147483647])
    call suite%that('sparse labels', table%find(2000000000) == 1 .and. table%find(5) == 2 .and. &
      table%find(70000) == 3 .and. table%find(2147483647) == 5)
    call suite%that('sparse labels that are not there', table%find(6) == 0 .and. table%find(1) == 0 .and. &
      table%find(2147483646) == 0)
    allocate (none(0))
    call table%build(none)
    call suite%that('no labels', table%find(1) == 0)
  end subroutine test_labels


  !> Sorting is ascending, stable, and permutes a second array; lists grow.
  subroutine test_sorting(suite)
    type(suite_type), intent(inout) :: suite
    type(integer_list_type) :: list
    integer, allocatable :: keys(:), companion(:)
    integer :: i, n
    logical :: is_right
    call suite%that('an empty list', size(list%trimmed()) == 0)
    is_right = .true.
    allocate (keys(0), companion(0))
    do n = 1, 70
      companion = [(i, i=1, n)]
      keys = modulo(companion * 7919, 13)
      call sort_integers(keys, companion)
      is_right = is_right .and. all(keys(2:) >= keys(:n - 1))
      is_right = is_right .and. all(pack(companion(2:) - companion(:n - 1), keys(2:) == keys(:n - 1)) > 0)
      is_right = is_right .and. all(keys == modulo(companion * 7919, 13))
    end do
    call suite%that('sorting of 1 to 70 keys, stable', is_right)
    do i = 1, 1000
      call list%add(1001 - i)
    end do
    keys = list%trimmed()
    call sort_integers(keys)
    call suite%that('a list of 1000 sorted', size(keys) == 1000 .and. all(keys == [(i, i=1, 1000)]))
  end subroutine test_sorting


  !> Rows of numbers have the characters of Fortran's formatted write in single precision, within its range:
  !! random numbers of all sizes with two-digit exponents, and sums of powers of two, half of which are ties.
  subroutine test_rows(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: N = 20000
    real(DP), allocatable :: values(:, :), r(:, :)
    integer, allocatable :: labels(:)
    integer :: i, k, n_bad
    character(50) :: line
    character(:), allocatable :: text
    call random_seed(put=[(19 * k, k=1, 64)])
    allocate (values(3, N), r(3, N), labels(N))
    call random_number(values)
    call random_number(r)
    values = (values - 0.5_DP) * 10.0_DP**(180 * (r - 0.5_DP))
    do i = 1, N
      labels(i) = 37 * i
      if (mod(i, 2) == 0) values(3, i) = (real(nint(1.0e6_DP * r(3, i)), DP) + 0.5_DP) / real(2**mod(i, 7), DP)
    end do
    text = format_value_rows(labels, values)
    n_bad = 0
    do i = 1, N
      write (line, '(a,i10,1p,3e12.5)') ' -1', labels(i), in_single(values(:, i))
      if (text(50 * (i - 1) + 1:50 * i - 1) /= line(:49)) n_bad = n_bad + 1
    end do
    call suite%that('the same characters', n_bad == 0)
    call suite%that('one line a row', len(text) == 50 * N - 1)
  end subroutine test_rows


  !> Rounded to single precision if it is in its range.
  elemental function in_single(value) result(rounded)
    real(DP), intent(in) :: value
    real(DP) :: rounded
    rounded = value
    if (abs(value) >= real(tiny(1.0), DP) .and. abs(value) <= real(huge(1.0), DP)) rounded = real(real(value, kind(1.0)), DP)
  end function in_single


  !> The value that a reader of the columns gets.
  subroutine test_known_rows(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: values(6, 1)
    values(:, 1) = [0.0_DP, -1.0_DP, 999999.5_DP, 1.0e-120_DP, -1.0e120_DP, 123456.0_DP]
    call suite%that('known', format_value_rows([7], values) == ' -1         7 0.00000E+00-1.00000E+00 1.00000E+06 0.00000E+00' // &
      '-9.90000E+99 1.23456E+05')
    values(:, 1) = [0.5948074886524_DP, -0.9357425202014_DP, 0.091489452_DP, 0.9662355_DP, 0.0_DP, 1.0e-30_DP]
    call suite%that('as CalculiX writes them', format_value_rows([7], values(:4, :)) == &
      ' -1         7 5.94808E-01-9.35742E-01 9.14894E-02 9.66236E-01')
    call suite%that('nothing', len(format_value_rows([integer ::], values(:, :0))) == 0)
  end subroutine test_known_rows


  !> Integers in columns: the same characters as by edit descriptors, asterisks included.
  subroutine test_placed_integers(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: WIDTHS(4) = [1, 5, 10, 12]
    integer :: numbers(122), i, k, n_bad
    character(12) :: written, placed
    character(5) :: descriptor
    numbers(:60) = [(2**(i / 2) - mod(i, 2), i=1, 60)]
    numbers(61:120) = -numbers(:60)
    numbers(121) = huge(i)
    numbers(122) = -numbers(121) - 1
    n_bad = 0
    do k = 1, size(WIDTHS)
      write (descriptor, '(a,i0,a)') '(i', WIDTHS(k), ')'
      do i = 1, size(numbers)
        write (written, descriptor) numbers(i)
        call place_integer(numbers(i), placed(:WIDTHS(k)))
        if (placed(:WIDTHS(k)) /= written(:WIDTHS(k))) n_bad = n_bad + 1
      end do
    end do
    call suite%that('placed integers', n_bad == 0)
  end subroutine test_placed_integers

end program test_text
