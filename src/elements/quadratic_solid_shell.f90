!> The solid shell of S6: the quadratic wedge C3D15 with assumed natural strains against shear, membrane and thickness locking.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The strains are Green's, or their linear part at small strain, in natural coordinates, as in module solid_shell. At each of the
!! three heights of the points they are interpolated over the triangle from other places:
!!
!! | strain | form | places |
!! |---|---|---|
!! | 11, 22 and that along the third edge | linear | two on the edge along it, one inside (Lee, Bathe: MITC6) |
!! | 13, 23 | linear, and s (d r + e s), -r (d r + e s) | along the edge at two places of each, both in the middle (MITC6) |
!! | 33 | quadratic | the six fibres |
!!
!! The law is that of solids, at the deformation gradient R U: U^2 = 1 + 2 E, R the rotation of the displacements.
!!
!! Reference: P.-S. Lee, K.-J. Bathe, Development of MITC isotropic triangular shell finite elements, Comput. Struct. 82 (2004)
!! 945-962.
module amontons_quadratic_solid_shell
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_element_integration_points, only: integration_points_type, set_point_input, ELEMENT_OK, ELEMENT_NOT_FINITE, &
    ELEMENT_DEGENERATE
  use amontons_kinds, only: DP
  use amontons_logarithmic_strain, only: voigt_transformation
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: material_type
  use amontons_shape_functions, only: shape_functions, quadrature
  use amontons_solid_shell, only: find_rotation, evaluate_stress_of_strain, natural_strain
  use amontons_tensor, only: invert
  use amontons_element_kinds, only: KIND_C3D15, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  implicit none
  private
  public :: evaluate_quadratic_solid_shell

  integer, parameter :: N_NODES = 15, N_DOF = 3 * N_NODES, N_WEDGE_POINTS = 9, N_HEIGHTS = 3
  integer, parameter :: N_PLACES = 16              !< of strains, at each height
  integer, parameter :: N_SAMPLES = 31             !< strains there
  real(DP), parameter :: NEAR = 0.5_DP - sqrt(3.0_DP) / 6, FAR = 0.5_DP + sqrt(3.0_DP) / 6, OPPOSITE = sqrt(3.0_DP) / 3, &
    THIRD = 1.0_DP / 3, MIDDLE = 0.5_DP
  real(DP), parameter :: PLACES(2, N_PLACES) = reshape([NEAR, 0.0_DP, FAR, 0.0_DP, NEAR, OPPOSITE, 0.0_DP, NEAR, 0.0_DP, FAR, &
    OPPOSITE, NEAR, NEAR, FAR, FAR, NEAR, NEAR, NEAR, THIRD, THIRD, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, &
    MIDDLE, 0.0_DP, MIDDLE, MIDDLE, 0.0_DP, MIDDLE], [2, N_PLACES])
  integer, parameter :: PLACE_OF(N_SAMPLES) = [1, 2, 3, 4, 5, 6, 7, 8, 9, 7, 8, 9, 7, 8, 9, 1, 2, 4, 5, 7, 8, 7, 8, 10, 10, &
    11, 12, 13, 14, 15, 16]
  integer, parameter :: PAIRS(2, N_SAMPLES) = reshape([1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, &
    1, 2, 1, 2, 1, 2, 1, 3, 1, 3, 2, 3, 2, 3, 1, 3, 1, 3, 2, 3, 2, 3, 1, 3, 2, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3], &
    [2, N_SAMPLES])

  !> An element and its strains at given displacements.
  type :: wedge_type
    real(DP) :: slope(3, N_NODES, N_PLACES, N_HEIGHTS)     !< derivatives of the shape functions at the places [-]
    real(DP) :: weight(N_SAMPLES, 6, N_WEDGE_POINTS)     !< parts of the samples in the strains at the points, Voigt order [-]
    integer :: height(N_WEDGE_POINTS)                    !< of the points
    real(DP) :: to_cartesian(6, 6, N_WEDGE_POINTS)     !< natural strains to those of global axes, engineering shears [1/length^2]
    real(DP) :: volume(N_WEDGE_POINTS)                   !< [length^3]
    real(DP) :: strain(6, N_WEDGE_POINTS)                !< global axes, engineering shears [-]
    real(DP) :: B(N_DOF, 6, N_WEDGE_POINTS)              !< its derivatives by the displacements [1/length]
    real(DP) :: turn(3, 3, N_WEDGE_POINTS)               !< R - 1 [-]
  end type wedge_type

