!> Unit test of solid_simd: results equal to those of single elements, a tangent that is the derivative of the forces, and detection
!! of invalid elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_solid_simd
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_kinds, only: DP
  use amontons_solid_simd, only: batch_type, batch_rule_type, create_batch_rules, is_batch_kind, set_batch_lane, &
    evaluate_batch_forces, evaluate_batch_tangent, BATCH_WIDTH
  use amontons_element, only: evaluate_element_forces, integration_points_type, ELEMENT_OK
  use amontons_materials, only: material_type, LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_shape_functions, only: node_coordinates
  use amontons_element_kinds, only: element_kind_type, element_kind, KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, &
    KIND_C3D8R, KIND_C3D10, KIND_C3D15, KIND_C3D20, KIND_C3D20R, N_SOLID_KINDS, MAX_ELEMENT_NODES
  use check, only: suite_type
  implicit none
  integer, parameter :: PLAIN(6) = [KIND_C3D4, KIND_C3D6, KIND_C3D8_FULL, KIND_C3D10, KIND_C3D15, KIND_C3D20]
  type(suite_type) :: suite
  type(batch_rule_type) :: rules(N_SOLID_KINDS)
  integer :: k
  call random_seed(put=[(17 * k, k=1, 64)])
  rules = create_batch_rules()
  call test_case('mean dilatation', KIND_C3D8, .false., 0.2_DP)
  do k = 1, size(PLAIN)
    call test_case('small', PLAIN(k), .false., 0.2_DP)
    call test_case('finite', PLAIN(k), .true., 0.2_DP)
    call test_case('tiny, finite', PLAIN(k), .true., 1.0e-9_DP)
    call test_difference(PLAIN(k))
  end do
  call test_unsound()
  call test_choice()
  call suite%finish()

