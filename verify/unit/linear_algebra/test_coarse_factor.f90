!> Unit test of coarse_factor: solution and statuses.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_coarse_factor
  use amontons_coarse_factor, only: coarse_factor_type, is_analysed_pattern
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_sparse, only: sparse_type, sparse_from_triplets, multiply_symmetric
  use check, only: suite_type
  implicit none
  integer, parameter :: N = 50
  real(DP), parameter :: TOL_SINGLE = 1.0e-5_DP    !< of residuals: the condition number, some 20, times single precision [-]
  type(suite_type) :: suite
  type(coarse_factor_type) :: factor
  type(sparse_type) :: matrix
  type(error_type), allocatable :: error
  real(DP) :: b(N), product(N)
  real(DP), allocatable :: c(:)
  logical :: is_ready
  integer :: i

  ! A chain of springs, grounded; unknown 7 has no entries.
  call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, N - 1)], [(i, i=1, N), (i + 1, i=1, N - 1)], &
    [(merge(0.0_DP, 2.2_DP, i == 7), i=1, N), (merge(0.0_DP, -1.0_DP, i == 6 .or. i == 7), i=1, N - 1)], matrix, error)
  call factor%factorise(matrix, spread(.true., 1, N), 10.0_DP, is_ready, error)
  call suite%that('too many entries', .not. (is_ready .or. allocated(error)))
  call factor%factorise(matrix, spread(.true., 1, N), huge(1.0_DP), is_ready, error)
  call suite%that('ready', is_ready .and. .not. allocated(error) .and. is_analysed_pattern(factor, matrix))
  call suite%that('an empty row gets 1', matrix%value(matrix%first(7)) == 1.0_DP)
  b = [(1.0e6_DP * sin(real(i * i, DP)), i=1, N)]
  c = b
  call factor%solve(c)
  call multiply_symmetric(matrix, c, product)
  call suite%that('residual', norm2(product - b) <= TOL_SINGLE * norm2(b))
  matrix%value(matrix%first(3)) = -1.0_DP
  call factor%factorise(matrix, spread(.true., 1, N), huge(1.0_DP), is_ready, error)
  call suite%that('indefinite', .not. (is_ready .or. allocated(error)))
  call suite%finish()

end program test_coarse_factor
