!> Unit test of failure: each code has the family that decides the remedy.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_failure
  use amontons_failure, only: failure_type, family_of, FAILURE_NONE, FAILURE_MATERIAL, FAILURE_SINGULAR, FAILURE_NOT_FINITE, &
    FAILURE_CONSTRAINTS, FAILURE_FREE_PUSHED, FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, FAILURE_FREE_MOTION, FAILURE_LEFT_MASTER, &
    FAILURE_CYCLE, FAILURE_FLIP, FAILURE_UNSETTLED, FAILURE_PASSED_THROUGH, FAILURE_DEEP, FAILURE_LIMIT_POINT, &
    FAILURE_CONTACT_LIMIT, FAILURE_GROWING, FAILURE_SLOW, FAILURE_USER_ROUTINE, FAILURE_SIGNAL, FAILURE_CROSSING, FAILURE_CREEP, &
    N_FAILURES, &
    FAMILY_NONE, &
    FAMILY_MATERIAL, FAMILY_SOLVER, FAMILY_CONSTRAINTS, FAMILY_FREE_BODY, FAMILY_LEFT_MASTER, FAMILY_CYCLE, FAMILY_FLIP, &
    FAMILY_UNSETTLED, FAMILY_PENETRATION, FAMILY_LIMIT_POINT, FAMILY_SLOW, FAMILY_USER_ROUTINE, FAMILY_SIGNAL, FAMILY_CREEP
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  logical :: is_met(0:N_FAILURES)
  type(failure_type) :: failure
  is_met = .false.
  call suite%that('nothing failed', family_of(failure) == FAMILY_NONE)
  call expect([FAILURE_NONE], FAMILY_NONE)
  call expect([FAILURE_MATERIAL], FAMILY_MATERIAL)
  call expect([FAILURE_SINGULAR, FAILURE_NOT_FINITE], FAMILY_SOLVER)
  call expect([FAILURE_CONSTRAINTS], FAMILY_CONSTRAINTS)
  call expect([FAILURE_FREE_PUSHED, FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, FAILURE_FREE_MOTION], FAMILY_FREE_BODY)
  call expect([FAILURE_LEFT_MASTER], FAMILY_LEFT_MASTER)
  call expect([FAILURE_CYCLE], FAMILY_CYCLE)
  call expect([FAILURE_FLIP], FAMILY_FLIP)
  call expect([FAILURE_UNSETTLED], FAMILY_UNSETTLED)
  call expect([FAILURE_PASSED_THROUGH, FAILURE_DEEP, FAILURE_CROSSING], FAMILY_PENETRATION)
  call expect([FAILURE_LIMIT_POINT, FAILURE_CONTACT_LIMIT], FAMILY_LIMIT_POINT)
  call expect([FAILURE_GROWING, FAILURE_SLOW], FAMILY_SLOW)
  call expect([FAILURE_USER_ROUTINE], FAMILY_USER_ROUTINE)
  call expect([FAILURE_SIGNAL], FAMILY_SIGNAL)
  call expect([FAILURE_CREEP], FAMILY_CREEP)
  call suite%that('each code has a family here', all(is_met))
  call suite%finish()

contains

  !> Codes of one family; each code once.
  subroutine expect(codes, family)
    integer, intent(in) :: codes(:), family
    type(failure_type) :: failures(size(codes))
    character(60) :: name
    failures%code = codes
    write (name, '(a,i0,a,4i4)') 'family ', family, ' of ', codes
    call suite%that(trim(name), all(family_of(failures) == family) .and. .not. any(is_met(codes)))
    is_met(codes) = .true.
  end subroutine expect

end program test_failure
