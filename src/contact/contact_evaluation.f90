!> Contact evaluation: trial traction, status (open, stick, slip) and contact force of every slave node at a configuration.
!! SPDX-License-Identifier: GPL-3.0-or-later
!! Theory: doc/theory/contact.md. Under exact contact the force on a slave node is minus its imbalance, as far as the contact laws
!! admit it (`evaluate_hard_node`); under a compliant law it is the law's (`evaluate_compliant_node`). The masters get the opposite
!! force with the weights of the row.
module amontons_contact_evaluation
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_surfaces, only: interaction_type, is_compliant, BEHAVIOR_TIED, BEHAVIOR_USER, ROUGH_FRICTION, NO_SHEAR_LIMIT
  use amontons_slave_node_overrides, only: note_pull_off, is_friction_suppressed, is_status_imposed, gives_way, &
    NODE_OVERRIDE_STICK_ONCE
  use amontons_slave_nodes, only: detach_slave, is_rough, set_force
  use amontons_user_contact, only: call_user_interaction, call_user_friction
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_row_imbalance, distribute_row_force
  use amontons_sparse, only: multiply
  use amontons_shared_slave_nodes, only: free_projector, support_free_projector, is_friction_in_other_pair, MIN_FREE_PART
  use amontons_facets, only: is_line_facet
  use amontons_friction_slip_scenarios, only: trial_traction_type, evaluate_trial_traction, slip_state_type, friction_limit, &
    NO_FRICTION_LIMIT, CONTACT_OPEN, CONTACT_CLOSED, CONTACT_KEPT
  use amontons_pressure_overclosure, only: find_activation_gap, find_shear_limit
  use amontons_slave_node_equilibrium, only: local_problem_type, local_solution_type, solve_local_problem
  use amontons_mortar_seams, only: update_mortar_rows
  use amontons_contact_pairs, only: contact_type, search_lost_slave, update_mortar_slave, update_gap, &
    is_stuck_to_mortar_row, current_row, origin_row, contact_slip_vector, begin_search, find_slaves_apart, &
    measure_clearances
  use amontons_first_touch, only: set_first_touch_origin
  implicit none
  private
  public :: evaluate_contact, has_other_constraints

  real(DP), parameter :: TOL_CLOSING = 1.0e-10_DP  !< an open node closes at a penetration larger than this times the facet's edge
                                                   !! [-]
  real(DP), parameter :: TOL_OPENING = 1.0e-12_DP  !< a closed node opens at a tension displacement larger than this times the edge
                                                   !! [-]
  real(DP), parameter :: TOL_SLIP_ROUNDING = 1.0e-11_DP        !< a slip below this times the edge is at rounding level [-]
  real(DP), parameter :: SLIP_ZERO = 1.0e-12_DP    !< for the slip scenarios a slip up to this times the edge is zero [-]
  real(DP), parameter :: TOL_SUPPORT_SLIDING = 1.0e-9_DP  !< a larger displacement imposed by supports, over the edge, is sliding
                                                          !! [-]

