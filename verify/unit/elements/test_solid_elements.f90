!> Unit test of amontons_solid_elements: volumes, body forces, weights of temperatures and forces of every kind in space.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_solid_elements
  use amontons_element_integration_points, only: integration_points_type, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_DEGENERATE
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type
  use amontons_shape_functions, only: node_coordinates, shape_functions, quadrature
  use amontons_solid_elements, only: evaluate_solid_element, evaluate_solid_volumes, integrate_solid_body_force, &
    set_solid_temperature_weights
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, KIND_BEAM_RECT, &
    KIND_C3D6, KIND_CSS8, KIND_CSS6
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: A(3, 3) = reshape([1.3_DP, 0.2_DP, -0.1_DP, 0.1_DP, 0.8_DP, 0.3_DP, -0.2_DP, 0.1_DP, 1.1_DP], [3, 3])
  real(DP), parameter :: E = 210000.0_DP, NU = 0.3_DP
  integer :: kind
  do kind = 1, KIND_BEAM_RECT
    call check_volume(kind)
    call check_body_force(kind)
    call check_temperatures(kind)
    call check_tension(kind)
    call check_exits(kind)
  end do
  call suite%finish()

contains

  !> The parent element, sheared and stretched, and its volume.
  subroutine make(kind, X, entry, volume)
    integer, intent(in) :: kind
    real(DP), intent(out) :: X(3, MAX_ELEMENT_NODES)
    type(element_kind_type), intent(out) :: entry
    real(DP), intent(out) :: volume
    real(DP) :: xi(3, MAX_ELEMENT_NODES)
    entry = element_kind(kind)
    xi = 0
    call node_coordinates(kind, xi)
    X = matmul(A, xi)
    volume = A(1, 1) * (A(2, 2) * A(3, 3) - A(2, 3) * A(3, 2)) - A(1, 2) * (A(2, 1) * A(3, 3) - A(2, 3) * A(3, 1)) &
      + A(1, 3) * (A(2, 1) * A(3, 2) - A(2, 2) * A(3, 1))
    select case (entry%n_nodes)
    case (4, 10)
      volume = volume / 6
    case (6, 15)
      volume = volume
    case default
      volume = 8 * volume
    end select
  end subroutine make


  !> The parts of the points add up to the volume; an element inside out is reported.
  subroutine check_volume(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    real(DP) :: X(3, MAX_ELEMENT_NODES), volume, volumes(MAX_ELEMENT_POINTS)
    integer :: n, status
    call make(kind, X, entry, volume)
    volumes = -1
    call evaluate_solid_volumes(kind, X, n, volumes, status)
    call suite%that(trim(entry%name) // ': points', n == entry%n_points .and. status == ELEMENT_OK)
    call suite%near(trim(entry%name) // ': volume', sum(volumes(:n)), volume, 1.0e-13_DP)
    call suite%that(trim(entry%name) // ': each is positive', all(volumes(:n) > 0))
    X(1, :) = -X(1, :)
    call evaluate_solid_volumes(kind, X, n, volumes, status)
    call suite%that(trim(entry%name) // ': inside out', status == ELEMENT_DEGENERATE)
  end subroutine check_volume


  !> The nodal forces add up to the whole force and to its moment about the origin.
  subroutine check_body_force(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    real(DP) :: X(3, MAX_ELEMENT_NODES), volume, force(3, MAX_ELEMENT_NODES), centre(3), moment
    real(DP), parameter :: B(3) = [2.0_DP, -1.0_DP, 0.5_DP]
    call make(kind, X, entry, volume)
    force = 0
    call integrate_solid_body_force(kind, X, B, force)
    associate (n => entry%n_nodes)
      call suite%near(trim(entry%name) // ': body force', norm2(sum(force(:, :n), 2) - volume * B), 0.0_DP, 1.0e-12_DP)
      centre = 0
      if (n == 4 .or. n == 10) centre = sum(X(:, :4), 2) / 4
      if (n == 6 .or. n == 15) centre = sum(X(:, :6), 2) / 6
      moment = sum(X(1, :n) * force(2, :n) - X(2, :n) * force(1, :n))
      call suite%near(trim(entry%name) // ': its moment', moment, volume * (centre(1) * B(2) - centre(2) * B(1)), 1.0e-12_DP)
    end associate
  end subroutine check_body_force


  !> Equal temperatures stay equal; linear ones have their mean over the points; quadratic kinds and C3D6 have them at each point.
  !! (Solid shells have a program of their own.)
  subroutine check_temperatures(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    real(DP) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), X(3, MAX_ELEMENT_NODES), volume, T(MAX_ELEMENT_NODES), at
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), mean
    integer :: p, n_rule
    call make(kind, X, entry, volume)
    call set_solid_temperature_weights(kind, weight)
    call quadrature(kind, n_rule, xi, w)
    associate (m => entry%n_nodes)
      T(:m) = 5 + X(1, :m) - 2 * X(2, :m) + 0.5_DP * X(3, :m)
      mean = 0
      do p = 1, entry%n_points
        call suite%near(trim(entry%name) // ': weights add up', sum(weight(:m, p)), 1.0_DP, 1.0e-13_DP)
        at = dot_product(weight(:m, p), T(:m))
        mean = mean + w(p) * at / sum(w(:n_rule))
        call shape_functions(kind, xi(:, p), N, dN)
        if (m > 8 .or. kind == KIND_C3D6) call suite%near(trim(entry%name) // ': linear temperature', at, &
          dot_product(N(:m), T(:m)), 1.0e-12_DP)
        if (m <= 8 .and. all(kind /= [KIND_CSS8, KIND_CSS6, KIND_C3D6])) call suite%near(trim(entry%name) // ': mean temperature', &
          at, sum(T(:m)) / real(m, DP), 1.0e-13_DP)
      end do
      at = 5
      if (m == 10) at = sum(T(:4)) / 4
      if (m == 15) at = sum(T(:6)) / 6
      if (m > 8) call suite%near(trim(entry%name) // ': mean', mean, at, 1.0e-12_DP)
    end associate
  end subroutine check_temperatures


  !> Uniaxial tension: the stress at every point, no transverse stress, and the energy is the work of the forces.
  subroutine check_tension(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    type(material_type) :: material
    type(integration_points_type) :: points
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), volume, force(3, MAX_ELEMENT_NODES), work
    real(DP), parameter :: STRAIN = 1.0e-3_DP
    integer :: status, p
    call make(kind, X, entry, volume)
    material%youngs_modulus = E
    material%poissons_ratio = NU
    u = STRAIN * X
    u(2:, :) = -NU * u(2:, :)
    call evaluate_solid_element(kind, material, X(:, :entry%n_nodes), u(:, :entry%n_nodes), .false., force, points, status)
    call suite%that(trim(entry%name) // ': tension', status == ELEMENT_OK)
    do p = 1, entry%n_points
      call suite%near(trim(entry%name) // ': stress', norm2(points%stress(:, p) - [E * STRAIN, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, &
        0.0_DP]), 0.0_DP, 1.0e-9_DP)
    end do
    work = 0.5_DP * sum(force(:, :entry%n_nodes) * u(:, :entry%n_nodes))
    call suite%near(trim(entry%name) // ': work', work, 0.5_DP * E * STRAIN**2 * volume, 1.0e-11_DP)
  end subroutine check_tension


  !> A displacement that turns the element inside out.
  subroutine check_exits(kind)
    integer, intent(in) :: kind
    type(element_kind_type) :: entry
    type(material_type) :: material
    type(integration_points_type) :: points
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES), volume, force(3, MAX_ELEMENT_NODES)
    integer :: status
    call make(kind, X, entry, volume)
    material%youngs_modulus = E
    u = 0
    u(1, :) = -2 * X(1, :)
    call evaluate_solid_element(kind, material, X(:, :entry%n_nodes), u(:, :entry%n_nodes), .true., force, points, status)
    call suite%that(trim(entry%name) // ': inverted', status == ELEMENT_INVERTED)
  end subroutine check_exits

end program test_solid_elements
