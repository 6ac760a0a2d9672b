!> Unit test of distributed_two_level: on one rank it is conjugate gradients with the two-level preconditioner, to the last bit.
!! verify/distributed runs several ranks.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_distributed_two_level
  use amontons_distributed_two_level, only: distributed_two_level_type, create_distributed_two_level, &
    update_distributed_two_level, renew_distributed_matrix, apply_distributed_two_level, solve_distributed_two_level, &
    solve_distributed_unsymmetric, own_unknowns, compare_messages, describe_messages
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_krylov, only: krylov_options_type, krylov_report_type, KRYLOV_CONVERGED
  use amontons_sparse, only: sparse_type, sparse_from_triplets, multiply, multiply_symmetric
  use amontons_two_level_preconditioner, only: two_level_preconditioner_type, build_coarse_space, factorise_two_level, &
    apply_preconditioner
  use check, only: suite_type
  implicit none
  integer, parameter :: N_NODES = 200, N = 3 * N_NODES
  type(suite_type) :: suite
  type(distributed_two_level_type) :: solver
  type(two_level_preconditioner_type) :: levels
  type(sparse_type) :: matrix, skew
  type(krylov_report_type) :: report
  type(error_type), allocatable :: error
  integer :: i
  logical :: is_broken
  real(DP) :: b(N), x(N), z(N), expected(N)

  ! A chain of nodes with equal springs in three directions, fixed at one end: A = tridiagonal blocks.
  call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, N - 3)], [(i, i=1, N), (i + 3, i=1, N - 3)], &
    [(merge(2.0_DP, 1.0_DP, i <= N - 3), i=1, N), (-1.0_DP, i=1, N - 3)], matrix, error)
  call build_coarse_space(levels, [((i + 59) / 60, i=1, N)], [(1 + mod(i - 1, 3), i=1, N)], &
    reshape([(real((i + 2) / 3, DP), 0.0_DP, 0.1_DP * real(mod((i + 2) / 3, 2), DP), i=1, N)], [3, N]), N / 60)
  call create_distributed_two_level(solver, matrix, spread(0, 1, N), levels)
  call suite%that('no messages yet', describe_messages(solver) == '')
  call update_distributed_two_level(solver, matrix, is_broken, error)
  call suite%that('built', .not. (is_broken .or. allocated(error)))
  b = [(sin(real(i, DP)), i=1, N)]
  call factorise_two_level(levels, matrix, is_broken, error)
  call apply_preconditioner(levels, matrix, b, expected)
  call apply_distributed_two_level(solver, b, z)
  call suite%that('applied as by one process', maxval(abs(z - expected)) <= 1.0e-12_DP * maxval(abs(expected)))
  call solve_distributed_two_level(solver, .true., b, x, krylov_options_type(tolerance=1.0e-11_DP), report)
  call multiply_symmetric(matrix, x, z)
  call suite%that('solved', report%status == KRYLOV_CONVERGED .and. norm2(b - z) <= 1.1e-11_DP * norm2(b))
  call compare_messages(solver)
  call suite%that('what it reports', index(describe_messages(solver), 'at most 600 unknowns, 0 in its halo and 0 neighbours') > 0)

  ! (A - D) x = b with D skew-symmetric in the pattern of A, and with 2 A by the preconditioner of A.
  call sparse_from_triplets(N, N, [(i, i=1, N - 3), (i + 3, i=1, N - 3)], [(i + 3, i=1, N - 3), (i, i=1, N - 3)], &
    [(0.5_DP, i=1, N - 3), (-0.5_DP, i=1, N - 3)], skew, error)
  call suite%that('one rank has all unknowns', all(own_unknowns(solver) == [(i, i=1, N)]))
  call solve_distributed_unsymmetric(solver, .true., skew, b, x, krylov_options_type(tolerance=1.0e-11_DP), report, error)
  call multiply_symmetric(matrix, x, z)
  call multiply(skew, x, expected)
  call suite%that('solved with a skew-symmetric part', .not. allocated(error) .and. report%status == KRYLOV_CONVERGED .and. &
    norm2(b - z + expected) <= 1.1e-11_DP * norm2(b))
  matrix%value = 2.0_DP * matrix%value
  call renew_distributed_matrix(solver, matrix)
  call solve_distributed_two_level(solver, .false., b, z, krylov_options_type(tolerance=1.0e-11_DP), report)
  call multiply_symmetric(matrix, z, expected)
  call suite%that('solved by the preconditioner of earlier values', norm2(b - expected) <= 1.1e-11_DP * norm2(b))

  matrix%value(matrix%first(:N)) = -1.0_DP
  call update_distributed_two_level(solver, matrix, is_broken, error)
  call suite%that('an indefinite matrix has none', is_broken .and. .not. allocated(error))
  call suite%finish()

end program test_distributed_two_level
