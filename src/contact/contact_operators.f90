!> The linearized contact forces as an operator, as sparse matrices, and as low-rank spring factors.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The tangents of amontons_contact_linearization are distributed here to the nodes of their rows. Tangents of higher levels include
!! the reactions of those of lower levels (pairs that share nodes).
module amontons_contact_operators
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_containers, only: sort_integers
  use amontons_tensor, only: IDENTITY
  use amontons_sparse, only: sparse_type, triplets_type, sparse_from_triplets, multiply, sparse_product, sparse_sum, upper_triangle
  use amontons_woodbury_interface, only: contact_springs_type
  use amontons_contact_linearization, only: contact_tangent_type, has_spring
  implicit none
  private
  public :: apply_contact_tangent, assemble_contact_tangents, assemble_spring_matrix, factorise_spring_tangents

  integer, parameter :: BY_IMBALANCE = 1, BY_DISPLACEMENT = 2, BY_SPRING = 3     !< what forces change with: Rhat, u, springs

contains

  !> Change of the contact forces for a change of displacement and the corresponding change of the imbalance.
  subroutine apply_contact_tangent(tangents, force_condensation, du, d_imbalance, d_force)
    type(contact_tangent_type), intent(in) :: tangents(:)
    type(sparse_type), intent(in) :: force_condensation       !< E of contact_type; used only with several levels
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    real(DP), intent(in) :: d_imbalance(:, :)      !< (3, n_nodes) change of Rhat, condensed [force]
    real(DP), intent(out) :: d_force(:, :)         !< (3, n_nodes) [force]
    real(DP), allocatable :: total(:, :), condensed_force(:)
    integer :: i, level, n_levels
    d_force = 0.0_DP
    n_levels = maxval([1, tangents%level])
    allocate (total, source=d_imbalance)
    do level = 1, n_levels
      do i = 1, size(tangents)
        if (tangents(i)%level == level) call add_node_tangent(tangents(i), du, total, d_force)
      end do
      if (level == n_levels) exit
      if (.not. allocated(condensed_force)) allocate (condensed_force(size(total)))
      call multiply(force_condensation, reshape(d_force, shape(condensed_force)), condensed_force)
      total = d_imbalance + reshape(condensed_force, shape(total))
    end do
  end subroutine apply_contact_tangent


  !> Adds the change of one nodal force at the nodes of its row.
  pure subroutine add_node_tangent(tangent, du, d_imbalance, d_force)
    type(contact_tangent_type), intent(in) :: tangent
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    real(DP), intent(in) :: d_imbalance(:, :)      !< (3, n_nodes) [force]
    real(DP), intent(inout) :: d_force(:, :)       !< (3, n_nodes) [force]
    real(DP) :: d_lambda(3), d_xi(size(tangent%xi_nodes, 1)), d_weight
    integer :: j
    d_lambda = 0.0_DP
    do j = 1, size(tangent%imbalance_nodes)
      d_lambda = d_lambda + tangent%imbalance_weights(j) * matmul(tangent%force_imbalance, d_imbalance(:, &
        tangent%imbalance_nodes(j)))
    end do
    d_xi = 0.0_DP
    do j = 1, size(tangent%nodes)
      d_lambda = d_lambda + matmul(tangent%force_nodes(:, :, j), du(:, tangent%nodes(j)))
      d_xi = d_xi + matmul(tangent%xi_nodes(:, :, j), du(:, tangent%nodes(j)))
    end do
    do j = 1, tangent%n_weights
      if (allocated(tangent%d_weights)) d_weight = dot_product(tangent%d_weights(:, j), d_xi)
      if (.not. allocated(tangent%d_weights)) d_weight = d_xi(j)
      d_force(:, tangent%nodes(j)) = d_force(:, tangent%nodes(j)) + tangent%weights(j) * d_lambda + d_weight * tangent%force
    end do
  end subroutine add_node_tangent


  !> The same change as two matrices over all unknowns: dF_c = D_R dRhat + D_u du. For solvers that need the whole tangent.
  !!
  !! Each level adds A (dRhat + E dF_c) + B du, with dF_c of the levels below it.
  subroutine assemble_contact_tangents(tangents, force_condensation, n_unknowns, imbalance_tangent, displacement_tangent)
    type(contact_tangent_type), intent(in) :: tangents(:)
    type(sparse_type), intent(in) :: force_condensation       !< E of contact_type; used only with several levels
    integer, intent(in) :: n_unknowns
    type(sparse_type), intent(out) :: imbalance_tangent       !< D_R [-]
    type(sparse_type), intent(out) :: displacement_tangent    !< D_u [force/length]
    type(sparse_type) :: a, b, by_force
    integer :: level
    call level_matrices(tangents, 1, n_unknowns, imbalance_tangent, displacement_tangent)
    do level = 2, maxval([1, tangents%level])
      call level_matrices(tangents, level, n_unknowns, a, b)
      by_force = sparse_product(a, force_condensation)   ! few rows: those of one level
      displacement_tangent = sparse_sum(sparse_sum(displacement_tangent, 1.0_DP, b), 1.0_DP, sparse_product(by_force, &
        displacement_tangent))
      imbalance_tangent = sparse_sum(sparse_sum(imbalance_tangent, 1.0_DP, a), 1.0_DP, sparse_product(by_force, imbalance_tangent))
    end do
  end subroutine assemble_contact_tangents


  !> The matrices of the tangents of one level, which do not depend on each other.
  subroutine level_matrices(tangents, level, n_unknowns, imbalance_tangent, displacement_tangent)
    type(contact_tangent_type), intent(in) :: tangents(:)
    integer, intent(in) :: level, n_unknowns
    type(sparse_type), intent(out) :: imbalance_tangent, displacement_tangent
    integer, allocatable :: first(:), members(:)
    call group_by_node(tangents, tangents%level == level, n_unknowns / 3, first, members)
    call sum_blocks(tangents, first, members, BY_IMBALANCE, imbalance_tangent)
    call sum_blocks(tangents, first, members, BY_DISPLACEMENT, displacement_tangent)
  end subroutine level_matrices


  !> The chosen tangents that give a force to each node, in their order.
  pure subroutine group_by_node(tangents, is_chosen, n_nodes, first, members)
    type(contact_tangent_type), intent(in) :: tangents(:)
    logical, intent(in) :: is_chosen(:)            !< (size(tangents))
    integer, intent(in) :: n_nodes
    integer, allocatable, intent(out) :: first(:)  !< (n_nodes + 1) start of each node in members
    integer, allocatable, intent(out) :: members(:)
    integer :: next(n_nodes), i, k, n
    next = 0
    do i = 1, size(tangents)
      if (.not. is_chosen(i)) cycle
      do k = 1, tangents(i)%n_weights
        next(tangents(i)%nodes(k)) = next(tangents(i)%nodes(k)) + 1
      end do
    end do
    allocate (first(n_nodes + 1), members(sum(next)))
    first(1) = 1
    do n = 1, n_nodes
      first(n + 1) = first(n) + next(n)
    end do
    next = first(:n_nodes)
    do i = 1, size(tangents)
      if (.not. is_chosen(i)) cycle
      do k = 1, tangents(i)%n_weights
        n = tangents(i)%nodes(k)
        members(next(n)) = i
        next(n) = next(n) + 1
      end do
    end do
  end subroutine group_by_node


  !> A matrix of nodal blocks: for each node the blocks of its tangents are summed in their order. (Integration points of
  !! surface-to-surface contact are many, and most of their blocks coincide: sorted triplets take ten times the time and memory.)
  subroutine sum_blocks(tangents, first, members, kind, matrix)
    type(contact_tangent_type), intent(in) :: tangents(:)
    integer, intent(in) :: first(:), members(:)    !< tangents of each node
    integer, intent(in) :: kind                    !< of the blocks: BY_...
    type(sparse_type), intent(out) :: matrix
    integer :: seen(size(first) - 1), column_index(size(first) - 1), r, m, q, j, n_nodes, next
    integer, allocatable :: columns(:)
    n_nodes = size(first) - 1
    matrix%n_rows = 3 * n_nodes
    matrix%n_columns = 3 * n_nodes
    allocate (matrix%first(3 * n_nodes + 1), columns(1000))
    seen = 0
    matrix%first(1) = 1
    do r = 1, n_nodes
      call gather_columns(r)
      matrix%first(3 * r - 1:3 * r + 1) = matrix%first(3 * r - 2) + 3 * m * [1, 2, 3]
    end do
    next = matrix%first(3 * n_nodes + 1)
    allocate (matrix%column(next - 1), matrix%value(next - 1))
    matrix%value = 0.0_DP
    seen = 0
    do r = 1, n_nodes
      if (first(r) == first(r + 1)) cycle
      call gather_columns(r)
      call sort_integers(columns(:m))
      column_index(columns(:m)) = [(j, j=1, m)]
      do q = 1, 3
        next = matrix%first(3 * r - 3 + q)
        do j = 1, m
          matrix%column(next + 3 * j - 3:next + 3 * j - 1) = 3 * (columns(j) - 1) + [1, 2, 3]
        end do
      end do
      do q = first(r), first(r + 1) - 1
        if (q > first(r)) then
          if (members(q) == members(q - 1)) cycle  ! add_node_blocks takes all weights of a tangent at the node
        end if
        call add_node_blocks(tangents(members(q)), r, kind, column_index, matrix)
      end do
    end do

  contains

    !> The nodes on which the force at a node depends.
    subroutine gather_columns(row)
      integer, intent(in) :: row
      integer :: p
      m = 0
      do p = first(row), first(row + 1) - 1
        associate (tangent => tangents(members(p)))
          select case (kind)
          case (BY_IMBALANCE)
            call append(tangent%imbalance_nodes, row)
          case (BY_DISPLACEMENT)
            call append(tangent%nodes, row)
          case default
            call append(tangent%nodes(:tangent%n_weights), row)
          end select
        end associate
      end do
    end subroutine gather_columns

    !> Appends those that are new.
    subroutine append(nodes, row)
      integer, intent(in) :: nodes(:), row
      integer :: k
      if (m + size(nodes) > size(columns)) columns = [columns, columns, nodes]
      do k = 1, size(nodes)
        if (seen(nodes(k)) == row) cycle
        seen(nodes(k)) = row
        m = m + 1
        columns(m) = nodes(k)
      end do
    end subroutine append

  end subroutine sum_blocks


  !> Contribution of a tangent to the three rows of a node.
  subroutine add_node_blocks(tangent, row, kind, column_index, matrix)
    type(contact_tangent_type), intent(in) :: tangent
    integer, intent(in) :: row                     !< node
    integer, intent(in) :: kind                    !< BY_...
    integer, intent(in) :: column_index(:)         !< (n_nodes) of the columns
    type(sparse_type), intent(inout) :: matrix
    integer :: i, j
    do i = 1, tangent%n_weights
      if (tangent%nodes(i) /= row) cycle
      select case (kind)
      case (BY_IMBALANCE)
        do j = 1, size(tangent%imbalance_nodes)
          call add(tangent%imbalance_nodes(j), tangent%weights(i) * tangent%imbalance_weights(j) * tangent%force_imbalance)
        end do
      case (BY_DISPLACEMENT)
        do j = 1, size(tangent%nodes)
          call add(tangent%nodes(j), tangent%weights(i) * tangent%force_nodes(:, :, j) + change_of_distribution(i, j))
        end do
      case default
        do j = 1, tangent%n_weights
          call add(tangent%nodes(j), tangent%weights(i) * tangent%weights(j) * tangent%spring)
        end do
      end select
    end do

  contains

    !> Adds a block in the columns of a node.
    subroutine add(node, block)
      integer, intent(in) :: node
      real(DP), intent(in) :: block(3, 3)
      integer :: a, at
      do a = 1, 3
        at = matrix%first(3 * row - 3 + a) + 3 * (column_index(node) - 1)
        matrix%value(at:at + 2) = matrix%value(at:at + 2) + block(a, :)
      end do
    end subroutine add

    !> lambda (dw_i/dxi . dxi/du_j) [force/length]
    pure function change_of_distribution(i, j) result(block)
      integer, intent(in) :: i, j
      real(DP) :: block(3, 3), d_weight(3)         ! [1/length]
      integer :: a, b
      if (allocated(tangent%d_weights)) then
        d_weight = tangent%d_weights(1, i) * tangent%xi_nodes(1, :, j) + tangent%d_weights(2, i) * tangent%xi_nodes(2, :, j)
      else
        d_weight = tangent%xi_nodes(i, :, j)
      end if
      do b = 1, 3
        do a = 1, 3
          block(a, b) = tangent%force(a) * d_weight(b)
        end do
      end do
    end function change_of_distribution

  end subroutine add_node_blocks


  !> The upper triangle of the springs of compliant laws and of held friction, for the preconditioner: symmetric and positive.
  subroutine assemble_spring_matrix(tangents, n_unknowns, springs)
    type(contact_tangent_type), intent(in) :: tangents(:)
    integer, intent(in) :: n_unknowns
    type(sparse_type), intent(out) :: springs      !< [force/length]
    integer, allocatable :: first(:), members(:)
    call group_by_node(tangents, has_spring(tangents), n_unknowns / 3, first, members)
    call sum_blocks(tangents, first, members, BY_SPRING, springs)
    springs = upper_triangle(springs)
  end subroutine assemble_spring_matrix


  !> The change of spring forces as products, dF_c = (B A + M X) du: B distributes a change of lambda over the nodes of its row, A
  !! du is that change; M is the change of the distribution with xi, X du the change of xi.
  subroutine factorise_spring_tangents(tangents, n_unknowns, springs, error)
    type(contact_tangent_type), intent(in) :: tangents(:)
    integer, intent(in) :: n_unknowns
    type(contact_springs_type), intent(out) :: springs
    type(error_type), allocatable, intent(out) :: error
    type(triplets_type) :: b, a, m, x
    logical :: is_moving
    integer :: i, j, n_spread, n_follow, moving
    n_spread = sum([(tangents(i)%n_weights, i=1, size(tangents))])
    n_follow = sum([(size(tangents(i)%nodes), i=1, size(tangents))])
    call allocate_triplets(b, 9 * n_spread)
    call allocate_triplets(a, 9 * n_follow)
    call allocate_triplets(m, 3 * sum([(tangents(i)%n_weights * merge(2, 1, allocated(tangents(i)%d_weights)), i=1, &
      size(tangents))]))
    call allocate_triplets(x, sum([(size(tangents(i)%xi_nodes), i=1, size(tangents))]))
    moving = 0                                     ! columns of M before those of a tangent
    do i = 1, size(tangents)
      associate (tangent => tangents(i), n_xi => size(tangents(i)%xi_nodes, 1))
        is_moving = .not. allocated(tangent%d_weights)
        if (.not. is_moving) is_moving = any(abs(tangent%d_weights) > 0.0_DP)
        do j = 1, tangent%n_weights
          call put_block(3 * (tangent%nodes(j) - 1), 3 * (i - 1), tangent%weights(j) * IDENTITY, b)
          if (.not. is_moving) cycle
          if (allocated(tangent%d_weights)) then
            call put_block(3 * (tangent%nodes(j) - 1), moving, &
              reshape([tangent%d_weights(1, j) * tangent%force, tangent%d_weights(2, j) * tangent%force], [3, 2]), m)
          else
            call put_block(3 * (tangent%nodes(j) - 1), moving + j - 1, reshape(tangent%force, [3, 1]), m)
          end if
        end do
        do j = 1, size(tangent%nodes)
          call put_block(3 * (i - 1), 3 * (tangent%nodes(j) - 1), tangent%force_nodes(:, :, j), a)
          if (is_moving) call put_block(moving, 3 * (tangent%nodes(j) - 1), tangent%xi_nodes(:, :, j), x)
        end do
        moving = moving + n_xi
      end associate
    end do
    call build_matrix(b, n_unknowns, 3 * size(tangents), springs%force_distribution, error)
    if (.not. allocated(error)) call build_matrix(a, 3 * size(tangents), n_unknowns, springs%spring_tangent, error)
    if (.not. allocated(error)) call build_matrix(m, n_unknowns, moving, springs%distribution_change, error)
    if (.not. allocated(error)) call build_matrix(x, moving, n_unknowns, springs%projection_gradient, error)
  end subroutine factorise_spring_tangents


  !> Converts triplets to a matrix.
  subroutine build_matrix(triplets, n_rows, n_columns, matrix, error)
    type(triplets_type), intent(in) :: triplets
    integer, intent(in) :: n_rows, n_columns
    type(sparse_type), intent(out) :: matrix
    type(error_type), allocatable, intent(out) :: error
    associate (t => triplets)
      call sparse_from_triplets(n_rows, n_columns, t%row(:t%n), t%column(:t%n), t%value(:t%n), matrix, error)
    end associate
  end subroutine build_matrix


  !> Appends a block as triplets.
  pure subroutine put_block(row, column, block, triplets)
    integer, intent(in) :: row, column             !< before its first
    real(DP), intent(in) :: block(:, :)
    type(triplets_type), intent(inout) :: triplets
    integer :: r, c
    do c = 1, size(block, 2)
      do r = 1, size(block, 1)
        triplets%n = triplets%n + 1
        triplets%row(triplets%n) = row + r
        triplets%column(triplets%n) = column + c
        triplets%value(triplets%n) = block(r, c)
      end do
    end do
  end subroutine put_block


  !> Allocates a number of entries.
  pure subroutine allocate_triplets(triplets, n)
    type(triplets_type), intent(inout) :: triplets
    integer, intent(in) :: n
    allocate (triplets%row(n), triplets%column(n), triplets%value(n))
  end subroutine allocate_triplets

end module amontons_contact_operators
