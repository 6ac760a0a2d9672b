!> Unit test of hex8_simd: results equal to those of single elements, a tangent that is the derivative of the forces, and detection
!! of invalid elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_hex8_simd
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_kinds, only: DP
  use amontons_hex8_simd, only: batch_type, batch_rule_type, create_batch_rule, is_batch_kind, set_batch_lane, &
    evaluate_batch_forces, evaluate_batch_tangent, BATCH_WIDTH
  use amontons_element, only: evaluate_element_forces, integration_points_type, ELEMENT_OK
  use amontons_materials, only: material_type, LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_element_kinds, only: KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, MAX_ELEMENT_NODES
  use check, only: suite_type
  implicit none
  real(DP), parameter :: CUBE(3, 8) = reshape([real(DP) :: 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, &
    0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8])
  type(suite_type) :: suite
  type(batch_rule_type) :: rule
  integer :: k
  call random_seed(put=[(17 * k, k=1, 64)])
  rule = create_batch_rule()
  call test_case('small', KIND_C3D8_FULL, .false., 0.2_DP)
  call test_case('mean dilatation', KIND_C3D8, .false., 0.2_DP)
  call test_case('finite', KIND_C3D8_FULL, .true., 0.2_DP)
  call test_case('tiny, finite', KIND_C3D8_FULL, .true., 1.0e-9_DP)
  call test_difference()
  call test_unsound()
  call test_choice()
  call suite%finish()

