!> Cycles: what is done for slave nodes whose statuses come round and round, and for those alone.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, "Cycles". A cycle is found by the hash of all slave nodes (amontons_forensics) while the
!! merit does not
!! fall over its length. Then, for the nodes that change within it:
!!
!! - one that runs off its master and is found on it again keeps to the edge that it ran over: for as long as it is pressed, that
!!   facet reaches half its length beyond itself for this node; one that was off it before stays beside it in this increment,
!!   unless it ends up well within it. (Along one direction, while contact settles, the third time counts as a cycle.)
!! - any other is held in the status that it had where the merit was least, until all else is in balance; then it is let go,
!!   and what its trial traction says then counts. No node is held twice in an increment.
module amontons_active_set_cycling
  use amontons_kinds, only: DP
  use amontons_surfaces, only: is_compliant
  use amontons_node_overrides, only: NODE_OVERRIDE_NONE, NODE_OVERRIDE_EXTENDED, NODE_OVERRIDE_OFF_MASTER, &
    NODE_OVERRIDE_FROZEN, NODE_OVERRIDE_RELEASED, NODE_OVERRIDE_FRICTIONLESS, NODE_OVERRIDE_RETRY
  use amontons_state, only: slave_type, STATUS_OPEN
  use amontons_active_set_history, only: forensics_type, find_cycle, cycle_nodes, least_merit, last_facet, DEPTH
  use amontons_surface_projection, only: projection_type, find_projection, excess_over_edges, PROJECT_ON
  use amontons_contact_pairs, only: contact_type, SEARCH_REACH
  implicit none
  private
  public :: act_on_cycle, release_nodes, keep_to_edges, walk_type

  real(DP), parameter :: STAGNANT = 0.5_DP         !< a merit that is not below this part of that one cycle before does not fall [-]
  integer, parameter :: OFTEN = 3                  !< times that a node runs off its master until it keeps to the edge
  integer, parameter :: TWICE = 2                  !< times that it comes back over an edge where the normal jumps until it stays
  real(DP), parameter :: NEAR_EDGE = 0.1_DP        !< a node deeper in a facet than this is not beside it, in its lengths [-]

  !> Where a node has been while contact settles along a direction.
  type :: walk_type
    integer :: facet = -1                          !< where it was last; 0: off its master; -1: not known yet
    integer :: before = -1                         !< and before that
    integer :: n_turns = 0                         !< how often it ran off, or came back
  end type walk_type

