!> User routines: loads the libraries, checks that the required routines exist, and calls UAMP.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_user_routine_setup
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SETUP, EXIT_USAGE, EXIT_NOT_CONVERGED
  use amontons_logger, only: logger_type
  use amontons_model, only: model_type, job_options_type
  use amontons_user_elements, only: has_uel
  use amontons_user_routines, only: user_library_type, umat_type, open_routines, close_routines, has_routine, &
    collect_user_messages, pass_job_name, uamp_type, call_uamp, call_uexternaldb, LOP_JOB_START, LOP_INCREMENT_START, &
    LOP_STEP_START, USER_NAME_LENGTH, ROUTINE_NAMES, ROUTINE_UMAT, ROUTINE_UAMP, ROUTINE_DLOAD, ROUTINE_UTRACLOAD, &
    ROUTINE_DISP, ROUTINE_FRIC, ROUTINE_UINTER, ROUTINE_SDVINI, ROUTINE_UEL, ROUTINE_USDFLD, &
    ROUTINE_CREEP
  use amontons_loads, only: amplitude_type, DISTRIBUTED_TRACTION
  use amontons_surfaces, only: interaction_type, BEHAVIOR_USER
  use amontons_materials, only: material_type, CREEP_USER
  use amontons_user_state, only: find_point_at_rest, field_library
  use amontons_state, only: state_type, fields_type
  use amontons_user_material, only: find_initial_tangent
  implicit none
  private
  public :: call_external_databases, open_user_routines, close_user_routines, handle_user_messages
  public :: update_user_amplitudes, restore_user_amplitudes

  character(*), parameter :: ERROR_MARK = '*ERROR: '          !< start of the message of a crash
  character(*), parameter :: CRASH_REMEDY = 'Set AMONTONS_FFLAGS to -fcheck=all in the environment and run the job again: ' // &
    'the compiler''s checks name the line and the array.'

