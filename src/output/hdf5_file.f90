!> HDF5 files: groups, attributes, data sets with unit and description, extendible tables, and crash-safe page writing.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Only this module, `amontons_hdf5_input` and `amontons_virtual_data_sets` use HDF5. A file is opened without a file lock, so that
!! a viewer can read it while the job runs: after `flush_hdf5` the file on disk is consistent, and existing data do not move while
!! rows are added.
!! Closing a file closes all objects that are open in it.
!!
!! The file on disk changes from one consistent state to the next (overlay_shim.c): writes into the old state are kept in memory
!! as pages. `flush_hdf5` writes them at once. A guarded file keeps them: its owner stores them in a checkpoint
!! (`export_pages`) and then calls `apply_pages`; after a crash `repair_hdf5` restores the file of that checkpoint.
module amontons_hdf5_file
  use, intrinsic :: iso_c_binding, only: c_associated, c_bool, c_char, c_int, c_int64_t, c_int8_t, c_loc, &
    c_null_char, c_null_ptr, c_ptr, c_size_t
  use amontons_kinds, only: DP, I8, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_posix, only: errno_text
  use hdf5, only: HID_T, HSIZE_T, SIZE_T, H5F_ACC_RDWR_F, H5F_ACC_TRUNC_F, H5F_CLOSE_STRONG_F, H5F_SCOPE_GLOBAL_F, &
    H5P_DATASET_CREATE_F, H5P_FILE_ACCESS_F, H5S_SCALAR_F, H5S_SELECT_SET_F, H5S_UNLIMITED_F, H5T_CSET_UTF8_F, &
    H5T_FORTRAN_S1, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, H5T_NATIVE_INTEGER, H5T_STD_I32LE, H5T_STD_I64LE, &
    H5T_STD_U8LE, H5T_STR_NULLPAD_F, H5_INTEGER_KIND, h5aclose_f, h5acreate_f, h5aexists_f, h5aopen_f, h5awrite_f, &
    h5dclose_f, h5dcreate_f, h5dget_space_f, h5dopen_f, h5dset_extent_f, h5dwrite_f, h5eset_auto_f, h5fclose_f, &
    h5fcreate_f, h5fflush_f, h5fopen_f, h5gclose_f, h5gcreate_f, h5iis_valid_f, h5kind_to_type, h5oclose_f, &
    h5oopen_f, h5open_f, h5pclose_f, h5pcreate_f, h5pset_chunk_f, h5pset_deflate_f, h5pset_fclose_degree_f, &
    h5pset_shuffle_f, h5sclose_f, h5screate_f, h5screate_simple_f, h5sget_simple_extent_dims_f, &
    h5sselect_hyperslab_f, h5tclose_f, h5tcopy_f, h5tset_cset_f, h5tset_size_f, h5tset_strpad_f
  implicit none
  private
  public :: hdf5_file_type, hdf5_table_type, hdf5_layout_type, STORAGE_REAL, STORAGE_I32, STORAGE_I64, STORAGE_U8, STORAGE_TEXT
  public :: open_hdf5, open_table, export_pages, apply_pages, repair_hdf5, discard_hdf5, hdf5_pages_type
  public :: create_hdf5, flush_hdf5, close_hdf5, create_group, write_attribute, write_data, create_table, append_rows
  public :: rank_of, extent_of, open_types, close_types, write_label, check_status      ! for amontons_virtual_data_sets
  public :: set_no_lock

  ! Storage types of values in the file (little endian on every machine).
  integer, parameter :: STORAGE_REAL = 1            !< 64-bit reals
  integer, parameter :: STORAGE_I32 = 2             !< 32-bit integers
  integer, parameter :: STORAGE_I64 = 3             !< 64-bit integers
  integer, parameter :: STORAGE_U8 = 4              !< unsigned bytes
  integer, parameter :: STORAGE_TEXT = 5            !< texts of one length, UTF-8, padded with NUL

  integer, parameter :: STATUS_OTHER_WRITER = -1, STATUS_CHANGED = -2   !< in addition to errno: see overlay_shim.c

  ! Deflate level of HDF5's filters; level 6 takes 1.4 times as long for 1 % less. Reals of fields: pack_shim.c.
  integer, parameter :: GZIP_LEVEL = 1
  integer, parameter :: COLUMN_CHUNK = 256        !< rows, of tables that grow by one row at a time
  integer, parameter :: TEXT_CHUNK = 32           !< the same for texts
  integer, parameter :: MIN_COMPRESSED_VALUES = 1024    !< values, of data sets that do not grow
  integer(I64), parameter :: MAX_CHUNK_VALUES = 134217728_I64   !< values: 1 GiB of reals; HDF5 ends at 4 GiB

  !> An open file.
  type :: hdf5_file_type
    private
    integer(HID_T), public :: file = -1
    type(c_ptr) :: overlay = c_null_ptr
    logical, public :: is_open = .false.
    logical, public :: is_guarded = .false.       !< the owner calls apply_pages; else flush_hdf5 and close_hdf5 do
    character(:), allocatable, public :: path
  end type hdf5_file_type

  !> The pages that change a file from one consistent state to the next, or back.
  type :: hdf5_pages_type
    integer(I64) :: end = 0                       !< of that state [bytes]
    integer(I64), allocatable :: index(:)         !< page numbers, from 0
    integer(I8), allocatable :: bytes(:, :)       !< (page size, pages)
  end type hdf5_pages_type

  !> Layout of a table.
  type :: hdf5_layout_type
    integer :: storage = STORAGE_REAL               !< STORAGE_...
    integer :: width = 1                          !< values per row; length of the texts for STORAGE_TEXT
    logical :: is_matrix = .false.                !< two dimensions even if width is 1
    integer :: n_rows_hint = 1                    !< rows that are added at a time; 1: uncompressed
  end type hdf5_layout_type

  !> A data set that grows.
  type :: hdf5_table_type
    private
    integer(HID_T) :: id = -1
    type(hdf5_layout_type) :: form
    integer(I64), public :: n_rows = 0            !< rows in the file
    character(:), allocatable :: name
  end type hdf5_table_type

  !> Sets an attribute of an object, or overwrites it.
  interface write_attribute
    procedure :: write_attribute_integers
    procedure :: write_attribute_text
  end interface write_attribute

  !> Writes a data set that does not grow.
  interface write_data
    procedure :: write_data_integers
    procedure :: write_data_integer_matrix
    procedure :: write_data_reals
    procedure :: write_data_real_matrix
    procedure :: write_data_text
    procedure :: write_data_texts
  end interface write_data

  !> Adds rows at the end of a table.
  interface append_rows
    procedure :: append_integers
    procedure :: append_long
    procedure :: append_reals
    procedure :: append_text
  end interface append_rows

  interface
    !> HDF5's switch for file locks; its Fortran module has it from release 1.14 on only.
    function h5pset_file_locking(list, use_locks, ignore_when_disabled) bind(c, name='H5Pset_file_locking') &
      result(status)
      import :: c_bool, c_int, c_int64_t
      integer(c_int64_t), value :: list
      logical(c_bool), value :: use_locks, ignore_when_disabled
      integer(c_int) :: status
    end function h5pset_file_locking

    function write_chunk(data_set, offset, values, n) bind(C, name='amontons_write_chunk') result(status)
      import :: c_int, c_int64_t, c_ptr, c_size_t
      integer(c_int64_t), value :: data_set
      integer(c_int64_t), intent(in) :: offset(*)
      type(c_ptr), value :: values
      integer(c_size_t), value :: n
      integer(c_int) :: status
    end function write_chunk

    function overlay_new() bind(C, name='amontons_overlay_new') result(overlay)
      import :: c_ptr
      type(c_ptr) :: overlay
    end function overlay_new

    function overlay_attach(overlay, list) bind(C, name='amontons_overlay_attach') result(status)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: overlay
      integer(c_int64_t), value :: list
      integer(c_int) :: status
    end function overlay_attach

    function overlay_pages(overlay) bind(C, name='amontons_overlay_pages') result(n_pages)
      import :: c_int64_t, c_ptr
      type(c_ptr), value :: overlay
      integer(c_int64_t) :: n_pages
    end function overlay_pages

    function overlay_page_size() bind(C, name='amontons_overlay_page_size') result(n_bytes)
      import :: c_int
      integer(c_int) :: n_bytes
    end function overlay_page_size

    function overlay_trouble(overlay) bind(C, name='amontons_overlay_trouble') result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: overlay
      integer(c_int) :: status
    end function overlay_trouble

    subroutine overlay_ends(overlay, frozen, end) bind(C, name='amontons_overlay_ends')
      import :: c_int64_t, c_ptr
      type(c_ptr), value :: overlay
      integer(c_int64_t), intent(out) :: frozen, end
    end subroutine overlay_ends

    function overlay_take(overlay, is_old, index, bytes) bind(C, name='amontons_overlay_take') result(status)
      import :: c_int, c_int64_t, c_int8_t, c_ptr
      type(c_ptr), value :: overlay
      integer(c_int), value :: is_old
      integer(c_int64_t), intent(out) :: index(*)
      integer(c_int8_t), intent(out) :: bytes(*)
      integer(c_int) :: status
    end function overlay_take

    function overlay_sync(overlay) bind(C, name='amontons_overlay_sync') result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: overlay
      integer(c_int) :: status
    end function overlay_sync

    function overlay_apply(overlay) bind(C, name='amontons_overlay_apply') result(status)
      import :: c_int, c_ptr
      type(c_ptr), value :: overlay
      integer(c_int) :: status
    end function overlay_apply

    subroutine overlay_free(overlay) bind(C, name='amontons_overlay_free')
      import :: c_ptr
      type(c_ptr), value :: overlay
    end subroutine overlay_free

    function overlay_mend(path, n_pages, index, bytes, end) bind(C, name='amontons_overlay_mend') result(status)
      import :: c_char, c_int, c_int64_t, c_int8_t
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int64_t), value :: n_pages, end
      integer(c_int64_t), intent(in) :: index(*)
      integer(c_int8_t), intent(in) :: bytes(*)
      integer(c_int) :: status
    end function overlay_mend
  end interface

