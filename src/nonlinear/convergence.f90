!> Convergence criteria: verdict on an iterate from residual, correction and gap (converged, continue, diverges, too slow).
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_convergence
  use amontons_kinds, only: DP
  use amontons_controls, only: controls_type, newton_controls_type
  implicit none
  private
  public :: convergence_measures_type, assess_convergence, assess_early, assess_growth, n_counted
  public :: VERDICT_CONTINUE, VERDICT_CONVERGED, VERDICT_DIVERGES, VERDICT_TOO_SLOW

  integer, parameter :: VERDICT_CONTINUE = 0
  integer, parameter :: VERDICT_CONVERGED = 1
  integer, parameter :: VERDICT_DIVERGES = 2       !< the residual grows in two consecutive iterations
  integer, parameter :: VERDICT_TOO_SLOW = 3       !< no convergence expected within i_c iterations

  !> Measures of an iterate for the verdict.
  type :: convergence_measures_type
    integer :: iteration = 0
    integer :: n_approaching = 0                   !< iterations that moved a loose body towards a support: limits do not count them
    integer :: n_renewed = 0                       !< others before mid-side nodes began or ended to follow: limits count from there
    real(DP) :: residual(0:2) = 0                  !< now, one and two iterations before, over the largest force [-]
    real(DP) :: residual_at_gap = 0                            !< residual with compliant laws at the actual gap, over the
                                                               !! largest force [-]
    real(DP) :: correction(0:1) = 0                !< now and one iteration before, over the largest increment of displacement [-]
    real(DP) :: gap = 0                            !< worst violation of a closed node over the facet's edge [-]
    logical :: is_whole_step = .true.              !< the last step had length 1
    logical :: is_displacement_complete = .true.                 !< no prescribed displacement is still missing
  end type convergence_measures_type

