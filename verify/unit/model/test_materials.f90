!> Unit test of amontons_materials: tables and curves over temperature and strain, and the words for a law.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_materials
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, property_table_type, hardening_curve_type, evaluate_table, evaluate_curves, &
    evaluate_curve, find_interval, law_name, LAW_SAINT_VENANT, ELASTIC_ORTHOTROPIC, ELASTIC_FOAM, ELASTIC_HYPER, HYPER_OGDEN, &
    HISTORY_PEEQ, HISTORY_CEEQ, HISTORY_INELASTIC, HISTORY_BACK, HISTORY_STRETCH, MAX_HISTORY, USER_STRESS, USER_STRAIN, &
    USER_GRADIENT, USER_ENERGY, USER_ROTATION, USER_STATE, MAX_CONSTANTS, MAX_HYPER_ORDER, CREEP_TIME_HARDENING
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_intervals()
  call check_tables()
  call check_curves()
  call check_rows()
  call check_names()
  call suite%finish()

contains

  !> Every interval of a list, its ends, and what lies outside.
  subroutine check_intervals()
    real(DP), parameter :: LIST(5) = [-1.0_DP, 0.0_DP, 2.0_DP, 3.0_DP, 7.0_DP]
    real(DP) :: s
    integer :: i, k
    do k = 1, 4
      call find_interval(LIST, LIST(k) + 0.25_DP * (LIST(k + 1) - LIST(k)), i, s)
      call suite%that('its interval', i == k)
      call suite%near('a quarter', s, 0.25_DP, 1.0e-15_DP)
      call find_interval(LIST, LIST(k), i, s)
      call suite%that('an entry begins an interval', i == k .and. s == 0)
    end do
    call find_interval(LIST, -5.0_DP, i, s)
    call suite%that('below', i == 1 .and. s == 0)
    call find_interval(LIST, 99.0_DP, i, s)
    call suite%that('above', i == 5 .and. s == 0)
    call find_interval(LIST(:1), 99.0_DP, i, s)
    call suite%that('one entry', i == 1 .and. s == 0)
  end subroutine check_intervals


  !> Linear between temperatures, constant outside.
  subroutine check_tables()
    type(property_table_type) :: table
    real(DP) :: values(2)
    table = property_table_type([0.0_DP, 100.0_DP], reshape([10.0_DP, 1.0_DP, 30.0_DP, 5.0_DP], [2, 2]))
    call evaluate_table(table, 25.0_DP, values)
    call suite%near('between', norm2(values - [15.0_DP, 2.0_DP]), 0.0_DP, 1.0e-14_DP)
    call evaluate_table(table, -50.0_DP, values)
    call suite%near('below', norm2(values - [10.0_DP, 1.0_DP]), 0.0_DP, 0.0_DP)
    call evaluate_table(table, 500.0_DP, values)
    call suite%near('above', norm2(values - [30.0_DP, 5.0_DP]), 0.0_DP, 0.0_DP)
  end subroutine check_tables


  !> Linear between strains, then constant; families over the temperature.
  subroutine check_curves()
    type(hardening_curve_type) :: curves(2)
    real(DP) :: stress, slope
    curves(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.1_DP, 0.3_DP], [100.0_DP, 200.0_DP, 240.0_DP])
    curves(2) = hardening_curve_type(100.0_DP, [0.0_DP, 0.3_DP], [50.0_DP, 80.0_DP])
    call evaluate_curve(curves(1), 0.05_DP, stress, slope)
    call suite%near('stress', stress, 150.0_DP, 1.0e-12_DP)
    call suite%near('slope', slope, 1000.0_DP, 1.0e-9_DP)
    call evaluate_curve(curves(1), 0.2_DP, stress, slope)
    call suite%near('the second piece', stress, 220.0_DP, 1.0e-12_DP)
    call evaluate_curve(curves(1), 5.0_DP, stress, slope)
    call suite%that('beyond the last point: constant', stress == 240 .and. slope == 0)
    call evaluate_curves(curves, 25.0_DP, 0.2_DP, stress, slope)
    call suite%near('between temperatures: stress', stress, 0.75_DP * 220 + 0.25_DP * 70, 1.0e-12_DP)
    call suite%near('between temperatures: slope', slope, 0.75_DP * 200 + 0.25_DP * 100, 1.0e-9_DP)
    call evaluate_curves(curves, 1000.0_DP, 0.15_DP, stress, slope)
    call suite%near('hotter than all', stress, 65.0_DP, 1.0e-12_DP)
    call evaluate_curves(curves(:1), -10.0_DP, 0.0_DP, stress, slope)
    call suite%near('one curve', stress, 100.0_DP, 0.0_DP)
  end subroutine check_curves


  !> Rows of the history follow each other without a gap; the largest polynomial has its constants.
  subroutine check_rows()
    call suite%that('history', HISTORY_PEEQ == 1 .and. HISTORY_CEEQ == 2 .and. HISTORY_INELASTIC == 3 &
      .and. HISTORY_BACK == HISTORY_INELASTIC + 6 .and. HISTORY_STRETCH == HISTORY_BACK + 6 .and. MAX_HISTORY == HISTORY_STRETCH)
    call suite%that('of a user', USER_STRESS == MAX_HISTORY + 1 .and. USER_STRAIN == USER_STRESS + 6 &
      .and. USER_GRADIENT == USER_STRAIN + 6 .and. USER_ENERGY == USER_GRADIENT + 9 .and. USER_ROTATION == USER_ENERGY + 3 &
      .and. USER_STATE == USER_ROTATION + 9)
    call suite%that('constants', MAX_CONSTANTS == MAX_HYPER_ORDER * (MAX_HYPER_ORDER + 3) / 2 + MAX_HYPER_ORDER)
  end subroutine check_rows


  !> The words that the log prints.
  subroutine check_names()
    type(material_type) :: material
    call suite%that('Hencky', law_name(material) == 'Hencky')
    material%law = LAW_SAINT_VENANT
    material%elastic_kind = ELASTIC_ORTHOTROPIC
    call suite%that('orthotropic', law_name(material) == 'Saint-Venant, orthotropic')
    allocate (material%isotropic_hardening(1))
    material%creep_law = CREEP_TIME_HARDENING
    call suite%that('plastic and creep', law_name(material) == 'Saint-Venant, orthotropic, plastic, creep')
    material = material_type()
    material%elastic_kind = ELASTIC_FOAM
    call suite%that('foam', law_name(material) == 'hyperfoam')
    material%elastic_kind = ELASTIC_HYPER
    material%hyper_kind = HYPER_OGDEN
    call suite%that('Ogden', law_name(material) == 'hyperelastic, Ogden')
    material%has_deformation_plasticity = .true.
    call suite%that('deformation plasticity', law_name(material) == 'Ramberg-Osgood')
    material%is_user = .true.
    call suite%that('user', law_name(material) == 'UMAT')
  end subroutine check_names

end program test_materials
