!> Constitutive update at an integration point: stress, tangent, energy and history of every material law.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Materials with E and nu only are evaluated by `elasticity`. All other laws are of one of two types, in terms of their strain:
!!
!! | sort | strain at finite strain |
!! |---|---|
!! | six strains to six stresses: linear elasticity with axes, kinematic hardening, deformation plasticity | ln(C)/2 |
!! | the same for linear elasticity and laws of invariants under LAW_SAINT_VENANT (calculix dialect) | Green's strain |
!! | the same for deformation plasticity under LAW_SAINT_VENANT | Almansi's strain, with Cauchy's stress |
!! | isotropic: linear elasticity, isotropic hardening, creep, rubber, foam | logarithms of the elastic stretches |
!! | plasticity and creep under LAW_SAINT_VENANT | the isochoric elastic b (Simo), as CalculiX |
!!
!! Initial stresses and given plastic strains are treated as initial inelastic strains. Theory: doc/theory/materials.md.
module amontons_material_point
  use amontons_kinds, only: DP
  use amontons_hyperelasticity, only: principal_response_type, evaluate_rubber, evaluate_foam
  use amontons_logarithmic_strain, only: log_strain_axes_type, find_log_strain_axes, push_forward_log_law, voigt_transformation, &
    tensor_log, tensor_exp, find_small_principal_strains, small_principal_tangent, principal_strains_type, left_cauchy_green, &
    find_principal_strains, tensor_from_principal, principal_tangent, expm1, log1p
  use amontons_materials, only: material_type, evaluate_table, LAW_SAINT_VENANT, ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, &
    ELASTIC_HYPER, ELASTIC_FOAM, ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY, ELASTIC_CIARLET, ELASTIC_FIBRES, is_hyperelastic, &
    is_one_sided, is_law_of_invariants, MAX_CONSTANTS, MAX_HISTORY, HISTORY_PEEQ, HISTORY_CEEQ, HISTORY_INELASTIC, HISTORY_BACK, &
    HISTORY_STRETCH, YIELD_ROUND, INELASTIC_NONE, INELASTIC_LINEAR, INELASTIC_CRYSTAL_CREEP, CREEP_NONE
  use amontons_invariant_elasticity, only: invariant_law_stress, invariant_law_at_rest
  use amontons_one_sided_elasticity, only: one_sided_stress
  use amontons_plasticity, only: return_mapping_type, anisotropic_return_type, map_radial_return, map_anisotropic_return, &
    is_inelastic, evaluate_ramberg_osgood, RETURN_OK
  use amontons_drucker_prager, only: map_cone_return
  use amontons_principal_stress_cutoff, only: cut_principal_stresses
  use amontons_corotational_elasticity, only: corotational_stress
  use amontons_crystal_plasticity, only: crystal_return_type, map_crystal_return, expand_creep_constants, N_CRYSTAL_CONSTANTS
  use amontons_linear_viscoplasticity, only: linear_return_type, map_linear_return, N_LINEAR_CONSTANTS
  use amontons_drucker_prager_cap, only: map_cap_return
  use amontons_viscoelasticity, only: viscoelastic_stress, relax_finite_stress
  use amontons_lode_angle_return, only: principal_return_type, map_principal_return
  use amontons_elasticity, only: hooke_stress, lame_constants, isotropic_tangent, isochoric_tangent, elasticity_matrix, deviator, &
    green_strain, green_strain_of_stretch, gradient_without_swelling, almansi_strain, check_gradient, STRESS_OK, STRESS_INVERTED, &
    STRESS_NOT_FINITE
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, determinant_minus_one, double_dot, invert, pack_voigt, push_forward, &
    unpack_voigt, von_mises
  use amontons_user_routines, only: creep_type
  use amontons_user_material, only: umat_point_type, evaluate_umat, transverse_energy
  implicit none
  private
  public :: material_point_type, update_material_point, cut_stress, elastic_strain_from_stress, evaluate_thermal_strain, SQRT_3_2

  !> Input and output of a material point. The committed history is read, never written.
  type :: material_point_type
    ! input
    real(DP) :: H(3, 3)                            !< finite strain: displacement gradient, F = 1 + H [-]
    real(DP) :: strain(6)                          !< small strain: input; finite: output, ln(b)/2 or Green's [-]
    real(DP) :: frame(3, 3)                        !< local axes of the material in its columns
    real(DP) :: temperature                        !< at the end of the increment [temperature]
    real(DP) :: initial_temperature                !< [temperature]
    real(DP) :: field = 0                          !< field variable that the tables of the material are over
    real(DP) :: initial_field = 0                  !< the same at the start
    real(DP) :: time                               !< at the end of the increment, for time-dependent laws [time]
    real(DP) :: time_increment                     !< of creep and viscoelasticity; 0 outside of VISCO steps [time]
    logical :: is_rate_at_end = .false.            !< time hardening: the rate is that at the end of the increment, not its mean
    real(DP) :: elapsed_time = 0                   !< length of the increment; 0: at rest [time]
    real(DP), allocatable :: inner_old(:)          !< committed history of a law beyond MAX_HISTORY
    real(DP) :: history_old(MAX_HISTORY)                  !< committed history
    type(umat_point_type), allocatable :: user     !< more of a user's material; not there: at rest
    type(creep_type), allocatable :: creep         !< what a routine CREEP gets
    logical :: is_tangent_wanted = .true.          !< if not, the tangent is not set
    logical :: is_output_wanted = .true.           !< if not, finite strain, energy and history need not be set
    logical :: is_cut_later = .false.              !< NO COMPRESSION, NO TENSION: the caller calls cut_stress
    logical :: is_flow_frozen = .false.            !< the law is elastic from its inelastic strains on
    ! output
    real(DP) :: stress(6)                          !< small strain: stress; finite: Kirchhoff stress [stress]
    real(DP) :: tangent(6, 6)                      !< its derivative, spatial at finite strain [stress]
    real(DP) :: energy                             !< elastic, per reference volume [stress]
    real(DP) :: history(MAX_HISTORY)               !< at the end of the increment
    real(DP), allocatable :: inner(:)              !< the same beyond MAX_HISTORY
  end type material_point_type

  !> The material constants at the temperature of a point.
  type :: moduli_type
    real(DP) :: lambda = 0                         !< Lame's first constant of isotropic materials [stress]
    real(DP) :: G = 0                              !< shear modulus of isotropic materials [stress]
    logical :: is_isotropic = .true.               !< lambda and G define C; else C is stored
    real(DP) :: C(6, 6) = 0                        !< elasticity in the global axes, engineering shears [stress]
    real(DP) :: thermal(6) = 0                     !< thermal strain, tensor components in the global axes [-]
    logical :: is_thermal_isotropic = .true.                !< the thermal strain is the same in all directions
    real(DP) :: constants(MAX_CONSTANTS) = 0       !< as the material has them
  end type moduli_type

  real(DP), parameter :: SQRT_2_3 = sqrt(2 / 3.0_DP), SQRT_3_2 = sqrt(1.5_DP)

