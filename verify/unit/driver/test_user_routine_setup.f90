!> Unit test of user_routine_setup: routines that a deck needs, libraries of materials, amplitudes by UAMP, messages of routines.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_user_routine_setup
  use amontons_errors, only: error_type, EXIT_IO, EXIT_SETUP, EXIT_USAGE, EXIT_NOT_CONVERGED
  use amontons_kinds, only: DP
  use amontons_loads, only: amplitude_type, amplitude_value
  use amontons_logger, only: logger_type
  use amontons_model, only: model_type, job_options_type
  use amontons_state, only: state_type
  use amontons_surfaces, only: BEHAVIOR_USER
  use amontons_user_routine_setup, only: open_user_routines, close_user_routines, update_user_amplitudes, &
    restore_user_amplitudes, handle_user_messages, call_external_databases
  use amontons_user_routines, only: has_routine, ROUTINE_UAMP, ROUTINE_UMAT, LOP_INCREMENT_START, LOP_STEP_START
  use check, only: suite_type
  implicit none
  character(*), parameter :: PATH = 'test_setup_routines.f90'
  type(suite_type) :: suite
  type(job_options_type) :: options
  call write_user_file(PATH)
  options%job = 'test_setup'
  call check_needs()
  call check_library()
  call check_amplitudes()
  call check_external_databases()
  call suite%finish()

