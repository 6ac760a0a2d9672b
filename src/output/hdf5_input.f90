!> Reading data sets of HDF5 files, whole or some of their rows.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Files are opened for reading alone and without a file lock, so that the job that writes one is not disturbed.
module amontons_hdf5_input
  use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_hdf5_file, only: set_no_lock
  use hdf5, only: HID_T, HSIZE_T, SIZE_T, H5F_ACC_RDONLY_F, H5P_FILE_ACCESS_F, H5S_SELECT_SET_F, &
    H5T_NATIVE_DOUBLE, H5_INTEGER_KIND, h5dclose_f, h5dget_space_f, h5dget_type_f, h5dopen_f, h5dread_f, &
    h5eset_auto_f, h5fclose_f, h5fopen_f, h5iis_valid_f, h5kind_to_type, h5lexists_f, h5open_f, h5pclose_f, h5pcreate_f, &
    h5sclose_f, h5screate_simple_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f, h5tclose_f, &
    h5tget_size_f
  implicit none
  private
  public :: hdf5_input_type, open_hdf5_input, close_hdf5_input, has_data_set, read_integers, read_reals, read_texts

  !> A file open for reading.
  type :: hdf5_input_type
    private
    integer(HID_T) :: file = -1
    logical, public :: is_open = .false.
    character(:), allocatable, public :: path
  end type hdf5_input_type

