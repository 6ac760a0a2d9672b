!> Material and spring parameters, property tables and hardening curves.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_materials
  use amontons_kinds, only: DP
  use amontons_user_routines, only: user_library_type
  implicit none
  private
  public :: material_type, spring_type, property_table_type, hardening_curve_type, orientation_type, evaluate_table, &
    evaluate_curves, &
    evaluate_curve, find_interval
  public :: law_name, LAW_HENCKY, LAW_SAINT_VENANT, MAX_LAW_NAME_LENGTH
  public :: ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC, ELASTIC_HYPER, ELASTIC_FOAM, &
    ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY, ELASTIC_CIARLET, ELASTIC_FIBRES, ELASTIC_TRACTION, is_linear_elastic, &
    is_hyperelastic, &
    is_one_sided, is_law_of_invariants, is_isotropic_elastic, has_no_energy
  public :: HYPER_POLYNOMIAL, HYPER_OGDEN, HYPER_ARRUDA_BOYCE, MAX_HYPER_ORDER
  public :: YIELD_ROUND, YIELD_RATIO, YIELD_MOHR_COULOMB, CONE_COMPRESSION, CONE_TENSION, CONE_SHEAR, CONE_COHESION
  public :: INELASTIC_NONE, INELASTIC_CRYSTAL, INELASTIC_CRYSTAL_CREEP, INELASTIC_LINEAR
  public :: CREEP_NONE, CREEP_TIME_HARDENING, CREEP_STRAIN_HARDENING, CREEP_USER
  public :: damage_type, SOFTENING_LINEAR, SOFTENING_EXPONENTIAL, SOFTENING_TABULAR, MIX_NONE, MIX_POWER_LAW, MIX_BENZEGGAGH_KENANE
  public :: RATE_NONE, RATE_POWER, RATE_RATIO, RATE_CURVES, rate_curves_type
  public :: MAX_CONSTANTS, MAX_HISTORY, HISTORY_PEEQ, HISTORY_CEEQ, HISTORY_INELASTIC, HISTORY_BACK, HISTORY_STRETCH
  public :: verdict_place, user_field_place
  public :: USER_STRESS, USER_STRAIN, USER_GRADIENT, USER_ENERGY, USER_ROTATION, USER_STATE, USER_FIELD, USER_VERDICT
  public :: SYSTEM_RECTANGULAR, SYSTEM_CYLINDRICAL

  integer, parameter :: MAX_LAW_NAME_LENGTH = 64               !< longest name of a law
  integer, parameter :: LAW_HENCKY = 1          !< Kirchhoff stress linear in the logarithmic strain (abaqus dialect)
  integer, parameter :: LAW_SAINT_VENANT = 2    !< 2nd Piola-Kirchhoff stress linear in Green's strain (calculix dialect)

  integer, parameter :: ELASTIC_ISOTROPIC = 1   !< E, nu
  integer, parameter :: ELASTIC_ORTHOTROPIC = 2 !< D1111 D1122 D2222 D1133 D2233 D3333 D1212 D1313 D2323
  integer, parameter :: ELASTIC_ANISOTROPIC = 3 !< the 21 D of the upper triangle, 11 22 33 12 13 23, column by column
  integer, parameter :: ELASTIC_HYPER = 4       !< strain energy of the isochoric invariants or stretches
  integer, parameter :: ELASTIC_FOAM = 5        !< strain energy of a compressible foam
  integer, parameter :: ELASTIC_TENSION_ONLY = 6       !< E, largest compressive stress
  integer, parameter :: ELASTIC_COMPRESSION_ONLY = 7   !< E, largest tensile stress
  integer, parameter :: ELASTIC_CIARLET = 8     !< E, nu
  integer, parameter :: ELASTIC_FIBRES = 9      !< C1, D1, then of each fibre two components of its direction, k1, k2

  integer, parameter :: ELASTIC_TRACTION = 10   !< of cohesive elements: three stiffnesses, normal, first and second shear

  integer, parameter :: HYPER_POLYNOMIAL = 1    !< C_ij, i + j = 1 to N, as 10 01 20 11 02 30 ..., then D_1 to D_N
  integer, parameter :: HYPER_OGDEN = 2         !< mu_1 alpha_1 ... mu_N alpha_N, then D_1 to D_N; foam: nu_i for D_i
  integer, parameter :: HYPER_ARRUDA_BOYCE = 3  !< mu, lambda_m, D
  integer, parameter :: MAX_HYPER_ORDER = 6
  integer, parameter :: MAX_CONSTANTS = 33      !< most constants of an elastic law: polynomial of order 6

  integer, parameter :: YIELD_ROUND = 1         !< von Mises's cylinder, or a round cone of Drucker and Prager
  integer, parameter :: YIELD_RATIO = 2         !< a cone of Drucker and Prager with K below 1
  integer, parameter :: YIELD_MOHR_COULOMB = 3  !< Mohr and Coulomb's pyramid
  integer, parameter :: CONE_COMPRESSION = 1, CONE_TENSION = 2, CONE_SHEAR = 3   !< test that gave the hardening curve of a cone
  integer, parameter :: CONE_COHESION = 4       !< the curve gives the cohesion of Mohr and Coulomb

  integer, parameter :: INELASTIC_NONE = 0
  integer, parameter :: INELASTIC_CRYSTAL = 1   !< K, n, c, d, phi, delta, r0, Q, b of octahedral slip, then of cubic slip
  integer, parameter :: INELASTIC_CRYSTAL_CREEP = 2  !< K, n of octahedral slip, then of cubic slip
  integer, parameter :: INELASTIC_LINEAR = 3    !< yield stress, isotropic and kinematic modulus, A, n, m of the overstress

  integer, parameter :: CREEP_NONE = 0
  integer, parameter :: CREEP_TIME_HARDENING = 1     !< rate = A q^n t^m
  integer, parameter :: CREEP_STRAIN_HARDENING = 2   !< rate = (A q^n ((m + 1) e)^m)^(1/(m + 1))
  integer, parameter :: CREEP_USER = 3               !< the increment by the routine CREEP

  integer, parameter :: RATE_NONE = 0           !< the yield stress does not depend on the rate of plastic strain
  integer, parameter :: RATE_POWER = 1          !< rate = D (ratio - 1)^n, the ratio of the yield stress to the static one
  integer, parameter :: RATE_RATIO = 2          !< a table of the ratio over the rate
  integer, parameter :: RATE_CURVES = 3         !< hardening curves of several rates

  integer, parameter :: SOFTENING_LINEAR = 1, SOFTENING_EXPONENTIAL = 2, SOFTENING_TABULAR = 3
  integer, parameter :: MIX_NONE = 1            !< one fracture energy for all modes
  integer, parameter :: MIX_POWER_LAW = 2       !< sum of (G_i/G_ic)^alpha is 1
  integer, parameter :: MIX_BENZEGGAGH_KENANE = 3   !< G = Gn + (Gs - Gn) (shear part of the energy)^eta

  ! The history variables of an integration point: its committed state, without position.
  integer, parameter :: HISTORY_PEEQ = 1        !< equivalent plastic strain [-]
  integer, parameter :: HISTORY_CEEQ = 2        !< equivalent creep strain [-]
  integer, parameter :: HISTORY_INELASTIC = 3   !< 3 to 8: plastic and creep strain, logarithmic, reference configuration [-]
  integer, parameter :: HISTORY_BACK = 9        !< 9 to 14: back stress in the reference configuration [stress]
  integer, parameter :: HISTORY_STRETCH = 15    !< mean inelastic strain of the initial state, of Simo's law [-]
  integer, parameter :: MAX_HISTORY = 15
  ! Further variables of materials with USDFLD only.
  integer, parameter :: USER_FIELD = MAX_HISTORY + 1       !< the field variable that the tables are over
  integer, parameter :: USER_VERDICT = USER_FIELD + 1      !< 1: the result of USDFLD is valid
  ! Further variables of user materials only; components 11 22 33 12 13 23, in the local axes of the orientation if given.
  integer, parameter :: USER_STRESS = MAX_HISTORY + 1      !< six: Cauchy stress [stress]
  integer, parameter :: USER_STRAIN = USER_STRESS + 6      !< six: STRAN, engineering shears [-]
  integer, parameter :: USER_GRADIENT = USER_STRAIN + 6    !< nine: displacement gradient, column by column [-]
  integer, parameter :: USER_ENERGY = USER_GRADIENT + 9    !< three: SSE, SPD, SCD [stress]
  integer, parameter :: USER_ROTATION = USER_ENERGY + 3    !< nine: rotation of the local axes since the start, less 1 [-]
  integer, parameter :: USER_STATE = USER_ROTATION + 9     !< from here on: STATEV, of USDFLD, too
  ! Behind them, if USDFLD is called before UMAT: its verdict, the field variables and the STATEV that it gave.

  integer, parameter :: SYSTEM_RECTANGULAR = 1, SYSTEM_CYLINDRICAL = 2

  !> Values over the temperature or a field variable, interpolated linearly, constant outside.
  type :: property_table_type
    real(DP), allocatable :: temperature(:)     !< (n) ascending, or values of the field variable [temperature]
    real(DP), allocatable :: value(:, :)        !< (n_values, n)
    integer :: variable = 0                     !< what it is over: 0 the temperature, k field variable k
  end type property_table_type

  !> Stress over the equivalent plastic strain at one temperature, interpolated linearly, constant outside.
  type :: hardening_curve_type
    real(DP) :: temperature = 0                 !< or value of the field variable [temperature]
    real(DP), allocatable :: strain(:)          !< (n) ascending, the first 0 [-]
    real(DP), allocatable :: stress(:)          !< (n) yield stress [stress]
    integer :: variable = 0                     !< what the curves of the material are over: 0 the temperature, k field variable k
  end type hardening_curve_type

  !> Hardening curves at one rate of the equivalent plastic strain.
  type :: rate_curves_type
    real(DP) :: rate = 0                        !< [1/time]
    type(hardening_curve_type), allocatable :: curves(:)   !< (temperatures) ascending
  end type rate_curves_type

  !> The law of the springs of one card.
  type :: spring_type
    type(property_table_type) :: constant                 !< over the temperature; unallocated: force, or the gap [force/length]
    type(hardening_curve_type), allocatable :: force(:)    !< (temperatures) force (stress) over the elongation (strain)
    logical :: is_gap = .false.
    logical :: is_distance_limit = .false.
    integer :: length_node = 0                   !< of a rope: the node that defines its length; it exerts no force
    real(DP) :: clearance = 0                    !< of a gap at the start, or slack of a rope [length]
    real(DP) :: stiffness = 0                    !< of a closed gap, of a taut rope [force/length]
    real(DP) :: open_force = 0                         !< tension limit of a wide open gap [force]
    real(DP) :: axes(3, 2) = 0                   !< directions at its nodes, in place of 1 to 3; zero: not given
  end type spring_type

  !> A local system of axes of a section.
  type :: orientation_type
    character(:), allocatable :: name
    integer :: system = SYSTEM_RECTANGULAR
    real(DP) :: a(3) = [1.0_DP, 0.0_DP, 0.0_DP]   !< rectangular: on local x; cylindrical: on the axis [length]
    real(DP) :: b(3) = [0.0_DP, 1.0_DP, 0.0_DP]   !< rectangular: in local xy; cylindrical: on the axis too [length]
    integer :: rotation_axis = 0                    !< further rotation about this local axis; 0: none
    real(DP) :: rotation_angle = 0                  !< [rad]
    logical :: is_projected = .false.               !< of shells: the axis behind normal_axis is projected on the shell
    integer :: normal_axis = 1                      !< the local axis nearest to the normal
    real(DP) :: layer_angle = 0                     !< further rotation about the normal [rad]
  end type orientation_type

  !> Damage of a cohesive law.
  type :: damage_type
    logical :: is_of_strain = .false.            !< the limits are strains; else stresses
    logical :: is_quadratic = .false.            !< root of the sum of squares; else the largest ratio
    type(property_table_type) :: initiation      !< limits: normal, first and second shear [stress] or [-]
    logical :: has_evolution = .false.           !< damage grows; else the criterion is found alone
    logical :: is_by_energy = .false.            !< evolution by fracture energies; else by a separation
    integer :: softening = SOFTENING_LINEAR      !< SOFTENING_...
    integer :: mode_mix = MIX_NONE               !< MIX_...
    real(DP) :: mix_exponent = 0                 !< alpha or eta [-]
    type(property_table_type) :: evolution       !< G, or Gn, Gs, Gt [energy/area]; or separation from the start of damage to its
                                                 !! end [length] and alpha of exponential softening [-]
    real(DP), allocatable :: table(:, :)         !< (2, rows) of tabular softening: separation since the start [length], damage [-]
    real(DP) :: viscosity = 0                    !< of DAMAGE STABILIZATION [time]
  end type damage_type

  !> One material. Under small displacements every linear elastic law is Hooke's law.
  type :: material_type
    character(:), allocatable :: name
    integer :: law = LAW_HENCKY                 !< law at finite strain, chosen by the dialect
    integer :: table_variable = 0               !< what its tables are over: 0 the temperature, k field variable k
    logical :: is_lamina = .false.               !< LAMINA: of shells only
    logical :: is_linear_isotropic = .true.                !< only E and nu: no table, temperature, axes or history
    logical :: has_elastic = .false.
    integer :: elastic_kind = ELASTIC_ISOTROPIC
    real(DP) :: youngs_modulus = 0              !< E, isotropic, at the first temperature [stress]
    real(DP) :: poissons_ratio = 0              !< nu, isotropic, at the first temperature [-]
    type(property_table_type) :: elastic                 !< constants by ELASTIC_...; optional with E and nu only
    integer :: cutoff_sign = 0                 !< 1: NO COMPRESSION, -1: NO TENSION of its linear elasticity; 0: both are carried
    logical :: is_corotational = .false.        !< linear in U - 1 in place of the strain of the law
    integer :: hyper_kind = 0                   !< HYPER_...
    integer :: hyper_order = 0                  !< N
    integer :: n_history = 0                    !< history variables used
    logical :: has_density = .false.
    real(DP) :: density = 0                     !< rho, at the first temperature [mass/volume]
    type(property_table_type) :: density_table               !< rho over the temperature; unallocated: constant [mass/volume]
    type(property_table_type) :: expansion               !< 1, 3 or 6 coefficients, secant from expansion_zero [1/temperature]
    real(DP) :: expansion_reference = 0              !< ZERO [temperature]
    type(hardening_curve_type), allocatable :: isotropic_hardening(:)   !< size of the yield surface, ascending temperatures
    type(hardening_curve_type), allocatable :: kinematic_hardening(:)   !< yield stress of monotonic tension of kinematic hardening
    integer :: rate_law = RATE_NONE             !< RATE_... of isotropic_hardening, which holds at the lowest rate
    type(property_table_type) :: rate_power     !< D [1/time], n
    type(hardening_curve_type), allocatable :: rate_ratio(:)   !< ratio of the yield stress to the static one (stress) over the
                                                !! rate (strain) [-]
    type(rate_curves_type), allocatable :: rate_curves(:)      !< (rates) ascending
    integer :: yield_surface = YIELD_ROUND      !< YIELD_...
    type(property_table_type) :: cone           !< friction and dilation angle [rad], then K, or e and eps; of a cap: friction
                                                !! angle, cohesion d, R, initial volumetric plastic strain, alpha; unallocated:
                                                !! von Mises
    logical :: has_cap = .false.                !< the cone is that of a cap
    logical :: has_cone_hardening = .false., has_plastic = .false.   !< which cards gave isotropic_hardening
    integer :: cone_hardening = CONE_COMPRESSION   !< the test of isotropic_hardening
    logical :: is_unsymmetric = .false.         !< its tangent may be: UMAT, a cone with flow that is not associated, a
                                                !! cutoff
    logical :: has_deformation_plasticity = .false.
    type(property_table_type) :: deformation_plasticity             !< E, nu, yield stress, n, alpha of the Ramberg-Osgood law
    integer :: creep_law = CREEP_NONE
    type(property_table_type) :: creep                   !< A, n, m; unallocated: CREEP_USER
    integer :: inelastic_law = INELASTIC_NONE   !< flow of an anisotropic elasticity by INELASTIC_...
    type(property_table_type) :: inelastic      !< its constants
    real(DP), allocatable :: prony(:, :)        !< (3, terms) g, k [-] and tau [time] of viscoelasticity, whose elasticity is the
                                                !! instantaneous one; unallocated: none
    integer :: inner_first = 0, n_inner = 0     !< history variables of a law beyond MAX_HISTORY: the first, their number
    type(damage_type), allocatable :: damage     !< of a cohesive law
    logical :: is_user = .false.                !< UMAT gives the stress
    logical :: is_user_field = .false.          !< USDFLD gives the field variables at its points
    logical :: is_called_in_3d = .false.             !< UMAT is called with three-dimensional arguments for all elements
    logical :: is_shell_law = .false.           !< UMAT is called for the plane stress of shells
    real(DP) :: transverse_shear(2, 2) = 0      !< of a shell law: stresses 13, 23 over their strains, in its axes [stress]
    character(:), allocatable :: library        !< file of its routine; unallocated: that of the job
    real(DP), allocatable :: props(:)           !< its PROPS
    integer :: n_statev = 0                     !< number of the STATEV of UMAT or USDFLD
    integer :: deletion = 0                     !< number of the STATEV of UMAT that deletes a point where it becomes 0; 0: none
    integer :: n_fields = 0                     !< number of the field variables that UMAT gets
    real(DP) :: at_rest(6, 6) = 0               !< its DDSDDE in the undeformed state, computed before the start [stress]
    type(user_library_type) :: routines             !< the opened library; opened before the start
  end type material_type

