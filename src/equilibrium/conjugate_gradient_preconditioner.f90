!> Preconditioners of nonlinear conjugate gradients: diagonal, nodal blocks, two levels, multigrid, factor; all of A = C'KC.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! DIAGONAL and NODAL need the diagonal blocks K_n of the nodes alone, never a matrix. Of the sum
!!
!!     A = sum over n, m of C_n' K_nm C_m        C_n: the three rows of C of node n
!!
!! they keep n = m, and of C_n' K_n C_n the blocks that couple unknowns of one node (NODAL) or the diagonal (DIAGONAL): so a closed
!! slave node adds its stiffness, weighted, to the nodes of its master. TWO LEVEL, AMG and FACTOR are those of `reduced_system`.
!! Springs of contact (compliant laws, friction that is held) are part of K.
module amontons_conjugate_gradient_preconditioner
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_model, only: model_type
  use amontons_controls, only: PRECONDITIONER_NODAL, PRECONDITIONER_DIAGONAL, PRECONDITIONER_TWO_LEVEL, PRECONDITIONER_AMG
  use amontons_steps, only: step_type, SOLVER_AUTO, SOLVER_ITERATIVE, SOLVER_GAMG
  use amontons_sparse, only: is_same_pattern
  use amontons_reduced_system, only: apply_reduced_inverse, USE_REPEATED
  use amontons_constraints, only: constraints_type
  use amontons_contact_linearization, only: contact_tangent_type, has_spring
  use amontons_equilibrium, only: equilibrium_type, OUTCOME_OK
  use amontons_newton_step, only: factorise_reduced_matrix
  implicit none
  private
  public :: gradient_preconditioner_type, update_gradient_preconditioner, apply_gradient_preconditioner
  public :: sum_nodal_blocks, invert_nodal_block

  real(DP), parameter :: MIN_PIVOT = 1.0e-8_DP     !< least pivot of a nodal block over its diagonal entry; below, the block is
                                                   !! replaced by its diagonal [-]

  !> The preconditioner of the present C and K.
  type :: gradient_preconditioner_type
    logical :: is_matrix = .false.                 !< TWO LEVEL, AMG or FACTOR: kept in the reduced system
    logical :: is_factorised = .false.             !< there is one of this attempt
    integer, allocatable :: unknown(:)             !< (n_free) among all unknowns, ascending
    real(DP), allocatable :: inverse(:, :)         !< (3, n_free) row of the inverse of its nodal block [length/force]
  end type gradient_preconditioner_type

