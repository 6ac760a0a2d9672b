!> Unit test of amontons_plane_elements: patch, energy, tangent, rotation, modes, pressure on edges, body force, error exits.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_plane_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_element, only: integration_points_type, evaluate_element_forces, evaluate_element_tangent, evaluate_element_volume, &
    integrate_body_force, integrate_edge_pressure, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_kinds, only: DP, PI
  use amontons_materials, only: material_type, LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_shape_functions, only: node_coordinates, shape_functions
  use amontons_element_kinds, only: element_kind, element_kind_type, KIND_CPS3, KIND_CPS4, KIND_CPE4, KIND_CPE4_FULL, &
    KIND_CAX3, KIND_CAX4, KIND_CAX4_FULL, KIND_CAX4R, KIND_CPE4I, KIND_CAX4I, KIND_CAX_SHELL, &
    KIND_CPS8R, KIND_CPE8R, MAX_ELEMENT_NODES, MAX_FACE_NODES, &
    FAMILY_PLANE_STRESS, FAMILY_PLANE_STRAIN, FAMILY_AXISYMMETRIC, FACET_LINE2, FACET_LINE3
  use check, only: suite_type
  implicit none
  integer, parameter :: N_DOF = 3 * MAX_ELEMENT_NODES
  real(DP), parameter :: THICKNESS = 0.7_DP
  type(suite_type) :: suite
  type(material_type) :: material
  integer :: kind, law, i, n

  call random_seed(size=n)
  call random_seed(put=[(15485863 + 7919 * i, i=1, n)])
  material%youngs_modulus = 210000
  material%poissons_ratio = 0.3_DP
  do kind = KIND_CPS3, KIND_CAX_SHELL
    do law = LAW_HENCKY, LAW_SAINT_VENANT
      material%law = law
      call check_patch(kind, .true.)
      call check_derivatives(kind, .true.)
      call check_tiny(kind)
    end do
    material%law = LAW_HENCKY
    call check_patch(kind, .false.)
    call check_derivatives(kind, .false.)
    call check_rotation(kind)
    call check_volume(kind)
    call check_modes(kind)
    call check_exits(kind)
  end do
  call check_no_locking()
  do i = FAMILY_PLANE_STRESS, FAMILY_AXISYMMETRIC
    call check_edge(i, FACET_LINE2)
    call check_edge(i, FACET_LINE3)
  end do
  call suite%finish()

