!> Unit test of amontons_steps: when output is due, where increments have to end, and defaults.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_steps
  use amontons_kinds, only: DP
  use amontons_steps, only: step_type, is_output_due, next_time_point, N_FRD, FRD_ERROR
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_output()
  call check_times()
  call check_defaults()
  call suite%finish()

contains

  !> Every n-th increment, the requested times, and the last.
  subroutine check_output()
    type(step_type) :: step
    integer :: i
    step%period = 2
    call suite%that('every third', all([(is_output_due(step, 3, i, 0.1_DP * real(i, DP)), i=1, 6)] &
      .eqv. [.false., .false., .true., .false., .false., .true.]))
    call suite%that('the last', is_output_due(step, 3, 7, 2.0_DP))
    call suite%that('none at all', .not. is_output_due(step, 0, 7, 2.0_DP))
    call suite%that('a requested time', is_output_due(step, 0, 1, 0.5_DP + 1.0e-9_DP, [0.5_DP, 1.0_DP]))
    call suite%that('no other', .not. is_output_due(step, 1, 1, 0.6_DP, [0.5_DP, 1.0_DP]))
    call suite%that('the last, with times', is_output_due(step, 0, 1, 2.0_DP, [0.5_DP]))
  end subroutine check_output


  !> The next of both lists, or the end; a time just reached is not returned again.
  subroutine check_times()
    type(step_type) :: step
    step%period = 2
    call suite%near('the end', next_time_point(step, 0.3_DP), 2.0_DP, 0.0_DP)
    step%print_times = [0.5_DP, 1.5_DP]
    step%file_times = [0.7_DP]
    call suite%near('a print', next_time_point(step, 0.0_DP), 0.5_DP, 0.0_DP)
    call suite%near('a file', next_time_point(step, 0.5_DP - 1.0e-9_DP), 0.7_DP, 0.0_DP)
    call suite%near('the next print', next_time_point(step, 0.7_DP), 1.5_DP, 0.0_DP)
    call suite%near('then the end', next_time_point(step, 1.5_DP), 2.0_DP, 0.0_DP)
  end subroutine check_times


  !> Defaults of a step.
  subroutine check_defaults()
    type(step_type) :: step
    call suite%that('a step of length 1', step%period == 1 .and. step%dt_initial == 1 .and. step%max_increments == 100)
    call suite%that('fields of the .frd file', N_FRD == FRD_ERROR .and. .not. any(step%frd%is_wanted))
  end subroutine check_defaults

end program test_steps
