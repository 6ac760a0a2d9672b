!> Unit test of result_cells: bodies are elements that share nodes, directly or by others, numbered in the order of the elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_result_cells
  use amontons_mesh, only: mesh_type
  use amontons_result_cells, only: number_bodies
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(mesh_type) :: mesh
  mesh%n_nodes = 9
  mesh%n_elements = 5
  mesh%first = [1, 3, 5, 7, 9, 10]
  mesh%nodes = [8, 9, 1, 2, 3, 4, 2, 4, 5]            ! lines 8-9, 1-2, 3-4; 2-4 joins the last two; a point at 5
  call suite%that('a chain is one body', all(number_bodies(mesh) == [1, 2, 2, 2, 3]))
  mesh%nodes(7:8) = [6, 7]
  call suite%that('without the link it is two', all(number_bodies(mesh) == [1, 2, 3, 4, 5]))
  mesh%nodes(9) = 9
  call suite%that('a point belongs to the body at its node', all(number_bodies(mesh) == [1, 2, 3, 4, 1]))
  call suite%finish()
end program test_result_cells
