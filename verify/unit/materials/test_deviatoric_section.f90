!> Unit test of amontons_deviatoric_section: values on the meridians, derivatives by differences, the equation of the flow.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deviatoric_section
  use amontons_kinds, only: DP, PI
  use amontons_deviatoric_section, only: deviatoric_section_type, deviator_return_type, evaluate_section, return_deviator, &
    lode_axes, lode_angle, SECTION_RATIO, SECTION_MENETREY_WILLAM, SECTION_MOHR_COULOMB
  use check, only: suite_type
  implicit none
  real(DP), parameter :: G = 400.0_DP, PHI = 0.5_DP
  type(suite_type) :: suite
  type(deviatoric_section_type) :: section
  real(DP) :: e, m
  integer :: i
  m = (3 - sin(PHI)) / (6 * cos(PHI))
  e = (3 - sin(PHI)) / (3 + sin(PHI))
  call check_section(deviatoric_section_type(SECTION_RATIO, ratio=1.0_DP), 1.0_DP, 1.0_DP, 'round')
  call check_section(deviatoric_section_type(SECTION_RATIO, ratio=0.8_DP), 1.0_DP, 1 / 0.8_DP, 'ratio')
  call check_section(deviatoric_section_type(SECTION_MENETREY_WILLAM, ratio=e, factor=m), m, m / e, 'Menetrey-Willam')
  call check_section(deviatoric_section_type(SECTION_MENETREY_WILLAM, ratio=1.0_DP, factor=m), m, m, 'Menetrey-Willam, round')
  call check_section(deviatoric_section_type(SECTION_MOHR_COULOMB, friction=PHI), m, m / e, 'Mohr-Coulomb')
  call check_axes()
  do i = 1, 3
    section = deviatoric_section_type(SECTION_RATIO, ratio=0.778_DP)
    if (i == 2) section = deviatoric_section_type(SECTION_MENETREY_WILLAM, ratio=e, factor=m)
    if (i == 3) section = deviatoric_section_type(SECTION_MENETREY_WILLAM, ratio=0.55_DP, factor=m)
    call check_return(section, 0.3_DP, 0.4_DP, 'between')
    call check_return(section, 0.9_DP, 0.7_DP, 'small flow')
    call check_return(section, 1.0e-3_DP, 0.5_DP, 'near the axis')
    call check_return(section, 0.5_DP, 0.0_DP, 'extension')
    call check_return(section, 0.5_DP, PI / 3, 'compression')
    call check_return(section, 0.0_DP, 0.6_DP, 'all deviator')
  end do
  call suite%finish()

