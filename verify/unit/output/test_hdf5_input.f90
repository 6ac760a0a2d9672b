!> Unit test of hdf5_input: what hdf5_file writes is read again, whole or some rows; what is missing or no HDF5 is an error.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_hdf5_input
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_hdf5_file, only: hdf5_file_type, create_hdf5, close_hdf5, create_group, write_data, STORAGE_I64, STORAGE_U8
  use amontons_hdf5_input, only: hdf5_input_type, open_hdf5_input, close_hdf5_input, has_data_set, read_integers, read_reals, &
    read_texts
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call write_sample()
  call check_values()
  call check_errors()
  call suite%finish()

contains

  !> The file.
  subroutine write_sample()
    type(hdf5_file_type) :: store
    type(error_type), allocatable :: error
    integer :: i
    call create_hdf5(store, 'input.h5', error)
    call create_group(store, '/a', error)
    call write_data(store, '/a/long', [(i, i=1, 3000)], '[-]', 'Many integers.', error, STORAGE_I64)
    call write_data(store, '/a/bytes', [0, 12, 255], '[-]', 'Bytes.', error, STORAGE_U8)
    call write_data(store, '/a/list', [0.5_DP, 1.5_DP, 2.5_DP], '[-]', 'Reals.', error)
    call write_data(store, '/a/table', reshape([(0.25_DP * real(i, DP), i=1, 6000)], [3, 2000]), '[-]', 'A table.', error)
    call write_data(store, '/a/texts', ['one  ', 'three'], '[-]', 'Texts.', error)
    call write_data(store, '/a/nothing', [integer ::], '[-]', 'Nothing.', error)
    call close_hdf5(store, error)
    call suite%that('the sample is written', .not. allocated(error))
  end subroutine write_sample


  !> All kinds of data sets.
  subroutine check_values()
    type(hdf5_input_type) :: input
    type(error_type), allocatable :: error
    integer, allocatable :: numbers(:)
    real(DP), allocatable :: values(:, :)
    character(:), allocatable :: texts(:)
    integer :: i
    call open_hdf5_input(input, 'input.h5', error)
    call suite%that('open', input%is_open .and. .not. allocated(error))
    call suite%that('has', has_data_set(input, '/a/long') .and. .not. has_data_set(input, '/a/short') .and. &
      .not. has_data_set(input, '/b/long'))
    call read_integers(input, '/a/long', numbers, error)
    call suite%that('compressed integers', size(numbers) == 3000 .and. all(numbers == [(i, i=1, 3000)]))
    call read_integers(input, '/a/bytes', numbers, error)
    call suite%that('bytes', all(numbers == [0, 12, 255]))
    call read_integers(input, '/a/nothing', numbers, error)
    call suite%that('nothing', size(numbers) == 0 .and. .not. allocated(error))
    call read_reals(input, '/a/list', values, error)
    call suite%near('list', maxval(abs(values - reshape([0.5_DP, 1.5_DP, 2.5_DP], [1, 3]))), 0.0_DP, 0.0_DP)
    call read_reals(input, '/a/list', values, error, 1_I64, 2_I64)
    call suite%near('rows of a list', maxval(abs(values - reshape([1.5_DP, 2.5_DP], [1, 2]))), 0.0_DP, 0.0_DP)
    call read_reals(input, '/a/table', values, error)
    call suite%that('shape', all(shape(values) == [3, 2000]))
    call suite%near('table', maxval(abs(values - reshape([(0.25_DP * real(i, DP), i=1, 6000)], [3, 2000]))), 0.0_DP, 0.0_DP)
    call read_reals(input, '/a/table', values, error, 1998_I64, 2_I64)
    call suite%near('last rows', maxval(abs(values - reshape([(0.25_DP * real(i, DP), i=5995, 6000)], [3, 2]))), 0.0_DP, 0.0_DP)
    call read_texts(input, '/a/texts', texts, error)
    call suite%that('texts', texts(1) == 'one' .and. texts(2) == 'three' .and. .not. allocated(error))
    call close_hdf5_input(input)
    call suite%that('closed', .not. input%is_open)
  end subroutine check_values


  !> Missing files and data sets, rows beyond the end, a file of another kind.
  subroutine check_errors()
    type(hdf5_input_type) :: input
    type(error_type), allocatable :: error
    real(DP), allocatable :: values(:, :)
    integer :: unit
    call open_hdf5_input(input, 'missing.h5', error)
    call suite%that('missing file', allocated(error) .and. .not. input%is_open)
    open (newunit=unit, file='text.h5', action='write')
    write (unit, '(a)') 'no HDF5'
    close (unit)
    call open_hdf5_input(input, 'text.h5', error)
    call suite%that('a text', allocated(error))
    if (allocated(error)) call suite%that('its code', error%code == EXIT_IO .and. index(error%message, 'text.h5') > 0)
    call open_hdf5_input(input, 'input.h5', error)
    call read_reals(input, '/a/short', values, error)
    call suite%that('missing data set', allocated(error))
    if (allocated(error)) call suite%that('its name', index(error%message, '/a/short') > 0)
    call read_reals(input, '/a/table', values, error, 1999_I64, 2_I64)
    call suite%that('rows beyond the end', allocated(error))
    call close_hdf5_input(input)
  end subroutine check_errors

end program test_hdf5_input
