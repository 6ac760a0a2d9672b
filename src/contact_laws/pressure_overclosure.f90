!> Pressure-overclosure laws of compliant contact, their slope, and the limit of the shear force.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 6. The laws are those of CalculiX's node-to-surface contact (G. Dhondt, CalculiX CrunchiX
!! user's manual, "Node-to-face penalty contact"): the same deck gives the same results. h is the overclosure, minus the gap.
module amontons_pressure_overclosure
  use amontons_kinds, only: DP, PI
  use amontons_friction_slip_scenarios, only: friction_limit
  use amontons_surfaces, only: interaction_type, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED
  implicit none
  private
  public :: evaluate_pressure_overclosure, find_activation_gap, find_shear_limit

  real(DP), parameter :: LOG_HUNDRED = log(100.0_DP)    !< EXPONENTIAL: the pressure at c0 is a hundredth of p0
  real(DP), parameter :: MAX_EXPONENT = 23.0_DP        !< EXPONENTIAL: linear continuation beyond e**23 p0 [-]

contains

  !> Pressure at an overclosure, its slope, and the stored energy per area.
  !!
  !! | law | pressure |
  !! |---|---|
  !! | LINEAR | K h (1/2 + atan(h/eps)/pi), eps = pi sigma_inf/K: K h for h >> eps, -sigma_inf for h << -eps |
  !! | with sigma_inf = 0 | K h: the caller cuts it off at the activation gap |
  !! | EXPONENTIAL | p0 exp(ln(100) h/c0); beyond the gap c0 its tangent, down to zero |
  !! | TABULAR | linear between the points, constant outside |
  !! | TIED | K h |
  pure subroutine evaluate_pressure_overclosure(law, h, p, slope, energy)
    type(interaction_type), intent(in) :: law
    real(DP), intent(in) :: h                      !< overclosure [length]
    real(DP), intent(out) :: p                     !< [stress]
    real(DP), intent(out) :: slope                 !< dp/dh [stress/length]
    real(DP), intent(out) :: energy            !< integral of p dh from h = 0, or from the far side where p vanishes [stress length]
    real(DP) :: eps, share, beta, x
    p = 0.0_DP
    slope = 0.0_DP
    energy = 0.0_DP
    select case (law%behavior)
    case (BEHAVIOR_LINEAR)
      if (law%tension_limit <= 0.0_DP) then
        p = law%stiffness * h
        slope = law%stiffness
        energy = 0.5_DP * law%stiffness * h**2
        return
      end if
      eps = PI * law%tension_limit / law%stiffness
      share = 0.5_DP + atan2(h, eps) / PI
      p = law%stiffness * h * share
      slope = law%stiffness * (share + h * eps / (PI * (eps**2 + h**2)))
      energy = 0.5_DP * law%stiffness * (h**2 * share + eps * (eps * atan2(h, eps) - h) / PI)
    case (BEHAVIOR_EXPONENTIAL)
      beta = LOG_HUNDRED / law%cutoff_clearance
      x = min(max(beta * h, -LOG_HUNDRED), MAX_EXPONENT)
      p = law%pressure * exp(x)
      slope = beta * p
      energy = p / beta - 0.5_DP * law%pressure / (100.0_DP * beta)
      if (x > -LOG_HUNDRED .and. x < MAX_EXPONENT) return
      x = max(h - x / beta, -1.0_DP / beta)
      energy = energy + x * (p + 0.5_DP * slope * x)
      p = p + slope * x
    case (BEHAVIOR_TABULAR)
      call interpolate_pressure_table(law%table_overclosure, law%table_pressure, h, p, slope, energy)
    case (BEHAVIOR_TIED)
      p = law%stiffness * h
      slope = law%stiffness
      energy = 0.5_DP * law%stiffness * h**2
    end select
  end subroutine evaluate_pressure_overclosure


  !> A table, linear between its points and constant outside; the energy counts from the first point.
  pure subroutine interpolate_pressure_table(at, value, h, p, slope, energy)
    real(DP), intent(in) :: at(:)                  !< (n) overclosures, ascending [length]
    real(DP), intent(in) :: value(:)               !< (n) [stress]
    real(DP), intent(in) :: h                      !< [length]
    real(DP), intent(out) :: p, slope, energy
    integer :: i, n
    n = size(at)
    slope = 0.0_DP
    energy = 0.0_DP
    p = value(1)
    if (h < at(1)) then
      energy = p * (h - at(1))
      return
    end if
    do i = 2, n
      if (h <= at(i)) then
        slope = (value(i) - value(i - 1)) / (at(i) - at(i - 1))
        p = value(i - 1) + slope * (h - at(i - 1))
        energy = energy + 0.5_DP * (p + value(i - 1)) * (h - at(i - 1))
        return
      end if
      energy = energy + 0.5_DP * (value(i) + value(i - 1)) * (at(i) - at(i - 1))
    end do
    p = value(n)
    energy = energy + p * (h - at(n))
  end subroutine interpolate_pressure_table


  !> The largest gap at which the law acts. EXPONENTIAL: the zero of the tangent at c0; LINEAR and TABULAR: c0 times the root of the
  !! area, TABULAR under the abaqus dialect also up to the first point of its table; TIED: any.
  pure real(DP) function find_activation_gap(law, area) result(reach)
    type(interaction_type), intent(in) :: law
    real(DP), intent(in) :: area                   !< of the slave node [length^2]
    reach = huge(1.0_DP)
    if (law%behavior == BEHAVIOR_EXPONENTIAL) reach = law%cutoff_clearance * (1.0_DP + 1.0_DP / LOG_HUNDRED)
    if (law%behavior == BEHAVIOR_LINEAR .or. law%behavior == BEHAVIOR_TABULAR) reach = max(law%cutoff_clearance * sqrt(area), &
      law%clearance)
  end function find_activation_gap


  !> Friction limit of a law at a pressure: the largest shear force at a node. TIED slips at TAUMAX alone; under FRIC the law gives
  !! the shear of a sticking node.
  pure real(DP) function find_shear_limit(law, area, pressure, is_bilateral) result(most)
    type(interaction_type), intent(in) :: law
    real(DP), intent(in) :: area                   !< [length^2]
    real(DP), intent(in) :: pressure               !< [stress]
    logical, intent(in) :: is_bilateral            !< the node bears tension (NO SEPARATION)
    most = friction_limit(law%friction, max(pressure, 0.0_DP), law%shear_limit, is_bilateral) * area
    if (law%behavior == BEHAVIOR_TIED .or. law%is_user_friction) most = law%shear_limit * area
  end function find_shear_limit

end module amontons_pressure_overclosure
