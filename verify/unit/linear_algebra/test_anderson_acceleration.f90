!> Tests of Anderson acceleration: linear fixed points of maps that diverge, forgetting, another number of unknowns.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_anderson_acceleration
  use amontons_kinds, only: DP
  use amontons_anderson_acceleration, only: anderson_type, accelerate, forget_iterates
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_linear_map(suite)
  call check_start(suite)
  call suite%finish()

contains

  !> x = b + diag(m) x with factors of -4, -2, 0.9 and 3: the plain iteration diverges. With four distinct factors GMRES needs four
  !! steps; the first iterate and the first step without history make it at most eight.
  subroutine check_linear_map(suite)
    type(suite_type), intent(inout) :: suite
    real(DP), parameter :: FACTORS(4) = [-4.0_DP, -2.0_DP, 0.9_DP, 3.0_DP], B(4) = [1.0_DP, 2.0_DP, 3.0_DP, -1.0_DP]
    type(anderson_type) :: anderson
    real(DP) :: x(4), next(4)
    integer :: k
    x = 0.0_DP
    do k = 1, 8
      call accelerate(anderson, x, FACTORS * x + B, next)
      x = next
    end do
    call suite%near('linear map: fixed point', maxval(abs(x - B / (1.0_DP - FACTORS))), 0.0_DP, 1.0e-8_DP)
    call accelerate(anderson, x, FACTORS * x + B, next)
    call suite%near('linear map: stays there', maxval(abs(next - x)), 0.0_DP, 1.0e-8_DP)
  end subroutine check_linear_map


  !> Without history the step is half of the plain one, also after the iterates were forgotten or another size.
  subroutine check_start(suite)
    type(suite_type), intent(inout) :: suite
    type(anderson_type) :: anderson
    real(DP) :: next(2), longer(3)
    call accelerate(anderson, [1.0_DP, 1.0_DP], [3.0_DP, 5.0_DP], next)
    call suite%near('start: half', maxval(abs(next - [2.0_DP, 3.0_DP])), 0.0_DP, 1.0e-14_DP)
    call accelerate(anderson, [2.0_DP, 3.0_DP], [4.0_DP, 6.0_DP], next)
    call forget_iterates(anderson)
    call accelerate(anderson, [0.0_DP, 0.0_DP], [2.0_DP, -2.0_DP], next)
    call suite%near('forgotten: half', maxval(abs(next - [1.0_DP, -1.0_DP])), 0.0_DP, 1.0e-14_DP)
    call accelerate(anderson, [0.0_DP, 0.0_DP, 2.0_DP], [2.0_DP, -2.0_DP, 2.0_DP], longer)
    call suite%near('another size: half', maxval(abs(longer - [1.0_DP, -1.0_DP, 2.0_DP])), 0.0_DP, 1.0e-14_DP)
    call suite%that('another size: one iterate', anderson%n == 0 .and. anderson%has_last)
  end subroutine check_start

end program test_anderson_acceleration
