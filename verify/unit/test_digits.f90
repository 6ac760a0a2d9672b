!> Rows of numbers as text: the same characters as Fortran's own formatted write, over all magnitudes and at ties.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_digits
  use amontons_kinds, only: DP
  use amontons_digits, only: rows_as_text
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: k
  call random_seed(put=[(19 * k, k=1, 64)])
  call test_random()
  call test_known()
  call suite%finish()

contains

  !> Random numbers of all sizes that two digits of an exponent hold, and sums of powers of two, half of which are ties.
  subroutine test_random()
    integer, parameter :: N = 20000
    real(DP), allocatable :: values(:, :), r(:, :)
    integer, allocatable :: labels(:)
    integer :: i, n_bad
    character(50) :: line
    character(:), allocatable :: text
    allocate (values(3, N), r(3, N), labels(N))
    call random_number(values)
    call random_number(r)
    values = (values - 0.5_DP) * 10.0_DP**(180 * (r - 0.5_DP))
    do i = 1, N
      labels(i) = 37 * i
      if (mod(i, 2) == 0) values(3, i) = (real(nint(1.0e6_DP * r(3, i)), DP) + 0.5_DP) / real(2**mod(i, 7), DP)
    end do
    text = rows_as_text(labels, values)
    n_bad = 0
    do i = 1, N
      write (line, '(a,i10,1p,3e12.5)') ' -1', labels(i), values(:, i)
      if (text(50 * (i - 1) + 1:50 * i - 1) /= line(:49)) n_bad = n_bad + 1
    end do
    call suite%that('the same characters', n_bad == 0)
    call suite%that('one line a row', len(text) == 50 * N - 1)
  end subroutine test_random


  !> What a reader of the columns knows.
  subroutine test_known()
    real(DP) :: values(6, 1)
    values(:, 1) = [0.0_DP, -1.0_DP, 999999.5_DP, 1.0e-120_DP, -1.0e120_DP, 123456.0_DP]
    call suite%that('known', rows_as_text([7], values) == ' -1         7 0.00000E+00-1.00000E+00 1.00000E+06 0.00000E+00' // &
      '-9.90000E+99 1.23456E+05')
    call suite%that('nothing', len(rows_as_text([integer ::], values(:, :0))) == 0)
  end subroutine test_known

end program test_digits
