!> The contact pairs: facets, search, projections, mortar rows and the first-touch (stick) origin of each slave node.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 1.
module amontons_contact_pairs
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY
  use amontons_containers, only: integer_list_type, list_groups
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_element_kinds, only: has_faces_in_space, MAX_FACE_NODES
  use amontons_model, only: model_type, dof_direction, DIALECT_CALCULIX
  use amontons_surfaces, only: interaction_type, is_compliant, is_self_contact, pair_interactions
  use amontons_slave_nodes, only: detach_slave
  use amontons_friction_slip_scenarios, only: slip_state_type
  use amontons_slave_node_overrides, only: edge_extension, gives_way, NODE_OVERRIDE_OFF_MASTER
  use amontons_user_contact, only: user_response_type
  use amontons_slave_node_equilibrium, only: local_solution_type
  use amontons_controls, only: contact_controls_type
  use amontons_steps, only: step_type
  use amontons_state, only: slave_state_type, n_amplitude_memory, STATUS_OPEN, STATUS_STICK
  use amontons_constraints, only: constraints_type, build_condensation_matrix
  use amontons_contact_constraint_rows, only: contact_row_type, fill_facet_row, evaluate_relative_position
  use amontons_tributary_areas, only: element_faces_type, add_nodal_face_areas, find_slave_faces, find_mean_edge_length
  use amontons_analytic_profiles, only: profile_length, PROFILE_PLANAR
  use amontons_sparse, only: sparse_type
  use amontons_shared_slave_nodes, only: shared_slaves_type, find_shared_slaves, global_axes, resize_shared_slaves, &
    are_shared
  use amontons_facets, only: facets_type, build_facets, is_unseen, facet_nodes, n_facet_corners, EDGE_CONVEX
  use amontons_facet_crossing, only: plane_normal
  use amontons_self_contact_visibility, only: find_unseen_facets, current_node_normal
  use amontons_analytic_master, only: build_profile_facets
  use amontons_midside_constraints, only: midsides_type, append_midsides
  use amontons_exterior_surface, only: depths_below, common_depth, reached_depth
  use amontons_facet_search, only: facet_search_type, renew_facet_search
  use amontons_mortar, only: mortar_type, create_mortar, unify_imbalance_weights, add_pretension_rows, rotate_with_normal, &
    differentiate_rotation
  use amontons_surface_projection, only: projection_type, track_projection, find_projection, measure_thickness, find_clearance, &
    find_edge_excess, PROJECTION_INSIDE, PROJECTION_OUTSIDE
  implicit none
  private
  public :: contact_type, create_contact, set_free_directions, resize_contact
  public :: current_row, origin_row, contact_slip_vector, origin_offset_derivative, search_lost_slave, &
    update_projection, &
    update_mortar_slave, update_gap, set_stick_origin, is_stuck_to_mortar_row, find_slaves_apart, &
    find_slave_projection, renew_searches, begin_search, measure_clearances, SEARCH_RADIUS_RATIO, SEARCH_SLACK_RATIO, &
    MAX_DEPTH_SHARE

  real(DP), parameter :: SEARCH_RADIUS_RATIO = 3.0_DP    !< search radius over the longest facet edge [-]
  real(DP), parameter :: SEARCH_SLACK_RATIO = 0.5_DP     !< motion of a master, over that edge, after which its grid is rebuilt [-]
  real(DP), parameter :: MAX_BESIDE = 0.01_DP    !< a node is beside a facet beyond this excess over its ridge, over its length [-]
  real(DP), parameter :: MIN_RIDGE_COSINE = 0.1_DP   !< of the normals of slave and of a side of the master that faces it [-]
  real(DP), parameter :: MAX_DEPTH_SHARE = 0.9_DP  !< a node behind a facet by more than this share of the depth of its element,
                                                   !! or of the thickness of its sheet, does not see it [-]

  !> The contact pairs: facets, search, free directions, and the results of the last evaluation.
  type :: contact_type
    type(facets_type), allocatable :: facets(:)   !< (n_pairs) the master's facets
    type(facet_search_type), allocatable :: search(:)   !< (n_pairs)
    logical, allocatable :: has_fixed_geometry(:)           !< (n_pairs) weights and normals are fixed in this step
    type(interaction_type), allocatable :: laws(:)   !< (n_pairs) in this step
    logical, allocatable :: is_removed(:)         !< (n_pairs) removed in this step
    logical, allocatable :: is_absent(:)          !< (n_elements) removed: their faces touch nothing; not allocated: none
    logical, allocatable :: is_pretension_duplicate(:)  !< (n_slaves) a pre-tension section binds it to a slave of its pair that has
                                                        !! the contact of both
    real(DP), allocatable :: interference(:)      !< (n_pairs) overclosure allowed at the start of this step [length]
    logical, allocatable :: is_shrink_fit(:)          !< (n_pairs) the initial overclosure of each node is allowed
    logical, allocatable :: is_ramped(:)          !< (n_pairs) initial overclosures are ramped as in CalculiX
    real(DP) :: period = 1                        !< of the step [time]
    type(contact_controls_type) :: controls       !< of the step
    type(element_faces_type), allocatable :: slave_area_faces(:)  !< (n_pairs) faces for the areas of slave nodes of compliant laws
    type(midsides_type) :: midsides               !< mid-side slave nodes and those that follow their corners
    real(DP), allocatable :: slave_normal(:, :)  !< (3, n_slaves) outward from the slave in the reference configuration; 0 if node
                                                 !! based
    real(DP), allocatable :: axes(:, :, :)  !< (3, 3, n_slaves) in columns: the global axes, or those of the node's local coordinate
                                            !! system
    real(DP), allocatable :: free_mask(:, :)           !< (3, n_slaves) along them: 1 free, 0 fixed by a support or an equation
    integer, allocatable :: seam(:)  !< (n_slaves) SEAM_... of `mortar_seams`: whether it is merged into the row of an earlier slave
    type(shared_slaves_type) :: shared_slaves               !< pairs that share nodes
    type(sparse_type) :: force_condensation  !< E: condenses forces on all nodes to free unknowns; only with several levels of
                                             !! slaves
    integer, allocatable :: carrier_first(:)   !< (n_nodes + 1) start of the carriers of a node
    integer, allocatable :: carrier(:)         !< nodes of exact slaves that move a node by supports and equations, and carry its
                                               !! contact forces
    real(DP), allocatable :: free(:, :, :)  !< (3, 3, n_slaves) projector on the directions that supports and other pairs leave free
    logical, allocatable :: has_sliding_support(:)         !< (n_slaves) its master slides in directions in which supports fix it
    real(DP), allocatable :: friction(:)          !< (n_slaves) mu at the last evaluation [-]
    real(DP), allocatable :: Rhat(:, :)  !< (3, n_slaves) imbalance of the row, including the reactions of other slaves [force]
    type(mortar_type), allocatable :: mortar(:)   !< (n_pairs) rows of surface-to-surface pairs: slave%row; empty for others
    real(DP), allocatable :: edge(:)              !< (n_pairs) longest facet edge of the master [length]
    real(DP), allocatable :: reach(:)             !< (n_pairs) search radius; on fixed facets that of a slave edge, too [length]
    real(DP), allocatable :: searched_x(:, :)     !< (3, n_nodes) coordinates at the last search of all nodes without a facet
                                                  !! [length]
    real(DP), allocatable :: clearance(:)         !< (n_slaves) least distance of such a node from its master there, gap of an open
                                                  !! row; 0: not known [length]
    real(DP), allocatable :: master_motion(:)     !< (n_pairs) largest motion of the master since then [length]
    type(slip_state_type), allocatable :: slip_data(:) !< (n_slaves) the decision on each slave node at the last evaluation
    type(user_response_type), allocatable :: user_responses(:)   !< (n_slaves) of FRIC and UINTER at the last evaluation
    type(local_solution_type), allocatable :: local_equilibrium(:)     !< (n_slaves) under compliant laws, at the last evaluation
    real(DP), allocatable :: law_linearization_force(:, :)  !< (3, n_nodes) forces of linearized laws at the actual positions minus
                                                            !! those in local equilibrium [force]
    logical, allocatable :: is_uncoupled(:)            !< (n_slaves) compliant law, and no other slave gives its node a force
    real(DP), allocatable :: memory(:)            !< committed STATEV
    real(DP), allocatable :: direction(:, :)      !< (3, n_slaves) of friction on the slave at the last evaluation
    real(DP), allocatable :: held_limit(:)        !< (n_slaves) friction limits while contact is held, which decide the statuses
                                                  !! after that; not allocated: those of the normal forces [force]
    real(DP), allocatable :: held_friction(:, :)  !< (3, n_slaves) friction on the slipping nodes where contact began to be held;
                                                  !! not allocated: it is not held [force]
    real(DP), allocatable :: held_normal_force(:)   !< (n_slaves) normal forces where an augmented round began: exact contact is a
                                                  !! spring beside them; not allocated: it is not augmented [force]
    integer :: n_newly_opened = 0                       !< changes in the last evaluation
    integer :: n_closed = 0
    integer :: n_changed = 0                      !< all changes of status, including opened and closed
    integer :: n_lost_master = 0                         !< nodes that lost their master
    integer :: n_imposed = 0                      !< nodes that the line search set to stick against their trial traction
    real(DP) :: max_gap_error = 0                     !< of the closed nodes, over the edge of the master's facet [-]
    integer :: worst_slave = 0
  end type contact_type