contains

  !> Computes the preconditioner for the constraints and the stiffness of the last linearization. A factor is kept as long as C has
  !! the same pattern and `is_new_attempt` does not require the present K.
  subroutine update_gradient_preconditioner(self, system, model, step, is_new_attempt, outcome, error)
    type(gradient_preconditioner_type), intent(inout) :: self
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_new_attempt
    integer, intent(out) :: outcome                !< OUTCOME_OK or OUTCOME_LINEAR_SOLVER
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: blocks(:, :, :)
    outcome = OUTCOME_OK
    self%is_matrix = all(step%controls%gradients%preconditioner /= [PRECONDITIONER_NODAL, PRECONDITIONER_DIAGONAL])
    if (.not. self%is_matrix) then
      call sum_nodal_blocks(system%constraints, system%contact_tangents, system%nodal_stiffness, self%unknown, blocks)
      call invert_blocks(self, blocks, step%controls%gradients%preconditioner == PRECONDITIONER_DIAGONAL)
      return
    end if
    associate (reduced => system%reduced_system)
      if (is_new_attempt .and. .not. system%is_constant) self%is_factorised = .false.
      if (self%is_factorised) then
        if (is_same_pattern(system%constraints%transformation, reduced%analysed_map)) return
      end if
      reduced%requested_solver = SOLVER_AUTO
      if (step%controls%gradients%preconditioner == PRECONDITIONER_TWO_LEVEL) reduced%requested_solver = SOLVER_ITERATIVE
      if (step%controls%gradients%preconditioner == PRECONDITIONER_AMG) reduced%requested_solver = SOLVER_GAMG
      reduced%use = USE_REPEATED
      if (.not. system%is_constant .or. .not. self%is_factorised) reduced%is_current = .false.
    end associate
    call factorise_reduced_matrix(system, model, outcome, error)
    self%is_factorised = outcome == OUTCOME_OK .and. .not. allocated(error)
  end subroutine update_gradient_preconditioner


  !> The part of A that couples the unknowns of each node, from the diagonal blocks of K and of the springs of contact.
  subroutine sum_nodal_blocks(constraints, tangents, stiffness, unknown, blocks)
    type(constraints_type), intent(in) :: constraints
    type(contact_tangent_type), intent(in) :: tangents(:)
    real(DP), intent(in) :: stiffness(:, :, :)     !< (3, 3, n_nodes) diagonal blocks of K [force/length]
    integer, allocatable, intent(out) :: unknown(:)   !< (n_free) number of each free unknown among all
    real(DP), allocatable, intent(out) :: blocks(:, :, :)   !< (3, 3, n_nodes) [force/length]
    integer :: node, i, j
    allocate (unknown(constraints%n_free), blocks(3, 3, size(stiffness, 3)))
    do i = 1, constraints%n_unknowns
      if (constraints%free_of(i) > 0) unknown(constraints%free_of(i)) = i
    end do
    blocks = 0.0_DP
    do node = 1, size(stiffness, 3)
      call add_transformed(node, stiffness(:, :, node))
    end do
    do i = 1, size(tangents)
      if (.not. has_spring(tangents(i))) cycle
      do j = 1, tangents(i)%n_weights
        call add_transformed(tangents(i)%nodes(j), tangents(i)%weights(j)**2 * tangents(i)%spring)
      end do
    end do

  contains

    !> Adds C_n' K_n C_n.
    subroutine add_transformed(n, block)
      integer, intent(in) :: n
      real(DP), intent(in) :: block(3, 3)
      integer, allocatable :: axis(:), row(:)      ! of the entries of C_n
      integer :: p, q, first, a
      associate (C => constraints%transformation)
        first = C%first(3 * n - 2)
        row = unknown(C%column(first:C%first(3 * n + 1) - 1))
        axis = [((a, p=C%first(3 * n - 3 + a), C%first(3 * n - 2 + a) - 1), a=1, 3)]
        do p = 1, size(row)
          do q = 1, size(row)
            if ((row(p) + 2) / 3 /= (row(q) + 2) / 3) cycle
            associate (entry => blocks(mod(row(p) - 1, 3) + 1, mod(row(q) - 1, 3) + 1, (row(p) + 2) / 3))
              entry = entry + C%value(first + p - 1) * block(axis(p), axis(q)) * C%value(first + q - 1)
            end associate
          end do
        end do
      end associate
    end subroutine add_transformed

  end subroutine sum_nodal_blocks


  !> The inverses of the nodal blocks on their free unknowns, or of their diagonals.
  pure subroutine invert_blocks(self, blocks, is_diagonal)
    type(gradient_preconditioner_type), intent(inout) :: self
    real(DP), intent(in) :: blocks(:, :, :)        !< (3, 3, n_nodes) [force/length]
    logical, intent(in) :: is_diagonal
    real(DP) :: block(3, 3), inverse(3, 3), mean
    logical :: is_free(3)
    integer :: i, last, n, axis
    n = size(self%unknown)
    if (allocated(self%inverse)) deallocate (self%inverse)
    allocate (self%inverse(3, n))
    mean = 0.0_DP
    do i = 1, n
      axis = mod(self%unknown(i) - 1, 3) + 1
      mean = mean + abs(blocks(axis, axis, (self%unknown(i) + 2) / 3)) / real(n, DP)
    end do
    i = 1
    do while (i <= n)
      last = last_of_node(i)
      is_free = .false.
      is_free(mod(self%unknown(i:last) - 1, 3) + 1) = .true.
      block = blocks(:, :, (self%unknown(i) + 2) / 3)
      if (is_diagonal) block = reshape([block(1, 1), 0.0_DP, 0.0_DP, 0.0_DP, block(2, 2), 0.0_DP, 0.0_DP, 0.0_DP, block(3, 3)], &
        [3, 3])
      call invert_nodal_block(block, is_free, mean, inverse)
      self%inverse(:, i:last) = inverse(:, mod(self%unknown(i:last) - 1, 3) + 1)
      i = last + 1
    end do

  contains

    !> The last free unknown of the node of unknown k.
    pure integer function last_of_node(k) result(m)
      integer, intent(in) :: k
      m = k
      do while (m < n)
        if ((self%unknown(m + 1) + 2) / 3 /= (self%unknown(k) + 2) / 3) exit
        m = m + 1
      end do
    end function last_of_node

  end subroutine invert_blocks


  !> The inverse of a nodal block on its free directions, zero elsewhere. A block that is not positive definite is replaced by its
  !! diagonal, an entry without stiffness by the mean of the model.
  pure subroutine invert_nodal_block(block, is_free, mean, inverse)
    real(DP), intent(in) :: block(3, 3)            !< [force/length]
    logical, intent(in) :: is_free(3)
    real(DP), intent(in) :: mean                   !< [force/length]
    real(DP), intent(out) :: inverse(3, 3)         !< [length/force]
    real(DP) :: a(3, 3), l(3, 3), w(3, 3)
    integer :: i, j
    logical :: is_definite
    a = block
    do i = 1, 3
      if (is_free(i)) cycle
      a(i, :) = 0.0_DP
      a(:, i) = 0.0_DP
      a(i, i) = 1.0_DP
    end do
    l = 0.0_DP
    is_definite = .true.
    do j = 1, 3
      l(j, j) = a(j, j) - sum(l(j, :j - 1)**2)
      is_definite = is_definite .and. l(j, j) > MIN_PIVOT * abs(a(j, j))
      if (.not. is_definite) exit
      l(j, j) = sqrt(l(j, j))
      do i = j + 1, 3
        l(i, j) = (a(i, j) - sum(l(i, :j - 1) * l(j, :j - 1))) / l(j, j)
      end do
    end do
    w = 0.0_DP                                     ! inv(L)
    do j = 1, 3
      if (is_definite) then
        w(j, j) = 1.0_DP / l(j, j)
        do i = j + 1, 3
          w(i, j) = -sum(l(i, j:i - 1) * w(j:i - 1, j)) / l(i, i)
        end do
      else
        w(j, j) = 1.0_DP / sqrt(merge(abs(a(j, j)), max(mean, tiny(1.0_DP)), abs(a(j, j)) > MIN_PIVOT * mean))
      end if
    end do
    inverse = matmul(transpose(w), w)
    do i = 1, 3
      if (is_free(i)) cycle
      inverse(i, :) = 0.0_DP
      inverse(:, i) = 0.0_DP
    end do
  end subroutine invert_nodal_block


  !> z = inv(M) r.
  subroutine apply_gradient_preconditioner(self, system, r, z)
    type(gradient_preconditioner_type), intent(in) :: self
    type(equilibrium_type), intent(inout) :: system
    real(DP), intent(in) :: r(:)                   !< (n_free) [force]
    real(DP), intent(out) :: z(:)                  !< (n_free) [length]
    integer :: i, j
    if (self%is_matrix) then
      call apply_reduced_inverse(system%reduced_system, r, z)
      return
    end if
    do i = 1, size(r)
      z(i) = 0.0_DP
      do j = max(1, i - 2), min(size(r), i + 2)
        if ((self%unknown(j) + 2) / 3 /= (self%unknown(i) + 2) / 3) cycle
        z(i) = z(i) + self%inverse(mod(self%unknown(j) - 1, 3) + 1, i) * r(j)
      end do
    end do
  end subroutine apply_gradient_preconditioner

end module amontons_conjugate_gradient_preconditioner
