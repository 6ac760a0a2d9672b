!> Tests of model change: unknowns without elements, and elements that start free of strain where their nodes are.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_model_change
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_state, only: state_type, create_state, slave_state_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: finalize_mesh
  use amontons_model_change, only: activate_elements, find_unconnected_unknowns
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_unconnected(suite)
  call check_activated(suite)
  call suite%finish()

contains

  !> Two cubes one above the other, and node 13 without an element.
  subroutine two_cubes(model)
    type(model_type), intent(out) :: model
    integer :: i
    real(DP), parameter :: SQUARE(2, 4) = reshape([0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 1.0_DP], [2, 4])
    associate (mesh => model%mesh)
      mesh%n_nodes = 13
      mesh%n_elements = 2
      mesh%node_label = [(i, i=1, 13)]
      mesh%element_label = [1, 2]
      allocate (mesh%coordinates(3, 13), source=9.0_DP)
      do i = 1, 12
        mesh%coordinates(:, i) = [SQUARE(:, 1 + mod(i - 1, 4)), real((i - 1) / 4, DP)]
      end do
      mesh%kind = [KIND_C3D8, KIND_C3D8]
      mesh%material = [1, 1]
      mesh%first = [1, 9, 17]
      mesh%nodes = [(i, i=1, 8), (i, i=5, 12)]
      allocate (mesh%node_sets(0), mesh%element_sets(0))
      call finalize_mesh(mesh)
    end associate
    allocate (model%steps(2))
  end subroutine two_cubes


  !> Nodes that no present element has; a node of two elements only when both are absent.
  subroutine check_unconnected(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    logical :: is_alone(39)
    integer :: i
    call two_cubes(model)
    is_alone = find_unconnected_unknowns(model%mesh, [.false., .false.])
    call suite%that('all present: node 13 alone', all(is_alone .eqv. [(i > 36, i=1, 39)]))
    is_alone = find_unconnected_unknowns(model%mesh, [.false., .true.])
    call suite%that('one absent: its own nodes too', all(is_alone .eqv. [(i > 24, i=1, 39)]))
    is_alone = find_unconnected_unknowns(model%mesh, [.true., .true.])
    call suite%that('both absent: all', all(is_alone))
  end subroutine check_unconnected


  !> An element that is put back starts at the displacement of its nodes, with no history; the other keeps its own; trial as
  !! committed. A step that puts none back changes nothing.
  subroutine check_activated(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(state_type) :: state
    type(slave_state_type) :: none(0)
    integer :: i
    call two_cubes(model)
    call create_state(state, model%mesh, none)
    state%old%u = reshape([(real(i, DP), i=1, 39)], [3, 13])
    deallocate (state%old%history)
    allocate (state%old%history(2, model%mesh%n_points), source=5.0_DP)
    allocate (state%old%birth_displacement(3, 16), source=-1.0_DP)
    call activate_elements(model, 2, state)
    call suite%near('no change: births', sum(abs(state%old%birth_displacement + 1.0_DP)), 0.0_DP, 0.0_DP)
    model%steps(2)%is_reactivated = [.false., .true.]
    call activate_elements(model, 1, state)
    call suite%near('another step: births', sum(abs(state%old%birth_displacement + 1.0_DP)), 0.0_DP, 0.0_DP)
    call activate_elements(model, 2, state)
    call suite%near('put back: where its nodes are', sum(abs(state%old%birth_displacement(:, 9:) - state%old%u(:, 5:12))), &
      0.0_DP, 0.0_DP)
    call suite%near('put back: not the other', sum(abs(state%old%birth_displacement(:, :8) + 1.0_DP)), 0.0_DP, 0.0_DP)
    associate (first => model%mesh%point_first)
      call suite%near('put back: no history', sum(abs(state%old%history(:, first(2):first(3) - 1))), 0.0_DP, 0.0_DP)
      call suite%near('put back: but of the other', minval(state%old%history(:, :first(2) - 1)), 5.0_DP, 0.0_DP)
    end associate
    call suite%near('put back: trial as committed', norm2(state%new%u - state%old%u) + norm2(state%new%history &
      - state%old%history), 0.0_DP, 0.0_DP)
  end subroutine check_activated

end program test_model_change
