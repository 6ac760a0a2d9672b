!> Unit test of amontons_cohesive_elements: areas, uniform separation, rigid motions, balance, derivatives, error exits.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_cohesive_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_element, only: integration_points_type, evaluate_element_forces, evaluate_point_volumes, integrate_body_force, &
    set_temperature_weights, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_element_kinds, only: element_kind, element_kind_type, opposite_node, has_faces_in_space, KIND_COH2D4, KIND_COHAX4, &
    KIND_COH3D8, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  use amontons_kinds, only: DP, PI
  use amontons_materials, only: material_type, property_table_type, ELASTIC_TRACTION
  use amontons_tensor, only: cross_product
  use check, only: suite_type
  implicit none
  integer, parameter :: N_DOF = 3 * MAX_ELEMENT_NODES
  !> A proper rotation.
  real(DP), parameter :: TILT(3, 3) = reshape([real(DP) :: 2, 1, 2, -2, 2, 1, -1, -2, 2], [3, 3]) / 3
  real(DP), parameter :: T0 = 0.5_DP
  type(suite_type) :: suite
  integer :: kind, i, n

  call random_seed(size=n)
  call random_seed(put=[(15485863 + 7919 * i, i=1, n)])
  do kind = KIND_COH2D4, KIND_COH3D8
    call check_uniform(kind)
    call check_rigid(kind)
    call check_derivatives(kind, elastic(), .false.)
    call check_derivatives(kind, elastic(), .true.)
    call check_derivatives(kind, damaged(), .false.)
    call check_derivatives(kind, damaged(), .true.)
    call check_exits(kind)
    call check_weights(kind)
  end do
  call check_areas()
  call suite%finish()

