!> Unit test of result_schema: rows of fields, columns that are written and read back, values that are not finite.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_result_schema
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
  use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_ptr
  use amontons_errors, only: error_type, EXIT_INTERNAL
  use amontons_hdf5_file, only: hdf5_file_type, hdf5_table_type, create_hdf5, close_hdf5
  use amontons_kinds, only: DP
  use amontons_result_schema, only: result_column_type, create_columns, open_columns, append_columns, write_columns, &
    check_finite, field_rows, POINT_COLUMNS, N_POINT_REALS, N_POINT_INTEGERS, STRAIN_COLUMN, INTEGRATION_COLUMNS, &
    CONTACT_COLUMNS, N_CONTACT_INTEGERS, N_CONTACT_REALS, PAIR_COLUMNS, N_PAIR_INTEGERS, N_PAIR_REALS, HISTORY_COLUMNS, &
    N_HISTORY_INTEGERS, N_HISTORY_REALS, ITERATION_COLUMNS, N_ITERATION_INTEGERS, N_ITERATION_REALS, STEP_COLUMNS, CONTROL_COLUMNS
  use check, only: suite_type
  use hdf5, only: HID_T, H5F_ACC_RDONLY_F, H5T_NATIVE_DOUBLE, H5T_NATIVE_INTEGER, h5open_f, h5fopen_f, h5fclose_f, h5dopen_f, &
    h5dread_f, h5dclose_f
  implicit none
  type(suite_type) :: suite
  call check_widths()
  call check_rows()
  call check_file()
  call check_finite_values()
  call suite%finish()