contains

  !> Creates a file, or empties it if it exists.
  subroutine create_hdf5(store, path, error, is_guarded)
    type(hdf5_file_type), intent(out) :: store
    character(*), intent(in) :: path              !< with folder and extension
    type(error_type), allocatable, intent(out) :: error
    logical, intent(in), optional :: is_guarded   !< default .false.
    if (present(is_guarded)) store%is_guarded = is_guarded
    call start_file(store, path, .true., 'create it (does the folder exist, may it be written, is the disk full?)', error)
  end subroutine create_hdf5


  !> Opens an existing file for writing, guarded.
  subroutine open_hdf5(store, path, error)
    type(hdf5_file_type), intent(out) :: store
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    store%is_guarded = .true.
    call start_file(store, path, .false., 'open it (is it there, and a result file?)', error)
  end subroutine open_hdf5


  !> Creates or opens the HDF5 file.
  subroutine start_file(store, path, is_new, action, error)
    type(hdf5_file_type), intent(inout) :: store
    character(*), intent(in) :: path, action
    logical, intent(in) :: is_new
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: access
    integer :: s(7), unused
    logical :: is_ready
    s = 0
    store%path = path
    store%overlay = overlay_new()
    if (.not. c_associated(store%overlay)) s(7) = -1
    ! h5open_f sets the module's type numbers. It is called once per process and never closed: other files may be
    ! open.
    call h5iis_valid_f(H5T_NATIVE_DOUBLE, is_ready, s(1))
    if (.not. is_ready) call h5open_f(s(1))
    call h5eset_auto_f(0, s(2))
    call h5pcreate_f(H5P_FILE_ACCESS_F, access, s(3))
    call h5pset_fclose_degree_f(access, H5F_CLOSE_STRONG_F, s(4))
    s(5) = h5pset_file_locking(access, .false._c_bool, .true._c_bool)
    if (all(s >= 0)) s(6) = overlay_attach(store%overlay, access)
    if (all(s >= 0)) then
      if (is_new) call h5fcreate_f(path, H5F_ACC_TRUNC_F, store%file, s(7), access_prp=access)
      if (.not. is_new) call h5fopen_f(path, H5F_ACC_RDWR_F, store%file, s(7), access)
    end if
    store%is_open = all(s >= 0)
    call check_status(store, s, action, error)
    if (s(7) < 0 .and. c_associated(store%overlay)) then
      if (overlay_trouble(store%overlay) /= 0) call check_errno(path, overlay_trouble(store%overlay), action, error)
    end if
    call h5pclose_f(access, unused)
    if (.not. store%is_open) call free_overlay(store)
  end subroutine start_file


  !> Lets a file be opened without a lock.
  subroutine set_no_lock(access)
    integer(HID_T), intent(in) :: access          !< property list of file access
    integer(c_int) :: unused
    unused = h5pset_file_locking(access, .false._c_bool, .true._c_bool)
  end subroutine set_no_lock


  !> Flushes everything written so far to disk; of a guarded file, to memory.
  subroutine flush_hdf5(store, error)
    type(hdf5_file_type), intent(in) :: store
    type(error_type), allocatable, intent(out) :: error
    integer :: s(1)
    call h5fflush_f(store%file, H5F_SCOPE_GLOBAL_F, s(1))
    call check_status(store, s, 'write it to disk (is the disk full?)', error)
    if (.not. allocated(error)) call check_errno(store%path, overlay_trouble(store%overlay), 'write it', error)
    if (.not. (allocated(error) .or. store%is_guarded)) call apply_pages(store, error)
  end subroutine flush_hdf5


  !> The pages that differ between the file on disk and the last flushed or closed state. Syncs all other data to disk first.
  subroutine export_pages(store, is_old, pages, error)
    type(hdf5_file_type), intent(in) :: store
    logical, intent(in) :: is_old                 !< .true.: contents on disk; .false.: new contents
    type(hdf5_pages_type), intent(out) :: pages
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: frozen, end, n_pages
    integer :: status
    n_pages = overlay_pages(store%overlay)
    allocate (pages%index(n_pages), pages%bytes(overlay_page_size(), n_pages))
    call overlay_ends(store%overlay, frozen, end)
    pages%end = merge(frozen, end, is_old)
    status = overlay_take(store%overlay, merge(1, 0, is_old), pages%index, pages%bytes)
    if (status == 0) status = overlay_sync(store%overlay)
    call check_errno(store%path, status, 'bring it to disk', error)
  end subroutine export_pages


  !> Writes the pages: the file on disk is then the last flushed or closed state.
  subroutine apply_pages(store, error)
    type(hdf5_file_type), intent(in) :: store
    type(error_type), allocatable, intent(out) :: error
    call check_errno(store%path, overlay_apply(store%overlay), 'write it', error)
  end subroutine apply_pages


  !> Restores the state of a file at which the pages were exported.
  subroutine repair_hdf5(path, pages, error)
    character(*), intent(in) :: path
    type(hdf5_pages_type), intent(in) :: pages
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: length
    inquire (file=path, size=length)
    if (length < 0) then
      call set_error(error, EXIT_IO, 'Result file ' // path // ': it is not there, but its checkpoint is.')
    else if (length < pages%end) then
      call set_error(error, EXIT_IO, 'Result file ' // path // ': it is shorter than its checkpoint says.')
    else
      call check_errno(path, overlay_mend(path // c_null_char, size(pages%index, kind=I64), pages%index, pages%bytes, &
        pages%end), 'mend it', error)
    end if
  end subroutine repair_hdf5


  !> Closes the file and all objects open in it; no effect if it is not open. The last pages of a guarded file remain in memory
  !! for apply_pages; discard_hdf5 frees them.
  subroutine close_hdf5(store, error)
    type(hdf5_file_type), intent(inout) :: store
    type(error_type), allocatable, intent(out) :: error
    integer :: s(1)
    if (.not. store%is_open) return
    call h5fclose_f(store%file, s(1))
    store%is_open = .false.
    store%file = -1
    call check_status(store, s, 'close it (is the disk full?)', error)
    if (.not. allocated(error)) call check_errno(store%path, overlay_trouble(store%overlay), 'write it', error)
    if (store%is_guarded) return
    if (.not. allocated(error)) call apply_pages(store, error)
    call free_overlay(store)
  end subroutine close_hdf5


  !> Closes the file and discards the pages that were not applied: the last consistent state remains on disk.
  subroutine discard_hdf5(store)
    type(hdf5_file_type), intent(inout) :: store
    integer :: unused
    call free_overlay(store)
    if (store%is_open) call h5fclose_f(store%file, unused)
    store%is_open = .false.
    store%file = -1
  end subroutine discard_hdf5


  !> Frees the pages and closes their file.
  subroutine free_overlay(store)
    type(hdf5_file_type), intent(inout) :: store
    call overlay_free(store%overlay)
    store%overlay = c_null_ptr
  end subroutine free_overlay


  !> Creates a group; its parent must exist.
  subroutine create_group(store, name, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name              !< full path in the file
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: group
    integer :: s(2)
    s = 0
    call h5gcreate_f(store%file, name, group, s(1))
    if (s(1) >= 0) call h5gclose_f(group, s(2))
    call check_status(store, s, 'create the group ' // name, error)
  end subroutine create_group


  !> Integers as an attribute, one-dimensional; a scalar if only one is given.
  subroutine write_attribute_integers(store, object, name, values, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: object            !< full path of the group or data set
    character(*), intent(in) :: name
    integer, intent(in), target, contiguous :: values(:)
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: space
    integer :: s(2)
    if (size(values) == 1) then
      call h5screate_f(H5S_SCALAR_F, space, s(1))
    else
      call h5screate_simple_f(1, [size(values, kind=HSIZE_T)], space, s(1))
    end if
    call put_attribute(store, object, name, H5T_STD_I32LE, H5T_NATIVE_INTEGER, space, c_loc(values), error)
    call h5sclose_f(space, s(2))
  end subroutine write_attribute_integers


  !> A text as an attribute: ASCII, fixed length, no padding (old VTK readers accept no other form).
  subroutine write_attribute_text(store, object, name, text, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: object            !< full path of the group or data set
    character(*), intent(in) :: name
    character(*), intent(in) :: text              !< not empty
    type(error_type), allocatable, intent(out) :: error
    character(len(text)), target :: buffer
    integer(HID_T) :: space, type
    integer :: s(5)
    buffer = text
    call h5screate_f(H5S_SCALAR_F, space, s(1))
    call h5tcopy_f(H5T_FORTRAN_S1, type, s(2))
    call h5tset_size_f(type, len(text, kind=SIZE_T), s(3))
    call put_attribute(store, object, name, type, type, space, c_loc(buffer(1:1)), error)
    call h5tclose_f(type, s(4))
    call h5sclose_f(space, s(5))
  end subroutine write_attribute_text


  !> Creates or opens an attribute and writes it.
  subroutine put_attribute(store, object, name, file_type, memory_type, space, buffer, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: object, name
    integer(HID_T), intent(in) :: file_type, memory_type, space
    type(c_ptr), intent(in) :: buffer
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: owner, attribute
    integer :: s(5), unused
    logical :: is_there
    s = 0
    call h5oopen_f(store%file, object, owner, s(1))
    if (s(1) >= 0) then
      call h5aexists_f(owner, name, is_there, s(2))
      if (is_there) then
        call h5aopen_f(owner, name, attribute, s(3))
      else
        call h5acreate_f(owner, name, file_type, space, attribute, s(3))
      end if
      if (s(3) >= 0) then
        call h5awrite_f(attribute, memory_type, buffer, s(4))
        call h5aclose_f(attribute, s(5))
      end if
      call h5oclose_f(owner, unused)
    end if
    call check_status(store, s, 'write the attribute ' // name // ' of ' // object, error)
  end subroutine put_attribute


  !> A list of integers.
  subroutine write_data_integers(store, name, values, unit, description, error, storage)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name              !< full path in the file
    integer, intent(in), target, contiguous :: values(:)
    character(*), intent(in) :: unit              !< e.g. '[length]', '[-]'
    character(*), intent(in) :: description       !< one sentence
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in), optional :: storage      !< STORAGE_..., default STORAGE_I32
    type(hdf5_layout_type) :: form
    type(c_ptr) :: buffer
    form = hdf5_layout_type(storage=STORAGE_I32)
    if (present(storage)) form%storage = storage
    buffer = c_null_ptr
    if (size(values) > 0) buffer = c_loc(values)
    call put_data(store, name, form, size(values, kind=I64), buffer, error)
    if (allocated(error)) return
    call write_label(store, name, unit, description, error)
  end subroutine write_data_integers


  !> A matrix of integers, one column in Fortran per row of the file.
  subroutine write_data_integer_matrix(store, name, values, unit, description, error, storage)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name              !< full path in the file
    integer, intent(in), target, contiguous :: values(:, :)
    character(*), intent(in) :: unit              !< e.g. '[-]'
    character(*), intent(in) :: description       !< one sentence
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in), optional :: storage      !< STORAGE_..., default STORAGE_I32
    type(hdf5_layout_type) :: form
    type(c_ptr) :: buffer
    form = hdf5_layout_type(storage=STORAGE_I32, width=size(values, 1), is_matrix=.true.)
    if (present(storage)) form%storage = storage
    buffer = c_null_ptr
    if (size(values) > 0) buffer = c_loc(values)
    call put_data(store, name, form, size(values, 2, kind=I64), buffer, error)
    if (allocated(error)) return
    call write_label(store, name, unit, description, error)
  end subroutine write_data_integer_matrix


  !> A list of reals.
  subroutine write_data_reals(store, name, values, unit, description, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name              !< full path in the file
    real(DP), intent(in), target, contiguous :: values(:)
    character(*), intent(in) :: unit              !< e.g. '[length]'
    character(*), intent(in) :: description       !< one sentence
    type(error_type), allocatable, intent(out) :: error
    type(c_ptr) :: buffer
    buffer = c_null_ptr
    if (size(values) > 0) buffer = c_loc(values)
    call put_data(store, name, hdf5_layout_type(), size(values, kind=I64), buffer, error)
    if (allocated(error)) return
    call write_label(store, name, unit, description, error)
  end subroutine write_data_reals


  !> A matrix of reals, one column in Fortran per row of the file.
  subroutine write_data_real_matrix(store, name, values, unit, description, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name              !< full path in the file
    real(DP), intent(in), target, contiguous :: values(:, :)
    character(*), intent(in) :: unit              !< e.g. '[length]'
    character(*), intent(in) :: description       !< one sentence
    type(error_type), allocatable, intent(out) :: error
    type(hdf5_layout_type) :: form
    type(c_ptr) :: buffer
    form = hdf5_layout_type(width=size(values, 1), is_matrix=.true.)
    buffer = c_null_ptr
    if (size(values) > 0) buffer = c_loc(values)
    call put_data(store, name, form, size(values, 2, kind=I64), buffer, error)
    if (allocated(error)) return
    call write_label(store, name, unit, description, error)
  end subroutine write_data_real_matrix


  !> One text, of any length and with line breaks.
  subroutine write_data_text(store, name, text, unit, description, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name              !< full path in the file
    character(*), intent(in) :: text
    character(*), intent(in) :: unit              !< '[-]'
    character(*), intent(in) :: description       !< one sentence
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: type, space, data
    integer :: s(7)
    character(:), allocatable, target :: buffer
    s = 0
    buffer = text
    if (len(text) == 0) buffer = c_null_char
    call make_text_type(len(buffer), type, s(1))
    call h5screate_f(H5S_SCALAR_F, space, s(2))
    call h5dcreate_f(store%file, name, type, space, data, s(3))
    if (s(3) >= 0) then
      call h5dwrite_f(data, type, c_loc(buffer(1:1)), s(4))
      call h5dclose_f(data, s(5))
    end if
    call h5sclose_f(space, s(6))
    call h5tclose_f(type, s(7))
    call check_status(store, s, 'write the data set ' // name, error)
    if (allocated(error)) return
    call write_label(store, name, unit, description, error)
  end subroutine write_data_text


  !> A list of texts.
  subroutine write_data_texts(store, name, texts, unit, description, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name              !< full path in the file
    character(*), intent(in) :: texts(:)          !< trailing blanks are dropped
    character(*), intent(in) :: unit              !< '[-]'
    character(*), intent(in) :: description       !< one sentence
    type(error_type), allocatable, intent(out) :: error
    character(len(texts)), target :: buffer(size(texts))
    integer :: i
    do i = 1, size(texts)
      buffer(i) = with_nulls(texts(i), len(texts))
    end do
    call put_data(store, name, hdf5_layout_type(storage=STORAGE_TEXT, width=len(texts)), size(texts, kind=I64), &
      c_loc(buffer), error)
    if (allocated(error)) return
    call write_label(store, name, unit, description, error)
  end subroutine write_data_texts


  !> Creates a data set of fixed size, writes all of it and closes it; large ones are compressed.
  subroutine put_data(store, name, form, n_rows, buffer, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name
    type(hdf5_layout_type), intent(in) :: form
    integer(I64), intent(in) :: n_rows
    type(c_ptr), intent(in) :: buffer
    type(error_type), allocatable, intent(out) :: error
    type(hdf5_layout_type) :: chunked
    integer(HID_T) :: file_type, memory_type, space, list, data
    integer(HSIZE_T) :: extent(2)
    integer :: s(8), unused
    s = 0
    extent = extent_of(form, n_rows)
    call open_types(form, file_type, memory_type, s(1))
    call h5screate_simple_f(rank_of(form), extent, space, s(2))
    call h5pcreate_f(H5P_DATASET_CREATE_F, list, s(3))
    if (form%storage /= STORAGE_TEXT .and. n_rows > int(MIN_COMPRESSED_VALUES / form%width, I64)) then
      chunked = form
      chunked%n_rows_hint = int(min(n_rows, int(huge(1), I64)))
      call set_chunks(list, chunked, s(4))
    end if
    if (all(s >= 0)) call h5dcreate_f(store%file, name, file_type, space, data, s(5), list)
    if (all(s >= 0)) then
      if (n_rows > 0) call h5dwrite_f(data, memory_type, buffer, s(6))
      call h5dclose_f(data, s(7))
    end if
    call h5pclose_f(list, unused)
    call h5sclose_f(space, unused)
    call close_types(form, file_type)
    call check_status(store, s, 'write the data set ' // name, error)
  end subroutine put_data


  !> Creates an empty data set that grows by rows.
  subroutine create_table(store, table, name, form, unit, description, error)
    type(hdf5_file_type), intent(in) :: store
    type(hdf5_table_type), intent(out) :: table
    character(*), intent(in) :: name              !< full path in the file
    type(hdf5_layout_type), intent(in) :: form           !< type of a row, and rows added at a time
    character(*), intent(in) :: unit              !< e.g. '[length]'
    character(*), intent(in) :: description       !< one sentence
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: file_type, memory_type, space, list
    integer(HSIZE_T) :: extent(2), limit(2)
    integer :: s(5), unused
    table%form = form
    table%name = name
    s = 0
    extent = extent_of(form, 0_I64)
    limit = extent
    limit(rank_of(form)) = H5S_UNLIMITED_F
    call open_types(form, file_type, memory_type, s(1))
    call h5screate_simple_f(rank_of(form), extent, space, s(2), limit)
    call h5pcreate_f(H5P_DATASET_CREATE_F, list, s(3))
    call set_chunks(list, form, s(4))
    if (all(s >= 0)) call h5dcreate_f(store%file, name, file_type, space, table%id, s(5), list)
    call h5pclose_f(list, unused)
    call h5sclose_f(space, unused)
    call close_types(form, file_type)
    call check_status(store, s, 'create the table ' // name, error)
    if (allocated(error)) return
    call write_label(store, name, unit, description, error)
  end subroutine create_table


  !> Opens a table of an open file to append rows.
  subroutine open_table(store, table, name, form, error)
    type(hdf5_file_type), intent(in) :: store
    type(hdf5_table_type), intent(out) :: table
    character(*), intent(in) :: name              !< full path in the file
    type(hdf5_layout_type), intent(in) :: form           !< the same as at its creation
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: space
    integer(HSIZE_T) :: extent(2), limit(2)
    integer :: s(3), unused
    s = 0
    table%form = form
    table%name = name
    call h5dopen_f(store%file, name, table%id, s(1))
    if (s(1) >= 0) then
      call h5dget_space_f(table%id, space, s(2))
      call h5sget_simple_extent_dims_f(space, extent(:rank_of(form)), limit(:rank_of(form)), s(3))
      call h5sclose_f(space, unused)
      table%n_rows = int(extent(rank_of(form)), I64)
    end if
    call check_status(store, s, 'open the table ' // name, error)
  end subroutine open_table


  !> Adds rows of integers.
  subroutine append_integers(store, table, values, error)
    type(hdf5_file_type), intent(in) :: store
    type(hdf5_table_type), intent(inout) :: table
    integer, intent(in), target, contiguous :: values(:, :)   !< (width, rows)
    type(error_type), allocatable, intent(out) :: error
    call put_rows(store, table, H5T_NATIVE_INTEGER, size(values, 2, kind=I64), c_loc(values), error)
  end subroutine append_integers


  !> Adds one row with one long integer.
  subroutine append_long(store, table, value, error)
    type(hdf5_file_type), intent(in) :: store
    type(hdf5_table_type), intent(inout) :: table
    integer(I64), intent(in) :: value
    type(error_type), allocatable, intent(out) :: error
    integer(I64), target :: buffer(1)
    buffer = value
    call put_rows(store, table, h5kind_to_type(I64, H5_INTEGER_KIND), 1_I64, c_loc(buffer), error)
  end subroutine append_long


  !> Adds rows of reals.
  subroutine append_reals(store, table, values, error)
    type(hdf5_file_type), intent(in) :: store
    type(hdf5_table_type), intent(inout) :: table
    real(DP), intent(in), target, contiguous :: values(:, :)   !< (width, rows)
    type(error_type), allocatable, intent(out) :: error
    call put_rows(store, table, H5T_NATIVE_DOUBLE, size(values, 2, kind=I64), c_loc(values), error)
  end subroutine append_reals


  !> Adds one text, truncated to the length of the table's texts.
  subroutine append_text(store, table, text, error)
    type(hdf5_file_type), intent(in) :: store
    type(hdf5_table_type), intent(inout) :: table
    character(*), intent(in) :: text
    type(error_type), allocatable, intent(out) :: error
    character(table%form%width), target :: buffer
    integer(HID_T) :: file_type, memory_type
    integer :: s(1)
    buffer = with_nulls(text, table%form%width)
    call open_types(table%form, file_type, memory_type, s(1))
    call put_rows(store, table, memory_type, 1_I64, c_loc(buffer(1:1)), error)
    call close_types(table%form, file_type)
  end subroutine append_text


  !> Extends a table and writes the new rows.
  subroutine put_rows(store, table, memory_type, n_rows, buffer, error)
    type(hdf5_file_type), intent(in) :: store
    type(hdf5_table_type), intent(inout) :: table
    integer(HID_T), intent(in) :: memory_type
    integer(I64), intent(in) :: n_rows
    type(c_ptr), intent(in) :: buffer
    type(error_type), allocatable, intent(out) :: error
    integer(HID_T) :: file_space, memory_space
    integer(HSIZE_T) :: count(2), start(2)
    integer :: s(6), rank, packed, unused
    if (n_rows == 0) return
    s = 0
    rank = rank_of(table%form)
    start = 0
    start(rank) = table%n_rows
    count = extent_of(table%form, n_rows)
    call h5dset_extent_f(table%id, extent_of(table%form, table%n_rows + n_rows), s(1))
    if (s(1) >= 0) then
      call h5dget_space_f(table%id, file_space, s(2))
      call h5sselect_hyperslab_f(file_space, H5S_SELECT_SET_F, start(:rank), count(:rank), s(3))
      call h5screate_simple_f(rank, count, memory_space, s(4))
      packed = 1
      if (all(s >= 0) .and. is_chunk(table%form, n_rows)) packed = write_chunk(table%id, int(start(rank:1:-1), c_int64_t), buffer, &
        int(n_rows * int(table%form%width, I64), c_size_t))
      if (packed < 0) s(6) = packed
      if (all(s >= 0) .and. packed /= 0) call h5dwrite_f(table%id, memory_type, buffer, s(5), memory_space, file_space)
      call h5sclose_f(memory_space, unused)
      call h5sclose_f(file_space, unused)
    end if
    call check_status(store, s, 'add rows to ' // table%name // ' (is the disk full?)', error)
    if (.not. allocated(error)) table%n_rows = table%n_rows + n_rows
  end subroutine put_rows


  !> Whether the rows are exactly one compressed chunk of reals, which pack_shim.c writes faster than HDF5's own filters.
  pure logical function is_chunk(form, n_rows)
    type(hdf5_layout_type), intent(in) :: form
    integer(I64), intent(in) :: n_rows
    is_chunk = form%storage == STORAGE_REAL .and. form%n_rows_hint > 1 .and. n_rows == int(form%n_rows_hint, I64) .and. &
      n_rows * int(form%width, I64) < MAX_CHUNK_VALUES
  end function is_chunk


  !> Writes the attributes `unit` and `description`.
  subroutine write_label(store, name, unit, description, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: name, unit, description
    type(error_type), allocatable, intent(out) :: error
    call write_attribute_text(store, name, 'unit', trim(unit), error)
    if (allocated(error)) return
    call write_attribute_text(store, name, 'description', trim(description), error)
  end subroutine write_label


  !> Chunk size and compression.
  !!
  !! A table that grows by many rows at a time has one compressed chunk per block of rows: a block in the file never moves, since
  !! a viewer may be reading it. Chunks of tables that grow row by row are changed in place and therefore not compressed.
  subroutine set_chunks(list, form, status)
    integer(HID_T), intent(in) :: list            !< property list of a new data set
    type(hdf5_layout_type), intent(in) :: form
    integer, intent(out) :: status                !< negative: it failed
    integer(I64) :: rows, n_chunks
    integer :: s(3)
    s = 0
    if (form%n_rows_hint > 1) then
      rows = int(form%n_rows_hint, I64)
      n_chunks = 1_I64 + rows * int(form%width, I64) / MAX_CHUNK_VALUES
      rows = (rows + n_chunks - 1_I64) / n_chunks
      call h5pset_shuffle_f(list, s(2))
      call h5pset_deflate_f(list, GZIP_LEVEL, s(3))
    else
      rows = int(merge(TEXT_CHUNK, COLUMN_CHUNK, form%storage == STORAGE_TEXT), I64)
    end if
    call h5pset_chunk_f(list, rank_of(form), extent_of(form, rows), s(1))
    status = minval(s)
  end subroutine set_chunks


  !> Dimensions of the data set, in Fortran's order.
  pure function rank_of(form) result(rank)
    type(hdf5_layout_type), intent(in) :: form
    integer :: rank
    rank = merge(2, 1, form%is_matrix .or. (form%width > 1 .and. form%storage /= STORAGE_TEXT))
  end function rank_of


  !> Extent of a data set with some rows, in Fortran's order; only the first rank numbers count.
  pure function extent_of(form, n_rows) result(extent)
    type(hdf5_layout_type), intent(in) :: form
    integer(I64), intent(in) :: n_rows
    integer(HSIZE_T) :: extent(2)
    if (rank_of(form) == 2) then
      extent = [int(form%width, HSIZE_T), int(n_rows, HSIZE_T)]
    else
      extent = [int(n_rows, HSIZE_T), 0_HSIZE_T]
    end if
  end function extent_of


  !> The HDF5 types of a layout in the file and in memory; close_types releases them.
  subroutine open_types(form, file_type, memory_type, status)
    type(hdf5_layout_type), intent(in) :: form
    integer(HID_T), intent(out) :: file_type, memory_type
    integer, intent(out) :: status
    status = 0
    memory_type = H5T_NATIVE_INTEGER
    select case (form%storage)
    case (STORAGE_REAL)
      file_type = H5T_IEEE_F64LE
      memory_type = H5T_NATIVE_DOUBLE
    case (STORAGE_I64)
      file_type = H5T_STD_I64LE
    case (STORAGE_U8)
      file_type = H5T_STD_U8LE
    case (STORAGE_TEXT)
      call make_text_type(form%width, file_type, status)
      memory_type = file_type
    case default
      file_type = H5T_STD_I32LE
    end select
  end subroutine open_types


  !> Closes the type of open_types.
  subroutine close_types(form, file_type)
    type(hdf5_layout_type), intent(in) :: form
    integer(HID_T), intent(in) :: file_type
    integer :: unused
    if (form%storage == STORAGE_TEXT) call h5tclose_f(file_type, unused)
  end subroutine close_types


  !> A type of texts of one length.
  subroutine make_text_type(length, type, status)
    integer, intent(in) :: length                 !< bytes, at least 1
    integer(HID_T), intent(out) :: type
    integer, intent(out) :: status                !< negative: it failed
    integer :: s(4)
    call h5tcopy_f(H5T_FORTRAN_S1, type, s(1))
    call h5tset_size_f(type, int(length, SIZE_T), s(2))
    call h5tset_strpad_f(type, H5T_STR_NULLPAD_F, s(3))
    call h5tset_cset_f(type, H5T_CSET_UTF8_F, s(4))
    status = minval(s)
  end subroutine make_text_type


  !> A text padded with NUL instead of blanks, or truncated.
  pure function with_nulls(text, length) result(filled)
    character(*), intent(in) :: text
    integer, intent(in) :: length
    character(length) :: filled
    integer :: i, n
    n = min(length, len_trim(text))
    filled = text
    do i = n + 1, length
      filled(i:i) = c_null_char
    end do
  end function with_nulls


  !> Sets an error if any of the status values is negative.
  subroutine check_status(store, statuses, action, error)
    type(hdf5_file_type), intent(in) :: store
    integer, intent(in) :: statuses(:)            !< of HDF5 calls
    character(*), intent(in) :: action             !< the action, to follow 'cannot'
    type(error_type), allocatable, intent(out) :: error
    if (any(statuses < 0)) call set_error(error, EXIT_IO, 'Result file ' // store%path // ': cannot ' // action // '.')
  end subroutine check_status


  !> Sets an error for an error number of the operating system.
  subroutine check_errno(path, status, action, error)
    character(*), intent(in) :: path
    integer, intent(in) :: status                 !< errno, STATUS_OTHER_WRITER, STATUS_CHANGED; 0: success
    character(*), intent(in) :: action             !< to follow 'cannot'
    type(error_type), allocatable, intent(out) :: error
    select case (status)
    case (0)
      return
    case (STATUS_OTHER_WRITER)
      call set_error(error, EXIT_IO, 'Result file ' // path // ': another job is writing it.')
    case (STATUS_CHANGED)
      call set_error(error, EXIT_IO, 'Result file ' // path // ': it was changed by another program while the job ran.')
    case default
      call set_error(error, EXIT_IO, 'Result file ' // path // ': cannot ' // action // ': ' // errno_text(status) // '.')
    end select
  end subroutine check_errno

end module amontons_hdf5_file
