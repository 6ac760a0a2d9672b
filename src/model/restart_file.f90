!> The restart file job.res: records of states and of the deck.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The file is a sequence of records of 64-bit words in native byte order: magic, version, number of words, checksum of the
!! following words, the label (step, increment, whether the step is done, step time, total time), then the content. The first
!! record holds the deck. A record is appended and flushed to the storage device; an incomplete record after a crash ends the file.
module amontons_restart_file
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_posix, only: checksum_of_words, truncate_file, sync_file
  use amontons_text, only: to_text
  implicit none
  private
  public :: restart_file_type, state_key_type, create_restart_file, reopen_restart_file, append_restart_state, read_restart_deck, &
    find_restart_state, read_restart_state

  integer(I64), parameter :: RESTART_FILE_MAGIC = transfer('AMONTRES', 0_I64)   !< as a number it identifies the byte order too
  integer(I64), parameter :: RESTART_FILE_VERSION = 1
  integer, parameter :: N_RECORD_HEADER = 9                 !< words of a record before its content

  !> The label of a record: which state it holds.
  type :: state_key_type
    integer :: step = 0, increment = 0             !< 0: the deck
    logical :: is_step_done = .false.
    real(DP) :: step_time = 0, total_time = 0      !< [time]
    integer(I64) :: place = 0                      !< first byte of the record in the file, from 0
  end type state_key_type

  !> A restart file open for writing.
  type :: restart_file_type
    character(:), allocatable :: path              !< unallocated: nothing is written
    integer(I64) :: last = 0                       !< first byte of the last state, from 0
    integer(I64) :: end = 0                        !< bytes of the file
    integer :: step = 0                            !< of the last state
  end type restart_file_type

