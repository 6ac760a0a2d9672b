!> Unit test of amontons_solid_shell: energies of bending, twist, curved and warped faces; equilibrium, temperatures, rotation.
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
  call check_bending(KIND_CSS8, 8, .true.)
  call check_bending(KIND_CSS6, 6, .false.)
  call check_bending(KIND_CSS6, 6, .true.)
  call check_equilibrium()
  call check_bending_in_plane()
  call check_curved_strip()
  call check_warped_face(0.05_DP)
  call check_warped_face(0.1_DP)
  call check_nearly_triangle()
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
  real(DP) function energy_of(kind, X, u, is_nlgeom, is_whole) result(energy)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    logical, intent(in), optional :: is_whole      !< the only layer of a shell
    type(integration_points_type) :: points
    real(DP) :: force(3, MAX_ELEMENT_NODES)
    integer :: status, n
    if (present(is_whole)) points%is_shell = is_whole
    call evaluate_solid_shell(kind, material, X, u, is_nlgeom, force, points, status)
    call suite%that('status', status == ELEMENT_OK)
    n = merge(20, 15, kind == KIND_CSS8)
    energy = sum(points%energy(:n) * points%volume(:n))
  end function energy_of


  !> Cylindrical bending and twist of a plate: energies by Kirchhoff, exact for these elements, however thin the plate is.
  subroutine check_bending(kind, n, is_whole)
    integer, intent(in) :: kind, n
    logical, intent(in) :: is_whole                !< the only layer of a shell
    real(DP) :: X(3, 8), u(3, 8), area, stiffness
    call make_plate(n, X)
    area = 2.4_DP
    if (n == 6) area = 1.2_DP
    stiffness = E * THICKNESS**3 / (12 * (1 - NU**2))
    u(1, :) = -CURVATURE * X(1, :) * X(3, :)
    u(2, :) = 0
    u(3, :) = 0.5_DP * CURVATURE * X(1, :)**2
    call suite%near('bending: energy over D k^2 A/2', energy_of(kind, X(:, :n), u(:, :n), .false., is_whole) / &
      (0.5_DP * stiffness * CURVATURE**2 * area), 1.0_DP, 1.0e-11_DP)
    u(1, :) = -CURVATURE * X(2, :) * X(3, :)
    u(2, :) = -CURVATURE * X(1, :) * X(3, :)
    u(3, :) = CURVATURE * X(1, :) * X(2, :)
    call suite%near('twist: energy over D (1 - nu) k^2 A', energy_of(kind, X(:, :n), u(:, :n), .false., is_whole) / &
      (stiffness * (1 - NU) * CURVATURE**2 * area), 1.0_DP, 1.0e-11_DP)
  end subroutine check_bending


  !> Under any displacements the moments at the places of the points, linear in between, and the shear force of a triangle are in
  !! equilibrium, M_ij,j = Q_i, however thin it is.
  subroutine check_equilibrium()
    type(integration_points_type) :: points
    real(DP) :: X(3, 8), u(3, 8), force(3, MAX_ELEMENT_NODES), xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), moment(3, 3), &
      shear(2), slope(2, 3), area
    integer :: status, p, k, n
    call make_plate(6, X)
    X(1, [2, 5]) = 1.4_DP
    X(2, [2, 5]) = -0.5_DP
    u = reshape([(sin(real(7 * k**2, DP)), k=1, 24)], [3, 8])
    call quadrature(KIND_CSS6, n, xi, w)
    points%is_shell = .true.
    call evaluate_solid_shell(KIND_CSS6, material, X(:, :6), u(:, :6), .false., force, points, status)
    call suite%that('status', status == ELEMENT_OK)
    area = sum(points%volume(:n)) / THICKNESS
    moment = 0                                     ! 11, 22, 12 at the three places
    do p = 1, n
      k = nearest_place(xi(:2, p))
      moment(:, k) = moment(:, k) + (3 * points%volume(p) / area) * (0.5_DP * THICKNESS * xi(3, p)) * points%stress([1, 2, 4], p)
    end do
    shear = [sum(points%volume(:n) * points%stress(6, :n)), sum(points%volume(:n) * points%stress(5, :n))] / area
    slope = place_slopes(X)
    call suite%near('moments and shear force, 1', dot_product(moment(1, :), slope(1, :)) + dot_product(moment(3, :), slope(2, :)), &
      shear(1), 1.0e-9_DP * maxval(abs(moment)))
    call suite%near('moments and shear force, 2', dot_product(moment(3, :), slope(1, :)) + dot_product(moment(2, :), slope(2, :)), &
      shear(2), 1.0e-9_DP * maxval(abs(moment)))
    call suite%that('a shear force', norm2(shear) > 0.01_DP * maxval(abs(moment)))
  end subroutine check_equilibrium


  !> The place of a point in the triangle: near its first, second or third corner.
  pure integer function nearest_place(xi)
    real(DP), intent(in) :: xi(2)
    nearest_place = maxloc([1 - xi(1) - xi(2), xi(1), xi(2)], 1)
  end function nearest_place


  !> Derivatives, along 1 and 2, of the linear functions that are one at one of the three places: twice those of the corners.
  pure function place_slopes(X) result(slope)
    real(DP), intent(in) :: X(3, 8)
    real(DP) :: slope(2, 3), edge(2, 2), det
    edge(:, 1) = X(:2, 2) - X(:2, 1)
    edge(:, 2) = X(:2, 3) - X(:2, 1)
    det = edge(1, 1) * edge(2, 2) - edge(1, 2) * edge(2, 1)
    slope(:, 2) = 2 * [edge(2, 2), -edge(1, 2)] / det
    slope(:, 3) = 2 * [-edge(2, 1), edge(1, 1)] / det
    slope(:, 1) = -slope(:, 2) - slope(:, 3)
  end function place_slopes


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


  !> A warped face, z = c x y over 2 x 1.2, gets another c while its edges keep their lengths and its fibres stay normal. The energy
  !! is that of twist alone, however thin the element is. Interpolated unit normals of the corners give the curvature c/s with
  !! s^2 = 1 + c^2 (1 + 0.6^2), hence the factor s^-6; the rest is the slope of the face: its area and its angles. The membrane
  !! strain x_d . u_d of bilinear displacements would make the energy hundreds of times as large.
  subroutine check_warped_face(warp)
    real(DP), intent(in) :: warp                   !< height of the corners over the middle [length]
    real(DP), parameter :: TWIST = 1.0e-4_DP
    real(DP) :: X(3, 8), moved(3, 8), exact, stiffness
    stiffness = E * THICKNESS**3 / (12 * (1 - NU**2))
    exact = stiffness * (1 - NU) * TWIST**2 * 2.4_DP / (1 + 1.36_DP * (warp / 0.6_DP)**2)**3
    call place_warped_face(warp, warp, X)
    call place_warped_face(warp, warp + 0.6_DP * TWIST, moved)
    call suite%near('warped face: energy over that of twist', energy_of(KIND_CSS8, X, moved - X, .true.) / exact, 1.0_DP, &
      (warp / 0.6_DP)**2)
  end subroutine check_warped_face


  !> The corners at +-warp, the edges as long as those of a face with the first warp; the fibres along the normals.
  subroutine place_warped_face(at_rest, warp, X)
    real(DP), intent(in) :: at_rest, warp          !< height of the corners at rest and now [length]
    real(DP), intent(out) :: X(3, 8)
    real(DP) :: half(2), corner(2), normal(3)
    integer :: a
    half = sqrt([1.0_DP, 0.36_DP] + at_rest**2 - warp**2)
    do a = 1, 4
      corner = half * [real(merge(-1, 1, any(a == [1, 4])), DP), real(merge(-1, 1, a <= 2), DP)]
      normal = [-warp * corner(2), -warp * corner(1), product(half)]
      normal = normal * (0.5_DP * THICKNESS / norm2(normal))
      X(:2, a) = corner
      X(3, a) = warp * product(corner) / product(half)
      X(:, a + 4) = X(:, a) + normal
      X(:, a) = X(:, a) - normal
    end do
  end subroutine place_warped_face


  !> A flat face whose third and fourth corner nearly meet: a constant strain has its energy, finite displacements have theirs.
  subroutine check_nearly_triangle()
    real(DP) :: X(3, 8), u(3, 8), area
    call make_plate(8, X)
    X(:2, 3) = [-0.9999_DP, 0.6_DP]
    X(:2, 7) = X(:2, 3)
    area = 0.5_DP * 1.2_DP * (2 + 0.0001_DP)
    u = 0
    u(1, :) = CURVATURE * X(1, :)
    u(2, :) = -NU * CURVATURE * X(2, :)
    u(3, :) = -NU * CURVATURE * X(3, :)
    call suite%near('nearly a triangle: energy over E e^2 V/2', energy_of(KIND_CSS8, X, u, .false.) / (0.5_DP * E * CURVATURE**2 &
      * area * THICKNESS), 1.0_DP, 1.0e-10_DP)
    call suite%that('at finite strain', abs(energy_of(KIND_CSS8, X, u, .true.) / (0.5_DP * E * CURVATURE**2 * area * THICKNESS) &
      - 1) < 2 * CURVATURE)
  end subroutine check_nearly_triangle


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
