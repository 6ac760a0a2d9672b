!> Unit test of distributed_solver: without PETSc the solver does not exist, and a request for it is an error.
!! verify/distributed runs the solver.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_distributed_solver
  use amontons_distributed_solver, only: distributed_solver_type, create_distributed, has_distributed_solvers, DISTRIBUTED_GAMG, &
    DISTRIBUTED_HYPRE, DISTRIBUTED_MUMPS, DISTRIBUTED_TWO_LEVEL, DISTRIBUTED_NAMES
  use amontons_errors, only: error_type, EXIT_SOLVER
  use amontons_kinds, only: DP
  use amontons_sparse, only: sparse_type
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(distributed_solver_type) :: solver
  type(sparse_type) :: matrix
  type(error_type), allocatable :: error
  real(DP) :: coordinates(3, 2)

  matrix = sparse_type(3, 3, [1, 3, 4, 5], [1, 2, 2, 3], [2.0_DP, -1.0_DP, 2.0_DP, 4.0_DP])
  coordinates = reshape([0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP], [3, 2])
  call suite%that('the library is without PETSc', .not. has_distributed_solvers())
  call create_distributed(solver, DISTRIBUTED_GAMG, matrix, [1, 2, 4], [0, 0], coordinates, error)
  call suite%that('error', allocated(error))
  if (allocated(error)) call suite%that('its code', error%code == EXIT_SOLVER .and. index(error%message, 'PETSc') > 0)
  call suite%that('names', DISTRIBUTED_NAMES(DISTRIBUTED_GAMG) == 'GAMG' .and. DISTRIBUTED_NAMES(DISTRIBUTED_HYPRE) == 'hypre' &
    .and. DISTRIBUTED_NAMES(DISTRIBUTED_MUMPS) == 'MUMPS' .and. DISTRIBUTED_NAMES(DISTRIBUTED_TWO_LEVEL) == 'two-level iteration')
  call suite%finish()

end program test_distributed_solver
