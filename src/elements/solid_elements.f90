!> Three-dimensional solid elements: full and reduced integration, B-bar/F-bar, incompatible modes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory and symbols: doc/theory/elements.md. Force and tangent are the first and second derivative of the element's
!! strain energy: the tangent is symmetric, also at finite strain and with mean dilatation. The first array index is the
!! node, for vectorization.
module amontons_solid_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_beam_rules, only: is_beam_kind
  use amontons_zero_stress_condition, only: evaluate_initial_tangent, CONDITION_NONE
  use amontons_incompatible_modes, only: mode_iteration_type, evaluate_mode_gradients, correct_mode_amplitudes, &
    condense_mode_amplitudes, add_mode_skew_part, N_MODES, MAX_AMPLITUDE_CORRECTIONS, &
    TOL_MODE_FORCE_ACCEPTABLE
  use amontons_hourglass, only: hourglass_type, set_physical_hourglass, set_artificial_hourglass, add_hourglass_forces, &
    add_thickness_stabilization, has_present_modulus, artificial_modulus
  use amontons_hourglass_flow, only: load_hourglass_flow, store_hourglass_flow
  use amontons_materials, only: material_type, LAW_SAINT_VENANT
  use amontons_material_point, only: material_point_type, update_material_point
  use amontons_element_integration_points, only: integration_points_type, set_point_input, store_point_history, &
    split_unsymmetric_tangent, ELEMENT_OK, &
    ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_logarithmic_strain, only: log1p
  use amontons_shape_functions, only: shape_functions, quadrature
  use amontons_quadratic_solid_shell, only: evaluate_quadratic_solid_shell
  use amontons_solid_shell, only: evaluate_solid_shell, set_layer_temperature_weights
  use amontons_element_kinds, only: KIND_CSS8, KIND_CSS6
  use amontons_elasticity, only: small_strain_stress, finite_strain_stress, kirchhoff_stress, STRESS_OK, STRESS_INVERTED, &
    MAX_DISPLACEMENT_GRADIENT
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, VOIGT_INDEX, determinant_minus_one, invert, pack_voigt
  use amontons_element_kinds, only: MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, &
    KIND_C3D8I, &
    KIND_C3D8R, KIND_C3D10, KIND_C3D15, KIND_C3D20, KIND_C3D20R, KIND_BEAM_RECT, KIND_BEAM_KRONROD, N_SOLID_KINDS
  implicit none
  private
  public :: evaluate_solid_element, evaluate_solid_volumes, integrate_solid_body_force, set_solid_temperature_weights

  ! The table of module element_kinds once more, as constants: so the loops have known lengths. The unit test notices if
  ! they differ.
  integer, parameter :: N_KIND_NODES(N_SOLID_KINDS) = [4, 6, 8, 8, 10, 20, 20, 8, 8, 15, 8, 6, 20, 20, 20, 20, 20, 15]
  integer, parameter :: N_KIND_POINTS(N_SOLID_KINDS) = [1, 2, 8, 8, 4, 27, 8, 8, 1, 9, 20, 15, 18, 16, 24, 24, 50, 6]
  logical, parameter :: HAS_MEAN_DILATATION(N_SOLID_KINDS) = [.false., .false., .true., .false., .false., .false., .false., &
    .false., .false., .false., .false., .false., .false., .false., .false., .false., .false., .false.]

  !> Kinematics of an element: deformation data for forces and tangent.
  type :: kinematics_type
    real(DP) :: gradient(MAX_ELEMENT_NODES, 3, MAX_ELEMENT_POINTS) !< dN_a/dx_j, current under NLGEOM [1/length]
    real(DP) :: mean(MAX_ELEMENT_NODES, 3)                 !< their mean over the (current) volume [1/length]
    real(DP) :: H(3, 3, MAX_ELEMENT_POINTS)                !< displacement gradient du_i/dX_j, or that of F-bar [-]
    real(DP) :: j(MAX_ELEMENT_POINTS)                      !< det(1 + H) - 1 [-]
    real(DP) :: reference(MAX_ELEMENT_POINTS)              !< reference volumes of the points [length^3]
    real(DP) :: current(MAX_ELEMENT_POINTS)                !< their current volumes [length^3]
  end type kinematics_type

