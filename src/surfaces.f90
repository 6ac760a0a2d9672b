!> Surfaces: named faces or nodes, how two of them interact, and which pairs may touch.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_surfaces
  use amontons_kinds, only: DP
  implicit none
  private
  public :: surface_type, interaction_type, contact_pair_type, BEHAVIOR_HARD

  integer, parameter :: BEHAVIOR_HARD = 1       !< no penetration, no tension, exactly

  !> A surface: element faces, or a list of nodes (slave side only).
  type :: surface_type
    character(:), allocatable :: name
    logical :: is_node_based = .false.
    integer, allocatable :: element(:)          !< (n_facets) element of each facet; empty if node based
    integer, allocatable :: face(:)             !< (n_facets) its face number 1 to 6
    integer, allocatable :: nodes(:)            !< its nodes, each once, ascending (both kinds)
  end type surface_type

  !> What happens between two surfaces that touch.
  type :: interaction_type
    character(:), allocatable :: name
    integer :: behavior = BEHAVIOR_HARD
    real(DP) :: friction = 0                    !< mu [-]; 0 is frictionless
  end type interaction_type

  !> Two surfaces that may touch.
  type :: contact_pair_type
    integer :: slave = 0                        !< index of the slave surface
    integer :: master = 0                       !< index of the master surface
    integer :: interaction = 0                  !< index of the interaction
    logical :: is_small_sliding = .false.       !< weights and normal kept from the start of the step
    logical :: has_adjust = .false.             !< ADJUST given: slave nodes within the distance are moved onto the master
    real(DP) :: adjust = 0                      !< that distance [length]
    character(:), allocatable :: name           !< 'slave / master', for messages
  end type contact_pair_type

end module amontons_surfaces
