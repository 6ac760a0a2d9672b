!> Unit test of master_symmetry_planes: normals of a flat master at supported edges, and the supports that count.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_master_symmetry_planes
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_facets, only: facets_type
  use amontons_kinds, only: DP
  use amontons_master_symmetry_planes, only: find_symmetry_planes, find_fixed_directions
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  integer, parameter :: CORNER = 10, SIDE = 13, OTHER_CORNER = 16, MIDDLE = 14   ! nodes of the master; the first three on x = -1.2
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  logical, allocatable :: is_fixed(:, :)
  call two_blocks(model, 0.3_DP, 0.1_DP, [0.0_DP, 0.0_DP, -0.1_DP])
  call start_blocks(model, system, state)
  allocate (is_fixed(3, model%mesh%n_nodes))
  call check_plane()
  call check_exceptions()
  call check_supports()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> The diagonal of a node's projector for the supports in is_fixed; the other entries vanish.
  function diagonal(node) result(values)
    integer, intent(in) :: node
    real(DP) :: values(3), projector(3, 3)
    integer :: k
    associate (facets => system%contact%facets(1))
      if (allocated(facets%symmetry_projector)) deallocate (facets%symmetry_projector)
      call find_symmetry_planes(facets, model, is_fixed)
      projector = facets%symmetry_projector(:, :, facets%vertex(findloc(facets%nodes, node, dim=1)))
    end associate
    values = [(projector(k, k), k=1, 3)]
    call suite%that('diagonal', sum(abs(projector)) <= sum(values))
  end function diagonal


  !> An edge that supports hold along x at all its nodes lies on a symmetry plane: its normals lose their part along x.
  subroutine check_plane()
    is_fixed = .false.
    is_fixed(1, [CORNER, SIDE, OTHER_CORNER]) = .true.
    call suite%that('corner', all(diagonal(CORNER) == [0.0_DP, 1.0_DP, 1.0_DP]))
    call suite%that('side', all(diagonal(SIDE) == [0.0_DP, 1.0_DP, 1.0_DP]))
    call suite%that('not inside', all(diagonal(MIDDLE) == [1.0_DP, 1.0_DP, 1.0_DP]))
    is_fixed(2, [CORNER, 11, 12]) = .true.
    call suite%that('two planes meet in the corner', all(diagonal(CORNER) == [0.0_DP, 0.0_DP, 1.0_DP]))
    call suite%that('one at the side', all(diagonal(SIDE) == [0.0_DP, 1.0_DP, 1.0_DP]))
  end subroutine check_plane


  !> No plane: a node of the edge is free, an inner edge, the direction of the normal is held.
  subroutine check_exceptions()
    is_fixed = .false.
    is_fixed(1, [CORNER, OTHER_CORNER]) = .true.
    call suite%that('a node between is free', all(diagonal(CORNER) == [1.0_DP, 1.0_DP, 1.0_DP]))
    is_fixed = .false.
    is_fixed(1, [11, MIDDLE, 17]) = .true.
    call suite%that('the line in the middle', all(diagonal(MIDDLE) == [1.0_DP, 1.0_DP, 1.0_DP]))
    is_fixed = .false.
    is_fixed(:, [CORNER, SIDE, OTHER_CORNER]) = .true.
    call suite%that('clamped', all(diagonal(SIDE) == [1.0_DP, 1.0_DP, 1.0_DP]))
  end subroutine check_exceptions


  !> Supports count by their owner, a negative number; equations do not.
  subroutine check_supports()
    integer :: owner(3 * model%mesh%n_nodes)
    owner = 0
    owner(4) = -1
    owner(9) = -1
    owner(12) = 7
    call find_fixed_directions(model, model%steps(1), owner, is_fixed)
    call suite%that('two supports', count(is_fixed) == 2)
    call suite%that('of nodes 2 and 3', is_fixed(1, 2) .and. is_fixed(3, 3))
  end subroutine check_supports

end program test_master_symmetry_planes
