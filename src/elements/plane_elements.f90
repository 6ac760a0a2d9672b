!> Plane: plane stress, plane strain and axisymmetric elements in two dimensions, and the pressure on their edges.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The law of the material works in space: here the strains of the plane are put into it, xx yy zz xy, with zz
!!
!!     plane strain    zero
!!     plane stress    such that the stress zz is zero                         (condition)
!!     axisymmetric    the hoop strain, u_x / X; x is the radius, y the axis
!!
!! so that every law serves every kind. With B of four rows the rest is that of the solids, mean dilatation of CPE4 and
!! CAX4 included. Integrals are over the thickness, or over the full circle (2 pi X): so are all forces.
!! Theory: doc/theory/elements.md, section "Plane and axisymmetric elements".
module amontons_plane_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP, PI
  use amontons_zero_stress_condition, only: stress_under, tangent_at_rest, CONDITION_NONE, CONDITION_PLANE_STRESS
  use amontons_hourglass, only: hourglass_type, prepare_hourglass, soften_hourglass, add_hourglass
  use amontons_material_point, only: point_type
  use amontons_materials, only: material_type, LAW_SAINT_VENANT
  use amontons_integration_points, only: points_type, begin_point, end_point, split_tangent, ELEMENT_OK, ELEMENT_INVERTED, &
    ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_shape_functions, only: shape_functions, quadrature, facet_shapes, facet_quadrature, MAX_FACET_POINTS
  use amontons_elasticity, only: STRESS_OK, STRESS_INVERTED, LARGEST_GRADIENT, logarithm_1p
  use amontons_tensor, only: IDENTITY, determinant_minus_one
  use amontons_topology, only: element_kind, kind_type, KIND_CPE4_FULL, KIND_CAX4R, KIND_CPS4R, KIND_CPE4R, &
    FAMILY_PLANE_STRESS, FAMILY_AXISYMMETRIC, FACET_TRI3, FACET_QUAD4, MAX_NODES, MAX_POINTS, MAX_FACE_NODES
  implicit none
  private
  public :: plane_element, plane_volumes, plane_body_force, plane_temperature_weights, edge_pressure

  integer, parameter :: N_MOST = 8                    !< most nodes
  real(DP), parameter :: SECTORS = 180                !< of CalculiX's expansion in the circle
  integer, parameter :: P_MOST = 9                    !< most points
  integer, parameter :: PLANE(4) = [1, 2, 3, 4]       !< xx yy zz xy among the six

  !> The geometry of one element.
  type :: strip_type
    integer :: n = 0                                  !< nodes
    integer :: m = 0                                  !< points
    real(DP) :: N_a(N_MOST, P_MOST)                   !< shape functions [-]
    real(DP) :: weight(N_MOST, P_MOST)                !< of the nodal temperatures [-]
    real(DP) :: gradient(N_MOST, 2, P_MOST)           !< dN_a/dX, later dN_a/dx [1/length]
    real(DP) :: hoop(N_MOST, P_MOST)                  !< N_a/X, later N_a/x; 0 but for axisymmetric kinds [1/length]
    real(DP) :: reference(P_MOST)                     !< reference volumes of the points [length^3]
    real(DP) :: current(P_MOST)                       !< current volumes [length^3]
    real(DP) :: H(3, 3, P_MOST)                       !< displacement gradient, or that of F-bar [-]
    real(DP) :: j(P_MOST)                             !< det(1 + H) - 1 [-]
    real(DP) :: mean(2 * N_MOST)                      !< mean of B^T 1 over the (current) volume [1/length]
    real(DP) :: at_rest(N_MOST, 2)                    !< dN_a/dX of the first point [1/length]
    real(DP) :: at_rest_hoop(4)                       !< N_a/X of the first point [1/length]
  end type strip_type