contains

  !> Eight distorted elements of different materials with random displacements.
  subroutine fill(batch, materials, size_of_u)
    type(batch_type), intent(out) :: batch
    type(material_type), intent(out) :: materials(BATCH_WIDTH)
    real(DP), intent(in) :: size_of_u
    real(DP) :: X(3, 8), u(3, 8), r(2)
    integer :: lane
    do lane = 1, BATCH_WIDTH
      call random_number(X)
      call random_number(u)
      call random_number(r)
      materials(lane)%youngs_modulus = 1 + r(1)
      materials(lane)%poissons_ratio = 0.45_DP * r(2)
      materials(lane)%law = LAW_SAINT_VENANT
      call set_batch_lane(batch, lane, materials(lane), CUBE + 0.3_DP * (X - 0.5_DP), size_of_u * (u - 0.5_DP))
    end do
  end subroutine fill


  !> All results of a batch against single elements; they differ by rounding only.
  subroutine test_case(name, kind, is_nlgeom, size_of_u)
    character(*), intent(in) :: name
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: size_of_u
    real(DP), parameter :: ROUNDING = 1.0e-13_DP
    type(batch_type) :: batch
    type(material_type) :: materials(BATCH_WIDTH)
    type(integration_points_type) :: points
    real(DP) :: force(3, MAX_ELEMENT_NODES), K_e(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES), worst(6)
    integer :: lane, a, b, pair, status
    call fill(batch, materials, size_of_u)
    call evaluate_batch_forces(batch, rule, kind == KIND_C3D8, is_nlgeom)
    call suite%that(name // ': sound', batch%is_sound)
    call evaluate_batch_tangent(batch, rule, kind == KIND_C3D8, is_nlgeom)
    worst = 0
    do lane = 1, BATCH_WIDTH
      call evaluate_element_forces(kind, materials(lane), batch%X(lane, :, :), batch%u(lane, :, :), is_nlgeom, force, points, &
        status, K_e)
      call suite%that(name // ': element', status == ELEMENT_OK)
      worst(1) = max(worst(1), maxval(abs(batch%force(lane, :, :) - force(:, :8))) / maxval(abs(force)))
      worst(2) = max(worst(2), maxval(abs(batch%stress(lane, :, :) - points%stress(:, :8))) / maxval(abs(points%stress(:, :8))))
      worst(3) = max(worst(3), maxval(abs(batch%strain(lane, :, :) - points%strain(:, :8))) / maxval(abs(points%strain(:, :8))))
      worst(4) = max(worst(4), maxval(abs(batch%energy(lane, :) - points%energy(:8))) / maxval(points%energy(:8)))
      worst(5) = max(worst(5), maxval(abs(batch%volume(lane, :) - points%volume(:8))) / maxval(points%volume(:8)))
      pair = 0
      do b = 1, 8
        do a = 1, b
          pair = pair + 1
          worst(6) = max(worst(6), maxval(abs(batch%stiffness(lane, :, :, pair) &
            - K_e(3 * a - 2:3 * a, 3 * b - 2:3 * b))) / maxval(abs(K_e(:24, :24))))
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
  subroutine test_difference()
    real(DP), parameter :: H = 1.0e-5_DP
    type(batch_type) :: batch, moved
    type(material_type) :: materials(BATCH_WIDTH)
    real(DP) :: plus(BATCH_WIDTH, 3, 8), worst
    integer :: a, b, j, pair
    call fill(batch, materials, 0.2_DP)
    call evaluate_batch_tangent(batch, rule, .false., .true.)
    worst = 0
    pair = 0
    do b = 1, 8
      do j = 1, 3
        moved = batch
        moved%u(:, j, b) = batch%u(:, j, b) + H
        call evaluate_batch_forces(moved, rule, .false., .true.)
        plus = moved%force
        moved%u(:, j, b) = batch%u(:, j, b) - H
        call evaluate_batch_forces(moved, rule, .false., .true.)
        do a = 1, b
          worst = max(worst, maxval(abs((plus(:, :, a) - moved%force(:, :, a)) / (2 * H) - batch%stiffness(:, :, j, pair + a))))
        end do
      end do
      pair = pair + b
    end do
    call suite%near('tangent by differences', worst / maxval(abs(batch%stiffness)), 0.0_DP, 1.0e-8_DP)
  end subroutine test_difference


  !> One inverted element, or one with NaN, makes the batch invalid; so does a degenerate one.
  subroutine test_unsound()
    type(batch_type) :: batch, bad
    type(material_type) :: materials(BATCH_WIDTH)
    call fill(batch, materials, 0.1_DP)
    bad = batch
    bad%u(5, 3, 5:8) = bad%u(5, 3, 5:8) - 3
    call evaluate_batch_forces(bad, rule, .false., .true.)
    call suite%that('inverted: forces', .not. bad%is_sound)
    call evaluate_batch_tangent(bad, rule, .false., .true.)
    call suite%that('inverted: tangent', .not. bad%is_sound)
    bad = batch
    bad%u(8, 2, 3) = ieee_value(1.0_DP, ieee_quiet_nan)
    call evaluate_batch_forces(bad, rule, .false., .false.)
    call suite%that('not a number', .not. bad%is_sound)
    bad = batch
    bad%X(2, 1, :) = 0
    call evaluate_batch_forces(bad, rule, .true., .false.)
    call suite%that('without volume', .not. bad%is_sound)
  end subroutine test_unsound


  !> Other kinds, laws and materials are left to the module `element`.
  subroutine test_choice()
    type(material_type) :: material
    material%law = LAW_SAINT_VENANT
    call suite%that('full', is_batch_kind(KIND_C3D8_FULL, material, .true.))
    call suite%that('mean dilatation, finite', .not. is_batch_kind(KIND_C3D8, material, .true.))
    call suite%that('modes', .not. is_batch_kind(KIND_C3D8I, material, .false.))
    material%law = LAW_HENCKY
    call suite%that('Hencky', .not. is_batch_kind(KIND_C3D8_FULL, material, .true.))
    call suite%that('Hencky, small', is_batch_kind(KIND_C3D8, material, .false.))
    material%is_linear_isotropic = .false.
    call suite%that('not plain', .not. is_batch_kind(KIND_C3D8_FULL, material, .false.))
  end subroutine test_choice

end program test_hex8_simd
