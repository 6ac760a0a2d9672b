!> Solid: elements in space: plain, B-bar or F-bar, with incompatible modes, with one point.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory and symbols: doc/theory/elements.md. Force and tangent are the first and second derivative of the element's
!! strain energy, so the tangent is symmetric, at finite strain and with mean dilatation too. Inside, arrays run over
!! the nodes first: that is the loop the compiler turns into vector instructions.
module amontons_solid_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_zero_stress_condition, only: tangent_at_rest, CONDITION_NONE
  use amontons_incompatible_modes, only: modes_type, incompatible_gradients, improve_modes, condense_modes, add_skew, N_MODES
  use amontons_hourglass, only: hourglass_type, prepare_hourglass, soften_hourglass, add_hourglass
  use amontons_materials, only: material_type, LAW_SAINT_VENANT
  use amontons_material_point, only: point_type, update_point
  use amontons_integration_points, only: points_type, begin_point, keep_history, split_tangent, ELEMENT_OK, &
    ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_logarithmic_strain, only: logarithm_1p
  use amontons_shape_functions, only: shape_functions, quadrature
  use amontons_elasticity, only: stress_small, stress_finite, kirchhoff_stress, STRESS_OK, STRESS_INVERTED, &
    LARGEST_GRADIENT
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, VOIGT_INDEX, determinant_minus_one, invert, pack_voigt
  use amontons_topology, only: MAX_NODES, MAX_POINTS, KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, &
    KIND_C3D8R, KIND_C3D10, KIND_C3D20, N_SOLID_KINDS
  implicit none
  private
  public :: solid_element, solid_volumes, solid_body_force, solid_temperature_weights

  ! The table of module topology once more, as constants: so the loops have known lengths. The unit test notices if
  ! they differ.
  integer, parameter :: N_NODES(N_SOLID_KINDS) = [4, 6, 8, 8, 10, 20, 20, 8, 8, 15]
  integer, parameter :: N_POINTS(N_SOLID_KINDS) = [1, 2, 8, 8, 4, 27, 8, 8, 1, 9]
  integer, parameter :: MOST_CORRECTIONS = 60      !< of the amplitudes of the incompatible modes
  real(DP), parameter :: EXACT = 1.0e-14_DP        !< their force of the stresses: converged [-]
  real(DP), parameter :: ACCEPTABLE = 1.0e-9_DP    !< where the corrections end [-]
  logical, parameter :: IS_MEAN(N_SOLID_KINDS) = [.false., .false., .true., .false., .false., .false., .false., .false., &
    .false., .false.]

  !> How an element has moved: what its forces and its tangent need.
  type :: motion_type
    real(DP) :: gradient(MAX_NODES, 3, MAX_POINTS) !< dN_a/dx_j, current under NLGEOM [1/length]
    real(DP) :: mean(MAX_NODES, 3)                 !< their mean over the (current) volume [1/length]
    real(DP) :: H(3, 3, MAX_POINTS)                !< displacement gradient du_i/dX_j, or that of F-bar [-]
    real(DP) :: j(MAX_POINTS)                      !< det(1 + H) - 1 [-]
    real(DP) :: reference(MAX_POINTS)              !< reference volumes of the points [length^3]
    real(DP) :: current(MAX_POINTS)                !< their current volumes [length^3]
  end type motion_type

