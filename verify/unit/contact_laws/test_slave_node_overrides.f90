!> Tests of the node overrides: the sequence of friction, the four fields in combination, and the queries.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_slave_node_overrides
  use amontons_kinds, only: DP
  use amontons_slave_node_overrides, only: node_overrides_type, note_pull_off, is_friction_suppressed, is_status_imposed, &
    edge_extension, gives_way, NODE_OVERRIDE_NONE, NODE_OVERRIDE_PULLED_OFF, NODE_OVERRIDE_FRICTIONLESS, NODE_OVERRIDE_RETRY, &
    NODE_OVERRIDE_FRICTIONLESS_FINAL, NODE_OVERRIDE_FROZEN, NODE_OVERRIDE_RELEASED, NODE_OVERRIDE_STICK_ONCE, &
    NODE_OVERRIDE_EXTENDED, NODE_OVERRIDE_OFF_MASTER, NODE_OVERRIDE_GIVES_WAY
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_friction()
  call check_fields()
  call suite%finish()

contains

  !> Opened once, twice, released on trial, opened again: suppressed until the increment ends.
  subroutine check_friction()
    type(node_overrides_type) :: node
    call suite%that('friction: at first none', .not. is_friction_suppressed(node))
    call note_pull_off(node)
    call suite%that('friction: the first opening counts only', node%friction == NODE_OVERRIDE_PULLED_OFF .and. &
      .not. is_friction_suppressed(node))
    call note_pull_off(node)
    call suite%that('friction: the second suppresses it', node%friction == NODE_OVERRIDE_FRICTIONLESS .and. &
      is_friction_suppressed(node))
    call note_pull_off(node)
    call suite%that('friction: a third changes nothing', node%friction == NODE_OVERRIDE_FRICTIONLESS)
    node%friction = NODE_OVERRIDE_RETRY
    call suite%that('friction: it acts on trial', .not. is_friction_suppressed(node))
    call note_pull_off(node)
    call suite%that('friction: the trial failed', node%friction == NODE_OVERRIDE_FRICTIONLESS_FINAL .and. &
      is_friction_suppressed(node))
    call note_pull_off(node)
    call suite%that('friction: for good', node%friction == NODE_OVERRIDE_FRICTIONLESS_FINAL)
  end subroutine check_friction


  !> Each query depends on its own field, also with all of them set.
  subroutine check_fields()
    type(node_overrides_type) :: nodes(5)
    nodes%status = [NODE_OVERRIDE_NONE, NODE_OVERRIDE_FROZEN, NODE_OVERRIDE_RELEASED, NODE_OVERRIDE_STICK_ONCE, &
      NODE_OVERRIDE_FROZEN]
    nodes%edge = [NODE_OVERRIDE_NONE, NODE_OVERRIDE_EXTENDED, NODE_OVERRIDE_OFF_MASTER, NODE_OVERRIDE_NONE, NODE_OVERRIDE_EXTENDED]
    nodes(5)%friction = NODE_OVERRIDE_FRICTIONLESS
    nodes(5)%side = NODE_OVERRIDE_GIVES_WAY
    call suite%that('status: frozen, or stick once', all(is_status_imposed(nodes) .eqv. [.false., .true., .false., .true., .true.]))
    call suite%near('edge: half a facet where it is extended', norm2(edge_extension(nodes, 0.5_DP) - &
      [0.0_DP, 0.5_DP, 0.0_DP, 0.0_DP, 0.5_DP]), 0.0_DP, 0.0_DP)
    call suite%that('side: gives way', all(gives_way(nodes) .eqv. [.false., .false., .false., .false., .true.]))
    call suite%that('all four at a time', is_friction_suppressed(nodes(5)) .and. is_status_imposed(nodes(5)) .and. &
      gives_way(nodes(5)) .and. edge_extension(nodes(5), 0.5_DP) > 0.0_DP)
    call suite%that('the others keep their friction', .not. any(is_friction_suppressed(nodes(:4))))
  end subroutine check_fields

end program test_slave_node_overrides
