!> Unit test of amontons_kinds: precision and range of the numbers.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_kinds
  use amontons_kinds, only: DP, SP, I8, I64, PI, NAME_LENGTH
  use amontons_version, only: VERSION, DESCRIPTION
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_numbers()
  call check_version()
  call suite%finish()

contains

  !> What the tolerances and the files of the program count on.
  subroutine check_numbers()
    call suite%that('doubles', digits(1.0_DP) == 53 .and. storage_size(1.0_DP) == 64 .and. range(1.0_DP) >= 307)
    call suite%that('singles', digits(1.0_SP) == 24 .and. storage_size(1.0_SP) == 32)
    call suite%that('bytes', storage_size(1_I8) == 8)
    call suite%that('sizes', storage_size(1_I64) == 64)
    call suite%near('pi', PI, 4 * atan(1.0_DP), 0.0_DP)
    call suite%that('names are as long as Abaqus has them', NAME_LENGTH == 80)
  end subroutine check_numbers


  !> Three numbers with points between them.
  subroutine check_version()
    integer :: i
    call suite%that('two points', count([(VERSION(i:i) == '.', i=1, len(VERSION))]) == 2)
    call suite%that('digits and points', verify(VERSION, '0123456789.') == 0)
    call suite%that('a description', len(DESCRIPTION) > 10)
  end subroutine check_version

end program test_kinds
