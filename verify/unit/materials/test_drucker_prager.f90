!> Unit test of amontons_drucker_prager: yield condition, flow, plastic work, derivatives by differences, on the cone and its apex.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_drucker_prager
  use amontons_kinds, only: DP, PI
  use amontons_drucker_prager, only: map_cone_return
  use amontons_materials, only: material_type, property_table_type, hardening_curve_type, CONE_COMPRESSION, CONE_TENSION, CONE_SHEAR
  use amontons_plasticity, only: return_mapping_type, RETURN_OK, RETURN_FAILED
  use check, only: suite_type
  implicit none
  real(DP), parameter :: MODULI(2) = [400.0_DP, 900.0_DP], G = MODULI(1), K = MODULI(2)
  type(suite_type) :: suite
  integer :: test

  do test = CONE_COMPRESSION, CONE_SHEAR
    call check_region(soil(test, 30.0_DP, 10.0_DP, 50.0_DP), [30.0_DP, 12.0_DP], .false., 'cone')
    call check_region(soil(test, 30.0_DP, 10.0_DP, 50.0_DP), [30.0_DP, -60.0_DP], .true., 'apex')
    call check_region(soil(test, 30.0_DP, 30.0_DP, -20.0_DP), [30.0_DP, 12.0_DP], .false., 'softening cone')
    call check_region(soil(test, 30.0_DP, 0.0_DP, 0.0_DP), [0.0_DP, -40.0_DP], .true., 'apex, tension in all directions')
    call check_region(soil(test, 0.0_DP, 0.0_DP, 50.0_DP), [30.0_DP, -40.0_DP], .false., 'no friction')
    call check_border(soil(test, 30.0_DP, 10.0_DP, 50.0_DP))
    call check_work(test)
  end do
  call check_elastic()
  call check_steep_softening()
  call suite%finish()

