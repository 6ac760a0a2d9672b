!> Unit test of face_proximity: which faces are near, the boxes of the search, and the faces that are close to another body.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_face_proximity
  use amontons_kinds, only: DP
  use amontons_exterior_surface, only: exterior_type
  use amontons_facets, only: facets_type
  use amontons_facet_search, only: facet_search_type, find_near_facets
  use amontons_face_proximity, only: are_near, compare_faces, box_distance, find_active_faces, list_facets, exterior_positions, &
    build_face_search, is_larger
  use amontons_rigid_exterior, only: SHEETS_FACE, SHEETS_BEHIND, SHEETS_UNDECIDED
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-14_DP          !< rounding of a few terms
  type(suite_type) :: suite
  call check_near()
  call check_heights()
  call check_sheets()
  call check_boxes()
  call suite%finish()

contains

  !> Two squares of edge 1 that oppose each other, at a gap and a lateral offset, on elements of a depth.
  function two_squares(gap, offset, depth, side) result(exterior)
    real(DP), intent(in) :: gap, offset, depth     !< [length]
    real(DP), intent(in) :: side                   !< 1: they face each other, -1: the far sides
    type(exterior_type) :: exterior
    integer :: i
    exterior%n = 2
    exterior%n_bodies = 2
    exterior%body = [1, 2]
    exterior%first = [1, 5, 9]
    exterior%n_corners = [4, 4]
    exterior%nodes = [(i, i=1, 8)]
    exterior%x = reshape([0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, &
      offset, 0.0_DP, gap, offset + 1, 0.0_DP, gap, offset + 1, 1.0_DP, gap, offset, 1.0_DP, gap], [3, 8])
    exterior%centre = reshape([0.5_DP, 0.5_DP, 0.0_DP, 0.5_DP + offset, 0.5_DP, gap], [3, 2])
    exterior%normal = side * reshape([0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, -1.0_DP], [3, 2])
    exterior%box = reshape([exterior%x(:, 1), exterior%x(:, 3), exterior%x(:, 5), exterior%x(:, 7)], [3, 2, 2])
    exterior%edge_length = [1.0_DP, 1.0_DP]
    exterior%area = [1.0_DP, 1.0_DP]
    exterior%depth = [depth, depth]
    exterior%thickness = [depth, depth]
    exterior%height = [0.0_DP, 0.0_DP]
  end function two_squares


  !> The gap, the offset, the side and the depth.
  subroutine check_near()
    type(exterior_type) :: exterior
    call suite%that('within the radius', are_near(two_squares(2.9_DP, 0.0_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
    call suite%that('beyond', .not. are_near(two_squares(3.1_DP, 0.0_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
    call suite%that('with motion', are_near(two_squares(3.1_DP, 0.0_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.2_DP))
    call suite%that('beside', .not. are_near(two_squares(0.1_DP, 2.5_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
    call suite%that('overlapping', are_near(two_squares(-0.5_DP, 0.0_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
    call suite%that('behind', .not. are_near(two_squares(-0.95_DP, 0.0_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
    call suite%that('side faces in a stack', .not. are_near(two_squares(-0.5_DP, 1.0_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
    call suite%that('that overlap', are_near(two_squares(-0.5_DP, 0.9_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
    call suite%that('in front, beside', are_near(two_squares(0.1_DP, 1.0_DP, 1.0_DP, 1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
    exterior = two_squares(-0.95_DP, 0.0_DP, 0.5_DP, 1.0_DP)
    exterior%thickness = [1.5_DP, 0.5_DP]
    call suite%that('one of two bodies is thin', .not. are_near(exterior, 1, 2, 3.0_DP, 0.0_DP))
    exterior%thickness = [1.5_DP, 1.5_DP]
    exterior%edge_length = [1.2_DP, 1.2_DP]
    call suite%that('an edge reaches through layers', are_near(exterior, 1, 2, 3.0_DP, 0.0_DP))
    call suite%that('far sides', .not. are_near(two_squares(1.0_DP, 0.0_DP, 0.5_DP, -1.0_DP), 1, 2, 3.0_DP, 0.0_DP))
  end subroutine check_near


  !> Surfaces before their faces are nearer; surfaces behind them let the faces overlap.
  subroutine check_heights()
    type(exterior_type) :: squares
    squares = two_squares(3.1_DP, 0.0_DP, 1.0_DP, 1.0_DP)
    squares%height = [0.1_DP, 0.1_DP]
    call suite%that('before', are_near(squares, 1, 2, 3.0_DP, 0.0_DP))
    squares = two_squares(-0.95_DP, 0.0_DP, 1.0_DP, 1.0_DP)
    squares%height = [-0.1_DP, 0.0_DP]
    call suite%that('behind', are_near(squares, 1, 2, 3.0_DP, 0.0_DP))
  end subroutine check_heights


  !> Faces without depth: facing, the far sides, in one plane, beside each other in one plane.
  subroutine check_sheets()
    real(DP), parameter :: THIN = 1.0e-6_DP
    call suite%that('face', compare_faces(two_squares(0.1_DP, 0.0_DP, THIN, 1.0_DP), 1, 2) == SHEETS_FACE)
    call suite%that('far', compare_faces(two_squares(0.1_DP, 0.0_DP, THIN, -1.0_DP), 1, 2) == SHEETS_BEHIND)
    call suite%that('far, with motion', .not. are_near(two_squares(0.1_DP, 0.0_DP, THIN, -1.0_DP), 1, 2, 3.0_DP, 5.0_DP))
    call suite%that('one plane', compare_faces(two_squares(THIN, 0.5_DP, THIN, 1.0_DP), 1, 2) == SHEETS_UNDECIDED)
    call suite%that('apart', compare_faces(two_squares(THIN, 1.5_DP, THIN, 1.0_DP), 1, 2) == SHEETS_BEHIND)
    call suite%that('with depth', compare_faces(two_squares(0.0_DP, 0.0_DP, 1.0_DP, 1.0_DP), 1, 2) == SHEETS_FACE)
  end subroutine check_sheets


  !> Distances of boxes, the faces within a distance of another body, and the boxes as facets of two nodes.
  subroutine check_boxes()
    type(exterior_type) :: squares
    type(facets_type) :: facets
    logical, allocatable :: is_active(:)
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    integer :: n
    squares = two_squares(4.0_DP, 4.0_DP, 1.0_DP, 1.0_DP)
    call suite%near('diagonal', box_distance(squares%box(:, :, 1), squares%box(:, :, 2)), 5.0_DP, TOL)
    call find_active_faces(squares, 4.9_DP, is_active)
    call suite%that('too far', .not. any(is_active))
    call find_active_faces(squares, 5.1_DP, is_active)
    call suite%that('within', all(is_active))
    squares%area(1) = 1.0e-6_DP
    call find_active_faces(squares, 5.1_DP, is_active)
    call suite%that('without area', .not. is_active(1) .and. is_active(2))
    call list_facets(2, facets)
    call suite%that('two nodes each', facets%n == 2 .and. all(facets%first == [1, 3, 5]))
    call build_face_search(squares, [1, 2], 0.0_DP, 4.0_DP, search)
    call find_near_facets(search, squares%centre(:, 1), list, n)
    call suite%that('within a distance', n == 2)
    squares%edge_length(2) = 0.1_DP              ! only its own size widens the box of a face
    call build_face_search(squares, [1, 2], 3.5_DP, 0.0_DP, search)
    call find_near_facets(search, squares%centre(:, 2), list, n)
    call suite%that('the large one, from the small one', all(list(:n) == [1, 2]))
    call find_near_facets(search, squares%centre(:, 1), list, n)
    call suite%that('but not the other way', all(list(:n) == [1]))
    call suite%that('of two faces one is larger', is_larger(squares, 1, 2) .and. .not. is_larger(squares, 2, 1))
    call suite%that('corners of boxes', all(abs(exterior_positions(squares, [2]) - squares%box(:, :, 2)) <= 0.0_DP))
  end subroutine check_boxes

end program test_face_proximity