contains

  !> Numbers of values of each table; names once each; all units in brackets and all descriptions a sentence.
  subroutine check_widths()
    call suite%that('point columns', N_POINT_REALS == 35 .and. N_POINT_INTEGERS == 2)
    call expect('nodes', POINT_COLUMNS, N_POINT_INTEGERS, N_POINT_REALS)
    call expect('points', INTEGRATION_COLUMNS, 0, 14)
    call expect('contact', CONTACT_COLUMNS, N_CONTACT_INTEGERS, N_CONTACT_REALS)
    call expect('pairs', PAIR_COLUMNS, N_PAIR_INTEGERS, N_PAIR_REALS)
    call expect('history', HISTORY_COLUMNS, N_HISTORY_INTEGERS, N_HISTORY_REALS)
    call expect('iterations', ITERATION_COLUMNS, N_ITERATION_INTEGERS, N_ITERATION_REALS)
    call expect('steps', STEP_COLUMNS, 6, 5)
    call expect('controls', CONTROL_COLUMNS, 7, 12)
  end subroutine check_widths


  !> The columns of one table.
  subroutine expect(name, columns, n_integers, n_reals)
    character(*), intent(in) :: name
    type(result_column_type), intent(in) :: columns(:)
    integer, intent(in) :: n_integers, n_reals       !< values per row
    integer :: i, integers, reals
    integers = 0
    reals = 0
    do i = 1, size(columns)
      if (columns(i)%is_integer) then
        integers = integers + columns(i)%width
      else
        reals = reals + columns(i)%width
      end if
      call suite%that(name // ': ' // trim(columns(i)%name) // ' stands once', count(columns%name == columns(i)%name) == 1)
      call suite%that(name // ': ' // trim(columns(i)%name) // ' has unit and sentence', columns(i)%unit(1:1) == '[' .and. &
        index(columns(i)%unit, ']') == len_trim(columns(i)%unit) .and. index(columns(i)%description, '.', back=.true.) == &
        len_trim(columns(i)%description))
    end do
    call suite%that(name // ': widths', integers == n_integers .and. reals == n_reals)
  end subroutine expect


  !> Rows among the reals or the integers: one after another, without gaps.
  subroutine check_rows()
    integer :: i, n(2), rows(2), k
    n = 0
    do i = 1, size(POINT_COLUMNS)
      k = merge(1, 2, POINT_COLUMNS(i)%is_integer)
      rows = field_rows(trim(POINT_COLUMNS(i)%name))
      call suite%that('rows of ' // trim(POINT_COLUMNS(i)%name), rows(1) == n(k) + 1 .and. &
        rows(2) == n(k) + POINT_COLUMNS(i)%width)
      n(k) = rows(2)
    end do
    call suite%that('displacement first, strain after stress', all(field_rows('U') == [1, 3]) .and. all(field_rows('E') == [13, &
      18]))
    call suite%that('integers count apart', all(field_rows('CSCENARIO') == [2, 2]))
    call suite%that('the strain', POINT_COLUMNS(STRAIN_COLUMN)%name == 'E')
  end subroutine check_rows


  !> Columns that grow, are opened again and grow on; columns that do not grow.
  subroutine check_file()
    type(result_column_type), parameter :: COLUMNS(3) = [result_column_type('n', 1, '[-]', 'Number.', .true.), &
      result_column_type('x', 2, '[length]', 'Place.'), result_column_type('t', 1, '[time]', 'Time.')]
    type(hdf5_file_type) :: store
    type(hdf5_table_type), allocatable :: tables(:)
    type(error_type), allocatable :: error
    real(DP) :: x(2, 3), t(3)
    integer(c_int) :: n(3)
    call create_hdf5(store, 'test_result_schema.h5', error)
    call create_columns(store, '/rows', COLUMNS, 1, tables, error)
    call suite%that('created', .not. allocated(error) .and. size(tables) == 3)
    call append_columns(store, COLUMNS, reshape([7, 8], [1, 2]), reshape([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP], [3, &
      2]), &
      tables, error)
    call suite%that('two rows', .not. allocated(error) .and. all(tables%n_rows == 2))
    deallocate (tables)
    call open_columns(store, '/rows', COLUMNS, 1, tables, error)
    call append_columns(store, COLUMNS, reshape([9], [1, 1]), reshape([7.0_DP, 8.0_DP, 9.0_DP], [3, 1]), tables, error)
    call suite%that('one more', .not. allocated(error) .and. all(tables%n_rows == 3))
    call write_columns(store, '/fixed', COLUMNS([1, 3]), reshape([1, 2, 3], [1, 3]), reshape([0.5_DP, 0.25_DP, 0.125_DP], [1, 3]), &
      error)
    call suite%that('fixed', .not. allocated(error))
    call write_columns(store, '/fixed', COLUMNS([1, 3]), reshape([1, 2, 3], [1, 3]), reshape([0.5_DP, 0.25_DP, 0.125_DP], [1, 3]), &
      error)
    call suite%that('not twice', allocated(error))
    call open_columns(store, '/none', COLUMNS, 1, tables, error)
    call suite%that('no such group', allocated(error))
    call close_hdf5(store, error)
    call read_back('/rows/n', integers=n)
    call suite%that('integers', all(n == [7, 8, 9]))
    call read_back('/rows/t', reals=t)
    call suite%near('the column after the wide one', maxval(abs(t - [3.0_DP, 6.0_DP, 9.0_DP])), 0.0_DP, 0.0_DP)
    call read_back('/rows/x', matrix=x)
    call suite%near('the wide one', maxval(abs(x - reshape([1.0_DP, 2.0_DP, 4.0_DP, 5.0_DP, 7.0_DP, 8.0_DP], [2, 3]))), 0.0_DP, &
      0.0_DP)
    call read_back('/fixed/t', reals=t)
    call suite%near('fixed reals', t(3), 0.125_DP, 0.0_DP)
  end subroutine check_file


  !> Reads one data set of the file with HDF5 itself.
  subroutine read_back(name, integers, reals, matrix)
    character(*), intent(in) :: name
    integer(c_int), intent(out), target, optional :: integers(:)
    real(DP), intent(out), target, optional :: reals(:), matrix(:, :)
    integer(HID_T) :: file, set
    integer :: status
    type(c_ptr) :: place
    call h5open_f(status)
    call h5fopen_f('test_result_schema.h5', H5F_ACC_RDONLY_F, file, status)
    call h5dopen_f(file, name, set, status)
    if (present(integers)) place = c_loc(integers)
    if (present(reals)) place = c_loc(reals)
    if (present(matrix)) place = c_loc(matrix)
    call h5dread_f(set, merge(H5T_NATIVE_INTEGER, H5T_NATIVE_DOUBLE, present(integers)), place, status)
    call suite%that('read ' // name, status == 0)
    call h5dclose_f(set, status)
    call h5fclose_f(file, status)
  end subroutine read_back


  !> The first value that is not finite, by column and row.
  subroutine check_finite_values()
    type(result_column_type), parameter :: COLUMNS(3) = [result_column_type('x', 2), result_column_type('n', 1, &
      is_integer=.true.), &
      result_column_type('t', 1)]
    type(error_type), allocatable :: error
    real(DP) :: values(3, 4)
    values = 1.0_DP
    call check_finite('node', COLUMNS, values, error)
    call suite%that('finite', .not. allocated(error))
    values(3, 2) = ieee_value(1.0_DP, ieee_positive_inf)
    call check_finite('node', COLUMNS, values, error)
    call suite%that('infinite', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_INTERNAL .and. &
      index(error%message, 't is not a finite number at node 2 ') == 1)
    values(2, 4) = ieee_value(1.0_DP, ieee_quiet_nan)
    call check_finite('node', COLUMNS, values, error)
    call suite%that('the first column with one', allocated(error))
    if (allocated(error)) call suite%that(error%message, index(error%message, 'x is not a finite number at node 4 ') == 1)
  end subroutine check_finite_values

end program test_result_schema
