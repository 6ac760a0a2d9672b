!> Unit test of exterior_membership: the exterior faces of surfaces, and those that a tie holds.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_exterior_membership
  use amontons_exterior_membership, only: find_members, find_tie_lines, find_tied_faces, find_uncounted_elements
  use amontons_exterior_surface, only: exterior_type, build_exterior
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type, new_equation
  use amontons_state, only: state_type
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  integer, parameter :: LINE = 7                     ! of the tie in the deck
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  type(exterior_type) :: exterior
  integer :: no_pairs(2, 0)
  call two_blocks(model, 0.0_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.1_DP])
  call start_blocks(model, system, state)
  call build_exterior(model%mesh, spread(.false., 1, model%mesh%n_elements), no_pairs, exterior)
  call check_members()
  call check_tied()
  call check_added()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> The surface of faces and that of its nodes have the same faces.
  subroutine check_members()
    associate (is_in => find_members(model, exterior, model%surfaces(1)))
      call suite%that('nine faces of the slave', count(is_in) == 9 .and. all(pack(exterior%element, is_in) > 4) .and. &
        all(pack(exterior%face, is_in) == 1))
      model%surfaces(1)%is_node_based = .true.
      call suite%that('the same by nodes', all(is_in .eqv. find_members(model, exterior, model%surfaces(1))))
    end associate
    model%surfaces(1)%is_node_based = .false.
  end subroutine check_members


  !> Without ties no node is held. A tie holds one corner of the slave: one face of its surface. An equation holds none.
  subroutine check_tied()
    call suite%that('no ties', all(find_tie_lines(model) == 0))
    allocate (model%ties(1))
    model%ties(1)%slave = 1
    model%ties(1)%master = 2
    model%ties(1)%line = LINE
    model%equations = [new_equation([19, 10], [3, 3], [1.0_DP, -1.0_DP], 'TIE', LINE), &
      new_equation([34, 18], [3, 3], [1.0_DP, -1.0_DP], 'EQUATION', LINE - 1), &
      new_equation([33, 18], [3, 3], [1.0_DP, -1.0_DP], 'EQUATION', LINE + 1)]
    associate (tie_line => find_tie_lines(model))
      call suite%that('the tied node alone', tie_line(19) == LINE .and. count(tie_line /= 0) == 1)
      associate (is_tied => find_tied_faces(model, exterior, model%ties(1), tie_line))
        call suite%that('its face', count(is_tied) == 1 .and. all(pack(exterior%element, is_tied) == 5) .and. &
          all(pack(exterior%face, is_tied) == 1))
      end associate
    end associate
  end subroutine check_tied


  !> The slave block, 5 to 13, is removed in the first step: it counts if the second one adds it. Of the master an element goes,
  !! with whose others it is one body: it does not count.
  subroutine check_added()
    integer :: i
    call suite%that('all count', .not. any(find_uncounted_elements(model, 1)))
    model%steps = [model%steps, model%steps]
    model%steps(1)%is_inactive = [(i == 1 .or. i > 4, i=1, 13)]
    model%steps(2)%is_inactive = spread(.false., 1, 13)
    call suite%that('the body that is added', all(find_uncounted_elements(model, 1) .eqv. [(i == 1, i=1, 13)]))
    model%steps(2)%is_inactive(5:) = .true.
    call suite%that('not one that is never there', all(find_uncounted_elements(model, 1) .eqv. model%steps(1)%is_inactive))
  end subroutine check_added

end program test_exterior_membership