contains

  include 'sample_user.inc'

  !> A model without anything of a user, in one step.
  subroutine make_model(model)
    type(model_type), intent(out) :: model
    allocate (model%materials(1), model%amplitudes(1), model%interactions(1), model%steps(1))
    allocate (model%steps(1)%distributed(1), model%steps(1)%prescribed(1), model%steps(1)%concentrated(0))
    model%materials(1)%name = 'M'
    model%mesh%n_elements = 0
    model%mesh%material = [integer ::]
    model%mesh%kind = [integer ::]
  end subroutine make_model


  !> Opens the routines of a model; a piece of the error, none if empty.
  subroutine expect(name, model, code, piece)
    character(*), intent(in) :: name, piece
    type(model_type), intent(inout) :: model
    integer, intent(in) :: code
    type(error_type), allocatable :: error
    call open_user_routines(model, options, error)
    call suite%that(name // ': verdict', allocated(error) .eqv. piece /= '')
    if (allocated(error)) call suite%that(name // ': ' // error%message, error%code == code .and. index(error%message, piece) > 0)
    call close_user_routines(model)
  end subroutine expect


  !> Each need without a file, and with one that has the routine or not.
  subroutine check_needs()
    type(model_type) :: model
    call make_model(model)
    call expect('nothing needed', model, 0, '')
    model%steps(1)%distributed(1)%is_user = .true.
    call expect('no file', model, EXIT_USAGE, 'A load of the user needs the user routine DLOAD; name the file')
    options%user = PATH
    call expect('DLOAD', model, 0, '')
    model%steps(1)%prescribed(1)%is_user = .true.
    model%amplitudes(1)%is_user = .true.
    model%interactions(1)%is_user_friction = .true.
    call expect('DISP, UAMP, FRIC', model, 0, '')
    model%steps(1)%interactions = model%interactions
    model%steps(1)%interactions(1)%behavior = BEHAVIOR_USER
    call expect('UINTER of a step', model, 0, '')
    model%materials(1)%is_user = .true.
    call expect('UMAT', model, EXIT_SETUP, 'The material ''M'' needs the user routine UMAT, which is not in ' // PATH)
    options%user = 'no_such_file.f90'
    call expect('no such file', model, EXIT_IO, 'no such file')
    deallocate (options%user)
  end subroutine check_needs


  !> UEXTERNALDB of a file: LOP 0 at its opening, the start of an increment and that of a step.
  subroutine check_external_databases()
    type(model_type) :: model
    type(state_type) :: state
    type(error_type), allocatable :: error
    real(DP) :: line(6)
    integer :: unit, i
    open (newunit=unit, file='test_setup_database.f90', status='replace', action='write')
    write (unit, '(a)') 'subroutine uexternaldb(lop, lrestart, time, dtime, kstep, kinc)', &
      '  integer :: lop, lrestart, kstep, kinc', '  real(8) :: time(2), dtime', &
      '  open (98, file=''test_setup_calls.txt'', position=''append'')', '  write (98, *) lop, time, dtime, kstep, kinc', &
      '  close (98)', 'end subroutine uexternaldb'
    close (unit)
    call execute_command_line('rm -f test_setup_calls.txt')
    call make_model(model)
    options%user = 'test_setup_database.f90'
    call open_user_routines(model, options, error)
    call suite%that('opened', .not. allocated(error))
    state%new%step = 2
    state%new%increment = 3
    state%new%step_time = 0.75_DP
    state%new%total_time = 1.75_DP
    state%new%time_increment = 0.25_DP
    call call_external_databases(model, LOP_INCREMENT_START, state%new)
    call call_external_databases(model, LOP_STEP_START, state%new)
    call close_user_routines(model)
    open (newunit=unit, file='test_setup_calls.txt', status='old')
    do i = 1, 3
      read (unit, *) line
      if (i == 1) call suite%near('LOP 0', norm2(line), 0.0_DP, 0.0_DP)
      if (i == 2) call suite%near('LOP 1', norm2(line - [1.0_DP, 0.5_DP, 1.5_DP, 0.25_DP, 2.0_DP, 3.0_DP]), 0.0_DP, 1.0e-14_DP)
      if (i == 3) call suite%near('LOP 5', norm2(line - [5.0_DP, 0.0_DP, 1.75_DP, 0.0_DP, 3.0_DP, 0.0_DP]), 0.0_DP, 1.0e-14_DP)
    end do
    close (unit, status='delete')
  end subroutine check_external_databases


  !> LIBRARY of a material, beside the deck first; the same for two materials; an invalid initial tangent.
  subroutine check_library()
    type(model_type) :: model
    integer :: unit
    open (newunit=unit, file='test_setup_umat.f90', status='replace', action='write')
    write (unit, '(a)') 'subroutine umat(stress, statev, ddsdde)', '  real(8) :: stress(6), statev(*), ddsdde(6, 6)', &
      '  integer :: i', &
      '  ddsdde = 0', '  do i = 1, 6', '    ddsdde(i, i) = 5', '  end do', '  stress = 0', 'end subroutine umat'
    close (unit)
    call make_model(model)
    model%materials = [model%materials, model%materials]
    model%materials%is_user = .true.
    model%materials(1)%props = [1.0_DP]
    model%materials(2)%props = [1.0_DP]
    model%materials(1)%library = 'test_setup_umat.f90'
    model%materials(2)%library = 'test_setup_umat.f90'
    model%materials%is_called_in_3d = .true.
    call execute_command_line('mkdir -p test_setup_folder && cp test_setup_umat.f90 test_setup_folder/test_setup_beside.f90')
    model%materials(1)%library = 'test_setup_beside.f90'
    model%materials(2)%library = 'test_setup_beside.f90'
    options%deck = 'test_setup_folder/somewhere.inp'
    call expect('library beside the deck', model, 0, '')
    model%materials(1)%library = 'test_setup_umat.f90'
    model%materials(2)%library = 'test_setup_umat.f90'
    options%deck = 'no/such/folder/somewhere.inp'
    call expect('library in the working folder', model, 0, '')
    model%materials(2)%library = 'test_setup_none.f90'
    call expect('no such library', model, EXIT_IO, 'test_setup_none.f90')
    model%materials(2)%library = 'test_setup_umat.f90'
    model%has_sdvini = .true.
    model%materials(2)%n_statev = 1
    call expect('SDVINI', model, EXIT_SETUP, 'needs the user routine SDVINI, which is not in test_setup_umat.f90')
    deallocate (options%deck)
    call make_model(model)
    options%user = 'test_setup_umat.f90'
    model%interactions(1)%is_user_friction = .true.
    call expect('FRIC', model, EXIT_SETUP, '*FRICTION, USER needs the user routine FRIC, which is not in')
    deallocate (options%user)
  end subroutine check_library


  !> UAMP is called before the first increment, then at the end of each attempt from the memory of the last increment.
  subroutine check_amplitudes()
    type(model_type) :: model
    type(state_type) :: state
    type(amplitude_type), allocatable :: amplitudes(:)
    type(error_type), allocatable :: error
    type(logger_type) :: logger
    real(DP) :: pnewdt
    call make_model(model)
    options%user = PATH
    model%amplitudes(1)%is_user = .true.
    model%amplitudes(1)%name = 'RAMP'
    model%amplitudes(1)%props = [3.0_DP]
    model%amplitudes(1)%n_svars = 1
    allocate (amplitudes(3))
    amplitudes(1)%time = [0.0_DP]                    ! a table, which keeps its values
    amplitudes(1)%factor = [7.0_DP]
    amplitudes(2) = model%amplitudes(1)
    amplitudes(3) = model%amplitudes(1)
    call open_user_routines(model, options, error)
    call suite%that('opened', .not. allocated(error))
    state%old%user_memory = [0.5_DP, 10.0_DP, 1.5_DP, 20.0_DP]
    state%new%user_memory = [0.5_DP, 10.0_DP, 1.5_DP, 20.0_DP]
    state%old%increment = 0
    state%new%total_time = 2.0_DP
    call update_user_amplitudes(model, amplitudes, state)
    call suite%near('first: two calls, 0.5 + 0, then + 3 t', amplitude_value(amplitudes(2), 2.0_DP), 6.5_DP, 0.0_DP)
    call suite%near('first: counted twice', state%new%user_memory(2), 12.0_DP, 0.0_DP)
    call suite%near('first: the other amplitude has its own memory', abs(amplitude_value(amplitudes(3), 2.0_DP) - 7.5_DP) + &
      abs(state%new%user_memory(4) - 22), 0.0_DP, 0.0_DP)
    call suite%near('the table', amplitude_value(amplitudes(1), 2.0_DP), 7.0_DP, 0.0_DP)
    state%old = state%new
    state%old%increment = 1
    state%new%total_time = 3.0_DP
    call update_user_amplitudes(model, amplitudes, state)
    call suite%near('next: old value + 3 t', amplitude_value(amplitudes(2), 3.0_DP), 15.5_DP, 0.0_DP)
    call suite%near('next: counted once', state%new%user_memory(2), 13.0_DP, 0.0_DP)
    call restore_user_amplitudes(amplitudes, state%old)
    call suite%near('restored', amplitude_value(amplitudes(2), 3.0_DP), 6.5_DP, 0.0_DP)
    pnewdt = 0.5_DP
    call handle_user_messages(model, logger, pnewdt, error)
    call suite%that('no messages', .not. allocated(error) .and. abs(pnewdt - 0.5_DP) <= 0)
    amplitudes(2)%name = 'OTHER'
    call update_user_amplitudes(model, amplitudes, state)
    call handle_user_messages(model, logger, pnewdt, error)
    call suite%that('XIT', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_NOT_CONVERGED .and. index(error%message, 'XIT') > 0)
    call close_user_routines(model)
    call suite%that('closed', .not. has_routine(model%routines, ROUTINE_UAMP) .and. &
      .not. has_routine(model%materials(1)%routines, ROUTINE_UMAT))
  end subroutine check_amplitudes

end program test_user_routine_setup
