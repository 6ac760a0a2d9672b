!> Slave nodes shared by several contact pairs: evaluation order, the active side of symmetric pairs, remaining free directions.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 5. The force of a slave follows from the balance of its own node, so all other contact
!! forces on that node are needed first: a slave has a *level* above all slaves whose reactions can act on it. Where reactions would
!! return to the slave they started from, as in symmetric pairs, one side is open (override GIVES_WAY). For each pair at a node in
!! several pairs, the other closed pairs act as supports.
module amontons_shared_slave_nodes
  use amontons_kinds, only: DP
  use amontons_containers, only: list_groups
  use amontons_facets, only: facets_type
  use amontons_surfaces, only: ROUGH_FRICTION
  use amontons_state, only: slave_state_type, STATUS_OPEN
  use amontons_slave_node_overrides, only: is_friction_suppressed, NODE_OVERRIDE_NONE, NODE_OVERRIDE_GIVES_WAY
  implicit none
  private
  public :: MIN_FREE_PART
  public :: shared_slaves_type, reachable_nodes_type, find_shared_slaves, are_shared, resize_shared_slaves, &
    order_slave_levels, free_projector, support_free_projector, global_axes, is_friction_in_other_pair, MIN_PARALLEL_COSINE

  real(DP), parameter :: MIN_PARALLEL_COSINE = 0.99_DP    !< normals whose product is above this constrain the same direction [-]
  real(DP), parameter :: MIN_FREE_PART = 1.0e-6_DP  !< a normal with a smaller free part than this is fixed by supports or
                                                    !! constrains no further direction [-]
  real(DP), parameter :: UNLIMITED_FORCE = sqrt(huge(1.0_DP))   !< normal force of a pair whose friction has no limit [force]

  !> The slaves at each node, and their evaluation order.
  type :: shared_slaves_type
    logical :: has_reaction_chains = .false.            !< reactions of a pair may act on slaves of another
    logical :: has_multi_pair_nodes = .false.           !< nodes are slaves in several exact pairs
    integer :: n_levels = 1
    integer, allocatable :: level(:)           !< (n_slaves) from 1
    integer, allocatable :: pair(:)                !< (n_slaves)
    logical, allocatable :: is_hard_pair(:)        !< (n_slaves) of a HARD pair: force from the balance of its node
    integer, allocatable :: first(:)           !< (n_nodes + 1) start of a node's slaves in member(:)
    integer, allocatable :: member(:)          !< slaves of all nodes, ascending
  end type shared_slaves_type

  !> The nodes to which each slave may give a force within an increment, except its own under exact contact.
  type :: reachable_nodes_type
    integer, allocatable :: first(:)           !< (n_slaves + 1) start of a slave's nodes in nodes(:)
    integer, allocatable :: nodes(:)               !< negative: of its own surface, a force that does not act on slaves of its pair
    integer, allocatable :: side_first(:)      !< (n_slaves + 1) self contact: start of the slaves beside a slave on its surface
    integer, allocatable :: side(:)
  end type reachable_nodes_type

