!> Unit test of amontons_element: patch, rigid motion, energy, tangent, modes, pressure, error exits, for every kind.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_element
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
  use amontons_element, only: integration_points_type, evaluate_element_forces, evaluate_element_tangent, evaluate_element_volume, &
    integrate_body_force, integrate_facet_pressure, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_shape_functions, only: node_coordinates, shape_functions
  use amontons_elasticity, only: small_strain_stress, finite_strain_stress
  use amontons_tensor, only: IDENTITY, cross_product, pack_voigt, determinant
  use amontons_element_kinds, only: element_kind, facet_kind, element_kind_type, facet_kind_type, MAX_ELEMENT_NODES, &
    MAX_FACE_NODES, &
    KIND_BEAM_RECT, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, KIND_C3D10, KIND_C3D15, &
    KIND_C3D20R, KIND_CSS8, KIND_CSS6, FACET_TRI3, FACET_QUAD8
  use check, only: suite_type
  implicit none
  integer, parameter :: N_DOF = 3 * MAX_ELEMENT_NODES
  type(suite_type) :: suite
  type(material_type) :: material
  integer :: kind, law, i, n
  logical :: is_whole                              !< CSS6: the only layer of a shell
  real(DP) :: stack_bending(2, 2) = 0              !< CSS6: one of several

  call random_seed(size=n)
  call random_seed(put=[(15485863 + 7919 * i, i=1, n)])
  is_whole = .false.
  material%youngs_modulus = 210000
  material%poissons_ratio = 0.3_DP
  do kind = 1, KIND_BEAM_RECT
    do law = LAW_HENCKY, LAW_SAINT_VENANT
      material%law = law
      call check_patch(kind, .true.)
      call check_derivatives(kind, .true.)
      call check_forces_alone(kind)
      call check_tiny(kind)
    end do
    material%law = LAW_HENCKY
    call check_patch(kind, .false.)
    call check_derivatives(kind, .false.)
    call check_rigid_motion(kind)
    call check_balance(kind)
    call check_volume(kind)
    call check_modes(kind)
    call check_hydrostatic(kind)
    call check_exits(kind)
  end do
  do i = 1, 3                                      ! CSS6 alone, in a stack; the quadratic solid shell
    is_whole = i /= 2
    stack_bending = merge(1.0e4_DP, 0.0_DP, i == 2) * reshape([real(DP) :: 3, 1, 1, 2], [2, 2])
    kind = merge(KIND_C3D15, KIND_CSS6, i == 3)
    do law = LAW_HENCKY, LAW_SAINT_VENANT
      material%law = law
      call check_derivatives(kind, .true.)
      call check_forces_alone(kind)
      call check_tiny(kind)
    end do
    material%law = LAW_HENCKY
    call check_derivatives(kind, .false.)
    call check_rigid_motion(kind)
    call check_balance(kind)
    call check_modes(kind)
    call check_hydrostatic(kind)
    call check_exits(kind)
  end do
  stack_bending = 0
  is_whole = .false.
  call check_no_locking()
  call check_mean_dilatation()
  do kind = FACET_TRI3, FACET_QUAD8
    call check_pressure(kind)
  end do
  call suite%finish()

