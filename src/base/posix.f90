!> Operating-system services: atomic file writes, signals, memory limits, process lock, heartbeat.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_posix
  use, intrinsic :: iso_c_binding, only: c_double, c_char, c_int, c_int64_t, c_null_char, c_ptr, c_null_ptr, c_associated
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  implicit none
  private
  public :: new_file_type, start_new_file, append_words, place_new_file, remove_new_file, sync_file, truncate_file
  public :: checksum_of_words, continue_checksum, checksum_of_text, errno_text
  public :: has_memory, available_megabytes, total_megabytes, peak_megabytes, install_signal_handlers, pending_stop_signal, &
    is_status_requested, set_exit_handler, end_process, restart_with_settings, return_large_blocks
  public :: heartbeat_type, start_heartbeat, postpone_heartbeat, set_heartbeat, stop_heartbeat
  public :: process_lock_type, acquire_lock, suspend_lock, resume_lock

  character(*), parameter :: SUFFIX_NEW = '.new'   !< of a file that is not complete yet

  !> A file that is being written under a temporary name.
  type :: new_file_type
    private
    character(:), allocatable :: path            !< whose place it takes
    integer(c_int) :: descriptor = -1
    integer(c_int) :: status = 0                 !< errno of the first failure; 0: none
  end type new_file_type

  !> The process lock of a thread around text output and formatting (reason in posix_shim.c); a procedure holds it until its end.
  type :: process_lock_type
    private
    logical :: is_locked = .false.
  contains
    final :: release_lock
  end type process_lock_type

  interface
    function open_new_c(temporary) bind(C, name='amontons_open_new') result(descriptor)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: temporary(*)
      integer(c_int) :: descriptor
    end function open_new_c

    function append_new_c(descriptor, words, n_bytes) bind(C, name='amontons_append_new') result(status)
      import :: c_int, c_int64_t
      integer(c_int), value :: descriptor
      integer(c_int64_t), intent(in) :: words(*)
      integer(c_int64_t), value :: n_bytes
      integer(c_int) :: status
    end function append_new_c

    function place_new_c(descriptor, path, temporary, head, n_bytes, status_before) bind(C, name='amontons_place_new') &
      result(status)
      import :: c_char, c_int, c_int64_t
      integer(c_int), value :: descriptor
      character(kind=c_char), intent(in) :: path(*), temporary(*)
      integer(c_int64_t), intent(in) :: head(*)
      integer(c_int64_t), value :: n_bytes
      integer(c_int), value :: status_before
      integer(c_int) :: status
    end function place_new_c

    function sync_file_c(path) bind(C, name='amontons_sync_file') result(status)
      import :: c_char, c_int
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function sync_file_c

    function truncate_file_c(path, length) bind(C, name='amontons_cut_file') result(status)
      import :: c_char, c_int, c_int64_t
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int64_t), value :: length
      integer(c_int) :: status
    end function truncate_file_c

    subroutine errno_text_c(number, text, buffer_length) bind(C, name='amontons_reason')
      import :: c_char, c_int
      integer(c_int), value :: number, buffer_length
      character(kind=c_char), intent(out) :: text(*)
    end subroutine errno_text_c

    pure function checksum_words_c(words, n_bytes) bind(C, name='amontons_checksum') result(sum)
      import :: c_int64_t
      integer(c_int64_t), intent(in) :: words(*)
      integer(c_int64_t), value :: n_bytes
      integer(c_int64_t) :: sum
    end function checksum_words_c

    pure function checksum_text_c(text, n_bytes) bind(C, name='amontons_checksum') result(sum)
      import :: c_int64_t, c_char
      character(kind=c_char), intent(in) :: text(*)
      integer(c_int64_t), value :: n_bytes
      integer(c_int64_t) :: sum
    end function checksum_text_c

    pure function continue_checksum_c(before, words, n_bytes) bind(C, name='amontons_continue_checksum') result(sum)
      import :: c_int64_t
      integer(c_int64_t), value :: before
      integer(c_int64_t), intent(in) :: words(*)
      integer(c_int64_t), value :: n_bytes
      integer(c_int64_t) :: sum
    end function continue_checksum_c

    subroutine acquire_lock_c() bind(C, name='amontons_acquire_lock')
    end subroutine acquire_lock_c

    subroutine release_lock_c() bind(C, name='amontons_release_lock')
    end subroutine release_lock_c

    !> Releases the lock during long work without text; the number is for resume_lock.
    function suspend_lock() bind(C, name='amontons_suspend_lock') result(before)
      import :: c_int
      integer(c_int) :: before
    end function suspend_lock

    !> Takes the lock again if it was held.
    subroutine resume_lock(before) bind(C, name='amontons_resume_lock')
      import :: c_int
      integer(c_int), value :: before
    end subroutine resume_lock

    !> Restarts the program with settings that libraries read before it begins; see posix_shim.c. For the main program only.
    subroutine restart_with_settings() bind(C, name='amontons_begin_again')
    end subroutine restart_with_settings

    !> Large blocks of memory go back to the system when they are freed. For the main program only.
    subroutine return_large_blocks() bind(C, name='amontons_return_blocks')
    end subroutine return_large_blocks

    !> Starts recording SIGINT, SIGTERM and SIGUSR1. For the main program only.
    subroutine install_signal_handlers() bind(C, name='amontons_watch_signals')
    end subroutine install_signal_handlers

    !> The number of the signal that requested a stop; 0: no signal, or signals are not recorded.
    function pending_stop_signal() bind(C, name='amontons_stop_signal') result(number)
      import :: c_int
      integer(c_int) :: number
    end function pending_stop_signal

    function status_requested_c() bind(C, name='amontons_status_requested') result(is_requested)
      import :: c_int
      integer(c_int) :: is_requested
    end function status_requested_c

    function has_memory_c(n_bytes) bind(C, name='amontons_has_memory') result(has)
      import :: c_int, c_int64_t
      integer(c_int64_t), value :: n_bytes
      integer(c_int) :: has
    end function has_memory_c

    !> Memory still available to the process [megabytes].
    function available_megabytes() bind(C, name='amontons_available_megabytes') result(megabytes)
      import :: c_double
      real(c_double) :: megabytes
    end function available_megabytes

    !> Memory limit of the process by machine and limits, whatever other processes use [megabytes].
    function total_megabytes() bind(C, name='amontons_whole_megabytes') result(megabytes)
      import :: c_double
      real(c_double) :: megabytes
    end function total_megabytes

    !> Peak resident memory of the process so far [megabytes].
    function peak_megabytes() bind(C, name='amontons_peak_megabytes') result(megabytes)
      import :: c_double
      real(c_double) :: megabytes
    end function peak_megabytes

    subroutine end_process_c(code) bind(C, name='amontons_end_process')
      import :: c_int
      integer(c_int), value :: code
    end subroutine end_process_c

    subroutine set_exit_handler_c(is_on) bind(C, name='amontons_watch_end')
      import :: c_int
      integer(c_int), value :: is_on
    end subroutine set_exit_handler_c
    function start_heartbeat_c(descriptor, seconds) bind(C, name='amontons_start_heartbeat') result(handle)
      import :: c_int, c_double, c_ptr
      integer(c_int), value :: descriptor
      real(c_double), value :: seconds
      type(c_ptr) :: handle
    end function start_heartbeat_c

    subroutine postpone_heartbeat_c(handle) bind(C, name='amontons_postpone_heartbeat')
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine postpone_heartbeat_c

    subroutine set_heartbeat_c(handle, text) bind(C, name='amontons_set_heartbeat')
      import :: c_ptr, c_char
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: text(*)
    end subroutine set_heartbeat_c

    subroutine stop_heartbeat_c(handle) bind(C, name='amontons_stop_heartbeat')
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine stop_heartbeat_c
  end interface

  !> A thread that writes a line where nothing else was written for some seconds.
  type :: heartbeat_type
    private
    type(c_ptr) :: handle = c_null_ptr           !< null: there is none
  end type heartbeat_type

