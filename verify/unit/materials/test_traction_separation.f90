!> Unit test of amontons_traction_separation: softening in closed form, fracture energies, derivatives, unloading, viscosity.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_traction_separation
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, property_table_type, ELASTIC_TRACTION, SOFTENING_LINEAR, SOFTENING_EXPONENTIAL, &
    SOFTENING_TABULAR, MIX_NONE, MIX_POWER_LAW, MIX_BENZEGGAGH_KENANE
  use amontons_traction_separation, only: cohesive_point_type, evaluate_cohesive_law, STATE_DAMAGE, STATE_DELAYED, STATE_CRITERION
  use check, only: suite_type
  implicit none
  real(DP), parameter :: K(3) = [1000.0_DP, 600.0_DP, 400.0_DP], LIMIT(3) = [10.0_DP, 8.0_DP, 7.0_DP], &
    G(3) = [0.4_DP, 0.9_DP, 1.1_DP]
  type(suite_type) :: suite
  integer :: softening, mix
  logical :: is_quadratic, is_of_strain
  integer :: i

  call check_linear()
  call check_unloading()
  call check_energies()
  call check_mixtures()
  call check_viscosity()
  do softening = SOFTENING_LINEAR, SOFTENING_TABULAR
    do i = 0, 3
      is_quadratic = mod(i, 2) == 1
      is_of_strain = i > 1
      call check_derivatives(law(softening, softening /= SOFTENING_TABULAR, MIX_NONE))
      call check_derivatives(law(softening, .false., MIX_NONE))
      if (softening == SOFTENING_TABULAR) cycle
      do mix = MIX_POWER_LAW, MIX_BENZEGGAGH_KENANE
        call check_derivatives(law(softening, .true., mix))
      end do
    end do
  end do
  call suite%finish()

