!> Unit test of plastic_solid_simd: results equal to those of single elements, a tangent near the derivative of the forces, and
!! detection of invalid elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_plastic_solid_simd
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_kinds, only: DP
  use amontons_solid_simd, only: batch_type, batch_rule_type, create_batch_rules, set_batch_lane, BATCH_WIDTH, BATCH_HISTORY
  use amontons_plastic_solid_simd, only: is_plastic_batch_kind, evaluate_plastic_batch_forces, evaluate_plastic_batch_tangent
  use amontons_element, only: evaluate_element_forces, integration_points_type, ELEMENT_OK
  use amontons_materials, only: material_type, LAW_HENCKY, LAW_SAINT_VENANT, CREEP_TIME_HARDENING, HISTORY_PEEQ, HISTORY_INELASTIC
  use amontons_shape_functions, only: node_coordinates
  use amontons_element_kinds, only: element_kind_type, element_kind, KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8R, &
    KIND_C3D10, KIND_C3D15, KIND_C3D20, KIND_C3D20R, N_SOLID_KINDS, MAX_ELEMENT_NODES
  use check, only: suite_type
  implicit none
  integer, parameter :: PLAIN(6) = [KIND_C3D4, KIND_C3D6, KIND_C3D8_FULL, KIND_C3D10, KIND_C3D15, KIND_C3D20]
  type(suite_type) :: suite
  type(batch_rule_type) :: rules(N_SOLID_KINDS)
  type(material_type) :: steel
  integer :: k
  call random_seed(put=[(17 * k, k=1, 64)])
  rules = create_batch_rules()
  call set_steel(steel)
  do k = 1, size(PLAIN)
    call test_case('elastic', PLAIN(k), 1.0e-4_DP, 0.0_DP)
    call test_case('elastic beside plastic', PLAIN(k), 3.0e-3_DP, 0.0_DP)
    call test_case('flow from rest', PLAIN(k), 0.1_DP, 0.0_DP)
    call test_case('flow after flow', PLAIN(k), 0.1_DP, 0.05_DP)
    call test_case('unloading', PLAIN(k), 1.0e-3_DP, 1.0e-3_DP)
    call test_case('large', PLAIN(k), 0.3_DP, 0.6_DP)
    call test_difference(PLAIN(k))
  end do
  call test_output()
  call test_unsound()
  call test_choice()
  call suite%finish()

