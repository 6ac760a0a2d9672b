!> Surfaces: named faces or nodes, how two of them interact, and which pairs may touch.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_surfaces
  use amontons_kinds, only: DP
  use amontons_analytic_profiles, only: analytic_profile_type
  implicit none
  private
  public :: surface_type, interaction_type, contact_pair_type, is_compliant, pair_interactions
  public :: BEHAVIOR_HARD, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED, BEHAVIOR_USER, ROUGH_FRICTION, &
    NO_SHEAR_LIMIT

  integer, parameter :: BEHAVIOR_HARD = 1          !< no penetration, no tension, exactly
  integer, parameter :: BEHAVIOR_LINEAR = 2        !< pressure rises with the penetration: stiffness, tension, reach
  integer, parameter :: BEHAVIOR_EXPONENTIAL = 3   !< pressure is there before the surfaces meet: reach, pressure
  integer, parameter :: BEHAVIOR_TABULAR = 4       !< pressure by a table: table_pressure, table_overclosure
  integer, parameter :: BEHAVIOR_TIED = 5          !< a spring both ways: stiffness
  integer, parameter :: BEHAVIOR_USER = 6          !< all of it by UINTER
  real(DP), parameter :: ROUGH_FRICTION = 1.0e30_DP   !< mu of surfaces that never slip [-]
  real(DP), parameter :: NO_SHEAR_LIMIT = 1.0e200_DP  !< without TAUMAX [stress]

  real(DP), parameter :: MAX_ACTIVE_GAP = 1.0e-8_DP         !< LINEAR of a mortar pair acts up to this gap over the root of the
                                                            !! area [-]

  !> A surface: element faces, a list of nodes (slave side only), or a profile (master side only).
  type :: surface_type
    character(:), allocatable :: name
    logical :: is_node_based = .false.
    integer, allocatable :: element(:)          !< (n_facets) element of each facet; empty if node based
    integer, allocatable :: face(:)             !< (n_facets) its face number 1 to 6
    integer, allocatable :: nodes(:)            !< its nodes, each once, ascending; of a profile the carriers
    type(analytic_profile_type), allocatable :: profile  !< analytic and rigid
  end type surface_type

  !> What happens between two surfaces that touch. The laws are those of `compliance`.
  type :: interaction_type
    character(:), allocatable :: name
    integer :: behavior = BEHAVIOR_HARD         !< BEHAVIOR_...
    real(DP) :: stiffness = 0                   !< K [stress/length]
    real(DP) :: tension_limit = 0                     !< LINEAR: of the law when wide open, sigma_inf [stress]
    real(DP) :: cutoff_clearance = 0                       !< c0: EXPONENTIAL [length]; LINEAR, TABULAR over the root of the area
                                                           !! [-]
    real(DP) :: clearance = 0                   !< TABULAR, dialect abaqus: acts up to this gap whatever the area [length]
    real(DP) :: pressure = 0                    !< EXPONENTIAL: p0, at gap zero [stress]
    real(DP), allocatable :: table_pressure(:)     !< TABULAR [stress]
    real(DP), allocatable :: table_overclosure(:)  !< TABULAR: ascending [length]
    real(DP) :: friction = 0                    !< mu [-]; 0 is frictionless
    real(DP) :: stick_slope = 0                 !< lambda of compliant laws: shear over elastic slip [stress/length]
    real(DP) :: shear_limit = NO_SHEAR_LIMIT    !< TAUMAX [stress]
    logical :: is_user_friction = .false.       !< friction is by FRIC; then mu is 0 and there is no TAUMAX
    real(DP), allocatable :: props(:)           !< PROPS of FRIC or UINTER
    integer :: n_statev = 0                     !< number of its STATEV at each slave node
  end type interaction_type

  !> Two surfaces that may touch.
  type :: contact_pair_type
    integer :: slave = 0                        !< index of the slave surface
    integer :: master = 0                       !< index of the master surface
    integer :: interaction = 0                  !< index of the interaction
    logical :: is_small_sliding = .false.       !< weights and normal kept from the start of the step
    logical :: is_mortar = .false.              !< surface to surface: rows from integrals over the slave faces
    logical :: has_point_contact = .false.           !< of a mortar pair: springs at points of the slave faces, as CalculiX has them
    logical :: has_adjust = .false.             !< ADJUST given: slave nodes within the distance are moved onto the master
    real(DP) :: adjust = 0                      !< that distance [length]
    integer, allocatable :: adjust_nodes(:)     !< or the nodes that are moved, wherever they are
    logical :: has_clearance = .false.          !< CLEARANCE given: the gap at the start is not that of the mesh
    real(DP) :: clearance = 0                   !< but this [length]
    character(:), allocatable :: name           !< 'slave / master', for messages
  end type contact_pair_type

contains

  !> Whether a slave node keeps its unknowns, its force being a law of its gap and slip. HARD is exact: it does not.
  elemental logical function is_compliant(interaction)
    type(interaction_type), intent(in) :: interaction
    is_compliant = interaction%behavior /= BEHAVIOR_HARD
  end function is_compliant


  !> The laws of all pairs. Over the faces of a mortar pair LINEAR is what it says: K h in contact, nothing outside.
  pure function pair_interactions(pairs, interactions) result(laws)
    type(contact_pair_type), intent(in) :: pairs(:)
    type(interaction_type), intent(in) :: interactions(:)
    type(interaction_type) :: laws(size(pairs))
    integer :: p
    do p = 1, size(pairs)
      laws(p) = interactions(pairs(p)%interaction)
      if (.not. pairs(p)%is_mortar .or. laws(p)%behavior /= BEHAVIOR_LINEAR) cycle
      laws(p)%tension_limit = 0.0_DP
      laws(p)%cutoff_clearance = MAX_ACTIVE_GAP
    end do
  end function pair_interactions

end module amontons_surfaces
