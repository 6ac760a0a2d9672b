!> Model change: activation and deactivation of elements, materials and equations between steps.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! MODEL CHANGE, TYPE=ELEMENT. The model data do not change: the inactive elements of a step, their materials and the valid
!! equations follow from the step (is_out and material_in_step of amontons_model, last_step of an equation).
module amontons_model_change
  use amontons_kinds, only: DP
  use amontons_materials, only: HISTORY_INELASTIC
  use amontons_mesh, only: mesh_type
  use amontons_model, only: model_type
  use amontons_state, only: state_type, restore_state
  implicit none
  private
  public :: activate_elements, relieve_elements, find_unconnected_unknowns

contains

  !> Elements that a step reactivates free of strain start from the current positions of their nodes, without history.
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
        if (size(old%modes, 2) > 0) old%modes(:, e) = 0
      end do
    end associate
    call restore_state(state)
  end subroutine activate_elements


  !> The strains that elements have as a step begins, without the thermal ones, become strains without stress. Their laws are
  !! of six strains, which the input admits alone.
  subroutine relieve_elements(model, step, strain, state)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< index into model%steps
    real(DP), intent(in) :: strain(:, :)           !< (6, n_points) committed mechanical strain, tensor components [-]
    type(state_type), intent(inout) :: state       !< the committed history
    integer :: e
    associate (history => state%old%history, first => model%mesh%point_first)
      do e = 1, model%mesh%n_elements
        if (model%steps(step)%is_relieved(e)) history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5, first(e):first(e + 1) - 1) = &
          strain(:, first(e):first(e + 1) - 1)
      end do
    end associate
    call restore_state(state)
  end subroutine relieve_elements


  !> The unknowns of nodes without elements, or whose elements are all inactive.
  pure function find_unconnected_unknowns(mesh, is_absent) result(is_unconnected)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)            !< (n_elements) inactive
    logical :: is_unconnected(3 * mesh%n_nodes)
    integer :: e, i
    is_unconnected = .true.
    do e = 1, mesh%n_elements
      if (is_absent(e)) cycle
      do i = mesh%first(e), mesh%first(e + 1) - 1
        is_unconnected(3 * mesh%nodes(i) - 2:3 * mesh%nodes(i)) = .false.
      end do
    end do
  end function find_unconnected_unknowns

end module amontons_model_change
