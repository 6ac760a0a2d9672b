!> Reading .frd files of CalculiX and Amontons: nodes, elements and the blocks of nodal results, in text or binary.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The file is read once from its start: nodes and elements are kept, of the results where each block lies. A block is read when
!! it is needed. Format numbers: 0 and 1 text with node numbers of 5 and 10 digits, 2 binary with 32-bit reals, 3 with 64-bit
!! reals. Reference: G. Dhondt, CalculiX GraphiX user's manual, section "Result Format".
module amontons_frd_input
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use, intrinsic :: iso_fortran_env, only: INT32, REAL32
  use amontons_kinds, only: DP, I64
  use amontons_containers, only: label_table_type
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_text, only: parse_integer, parse_real, to_text, NUMBER_OK, NEWLINE
  use amontons_element_kinds, only: KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D15, KIND_C3D20, KIND_CPS3, KIND_CPS4, &
    KIND_CPS6, KIND_CPS8
  implicit none
  private
  public :: frd_input_type, frd_block_type, open_frd_input, close_frd_input, read_frd_block, FRD_VALUES_PER_LINE

  integer, parameter :: FORMAT_SHORT = 0, FORMAT_BINARY = 2, FORMAT_BINARY_DOUBLE = 3
  integer, parameter :: BUFFER_LENGTH = 4000000        !< [bytes]
  integer, parameter :: MAX_LINE = 400                 !< more is no line of text [bytes]
  integer, parameter :: FRD_VALUES_PER_LINE = 6        !< of a row in text

  ! Of the element types 1 to 12 of CGX: nodes, and the kind of the same shape; 0: of no shape that has an inside.
  integer, parameter :: N_CGX_NODES(12) = [8, 6, 4, 20, 15, 10, 3, 6, 4, 8, 2, 3]
  integer, parameter :: CGX_KIND(12) = [KIND_C3D8, KIND_C3D6, KIND_C3D4, KIND_C3D20, KIND_C3D15, KIND_C3D10, KIND_CPS3, KIND_CPS6, &
    KIND_CPS4, KIND_CPS8, 0, 0]

  !> One block of nodal results.
  type :: frd_block_type
    character(8) :: name = ''                          !< 'DISP', 'NDTEMP', 'STRESS', ...
    integer :: step = 0                                !< of the job
    integer :: data_set = 0                            !< its number, which the blocks of one increment share
    real(DP) :: time = 0                               !< total time [time]
    integer :: n_rows = 0                              !< nodes
    integer :: n_values = 0                            !< per node
    integer :: format = 1
    integer(I64) :: place = 0                          !< of the first row in the file, from 1 [byte]
  end type frd_block_type

  !> A file open for reading.
  type :: frd_input_type
    character(:), allocatable :: path
    integer :: n_nodes = 0
    real(DP), allocatable :: coordinates(:, :)         !< (3, n_nodes) [length]
    integer :: n_elements = 0
    integer, allocatable :: kind(:)                    !< (n_elements) KIND_... of this shape, or 0
    integer, allocatable :: first(:)                   !< (n_elements + 1) start of an element's nodes in nodes(:)
    integer, allocatable :: nodes(:)                   !< in the order of a deck
    integer, allocatable :: element_label(:)           !< (n_elements)
    type(frd_block_type), allocatable :: blocks(:)
    type(label_table_type), private :: labels          !< of the nodes
    integer, private :: unit = -1
    integer(I64), private :: file_size = 0, buffer_start = 1, next = 1     !< [bytes]
    character(:), allocatable, private :: buffer
  end type frd_input_type

