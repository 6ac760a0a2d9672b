!> Overlaps: pairs that share nodes: the order in which slaves are looked at, the side that is kept, and corners.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Pairs that share nodes". A slave's force is found from the balance of its own node, so
!! whatever other contact brings to that node has to be known before: a slave stands on a *level* above all slaves whose
!! reaction it may carry. Where reactions would come back to the slave that they started from, as in symmetric pairs, one
!! side gives way. A node that touches in several pairs is, for each of them, held by the others as by supports.
module amontons_shared_slave_nodes
  use amontons_kinds, only: DP
  use amontons_facets, only: facets_type
  use amontons_state, only: slave_type, STATUS_OPEN
  use amontons_node_overrides, only: is_friction_suppressed, NODE_OVERRIDE_NONE, NODE_OVERRIDE_GIVES_WAY
  implicit none
  private
  public :: overlaps_type, reach_type, find_overlaps, fit_overlaps, order_slaves, free_directions, left_free, global_axes, &
    is_friction_taken, PARALLEL

  real(DP), parameter :: PARALLEL = 0.99_DP    !< normals whose product is above this hold the same direction [-]
  real(DP), parameter :: MORE = 1.001_DP       !< a pair presses more than an earlier one if it does by this factor [-]
  real(DP), parameter :: HELD = 1.0e-6_DP      !< a normal whose free part is smaller than this holds nothing more [-]

  !> Which slaves stand at which node, and in which order they are looked at.
  type :: overlaps_type
    logical :: has_chains = .false.            !< reactions of a pair may come to slaves of another
    logical :: has_corners = .false.           !< nodes are slaves in several exact pairs
    integer :: n_levels = 1
    integer, allocatable :: level(:)           !< (n_slaves) from 1
    logical, allocatable :: is_exact(:)        !< (n_slaves) of a HARD pair: found from the balance of its node
    integer, allocatable :: first(:)           !< (n_nodes + 1) start of a node's slaves in member(:)
    integer, allocatable :: member(:)          !< slaves of all nodes, ascending
  end type overlaps_type

  !> The nodes to which each slave may give a force within an increment, but for its own under exact contact.
  type :: reach_type
    integer, allocatable :: first(:)           !< (n_slaves + 1) start of a slave's nodes in nodes(:)
    integer, allocatable :: nodes(:)
  end type reach_type

