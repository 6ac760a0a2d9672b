!> Unit test of amontons_posix: whole files, cuts, checksums, memory and locks.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_posix
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_kinds, only: DP, I64
  use amontons_posix, only: write_whole_file, sync_file, truncate_file, checksum_of_words, checksum_of_text, errno_text, &
    has_memory, available_megabytes, total_megabytes, peak_megabytes
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  character(*), parameter :: PATH = 'test_posix.bin'
  call check_files()
  call check_checksums()
  call check_machine()
  call suite%finish()

contains

  !> What is written is there, whole; a cut shortens it; what cannot be done is an error with a reason.
  subroutine check_files()
    type(error_type), allocatable :: error
    integer(I64) :: words(3), n_bytes
    integer :: unit
    call write_whole_file(PATH, [1_I64, -2_I64, huge(1_I64)], error)
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
    call write_whole_file('no/such/folder/file', [1_I64], error)
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
