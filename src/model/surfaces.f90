!> Surfaces, surface interactions and contact pairs.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_surfaces
  use amontons_kinds, only: DP
  use amontons_analytic_profiles, only: analytic_profile_type
  implicit none
  private
  public :: surface_type, interaction_type, contact_pair_type, general_contact_type, shell_property_type, &
    contact_initialization_type, is_compliant, &
    is_self_contact, swap_advice, pair_interactions
  public :: BEHAVIOR_HARD, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED, BEHAVIOR_USER, ROUGH_FRICTION, &
    NO_SHEAR_LIMIT

  integer, parameter :: BEHAVIOR_HARD = 1          !< no penetration and no tension, exactly
  integer, parameter :: BEHAVIOR_LINEAR = 2        !< linear in the penetration: stiffness, tension_limit, cutoff_clearance
  integer, parameter :: BEHAVIOR_EXPONENTIAL = 3   !< pressure from a positive gap on: cutoff_clearance, pressure
  integer, parameter :: BEHAVIOR_TABULAR = 4       !< pressure by a table: table_pressure, table_overclosure
  integer, parameter :: BEHAVIOR_TIED = 5          !< a spring in tension and compression: stiffness
  integer, parameter :: BEHAVIOR_USER = 6          !< all of it by UINTER
  real(DP), parameter :: ROUGH_FRICTION = 1.0e30_DP   !< mu of surfaces that never slip [-]
  real(DP), parameter :: NO_SHEAR_LIMIT = 1.0e200_DP  !< without TAUMAX [stress]

  real(DP), parameter :: MAX_ACTIVE_GAP = 1.0e-8_DP         !< LINEAR of a mortar pair acts up to this gap over the root of the
                                                            !! area [-]

  !> A surface: element faces, a list of nodes (slave side only), or an analytic profile (master side only).
  type :: surface_type
    character(:), allocatable :: name
    logical :: is_node_based = .false.
    integer, allocatable :: element(:)          !< (n_facets) element of each facet; empty if node based
    integer, allocatable :: face(:)             !< (n_facets) its face number 1 to 6
    integer, allocatable :: nodes(:)            !< its nodes, each once, ascending; of a profile the carrier nodes
    real(DP), allocatable :: thickness(:)       !< (n_facets) general contact: of the body below each facet [length]
    type(analytic_profile_type), allocatable :: profile  !< analytic rigid surface
  end type surface_type

  !> Surface interaction: normal and friction laws. The laws are evaluated in `pressure_overclosure`.
  type :: interaction_type
    character(:), allocatable :: name
    integer :: behavior = BEHAVIOR_HARD         !< BEHAVIOR_...
    real(DP) :: stiffness = 0                   !< K [stress/length]
    real(DP) :: tension_limit = 0                     !< LINEAR: tension of the law at large gaps, sigma_inf [stress]
    real(DP) :: cutoff_clearance = 0                       !< c0: EXPONENTIAL [length]; LINEAR, TABULAR over the root of the area
                                                           !! [-]
    real(DP) :: clearance = 0                   !< TABULAR, dialect abaqus: active up to this gap whatever the area [length]
    real(DP) :: pressure = 0                    !< EXPONENTIAL: p0, at gap zero [stress]
    real(DP), allocatable :: table_pressure(:)     !< TABULAR [stress]
    real(DP), allocatable :: table_overclosure(:)  !< TABULAR: ascending [length]
    real(DP) :: friction = 0                    !< mu [-]; 0 is frictionless
    logical :: has_no_separation = .false.      !< HARD: a node that has touched stays on its master, in tension too
    logical :: is_penalty = .false.             !< LINEAR in place of exact contact, at dependent slave nodes
    real(DP) :: stick_slope = 0                 !< lambda of compliant laws: shear over elastic slip [stress/length]
    real(DP) :: shear_limit = NO_SHEAR_LIMIT    !< TAUMAX [stress]
    logical :: is_user_friction = .false.       !< friction by FRIC; then mu is 0 and TAUMAX has no effect
    real(DP), allocatable :: props(:)           !< PROPS of FRIC or UINTER
    integer :: n_statev = 0                     !< number of its STATEV at each slave node
  end type interaction_type

  !> A contact pair.
  type :: contact_pair_type
    integer :: slave = 0                        !< index of the slave surface
    integer :: master = 0                       !< index of the master surface
    integer :: interaction = 0                  !< index of the interaction
    logical :: is_small_sliding = .false.       !< weights and normal fixed from the start of the step
    logical :: is_mortar = .false.              !< surface to surface: rows from integrals over the slave faces
    logical :: has_point_contact = .false.           !< of a mortar pair: springs at integration points, as CalculiX
    logical :: has_adjust = .false.             !< ADJUST given: slave nodes within the distance are moved onto the master
    real(DP) :: adjust = 0                      !< that distance [length]
    real(DP) :: adjust_depth = huge(1.0_DP)     !< nodes deeper in the master stay where they are [length]
    integer, allocatable :: adjust_nodes(:)     !< or the nodes that are moved, wherever they are
    logical :: is_shrink_fit = .false.          !< of general contact: its initial overclosures go to zero over the first step
    logical :: has_clearance = .false.          !< CLEARANCE given: it replaces the initial gap of the mesh
    real(DP) :: clearance = 0                   !< the initial gap [length]
    character(:), allocatable :: name           !< 'slave / master', for messages
    logical :: is_general = .false.             !< found by general contact: its surfaces may be apart and turn away from each other
    real(DP) :: slave_depth = 0                 !< of it: the least thickness of the body below the slave faces [length]
    real(DP) :: slave_edge = 0                  !< of it: the longest edge of the slave faces [length]
    real(DP) :: height = 0                      !< of it: how far both surfaces stand before their faces, together [length]
  end type contact_pair_type

  !> SURFACE PROPERTY ASSIGNMENT: the thickness of shells in general contact, or their place.
  type :: shell_property_type
    integer :: surface = 0                      !< 0: the whole exterior
    logical :: is_place = .false.               !< the place, else the thickness
    logical :: is_original = .true.             !< that of the section
    real(DP) :: value = 0                       !< thickness [length]; position of the nodes over it, from the middle [-]
    real(DP) :: factor = 1                      !< of the thickness [-]
  end type shell_property_type

  !> CONTACT INITIALIZATION DATA: what becomes of overclosures at the start of general contact.
  type :: contact_initialization_type
    character(:), allocatable :: name
    logical :: is_fit = .false.                 !< they go to zero over the first step; else slave nodes are moved, without stress
    real(DP) :: above = 0                       !< so are those within this distance before the master [length]
    real(DP) :: below = huge(1.0_DP)            !< not those that are deeper in it [length]
  end type contact_initialization_type

  !> General contact: which faces of the exterior may touch, and by which interaction. The surface 0 is the whole exterior. Of
  !! several assignments that hold for two faces the last one counts.
  type :: general_contact_type
    integer, allocatable :: included(:, :)      !< (2, :) surfaces that may touch
    integer, allocatable :: excluded(:, :)      !< (2, :) surfaces that do not
    integer, allocatable :: assigned(:, :)      !< (3, :) two surfaces and the index of their interaction
    integer, allocatable :: initialized(:, :)   !< (3, :) two surfaces and the index of their initialization
    type(contact_initialization_type), allocatable :: initial(:)
    integer, allocatable :: roles(:, :)         !< (2, :) slave and master surface, where the deck says so
    type(shell_property_type), allocatable :: properties(:)   !< in the order of the deck
    logical :: is_mortar = .true.               !< its pairs are surface to surface
    real(DP) :: reach = -1                      !< REACH: how far bodies move in the job; negative: it is estimated [length]
    integer :: line = 0                         !< line of the card in the deck, for messages
  end type general_contact_type

contains

  !> Whether the force of a slave node is a function of its gap and slip (compliant law). Not for HARD, which is exact.
  elemental logical function is_compliant(interaction)
    type(interaction_type), intent(in) :: interaction
    is_compliant = interaction%behavior /= BEHAVIOR_HARD
  end function is_compliant


  !> Whether a surface touches itself.
  elemental logical function is_self_contact(pair)
    type(contact_pair_type), intent(in) :: pair
    is_self_contact = pair%slave == pair%master
  end function is_self_contact


  !> What exchanges slave and master of a pair, as the start of a sentence.
  pure function swap_advice(pair) result(text)
    type(contact_pair_type), intent(in) :: pair
    character(:), allocatable :: text
    text = 'Swap slave and master'
    if (pair%is_general) text = text // ' by *CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES'
  end function swap_advice


  !> The laws of all pairs. Over the faces of a mortar pair LINEAR is exactly linear: K h in contact, 0 outside.
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
