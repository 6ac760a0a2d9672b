!> Virtual data sets of HDF5: a data set whose rows lie in other files, one block of rows after the other.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! File f has n(f) rows of a data set of the same name. The virtual data set has those of the first file, then those of the
!! second, ... If the data set grows by frames, file f has n(f) rows per frame, and the virtual one has sum(n) rows per frame, with
!! the files in the same order. It grows with the files: its selections are unlimited, so that it is written once.
!!
!! Reference: HDF5 reference manual, H5Pset_virtual; a name without folder is looked for beside the file itself.
module amontons_virtual_data_sets
  use amontons_kinds, only: I64
  use amontons_errors, only: error_type
  use amontons_hdf5_file, only: hdf5_file_type, hdf5_layout_type, hdf5_table_type, rank_of, extent_of, open_types, close_types, &
    write_label, check_status, create_table
  use hdf5, only: HID_T, HSIZE_T, H5P_DATASET_CREATE_F, H5S_SELECT_SET_F, H5S_UNLIMITED_F, h5dclose_f, h5dcreate_f, h5pclose_f, &
    h5pcreate_f, h5pset_virtual_f, h5sclose_f, h5screate_simple_f, h5sselect_hyperslab_f
  implicit none
  private
  public :: source_files_type, create_virtual

  !> The files with the rows.
  type :: source_files_type
    character(:), allocatable :: name(:)          !< of each file, without folder
  end type source_files_type

contains

  !> Creates a virtual data set. Cost: that of its description, whatever the number of rows. Errors: EXIT_IO.
  subroutine create_virtual(store, sources, n_rows, name, form, is_growing, unit, description, error)
    type(hdf5_file_type), intent(in) :: store
    type(source_files_type), intent(in) :: sources
    integer, intent(in) :: n_rows(:)              !< rows in each file, per frame if it grows
    character(*), intent(in) :: name              !< full path in this file and in each source
    type(hdf5_layout_type), intent(in) :: form    !< type of a row
    logical, intent(in) :: is_growing
    character(*), intent(in) :: unit, description
    type(error_type), allocatable, intent(out) :: error
    type(hdf5_table_type) :: empty
    integer(HID_T) :: file_type, memory_type, space, list, data
    integer(I64) :: total
    integer :: s(6), f, unused
    total = sum(int(n_rows, I64))
    if (total == 0_I64) then                      ! HDF5 has no virtual data sets without rows
      call create_table(store, empty, name, form, unit, description, error)
      return
    end if
    s = 0
    call open_types(form, file_type, memory_type, s(1))
    call h5pcreate_f(H5P_DATASET_CREATE_F, list, s(2))
    call create_space(form, total, is_growing, space, s(3))
    do f = 1, size(n_rows)
      if (n_rows(f) > 0 .and. all(s >= 0)) call add_source(list, form, trim(sources%name(f)), name, &
        [sum(int(n_rows(:f - 1), I64)), int(n_rows(f), I64), total], is_growing, s(4))
    end do
    if (all(s >= 0)) call h5dcreate_f(store%file, name, file_type, space, data, s(5), list)
    if (all(s >= 0)) call h5dclose_f(data, s(6))
    call h5sclose_f(space, unused)
    call h5pclose_f(list, unused)
    call close_types(form, file_type)
    call check_status(store, s, 'write the virtual data set ' // name, error)
    if (.not. allocated(error)) call write_label(store, name, unit, description, error)
  end subroutine create_virtual


  !> The rows of one file.
  subroutine add_source(list, form, file, name, rows, is_growing, status)
    integer(HID_T), intent(in) :: list            !< property list of the data set
    type(hdf5_layout_type), intent(in) :: form
    character(*), intent(in) :: file, name
    integer(I64), intent(in) :: rows(3)           !< before it, of it, of all files
    logical, intent(in) :: is_growing
    integer, intent(out) :: status                !< negative: it failed
    integer(HID_T) :: here, there
    integer :: s(5), unused
    s = 0
    call create_space(form, rows(3), is_growing, here, s(1))
    call create_space(form, rows(2), is_growing, there, s(2))
    if (all(s >= 0)) call select_rows(here, form, rows(1), rows(2), rows(3), is_growing, s(3))
    if (all(s >= 0)) call select_rows(there, form, 0_I64, rows(2), rows(2), is_growing, s(4))
    if (all(s >= 0)) call h5pset_virtual_f(list, here, file, name, there, s(5))
    call h5sclose_f(there, unused)
    call h5sclose_f(here, unused)
    status = minval(s)
  end subroutine add_source


  !> A data space of some rows; one that grows starts without.
  subroutine create_space(form, n_rows, is_growing, space, status)
    type(hdf5_layout_type), intent(in) :: form
    integer(I64), intent(in) :: n_rows
    logical, intent(in) :: is_growing
    integer(HID_T), intent(out) :: space
    integer, intent(out) :: status                !< negative: it failed
    integer(HSIZE_T) :: extent(2), limit(2)
    integer :: rank
    rank = rank_of(form)
    extent = extent_of(form, merge(0_I64, n_rows, is_growing))
    limit = extent
    if (is_growing) limit(rank) = H5S_UNLIMITED_F
    call h5screate_simple_f(rank, extent, space, status, limit)
  end subroutine create_space


  !> Selects a block of rows, or such a block in each frame without end.
  subroutine select_rows(space, form, before, n_rows, n_per_frame, is_growing, status)
    integer(HID_T), intent(in) :: space
    type(hdf5_layout_type), intent(in) :: form
    integer(I64), intent(in) :: before, n_rows    !< in a frame
    integer(I64), intent(in) :: n_per_frame       !< rows of a frame
    logical, intent(in) :: is_growing
    integer, intent(out) :: status                !< negative: it failed
    integer(HSIZE_T) :: start(2), count(2), stride(2), block(2)
    integer :: rank
    rank = rank_of(form)
    start = 0
    count = 1
    block = extent_of(form, n_rows)
    stride = max(1_HSIZE_T, extent_of(form, n_per_frame))
    start(rank) = int(before, HSIZE_T)
    if (is_growing) count(rank) = H5S_UNLIMITED_F
    call h5sselect_hyperslab_f(space, H5S_SELECT_SET_F, start(:rank), count(:rank), status, stride(:rank), block(:rank))
  end subroutine select_rows

end module amontons_virtual_data_sets
