!> Unit test of user_routines: libraries that open and those that do not, the arguments of each call, XIT.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_user_routines
  use amontons_errors, only: error_type, EXIT_IO, EXIT_SETUP
  use amontons_kinds, only: DP
  use amontons_user_routines, only: user_library_type, creep_type, uamp_type, fric_type, uinter_type, open_routines, &
    close_routines, call_creep, &
    has_routine, collect_user_messages, pass_job_name, call_sdvini, call_dload, call_utracload, call_disp, call_uamp, &
    call_fric, call_uinter, &
    ROUTINE_UMAT, ROUTINE_FRIC, ROUTINE_UINTER, ROUTINE_DLOAD, ROUTINE_DISP, ROUTINE_UAMP, ROUTINE_SDVINI, ROUTINE_CREEP, &
    ROUTINE_NAMES, USER_NAME_LENGTH
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(user_library_type) :: routines
  type(error_type), allocatable :: error
  call write_user_file('test_user_routines.f90')
  call open_routines('test_user_routines.f90', routines, error)
  call suite%that('opened', .not. allocated(error))
  if (allocated(error)) error stop 'the routines do not compile'
  call check_contents()
  call check_loads()
  call check_amplitude()
  call check_contact()
  call check_creep()
  call check_end()
  call check_errors()
  call suite%finish()

