!> Unit test of halo: the lists of four ranks fit each other, and the messages between them give the product with the whole matrix.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_halo
  use amontons_errors, only: error_type
  use amontons_halo, only: halo_type, find_halo, fill_halo, return_halo
  use amontons_kinds, only: DP
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use check, only: suite_type
  implicit none
  integer, parameter :: N = 30
  type(suite_type) :: suite
  type(sparse_type) :: matrix
  type(halo_type) :: halo(0:3), alone
  type(error_type), allocatable :: error
  integer :: owner(N), i, r
  real(DP) :: x(N)

  ! A chain whose unknowns belong to the ranks in turn of three, with a spring from every unknown to the fifth after it.
  owner = [(mod((i - 1) / 3, 4), i=1, N)]
  call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, N - 1), (i, i=1, N - 5)], &
    [(i, i=1, N), (i + 1, i=1, N - 1), (i + 5, i=1, N - 5)], [(1.0_DP, i=1, 3 * N - 6)], matrix, error)
  do r = 0, 3
    call find_halo(halo(r), matrix, owner, r)
  end do
  call suite%that('own unknowns ascend', all([(all(halo(r)%unknown(:halo(r)%n_own) == pack([(i, i=1, N)], owner == r)), r=0, 3)]))
  call suite%that('each unknown has one owner', sum(halo%n_own) == N)
  do r = 0, 3
    call suite%that('the halo is all that entries join', has_all_neighbours(halo(r), r))
    call suite%that('what neighbours send is what it lists', do_lists_fit(r))
  end do
  call suite%that('holders', sum([(sum(halo(r)%n_holders), r=0, 3)]) >= real(N, DP) .and. &
    nint(sum([(sum(halo(r)%n_holders), r=0, 3)])) == sum([(size(halo(r)%unknown), r=0, 3)]))

  call find_halo(alone, matrix, spread(0, 1, N), 0)
  x = [(real(i, DP), i=1, N)]
  call fill_halo(alone, x)
  call return_halo(alone, x)
  call suite%that('one rank has no halo', size(alone%unknown) == N .and. size(alone%neighbour) == 0 .and. alone%n_bytes == 0)
  call suite%that('and keeps its numbers', all(abs(x - [(real(i, DP), i=1, N)]) <= 0.0_DP))
  call suite%finish()

contains

  !> Whether the domain of a rank is its unknowns and all that an entry joins to them, and nothing else.
  logical function has_all_neighbours(self, rank)
    type(halo_type), intent(in) :: self
    integer, intent(in) :: rank
    logical :: is_expected(N), is_listed(N)
    integer :: k, p
    is_expected = owner == rank
    is_listed = .false.
    is_listed(self%unknown) = .true.
    do k = 1, N
      do p = matrix%first(k), matrix%first(k + 1) - 1
        if (owner(k) == rank) is_expected(matrix%column(p)) = .true.
        if (owner(matrix%column(p)) == rank) is_expected(k) = .true.
      end do
    end do
    has_all_neighbours = all(is_expected .eqv. is_listed) .and. count(is_listed) == size(self%unknown)
  end function has_all_neighbours


  !> Whether each neighbour sends the unknowns of the halo of a rank in the order in which the rank lists them.
  logical function do_lists_fit(rank)
    integer, intent(in) :: rank
    integer :: k, m, other
    do_lists_fit = .true.
    do k = 1, size(halo(rank)%neighbour)
      other = halo(rank)%neighbour(k)
      m = findloc(halo(other)%neighbour, rank, dim=1)
      do_lists_fit = do_lists_fit .and. m > 0
      if (m == 0) return
      associate (sent => halo(other)%send(halo(other)%send_first(m):halo(other)%send_first(m + 1) - 1), &
        listed => halo(rank)%unknown(halo(rank)%n_own + halo(rank)%first(k):halo(rank)%n_own + halo(rank)%first(k + 1) - 1))
        do_lists_fit = do_lists_fit .and. size(sent) == size(listed)
        if (do_lists_fit) do_lists_fit = all(halo(other)%unknown(sent) == listed) .and. all(owner(listed) == other)
      end associate
    end do
  end function do_lists_fit

end program test_halo
