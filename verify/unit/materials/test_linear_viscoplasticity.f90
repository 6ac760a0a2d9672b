!> Unit test of amontons_linear_viscoplasticity: the yield condition at the result, the tangent by differences, von Mises's return
!! with isotropic elasticity, and what does not flow.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_linear_viscoplasticity
  use amontons_kinds, only: DP
  use amontons_elasticity, only: isotropic_tangent
  use amontons_linear_viscoplasticity, only: linear_return_type, map_linear_return, N_LINEAR_STATE
  use amontons_plasticity, only: RETURN_OK
  use amontons_tensor, only: double_dot, von_mises, VOIGT_IDENTITY
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: STRAINS(6, 4) = reshape([0.0_DP, 0.0_DP, 0.012_DP, 0.0_DP, 0.0_DP, 0.0_DP, &
    0.01_DP, -0.006_DP, -0.003_DP, 0.004_DP, -0.007_DP, 0.002_DP, &
    0.0_DP, 0.0_DP, 0.0_DP, 0.02_DP, 0.0_DP, 0.0_DP, &
    -0.02_DP, 0.03_DP, -0.01_DP, -0.04_DP, 0.01_DP, 0.05_DP], [6, 4])
  real(DP), parameter :: PLASTIC(6) = [200.0_DP, 1500.0_DP, 4000.0_DP, -1.0_DP, 1.0_DP, 0.0_DP]
  real(DP), parameter :: VISCOUS(6) = [150.0_DP, 1500.0_DP, 4000.0_DP, 1.0e-12_DP, 5.0_DP, 0.0_DP]
  real(DP), parameter :: PRIMARY(6) = [0.0_DP, 0.0_DP, 0.0_DP, 1.0e-14_DP, 5.0_DP, -0.4_DP]
  real(DP) :: C(6, 6)
  integer :: i
  C = isotropic_tangent(1.0e5_DP, 8.0e4_DP)
  C(3, 3) = 1.8e5_DP
  C(1, 2) = 0.6e5_DP
  C(2, 1) = C(1, 2)
  C(5, 5) = 4.0e4_DP
  do i = 1, 4
    call check_law(PLASTIC, STRAINS(:, i), .false.)
    call check_law(VISCOUS, STRAINS(:, i), .true.)
    call check_law(VISCOUS, STRAINS(:, i), .false.)
    call check_law(PRIMARY, STRAINS(:, i), .true.)
  end do
  call check_isotropic_elasticity(STRAINS(:, 2))
  call check_elastic()
  do i = 1, 12
    call check_small_flow(PLASTIC, 10.0_DP**(-i), .false.)
    call check_small_flow(VISCOUS, 10.0_DP**(-i), .true.)
  end do
  call suite%finish()