contains

  include 'sample_user.inc'

  !> What the library has; a closed one has nothing.
  subroutine check_contents()
    type(user_library_type) :: none
    integer :: which
    do which = 0, 6
      call suite%that('has ' // ROUTINE_NAMES(which), has_routine(routines, which) .eqv. which /= ROUTINE_UMAT)
      call suite%that('a library that is not open', .not. has_routine(none, which))
    end do
    call suite%that('names', ROUTINE_NAMES(ROUTINE_FRIC) == 'FRIC' .and. ROUTINE_NAMES(ROUTINE_UINTER) == 'UINTER' .and. &
      ROUTINE_NAMES(ROUTINE_DLOAD) == 'DLOAD' .and. ROUTINE_NAMES(ROUTINE_DISP) == 'DISP' .and. &
      ROUTINE_NAMES(ROUTINE_UAMP) == 'UAMP' .and. ROUTINE_NAMES(ROUTINE_SDVINI) == 'SDVINI')
    call suite%that('has CREEP', has_routine(routines, ROUTINE_CREEP) .and. ROUTINE_NAMES(ROUTINE_CREEP) == 'CREEP')
    call pass_job_name(routines, 'folder', 'job')
  end subroutine check_contents


  !> DLOAD, DISP and SDVINI: arguments in their places.
  subroutine check_loads()
    real(DP) :: value, statev(2), direction(3)
    logical :: is_taken
    character(USER_NAME_LENGTH) :: name
    name = ''
    value = 0
    call call_dload(routines, value, [0.5_DP, 9.0_DP], [1.0_DP, 2.0_DP, 3.0_DP], name, [1, 2, 7, 4, 23], is_taken)
    call suite%near('DLOAD', value, 1.0_DP + 20.0_DP + 400.0_DP + 3000.0_DP + 0.5_DP, 0.0_DP)
    call suite%that('taken', is_taken)
    value = 5
    direction = [1.0_DP, 0.0_DP, 0.0_DP]
    call call_utracload(routines, value, direction, [0.5_DP, 9.0_DP], reshape([real(DP) :: 1, 2, 3, 1, 0, 0, 0, 1, 0, 0, 0, 1], &
      [3, 4]), name, [1, 2, 7, 4, 523], is_taken)
    call suite%near('UTRACLOAD', value, 5.0_DP + 1.0_DP + 20.0_DP + 400.0_DP + 3000.0_DP + 0.5_DP + 7.0_DP, 0.0_DP)
    call suite%near('its direction', norm2(direction - [1.0_DP, 0.0_DP, 2.0_DP]), 0.0_DP, 0.0_DP)
    call suite%that('its traction is taken', is_taken)
    call call_disp(routines, value, [0.5_DP, 9.0_DP, 0.25_DP], [4.0_DP, 2.0_DP, 3.0_DP], [1, 2, 7, 3], is_taken)
    call suite%near('DISP', value, 9.0_DP + 70.0_DP + 300.0_DP + 4.0_DP, 0.0_DP)
    call call_sdvini(routines, statev, [1.5_DP, 2.0_DP, 3.0_DP], 7, 4, is_taken)
    call suite%near('SDVINI', maxval(abs(statev - [1.5_DP, 704.0_DP])), 0.0_DP, 0.0_DP)
  end subroutine check_loads


  !> UAMP: value and state; another name ends the job.
  subroutine check_amplitude()
    type(uamp_type) :: values
    character(USER_NAME_LENGTH) :: name
    real(DP) :: svars(1), smallest
    character(:), allocatable :: text
    logical :: is_stopped, has_crashed
    name = 'RAMP'
    svars = 5
    values%time = [0.5_DP, 2.0_DP]
    values%old = 0.25_DP
    call call_uamp(routines, name, [3.0_DP], svars, values)
    call suite%that('accepted', values%is_accepted == 1)
    call suite%near('UAMP', values%value, 6.25_DP, 0.0_DP)
    call suite%near('its variable', svars(1), 6.0_DP, 0.0_DP)
    call collect_user_messages(routines, smallest, text, is_stopped, has_crashed)
    call suite%that('nothing to report', .not. is_stopped .and. .not. has_crashed .and. text == '' .and. smallest >= 1)
    name = 'OTHER'
    call call_uamp(routines, name, [3.0_DP], svars, values)
    call suite%that('XIT', values%is_accepted == 0)
    call collect_user_messages(routines, smallest, text, is_stopped, has_crashed)
    call suite%that('is reported', is_stopped .and. .not. has_crashed)
  end subroutine check_amplitude


  !> CREEP: arguments in their places; swelling and a negative increment end the job with a message.
  subroutine check_creep()
    type(creep_type) :: values
    character(USER_NAME_LENGTH) :: name
    character(:), allocatable :: text
    real(DP) :: smallest
    logical :: is_stopped, has_crashed
    name = 'LEAD'
    values = creep_type(ec=[3.0_DP, 4.0_DP], p=2.0_DP, qtild=1.0_DP, temp=5.0_DP, dtemp=6.0_DP, time=[1.0_DP, 2.0_DP, 3.0_DP], &
      dtime=4.0_DP, coords=[1.0_DP, 2.0_DP, 3.0_DP], noel=4, npt=5, step=6, increment=7)
    call call_creep(routines, name, values)
    call suite%near('CREEP', values%decra(1), 1654321.0_DP, 0.0_DP)
    call suite%near('its times', values%decra(2), 4321.0_DP, 0.0_DP)
    call suite%near('its place', values%decra(5), 7654321.0_DP, 0.0_DP)
    call suite%that('its creep is taken', values%is_accepted == 1)
    values%qtild = -1
    call call_creep(routines, name, values)
    call collect_user_messages(routines, smallest, text, is_stopped, has_crashed)
    call suite%that('a negative increment', values%is_accepted == 0 .and. is_stopped .and. index(text, 'negative increment') > 0)
    values%qtild = 11
    call call_creep(routines, name, values)
    call collect_user_messages(routines, smallest, text, is_stopped, has_crashed)
    call suite%that('swelling', values%is_accepted == 0 .and. is_stopped .and. index(text, 'swelling') > 0)
  end subroutine check_creep


  !> FRIC and UINTER: results, and LM.
  subroutine check_contact()
    type(fric_type) :: fric
    type(uinter_type) :: uinter
    character(USER_NAME_LENGTH) :: names(3)
    real(DP) :: statev(1)
    names = ['I', 'S', 'M']
    statev = 0
    fric%press = 4
    fric%dgam = [0.5_DP, 1.0_DP]
    fric%taulm = [3.0_DP, 0.0_DP]
    call call_fric(routines, names, [0.0_DP], statev, fric)
    call suite%near('FRIC', maxval(abs(fric%tau - [9.5_DP, 11.0_DP])), 0.0_DP, 0.0_DP)
    call suite%near('its derivatives', abs(fric%ddtddg(2, 2) - 3) + abs(fric%ddtddg(1, 2)) + abs(fric%ddtddp(2) - 2), 0.0_DP, &
      0.0_DP)
    call suite%that('slips', fric%lm == 0 .and. abs(statev(1) - 1) <= 0)
    fric%nfdir = 1                                   ! in the plane
    fric%mcrd = 2
    fric%dgam = [1.0_DP, 0.0_DP]
    call call_fric(routines, names, [0.0_DP], statev, fric)
    call suite%near('in the plane', fric%tau(1), 11.0_DP, 0.0_DP)
    fric%taulm = 0
    call call_fric(routines, names, [0.0_DP], statev, fric)
    call suite%that('sticks', fric%lm == 1)
    uinter%rdisp = [0.5_DP, 0.25_DP, 0.125_DP]
    call call_uinter(routines, names, [8.0_DP], statev, uinter)
    call suite%near('UINTER', maxval(abs(uinter%stress - [4.0_DP, 2.0_DP, 1.0_DP])), 0.0_DP, 0.0_DP)
    call suite%near('its derivative and energy', abs(uinter%ddsddr(3, 3) - 8) + abs(uinter%sed - 1), 0.0_DP, 0.0_DP)
  end subroutine check_contact


  !> A closed library has nothing to report.
  subroutine check_end()
    real(DP) :: smallest
    character(:), allocatable :: text
    logical :: is_stopped, has_crashed
    call close_routines(routines)
    call suite%that('closed', .not. has_routine(routines, ROUTINE_DLOAD))
    call collect_user_messages(routines, smallest, text, is_stopped, has_crashed)
    call suite%that('nothing', smallest >= 1 .and. .not. is_stopped .and. text == '')
  end subroutine check_end


  !> A text in a file that must not open.
  subroutine expect_error(path, text, code, piece)
    character(*), intent(in) :: path, text, piece
    integer, intent(in) :: code
    integer :: unit
    if (text /= '') then
      open (newunit=unit, file=path, status='replace', action='write')
      write (unit, '(a)') text
      close (unit)
    end if
    call open_routines(path, routines, error)
    call suite%that('error: ' // piece, allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == code .and. index(error%message, piece) > 0 .and. &
      index(error%message, path) > 0)
  end subroutine expect_error


  !> No file, no Fortran, no routine, no library.
  subroutine check_errors()
    call expect_error('test_user_none.f90', '', EXIT_IO, 'no such file')
    call expect_error('test_user_bad.f90', 'this is no Fortran', EXIT_IO, 'do not compile')
    call expect_error('test_user_empty.f90', 'subroutine nothing; end subroutine nothing', EXIT_SETUP, 'hold none of UMAT')
    call expect_error('test_user_bad.so', 'no library', EXIT_IO, 'cannot be loaded')
  end subroutine check_errors

end program test_user_routines
