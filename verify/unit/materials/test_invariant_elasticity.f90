!> Unit test of amontons_invariant_elasticity: stress and tangent by differences of the energy, Hooke's law at small strain, turned
!! axes, fibres that are pressed, and deformations that have no stress.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_invariant_elasticity
  use amontons_kinds, only: DP
  use amontons_elasticity, only: hooke_stress, isotropic_tangent, STRESS_OK, STRESS_INVERTED, STRESS_NOT_FINITE
  use amontons_invariant_elasticity, only: invariant_law_stress, invariant_law_at_rest
  use amontons_materials, only: ELASTIC_CIARLET, ELASTIC_FIBRES
  use amontons_tensor, only: IDENTITY, pack_voigt, unpack_voigt
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: CIARLET(2) = [1000.0_DP, 0.3_DP]
  real(DP), parameter :: FIBRES(10) = [2.0_DP, 0.03_DP, 0.0_DP, 0.7_DP, 3.0_DP, 0.8_DP, 0.6_DP, -0.5_DP, 2.0_DP, 0.0_DP]
  real(DP), parameter :: STRAINS(6, 3) = reshape([0.2_DP, -0.1_DP, 0.05_DP, 0.03_DP, -0.06_DP, 0.04_DP, &
    -0.2_DP, 0.3_DP, 0.4_DP, 0.1_DP, 0.2_DP, -0.05_DP, 1.0_DP, 2.0_DP, 0.5_DP, -0.3_DP, 0.2_DP, 0.4_DP], [6, 3])
  integer :: i
  do i = 1, 3
    call check_derivatives(ELASTIC_CIARLET, CIARLET, STRAINS(:, i))
    call check_derivatives(ELASTIC_FIBRES, FIBRES, STRAINS(:, i))
    call check_axes(STRAINS(:, i))
  end do
  call check_small_strain(ELASTIC_CIARLET, CIARLET)
  call check_small_strain(ELASTIC_FIBRES, FIBRES(:2))
  call check_fibres()
  call check_status()
  call suite%finish()