contains

  !> Internal force, point values and, if wanted, the tangent of an element.
  pure subroutine plane_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_CPS..., KIND_CPE..., KIND_CAX...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements; the third is not looked at [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_NODES)   !< [force]
    type(points_type), intent(inout) :: points     !< in: section, the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)   !< d force/d u [force/length]
    type(strip_type) :: strip
    type(kind_type) :: entry
    real(DP) :: tau(4, P_MOST), c(4, 4, P_MOST), B(4, 2 * N_MOST, P_MOST), f(2 * N_MOST)
    entry = element_kind(kind)
    force = 0
    call set_reference(kind, entry, X, points%section, strip, status)
    if (status == ELEMENT_OK) call move(entry, u, is_nlgeom, strip, B, status)
    if (status == ELEMENT_OK) call set_stresses(entry, material, is_nlgeom, strip, tau, c, points, status)
    if (status /= ELEMENT_OK) return
    call add_forces(entry%is_mean_dilatation, strip, B, tau, f)
    force(:2, :strip%n) = reshape(f(:2 * strip%n), [2, strip%n])
    if (present(stiffness)) then
      if (.not. is_nlgeom) tau = 0
      stiffness(:3 * strip%n, :3 * strip%n) = 0
      call set_stiffness(entry%is_mean_dilatation, strip, B, tau, c, stiffness)
    end if
    if (is_one_point(kind)) call hold_hourglass(entry, material, X, u, is_nlgeom, strip, force, points, stiffness)
  end subroutine plane_element


  !> The kinds of one point and four nodes.
  pure logical function is_one_point(kind)
    integer, intent(in) :: kind
    is_one_point = kind == KIND_CPS4R .or. kind == KIND_CPE4R .or. kind == KIND_CAX4R
  end function is_one_point


  !> Gradients, hoop terms and volumes in the reference configuration. A kind of one point takes their mean over the
  !! element, by the rule of four points.
  pure subroutine set_reference(kind, entry, X, section, strip, status)
    integer, intent(in) :: kind
    type(kind_type), intent(in) :: entry
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) [length]
    real(DP), intent(in) :: section                !< thickness [length]
    type(strip_type), intent(out) :: strip
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS), N(MAX_NODES), dN(3, MAX_NODES)
    real(DP) :: J(2, 2), det, radius
    integer :: rule, p, a
    status = ELEMENT_OK
    rule = kind
    if (is_one_point(kind)) rule = KIND_CPE4_FULL
    strip%n = entry%n_nodes
    strip%hoop = 0
    call quadrature(rule, strip%m, xi, w)
    do p = 1, strip%m
      call shape_functions(rule, xi(:, p), N, dN)
      J = 0
      do a = 2, strip%n
        J(:, 1) = J(:, 1) + (X(:2, a) - X(:2, 1)) * dN(1, a)
        J(:, 2) = J(:, 2) + (X(:2, a) - X(:2, 1)) * dN(2, a)
      end do
      det = J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)
      strip%N_a(:, p) = N(:N_MOST)
      strip%reference(p) = w(p) * det * section
      if (.not. abs(det) > 0) det = 1
      strip%gradient(:, 1, p) = (dN(1, :N_MOST) * J(2, 2) - dN(2, :N_MOST) * J(2, 1)) / det
      strip%gradient(:, 2, p) = (dN(2, :N_MOST) * J(1, 1) - dN(1, :N_MOST) * J(1, 2)) / det
      if (entry%family == FAMILY_AXISYMMETRIC) then
        radius = dot_product(N(:strip%n), X(1, :strip%n))
        strip%reference(p) = w(p) * det * 2 * PI * radius
        strip%hoop(:strip%n, p) = N(:strip%n) / merge(radius, 1.0_DP, abs(radius) > 0)
      end if
      if (.not. strip%reference(p) > 0) status = ELEMENT_DEGENERATE
    end do
    if (is_one_point(kind) .and. status == ELEMENT_OK) call take_mean(strip)
    call set_weights(entry, xi, strip)
    strip%at_rest = strip%gradient(:, :, 1)
    strip%at_rest_hoop = strip%hoop(:4, 1)
    strip%current = strip%reference
  end subroutine set_reference


  !> Weights of the nodal temperatures at the points of a plane or axisymmetric element.
  pure subroutine plane_temperature_weights(kind, weight)
    integer, intent(in) :: kind
    real(DP), intent(inout) :: weight(:, :)        !< (MAX_NODES, MAX_POINTS), zero [-]
    type(strip_type) :: strip
    type(kind_type) :: entry
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS)
    entry = element_kind(kind)
    strip%n = entry%n_nodes
    call quadrature(kind, strip%m, xi, w)
    call set_weights(entry, xi, strip)
    weight(:strip%n, :strip%m) = strip%weight(:strip%n, :strip%m)
  end subroutine plane_temperature_weights


  !> Weights of the nodal temperatures, one degree below the displacements: the mean in linear elements, linear from the
  !! corners in quadratic ones.
  pure subroutine set_weights(entry, xi, strip)
    type(kind_type), intent(in) :: entry
    real(DP), intent(in) :: xi(3, MAX_POINTS)      !< of the points
    type(strip_type), intent(inout) :: strip
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: p
    strip%weight = 0
    if (entry%n_nodes == entry%n_faces) then
      strip%weight(:strip%n, :) = 1 / real(strip%n, DP)
      return
    end if
    do p = 1, strip%m
      call facet_shapes(merge(FACET_TRI3, FACET_QUAD4, entry%n_faces == 3), xi(:2, p), N, dN, ddN)
      strip%weight(:entry%n_faces, p) = N(:entry%n_faces)
    end do
  end subroutine set_weights


  !> Puts the mean over all points into the first and only one.
  pure subroutine take_mean(strip)
    type(strip_type), intent(inout) :: strip
    real(DP) :: volume
    integer :: i
    associate (m => strip%m, weight => strip%reference(:strip%m))
      volume = sum(weight)
      do i = 1, 2
        strip%gradient(:, i, 1) = matmul(strip%gradient(:, i, :m), weight) / volume
      end do
      strip%hoop(:, 1) = matmul(strip%hoop(:, :m), weight) / volume
      strip%N_a(:, 1) = matmul(strip%N_a(:, :m), weight) / volume
    end associate
    strip%m = 1
    strip%reference(1) = volume
  end subroutine take_mean


  !> Displacement gradients; under NLGEOM current gradients and volumes; B; with mean dilatation its mean and F-bar.
  pure subroutine move(entry, u, is_nlgeom, strip, B, status)
    type(kind_type), intent(in) :: entry
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) [length]
    logical, intent(in) :: is_nlgeom
    type(strip_type), intent(inout) :: strip
    real(DP), intent(out) :: B(4, 2 * N_MOST, P_MOST)
    integer, intent(out) :: status                 !< ELEMENT_...
    integer :: p, a
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u(:2, :strip%n)))) return
    status = ELEMENT_OK
    do p = 1, strip%m
      strip%H(:, :, p) = 0
      do a = 1, strip%n
        strip%H(:2, 1, p) = strip%H(:2, 1, p) + (u(:2, a) - u(:2, 1)) * strip%gradient(a, 1, p)
        strip%H(:2, 2, p) = strip%H(:2, 2, p) + (u(:2, a) - u(:2, 1)) * strip%gradient(a, 2, p)
        strip%H(3, 3, p) = strip%H(3, 3, p) + u(1, a) * strip%hoop(a, p)
      end do
      if (is_nlgeom) call push_forward(strip, p, status)
      if (status /= ELEMENT_OK) return
      do a = 1, strip%n
        B(:, 2 * a - 1, p) = [strip%gradient(a, 1, p), 0.0_DP, strip%hoop(a, p), strip%gradient(a, 2, p)]
        B(:, 2 * a, p) = [0.0_DP, strip%gradient(a, 2, p), 0.0_DP, strip%gradient(a, 1, p)]
      end do
    end do
    if (.not. entry%is_mean_dilatation) return
    strip%mean = 0
    do p = 1, strip%m
      strip%mean = strip%mean + strip%current(p) * (B(1, :, p) + B(2, :, p) + B(3, :, p))
    end do
    strip%mean = strip%mean / sum(strip%current(:strip%m))
    call set_mean_dilatation(is_nlgeom, strip)
  end subroutine move


  !> Turns the gradients and the volume of a point into current ones.
  pure subroutine push_forward(strip, p, status)
    type(strip_type), intent(inout) :: strip
    integer, intent(in) :: p                       !< point
    integer, intent(out) :: status                 !< ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE
    real(DP) :: F(2, 2), det, x(N_MOST)
    status = ELEMENT_NOT_FINITE
    if (.not. all(abs(strip%H(:, :, p)) <= LARGEST_GRADIENT)) return
    status = ELEMENT_INVERTED
    strip%j(p) = determinant_minus_one(strip%H(:, :, p))
    F = IDENTITY(:2, :2) + strip%H(:2, :2, p)
    det = F(1, 1) * F(2, 2) - F(1, 2) * F(2, 1)
    if (.not. (strip%j(p) > -1 .and. det > 0)) return
    status = ELEMENT_OK
    strip%current(p) = (1 + strip%j(p)) * strip%reference(p)
    x = (strip%gradient(:, 1, p) * F(2, 2) - strip%gradient(:, 2, p) * F(2, 1)) / det
    strip%gradient(:, 2, p) = (strip%gradient(:, 2, p) * F(1, 1) - strip%gradient(:, 1, p) * F(1, 2)) / det
    strip%gradient(:, 1, p) = x
    strip%hoop(:, p) = strip%hoop(:, p) / (1 + strip%H(3, 3, p))
  end subroutine push_forward


  !> Replaces the change of volume of each point by that of the element: B-bar, or F-bar with r^3 = Jbar/J.
  pure subroutine set_mean_dilatation(is_nlgeom, strip)
    logical, intent(in) :: is_nlgeom
    type(strip_type), intent(inout) :: strip       !< H and j change
    real(DP) :: change(P_MOST), mean, cube, r
    integer :: p
    do p = 1, strip%m
      change(p) = strip%H(1, 1, p) + strip%H(2, 2, p) + strip%H(3, 3, p)
      if (is_nlgeom) change(p) = strip%j(p)
    end do
    associate (weight => strip%reference(:strip%m))
      mean = sum(change(:strip%m) * weight) / sum(weight)
    end associate
    do p = 1, strip%m
      if (is_nlgeom) then
        cube = (mean - strip%j(p)) / (1 + strip%j(p))
        r = exp(logarithm_1p(cube) / 3)
        strip%H(:, :, p) = strip%H(:, :, p) + (cube / (1 + r + r * r)) * (IDENTITY + strip%H(:, :, p))
        strip%j(p) = mean
      else
        strip%H(:, :, p) = strip%H(:, :, p) + ((mean - change(p)) / 3) * IDENTITY
      end if
    end do
  end subroutine set_mean_dilatation


  !> Stress, tangent and point values at all points.
  pure subroutine set_stresses(entry, material, is_nlgeom, strip, tau, c, points, status)
    type(kind_type), intent(in) :: entry
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(strip_type), intent(in) :: strip
    real(DP), intent(out) :: tau(4, P_MOST), c(4, 4, P_MOST)
    type(points_type), intent(inout) :: points
    integer, intent(out) :: status                 !< ELEMENT_...
    type(point_type) :: point
    integer :: p
    status = ELEMENT_OK
    do p = 1, strip%m
      call begin_point(material, points, p, strip%weight(:strip%n, p), point)
      point%H = strip%H(:, :, p)
      call stress_under(condition_of(entry), material, is_nlgeom, point, status)
      if (status /= STRESS_OK) exit
      call split_tangent(material, point, points, p)
      tau(:, p) = point%stress(PLANE)
      c(:, :, p) = point%tangent(PLANE, PLANE)
      call end_point(material, is_nlgeom, point, points, p)
      points%volume(p) = strip%reference(p)
    end do
    if (status /= STRESS_OK) status = merge(ELEMENT_INVERTED, ELEMENT_NOT_FINITE, status == STRESS_INVERTED)
  end subroutine set_stresses


  !> Plane stress leaves the normal strain across free.
  pure integer function condition_of(entry)
    type(kind_type), intent(in) :: entry
    condition_of = merge(CONDITION_PLANE_STRESS, CONDITION_NONE, entry%family == FAMILY_PLANE_STRESS)
  end function condition_of


  !> Internal forces: sum of V B^T tau; with mean dilatation sum of V B^T (tau - p 1) + (sum of V p) mean.
  pure subroutine add_forces(is_mean_dilatation, strip, B, tau, f)
    logical, intent(in) :: is_mean_dilatation
    type(strip_type), intent(in) :: strip
    real(DP), intent(in) :: B(4, 2 * N_MOST, P_MOST), tau(4, P_MOST)
    real(DP), intent(out) :: f(2 * N_MOST)
    real(DP) :: t(4), pressure, total
    integer :: p
    f = 0
    total = 0
    do p = 1, strip%m
      t = strip%reference(p) * tau(:, p)
      if (is_mean_dilatation) then
        pressure = sum(t(:3)) / 3
        t(:3) = t(:3) - pressure
        total = total + pressure
      end if
      f(:2 * strip%n) = f(:2 * strip%n) + matmul(t, B(:, :2 * strip%n, p))
    end do
    if (is_mean_dilatation) f(:2 * strip%n) = f(:2 * strip%n) + total * strip%mean(:2 * strip%n)
  end subroutine add_forces


  !> The tangent: sum of B^T c B and the geometric part. The terms of the mean dilatation are folded into c and tau but
  !! for three products of vectors, as for the solids (doc/theory/elements.md, "Mean dilatation: the tangent").
  pure subroutine set_stiffness(is_mean_dilatation, strip, B, tau, c, stiffness)
    logical, intent(in) :: is_mean_dilatation
    type(strip_type), intent(in) :: strip
    real(DP), intent(in) :: B(4, 2 * N_MOST, P_MOST)
    real(DP), intent(inout) :: tau(4, P_MOST), c(4, 4, P_MOST)   !< spoiled
    real(DP), intent(inout) :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)   !< zero on entry up to 3 n
    real(DP) :: K(2 * N_MOST, 2 * N_MOST), r(2 * N_MOST), factor
    integer :: p, i, j, row, column
    associate (n => 2 * strip%n, mean => strip%mean)
      K = 0
      if (is_mean_dilatation) then
        call fold_mean_dilatation(strip, B, tau, c, r, factor)
        do j = 1, n
          K(:n, j) = (r(j) + factor * mean(j)) * mean(:n) + mean(j) * r(:n)
        end do
      else
        do p = 1, strip%m
          c(:, :, p) = strip%reference(p) * c(:, :, p)
          tau(:, p) = strip%reference(p) * tau(:, p)
        end do
      end if
      do p = 1, strip%m
        K(:n, :n) = K(:n, :n) + matmul(transpose(B(:, :n, p)), matmul(c(:, :, p), B(:, :n, p)))
        call add_geometric(strip, p, tau(:, p), K)
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
  end subroutine set_stiffness


  !> (g_a . tau g_b) 1, and the hoop's part in the radial direction.
  pure subroutine add_geometric(strip, p, tau, K)
    type(strip_type), intent(in) :: strip
    integer, intent(in) :: p                       !< point
    real(DP), intent(in) :: tau(4)                 !< times the volume [force length]
    real(DP), intent(inout) :: K(2 * N_MOST, 2 * N_MOST)
    real(DP) :: t(2), term
    integer :: a, b
    do b = 1, strip%n
      associate (g => strip%gradient(:, :, p), hoop => strip%hoop(:, p))
        t = [tau(1) * g(b, 1) + tau(4) * g(b, 2), tau(4) * g(b, 1) + tau(2) * g(b, 2)]
        do a = b, strip%n
          term = g(a, 1) * t(1) + g(a, 2) * t(2)
          K(2 * a - 1, 2 * b - 1) = K(2 * a - 1, 2 * b - 1) + term + hoop(a) * tau(3) * hoop(b)
          K(2 * a, 2 * b) = K(2 * a, 2 * b) + term
        end do
      end associate
    end do
  end subroutine add_geometric


  !> Folds the terms of the mean dilatation into tangent and stress (both times the volumes), and gives what is left:
  !! r and k of  mean r^T + r mean^T + k mean mean^T.
  pure subroutine fold_mean_dilatation(strip, B, tau, c, r, factor)
    type(strip_type), intent(in) :: strip
    real(DP), intent(in) :: B(4, 2 * N_MOST, P_MOST)
    real(DP), intent(inout) :: tau(4, P_MOST), c(4, 4, P_MOST)
    real(DP), intent(out) :: r(2 * N_MOST), factor
    real(DP), parameter :: TWICE_SYMMETRIC(4) = [real(DP) :: 2, 2, 2, 1]
    real(DP) :: total, w, q(4), beta, omega, dilatation
    integer :: p, i
    associate (volumes => strip%reference(:strip%m))
      total = sum(volumes * (tau(1, :strip%m) + tau(2, :strip%m) + tau(3, :strip%m))) / 3
    end associate
    factor = -total
    r = 0
    do p = 1, strip%m
      w = strip%reference(p)
      dilatation = total * strip%current(p) / sum(strip%current(:strip%m))
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
      r(:2 * strip%n) = r(:2 * strip%n) + matmul(q, B(:, :2 * strip%n, p))
    end do
  end subroutine fold_mean_dilatation


  !> Force, energy and stiffness of the hourglass mode of a kind with one point. The energy goes to that point.
  pure subroutine hold_hourglass(entry, material, X, u, is_nlgeom, strip, force, points, stiffness)
    type(kind_type), intent(in) :: entry
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    type(strip_type), intent(in) :: strip
    real(DP), intent(inout) :: force(3, MAX_NODES)
    type(points_type), intent(inout) :: points
    real(DP), intent(inout), optional :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)
    type(hourglass_type) :: hourglass
    real(DP) :: energy, c(6, 6)
    call tangent_at_rest(condition_of(entry), material, is_nlgeom, 4, points, c)
    call prepare_hourglass(2, X, strip%at_rest, strip%reference(1), c, hourglass)
    if (material%law == LAW_SAINT_VENANT) then
      call tangent_at_rest(CONDITION_NONE, material, is_nlgeom, 4, points, c)
      if (entry%family == FAMILY_AXISYMMETRIC) then
        call soften_hourglass(hourglass, strip%reference(1), c, SECTORS / (2 * PI) * strip%at_rest_hoop, SECTORS)
      else
        call soften_hourglass(hourglass, strip%reference(1), c, strip%N_a(:4, 1) / points%section, 1.0_DP)
      end if
      call add_hourglass(hourglass, u, .false., energy, force, stiffness)   ! |q|^2 is free of rotations
    else
      call add_hourglass(hourglass, u, is_nlgeom, energy, force, stiffness)
    end if
    points%energy(1) = points%energy(1) + energy / strip%reference(1)
  end subroutine hold_hourglass


  !> The reference volumes of the points of an element.
  pure subroutine plane_volumes(kind, X, section, n, volumes, status)
    integer, intent(in) :: kind                    !< KIND_CPS..., KIND_CPE..., KIND_CAX...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    real(DP), intent(in) :: section                !< thickness; of no meaning for axisymmetric kinds [length]
    integer, intent(out) :: n                      !< points
    real(DP), intent(out) :: volumes(:)            !< the first n are set [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    type(strip_type) :: strip
    call set_reference(kind, element_kind(kind), X, section, strip, status)
    n = strip%m
    volumes(:n) = strip%reference(:n)
    if (status == ELEMENT_OK .or. .not. is_one_point(kind)) return
    volumes(1) = sum(strip%reference(:n))
    n = 1
  end subroutine plane_volumes


  !> Consistent nodal forces of a body force in the plane.
  pure subroutine plane_body_force(kind, X, section, b, force)
    integer, intent(in) :: kind                    !< KIND_CPS..., KIND_CPE..., KIND_CAX...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: section                !< thickness; of no meaning for axisymmetric kinds [length]
    real(DP), intent(in) :: b(3)                   !< force per reference volume; the third is not used [force/length^3]
    real(DP), intent(out) :: force(3, MAX_NODES)   !< zero past the nodes [force]
    type(strip_type) :: strip
    integer :: p, a, status
    force = 0
    call set_reference(kind, element_kind(kind), X, section, strip, status)
    do p = 1, strip%m
      do a = 1, strip%n
        force(:2, a) = force(:2, a) + (strip%N_a(a, p) * strip%reference(p)) * b(:2)
      end do
    end do
  end subroutine plane_body_force


  !> Nodal forces of a pressure on an edge in its current place, and their derivative:
  !! force_a = -pressure * integral of N_a (dy/dxi, -dx/dxi) times the thickness or 2 pi x.
  !! Edges run counterclockwise: the normal is to their right. The thickness is that of the reference configuration.
  pure subroutine edge_pressure(family, edge, x, section, pressure, force, stiffness, rule)
    integer, intent(in) :: family                  !< FAMILY_...
    integer, intent(in) :: edge                    !< FACET_LINE2, FACET_LINE3
    real(DP), intent(in) :: x(:, :)                !< (3, nodes) current coordinates [length]
    real(DP), intent(in) :: section                !< thickness; of no meaning for axisymmetric kinds [length]
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
      depth = section
      growth = 0                                    ! of the depth with the radius
      if (family == FAMILY_AXISYMMETRIC) then
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
  end subroutine edge_pressure

end module amontons_plane_elements
