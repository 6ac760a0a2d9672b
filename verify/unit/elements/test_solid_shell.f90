!> Unit test of amontons_solid_shell: energies of bending, twist and bending in the plane, a curved strip, temperatures, rotation.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Derivatives against differences, patch test, rigid motions and error exits: test_element, which runs over all kinds.
program test_solid_shell
  use amontons_element_integration_points, only: integration_points_type, ELEMENT_OK, ELEMENT_INVERTED
  use amontons_kinds, only: DP, PI
  use amontons_materials, only: material_type
  use amontons_shape_functions, only: quadrature
  use amontons_solid_shell, only: evaluate_solid_shell, set_layer_temperature_weights
  use amontons_element_kinds, only: KIND_CSS8, KIND_CSS6, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  use check, only: suite_type
  implicit none
  real(DP), parameter :: E = 210000.0_DP, NU = 0.3_DP, THICKNESS = 0.01_DP, CURVATURE = 0.02_DP
  type(suite_type) :: suite
  type(material_type) :: material
  material%youngs_modulus = E
  material%poissons_ratio = NU
  call check_bending(KIND_CSS8, 8)
  call check_bending(KIND_CSS6, 6)
  call check_bending_in_plane()
  call check_curved_strip()
  call check_rotation()
  call check_temperatures(KIND_CSS8, 4)
  call check_temperatures(KIND_CSS6, 3)
  call check_exit()
  call suite%finish()

