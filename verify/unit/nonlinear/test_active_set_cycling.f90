!> Tests of active-set cycling: what is done for the slave nodes of a cycle, by history written by hand, and what undoes it.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_active_set_cycling
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_controls, only: cycling_controls_type
  use amontons_steps, only: step_type
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_NONE, NODE_OVERRIDE_EXTENDED, NODE_OVERRIDE_OFF_MASTER, &
    NODE_OVERRIDE_FROZEN, NODE_OVERRIDE_RELEASED, NODE_OVERRIDE_FRICTIONLESS, NODE_OVERRIDE_RETRY
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_active_set_history, only: active_set_history_type, record_active_set, HISTORY_DEPTH
  use amontons_active_set_cycling, only: break_cycle, release_frozen_nodes, extend_master_edges, facet_track_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call two_blocks(model, 0.2_DP, 0.0_DP, [0.0_DP, 0.0_DP, 0.0_DP])
  model%steps(1)%is_nlgeom = .true.                ! finite sliding: the master has edges
  call start_blocks(model, system, state)
  call check_frozen(suite)
  call check_no_cycle(suite)
  call check_edge(suite)
  call check_tracks(suite)
  call check_release(suite)
  call suite%finish()

contains

  !> All slave nodes stick on facet 1 but node 5 of the list, which has another status or facet in each iteration of a cycle of two.
  subroutine write_history(statuses, facets, merits, history, slaves)
    integer, intent(in) :: statuses(2), facets(2)  !< of slave 5, by turns
    real(DP), intent(in) :: merits(:)              !< of the iterations [force]
    type(active_set_history_type), intent(out) :: history
    type(slave_state_type), allocatable, intent(out) :: slaves(:)
    integer :: i
    slaves = state%new%slaves
    slaves%status = STATUS_STICK
    slaves%facet = 1
    do i = 1, size(merits)
      slaves(5)%status = statuses(1 + mod(i, 2))
      slaves(5)%facet = facets(1 + mod(i, 2))
      call record_active_set(history, slaves, merits(i))
    end do
  end subroutine write_history


  !> Stick and slip by turns: the node, and it alone, is frozen in the status of the least merit, once in an increment.
  subroutine check_frozen(suite)
    type(suite_type), intent(inout) :: suite
    type(active_set_history_type) :: history
    type(slave_state_type), allocatable :: slaves(:)
    logical :: is_found, is_changed
    integer :: i
    do i = 1, 2
      call write_history([STATUS_SLIP, STATUS_STICK], [1, 1], merge([4.0_DP, 1.0_DP, 4.0_DP, 1.0_DP, 4.0_DP], &
        [1.0_DP, 4.0_DP, 1.0_DP, 4.0_DP, 1.0_DP], i == 1), history, slaves)
      call break_cycle(system%contact, history, cycling_controls_type(), slaves, is_found, is_changed)
      call suite%that('frozen: found and acted on', is_found .and. is_changed)
      call suite%that('frozen: one node alone', slaves(5)%overrides%status == NODE_OVERRIDE_FROZEN .and. &
        count(slaves%overrides%status == NODE_OVERRIDE_NONE) == size(slaves) - 1)
      call suite%that('frozen: in the status of the least merit', slaves(5)%status == merge(STATUS_SLIP, STATUS_STICK, i == 1))
      call suite%that('frozen: no edge is extended', all(slaves%overrides%edge == NODE_OVERRIDE_NONE))
      slaves(5)%overrides%status = NODE_OVERRIDE_RELEASED
      call break_cycle(system%contact, history, cycling_controls_type(), slaves, is_found, is_changed)
      call suite%that('frozen: not a second time', is_found .and. .not. is_changed .and. &
        slaves(5)%overrides%status == NODE_OVERRIDE_RELEASED)
    end do
  end subroutine check_frozen


  !> A merit that falls by more than half over the cycle, statuses that do not return, and statuses that stand are no cycle.
  subroutine check_no_cycle(suite)
    type(suite_type), intent(inout) :: suite
    type(active_set_history_type) :: history
    type(slave_state_type), allocatable :: slaves(:)
    logical :: is_found, is_changed
    integer :: length, i
    call write_history([STATUS_SLIP, STATUS_STICK], [1, 1], [16.0_DP, 8.0_DP, 4.0_DP, 2.0_DP], history, slaves)
    call break_cycle(system%contact, history, cycling_controls_type(), slaves, is_found, is_changed)
    call suite%that('no cycle: the merit falls', .not. (is_found .or. is_changed))
    call write_history([STATUS_STICK, STATUS_STICK], [1, 1], [1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP], history, slaves)
    call break_cycle(system%contact, history, cycling_controls_type(), slaves, is_found, is_changed)
    call suite%that('no cycle: nothing changes', .not. (is_found .or. is_changed))
    call write_history([STATUS_SLIP, STATUS_STICK], [1, 1], [1.0_DP, 1.0_DP], history, slaves)
    call break_cycle(system%contact, history, cycling_controls_type(), slaves, is_found, is_changed)
    call suite%that('no cycle: too short', .not. (is_found .or. is_changed))
    call suite%that('no cycle: no override', all(slaves%overrides%status == NODE_OVERRIDE_NONE))
    do length = HISTORY_DEPTH - 1, HISTORY_DEPTH   ! the longer one has iterations that are not stored
      history = active_set_history_type()
      slaves%overrides%status = NODE_OVERRIDE_NONE
      do i = 0, 2 * length
        slaves%status = STATUS_STICK
        slaves(5)%status = merge(STATUS_SLIP, STATUS_STICK, mod(i, length) == 0)
        slaves(5)%facet = 1 + min(1, mod(i, length))
        slaves(6)%facet = 1 + mod(i, length)
        call record_active_set(history, slaves, 1.0_DP)
      end do
      call break_cycle(system%contact, history, cycling_controls_type(), slaves, is_found, is_changed)
      call suite%that('no cycle: longer than the iterations stored', is_found .eqv. length < HISTORY_DEPTH)
    end do
  end subroutine check_no_cycle


  !> Off the master and on it by turns: the facet where the node was last is extended for it; nothing is frozen.
  subroutine check_edge(suite)
    type(suite_type), intent(inout) :: suite
    type(active_set_history_type) :: history
    type(slave_state_type), allocatable :: slaves(:)
    logical :: is_found, is_changed
    call write_history([STATUS_OPEN, STATUS_SLIP], [0, 3], [1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP], history, slaves)
    call break_cycle(system%contact, history, cycling_controls_type(), slaves, is_found, is_changed)
    call suite%that('edge: extended', is_found .and. is_changed .and. slaves(5)%overrides%edge == NODE_OVERRIDE_EXTENDED)
    call suite%that('edge: on its last facet', slaves(5)%facet == 3)
    call suite%that('edge: it alone, and not frozen', count(slaves%overrides%edge /= NODE_OVERRIDE_NONE) == 1 .and. &
      all(slaves%overrides%status == NODE_OVERRIDE_NONE))
    call break_cycle(system%contact, history, cycling_controls_type(), slaves, is_found, is_changed)
    call suite%that('edge: there is no more to do', is_found .and. .not. is_changed)
  end subroutine check_edge


  !> Along one direction: the third time that a node runs off its master its facet is extended when it is found on it; a node that
  !! started open and is off stays off.
  subroutine check_tracks(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type), allocatable :: start(:), trial(:)
    type(facet_track_type), allocatable :: tracks(:)
    logical :: is_lost
    integer :: i, n_extended
    start = state%new%slaves
    start%status = STATUS_OPEN
    start(1)%status = STATUS_STICK
    trial = start
    trial%facet = 1
    allocate (tracks(size(start)))
    do i = 1, 5
      trial(1:2)%facet = merge(1, 0, mod(i, 2) == 1)
      call extend_master_edges(system%contact, cycling_controls_type(), start, trial, tracks, n_extended, is_lost)
      call suite%that('tracks: not yet', n_extended == 0 .and. all(start%overrides%edge == NODE_OVERRIDE_NONE))
    end do
    call suite%that('tracks: twice off', all(tracks(1:2)%n_returns == 2) .and. all(tracks(3:)%n_returns == 0))
    trial(1:2)%facet = 0
    call extend_master_edges(system%contact, cycling_controls_type(), start, trial, tracks, n_extended, is_lost)
    call suite%that('tracks: the third time', n_extended == 2 .and. is_lost .and. start(1)%overrides%edge == NODE_OVERRIDE_EXTENDED)
    call suite%that('tracks: one that was open stays beside its master', start(2)%overrides%edge == NODE_OVERRIDE_OFF_MASTER .and. &
      start(2)%facet == 0)
    call suite%that('tracks: the others as they were', all(start(3:)%overrides%edge == NODE_OVERRIDE_NONE))
    call extend_master_edges(system%contact, cycling_controls_type(), start, trial, tracks, n_extended, is_lost)
    call suite%that('tracks: each node once', n_extended == 0)
    start%overrides%edge = NODE_OVERRIDE_NONE      ! a master whose normals jump at edges
    system%contact%facets%is_faceted = .true.
    tracks = facet_track_type()
    do i = 1, 4
      trial(1)%facet = merge(1, 2, mod(i, 2) == 1)
      call extend_master_edges(system%contact, cycling_controls_type(), start, trial, tracks, n_extended, is_lost)
      call suite%that('tracks: one facet, and the other', n_extended == merge(1, 0, i == 4) .and. .not. is_lost)
    end do
    call suite%that('tracks: alternates', start(1)%overrides%edge == NODE_OVERRIDE_EXTENDED)
    system%contact%facets%is_faceted = .false.
  end subroutine check_tracks


  !> Frozen nodes and suppressed friction are released; a node beside its master only where it is well inside a facet.
  subroutine check_release(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type), allocatable :: slaves(:)
    real(DP), allocatable :: x(:, :)
    logical :: is_released
    x = model%mesh%coordinates
    slaves = state%new%slaves
    call release_frozen_nodes(system%contact, x, cycling_controls_type(), slaves, is_released)
    call suite%that('release: nothing to do', .not. is_released)
    slaves(3)%overrides%status = NODE_OVERRIDE_FROZEN
    slaves(4)%overrides%friction = NODE_OVERRIDE_FRICTIONLESS
    call release_frozen_nodes(system%contact, x, cycling_controls_type(), slaves, is_released)
    call suite%that('release: both', is_released .and. slaves(3)%overrides%status == NODE_OVERRIDE_RELEASED .and. &
      slaves(4)%overrides%friction == NODE_OVERRIDE_RETRY)
    call suite%that('release: no other', count(slaves%overrides%status /= NODE_OVERRIDE_NONE) == 1)
    slaves = state%new%slaves
    slaves(6)%overrides%edge = NODE_OVERRIDE_OFF_MASTER
    x(3, slaves(6)%node) = 0.1_DP
    call release_frozen_nodes(system%contact, x, cycling_controls_type(), slaves, is_released)
    call suite%that('release: above its master it stays off', .not. is_released)
    x(:, slaves(6)%node) = [1.19_DP, 0.6_DP, -0.1_DP]
    call release_frozen_nodes(system%contact, x, cycling_controls_type(), slaves, is_released)
    call suite%that('release: at the edge it stays off', .not. is_released)
    x(:, slaves(6)%node) = [0.6_DP, 0.6_DP, -0.1_DP]
    call release_frozen_nodes(system%contact, x, cycling_controls_type(), slaves, is_released)
    call suite%that('release: well inside it comes back', is_released .and. slaves(6)%overrides%edge == NODE_OVERRIDE_NONE)
  end subroutine check_release


  include 'sample_blocks.inc'

end program test_active_set_cycling
