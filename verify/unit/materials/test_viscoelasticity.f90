!> Unit test of amontons_viscoelasticity: relaxation and ramps in closed form, limits, and the tangents by differences.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_viscoelasticity
  use amontons_kinds, only: DP
  use amontons_elasticity, only: hooke_stress, isotropic_tangent
  use amontons_hyperelasticity, only: principal_response_type, evaluate_rubber
  use amontons_logarithmic_strain, only: principal_strains_type, find_principal_strains, left_cauchy_green, &
    tensor_from_principal, principal_tangent
  use amontons_materials, only: HYPER_POLYNOMIAL
  use amontons_tensor, only: IDENTITY, determinant_minus_one, pack_voigt, unpack_voigt
  use amontons_viscoelasticity, only: viscoelastic_stress, relax_finite_stress, n_viscoelastic_state
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: PRONY(3, 2) = reshape([0.3_DP, 0.2_DP, 0.5_DP, 0.4_DP, 0.1_DP, 7.0_DP], [3, 2])
  real(DP), parameter :: LAME(2) = [120.0_DP, 80.0_DP]
  real(DP), parameter :: STRAIN(6) = [0.01_DP, -0.02_DP, 0.015_DP, 0.004_DP, -0.006_DP, 0.008_DP]
  call check_relaxation()
  call check_ramp()
  call check_limits()
  call check_finite()
  call suite%finish()

