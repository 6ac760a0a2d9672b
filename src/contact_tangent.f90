!> Contact tangent: how the contact forces of the closed nodes change, and the rows that hold them on the master.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Linearisation". A closed slave node carries the force lambda, a function of the imbalance
!! Rhat of its row and of the positions around it; node k of the row gets w_k lambda (w = 1 at the slave, -N_i at the
!! master nodes). So
!!     d F_k = w_k d lambda + lambda (dw_k/dxi . d xi),
!!     d lambda = lambda_R sum b_k d Rhat_k + sum_j lambda_j d u_j.
module amontons_contact_tangent
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_state, only: fields_type, slave_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_constraints, only: constraints_type, row_type, add_row, ROW_CONFLICT
  use amontons_errors, only: error_type
  use amontons_sprung, only: springs_type
  use amontons_sparse, only: sparse_type, from_triplets, multiply, product_of, sum_of, transpose_of
  use amontons_gap, only: gap_derivative, gap_derivative_type, vertex_derivative
  use amontons_surfaces, only: interaction_type, is_compliant, BEHAVIOR_TIED, BEHAVIOR_USER
  use amontons_compliance, only: law_pressure, shear_most
  use amontons_rows, only: contact_row_type, relative_position
  use amontons_cut_rates, only: facet_rates_type, row_rates_type, differentiate_row
  use amontons_contact, only: contact_type, touching_row, origin_row, contact_slip_vector, origin_offset_rate, SEARCH_REACH
  use amontons_contact_forces, only: elastic_trial, is_cornered
  implicit none
  private
  public :: link_type, linearise_contact, keep_symmetric, add_contact_rows, apply_contact_tangent, contact_matrices, &
    contact_springs, spring_factors

  !> Entries of a matrix as they come.
  type :: triplets_type
    integer :: n = 0
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
  end type triplets_type

  !> The linearised contact force of one closed slave node.
  type :: link_type
    integer :: slave = 0                           !< index of the slave
    integer :: node = 0                            !< its node
    integer :: level = 1                           !< it carries what slaves of lower levels bring
    integer :: n_weights = 0                       !< nodes of the row: the first of nodes(:), the slave before all others
    integer, allocatable :: nodes(:)               !< nodes on which lambda and xi depend
    real(DP), allocatable :: weights(:)            !< (n_weights) w_k [-]
    real(DP), allocatable :: d_weights(:, :)       !< (2, n_weights) dw_k/dxi [-]; none if xi are the weights themselves
    integer, allocatable :: own(:)                 !< slave nodes whose imbalance is the row's
    real(DP), allocatable :: shares(:)             !< b_k [-]
    real(DP) :: force(3) = 0                       !< lambda [force]
    real(DP) :: force_imbalance(3, 3) = 0          !< d lambda / d Rhat [-]
    real(DP), allocatable :: force_nodes(:, :, :)  !< (3, 3, :) d lambda / d u_j [force/length]
    real(DP), allocatable :: xi_nodes(:, :, :)     !< (2 or n_weights, 3, :) d xi / d u_j [1/length]
    real(DP), allocatable :: gap_nodes(:, :)       !< (3, :) d g / d u_j [-]
    logical :: is_spring = .false.                 !< a compliant law: the node keeps its unknowns and has no row
    real(DP) :: spring(3, 3) = 0                 !< its stiffness without the turning of normals: symmetric, positive [force/length]
  end type link_type

  !> What the facets of a mortar pair's slave have been asked for.
  type :: pair_rates_type
    type(facet_rates_type), allocatable :: facets(:)
  end type pair_rates_type

