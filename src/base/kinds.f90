!> Number kinds, pi and the longest name of the deck.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_kinds
  use, intrinsic :: iso_fortran_env, only: int8, int64, real32, real64
  implicit none
  private
  public :: DP, SP, I8, I64, PI, NAME_LENGTH

  integer, parameter :: DP = real64           !< all real numbers except those of preconditioners
  integer, parameter :: SP = real32           !< for preconditioners, which need no full precision
  integer, parameter :: I8 = int8             !< bytes
  integer, parameter :: I64 = int64           !< sizes, clocks, row pointers of large matrices
  real(DP), parameter :: PI = 3.141592653589793_DP
  integer, parameter :: NAME_LENGTH = 80      !< longest name of a set, surface, material, ... in a deck
end module amontons_kinds