contains

  !> Verdict on an iterate.
  !!
  !! Converged: the prescribed displacements are complete, the residual is at most r_n (r_p after i_p iterations), the gap error of
  !! closed nodes is within its tolerance, and the estimated error of displacement is at most c_n. A residual below r_l needs no
  !! estimate.
  pure integer function assess_convergence(controls, measures) result(verdict)
    type(controls_type), intent(in) :: controls
    type(convergence_measures_type), intent(in) :: measures
    real(DP) :: tolerance, residual_left
    integer :: n                                   ! iterations that count
    tolerance = merge(controls%r_p, controls%r_n, n_counted(measures) > controls%i_p)
    residual_left = max(measures%residual(0), measures%residual_at_gap)
    n = n_counted(measures)
    verdict = VERDICT_CONTINUE
    if (measures%is_displacement_complete .and. residual_left <= tolerance .and. measures%gap <= controls%gap_tolerance .and. &
      (estimate_error(measures) <= controls%c_n .or. residual_left <= controls%r_l)) then
      verdict = VERDICT_CONVERGED
    else if (n >= controls%i_c) then
      verdict = VERDICT_TOO_SLOW
    else if (n > controls%i_0 .and. measures%residual(0) > measures%residual(1) .and. &
      measures%residual(1) > measures%residual(2)) then
      verdict = VERDICT_DIVERGES
    else if (n > controls%i_r) then
      if (estimate_iterations(measures, tolerance) > real(controls%i_c, DP)) verdict = VERDICT_TOO_SLOW
    end if
  end function assess_convergence


  !> Iterations of the attempt that count for the limits: all but those that moved a loose body towards a support, and those before
  !! a change of the mid-side nodes that follow.
  pure integer function n_counted(measures) result(n)
    type(convergence_measures_type), intent(in) :: measures
    n = measures%iteration - measures%n_approaching - measures%n_renewed
  end function n_counted


  !> Estimated error of displacement of an iterate, over the largest increment of displacement [-].
  !!
  !! The last correction is the error of the *previous* iterate. To first order the error of this one is the correction of its
  !! residual. It is the least of the last correction, and the largest of three forecasts of the next one: the last two corrections,
  !! each times the residual over the residual that it removed; and quadratic convergence. One residual alone forecasts too little
  !! where stiff parts had most of it and soft parts have the rest. Where the residual rose before this iteration, stiff and soft
  !! motions are corrected in turn: a small last correction bounds nothing; the forecasts count alone, times the factor of the rise
  !! by which each residual understates the motion that it lacks. A first iteration has no forecast. Its correction counts only if
  !! the residual before it was at most the largest force: beyond, forces that no equilibrium has may make the tangent of the start
  !! far too stiff, e.g. the tension of a rope that the extrapolation of a rotation stretches.
  pure real(DP) function estimate_error(measures) result(error)
    type(convergence_measures_type), intent(in) :: measures
    error = measures%correction(0)
    if (measures%iteration == 1) then
      if (measures%residual(1) > 1) error = huge(1.0_DP)
    else if (measures%residual(1) > measures%residual(2)) then
      if (.not. measures%residual(2) > 0) return
      associate (forecast => measures%residual(0) * maxval(measures%correction / measures%residual(1:)) * measures%residual(1) / &
          measures%residual(2))
        error = merge(forecast, max(error, forecast), measures%is_whole_step .and. measures%residual(0) < measures%residual(1))
      end associate
    else if (measures%is_whole_step .and. measures%residual(0) < minval(measures%residual(1:)) .and. &
      measures%correction(0) < measures%correction(1)) then
      error = min(error, max(measures%residual(0) * maxval(measures%correction / measures%residual(1:)), &
        error * (error / measures%correction(1))**2))
    end if
  end function estimate_error


  !> Early end of an attempt with contact that can be cut back (empirical): after a few iterations the residual is
  !! still large and decreases slowly. Four in five of such attempts failed, after eleven
  !! iterations on average.
  pure subroutine assess_early(controls, measures, verdict)
    type(newton_controls_type), intent(in) :: controls
    type(convergence_measures_type), intent(in) :: measures
    integer, intent(inout) :: verdict              !< out: VERDICT_DIVERGES above diverged_residual, else VERDICT_TOO_SLOW
    if (n_counted(measures) < controls%early_check_iteration .or. &
      measures%residual(0) < controls%min_lost_residual .or. &
      measures%residual(0) < controls%sufficient_decrease * measures%residual(2)) return
    verdict = merge(VERDICT_DIVERGES, VERDICT_TOO_SLOW, measures%residual(0) > controls%diverged_residual)
  end subroutine assess_early


  !> End of an attempt by conjugate gradients that can be cut back: the residual has grown in two rounds to the size of the largest
  !! force. Such rounds have left the neighbourhood of the start; the equilibrium that they may find at last is another one.
  pure subroutine assess_growth(controls, measures, verdict)
    type(newton_controls_type), intent(in) :: controls
    type(convergence_measures_type), intent(in) :: measures
    integer, intent(inout) :: verdict              !< out: VERDICT_DIVERGES
    if (measures%iteration < 3) return             ! the residual at the start is not that of a round
    if (measures%residual(0) > controls%diverged_residual .and. measures%residual(0) > measures%residual(1) .and. &
      measures%residual(1) > measures%residual(2)) verdict = VERDICT_DIVERGES
  end subroutine assess_growth


  !> Iterations until the tolerance if the residual decreases at the rate of the last two iterations.
  pure real(DP) function estimate_iterations(measures, tolerance) result(total)
    type(convergence_measures_type), intent(in) :: measures
    real(DP), intent(in) :: tolerance              !< [-]
    real(DP) :: rate
    total = real(n_counted(measures), DP)
    if (measures%residual(0) <= tolerance) return
    rate = measures%residual(0) / max(measures%residual(2), tiny(1.0_DP))
    if (rate >= 1.0_DP) then
      total = huge(1.0_DP)
    else
      total = total + 2.0_DP * log(tolerance / measures%residual(0)) / log(rate)
    end if
  end function estimate_iterations

end module amontons_convergence
