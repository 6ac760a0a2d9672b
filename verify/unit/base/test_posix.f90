!> Unit test of amontons_posix: whole files, cuts, checksums, memory and locks.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_posix
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_kinds, only: DP, I64
  use amontons_posix, only: new_file_type, start_new_file, append_words, place_new_file, &
    continue_checksum, sync_file, truncate_file, checksum_of_words, checksum_of_text, errno_text, &
    has_memory, available_megabytes, total_megabytes, peak_megabytes, heartbeat_type, start_heartbeat, postpone_heartbeat, &
    set_heartbeat, stop_heartbeat
  use check, only: suite_type
  implicit none
  interface
    !> POSIX: creates a file for writing.
    function creat(path, mode) bind(C, name='creat') result(descriptor)
      import :: c_char, c_int
      implicit none
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
      integer(c_int) :: descriptor
    end function creat

    !> POSIX: waits.
    function usleep(microseconds) bind(C, name='usleep') result(status)
      import :: c_int
      implicit none
      integer(c_int), value :: microseconds
      integer(c_int) :: status
    end function usleep
  end interface

  type(suite_type) :: suite
  character(*), parameter :: PATH = 'test_posix.bin'
  call check_files()
  call check_checksums()
  call check_machine()
  call check_heartbeat()
  call suite%finish()

contains

  !> Nothing without a text; then a line each 0.1 s, unless others are written; nothing after the end.
  subroutine check_heartbeat()
    type(heartbeat_type) :: beat
    integer :: i, n
    call start_heartbeat(beat, creat('test_posix.beats' // c_null_char, 384_c_int), 0.1_DP)
    call wait(250)
    call suite%that('silent at first', beats() == 0)
    call set_heartbeat(beat, 'still here')
    call wait(1050)
    n = beats()
    call suite%that('ten a second', n >= 5 .and. n <= 11)
    i = beats()
    call stop_heartbeat(beat)
    call wait(250)
    call suite%that('none after the end', beats() == i)
    call start_heartbeat(beat, creat('test_posix.beats' // c_null_char, 384_c_int), 2.0_DP)
    call set_heartbeat(beat, 'still here')
    do i = 1, 12
      call wait(250)
      call postpone_heartbeat(beat)
    end do
    call suite%that('none where others write', beats() == 0)
    call stop_heartbeat(beat)
    call set_heartbeat(beat, 'no one')            ! without a thread: nothing happens
  end subroutine check_heartbeat


  !> Waits.
  subroutine wait(milliseconds)
    integer, intent(in) :: milliseconds
    integer(c_int) :: unused
    integer :: i
    do i = 1, milliseconds / 50
      unused = usleep(50000_c_int)
    end do
  end subroutine wait


  !> The number of lines written.
  integer function beats()
    character(20) :: line
    integer :: unit, status
    beats = 0
    open (newunit=unit, file='test_posix.beats', action='read', status='old')
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (line == 'still here') beats = beats + 1
    end do
    close (unit)
  end function beats


  !> What is written is there, whole; a cut shortens it; what cannot be done is an error with a reason.
  subroutine check_files()
    type(new_file_type) :: file
    type(error_type), allocatable :: error
    logical :: is_there
    integer(I64) :: words(3), n_bytes
    integer :: unit
    call start_new_file(file, PATH)
    call append_words(file, [0_I64, -2_I64])
    call append_words(file, [huge(1_I64)])
    inquire (file=PATH, exist=is_there)
    call suite%that('not in its place yet', .not. is_there)
    call place_new_file(file, [1_I64], error)
    call suite%that('written', .not. allocated(error))
    open (newunit=unit, file=PATH, access='stream', form='unformatted', action='read', status='old')
    read (unit) words
    close (unit)
    call suite%that('as given', all(words == [1_I64, -2_I64, huge(1_I64)]))
    call sync_file(PATH, error)
    call suite%that('on the medium', .not. allocated(error))
    call truncate_file(PATH, 8_I64, error)
    inquire (file=PATH, size=n_bytes)
    call suite%that('cut', .not. allocated(error) .and. n_bytes == 8)
    call truncate_file(PATH, 800_I64, error)
    call suite%that('not made longer', allocated(error))
    call start_new_file(file, 'no/such/folder/file')
    call append_words(file, [1_I64])
    call place_new_file(file, [1_I64], error)
    call suite%that('no such folder', allocated(error))
    if (allocated(error)) call suite%that('an error of files', error%code == EXIT_IO)
    if (allocated(error)) call suite%that('with a reason', index(error%message, errno_text(2)) > 0)
    open (newunit=unit, file=PATH, status='old')
    close (unit, status='delete')
  end subroutine check_files


  !> They change with every word, with their order, and with every letter.
  subroutine check_checksums()
    integer(I64) :: words(20)
    integer(I64) :: before
    integer :: i
    words = [(int(i * i, I64), i=1, 20)]
    before = checksum_of_words(words)
    call suite%that('the same again', checksum_of_words(words) == before)
    do i = 1, 20
      words(i) = ieor(words(i), 1_I64)
      call suite%that('one bit', checksum_of_words(words) /= before)
      words(i) = ieor(words(i), 1_I64)
    end do
    call suite%that('in pieces', continue_checksum(continue_checksum(0_I64, words(:7)), words(8:)) == &
      continue_checksum(0_I64, words))
    call suite%that('the order', checksum_of_words(words([2, 1])) /= checksum_of_words(words([1, 2])))
    call suite%that('letters', checksum_of_text('ab') /= checksum_of_text('ba'))
    call suite%that('blanks at the end', checksum_of_text('ab') /= checksum_of_text('ab '))
    call suite%that('the same text', checksum_of_text('contact') == checksum_of_text('contact'))
  end subroutine check_checksums


  !> Little memory can be had, more than the machine has cannot be there.
  subroutine check_machine()
    character(:), allocatable :: one, other
    real(DP) :: total, available, peak
    one = errno_text(2)
    other = errno_text(28)
    total = real(total_megabytes(), DP)
    available = real(available_megabytes(), DP)
    peak = real(peak_megabytes(), DP)
    call suite%that('a megabyte', has_memory(1))
    call suite%that('the machine has some', total > 0 .and. available <= total)
    call suite%that('this program took some', peak > 0 .and. peak < total)
    call suite%that('words for a number', len(one) > 5 .and. one /= other)
  end subroutine check_machine

end program test_posix
