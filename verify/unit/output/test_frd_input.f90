!> Unit test of frd_input: nodes, elements in the order of a deck, and blocks, in long and short text and in binary; damaged files.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_frd_input
  use, intrinsic :: iso_fortran_env, only: int32, real32, real64
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: KIND_C3D8, KIND_C3D20, KIND_CPS3
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_frd_input, only: frd_input_type, frd_block_type, open_frd_input, close_frd_input, read_frd_block
  use check, only: suite_type
  implicit none
  integer, parameter :: TEXT_SHORT = 0, TEXT_LONG = 1, BINARY = 2
  integer, parameter :: N_NODES = 22
  character(*), parameter :: NL = new_line('a')
  type(suite_type) :: suite
  integer :: format
  do format = TEXT_SHORT, BINARY
    call check_file(format)
  end do
  call check_damage()
  call suite%finish()

contains

  !> A value of a node that six digits hold.
  elemental real(DP) function value_of(node, k) result(value)
    integer, intent(in) :: node, k
    value = 0.25_DP * real(node, DP) - real(k, DP)
  end function value_of


  !> A file with a triangle, a hexahedron of 20 nodes and one of 8, two blocks of displacements and one of temperatures, the last
  !! of them without node 5. Node i has the number 10 i.
  subroutine write_file(format, path, last_value)
    integer, intent(in) :: format                  !< TEXT_... or BINARY
    character(*), intent(in) :: path
    character(*), intent(in) :: last_value         !< of twelve characters, of texts
    integer :: unit, i, k, step
    open (newunit=unit, file=path, access='stream', form='unformatted', action='write', status='replace')
    write (unit) '    1C' // NL // '    1UUSER' // NL
    call write_head(unit, '    2C', N_NODES, merge(3, format, format == BINARY))
    do i = 1, N_NODES
      if (format == BINARY) then
        write (unit) int(10 * i, int32), (real(value_of(i, k), real64), k=1, 3)
      else
        call write_row(unit, format, 10 * i, [(value_of(i, k), k=1, 3)])
      end if
    end do
    if (format /= BINARY) write (unit) ' -3' // NL
    call write_head(unit, '    3C', 3, format)
    call write_element(unit, format, 7, 7, [1, 2, 3])
    call write_element(unit, format, 8, 4, [(i, i=1, 20)])
    call write_element(unit, format, 90, 1, [(i, i=3, 10)])
    if (format /= BINARY) write (unit) ' -3' // NL
    do step = 1, 2
      call write_block_head(unit, format, step, N_NODES, 'DISP    ', 3)
      do i = 1, N_NODES
        if (format == BINARY) then
          write (unit) int(10 * i, int32), (real(real(step, DP) * value_of(i, k), real32), k=1, 3)
        else
          call write_row(unit, format, 10 * i, [(real(step, DP) * value_of(i, k), k=1, 3)])
        end if
      end do
      if (format /= BINARY) write (unit) ' -3' // NL
    end do
    call write_block_head(unit, format, 2, N_NODES - 1, 'NDTEMP  ', 1)
    do i = 1, N_NODES
      if (i == 5) cycle
      if (format == BINARY) then
        write (unit) int(10 * i, int32), real(value_of(i, 0), real32)
      else if (i == N_NODES) then
        write (unit) ' -1' // trim(number(10 * i, format)) // last_value // NL
      else
        call write_row(unit, format, 10 * i, [value_of(i, 0)])
      end if
    end do
    if (format /= BINARY) write (unit) ' -3' // NL
    write (unit) ' 9999' // NL
    close (unit)
  end subroutine write_file


  !> The head of nodes and elements.
  subroutine write_head(unit, key, n, format)
    integer, intent(in) :: unit, n, format
    character(*), intent(in) :: key
    character(75) :: line
    write (line, '(a6,18x,i12,37x,i1)') key, n, format
    write (unit) line // NL
  end subroutine write_head


  !> The head of a block; a last component is one that CGX computes.
  subroutine write_block_head(unit, format, step, n, name, n_values)
    integer, intent(in) :: unit, format, step, n, n_values
    character(8), intent(in) :: name
    character(75) :: line
    integer :: k
    write (line, '(a,i26,2i12)') '    1PSTEP', 40 + step, 1, step
    write (unit) line // NL
    write (line, '(a,i5,es12.5,i12,20x,i2,i5,10x,i2)') '  100CL', 100 + step, 0.5_DP * real(step, DP), n, 0, step + 6, format
    write (unit) line // NL
    write (line, '(a,a8,2i5)') ' -4  ', name, n_values + 1, 1
    write (unit) line // NL
    do k = 1, n_values + 1
      write (line, '(a,a8,5i5,a)') ' -5  ', 'D', 1, 2, k, 0, merge(0, 1, k <= n_values), merge('   ', 'ALL', k <= n_values)
      write (unit) trim(line) // NL
    end do
  end subroutine write_block_head


  !> A node number in its columns.
  function number(label, format)
    integer, intent(in) :: label, format
    character(10) :: number
    if (format == TEXT_SHORT) write (number, '(i5)') label
    if (format == TEXT_LONG) write (number, '(i10)') label
  end function number


  !> A row of text.
  subroutine write_row(unit, format, label, values)
    integer, intent(in) :: unit, format, label
    real(DP), intent(in) :: values(:)
    character(36) :: text
    write (text, '(3es12.5)') values
    write (unit) ' -1' // trim(number(label, format)) // trim(text) // NL
  end subroutine write_row


  !> An element.
  subroutine write_element(unit, format, label, shape, nodes)
    integer, intent(in) :: unit, format, label, shape, nodes(:)
    integer :: i, per_line
    character(15) :: rest
    if (format == BINARY) then
      write (unit) int([label, shape, 0, 1, 10 * nodes], int32)
      return
    end if
    write (rest, '(3i5)') shape, 0, 1
    write (unit) ' -1' // trim(number(label, format)) // rest // NL
    per_line = merge(15, 10, format == TEXT_SHORT)
    do i = 1, size(nodes)
      if (mod(i, per_line) == 1) write (unit) ' -2'
      write (unit) trim(number(10 * nodes(i), format))
      if (mod(i, per_line) == 0 .or. i == size(nodes)) write (unit) NL
    end do
  end subroutine write_element


  !> Mesh and blocks.
  subroutine check_file(format)
    integer, intent(in) :: format
    type(frd_input_type) :: input
    type(error_type), allocatable :: error
    real(DP), allocatable :: values(:, :)
    logical, allocatable :: is_given(:)
    character(2) :: name
    integer :: i, k, b
    write (name, '(i1,a)') format, ' '
    call write_file(format, 'sample.frd', ' 5.50000E+00')
    call open_frd_input(input, 'sample.frd', error)
    call suite%that(name // 'opened', .not. allocated(error))
    if (allocated(error)) return
    call suite%that(name // 'nodes', input%n_nodes == N_NODES)
    call suite%near(name // 'coordinates', maxval(abs(input%coordinates - reshape([((value_of(i, k), k=1, 3), i=1, N_NODES)], [3, &
      N_NODES]))), 0.0_DP, 0.0_DP)
    call suite%that(name // 'elements', all(input%element_label == [7, 8, 90]) .and. all(input%kind == [KIND_CPS3, KIND_C3D20, &
      KIND_C3D8]) .and. all(input%first == [1, 4, 24, 32]))
    call suite%that(name // 'upright edges come last', all(input%nodes(4:23) == [(i, i=1, 12), 17, 18, 19, 20, 13, 14, 15, 16]))
    call suite%that(name // 'blocks', all(input%blocks%step == [1, 2, 2]) .and. all(input%blocks%data_set == [7, 8, 8]) .and. &
      all(input%blocks%n_values == [3, 3, 1]) .and. input%blocks(3)%name == 'NDTEMP')
    call suite%near(name // 'time', input%blocks(2)%time, 1.0_DP, 0.0_DP)
    do b = 2, 1, -1                                ! in any order
      call read_frd_block(input, input%blocks(b), values, is_given, error)
      call suite%that(name // 'all given', all(is_given) .and. .not. allocated(error))
      call suite%near(name // 'displacements', maxval(abs(values - real(b, DP) * input%coordinates)), 0.0_DP, 0.0_DP)
    end do
    call read_frd_block(input, input%blocks(3), values, is_given, error)
    call suite%that(name // 'one not given', count(is_given) == N_NODES - 1 .and. .not. is_given(5))
    call suite%near(name // 'temperature', values(1, N_NODES), 5.5_DP, 0.0_DP)
    call close_frd_input(input)
  end subroutine check_file


  !> Files that are missing, empty, cut off, or with a value that is no number.
  subroutine check_damage()
    type(frd_input_type) :: input
    type(error_type), allocatable :: error
    real(DP), allocatable :: values(:, :)
    logical, allocatable :: is_given(:)
    character(2000) :: start
    integer :: unit
    call open_frd_input(input, 'missing.frd', error)
    call suite%that('missing', allocated(error))
    if (allocated(error)) call suite%that('its code', error%code == EXIT_IO)
    call write_file(TEXT_LONG, 'sample.frd', '         NaN')
    call open_frd_input(input, 'sample.frd', error)
    call read_frd_block(input, input%blocks(3), values, is_given, error)
    call suite%that('NaN', allocated(error))
    call close_frd_input(input)
    open (newunit=unit, file='sample.frd', access='stream', form='unformatted', action='read')
    read (unit) start
    close (unit)
    call write_start(start(:1500))                 ! within the elements
    call open_frd_input(input, 'cut.frd', error)
    call suite%that('cut off', allocated(error))
    call write_start('')
    call open_frd_input(input, 'cut.frd', error)
    call suite%that('empty', allocated(error))
    call write_start('no results' // NL)
    call open_frd_input(input, 'cut.frd', error)
    call suite%that('another text', allocated(error))
  end subroutine check_damage


  !> A file of a text.
  subroutine write_start(text)
    character(*), intent(in) :: text
    integer :: unit
    open (newunit=unit, file='cut.frd', access='stream', form='unformatted', action='write', status='replace')
    write (unit) text
    close (unit)
  end subroutine write_start

end program test_frd_input
