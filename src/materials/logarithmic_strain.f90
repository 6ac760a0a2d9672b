!> Logarithmic strain ln(C)/2: principal axes, tensor functions, and laws in ln(C)/2 pushed forward to Kirchhoff stress and tangent.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A law between the six components of E = ln(C)/2 and their conjugate stress T is objective at finite strain for any
!! material symmetry. T and dT/dE are converted to Kirchhoff stress and spatial tangent by the first and second derivative
!! of the logarithm in the axes of C; divided differences are computed without cancellation.
!! References: C. Miehe, N. Apel, M. Lambrecht, Anisotropic additive plasticity in the logarithmic strain space, Comput.
!! Methods Appl. Mech. Engrg. 191 (2002) 5383-5425; R. Bhatia, Matrix Analysis (1997), section V.3 (second derivative).
!!
!! Isotropic laws in principal axes get their spatial tangent here too.
!! Voigt order xx yy zz xy yz xz, tensor components; a tangent multiplies engineering shears. Pairs of axes are ordered
!! (1, 2), (2, 3), (3, 1). Theory: doc/theory/materials.md.
module amontons_logarithmic_strain
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, VOIGT_INDEX, VOIGT_ROW, VOIGT_COLUMN, double_dot, invert, pack_voigt, &
    push_forward, symmetric_eigen, unpack_voigt
  implicit none
  private
  public :: log_strain_axes_type, find_log_strain_axes, push_forward_log_law, voigt_transformation, tensor_log, tensor_exp
  public :: find_small_principal_strains, small_principal_tangent
  public :: principal_strains_type, find_principal_strains, left_cauchy_green, tensor_from_principal, principal_tangent, &
    coth_divided_difference
  public :: log1p, expm1, NEXT_AXIS

  !> The principal axes of C and the quantities derived from them.
  type :: log_strain_axes_type
    real(DP) :: x(3)                               !< eigenvalues of C - 1 [-]
    real(DP) :: e(3)                               !< logarithmic strains [-]
    real(DP) :: reference(3, 3)                    !< axes N_A in the reference configuration, in columns
    real(DP) :: spatial_axes(3, 3)                        !< axes n_A = F N_A/lambda_A, in columns
  end type log_strain_axes_type

  integer, parameter :: NEXT_AXIS(3) = [2, 3, 1]   !< the second axis of each pair

  !> The principal logarithmic strains and their directions.
  type :: principal_strains_type
    real(DP) :: x(3)                               !< eigenvalues of b - 1 [-]
    real(DP) :: e(3)                               !< logarithmic strains 1/2 ln(1 + x) [-]
    real(DP) :: m(6, 3)                            !< n_A n_A as Voigt vectors
    real(DP) :: s(6, 3)                            !< n_A n_B + n_B n_A of the pairs
  end type principal_strains_type