contains

  !> Internal force, point values and, if wanted, the tangent of an element in space.
  pure subroutine solid_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_C3D...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_NODES)   !< [force]
    type(points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)   !< d force/d u [force/length]
    select case (kind)                             ! constants here make loops of known length there
    case (KIND_C3D4)
      call evaluate(KIND_C3D4, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D6)
      call evaluate(KIND_C3D6, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D8)
      call evaluate(KIND_C3D8, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D8_FULL)
      call evaluate(KIND_C3D8_FULL, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D10)
      call evaluate(KIND_C3D10, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D8I)
      call evaluate_enhanced(material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D8R)
      call evaluate_one_point(material, X, u, is_nlgeom, force, points, status, stiffness)
    case default
      call evaluate(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    end select
  end subroutine solid_element


  !> The volume that each integration point stands for.
  pure subroutine solid_volumes(kind, X, n, volumes, status)
    integer, intent(in) :: kind                    !< KIND_C3D...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    integer, intent(out) :: n                      !< integration points
    real(DP), intent(inout) :: volumes(:)          !< (MAX_POINTS) the first n are set [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    type(motion_type) :: motion
    call set_reference(full_rule(kind), X, motion, status)
    n = N_POINTS(kind)
    volumes(:n) = motion%reference(:n)
    if (kind == KIND_C3D8R) volumes(1) = sum(motion%reference(:8))
  end subroutine solid_volumes


  !> The kind whose points see the whole of an element: C3D8R has the mean of eight.
  pure integer function full_rule(kind)
    integer, intent(in) :: kind                    !< a solid in space
    full_rule = merge(KIND_C3D8_FULL, kind, kind == KIND_C3D8R)
  end function full_rule


  !> Consistent nodal forces of a body force: force_a = sum over points of N_a b w.
  pure subroutine solid_body_force(kind, X, b, force)
    integer, intent(in) :: kind                    !< KIND_C3D...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: b(3)                   !< [force/length^3]
    real(DP), intent(inout) :: force(3, MAX_NODES)   !< in: zero [force]
    type(motion_type) :: motion
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS), N(MAX_NODES), dN(3, MAX_NODES)
    integer :: rule, n_rule, p, a, status
    rule = full_rule(kind)
    call set_reference(rule, X, motion, status)
    call quadrature(rule, n_rule, xi, w)
    do p = 1, n_rule
      call shape_functions(rule, xi(:, p), N, dN)
      do a = 1, N_NODES(rule)
        force(:, a) = force(:, a) + (N(a) * motion%reference(p)) * b
      end do
    end do
  end subroutine solid_body_force


  !> Weights of the nodal temperatures at the points, such that thermal strains match the strains of the element:
  !!
  !! | element | temperature |
  !! |---|---|
  !! | linear | the mean |
  !! | C3D10 | linear from the corners |
  !! | C3D15, C3D20R | quadratic: at these few points it is as good as linear |
  !! | C3D20 | trilinear through the eight points of the C3D20R |
  pure subroutine solid_temperature_weights(kind, weight)
    integer, intent(in) :: kind                    !< KIND_C3D...
    real(DP), intent(out) :: weight(MAX_NODES, MAX_POINTS)   !< [-]
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS), N(MAX_NODES), dN(3, MAX_NODES), at_corner(MAX_NODES, 8), L(MAX_NODES)
    real(DP), parameter :: CORNER(3, 8) = reshape([real(DP) :: -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, &
      -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
    integer :: n_rule, p, k
    weight = 0
    if (N_NODES(kind) < 10) then
      weight(:N_NODES(kind), :) = 1.0_DP / real(N_NODES(kind), DP)
      return
    end if
    call quadrature(kind, n_rule, xi, w)
    if (kind == KIND_C3D20) then
      do k = 1, 8
        call shape_functions(kind, CORNER(:, k) / sqrt(3.0_DP), at_corner(:, k), dN)
      end do
    end if
    do p = 1, n_rule
      select case (kind)
      case (KIND_C3D10)
        call shape_functions(KIND_C3D4, xi(:, p), N, dN)
        weight(:4, p) = N(:4)
      case (KIND_C3D20)
        call shape_functions(KIND_C3D8, sqrt(3.0_DP) * xi(:, p), L, dN)
        weight(:20, p) = matmul(at_corner(:20, :), L(:8))
      case default
        call shape_functions(kind, xi(:, p), N, dN)
        weight(:N_NODES(kind), p) = N(:N_NODES(kind))
      end select
    end do
  end subroutine solid_temperature_weights


  !> Forces, point values and, if wanted, the tangent of an element of a kind known to the compiler.
  pure subroutine evaluate(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_NODES)
    type(points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status
    real(DP), intent(out), optional :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)
    type(motion_type) :: motion
    real(DP) :: tau(6, MAX_POINTS), tangent(6, 6, MAX_POINTS)
    force = 0
    call set_reference(kind, X, motion, status)
    if (status == ELEMENT_OK) call move(kind, u, is_nlgeom, motion, status)
    if (status /= ELEMENT_OK) return
    call respond(kind, material, is_nlgeom, present(stiffness), motion, tau, tangent, points, status)
    if (status /= ELEMENT_OK) return
    call add_forces(N_NODES(kind), N_POINTS(kind), IS_MEAN(kind), motion, tau, force)
    if (.not. present(stiffness)) return
    if (.not. is_nlgeom) tau = 0
    call set_stiffness(N_NODES(kind), N_POINTS(kind), IS_MEAN(kind), motion, tau, tangent, stiffness)
  end subroutine evaluate


  !> C3D8I: the amplitudes of the incompatible modes are found anew each time, so that their forces are zero; then they
  !! leave force and tangent by condensation. So force and tangent are derivatives of the least energy, and nothing is
  !! to be remembered. Cost: one correction where stress and strain are proportional, else two to five, more where plastic
  !! flow turns.
  pure subroutine evaluate_enhanced(material, X, u, is_nlgeom, force, points, status, stiffness)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_NODES)
    type(points_type), intent(inout) :: points
    integer, intent(out) :: status
    real(DP), intent(out), optional :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)
    type(motion_type) :: at_rest
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS), K(3 * MAX_NODES, 3 * MAX_NODES), whole(3, 8 + N_MODES), &
      imbalance
    type(modes_type) :: search
    integer :: n_rule, step
    logical :: is_exact, is_regular
    call set_reference(KIND_C3D8I, X, at_rest, status)
    if (status /= ELEMENT_OK) return
    call quadrature(KIND_C3D8I, n_rule, xi, w)
    call incompatible_gradients(X, xi(:, :8), at_rest%reference(:8), at_rest%gradient(9:8 + N_MODES, :, :8))
    whole(:, :8) = u(:, :8)
    whole(:, 9:) = 0                                 ! the amplitudes
    do step = 0, MOST_CORRECTIONS
      call evaluate_modes(material, at_rest, whole, is_nlgeom, force, points, status, K, imbalance)
      if (status /= ELEMENT_OK) return
      if (imbalance <= EXACT) exit
      call improve_modes(search, 8, force, K, whole, is_exact, is_regular)
      if (is_exact) imbalance = 0
      if (is_exact .or. .not. is_regular) exit
    end do
    if (.not. imbalance <= ACCEPTABLE) status = ELEMENT_NOT_FINITE
    if (present(stiffness)) then
      stiffness = K
      call condense_modes(8, .not. allocated(points%skew), force, stiffness, is_regular)
    end if
    force(:, 9:) = 0
  end subroutine evaluate_enhanced


  !> Forces and tangent of the eight nodes and of the amplitudes, as if these were three more nodes.
  pure subroutine evaluate_modes(material, at_rest, u, is_nlgeom, force, points, status, stiffness, imbalance)
    type(material_type), intent(in) :: material
    type(motion_type), intent(in) :: at_rest       !< gradients of nodes and modes
    real(DP), intent(in) :: u(3, 8 + N_MODES)      !< displacements, then amplitudes [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_NODES)
    type(points_type), intent(inout) :: points
    integer, intent(out) :: status
    real(DP), intent(out) :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)
    real(DP), intent(out) :: imbalance             !< of the modes, over the stresses times their gradients [-]
    type(motion_type) :: motion
    real(DP) :: tau(6, MAX_POINTS), tangent(6, 6, MAX_POINTS), scale
    integer :: p, m, j
    integer, parameter :: N = 8 + N_MODES
    force = 0
    motion = at_rest
    call move(KIND_C3D8I, u, .false., motion, status)
    if (status /= ELEMENT_OK) return
    do p = 1, 8
      do m = 1, N_MODES
        do j = 1, 3
          motion%H(:, j, p) = motion%H(:, j, p) + u(:, 8 + m) * motion%gradient(8 + m, j, p)
        end do
      end do
    end do
    if (is_nlgeom) call push_forward(N, 8, motion, status)
    if (status == ELEMENT_OK) call respond(KIND_C3D8I, material, is_nlgeom, .true., motion, tau, tangent, points, status)
    if (status /= ELEMENT_OK) return
    call add_forces(N, 8, .false., motion, tau, force)
    scale = tiny(1.0_DP)
    do p = 1, 8
      scale = scale + motion%reference(p) * norm2(tau(:, p)) * norm2(motion%gradient(9:N, :, p))
    end do
    imbalance = norm2(force(:, 9:N)) / scale
    if (.not. is_nlgeom) tau = 0
    call set_stiffness(N, 8, .false., motion, tau, tangent, stiffness)
    if (allocated(points%skew)) call add_skew(N, motion%gradient(:, :, :8), motion%reference(:8), points%skew, stiffness)
  end subroutine evaluate_modes


  !> C3D8R: the mean of the gradients stands for all points; the hourglass modes have an energy of their own, which is
  !! written with that of the point.
  pure subroutine evaluate_one_point(material, X, u, is_nlgeom, force, points, status, stiffness)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_NODES)
    type(points_type), intent(inout) :: points
    integer, intent(out) :: status
    real(DP), intent(out), optional :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)
    type(motion_type) :: motion
    type(hourglass_type) :: hourglass
    real(DP) :: mean(MAX_NODES, 3), volume, tau(6, MAX_POINTS), tangent(6, 6, MAX_POINTS), c(6, 6), energy
    integer :: p
    force = 0
    call set_reference(KIND_C3D8_FULL, X, motion, status)
    if (status /= ELEMENT_OK) return
    volume = sum(motion%reference(:8))
    mean = 0
    do p = 1, 8
      mean(:8, :) = mean(:8, :) + (motion%reference(p) / volume) * motion%gradient(:8, :, p)
    end do
    motion%gradient(:8, :, 1) = mean(:8, :)
    motion%reference(1) = volume
    motion%current(1) = volume
    call move(KIND_C3D8R, u, is_nlgeom, motion, status)
    if (status == ELEMENT_OK) call respond(KIND_C3D8R, material, is_nlgeom, present(stiffness), motion, tau, tangent, &
      points, status)
    if (status /= ELEMENT_OK) return
    call add_forces(8, 1, .false., motion, tau, force)
    if (present(stiffness)) then
      if (.not. is_nlgeom) tau = 0
      call set_stiffness(8, 1, .false., motion, tau, tangent, stiffness)
    end if
    call tangent_at_rest(CONDITION_NONE, material, is_nlgeom, 8, points, c)
    call prepare_hourglass(3, X, mean(:8, :), volume, c, hourglass)
    if (material%law == LAW_SAINT_VENANT) then
      call soften_hourglass(hourglass, volume, c, [real(DP) ::], 1.0_DP)
      call add_hourglass(hourglass, u, .false., energy, force, stiffness)   ! |q|^2 is free of rotations
    else
      call add_hourglass(hourglass, u, is_nlgeom, energy, force, stiffness)
    end if
    points%energy(1) = points%energy(1) + energy / volume
  end subroutine evaluate_one_point


  !> Stress, tangent and point values at all points, by the law of the material.
  pure subroutine respond(kind, material, is_nlgeom, is_tangent, motion, tau, tangent, points, status)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom, is_tangent
    type(motion_type), intent(in) :: motion
    real(DP), intent(out) :: tau(6, MAX_POINTS), tangent(6, 6, MAX_POINTS)
    type(points_type), intent(inout) :: points
    integer, intent(out) :: status
    if (material%is_plain) then
      call set_stresses(kind, material, is_nlgeom, is_tangent, motion, tau, tangent, points, status)
    else
      call update_points(kind, material, is_nlgeom, motion, tau, tangent, points, status)
    end if
  end subroutine respond


  !> Derivatives of the shape functions by the coordinates given, and the volumes of the points.
  pure subroutine set_reference(kind, X, motion, status)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) [length]
    type(motion_type), intent(out) :: motion       !< gradient, reference, current are set
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS), N(MAX_NODES), dN(3, MAX_NODES)
    real(DP) :: jacobian(3, 3), inverse(3, 3), det
    integer :: n_rule, p, a, j
    status = ELEMENT_OK
    call quadrature(kind, n_rule, xi, w)
    do p = 1, N_POINTS(kind)
      call shape_functions(kind, xi(:, p), N, dN)
      jacobian = 0
      do a = 2, N_NODES(kind)
        do j = 1, 3
          jacobian(:, j) = jacobian(:, j) + (X(:, a) - X(:, 1)) * dN(j, a)
        end do
      end do
      call invert(jacobian, inverse, det)
      if (.not. det > 0) status = ELEMENT_DEGENERATE
      motion%reference(p) = w(p) * det
      motion%current(p) = w(p) * det
      do j = 1, 3
        do a = 1, N_NODES(kind)
          motion%gradient(a, j, p) = dN(1, a) * inverse(1, j) + dN(2, a) * inverse(2, j) + dN(3, a) * inverse(3, j)
        end do
      end do
    end do
  end subroutine set_reference


  !> Displacement gradients; under NLGEOM current gradients and volumes; with mean dilatation the mean gradients and
  !! F-bar. Displacements count from node 1, so that a translation gives exactly nothing.
  pure subroutine move(kind, u, is_nlgeom, motion, status)
    integer, intent(in) :: kind
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) [length]
    logical, intent(in) :: is_nlgeom
    type(motion_type), intent(inout) :: motion
    integer, intent(out) :: status                 !< ELEMENT_...
    integer :: p, a, j
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u(:, :N_NODES(kind))))) return
    status = ELEMENT_OK
    do p = 1, N_POINTS(kind)
      motion%H(:, :, p) = 0
      do a = 2, N_NODES(kind)
        do j = 1, 3
          motion%H(:, j, p) = motion%H(:, j, p) + (u(:, a) - u(:, 1)) * motion%gradient(a, j, p)
        end do
      end do
    end do
    if (is_nlgeom) call push_forward(N_NODES(kind), N_POINTS(kind), motion, status)
    if (status /= ELEMENT_OK .or. .not. IS_MEAN(kind)) return
    motion%mean = 0
    do p = 1, N_POINTS(kind)
      do j = 1, 3
        do a = 1, N_NODES(kind)
          motion%mean(a, j) = motion%mean(a, j) + motion%current(p) * motion%gradient(a, j, p)
        end do
      end do
    end do
    motion%mean = motion%mean / sum(motion%current(:N_POINTS(kind)))
    if (is_nlgeom) call set_mean_dilatation(N_POINTS(kind), motion)
  end subroutine move


  !> Turns reference gradients and volumes into current ones: dN/dx = dN/dX F^-1, dv = J dV.
  pure subroutine push_forward(n, n_rule, motion, status)
    integer, intent(in) :: n, n_rule               !< nodes, points
    type(motion_type), intent(inout) :: motion
    integer, intent(out) :: status                 !< ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE
    real(DP) :: inverse(3, 3), det, g1, g2, g3
    integer :: p, a
    do p = 1, n_rule
      status = ELEMENT_NOT_FINITE
      if (.not. all(abs(motion%H(:, :, p)) <= LARGEST_GRADIENT)) return
      motion%j(p) = determinant_minus_one(motion%H(:, :, p))
      status = ELEMENT_INVERTED
      call invert(IDENTITY + motion%H(:, :, p), inverse, det)
      if (.not. (motion%j(p) > -1 .and. det > 0)) return
      motion%current(p) = (1 + motion%j(p)) * motion%reference(p)
      do a = 1, n
        g1 = motion%gradient(a, 1, p)
        g2 = motion%gradient(a, 2, p)
        g3 = motion%gradient(a, 3, p)
        motion%gradient(a, 1, p) = g1 * inverse(1, 1) + g2 * inverse(2, 1) + g3 * inverse(3, 1)
        motion%gradient(a, 2, p) = g1 * inverse(1, 2) + g2 * inverse(2, 2) + g3 * inverse(3, 2)
        motion%gradient(a, 3, p) = g1 * inverse(1, 3) + g2 * inverse(2, 3) + g3 * inverse(3, 3)
      end do
    end do
    status = ELEMENT_OK
  end subroutine push_forward


  !> Replaces H by that of F-bar = r F, r^3 = Jbar/J, Jbar = current over reference volume of the element.
  pure subroutine set_mean_dilatation(n_rule, motion)
    integer, intent(in) :: n_rule                  !< points
    type(motion_type), intent(inout) :: motion     !< H and j change
    real(DP) :: mean, cube, r, r_minus_one
    integer :: p
    mean = sum(motion%j(:n_rule) * motion%reference(:n_rule)) / sum(motion%reference(:n_rule))
    do p = 1, n_rule
      cube = (mean - motion%j(p)) / (1 + motion%j(p))          ! r^3 - 1
      r = exp(logarithm_1p(cube) / 3)
      r_minus_one = cube / (1 + r + r * r)
      motion%H(:, :, p) = motion%H(:, :, p) + r_minus_one * (IDENTITY + motion%H(:, :, p))
      motion%j(p) = mean
    end do
  end subroutine set_mean_dilatation


  !> Stress (Hooke or Kirchhoff), tangent and point values at all points.
  pure subroutine set_stresses(kind, material, is_nlgeom, is_tangent, motion, tau, tangent, points, status)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom, is_tangent
    type(motion_type), intent(in) :: motion
    real(DP), intent(out) :: tau(6, MAX_POINTS)    !< [stress]
    real(DP), intent(out) :: tangent(6, 6, MAX_POINTS)   !< defined if is_tangent [stress]
    type(points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP) :: strain(6), dilatation
    integer :: p
    status = STRESS_OK
    dilatation = 0
    if (IS_MEAN(kind) .and. .not. is_nlgeom) dilatation = mean_divergence(N_POINTS(kind), motion)
    do p = 1, N_POINTS(kind)
      if (.not. is_nlgeom) then
        strain = pack_voigt(motion%H(:, :, p))
        if (IS_MEAN(kind)) strain = strain + ((dilatation - sum(strain(:3))) / 3) * VOIGT_IDENTITY
        points%strain(:, p) = strain
        call stress_small(material, strain, tau(:, p), tangent(:, :, p), points%energy(p))
        points%stress(:, p) = tau(:, p)
      else
        if (is_tangent) then
          call stress_finite(material, motion%H(:, :, p), tau(:, p), tangent(:, :, p), points%strain(:, p), &
            points%energy(p), status)
        else
          call kirchhoff_stress(material, motion%H(:, :, p), tau(:, p), points%strain(:, p), points%energy(p), status)
        end if
        if (status /= STRESS_OK) exit
        points%stress(:, p) = tau(:, p) / (1 + motion%j(p))
      end if
      points%volume(p) = motion%reference(p)
    end do
    if (status /= STRESS_OK) status = merge(ELEMENT_INVERTED, ELEMENT_NOT_FINITE, status == STRESS_INVERTED)
  end subroutine set_stresses


  !> Stress, tangent, point values and history at all points of a material that is not plain.
  pure subroutine update_points(kind, material, is_nlgeom, motion, tau, tangent, points, status)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(motion_type), intent(in) :: motion
    real(DP), intent(out) :: tau(6, MAX_POINTS)    !< [stress]
    real(DP), intent(out) :: tangent(6, 6, MAX_POINTS)   !< [stress]
    type(points_type), intent(inout) :: points
    integer, intent(out) :: status                 !< ELEMENT_...
    type(point_type) :: point
    real(DP) :: dilatation, weight(MAX_NODES, MAX_POINTS)
    integer :: p, n
    n = N_NODES(kind)
    call solid_temperature_weights(kind, weight)
    dilatation = 0
    if (IS_MEAN(kind) .and. .not. is_nlgeom) dilatation = mean_divergence(N_POINTS(kind), motion)
    do p = 1, N_POINTS(kind)
      call begin_point(material, points, p, weight(:n, p), point)
      point%H = motion%H(:, :, p)
      point%strain = pack_voigt(point%H)
      if (IS_MEAN(kind)) point%strain = point%strain + ((dilatation - sum(point%strain(:3))) / 3) * VOIGT_IDENTITY
      call update_point(material, is_nlgeom, point, status)
      if (status /= STRESS_OK) exit
      call split_tangent(material, point, points, p)
      tau(:, p) = point%stress
      tangent(:, :, p) = point%tangent
      points%stress(:, p) = point%stress
      if (is_nlgeom) points%stress(:, p) = point%stress / (1 + motion%j(p))
      points%strain(:, p) = point%strain
      points%energy(p) = point%energy
      call keep_history(point, points, p)
      points%volume(p) = motion%reference(p)
    end do
    if (status /= STRESS_OK) status = merge(ELEMENT_INVERTED, ELEMENT_NOT_FINITE, status == STRESS_INVERTED)
  end subroutine update_points


  !> Mean of div u over the reference volume.
  pure function mean_divergence(n_rule, motion) result(divergence)
    integer, intent(in) :: n_rule                  !< points
    type(motion_type), intent(in) :: motion
    real(DP) :: divergence
    integer :: p
    divergence = 0
    do p = 1, n_rule
      divergence = divergence + motion%reference(p) * (motion%H(1, 1, p) + motion%H(2, 2, p) + motion%H(3, 3, p))
    end do
    divergence = divergence / sum(motion%reference(:n_rule))
  end function mean_divergence


  !> Internal forces: force_a = sum of w tau g_a; with mean dilatation sum of w (tau - p 1) g_a + (sum of w p) gbar_a.
  pure subroutine add_forces(n, n_rule, is_mean_dilatation, motion, tau, force)
    integer, intent(in) :: n, n_rule               !< nodes, points
    logical, intent(in) :: is_mean_dilatation
    type(motion_type), intent(in) :: motion
    real(DP), intent(in) :: tau(6, MAX_POINTS)     !< [stress]
    real(DP), intent(inout) :: force(3, MAX_NODES) !< [force]
    real(DP) :: t(6), pressure, total, f(MAX_NODES, 3)
    integer :: p, a
    f = 0
    total = 0
    do p = 1, n_rule
      t = motion%reference(p) * tau(:, p)
      if (is_mean_dilatation) then
        pressure = (t(1) + t(2) + t(3)) / 3
        t(:3) = t(:3) - pressure
        total = total + pressure
      end if
      do a = 1, n
        f(a, 1) = f(a, 1) + t(1) * motion%gradient(a, 1, p) + t(4) * motion%gradient(a, 2, p) &
          + t(6) * motion%gradient(a, 3, p)
        f(a, 2) = f(a, 2) + t(4) * motion%gradient(a, 1, p) + t(2) * motion%gradient(a, 2, p) &
          + t(5) * motion%gradient(a, 3, p)
        f(a, 3) = f(a, 3) + t(6) * motion%gradient(a, 1, p) + t(5) * motion%gradient(a, 2, p) &
          + t(3) * motion%gradient(a, 3, p)
      end do
    end do
    if (is_mean_dilatation) f(:n, :) = f(:n, :) + total * motion%mean(:n, :)
    force(:, :n) = force(:, :n) + transpose(f(:n, :))
  end subroutine add_forces


  !> The tangent: sum over the points of B^T c B + (g . tau g) 1; the terms of the mean dilatation are folded into c
  !! and tau but for three products of vectors of the element.
  pure subroutine set_stiffness(n, n_rule, is_mean_dilatation, motion, tau, tangent, stiffness)
    integer, intent(in) :: n, n_rule               !< nodes, points
    logical, intent(in) :: is_mean_dilatation
    type(motion_type), intent(in) :: motion
    real(DP), intent(inout) :: tau(6, MAX_POINTS)  !< Kirchhoff stress, zero at small strain; spoiled [stress]
    real(DP), intent(inout) :: tangent(6, 6, MAX_POINTS)   !< spoiled [stress]
    real(DP), intent(inout) :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)   !< set up to 3 n
    real(DP) :: remainder(MAX_NODES, 3), factor, m(MAX_NODES, 3, MAX_POINTS), block(MAX_NODES, MAX_NODES)
    integer :: p, b, i, j
    factor = 0
    if (is_mean_dilatation) then
      call fold_mean_dilatation(n, n_rule, motion, tau, tangent, remainder, factor)
    else
      do p = 1, n_rule
        tangent(:, :, p) = motion%reference(p) * tangent(:, :, p)
        tau(:, p) = motion%reference(p) * tau(:, p)
      end do
    end if
    do j = 1, 3
      do i = j, 3
        call multiply_gradients(n, n_rule, i, j, motion%gradient, tau, tangent, m)
        block(:n, :n) = 0
        do p = 1, n_rule
          call add_product(n, motion%gradient(:, :, p), m(:, :, p), block)
        end do
        do b = 1, n
          if (is_mean_dilatation) block(:n, b) = block(:n, b) + motion%mean(b, j) * remainder(:n, i) &
            + (remainder(b, j) + factor * motion%mean(b, j)) * motion%mean(:n, i)
        end do
        call scatter(n, i, j, block, stiffness)
      end do
    end do
  end subroutine set_stiffness


  !> m_bk = (c_ikjl + tau_kl delta_ij) g_bl at all points, for one pair of directions.
  pure subroutine multiply_gradients(n, n_rule, i, j, g, tau, tangent, m)
    integer, intent(in) :: n, n_rule, i, j
    real(DP), intent(in) :: g(MAX_NODES, 3, MAX_POINTS), tau(6, MAX_POINTS), tangent(6, 6, MAX_POINTS)
    real(DP), intent(out) :: m(MAX_NODES, 3, MAX_POINTS)
    real(DP) :: c(3, 3)
    integer :: p, k, l
    do p = 1, n_rule
      do l = 1, 3
        do k = 1, 3
          c(k, l) = tangent(VOIGT_INDEX(i, k), VOIGT_INDEX(j, l), p)
          if (i == j) c(k, l) = c(k, l) + tau(VOIGT_INDEX(k, l), p)
        end do
      end do
      do k = 1, 3
        m(:n, k, p) = c(k, 1) * g(:n, 1, p) + c(k, 2) * g(:n, 2, p) + c(k, 3) * g(:n, 3, p)
      end do
    end do
  end subroutine multiply_gradients


  !> block_ab = block_ab + g_ak m_bk: the innermost loop of the tangent.
  pure subroutine add_product(n, g, m, block)
    integer, intent(in) :: n                       !< nodes
    real(DP), intent(in) :: g(MAX_NODES, 3), m(MAX_NODES, 3)
    real(DP), intent(inout) :: block(MAX_NODES, MAX_NODES)
    integer :: a, b
    do b = 1, n
      do a = 1, n
        block(a, b) = block(a, b) + g(a, 1) * m(b, 1) + g(a, 2) * m(b, 2) + g(a, 3) * m(b, 3)
      end do
    end do
  end subroutine add_product


  !> Writes the block of the directions (i, j), i >= j, and its mirror image: the matrix is symmetric to the last bit.
  pure subroutine scatter(n, i, j, block, stiffness)
    integer, intent(in) :: n, i, j
    real(DP), intent(in) :: block(MAX_NODES, MAX_NODES)
    real(DP), intent(inout) :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)
    integer :: a, b
    do b = 1, n
      do a = merge(b, 1, i == j), n
        stiffness(3 * a - 3 + i, 3 * b - 3 + j) = block(a, b)
        stiffness(3 * b - 3 + j, 3 * a - 3 + i) = block(a, b)
      end do
    end do
  end subroutine scatter


  !> Folds the terms of the mean dilatation into tangent and stress (both times the volumes), and gives what is left:
  !! remainder r and factor k of  gbar r^T + r gbar^T + k gbar gbar^T.
  !! Derivation: doc/theory/elements.md, section "Mean dilatation: the tangent".
  pure subroutine fold_mean_dilatation(n, n_rule, motion, tau, tangent, remainder, factor)
    integer, intent(in) :: n, n_rule               !< nodes, points
    type(motion_type), intent(in) :: motion
    real(DP), intent(inout) :: tau(6, MAX_POINTS), tangent(6, 6, MAX_POINTS)
    real(DP), intent(out) :: remainder(MAX_NODES, 3), factor
    real(DP), parameter :: TWICE_SYMMETRIC(6) = [real(DP) :: 2, 2, 2, 1, 1, 1]
    real(DP) :: total, pressure, q(6), beta, omega, dilatation, w
    integer :: p, i, a
    total = 0
    do p = 1, n_rule
      total = total + motion%reference(p) * (tau(1, p) + tau(2, p) + tau(3, p)) / 3
    end do
    remainder(:n, :) = 0
    factor = -total
    do p = 1, n_rule
      w = motion%reference(p)
      pressure = (tau(1, p) + tau(2, p) + tau(3, p)) / 3
      dilatation = total * motion%current(p) / sum(motion%current(:n_rule))
      omega = w * pressure - dilatation
      q = w * ((tangent(:, 1, p) + tangent(:, 2, p) + tangent(:, 3, p)) + 2 * tau(:, p)) / 3
      beta = (q(1) + q(2) + q(3)) / 3
      factor = factor + beta
      tangent(:, :, p) = w * tangent(:, :, p)
      do i = 1, 3
        tangent(:, i, p) = tangent(:, i, p) - q
        tangent(i, :, p) = tangent(i, :, p) - q
        tangent(:3, i, p) = tangent(:3, i, p) + beta + dilatation
      end do
      do i = 1, 6
        tangent(i, i, p) = tangent(i, i, p) + omega * TWICE_SYMMETRIC(i)
      end do
      tau(:, p) = w * tau(:, p) - omega * VOIGT_IDENTITY
      q(:3) = q(:3) - beta
      do a = 1, n
        associate (g => motion%gradient(a, :, p))
          remainder(a, 1) = remainder(a, 1) + q(1) * g(1) + q(4) * g(2) + q(6) * g(3)
          remainder(a, 2) = remainder(a, 2) + q(4) * g(1) + q(2) * g(2) + q(5) * g(3)
          remainder(a, 3) = remainder(a, 3) + q(6) * g(1) + q(5) * g(2) + q(3) * g(3)
        end associate
      end do
    end do
  end subroutine fold_mean_dilatation

end module amontons_solid_elements
