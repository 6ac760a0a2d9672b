!> Robin springs between slave nodes and master, which restrain the bodies in the preconditioner of wide contact, and what the
!! contact skin consists of: the nodes of its rows, and how slaves of compliant laws follow their masters.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "The contact skin". A slave node near its master has springs to its
!! projection on the master, in all directions that the supports leave free: the node's own stiffness c along the normal, and a
!! fraction of c across it. Under a compliant law they are at most the mean slopes of the law over the closed slaves of the pair.
module amontons_robin_springs
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_controls, only: skin_controls_type
  use amontons_tensor, only: outer_product
  use amontons_dense, only: solve_small
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_state, only: fields_type, STATUS_OPEN, STATUS_STICK
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_pairs, only: contact_type, current_row
  use amontons_shared_slave_nodes, only: support_free_projector
  use amontons_contact_linearization, only: contact_tangent_type
  use amontons_contact_operators, only: assemble_spring_matrix
  implicit none
  private
  public :: find_near, robin_springs, skin_rows, master_shares, following_motion

contains

  !> The slaves that are closed or near their master.
  pure function find_near(contact, fields, max_gap) result(is_near)
    type(contact_type), intent(in) :: contact
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: max_gap                !< of a near slave over the edge of its facet [-]
    logical :: is_near(size(fields%slaves))
    integer :: s
    do s = 1, size(is_near)
      associate (slave => fields%slaves(s))
        is_near(s) = slave%facet > 0
        if (is_near(s)) is_near(s) = slave%status /= STATUS_OPEN .or. slave%gap <= max_gap * contact%edge(slave%pair)
      end associate
    end do
  end function find_near


  !> The springs of the near slaves, as the upper triangle of a stiffness. Slaves at one node share its spring.
  subroutine robin_springs(controls, contact, fields, is_near, closed, n_unknowns, springs)
    type(skin_controls_type), intent(in) :: controls
    type(contact_type), intent(in) :: contact
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_near(:)              !< (n_slaves)
    type(contact_tangent_type), intent(in) :: closed(:)       !< of the closed slaves
    integer, intent(in) :: n_unknowns
    type(sparse_type), intent(out) :: springs      !< [force/length]
    type(contact_tangent_type), allocatable :: links(:)
    type(contact_row_type) :: row
    real(DP) :: slope(2, size(contact%facets)), free(3, 3), along, across
    integer :: n_at(n_unknowns / 3), s, n
    call mean_slopes(contact, fields, closed, slope)
    n_at = 0
    do s = 1, size(is_near)
      if (is_near(s)) n_at(fields%slaves(s)%node) = n_at(fields%slaves(s)%node) + 1
    end do
    allocate (links(count(is_near)))
    n = 0
    do s = 1, size(is_near)
      if (.not. is_near(s)) cycle
      n = n + 1
      associate (slave => fields%slaves(s), link => links(n))
        call current_row(contact, slave, row)
        link%is_compliant_node = .true.
        link%n_weights = size(row%nodes)
        link%nodes = row%nodes
        link%weights = row%weights
        along = controls%spring_along * slave%stiffness / real(n_at(slave%node), DP)
        across = controls%spring_across * slave%stiffness / real(n_at(slave%node), DP)
        if (slope(1, slave%pair) > 0.0_DP) along = min(along, slope(1, slave%pair) * slave%area)
        if (slope(2, slave%pair) > 0.0_DP) across = min(across, slope(2, slave%pair) * slave%area)
        free = support_free_projector(contact%axes(:, :, s), contact%free_mask(:, s))
        link%spring = across * free + (along - across) * outer_product(matmul(free, slave%normal), matmul(free, slave%normal))
      end associate
    end do
    call assemble_spring_matrix(links, n_unknowns, springs)
  end subroutine robin_springs


  !> The mean slopes of compliant laws, weighted by area: of the pressure over the closed slaves, of the shear over the sticking
  !! ones.
  pure subroutine mean_slopes(contact, fields, closed, slope)
    type(contact_type), intent(in) :: contact
    type(fields_type), intent(in) :: fields
    type(contact_tangent_type), intent(in) :: closed(:)
    real(DP), intent(out) :: slope(2, size(contact%facets))   !< (2, n_pairs) 0: unknown, or no compliant law [stress/length]
    real(DP) :: area(2, size(contact%facets)), along
    integer :: i, k
    slope = 0.0_DP
    area = 0.0_DP
    do i = 1, size(closed)
      if (.not. closed(i)%is_compliant_node) cycle
      associate (slave => fields%slaves(closed(i)%slave))
        along = dot_product(slave%normal, matmul(closed(i)%spring, slave%normal))
        slope(1, slave%pair) = slope(1, slave%pair) + along
        area(1, slave%pair) = area(1, slave%pair) + slave%area
        if (slave%status /= STATUS_STICK) cycle
        slope(2, slave%pair) = slope(2, slave%pair) + &
          0.5_DP * (sum([(closed(i)%spring(k, k), k=1, 3)]) - along)
        area(2, slave%pair) = area(2, slave%pair) + slave%area
      end associate
    end do
    where (area > 0.0_DP) slope = slope / area
  end subroutine mean_slopes


  !> The contact skin: the nodes of the rows of closed and near slaves with the sizes of their weights, the slave node first.
  subroutine skin_rows(contact, fields, is_near, links, n_nodes, rows)
    type(contact_type), intent(in) :: contact
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_near(:)              !< (n_slaves) at the computation of the springs
    type(contact_tangent_type), intent(in) :: links(:)        !< of the closed slaves, in their order
    integer, intent(in) :: n_nodes
    type(sparse_type), intent(out) :: rows
    type(contact_row_type) :: row
    integer :: s, n, k, pass, n_entries
    do pass = 1, 2
      n = 0
      k = 1                                        ! next link
      n_entries = 0
      do s = 1, size(is_near)
        if (is_link(k, s)) then
          call put([links(k)%node, links(k)%nodes(:links(k)%n_weights)], [1.0_DP, abs(links(k)%weights)], &
            links(k)%imbalance_nodes)
          k = k + 1
        else if (is_near(s)) then
          row%nodes = [fields%slaves(s)%node]
          row%weights = [1.0_DP]
          if (fields%slaves(s)%facet > 0) call current_row(contact, fields%slaves(s), row)
          call put([fields%slaves(s)%node, row%nodes], [1.0_DP, abs(row%weights)], [integer ::])
        end if
      end do
      if (pass == 1) then
        rows%n_rows = n
        rows%n_columns = n_nodes
        allocate (rows%first(n + 1), rows%column(n_entries), rows%value(n_entries))
      end if
    end do
    rows%first(n + 1) = n_entries + 1

  contains

    !> Whether the contact tangent is that of the slave.
    pure logical function is_link(number, slave)
      integer, intent(in) :: number, slave
      is_link = number <= size(links)
      if (is_link) is_link = links(number)%slave == slave
    end function is_link

    !> Appends a row; nodes may occur twice.
    subroutine put(nodes, sizes, others)
      integer, intent(in) :: nodes(:), others(:)   !< of the row; without weights
      real(DP), intent(in) :: sizes(:)             !< |w_k| of the row [-]
      integer :: last
      last = n_entries + size(nodes) + size(others)
      n = n + 1
      if (pass == 2) then
        rows%first(n) = n_entries + 1
        rows%column(n_entries + 1:last) = [nodes, others]
        rows%value(n_entries + 1:last) = [sizes, spread(0.0_DP, 1, size(others))]
      end if
      n_entries = last
    end subroutine put

  end subroutine skin_rows


  !> The shares N of master nodes in the jump u_s - sum N_m u_m of each slave node of a compliant law: the negative weights of all
  !! its rows, scaled to the sum 1. A node is slave or master by the sum of its weights: single ones of a master are
  !! positive where a facet is extended.
  subroutine master_shares(links, n_nodes, shares, error)
    type(contact_tangent_type), intent(in) :: links(:)        !< of the closed slaves
    integer, intent(in) :: n_nodes
    type(sparse_type), intent(out) :: shares       !< N (n_nodes x n_nodes) [-]
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: value(:), total(:), sum_of_weights(:)
    integer, allocatable :: row(:), column(:)
    integer :: i, j, n
    allocate (total(n_nodes), sum_of_weights(n_nodes), source=0.0_DP)
    do i = 1, size(links)
      if (.not. links(i)%is_compliant_node) cycle
      do j = 1, links(i)%n_weights
        sum_of_weights(links(i)%nodes(j)) = sum_of_weights(links(i)%nodes(j)) + links(i)%weights(j)
      end do
    end do
    n = 0
    do i = 1, size(links)
      if (links(i)%is_compliant_node) n = n + count(is_of(links(i), 1.0_DP)) * count(is_of(links(i), -1.0_DP))
    end do
    allocate (row(n), column(n), value(n))
    n = 0
    do i = 1, size(links)
      if (links(i)%is_compliant_node) call add_row(links(i))
    end do
    call sparse_from_triplets(n_nodes, n_nodes, row, column, value / total(row), shares, error)

  contains

    !> The nodes of a row that are slaves (sign 1) or masters (-1).
    pure function is_of(link, sign)
      type(contact_tangent_type), intent(in) :: link
      real(DP), intent(in) :: sign                 !< [-]
      logical :: is_of(link%n_weights)
      is_of = sign * sum_of_weights(link%nodes(:link%n_weights)) > 0.0_DP .and. sign * link%weights > 0.0_DP
    end function is_of

    !> Adds the shares of the masters of a row in the jumps of its slaves.
    subroutine add_row(link)
      type(contact_tangent_type), intent(in) :: link
      logical :: is_slave(link%n_weights), is_master(link%n_weights)
      integer :: j, k
      is_slave = is_of(link, 1.0_DP)
      is_master = is_of(link, -1.0_DP)
      do j = 1, link%n_weights
        do k = 1, link%n_weights
          if (.not. (is_slave(j) .and. is_master(k))) cycle
          n = n + 1
          row(n) = link%nodes(j)
          column(n) = link%nodes(k)
          value(n) = -link%weights(j) * link%weights(k)
          total(row(n)) = total(row(n)) + value(n)
        end do
      end do
    end subroutine add_row

  end subroutine master_shares


  !> S N: how the slave nodes of compliant laws follow their masters, u_s = s + S N u, with S = inv(K_ss + k) k of the node's own
  !! stiffness and that of the law. An infinite slope gives the constraint of exact contact.
  subroutine following_motion(links, stiffness, shares, motion, error)
    type(contact_tangent_type), intent(in) :: links(:)        !< of the closed slaves
    type(sparse_type), intent(in) :: stiffness     !< K, upper triangle (n_unknowns x n_unknowns) [force/length]
    type(sparse_type), intent(in) :: shares        !< N (n_nodes x n_nodes) [-]
    type(sparse_type), intent(out) :: motion       !< S N (n_unknowns x n_unknowns) [-]
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: law(:, :, :), value(:)
    integer, allocatable :: row(:), column(:)
    real(DP) :: share(3, 3)
    integer :: i, j, m, n, node, p, status
    allocate (law(3, 3, shares%n_rows), source=0.0_DP)
    do i = 1, size(links)
      if (.not. links(i)%is_compliant_node) cycle
      do j = 1, links(i)%n_weights
        associate (slave => links(i)%nodes(j))
          law(:, :, slave) = law(:, :, slave) + links(i)%weights(j)**2 * links(i)%spring
        end associate
      end do
    end do
    n = 9 * size(shares%column)
    allocate (row(n), column(n), value(n))
    n = 0
    do node = 1, shares%n_rows
      if (shares%first(node + 1) == shares%first(node)) cycle
      call solve_small(own_stiffness(node) + law(:, :, node), law(:, :, node), share, status)
      if (status /= 0) share = 0.0_DP
      do p = shares%first(node), shares%first(node + 1) - 1
        do j = 1, 3
          do m = 1, 3
            n = n + 1
            row(n) = 3 * (node - 1) + m
            column(n) = 3 * (shares%column(p) - 1) + j
            value(n) = shares%value(p) * share(m, j)
          end do
        end do
      end do
    end do
    call sparse_from_triplets(stiffness%n_rows, stiffness%n_rows, row(:n), column(:n), value(:n), motion, error)

  contains

    !> K_ss of a node.
    pure function own_stiffness(at) result(own)
      integer, intent(in) :: at
      real(DP) :: own(3, 3)
      integer :: a, b, q
      own = 0.0_DP
      do a = 1, 3
        do q = stiffness%first(3 * (at - 1) + a), stiffness%first(3 * (at - 1) + a + 1) - 1
          b = stiffness%column(q) - 3 * (at - 1)
          if (b < 1 .or. b > 3) cycle
          own(a, b) = stiffness%value(q)
          own(b, a) = own(a, b)
        end do
      end do
    end function own_stiffness

  end subroutine following_motion

end module amontons_robin_springs