contains

  !> Axes and logarithmic strains of F = 1 + H.
  pure subroutine find_log_strain_axes(H, axes, is_positive)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    type(log_strain_axes_type), intent(out) :: axes
    logical, intent(out) :: is_positive            !< .false.: C is not positive definite, the rest is not set
    integer :: A
    call symmetric_eigen(pack_voigt(H + transpose(H) + matmul(transpose(H), H)), axes%x, axes%reference)
    is_positive = minval(axes%x) > -1
    if (.not. is_positive) return
    axes%e = 0.5_DP * log1p(axes%x)
    axes%spatial_axes = matmul(IDENTITY + H, axes%reference)
    do A = 1, 3
      axes%spatial_axes(:, A) = axes%spatial_axes(:, A) / sqrt(1 + axes%x(A))
    end do
  end subroutine find_log_strain_axes


  !> Kirchhoff stress and, if wanted, spatial tangent from T and dT/dE.
  !!
  !! In the axes: tau_AB = T_AB g_AB, g_AB = d/sinh(d), d = e_A - e_B;
  !! c_ABCD = g_AB D_ABCD g_CD + the curvature of the logarithm.
  pure subroutine push_forward_log_law(axes, stress, is_tangent_wanted, tangent)
    type(log_strain_axes_type), intent(in) :: axes
    real(DP), intent(inout) :: stress(6)           !< in: T, reference axes; out: tau [stress]
    logical, intent(in) :: is_tangent_wanted       !< if not, the tangent is not changed
    real(DP), intent(inout) :: tangent(6, 6)       !< in: dT/dE; out: spatial; engineering shears [stress]
    real(DP) :: Q(6, 6), T(6), c(6, 6), g(6), d
    integer :: k
    T = push_forward(transpose(axes%reference), stress)
    do k = 1, 6
      d = axes%e(VOIGT_ROW(k)) - axes%e(VOIGT_COLUMN(k))
      g(k) = 1
      if (abs(d) > 1.0e-9_DP) g(k) = d / sinh(d)
    end do
    stress = push_forward(axes%spatial_axes, g * T)
    if (.not. is_tangent_wanted) return
    Q = voigt_transformation(transpose(axes%reference))
    c = matmul(Q, matmul(tangent, transpose(Q)))
    do k = 1, 6
      c(:, k) = g * c(:, k) * g(k)
    end do
    call add_logarithm_curvature(1 + axes%x, T, c)
    Q = voigt_transformation(axes%spatial_axes)
    tangent = matmul(Q, matmul(c, transpose(Q)))
  end subroutine push_forward_log_law


  !> Adds the curvature of the logarithm in the axes, as a form of two strains h and k
  !! 2 T_AB l_A l_B x_C ln[x_A, x_C, x_B] (h_AC k_CB + k_AC h_CB), with the second divided difference of ln, which is symmetric, and
  !! the stretches l, x = l^2.
  pure subroutine add_logarithm_curvature(x, T, c)
    real(DP), intent(in) :: x(3)                   !< eigenvalues of C [-]
    real(DP), intent(in) :: T(6)                   !< in the axes [stress]
    real(DP), intent(inout) :: c(6, 6)             !< [stress]
    real(DP) :: ln(3, 3, 3), xi
    integer :: A, B, k, i, j
    do A = 1, 3
      do B = A, 3
        do k = B, 3
          xi = second_divided_difference(x(A), x(B), x(k))
          ln(A, B, k) = xi
          ln(A, k, B) = xi
          ln(B, A, k) = xi
          ln(B, k, A) = xi
          ln(k, A, B) = xi
          ln(k, B, A) = xi
        end do
      end do
    end do
    do A = 1, 3
      do B = 1, 3
        do k = 1, 3
          xi = 2 * T(VOIGT_INDEX(A, B)) * sqrt(x(A) * x(B)) * x(k) * ln(A, k, B)
          i = VOIGT_INDEX(A, k)
          j = VOIGT_INDEX(k, B)
          if (A /= k) xi = 0.5_DP * xi
          if (B /= k) xi = 0.5_DP * xi
          c(i, j) = c(i, j) + xi
          c(j, i) = c(j, i) + xi
        end do
      end do
    end do
  end subroutine add_logarithm_curvature


  !> The second divided difference of ln at three positive numbers: where they are close, from the series of
  !! ln(1 + d) = sum (-1)^(k+1) d^k/k, whose divided differences are the complete symmetric polynomials of the d.
  pure function second_divided_difference(x1, x2, x3) result(f)
    real(DP), intent(in) :: x1, x2, x3
    real(DP) :: f
    real(DP), parameter :: TOL_CLOSE_EIGENVALUES = 0.03_DP
    real(DP) :: mean, y(3), h1, h2, h3, low, high, middle, factor
    integer :: k
    mean = (x1 + x2 + x3) / 3
    y = [x1, x2, x3] / mean - 1
    if (maxval(abs(y)) > TOL_CLOSE_EIGENVALUES) then
      low = min(x1, x2, x3)
      high = max(x1, x2, x3)
      middle = x1 + x2 + x3 - low - high
      middle = min(max(middle, low), high)
      f = (first_divided_difference(high, middle) - first_divided_difference(middle, low)) / (high - low)
      return
    end if
    f = -0.5_DP
    h1 = 1
    h2 = 1
    h3 = 1
    factor = -1
    do k = 1, 9
      h1 = h1 * y(1)
      h2 = h1 + y(2) * h2
      h3 = h2 + y(3) * h3
      factor = -factor
      f = f + factor * h3 / real(k + 2, DP)
    end do
    f = f / mean**2
  end function second_divided_difference


  !> The first divided difference of ln.
  pure function first_divided_difference(a, b) result(f)
    real(DP), intent(in) :: a, b
    real(DP) :: f
    f = 1 / b
    if (abs(a - b) > 0) f = log1p((a - b) / b) / (a - b)
  end function first_divided_difference


  !> The matrix Q with tau = Q S and c = Q C Q^T for tau_ij = A_iI S_IJ A_jJ, c_ijkl = A_iI A_jJ C_IJKL A_kK A_lL.
  pure function voigt_transformation(A) result(Q)
    real(DP), intent(in) :: A(3, 3)                !< F, or a rotation [-]
    real(DP) :: Q(6, 6)
    integer :: k, n, i, j, r, s
    do n = 1, 6
      r = VOIGT_ROW(n)
      s = VOIGT_COLUMN(n)
      do k = 1, 6
        i = VOIGT_ROW(k)
        j = VOIGT_COLUMN(k)
        Q(k, n) = A(i, r) * A(j, s)
        if (n > 3) Q(k, n) = Q(k, n) + A(i, s) * A(j, r)
      end do
    end do
  end function voigt_transformation


  !> exp(a S) - 1 of a symmetric tensor: the series of x = exp(A) - 1 for A = a S/2^j of size 1 at most, and j times x (2 + x).
  pure function tensor_exp(S, a) result(y)
    real(DP), intent(in) :: S(6)                   !< Voigt vector
    real(DP), intent(in) :: a                      !< [-]
    real(DP) :: y(6)
    integer :: k, n_doublings
    real(DP), parameter :: FACTORIALS(19) = [(gamma(real(k + 1, DP)), k=1, 19)]
    y = a * S
    n_doublings = min(max(0, exponent(sqrt(double_dot(y, y)))), maxexponent(a))
    y = power_series(y / 2.0_DP**n_doublings, 1 / FACTORIALS)
    do k = 1, n_doublings
      y = 2 * y + multiply_symmetric(y, y)
    end do
  end function tensor_exp


  !> a ln(1 + S) of a symmetric tensor: the series of 2 artanh(Z), Z = S (2 + S)^-1, or in the principal axes if Z is large.
  pure function tensor_log(S, a) result(y)
    real(DP), intent(in) :: S(6)                   !< Voigt vector, eigenvalues more than -1
    real(DP), intent(in) :: a                      !< [-]
    real(DP) :: y(6)
    integer :: k
    real(DP), parameter :: ODD_NUMBERS(17) = [(real(2 * k + 1, DP), k=1, 17)], MAX_SERIES_ARGUMENT = 1 / 3.0_DP
    real(DP) :: Z(6), inverse(3, 3), det, values(3), n(3, 3)
    call invert(unpack_voigt(S + 2 * VOIGT_IDENTITY), inverse, det)
    Z = multiply_symmetric(S, pack_voigt(inverse))
    if (double_dot(Z, Z) <= MAX_SERIES_ARGUMENT**2) then
      y = 2 * a * (Z + multiply_symmetric(Z, power_series(multiply_symmetric(Z, Z), 1 / ODD_NUMBERS)))
    else
      call symmetric_eigen(S, values, n)
      y = tensor_from_axes(a * log1p(values), n)
    end if
  end function tensor_log


  !> c_1 A + c_2 A^2 + ... of a symmetric tensor. Horner's scheme on p_0 + p_1 A + p_2 A^2, as A^3 = I_1 A^2 - I_2 A + I_3
  !! (Cayley and Hamilton).
  pure function power_series(A, c) result(y)
    real(DP), intent(in) :: A(6)                   !< Voigt vector
    real(DP), intent(in) :: c(:)
    real(DP) :: y(6), square(6), p(3), i1, i2, i3
    integer :: k
    square = multiply_symmetric(A, A)
    i1 = A(1) + A(2) + A(3)
    i2 = A(1) * A(2) + A(2) * A(3) + A(3) * A(1) - A(4) * A(4) - A(5) * A(5) - A(6) * A(6)
    i3 = A(1) * (A(2) * A(3) - A(5) * A(5)) - A(4) * (A(4) * A(3) - A(5) * A(6)) + A(6) * (A(4) * A(5) - A(2) * A(6))
    p = 0
    do k = size(c), 1, -1
      p = [i3 * p(3) + c(k), p(1) - i2 * p(3), p(2) + i1 * p(3)]
    end do
    y = (p(1) - i2 * p(3)) * A + (p(2) + i1 * p(3)) * square + i3 * p(3) * VOIGT_IDENTITY
  end function power_series


  !> The product of two symmetric tensors with the same axes, which is symmetric.
  pure function multiply_symmetric(A, B) result(y)
    real(DP), intent(in) :: A(6), B(6)             !< Voigt vectors
    real(DP) :: y(6)
    y(1) = A(1) * B(1) + A(4) * B(4) + A(6) * B(6)
    y(2) = A(4) * B(4) + A(2) * B(2) + A(5) * B(5)
    y(3) = A(6) * B(6) + A(5) * B(5) + A(3) * B(3)
    y(4) = A(1) * B(4) + A(4) * B(2) + A(6) * B(5)
    y(5) = A(4) * B(6) + A(2) * B(5) + A(5) * B(3)
    y(6) = A(1) * B(6) + A(4) * B(5) + A(6) * B(3)
  end function multiply_symmetric


  !> The tensor with given eigenvalues and axes.
  pure function tensor_from_axes(values, n) result(y)
    real(DP), intent(in) :: values(3), n(3, 3)
    real(DP) :: y(6)
    integer :: k
    do k = 1, 6
      y(k) = sum(values * n(VOIGT_ROW(k), :) * n(VOIGT_COLUMN(k), :))
    end do
  end function tensor_from_axes


  !> b - 1 = H + H^T + H H^T, computed without cancellation.
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
  pure subroutine find_principal_strains(x, principal, is_positive)
    real(DP), intent(in) :: x(6)                   !< b - 1 as a Voigt vector [-]
    type(principal_strains_type), intent(out) :: principal
    logical, intent(out) :: is_positive            !< .false.: b is not positive definite, the rest is not set
    real(DP) :: n(3, 3)
    call symmetric_eigen(x, principal%x, n)
    is_positive = minval(principal%x) > -1
    if (.not. is_positive) return
    principal%e = 0.5_DP * log1p(principal%x)
    call set_dyads(n, principal)
  end subroutine find_principal_strains


  !> Small principal strains with their dyads.
  pure subroutine find_small_principal_strains(strain, principal)
    real(DP), intent(in) :: strain(6)              !< tensor components [-]
    type(principal_strains_type), intent(out) :: principal   !< x is not set
    real(DP) :: n(3, 3)
    call symmetric_eigen(strain, principal%e, n)
    call set_dyads(n, principal)
  end subroutine find_small_principal_strains


  !> The dyads of principal axes.
  pure subroutine set_dyads(n, principal)
    real(DP), intent(in) :: n(3, 3)                !< unit vectors in columns
    type(principal_strains_type), intent(inout) :: principal
    integer :: k, i, j
    do k = 1, 6
      i = VOIGT_ROW(k)
      j = VOIGT_COLUMN(k)
      principal%m(k, :) = n(i, :) * n(j, :)
      principal%s(k, 1) = n(i, 1) * n(j, 2) + n(i, 2) * n(j, 1)
      principal%s(k, 2) = n(i, 2) * n(j, 3) + n(i, 3) * n(j, 2)
      principal%s(k, 3) = n(i, 3) * n(j, 1) + n(i, 1) * n(j, 3)
    end do
  end subroutine set_dyads


  !> The tensor with given principal values.
  pure function tensor_from_principal(principal, values) result(tensor)
    type(principal_strains_type), intent(in) :: principal
    real(DP), intent(in) :: values(3)              !< [stress]
    real(DP) :: tensor(6)                          !< Voigt vector
    tensor = values(1) * principal%m(:, 1) + values(2) * principal%m(:, 2) + values(3) * principal%m(:, 3)
  end function tensor_from_principal


  !> The spatial tangent (L_v tau = c : d) of tau = sum tau_A(e) n_A n_A:
  !! c_AABB = d tau_A/d e_B - 2 tau_A delta_AB, c_ABAB = 1/2 S_AB d coth(d) - 1/2 (tau_A + tau_B),
  !! with d = e_A - e_B and the secants S_AB = (tau_A - tau_B)/(e_A - e_B), which the law gives without cancellation.
  !! Reference: C. Miehe, M. Lambrecht, Algorithms for computation of stresses and elasticity moduli in terms of
  !! Seth-Hill's family of generalized strain tensors, Commun. Numer. Meth. Engng 17 (2001) 337-353.
  pure function principal_tangent(principal, tau, slope, secant) result(c)
    type(principal_strains_type), intent(in) :: principal
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
      shear(A) = 0.5_DP * secant(A) * coth_divided_difference(principal, A, B) - 0.5_DP * (tau(A) + tau(B))
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


  !> The tangent of principal stresses over small principal strains.
  pure function small_principal_tangent(principal, slope, secant) result(c)
    type(principal_strains_type), intent(in) :: principal
    real(DP), intent(in) :: slope(3, 3)            !< d tau_A/d e_B [stress]
    real(DP), intent(in) :: secant(3)              !< S_AB of the pairs [stress]
    real(DP) :: c(6, 6)                            !< engineering shears [stress]
    integer :: A, j
    c = matmul(principal%m, matmul(slope, transpose(principal%m)))
    do A = 1, 3
      do j = 1, 6
        c(:, j) = c(:, j) + 0.5_DP * secant(A) * principal%s(j, A) * principal%s(:, A)
      end do
    end do
  end function small_principal_tangent


  !> d coth(d) of a pair of axes.
  pure function coth_divided_difference(principal, A, B) result(y)
    type(principal_strains_type), intent(in) :: principal
    integer, intent(in) :: A, B                    !< axes
    real(DP) :: y
    y = x_coth_x(principal%e(A) - principal%e(B), (principal%x(A) - principal%x(B)) &
      / (2 + principal%x(A) + principal%x(B)))
  end function coth_divided_difference


  !> d coth(d) with t = tanh(d) given: d / t, and for small t the series of artanh(t) / t.
  pure function x_coth_x(d, t) result(y)
    real(DP), intent(in) :: d                      !< e_A - e_B [-]
    real(DP), intent(in) :: t                      !< (b_A - b_B)/(b_A + b_B) [-]
    real(DP) :: y
    real(DP), parameter :: MAX_SERIES_ARGUMENT = 0.1_DP
    real(DP) :: q
    if (abs(t) > MAX_SERIES_ARGUMENT) then
      y = d / t
    else
      q = t * t
      y = 1 + q * (1 / 3.0_DP + q * (1 / 5.0_DP + q * (1 / 7.0_DP + q * (1 / 9.0_DP + q * (1 / 11.0_DP &
        + q * (1 / 13.0_DP + q / 15))))))
    end if
  end function x_coth_x


  !> ln(1 + x) for small and large x. Reference: W. Kahan; in D. Goldberg, What every computer scientist should know
  !! about floating-point arithmetic, ACM Computing Surveys 23 (1991), theorem 4.
  pure elemental function log1p(x) result(y)
    real(DP), intent(in) :: x                      !< more than -1 [-]
    real(DP) :: y
    real(DP) :: u
    u = 1 + x
    y = x
    if (abs(u - 1) > 0) y = log(u) * (x / (u - 1))
  end function log1p


  !> exp(x) - 1 for small and large x: 2 sinh(x/2) exp(x/2).
  pure elemental function expm1(x) result(y)
    real(DP), intent(in) :: x                      !< [-]
    real(DP) :: y
    y = 2 * sinh(0.5_DP * x) * exp(0.5_DP * x)
  end function expm1

end module amontons_logarithmic_strain
