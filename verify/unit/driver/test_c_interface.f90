!> Unit test of c_interface: the functions of amontons.h on one cube: values, sizes, messages, and NULL in every place.
!! SPDX-License-Identifier: GPL-3.0-or-later
module lines_of_c
  use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_int, c_null_char, c_ptr
  implicit none
  private
  public :: count_line

contains

  !> Counts the lines of the log: amontons_log of the header.
  subroutine count_line(context, line) bind(C, name='count_line_of_test')
    type(c_ptr), value :: context, line
    integer(c_int), pointer :: n
    character(kind=c_char), pointer :: first
    call c_f_pointer(context, n)
    call c_f_pointer(line, first)
    if (first /= c_null_char) n = n + 1_c_int
  end subroutine count_line

end module lines_of_c

program test_c_interface
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_funloc, c_funptr, c_int, c_int32_t, &
    c_int64_t, c_loc, c_null_char, c_null_funptr, c_null_ptr, c_ptr
  use check, only: suite_type
  use samples, only: deck_lines
  use lines_of_c, only: count_line
  use amontons_kinds, only: DP
  use amontons_errors, only: EXIT_SUCCESS, EXIT_USAGE, EXIT_DECK
  use amontons_text, only: NEWLINE
  use amontons_version, only: VERSION
  use amontons_convergence, only: VERDICT_CONTINUE, VERDICT_CONVERGED
  implicit none
  real(DP), parameter :: TOL = 1.0e-9_DP

  !> amontons_options.
  type, bind(C) :: options_type
    integer(c_int32_t) :: abi = 4, n_threads = 1, has_files = 0, has_checkpoint = 0, is_resumed = 0, is_check = 0, &
      n_partitions = 0
    type(c_ptr) :: deck = c_null_ptr, text = c_null_ptr, job = c_null_ptr, outdir = c_null_ptr, dialect = c_null_ptr, &
      user = c_null_ptr, old_job = c_null_ptr
    type(c_funptr) :: log = c_null_funptr
    type(c_ptr) :: context = c_null_ptr
  end type options_type

  interface
    integer(c_int) function c_abi() bind(C, name='amontons_abi')
      import :: c_int
    end function c_abi
    subroutine c_version(text, capacity) bind(C, name='amontons_version')
      import :: c_int64_t, c_ptr
      type(c_ptr), value :: text
      integer(c_int64_t), value :: capacity
    end subroutine c_version
    integer(c_int) function c_open(options, handle) bind(C, name='amontons_open')
      import :: c_int, c_ptr
      type(c_ptr), value :: options, handle
    end function c_open
    subroutine c_close(handle) bind(C, name='amontons_close')
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine c_close
    type(c_ptr) function c_message(handle) bind(C, name='amontons_message')
      import :: c_ptr
      type(c_ptr), value :: handle
    end function c_message
    integer(c_int) function c_is_done(handle) bind(C, name='amontons_is_done')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle
    end function c_is_done
    integer(c_int) function c_advance(handle) bind(C, name='amontons_advance')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle
    end function c_advance
    integer(c_int) function c_advance_to(handle, time) bind(C, name='amontons_advance_to')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), value :: time
    end function c_advance_to
    integer(c_int) function c_try(handle, dt) bind(C, name='amontons_try')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), value :: dt
    end function c_try
    integer(c_int) function c_begin(handle, dt) bind(C, name='amontons_begin')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), value :: dt
    end function c_begin
    integer(c_int) function c_iterate(handle, verdict) bind(C, name='amontons_iterate')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle, verdict
    end function c_iterate
    integer(c_int) function c_commit(handle) bind(C, name='amontons_commit')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle
    end function c_commit
    integer(c_int) function c_rollback(handle) bind(C, name='amontons_rollback')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle
    end function c_rollback
    integer(c_int) function c_finish(handle) bind(C, name='amontons_finish')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle
    end function c_finish
    integer(c_int) function c_get(handle, quantity, set, values, capacity, rows, columns) bind(C, name='amontons_get')
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: handle, quantity, set, values, rows, columns
      integer(c_int64_t), value :: capacity
    end function c_get
    integer(c_int) function c_set(handle, quantity, set, values, n) bind(C, name='amontons_set')
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: handle, quantity, set, values
      integer(c_int64_t), value :: n
    end function c_set
    integer(c_int) function c_names(handle, kind, text, capacity, needed) bind(C, name='amontons_names')
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: handle, kind, text, needed
      integer(c_int64_t), value :: capacity
    end function c_names
    integer(c_int) function c_matrix(handle, name, rows, columns, entries) bind(C, name='amontons_matrix')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle, name, rows, columns, entries
    end function c_matrix
    integer(c_int) function c_matrix_copy(handle, first, column, values) bind(C, name='amontons_matrix_copy')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle, first, column, values
    end function c_matrix_copy
    integer(c_int) function c_residual_copy(handle, values) bind(C, name='amontons_residual_copy')
      import :: c_int, c_ptr
      type(c_ptr), value :: handle, values
    end function c_residual_copy
  end interface

  type(suite_type) :: suite

  call check_version()
  call check_open()
  call check_values()
  call check_solving()
  call check_matrix()
  call check_null()
  call suite%finish()

