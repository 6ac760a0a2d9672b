!> Contact tangent: how the contact forces of the closed nodes change, and the rows that hold them on the master.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Linearisation". A closed slave node carries the force lambda, a function of the imbalance
!! Rhat of its row and of the positions around it; node k of the row gets w_k lambda (w = 1 at the slave, -N_i at the
!! master nodes). So
!!     d F_k = w_k d lambda + lambda (dw_k/dxi . d xi),
!!     d lambda = lambda_R sum b_k d Rhat_k + sum_j lambda_j d u_j.
module amontons_contact_linearization
  use amontons_kinds, only: DP
  use amontons_tensor, only: outer, IDENTITY
  use amontons_model, only: model_type
  use amontons_state, only: fields_type, slave_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_constraints, only: constraints_type, row_type, add_row, ROW_CONFLICT
  use amontons_surface_projection, only: gap_derivative, gap_derivative_type, vertex_derivative
  use amontons_slip_scenarios, only: friction_limit, is_friction_capped
  use amontons_surfaces, only: is_compliant, BEHAVIOR_USER
  use amontons_contact_constraint_rows, only: contact_row_type, relative_position
  use amontons_segment_derivatives, only: facet_rates_type
  use amontons_mortar_linearization, only: row_rates_type, differentiate_row
  use amontons_contact_pairs, only: contact_type, touching_row, origin_row, contact_slip_vector, origin_offset_rate
  use amontons_contact_evaluation, only: is_cornered
  implicit none
  private
  public :: link_type, linearise_contact, keep_symmetric, add_contact_rows

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


  !> Finite sliding of a mortar pair: the weights and the area change with the cuts. (Of nodes that two pairs share this is left
  !! out.)
  subroutine link_cuts(contact, x, slave, rates, link)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_type), intent(in) :: slave
    type(pair_rates_type), intent(inout) :: rates
    type(link_type), intent(inout) :: link
    type(row_rates_type) :: row
    real(DP) :: height(link%n_weights)
    integer :: j, n
    associate (mortar => contact%mortar(slave%pair))
      if (.not. allocated(rates%facets)) allocate (rates%facets(mortar%slave%n))
      call differentiate_row(mortar, contact%facets(slave%pair), x, slave%row, rates%facets, row)
    end associate
    n = link%n_weights
    call append_nodes(row%nodes(n + 1:), link)
    deallocate (link%d_weights)
    call move_alloc(row%d_weights, link%xi_nodes)
    height = matmul(slave%normal, x(:, link%nodes(:n)) - spread(x(:, link%node), 2, n))
    do j = 1, size(link%nodes)
      if (link%is_spring) then
        link%force_nodes(:, :, j) = outer(link%force / slave%area, row%d_area(:, j))
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
    real(DP) :: w(3), n(3), b(3, 3), force_gap(3), force_normal(3, 3), force_slip(3, 3)
    integer :: j
    associate (slave => fields%slaves(link%slave), law => contact%laws(fields%slaves(link%slave)%pair), &
      met => contact%met(link%slave))
      n = slave%normal
      link%is_spring = .true.
      if (law%behavior == BEHAVIOR_USER) then
        call link_user(contact, x, old, model, fields, rates, link)
        return
      end if
      w = old%elastic + contact_slip_vector(contact, model, fields%u, slave)
      force_gap = -met%slope * slave%area * n
      if (law%is_user_friction .and. .not. contact%answers(link%slave)%is_stuck) then
        b = contact%answers(link%slave)%by_slip
        force_gap = force_gap - met%slope * contact%answers(link%slave)%by_pressure
      else
        b = met%by_slip
        force_gap = force_gap + met%by_gap
      end if
      force_slip = matmul(b, IDENTITY - outer(n, n))
      force_normal = slave%area * met%pressure * IDENTITY - matmul(b, dot_product(n, w) * IDENTITY + outer(n, w)) &
        - matmul(force_slip, origin_offset_rate(contact, slave))
      call link_weights(contact, x, slave, force_normal, rates, link)
      do j = 1, size(link%nodes)
        link%force_nodes(:, :, j) = link%force_nodes(:, :, j) + outer(force_gap, link%gap_nodes(:, j))
      end do
      call link_origin(contact, slave, force_slip, link)
      link%spring = met%slope * slave%area * outer(n, n) - matmul(IDENTITY - outer(n, n), force_slip)
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
      force_normal = dot_product(n, slave%force) * IDENTITY - outer(n, slave%shear) - dot_product(n, w) * answer%by_slip &
        - matmul(answer%by_slip, origin_offset_rate(contact, slave))
      call link_weights(contact, x, slave, force_normal, rates, link)
      do j = 1, size(link%nodes)
        link%force_nodes(:, :, j) = link%force_nodes(:, :, j) + outer(answer%by_gap, link%gap_nodes(:, j))
      end do
      call link_origin(contact, slave, answer%by_slip, link)
      link%spring = max(-dot_product(n, answer%by_gap), 0.0_DP) * outer(n, n)
    end associate
  end subroutine link_user


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
    unit = IDENTITY
    m = contact%free(:, :, link%slave)
    associate (slave => fields%slaves(link%slave))
      n_f = matmul(m, slave%normal)
      share = norm2(n_f)
      n_f = n_f / share
      N = -dot_product(n_f, imbalance)
      mu = contact%friction(link%slave)
      if (contact%laws(slave%pair)%is_user_friction) mu = 0.0_DP
      most = contact%laws(slave%pair)%shear_limit * slave%area
      is_capped = is_friction_capped(mu / share, N, most)
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
      limit = friction_limit(mu / share, N, most)
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
          if (k == 1 .and. is_cornered(contact, link%slave)) row%rhs = -slave%gap   ! it goes along its master
          call add_row(constraints, row, count(abs(direction(:, k)) > 0.0_DP), tolerance, verdict)
          if (verdict == ROW_CONFLICT) n_conflicts = n_conflicts + 1
        end do
      end associate
    end do
  end subroutine add_contact_rows


  !> In which directions a sticking node is tied: the axes (of its own frame) that supports leave free; where other pairs hold it
  !! too, or its master slides along supports, the normal and what is left beside it.
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

end module amontons_contact_linearization
