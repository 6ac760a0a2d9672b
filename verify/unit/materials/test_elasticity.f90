!> Unit test of amontons_elasticity: closed forms, objectivity, energy and tangent by differences, tiny strains, exits.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_elasticity
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_elasticity, only: small_strain_stress, finite_strain_stress, kirchhoff_stress, lame_constants, &
    gradient_without_swelling, STRESS_OK, STRESS_INVERTED, STRESS_NOT_FINITE
  use amontons_logarithmic_strain, only: log1p
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, pack_voigt, unpack_voigt, double_dot
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(material_type) :: material
  real(DP) :: lambda, G
  integer :: n, i

  call random_seed(size=n)
  call random_seed(put=[(104729 * i, i=1, n)])
  material%youngs_modulus = 7
  material%poissons_ratio = 0.3_DP
  call lame_constants(material%youngs_modulus, material%poissons_ratio, lambda, G)
  call check_small()
  call check_logarithm()
  call check_swelling()
  call check_hencky_closed_forms()
  call check_saint_venant_closed_forms()
  do i = LAW_HENCKY, LAW_SAINT_VENANT
    material%law = i
    call check_derivatives_of_many()
    call check_objectivity()
    call check_small_limit()
    call check_exits()
  end do
  call suite%finish()

contains

  subroutine check_small()
    real(DP) :: stress(6), tangent(6, 6), energy, strain(6), gamma(6)
    strain = [0.01_DP, -0.003_DP, -0.003_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    call small_strain_stress(material, strain, stress, tangent, energy)
    call suite%near('tension: E times strain', stress(1), 0.07_DP, 1e-16_DP)
    call suite%near('tension: no lateral stress', maxval(abs(stress(2:))), 0.0_DP, 1e-16_DP)
    call suite%near('tension: energy', energy, 0.5_DP * 0.07_DP * 0.01_DP, 1e-17_DP)
    call random_number(strain)
    call small_strain_stress(material, strain, stress, tangent, energy)
    gamma = strain
    gamma(4:) = 2 * gamma(4:)
    call suite%near('tangent times engineering strain', maxval(abs(matmul(tangent, gamma) - stress)), 0.0_DP, 1e-14_DP)
    call suite%near('shear modulus', tangent(5, 5), 7 / 2.6_DP, 1e-15_DP)
  end subroutine check_small


  !> A stretch behind a swelling, and free swelling by other amounts along each axis.
  subroutine check_swelling()
    real(DP) :: H(3, 3), e(6), swollen(3, 3)
    call random_number(H)
    call random_number(e)
    H = 0.1_DP * H
    e = 0.1_DP * e
    swollen = exp(0.03_DP) * (IDENTITY + unpack_voigt(e))
    swollen = gradient_without_swelling(matmul(IDENTITY + H, swollen) - IDENTITY, e, 0.03_DP)
    call suite%near('swelling is taken off', maxval(abs(swollen - H)), 0.0_DP, 1e-15_DP)
    swollen = gradient_without_swelling(unpack_voigt(e), e, 0.0_DP)
    call suite%near('free swelling leaves nothing', maxval(abs(swollen)), 0.0_DP, 0.0_DP)
  end subroutine check_swelling


  subroutine check_logarithm()
    call suite%near('ln(1 + x), tiny', log1p(1e-12_DP) / (1e-12_DP - 0.5e-24_DP), 1.0_DP, 1e-15_DP)
    call suite%near('ln(1 + x), below rounding', log1p(-1e-20_DP), -1e-20_DP, 0.0_DP)
    call suite%near('ln(1 + x), large', log1p(exp(2.0_DP) - 1), 2.0_DP, 1e-15_DP)
    call suite%near('ln(1 + 0)', log1p(0.0_DP), 0.0_DP, 0.0_DP)
  end subroutine check_logarithm


  !> A stretch along the axes, a dilatation and a tiny tension.
  subroutine check_hencky_closed_forms()
    real(DP) :: H(3, 3), tau(6), tangent(6, 6), strain(6), energy, e(6)
    integer :: status
    material%law = LAW_HENCKY
    e = [0.4_DP, -0.2_DP, 0.1_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    H = 0
    H(1, 1) = exp(e(1)) - 1
    H(2, 2) = exp(e(2)) - 1
    H(3, 3) = exp(e(3)) - 1
    call finite_strain_stress(material, H, tau, tangent, strain, energy, status)
    call suite%near('stretch: strain', maxval(abs(strain - e)), 0.0_DP, 1e-15_DP)
    call suite%near('stretch: stress', maxval(abs(tau - lambda * 0.3_DP * VOIGT_IDENTITY - 2 * G * e)), 0.0_DP, &
      1e-14_DP)
    call suite%near('stretch: energy', energy, 0.5_DP * lambda * 0.09_DP + G * 0.21_DP, 1e-14_DP)
    call suite%near('stretch: c_1111', tangent(1, 1), lambda + 2 * G - 2 * tau(1), 1e-14_DP)
    call suite%near('stretch: c_1212', tangent(4, 4), &
      (tau(1) * exp(2 * e(2)) - tau(2) * exp(2 * e(1))) / (exp(2 * e(1)) - exp(2 * e(2))), 1e-13_DP)
    H = 0.5_DP * IDENTITY
    call finite_strain_stress(material, H, tau, tangent, strain, energy, status)
    call suite%near('dilatation: stress', maxval(abs(tau - (3 * lambda + 2 * G) * log(1.5_DP) * VOIGT_IDENTITY)), &
      0.0_DP, 1e-14_DP)
    H = 0
    H(1, 1) = 1e-9_DP
    call finite_strain_stress(material, H, tau, tangent, strain, energy, status)
    call suite%near('tiny tension: relative', strain(1) / (1e-9_DP - 0.5e-18_DP), 1.0_DP, 4e-16_DP)
    call suite%near('tiny tension: stress', tau(2) / (lambda * strain(1)), 1.0_DP, 1e-15_DP)
    call suite%near('tiny tension: energy', energy / ((0.5_DP * lambda + G) * strain(1)**2), 1.0_DP, 2e-15_DP)
    H = 0
    H(1, 2) = 1e-9_DP
    call finite_strain_stress(material, H, tau, tangent, strain, energy, status)
    call suite%near('tiny simple shear: relative', tau(4) / (G * 1e-9_DP), 1.0_DP, 1e-15_DP)
  end subroutine check_hencky_closed_forms


  !> Simple shear g: E_12 = g/2, E_22 = g^2/2.
  subroutine check_saint_venant_closed_forms()
    real(DP) :: H(3, 3), tau(6), tangent(6, 6), strain(6), energy, E(3, 3), S(3, 3), F(3, 3)
    real(DP), parameter :: g_shear = 0.6_DP
    integer :: status
    material%law = LAW_SAINT_VENANT
    H = 0
    H(1, 2) = g_shear
    E = 0
    E(1, 2) = g_shear / 2
    E(2, 1) = g_shear / 2
    E(2, 2) = g_shear**2 / 2
    F = IDENTITY + H
    S = lambda * E(2, 2) * IDENTITY + 2 * G * E
    call finite_strain_stress(material, H, tau, tangent, strain, energy, status)
    call suite%near('simple shear: F S F^T', maxval(abs(unpack_voigt(tau) - matmul(F, matmul(S, transpose(F))))), &
      0.0_DP, 1e-14_DP)
    call suite%near('simple shear: energy', energy, 0.5_DP * sum(S * E), 1e-14_DP)
    call suite%near('simple shear: strain', maxval(abs(unpack_voigt(strain) - E)), 0.0_DP, 1e-15_DP)
  end subroutine check_saint_venant_closed_forms


  !> Small, large, rotated, with two and three equal stretches, nearly equal ones, and zero strain.
  subroutine check_derivatives_of_many()
    real(DP) :: H(3, 3), R(3, 3)
    real(DP), parameter :: NEARBY(4) = [1e-3_DP, 1e-6_DP, 1e-9_DP, 1e-13_DP]
    integer :: k
    R = reshape([0.0_DP, 1.0_DP, 0.0_DP, -1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    do k = 1, 10
      call random_number(H)
      H = 0.6_DP * (H - 0.5_DP)
      call check_derivatives('random', H)
      call check_derivatives('turned', matmul(R, IDENTITY + H) - IDENTITY)
      call check_derivatives('small', 1e-4_DP * H)
    end do
    call check_derivatives('none', 0 * H)
    call check_derivatives('dilatation', 0.3_DP * IDENTITY)
    H = 0.3_DP * IDENTITY
    H(3, 3) = -0.2_DP
    call check_derivatives('two equal', H)
    do k = 1, size(NEARBY)
      H(1, 1) = 0.3_DP + NEARBY(k)
      H(1, 2) = 0.7_DP * NEARBY(k)
      call check_derivatives('two close', H)
    end do
    H = 0
    H(1, 1) = 2.5_DP
    H(2, 2) = -0.7_DP
    H(2, 3) = 1.1_DP
    call check_derivatives('very large', H)
  end subroutine check_derivatives_of_many


  !> With F moved to (1 + s l) F: d energy = tau : d, d tau = c : d + l tau + tau l^T, for nine l.
  subroutine check_derivatives(name, H)
    character(*), intent(in) :: name
    real(DP), intent(in) :: H(3, 3)
    real(DP), parameter :: STEP = 1e-5_DP
    real(DP) :: l(3, 3), tau(6), c(6, 6), strain(6), energy, tp(6), tm(6), wp, wm, d(6), expected(6), t(3, 3), size_of
    integer :: i, j, status
    call finite_strain_stress(material, H, tau, c, strain, energy, status)
    call suite%that(name // ': status', status == STRESS_OK)
    call suite%near(name // ': symmetric tangent', maxval(abs(c - transpose(c))), 0.0_DP, 1e-14_DP * maxval(abs(c)))
    t = unpack_voigt(tau)
    size_of = maxval(abs(c))
    do j = 1, 3
      do i = 1, 3
        l = 0
        l(i, j) = 1
        call kirchhoff_stress(material, H + STEP * matmul(l, IDENTITY + H), tp, strain, wp, status)
        call kirchhoff_stress(material, H - STEP * matmul(l, IDENTITY + H), tm, strain, wm, status)
        d = pack_voigt(l)
        call suite%near(name // ': energy by differences', (wp - wm) / (2 * STEP), double_dot(tau, d), &
          2e-9_DP * size_of)
        d(4:) = 2 * d(4:)
        expected = matmul(c, d) + pack_voigt(matmul(l, t) + matmul(t, transpose(l)))
        call suite%near(name // ': tangent by differences', maxval(abs((tp - tm) / (2 * STEP) - expected)), 0.0_DP, &
          5e-9_DP * size_of)
      end do
    end do
  end subroutine check_derivatives


  !> A rotation after the deformation rotates the stress and leaves the energy unchanged; one before changes neither.
  subroutine check_objectivity()
    real(DP) :: H(3, 3), Q(3, 3), t1(6), t2(6), strain(6), w1, w2
    integer :: status
    Q = reshape([0.36_DP, 0.48_DP, -0.8_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.48_DP, 0.64_DP, 0.6_DP], [3, 3])
    call random_number(H)
    H = 0.4_DP * (H - 0.5_DP)
    call kirchhoff_stress(material, H, t1, strain, w1, status)
    call kirchhoff_stress(material, matmul(Q, IDENTITY + H) - IDENTITY, t2, strain, w2, status)
    call suite%near('objective stress', maxval(abs(unpack_voigt(t2) - &
      matmul(Q, matmul(unpack_voigt(t1), transpose(Q))))), &
      0.0_DP, 2e-14_DP)
    call suite%near('objective energy', w2, w1, 1e-14_DP)
    call kirchhoff_stress(material, matmul(IDENTITY + H, Q) - IDENTITY, t2, strain, w2, status)
    call suite%near('isotropic stress', maxval(abs(t2 - t1)), 0.0_DP, 2e-14_DP)
    call kirchhoff_stress(material, Q - IDENTITY, t2, strain, w2, status)
    call suite%near('rotation: no stress', maxval(abs(t2)), 0.0_DP, 1e-14_DP)
  end subroutine check_objectivity


  !> At a strain of 1e-9 stress and tangent are Hooke's to 1e-8; at zero strain exactly zero and Hooke's.
  subroutine check_small_limit()
    real(DP) :: H(3, 3), tau(6), c(6, 6), strain(6), w, stress(6), hooke(6, 6), energy
    integer :: status
    call random_number(H)
    H = 1e-9_DP * (H - 0.5_DP)
    call finite_strain_stress(material, H, tau, c, strain, w, status)
    call small_strain_stress(material, pack_voigt(H), stress, hooke, energy)
    call suite%near('tiny: Hooke stress', maxval(abs(tau - stress)) / maxval(abs(stress)), 0.0_DP, 1e-8_DP)
    call suite%near('tiny: Hooke tangent', maxval(abs(c - hooke)), 0.0_DP, 1e-7_DP)
    call finite_strain_stress(material, 0 * H, tau, c, strain, w, status)
    call suite%near('no strain: stress', maxval(abs(tau)), 0.0_DP, 0.0_DP)
    call suite%near('no strain: energy', w, 0.0_DP, 0.0_DP)
    call suite%near('no strain: tangent', maxval(abs(c - hooke)), 0.0_DP, 1e-14_DP)
  end subroutine check_small_limit


  subroutine check_exits()
    real(DP) :: H(3, 3), tau(6), c(6, 6), strain(6), w
    integer :: status
    H = 0
    H(2, 2) = -1
    call finite_strain_stress(material, H, tau, c, strain, w, status)
    call suite%that('flat: inverted', status == STRESS_INVERTED)
    H(2, 2) = -1.5_DP
    call kirchhoff_stress(material, H, tau, strain, w, status)
    call suite%that('turned inside out: inverted', status == STRESS_INVERTED)
    call suite%that('inverted: zeros', all(abs(tau) <= 0))
    H(2, 2) = 1e200_DP
    call finite_strain_stress(material, H, tau, c, strain, w, status)
    call suite%that('beyond all bounds: not finite', status == STRESS_NOT_FINITE)
    H(2, 2) = ieee_value(1.0_DP, ieee_quiet_nan)
    call finite_strain_stress(material, H, tau, c, strain, w, status)
    call suite%that('NaN: not finite', status == STRESS_NOT_FINITE)
  end subroutine check_exits

end program test_elasticity
