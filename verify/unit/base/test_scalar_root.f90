!> Unit test of amontons_scalar_root: roots with known values, by Newton's steps and by bisection, with and without an upper bound.
!! SPDX-License-Identifier: GPL-3.0-or-later
module test_functions
  use amontons_kinds, only: DP
  implicit none
  public

contains

  pure subroutine cube(x, value, slope)
    real(DP), intent(in) :: x
    real(DP), intent(out) :: value, slope
    value = x**3 - 2
    slope = 3 * x**2
  end subroutine cube


  pure subroutine arc(x, value, slope)
    real(DP), intent(in) :: x
    real(DP), intent(out) :: value, slope
    value = atan(x - 1)
    slope = 1 / (1 + (x - 1)**2)
  end subroutine arc


  !> Two slopes that differ by 1e6.
  pure subroutine kink(x, value, slope)
    real(DP), intent(in) :: x
    real(DP), intent(out) :: value, slope
    slope = merge(1e3_DP, 1e-3_DP, x > 0.25_DP)
    value = slope * (x - 0.25_DP)
  end subroutine kink


  !> Newton's steps alone from x = 1 are shorter by 0.995 each.
  pure subroutine steep_power(x, value, slope)
    real(DP), intent(in) :: x
    real(DP), intent(out) :: value, slope
    value = x**200 + 1e-3_DP * (x - 0.01_DP)
    slope = 200 * x**199 + 1e-3_DP
  end subroutine steep_power


  pure subroutine tiny_cube(x, value, slope)
    real(DP), intent(in) :: x
    real(DP), intent(out) :: value, slope
    value = (x - 1e-12_DP) * (1 + x**2)
    slope = 1 + x**2 + 2 * x * (x - 1e-12_DP)
  end subroutine tiny_cube

end module test_functions

program test_scalar_root
  use amontons_kinds, only: DP
  use amontons_scalar_root, only: root_search_type, improve_root, MAX_ROOT_ITERATIONS, TOL_ROOT
  use check, only: suite_type
  use test_functions, only: cube, arc, kink, tiny_cube, steep_power
  implicit none
  type(suite_type) :: suite
  integer :: n

  call suite%near('cube root of two', root_of(cube, root_search_type(low=0.0_DP, high=2.0_DP, x=1.0_DP), n), &
    2.0_DP**(1.0_DP / 3.0_DP), 1e-15_DP)
  call suite%that('quadratic convergence', n <= 6)
  call suite%near('no upper bound', root_of(cube, root_search_type(x=0.5_DP), n), 2.0_DP**(1.0_DP / 3.0_DP), 1e-15_DP)
  ! Newton's method alone leaves the arc tangent for infinity from |x - 1| > 1.392.
  call suite%near('bisection', root_of(arc, root_search_type(low=-10.0_DP, high=30.0_DP, x=9.0_DP), n), 1.0_DP, 1e-12_DP)
  call suite%that('within the limit', n < MAX_ROOT_ITERATIONS)
  call suite%near('a kink', root_of(kink, root_search_type(low=0.0_DP, high=1.0_DP), n), 0.25_DP, 1e-12_DP)
  call suite%near('the start is the root', root_of(arc, root_search_type(low=0.0_DP, high=2.0_DP, x=1.0_DP), n), 1.0_DP, 0.0_DP)
  call suite%that('at once', n == 1)
  call suite%near('slow steps', root_of(steep_power, root_search_type(low=0.0_DP, high=10.0_DP, x=10.0_DP), n), 0.01_DP, 1e-15_DP)
  call suite%that('become bisections', n <= 30)
  call suite%near('a small root', root_of(tiny_cube, root_search_type(low=0.0_DP, high=1.0_DP, x=1e-3_DP), n), 1e-12_DP, 1e-24_DP)
  call suite%near('a small root on a large scale', &
    root_of(tiny_cube, root_search_type(low=0.0_DP, high=1.0_DP, x=1e-3_DP, scale=1.0_DP), n), 0.0_DP, 2 * TOL_ROOT + 1e-12_DP)
  call suite%finish()

contains

  !> The root of a function by improve_root; 0 if there is none after the limit.
  real(DP) function root_of(f, start, n_steps) result(root)
    interface
      pure subroutine f(x, value, slope)
        import :: DP
        real(DP), intent(in) :: x
        real(DP), intent(out) :: value, slope
      end subroutine f
    end interface
    type(root_search_type), intent(in) :: start
    integer, intent(out) :: n_steps
    type(root_search_type) :: search
    real(DP) :: value, slope
    search = start
    root = -huge(1.0_DP)
    do n_steps = 1, MAX_ROOT_ITERATIONS
      call f(search%x, value, slope)
      call improve_root(search, value, slope)
      if (search%x < search%low .or. search%x > search%high) return
      if (search%is_found) root = search%x
      if (search%is_found) return
    end do
  end function root_of

end program test_scalar_root