contains

  !> Opens the user routines of the job and checks that those required by the deck exist.
  !!
  !! Errors: EXIT_IO (file missing, does not compile, cannot be loaded), EXIT_SETUP (a routine is missing), EXIT_USAGE (the
  !! deck requires routines, and no file was given).
  subroutine open_user_routines(model, options, error)
    type(model_type), intent(inout) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: text
    type(umat_type) :: at_rest
    real(DP), allocatable :: statev(:), fields(:, :)
    real(DP) :: pnewdt
    logical :: is_stopped, has_crashed
    integer :: m
    if (allocated(options%user)) call open_named(options%user, options, model%routines, error)
    if (allocated(error)) return
    do m = 1, size(model%materials)
      associate (material => model%materials(m))
        if (material%creep_law == CREEP_USER) call check_routine(model%routines, file_of(material, options), ROUTINE_CREEP, &
          'The material ''' // material%name // '''', error)
        if (allocated(error)) return
        if (material%is_user .or. material%creep_law == CREEP_USER) material%routines = model%routines
        if (.not. material%is_user) cycle
        if (allocated(material%library)) call open_material_library(model, options, m, error)
        if (allocated(error)) return
        call check_routine(material%routines, file_of(material, options), ROUTINE_UMAT, 'The material ''' // material%name // &
          '''', error)
        if (allocated(error)) return
        if (model%has_sdvini .and. material%n_statev > 0) call check_routine(material%routines, file_of(material, options), &
          ROUTINE_SDVINI, '*INITIAL CONDITIONS, TYPE=SOLUTION, USER', error)
        if (allocated(error)) return
        call find_point_at_rest(model, m, at_rest, statev, fields)
        at_rest%dtime = first_increment(model)
        call find_initial_tangent(material, at_rest, statev, fields, error)
        ! PNEWDT has no meaning in the undeformed state
        call collect_user_messages(material%routines, pnewdt, text, is_stopped, has_crashed)
        if (has_crashed) call set_error(error, EXIT_SETUP, 'In the call at rest for the material ''' // material%name // ''': ' // &
          text(len(ERROR_MARK) + 1:len(text) - 1) // ' ' // CRASH_REMEDY)
        if (allocated(error)) return
      end associate
    end do
    call check_load_routines(model, options, error)
    if (.not. allocated(error)) call check_contact_routines(model, options, error)
  end subroutine open_user_routines


  !> Opens a file and sets the data of the job in it.
  subroutine open_named(path, options, routines, error)
    character(*), intent(in) :: path
    type(job_options_type), intent(in) :: options
    type(user_library_type), intent(out) :: routines
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: folder, text
    real(DP) :: pnewdt
    logical :: is_stopped, has_crashed
    folder = '.'
    if (allocated(options%outdir)) folder = options%outdir
    call open_routines(path, routines, error)
    if (allocated(error)) return
    call pass_job_name(routines, folder, options%job)
    call call_uexternaldb(routines, LOP_JOB_START, [0.0_DP, 0.0_DP, 0.0_DP], 0, 0)
    call collect_user_messages(routines, pnewdt, text, is_stopped, has_crashed)
    if (has_crashed) call set_error(error, EXIT_SETUP, text(len(ERROR_MARK) + 1:len(text) - 1) // ' ' // CRASH_REMEDY)
    if (is_stopped .and. .not. has_crashed) call set_error(error, EXIT_SETUP, 'The user routine UEXTERNALDB has ended the job &
      &before its start (XIT).')
  end subroutine open_named


  !> Calls UEXTERNALDB of each library: TIME is that of the fields, at the start of an increment less the increment;
  !! a step starts at 0.
  subroutine call_external_databases(model, lop, fields)
    type(model_type), intent(in) :: model
    integer, intent(in) :: lop                     !< LOP_...
    type(fields_type), intent(in) :: fields        !< of the attempt at the start of an increment; else committed
    real(DP) :: times(3)
    integer :: step, increment, m
    times = [fields%step_time, fields%total_time, fields%time_increment]
    step = fields%step
    increment = fields%increment
    if (lop == LOP_INCREMENT_START) times(:2) = times(:2) - fields%time_increment
    if (lop == LOP_STEP_START) then
      times = [0.0_DP, fields%total_time, 0.0_DP]
      step = step + 1
      increment = 0
    end if
    call call_uexternaldb(model%routines, lop, times, step, increment)
    do m = 1, size(model%materials)
      if (is_first_of_library(model, m)) call call_uexternaldb(model%materials(m)%routines, lop, times, step, increment)
    end do
  end subroutine call_external_databases


  !> Opens the file of LIBRARY once for all its materials; search: relative to the deck, then to the working folder.
  subroutine open_material_library(model, options, m, error)
    type(model_type), intent(inout) :: model
    type(job_options_type), intent(in) :: options
    integer, intent(in) :: m                       !< material
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: path
    integer :: k
    logical :: is_there
    associate (material => model%materials(m))
      do k = 1, m - 1
        if (.not. allocated(model%materials(k)%library)) cycle
        if (model%materials(k)%library /= material%library) cycle
        material%routines = model%materials(k)%routines
        return
      end do
      path = material%library
      if (allocated(options%deck)) path = path_beside(options%deck, path)
      inquire (file=path, exist=is_there)
      if (.not. is_there) path = material%library
      call open_named(path, options, material%routines, error)
    end associate
  end subroutine open_material_library


  !> A file in the folder of another one, unless its path is absolute.
  pure function path_beside(place, path) result(joined)
    character(*), intent(in) :: place, path
    character(:), allocatable :: joined
    joined = path
    if (index(path, '/') /= 1) joined = place(:index(place, '/', back=.true.)) // path
  end function path_beside


  !> The file of a material's routine; empty if none is given.
  pure function file_of(material, options) result(path)
    type(material_type), intent(in) :: material
    type(job_options_type), intent(in) :: options
    character(:), allocatable :: path
    path = ''
    if (allocated(options%user)) path = options%user
    if (allocated(material%library)) path = material%library
  end function file_of


  !> Closes all libraries; no call may follow.
  subroutine close_user_routines(model)
    type(model_type), intent(inout) :: model
    integer :: m
    if (allocated(model%materials)) then
      do m = 1, size(model%materials)
        if (is_first_of_library(model, m)) call close_routines(model%materials(m)%routines)
      end do
    end if
    call close_routines(model%routines)
  end subroutine close_user_routines


  !> Whether a material is the first with its library.
  pure logical function is_first_of_library(model, m)
    type(model_type), intent(in) :: model
    integer, intent(in) :: m                       !< material
    integer :: k
    is_first_of_library = allocated(model%materials(m)%library)
    do k = 1, merge(m - 1, 0, is_first_of_library)
      if (.not. allocated(model%materials(k)%library)) cycle
      if (model%materials(k)%library == model%materials(m)%library) is_first_of_library = .false.
    end do
  end function is_first_of_library


  !> Checks the routines that loads need.
  subroutine check_load_routines(model, options, error)
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: path
    integer :: i
    path = ''
    if (allocated(options%user)) path = options%user
    if (any(model%materials%is_user_field) .and. model%has_sdvini) call check_routine(model%routines, path, ROUTINE_SDVINI, &
      '*INITIAL CONDITIONS, TYPE=SOLUTION, USER', error)
    if (allocated(error)) return
    if (has_uel(model%user_elements)) call check_routine(model%routines, path, ROUTINE_UEL, '*USER ELEMENT', error)
    if (allocated(error)) return
    do i = 1, size(model%materials)
      if (allocated(error)) return
      if (model%materials(i)%is_user_field) call check_routine(field_library(model, model%materials(i)), path, ROUTINE_USDFLD, &
        '*USER DEFINED FIELD', error)
    end do
    if (allocated(error)) return
    if (any(model%amplitudes%is_user)) call check_routine(model%routines, path, ROUTINE_UAMP, '*AMPLITUDE, DEFINITION=USER', error)
    do i = 1, size(model%steps)
      if (allocated(error)) return
      associate (loads => model%steps(i)%distributed)
        if (any(loads%is_user .and. loads%kind /= DISTRIBUTED_TRACTION)) call check_routine(model%routines, path, ROUTINE_DLOAD, &
          'A load of the user', error)
        if (allocated(error)) return
        if (any(loads%is_user .and. loads%kind == DISTRIBUTED_TRACTION)) call check_routine(model%routines, path, &
          ROUTINE_UTRACLOAD, 'A traction of the user', error)
      end associate
      if (allocated(error)) return
      if (any(model%steps(i)%prescribed%is_user)) call check_routine(model%routines, path, ROUTINE_DISP, '*BOUNDARY, USER', error)
    end do
  end subroutine check_load_routines


  !> Checks the routines that interactions need.
  subroutine check_contact_routines(model, options, error)
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    type(interaction_type), allocatable :: laws(:)
    character(:), allocatable :: path
    integer :: i
    path = ''
    if (allocated(options%user)) path = options%user
    laws = model%interactions
    do i = 1, size(model%steps)
      if (allocated(model%steps(i)%interactions)) laws = [laws, model%steps(i)%interactions]
    end do
    if (any(laws%is_user_friction)) call check_routine(model%routines, path, ROUTINE_FRIC, '*FRICTION, USER', error)
    if (allocated(error)) return
    if (any(laws%behavior == BEHAVIOR_USER)) call check_routine(model%routines, path, ROUTINE_UINTER, &
      '*SURFACE INTERACTION, USER', error)
  end subroutine check_contact_routines


  !> Before an attempt: calls UAMP for the factors at its end. Its state variables start from those of the last increment.
  subroutine update_user_amplitudes(model, amplitudes, state)
    type(model_type), intent(in) :: model
    type(amplitude_type), intent(inout) :: amplitudes(:)   !< out: the factors of those by UAMP
    type(state_type), intent(inout) :: state       !< old memory; new times, numbers; out: new memory
    type(uamp_type) :: values
    character(USER_NAME_LENGTH) :: name
    integer :: i, first
    first = 1
    do i = 1, size(amplitudes)
      associate (amplitude => amplitudes(i), old => state%old, new => state%new)
        if (.not. amplitude%is_user) cycle
        name = amplitude%name
        associate (svars => new%user_memory(first + 1:first + amplitude%n_svars))
          values = uamp_type(step=new%step, increment=new%increment, old=old%user_memory(first))
          values%value = values%old
          if (old%increment == 0) then             ! before the first increment
            values%is_first = 1
            call call_uamp(model%routines, name, amplitude%props, svars, values)
            values%old = values%value
          end if
          values%is_first = 0
          values%time = [new%step_time, new%total_time]
          values%dt = new%time_increment
          call call_uamp(model%routines, name, amplitude%props, svars, values)
        end associate
        new%user_memory(first) = values%value
        first = first + 1 + amplitude%n_svars
      end associate
    end do
    call restore_user_amplitudes(amplitudes, state%new)
  end subroutine update_user_amplitudes


  !> Restores the factors stored in some fields.
  subroutine restore_user_amplitudes(amplitudes, fields)
    type(amplitude_type), intent(inout) :: amplitudes(:)
    type(fields_type), intent(in) :: fields
    integer :: i, first
    first = 1
    do i = 1, size(amplitudes)
      if (.not. amplitudes(i)%is_user) cycle
      amplitudes(i)%time = [fields%total_time]
      amplitudes(i)%factor = [fields%user_memory(first)]
      first = first + 1 + amplitudes(i)%n_svars
    end do
  end subroutine restore_user_amplitudes


  !> Length of the first increment [time].
  pure real(DP) function first_increment(model)
    type(model_type), intent(in) :: model
    first_increment = 1
    if (size(model%steps) > 0) first_increment = model%steps(1)%dt_initial
  end function first_increment


  !> Sets an error if a routine is missing.
  subroutine check_routine(routines, path, which, caller, error)
    type(user_library_type), intent(in) :: routines
    character(*), intent(in) :: path               !< file of the routine; empty: none was given
    integer, intent(in) :: which                   !< ROUTINE_...
    character(*), intent(in) :: caller                !< what requires it
    type(error_type), allocatable, intent(out) :: error
    if (has_routine(routines, which)) return
    if (path /= '') then
      call set_error(error, EXIT_SETUP, caller // ' needs the user routine ' // trim(ROUTINE_NAMES(which)) &
        // ', which is not in ' // &
        path // '.')
    else
      call set_error(error, EXIT_USAGE, caller // ' needs the user routine ' // trim(ROUTINE_NAMES(which)) // '; name the file ' &
        // &
        'that holds it: amontons job user=file.f (or .f90, .for, .so).')
    end if
  end subroutine check_routine


  !> Logs the messages of the routines since the last call, takes the smallest PNEWDT, and ends the job after XIT or a crash.
  subroutine handle_user_messages(model, logger, pnewdt, error)
    type(model_type), intent(in) :: model
    type(logger_type), intent(inout) :: logger
    real(DP), intent(inout) :: pnewdt              !< smallest of this attempt [-]
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: text
    real(DP) :: smallest
    logical :: is_stopped, has_stopped, has_crashed
    integer :: m
    has_stopped = .false.
    do m = 0, size(model%materials)
      if (m == 0) then
        call collect_user_messages(model%routines, smallest, text, is_stopped, has_crashed)
      else
        if (.not. is_first_of_library(model, m)) cycle
        call collect_user_messages(model%materials(m)%routines, smallest, text, is_stopped, has_crashed)
      end if
      pnewdt = min(pnewdt, smallest)
      has_stopped = has_stopped .or. is_stopped
      if (has_crashed) then
        call set_error(error, EXIT_NOT_CONVERGED, text(index(text, ERROR_MARK, back=.true.) + len(ERROR_MARK):len(text) - 1) // &
          ' ' // CRASH_REMEDY // ' All converged increments are on disk.')
        return
      end if
      if (len(text) > 0) call logger%say('User routines: ' // text(:len(text) - 1))
    end do
    if (has_stopped) call set_error(error, EXIT_NOT_CONVERGED, 'A user routine has ended the job (XIT or STDB_ABQERR). ' // &
      'All converged increments are on disk.')
  end subroutine handle_user_messages

end module amontons_user_routine_setup