contains

  !> S = dU/dE and its derivative by central differences; the tangent is symmetric.
  subroutine check_derivatives(kind, constants, at)
    integer, intent(in) :: kind
    real(DP), intent(in) :: constants(:), at(6)
    real(DP) :: S(6), C(6, 6), U, plus(6), minus(6), unused(6, 6), U_plus, U_minus, de(6)
    real(DP), parameter :: STEP = 1.0e-6_DP
    integer :: k, status
    call invariant_law_stress(kind, constants, IDENTITY, at, S, C, U, status)
    call suite%that('it is a deformation', status == STRESS_OK)
    call suite%near('symmetric', norm2(C - transpose(C)), 0.0_DP, 1.0e-12_DP * norm2(C))
    do k = 1, 6
      de = 0
      de(k) = merge(STEP, 0.5_DP * STEP, k <= 3)   ! engineering shears
      call invariant_law_stress(kind, constants, IDENTITY, at + de, plus, unused, U_plus, status)
      call invariant_law_stress(kind, constants, IDENTITY, at - de, minus, unused, U_minus, status)
      call suite%near('stress', S(k), (U_plus - U_minus) / (2 * STEP), 1.0e-7_DP * norm2(S) + 1.0e-9_DP * norm2(C))
      call suite%near('tangent', norm2(C(:, k) - (plus - minus) / (2 * STEP)), 0.0_DP, 1.0e-7_DP * norm2(C))
    end do
  end subroutine check_derivatives


  !> In turned axes of the material the stress turns with the strain.
  subroutine check_axes(strain)
    real(DP), intent(in) :: strain(6)
    real(DP), parameter :: Q(3, 3) = reshape([0.6_DP, 0.8_DP, 0.0_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    real(DP) :: S(6), S_turned(6), C(6, 6), U, U_turned
    integer :: status
    call invariant_law_stress(ELASTIC_FIBRES, FIBRES, IDENTITY, strain, S, C, U, status)
    call invariant_law_stress(ELASTIC_FIBRES, FIBRES, Q, pack_voigt(matmul(Q, matmul(unpack_voigt(strain), transpose(Q)))), &
      S_turned, C, U_turned, status)
    call suite%near('energy in turned axes', U_turned, U, 1.0e-12_DP * U)
    call suite%near('stress in turned axes', norm2(S_turned - pack_voigt(matmul(Q, matmul(unpack_voigt(S), transpose(Q))))), &
      0.0_DP, 1.0e-12_DP * norm2(S))
  end subroutine check_axes


  !> Hooke's law with Lame's constants at rest, to the last digits of a strain of 1e-9.
  subroutine check_small_strain(kind, constants)
    integer, intent(in) :: kind
    real(DP), intent(in) :: constants(:)
    real(DP), parameter :: STRAIN(6) = 1.0e-9_DP * [1.0_DP, -3.0_DP, 2.0_DP, 0.5_DP, -1.5_DP, 0.25_DP]
    real(DP) :: S(6), C(6, 6), U, lambda, G
    integer :: status
    call invariant_law_at_rest(kind, constants, lambda, G)
    call invariant_law_stress(kind, constants, IDENTITY, STRAIN, S, C, U, status)
    call suite%near('Hooke', norm2(S - hooke_stress(lambda, G, STRAIN)), 0.0_DP, 1.0e-7_DP * norm2(S))
    call suite%near('modulus', norm2(C - isotropic_tangent(lambda, G)), 0.0_DP, 1.0e-7_DP * norm2(C))
  end subroutine check_small_strain


  !> A fibre along x that is pressed adds nothing; stretched it adds stress along x.
  subroutine check_fibres()
    real(DP), parameter :: FIBRE(6) = [2.0_DP, 0.03_DP, 1.0_DP, 0.0_DP, 3.0_DP, 0.8_DP]
    real(DP) :: S(6), bare(6), C(6, 6), C_bare(6, 6), U, U_bare, strain(6)
    integer :: status
    strain = [-0.1_DP, 0.05_DP, 0.05_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    call invariant_law_stress(ELASTIC_FIBRES, FIBRE, IDENTITY, strain, S, C, U, status)
    call invariant_law_stress(ELASTIC_FIBRES, FIBRE(:2), IDENTITY, strain, bare, C_bare, U_bare, status)
    call suite%that('pressed', norm2(S - bare) <= 0 .and. norm2(C - C_bare) <= 0 .and. abs(U - U_bare) <= 0)
    call invariant_law_stress(ELASTIC_FIBRES, FIBRE, IDENTITY, -strain, S, C, U, status)
    call invariant_law_stress(ELASTIC_FIBRES, FIBRE(:2), IDENTITY, -strain, bare, C_bare, U_bare, status)
    call suite%that('stretched', S(1) > bare(1) .and. C(1, 1) > C_bare(1, 1) .and. U > U_bare)
  end subroutine check_fibres


  !> Strains that no deformation has, and a fibre stretched beyond what numbers hold.
  subroutine check_status()
    real(DP), parameter :: SQUASHED(6) = [-0.6_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    real(DP), parameter :: SQUASHED_TWICE(6) = [-0.6_DP, -0.6_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]   ! det C is positive
    real(DP) :: S(6), C(6, 6), U
    integer :: status
    call invariant_law_stress(ELASTIC_CIARLET, CIARLET, IDENTITY, SQUASHED, S, C, U, status)
    call suite%that('inside out', status == STRESS_INVERTED)
    call invariant_law_stress(ELASTIC_CIARLET, CIARLET, IDENTITY, SQUASHED_TWICE, S, C, U, status)
    call suite%that('inside out twice', status == STRESS_INVERTED)
    call invariant_law_stress(ELASTIC_FIBRES, [2.0_DP, 0.03_DP, 1.0_DP, 0.0_DP, 3.0_DP, 1.0e3_DP], IDENTITY, &
      [5.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], S, C, U, status)
    call suite%that('beyond all bounds', status == STRESS_NOT_FINITE)
  end subroutine check_status

end program test_invariant_elasticity