contains

  !> Values of t/q in triaxial compression and extension; derivatives; convexity: H + H'' >= 0.
  subroutine check_section(section, compression, extension, name)
    type(deviatoric_section_type), intent(in) :: section
    real(DP), intent(in) :: compression, extension
    character(*), intent(in) :: name
    real(DP), parameter :: STEP = 1.0e-5_DP
    real(DP) :: H(3), dH(3), ddH(3), theta
    integer :: i
    call evaluate_section(section, PI / 3, H(1), dH(1), ddH(1))
    call suite%near(name // ': compression', H(1), sqrt(1.5_DP) * compression, 1e-14_DP)
    if (section%kind /= SECTION_MOHR_COULOMB) call suite%near(name // ': smooth in compression', dH(1), 0.0_DP, 1e-13_DP)
    call evaluate_section(section, 0.0_DP, H(1), dH(1), ddH(1))
    call suite%near(name // ': extension', H(1), sqrt(1.5_DP) * extension, 1e-14_DP)
    if (section%kind /= SECTION_MOHR_COULOMB) call suite%near(name // ': smooth in extension', dH(1), 0.0_DP, 1e-13_DP)
    do i = 1, 9
      theta = PI / 30 * real(i, DP)
      call evaluate_section(section, theta - STEP, H(1), dH(1), ddH(1))
      call evaluate_section(section, theta + STEP, H(3), dH(3), ddH(3))
      call evaluate_section(section, theta, H(2), dH(2), ddH(2))
      call suite%near(name // ': slope', dH(2), (H(3) - H(1)) / (2 * STEP), 1e-8_DP)
      call suite%near(name // ': curvature', ddH(2), (dH(3) - dH(1)) / (2 * STEP), 1e-8_DP)
      call suite%that(name // ': convex', H(2) + ddH(2) > -1e-13_DP)
      if (section%kind == SECTION_MOHR_COULOMB) call suite%near(name // ': hexagon', hexagon(theta), H(2), 1e-14_DP)
    end do
  end subroutine check_section


  !> Mohr and Coulomb's criterion without pressure of a unit deviator: (s1 - s3 + (s1 + s3) sin(phi))/(2 cos(phi)).
  real(DP) function hexagon(theta)
    real(DP), intent(in) :: theta
    real(DP) :: axes(3, 2)
    axes = lode_axes(theta)
    hexagon = (axes(1, 1) - axes(3, 1) + (axes(1, 1) + axes(3, 1)) * sin(PHI)) / (2 * cos(PHI))
  end function hexagon


  !> The axes are orthonormal deviators, in descending order; the angle of one is found again.
  subroutine check_axes()
    real(DP) :: axes(3, 2), theta, s(3)
    integer :: i
    do i = 0, 10
      theta = PI / 30 * real(i, DP)
      axes = lode_axes(theta)
      call suite%near('axes', sum(abs(matmul(transpose(axes), axes) - reshape([1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [2, 2]))), 0.0_DP, &
        1e-14_DP)
      call suite%near('axes: trace', sum(abs(sum(axes, dim=1))), 0.0_DP, 1e-14_DP)
      s = 7 * axes(:, 1)
      call suite%that('axes: order', s(1) >= s(2) - 1e-14_DP .and. s(2) >= s(3) - 1e-14_DP)
      call suite%near('axes: angle', lode_angle(s), theta, 1e-14_DP)
      call suite%near('axes: cos(3 theta)', 13.5_DP * product(s) / (1.5_DP * sum(s**2))**1.5_DP, cos(3 * theta), 1e-13_DP)
    end do
  end subroutine check_axes


  !> s + 2 G mu n = s_trial with y = 1/(1 + 3 G mu/t), and derivatives by differences in the deviatoric plane.
  subroutine check_return(section, y, theta, name)
    type(deviatoric_section_type), intent(in) :: section
    real(DP), intent(in) :: y, theta
    character(*), intent(in) :: name
    type(deviator_return_type) :: back, plus, minus
    real(DP) :: axes(3, 2), trial(3), H, dH, ddH, slope(2), tolerance
    real(DP), parameter :: RHO = 20.0_DP, STEP = 1.0e-5_DP
    logical :: is_found
    integer :: i
    trial = RHO * matmul(lode_axes(theta), [1.0_DP, 0.0_DP])
    call return_deviator(section, G, RHO, theta, y, back, is_found)
    call suite%that(name // ': found', is_found)
    call evaluate_section(section, back%theta, H, dH, ddH)
    axes = lode_axes(back%theta)
    call suite%near(name // ': flow', norm2(back%rho * axes(:, 1) + 2 * G * back%mu * matmul(axes, [H, dH]) - trial), 0.0_DP, &
      1e-11_DP * RHO)
    call suite%near(name // ': y', y * (back%t + 3 * G * back%mu), back%t, 1e-12_DP * RHO)
    do i = 1, 2
      slope = merge(STEP, 0.0_DP, [1, 2] == i)
      call turned_return(section, trial + matmul(axes, slope), y, plus)
      call turned_return(section, trial - matmul(axes, slope), y, minus)
      call suite%near(name // ': dt', back%dt(i), (plus%t - minus%t) / (2 * STEP), 1e-6_DP)
      call suite%near(name // ': dmu', G * back%dmu(i), G * (plus%mu - minus%mu) / (2 * STEP), 1e-6_DP)
      slope = matmul(deviator(plus) - deviator(minus), axes) / (2 * STEP)
      call suite%near(name // ': ds', norm2(slope - back%ds(:, i)), 0.0_DP, 1e-6_DP)
    end do
    if (y < 2 * STEP) return
    call return_deviator(section, G, RHO, theta, y + STEP * y, plus, is_found)
    call return_deviator(section, G, RHO, theta, y - STEP * y, minus, is_found)
    tolerance = 1e-6_DP * RHO
    call suite%near(name // ': dt/dy', back%dt(3), (plus%t - minus%t) / (2 * STEP * y), tolerance)
    call suite%near(name // ': dmu/dy', G * back%dmu(3), G * (plus%mu - minus%mu) / (2 * STEP * y), tolerance)
    slope = matmul(deviator(plus) - deviator(minus), axes) / (2 * STEP * y)
    call suite%near(name // ': ds/dy', norm2(slope - back%ds(:, 3)), 0.0_DP, tolerance)
  end subroutine check_return


  !> The return of a deviator, whose order may be another.
  subroutine turned_return(section, trial, y, back)
    type(deviatoric_section_type), intent(in) :: section
    real(DP), intent(in) :: trial(3), y
    type(deviator_return_type), intent(out) :: back
    real(DP) :: theta
    logical :: is_found
    theta = atan2((trial(2) - trial(3)) / sqrt(2.0_DP), sqrt(1.5_DP) * trial(1))
    is_found = theta >= 0 .and. theta <= PI / 3
    if (is_found) then
      call return_deviator(section, G, norm2(trial), theta, y, back, is_found)
    else                                           ! across a meridian: the mirror image
      call return_deviator(section, G, norm2(trial), merge(-theta, 2 * PI / 3 - theta, theta < 0), y, back, is_found)
      back%theta = merge(-back%theta, 2 * PI / 3 - back%theta, theta < 0)
    end if
  end subroutine turned_return


  !> The deviator of a return.
  function deviator(back) result(s)
    type(deviator_return_type), intent(in) :: back
    real(DP) :: s(3)
    s = back%rho * matmul(lode_axes(back%theta), [1.0_DP, 0.0_DP])
  end function deviator

end program test_deviatoric_section