contains

  !> Elastic constants and a hardening curve with a plateau at its end.
  subroutine set_steel(material)
    type(material_type), intent(out) :: material
    material%law = LAW_SAINT_VENANT
    material%is_linear_isotropic = .false.
    material%youngs_modulus = 210000
    material%poissons_ratio = 0.3_DP
    material%n_history = BATCH_HISTORY
    allocate (material%isotropic_hardening(1))
    material%isotropic_hardening(1)%strain = [0.0_DP, 0.02_DP, 0.3_DP]
    material%isotropic_hardening(1)%stress = [300.0_DP, 400.0_DP, 500.0_DP]
  end subroutine set_steel


  !> Eight distorted elements with random displacements and random plastic strains of a given size.
  subroutine fill(kind, batch, size_of_u, size_of_strain)
    integer, intent(in) :: kind
    type(batch_type), intent(out) :: batch
    real(DP), intent(in) :: size_of_u, size_of_strain
    real(DP), dimension(3, MAX_ELEMENT_NODES) :: X, u, xi
    real(DP) :: edge
    integer :: lane, p, n
    n = rules(kind)%n_nodes
    call node_coordinates(kind, xi)
    edge = maxval(xi) - minval(xi)
    call random_number(batch%history_old)
    batch%history_old = size_of_strain * (batch%history_old - 0.5_DP)
    batch%history_old(:, HISTORY_PEEQ, :) = abs(batch%history_old(:, HISTORY_PEEQ, :))
    do p = 1, rules(kind)%n_points                                    ! plastic strains keep the volume
      batch%history_old(:, HISTORY_INELASTIC, p) = -batch%history_old(:, HISTORY_INELASTIC + 1, p) &
        - batch%history_old(:, HISTORY_INELASTIC + 2, p)
    end do
    do lane = 1, BATCH_WIDTH
      call random_number(X)
      call random_number(u)
      call set_batch_lane(batch, lane, steel, xi(:, :n) + 0.1_DP * edge * (X(:, :n) - 0.5_DP), &
        0.5_DP * edge * size_of_u * (u(:, :n) - 0.5_DP))
    end do
  end subroutine fill


  !> One element of a batch by module `element`.
  subroutine evaluate_lane(kind, batch, lane, force, points, status, K_e)
    integer, intent(in) :: kind
    type(batch_type), intent(in) :: batch
    integer, intent(in) :: lane
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(out) :: points
    integer, intent(out) :: status
    real(DP), intent(out) :: K_e(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    points%history_old = 0
    points%history_old(:BATCH_HISTORY, :rules(kind)%n_points) = batch%history_old(lane, :, :rules(kind)%n_points)
    points%temperature = 0
    points%initial_temperature = 0
    points%time = 0
    points%time_increment = 0
    points%has_frame = .false.
    associate (n => rules(kind)%n_nodes)
      call evaluate_element_forces(kind, steel, batch%X(lane, :, :n), batch%u(lane, :, :n), .true., force, points, status, K_e)
    end associate
  end subroutine evaluate_lane


  !> All results of a batch against single elements; they differ by rounding only.
  subroutine test_case(title, kind, size_of_u, size_of_strain)
    character(*), intent(in) :: title
    integer, intent(in) :: kind
    real(DP), intent(in) :: size_of_u, size_of_strain
    real(DP), parameter :: ROUNDING = 1.0e-11_DP   ! of stresses, beside the elastic strains of 1e-3 of a strain of 1
    type(batch_type) :: batch
    type(integration_points_type) :: points
    real(DP) :: force(3, MAX_ELEMENT_NODES), K_e(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES), worst(7)
    type(element_kind_type) :: entry
    character(:), allocatable :: name
    integer :: lane, a, b, pair, status, n, m
    entry = element_kind(kind)
    name = trim(entry%name) // ', ' // title
    n = rules(kind)%n_nodes
    m = rules(kind)%n_points
    call fill(kind, batch, size_of_u, size_of_strain)
    call evaluate_plastic_batch_forces(batch, rules(kind), steel, .true.)
    call suite%that(name // ': sound', batch%is_sound)
    call evaluate_plastic_batch_tangent(batch, rules(kind), steel)
    worst = 0
    do lane = 1, BATCH_WIDTH
      call evaluate_lane(kind, batch, lane, force, points, status, K_e)
      call suite%that(name // ': element', status == ELEMENT_OK)
      worst(1) = max(worst(1), maxval(abs(batch%force(lane, :, :n) - force(:, :n))) / maxval(abs(force(:, :n))))
      worst(2) = max(worst(2), maxval(abs(batch%stress(lane, :, :m) - points%stress(:, :m))) / maxval(abs(points%stress(:, :m))))
      worst(3) = max(worst(3), maxval(abs(batch%strain(lane, :, :m) - points%strain(:, :m))) / maxval(abs(points%strain(:, :m))))
      worst(4) = max(worst(4), maxval(abs(batch%energy(lane, :m) - points%energy(:m))) / steel%youngs_modulus)
      worst(5) = max(worst(5), maxval(abs(batch%volume(lane, :m) - points%volume(:m))) / maxval(points%volume(:m)))
      worst(6) = max(worst(6), maxval(abs(batch%history(lane, :, :m) - points%history(:BATCH_HISTORY, :m))))
      pair = 0
      do b = 1, n
        do a = 1, b
          pair = pair + 1
          worst(7) = max(worst(7), maxval(abs(batch%stiffness(lane, :, :, pair) &
            - K_e(3 * a - 2:3 * a, 3 * b - 2:3 * b))) / maxval(abs(K_e(:3 * n, :3 * n))))
        end do
      end do
    end do
    call suite%near(name // ': force', worst(1), 0.0_DP, ROUNDING)
    call suite%near(name // ': stress', worst(2), 0.0_DP, ROUNDING)
    call suite%near(name // ': strain', worst(3), 0.0_DP, 1.0e-13_DP)
    call suite%near(name // ': energy over E', worst(4), 0.0_DP, 1.0e-15_DP)   ! J^2 - 1 - 2 ln J cancels
    call suite%near(name // ': volume', worst(5), 0.0_DP, 1.0e-13_DP)
    call suite%near(name // ': history', worst(6), 0.0_DP, 1.0e-13_DP)
    call suite%near(name // ': tangent', worst(7), 0.0_DP, ROUNDING)
  end subroutine test_case


  !> Without output the forces are the same, to the last bit, and stress and history are not touched.
  subroutine test_output()
    type(batch_type) :: batch, quiet
    call fill(KIND_C3D8_FULL, batch, 0.1_DP, 0.05_DP)
    batch%stress = -1
    batch%history = -2
    quiet = batch
    call evaluate_plastic_batch_forces(batch, rules(KIND_C3D8_FULL), steel, .true.)
    call evaluate_plastic_batch_forces(quiet, rules(KIND_C3D8_FULL), steel, .false.)
    call suite%that('forces without output', all(abs(batch%force(:, :, :8) - quiet%force(:, :, :8)) <= 0.0_DP))
    call suite%that('no output', all(abs(quiet%stress + 1) <= 0.0_DP) .and. all(abs(quiet%history + 2) <= 0.0_DP))
    call suite%that('flow grows', all(batch%history(:, HISTORY_PEEQ, :8) >= batch%history_old(:, HISTORY_PEEQ, :8)))
  end subroutine test_output


  !> The tangent against central differences of the forces: the law leaves out terms of the order of the elastic strains, here 3e-3.
  subroutine test_difference(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: H = 1.0e-7_DP
    type(batch_type) :: batch, moved
    real(DP) :: plus(BATCH_WIDTH, 3, MAX_ELEMENT_NODES), worst
    integer :: a, b, j, pair
    call fill(kind, batch, 0.1_DP, 0.02_DP)
    call evaluate_plastic_batch_tangent(batch, rules(kind), steel)
    worst = 0
    pair = 0
    do b = 1, rules(kind)%n_nodes
      do j = 1, 3
        moved = batch
        moved%u(:, j, b) = batch%u(:, j, b) + H
        call evaluate_plastic_batch_forces(moved, rules(kind), steel, .false.)
        plus = moved%force
        moved%u(:, j, b) = batch%u(:, j, b) - H
        call evaluate_plastic_batch_forces(moved, rules(kind), steel, .false.)
        do a = 1, b
          worst = max(worst, maxval(abs((plus(:, :, a) - moved%force(:, :, a)) / (2 * H) - batch%stiffness(:, :, j, pair + a))))
        end do
      end do
      pair = pair + b
    end do
    call suite%near('tangent by differences', worst / maxval(abs(batch%stiffness(:, :, :, :pair))), 0.0_DP, 3.0e-3_DP)
  end subroutine test_difference


  !> One inverted element, or one with NaN, makes the batch invalid; so does a return mapping without solution.
  subroutine test_unsound()
    type(batch_type) :: batch, bad
    type(material_type) :: softening
    call fill(KIND_C3D8_FULL, batch, 0.1_DP, 0.0_DP)
    bad = batch
    bad%u(5, 3, 5:8) = bad%u(5, 3, 5:8) - 3
    call evaluate_plastic_batch_forces(bad, rules(KIND_C3D8_FULL), steel, .true.)
    call suite%that('inverted: forces', .not. bad%is_sound)
    call evaluate_plastic_batch_tangent(bad, rules(KIND_C3D8_FULL), steel)
    call suite%that('inverted: tangent', .not. bad%is_sound)
    bad = batch
    bad%u(8, 2, 3) = ieee_value(1.0_DP, ieee_quiet_nan)
    call evaluate_plastic_batch_forces(bad, rules(KIND_C3D8_FULL), steel, .true.)
    call suite%that('not a number', .not. bad%is_sound)
    softening = steel
    softening%isotropic_hardening(1)%strain = [0.0_DP, 1.0e-4_DP]   ! its slope is below -3 G
    softening%isotropic_hardening(1)%stress = [300.0_DP, 100.0_DP]
    bad = batch
    call evaluate_plastic_batch_forces(bad, rules(KIND_C3D8_FULL), softening, .true.)
    call suite%that('no return: forces', .not. bad%is_sound)
    call evaluate_plastic_batch_tangent(bad, rules(KIND_C3D8_FULL), softening)
    call suite%that('no return: tangent', .not. bad%is_sound)
  end subroutine test_unsound


  !> Other kinds, laws and materials are left to the module `element`.
  subroutine test_choice()
    type(material_type) :: other
    call suite%that('full', is_plastic_batch_kind(KIND_C3D8_FULL, steel, .true.))
    call suite%that('hourglass stiffness', .not. is_plastic_batch_kind(KIND_C3D8R, steel, .true.))
    call suite%that('modes without energy', .not. is_plastic_batch_kind(KIND_C3D20R, steel, .true.))
    call suite%that('small displacements', .not. is_plastic_batch_kind(KIND_C3D8_FULL, steel, .false.))
    call suite%that('mean dilatation', .not. is_plastic_batch_kind(KIND_C3D8, steel, .true.))
    other = steel
    other%law = LAW_HENCKY
    call suite%that('Hencky', .not. is_plastic_batch_kind(KIND_C3D8_FULL, other, .true.))
    other = steel
    other%creep_law = CREEP_TIME_HARDENING
    call suite%that('creep', .not. is_plastic_batch_kind(KIND_C3D8_FULL, other, .true.))
    other = steel
    other%kinematic_hardening = steel%isotropic_hardening
    call suite%that('kinematic', .not. is_plastic_batch_kind(KIND_C3D8_FULL, other, .true.))
    other = steel
    other%isotropic_hardening = [steel%isotropic_hardening, steel%isotropic_hardening]
    call suite%that('two temperatures', .not. is_plastic_batch_kind(KIND_C3D8_FULL, other, .true.))
    other = steel
    allocate (other%elastic%value(2, 2), source=0.3_DP)
    call suite%that('moduli over the temperature', .not. is_plastic_batch_kind(KIND_C3D8_FULL, other, .true.))
    other = steel
    allocate (other%expansion%value(1, 1), source=0.0_DP)
    call suite%that('expansion', .not. is_plastic_batch_kind(KIND_C3D8_FULL, other, .true.))
    other = steel
    deallocate (other%isotropic_hardening)
    call suite%that('no hardening curve', .not. is_plastic_batch_kind(KIND_C3D8_FULL, other, .true.))
  end subroutine test_choice

end program test_plastic_solid_simd
