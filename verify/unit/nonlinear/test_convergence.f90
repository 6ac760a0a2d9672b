!> Tests of convergence: each verdict with numbers at its limits, and the estimate of the iterations that are left.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_convergence
  use amontons_kinds, only: DP
  use amontons_controls, only: controls_type, newton_controls_type
  use amontons_convergence, only: convergence_measures_type, assess_convergence, assess_early, assess_growth, VERDICT_CONTINUE, &
    VERDICT_CONVERGED, VERDICT_DIVERGES, VERDICT_TOO_SLOW
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_converged(suite)
  call check_not_converged(suite)
  call check_soft_parts(suite)
  call check_first_iteration(suite)
  call check_divergence(suite)
  call check_estimate(suite)
  call check_early_end(suite)
  call check_approach(suite)
  call suite%finish()

contains

  !> Controls whose limits differ from each other, so that none can stand for another.
  pure function sample_controls() result(controls)
    type(controls_type) :: controls
    controls%i_0 = 4
    controls%i_r = 8
    controls%i_p = 9
    controls%i_c = 16
    controls%r_n = 1.0e-3_DP
    controls%r_p = 1.0e-2_DP
    controls%r_l = 1.0e-5_DP
    controls%c_n = 1.0e-2_DP
    controls%gap_tolerance = 1.0e-6_DP
  end function sample_controls


  !> An iterate that has converged by its residual and its correction.
  pure function sample_measures() result(measures)
    type(convergence_measures_type) :: measures
    measures%iteration = 3
    measures%residual = [0.9e-3_DP, 0.9e-3_DP, 1.0_DP]
    measures%correction = 0.9e-2_DP
    measures%gap = 0.9e-6_DP
  end function sample_measures


  !> Iterations that move a loose body count for no limit.
  subroutine check_approach(suite)
    type(suite_type), intent(inout) :: suite
    type(convergence_measures_type) :: measures
    measures = sample_measures()
    measures%residual = [0.5_DP, 0.4_DP, 0.3_DP]   ! grows
    measures%iteration = 20
    call suite%that('too many iterations', assess_convergence(sample_controls(), measures) == VERDICT_TOO_SLOW)
    measures%n_approaching = 16
    call suite%that('four of them count', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%n_approaching = 15
    call suite%that('five count: divergence', assess_convergence(sample_controls(), measures) == VERDICT_DIVERGES)
  end subroutine check_approach


  !> Convergence: by both limits, by the scaled correction, by a residual below r_l, by the weaker limit of late iterations.
  subroutine check_converged(suite)
    type(suite_type), intent(inout) :: suite
    type(convergence_measures_type) :: measures
    measures = sample_measures()
    call suite%that('both limits', assess_convergence(sample_controls(), measures) == VERDICT_CONVERGED)
    measures%residual = [1.0e-4_DP, 1.0e-2_DP, 1.0_DP]
    measures%correction = [0.05_DP, 1.0_DP]        ! times 1e-4 / 1e-2: 0.0005
    call suite%that('the correction that is left', assess_convergence(sample_controls(), measures) == VERDICT_CONVERGED)
    measures%residual = [0.9e-5_DP, 0.9e-5_DP, 1.0_DP]
    measures%correction = 10.0_DP
    call suite%that('a residual below r_l', assess_convergence(sample_controls(), measures) == VERDICT_CONVERGED)
    measures = sample_measures()
    measures%residual = [0.9e-2_DP, 0.9e-2_DP, 1.0_DP]
    measures%iteration = 10
    call suite%that('r_p after i_p iterations', assess_convergence(sample_controls(), measures) == VERDICT_CONVERGED)
    measures%iteration = 16
    call suite%that('convergence counts in the last iteration', assess_convergence(sample_controls(), measures) &
      == VERDICT_CONVERGED)
  end subroutine check_converged


  !> Each condition alone prevents convergence.
  subroutine check_not_converged(suite)
    type(suite_type), intent(inout) :: suite
    type(convergence_measures_type) :: measures
    measures = sample_measures()
    measures%residual(0:1) = 1.1e-3_DP
    call suite%that('residual', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures = sample_measures()
    measures%residual_at_gap = 1.1e-3_DP
    call suite%that('residual of the laws at their nodes', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures = sample_measures()
    measures%gap = 1.1e-6_DP
    call suite%that('gap', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures = sample_measures()
    measures%is_displacement_complete = .false.
    call suite%that('supports on their way', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures = sample_measures()
    measures%correction = 1.1e-2_DP
    call suite%that('correction', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%residual = [1.0e-4_DP, 1.0e-2_DP, 1.0_DP]
    measures%correction = [0.05_DP, 1.0_DP]
    measures%is_whole_step = .false.
    call suite%that('a shortened step scales no correction', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures = sample_measures()
    measures%residual(0:1) = 0.9e-2_DP
    measures%iteration = 4
    call suite%that('r_p not before i_p', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
  end subroutine check_not_converged


  !> Soft parts beside stiff ones: the residual of the stiff parts forecasts no correction of the soft ones.
  subroutine check_soft_parts(suite)
    type(suite_type), intent(inout) :: suite
    type(convergence_measures_type) :: measures
    measures = sample_measures()
    measures%residual = [1.0e-5_DP, 1.0e-2_DP, 1.0_DP] * 1.1_DP
    measures%correction = [0.5_DP, 1.0_DP]         ! halved: quadratic convergence forecasts an eighth
    call suite%that('corrections that hardly shrink', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%residual = [1.0e-4_DP, 1.0_DP, 1.0e-4_DP]   ! a stretched stiff part in between
    measures%correction = [0.02_DP, 0.5_DP]
    call suite%that('a residual that returns', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%residual = [1.0e-4_DP, 1.0_DP, 2.0e-4_DP]   ! 0.5 for 2e-4 leaves 0.25 for 1e-4
    call suite%that('the larger of two forecasts', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%residual = [1.2e-5_DP, 3.7e-2_DP, 3.9e-3_DP]   ! stiff and soft motions are corrected in turn
    measures%correction = [6.1e-3_DP, 0.41_DP]
    call suite%that('a small correction after a residual that rose', assess_convergence(sample_controls(), measures) == &
      VERDICT_CONTINUE)
    measures%residual(2) = 4.0e-2_DP
    call suite%that('the same after one that fell', assess_convergence(sample_controls(), measures) == VERDICT_CONVERGED)
  end subroutine check_soft_parts


  !> The first iteration: its correction counts where the residual at the start was at most the largest force.
  subroutine check_first_iteration(suite)
    type(suite_type), intent(inout) :: suite
    type(convergence_measures_type) :: measures
    measures = sample_measures()
    measures%iteration = 1
    measures%residual = [0.9e-3_DP, 1.1_DP, 0.0_DP]
    call suite%that('from a start far from equilibrium', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%residual(1) = 0.9_DP
    call suite%that('from a start near to it', assess_convergence(sample_controls(), measures) == VERDICT_CONVERGED)
    measures%residual = [0.9e-5_DP, 1.1_DP, 0.0_DP]
    call suite%that('a linear problem', assess_convergence(sample_controls(), measures) == VERDICT_CONVERGED)
  end subroutine check_first_iteration


  !> Growth in two iterations running after i_0, and the last iteration allowed.
  subroutine check_divergence(suite)
    type(suite_type), intent(inout) :: suite
    type(convergence_measures_type) :: measures
    measures = sample_measures()
    measures%residual = [0.3_DP, 0.2_DP, 0.1_DP]
    measures%iteration = 4
    call suite%that('growth up to i_0 is allowed', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%iteration = 5
    call suite%that('growth after i_0', assess_convergence(sample_controls(), measures) == VERDICT_DIVERGES)
    measures%residual = [0.3_DP, 0.2_DP, 0.25_DP]
    call suite%that('growth in one iteration', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%residual = [0.2_DP, 0.3_DP, 0.1_DP]
    call suite%that('growth in the one before', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%iteration = 16
    call suite%that('the last iteration', assess_convergence(sample_controls(), measures) == VERDICT_TOO_SLOW)
  end subroutine check_divergence


  !> The logarithmic estimate after i_r: a residual that falls by 10 in two iterations takes two for each decade that is left.
  subroutine check_estimate(suite)
    type(suite_type), intent(inout) :: suite
    type(convergence_measures_type) :: measures
    measures = sample_measures()
    measures%iteration = 9
    measures%residual = [0.9_DP, 2.0_DP, 9.0_DP]   ! to 1e-3: 2.95 decades, 5.9 iterations, 14.9 in all
    call suite%that('enough iterations are left', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%residual = [20.0_DP, 40.0_DP, 200.0_DP]   ! 4.3 decades: 17.6 in all
    call suite%that('too few are left', assess_convergence(sample_controls(), measures) == VERDICT_TOO_SLOW)
    measures%iteration = 8
    call suite%that('no estimate up to i_r', assess_convergence(sample_controls(), measures) == VERDICT_CONTINUE)
    measures%iteration = 9
    measures%residual = [0.5_DP, 0.6_DP, 0.5_DP]
    call suite%that('a residual that stands', assess_convergence(sample_controls(), measures) == VERDICT_TOO_SLOW)
    measures%residual = [0.9e-3_DP, 0.9e-3_DP, 0.9e-3_DP]
    measures%correction = 1.0_DP
    call suite%that('a residual that is small enough needs no more', assess_convergence(sample_controls(), measures) &
      == VERDICT_CONTINUE)
  end subroutine check_estimate


  !> The early end: from the fourth iteration on, of a large residual that falls slowly; by its size the one verdict or the other.
  subroutine check_early_end(suite)
    type(suite_type), intent(inout) :: suite
    call suite%that('three iterations', early(3, [0.6_DP, 0.6_DP, 0.6_DP]) == VERDICT_CONTINUE)
    call suite%that('far off', early(4, [0.6_DP, 0.6_DP, 0.6_DP]) == VERDICT_DIVERGES)
    call suite%that('nearer', early(4, [0.4_DP, 0.6_DP, 0.6_DP]) == VERDICT_TOO_SLOW)
    call suite%that('falls well', early(4, [0.14_DP, 0.3_DP, 0.6_DP]) == VERDICT_CONTINUE)
    call suite%that('small', early(4, [0.09_DP, 0.09_DP, 0.09_DP]) == VERDICT_CONTINUE)
    call suite%that('rounds: grown twice, far off', growth(3, [0.6_DP, 0.4_DP, 0.3_DP]) == VERDICT_DIVERGES)
    call suite%that('rounds: the start is none', growth(2, [0.6_DP, 0.4_DP, 0.3_DP]) == VERDICT_CONTINUE)
    call suite%that('rounds: grown once', growth(3, [0.6_DP, 0.4_DP, 0.5_DP]) == VERDICT_CONTINUE)
    call suite%that('rounds: grown twice, near', growth(3, [0.4_DP, 0.3_DP, 0.2_DP]) == VERDICT_CONTINUE)
  end subroutine check_early_end


  !> The verdict that was to continue, after the look at an early end.
  pure integer function early(iteration, residual) result(verdict)
    integer, intent(in) :: iteration
    real(DP), intent(in) :: residual(0:2)          !< over the largest force [-]
    type(convergence_measures_type) :: measures
    measures%iteration = iteration
    measures%residual = residual
    verdict = VERDICT_CONTINUE
    call assess_early(newton_controls_type(), measures, verdict)
  end function early


  !> The verdict that was to continue, after the look at the growth over two rounds.
  pure integer function growth(iteration, residual) result(verdict)
    integer, intent(in) :: iteration
    real(DP), intent(in) :: residual(0:2)          !< over the largest force [-]
    type(convergence_measures_type) :: measures
    measures%iteration = iteration
    measures%residual = residual
    verdict = VERDICT_CONTINUE
    call assess_growth(newton_controls_type(), measures, verdict)
  end function growth

end program test_convergence