contains

  !> Starts a heartbeat without text, which writes nothing yet.
  subroutine start_heartbeat(beat, descriptor, seconds)
    type(heartbeat_type), intent(out) :: beat
    integer(c_int), intent(in) :: descriptor     !< of the open file
    real(DP), intent(in) :: seconds              !< [s]
    beat%handle = start_heartbeat_c(descriptor, real(seconds, c_double))
  end subroutine start_heartbeat


  !> A line was written just now: the next one is due in some seconds.
  subroutine postpone_heartbeat(beat)
    type(heartbeat_type), intent(in) :: beat
    if (c_associated(beat%handle)) call postpone_heartbeat_c(beat%handle)
  end subroutine postpone_heartbeat


  !> Sets the line that a heartbeat writes; '': none.
  subroutine set_heartbeat(beat, text)
    type(heartbeat_type), intent(in) :: beat
    character(*), intent(in) :: text
    if (c_associated(beat%handle)) call set_heartbeat_c(beat%handle, text // c_null_char)
  end subroutine set_heartbeat


  !> Ends a heartbeat.
  subroutine stop_heartbeat(beat)
    type(heartbeat_type), intent(inout) :: beat
    if (c_associated(beat%handle)) call stop_heartbeat_c(beat%handle)
    beat%handle = c_null_ptr
  end subroutine stop_heartbeat


  !> Starts a file that takes the place of another one when it is complete: at any moment the complete old or the complete new file
  !! exists. It is written under a temporary name. An error is kept until the end.
  subroutine start_new_file(file, path)
    type(new_file_type), intent(out) :: file
    character(*), intent(in) :: path
    file%path = path
    file%descriptor = open_new_c(path // SUFFIX_NEW // c_null_char)
    file%status = max(0, -file%descriptor)
  end subroutine start_new_file


  !> Appends words to a new file.
  subroutine append_words(file, words)
    type(new_file_type), intent(inout) :: file
    integer(I64), intent(in) :: words(:)
    if (file%status == 0) file%status = append_new_c(file%descriptor, words, 8_I64 * size(words, kind=I64))
  end subroutine append_words


  !> Writes the first words of a new file once more, flushes it to the storage device and renames it (atomic). After an error it is
  !! removed. Errors (EXIT_IO): the first one since its start.
  subroutine place_new_file(file, head, error)
    type(new_file_type), intent(inout) :: file
    integer(I64), intent(in) :: head(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    status = file%status
    if (file%descriptor >= 0) status = place_new_c(file%descriptor, file%path // c_null_char, file%path // SUFFIX_NEW // &
      c_null_char, head, 8_I64 * size(head, kind=I64), status)
    call set_posix_error('write', file%path, status, error)
  end subroutine place_new_file


  !> Removes a new file: the one before stays.
  subroutine remove_new_file(file)
    type(new_file_type), intent(inout) :: file
    integer(I64), parameter :: NO_WORDS(0) = [integer(I64) ::]
    integer :: status
    status = huge(status)                            ! not 0: the shim removes the file
    if (file%descriptor >= 0) status = place_new_c(file%descriptor, file%path // c_null_char, file%path // SUFFIX_NEW // &
      c_null_char, NO_WORDS, 0_I64, status)
    file%descriptor = -1
  end subroutine remove_new_file


  !> Flushes a file that is open for writing to the storage device.
  subroutine sync_file(path, error)
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    call set_posix_error('bring to disk', path, sync_file_c(path // c_null_char), error)
  end subroutine sync_file


  !> Truncates a file to a length. Errors: the file does not exist or is shorter.
  subroutine truncate_file(path, length, error)
    character(*), intent(in) :: path
    integer(I64), intent(in) :: length               !< [bytes]
    type(error_type), allocatable, intent(out) :: error
    integer, parameter :: ERRNO_INVALID = 22             ! EINVAL
    integer :: status
    status = truncate_file_c(path // c_null_char, length)
    if (status == ERRNO_INVALID) then
      call set_error(error, EXIT_IO, 'The file ' // path // ' is shorter than it was when the checkpoint was written.')
    else
      call set_posix_error('cut off', path, status, error)
    end if
  end subroutine truncate_file


  !> Checksum of words; it depends on their values and their order.
  pure function checksum_of_words(words) result(sum)
    integer(I64), intent(in) :: words(:)
    integer(I64) :: sum
    sum = checksum_words_c(words, 8_I64 * size(words, kind=I64))
  end function checksum_of_words


  !> Checksum of a sequence of words that comes in pieces.
  pure function continue_checksum(before, words) result(sum)
    integer(I64), intent(in) :: before               !< of the pieces before; 0 at the start
    integer(I64), intent(in) :: words(:)
    integer(I64) :: sum
    sum = continue_checksum_c(before, words, 8_I64 * size(words, kind=I64))
  end function continue_checksum


  !> The same for a text.
  pure function checksum_of_text(text) result(sum)
    character(*), intent(in) :: text
    integer(I64) :: sum
    sum = checksum_text_c(text, int(len(text), I64))
  end function checksum_of_text


  !> The operating system's text for an error number, e.g. 'No space left on device'.
  function errno_text(number) result(text)
    integer, intent(in) :: number                    !< errno
    character(:), allocatable :: text
    character(256) :: buffer
    call errno_text_c(number, buffer, len(buffer))
    text = buffer(:index(buffer, c_null_char) - 1)
  end function errno_text


  !> Whether SIGUSR1 arrived since the last call.
  logical function is_status_requested()
    is_status_requested = status_requested_c() /= 0
  end function is_status_requested


  !> Whether so much memory is available at once.
  logical function has_memory(megabytes)
    integer, intent(in) :: megabytes
    has_memory = has_memory_c(int(megabytes, I64) * 1048576_I64) /= 0
  end function has_memory


  !> After .true., an unexpected end of the process gives an exit code of this program and a line that starts with *ERROR;
  !! .false. announces a regular end. For the main program only.
  subroutine set_exit_handler(is_on)
    logical, intent(in) :: is_on
    call set_exit_handler_c(merge(1_c_int, 0_c_int, is_on))
  end subroutine set_exit_handler


  !> Ends the process with an exit code, without what the run-time libraries do at the end: after an error their memory may be
  !! broken. All files must be closed. For the main program only.
  subroutine end_process(code)
    integer, intent(in) :: code
    flush (output_unit)
    flush (error_unit)
    call end_process_c(int(code, c_int))
  end subroutine end_process


  !> Makes an error from an error number.
  subroutine set_posix_error(doing, path, status, error)
    character(*), intent(in) :: doing                !< e.g. 'write'
    character(*), intent(in) :: path
    integer, intent(in) :: status                    !< errno; 0: success
    type(error_type), allocatable, intent(out) :: error
    if (status /= 0) call set_error(error, EXIT_IO, 'Cannot ' // doing // ' the file ' // path // ': ' // &
      errno_text(status) // '.')
  end subroutine set_posix_error


  !> Waits for the process lock; finalization of the variable releases it.
  subroutine acquire_lock(lock)
    type(process_lock_type), intent(inout) :: lock
    if (lock%is_locked) return
    call acquire_lock_c()
    lock%is_locked = .true.
  end subroutine acquire_lock


  !> Finalizer: releases the lock.
  subroutine release_lock(lock)
    type(process_lock_type), intent(inout) :: lock
    if (lock%is_locked) call release_lock_c()
    lock%is_locked = .false.
  end subroutine release_lock

end module amontons_posix
