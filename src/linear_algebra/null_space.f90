!> Null space of a Gram matrix by pivoted Cholesky.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_null_space
  use amontons_kinds, only: DP
  use amontons_dense, only: solve_symmetric_eigen, DENSE_OK
  implicit none
  private
  public :: find_null_space, find_null_vectors

contains

  !> Orthonormal vectors that a Gram matrix maps to (nearly) zero, in the first n columns.
  subroutine find_null_space(gram, tolerance, n, vectors, eigenvalues)
    real(DP), intent(in) :: gram(:, :)             !< (m, m)
    real(DP), intent(in) :: tolerance              !< of an eigenvalue over the largest [-]
    integer, intent(out) :: n
    real(DP), intent(out) :: vectors(:, :)         !< (m, m) all eigenvectors
    real(DP), intent(out), optional :: eigenvalues(:)   !< (m) ascending
    real(DP) :: values(size(gram, 1))
    integer :: status
    call solve_symmetric_eigen(gram, values, vectors, status)
    if (present(eigenvalues)) eigenvalues = values
    n = 0
    if (status == DENSE_OK) n = count(values <= tolerance * values(size(values)))
  end subroutine find_null_space


  !> Null vectors of a Gram matrix by Cholesky with diagonal pivoting: L11 L11' x1 = -L11 L21' x2 for unit x2.
  !!
  !! In a stack of n bodies the smallest pivot falls as 1/n^3, the smallest eigenvalue as 1/n^4: pivots distinguish a weak support
  !! from a missing one in longer stacks. Reference: N. J. Higham, Analysis of the Cholesky decomposition of a semi-definite
  !! matrix, in: Reliable numerical computation, Oxford 1990.
  pure subroutine find_null_vectors(gram, tolerance, n, vectors)
    real(DP), intent(inout) :: gram(:, :)          !< (m, m), diagonal at most 1; overwritten: L in the lower triangle
    real(DP), intent(in) :: tolerance              !< of a pivot over the largest [-]
    integer, intent(out) :: n                      !< m less the rank
    real(DP), intent(out) :: vectors(:, :)         !< (m, m) the first n columns are set
    real(DP) :: x(size(gram, 1))
    integer :: order(size(gram, 1)), m, rank, i, j, k
    m = size(gram, 1)
    order = [(i, i=1, m)]
    do rank = 0, m - 1
      k = rank + 1
      i = k - 1 + maxloc([(gram(j, j), j=k, m)], dim=1)
      if (gram(i, i) <= tolerance) exit
      order([k, i]) = order([i, k])
      call exchange(gram, k, i)
      gram(k:, k) = gram(k:, k) / sqrt(gram(k, k))
      do j = k + 1, m
        gram(j:, j) = gram(j:, j) - gram(j, k) * gram(j:, k)
      end do
    end do
    n = m - rank
    do i = 1, n
      x = 0.0_DP
      x(rank + i) = 1.0_DP
      do k = rank, 1, -1
        x(k) = -dot_product(gram(k + 1:, k), x(k + 1:)) / gram(k, k)
      end do
      vectors(order, i) = x
    end do
  end subroutine find_null_vectors


  !> Exchanges two rows and columns, k < i, of a symmetric matrix stored by its lower triangle.
  pure subroutine exchange(a, k, i)
    real(DP), intent(inout) :: a(:, :)
    integer, intent(in) :: k, i
    real(DP) :: row(k - 1), low(size(a, 1) - i), mid(max(i - k - 1, 0)), corner
    if (k == i) return
    row = a(k, :k - 1)
    a(k, :k - 1) = a(i, :k - 1)
    a(i, :k - 1) = row
    mid = a(k + 1:i - 1, k)
    a(k + 1:i - 1, k) = a(i, k + 1:i - 1)
    a(i, k + 1:i - 1) = mid
    low = a(i + 1:, k)
    a(i + 1:, k) = a(i + 1:, i)
    a(i + 1:, i) = low
    corner = a(k, k)
    a(k, k) = a(i, i)
    a(i, i) = corner
  end subroutine exchange

end module amontons_null_space
