!> Error object, exit codes, and the list of diagnostics of the input reader.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_errors
  implicit none
  private
  public :: error_type, diagnostic_type, diagnostic_list_type, set_error
  public :: EXIT_SUCCESS, EXIT_USAGE, EXIT_DECK, EXIT_SETUP, EXIT_NOT_CONVERGED, EXIT_SOLVER, EXIT_IO, EXIT_INTERNAL

  ! The exit codes of the program and the status codes of the library.
  integer, parameter :: EXIT_SUCCESS = 0            !< all steps done
  integer, parameter :: EXIT_USAGE = 2           !< wrong command line
  integer, parameter :: EXIT_DECK = 3            !< the deck has errors
  integer, parameter :: EXIT_SETUP = 4           !< the model check found an invalid or unsupported model before the first step
  integer, parameter :: EXIT_NOT_CONVERGED = 5   !< cut-backs exhausted; all converged increments are on disk
  integer, parameter :: EXIT_SOLVER = 6          !< linear solver or memory
  integer, parameter :: EXIT_IO = 7              !< reading or writing a file
  integer, parameter :: EXIT_INTERNAL = 8        !< internal error of the program

  !> An error. An unallocated error means success.
  type :: error_type
    integer :: code = EXIT_INTERNAL              !< one of EXIT_... above
    character(:), allocatable :: message         !< complete sentences for the user
  end type error_type

  !> One diagnostic of the input reader about one card.
  type :: diagnostic_type
    logical :: is_warning = .false.              !< .true.: the job may run
    character(:), allocatable :: file            !< file that contains the card
    integer :: line = 0                          !< its line there, counted from 1; 0 if none
    character(:), allocatable :: card            !< the line as written
    character(:), allocatable :: text            !< what is wrong and what is allowed
  end type diagnostic_type

  !> All diagnostics of the input reader, in the order found.
  type :: diagnostic_list_type
    type(diagnostic_type), allocatable :: items(:)
    integer :: n_items = 0
    integer :: n_errors = 0
    integer :: n_warnings = 0
  contains
    procedure :: add => add_diagnostic
  end type diagnostic_list_type

contains

  !> Makes an error object. The caller's next line is `return`.
  subroutine set_error(error, code, message)
    type(error_type), allocatable, intent(out) :: error   !< allocated on return
    integer, intent(in) :: code                           !< one of EXIT_...
    character(*), intent(in) :: message                   !< complete sentences
    allocate (error)
    error%code = code
    error%message = message
  end subroutine set_error


  !> Adds a diagnostic to the list. Cost: amortised constant.
  subroutine add_diagnostic(self, file, line, card, text, is_warning)
    class(diagnostic_list_type), intent(inout) :: self
    character(*), intent(in) :: file              !< file that contains the card
    integer, intent(in) :: line                   !< line counted from 1; 0 if none
    character(*), intent(in) :: card              !< the line as written
    character(*), intent(in) :: text              !< what is wrong and what is allowed
    logical, intent(in), optional :: is_warning   !< default .false.: an error
    type(diagnostic_type), allocatable :: larger(:)
    if (.not. allocated(self%items)) allocate (self%items(16))
    if (self%n_items == size(self%items)) then
      allocate (larger(2 * self%n_items))
      larger(:self%n_items) = self%items
      call move_alloc(larger, self%items)
    end if
    self%n_items = self%n_items + 1
    associate (item => self%items(self%n_items))
      item%file = file
      item%line = line
      item%card = card
      item%text = text
      if (present(is_warning)) item%is_warning = is_warning
      if (item%is_warning) then
        self%n_warnings = self%n_warnings + 1
      else
        self%n_errors = self%n_errors + 1
      end if
    end associate
  end subroutine add_diagnostic

end module amontons_errors
