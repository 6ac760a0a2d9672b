!> Unit test of amontons_lode_angle_return: yield condition, flow, work, slopes and secants by differences; K = 1 is the round cone.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_lode_angle_return
  use amontons_kinds, only: DP, PI
  use amontons_drucker_prager, only: map_cone_return
  use amontons_lode_angle_return, only: principal_return_type, map_principal_return
  use amontons_materials, only: material_type, property_table_type, hardening_curve_type, YIELD_RATIO, YIELD_MOHR_COULOMB, &
    CONE_COMPRESSION, CONE_TENSION, CONE_SHEAR
  use amontons_plasticity, only: return_mapping_type, RETURN_OK, RETURN_FAILED
  use check, only: suite_type
  implicit none
  real(DP), parameter :: MODULI(2) = [400.0_DP, 900.0_DP], G = MODULI(1), K = MODULI(2), E_OLD = 0.01_DP
  ! Trial stresses: shear, near compression, triaxial extension and compression, unordered, tension, tension in all directions.
  real(DP), parameter :: TRIALS(3, 8) = reshape([20.0_DP, -3.0_DP, -25.0_DP, -5.0_DP, -7.0_DP, -50.0_DP, &
    15.0_DP, -9.0_DP, -9.0_DP, -8.0_DP, -8.0_DP, -60.0_DP, -40.0_DP, -2.0_DP, -15.0_DP, 40.0_DP, 4.0_DP, 1.0_DP, &
    80.0_DP, 70.0_DP, 65.0_DP, 50.0_DP, 50.0_DP, 50.0_DP], [3, 8])
  type(suite_type) :: suite
  integer :: i, test
  do i = 1, size(TRIALS, 2)
    do test = CONE_COMPRESSION, CONE_SHEAR
      call check_round(TRIALS(:, i), test, 30.0_DP, 10.0_DP)
      call check_round(TRIALS(:, i), test, 30.0_DP, 0.0_DP)
      call check_law(cone(0.8_DP, test, 30.0_DP, 10.0_DP, 50.0_DP), TRIALS(:, i), 'K')
    end do
    call check_law(cone(0.778_DP, CONE_SHEAR, 30.0_DP, 30.0_DP, -20.0_DP), TRIALS(:, i), 'K, softening')
    call check_law(cone(0.9_DP, CONE_TENSION, 30.0_DP, 0.0_DP, 0.0_DP), TRIALS(:, i), 'K, no dilation')
    call check_law(pyramid(30.0_DP, 10.0_DP, 50.0_DP, 0.1_DP), TRIALS(:, i), 'Mohr-Coulomb')
    call check_law(pyramid(35.0_DP, 35.0_DP, 0.0_DP, 0.1_DP), TRIALS(:, i), 'Mohr-Coulomb, full dilation')
    call check_law(pyramid(30.0_DP, 0.0_DP, 20.0_DP, 0.1_DP), TRIALS(:, i), 'Mohr-Coulomb, no dilation')
    call check_law(pyramid(30.0_DP, 10.0_DP, -5.0_DP, 0.0_DP), TRIALS(:, i), 'Mohr-Coulomb, straight potential, softening')
    if (i < 8) call check_law(pyramid(0.0_DP, 0.0_DP, 30.0_DP, 0.1_DP), TRIALS(:, i), 'Tresca')
  end do
  call check_elastic()
  call check_steep_softening()
  call suite%finish()

