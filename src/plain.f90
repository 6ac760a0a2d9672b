!> Plain: the text of a file, whole, as lines of plain characters, whatever system it was written on.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A mark of the byte order is taken off; UTF-16, which some editors and shells of Windows write, is brought to single bytes; where
!! lines end with carriage returns alone these become line ends. (A carriage return before a line end is blank to all who read on.)
module amontons_plain
  use amontons_kinds, only: I64
  use amontons_text, only: NEWLINE
  implicit none
  private
  public :: read_plain, read_beside

  integer(I64), parameter :: BLOCK = 16777216_I64   !< bytes read at once
  character(2), parameter :: LITTLE_END = char(255) // char(254), BIG_END = char(254) // char(255)   !< marks of UTF-16
  character(3), parameter :: UTF_8 = char(239) // char(187) // char(191)   !< the mark of UTF-8

contains

  !> Reads a whole file.
  subroutine read_plain(path, text, is_read)
    character(*), intent(in) :: path
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    integer :: unit, iostat
    integer(I64) :: n
    inquire (file=path, exist=is_read)
    if (.not. is_read) return
    is_read = .false.
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=iostat)
    if (iostat /= 0) return
    inquire (unit=unit, size=n, iostat=iostat)
    if (iostat == 0 .and. n > 0 .and. n < huge(n)) then
      call read_blocks(unit, n, text, is_read)
    else if (iostat == 0) then
      call read_bytes(unit, text, is_read)
    end if
    close (unit, iostat=iostat)
    is_read = is_read .and. iostat == 0
    if (is_read) call make_plain(text)
  end subroutine read_plain


  !> Reads a file whose size is known.
  subroutine read_blocks(unit, n, text, is_read)
    integer, intent(in) :: unit
    integer(I64), intent(in) :: n                !< its size [bytes]
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    integer :: iostat
    integer(I64) :: first, last
    allocate (character(n) :: text)
    do first = 1, n, BLOCK
      last = min(n, first + BLOCK - 1)
      read (unit, iostat=iostat) text(first:last)
      if (iostat /= 0) exit
    end do
    is_read = iostat == 0
  end subroutine read_blocks


  !> Reads a file of unknown size, a pipe, to its end.
  subroutine read_bytes(unit, text, is_read)
    integer, intent(in) :: unit
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    character(:), allocatable :: larger
    character(1) :: byte
    integer :: iostat
    integer(I64) :: n
    allocate (character(4096) :: text)
    n = 0
    do
      read (unit, iostat=iostat) byte
      if (iostat /= 0) exit
      if (n == len(text, I64)) then
        allocate (character(2 * n) :: larger)
        larger(:n) = text
        call move_alloc(larger, text)
      end if
      n = n + 1
      text(n:n) = byte
    end do
    is_read = is_iostat_end(iostat)
    text = text(:n)
  end subroutine read_bytes


  !> Single bytes without a mark, and lines that end with line ends.
  pure subroutine make_plain(text)
    character(:), allocatable, intent(inout) :: text
    integer(I64) :: i
    if (len(text) < 3) return
    if (text(:3) == UTF_8) then
      text = text(4:)
    else if (text(:2) == LITTLE_END .or. text(:2) == BIG_END) then
      text = single_bytes(text, merge(1_I64, 0_I64, text(:2) == BIG_END))
    end if
    if (scan(text, NEWLINE) > 0) return
    do i = 1, len(text, I64)
      if (text(i:i) == achar(13)) text(i:i) = NEWLINE
    end do
  end subroutine make_plain


  !> UTF-16 behind its mark with one byte for each character; what is not ASCII becomes a question mark.
  pure function single_bytes(text, low) result(plain)
    character(*), intent(in) :: text
    integer(I64), intent(in) :: low              !< place of the low byte in a pair: 0 or 1
    character(:), allocatable :: plain
    integer(I64) :: i, n
    n = len(text, I64) / 2 - 1
    allocate (character(n) :: plain)
    do i = 1, n
      plain(i:i) = text(2 * i + 1 + low:2 * i + 1 + low)
      if (iachar(text(2 * i + 2 - low:2 * i + 2 - low)) /= 0 .or. iachar(plain(i:i)) > 127) plain(i:i) = '?'
    end do
  end function single_bytes


  !> Reads a file named in another one: beside that one first, then as it stands.
  subroutine read_beside(including, path, text, is_read)
    character(*), intent(in) :: including        !< path of the including file
    character(:), allocatable, intent(inout) :: path   !< as written; as opened on return
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_read
    character(:), allocatable :: beside
    is_read = .false.
    if (path(1:1) /= '/') then
      beside = including(:index(including, '/', back=.true.)) // path
      call read_plain(beside, text, is_read)
    end if
    if (is_read) then
      path = beside
    else
      call read_plain(path, text, is_read)
    end if
  end subroutine read_beside

end module amontons_plain
