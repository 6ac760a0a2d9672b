!> Treatment of active-set cycling: freezes the status of cycling slave nodes, or extends the master's edges for them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, section [active_set_cycling]. The hash of all slave nodes (amontons_active_set_history) detects a
!! cycle; it is treated if the merit does not decrease over its length. For the nodes that change within the cycle:
!!
!! - A node that leaves its master and returns: the facet at the edge is extended by half its length for this node while it is
!!   pressed. A node that was off the master before stays off in this increment, unless it ends well within the master. (Within
!!   one contact subproblem the third time counts as a cycle.)
!! - Any other node: its status is frozen at that of the least merit until convergence. Then it is released, and its trial
!!   traction decides. No node is frozen twice in an increment.
module amontons_active_set_cycling
  use amontons_kinds, only: DP
  use amontons_controls, only: cycling_controls_type
  use amontons_surfaces, only: is_compliant
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_NONE, NODE_OVERRIDE_EXTENDED, NODE_OVERRIDE_OFF_MASTER, &
    NODE_OVERRIDE_FROZEN, NODE_OVERRIDE_RELEASED, NODE_OVERRIDE_FRICTIONLESS, NODE_OVERRIDE_RETRY
  use amontons_state, only: slave_state_type, STATUS_OPEN
  use amontons_active_set_history, only: active_set_history_type, find_cycle, cycling_slaves, find_least_merit, last_facet, &
    HISTORY_DEPTH
  use amontons_surface_projection, only: projection_type, find_edge_excess, PROJECTION_INSIDE
  use amontons_contact_pairs, only: contact_type, find_slave_projection
  implicit none
  private
  public :: break_cycle, release_frozen_nodes, extend_master_edges, facet_track_type

  !> Facets of a node during a contact subproblem.
  type :: facet_track_type
    integer :: facet = -1                          !< last facet; 0: off its master; -1: not known yet
    integer :: previous_facet = -1                         !< the one before
    integer :: n_returns = 0                         !< number of losses of the master, or of returns to a facet
  end type facet_track_type