contains

  !> Opens a file. Errors: EXIT_IO.
  subroutine open_hdf5_input(input, path, error)
    type(hdf5_input_type), intent(out) :: input
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: access
    integer :: status, unused
    logical :: is_ready
    input%path = path
    call h5iis_valid_f(H5T_NATIVE_DOUBLE, is_ready, status)
    if (.not. is_ready) call h5open_f(status)
    call h5eset_auto_f(0, unused)
    call h5pcreate_f(H5P_FILE_ACCESS_F, access, status)
    call set_no_lock(access)
    if (status >= 0) call h5fopen_f(path, H5F_ACC_RDONLY_F, input%file, status, access)
    call h5pclose_f(access, unused)
    input%is_open = status >= 0
    if (.not. input%is_open) call set_error(error, EXIT_IO, 'The file ' // path // ' cannot be opened as a .vtkhdf file: it ' // &
      'is missing, not readable, or no HDF5 file.')
  end subroutine open_hdf5_input


  !> Closes a file.
  subroutine close_hdf5_input(input)
    type(hdf5_input_type), intent(inout) :: input
    integer :: unused
    if (input%is_open) call h5fclose_f(input%file, unused)
    input%is_open = .false.
  end subroutine close_hdf5_input


  !> Whether a data set is there; all groups on its path are tested.
  logical function has_data_set(input, name) result(is_there)
    type(hdf5_input_type), intent(in) :: input
    character(*), intent(in) :: name                   !< full path
    integer :: k, status
    is_there = .true.
    do k = 2, len(name)
      if (k < len(name) .and. name(k:k) /= '/') cycle
      call h5lexists_f(input%file, name(:merge(k, k - 1, k == len(name))), is_there, status)
      is_there = is_there .and. status >= 0
      if (.not. is_there) return
    end do
  end function has_data_set


  !> A list of integers.
  subroutine read_integers(input, name, values, error)
    type(hdf5_input_type), intent(in) :: input
    character(*), intent(in) :: name
    integer, allocatable, intent(out) :: values(:)     !< all rows; of a table row by row
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable, target :: buffer(:)
    integer(HSIZE_T) :: extent(2)
    integer(HID_T) :: data
    type(c_ptr) :: place
    integer :: status, unused
    call open_data(input, name, data, extent, error)
    if (allocated(error)) return
    allocate (buffer(max(1_HSIZE_T, product(extent))))
    status = 0
    place = c_loc(buffer)
    if (product(extent) > 0) call h5dread_f(data, h5kind_to_type(I64, H5_INTEGER_KIND), place, status)
    call h5dclose_f(data, unused)
    if (status < 0) call set_damage(input, name, error)
    if (allocated(error)) return
    values = int(buffer(:product(extent)))
  end subroutine read_integers


  !> Rows of a table of reals.
  subroutine read_reals(input, name, values, error, first, n_rows)
    type(hdf5_input_type), intent(in) :: input
    character(*), intent(in) :: name
    real(DP), allocatable, target, intent(out) :: values(:, :)   !< (values per row, rows)
    type(error_type), allocatable, intent(out) :: error
    integer(I64), intent(in), optional :: first        !< first row, from 0; default: all rows
    integer(I64), intent(in), optional :: n_rows       !< with `first`: their number
    integer(HSIZE_T) :: extent(2), start(2), counts(2)
    integer(HID_T) :: data, space, memory
    type(c_ptr) :: place
    integer :: s(4), rank, unused
    call open_data(input, name, data, extent, error)
    if (allocated(error)) return
    start = 0
    counts = extent
    if (present(first)) then
      start(2) = first
      counts(2) = n_rows
    end if
    allocate (values(extent(1), max(1_HSIZE_T, counts(2))), source=0.0_DP)
    s = 0
    if (start(2) + counts(2) > extent(2)) s(1) = -1
    if (s(1) >= 0 .and. product(counts) > 0) then
      call h5dget_space_f(data, space, s(1))
      call h5sget_simple_extent_ndims_f(space, rank, s(2))
      if (rank == 1) then
        start(1) = start(2)
        counts(1) = counts(2)
      end if
      call h5sselect_hyperslab_f(space, H5S_SELECT_SET_F, start(:rank), counts(:rank), s(2))
      call h5screate_simple_f(rank, counts(:rank), memory, s(3))
      place = c_loc(values)
      if (all(s >= 0)) call h5dread_f(data, H5T_NATIVE_DOUBLE, place, s(4), memory, space)
      call h5sclose_f(memory, unused)
      call h5sclose_f(space, unused)
    end if
    call h5dclose_f(data, unused)
    if (any(s < 0)) call set_damage(input, name, error)
  end subroutine read_reals


  !> A list of texts of one length.
  subroutine read_texts(input, name, values, error)
    type(hdf5_input_type), intent(in) :: input
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: values(:)   !< without the NUL behind them
    type(error_type), allocatable, intent(out) :: error
    character(1), allocatable, target :: buffer(:, :)
    integer(HSIZE_T) :: extent(2)
    integer(HID_T) :: data, type
    integer(SIZE_T) :: length
    type(c_ptr) :: place
    integer :: s(3), unused, i, k
    call open_data(input, name, data, extent, error)
    if (allocated(error)) return
    s = 0
    call h5dget_type_f(data, type, s(1))
    call h5tget_size_f(type, length, s(2))
    allocate (buffer(length, max(1_HSIZE_T, product(extent))))
    buffer = ' '
    place = c_loc(buffer)
    if (all(s >= 0) .and. product(extent) > 0) call h5dread_f(data, type, place, s(3))
    call h5tclose_f(type, unused)
    call h5dclose_f(data, unused)
    if (any(s < 0)) call set_damage(input, name, error)
    allocate (character(length) :: values(product(extent)))
    do i = 1, size(values)
      do k = 1, int(length)
        if (iachar(buffer(k, i)) == 0) exit
      end do
      buffer(k:, i) = ' '
      values(i) = transfer(buffer(:, i), values(i))
    end do
  end subroutine read_texts


  !> Opens a data set; its extent is (values per row, rows).
  subroutine open_data(input, name, data, extent, error)
    type(hdf5_input_type), intent(in) :: input
    character(*), intent(in) :: name
    integer(HID_T), intent(out) :: data
    integer(HSIZE_T), intent(out) :: extent(2)
    type(error_type), allocatable, intent(out) :: error
    integer(HSIZE_T) :: dims(2), max_dims(2)
    integer(HID_T) :: space
    integer :: status, rank, unused
    extent = 0
    if (.not. has_data_set(input, name)) then
      call set_error(error, EXIT_IO, 'The file ' // input%path // ' has no ' // name // ': it is no result file of Amontons.')
      return
    end if
    call h5dopen_f(input%file, name, data, status)
    if (status < 0) then
      call set_damage(input, name, error)
      return
    end if
    call h5dget_space_f(data, space, status)
    call h5sget_simple_extent_ndims_f(space, rank, status)
    dims = 1
    if (status >= 0 .and. rank >= 1 .and. rank <= 2) call h5sget_simple_extent_dims_f(space, dims(:rank), max_dims(:rank), status)
    call h5sclose_f(space, unused)
    if (rank < 0 .or. rank > 2) status = -1
    if (rank == 0) dims = 1
    extent = dims
    if (rank == 1) extent = [1_HSIZE_T, dims(1)]
    if (status >= 0) return
    call h5dclose_f(data, unused)
    call set_damage(input, name, error)
  end subroutine open_data


  !> The error of a data set that cannot be read.
  subroutine set_damage(input, name, error)
    type(hdf5_input_type), intent(in) :: input
    character(*), intent(in) :: name
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_IO, 'The data set ' // name // ' of ' // input%path // ' cannot be read: the file is damaged ' // &
      'or of another program.')
  end subroutine set_damage

end module amontons_hdf5_input