contains

  !> Positions, statuses and contact forces of all slave nodes at a configuration.
  !!
  !! Before: `imbalance` is Rhat = F_ext - F_int, condensed onto the free unknowns (0 at supports). After: slaves, contact_force,
  !! and in `contact` the data of the slip scenarios and the counts of changes.
  subroutine evaluate_contact(contact, model, old, imbalance, is_frozen, fields, is_linearized)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: old           !< committed: start of the increment
    real(DP), intent(in) :: imbalance(:, :)        !< (3, n_nodes) [force]
    logical, intent(in) :: is_frozen               !< .true.: keep every status
    type(fields_type), intent(inout) :: fields
    logical, intent(in) :: is_linearized           !< of the elements: imbalance is linearised at their last evaluation
    real(DP), allocatable :: x(:, :), total(:, :)
    logical, allocatable :: is_apart(:)            ! (n_slaves) stays open; not allocated: all are evaluated
    integer :: level, s
    fields%contact_force = 0.0_DP
    contact%law_linearization_force = 0.0_DP
    contact%n_newly_opened = 0
    contact%n_closed = 0
    contact%n_changed = 0
    contact%n_lost_master = 0
    contact%n_imposed = 0
    contact%max_gap_error = 0.0_DP
    contact%worst_slave = 0
    if (size(fields%slaves) == 0) return
    contact%memory = old%user_memory
    allocate (x, source=model%mesh%coordinates + fields%u)
    call begin_search(contact, size(fields%slaves), x, is_linearized)
    if (is_linearized) is_apart = find_slaves_apart(contact, fields%slaves, x)
    if (any(model%pairs%is_mortar) .and. .not. allocated(contact%held_friction)) call update_mortar_rows(contact, old%slaves, &
      model%pairs%is_mortar .and. .not. contact%has_fixed_geometry, &
      .false., x, is_apart)
    allocate (total, source=imbalance)
    do level = 1, contact%shared_slaves%n_levels
      do s = 1, size(fields%slaves)
        if (contact%shared_slaves%level(s) == level) contact%Rhat(:, s) = row_imbalance(contact, fields%slaves(s), total)
      end do
      do s = 1, size(fields%slaves)
        if (contact%shared_slaves%level(s) /= level) cycle
        call evaluate_slave(contact, model, old%slaves(s), old%u, x, is_frozen .or. &
          is_status_imposed(fields%slaves(s)%overrides), s, fields)
      end do
      do s = 1, size(fields%slaves)
        if (contact%shared_slaves%level(s) == level) call add_contact_force(contact, s, fields%slaves(s), fields%contact_force)
      end do
      if (level < contact%shared_slaves%n_levels) call add_known_reactions(contact, fields%contact_force, imbalance, total)
    end do
    if (.not. is_linearized) call measure_clearances(contact, fields%slaves, x)
  end subroutine evaluate_contact


  !> The imbalance that the contact force of a slave node balances: for a sticking node that of its origin's row.
  pure function row_imbalance(contact, slave, imbalance) result(own)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: imbalance(:, :)        !< (3, n_nodes) Rhat, condensed [force]
    real(DP) :: own(3)
    if (is_stuck_to_mortar_row(contact, slave)) then
      own = evaluate_row_imbalance(contact%mortar(slave%pair)%origin_rows(slave%row), imbalance)
    else if (slave%row > 0) then
      own = evaluate_row_imbalance(contact%mortar(slave%pair)%rows(slave%row), imbalance)
    else
      own = imbalance(:, slave%node)
    end if
  end function row_imbalance


  !> The imbalance with the contact forces known so far, condensed onto the free unknowns.
  subroutine add_known_reactions(contact, contact_force, imbalance, total)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: contact_force(:, :)    !< (3, n_nodes) [force]
    real(DP), intent(in) :: imbalance(:, :)        !< (3, n_nodes) Rhat [force]
    real(DP), intent(out) :: total(:, :)           !< (3, n_nodes) [force]
    real(DP) :: condensed(size(total))
    call multiply(contact%force_condensation, reshape(contact_force, shape(condensed)), condensed)
    total = imbalance + reshape(condensed, shape(total))
  end subroutine add_known_reactions


  !> Evaluates one slave node: its projection, then its contact law.
  subroutine evaluate_slave(contact, model, old, u_old, x, is_frozen, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: old
    real(DP), intent(in) :: u_old(:, :)            !< (3, n_nodes) committed displacements [length]
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    logical, intent(in) :: is_frozen               !< it keeps its status
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    integer :: status_before
    associate (slave => fields%slaves(s))
      status_before = slave%status
      if (slave%row > 0 .and. .not. contact%has_fixed_geometry(slave%pair) .and. .not. gives_way(slave%overrides)) &
        call update_mortar_slave(contact, slave)
      if (slave%facet == 0 .and. slave%row == 0) call search_lost_slave(contact, x, s, slave)
      call update_gap(contact, x, slave)
      if (slave%facet > 0 .and. is_compliant(contact%laws(slave%pair))) then
        call evaluate_compliant_node(contact, model, old, u_old, contact%Rhat(:, s), s, fields)
      else
        call evaluate_hard_node(contact, model, old, u_old, is_frozen, status_before, s, fields)
      end if
    end associate
  end subroutine evaluate_slave


  !> A slave node of exact contact: its status by the trial traction in the directions that supports and other pairs leave free, its
  !! force from its imbalance. Theory: doc/theory/contact.md, section 3.
  subroutine evaluate_hard_node(contact, model, old, u_old, is_frozen, status_before, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: old
    real(DP), intent(in) :: u_old(:, :)            !< (3, n_nodes) committed displacements [length]
    logical, intent(in) :: is_frozen               !< it keeps its status
    integer, intent(in) :: status_before                  !< status before
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    type(trial_traction_type) :: trial
    real(DP) :: free(3, 3), free_normal(3), free_share, mu, shear_limit_force, Rhat(3), d(3)
    associate (slave => fields%slaves(s), law => contact%laws(fields%slaves(s)%pair))
      free = free_projector(contact%shared_slaves, fields%slaves, s, support_free_projector(contact%axes(:, :, s), &
        contact%free_mask(:, s)))
      contact%free(:, :, s) = free
      contact%friction(s) = law%friction
      Rhat = matmul(free, contact%Rhat(:, s))
      free_normal = matmul(free, slave%normal)
      free_share = norm2(free_normal)
      if (slave%facet == 0 .or. free_share < MIN_FREE_PART) then
        call release_slave(contact, status_before, s, slave)
        return
      end if
      free_normal = free_normal / free_share
      d = 0.0_DP
      if (slave%origin_facet > 0) d = contact_slip_vector(contact, model, fields%u, slave)
      if (has_no_friction(contact, fields%slaves, s, free, d)) contact%friction(s) = 0.0_DP
      mu = contact%friction(s) / free_share
      shear_limit_force = law%shear_limit * slave%area
      contact%has_sliding_support(s) = has_sliding_support(free, d, contact%edge(slave%pair))
      d = matmul(free, d)
      call evaluate_status()
      if (slave%status /= STATUS_OPEN .and. slave%origin_facet == 0) then
        call set_first_touch_origin(contact, model, u_old, fields%u, slave)
        d = matmul(free, contact_slip_vector(contact, model, fields%u, slave))   ! slip from first touch decides on stick or slip
        call evaluate_status()
      end if
      if (status_before /= STATUS_OPEN .and. slave%status == STATUS_OPEN .and. (is_rough(law) .or. &
        has_other_constraints(contact, s))) call note_pull_off(slave%overrides)
      contact%direction(:, s) = trial%direction
      slave%slip_increment = merge(0.0_DP, d - dot_product(free_normal, d) * free_normal, slave%status == STATUS_OPEN)
      call set_forces(-dot_product(free_normal, Rhat))
      if (allocated(contact%held_normal_force)) call set_augmented_force(contact, s, free_share, slave)
      if (has_other_constraints(contact, s)) d = slave%slip_increment + slave%gap * free_normal
      call count_changes(contact, status_before, s, slave, norm2(d))
    end associate

  contains

    !> Trial traction and status. Hysteresis prevents open/close oscillation of a node at zero gap; a closed node without force
    !! stays closed, since otherwise rounding would decide.
    subroutine evaluate_status()
      real(DP) :: gap, limit(2)
      limit = deciding_limit(contact, s, status_before, mu, shear_limit_force)
      associate (slave => fields%slaves(s))
        gap = slave%gap + merge(TOL_CLOSING, -TOL_OPENING, status_before == STATUS_OPEN) * contact%edge(slave%pair)
        call evaluate_trial_traction(Rhat, gap, d, free_normal, limit(1), slave%stiffness, merge(CONTACT_KEPT, &
          merge(CONTACT_OPEN, CONTACT_CLOSED, status_before == STATUS_OPEN), slave%is_bilateral), limit(2), trial)
        slave%status = merge(status_before, trial%status, is_frozen)
        if (has_no_direction(contact, old, slave) .and. trial%status == STATUS_STICK) slave%status = STATUS_STICK
        if (slave%overrides%status == NODE_OVERRIDE_STICK_ONCE .and. trial%status /= STATUS_STICK) &
          contact%n_imposed = contact%n_imposed + 1
      end associate
    end subroutine evaluate_status

    !> Normal force and friction by the status; by the user routine if the pair has one.
    subroutine set_forces(N)
      real(DP), intent(in) :: N                    !< normal force required by the imbalance [force]
      integer :: status
      logical :: is_user
      associate (slave => fields%slaves(s))
        status = slave%status
        is_user = contact%laws(slave%pair)%is_user_friction .and. .not. is_friction_held(contact, status)
        if (is_user .and. status /= STATUS_OPEN) then
          call apply_fric_hard(contact, model, status_before, Rhat / slave%area, d, s, fields)
          if (is_frozen) slave%status = status
        end if
        if (is_user .and. slave%status == STATUS_SLIP) then
          slave%force = N / free_share * slave%normal
        else
          call set_force(slave, Rhat, N / free_share, slip_friction(contact, slave, s, &
            friction_limit(mu, N, shear_limit_force, slave%is_bilateral) * trial%direction))
        end if
        if (slave%status == STATUS_STICK .and. has_other_constraints(contact, s)) slave%shear = -Rhat - N * free_normal
        contact%slip_data(s) = slip_state_type(slave%status, N, Rhat + N * free_normal, limit_of(contact, slave, s, &
          N / free_share), slave%slip_increment, SLIP_ZERO * contact%edge(slave%pair), slave%is_bilateral)
      end associate
    end subroutine set_forces

  end subroutine evaluate_hard_node


  !> Whether a slipping node bore no friction at the start of the increment (in tension, or without a coefficient): where it has
  !! some now, it has no direction of slip to keep while statuses are frozen.
  pure logical function has_no_direction(contact, old, slave)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: old      !< committed
    type(slave_state_type), intent(in) :: slave
    has_no_direction = slave%status == STATUS_SLIP .and. old%status == STATUS_SLIP .and. .not. (norm2(old%shear) > 0.0_DP .or. &
      is_status_imposed(slave%overrides) .or. allocated(contact%held_friction) .or. contact%laws(slave%pair)%is_user_friction)
  end function has_no_direction


  !> Augmented Lagrangian: the force at the start of the round and the spring c, shortened to what the laws admit under a constant
  !! friction limit, whatever the status.
  pure subroutine set_augmented_force(contact, s, free_share, slave)
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: s                       !< index of the slave
    real(DP), intent(in) :: free_share             !< length of the free part of its normal [-]
    type(slave_state_type), intent(inout) :: slave
    real(DP) :: N                                  ! [force]
    N = contact%held_normal_force(s) - slave%stiffness * slave%gap
    if (.not. slave%is_bilateral) N = max(N, 0.0_DP)
    slave%force = N / free_share * slave%normal
    slave%shear = held_friction(contact, slave, s)
  end subroutine set_augmented_force


  !> The friction of a round, P_L (f - c g): with the limit L and the friction f of its start constant, it is the gradient of a
  !! convex function of the slip g, so that conjugate gradients can turn it. Without slip it is f.
  pure function held_friction(contact, slave, s) result(friction)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s                       !< its index
    real(DP) :: friction(3)
    friction = shorten(contact%held_friction(:, s) - slave%stiffness * slave%slip_increment, contact%held_limit(s))
  end function held_friction


  !> A friction force, shortened to its limit.
  pure function shorten(friction, limit) result(admissible)
    real(DP), intent(in) :: friction(3)            !< [force]
    real(DP), intent(in) :: limit                  !< [force]
    real(DP) :: admissible(3)
    admissible = friction
    if (norm2(friction) > limit) admissible = limit / norm2(friction) * friction
  end function shorten


  !> Whether the friction of a node is held constant: it slips while contact is held.
  pure logical function is_friction_held(contact, status)
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: status
    is_friction_held = allocated(contact%held_friction) .and. status == STATUS_SLIP
  end function is_friction_held


  !> The friction of a slipping node: that of its normal force, or that of the round.
  pure function slip_friction(contact, slave, s, coulomb) result(friction)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s                       !< its index
    real(DP), intent(in) :: coulomb(3)             !< friction of the normal force [force]
    real(DP) :: friction(3)
    friction = coulomb
    if (is_friction_held(contact, slave%status)) friction = held_friction(contact, slave, s)
  end function slip_friction


  !> Coefficient and cap of the friction limit that decides the status of a node: its own, or the limit under which it slipped while
  !! contact was held.
  pure function deciding_limit(contact, s, status_before, mu, limit_cap) result(limit)
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: s, status_before
    real(DP), intent(in) :: mu                     !< [-]
    real(DP), intent(in) :: limit_cap              !< [force]
    real(DP) :: limit(2)
    limit = [mu, limit_cap]
    if (.not. allocated(contact%held_limit) .or. status_before /= STATUS_SLIP .or. mu <= 0.0_DP) return
    limit = [NO_FRICTION_LIMIT, contact%held_limit(s)]
  end function deciding_limit


  !> A slave node without a facet, or whose normal is fixed by supports, is open.
  subroutine release_slave(contact, status_before, s, slave)
    type(contact_type), intent(inout) :: contact
    integer, intent(in) :: status_before                  !< status before
    integer, intent(in) :: s                       !< index of the slave
    type(slave_state_type), intent(inout) :: slave
    if (status_before /= STATUS_OPEN) contact%n_lost_master = contact%n_lost_master + 1
    call detach_slave(slave)
    slave%slip_increment = 0.0_DP
    contact%slip_data(s) = slip_state_type()
  end subroutine release_slave


  !> The friction limit of a closed node for the slip scenarios: from its coefficient, TAUMAX or the user routine.
  !!
  !! Exact contact: the coefficient of the node, 0 if its friction is suppressed, with the force along its full normal. Compliant
  !! law: that of the law. FRIC: the shear force that it returned. Nodes that FRIC holds and nodes of ROUGH and TIED laws have no
  !! limit.
  pure real(DP) function limit_of(contact, slave, s, N) result(limit)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave          !< evaluated
    integer, intent(in) :: s                       !< index of the slave
    real(DP), intent(in) :: N                      !< normal force that the imbalance requires [force]
    logical :: is_unlimited
    associate (law => contact%laws(slave%pair))
      if (is_friction_held(contact, slave%status)) then
        limit = contact%held_limit(s)
        return
      end if
      if (law%is_user_friction) then
        limit = merge(NO_FRICTION_LIMIT, norm2(slave%shear), contact%user_responses(s)%is_stuck)
        return
      end if
      if (is_compliant(law)) then
        is_unlimited = law%friction >= ROUGH_FRICTION .or. law%behavior == BEHAVIOR_TIED
        limit = find_shear_limit(law, slave%area, N / slave%area, slave%is_bilateral)
      else
        is_unlimited = contact%friction(s) >= ROUGH_FRICTION
        limit = friction_limit(contact%friction(s), max(N, 0.0_DP), law%shear_limit * slave%area, slave%is_bilateral)
      end if
      if (is_unlimited .and. law%shear_limit >= NO_SHEAR_LIMIT) limit = NO_FRICTION_LIMIT
    end associate
  end function limit_of


  !> Whether a node has no friction whatever its law: it acts in another pair of the node, supports alone move the node along its
  !! master, or the friction of a ROUGH law is suppressed.
  pure logical function has_no_friction(contact, slaves, s, free, d)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)   !< (n_slaves)
    integer, intent(in) :: s                       !< index of the slave
    real(DP), intent(in) :: free(3, 3)             !< its free directions
    real(DP), intent(in) :: d(3)                   !< x_s - x_m(origin) [length]
    associate (slave => slaves(s))
      has_no_friction = is_friction_in_other_pair(contact%shared_slaves, slaves, s, free, contact%laws%friction, contact%Rhat, &
        contact%controls%min_force_ratio) .or. &
        is_prescribed_tangentially(free, d - dot_product(slave%normal, d) * slave%normal, contact%edge(slave%pair)) .or. &
        (is_rough(contact%laws(slave%pair)) .and. is_friction_suppressed(slave%overrides))
    end associate
  end function has_no_friction


  !> Whether supports alone move a slave along its master: none of its tangential directions is free. The supports carry the
  !! friction there, and the node must not stick to its first-touch point.
  pure logical function is_prescribed_tangentially(free, d, edge)
    real(DP), intent(in) :: free(3, 3)             !< its free directions
    real(DP), intent(in) :: d(3)                   !< x_s - x_m(origin) along the master [length]
    real(DP), intent(in) :: edge                   !< of the master [length]
    is_prescribed_tangentially = free(1, 1) + free(2, 2) + free(3, 3) < 1.5_DP .and. norm2(d) > TOL_SUPPORT_SLIDING * edge
  end function is_prescribed_tangentially


  !> FRIC at a slave node of exact contact: LM = 1 sticks, otherwise the node slips with the shear that FRIC returns.
  subroutine apply_fric_hard(contact, model, status_before, required_traction, d, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    integer, intent(in) :: status_before                  !< status before
    real(DP), intent(in) :: required_traction(3)  !< imbalance over the area: the traction required from contact [stress]
    real(DP), intent(in) :: d(3)                   !< slip in this increment [length]
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    associate (slave => fields%slaves(s))
      slave%status = status_before
      slave%shear = 0.0_DP
      call call_user_friction(model, contact%laws(slave%pair), is_line_facet(contact%facets(slave%pair)%kind(1)), d, &
        required_traction, contact%memory, s, &
        fields, contact%user_responses(s))
      slave%status = merge(STATUS_STICK, STATUS_SLIP, contact%user_responses(s)%is_stuck)
    end associate
  end subroutine apply_fric_hard


  !> Whether supports fix a slave in a direction in which its master slides: its gap is then not measured from its origin.
  pure logical function has_sliding_support(free, d, edge)
    real(DP), intent(in) :: free(3, 3)             !< its free directions
    real(DP), intent(in) :: d(3)                   !< x_s - x_m(origin) [length]
    real(DP), intent(in) :: edge                   !< of the master [length]
    has_sliding_support = norm2(d - matmul(free, d)) > TOL_SUPPORT_SLIDING * edge
  end function has_sliding_support


  !> Whether other constraints fix a slave in tangential directions: other pairs, or supports along which the master slides.
  pure logical function has_other_constraints(contact, s)
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: s
    has_other_constraints = contact%has_sliding_support(s) .or. &
      any(abs(contact%free(:, :, s) - support_free_projector(contact%axes(:, :, s), contact%free_mask(:, s))) > 0.0_DP)
  end function has_other_constraints


  !> A slave node under a compliant law: its force is the law's, whatever the imbalance; open outside the activation range.
  subroutine evaluate_compliant_node(contact, model, old, u_old, imbalance, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: old
    real(DP), intent(in) :: u_old(:, :)            !< (3, n_nodes) committed displacements [length]
    real(DP), intent(in) :: imbalance(3)           !< Rhat of the node [force]
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    type(local_problem_type) :: local_problem
    real(DP) :: N
    integer :: status_before
    associate (slave => fields%slaves(s), law => contact%laws(fields%slaves(s)%pair))
      status_before = slave%status
      slave%slip_increment = 0.0_DP
      if (law%behavior == BEHAVIOR_USER) then
        if (slave%origin_facet == 0) call set_first_touch_origin(contact, model, u_old, fields%u, slave)
        call call_user_interaction(model, law, is_line_facet(contact%facets(slave%pair)%kind(1)), elastic_trial_slip(contact, &
          model, old, fields%u, &
          slave), old, contact%memory, s, fields, contact%user_responses(s))
        contact%local_equilibrium(s)%slope = norm2(contact%user_responses(s)%d_force_d_gap) / max(slave%area, tiny(1.0_DP))
        if (slave%status == STATUS_OPEN .and. old%status == STATUS_OPEN) slave%origin_facet = 0
        contact%slip_data(s) = slip_state_type(status=slave%status, slip=slave%slip_increment, &
          slip_zero=SLIP_ZERO * contact%edge(slave%pair))
        call count_changes(contact, status_before, s, slave, 0.0_DP)
        return
      end if
      local_problem = build_local_problem(contact, slave, imbalance, s)
      if (slave%origin_facet > 0) local_problem%slip = elastic_trial_slip(contact, model, old, fields%u, slave)
      call solve_local_problem(law, local_problem, contact%local_equilibrium(s))
      if (.not. contact%local_equilibrium(s)%is_open .and. slave%origin_facet == 0) then
        call set_first_touch_origin(contact, model, u_old, fields%u, slave)
        local_problem%slip = elastic_trial_slip(contact, model, old, fields%u, slave)
        call solve_local_problem(law, local_problem, contact%local_equilibrium(s))
      end if
      slave%is_in_law_range = .not. contact%local_equilibrium(s)%is_open .and. (slave%is_bilateral .or. &
        slave%gap <= find_activation_gap(law, slave%area))
      call apply_local_equilibrium(contact%local_equilibrium(s), slave)
      if (allocated(contact%held_friction) .and. status_before /= STATUS_OPEN .and. slave%status /= STATUS_OPEN) then
        call set_held_shear(contact, law, local_problem%slip, s, slave)
      else if (law%is_user_friction .and. slave%status /= STATUS_OPEN) then
        call apply_fric_compliant(contact, model, status_before, &
          -contact%local_equilibrium(s)%pressure * slave%normal - slave%shear / slave%area, local_problem%slip, s, fields)
      end if
      N = -dot_product(slave%normal, imbalance)
      if (slave%status == STATUS_OPEN) then
        contact%slip_data(s) = slip_state_type(slip=slave%slip_increment, slip_zero=SLIP_ZERO * contact%edge(slave%pair))
      else
        contact%slip_data(s) = slip_state_type(slave%status, N, imbalance + N * slave%normal, limit_of(contact, slave, s, N), &
          slave%slip_increment, SLIP_ZERO * contact%edge(slave%pair), slave%is_bilateral)
      end if
      call count_changes(contact, status_before, s, slave, 0.0_DP)
    end associate
  end subroutine evaluate_compliant_node


  !> The shear of a compliant law under the friction limit at the start of the round; that of FRIC is constant.
  pure subroutine set_held_shear(contact, law, slip, s, slave)
    type(contact_type), intent(in) :: contact
    type(interaction_type), intent(in) :: law
    real(DP), intent(in) :: slip(3)                !< as if it were elastic [length]
    integer, intent(in) :: s                       !< index of the slave
    type(slave_state_type), intent(inout) :: slave
    if (law%is_user_friction) then
      slave%shear = contact%held_friction(:, s)
      return
    end if
    slave%shear = shorten(-law%stick_slope * slave%area * slip, contact%held_limit(s))
  end subroutine set_held_shear


  !> Sets up the local problem of a slave node under a compliant law, without its slip.
  pure type(local_problem_type) function build_local_problem(contact, slave, imbalance, s) result(local_problem)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: imbalance(3)           !< Rhat of the node [force]
    integer, intent(in) :: s                       !< index of the slave
    local_problem%area = slave%area
    local_problem%overclosure = -slave%gap
    local_problem%normal = slave%normal
    local_problem%is_bilateral = slave%is_bilateral
    local_problem%imbalance = imbalance
    local_problem%slip_rounding = epsilon(1.0_DP) * contact%edge(slave%pair)
    if (.not. is_row_uncoupled(contact, slave, s) .or. contact%laws(slave%pair)%is_user_friction) return
    if (all(contact%free_mask(:, s) <= 0.0_DP)) return
    local_problem%stiffness = max(slave%stiffness, 0.0_DP)
    local_problem%free = support_free_projector(contact%axes(:, :, s), contact%free_mask(:, s))
  end function build_local_problem


  !> Whether no other row gives a force to the nodes whose imbalances form that of a slave's row.
  pure logical function is_row_uncoupled(contact, slave, s)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s                       !< index of the slave
    is_row_uncoupled = contact%is_uncoupled(s)
    if (is_row_uncoupled .and. slave%row > 0) is_row_uncoupled = contact%mortar(slave%pair)%is_decoupled(slave%row)
  end function is_row_uncoupled


  !> Status, force and energy of a slave node from the solution of its local problem.
  pure subroutine apply_local_equilibrium(solution, slave)
    type(local_solution_type), intent(in) :: solution
    type(slave_state_type), intent(inout) :: slave
    slave%status = merge(STATUS_SLIP, STATUS_STICK, solution%is_slipping)
    if (solution%is_open) slave%status = STATUS_OPEN
    slave%force = solution%pressure * slave%area * slave%normal
    slave%shear = solution%shear
    slave%elastic = solution%elastic
    slave%slip_increment = solution%slip
    slave%energy = solution%energy
  end subroutine apply_local_equilibrium


  !> FRIC at a slave node of a compliant law: LM = 1 sticks with the stick slope, as the law without a friction limit.
  subroutine apply_fric_compliant(contact, model, status_before, required_traction, d, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    integer, intent(in) :: status_before                  !< status before
    real(DP), intent(in) :: required_traction(3)                !< traction required from contact [stress]
    real(DP), intent(in) :: d(3)                   !< tangential slip in this increment [length]
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    type(slave_state_type) :: stuck
    stuck = fields%slaves(s)
    call apply_fric_hard(contact, model, status_before, required_traction, d, s, fields)
    if (contact%user_responses(s)%is_stuck) then
      fields%slaves(s) = stuck
    else                                           ! neither elastic slip nor its energy
      fields%slaves(s)%elastic = 0.0_DP
      fields%slaves(s)%energy = stuck%energy + 0.5_DP * dot_product(stuck%shear, stuck%elastic)
      contact%local_equilibrium(s)%law_linearization_force = 0.0_DP
    end if
  end subroutine apply_fric_compliant


  !> Tangential displacement of a slave node under a compliant law, taken as elastic since the last commit.
  pure function elastic_trial_slip(contact, model, old, u, slave) result(d)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: old            !< committed
    real(DP), intent(in) :: u(:, :)
    type(slave_state_type), intent(in) :: slave
    real(DP) :: d(3)
    d = old%elastic + contact_slip_vector(contact, model, u, slave)
    d = d - dot_product(slave%normal, d) * slave%normal
    if (norm2(d) <= TOL_SLIP_ROUNDING * contact%edge(slave%pair)) d = 0.0_DP   ! no shear from rounding at first touch
  end function elastic_trial_slip


  !> Counts changes of status and records the largest gap error of a closed node.
  subroutine count_changes(contact, status_before, s, slave, from_origin)
    type(contact_type), intent(inout) :: contact
    integer, intent(in) :: status_before                  !< status before
    integer, intent(in) :: s
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: from_origin            !< exact contact: distance from the stick origin [length]
    real(DP) :: distance
    if (slave%status /= status_before) contact%n_changed = contact%n_changed + 1
    if (slave%status == STATUS_OPEN .and. status_before /= STATUS_OPEN) contact%n_newly_opened = contact%n_newly_opened + 1
    if (slave%status /= STATUS_OPEN .and. status_before == STATUS_OPEN) contact%n_closed = contact%n_closed + 1
    if (slave%status == STATUS_OPEN .or. is_compliant(contact%laws(slave%pair))) return
    distance = abs(slave%gap)
    if (slave%status == STATUS_STICK) distance = max(distance, from_origin)
    distance = distance / contact%edge(slave%pair)
    if (distance > contact%max_gap_error) then
      contact%max_gap_error = distance
      contact%worst_slave = s
    end if
  end subroutine count_changes


  !> Adds the force on the slave, its reaction on the nodes of the facet, and the linearization force of a compliant law.
  subroutine add_contact_force(contact, s, slave, contact_force)
    type(contact_type), intent(inout) :: contact
    integer, intent(in) :: s                       !< index of the slave
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(inout) :: contact_force(:, :)   !< (3, n_nodes) [force]
    type(contact_row_type) :: row
    logical :: is_augmented
    is_augmented = allocated(contact%held_normal_force) .and. slave%facet > 0
    if (slave%status == STATUS_OPEN .and. .not. is_augmented) return
    if (slave%status == STATUS_STICK .and. .not. is_augmented .and. .not. is_compliant(contact%laws(slave%pair))) then
      call origin_row(contact, slave, row)
    else
      call current_row(contact, slave, row)
    end if
    call distribute_row_force(row, slave%force + slave%shear, contact_force)
    if (is_compliant(contact%laws(slave%pair))) call distribute_row_force(row, &
      contact%local_equilibrium(s)%law_linearization_force, contact%law_linearization_force)
  end subroutine add_contact_force

end module amontons_contact_evaluation
