!> Version: the number of this version, one place for the program, the result files and the manual.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_version
  implicit none
  private
  public :: VERSION, DESCRIPTION

  character(*), parameter :: VERSION = '0.1.0'   !< as in CHANGELOG.md and CITATION.cff
  character(*), parameter :: DESCRIPTION = 'quasi-static solid mechanics with frictional contact'
end module amontons_version