contains

  !> Lists the exact slaves at each node, and whether pairs share nodes. Cost: linear.
  subroutine find_shared_slaves(n_nodes, slaves, facets, is_exact, shared)
    integer, intent(in) :: n_nodes
    type(slave_state_type), intent(in) :: slaves(:)
    type(facets_type), intent(in) :: facets(:)     !< (n_pairs) masters
    logical, intent(in) :: is_exact(:)             !< (n_pairs)
    type(shared_slaves_type), intent(out) :: shared
    integer :: s, p
    allocate (shared%level(size(slaves)), source=1)
    shared%pair = slaves%pair
    shared%is_hard_pair = is_exact(slaves%pair)
    call list_groups(merge(slaves%node, 0, shared%is_hard_pair), n_nodes, shared%first, shared%member)
    shared%has_multi_pair_nodes = any(shared%first(2:) > shared%first(:n_nodes) + 1)
    do p = 1, size(facets)
      shared%has_reaction_chains = shared%has_reaction_chains .or. any(shared%first(facets(p)%nodes &
        + 1) > shared%first(facets(p)%nodes))
    end do
    do s = 1, size(slaves)                         ! the force of a compliant law at a node that is also an exact slave
      if (.not. shared%is_hard_pair(s)) shared%has_reaction_chains = shared%has_reaction_chains .or. &
        shared%first(slaves(s)%node + 1) > shared%first(slaves(s)%node)
    end do
  end subroutine find_shared_slaves


  !> Which slave nodes of a pair are slaves of other exact pairs, too; in self contact all of them if any is, because the side that
  !! would take their functions may be the master.
  pure function are_shared(shared, nodes, is_self) result(is_shared)
    type(shared_slaves_type), intent(in) :: shared
    integer, intent(in) :: nodes(:)
    logical, intent(in) :: is_self                 !< of a pair with one surface
    logical :: is_shared(size(nodes))
    is_shared = shared%first(nodes + 1) - shared%first(nodes) > 1
    if (is_self) is_shared = any(is_shared)
  end function are_shared


  !> Adapts the arrays to a new number of slaves; the new ones are of compliant pairs and are not listed at nodes.
  subroutine resize_shared_slaves(shared, n)
    type(shared_slaves_type), intent(inout) :: shared
    integer, intent(in) :: n                       !< slaves
    integer :: m
    m = min(n, size(shared%level))
    shared%level = [shared%level(:m), spread(1, 1, n - m)]
    shared%pair = [shared%pair(:m), spread(0, 1, n - m)]
    shared%is_hard_pair = [shared%is_hard_pair(:m), spread(.false., 1, n - m)]
  end subroutine resize_shared_slaves


  !> The levels of an increment, and the secondary slaves: pair by pair in the order of the deck, a slave is active unless its
  !! reaction would return to it through slaves that are active already. In self contact the slaves beside an active one come next,
  !! so that a whole side of a fold is slave and the other one master; slaves that were closed come first and keep their side. So do
  !! slaves that bear tension, in any pair: the other side does not know it.
  subroutine order_slave_levels(slaves, is_secondary, reach, shared)
    type(slave_state_type), intent(inout) :: slaves(:)   !< out: the override GIVES_WAY
    logical, intent(in) :: is_secondary(:)         !< (n_pairs) all slaves of the pair are secondary
    type(reachable_nodes_type), intent(in) :: reach          !< of the slaves at the start of the increment
    type(shared_slaves_type), intent(inout) :: shared
    integer, allocatable :: list(:), mark(:), stack(:), queue(:)
    integer :: s, n, pass, n_queue
    logical, allocatable :: is_kept(:), was_tested(:)   ! (n_slaves)
    shared%level = 1
    shared%n_levels = 1
    slaves%overrides%side = NODE_OVERRIDE_NONE
    if (.not. shared%has_reaction_chains) return
    is_kept = .not. shared%is_hard_pair
    allocate (mark(size(slaves)), source=0)
    allocate (stack(size(slaves)), queue(size(slaves)))
    was_tested = .not. shared%is_hard_pair .or. is_secondary(slaves%pair)
    do pass = 1, 2
      do s = 1, size(slaves)
        if (pass == 1 .and. .not. keeps_side(s)) cycle
        call choose_sides(s)
      end do
    end do
    where (.not. is_kept) slaves%overrides%side = NODE_OVERRIDE_GIVES_WAY
    call number_levels(reach, is_kept, shared)

  contains

    !> Whether a slave that was closed keeps its side.
    logical function keeps_side(s)
      integer, intent(in) :: s
      keeps_side = slaves(s)%is_bilateral
      if (.not. keeps_side .and. allocated(reach%side)) keeps_side = slaves(s)%status /= STATUS_OPEN .and. &
        reach%side_first(s + 1) > reach%side_first(s)
    end function keeps_side

    !> Decides on a slave, then on those beside it as far as they are active.
    subroutine choose_sides(s)
      integer, intent(in) :: s
      integer :: k, next
      if (was_tested(s)) return
      n_queue = 1
      queue(1) = s
      was_tested(s) = .true.
      next = 1
      do while (next <= n_queue)
        associate (q => queue(next))
          is_kept(q) = .true.
          is_kept(q) = .not. is_reaction_circular(q)
          if (is_kept(q) .and. slaves(q)%facet > 0 .and. allocated(reach%side)) then
            do k = reach%side_first(q), reach%side_first(q + 1) - 1
              if (was_tested(reach%side(k))) cycle
              was_tested(reach%side(k)) = .true.
              n_queue = n_queue + 1
              queue(n_queue) = reach%side(k)
            end do
          end if
        end associate
        next = next + 1
      end do
    end subroutine choose_sides

    !> Whether a path over active slaves leads from slave s back to it.
    logical function is_reaction_circular(s)
      integer, intent(in) :: s
      integer :: n_stack, k, next
      is_reaction_circular = .false.
      n_stack = 1
      stack(1) = s
      mark(s) = s
      do while (n_stack > 0)
        next = stack(n_stack)
        n_stack = n_stack - 1
        call find_receiving_slaves(shared, reach, next, list, n)
        do k = 1, n
          if (list(k) == s) is_reaction_circular = .true.
          if (list(k) == s) return
          if (mark(list(k)) == s .or. .not. is_kept(list(k))) cycle
          mark(list(k)) = s
          n_stack = n_stack + 1
          stack(n_stack) = list(k)
        end do
      end do
    end function is_reaction_circular

  end subroutine order_slave_levels


  !> Numbers the levels of the active slaves, which have no circular reactions.
  subroutine number_levels(reach, is_kept, shared)
    type(reachable_nodes_type), intent(in) :: reach
    logical, intent(in) :: is_kept(:)              !< (n_slaves) active
    type(shared_slaves_type), intent(inout) :: shared
    integer, allocatable :: list(:)
    integer :: pass, s, i, n
    logical :: is_changed
    do pass = 1, size(is_kept)
      is_changed = .false.
      do s = 1, size(is_kept)
        if (.not. is_kept(s)) cycle
        call find_receiving_slaves(shared, reach, s, list, n)
        do i = 1, n
          if (.not. is_kept(list(i)) .or. shared%level(list(i)) > shared%level(s)) cycle
          shared%level(list(i)) = shared%level(s) + 1
          is_changed = .true.
        end do
      end do
      if (.not. is_changed) exit
    end do
    shared%n_levels = maxval([1, shared%level])
  end subroutine number_levels


  !> The exact slaves on which the reaction of a slave may act within an increment.
  subroutine find_receiving_slaves(shared, reach, s, list, n)
    type(shared_slaves_type), intent(in) :: shared
    type(reachable_nodes_type), intent(in) :: reach
    integer, intent(in) :: s
    integer, allocatable, intent(inout) :: list(:) !< grows when too short
    integer, intent(out) :: n                      !< slaves found
    integer :: i, k
    if (.not. allocated(list)) allocate (list(2 * size(shared%level)))
    n = 0
    do i = reach%first(s), reach%first(s + 1) - 1
      do k = shared%first(abs(reach%nodes(i))), shared%first(abs(reach%nodes(i)) + 1) - 1
        if (reach%nodes(i) < 0 .and. shared%pair(shared%member(k)) == shared%pair(s)) cycle
        n = n + 1
        if (n > size(list)) list = [list, list]
        list(n) = shared%member(k)
      end do
    end do
  end subroutine find_receiving_slaves


  !> The global axes of n slaves, in columns.
  pure function global_axes(n) result(axes)
    integer, intent(in) :: n
    real(DP) :: axes(3, 3, n)
    integer :: k
    axes = 0.0_DP
    do k = 1, 3
      axes(k, k, :) = 1.0_DP
    end do
  end function global_axes


  !> The directions that supports leave free for a slave, as a projector.
  pure function support_free_projector(axes, mask) result(free)
    real(DP), intent(in) :: axes(3, 3)             !< in columns
    real(DP), intent(in) :: mask(3)                !< along them: 1 free, 0 fixed by a support
    real(DP) :: free(3, 3)
    integer :: k
    free = 0.0_DP
    do k = 1, 3
      if (mask(k) > 0.0_DP) free = free + spread(axes(:, k), 2, 3) * spread(axes(:, k), 1, 3)
    end do
  end function support_free_projector


  !> The directions that supports and the other pairs leave free for a slave, as a projector: for each pair the other closed pairs
  !! of the node are supports. Of two pairs with the same normal only the first is.
  pure function free_projector(shared, slaves, s, support_free) result(free)
    type(shared_slaves_type), intent(in) :: shared
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: s
    real(DP), intent(in) :: support_free(3, 3)             !< projector on the directions that supports leave free
    real(DP) :: free(3, 3), v(3), along
    integer :: k, t
    free = support_free
    if (.not. shared%has_multi_pair_nodes .or. .not. shared%is_hard_pair(s)) return
    do k = shared%first(slaves(s)%node), shared%first(slaves(s)%node + 1) - 1
      t = shared%member(k)
      if (t == s .or. slaves(t)%facet == 0) cycle
      if (slaves(t)%status == STATUS_OPEN .and. .not. is_friction_suppressed(slaves(t)%overrides)) cycle
      along = abs(dot_product(slaves(t)%normal, slaves(s)%normal))
      if (along > MIN_PARALLEL_COSINE .and. t > s) cycle
      v = matmul(free, slaves(t)%normal)
      if (along > MIN_PARALLEL_COSINE) v = matmul(free, slaves(s)%normal)
      if (norm2(v) < MIN_FREE_PART) cycle
      v = v / norm2(v)
      free = free - spread(v, 2, 3) * spread(v, 1, 3)
    end do
  end function free_projector


  !> Whether the friction of a slave in several pairs acts in another pair: no direction is left beside its normal, or friction
  !! along the remaining edge acts in the pair with the larger normal force, for equal forces in the first. (If it always acted in
  !! the first pair, friction would vary with a pair of almost no force, and equilibrium might not exist.)
  pure logical function is_friction_in_other_pair(shared, slaves, s, free, friction, Rhat, min_ratio) result(has)
    type(shared_slaves_type), intent(in) :: shared
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: s
    real(DP), intent(in) :: free(3, 3)             !< its free directions
    real(DP), intent(in) :: friction(:)            !< (n_pairs) mu [-]
    real(DP), intent(in) :: Rhat(:, :)             !< (3, n_slaves) imbalance of their rows [force]
    real(DP), intent(in) :: min_ratio              !< of the forces of two pairs that differ [-]
    real(DP) :: own, other
    integer :: k, t
    has = .false.
    if (.not. shared%has_multi_pair_nodes .or. .not. shared%is_hard_pair(s)) return
    if (shared%first(slaves(s)%node + 1) - shared%first(slaves(s)%node) < 2) return
    has = free(1, 1) + free(2, 2) + free(3, 3) < 1.5_DP   ! its rank
    own = 0.0_DP
    if (slaves(s)%status /= STATUS_OPEN) own = max(deciding_force(slaves(s), friction(slaves(s)%pair), Rhat(:, s)), 0.0_DP)
    do k = shared%first(slaves(s)%node), shared%first(slaves(s)%node + 1) - 1
      t = shared%member(k)
      if (t == s .or. slaves(t)%status == STATUS_OPEN .or. .not. friction(slaves(t)%pair) > 0.0_DP) cycle
      other = deciding_force(slaves(t), friction(slaves(t)%pair), Rhat(:, t))
      if (t < s) has = has .or. min_ratio * other >= own
      if (t > s) has = has .or. other > min_ratio * own
    end do
  end function is_friction_in_other_pair


  !> The normal force by which a pair has the friction of a node in several pairs. A node that bears tension has no friction in it,
  !! but what never slips (ROUGH) has friction at any force.
  pure real(DP) function deciding_force(slave, friction, Rhat) result(force)
    type(slave_state_type), intent(in) :: slave    !< closed
    real(DP), intent(in) :: friction               !< mu [-]
    real(DP), intent(in) :: Rhat(3)                !< imbalance of its row [force]
    force = -dot_product(slave%normal, Rhat)       ! [force]
    if (slave%is_bilateral) force = merge(UNLIMITED_FORCE, max(force, 0.0_DP), friction >= ROUGH_FRICTION)
  end function deciding_force

end module amontons_shared_slave_nodes
