!> Contact forces: the node loop: whether each slave node touches, sticks or slips, and the force on it.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md. Where contact is exact the force on a slave node is its own imbalance with the sign turned, as far
!! as contact can give it (`hold_slave`); under a compliant law it is the law's (`press_slave`). The masters get the opposite
!! force with the weights of the row.
module amontons_contact_evaluation
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_surfaces, only: is_compliant, BEHAVIOR_TIED, BEHAVIOR_USER, ROUGH_FRICTION, NO_SHEAR_LIMIT
  use amontons_node_overrides, only: note_pull_off, is_friction_suppressed, is_status_imposed, gives_way, NODE_OVERRIDE_STICK_ONCE
  use amontons_slave_nodes, only: lose_master, never_slips, set_force
  use amontons_user_contact, only: ask_interface, ask_friction
  use amontons_state, only: fields_type, slave_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_contact_constraint_rows, only: contact_row_type, imbalance_of, spread_force
  use amontons_sparse, only: multiply
  use amontons_shared_slave_nodes, only: free_directions, left_free, is_friction_taken
  use amontons_facets, only: is_line
  use amontons_slip_scenarios, only: trial_type, trial_traction, slip_point_type, friction_limit, NO_FRICTION_LIMIT
  use amontons_pressure_overclosure, only: law_reach, shear_most
  use amontons_local_equilibrium, only: asked_type, meeting_type, meet_law
  use amontons_contact_pairs, only: contact_type, renew_rows, find_again, renew_place, locate_slave, close_slave, is_stuck, &
    touching_row, origin_row, contact_slip_vector
  implicit none
  private
  public :: evaluate_contact, elastic_trial, is_cornered

  real(DP), parameter :: GRAZE = 1.0e-10_DP       !< an open node closes when it is deeper than this times the facet's edge [-]
  real(DP), parameter :: CLING = 1.0e-12_DP       !< a closed node opens when it is pulled off by more than this times the edge [-]
  real(DP), parameter :: STILL = 1.0e-11_DP        !< a slip below this times the edge is rounding [-]
  real(DP), parameter :: SLIP_ZERO = 1.0e-12_DP    !< for the slip scenarios a slip up to this times the edge is zero [-]
  real(DP), parameter :: SUPPORTED = 1.0e-6_DP    !< a normal with a smaller free part than this is held by supports [-]
  real(DP), parameter :: LED = 1.0e-9_DP          !< a node that supports lead farther than this times the edge slides [-]

