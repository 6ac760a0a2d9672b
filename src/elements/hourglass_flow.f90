!> Flow of one-point elements in their hourglass modes: how much of the hourglass stress an inelastic law holds after an increment.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The stabilization of `hourglass` is elastic within an increment. Where the material flows its stress must follow, or bending
!! grows without limit. When an increment is accepted the law itself decides how far: it is evaluated at the 2^d Gauss points of the
!! full rule, at the strain of the element plus that of the hourglass modes, from the history of the element's point, once as it is
!! and once with its flow frozen. With T_g the stress of the frozen law, d_g its excess over that of the flowing one, and a prime
!! for the part that varies over the element,
!!
!!     share = 1 - sum d'_g : d'_g / sum d'_g : T'_g,
!!
!! the projection of the held stress on what relaxes: 1 without flow, the factor of the radial return for a metal that is bent
!! alone, 0 in bending along the stress of an element that flows as a whole and does not harden, the factor of the radial return
!! across it. The amplitudes that have flowed are a history: p_i <- p - share (p - p_i). Within the next increment the stress is
!!
!!     s = M (p_n - p_i) + M' (p - p_n),    M' = M - (1 - slope) m m' / (m . (p_n - p_i)),    m = M (p_n - p_i),
!!
!! with p_n the amplitudes at its start and slope d(share |p - p_i|) / d|p - p_i|: the stabilization has the modulus of the flowing
!! material along its stress, the elastic one across it. So force and tangent remain those of an energy, and only the first
!! increment that flows is elastic.
!!
!! References: T. Belytschko, L. P. Bindeman, Assumed strain stabilization of the eight node hexahedral element, Comput. Meth. Appl.
!! Mech. Engng 105 (1993) 225-260 (stabilization by the moduli of the flowing material); S. Reese, On a physically stabilized one
!! point finite element formulation for three-dimensional finite elasto-plasticity, Comput. Meth. Appl. Mech. Engng 194 (2005)
!! 4685-4715. Theory: doc/theory/elements.md, section "One point and hourglass stiffness".
module amontons_hourglass_flow
  use amontons_kinds, only: DP
  use amontons_element_integration_points, only: integration_points_type, set_point_input
  use amontons_elasticity, only: STRESS_OK
  use amontons_element_kinds, only: MAX_ELEMENT_AMPLITUDES
  use amontons_hourglass, only: hourglass_type, hourglass_amplitudes, hourglass_strain, MAX_HOURGLASS_SAMPLES
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: material_type, LAW_SAINT_VENANT
  use amontons_tensor, only: IDENTITY, double_dot, invert, pack_voigt
  use amontons_zero_stress_condition, only: solve_zero_stress
  implicit none
  private
  public :: has_hourglass_flow, load_hourglass_flow, store_hourglass_flow

  integer, parameter :: N = 12                     !< amplitudes; after them those at the start of the increment
  integer, parameter :: SOFTENING = 2 * N + 1      !< place of 1 - slope
  integer, parameter :: DISSIPATED = MAX_ELEMENT_AMPLITUDES - 1   !< place of the energy that flow dissipates
  integer, parameter :: MISSED = MAX_ELEMENT_AMPLITUDES   !< place of the work of the stress that the law did not hold
  real(DP), parameter :: MIN_SLOPE = 0.1_DP        !< softer, a row of single elements in bending swings between increments [-]

