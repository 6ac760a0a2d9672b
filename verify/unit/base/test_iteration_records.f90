!> Unit test of amontons_iteration_records: the defaults that logs, status files and result files rely on.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_iteration_records
  use amontons_kinds, only: DP
  use amontons_failure, only: FAILURE_NONE
  use amontons_iteration_records, only: iteration_record_type, increment_record_type, PHASE_NAMES, N_PHASES, PHASE_READING, &
    PHASE_OTHER, REPORT_LINE_LENGTH
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_defaults()
  call check_phases()
  call suite%finish()

contains

  !> An empty record counts nothing, took whole steps and has not failed or converged.
  subroutine check_defaults()
    type(iteration_record_type) :: iteration
    type(increment_record_type) :: increment
    call suite%that('an iteration', iteration%n_closed == 0 .and. all(iteration%n_status == 0) .and. all(iteration%n_scenario == 0))
    call suite%near('a whole step', iteration%step_length, 1.0_DP, 0.0_DP)
    call suite%that('an increment', .not. increment%is_converged .and. increment%failure%code == FAILURE_NONE)
    call suite%near('only whole steps', increment%smallest_step_length, 1.0_DP, 0.0_DP)
    call suite%that('no time', all(increment%seconds == 0) .and. all(increment%megabytes == 0))
    call suite%that('open, stick and slip by their numbers', lbound(increment%n_status, 1) == 0)
    call suite%that('three of them', size(increment%n_status) == 3 .and. size(iteration%n_status) == 3)
    call suite%that('no words yet', .not. allocated(increment%reason) .and. .not. allocated(increment%report_lines))
    call suite%that('a line of a report', REPORT_LINE_LENGTH >= 132)
  end subroutine check_defaults


  !> A name for each phase, all different.
  subroutine check_phases()
    integer :: i
    call suite%that('from the first to the last', PHASE_READING == 1 .and. PHASE_OTHER == N_PHASES)
    do i = 1, N_PHASES
      call suite%that('one name each', len_trim(PHASE_NAMES(i)) > 0 .and. count(PHASE_NAMES == PHASE_NAMES(i)) == 1)
    end do
  end subroutine check_phases

end program test_iteration_records
