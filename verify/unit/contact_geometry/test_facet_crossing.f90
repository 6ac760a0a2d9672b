!> Unit test of facet_crossing: planes of faces, points within them, and where a segment passes through.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_facet_crossing
  use amontons_kinds, only: DP
  use amontons_facet_crossing, only: plane_normal, is_inside_facet, cross_facet, distance_along
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TINY_LENGTH = 1.0e-14_DP  !< rounding of lengths of about 1
  real(DP), parameter :: SQUARE(3, 4) = reshape([0.0_DP, 0.0_DP, 2.0_DP, 1.0_DP, 0.0_DP, 2.0_DP, 1.0_DP, 1.0_DP, 2.0_DP, &
    0.0_DP, 1.0_DP, 2.0_DP], [3, 4])
  real(DP), parameter :: UP(3) = [0.0_DP, 0.0_DP, 1.0_DP]
  real(DP), parameter :: LINE(3, 2) = reshape([0.0_DP, 0.0_DP, 0.0_DP, 2.0_DP, 0.0_DP, 0.0_DP], [3, 2])
  type(suite_type) :: suite
  call suite%near('normal of a square', norm2(plane_normal(SQUARE, .false.) - UP), 0.0_DP, TINY_LENGTH)
  call suite%near('normal of a triangle', norm2(plane_normal(SQUARE(:, :3), .false.) - UP), 0.0_DP, TINY_LENGTH)
  call suite%near('normal of a line', norm2(plane_normal(LINE, .true.) - [0.0_DP, -1.0_DP, 0.0_DP]), 0.0_DP, TINY_LENGTH)
  call suite%that('inside', is_inside_facet([0.9_DP, 0.1_DP, 2.0_DP], SQUARE, UP, .false.))
  call suite%that('outside', .not. is_inside_facet([1.1_DP, 0.1_DP, 2.0_DP], SQUARE, UP, .false.))
  call cross('through the square', SQUARE, [0.5_DP, 0.5_DP, 1.0_DP], [0.9_DP, 0.5_DP, 5.0_DP], [0.6_DP, 0.5_DP, 2.0_DP])
  call cross('the same backwards', SQUARE, [0.9_DP, 0.5_DP, 5.0_DP], [0.5_DP, 0.5_DP, 1.0_DP], [0.6_DP, 0.5_DP, 2.0_DP])
  call cross('ends before it', SQUARE, [0.5_DP, 0.5_DP, 3.0_DP], [0.5_DP, 0.5_DP, 2.1_DP])
  call cross('beside it', SQUARE, [1.5_DP, 0.5_DP, 1.0_DP], [1.5_DP, 0.5_DP, 5.0_DP])
  call cross('through a line', LINE, [1.0_DP, -1.0_DP, 0.0_DP], [2.0_DP, 1.0_DP, 0.0_DP], [1.5_DP, 0.0_DP, 0.0_DP])
  call cross('beside a line', LINE, [2.0_DP, -1.0_DP, 0.0_DP], [3.0_DP, 1.0_DP, 0.0_DP])
  call check_rays()
  call suite%finish()

contains

  !> The way of a ray to a face where it leaves a body; huge before a face that looks at it, beside it and along it.
  subroutine check_rays()
    real(DP), parameter :: DOWN(3) = -UP, SLANTED(3) = [0.6_DP, 0.0_DP, 0.8_DP], ALONG(3) = [1.0_DP, 0.0_DP, 0.0_DP]
    real(DP), parameter :: BELOW(3) = [0.1_DP, 0.5_DP, 1.2_DP], FROM(3) = [1.0_DP, 1.5_DP, 0.0_DP]
    real(DP), parameter :: OUT(3) = [0.0_DP, -1.0_DP, 0.0_DP]
    call suite%near('a ray leaves', distance_along(BELOW, UP, UP, SQUARE), 0.8_DP, TINY_LENGTH)
    call suite%near('a slanted one', distance_along(BELOW, SLANTED, UP, SQUARE), 1.0_DP, TINY_LENGTH)
    call suite%near('it leaves a body in the plane', distance_along(FROM, OUT, OUT, LINE), 1.5_DP, TINY_LENGTH)
    call suite%near('at an edge', distance_along([1.0_DP, 0.5_DP, 0.0_DP], UP, UP, SQUARE), 2.0_DP, TINY_LENGTH)
    call suite%that('the face looks at the ray', distance_along(BELOW, UP, DOWN, SQUARE) >= huge(1.0_DP))
    call suite%that('the face is behind', distance_along([0.1_DP, 0.5_DP, 2.2_DP], UP, UP, SQUARE) >= huge(1.0_DP))
    call suite%that('beside the face', distance_along([1.1_DP, 0.5_DP, 1.2_DP], UP, UP, SQUARE) >= huge(1.0_DP))
    call suite%that('along the face', distance_along(BELOW, ALONG, UP, SQUARE) >= huge(1.0_DP))
  end subroutine check_rays


  !> A segment crosses a face at a point; without one it does not.
  subroutine cross(title, corner, a, b, expected)
    character(*), intent(in) :: title
    real(DP), intent(in) :: corner(:, :), a(3), b(3)   !< [length]
    real(DP), intent(in), optional :: expected(3)
    logical :: is_crossed
    real(DP) :: point(3)
    call cross_facet(corner, reshape([a, b], [3, 2]), is_crossed, point)
    call suite%that(title, is_crossed .eqv. present(expected))
    if (present(expected)) call suite%near(title, norm2(point - expected), 0.0_DP, TINY_LENGTH)
  end subroutine cross

end program test_facet_crossing