contains

  !> A distorted element away from the axis; the third coordinates are zero.
  subroutine distort(kind, amount, X)
    integer, intent(in) :: kind
    real(DP), intent(in) :: amount                 !< of the corners, and a tenth of it for the mid-side nodes
    real(DP), intent(out) :: X(3, MAX_ELEMENT_NODES)
    real(DP), parameter :: A(2, 2) = reshape([1.3_DP, 0.2_DP, -0.1_DP, 0.8_DP], [2, 2])
    real(DP) :: xi(3, MAX_ELEMENT_NODES), r(3, MAX_ELEMENT_NODES), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), place(2)
    type(element_kind_type) :: entry
    integer :: b
    entry = element_kind(kind)
    call node_coordinates(kind, xi)
    call random_number(r)
    X = 0
    X(:2, :) = matmul(A, xi(:2, :)) + amount * (r(:2, :) - 0.5_DP)
    X(1, :) = X(1, :) + 4
    do b = entry%n_faces + 1, entry%n_nodes
      call shape_functions(merge(KIND_CPS3, KIND_CPS4, entry%n_faces == 3), xi(:, b), N, dN)
      place = matmul(X(:2, :entry%n_faces), N(:entry%n_faces))
      X(:2, b) = place + 0.1_DP * amount * (r(:2, b) - 0.5_DP)
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


  !> A linear displacement field (axisymmetric: u_x = a X, u_y = b Y, so that the hoop strain is a too) gives the same
  !! stress everywhere; plane stress has zero transverse stress, plane strain zero transverse strain.
  subroutine check_patch(kind, is_nlgeom)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: H(2, 2) = reshape([0.2_DP, 0.1_DP, -0.3_DP, -0.1_DP], [2, 2])
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: p, status, n
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.3_DP, X)
    u = 0
    u(:2, :) = matmul(H, X(:2, :))
    if (entry%family == FAMILY_AXISYMMETRIC) u(:2, :) = spread([0.2_DP, -0.1_DP], 2, MAX_ELEMENT_NODES) * X(:2, :)
    points%section_value = THICKNESS
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, force, points, status)
    call suite%that(title(kind, is_nlgeom, 'patch: status'), status == ELEMENT_OK)
    do p = 1, entry%n_points
      call suite%near(title(kind, is_nlgeom, 'patch: uniform'), maxval(abs(points%stress(:, p) - points%stress(:, 1))), &
        0.0_DP, 1e-11_DP * maxval(abs(points%stress(:, 1))))
      if (entry%family == FAMILY_PLANE_STRESS) call suite%near(title(kind, is_nlgeom, 'patch: plane stress'), &
        points%stress(3, p), 0.0_DP, 0.0_DP)
      if (entry%family == FAMILY_PLANE_STRAIN) call suite%near(title(kind, is_nlgeom, 'patch: plane strain'), &
        points%strain(3, p), 0.0_DP, 1e-14_DP)
      if (entry%family == FAMILY_AXISYMMETRIC) call suite%near(title(kind, is_nlgeom, 'patch: hoop'), &
        points%strain(3, p), merge(merge(0.22_DP, log(1.2_DP), material%law == LAW_SAINT_VENANT), 0.2_DP, is_nlgeom), &
        1e-14_DP)
    end do
    call suite%that(title(kind, is_nlgeom, 'patch: no force out of the plane'), all(abs(force(3, :)) <= 0))
    if (is_nlgeom) return
    associate (E => material%youngs_modulus, nu => material%poissons_ratio, strain => points%strain(:, 1))
      if (entry%family == FAMILY_PLANE_STRESS) call suite%near(title(kind, is_nlgeom, 'patch: Hooke'), points%stress(1, 1), &
        E / (1 - nu**2) * (0.2_DP - 0.1_DP * nu), 1e-9_DP * E)
      call suite%near(title(kind, is_nlgeom, 'patch: energy'), points%energy(1), 0.5_DP * (dot_product(strain(:3), &
        points%stress(:3, 1)) + 2 * strain(4) * points%stress(4, 1)), 1e-11_DP * E)
    end associate
  end subroutine check_patch


  !> The force is the derivative of the energy and the tangent that of the force, on a distorted, strongly deformed element.
  subroutine check_derivatives(kind, is_nlgeom)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: STEP = 1e-5_DP
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF)
    real(DP) :: moved(3, MAX_ELEMENT_NODES), fp(3, MAX_ELEMENT_NODES), fm(3, MAX_ELEMENT_NODES), slope, difference(N_DOF), worst, &
      worst_force
    type(integration_points_type) :: points, plus, minus
    type(element_kind_type) :: entry
    integer :: n, a, j, status
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    call random_number(u)
    u(:2, :) = 0.2_DP * (u(:2, :) - 0.5_DP) + matmul(reshape([-0.2_DP, 0.4_DP, -0.3_DP, 0.1_DP], [2, 2]), X(:2, :))
    u(1, :) = u(1, :) + 0.5_DP
    u(3, :) = 0
    points%section_value = THICKNESS
    plus%section_value = THICKNESS
    minus%section_value = THICKNESS
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, force, points, status, K)
    call suite%that(title(kind, is_nlgeom, 'system: status'), status == ELEMENT_OK)
    worst = 0
    worst_force = 0
    do a = 1, n
      do j = 1, 2
        moved = u
        moved(j, a) = u(j, a) + STEP
        call evaluate_element_forces(kind, material, X(:, :n), moved(:, :n), is_nlgeom, fp, plus, status)
        moved(j, a) = u(j, a) - STEP
        call evaluate_element_forces(kind, material, X(:, :n), moved(:, :n), is_nlgeom, fm, minus, status)
        difference = reshape((fp - fm) / (2 * STEP), [N_DOF])
        slope = sum((plus%energy(:entry%n_points) - minus%energy(:entry%n_points)) * plus%volume(:entry%n_points)) &
          / (2 * STEP)
        worst_force = max(worst_force, abs(slope - force(j, a)))
        worst = max(worst, maxval(abs(difference(:3 * n) - K(:3 * n, 3 * (a - 1) + j))))
      end do
    end do
    call suite%near(title(kind, is_nlgeom, 'force by differences of the energy'), worst_force, 0.0_DP, 1e-8_DP * &
      norm2(force))
    call suite%near(title(kind, is_nlgeom, 'tangent by differences of the force'), worst, 0.0_DP, &
      1e-8_DP * norm2(K(:3 * n, :3 * n)))
    call suite%near(title(kind, is_nlgeom, 'symmetric'), maxval(abs(K(:3 * n, :3 * n) - transpose(K(:3 * n, :3 * n)))), &
      0.0_DP, 0.0_DP)
    call suite%that(title(kind, is_nlgeom, 'nothing out of the plane'), all(abs(K(3:3 * n:3, :3 * n)) <= 0))
  end subroutine check_derivatives


  !> At displacements of 1e-9 the finite theory gives the forces and tangent of the small one to 1e-8.
  subroutine check_tiny(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), f1(3, MAX_ELEMENT_NODES), f2(3, MAX_ELEMENT_NODES), K1(N_DOF, &
      N_DOF), K2(N_DOF, N_DOF)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    call random_number(u)
    u = 1e-9_DP * u
    points%section_value = THICKNESS
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., f1, points, status, K1)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .false., f2, points, status, K2)
    call suite%near(title(kind, .true., 'tiny: force'), norm2(f1 - f2), 0.0_DP, 3e-8_DP * norm2(f2))
    call suite%near(title(kind, .true., 'tiny: tangent'), norm2(K1(:3 * n, :3 * n) - K2(:3 * n, :3 * n)), 0.0_DP, &
      2e-8_DP * norm2(K2(:3 * n, :3 * n)))
  end subroutine check_tiny


  !> A translation gives exactly zero, along the axis too; a rotation gives only rounding (plane kinds).
  subroutine check_rotation(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    points%section_value = THICKNESS
    u = 0
    u(2, :) = 1.234567e6_DP
    if (entry%family /= FAMILY_AXISYMMETRIC) u(1, :) = -1.0_DP / 3
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%near(title(kind, .true., 'translation: force'), maxval(abs(force)), 0.0_DP, 0.0_DP)
    if (entry%family == FAMILY_AXISYMMETRIC) return
    u(:2, :) = matmul(reshape([-0.4_DP, 0.8_DP, -0.8_DP, -0.4_DP], [2, 2]), X(:2, :))
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%near(title(kind, .true., 'rotation: stress'), maxval(abs(points%stress(:, :entry%n_points))), 0.0_DP, &
      1e-13_DP * material%youngs_modulus)
  end subroutine check_rotation


  !> Volume by Pappus or thickness, and body forces that add up to force times volume.
  subroutine check_volume(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: b(3) = [1.0_DP, -2.0_DP, 5.0_DP], JACOBIAN = 1.06_DP
    real(DP) :: X(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), volume, expected
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.0_DP, X)
    call evaluate_element_volume(kind, X(:, :n), THICKNESS, volume, status)
    expected = JACOBIAN * merge(0.5_DP, 4.0_DP, entry%n_faces == 3)
    if (entry%family == FAMILY_AXISYMMETRIC) then
      expected = expected * 2 * PI * sum(X(1, :entry%n_faces)) / real(entry%n_faces, DP)
    else
      expected = expected * THICKNESS
    end if
    call suite%that(title(kind, .false., 'volume: status'), status == ELEMENT_OK)
    call suite%near(title(kind, .false., 'volume'), volume, expected, 1e-13_DP * expected)
    call integrate_body_force(kind, X(:, :n), THICKNESS, b, force)
    call suite%near(title(kind, .false., 'body force: sum'), maxval(abs(sum(force(:2, :), 2) - b(:2) * volume)), 0.0_DP, &
      1e-12_DP * volume)
    call suite%that(title(kind, .false., 'body force: none across'), all(abs(force(3, :)) <= 0))
  end subroutine check_volume


  !> Three modes have zero energy in the plane, one about an axis; the reduced quadratic quadrilaterals have one more, and so have
  !! axisymmetric kinds of one point (a rotation about the point); these modes do not propagate through a mesh.
  subroutine check_modes(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF), values(24)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status, expected, a, b, i, j
    real(DP) :: flat(16, 16)
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    points%section_value = THICKNESS
    call evaluate_element_tangent(kind, material, X(:, :n), 0 * X(:, :n), .false., K, points, status)
    do concurrent(a=1:n, b=1:n, i=1:2, j=1:2)
      flat(2 * a - 2 + i, 2 * b - 2 + j) = K(3 * a - 3 + i, 3 * b - 3 + j)
    end do
    call find_eigenvalues(flat(:2 * n, :2 * n), values(:2 * n))
    expected = merge(1, 3, entry%family == FAMILY_AXISYMMETRIC)
    if (kind == KIND_CPS8R .or. kind == KIND_CPE8R) expected = 4
    if (kind == KIND_CAX3 .or. kind == KIND_CAX4R) expected = 2
    call suite%that(title(kind, .false., 'number of modes without energy'), &
      count(abs(values(:2 * n)) < 1e-10_DP * maxval(values(:2 * n))) == expected)
    call suite%that(title(kind, .false., 'no negative mode'), &
      minval(values(:2 * n)) > -1e-13_DP * maxval(values(:2 * n)))
  end subroutine check_modes


  !> Near incompressibility one mode of CPE4 and CAX4 is stiff; without mean dilatation more are.
  subroutine check_no_locking()
    real(DP) :: X(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF), values(12)
    type(material_type) :: rubber
    type(integration_points_type) :: points
    integer :: status
    rubber%youngs_modulus = 3
    rubber%poissons_ratio = 0.5_DP - 1e-7_DP
    points%section_value = 1
    call distort(KIND_CPE4, 0.2_DP, X)
    call evaluate_element_tangent(KIND_CPE4, rubber, X(:, :4), 0 * X(:, :4), .false., K, points, status)
    call find_eigenvalues(K(:12, :12), values)
    call suite%that('CPE4: one stiff mode', count(values > 1e4_DP) == 1)
    call evaluate_element_tangent(KIND_CAX4, rubber, X(:, :4), 0 * X(:, :4), .true., K, points, status)
    call find_eigenvalues(K(:12, :12), values)
    call suite%that('CAX4 large: one stiff mode', count(values > 1e4_DP) == 1)
    call evaluate_element_tangent(KIND_CPE4_FULL, rubber, X(:, :4), 0 * X(:, :4), .false., K, points, status)
    call find_eigenvalues(K(:12, :12), values)
    call suite%that('CPE4 plain: many stiff modes', count(values > 1e4_DP) > 1)
    call evaluate_element_tangent(KIND_CPE4I, rubber, X(:, :4), 0 * X(:, :4), .false., K, points, status)
    call find_eigenvalues(K(:12, :12), values)
    call suite%that('CPE4I: one stiff mode', count(values > 1e4_DP) == 1)
    call evaluate_element_tangent(KIND_CAX4I, rubber, X(:, :4), 0 * X(:, :4), .true., K, points, status)
    call find_eigenvalues(K(:12, :12), values)
    call suite%that('CAX4I large: one stiff mode', count(values > 1e4_DP) == 1)
    call evaluate_element_tangent(KIND_CAX4_FULL, rubber, X(:, :4), 0 * X(:, :4), .true., K, points, status)
    call find_eigenvalues(K(:12, :12), values)
    call suite%that('CAX4 plain: many stiff modes', count(values > 1e4_DP) > 1)
  end subroutine check_no_locking


  !> Eigenvalues of a symmetric matrix by cyclic Jacobi rotations: slow and reliable.
  subroutine find_eigenvalues(matrix, values)
    real(DP), intent(in) :: matrix(:, :)
    real(DP), intent(out) :: values(:)
    real(DP) :: A(size(values), size(values)), t, c, s, row(size(values)), theta
    integer :: sweep, p, q
    A = matrix
    do sweep = 1, 12
      do p = 1, size(values) - 1
        do q = p + 1, size(values)
          if (abs(A(p, q)) <= 1e-300_DP) cycle
          theta = (A(q, q) - A(p, p)) / (2 * A(p, q))
          t = sign(1.0_DP, theta) / (abs(theta) + sqrt(1 + theta**2))
          if (abs(theta) > 1e100_DP) t = 0
          c = 1 / sqrt(1 + t**2)
          s = t * c
          row = c * A(p, :) - s * A(q, :)
          A(q, :) = s * A(p, :) + c * A(q, :)
          A(p, :) = row
          row = c * A(:, p) - s * A(:, q)
          A(:, q) = s * A(:, p) + c * A(:, q)
          A(:, p) = row
        end do
      end do
    end do
    do p = 1, size(values)
      values(p) = A(p, p)
    end do
  end subroutine find_eigenvalues


  !> A pressure on a straight edge pushes to its left, with the right sum; the load stiffness agrees with differences.
  subroutine check_edge(family, edge)
    integer, intent(in) :: family, edge
    real(DP), parameter :: STEP = 1e-6_DP
    real(DP) :: x(3, 3), moved(3, 3), r(3, 3), force(3, MAX_FACE_NODES), fp(3, MAX_FACE_NODES), fm(3, MAX_FACE_NODES)
    real(DP) :: K(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES), unused(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES), depth, width
    integer :: n, a, j
    n = merge(2, 3, edge == FACET_LINE2)
    x = reshape([real(DP) :: 2, 0, 0, 4, 0, 0, 3, 0, 0], [3, 3])
    depth = merge(2 * PI * 3, THICKNESS, family == FAMILY_AXISYMMETRIC)
    width = merge(-1.0_DP, THICKNESS, family == FAMILY_AXISYMMETRIC)
    call integrate_edge_pressure(edge, x(:, :n), width, 5.0_DP, force, K, edge)
    call suite%near('edge: sum, pushes to the left', maxval(abs(sum(force, 2) - [0.0_DP, 10 * depth, 0.0_DP])), 0.0_DP, &
      1e-12_DP * depth)
    call random_number(r)
    x(:2, :) = x(:2, :) + 0.3_DP * (r(:2, :) - 0.5_DP)
    call integrate_edge_pressure(edge, x(:, :n), width, 5.0_DP, force, K, edge)
    do a = 1, n
      do j = 1, 2
        moved = x
        moved(j, a) = x(j, a) + STEP
        call integrate_edge_pressure(edge, moved(:, :n), width, 5.0_DP, fp, unused, edge)
        moved(j, a) = x(j, a) - STEP
        call integrate_edge_pressure(edge, moved(:, :n), width, 5.0_DP, fm, unused, edge)
        call suite%near('edge: load stiffness', norm2(reshape((fp - fm) / (2 * STEP), [3 * MAX_FACE_NODES]) &
          - K(:, 3 * (a - 1) + j)), 0.0_DP, 1e-8_DP * norm2(K))
      end do
    end do
  end subroutine check_edge


  !> Inverted elements, NaN, and a mesh with clockwise node order.
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
    u(2, :) = -2 * X(2, :)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that(title(kind, .true., 'exit: inverted'), status == ELEMENT_INVERTED)
    u(2, n) = ieee_value(1.0_DP, ieee_quiet_nan)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .false., force, points, status)
    call suite%that(title(kind, .false., 'exit: NaN'), status == ELEMENT_NOT_FINITE)
    u(2, n) = 1e200_DP
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that(title(kind, .true., 'exit: beyond all bounds'), status == ELEMENT_NOT_FINITE)
    X(2, :) = -X(2, :)
    call evaluate_element_volume(kind, X(:, :n), THICKNESS, volume, status)
    call suite%that(title(kind, .true., 'exit: clockwise'), status == ELEMENT_DEGENERATE .and. volume < 0)
  end subroutine check_exits

end program test_plane_elements
