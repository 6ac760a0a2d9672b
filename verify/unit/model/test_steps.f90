!> Unit test of amontons_steps: when output is due, where increments have to end, and the controls of CalculiX.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_steps
  use amontons_kinds, only: DP
  use amontons_steps, only: step_type, controls_type, calculix_controls, is_output_due, next_time_point, N_FRD, FRD_ERROR
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_output()
  call check_times()
  call check_controls()
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
    call suite%that('a time asked for', is_output_due(step, 0, 1, 0.5_DP + 1.0e-9_DP, [0.5_DP, 1.0_DP]))
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


  !> Cut-back factors are below 1, growth factors above; the CalculiX tolerances are larger.
  subroutine check_controls()
    type(controls_type) :: own, other
    type(step_type) :: step
    other = calculix_controls()
    call suite%that('factors', own%d_f < own%d_c .and. own%d_c < own%d_b .and. own%d_b < 1 .and. own%d_d > 1)
    call suite%that('iterations', own%i_0 < own%i_r .and. own%i_r < own%i_c .and. own%i_g < own%i_l)
    call suite%that('looser', other%r_n > own%r_n .and. other%c_n > own%c_n .and. other%i_c < own%i_c)
    call suite%that('the same cuts', other%d_f == own%d_f .and. other%d_d == own%d_d .and. other%s_min == own%s_min)
    call suite%that('CalculiX: 0.5 % of the mean force, a correction of 1 %', other%r_n == 0.0005_DP .and. other%c_n == 0.01_DP)
    call suite%that('a step of length 1', step%period == 1 .and. step%dt_initial == 1 .and. step%max_increments == 100)
    call suite%that('fields of the .frd file', N_FRD == FRD_ERROR .and. .not. any(step%frd%is_wanted))
  end subroutine check_controls

end program test_steps
