!> Unit test of amontons_structural_data: weights of a director, and the nodes of several.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_structural_data
  use amontons_kinds, only: DP
  use amontons_structural_data, only: structure_type, director_type, find_node_directors, expanded_nodes, mean_weights, &
    force_weights
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_weights()
  call check_search()
  call suite%finish()

contains

  !> Weights sum to 1 and, under the abaqus dialect, give the place of the node in the section.
  subroutine check_weights()
    type(director_type) :: director
    real(DP), parameter :: PLACES(2, 4) = 0.5_DP * reshape([real(DP) :: -1, 1, -1, -1, 1, -1, 1, 1], [2, 4])
    director = director_type(node=1, n_outer=2, nodes=[2, 3], offset=[0.25_DP, 0.0_DP])
    allocate (director%height(0:1), source=[-0.5_DP, 0.5_DP])
    call suite%near('fibre', maxval(abs(mean_weights(director, .false., .false.) - [0.25_DP, 0.75_DP])), 0.0_DP, 1.0e-15_DP)
    call suite%near('calculix: the mean', sum(abs(mean_weights(director, .true., .false.) - [0.5_DP, 0.5_DP])), 0.0_DP, 1.0e-15_DP)
    director%nodes = [2, 3, 4]
    director%offset = 0
    call suite%near('Simpson', sum(mean_weights(director, .false., .false.) * [real(DP) :: 0, 0, 1]), 2.0_DP / 3, 1.0e-15_DP)
    call suite%near('sum', sum(mean_weights(director, .false., .false.)), 1.0_DP, 1.0e-15_DP)
    call suite%near('constrained: bottom and top', sum(abs(mean_weights(director, .true., .true.) - [0.5_DP, 0.5_DP, 0.0_DP])), &
      0.0_DP, 1.0e-15_DP)
    call suite%near('its force', sum(abs(force_weights(director, .true., .true.) - [0.5_DP, 0.5_DP, 0.0_DP])), 0.0_DP, 1.0e-15_DP)
    call suite%near('shares of a force', sum(abs(force_weights(director, .false., .false.))), 3.0_DP, 1.0e-15_DP)
    call suite%near('all of it', sum(force_weights(director, .false., .false.)), 1.0_DP, 1.0e-15_DP)
    deallocate (director%height)
    allocate (director%height(0:3), source=[-0.5_DP, -0.25_DP, 0.25_DP, 0.5_DP])
    director%nodes = [2, 3, 4, 5]
    director%offset = [0.375_DP, 0.0_DP]
    call suite%near('layers', sum(abs(mean_weights(director, .false., .false.) - [0.0_DP, 0.5_DP, 0.0_DP, 0.5_DP])), 0.0_DP, &
      1.0e-15_DP)
    director%offset = [-0.75_DP, 0.0_DP]
    call suite%near('beyond them', sum(abs(mean_weights(director, .false., .false.) - [2.0_DP, 0.0_DP, -1.0_DP, 0.0_DP])), 0.0_DP, &
      1.0e-15_DP)
    call suite%near('their force', sum(force_weights(director, .false., .false.)), 1.0_DP, 1.0e-15_DP)
    director%n_outer = 4
    director%offset = [0.3_DP, -0.2_DP]
    associate (weight => mean_weights(director, .false., .false.))
      call suite%near('cross-section', norm2(matmul(PLACES, weight(:4)) - director%offset), 0.0_DP, 1.0e-15_DP)
    end associate
  end subroutine check_weights


  !> Nodes with none, one and two directors.
  subroutine check_search()
    type(structure_type) :: structure
    integer :: first, last
    allocate (structure%directors(3))
    structure%directors%node = [2, 5, 5]
    structure%directors(1)%nodes = [11, 12]
    structure%directors(2)%nodes = [13, 14]
    structure%directors(3)%nodes = [15, 16]
    call find_node_directors(structure, 5, first, last)
    call suite%that('two', first == 2 .and. last == 3)
    call find_node_directors(structure, 3, first, last)
    call suite%that('none', last < first)
    call find_node_directors(structure, 9, first, last)
    call suite%that('none behind', last < first)
    call suite%that('all nodes', all(expanded_nodes(structure, [2, 3, 5]) == [2, 3, 5, 11, 12, 13, 14, 15, 16]))
  end subroutine check_search

end program test_structural_data
