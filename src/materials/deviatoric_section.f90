!> Sections of yield surfaces and flow potentials across the hydrostatic axis, and the return of a deviator that flows along one.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A section is a convex function t(s) of the deviator s, of degree one: t = rho H(theta), rho = |s|, theta the Lode angle, from 0
!! in triaxial extension to pi/3 in triaxial compression; cos(3 theta) = 27 det(s)/(2 q^3). Implicit flow along its gradient n,
!!
!!     s + 2 G mu n(s) = s_trial,        n = H e + H' e',
!!
!! e along s and e' across it in the deviatoric plane, is the minimum of |s - s_trial|^2/2 + 2 G mu t(s): it exists for every mu
!! and is unique. With y = 1/(1 + 3 G mu/t), from 1 without flow to 0 where s vanishes, one equation for theta is left, whose
!! function descends from theta = 0 to pi/3; mu stays finite at y = 0, and mu/t is given at s_trial = 0, too.
!! References: Abaqus Theory Manual, section 4.4 (t by K); P. Menetrey, K. J. Willam, ACI Struct. J. 92 (1995) 311-318.
module amontons_deviatoric_section
  use amontons_kinds, only: DP, PI
  use amontons_scalar_root, only: root_search_type, improve_root, MAX_ROOT_ITERATIONS
  implicit none
  private
  public :: deviatoric_section_type, deviator_return_type, evaluate_section, return_deviator, lode_axes, lode_angle
  public :: SECTION_RATIO, SECTION_MENETREY_WILLAM, SECTION_MOHR_COULOMB

  integer, parameter :: SECTION_RATIO = 1           !< t = q/2 (1 + 1/K - (1 - 1/K) cos(3 theta)), ratio K
  integer, parameter :: SECTION_MENETREY_WILLAM = 2 !< smooth and elliptic, ratio e of extension to compression, factor: t/q there
  integer, parameter :: SECTION_MOHR_COULOMB = 3    !< Mohr and Coulomb's hexagon of the friction angle; no potential

  !> One section.
  type :: deviatoric_section_type
    integer :: kind = SECTION_RATIO
    real(DP) :: ratio = 1                           !< K or e [-]
    real(DP) :: factor = 1                          !< t over q in triaxial compression [-]
    real(DP) :: friction = 0                        !< friction angle of SECTION_MOHR_COULOMB [rad]
  end type deviatoric_section_type

  !> The deviator after the flow, and its derivatives. Vectors in the deviatoric plane have components along e and across it.
  type :: deviator_return_type
    real(DP) :: theta = 0                           !< Lode angle [rad]
    real(DP) :: rho = 0                             !< |s| [stress]
    real(DP) :: t = 0                               !< [stress]
    real(DP) :: mu = 0                              !< multiplier of the flow [-]
    real(DP) :: ds(2, 3) = 0                        !< s by the trial deviator along e, across it [-], and by y [stress]
    real(DP) :: dt(3) = 0                           !< t by the same
    real(DP) :: dmu(3) = 0                          !< mu by the same
  end type deviator_return_type

