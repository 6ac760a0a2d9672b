!> Principal: logarithmic strains and their axes, and the spatial tangent of an isotropic law given in them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Voigt order xx yy zz xy yz xz, tensor components; a tangent multiplies engineering shears. Pairs of axes are ordered
!! (1, 2), (2, 3), (3, 1). Theory: doc/theory/materials.md.
module amontons_principal
  use amontons_kinds, only: DP
  use amontons_tensor, only: VOIGT_ROW, VOIGT_COLUMN, symmetric_eigen
  implicit none
  private
  public :: principal_type, find_principal, left_cauchy_green, principal_stress, principal_tangent, divided_coth
  public :: logarithm_1p, exponential_m1, NEXT_AXIS

  integer, parameter :: NEXT_AXIS(3) = [2, 3, 1]   !< the second axis of each pair

  !> The principal logarithmic strains and their directions.
  type :: principal_type
    real(DP) :: x(3)                               !< eigenvalues of b - 1 [-]
    real(DP) :: e(3)                               !< logarithmic strains 1/2 ln(1 + x) [-]
    real(DP) :: m(6, 3)                            !< n_A n_A as Voigt vectors
    real(DP) :: s(6, 3)                            !< n_A n_B + n_B n_A of the pairs
  end type principal_type

contains

  !> b - 1 = H + H^T + H H^T, formed so that nothing cancels.
  pure function left_cauchy_green(H) result(x)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient, F = 1 + H [-]
    real(DP) :: x(6)                               !< Voigt vector [-]
    integer :: k, i, j
    do k = 1, 6
      i = VOIGT_ROW(k)
      j = VOIGT_COLUMN(k)
      x(k) = H(i, j) + H(j, i) + H(i, 1) * H(j, 1) + H(i, 2) * H(j, 2) + H(i, 3) * H(j, 3)
    end do
  end function left_cauchy_green


  !> Principal logarithmic strains and axes of b = 1 + x.
  pure subroutine find_principal(x, principal, is_positive)
    real(DP), intent(in) :: x(6)                   !< b - 1 as a Voigt vector [-]
    type(principal_type), intent(out) :: principal
    logical, intent(out) :: is_positive            !< .false.: b is not positive definite, the rest is not set
    real(DP) :: n(3, 3)
    integer :: k, i, j
    call symmetric_eigen(x, principal%x, n)
    is_positive = minval(principal%x) > -1
    if (.not. is_positive) return
    principal%e = 0.5_DP * logarithm_1p(principal%x)
    do k = 1, 6
      i = VOIGT_ROW(k)
      j = VOIGT_COLUMN(k)
      principal%m(k, :) = n(i, :) * n(j, :)
      principal%s(k, 1) = n(i, 1) * n(j, 2) + n(i, 2) * n(j, 1)
      principal%s(k, 2) = n(i, 2) * n(j, 3) + n(i, 3) * n(j, 2)
      principal%s(k, 3) = n(i, 3) * n(j, 1) + n(i, 1) * n(j, 3)
    end do
  end subroutine find_principal


  !> The tensor with given principal values.
  pure function principal_stress(principal, values) result(tensor)
    type(principal_type), intent(in) :: principal
    real(DP), intent(in) :: values(3)
    real(DP) :: tensor(6)                          !< Voigt vector
    tensor = values(1) * principal%m(:, 1) + values(2) * principal%m(:, 2) + values(3) * principal%m(:, 3)
  end function principal_stress


  !> The spatial tangent (L_v tau = c : d) of tau = sum tau_A(e) n_A n_A:
  !! c_AABB = d tau_A/d e_B - 2 tau_A delta_AB, c_ABAB = 1/2 S_AB d coth(d) - 1/2 (tau_A + tau_B),
  !! with d = e_A - e_B and the secants S_AB = (tau_A - tau_B)/(e_A - e_B), which the law gives without cancellation.
  !! Reference: C. Miehe, M. Lambrecht, Algorithms for computation of stresses and elasticity moduli in terms of
  !! Seth-Hill's family of generalized strain tensors, Commun. Numer. Meth. Engng 17 (2001) 337-353.
  pure function principal_tangent(principal, tau, slope, secant) result(c)
    type(principal_type), intent(in) :: principal
    real(DP), intent(in) :: tau(3)                 !< [stress]
    real(DP), intent(in) :: slope(3, 3)            !< d tau_A/d e_B [stress]
    real(DP), intent(in) :: secant(3)              !< S_AB of the pairs [stress]
    real(DP) :: c(6, 6)                            !< engineering shears [stress]
    real(DP) :: g(3, 3), shear(3), along(6, 3), across(6, 3)
    integer :: A, B, j
    g = slope
    do A = 1, 3
      B = NEXT_AXIS(A)
      g(A, A) = g(A, A) - 2 * tau(A)
      shear(A) = 0.5_DP * secant(A) * divided_coth(principal, A, B) - 0.5_DP * (tau(A) + tau(B))
    end do
    do A = 1, 3
      along(:, A) = g(1, A) * principal%m(:, 1) + g(2, A) * principal%m(:, 2) + g(3, A) * principal%m(:, 3)
      across(:, A) = shear(A) * principal%s(:, A)
    end do
    associate (m => principal%m, s => principal%s)
      do j = 1, 6
        c(:, j) = m(j, 1) * along(:, 1) + m(j, 2) * along(:, 2) + m(j, 3) * along(:, 3) &
          + s(j, 1) * across(:, 1) + s(j, 2) * across(:, 2) + s(j, 3) * across(:, 3)
      end do
    end associate
  end function principal_tangent


  !> d coth(d) of a pair of axes.
  pure function divided_coth(principal, A, B) result(y)
    type(principal_type), intent(in) :: principal
    integer, intent(in) :: A, B                    !< axes
    real(DP) :: y
    y = d_coth_d(principal%e(A) - principal%e(B), (principal%x(A) - principal%x(B)) &
      / (2 + principal%x(A) + principal%x(B)))
  end function divided_coth


  !> d coth(d) with t = tanh(d) given: d / t, and for small t the series of artanh(t) / t.
  pure function d_coth_d(d, t) result(y)
    real(DP), intent(in) :: d                      !< e_A - e_B [-]
    real(DP), intent(in) :: t                      !< (b_A - b_B)/(b_A + b_B) [-]
    real(DP) :: y
    real(DP), parameter :: SERIES_LIMIT = 0.1_DP
    real(DP) :: q
    if (abs(t) > SERIES_LIMIT) then
      y = d / t
    else
      q = t * t
      y = 1 + q * (1 / 3.0_DP + q * (1 / 5.0_DP + q * (1 / 7.0_DP + q * (1 / 9.0_DP + q * (1 / 11.0_DP &
        + q * (1 / 13.0_DP + q / 15))))))
    end if
  end function d_coth_d


  !> ln(1 + x) for small and large x. Reference: W. Kahan; in D. Goldberg, What every computer scientist should know
  !! about floating-point arithmetic, ACM Computing Surveys 23 (1991), theorem 4.
  pure elemental function logarithm_1p(x) result(y)
    real(DP), intent(in) :: x                      !< more than -1 [-]
    real(DP) :: y
    real(DP) :: u
    u = 1 + x
    y = x
    if (abs(u - 1) > 0) y = log(u) * (x / (u - 1))
  end function logarithm_1p


  !> exp(x) - 1 for small and large x: 2 sinh(x/2) exp(x/2).
  pure elemental function exponential_m1(x) result(y)
    real(DP), intent(in) :: x                      !< [-]
    real(DP) :: y
    y = 2 * sinh(0.5_DP * x) * exp(0.5_DP * x)
  end function exponential_m1

end module amontons_principal
