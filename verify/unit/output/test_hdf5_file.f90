!> HDF5 files: written data are read back with HDF5 itself; failures are errors with path and action, never printed text.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_hdf5_file
  use, intrinsic :: iso_fortran_env, only: int64
  use hdf5, only: HID_T, HSIZE_T, SIZE_T, H5F_ACC_RDONLY_F, H5T_NATIVE_DOUBLE, H5T_NATIVE_INTEGER, h5aclose_f, &
    h5aget_type_f, h5aopen_by_name_f, h5aread_f, h5dclose_f, h5dget_space_f, h5dget_type_f, h5dopen_f, &
    h5dread_f, h5fclose_f, h5fopen_f, h5sclose_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, &
    h5tclose_f, h5tget_size_f
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_hdf5_file, only: append_rows, close_hdf5, create_group, create_hdf5, create_table, flush_hdf5, &
    hdf5_layout_type, hdf5_file_type, hdf5_table_type, write_attribute, write_data, STORAGE_I32, STORAGE_I64, STORAGE_TEXT, &
    STORAGE_U8
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite

  call test_data(suite)
  call test_tables(suite)
  call test_packing(suite)
  call test_readable_while_open(suite)
  call test_errors(suite)
  call test_full_disk(suite)
  call suite%finish()

contains

  !> Data sets of fixed size: values, shape, size of a value in the file, label, attributes.
  subroutine test_data(suite)
    type(suite_type), intent(inout) :: suite
    type(hdf5_file_type) :: store
    type(error_type), allocatable :: error
    integer :: i, long(3000)
    real(DP) :: matrix(3, 2)
    matrix = reshape([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.5_DP], [3, 2])
    long = [(i, i=1, 3000)]
    call create_hdf5(store, 'data.h5', error)
    call expect(suite, 'create_store', error)
    call suite%that('the store is open', store%is_open)
    call create_group(store, '/a', error)
    call expect(suite, 'create_group', error)
    call write_data(store, '/a/real', [0.1_DP, -2.0e300_DP], '[length]', 'Two reals.', error)
    call expect(suite, 'reals', error)
    call write_data(store, '/a/matrix', matrix, '[force]', 'A matrix.', error)
    call expect(suite, 'real matrix', error)
    call write_data(store, '/a/long', long, '[-]', 'Many integers.', error, STORAGE_I64)
    call expect(suite, 'integers', error)
    call write_data(store, '/a/bytes', [0, 12, 255], '[-]', 'Bytes.', error, STORAGE_U8)
    call expect(suite, 'bytes', error)
    call write_data(store, '/a/pairs', reshape(long(:6), [2, 3]), '[-]', 'Pairs.', error)
    call expect(suite, 'integer matrix', error)
    call write_data(store, '/a/text', 'gap ' // char(195) // char(169), '[-]', 'A text.', error)
    call expect(suite, 'text', error)
    call write_data(store, '/a/no_text', '', '[-]', 'An empty text.', error)
    call expect(suite, 'empty text', error)
    call write_data(store, '/a/texts', ['one  ', 'three'], '[-]', 'Texts.', error)
    call expect(suite, 'texts', error)
    call write_data(store, '/a/nothing', [integer ::], '[-]', 'Nothing.', error)
    call expect(suite, 'empty list', error)
    call write_attribute(store, '/a', 'count', [7], error)
    call write_attribute(store, '/a', 'count', [8], error)
    call expect(suite, 'attribute is overwritten', error)
    call close_hdf5(store, error)
    call expect(suite, 'close_store', error)
    call suite%that('the store is closed', .not. store%is_open)

    call suite%that('reals are exact', same(reals_of('data.h5', '/a/real', 2), [0.1_DP, -2.0e300_DP]))
    call suite%that('matrix is exact', same(reals_of('data.h5', '/a/matrix', 6), [matrix]))
    call suite%that('matrix is 2 x 3 in C', all(extent_of('data.h5', '/a/matrix') == [2, 3]))
    call suite%that('compressed integers are exact', all(integers_of('data.h5', '/a/long', 3000) == long))
    call suite%that('long integers take 8 bytes', value_size('data.h5', '/a/long') == 8)
    call suite%that('bytes are exact', all(integers_of('data.h5', '/a/bytes', 3) == [0, 12, 255]))
    call suite%that('bytes take 1 byte', value_size('data.h5', '/a/bytes') == 1)
    call suite%that('integers take 4 bytes', value_size('data.h5', '/a/pairs') == 4)
    call suite%that('a text takes its length', value_size('data.h5', '/a/text') == 6)
    call suite%that('an empty text takes one NUL', value_size('data.h5', '/a/no_text') == 1)
    call suite%that('texts have one length', value_size('data.h5', '/a/texts') == 5)
    call suite%that('an empty list is empty', all(extent_of('data.h5', '/a/nothing') == [0, 0]))
    call suite%that('attribute has its last value', attribute_of('data.h5', '/a', 'count') == 8)
    call suite%that('unit is written as it is', attribute_size('data.h5', '/a/real', 'unit') == len('[length]'))
    call suite%that('description too', attribute_size('data.h5', '/a/real', 'description') == len('Two reals.'))
  end subroutine test_data


  !> Tables grow row by row and block by block, also across chunk borders.
  subroutine test_tables(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: N = 500, BLOCKS = 5
    type(hdf5_file_type) :: store
    type(hdf5_table_type) :: column, blocks_table, longs, words, integers
    type(error_type), allocatable :: error
    real(DP) :: block(3, N), read_back(3, N, BLOCKS)
    integer :: i, read_integers(2, 300)
    call create_hdf5(store, 'tables.h5', error)
    call create_table(store, column, '/column', hdf5_layout_type(), '[time]', 'A column.', error)
    call expect(suite, 'create a column', error)
    call create_table(store, blocks_table, '/blocks', hdf5_layout_type(width=3, n_rows_hint=N), '[-]', 'Blocks.', error)
    call expect(suite, 'create a table of blocks', error)
    call create_table(store, longs, '/longs', hdf5_layout_type(storage=STORAGE_I64, is_matrix=.true.), '[-]', 'Long.', error)
    call expect(suite, 'create a table of long integers', error)
    call create_table(store, words, '/words', hdf5_layout_type(storage=STORAGE_TEXT, width=4), '[-]', 'Words.', error)
    call expect(suite, 'create a table of texts', error)
    call create_table(store, integers, '/integers', hdf5_layout_type(storage=STORAGE_I32, width=2), '[-]', 'Integers.', error)
    do i = 1, 300
      call append_rows(store, column, reshape([real(i, DP)], [1, 1]), error)
      if (.not. allocated(error)) call append_rows(store, integers, reshape([i, -i], [2, 1]), error)
      if (allocated(error)) exit
    end do
    call expect(suite, 'add 300 rows', error)
    do i = 1, BLOCKS
      block = real(i, DP)
      block(2, N) = -real(i, DP)
      call append_rows(store, blocks_table, block, error)
      call expect(suite, 'add a block', error)
    end do
    call append_rows(store, blocks_table, block(:, :0), error)
    call expect(suite, 'add no rows', error)
    call append_rows(store, longs, 5000000000_int64, error)
    call expect(suite, 'add a long integer', error)
    call append_rows(store, words, 'ab', error)
    call append_rows(store, words, 'too long', error)
    call expect(suite, 'add texts', error)
    call suite%that('rows are counted', column%n_rows == 300 .and. blocks_table%n_rows == N * BLOCKS)
    call close_hdf5(store, error)
    call expect(suite, 'close', error)

    call suite%that('column is exact', same(reals_of('tables.h5', '/column', 300), [(real(i, DP), i=1, 300)]))
    call suite%that('blocks follow each other', all(extent_of('tables.h5', '/blocks') == [N * BLOCKS, 3]))
    read_back = reshape(reals_of('tables.h5', '/blocks', 3 * N * BLOCKS), [3, N, BLOCKS])
    do i = 1, BLOCKS
      block = real(i, DP)
      block(2, N) = -real(i, DP)
      call suite%that('block is exact', same([read_back(:, :, i)], [block]))
    end do
    read_integers = reshape(integers_of('tables.h5', '/integers', 600), [2, 300])
    call suite%that('integer rows are exact', all(read_integers(1, :) == [(i, i=1, 300)]) &
      .and. all(read_integers(2, :) == [(-i, i=1, 300)]))
    call suite%that('long integer is exact', same(reals_of('tables.h5', '/longs', 1), [5.0e9_DP]))
    call suite%that('long table is a matrix', all(extent_of('tables.h5', '/longs') == [1, 1]))
    call suite%that('texts are rows', all(extent_of('tables.h5', '/words') == [2, 0]))
    call suite%that('texts are cut to their length', value_size('tables.h5', '/words') == 4)
  end subroutine test_tables


  !> Blocks compressed by pack_shim.c and decompressed by HDF5. The eight byte planes contain noise, one value, two, runs of
  !! sixteen, and bytes each twice as frequent as the previous one, whose Huffman codes would be longer than deflate allows. Equal
  !! values have codes of their own: of small bytes and of large ones, and runs of deflate's longest repetition, more and less.
  subroutine test_packing(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: LENGTHS(3) = [1000, 46367, 200000], EQUAL_LENGTHS(5) = [2, 258, 259, 260, 100000]
    real(DP), parameter :: EQUAL_VALUES(4) = [0.0_DP, -0.0_DP, 293.15_DP, -3.7e200_DP]
    integer :: k, i
    do k = 1, size(LENGTHS)
      call check_packing(suite, mixed_words(LENGTHS(k)))
    end do
    do k = 1, size(EQUAL_LENGTHS)
      do i = 1, size(EQUAL_VALUES)
        call check_packing(suite, spread(transfer(EQUAL_VALUES(i), 0_int64), 1, EQUAL_LENGTHS(k)))
      end do
    end do
  end subroutine test_packing


  !> One block, there and back.
  subroutine check_packing(suite, words)
    type(suite_type), intent(inout) :: suite
    integer(int64), intent(in) :: words(:)
    type(hdf5_file_type) :: store
    type(hdf5_table_type) :: table
    type(error_type), allocatable :: error
    integer(int64), allocatable :: found(:)
    integer :: n
    n = size(words)
    call create_hdf5(store, 'packed.h5', error)
    call create_table(store, table, '/packed', hdf5_layout_type(width=1, n_rows_hint=n), '[-]', 'Bytes.', error)
    call append_rows(store, table, reshape(transfer(words, [0.0_DP]), [1, n]), error)
    call close_hdf5(store, error)
    call expect(suite, 'pack', error)
    found = transfer(reals_of('packed.h5', '/packed', n), found)
    call suite%that('packed and unpacked to the bit', size(found) == size(words))
    if (size(found) == size(words)) call suite%that('the same bits', all(found == words))
  end subroutine check_packing


  !> Words whose bytes are distributed in different ways; no NaN and no infinity.
  function mixed_words(n) result(words)
    integer, intent(in) :: n
    integer(int64) :: words(n), bytes(8)
    integer :: doubled(n), i, k, a, many
    i = 1
    a = 1
    k = 0
    do while (i <= n)                              ! byte k so often as 2^k
      many = min(a, n - i + 1)
      doubled(i:i + many - 1) = k
      i = i + many
      k = k + 1
      a = 2 * a
    end do
    do i = 1, n
      bytes(1) = mod(int(i, int64) * 2654435761_int64 / 65536_int64, 256_int64)
      bytes(2) = 7
      bytes(3) = merge(200_int64, 3_int64, mod(i, 5) < 2)
      bytes(4) = mod(bytes(1), 16_int64)
      bytes(5) = int(doubled(i), int64)
      bytes(6) = int(doubled(1 + int(mod(int(i, int64) * 40503_int64, int(n, int64)))), int64)
      bytes(7) = 15 - mod(bytes(1), 16_int64)
      bytes(8) = merge(63_int64, 191_int64, mod(bytes(1), 3_int64) == 0_int64)
      words(i) = 0
      do k = 8, 1, -1
        words(i) = ior(ishft(words(i), 8), bytes(k))
      end do
    end do
  end function mixed_words


  !> After a flush another reader finds the rows although the file is open: no lock, and a consistent file.
  subroutine test_readable_while_open(suite)
    type(suite_type), intent(inout) :: suite
    type(hdf5_file_type) :: store
    type(hdf5_table_type) :: column
    type(error_type), allocatable :: error
    integer :: status
    call create_hdf5(store, 'open.h5', error)
    call create_table(store, column, '/column', hdf5_layout_type(), '[time]', 'A column.', error)
    call append_rows(store, column, reshape([1.5_DP], [1, 1]), error)
    call flush_hdf5(store, error)
    call expect(suite, 'flush_store', error)
    call execute_command_line('cp open.h5 copy.h5', exitstat=status)
    call suite%that('the file of an open store can be copied', status == 0)
    call suite%that('the copy is whole', same(reals_of('copy.h5', '/column', 1), [1.5_DP]))
    call close_hdf5(store, error)
  end subroutine test_readable_while_open


  !> Each failure is an error with EXIT_IO, the path and the action.
  subroutine test_errors(suite)
    type(suite_type), intent(inout) :: suite
    type(hdf5_file_type) :: store, other
    type(hdf5_table_type) :: table
    type(error_type), allocatable :: error
    call create_hdf5(store, 'no/such/folder/x.h5', error)
    call expect_error(suite, error, 'Result file no/such/folder/x.h5: cannot create it')
    call suite%that('it is not open', .not. store%is_open)
    call close_hdf5(store, error)
    call expect(suite, 'closing what is not open', error)
    call create_hdf5(store, 'errors.h5', error)
    call create_group(store, '/g', error)
    call create_group(store, '/g', error)
    call expect_error(suite, error, 'Result file errors.h5: cannot create the group /g.')
    call write_data(store, '/no/group', [1], '[-]', 'Nowhere.', error)
    call expect_error(suite, error, 'Result file errors.h5: cannot write the data set /no/group.')
    call write_data(store, '/no/text', 'text', '[-]', 'Nowhere.', error)
    call expect_error(suite, error, 'Result file errors.h5: cannot write the data set /no/text.')
    call write_attribute(store, '/nothing', 'name', [1], error)
    call expect_error(suite, error, 'Result file errors.h5: cannot write the attribute name of /nothing.')
    call create_table(store, table, '/no/table', hdf5_layout_type(), '[-]', 'Nowhere.', error)
    call expect_error(suite, error, 'Result file errors.h5: cannot create the table /no/table.')
    call append_rows(store, table, reshape([1.0_DP], [1, 1]), error)
    call expect_error(suite, error, 'Result file errors.h5: cannot add rows to /no/table')
    call create_table(store, table, '/table', hdf5_layout_type(), '[-]', 'A table.', error)
    call create_hdf5(other, 'other.h5', error)
    call close_hdf5(store, error)
    call expect(suite, 'closing with a table open', error)
    call append_rows(store, table, reshape([1.0_DP], [1, 1]), error)
    call expect_error(suite, error, 'Result file errors.h5: cannot add rows to /table')
    call flush_hdf5(store, error)
    call expect_error(suite, error, 'Result file errors.h5: cannot write it to disk')
    call create_group(other, '/still/open', error)
    call expect_error(suite, error, 'Result file other.h5: cannot create the group /still/open.')
    call create_group(other, '/still', error)
    call expect(suite, 'the other store is still open', error)
    call close_hdf5(other, error)
  end subroutine test_errors


  !> A full disk (the device that reports one): the error comes at the flush at the latest, and closing returns.
  subroutine test_full_disk(suite)
    type(suite_type), intent(inout) :: suite
    type(hdf5_file_type) :: store
    type(error_type), allocatable :: error
    logical :: is_there
    inquire (file='/dev/full', exist=is_there)
    if (.not. is_there) return
    call create_hdf5(store, '/dev/full', error)
    if (.not. allocated(error)) call create_group(store, '/g', error)
    if (.not. allocated(error)) call flush_hdf5(store, error)
    call expect_error(suite, error, 'Result file /dev/full: cannot ')
    call close_hdf5(store, error)
    call suite%that('a store on a full disk closes', .not. store%is_open)
  end subroutine test_full_disk


  subroutine expect(suite, name, error)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: name
    type(error_type), allocatable, intent(in) :: error
    if (allocated(error)) call suite%that(name // ': ' // error%message, .false.)
    if (.not. allocated(error)) call suite%that(name, .true.)
  end subroutine expect


  subroutine expect_error(suite, error, message)
    type(suite_type), intent(inout) :: suite
    type(error_type), allocatable, intent(in) :: error
    character(*), intent(in) :: message             !< beginning of the message
    call suite%that('there is an error: ' // message, allocated(error))
    if (.not. allocated(error)) return
    call suite%that('EXIT_IO: ' // error%message, error%code == EXIT_IO)
    call suite%that(message // ' - not: ' // error%message, index(error%message, message) == 1)
  end subroutine expect_error


  !> Bit for bit the same numbers.
  pure function same(a, b) result(is_same)
    real(DP), intent(in) :: a(:), b(:)
    logical :: is_same
    is_same = all(abs(a - b) <= 0)
  end function same


  !> A data set as reals, in the order of the file.
  function reals_of(path, name, n) result(values)
    character(*), intent(in) :: path, name
    integer, intent(in) :: n
    real(DP) :: values(n)
    integer(HID_T) :: file, data
    integer :: status
    values = huge(1.0_DP)
    call h5fopen_f(path, H5F_ACC_RDONLY_F, file, status)
    call h5dopen_f(file, name, data, status)
    call h5dread_f(data, H5T_NATIVE_DOUBLE, values, [int(n, HSIZE_T)], status)
    call h5dclose_f(data, status)
    call h5fclose_f(file, status)
  end function reals_of


  !> A data set as integers, in the order of the file.
  function integers_of(path, name, n) result(values)
    character(*), intent(in) :: path, name
    integer, intent(in) :: n
    integer :: values(n)
    integer(HID_T) :: file, data
    integer :: status
    values = huge(1)
    call h5fopen_f(path, H5F_ACC_RDONLY_F, file, status)
    call h5dopen_f(file, name, data, status)
    call h5dread_f(data, H5T_NATIVE_INTEGER, values, [int(n, HSIZE_T)], status)
    call h5dclose_f(data, status)
    call h5fclose_f(file, status)
  end function integers_of


  !> Extent of a data set as C and Python see it; 0 for a dimension that it does not have.
  function extent_of(path, name) result(extent)
    character(*), intent(in) :: path, name
    integer :: extent(2)
    integer(HID_T) :: file, data, space
    integer(HSIZE_T) :: dims(2), limits(2)
    integer :: status, rank
    call h5fopen_f(path, H5F_ACC_RDONLY_F, file, status)
    call h5dopen_f(file, name, data, status)
    call h5dget_space_f(data, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    dims = 0
    call h5sget_simple_extent_dims_f(space, dims(:rank), limits(:rank), status)
    extent = 0
    extent(:rank) = int(dims(rank:1:-1))
    call h5sclose_f(space, status)
    call h5dclose_f(data, status)
    call h5fclose_f(file, status)
  end function extent_of


  !> Bytes of a value in the file.
  function value_size(path, name) result(bytes)
    character(*), intent(in) :: path, name
    integer :: bytes, status
    integer(HID_T) :: file, data, type
    integer(SIZE_T) :: n
    call h5fopen_f(path, H5F_ACC_RDONLY_F, file, status)
    call h5dopen_f(file, name, data, status)
    call h5dget_type_f(data, type, status)
    call h5tget_size_f(type, n, status)
    bytes = int(n)
    call h5tclose_f(type, status)
    call h5dclose_f(data, status)
    call h5fclose_f(file, status)
  end function value_size


  !> Bytes of a text attribute in the file.
  function attribute_size(path, object, name) result(bytes)
    character(*), intent(in) :: path, object, name
    integer :: bytes, status
    integer(HID_T) :: file, attribute, type
    integer(SIZE_T) :: n
    call h5fopen_f(path, H5F_ACC_RDONLY_F, file, status)
    call h5aopen_by_name_f(file, object, name, attribute, status)
    call h5aget_type_f(attribute, type, status)
    call h5tget_size_f(type, n, status)
    bytes = int(n)
    call h5tclose_f(type, status)
    call h5aclose_f(attribute, status)
    call h5fclose_f(file, status)
  end function attribute_size


  !> An integer attribute.
  function attribute_of(path, object, name) result(value)
    character(*), intent(in) :: path, object, name
    integer :: value, status
    integer(HID_T) :: file, attribute
    value = huge(1)
    call h5fopen_f(path, H5F_ACC_RDONLY_F, file, status)
    call h5aopen_by_name_f(file, object, name, attribute, status)
    call h5aread_f(attribute, H5T_NATIVE_INTEGER, value, [1_HSIZE_T], status)
    call h5aclose_f(attribute, status)
    call h5fclose_f(file, status)
  end function attribute_of

end program test_hdf5_file
