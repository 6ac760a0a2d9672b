!> Unit test of amontons_errors: exit codes, error objects and the list of remarks.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_errors
  use amontons_errors, only: error_type, diagnostic_list_type, set_error, EXIT_SUCCESS, EXIT_USAGE, EXIT_DECK, EXIT_SETUP, &
    EXIT_NOT_CONVERGED, EXIT_SOLVER, EXIT_IO, EXIT_INTERNAL
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_codes()
  call check_list()
  call suite%finish()

contains

  !> The codes that the manual promises to scripts.
  subroutine check_codes()
    type(error_type), allocatable :: error
    call suite%that('exit codes', all([EXIT_SUCCESS, EXIT_USAGE, EXIT_DECK, EXIT_SETUP, EXIT_NOT_CONVERGED, EXIT_SOLVER, EXIT_IO, &
      EXIT_INTERNAL] == [0, 2, 3, 4, 5, 6, 7, 8]))
    call set_error(error, EXIT_IO, 'It is full.')
    call suite%that('an error', allocated(error))
    call suite%that('as given', error%code == EXIT_IO .and. error%message == 'It is full.')
    call set_error(error, EXIT_DECK, 'Another one.')
    call suite%that('the last one counts', error%code == EXIT_DECK .and. error%message == 'Another one.')
  end subroutine check_codes


  !> A hundred remarks, more than the list begins with, every third a warning.
  subroutine check_list()
    type(diagnostic_list_type) :: list
    character(8) :: text
    integer :: i
    do i = 1, 100
      write (text, '(i0)') i
      if (modulo(i, 3) == 0) then
        call list%add('a.inp', i, '*CARD', trim(text), is_warning=.true.)
      else
        call list%add('b.inp', i, '*OTHER', trim(text))
      end if
    end do
    call suite%that('counts', list%n_items == 100 .and. list%n_warnings == 33 .and. list%n_errors == 67)
    do i = 1, 100
      write (text, '(i0)') i
      associate (item => list%items(i))
        call suite%that('in order', item%line == i .and. item%text == trim(text))
        call suite%that('its kind', item%is_warning .eqv. item%file == 'a.inp')
      end associate
    end do
  end subroutine check_list

end program test_errors