contains

  !> Eight distorted elements of different materials with random displacements.
  subroutine fill(kind, batch, materials, size_of_u)
    integer, intent(in) :: kind
    type(batch_type), intent(out) :: batch
    type(material_type), intent(out) :: materials(BATCH_WIDTH)
    real(DP), intent(in) :: size_of_u
    real(DP), dimension(3, MAX_ELEMENT_NODES) :: X, u, xi
    real(DP) :: r(2), edge
    integer :: lane, n
    n = rules(kind)%n_nodes
    call node_coordinates(kind, xi)
    edge = maxval(xi) - minval(xi)
    do lane = 1, BATCH_WIDTH
      call random_number(X)
      call random_number(u)
      call random_number(r)
      materials(lane)%youngs_modulus = 1 + r(1)
      materials(lane)%poissons_ratio = 0.45_DP * r(2)
      materials(lane)%law = LAW_SAINT_VENANT
      call set_batch_lane(batch, lane, materials(lane), xi(:, :n) + 0.1_DP * edge * (X(:, :n) - 0.5_DP), &
        0.5_DP * edge * size_of_u * (u(:, :n) - 0.5_DP))
    end do
  end subroutine fill


  !> All results of a batch against single elements; they differ by rounding only.
  subroutine test_case(title, kind, is_nlgeom, size_of_u)
    character(*), intent(in) :: title
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: size_of_u
    real(DP), parameter :: ROUNDING = 1.0e-13_DP
    type(batch_type) :: batch
    type(material_type) :: materials(BATCH_WIDTH)
    type(integration_points_type) :: points
    real(DP) :: force(3, MAX_ELEMENT_NODES), K_e(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES), worst(6)
    type(element_kind_type) :: entry
    character(:), allocatable :: name
    integer :: lane, a, b, pair, status, n, m
    entry = element_kind(kind)
    name = trim(entry%name) // ', ' // title
    n = rules(kind)%n_nodes
    m = rules(kind)%n_points
    call fill(kind, batch, materials, size_of_u)
    call evaluate_batch_forces(batch, rules(kind), is_nlgeom)
    call suite%that(name // ': sound', batch%is_sound)
    call evaluate_batch_tangent(batch, rules(kind), is_nlgeom)
    worst = 0
    do lane = 1, BATCH_WIDTH
      call evaluate_element_forces(kind, materials(lane), batch%X(lane, :, :n), batch%u(lane, :, :n), is_nlgeom, force, points, &
        status, K_e)
      call suite%that(name // ': element', status == ELEMENT_OK)
      worst(1) = max(worst(1), maxval(abs(batch%force(lane, :, :n) - force(:, :n))) / maxval(abs(force)))
      worst(2) = max(worst(2), maxval(abs(batch%stress(lane, :, :m) - points%stress(:, :m))) / maxval(abs(points%stress(:, :m))))
      worst(3) = max(worst(3), maxval(abs(batch%strain(lane, :, :m) - points%strain(:, :m))) / maxval(abs(points%strain(:, :m))))
      worst(4) = max(worst(4), maxval(abs(batch%energy(lane, :m) - points%energy(:m))) / maxval(points%energy(:m)))
      worst(5) = max(worst(5), maxval(abs(batch%volume(lane, :m) - points%volume(:m))) / maxval(points%volume(:m)))
      pair = 0
      do b = 1, n
        do a = 1, b
          pair = pair + 1
          worst(6) = max(worst(6), maxval(abs(batch%stiffness(lane, :, :, pair) &
            - K_e(3 * a - 2:3 * a, 3 * b - 2:3 * b))) / maxval(abs(K_e(:3 * n, :3 * n))))
        end do
      end do
    end do
    call suite%near(name // ': force', worst(1), 0.0_DP, ROUNDING)
    call suite%near(name // ': stress', worst(2), 0.0_DP, ROUNDING)
    call suite%near(name // ': strain', worst(3), 0.0_DP, ROUNDING)
    call suite%near(name // ': energy', worst(4), 0.0_DP, ROUNDING)
    call suite%near(name // ': volume', worst(5), 0.0_DP, ROUNDING)
    call suite%near(name // ': tangent', worst(6), 0.0_DP, ROUNDING)
  end subroutine test_case


  !> The tangent under NLGEOM against central differences of the forces with a step of 1e-5: their error is of the order
  !! of its cube.
  subroutine test_difference(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: H = 1.0e-5_DP
    type(batch_type) :: batch, moved
    type(material_type) :: materials(BATCH_WIDTH)
    real(DP) :: plus(BATCH_WIDTH, 3, MAX_ELEMENT_NODES), worst
    integer :: a, b, j, pair
    call fill(kind, batch, materials, 0.2_DP)
    call evaluate_batch_tangent(batch, rules(kind), .true.)
    worst = 0
    pair = 0
    do b = 1, rules(kind)%n_nodes
      do j = 1, 3
        moved = batch
        moved%u(:, j, b) = batch%u(:, j, b) + H
        call evaluate_batch_forces(moved, rules(kind), .true.)
        plus = moved%force
        moved%u(:, j, b) = batch%u(:, j, b) - H
        call evaluate_batch_forces(moved, rules(kind), .true.)
        do a = 1, b
          worst = max(worst, maxval(abs((plus(:, :, a) - moved%force(:, :, a)) / (2 * H) - batch%stiffness(:, :, j, pair + a))))
        end do
      end do
      pair = pair + b
    end do
    call suite%near('tangent by differences', worst / maxval(abs(batch%stiffness(:, :, :, :pair))), 0.0_DP, 1.0e-8_DP)
  end subroutine test_difference


  !> One inverted element, or one with NaN, makes the batch invalid; so does a degenerate one.
  subroutine test_unsound()
    type(batch_type) :: batch, bad
    type(material_type) :: materials(BATCH_WIDTH)
    call fill(KIND_C3D8_FULL, batch, materials, 0.1_DP)
    bad = batch
    bad%u(5, 3, 5:8) = bad%u(5, 3, 5:8) - 3
    call evaluate_batch_forces(bad, rules(KIND_C3D8_FULL), .true.)
    call suite%that('inverted: forces', .not. bad%is_sound)
    call evaluate_batch_tangent(bad, rules(KIND_C3D8_FULL), .true.)
    call suite%that('inverted: tangent', .not. bad%is_sound)
    bad = batch
    bad%u(8, 2, 3) = ieee_value(1.0_DP, ieee_quiet_nan)
    call evaluate_batch_forces(bad, rules(KIND_C3D8_FULL), .false.)
    call suite%that('not a number', .not. bad%is_sound)
    bad = batch
    bad%X(2, 1, :) = 0
    call evaluate_batch_forces(bad, rules(KIND_C3D8), .false.)
    call suite%that('without volume', .not. bad%is_sound)
  end subroutine test_unsound


  !> Other kinds, laws and materials are left to the module `element`.
  subroutine test_choice()
    type(material_type) :: material
    material%law = LAW_SAINT_VENANT
    call suite%that('full', is_batch_kind(KIND_C3D8_FULL, material, .true.))
    call suite%that('mean dilatation, finite', .not. is_batch_kind(KIND_C3D8, material, .true.))
    call suite%that('modes', .not. is_batch_kind(KIND_C3D8I, material, .false.))
    call suite%that('hourglass stiffness', .not. is_batch_kind(KIND_C3D8R, material, .false.))
    call suite%that('modes without energy', .not. is_batch_kind(KIND_C3D20R, material, .false.))
    call suite%that('rules', all(is_batch_kind([(k, k=1, N_SOLID_KINDS)], material, .false.) .eqv. rules%n_nodes > 0))
    material%law = LAW_HENCKY
    call suite%that('Hencky', .not. is_batch_kind(KIND_C3D8_FULL, material, .true.))
    call suite%that('Hencky, small', is_batch_kind(KIND_C3D8, material, .false.))
    material%is_linear_isotropic = .false.
    call suite%that('not plain', .not. is_batch_kind(KIND_C3D8_FULL, material, .false.))
  end subroutine test_choice

end program test_solid_simd
