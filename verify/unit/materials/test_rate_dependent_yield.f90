!> Unit test of amontons_rate_dependent_yield: yield stress and slopes of the three laws, and the estimate of the flow.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_rate_dependent_yield
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, hardening_curve_type, property_table_type, rate_curves_type, RATE_POWER, &
    RATE_RATIO, RATE_CURVES
  use amontons_rate_dependent_yield, only: yield_point_type, evaluate_rate_yield, estimate_rate_flow
  use check, only: suite_type
  implicit none
  real(DP), parameter :: DT = 0.5_DP, P_OLD = 0.1_DP, COLD = 0.0_DP, HOT = 100.0_DP, WARM = 25.0_DP
  type(suite_type) :: suite
  call check_power()
  call check_ratio()
  call check_curves()
  call check_estimate()
  call suite%finish()

contains

  !> Static hardening 200 + 1000 p cold, half of it hot.
  function metal(rate_law) result(material)
    integer, intent(in) :: rate_law
    type(material_type) :: material
    material%rate_law = rate_law
    material%isotropic_hardening = [hardening_curve_type(COLD, [0.0_DP, 1.0_DP], [200.0_DP, 1200.0_DP]), &
      hardening_curve_type(HOT, [0.0_DP, 1.0_DP], [100.0_DP, 600.0_DP])]
  end function metal


  !> D and n over the temperature, on both sides of n = 1.
  subroutine check_power()
    type(material_type) :: material
    type(yield_point_type) :: at
    material = metal(RATE_POWER)
    material%rate_power = property_table_type([COLD, HOT], reshape([2.0_DP, 3.0_DP, 6.0_DP, 7.0_DP], [2, 2]))
    call evaluate_rate_yield(material, WARM, DT, P_OLD, 0.2_DP, at)      ! D = 3, n = 4
    call suite%near('strain', at%p, 0.5_DP * 3 * 0.2_DP**4, 1e-16_DP)
    call suite%near('stress', at%yield, 0.875_DP * (200 + 1000 * (P_OLD + at%p)) * 1.2_DP, 1e-10_DP)
    call check_slopes('power', material, 0.2_DP)
    material%rate_power = property_table_type([COLD], reshape([2.0_DP, 0.5_DP], [2, 1]))
    call evaluate_rate_yield(material, COLD, DT, P_OLD, 0.3_DP, at)
    call suite%near('strain below n = 1', at%p, 0.5_DP * 2 * 0.3_DP, 1e-16_DP)
    call suite%near('stress below n = 1', at%yield, (200 + 1000 * (P_OLD + at%p)) * 1.09_DP, 1e-10_DP)
    call check_slopes('power below n = 1', material, 0.3_DP)
    call evaluate_rate_yield(material, COLD, DT, P_OLD, 0.0_DP, at)
    call suite%near('no rate', at%yield, 300.0_DP, 1e-12_DP)
  end subroutine check_power


  !> A table of two segments, constant behind its end.
  subroutine check_ratio()
    type(material_type) :: material
    type(yield_point_type) :: at
    material = metal(RATE_RATIO)
    material%rate_ratio = [hardening_curve_type(COLD, [0.0_DP, 1.0_DP, 3.0_DP], [1.0_DP, 1.5_DP, 1.7_DP]), &
      hardening_curve_type(HOT, [0.0_DP], [1.0_DP])]
    call evaluate_rate_yield(material, COLD, DT, P_OLD, 1.0_DP, at)      ! rate 2
    call suite%near('table', at%yield, 1.6_DP * 1200, 1e-9_DP)
    call suite%near('its strain', at%p, 1.0_DP, 0.0_DP)
    call evaluate_rate_yield(material, WARM, DT, 0.0_DP, 0.5_DP, at)     ! rate 1
    call suite%near('between temperatures', at%yield, (1 + 0.75_DP * 0.5_DP) * 0.875_DP * 700, 1e-9_DP)
    call check_slopes('table', material, 0.8_DP)
    call check_slopes('behind the table', material, 1.8_DP)
  end subroutine check_ratio


  !> Curves at the rates 1, 2 and 4: constant below and above, linear between.
  subroutine check_curves()
    type(material_type) :: material
    type(yield_point_type) :: at
    material = metal(RATE_CURVES)
    allocate (material%rate_curves(3))
    material%rate_curves(1) = rate_curves_type(1.0_DP, material%isotropic_hardening)
    material%rate_curves(2) = rate_curves_type(2.0_DP, [hardening_curve_type(COLD, [0.0_DP, 1.0_DP], [300.0_DP, 1400.0_DP])])
    material%rate_curves(3) = rate_curves_type(4.0_DP, [hardening_curve_type(COLD, [0.0_DP, 1.0_DP], [500.0_DP, 1600.0_DP])])
    call evaluate_rate_yield(material, COLD, DT, P_OLD, 0.25_DP, at)     ! rate 0.5
    call suite%near('below', at%yield, 550.0_DP, 1e-10_DP)
    call suite%near('slope below', at%slope, 1000.0_DP, 1e-10_DP)
    call evaluate_rate_yield(material, COLD, DT, 0.0_DP, 0.75_DP, at)    ! rate 1.5
    call suite%near('between', at%yield, 0.5_DP * (950.0_DP + 1125.0_DP), 1e-10_DP)
    call check_slopes('between', material, 0.7_DP)
    call check_slopes('between the others', material, 1.4_DP)
    call evaluate_rate_yield(material, COLD, 0.1_DP * DT, 0.0_DP, 0.5_DP, at)   ! rate 10
    call suite%near('above', at%yield, 1050.0_DP, 1e-10_DP)
    call suite%near('slope above', at%slope, 1100.0_DP, 1e-10_DP)
  end subroutine check_curves


  !> The derivatives against central differences.
  subroutine check_slopes(name, material, x)
    character(*), intent(in) :: name
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: x
    type(yield_point_type) :: at, plus, minus
    real(DP), parameter :: STEP = 1e-6_DP
    call evaluate_rate_yield(material, WARM, DT, P_OLD, x, at)
    call evaluate_rate_yield(material, WARM, DT, P_OLD, x + STEP, plus)
    call evaluate_rate_yield(material, WARM, DT, P_OLD, x - STEP, minus)
    call suite%near(name // ': dp', at%dp, (plus%p - minus%p) / (2 * STEP), 1e-8_DP * at%dp)
    call suite%near(name // ': slope', at%slope, (plus%yield - minus%yield) / (2 * STEP), 1e-6_DP * at%slope)
  end subroutine check_slopes


  !> The largest unknown takes all of the trial stress, and the start is not beyond it.
  subroutine check_estimate()
    type(material_type) :: material
    type(yield_point_type) :: at
    real(DP) :: start, most
    real(DP), parameter :: STIFFNESS = 1000.0_DP, Q = 450.0_DP
    integer :: k
    material = metal(RATE_POWER)
    do k = 1, 2
      material%rate_power = property_table_type([COLD], reshape([2.0_DP, merge(0.5_DP, 4.0_DP, k == 1)], [2, 1]))
      call estimate_rate_flow(material, COLD, DT, P_OLD, [Q, STIFFNESS], start, most)
      call evaluate_rate_yield(material, COLD, DT, P_OLD, most, at)
      call suite%near('all of the stress', STIFFNESS * at%p, Q, 1e-10_DP)
      call suite%that('the start is within', start > 0 .and. start <= most)
    end do
    call estimate_rate_flow(metal(RATE_RATIO), COLD, DT, P_OLD, [Q, STIFFNESS], start, most)
    call suite%near('tables', most, Q / STIFFNESS, 1e-15_DP)
    call suite%near('their start', start, 0.0_DP, 0.0_DP)
  end subroutine check_estimate

end program test_rate_dependent_yield
