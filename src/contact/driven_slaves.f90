!> Driven slave nodes: whether supports drove a slave node behind its master where contact cannot keep them apart.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Exact contact takes the force on a slave node from the balance of that node. A node whose displacement along the normal is
!! prescribed has none: the support takes every force, and nothing pushes the master. While the node stays before its master that is
!! right; behind it a force is missing. The penalty at dependent slave nodes pushes the master instead, but no force moves a row all
!! of whose nodes, slave and master, supports move along the normal: by themselves, by equations, or with their rigid body. Laws of
!! the deck give their force for any depth.
!!
!! Slave nodes that supports merely hold are none of these while other nodes carry: masters bulge over clamped edges. Where the
!! pair, or one with the sides exchanged, does not load the master, and of a row that supports move as a whole, the relative
!! displacement counts, else that of the slave node.
!!
!! Cost: linear in the slave nodes, with a search for each that supports hold.
module amontons_driven_slaves
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_surfaces, only: is_compliant, swap_advice
  use amontons_model, only: model_type
  use amontons_state, only: slave_state_type
  use amontons_constraints, only: constraints_type, is_prescribed_along
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_relative_position
  use amontons_contact_step, only: find_faceless_slaves
  use amontons_contact_pairs, only: contact_type, current_row, update_gap, update_projection
  use amontons_slave_node_overrides, only: gives_way
  implicit none
  private
  public :: find_driven_slave

  real(DP), parameter :: MIN_DEPTH = 0.001_DP              !< of a node behind its master, over the facet's edge [-]
  real(DP), parameter :: MIN_OWN_PART = 0.5_DP             !< of that depth by which supports moved the node [-]