contains

  !> A cone with linear hardening from 10 on.
  function soil(hardening, friction, dilation, slope) result(material)
    integer, intent(in) :: hardening               !< CONE_...
    real(DP), intent(in) :: friction, dilation     !< [degree]
    real(DP), intent(in) :: slope                  !< [stress]
    type(material_type) :: material
    material%cone = property_table_type([0.0_DP], reshape(PI / 180 * [friction, dilation], [2, 1]))
    material%cone_hardening = hardening
    allocate (material%isotropic_hardening(1))
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.2_DP], [10.0_DP, 10 + 0.2_DP * slope])
  end function soil


  !> The cohesion after an equivalent plastic strain.
  real(DP) function cohesion(material, e)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: e
    real(DP) :: friction
    friction = tan(material%cone%value(1, 1))
    associate (curve => material%isotropic_hardening(1))
      cohesion = curve%stress(1) + e * (curve%stress(2) - curve%stress(1)) / 0.2_DP
    end associate
    select case (material%cone_hardening)
    case (CONE_COMPRESSION)
      cohesion = cohesion * (1 - friction / 3)
    case (CONE_TENSION)
      cohesion = cohesion * (1 + friction / 3)
    case default
      cohesion = cohesion * sqrt(3.0_DP)
    end select
  end function cohesion


  !> Stress after the return: von Mises stress and pressure.
  function returned(solution, trial) result(stress)
    type(return_mapping_type), intent(in) :: solution
    real(DP), intent(in) :: trial(2)
    real(DP) :: stress(2)
    stress = [trial(1) - 3 * G * solution%flow, trial(2) + K * solution%expansion]
  end function returned


  !> The returned stress lies on the cone or at its apex; the derivatives agree with differences.
  subroutine check_region(material, trial, is_apex, name)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: trial(2)
    logical, intent(in) :: is_apex
    character(*), intent(in) :: name
    real(DP), parameter :: STEP = 1.0e-5_DP, E_OLD = 0.01_DP
    type(return_mapping_type) :: solution, plus, minus
    real(DP) :: stress(2), slope(2, 2), change(2), friction, dilation
    integer :: i, status, statuses(2)
    friction = tan(material%cone%value(1, 1))
    dilation = tan(material%cone%value(2, 1))
    call map_cone_return(material, MODULI, trial, 0.0_DP, E_OLD, solution, status)
    call suite%that(name // ': status', status == RETURN_OK)
    stress = returned(solution, trial)
    call suite%near(name // ': yield', stress(1) - stress(2) * friction, cohesion(material, E_OLD + solution%plastic), 1e-11_DP)
    call suite%near(name // ': ratio', solution%ratio * trial(1), stress(1), 1e-11_DP)
    if (is_apex) then
      call suite%near(name // ': q', stress(1), 0.0_DP, 1e-12_DP)
      call suite%that(name // ': volume grows by more than on the cone', solution%expansion > dilation * solution%flow)
    else
      call suite%that(name // ': q', stress(1) > 0)
      call suite%near(name // ': dilation', solution%expansion, dilation * solution%flow, 1e-14_DP)
    end if
    do i = 1, 2
      change = merge(STEP, 0.0_DP, [1, 2] == i)
      if (is_apex .and. trial(1) - change(1) < 0) cycle      ! no von Mises stress below zero
      call map_cone_return(material, MODULI, trial + change, 0.0_DP, E_OLD, plus, statuses(1))
      call map_cone_return(material, MODULI, trial - change, 0.0_DP, E_OLD, minus, statuses(2))
      slope(:, i) = (returned(plus, trial + change) - returned(minus, trial - change)) / (2 * STEP)
      call suite%near(name // ': dq', merge(solution%slope, solution%dq_dp, i == 1), slope(1, i), 1e-7_DP)
      call suite%near(name // ': dp', merge(solution%dp_dq, solution%dp_dp, i == 1), slope(2, i), 1e-7_DP)
    end do
  end subroutine check_region


  !> The stress is continuous where the cone ends: the trial pressures on both sides give the apex.
  subroutine check_border(material)
    type(material_type), intent(in) :: material
    type(return_mapping_type) :: on_cone, at_apex
    real(DP) :: friction, m, growth, p
    integer :: status
    friction = tan(material%cone%value(1, 1))
    m = 30 / (3 * G)
    growth = 1 - tan(material%cone%value(2, 1)) / 3
    if (material%cone_hardening == CONE_TENSION) growth = 1 + tan(material%cone%value(2, 1)) / 3
    if (material%cone_hardening == CONE_SHEAR) growth = sqrt(3.0_DP)
    p = -cohesion(material, growth * m) / friction - K * m * tan(material%cone%value(2, 1))
    call map_cone_return(material, MODULI, [30.0_DP, p + 1e-7_DP], 0.0_DP, 0.0_DP, on_cone, status)
    call map_cone_return(material, MODULI, [30.0_DP, p - 1e-7_DP], 0.0_DP, 0.0_DP, at_apex, status)
    call suite%that('border: one side is the cone', on_cone%ratio > 0 .and. .not. at_apex%ratio > 0)
    call suite%near('border: plastic strain', at_apex%plastic, on_cone%plastic, 1e-8_DP)
    call suite%near('border: volume', at_apex%expansion, on_cone%expansion, 1e-8_DP)
  end subroutine check_border


  !> With associated flow the plastic work is the stress of the curve times the equivalent plastic strain, at the apex too.
  subroutine check_work(hardening)
    integer, intent(in) :: hardening
    real(DP), parameter :: TRIALS(2, 2) = reshape([30.0_DP, 12.0_DP, 30.0_DP, -80.0_DP], [2, 2])
    type(return_mapping_type) :: solution
    real(DP) :: stress(2)
    integer :: i, status
    do i = 1, 2
      call map_cone_return(soil(hardening, 30.0_DP, 30.0_DP, 0.0_DP), MODULI, TRIALS(:, i), 0.0_DP, 0.0_DP, solution, status)
      stress = returned(solution, TRIALS(:, i))
      call suite%near('work', stress(1) * solution%flow - stress(2) * solution%expansion, 10 * solution%plastic, 1e-12_DP)
    end do
  end subroutine check_work


  !> Within the cone nothing happens.
  subroutine check_elastic()
    type(return_mapping_type) :: solution
    integer :: status
    call map_cone_return(soil(CONE_COMPRESSION, 30.0_DP, 10.0_DP, 0.0_DP), MODULI, [12.0_DP, 20.0_DP], 0.0_DP, 0.0_DP, solution, &
      status)
    call suite%that('elastic', status == RETURN_OK .and. .not. solution%plastic > 0 .and. .not. solution%flow > 0)
    call suite%near('elastic: slopes', sum(abs([solution%ratio, solution%slope, solution%dp_dp] - 1)), 0.0_DP, 0.0_DP)
  end subroutine check_elastic


  !> Softening that is steeper than the elastic unloading has no solution.
  subroutine check_steep_softening()
    type(return_mapping_type) :: solution
    type(material_type) :: material
    integer :: status
    material = soil(CONE_COMPRESSION, 30.0_DP, 10.0_DP, 0.0_DP)
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.001_DP], [10.0_DP, 1.0_DP])
    call map_cone_return(material, MODULI, [12.0_DP, 0.0_DP], 0.0_DP, 0.0_DP, solution, status)
    call suite%that('steep softening', status == RETURN_FAILED)
  end subroutine check_steep_softening

end program test_drucker_prager
