!> Plane stress, plane strain and axisymmetric elements with B-bar/F-bar or incompatible modes, and the pressure on their edges.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The material law is three-dimensional: the plane strains enter it as xx yy zz xy, with zz
!!
!!     plane strain    zero
!!     plane stress    such that the stress zz is zero                         (`zero_stress_condition`)
!!     axisymmetric    the hoop strain, u_x / X; x is the radius, y the axis
!!
!! so that every law works for every kind. With B of four rows the rest equals that of the solids, including mean dilatation of
!! CPE4 and CAX4. Integrals are over the thickness, or over the full circle (2 pi X), and so are all forces.
!! Theory: doc/theory/elements.md, section "Plane and axisymmetric elements".
module amontons_plane_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP, PI
  use amontons_zero_stress_condition, only: solve_zero_stress, evaluate_initial_tangent, CONDITION_NONE, CONDITION_PLANE_STRESS
  use amontons_incompatible_modes, only: mode_iteration_type, evaluate_plane_mode_gradients, correct_mode_amplitudes, &
    condense_mode_amplitudes, N_MODES, MAX_AMPLITUDE_CORRECTIONS, TOL_MODE_FORCE_ACCEPTABLE
  use amontons_hourglass_flow, only: load_hourglass_flow, store_hourglass_flow
  use amontons_hourglass, only: hourglass_type, set_physical_hourglass, set_artificial_hourglass, add_hourglass_forces, &
    has_present_modulus, artificial_modulus
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: material_type, LAW_SAINT_VENANT
  use amontons_element_integration_points, only: integration_points_type, set_point_input, store_point_output, &
    split_unsymmetric_tangent, &
    ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_shape_functions, only: shape_functions, quadrature, facet_shapes, facet_quadrature, MAX_FACET_POINTS
  use amontons_elasticity, only: STRESS_OK, STRESS_INVERTED, MAX_DISPLACEMENT_GRADIENT
  use amontons_logarithmic_strain, only: log1p
  use amontons_tensor, only: IDENTITY, determinant_minus_one, invert
  use amontons_element_kinds, only: element_kind, element_kind_type, is_one_point, has_modes, KIND_CPE4_FULL, &
    FAMILY_PLANE_STRESS, FAMILY_AXISYMMETRIC, FACET_TRI3, FACET_QUAD4, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, MAX_FACE_NODES, &
    N_CIRCLE_SECTORS
  implicit none
  private
  public :: evaluate_plane_element, evaluate_plane_volumes, integrate_plane_body_force, set_plane_temperature_weights, &
    integrate_edge_pressure

  integer, parameter :: MAX_PLANE_NODES = 8                    !< most nodes
  integer, parameter :: MAX_PLANE_POINTS = 10                   !< most points
  integer, parameter :: PLANE_COMPONENTS(4) = [1, 2, 3, 4]       !< xx yy zz xy among the six

  !> The geometry of one element.
  type :: plane_geometry_type
    type(element_kind_type) :: entry                  !< of its kind
    integer :: n = 0                                  !< nodes
    integer :: n_all = 0                              !< nodes and incompatible modes, which follow as if they were nodes
    integer :: m = 0                                  !< points
    real(DP) :: N_a(MAX_PLANE_NODES, MAX_PLANE_POINTS)                   !< shape functions [-]
    real(DP) :: weight(MAX_PLANE_NODES, MAX_PLANE_POINTS)                !< of the nodal temperatures [-]
    real(DP) :: gradient(MAX_PLANE_NODES, 2, MAX_PLANE_POINTS)           !< dN_a/dX, later dN_a/dx [1/length]
    real(DP) :: hoop(MAX_PLANE_NODES, MAX_PLANE_POINTS)                  !< N_a/X, later N_a/x; 0 but for axisymmetric kinds
                                                                         !! [1/length]
    real(DP) :: radial(MAX_PLANE_NODES, 2, MAX_PLANE_POINTS)             !< what the gradient of u_x has more, of modes [1/length]
    real(DP) :: reference(MAX_PLANE_POINTS)                     !< reference volumes of the points [length^3]
    real(DP) :: current(MAX_PLANE_POINTS)                       !< current volumes [length^3]
    real(DP) :: H(3, 3, MAX_PLANE_POINTS)                       !< displacement gradient, or that of F-bar [-]
    real(DP) :: j(MAX_PLANE_POINTS)                             !< det(1 + H) - 1 [-]
    real(DP) :: mean(2 * MAX_PLANE_NODES)                      !< mean of B^T 1 over the (current) volume [1/length]
    real(DP) :: at_rest(MAX_PLANE_NODES, 2)                    !< dN_a/dX of the first point [1/length]
    real(DP) :: reference_hoop(4)                       !< N_a/X of the first point [1/length]
    logical :: is_one_point = .false.
    real(DP) :: modulus = 0                             !< of the artificial hourglass stiffness, of a kind with one point [stress]
  end type plane_geometry_type