contains

  !> A flat element: 2 x 1.2, or half of it.
  subroutine make_plate(n, X)
    integer, intent(in) :: n                       !< nodes: 8 or 6
    real(DP), intent(out) :: X(3, 8)
    real(DP), parameter :: CORNERS(2, 4) = reshape([-1.0_DP, -0.6_DP, 1.0_DP, -0.6_DP, 1.0_DP, 0.6_DP, -1.0_DP, 0.6_DP], [2, 4])
    integer :: m
    m = n / 2
    X = 0
    if (m == 4) X(:2, :4) = CORNERS
    if (m == 3) X(:2, :3) = CORNERS(:, [1, 2, 4])
    X(:2, m + 1:n) = X(:2, :m)
    X(3, :m) = -0.5_DP * THICKNESS
    X(3, m + 1:n) = 0.5_DP * THICKNESS
  end subroutine make_plate


  !> The energy of an element.
  real(DP) function energy_of(kind, X, u, is_nlgeom) result(energy)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    type(integration_points_type) :: points
    real(DP) :: force(3, MAX_ELEMENT_NODES)
    integer :: status, n
    call evaluate_solid_shell(kind, material, X, u, is_nlgeom, force, points, status)
    call suite%that('status', status == ELEMENT_OK)
    n = merge(20, 15, kind == KIND_CSS8)
    energy = sum(points%energy(:n) * points%volume(:n))
  end function energy_of


  !> Cylindrical bending and twist of a plate: energies by Kirchhoff, exact for these elements, however thin the plate is.
  subroutine check_bending(kind, n)
    integer, intent(in) :: kind, n
    real(DP) :: X(3, 8), u(3, 8), area, stiffness
    call make_plate(n, X)
    area = 2.4_DP
    if (n == 6) area = 1.2_DP
    stiffness = E * THICKNESS**3 / (12 * (1 - NU**2))
    u(1, :) = -CURVATURE * X(1, :) * X(3, :)
    u(2, :) = 0
    u(3, :) = 0.5_DP * CURVATURE * X(1, :)**2
    call suite%near('bending: energy over D k^2 A/2', energy_of(kind, X(:, :n), u(:, :n), .false.) / &
      (0.5_DP * stiffness * CURVATURE**2 * area), 1.0_DP, 1.0e-11_DP)
    u(1, :) = -CURVATURE * X(2, :) * X(3, :)
    u(2, :) = -CURVATURE * X(1, :) * X(3, :)
    u(3, :) = CURVATURE * X(1, :) * X(2, :)
    call suite%near('twist: energy over D (1 - nu) k^2 A', energy_of(kind, X(:, :n), u(:, :n), .false.) / &
      (stiffness * (1 - NU) * CURVATURE**2 * area), 1.0_DP, 1.0e-11_DP)
  end subroutine check_bending


  !> Bending in the plane as a beam: the amplitudes take the shear and the transverse strain that four nodes cannot have.
  subroutine check_bending_in_plane()
    real(DP) :: X(3, 8), u(3, 8)
    call make_plate(8, X)
    u(1, :) = CURVATURE * X(1, :) * X(2, :)
    u(2, :) = 0
    u(3, :) = -NU * CURVATURE * X(2, :) * X(3, :)
    call suite%near('in its plane: energy over E I k^2 l/2', energy_of(KIND_CSS8, X, u, .false.) / &
      (0.5_DP * E * (THICKNESS * 1.2_DP**3 / 12) * CURVATURE**2 * 2), 1.0_DP, 1.0e-11_DP)
  end subroutine check_bending_in_plane


  !> A strip over 20 degrees of a circle, its fibres along the radii, bends to another radius: each fibre turns by its share of the
  !! angle while the middle keeps its length. The energy is that of bending alone, to the error of the polygon, squared, however
  !! thin it is. The strain of a straight brick would be that of its thickness: over a thousand times this energy.
  subroutine check_curved_strip()
    real(DP), parameter :: ANGLE = 20 * PI / 180, RADIUS = 10.0_DP, TURN = 1.0e-3_DP
    real(DP) :: X(3, 8), moved(3, 8), half, chord, exact, stiffness, y, z
    integer :: a
    half = 0.5_DP * ANGLE
    chord = 2 * RADIUS * sin(half)
    do a = 1, 8
      y = merge(-0.5_DP, 0.5_DP, any(a == [1, 2, 5, 6]))
      z = merge(-0.5_DP, 0.5_DP, a <= 4) * THICKNESS
      X(:, a) = [sign(1.0_DP, real(merge(1, -1, any(a == [2, 3, 6, 7])), DP)) * (0.5_DP * chord + z * sin(half)), y, z * cos(half)]
      moved(:, a) = [sign(1.0_DP, X(1, a)) * (0.5_DP * chord + z * sin(half + 0.5_DP * TURN)), y, z * cos(half + 0.5_DP * TURN)]
    end do
    stiffness = E * THICKNESS**3 / (12 * (1 - NU**2))
    exact = 0.5_DP * stiffness * TURN**2 / (RADIUS * ANGLE)
    call suite%near('curved strip: energy over that of bending', energy_of(KIND_CSS8, X, moved - X, .true.) / exact, 1.0_DP, &
      0.03_DP)
  end subroutine check_curved_strip


  !> A stretched element turned by a right angle: the Cauchy stress turns with it.
  subroutine check_rotation()
    real(DP) :: X(3, 8), u(3, 8), force(3, MAX_ELEMENT_NODES), straight(6)
    type(integration_points_type) :: points
    integer :: status
    call make_plate(8, X)
    u = 0
    u(1, :) = 0.1_DP * X(1, :)
    call evaluate_solid_shell(KIND_CSS8, material, X, u, .true., force, points, status)
    straight = points%stress(:, 7)
    call suite%that('tension', straight(1) > 0.05_DP * E)
    u(1, :) = -X(2, :) - X(1, :)
    u(2, :) = 1.1_DP * X(1, :) - X(2, :)
    call evaluate_solid_shell(KIND_CSS8, material, X, u, .true., force, points, status)
    call suite%near('turned stress', norm2(points%stress(:, 7) - straight([2, 1, 3, 4, 5, 6])), 0.0_DP, 1.0e-12_DP * E)
  end subroutine check_rotation


  !> Linear over the thickness between the means of both faces.
  subroutine check_temperatures(kind, n)
    integer, intent(in) :: kind, n                 !< n: nodes of a face
    real(DP) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), T(2 * n)
    integer :: n_points, p, a
    call set_layer_temperature_weights(kind, weight)
    call quadrature(kind, n_points, xi, w)
    T = [(real(a, DP), a=1, n), (20 + real(a, DP), a=1, n)]
    do p = 1, n_points
      call suite%near('temperature', dot_product(weight(:2 * n, p), T), 0.5_DP * real(n + 1, DP) + 10 * (1 + xi(3, p)), 1.0e-13_DP)
    end do
  end subroutine check_temperatures


  !> Pressed through itself.
  subroutine check_exit()
    real(DP) :: X(3, 8), force(3, MAX_ELEMENT_NODES), u(3, 8)
    type(integration_points_type) :: points
    integer :: status
    call make_plate(8, X)
    u = 0
    u(3, :) = -2 * X(3, :)
    call evaluate_solid_shell(KIND_CSS8, material, X, u, .true., force, points, status)
    call suite%that('inverted', status == ELEMENT_INVERTED)
  end subroutine check_exit

end program test_solid_shell
