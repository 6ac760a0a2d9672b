!> Unit test of domain_matrix: one rank has the whole matrix, to the last bit, also where no element contributes to an unknown.
!! verify/distributed runs several ranks.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_domain_matrix
  use amontons_domain_matrix, only: domain_sum_type, plan_domain_sum, sum_domain
  use amontons_errors, only: error_type
  use amontons_halo, only: halo_type, halo_list_type, list_halos, find_halo_in_lists, list_domain
  use amontons_kinds, only: DP
  use amontons_sparse, only: sparse_type, sparse_from_triplets, is_same_pattern
  use check, only: suite_type
  implicit none
  integer, parameter :: N = 30
  type(suite_type) :: suite
  type(sparse_type) :: matrix, domain
  type(domain_sum_type) :: plan
  type(halo_type) :: halo
  type(halo_list_type) :: halos
  type(error_type), allocatable :: error
  integer :: owner(N), i

  ! A chain with a spring from every unknown but the last to the fifth after it.
  call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, N - 2), (i, i=1, N - 6)], &
    [(i, i=1, N), (i + 1, i=1, N - 2), (i + 5, i=1, N - 6)], [(real(i, DP), i=1, 3 * N - 8)], matrix, error)
  owner = 0
  call list_halos(halos, matrix, owner)
  call suite%that('one rank has no halo', size(halos%unknown) == 0 .and. all(halos%first == [1, 1]))
  call find_halo_in_lists(halo, halos, owner, 0)
  call suite%that('its domain is all', all(halo%unknown == [(i, i=1, N)]) .and. all(list_domain(halos, owner, 0) == halo%unknown))
  call plan_domain_sum(plan, matrix, [(i < N, i=1, N)], owner, halos, domain)
  call suite%that('pattern', is_same_pattern(matrix, domain))
  call suite%that('no neighbours', size(plan%neighbour) == 0 .and. size(plan%send) == 0)
  allocate (domain%value(size(domain%column)))
  call sum_domain(plan, matrix, domain)
  call suite%that('values', all(abs(domain%value - matrix%value) <= 0.0_DP))

  ! Rank 1 has every third unknown: its halo, as its neighbour lists it.
  owner = [(merge(1, 0, mod(i, 3) == 0), i=1, N)]
  halos%first = [1, 1 + count(owner == 1), 1 + N]
  halos%unknown = [pack([(i, i=1, N)], owner == 1), pack([(i, i=1, N)], owner == 0)]
  call find_halo_in_lists(halo, halos, owner, 1)
  call suite%that('own, then halo', halo%n_own == N / 3 .and. all(halo%unknown == [pack([(i, i=1, N)], owner == 1), &
    pack([(i, i=1, N)], owner == 0)]))
  call suite%that('what it sends', all(halo%neighbour == [0]) .and. all(halo%send == [(i, i=1, N / 3)]))
  call suite%that('holders', all(nint(halo%n_holders) == 2))
  call suite%finish()

end program test_domain_matrix