contains

  !> Whether the hourglass stress of a material flows: of all inelastic laws but user routines, and the relaxing ones, which the
  !! reader refuses. The artificial stiffness of the calculix dialect is elastic, as in CalculiX.
  pure logical function has_hourglass_flow(material) result(has)
    type(material_type), intent(in) :: material
    has = (material%n_history > 0 .or. material%has_deformation_plasticity) .and. .not. (material%is_user .or. &
      allocated(material%prony) .or. material%law == LAW_SAINT_VENANT)
  end function has_hourglass_flow


  !> Loads what an element keeps of its flow before this increment: amplitudes that have flowed, those at the start, the modulus.
  pure subroutine load_hourglass_flow(material, points, hourglass)
    type(material_type), intent(in) :: material
    type(integration_points_type), intent(in) :: points
    type(hourglass_type), intent(inout) :: hourglass
    real(DP) :: held(N), m(N), product
    if (.not. has_hourglass_flow(material)) return
    hourglass%inelastic = points%modes_old(:N)
    hourglass%start = points%modes_old(N + 1:2 * N)
    hourglass%tangent = hourglass%matrix
    held = hourglass%start - hourglass%inelastic
    m = matmul(hourglass%matrix, held)
    product = dot_product(m, held)
    if (product > 0) hourglass%tangent = hourglass%matrix - points%modes_old(SOFTENING) / product * spread(m, 2, N) &
      * spread(m, 1, N)
  end subroutine load_hourglass_flow


  !> Stores the same at the end of the increment, and since the start the energy that the flow dissipates and the work of the
  !! stresses that were not those which the law holds. The energy of the modes becomes that which is held.
  pure subroutine store_hourglass_flow(condition, material, u, H, is_nlgeom, weight, hourglass, energy, points)
    integer, intent(in) :: condition               !< CONDITION_...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    real(DP), intent(in) :: H(3, 3)                !< mean displacement gradient [-]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: weight(:)              !< of the nodal temperatures [-]
    type(hourglass_type), intent(in) :: hourglass
    real(DP), intent(inout) :: energy              !< of the modes [energy]
    type(integration_points_type), intent(inout) :: points     !< out: modes
    real(DP) :: p(N), held(N), change(N), s(N), response(2), work
    if (.not. has_hourglass_flow(material)) return
    points%modes = points%modes_old
    if (.not. points%is_output_wanted) return
    p = hourglass_amplitudes(hourglass, u, is_nlgeom)
    held = hourglass%start - hourglass%inelastic
    change = p - hourglass%start
    work = dot_product(change, matmul(hourglass%matrix, held)) + 0.5_DP * dot_product(change, matmul(hourglass%tangent, change))
    energy = 0.5_DP * dot_product(held, matmul(hourglass%matrix, held))
    call find_held_share(condition, material, p - hourglass%inelastic, H, is_nlgeom, weight, hourglass, points, response)
    s = matmul(hourglass%matrix, held) + matmul(hourglass%tangent, change)
    held = response(1) * (p - hourglass%inelastic)
    points%modes(:N) = p - held
    if (response(1) >= 1) points%modes(:N) = hourglass%inelastic
    points%modes(N + 1:2 * N) = p
    points%modes(SOFTENING) = 1 - response(2)
    points%modes(DISSIPATED) = points%modes_old(DISSIPATED) + energy + work
    energy = 0.5_DP * dot_product(held, matmul(hourglass%matrix, held))
    points%modes(DISSIPATED) = points%modes(DISSIPATED) - energy
    points%modes(MISSED) = points%modes_old(MISSED) + abs(dot_product(s - matmul(hourglass%matrix, held), change))
  end subroutine store_hourglass_flow


  !> The share of the hourglass stress that the law holds, and its slope.
  pure subroutine find_held_share(condition, material, p, H, is_nlgeom, weight, hourglass, points, response)
    integer, intent(in) :: condition               !< CONDITION_...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: p(:)                   !< amplitudes that have not flowed [length]
    real(DP), intent(in) :: H(3, 3)                !< mean displacement gradient [-]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: weight(:)              !< of the nodal temperatures [-]
    type(hourglass_type), intent(in) :: hourglass
    type(integration_points_type), intent(in) :: points
    real(DP), intent(out) :: response(2)           !< share, and the slope of its product with |p| by |p| [-]
    type(material_point_type) :: point
    real(DP) :: F(3, 3), inverse(3, 3), strain(3, 3), e(6), det, square, product, d_square, d_product, share
    real(DP), dimension(6, MAX_HOURGLASS_SAMPLES) :: frozen, excess, rate
    integer :: g, k, status
    response = 1
    if (.not. any(abs(p) > 0)) return
    F = IDENTITY
    if (is_nlgeom) F = F + H
    call invert(F, inverse, det)
    call set_point_input(material, points, 1, weight, point)
    point%is_tangent_wanted = .true.
    k = 2**hourglass%d
    do g = 1, k
      strain = matmul(transpose(inverse), matmul(hourglass_strain(hourglass, p, g), inverse))
      e = pack_voigt(strain)
      e(4:) = 2 * e(4:)
      point%H = H + matmul(strain, F)
      point%is_flow_frozen = .true.
      call solve_zero_stress(condition, material, is_nlgeom, point, status)
      if (status /= STRESS_OK) return              ! beyond all bounds: elastic, as the modes have been within the increment
      frozen(:, g) = point%stress
      rate(:, g) = matmul(point%tangent, e)
      point%is_flow_frozen = .false.
      call solve_zero_stress(condition, material, is_nlgeom, point, status)
      if (status /= STRESS_OK) return
      excess(:, g) = frozen(:, g) - point%stress
      rate(:, g) = rate(:, g) - matmul(point%tangent, e)
    end do
    frozen(:, :k) = varying_part(frozen(:, :k))
    excess(:, :k) = varying_part(excess(:, :k))
    rate(:, :k) = varying_part(rate(:, :k))
    square = sum([(double_dot(excess(:, g), excess(:, g)), g=1, k)])
    if (.not. square > 0) return
    product = sum([(double_dot(excess(:, g), frozen(:, g)), g=1, k)])
    response = [0.0_DP, MIN_SLOPE]
    if (product <= square) return                  ! all flows away
    share = 1 - square / product
    d_square = 2 * sum([(double_dot(excess(:, g), rate(:, g)), g=1, k)])
    d_product = product + sum([(double_dot(rate(:, g), frozen(:, g)), g=1, k)])
    response = [share, min(max(share - (d_square * product - square * d_product) / product**2, MIN_SLOPE), 1.0_DP)]
  end subroutine find_held_share


  !> What varies over the samples.
  pure function varying_part(stress) result(varying)
    real(DP), intent(in) :: stress(:, :)           !< (6, samples)
    real(DP) :: varying(size(stress, 1), size(stress, 2))
    varying = stress - spread(sum(stress, 2) / real(size(stress, 2), DP), 2, size(stress, 2))
  end function varying_part

end module amontons_hourglass_flow
