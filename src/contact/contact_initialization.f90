!> Contact initialization at the start of a job, step or increment: projections, initial status, interference, areas, ADJUST.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_contact_initialization
  use amontons_kinds, only: DP, PI
  use amontons_element_kinds, only: MAX_FACE_NODES
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_surfaces, only: is_compliant, BEHAVIOR_TIED
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP, state_type, create_state
  use amontons_slave_node_overrides, only: node_overrides_type, gives_way, NODE_OVERRIDE_NONE, NODE_OVERRIDE_EXTENDED, &
    NODE_OVERRIDE_GIVES_WAY
  use amontons_contact_constraint_rows, only: evaluate_facet_weights
  use amontons_tributary_areas, only: integrate_face_area, out_of_plane_depth, sum_nodal_areas
  use amontons_surface_projection, only: find_edge_excess
  use amontons_facets, only: facets_type, is_absent_facet
  use amontons_facet_search, only: build_facet_search
  use amontons_mortar, only: find_search_margin, n_imbalance_nodes
  use amontons_shared_slave_nodes, only: order_slave_levels, reachable_nodes_type
  use amontons_slave_nodes, only: detach_slave, is_rough
  use amontons_contact_step, only: find_faceless_slaves
  use amontons_mortar_seams, only: update_mortar_rows
  use amontons_contact_pairs, only: contact_type, update_projection, set_stick_origin, create_contact, &
    SEARCH_RADIUS_RATIO, SEARCH_SLACK_RATIO
  use amontons_errors, only: error_type
  use amontons_containers, only: integer_list_type
  implicit none
  private
  public :: initialize_contact
  public :: find_adjustment, TOL_INITIAL_CONTACT

  real(DP), parameter :: TOL_INITIAL_CONTACT = 1.0e-6_DP  !< at the start a node nearer than this times the facet's edge is closed
                                                          !! [-]

