!> Tests of contact operators: the change of forces of hand-made tangents by operator, by matrices and by products; levels; springs.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_operators
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, multiply
  use amontons_woodbury_interface, only: contact_springs_type
  use amontons_contact_linearization, only: contact_tangent_type, lower_levels
  use amontons_contact_operators, only: apply_contact_tangent, assemble_contact_tangents, assemble_spring_matrix, &
    factorise_spring_tangents
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: N_NODES = 6, N = 3 * N_NODES
  call check_one(suite)
  call check_matrices(suite)
  call check_levels(suite)
  call check_springs(suite)
  call check_none(suite)
  call suite%finish()

contains

  !> A tangent at a slave with two master nodes: all its parts full of different numbers.
  subroutine make_tangent(node, masters, level, is_compliant, tangent)
    integer, intent(in) :: node, masters(2), level
    logical, intent(in) :: is_compliant
    type(contact_tangent_type), intent(out) :: tangent
    integer :: i
    tangent%node = node
    tangent%level = level
    tangent%n_weights = 3
    tangent%nodes = [node, masters]
    tangent%weights = [1.0_DP, -0.3_DP, -0.7_DP]
    tangent%d_weights = reshape([0.0_DP, 0.0_DP, 0.5_DP, 0.1_DP, -0.5_DP, -0.1_DP], [2, 3])
    tangent%imbalance_nodes = [node]
    tangent%imbalance_weights = [1.0_DP]
    tangent%force = [1.0_DP, 2.0_DP, real(node, DP)]
    if (.not. is_compliant) tangent%force_imbalance = reshape([(sin(real(i + node, DP)), i=1, 9)], [3, 3])
    tangent%force_nodes = reshape([(cos(real(i * node, DP)), i=1, 27)], [3, 3, 3])
    tangent%xi_nodes = reshape([(sin(real(2 * i + node, DP)), i=1, 18)], [2, 3, 3])
    tangent%is_compliant_node = is_compliant
    tangent%spring = reshape([4.0_DP, 1.0_DP, 0.0_DP, 1.0_DP, 3.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 2.0_DP], [3, 3])
  end subroutine make_tangent


  !> A field of different numbers.
  pure function sample_field(k) result(field)
    integer, intent(in) :: k
    real(DP) :: field(3, N_NODES)
    integer :: i
    field = reshape([(sin(real(k * i * i, DP)), i=1, N)], [3, N_NODES])
  end function sample_field


  !> The diagonal matrix that lets half of each force through.
  subroutine make_condensation(E)
    type(sparse_type), intent(out) :: E
    type(error_type), allocatable :: error
    integer :: i
    call sparse_from_triplets(N, N, [(i, i=1, N)], [(i, i=1, N)], [(0.5_DP, i=1, N)], E, error)
  end subroutine make_condensation


  !> One tangent by hand: lambda changes by its imbalance and its nodes, the weights by xi.
  subroutine check_one(suite)
    type(suite_type), intent(inout) :: suite
    type(contact_tangent_type) :: tangent(1)
    type(sparse_type) :: E
    real(DP) :: du(3, N_NODES), dR(3, N_NODES), dF(3, N_NODES), d_lambda(3), d_xi(2), expected(3, N_NODES)
    integer :: j
    call make_tangent(1, [4, 5], 1, .false., tangent(1))
    call make_condensation(E)
    du = sample_field(1)
    dR = sample_field(2)
    call apply_contact_tangent(tangent, E, du, dR, dF)
    d_lambda = matmul(tangent(1)%force_imbalance, dR(:, 1))
    d_xi = 0.0_DP
    do j = 1, 3
      d_lambda = d_lambda + matmul(tangent(1)%force_nodes(:, :, j), du(:, tangent(1)%nodes(j)))
      d_xi = d_xi + matmul(tangent(1)%xi_nodes(:, :, j), du(:, tangent(1)%nodes(j)))
    end do
    expected = 0.0_DP
    expected(:, 1) = d_lambda
    expected(:, 4) = -0.3_DP * d_lambda + (0.5_DP * d_xi(1) + 0.1_DP * d_xi(2)) * tangent(1)%force
    expected(:, 5) = -0.7_DP * d_lambda - (0.5_DP * d_xi(1) + 0.1_DP * d_xi(2)) * tangent(1)%force
    call suite%near('one: by hand', maxval(abs(dF - expected)), 0.0_DP, 1.0e-14_DP)
    call suite%near('one: actio and reactio', norm2(sum(dF, dim=2)), 0.0_DP, 1.0e-14_DP)
  end subroutine check_one


  !> D_R dR + D_u du is what the operator gives, with two tangents at a node and with three levels.
  subroutine check_matrices(suite)
    type(suite_type), intent(inout) :: suite
    type(contact_tangent_type) :: tangents(4)
    type(sparse_type) :: E, d_r, d_u
    real(DP) :: dF(3, N_NODES), by_r(N), by_u(N)
    integer :: n_levels
    call make_condensation(E)
    do n_levels = 1, 3
      call make_tangent(1, [2, 3], 1, .false., tangents(1))
      call make_tangent(2, [3, 4], min(2, n_levels), .false., tangents(2))
      call make_tangent(3, [4, 5], n_levels, .false., tangents(3))
      call make_tangent(1, [6, 3], 1, .false., tangents(4))
      call apply_contact_tangent(tangents, E, sample_field(1), sample_field(2), dF)
      call assemble_contact_tangents(tangents, E, N, d_r, d_u)
      call multiply(d_r, reshape(sample_field(2), [N]), by_r)
      call multiply(d_u, reshape(sample_field(1), [N]), by_u)
      call suite%near('matrices: as the operator', maxval(abs(reshape(dF, [N]) - by_r - by_u)), 0.0_DP, 1.0e-12_DP)
    end do
    call suite%that('matrices: the second tangent of node 1 counts', maxval(abs(dF(:, 6))) > 0.0_DP)
  end subroutine check_matrices


  !> Levels without slaves in between are lowered, the change of forces stays: node 2 is a master of node 1, node 3 of node 2;
  !! node 4 acts on node 2, before which it must not come; node 6 acts on no other.
  subroutine check_levels(suite)
    type(suite_type), intent(inout) :: suite
    type(contact_tangent_type) :: tangents(5)
    type(sparse_type) :: E
    real(DP) :: before(3, N_NODES), after(3, N_NODES)
    call make_condensation(E)
    call make_tangent(1, [2, 5], 1, .false., tangents(1))
    call make_tangent(2, [3, 5], 3, .false., tangents(2))
    call make_tangent(3, [5, 5], 7, .false., tangents(3))
    call make_tangent(4, [2, 5], 5, .false., tangents(4))
    call make_tangent(6, [5, 5], 4, .false., tangents(5))
    call apply_contact_tangent(tangents, E, sample_field(1), sample_field(2), before)
    call lower_levels(E, tangents)
    call suite%that('levels: lowered', all(tangents%level == [1, 2, 3, 2, 1]))
    call apply_contact_tangent(tangents, E, sample_field(1), sample_field(2), after)
    call suite%near('levels: the same forces', maxval(abs(after - before)), 0.0_DP, 1.0e-14_DP)
  end subroutine check_levels


  !> Springs as products give the same change of forces; the symmetric part is w w' k between all nodes of a row.
  subroutine check_springs(suite)
    type(suite_type), intent(inout) :: suite
    type(contact_tangent_type) :: tangents(2)
    type(contact_springs_type) :: springs
    type(sparse_type) :: E, matrix
    type(error_type), allocatable :: error
    real(DP) :: dF(3, N_NODES), none(3, N_NODES), along(6), moved(4), by_spread(N), by_motion(N)
    integer :: p
    call make_condensation(E)
    none = 0.0_DP
    call make_tangent(1, [4, 5], 1, .true., tangents(1))
    call make_tangent(2, [5, 6], 1, .true., tangents(2))
    call apply_contact_tangent(tangents, E, sample_field(1), none, dF)
    call factorise_spring_tangents(tangents, N, springs, error)
    call multiply(springs%spring_tangent, reshape(sample_field(1), [N]), along)
    call multiply(springs%projection_gradient, reshape(sample_field(1), [N]), moved)
    call multiply(springs%force_distribution, along, by_spread)
    call multiply(springs%distribution_change, moved, by_motion)
    call suite%near('springs: products', maxval(abs(reshape(dF, [N]) - by_spread - by_motion)), 0.0_DP, 1.0e-13_DP)
    tangents(2)%is_compliant_node = .false.
    call assemble_spring_matrix(tangents, N, matrix)
    call suite%near('springs: at the slave', matrix%value(matrix%first(1)), 4.0_DP, 0.0_DP)
    p = matrix%first(11)                           ! node 4, y
    call suite%near('springs: at a master', matrix%value(p), 0.09_DP * 3.0_DP, 1.0e-15_DP)
    call suite%that('springs: upper triangle', all([(minval(matrix%column(matrix%first(p):matrix%first(p + 1) - 1)) >= p, p=1, N)]))
    call suite%that('springs: of held friction', matrix%first(19) > matrix%first(16) .and. matrix%first(7) > matrix%first(4))
    tangents(2)%spring = 0.0_DP
    call assemble_spring_matrix(tangents, N, matrix)
    call suite%that('springs: none of exact contact', matrix%first(16) == matrix%first(19) .and. matrix%first(4) == matrix%first(7))
  end subroutine check_springs


  !> Without closed nodes nothing changes.
  subroutine check_none(suite)
    type(suite_type), intent(inout) :: suite
    type(contact_tangent_type) :: tangents(0)
    type(sparse_type) :: E, d_r, d_u
    real(DP) :: dF(3, N_NODES)
    call make_condensation(E)
    call apply_contact_tangent(tangents, E, sample_field(1), sample_field(2), dF)
    call suite%near('none: no force', norm2(dF), 0.0_DP, 0.0_DP)
    call assemble_contact_tangents(tangents, E, N, d_r, d_u)
    call suite%that('none: matrices without entries', size(d_r%value) == 0 .and. size(d_u%value) == 0 .and. d_u%n_rows == N)
  end subroutine check_none

end program test_contact_operators
