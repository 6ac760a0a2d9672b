!> Unit test of amontons_zero_stress_condition: plane stress and uniaxial stress in closed form, small and finite strain.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_zero_stress_condition
  use amontons_kinds, only: DP
  use amontons_elasticity, only: STRESS_OK
  use amontons_element_integration_points, only: integration_points_type
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: material_type, hardening_curve_type
  use amontons_tensor, only: IDENTITY
  use amontons_zero_stress_condition, only: solve_zero_stress, evaluate_initial_tangent, CONDITION_NONE, &
    CONDITION_PLANE_STRESS, CONDITION_UNIAXIAL
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: E = 200000.0_DP, NU = 0.25_DP
  call check_small()
  call check_finite_uniaxial()
  call check_finite_plane()
  call check_plasticity()
  call check_initial_tangent()
  call check_failure()
  call suite%finish()

contains

  !> An elastic material; with a yield stress of 100 and hardening 1000 where wanted.
  function make_material(is_plastic) result(material)
    logical, intent(in) :: is_plastic
    type(material_type) :: material
    material%youngs_modulus = E
    material%poissons_ratio = NU
    if (.not. is_plastic) return
    material%is_linear_isotropic = .false.
    allocate (material%isotropic_hardening(1))
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 1.0_DP], [100.0_DP, 1100.0_DP])
  end function make_material


  !> A point with a displacement gradient and no past.
  subroutine solve(condition, material, is_nlgeom, H, point, status)
    integer, intent(in) :: condition
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: H(3, 3)
    type(material_point_type), intent(out) :: point
    integer, intent(out) :: status
    point%H = H
    point%frame = IDENTITY
    point%temperature = 0
    point%initial_temperature = 0
    point%time = 1
    point%time_increment = 1
    point%history_old = 0
    point%strain = 0
    call solve_zero_stress(condition, material, is_nlgeom, point, status)
  end subroutine solve


  !> Hooke's law in the plane and along a line; the free strains are those of Poisson's ratio.
  subroutine check_small()
    type(material_point_type) :: point
    real(DP) :: H(3, 3)
    integer :: status
    real(DP), parameter :: A = 1.0e-3_DP, B = -2.0e-3_DP, C = 3.0e-3_DP
    H = 0
    H(1, 1) = A
    H(2, 2) = B
    H(1, 2) = C
    H(3, 3) = 77                                   ! free: not to be used
    call solve(CONDITION_PLANE_STRESS, make_material(.false.), .false., H, point, status)
    call suite%that('plane stress: solved', status == STRESS_OK)
    call suite%near('plane stress: 11', point%stress(1), E / (1 - NU**2) * (A + NU * B), 1.0e-9_DP)
    call suite%near('plane stress: 22', point%stress(2), E / (1 - NU**2) * (B + NU * A), 1.0e-9_DP)
    call suite%near('plane stress: 33', point%stress(3), 0.0_DP, 0.0_DP)
    call suite%near('plane stress: 12', point%stress(4), E / (2 * (1 + NU)) * C, 1.0e-9_DP)
    call suite%near('plane stress: strain 33', point%strain(3), -NU / (1 - NU) * (A + B), 1.0e-16_DP)
    call suite%near('plane stress: c 11', point%tangent(1, 1), E / (1 - NU**2), 1.0e-9_DP)
    call suite%near('plane stress: c 12', point%tangent(1, 2), NU * E / (1 - NU**2), 1.0e-9_DP)
    call suite%near('plane stress: c 44', point%tangent(4, 4), E / (2 * (1 + NU)), 1.0e-9_DP)
    call suite%near('plane stress: row and column of 33', sum(abs(point%tangent(3, :))) + sum(abs(point%tangent(:, 3))), &
      0.0_DP, 0.0_DP)
    H(1, 2) = 0
    call solve(CONDITION_UNIAXIAL, make_material(.false.), .false., H, point, status)
    call suite%near('uniaxial: 11', point%stress(1), E * A, 1.0e-9_DP)
    call suite%near('uniaxial: free strains', norm2(point%strain(2:3) + NU * A), 0.0_DP, 1.0e-16_DP)
    call suite%near('uniaxial: c 11', point%tangent(1, 1), E, 1.0e-9_DP)
    call suite%near('uniaxial: energy', point%energy, E * A**2 / 2, 1.0e-12_DP)
    H(3, 3) = C
    call solve(CONDITION_NONE, make_material(.false.), .false., H, point, status)
    call suite%near('no condition: the strain as given', point%strain(3), C, 0.0_DP)
    call suite%near('no condition: pressure', sum(point%stress(:3)), E / (1 - 2 * NU) * (A + B + C), 1.0e-9_DP)
  end subroutine check_small


  !> Hencky's law along a line: tau = E e, the stretch across is lambda^-nu, c = E - 2 tau.
  subroutine check_finite_uniaxial()
    type(material_point_type) :: point
    real(DP) :: H(3, 3)
    real(DP), parameter :: STRAINS(3) = [0.7_DP, -0.5_DP, 1.0e-9_DP]
    integer :: status, i
    do i = 1, 3
      H = 0
      H(1, 1) = exp(STRAINS(i)) - 1
      if (i == 3) H(1, 1) = STRAINS(i) + STRAINS(i)**2 / 2
      call solve(CONDITION_UNIAXIAL, make_material(.false.), .true., H, point, status)
      call suite%that('Hencky along a line: solved', status == STRESS_OK)
      call suite%near('Hencky: tau', point%stress(1), E * STRAINS(i), 1.0e-11_DP * E * abs(STRAINS(i)))
      call suite%near('Hencky: across', log(1 + point%H(2, 2)), -NU * STRAINS(i), 1.0e-12_DP * abs(STRAINS(i)) + 1.0e-16_DP)
      call suite%near('Hencky: both across alike', point%H(3, 3), point%H(2, 2), 1.0e-14_DP)
      call suite%near('Hencky: tangent', point%tangent(1, 1), E - 2 * E * STRAINS(i), 1.0e-8_DP * E)
    end do
  end subroutine check_finite_uniaxial


  !> Hencky's law in the plane, with the axes turned by a rotation about 3.
  subroutine check_finite_plane()
    type(material_point_type) :: point
    real(DP) :: F(3, 3), tau(2)
    integer :: status
    real(DP), parameter :: A = 0.4_DP, B = -0.3_DP
    F = IDENTITY
    F(:2, 1) = exp(A) * [0.6_DP, 0.8_DP]
    F(:2, 2) = exp(B) * [-0.8_DP, 0.6_DP]
    call solve(CONDITION_PLANE_STRESS, make_material(.false.), .true., F - IDENTITY, point, status)
    tau = E / (1 - NU**2) * [A + NU * B, B + NU * A]
    call suite%near('Hencky in the plane: 11', point%stress(1), 0.36_DP * tau(1) + 0.64_DP * tau(2), 1.0e-7_DP)
    call suite%near('Hencky in the plane: 22', point%stress(2), 0.64_DP * tau(1) + 0.36_DP * tau(2), 1.0e-7_DP)
    call suite%near('Hencky in the plane: 12', point%stress(4), 0.48_DP * (tau(1) - tau(2)), 1.0e-7_DP)
    call suite%near('Hencky in the plane: 33', log(1 + point%H(3, 3)), -NU / (1 - NU) * (A + B), 1.0e-13_DP)
  end subroutine check_finite_plane


  !> Plastic tension along a line: stress and tangent of the bilinear law.
  subroutine check_plasticity()
    type(material_point_type) :: point
    real(DP) :: H(3, 3), expected
    integer :: status
    real(DP), parameter :: TOTAL = 0.01_DP, HARD = 1000.0_DP
    H = 0
    H(1, 1) = TOTAL
    call solve(CONDITION_UNIAXIAL, make_material(.true.), .false., H, point, status)
    expected = (100 + HARD * TOTAL) / (1 + HARD / E)
    call suite%that('plastic: solved', status == STRESS_OK)
    call suite%near('plastic: stress', point%stress(1), expected, 1.0e-9_DP)
    call suite%near('plastic: tangent', point%tangent(1, 1), E * HARD / (E + HARD), 1.0e-6_DP)
    call suite%near('plastic: across', point%strain(2), -NU * expected / E - 0.5_DP * (TOTAL - expected / E), 1.0e-13_DP)
  end subroutine check_plasticity


  !> At rest the tangent is that of elasticity, whatever the point has been through.
  subroutine check_initial_tangent()
    type(integration_points_type) :: points
    real(DP) :: c(6, 6)
    points%has_frame = .false.
    points%history_old = 5
    points%temperature = 300
    points%initial_temperature = 20
    points%time = 1
    points%time_increment = 1
    call evaluate_initial_tangent(CONDITION_PLANE_STRESS, make_material(.true.), .true., 4, points, c)
    call suite%near('at rest: plane stress', c(2, 2), E / (1 - NU**2), 1.0e-8_DP)
    call evaluate_initial_tangent(CONDITION_UNIAXIAL, make_material(.false.), .false., 2, points, c)
    call suite%near('at rest: uniaxial', c(1, 1), E, 1.0e-8_DP)
    call evaluate_initial_tangent(CONDITION_NONE, make_material(.false.), .true., 8, points, c)
    call suite%near('at rest: in space', c(1, 1), E * (1 - NU) / ((1 + NU) * (1 - 2 * NU)), 1.0e-8_DP)
  end subroutine check_initial_tangent


  !> A line that is turned inside out, and one that is not a number, are reported.
  subroutine check_failure()
    type(material_point_type) :: point
    real(DP) :: H(3, 3)
    integer :: status
    H = 0
    H(1, 1) = -1.5_DP
    call solve(CONDITION_UNIAXIAL, make_material(.false.), .true., H, point, status)
    call suite%that('inverted', status /= STRESS_OK)
    H(1, 1) = huge(H)
    call solve(CONDITION_PLANE_STRESS, make_material(.false.), .true., H, point, status)
    call suite%that('not finite', status /= STRESS_OK)
  end subroutine check_failure

end program test_zero_stress_condition