contains

  !> The history variable that is 1 where the result of USDFLD is valid.
  pure integer function verdict_place(material)
    type(material_type), intent(in) :: material
    verdict_place = USER_VERDICT
    if (material%is_user) verdict_place = USER_STATE + material%n_statev
  end function verdict_place


  !> The history variable that is a field variable by USDFLD; without UMAT that which the tables are over.
  pure integer function user_field_place(material, variable)
    type(material_type), intent(in) :: material
    integer, intent(in) :: variable              !< its number
    user_field_place = USER_FIELD
    if (material%is_user) user_field_place = verdict_place(material) + variable
  end function user_field_place


  !> The values of a table at a temperature.
  pure subroutine evaluate_table(table, temperature, values)
    type(property_table_type), intent(in) :: table
    real(DP), intent(in) :: temperature         !< [temperature]
    real(DP), intent(out) :: values(:)          !< (n_values)
    integer :: i
    real(DP) :: s
    call find_interval(table%temperature, temperature, i, s)
    values = table%value(:size(values), i)
    if (s > 0) values = values + s * (table%value(:size(values), i + 1) - values)
  end subroutine evaluate_table


  !> Stress and slope of a family of curves at a temperature and an equivalent plastic strain.
  pure subroutine evaluate_curves(curves, temperature, strain, stress, slope)
    type(hardening_curve_type), intent(in) :: curves(:)   !< ascending temperatures
    real(DP), intent(in) :: temperature         !< [temperature]
    real(DP), intent(in) :: strain              !< [-]
    real(DP), intent(out) :: stress             !< [stress]
    real(DP), intent(out) :: slope              !< d stress / d strain [stress]
    integer :: i
    real(DP) :: s, next_stress, next_slope
    i = 1
    s = 0
    if (size(curves) > 1) call find_interval(curves%temperature, temperature, i, s)
    call evaluate_curve(curves(i), strain, stress, slope)
    if (.not. s > 0) return
    call evaluate_curve(curves(i + 1), strain, next_stress, next_slope)
    stress = stress + s * (next_stress - stress)
    slope = slope + s * (next_slope - slope)
  end subroutine evaluate_curves


  !> Stress and slope of one curve.
  pure subroutine evaluate_curve(curve, strain, stress, slope)
    type(hardening_curve_type), intent(in) :: curve
    real(DP), intent(in) :: strain                 !< [-]
    real(DP), intent(out) :: stress, slope         !< [stress]
    integer :: i
    real(DP) :: s
    call find_interval(curve%strain, strain, i, s)
    stress = curve%stress(i)
    slope = 0
    if (i == size(curve%strain)) return
    slope = (curve%stress(i + 1) - stress) / (curve%strain(i + 1) - curve%strain(i))
    stress = stress + slope * max(strain - curve%strain(i), 0.0_DP)
  end subroutine evaluate_curve


  !> The interval of an ascending list that contains a value, and the fraction of it: clamped at the ends of the list.
  pure subroutine find_interval(list, x, i, s)
    real(DP), intent(in) :: list(:)             !< (n) ascending
    real(DP), intent(in) :: x
    integer, intent(out) :: i                   !< 1 to size(list)
    real(DP), intent(out) :: s                  !< 0 to 1
    integer :: low, high, middle
    s = 0
    low = 1
    high = size(list)
    if (x >= list(high)) low = high
    do while (high - low > 1)
      middle = (low + high) / 2
      if (list(middle) <= x) then
        low = middle
      else
        high = middle
      end if
    end do
    i = low
    if (low < high .and. x > list(low)) s = (x - list(low)) / (list(high) - list(low))
  end subroutine find_interval


  !> Whether the elastic stress is linear in the strain of its law.
  pure logical function is_linear_elastic(material)
    type(material_type), intent(in) :: material
    is_linear_elastic = any(material%elastic_kind == [ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC])
  end function is_linear_elastic


  !> Whether a material is elastic by E and nu alone, constant or over a temperature.
  pure logical function is_isotropic_elastic(material) result(is_true)
    type(material_type), intent(in) :: material
    is_true = material%elastic_kind == ELASTIC_ISOTROPIC .and. material%creep_law == CREEP_NONE .and. .not. (material%is_user .or. &
      material%has_deformation_plasticity .or. allocated(material%isotropic_hardening) .or. &
      allocated(material%kinematic_hardening) .or. allocated(material%prony))
  end function is_isotropic_elastic


  !> Whether a material is rubber or foam.
  pure logical function is_hyperelastic(material)
    type(material_type), intent(in) :: material
    is_hyperelastic = material%elastic_kind == ELASTIC_HYPER .or. material%elastic_kind == ELASTIC_FOAM
  end function is_hyperelastic


  !> Whether a material carries only tension or only compression.
  pure logical function is_one_sided(material)
    type(material_type), intent(in) :: material
    is_one_sided = material%elastic_kind == ELASTIC_TENSION_ONLY .or. material%elastic_kind == ELASTIC_COMPRESSION_ONLY
  end function is_one_sided


  !> Whether the stress of a material is not the derivative of an energy that it keeps: viscoelasticity, NO COMPRESSION, NO TENSION.
  elemental logical function has_no_energy(material)
    type(material_type), intent(in) :: material
    has_no_energy = allocated(material%prony) .or. material%cutoff_sign /= 0
  end function has_no_energy


  !> Whether the elastic energy is one of the invariants of the right Cauchy-Green tensor.
  pure logical function is_law_of_invariants(material)
    type(material_type), intent(in) :: material
    is_law_of_invariants = material%elastic_kind == ELASTIC_CIARLET .or. material%elastic_kind == ELASTIC_FIBRES
  end function is_law_of_invariants


  !> The name of the law of a material.
  pure function law_name(material) result(words)
    type(material_type), intent(in) :: material
    character(MAX_LAW_NAME_LENGTH) :: words
    if (material%is_user) then
      words = 'UMAT'
      return
    else if (material%has_deformation_plasticity) then
      words = 'Ramberg-Osgood'
      return
    end if
    words = merge('Hencky      ', 'Saint-Venant', material%law == LAW_HENCKY)
    select case (material%elastic_kind)
    case (ELASTIC_ORTHOTROPIC)
      words = trim(words) // ', orthotropic'
    case (ELASTIC_ANISOTROPIC)
      words = trim(words) // ', anisotropic'
    case (ELASTIC_TENSION_ONLY)
      words = 'tension only'
    case (ELASTIC_COMPRESSION_ONLY)
      words = 'compression only'
    case (ELASTIC_CIARLET)
      words = 'Ciarlet'
    case (ELASTIC_FIBRES)
      words = 'rubber with fibres'
    case (ELASTIC_FOAM)
      words = 'hyperfoam'
    case (ELASTIC_HYPER)
      words = 'hyperelastic, polynomial'
      if (material%hyper_kind == HYPER_OGDEN) words = 'hyperelastic, Ogden'
      if (material%hyper_kind == HYPER_ARRUDA_BOYCE) words = 'hyperelastic, Arruda-Boyce'
    end select
    if (allocated(material%isotropic_hardening)) then
      if (.not. allocated(material%cone%value)) then
        words = trim(words) // ', plastic'
      else if (material%yield_surface == YIELD_MOHR_COULOMB) then
        words = trim(words) // ', Mohr-Coulomb'
      else if (material%has_cap) then
        words = trim(words) // ', Drucker-Prager cap'
      else
        words = trim(words) // ', Drucker-Prager'
      end if
    end if
    if (material%rate_law /= RATE_NONE) words = trim(words) // ', rate-dependent'
    if (allocated(material%kinematic_hardening)) words = trim(words) // ', kinematic hardening'
    if (material%is_corotational) words = trim(words) // ', corotational'
    if (material%cutoff_sign > 0) words = trim(words) // ', no compression'
    if (material%cutoff_sign < 0) words = trim(words) // ', no tension'
    if (allocated(material%prony)) words = trim(words) // ', viscoelastic'
    if (material%creep_law /= CREEP_NONE) words = trim(words) // ', creep'
    if (material%inelastic_law == INELASTIC_LINEAR) words = trim(words) // ', viscoplastic'
    if (material%inelastic_law == INELASTIC_CRYSTAL) words = trim(words) // ', crystal plasticity'
    if (material%inelastic_law == INELASTIC_CRYSTAL_CREEP) words = trim(words) // ', crystal creep'
  end function law_name

end module amontons_materials
