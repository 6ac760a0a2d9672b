!> Unit test of amontons_controls: relations that the defaults must keep, and the controls of CalculiX.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_controls
  use amontons_kinds, only: DP
  use amontons_controls, only: controls_type, calculix_controls
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(controls_type) :: own
  call check_slots()
  call check_newton()
  call check_steps()
  call check_substeps()
  call check_linear_solver()
  call suite%finish()

contains

  !> Cut-back factors are below 1, growth factors above; the CalculiX tolerances are larger.
  subroutine check_slots()
    type(controls_type) :: other
    other = calculix_controls()
    call suite%that('factors', own%d_f < own%d_c .and. own%d_c < own%d_b .and. own%d_b < 1 .and. own%d_d > 1)
    call suite%that('iterations', own%i_0 < own%i_r .and. own%i_r < own%i_c .and. own%i_g < own%i_l)
    call suite%that('looser', other%r_n > own%r_n .and. other%c_n > own%c_n .and. other%i_c < own%i_c)
    call suite%that('the same cuts', other%d_f == own%d_f .and. other%d_d == own%d_d .and. other%s_min == own%s_min)
    call suite%that('CalculiX: 0.5 % of the mean force, a correction of 1 %', other%r_n == 0.0005_DP .and. other%c_n == 0.01_DP)
    call suite%that('a step can be cut once before it is too short', own%d_f < 1 .and. own%i_a > 1)
  end subroutine check_slots


  !> Forcing terms of Eisenstat and Walker lie in (0, 1); hopeless comes before diverged; rounding is below all tolerances.
  subroutine check_newton()
    associate (c => own%newton)
      call suite%that('forcing terms', 0 < c%min_forcing_term .and. c%min_forcing_term < own%subproblem%tolerance .and. &
        own%subproblem%tolerance < 1)
      call suite%that('hopeless before diverged', c%min_lost_residual < c%diverged_residual .and. c%sufficient_decrease < 1)
      call suite%that('two iterations back are known', c%early_check_iteration > 2)
      call suite%that('rounding', c%force_rounding < own%r_l .and. c%force_rounding > epsilon(1.0_DP))
      call suite%that('proximal steps go less far', c%max_proximal_ratio < c%max_displacement_ratio)
    end associate
  end subroutine check_newton


  !> Trials reach the largest shift; a proximal step stays
  !! within the search radius of contact, three edges.
  subroutine check_steps()
    associate (c => own%globalization)
      call suite%that('all shifts are reached', c%min_proximal_shift * c%singular_shift_factor**c%max_shift_trials >= &
        c%max_proximal_shift)
      call suite%that('within the search radius', c%max_step_edges < 3)
      call suite%that('snap-through starts between', c%min_proximal_shift < c%initial_snap_shift .and. &
        c%initial_snap_shift < c%max_proximal_shift)
    end associate
    call suite%that('a return needs a loss before it', own%cycling%max_edge_returns > 1 .and. own%cycling%max_master_losses > 1)
    call suite%that('s_min within the halvings', own%s_min >= 0.5_DP**own%line_search%max_halvings)
  end subroutine check_steps


  !> Substeps are halved and doubled, and their sum must be exactly 1: powers of two.
  subroutine check_substeps()
    associate (c => own%subproblem)
      call suite%that('powers of two', fraction(c%initial_substep) == 0.5_DP .and. fraction(c%min_substep) == 0.5_DP)
      call suite%that('shorter than the first', c%min_substep < c%initial_substep .and. c%initial_substep < 1)
      call suite%that('the homotopy can end', real(c%max_iterations_all_substeps, DP) >= 1 / c%initial_substep)
      call suite%that('corrections', c%max_iterations_per_substep < c%max_iterations_all_substeps)
      call suite%that('tolerances', c%rounding < own%newton%min_forcing_term)
    end associate
  end subroutine check_substeps


  !> Tolerances of directions: the tighter, the fewer corrections follow. Limits of memory and work are ordered.
  subroutine check_linear_solver()
    associate (skin => own%skin, krylov => own%krylov, linear => own%linear_solver)
      call suite%that('skin: tighter with fewer corrections to come', skin%tolerance_length > skin%tolerance_changing .and. &
        skin%tolerance_changing > skin%tolerance_halved .and. skin%tolerance_halved > skin%tolerance_unchanged .and. &
        skin%tolerance_unchanged > skin%tolerance_origin .and. skin%tolerance_origin > skin%tolerance_single)
      call suite%that('skin: one direction alone satisfies Newton', skin%tolerance_single < own%r_n)
      call suite%that('skin: usual criteria are the defaults', abs(skin%usual_r_n - own%r_n) <= 0.0_DP)
      call suite%that('skin: a free motion is weakly restrained', skin%free_motion_ratio < skin%max_motion_energy)
      call suite%that('krylov: below the least forcing term', krylov%newton_tolerance_share * own%r_n < &
        own%newton%min_forcing_term .and. krylov%iterative_tolerance < krylov%tolerance)
      call suite%that('memory', linear%max_memory_share < linear%max_free_memory_share .and. linear%max_free_memory_share < 1)
      call suite%that('planned before estimated', linear%min_unknowns_planned < linear%min_unknowns_estimated)
    end associate
  end subroutine check_linear_solver

end program test_controls