contains

  !> Which exact slaves stand at which node; whether pairs share nodes at all. Cost: linear.
  subroutine find_overlaps(n_nodes, slaves, facets, is_exact, overlaps)
    integer, intent(in) :: n_nodes
    type(slave_type), intent(in) :: slaves(:)
    type(facets_type), intent(in) :: facets(:)     !< (n_pairs) masters
    logical, intent(in) :: is_exact(:)             !< (n_pairs)
    type(overlaps_type), intent(out) :: overlaps
    integer, allocatable :: next(:)
    integer :: s, p, n
    allocate (overlaps%level(size(slaves)), source=1)
    overlaps%is_exact = is_exact(slaves%pair)
    allocate (overlaps%first(n_nodes + 1), source=0)
    do s = 1, size(slaves)
      if (overlaps%is_exact(s)) overlaps%first(slaves(s)%node + 1) = overlaps%first(slaves(s)%node + 1) + 1
    end do
    overlaps%has_corners = any(overlaps%first > 1)
    overlaps%first(1) = 1
    do n = 1, n_nodes
      overlaps%first(n + 1) = overlaps%first(n + 1) + overlaps%first(n)
    end do
    next = overlaps%first(:n_nodes)
    allocate (overlaps%member(overlaps%first(n_nodes + 1) - 1))
    do s = 1, size(slaves)
      if (.not. overlaps%is_exact(s)) cycle
      overlaps%member(next(slaves(s)%node)) = s
      next(slaves(s)%node) = next(slaves(s)%node) + 1
    end do
    do p = 1, size(facets)
      overlaps%has_chains = overlaps%has_chains .or. any(overlaps%first(facets(p)%nodes + 1) > overlaps%first(facets(p)%nodes))
    end do
    do s = 1, size(slaves)                         ! the force of a law at a node that is also an exact slave
      if (.not. overlaps%is_exact(s)) overlaps%has_chains = overlaps%has_chains .or. &
        overlaps%first(slaves(s)%node + 1) > overlaps%first(slaves(s)%node)
    end do
  end subroutine find_overlaps


  !> Room for slaves whose number has changed; those that come are of compliant pairs and stand at no node.
  subroutine fit_overlaps(overlaps, n)
    type(overlaps_type), intent(inout) :: overlaps
    integer, intent(in) :: n                       !< slaves
    integer :: m
    m = min(n, size(overlaps%level))
    overlaps%level = [overlaps%level(:m), spread(1, 1, n - m)]
    overlaps%is_exact = [overlaps%is_exact(:m), spread(.false., 1, n - m)]
  end subroutine fit_overlaps


  !> The levels of an increment, and which slaves give way: pair by pair in the order of the deck, a slave is kept unless
  !! its reaction would come back to it through slaves that are kept already.
  subroutine order_slaves(slaves, is_secondary, reach, overlaps)
    type(slave_type), intent(inout) :: slaves(:)   !< out: the override GIVES_WAY
    logical, intent(in) :: is_secondary(:)         !< (n_pairs) all slaves of the pair give way
    type(reach_type), intent(in) :: reach          !< of the slaves where they are at the start of the increment
    type(overlaps_type), intent(inout) :: overlaps
    integer, allocatable :: list(:), mark(:), stack(:)
    integer :: s, t, i, n, pass
    logical, allocatable :: is_kept(:)             ! (n_slaves)
    logical :: is_changed
    overlaps%level = 1
    overlaps%n_levels = 1
    slaves%overrides%side = NODE_OVERRIDE_NONE
    if (.not. overlaps%has_chains) return
    is_kept = .not. overlaps%is_exact
    allocate (mark(size(slaves)), source=0)
    allocate (stack(size(slaves)))
    do s = 1, size(slaves)
      if (.not. overlaps%is_exact(s) .or. is_secondary(slaves(s)%pair)) cycle
      is_kept(s) = .true.
      is_kept(s) = .not. comes_back(s)
    end do
    where (.not. is_kept) slaves%overrides%side = NODE_OVERRIDE_GIVES_WAY
    do pass = 1, size(slaves)
      is_changed = .false.
      do s = 1, size(slaves)
        if (.not. is_kept(s)) cycle
        call find_carriers(overlaps, reach, s, list, n)
        do i = 1, n
          t = list(i)
          if (.not. is_kept(t) .or. overlaps%level(t) > overlaps%level(s)) cycle
          overlaps%level(t) = overlaps%level(s) + 1
          is_changed = .true.
        end do
      end do
      if (.not. is_changed) exit
    end do
    overlaps%n_levels = maxval([1, overlaps%level])

  contains

    !> Whether a path over slaves that are kept leads from slave s back to it.
    logical function comes_back(s)
      integer, intent(in) :: s
      integer :: n_stack, k, next
      comes_back = .false.
      n_stack = 1
      stack(1) = s
      mark(s) = s
      do while (n_stack > 0)
        next = stack(n_stack)
        n_stack = n_stack - 1
        call find_carriers(overlaps, reach, next, list, n)
        do k = 1, n
          if (list(k) == s) comes_back = .true.
          if (list(k) == s) return
          if (mark(list(k)) == s .or. .not. is_kept(list(k))) cycle
          mark(list(k)) = s
          n_stack = n_stack + 1
          stack(n_stack) = list(k)
        end do
      end do
    end function comes_back

  end subroutine order_slaves


  !> The exact slaves that may carry the reaction of a slave within an increment.
  subroutine find_carriers(overlaps, reach, s, list, n)
    type(overlaps_type), intent(in) :: overlaps
    type(reach_type), intent(in) :: reach
    integer, intent(in) :: s
    integer, allocatable, intent(inout) :: list(:) !< grows when too short
    integer, intent(out) :: n                      !< carriers found
    integer :: i, k
    if (.not. allocated(list)) allocate (list(2 * size(overlaps%level)))
    n = 0
    do i = reach%first(s), reach%first(s + 1) - 1
      do k = overlaps%first(reach%nodes(i)), overlaps%first(reach%nodes(i) + 1) - 1
        n = n + 1
        if (n > size(list)) list = [list, list]
        list(n) = overlaps%member(k)
      end do
    end do
  end subroutine find_carriers


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


  !> The directions that supports leave to a slave, as a projector.
  pure function left_free(axes, mask) result(free)
    real(DP), intent(in) :: axes(3, 3)             !< in columns
    real(DP), intent(in) :: mask(3)                !< along them: 1 free, 0 held by a support
    real(DP) :: free(3, 3)
    integer :: k
    free = 0.0_DP
    do k = 1, 3
      if (mask(k) > 0.0_DP) free = free + spread(axes(:, k), 2, 3) * spread(axes(:, k), 1, 3)
    end do
  end function left_free


  !> The directions that supports and the other pairs leave to a slave, as a projector: for each pair the others in which
  !! the node touches are supports. Of two pairs that push the same way only the one that comes first does.
  pure function free_directions(overlaps, slaves, s, left) result(free)
    type(overlaps_type), intent(in) :: overlaps
    type(slave_type), intent(in) :: slaves(:)
    integer, intent(in) :: s
    real(DP), intent(in) :: left(3, 3)             !< projector on what supports leave
    real(DP) :: free(3, 3), v(3), along
    integer :: k, t
    free = left
    if (.not. overlaps%has_corners .or. .not. overlaps%is_exact(s)) return
    do k = overlaps%first(slaves(s)%node), overlaps%first(slaves(s)%node + 1) - 1
      t = overlaps%member(k)
      if (t == s .or. slaves(t)%facet == 0) cycle
      if (slaves(t)%status == STATUS_OPEN .and. .not. is_friction_suppressed(slaves(t)%overrides)) cycle
      along = abs(dot_product(slaves(t)%normal, slaves(s)%normal))
      if (along > PARALLEL .and. t > s) cycle
      v = matmul(free, slaves(t)%normal)
      if (along > PARALLEL) v = matmul(free, slaves(s)%normal)
      if (norm2(v) < HELD) cycle
      v = v / norm2(v)
      free = free - spread(v, 2, 3) * spread(v, 1, 3)
    end do
  end function free_directions


  !> Whether a slave that other pairs hold too has no friction of its own: no direction is left beside its normal, or the
  !! friction along the edge that is left is given by the pair that presses more, of two that press alike by the first. (By the
  !! first pair, whatever it presses, friction would come and go with a pair that hardly touches, and where it does there may be no
  !! balance.)
  pure logical function is_friction_taken(overlaps, slaves, s, free, friction, Rhat) result(has)
    type(overlaps_type), intent(in) :: overlaps
    type(slave_type), intent(in) :: slaves(:)
    integer, intent(in) :: s
    real(DP), intent(in) :: free(3, 3)             !< its free directions
    real(DP), intent(in) :: friction(:)            !< (n_pairs) mu [-]
    real(DP), intent(in) :: Rhat(:, :)             !< (3, n_slaves) imbalance of their rows [force]
    real(DP) :: own, other
    integer :: k, t
    has = .false.
    if (.not. overlaps%has_corners .or. .not. overlaps%is_exact(s)) return
    if (overlaps%first(slaves(s)%node + 1) - overlaps%first(slaves(s)%node) < 2) return
    has = free(1, 1) + free(2, 2) + free(3, 3) < 1.5_DP   ! its rank
    own = 0.0_DP
    if (slaves(s)%status /= STATUS_OPEN) own = max(-dot_product(slaves(s)%normal, Rhat(:, s)), 0.0_DP)
    do k = overlaps%first(slaves(s)%node), overlaps%first(slaves(s)%node + 1) - 1
      t = overlaps%member(k)
      if (t == s .or. slaves(t)%status == STATUS_OPEN .or. .not. friction(slaves(t)%pair) > 0.0_DP) cycle
      other = -dot_product(slaves(t)%normal, Rhat(:, t))
      if (t < s) has = has .or. MORE * other >= own
      if (t > s) has = has .or. other > MORE * own
    end do
  end function is_friction_taken

end module amontons_shared_slave_nodes
