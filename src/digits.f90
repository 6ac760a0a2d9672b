!> Digits: rows of numbers as text, in the columns of a .frd file, ten times as fast as formatted writes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Six digits, correctly rounded: the same characters as the format (' -1', i10, 1p, 6e12.5) gives (digits_shim.c).
module amontons_digits
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
  use amontons_kinds, only: DP
  implicit none
  private
  public :: rows_as_text

  interface
    subroutine put_rows(labels, values, width, n, text) bind(C, name='amontons_put_rows')
      import :: c_char, c_double, c_int
      integer(c_int), intent(in) :: labels(*)
      real(c_double), intent(in) :: values(*)
      integer(c_int), value :: width, n
      character(kind=c_char), intent(out) :: text(*)
    end subroutine put_rows
  end interface

contains

  !> Rows of ' -1', a label in ten columns and values in twelve each, with an end of line between them. Values beyond 9.9e99 are cut
  !! off there, those below 1e-99 are 0: the exponent has two digits.
  function rows_as_text(labels, values) result(text)
    integer, intent(in) :: labels(:)               !< (n) positive
    real(DP), intent(in) :: values(:, :)           !< (width, n) no NaN
    character(:), allocatable :: text
    allocate (character((14 + 12 * size(values, 1)) * size(labels)) :: text)
    if (size(labels) == 0) return
    call put_rows(labels, values, size(values, 1), size(labels), text)
    text = text(:len(text) - 1)
  end function rows_as_text

end module amontons_digits
