!> Unit test of contact_step: settings of a step, and faces of removed elements on both sides of a pair.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_step
  use amontons_contact_step, only: begin_contact_step, find_faceless_slaves
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_facet_search, only: build_facet_search, find_near_facets
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  integer, parameter :: N_MASTER = 4                 ! elements of the master, which have the first numbers; 9 of the slave follow
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_step()
  call check_removed_slaves(.false.)
  call check_removed_slaves(.true.)
  call check_removed_masters()
  call suite%finish()

contains

  include 'sliding_blocks.inc'

  !> Laws, removed pairs and interferences of a step; without them those of the model.
  subroutine check_step()
    type(step_type) :: step
    call start(0.05_DP)
    step = model%steps(1)
    step%interactions = model%interactions
    step%interactions(1)%friction = 0.75_DP
    step%is_removed = [.true.]
    step%interference = [0.02_DP]
    step%is_shrink_fit = [.true.]
    step%period = 4
    call begin_contact_step(system%contact, model, step)
    associate (c => system%contact)
      call suite%near('law, interference, period', abs(c%laws(1)%friction - 0.75_DP) + abs(c%interference(1) - 0.02_DP) + &
        abs(c%period - 4), 0.0_DP, 0.0_DP)
      call suite%that('removed, shrink fit', c%is_removed(1) .and. c%is_shrink_fit(1))
      call begin_contact_step(c, model, model%steps(1))
      call suite%near('those of the model', abs(c%laws(1)%friction - 0.3_DP) + abs(c%interference(1)), 0.0_DP, 0.0_DP)
      call suite%that('not removed', .not. (c%is_removed(1) .or. c%is_shrink_fit(1)))
    end associate
  end subroutine check_step


  !> One element of the slave surface removed: its corner of the surface has no face left, of a surface of nodes no element; all
  !! removed: no node has. In the next step all are back.
  subroutine check_removed_slaves(is_node_based)
    logical, intent(in) :: is_node_based
    type(step_type) :: step
    call start(0.05_DP)
    model%surfaces(1)%is_node_based = is_node_based
    step = model%steps(1)
    allocate (step%is_inactive(model%mesh%n_elements), source=.false.)
    step%is_inactive(N_MASTER + 1) = .true.
    call begin_contact_step(system%contact, model, step)
    associate (is_faceless => find_faceless_slaves(system%contact, model, state%new%slaves))
      call suite%that('the node of the corner alone', is_faceless(1) .and. count(is_faceless) == 1)
    end associate
    step%is_inactive(N_MASTER + 1:) = .true.
    call begin_contact_step(system%contact, model, step)
    call suite%that('all of them', all(find_faceless_slaves(system%contact, model, state%new%slaves)))
    call begin_contact_step(system%contact, model, model%steps(1))
    call suite%that('none', .not. any(find_faceless_slaves(system%contact, model, state%new%slaves)))
  end subroutine check_removed_slaves


  !> One element of the master removed: no search finds its facet, but the others; all removed: it finds none.
  subroutine check_removed_masters()
    type(step_type) :: step
    integer, allocatable :: list(:)
    integer :: n
    call start(0.05_DP)
    step = model%steps(1)
    allocate (step%is_inactive(model%mesh%n_elements), source=.false.)
    step%is_inactive(1) = .true.
    call search_all(step, list, n)
    call suite%that('three facets', n == N_MASTER - 1 .and. all(list(:n) == [2, 3, 4]))
    step%is_inactive(:N_MASTER) = .true.
    call search_all(step, list, n)
    call suite%that('no facet', n == 0)
    call search_all(model%steps(1), list, n)
    call suite%that('all facets', n == N_MASTER)
  end subroutine check_removed_masters


  !> The facets of the master found from its middle within more than its size.
  subroutine search_all(step, list, n)
    type(step_type), intent(in) :: step
    integer, allocatable, intent(out) :: list(:)
    integer, intent(out) :: n
    call begin_contact_step(system%contact, model, step)
    associate (facets => system%contact%facets(1), x => model%mesh%coordinates)
      call build_facet_search(facets, x, 10.0_DP, system%contact%search(1))
      call find_near_facets(system%contact%search(1), x(:, 14), list, n)
    end associate
  end subroutine search_all

end program test_contact_step
