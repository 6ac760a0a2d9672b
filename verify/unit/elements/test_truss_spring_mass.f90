!> Unit test of amontons_truss_spring_mass and amontons_zero_stress_condition: closed forms, energy, tangent, rotation, exits.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_truss_spring_mass
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use amontons_element, only: integration_points_type, evaluate_element_forces, evaluate_element_volume, &
    integrate_body_force, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_kinds, only: DP
  use amontons_materials, only: spring_type, material_type, LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_element_kinds, only: element_kind, element_kind_type, KIND_T3D2, KIND_T3D3, KIND_SPRINGA, KIND_SPRING1, &
    KIND_SPRING2, &
    KIND_GAPUNI, KIND_MASS, MAX_ELEMENT_NODES
  use amontons_truss_spring_mass, only: spring_energy
  use check, only: suite_type
  implicit none
  integer, parameter :: N_DOF = 3 * MAX_ELEMENT_NODES
  type(suite_type) :: suite
  type(material_type) :: material
  type(spring_type), allocatable :: spring       ! law that points get
  integer :: kind, law

  material%youngs_modulus = 210000
  material%poissons_ratio = 0.3_DP
  do kind = KIND_T3D2, KIND_SPRING2
    do law = LAW_HENCKY, LAW_SAINT_VENANT
      material%law = law
      call check_derivatives(kind, .true.)
    end do
    call check_derivatives(kind, .false.)
  end do
  call check_laws()
  call check_hencky_bar(KIND_T3D2)
  call check_hencky_bar(KIND_T3D3)
  call check_green_bar()
  call check_rotation(KIND_T3D2)
  call check_rotation(KIND_T3D3)
  call check_rotation(KIND_SPRINGA)
  call check_springs()
  call check_weights()
  call check_exits()
  call suite%finish()

