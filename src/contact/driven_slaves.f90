!> Driven slave nodes: whether supports drove a slave node of an exact pair behind its master.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Exact contact takes the force on a slave node from the balance of that node. A node whose displacement along the normal is
!! prescribed has none: the support takes every force, and nothing pushes the master. While the node stays before its master that is
!! right; behind it a force is missing. Slave nodes that supports merely hold are none of these: masters bulge over clamped edges.
!!
!! Cost: linear in the slave nodes, with a search for each that supports hold.
module amontons_driven_slaves
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_surfaces, only: is_compliant
  use amontons_model, only: model_type
  use amontons_state, only: slave_state_type
  use amontons_contact_pairs, only: contact_type, update_gap, update_projection
  use amontons_rigid_exterior, only: rigid_bodies_type, collect_rigid_bodies, free_unknowns
  use amontons_shared_slave_nodes, only: support_free_projector, MIN_FREE_PART
  implicit none
  private
  public :: find_driven_slave

  real(DP), parameter :: MIN_DEPTH = 0.001_DP              !< of a node behind its master, over the facet's edge [-]
  real(DP), parameter :: MIN_OWN_PART = 0.5_DP             !< of that depth which the node moved by itself [-]

contains

  !> The first slave node that supports drove behind a master that can move: message says which.
  subroutine find_driven_slave(model, contact, slaves, u, step, message)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)   !< evaluated at u
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: step                    !< of the model, from 1
    character(:), allocatable, intent(out) :: message   !< '': none
    type(slave_state_type) :: slave
    logical, allocatable :: is_movable(:)          ! (n_nodes) known from the first candidate on
    integer :: s
    message = ''
    do s = 1, size(slaves)
      associate (p => slaves(s)%pair)
        if (is_compliant(contact%laws(p)) .or. contact%is_removed(p) .or. slaves(s)%slave_facet > 0) cycle
        if (all(contact%free_mask(:, s) > 0.0_DP)) cycle
      end associate
      slave = find_position(model, contact, s, slaves(s), u)
      if (.not. is_driven_behind(contact, s, slave, u)) cycle
      if (.not. allocated(is_movable)) is_movable = movable_nodes(model, step)
      associate (facets => contact%facets(slave%pair))
        if (.not. any(is_movable(facets%nodes(facets%first(slave%facet):facets%first(slave%facet + 1) - 1)))) cycle
      end associate
      message = 'Contact pair ' // model%pairs(slave%pair)%name // ': supports drive the slave node ' // &
        to_text(model%mesh%node_label(slave%node)) // ' by ' // to_text(-slave%gap) // ' behind its master, and exact ' // &
        'contact cannot push a node that supports hold. Swap slave and master, or give a *SURFACE BEHAVIOR, ' // &
        'PRESSURE-OVERCLOSURE=LINEAR, whose force acts on the master alone.'
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


  !> Whether a slave node that is held along the normal of its master moved behind it, by half of its depth at least by itself.
  pure logical function is_driven_behind(contact, s, slave, u) result(is_so)
    type(contact_type), intent(in) :: contact
    integer, intent(in) :: s                       !< index of the slave
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    is_so = .false.
    if (slave%facet == 0) return
    associate (normal => slave%normal, depth => -slave%gap)
      if (depth < MIN_DEPTH * contact%facets(slave%pair)%edge_length(slave%facet)) return
      if (norm2(matmul(support_free_projector(contact%axes(:, :, s), contact%free_mask(:, s)), normal)) >= MIN_FREE_PART) return
      is_so = dot_product(u(:, slave%node), normal) <= -MIN_OWN_PART * depth
    end associate
  end function is_driven_behind


  !> The nodes with a displacement that supports do not prescribe, by themselves or as those of their rigid body.
  function movable_nodes(model, step) result(is_movable)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< of the model, from 1
    logical :: is_movable(model%mesh%n_nodes)
    type(rigid_bodies_type) :: bodies
    call collect_rigid_bodies(model, bodies)
    is_movable = any(free_unknowns(model, step), dim=1) .and. .not. bodies%is_driven
  end function movable_nodes

end module amontons_driven_slaves
