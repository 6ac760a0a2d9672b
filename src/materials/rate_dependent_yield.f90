!> Yield stress of metals that depends on the rate of the equivalent plastic strain, in the unknown of the return mapping.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! With p the plastic strain of an increment of length dt the rate is p/dt (backward Euler). Static yield stress y, ratio R to it:
!!
!! | law | yield stress | unknown x |
!! |---|---|---|
!! | power law, n >= 1 | (1 + (p/(dt D))^(1/n)) y | R - 1: p = dt D x^n |
!! | power law, n < 1 | the same | p/(dt D): R = 1 + x^(1/n) |
!! | table | R(p/dt) y | p |
!! | curves of several rates | linear between the curves, constant outside | p |
!!
!! In these unknowns strain and yield stress have finite slopes, also where flow begins.
!!
!! Reference of the power law: P. S. Symonds, Survey of Methods of Analysis for Plastic Deformation of Structures under Dynamic
!! Loading, Brown University, report BU/NSRDC/1-67 (1967).
module amontons_rate_dependent_yield
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, evaluate_curves, evaluate_table, find_interval, RATE_POWER, RATE_RATIO, RATE_CURVES
  implicit none
  private
  public :: yield_point_type, evaluate_rate_yield, estimate_rate_flow

  !> Plastic strain of the increment and yield stress at a value of the unknown.
  type :: yield_point_type
    real(DP) :: p = 0, dp = 0                      !< plastic strain and its derivative by the unknown [-]
    real(DP) :: yield = 0, slope = 0               !< yield stress and its derivative by the unknown [stress]
  end type yield_point_type

contains

  !> Plastic strain and yield stress at a value of the unknown.
  pure subroutine evaluate_rate_yield(material, argument, dt, p_old, x, at)
    type(material_type), intent(in) :: material    !< with a rate law
    real(DP), intent(in) :: argument               !< of the tables [temperature]
    real(DP), intent(in) :: dt                     !< length of the increment, above 0 [time]
    real(DP), intent(in) :: p_old                  !< committed equivalent plastic strain [-]
    real(DP), intent(in) :: x                      !< the unknown, 0 or more
    type(yield_point_type), intent(out) :: at
    real(DP) :: law(2), ratio, ratio_slope, static, hardening
    at%p = x
    at%dp = 1
    select case (material%rate_law)
    case (RATE_POWER)
      call evaluate_table(material%rate_power, argument, law)
      associate (scale => dt * law(1), n => law(2))
        if (n < 1) then
          at%p = scale * x
          at%dp = scale
          ratio = 1 + x**(1 / n)
          ratio_slope = x**(1 / n - 1) / n
        else
          at%p = scale * x**n
          at%dp = scale * n * x**(n - 1)
          ratio = 1 + x
          ratio_slope = 1
        end if
      end associate
    case (RATE_RATIO)
      call evaluate_curves(material%rate_ratio, argument, x / dt, ratio, ratio_slope)
      ratio_slope = ratio_slope / dt
    case (RATE_CURVES)
      call evaluate_rate_curves(material, argument, dt, p_old, at)
      return
    end select
    call evaluate_curves(material%isotropic_hardening, argument, p_old + at%p, static, hardening)
    at%yield = ratio * static
    at%slope = ratio_slope * static + ratio * hardening * at%dp
  end subroutine evaluate_rate_yield


  !> The yield stress between the curves of two rates.
  pure subroutine evaluate_rate_curves(material, argument, dt, p_old, at)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: argument               !< of the tables [temperature]
    real(DP), intent(in) :: dt                     !< length of the increment [time]
    real(DP), intent(in) :: p_old                  !< committed equivalent plastic strain [-]
    type(yield_point_type), intent(inout) :: at    !< in: p
    real(DP) :: s, upper, upper_slope
    integer :: i
    associate (rates => material%rate_curves%rate)
      call find_interval(rates, at%p / dt, i, s)
      call evaluate_curves(material%rate_curves(i)%curves, argument, p_old + at%p, at%yield, at%slope)
      if (i == size(rates) .or. at%p < dt * rates(1)) return
      call evaluate_curves(material%rate_curves(i + 1)%curves, argument, p_old + at%p, upper, upper_slope)
      at%slope = at%slope + s * (upper_slope - at%slope) + (upper - at%yield) / (dt * (rates(i + 1) - rates(i)))
      at%yield = at%yield + s * (upper - at%yield)
    end associate
  end subroutine evaluate_rate_curves


  !> Where the search for the unknown begins, and its largest value: that of a flow which takes all of the trial stress.
  pure subroutine estimate_rate_flow(material, argument, dt, p_old, trial, start, most)
    type(material_type), intent(in) :: material    !< with a rate law
    real(DP), intent(in) :: argument               !< of the tables [temperature]
    real(DP), intent(in) :: dt                     !< length of the increment, above 0 [time]
    real(DP), intent(in) :: p_old                  !< committed equivalent plastic strain [-]
    real(DP), intent(in) :: trial(2)               !< von Mises stress of the trial, and what it loses per plastic strain [stress]
    real(DP), intent(out) :: start, most
    real(DP) :: law(2), static, hardening
    start = 0
    most = trial(1) / trial(2)
    if (material%rate_law /= RATE_POWER) return
    call evaluate_table(material%rate_power, argument, law)
    call evaluate_curves(material%isotropic_hardening, argument, p_old, static, hardening)
    associate (ratio => most / (dt * law(1)), n => law(2), over => max(trial(1) / static - 1, 0.0_DP))
      if (n < 1) then
        most = ratio
        start = min(ratio, over**n)
      else
        most = ratio**(1 / n)
        start = min(most, over)
      end if
    end associate
  end subroutine estimate_rate_flow

end module amontons_rate_dependent_yield
