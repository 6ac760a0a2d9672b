!> Root of one ascending function by Newton's method with bisection. The return mappings of plasticity and creep are such equations.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Bisection where a step leaves the bracket or is more than half of the last but one (e.g. W. H. Press et al., Numerical Recipes,
!! 3rd ed., Cambridge 2007, section 9.4).
module amontons_scalar_root
  use amontons_kinds, only: DP
  implicit none
  private
  public :: root_search_type, improve_root, MAX_ROOT_ITERATIONS, TOL_ROOT

  integer, parameter :: MAX_ROOT_ITERATIONS = 100
  real(DP), parameter :: TOL_ROOT = 1.0e-13_DP     !< of a step, or of the bracket, over the size of the root [-]

  !> A search: the user sets bracket, start and scale, evaluates f at x, improves x, and so on until is_found.
  type :: root_search_type
    real(DP) :: x = 0                              !< estimate of the root
    real(DP) :: low = 0                            !< f <= 0 there
    real(DP) :: high = huge(1.0_DP)                !< f >= 0 there; huge: not known yet
    real(DP) :: scale = 0                          !< least size of x that counts; 0: that of the root itself
    logical :: is_found = .false.                  !< x is the root to rounding
    real(DP) :: last_steps(2) = huge(1.0_DP)       !< sizes of the last but one step and of the last one
  end type root_search_type

contains

  !> One step from x.
  elemental subroutine improve_root(search, f, df)
    type(root_search_type), intent(inout) :: search
    real(DP), intent(in) :: f                      !< at x
    real(DP), intent(in) :: df                     !< its slope there, above 0
    real(DP) :: step
    logical :: is_slow
    if (f >= 0) search%high = search%x
    if (f <= 0) search%low = search%x
    step = -f / df
    is_slow = search%high < huge(1.0_DP) .and. abs(step) > 0.5_DP * search%last_steps(1)
    if (is_slow .or. .not. (search%x + step >= search%low .and. search%x + step <= search%high)) &
      step = 0.5_DP * (search%low + search%high) - search%x
    search%x = search%x + step
    search%last_steps = [search%last_steps(2), abs(step)]
    search%is_found = min(abs(step), search%high - search%low) <= TOL_ROOT * max(abs(search%x), search%scale)
  end subroutine improve_root

end module amontons_scalar_root
