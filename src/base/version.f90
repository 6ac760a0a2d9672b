!> Version number of the program, for result files and documentation.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_version
  implicit none
  private
  public :: VERSION, DESCRIPTION

  character(*), parameter :: VERSION = '0.1.0'   !< as in CHANGELOG.md and CITATION.cff
  character(*), parameter :: DESCRIPTION = 'quasi-static solid mechanics with frictional contact'
end module amontons_version
