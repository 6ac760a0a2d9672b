!> User job: which routines of the user a model needs; they are opened before the start and handed to those that call them.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_user_job
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SETUP, EXIT_USAGE, EXIT_NOT_CONVERGED
  use amontons_journal, only: journal_type
  use amontons_model, only: model_type, job_options_type
  use amontons_user, only: routines_type, open_routines, has_routine, hear_routines, name_job_to, ROUTINE_NAMES, USER_UMAT
  use amontons_user_material, only: find_rest_tangent
  implicit none
  private
  public :: start_routines, heed_routines

contains

  !> Opens the routines that the job names, and proves that those which the deck needs are there.
  !!
  !! Errors: EXIT_IO (not there, does not compile, cannot be loaded), EXIT_SETUP (a routine is missing), EXIT_USAGE (the
  !! deck needs some, and none were named).
  subroutine start_routines(model, options, error)
    type(model_type), intent(inout) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: folder, text
    real(DP) :: pnewdt
    logical :: is_stopped
    integer :: m
    folder = '.'
    if (allocated(options%outdir)) folder = options%outdir
    if (allocated(options%user)) then
      call open_routines(options%user, model%routines, error)
      if (allocated(error)) return
      call name_job_to(model%routines, folder, options%job)
    end if
    do m = 1, size(model%materials)
      associate (material => model%materials(m))
        if (.not. material%is_user) cycle
        call need_routine(model, options, USER_UMAT, 'The material ''' // material%name // '''', error)
        if (allocated(error)) return
        material%routines = model%routines
        call find_rest_tangent(material, first_increment(model), error)
        if (allocated(error)) return
      end associate
    end do
    call hear_routines(model%routines, pnewdt, text, is_stopped)   ! at rest PNEWDT means nothing
  end subroutine start_routines


  !> The length of the first increment.
  pure real(DP) function first_increment(model)
    type(model_type), intent(in) :: model
    first_increment = 1
    if (size(model%steps) > 0) first_increment = model%steps(1)%dt_initial
  end function first_increment


  !> An error if a routine is not there.
  subroutine need_routine(model, options, which, who, error)
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    integer, intent(in) :: which                   !< USER_...
    character(*), intent(in) :: who                !< what needs it
    type(error_type), allocatable, intent(out) :: error
    if (has_routine(model%routines, which)) return
    if (allocated(options%user)) then
      call set_error(error, EXIT_SETUP, who // ' needs the user routine ' // trim(ROUTINE_NAMES(which)) // ', which is not in ' // &
        options%user // '.')
    else
      call set_error(error, EXIT_USAGE, who // ' needs the user routine ' // trim(ROUTINE_NAMES(which)) // '; name the file ' // &
        'that holds it: amontons job user=file.f (or .f90, .for, .so).')
    end if
  end subroutine need_routine


  !> Tells what the routines have said since the last call, takes the smallest PNEWDT, and ends the job after XIT.
  subroutine heed_routines(model, journal, pnewdt, error)
    type(model_type), intent(in) :: model
    type(journal_type), intent(inout) :: journal
    real(DP), intent(inout) :: pnewdt              !< smallest of this attempt [-]
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: text
    real(DP) :: smallest
    logical :: is_stopped
    call hear_routines(model%routines, smallest, text, is_stopped)
    pnewdt = min(pnewdt, smallest)
    if (len(text) > 0) call journal%say('User routines: ' // text(:len(text) - 1))
    if (is_stopped) call set_error(error, EXIT_NOT_CONVERGED, 'A user routine has ended the job (XIT or STDB_ABQERR). ' // &
      'All converged increments are on disk.')
  end subroutine heed_routines

end module amontons_user_job
