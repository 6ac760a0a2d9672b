!> Shared libraries with user subroutines (UMAT, FRIC, UINTER, DLOAD, UTRACLOAD, DISP, UAMP, SDVINI, UEL, ...) and
!! their calls.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The calls are declared pure: pure element procedures call them, and the results depend on the arguments only.
!! Calls of a routine with internal memory are serialized, but their order is not fixed.
module amontons_user_routines
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_int, c_null_char, c_null_ptr, c_ptr
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_IO, EXIT_SETUP, EXIT_SOLVER
  use amontons_text, only: NEWLINE
  implicit none
  private
  public :: user_library_type, umat_type, uamp_type, open_routines, close_routines, has_routine, collect_user_messages, &
    pass_job_name
  public :: fric_type, uinter_type, call_fric, call_uinter, uel_type, call_uel, usdfld_type, call_usdfld
  public :: creep_type, call_creep
  public :: call_umat, call_sdvini, call_dload, call_utracload, call_disp, call_uamp, call_uexternaldb
  public :: LOP_JOB_START, LOP_INCREMENT_START, LOP_INCREMENT_END, LOP_JOB_END, LOP_RESTART, LOP_STEP_START, LOP_STEP_END
  public :: ROUTINE_UMAT, ROUTINE_FRIC, ROUTINE_UINTER, ROUTINE_DLOAD, ROUTINE_DISP, ROUTINE_UAMP, ROUTINE_SDVINI, ROUTINE_UEL, &
    ROUTINE_USDFLD, ROUTINE_UEXTERNALDB, ROUTINE_UTRACLOAD, ROUTINE_CREEP, ROUTINE_NAMES, USER_NAME_LENGTH

  integer, parameter :: ROUTINE_UMAT = 0, ROUTINE_FRIC = 1, ROUTINE_UINTER = 2, ROUTINE_DLOAD = 3, ROUTINE_DISP = 4, &
    ROUTINE_UAMP = 5, &
    ROUTINE_SDVINI = 6, ROUTINE_UEL = 7, ROUTINE_USDFLD = 8, ROUTINE_UEXTERNALDB = 9, ROUTINE_UTRACLOAD = 10, ROUTINE_CREEP = 11
  character(11), parameter :: ROUTINE_NAMES(0:11) = [character(11) :: 'UMAT', 'FRIC', 'UINTER', 'DLOAD', 'DISP', 'UAMP', &
    'SDVINI', 'UEL', 'USDFLD', 'UEXTERNALDB', 'UTRACLOAD', 'CREEP']

  ! LOP of UEXTERNALDB: when it is called.
  integer, parameter :: LOP_JOB_START = 0, LOP_INCREMENT_START = 1, LOP_INCREMENT_END = 2, LOP_JOB_END = 3, LOP_RESTART = 4, &
    LOP_STEP_START = 5, LOP_STEP_END = 6
  integer, parameter :: USER_NAME_LENGTH = 80             !< longest name passed to a routine
  integer, parameter :: MESSAGE_LENGTH = 8192           !< of messages of a compiler or a routine

  ! Status codes of opening; the same numbers as in the shim.
  integer, parameter :: LIBRARY_OPENED = 0, LIBRARY_NOT_FOUND = 1, LIBRARY_NOT_COMPILED = 2, LIBRARY_NOT_LOADED = 3, &
    LIBRARY_NO_ROUTINE = 4

  !> An open library; a copy is the same library.
  type :: user_library_type
    private
    type(c_ptr) :: handle = c_null_ptr
  end type user_library_type

  !> Arguments of UMAT except STATEV and PROPS; components 11 22 33 12 13 23, engineering shears.
  type, bind(C) :: umat_type
    real(c_double) :: stress(6) = 0                !< in: at the start, rotated; out: at the end [stress]
    real(c_double) :: ddsdde(6, 6) = 0             !< [stress]
    real(c_double) :: energies(3) = 0              !< SSE SPD SCD [stress]
    real(c_double) :: stran(6) = 0, dstran(6) = 0  !< [-]
    real(c_double) :: time(2) = 0                  !< step, total, at the start of the increment [time]
    real(c_double) :: dtime = 0                    !< [time]
    real(c_double) :: temp = 0, dtemp = 0          !< [temperature]
    real(c_double) :: celent = 0                   !< [length]
    real(c_double) :: coords(3) = 0                !< of the point [length]
    real(c_double) :: drot(3, 3) = 0, dfgrd0(3, 3) = 0, dfgrd1(3, 3) = 0   !< [-]
    integer(c_int) :: noel = 0, npt = 0, step = 0, increment = 0
    integer(c_int) :: is_accepted = 0                 !< out; 1: valid result; 2: PNEWDT < 1; 0: XIT
    integer(c_int) :: ndi = 3, nshr = 3            !< normal and shear components passed to UMAT; the others are zero
  end type umat_type

  !> Arguments of CREEP except names; implicit, at the end of the increment.
  type, bind(C) :: creep_type
    real(c_double) :: decra(5) = 0                 !< out: increment of the creep strain, its derivatives by EC, swelling, P, QTILD
    real(c_double) :: ec(2) = 0                    !< creep strain at the start and at the end [-]
    real(c_double) :: p = 0, qtild = 0             !< pressure, von Mises stress [stress]
    real(c_double) :: temp = 0, dtemp = 0          !< at the end, and its change in the increment [temperature]
    real(c_double) :: time(3) = 0                  !< step, total, creep, at the end of the increment [time]
    real(c_double) :: dtime = 0                    !< [time]
    real(c_double) :: coords(3) = 0                !< of the point [length]
    integer(c_int) :: noel = 0, npt = 0, step = 0, increment = 0
    integer(c_int) :: is_accepted = 0              !< out; 0: XIT
  end type creep_type

  !> Arguments of UAMP except properties and variables.
  type, bind(C) :: uamp_type
    real(c_double) :: time(2) = 0                  !< step, total, at the end of the increment [time]
    real(c_double) :: dt = 0                       !< [time]
    real(c_double) :: old = 0                      !< ampValueOld [-]
    real(c_double) :: value = 0                    !< AmpValueNew [-]
    integer(c_int) :: is_first = 0                 !< 1: the call before the first increment
    integer(c_int) :: step = 0, increment = 0
    integer(c_int) :: is_accepted = 0                 !< out; 0: XIT
  end type uamp_type

  !> Arguments of FRIC except names, STATEV and PROPS; in the plane only the first components count.
  type, bind(C) :: fric_type
    real(c_double) :: tau(2) = 0, ddtddg(2, 2) = 0, ddtddp(2) = 0   !< out [stress], [stress/length], [-]
    real(c_double) :: dslip(2) = 0                 !< out: irrecoverable slip of the increment [length]
    real(c_double) :: sed = 0, sfd = 0             !< out [stress length]
    real(c_double) :: dgam(2) = 0                  !< of the increment [length]
    real(c_double) :: taulm(2) = 0                 !< friction stress required for stick [stress]
    real(c_double) :: press = 0, dpress = 0, ddpddh = 0   !< [stress], [stress], [stress/length]
    real(c_double) :: slip(2) = 0                  !< at the start of the increment [length]
    real(c_double) :: time(2) = 0, dtime = 0       !< step, total, at the end of the increment [time]
    real(c_double) :: coords(3) = 0, length = 0    !< COORDS, CHRLNGTH [length]
    real(c_double) :: temp(2) = 0                  !< [temperature]
    integer(c_int) :: lm = 0                       !< in, out
    integer(c_int) :: node = 0, nfdir = 2, mcrd = 3, step = 0, increment = 0
    integer(c_int) :: is_accepted = 0                 !< out; 0: XIT
  end type fric_type

  !> Arguments of UINTER except names, STATEV and PROPS; in the plane only the first two components count.
  type, bind(C) :: uinter_type
    real(c_double) :: stress(3) = 0, ddsddr(3, 3) = 0   !< in: at the start; out [stress], [stress/length]
    real(c_double) :: sed = 0, sfd = 0             !< [stress length]
    real(c_double) :: rdisp(3) = 0, drdisp(3) = 0  !< penetration, slip [length]
    real(c_double) :: temp(2) = 0                  !< [temperature]
    real(c_double) :: time(2) = 0, dtime = 0       !< step, total, at the end of the increment [time]
    real(c_double) :: coords(3) = 0                !< [length]
    real(c_double) :: axes(3, 3) = 0               !< ALOCALDIR
    real(c_double) :: area = 0                     !< [length^2]
    integer(c_int) :: node = 0, ndir = 3, mcrd = 3, step = 0, increment = 0
    integer(c_int) :: is_closed = 0                !< LOPENCLOSE
    integer(c_int) :: is_accepted = 0                 !< out; 0: XIT
  end type uinter_type

  !> Arguments of UEL except arrays.
  type, bind(C) :: uel_type
    real(c_double) :: time(2) = 0                  !< step, total, at the end of the increment [time]
    real(c_double) :: dtime = 0, period = 0        !< [time]
    integer(c_int) :: lflags(10) = 0
    integer(c_int) :: ndofel = 0, nsvars = 0, mcrd = 0, nnode = 0, npredf = 0, jtype = 0, element = 0
    integer(c_int) :: step = 0, increment = 0
    integer(c_int) :: is_accepted = 0              !< out; 1: valid result; 2: PNEWDT < 1; 0: XIT
  end type uel_type

  !> Arguments of USDFLD except names, FIELD and STATEV, at the start of the increment, and what GETVRM gives.
  type, bind(C) :: usdfld_type
    real(c_double) :: stress(6) = 0                !< 11 22 33 12 13 23 [stress]
    real(c_double) :: strain(6) = 0                !< the same order, engineering shears [-]
    real(c_double) :: plastic(7) = 0               !< plastic strain, PEEQ [-]
    real(c_double) :: time(2) = 0                  !< step, total [time]
    real(c_double) :: dtime = 0                    !< [time]
    real(c_double) :: temp = 0                     !< [temperature]
    real(c_double) :: celent = 0                   !< [length]
    real(c_double) :: coords(3) = 0                !< of the point [length]
    real(c_double) :: direct(3, 3) = 0             !< local axes in columns
    integer(c_int) :: noel = 0, npt = 0, ndi = 3, nshr = 3, nfield = 0, nstatv = 0, step = 0, increment = 0
    integer(c_int) :: is_accepted = 0              !< out; 1: valid result; 2: PNEWDT < 1; 0: XIT
  end type usdfld_type

  interface
    subroutine usdfld_c(handle, names, field, statev, values) bind(C, name='amontons_user_usdfld')
      import :: c_char, c_double, c_ptr, usdfld_type
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: names(*)
      real(c_double), intent(inout) :: field(*), statev(*)
      type(usdfld_type), intent(inout) :: values
    end subroutine usdfld_c

    subroutine uel_c(handle, props, jprops, counts, inputs, rhs, amatrx, memory, values) bind(C, name='amontons_user_uel')
      import :: c_double, c_int, c_ptr, uel_type
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: props(*), inputs(*)
      integer(c_int), intent(in) :: jprops(*), counts(2)
      real(c_double), intent(inout) :: rhs(*), amatrx(*), memory(*)
      type(uel_type), intent(inout) :: values
    end subroutine uel_c

    pure subroutine fric_c(handle, names, props, nprops, statev, nstatv, values) bind(C, name='amontons_user_fric')
      import :: c_char, c_double, c_int, c_ptr, fric_type
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: names(*)
      real(c_double), intent(in) :: props(*)
      integer(c_int), value :: nprops, nstatv
      real(c_double), intent(inout) :: statev(*)
      type(fric_type), intent(inout) :: values
    end subroutine fric_c

    pure subroutine uinter_c(handle, names, props, nprops, statev, nstatv, values) bind(C, name='amontons_user_uinter')
      import :: c_char, c_double, c_int, c_ptr, uinter_type
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: names(*)
      real(c_double), intent(in) :: props(*)
      integer(c_int), value :: nprops, nstatv
      real(c_double), intent(inout) :: statev(*)
      type(uinter_type), intent(inout) :: values
    end subroutine uinter_c

    function open_c(path, message, capacity, handle) bind(C, name='amontons_user_open') result(status)
      import :: c_char, c_int, c_ptr
      character(kind=c_char), intent(in) :: path(*)
      character(kind=c_char), intent(out) :: message(*)
      integer(c_int), value :: capacity
      type(c_ptr), intent(out) :: handle
      integer(c_int) :: status
    end function open_c

    subroutine close_c(handle) bind(C, name='amontons_user_close')
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine close_c

    pure function has_c(handle, which) bind(C, name='amontons_user_has') result(has)
      import :: c_int, c_ptr
      type(c_ptr), value :: handle
      integer(c_int), value :: which
      integer(c_int) :: has
    end function has_c

    subroutine job_c(handle, folder, job) bind(C, name='amontons_user_job')
      import :: c_char, c_ptr
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: folder(*), job(*)
    end subroutine job_c

    subroutine messages_c(handle, smallest, is_stopped, text, capacity) bind(C, name='amontons_user_news')
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), intent(out) :: smallest
      integer(c_int), intent(out) :: is_stopped
      character(kind=c_char), intent(out) :: text(*)
      integer(c_int), value :: capacity
    end subroutine messages_c

    pure subroutine umat_c(handle, cmname, props, nprops, statev, nstatv, fields, nfield, values) &
      bind(C, name='amontons_user_umat')
      import :: c_char, c_double, c_int, c_ptr, umat_type
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: cmname(*)
      real(c_double), intent(in) :: props(*), fields(*)
      integer(c_int), value :: nprops, nstatv, nfield
      real(c_double), intent(inout) :: statev(*)
      type(umat_type), intent(inout) :: values
    end subroutine umat_c

    pure subroutine creep_c(handle, cmname, values) bind(C, name='amontons_user_creep')
      import :: c_char, c_ptr, creep_type
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: cmname(*)
      type(creep_type), intent(inout) :: values
    end subroutine creep_c

    pure subroutine sdvini_c(handle, statev, nstatv, coords, noel, npt, is_taken) bind(C, name='amontons_user_sdvini')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), intent(inout) :: statev(*)
      integer(c_int), value :: nstatv, noel, npt
      real(c_double), intent(in) :: coords(*)
      integer(c_int), intent(out) :: is_taken
    end subroutine sdvini_c

    subroutine uexternaldb_c(handle, times, counts) bind(C, name='amontons_user_uexternaldb')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), intent(in) :: times(3)
      integer(c_int), intent(in) :: counts(3)
    end subroutine uexternaldb_c

    pure subroutine dload_c(handle, f, time, coords, sname, counts, is_taken) bind(C, name='amontons_user_dload')
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), intent(inout) :: f
      real(c_double), intent(in) :: time(*), coords(*)
      character(kind=c_char), intent(in) :: sname(*)
      integer(c_int), intent(in) :: counts(*)
      integer(c_int), intent(out) :: is_taken
    end subroutine dload_c

    pure subroutine utracload_c(handle, alpha, t_user, time, coords, dircos, sname, counts, is_taken) &
      bind(C, name='amontons_user_utracload')
      import :: c_char, c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), intent(inout) :: alpha, t_user(*)
      real(c_double), intent(in) :: time(*), coords(*), dircos(*)
      character(kind=c_char), intent(in) :: sname(*)
      integer(c_int), intent(in) :: counts(*)
      integer(c_int), intent(out) :: is_taken
    end subroutine utracload_c

    pure subroutine disp_c(handle, u, time, coords, counts, is_taken) bind(C, name='amontons_user_disp')
      import :: c_double, c_int, c_ptr
      type(c_ptr), value :: handle
      real(c_double), intent(inout) :: u
      real(c_double), intent(in) :: time(*), coords(*)
      integer(c_int), intent(in) :: counts(*)
      integer(c_int), intent(out) :: is_taken
    end subroutine disp_c

    pure subroutine uamp_c(handle, name, props, nprops, svars, nsvars, values) bind(C, name='amontons_user_uamp')
      import :: c_char, c_double, c_int, c_ptr, uamp_type
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), intent(in) :: props(*)
      integer(c_int), value :: nprops, nsvars
      real(c_double), intent(inout) :: svars(*)
      type(uamp_type), intent(inout) :: values
    end subroutine uamp_c
  end interface