contains

  !> The first slave node that supports drove behind its master where contact cannot keep them apart: message says which.
  subroutine find_driven_slave(model, contact, base, slaves, u, message)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(constraints_type), intent(in) :: base     !< of the supports, and what depends on others
    type(slave_state_type), intent(in) :: slaves(:)   !< evaluated at u
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    character(:), allocatable, intent(out) :: message   !< '': none
    type(slave_state_type) :: slave
    logical, allocatable :: is_loaded(:)           ! (n_nodes) by the pair is_loaded_by
    logical :: is_driven, is_master_driven, is_faceless(size(slaves))
    integer :: s, is_loaded_by
    message = ''
    is_loaded_by = 0
    is_faceless = find_faceless_slaves(contact, model, slaves)   ! of removed elements
    do s = 1, size(slaves)
      associate (p => slaves(s)%pair)
        if (contact%is_removed(p) .or. slaves(s)%slave_facet > 0 .or. all(contact%free_mask(:, s) > 0.0_DP)) cycle
        if (is_faceless(s)) cycle
        if (is_compliant(contact%laws(p)) .and. .not. contact%laws(p)%is_penalty) cycle
      end associate
      slave = find_position(model, contact, s, slaves(s), u)
      if (is_loaded_by /= slave%pair) is_loaded = loaded_nodes(contact, slaves, model%mesh%n_nodes, slave%pair)
      is_loaded_by = slave%pair
      call judge_slave(contact, base, slave, u, is_loaded, is_driven, is_master_driven)
      if (.not. is_driven) cycle
      call describe_slave(model, slave, is_master_driven, .not. (is_master_driven .or. norm2(u(:, slave%node)) > 0.0_DP), message)
      return
    end do
  end subroutine find_driven_slave


  !> A slave with its facet and gap, which contact does not keep where it cannot push.
  type(slave_state_type) function find_position(model, contact, s, now, u) result(slave)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: s                       !< index of the slave
    type(slave_state_type), intent(in) :: now
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    slave = now
    if (slave%facet > 0) return
    associate (x => model%mesh%coordinates, reach => contact%reach(slave%pair))
      if (contact%has_fixed_geometry(slave%pair)) then
        call update_projection(contact, x, s, reach, slave)
        call update_gap(contact, x + u, slave)
      else
        call update_projection(contact, x + u, s, reach, slave)
      end if
    end associate
  end function find_position


  !> The nodes that a pair, or one with the sides exchanged, loads, as slaves or as nodes of a master.
  pure function loaded_nodes(contact, slaves, n_nodes, pair) result(is_loaded)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: n_nodes
    integer, intent(in) :: pair
    logical :: is_loaded(n_nodes), is_slave(n_nodes), is_loading(size(contact%facets))
    integer :: p, s
    is_slave = .false.
    is_slave(pack(slaves%node, slaves%pair == pair)) = .true.
    is_loading = [(p == pair .or. any(is_slave(contact%facets(p)%nodes)), p=1, size(contact%facets))]
    is_loaded = .false.
    do s = 1, size(slaves)
      associate (slave => slaves(s))
        if (slave%facet == 0 .or. .not. norm2(slave%force) > 0.0_DP) cycle
        if (.not. is_loading(slave%pair)) cycle
        is_loaded(slave%node) = .true.
        associate (facets => contact%facets(slave%pair))
          is_loaded(facets%nodes(facets%first(slave%facet):facets%first(slave%facet + 1) - 1)) = .true.
        end associate
      end associate
    end do
  end function loaded_nodes


  !> Whether a slave node that supports hold is behind its master by a motion since the start, of half of its depth at least, and
  !! contact could move neither: the exact force of the node is that of a support, or supports move the master too. A slave that
  !! gives way leaves the force to slaves of the other side, and a penalty pushes the master.
  pure subroutine judge_slave(contact, base, slave, u, is_loaded, is_driven, is_master_driven)
    type(contact_type), intent(in) :: contact
    type(constraints_type), intent(in) :: base
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    logical, intent(in) :: is_loaded(:)            !< (n_nodes) nodes that the pair loads
    logical, intent(out) :: is_driven, is_master_driven
    type(contact_row_type) :: row
    real(DP) :: way(3)
    integer :: i
    is_driven = .false.
    is_master_driven = .false.
    if (slave%facet == 0) return
    associate (normal => slave%normal, depth => -slave%gap)
      if (depth < MIN_DEPTH * contact%facets(slave%pair)%edge_length(slave%facet)) return
      if (.not. is_prescribed_along(base, slave%node, normal)) return
      call current_row(contact, slave, row)
      is_master_driven = all([(is_prescribed_along(base, row%nodes(i), normal), i=1, size(row%nodes))])
      if (.not. is_master_driven .and. (gives_way(slave%overrides) .or. contact%laws(slave%pair)%is_penalty)) return
      way = u(:, slave%node)
      if (is_master_driven .or. .not. any(is_loaded(contact%facets(slave%pair)%nodes))) way = evaluate_relative_position(row, u)
      is_driven = dot_product(way, normal) <= -MIN_OWN_PART * depth
    end associate
  end subroutine judge_slave


  !> The sentence about a driven slave node, with what helps.
  subroutine describe_slave(model, slave, is_master_driven, is_still, message)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slave
    logical, intent(in) :: is_master_driven        !< supports move its master, too
    logical, intent(in) :: is_still                !< the node does not move, and the master came
    character(:), allocatable, intent(out) :: message
    associate (pair => model%pairs(slave%pair))
      message = 'Contact pair ' // pair%name // ': supports ' // trim(merge('hold ', 'drive', is_still)) // &
        ' the slave node ' // to_text(model%mesh%node_label(slave%node)) // ' by ' // to_text(-slave%gap) // ' behind its master, '
      if (is_master_driven) then
        message = message // 'whose motion they prescribe, too: no contact can keep them apart. Leave the nodes of one body ' // &
          'free where it touches, or give a *SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR, whose force follows from the ' // &
          'depth. Bodies that may pass each other '
        if (pair%is_general) message = message // 'are named in *CONTACT EXCLUSIONS.'
        if (.not. pair%is_general) message = message // 'need no *CONTACT PAIR.'
      else
        message = message // 'and exact contact cannot push a node that supports hold. ' // swap_advice(pair)
        message = message // ', or give a *SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR, whose force acts on the master alone.'
      end if
    end associate
  end subroutine describe_slave

end module amontons_driven_slaves
