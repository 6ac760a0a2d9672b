!> Unit test of amontons_tensor: identities of 3x3 and Voigt algebra, and nearly equal eigenvalues.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_tensor
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, VOIGT_ROW, VOIGT_COLUMN, VOIGT_INDEX, cross_product, &
    determinant, determinant_minus_one, invert, skew_matrix, pack_voigt, unpack_voigt, double_dot, von_mises, &
    symmetric_eigen, extreme_eigenvalues, solve_normal_equations
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite

  call set_seed()
  call check_matrices()
  call check_voigt()
  call check_eigen()
  call check_least_squares()
  call suite%finish()

contains

  !> The coefficients of a parabola from its values at five points; the fit leaves no normal residual for other values.
  subroutine check_least_squares()
    real(DP), parameter :: AT(5) = [-1.0_DP, -0.3_DP, 0.1_DP, 0.8_DP, 1.5_DP], WANTED(3) = [0.7_DP, -2.0_DP, 3.0_DP]
    real(DP) :: functions(3, 5), fit(3, 5), values(5), residual(5)
    functions = transpose(reshape([spread(1.0_DP, 1, 5), AT, AT**2], [5, 3]))
    fit = functions
    call solve_normal_equations(fit)
    call suite%near('fit of a parabola', maxval(abs(matmul(fit, matmul(WANTED, functions)) - WANTED)), 0.0_DP, 1e-14_DP)
    call random_number(values)
    residual = values - matmul(matmul(fit, values), functions)
    call suite%near('no normal residual', maxval(abs(matmul(functions, residual))), 0.0_DP, 1e-14_DP)
    call suite%that('values that no parabola has', maxval(abs(residual)) > 1e-3_DP)
  end subroutine check_least_squares


  subroutine set_seed()
    integer :: n, i
    call random_seed(size=n)
    call random_seed(put=[(7919 * i, i=1, n)])
  end subroutine set_seed


  subroutine check_matrices()
    real(DP) :: A(3, 3), inverse(3, 3), det, a1(3), a2(3), a3(3), H(3, 3)
    integer :: i
    do i = 1, 20
      call random_number(A)
      A = A - 0.5_DP
      a1 = A(:, 1)
      a2 = A(:, 2)
      a3 = A(:, 3)
      call suite%near('determinant is the triple product', determinant(A), dot_product(a1, cross_product(a2, a3)), &
        1e-15_DP)
      call invert(A, inverse, det)
      call suite%near('determinant of invert', det, determinant(A), 1e-15_DP)
      call suite%near('A times its inverse', maxval(abs(matmul(A, inverse) - IDENTITY)), 0.0_DP, 1e-14_DP / abs(det))
      call suite%near('det(1 + H) - 1', determinant_minus_one(A), determinant(IDENTITY + A) - 1, 1e-14_DP)
    end do
    H = 0
    H(1, 1) = 1e-13_DP
    H(2, 2) = -1e-13_DP
    H(1, 2) = 3e-13_DP
    call suite%near('det(1 + H) - 1 of a tiny H', determinant_minus_one(H) * 1e26_DP, -1.0_DP, 1e-14_DP)
    A(:, 3) = A(:, 1)
    A(:, 2) = 0
    call invert(A, inverse, det)
    call suite%near('singular: determinant', det, 0.0_DP, 0.0_DP)
    call suite%near('singular: inverse of zeros', maxval(abs(inverse)), 0.0_DP, 0.0_DP)
    call suite%near('skew matrix: its product is the vector product', norm2(matmul(skew_matrix([1.0_DP, -2.0_DP, 5.0_DP]), &
      [3.0_DP, 7.0_DP, -4.0_DP]) - cross_product([1.0_DP, -2.0_DP, 5.0_DP], [3.0_DP, 7.0_DP, -4.0_DP])), 0.0_DP, 0.0_DP)
  end subroutine check_matrices


  subroutine check_voigt()
    real(DP) :: A(3, 3), B(3, 3)
    integer :: k, i, j
    do k = 1, 6
      i = VOIGT_ROW(k)
      j = VOIGT_COLUMN(k)
      call suite%that('Voigt tables agree', VOIGT_INDEX(i, j) == k .and. VOIGT_INDEX(j, i) == k)
    end do
    call random_number(A)
    call random_number(B)
    A = A + transpose(A)
    B = B + transpose(B)
    call suite%near('unpack of pack', maxval(abs(unpack_voigt(pack_voigt(A)) - A)), 0.0_DP, 0.0_DP)
    call suite%near('order xx yy zz xy yz xz', maxval(abs(pack_voigt(A) &
      - [A(1, 1), A(2, 2), A(3, 3), A(1, 2), A(2, 3), A(1, 3)])), 0.0_DP, 0.0_DP)
    call suite%near('double dot', double_dot(pack_voigt(A), pack_voigt(B)), sum(A * B), 1e-14_DP)
    call suite%near('Mises of tension', von_mises([0.0_DP, -3.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]), 3.0_DP, 1e-15_DP)
    call suite%near('Mises of shear', von_mises([0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 2.0_DP, 0.0_DP]), &
      2 * sqrt(3.0_DP), 1e-15_DP)
    call suite%near('Mises of pressure', von_mises(-7 * VOIGT_IDENTITY), 0.0_DP, 0.0_DP)
  end subroutine check_voigt


  !> Eigenvalues distinct, equal, and nearly equal; small and large matrices; random axes.
  subroutine check_eigen()
    real(DP), parameter :: SPLIT(8) = [1.0_DP, 1e-2_DP, 1e-5_DP, 1e-8_DP, 1e-11_DP, 1e-14_DP, 1e-16_DP, 0.0_DP]
    real(DP) :: Q(3, 3), values(3), vectors(3, 3), A(6)
    integer :: i, k
    do i = 1, size(SPLIT)
      do k = 1, 20
        call random_rotation(Q)
        call check_decomposition(turn([1.0_DP, 1 + SPLIT(i), -2.0_DP], Q), 'two close, third below')
        call check_decomposition(turn([1.0_DP, 1 - SPLIT(i), 3.0_DP], Q), 'two close, third above')
        call check_decomposition(turn([1.0_DP, 1 - SPLIT(i), 1 + 2 * SPLIT(i)], Q), 'all close')
        call check_decomposition(1e-150_DP * turn([1.0_DP, 1 - SPLIT(i), -2.0_DP], Q), 'tiny')
        call check_decomposition(1e150_DP * turn([1.0_DP, 1 - SPLIT(i), -2.0_DP], Q), 'huge')
      end do
    end do
    call check_decomposition([3.0_DP, 1.0_DP, 2.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], 'diagonal')
    call check_decomposition([0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP], 'shear')
    A = 0.25_DP * VOIGT_IDENTITY
    call symmetric_eigen(A, values, vectors)
    call suite%near('multiple of 1: values', maxval(abs(values - 0.25_DP)), 0.0_DP, 0.0_DP)
    call suite%near('multiple of 1: least and largest', maxval(abs(extreme_eigenvalues(A) - 0.25_DP)), 0.0_DP, 0.0_DP)
    call suite%near('multiple of 1: vectors', maxval(abs(vectors - IDENTITY)), 0.0_DP, 0.0_DP)
    call symmetric_eigen([0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], values, vectors)
    call suite%near('zero: values', maxval(abs(values)), 0.0_DP, 0.0_DP)
    call symmetric_eigen([1.0_DP, 2.0_DP, 4.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], values, vectors)
    call suite%near('known values: smallest', minval(values), 1.0_DP, 1e-15_DP)
    call suite%near('known values: largest', maxval(values), 4.0_DP, 2e-15_DP)
  end subroutine check_eigen


  !> V diag(values) V^T gives A back, and V is orthonormal.
  subroutine check_decomposition(A, name)
    real(DP), intent(in) :: A(6)
    character(*), intent(in) :: name
    real(DP) :: values(3), V(3, 3), again(6)
    call symmetric_eigen(A, values, V)
    again = turn(values, V)
    call suite%near('orthonormal: ' // name, maxval(abs(matmul(transpose(V), V) - IDENTITY)), 0.0_DP, 2e-15_DP)
    call suite%near('decomposition: ' // name, maxval(abs(again - A)) / maxval(abs(A)), 0.0_DP, 3e-15_DP)
    call suite%near('least and largest value: ' // name, maxval(abs(extreme_eigenvalues(A) - [minval(values), maxval(values)])) &
      / maxval(abs(A)), 0.0_DP, 1e-7_DP)
  end subroutine check_decomposition


  !> V diag(values) V^T as a Voigt vector.
  function turn(values, V) result(A)
    real(DP), intent(in) :: values(3), V(3, 3)
    real(DP) :: A(6), D(3, 3)
    integer :: k
    do k = 1, 3
      D(:, k) = values(k) * V(:, k)
    end do
    A = pack_voigt(matmul(D, transpose(V)))
  end function turn


  subroutine random_rotation(Q)
    real(DP), intent(out) :: Q(3, 3)
    call random_number(Q)
    Q = Q - 0.5_DP
    Q(:, 1) = Q(:, 1) / norm2(Q(:, 1))
    Q(:, 2) = cross_product(Q(:, 1), Q(:, 2))
    Q(:, 2) = Q(:, 2) / norm2(Q(:, 2))
    Q(:, 3) = cross_product(Q(:, 1), Q(:, 2))
  end subroutine random_rotation

end program test_tensor
