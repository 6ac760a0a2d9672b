!> Tests of mid-side nodes of slave faces: they follow closed corners of their own pair, and each is released once in an attempt.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_midside_constraints
  use amontons_midside_constraints, only: midsides_type, append_midsides, hold_all_midsides, begin_midsides, update_midsides
  use amontons_state, only: slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_pairs(suite)
  call check_attempt(suite)
  call suite%finish()

contains

  !> Mid-side node 7 between corners 1 and 2, slaves 1 and 2 of a first pair, and 3 and 4 of a second; node 8 between 2 and 3 of the
  !! second pair, whose corner 3 is no slave.
  subroutine make_midsides(midsides)
    type(midsides_type), intent(out) :: midsides
    call append_midsides(midsides, reshape([7, 1, 2], [3, 1]), reshape([1, 2], [2, 1]))
    call append_midsides(midsides, reshape([7, 1, 2, 8, 2, 3], [3, 2]), reshape([3, 4, 4, 0], [2, 2]))
  end subroutine make_midsides


  !> A closed corner holds the mid-side nodes of its own pair; a node of two pairs is listed once.
  subroutine check_pairs(suite)
    type(suite_type), intent(inout) :: suite
    type(midsides_type) :: midsides
    type(slave_state_type) :: slaves(4)
    logical :: is_changed
    call make_midsides(midsides)
    call suite%that('all at first', all(midsides%held(1, :) == [7, 8]))
    slaves%status = STATUS_OPEN
    call begin_midsides(midsides, slaves, is_changed)
    call suite%that('none beside open corners', is_changed .and. size(midsides%held, 2) == 0)
    slaves(2)%status = STATUS_STICK                ! at the corner that the second pair shares
    call update_midsides(midsides, slaves, is_changed)
    call suite%that('of its own pair', is_changed .and. size(midsides%held, 2) == 1)
    call suite%that('with its corners', all(midsides%held(:, 1) == [7, 1, 2]))
    slaves(4)%status = STATUS_SLIP
    call update_midsides(midsides, slaves, is_changed)
    call suite%that('of both pairs, once', is_changed .and. all(midsides%held(1, :) == [7, 8]))
    slaves(2)%status = STATUS_OPEN
    call update_midsides(midsides, slaves, is_changed)
    call suite%that('the other pair holds it', .not. is_changed .and. size(midsides%held, 2) == 2)
  end subroutine check_pairs


  !> A node that is released by an opened corner and then held again stays held until the next attempt.
  subroutine check_attempt(suite)
    type(suite_type), intent(inout) :: suite
    type(midsides_type) :: midsides
    type(slave_state_type) :: slaves(4)
    logical :: is_changed
    call make_midsides(midsides)
    slaves%status = STATUS_OPEN
    slaves(1)%status = STATUS_STICK
    call begin_midsides(midsides, slaves, is_changed)
    call update_midsides(midsides, slaves, is_changed)
    call suite%that('nothing new', .not. is_changed)
    slaves%status = STATUS_OPEN
    call update_midsides(midsides, slaves, is_changed)
    call suite%that('released', is_changed .and. size(midsides%held, 2) == 0)
    slaves(1)%status = STATUS_SLIP
    call update_midsides(midsides, slaves, is_changed)
    call suite%that('held again', is_changed .and. size(midsides%held, 2) == 1)
    slaves%status = STATUS_OPEN
    call update_midsides(midsides, slaves, is_changed)
    call suite%that('and not released again', .not. is_changed .and. size(midsides%held, 2) == 1)
    call begin_midsides(midsides, slaves, is_changed)
    call suite%that('but in the next attempt', is_changed .and. size(midsides%held, 2) == 0)
    call hold_all_midsides(midsides)
    call suite%that('all', size(midsides%held, 2) == 2)
  end subroutine check_attempt

end program test_midside_constraints
