!> Unit test of amontons_logarithmic_strain: logarithms and exponentials, principal axes, and stresses and tangents in closed form.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_logarithmic_strain
  use amontons_kinds, only: DP
  use amontons_elasticity, only: finite_strain_stress, hooke_stress, isotropic_tangent, STRESS_OK
  use amontons_logarithmic_strain, only: log_strain_axes_type, find_log_strain_axes, push_forward_log_law, &
    voigt_transformation, tensor_log, tensor_exp, principal_strains_type, find_principal_strains, left_cauchy_green, &
    tensor_from_principal, principal_tangent, coth_divided_difference, log1p, expm1, NEXT_AXIS
  use amontons_materials, only: material_type, LAW_HENCKY
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, pack_voigt, unpack_voigt, determinant
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: H_GENERAL(3, 3) = reshape([0.3_DP, 0.1_DP, -0.2_DP, 0.25_DP, -0.1_DP, 0.15_DP, 0.05_DP, -0.3_DP, &
    0.2_DP], [3, 3])
  real(DP), parameter :: LAMBDA = 3, G = 2
  call check_functions()
  call check_tensor_functions()
  call check_axes()
  call check_principal()
  call check_transformation()
  call check_hencky()
  call check_neo_hooke()
  call suite%finish()

contains

  !> Small arguments keep their digits, large ones are those of the intrinsic functions.
  subroutine check_functions()
    real(DP), parameter :: X = 1.0e-10_DP
    call suite%near('log1p of 1e-10', log1p(X), X - X**2 / 2, 1.0e-25_DP)
    call suite%near('expm1 of 1e-10', expm1(X), X + X**2 / 2, 1.0e-25_DP)
    call suite%near('log1p of -0.9', log1p(-0.9_DP), log(0.1_DP), 1.0e-14_DP)
    call suite%near('expm1 of 2', expm1(2.0_DP), exp(2.0_DP) - 1, 1.0e-14_DP)
    call suite%that('of zero', log1p(0.0_DP) == 0 .and. expm1(0.0_DP) == 0)
    call suite%that('pairs of axes', all(NEXT_AXIS == [2, 3, 1]))
  end subroutine check_functions


  !> ln and exp are inverse; of a diagonal tensor they are those of its entries. Small and large tensors: as in principal axes.
  subroutine check_tensor_functions()
    type(principal_strains_type) :: p
    real(DP), parameter :: SIZES(6) = [1.0e-12_DP, 1.0e-4_DP, 0.3_DP, 0.8_DP, 3.0_DP, 20.0_DP]
    real(DP) :: S(6), y(6), expected(6)
    logical :: is_positive
    integer :: i
    S = [0.3_DP, -0.2_DP, 0.1_DP, 0.15_DP, -0.05_DP, 0.2_DP]
    y = tensor_log(tensor_exp(S, 2.0_DP), 0.5_DP)
    call suite%near('ln of exp', norm2(y - S), 0.0_DP, 1.0e-14_DP)
    y = tensor_exp([0.4_DP, -1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], 0.5_DP)
    call suite%near('exp of a diagonal', norm2(y - [exp(0.2_DP) - 1, exp(-0.5_DP) - 1, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]), &
      0.0_DP, 1.0e-15_DP)
    y = tensor_exp([0.0_DP, 0.0_DP, 0.0_DP, 0.7_DP, 0.0_DP, 0.0_DP], 1.0_DP)
    call suite%near('exp of a shear: cosh', y(1), cosh(0.7_DP) - 1, 1.0e-14_DP)
    call suite%near('exp of a shear: sinh', y(4), sinh(0.7_DP), 1.0e-14_DP)
    do i = 1, size(SIZES)
      S = SIZES(i) * [1.0_DP, 0.6_DP, 0.2_DP, 0.15_DP, -0.05_DP, 0.2_DP]
      call find_principal_strains(S, p, is_positive)
      expected = tensor_from_principal(p, expm1(p%x))
      call suite%near('exp in principal axes', norm2(tensor_exp(S, 1.0_DP) - expected) / norm2(expected), 0.0_DP, 4.0e-15_DP)
      expected = tensor_from_principal(p, log1p(p%x))
      call suite%near('ln in principal axes', norm2(tensor_log(S, 1.0_DP) - expected) / norm2(expected), 0.0_DP, 4.0e-15_DP)
    end do
  end subroutine check_tensor_functions


  !> Axes of F = R U: the strain of U, spatial axes turned by R; none for a singular F.
  subroutine check_axes()
    type(log_strain_axes_type) :: axes
    real(DP) :: R(3, 3), U(3, 3), F(3, 3), E(3, 3)
    integer :: A
    logical :: is_positive
    R = reshape([0.36_DP, 0.48_DP, -0.8_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.48_DP, 0.64_DP, 0.6_DP], [3, 3])
    call find_log_strain_axes(R - IDENTITY, axes, is_positive)
    call suite%that('a rotation is positive', is_positive)
    call suite%near('a rotation has no strain', norm2(axes%e), 0.0_DP, 1.0e-15_DP)
    U = IDENTITY + unpack_voigt(tensor_exp([0.3_DP, -0.2_DP, 0.1_DP, 0.15_DP, -0.05_DP, 0.2_DP], 1.0_DP))
    F = matmul(R, U)
    call find_log_strain_axes(F - IDENTITY, axes, is_positive)
    E = 0
    do A = 1, 3
      E = E + axes%e(A) * spread(axes%reference(:, A), 2, 3) * spread(axes%reference(:, A), 1, 3)
      call suite%near('n = F N/lambda', norm2(axes%spatial_axes(:, A) - matmul(F, axes%reference(:, A)) / exp(axes%e(A))), &
        0.0_DP, 1.0e-14_DP)
      call suite%near('n is a unit vector', norm2(axes%spatial_axes(:, A)), 1.0_DP, 1.0e-14_DP)
      call suite%near('e = ln(1 + x)/2', axes%e(A), 0.5_DP * log(1 + axes%x(A)), 1.0e-14_DP)
    end do
    call suite%near('ln U', norm2(pack_voigt(E) - [0.3_DP, -0.2_DP, 0.1_DP, 0.15_DP, -0.05_DP, 0.2_DP]), 0.0_DP, 1.0e-14_DP)
    call find_log_strain_axes(-IDENTITY, axes, is_positive)
    call suite%that('F = 0 has no axes', .not. is_positive)
  end subroutine check_axes


  !> b, its principal strains, and the tensor put together again.
  subroutine check_principal()
    type(principal_strains_type) :: p
    real(DP) :: x(6), F(3, 3), d
    logical :: is_positive
    integer :: A
    F = IDENTITY + H_GENERAL
    x = left_cauchy_green(H_GENERAL)
    call suite%near('b - 1', norm2(unpack_voigt(x) - (matmul(F, transpose(F)) - IDENTITY)), 0.0_DP, 1.0e-15_DP)
    call find_principal_strains(x, p, is_positive)
    call suite%that('positive', is_positive)
    call suite%near('from principal values', norm2(tensor_from_principal(p, p%x) - x), 0.0_DP, 1.0e-14_DP)
    call suite%near('ln J', sum(p%e), log(determinant(F)), 1.0e-14_DP)
    do A = 1, 3
      d = p%e(A) - p%e(NEXT_AXIS(A))
      call suite%near('d coth(d)', coth_divided_difference(p, A, NEXT_AXIS(A)), d / tanh(d), 1.0e-13_DP)
    end do
    call find_principal_strains(0.5_DP * VOIGT_IDENTITY, p, is_positive)
    call suite%near('d coth(d) of equal strains', coth_divided_difference(p, 1, 2), 1.0_DP, 1.0e-15_DP)
    call find_principal_strains([0.0_DP, -1.5_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], p, is_positive)
    call suite%that('not positive definite', .not. is_positive)
  end subroutine check_principal


  !> tau = F S F' by the matrix Q, and the fourth-order push-forward of isotropic elasticity by a rotation changes nothing.
  subroutine check_transformation()
    real(DP) :: Q(6, 6), S(6), F(3, 3), R(3, 3), c(6, 6)
    S = [1.0_DP, -2.0_DP, 3.0_DP, 0.5_DP, -0.7_DP, 0.2_DP]
    F = IDENTITY + H_GENERAL
    Q = voigt_transformation(F)
    call suite%near('F S F''', norm2(unpack_voigt(matmul(Q, S)) - matmul(F, matmul(unpack_voigt(S), transpose(F)))), 0.0_DP, &
      1.0e-13_DP)
    R = reshape([0.36_DP, 0.48_DP, -0.8_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.48_DP, 0.64_DP, 0.6_DP], [3, 3])
    Q = voigt_transformation(R)
    c = isotropic_tangent(LAMBDA, G)
    call suite%near('Q C Q'' of a rotation', norm2(matmul(Q, matmul(c, transpose(Q))) - c), 0.0_DP, 1.0e-13_DP)
  end subroutine check_transformation


  !> A law linear in ln U, pushed forward, is Hencky's law in ln V: stress and tangent.
  subroutine check_hencky()
    type(material_type) :: material
    type(log_strain_axes_type) :: axes
    type(principal_strains_type) :: p
    real(DP) :: tau(6), c(6, 6), strain(6), energy, T(6), stress(6), dT(6, 6), E(3, 3), slope(3, 3)
    integer :: status, A
    logical :: is_positive
    material%law = LAW_HENCKY
    material%youngs_modulus = G * (3 * LAMBDA + 2 * G) / (LAMBDA + G)
    material%poissons_ratio = LAMBDA / (2 * (LAMBDA + G))
    call finite_strain_stress(material, H_GENERAL, tau, c, strain, energy, status)
    call suite%that('Hencky', status == STRESS_OK)
    call find_log_strain_axes(H_GENERAL, axes, is_positive)
    E = 0
    do A = 1, 3
      E = E + axes%e(A) * spread(axes%reference(:, A), 2, 3) * spread(axes%reference(:, A), 1, 3)
    end do
    T = hooke_stress(LAMBDA, G, pack_voigt(E))
    dT = isotropic_tangent(LAMBDA, G)
    stress = T
    call push_forward_log_law(axes, T, .true., dT)
    call suite%near('pushed forward: stress', norm2(T - tau), 0.0_DP, 1.0e-13_DP)
    call suite%near('pushed forward: tangent', norm2(dT - c), 0.0_DP, 1.0e-12_DP)
    call push_forward_log_law(axes, stress, .false., dT)
    call suite%near('pushed forward: stress alone', norm2(stress - T), 0.0_DP, 0.0_DP)
    call suite%near('pushed forward: the tangent as it was', norm2(dT - c), 0.0_DP, 1.0e-12_DP)
    call find_principal_strains(left_cauchy_green(H_GENERAL), p, is_positive)
    slope = LAMBDA + 2 * G * IDENTITY
    dT = principal_tangent(p, LAMBDA * sum(p%e) + 2 * G * p%e, slope, [2 * G, 2 * G, 2 * G])
    call suite%near('principal: tangent', norm2(dT - c), 0.0_DP, 1.0e-12_DP)
  end subroutine check_hencky


  !> tau = G (b - 1) + lambda ln J 1 has c = lambda 1 1 + 2 (G - lambda ln J) I.
  subroutine check_neo_hooke()
    type(principal_strains_type) :: p
    real(DP) :: tau(3), slope(3, 3), secant(3), c(6, 6), ln_J
    integer :: A, B
    logical :: is_positive
    call find_principal_strains(left_cauchy_green(H_GENERAL), p, is_positive)
    ln_J = sum(p%e)
    tau = G * p%x + LAMBDA * ln_J
    slope = LAMBDA
    do A = 1, 3
      B = NEXT_AXIS(A)
      slope(A, A) = slope(A, A) + 2 * G * (1 + p%x(A))
      secant(A) = G * (p%x(A) - p%x(B)) / (p%e(A) - p%e(B))
    end do
    c = principal_tangent(p, tau, slope, secant)
    call suite%near('Neo-Hooke: tangent', norm2(c - isotropic_tangent(LAMBDA, G - LAMBDA * ln_J)), 0.0_DP, 1.0e-12_DP)
  end subroutine check_neo_hooke

end program test_logarithmic_strain
