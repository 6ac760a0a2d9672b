!> Unit test of amontons_corotational_elasticity: the stress of a known stretch, the tangent by differences, and bounds.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_corotational_elasticity
  use amontons_kinds, only: DP
  use amontons_corotational_elasticity, only: corotational_stress
  use amontons_elasticity, only: isotropic_tangent, STRESS_OK, STRESS_INVERTED
  use amontons_tensor, only: pack_voigt, double_dot
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: EQUAL(6) = [0.1_DP, 0.1_DP, 0.1_DP, 0.0_DP, 0.0_DP, 0.0_DP]
  real(DP), parameter :: GENERAL(6) = [0.2_DP, -0.1_DP, 0.05_DP, 0.03_DP, -0.06_DP, 0.04_DP]
  real(DP) :: C(6, 6)
  C = isotropic_tangent(120.0_DP, 80.0_DP)
  call check_stretch()
  call check_tangent(C, EQUAL)
  call check_tangent(C, GENERAL)
  C(1, 1) = 400
  C(4, 4) = 30
  call check_tangent(C, GENERAL)
  call check_bound()
  call suite%finish()

contains

  !> E = (U U - 1)/2 of a given U.
  subroutine check_stretch()
    real(DP), parameter :: U(3, 3) = reshape([1.2_DP, 0.1_DP, 0.0_DP, 0.1_DP, 0.9_DP, -0.2_DP, 0.0_DP, -0.2_DP, 1.1_DP], [3, 3])
    real(DP) :: unit(3, 3), stress(6), tangent(6, 6), energy, expected(6)
    integer :: status
    unit = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    call corotational_stress(C, pack_voigt(0.5_DP * (matmul(U, U) - unit)), stress, tangent, energy, status)
    expected = pack_voigt(160 * (U - unit))
    expected(:3) = expected(:3) + 120 * 0.2_DP
    call suite%near('stress', norm2(stress - expected), 0.0_DP, 1.0e-12_DP * norm2(expected))
    call suite%near('energy', energy, 0.5_DP * double_dot(expected, pack_voigt(U - unit)), 1.0e-12_DP * energy)
  end subroutine check_stretch


  !> Central differences.
  subroutine check_tangent(C, at)
    real(DP), intent(in) :: C(6, 6), at(6)
    real(DP), parameter :: STEP = 1.0e-6_DP
    real(DP) :: stress(6), tangent(6, 6), plus(6), minus(6), unused(6, 6), energy, de(6)
    integer :: k, status
    call corotational_stress(C, at, stress, tangent, energy, status)
    call suite%that('it is a deformation', status == STRESS_OK)
    do k = 1, 6
      de = 0
      de(k) = merge(STEP, 0.5_DP * STEP, k <= 3)   ! engineering shears
      call corotational_stress(C, at + de, plus, unused, energy, status)
      call corotational_stress(C, at - de, minus, unused, energy, status)
      call suite%near('tangent', norm2(tangent(:, k) - (plus - minus) / (2 * STEP)), 0.0_DP, 1.0e-8_DP * norm2(C))
    end do
  end subroutine check_tangent


  !> A strain that no deformation has.
  subroutine check_bound()
    real(DP) :: stress(6), tangent(6, 6), energy
    integer :: status
    call corotational_stress(C, [0.0_DP, -0.51_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], stress, tangent, energy, status)
    call suite%that('inside out', status == STRESS_INVERTED)
  end subroutine check_bound

end program test_corotational_elasticity
