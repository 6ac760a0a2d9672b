!> Algebra of small matrices: inverse, invariants and eigenvalues of 3x3 matrices, Voigt vectors, least squares.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Voigt order is xx yy zz xy yz xz, always; a Voigt vector holds tensor components (no factor 2 at the shears).
module amontons_tensor
  use amontons_kinds, only: DP
  implicit none
  private
  public :: IDENTITY, VOIGT_IDENTITY, VOIGT_ROW, VOIGT_COLUMN, VOIGT_INDEX
  public :: trace, cross_product, skew_matrix, outer_product, determinant, determinant_minus_one, invert
  public :: rotation_matrix, moment_on_vector
  public :: pack_voigt, unpack_voigt, push_forward, double_dot, von_mises, symmetric_eigen, extreme_eigenvalues
  public :: solve_normal_equations

  real(DP), parameter :: IDENTITY(3, 3) = reshape([real(DP) :: 1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
  real(DP), parameter :: VOIGT_IDENTITY(6) = [real(DP) :: 1, 1, 1, 0, 0, 0]
  integer, parameter :: VOIGT_ROW(6) = [1, 2, 3, 1, 2, 1]       !< row of a Voigt component in the 3x3 matrix
  integer, parameter :: VOIGT_COLUMN(6) = [1, 2, 3, 2, 3, 3]    !< its column
  integer, parameter :: VOIGT_INDEX(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])   !< Voigt component of (i, j)

contains

  !> The vector product a x b.
  pure function cross_product(a, b) result(c)
    real(DP), intent(in) :: a(3), b(3)
    real(DP) :: c(3)
    c(1) = a(2) * b(3) - a(3) * b(2)
    c(2) = a(3) * b(1) - a(1) * b(3)
    c(3) = a(1) * b(2) - a(2) * b(1)
  end function cross_product


  !> [a]x, the matrix with [a]x b = a x b.
  pure function skew_matrix(a) result(matrix)
    real(DP), intent(in) :: a(3)
    real(DP) :: matrix(3, 3)
    matrix = reshape([0.0_DP, a(3), -a(2), -a(3), 0.0_DP, a(1), a(2), -a(1), 0.0_DP], [3, 3])
  end function skew_matrix


  !> The trace of a 3x3 matrix.
  pure function trace(A) result(t)
    real(DP), intent(in) :: A(3, 3)
    real(DP) :: t
    t = A(1, 1) + A(2, 2) + A(3, 3)
  end function trace


  !> The determinant of a 3x3 matrix.
  pure function determinant(A) result(d)
    real(DP), intent(in) :: A(3, 3)
    real(DP) :: d
    d = A(1, 1) * (A(2, 2) * A(3, 3) - A(2, 3) * A(3, 2)) &
      - A(1, 2) * (A(2, 1) * A(3, 3) - A(2, 3) * A(3, 1)) &
      + A(1, 3) * (A(2, 1) * A(3, 2) - A(2, 2) * A(3, 1))
  end function determinant


  !> det(1 + H) - 1 without cancellation: the sum of the three invariants of H.
  pure function determinant_minus_one(H) result(j)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    real(DP) :: j
    j = trace(H) + determinant(H) &
      + (H(1, 1) * H(2, 2) - H(1, 2) * H(2, 1)) &
      + (H(2, 2) * H(3, 3) - H(2, 3) * H(3, 2)) &
      + (H(1, 1) * H(3, 3) - H(1, 3) * H(3, 1))
  end function determinant_minus_one


  !> Inverse and determinant of a 3x3 matrix by the adjugate. A zero determinant gives an inverse of zeros: the caller
  !! tests the determinant.
  pure subroutine invert(A, inverse, det)
    real(DP), intent(in) :: A(3, 3)
    real(DP), intent(out) :: inverse(3, 3)
    real(DP), intent(out) :: det
    real(DP) :: factor
    inverse(1, 1) = A(2, 2) * A(3, 3) - A(2, 3) * A(3, 2)
    inverse(2, 1) = A(2, 3) * A(3, 1) - A(2, 1) * A(3, 3)
    inverse(3, 1) = A(2, 1) * A(3, 2) - A(2, 2) * A(3, 1)
    inverse(1, 2) = A(1, 3) * A(3, 2) - A(1, 2) * A(3, 3)
    inverse(2, 2) = A(1, 1) * A(3, 3) - A(1, 3) * A(3, 1)
    inverse(3, 2) = A(1, 2) * A(3, 1) - A(1, 1) * A(3, 2)
    inverse(1, 3) = A(1, 2) * A(2, 3) - A(1, 3) * A(2, 2)
    inverse(2, 3) = A(1, 3) * A(2, 1) - A(1, 1) * A(2, 3)
    inverse(3, 3) = A(1, 1) * A(2, 2) - A(1, 2) * A(2, 1)
    det = A(1, 1) * inverse(1, 1) + A(1, 2) * inverse(2, 1) + A(1, 3) * inverse(3, 1)
    factor = 0
    if (abs(det) > 0) factor = 1 / det
    inverse = factor * inverse
  end subroutine invert


  !> The symmetric part of a 3x3 matrix as a Voigt vector.
  pure function pack_voigt(A) result(v)
    real(DP), intent(in) :: A(3, 3)
    real(DP) :: v(6)
    v(1) = A(1, 1)
    v(2) = A(2, 2)
    v(3) = A(3, 3)
    v(4) = 0.5_DP * (A(1, 2) + A(2, 1))
    v(5) = 0.5_DP * (A(2, 3) + A(3, 2))
    v(6) = 0.5_DP * (A(1, 3) + A(3, 1))
  end function pack_voigt


  !> The symmetric 3x3 matrix of a Voigt vector.
  pure function unpack_voigt(v) result(A)
    real(DP), intent(in) :: v(6)                   !< tensor components
    real(DP) :: A(3, 3)
    A(:, 1) = [v(1), v(4), v(6)]
    A(:, 2) = [v(4), v(2), v(5)]
    A(:, 3) = [v(6), v(5), v(3)]
  end function unpack_voigt


  !> Push-forward of a symmetric tensor: F T F^T.
  pure function push_forward(F, T) result(y)
    real(DP), intent(in) :: F(3, 3)                !< any matrix
    real(DP), intent(in) :: T(6)                   !< Voigt vector
    real(DP) :: y(6)
    real(DP) :: FT(3, 3)
    FT(:, 1) = F(:, 1) * T(1) + F(:, 2) * T(4) + F(:, 3) * T(6)
    FT(:, 2) = F(:, 1) * T(4) + F(:, 2) * T(2) + F(:, 3) * T(5)
    FT(:, 3) = F(:, 1) * T(6) + F(:, 2) * T(5) + F(:, 3) * T(3)
    y(1) = FT(1, 1) * F(1, 1) + FT(1, 2) * F(1, 2) + FT(1, 3) * F(1, 3)
    y(2) = FT(2, 1) * F(2, 1) + FT(2, 2) * F(2, 2) + FT(2, 3) * F(2, 3)
    y(3) = FT(3, 1) * F(3, 1) + FT(3, 2) * F(3, 2) + FT(3, 3) * F(3, 3)
    y(4) = FT(1, 1) * F(2, 1) + FT(1, 2) * F(2, 2) + FT(1, 3) * F(2, 3)
    y(5) = FT(2, 1) * F(3, 1) + FT(2, 2) * F(3, 2) + FT(2, 3) * F(3, 3)
    y(6) = FT(1, 1) * F(3, 1) + FT(1, 2) * F(3, 2) + FT(1, 3) * F(3, 3)
  end function push_forward


  !> a : b of two symmetric tensors in Voigt form.
  pure function double_dot(a, b) result(s)
    real(DP), intent(in) :: a(6), b(6)             !< tensor components
    real(DP) :: s
    s = a(1) * b(1) + a(2) * b(2) + a(3) * b(3) + 2 * (a(4) * b(4) + a(5) * b(5) + a(6) * b(6))
  end function double_dot


  !> The von Mises equivalent stress sqrt(3/2 s:s), s the deviator.
  pure function von_mises(stress) result(q)
    real(DP), intent(in) :: stress(6)              !< [stress]
    real(DP) :: q                                  !< [stress]
    q = sqrt(0.5_DP * ((stress(1) - stress(2))**2 + (stress(2) - stress(3))**2 + (stress(3) - stress(1))**2) &
      + 3 * (stress(4)**2 + stress(5)**2 + stress(6)**2))
  end function von_mises


  !> Eigenvalues and orthonormal eigenvectors of a symmetric 3x3 matrix, unordered; exact to rounding of the
  !! deviator's size, also for (nearly) equal eigenvalues.
  !!
  !! The eigenvalue separated from the two others by at least sqrt(3) of the scaled deviator is the root beta of
  !! beta^3 - 3 beta - 2 h = 0, found by Newton's method from above, and its eigenvector a column of the adjugate:
  !! both are well conditioned. The other two follow from the 2x2 matrix on the orthogonal plane by one Jacobi rotation,
  !! which tolerates equal eigenvalues. Cost: about 150 operations, no trigonometry.
  !! Reference: D. Eberly, A robust eigensolver for 3x3 symmetric matrices, Geometric Tools (2014), sections 2 to 4.
  pure subroutine symmetric_eigen(A, values, vectors)
    real(DP), intent(in) :: A(6)                   !< Voigt vector
    real(DP), intent(out) :: values(3)             !< eigenvalues
    real(DP), intent(out) :: vectors(3, 3)         !< vectors(:, k) belongs to values(k); right-handed or left-handed
    real(DP) :: mean, scale, d(6), v(3), u(3), w(3), au(3), aw(3), t, c, s
    mean = (A(1) + A(2) + A(3)) / 3
    d = A - mean * VOIGT_IDENTITY
    scale = max(abs(d(1)), abs(d(2)), abs(d(3)), abs(d(4)), abs(d(5)), abs(d(6)))
    values = mean
    vectors = IDENTITY
    if (.not. scale > 0) return
    d = d * (1 / max(scale, tiny(scale)))
    v = isolated_eigenvector(d)
    call complete_basis(v, u, w)
    au = multiply_voigt_vector(d, u)
    aw = multiply_voigt_vector(d, w)
    t = jacobi_tangent(dot_product(u, au), dot_product(u, aw), dot_product(w, aw))
    c = 1 / sqrt(1 + t * t)
    s = t * c
    vectors(:, 1) = c * u - s * w
    vectors(:, 2) = s * u + c * w
    vectors(:, 3) = v
    values(1) = mean + scale * (dot_product(u, au) - t * dot_product(u, aw))
    values(2) = mean + scale * (dot_product(w, aw) + t * dot_product(u, aw))
    values(3) = mean + scale * dot_product(v, multiply_voigt_vector(d, v))
  end subroutine symmetric_eigen


  !> The least and the largest eigenvalue of a symmetric tensor, to half of the digits of their difference.
  !!
  !! Those of a deviator whose double dot product with itself is 6 are b and (-b +- sqrt(12 - 3 b^2)) / 2, with its sign, where b,
  !! from sqrt(3) to 2, is that of largest magnitude.
  pure function extreme_eigenvalues(A) result(values)
    real(DP), intent(in) :: A(6)                   !< Voigt vector
    real(DP) :: values(2)                          !< least, largest
    real(DP) :: mean, scale, d(6), p, h, beta
    mean = (A(1) + A(2) + A(3)) / 3
    values = mean
    d = A - mean * VOIGT_IDENTITY
    scale = maxval(abs(d))
    if (.not. scale > 0) return
    d = d * (1 / max(scale, tiny(scale)))
    p = sqrt(double_dot(d, d) / 6)
    h = half_determinant(d * (1 / p))
    beta = isolated_eigenvalue(abs(h))
    values = [-0.5_DP * (beta + sqrt(max(0.0_DP, 12 - 3 * beta * beta))), beta]
    if (h < 0) values = -values(2:1:-1)
    values = mean + scale * p * values
  end function extreme_eigenvalues


  !> The unit eigenvector of a deviator for the eigenvalue that is separated from the two others.
  pure function isolated_eigenvector(d) result(v)
    real(DP), intent(in) :: d(6)                   !< deviator, scaled: largest component 1
    real(DP) :: v(3)
    real(DP) :: h, m(6)
    m = d * (1 / sqrt(double_dot(d, d) / 6))
    h = half_determinant(m)
    v = largest_adjugate_column(m - sign(isolated_eigenvalue(abs(h)), h) * VOIGT_IDENTITY)
  end function isolated_eigenvector


  !> Half of the determinant of a symmetric tensor.
  pure real(DP) function half_determinant(m) result(h)
    real(DP), intent(in) :: m(6)                   !< Voigt vector
    h = 0.5_DP * (m(1) * (m(2) * m(3) - m(5) * m(5)) - m(4) * (m(4) * m(3) - m(5) * m(6)) &
      + m(6) * (m(4) * m(5) - m(2) * m(6)))
  end function half_determinant


  !> The largest root of b^3 - 3 b - 2 h: the eigenvalue of largest magnitude of a deviator with double dot product 6.
  pure real(DP) function isolated_eigenvalue(h) result(beta)
    real(DP), intent(in) :: h                      !< magnitude of half its determinant, 0 to 1 [-]
    integer :: i
    beta = 2
    if (.not. h < 1) return
    beta = 1.7320508075688772_DP + 0.2679491924311228_DP * h
    do i = 1, 3
      beta = beta - (beta * (beta * beta - 3) - 2 * h) / (3 * (beta * beta - 1))
    end do
  end function isolated_eigenvalue


  !> The null vector, of length 1, of a symmetric matrix of rank 2: the largest column of its adjugate.
  pure function largest_adjugate_column(m) result(v)
    real(DP), intent(in) :: m(6)                   !< Voigt vector
    real(DP) :: v(3)
    real(DP) :: xx, yy, zz
    xx = m(2) * m(3) - m(5) * m(5)
    yy = m(1) * m(3) - m(6) * m(6)
    zz = m(1) * m(2) - m(4) * m(4)
    if (abs(xx) >= max(abs(yy), abs(zz))) then
      v = [xx, m(5) * m(6) - m(4) * m(3), m(4) * m(5) - m(2) * m(6)]
    else if (abs(yy) >= abs(zz)) then
      v = [m(5) * m(6) - m(4) * m(3), yy, m(4) * m(6) - m(1) * m(5)]
    else
      v = [m(4) * m(5) - m(2) * m(6), m(4) * m(6) - m(1) * m(5), zz]
    end if
    v = v * (1 / sqrt(v(1)**2 + v(2)**2 + v(3)**2))
  end function largest_adjugate_column


  !> Two unit vectors orthogonal to v and to each other.
  pure subroutine complete_basis(v, u, w)
    real(DP), intent(in) :: v(3)                   !< of length 1
    real(DP), intent(out) :: u(3), w(3)
    if (abs(v(1)) > abs(v(2))) then
      u = [-v(3), 0.0_DP, v(1)] * (1 / sqrt(v(1)**2 + v(3)**2))
    else
      u = [0.0_DP, v(3), -v(2)] * (1 / sqrt(v(2)**2 + v(3)**2))
    end if
    w = cross_product(v, u)
  end subroutine complete_basis


  !> The product of a symmetric matrix in Voigt form and a vector.
  pure function multiply_voigt_vector(m, x) result(y)
    real(DP), intent(in) :: m(6), x(3)
    real(DP) :: y(3)
    y(1) = m(1) * x(1) + m(4) * x(2) + m(6) * x(3)
    y(2) = m(4) * x(1) + m(2) * x(2) + m(5) * x(3)
    y(3) = m(6) * x(1) + m(5) * x(2) + m(3) * x(3)
  end function multiply_voigt_vector


  !> The tangent of the Jacobi rotation that diagonalizes ((a, b), (b, c)); the smaller of the two angles.
  pure function jacobi_tangent(a, b, c) result(t)
    real(DP), intent(in) :: a, b, c
    real(DP) :: t
    real(DP) :: root
    root = sqrt((c - a)**2 + 4 * b * b)
    t = 0
    if (root > 0) t = 2 * b / ((c - a) + sign(root, c - a))
  end function jacobi_tangent


  !> The dyadic product a b'.
  pure function outer_product(a, b) result(c)
    real(DP), intent(in) :: a(3), b(3)
    real(DP) :: c(3, 3)
    integer :: k
    do k = 1, 3
      c(:, k) = a * b(k)
    end do
  end function outer_product


  !> The matrix of a least squares fit: N becomes (N N^T)^-1 N, by Cholesky. Coefficients of functions from values at points.
  pure subroutine solve_normal_equations(N)
    real(DP), intent(inout) :: N(:, :)             !< (functions, points) in: values of the functions
    real(DP) :: L(size(N, 1), size(N, 1))
    integer :: m, i, j
    m = size(N, 1)
    L = matmul(N, transpose(N))
    do j = 1, m
      do i = 1, j - 1
        L(j:m, j) = L(j:m, j) - L(j, i) * L(j:m, i)
      end do
      L(j:m, j) = L(j:m, j) / sqrt(L(j, j))
    end do
    do i = 1, m
      do j = 1, i - 1
        N(i, :) = N(i, :) - L(i, j) * N(j, :)
      end do
      N(i, :) = N(i, :) / L(i, i)
    end do
    do i = m, 1, -1
      do j = i + 1, m
        N(i, :) = N(i, :) - L(j, i) * N(j, :)
      end do
      N(i, :) = N(i, :) / L(i, i)
    end do
  end subroutine solve_normal_equations


  !> R(w) = 1 + s [w] + c [w][w], s = sin t / t, c = (1 - cos t) / t^2, t = |w|, and dR/dw_k. Series for small t.
  pure subroutine rotation_matrix(w, R, dR)
    real(DP), intent(in) :: w(3)                   !< rotation vector [rad]
    real(DP), intent(out) :: R(3, 3)               !< [-]
    real(DP), intent(out) :: dR(3, 3, 3)           !< (:, :, k) dR/dw_k
    real(DP) :: t2, t, s, c, ds, dc, S_matrix(3, 3), E(3, 3)
    integer :: i, k
    t2 = dot_product(w, w)
    t = sqrt(t2)
    if (t2 < 1.0e-4_DP) then                       ! next terms below 1e-16
      s = 1.0_DP - t2 / 6.0_DP * (1.0_DP - t2 / 20.0_DP * (1.0_DP - t2 / 42.0_DP))
      c = 0.5_DP - t2 / 24.0_DP * (1.0_DP - t2 / 30.0_DP * (1.0_DP - t2 / 56.0_DP))
      ds = -(1.0_DP - t2 / 10.0_DP * (1.0_DP - t2 / 28.0_DP)) / 3.0_DP
      dc = -(1.0_DP - t2 / 15.0_DP * (1.0_DP - 0.75_DP * t2 / 28.0_DP)) / 12.0_DP
    else
      s = sin(t) / t
      c = (1.0_DP - cos(t)) / t2
      ds = (cos(t) - s) / t2                       ! ds/dw_k = ds * w_k
      dc = (s - 2.0_DP * c) / t2
    end if
    S_matrix = skew_matrix(w)
    R = s * S_matrix + c * matmul(S_matrix, S_matrix)
    do i = 1, 3
      R(i, i) = R(i, i) + 1.0_DP
    end do
    do k = 1, 3
      E = skew_matrix([(merge(1.0_DP, 0.0_DP, i == k), i=1, 3)])
      dR(:, :, k) = w(k) * (ds * S_matrix + dc * matmul(S_matrix, S_matrix)) + s * E &
        + c * (matmul(E, S_matrix) + matmul(S_matrix, E))
    end do
  end subroutine rotation_matrix


  !> The forces on the components of a rotation vector w that do the work of a moment: f . dw = M . dtheta, where the skew matrix of
  !! dtheta is dR R'.
  pure function moment_on_vector(w, moment) result(f)
    real(DP), intent(in) :: w(3)                   !< rotation vector [rad]
    real(DP), intent(in) :: moment(3)              !< about fixed axes
    real(DP) :: f(3)
    real(DP) :: R(3, 3), dR(3, 3, 3), turned(3, 3)
    integer :: k
    call rotation_matrix(w, R, dR)
    turned = 0.5_DP * matmul(skew_matrix(moment), R)
    f = [(sum(turned * dR(:, :, k)), k=1, 3)]
  end function moment_on_vector

end module amontons_tensor