contains

  !> Updates a point: stress, tangent, energy and history from strain, temperature and the committed history.
  pure subroutine update_material_point(material, is_nlgeom, point, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(material_point_type), intent(inout) :: point       !< input and output as its type states
    integer, intent(out) :: status                 !< STRESS_...; if not STRESS_OK the output is invalid
    call evaluate_law(material, is_nlgeom, point, status)
    if (status == STRESS_OK .and. .not. point%is_cut_later) call cut_stress(material, is_nlgeom, point)
  end subroutine update_material_point


  !> Cuts the stress of a point by NO COMPRESSION or NO TENSION. Its energy is then the work along a straight path of strains.
  pure subroutine cut_stress(material, is_nlgeom, point)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(material_point_type), intent(inout) :: point       !< stress, tangent and energy change
    real(DP) :: elastic(6), whole
    if (material%cutoff_sign == 0) return
    elastic = elastic_strain_from_stress(material, table_argument(material, point), point%frame, point%stress)
    whole = double_dot(point%stress, elastic)
    call cut_principal_stresses(material%cutoff_sign, is_nlgeom, point%is_tangent_wanted, point%stress, point%tangent)
    if (whole > 0) point%energy = point%energy * (double_dot(point%stress, elastic) / whole)
  end subroutine cut_stress


  !> The law without what cut_stress does.
  pure subroutine evaluate_law(material, is_nlgeom, point, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(material_point_type), intent(inout) :: point       !< input and output as its type states
    integer, intent(out) :: status                 !< STRESS_...
    type(moduli_type) :: moduli
    real(DP) :: thermal_stretch
    point%history = point%history_old
    if (allocated(point%inner_old)) point%inner = point%inner_old
    if (material%is_user) then
      call evaluate_user_law(material, is_nlgeom, point, status)
      return
    end if
    call evaluate_moduli(material, point, moduli)
    if (.not. is_nlgeom) then
      call evaluate_strain_law(material, moduli, point%strain, point, status)
      return
    end if
    status = check_gradient(point%H)
    if (status /= STRESS_OK) return
    if (is_hyperelastic(material)) then
      call evaluate_principal_law(material, moduli, point, status)
    else if (material%law == LAW_SAINT_VENANT .and. material%has_deformation_plasticity) then
      call evaluate_almansi_law(material, moduli, point, status)
    else if (material%law == LAW_SAINT_VENANT .and. (.not. is_inelastic(material) .or. (material%creep_law /= CREEP_NONE .and. &
      .not. (moduli%is_isotropic .or. allocated(material%isotropic_hardening))))) then
      call evaluate_green_law(material, moduli, point, status)
    else if (material%law == LAW_SAINT_VENANT .and. is_inelastic(material) .and. moduli%is_isotropic .and. .not. &
      allocated(material%cone%value)) then
      call evaluate_simo_law(material, moduli, point, status)
      thermal_stretch = 1 + determinant_minus_one(unpack_voigt(moduli%thermal))  ! the law is that of a volume which has swollen
      point%stress = thermal_stretch * point%stress
      point%tangent = thermal_stretch * point%tangent
      point%energy = thermal_stretch * point%energy
    else if (allocated(material%kinematic_hardening) .or. material%has_deformation_plasticity .or. allocated(material%prony) .or. &
      .not. (moduli%is_isotropic .and. moduli%is_thermal_isotropic)) then
      call evaluate_log_law(material, moduli, point, status)
    else
      call evaluate_principal_law(material, moduli, point, status)
    end if
  end subroutine evaluate_law


  !> User law. A point without state variables is undeformed: its tangent was computed before the start.
  pure subroutine evaluate_user_law(material, is_nlgeom, point, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(material_point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    type(moduli_type) :: moduli
    type(material_point_type) :: start
    real(DP) :: Q(6, 6)
    logical :: is_accepted
    status = STRESS_OK
    if (.not. allocated(point%user)) then
      point%stress = 0
      Q = voigt_transformation(point%frame)
      point%tangent = matmul(Q, matmul(material%at_rest, transpose(Q)))
      point%energy = 0
      return
    end if
    if (is_nlgeom) status = check_gradient(point%H)
    if (status /= STRESS_OK) return
    if (allocated(material%expansion%value)) then
      call set_thermal_strain(material, point, moduli)
      point%user%thermal(:, 2) = moduli%thermal
      start = point
      start%temperature = point%user%values%temp
      call set_thermal_strain(material, start, moduli)
      point%user%thermal(:, 1) = moduli%thermal
    end if
    point%user%values%dtemp = point%temperature - point%user%values%temp
    call evaluate_umat(material, is_nlgeom, point%H, point%strain, point%frame, point%user, point%stress, point%tangent, &
      is_accepted)
    if (.not. is_accepted) status = STRESS_NOT_FINITE
    point%energy = point%user%values%energies(1) + transverse_energy(material, point%user%values%stress)
    if (is_nlgeom) point%strain = evaluate_output_strain(material, point%H)
  end subroutine evaluate_user_law


  !> What the tables of a material are over, at a point: the temperature or a field variable.
  pure real(DP) function table_argument(material, point) result(argument)
    type(material_type), intent(in) :: material
    type(material_point_type), intent(in) :: point
    argument = point%temperature
    if (material%table_variable > 0) argument = point%field
  end function table_argument


  !> The constants at the temperature of a point, in the global axes.
  pure subroutine evaluate_moduli(material, point, moduli)
    type(material_type), intent(in) :: material
    type(material_point_type), intent(in) :: point
    type(moduli_type), intent(out) :: moduli
    type(principal_response_type) :: rest
    real(DP) :: Q(6, 6)
    associate (constants => moduli%constants)
      constants(:2) = [material%youngs_modulus, material%poissons_ratio]
      if (allocated(material%elastic%value)) call evaluate_table(material%elastic, table_argument(material, point), &
        constants(:size(material%elastic%value, 1)))
      if (material%has_deformation_plasticity) call evaluate_table(material%deformation_plasticity, &
        table_argument(material, point), constants(:5))
      select case (material%elastic_kind)
      case (ELASTIC_ISOTROPIC)
        call lame_constants(constants(1), constants(2), moduli%lambda, moduli%G)
      case (ELASTIC_HYPER, ELASTIC_FOAM)
        call evaluate_hyperelastic(material, constants, [0.0_DP, 0.0_DP, 0.0_DP], rest)
        moduli%G = 0.5_DP * rest%secant(1)
        moduli%lambda = rest%slope(1, 2)
      case (ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY)
        moduli%G = constants(1) / 4                ! at rest half of E carries, without a Poisson effect
      case (ELASTIC_CIARLET, ELASTIC_FIBRES)
        call invariant_law_at_rest(material%elastic_kind, constants, moduli%lambda, moduli%G)
      case default
        moduli%is_isotropic = .false.
        Q = voigt_transformation(point%frame)
        moduli%C = matmul(Q, matmul(elasticity_matrix(material%elastic_kind, constants), transpose(Q)))
      end select
    end associate
    if (allocated(material%expansion%value)) call set_thermal_strain(material, point, moduli)
  end subroutine evaluate_moduli


  !> Principal stresses of rubber or foam.
  pure subroutine evaluate_hyperelastic(material, constants, e, response)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: constants(:)
    real(DP), intent(in) :: e(3)                   !< principal logarithmic strains [-]
    type(principal_response_type), intent(out) :: response
    if (material%elastic_kind == ELASTIC_FOAM) then
      call evaluate_foam(material%hyper_order, constants, e, response)
    else
      call evaluate_rubber(material%hyper_kind, material%hyper_order, constants, e, response)
    end if
  end subroutine evaluate_hyperelastic


  !> The thermal strain since the start: a(T) (T - T0) - a(Ti) (Ti - T0), a the secant coefficient from T0 on.
  pure function evaluate_thermal_strain(material, temperature, field, frame, is_nlgeom) result(strain)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: temperature(2)         !< at the start and now [temperature]
    real(DP), intent(in) :: field(2)               !< field variable that the tables are over, at the start and now
    real(DP), intent(in) :: frame(3, 3)            !< local axes of the material in its columns
    logical, intent(in) :: is_nlgeom               !< Green's strain of it, if that is the strain of the law
    real(DP) :: strain(6)                          !< tensor components in the global axes, xx yy zz xy yz xz [-]
    type(material_point_type) :: point
    type(moduli_type) :: moduli
    strain = 0
    if (.not. allocated(material%expansion%value)) return
    point%temperature = temperature(2)
    point%initial_temperature = temperature(1)
    point%field = field(2)
    point%initial_field = field(1)
    point%frame = frame
    call set_thermal_strain(material, point, moduli)
    strain = moduli%thermal
    if (is_nlgeom .and. material%law == LAW_SAINT_VENANT) strain = green_strain_of_stretch(moduli%thermal)
  end function evaluate_thermal_strain


  !> The thermal strain at the temperature of a point.
  pure subroutine set_thermal_strain(material, point, moduli)
    type(material_type), intent(in) :: material
    type(material_point_type), intent(in) :: point
    type(moduli_type), intent(inout) :: moduli
    real(DP) :: now(6), start(6)
    integer :: n
    now = 0
    start = 0
    n = size(material%expansion%value, 1)
    call evaluate_table(material%expansion, table_argument(material, point), now(:n))
    call evaluate_table(material%expansion, merge(point%initial_field, point%initial_temperature, material%table_variable > 0), &
      start(:n))
    now = now * (point%temperature - material%expansion_reference) &
      - start * (point%initial_temperature - material%expansion_reference)
    moduli%is_thermal_isotropic = n == 1
    if (n == 1) then
      moduli%thermal = now(1) * VOIGT_IDENTITY
    else                                           ! the decks order the shears 12 13 23
      now(5:6) = now([6, 5])
      moduli%thermal = matmul(voigt_transformation(point%frame), now)
    end if
  end subroutine set_thermal_strain


  !> The law between six strains and six stresses, of any strain measure.
  pure subroutine evaluate_strain_law(material, moduli, strain, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: strain(6)              !< tensor components [-]
    type(material_point_type), intent(inout) :: point       !< out: stress, tangent, energy, history
    integer, intent(out) :: status                 !< STRESS_...
    real(DP) :: elastic(6), doubled(6)
    status = STRESS_OK
    elastic = strain - moduli%thermal - point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 5)
    if (material%has_deformation_plasticity .and. .not. point%is_flow_frozen) then
      call evaluate_deformation_plasticity(moduli, elastic, point, status)
    else if (is_one_sided(material)) then
      call one_sided_stress(material%elastic_kind, moduli%constants, elastic, point%stress, point%tangent, point%energy)
    else if (is_law_of_invariants(material)) then
      call invariant_law_stress(material%elastic_kind, moduli%constants, point%frame, elastic, point%stress, point%tangent, &
        point%energy, status)
    else if (material%is_corotational) then
      call corotational_stress(merge(isotropic_tangent(moduli%lambda, moduli%G), moduli%C, moduli%is_isotropic), elastic, &
        point%stress, point%tangent, point%energy, status)
    else if (allocated(material%prony)) then
      call viscoelastic_stress(material%prony, [moduli%lambda, moduli%G], point%time_increment, elastic, point%inner, &
        point%stress, point%tangent, point%energy)
    else if (moduli%is_isotropic) then
      point%stress = hooke_stress(moduli%lambda, moduli%G, elastic)
      point%tangent = isotropic_tangent(moduli%lambda, moduli%G)
      if (material%yield_surface /= YIELD_ROUND .and. .not. point%is_flow_frozen) then
        call return_along_axes(material, moduli, elastic, point, status)
      else if (is_inelastic(material) .and. .not. point%is_flow_frozen) then
        call return_to_yield_surface(material, moduli, point, status)
      end if
      elastic = strain - moduli%thermal - point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5)
      point%energy = 0.5_DP * double_dot(point%stress, elastic)
    else
      doubled = elastic
      doubled(4:) = 2 * elastic(4:)
      point%stress = matmul(moduli%C, doubled)
      point%tangent = moduli%C
      if (is_inelastic(material) .and. .not. point%is_flow_frozen) &
        call return_with_anisotropy(material, moduli, doubled, point, status)
      if (material%inelastic_law /= INELASTIC_NONE .and. point%elapsed_time > 0 .and. .not. point%is_flow_frozen) &
        call return_by_name(material, moduli, doubled, point, status)
      elastic = strain - moduli%thermal - point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5)
      point%energy = 0.5_DP * double_dot(point%stress, elastic)
    end if
  end subroutine evaluate_strain_law


  !> Returns a trial stress to the yield surface: stress = trial - 2 G sqrt(3/2) (dp + dc) N,
  !! tangent = K 1 1 + 2 G theta (I - 1 1/3) + 2 G (kappa - theta) N N, N the unit tensor along the trial deviator.
  pure subroutine return_to_yield_surface(material, moduli, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    type(material_point_type), intent(inout) :: point       !< in: trial stress, elastic tangent
    integer, intent(out) :: status                 !< STRESS_...
    type(return_mapping_type) :: response
    real(DP) :: N(6), p, q, bulk
    integer :: i
    p = -sum(point%stress(:3)) / 3
    N = point%stress + p * VOIGT_IDENTITY - point%history_old(HISTORY_BACK:HISTORY_BACK + 5)
    q = von_mises(N)
    bulk = moduli%lambda + 2 * moduli%G / 3
    call map_return(material, moduli, [q, p], point, response, status)
    if (status /= STRESS_OK .or. .not. response%flow + abs(response%expansion) > 0) return
    if (q > 0) N = N / (SQRT_2_3 * q)
    point%stress = point%stress - (2 * moduli%G * SQRT_3_2 * response%flow) * N - (bulk * response%expansion) * VOIGT_IDENTITY
    point%tangent = response%ratio * isotropic_tangent(0.0_DP, moduli%G)
    point%tangent(:3, :3) = point%tangent(:3, :3) + bulk * response%dp_dp - 2 * moduli%G * response%ratio / 3
    do i = 1, 6
      point%tangent(:, i) = point%tangent(:, i) + (2 * moduli%G * (response%slope - response%ratio) * N(i)) * N &
        - (SQRT_2_3 * bulk * response%dq_dp * VOIGT_IDENTITY(i)) * N &
        - (2 * SQRT_3_2 * moduli%G * response%dp_dq * N(i)) * VOIGT_IDENTITY
    end do
    associate (history => point%history)
      history(HISTORY_PEEQ) = history(HISTORY_PEEQ) + response%plastic
      history(HISTORY_CEEQ) = history(HISTORY_CEEQ) + response%creep
      history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5) = history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5) &
        + (SQRT_3_2 * response%flow) * N + (response%expansion / 3) * VOIGT_IDENTITY
      history(HISTORY_BACK:HISTORY_BACK + 5) = history(HISTORY_BACK:HISTORY_BACK + 5) + (SQRT_2_3 * response%back_increment) * N
    end associate
  end subroutine return_to_yield_surface


  !> Return mapping at small strain in the principal axes of the elastic trial strain.
  pure subroutine return_along_axes(material, moduli, elastic, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: elastic(6)             !< trial strain [-]
    type(material_point_type), intent(inout) :: point       !< in: trial stress, elastic tangent
    integer, intent(out) :: status                 !< STRESS_...
    type(principal_strains_type) :: principal
    type(principal_response_type) :: response
    real(DP) :: flow(3)
    call find_small_principal_strains(elastic, principal)
    call evaluate_hencky(moduli, principal%e, response)
    call return_principal_stresses(material, moduli, principal%e, point, response, flow, status)
    if (status /= STRESS_OK .or. .not. any(abs(flow) > 0)) return
    point%stress = tensor_from_principal(principal, response%tau)
    point%tangent = small_principal_tangent(principal, response%slope, response%secant)
    associate (inelastic => point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5))
      inelastic = inelastic + tensor_from_principal(principal, flow)
    end associate
  end subroutine return_along_axes


  !> The return mapping of the material: von Mises's cylinder, or the cone of Drucker and Prager.
  pure subroutine map_return(material, moduli, trial, point, response, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: trial(2)               !< von Mises stress and pressure [stress]
    type(material_point_type), intent(inout) :: point
    type(return_mapping_type), intent(out) :: response
    integer, intent(out) :: status                 !< STRESS_...
    integer :: return_status
    if (material%has_cap) then
      call map_cap_return(material, [moduli%G, moduli%lambda + 2 * moduli%G / 3], trial, table_argument(material, point), &
        point%history_old(HISTORY_PEEQ), response, return_status)
    else if (allocated(material%cone%value)) then
      call map_cone_return(material, [moduli%G, moduli%lambda + 2 * moduli%G / 3], trial, table_argument(material, point), &
        point%history_old(HISTORY_PEEQ), response, return_status)
    else
      if (allocated(point%creep)) point%creep%p = trial(2)
      call map_radial_return(material, moduli%G, trial(1), table_argument(material, point), creep_times(point), &
        point%history_old, response, return_status, point%creep)
    end if
    status = merge(STRESS_OK, STRESS_NOT_FINITE, return_status == RETURN_OK)
  end subroutine map_return


  !> The times of creep and of rates: end and length of the increment, start of the mean of time hardening, elapsed time [time].
  pure function creep_times(point) result(times)
    type(material_point_type), intent(in) :: point
    real(DP) :: times(4)
    times = [point%time, point%time_increment, point%time - merge(0.0_DP, point%time_increment, point%is_rate_at_end), &
      point%elapsed_time]
  end function creep_times


  !> Plastic flow and creep with anisotropic elasticity; the reader admits only isotropic hardening here.
  pure subroutine return_with_anisotropy(material, moduli, elastic, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: elastic(6)             !< trial strain, engineering shears [-]
    type(material_point_type), intent(inout) :: point       !< out: stress, tangent, history
    integer, intent(out) :: status                 !< STRESS_...
    type(anisotropic_return_type) :: response
    integer :: return_status
    call map_anisotropic_return(material, moduli%C, elastic, table_argument(material, point), creep_times(point), &
      point%history_old, response, return_status)
    status = merge(STRESS_OK, STRESS_NOT_FINITE, return_status == RETURN_OK)
    point%stress = response%stress
    point%tangent = response%tangent
    point%history(HISTORY_PEEQ) = point%history_old(HISTORY_PEEQ) + response%plastic
    point%history(HISTORY_CEEQ) = point%history_old(HISTORY_CEEQ) + response%creep
    associate (inelastic => point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5))
      inelastic(:3) = inelastic(:3) + (response%plastic + response%creep) * response%flow(:3)
      inelastic(4:) = inelastic(4:) + 0.5_DP * (response%plastic + response%creep) * response%flow(4:)
    end associate
  end subroutine return_with_anisotropy


  !> Flow of the laws that CalculiX takes by the name of the material.
  pure subroutine return_by_name(material, moduli, elastic, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: elastic(6)             !< trial strain, engineering shears [-]
    type(material_point_type), intent(inout) :: point       !< out: stress, tangent, history, inner
    integer, intent(out) :: status                 !< STRESS_...
    type(crystal_return_type) :: crystal
    type(linear_return_type) :: linear
    real(DP) :: constants(2 * N_CRYSTAL_CONSTANTS)
    integer :: return_status
    call evaluate_table(material%inelastic, table_argument(material, point), constants(:size(material%inelastic%value, 1)))
    if (material%inelastic_law == INELASTIC_LINEAR) then
      call map_linear_return(constants(:N_LINEAR_CONSTANTS), moduli%C, elastic, [point%time, point%elapsed_time], &
        point%time_increment > 0, point%inner, linear, return_status)
      crystal = crystal_return_type(linear%stress, linear%tangent, linear%flow, linear%plastic)
    else
      if (material%inelastic_law == INELASTIC_CRYSTAL_CREEP) constants = expand_creep_constants(constants(:4))
      call map_crystal_return(material%inelastic_law, constants, moduli%C, point%frame, elastic, point%elapsed_time, point%inner, &
        crystal, return_status)
    end if
    status = merge(STRESS_OK, STRESS_NOT_FINITE, return_status == RETURN_OK)
    point%stress = crystal%stress
    point%tangent = crystal%tangent
    point%history(HISTORY_PEEQ) = point%history_old(HISTORY_PEEQ) + crystal%plastic
    point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5) = point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 5) &
      + crystal%flow
  end subroutine return_by_name


  !> Deformation plasticity: the deviator of the stress follows the strain by Ramberg and Osgood's law, the pressure is
  !! elastic. Its energy is that of the elastic part.
  pure subroutine evaluate_deformation_plasticity(moduli, strain, point, status)
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: strain(6)              !< [-]
    type(material_point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    real(DP) :: N(6), e, ratio, slope, mean, bulk
    integer :: i, return_status
    mean = sum(strain(:3)) / 3
    N = strain - mean * VOIGT_IDENTITY
    e = SQRT_2_3 * sqrt(double_dot(N, N))
    call evaluate_ramberg_osgood(moduli%constants(:5), moduli%G, e, ratio, slope, return_status)
    status = merge(STRESS_OK, STRESS_NOT_FINITE, return_status == RETURN_OK)
    bulk = moduli%lambda + 2 * moduli%G / 3
    point%stress = 2 * moduli%G * ratio * N + 3 * bulk * mean * VOIGT_IDENTITY
    point%energy = double_dot(point%stress, point%stress) / (4 * moduli%G) &
      + (1 / (18 * bulk) - 1 / (12 * moduli%G)) * sum(point%stress(:3))**2
    point%tangent = ratio * isotropic_tangent(0.0_DP, moduli%G)
    point%tangent(:3, :3) = point%tangent(:3, :3) + bulk - 2 * moduli%G * ratio / 3
    if (e > 0) N = N / (SQRT_3_2 * e)
    do i = 1, 6
      point%tangent(:, i) = point%tangent(:, i) + (2 * moduli%G * (slope - ratio) * N(i)) * N
    end do
  end subroutine evaluate_deformation_plasticity


  !> The strain for output: ln(b)/2, or Green's under LAW_SAINT_VENANT.
  pure function evaluate_output_strain(material, H) result(strain)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    real(DP) :: strain(6)                          !< tensor components [-]
    if (material%law == LAW_SAINT_VENANT) then
      strain = green_strain(H)
    else
      strain = tensor_log(left_cauchy_green(H), 0.5_DP)
    end if
  end function evaluate_output_strain


  !> The law of six strains between Green's strain and the second Piola-Kirchhoff stress, pushed forward. A thermal strain e
  !! is a stretch 1 + e: the rest of Green's strain E is (E - e - e e/2)/(1 + e), with the mean of e in the denominator.
  pure subroutine evaluate_green_law(material, moduli, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    type(material_point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    type(moduli_type) :: thermal_moduli
    real(DP) :: push(6, 6), thermal_stretch
    point%strain = evaluate_output_strain(material, point%H)
    thermal_moduli = moduli
    thermal_moduli%thermal = green_strain_of_stretch(moduli%thermal)
    thermal_stretch = 1 + sum(moduli%thermal(:3)) / 3
    call evaluate_strain_law(material, thermal_moduli, point%strain, point, status)
    point%stress = point%stress / thermal_stretch
    point%tangent = point%tangent / thermal_stretch
    point%energy = point%energy / thermal_stretch
    push = voigt_transformation(IDENTITY + point%H)
    point%stress = matmul(push, point%stress)
    point%tangent = matmul(push, matmul(point%tangent, transpose(push)))
  end subroutine evaluate_green_law


  !> Deformation plasticity as in CalculiX: the law of six strains between Almansi's strain e = (1 - inv(b))/2 and Cauchy's
  !! stress s. With C = ds/de and the rate of deformation d the Kirchhoff stress changes, beside its convective part, by
  !!
  !!     J (C : (d - d e - e d) + s tr d - d s - s d),
  !!
  !! of which the symmetric part is used: there is no potential.
  pure subroutine evaluate_almansi_law(material, moduli, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    type(material_point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    real(DP) :: inverse(3, 3), rest(3, 3), e(3, 3), s(3, 3), d(3, 3), J, tangent(6, 6)
    integer :: k
    point%strain = almansi_strain(point%H)
    call evaluate_strain_law(material, moduli, point%strain, point, status)
    call invert(IDENTITY + point%H, inverse, J)
    e = unpack_voigt(point%strain)
    s = unpack_voigt(point%stress)
    do k = 1, 6
      d = unpack_voigt(merge(1.0_DP, 0.0_DP, [1, 2, 3, 4, 5, 6] == k))
      if (k > 3) d = 0.5_DP * d
      rest = d - matmul(d, e) - matmul(e, d)
      tangent(:, k) = matmul(point%tangent(:, :3), [rest(1, 1), rest(2, 2), rest(3, 3)]) &
        + 2 * matmul(point%tangent(:, 4:), [rest(1, 2), rest(2, 3), rest(1, 3)])
      rest = matmul(d, s) + matmul(s, d)
      tangent(:, k) = tangent(:, k) - pack_voigt(rest)
      if (k <= 3) tangent(:, k) = tangent(:, k) + point%stress
    end do
    point%tangent = 0.5_DP * J * (tangent + transpose(tangent))
    point%stress = J * point%stress
    point%energy = J * point%energy
  end subroutine evaluate_almansi_law


  !> A law of six strain components in ln(C)/2 and its conjugate stress, pushed forward to the current configuration.
  pure subroutine evaluate_log_law(material, moduli, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    type(material_point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    type(log_strain_axes_type) :: axes
    logical :: is_positive
    call find_log_strain_axes(point%H, axes, is_positive)
    status = STRESS_INVERTED
    if (.not. is_positive) return
    if (point%is_output_wanted) point%strain = evaluate_output_strain(material, point%H)
    call evaluate_strain_law(material, moduli, tensor_log(left_cauchy_green(transpose(point%H)), 0.5_DP), point, status)
    if (status == STRESS_OK) call push_forward_log_law(axes, point%stress, point%is_tangent_wanted, point%tangent)
  end subroutine evaluate_log_law


  !> The isotropic laws in the principal logarithms of the elastic trial b = F exp(-2 E_inelastic) F^T, less swelling.
  pure subroutine evaluate_principal_law(material, moduli, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    type(material_point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    type(principal_strains_type) :: principal
    type(principal_response_type) :: response
    real(DP) :: e(3), flow(3), F(3, 3), x(6)
    logical :: is_positive, has_past
    status = STRESS_INVERTED
    F = IDENTITY + point%H
    x = left_cauchy_green(point%H)
    associate (inelastic => point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 5))
      has_past = any(abs(inelastic) > 0)
      if (has_past) then
        call find_principal_strains(x + push_forward(F, tensor_exp(inelastic, -2.0_DP)), principal, is_positive)
      else
        call find_principal_strains(x, principal, is_positive)
      end if
    end associate
    if (.not. is_positive) return
    status = STRESS_OK
    if (point%is_output_wanted) then
      point%strain = tensor_from_principal(principal, principal%e)
      if (has_past .or. material%law == LAW_SAINT_VENANT) point%strain = evaluate_output_strain(material, point%H)
    end if
    if (is_hyperelastic(material)) then
      call evaluate_hyperelastic(material, moduli%constants, principal%e - log1p(moduli%thermal(1)), response)
    else
      e = principal%e - moduli%thermal(1)
      call evaluate_hencky(moduli, e, response)
      if (is_inelastic(material) .and. .not. point%is_flow_frozen) then
        call return_principal_stresses(material, moduli, e, point, response, flow, status)
        if (status /= STRESS_OK) return
        if (point%is_output_wanted .and. any(abs(flow) > 0)) call store_inelastic_strain(principal, flow, point)
      end if
    end if
    point%stress = tensor_from_principal(principal, response%tau)
    if (point%is_tangent_wanted .or. allocated(material%prony)) point%tangent = principal_tangent(principal, response%tau, &
      response%slope, response%secant)
    point%energy = response%energy
    if (.not. allocated(material%prony)) return
    call relax_finite_stress(material%prony, point%time_increment, point%H, point%inner, point%stress, point%tangent)
    point%energy = (1 - sum(material%prony(1, :))) * point%energy    ! of the spring that lasts
  end subroutine evaluate_principal_law


  !> Hencky's law in principal values.
  pure subroutine evaluate_hencky(moduli, e, response)
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: e(3)                   !< elastic logarithmic strains [-]
    type(principal_response_type), intent(out) :: response
    integer :: A
    response%tau = 2 * moduli%G * e + moduli%lambda * (e(1) + e(2) + e(3))
    response%slope = moduli%lambda
    do A = 1, 3
      response%slope(A, A) = moduli%lambda + 2 * moduli%G
    end do
    response%secant = 2 * moduli%G
    response%energy = 0.5_DP * dot_product(response%tau, e)
  end subroutine evaluate_hencky


  !> Return mapping in principal values, as return_to_yield_surface.
  pure subroutine return_principal_stresses(material, moduli, e, point, response, flow, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    real(DP), intent(in) :: e(3)                   !< elastic trial strains [-]
    type(material_point_type), intent(inout) :: point       !< out: equivalent strains
    type(principal_response_type), intent(inout) :: response      !< in: of the trial strains
    real(DP), intent(out) :: flow(3)               !< inelastic strains of the increment [-]
    integer, intent(out) :: status                 !< STRESS_...
    type(return_mapping_type) :: back
    real(DP) :: N(3), p, q, bulk
    integer :: A
    flow = 0
    bulk = moduli%lambda + 2 * moduli%G / 3
    if (material%yield_surface /= YIELD_ROUND) then
      call return_by_lode_angle(material, [moduli%G, bulk], e, point, response, flow, status)
      return
    end if
    p = -sum(response%tau) / 3
    N = response%tau + p
    q = SQRT_3_2 * norm2(N)
    call map_return(material, moduli, [q, p], point, back, status)
    if (status /= STRESS_OK .or. .not. back%flow + abs(back%expansion) > 0) return
    if (q > 0) N = N / (SQRT_2_3 * q)
    flow = (SQRT_3_2 * back%flow) * N + back%expansion / 3
    response%tau = response%tau - 2 * moduli%G * SQRT_3_2 * back%flow * N - bulk * back%expansion
    do A = 1, 3
      response%slope(:, A) = bulk * back%dp_dp - 2 * moduli%G * back%ratio / 3 - 2 * SQRT_3_2 * moduli%G * back%dp_dq * N(A) &
        + (2 * moduli%G * (back%slope - back%ratio) * N(A) - SQRT_2_3 * bulk * back%dq_dp) * N
      response%slope(A, A) = response%slope(A, A) + 2 * moduli%G * back%ratio
    end do
    response%secant = 2 * moduli%G * back%ratio
    response%energy = 0.5_DP * dot_product(response%tau, e - flow)
    point%history(HISTORY_PEEQ) = point%history_old(HISTORY_PEEQ) + back%plastic
    point%history(HISTORY_CEEQ) = point%history_old(HISTORY_CEEQ) + back%creep
  end subroutine return_principal_stresses


  !> The same for laws of the pressure and the Lode angle.
  pure subroutine return_by_lode_angle(material, moduli, e, point, response, flow, status)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: moduli(2)              !< shear and bulk modulus [stress]
    real(DP), intent(in) :: e(3)                   !< elastic trial strains [-]
    type(material_point_type), intent(inout) :: point       !< out: equivalent plastic strain
    type(principal_response_type), intent(inout) :: response      !< in: of the trial strains
    real(DP), intent(inout) :: flow(3)             !< plastic strains of the increment [-]
    integer, intent(out) :: status                 !< STRESS_...
    type(principal_return_type) :: back
    integer :: return_status
    call map_principal_return(material, moduli, response%tau, table_argument(material, point), point%history_old(HISTORY_PEEQ), &
      back, return_status)
    status = merge(STRESS_OK, STRESS_NOT_FINITE, return_status == RETURN_OK)
    if (status /= STRESS_OK .or. .not. any(abs(back%flow) > 0)) return
    flow = back%flow
    response = principal_response_type(back%tau, back%slope, back%secant, 0.5_DP * dot_product(back%tau, e - flow))
    point%history(HISTORY_PEEQ) = point%history_old(HISTORY_PEEQ) + back%plastic
  end subroutine return_by_lode_angle


  !> The inelastic strain after plastic flow: exp(-2 E) = F^-1 b F^-T with b the elastic one after it.
  pure subroutine store_inelastic_strain(principal, flow, point)
    type(principal_strains_type), intent(in) :: principal  !< of the trial b
    real(DP), intent(in) :: flow(3)                !< inelastic strains of the increment [-]
    type(material_point_type), intent(inout) :: point       !< out: history
    real(DP) :: inverse(3, 3), rest(3, 3), b(6), det
    call invert(IDENTITY + point%H, inverse, det)
    rest = -matmul(inverse, point%H)               ! F^-1 - 1
    b = tensor_from_principal(principal, expm1(2 * (principal%e - flow)))
    b = push_forward(inverse, b) + left_cauchy_green(rest)
    point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5) = tensor_log(b, -0.5_DP)
  end subroutine store_inelastic_strain


  !> Plasticity as in CalculiX (Simo): b is the isochoric elastic b and k the back stress, both pushed forward by F,
  !! x = b - k/G, tau = K/2 (J^2 - 1) 1 + G dev b - 2 G' sqrt(3/2) (dp + dc) n, n along dev x, G' = G tr b/3; the yield
  !! stress is a Cauchy stress. The tangent omits terms of the order of the elastic strains: symmetric, not exact. F is without
  !! the volume of initial stresses and strains (HISTORY_STRETCH), which the pressure does not come from.
  !! Reference: J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), box 9.1.
  pure subroutine evaluate_simo_law(material, moduli, point, status)
    type(material_type), intent(in) :: material
    type(moduli_type), intent(in) :: moduli
    type(material_point_type), intent(inout) :: point
    integer, intent(out) :: status                 !< STRESS_...
    type(return_mapping_type) :: back
    real(DP) :: H(3, 3), F(3, 3), j_minus_one, J, scale, b(6), k(6), s(6), n(6), size, modulus, flow
    real(DP) :: stretch                            ! inelastic, of the initial state, logarithmic [-]
    integer :: return_status
    stretch = 0
    if (material%n_history == HISTORY_STRETCH) stretch = point%history_old(HISTORY_STRETCH)
    H = gradient_without_swelling(point%H, moduli%thermal, stretch)
    F = IDENTITY + H
    j_minus_one = determinant_minus_one(H)
    J = 1 + j_minus_one
    scale = J**(-2 / 3.0_DP)
    k = push_forward(F, point%history_old(HISTORY_BACK:HISTORY_BACK + 5)) * scale
    b = left_cauchy_green(H) &
      + push_forward(F, tensor_exp(point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 5) - stretch * VOIGT_IDENTITY, &
      -2.0_DP))                                    ! J^(2/3) b - 1
    if (point%is_output_wanted) point%strain = evaluate_output_strain(material, point%H)
    modulus = moduli%G * scale * (3 + sum(b(:3))) / 3
    s = deviator(moduli%G * scale * b - k)
    size = sqrt(double_dot(s, s))
    if (allocated(point%creep)) point%creep%p = -(moduli%lambda + 2 * moduli%G / 3) * j_minus_one * (j_minus_one + 2) / (2 * J)
    call map_radial_return(material, modulus / J, SQRT_3_2 * size / J, table_argument(material, point), &
      creep_times(point), point%history_old, back, return_status, point%creep)
    status = merge(STRESS_OK, STRESS_NOT_FINITE, return_status == RETURN_OK)
    if (status /= STRESS_OK) return
    call set_isochoric_response(deviator(moduli%G * scale * b), modulus, moduli%G, moduli%lambda + 2 * moduli%G / 3, j_minus_one, &
      point)
    flow = back%plastic + back%creep
    n = 0
    if (flow > 0) then
      n = s / size
      call subtract_plastic_stress(n, size, modulus - sum(k(:3)) / 3, back, point)
    end if
    if (flow > 0 .or. any(abs(point%history_old(HISTORY_INELASTIC:HISTORY_INELASTIC + 5)) > 0)) &
      point%energy = evaluate_elastic_energy(moduli%lambda + 2 * moduli%G / 3, modulus, j_minus_one, point%stress)
    if (.not. (flow > 0 .and. point%is_output_wanted)) return
    call store_simo_history(H, J, b - (2 * SQRT_3_2 * modulus / (moduli%G * scale) * flow) * n, &
      k + (SQRT_2_3 * J * back%back_increment) * n, point)
    point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 2) = point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 2) + stretch
    point%history(HISTORY_PEEQ) = point%history_old(HISTORY_PEEQ) + back%plastic
    point%history(HISTORY_CEEQ) = point%history_old(HISTORY_CEEQ) + back%creep
  end subroutine evaluate_simo_law


  !> Elastic energy of a point with plastic flow. The trace of b is not a measure of elastic strain after flow: the deviator
  !! of the stress is.
  pure real(DP) function evaluate_elastic_energy(bulk, modulus, j_minus_one, tau) result(energy)
    real(DP), intent(in) :: bulk, modulus          !< K and G' [stress]
    real(DP), intent(in) :: j_minus_one            !< det F - 1 [-]
    real(DP), intent(in) :: tau(6)                 !< Kirchhoff stress [stress]
    energy = 0.25_DP * bulk * (j_minus_one * (j_minus_one + 2) - 2 * log1p(j_minus_one)) + von_mises(tau)**2 / (6 * modulus)
  end function evaluate_elastic_energy


  !> tau = K/2 (J^2 - 1) 1 + s, s = G dev b, b isochoric, with its tangent and energy.
  pure subroutine set_isochoric_response(s, modulus, G, bulk, j_minus_one, point)
    real(DP), intent(in) :: s(6)                   !< [stress]
    real(DP), intent(in) :: modulus                !< G' = G tr b/3 [stress]
    real(DP), intent(in) :: G, bulk                !< G, K [stress]
    real(DP), intent(in) :: j_minus_one            !< J - 1, J = det F [-]
    type(material_point_type), intent(inout) :: point       !< out: stress, tangent, energy
    real(DP) :: pressure
    integer :: i
    pressure = 0.5_DP * bulk * j_minus_one * (j_minus_one + 2)
    point%stress = s + pressure * VOIGT_IDENTITY
    point%energy = 0.25_DP * bulk * (j_minus_one * (j_minus_one + 2) - 2 * log1p(j_minus_one)) + 1.5_DP * (modulus - G)
    if (.not. point%is_tangent_wanted) return
    point%tangent = isochoric_tangent(s, modulus)
    point%tangent(:3, :3) = point%tangent(:3, :3) + bulk * (1 + j_minus_one)**2
    do i = 1, 6
      point%tangent(i, i) = point%tangent(i, i) - merge(2.0_DP, 1.0_DP, i <= 3) * pressure
    end do
  end subroutine set_isochoric_response


  !> Subtracts the plastic flow from the stress: tau = ... - (1 - theta) s, s = |s| n, with its tangent.
  pure subroutine subtract_plastic_stress(n, size, modulus, back, point)
    real(DP), intent(in) :: n(6)                   !< unit tensor along s [-]
    real(DP), intent(in) :: size                   !< |s| [stress]
    real(DP), intent(in) :: modulus                !< G tr x/3 [stress]
    type(return_mapping_type), intent(in) :: back
    type(material_point_type), intent(inout) :: point       !< stress and tangent change
    real(DP) :: along(6), factor
    integer :: i
    point%stress = point%stress - (1 - back%ratio) * size * n
    if (.not. point%is_tangent_wanted) return
    point%tangent = point%tangent - (1 - back%ratio) * isochoric_tangent(size * n, modulus)
    along = 2 * modulus * n + 2 * size * deviator(pack_voigt(matmul(unpack_voigt(n), unpack_voigt(n))))   ! d|s|
    factor = 0.5_DP * (back%slope - back%ratio)
    do i = 1, 6
      point%tangent(:, i) = point%tangent(:, i) + factor * (n * along(i) + along * n(i))
    end do
  end subroutine subtract_plastic_stress


  !> Pulls b and the back stress back to the reference configuration: the history.
  pure subroutine store_simo_history(H, J, b, k, point)
    real(DP), intent(in) :: H(3, 3)                !< F - 1 [-]
    real(DP), intent(in) :: J
    real(DP), intent(in) :: b(6)                   !< J^(2/3) b - 1 [-]
    real(DP), intent(in) :: k(6)                   !< back stress [stress]
    type(material_point_type), intent(inout) :: point
    real(DP) :: inverse(3, 3), det
    call invert(IDENTITY + H, inverse, det)
    point%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5) = &
      tensor_log(push_forward(inverse, b) + left_cauchy_green(-matmul(inverse, H)), -0.5_DP)
    point%history(HISTORY_BACK:HISTORY_BACK + 5) = J**(2 / 3.0_DP) * push_forward(inverse, k)
  end subroutine store_simo_history


  !> The elastic strain of a stress: initial stresses enter the inelastic strain with the opposite sign of this strain.
  pure function elastic_strain_from_stress(material, temperature, frame, stress) result(strain)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: temperature            !< or the field variable that the tables are over [temperature]
    real(DP), intent(in) :: frame(3, 3)            !< local axes in columns
    real(DP), intent(in) :: stress(6)              !< [stress]
    real(DP) :: strain(6)                          !< tensor components [-]
    type(material_point_type) :: point
    type(moduli_type) :: moduli
    real(DP) :: rest(6), C(6, 6), factor
    integer :: i, k
    point%frame = frame
    point%temperature = temperature
    point%initial_temperature = temperature
    point%field = temperature
    point%initial_field = temperature
    call evaluate_moduli(material, point, moduli)
    C = moduli%C
    if (moduli%is_isotropic) C = isotropic_tangent(moduli%lambda, moduli%G)
    rest = stress
    do k = 1, 6                                    ! C is positive definite: no pivots
      do i = k + 1, 6
        factor = C(i, k) / C(k, k)
        C(i, :) = C(i, :) - factor * C(k, :)
        rest(i) = rest(i) - factor * rest(k)
      end do
    end do
    do k = 6, 1, -1
      rest(k) = (rest(k) - dot_product(C(k, k + 1:), rest(k + 1:))) / C(k, k)
    end do
    strain = rest
    strain(4:) = 0.5_DP * rest(4:)
  end function elastic_strain_from_stress

end module amontons_material_point