contains

  !> Before the first iteration: searches facets for nodes without one, and sets the origins of the closed nodes.
  subroutine initialize_contact(contact, model, is_nlgeom, is_step_start, u_start, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_nlgeom
    logical, intent(in) :: is_step_start           !< first increment of a step
    real(DP), intent(in) :: u_start(:, :)          !< (3, n_nodes) displacement at the start of the step [length]
    type(fields_type), intent(inout) :: fields     !< in: u; out: slaves
    real(DP), allocatable :: x(:, :), x_now(:, :)
    type(reachable_nodes_type) :: nodes_in_reach
    real(DP) :: reach
    integer :: p, s
    logical :: is_new, needs_new_rows(size(model%pairs)), is_at_step_start(size(model%pairs))
    allocate (x, source=model%mesh%coordinates)
    needs_new_rows = .false.
    if (is_nlgeom) x = x + fields%u
    allocate (x_now, source=model%mesh%coordinates + fields%u)
    do p = 1, size(model%pairs)
      contact%has_fixed_geometry(p) = uses_fixed_geometry(contact, model, is_nlgeom, p)
      contact%reach(p) = SEARCH_RADIUS_RATIO * contact%edge(p)     ! what is not found now is never found on fixed facets
      if (contact%has_fixed_geometry(p)) contact%reach(p) = max(contact%reach(p), SEARCH_RADIUS_RATIO * model%pairs(p)%slave_edge)
      if (model%pairs(p)%has_point_contact) cycle
      reach = contact%reach(p)
      if (model%pairs(p)%is_mortar) reach = find_search_margin(contact%mortar(p), reach)
      if (.not. allocated(contact%facets(p)%profile)) call build_facet_search(contact%facets(p), merge(x, x_now, &
        contact%has_fixed_geometry(p)), &
        reach + SEARCH_SLACK_RATIO * contact%edge(p), contact%search(p))
      if (.not. model%pairs(p)%is_mortar) cycle
      needs_new_rows(p) = .not. contact%has_fixed_geometry(p) .or. is_step_start .or. .not. contact%mortar(p)%is_made
    end do
    is_at_step_start = needs_new_rows .and. contact%has_fixed_geometry .and. is_nlgeom
    if (any(is_at_step_start)) call update_mortar_rows(contact, fields%slaves, is_at_step_start, .true., &
      model%mesh%coordinates + u_start)
    needs_new_rows = needs_new_rows .and. .not. is_at_step_start
    if (any(needs_new_rows)) call update_mortar_rows(contact, fields%slaves, needs_new_rows, .true., x)
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        p = slave%pair
        if (contact%is_removed(p)) then
          call detach_slave(slave)
          slave%origin_facet = 0
          slave%elastic = 0.0_DP
          cycle
        end if
        reach = contact%reach(p)
        if (is_absent_facet(contact%facets(p), slave%facet)) call detach_slave(slave)
        if (slave%slave_facet > 0 .or. .not. contact%has_fixed_geometry(p)) then
          call update_projection(contact, x_now, s, reach, slave)
        else if (is_step_start) then
          call update_projection(contact, x, s, reach, slave)
        end if
        slave%overrides = node_overrides_type(edge=merge(NODE_OVERRIDE_EXTENDED, NODE_OVERRIDE_NONE, is_beyond_edge(contact, &
          slave)))
        is_new = .not. slave%is_initialized
        if (is_new) call initialize_slave(contact, model, slave)
        call ramp_interference(contact, is_step_start, fields, slave)
        if (is_new .and. slave%facet > 0 .and. slave%gap <= TOL_INITIAL_CONTACT * contact%edge(p)) slave%status = STATUS_STICK
        slave%is_bilateral = contact%laws(p)%has_no_separation .and. slave%status /= STATUS_OPEN
        slave%scenario = 0
        slave%is_in_law_range = slave%is_bilateral
        if (is_rough(contact%laws(p)) .and. slave%status == STATUS_SLIP) slave%status = STATUS_STICK   ! at its current position
        slave%slip_increment = 0.0_DP
        slave%origin_facet = 0
        if (slave%status /= STATUS_OPEN) call set_stick_origin(contact, model, fields%u, slave%facet, slave%xi, slave)
      end associate
    end do
    if (contact%shared_slaves%has_reaction_chains) call list_reachable_nodes(contact, model, fields%slaves, nodes_in_reach)
    call order_slave_levels(fields%slaves, mirrored_pairs(contact, model), nodes_in_reach, contact%shared_slaves)
    where (contact%is_pretension_duplicate .or. find_faceless_slaves(contact, model, fields%slaves)) &
      fields%slaves%overrides%side = NODE_OVERRIDE_GIVES_WAY
    do s = 1, size(fields%slaves)
      if (.not. gives_way(fields%slaves(s)%overrides)) cycle
      call detach_slave(fields%slaves(s))
      fields%slaves(s)%origin_facet = 0
    end do
    if (model%dialect == DIALECT_CALCULIX) x = x_now
    call update_areas(contact, model, x, fields%slaves)
  end subroutine initialize_contact


  !> Pairs that are an earlier one with exchanged sides, both surface-to-surface: the constraint of one enforces the other in the
  !! mean.
  function mirrored_pairs(contact, model) result(is_mirrored)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    logical :: is_mirrored(size(model%pairs)), is_hard_mortar(size(model%pairs))
    integer :: q
    is_hard_mortar = model%pairs%is_mortar .and. .not. is_compliant(contact%laws) .and. .not. contact%is_removed
    is_mirrored = .false.
    do q = 2, size(model%pairs)
      is_mirrored(q) = is_hard_mortar(q) .and. any(is_hard_mortar(:q - 1) .and. model%pairs(:q - 1)%slave == model%pairs(q)%master &
        .and. model%pairs(:q - 1)%master == model%pairs(q)%slave)
    end do
  end function mirrored_pairs


  !> The nodes to which slaves may give a force within the increment: those of the facet and around it, for a mortar row all its
  !! master nodes; under a compliant law also their own. A force on a mid-side node of a mortar pair acts on the adjacent corners
  !! too. Nodes beyond the master's edge transfer their functions to the row: its force on them has no part in the imbalances of
  !! other rows of the pair, and none in those of their corners, because the row has the corners with opposite weights.
  subroutine list_reachable_nodes(contact, model, slaves, reach)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    type(reachable_nodes_type), intent(out) :: reach
    integer, allocatable :: ends(:, :), nodes(:), own_side(:)
    logical :: is_master(model%mesh%n_nodes)       ! of the pair of the slave
    integer :: s, p, k, n
    allocate (ends(2, model%mesh%n_nodes), source=0)
    do p = 1, size(model%pairs)
      if (.not. model%pairs(p)%is_mortar .or. is_compliant(contact%laws(p))) cycle
      ends(:, contact%mortar(p)%nodes) = max(ends(:, contact%mortar(p)%nodes), contact%mortar(p)%corners)
    end do
    allocate (reach%first(size(slaves) + 1), reach%nodes(1000))
    reach%first(1) = 1
    p = 0
    do s = 1, size(slaves)
      if (slaves(s)%pair /= p) then
        p = slaves(s)%pair
        is_master = .false.
        is_master(pack(contact%facets(p)%nodes, contact%facets(p)%nodes > 0)) = .true.
      end if
      call add_reachable_nodes(s)
      call add_carriers(s)
      n = size(nodes)
      nodes = [nodes, pack(reshape(ends(:, nodes), [2 * n]), reshape(ends(:, nodes), [2 * n]) > 0), -own_side]
      n = reach%first(s)
      do while (n + size(nodes) > size(reach%nodes))
        reach%nodes = [reach%nodes, reach%nodes]
      end do
      do k = 1, size(nodes)
        if (any(reach%nodes(reach%first(s):n - 1) == nodes(k))) cycle
        reach%nodes(n) = nodes(k)
        n = n + 1
      end do
      reach%first(s + 1) = n
    end do
    call list_slaves_beside(contact, slaves, reach)

  contains

    !> The nodes of one slave, with repetitions.
    subroutine add_reachable_nodes(s)
      integer, intent(in) :: s
      integer :: own
      nodes = [integer ::]
      own_side = [integer ::]
      associate (slave => slaves(s), f => contact%facets(slaves(s)%pair))
        if (slave%facet == 0) return
        if (allocated(f%stencil)) nodes = f%stencil(f%stencil_first(slave%facet):f%stencil_first(slave%facet + 1) - 1)
        if (is_compliant(contact%laws(slave%pair))) nodes = [nodes, slave%node]
        if (slave%row == 0) return
        own = 0
        if (.not. is_compliant(contact%laws(slave%pair))) own = n_imbalance_nodes(contact%mortar(slave%pair), slave%row)
        associate (others => contact%mortar(slave%pair)%rows(slave%row)%nodes(own + 1:))
          nodes = [nodes, pack(others, is_master(others))]
          own_side = pack(others, .not. is_master(others))
        end associate
      end associate
    end subroutine add_reachable_nodes

    !> The slaves that carry the forces on these nodes and on those of the slave itself.
    subroutine add_carriers(s)
      integer, intent(in) :: s
      integer, allocatable :: loaded(:)
      integer :: i
      if (.not. allocated(contact%carrier) .or. slaves(s)%facet == 0) return   ! not before the first step
      loaded = [nodes, slaves(s)%node]
      if (slaves(s)%row > 0) loaded = [loaded, contact%mortar(slaves(s)%pair)%rows(slaves(s)%row)%nodes]
      do i = 1, size(loaded)
        nodes = [nodes, contact%carrier(contact%carrier_first(loaded(i)):contact%carrier_first(loaded(i) + 1) - 1)]
      end do
    end subroutine add_carriers

  end subroutine list_reachable_nodes


  !> Self contact: the slaves with a facet of the surface in common.
  subroutine list_slaves_beside(contact, slaves, reach)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    type(reachable_nodes_type), intent(inout) :: reach
    type(integer_list_type) :: beside
    integer, allocatable :: slave_of(:)            ! (n_nodes) of the present pair
    integer :: s, p
    allocate (reach%side_first(size(slaves) + 1), source=1)
    p = 0
    do s = 1, size(slaves)
      if (allocated(contact%facets(slaves(s)%pair)%unseen)) then
        if (p /= slaves(s)%pair) call number_slaves(slaves(s)%pair)
        p = slaves(s)%pair
        call add_slaves_beside(contact%facets(p), slaves(s)%node)
      end if
      reach%side_first(s + 1) = beside%n + 1
    end do
    reach%side = [integer ::]
    if (beside%n > 0) reach%side = beside%trimmed()

  contains

    !> The slaves of a pair at the nodes.
    subroutine number_slaves(pair)
      integer, intent(in) :: pair
      integer :: i
      slave_of = spread(0, 1, size(contact%facets(pair)%at_first) - 1)
      do i = 1, size(slaves)
        if (slaves(i)%pair == pair) slave_of(slaves(i)%node) = i
      end do
    end subroutine number_slaves

    !> Those beside a node.
    subroutine add_slaves_beside(f, node)
      type(facets_type), intent(in) :: f
      integer, intent(in) :: node
      integer :: i, k
      do i = f%at_first(node), f%at_first(node + 1) - 1
        do k = f%first(f%at(i)), f%first(f%at(i) + 1) - 1
          if (slave_of(f%nodes(k)) > 0) call beside%add(slave_of(f%nodes(k)))
        end do
      end do
    end subroutine add_slaves_beside

  end subroutine list_slaves_beside


  !> Whether a closed slave node is beyond an edge of its meshed master.
  pure logical function is_beyond_edge(contact, slave)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    is_beyond_edge = slave%overrides%edge == NODE_OVERRIDE_EXTENDED .and. slave%facet > 0 .and. slave%status /= STATUS_OPEN
    if (is_beyond_edge) is_beyond_edge = any(find_edge_excess(contact%facets(slave%pair)%kind(slave%facet), slave%xi) > 0.0_DP)
  end function is_beyond_edge


  !> Whether a pair has fixed weights and normals in a step. Under the calculix dialect node-to-surface and MORTAR pairs follow
  !! their master in any step, as in CalculiX.
  pure logical function uses_fixed_geometry(contact, model, is_nlgeom, p) result(is_kept)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_nlgeom
    integer, intent(in) :: p                       !< pair
    associate (pair => model%pairs(p))
      is_kept = pair%has_point_contact .or. pair%is_small_sliding .or. .not. is_nlgeom
      if (model%dialect /= DIALECT_CALCULIX .or. pair%has_point_contact) return
      if (.not. pair%is_mortar) is_kept = is_kept .and. .not. is_compliant(contact%laws(p))
      if (pair%is_mortar) is_kept = pair%is_small_sliding
    end associate
  end function uses_fixed_geometry


  !> Start of the job: CLEARANCE prescribes the gap of a pair; the gap of a tied node is zero; surfaces before their faces are
  !! nearer by their height.
  subroutine initialize_slave(contact, model, slave)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(inout) :: slave
    slave%is_initialized = .true.
    slave%clearance = -model%pairs(slave%pair)%height
    if (slave%facet == 0) return
    if (model%pairs(slave%pair)%has_clearance) slave%clearance = model%pairs(slave%pair)%clearance - slave%gap
    if (contact%laws(slave%pair)%behavior == BEHAVIOR_TIED .and. slave%slave_facet == 0) slave%clearance = -slave%gap
  end subroutine initialize_slave


  !> The allowed overclosure: full at the start of the step, zero at its end.
  !!
  !! Under the calculix dialect, as in CalculiX: the initial overclosure of a slave node at the start of the job is ramped down over
  !! the first increment, as if that were the step, and acts fully afterwards. Integration points: in the first step the overclosure
  !! of a point at the start of an increment is ramped down over the rest of the step, again in each increment; in later steps only
  !! that of an open point, over the first increment. CLEARANCE grows with the time of each step there.
  subroutine ramp_interference(contact, is_step_start, fields, slave)
    type(contact_type), intent(in) :: contact
    logical, intent(in) :: is_step_start
    type(fields_type), intent(in) :: fields        !< step, times at the end of the increment
    type(slave_state_type), intent(inout) :: slave
    real(DP) :: offset, remaining_share, gap_without_offset, clearance_now
    logical :: is_new
    gap_without_offset = slave%gap - slave%offset
    clearance_now = slave%clearance
    if (slave%slave_facet > 0) clearance_now = clearance_now * fields%step_time / contact%period
    if (is_step_start) then
      slave%allowed = contact%interference(slave%pair)
      is_new = contact%is_ramped(slave%pair) .and. slave%row > 0 .and. slave%status == STATUS_OPEN
      if (slave%facet > 0 .and. (contact%is_shrink_fit(slave%pair) .or. is_new)) slave%allowed = max(0.0_DP, &
        -(gap_without_offset + clearance_now))
    end if
    is_new = contact%is_ramped(slave%pair) .and. (slave%slave_facet > 0 .or. slave%row == 0)
    if (is_new .and. .not. (abs(contact%interference(slave%pair)) > 0.0_DP .or. contact%is_shrink_fit(slave%pair))) then
      is_new = fields%step <= 1 .and. (is_step_start .or. slave%slave_facet > 0)
      is_new = is_new .or. (slave%slave_facet > 0 .and. is_step_start .and. slave%status == STATUS_OPEN)
      remaining_share = 1.0_DP - (fields%step_time - fields%time_increment) / contact%period
      is_new = is_new .and. fields%time_increment > 0.0_DP .and. remaining_share > 0.0_DP   ! not in the model check
      slave%allowed = 0.0_DP
      if (slave%facet > 0 .and. is_new) slave%allowed = max(0.0_DP, -(gap_without_offset + clearance_now)) / remaining_share
    end if
    offset = clearance_now + slave%allowed * max(0.0_DP, 1.0_DP - fields%step_time / contact%period)
    if (slave%facet > 0) slave%gap = gap_without_offset + offset
    slave%offset = offset
  end subroutine ramp_interference


  !> The areas of the slave nodes of compliant pairs in the current configuration: the laws define true pressures. A slave node
  !! without faces of its own has the area of its facet.
  subroutine update_areas(contact, model, x, slaves)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates now [length]
    type(slave_state_type), intent(inout) :: slaves(:)
    real(DP), allocatable :: area(:), area_vector(:, :)
    real(DP) :: weights(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), vector(3), depth
    integer :: nodes(MAX_FACE_NODES), n, s, p
    do p = 1, size(model%pairs)
      if (.not. is_compliant(contact%laws(p)) .or. model%pairs(p)%is_mortar) cycle
      allocate (area_vector(3, size(x, 2)), area(size(x, 2)), source=0.0_DP)
      call sum_nodal_areas(model%mesh, contact%slave_area_faces(p), x, area_vector, area, contact%is_absent)
      do s = 1, size(slaves)
        if (slaves(s)%pair /= p) cycle
        if (area(slaves(s)%node) > 0.0_DP) then
          slaves(s)%area = area(slaves(s)%node)
        else if (slaves(s)%facet > 0 .and. .not. allocated(contact%facets(p)%profile)) then
          call evaluate_facet_weights(contact%facets(p), slaves(s)%facet, slaves(s)%xi, n, nodes, weights, dN)
          depth = out_of_plane_depth(model%mesh, contact%facets(p)%element(slaves(s)%facet))
          if (depth < 0.0_DP) depth = 2 * PI * x(1, slaves(s)%node)   ! length of the node's circle
          call integrate_face_area(x(:, nodes(:n)), contact%facets(p)%kind(slaves(s)%facet), depth, vector, slaves(s)%area)
        end if
      end do
      deallocate (area_vector, area)
    end do
  end subroutine update_areas


  !> ADJUST: the adjustments of slave nodes that penetrate or are nearer than the distance, along the master's normal; nodes of the
  !! given set at any distance. A constrained mid-side node moves by the mean of its corners.
  !!
  !! As in Abaqus and CalculiX the job is solved on the adjusted mesh: the caller adds the adjustments to the coordinates. Cost: one
  !! search.
  subroutine find_adjustment(model, adjustment, error)
    type(model_type), intent(in) :: model
    real(DP), intent(out) :: adjustment(:, :)             !< (3, n_nodes) from the current positions [length]
    type(error_type), allocatable, intent(out) :: error
    type(contact_type) :: contact
    type(model_type) :: by_nodes                   ! the same with node-to-surface contact: nodes are adjusted, not faces
    type(state_type) :: state
    type(slave_state_type), allocatable :: slaves(:)
    integer :: s, i
    adjustment = 0.0_DP
    if (.not. any(model%pairs%has_adjust)) return
    by_nodes = model
    by_nodes%pairs%is_mortar = .false.
    by_nodes%pairs%has_point_contact = .false.
    call create_contact(contact, by_nodes, slaves, error)
    if (allocated(error)) return
    call create_state(state, model%mesh, slaves)
    call initialize_contact(contact, by_nodes, .true., .true., state%new%u, state%new)
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (is_adjusted(model, slave)) adjustment(:, slave%node) = -(slave%gap - slave%offset) * slave%normal
      end associate
    end do
    do i = 1, size(contact%midsides%nodes, 2)
      associate (f => contact%midsides%nodes(:, i))
        adjustment(:, f(1)) = 0.5_DP * (adjustment(:, f(2)) + adjustment(:, f(3)))
      end associate
    end do
  end subroutine find_adjustment


  !> Whether a slave node is to be adjusted.
  pure logical function is_adjusted(model, slave)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slave
    is_adjusted = .false.
    associate (pair => model%pairs(slave%pair))
      if (.not. pair%has_adjust .or. slave%facet == 0) return
      if (allocated(pair%adjust_nodes)) then
        is_adjusted = any(pair%adjust_nodes == slave%node)
      else
        is_adjusted = slave%gap - slave%offset <= pair%adjust .and. slave%gap - slave%offset >= -pair%adjust_depth
      end if
    end associate
  end function is_adjusted

end module amontons_contact_initialization