contains

  !> Positions, statuses and contact forces of all slave nodes at a configuration.
  !!
  !! Before: `imbalance` is Rhat = F_ext - F_int, condensed onto the free unknowns (0 where a support holds).
  !! After: slaves, contact_force, and in `contact` the view for the slip procedure and the counts of changes.
  subroutine evaluate_contact(contact, model, old, imbalance, is_frozen, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: old           !< committed: where the increment started
    real(DP), intent(in) :: imbalance(:, :)        !< (3, n_nodes) [force]
    logical, intent(in) :: is_frozen               !< .true.: keep every status
    type(fields_type), intent(inout) :: fields
    real(DP), allocatable :: x(:, :), total(:, :)
    integer :: level, s
    fields%contact_force = 0.0_DP
    contact%ahead = 0.0_DP
    contact%n_opened = 0
    contact%n_closed = 0
    contact%n_changed = 0
    contact%n_left = 0
    contact%n_imposed = 0
    contact%worst_gap = 0.0_DP
    contact%worst_slave = 0
    if (size(fields%slaves) == 0) return
    contact%memory = old%user_memory
    allocate (x, source=model%mesh%coordinates + fields%u)
    if (any(model%pairs%is_mortar)) call renew_rows(contact, old%slaves, model%pairs%is_mortar .and. .not. contact%is_small, &
      .false., x)
    allocate (total, source=imbalance)
    do level = 1, contact%overlaps%n_levels
      do s = 1, size(fields%slaves)
        if (contact%overlaps%level(s) == level) contact%Rhat(:, s) = row_imbalance(contact, fields%slaves(s), total)
      end do
      do s = 1, size(fields%slaves)
        if (contact%overlaps%level(s) /= level) cycle
        call evaluate_slave(contact, model, old%slaves(s), old%u, x, is_frozen .or. &
          is_status_imposed(fields%slaves(s)%overrides), s, fields)
      end do
      do s = 1, size(fields%slaves)
        if (contact%overlaps%level(s) == level) call add_contact_force(contact, s, fields%slaves(s), fields%contact_force)
      end do
      if (level < contact%overlaps%n_levels) call pass_on(contact, fields%contact_force, imbalance, total)
    end do
  end subroutine evaluate_contact


  !> The imbalance that the contact force of a slave node has to answer: by the row by which it sticks, where it sticks.
  pure function row_imbalance(contact, slave, imbalance) result(own)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: imbalance(:, :)        !< (3, n_nodes) Rhat, condensed [force]
    real(DP) :: own(3)
    if (is_stuck(contact, slave)) then
      own = imbalance_of(contact%mortar(slave%pair)%origins(slave%row), imbalance)
    else if (slave%row > 0) then
      own = imbalance_of(contact%mortar(slave%pair)%rows(slave%row), imbalance)
    else
      own = imbalance(:, slave%node)
    end if
  end function row_imbalance


  !> The imbalance with the contact forces that are known by now, condensed onto the free unknowns.
  subroutine pass_on(contact, contact_force, imbalance, total)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: contact_force(:, :)    !< (3, n_nodes) [force]
    real(DP), intent(in) :: imbalance(:, :)        !< (3, n_nodes) Rhat [force]
    real(DP), intent(out) :: total(:, :)           !< (3, n_nodes) [force]
    real(DP) :: condensed(size(total))
    call multiply(contact%passing, reshape(contact_force, shape(condensed)), condensed)
    total = imbalance + reshape(condensed, shape(total))
  end subroutine pass_on


  !> One slave node: where it is, and what its law makes of that.
  subroutine evaluate_slave(contact, model, old, u_old, x, is_frozen, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: old
    real(DP), intent(in) :: u_old(:, :)            !< (3, n_nodes) committed displacements [length]
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    logical, intent(in) :: is_frozen               !< it keeps its status
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    integer :: before
    associate (slave => fields%slaves(s))
      before = slave%status
      if (slave%row > 0 .and. .not. contact%is_small(slave%pair) .and. .not. gives_way(slave%overrides)) &
        call renew_place(contact, slave)
      if (slave%facet == 0 .and. slave%row == 0) call find_again(contact, x, s, slave)
      call locate_slave(contact, x, slave)
      if (slave%facet > 0 .and. is_compliant(contact%laws(slave%pair))) then
        call press_slave(contact, model, old, u_old, contact%Rhat(:, s), s, fields)
      else
        call hold_slave(contact, model, old, u_old, is_frozen, before, s, fields)
      end if
    end associate
  end subroutine evaluate_slave


  !> A slave node of exact contact: its status by the trial traction along what supports and other pairs leave free, its force
  !! from its imbalance. Theory: doc/theory/contact.md, section 3.
  subroutine hold_slave(contact, model, old, u_old, is_frozen, before, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: old
    real(DP), intent(in) :: u_old(:, :)            !< (3, n_nodes) committed displacements [length]
    logical, intent(in) :: is_frozen               !< it keeps its status
    integer, intent(in) :: before                  !< status before
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    type(trial_type) :: trial
    real(DP) :: free(3, 3), free_normal(3), share, mu, most, Rhat(3), d(3)
    associate (slave => fields%slaves(s), law => contact%laws(fields%slaves(s)%pair))
      free = free_directions(contact%overlaps, fields%slaves, s, left_free(contact%axes(:, :, s), contact%mask(:, s)))
      contact%free(:, :, s) = free
      contact%friction(s) = law%friction
      if (is_friction_taken(contact%overlaps, fields%slaves, s, free, contact%laws%friction, contact%Rhat)) &
        contact%friction(s) = 0.0_DP
      Rhat = matmul(free, contact%Rhat(:, s))
      free_normal = matmul(free, slave%normal)
      share = norm2(free_normal)
      if (slave%facet == 0 .or. share < SUPPORTED) then
        call release_slave(contact, old, before, s, slave)
        return
      end if
      free_normal = free_normal / share
      d = 0.0_DP
      if (slave%origin_facet > 0) d = contact_slip_vector(contact, model, fields%u, slave)
      if (is_led(free, d - dot_product(slave%normal, d) * slave%normal, contact%edge(slave%pair))) contact%friction(s) = 0.0_DP
      if (never_slips(law) .and. is_friction_suppressed(slave%overrides)) contact%friction(s) = 0.0_DP
      mu = contact%friction(s) / share
      most = law%shear_limit * slave%area
      contact%is_shifted(s) = is_shifted(free, d, contact%edge(slave%pair))
      d = matmul(free, d)
      call ask_status()
      if (slave%status /= STATUS_OPEN .and. slave%origin_facet == 0) then
        call close_slave(contact, model, u_old, fields%u, slave)
        d = matmul(free, contact_slip_vector(contact, model, fields%u, slave))   ! since first touch: stick or slip is asked again
        call ask_status()
      end if
      if (before /= STATUS_OPEN .and. slave%status == STATUS_OPEN .and. (never_slips(law) .or. is_cornered(contact, s))) &
        call note_pull_off(slave%overrides)
      if (slave%status == STATUS_OPEN .and. old%status == STATUS_OPEN) slave%origin_facet = 0
      contact%direction(:, s) = trial%direction
      slave%slip_increment = d - dot_product(free_normal, d) * free_normal
      if (slave%status == STATUS_OPEN) slave%slip_increment = 0.0_DP
      call set_forces(-dot_product(free_normal, Rhat))
      if (is_cornered(contact, s)) d = slave%slip_increment + slave%gap * free_normal
      call count_changes(contact, before, s, slave, norm2(d))
    end associate

  contains

    !> Trial traction and status. An open node that grazes its master stays open: it would only chatter. One that touches without
    !! any force stays closed: rounding would choose.
    subroutine ask_status()
      real(DP) :: gap
      associate (slave => fields%slaves(s))
        gap = slave%gap
        gap = gap + merge(GRAZE, -CLING, before == STATUS_OPEN) * contact%edge(slave%pair)
        call trial_traction(Rhat, gap, d, free_normal, mu, slave%stiffness, before /= STATUS_OPEN, most, trial)
        slave%status = merge(before, trial%status, is_frozen)
        if (slave%overrides%status == NODE_OVERRIDE_STICK_ONCE .and. trial%status /= STATUS_STICK) &
          contact%n_imposed = contact%n_imposed + 1
      end associate
    end subroutine ask_status

    !> Normal force and friction by the status; of a routine of the user where the pair has one.
    subroutine set_forces(N)
      real(DP), intent(in) :: N                    !< normal force that the imbalance asks for [force]
      integer :: status
      associate (slave => fields%slaves(s))
        status = slave%status
        if (contact%laws(slave%pair)%is_user_friction .and. status /= STATUS_OPEN) then
          call rub_by_user(contact, model, before, Rhat / slave%area, d, s, fields)
          if (is_frozen) slave%status = status
        end if
        if (contact%laws(slave%pair)%is_user_friction .and. slave%status == STATUS_SLIP) then
          slave%force = N / share * slave%normal
        else
          call set_force(slave, Rhat, N / share, friction_limit(mu, N, most) * trial%direction)
        end if
        if (slave%status == STATUS_STICK .and. is_cornered(contact, s)) slave%shear = -Rhat - N * free_normal
        contact%view(s) = slip_point_type(slave%status, N, Rhat + N * free_normal, limit_of(contact, slave, s, N / share), &
          slave%slip_increment, SLIP_ZERO * contact%edge(slave%pair))
      end associate
    end subroutine set_forces

  end subroutine hold_slave


  !> A slave node that is not over its master, or whose normal supports hold, is open.
  subroutine release_slave(contact, old, before, s, slave)
    type(contact_type), intent(inout) :: contact
    type(slave_type), intent(in) :: old
    integer, intent(in) :: before                  !< status before
    integer, intent(in) :: s                       !< index of the slave
    type(slave_type), intent(inout) :: slave
    if (before /= STATUS_OPEN) contact%n_left = contact%n_left + 1
    call lose_master(slave)
    if (old%status == STATUS_OPEN) slave%origin_facet = 0
    slave%slip_increment = 0.0_DP
    contact%view(s) = slip_point_type()
  end subroutine release_slave


  !> The friction limit of a closed node as the slip scenarios take it: by its coefficient, TAUMAX or the user's routine.
  !!
  !! Exact contact: the coefficient of the node, 0 where its friction is suppressed, with the normal force that acts along the
  !! normal itself. Compliant law: that of the law. FRIC: the shear that it gave. A node that FRIC holds, a ROUGH one and a TIED
  !! one have no limit.
  pure real(DP) function limit_of(contact, slave, s, N) result(limit)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slave          !< evaluated
    integer, intent(in) :: s                       !< index of the slave
    real(DP), intent(in) :: N                      !< normal force that the imbalance requires [force]
    logical :: is_unlimited
    associate (law => contact%laws(slave%pair))
      if (law%is_user_friction) then
        limit = merge(NO_FRICTION_LIMIT, norm2(slave%shear), contact%answers(s)%is_stuck)
        return
      end if
      if (is_compliant(law)) then
        is_unlimited = law%friction >= ROUGH_FRICTION .or. law%behavior == BEHAVIOR_TIED
        limit = shear_most(law, slave%area, N / slave%area)
      else
        is_unlimited = contact%friction(s) >= ROUGH_FRICTION
        limit = friction_limit(contact%friction(s), max(N, 0.0_DP), law%shear_limit * slave%area)
      end if
      if (is_unlimited .and. law%shear_limit >= NO_SHEAR_LIMIT) limit = NO_FRICTION_LIMIT
    end associate
  end function limit_of


  !> Whether supports alone move a slave along its master: none of its directions along the master is free. What friction is
  !! there the supports carry, and the node is not to be held where it first touched.
  pure logical function is_led(free, d, edge)
    real(DP), intent(in) :: free(3, 3)             !< its free directions
    real(DP), intent(in) :: d(3)                   !< x_s - x_m(origin) along the master [length]
    real(DP), intent(in) :: edge                   !< of the master [length]
    is_led = free(1, 1) + free(2, 2) + free(3, 3) < 1.5_DP .and. norm2(d) > LED * edge
  end function is_led


  !> FRIC at a slave node of exact contact: LM = 1 sticks, all else slips by the shear that it gives.
  subroutine rub_by_user(contact, model, before, pull, d, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    integer, intent(in) :: before                  !< status before
    real(DP), intent(in) :: pull(3)                !< imbalance over the area: what the contact has to answer [stress]
    real(DP), intent(in) :: d(3)                   !< slip in this increment [length]
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    associate (slave => fields%slaves(s))
      slave%status = before
      slave%shear = 0.0_DP
      call ask_friction(model, contact%laws(slave%pair), is_line(contact%facets(slave%pair)%kind(1)), d, pull, contact%memory, s, &
        fields, contact%answers(s))
      slave%status = merge(STATUS_STICK, STATUS_SLIP, contact%answers(s)%is_stuck)
    end associate
  end subroutine rub_by_user


  !> Whether supports hold a slave in a direction along which its master slides: its gap is not that from its origin then.
  pure logical function is_shifted(free, d, edge)
    real(DP), intent(in) :: free(3, 3)             !< its free directions
    real(DP), intent(in) :: d(3)                   !< x_s - x_m(origin) [length]
    real(DP), intent(in) :: edge                   !< of the master [length]
    is_shifted = norm2(d - matmul(free, d)) > LED * edge
  end function is_shifted


  !> Whether a slave is held in directions along the master beside contact: by other pairs, or by supports along which the master
  !! slides.
  pure logical function is_cornered(contact, s)
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: s
    is_cornered = contact%is_shifted(s) .or. &
      any(abs(contact%free(:, :, s) - left_free(contact%axes(:, :, s), contact%mask(:, s))) > 0.0_DP)
  end function is_cornered


  !> A slave node under a compliant law: its force is the law's, whatever the imbalance; open beyond the law's reach.
  subroutine press_slave(contact, model, old, u_old, imbalance, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: old
    real(DP), intent(in) :: u_old(:, :)            !< (3, n_nodes) committed displacements [length]
    real(DP), intent(in) :: imbalance(3)           !< Rhat of the node [force]
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    type(asked_type) :: asked
    real(DP) :: N
    integer :: before
    associate (slave => fields%slaves(s), law => contact%laws(fields%slaves(s)%pair))
      before = slave%status
      slave%slip_increment = 0.0_DP
      if (law%behavior == BEHAVIOR_USER) then
        if (slave%origin_facet == 0) call close_slave(contact, model, u_old, fields%u, slave)
        call ask_interface(model, law, is_line(contact%facets(slave%pair)%kind(1)), elastic_trial(contact, model, old, fields%u, &
          slave), old, contact%memory, s, fields, contact%answers(s))
        if (slave%status == STATUS_OPEN .and. old%status == STATUS_OPEN) slave%origin_facet = 0
        contact%view(s) = slip_point_type(status=slave%status, slip=slave%slip_increment, &
          slip_zero=SLIP_ZERO * contact%edge(slave%pair))
        call count_changes(contact, before, s, slave, 0.0_DP)
        return
      end if
      if (old%status == STATUS_OPEN .and. .not. slave%is_within) slave%origin_facet = 0
      asked = asked_of(contact, slave, imbalance, s)
      if (slave%origin_facet > 0) asked%slip = elastic_trial(contact, model, old, fields%u, slave)
      call meet_law(law, asked, contact%met(s))
      if (.not. contact%met(s)%is_open .and. slave%origin_facet == 0) then
        call close_slave(contact, model, u_old, fields%u, slave)
        asked%slip = elastic_trial(contact, model, old, fields%u, slave)
        call meet_law(law, asked, contact%met(s))
      end if
      slave%is_within = .not. contact%met(s)%is_open .and. slave%gap <= law_reach(law, slave%area)
      if (contact%met(s)%is_open .and. old%status == STATUS_OPEN) slave%origin_facet = 0
      call take_meeting(contact%met(s), slave)
      if (law%is_user_friction .and. slave%status /= STATUS_OPEN) call rub_softly(contact, model, before, &
        -contact%met(s)%pressure * slave%normal - slave%shear / slave%area, asked%slip, s, fields)
      N = -dot_product(slave%normal, imbalance)
      if (slave%status == STATUS_OPEN) then
        contact%view(s) = slip_point_type(slip=slave%slip_increment, slip_zero=SLIP_ZERO * contact%edge(slave%pair))
      else
        contact%view(s) = slip_point_type(slave%status, N, imbalance + N * slave%normal, limit_of(contact, slave, s, N), &
          slave%slip_increment, SLIP_ZERO * contact%edge(slave%pair))
      end if
      call count_changes(contact, before, s, slave, 0.0_DP)
    end associate
  end subroutine press_slave


  !> What a slave node under a compliant law is asked for, but for its slip.
  pure type(asked_type) function asked_of(contact, slave, imbalance, s) result(asked)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: imbalance(3)           !< Rhat of the node [force]
    integer, intent(in) :: s                       !< index of the slave
    asked%area = slave%area
    asked%overclosure = -slave%gap
    asked%normal = slave%normal
    asked%imbalance = imbalance
    if (.not. is_alone(contact, slave, s) .or. contact%laws(slave%pair)%is_user_friction) return
    if (all(contact%mask(:, s) <= 0.0_DP)) return
    asked%stiffness = max(slave%stiffness, 0.0_DP)
    asked%free = left_free(contact%axes(:, :, s), contact%mask(:, s))
  end function asked_of


  !> Whether no other row gives a force to the nodes whose imbalance is that of a slave's row.
  pure logical function is_alone(contact, slave, s)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slave
    integer, intent(in) :: s                       !< index of the slave
    is_alone = contact%is_lone(s)
    if (is_alone .and. slave%row > 0) is_alone = contact%mortar(slave%pair)%is_whole(slave%row)
  end function is_alone


  !> Status, force and energy of a slave node as its law and the bodies meet.
  pure subroutine take_meeting(met, slave)
    type(meeting_type), intent(in) :: met
    type(slave_type), intent(inout) :: slave
    slave%status = merge(STATUS_SLIP, STATUS_STICK, met%is_slipping)
    if (met%is_open) slave%status = STATUS_OPEN
    slave%force = met%pressure * slave%area * slave%normal
    slave%shear = met%shear
    slave%elastic = met%elastic
    slave%slip_increment = met%slip
    slave%energy = met%energy
  end subroutine take_meeting


  !> FRIC at a slave node of a compliant law: LM = 1 sticks by the stick slope, as the law has it without a friction limit.
  subroutine rub_softly(contact, model, before, pull, d, s, fields)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    integer, intent(in) :: before                  !< status before
    real(DP), intent(in) :: pull(3)                !< what the contact has to answer [stress]
    real(DP), intent(in) :: d(3)                   !< tangential slip in this increment [length]
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields
    type(slave_type) :: stuck
    stuck = fields%slaves(s)
    call rub_by_user(contact, model, before, pull, d, s, fields)
    if (contact%answers(s)%is_stuck) then
      fields%slaves(s) = stuck
    else                                           ! no elastic slip, nor its energy
      fields%slaves(s)%elastic = 0.0_DP
      fields%slaves(s)%energy = stuck%energy + 0.5_DP * dot_product(stuck%shear, stuck%elastic)
      contact%met(s)%ahead = 0.0_DP
    end if
  end subroutine rub_softly


  !> Tangential displacement of a slave node under a compliant law, counted as if all since the last commit were elastic.
  pure function elastic_trial(contact, model, old, u, slave) result(d)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: old            !< committed
    real(DP), intent(in) :: u(:, :)
    type(slave_type), intent(in) :: slave
    real(DP) :: d(3)
    d = old%elastic + contact_slip_vector(contact, model, u, slave)
    d = d - dot_product(slave%normal, d) * slave%normal
    if (norm2(d) <= STILL * contact%edge(slave%pair)) d = 0.0_DP   ! one that only touches has no shear to resist rounding
  end function elastic_trial


  !> Counts changes of status and keeps the worst violation of a closed node.
  subroutine count_changes(contact, before, s, slave, from_origin)
    type(contact_type), intent(inout) :: contact
    integer, intent(in) :: before                  !< status before
    integer, intent(in) :: s
    type(slave_type), intent(in) :: slave
    real(DP), intent(in) :: from_origin            !< exact contact: distance from where it sticks [length]
    real(DP) :: distance
    if (slave%status /= before) contact%n_changed = contact%n_changed + 1
    if (slave%status == STATUS_OPEN .and. before /= STATUS_OPEN) contact%n_opened = contact%n_opened + 1
    if (slave%status /= STATUS_OPEN .and. before == STATUS_OPEN) contact%n_closed = contact%n_closed + 1
    if (slave%status == STATUS_OPEN .or. is_compliant(contact%laws(slave%pair))) return
    distance = abs(slave%gap)
    if (slave%status == STATUS_STICK) distance = max(distance, from_origin)
    distance = distance / contact%edge(slave%pair)
    if (distance > contact%worst_gap) then
      contact%worst_gap = distance
      contact%worst_slave = s
    end if
  end subroutine count_changes


  !> The force on the slave and its reaction on the nodes of the facet, and what a law gives more where the slave is.
  subroutine add_contact_force(contact, s, slave, contact_force)
    type(contact_type), intent(inout) :: contact
    integer, intent(in) :: s                       !< index of the slave
    type(slave_type), intent(in) :: slave
    real(DP), intent(inout) :: contact_force(:, :)   !< (3, n_nodes) [force]
    type(contact_row_type) :: row
    if (slave%status == STATUS_OPEN) return
    if (slave%status == STATUS_STICK .and. .not. is_compliant(contact%laws(slave%pair))) then
      call origin_row(contact, slave, row)
    else
      call touching_row(contact, slave, row)
    end if
    call spread_force(row, slave%force + slave%shear, contact_force)
    if (is_compliant(contact%laws(slave%pair))) call spread_force(row, contact%met(s)%ahead, contact%ahead)
  end subroutine add_contact_force

end module amontons_contact_evaluation
