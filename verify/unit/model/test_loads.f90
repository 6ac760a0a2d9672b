!> Unit test of amontons_loads: amplitudes by table and by formula, and the magnitude of a load over a step.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_loads
  use amontons_kinds, only: DP
  use amontons_loads, only: equation_type, equation_list_type, amplitude_type, load_type, amplitude_value, load_value, &
    AMPLITUDE_SMOOTH_STEP, AMPLITUDE_PERIODIC, AMPLITUDE_MODULATED, AMPLITUDE_DECAY
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_table()
  call check_formulas()
  call check_loads()
  call check_equations()
  call suite%finish()

contains

  !> Equations added one by one and moved behind others keep their order and their terms.
  subroutine check_equations()
    type(equation_list_type) :: list
    type(equation_type), allocatable :: equations(:)
    type(equation_type) :: equation
    integer :: i
    do i = 1, 40
      equation%node = [i, 100 + i]
      equation%dof = [1, 2]
      equation%coefficient = [1.0_DP, real(-i, DP)]
      equation%line = i
      call list%add(equation)
      if (i == 3) call list%move_to(equations)
    end do
    call suite%that('three first', size(equations) == 3 .and. list%n == 37)
    call list%move_to(equations)
    call suite%that('all', size(equations) == 40 .and. list%n == 0)
    call suite%that('in order', all(equations%line == [(i, i=1, 40)]))
call suite%that('terms', all([(equations(i)%node(2) == 100 + i .and. equations(i)%coefficient(2) < 0.5_DP - real(i, DP), i=1, 40)]))
    call list%move_to(equations)
    call suite%that('nothing more', size(equations) == 40)
  end subroutine check_equations


  !> Linear or smooth between the times, constant outside.
  subroutine check_table()
    type(amplitude_type) :: a
    real(DP), parameter :: STEP = 1.0e-4_DP
    a%time = [1.0_DP, 2.0_DP, 4.0_DP]
    a%factor = [0.0_DP, 10.0_DP, 4.0_DP]
    call suite%near('before', amplitude_value(a, -1.0_DP), 0.0_DP, 0.0_DP)
    call suite%near('after', amplitude_value(a, 9.0_DP), 4.0_DP, 0.0_DP)
    call suite%near('at a time', amplitude_value(a, 2.0_DP), 10.0_DP, 0.0_DP)
    call suite%near('between', amplitude_value(a, 2.5_DP), 8.5_DP, 1.0e-14_DP)
    a%shape = AMPLITUDE_SMOOTH_STEP
    call suite%near('smooth: the middle', amplitude_value(a, 3.0_DP), 7.0_DP, 1.0e-14_DP)
    call suite%near('smooth: flat at a time', amplitude_value(a, 2 + STEP) - 10, 0.0_DP, 1.0e-10_DP)
    call suite%near('smooth: a quarter', amplitude_value(a, 1.25_DP), 10 * 0.103515625_DP, 1.0e-14_DP)
  end subroutine check_table


  !> Fourier series, product of sines, decay: before they begin and after.
  subroutine check_formulas()
    type(amplitude_type) :: a
    a%shape = AMPLITUDE_PERIODIC
    a%formula_constants = [2.0_DP, 1.0_DP, 0.5_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP]
    call suite%near('periodic: before', amplitude_value(a, 0.9_DP), 0.5_DP, 0.0_DP)
    call suite%near('periodic: at its start', amplitude_value(a, 1.0_DP), 8.5_DP, 1.0e-14_DP)
    call suite%near('periodic', amplitude_value(a, 1.3_DP), 0.5_DP + 3 * cos(0.6_DP) + 4 * sin(0.6_DP) + 5 * cos(1.2_DP) &
      + 6 * sin(1.2_DP), 1.0e-14_DP)
    a%shape = AMPLITUDE_MODULATED
    a%formula_constants = [1.0_DP, 2.0_DP, 0.5_DP, 3.0_DP, 7.0_DP]
    call suite%near('modulated: before', amplitude_value(a, 0.2_DP), 1.0_DP, 0.0_DP)
    call suite%near('modulated', amplitude_value(a, 0.7_DP), 1 + 2 * sin(0.6_DP) * sin(1.4_DP), 1.0e-14_DP)
    a%shape = AMPLITUDE_DECAY
    a%formula_constants = [1.0_DP, 2.0_DP, 0.5_DP, 4.0_DP]
    call suite%near('decay: before', amplitude_value(a, 0.4_DP), 1.0_DP, 0.0_DP)
    call suite%near('decay', amplitude_value(a, 2.5_DP), 1 + 2 * exp(-0.5_DP), 1.0e-14_DP)
  end subroutine check_formulas


  !> Without an amplitude a ramp; with one times its factor, by step time or total time, or the factor itself.
  subroutine check_loads()
    type(amplitude_type) :: a(2)
    type(load_type) :: load
    a(1)%time = [0.0_DP, 10.0_DP]
    a(1)%factor = [0.0_DP, 1.0_DP]
    a(2) = a(1)
    a(2)%is_total_time = .true.
    load = load_type(start=2.0_DP, end=6.0_DP)
    call suite%near('ramp', load_value(load, a, 0.5_DP, 100.0_DP, 2.0_DP), 3.0_DP, 1.0e-15_DP)
    load%amplitude = 1
    call suite%near('step time', load_value(load, a, 0.5_DP, 5.0_DP, 2.0_DP), 0.3_DP, 1.0e-15_DP)
    load%amplitude = 2
    call suite%near('total time', load_value(load, a, 0.5_DP, 5.0_DP, 2.0_DP), 3.0_DP, 1.0e-15_DP)
    a(2)%is_absolute = .true.
    call suite%near('absolute', load_value(load, a, 0.5_DP, 5.0_DP, 2.0_DP), 0.5_DP, 1.0e-15_DP)
  end subroutine check_loads

end program test_loads
