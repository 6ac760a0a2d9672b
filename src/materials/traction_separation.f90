!> Cohesive law: tractions between two faces over their separation, with damage.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Components: normal (opening is positive), first and second shear. With the strains e = separation/thickness, the opening
!! strains o (e without a negative normal one) and tau = K o the tractions are
!!
!!     t = (1 - D) tau,   and K e of a normal strain below 0, which damage leaves as it is.
!!
!! The criterion f is the largest of tau/limit or their root of squares (or the same of strains); it is homogeneous of degree 1, so
!! that damage starts at the separation 1/f along the ray to the present one. With the effective separation m = |o| thickness, the
!! effective traction T = |tau| and the fracture energy G of the present mixture of modes the damage on this ray is
!!
!!     linear         D = r (f - 1)/(f (r - 1)),   r = 2 G f^2/(T m)  or, by displacement, r = 1 + d f/m
!!     exponential    D = 1 - exp(-(f^2 - 1) a/(f^2 G - a)),   a = T m/2,   by energy
!!                    D = 1 - (1 - q(x))/f,   q = (1 - exp(-alpha x))/(1 - exp(-alpha)),   x = m (1 - 1/f)/d,   by displacement
!!     tabular        D(m (1 - 1/f))
!!
!! and never decreases. A viscosity mu delays it: mu dDv/dt = D - Dv, by backward Euler; Dv takes the place of D in the tractions.
!! References: P. P. Camanho, C. G. Davila, NASA/TM-2002-211737 (2002); M. L. Benzeggagh, M. Kenane, Compos. Sci. Technol. 56 (1996)
!! 439-449; G. Alfano, M. A. Crisfield, Int. J. Numer. Meth. Engng 50 (2001) 1701-1736. Theory: doc/theory/cohesion.md.
module amontons_traction_separation
  use amontons_kinds, only: DP
  use amontons_logarithmic_strain, only: expm1
  use amontons_materials, only: material_type, damage_type, evaluate_table, SOFTENING_LINEAR, SOFTENING_EXPONENTIAL, MIX_NONE, &
    MIX_POWER_LAW, find_interval
  implicit none
  private
  public :: cohesive_point_type, evaluate_cohesive_law, N_COHESIVE_STATE, STATE_DAMAGE, STATE_DELAYED, STATE_CRITERION

  integer, parameter :: N_COHESIVE_STATE = 3     !< history variables of a point
  integer, parameter :: STATE_DAMAGE = 1         !< D [-]
  integer, parameter :: STATE_DELAYED = 2        !< Dv, which the tractions have [-]
  integer, parameter :: STATE_CRITERION = 3      !< the largest f so far, at most 1 [-]

  !> Input and output of a point.
  type :: cohesive_point_type
    ! input
    real(DP) :: separation(3)                      !< [length]
    real(DP) :: thickness                          !< that strains refer to [length]
    real(DP) :: argument                           !< temperature, or the field variable that the tables are over
    real(DP) :: viscosity = 0                      !< mu [time]
    real(DP) :: time_increment = 0                 !< [time]
    real(DP) :: state_old(N_COHESIVE_STATE) = 0    !< committed
    ! output
    real(DP) :: traction(3)                        !< per reference area [stress]
    real(DP) :: tangent(3, 3)                      !< its derivative by the separation [stress/length]
    real(DP) :: state(N_COHESIVE_STATE)            !< at the end of the increment
    real(DP) :: energy                             !< elastic, per area and thickness [stress]
  end type cohesive_point_type

  !> A scalar and its gradient by the separation.
  type :: graded_type
    real(DP) :: value = 0
    real(DP) :: slope(3) = 0                       !< [1/length]
  end type graded_type

