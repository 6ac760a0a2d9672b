!> Unit test of amontons_membrane_elements: plane stress in space, derivatives, rotation, tension across, volumes, error exits.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_membrane_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_element, only: integration_points_type, evaluate_element_forces, evaluate_element_volume, integrate_body_force, &
    ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_shape_functions, only: node_coordinates
  use amontons_element_kinds, only: element_kind, element_kind_type, KIND_M3D3, KIND_M3D8R, KIND_CPS3, KIND_CPS4, KIND_CPS6, &
    KIND_CPS8, KIND_CPS8R, MAX_ELEMENT_NODES
  use check, only: suite_type
  implicit none
  integer, parameter :: N_DOF = 3 * MAX_ELEMENT_NODES
  integer, parameter :: PLANE_KIND(0:5) = [KIND_CPS3, KIND_CPS4, KIND_CPS4, KIND_CPS6, KIND_CPS8, KIND_CPS8R]
  real(DP), parameter :: THICKNESS = 0.7_DP
  !> A proper rotation; its columns are the axes of the tilted plane.
  real(DP), parameter :: TILT(3, 3) = reshape([real(DP) :: 2, 1, 2, -2, 2, 1, -1, -2, 2], [3, 3]) / 3
  type(suite_type) :: suite
  type(material_type) :: material
  integer :: kind, law, i, n

  call random_seed(size=n)
  call random_seed(put=[(15485863 + 7919 * i, i=1, n)])
  material%youngs_modulus = 210000
  material%poissons_ratio = 0.3_DP
  do kind = KIND_M3D3, KIND_M3D8R
    do law = LAW_HENCKY, LAW_SAINT_VENANT
      material%law = law
      call check_plane_stress(kind, .true.)
      call check_derivatives(kind, .true.)
    end do
    material%law = LAW_HENCKY
    call check_plane_stress(kind, .false.)
    call check_derivatives(kind, .false.)
    call check_rotation(kind)
    call check_volume(kind)
    call check_exits(kind)
  end do
  call suite%finish()

