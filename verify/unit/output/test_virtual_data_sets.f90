!> Virtual data sets: rows of two files as one data set, fixed and growing; a source without rows, none at all, a missing folder.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_virtual_data_sets
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_hdf5_file, only: append_rows, close_hdf5, create_hdf5, create_table, flush_hdf5, hdf5_file_type, hdf5_layout_type, &
    hdf5_table_type, write_data, STORAGE_I32
  use amontons_virtual_data_sets, only: create_virtual, source_files_type
  use check, only: suite_type
  use hdf5, only: HID_T, HSIZE_T, H5F_ACC_RDONLY_F, H5T_NATIVE_DOUBLE, H5T_NATIVE_INTEGER, h5dclose_f, h5dget_space_f, h5dopen_f, &
    h5dread_f, h5fclose_f, h5fopen_f, h5sclose_f, h5sget_simple_extent_dims_f
  implicit none
  integer, parameter :: ROWS(3) = [2, 0, 3]       !< of the files
  character(*), parameter :: JOB = 'test_virtual_data_sets'
  type(suite_type) :: suite
  type(hdf5_file_type) :: parts(3), ties
  type(hdf5_table_type) :: tables(3)
  type(error_type), allocatable :: error

  call create()
  call expect_fixed()
  call expect_frames(0)
  call add_frame(1)
  call expect_frames(1)
  call add_frame(2)
  call expect_frames(2)
  call close_all()
  call expect_frames(2)
  call suite%finish()

contains

  !> Name of a file.
  function name_of(p) result(name)
    integer, intent(in) :: p
    character(len(JOB) + 5) :: name
    write (name, '(a, a, i1, a)') JOB, '_', p, '.h5'
  end function name_of


  !> Three files, of which the second has no rows, and the one that ties them, written first as if it knew them.
  subroutine create()
    type(source_files_type) :: sources
    integer :: p, i
    sources%name = [(name_of(p), p=1, 3)]
    call create_hdf5(ties, JOB // '.h5', error)
    call create_virtual(ties, sources, ROWS, '/label', hdf5_layout_type(storage=STORAGE_I32), .false., '[-]', 'Labels.', error)
    call suite%that('fixed', .not. allocated(error))
    call create_virtual(ties, sources, ROWS, '/u', hdf5_layout_type(width=2), .true., '[length]', 'Growing.', error)
    call suite%that('growing', .not. allocated(error))
    call create_virtual(ties, sources, [0, 0, 0], '/none', hdf5_layout_type(), .true., '[-]', 'Without rows.', error)
    call suite%that('without rows', .not. allocated(error))
    call create_virtual(ties, sources, ROWS, '/nowhere/u', hdf5_layout_type(), .true., '[-]', 'No group.', error)
    call suite%that('no such group', allocated(error))
    call flush_hdf5(ties, error)
    do p = 1, 3
      call create_hdf5(parts(p), name_of(p), error)
      call write_data(parts(p), '/label', [(10 * p + i, i=1, ROWS(p))], '[-]', 'Labels.', error)
      call create_table(parts(p), tables(p), '/u', hdf5_layout_type(width=2, n_rows_hint=max(1, ROWS(p))), '[length]', 'Growing.', &
        error)
      call flush_hdf5(parts(p), error)
    end do
  end subroutine create


  !> A frame in each file: 100 p + 10 row + column + 1000 frame.
  subroutine add_frame(frame)
    integer, intent(in) :: frame
    integer :: p
    do p = 1, 3
      if (ROWS(p) > 0) call append_rows(parts(p), tables(p), frame_of(frame, p), error)
      call suite%that('rows', .not. allocated(error))
      call flush_hdf5(parts(p), error)
    end do
  end subroutine add_frame


  !> The values of a file in a frame.
  function frame_of(frame, p) result(values)
    integer, intent(in) :: frame, p
    real(DP) :: values(2, ROWS(p))
    integer :: i, k
    do i = 1, ROWS(p)
      values(:, i) = [(real(1000 * frame + 100 * p + 10 * i + k, DP), k=1, 2)]
    end do
  end function frame_of


  !> The labels of all files.
  subroutine expect_fixed()
    integer(HID_T) :: file, data
    integer :: labels(5), s
    call h5fopen_f(JOB // '.h5', H5F_ACC_RDONLY_F, file, s)
    call h5dopen_f(file, '/label', data, s)
    call h5dread_f(data, H5T_NATIVE_INTEGER, labels, [5_HSIZE_T], s)
    call suite%that('labels', s >= 0 .and. all(labels == [11, 12, 31, 32, 33]))
    call h5dclose_f(data, s)
    call h5fclose_f(file, s)
  end subroutine expect_fixed


  !> So many frames, in each the rows of the first file before those of the third.
  subroutine expect_frames(n)
    integer, intent(in) :: n
    integer(HID_T) :: file, data, space
    integer(HSIZE_T) :: extent(2), limit(2)
    real(DP), allocatable :: values(:, :), expected(:, :)
    integer :: s, frame
    call h5fopen_f(JOB // '.h5', H5F_ACC_RDONLY_F, file, s)
    call h5dopen_f(file, '/u', data, s)
    call h5dget_space_f(data, space, s)
    call h5sget_simple_extent_dims_f(space, extent, limit, s)
    call suite%that('rows of all frames', extent(1) == 2_HSIZE_T .and. extent(2) == int(5 * n, HSIZE_T))
    allocate (values(2, 5 * n), expected(2, 0))
    do frame = 1, n
      expected = reshape([expected, frame_of(frame, 1), frame_of(frame, 3)], [2, 5 * frame])
    end do
    if (n > 0) call h5dread_f(data, H5T_NATIVE_DOUBLE, values, extent, s)
    call suite%that('their values', s >= 0 .and. all(abs(values - expected) <= 0.0_DP))
    call h5sclose_f(space, s)
    call h5dclose_f(data, s)
    call h5fclose_f(file, s)
  end subroutine expect_frames


  !> Closes all files.
  subroutine close_all()
    integer :: p
    do p = 1, 3
      call close_hdf5(parts(p), error)
      call suite%that('closed', .not. allocated(error))
    end do
    call close_hdf5(ties, error)
    call suite%that('closed', .not. allocated(error))
  end subroutine close_all

end program test_virtual_data_sets