contains

  !> Sets up facets, slave nodes (corners of the slave faces, all nodes of a node-based surface) and their areas.
  subroutine create_contact(contact, model, slaves, error)
    type(contact_type), intent(out) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), allocatable, intent(out) :: slaves(:)   !< all slave nodes of all pairs, open
    type(error_type), allocatable, intent(out) :: error
    integer :: p, n
    allocate (contact%facets(size(model%pairs)), contact%search(size(model%pairs)))
    allocate (contact%has_fixed_geometry(size(model%pairs)), source=.false.)
    allocate (contact%edge(size(model%pairs)), contact%reach(size(model%pairs)), contact%slave_area_faces(size(model%pairs)))
    allocate (contact%is_removed(size(model%pairs)), contact%is_shrink_fit(size(model%pairs)), &
      contact%is_ramped(size(model%pairs)), source=.false.)
    allocate (contact%interference(size(model%pairs)), source=0.0_DP)
    contact%laws = pair_interactions(model%pairs, model%interactions)
    allocate (slaves(0), contact%slave_normal(3, 0), contact%mortar(size(model%pairs)))
    call append_midsides(contact%midsides, reshape([integer ::], [3, 0]), reshape([integer ::], [2, 0]))
    do p = 1, size(model%pairs)
      associate (master => model%surfaces(model%pairs(p)%master))
        if (allocated(master%profile)) then
          call build_profile_facets(master%profile, find_mean_edge_length(model%mesh, model%surfaces(model%pairs(p)%slave), &
            profile_length(master%profile)), contact%facets(p))
        else
          call build_facets(model%mesh, master%element, master%face, contact%facets(p), error, &
            is_faceted=is_faceted(model, contact%laws(p), p))
        end if
        if (.not. allocated(error)) call check_dimensions(model, p, error)
        if (allocated(error)) return
      end associate
      contact%edge(p) = maxval(contact%facets(p)%edge_length)
      contact%reach(p) = SEARCH_RADIUS_RATIO * contact%edge(p)
      call limit_depth(model, p, contact%edge(p), contact%facets(p))
      if (is_self_contact(model%pairs(p))) call find_unseen_facets(model%mesh%coordinates, &
        contact%facets(p)%max_depth / MAX_DEPTH_SHARE, contact%facets(p))
      if (model%pairs(p)%is_mortar) then
        associate (slave => model%surfaces(model%pairs(p)%slave))
          call create_mortar(model%mesh, slave%element, slave%face, slave%nodes, contact%mortar(p), error)
        end associate
        if (allocated(error)) return
      else if (is_compliant(contact%laws(p))) then
        call find_slave_faces(model%mesh, model%surfaces(model%pairs(p)%slave), model%dialect == DIALECT_CALCULIX, &
          contact%slave_area_faces(p))
      end if
      if (.not. model%pairs(p)%has_point_contact) call append_slaves(contact, model, p, slaves)
    end do
    n = size(slaves)
    call unite_hard_mortar_pairs(contact, model)
    allocate (contact%is_pretension_duplicate(n), contact%has_sliding_support(n), source=.false.)
    allocate (contact%seam(n), source=0)
    if (allocated(model%pretension_node_pairs)) call mark_pretension_duplicates(contact, model, slaves)
    call find_shared_slaves(model%mesh%n_nodes, slaves, contact%facets, .not. is_compliant(contact%laws), contact%shared_slaves)
    do p = 1, size(model%pairs)
      if (.not. model%pairs(p)%is_mortar) cycle
      contact%mortar(p)%has_other_masters = are_shared(contact%shared_slaves, contact%mortar(p)%nodes, &
        allocated(contact%facets(p)%unseen))
      contact%mortar(p)%has_unique_slaves = .not. any(contact%mortar(p)%has_other_masters)
    end do
    allocate (contact%free_mask(3, n), source=1.0_DP)
    allocate (contact%axes, source=global_axes(n))
    allocate (contact%free(3, 3, n), contact%friction(n), contact%Rhat(3, n), source=0.0_DP)
    allocate (contact%direction(3, n), source=0.0_DP)
    allocate (contact%user_responses(n), contact%local_equilibrium(n))
    allocate (contact%is_uncoupled(n), source=.false.)
    allocate (contact%law_linearization_force(3, model%mesh%n_nodes), source=0.0_DP)
    allocate (contact%slip_data(n))
  end subroutine create_contact


  !> The depth behind a facet from which nodes do not see it: in general contact how far a slave reaches (`reached_depth`), in self
  !! contact that of its element (`common_depth`), else that of a body both of whose sides are in the master, as of a sheet or a
  !! whole exterior. A slave beyond the one side is not behind the other.
  subroutine limit_depth(model, p, edge, facets)
    type(model_type), intent(in) :: model
    integer, intent(in) :: p                       !< pair
    real(DP), intent(in) :: edge                   !< longest of the facets [length]
    type(facets_type), intent(inout) :: facets     !< its master
    real(DP) :: thickness(facets%n)
    if (allocated(facets%profile)) return
    if (model%pairs(p)%is_general .or. is_self_contact(model%pairs(p))) then
      thickness = depths_below(model%mesh, facets)
      if (.not. is_self_contact(model%pairs(p))) thickness = reached_depth(thickness, &
        model%surfaces(model%pairs(p)%master)%thickness, model%pairs(p)%slave_edge)
      facets%max_depth = MAX_DEPTH_SHARE * common_depth(thickness, facets%edge_length, model%pairs(p)%slave_depth) &
        + max(0.0_DP, -model%pairs(p)%height)
      return
    end if
    call measure_thickness(facets, model%mesh%coordinates, SEARCH_RADIUS_RATIO * edge, thickness)
    if (any(thickness < huge(thickness))) facets%max_depth = MAX_DEPTH_SHARE * thickness
  end subroutine limit_depth


  !> Marks the slaves of compliant laws whose law alone balances their imbalance: no other slave gives a force to the nodes of the
  !! row, no other node depends on them, and none of them has a support that the slave lacks.
  pure function find_uncoupled_slaves(contact, model, slaves, base) result(is_uncoupled)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    type(constraints_type), intent(in) :: base     !< boundary conditions, equations, mid-side constraints
    logical :: is_uncoupled(size(slaves)), is_shared(model%mesh%n_nodes), is_held(3)
    integer :: n_slaves(model%mesh%n_nodes), p, s
    n_slaves = 0
    do s = 1, size(slaves)
      if (slaves(s)%slave_facet == 0) n_slaves(slaves(s)%node) = n_slaves(slaves(s)%node) + 1
    end do
    is_shared = n_slaves > 1
    do p = 1, base%n_rows                          ! a node on which others depend has their imbalance too
      if (size(base%rows(p)%unknown) > 0) is_shared((base%rows(p)%unknown + 2) / 3) = .true.
    end do
    do p = 1, size(model%pairs)
      is_shared(pack(contact%facets(p)%nodes, contact%facets(p)%nodes > 0)) = .true.
    end do
    do s = 1, size(slaves)
      is_uncoupled(s) = is_compliant(contact%laws(slaves(s)%pair)) .and. slaves(s)%slave_facet == 0
      if (.not. is_uncoupled(s)) cycle
      is_uncoupled(s) = .not. is_shared(slaves(s)%node)
      if (slaves(s)%row == 0) cycle
      is_held = base%owner(3 * slaves(s)%node - 2:3 * slaves(s)%node) /= 0
      associate (own => contact%mortar(slaves(s)%pair)%rows(slaves(s)%row)%imbalance_nodes)
        is_uncoupled(s) = .not. any(is_shared(own))
        do p = 1, size(own)
          is_uncoupled(s) = is_uncoupled(s) .and. .not. any(base%owner(3 * own(p) - 2:3 * own(p)) /= 0 .and. .not. is_held)
        end do
      end associate
    end do
  end function find_uncoupled_slaves


  !> Slave nodes across pre-tension sections: of two at one position only the first has unknowns of its own.
  subroutine mark_pretension_duplicates(contact, model, slaves)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    logical :: is_pair_slave(model%mesh%n_nodes)
    integer :: p, i
    do p = 1, size(model%pairs)
      if (is_compliant(contact%laws(p))) cycle
      if (model%pairs(p)%is_mortar) call add_pretension_rows(contact%mortar(p), model%pretension_node_pairs)
      is_pair_slave = .false.
      is_pair_slave(pack(slaves%node, slaves%pair == p)) = .true.
      associate (node_pairs => model%pretension_node_pairs)
        do i = 1, size(node_pairs, 2)
          if (is_pair_slave(node_pairs(1, i))) where (slaves%pair == p .and. slaves%node == node_pairs(2, &
            i)) contact%is_pretension_duplicate = .true.
        end do
      end associate
    end do
  end subroutine mark_pretension_duplicates


  !> Unifies the transformed bases of exact mortar pairs that share slave nodes.
  subroutine unite_hard_mortar_pairs(contact, model)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(mortar_type), allocatable :: exact(:)
    integer, allocatable :: list(:)
    integer :: p
    list = pack([(p, p=1, size(model%pairs))], model%pairs%is_mortar .and. .not. is_compliant(contact%laws))
    if (size(list) < 2) return
    exact = contact%mortar(list)
    call unify_imbalance_weights(exact, model%mesh%n_nodes)
    contact%mortar(list) = exact
  end subroutine unite_hard_mortar_pairs


  !> Adapts the arrays to a new number of slaves: those of pairs with integration points are the last.
  subroutine resize_contact(contact, slaves)
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP), allocatable :: normal(:, :)
    integer :: n, s
    n = size(slaves)
    if (n == size(contact%friction) .and. .not. any(slaves%slave_facet > 0)) return
    allocate (normal(3, n), source=0.0_DP)
    do s = 1, n
      if (slaves(s)%slave_facet == 0) normal(:, s) = contact%slave_normal(:, s)
      if (slaves(s)%slave_facet > 0) normal(:, s) = -contact%mortar(slaves(s)%pair)%places(slaves(s)%row)%normal
    end do
    call move_alloc(normal, contact%slave_normal)
    if (n == size(contact%friction)) return
    contact%free_mask = reshape(contact%free_mask(:, :min(n, size(contact%friction))), [3, n], pad=[1.0_DP])
    contact%axes = reshape(contact%axes(:, :, :min(n, size(contact%friction))), [3, 3, n], pad=global_axes(1))
    contact%free = reshape([0.0_DP], [3, 3, n], pad=[0.0_DP])
    contact%has_sliding_support = spread(.false., 1, n)
    contact%friction = spread(0.0_DP, 1, n)
    contact%is_pretension_duplicate = [contact%is_pretension_duplicate(:min(n, size(contact%is_pretension_duplicate))), &
      spread(.false., 1, n - min(n, size(contact%is_pretension_duplicate)))]
    deallocate (contact%user_responses, contact%local_equilibrium)
    allocate (contact%user_responses(n), contact%local_equilibrium(n))
    contact%is_uncoupled = [contact%is_uncoupled(:min(n, size(contact%is_uncoupled))), spread(.false., 1, n - min(n, &
      size(contact%is_uncoupled)))]
    contact%Rhat = reshape([0.0_DP], [3, n], pad=[0.0_DP])
    contact%direction = contact%Rhat
    contact%slip_data = spread(slip_state_type(), 1, n)
    call resize_shared_slaves(contact%shared_slaves, n)
  end subroutine resize_contact


  !> Whether the normals of a master are those of its faces, as in CalculiX, or continuous over the faces.
  pure logical function is_faceted(model, law, pair)
    type(model_type), intent(in) :: model
    type(interaction_type), intent(in) :: law
    integer, intent(in) :: pair
    is_faceted = model%dialect == DIALECT_CALCULIX .and. .not. model%pairs(pair)%is_mortar .and. is_compliant(law)
  end function is_faceted


  !> Checks that both surfaces of a pair are of solids, or both of plane elements.
  subroutine check_dimensions(model, pair, error)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    type(error_type), allocatable, intent(out) :: error
    logical, allocatable :: is_solid(:)
    associate (slave => model%surfaces(model%pairs(pair)%slave), master => model%surfaces(model%pairs(pair)%master), &
      kind => model%mesh%kind)
      is_solid = has_faces_in_space(kind(master%element))
      if (allocated(master%profile)) is_solid = [master%profile%kind /= PROFILE_PLANAR]
      if (.not. slave%is_node_based) is_solid = [is_solid, has_faces_in_space(kind(slave%element))]
      if (all(is_solid) .or. .not. any(is_solid)) return
      call set_error(error, EXIT_SETUP, 'The contact pair ' // slave%name // ' / ' // master%name // ' has faces of ' // &
        'solids and edges of plane elements; both surfaces must be of one kind.')
    end associate
  end subroutine check_dimensions


  !> The slave nodes of one pair with area and outward normal, and the mid-side nodes constrained to their corners. Under a
  !! compliant law no node is constrained, and nodes without area are no slaves; in a mortar pair all nodes are slaves.
  subroutine append_slaves(contact, model, pair, slaves)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    type(slave_state_type), allocatable, intent(inout) :: slaves(:)
    real(DP), allocatable :: area_vector(:, :), area(:)
    integer, allocatable :: corners(:, :)          ! (2, n_nodes) the corners of a mid-side node
    integer, allocatable :: midside_nodes(:)           ! of this pair
    integer, allocatable :: slave_of(:)            ! (n_nodes) of this pair
    type(slave_state_type), allocatable :: added(:)
    integer :: i, f, n, node, memory
    logical :: has_nodal_areas
    has_nodal_areas = is_compliant(contact%laws(pair)) .or. model%pairs(pair)%is_mortar
    associate (mesh => model%mesh, surface => model%surfaces(model%pairs(pair)%slave))
      allocate (area_vector(3, mesh%n_nodes), area(mesh%n_nodes), source=0.0_DP)
      allocate (corners(2, mesh%n_nodes), source=0)
      allocate (slave_of(mesh%n_nodes), source=0)
      allocate (added(size(surface%nodes)))
      if (.not. surface%is_node_based) then
        do f = 1, size(surface%element)
          call add_nodal_face_areas(mesh, surface%element(f), surface%face(f), has_nodal_areas, area_vector, area, corners)
        end do
      end if
      memory = n_amplitude_memory(model)
      if (size(slaves) > 0) memory = slaves(size(slaves))%memory + contact%laws(slaves(size(slaves))%pair)%n_statev
      n = 0
      do i = 1, size(surface%nodes)
        node = surface%nodes(i)
        if (has_nodal_areas .and. .not. surface%is_node_based .and. area(node) <= 0.0_DP &
          .and. .not. model%pairs(pair)%is_mortar) cycle
        if (corners(1, node) > 0) cycle
        n = n + 1
        added(n) = slave_state_type(pair=pair, node=node, area=merge(1.0_DP, area(node), surface%is_node_based), memory=memory)
        if (model%pairs(pair)%is_mortar) added(n)%row = i
        memory = memory + contact%laws(pair)%n_statev
      end do
      slave_of(added(:n)%node) = [(size(slaves) + i, i=1, n)]
      midside_nodes = pack(surface%nodes, corners(1, surface%nodes) > 0)
      call append_midsides(contact%midsides, reshape([(midside_nodes(i), corners(:, midside_nodes(i)), i=1, &
        size(midside_nodes))], [3, size(midside_nodes)]), reshape([(slave_of(corners(:, midside_nodes(i))), i=1, &
        size(midside_nodes))], [2, size(midside_nodes)]))
      slaves = [slaves, added(:n)]
      contact%slave_normal = reshape([contact%slave_normal, (area_vector(:, added(i)%node) &
        / max(norm2(area_vector(:, added(i)%node)), tiny(1.0_DP)), i=1, n)], [3, size(slaves)])
    end associate
  end subroutine append_slaves


  !> The free directions of the slave nodes: contact gives no force in a direction fixed by a support.
  subroutine set_free_directions(contact, model, slaves, base, is_held, error)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    type(constraints_type), intent(in) :: base     !< boundary conditions, equations, mid-side constraints
    logical, intent(in) :: is_held(:, :)           !< (3, n_nodes) by supports, along the axes of the node's local coordinate system
    type(error_type), allocatable, intent(out) :: error
    logical :: is_component_held(3)
    integer :: middle(model%mesh%n_nodes)          ! the node of the deck whose supports hold a node
    integer :: s, k
    middle = middle_nodes(model)
    do s = 1, size(slaves)
      if (slaves(s)%slave_facet > 0) cycle  ! integration points are no nodes; their number changes, and they are the last
      associate (node => slaves(s)%node, own => middle(slaves(s)%node))
        is_component_held = base%owner(3 * node - 2:3 * node) /= 0
        contact%axes(:, :, s:s) = global_axes(1)
        if (any(is_component_held) .and. count(is_held(:, own)) == count(is_component_held)) then   ! supports alone, no equation
          is_component_held = is_held(:, own)
          contact%axes(:, :, s) = reshape([(dof_direction(model, own, k), k=1, 3)], [3, 3])
        end if
        contact%free_mask(:, s) = merge(0.0_DP, 1.0_DP, is_component_held)
      end associate
    end do
    contact%is_uncoupled = find_uncoupled_slaves(contact, model, slaves, base)
    call list_carriers(contact, model%mesh%n_nodes, slaves, base)
    if (contact%shared_slaves%has_reaction_chains) call build_condensation_matrix(base, contact%force_condensation, error)
  end subroutine set_free_directions


  !> The node of the deck whose supports hold a node: of a node on the face of a shell or beam that of its director, else itself.
  pure function middle_nodes(model) result(middle)
    type(model_type), intent(in) :: model
    integer :: middle(model%mesh%n_nodes)
    integer :: i
    middle = [(i, i=1, model%mesh%n_nodes)]
    if (.not. allocated(model%structure)) return
    if (.not. allocated(model%structure%directors)) return
    do i = 1, size(model%structure%directors)
      associate (director => model%structure%directors(i))
        middle(director%nodes) = director%node
      end associate
    end do
  end function middle_nodes


  !> Lists for the nodes on which contact acts the exact slaves that move them by supports and equations: these slaves carry their
  !! forces. A mid-side node that follows its corners has none: the rows of its pair have its force.
  subroutine list_carriers(contact, n_nodes, slaves, base)
    type(contact_type), intent(inout) :: contact   !< out: carrier
    integer, intent(in) :: n_nodes
    type(slave_state_type), intent(in) :: slaves(:)
    type(constraints_type), intent(in) :: base
    type(integer_list_type) :: carried, carriers
    integer, allocatable :: member(:)
    logical :: is_loaded(n_nodes)
    integer :: p, s, k, j
    is_loaded = .false.
    do p = 1, size(contact%facets)
      is_loaded(pack(contact%facets(p)%nodes, contact%facets(p)%nodes > 0)) = .true.
    end do
    do s = 1, size(slaves)
      if (slaves(s)%slave_facet > 0) cycle
      if (any(contact%free_mask(:, s) > 0.0_DP)) is_loaded(slaves(s)%node) = .true.
    end do
    is_loaded(contact%midsides%nodes(1, :)) = .false.
    do k = 1, base%n_rows
      associate (node => (base%rows(k)%pivot + 2) / 3, movers => (base%rows(k)%unknown + 2) / 3, first => &
        contact%shared_slaves%first)
        if (.not. is_loaded(node)) cycle
        do j = 1, size(movers)
          if (movers(j) == node .or. first(movers(j) + 1) == first(movers(j))) cycle
          call carried%add(node)
          call carriers%add(movers(j))
        end do
      end associate
    end do
    call list_groups(carried%trimmed(), n_nodes, contact%carrier_first, member)
    contact%carrier = carriers%trimmed()
    contact%carrier = contact%carrier(member)
    if (size(member) > 0) contact%shared_slaves%has_reaction_chains = .true.
  end subroutine list_carriers


  !> Rebuilds the grids of the masters that have moved too far since the last build within finite sliding.
  subroutine renew_searches(contact, x)
    type(contact_type), intent(inout) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    integer :: p
    do p = 1, size(contact%facets)
      if (.not. contact%has_fixed_geometry(p)) call renew_facet_search(contact%facets(p), x, &
        SEARCH_SLACK_RATIO * contact%edge(p), contact%search(p))
    end do
  end subroutine renew_searches


  !> Coordinates and distances since which motion counts: at an evaluation of the elements all nodes without a facet are searched,
  !! at a linearised one those that may have come to their master since.
  subroutine begin_search(contact, n_slaves, x, is_linearized)
    type(contact_type), intent(inout) :: contact
    integer, intent(in) :: n_slaves
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    logical, intent(in) :: is_linearized           !< the elements are linearised: motion since their last evaluation
    integer :: p
    if (.not. allocated(contact%master_motion)) allocate (contact%master_motion(size(contact%facets)))
    contact%master_motion = 0.0_DP
    if (is_linearized .and. allocated(contact%clearance)) then
      do p = 1, size(contact%facets)
        associate (nodes => contact%facets(p)%nodes)
          if (size(nodes) > 0) contact%master_motion(p) = sqrt(maxval(sum((x(:, nodes) - contact%searched_x(:, nodes))**2, dim=1)))
        end associate
      end do
      return
    end if
    contact%searched_x = x
    contact%clearance = spread(0.0_DP, 1, n_slaves)
  end subroutine begin_search


  !> The distances of nodes without a facet from their masters, and those of open rows.
  subroutine measure_clearances(contact, slaves, x)
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates of the search [length]
    integer :: s
    do s = 1, size(slaves)
      associate (slave => slaves(s), p => slaves(s)%pair)
        if (slave%facet == 0 .and. (slave%row == 0 .or. slave%slave_facet == 0) .and. .not. contact%has_fixed_geometry(p)) &
          contact%clearance(s) = find_clearance(contact%facets(p), contact%search(p), x, x(:, slave%node), contact%reach(p), &
          slave%node)
        if (slave%facet > 0 .and. slave%row > 0 .and. slave%slave_facet == 0 .and. slave%status == STATUS_OPEN .and. &
          .not. is_compliant(contact%laws(p))) contact%clearance(s) = max(slave%gap, 0.0_DP) * &
          dot_product(slave%normal, contact%mortar(p)%cuts%master_planes(slave%facet)%normal)
      end associate
    end do
  end subroutine measure_clearances


  !> The slaves with rows that stay open at linearised elements: they and their masters have moved by less than half their gap since
  !! it was measured. Half, because a gap between inclined faces changes by more than their motion; a row that closes all the same
  !! does so at the next evaluation of the elements.
  pure function find_slaves_apart(contact, slaves, x) result(is_apart)
    type(contact_type), intent(in) :: contact      !< after `begin_search`
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    logical :: is_apart(size(slaves))
    integer :: s
    do s = 1, size(slaves)
      associate (slave => slaves(s))
        is_apart(s) = slave%row > 0 .and. slave%status == STATUS_OPEN
        if (is_apart(s)) is_apart(s) = 0.5_DP * contact%clearance(s) > contact%master_motion(slave%pair) &
          + norm2(x(:, slave%node) - contact%searched_x(:, slave%node))
      end associate
    end do
  end function find_slaves_apart


  !> Searches a facet for a node without one, because an earlier iterate left the master or the node was far away: otherwise it
  !! could penetrate the master undetected.
  subroutine search_lost_slave(contact, x, s, slave)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    integer, intent(in) :: s
    type(slave_state_type), intent(inout) :: slave
    if (contact%has_fixed_geometry(slave%pair) .or. contact%is_removed(slave%pair)) return
    if (slave%overrides%edge == NODE_OVERRIDE_OFF_MASTER .or. gives_way(slave%overrides)) return
    if (contact%clearance(s) > contact%master_motion(slave%pair) + norm2(x(:, slave%node) - contact%searched_x(:, slave%node))) &
      return
    call update_projection(contact, x, s, contact%reach(slave%pair), slave)
  end subroutine search_lost_slave


  !> Searches the facet of a node. An open node may be nearer to another facet now; a closed one is tracked from its own.
  subroutine update_projection(contact, x, s, reach, slave)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates that define weights and normals
    integer, intent(in) :: s
    real(DP), intent(in) :: reach                  !< [length]
    type(slave_state_type), intent(inout) :: slave
    type(projection_type) :: projection
    integer :: status
    if (slave%row > 0) then
      call copy_mortar_state(contact, slave)
      call update_gap(contact, x, slave)
      if (slave%facet == 0) call detach_slave(slave)
      return
    end if
    if (slave%status /= STATUS_OPEN .and. slave%facet > 0) then
      call track_projection(contact%facets(slave%pair), x, x(:, slave%node), slave%facet, slave%xi, slave%gap, &
        slave%normal, status, edge_extension(slave%overrides, contact%controls%edge_extension))
    else
      call find_slave_projection(contact, x, s, reach, slave, projection)
      status = projection%status
      slave%facet = projection%facet
      slave%xi = projection%xi
      slave%gap = projection%gap
      slave%normal = projection%normal
    end if
    slave%gap = slave%gap + slave%offset
    if (is_unseen(contact%facets(slave%pair), slave%node, slave%facet)) status = PROJECTION_OUTSIDE
    if (status == PROJECTION_INSIDE .and. contact%has_fixed_geometry(slave%pair)) then
      if (is_beside_body(contact%facets(slave%pair), x, slave, contact%slave_normal(:, s))) status = PROJECTION_OUTSIDE
    end if
    if (status /= PROJECTION_INSIDE) call detach_slave(slave)
  end subroutine update_projection


  !> Whether a node lies beyond a ridge of its facet whose other side does not face the slave: it passes beside the body. Small
  !! displacements do not bring it over the facet. Where the other side faces the slave too, as at the edge of a wedge that is
  !! pressed into it, the facet holds the node.
  pure logical function is_beside_body(facets, x, slave, slave_normal) result(is_beside)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates that define weights and normals [length]
    type(slave_state_type), intent(in) :: slave    !< with a facet
    real(DP), intent(in) :: slave_normal(3)        !< outward; 0: unknown [-]
    real(DP) :: excess(4)
    integer :: k, n, nodes(MAX_FACE_NODES)
    is_beside = .false.
    if (allocated(facets%profile) .or. norm2(slave_normal) < 0.5_DP) return
    excess = find_edge_excess(facets%kind(slave%facet), slave%xi)
    do k = 1, 4
      if (excess(k) <= MAX_BESIDE) cycle
      if (facets%edge(k, slave%facet) /= EDGE_CONVEX) cycle
      call facet_nodes(facets, facets%neighbour(k, slave%facet), n, nodes)
      n = n_facet_corners(facets%kind(facets%neighbour(k, slave%facet)))
      is_beside = is_beside .or. dot_product(plane_normal(x(:, nodes(:n)), n == 2), slave_normal) > -MIN_RIDGE_COSINE
    end do
  end function is_beside_body


  !> Searches the facet of a node. In self contact it sees those that oppose its current normal.
  subroutine find_slave_projection(contact, x, s, reach, slave, projection)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates that define weights and normals [length]
    integer, intent(in) :: s
    real(DP), intent(in) :: reach                  !< [length]
    type(slave_state_type), intent(in) :: slave
    type(projection_type), intent(out) :: projection
    associate (facets => contact%facets(slave%pair), search => contact%search(slave%pair), position => x(:, slave%node))
      if (allocated(facets%unseen)) then
        call find_projection(facets, search, x, position, reach, projection, current_node_normal(facets, x, slave%node), slave%node)
      else
        call find_projection(facets, search, x, position, reach, projection, contact%slave_normal(:, s))
      end if
    end associate
  end subroutine find_slave_projection


  !> Copies facet, normal and area of a slave node of a mortar pair from its integrated row.
  subroutine copy_mortar_state(contact, slave)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(inout) :: slave
    associate (mortar_node => contact%mortar(slave%pair)%places(slave%row))
      slave%facet = merge(0, mortar_node%facet, mortar_node%is_barely_covered)
      slave%xi = mortar_node%xi
      if (slave%facet == 0) return
      slave%normal = mortar_node%normal
      slave%area = mortar_node%area
      slave%force_arm = mortar_node%force_arm
    end associate
  end subroutine copy_mortar_state


  !> Sets the stick origin of a node to a point of a facet.
  subroutine set_stick_origin(contact, model, u, facet, xi, slave, u_old, fraction)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)
    integer, intent(in) :: facet
    real(DP), intent(in) :: xi(2)
    type(slave_state_type), intent(inout) :: slave
    real(DP), intent(in), optional :: u_old(:, :)  !< (3, n_nodes) with `fraction` [length]: the origin is at
    real(DP), intent(in), optional :: fraction     !< u_old + fraction (u - u_old), for a row that does not change [-]
    real(DP) :: d(3)
    slave%origin_facet = facet
    slave%origin_xi = xi
    slave%origin_offset = 0.0_DP
    if (slave%row > 0) then
      contact%mortar(slave%pair)%origin_rows(slave%row) = contact%mortar(slave%pair)%rows(slave%row)
      contact%mortar(slave%pair)%origin_normal(:, slave%row) = slave%normal
    end if
    if (contact%has_fixed_geometry(slave%pair) .or. slave%row > 0) then
      d = contact_slip_vector(contact, model, u, slave)
      if (present(fraction)) d = (1.0_DP - fraction) * contact_slip_vector(contact, model, u_old, slave) + fraction * d
      slave%origin_offset = d - dot_product(slave%normal, d) * slave%normal
    end if
    slave%origin_offset = slave%origin_offset - slave%offset * slave%normal
  end subroutine set_stick_origin


  !> The part of d at the origin that remains constant. Under finite sliding it rotates with the normal. For nodes on facets it is
  !! the gap from interference and clearance along the current normal, as in the gap itself.
  pure function rotated_origin_offset(contact, slave) result(offset)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    real(DP) :: offset(3)
    offset = slave%origin_offset
    if (contact%has_fixed_geometry(slave%pair)) return
    if (slave%row == 0) then
      offset = -slave%offset * slave%normal
      return
    end if
    offset = rotate_with_normal(offset, contact%mortar(slave%pair)%origin_normal(:, slave%row), slave%normal)
  end function rotated_origin_offset


  !> Its derivative with respect to the normal.
  pure function origin_offset_derivative(contact, slave) result(rate)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    real(DP) :: rate(3, 3)                         !< [length]
    rate = 0.0_DP
    if (contact%has_fixed_geometry(slave%pair)) return
    if (slave%row == 0) then
      rate = -slave%offset * IDENTITY
      return
    end if
    rate = differentiate_rotation(slave%origin_offset, contact%mortar(slave%pair)%origin_normal(:, slave%row), slave%normal)
  end function origin_offset_derivative


  !> d = x_s - x_m(origin) - offset: displacement of the node from its stick origin, normal part included [length].
  pure function contact_slip_vector(contact, model, u, slave) result(d)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) displacement [length]
    type(slave_state_type), intent(in) :: slave          !< with an origin
    real(DP) :: d(3)
    type(contact_row_type) :: row
    integer :: i
    call origin_row(contact, slave, row)
    d = -rotated_origin_offset(contact, slave)
    do i = 1, size(row%nodes)
      d = d + row%weights(i) * (model%mesh%coordinates(:, row%nodes(i)) + u(:, row%nodes(i)))
    end do
  end function contact_slip_vector


  !> The current row of a slave node.
  pure subroutine current_row(contact, slave, row)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave          !< with a facet
    type(contact_row_type), intent(inout) :: row
    if (slave%row > 0) then
      row = contact%mortar(slave%pair)%rows(slave%row)
    else
      call fill_facet_row(contact%facets(slave%pair), slave%facet, slave%xi, slave%node, row)
    end if
  end subroutine current_row


  !> The row of a slave node with respect to its origin, which defines slip and stick.
  pure subroutine origin_row(contact, slave, row)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave          !< with an origin
    type(contact_row_type), intent(inout) :: row
    if (slave%row > 0) then
      row = contact%mortar(slave%pair)%origin_rows(slave%row)
    else
      call fill_facet_row(contact%facets(slave%pair), slave%origin_facet, slave%origin_xi, slave%node, row)
    end if
  end subroutine origin_row


  !> Finite sliding of a mortar pair: current position and row; a sticking node keeps the row of its origin.
  subroutine update_mortar_slave(contact, slave)
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(inout) :: slave
    if (contact%is_removed(slave%pair)) return
    call copy_mortar_state(contact, slave)
    if (is_stuck_to_mortar_row(contact, slave)) contact%mortar(slave%pair)%rows(slave%row) &
      = contact%mortar(slave%pair)%origin_rows(slave%row)
  end subroutine update_mortar_slave


  !> Whether a slave node of a mortar pair with finite sliding sticks to its origin: its gap is then measured from there too, where
  !! the stick constraint makes it zero.
  pure logical function is_stuck_to_mortar_row(contact, slave)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    is_stuck_to_mortar_row = slave%row > 0 .and. slave%status == STATUS_STICK .and. slave%facet > 0 .and. slave%origin_facet > 0
    is_stuck_to_mortar_row = is_stuck_to_mortar_row .and. .not. contact%has_fixed_geometry(slave%pair) &
      .and. .not. is_compliant(contact%laws(slave%pair))
  end function is_stuck_to_mortar_row


  !> Current facet, natural coordinates, gap and normal of a slave node.
  subroutine update_gap(contact, x, slave)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    type(slave_state_type), intent(inout) :: slave
    type(contact_row_type) :: row
    integer :: status
    if (slave%facet == 0) return
    if (contact%has_fixed_geometry(slave%pair) .or. slave%row > 0) then
      call current_row(contact, slave, row)
      slave%gap = slave%offset + dot_product(slave%normal, evaluate_relative_position(row, x))
      if (is_stuck_to_mortar_row(contact, slave)) slave%gap = dot_product(slave%normal, evaluate_relative_position(row, x) &
        - rotated_origin_offset(contact, slave))
    else
      call track_projection(contact%facets(slave%pair), x, x(:, slave%node), slave%facet, slave%xi, slave%gap, &
        slave%normal, status, edge_extension(slave%overrides, contact%controls%edge_extension))
      slave%gap = slave%gap + slave%offset
      if (is_unseen(contact%facets(slave%pair), slave%node, slave%facet)) status = PROJECTION_OUTSIDE
      if (status /= PROJECTION_INSIDE) slave%facet = 0
    end if
  end subroutine update_gap

end module amontons_contact_pairs