contains

  !> A law without damage.
  function elastic() result(material)
    type(material_type) :: material
    material%elastic_kind = ELASTIC_TRACTION
    material%is_linear_isotropic = .false.
    material%elastic = property_table_type([0.0_DP], reshape([100.0_DP, 70.0_DP, 50.0_DP], [3, 1]))
  end function elastic


  !> The law with damage by an energy of mixed modes.
  function damaged() result(material)
    type(material_type) :: material
    material = elastic()
    material%is_unsymmetric = .true.
    allocate (material%damage)
    material%damage%is_quadratic = .true.
    material%damage%initiation = property_table_type([0.0_DP], reshape([1.0_DP, 0.8_DP, 0.9_DP], [3, 1]))
    material%damage%has_evolution = .true.
    material%damage%is_by_energy = .true.
    material%damage%mode_mix = 3
    material%damage%mix_exponent = 1.5_DP
    material%damage%evolution = property_table_type([0.0_DP], reshape([0.5_DP, 0.9_DP, 0.9_DP], [3, 1]))
  end function damaged


  !> An element with some distance between its faces, distorted by an amount.
  subroutine make(kind, amount, X)
    integer, intent(in) :: kind
    real(DP), intent(in) :: amount                 !< [length]
    real(DP), intent(out) :: X(3, MAX_ELEMENT_NODES)
    real(DP), parameter :: FACE(3, 4) = reshape([0.0_DP, 0.0_DP, 0.0_DP, 2.0_DP, 0.0_DP, 0.0_DP, 2.2_DP, 1.5_DP, 0.0_DP, -0.1_DP, &
      1.4_DP, 0.0_DP], [3, 4])
    type(element_kind_type) :: entry
    real(DP) :: r(3, MAX_ELEMENT_NODES)
    integer :: a
    entry = element_kind(kind)
    call random_number(r)
    X = 0
    do a = 1, entry%n_points
      X(:, a) = FACE(:, a)
      if (kind == KIND_COHAX4) X(1, a) = X(1, a) + 3
      X(:, opposite_node(kind, a)) = X(:, a) + merge([0.0_DP, 0.0_DP, 0.1_DP], [0.0_DP, 0.1_DP, 0.0_DP], has_faces_in_space(kind))
    end do
    X = X + amount * (r - 0.5_DP)
    if (.not. has_faces_in_space(kind)) X(3, :) = 0
    X(:, entry%n_nodes + 1:) = 0
  end subroutine make


  !> Points of an element with its section.
  function sections() result(points)
    type(integration_points_type) :: points
    points%section_value = T0
    points%cohesive = [T0, 0.0_DP]
    points%has_frame = .false.
    points%temperature = 0
    points%elapsed_time = 1
    allocate (points%inner_old(3, MAX_ELEMENT_POINTS), source=0.0_DP)
    points%inner = points%inner_old
  end function sections


  !> The upper face of a flat element moves by a vector: stresses, and forces of its area, are those of the law.
  subroutine check_uniform(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: MOVE(3) = [0.002_DP, 0.003_DP, 0.005_DP]
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), area, expected(3)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: status, a, m
    entry = element_kind(kind)
    points = sections()
    call make(kind, 0.0_DP, X)
    u = 0
    do a = 1, entry%n_points
      u(:, opposite_node(kind, a)) = MOVE
    end do
    call evaluate_element_forces(kind, elastic(), X(:, :entry%n_nodes), u(:, :entry%n_nodes), .false., force, points, status)
    call suite%that('status', status == ELEMENT_OK)
    m = entry%n_points
    area = sum(points%volume(:m)) / T0
    if (has_faces_in_space(kind)) then
      expected = area * [70.0_DP, 50.0_DP, 100.0_DP] * MOVE / T0
      call suite%near('normal stress', points%stress(3, 1), 100 * MOVE(3) / T0, 1.0e-13_DP)
      call suite%near('shear stresses', norm2(points%stress(5:6, 1) - [50 * MOVE(2), 70 * MOVE(1)] / T0), 0.0_DP, 1.0e-13_DP)
      call suite%near('normal strain', points%strain(3, m), MOVE(3) / T0, 1.0e-15_DP)
    else
      expected = area * [70.0_DP, 100.0_DP, 0.0_DP] * MOVE / T0
      call suite%near('normal stress', points%stress(2, 1), 100 * MOVE(2) / T0, 1.0e-13_DP)
      call suite%near('shear stress', points%stress(4, 1), 70 * MOVE(1) / T0, 1.0e-13_DP)
      call suite%near('shear strain', points%strain(4, 2), 0.5_DP * MOVE(1) / T0, 1.0e-15_DP)
    end if
    call suite%near('force', norm2(sum(force(:, opposite_node(kind, [(a, a=1, m)])), dim=2) - expected) / norm2(expected), 0.0_DP, &
      1.0e-13_DP)
    call suite%near('balance', norm2(sum(force, dim=2)), 0.0_DP, 1.0e-13_DP)
    call suite%near('energy', sum(points%energy(:m) * points%volume(:m)), 0.5_DP * dot_product(expected, MOVE), 1.0e-13_DP)
  end subroutine check_uniform


  !> A rotation by any angle exerts no force, and turns those of an opened element; forces and moments balance.
  subroutine check_rigid(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), turned(3, MAX_ELEMENT_NODES), &
      R(3, 3), moment(3)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status, a
    if (kind == KIND_COHAX4) return                ! only motions along its axis are rigid
    entry = element_kind(kind)
    n = entry%n_nodes
    points = sections()
    call make(kind, 0.05_DP, X)
    R = TILT
    if (.not. has_faces_in_space(kind)) R = reshape([0.6_DP, 0.8_DP, 0.0_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], &
      [3, 3])
    u = matmul(R, X) - X
    call evaluate_element_forces(kind, elastic(), X(:, :n), u(:, :n), .true., force, points, status)
    call suite%near('no force in a rotation', norm2(force(:, :n)), 0.0_DP, 1.0e-12_DP)
    call random_number(u)
    if (.not. has_faces_in_space(kind)) u(3, :) = 0
    u = 0.1_DP * u
    call evaluate_element_forces(kind, elastic(), X(:, :n), u(:, :n), .true., force, points, status)
    moment = 0
    do a = 1, n
      moment = moment + cross_product(X(:, a) + u(:, a), force(:, a))
    end do
    call suite%near('balance of forces', norm2(sum(force(:, :n), dim=2)), 0.0_DP, 1.0e-12_DP)
    call suite%near('balance of moments', norm2(moment), 0.0_DP, 1.0e-12_DP)
    u = matmul(R, X + u) - X
    call evaluate_element_forces(kind, elastic(), X(:, :n), u(:, :n), .true., turned, points, status)
    call suite%near('forces turn', norm2(turned(:, :n) - matmul(R, force(:, :n))) / norm2(force(:, :n)), 0.0_DP, 1.0e-12_DP)
  end subroutine check_rigid


  !> The tangent against central differences.
  subroutine check_derivatives(kind, material, is_nlgeom)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: STEP = 1.0e-6_DP
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), v(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES), &
      before(3, MAX_ELEMENT_NODES), behind(3, MAX_ELEMENT_NODES), matrix(N_DOF, N_DOF), difference(N_DOF, N_DOF)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status, j
    entry = element_kind(kind)
    n = entry%n_nodes
    points = sections()
    call make(kind, 0.05_DP, X)
    call random_number(u)
    u = 0.02_DP * (u - 0.5_DP)
    do j = 1, entry%n_points                       ! open, beyond the start of damage
      u(:, opposite_node(kind, j)) = u(:, opposite_node(kind, j)) + [0.02_DP, 0.04_DP, 0.04_DP]
    end do
    if (.not. has_faces_in_space(kind)) u(3, :) = 0
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, force, points, status, matrix)
    call suite%that('status', status == ELEMENT_OK)
    difference = 0
    do j = 1, 3 * n
      if (mod(j, 3) == 0 .and. .not. has_faces_in_space(kind)) cycle
      v = u
      v(1 + mod(j - 1, 3), (j + 2) / 3) = v(1 + mod(j - 1, 3), (j + 2) / 3) - STEP
      call evaluate_element_forces(kind, material, X(:, :n), v(:, :n), is_nlgeom, before, points, status)
      v = u
      v(1 + mod(j - 1, 3), (j + 2) / 3) = v(1 + mod(j - 1, 3), (j + 2) / 3) + STEP
      call evaluate_element_forces(kind, material, X(:, :n), v(:, :n), is_nlgeom, behind, points, status)
      difference(:3 * n, j) = reshape((behind(:, :n) - before(:, :n)) / (2 * STEP), [3 * n])
    end do
    call suite%near('tangent', norm2(matrix(:3 * n, :3 * n) - difference(:3 * n, :3 * n)) / norm2(difference(:3 * n, :3 * n)), &
      0.0_DP, 1.0e-7_DP)
    call suite%that('unsymmetric with damage alone', allocated(points%skew) .eqv. allocated(material%damage))
  end subroutine check_derivatives


  !> Consistent forces of a uniform pressure on a distorted quadrilateral; circles of a body of revolution; a body force.
  subroutine check_areas()
    real(DP) :: X(3, MAX_ELEMENT_NODES), volumes(MAX_ELEMENT_POINTS), force(3, MAX_ELEMENT_NODES)
    integer :: n, status
    call make(KIND_COH3D8, 0.0_DP, X)
    X(3, 5:8) = 0                                  ! faces without a distance
    call evaluate_point_volumes(KIND_COH3D8, X(:, :8), T0, n, volumes, status)
    call suite%near('area of a quadrilateral', sum(volumes), T0 * 0.5_DP * norm2(cross_product(X(:, 3) - X(:, 1), X(:, 4) - &
      X(:, 2))), 1.0e-13_DP)
    call suite%that('points', n == 4 .and. status == ELEMENT_OK)
    call integrate_body_force(KIND_COH3D8, X(:, :8), T0, [1.0_DP, 0.0_DP, -2.0_DP], force)
    call suite%near('weight', norm2(sum(force(:, :8), dim=2) - sum(volumes) * [1.0_DP, 0.0_DP, -2.0_DP]), 0.0_DP, 1.0e-13_DP)
    X = 0
    X(1, [2, 3]) = 2.0_DP
    call evaluate_point_volumes(KIND_COHAX4, X(:, :4), T0, n, volumes, status)
    call suite%near('area of a disc', sum(volumes), T0 * PI * 4, 1.0e-13_DP)
    call suite%near('share of its centre', volumes(1), T0 * PI * 4 / 3, 1.0e-13_DP)
  end subroutine check_areas


  !> Each point has the temperature of its pair of nodes.
  subroutine check_weights(kind)
    integer, intent(in) :: kind
    real(DP) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    call set_temperature_weights(kind, weight)
    call suite%near('weights of temperatures', weight(1, 1) + weight(opposite_node(kind, 1), 1), 1.0_DP, 0.0_DP)
    call suite%near('of a pair alone', sum(weight(:, 2)), 1.0_DP, 0.0_DP)
  end subroutine check_weights


  !> A displacement that is not finite, a face that collapses, one without an area.
  subroutine check_exits(kind)
    integer, intent(in) :: kind
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), force(3, MAX_ELEMENT_NODES)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    points = sections()
    call make(kind, 0.0_DP, X)
    u = 0
    u(2, 1) = ieee_value(1.0_DP, ieee_quiet_nan)
    call evaluate_element_forces(kind, elastic(), X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that('not finite', status == ELEMENT_NOT_FINITE)
    u = -X
    call evaluate_element_forces(kind, elastic(), X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that('collapsed', status == ELEMENT_INVERTED)
    X = 0
    u = 0
    call evaluate_element_forces(kind, elastic(), X(:, :n), u(:, :n), .true., force, points, status)
    call suite%that('without an area', status == ELEMENT_DEGENERATE)
  end subroutine check_exits

end program test_cohesive_elements
