!> Main program: command line, the three stages of a job, and the exit code; the only module that stops the process.
!! SPDX-License-Identifier: GPL-3.0-or-later
program amontons
  use amontons_errors, only: error_type, set_error, EXIT_SUCCESS, EXIT_USAGE, EXIT_IO
  use amontons_posix, only: restart_with_settings, return_large_blocks, set_exit_handler, end_process, install_signal_handlers
  use amontons_version, only: VERSION, DESCRIPTION
  use amontons_logger, only: logger_type, open_logger, PROGRESS_AUTO, PROGRESS_PLAIN, PROGRESS_NONE
  use amontons_model, only: model_type, job_options_type, MAX_PARTITIONS, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_card_table, only: list_cards
  use amontons_deck, only: explain_deck
  use amontons_model_setup, only: add_general_contact
  use amontons_job_estimate, only: estimate_job, job_estimate_type, describe_estimate
  use amontons_analysis, only: analysis_type, start_analysis, advance_analysis, finish_analysis
  use amontons_mpi_ranks, only: begin_ranks, end_ranks, n_ranks, is_first_rank, is_shared_by_ranks, abort_ranks
  implicit none

  character(*), parameter :: USAGE = 'usage: amontons [options] job[.inp]    (a deck of Abaqus or CalculiX; ' // &
    'amontons --help lists the options)'

  integer, parameter :: ACTION_RUN = 0, ACTION_HELP = 1, ACTION_VERSION = 2, ACTION_CARDS = 3, ACTION_EXPLAIN = 4, &
    ACTION_ESTIMATE = 5

  !> Options of the command line.
  type :: command_type
    integer :: action = ACTION_RUN
    integer :: progress = PROGRESS_AUTO
    logical :: is_quiet = .false.
    type(job_options_type) :: job
  end type command_type

  call run_command()

