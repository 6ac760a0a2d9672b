!> Unit test of amontons_one_sided_elasticity: stresses and slopes by differences of the energy, secants, and the limits on both
!! sides.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_one_sided_elasticity
  use amontons_kinds, only: DP, PI
  use amontons_hyperelasticity, only: principal_response_type
  use amontons_materials, only: ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY
  use amontons_one_sided_elasticity, only: one_sided_stress, evaluate_one_sided
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: KINDS(2) = [ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY]
  character(16), parameter :: NAMES(2) = [character(16) :: 'tension only', 'compression only']
  real(DP), parameter :: E = 1000, S0 = 2, W = PI * S0 / E
  real(DP), parameter :: STRAINS(3, 4) = reshape([0.02_DP, -0.013_DP, 0.004_DP, 1.0e-3_DP, -2.0e-3_DP, 0.0_DP, &
    0.3_DP, 0.1_DP, 0.2_DP, -0.3_DP, -0.1_DP, -0.2_DP], [3, 4])
  integer :: law, i
  do law = 1, 2
    do i = 1, 4
      call check_derivatives(law, STRAINS(:, i))
      call check_secants(law, STRAINS(:, i))
      call check_tensor(law, STRAINS(:, i))
    end do
    call check_secants(law, [0.01_DP, 0.01_DP, 0.01_DP + 1.0e-9_DP])
    call check_equal_strains(law)
  end do
  call check_limits()
  call suite%finish()

contains

  !> tau = dW/de and slope = d tau/de by central differences.
  subroutine check_derivatives(law, at)
    integer, intent(in) :: law
    real(DP), intent(in) :: at(3)
    type(principal_response_type) :: r, plus, minus
    real(DP) :: de(3)
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: k
    call evaluate_one_sided(KINDS(law), [E, S0], at, r)
    do k = 1, 3
      de = 0
      de(k) = STEP
      call evaluate_one_sided(KINDS(law), [E, S0], at + de, plus)
      call evaluate_one_sided(KINDS(law), [E, S0], at - de, minus)
      call suite%near(NAMES(law) // ': stress', r%tau(k), (plus%energy - minus%energy) / (2 * STEP), 1.0e-6_DP * E)
      call suite%near(NAMES(law) // ': slope', norm2(r%slope(:, k) - (plus%tau - minus%tau) / (2 * STEP)), 0.0_DP, 1.0e-6_DP * E)
    end do
  end subroutine check_derivatives


  !> The secants are the quotients.
  subroutine check_secants(law, at)
    integer, intent(in) :: law
    real(DP), intent(in) :: at(3)
    type(principal_response_type) :: r
    integer, parameter :: NEXT(3) = [2, 3, 1]
    integer :: A, B
    call evaluate_one_sided(KINDS(law), [E, S0], at, r)
    do A = 1, 3
      B = NEXT(A)
      if (abs(at(A) - at(B)) > 0) call suite%near(NAMES(law) // ': secant', r%secant(A), &
        (r%tau(A) - r%tau(B)) / (at(A) - at(B)), 1.0e-5_DP * E)
    end do
  end subroutine check_secants


  !> Of equal strains the secants are the slope.
  subroutine check_equal_strains(law)
    integer, intent(in) :: law
    type(principal_response_type) :: r
    call evaluate_one_sided(KINDS(law), [E, S0], [W, W, W], r)
    call suite%near(NAMES(law) // ': secant of equal strains', norm2(r%secant - r%slope(1, 1)), 0.0_DP, 1.0e-12_DP * E)
  end subroutine check_equal_strains


  !> The tangent of a strain that has shears, by differences of the stress.
  subroutine check_tensor(law, principal)
    integer, intent(in) :: law
    real(DP), intent(in) :: principal(3)
    real(DP) :: strain(6), de(6), stress(6), plus(6), minus(6), tangent(6, 6), unused(6, 6), energy
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: k
    strain = [principal, 0.004_DP, -0.006_DP, 0.002_DP]
    call one_sided_stress(KINDS(law), [E, S0], strain, stress, tangent, energy)
    call suite%near(NAMES(law) // ': the tangent is symmetric', norm2(tangent - transpose(tangent)), 0.0_DP, 1.0e-11_DP * E)
    do k = 1, 6
      de = 0
      de(k) = merge(STEP, 0.5_DP * STEP, k <= 3)   ! engineering shears
      call one_sided_stress(KINDS(law), [E, S0], strain + de, plus, unused, energy)
      call one_sided_stress(KINDS(law), [E, S0], strain - de, minus, unused, energy)
      call suite%near(NAMES(law) // ': tangent', norm2(tangent(:, k) - (plus - minus) / (2 * STEP)), 0.0_DP, 1.0e-5_DP * E)
    end do
  end subroutine check_tensor


  !> Far on one side E e, far on the other -s0, at zero strain half of E; compression only mirrors tension only.
  subroutine check_limits()
    type(principal_response_type) :: tension, compression
    real(DP), parameter :: FAR = 1.0e6_DP * W
    call evaluate_one_sided(ELASTIC_TENSION_ONLY, [E, S0], [FAR, -FAR, 0.0_DP], tension)
    call suite%near('tension', tension%tau(1), E * FAR, 1.001_DP * S0)
    call suite%near('the other side', tension%tau(2), -S0, 1.0e-6_DP * S0)
    call suite%near('at rest', tension%slope(3, 3), 0.5_DP * E, 1.0e-12_DP * E)
    call evaluate_one_sided(ELASTIC_COMPRESSION_ONLY, [E, S0], [-FAR, FAR, 0.0_DP], compression)
    call suite%near('mirrored', norm2(tension%tau + compression%tau), 0.0_DP, 1.0e-12_DP * E * FAR)
    call suite%near('energy', compression%energy, tension%energy, 1.0e-12_DP * tension%energy)
  end subroutine check_limits

end program test_one_sided_elasticity
