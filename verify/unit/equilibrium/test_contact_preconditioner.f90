!> Unit test of contact_preconditioner: two supported chains with a frictional contact row, against dense matrices.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_preconditioner
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_factorization, only: FACTOR_OK
  use amontons_constraints, only: constraints_type, reset_constraints, prescribe_unknown, &
    eliminate_constraints
  use amontons_reduced_system, only: factorise_reduced_system
  use amontons_contact_preconditioner, only: skin_type, partition_skin, update_skin, apply_bulk, apply_tiles, subtract_contact
  use check, only: suite_type
  use samples, only: dense_of, add_oblique_row, make_chain_mesh
  implicit none
  integer, parameter :: N_NODES = 20, N = 3 * N_NODES, SLAVE = 11, MASTER = 10
  real(DP), parameter :: MU = 0.3_DP
  type(suite_type) :: suite
  type(sparse_type) :: K, D_R, D_u
  type(constraints_type) :: base, whole
  type(mesh_type) :: mesh
  call make_chains()
  call check_bulk_alone()
  call check_symmetry()
  call check_tile(.false.)
  call check_tile(.true.)
  call check_forces()
  call check_following()
  call check_membership()
  call suite%finish()

contains

  !> Bars between neighbours but for nodes 10 and 11; both ends fixed. The slave's row is oblique, its friction acts along y.
  subroutine make_chains()
    type(error_type), allocatable :: error
    integer :: i
    call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, N - 3)], [(i, i=1, N), (i + 3, i=1, N - 3)], &
      [(5.0_DP, i=1, N), (merge(0.0_DP, -2.0_DP, (i + 2) / 3 == MASTER), i=1, N - 3)], K, error)
    call fix_ends(base)
    call eliminate_constraints(base)
    call fix_ends(whole)
    call add_oblique_row(SLAVE, MASTER, MU, whole, D_R, D_u)
    call make_chain_mesh([(real(mod(i, 7), DP) + real(i, DP), i=1, N)], mesh)
  end subroutine make_chains


  !> Fixes the first and the last node.
  subroutine fix_ends(constraints)
    type(constraints_type), intent(inout) :: constraints
    integer :: i
    call reset_constraints(constraints, N)
    do i = 1, 3
      call prescribe_unknown(constraints, i, 0.0_DP)
      call prescribe_unknown(constraints, N - 3 + i, 0.0_DP)
    end do
  end subroutine fix_ends


  !> The preconditioner with the bulk K and a tile of the nodes 10 and 11.
  subroutine make_skin(constraints, skin, has_jump, share)
    type(constraints_type), intent(in) :: constraints
    type(skin_type), intent(out) :: skin
    logical, intent(in), optional :: has_jump      !< the slave's displacement is that of the master and a jump
    real(DP), intent(in), optional :: share        !< in which the slave follows the master, 1 without it [-]
    type(sparse_type) :: rows, motion
    integer :: n_following, i
    real(DP) :: amount
    type(error_type), allocatable :: error
    integer :: status
    call partition_skin(skin, mesh%coordinates, [SLAVE], 64)
    call factorise_reduced_system(skin%robin, K, .false., base, mesh, status, error)
    call suite%that('bulk: factor', status == FACTOR_OK)
    rows%n_rows = 1
    rows%n_columns = N_NODES
    rows%first = [1, 3]
    rows%column = [SLAVE, MASTER]
    rows%value = [1.0_DP, 1.0_DP]
    n_following = 0
    if (present(has_jump)) n_following = merge(3, 0, has_jump)
    amount = 1.0_DP
    if (present(share)) amount = share
    call sparse_from_triplets(N, N, [(3 * SLAVE - 3 + i, i=1, n_following)], [(3 * MASTER - 3 + i, i=1, n_following)], &
      [(amount, i=1, n_following)], motion, error)
    skin%by_imbalance = D_R
    skin%by_displacement = D_u
    call update_skin(skin, base, constraints, K, rows, motion, error)
    call suite%that('skin: renewed', .not. allocated(error) .and. skin%n_tiles == 1)
  end subroutine make_skin


  !> J = C' ((1 + D_R) K - D_u) C.
  pure function tangent() result(J)
    real(DP) :: J(whole%n_free, whole%n_free), C(N, whole%n_free), stiffness(N, N)
    C = dense_of(whole%transformation)
    stiffness = dense_of(K, is_symmetric=.true.)
    J = matmul(transpose(C), matmul(stiffness + matmul(dense_of(D_R), stiffness) - dense_of(D_u), C))
  end function tangent


  !> Any numbers.
  pure function numbers(n_numbers, seed) result(values)
    integer, intent(in) :: n_numbers, seed
    real(DP) :: values(n_numbers)
    integer :: i
    values = [(sin(real(seed * i * i + i, DP)), i=1, n_numbers)]
  end function numbers


  !> Without contact rows the bulk solver is inv(K).
  subroutine check_bulk_alone()
    type(skin_type) :: skin
    real(DP) :: r(base%n_free), x(base%n_free), C(N, base%n_free)
    call make_skin(base, skin)
    r = numbers(base%n_free, 3)
    call apply_bulk(skin, r, x)
    C = dense_of(base%transformation)
    call suite%near('no rows: K x = r', &
      maxval(abs(matmul(transpose(C), matmul(dense_of(K, is_symmetric=.true.), matmul(C, x))) - r)), 0.0_DP, 1.0e-12_DP)
  end subroutine check_bulk_alone


  !> R Pi P Pi' R' is symmetric, and positive in a direction that moves slave and master together.
  subroutine check_symmetry()
    type(skin_type) :: skin
    real(DP), dimension(whole%n_free) :: a, b, of_a, of_b
    call make_skin(whole, skin)
    a = numbers(whole%n_free, 1)
    b = numbers(whole%n_free, 2)
    call apply_bulk(skin, a, of_a)
    call apply_bulk(skin, b, of_b)
    call suite%near('symmetric', dot_product(b, of_a), dot_product(a, of_b), 1.0e-12_DP)
    call suite%that('positive', dot_product(a, of_a) > 0.0_DP .and. dot_product(b, of_b) > 0.0_DP)
  end subroutine check_symmetry


  !> After the tile's correction nothing remains of the residual on the tile, whatever x was; the other unknowns keep their values.
  subroutine check_tile(has_jump)
    logical, intent(in) :: has_jump
    type(skin_type) :: skin
    real(DP), dimension(whole%n_free) :: r, x, before, rest
    logical :: is_inside(whole%n_free)
    integer :: i
    call make_skin(whole, skin, has_jump)
    is_inside = .false.
    do i = 3 * MASTER - 2, 3 * SLAVE
      if (whole%free_of(i) > 0) is_inside(whole%free_of(i)) = .true.
    end do
    r = numbers(whole%n_free, 5)
    x = numbers(whole%n_free, 7)
    before = x
    call apply_tiles(skin, r - matmul(tangent(), x), x)
    rest = r - matmul(tangent(), x)
    call suite%that('tile: five unknowns', count(is_inside) == 5)
    call suite%near('tile: no residual', maxval(abs(pack(rest, is_inside))), 0.0_DP, 1.0e-5_DP)
    call suite%that('tile: the others stay', all(abs(pack(x - before, .not. is_inside)) <= 0.0_DP))
    call suite%that('tile: a correction', maxval(abs(x - before)) > 0.01_DP)
  end subroutine check_tile


  !> w - D_R dRhat - D_u du.
  subroutine check_forces()
    type(skin_type) :: skin
    real(DP), dimension(N) :: du, d_imbalance, w, expected
    call make_skin(whole, skin)
    du = numbers(N, 1)
    d_imbalance = numbers(N, 2)
    w = numbers(N, 3)
    expected = w - matmul(dense_of(D_R), d_imbalance) - matmul(dense_of(D_u), du)
    call subtract_contact(skin, du, d_imbalance, w)
    call suite%near('forces', maxval(abs(w - expected)), 0.0_DP, 1.0e-14_DP)
  end subroutine check_forces


  !> A slave that follows its master in the share s: x = R Pi P Pi' R' r with Pi = 1 - s (e_s e_s' - e_s e_m').
  subroutine check_following()
    real(DP), parameter :: SHARE = 0.75_DP
    type(skin_type) :: skin
    real(DP), dimension(base%n_free) :: r, x, y, alone
    real(DP) :: C(N, base%n_free), projection(N, N)
    integer :: i
    call make_skin(base, skin, .true., SHARE)
    r = numbers(base%n_free, 3)
    call apply_bulk(skin, r, x)
    C = dense_of(base%transformation)
    projection = 0.0_DP
    do i = 1, N
      projection(i, i) = 1.0_DP
    end do
    do i = 1, 3
      projection(3 * SLAVE - 3 + i, 3 * SLAVE - 3 + i) = 1.0_DP - SHARE
      projection(3 * SLAVE - 3 + i, 3 * MASTER - 3 + i) = SHARE
    end do
    call make_skin(base, skin)
    alone = matmul(transpose(C), matmul(transpose(projection), matmul(C, r)))
    call apply_bulk(skin, alone, y)
    call suite%near('follows', maxval(abs(x - matmul(transpose(C), matmul(projection, matmul(C, y))))), 0.0_DP, 1.0e-12_DP)
    call suite%that('alone it does not', maxval(abs(x - y)) > 0.01_DP)
  end subroutine check_following


  !> A master node of two slaves belongs to the tile of the one whose row has the larger weight, whichever comes first: a force on
  !! it moves that slave alone.
  subroutine check_membership()
    integer, parameter :: FIRST = 12, SECOND = 9   ! slaves; the master is a neighbour of the second
    type(skin_type) :: skin
    type(sparse_type) :: rows, motion
    type(error_type), allocatable :: error
    real(DP), dimension(base%n_free) :: r, x
    integer :: i, status, turn
    do turn = 1, 2
      call partition_skin(skin, mesh%coordinates, [FIRST, SECOND], 1)
      call factorise_reduced_system(skin%robin, K, .false., base, mesh, status, error)
      rows%n_rows = 2
      rows%n_columns = N_NODES
      rows%first = [1, 3, 5]
      rows%column = [FIRST, MASTER, SECOND, MASTER]
      rows%value = [1.0_DP, merge(0.1_DP, 0.9_DP, turn == 1), 1.0_DP, merge(0.9_DP, 0.1_DP, turn == 1)]
      call sparse_from_triplets(N, N, [integer ::], [integer ::], [real(DP) ::], motion, error)
      skin%by_imbalance = D_R
      skin%by_displacement = D_u
      call update_skin(skin, base, base, K, rows, motion, error)
      call suite%that('two tiles', .not. allocated(error) .and. skin%n_tiles == 2)
      r = 0.0_DP
      r(base%free_of([(3 * MASTER - 3 + i, i=1, 3)])) = [1.0_DP, 2.0_DP, 3.0_DP]
      x = 0.0_DP
      call apply_tiles(skin, r, x)
      call suite%that('the tile of the larger weight', &
        any(abs(x(base%free_of([(3 * SECOND - 3 + i, i=1, 3)]))) > 0.01_DP) .eqv. turn == 1)
      call suite%that('not the other slave', all(abs(x(base%free_of([(3 * FIRST - 3 + i, i=1, 3)]))) <= 0.0_DP))
    end do
  end subroutine check_membership

end program test_contact_preconditioner
