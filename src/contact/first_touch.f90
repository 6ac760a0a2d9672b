!> The first-touch origin of a slave node: where its straight path within the increment meets the master.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 1.
module amontons_first_touch
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_state, only: slave_state_type
  use amontons_contact_constraint_rows, only: contact_row_type, evaluate_relative_position
  use amontons_contact_pairs, only: contact_type, current_row, update_gap, set_stick_origin
  implicit none
  private
  public :: set_first_touch_origin

  real(DP), parameter :: TOL_ENTRY = 1.0e-3_DP   !< error of the part of a path after which a node enters its master [-]

contains

  !> Sets the origin of an open node that closes: the first touch on its straight path from the committed state.
  !!
  !! The gap decreases linearly but for rotating normals; a node already in contact keeps its old position as origin. A node that
  !! comes over the border of its master, as from one master to the next, touches no earlier than it enters.
  subroutine set_first_touch_origin(contact, model, u_old, u, slave)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u_old(:, :)            !< (3, n_nodes) committed displacements [length]
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) current displacements [length]
    type(slave_state_type), intent(inout) :: slave
    type(slave_state_type) :: touch
    type(contact_row_type) :: row
    real(DP), allocatable :: x(:, :)
    real(DP) :: gap, entry
    if (slave%gap >= 0.0_DP) then
      call set_stick_origin(contact, model, u, slave%facet, slave%xi, slave)
    else if (contact%has_fixed_geometry(slave%pair) .or. slave%row > 0) then     ! the row stays: no field of all nodes is needed
      call current_row(contact, slave, row)
      gap = max(slave%offset + dot_product(slave%normal, evaluate_relative_position(row, model%mesh%coordinates, u_old)), 0.0_DP)
      call set_stick_origin(contact, model, u, slave%facet, slave%xi, slave, u_old, gap / (gap - slave%gap))
    else
      call find_entry(contact, model%mesh%coordinates, u_old, u, slave, touch, entry, x)
      gap = max(touch%gap, 0.0_DP)
      call place_on_path(contact, model%mesh%coordinates, u_old, u, entry + (1.0_DP - entry) * gap / (gap - slave%gap), slave, x)
      call update_gap(contact, x, touch)
      if (touch%facet == 0) touch = slave
      call set_stick_origin(contact, model, u, touch%facet, touch%xi, slave)
    end if
  end subroutine set_first_touch_origin


  !> The part of the straight path of a node relative to its master after which it projects on it, by bisection; 0: from the start.
  subroutine find_entry(contact, x, u_old, u, slave, touch, entry, placed)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :), u_old(:, :), u(:, :)   !< (3, n_nodes) coordinates, start and end of the path [length]
    type(slave_state_type), intent(in) :: slave    !< at the end of the path
    type(slave_state_type), intent(out) :: touch   !< at the entry
    real(DP), intent(out) :: entry                 !< [-]
    real(DP), allocatable, intent(out) :: placed(:, :)   !< (3, n_nodes) of `place_on_path`, for further use [length]
    type(slave_state_type) :: trial
    type(contact_row_type) :: row
    real(DP) :: outside, path(3), final(3)
    touch = slave
    call place_on_path(contact, x, u_old, u, 0.0_DP, slave, placed)
    call update_gap(contact, placed, touch)
    entry = 0.0_DP
    if (touch%facet > 0) return
    call current_row(contact, slave, row)
    path = evaluate_relative_position(row, u) - evaluate_relative_position(row, u_old)
    call place_on_path(contact, x, u_old, u, 1.0_DP, slave, placed)
    final = placed(:, slave%node)
    touch = slave
    entry = 1.0_DP
    outside = 0.0_DP
    do while (entry - outside > TOL_ENTRY)
      trial = touch
      placed(:, slave%node) = final - (1.0_DP - 0.5_DP * (outside + entry)) * path
      call update_gap(contact, placed, trial)
      if (trial%facet == 0) outside = 0.5_DP * (outside + entry)
      if (trial%facet == 0) cycle
      entry = 0.5_DP * (outside + entry)
      touch = trial
    end do
  end subroutine find_entry


  !> The places of a slave node and its master on the straight path between two configurations. Other nodes are not set: a field of
  !! all nodes for each slave that closes would cost their product.
  pure subroutine place_on_path(contact, x, u_old, u, fraction, slave, placed)
    type(contact_type), intent(in) :: contact
    real(DP), intent(in) :: x(:, :), u_old(:, :), u(:, :)   !< (3, n_nodes) coordinates, start and end of the path [length]
    real(DP), intent(in) :: fraction               !< of the path [-]
    type(slave_state_type), intent(in) :: slave
    real(DP), allocatable, intent(inout) :: placed(:, :)   !< (3, n_nodes) [length]
    integer :: k
    if (.not. allocated(placed)) allocate (placed(3, size(x, 2)))
    placed(:, slave%node) = place(slave%node)
    associate (nodes => contact%facets(slave%pair)%nodes)
      do k = 1, size(nodes)
        placed(:, nodes(k)) = place(nodes(k))
      end do
    end associate

  contains

    !> The place of one node.
    pure function place(node)
      integer, intent(in) :: node
      real(DP) :: place(3)                         !< [length]
      place = x(:, node) + (u_old(:, node) + fraction * (u(:, node) - u_old(:, node)))
    end function place

  end subroutine place_on_path

end module amontons_first_touch
