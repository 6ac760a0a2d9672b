!> Unit test of facet_crossing: planes of faces, points within them, and where a segment passes through.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_facet_crossing
  use amontons_kinds, only: DP
  use amontons_facet_crossing, only: plane_normal, is_inside_facet, cross_facet
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
  call suite%finish()

contains

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
