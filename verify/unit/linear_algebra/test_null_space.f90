!> Tests of null space: vectors of Gram matrices of known rank, by eigenvalues and by pivots, and chains whose hold is weak.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_null_space
  use amontons_kinds, only: DP
  use amontons_null_space, only: find_null_space, find_null_vectors
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_rank(suite, 5, 3)
  call check_rank(suite, 9, 1)
  call check_rank(suite, 6, 6)
  call check_zero(suite)
  call check_known_vector(suite)
  call check_chain(suite)
  call suite%finish()

contains

  !> B'B with `rank` rows of full rank, its diagonal at most 1.
  pure function gram_matrix(m, rank) result(gram)
    integer, intent(in) :: m, rank
    real(DP) :: gram(m, m), b(rank, m)
    integer :: i, j
    do j = 1, m
      b(:, j) = [(sin(real(7 * i + 3 * j * j + i * j, DP)), i=1, rank)]
    end do
    gram = matmul(transpose(b), b)
    gram = gram / maxval([(gram(i, i), i=1, m)])
  end function gram_matrix


  !> Both ways find m less the rank vectors, which the matrix maps to zero and which are independent.
  subroutine check_rank(suite, m, rank)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: m, rank
    real(DP) :: gram(m, m), copy(m, m), vectors(m, m), product(m, m)
    integer :: n, i
    gram = gram_matrix(m, rank)
    call find_null_space(gram, 1.0e-10_DP, n, vectors)
    call suite%that('eigenvalues: as many vectors as are missing', n == m - rank)
    call suite%near('eigenvalues: mapped to zero', norm2(matmul(gram, vectors(:, :n))), 0.0_DP, 1.0e-13_DP)
    product(:n, :n) = matmul(transpose(vectors(:, :n)), vectors(:, :n))
    do i = 1, n
      product(i, i) = product(i, i) - 1.0_DP
    end do
    call suite%near('eigenvalues: orthonormal', norm2(product(:n, :n)), 0.0_DP, 1.0e-13_DP)
    copy = gram
    call find_null_vectors(copy, 1.0e-10_DP, n, vectors)
    call suite%that('pivots: as many vectors as are missing', n == m - rank)
    call suite%near('pivots: mapped to zero', norm2(matmul(gram, vectors(:, :n))), 0.0_DP, 1.0e-9_DP)
    call suite%that('pivots: one entry of each is 1', all([(any(abs(vectors(:, i) - 1.0_DP) <= 0.0_DP), i=1, n)]))
    if (n == 0) return
    copy(:n, :n) = matmul(transpose(vectors(:, :n)), vectors(:, :n))
    do i = 1, n
      copy(:i, i) = copy(:i, i) / maxval(abs(copy(:n, :n)))
    end do
    call find_null_space(matmul(transpose(vectors(:, :n)), vectors(:, :n)), 1.0e-8_DP, i, product(:n, :n))
    call suite%that('pivots: independent', i == 0)
  end subroutine check_rank


  !> A matrix of zeros: every unit vector is one.
  subroutine check_zero(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: gram(3, 3), vectors(3, 3)
    integer :: n
    gram = 0.0_DP
    call find_null_vectors(gram, 1.0e-12_DP, n, vectors)
    call suite%that('zero: all vectors', n == 3)
    call suite%near('zero: the unit vectors', sum(abs(vectors)), 3.0_DP, 0.0_DP)
  end subroutine check_zero


  !> Two springs between three places: nothing holds the motion of all by the same.
  subroutine check_known_vector(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: gram(3, 3), vectors(3, 3)
    integer :: n
    gram = reshape([0.5_DP, -0.5_DP, 0.0_DP, -0.5_DP, 1.0_DP, -0.5_DP, 0.0_DP, -0.5_DP, 0.5_DP], [3, 3])
    call find_null_vectors(gram, 1.0e-12_DP, n, vectors)
    call suite%that('springs: one motion', n == 1)
    call suite%near('springs: all by the same', norm2(vectors(:, 1) - 1.0_DP), 0.0_DP, 1.0e-14_DP)
  end subroutine check_known_vector


  !> A chain of springs held at one end: the last pivot is 1/m of the others, and the pivots of a chain that nothing holds end at 0.
  subroutine check_chain(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: M = 60
    real(DP) :: gram(M, M), vectors(M, M)
    integer :: n, i
    do i = 1, 2
      call fill_chain(i == 1, gram)
      call find_null_vectors(gram, 1.0e-6_DP, n, vectors)
      call suite%that('chain: a free one alone has a motion', n == i - 1)
    end do
    call suite%near('chain: it moves as a whole', maxval(abs(vectors(:, 1) - 1.0_DP)), 0.0_DP, 1.0e-9_DP)
  end subroutine check_chain


  !> Springs of 1/2 between neighbours, and one to the ground at the first if it is held.
  pure subroutine fill_chain(is_held, gram)
    logical, intent(in) :: is_held
    real(DP), intent(out) :: gram(:, :)            !< (m, m)
    integer :: i, m
    m = size(gram, 1)
    gram = 0.0_DP
    do i = 1, m - 1
      gram(i, i) = gram(i, i) + 0.5_DP
      gram(i + 1, i + 1) = gram(i + 1, i + 1) + 0.5_DP
      gram(i, i + 1) = -0.5_DP
      gram(i + 1, i) = -0.5_DP
    end do
    if (is_held) gram(1, 1) = 1.0_DP
  end subroutine fill_chain

end program test_null_space
