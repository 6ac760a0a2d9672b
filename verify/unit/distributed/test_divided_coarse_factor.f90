!> Unit test of divided_coarse_factor on one rank: with a border and without one it solves the same system; statuses.
!! verify/distributed runs several ranks.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_divided_coarse_factor
  use amontons_divided_coarse_factor, only: divided_coarse_factor_type, divide_unknowns
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_sparse, only: sparse_type, sparse_from_triplets, multiply_symmetric
  use check, only: suite_type
  implicit none
  integer, parameter :: EDGE = 12, N = EDGE**2
  real(DP), parameter :: TOL_SINGLE = 2.0e-5_DP    !< of residuals: the condition number, some 100, times single precision [-]
  type(suite_type) :: suite
  type(divided_coarse_factor_type), allocatable :: factor
  type(sparse_type) :: matrix
  type(error_type), allocatable :: error
  real(DP), allocatable :: c(:)
  integer :: owner(N), k
  logical :: is_ready

  allocate (factor)
  call make_matrix(0.1_DP)
  call factorise()
  call suite%that('one rank has the whole', is_ready)
  call compare('one rank')
  call divide('no border', spread(0, 1, N))
  call factorise()
  call suite%that('no border', is_ready .and. factor%n_summed == 0)
  call compare('no border')

  call divide('all of another rank', spread(1, 1, N))
  call factorise()
  c = spread(1.0_DP, 1, N)
  call factor%solve(c)
  call suite%that('all of another rank', is_ready .and. maxval(abs(c)) <= 0.0_DP)

  owner = [(merge(-1, 0, mod(k, EDGE) == EDGE / 2), k=1, N)]     ! the border is a line of the grid
  call divide('a border')
  call suite%that('the border is summed', factor%n_summed == EDGE)
  call factorise()
  call suite%that('with a border', is_ready .and. factor%n_summed == EDGE)
  call compare('with a border')
  call make_matrix(0.3_DP)
  call factorise()
  call suite%that('other values', is_ready)
  call compare('other values')

  call divide('half of them', [(-mod(k, 2), k=1, N)])
  call suite%that('too large a border', factor%n_summed == N)

  call divide('a border again')
  call factor%factorise(matrix, spread(.true., 1, N), 10.0_DP, is_ready, error)
  call suite%that('too many entries', .not. (is_ready .or. allocated(error)))
  do k = 1, 2                                        ! an unknown of the border, and an inner one
    call make_matrix(0.1_DP)
    matrix%value(matrix%first(merge(EDGE / 2, 1, k == 1))) = -1.0_DP
    call factorise()
    call suite%that('indefinite', .not. is_ready)
  end do
  call suite%finish()

contains

  !> The five-point Laplacian of a grid plus a multiple of the identity.
  subroutine make_matrix(shift)
    real(DP), intent(in) :: shift
    call sparse_from_triplets(N, N, [(k, k=1, N), pack([(k, k=1, N)], mod([(k, k=1, N)], EDGE) /= 0), (k, k=1, N - EDGE)], &
      [(k, k=1, N), pack([(k + 1, k=1, N)], mod([(k, k=1, N)], EDGE) /= 0), (k + EDGE, k=1, N - EDGE)], &
      [(4.0_DP + shift, k=1, N), (-1.0_DP, k=1, N - EDGE), (-1.0_DP, k=1, N - EDGE)], matrix, error)
  end subroutine make_matrix


  !> Divides the factor anew.
  subroutine divide(name, owners)
    character(*), intent(in) :: name
    integer, intent(in), optional :: owners(:)         !< in place of `owner`
    deallocate (factor)
    allocate (factor)
    if (present(owners)) then
      call divide_unknowns(factor, matrix, owners, error)
    else
      call divide_unknowns(factor, matrix, owner, error)
    end if
    call suite%that(name // ': divided', .not. allocated(error))
  end subroutine divide


  !> Factorizes the present matrix.
  subroutine factorise()
    call factor%factorise(matrix, spread(.true., 1, N), huge(1.0_DP), is_ready, error)
    call suite%that('no error', .not. allocated(error))
  end subroutine factorise


  !> The residual of a solution.
  subroutine compare(name)
    character(*), intent(in) :: name
    real(DP) :: b(N), product(N)
    b = [(1.0e6_DP * sin(real(k * k, DP)), k=1, N)]
    c = b
    call factor%solve(c)
    call multiply_symmetric(matrix, c, product)
    call suite%that(name // ': residual', norm2(product - b) <= TOL_SINGLE * norm2(b))
  end subroutine compare

end program test_divided_coarse_factor