contains

  !> A distorted element in the plane of the first two coordinates, straight at its edges.
  subroutine distort(kind, amount, X)
    integer, intent(in) :: kind
    real(DP), intent(in) :: amount                 !< [length]
    real(DP), intent(out) :: X(3, MAX_ELEMENT_NODES)
    real(DP), parameter :: A(2, 2) = reshape([1.3_DP, 0.2_DP, -0.1_DP, 0.8_DP], [2, 2])
    real(DP) :: xi(3, MAX_ELEMENT_NODES), r(3, MAX_ELEMENT_NODES)
    type(element_kind_type) :: entry
    integer :: k, corners
    entry = element_kind(kind)
    call node_coordinates(kind, xi)
    call random_number(r)
    X = 0
    X(:2, :) = matmul(A, xi(:2, :)) + amount * (r(:2, :) - 0.5_DP)
    corners = merge(3, 4, entry%n_nodes == 3 .or. entry%n_nodes == 6)
    do k = corners + 1, entry%n_nodes
      X(:, k) = 0.5_DP * (X(:, k - corners) + X(:, modulo(k - corners, corners) + 1))
    end do
  end subroutine distort


  !> The name of a check.
  function title(kind, is_nlgeom, what) result(name)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    character(*), intent(in) :: what
    character(:), allocatable :: name
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    name = trim(entry%name) // merge(' large ', ' small ', is_nlgeom) // what
  end function title


  !> In a tilted plane a membrane has the forces of the plane-stress element, turned.
  subroutine check_plane_stress(kind, is_nlgeom)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), flat(3, MAX_ELEMENT_NODES), tilted(3, MAX_ELEMENT_NODES), &
      matrix(N_DOF, N_DOF)
    type(integration_points_type) :: points, plane
    type(element_kind_type) :: entry
    integer :: n, status, m
    entry = element_kind(kind)
    n = entry%n_nodes
    m = entry%n_points
    call distort(kind, 0.3_DP, X)
    call random_number(u)
    u = 0.2_DP * (u - 0.5_DP)
    u(3, :) = 0
    points%section_value = THICKNESS
    plane%section_value = THICKNESS
    call evaluate_element_forces(PLANE_KIND(kind - KIND_M3D3), material, X(:, :n), u(:, :n), is_nlgeom, flat, plane, status)
    X = matmul(TILT, X)
    u = matmul(TILT, u)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, tilted, points, status, matrix)
    call suite%that(title(kind, is_nlgeom, 'plane stress: status'), status == ELEMENT_OK)
    call suite%near(title(kind, is_nlgeom, 'plane stress: force'), norm2(tilted - matmul(TILT, flat)), 0.0_DP, 1e-11_DP * &
      norm2(flat))
    call suite%near(title(kind, is_nlgeom, 'plane stress: energy'), dot_product(points%energy(:m), points%volume(:m)), &
      dot_product(plane%energy(:m), plane%volume(:m)), 1e-11_DP * dot_product(plane%energy(:m), plane%volume(:m)))
  end subroutine check_plane_stress


  !> The force is the derivative of the energy and the tangent that of the force, on a curved, strongly deformed element.
  subroutine check_derivatives(kind, is_nlgeom)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: STEP = 1e-5_DP
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF)
    real(DP) :: moved(3, MAX_ELEMENT_NODES), fp(3, MAX_ELEMENT_NODES), fm(3, MAX_ELEMENT_NODES), slope, difference(N_DOF), worst, &
      worst_force, unused(N_DOF, N_DOF)
    type(integration_points_type) :: points, plus, minus
    type(element_kind_type) :: entry
    integer :: n, m, a, j, status
    entry = element_kind(kind)
    n = entry%n_nodes
    m = entry%n_points
    call distort(kind, 0.2_DP, X)
    call random_number(u)
    X(3, :) = 0.3_DP * u(1, :)                     ! curved, or warped
    X = matmul(TILT, X)
    call random_number(u)
    u = 0.3_DP * (u - 0.5_DP)
    points%section_value = THICKNESS
    plus%section_value = THICKNESS
    minus%section_value = THICKNESS
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, force, points, status, K)
    call suite%that(title(kind, is_nlgeom, 'derivatives: status'), status == ELEMENT_OK)
    worst = 0
    worst_force = 0
    do a = 1, n
      do j = 1, 3
        moved = u
        moved(j, a) = u(j, a) + STEP
        call evaluate_element_forces(kind, material, X(:, :n), moved(:, :n), is_nlgeom, fp, plus, status, unused)
        moved(j, a) = u(j, a) - STEP
        call evaluate_element_forces(kind, material, X(:, :n), moved(:, :n), is_nlgeom, fm, minus, status, unused)
        difference = reshape((fp - fm) / (2 * STEP), [N_DOF])
        slope = (dot_product(plus%energy(:m), plus%volume(:m)) - dot_product(minus%energy(:m), minus%volume(:m))) / (2 * STEP)
        worst_force = max(worst_force, abs(slope - force(j, a)))
        worst = max(worst, maxval(abs(difference(:3 * n) - K(:3 * n, 3 * (a - 1) + j))))
      end do
    end do
    call suite%near(title(kind, is_nlgeom, 'force by differences of the energy'), worst_force, 0.0_DP, 1e-8_DP * norm2(force))
    call suite%near(title(kind, is_nlgeom, 'tangent by differences of the force'), worst, 0.0_DP, 1e-8_DP * &
      norm2(K(:3 * n, :3 * n)))
    call suite%near(title(kind, is_nlgeom, 'symmetric'), maxval(abs(K(:3 * n, :3 * n) - transpose(K(:3 * n, :3 * n)))), 0.0_DP, &
      0.0_DP)
  end subroutine check_derivatives


  !> A rotation of a stretched membrane turns its stress; without strain there is none.
  subroutine check_rotation(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), turned(3, MAX_ELEMENT_NODES)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    points%section_value = THICKNESS
    u = matmul(TILT, X) - X
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%near(title(kind, .true., 'rotation: no stress'), maxval(abs(points%stress(:, :entry%n_points))), 0.0_DP, &
      1e-13_DP * material%youngs_modulus)
    call random_number(u)
    u(3, :) = 0
    u = 0.1_DP * u
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    u = matmul(TILT, X + u) - X
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., turned, points, status)
    call suite%near(title(kind, .true., 'rotation: turned force'), norm2(turned - matmul(TILT, force)), 0.0_DP, 1e-11_DP * &
      norm2(force))
  end subroutine check_rotation


  !> Volume, and body forces that add up to force times volume.
  subroutine check_volume(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: b(3) = [1.0_DP, -2.0_DP, 5.0_DP], JACOBIAN = 1.06_DP
    real(DP) :: X(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), volume, expected
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.0_DP, X)
    X = matmul(TILT, X)
    call evaluate_element_volume(kind, X(:, :n), THICKNESS, volume, status)
    expected = JACOBIAN * THICKNESS * merge(0.5_DP, 4.0_DP, n == 3 .or. n == 6)
    call suite%that(title(kind, .false., 'volume: status'), status == ELEMENT_OK)
    call suite%near(title(kind, .false., 'volume'), volume, expected, 1e-13_DP * expected)
    force = 0
    call integrate_body_force(kind, X(:, :n), THICKNESS, b, force)
    call suite%near(title(kind, .false., 'body force: sum'), maxval(abs(sum(force, 2) - b * volume)), 0.0_DP, 1e-12_DP * volume)
  end subroutine check_volume


  !> A membrane that shrinks to a line, NaN, and nodes on a line.
  subroutine check_exits(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), volume
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.0_DP, X)
    points%section_value = THICKNESS
    u = 0
    u(:2, :) = -X(:2, :)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that(title(kind, .true., 'exit: a point'), status == ELEMENT_INVERTED)
    u(2, n) = ieee_value(1.0_DP, ieee_quiet_nan)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .false., force, points, status)
    call suite%that(title(kind, .false., 'exit: NaN'), status == ELEMENT_NOT_FINITE)
    u(2, n) = 1e200_DP
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that(title(kind, .true., 'exit: beyond all bounds'), status == ELEMENT_NOT_FINITE)
    X(2, :) = 0
    call evaluate_element_volume(kind, X(:, :n), THICKNESS, volume, status)
    call suite%that(title(kind, .true., 'exit: on a line'), status == ELEMENT_DEGENERATE)
  end subroutine check_exits

end program test_membrane_elements
