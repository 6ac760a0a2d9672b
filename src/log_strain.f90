!> Logarithmic strain: ln(C)/2 of a placement, and any law given in it turned to space.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A law between the six components of E = ln(C)/2 and their conjugate stress T is objective at finite strain whatever
!! its symmetry. Here T and dT/dE become Kirchhoff stress and spatial tangent, by the first and second derivative
!! of the logarithm in the axes of C; divided differences are formed without cancellation.
!! References: C. Miehe, N. Apel, M. Lambrecht, Anisotropic additive plasticity in the logarithmic strain space, Comput.
!! Methods Appl. Mech. Engrg. 191 (2002) 5383-5425; R. Bhatia, Matrix Analysis (1997), section V.3 (second derivative).
module amontons_log_strain
  use amontons_kinds, only: DP
  use amontons_principal, only: logarithm_1p, exponential_m1
  use amontons_tensor, only: IDENTITY, VOIGT_INDEX, VOIGT_ROW, VOIGT_COLUMN, pack_voigt, symmetric_eigen
  implicit none
  private
  public :: log_axes_type, find_log_axes, push_log_law, transform_matrix, tensor_log, tensor_exp

  !> The axes of C and what hangs on them.
  type :: log_axes_type
    real(DP) :: x(3)                               !< eigenvalues of C - 1 [-]
    real(DP) :: e(3)                               !< logarithmic strains [-]
    real(DP) :: reference(3, 3)                    !< axes N_A in the reference placement, in columns
    real(DP) :: space(3, 3)                        !< axes n_A = F N_A/lambda_A, in columns
  end type log_axes_type

contains

  !> Axes and logarithmic strains of F = 1 + H.
  pure subroutine find_log_axes(H, axes, is_positive)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    type(log_axes_type), intent(out) :: axes
    logical, intent(out) :: is_positive            !< .false.: C is not positive definite, the rest is not set
    integer :: A
    call symmetric_eigen(pack_voigt(H + transpose(H) + matmul(transpose(H), H)), axes%x, axes%reference)
    is_positive = minval(axes%x) > -1
    if (.not. is_positive) return
    axes%e = 0.5_DP * logarithm_1p(axes%x)
    axes%space = matmul(IDENTITY + H, axes%reference)
    do A = 1, 3
      axes%space(:, A) = axes%space(:, A) / sqrt(1 + axes%x(A))
    end do
  end subroutine find_log_axes


  !> Kirchhoff stress and spatial tangent from T and dT/dE.
  !!
  !! In the axes: tau_AB = T_AB g_AB, g_AB = d/sinh(d), d = e_A - e_B;
  !! c_ABCD = g_AB D_ABCD g_CD + the curvature of the logarithm, as a form of two strains h and k
  !! 2 T_AB l_A l_B x_C ln[x_A, x_C, x_B] (h_AC k_CB + k_AC h_CB), with the second divided difference of ln and the
  !! stretches l, x = l^2.
  pure subroutine push_log_law(axes, stress, tangent)
    type(log_axes_type), intent(in) :: axes
    real(DP), intent(inout) :: stress(6)           !< in: T, reference axes; out: tau [stress]
    real(DP), intent(inout) :: tangent(6, 6)       !< in: dT/dE; out: spatial; engineering shears [stress]
    real(DP) :: Q(6, 6), T(6), c(6, 6), g(6), d, xi
    integer :: k, A, B, i, j
    Q = transform_matrix(transpose(axes%reference))
    T = matmul(Q, stress)
    c = matmul(Q, matmul(tangent, transpose(Q)))
    do k = 1, 6
      d = axes%e(VOIGT_ROW(k)) - axes%e(VOIGT_COLUMN(k))
      g(k) = 1
      if (abs(d) > 1.0e-9_DP) g(k) = d / sinh(d)
    end do
    do k = 1, 6
      c(:, k) = g * c(:, k) * g(k)
    end do
    do A = 1, 3
      do B = 1, 3
        do k = 1, 3
          xi = 2 * T(VOIGT_INDEX(A, B)) * sqrt((1 + axes%x(A)) * (1 + axes%x(B))) * (1 + axes%x(k)) &
            * second_difference(1 + axes%x(A), 1 + axes%x(k), 1 + axes%x(B))
          i = VOIGT_INDEX(A, k)
          j = VOIGT_INDEX(k, B)
          if (A /= k) xi = 0.5_DP * xi
          if (B /= k) xi = 0.5_DP * xi
          c(i, j) = c(i, j) + xi
          c(j, i) = c(j, i) + xi
        end do
      end do
    end do
    Q = transform_matrix(axes%space)
    stress = matmul(Q, g * T)
    tangent = matmul(Q, matmul(c, transpose(Q)))
  end subroutine push_log_law


  !> The second divided difference of ln at three positive numbers: where they are close, from the series of
  !! ln(1 + d) = sum (-1)^(k+1) d^k/k, whose divided differences are the complete symmetric polynomials of the d.
  pure function second_difference(x1, x2, x3) result(f)
    real(DP), intent(in) :: x1, x2, x3
    real(DP) :: f
    real(DP), parameter :: NEAR = 0.03_DP
    real(DP) :: mean, y(3), h1, h2, h3, low, high, middle, factor
    integer :: k
    mean = (x1 + x2 + x3) / 3
    y = [x1, x2, x3] / mean - 1
    if (maxval(abs(y)) > NEAR) then
      low = min(x1, x2, x3)
      high = max(x1, x2, x3)
      middle = x1 + x2 + x3 - low - high
      middle = min(max(middle, low), high)
      f = (first_difference(high, middle) - first_difference(middle, low)) / (high - low)
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
  end function second_difference


  !> The first divided difference of ln.
  pure function first_difference(a, b) result(f)
    real(DP), intent(in) :: a, b
    real(DP) :: f
    f = 1 / b
    if (abs(a - b) > 0) f = logarithm_1p((a - b) / b) / (a - b)
  end function first_difference


  !> The matrix Q with tau = Q S and c = Q C Q^T for tau_ij = A_iI S_IJ A_jJ, c_ijkl = A_iI A_jJ C_IJKL A_kK A_lL.
  pure function transform_matrix(A) result(Q)
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
  end function transform_matrix


  !> exp(a S) - 1 of a symmetric tensor.
  pure function tensor_exp(S, a) result(y)
    real(DP), intent(in) :: S(6)                   !< Voigt vector
    real(DP), intent(in) :: a
    real(DP) :: y(6)
    real(DP) :: values(3), n(3, 3)
    call symmetric_eigen(S, values, n)
    y = from_axes(exponential_m1(a * values), n)
  end function tensor_exp


  !> a ln(1 + S) of a symmetric tensor.
  pure function tensor_log(S, a) result(y)
    real(DP), intent(in) :: S(6)                   !< Voigt vector, eigenvalues more than -1
    real(DP), intent(in) :: a
    real(DP) :: y(6)
    real(DP) :: values(3), n(3, 3)
    call symmetric_eigen(S, values, n)
    y = from_axes(a * logarithm_1p(values), n)
  end function tensor_log


  !> The tensor with given eigenvalues and axes.
  pure function from_axes(values, n) result(y)
    real(DP), intent(in) :: values(3), n(3, 3)
    real(DP) :: y(6)
    integer :: k
    do k = 1, 6
      y(k) = sum(values * n(VOIGT_ROW(k), :) * n(VOIGT_COLUMN(k), :))
    end do
  end function from_axes

end module amontons_log_strain