contains

  !> Looks for a cycle and acts on its nodes. After: the statuses and facets with which contact is to be evaluated again.
  subroutine act_on_cycle(contact, forensics, slaves, is_found, is_acted)
    type(contact_type), intent(in) :: contact
    type(forensics_type), intent(in) :: forensics
    type(slave_type), intent(inout) :: slaves(:)
    logical, intent(out) :: is_found               !< there is a cycle
    logical, intent(out) :: is_acted               !< something was done
    integer, allocatable :: nodes(:)
    integer :: length, i, best
    is_acted = .false.
    is_found = .false.
    length = find_cycle(forensics)
    if (length == 0 .or. length >= DEPTH) return
    if (.not. forensics%merit(1) > STAGNANT * forensics%merit(1 + length)) return
    is_found = .true.
    nodes = cycle_nodes(forensics, length)
    best = least_merit(forensics, length)
    do i = 1, size(nodes)
      associate (slave => slaves(nodes(i)), s => nodes(i))
        if (is_running_off(contact, forensics, slave, s, length) .or. is_changing_facets(contact, forensics, slave, s, length)) then
          if (slave%overrides%edge == NODE_OVERRIDE_EXTENDED) cycle
          slave%overrides%edge = NODE_OVERRIDE_EXTENDED
          slave%facet = last_facet(forensics, s)
          is_acted = .true.
        else if (slave%overrides%status == NODE_OVERRIDE_NONE .and. .not. is_compliant(contact%laws(slave%pair))) then
          if (forensics%facet(s, best) == 0) cycle
          slave%overrides%status = NODE_OVERRIDE_FROZEN
          slave%status = forensics%status(s, best)
          if (slave%facet == 0) slave%facet = forensics%facet(s, best)
          is_acted = .true.
        end if
      end associate
    end do
  end subroutine act_on_cycle


  !> While contact settles along a direction: nodes that ran off their master again and again, and were found on it in between,
  !! keep to its edge. After: whether there are new ones; they are marked in the slaves where the direction starts.
  pure subroutine keep_to_edges(contact, start, now, walks, is_kept)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(inout) :: start(:)    !< (n_slaves) where the direction starts
    type(slave_type), intent(in) :: now(:)         !< (n_slaves) as they were foreseen
    type(walk_type), intent(inout) :: walks(:)     !< (n_slaves)
    logical, intent(out) :: is_kept
    logical :: is_faceted
    integer :: s
    is_kept = .false.
    do s = 1, size(now)
      if (start(s)%overrides%edge /= NODE_OVERRIDE_NONE .or. .not. has_edges(contact, now(s))) cycle
      is_faceted = contact%facets(now(s)%pair)%is_faceted
      call follow_walk(now(s)%facet, is_faceted, walks(s))
      if (walks(s)%n_turns < merge(TWICE, OFTEN, is_faceted)) cycle
      if (now(s)%facet > 0 .and. .not. is_faceted) cycle
      start(s)%overrides%edge = NODE_OVERRIDE_EXTENDED
      is_kept = .true.
      if (now(s)%facet > 0 .or. start(s)%status /= STATUS_OPEN) cycle
      start(s)%overrides%edge = NODE_OVERRIDE_OFF_MASTER
      start(s)%facet = 0
    end do
  end subroutine keep_to_edges


  !> Counts how often a node runs off its master, or, where normals jump at its edges, comes back to the facet before the last.
  pure subroutine follow_walk(facet, is_faceted, walk)
    integer, intent(in) :: facet                   !< where it is now; 0: off
    logical, intent(in) :: is_faceted              !< normals jump at the master's edges
    type(walk_type), intent(inout) :: walk
    if (facet == walk%facet) return
    if (facet == 0 .or. (is_faceted .and. facet == walk%before)) walk%n_turns = walk%n_turns + 1
    walk%before = walk%facet
    walk%facet = facet
  end subroutine follow_walk


  !> Whether the master of a node has edges to keep to: it is meshed, and the node slides over it by itself.
  pure logical function has_edges(contact, slave)
    type(contact_type), intent(in) :: contact
    type(slave_type), intent(in) :: slave
    has_edges = slave%row == 0 .and. .not. contact%is_small(slave%pair) .and. &
      .not. allocated(contact%facets(slave%pair)%profile)
  end function has_edges


  !> Whether a node goes off its meshed master and comes back within the last iterations.
  pure logical function is_running_off(contact, forensics, slave, s, length)
    type(contact_type), intent(in) :: contact
    type(forensics_type), intent(in) :: forensics
    type(slave_type), intent(in) :: slave
    integer, intent(in) :: s                       !< index of the slave
    integer, intent(in) :: length                  !< of the cycle
    associate (facet => forensics%facet(s, :length + 1), status => forensics%status(s, :length + 1))
      is_running_off = any(facet == 0) .and. any(facet > 0 .and. status /= STATUS_OPEN)
    end associate
    is_running_off = is_running_off .and. has_edges(contact, slave)
  end function is_running_off


  !> Whether a node goes over an edge of its master at which the normal jumps, and comes back, within the last iterations.
  pure logical function is_changing_facets(contact, forensics, slave, s, length) result(is_changing)
    type(contact_type), intent(in) :: contact
    type(forensics_type), intent(in) :: forensics
    type(slave_type), intent(in) :: slave
    integer, intent(in) :: s                       !< index of the slave
    integer, intent(in) :: length                  !< of the cycle
    is_changing = contact%facets(slave%pair)%is_faceted .and. has_edges(contact, slave)
    if (is_changing) is_changing = all(forensics%facet(s, :length + 1) > 0) .and. &
      any(forensics%facet(s, 2:length + 1) /= forensics%facet(s, 1))
  end function is_changing_facets


  !> All else is in balance: nodes that were held are let go, and those beside their master that are well within it. After:
  !! whether there were any.
  subroutine release_nodes(contact, x, slaves, is_released)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates now [length]
    type(slave_type), intent(inout) :: slaves(:)
    logical, intent(out) :: is_released
    type(projection_type) :: here
    integer :: s
    is_released = any(slaves%overrides%status == NODE_OVERRIDE_FROZEN .or. &
      slaves%overrides%friction == NODE_OVERRIDE_FRICTIONLESS)
    where (slaves%overrides%status == NODE_OVERRIDE_FROZEN) slaves%overrides%status = NODE_OVERRIDE_RELEASED
    where (slaves%overrides%friction == NODE_OVERRIDE_FRICTIONLESS) slaves%overrides%friction = NODE_OVERRIDE_RETRY
    do s = 1, size(slaves)
      if (slaves(s)%overrides%edge /= NODE_OVERRIDE_OFF_MASTER) cycle
      associate (p => slaves(s)%pair)
        call find_projection(contact%facets(p), contact%search(p), x, x(:, slaves(s)%node), SEARCH_REACH * contact%edge(p), here, &
          contact%slave_normal(:, s))
        if (here%status /= PROJECT_ON .or. here%gap + slaves(s)%offset >= 0.0_DP) cycle
        if (maxval(excess_over_edges(contact%facets(p)%kind(here%facet), here%xi)) > -NEAR_EDGE) cycle
      end associate
      slaves(s)%overrides%edge = NODE_OVERRIDE_NONE
      is_released = .true.
    end do
  end subroutine release_nodes

end module amontons_active_set_cycling