contains

  !> Internal force, point values and, if requested, the tangent.
  pure subroutine evaluate_quadratic_solid_shell(material, X, u, is_nlgeom, force, points, status, stiffness)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, 15) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, 15) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< [force]
    type(integration_points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u [force/length]
    type(wedge_type) :: wedge
    real(DP) :: S(6, N_WEDGE_POINTS), C(6, 6, N_WEDGE_POINTS)
    integer :: p
    force = 0
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u(:, :N_NODES)))) return
    call set_strains(X, u, is_nlgeom, wedge, status)
    if (status /= ELEMENT_OK) return
    call evaluate_stresses(material, is_nlgeom, wedge, points, S, C, status)
    if (status /= ELEMENT_OK) return
    do p = 1, N_WEDGE_POINTS
      force(:, :N_NODES) = force(:, :N_NODES) + wedge%volume(p) * reshape(matmul(wedge%B(:, :, p), S(:, p)), [3, N_NODES])
    end do
    if (.not. present(stiffness)) return
    call integrate_stiffness(wedge, C, .not. allocated(points%skew), stiffness)
    if (is_nlgeom) call add_geometric_stiffness(wedge, S, stiffness)
  end subroutine evaluate_quadratic_solid_shell


  !> The assumed strains at the points, their derivatives, and the rotations.
  pure subroutine set_strains(X, u, is_nlgeom, wedge, status)
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    type(wedge_type), intent(out) :: wedge
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), heights(N_HEIGHTS), slope(3, N_NODES), base(3, 3), dual(3, 3)
    real(DP) :: det
    real(DP) :: value(N_SAMPLES, N_HEIGHTS), row(N_DOF, N_SAMPLES, N_HEIGHTS), natural(6), d(N_DOF, 6)
    integer :: n, p, m, k
    call quadrature(KIND_C3D15, n, xi, w)
    heights = [minval(xi(3, :n)), 0.0_DP, maxval(xi(3, :n))]
    do k = 1, N_HEIGHTS
      call sample_strains(X, u, is_nlgeom, heights(k), wedge%slope(:, :, :, k), value(:, k), row(:, :, k))
    end do
    do p = 1, N_WEDGE_POINTS
      slope = slopes_at(xi(:, p))
      base = relative_slopes(X, slope)
      call invert(base, dual, det)
      status = ELEMENT_DEGENERATE
      if (.not. det > 0) return
      wedge%volume(p) = w(p) * det
      wedge%to_cartesian(:, :, p) = transpose(voigt_transformation(dual))
      if (is_nlgeom) then
        call find_rotation(matmul(relative_slopes(u, slope), dual), wedge%turn(:, :, p), status)
        if (status /= ELEMENT_OK) return
      end if
      k = minloc(abs(heights - xi(3, p)), dim=1)
      wedge%height(p) = k
      wedge%weight(:, :, p) = sample_weights(xi(1, p), xi(2, p))
      natural = 0
      d = 0
      do n = 1, 6
        do m = 1, N_SAMPLES
          if (.not. abs(wedge%weight(m, n, p)) > 0) cycle
          natural(n) = natural(n) + wedge%weight(m, n, p) * value(m, k)
          d(:, n) = d(:, n) + wedge%weight(m, n, p) * row(:, m, k)
        end do
      end do
      wedge%strain(:, p) = matmul(wedge%to_cartesian(:, :, p), natural)
      wedge%B(:, :, p) = matmul(d, transpose(wedge%to_cartesian(:, :, p)))
    end do
    status = ELEMENT_OK
  end subroutine set_strains


  !> The strains at the places of a height.
  pure subroutine sample_strains(X, u, is_nlgeom, height, slope, value, row)
    real(DP), intent(in) :: X(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: height                 !< third natural coordinate [-]
    real(DP), intent(out) :: slope(3, N_NODES, N_PLACES)
    real(DP), intent(out) :: value(N_SAMPLES)      !< twice the strain for two different indices [length^2]
    real(DP), intent(out) :: row(N_DOF, N_SAMPLES) !< derivatives by the displacements [length]
    real(DP) :: base(3, 3, N_PLACES), v(3, 3, N_PLACES)
    integer :: k, m
    do k = 1, N_PLACES
      slope(:, :, k) = slopes_at([PLACES(:, k), height])
      base(:, :, k) = relative_slopes(X, slope(:, :, k))
      v(:, :, k) = relative_slopes(u, slope(:, :, k))
    end do
    do m = 1, N_SAMPLES
      k = PLACE_OF(m)
      call natural_strain(PAIRS(1, m), PAIRS(2, m), slope(:, :, k), base(:, :, k), v(:, :, k), is_nlgeom, value(m), row(:, m))
    end do
  end subroutine sample_strains


  !> Derivatives of the shape functions at a place.
  pure function slopes_at(xi) result(slope)
    real(DP), intent(in) :: xi(3)
    real(DP) :: slope(3, N_NODES)
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    call shape_functions(KIND_C3D15, xi, N, dN)
    slope = dN(:, :N_NODES)
  end function slopes_at


  !> The derivatives of a field by the natural coordinates, in columns; a uniform field gives exactly zero.
  pure function relative_slopes(values, slope) result(base)
    real(DP), intent(in) :: values(:, :), slope(3, N_NODES)
    real(DP) :: base(3, 3)
    integer :: a, i
    base = 0
    do a = 2, N_NODES
      do i = 1, 3
        base(:, i) = base(:, i) + slope(i, a) * (values(:, a) - values(:, 1))
      end do
    end do
  end function relative_slopes


  !> The parts of the samples in the strains at a place of the triangle.
  !!
  !! 12 is that of 11, 22 and the strain 11 + 22 - 12 along the third edge.
  pure function sample_weights(r, s) result(weight)
    real(DP), intent(in) :: r, s
    real(DP) :: weight(N_SAMPLES, 6)
    real(DP) :: t
    t = 1 - r - s
    weight = 0
    weight(1:3, 1) = linear_weights(PLACES(:, 1:3), [r, s])
    weight(4:6, 2) = linear_weights(PLACES(:, 4:6), [r, s])
    weight(7:9, 4) = -linear_weights(PLACES(:, 7:9), [r, s])
    weight(10:12, 4) = weight(7:9, 4)
    weight(13:15, 4) = -weight(7:9, 4)
    weight(1:6, 4) = weight(1:6, 1) + weight(1:6, 2)
    call set_shear_weights(r, s, weight(:, 6), weight(:, 5))
    weight(26:31, 3) = [t * (2 * t - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * t * r, 4 * r * s, 4 * s * t]
  end function sample_weights


  !> The parts of three places in a linear field.
  pure function linear_weights(place, at) result(weight)
    real(DP), intent(in) :: place(2, 3), at(2)
    real(DP) :: weight(3)
    real(DP) :: a(2), b(2), c(2), det
    a = place(:, 2) - place(:, 1)
    b = place(:, 3) - place(:, 1)
    c = at - place(:, 1)
    det = a(1) * b(2) - a(2) * b(1)
    weight(2) = (c(1) * b(2) - c(2) * b(1)) / det
    weight(3) = (a(1) * c(2) - a(2) * c(1)) / det
    weight(1) = 1 - weight(2) - weight(3)
  end function linear_weights


  !> Those of 13 = a_1 + b_1 r + c_1 s + s (d r + e s) and 23 = a_2 + b_2 r + c_2 s - r (d r + e s): along an edge they are linear.
  pure subroutine set_shear_weights(r, s, w13, w23)
    real(DP), intent(in) :: r, s
    real(DP), intent(out) :: w13(N_SAMPLES), w23(N_SAMPLES)
    real(DP), dimension(N_SAMPLES) :: a1, b1, a2, c2, before, behind, beta, gamma_, p, q, d, e
    integer :: k
    b1 = sqrt(3.0_DP) * (unit(17) - unit(16))
    a1 = MIDDLE * (unit(16) + unit(17) - b1)
    c2 = sqrt(3.0_DP) * (unit(19) - unit(18))
    a2 = MIDDLE * (unit(18) + unit(19) - c2)
    d = MIDDLE * (unit(22) - unit(20) + unit(23) - unit(21))             ! along the third edge: mean and half of the slope
    e = MIDDLE * sqrt(3.0_DP) * (unit(23) - unit(21) - unit(22) + unit(20))
    before = d - e                                 ! at its ends, where s = 1 and where r = 1
    behind = d + e
    beta = behind - (a2 - a1) + b1                 ! b_2 - d
    gamma_ = c2 - (before - (a2 - a1))             ! c_1 + e
    p = 9 * (unit(24) - a1 - THIRD * (b1 + gamma_))
    q = 9 * (unit(25) - a2 - THIRD * (beta + c2))
    d = THIRD * (2 * q - p)
    e = THIRD * (q - 2 * p)
    w13 = a1 + r * b1 + s * (gamma_ - e) + s * (r * d + s * e)
    w23 = a2 + r * (beta + d) + s * c2 - r * (r * d + s * e)

  contains

    !> A sample by itself.
    pure function unit(m)
      integer, intent(in) :: m
      real(DP) :: unit(N_SAMPLES)
      unit = [(merge(1.0_DP, 0.0_DP, k == m), k=1, N_SAMPLES)]
    end function unit

  end subroutine set_shear_weights


  !> Second Piola-Kirchhoff stresses and their derivatives by Green's strain at all points.
  pure subroutine evaluate_stresses(material, is_nlgeom, wedge, points, S, C, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(wedge_type), intent(in) :: wedge
    type(integration_points_type), intent(inout) :: points
    real(DP), intent(out) :: S(6, N_WEDGE_POINTS), C(6, 6, N_WEDGE_POINTS)     !< engineering shears [stress]
    integer, intent(out) :: status                 !< ELEMENT_...
    type(material_point_type) :: point
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    integer :: p, n_rule
    call quadrature(KIND_C3D15, n_rule, xi, w)
    do p = 1, N_WEDGE_POINTS
      call shape_functions(KIND_C3D15, xi(:, p), N, dN)
      call set_point_input(material, points, p, N(:N_NODES), point)
      call evaluate_stress_of_strain(material, is_nlgeom, wedge%strain(:, p), wedge%turn(:, :, p), p, point, points, status)
      if (status /= ELEMENT_OK) return
      points%volume(p) = wedge%volume(p)
      S(:, p) = point%stress
      C(:, :, p) = point%tangent
    end do
  end subroutine evaluate_stresses


  !> The stiffness of the strains.
  pure subroutine integrate_stiffness(wedge, C, is_symmetric, K)
    type(wedge_type), intent(in) :: wedge
    real(DP), intent(in) :: C(6, 6, N_WEDGE_POINTS)      !< [stress]
    logical, intent(in) :: is_symmetric            !< then it is so to the last bit
    real(DP), intent(inout) :: K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< set up to 45
    integer :: p, j
    K(:N_DOF, :N_DOF) = 0
    do p = 1, N_WEDGE_POINTS
      K(:N_DOF, :N_DOF) = K(:N_DOF, :N_DOF) + matmul(wedge%B(:, :, p), wedge%volume(p) * matmul(C(:, :, p), &
        transpose(wedge%B(:, :, p))))
    end do
    if (.not. is_symmetric) return
    do j = 1, N_DOF
      K(j, j + 1:N_DOF) = K(j + 1:N_DOF, j)
    end do
  end subroutine integrate_stiffness


  !> The stiffness of the stresses: sum of S^ij d2 E_ij, summed at the places of the strains.
  pure subroutine add_geometric_stiffness(wedge, S, K)
    type(wedge_type), intent(in) :: wedge
    real(DP), intent(in) :: S(6, N_WEDGE_POINTS)         !< [stress]
    real(DP), intent(inout) :: K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: sampled(N_SAMPLES, N_HEIGHTS), block(N_NODES, N_NODES), factor
    integer :: p, m, l, a, b, i
    sampled = 0
    do p = 1, N_WEDGE_POINTS
      sampled(:, wedge%height(p)) = sampled(:, wedge%height(p)) + matmul(wedge%weight(:, :, p), wedge%volume(p) * &
        matmul(S(:, p), wedge%to_cartesian(:, :, p)))
    end do
    block = 0
    do l = 1, N_HEIGHTS
      do m = 1, N_SAMPLES
        factor = merge(0.5_DP, 1.0_DP, PAIRS(1, m) == PAIRS(2, m)) * sampled(m, l)
        associate (first => wedge%slope(PAIRS(1, m), :, PLACE_OF(m), l), second => wedge%slope(PAIRS(2, m), :, PLACE_OF(m), l))
          do b = 1, N_NODES
            block(:, b) = block(:, b) + factor * (first * second(b) + second * first(b))
          end do
        end associate
      end do
    end do
    do b = 1, N_NODES
      do a = 1, N_NODES
        do i = -2, 0
          K(3 * a + i, 3 * b + i) = K(3 * a + i, 3 * b + i) + block(a, b)
        end do
      end do
    end do
  end subroutine add_geometric_stiffness

end module amontons_quadratic_solid_shell