contains

  !> Opens a shared library, or compiles a Fortran file into one first.
  !!
  !! Errors: EXIT_IO (missing, compilation failed, not a library for this machine), EXIT_SETUP (no known routine in it).
  subroutine open_routines(path, routines, error)
    character(*), intent(in) :: path
    type(user_library_type), intent(out) :: routines
    type(error_type), allocatable, intent(out) :: error
    character(MESSAGE_LENGTH) :: message
    character(:), allocatable :: who
    who = 'The user routines ' // path // ' '
    select case (open_c(path // c_null_char, message, len(message), routines%handle))
    case (LIBRARY_OPENED)
    case (LIBRARY_NOT_FOUND)
      call set_error(error, EXIT_IO, who // 'do not exist: no such file.')
    case (LIBRARY_NOT_COMPILED)
      call set_error(error, EXIT_IO, who // 'do not compile:' // NEWLINE // text_before_null(message))
    case (LIBRARY_NOT_LOADED)
      call set_error(error, EXIT_IO, who // 'cannot be loaded: ' // text_before_null(message) // '.')
    case (LIBRARY_NO_ROUTINE)
      call set_error(error, EXIT_SETUP, who // 'hold none of UMAT, FRIC, UINTER, DLOAD, DISP, UAMP, SDVINI, UEL, USDFLD, ' // &
        'UEXTERNALDB, UTRACLOAD, CREEP (as umat_, ..., the name that a Fortran compiler gives a SUBROUTINE UMAT).')
    case default
      call set_error(error, EXIT_SOLVER, who // 'cannot be opened: there is no memory.')
    end select
  end subroutine open_routines


  !> A C string up to its terminator.
  pure function text_before_null(text) result(short)
    character(*), intent(in) :: text
    character(:), allocatable :: short
    short = text(:index(text // c_null_char, c_null_char) - 1)
  end function text_before_null


  !> Closes a library; no call may follow.
  subroutine close_routines(routines)
    type(user_library_type), intent(inout) :: routines
    call close_c(routines%handle)
    routines%handle = c_null_ptr
  end subroutine close_routines


  !> Whether a library is open and contains a routine.
  pure logical function has_routine(routines, which)
    type(user_library_type), intent(in) :: routines
    integer, intent(in) :: which                   !< USER_...
    has_routine = .false.
    if (c_associated(routines%handle)) has_routine = has_c(routines%handle, which) /= 0
  end function has_routine


  !> Folder and name of the job, for GETOUTDIR and GETJOBNAME.
  subroutine pass_job_name(routines, folder, job)
    type(user_library_type), intent(in) :: routines
    character(*), intent(in) :: folder, job
    call job_c(routines%handle, folder // c_null_char, job // c_null_char)
  end subroutine pass_job_name


  !> Reports of the routines since the last call of this procedure: the smallest PNEWDT (1: none), the lines of STDB_ABQERR or of
  !! a crash, whether XIT was called or a routine has crashed.
  subroutine collect_user_messages(routines, smallest, text, is_stopped, has_crashed)
    type(user_library_type), intent(in) :: routines
    real(DP), intent(out) :: smallest              !< [-]
    character(:), allocatable, intent(out) :: text
    logical, intent(out) :: is_stopped, has_crashed
    integer(c_int), parameter :: CRASHED = 2       ! as in the shim
    character(MESSAGE_LENGTH) :: buffer
    integer(c_int) :: stopped
    smallest = 1
    text = ''
    is_stopped = .false.
    has_crashed = .false.
    if (.not. c_associated(routines%handle)) return
    call messages_c(routines%handle, smallest, stopped, buffer, len(buffer))
    text = text_before_null(buffer)
    is_stopped = stopped /= 0
    has_crashed = stopped == CRASHED
  end subroutine collect_user_messages


  !> Calls UMAT.
  pure subroutine call_umat(routines, name, props, statev, fields, values)
    type(user_library_type), intent(in) :: routines
    character(USER_NAME_LENGTH), intent(in) :: name       !< CMNAME
    real(DP), intent(in) :: props(:)               !< PROPS
    real(DP), intent(inout) :: statev(:)           !< STATEV
    real(DP), intent(in) :: fields(:, :)           !< (n, 2) PREDEF, DPRED
    type(umat_type), intent(inout) :: values
    real(DP) :: given(max(1, size(fields, 1)), 2)   ! a routine may look at the first of none
    given = 0
    given(:size(fields, 1), :) = fields
    call umat_c(routines%handle, name, props, size(props), statev, size(statev), given, size(given, 1), values)
  end subroutine call_umat


  !> Calls CREEP.
  pure subroutine call_creep(routines, name, values)
    type(user_library_type), intent(in) :: routines
    character(USER_NAME_LENGTH), intent(in) :: name       !< CMNAME
    type(creep_type), intent(inout) :: values
    call creep_c(routines%handle, name, values)
  end subroutine call_creep


  !> Calls SDVINI.
  pure subroutine call_sdvini(routines, statev, coordinates, element, point, is_taken)
    type(user_library_type), intent(in) :: routines
    real(DP), intent(inout) :: statev(:)           !< STATEV
    real(DP), intent(in) :: coordinates(3)         !< of the point [length]
    integer, intent(in) :: element, point          !< label, number from 1
    logical, intent(out) :: is_taken
    integer(c_int) :: taken
    call sdvini_c(routines%handle, statev, size(statev), coordinates, element, point, taken)
    is_taken = taken /= 0
  end subroutine call_sdvini


  !> Calls DLOAD.
  pure subroutine call_dload(routines, magnitude, time, coordinates, name, counts, is_taken)
    type(user_library_type), intent(in) :: routines
    real(DP), intent(inout) :: magnitude           !< F
    real(DP), intent(in) :: time(2)                !< step, total, at the end of the increment [time]
    real(DP), intent(in) :: coordinates(3)         !< of the point, current configuration [length]
    character(USER_NAME_LENGTH), intent(in) :: name       !< SNAME
    integer, intent(in) :: counts(5)               !< step, increment, NOEL, NPT, JLTYP
    logical, intent(out) :: is_taken
    integer(c_int) :: taken
    call dload_c(routines%handle, magnitude, time, coordinates, name, counts, taken)
    is_taken = taken /= 0
  end subroutine call_dload


  !> Calls UTRACLOAD. A magnitude without a direction ends the job.
  pure subroutine call_utracload(routines, magnitude, direction, time, places, name, counts, is_taken)
    type(user_library_type), intent(in) :: routines
    real(DP), intent(inout) :: magnitude           !< ALPHA [stress]
    real(DP), intent(inout) :: direction(3)        !< T_USER, of any length
    real(DP), intent(in) :: time(2)                !< step, total, at the end of the increment [time]
    real(DP), intent(in) :: places(3, 4)           !< COORDS of the point, current configuration [length]; DIRCOS
    character(USER_NAME_LENGTH), intent(in) :: name       !< SNAME
    integer, intent(in) :: counts(5)               !< step, increment, NOEL, NPT, JLTYP
    logical, intent(out) :: is_taken
    integer(c_int) :: taken
    call utracload_c(routines%handle, magnitude, direction, time, places(:, 1), places(:, 2:), name, counts, taken)
    is_taken = taken /= 0
  end subroutine call_utracload


  !> Calls DISP.
  pure subroutine call_disp(routines, u, time, coordinates, counts, is_taken)
    type(user_library_type), intent(in) :: routines
    real(DP), intent(inout) :: u                   !< U(1) [length]
    real(DP), intent(in) :: time(3)                !< step, total, at the end of the increment; its length [time]
    real(DP), intent(in) :: coordinates(3)         !< of the node, current configuration [length]
    integer, intent(in) :: counts(4)               !< step, increment, NODE, JDOF
    logical, intent(out) :: is_taken
    integer(c_int) :: taken
    call disp_c(routines%handle, u, time, coordinates, counts, taken)
    is_taken = taken /= 0
  end subroutine call_disp


  !> Calls UAMP.
  pure subroutine call_uamp(routines, name, props, svars, values)
    type(user_library_type), intent(in) :: routines
    character(USER_NAME_LENGTH), intent(in) :: name       !< ampName
    real(DP), intent(in) :: props(:)               !< props
    real(DP), intent(inout) :: svars(:)            !< svars
    type(uamp_type), intent(inout) :: values
    call uamp_c(routines%handle, name, props, size(props), svars, size(svars), values)
  end subroutine call_uamp


  !> Calls UEL.
  subroutine call_uel(routines, props, jprops, inputs, rhs, amatrx, memory, values)
    type(user_library_type), intent(in) :: routines
    real(DP), intent(in) :: props(:)               !< PROPS
    integer, intent(in) :: jprops(:)               !< JPROPS
    real(DP), intent(in) :: inputs(:)              !< COORDS, U, DU, PREDEF, one after the other
    real(DP), intent(inout) :: rhs(:)              !< (NDOFEL) RHS [force]
    real(DP), intent(inout) :: amatrx(:, :)        !< (NDOFEL, NDOFEL) AMATRX [force/length]
    real(DP), intent(inout) :: memory(:)           !< SVARS, ENERGY
    type(uel_type), intent(inout) :: values
    call uel_c(routines%handle, props, jprops, [size(props), size(jprops)], inputs, rhs, amatrx, memory, values)
  end subroutine call_uel


  !> Calls USDFLD.
  subroutine call_usdfld(routines, names, field, statev, values)
    type(user_library_type), intent(in) :: routines
    character(USER_NAME_LENGTH), intent(in) :: names(2)   !< CMNAME, ORNAME
    real(DP), intent(inout) :: field(:)            !< FIELD
    real(DP), intent(inout) :: statev(:)           !< STATEV
    type(usdfld_type), intent(inout) :: values
    values%nfield = size(field)
    values%nstatv = size(statev)
    call usdfld_c(routines%handle, names(1) // names(2), field, statev, values)
  end subroutine call_usdfld


  !> Calls UEXTERNALDB of a library that has it.
  subroutine call_uexternaldb(routines, lop, times, step, increment)
    type(user_library_type), intent(in) :: routines
    integer, intent(in) :: lop                     !< LOP_...
    real(DP), intent(in) :: times(3)               !< TIME: step, total; DTIME [time]
    integer, intent(in) :: step, increment         !< KSTEP, KINC
    if (has_routine(routines, ROUTINE_UEXTERNALDB)) call uexternaldb_c(routines%handle, times, [lop, step, increment])
  end subroutine call_uexternaldb


  !> Calls FRIC.
  pure subroutine call_fric(routines, names, props, statev, values)
    type(user_library_type), intent(in) :: routines
    character(USER_NAME_LENGTH), intent(in) :: names(3)   !< CINAME, SLNAME, MSNAME
    real(DP), intent(in) :: props(:)               !< PROPS
    real(DP), intent(inout) :: statev(:)           !< STATEV
    type(fric_type), intent(inout) :: values
    call fric_c(routines%handle, names(1) // names(2) // names(3), props, size(props), statev, size(statev), values)
  end subroutine call_fric


  !> Calls UINTER.
  pure subroutine call_uinter(routines, names, props, statev, values)
    type(user_library_type), intent(in) :: routines
    character(USER_NAME_LENGTH), intent(in) :: names(3)   !< CINAME, SLNAME, MSNAME
    real(DP), intent(in) :: props(:)               !< PROPS
    real(DP), intent(inout) :: statev(:)           !< STATEV
    type(uinter_type), intent(inout) :: values
    call uinter_c(routines%handle, names(1) // names(2) // names(3), props, size(props), statev, size(statev), values)
  end subroutine call_uinter

end module amontons_user_routines
