!> Unit test of ranks: one process is rank 0 of 1 and keeps its numbers, errors and decisions. (verify/distributed runs several.)
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_mpi_ranks
  use amontons_errors, only: error_type, set_error, EXIT_IO, EXIT_USAGE
  use amontons_kinds, only: DP
  use amontons_mpi_ranks, only: begin_ranks, end_ranks, join_ranks, leave_ranks, this_rank, n_ranks, is_first_rank, &
    sum_over_ranks, gather_parts, min_over_ranks, share_error, check_agreement, is_shared_by_ranks
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(error_type), allocatable :: error
  real(DP) :: vector(3), table(2, 2), blocks(1, 2, 1)

  call begin_ranks()
  call suite%that('rank 0', this_rank() == 0)
  call suite%that('of 1', n_ranks() == 1)
  call suite%that('which writes', is_first_rank())
  vector = [1.0_DP, -2.5_DP, 0.1_DP]
  table = reshape([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP], [2, 2])
  blocks = 7.0_DP
  call sum_over_ranks(vector)
  call sum_over_ranks(table)
  call sum_over_ranks(blocks)
  call gather_parts(vector, [3])
  call suite%that('bits of a vector', all(abs(vector - [1.0_DP, -2.5_DP, 0.1_DP]) <= 0.0_DP))
  call suite%that('bits of a table', all(abs(table - reshape([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP], [2, 2])) <= 0.0_DP))
  call suite%that('bits of blocks', all(abs(blocks - 7.0_DP) <= 0.0_DP))
  call suite%that('least', abs(min_over_ranks(0.3_DP) - 0.3_DP) <= 0.0_DP)
  call share_error(error)
  call suite%that('no error', .not. allocated(error))
  call set_error(error, EXIT_IO, 'A file.')
  call share_error(error)
  call suite%that('its error', error%code == EXIT_IO .and. error%message == 'A file.')
  call suite%that('met', is_shared_by_ranks())
  deallocate (error)
  call check_agreement([1.0_DP, 2.0_DP], 'numbers', error)
  call suite%that('agreed', .not. allocated(error))
  call join_ranks(error)
  call suite%that('a job alone', .not. allocated(error))
  call leave_ranks()
  call join_ranks(error, 0)
  call suite%that('no communicator without MPI', error%code == EXIT_USAGE)
  call end_ranks()
  call suite%that('after the end', n_ranks() == 1)
  call suite%finish()

end program test_mpi_ranks
