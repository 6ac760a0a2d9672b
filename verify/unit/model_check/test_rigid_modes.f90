!> Unit test of amontons_rigid_modes: motions in simple combinations and in words.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_rigid_modes
  use amontons_kinds, only: DP
  use amontons_model_check_bodies, only: body_type
  use amontons_rigid_modes, only: simplify_motions, motions_text, is_translation, MIN_MOTION_PART
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_simplify()
  call check_words()
  call suite%finish()

contains

  !> Mixed motions become the plain ones, translations first; the space that they span stays.
  subroutine check_simplify()
    real(DP) :: motions(6, 2), plain(6, 2)
    plain = 0
    plain(1, 1) = 1
    plain(6, 2) = 1
    motions(:, 1) = 0.6_DP * plain(:, 1) + 0.8_DP * plain(:, 2)
    motions(:, 2) = -0.8_DP * plain(:, 1) + 0.6_DP * plain(:, 2)
    call simplify_motions(motions)
    call suite%near('along x, then about z', norm2(motions - plain), 0.0_DP, 1.0e-14_DP)
    call suite%that('a translation', is_translation(motions(:, 1)) .and. .not. is_translation(motions(:, 2)))
    call suite%that('nearly one', is_translation([1.0_DP, 0.0_DP, 0.0_DP, 0.5_DP * MIN_MOTION_PART, 0.0_DP, 0.0_DP]))
  end subroutine check_simplify


  !> What a person reads.
  subroutine check_words()
    type(body_type) :: body
    real(DP) :: motions(6, 6)
    integer :: i
    motions = 0
    do i = 1, 6
      motions(i, i) = 1
    end do
    body%size = 2
    body%centre = [1.0_DP, 0.0_DP, 0.0_DP]
    call suite%that('all', motions_text(body, motions, spread(.true., 1, 6)) == 'move and turn freely')
    call suite%that('one', motions_text(body, motions(:, 2:2), [.true.]) == 'move along y')
    call suite%that('a turn', motions_text(body, motions(:, 6:6), [.true.]) == 'turn about z through its centre')
    call suite%that('translations first', motions_text(body, motions(:, [5, 1]), [.true., .true.]) &
      == 'move along x and turn about y through its centre')
    call suite%that('of those that count', motions_text(body, motions(:, [5, 1]), [.true., .false.]) &
      == 'turn about y through its centre')
    motions(:, 1) = [0.6_DP, -0.8_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    call suite%that('a direction', index(motions_text(body, motions(:, 1:1), [.true.]), '0.8') > 0)
    motions(3, 6) = 1
    call suite%that('a screw', index(motions_text(body, motions(:, 6:6), [.true.]), 'while it moves along it') > 0)
  end subroutine check_words

end program test_rigid_modes
