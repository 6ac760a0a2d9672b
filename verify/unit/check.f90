!> Check: what every unit test program uses: named checks with a tolerance, counted, reported, and an exit code.
!! SPDX-License-Identifier: GPL-3.0-or-later
module check
  use, intrinsic :: iso_fortran_env, only: real64, output_unit
  implicit none
  private
  public :: suite_type

  !> Counts checks; a test program makes one, calls `near` and `that`, and ends with `finish`.
  type :: suite_type
    integer :: n_passed = 0
    integer :: n_failed = 0
  contains
    procedure :: near
    procedure :: that
    procedure :: finish
  end type suite_type

contains

  !> |actual - expected| <= tolerance; a NaN fails.
  subroutine near(self, name, actual, expected, tolerance)
    class(suite_type), intent(inout) :: self
    character(*), intent(in) :: name              !< what is compared
    real(real64), intent(in) :: actual, expected
    real(real64), intent(in) :: tolerance         !< absolute
    character(120) :: numbers
    write (numbers, '(a,es23.15,a,es23.15,a,es9.1)') ': ', actual, ' expected ', expected, ' within ', tolerance
    call self%that(name // trim(numbers), abs(actual - expected) <= tolerance)
  end subroutine near


  !> A condition that must hold.
  subroutine that(self, name, is_true)
    class(suite_type), intent(inout) :: self
    character(*), intent(in) :: name
    logical, intent(in) :: is_true
    if (is_true) then
      self%n_passed = self%n_passed + 1
    else
      self%n_failed = self%n_failed + 1
      write (output_unit, '(2a)') 'FAILED ', name
    end if
  end subroutine that


  !> Prints the count and stops with exit code 1 if a check failed or none was made.
  subroutine finish(self)
    class(suite_type), intent(in) :: self
    write (output_unit, '(i0,a,i0,a)') self%n_passed, ' passed, ', self%n_failed, ' failed'
    if (self%n_failed > 0 .or. self%n_passed == 0) stop 1
  end subroutine finish

end module check