contains

  !> Internal force, point values and, if requested, the tangent of a three-dimensional element.
  pure subroutine evaluate_solid_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_C3D...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< [force]
    type(integration_points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u [force/length]
    select case (kind)                             ! constant arguments give loops of known length
    case (KIND_C3D4)
      call evaluate_kernel(KIND_C3D4, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D6)
      call evaluate_kernel(KIND_C3D6, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D8)
      call evaluate_kernel(KIND_C3D8, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D8_FULL)
      call evaluate_kernel(KIND_C3D8_FULL, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D10)
      call evaluate_kernel(KIND_C3D10, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D8I)
      call evaluate_incompatible_modes(material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_CSS8, KIND_CSS6)
      call evaluate_solid_shell(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    case (KIND_C3D8R)
      call evaluate_one_point(material, X, u, is_nlgeom, force, points, status, stiffness)
    case default
      if (kind == KIND_C3D15 .and. points%is_shell) then
        call evaluate_quadratic_solid_shell(material, X, u, is_nlgeom, force, points, status, stiffness)
        return
      end if
      call evaluate_kernel(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
      if (kind == KIND_C3D20R .and. points%is_shell .and. status == ELEMENT_OK) call stabilize_thickness(material, X, u, &
        is_nlgeom, force, points, stiffness)
    end select
  end subroutine evaluate_solid_element


  !> Adds the thickness stabilization of a shell of C3D20R; its energy is spread over the points.
  pure subroutine stabilize_thickness(material, X, u, is_nlgeom, force, points, stiffness)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    real(DP), intent(inout), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: c(6, 6), volume, energy
    call evaluate_initial_tangent(CONDITION_NONE, material, is_nlgeom, 20, points, c)
    volume = sum(points%volume(:8))
    call add_thickness_stabilization(X, u, is_nlgeom, c, volume, energy, force, stiffness)
    points%energy(:8) = points%energy(:8) + energy / volume
  end subroutine stabilize_thickness


  !> The volume of each integration point.
  pure subroutine evaluate_solid_volumes(kind, X, n, volumes, status, walls)
    integer, intent(in) :: kind                    !< KIND_C3D...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    integer, intent(out) :: n                      !< integration points
    real(DP), intent(inout) :: volumes(:)          !< (MAX_ELEMENT_POINTS) the first n are set [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N_a(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    real(DP) :: inverse(3, 3), det, of_point(MAX_ELEMENT_POINTS)
    integer :: rule, n_rule, p
    rule = full_integration_kind(kind)
    call quadrature(rule, n_rule, xi, w, walls)
    status = ELEMENT_OK
    do p = 1, N_KIND_POINTS(rule)
      call shape_functions(rule, xi(:, p), N_a, dN)
      call invert(jacobian_matrix(N_KIND_NODES(rule), X, dN), inverse, det)
      if (.not. det > 0) status = ELEMENT_DEGENERATE
      of_point(p) = w(p) * det
    end do
    n = N_KIND_POINTS(kind)
    volumes(:n) = of_point(:n)
    if (kind == KIND_C3D8R) volumes(1) = sum(of_point(:8))
  end subroutine evaluate_solid_volumes


  !> The kind whose points cover the whole element: C3D8R uses the mean of eight points.
  pure integer function full_integration_kind(kind)
    integer, intent(in) :: kind                    !< a solid in space
    full_integration_kind = merge(KIND_C3D8_FULL, kind, kind == KIND_C3D8R)
  end function full_integration_kind


  !> Consistent nodal forces of a body force: force_a = sum over points of N_a b w.
  pure subroutine integrate_solid_body_force(kind, X, b, force, walls)
    integer, intent(in) :: kind                    !< KIND_C3D...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: b(3)                   !< [force/length^3]
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)   !< in: zero [force]
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    type(kinematics_type) :: kinematics
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    integer :: rule, n_rule, p, a, status
    rule = full_integration_kind(kind)
    call set_reference(rule, X, kinematics, status, walls)
    call quadrature(rule, n_rule, xi, w, walls)
    do p = 1, n_rule
      call shape_functions(rule, xi(:, p), N, dN)
      do a = 1, N_KIND_NODES(rule)
        force(:, a) = force(:, a) + (N(a) * kinematics%reference(p)) * b
      end do
    end do
  end subroutine integrate_solid_body_force


  !> Weights of the nodal temperatures at the points, such that thermal strains match the strains of the element:
  !!
  !! | element | temperature |
  !! |---|---|
  !! | linear | the mean; in the solid of a beam (walls > 0, full sections 1/2) linear over the cross-section, the mean along it |
  !! | C3D6 | linear along its axis between the means of both triangles |
  !! | CSS8, CSS6 | linear over the thickness between the means of both faces |
  !! | C3D10 | linear from the corners |
  !! | C3D15, C3D20R | quadratic: at these few points it is as good as linear |
  !! | C3D20, beams | trilinear through the eight points of the C3D20R |
  pure subroutine set_solid_temperature_weights(kind, weight, walls)
    integer, intent(in) :: kind                    !< KIND_C3D...
    real(DP), intent(out) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)   !< [-]
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), &
      at_corner(MAX_ELEMENT_NODES, 8), L(MAX_ELEMENT_NODES)
    real(DP), parameter :: HEX8_CORNERS(3, 8) = reshape([real(DP) :: -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, &
      -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
    integer :: n_rule, p, k
    weight = 0
    if (kind == KIND_CSS8 .or. kind == KIND_CSS6) then
      call set_layer_temperature_weights(kind, weight)
      return
    else if (N_KIND_NODES(kind) < 10 .and. kind /= KIND_C3D6) then
      weight(:N_KIND_NODES(kind), :) = 1.0_DP / real(N_KIND_NODES(kind), DP)
      if (.not. present(walls)) return
      if (kind /= KIND_C3D8I .or. .not. any(walls > 0)) return
    end if
    call quadrature(kind, n_rule, xi, w, walls)
    if (kind == KIND_C3D20 .or. is_beam_kind(kind)) then
      do k = 1, 8
        call shape_functions(kind, HEX8_CORNERS(:, k) / sqrt(3.0_DP), at_corner(:, k), dN)
      end do
    end if
    do p = 1, n_rule
      select case (kind)
      case (KIND_C3D8I)
        call shape_functions(kind, [0.0_DP, xi(2, p), xi(3, p)], N, dN)
        weight(:8, p) = N(:8)
      case (KIND_C3D10)
        call shape_functions(KIND_C3D4, xi(:, p), N, dN)
        weight(:4, p) = N(:4)
      case (KIND_C3D20, KIND_BEAM_RECT:KIND_BEAM_KRONROD)
        call shape_functions(KIND_C3D8, sqrt(3.0_DP) * xi(:, p), L, dN)
        weight(:20, p) = matmul(at_corner(:20, :), L(:8))
      case default
        call shape_functions(kind, xi(:, p), N, dN)
        weight(:N_KIND_NODES(kind), p) = N(:N_KIND_NODES(kind))
      end select
    end do
  end subroutine set_solid_temperature_weights


  !> Forces, point values and, if requested, the tangent of an element of a kind known at compile time.
  pure subroutine evaluate_kernel(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    type(kinematics_type) :: kinematics
    real(DP) :: tau(6, MAX_ELEMENT_POINTS), tangent(6, 6, MAX_ELEMENT_POINTS)
    force = 0
    call set_reference(kind, X, kinematics, status, points%walls)
    if (status == ELEMENT_OK) call update_kinematics(kind, u, is_nlgeom, kinematics, status)
    if (status /= ELEMENT_OK) return
    call evaluate_material(kind, material, is_nlgeom, present(stiffness), kinematics, tau, tangent, points, status)
    if (status /= ELEMENT_OK) return
    call integrate_forces(N_KIND_NODES(kind), N_KIND_POINTS(kind), HAS_MEAN_DILATATION(kind), kinematics, tau, force)
    if (.not. present(stiffness)) return
    if (.not. is_nlgeom) tau = 0
    call integrate_stiffness(N_KIND_NODES(kind), N_KIND_POINTS(kind), HAS_MEAN_DILATATION(kind), kinematics, tau, tangent, &
      stiffness)
  end subroutine evaluate_kernel


  !> C3D8I: the amplitudes of the incompatible modes are solved for, so that their forces are zero; static condensation eliminates
  !! them. Force and tangent are derivatives of the minimum energy. Cost: one correction for a linear law, else two to five, more
  !! where plastic flow changes direction.
  !!
  !! The search begins with the committed amplitudes (points%modes_old; zero for a law without history), which follow the mean
  !! deformation of the element. Zero amplitudes after plastic flow would be a large step back that yields anew and may invert the
  !! element. If the search fails, a second one begins at zero.
  pure subroutine evaluate_incompatible_modes(material, X, u, is_nlgeom, force, points, status, stiffness)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    type(kinematics_type) :: reference_kinematics
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES), whole(3, &
      8 + N_MODES), F(3, 3), inverse(3, 3), det
    integer :: n_rule
    logical :: is_regular
    call set_reference(KIND_C3D8I, X, reference_kinematics, status)
    if (status /= ELEMENT_OK) return
    call quadrature(KIND_C3D8I, n_rule, xi, w)
    call evaluate_mode_gradients(X, xi(:, :8), reference_kinematics%reference(:8), reference_kinematics%gradient(9:8 + N_MODES, &
      :, :8))
    F = IDENTITY
    if (is_nlgeom) F = mean_deformation(reference_kinematics, u)
    whole(:, :8) = u(:, :8)
    whole(:, 9:) = matmul(F, reshape(points%modes_old, [3, N_MODES]))
    call solve_mode_amplitudes(material, reference_kinematics, is_nlgeom, whole, force, points, status, K)
    if (status /= ELEMENT_OK .and. any(abs(points%modes_old) > 0)) then
      whole(:, 9:) = 0
      call solve_mode_amplitudes(material, reference_kinematics, is_nlgeom, whole, force, points, status, K)
    end if
    if (status /= ELEMENT_OK) return
    call invert(F, inverse, det)
    points%modes = 0
    if (det > 0) points%modes(:3 * N_MODES) = reshape(matmul(inverse, whole(:, 9:)), [3 * N_MODES])
    if (present(stiffness)) then
      stiffness = K
      call condense_mode_amplitudes(8, .not. allocated(points%skew), force, stiffness, is_regular)
    end if
    force(:, 9:) = 0
  end subroutine evaluate_incompatible_modes


  !> The mean deformation gradient of an element by its nodes.
  pure function mean_deformation(kinematics, u) result(F)
    type(kinematics_type), intent(in) :: kinematics     !< of the reference configuration
    real(DP), intent(in) :: u(:, :)                !< (3, 8) [length]
    real(DP) :: F(3, 3)
    integer :: p, a, j
    F = 0
    do p = 1, 8
      do a = 2, 8
        do j = 1, 3
          F(:, j) = F(:, j) + kinematics%reference(p) * (u(:, a) - u(:, 1)) * kinematics%gradient(a, j, p)
        end do
      end do
    end do
    F = IDENTITY + F / sum(kinematics%reference(:8))
  end function mean_deformation


  !> Newton's method for the amplitudes. A correction that inverts the element is halved.
  pure subroutine solve_mode_amplitudes(material, reference_kinematics, is_nlgeom, whole, force, points, status, stiffness)
    type(material_type), intent(in) :: material
    type(kinematics_type), intent(in) :: reference_kinematics       !< gradients of nodes and modes
    logical, intent(in) :: is_nlgeom
    real(DP), intent(inout) :: whole(3, 8 + N_MODES)    !< displacements, then amplitudes [length]
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
      call evaluate_modes(material, reference_kinematics, whole, is_nlgeom, force, points, status, stiffness, mode_residual)
      call correct_mode_amplitudes(iteration, 8, status == ELEMENT_OK, force, stiffness, whole, mode_residual, is_done)
      if (is_done) exit
    end do
    if (status == ELEMENT_OK .and. .not. mode_residual <= TOL_MODE_FORCE_ACCEPTABLE) status = ELEMENT_NOT_FINITE
  end subroutine solve_mode_amplitudes


  !> Forces and tangent of the eight nodes and of the amplitudes, as if these were three more nodes.
  pure subroutine evaluate_modes(material, reference_kinematics, u, is_nlgeom, force, points, status, stiffness, mode_residual)
    type(material_type), intent(in) :: material
    type(kinematics_type), intent(in) :: reference_kinematics       !< gradients of nodes and modes
    real(DP), intent(in) :: u(3, 8 + N_MODES)      !< displacements, then amplitudes [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status
    real(DP), intent(out) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP), intent(out) :: mode_residual             !< of the modes, over the stresses times their gradients [-]
    type(kinematics_type) :: kinematics
    real(DP) :: tau(6, MAX_ELEMENT_POINTS), tangent(6, 6, MAX_ELEMENT_POINTS), scale
    integer :: p, m, j
    integer, parameter :: N = 8 + N_MODES
    force = 0
    kinematics%gradient(:, :, :8) = reference_kinematics%gradient(:, :, :8)
    kinematics%reference(:8) = reference_kinematics%reference(:8)
    kinematics%current(:8) = reference_kinematics%current(:8)
    call update_kinematics(KIND_C3D8I, u, .false., kinematics, status)
    if (status /= ELEMENT_OK) return
    do p = 1, 8
      do m = 1, N_MODES
        do j = 1, 3
          kinematics%H(:, j, p) = kinematics%H(:, j, p) + u(:, 8 + m) * kinematics%gradient(8 + m, j, p)
        end do
      end do
    end do
    if (is_nlgeom) call push_forward(N, 8, kinematics, status)
    if (status == ELEMENT_OK) call evaluate_material(KIND_C3D8I, material, is_nlgeom, .true., kinematics, tau, tangent, points, &
      status)
    if (status /= ELEMENT_OK) return
    call integrate_forces(N, 8, .false., kinematics, tau, force)
    scale = tiny(1.0_DP)
    do p = 1, 8
      scale = scale + kinematics%reference(p) * norm2(tau(:, p)) * norm2(kinematics%gradient(9:N, :, p))
    end do
    mode_residual = norm2(force(:, 9:N)) / scale
    if (.not. is_nlgeom) tau = 0
    call integrate_stiffness(N, 8, .false., kinematics, tau, tangent, stiffness)
    if (allocated(points%skew)) call add_mode_skew_part(N, kinematics%gradient(:, :, :8), kinematics%reference(:8), points%skew, &
      stiffness)
  end subroutine evaluate_modes


  !> C3D8R: the mean of the gradients replaces those of all points; the energy of the hourglass modes is added
  !! to that of the point. The artificial stiffness may need the present tangent.
  pure subroutine evaluate_one_point(material, X, u, is_nlgeom, force, points, status, stiffness)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    type(kinematics_type) :: kinematics
    type(hourglass_type) :: hourglass
    real(DP) :: mean(MAX_ELEMENT_NODES, 3), volume, tau(6, MAX_ELEMENT_POINTS), tangent(6, 6, MAX_ELEMENT_POINTS), c(6, 6), energy
    real(DP) :: temperature_weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), modulus
    integer :: p
    force = 0
    call set_solid_temperature_weights(KIND_C3D8R, temperature_weight, points%walls)
    call set_reference(KIND_C3D8_FULL, X, kinematics, status)
    if (status /= ELEMENT_OK) return
    volume = sum(kinematics%reference(:8))
    mean = 0
    do p = 1, 8
      mean(:8, :) = mean(:8, :) + (kinematics%reference(p) / volume) * kinematics%gradient(:8, :, p)
    end do
    kinematics%gradient(:8, :, 1) = mean(:8, :)
    kinematics%reference(1) = volume
    kinematics%current(1) = volume
    call update_kinematics(KIND_C3D8R, u, is_nlgeom, kinematics, status)
    if (status == ELEMENT_OK) call evaluate_material(KIND_C3D8R, material, is_nlgeom, present(stiffness) .or. &
      has_present_modulus(material), kinematics, tau, tangent, points, status)
    if (status /= ELEMENT_OK) return
    call evaluate_initial_tangent(CONDITION_NONE, material, is_nlgeom, 8, points, c)
    if (material%law == LAW_SAINT_VENANT) modulus = artificial_modulus(material, c, tangent(:, :, 1), merge(kinematics%H(:, :, 1), &
      0.0_DP, is_nlgeom))
    call integrate_forces(8, 1, .false., kinematics, tau, force)
    if (present(stiffness)) then
      if (.not. is_nlgeom) tau = 0
      call integrate_stiffness(8, 1, .false., kinematics, tau, tangent, stiffness)
    end if
    call set_physical_hourglass(3, X, mean(:8, :), volume, c, hourglass)
    if (material%law == LAW_SAINT_VENANT) then
      call set_artificial_hourglass(hourglass, volume, modulus, [real(DP) ::], 1.0_DP)
      call add_hourglass_forces(hourglass, u, .false., energy, force, stiffness)   ! |q|^2 is free of rotations
    else
      call load_hourglass_flow(material, points, hourglass)
      call add_hourglass_forces(hourglass, u, is_nlgeom, energy, force, stiffness)
      call store_hourglass_flow(CONDITION_NONE, material, u, kinematics%H(:, :, 1), is_nlgeom, temperature_weight(:8, 1), &
        hourglass, energy, points)
    end if
    points%energy(1) = points%energy(1) + energy / volume
  end subroutine evaluate_one_point


  !> Stress, tangent and point values at all points, by the law of the material.
  pure subroutine evaluate_material(kind, material, is_nlgeom, is_tangent, kinematics, tau, tangent, points, status)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom, is_tangent
    type(kinematics_type), intent(in) :: kinematics
    real(DP), intent(out) :: tau(6, MAX_ELEMENT_POINTS), tangent(6, 6, MAX_ELEMENT_POINTS)
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status
    if (material%is_linear_isotropic) then
      call evaluate_plain_stresses(kind, material, is_nlgeom, is_tangent, kinematics, tau, tangent, points, status)
    else
      points%is_tangent_wanted = is_tangent
      call evaluate_point_laws(kind, material, is_nlgeom, kinematics, tau, tangent, points, status)
    end if
  end subroutine evaluate_material


  !> Derivatives of the shape functions by the coordinates given, and the volumes of the points.
  pure subroutine set_reference(kind, X, kinematics, status, walls)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) [length]
    type(kinematics_type), intent(out) :: kinematics       !< gradient, reference, current are set
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    real(DP) :: inverse(3, 3), det
    integer :: n_rule, p, a, j
    status = ELEMENT_OK
    call quadrature(kind, n_rule, xi, w, walls)
    do p = 1, N_KIND_POINTS(kind)
      call shape_functions(kind, xi(:, p), N, dN)
      call invert(jacobian_matrix(N_KIND_NODES(kind), X, dN), inverse, det)
      if (.not. det > 0) status = ELEMENT_DEGENERATE
      kinematics%reference(p) = w(p) * det
      kinematics%current(p) = w(p) * det
      do j = 1, 3
        do a = 1, N_KIND_NODES(kind)
          kinematics%gradient(a, j, p) = dN(1, a) * inverse(1, j) + dN(2, a) * inverse(2, j) + dN(3, a) * inverse(3, j)
        end do
      end do
    end do
  end subroutine set_reference


  !> dX/dxi at a point, from the places relative to node 1.
  pure function jacobian_matrix(n, X, dN) result(jacobian)
    integer, intent(in) :: n                       !< nodes
    real(DP), intent(in) :: X(:, :)                !< (3, n) [length]
    real(DP), intent(in) :: dN(:, :)               !< (3, n) derivatives of the shape functions [-]
    real(DP) :: jacobian(3, 3)
    integer :: a, j
    jacobian = 0
    do a = 2, n
      do j = 1, 3
        jacobian(:, j) = jacobian(:, j) + (X(:, a) - X(:, 1)) * dN(j, a)
      end do
    end do
  end function jacobian_matrix


  !> Displacement gradients; under NLGEOM current gradients and volumes; with mean dilatation the mean gradients and
  !! F-bar. Displacements are relative to node 1, so that a translation gives exactly zero.
  pure subroutine update_kinematics(kind, u, is_nlgeom, kinematics, status)
    integer, intent(in) :: kind
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) [length]
    logical, intent(in) :: is_nlgeom
    type(kinematics_type), intent(inout) :: kinematics
    integer, intent(out) :: status                 !< ELEMENT_...
    integer :: p, a, j
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u(:, :N_KIND_NODES(kind))))) return
    status = ELEMENT_OK
    do p = 1, N_KIND_POINTS(kind)
      kinematics%H(:, :, p) = 0
      do a = 2, N_KIND_NODES(kind)
        do j = 1, 3
          kinematics%H(:, j, p) = kinematics%H(:, j, p) + (u(:, a) - u(:, 1)) * kinematics%gradient(a, j, p)
        end do
      end do
    end do
    if (is_nlgeom) call push_forward(N_KIND_NODES(kind), N_KIND_POINTS(kind), kinematics, status)
    if (status /= ELEMENT_OK .or. .not. HAS_MEAN_DILATATION(kind)) return
    kinematics%mean = 0
    do p = 1, N_KIND_POINTS(kind)
      do j = 1, 3
        do a = 1, N_KIND_NODES(kind)
          kinematics%mean(a, j) = kinematics%mean(a, j) + kinematics%current(p) * kinematics%gradient(a, j, p)
        end do
      end do
    end do
    kinematics%mean = kinematics%mean / sum(kinematics%current(:N_KIND_POINTS(kind)))
    if (is_nlgeom) call set_mean_dilatation(N_KIND_POINTS(kind), kinematics)
  end subroutine update_kinematics


  !> Turns reference gradients and volumes into current ones: dN/dx = dN/dX F^-1, dv = J dV.
  pure subroutine push_forward(n, n_rule, kinematics, status)
    integer, intent(in) :: n, n_rule               !< nodes, points
    type(kinematics_type), intent(inout) :: kinematics
    integer, intent(out) :: status                 !< ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE
    real(DP) :: inverse(3, 3), det, g1, g2, g3
    integer :: p, a
    do p = 1, n_rule
      status = ELEMENT_NOT_FINITE
      if (.not. all(abs(kinematics%H(:, :, p)) <= MAX_DISPLACEMENT_GRADIENT)) return
      kinematics%j(p) = determinant_minus_one(kinematics%H(:, :, p))
      status = ELEMENT_INVERTED
      call invert(IDENTITY + kinematics%H(:, :, p), inverse, det)
      if (.not. (kinematics%j(p) > -1 .and. det > 0)) return
      kinematics%current(p) = (1 + kinematics%j(p)) * kinematics%reference(p)
      do a = 1, n
        g1 = kinematics%gradient(a, 1, p)
        g2 = kinematics%gradient(a, 2, p)
        g3 = kinematics%gradient(a, 3, p)
        kinematics%gradient(a, 1, p) = g1 * inverse(1, 1) + g2 * inverse(2, 1) + g3 * inverse(3, 1)
        kinematics%gradient(a, 2, p) = g1 * inverse(1, 2) + g2 * inverse(2, 2) + g3 * inverse(3, 2)
        kinematics%gradient(a, 3, p) = g1 * inverse(1, 3) + g2 * inverse(2, 3) + g3 * inverse(3, 3)
      end do
    end do
    status = ELEMENT_OK
  end subroutine push_forward


  !> Replaces H by that of F-bar = r F, r^3 = Jbar/J, Jbar = current over reference volume of the element.
  pure subroutine set_mean_dilatation(n_rule, kinematics)
    integer, intent(in) :: n_rule                  !< points
    type(kinematics_type), intent(inout) :: kinematics     !< H and j change
    real(DP) :: mean, cube, r, r_minus_one
    integer :: p
    mean = sum(kinematics%j(:n_rule) * kinematics%reference(:n_rule)) / sum(kinematics%reference(:n_rule))
    do p = 1, n_rule
      cube = (mean - kinematics%j(p)) / (1 + kinematics%j(p))          ! r^3 - 1
      r = exp(log1p(cube) / 3)
      r_minus_one = cube / (1 + r + r * r)
      kinematics%H(:, :, p) = kinematics%H(:, :, p) + r_minus_one * (IDENTITY + kinematics%H(:, :, p))
      kinematics%j(p) = mean
    end do
  end subroutine set_mean_dilatation


  !> Stress (Hooke or Kirchhoff), tangent and point values at all points.
  pure subroutine evaluate_plain_stresses(kind, material, is_nlgeom, is_tangent, kinematics, tau, tangent, points, status)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom, is_tangent
    type(kinematics_type), intent(in) :: kinematics
    real(DP), intent(out) :: tau(6, MAX_ELEMENT_POINTS)    !< [stress]
    real(DP), intent(out) :: tangent(6, 6, MAX_ELEMENT_POINTS)   !< defined if is_tangent [stress]
    type(integration_points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP) :: strain(6), dilatation
    integer :: p
    status = STRESS_OK
    dilatation = 0
    if (HAS_MEAN_DILATATION(kind) .and. .not. is_nlgeom) dilatation = mean_divergence(N_KIND_POINTS(kind), kinematics)
    do p = 1, N_KIND_POINTS(kind)
      if (.not. is_nlgeom) then
        strain = pack_voigt(kinematics%H(:, :, p))
        if (HAS_MEAN_DILATATION(kind)) strain = strain + ((dilatation - sum(strain(:3))) / 3) * VOIGT_IDENTITY
        points%strain(:, p) = strain
        call small_strain_stress(material, strain, tau(:, p), tangent(:, :, p), points%energy(p))
        points%stress(:, p) = tau(:, p)
      else
        if (is_tangent) then
          call finite_strain_stress(material, kinematics%H(:, :, p), tau(:, p), tangent(:, :, p), points%strain(:, p), &
            points%energy(p), status)
        else
          call kirchhoff_stress(material, kinematics%H(:, :, p), tau(:, p), points%strain(:, p), points%energy(p), status)
        end if
        if (status /= STRESS_OK) exit
        points%stress(:, p) = tau(:, p) / (1 + kinematics%j(p))
      end if
      points%volume(p) = kinematics%reference(p)
    end do
    if (status /= STRESS_OK) status = merge(ELEMENT_INVERTED, ELEMENT_NOT_FINITE, status == STRESS_INVERTED)
  end subroutine evaluate_plain_stresses


  !> Stress, tangent, point values and history at all points of a material that is not plain.
  pure subroutine evaluate_point_laws(kind, material, is_nlgeom, kinematics, tau, tangent, points, status)
    integer, intent(in) :: kind
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(kinematics_type), intent(in) :: kinematics
    real(DP), intent(out) :: tau(6, MAX_ELEMENT_POINTS)    !< [stress]
    real(DP), intent(out) :: tangent(6, 6, MAX_ELEMENT_POINTS)   !< [stress]
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status                 !< ELEMENT_...
    type(material_point_type) :: point
    real(DP) :: dilatation, weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    integer :: p, n
    n = N_KIND_NODES(kind)
    call set_solid_temperature_weights(kind, weight, points%walls)
    dilatation = 0
    if (HAS_MEAN_DILATATION(kind) .and. .not. is_nlgeom) dilatation = mean_divergence(N_KIND_POINTS(kind), kinematics)
    do p = 1, N_KIND_POINTS(kind)
      call set_point_input(material, points, p, weight(:n, p), point)
      point%H = kinematics%H(:, :, p)
      point%strain = pack_voigt(point%H)
      if (HAS_MEAN_DILATATION(kind)) point%strain = point%strain + ((dilatation - sum(point%strain(:3))) / 3) * VOIGT_IDENTITY
      call update_material_point(material, is_nlgeom, point, status)
      if (status /= STRESS_OK) exit
      tau(:, p) = point%stress
      if (points%is_tangent_wanted) then
        call split_unsymmetric_tangent(material, point, points, p)
        tangent(:, :, p) = point%tangent
      end if
      points%stress(:, p) = point%stress
      if (is_nlgeom) points%stress(:, p) = point%stress / (1 + kinematics%j(p))
      points%strain(:, p) = point%strain
      points%energy(p) = point%energy
      call store_point_history(point, points, p)
      points%volume(p) = kinematics%reference(p)
    end do
    if (status /= STRESS_OK) status = merge(ELEMENT_INVERTED, ELEMENT_NOT_FINITE, status == STRESS_INVERTED)
  end subroutine evaluate_point_laws


  !> Mean of div u over the reference volume.
  pure function mean_divergence(n_rule, kinematics) result(divergence)
    integer, intent(in) :: n_rule                  !< points
    type(kinematics_type), intent(in) :: kinematics
    real(DP) :: divergence
    integer :: p
    divergence = 0
    do p = 1, n_rule
      divergence = divergence + kinematics%reference(p) * (kinematics%H(1, 1, p) + kinematics%H(2, 2, p) + kinematics%H(3, 3, p))
    end do
    divergence = divergence / sum(kinematics%reference(:n_rule))
  end function mean_divergence


  !> Internal forces: force_a = sum of w tau g_a; with mean dilatation sum of w (tau - p 1) g_a + (sum of w p) gbar_a.
  pure subroutine integrate_forces(n, n_rule, is_mean_dilatation, kinematics, tau, force)
    integer, intent(in) :: n, n_rule               !< nodes, points
    logical, intent(in) :: is_mean_dilatation
    type(kinematics_type), intent(in) :: kinematics
    real(DP), intent(in) :: tau(6, MAX_ELEMENT_POINTS)     !< [stress]
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES) !< [force]
    real(DP) :: t(6), pressure, total, f(MAX_ELEMENT_NODES, 3)
    integer :: p, a
    f = 0
    total = 0
    do p = 1, n_rule
      t = kinematics%reference(p) * tau(:, p)
      if (is_mean_dilatation) then
        pressure = (t(1) + t(2) + t(3)) / 3
        t(:3) = t(:3) - pressure
        total = total + pressure
      end if
      do a = 1, n
        f(a, 1) = f(a, 1) + t(1) * kinematics%gradient(a, 1, p) + t(4) * kinematics%gradient(a, 2, p) &
          + t(6) * kinematics%gradient(a, 3, p)
        f(a, 2) = f(a, 2) + t(4) * kinematics%gradient(a, 1, p) + t(2) * kinematics%gradient(a, 2, p) &
          + t(5) * kinematics%gradient(a, 3, p)
        f(a, 3) = f(a, 3) + t(6) * kinematics%gradient(a, 1, p) + t(5) * kinematics%gradient(a, 2, p) &
          + t(3) * kinematics%gradient(a, 3, p)
      end do
    end do
    if (is_mean_dilatation) f(:n, :) = f(:n, :) + total * kinematics%mean(:n, :)
    force(:, :n) = force(:, :n) + transpose(f(:n, :))
  end subroutine integrate_forces


  !> The tangent: sum over the points of B^T c B + (g . tau g) 1; the terms of the mean dilatation are folded into c
  !! and tau but for three products of vectors of the element.
  pure subroutine integrate_stiffness(n, n_rule, is_mean_dilatation, kinematics, tau, tangent, stiffness)
    integer, intent(in) :: n, n_rule               !< nodes, points
    logical, intent(in) :: is_mean_dilatation
    type(kinematics_type), intent(in) :: kinematics
    real(DP), intent(inout) :: tau(6, MAX_ELEMENT_POINTS)  !< Kirchhoff stress, zero at small strain; spoiled [stress]
    real(DP), intent(inout) :: tangent(6, 6, MAX_ELEMENT_POINTS)   !< spoiled [stress]
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< set up to 3 n
    real(DP) :: remainder(MAX_ELEMENT_NODES, 3), factor, m(MAX_ELEMENT_NODES, 3, MAX_ELEMENT_POINTS), block(MAX_ELEMENT_NODES, &
      MAX_ELEMENT_NODES)
    integer :: p, b, i, j
    factor = 0
    if (is_mean_dilatation) then
      call fold_mean_dilatation(n, n_rule, kinematics, tau, tangent, remainder, factor)
    else
      do p = 1, n_rule
        tangent(:, :, p) = kinematics%reference(p) * tangent(:, :, p)
        tau(:, p) = kinematics%reference(p) * tau(:, p)
      end do
    end if
    do j = 1, 3
      do i = j, 3
        call multiply_gradients(n, n_rule, i, j, kinematics%gradient, tau, tangent, m)
        block(:n, :n) = 0
        do p = 1, n_rule
          call add_product(n, kinematics%gradient(:, :, p), m(:, :, p), block)
        end do
        do b = 1, n
          if (is_mean_dilatation) block(:n, b) = block(:n, b) + kinematics%mean(b, j) * remainder(:n, i) &
            + (remainder(b, j) + factor * kinematics%mean(b, j)) * kinematics%mean(:n, i)
        end do
        call scatter_block(n, i, j, block, stiffness)
      end do
    end do
  end subroutine integrate_stiffness


  !> m_bk = (c_ikjl + tau_kl delta_ij) g_bl at all points, for one pair of directions.
  pure subroutine multiply_gradients(n, n_rule, i, j, g, tau, tangent, m)
    integer, intent(in) :: n, n_rule, i, j
    real(DP), intent(in) :: g(MAX_ELEMENT_NODES, 3, MAX_ELEMENT_POINTS), tau(6, MAX_ELEMENT_POINTS), tangent(6, 6, &
      MAX_ELEMENT_POINTS)
    real(DP), intent(out) :: m(MAX_ELEMENT_NODES, 3, MAX_ELEMENT_POINTS)
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
    real(DP), intent(in) :: g(MAX_ELEMENT_NODES, 3), m(MAX_ELEMENT_NODES, 3)
    real(DP), intent(inout) :: block(MAX_ELEMENT_NODES, MAX_ELEMENT_NODES)
    integer :: a, b
    do b = 1, n
      do a = 1, n
        block(a, b) = block(a, b) + g(a, 1) * m(b, 1) + g(a, 2) * m(b, 2) + g(a, 3) * m(b, 3)
      end do
    end do
  end subroutine add_product


  !> Writes the block of the directions (i, j), i >= j, and its mirror image: the matrix is symmetric to the last bit.
  pure subroutine scatter_block(n, i, j, block, stiffness)
    integer, intent(in) :: n, i, j
    real(DP), intent(in) :: block(MAX_ELEMENT_NODES, MAX_ELEMENT_NODES)
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    integer :: a, b
    do b = 1, n
      do a = merge(b, 1, i == j), n
        stiffness(3 * a - 3 + i, 3 * b - 3 + j) = block(a, b)
        stiffness(3 * b - 3 + j, 3 * a - 3 + i) = block(a, b)
      end do
    end do
  end subroutine scatter_block


  !> Adds the terms of the mean dilatation to tangent and stress (both times the volumes), and returns the rest:
  !! remainder r and factor k of  gbar r^T + r gbar^T + k gbar gbar^T.
  !! Derivation: doc/theory/elements.md, section "Mean dilatation: the tangent".
  pure subroutine fold_mean_dilatation(n, n_rule, kinematics, tau, tangent, remainder, factor)
    integer, intent(in) :: n, n_rule               !< nodes, points
    type(kinematics_type), intent(in) :: kinematics
    real(DP), intent(inout) :: tau(6, MAX_ELEMENT_POINTS), tangent(6, 6, MAX_ELEMENT_POINTS)
    real(DP), intent(out) :: remainder(MAX_ELEMENT_NODES, 3), factor
    real(DP), parameter :: TWICE_SYMMETRIC(6) = [real(DP) :: 2, 2, 2, 1, 1, 1]
    real(DP) :: total, pressure, q(6), beta, omega, dilatation, w
    integer :: p, i, a
    total = 0
    do p = 1, n_rule
      total = total + kinematics%reference(p) * (tau(1, p) + tau(2, p) + tau(3, p)) / 3
    end do
    remainder(:n, :) = 0
    factor = -total
    do p = 1, n_rule
      w = kinematics%reference(p)
      pressure = (tau(1, p) + tau(2, p) + tau(3, p)) / 3
      dilatation = total * kinematics%current(p) / sum(kinematics%current(:n_rule))
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
        associate (g => kinematics%gradient(a, :, p))
          remainder(a, 1) = remainder(a, 1) + q(1) * g(1) + q(4) * g(2) + q(6) * g(3)
          remainder(a, 2) = remainder(a, 2) + q(4) * g(1) + q(2) * g(2) + q(5) * g(3)
          remainder(a, 3) = remainder(a, 3) + q(6) * g(1) + q(5) * g(2) + q(3) * g(3)
        end associate
      end do
    end do
  end subroutine fold_mean_dilatation

end module amontons_solid_elements