contains

  !> Opens a file and reads its mesh and the places of its results. Errors: EXIT_IO.
  subroutine open_frd_input(input, path, error)
    type(frd_input_type), intent(out) :: input
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    type(frd_block_type) :: block
    character(:), allocatable :: line
    logical :: is_ok, is_end
    integer :: status, step
    input%path = path
    open (newunit=input%unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=status)
    if (status == 0) inquire (unit=input%unit, size=input%file_size)
    if (status /= 0) then
      call set_error(error, EXIT_IO, 'The file ' // path // ' cannot be opened: it is missing or not readable.')
      return
    end if
    allocate (input%blocks(0))
    is_ok = .true.
    step = 0
    do
      call next_line(input, line, is_end)
      if (is_end) exit
      select case (line(:min(6, len(line))))
      case ('    2C')
        call read_nodes(input, line, is_ok)
      case ('    3C')
        call read_elements(input, line, is_ok)
      case ('    1P')
        if (index(line, 'PSTEP') == 6) step = integer_at(line, 49, 60)
      case ('  100C')
        block%step = step
        call read_head(input, line, block, is_ok)
        if (is_ok) input%blocks = [input%blocks, block]
        if (is_ok) call pass_rows(input, block)
      case (' 9999')
        exit
      end select
      if (.not. is_ok) exit
    end do
    if (is_ok .and. input%n_nodes > 0 .and. input%n_elements > 0) return
    call set_error(error, EXIT_IO, 'The file ' // path // ' has no nodes and elements of a .frd file, or is damaged before byte ' &
      // to_text(int(min(input%next, int(huge(1), I64)))) // '.')
    call close_frd_input(input)
  end subroutine open_frd_input


  !> Closes a file.
  subroutine close_frd_input(input)
    type(frd_input_type), intent(inout) :: input
    if (input%unit /= -1) close (input%unit)
    input%unit = -1
  end subroutine close_frd_input


  !> The values of a block at all nodes; 0 at those that it does not have. Errors: EXIT_IO.
  subroutine read_frd_block(input, block, values, is_given, error)
    type(frd_input_type), intent(inout) :: input
    type(frd_block_type), intent(in) :: block
    real(DP), allocatable, intent(out) :: values(:, :) !< (block%n_values, n_nodes)
    logical, allocatable, intent(out) :: is_given(:)   !< (n_nodes)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: labels(:)
    real(DP), allocatable :: rows(:, :)
    logical :: is_ok
    integer :: i, node
    input%next = block%place
    is_ok = .true.
    call read_rows(input, block%n_rows, block%n_values, block%format, labels, rows, is_ok)
    allocate (values(block%n_values, input%n_nodes), source=0.0_DP)
    allocate (is_given(input%n_nodes), source=.false.)
    do i = 1, block%n_rows
      if (.not. is_ok) exit
      node = input%labels%find(labels(i))
      if (node == 0) cycle
      values(:, node) = rows(:, i)
      is_given(node) = .true.
    end do
    if (.not. is_ok) call set_error(error, EXIT_IO, 'The block ' // trim(block%name) // ' of step ' // to_text(block%step) // &
      ' in ' // input%path // ' is damaged.')
  end subroutine read_frd_block


  !> The block of the nodes.
  subroutine read_nodes(input, line, is_ok)
    type(frd_input_type), intent(inout) :: input
    character(*), intent(in) :: line                   !< its head
    logical, intent(inout) :: is_ok
    integer, allocatable :: labels(:)
    input%n_nodes = integer_at(line, 25, 36)
    call read_rows(input, input%n_nodes, 3, integer_at(line, 74, 75), labels, input%coordinates, is_ok)
    if (is_ok) is_ok = all(labels > 0)
    if (is_ok) call input%labels%build(labels)
  end subroutine read_nodes


  !> The block of the elements.
  subroutine read_elements(input, line, is_ok)
    type(frd_input_type), intent(inout) :: input
    character(*), intent(in) :: line                   !< its head
    logical, intent(inout) :: is_ok
    integer :: nodes(20), e, format, label, shape, n, i
    integer, allocatable :: all_nodes(:)
    input%n_elements = integer_at(line, 25, 36)
    format = integer_at(line, 74, 75)
    allocate (input%kind(input%n_elements), input%first(input%n_elements + 1), input%element_label(input%n_elements), &
      all_nodes(20 * input%n_elements))
    input%first(1) = 1
    do e = 1, input%n_elements
      call read_element(input, format, label, shape, nodes, is_ok)
      if (.not. is_ok) return
      n = N_CGX_NODES(shape)
      if (n == 20) nodes(13:) = nodes([17, 18, 19, 20, 13, 14, 15, 16])      ! upright edges before those of the top
      if (n == 15) nodes(10:15) = nodes([13, 14, 15, 10, 11, 12])
      input%element_label(e) = label
      input%kind(e) = CGX_KIND(shape)
      input%first(e + 1) = input%first(e) + n
      do i = 1, n
        all_nodes(input%first(e) + i - 1) = input%labels%find(nodes(i))
      end do
    end do
    input%nodes = all_nodes(:input%first(input%n_elements + 1) - 1)
    is_ok = all(input%nodes > 0)
  end subroutine read_elements


  !> One element.
  subroutine read_element(input, format, label, shape, nodes, is_ok)
    type(frd_input_type), intent(inout) :: input
    integer, intent(in) :: format
    integer, intent(out) :: label, shape               !< shape: type number of CGX
    integer, intent(out) :: nodes(20)                  !< in the order of CGX
    logical, intent(inout) :: is_ok
    character(:), allocatable :: line
    integer :: width, i, k, n
    logical :: is_end
    nodes = 0
    if (format >= FORMAT_BINARY) then
      call next_integers(input, nodes(:4), is_ok)
      label = nodes(1)
      shape = nodes(2)
      is_ok = is_ok .and. shape >= 1 .and. shape <= size(CGX_KIND)
      if (is_ok) call next_integers(input, nodes(:N_CGX_NODES(shape)), is_ok)
      return
    end if
    width = merge(5, 10, format == FORMAT_SHORT)
    call next_line(input, line, is_end)
    label = integer_at(line, 4, 3 + width)
    shape = integer_at(line, 4 + width, 8 + width)
    is_ok = is_ok .and. .not. is_end .and. index(line, ' -1') == 1 .and. shape >= 1 .and. shape <= size(CGX_KIND)
    if (.not. is_ok) return
    n = 0
    do while (n < N_CGX_NODES(shape) .and. is_ok)
      call next_line(input, line, is_end)
      is_ok = .not. is_end .and. index(line, ' -2') == 1
      k = min(merge(15, 10, width == 5), N_CGX_NODES(shape) - n)
      do i = 1, k
        nodes(n + i) = integer_at(line, 4 + (i - 1) * width, 3 + i * width)
      end do
      n = n + k
    end do
  end subroutine read_element


  !> The head of a block of results, up to its rows.
  subroutine read_head(input, line, block, is_ok)
    type(frd_input_type), intent(inout) :: input
    character(*), intent(in) :: line                   !< the first line
    type(frd_block_type), intent(inout) :: block       !< with its step
    logical, intent(inout) :: is_ok
    character(:), allocatable :: next
    logical :: is_end
    integer(I64) :: before
    block%time = real_at(line, 13, 24)
    block%n_rows = integer_at(line, 25, 36)
    block%data_set = integer_at(line, 59, 63)
    block%format = integer_at(line, 74, 75)
    block%n_values = 0
    call next_line(input, next, is_end)
    is_ok = is_ok .and. .not. is_end .and. index(next, ' -4') == 1
    if (.not. is_ok) return
    block%name = adjustl(next(5:min(13, len(next))))
    do
      before = input%next
      call next_line(input, next, is_end)
      if (index(next, ' -5') /= 1) exit
      if (integer_at(next, 34, 38) == 0) block%n_values = block%n_values + 1    ! 1: CGX computes this component
    end do
    input%next = before
    block%place = before
  end subroutine read_head


  !> Passes over the rows of a block. Rows of text end at a line -3.
  subroutine pass_rows(input, block)
    type(frd_input_type), intent(inout) :: input
    type(frd_block_type), intent(in) :: block
    character(:), allocatable :: line
    logical :: is_end
    if (block%format >= FORMAT_BINARY) then
      input%next = input%next + int(block%n_rows, I64) * row_bytes(block%n_values, block%format)
      return
    end if
    do
      call next_line(input, line, is_end)
      if (is_end .or. index(line, ' -3') == 1) exit
    end do
  end subroutine pass_rows


  !> Bytes of a binary row.
  pure integer(I64) function row_bytes(n_values, format)
    integer, intent(in) :: n_values, format
    row_bytes = 4_I64 + int(n_values, I64) * merge(8_I64, 4_I64, format == FORMAT_BINARY_DOUBLE)
  end function row_bytes


  !> Rows of a number and reals.
  subroutine read_rows(input, n_rows, n_values, format, labels, values, is_ok)
    type(frd_input_type), intent(inout) :: input
    integer, intent(in) :: n_rows, n_values, format
    integer, allocatable, intent(out) :: labels(:)     !< (n_rows)
    real(DP), allocatable, intent(out) :: values(:, :) !< (n_values, n_rows)
    logical, intent(inout) :: is_ok
    character(:), allocatable :: line
    integer :: i, k, offset, at
    logical :: is_end
    allocate (labels(n_rows), source=0)
    allocate (values(n_values, n_rows), source=0.0_DP)
    offset = merge(8, 13, format == FORMAT_SHORT)
    do i = 1, n_rows
      if (.not. is_ok) return
      if (format >= FORMAT_BINARY) then
        call next_integers(input, labels(i:i), is_ok)
        call next_reals(input, format, values(:, i), is_ok)
        cycle
      end if
      do k = 1, n_values
        at = mod(k - 1, FRD_VALUES_PER_LINE)
        if (at == 0) then
          call next_line(input, line, is_end)
          is_ok = is_ok .and. .not. is_end .and. (index(line, ' -1') == 1 .or. (k > 1 .and. index(line, ' -2') == 1))
          if (.not. is_ok) return
          if (k == 1) labels(i) = integer_at(line, 4, offset)
        end if
        call read_value(line, offset + 1 + 12 * at, values(k, i), is_ok)
      end do
    end do
  end subroutine read_rows


  !> A value of a row; NaN, infinity and what is no number are damage.
  subroutine read_value(line, first, value, is_ok)
    character(*), intent(in) :: line
    integer, intent(in) :: first                       !< its first column; it has twelve
    real(DP), intent(out) :: value
    logical, intent(inout) :: is_ok
    integer :: status
    value = 0
    status = NUMBER_OK - 1
    if (len(line) >= first) call parse_real(line(first:min(first + 11, len(line))), value, status)
    is_ok = is_ok .and. status == NUMBER_OK
  end subroutine read_value


  !> Binary integers of 32 bits.
  subroutine next_integers(input, values, is_ok)
    type(frd_input_type), intent(inout) :: input
    integer, intent(out) :: values(:)
    logical, intent(inout) :: is_ok
    integer(INT32) :: raw(size(values))
    integer(I64) :: at, n
    raw = 0
    n = 4_I64 * size(values, kind=I64)
    call fill_buffer(input, n, at, is_ok)
    if (is_ok) raw = transfer(input%buffer(at:at + n - 1_I64), raw)
    values = raw
  end subroutine next_integers


  !> Binary reals of 32 or 64 bits.
  subroutine next_reals(input, format, values, is_ok)
    type(frd_input_type), intent(inout) :: input
    integer, intent(in) :: format
    real(DP), intent(out) :: values(:)
    logical, intent(inout) :: is_ok
    real(REAL32) :: raw(size(values))
    integer(I64) :: at, n
    n = size(values, kind=I64) * merge(8_I64, 4_I64, format == FORMAT_BINARY_DOUBLE)
    values = 0
    call fill_buffer(input, n, at, is_ok)
    if (.not. is_ok) return
    if (format == FORMAT_BINARY_DOUBLE) then
      values = transfer(input%buffer(at:at + n - 1_I64), values)
    else
      raw = transfer(input%buffer(at:at + n - 1_I64), raw)
      values = real(raw, DP)
    end if
    is_ok = all(ieee_is_finite(values))
  end subroutine next_reals


  !> The next line of text, without its end.
  subroutine next_line(input, line, is_end)
    type(frd_input_type), intent(inout) :: input
    character(:), allocatable, intent(out) :: line     !< empty at the end of the file
    logical, intent(out) :: is_end
    integer(I64) :: at, n, length
    logical :: is_ok
    line = ''
    is_ok = .true.
    n = min(int(MAX_LINE, I64), input%file_size - input%next + 1_I64)
    is_end = n <= 0_I64
    if (is_end) return
    call fill_buffer(input, n, at, is_ok)
    is_end = .not. is_ok
    if (is_end) return
    length = int(index(input%buffer(at:at + n - 1_I64), NEWLINE), I64) - 1_I64
    if (length < 0_I64) length = n
    line = input%buffer(at:at + length - 1_I64)
    input%next = input%next - n + length + 1_I64
    if (length > 0_I64) then
      if (line(length:length) == achar(13)) line = line(:length - 1_I64)
    end if
  end subroutine next_line


  !> Brings the next bytes into the buffer and passes over them.
  subroutine fill_buffer(input, n, at, is_ok)
    type(frd_input_type), intent(inout) :: input
    integer(I64), intent(in) :: n                      !< bytes, at most BUFFER_LENGTH
    integer(I64), intent(out) :: at                    !< the first of them in the buffer
    logical, intent(inout) :: is_ok
    integer(I64) :: length
    integer :: status
    at = 1
    if (input%next + n - 1_I64 > input%file_size .or. input%next < 1_I64) is_ok = .false.
    if (.not. is_ok) return
    if (.not. allocated(input%buffer)) input%buffer = ''
    if (input%next < input%buffer_start .or. input%next + n > input%buffer_start + len(input%buffer, I64)) then
      length = min(int(BUFFER_LENGTH, I64), input%file_size - input%next + 1_I64)
      if (len(input%buffer, I64) /= length) then
        deallocate (input%buffer)
        allocate (character(length) :: input%buffer)
      end if
      read (input%unit, pos=input%next, iostat=status) input%buffer
      is_ok = status == 0
      input%buffer_start = input%next
    end if
    at = input%next - input%buffer_start + 1_I64
    input%next = input%next + n
  end subroutine fill_buffer


  !> The integer in columns of a line; 0 if there is none.
  pure integer function integer_at(line, first, last) result(value)
    character(*), intent(in) :: line
    integer, intent(in) :: first, last
    integer :: status
    value = 0
    if (len(line) < first) return
    call parse_integer(line(first:min(last, len(line))), value, status)
    if (status /= NUMBER_OK) value = 0
  end function integer_at


  !> The real in columns of a line; 0 if there is none.
  pure real(DP) function real_at(line, first, last) result(value)
    character(*), intent(in) :: line
    integer, intent(in) :: first, last
    integer :: status
    value = 0
    if (len(line) < first) return
    call parse_real(line(first:min(last, len(line))), value, status)
    if (status /= NUMBER_OK) value = 0
  end function real_at

end module amontons_frd_input
