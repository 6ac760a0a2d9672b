!> Tests of the pressure-overclosure laws: closed forms, slopes against differences, energies against sums.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_pressure_overclosure
  use amontons_kinds, only: DP
  use amontons_surfaces, only: interaction_type, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED
  use amontons_pressure_overclosure, only: evaluate_pressure_overclosure, find_activation_gap
  use amontons_tributary_areas, only: nodal_area_fractions
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_linear()
  call check_exponential()
  call check_tabular()
  call check_shares()
  call suite%finish()

contains

  !> K h far inside, -sigma_inf far outside, half of K as the slope at zero; TIED is K h.
  subroutine check_linear()
    type(interaction_type) :: law
    real(DP) :: p, slope, energy
    law = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=1.0e7_DP, tension_limit=3.0_DP, cutoff_clearance=2.0_DP)
    call evaluate_pressure_overclosure(law, 1.0e-2_DP, p, slope, energy)
    call suite%near('linear: deep', p, 1.0e5_DP - 3.0_DP, 1.0e-3_DP)
    call evaluate_pressure_overclosure(law, -1.0e2_DP, p, slope, energy)
    call suite%near('linear: wide open', p, -3.0_DP, 1.0e-6_DP)
    call evaluate_pressure_overclosure(law, 0.0_DP, p, slope, energy)
    call suite%near('linear: touching', p, 0.0_DP, 0.0_DP)
    call suite%near('linear: slope when touching', slope, 5.0e6_DP, 1.0e-9_DP * 5.0e6_DP)
    call suite%near('linear: reach', find_activation_gap(law, 9.0_DP), 6.0_DP, 1.0e-14_DP)
    law%tension_limit = 1.0e5_DP
    call check_derivatives('linear', law, [-0.1_DP, -0.01_DP, 0.002_DP, 0.05_DP])
    law = interaction_type(behavior=BEHAVIOR_TIED, stiffness=40.0_DP)
    call check_derivatives('tied', law, [-0.1_DP, 0.2_DP])
    call evaluate_pressure_overclosure(law, -0.5_DP, p, slope, energy)
    call suite%near('tied: pulls', p, -20.0_DP, 1.0e-14_DP)
  end subroutine check_linear


  !> p0 at zero, a hundredth of it at the gap c0, beyond it the tangent down to zero; a straight line where the exponential would
  !! overflow.
  subroutine check_exponential()
    type(interaction_type) :: law
    real(DP) :: p, slope, energy
    law = interaction_type(behavior=BEHAVIOR_EXPONENTIAL, cutoff_clearance=1.0e-2_DP, pressure=0.5_DP)
    call evaluate_pressure_overclosure(law, 0.0_DP, p, slope, energy)
    call suite%near('exponential: p0', p, 0.5_DP, 1.0e-15_DP)
    call evaluate_pressure_overclosure(law, -1.0e-2_DP, p, slope, energy)
    call suite%near('exponential: at c0', p, 0.005_DP, 1.0e-15_DP)
    call suite%near('exponential: reach', find_activation_gap(law, 9.0_DP), 1.0e-2_DP * (1.0_DP + 1.0_DP / log(100.0_DP)), &
      1.0e-17_DP)
    call check_derivatives('exponential', law, [-0.012_DP, -0.011_DP, -0.008_DP, 0.01_DP, 0.07_DP])
    call evaluate_pressure_overclosure(law, -find_activation_gap(law, 9.0_DP), p, slope, energy)
    call suite%near('exponential: nothing where it ends', abs(p) + abs(energy), 0.0_DP, 1.0e-16_DP)
    call evaluate_pressure_overclosure(law, 1.0e3_DP, p, slope, energy)
    call suite%that('exponential: never overflows', p < 1.0e20_DP .and. slope > 0.0_DP)
  end subroutine check_exponential


  !> Between, before and beyond the points.
  subroutine check_tabular()
    type(interaction_type) :: law
    real(DP) :: p, slope, energy
    law = interaction_type(behavior=BEHAVIOR_TABULAR, cutoff_clearance=1.0e-3_DP)
    law%table_pressure = [0.0_DP, 10.0_DP, 30.0_DP]
    law%table_overclosure = [0.0_DP, 0.1_DP, 0.2_DP]
    call evaluate_pressure_overclosure(law, 0.15_DP, p, slope, energy)
    call suite%near('tabular: between', p, 20.0_DP, 1.0e-13_DP)
    call suite%near('tabular: slope', slope, 200.0_DP, 1.0e-12_DP)
    call suite%near('tabular: energy', energy, 0.5_DP + 0.75_DP, 1.0e-14_DP)
    call evaluate_pressure_overclosure(law, 0.4_DP, p, slope, energy)
    call suite%near('tabular: beyond', p, 30.0_DP, 0.0_DP)
    call evaluate_pressure_overclosure(law, -0.4_DP, p, slope, energy)
    call suite%near('tabular: before', p, 0.0_DP, 0.0_DP)
    call check_derivatives('tabular', law, [0.05_DP, 0.13_DP, 0.25_DP])
  end subroutine check_tabular


  !> Slope and energy against central differences.
  subroutine check_derivatives(name, law, at)
    character(*), intent(in) :: name
    type(interaction_type), intent(in) :: law
    real(DP), intent(in) :: at(:)                  !< overclosures [length]
    real(DP), parameter :: D = 1.0e-6_DP
    real(DP) :: p(3), slope(3), energy(3)
    integer :: i
    do i = 1, size(at)
      call evaluate_pressure_overclosure(law, at(i) - D, p(1), slope(1), energy(1))
      call evaluate_pressure_overclosure(law, at(i), p(2), slope(2), energy(2))
      call evaluate_pressure_overclosure(law, at(i) + D, p(3), slope(3), energy(3))
      call suite%near(name // ': slope', (p(3) - p(1)) / (2 * D), slope(2), 1.0e-6_DP * (abs(slope(2)) + abs(p(2))))
      call suite%near(name // ': energy', (energy(3) - energy(1)) / (2 * D), p(2), 1.0e-6_DP * (abs(slope(2)) + abs(p(2))))
    end do
  end subroutine check_derivatives


  !> The area fractions of a face's nodes add up to one.
  subroutine check_shares()
    real(DP), allocatable :: share(:)
    share = nodal_area_fractions(4, 8)
    call suite%near('shares: corner of a square with 8 nodes', share(4), 0.01_DP, 0.0_DP)
    call suite%near('shares: sum of a square with 8 nodes', sum(share), 1.0_DP, 1.0e-14_DP)
    call suite%near('shares: corner of a triangle with 6 nodes', maxval(nodal_area_fractions(3, 6), mask=[.true., .true., .true., &
      .false., .false., .false.]), 0.001_DP, 1.0e-15_DP)
    call suite%near('shares: sum of a triangle with 6 nodes', sum(nodal_area_fractions(3, 6)), 1.0_DP, 1.0e-14_DP)
    call suite%near('shares: square', sum(nodal_area_fractions(4, 4)), 1.0_DP, 1.0e-14_DP)
    call suite%near('shares: triangle', sum(nodal_area_fractions(3, 3)), 1.0_DP, 1.0e-14_DP)
  end subroutine check_shares

end program test_pressure_overclosure
