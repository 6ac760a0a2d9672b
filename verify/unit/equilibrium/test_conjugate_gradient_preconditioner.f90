!> Tests of the preconditioners of conjugate gradients: nodal blocks against the dense C'KC, and their inverses.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_conjugate_gradient_preconditioner
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY
  use amontons_constraints, only: constraints_type, constraint_row_type, reset_constraints, prescribe_unknown, add_constraint_row, &
    eliminate_constraints
  use amontons_contact_linearization, only: contact_tangent_type
  use amontons_conjugate_gradient_preconditioner, only: sum_nodal_blocks, invert_nodal_block
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_blocks(suite)
  call check_inverse(suite)
  call suite%finish()

contains

  !> Three nodes: the first fixed along y, the second between the first and the third (u_2x = 0.3 u_1x + 0.7 u_3x + 0.1 u_3z), a
  !! spring between the nodes 1 and 3, one of held friction between 3 and 2. The blocks are those of the dense product.
  subroutine check_blocks(suite)
    type(suite_type), intent(inout) :: suite
    type(constraints_type) :: constraints
    type(constraint_row_type) :: row
    type(contact_tangent_type) :: tangents(2)
    real(DP) :: stiffness(3, 3, 3), K(9, 9), C(9, 9), A(9, 9)
    real(DP), allocatable :: blocks(:, :, :)
    integer, allocatable :: unknown(:)
    integer :: n, i, j, p, verdict
    call reset_constraints(constraints, 9)
    call prescribe_unknown(constraints, 2, 0.5_DP)
    row%unknown = [4, 1, 7, 9]
    row%coefficient = [1.0_DP, -0.3_DP, -0.7_DP, -0.1_DP]
    call add_constraint_row(constraints, row, 1, 1.0e-6_DP, verdict)
    call eliminate_constraints(constraints)
    K = 0.0_DP
    do n = 1, 3
      stiffness(:, :, n) = real(n, DP) * reshape([4.0_DP, 1.0_DP, 0.5_DP, 1.0_DP, 3.0_DP, -0.7_DP, 0.5_DP, -0.7_DP, 5.0_DP], [3, 3])
      K(3 * n - 2:3 * n, 3 * n - 2:3 * n) = stiffness(:, :, n)
    end do
    tangents(1)%is_compliant_node = .true.
    tangents(1)%n_weights = 2
    tangents(1)%nodes = [1, 3]
    tangents(1)%weights = [1.0_DP, -0.5_DP]
    tangents(1)%spring = 2.0_DP * IDENTITY
    tangents(2)%n_weights = 2                      ! it has a row as well: the node slips
    tangents(2)%nodes = [3, 2]
    tangents(2)%weights = [1.0_DP, -0.25_DP]
    tangents(2)%spring = reshape([3.0_DP, 0.5_DP, 0.0_DP, 0.5_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], [3, 3])
    K(7:9, 7:9) = K(7:9, 7:9) + tangents(2)%spring
    K(4:6, 4:6) = K(4:6, 4:6) + 0.0625_DP * tangents(2)%spring
    K(1:3, 1:3) = K(1:3, 1:3) + 2.0_DP * IDENTITY
    K(7:9, 7:9) = K(7:9, 7:9) + 0.5_DP * IDENTITY
    C = 0.0_DP
    associate (map => constraints%transformation)
      do i = 1, 9
        do p = map%first(i), map%first(i + 1) - 1
          C(i, findloc(constraints%free_of, map%column(p), dim=1)) = map%value(p)
        end do
      end do
    end associate
    A = matmul(transpose(C), matmul(K, C))
    call sum_nodal_blocks(constraints, tangents, stiffness, unknown, blocks)
    call suite%that('blocks: free unknowns', size(unknown) == 7 .and. all(unknown == [1, 3, 5, 6, 7, 8, 9]))
    do n = 1, 3
      call suite%near('blocks: those of the product', maxval(abs(blocks(:, :, n) - A(3 * n - 2:3 * n, 3 * n - 2:3 * n))), 0.0_DP, &
        1.0e-13_DP)
    end do
    call suite%that('blocks: the dependent node adds to the third', blocks(1, 3, 3) > stiffness(1, 3, 3) + 0.1_DP)
    call suite%near('blocks: no fixed unknown', sum([(abs(blocks(2, j, 1)), j=1, 3)]), 0.0_DP, 1.0e-15_DP)
  end subroutine check_blocks


  !> Inverses: of a whole block, of one with a fixed direction, and the diagonal in place of an indefinite one.
  subroutine check_inverse(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: block(3, 3), inverse(3, 3)
    block = reshape([4.0_DP, 1.0_DP, 0.5_DP, 1.0_DP, 3.0_DP, -0.7_DP, 0.5_DP, -0.7_DP, 5.0_DP], [3, 3])
    call invert_nodal_block(block, [.true., .true., .true.], 1.0_DP, inverse)
    call suite%near('inverse: whole', maxval(abs(matmul(block, inverse) - IDENTITY)), 0.0_DP, 1.0e-14_DP)
    call invert_nodal_block(block, [.true., .false., .true.], 1.0_DP, inverse)
    call suite%near('inverse: fixed direction', maxval(abs(inverse([1, 3], [1, 3]) - reshape([5.0_DP, -0.5_DP, -0.5_DP, 4.0_DP], &
      [2, 2]) / 19.75_DP)), 0.0_DP, 1.0e-14_DP)
    call suite%near('inverse: nothing along it', maxval(abs(inverse(2, :))) + maxval(abs(inverse(:, 2))), 0.0_DP, 1.0e-15_DP)
    block(1, 1) = -4.0_DP
    block(3, 3) = 0.0_DP
    call invert_nodal_block(block, [.true., .true., .true.], 8.0_DP, inverse)
    call suite%near('inverse: indefinite', maxval(abs(inverse - reshape([0.25_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP / 3.0_DP, 0.0_DP, &
      0.0_DP, 0.0_DP, 0.125_DP], [3, 3]))), 0.0_DP, 1.0e-14_DP)
  end subroutine check_inverse

end program test_conjugate_gradient_preconditioner