contains

  !> The links of all closed nodes at the configuration of the last evaluation.
  subroutine linearise_contact(contact, model, old, fields, links)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: old           !< committed
    type(fields_type), intent(in) :: fields
    type(link_type), allocatable, intent(out) :: links(:)   !< one for each closed slave node, in their order
    type(pair_rates_type) :: rates(size(contact%facets))
    real(DP), allocatable :: x(:, :)
    integer :: s, n
    allocate (links(count(fields%slaves(:)%status /= STATUS_OPEN)))
    if (size(links) == 0) return
    allocate (x, source=model%mesh%coordinates + fields%u)
    n = 0
    do s = 1, size(fields%slaves)
      if (fields%slaves(s)%status == STATUS_OPEN) cycle
      n = n + 1
      links(n)%slave = s
      links(n)%node = fields%slaves(s)%node
      links(n)%level = contact%overlaps%level(s)
      links(n)%force = fields%slaves(s)%force + fields%slaves(s)%shear
      if (is_compliant(contact%laws(fields%slaves(s)%pair))) then
        call link_spring(contact, model, x, old%slaves(s), fields, rates, links(n))
      else if (fields%slaves(s)%status == STATUS_STICK) then
        call link_stick(contact, fields%slaves(s), s, links(n))
      else
        call link_slip(contact, model, x, fields, rates, links(n))
      end if
    end do
  end subroutine linearise_contact


  !> Stick: lambda = -Rhat_s, the weights are those of the origin and do not change.
  subroutine link_stick(contact, slave, s, link)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slave
    integer, intent(in) :: s
    type(link_type), intent(inout) :: link
    type(contact_row_type) :: row
    real(DP) :: n_f(3), share
    call origin_row(contact, slave, row)
    call fill_weights(row, link)
    allocate (link%force_nodes(3, 3, link%n_weights), link%xi_nodes(2, 3, link%n_weights), source=0.0_DP)
    allocate (link%gap_nodes(3, link%n_weights), source=0.0_DP)
    link%force_imbalance = -contact%free(:, :, s)
    if (.not. is_cornered(contact, s)) return
    n_f = matmul(contact%free(:, :, s), slave%normal)   ! lambda = N n/|n_f| and what is left in the free directions
    share = norm2(n_f)
    n_f = n_f / share
    link%force_imbalance = link%force_imbalance + outer(n_f - slave%normal / share, n_f)
  end subroutine link_stick


  !> Nodes and weights of a row that does not change.
  subroutine fill_weights(row, link)
    type(contact_row_type), intent(in) :: row
    type(link_type), intent(inout) :: link
    link%n_weights = size(row%nodes)
    link%nodes = row%nodes
    link%weights = row%weights
    link%own = row%own
    link%shares = row%shares
    allocate (link%d_weights(2, link%n_weights), source=0.0_DP)
  end subroutine fill_weights


  !> Slip: lambda = N (n/|n_f| + mu_f q), n_f the free part of n, mu_f = mu/|n_f|, q = tau/|tau| the direction of friction.
  subroutine link_slip(contact, model, x, fields, rates, link)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(fields_type), intent(in) :: fields
    type(pair_rates_type), intent(inout) :: rates(:)   !< (n_pairs)
    type(link_type), intent(inout) :: link
    real(DP) :: force_normal(3, 3), force_slip(3, 3)
    call differentiate_force(contact, model, contact%Rhat(:, link%slave), fields, link, force_normal, force_slip)
    force_normal = force_normal - matmul(force_slip, origin_offset_rate(contact, fields%slaves(link%slave)))
    call link_weights(contact, x, fields%slaves(link%slave), force_normal, rates, link)
    call link_origin(contact, fields%slaves(link%slave), force_slip, link)
  end subroutine link_slip


  !> Nodes, weights, gap and normal of a link, as they are kept or move.
  subroutine link_weights(contact, x, slave, force_normal, rates, link)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: force_normal(3, 3)     !< d lambda / d n [force]
    type(pair_rates_type), intent(inout) :: rates(:)   !< (n_pairs)
    type(link_type), intent(inout) :: link
    type(gap_derivative_type) :: derivative
    type(contact_row_type) :: row
    if (contact%is_small(slave%pair) .or. slave%row > 0) then
      call touching_row(contact, slave, row)
      call fill_weights(row, link)
      call link_kept_weights(slave, link)
      if (contact%is_small(slave%pair)) return
      if (slave%side == 0 .and. .not. contact%mortar(slave%pair)%places(slave%row)%is_shared) call link_cuts(contact, x, slave, &
        rates(slave%pair), link)
      call link_vertex(contact, x, slave, force_normal, link)
    else
      call gap_derivative(contact%facets(slave%pair), x, slave%facet, slave%xi, slave%gap - slave%offset, derivative)
      call link_moving_weights(derivative, force_normal, link)
    end if
  end subroutine link_weights


  !> Finite sliding of a mortar pair: the weights and the area change with the cuts. (Of nodes that two pairs share this is left out.)
  subroutine link_cuts(contact, x, slave, rates, link)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_type), intent(in) :: slave
    type(pair_rates_type), intent(inout) :: rates
    type(link_type), intent(inout) :: link
    type(row_rates_type) :: row
    real(DP) :: by_area(3), height(link%n_weights)
    integer :: j, n
    associate (mortar => contact%mortar(slave%pair))
      if (.not. allocated(rates%facets)) allocate (rates%facets(mortar%slave%n))
      call differentiate_row(mortar, contact%facets(slave%pair), contact%search(slave%pair), x, &
        SEARCH_REACH * contact%edge(slave%pair), slave%row, rates%facets, row)
    end associate
    n = link%n_weights
    call append_nodes(row%nodes(n + 1:), link)
    deallocate (link%d_weights)
    call move_alloc(row%d_weights, link%xi_nodes)
    height = matmul(slave%normal, x(:, link%nodes(:n)) - spread(x(:, link%node), 2, n))
    by_area = link%force / slave%area
    if (.not. link%is_spring) by_area = 0.0_DP
    do j = 1, size(link%nodes)
      link%force_nodes(:, :, j) = outer(by_area, row%d_area(:, j))
      if (link%is_spring) then
        link%gap_nodes(:, j) = link%gap_nodes(:, j) + matmul(height, link%xi_nodes(:, :, j))
      else
        link%force_nodes(:, :, j) = outer(matmul(link%force_imbalance, contact%Rhat(:, link%slave)), row%d_factor(:, j))
      end if
    end do
  end subroutine link_cuts


  !> Finite sliding of a mortar pair: the normal turns with the facets around the slave's vertex.
  subroutine link_vertex(contact, x, slave, force_normal, link)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: force_normal(3, 3)     !< d lambda / d n [force]
    type(link_type), intent(inout) :: link
    integer, allocatable :: nodes(:)
    real(DP), allocatable :: d_n(:, :, :)
    real(DP) :: d(3)
    integer :: at, j
    associate (mortar => contact%mortar(slave%pair))
      call vertex_derivative(mortar%slave, x, mortar%places(slave%row)%vertex, nodes, d_n)
      d = relative_position(mortar%rows(slave%row), x)
    end associate
    call append_nodes(pack(nodes, [(all(link%nodes /= nodes(j)), j=1, size(nodes))]), link)
    do j = 1, size(nodes)                          ! the normal is that of the vertex turned round
      at = findloc(link%nodes, nodes(j), dim=1)
      link%force_nodes(:, :, at) = link%force_nodes(:, :, at) - matmul(force_normal, d_n(:, :, j))
      if (at > link%n_weights .or. link%is_spring) link%gap_nodes(:, at) = link%gap_nodes(:, at) - matmul(d, d_n(:, :, j))
    end do
  end subroutine link_vertex


  !> More nodes on which lambda depends, with derivatives that are zero yet.
  pure subroutine append_nodes(nodes, link)
    integer, intent(in) :: nodes(:)
    type(link_type), intent(inout) :: link
    integer :: n
    if (size(nodes) == 0) return
    n = size(link%nodes) + size(nodes)
    link%nodes = [link%nodes, nodes]
    link%force_nodes = reshape(link%force_nodes, [3, 3, n], pad=[0.0_DP])
    link%xi_nodes = reshape(link%xi_nodes, [size(link%xi_nodes, 1), 3, n], pad=[0.0_DP])
    link%gap_nodes = reshape(link%gap_nodes, [3, n], pad=[0.0_DP])
  end subroutine append_nodes


  !> The slip vector also depends on the nodes of the origin's row: they are appended to the nodes of the link.
  subroutine link_origin(contact, slave, force_slip, link)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: force_slip(3, 3)       !< d lambda / d d [force/length]
    type(link_type), intent(inout) :: link
    type(contact_row_type) :: row
    integer :: j, at
    call origin_row(contact, slave, row)
    call append_nodes(pack(row%nodes, [(all(link%nodes /= row%nodes(j)), j=1, size(row%nodes))]), link)
    do j = 1, size(row%nodes)
      at = findloc(link%nodes, row%nodes(j), 1)
      link%force_nodes(:, :, at) = link%force_nodes(:, :, at) + row%weights(j) * force_slip
    end do
  end subroutine link_origin


  !> A compliant law: lambda = A p n + S, a function of gap, normal and slip alone.
  !!
  !! S = -k e where it sticks, L e/|e| times -1 where it slips, with e = P (e_old + d), L = min(mu A p, A taumax).
  subroutine link_spring(contact, model, x, old, fields, rates, link)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_type), intent(in) :: old            !< committed
    type(fields_type), intent(in) :: fields
    type(pair_rates_type), intent(inout) :: rates(:)   !< (n_pairs)
    type(link_type), intent(inout) :: link
    real(DP) :: p, slope, energy, w(3), e(3), n(3), b(3, 3), force_gap(3), force_normal(3, 3), force_slip(3, 3)
    integer :: j
    associate (slave => fields%slaves(link%slave), law => contact%laws(fields%slaves(link%slave)%pair))
      n = slave%normal
      link%is_spring = .true.
      if (law%behavior == BEHAVIOR_USER) then
        call link_user(contact, x, old, model, fields, rates, link)
        return
      end if
      call law_pressure(law, -slave%gap, p, slope, energy)
      w = old%elastic + contact_slip_vector(contact, model, fields%u, slave)
      e = elastic_trial(contact, model, old, fields%u, slave)
      force_gap = -slope * slave%area * n
      if (law%is_user_friction .and. .not. contact%answers(link%slave)%is_stuck) then
        b = contact%answers(link%slave)%by_slip
        force_gap = force_gap - slope * contact%answers(link%slave)%by_pressure
      else
        call shear_derivatives(law, slave, p, slope, e, b, force_gap)
      end if
      force_slip = matmul(b, unit_matrix() - outer(n, n))
      force_normal = slave%area * p * unit_matrix() - matmul(b, dot_product(n, w) * unit_matrix() + outer(n, w)) &
        - matmul(force_slip, origin_offset_rate(contact, slave))
      call link_weights(contact, x, slave, force_normal, rates, link)
      do j = 1, size(link%nodes)
        link%force_nodes(:, :, j) = link%force_nodes(:, :, j) + outer(force_gap, link%gap_nodes(:, j))
      end do
      call link_origin(contact, slave, force_slip, link)
      link%spring = slope * slave%area * outer(n, n) - matmul(unit_matrix() - outer(n, n), force_slip)
    end associate
  end subroutine link_spring


  !> A law by UINTER: lambda = A (s_1 n - s_2 t_1 - s_3 t_2), and S its part along the surface, which turns with n.
  subroutine link_user(contact, x, old, model, fields, rates, link)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_type), intent(in) :: old            !< committed
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(pair_rates_type), intent(inout) :: rates(:)   !< (n_pairs)
    type(link_type), intent(inout) :: link
    real(DP) :: w(3), n(3), force_normal(3, 3)
    integer :: j
    associate (slave => fields%slaves(link%slave), answer => contact%answers(link%slave))
      n = slave%normal
      w = old%elastic + contact_slip_vector(contact, model, fields%u, slave)
      force_normal = dot_product(n, slave%force) * unit_matrix() - outer(n, slave%shear) - dot_product(n, w) * answer%by_slip &
        - matmul(answer%by_slip, origin_offset_rate(contact, slave))
      call link_weights(contact, x, slave, force_normal, rates, link)
      do j = 1, size(link%nodes)
        link%force_nodes(:, :, j) = link%force_nodes(:, :, j) + outer(answer%by_gap, link%gap_nodes(:, j))
      end do
      call link_origin(contact, slave, answer%by_slip, link)
      link%spring = max(-dot_product(n, answer%by_gap), 0.0_DP) * outer(n, n)
    end associate
  end subroutine link_user


  !> How the shear force changes with the elastic slip if all were elastic (b = dS/de), and with the gap.
  pure subroutine shear_derivatives(law, slave, p, slope, e, b, force_gap)
    type(interaction_type), intent(in) :: law
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: p, slope               !< pressure [stress] and its slope [stress/length]
    real(DP), intent(in) :: e(3)                   !< [length]
    real(DP), intent(out) :: b(3, 3)               !< [force/length]
    real(DP), intent(inout) :: force_gap(3)        !< d lambda / d g [force/length]
    real(DP) :: k, most, length, q(3)
    k = law%stick_slope * slave%area
    b = -k * unit_matrix()
    length = norm2(e)
    most = shear_most(law, slave%area, p)
    if (k * length <= most) return
    q = e / length
    b = -most / length * (unit_matrix() - outer(q, q))
    if (law%behavior == BEHAVIOR_TIED .or. p <= 0.0_DP .or. law%friction * p > law%shear_limit) return
    force_gap = force_gap + law%friction * slope * slave%area * q
  end subroutine shear_derivatives


  !> The unit matrix.
  pure function unit_matrix() result(c)
    real(DP) :: c(3, 3)
    integer :: k
    c = 0.0_DP
    do k = 1, 3
      c(k, k) = 1.0_DP
    end do
  end function unit_matrix


  !> Small sliding: normal and weights are constants.
  subroutine link_kept_weights(slave, link)
    type(slave_type), intent(in) :: slave
    type(link_type), intent(inout) :: link
    integer :: j
    allocate (link%force_nodes(3, 3, link%n_weights), link%xi_nodes(2, 3, link%n_weights), source=0.0_DP)
    allocate (link%gap_nodes(3, link%n_weights))
    do j = 1, link%n_weights
      link%gap_nodes(:, j) = link%weights(j) * slave%normal
    end do
  end subroutine link_kept_weights


  !> Finite sliding: normal and weights move with the slave, the facet and its neighbours.
  subroutine link_moving_weights(derivative, force_normal, link)
    type(gap_derivative_type), intent(in) :: derivative
    real(DP), intent(in) :: force_normal(3, 3)     !< d lambda / d n [force]
    type(link_type), intent(inout) :: link
    integer :: j, n
    n = derivative%n_nodes + 1
    link%n_weights = derivative%n_weights + 1
    link%weights = [1.0_DP, -derivative%weights]
    link%own = [link%node]
    link%shares = [1.0_DP]
    link%nodes = [link%node, derivative%nodes(:n - 1)]
    allocate (link%d_weights(2, link%n_weights), link%force_nodes(3, 3, n), link%xi_nodes(2, 3, n), link%gap_nodes(3, n))
    link%d_weights(:, 1) = 0.0_DP
    link%d_weights(:, 2:) = -derivative%d_weights(:, :derivative%n_weights)
    link%xi_nodes(:, :, 1) = derivative%d_xi_slave
    link%xi_nodes(:, :, 2:) = derivative%d_xi(:, :, :n - 1)
    link%gap_nodes(:, 1) = derivative%d_gap_slave
    link%gap_nodes(:, 2:) = derivative%d_gap(:, :n - 1)
    link%force_nodes(:, :, 1) = matmul(force_normal, derivative%d_n_slave)
    do j = 2, n
      link%force_nodes(:, :, j) = matmul(force_normal, derivative%d_n(:, :, j - 1))
    end do
  end subroutine link_moving_weights


  !> Drops what makes the tangent unsymmetric: friction follows the pressure, weights and normals move. Rows and springs stay.
  pure subroutine keep_symmetric(links)
    type(link_type), intent(inout) :: links(:)
    integer :: i, k
    do i = 1, size(links)
      associate (link => links(i))
        link%force_imbalance = 0.0_DP
        link%force_nodes = 0.0_DP
        link%xi_nodes = 0.0_DP
        if (.not. link%is_spring) cycle
        link%spring = 0.5_DP * (link%spring + transpose(link%spring))
        do k = 1, link%n_weights
          link%force_nodes(:, :, k) = -link%weights(k) * link%spring
        end do
      end associate
    end do
  end subroutine keep_symmetric


  !> The derivatives of lambda = N (n/|n_f| + mu_f q) with respect to Rhat_s, the normal n and the slip vector d.
  subroutine differentiate_force(contact, model, imbalance, fields, link, force_normal, force_slip)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: imbalance(3)           !< Rhat_s [force]
    type(fields_type), intent(in) :: fields
    type(link_type), intent(inout) :: link         !< force_imbalance is set
    real(DP), intent(out) :: force_normal(3, 3)    !< d lambda / d n [force]
    real(DP), intent(out) :: force_slip(3, 3)      !< d lambda / d d [force/length]
    real(DP) :: m(3, 3), n_f(3), share, mu, N, w(3), tau(3), q(3), unit(3, 3), p(3, 3), h(3, 3), turn(3, 3), a(3)
    real(DP) :: length, most, limit, d_limit
    logical :: is_capped
    unit = unit_matrix()
    m = contact%free(:, :, link%slave)
    associate (slave => fields%slaves(link%slave))
      n_f = matmul(m, slave%normal)
      share = norm2(n_f)
      n_f = n_f / share
      N = -dot_product(n_f, imbalance)
      mu = contact%friction(link%slave)
      if (contact%laws(slave%pair)%is_user_friction) mu = 0.0_DP
      most = contact%laws(slave%pair)%shear_limit * slave%area
      is_capped = mu / share * N > most
      w = -matmul(m, imbalance) - slave%stiffness * matmul(m, contact_slip_vector(contact, model, fields%u, slave))
      p = unit - outer(n_f, n_f)
      h = matmul(p, m) / share                     ! d n_f = h d n
      tau = matmul(p, w)
      length = norm2(tau)
      q = 0.0_DP
      turn = 0.0_DP                                ! d q = turn d tau
      if (mu > 0.0_DP .and. length > 0.0_DP) then
        q = tau / length
        turn = (unit - outer(q, q)) / length
      end if
      d_limit = merge(0.0_DP, mu, is_capped)       ! friction is limit q, d limit = d_limit/|n_f| (dN - N d|n_f|/|n_f|)
      limit = merge(most, mu / share * N, is_capped)
      a = (slave%normal + d_limit * q) / share
      link%force_imbalance = -outer(a, n_f) - limit * matmul(turn, p)
      force_slip = -limit * slave%stiffness * matmul(matmul(turn, p), m)
      force_normal = -outer(a, matmul(imbalance, h)) + N / share * (unit - outer(a, matmul(n_f, m))) &
        - limit * matmul(turn, dot_product(n_f, w) * h + outer(n_f, matmul(w, h)))
    end associate
    if (contact%laws(fields%slaves(link%slave)%pair)%is_user_friction) then   ! the shear is FRIC's, of pressure and slip
      associate (answer => contact%answers(link%slave), slave => fields%slaves(link%slave))
        link%force_imbalance = link%force_imbalance - outer(answer%by_pressure, n_f) / slave%area
        force_slip = matmul(answer%by_slip, m)
        force_normal = force_normal - outer(slave%normal, slave%shear)
      end associate
    end if
    link%force_imbalance = matmul(link%force_imbalance, m)
  end subroutine differentiate_force


  !> a b'.
  pure function outer(a, b) result(c)
    real(DP), intent(in) :: a(3), b(3)
    real(DP) :: c(3, 3)
    integer :: k
    do k = 1, 3
      c(:, k) = a * b(k)
    end do
  end function outer


  !> Adds the rows of the closed nodes: stick ties the node to its origin, slip keeps it on the facet.
  !!
  !! The gap's dependence on the turning of the normals is left out of the rows: it is multiplied by the gap, which the
  !! row brings to zero.
  subroutine add_contact_rows(contact, model, fields, links, constraints, n_conflicts)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(link_type), intent(in) :: links(:)
    type(constraints_type), intent(inout) :: constraints
    integer, intent(out) :: n_conflicts            !< rows dropped for stronger constraints
    type(row_type) :: row
    real(DP) :: d(3), tolerance, direction(3, 3)
    integer :: i, k, n, verdict
    n_conflicts = 0
    do i = 1, size(links)
      associate (link => links(i), slave => fields%slaves(links(i)%slave))
        tolerance = 1.0e-6_DP * contact%edge(slave%pair)
        if (link%is_spring) cycle
        if (slave%status == STATUS_SLIP) then
          call gap_row(link, slave%gap, row)
          call add_row(constraints, row, 3, tolerance, verdict)
          if (verdict == ROW_CONFLICT) n_conflicts = n_conflicts + 1
          cycle
        end if
        d = contact_slip_vector(contact, model, fields%u, slave)
        call stick_directions(contact, slave, link%slave, n, direction)
        do k = 1, n
          call tie_row(link, direction(:, k), d, row)
          if (k == 1 .and. is_cornered(contact, link%slave)) row%rhs = -slave%gap   ! it goes along the other pair's normal
          call add_row(constraints, row, count(abs(direction(:, k)) > 0.0_DP), tolerance, verdict)
          if (verdict == ROW_CONFLICT) n_conflicts = n_conflicts + 1
        end do
      end associate
    end do
  end subroutine add_contact_rows


  !> In which directions a sticking node is tied: the axes (of its own frame) that supports leave free; where other pairs hold it
  !! too, the normal and what is left beside it.
  pure subroutine stick_directions(contact, slave, s, n, direction)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slave
    integer, intent(in) :: s
    integer, intent(out) :: n                      !< directions
    real(DP), intent(out) :: direction(3, 3)       !< in columns
    real(DP) :: rest(3, 3), n_f(3)
    integer :: k
    n = 0
    direction = 0.0_DP
    if (.not. is_cornered(contact, s)) then
      do k = 1, 3
        if (contact%mask(k, s) == 0.0_DP) cycle
        n = n + 1
        direction(:, n) = contact%axes(:, k, s)
      end do
      return
    end if
    n = 1
    direction(:, 1) = slave%normal
    n_f = matmul(contact%free(:, :, s), slave%normal)
    rest = contact%free(:, :, s) - outer(n_f, n_f) / dot_product(n_f, n_f)
    k = maxloc(norm2(rest, dim=1), dim=1)          ! one direction at most: the other pair takes one, the normal another
    if (norm2(rest(:, k)) < 0.1_DP) return
    n = 2
    direction(:, 2) = rest(:, k) / norm2(rest(:, k))
  end subroutine stick_directions


  !> d g = -g over the nodes of the row, the slave first.
  pure subroutine gap_row(link, gap, row)
    type(link_type), intent(in) :: link
    real(DP), intent(in) :: gap
    type(row_type), intent(out) :: row
    integer :: j, k
    row%unknown = [((3 * (link%nodes(j) - 1) + k, k=1, 3), j=1, link%n_weights)]
    row%coefficient = reshape(link%gap_nodes(:, :link%n_weights), [3 * link%n_weights])
    row%rhs = -gap
  end subroutine gap_row


  !> Component along a direction of sum w_i du_i = -d.
  pure subroutine tie_row(link, direction, distance, row)
    type(link_type), intent(in) :: link
    real(DP), intent(in) :: direction(3)
    real(DP), intent(in) :: distance(3)            !< d [length]
    type(row_type), intent(out) :: row
    integer, allocatable :: axes(:)
    integer :: j, k
    axes = pack([1, 2, 3], abs(direction) > 0.0_DP)
    row%unknown = [((3 * (link%nodes(j) - 1) + axes(k), k=1, size(axes)), j=1, link%n_weights)]
    row%coefficient = [((link%weights(j) * direction(axes(k)), k=1, size(axes)), j=1, link%n_weights)]
    row%rhs = -dot_product(direction, distance)
  end subroutine tie_row


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
          call put_block(3 * (link%nodes(j) - 1), 3 * (i - 1), link%weights(j) * unit_matrix(), b)
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

end module amontons_contact_tangent