contains

  !> Finds a cycle and treats its nodes. Out: statuses and facets for the next evaluation of contact.
  subroutine break_cycle(contact, active_set_history, controls, slaves, is_found, is_changed)
    type(contact_type), intent(in) :: contact
    type(active_set_history_type), intent(in) :: active_set_history
    type(cycling_controls_type), intent(in) :: controls
    type(slave_state_type), intent(inout) :: slaves(:)
    logical, intent(out) :: is_found               !< there is a cycle
    logical, intent(out) :: is_changed               !< a node was treated
    integer, allocatable :: nodes(:)
    integer :: length, i, best
    is_changed = .false.
    is_found = .false.
    length = find_cycle(active_set_history)
    if (length == 0 .or. length >= HISTORY_DEPTH) return
    if (.not. active_set_history%merit(1) > controls%stagnation_ratio * active_set_history%merit(1 + length)) return
    is_found = .true.
    nodes = cycling_slaves(active_set_history, length)
    best = find_least_merit(active_set_history, length)
    do i = 1, size(nodes)
      associate (slave => slaves(nodes(i)), s => nodes(i))
        if (is_leaving_master(contact, active_set_history, slave, s, length) .or. is_alternating_facets(contact, &
          active_set_history, slave, s, length)) then
          if (slave%overrides%edge == NODE_OVERRIDE_EXTENDED) cycle
          slave%overrides%edge = NODE_OVERRIDE_EXTENDED
          slave%facet = last_facet(active_set_history, s)
          is_changed = .true.
        else if (slave%overrides%status == NODE_OVERRIDE_NONE .and. .not. is_compliant(contact%laws(slave%pair))) then
          if (active_set_history%facet(s, best) == 0) cycle
          slave%overrides%status = NODE_OVERRIDE_FROZEN
          slave%status = active_set_history%status(s, best)
          if (slave%facet == 0) slave%facet = active_set_history%facet(s, best)
          is_changed = .true.
        end if
      end associate
    end do
  end subroutine break_cycle


  !> Cycling within a contact subproblem: extends the edge for nodes that left their master, or crossed an edge, repeatedly.
  !! New ones are marked in `start`.
  pure subroutine extend_master_edges(contact, controls, start, trial_slaves, facet_tracks, n_extended, is_lost)
    type(contact_type), intent(in) :: contact
    type(cycling_controls_type), intent(in) :: controls
    type(slave_state_type), intent(inout) :: start(:)    !< (n_slaves) at the start of the direction
    type(slave_state_type), intent(in) :: trial_slaves(:)         !< (n_slaves) predicted
    type(facet_track_type), intent(inout) :: facet_tracks(:)     !< (n_slaves)
    integer, intent(out) :: n_extended             !< number of new ones
    logical, intent(out) :: is_lost                !< one of the new ones left a smooth master
    logical :: is_faceted
    integer :: s
    n_extended = 0
    is_lost = .false.
    do s = 1, size(trial_slaves)
      if (start(s)%overrides%edge /= NODE_OVERRIDE_NONE .or. .not. has_master_edges(contact, trial_slaves(s))) cycle
      is_faceted = contact%facets(trial_slaves(s)%pair)%is_faceted
      call update_facet_track(trial_slaves(s)%facet, is_faceted, facet_tracks(s))
      if (facet_tracks(s)%n_returns < merge(controls%max_edge_returns, controls%max_master_losses, is_faceted)) cycle
      if (trial_slaves(s)%facet > 0 .and. .not. is_faceted) cycle
      start(s)%overrides%edge = NODE_OVERRIDE_EXTENDED
      n_extended = n_extended + 1
      is_lost = is_lost .or. .not. is_faceted
      if (trial_slaves(s)%facet > 0 .or. start(s)%status /= STATUS_OPEN) cycle
      start(s)%overrides%edge = NODE_OVERRIDE_OFF_MASTER
      start(s)%facet = 0
    end do
  end subroutine extend_master_edges


  !> Counts losses of the master; where normals jump at its edges, also returns to the facet before the last.
  pure subroutine update_facet_track(facet, is_faceted, facet_track)
    integer, intent(in) :: facet                   !< current facet; 0: off the master
    logical, intent(in) :: is_faceted              !< normals jump at the master's edges
    type(facet_track_type), intent(inout) :: facet_track
    if (facet == facet_track%facet) return
    if (facet == 0 .or. (is_faceted .and. facet == facet_track%previous_facet)) facet_track%n_returns = facet_track%n_returns + 1
    facet_track%previous_facet = facet_track%facet
    facet_track%facet = facet
  end subroutine update_facet_track


  !> Whether the edges of a node's master can be extended: the master is meshed, and the node slides freely on it.
  pure logical function has_master_edges(contact, slave)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    has_master_edges = slave%row == 0 .and. .not. contact%has_fixed_geometry(slave%pair) .and. &
      .not. allocated(contact%facets(slave%pair)%profile)
  end function has_master_edges


  !> Whether a node leaves its meshed master and returns within the last iterations.
  pure logical function is_leaving_master(contact, active_set_history, slave, s, length)
    type(contact_type), intent(in) :: contact
    type(active_set_history_type), intent(in) :: active_set_history
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s                       !< index of the slave
    integer, intent(in) :: length                  !< of the cycle
    associate (facet => active_set_history%facet(s, :length + 1), status => active_set_history%status(s, :length + 1))
      is_leaving_master = any(facet == 0) .and. any(facet > 0 .and. status /= STATUS_OPEN)
    end associate
    is_leaving_master = is_leaving_master .and. has_master_edges(contact, slave)
  end function is_leaving_master


  !> Whether a node crosses an edge of its master with a jump of the normal, and returns, within the last iterations.
  pure logical function is_alternating_facets(contact, active_set_history, slave, s, length) result(is_alternating)
    type(contact_type), intent(in) :: contact
    type(active_set_history_type), intent(in) :: active_set_history
    type(slave_state_type), intent(in) :: slave
    integer, intent(in) :: s                       !< index of the slave
    integer, intent(in) :: length                  !< of the cycle
    is_alternating = contact%facets(slave%pair)%is_faceted .and. has_master_edges(contact, slave)
    if (is_alternating) is_alternating = all(active_set_history%facet(s, :length + 1) > 0) .and. &
      any(active_set_history%facet(s, 2:length + 1) /= active_set_history%facet(s, 1))
  end function is_alternating_facets


  !> After convergence: releases frozen nodes, nodes without friction, and nodes marked as off the master that are well within it.
  subroutine release_frozen_nodes(contact, x, controls, slaves, is_released)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates now [length]
    type(cycling_controls_type), intent(in) :: controls
    type(slave_state_type), intent(inout) :: slaves(:)
    logical, intent(out) :: is_released
    type(projection_type) :: projection
    integer :: s
    is_released = any(slaves%overrides%status == NODE_OVERRIDE_FROZEN .or. &
      slaves%overrides%friction == NODE_OVERRIDE_FRICTIONLESS)
    where (slaves%overrides%status == NODE_OVERRIDE_FROZEN) slaves%overrides%status = NODE_OVERRIDE_RELEASED
    where (slaves%overrides%friction == NODE_OVERRIDE_FRICTIONLESS) slaves%overrides%friction = NODE_OVERRIDE_RETRY
    do s = 1, size(slaves)
      if (slaves(s)%overrides%edge /= NODE_OVERRIDE_OFF_MASTER) cycle
      associate (p => slaves(s)%pair)
        call find_slave_projection(contact, x, s, contact%reach(p), slaves(s), projection)
        if (projection%status /= PROJECTION_INSIDE .or. projection%gap + slaves(s)%offset >= 0.0_DP) cycle
        if (maxval(find_edge_excess(contact%facets(p)%kind(projection%facet), projection%xi)) > &
          -controls%min_depth_in_facet) cycle
      end associate
      slaves(s)%overrides%edge = NODE_OVERRIDE_NONE
      is_released = .true.
    end do
  end subroutine release_frozen_nodes

end module amontons_active_set_cycling
