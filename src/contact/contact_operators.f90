!> Contact matrices: the linearised contact forces as a product with a displacement, as sparse matrices, and as springs.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `contact_tangent` says how the force of each closed slave node changes; here it comes to the nodes of its row. Links of higher
!! levels carry what those of lower levels bring (pairs that share nodes).
module amontons_contact_operators
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_tensor, only: IDENTITY
  use amontons_sparse, only: sparse_type, from_triplets, multiply, product_of, sum_of, transpose_of
  use amontons_woodbury_interface, only: springs_type
  use amontons_contact_linearization, only: link_type
  implicit none
  private
  public :: apply_contact_tangent, contact_matrices, contact_springs, spring_factors

  !> Entries of a matrix as they come.
  type :: triplets_type
    integer :: n = 0
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
  end type triplets_type

contains

  !> Change of the contact forces for a change of displacement and of the imbalance that comes with it.
  subroutine apply_contact_tangent(links, passing, du, d_imbalance, d_force)
    type(link_type), intent(in) :: links(:)
    type(sparse_type), intent(in) :: passing       !< E of `contact`; looked at only if there are levels
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    real(DP), intent(in) :: d_imbalance(:, :)      !< (3, n_nodes) change of Rhat, condensed [force]
    real(DP), intent(out) :: d_force(:, :)         !< (3, n_nodes) [force]
    real(DP), allocatable :: total(:, :), passed(:)
    integer :: i, level, n_levels
    d_force = 0.0_DP
    n_levels = maxval([1, links%level])
    allocate (total, source=d_imbalance)
    do level = 1, n_levels
      do i = 1, size(links)
        if (links(i)%level == level) call add_change(links(i), du, total, d_force)
      end do
      if (level == n_levels) exit
      if (.not. allocated(passed)) allocate (passed(size(total)))
      call multiply(passing, reshape(d_force, shape(passed)), passed)
      total = d_imbalance + reshape(passed, shape(total))
    end do
  end subroutine apply_contact_tangent


  !> The change of one link's force, added at the nodes of its row.
  pure subroutine add_change(link, du, d_imbalance, d_force)
    type(link_type), intent(in) :: link
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    real(DP), intent(in) :: d_imbalance(:, :)      !< (3, n_nodes) [force]
    real(DP), intent(inout) :: d_force(:, :)       !< (3, n_nodes) [force]
    real(DP) :: d_lambda(3), d_xi(size(link%xi_nodes, 1)), d_weight
    integer :: j
    d_lambda = 0.0_DP
    do j = 1, size(link%own)
      d_lambda = d_lambda + link%shares(j) * matmul(link%force_imbalance, d_imbalance(:, link%own(j)))
    end do
    d_xi = 0.0_DP
    do j = 1, size(link%nodes)
      d_lambda = d_lambda + matmul(link%force_nodes(:, :, j), du(:, link%nodes(j)))
      d_xi = d_xi + matmul(link%xi_nodes(:, :, j), du(:, link%nodes(j)))
    end do
    do j = 1, link%n_weights
      if (allocated(link%d_weights)) d_weight = dot_product(link%d_weights(:, j), d_xi)
      if (.not. allocated(link%d_weights)) d_weight = d_xi(j)
      d_force(:, link%nodes(j)) = d_force(:, link%nodes(j)) + link%weights(j) * d_lambda + d_weight * link%force
    end do
  end subroutine add_change


  !> The same change as two matrices over all unknowns: dF_c = D_R dRhat + D_u du. For solvers that need the tangent whole.
  !!
  !! Each level adds A (dRhat + E dF_c) + B du, with dF_c of the levels below it.
  subroutine contact_matrices(links, passing, n_unknowns, by_imbalance, by_displacement)
    type(link_type), intent(in) :: links(:)
    type(sparse_type), intent(in) :: passing       !< E of `contact`; looked at only if there are levels
    integer, intent(in) :: n_unknowns
    type(sparse_type), intent(out) :: by_imbalance       !< D_R [-]
    type(sparse_type), intent(out) :: by_displacement    !< D_u [force/length]
    type(sparse_type) :: a, b
    integer :: level
    call level_matrices(links, 1, n_unknowns, by_imbalance, by_displacement)
    do level = 2, maxval([1, links%level])
      call level_matrices(links, level, n_unknowns, a, b)
      by_displacement = sum_of(sum_of(by_displacement, 1.0_DP, b), 1.0_DP, product_of(a, product_of(passing, by_displacement)))
      by_imbalance = sum_of(sum_of(by_imbalance, 1.0_DP, a), 1.0_DP, product_of(a, product_of(passing, by_imbalance)))
    end do
  end subroutine contact_matrices


  !> The matrices of the links of one level, which carry nothing of each other.
  subroutine level_matrices(links, level, n_unknowns, by_imbalance, by_displacement)
    type(link_type), intent(in) :: links(:)
    integer, intent(in) :: level, n_unknowns
    type(sparse_type), intent(out) :: by_imbalance, by_displacement
    integer, allocatable :: first(:), members(:)
    call rows_of_links(links, level, n_unknowns / 3, first, members)
    call sum_blocks(links, first, members, .true., by_imbalance)
    call sum_blocks(links, first, members, .false., by_displacement)
  end subroutine level_matrices


  !> The links of a level that give a force to each node, in their order.
  pure subroutine rows_of_links(links, level, n_nodes, first, members)
    type(link_type), intent(in) :: links(:)
    integer, intent(in) :: level, n_nodes
    integer, allocatable, intent(out) :: first(:)  !< (n_nodes + 1) start of each node in members
    integer, allocatable, intent(out) :: members(:)
    integer :: next(n_nodes), i, k, n
    next = 0
    do i = 1, size(links)
      if (links(i)%level /= level) cycle
      do k = 1, links(i)%n_weights
        next(links(i)%nodes(k)) = next(links(i)%nodes(k)) + 1
      end do
    end do
    allocate (first(n_nodes + 1), members(sum(next)))
    first(1) = 1
    do n = 1, n_nodes
      first(n + 1) = first(n) + next(n)
    end do
    next = first(:n_nodes)
    do i = 1, size(links)
      if (links(i)%level /= level) cycle
      do k = 1, links(i)%n_weights
        n = links(i)%nodes(k)
        members(next(n)) = i
        next(n) = next(n) + 1
      end do
    end do
  end subroutine rows_of_links


  !> D_R or D_u: for each node the blocks of its links are summed in the links' order. (Integration points of
  !! surface-to-surface contact
  !! are many, and most of their blocks fall together: sorting triplets took ten times as long, and as much memory.)
  subroutine sum_blocks(links, first, members, is_imbalance, matrix)
    type(link_type), intent(in) :: links(:)
    integer, intent(in) :: first(:), members(:)    !< links of each node
    logical, intent(in) :: is_imbalance            !< D_R; else D_u
    type(sparse_type), intent(out) :: matrix
    integer :: seen(size(first) - 1), place(size(first) - 1), r, m, q, j, n_nodes, next
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
      do q = 1, 3
        next = matrix%first(3 * r - 3 + q)
        matrix%column(next:next + 3 * m - 1) = [(3 * (columns((j + 2) / 3) - 1) + 1 + mod(j + 2, 3), j=1, 3 * m)]
      end do
      do q = first(r), first(r + 1) - 1
        if (q > first(r)) then
          if (members(q) == members(q - 1)) cycle  ! add_link takes all weights of a link at the node
        end if
        call add_link(links(members(q)), r, is_imbalance, place, matrix)
      end do
    end do
    matrix = transpose_of(transpose_of(matrix))    ! columns in their order

  contains

    !> The nodes on which the force at a node depends, and their places.
    subroutine gather_columns(row)
      integer, intent(in) :: row
      integer :: p
      m = 0
      do p = first(row), first(row + 1) - 1
        if (is_imbalance) call append(links(members(p))%own, row)
        if (.not. is_imbalance) call append(links(members(p))%nodes, row)
      end do
    end subroutine gather_columns

    !> Those of them that are new.
    subroutine append(nodes, row)
      integer, intent(in) :: nodes(:), row
      integer :: k
      if (m + size(nodes) > size(columns)) columns = [columns, columns, nodes]
      do k = 1, size(nodes)
        if (seen(nodes(k)) == row) cycle
        seen(nodes(k)) = row
        m = m + 1
        columns(m) = nodes(k)
        place(nodes(k)) = m
      end do
    end subroutine append

  end subroutine sum_blocks


  !> What a link gives to the three rows of a node.
  pure subroutine add_link(link, row, is_imbalance, place, matrix)
    type(link_type), intent(in) :: link
    integer, intent(in) :: row                     !< node
    logical, intent(in) :: is_imbalance
    integer, intent(in) :: place(:)                !< (n_nodes) of the columns
    type(sparse_type), intent(inout) :: matrix
    real(DP) :: turn(3)                            ! lambda (dw/dxi . dxi/du_j), but for lambda
    integer :: i, j, p, a, at
    do i = 1, link%n_weights
      if (link%nodes(i) /= row) cycle
      do j = 1, merge(size(link%own), size(link%nodes), is_imbalance)
        if (is_imbalance) then
          p = place(link%own(j))
        else
          p = place(link%nodes(j))
          if (allocated(link%d_weights)) turn = matmul(link%d_weights(:, i), link%xi_nodes(:, :, j))
          if (.not. allocated(link%d_weights)) turn = link%xi_nodes(i, :, j)
        end if
        do a = 1, 3
          at = matrix%first(3 * row - 3 + a) + 3 * (p - 1)
          if (is_imbalance) then
            matrix%value(at:at + 2) = matrix%value(at:at + 2) + link%weights(i) * link%shares(j) * link%force_imbalance(a, :)
          else
            matrix%value(at:at + 2) = matrix%value(at:at + 2) + link%weights(i) * link%force_nodes(a, :, j) + link%force(a) * turn
          end if
        end do
      end do
    end do
  end subroutine add_link


  !> The change of the forces of springs as products, dF_c = (B A + M X) du: B spreads a change of lambda over the nodes of its row,
  !! A du is that change; M is how lambda moves over them with xi, X du the change of xi.
  subroutine spring_factors(links, n_unknowns, springs, error)
    type(link_type), intent(in) :: links(:)
    integer, intent(in) :: n_unknowns
    type(springs_type), intent(out) :: springs
    type(error_type), allocatable, intent(out) :: error
    type(triplets_type) :: b, a, m, x
    logical :: is_moving
    integer :: i, j, n_spread, n_follow, moving
    n_spread = sum([(links(i)%n_weights, i=1, size(links))])
    n_follow = sum([(size(links(i)%nodes), i=1, size(links))])
    call reserve(b, 9 * n_spread)
    call reserve(a, 9 * n_follow)
    call reserve(m, 3 * sum([(links(i)%n_weights * merge(2, 1, allocated(links(i)%d_weights)), i=1, size(links))]))
    call reserve(x, sum([(size(links(i)%xi_nodes), i=1, size(links))]))
    moving = 0                                     ! columns of M before those of a link
    do i = 1, size(links)
      associate (link => links(i), n_xi => size(links(i)%xi_nodes, 1))
        is_moving = .not. allocated(link%d_weights)
        if (.not. is_moving) is_moving = any(abs(link%d_weights) > 0.0_DP)
        do j = 1, link%n_weights
          call put_block(3 * (link%nodes(j) - 1), 3 * (i - 1), link%weights(j) * IDENTITY, b)
          if (.not. is_moving) cycle
          if (allocated(link%d_weights)) then
            call put_block(3 * (link%nodes(j) - 1), moving, &
              reshape([link%d_weights(1, j) * link%force, link%d_weights(2, j) * link%force], [3, 2]), m)
          else
            call put_block(3 * (link%nodes(j) - 1), moving + j - 1, reshape(link%force, [3, 1]), m)
          end if
        end do
        do j = 1, size(link%nodes)
          call put_block(3 * (i - 1), 3 * (link%nodes(j) - 1), link%force_nodes(:, :, j), a)
          if (is_moving) call put_block(moving, 3 * (link%nodes(j) - 1), link%xi_nodes(:, :, j), x)
        end do
        moving = moving + n_xi
      end associate
    end do
    call matrix_of(b, n_unknowns, 3 * size(links), springs%spread, error)
    if (.not. allocated(error)) call matrix_of(a, 3 * size(links), n_unknowns, springs%follow, error)
    if (.not. allocated(error)) call matrix_of(m, n_unknowns, moving, springs%moved, error)
    if (.not. allocated(error)) call matrix_of(x, moving, n_unknowns, springs%moving, error)
  end subroutine spring_factors


  !> Triplets as a matrix.
  subroutine matrix_of(triplets, n_rows, n_columns, matrix, error)
    type(triplets_type), intent(in) :: triplets
    integer, intent(in) :: n_rows, n_columns
    type(sparse_type), intent(out) :: matrix
    type(error_type), allocatable, intent(out) :: error
    associate (t => triplets)
      call from_triplets(n_rows, n_columns, t%row(:t%n), t%column(:t%n), t%value(:t%n), matrix, error)
    end associate
  end subroutine matrix_of


  !> The upper triangle of the springs of the compliant laws, for the preconditioner: symmetric and positive.
  subroutine contact_springs(links, n_unknowns, springs, error)
    type(link_type), intent(in) :: links(:)
    integer, intent(in) :: n_unknowns
    type(sparse_type), intent(out) :: springs      !< [force/length]
    type(error_type), allocatable, intent(out) :: error
    type(triplets_type) :: triplets
    integer :: i, j, k
    logical, allocatable :: is_upper(:)
    call reserve(triplets, 9 * sum([(links(i)%n_weights**2, i=1, size(links))]))
    do i = 1, size(links)
      if (.not. links(i)%is_spring) cycle
      associate (link => links(i))
        do j = 1, link%n_weights
          do k = 1, link%n_weights
            call put_block(3 * (link%nodes(j) - 1), 3 * (link%nodes(k) - 1), link%weights(j) * link%weights(k) * link%spring, &
              triplets)
          end do
        end do
      end associate
    end do
    associate (t => triplets)
      is_upper = t%column(:t%n) >= t%row(:t%n)
      call from_triplets(n_unknowns, n_unknowns, pack(t%row(:t%n), is_upper), pack(t%column(:t%n), is_upper), &
        pack(t%value(:t%n), is_upper), springs, error)
    end associate
  end subroutine contact_springs


  !> A block as triplets.
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


  !> Room for so many entries.
  pure subroutine reserve(triplets, n)
    type(triplets_type), intent(inout) :: triplets
    integer, intent(in) :: n
    allocate (triplets%row(n), triplets%column(n), triplets%value(n))
  end subroutine reserve

end module amontons_contact_operators