contains

  !> Tractions, tangent, state and energy of a point.
  pure subroutine evaluate_cohesive_law(material, point)
    type(material_type), intent(in) :: material    !< of ELASTIC_TRACTION
    type(cohesive_point_type), intent(inout) :: point       !< input and output as its type states
    type(graded_type) :: damage
    real(DP) :: K(3), strain(3), tau(3), rate
    integer :: i
    call evaluate_table(material%elastic, point%argument, K)
    strain = point%separation / point%thickness
    tau = K * [max(strain(1), 0.0_DP), strain(2:)]
    point%state = point%state_old
    damage%value = point%state(STATE_DAMAGE)
    if (allocated(material%damage)) call find_damage(material%damage, K, tau, point, damage)
    point%state(STATE_DAMAGE) = damage%value
    rate = 1
    if (point%viscosity > 0) rate = point%time_increment / (point%viscosity + point%time_increment)
    point%state(STATE_DELAYED) = point%state_old(STATE_DELAYED) + rate * (damage%value - point%state_old(STATE_DELAYED))
    point%traction = (1 - point%state(STATE_DELAYED)) * tau
    do i = 1, 3
      point%tangent(i, :) = -rate * tau(i) * damage%slope
      point%tangent(i, i) = point%tangent(i, i) + (1 - point%state(STATE_DELAYED)) * K(i) / point%thickness
    end do
    if (strain(1) < 0) then
      point%traction(1) = K(1) * strain(1)
      point%tangent(1, :) = [K(1) / point%thickness, 0.0_DP, 0.0_DP]
    end if
    point%energy = 0.5_DP * dot_product(point%traction, strain)
  end subroutine evaluate_cohesive_law


  !> The damage of the present separation where it exceeds the committed one, and the criterion.
  pure subroutine find_damage(law, K, tau, point, damage)
    type(damage_type), intent(in) :: law
    real(DP), intent(in) :: K(3)                   !< [stress]
    real(DP), intent(in) :: tau(3)                 !< tractions without damage [stress]
    type(cohesive_point_type), intent(inout) :: point       !< the criterion in its state changes
    type(graded_type), intent(inout) :: damage     !< in: committed, without a slope
    type(graded_type) :: f, m, T, G, trial
    f = criterion(law, K, tau, point)
    point%state(STATE_CRITERION) = max(point%state(STATE_CRITERION), min(f%value, 1.0_DP))
    if (.not. (law%has_evolution .and. f%value > 1)) return
    m%value = point%thickness * norm2(tau / K)
    m%slope = point%thickness * (tau / K) / m%value
    T%value = norm2(tau)
    T%slope = tau * K / (point%thickness * T%value)
    if (law%is_by_energy) then
      G = fracture_energy(law, tau, point)
      if (law%softening == SOFTENING_LINEAR) then
        trial = soften_linearly(f, scaled_ratio(f, m, T, G))
      else
        trial = soften_by_energy(f, m, T, G)
      end if
    else
      trial = soften_by_displacement(law, point%argument, f, m)
    end if
    if (trial%value > damage%value) damage = trial
  end subroutine find_damage


  !> The criterion f of the start of damage.
  pure function criterion(law, K, tau, point) result(f)
    type(damage_type), intent(in) :: law
    real(DP), intent(in) :: K(3), tau(3)           !< [stress]
    type(cohesive_point_type), intent(in) :: point
    type(graded_type) :: f
    real(DP) :: limit(3), share(3)
    integer :: i
    call evaluate_table(law%initiation, point%argument, limit)
    if (law%is_of_strain) limit = K * limit
    share = tau / limit
    if (law%is_quadratic) then
      f%value = norm2(share)
      if (f%value > 0) f%slope = share / f%value * K / (limit * point%thickness)
    else
      i = maxloc(abs(share), dim=1)
      f%value = abs(share(i))
      f%slope(i) = sign(K(i) / (limit(i) * point%thickness), share(i))
    end if
  end function criterion


  !> The fracture energy of the present mixture of modes.
  pure function fracture_energy(law, tau, point) result(G)
    type(damage_type), intent(in) :: law
    real(DP), intent(in) :: tau(3)                 !< [stress]
    type(cohesive_point_type), intent(in) :: point
    type(graded_type) :: G
    real(DP) :: work(3), share(3), slope(3, 3), pure_mode(3), total, power
    integer :: i
    if (law%mode_mix == MIX_NONE) then
      call evaluate_table(law%evolution, point%argument, pure_mode(:1))
      G%value = pure_mode(1)
      return
    end if
    call evaluate_table(law%evolution, point%argument, pure_mode)
    work = 0.5_DP * tau * point%separation         ! of a closed normal direction tau is 0
    total = sum(work)
    share = work / total
    do i = 1, 3
      slope(i, :) = -share(i) * tau / total
      slope(i, i) = slope(i, i) + tau(i) / total
    end do
    if (law%mode_mix == MIX_POWER_LAW) then
      power = sum((share / pure_mode)**law%mix_exponent)
      G%value = power**(-1 / law%mix_exponent)
      do i = 1, 3
        if (share(i) > 0) G%slope = G%slope - G%value / power * (share(i) / pure_mode(i))**(law%mix_exponent - 1) * slope(i, :) / &
          pure_mode(i)
      end do
    else
      associate (shear => share(2) + share(3))
        G%value = pure_mode(1) + (pure_mode(2) - pure_mode(1)) * shear**law%mix_exponent
        if (shear > 0) G%slope = (pure_mode(2) - pure_mode(1)) * law%mix_exponent * shear**(law%mix_exponent - 1) * &
          (slope(2, :) + slope(3, :))
      end associate
    end if
  end function fracture_energy


  !> Separation at full damage over that at its start, for linear softening by energy.
  pure function scaled_ratio(f, m, T, G) result(r)
    type(graded_type), intent(in) :: f, m, T, G
    type(graded_type) :: r
    r%value = 2 * G%value * f%value**2 / (T%value * m%value)
    r%slope = r%value * (G%slope / G%value + 2 * f%slope / f%value - T%slope / T%value - m%slope / m%value)
  end function scaled_ratio


  !> Linear softening; full damage at once if no energy is left for it.
  pure function soften_linearly(f, r) result(D)
    type(graded_type), intent(in) :: f, r
    type(graded_type) :: D
    D%value = 1
    if (f%value >= r%value) return
    D%value = r%value * (f%value - 1) / (f%value * (r%value - 1))
    D%slope = r%value / ((r%value - 1) * f%value**2) * f%slope - (f%value - 1) / (f%value * (r%value - 1)**2) * r%slope
  end function soften_linearly


  !> Exponential softening by energy.
  pure function soften_by_energy(f, m, T, G) result(D)
    type(graded_type), intent(in) :: f, m, T, G
    type(graded_type) :: D
    type(graded_type) :: a
    real(DP) :: above, below, above_slope(3), below_slope(3)
    D%value = 1
    a%value = 0.5_DP * T%value * m%value
    a%slope = 0.5_DP * (T%value * m%slope + m%value * T%slope)
    below = f%value**2 * G%value - a%value
    if (.not. below > 0) return
    above = (f%value**2 - 1) * a%value
    above_slope = 2 * f%value * a%value * f%slope + (f%value**2 - 1) * a%slope
    below_slope = 2 * f%value * G%value * f%slope + f%value**2 * G%slope - a%slope
    D%value = 1 - exp(-above / below)
    D%slope = exp(-above / below) * (above_slope - above / below * below_slope) / below
  end function soften_by_energy


  !> Softening by the separation since the start of damage.
  pure function soften_by_displacement(law, argument, f, m) result(D)
    type(damage_type), intent(in) :: law
    real(DP), intent(in) :: argument
    type(graded_type), intent(in) :: f, m
    type(graded_type) :: D, r, past
    real(DP) :: constants(2), q, alpha, x, slope
    integer :: i
    past%value = m%value * (1 - 1 / f%value)
    past%slope = (1 - 1 / f%value) * m%slope + m%value / f%value**2 * f%slope
    constants = 0
    if (law%softening == SOFTENING_LINEAR) then
      call evaluate_table(law%evolution, argument, constants(:1))
      r%value = 1 + constants(1) * f%value / m%value
      r%slope = constants(1) * (f%slope - f%value / m%value * m%slope) / m%value
      D = soften_linearly(f, r)
    else if (law%softening == SOFTENING_EXPONENTIAL) then
      call evaluate_table(law%evolution, argument, constants)
      D%value = 1
      x = past%value / constants(1)
      alpha = constants(2)
      if (x >= 1) return
      if (abs(alpha) > 0) then
        q = expm1(-alpha * x) / expm1(-alpha)
        slope = -alpha * exp(-alpha * x) / expm1(-alpha)
      else
        q = x
        slope = 1
      end if
      D%value = 1 - (1 - q) / f%value
      D%slope = (1 - q) / f%value**2 * f%slope + slope / (f%value * constants(1)) * past%slope
    else
      associate (table => law%table)
        D%value = table(2, size(table, 2))
        if (past%value >= table(1, size(table, 2))) return
        call find_interval(table(1, :), past%value, i, x)
        slope = (table(2, i + 1) - table(2, i)) / (table(1, i + 1) - table(1, i))
        D%value = table(2, i) + slope * (past%value - table(1, i))
        D%slope = slope * past%slope
      end associate
    end if
  end function soften_by_displacement

end module amontons_traction_separation
