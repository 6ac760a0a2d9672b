!> Membranes in space: plane stress in the surface, no bending.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! At each point the surface has a reference frame (e1, e2, n). With the gradients f_i = dx/dX_i of the position by lengths along
!! e1 and e2, the energy per volume is that of plane stress under C_ij = f_i . f_j. The law gets the triangular F with F^T F = C, in
!! the current frame t1 = f1/|f1|, t2 across it in the surface; its stress tau_kl in this frame gives
!!
!!     force_a = sum of V tau_kl dN_a/dx_l t_k,      dforce_a/dx_b = sum of V (B_a^T c B_b + (dN_a/dx . tau dN_b/dx) 1)
!!
!! with B of the displacements along t1 and t2, and the second term for all three. It holds a membrane across its surface: one
!! without tension has no stiffness there. Small displacements: e1, e2 in place of t1, t2, without the second term. The
!! thickness changes by the law. Stresses and strains are written in global axes.
!! Theory: doc/theory/elements.md, section "Membranes".
module amontons_membrane_elements
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_zero_stress_condition, only: solve_zero_stress, CONDITION_PLANE_STRESS
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: material_type
  use amontons_element_integration_points, only: integration_points_type, set_point_input, store_point_output, &
    split_unsymmetric_tangent, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_shape_functions, only: shape_functions, quadrature, spread_body_force
  use amontons_elasticity, only: STRESS_OK, STRESS_INVERTED, MAX_DISPLACEMENT_GRADIENT
  use amontons_tensor, only: IDENTITY, cross_product, pack_voigt, unpack_voigt
  use amontons_element_kinds, only: KIND_M3D6, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  implicit none
  private
  public :: evaluate_membrane_element, evaluate_membrane_volumes, integrate_membrane_body_force, set_membrane_temperature_weights, &
    set_surface_axes

  integer, parameter :: MAX_MEMBRANE_NODES = 8               !< most nodes
  integer, parameter :: IN_PLANE(3) = [1, 2, 4]              !< 11 22 12 among the six components
  real(DP), parameter :: TOL_ALONG_NORMAL = 1.745e-3_DP      !< sine of 0.1 degrees: x lies along the normal, z is projected [-]