contains

  !> From the command line to the exit code.
  subroutine run_command()
    type(command_type) :: command
    type(logger_type) :: logger
    type(error_type), allocatable :: error
    type(model_type) :: model
    character(:), allocatable :: cards
    call restart_with_settings()                     ! before MPI begins
    call set_exit_handler(.true.)
    call return_large_blocks()
    call begin_ranks()
    call open_log(logger, .false., PROGRESS_NONE)
    call read_command(command, error)
    if (.not. allocated(error)) then
      if (n_ranks() > 1) then                        ! mpiexec mixes what the ranks write: no live line
        command%job%n_threads = max(1, command%job%n_threads)
        if (command%progress == PROGRESS_AUTO) command%progress = PROGRESS_PLAIN
      end if
      select case (command%action)
      case (ACTION_HELP)
        call print_help(logger)
      case (ACTION_VERSION)
        call logger%say('Amontons ' // VERSION)
      case (ACTION_CARDS)
        call list_cards(cards)
        call logger%say(cards)
      case (ACTION_EXPLAIN)
        call explain_deck(command%job, model, cards, error)
        call logger%say(cards)
        if (.not. allocated(error)) call add_general_contact(model, logger, error)
      case (ACTION_ESTIMATE)
        call print_estimate(command%job, logger, error)
      case default
        call open_log(logger, command%is_quiet, command%progress)
        call run_job(command%job, logger, error)
      end select
    end if
    call set_exit_handler(.false.)
    if (allocated(error)) call end_alone(error)
    if (allocated(error)) call logger%fail(error%message)
    call end_ranks()
    if (.not. allocated(error)) stop EXIT_SUCCESS, quiet=.true.
    call end_process(error%code)
  end subroutine run_command


  !> The log of this rank: only the first one writes.
  subroutine open_log(logger, is_quiet, progress)
    type(logger_type), intent(out) :: logger
    logical, intent(in) :: is_quiet
    integer, intent(in) :: progress
    integer :: unit
    if (is_first_rank()) then
      call open_logger(logger, is_quiet, progress)
    else
      open (newunit=unit, file='/dev/null', action='write')
      call open_logger(logger, .true., PROGRESS_NONE, unit=unit)
    end if
  end subroutine open_log


  !> An error that the other ranks do not share is reported here and ends all; they wait for this rank somewhere.
  subroutine end_alone(error)
    type(error_type), intent(in) :: error
    type(logger_type) :: logger
    if (is_shared_by_ranks()) return
    call set_exit_handler(.false.)
    call open_logger(logger, .true., PROGRESS_NONE)
    call logger%fail(error%message)
    call abort_ranks(error%code)
  end subroutine end_alone


  !> Start, advance and finish. A job that fails is finished too: converged increments are on disk.
  subroutine run_job(options, logger, error)
    type(job_options_type), intent(in) :: options
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(analysis_type) :: analysis
    type(error_type), allocatable :: last_error
    logical :: is_done
    call install_signal_handlers()
    call start_analysis(analysis, options, logger, error)
    if (allocated(error) .or. .not. analysis%is_open) return   ! --check, NO ANALYSIS
    is_done = .false.
    do while (.not. (is_done .or. allocated(error)))
      call advance_analysis(analysis, logger, is_done, error)
    end do
    if (allocated(error)) call end_alone(error)
    call finish_analysis(analysis, logger, last_error)
    if (.not. allocated(error)) call move_alloc(last_error, error)
  end subroutine run_job


  !> --estimate: on one thread, so that processor time is that of the work.
  subroutine print_estimate(options, logger, error)
    type(job_options_type), intent(inout) :: options
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(job_estimate_type) :: estimate
    if (n_ranks() > 1) then
      call set_usage_error(error, '--estimate runs with one rank.')
      return
    end if
    options%n_threads = 1
    call estimate_job(options, logger, estimate, error)
    if (.not. allocated(error)) call logger%say(describe_estimate(estimate, options%job // '.inp'))
  end subroutine print_estimate


  !> Reads the command line from left to right; --help, --version and --cards end it.
  subroutine read_command(command, error)
    type(command_type), intent(out) :: command
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    command%job%n_threads = 0
    command%job%is_guarded = .true.
    command%job%handles_signals = .true.
    i = 1
    do while (i <= command_argument_count() .and. any(command%action == [ACTION_RUN, ACTION_EXPLAIN, ACTION_ESTIMATE]))
      call read_option(command, i, error)
      if (allocated(error)) return
    end do
    if (any(command%action == [ACTION_RUN, ACTION_EXPLAIN, ACTION_ESTIMATE])) call find_deck(command%job, error)
  end subroutine read_command


  !> Reads one option with its value, or the name of the job. A value follows = or is the next word.
  subroutine read_option(command, i, error)
    type(command_type), intent(inout) :: command
    integer, intent(inout) :: i                !< number of the word; out: that of the next one
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: word, name, value
    integer :: equals
    word = argument(i)
    i = i + 1
    name = word
    value = ''
    equals = index(word, '=')
    if (equals > 0 .and. any(word(:max(1, equals - 1)) == ['user       ', 'job        ', 'oldjob     ', &
      'globalmodel'])) then
      name = '--' // word(:equals - 1)
      if (word(:equals - 1) == 'globalmodel') name = '--global'
      value = word(equals + 1:)
    else if (index(word, '--') == 1 .and. equals > 0) then
      name = word(:equals - 1)
      value = word(equals + 1:)
    else if (is_with_value(word)) then
      value = argument(i)
      i = i + 1
    end if
    if (is_with_value(name) .eqv. len(value) == 0) then
      if (len(value) == 0) call set_usage_error(error, 'The option ' // name // ' needs a value.')
      if (equals > 0) call set_usage_error(error, 'The option ' // name // ' takes no value.')
      if (allocated(error)) return
    end if
    call apply_option(command, name, value, error)
  end subroutine read_option


  !> Whether an option is followed by a value.
  pure function is_with_value(name) result(is_true)
    character(*), intent(in) :: name
    logical :: is_true
    is_true = any(name == [character(12) :: '-i', '--job', '--threads', '--progress', '--dialect', '--outdir', '--user', &
      '--oldjob', '--partitions', '--global'])
  end function is_with_value


  !> Applies an option.
  subroutine apply_option(command, name, value, error)
    type(command_type), intent(inout) :: command
    character(*), intent(in) :: name, value
    type(error_type), allocatable, intent(out) :: error
    select case (name)
    case ('--help', '-h')
      command%action = ACTION_HELP
    case ('--version', '-v')
      command%action = ACTION_VERSION
    case ('--cards')
      command%action = ACTION_CARDS
    case ('--explain')
      command%action = ACTION_EXPLAIN
    case ('--estimate')
      command%action = ACTION_ESTIMATE
    case ('--check')
      command%job%is_check = .true.
    case ('--resume')
      command%job%is_resumed = .true.
    case ('--no-checkpoint')
      command%job%is_guarded = .false.
    case ('--frd')
      command%job%has_frd = .true.
    case ('--quiet')
      command%is_quiet = .true.
    case ('--threads')
      call set_threads(command%job, value, error)
    case ('--partitions')
      call set_partitions(command%job, value, error)
    case ('--progress')
      call set_progress(command, value, error)
    case ('--dialect')
      call set_dialect(command%job, value, error)
    case ('--outdir')
      command%job%outdir = value
    case ('--user')
      command%job%user = value
    case ('--oldjob')
      command%job%old_job = value
    case ('--global')
      command%job%global_results = value
    case ('-i', '--job')
      call set_job(command%job, value, error)
    case default
      if (index(name, '-') == 1) then
        call set_usage_error(error, 'There is no option ' // name // '.')
      else
        call set_job(command%job, name, error)
      end if
    end select
  end subroutine apply_option


  !> --threads N
  subroutine set_threads(options, value, error)
    type(job_options_type), intent(inout) :: options
    character(*), intent(in) :: value
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    status = verify(value, '0123456789')
    if (status == 0) read (value, *, iostat=status) options%n_threads
    if (status /= 0 .or. options%n_threads < 1) then
      call set_usage_error(error, 'The number of threads is "' // value // '"; it must be 1 or more.')
    end if
  end subroutine set_threads


  !> --partitions G
  subroutine set_partitions(options, value, error)
    type(job_options_type), intent(inout) :: options
    character(*), intent(in) :: value
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    status = verify(value, '0123456789')
    if (status == 0) read (value, *, iostat=status) options%n_partitions
    if (status /= 0 .or. options%n_partitions < 1 .or. options%n_partitions > MAX_PARTITIONS) call set_usage_error(error, &
      'The number of partitions is "' // value // '"; it can be 1 to 9999.')
  end subroutine set_partitions


  !> --progress=auto|plain|none
  subroutine set_progress(command, value, error)
    type(command_type), intent(inout) :: command
    character(*), intent(in) :: value
    type(error_type), allocatable, intent(out) :: error
    select case (value)
    case ('auto')
      command%progress = PROGRESS_AUTO
    case ('plain')
      command%progress = PROGRESS_PLAIN
    case ('none')
      command%progress = PROGRESS_NONE
    case default
      call set_usage_error(error, 'The progress is "' // value // '"; it can be auto, plain or none.')
    end select
  end subroutine set_progress


  !> --dialect=abaqus|calculix
  subroutine set_dialect(options, value, error)
    type(job_options_type), intent(inout) :: options
    character(*), intent(in) :: value
    type(error_type), allocatable, intent(out) :: error
    select case (value)
    case ('abaqus')
      options%dialect = DIALECT_ABAQUS
    case ('calculix')
      options%dialect = DIALECT_CALCULIX
    case default
      call set_usage_error(error, 'The dialect is "' // value // '"; it can be abaqus or calculix.')
    end select
  end subroutine set_dialect


  !> Sets the job: the only word that is not an option.
  subroutine set_job(options, value, error)
    type(job_options_type), intent(inout) :: options
    character(*), intent(in) :: value
    type(error_type), allocatable, intent(out) :: error
    if (allocated(options%deck)) then
      call set_usage_error(error, 'Two jobs are named, ' // options%deck // ' and ' // value // '; one at a time can run.')
    else
      options%deck = value
    end if
  end subroutine set_job


  !> Finds the deck, the name of the job and the folder of the results (default: that of the deck).
  subroutine find_deck(options, error)
    type(job_options_type), intent(inout) :: options
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: folder
    logical :: is_there
    if (.not. allocated(options%deck)) then
      call set_usage_error(error, 'No job is named.')
      return
    end if
    if (.not. is_inp(options%deck)) options%deck = options%deck // '.inp'
    inquire (file=options%deck, exist=is_there)
    if (.not. is_there) then
      call set_error(error, EXIT_IO, 'There is no file ' // options%deck // '.')
      return
    end if
    call split_path(options%deck, folder, options%job)
    if (.not. allocated(options%outdir)) options%outdir = folder
    inquire (file=options%outdir // '/.', exist=is_there)
    if (.not. is_there) call set_error(error, EXIT_IO, 'There is no folder ' // options%outdir // ' for the results.')
  end subroutine find_deck


  !> Folder and name of a deck, without .inp.
  pure subroutine split_path(deck, folder, job)
    character(*), intent(in) :: deck
    character(:), allocatable, intent(out) :: folder, job
    integer :: slash
    slash = index(deck, '/', back=.true.)
    job = deck(slash + 1:len(deck) - len('.inp'))
    folder = '.'
    if (slash == 1) folder = '/'
    if (slash > 1) folder = deck(:slash - 1)
  end subroutine split_path


  !> Whether a name ends with .inp, in any case.
  pure function is_inp(name) result(is_true)
    character(*), intent(in) :: name
    logical :: is_true
    is_true = .false.
    if (len(name) > 4) is_true = any(name(len(name) - 3:) == ['.inp', '.INP', '.Inp'])
  end function is_inp


  !> Sets an error with a sentence and the usage line.
  subroutine set_usage_error(error, sentence)
    type(error_type), allocatable, intent(out) :: error
    character(*), intent(in) :: sentence
    call set_error(error, EXIT_USAGE, sentence // new_line('a') // USAGE)
  end subroutine set_usage_error


  !> The i-th word of the command line; empty beyond the last.
  function argument(i) result(word)
    integer, intent(in) :: i
    character(:), allocatable :: word
    integer :: length
    call get_command_argument(i, length=length)
    allocate (character(length) :: word)
    if (length > 0) call get_command_argument(i, value=word)
  end function argument


  !> Prints the help text.
  subroutine print_help(logger)
    type(logger_type), intent(inout) :: logger
    character(*), parameter :: TEXT(*) = [character(112) :: &
      'Amontons ' // VERSION // ': ' // DESCRIPTION // '.', &
      '', &
      USAGE, &
      '       amontons [options] -i job    (or --job=job)', &
      '', &
      'The deck job.inp is written with the cards of Abaqus or CalculiX; amontons --cards lists those known.', &
      '', &
      '  --explain                    list card by card what is used, has no effect or is refused, with the numbers', &
      '                               taken, then stop', &
      '  --estimate                   print unknowns, memory, processor time and the chosen solver, then stop', &
      '  --check                      read the deck, check the model, then stop', &
      '  --resume                     continue a job that was stopped, from its checkpoint job.restart', &
      '  --no-checkpoint              write no checkpoint', &
      '  --threads N                  work with N threads (default: OMP_NUM_THREADS, else all processors;', &
      '                               one for a small model)', &
      '  --outdir DIR                 folder of the result files (default: the folder of the deck)', &
      '  --dialect=abaqus|calculix    what a card means where the two differ (default: abaqus, or what a line', &
      '                               "** dialect: calculix" in the first comments of the deck says)', &
      '  --partitions G               divide the grid and the fields of job.vtkhdf into G files, which the ranks of', &
      '                               amontons-mpi share; job.vtkhdf ties them', &
      '  --frd                        write all fields to job.frd too, for CGX, PrePoMax and the like (under the', &
      '                               calculix dialect the FILE cards of the deck request it)', &
      '  --user FILE, user=FILE       user routines (UMAT, ...): a Fortran file, which gfortran compiles, or a', &
      '                               shared library', &
      '  --oldjob NAME, oldjob=NAME   the job whose restart file NAME.res a deck with *RESTART, READ continues from', &
      '  --global FILE, globalmodel=FILE   results of the global model of a deck with *SUBMODEL: .vtkhdf or .frd', &
      '  --progress=auto|plain|none   a line per increment; auto adds a live line on a terminal', &
      '  --quiet                      write nothing but failures', &
      '  --cards                      list the cards', &
      '  --version                    print the version', &
      '  --help                       print this text', &
      '', &
      'Results: job.vtkhdf (for ParaView), job.dat (PRINT cards), job.frd (if requested), job.sta and job.cvg (what', &
      'each increment and iteration cost), and until the job is done job.restart, the checkpoint of the last converged', &
      'increment.', &
      'SIGINT and SIGTERM end a job after the iteration that runs (exit code 5); SIGUSR1 requests a status line.', &
      '', &
      'Exit codes: 0 done, 2 wrong usage, 3 errors in the deck, 4 the model check found errors, 5 not converged (all', &
      'converged increments are on disk), 6 linear solver or memory, 7 reading or writing a file, 8 an internal', &
      'error of Amontons.']
    integer :: i
    do i = 1, size(TEXT)
      call logger%say(trim(TEXT(i)))
    end do
  end subroutine print_help

end program amontons