contains

  include 'sample_cube.inc'

  !> A C string; valid until the end of the program.
  function c_text(text) result(address)
    character(*), intent(in) :: text
    type(c_ptr) :: address
    character(kind=c_char), pointer :: letters(:)
    integer :: i
    allocate (letters(len(text) + 1))
    do i = 1, len(text)
      letters(i) = text(i:i)
    end do
    letters(len(text) + 1) = c_null_char
    address = c_loc(letters)
  end function c_text


  !> Opens the cube.
  subroutine open_cube(handle)
    type(c_ptr), intent(out), target :: handle
    type(options_type), target :: options
    options%text = c_text(cube_deck())
    call suite%that('opened', c_open(c_loc(options), c_loc(handle)) == EXIT_SUCCESS)
  end subroutine open_cube


  !> The message of the handle contains a piece.
  logical function has_message(handle, piece)
    type(c_ptr), intent(in) :: handle
    character(*), intent(in) :: piece
    character(kind=c_char), pointer :: letters(:)
    character(:), allocatable :: text
    type(c_ptr) :: address
    integer :: i
    has_message = .false.
    address = c_message(handle)
    if (.not. c_associated(address)) return
    call c_f_pointer(address, letters, [100000])
    text = ''
    do i = 1, size(letters)
      if (letters(i) == c_null_char) exit
      text = text // letters(i)
    end do
    has_message = index(text, piece) > 0
    if (.not. has_message) print '(2a)', 'the message is: ', text
  end function has_message


  !> The last component of the first row of a quantity.
  real(DP) function value_of(handle, quantity, set)
    type(c_ptr), intent(in) :: handle
    character(*), intent(in) :: quantity, set
    real(c_double), target :: values(100)
    integer(c_int64_t), target :: rows, columns
    value_of = -huge(1.0_DP)
    if (c_get(handle, c_text(quantity), c_text(set), c_loc(values), 100_c_int64_t, c_loc(rows), c_loc(columns)) /= 0) return
    value_of = values(columns)
  end function value_of


  !> The version is cut off at the capacity.
  subroutine check_version()
    character(kind=c_char), target :: text(40)
    call suite%that('the binary interface', c_abi() == 4)
    text = 'x'
    call c_version(c_loc(text), 40_c_int64_t)
    call suite%that('the version', all(text(:len(VERSION)) == transfer(VERSION, text)) .and. text(len(VERSION) + 1) == c_null_char)
    text = 'x'
    call c_version(c_loc(text), 3_c_int64_t)
    call suite%that('cut off', all(text(:2) == transfer(VERSION(:2), text)) .and. text(3) == c_null_char .and. text(4) == 'x')
  end subroutine check_version


  !> Options: another interface, dialects, no deck, faults, a check only, a log_sink.
  subroutine check_open()
    type(options_type), target :: options
    type(c_ptr), target :: handle
    integer(c_int), target :: n_lines
    call suite%that('no place for the handle', c_open(c_loc(options), c_null_ptr) == EXIT_USAGE)
    handle = c_loc(n_lines)
    call suite%that('no options', c_open(c_null_ptr, c_loc(handle)) == EXIT_USAGE .and. .not. c_associated(handle))
    call suite%that('no deck', c_open(c_loc(options), c_loc(handle)) == EXIT_USAGE)
    call suite%that('its message', has_message(handle, 'needs a deck'))
    call c_close(handle)
    options%text = c_text(cube_deck())
    options%abi = 3
    call suite%that('another interface', c_open(c_loc(options), c_loc(handle)) == EXIT_USAGE)
    call suite%that('its message', has_message(handle, 'binary interface'))
    call c_close(handle)
    options%abi = 4
    options%dialect = c_text('nastran')
    call suite%that('another dialect', c_open(c_loc(options), c_loc(handle)) == EXIT_USAGE)
    call suite%that('its message', has_message(handle, 'abaqus or calculix'))
    call c_close(handle)
    options%dialect = c_text('CalculiX')
    options%n_partitions = 10000
    call suite%that('too many partitions', c_open(c_loc(options), c_loc(handle)) == EXIT_USAGE)
    call suite%that('its message', has_message(handle, 'is 10000; it can be 1 to 9999'))
    call c_close(handle)
    options%n_partitions = 0
    options%is_check = 1
    n_lines = 0
    options%log = c_funloc(count_line)
    options%context = c_loc(n_lines)
    call suite%that('a check only', c_open(c_loc(options), c_loc(handle)) == EXIT_SUCCESS)
    call suite%that('it is done, and was heard', c_is_done(handle) == 1 .and. n_lines > 3)
    call c_close(handle)
    options%text = c_text('*NODE' // NEWLINE // '1,0,x,0' // NEWLINE)
    call suite%that('a faulty deck', c_open(c_loc(options), c_loc(handle)) == EXIT_DECK)
    call suite%that('its message', has_message(handle, ':2: '))
    call c_close(handle)
  end subroutine check_open


  !> Values, names, and arrays that are too small.
  subroutine check_values()
    type(c_ptr) :: handle
    real(c_double), target :: values(30)
    integer(c_int64_t), target :: rows, columns, needed
    character(kind=c_char), target :: text(200)
    integer :: i, n
    logical :: found
    call open_cube(handle)
    call suite%that('the shape of X', c_get(handle, c_text('X'), c_text('TOP'), c_null_ptr, 0_c_int64_t, c_loc(rows), &
      c_loc(columns)) == EXIT_SUCCESS .and. rows == 4 .and. columns == 3)
    values = -7
    call suite%that('X', c_get(handle, c_text('X'), c_text('7'), c_loc(values), 3_c_int64_t, c_null_ptr, &
      c_null_ptr) == EXIT_SUCCESS)
    call suite%near('its three numbers', maxval(abs(values(:4) - [1.0_DP, 1.0_DP, 1.0_DP, -7.0_DP])), 0.0_DP, 0.0_DP)
    call suite%that('row by row', c_get(handle, c_text('X'), c_text('LEFT'), c_loc(values), 12_c_int64_t, c_null_ptr, &
      c_null_ptr) == EXIT_SUCCESS)
    call suite%near('the second row', maxval(abs(values(4:6) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
    call suite%that('too small', c_get(handle, c_text('X'), c_text('LEFT'), c_loc(values), 11_c_int64_t, c_null_ptr, &
      c_null_ptr) == EXIT_USAGE)
    call suite%that('its message', has_message(handle, 'too small'))
    call suite%that('nothing to set', c_set(handle, c_text('U3'), c_text('TOP'), c_loc(values), 0_c_int64_t) == EXIT_USAGE)
    call suite%that('its message', has_message(handle, 'No values of U3'))
    call suite%that('the capacity of names', c_names(handle, c_text('ELEMENT SETS'), c_null_ptr, 0_c_int64_t, c_loc(needed)) &
      == EXIT_SUCCESS)
    call suite%that('it holds CUBE', needed >= 5 .and. needed <= 200)
    text = 'x'
    call suite%that('names', c_names(handle, c_text('ELEMENT SETS'), c_loc(text), needed, c_null_ptr) == EXIT_SUCCESS)
    n = int(needed)
    call suite%that('they end there', text(n) == c_null_char .and. text(n + 1) == 'x')
    found = .false.
    do i = 1, n - 3
      found = found .or. all(text(i:i + 3) == ['C', 'U', 'B', 'E'])
    end do
    call suite%that('CUBE is one', found)
    call suite%that('names in too little space', c_names(handle, c_text('ELEMENT SETS'), c_loc(text), needed - 1, c_null_ptr) &
      == EXIT_USAGE)
    call suite%that('its message', has_message(handle, 'too small'))
    call suite%that('names of nonsense', c_names(handle, c_text('NONSENSE'), c_null_ptr, 0_c_int64_t, c_null_ptr) == EXIT_USAGE)
    call c_close(handle)
  end subroutine check_values


  !> All ways to solve.
  subroutine check_solving()
    type(c_ptr) :: handle
    integer(c_int), target :: verdict
    real(c_double), target :: target(1)
    integer :: n
    call open_cube(handle)
    call suite%that('not done', c_is_done(handle) == 0)
    call suite%that('advance', c_advance(handle) == EXIT_SUCCESS)
    call suite%near('to 0.25', value_of(handle, 'U', '7'), 0.0025_DP, TOL)
    call suite%that('advance to', c_advance_to(handle, 0.4_c_double) == EXIT_SUCCESS)
    call suite%near('to 0.4', value_of(handle, 'U', '7'), 0.004_DP, TOL)
    target = -0.002_DP
    call suite%that('set', c_set(handle, c_text('U3'), c_text('TOP'), c_loc(target), 1_c_int64_t) == EXIT_SUCCESS)
    call suite%that('try', c_try(handle, 0.1_c_double) == EXIT_SUCCESS)
    call suite%near('tried', value_of(handle, 'U', '7'), -0.002_DP, TOL)
    call suite%that('roll back', c_rollback(handle) == EXIT_SUCCESS)
    call suite%near('rolled back', value_of(handle, 'U', '7'), 0.004_DP, TOL)
    call suite%that('try nothing', c_try(handle, 0.0_c_double) == EXIT_USAGE)
    call suite%that('begin', c_begin(handle, 0.2_c_double) == EXIT_SUCCESS)
    call suite%that('commit too early', c_commit(handle) == EXIT_USAGE)
    n = 0
    verdict = int(VERDICT_CONTINUE, c_int)
    do while (verdict == VERDICT_CONTINUE .and. n < 10)
      call suite%that('iterate', c_iterate(handle, c_loc(verdict)) == EXIT_SUCCESS)
      n = n + 1
    end do
    call suite%that('converged', verdict == VERDICT_CONVERGED)
    call suite%that('commit', c_commit(handle) == EXIT_SUCCESS)
    call suite%that('nothing to roll back', c_rollback(handle) == EXIT_SUCCESS)
    call suite%near('committed', value_of(handle, 'STEP TIME', ''), 0.6_DP, TOL)
    call suite%that('to the end', c_advance_to(handle, 9.0_c_double) == EXIT_SUCCESS)
    call suite%that('done', c_is_done(handle) == 1)
    call suite%that('no further', c_advance(handle) == EXIT_USAGE)
    call suite%that('its message', has_message(handle, 'All steps'))
    call suite%that('finish', c_finish(handle) == EXIT_SUCCESS)
    call c_close(handle)
  end subroutine check_solving


  !> The map of 24 unknowns to 8 free ones, counted from 0.
  subroutine check_matrix()
    type(c_ptr) :: handle
    integer(c_int64_t), target :: rows, columns, entries, first(25), column(8)
    real(c_double), target :: values(8), residual(8)
    call open_cube(handle)
    call suite%that('no copy before a matrix', c_matrix_copy(handle, c_loc(first), c_loc(column), c_loc(values)) == EXIT_USAGE)
    call suite%that('no residual before', c_residual_copy(handle, c_loc(residual)) == EXIT_USAGE)
    call suite%that('no matrix before a step', c_matrix(handle, c_text('MAP'), c_null_ptr, c_null_ptr, c_null_ptr) == EXIT_USAGE)
    call suite%that('advance', c_advance(handle) == EXIT_SUCCESS)
    call suite%that('map', c_matrix(handle, c_text('MAP'), c_loc(rows), c_loc(columns), c_loc(entries)) == EXIT_SUCCESS)
    call suite%that('its sizes', rows == 24 .and. columns == 8 .and. entries == 8)
    if (rows /= 24 .or. entries /= 8) return
    call suite%that('copy', c_matrix_copy(handle, c_loc(first), c_loc(column), c_loc(values)) == EXIT_SUCCESS)
    call suite%that('rows from 0', first(1) == 0 .and. first(25) == 8)
    call suite%that('columns from 0', minval(column) == 0 .and. maxval(column) == 7)
    call suite%that('the x of node 2 is free, that of node 1 is not', first(5) == 1 .and. first(4) == 0)
    call suite%near('ones', maxval(abs(values - 1)), 0.0_DP, 0.0_DP)
    residual = 1
    call suite%that('residual', c_residual_copy(handle, c_loc(residual)) == EXIT_SUCCESS)
    call suite%near('it is zero', maxval(abs(residual)), 0.0_DP, TOL)
    call suite%that('a copy of nothing', c_matrix_copy(handle, c_null_ptr, c_null_ptr, c_null_ptr) == EXIT_SUCCESS)
    call c_close(handle)
  end subroutine check_matrix


  !> No function fails for a NULL handle.
  subroutine check_null()
    type(c_ptr) :: none
    none = c_null_ptr
    call suite%that('advance nothing', c_advance(none) == EXIT_USAGE)
    call suite%that('advance nothing to', c_advance_to(none, 1.0_c_double) == EXIT_USAGE)
    call suite%that('try nothing', c_try(none, 1.0_c_double) == EXIT_USAGE)
    call suite%that('begin nothing', c_begin(none, 1.0_c_double) == EXIT_USAGE)
    call suite%that('iterate nothing', c_iterate(none, none) == EXIT_USAGE)
    call suite%that('commit nothing', c_commit(none) == EXIT_USAGE)
    call suite%that('roll back nothing', c_rollback(none) == EXIT_USAGE)
    call suite%that('finish nothing', c_finish(none) == EXIT_USAGE)
    call suite%that('get nothing', c_get(none, none, none, none, 0_c_int64_t, none, none) == EXIT_USAGE)
    call suite%that('set nothing', c_set(none, none, none, none, 0_c_int64_t) == EXIT_USAGE)
    call suite%that('names of nothing', c_names(none, none, none, 0_c_int64_t, none) == EXIT_USAGE)
    call suite%that('matrix of nothing', c_matrix(none, none, none, none, none) == EXIT_USAGE)
    call suite%that('copy of nothing', c_matrix_copy(none, none, none, none) == EXIT_USAGE)
    call suite%that('residual of nothing', c_residual_copy(none, none) == EXIT_USAGE)
    call suite%that('nothing is done', c_is_done(none) == 1)
    call c_close(none)
  end subroutine check_null

end program test_c_interface