contains

  !> Internal force, point values and, if requested, the tangent of an element.
  pure subroutine evaluate_plane_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_CPS..., KIND_CPE..., KIND_CAX...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements; the third is not looked at [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< [force]
    type(integration_points_type), intent(inout) :: points     !< in: section, the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u [force/length]
    type(plane_geometry_type) :: geometry
    type(element_kind_type) :: entry
    real(DP) :: tau(4, MAX_PLANE_POINTS), c(4, 4, MAX_PLANE_POINTS), B(4, 2 * MAX_PLANE_NODES, MAX_PLANE_POINTS), &
      f(2 * MAX_PLANE_NODES)
    if (has_modes(kind)) then
      call evaluate_incompatible_modes(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
      return
    end if
    entry = element_kind(kind)
    force = 0
    call set_reference(kind, entry, X, points%section_value, geometry, status)
    if (status == ELEMENT_OK) call update_kinematics(entry, u, is_nlgeom, geometry, B, status)
    if (status == ELEMENT_OK) call evaluate_stresses(entry, material, is_nlgeom, geometry, tau, c, points, status)
    if (status /= ELEMENT_OK) return
    call integrate_forces(entry%is_mean_dilatation, geometry, B, tau, f)
    force(:2, :geometry%n) = reshape(f(:2 * geometry%n), [2, geometry%n])
    if (present(stiffness)) then
      if (.not. is_nlgeom) tau = 0
      stiffness(:3 * geometry%n, :3 * geometry%n) = 0
      call integrate_stiffness(entry%is_mean_dilatation, geometry, B, tau, c, stiffness)
    end if
    if (geometry%is_one_point) call add_hourglass_control(entry, material, X, u, is_nlgeom, geometry, force, points, stiffness)
  end subroutine evaluate_plane_element


  !> Gradients, hoop terms and volumes in the reference configuration. A kind with one point uses their mean over the
  !! element, by the rule of four points.
  pure subroutine set_reference(kind, entry, X, section, geometry, status)
    integer, intent(in) :: kind
    type(element_kind_type), intent(in) :: entry
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) [length]
    real(DP), intent(in) :: section                !< thickness [length]
    type(plane_geometry_type), intent(out) :: geometry
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    real(DP) :: J(2, 2), det, radius
    integer :: rule, p, a
    status = ELEMENT_OK
    rule = kind
    geometry%is_one_point = is_one_point(kind)
    if (geometry%is_one_point) rule = KIND_CPE4_FULL
    geometry%entry = entry
    geometry%n = entry%n_nodes
    geometry%n_all = geometry%n
    geometry%hoop = 0
    geometry%radial = 0
    call quadrature(rule, geometry%m, xi, w)
    do p = 1, geometry%m
      call shape_functions(rule, xi(:, p), N, dN)
      J = 0
      do a = 2, geometry%n
        J(:, 1) = J(:, 1) + (X(:2, a) - X(:2, 1)) * dN(1, a)
        J(:, 2) = J(:, 2) + (X(:2, a) - X(:2, 1)) * dN(2, a)
      end do
      det = J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)
      geometry%N_a(:, p) = N(:MAX_PLANE_NODES)
      geometry%reference(p) = w(p) * det * section
      if (.not. abs(det) > 0) det = 1
      geometry%gradient(:, 1, p) = (dN(1, :MAX_PLANE_NODES) * J(2, 2) - dN(2, :MAX_PLANE_NODES) * J(2, 1)) / det
      geometry%gradient(:, 2, p) = (dN(2, :MAX_PLANE_NODES) * J(1, 1) - dN(1, :MAX_PLANE_NODES) * J(1, 2)) / det
      if (entry%family == FAMILY_AXISYMMETRIC) then
        radius = dot_product(N(:geometry%n), X(1, :geometry%n))
        geometry%reference(p) = w(p) * det * 2 * PI * radius
        geometry%hoop(:geometry%n, p) = N(:geometry%n) / merge(radius, 1.0_DP, abs(radius) > 0)
      end if
      if (.not. geometry%reference(p) > 0) status = ELEMENT_DEGENERATE
    end do
    if (geometry%is_one_point .and. status == ELEMENT_OK) call average_gradients(geometry)
    if (has_modes(kind) .and. status == ELEMENT_OK) then
      geometry%n_all = geometry%n + N_MODES
      call evaluate_plane_mode_gradients(X, xi, entry%family == FAMILY_AXISYMMETRIC, geometry%gradient(5:6, :, :4), &
        geometry%radial(5:6, 1, :4), geometry%hoop(5:7, :4))
    end if
    call set_point_temperature_weights(entry, xi, geometry)
    geometry%at_rest = geometry%gradient(:, :, 1)
    geometry%reference_hoop = geometry%hoop(:4, 1)
    geometry%current = geometry%reference
  end subroutine set_reference


  !> Weights of the nodal temperatures at the points of a plane or axisymmetric element.
  pure subroutine set_plane_temperature_weights(kind, weight)
    integer, intent(in) :: kind
    real(DP), intent(inout) :: weight(:, :)        !< (MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), zero [-]
    type(plane_geometry_type) :: geometry
    type(element_kind_type) :: entry
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    entry = element_kind(kind)
    geometry%n = entry%n_nodes
    call quadrature(kind, geometry%m, xi, w)
    call set_point_temperature_weights(entry, xi, geometry)
    weight(:geometry%n, :geometry%m) = geometry%weight(:geometry%n, :geometry%m)
  end subroutine set_plane_temperature_weights


  !> Weights of the nodal temperatures, one degree below the displacements: the mean in linear elements, linear from the
  !! corners in quadratic ones.
  pure subroutine set_point_temperature_weights(entry, xi, geometry)
    type(element_kind_type), intent(in) :: entry
    real(DP), intent(in) :: xi(3, MAX_ELEMENT_POINTS)      !< of the points
    type(plane_geometry_type), intent(inout) :: geometry
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: p
    geometry%weight = 0
    if (entry%n_nodes == entry%n_faces) then
      geometry%weight(:geometry%n, :) = 1 / real(geometry%n, DP)
      return
    end if
    do p = 1, geometry%m
      call facet_shapes(merge(FACET_TRI3, FACET_QUAD4, entry%n_faces == 3), xi(:2, p), N, dN, ddN)
      geometry%weight(:entry%n_faces, p) = N(:entry%n_faces)
    end do
  end subroutine set_point_temperature_weights


  !> Puts the mean over all points into the first and only one.
  pure subroutine average_gradients(geometry)
    type(plane_geometry_type), intent(inout) :: geometry
    real(DP) :: volume
    integer :: i
    associate (m => geometry%m, weight => geometry%reference(:geometry%m))
      volume = sum(weight)
      do i = 1, 2
        geometry%gradient(:, i, 1) = matmul(geometry%gradient(:, i, :m), weight) / volume
      end do
      geometry%hoop(:, 1) = matmul(geometry%hoop(:, :m), weight) / volume
      geometry%N_a(:, 1) = matmul(geometry%N_a(:, :m), weight) / volume
    end associate
    geometry%m = 1
    geometry%reference(1) = volume
  end subroutine average_gradients


  !> Displacement gradients; under NLGEOM current gradients and volumes; B; with mean dilatation its mean and F-bar.
  pure subroutine update_kinematics(entry, u, is_nlgeom, geometry, B, status)
    type(element_kind_type), intent(in) :: entry
    real(DP), intent(in) :: u(:, :)                !< (3, nodes and modes) [length]
    logical, intent(in) :: is_nlgeom
    type(plane_geometry_type), intent(inout) :: geometry
    real(DP), intent(out) :: B(4, 2 * MAX_PLANE_NODES, MAX_PLANE_POINTS)
    integer, intent(out) :: status                 !< ELEMENT_...
    integer :: p, a
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u(:2, :geometry%n_all)))) return
    status = ELEMENT_OK
    do p = 1, geometry%m
      geometry%H(:, :, p) = 0
      do a = 1, geometry%n
        geometry%H(:2, 1, p) = geometry%H(:2, 1, p) + (u(:2, a) - u(:2, 1)) * geometry%gradient(a, 1, p)
        geometry%H(:2, 2, p) = geometry%H(:2, 2, p) + (u(:2, a) - u(:2, 1)) * geometry%gradient(a, 2, p)
        geometry%H(3, 3, p) = geometry%H(3, 3, p) + u(1, a) * geometry%hoop(a, p)
      end do
      do a = geometry%n + 1, geometry%n_all
        geometry%H(:2, 1, p) = geometry%H(:2, 1, p) + u(:2, a) * geometry%gradient(a, 1, p)
        geometry%H(:2, 2, p) = geometry%H(:2, 2, p) + u(:2, a) * geometry%gradient(a, 2, p)
        geometry%H(1, 1, p) = geometry%H(1, 1, p) + u(1, a) * geometry%radial(a, 1, p)
        geometry%H(3, 3, p) = geometry%H(3, 3, p) + u(1, a) * geometry%hoop(a, p)
      end do
      if (is_nlgeom) call push_forward(geometry, p, status)
      if (status /= ELEMENT_OK) return
      do a = 1, geometry%n_all
        B(:, 2 * a - 1, p) = [geometry%gradient(a, 1, p) + geometry%radial(a, 1, p), 0.0_DP, geometry%hoop(a, p), &
          geometry%gradient(a, 2, p) + geometry%radial(a, 2, p)]
        B(:, 2 * a, p) = [0.0_DP, geometry%gradient(a, 2, p), 0.0_DP, geometry%gradient(a, 1, p)]
      end do
    end do
    if (.not. entry%is_mean_dilatation) return
    geometry%mean = 0
    do p = 1, geometry%m
      geometry%mean = geometry%mean + geometry%current(p) * (B(1, :, p) + B(2, :, p) + B(3, :, p))
    end do
    geometry%mean = geometry%mean / sum(geometry%current(:geometry%m))
    call set_mean_dilatation(is_nlgeom, geometry)
  end subroutine update_kinematics


  !> Turns the gradients and the volume of a point into current ones.
  pure subroutine push_forward(geometry, p, status)
    type(plane_geometry_type), intent(inout) :: geometry
    integer, intent(in) :: p                       !< point
    integer, intent(out) :: status                 !< ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE
    real(DP) :: F(2, 2), det, x(MAX_PLANE_NODES)
    status = ELEMENT_NOT_FINITE
    if (.not. all(abs(geometry%H(:, :, p)) <= MAX_DISPLACEMENT_GRADIENT)) return
    status = ELEMENT_INVERTED
    geometry%j(p) = determinant_minus_one(geometry%H(:, :, p))
    F = IDENTITY(:2, :2) + geometry%H(:2, :2, p)
    det = F(1, 1) * F(2, 2) - F(1, 2) * F(2, 1)
    if (.not. (geometry%j(p) > -1 .and. det > 0)) return
    status = ELEMENT_OK
    geometry%current(p) = (1 + geometry%j(p)) * geometry%reference(p)
    x = (geometry%gradient(:, 1, p) * F(2, 2) - geometry%gradient(:, 2, p) * F(2, 1)) / det
    geometry%gradient(:, 2, p) = (geometry%gradient(:, 2, p) * F(1, 1) - geometry%gradient(:, 1, p) * F(1, 2)) / det
    geometry%gradient(:, 1, p) = x
    if (geometry%n_all > geometry%n) then
      geometry%radial(:, 2, p) = -geometry%radial(:, 1, p) * F(1, 2) / det
      geometry%radial(:, 1, p) = geometry%radial(:, 1, p) * F(2, 2) / det
    end if
    geometry%hoop(:, p) = geometry%hoop(:, p) / (1 + geometry%H(3, 3, p))
  end subroutine push_forward


  !> Replaces the change of volume of each point by that of the element: B-bar, or F-bar with r^3 = Jbar/J.
  pure subroutine set_mean_dilatation(is_nlgeom, geometry)
    logical, intent(in) :: is_nlgeom
    type(plane_geometry_type), intent(inout) :: geometry       !< H and j change
    real(DP) :: change(MAX_PLANE_POINTS), mean, cube, r
    integer :: p
    do p = 1, geometry%m
      change(p) = geometry%H(1, 1, p) + geometry%H(2, 2, p) + geometry%H(3, 3, p)
      if (is_nlgeom) change(p) = geometry%j(p)
    end do
    associate (weight => geometry%reference(:geometry%m))
      mean = sum(change(:geometry%m) * weight) / sum(weight)
    end associate
    do p = 1, geometry%m
      if (is_nlgeom) then
        cube = (mean - geometry%j(p)) / (1 + geometry%j(p))
        r = exp(log1p(cube) / 3)
        geometry%H(:, :, p) = geometry%H(:, :, p) + (cube / (1 + r + r * r)) * (IDENTITY + geometry%H(:, :, p))
        geometry%j(p) = mean
      else
        geometry%H(:, :, p) = geometry%H(:, :, p) + ((mean - change(p)) / 3) * IDENTITY
      end if
    end do
  end subroutine set_mean_dilatation


  !> Stress, tangent and point values at all points; the modulus of the hourglass stiffness.
  pure subroutine evaluate_stresses(entry, material, is_nlgeom, geometry, tau, c, points, status)
    type(element_kind_type), intent(in) :: entry
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(plane_geometry_type), intent(inout) :: geometry       !< modulus changes
    real(DP), intent(out) :: tau(4, MAX_PLANE_POINTS), c(4, 4, MAX_PLANE_POINTS)
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status                 !< ELEMENT_...
    type(material_point_type) :: point
    integer :: p
    status = ELEMENT_OK
    do p = 1, geometry%m
      call set_point_input(material, points, p, geometry%weight(:geometry%n, p), point)
      point%H = geometry%H(:, :, p)
      if (geometry%is_one_point .and. has_present_modulus(material)) point%is_tangent_wanted = .true.
      call solve_zero_stress(stress_condition(entry), material, is_nlgeom, point, status)
      if (status /= STRESS_OK) exit
      call split_unsymmetric_tangent(material, point, points, p)
      tau(:, p) = point%stress(PLANE_COMPONENTS)
      c(:, :, p) = point%tangent(PLANE_COMPONENTS, PLANE_COMPONENTS)
      call store_point_output(material, is_nlgeom, point, points, p)
      points%volume(p) = geometry%reference(p)
    end do
    if (status == STRESS_OK .and. geometry%is_one_point .and. material%law == LAW_SAINT_VENANT) &
      call find_artificial_modulus(stress_condition(entry), material, is_nlgeom, points, point, geometry%modulus)
    if (status /= STRESS_OK) status = merge(ELEMENT_INVERTED, ELEMENT_NOT_FINITE, status == STRESS_INVERTED)
  end subroutine evaluate_stresses


  !> The modulus of the artificial hourglass stiffness: of the law in space, in plane stress too, at the strains that it has found.
  pure subroutine find_artificial_modulus(condition, material, is_nlgeom, points, point, modulus)
    integer, intent(in) :: condition               !< CONDITION_...
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(integration_points_type), intent(in) :: points
    type(material_point_type), intent(inout) :: point       !< in: with H, the past and the tangent
    real(DP), intent(out) :: modulus               !< [stress]
    real(DP) :: c(6, 6)
    integer :: status
    call evaluate_initial_tangent(CONDITION_NONE, material, is_nlgeom, 4, points, c)
    if (condition /= CONDITION_NONE .and. has_present_modulus(material)) &
      call solve_zero_stress(CONDITION_NONE, material, is_nlgeom, point, status)
    modulus = artificial_modulus(material, c, point%tangent, merge(point%H, 0.0_DP, is_nlgeom))
  end subroutine find_artificial_modulus


  !> Plane stress: the normal strain across the thickness is free.
  pure integer function stress_condition(entry)
    type(element_kind_type), intent(in) :: entry
    stress_condition = merge(CONDITION_PLANE_STRESS, CONDITION_NONE, entry%family == FAMILY_PLANE_STRESS)
  end function stress_condition


  !> Internal forces: sum of V B^T tau; with mean dilatation sum of V B^T (tau - p 1) + (sum of V p) mean.
  pure subroutine integrate_forces(is_mean_dilatation, geometry, B, tau, f)
    logical, intent(in) :: is_mean_dilatation
    type(plane_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: B(4, 2 * MAX_PLANE_NODES, MAX_PLANE_POINTS), tau(4, MAX_PLANE_POINTS)
    real(DP), intent(out) :: f(2 * MAX_PLANE_NODES)
    real(DP) :: t(4), pressure, total
    integer :: p
    f = 0
    total = 0
    do p = 1, geometry%m
      t = geometry%reference(p) * tau(:, p)
      if (is_mean_dilatation) then
        pressure = sum(t(:3)) / 3
        t(:3) = t(:3) - pressure
        total = total + pressure
      end if
      f(:2 * geometry%n_all) = f(:2 * geometry%n_all) + matmul(t, B(:, :2 * geometry%n_all, p))
    end do
    if (is_mean_dilatation) f(:2 * geometry%n) = f(:2 * geometry%n) + total * geometry%mean(:2 * geometry%n)
  end subroutine integrate_forces


  !> The tangent: sum of B^T c B and the geometric part. The terms of the mean dilatation are folded into c and tau but
  !! for three products of vectors, as for the solids (doc/theory/elements.md, "Mean dilatation: the tangent").
  pure subroutine integrate_stiffness(is_mean_dilatation, geometry, B, tau, c, stiffness)
    logical, intent(in) :: is_mean_dilatation
    type(plane_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: B(4, 2 * MAX_PLANE_NODES, MAX_PLANE_POINTS)
    real(DP), intent(inout) :: tau(4, MAX_PLANE_POINTS), c(4, 4, MAX_PLANE_POINTS)   !< spoiled
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< zero on entry up to 3 n
    real(DP) :: K(2 * MAX_PLANE_NODES, 2 * MAX_PLANE_NODES), r(2 * MAX_PLANE_NODES), factor
    integer :: p, i, j, row, column
    associate (n => 2 * geometry%n_all, mean => geometry%mean)
      K = 0
      if (is_mean_dilatation) then
        call fold_mean_dilatation(geometry, B, tau, c, r, factor)
        do j = 1, n
          K(:n, j) = (r(j) + factor * mean(j)) * mean(:n) + mean(j) * r(:n)
        end do
      else
        do p = 1, geometry%m
          c(:, :, p) = geometry%reference(p) * c(:, :, p)
          tau(:, p) = geometry%reference(p) * tau(:, p)
        end do
      end if
      do p = 1, geometry%m
        K(:n, :n) = K(:n, :n) + matmul(transpose(B(:, :n, p)), matmul(c(:, :, p), B(:, :n, p)))
        call add_geometric(geometry, p, tau(:, p), K)
      end do
      do j = 1, n
        do i = j, n                                 ! one half, and its mirror image: symmetric to the last bit
          row = i + (i - 1) / 2
          column = j + (j - 1) / 2
          stiffness(row, column) = K(i, j)
          stiffness(column, row) = K(i, j)
        end do
      end do
    end associate
  end subroutine integrate_stiffness


  !> (g_a . tau g_b) 1, and the hoop's part in the radial direction.
  pure subroutine add_geometric(geometry, p, tau, K)
    type(plane_geometry_type), intent(in) :: geometry
    integer, intent(in) :: p                       !< point
    real(DP), intent(in) :: tau(4)                 !< times the volume [force length]
    real(DP), intent(inout) :: K(2 * MAX_PLANE_NODES, 2 * MAX_PLANE_NODES)
    real(DP) :: t(2), term, h(2)
    integer :: a, b
    do b = 1, geometry%n_all
      associate (g => geometry%gradient(:, :, p), hoop => geometry%hoop(:, p))
        t = [tau(1) * g(b, 1) + tau(4) * g(b, 2), tau(4) * g(b, 1) + tau(2) * g(b, 2)]
        do a = b, geometry%n_all
          term = g(a, 1) * t(1) + g(a, 2) * t(2)
          K(2 * a, 2 * b) = K(2 * a, 2 * b) + term
          if (a > geometry%n) then                  ! the gradient of u_x of a mode differs from that of u_y
            h = g(b, :) + geometry%radial(b, :, p)
            h = [tau(1) * h(1) + tau(4) * h(2), tau(4) * h(1) + tau(2) * h(2)]
            term = dot_product(g(a, :) + geometry%radial(a, :, p), h)
          end if
          K(2 * a - 1, 2 * b - 1) = K(2 * a - 1, 2 * b - 1) + term + hoop(a) * tau(3) * hoop(b)
        end do
      end associate
    end do
  end subroutine add_geometric


  !> Adds the terms of the mean dilatation to tangent and stress (both times the volumes), and returns the remainder:
  !! r and k of  mean r^T + r mean^T + k mean mean^T.
  pure subroutine fold_mean_dilatation(geometry, B, tau, c, r, factor)
    type(plane_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: B(4, 2 * MAX_PLANE_NODES, MAX_PLANE_POINTS)
    real(DP), intent(inout) :: tau(4, MAX_PLANE_POINTS), c(4, 4, MAX_PLANE_POINTS)
    real(DP), intent(out) :: r(2 * MAX_PLANE_NODES), factor
    real(DP), parameter :: TWICE_SYMMETRIC(4) = [real(DP) :: 2, 2, 2, 1]
    real(DP) :: total, w, q(4), beta, omega, dilatation
    integer :: p, i
    associate (volumes => geometry%reference(:geometry%m))
      total = sum(volumes * (tau(1, :geometry%m) + tau(2, :geometry%m) + tau(3, :geometry%m))) / 3
    end associate
    factor = -total
    r = 0
    do p = 1, geometry%m
      w = geometry%reference(p)
      dilatation = total * geometry%current(p) / sum(geometry%current(:geometry%m))
      omega = w * sum(tau(:3, p)) / 3 - dilatation
      q = w * (c(:, 1, p) + c(:, 2, p) + c(:, 3, p) + 2 * tau(:, p)) / 3
      beta = sum(q(:3)) / 3
      factor = factor + beta
      c(:, :, p) = w * c(:, :, p)
      do i = 1, 3
        c(:, i, p) = c(:, i, p) - q
        c(i, :, p) = c(i, :, p) - q
        c(:3, i, p) = c(:3, i, p) + beta + dilatation
      end do
      do i = 1, 4
        c(i, i, p) = c(i, i, p) + omega * TWICE_SYMMETRIC(i)
      end do
      tau(:, p) = w * tau(:, p)
      tau(:3, p) = tau(:3, p) - omega
      q(:3) = q(:3) - beta
      r(:2 * geometry%n) = r(:2 * geometry%n) + matmul(q, B(:, :2 * geometry%n, p))
    end do
  end subroutine fold_mean_dilatation


  !> Force, energy and stiffness of the hourglass mode of a kind with one point. The energy is assigned to that point.
  pure subroutine add_hourglass_control(entry, material, X, u, is_nlgeom, geometry, force, points, stiffness)
    type(element_kind_type), intent(in) :: entry
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    type(plane_geometry_type), intent(in) :: geometry
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    real(DP), intent(inout), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    type(hourglass_type) :: hourglass
    real(DP) :: energy, c(6, 6)
    call evaluate_initial_tangent(stress_condition(entry), material, is_nlgeom, 4, points, c)
    call set_physical_hourglass(2, X, geometry%at_rest, geometry%reference(1), c, hourglass)
    if (material%law == LAW_SAINT_VENANT) then
      if (entry%family == FAMILY_AXISYMMETRIC) then
        call set_artificial_hourglass(hourglass, geometry%reference(1), geometry%modulus, N_CIRCLE_SECTORS / (2 * PI) &
          * geometry%reference_hoop, real(N_CIRCLE_SECTORS, DP))
      else
        call set_artificial_hourglass(hourglass, geometry%reference(1), geometry%modulus, geometry%N_a(:4, 1) &
          / points%section_value, 1.0_DP)
      end if
      call add_hourglass_forces(hourglass, u, .false., energy, force, stiffness)   ! |q|^2 is free of rotations
    else
      call load_hourglass_flow(material, points, hourglass)
      call add_hourglass_forces(hourglass, u, is_nlgeom, energy, force, stiffness)
      call store_hourglass_flow(stress_condition(entry), material, u, geometry%H(:, :, 1), is_nlgeom, geometry%weight(:4, 1), &
        hourglass, energy, points)
    end if
    points%energy(1) = points%energy(1) + energy / geometry%reference(1)
  end subroutine add_hourglass_control


  !> CPS4I, CPE4I, CAX4I: the amplitudes of the incompatible modes are solved for, so that their forces are zero, and eliminated, as
  !! those of C3D8I (`solid_elements`). The amplitude of the hoop strain is the first component of the third mode.
  pure subroutine evaluate_incompatible_modes(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    type(plane_geometry_type) :: reference
    real(DP) :: K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES), whole(3, 4 + N_MODES), F(3, 3), inverse(3, 3), det
    logical :: is_regular
    force = 0
    call set_reference(kind, element_kind(kind), X, points%section_value, reference, status)
    if (status /= ELEMENT_OK) return
    F = IDENTITY
    if (is_nlgeom) F = mean_deformation(reference, u)
    whole(:, :4) = u(:, :4)
    whole(:, 5:) = transported(F, reshape(points%modes_old, [3, N_MODES]))
    call solve_mode_amplitudes(material, reference, is_nlgeom, whole, force, points, status, K)
    if (status /= ELEMENT_OK .and. any(abs(points%modes_old) > 0)) then
      whole(:, 5:) = 0
      call solve_mode_amplitudes(material, reference, is_nlgeom, whole, force, points, status, K)
    end if
    if (status /= ELEMENT_OK) return
    call invert(F, inverse, det)
    points%modes = 0
    if (det > 0) points%modes(:3 * N_MODES) = reshape(transported(inverse, whole(:, 5:)), [3 * N_MODES])
    if (present(stiffness)) then
      stiffness = K
      call condense_mode_amplitudes(4, .not. allocated(points%skew), force, stiffness, is_regular)
    end if
    force(:, 5:) = 0
  end subroutine evaluate_incompatible_modes


  !> Amplitudes that follow a deformation F: vectors in the plane by its part there, that of the hoop strain by the hoop stretch.
  pure function transported(F, amplitudes) result(moved)
    real(DP), intent(in) :: F(3, 3), amplitudes(3, N_MODES)    !< [length]
    real(DP) :: moved(3, N_MODES)
    moved = 0
    moved(:2, :2) = matmul(F(:2, :2), amplitudes(:2, :2))
    moved(1, 3) = F(3, 3) * amplitudes(1, 3)
  end function transported


  !> The mean deformation gradient of an element by its nodes.
  pure function mean_deformation(reference, u) result(F)
    type(plane_geometry_type), intent(in) :: reference    !< of the reference configuration
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) [length]
    real(DP) :: F(3, 3)
    integer :: p, a, j
    F = 0
    do p = 1, reference%m
      do a = 1, reference%n
        do j = 1, 2
          F(:2, j) = F(:2, j) + reference%reference(p) * (u(:2, a) - u(:2, 1)) * reference%gradient(a, j, p)
        end do
        F(3, 3) = F(3, 3) + reference%reference(p) * u(1, a) * reference%hoop(a, p)
      end do
    end do
    F = IDENTITY + F / sum(reference%reference(:reference%m))
  end function mean_deformation


  !> Newton's method for the amplitudes. A correction that inverts the element is halved.
  pure subroutine solve_mode_amplitudes(material, reference, is_nlgeom, whole, force, points, status, stiffness)
    type(material_type), intent(in) :: material
    type(plane_geometry_type), intent(in) :: reference
    logical, intent(in) :: is_nlgeom
    real(DP), intent(inout) :: whole(3, 4 + N_MODES)    !< displacements, then amplitudes [length]
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status                 !< ELEMENT_...; ELEMENT_NOT_FINITE without convergence
    real(DP), intent(out) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< of nodes and modes, not condensed
    type(mode_iteration_type) :: iteration
    real(DP) :: mode_residual
    integer :: step
    logical :: is_done
    mode_residual = huge(1.0_DP)
    do step = 0, MAX_AMPLITUDE_CORRECTIONS
      call evaluate_modes(material, reference, whole, is_nlgeom, force, points, status, stiffness, mode_residual)
      call correct_mode_amplitudes(iteration, 4, status == ELEMENT_OK, force, stiffness, whole, mode_residual, is_done)
      if (is_done) exit
    end do
    if (status == ELEMENT_OK .and. .not. mode_residual <= TOL_MODE_FORCE_ACCEPTABLE) status = ELEMENT_NOT_FINITE
  end subroutine solve_mode_amplitudes


  !> Forces and tangent of the four nodes and of the amplitudes, as if these were three more nodes. Components that no strain
  !! belongs to have a stiffness of 1: they stay zero.
  pure subroutine evaluate_modes(material, reference, u, is_nlgeom, force, points, status, stiffness, mode_residual)
    type(material_type), intent(in) :: material
    type(plane_geometry_type), intent(in) :: reference
    real(DP), intent(in) :: u(3, 4 + N_MODES)      !< displacements, then amplitudes [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status
    real(DP), intent(out) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP), intent(out) :: mode_residual         !< of the modes, over the stresses times their gradients [-]
    type(plane_geometry_type) :: geometry
    real(DP) :: tau(4, MAX_PLANE_POINTS), c(4, 4, MAX_PLANE_POINTS), B(4, 2 * MAX_PLANE_NODES, MAX_PLANE_POINTS), &
      f(2 * MAX_PLANE_NODES), scale
    integer :: p, i
    geometry = reference
    force = 0
    points%is_tangent_wanted = .true.
    call update_kinematics(geometry%entry, u, is_nlgeom, geometry, B, status)
    if (status == ELEMENT_OK) call evaluate_stresses(geometry%entry, material, is_nlgeom, geometry, tau, c, points, status)
    if (status /= ELEMENT_OK) return
    call integrate_forces(.false., geometry, B, tau, f)
    force(:2, :geometry%n_all) = reshape(f(:2 * geometry%n_all), [2, geometry%n_all])
    scale = tiny(1.0_DP)
    do p = 1, geometry%m
      scale = scale + geometry%reference(p) * norm2(tau(:, p)) * norm2(B(:, 9:14, p))
    end do
    mode_residual = norm2(force(:2, 5:7)) / scale
    if (.not. is_nlgeom) tau = 0
    stiffness(:3 * geometry%n_all, :3 * geometry%n_all) = 0
    call integrate_stiffness(.false., geometry, B, tau, c, stiffness)
    if (allocated(points%skew)) call add_skew_part(geometry, B, points%skew, stiffness)
    do i = 3 * geometry%n + 1, 3 * geometry%n_all
      if (.not. abs(stiffness(i, i)) > 0) stiffness(i, i) = 1
    end do
  end subroutine evaluate_modes


  !> Adds the contribution of an unsymmetric law: the sum of V B' w B over the points.
  pure subroutine add_skew_part(geometry, B, w, stiffness)
    type(plane_geometry_type), intent(in) :: geometry
    real(DP), intent(in) :: B(4, 2 * MAX_PLANE_NODES, MAX_PLANE_POINTS)
    real(DP), intent(in) :: w(:, :, :)             !< (6, 6, >= points) (c - c')/2, engineering shears [stress]
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< [force/length]
    real(DP) :: K(2 * MAX_PLANE_NODES, 2 * MAX_PLANE_NODES)
    integer :: p, i, n, rows(2 * MAX_PLANE_NODES)
    n = 2 * geometry%n_all
    rows = [([3 * i - 2, 3 * i - 1], i=1, MAX_PLANE_NODES)]
    K = 0
    do p = 1, geometry%m
      K(:n, :n) = K(:n, :n) + geometry%reference(p) * matmul(transpose(B(:, :n, p)), matmul(w(PLANE_COMPONENTS, &
        PLANE_COMPONENTS, p), B(:, :n, p)))
    end do
    stiffness(rows(:n), rows(:n)) = stiffness(rows(:n), rows(:n)) + K(:n, :n)
  end subroutine add_skew_part


  !> The reference volumes of the points of an element.
  pure subroutine evaluate_plane_volumes(kind, X, section, n, volumes, status)
    integer, intent(in) :: kind                    !< KIND_CPS..., KIND_CPE..., KIND_CAX...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    real(DP), intent(in) :: section                !< thickness; of no meaning for axisymmetric kinds [length]
    integer, intent(out) :: n                      !< points
    real(DP), intent(out) :: volumes(:)            !< the first n are set [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    type(plane_geometry_type) :: geometry
    call set_reference(kind, element_kind(kind), X, section, geometry, status)
    n = geometry%m
    volumes(:n) = geometry%reference(:n)
    if (status == ELEMENT_OK .or. .not. is_one_point(kind)) return
    volumes(1) = sum(geometry%reference(:n))
    n = 1
  end subroutine evaluate_plane_volumes


  !> Consistent nodal forces of a body force in the plane.
  pure subroutine integrate_plane_body_force(kind, X, section, b, force)
    integer, intent(in) :: kind                    !< KIND_CPS..., KIND_CPE..., KIND_CAX...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: section                !< thickness; of no meaning for axisymmetric kinds [length]
    real(DP), intent(in) :: b(3)                   !< force per reference volume; the third is not used [force/length^3]
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< zero past the nodes [force]
    type(plane_geometry_type) :: geometry
    integer :: p, a, status
    force = 0
    call set_reference(kind, element_kind(kind), X, section, geometry, status)
    do p = 1, geometry%m
      do a = 1, geometry%n
        force(:2, a) = force(:2, a) + (geometry%N_a(a, p) * geometry%reference(p)) * b(:2)
      end do
    end do
  end subroutine integrate_plane_body_force


  !> Nodal forces of a pressure on an edge in its current place, and their derivative:
  !! force_a = -pressure * integral of N_a (dy/dxi, -dx/dxi) times the thickness or 2 pi x.
  !! Edges run counterclockwise: the normal is to their right. The thickness is that of the reference configuration.
  pure subroutine integrate_edge_pressure(edge, x, width, pressure, force, stiffness, rule)
    integer, intent(in) :: edge                    !< FACET_LINE2, FACET_LINE3
    real(DP), intent(in) :: x(:, :)                !< (3, nodes) current coordinates [length]
    real(DP), intent(in) :: width                  !< of the face [length], below zero: around the circle
    real(DP), intent(in) :: pressure               !< [stress]
    real(DP), intent(out) :: force(3, MAX_FACE_NODES)   !< zero past the nodes [force]
    real(DP), intent(out) :: stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)   !< d force/d x, zero past 3 * nodes
    integer, intent(in) :: rule                    !< the points: those of this kind of facet, or a rule of calculix_face_rule
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), &
      ddN(3, MAX_FACE_NODES), along(2), depth, growth, f
    integer :: n_rule, n_nodes, p, a, b
    n_nodes = size(x, 2)
    force = 0
    stiffness = 0
    call facet_quadrature(rule, n_rule, xi, w)
    do p = 1, n_rule
      call facet_shapes(edge, xi(:, p), N, dN, ddN)
      along = matmul(x(:2, :), dN(1, :n_nodes))
      depth = width
      growth = 0                                    ! of the depth with the radius
      if (width < 0) then
        depth = 2 * PI * dot_product(x(1, :), N(:n_nodes))
        growth = 2 * PI
      end if
      do a = 1, n_nodes
        f = -pressure * w(p) * N(a)
        force(:2, a) = force(:2, a) + f * depth * [along(2), -along(1)]
        do b = 1, n_nodes
          associate (block => stiffness(3 * a - 2:3 * a, 3 * b - 2:3 * b))
            block(1, 1) = block(1, 1) + f * growth * N(b) * along(2)
            block(2, 1) = block(2, 1) - f * (growth * N(b) * along(1) + depth * dN(1, b))
            block(1, 2) = block(1, 2) + f * depth * dN(1, b)
          end associate
        end do
      end do
    end do
  end subroutine integrate_edge_pressure

end module amontons_plane_elements
