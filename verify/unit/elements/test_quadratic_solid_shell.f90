!> Unit test of amontons_quadratic_solid_shell: plates against closed forms, a piece of a tube that bends without stretching.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Tangent, rigid motions, modes and exits: test_element.
program test_quadratic_solid_shell
  use amontons_element_integration_points, only: integration_points_type, ELEMENT_OK, ELEMENT_DEGENERATE, ELEMENT_NOT_FINITE
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type
  use amontons_quadratic_solid_shell, only: evaluate_quadratic_solid_shell
  use amontons_solid_elements, only: evaluate_solid_element
  use amontons_element_kinds, only: KIND_C3D15, MAX_ELEMENT_NODES
  use check, only: suite_type
  implicit none
  real(DP), parameter :: E = 210000.0_DP, THICKNESS = 0.01_DP
  real(DP), parameter :: CORNERS(2, 3) = reshape([0.0_DP, 0.0_DP, 2.0_DP, 0.3_DP, 0.4_DP, 1.5_DP], [2, 3])
  type(suite_type) :: suite
  call check_plate()
  call check_tube(0.02_DP, 0.07_DP, 0.6_DP)
  call check_tube(0.1_DP, 1.6_DP, 16.0_DP)
  call check_exits()
  call suite%finish()

contains

  !> Any state of membrane strain, bending and twist of a flat triangle: its energy, Poisson's ratio 0.
  subroutine check_plate()
    real(DP), parameter :: STRAIN(3, 4) = reshape([real(DP) :: 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, -1, 3], [3, 4])   ! 11, 22, 12
    real(DP) :: X(3, 15), u(3, 15), area, density
    integer :: k, a
    do a = 1, 15
      X(:, a) = [place_of(a), height_of(a)]
    end do
    area = 0.5_DP * (CORNERS(1, 2) * CORNERS(2, 3) - CORNERS(2, 2) * CORNERS(1, 3))
    do k = 1, 4
      associate (m => STRAIN(:, k))
        density = 0.5_DP * E * (m(1)**2 + m(2)**2 + 2 * m(3)**2)
        do a = 1, 15
          u(:, a) = 1.0e-3_DP * [m(1) * X(1, a) + m(3) * X(2, a), m(3) * X(1, a) + m(2) * X(2, a), 0.0_DP]
        end do
        call suite%near('plate: stretched', energy_of(X, u) / (1.0e-6_DP * density * area * THICKNESS), 1.0_DP, 1.0e-10_DP)
        do a = 1, 15                               ! u = -z grad w, w the quadratic form of the curvatures
          u(:, a) = 1.0e-3_DP * [-X(3, a) * (m(1) * X(1, a) + m(3) * X(2, a)), -X(3, a) * (m(3) * X(1, a) + m(2) * X(2, a)), &
            0.5_DP * (m(1) * X(1, a)**2 + m(2) * X(2, a)**2) + m(3) * X(1, a) * X(2, a)]
        end do
        call suite%near('plate: bent', energy_of(X, u) / (1.0e-6_DP * density * area * THICKNESS**3 / 12), 1.0_DP, 1.0e-7_DP)
      end associate
    end do
  end subroutine check_plate


  !> A piece of a tube of radius 10 bends to another radius, its arcs keep their length. The energy is that of bending, but for
  !! what one quadratic triangle cannot follow; strains of the displacements alone cost ten times that.
  subroutine check_tube(angle, largest, least)
    real(DP), intent(in) :: angle                  !< of a unit of length [rad]
    real(DP), intent(in) :: largest                !< error of the energy over that of bending [-]
    real(DP), intent(in) :: least                  !< error of the strains of the displacements, the same [-]
    real(DP), parameter :: CHANGE = 1.0e-6_DP      ! of the curvature, over the curvature
    type(material_type) :: material
    type(integration_points_type) :: points
    real(DP) :: X(3, 15), u(3, 15), force(3, MAX_ELEMENT_NODES), s(2), area, bending
    integer :: a, status
    associate (curvature => angle)
      do a = 1, 15
        s = place_of(a)
        associate (phi => curvature * s(1), r => 1 / curvature, z => height_of(a))   ! u: derivatives by the relative curvature
          X(:, a) = [sin(phi) * (r + z), s(2), cos(phi) * (r + z)]
          u(:, a) = CHANGE * [(r + z) * phi * cos(phi) - r * sin(phi), 0.0_DP, -(r + z) * phi * sin(phi) - r * cos(phi) + r]
        end associate
      end do
      area = 0.5_DP * (CORNERS(1, 2) * CORNERS(2, 3) - CORNERS(2, 2) * CORNERS(1, 3))
      bending = 0.5_DP * E * THICKNESS**3 / 12 * (CHANGE * curvature)**2 * area
      call suite%near('tube: energy over that of bending', energy_of(X, u) / bending, 1.0_DP, largest)
      material%youngs_modulus = E
      call evaluate_solid_element(KIND_C3D15, material, X, u, .false., force, points, status)
      call suite%that('tube: locks without', sum(points%energy(:9) * points%volume(:9)) > (1 + least) * bending)
    end associate
  end subroutine check_tube


  !> Elements without volume, displacements that are no numbers.
  subroutine check_exits()
    real(DP) :: X(3, 15), u(3, 15), force(3, MAX_ELEMENT_NODES)
    type(material_type) :: material
    type(integration_points_type) :: points
    integer :: status, a
    material%youngs_modulus = E
    do a = 1, 15
      X(:, a) = [place_of(a), height_of(a)]
    end do
    u = 0
    u(2, 7) = ieee_nan()
    call evaluate_quadratic_solid_shell(material, X, u, .false., force, points, status)
    call suite%that('not finite', status == ELEMENT_NOT_FINITE)
    u = 0
    X(3, :) = -X(3, :)
    call evaluate_quadratic_solid_shell(material, X, u, .false., force, points, status)
    call suite%that('upside down', status == ELEMENT_DEGENERATE)
  end subroutine check_exits


  !> Not a number.
  real(DP) function ieee_nan()
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    ieee_nan = ieee_value(1.0_DP, ieee_quiet_nan)
  end function ieee_nan


  !> The place of a node in the plane of the triangle: corners below and above, mid-sides below and above, corners in the middle.
  pure function place_of(a) result(s)
    integer, intent(in) :: a
    real(DP) :: s(2)
    integer :: k
    k = modulo(a - 1, 3) + 1
    s = CORNERS(:, k)
    if (a > 6 .and. a < 13) s = 0.5_DP * (s + CORNERS(:, modulo(k, 3) + 1))
  end function place_of


  !> Its height over the middle.
  pure real(DP) function height_of(a)
    integer, intent(in) :: a
    integer, parameter :: SIDE(15) = [-1, -1, -1, 1, 1, 1, -1, -1, -1, 1, 1, 1, 0, 0, 0]
    height_of = 0.5_DP * THICKNESS * real(SIDE(a), DP)
  end function height_of


  !> The strain energy at small strain, Poisson's ratio 0.
  real(DP) function energy_of(X, u) result(energy)
    real(DP), intent(in) :: X(3, 15), u(3, 15)
    type(material_type) :: material
    type(integration_points_type) :: points
    real(DP) :: force(3, MAX_ELEMENT_NODES)
    integer :: status
    material%youngs_modulus = E
    call evaluate_quadratic_solid_shell(material, X, u, .false., force, points, status)
    call suite%that('status', status == ELEMENT_OK)
    energy = sum(points%energy(:9) * points%volume(:9))
    call suite%near('work of the forces', 0.5_DP * sum(force(:, :15) * u) / energy, 1.0_DP, 1.0e-6_DP)
  end function energy_of

end program test_quadratic_solid_shell