contains

  !> An increment from time 1.
  subroutine advance(constants, C, e, is_viscous, state, response)
    real(DP), intent(in) :: constants(6), C(6, 6), e(6)
    logical, intent(in) :: is_viscous
    real(DP), intent(inout) :: state(:)
    type(linear_return_type), intent(out) :: response
    integer :: status
    call map_linear_return(constants, C, e, [1.3_DP, 0.3_DP], is_viscous, state, response, status)
    call suite%that('it converges', status == RETURN_OK)
  end subroutine advance


  !> Trial stresses hardly beyond the yield surface, in many directions: rounding ends the search for the flow.
  subroutine check_small_flow(constants, excess, is_viscous)
    real(DP), intent(in) :: constants(6)
    real(DP), intent(in) :: excess                 !< over the yield stress [-]
    logical, intent(in) :: is_viscous
    type(linear_return_type) :: response
    real(DP) :: e(6), state(N_LINEAR_STATE)
    integer :: i, k
    do i = 1, 40
      e = [(sin(real(i * k + i, DP)), k=1, 6)]
      e = e * (1 + excess) * constants(1) / von_mises(matmul(C, e))
      state = 0
      call advance(constants, C, e, is_viscous, state, response)
      call suite%that('on or outside the surface', von_mises(response%stress) >= constants(1) * (1 - 1.0e-9_DP) .and. &
        von_mises(response%stress) <= constants(1) * (1 + excess + 1.0e-9_DP))
    end do
  end subroutine check_small_flow


  !> Two increments: the yield condition and the tangent of the second.
  subroutine check_law(constants, e, is_viscous)
    real(DP), intent(in) :: constants(6), e(6)
    logical, intent(in) :: is_viscous
    real(DP), parameter :: STEP = 1.0e-7_DP
    type(linear_return_type) :: response, plus, minus
    real(DP) :: before(N_LINEAR_STATE), after(N_LINEAR_STATE), other(N_LINEAR_STATE), engineering(6), de(6), s(6), limit
    integer :: k
    before = 0
    call advance(constants, C, 0.6_DP * e, is_viscous, before, response)
    engineering = response%flow
    engineering(4:) = 2 * engineering(4:)
    after = before
    call advance(constants, C, e - engineering, is_viscous, after, response)
    call suite%that('it flows', response%plastic > 0)
    s = response%stress - sum(response%stress(:3)) / 3 * VOIGT_IDENTITY - constants(3) * after([9, 10, 11, 12, 14, 13])
    limit = constants(1) + constants(2) * after(8)
    if (is_viscous) limit = limit + (response%plastic / (0.3_DP * constants(4)))**(1 / constants(5))
    call suite%near('yield', sqrt(1.5_DP * double_dot(s, s)), limit, 1.0e-7_DP * limit)
    call suite%near('along the stress', norm2(response%flow / response%plastic - 1.5_DP * s / sqrt(1.5_DP * double_dot(s, s))), &
      0.0_DP, 1.0e-9_DP)
    call suite%near('state', after(1) - before(1), response%plastic, 1.0e-14_DP)
    do k = 1, 6
      de = 0
      de(k) = STEP
      other = before
      call advance(constants, C, e - engineering + de, is_viscous, other, plus)
      other = before
      call advance(constants, C, e - engineering - de, is_viscous, other, minus)
      call suite%near('tangent', norm2(response%tangent(:, k) - (plus%stress - minus%stress) / (2 * STEP)), 0.0_DP, &
        1.0e-5_DP * norm2(response%tangent))
    end do
    call suite%near('symmetric', norm2(response%tangent - transpose(response%tangent)), 0.0_DP, 1.0e-9_DP * norm2(response%tangent))
  end subroutine check_law


  !> With isotropic elasticity and isotropic hardening alone the return is radial: q_trial - 3 G p = r0 + d1 p.
  subroutine check_isotropic_elasticity(e)
    real(DP), intent(in) :: e(6)
    type(linear_return_type) :: response
    real(DP) :: state(N_LINEAR_STATE), D(6, 6), q
    state = 0
    D = isotropic_tangent(1.0e5_DP, 8.0e4_DP)
    q = von_mises(matmul(D, e))
    call advance([200.0_DP, 1500.0_DP, 0.0_DP, -1.0_DP, 1.0_DP, 0.0_DP], D, e, .true., state, response)
    call suite%near('radial return', response%plastic, (q - 200) / (3 * 8.0e4_DP + 1500), 1.0e-14_DP)
  end subroutine check_isotropic_elasticity


  !> Below the yield stress, creep without time, and an infinite viscosity.
  subroutine check_elastic()
    real(DP), parameter :: E(6) = [1.0e-4_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    type(linear_return_type) :: response
    real(DP) :: state(N_LINEAR_STATE)
    integer :: status
    state = 0
    call advance(PLASTIC, C, E, .false., state, response)
    call suite%that('below the yield stress', response%plastic <= 0 .and. all(abs(state) <= 0))
    call advance(PRIMARY, C, E, .false., state, response)
    call suite%that('creep outside of VISCO', response%plastic <= 0)
    call map_linear_return([0.0_DP, 0.0_DP, 0.0_DP, 1.0e-9_DP, 5.0_DP, 0.5_DP], C, E, [0.3_DP, 0.3_DP], .true., state, response, &
      status)
    call suite%that('t^m is 0 at the start', status == RETURN_OK .and. response%plastic <= 0)
    call suite%near('stress', norm2(response%stress - matmul(C, E)), 0.0_DP, 1.0e-12_DP)
  end subroutine check_elastic

end program test_linear_viscoplasticity
