!> Tests of shared slave nodes: which slaves stand at a node, levels, circles of reactions, and what several pairs leave free.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_shared_slave_nodes
  use amontons_kinds, only: DP
  use amontons_facets, only: facets_type
  use amontons_slave_node_overrides, only: gives_way, NODE_OVERRIDE_EXTENDED
  use amontons_state, only: slave_state_type, STATUS_OPEN, STATUS_STICK
  use amontons_shared_slave_nodes, only: shared_slaves_type, reachable_nodes_type, find_shared_slaves, resize_shared_slaves, &
    are_shared, &
    order_slave_levels, free_projector, support_free_projector, global_axes, is_friction_in_other_pair
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_chain(suite)
  call check_circle(suite)
  call check_separate(suite)
  call check_projectors(suite)
  call check_friction(suite)
  call check_others()
  call suite%finish()

contains

  !> Masters with these nodes, a pair each; a slave of each pair at each of these nodes.
  subroutine make_pairs(slave_nodes, master_nodes, slaves, facets)
    integer, intent(in) :: slave_nodes(:), master_nodes(:)   !< (n_pairs)
    type(slave_state_type), allocatable, intent(out) :: slaves(:)
    type(facets_type), allocatable, intent(out) :: facets(:)
    integer :: p
    allocate (slaves(size(slave_nodes)), facets(size(slave_nodes)))
    do p = 1, size(slave_nodes)
      slaves(p)%pair = p
      slaves(p)%node = slave_nodes(p)
      slaves(p)%facet = 1
      slaves(p)%status = STATUS_STICK
      facets(p)%nodes = [master_nodes(p)]
    end do
  end subroutine make_pairs


  !> Node 1 has slaves of three pairs; node 2 has a slave of one pair.
  subroutine check_others()
    type(slave_state_type), allocatable :: slaves(:)
    type(facets_type), allocatable :: facets(:)
    type(shared_slaves_type) :: shared
    call make_pairs([1, 2, 1, 1], [3, 4, 5, 6], slaves, facets)
    call find_shared_slaves(6, slaves, facets, spread(.true., 1, 4), shared)
    call suite%that('slaves of others', all(are_shared(shared, [1, 2, 3], .false.) .eqv. [.true., .false., .false.]))
    call suite%that('slaves of others in self contact', all(are_shared(shared, [2, 1], .true.)))
    call suite%that('slaves of no others in self contact', .not. any(are_shared(shared, [2, 3], .true.)))
  end subroutine check_others


  !> Slave at node 1 pushes node 2, a slave that pushes node 3, a slave that pushes node 4: three levels, whatever their order.
  subroutine check_chain(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type), allocatable :: slaves(:)
    type(facets_type), allocatable :: facets(:)
    type(shared_slaves_type) :: shared
    type(reachable_nodes_type) :: reach
    call make_pairs([3, 1, 2], [4, 2, 3], slaves, facets)
    call find_shared_slaves(4, slaves, facets, [.true., .true., .true.], shared)
    call suite%that('chain: reactions are passed on', shared%has_reaction_chains .and. .not. shared%has_multi_pair_nodes)
    call suite%that('chain: slaves by node', all(shared%member == [2, 3, 1]) .and. all(shared%first == [1, 2, 3, 4, 4]))
    reach%first = [1, 2, 3, 4]
    reach%nodes = [4, 2, 3]
    slaves(2)%overrides%edge = NODE_OVERRIDE_EXTENDED
    call order_slave_levels(slaves, [.false., .false., .false.], reach, shared)
    call suite%that('chain: levels', all(shared%level == [3, 1, 2]) .and. shared%n_levels == 3)
    call suite%that('chain: none gives way', .not. any(gives_way(slaves%overrides)))
    call suite%that('chain: an extended edge stays', slaves(2)%overrides%edge == NODE_OVERRIDE_EXTENDED)
    call order_slave_levels(slaves, [.false., .false., .true.], reach, shared)
    call suite%that('chain: a secondary pair gives way', all(gives_way(slaves%overrides) .eqv. [.false., .false., .true.]))
    call suite%that('chain: then two levels less', shared%n_levels == 1)
    call order_slave_levels(slaves, [.false., .false., .false.], reach, shared)
    call suite%that('chain: until the next increment', .not. any(gives_way(slaves%overrides)))
    call resize_shared_slaves(shared, 5)
    call suite%that('chain: more slaves are compliant', all(shared%is_hard_pair .eqv. [.true., .true., .true., .false., .false.]) &
      .and. all(shared%level == [3, 1, 2, 1, 1]))
    call resize_shared_slaves(shared, 2)
    call suite%that('chain: or fewer', size(shared%level) == 2 .and. size(shared%is_hard_pair) == 2)
  end subroutine check_chain


  !> A symmetric pair: each slave's reaction comes back to it over the other. The first is kept; over a law there is no circle.
  subroutine check_circle(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type), allocatable :: slaves(:)
    type(facets_type), allocatable :: facets(:)
    type(shared_slaves_type) :: shared
    type(reachable_nodes_type) :: reach
    call make_pairs([1, 2], [2, 1], slaves, facets)
    reach%first = [1, 2, 3]
    reach%nodes = [2, 1]
    call find_shared_slaves(2, slaves, facets, [.true., .true.], shared)
    call order_slave_levels(slaves, [.false., .false.], reach, shared)
    call suite%that('circle: the second gives way', all(gives_way(slaves%overrides) .eqv. [.false., .true.]))
    call find_shared_slaves(2, slaves, facets, [.true., .false.], shared)
    call order_slave_levels(slaves, [.false., .false.], reach, shared)
    call suite%that('circle: none over a law', .not. any(gives_way(slaves%overrides)))
    call suite%that('circle: what the law gives comes first', shared%level(1) > shared%level(2))
    call make_pairs([1, 2], [3, 3], slaves, facets)
    slaves%pair = 1
    reach%nodes = [-2, -1]                         ! of its own surface
    facets(1)%nodes = [1]                          ! as if reactions were passed on
    call find_shared_slaves(3, slaves, facets, [.true., .true.], shared)
    call order_slave_levels(slaves, [.false., .false.], reach, shared)
    call suite%that('circle: none in a surface', .not. any(gives_way(slaves%overrides)) .and. all(shared%level == 1))
    slaves(2)%pair = 2
    call find_shared_slaves(3, slaves, facets, [.true., .true.], shared)
    call order_slave_levels(slaves, [.false., .false.], reach, shared)
    call suite%that('circle: but over another pair', all(gives_way(slaves%overrides) .eqv. [.false., .true.]))
  end subroutine check_circle


  !> Pairs without a common node: one level, and nothing to look for.
  subroutine check_separate(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type), allocatable :: slaves(:)
    type(facets_type), allocatable :: facets(:)
    type(shared_slaves_type) :: shared
    type(reachable_nodes_type) :: reach
    call make_pairs([1, 2], [3, 4], slaves, facets)
    reach%first = [1, 2, 3]
    reach%nodes = [3, 4]
    call find_shared_slaves(4, slaves, facets, [.true., .true.], shared)
    call order_slave_levels(slaves, [.false., .false.], reach, shared)
    call suite%that('separate', .not. (shared%has_reaction_chains .or. shared%has_multi_pair_nodes) .and. shared%n_levels == 1)
    call make_pairs([1, 1], [3, 4], slaves, facets)
    call find_shared_slaves(4, slaves, facets, [.true., .true.], shared)
    call suite%that('two pairs at a node', shared%has_multi_pair_nodes .and. .not. shared%has_reaction_chains)
  end subroutine check_separate


  !> What supports and another pair leave: a plane, a line; of two that push the same way the first alone holds.
  subroutine check_projectors(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type), allocatable :: slaves(:)
    type(facets_type), allocatable :: facets(:)
    type(shared_slaves_type) :: shared
    real(DP) :: axes(3, 3, 2), all_free(3, 3), free(3, 3)
    axes = global_axes(2)
    all_free = support_free_projector(axes(:, :, 2), [1.0_DP, 1.0_DP, 1.0_DP])
    call suite%near('supports: none', norm2(all_free - axes(:, :, 1)), 0.0_DP, 0.0_DP)
    free = support_free_projector(reshape([0.6_DP, 0.8_DP, 0.0_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3]), &
      [0.0_DP, 1.0_DP, 1.0_DP])
    call suite%near('supports: an oblique one', norm2(matmul(free, [0.6_DP, 0.8_DP, 0.0_DP])), 0.0_DP, 1.0e-15_DP)
    call suite%near('supports: two directions are left', free(1, 1) + free(2, 2) + free(3, 3), 2.0_DP, 1.0e-15_DP)
    call make_pairs([1, 1], [3, 4], slaves, facets)
    call find_shared_slaves(4, slaves, facets, [.true., .true.], shared)
    slaves(1)%normal = [1.0_DP, 0.0_DP, 0.0_DP]
    slaves(2)%normal = [0.6_DP, 0.8_DP, 0.0_DP]
    free = free_projector(shared, slaves, 1, all_free)
    call suite%near('pairs: the other holds its normal', norm2(matmul(free, slaves(2)%normal)), 0.0_DP, 1.0e-15_DP)
    call suite%near('pairs: idempotent', norm2(matmul(free, free) - free), 0.0_DP, 1.0e-15_DP)
    slaves(2)%normal = [sqrt(0.91_DP), 0.3_DP, 0.0_DP]     ! supports hold most of it: its free part counts all the same
    free = free_projector(shared, slaves, 1, support_free_projector(axes(:, :, 1), [0.0_DP, 1.0_DP, 1.0_DP]))
    call suite%near('pairs: beside supports', norm2(free - reshape([real(DP) :: 0, 0, 0, 0, 0, 0, 0, 0, 1], [3, 3])), &
      0.0_DP, 1.0e-15_DP)
    slaves(2)%status = STATUS_OPEN
    call suite%near('pairs: an open one holds nothing', norm2(free_projector(shared, slaves, 1, all_free) - all_free), 0.0_DP, &
      0.0_DP)
    slaves(2)%status = STATUS_STICK
    slaves(2)%normal = [1.0_DP, 0.0_DP, 0.0_DP]
    call suite%near('pairs: the first of two alike', norm2(free_projector(shared, slaves, 1, all_free) - all_free), 0.0_DP, 0.0_DP)
    free = free_projector(shared, slaves, 2, all_free)
    call suite%near('pairs: the second of two alike', norm2(matmul(free, slaves(2)%normal)), 0.0_DP, 1.0e-15_DP)
  end subroutine check_projectors


  !> Along an edge between two masters friction is given by the pair that presses more, of two that press alike by the first.
  subroutine check_friction(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type), allocatable :: slaves(:)
    type(facets_type), allocatable :: facets(:)
    type(shared_slaves_type) :: shared
    real(DP) :: free(3, 3), Rhat(3, 2), axes(3, 3, 1), line(3, 3)
    logical :: has(2)
    integer :: s
    call make_pairs([1, 1], [3, 4], slaves, facets)
    call find_shared_slaves(4, slaves, facets, [.true., .true.], shared)
    slaves(1)%normal = [1.0_DP, 0.0_DP, 0.0_DP]
    slaves(2)%normal = [0.0_DP, 1.0_DP, 0.0_DP]
    axes = global_axes(1)
    free = support_free_projector(axes(:, :, 1), [1.0_DP, 1.0_DP, 1.0_DP])
    line = support_free_projector(axes(:, :, 1), [0.0_DP, 0.0_DP, 1.0_DP])
    Rhat = -1.0_DP
    has = [(is_friction_in_other_pair(shared, slaves, s, free, [0.3_DP, 0.3_DP], Rhat, 1.001_DP), s=1, 2)]
    call suite%that('friction: alike, the first has it', .not. has(1) .and. has(2))
    Rhat(:, 2) = -2.0_DP
    has = [(is_friction_in_other_pair(shared, slaves, s, free, [0.3_DP, 0.3_DP], Rhat, 1.001_DP), s=1, 2)]
    call suite%that('friction: the second presses more', has(1) .and. .not. has(2))
    call suite%that('friction: but it has none', .not. &
      is_friction_in_other_pair(shared, slaves, 1, free, [0.3_DP, 0.0_DP], Rhat, 1.001_DP))
    call suite%that('friction: no direction beside the normal', is_friction_in_other_pair(shared, slaves, 1, line, &
      [0.3_DP, 0.0_DP], Rhat, 1.001_DP))
    slaves(2)%status = STATUS_OPEN
    has = [(is_friction_in_other_pair(shared, slaves, s, free, [0.3_DP, 0.3_DP], Rhat, 1.001_DP), s=1, 2)]
    call suite%that('friction: of an open pair none', .not. has(1))
  end subroutine check_friction

end program test_shared_slave_nodes