contains

  !> A truss or spring in space.
  subroutine place(X)
    real(DP), intent(out) :: X(3, 3)
    X = reshape([0.1_DP, 0.2_DP, -0.3_DP, 1.4_DP, 0.9_DP, 0.5_DP, 0.8_DP, 0.5_DP, 0.2_DP], [3, 3])
  end subroutine place


  !> Points with a section and directions.
  subroutine equip(points)
    type(integration_points_type), intent(out) :: points
    points%section_value = 0.25_DP
    points%directions = [3, 1]
    points%temperature = 30
    if (allocated(spring)) points%spring = spring
  end subroutine equip


  !> Springs with laws: two tables over the temperature, constants over the temperature, a closed and an open gap.
  subroutine check_laws()
    integer :: i
    allocate (spring)
    allocate (spring%force(2))
    do i = 1, 2
      spring%force(i)%temperature = 100.0_DP * real(i - 1, DP)
      spring%force(i)%strain = [-2.0_DP, -0.01_DP, 0.02_DP, 2.0_DP]
      spring%force(i)%stress = real(i, DP) * [-5.0_DP, -1.0_DP, 1.0_DP, 9.0_DP]
    end do
    do i = KIND_SPRINGA, KIND_SPRING2
      call check_derivatives(i, .true.)
      call check_derivatives(i, .false.)
    end do
    deallocate (spring%force)
    spring%constant%temperature = [0.0_DP, 100.0_DP]
    spring%constant%value = reshape([2.0_DP, 7.0_DP], [1, 2])
    spring%axes = reshape([0.6_DP, 0.8_DP, 0.0_DP, 0.0_DP, -0.6_DP, 0.8_DP], [3, 2])
    do i = KIND_SPRINGA, KIND_SPRING2
      call check_derivatives(i, .false.)
    end do
    spring%is_gap = .true.
    spring%stiffness = 3
    spring%open_force = 0.1_DP
    do i = -1, 1
      spring%clearance = 0.5_DP * real(i, DP)                ! the elongation is -0.34
      call check_derivatives(KIND_GAPUNI, .true.)
    end do
    spring%axes = 0
    call check_derivatives(KIND_GAPUNI, .false.)
    spring%is_gap = .false.
    spring%is_distance_limit = .true.
    spring%clearance = -0.6_DP
    call check_derivatives(KIND_SPRINGA, .true.)
    deallocate (spring)
  end subroutine check_laws


  !> The tangent is the derivative of the force, and the force of a truss that of its energy.
  subroutine check_derivatives(kind, is_nlgeom)
    integer, intent(in) :: kind
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: STEP = 1e-6_DP
    real(DP) :: X(3, 3), u(3, 3), moved(3, 3), force(3, MAX_ELEMENT_NODES), fp(3, MAX_ELEMENT_NODES), fm(3, MAX_ELEMENT_NODES), &
      K(N_DOF, N_DOF)
    real(DP) :: difference(N_DOF), slope, worst, worst_force
    type(integration_points_type) :: points, plus, minus
    type(element_kind_type) :: entry
    integer :: n, m, a, j, status
    entry = element_kind(kind)
    n = entry%n_nodes
    m = entry%n_points
    call place(X)
    call equip(points)
    call equip(plus)
    call equip(minus)
    u = reshape([-0.1_DP, 0.3_DP, 0.2_DP, 0.4_DP, -0.5_DP, 0.1_DP, 0.15_DP, -0.12_DP, 0.11_DP], [3, 3])
    call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), is_nlgeom, force, points, status, K)
    call suite%that(entry%name // 'status', status == ELEMENT_OK)
    worst = 0
    worst_force = 0
    do a = 1, n
      do j = 1, 3
        moved = u
        moved(j, a) = u(j, a) + STEP
        call evaluate_element_forces(kind, material, X(:, :n), moved(:, :n), is_nlgeom, fp, plus, status)
        moved(j, a) = u(j, a) - STEP
        call evaluate_element_forces(kind, material, X(:, :n), moved(:, :n), is_nlgeom, fm, minus, status)
        difference = reshape((fp - fm) / (2 * STEP), [N_DOF])
        worst = max(worst, maxval(abs(difference(:3 * n) - K(:3 * n, 3 * a - 3 + j))))
        slope = sum((plus%energy(:m) - minus%energy(:m)) * plus%volume(:m)) / (2 * STEP)
        if (m == 0) then
          slope = -spring_energy(kind, X(:, :n), moved(:, :n), is_nlgeom, points)
          moved(j, a) = u(j, a) + STEP
          slope = (slope + spring_energy(kind, X(:, :n), moved(:, :n), is_nlgeom, points)) / (2 * STEP)
        end if
        worst_force = max(worst_force, abs(slope - force(j, a)))
      end do
    end do
    call suite%near(entry%name // 'tangent by differences', worst, 0.0_DP, 1e-8_DP * norm2(K(:3 * n, :3 * n)))
    call suite%near(entry%name // 'symmetric', maxval(abs(K(:3 * n, :3 * n) - transpose(K(:3 * n, :3 * n)))), 0.0_DP, &
      1e-12_DP * norm2(K(:3 * n, :3 * n)))
    call suite%near(entry%name // 'force by differences of the energy', worst_force, 0.0_DP, 1e-8_DP * norm2(force))
    if (m == 0) call suite%near(entry%name // 'no energy at rest', spring_energy(kind, X(:, :n), 0 * u(:, :n), is_nlgeom, points), &
      0.0_DP, 1e-15_DP)
    call suite%near(entry%name // 'no sum', merge(0.0_DP, maxval(abs(sum(force, 2))), kind >= KIND_SPRING1), 0.0_DP, &
      1e-12_DP * norm2(force))
  end subroutine check_derivatives


  !> Hencky's law in uniaxial stress: tau = E ln s, J = s^(1 - 2 nu), for any s.
  subroutine check_hencky_bar(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: STRETCH(3) = [0.3_DP, 1.0_DP + 1e-9_DP, 3.0_DP]
    real(DP) :: X(3, 3), u(3, 3), force(3, MAX_ELEMENT_NODES), tau
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: i, n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    material%law = LAW_HENCKY
    X = 0
    X(1, :) = [1.0_DP, 3.0_DP, 2.0_DP]
    do i = 1, 3
      u = (STRETCH(i) - 1) * X
      call equip(points)
      call evaluate_element_forces(kind, material, X(:, :n), u(:, :n), .true., force, points, status)
      tau = material%youngs_modulus * log(STRETCH(i))
      call suite%near('Hencky bar: force', force(1, 2), tau * 0.25_DP / STRETCH(i), max(1e-12_DP * abs(tau), 1e-11_DP))
      call suite%near('Hencky bar: Cauchy stress', points%stress(1, 1), tau / STRETCH(i)**(1 - 0.6_DP), &
        max(1e-12_DP * abs(tau), 1e-11_DP))
      call suite%near('Hencky bar: lateral strain', points%strain(2, 1), -0.3_DP * log(STRETCH(i)), 1e-14_DP)
    end do
  end subroutine check_hencky_bar


  !> Saint-Venant's law in uniaxial stress: S = E E11, force = A S s.
  subroutine check_green_bar()
    real(DP) :: X(3, 2), u(3, 2), force(3, MAX_ELEMENT_NODES), s
    type(integration_points_type) :: points
    integer :: status
    material%law = LAW_SAINT_VENANT
    X = 0
    X(2, 2) = 2
    s = 1.4_DP
    u = (s - 1) * X
    call equip(points)
    call evaluate_element_forces(KIND_T3D2, material, X, u, .true., force, points, status)
    call suite%near('Saint-Venant bar: force', force(2, 2), 0.25_DP * material%youngs_modulus * 0.5_DP * (s**2 - 1) * s, &
      1e-10_DP * material%youngs_modulus)
  end subroutine check_green_bar


  !> A rotation gives no force, and a stretched bar after rotation has the rotated force.
  subroutine check_rotation(kind)
    integer, intent(in) :: kind
    real(DP), parameter :: Q(3, 3) = reshape([0.36_DP, 0.48_DP, -0.8_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.48_DP, 0.64_DP, &
      0.6_DP], [3, 3])
    real(DP) :: X(3, 3), force(3, MAX_ELEMENT_NODES), turned(3, MAX_ELEMENT_NODES)
    type(integration_points_type) :: points
    type(element_kind_type) :: entry
    integer :: n, status
    entry = element_kind(kind)
    n = entry%n_nodes
    material%law = LAW_HENCKY
    call place(X)
    call equip(points)
    call evaluate_element_forces(kind, material, X(:, :n), matmul(Q, X(:, :n)) - X(:, :n), .true., force, points, status)
    call suite%near(entry%name // 'rotation', maxval(abs(force)), 0.0_DP, 1e-13_DP * material%youngs_modulus)
    call evaluate_element_forces(kind, material, X(:, :n), 0.2_DP * X(:, :n), .true., force, points, status)
    call evaluate_element_forces(kind, material, X(:, :n), 1.2_DP * matmul(Q, X(:, :n)) - X(:, :n), .true., turned, points, status)
    call suite%near(entry%name // 'stretched and turned', maxval(abs(turned - matmul(Q, force))), 0.0_DP, &
      1e-12_DP * material%youngs_modulus)
  end subroutine check_rotation


  !> Spring tension: constant times elongation.
  subroutine check_springs()
    real(DP) :: X(3, 3), u(3, 3), force(3, MAX_ELEMENT_NODES)
    type(integration_points_type) :: points
    integer :: status
    call place(X)
    u = reshape([1.0_DP, 2.0_DP, 3.0_DP, 5.0_DP, 7.0_DP, 11.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], [3, 3])
    call equip(points)
    call evaluate_element_forces(KIND_SPRING1, material, X(:, :1), u(:, :1), .true., force, points, status)
    call suite%near('SPRING1', norm2(force(:, 1) - [0.0_DP, 0.0_DP, 0.75_DP]), 0.0_DP, 1e-15_DP)
    call evaluate_element_forces(KIND_SPRING2, material, X(:, :2), u(:, :2), .true., force, points, status)
    call suite%near('SPRING2', norm2(force(:, :2) - reshape([0.0_DP, 0.0_DP, -0.5_DP, 0.5_DP, 0.0_DP, 0.0_DP], [3, 2])), &
      0.0_DP, 1e-15_DP)
    X(:, 2) = X(:, 1) + [0.0_DP, 2.0_DP, 0.0_DP]
    u(:, 2) = u(:, 1) + [3.0_DP, 2.0_DP, 0.0_DP]
    call evaluate_element_forces(KIND_SPRINGA, material, X(:, :2), u(:, :2), .true., force, points, status)
    call suite%near('SPRINGA large: 3-4-5', norm2(force(:, 2) - 0.75_DP * [0.6_DP, 0.8_DP, 0.0_DP]), 0.0_DP, 1e-15_DP)
    call evaluate_element_forces(KIND_SPRINGA, material, X(:, :2), u(:, :2), .false., force, points, status)
    call suite%near('SPRINGA small', norm2(force(:, 2) - [0.0_DP, 0.5_DP, 0.0_DP]), 0.0_DP, 1e-15_DP)
  end subroutine check_springs


  !> Volumes and weights.
  subroutine check_weights()
    real(DP), parameter :: b(3) = [1.0_DP, -2.0_DP, 5.0_DP]
    real(DP) :: X(3, 3), force(3, MAX_ELEMENT_NODES), volume
    integer :: status
    X = 0
    X(1, :) = [1.0_DP, 3.0_DP, 2.0_DP]
    call evaluate_element_volume(KIND_T3D3, X, 0.25_DP, volume, status)
    call suite%near('volume of a truss', volume, 0.5_DP, 1e-15_DP)
    call integrate_body_force(KIND_T3D3, X, 0.25_DP, b, force)
    call suite%near('weight of a truss', norm2(sum(force, 2) - 0.5_DP * b), 0.0_DP, 1e-14_DP)
    call integrate_body_force(KIND_MASS, X(:, :1), 3.0_DP, b, force)
    call suite%near('weight of a mass', norm2(force(:, 1) - 3 * b), 0.0_DP, 0.0_DP)
    call integrate_body_force(KIND_SPRINGA, X(:, :2), 3.0_DP, b, force)
    call suite%near('a spring has none', norm2(force), 0.0_DP, 0.0_DP)
    call evaluate_element_volume(KIND_MASS, X(:, :1), 3.0_DP, volume, status)
    call suite%that('a mass has no volume', status == ELEMENT_OK .and. abs(volume) <= 0)
  end subroutine check_weights


  !> NaN, a bar compressed to zero length, coincident nodes.
  subroutine check_exits()
    real(DP) :: X(3, 3), u(3, 3), force(3, MAX_ELEMENT_NODES), volume
    type(integration_points_type) :: points
    integer :: status
    call place(X)
    call equip(points)
    u = 0
    u(:, 2) = X(:, 1) - X(:, 2)
    call evaluate_element_forces(KIND_T3D2, material, X(:, :2), u(:, :2), .true., force, points, status)
    call suite%that('exit: pressed to nothing', status == ELEMENT_INVERTED)
    call evaluate_element_forces(KIND_SPRINGA, material, X(:, :2), u(:, :2), .true., force, points, status)
    call suite%that('exit: spring pressed to nothing', status == ELEMENT_INVERTED)
    u(1, 1) = ieee_value(1.0_DP, ieee_quiet_nan)
    call evaluate_element_forces(KIND_T3D2, material, X(:, :2), u(:, :2), .true., force, points, status)
    call suite%that('exit: NaN', status == ELEMENT_NOT_FINITE)
    call evaluate_element_forces(KIND_SPRING2, material, X(:, :2), u(:, :2), .true., force, points, status)
    call suite%that('exit: NaN of a spring', status == ELEMENT_NOT_FINITE)
    X(:, 2) = X(:, 1)
    call evaluate_element_volume(KIND_SPRINGA, X(:, :2), 1.0_DP, volume, status)
    call suite%that('exit: spring without length', status == ELEMENT_DEGENERATE)
    call evaluate_element_volume(KIND_T3D2, X(:, :2), 1.0_DP, volume, status)
    call suite%that('exit: truss without length', status == ELEMENT_DEGENERATE)
  end subroutine check_exits

end program test_truss_spring_mass
