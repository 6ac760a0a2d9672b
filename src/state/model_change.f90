!> Changes: what a step takes out of the model, puts back, or makes of another material.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! MODEL CHANGE, TYPE=ELEMENT, CHANGE SOLID SECTION, CHANGE MATERIAL and EQUATION, REMOVE. The mesh that the element loops see is
!! that of the present step.
module amontons_model_change
  use amontons_mesh, only: is_inactive_element
  use amontons_model, only: model_type
  use amontons_state, only: state_type
  implicit none
  private
  public :: apply_model_changes, activate_elements, find_unconnected_unknowns

contains

  !> The elements, materials and equations of a step. Before the first step (0) those of the first one hold.
  subroutine apply_model_changes(model, step)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: step                    !< index into model%steps, 0: none has begun
    if (size(model%steps) == 0) return
    associate (now => model%steps(max(1, step)))
      if (allocated(model%mesh%is_inactive)) deallocate (model%mesh%is_inactive)
      if (allocated(now%is_inactive)) model%mesh%is_inactive = now%is_inactive
      if (allocated(now%material)) model%mesh%material = now%material
      if (allocated(model%equations)) model%equations%is_removed = model%equations%last_step < max(1, step)
    end associate
  end subroutine apply_model_changes


  !> Elements that a step puts back free of strain start where their nodes are now, with no history.
  subroutine activate_elements(model, step, state)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< index into model%steps
    type(state_type), intent(inout) :: state       !< the committed fields
    integer :: e, i
    if (.not. allocated(model%steps(step)%is_reactivated)) return
    associate (old => state%old, mesh => model%mesh)
      if (.not. allocated(old%birth_displacement)) return
      do e = 1, mesh%n_elements
        if (.not. model%steps(step)%is_reactivated(e)) cycle
        do i = mesh%first(e), mesh%first(e + 1) - 1
          old%birth_displacement(:, i) = old%u(:, mesh%nodes(i))
        end do
        old%history(:, mesh%point_first(e):mesh%point_first(e + 1) - 1) = 0
      end do
      state%new = old
    end associate
  end subroutine activate_elements


  !> The unknowns of nodes without elements, or all of whose elements are taken out.
  pure function find_unconnected_unknowns(model) result(is_unconnected)
    type(model_type), intent(in) :: model
    logical :: is_unconnected(3 * model%mesh%n_nodes)
    integer :: e, i
    is_unconnected = .true.
    do e = 1, model%mesh%n_elements
      if (is_inactive_element(model%mesh, e)) cycle
      do i = model%mesh%first(e), model%mesh%first(e + 1) - 1
        is_unconnected(3 * model%mesh%nodes(i) - 2:3 * model%mesh%nodes(i)) = .false.
      end do
    end do
  end function find_unconnected_unknowns

end module amontons_model_change
