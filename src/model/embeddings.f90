!> Embedded elements: elements whose nodes move with the hosts in which they lie, as EMBEDDED ELEMENT cards name them.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_embeddings
  use amontons_kinds, only: DP
  implicit none
  private
  public :: embedding_type

  !> One EMBEDDED ELEMENT card. The tolerances are those of Abaqus by default.
  type :: embedding_type
    integer :: line = 0                              !< of the card in its file, for messages
    integer, allocatable :: elements(:)              !< embedded, ascending
    integer, allocatable :: hosts(:)                 !< elements in which they may lie, ascending
    real(DP) :: exterior_tolerance = 0.05_DP         !< of a node outside, over the mean size of the hosts [-]
    real(DP) :: absolute_tolerance = huge(1.0_DP)    !< the same as a distance; the smaller counts [length]
    real(DP) :: roundoff_tolerance = 1.0e-6_DP       !< weights of a host's nodes below it are left out [-]
  end type embedding_type

end module amontons_embeddings
