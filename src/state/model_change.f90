!> Changes: what a step takes out of the model, puts back, or makes of another material.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! MODEL CHANGE, TYPE=ELEMENT, CHANGE SOLID SECTION, CHANGE MATERIAL and EQUATION, REMOVE. The mesh that the element loops see is
!! that of the present step.
module amontons_model_change
  use amontons_mesh, only: is_out
  use amontons_model, only: model_type
  use amontons_state, only: state_type
  implicit none
  private
  public :: change_model, bear_elements, lone_unknowns

contains

  !> The elements, materials and equations of a step. Before the first step (0) those of the first one hold.
  subroutine change_model(model, step)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: step                    !< index into model%steps, 0: none has begun
    if (size(model%steps) == 0) return
    associate (now => model%steps(max(1, step)))
      if (allocated(model%mesh%is_absent)) deallocate (model%mesh%is_absent)
      if (allocated(now%is_absent)) model%mesh%is_absent = now%is_absent
      if (allocated(now%material)) model%mesh%material = now%material
      if (allocated(model%equations)) model%equations%is_removed = model%equations%last_step < max(1, step)
    end associate
  end subroutine change_model


  !> Elements that a step puts back free of strain start where their nodes are now, with no history.
  subroutine bear_elements(model, step, state)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< index into model%steps
    type(state_type), intent(inout) :: state       !< the committed fields
    integer :: e, i
    if (.not. allocated(model%steps(step)%is_born)) return
    associate (old => state%old, mesh => model%mesh)
      if (.not. allocated(old%birth)) return
      do e = 1, mesh%n_elements
        if (.not. model%steps(step)%is_born(e)) cycle
        do i = mesh%first(e), mesh%first(e + 1) - 1
          old%birth(:, i) = old%u(:, mesh%nodes(i))
        end do
        old%history(:, mesh%point_first(e):mesh%point_first(e + 1) - 1) = 0
      end do
      state%new = old
    end associate
  end subroutine bear_elements


  !> The unknowns of nodes without elements, or all of whose elements are taken out.
  pure function lone_unknowns(model) result(is_lone)
    type(model_type), intent(in) :: model
    logical :: is_lone(3 * model%mesh%n_nodes)
    integer :: e, i
    is_lone = .true.
    do e = 1, model%mesh%n_elements
      if (is_out(model%mesh, e)) cycle
      do i = model%mesh%first(e), model%mesh%first(e + 1) - 1
        is_lone(3 * model%mesh%nodes(i) - 2:3 * model%mesh%nodes(i)) = .false.
      end do
    end do
  end function lone_unknowns

end module amontons_model_change