contains

  !> A distorted element: a sheared parent element with straight edges whose corners are moved at random.
  subroutine distort(kind, amount, X)
    integer, intent(in) :: kind
    real(DP), intent(in) :: amount                 !< of the corners, and a tenth of it for the mid-side nodes
    real(DP), intent(out) :: X(3, MAX_ELEMENT_NODES)
    real(DP), parameter :: A(3, 3) = reshape([1.3_DP, 0.2_DP, -0.1_DP, 0.1_DP, 0.8_DP, 0.3_DP, -0.2_DP, 0.1_DP, &
      1.1_DP], [3, 3])
    real(DP) :: xi(3, MAX_ELEMENT_NODES), r(3, MAX_ELEMENT_NODES), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), straight(3, &
      MAX_ELEMENT_NODES)
    type(element_kind_type) :: entry
    integer :: linear, corners, a_node
    entry = element_kind(kind)
    call node_coordinates(kind, xi)
    call random_number(r)
    X = matmul(A, xi) + amount * (r - 0.5_DP)
    linear = 0
    if (entry%n_nodes == 10) linear = 1
    if (entry%n_nodes == 15) linear = KIND_C3D6
    if (entry%n_nodes == 20) linear = KIND_C3D8
    if (linear == 0) return
    corners = 2 + 2 * linear
    call random_number(r)
    do a_node = corners + 1, entry%n_nodes
      call shape_functions(linear, xi(:, a_node), N, dN)
      straight(:, a_node) = matmul(X(:, :corners), N(:corners))
      X(:, a_node) = straight(:, a_node) + 0.1_DP * amount * (r(:, a_node) - 0.5_DP)
    end do
  end subroutine distort


  !> The name of a check: the element and what is tested.
  function title(kind, is_nlgeom, what) result(name)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    character(*), intent(in) :: what
    character(:), allocatable :: name
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    name = trim(entry%name) // merge(' plain', merge(' whole', '      ', is_whole), kind == KIND_C3D8_FULL) // &
      merge(' large ', ' small ', is_nlgeom) // what
  end function title


  !> Forces without a stiffness by the general law of a material, after the stiffness of a much stiffer one: those of the same
  !! elastic constants, also of the hourglass energy, which needs the tangent at rest.
  subroutine check_forces_alone(kind)
    integer, intent(in) :: kind
    type(material_type) :: general
    type(integration_points_type) :: points
    real(DP), dimension(3, MAX_ELEMENT_NODES) :: X, u, force, expected
    real(DP) :: stiffness(N_DOF, N_DOF)
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    n = entry%n_nodes
    call distort(kind, 0.3_DP, X)
    call random_number(u)
    u = 0.1_DP * (u - 0.5_DP)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., expected, points, status)
    general = material
    general%is_linear_isotropic = .false.
    points%has_frame = .false.
    points%temperature = 0
    points%initial_temperature = 0
    points%history_old = 0
    general%youngs_modulus = 1.0e6_DP * material%youngs_modulus
    call evaluate_element_tangent(kind, general, X(:, :n), u(:, :n), .true., stiffness, points, status)
    general%youngs_modulus = material%youngs_modulus
    call evaluate_element_forces(kind, general, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that(title(kind, .true., 'forces alone: status'), status == ELEMENT_OK)
    call suite%near(title(kind, .true., 'forces alone: general law'), maxval(abs(force(:, :n) - expected(:, :n))), 0.0_DP, &
      1e-12_DP * norm2(expected(:, :n)))
  end subroutine check_forces_alone


  !> A linear displacement field gives the same stress everywhere, that of the law; in solid shells of uniform thickness, which are
  !! distorted in their plane here.
  subroutine check_patch(kind, is_nlgeom)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: H(3, 3) = reshape([0.3_DP, 0.1_DP, -0.2_DP, -0.4_DP, -0.1_DP, 0.1_DP, 0.2_DP, 0.3_DP, &
      0.2_DP], [3, 3])
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), expected(6), strain(6), c(6, 6), &
      energy
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: p, status, n
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.3_DP, X)
    if (kind == KIND_CSS8 .or. kind == KIND_CSS6) then
      X(3, :n / 2) = 0.2_DP * X(1, :n / 2)
      X(:, n / 2 + 1:n) = X(:, :n / 2) + spread([0.1_DP, -0.2_DP, 1.0_DP], 2, n / 2)
    end if
    u = matmul(H, X)
    u(3, :) = u(3, :) + 5
    if (is_nlgeom) then
      call finite_strain_stress(material, H, expected, c, strain, energy, status)
      expected = expected / determinant(IDENTITY + H)
    else
      strain = pack_voigt(H)
      call small_strain_stress(material, strain, expected, c, energy)
    end if
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, force, points, status)
    call suite%that(title(kind, is_nlgeom, 'patch: status'), status == ELEMENT_OK)
    do p = 1, entry%n_points
      call suite%near(title(kind, is_nlgeom, 'patch: stress'), maxval(abs(points%stress(:, p) - expected)), 0.0_DP, &
        1e-12_DP * maxval(abs(expected)))
      call suite%near(title(kind, is_nlgeom, 'patch: strain'), maxval(abs(points%strain(:, p) - strain)), 0.0_DP, &
        1e-13_DP)
      call suite%near(title(kind, is_nlgeom, 'patch: energy'), points%energy(p), energy, 1e-12_DP * energy)
    end do
    call suite%that(title(kind, is_nlgeom, 'patch: no force past the nodes'), all(abs(force(:, n + 1:)) <= 0))
  end subroutine check_patch


  !> The force is the derivative of the energy and the tangent that of the force, on a distorted, rotated, strongly
  !! deformed element; the three procedures agree to the last bit, and the tangent is symmetric.
  subroutine check_derivatives(kind, is_nlgeom)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: STEP = 1e-5_DP
    real(DP), parameter :: H(3, 3) = reshape([-0.6_DP, 0.9_DP, 0.1_DP, -0.8_DP, -0.4_DP, 0.3_DP, 0.2_DP, 0.1_DP, &
      0.2_DP], [3, 3])
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF), again(3, &
      MAX_ELEMENT_NODES)
    real(DP) :: K_again(N_DOF, N_DOF), differences(N_DOF, N_DOF), fp(3, MAX_ELEMENT_NODES), fm(3, MAX_ELEMENT_NODES), wp, wm, &
      slope(N_DOF)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, a, j, dof, status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    call random_number(u)
    u = 0.2_DP * (u - 0.5_DP) + matmul(H, X)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, force, points, status, K)
    call suite%that(title(kind, is_nlgeom, 'system: status'), status == ELEMENT_OK)
    do a = 1, n
      do j = 1, 3
        dof = 3 * (a - 1) + j
        call displaced(kind, is_nlgeom, X, u, a, j, STEP, fp, wp)
        call displaced(kind, is_nlgeom, X, u, a, j, -STEP, fm, wm)
        differences(:, dof) = reshape((fp - fm) / (2 * STEP), [N_DOF])
        slope(dof) = (wp - wm) / (2 * STEP)
      end do
    end do
    associate (size_of => norm2(K(:3 * n, :3 * n)))
      call suite%near(title(kind, is_nlgeom, 'force by differences of the energy'), &
        maxval(abs(slope(:3 * n) - reshape(force(:, :n), [3 * n]))), 0.0_DP, 1e-8_DP * norm2(force))
      call suite%near(title(kind, is_nlgeom, 'tangent by differences of the force'), &
        norm2(K(:3 * n, :3 * n) - differences(:3 * n, :3 * n)), 0.0_DP, 1e-8_DP * size_of)
      call suite%near(title(kind, is_nlgeom, 'symmetric'), &
        maxval(abs(K(:3 * n, :3 * n) - transpose(K(:3 * n, :3 * n)))), 0.0_DP, 0.0_DP)
    end associate
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, again, points, status)
    call suite%near(title(kind, is_nlgeom, 'forces alone'), maxval(abs(again - force)), 0.0_DP, 1e-15_DP * norm2(force))
    call evaluate_element_tangent(kind, material, X(:, :n), u(:, :n), is_nlgeom, K_again, points, status)
    call suite%near(title(kind, is_nlgeom, 'tangent alone'), maxval(abs(K_again(:3 * n, :3 * n) - K(:3 * n, :3 * n))), &
      0.0_DP, 0.0_DP)
  end subroutine check_derivatives


  !> Force and energy after one node has moved a little.
  subroutine displaced(kind, is_nlgeom, X, u, a, j, step, force, energy)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), step
    integer, intent(in) :: a, j
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES), energy
    real(DP) :: moved(3, MAX_ELEMENT_NODES)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    moved = u
    moved(j, a) = moved(j, a) + step
    call evaluate_element_forces(kind, material, X(:, :entry%n_nodes), moved(:, :entry%n_nodes), is_nlgeom, force, points, &
      status)
    energy = sum(points%energy(:entry%n_points) * points%volume(:entry%n_points))
  end subroutine displaced


  !> At displacements of 1e-9 the finite theory gives the forces and tangent of the small one to 1e-8.
  subroutine check_tiny(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), f1(3, MAX_ELEMENT_NODES), f2(3, MAX_ELEMENT_NODES), K1(N_DOF, &
      N_DOF), K2(N_DOF, N_DOF)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    call random_number(u)
    u = 1e-9_DP * u
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., f1, points, status, K1)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .false., f2, points, status, K2)
    call suite%near(title(kind, .true., 'tiny: force'), norm2(f1 - f2), 0.0_DP, 2e-8_DP * norm2(f2))
    call suite%near(title(kind, .true., 'tiny: tangent'), norm2(K1(:3 * n, :3 * n) - K2(:3 * n, :3 * n)), 0.0_DP, &
      2e-8_DP * norm2(K2(:3 * n, :3 * n)))
  end subroutine check_tiny


  !> Any translation gives exactly zero force; a rotation gives only rounding, and rotates the tangent.
  subroutine check_rigid_motion(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: Q(3, 3) = reshape([0.36_DP, 0.48_DP, -0.8_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.48_DP, 0.64_DP, &
      0.6_DP], [3, 3])
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), K0(N_DOF, N_DOF), K(N_DOF, N_DOF), &
      worst
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, a, b, status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    u = spread([1.234567e6_DP, -0.1_DP, 1.0_DP / 3], 2, MAX_ELEMENT_NODES)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%near(title(kind, .true., 'translation: force'), maxval(abs(force)), 0.0_DP, 0.0_DP)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .false., force, points, status)
    call suite%near(title(kind, .false., 'translation: force'), maxval(abs(force)), 0.0_DP, 0.0_DP)
    call evaluate_element_tangent(kind, material, X(:, :n), 0 * u(:, :n), .true., K0, points, status)
    u = matmul(Q - IDENTITY, X)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status, K)
    call suite%near(title(kind, .true., 'rotation: stress'), maxval(abs(points%stress(:, :entry%n_points))), 0.0_DP, &
      1e-14_DP * material%youngs_modulus)
    worst = 0
    do b = 1, n
      do a = 1, n
        associate (turned => K(3 * a - 2:3 * a, 3 * b - 2:3 * b), straight => K0(3 * a - 2:3 * a, 3 * b - 2:3 * b))
          worst = max(worst, maxval(abs(turned - matmul(Q, matmul(straight, transpose(Q))))))
        end associate
      end do
    end do
    call suite%near(title(kind, .true., 'rotation: tangent'), worst, 0.0_DP, 1e-13_DP * maxval(abs(K0(:3 * n, :3 * n))))
  end subroutine check_rigid_motion


  !> Internal forces have zero sum and moment: about the current positions under NLGEOM, the reference ones without.
  subroutine check_balance(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), place(3, MAX_ELEMENT_NODES), &
      moment(3)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    logical :: is_nlgeom
    integer :: n, a, i, status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    call random_number(u)
    u = 0.2_DP * u
    do i = 1, 2
      is_nlgeom = i == 2
      call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, force, points, status)
      place = X
      if (is_nlgeom) place = X + u
      moment = 0
      do a = 1, n
        moment = moment + cross_product(place(:, a), force(:, a))
      end do
      call suite%near(title(kind, is_nlgeom, 'sum of forces'), maxval(abs(sum(force, 2))), 0.0_DP, &
        1e-14_DP * norm2(force))
      call suite%near(title(kind, is_nlgeom, 'sum of moments'), maxval(abs(moment)), 0.0_DP, 1e-14_DP * norm2(force))
    end do
  end subroutine check_balance


  !> The volume of an affine element, and body forces that add up to force times volume and to their first moment.
  subroutine check_volume(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: b(3) = [1.0_DP, -2.0_DP, 0.5_DP]
    real(DP) :: X(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), volume, parent, centre(3), moment(3)
    type(element_kind_type) :: entry
    integer :: n, a, corners, status
    entry = element_kind(kind)
    n = entry%n_nodes
    call distort(kind, 0.0_DP, X)
    call evaluate_element_volume(kind, X(:, :n), 1.0_DP, volume, status)
    parent = 8
    if (n == 4 .or. n == 10) parent = 1.0_DP / 6
    if (n == 6 .or. n == 15) parent = 1
    call suite%that(title(kind, .false., 'volume: status'), status == ELEMENT_OK)
    call suite%near(title(kind, .false., 'volume'), volume, 1.054_DP * parent, 1e-14_DP)
    call integrate_body_force(kind, X(:, :n), 1.0_DP, b, force)
    call suite%near(title(kind, .false., 'body force: sum'), maxval(abs(sum(force, 2) - b * volume)), 0.0_DP, 1e-13_DP)
    corners = n
    if (n == 10) corners = 4
    if (n == 15) corners = 6
    if (n == 20) corners = 8
    centre = sum(X(:, :corners), 2) / real(corners, DP)
    moment = 0
    do a = 1, n
      moment = moment + cross_product(X(:, a) - centre, force(:, a))
    end do
    call suite%near(title(kind, .false., 'body force: moment'), maxval(abs(moment)), 0.0_DP, 1e-13_DP)
  end subroutine check_volume


  !> Six modes have zero energy; with reduced integration more: the wedge's twist about its axis (1), the hourglass
  !! modes of C3D20R (6), which do not propagate through a mesh.
  subroutine check_modes(kind)
    integer, intent(in) :: kind
    integer, parameter :: EXPECTED(KIND_BEAM_RECT) = [6, 7, 6, 6, 6, 6, 12, 6, 6, 6, 6, 6, 6]
    real(DP) :: X(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF), values(N_DOF)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    call evaluate_element_tangent(kind, material, X(:, :n), 0 * X(:, :n), .false., K, points, status)
    call find_eigenvalues(K(:3 * n, :3 * n), values(:3 * n))
    call suite%that(title(kind, .false., 'number of modes without energy'), &
      count(abs(values(:3 * n)) < 1e-10_DP * maxval(values(:3 * n))) == EXPECTED(kind))
    call suite%that(title(kind, .false., 'no negative mode'), &
      minval(values(:3 * n)) > -1e-13_DP * maxval(values(:3 * n)))
  end subroutine check_modes


  !> Near incompressibility one mode of a C3D8 is stiff, the change of its volume; without mean dilatation there are seven
  !! more.
  subroutine check_no_locking()
    real(DP) :: X(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF), values(24)
    type(integration_points_type) :: points
    type(material_type) :: rubber
    integer :: status
    rubber%youngs_modulus = 3
    rubber%poissons_ratio = 0.5_DP - 1e-7_DP
    call distort(KIND_C3D8, 0.2_DP, X)
    call evaluate_element_tangent(KIND_C3D8, rubber, X(:, :8), 0 * X(:, :8), .false., K, points, status)
    call find_eigenvalues(K(:24, :24), values)
    call suite%that('C3D8: one stiff mode', count(values > 1e3_DP) == 1)
    call evaluate_element_tangent(KIND_C3D8, rubber, X(:, :8), 0 * X(:, :8), .true., K, points, status)
    call find_eigenvalues(K(:24, :24), values)
    call suite%that('C3D8 large: one stiff mode', count(values > 1e3_DP) == 1)
    call evaluate_element_tangent(KIND_C3D8_FULL, rubber, X(:, :8), 0 * X(:, :8), .false., K, points, status)
    call find_eigenvalues(K(:24, :24), values)
    call suite%that('C3D8 plain: many stiff modes', count(values > 1e3_DP) > 1)
  end subroutine check_no_locking


  !> The pressure of a C3D8 is uniform, that of its change of volume v/V: K ln(v/V)/(v/V) by Hencky's law, under any
  !! displacements.
  subroutine check_mean_dilatation()
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), bulk, before, after, expected
    type(integration_points_type) :: points
    integer :: p, status
    material%law = LAW_HENCKY
    call distort(KIND_C3D8, 0.2_DP, X)
    call random_number(u)
    u = 0.6_DP * (u - 0.5_DP) + 0.1_DP * X
    bulk = material%youngs_modulus / (3 * (1 - 2 * material%poissons_ratio))
    call evaluate_element_volume(KIND_C3D8, X(:, :8), 1.0_DP, before, status)
    call evaluate_element_volume(KIND_C3D8, X(:, :8) + u(:, :8), 1.0_DP, after, status)
    expected = bulk * log(after / before) * before / after
    call evaluate_element_forces(KIND_C3D8, material, X(:, :8), u(:, :8), .true., force, points, status)
    do p = 1, 8
      call suite%near('C3D8 large: Cauchy pressure of the mean dilatation', sum(points%stress(:3, p)) / 3, expected, &
        1e-12_DP * bulk)
      call suite%near('C3D8 large: trace of the strain', sum(points%strain(:3, p)), log(after / before), 1e-13_DP)
    end do
    call evaluate_element_forces(KIND_C3D8, material, X(:, :8), u(:, :8), .false., force, points, status)
    do p = 1, 8
      call suite%near('C3D8 small: uniform pressure', sum(points%stress(:3, p)), sum(points%stress(:3, 1)), &
        1e-12_DP * bulk)
    end do
  end subroutine check_mean_dilatation


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


  !> Internal forces of a uniform pressure equal those of the pressure on all faces, current and exact; their sum is
  !! zero. (Not of C3D6, C3D15, C3D20R, beams distorted, nor C3D10 curved: their points do not integrate the gradients exactly; nor
  !! of solid shells, whose assumed strains are not those of the gradients.)
  subroutine check_hydrostatic(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), outside(3, MAX_ELEMENT_NODES), &
      pressure
    real(DP) :: on_face(3, MAX_FACE_NODES), K(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    type(facet_kind_type) :: facet
    integer :: n, face, a, status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    n = entry%n_nodes
    call distort(kind, 0.2_DP, X)
    if (kind == KIND_C3D10) then
      call distort(kind, 0.0_DP, X)
      X(:, 1) = X(:, 1) + [0.0_DP, -0.1_DP, 0.2_DP]
      X(:, [5, 7, 8]) = 0.5_DP * (spread(X(:, 1), 2, 3) + X(:, 2:4))
    end if
    u = -0.1_DP * X
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    pressure = -sum(points%stress(:3, 1)) / 3
    outside = 0
    do face = 1, entry%n_faces
      facet = facet_kind(entry%face_kind(face))
      associate (nodes => entry%face_nodes(:facet%n_nodes, face))
        call integrate_facet_pressure(entry%face_kind(face), X(:, nodes) + u(:, nodes), pressure, on_face, K)
        do a = 1, facet%n_nodes
          outside(:, nodes(a)) = outside(:, nodes(a)) + on_face(:, a)
        end do
      end associate
    end do
    call suite%near(title(kind, .true., 'closed surface: no force'), maxval(abs(sum(outside, 2))), 0.0_DP, 1e-14_DP * &
      norm2(outside))
    if (any(kind == [KIND_C3D6, KIND_C3D15, KIND_C3D20R, KIND_CSS8, KIND_CSS6, KIND_BEAM_RECT])) return
    call suite%near(title(kind, .true., 'pressure inside and outside'), norm2(force - outside), 0.0_DP, &
      1e-12_DP * norm2(outside))
  end subroutine check_hydrostatic


  !> A pressure on a flat quadrilateral or triangle has the right sum and direction; the load stiffness agrees with differences.
  subroutine check_pressure(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: STEP = 1e-6_DP
    real(DP), parameter :: SQUARE(2, 8) = reshape([real(DP) :: 0, 0, 2, 0, 2, 2, 0, 2, 1, 0, 2, 1, 1, 2, 0, 1], [2, 8])
    real(DP), parameter :: TRIANGLE(2, 6) = reshape([real(DP) :: 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0, 1], [2, 6])
    real(DP) :: x(3, MAX_FACE_NODES), moved(3, MAX_FACE_NODES), force(3, MAX_FACE_NODES), fp(3, MAX_FACE_NODES)
    real(DP) :: fm(3, MAX_FACE_NODES), K(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)
    real(DP) :: unused(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES), r(3, MAX_FACE_NODES), area
    type(facet_kind_type) :: facet
    integer :: n, a, j
    facet = facet_kind(kind)
    n = facet%n_nodes
    x = 0
    if (facet%n_corners == 4) x(:2, :) = SQUARE
    if (facet%n_corners == 3) x(:2, :6) = TRIANGLE
    area = merge(4.0_DP, 2.0_DP, facet%n_corners == 4)
    call integrate_facet_pressure(kind, x(:, :n), 3.0_DP, force, K)
    call suite%near('pressure: pushes against the normal', maxval(abs(sum(force, 2) &
      - [0.0_DP, 0.0_DP, -3 * area])), 0.0_DP, 1e-14_DP)
    call random_number(r)
    x = x + 0.3_DP * (r - 0.5_DP)
    call integrate_facet_pressure(kind, x(:, :n), 3.0_DP, force, K)
    do a = 1, n
      do j = 1, 3
        moved = x
        moved(j, a) = x(j, a) + STEP
        call integrate_facet_pressure(kind, moved(:, :n), 3.0_DP, fp, unused)
        moved(j, a) = x(j, a) - STEP
        call integrate_facet_pressure(kind, moved(:, :n), 3.0_DP, fm, unused)
        call suite%near('pressure: load stiffness', norm2(reshape((fp - fm) / (2 * STEP), [3 * MAX_FACE_NODES]) &
          - K(:, 3 * (a - 1) + j)), 0.0_DP, 1e-9_DP * norm2(K))
      end do
    end do
  end subroutine check_pressure


  !> Inverted elements, NaN and infinity, and an invalid reference mesh.
  subroutine check_exits(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF), volume
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    points%is_shell = is_whole
    points%stack_bending = stack_bending
    n = entry%n_nodes
    call distort(kind, 0.0_DP, X)
    u = 0
    u(1, :) = -2 * X(1, :)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that(title(kind, .true., 'exit: inverted'), status == ELEMENT_INVERTED)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .false., force, points, status)
    call suite%that(title(kind, .false., 'small theory knows no inversion'), status == ELEMENT_OK)
    u(2, n) = ieee_value(1.0_DP, ieee_quiet_nan)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status, K)
    call suite%that(title(kind, .true., 'exit: NaN'), status == ELEMENT_NOT_FINITE)
    u(2, n) = ieee_value(1.0_DP, ieee_positive_inf)
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .false., force, points, status)
    call suite%that(title(kind, .false., 'exit: infinite'), status == ELEMENT_NOT_FINITE)
    u(2, n) = 1e200_DP
    call evaluate_element_tangent(kind, material, X(:, :n), u(:, :n), .true., K, points, status)
    call suite%that(title(kind, .true., 'exit: beyond all bounds'), status == ELEMENT_NOT_FINITE)
    X(3, :) = -X(3, :)
    call evaluate_element_tangent(kind, material, X(:, :n), 0 * X(:, :n), .true., K, points, status)
    call suite%that(title(kind, .true., 'exit: degenerate'), status == ELEMENT_DEGENERATE)
    call evaluate_element_volume(kind, X(:, :n), 1.0_DP, volume, status)
    call suite%that(title(kind, .true., 'exit: negative volume'), status == ELEMENT_DEGENERATE .and. volume < 0)
  end subroutine check_exits

end program test_element
