!> Unit test of amontons_phase_clock: no time is counted twice or lost between readings.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_phase_clock
  use amontons_kinds, only: DP, I64
  use amontons_iteration_records, only: N_PHASES, PHASE_READING, PHASE_CONTACT, PHASE_OTHER
  use amontons_phase_clock, only: phase_clock_type
  use check, only: suite_type
  implicit none
  real(DP), parameter :: WAIT_TIME = 0.02_DP       ! [s]
  real(DP), parameter :: TOL_CLOCK = 0.005_DP      ! between two readings of two clocks, on a loaded machine [s]
  type(suite_type) :: suite
  call check_readings()
  call suite%finish()

contains

  !> Each reading gives the time since the one before to its phase; a collection empties the clock and adds to what is there.
  subroutine check_readings()
    type(phase_clock_type) :: clock
    real(DP) :: seconds(N_PHASES), megabytes(N_PHASES), whole
    integer(I64) :: first, last, rate
    call system_clock(first, rate)
    call clock%start()
    call pass_time()
    call clock%read(PHASE_READING)
    call pass_time()
    call clock%read(PHASE_CONTACT)
    call clock%read(PHASE_OTHER)
    call pass_time()
    call clock%read(PHASE_READING)
    call system_clock(last)
    whole = real(last - first, DP) / real(rate, DP)
    seconds = 0.0_DP
    megabytes = 0.0_DP
    seconds(PHASE_CONTACT) = 1.0_DP
    call clock%collect(seconds, megabytes)
    seconds(PHASE_CONTACT) = seconds(PHASE_CONTACT) - 1.0_DP
    call suite%near('the whole time', sum(seconds), whole, TOL_CLOCK)
    call suite%that('two parts of one phase', seconds(PHASE_READING) >= 2.0_DP * WAIT_TIME)
    call suite%that('one of the other', seconds(PHASE_CONTACT) >= WAIT_TIME)
    call suite%that('none of the rest', count(seconds > 0.0_DP) <= 3)
    call suite%that('memory of the program', sum(megabytes) > 0.0_DP)
    call clock%collect(seconds, megabytes)
    call suite%near('collected once', sum(seconds), whole, TOL_CLOCK)
  end subroutine check_readings


  !> Waits.
  subroutine pass_time()
    integer(I64) :: first, now, rate
    call system_clock(first, rate)
    do
      call system_clock(now)
      if (real(now - first, DP) / real(rate, DP) >= WAIT_TIME) return
    end do
  end subroutine pass_time

end program test_phase_clock