contains

  !> H = t/rho of a section and its derivatives by the Lode angle.
  pure subroutine evaluate_section(section, theta, H, dH, ddH)
    type(deviatoric_section_type), intent(in) :: section
    real(DP), intent(in) :: theta                   !< from 0 to pi/3 [rad]
    real(DP), intent(out) :: H, dH, ddH             !< [-]
    real(DP) :: c, s, a, b, root, droot, N, D, dN, dD, ddD, R, dR, ddR
    select case (section%kind)
    case (SECTION_RATIO)
      a = 0.5_DP * (1 + 1 / section%ratio)
      b = 0.5_DP * (1 / section%ratio - 1)
      H = a + b * cos(3 * theta)
      dH = -3 * b * sin(3 * theta)
      ddH = -9 * b * cos(3 * theta)
    case (SECTION_MENETREY_WILLAM)
      c = cos(theta)
      s = sin(theta)
      a = 4 * (1 - section%ratio**2)
      b = 2 * section%ratio - 1
      root = sqrt(a * c * c + section%ratio * (5 * section%ratio - 4))
      droot = a * c / root
      N = a * c * c + b * b                         ! R = N/D and its derivatives by c
      D = 0.5_DP * a * c + b * root
      dN = 2 * a * c
      dD = 0.5_DP * a + b * droot
      ddD = b * (a - droot**2) / root
      R = N / D
      dR = (dN - R * dD) / D
      ddR = (2 * a - 2 * dR * dD - R * ddD) / D
      H = section%factor * R
      dH = -section%factor * dR * s
      ddH = section%factor * (ddR * s * s - dR * c)
    case default
      a = 1 / (sqrt(3.0_DP) * cos(section%friction))
      b = tan(section%friction) / 3
      H = a * sin(theta + PI / 3) + b * cos(theta + PI / 3)
      dH = a * cos(theta + PI / 3) - b * sin(theta + PI / 3)
      ddH = -H
    end select
    H = sqrt(1.5_DP) * H
    dH = sqrt(1.5_DP) * dH
    ddH = sqrt(1.5_DP) * ddH
  end subroutine evaluate_section


  !> The unit vectors along a deviator of given Lode angle and across it, in descending principal values.
  pure function lode_axes(theta) result(axes)
    real(DP), intent(in) :: theta                   !< [rad]
    real(DP) :: axes(3, 2)                          !< e, e' = de/dtheta
    real(DP), parameter :: PLACE(3) = [0.0_DP, 2 * PI / 3, -2 * PI / 3]
    axes(:, 1) = sqrt(2 / 3.0_DP) * cos(theta - PLACE)
    axes(:, 2) = -sqrt(2 / 3.0_DP) * sin(theta - PLACE)
  end function lode_axes


  !> The Lode angle of a deviator [rad]; 0 without one.
  pure real(DP) function lode_angle(s) result(theta)
    real(DP), intent(in) :: s(3)                    !< principal values, descending [stress]
    theta = 0
    if (s(1) > 0) theta = atan2((s(2) - s(3)) / sqrt(2.0_DP), sqrt(1.5_DP) * s(1))
  end function lode_angle


  !> The deviator after flow along a convex and smooth section.
  pure subroutine return_deviator(section, G, rho_trial, theta_trial, y, back, is_found)
    type(deviatoric_section_type), intent(in) :: section
    real(DP), intent(in) :: G                       !< shear modulus [stress]
    real(DP), intent(in) :: rho_trial               !< norm of the trial deviator [stress]
    real(DP), intent(in) :: theta_trial             !< its Lode angle [rad]
    real(DP), intent(in) :: y                       !< from 0 to 1 [-]
    type(deviator_return_type), intent(out) :: back
    logical, intent(out) :: is_found
    real(DP) :: H, dH, ddH, flow, radial, along, B(2, 2), n(2)
    flow = (2 / 3.0_DP) * (1 - y)                   ! 2 G mu y/t
    call find_lode_angle(section, theta_trial, y, flow, back%theta, is_found)
    if (.not. is_found) return
    call evaluate_section(section, back%theta, H, dH, ddH)
    n = [H, dH]
    radial = y + flow * H**2
    along = rho_trial * cos(theta_trial - back%theta) / radial   ! rho/y
    back%rho = y * along
    back%t = back%rho * H
    back%mu = (1 - y) * along * H / (3 * G)
    B = reshape([y + flow * (dH**2 + H * (H + ddH)), -flow * H * dH, -flow * H * dH, radial], [2, 2])
    B = B / (B(1, 1) * B(2, 2) - B(1, 2)**2)
    back%ds(:, :2) = y * B
    back%ds(:, 3) = (2 / 3.0_DP) * along * H * matmul(B, n)
    back%dt = matmul(n, back%ds)
    back%dmu(:2) = (1 - y) / (3 * G) * matmul(n, B)
    back%dmu(3) = -along * H / (3 * G) / (radial + flow * y * dH**2 / (y + flow * H * (H + ddH)))
  end subroutine return_deviator


  !> The Lode angle after the flow: sin(theta_trial - theta) (y + f H^2) = f H H' cos(theta_trial - theta), f = 2 G mu y/t.
  pure subroutine find_lode_angle(section, theta_trial, y, flow, theta, is_found)
    type(deviatoric_section_type), intent(in) :: section
    real(DP), intent(in) :: theta_trial             !< [rad]
    real(DP), intent(in) :: y, flow                 !< [-]
    real(DP), intent(out) :: theta                  !< [rad]
    logical, intent(out) :: is_found
    type(root_search_type) :: search
    real(DP) :: H, dH, ddH, s, c, f, df
    integer :: i
    search%x = theta_trial
    search%high = PI / 3
    search%scale = 1
    is_found = .false.
    do i = 0, MAX_ROOT_ITERATIONS
      theta = min(max(search%x, 0.0_DP), PI / 3)
      is_found = search%is_found
      if (is_found) return
      call evaluate_section(section, theta, H, dH, ddH)
      s = sin(theta_trial - theta)
      c = cos(theta_trial - theta)
      f = s * (y + flow * H**2) - flow * H * dH * c
      df = flow * H * dH * s - c * (y + flow * (H**2 + dH**2 + H * ddH))
      if (.not. abs(f) > 0) then                    ! on a meridian, where both sides of the bracket may be its end
        is_found = .true.
        return
      end if
      call improve_root(search, -f, -df)
    end do
  end subroutine find_lode_angle

end module amontons_deviatoric_section