contains

  !> A material with damage by the criterion of is_quadratic and is_of_strain.
  function law(softening, is_by_energy, mix) result(material)
    integer, intent(in) :: softening, mix
    logical, intent(in) :: is_by_energy
    type(material_type) :: material
    material%elastic_kind = ELASTIC_TRACTION
    material%elastic = property_table_type([0.0_DP], reshape(K, [3, 1]))
    allocate (material%damage)
    associate (damage => material%damage)
      damage%is_quadratic = is_quadratic
      damage%is_of_strain = is_of_strain
      damage%initiation = property_table_type([0.0_DP], reshape(LIMIT, [3, 1]))
      if (is_of_strain) damage%initiation%value(:, 1) = LIMIT / K
      damage%has_evolution = .true.
      damage%is_by_energy = is_by_energy
      damage%softening = softening
      damage%mode_mix = mix
      damage%mix_exponent = 1.7_DP
      if (softening == SOFTENING_TABULAR) then
        damage%table = reshape([0.0_DP, 0.0_DP, 0.02_DP, 0.5_DP, 0.07_DP, 0.8_DP, 0.1_DP, 1.0_DP], [2, 4])
      else if (mix /= MIX_NONE) then
        damage%evolution = property_table_type([0.0_DP], reshape(G, [3, 1]))
      else if (is_by_energy) then
        damage%evolution = property_table_type([0.0_DP], reshape(G(:1), [1, 1]))
      else
        damage%evolution = property_table_type([0.0_DP], reshape([0.08_DP, 2.0_DP], [2, 1]))
        if (softening == SOFTENING_LINEAR) damage%evolution%value = damage%evolution%value(:1, :)
      end if
    end associate
  end function law


  !> A point at a separation.
  function evaluate(material, separation, past) result(point)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: separation(3)
    type(cohesive_point_type), intent(in), optional :: past
    type(cohesive_point_type) :: point
    point%separation = separation
    point%thickness = 1
    point%argument = 0
    point%time_increment = 1
    if (present(past)) point%state_old = past%state
    call evaluate_cohesive_law(material, point)
  end function evaluate


  !> Linear softening in the normal direction: t = limit (df - d)/(df - d0), d0 = limit/K, df = 2 G/limit; pressure stays elastic.
  subroutine check_linear()
    type(cohesive_point_type) :: point
    real(DP) :: d, d0, df
    is_quadratic = .true.
    is_of_strain = .false.
    d0 = LIMIT(1) / K(1)
    df = 2 * G(1) / LIMIT(1)
    d = 0.5_DP * (d0 + df)
    point = evaluate(law(SOFTENING_LINEAR, .true., MIX_NONE), [d, 0.0_DP, 0.0_DP])
    call suite%near('linear softening', point%traction(1), LIMIT(1) * (df - d) / (df - d0), 1.0e-12_DP)
    call suite%near('its slope', point%tangent(1, 1), -LIMIT(1) / (df - d0), 1.0e-10_DP)
    call suite%near('its damage', point%state(STATE_DAMAGE), 1 - point%traction(1) / (K(1) * d), 1.0e-14_DP)
    call suite%near('its criterion', point%state(STATE_CRITERION), 1.0_DP, 0.0_DP)
    call suite%near('its energy', point%energy, 0.5_DP * point%traction(1) * d, 1.0e-14_DP)
    point = evaluate(law(SOFTENING_LINEAR, .true., MIX_NONE), [df, 0.0_DP, 0.0_DP])
    call suite%near('the end', norm2(point%traction), 0.0_DP, 0.0_DP)
    point = evaluate(law(SOFTENING_LINEAR, .true., MIX_NONE), [-df, 0.0_DP, 0.0_DP])
    call suite%near('pressure', point%traction(1), -K(1) * df, 1.0e-12_DP)
    call suite%near('without damage', norm2(point%state), 0.0_DP, 0.0_DP)
    point = evaluate(law(SOFTENING_LINEAR, .true., MIX_NONE), [0.5_DP * d0, 0.0_DP, 0.0_DP])
    call suite%near('below the limit', point%state(STATE_CRITERION), 0.5_DP, 1.0e-14_DP)
    point = evaluate(law(SOFTENING_LINEAR, .true., MIX_NONE), [-df, 0.0_DP, 0.03_DP])
    call suite%near('pressure beside damage', point%traction(1), -K(1) * df, 1.0e-12_DP)
    call suite%that('shear beside pressure is damaged', point%state(STATE_DAMAGE) > 0 .and. point%traction(3) < K(3) * 0.03_DP)
  end subroutine check_linear


  !> Unloading follows the secant, and damage stays.
  subroutine check_unloading()
    type(cohesive_point_type) :: loaded, point
    loaded = evaluate(law(SOFTENING_EXPONENTIAL, .true., MIX_BENZEGGAGH_KENANE), [0.03_DP, 0.02_DP, 0.0_DP])
    point = evaluate(law(SOFTENING_EXPONENTIAL, .true., MIX_BENZEGGAGH_KENANE), [0.015_DP, 0.01_DP, 0.0_DP], loaded)
    call suite%near('unloading to the half', norm2(point%traction - 0.5_DP * loaded%traction), 0.0_DP, 1.0e-14_DP)
    call suite%near('damage stays', point%state(STATE_DAMAGE), loaded%state(STATE_DAMAGE), 0.0_DP)
    call suite%near('secant stiffness', point%tangent(2, 2), (1 - loaded%state(STATE_DAMAGE)) * K(2), 1.0e-12_DP)
  end subroutine check_unloading


  !> The work until full damage is the fracture energy of each pure mode.
  subroutine check_energies()
    integer :: mode, n, s
    real(DP) :: work, step, separation(3), old(3)
    type(cohesive_point_type) :: point
    integer, parameter :: STEPS = 200000
    is_quadratic = .true.
    is_of_strain = .false.
    do s = SOFTENING_LINEAR, SOFTENING_EXPONENTIAL
      do mode = 1, 3
        step = merge(2.2_DP, 60.0_DP, s == SOFTENING_LINEAR) * G(mode) / LIMIT(mode) / STEPS
        work = 0
        separation = 0
        old = 0
        do n = 1, STEPS
          separation(mode) = real(n, DP) * step
          point = evaluate(law(s, .true., MIX_POWER_LAW), separation)
          work = work + 0.5_DP * step * (old(mode) + point%traction(mode))
          old = point%traction
        end do
        call suite%near('fracture energy', work, G(mode), 1.0e-7_DP)
      end do
    end do
  end subroutine check_energies


  !> On a straight path the work until full damage is the energy of the mixture; with one stiffness for all directions the shares of
  !! the energy are those of the squared separation.
  subroutine check_mixtures()
    type(material_type) :: material
    type(cohesive_point_type) :: point
    real(DP) :: work, ray(3), shear, old, now, step
    integer :: n, m
    integer, parameter :: STEPS = 100000
    ray = [3.0_DP, 4.0_DP, 0.0_DP] / 5
    shear = 16.0_DP / 25
    do m = MIX_POWER_LAW, MIX_BENZEGGAGH_KENANE
      material = law(SOFTENING_LINEAR, .true., m)
      material%elastic%value = 1000
      step = 0.3_DP / STEPS
      work = 0
      old = 0
      do n = 1, STEPS
        point = evaluate(material, real(n, DP) * step * ray)
        now = dot_product(point%traction, ray)
        work = work + 0.5_DP * step * (old + now)
        old = now
      end do
      if (m == MIX_POWER_LAW) then
        call suite%near('power law', ((1 - shear) * work / G(1))**1.7_DP + (shear * work / G(2))**1.7_DP, 1.0_DP, 1.0e-7_DP)
      else
        call suite%near('Benzeggagh and Kenane', work, G(1) + (G(2) - G(1)) * shear**1.7_DP, 1.0e-7_DP)
      end if
    end do
  end subroutine check_mixtures


  !> A held separation: D - Dv falls by mu/(mu + dt) in each increment of backward Euler.
  subroutine check_viscosity()
    type(cohesive_point_type) :: point
    real(DP), parameter :: VISCOSITY = 0.7_DP, DT = 0.2_DP
    real(DP) :: damage
    integer :: n
    point = evaluate(law(SOFTENING_LINEAR, .true., MIX_NONE), [0.04_DP, 0.0_DP, 0.0_DP])
    damage = point%state(STATE_DAMAGE)
    point%viscosity = VISCOSITY
    point%time_increment = DT
    point%state_old = 0
    do n = 1, 5
      call evaluate_cohesive_law(law(SOFTENING_LINEAR, .true., MIX_NONE), point)
      call suite%near('delayed damage', damage - point%state(STATE_DELAYED), damage * (VISCOSITY / (VISCOSITY + DT))**n, 1.0e-14_DP)
      call suite%near('its traction', point%traction(1), (1 - point%state(STATE_DELAYED)) * K(1) * 0.04_DP, 1.0e-12_DP)
      point%state_old = point%state
    end do
  end subroutine check_viscosity


  !> The tangent against central differences, opening and closed, with a past and viscosity.
  subroutine check_derivatives(material)
    type(material_type), intent(in) :: material
    real(DP), parameter :: SEPARATIONS(3, 4) = reshape([0.021_DP, 0.013_DP, -0.017_DP, 0.004_DP, -0.024_DP, 0.009_DP, -0.003_DP, &
      0.019_DP, 0.014_DP, 0.031_DP, 0.002_DP, -0.001_DP], [3, 4]), STEP = 1.0e-7_DP
    type(cohesive_point_type) :: point, before, behind
    real(DP) :: difference(3, 3)
    integer :: s, j
    do s = 1, size(SEPARATIONS, 2)
      point%separation = SEPARATIONS(:, s)
      point%thickness = 1
      point%argument = 0
      point%viscosity = 0.3_DP
      point%time_increment = 0.8_DP
      point%state_old = [0.05_DP, 0.04_DP, 1.0_DP]
      call evaluate_cohesive_law(material, point)
      do j = 1, 3
        before = point
        behind = point
        before%separation(j) = before%separation(j) - STEP
        behind%separation(j) = behind%separation(j) + STEP
        call evaluate_cohesive_law(material, before)
        call evaluate_cohesive_law(material, behind)
        difference(:, j) = (behind%traction - before%traction) / (2 * STEP)
      end do
      call suite%near('tangent', norm2(point%tangent - difference) / norm2(difference), 0.0_DP, 1.0e-6_DP)
    end do
  end subroutine check_derivatives

end program test_traction_separation
