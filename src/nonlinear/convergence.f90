!> Converge: the verdict on an iterate: converged, go on, diverges, or too slow; numbers in, verdict out.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_convergence
  use amontons_kinds, only: DP
  use amontons_steps, only: controls_type
  implicit none
  private
  public :: progress_type, judge, judge_early
  public :: VERDICT_GO_ON, VERDICT_CONVERGED, VERDICT_DIVERGES, VERDICT_TOO_SLOW

  integer, parameter :: VERDICT_GO_ON = 0
  integer, parameter :: VERDICT_CONVERGED = 1
  integer, parameter :: VERDICT_DIVERGES = 2       !< the residual grows in two consecutive iterations
  integer, parameter :: VERDICT_TOO_SLOW = 3       !< the iterations allowed will not do

  integer, parameter :: EARLY = 4                  !< iterations
  real(DP), parameter :: LOST = 0.1_DP             !< of the largest force [-]
  real(DP), parameter :: FALLING = 0.25_DP         !< an imbalance that fell by this factor over two iterations falls well [-]
  real(DP), parameter :: FAR_OFF = 0.5_DP          !< of the largest force: only a much shorter increment will do [-]

  !> What the verdict looks at, after each iteration.
  type :: progress_type
    integer :: iteration = 0
    real(DP) :: residual(0:2) = 0                  !< now, one and two iterations before, over the largest force [-]
    real(DP) :: law = 0                            !< residual with compliant laws where their nodes are, over the largest force [-]
    real(DP) :: correction = 0                     !< over the largest increment of displacement [-]
    real(DP) :: gap = 0                            !< worst violation of a closed node over the facet's edge [-]
    logical :: is_whole_step = .true.              !< the last step had length 1
    logical :: is_arrived = .true.                 !< no prescribed displacement is still missing
  end type progress_type

contains

  !> The verdict on an iterate.
  !!
  !! Converged: the supports have arrived, the residual is at most r_n (r_p after i_p iterations), the closed nodes are on
  !! their facets, and the
  !! correction is at most c_n. The last correction is the error of the iterate *before*; that of this one is, to first
  !! order, the correction that the residual now would give: last correction times residual now over residual before.
  !! The smaller of the two counts. A residual below r_l needs no correction.
  pure integer function judge(controls, progress) result(verdict)
    type(controls_type), intent(in) :: controls
    type(progress_type), intent(in) :: progress
    real(DP) :: tolerance, correction, left
    tolerance = merge(controls%r_p, controls%r_n, progress%iteration > controls%i_p)
    left = max(progress%residual(0), progress%law)
    correction = progress%correction
    if (progress%is_whole_step .and. progress%residual(0) < progress%residual(1)) &
      correction = correction * progress%residual(0) / progress%residual(1)
    verdict = VERDICT_GO_ON
    if (progress%is_arrived .and. left <= tolerance .and. progress%gap <= controls%gap_tolerance .and. &
      (correction <= controls%c_n .or. left <= controls%r_l)) then
      verdict = VERDICT_CONVERGED
    else if (progress%iteration >= controls%i_c) then
      verdict = VERDICT_TOO_SLOW
    else if (progress%iteration > controls%i_0 .and. progress%residual(0) > progress%residual(1) .and. &
      progress%residual(1) > progress%residual(2)) then
      verdict = VERDICT_DIVERGES
    else if (progress%iteration > controls%i_r) then
      if (iterations_needed(progress, tolerance) > real(controls%i_c, DP)) verdict = VERDICT_TOO_SLOW
    end if
  end function judge


  !> An attempt with contact that may be cut back ends early where what is known by experience says that it is lost: after EARLY
  !! iterations the imbalance is still more than LOST of the largest force and falls slowly. Of such attempts four in five
  !! failed, after eleven iterations in the mean.
  pure subroutine judge_early(progress, verdict)
    type(progress_type), intent(in) :: progress
    integer, intent(inout) :: verdict              !< out: VERDICT_DIVERGES where it is far off, VERDICT_TOO_SLOW where it is nearer
    if (progress%iteration < EARLY .or. progress%residual(0) < LOST .or. &
      progress%residual(0) < FALLING * progress%residual(2)) return
    verdict = merge(VERDICT_DIVERGES, VERDICT_TOO_SLOW, progress%residual(0) > FAR_OFF)
  end subroutine judge_early


  !> Iterations until the tolerance if the residual goes on falling by the same factor as over the last two iterations.
  pure real(DP) function iterations_needed(progress, tolerance) result(total)
    type(progress_type), intent(in) :: progress
    real(DP), intent(in) :: tolerance              !< [-]
    real(DP) :: rate
    total = real(progress%iteration, DP)
    if (progress%residual(0) <= tolerance) return
    rate = progress%residual(0) / max(progress%residual(2), tiny(1.0_DP))
    if (rate >= 1.0_DP) then
      total = huge(1.0_DP)
    else
      total = total + 2.0_DP * log(tolerance / progress%residual(0)) / log(rate)
    end if
  end function iterations_needed

end module amontons_convergence
