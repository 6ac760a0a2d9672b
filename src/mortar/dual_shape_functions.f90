!> Biorthogonal (dual) shape functions on the covered part of a slave facet, with the transformed basis of quadratic faces.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 7. The corner functions of quadratic faces have zero or negative integrals, so their dual
!! functions give no admissible pressure. Their basis is therefore transformed (A. Popp, B. Wohlmuth, M. Gee, W. Wall, SIAM J. Sci.
!! Comput. 34 (2012) B421-B446): a corner takes alpha of each adjacent mid-side function, a mid-side keeps the rest,
!!
!!     N~_corner = N_corner + alpha (N_mid + N_mid'),    N~_mid = (1 - 2 alpha) N_mid,    alpha = 1/5,
!!
!! all with positive integrals. sum N~_j x^_j is the same surface with x^_corner = x_corner and
!! x^_mid = (x_mid - alpha (x_a + x_b))/(1 - 2 alpha).
module amontons_dual_shape_functions
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: facet_kind, facet_kind_type, FACET_TRI3, FACET_TRI6, FACET_QUAD4, FACET_QUAD8, &
    FACET_LINE2, FACET_LINE3, MAX_FACE_NODES
  use amontons_dense, only: invert_small, DENSE_OK
  implicit none
  private
  public :: is_transformed, find_full_dual_fraction, transform_shape_functions, transform_nodal_positions, &
    nodal_integral_fractions, evaluate_dual_functions
  public :: BASIS_ALPHA

  real(DP), parameter :: BASIS_ALPHA = 0.2_DP            !< of the transformation of quadratic faces [-]
  !> Covered fraction from which the dual functions are fully biorthogonal, over MIN_DUAL_COVER, by kind [-].
  real(DP), parameter :: FULL_COVER_FACTOR(6) = [2.0_DP, 2.0_DP, 1.2_DP, 1.2_DP, 2.0_DP, 2.0_DP]
  !> Least covered fraction of a facet for biorthogonal functions, by kind [-].
  real(DP), parameter :: MIN_DUAL_COVER(6) = [0.0_DP, 0.05_DP, 0.25_DP, 0.25_DP, 0.0_DP, 0.1_DP]

contains

  !> Whether the basis of a facet kind is transformed: quadratic faces, but not lines, whose functions have positive integrals.
  elemental logical function is_transformed(kind)
    integer, intent(in) :: kind                    !< FACET_...
    is_transformed = kind == FACET_TRI6 .or. kind == FACET_QUAD8
  end function is_transformed


  !> The weight of the biorthogonal functions; those of the linear basis have the rest. It is 0 where too little of a facet is
  !! covered and rises continuously to 1 with the covered fraction.
  pure subroutine find_full_dual_fraction(kind, covered_fraction, full_fraction, slope)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: covered_fraction                  !< covered area over that of the facet [-]
    real(DP), intent(out) :: full_fraction                  !< [-]
    real(DP), intent(out) :: slope                 !< d weight/d cover [-]
    real(DP) :: t
    full_fraction = 1.0_DP
    slope = 0.0_DP
    if (covered_fraction >= FULL_COVER_FACTOR(kind) * MIN_DUAL_COVER(kind)) return
    t = max((covered_fraction / MIN_DUAL_COVER(kind) - 1) / (FULL_COVER_FACTOR(kind) - 1), 0.0_DP)
    full_fraction = t**2 * (3 - 2 * t)
    slope = 6 * t * (1 - t) / ((FULL_COVER_FACTOR(kind) - 1) * MIN_DUAL_COVER(kind))
  end subroutine find_full_dual_fraction


  !> Transforms the functions of a facet.
  pure subroutine transform_shape_functions(kind, N)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(inout) :: N(MAX_FACE_NODES)   !< in: N_j; out: N~_j [-]
    type(facet_kind_type) :: shape
    real(DP) :: mid(4)
    integer :: m
    if (.not. is_transformed(kind)) return
    shape = facet_kind(kind)
    m = shape%n_corners
    mid(:m) = N(m + 1:2 * m)
    N(:m) = N(:m) + BASIS_ALPHA * (mid(:m) + cshift(mid(:m), -1))
    N(m + 1:2 * m) = (1 - 2 * BASIS_ALPHA) * mid(:m)
  end subroutine transform_shape_functions


  !> The nodes x^_j of the transformed functions.
  pure subroutine transform_nodal_positions(kind, x)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(inout) :: x(:, :)             !< (:, n) in: x_j; out: x^_j [length]
    type(facet_kind_type) :: shape
    integer :: i, m
    if (.not. is_transformed(kind)) return
    shape = facet_kind(kind)
    m = shape%n_corners
    do i = 1, m
      x(:, m + i) = (x(:, m + i) - BASIS_ALPHA * (x(:, i) + x(:, modulo(i, m) + 1))) / (1 - 2 * BASIS_ALPHA)
    end do
  end subroutine transform_nodal_positions


  !> The integral of each N~_j over a flat whole facet, as a fraction of its area.
  pure function nodal_integral_fractions(kind) result(share)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP) :: share(MAX_FACE_NODES)              !< [-]
    share = 0.0_DP
    select case (kind)
    case (FACET_TRI3)
      share(:3) = 1.0_DP / 3
    case (FACET_QUAD4)
      share(:4) = 0.25_DP
    case (FACET_TRI6)
      share(:3) = 2 * BASIS_ALPHA / 3
      share(4:6) = (1 - 2 * BASIS_ALPHA) / 3
    case (FACET_QUAD8)
      share(:4) = (8 * BASIS_ALPHA - 1) / 12
      share(5:8) = (1 - 2 * BASIS_ALPHA) / 3
    case (FACET_LINE2)
      share(:2) = 0.5_DP
    case (FACET_LINE3)
      share(:3) = [1.0_DP, 1.0_DP, 4.0_DP] / 6
    case default
    end select
  end function nodal_integral_fractions


  !> The dual functions phi_j at the points of the integrated part of a facet, and d_j, the integral of N~_j over it.
  !!
  !! They are biorthogonal on that part: integral of phi_j N~_k = d_j delta_jk; with M = integral of N~ N~', phi = diag(d) inv(M)
  !! N~. The sum of all phi_j is 1. On a part too small for that (M is nearly singular) they are biorthogonal to linear functions of
  !! the position only: phi_j = d_j (1, y_j)' inv(G) (1, y), with G = integral of (1, y)(1, y)'; the sum is 1 again. In between they
  !! are a mean of both, by `find_full_dual_fraction`.
  subroutine evaluate_dual_functions(kind, area, at_node, weight, at, shapes, phi, d)
    integer, intent(in) :: kind                    !< FACET_...
    real(DP), intent(in) :: area                   !< of the whole facet [length^2]
    real(DP), intent(in) :: at_node(:, :)          !< (2, n) x^_j in the plane of the facet [length]
    real(DP), intent(in) :: weight(:)              !< (n_points) [length^2]
    real(DP), intent(in) :: at(:, :)               !< (2, n_points) points in the plane [length]
    real(DP), intent(in) :: shapes(:, :)           !< (n, n_points) N~_j [-]
    real(DP), intent(out) :: phi(:, :)             !< (n, n_points) [-]
    real(DP), intent(out) :: d(:)                  !< (n) [length^2]
    real(DP) :: mass(size(d), size(d)), inverse(size(d), size(d)), full_fraction, slope
    real(DP), allocatable :: affine(:, :)
    integer :: i, q, status
    mass = 0.0_DP
    do q = 1, size(weight)
      do i = 1, size(d)
        mass(:, i) = mass(:, i) + weight(q) * shapes(i, q) * shapes(:, q)
      end do
    end do
    d = matmul(shapes, weight)
    call find_full_dual_fraction(kind, sum(weight) / area, full_fraction, slope)
    status = -1
    if (full_fraction > 0.0_DP) call invert_small(mass, inverse, status)
    if (status /= DENSE_OK) then
      call evaluate_affine_duals(area, at_node, weight, at, d, phi)
      return
    end if
    do q = 1, size(weight)
      phi(:, q) = 0.0_DP
      do i = 1, size(d)
        phi(:, q) = phi(:, q) + shapes(i, q) * inverse(:, i)
      end do
      phi(:, q) = d * phi(:, q)
    end do
    if (full_fraction >= 1.0_DP) return
    allocate (affine, mold=phi)
    call evaluate_affine_duals(area, at_node, weight, at, d, affine)
    phi = full_fraction * phi + (1 - full_fraction) * affine
  end subroutine evaluate_dual_functions


  !> The functions dual to the linear functions of the position only; on a degenerate narrow part, to the constant.
  subroutine evaluate_affine_duals(area, at_node, weight, at, d, phi)
    real(DP), intent(in) :: area                   !< [length^2]
    real(DP), intent(in) :: at_node(:, :), weight(:), at(:, :), d(:)
    real(DP), intent(out) :: phi(:, :)
    real(DP) :: centre(2), y(3, size(weight)), y_node(3, size(d)), gram(3, 3), inverse(3, 3)
    integer :: i, q, status
    centre = matmul(at, weight) / sum(weight)
    y(1, :) = 1.0_DP
    y_node(1, :) = 1.0_DP
    do i = 1, 2
      y(i + 1, :) = (at(i, :) - centre(i)) / sqrt(area)
      y_node(i + 1, :) = (at_node(i, :) - centre(i)) / sqrt(area)
    end do
    gram = 0.0_DP
    do q = 1, size(weight)
      do i = 1, 3
        gram(:, i) = gram(:, i) + weight(q) * y(i, q) * y(:, q)
      end do
    end do
    call invert_small(gram, inverse, status)
    if (status == DENSE_OK) then
      phi = spread(d, 2, size(weight)) * matmul(transpose(y_node), matmul(inverse, y))
    else
      phi = spread(d / sum(weight), 2, size(weight))
    end if
  end subroutine evaluate_affine_duals

end module amontons_dual_shape_functions
