!> Node overrides: what the solver imposes on a slave node against its trial traction, its friction law or its search.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A slave node without overrides has the status of its trial traction, the friction of its law and the facet of its projection. An
!! override replaces one of these for a part of the increment. The four fields are independent: a node can have one override in each
!! of them at the same time. NONE is the value of all of them at the start of an increment (EXTENDED can outlast it).
!!
!! | field: value | set by | why | until |
!! |---|---|---|---|
!! | friction: PULLED_OFF | evaluation: it opens (ROUGH, or several pairs) | counts; no effect yet | it opens again |
!! | friction: FRICTIONLESS | evaluation: it opens again | neither open nor stick is admissible | all else is in equilibrium |
!! | friction: RETRY | `release_frozen_nodes` | friction acts again, on trial | it opens again |
!! | friction: FRICTIONLESS_FINAL | evaluation: it opens in RETRY | the trial failed | end of the increment |
!! | status: FROZEN | `break_cycle` (AUTO) | cycling: the status of the least merit | all else is in equilibrium |
!! | status: RELEASED | `release_frozen_nodes` | it was frozen; not a second time | end of the increment |
!! | status: STICK_ONCE | line search NODAL | its step ends at zero slip | end of the evaluation |
!! | edge: EXTENDED | `break_cycle`, `extend_master_edges` | no equilibrium on either side of an edge | it is open or on the facet |
!! | edge: OFF_MASTER | `extend_master_edges` | the same; it was off the master before | well inside, or end of the increment |
!! | side: GIVES_WAY | `order_slave_levels`, pre-tension sections | another slave enforces this contact | end of the increment |
module amontons_slave_node_overrides
  use amontons_kinds, only: DP
  implicit none
  private
  public :: node_overrides_type, note_pull_off, is_friction_suppressed, is_status_imposed, edge_extension, gives_way
  public :: NODE_OVERRIDE_NONE, NODE_OVERRIDE_PULLED_OFF, NODE_OVERRIDE_FRICTIONLESS, NODE_OVERRIDE_RETRY, &
    NODE_OVERRIDE_FRICTIONLESS_FINAL, NODE_OVERRIDE_FROZEN, NODE_OVERRIDE_RELEASED, NODE_OVERRIDE_STICK_ONCE, &
    NODE_OVERRIDE_EXTENDED, NODE_OVERRIDE_OFF_MASTER, NODE_OVERRIDE_GIVES_WAY

  integer, parameter :: NODE_OVERRIDE_NONE = 0               !< of any field: the node follows its laws
  integer, parameter :: NODE_OVERRIDE_PULLED_OFF = 1         !< friction: it opened once in this increment; no effect yet
  integer, parameter :: NODE_OVERRIDE_FRICTIONLESS = 2       !< friction: suppressed until all else is in equilibrium
  integer, parameter :: NODE_OVERRIDE_RETRY = 3              !< friction: acts again, on trial
  integer, parameter :: NODE_OVERRIDE_FRICTIONLESS_FINAL = 4 !< friction: suppressed until the increment ends
  integer, parameter :: NODE_OVERRIDE_FROZEN = 5             !< status: kept, whatever the trial traction
  integer, parameter :: NODE_OVERRIDE_RELEASED = 6           !< status: was frozen, and is not frozen again
  integer, parameter :: NODE_OVERRIDE_STICK_ONCE = 7         !< status: set to stick for one evaluation
  integer, parameter :: NODE_OVERRIDE_EXTENDED = 8           !< edge: its facet extends beyond its edges (contact%edge_extension)
  integer, parameter :: NODE_OVERRIDE_OFF_MASTER = 9         !< edge: it stays off the master
  integer, parameter :: NODE_OVERRIDE_GIVES_WAY = 10         !< side: open, since another slave enforces this contact

  !> The overrides of one slave node: one of each field at a time.
  type :: node_overrides_type
    integer :: friction = NODE_OVERRIDE_NONE   !< NONE, PULLED_OFF, FRICTIONLESS, RETRY, FRICTIONLESS_FINAL
    integer :: status = NODE_OVERRIDE_NONE     !< NONE, FROZEN, RELEASED, STICK_ONCE
    integer :: edge = NODE_OVERRIDE_NONE       !< NONE, EXTENDED, OFF_MASTER
    integer :: side = NODE_OVERRIDE_NONE       !< NONE, GIVES_WAY
  end type node_overrides_type

contains

  !> Records that a ROUGH node, or one in several pairs, opens: the second time in an increment its friction is suppressed; if it
  !! opens after a retry, until the increment ends.
  elemental subroutine note_pull_off(overrides)
    type(node_overrides_type), intent(inout) :: overrides
    select case (overrides%friction)
    case (NODE_OVERRIDE_NONE)
      overrides%friction = NODE_OVERRIDE_PULLED_OFF
    case (NODE_OVERRIDE_PULLED_OFF)
      overrides%friction = NODE_OVERRIDE_FRICTIONLESS
    case (NODE_OVERRIDE_RETRY)
      overrides%friction = NODE_OVERRIDE_FRICTIONLESS_FINAL
    end select
  end subroutine note_pull_off


  !> Whether the friction of a node is suppressed. A ROUGH node then slides without friction. Of several pairs at a node, the pairs
  !! still closed have no friction along the normal of this one.
  elemental logical function is_friction_suppressed(overrides)
    type(node_overrides_type), intent(in) :: overrides
    is_friction_suppressed = overrides%friction == NODE_OVERRIDE_FRICTIONLESS .or. &
      overrides%friction == NODE_OVERRIDE_FRICTIONLESS_FINAL
  end function is_friction_suppressed


  !> Whether the status of a node is imposed, whatever its trial traction.
  elemental logical function is_status_imposed(overrides)
    type(node_overrides_type), intent(in) :: overrides
    is_status_imposed = overrides%status == NODE_OVERRIDE_FROZEN .or. overrides%status == NODE_OVERRIDE_STICK_ONCE
  end function is_status_imposed


  !> Extension of a node's facet beyond its edges by an override, over the facet length; 0: that of any facet.
  elemental real(DP) function edge_extension(overrides, extension)
    type(node_overrides_type), intent(in) :: overrides
    real(DP), intent(in) :: extension              !< of an extended facet over its length [-]
    edge_extension = merge(extension, 0.0_DP, overrides%edge == NODE_OVERRIDE_EXTENDED)   ! [-]
  end function edge_extension


  !> Whether a node is open in this increment because another slave enforces its contact.
  elemental logical function gives_way(overrides)
    type(node_overrides_type), intent(in) :: overrides
    gives_way = overrides%side == NODE_OVERRIDE_GIVES_WAY
  end function gives_way

end module amontons_slave_node_overrides
