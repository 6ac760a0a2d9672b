!> Unit test of amontons_drucker_prager_cap: yield and flow, derivatives by differences, isotropic compression, all surfaces.
!! the three surfaces.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_drucker_prager_cap
  use amontons_kinds, only: DP, PI
  use amontons_drucker_prager_cap, only: map_cap_return
  use amontons_materials, only: material_type, property_table_type, hardening_curve_type
  use amontons_plasticity, only: return_mapping_type, RETURN_OK
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: G = 1200.0_DP, K = 2000.0_DP, BETA = 35 * PI / 180, D = 3.0_DP, R = 0.4_DP
  integer :: n_shear = 0, n_transition = 0, n_cap = 0
  integer :: i, j
  do i = 0, 24
    do j = -6, 24
      call check_trial(0.1_DP, 4.0_DP * real(i, DP), 2.5_DP * real(j, DP))
      call check_trial(0.0_DP, 4.0_DP * real(i, DP), 2.5_DP * real(j, DP))
    end do
  end do
  call suite%that('all three surfaces', min(n_shear, n_transition, n_cap) >= 5)
  call check_isotropic_compression()
  call suite%finish()

contains

  !> A clay whose cap hardens from 20 to 60.
  function clay(alpha) result(material)
    real(DP), intent(in) :: alpha
    type(material_type) :: material
    material%has_cap = .true.
    material%cone = property_table_type([0.0_DP], reshape([BETA, D, R, 0.002_DP, alpha], [5, 1]))
    material%isotropic_hardening = [hardening_curve_type(0.0_DP, [0.0_DP, 0.005_DP, 0.02_DP], [20.0_DP, 25.0_DP, 60.0_DP])]
  end function clay


  !> p_b of clay.
  pure real(DP) function cap_stress(v) result(p_b)
    real(DP), intent(in) :: v                      !< with the initial compaction [-]
    p_b = 20 + 1000 * min(max(v, 0.0_DP), 0.005_DP) + 35 / 0.015_DP * min(max(v - 0.005_DP, 0.0_DP), 0.015_DP)
  end function cap_stress


  !> Yield, direction of flow and derivatives.
  subroutine check_trial(alpha, q_trial, p_trial)
    real(DP), intent(in) :: alpha, q_trial, p_trial
    real(DP), parameter :: V_OLD = 0.004_DP, STEP = 1.0e-5_DP
    type(return_mapping_type) :: back, plus, minus
    real(DP) :: p, q, p_a, height, m, excess, ratio
    integer :: status
    call map_cap_return(clay(alpha), [G, K], [q_trial, p_trial], 0.0_DP, V_OLD, back, status)
    call suite%that('it converges', status == RETURN_OK)
    q = q_trial - 3 * G * back%flow
    p = p_trial + K * back%expansion
    p_a = (cap_stress(V_OLD + 0.002_DP - back%expansion) - R * D) / (1 + R * tan(BETA))
    height = D + p_a * tan(BETA)
    m = 1 + alpha - alpha / cos(BETA)
    if (p > p_a) then
      excess = sqrt((p - p_a)**2 + (R * q / m)**2) - R * height
    else if (p < p_a - alpha * height * sin(BETA)) then
      excess = q - p * tan(BETA) - D
    else
      excess = q - (1 - alpha / cos(BETA)) * height - sqrt((alpha * height)**2 - (p - p_a)**2)
    end if
    if (.not. back%flow + abs(back%expansion) > 0) then
      call suite%that('inside', excess <= 1.0e-7_DP)
      return
    end if
    call suite%near('on the surface', excess, 0.0_DP, 1.0e-8_DP)
    if (p > p_a) then
      n_cap = n_cap + 1
      ratio = (m / R)**2
    else
      if (p < p_a - alpha * height * sin(BETA)) n_shear = n_shear + 1
      if (p > p_a - alpha * height * sin(BETA)) n_transition = n_transition + 1
      ratio = (m * tan(BETA))**2
    end if
    call suite%near('flow', -back%expansion * q, ratio * (p - p_a) * back%flow, 1.0e-9_DP)
    call suite%near('compaction', back%plastic, -back%expansion, 0.0_DP)
    if (q_trial > 0) call suite%near('ratio', back%ratio, q / q_trial, 1.0e-12_DP)
    if (.not. q_trial > 0) return
    call map_cap_return(clay(alpha), [G, K], [q_trial + STEP, p_trial], 0.0_DP, V_OLD, plus, status)
    call map_cap_return(clay(alpha), [G, K], [q_trial - STEP, p_trial], 0.0_DP, V_OLD, minus, status)
    call near_difference('q by q', back%slope, 1 - 3 * G * (plus%flow - minus%flow) / (2 * STEP))
    call near_difference('p by q', back%dp_dq, K * (plus%expansion - minus%expansion) / (2 * STEP))
    call map_cap_return(clay(alpha), [G, K], [q_trial, p_trial + STEP], 0.0_DP, V_OLD, plus, status)
    call map_cap_return(clay(alpha), [G, K], [q_trial, p_trial - STEP], 0.0_DP, V_OLD, minus, status)
    call near_difference('q by p', back%dq_dp, -3 * G * (plus%flow - minus%flow) / (2 * STEP))
    call near_difference('p by p', back%dp_dp, 1 + K * (plus%expansion - minus%expansion) / (2 * STEP))
  end subroutine check_trial


  !> A derivative by differences.
  subroutine near_difference(what, value, difference)
    character(*), intent(in) :: what
    real(DP), intent(in) :: value, difference
    call suite%near(what, value, difference, 2.0e-5_DP * (1 + abs(difference)))
  end subroutine near_difference


  !> p = p_b(v) and p = p_trial - K dv.
  subroutine check_isotropic_compression()
    type(return_mapping_type) :: back
    integer :: status
    call map_cap_return(clay(0.1_DP), [G, K], [0.0_DP, 50.0_DP], 0.0_DP, 0.0_DP, back, status)
    call suite%near('on the cap', 50 - K * back%plastic, cap_stress(0.002_DP + back%plastic), 1.0e-9_DP)
    call suite%near('no shear', back%flow, 0.0_DP, 0.0_DP)
  end subroutine check_isotropic_compression

end program test_drucker_prager_cap
