!> Submodels: nodes that follow the results of a global model, as SUBMODEL cards name them.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_submodels
  use amontons_kinds, only: DP
  implicit none
  private
  public :: submodel_type, DEFAULT_EXTERIOR_TOLERANCE

  real(DP), parameter :: DEFAULT_EXTERIOR_TOLERANCE = 0.05_DP   !< EXTERIOR TOLERANCE of Abaqus [-]

  !> One SUBMODEL card.
  type :: submodel_type
    integer :: line = 0                          !< of the card in its file, for messages
    character(:), allocatable :: path            !< result file of the global model as written; empty: that of the command line
    integer, allocatable :: nodes(:)             !< that may be driven, each once, ascending
    character(:), allocatable :: global_elset    !< name of the set of the global elements that count; empty: all
    integer, allocatable :: global_labels(:)     !< numbers of its elements where the deck has this set, ascending
    logical :: is_exterior_error = .true.        !< a driven node farther outside than the tolerance ends the job
    real(DP) :: exterior_tolerance = DEFAULT_EXTERIOR_TOLERANCE   !< over the mean size of the global elements [-]
    real(DP) :: absolute_tolerance = huge(1.0_DP)   !< the smaller of both counts [length]
  end type submodel_type

end module amontons_submodels
