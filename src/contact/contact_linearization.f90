!> Consistent linearization of the contact forces and the constraint rows of closed nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Linearisation". The force lambda on a closed slave node is a function of the imbalance Rhat of
!! its row and of the nodal positions around it; node k of the row gets w_k lambda (w = 1 at the slave, -N_i at the master nodes).
!! So
!!     d F_k = w_k d lambda + lambda (dw_k/dxi . d xi),
!!     d lambda = lambda_R sum b_k d Rhat_k + sum_j lambda_j d u_j.
module amontons_contact_linearization
  use amontons_kinds, only: DP
  use amontons_tensor, only: outer_product, IDENTITY
  use amontons_sparse, only: sparse_type
  use amontons_model, only: model_type
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_constraints, only: constraints_type, constraint_row_type, add_constraint_row, ROW_CONFLICT
  use amontons_surface_projection, only: evaluate_gap_derivatives, gap_derivatives_type
  use amontons_friction_slip_scenarios, only: friction_limit, is_friction_capped
  use amontons_surfaces, only: is_compliant, BEHAVIOR_USER
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_relative_position
  use amontons_segment_derivatives, only: facet_derivatives_type
  use amontons_mortar, only: vertices_of
  use amontons_row_normals, only: differentiate_row_normal
  use amontons_mortar_linearization, only: row_derivatives_type, differentiate_mortar_row
  use amontons_contact_pairs, only: contact_type, current_row, origin_row, contact_slip_vector, origin_offset_derivative
  use amontons_contact_evaluation, only: has_other_constraints
  implicit none
  private
  public :: contact_tangent_type, linearize_contact, lower_levels, drop_unsymmetric_terms, add_contact_rows, has_spring, &
    held_friction_spring

  !> The linearized contact force of one closed slave node.
  type :: contact_tangent_type
    integer :: slave = 0                           !< index of the slave
    integer :: node = 0                            !< its node
    integer :: level = 1                           !< above those of the slaves whose reactions act on it
    integer :: n_weights = 0                       !< nodes of the row: the first of nodes(:), the slave first
    integer, allocatable :: nodes(:)               !< nodes on which lambda and xi depend
    real(DP), allocatable :: weights(:)            !< (n_weights) w_k [-]
    real(DP), allocatable :: d_weights(:, :)       !< (2, n_weights) dw_k/dxi [-]; none if xi are the weights themselves
    integer, allocatable :: imbalance_nodes(:)                 !< slave nodes whose imbalances form the row's
    real(DP), allocatable :: imbalance_weights(:)             !< b_k [-]
    real(DP) :: force(3) = 0                       !< lambda [force]
    real(DP) :: force_imbalance(3, 3) = 0          !< d lambda / d Rhat [-]
    real(DP), allocatable :: force_nodes(:, :, :)  !< (3, 3, :) d lambda / d u_j [force/length]
    real(DP), allocatable :: xi_nodes(:, :, :)     !< (2 or n_weights, 3, :) d xi / d u_j [1/length]
    real(DP), allocatable :: gap_nodes(:, :)       !< (3, :) d g / d u_j [-]
    logical :: is_compliant_node = .false.                 !< a compliant law: the node keeps its unknowns and has no constraint row
    real(DP) :: spring(3, 3) = 0  !< its stiffness without the rotation of normals, or that of friction that is held: symmetric,
                                                   !! positive [force/length]
  end type contact_tangent_type

  !> Derivatives evaluated so far for the slave facets of a mortar pair.
  type :: pair_derivatives_type
    type(facet_derivatives_type), allocatable :: facets(:)
  end type pair_derivatives_type