contains

  !> A strain at once, then held for many unequal increments: s = s0 (1 - sum g (1 - exp(-t/tau))), exactly.
  subroutine check_relaxation()
    real(DP) :: state(n_viscoelastic_state(2)), stress(6), tangent(6, 6), energy, s0(6), m0, t, expected(6), lasting(2), before
    integer :: i
    state = 0
    s0 = hooke_stress(LAME(1), LAME(2), STRAIN)
    call viscoelastic_stress(PRONY, LAME, 0.0_DP, STRAIN, state, stress, tangent, energy)
    call suite%near('at once', norm2(stress - s0), 0.0_DP, 1.0e-14_DP)
    call suite%near('modulus at once', norm2(tangent - isotropic_tangent(LAME(1), LAME(2))), 0.0_DP, 1.0e-12_DP)
    call suite%near('energy at once', energy, 0.5_DP * dot_product(stress, [STRAIN(:3), 2 * STRAIN(4:)]), 1.0e-14_DP)
    m0 = sum(s0(:3)) / 3
    t = 0
    do i = 1, 8
      before = energy
      call viscoelastic_stress(PRONY, LAME, 0.1_DP * 2.0_DP**i, STRAIN, state, stress, tangent, energy)
      t = t + 0.1_DP * 2.0_DP**i
      lasting = [1 - sum(PRONY(1, :) * (1 - exp(-t / PRONY(3, :)))), 1 - sum(PRONY(2, :) * (1 - exp(-t / PRONY(3, :))))]
      expected = lasting(1) * s0
      expected(:3) = expected(:3) + (lasting(2) - lasting(1)) * m0
      call suite%near('relaxation', norm2(stress - expected), 0.0_DP, 1.0e-13_DP)
      call suite%that('the springs lose energy', energy < before)
    end do
  end subroutine check_relaxation


  !> A strain that grows in proportion to time, in three increments: the integral of the relaxation modulus, exactly.
  subroutine check_ramp()
    real(DP), parameter :: TIMES(0:3) = [0.0_DP, 0.4_DP, 1.0_DP, 5.0_DP]
    real(DP) :: state(n_viscoelastic_state(2)), stress(6), tangent(6, 6), energy, s0(6), m0, lasting(2), expected(6)
    integer :: i
    state = 0
    s0 = hooke_stress(LAME(1), LAME(2), STRAIN)
    m0 = sum(s0(:3)) / 3
    do i = 1, 3
      call viscoelastic_stress(PRONY, LAME, TIMES(i) - TIMES(i - 1), TIMES(i) * STRAIN, state, stress, tangent, energy)
      associate (t => TIMES(i))
        lasting(1) = t - sum(PRONY(1, :) * (t - PRONY(3, :) * (1 - exp(-t / PRONY(3, :)))))
        lasting(2) = t - sum(PRONY(2, :) * (t - PRONY(3, :) * (1 - exp(-t / PRONY(3, :)))))
      end associate
      expected = lasting(1) * s0
      expected(:3) = expected(:3) + (lasting(2) - lasting(1)) * m0
      call suite%near('ramp', norm2(stress - expected), 0.0_DP, 1.0e-12_DP)
    end do
  end subroutine check_ramp


  !> A huge increment leaves the long-term modulus; the tangent is the difference of stresses, for the law is linear.
  subroutine check_limits()
    real(DP) :: state(n_viscoelastic_state(2)), stress(6), tangent(6, 6), energy, G, K, other(6), unused(6, 6)
    state = 0
    call viscoelastic_stress(PRONY, LAME, huge(1.0_DP), STRAIN, state, stress, tangent, energy)
    G = 0.3_DP * LAME(2)
    K = 0.7_DP * (LAME(1) + 2 * LAME(2) / 3)
    call suite%near('long-term', norm2(stress - hooke_stress(K - 2 * G / 3, G, STRAIN)), 0.0_DP, 1.0e-12_DP)
    state = 1
    call viscoelastic_stress(PRONY, LAME, 0.7_DP, STRAIN, state, stress, tangent, energy)
    state = 1
    call viscoelastic_stress(PRONY, LAME, 0.7_DP, 2 * STRAIN, state, other, unused, energy)
    call suite%near('tangent', norm2(other - stress - matmul(tangent, [STRAIN(:3), 2 * STRAIN(4:)])), 0.0_DP, 1.0e-12_DP)
  end subroutine check_limits


  !> The Kirchhoff stress and spatial tangent of Mooney's rubber at once.
  subroutine rubber(H, tau, tangent)
    real(DP), intent(in) :: H(3, 3)
    real(DP), intent(out) :: tau(6), tangent(6, 6)
    type(principal_strains_type) :: principal
    type(principal_response_type) :: response
    logical :: is_positive
    call find_principal_strains(left_cauchy_green(H), principal, is_positive)
    call evaluate_rubber(HYPER_POLYNOMIAL, 1, [30.0_DP, 10.0_DP, 0.01_DP], principal%e, response)
    tau = tensor_from_principal(principal, response%tau)
    tangent = principal_tangent(principal, response%tau, response%slope, response%secant)
  end subroutine rubber


  !> Stress after a first deformation at once, and a second in an increment.
  subroutine relaxed(second, dt, stress, tangent)
    real(DP), intent(in) :: second(3, 3), dt
    real(DP), intent(out) :: stress(6), tangent(6, 6)
    real(DP), parameter :: FIRST(3, 3) = reshape([0.3_DP, 0.1_DP, 0.0_DP, -0.2_DP, -0.1_DP, 0.1_DP, 0.2_DP, 0.0_DP, 0.1_DP], [3, 3])
    real(DP) :: state(n_viscoelastic_state(2))
    state = 0
    call rubber(FIRST, stress, tangent)
    call relax_finite_stress(PRONY, 0.0_DP, FIRST, state, stress, tangent)
    call rubber(second, stress, tangent)
    call relax_finite_stress(PRONY, dt, second, state, stress, tangent)
  end subroutine relaxed


  !> Instantaneous and long-term stress, a rotation that turns the relaxed stress, and the tangent: the Lie derivative of the stress
  !! along a velocity gradient.
  subroutine check_finite()
    real(DP), parameter :: SECOND(3, 3) = reshape([0.5_DP, -0.1_DP, 0.2_DP, 0.3_DP, 0.2_DP, 0.1_DP, -0.2_DP, 0.1_DP, -0.2_DP], &
      [3, 3]), STEP = 1.0e-6_DP
    real(DP), parameter :: TURN(3, 3) = reshape([0.6_DP, 0.8_DP, 0.0_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    real(DP) :: stress(6), tangent(6, 6), plus(6), minus(6), unused(6, 6), l(3, 3), T(3, 3), d(6), tau(6), m
    integer :: i, j
    call rubber(SECOND, tau, tangent)
    call relaxed(SECOND, 0.0_DP, stress, unused)
    call suite%near('at once', norm2(stress - tau), 0.0_DP, 1.0e-12_DP * norm2(tau))
    call suite%near('its tangent', norm2(tangent - unused), 0.0_DP, 1.0e-12_DP * norm2(tangent))
    call relaxed(SECOND, huge(1.0_DP), stress, tangent)
    m = sum(tau(:3)) / 3
    tau(:3) = tau(:3) - m
    tau = 0.3_DP * tau
    tau(:3) = tau(:3) + 0.7_DP * m
    call suite%near('long-term', norm2(stress - tau), 0.0_DP, 1.0e-12_DP * norm2(tau))
    call relaxed(SECOND, 0.6_DP, stress, tangent)
    call relaxed(matmul(TURN, IDENTITY + SECOND) - IDENTITY, 0.6_DP, plus, unused)
    call suite%near('turned', norm2(plus - pack_voigt(matmul(TURN, matmul(unpack_voigt(stress), transpose(TURN))))), 0.0_DP, &
      1.0e-11_DP * norm2(stress))
    T = unpack_voigt(stress)
    do i = 1, 3
      do j = 1, 3
        l = 0
        l(i, j) = 1
        call relaxed(SECOND + STEP * matmul(l, IDENTITY + SECOND), 0.6_DP, plus, unused)
        call relaxed(SECOND - STEP * matmul(l, IDENTITY + SECOND), 0.6_DP, minus, unused)
        d = pack_voigt(0.5_DP * (l + transpose(l)))
        d(4:) = 2 * d(4:)
        call suite%near('tangent', norm2((plus - minus) / (2 * STEP) - pack_voigt(matmul(l, T) + matmul(T, transpose(l))) &
          - matmul(tangent, d)), 0.0_DP, 1.0e-7_DP * norm2(tangent))
      end do
    end do
    call suite%near('symmetric', norm2(tangent - transpose(tangent)), 0.0_DP, 1.0e-12_DP * norm2(tangent))
    call suite%that('a volume', determinant_minus_one(SECOND) > -1)
  end subroutine check_finite

end program test_viscoelasticity