contains

  !> Starts a file with the deck. Errors: EXIT_IO.
  subroutine create_restart_file(restart_file, path, deck, dialect, error)
    type(restart_file_type), intent(inout) :: restart_file
    character(*), intent(in) :: path
    character(*), intent(in) :: deck               !< complete, includes in place
    integer, intent(in) :: dialect                 !< DIALECT_...
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable :: letters(:)
    integer :: unit, status
    open (newunit=unit, file=path, status='replace', action='write', iostat=status)
    if (status == 0) close (unit, iostat=status)
    if (status /= 0) then
      call set_error(error, EXIT_IO, 'Cannot write the file ' // path // '.')
      return
    end if
    restart_file = restart_file_type(path=path)
    letters = transfer(deck, [0_I64], (len(deck, I64) + 7_I64) / 8_I64)
    call append_record(restart_file, state_key_type(), [int(dialect, I64), len(deck, I64), letters], error)
    restart_file%last = restart_file%end
  end subroutine create_restart_file


  !> Continues a file from its length at a checkpoint. Later records are cut off, and a last state that is incomplete.
  subroutine reopen_restart_file(restart_file, path, counts, error)
    type(restart_file_type), intent(inout) :: restart_file
    character(*), intent(in) :: path
    integer(I64), intent(in) :: counts(3)          !< last, end, step at the checkpoint
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: n_bytes
    restart_file = restart_file_type(path=path, last=counts(1), end=counts(2), step=int(counts(3)))
    inquire (file=path, size=n_bytes)
    if (n_bytes < restart_file%end .and. n_bytes >= restart_file%last) then   ! OVERLAY had replaced the last state
      restart_file%end = restart_file%last
      restart_file%step = 0
    end if
    call truncate_file(path, restart_file%end, error)
  end subroutine reopen_restart_file


  !> Appends a state; with OVERLAY it replaces the previous one of the same step.
  subroutine append_restart_state(restart_file, label, words, is_overlay, error)
    type(restart_file_type), intent(inout) :: restart_file
    type(state_key_type), intent(in) :: label
    integer(I64), intent(in) :: words(:)
    logical, intent(in) :: is_overlay
    type(error_type), allocatable, intent(out) :: error
    if (is_overlay .and. restart_file%step == label%step) then
      call truncate_file(restart_file%path, restart_file%last, error)
      if (allocated(error)) return
      restart_file%end = restart_file%last
    end if
    restart_file%last = restart_file%end
    restart_file%step = label%step
    call append_record(restart_file, label, words, error)
  end subroutine append_restart_state


  !> Appends a record and flushes it to the storage device.
  subroutine append_record(restart_file, label, words, error)
    type(restart_file_type), intent(inout) :: restart_file
    type(state_key_type), intent(in) :: label
    integer(I64), intent(in) :: words(:)
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable :: record(:)
    integer :: unit, status, status_of_close
    record = [RESTART_FILE_MAGIC, RESTART_FILE_VERSION, size(words, kind=I64) + N_RECORD_HEADER, 0_I64, int(label%step, I64), &
      int(label%increment, I64), &
      merge(1_I64, 0_I64, label%is_step_done), transfer(label%step_time, 0_I64), transfer(label%total_time, 0_I64), words]
    record(4) = checksum_of_words(record(5:))
    open (newunit=unit, file=restart_file%path, access='stream', form='unformatted', action='write', status='old', iostat=status)
    if (status == 0) then
      write (unit, pos=restart_file%end + 1_I64, iostat=status) record
      close (unit, iostat=status_of_close)
      if (status == 0) status = status_of_close
    end if
    if (status /= 0) then
      call set_error(error, EXIT_IO, 'Cannot write the file ' // restart_file%path // &
        ': no disk space, or the file does not exist.')
      return
    end if
    restart_file%end = restart_file%end + 8_I64 * size(record, kind=I64)
    call sync_file(restart_file%path, error)
  end subroutine append_record


  !> Reads the deck of a restart file. Errors (EXIT_IO): file missing, damaged, or of another version of the program.
  subroutine read_restart_deck(path, deck, dialect, error)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: deck
    integer, intent(out) :: dialect                !< DIALECT_...
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable :: words(:)
    integer(I64) :: i, n
    deck = ''
    dialect = 0
    call read_record(path, 0_I64, words, error)
    if (allocated(error)) return
    n = 0
    if (size(words) >= 2) n = words(2)
    if (n <= 0 .or. (n + 7_I64) / 8_I64 + 2_I64 /= size(words, kind=I64)) then
      call set_damaged_error(path, error)
      return
    end if
    dialect = int(words(1))
    deallocate (deck)
    allocate (character(n) :: deck)
    do i = 1, (n + 7_I64) / 8_I64
      deck(8 * i - 7:min(8 * i, n)) = word_characters(words(i + 2), int(min(8_I64, n - 8 * (i - 1))))
    end do
  end subroutine read_restart_deck


  !> The first n letters of a word.
  pure function word_characters(word, n) result(letters)
    integer(I64), intent(in) :: word
    integer, intent(in) :: n                       !< 8 at most
    character(n) :: letters
    character(8) :: all_letters
    all_letters = transfer(word, all_letters)
    letters = all_letters(:n)
  end function word_characters


  !> Finds the state of a step and an increment; increment 0: the last of the step; both 0: the last of all.
  !!
  !! Errors (EXIT_IO): the state does not exist; the message describes what exists.
  subroutine find_restart_state(path, step, increment, label, error)
    character(*), intent(in) :: path
    integer, intent(in) :: step, increment         !< 0: the last
    type(state_key_type), intent(out) :: label
    type(error_type), allocatable, intent(out) :: error
    type(state_key_type) :: here, last
    integer(I64) :: place, next, n_bytes
    logical :: is_found, is_sound
    inquire (file=path, size=n_bytes)
    place = 0
    is_found = .false.
    do
      call read_label(path, place, n_bytes, here, next, is_sound)
      if (next == 0) exit
      if (here%step > 0) last = here
      if (here%step > 0 .and. (step == 0 .or. here%step == step) .and. (increment == 0 .or. here%increment == increment)) then
        is_found = .true.
        label = here
      end if
      place = next
    end do
    if (is_found .and. is_sound) return
    if (.not. is_sound) then
      call set_damaged_error(path, error)
    else if (last%step == 0) then
      call set_error(error, EXIT_IO, 'The restart file ' // path // ' holds no state.')
    else if (increment > 0) then
      call set_error(error, EXIT_IO, 'The restart file ' // path // ' holds no state of increment ' // to_text(increment) // &
        ' of step ' // to_text(merge(step, last%step, step > 0)) // '. ' // last_state(last))
    else
      call set_error(error, EXIT_IO, 'The restart file ' // path // ' holds no state of step ' // to_text(step) // '. ' // &
        last_state(last))
    end if
  end subroutine find_restart_state


  !> A sentence about the last state.
  function last_state(label) result(sentence)
    type(state_key_type), intent(in) :: label
    character(:), allocatable :: sentence
    sentence = 'Its last one is of step ' // to_text(label%step) // ', increment ' // to_text(label%increment) // '.'
  end function last_state


  !> The label of the record at a position, and the position of the next one; 0: no complete record.
  subroutine read_label(path, place, n_bytes, label, next, is_sound)
    character(*), intent(in) :: path
    integer(I64), intent(in) :: place              !< [bytes]
    integer(I64), intent(in) :: n_bytes            !< of the file
    type(state_key_type), intent(out) :: label
    integer(I64), intent(out) :: next              !< [bytes]
    logical, intent(out) :: is_sound               !< .false.: not even the start of a record
    integer(I64) :: head(N_RECORD_HEADER)
    integer :: unit, status
    next = 0
    is_sound = .true.
    if (n_bytes - place < 8_I64 * N_RECORD_HEADER) return
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=status)
    if (status /= 0) return
    read (unit, pos=place + 1_I64, iostat=status) head
    close (unit)
    is_sound = status == 0 .and. head(1) == RESTART_FILE_MAGIC .and. head(2) == RESTART_FILE_VERSION &
      .and. head(3) >= N_RECORD_HEADER
    if (.not. is_sound .or. head(3) > (n_bytes - place) / 8_I64) return
    label%step = int(head(5))
    label%increment = int(head(6))
    label%is_step_done = head(7) /= 0
    label%step_time = transfer(head(8), label%step_time)
    label%total_time = transfer(head(9), label%total_time)
    label%place = place
    next = place + 8_I64 * head(3)
  end subroutine read_label


  !> The content of the record of a label. Errors (EXIT_IO): it is damaged.
  subroutine read_restart_state(path, label, words, error)
    character(*), intent(in) :: path
    type(state_key_type), intent(in) :: label
    integer(I64), allocatable, intent(out) :: words(:)
    type(error_type), allocatable, intent(out) :: error
    call read_record(path, label%place, words, error)
  end subroutine read_restart_state


  !> Reads and checks a record.
  subroutine read_record(path, place, words, error)
    character(*), intent(in) :: path
    integer(I64), intent(in) :: place              !< [bytes]
    integer(I64), allocatable, intent(out) :: words(:)
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable :: record(:)
    integer(I64) :: head(N_RECORD_HEADER), n_bytes
    integer :: unit, status
    inquire (file=path, size=n_bytes)
    if (n_bytes < 0) then
      call set_error(error, EXIT_IO, 'There is no restart file ' // path // '. A job writes one if its deck has ' // &
        '*RESTART, WRITE.')
      return
    end if
    head = 0
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=status)
    if (status == 0) read (unit, pos=place + 1_I64, iostat=status) head
    if (status /= 0 .or. head(1) /= RESTART_FILE_MAGIC) then
      call set_damaged_error(path, error)
    else if (head(2) /= RESTART_FILE_VERSION) then
      call set_error(error, EXIT_IO, 'The restart file ' // path // ' is of another version of Amontons.')
    else if (head(3) < N_RECORD_HEADER .or. head(3) > (n_bytes - place) / 8_I64) then
      call set_damaged_error(path, error)
    else
      allocate (record(head(3)))
      read (unit, pos=place + 1_I64, iostat=status) record
      if (status /= 0) then
        call set_damaged_error(path, error)
      else if (checksum_of_words(record(5:)) /= record(4)) then
        call set_damaged_error(path, error)
      else
        words = record(N_RECORD_HEADER + 1:)
      end if
    end if
    close (unit)
  end subroutine read_record


  !> The error for an unusable file.
  subroutine set_damaged_error(path, error)
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_IO, 'The restart file ' // path // ' is damaged, or was not written by *RESTART, WRITE of ' // &
      'Amontons.')
  end subroutine set_damaged_error

end module amontons_restart_file