contains

  !> A cone with K and linear hardening from 10 on.
  function cone(ratio, hardening, friction, dilation, slope) result(material)
    real(DP), intent(in) :: ratio
    integer, intent(in) :: hardening               !< CONE_...
    real(DP), intent(in) :: friction, dilation     !< [degree]
    real(DP), intent(in) :: slope                  !< [stress]
    type(material_type) :: material
    material%yield_surface = YIELD_RATIO
    material%cone = property_table_type([0.0_DP], reshape([PI / 180 * friction, PI / 180 * dilation, ratio], [3, 1]))
    material%cone_hardening = hardening
    allocate (material%isotropic_hardening(1))
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.5_DP], [10.0_DP, 10 + 0.5_DP * slope])
  end function cone


  !> Mohr and Coulomb's law with linear hardening from 10 on.
  function pyramid(friction, dilation, slope, eccentricity) result(material)
    real(DP), intent(in) :: friction, dilation     !< [degree]
    real(DP), intent(in) :: slope                  !< [stress]
    real(DP), intent(in) :: eccentricity           !< [-]
    type(material_type) :: material
    real(DP) :: s
    material = cone(1.0_DP, CONE_COMPRESSION, friction, dilation, slope)
    material%yield_surface = YIELD_MOHR_COULOMB
    s = sin(PI / 180 * friction)
    material%cone%value = reshape([PI / 180 * friction, PI / 180 * dilation, (3 - s) / (3 + s), eccentricity], [4, 1])
  end function pyramid


  !> The yield condition in principal stresses, from its definition.
  real(DP) function excess(material, tau, e) result(f)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: tau(3), e
    real(DP) :: d, p, q, s(3), t
    associate (curve => material%isotropic_hardening(1), angle => material%cone%value(1, 1), ratio => material%cone%value(3, 1))
      d = curve%stress(1) + e * (curve%stress(2) - curve%stress(1)) / curve%strain(2)
      if (material%yield_surface == YIELD_MOHR_COULOMB) then
        f = 0.5_DP * (maxval(tau) - minval(tau)) + 0.5_DP * (maxval(tau) + minval(tau)) * sin(angle) - d * cos(angle)
        return
      end if
      p = -sum(tau) / 3
      s = tau + p
      q = sqrt(1.5_DP) * norm2(s)
      t = 0
      if (q > 0) t = 0.5_DP * q * (1 + 1 / ratio - (1 - 1 / ratio) * 13.5_DP * product(s) / q**3)
      select case (material%cone_hardening)
      case (CONE_COMPRESSION)
        d = d * (1 - tan(angle) / 3)
      case (CONE_TENSION)
        d = d * (1 / ratio + tan(angle) / 3)
      case default
        d = d * sqrt(3.0_DP) / 2 * (1 + 1 / ratio)
      end select
      f = t - p * tan(angle) - d
    end associate
  end function excess


  !> Yield, elasticity, plastic work of Mohr-Coulomb, slopes and secants.
  subroutine check_law(material, trial, name)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: trial(3)               !< [stress]
    character(*), intent(in) :: name
    real(DP), parameter :: STEP = 1.0e-8_DP
    type(principal_return_type) :: back, plus, minus
    real(DP) :: strain(3), slope(3), stress(3), change
    integer :: status, i, j
    call map_principal_return(material, MODULI, trial, 0.0_DP, E_OLD, back, status)
    call suite%that(name // ': status', status == RETURN_OK)
    if (excess(material, trial, E_OLD) < 0) then
      call suite%that(name // ': elastic', .not. (back%plastic > 0 .or. norm2(back%flow) > 0))
      return
    end if
    call suite%that(name // ': yields', back%plastic > 0)
    call suite%near(name // ': yield', excess(material, back%tau, E_OLD + back%plastic), 0.0_DP, 1e-9_DP)
    call suite%near(name // ': elasticity', norm2(trial - elastic(back%flow) - back%tau), 0.0_DP, 1e-9_DP)
    if (material%yield_surface == YIELD_MOHR_COULOMB) call suite%near(name // ': work', dot_product(back%tau, back%flow), &
      back%plastic * (material%isotropic_hardening(1)%stress(1) + (E_OLD + back%plastic) / 0.5_DP * &
      (material%isotropic_hardening(1)%stress(2) - material%isotropic_hardening(1)%stress(1))), 1e-9_DP)
    if (.not. maxval(trial) - minval(trial) > 0) return    ! the sections are no smooth functions there
    do i = 1, 3
      strain = merge(STEP, 0.0_DP, [1, 2, 3] == i)
      call map_principal_return(material, MODULI, trial + elastic(strain), 0.0_DP, E_OLD, plus, status)
      call map_principal_return(material, MODULI, trial - elastic(strain), 0.0_DP, E_OLD, minus, status)
      slope = (plus%tau - minus%tau) / (2 * STEP)
      if (.not. has_corner(material, trial, i)) call suite%near(name // ': slope', norm2(slope - back%slope(:, i)) / K, 0.0_DP, &
        1e-5_DP)
      j = modulo(i, 3) + 1
      stress = trial
      if (abs(trial(i) - trial(j)) > 0) then
        call suite%near(name // ': secant', back%secant(i) * (trial(i) - trial(j)) / (2 * G), back%tau(i) - back%tau(j), 1e-9_DP)
      else                                         ! the limit of unequal strains
        change = 1.0e-4_DP
        stress(i) = stress(i) + change
        call map_principal_return(material, MODULI, stress, 0.0_DP, E_OLD, plus, status)
        call suite%near(name // ': secant of equal strains', back%secant(i) / G, &
          2 * (plus%tau(i) - plus%tau(j)) / change, 1e-3_DP)
      end if
    end do
  end subroutine check_law


  !> Whether a change of strain i crosses a corner of Mohr and Coulomb's hexagon.
  logical function has_corner(material, trial, i)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: trial(3)
    integer, intent(in) :: i
    has_corner = material%yield_surface == YIELD_MOHR_COULOMB .and. &
      count(abs(trial - trial(i)) <= 0) + count(abs(trial - cshift(trial, 1)) <= 0) > 1
  end function has_corner


  !> Hooke's law in principal values.
  function elastic(strain) result(stress)
    real(DP), intent(in) :: strain(3)
    real(DP) :: stress(3)
    stress = 2 * G * strain + (K - 2 * G / 3) * sum(strain)
  end function elastic


  !> K = 1 gives the stress, the plastic strain and the slopes of the round cone.
  subroutine check_round(trial, hardening, friction, dilation)
    real(DP), intent(in) :: trial(3)
    integer, intent(in) :: hardening
    real(DP), intent(in) :: friction, dilation     !< [degree]
    type(principal_return_type) :: back
    type(return_mapping_type) :: round
    real(DP) :: p, q, s(3), stress(3)
    integer :: status
    call map_principal_return(cone(1.0_DP, hardening, friction, dilation, 50.0_DP), MODULI, trial, 0.0_DP, E_OLD, back, status)
    p = -sum(trial) / 3
    s = trial + p
    q = sqrt(1.5_DP) * norm2(s)
    call map_cone_return(cone(1.0_DP, hardening, friction, dilation, 50.0_DP), MODULI, [q, p], 0.0_DP, E_OLD, round, status)
    stress = round%ratio * s - p - K * round%expansion
    call suite%near('round: stress', norm2(back%tau - stress), 0.0_DP, 1e-10_DP)
    call suite%near('round: plastic strain', back%plastic, round%plastic, 1e-13_DP)
    call suite%near('round: dp/dp', sum(back%slope) / (9 * K), round%dp_dp, 1e-12_DP)
    if (q > 0) call suite%near('round: dq/dq', dot_product(s, matmul(back%slope, s)) / (2 * G * sum(s**2)), round%slope, 1e-12_DP)
    if (q > 0) call suite%near('round: secant', back%secant(1) * (trial(1) - trial(2)), 2 * G * round%ratio * &
      (trial(1) - trial(2)), 1e-9_DP)
  end subroutine check_round


  !> Within the surface nothing happens.
  subroutine check_elastic()
    type(principal_return_type) :: back
    integer :: status
    call map_principal_return(cone(0.8_DP, CONE_COMPRESSION, 30.0_DP, 10.0_DP, 0.0_DP), MODULI, [-20.0_DP, -22.0_DP, -28.0_DP], &
      0.0_DP, 0.0_DP, back, status)
    call suite%that('elastic', status == RETURN_OK .and. .not. back%plastic > 0 .and. .not. norm2(back%flow) > 0)
  end subroutine check_elastic


  !> Softening that is steeper than the elastic unloading has no solution.
  subroutine check_steep_softening()
    type(principal_return_type) :: back
    type(material_type) :: material
    integer :: status
    material = cone(0.8_DP, CONE_COMPRESSION, 30.0_DP, 10.0_DP, 0.0_DP)
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.001_DP], [10.0_DP, 1.0_DP])
    call map_principal_return(material, MODULI, [0.0_DP, 0.0_DP, -12.0_DP], 0.0_DP, 0.0_DP, back, status)
    call suite%that('steep softening', status == RETURN_FAILED)
  end subroutine check_steep_softening

end program test_lode_angle_return