contains

  !> Internal force, point values and, if requested, the tangent of a membrane.
  pure subroutine evaluate_membrane_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_M3D...
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< [force]
    type(integration_points_type), intent(inout) :: points     !< in: thickness, the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u [force/length]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), &
      slope(MAX_MEMBRANE_NODES, 2), frame(3, 3), axes(3, 2), direction(3)
    type(material_point_type) :: point
    integer :: m, p, n
    n = size(X, 2)
    force = 0
    if (present(stiffness)) stiffness(:3 * n, :3 * n) = 0
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u(:, :n)))) return
    weight = 0
    call set_membrane_temperature_weights(kind, weight)
    call quadrature(kind, m, xi, w)
    do p = 1, m
      direction = [1.0_DP, 0.0_DP, 0.0_DP]
      if (.not. material%is_linear_isotropic) then
        if (points%has_frame) direction = points%frame(:, 1, p)
      end if
      call set_reference(kind, X, xi(:, p), direction, frame, slope, points%volume(p), status)
      if (status /= ELEMENT_OK) return
      points%volume(p) = w(p) * points%volume(p) * points%section_value
      call set_point_input(material, points, p, weight(:n, p), point)
      point%frame = IDENTITY                       ! the axes of the material are those of the point
      call set_kinematics(X, u, is_nlgeom, frame, slope, axes, point%H, status)
      if (status /= ELEMENT_OK) return
      call solve_zero_stress(CONDITION_PLANE_STRESS, material, is_nlgeom, point, status)
      if (status /= STRESS_OK) then
        status = merge(ELEMENT_INVERTED, ELEMENT_NOT_FINITE, status == STRESS_INVERTED)
        return
      end if
      call split_unsymmetric_tangent(material, point, points, p)
      call store_point_output(material, is_nlgeom, point, points, p)
      call turn_output(axes, points%stress(:, p))
      call turn_output(axes, points%strain(:, p))
      call add_forces(n, points%volume(p), point, axes, slope, force)
      if (present(stiffness)) call add_stiffness(n, points%volume(p), is_nlgeom, point, axes, slope, stiffness)
    end do
    if (allocated(points%skew)) deallocate (points%skew)   ! the symmetric part is used alone
    status = ELEMENT_OK
  end subroutine evaluate_membrane_element


  !> The reference frame of a point, the derivatives of the shape functions by lengths along its first two axes, and the area that
  !! belongs to a weight of 1. An orientation gives the first axis, else the projection of x, or z where x is along the normal.
  pure subroutine set_reference(kind, X, xi, direction, frame, slope, area, status)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :)
    real(DP), intent(in) :: xi(3)
    real(DP), intent(in) :: direction(3)           !< projected on the surface it is the first axis
    real(DP), intent(out) :: frame(3, 3)           !< e1, e2, normal in columns
    real(DP), intent(out) :: slope(MAX_MEMBRANE_NODES, 2)   !< [1/length]
    real(DP), intent(out) :: area                  !< [length^2]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), along(3, 2)
    integer :: k
    call shape_functions(kind, xi, N, dN)
    along = 0
    do k = 2, size(X, 2)
      along(:, 1) = along(:, 1) + (X(:, k) - X(:, 1)) * dN(1, k)
      along(:, 2) = along(:, 2) + (X(:, k) - X(:, 1)) * dN(2, k)
    end do
    call set_surface_axes(along, dN(:2, :MAX_MEMBRANE_NODES), direction, frame, slope, area, status)
  end subroutine set_reference


  !> The frame of a surface at a point from its tangents, and derivatives of shape functions by lengths along its first two axes.
  !! The first axis is the projection of a direction, or of z where that is along the normal.
  pure subroutine set_surface_axes(along, dN, direction, frame, slope, area, status)
    real(DP), intent(in) :: along(3, 2)            !< tangents by the natural coordinates [length]
    real(DP), intent(in) :: dN(:, :)               !< (2, nodes) derivatives by the natural coordinates [-]
    real(DP), intent(in) :: direction(3)           !< of length 1
    real(DP), intent(out) :: frame(3, 3)           !< e1, e2, normal in columns
    real(DP), intent(out) :: slope(:, :)           !< (nodes, 2) [1/length]
    real(DP), intent(out) :: area                  !< that belongs to a weight of 1 [length^2]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: J(2, 2), det
    frame(:, 3) = cross_product(along(:, 1), along(:, 2))
    area = norm2(frame(:, 3))
    status = ELEMENT_DEGENERATE
    frame(:, :2) = 0
    slope = 0
    if (.not. area > 0) return
    frame(:, 3) = frame(:, 3) / area
    frame(:, 1) = direction
    if (norm2(cross_product(frame(:, 1), frame(:, 3))) < TOL_ALONG_NORMAL) frame(:, 1) = [0.0_DP, 0.0_DP, 1.0_DP]
    frame(:, 1) = frame(:, 1) - dot_product(frame(:, 1), frame(:, 3)) * frame(:, 3)
    if (.not. norm2(frame(:, 1)) > 0) return
    frame(:, 1) = frame(:, 1) / norm2(frame(:, 1))
    frame(:, 2) = cross_product(frame(:, 3), frame(:, 1))
    status = ELEMENT_OK
    J = matmul(transpose(frame(:, :2)), along)     ! dX_i/dxi_k
    det = J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)
    slope(:, 1) = (dN(1, :) * J(2, 2) - dN(2, :) * J(2, 1)) / det
    slope(:, 2) = (dN(2, :) * J(1, 1) - dN(1, :) * J(1, 2)) / det
  end subroutine set_surface_axes


  !> The axes in which the law is evaluated, its displacement gradient, and the derivatives of the shape functions in these axes.
  pure subroutine set_kinematics(X, u, is_nlgeom, frame, slope, axes, H, status)
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: frame(3, 3)
    real(DP), intent(inout) :: slope(MAX_MEMBRANE_NODES, 2)   !< in: by reference lengths; out: under NLGEOM by current ones
    real(DP), intent(out) :: axes(3, 2)
    real(DP), intent(out) :: H(3, 3)               !< [-]
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP) :: f(3, 2), change(3, 2), first(MAX_MEMBRANE_NODES)
    integer :: k, n
    n = size(X, 2)
    change = 0
    do k = 2, n
      change(:, 1) = change(:, 1) + (u(:, k) - u(:, 1)) * slope(k, 1)
      change(:, 2) = change(:, 2) + (u(:, k) - u(:, 1)) * slope(k, 2)
    end do
    H = 0
    axes = frame(:, :2)
    status = ELEMENT_OK
    if (.not. is_nlgeom) then
      H(:2, :2) = matmul(transpose(axes), change)
      return
    end if
    status = ELEMENT_NOT_FINITE
    if (.not. all(abs(change) <= MAX_DISPLACEMENT_GRADIENT)) return
    status = ELEMENT_INVERTED
    f = frame(:, :2) + change
    if (.not. norm2(f(:, 1)) > 0) return
    axes(:, 1) = f(:, 1) / norm2(f(:, 1))
    axes(:, 2) = f(:, 2) - dot_product(f(:, 2), axes(:, 1)) * axes(:, 1)
    if (.not. norm2(axes(:, 2)) > 0) return
    axes(:, 2) = axes(:, 2) / norm2(axes(:, 2))
    status = ELEMENT_OK
    H(1, 1) = dot_product(change(:, 1), 2 * frame(:, 1) + change(:, 1)) / (1 + norm2(f(:, 1)))   ! |f1| - 1 without cancellation
    H(1, 2) = dot_product(axes(:, 1), f(:, 2))
    H(2, 2) = (dot_product(change(:, 2), 2 * frame(:, 2) + change(:, 2)) - H(1, 2)**2) / (1 + dot_product(axes(:, 2), f(:, 2)))
    first = slope(:, 1) / (1 + H(1, 1))
    slope(:, 2) = (slope(:, 2) - H(1, 2) * first) / (1 + H(2, 2))
    slope(:, 1) = first
  end subroutine set_kinematics


  !> A tensor in the axes of a point to global axes.
  pure subroutine turn_output(axes, tensor)
    real(DP), intent(in) :: axes(3, 2)
    real(DP), intent(inout) :: tensor(6)           !< xx yy zz xy yz xz
    real(DP) :: Q(3, 3)
    Q(:, :2) = axes
    Q(:, 3) = cross_product(axes(:, 1), axes(:, 2))
    tensor = pack_voigt(matmul(Q, matmul(unpack_voigt(tensor), transpose(Q))))
  end subroutine turn_output


  !> Adds the forces of a point.
  pure subroutine add_forces(n, volume, point, axes, slope, force)
    integer, intent(in) :: n                       !< nodes
    real(DP), intent(in) :: volume                 !< [length^3]
    type(material_point_type), intent(in) :: point
    real(DP), intent(in) :: axes(3, 2), slope(MAX_MEMBRANE_NODES, 2)
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)
    integer :: a
    associate (tau => point%stress)
      do a = 1, n
        force(:, a) = force(:, a) + volume * (axes(:, 1) * (tau(1) * slope(a, 1) + tau(4) * slope(a, 2)) + axes(:, 2) * &
          (tau(4) * slope(a, 1) + tau(2) * slope(a, 2)))
      end do
    end associate
  end subroutine add_forces


  !> Adds the stiffness of a point.
  pure subroutine add_stiffness(n, volume, is_nlgeom, point, axes, slope, stiffness)
    integer, intent(in) :: n                       !< nodes
    real(DP), intent(in) :: volume                 !< [length^3]
    logical, intent(in) :: is_nlgeom
    type(material_point_type), intent(in) :: point
    real(DP), intent(in) :: axes(3, 2), slope(MAX_MEMBRANE_NODES, 2)
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: B(3, 3, MAX_MEMBRANE_NODES), c(3, 3), tau(2, 2), block(3, 3), term
    integer :: a, bb
    c = volume * point%tangent(IN_PLANE, IN_PLANE)
    tau = volume * reshape(point%stress([1, 4, 4, 2]), [2, 2])
    do a = 1, n                                    ! rows 11, 22, 2 x 12
      B(1, :, a) = slope(a, 1) * axes(:, 1)
      B(2, :, a) = slope(a, 2) * axes(:, 2)
      B(3, :, a) = slope(a, 2) * axes(:, 1) + slope(a, 1) * axes(:, 2)
    end do
    do bb = 1, n
      do a = bb, n                                 ! one half, and its mirror image: symmetric to the last bit
        block = matmul(transpose(B(:, :, a)), matmul(c, B(:, :, bb)))
        term = 0
        if (is_nlgeom) term = dot_product(slope(a, :), matmul(tau, slope(bb, :)))
        block = block + term * IDENTITY
        if (a == bb) block = 0.5_DP * (block + transpose(block))
        associate (lower => stiffness(3 * a - 2:3 * a, 3 * bb - 2:3 * bb), upper => stiffness(3 * bb - 2:3 * bb, 3 * a - 2:3 * a))
          lower = lower + block
          if (a /= bb) upper = upper + transpose(block)
        end associate
      end do
    end do
  end subroutine add_stiffness


  !> The reference volumes of the points of a membrane.
  pure subroutine evaluate_membrane_volumes(kind, X, thickness, n, volumes, status)
    integer, intent(in) :: kind                    !< KIND_M3D...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    real(DP), intent(in) :: thickness              !< [length]
    integer, intent(out) :: n                      !< points
    real(DP), intent(inout) :: volumes(:)          !< the first n are set [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N_a(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    integer :: p
    call quadrature(kind, n, xi, w)
    do p = 1, n
      call shape_functions(kind, xi(:, p), N_a, dN)
      associate (m => size(X, 2))
        volumes(p) = w(p) * thickness * norm2(cross_product(matmul(X, dN(1, :m)), matmul(X, dN(2, :m))))
      end associate
    end do
    status = merge(ELEMENT_OK, ELEMENT_DEGENERATE, all(volumes(:n) > 0))
  end subroutine evaluate_membrane_volumes


  !> Consistent nodal forces of a body force on a membrane.
  pure subroutine integrate_membrane_body_force(kind, X, thickness, b, force)
    integer, intent(in) :: kind                    !< KIND_M3D...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: thickness              !< [length]
    real(DP), intent(in) :: b(3)                   !< [force/length^3]
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)   !< in: zero [force]
    real(DP) :: volumes(MAX_ELEMENT_POINTS)
    integer :: m, status
    volumes = 0
    call evaluate_membrane_volumes(kind, X, thickness, m, volumes, status)
    call spread_body_force(kind, size(X, 2), volumes, b, force)
  end subroutine integrate_membrane_body_force


  !> Weights of the nodal temperatures: the mean in linear elements, linear from the corners in quadratic ones.
  pure subroutine set_membrane_temperature_weights(kind, weight)
    integer, intent(in) :: kind                    !< KIND_M3D...
    real(DP), intent(inout) :: weight(:, :)        !< (MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), zero [-]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    integer :: m, p, corners
    call quadrature(kind, m, xi, w)
    corners = corner_kind(kind)
    do p = 1, m
      call shape_functions(corners, xi(:, p), N, dN)
      if (corners == kind) N = merge(1 / real(count(abs(N) > 0), DP), 0.0_DP, abs(N) > 0)
      weight(:, p) = N
    end do
  end subroutine set_membrane_temperature_weights


  !> The linear kind on the corners of a membrane.
  pure integer function corner_kind(kind)
    integer, intent(in) :: kind                    !< KIND_M3D...
    corner_kind = kind
    if (kind == KIND_M3D6) corner_kind = KIND_M3D6 - 3
    if (kind > KIND_M3D6) corner_kind = KIND_M3D6 - 2
  end function corner_kind

end module amontons_membrane_elements