contains

  !> The tangents of all closed nodes at the configuration of the last evaluation.
  subroutine linearize_contact(contact, model, old, fields, tangents)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: old           !< committed
    type(fields_type), intent(in) :: fields
    type(contact_tangent_type), allocatable, intent(out) :: tangents(:)   !< one for each closed slave node, in their order
    type(pair_derivatives_type) :: rates(size(contact%facets))
    real(DP), allocatable :: x(:, :)
    integer :: s, n
    allocate (tangents(count(fields%slaves(:)%status /= STATUS_OPEN)))
    if (size(tangents) == 0) return
    allocate (x, source=model%mesh%coordinates + fields%u)
    n = 0
    do s = 1, size(fields%slaves)
      if (fields%slaves(s)%status == STATUS_OPEN) cycle
      n = n + 1
      tangents(n)%slave = s
      tangents(n)%node = fields%slaves(s)%node
      tangents(n)%level = contact%shared_slaves%level(s)
      tangents(n)%force = fields%slaves(s)%force + fields%slaves(s)%shear
      if (is_compliant(contact%laws(fields%slaves(s)%pair))) then
        call linearize_compliant(contact, model, x, old%slaves(s), fields, rates, tangents(n))
      else if (allocated(contact%held_normal_force)) then
        call linearize_augmented(contact, fields%slaves(s), s, tangents(n))
      else if (fields%slaves(s)%status == STATUS_STICK) then
        call linearize_stick(contact, fields%slaves(s), s, tangents(n))
      else
        call linearize_slip(contact, model, x, fields, rates, tangents(n))
        if (allocated(contact%held_friction)) tangents(n)%spring = held_friction_spring(contact, fields%slaves(s), s)
      end if
    end do
    call lower_levels(contact%force_condensation, tangents)
  end subroutine linearize_contact


  !> Lowers the levels as far as the order of closed slaves that act on each other stays: those in between may be open, and each
  !! level costs products of matrices. Cost: linear in the weights.
  pure subroutine lower_levels(force_condensation, tangents)
    type(sparse_type), intent(in) :: force_condensation       !< E of contact_type
    type(contact_tangent_type), intent(inout) :: tangents(:)
    integer :: reader(force_condensation%n_rows / 3)   ! the highest level so far of slaves on which forces at a node act
    integer :: writer(force_condensation%n_rows / 3)   ! the highest level so far of slaves with forces at a node
    integer, allocatable :: acting(:)
    integer :: lowered(size(tangents)), level, i
    if (all(tangents%level <= 1)) return
    lowered = 1
    reader = 1
    writer = 0
    do level = 1, maxval(tangents%level)
      do i = 1, size(tangents)
        if (tangents(i)%level /= level) cycle
        acting = find_acting_nodes(force_condensation, tangents(i)%imbalance_nodes)
        lowered(i) = maxval([1, reader(tangents(i)%nodes(:tangents(i)%n_weights)), 1 + writer(acting)])
      end do
      do i = 1, size(tangents)
        if (tangents(i)%level /= level) cycle
        acting = find_acting_nodes(force_condensation, tangents(i)%imbalance_nodes)
        reader(acting) = max(reader(acting), lowered(i))
        associate (own => tangents(i)%nodes(:tangents(i)%n_weights))
          writer(own) = max(writer(own), lowered(i))
        end associate
      end do
    end do
    tangents%level = lowered
  end subroutine lower_levels


  !> The nodes whose forces change the imbalances of some nodes, perhaps several times.
  pure function find_acting_nodes(force_condensation, nodes) result(acting)
    type(sparse_type), intent(in) :: force_condensation       !< E of contact_type
    integer, intent(in) :: nodes(:)
    integer, allocatable :: acting(:)
    integer :: i
    acting = [integer ::]
    do i = 1, size(nodes)
      associate (first => force_condensation%first(3 * nodes(i) - 2), beyond => force_condensation%first(3 * nodes(i) + 1))
        acting = [acting, (force_condensation%column(first:beyond - 1) + 2) / 3]
      end associate
    end do
  end function find_acting_nodes


  !> Stick: lambda = -Rhat_s; the weights are those of the origin and constant.
  subroutine linearize_stick(contact, slave, s, tangent)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s
    type(contact_tangent_type), intent(inout) :: tangent
    type(contact_row_type) :: row
    real(DP) :: n_f(3), share
    call origin_row(contact, slave, row)
    call copy_row(row, tangent)
    allocate (tangent%force_nodes(3, 3, tangent%n_weights), tangent%xi_nodes(2, 3, tangent%n_weights), source=0.0_DP)
    allocate (tangent%gap_nodes(3, tangent%n_weights), source=0.0_DP)
    tangent%force_imbalance = -contact%free(:, :, s)
    if (.not. has_other_constraints(contact, s)) return
    n_f = matmul(contact%free(:, :, s), slave%normal)   ! lambda = N n/|n_f| and the remainder in the free directions
    share = norm2(n_f)
    n_f = n_f / share
    tangent%force_imbalance = tangent%force_imbalance + outer_product(n_f - slave%normal / share, n_f)
  end subroutine linearize_stick


  !> Exact contact in an augmented round: the spring of the trial traction, for the preconditioner alone; no row.
  subroutine linearize_augmented(contact, slave, s, tangent)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s                       !< its index
    type(contact_tangent_type), intent(inout) :: tangent
    type(contact_row_type) :: row
    call current_row(contact, slave, row)
    call copy_row(row, tangent)
    call set_fixed_weights(slave, tangent)
    tangent%is_compliant_node = .true.
    tangent%spring = slave%stiffness * outer_product(slave%normal, slave%normal) + held_friction_spring(contact, slave, s)
  end subroutine linearize_augmented


  !> The stiffness of the friction P_L (f - c g) that is held: c along the master below the limit L; beyond it c L/|q|, across
  !! q = f - c g alone.
  pure function held_friction_spring(contact, slave, s) result(spring)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s                       !< its index
    real(DP) :: spring(3, 3), q(3), size_of_q
    spring = slave%stiffness * (IDENTITY - outer_product(slave%normal, slave%normal))
    q = contact%held_friction(:, s) - slave%stiffness * slave%slip_increment
    q = q - dot_product(slave%normal, q) * slave%normal
    size_of_q = norm2(q)
    if (size_of_q > contact%held_limit(s)) spring = contact%held_limit(s) / size_of_q * (spring - &
      slave%stiffness * outer_product(q / size_of_q, q / size_of_q))
  end function held_friction_spring


  !> Whether the row of a tangent has a spring.
  elemental logical function has_spring(tangent)
    type(contact_tangent_type), intent(in) :: tangent
    has_spring = tangent%is_compliant_node .or. any(abs(tangent%spring) > 0.0_DP)
  end function has_spring


  !> Nodes and weights of a constant row.
  subroutine copy_row(row, tangent)
    type(contact_row_type), intent(in) :: row
    type(contact_tangent_type), intent(inout) :: tangent
    tangent%n_weights = size(row%nodes)
    tangent%nodes = row%nodes
    tangent%weights = row%weights
    tangent%imbalance_nodes = row%imbalance_nodes
    tangent%imbalance_weights = row%imbalance_weights
    allocate (tangent%d_weights(2, tangent%n_weights), source=0.0_DP)
  end subroutine copy_row


  !> Slip: lambda = N (n/|n_f| + mu_f q), n_f the free part of n, mu_f = mu/|n_f|, q = tau/|tau| the direction of friction.
  subroutine linearize_slip(contact, model, x, fields, rates, tangent)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(fields_type), intent(in) :: fields
    type(pair_derivatives_type), intent(inout) :: rates(:)   !< (n_pairs)
    type(contact_tangent_type), intent(inout) :: tangent
    real(DP) :: force_normal(3, 3), force_slip(3, 3)
    call differentiate_force(contact, model, contact%Rhat(:, tangent%slave), fields, tangent, force_normal, force_slip)
    force_normal = force_normal - matmul(force_slip, origin_offset_derivative(contact, fields%slaves(tangent%slave)))
    call linearize_weights(contact, x, fields%slaves(tangent%slave), force_normal, rates, tangent)
    call add_origin_terms(contact, fields%slaves(tangent%slave), force_slip, tangent)
  end subroutine linearize_slip


  !> Nodes, weights, gap and normal of a tangent, fixed or moving.
  subroutine linearize_weights(contact, x, slave, force_normal, rates, tangent)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: force_normal(3, 3)     !< d lambda / d n [force]
    type(pair_derivatives_type), intent(inout) :: rates(:)   !< (n_pairs)
    type(contact_tangent_type), intent(inout) :: tangent
    type(gap_derivatives_type) :: derivative
    type(contact_row_type) :: row
    if (contact%has_fixed_geometry(slave%pair) .or. slave%row > 0) then
      call current_row(contact, slave, row)
      call copy_row(row, tangent)
      call set_fixed_weights(slave, tangent)
      if (contact%has_fixed_geometry(slave%pair)) return
      if (slave%slave_facet == 0 &
        .and. .not. contact%mortar(slave%pair)%places(slave%row)%is_shared) call linearize_mortar_weights(contact, x, slave, &
        rates(slave%pair), tangent)
      call linearize_row_normal(contact, x, slave, force_normal, rates(slave%pair), tangent)
    else
      call evaluate_gap_derivatives(contact%facets(slave%pair), x, slave%facet, slave%xi, slave%gap - slave%offset, derivative)
      call set_moving_weights(derivative, force_normal, tangent)
    end if
  end subroutine linearize_weights


  !> Finite sliding of a mortar pair: the weights and the area change with the intersections. (Omitted for nodes shared by two
  !! pairs.)
  subroutine linearize_mortar_weights(contact, x, slave, rates, tangent)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_state_type), intent(in) :: slave
    type(pair_derivatives_type), intent(inout) :: rates
    type(contact_tangent_type), intent(inout) :: tangent
    type(row_derivatives_type) :: row
    real(DP) :: height(tangent%n_weights), d_gap(3)
    integer :: j, n, at
    associate (mortar => contact%mortar(slave%pair))
      if (.not. allocated(rates%facets)) allocate (rates%facets(mortar%slave%n))
      call differentiate_mortar_row(mortar, contact%facets(slave%pair), x, slave%row, rates%facets, row)
    end associate
    n = tangent%n_weights
    call append_nodes(row%nodes(n + 1:), tangent)
    deallocate (tangent%d_weights)
    call move_alloc(row%d_weights, tangent%xi_nodes)
    height = matmul(slave%normal, x(:, tangent%nodes(:n)) - spread(x(:, tangent%node), 2, n))
    do j = 1, size(tangent%nodes)
      d_gap = matmul(height, tangent%xi_nodes(:, :, j))
      if (tangent%is_compliant_node) then
        tangent%force_nodes(:, :, j) = outer_product(tangent%force / slave%area, row%d_area(:, j))
        tangent%gap_nodes(:, j) = tangent%gap_nodes(:, j) + d_gap
      else                                         ! the constraint row has no other nodes: their part goes to the slave node
        tangent%force_nodes(:, :, j) = outer_product(matmul(tangent%force_imbalance, contact%Rhat(:, tangent%slave)), &
          row%d_factor(:, j))
        at = merge(j, 1, j <= n)
        tangent%gap_nodes(:, at) = tangent%gap_nodes(:, at) + d_gap
      end if
    end do
  end subroutine linearize_mortar_weights


  !> Finite sliding of a mortar pair: the normal rotates with the facets of the slave, and at a crease with those of the master.
  subroutine linearize_row_normal(contact, x, slave, force_normal, rates, tangent)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: force_normal(3, 3)     !< d lambda / d n [force]
    type(pair_derivatives_type), intent(inout) :: rates
    type(contact_tangent_type), intent(inout) :: tangent
    integer, allocatable :: nodes(:)
    real(DP), allocatable :: d_n(:, :, :)
    real(DP) :: d(3)
    integer :: at, j
    associate (mortar => contact%mortar(slave%pair))
      if (.not. allocated(rates%facets)) allocate (rates%facets(mortar%slave%n))
      call differentiate_row_normal(mortar%slave, vertices_of(mortar, slave%row), mortar%places(slave%row)%vertex, &
        mortar%cuts%covers, contact%facets(slave%pair), x, rates%facets, nodes, d_n)
      d = evaluate_relative_position(mortar%rows(slave%row), x)
    end associate
    call append_nodes(pack(nodes, [(all(tangent%nodes /= nodes(j)), j=1, size(nodes))]), tangent)
    do j = 1, size(nodes)                          ! the normal is opposite to that of the slave
      at = findloc(tangent%nodes, nodes(j), dim=1)
      tangent%force_nodes(:, :, at) = tangent%force_nodes(:, :, at) - matmul(force_normal, d_n(:, :, j))
      if (at > tangent%n_weights .or. tangent%is_compliant_node) tangent%gap_nodes(:, at) = tangent%gap_nodes(:, at) - matmul(d, &
        d_n(:, :, j))
    end do
  end subroutine linearize_row_normal


  !> Appends nodes on which lambda depends, with zero derivatives.
  pure subroutine append_nodes(nodes, tangent)
    integer, intent(in) :: nodes(:)
    type(contact_tangent_type), intent(inout) :: tangent
    integer :: n
    if (size(nodes) == 0) return
    n = size(tangent%nodes) + size(nodes)
    tangent%nodes = [tangent%nodes, nodes]
    tangent%force_nodes = reshape(tangent%force_nodes, [3, 3, n], pad=[0.0_DP])
    tangent%xi_nodes = reshape(tangent%xi_nodes, [size(tangent%xi_nodes, 1), 3, n], pad=[0.0_DP])
    tangent%gap_nodes = reshape(tangent%gap_nodes, [3, n], pad=[0.0_DP])
  end subroutine append_nodes


  !> The slip vector also depends on the nodes of the origin's row: they are appended to the nodes of the tangent.
  subroutine add_origin_terms(contact, slave, force_slip, tangent)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: force_slip(3, 3)       !< d lambda / d d [force/length]
    type(contact_tangent_type), intent(inout) :: tangent
    type(contact_row_type) :: row
    integer :: j, at
    call origin_row(contact, slave, row)
    call append_nodes(pack(row%nodes, [(all(tangent%nodes /= row%nodes(j)), j=1, size(row%nodes))]), tangent)
    do j = 1, size(row%nodes)
      at = findloc(tangent%nodes, row%nodes(j), 1)
      tangent%force_nodes(:, :, at) = tangent%force_nodes(:, :, at) + row%weights(j) * force_slip
    end do
  end subroutine add_origin_terms


  !> A compliant law: lambda = A p n + S, a function of gap, normal and slip alone.
  !!
  !! Stick: S = -k e; slip: S = -L e/|e|; with e = P (e_old + d), L = min(mu A p, A taumax).
  subroutine linearize_compliant(contact, model, x, old, fields, rates, tangent)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_state_type), intent(in) :: old            !< committed
    type(fields_type), intent(in) :: fields
    type(pair_derivatives_type), intent(inout) :: rates(:)   !< (n_pairs)
    type(contact_tangent_type), intent(inout) :: tangent
    real(DP) :: w(3), n(3), b(3, 3), force_gap(3), force_normal(3, 3), force_slip(3, 3)
    integer :: j
    associate (slave => fields%slaves(tangent%slave), law => contact%laws(fields%slaves(tangent%slave)%pair), &
      local => contact%local_equilibrium(tangent%slave))
      n = slave%normal
      tangent%is_compliant_node = .true.
      if (law%behavior == BEHAVIOR_USER) then
        call linearize_user_law(contact, x, old, model, fields, rates, tangent)
        return
      end if
      w = old%elastic + contact_slip_vector(contact, model, fields%u, slave)
      force_gap = -local%slope * slave%area * n
      if (law%is_user_friction .and. .not. contact%user_responses(tangent%slave)%is_stuck) then
        b = contact%user_responses(tangent%slave)%d_force_d_slip
        force_gap = force_gap - local%slope * contact%user_responses(tangent%slave)%by_pressure
      else
        b = local%d_force_d_slip
        force_gap = force_gap + local%d_force_d_gap
      end if
      force_slip = matmul(b, IDENTITY - outer_product(n, n))
      force_normal = slave%area * local%pressure * IDENTITY - matmul(b, dot_product(n, w) * IDENTITY + outer_product(n, w)) &
        - matmul(force_slip, origin_offset_derivative(contact, slave))
      call linearize_weights(contact, x, slave, force_normal, rates, tangent)
      do j = 1, size(tangent%nodes)
        tangent%force_nodes(:, :, j) = tangent%force_nodes(:, :, j) + outer_product(force_gap, tangent%gap_nodes(:, j))
      end do
      call add_origin_terms(contact, slave, force_slip, tangent)
      tangent%spring = local%slope * slave%area * outer_product(n, n) - matmul(IDENTITY - outer_product(n, n), force_slip)
    end associate
  end subroutine linearize_compliant


  !> A law by UINTER: lambda = A (s_1 n - s_2 t_1 - s_3 t_2), with the tangential part S, which rotates with n.
  subroutine linearize_user_law(contact, x, old, model, fields, rates, tangent)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_state_type), intent(in) :: old            !< committed
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(pair_derivatives_type), intent(inout) :: rates(:)   !< (n_pairs)
    type(contact_tangent_type), intent(inout) :: tangent
    real(DP) :: w(3), n(3), force_normal(3, 3)
    integer :: j
    associate (slave => fields%slaves(tangent%slave), response => contact%user_responses(tangent%slave))
      n = slave%normal
      w = old%elastic + contact_slip_vector(contact, model, fields%u, slave)
      force_normal = dot_product(n, slave%force) * IDENTITY - outer_product(n, slave%shear) - dot_product(n, &
        w) * response%d_force_d_slip &
        - matmul(response%d_force_d_slip, origin_offset_derivative(contact, slave))
      call linearize_weights(contact, x, slave, force_normal, rates, tangent)
      do j = 1, size(tangent%nodes)
        tangent%force_nodes(:, :, j) = tangent%force_nodes(:, :, j) + outer_product(response%d_force_d_gap, tangent%gap_nodes(:, j))
      end do
      call add_origin_terms(contact, slave, response%d_force_d_slip, tangent)
      tangent%spring = max(-dot_product(n, response%d_force_d_gap), 0.0_DP) * outer_product(n, n)
    end associate
  end subroutine linearize_user_law


  !> Small sliding: normal and weights are constant.
  subroutine set_fixed_weights(slave, tangent)
    type(slave_state_type), intent(in) :: slave
    type(contact_tangent_type), intent(inout) :: tangent
    integer :: j
    allocate (tangent%force_nodes(3, 3, tangent%n_weights), tangent%xi_nodes(2, 3, tangent%n_weights), source=0.0_DP)
    allocate (tangent%gap_nodes(3, tangent%n_weights))
    do j = 1, tangent%n_weights
      tangent%gap_nodes(:, j) = tangent%weights(j) * slave%normal
    end do
  end subroutine set_fixed_weights


  !> Finite sliding: normal and weights move with the slave, the facet and its neighbours.
  subroutine set_moving_weights(derivative, force_normal, tangent)
    type(gap_derivatives_type), intent(in) :: derivative
    real(DP), intent(in) :: force_normal(3, 3)     !< d lambda / d n [force]
    type(contact_tangent_type), intent(inout) :: tangent
    integer :: j, n
    n = derivative%n_nodes + 1
    tangent%n_weights = derivative%n_weights + 1
    tangent%weights = [1.0_DP, -derivative%weights]
    tangent%imbalance_nodes = [tangent%node]
    tangent%imbalance_weights = [1.0_DP]
    tangent%nodes = [tangent%node, derivative%nodes(:n - 1)]
    allocate (tangent%d_weights(2, tangent%n_weights), tangent%force_nodes(3, 3, n), tangent%xi_nodes(2, 3, n), &
      tangent%gap_nodes(3, n))
    tangent%d_weights(:, 1) = 0.0_DP
    tangent%d_weights(:, 2:) = -derivative%d_weights(:, :derivative%n_weights)
    tangent%xi_nodes(:, :, 1) = derivative%d_xi_slave
    tangent%xi_nodes(:, :, 2:) = derivative%d_xi(:, :, :n - 1)
    tangent%gap_nodes(:, 1) = derivative%d_gap_slave
    tangent%gap_nodes(:, 2:) = derivative%d_gap(:, :n - 1)
    tangent%force_nodes(:, :, 1) = matmul(force_normal, derivative%d_n_slave)
    do j = 2, n
      tangent%force_nodes(:, :, j) = matmul(force_normal, derivative%d_n(:, :, j - 1))
    end do
  end subroutine set_moving_weights


  !> Drops the unsymmetric terms: friction by pressure, moving weights and normals. Constraint rows and springs remain.
  pure subroutine drop_unsymmetric_terms(tangents)
    type(contact_tangent_type), intent(inout) :: tangents(:)
    integer :: i, k
    do i = 1, size(tangents)
      associate (tangent => tangents(i))
        tangent%force_imbalance = 0.0_DP
        tangent%force_nodes = 0.0_DP
        tangent%xi_nodes = 0.0_DP
        if (.not. tangent%is_compliant_node) cycle
        tangent%spring = 0.5_DP * (tangent%spring + transpose(tangent%spring))
        do k = 1, tangent%n_weights
          tangent%force_nodes(:, :, k) = -tangent%weights(k) * tangent%spring
        end do
      end associate
    end do
  end subroutine drop_unsymmetric_terms


  !> The derivatives of lambda = N (n/|n_f| + mu_f q) with respect to Rhat_s, the normal n and the slip vector d.
  subroutine differentiate_force(contact, model, imbalance, fields, tangent, force_normal, force_slip)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: imbalance(3)           !< Rhat_s [force]
    type(fields_type), intent(in) :: fields
    type(contact_tangent_type), intent(inout) :: tangent         !< force_imbalance is set
    real(DP), intent(out) :: force_normal(3, 3)    !< d lambda / d n [force]
    real(DP), intent(out) :: force_slip(3, 3)      !< d lambda / d d [force/length]
    real(DP) :: m(3, 3), n_f(3), share, mu, N, w(3), tau(3), q(3), unit(3, 3), p(3, 3), h(3, 3), direction_derivative(3, 3), a(3)
    real(DP) :: length, shear_limit_force, limit, d_limit
    logical :: is_capped
    unit = IDENTITY
    m = contact%free(:, :, tangent%slave)
    associate (slave => fields%slaves(tangent%slave))
      n_f = matmul(m, slave%normal)
      share = norm2(n_f)
      n_f = n_f / share
      N = -dot_product(n_f, imbalance)
      mu = contact%friction(tangent%slave)
      if (contact%laws(slave%pair)%is_user_friction) mu = 0.0_DP
      shear_limit_force = contact%laws(slave%pair)%shear_limit * slave%area
      is_capped = is_friction_capped(mu / share, N, shear_limit_force, slave%is_bilateral)
      w = -matmul(m, imbalance) - slave%stiffness * matmul(m, contact_slip_vector(contact, model, fields%u, slave))
      p = unit - outer_product(n_f, n_f)
      h = matmul(p, m) / share                     ! d n_f = h d n
      tau = matmul(p, w)
      length = norm2(tau)
      q = 0.0_DP
      direction_derivative = 0.0_DP                                ! d q = turn d tau
      if (mu > 0.0_DP .and. length > 0.0_DP) then
        q = tau / length
        direction_derivative = (unit - outer_product(q, q)) / length
      end if
      d_limit = merge(0.0_DP, mu, is_capped)       ! friction is limit q, d limit = d_limit/|n_f| (dN - N d|n_f|/|n_f|)
      limit = friction_limit(mu / share, N, shear_limit_force, slave%is_bilateral)
      a = (slave%normal + d_limit * q) / share
      tangent%force_imbalance = -outer_product(a, n_f) - limit * matmul(direction_derivative, p)
      force_slip = -limit * slave%stiffness * matmul(matmul(direction_derivative, p), m)
      force_normal = -outer_product(a, matmul(imbalance, h)) + N / share * (unit - outer_product(a, matmul(n_f, m))) &
        - limit * matmul(direction_derivative, dot_product(n_f, w) * h + outer_product(n_f, matmul(w, h)))
    end associate
    if (contact%laws(fields%slaves(tangent%slave)%pair)%is_user_friction) then   ! the shear is FRIC's
      associate (response => contact%user_responses(tangent%slave), slave => fields%slaves(tangent%slave))
        tangent%force_imbalance = tangent%force_imbalance - outer_product(response%by_pressure, n_f) / slave%area
        force_slip = matmul(response%d_force_d_slip, m)
        force_normal = force_normal - outer_product(slave%normal, slave%shear)
      end associate
    end if
    tangent%force_imbalance = matmul(tangent%force_imbalance, m)
  end subroutine differentiate_force


  !> Adds the rows of the closed nodes: stick ties the node to its origin, slip keeps it on the facet.
  !!
  !! The rows omit the dependence of the gap on the rotation of the normals: that term is proportional to the gap, which the row
  !! makes zero.
  subroutine add_contact_rows(contact, model, fields, tangents, constraints, n_conflicts)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(contact_tangent_type), intent(in) :: tangents(:)
    type(constraints_type), intent(inout) :: constraints
    integer, intent(out) :: n_conflicts            !< rows dropped because of rows of higher priority
    type(constraint_row_type) :: row
    real(DP) :: d(3), tolerance, direction(3, 3)
    integer :: i, k, n, verdict
    n_conflicts = 0
    do i = 1, size(tangents)
      associate (tangent => tangents(i), slave => fields%slaves(tangents(i)%slave))
        tolerance = 1.0e-6_DP * contact%edge(slave%pair)
        if (tangent%is_compliant_node) cycle
        if (slave%status == STATUS_SLIP) then
          call gap_row(tangent, slave%gap, row)
          call add_constraint_row(constraints, row, 3, tolerance, verdict)
          if (verdict == ROW_CONFLICT) n_conflicts = n_conflicts + 1
          cycle
        end if
        d = contact_slip_vector(contact, model, fields%u, slave)
        call stick_directions(contact, slave, tangent%slave, n, direction)
        do k = 1, n
          call tie_row(tangent, direction(:, k), d, row)
          if (k == 1 .and. has_other_constraints(contact, tangent%slave)) row%rhs = -slave%gap   ! it slides with its master
          call add_constraint_row(constraints, row, count(abs(direction(:, k)) > 0.0_DP), tolerance, verdict)
          if (verdict == ROW_CONFLICT) n_conflicts = n_conflicts + 1
        end do
      end associate
    end do
  end subroutine add_contact_rows


  !> The directions in which a sticking node is tied: its local axes that supports leave free; if other pairs constrain it too, or
  !! its master slides along supports, the normal and the remaining direction.
  pure subroutine stick_directions(contact, slave, s, n, direction)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s
    integer, intent(out) :: n                      !< directions
    real(DP), intent(out) :: direction(3, 3)       !< in columns
    real(DP) :: rest(3, 3), n_f(3)
    integer :: k
    n = 0
    direction = 0.0_DP
    if (.not. has_other_constraints(contact, s)) then
      do k = 1, 3
        if (contact%free_mask(k, s) == 0.0_DP) cycle
        n = n + 1
        direction(:, n) = contact%axes(:, k, s)
      end do
      return
    end if
    n = 1
    direction(:, 1) = slave%normal
    n_f = matmul(contact%free(:, :, s), slave%normal)
    rest = contact%free(:, :, s) - outer_product(n_f, n_f) / dot_product(n_f, n_f)
    k = maxloc(norm2(rest, dim=1), dim=1)          ! one direction at most: the other pair and the normal take one each
    if (norm2(rest(:, k)) < 0.1_DP) return
    n = 2
    direction(:, 2) = rest(:, k) / norm2(rest(:, k))
  end subroutine stick_directions


  !> d g = -g over the nodes of the row, the slave first.
  pure subroutine gap_row(tangent, gap, row)
    type(contact_tangent_type), intent(in) :: tangent
    real(DP), intent(in) :: gap
    type(constraint_row_type), intent(out) :: row
    integer :: j, k
    row%unknown = [((3 * (tangent%nodes(j) - 1) + k, k=1, 3), j=1, tangent%n_weights)]
    row%coefficient = reshape(tangent%gap_nodes(:, :tangent%n_weights), [3 * tangent%n_weights])
    row%rhs = -gap
  end subroutine gap_row


  !> Component along a direction of sum w_i du_i = -d.
  pure subroutine tie_row(tangent, direction, distance, row)
    type(contact_tangent_type), intent(in) :: tangent
    real(DP), intent(in) :: direction(3)
    real(DP), intent(in) :: distance(3)            !< d [length]
    type(constraint_row_type), intent(out) :: row
    integer, allocatable :: axes(:)
    integer :: j, k
    axes = pack([1, 2, 3], abs(direction) > 0.0_DP)
    row%unknown = [((3 * (tangent%nodes(j) - 1) + axes(k), k=1, size(axes)), j=1, tangent%n_weights)]
    row%coefficient = [((tangent%weights(j) * direction(axes(k)), k=1, size(axes)), j=1, tangent%n_weights)]
    row%rhs = -dot_product(direction, distance)
  end subroutine tie_row

end module amontons_contact_linearization
