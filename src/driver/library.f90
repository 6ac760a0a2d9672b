!> The Fortran API: open, solve, commit or roll back, get and set values by name.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! c_interface.f90 and amontons.h provide the same procedures for C. Manual: doc/manual/library.md.
!!
!! Solution starts from the last commit. `try_job` and `iterate_job` solve without a commit: the caller can inspect their
!! result, then keep it (`commit_job`) or discard it (`rollback_job`). `advance_job` solves and commits. The library prints nothing
!! without a log_sink, never stops the program, and has no data outside the job.
!!
!! A job on several ranks is opened with a communicator. Then all ranks call the same procedures with the same arguments, and get
!! the same values and errors; the first rank has the log and writes the files.
module amontons_library
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_USAGE, EXIT_DECK, EXIT_NOT_CONVERGED
  use amontons_text, only: name_key, to_text, NEWLINE
  use amontons_posix, only: process_lock_type, acquire_lock, checksum_of_words
  use amontons_mpi_ranks, only: join_ranks, leave_ranks, n_ranks, is_first_rank, check_agreement, is_shared_by_ranks
  use amontons_logger, only: logger_type, log_sink_type, open_logger, PROGRESS_PLAIN
  use amontons_model, only: job_options_type, MAX_PARTITIONS
  use amontons_increment_control, only: propose_increment
  use amontons_convergence, only: VERDICT_CONTINUE, VERDICT_CONVERGED
  use amontons_unsymmetric_tangent, only: combine_with_skew
  use amontons_sparse, only: sparse_type, full_from_upper, multiply_transpose
  use amontons_state, only: state_type
  use amontons_friction_slip_scenarios, only: classify_slip_scenarios, friction_limit, slip_state_type, slip_controls_type, &
    slip_result_type, &
    STATUS_OPEN, STATUS_STICK, STATUS_SLIP, STATUS_BALANCED, STATUS_OPENS, STATUS_CLOSES, NO_FRICTION_LIMIT
  use amontons_user_routine_setup, only: close_user_routines
  use amontons_assembly, only: share_points
  use amontons_equilibrium, only: evaluate_equilibrium, undivide_matrix, OUTCOME_OK
  use amontons_newton_step, only: linearize_equilibrium
  use amontons_tangent_solution, only: assemble_tangent_matrix
  use amontons_analysis, only: analysis_type, start_analysis, advance_analysis, finish_analysis, solve_increment, &
    enter_step, begin_trial, iterate_trial, commit_analysis, rollback_analysis, is_at_end, use_threads
  use amontons_driven_loads, only: activate_driven, finish_driven
  use amontons_job_query, only: query_values, set_driven_values, query_names, current_step, time_in_step, time_left_in_step
  implicit none
  private
  public :: job_type, job_options_type, log_sink_type, error_type, sparse_type
  public :: open_job, advance_job, advance_job_to, try_job, begin_job, iterate_job, commit_job, rollback_job, finish_job, close_job
  public :: is_job_done, get_values, set_values, get_names, get_matrix, VERDICT_CONTINUE, VERDICT_CONVERGED
  ! For the nodes of a program with its own solver: no job needed.
  public :: classify_slip_scenarios, friction_limit, slip_state_type, slip_controls_type, slip_result_type
  public :: STATUS_OPEN, STATUS_STICK, STATUS_SLIP, STATUS_BALANCED, STATUS_OPENS, STATUS_CLOSES, NO_FRICTION_LIMIT

  real(DP), parameter :: TOL_TIME = 1.0e-9_DP          !< difference of equal times, over the step's period [-]

  !> A job with all its data.
  type :: job_type
    private
    type(analysis_type) :: analysis
    type(logger_type) :: logger
    logical :: is_ready = .false.                  !< started and not finished
    logical :: is_begun = .false.                  !< the attempt started by begin_job has not ended
    logical :: is_joined = .false.                 !< it has the ranks of the process, and leaves them when it is closed
  end type job_type

  !> Log sink that discards its lines.
  type, extends(log_sink_type) :: null_sink_type
  contains
    procedure :: write_lines => discard_line
  end type null_sink_type

contains

  !> Starts a job from options%deck (a file) or options%deck_text (memory).
  !!
  !! Errors: EXIT_USAGE, EXIT_DECK (the message contains all errors of the deck), EXIT_SETUP, EXIT_IO, EXIT_SOLVER.
  subroutine open_job(job, options, error, log_sink, communicator)
    type(job_type), intent(inout) :: job
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    class(log_sink_type), intent(in), target, optional :: log_sink   !< receives the log; `target` as it may point
    integer, intent(in), optional :: communicator  !< of MPI, a Fortran handle: all its ranks open the job (libamontons-mpi)
    type(job_options_type) :: whole
    logical :: is_heard
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    whole = options
    if (.not. allocated(whole%deck) .and. .not. allocated(whole%deck_text)) then
      call set_error(error, EXIT_USAGE, 'A job needs a deck: a file or a text.')
      return
    end if
    if (whole%n_partitions < 0 .or. whole%n_partitions > MAX_PARTITIONS) then
      call set_error(error, EXIT_USAGE, 'The number of partitions is ' // to_text(whole%n_partitions) // '; it can be 1 to ' // &
        to_text(MAX_PARTITIONS) // ', or 0: one file has all.')
      return
    end if
    call join_ranks(error, communicator)
    if (allocated(error)) return
    job%is_joined = .true.
    if (.not. allocated(whole%job)) call derive_job_name(whole)
    is_heard = present(log_sink)
    if (is_heard) is_heard = is_first_rank()
    if (is_heard) then
      call open_logger(job%logger, .false., PROGRESS_PLAIN, log_sink=log_sink)
    else
      call open_logger(job%logger, .true., PROGRESS_PLAIN, log_sink=null_sink_type())
    end if
    call start_analysis(job%analysis, whole, job%logger, error)
    job%is_ready = .not. (allocated(error) .or. job%analysis%options%is_check)
    if (.not. allocated(error)) return
    call append_deck_errors(job, error)
    call report_alone(error)
    job%is_joined = .false.
    call leave_ranks()
  end subroutine open_job


  !> Says so in an error that the other ranks of the job do not share: they wait somewhere without end.
  subroutine report_alone(error)
    type(error_type), allocatable, intent(inout) :: error
    if (.not. allocated(error)) return
    if (n_ranks() == 1) return
    if (.not. is_shared_by_ranks()) error%message = error%message // ' The other ranks do not have this error and wait: end ' // &
      'the processes of all (MPI_Abort).'
  end subroutine report_alone


  !> Derives name and result folder of the job from its deck.
  subroutine derive_job_name(options)
    type(job_options_type), intent(inout) :: options
    options%job = 'job'
    if (.not. allocated(options%deck)) return
    if (.not. allocated(options%outdir)) options%outdir = folder_of(options%deck)
    options%job = name_of(options%deck)
  end subroutine derive_job_name


  !> The folder of a path.
  pure function folder_of(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder
    integer :: slash
    slash = index(path, '/', back=.true.)
    folder = '.'
    if (slash > 0) folder = path(:max(1, slash - 1))
  end function folder_of


  !> The name of a path without its folder and .inp.
  pure function name_of(path) result(name)
    character(*), intent(in) :: path
    character(:), allocatable :: name
    integer :: first, last
    first = index(path, '/', back=.true.) + 1
    last = len(path)
    if (last > first + 3) then
      if (name_key(path(last - 3:)) == '.INP') last = last - 4
    end if
    name = path(first:last)
    if (last < first) name = 'job'
  end function name_of


  !> Appends the errors of a deck to the message, one per line.
  subroutine append_deck_errors(job, error)
    type(job_type), intent(in) :: job
    type(error_type), allocatable, intent(inout) :: error
    integer :: i
    if (error%code /= EXIT_DECK) return
    do i = 1, job%analysis%diagnostics%n_items
      associate (item => job%analysis%diagnostics%items(i))
        if (item%is_warning) cycle
        error%message = error%message // NEWLINE // item%file // ':' // to_text(item%line) // ': ' // item%text
      end associate
    end do
  end subroutine append_deck_errors


  !> Solves and commits one increment of the length given by increment control. is_job_done reports the end.
  subroutine advance_job(job, error)
    type(job_type), intent(inout) :: job
    type(error_type), allocatable, intent(out) :: error
    logical :: is_done
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    call check_ready(job, .false., error)
    if (allocated(error)) return
    call activate_targets(job, next_length(job))
    call advance_analysis(job%analysis, job%logger, is_done, error)
    call report_alone(error)
    call finish_commit(job, error)
  end subroutine advance_job


  !> Solves increments until a total time, each committed; the last one ends there. Steps may end before.
  subroutine advance_job_to(job, total_time, error)
    type(job_type), intent(inout) :: job
    real(DP), intent(in) :: total_time             !< [time]
    type(error_type), allocatable, intent(out) :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (.not. abs(total_time) <= huge(1.0_DP)) then
      call set_error(error, EXIT_USAGE, 'The time to advance to is not a finite number.')
      return
    end if
    call check_agreement([total_time], 'times to advance to', error)
    if (allocated(error)) return
    do while (.not. is_job_done(job))
      if (total_time - job%analysis%stepping%total_time <= TOL_TIME * max(abs(total_time), time_left_in_step(job%analysis))) exit
      call check_ready(job, .false., error)
      if (allocated(error)) return
      call activate_targets(job, total_time - job%analysis%stepping%total_time)
      call solve_increment(job%analysis, job%logger, end_in_step(job, total_time - job%analysis%stepping%total_time), error)
      if (.not. allocated(error)) call commit_analysis(job%analysis, job%logger, error)
      call report_alone(error)
      call finish_commit(job, error)
      if (allocated(error)) return
    end do
  end subroutine advance_job_to


  !> Solves to the current time + dt, or to the end of the step if that is earlier, without a commit; by several shorter
  !! increments if one does not converge. After an error the job is at its last commit.
  subroutine try_job(job, dt, error)
    type(job_type), intent(inout) :: job
    real(DP), intent(in) :: dt                     !< [time]
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: end_time
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    call check_ready(job, .true., error)
    if (.not. allocated(error)) call check_increment(job, dt, error)
    if (allocated(error)) return
    end_time = end_in_step(job, dt)
    associate (analysis => job%analysis)
      call enter_step(analysis, error)
      analysis%stepping%dt = end_time - time_in_step(job%analysis)
      call activate_targets(job, analysis%stepping%dt)
      do while (.not. allocated(error))
        call solve_increment(analysis, job%logger, end_time, error)
        if (analysis%is_step_start .or. end_time - analysis%stepping%step_time <= TOL_TIME * end_time) exit
        call activate_targets(job, end_time - analysis%stepping%step_time)
      end do
    end associate
    call report_alone(error)
    if (allocated(error)) call rollback_after_error(job)
  end subroutine try_job


  !> Starts an increment of length dt, to be solved iteration by iteration with iterate_job.
  subroutine begin_job(job, dt, error)
    type(job_type), intent(inout) :: job
    real(DP), intent(in) :: dt                     !< [time]; cut off at the end of the step
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: length
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    call check_ready(job, .true., error)
    if (.not. allocated(error)) call check_increment(job, dt, error)
    if (allocated(error)) return
    length = end_in_step(job, dt) - time_in_step(job%analysis)
    call activate_targets(job, length)
    call begin_trial(job%analysis, length, error)
    call report_alone(error)
    job%is_begun = .not. allocated(error)
  end subroutine begin_job


  !> One Newton iteration. Afterwards: VERDICT_CONVERGED: commit or roll back; VERDICT_CONTINUE: iterate; else: roll back.
  subroutine iterate_job(job, verdict, error)
    type(job_type), intent(inout) :: job
    integer, intent(out) :: verdict                !< VERDICT_...
    type(error_type), allocatable, intent(out) :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    verdict = VERDICT_CONTINUE
    if (.not. job%is_begun) then
      call set_error(error, EXIT_USAGE, 'There is no increment to iterate: begin one first.')
      return
    end if
    call use_threads(job%analysis%options%n_threads)
    call iterate_trial(job%analysis, job%logger, verdict, error)
    call report_alone(error)
    if (.not. allocated(error)) call share_points(job%analysis%system%assembly, job%analysis%model%mesh, job%analysis%state%new)
    if (allocated(error)) call rollback_after_error(job)
    if (verdict /= VERDICT_CONTINUE) job%is_begun = .false.
  end subroutine iterate_job


  !> Commits the increments solved since the last commit, and writes them.
  subroutine commit_job(job, error)
    type(job_type), intent(inout) :: job
    type(error_type), allocatable, intent(out) :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (.not. job%is_ready) then
      call set_error(error, EXIT_USAGE, 'The job has not begun or is finished.')
      return
    end if
    if (job%analysis%n_records > job%analysis%n_committed) then
      if (job%is_begun .or. .not. job%analysis%records(job%analysis%n_records)%is_converged) then
        call set_error(error, EXIT_USAGE, 'An increment that has not converged cannot be committed; iterate on or roll back.')
        return
      end if
    end if
    call commit_analysis(job%analysis, job%logger, error)
    call report_alone(error)
    call finish_driven(job%analysis%driven_loads)
  end subroutine commit_job


  !> Restores the last commit bitwise: displacements, stresses, contact, time. Values that were set remain set.
  subroutine rollback_job(job, error)
    type(job_type), intent(inout) :: job
    type(error_type), allocatable, intent(out) :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    job%is_begun = .false.
    if (job%is_ready) call rollback_analysis(job%analysis, error)
  end subroutine rollback_job


  !> Closes the files. Queries of values remain possible.
  subroutine finish_job(job, error)
    type(job_type), intent(inout) :: job
    type(error_type), allocatable, intent(out) :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    job%is_ready = .false.
    job%is_begun = .false.
    call finish_analysis(job%analysis, job%logger, error)
    call report_alone(error)
  end subroutine finish_job


  !> Finishes a job and closes all its resources; no call may follow.
  subroutine close_job(job, error)
    type(job_type), intent(inout) :: job
    type(error_type), allocatable, intent(out) :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    call finish_job(job, error)
    call close_user_routines(job%analysis%model)
    if (.not. job%is_joined) return
    job%is_joined = .false.
    call leave_ranks()
  end subroutine close_job


  !> Whether all steps are done.
  pure logical function is_job_done(job)
    type(job_type), intent(in) :: job
    is_job_done = .true.
    if (job%is_ready) is_job_done = is_at_end(job%analysis)
  end function is_job_done


  !> Checks the preconditions of all solving procedures.
  subroutine check_ready(job, is_trial, error)
    type(job_type), intent(inout) :: job
    logical, intent(in) :: is_trial
    type(error_type), allocatable, intent(out) :: error
    if (.not. job%is_ready) then
      call set_error(error, EXIT_USAGE, 'The job has not begun or is finished.')
    else if (job%is_begun) then
      call set_error(error, EXIT_USAGE, 'An increment is being iterated; roll it back or iterate on.')
    else if (is_at_end(job%analysis)) then
      call set_error(error, EXIT_USAGE, 'All steps of the job are done.')
    end if
    job%analysis%is_trial = is_trial
    call use_threads(job%analysis%options%n_threads)
  end subroutine check_ready


  !> Checks a time increment: positive, and not negligible relative to the period of the step; the same on all ranks.
  !! Errors: EXIT_USAGE.
  subroutine check_increment(job, dt, error)
    type(job_type), intent(in) :: job
    real(DP), intent(in) :: dt                     !< [time]
    type(error_type), allocatable, intent(inout) :: error
    call check_agreement([dt], 'time steps', error)
    if (allocated(error)) return
    if (.not. dt >= TOL_TIME * job%analysis%model%steps(current_step(job%analysis))%period) call set_error(error, EXIT_USAGE, &
      'A time step must be positive, and at least 1e-9 of the period of the step.')
  end subroutine check_increment


  !> After an error: restores the last commit.
  subroutine rollback_after_error(job)
    type(job_type), intent(inout) :: job
    type(error_type), allocatable :: second
    call rollback_job(job, second)
  end subroutine rollback_after_error


  !> End of a procedure that commits.
  subroutine finish_commit(job, error)
    type(job_type), intent(inout) :: job
    type(error_type), allocatable, intent(in) :: error
    if (allocated(error)) then
      if (error%code == EXIT_NOT_CONVERGED) call rollback_after_error(job)
    else
      call finish_driven(job%analysis%driven_loads)
    end if
  end subroutine finish_commit


  !> Starts the amplitudes of values that were set; they reach their targets after a length of time.
  subroutine activate_targets(job, length)
    type(job_type), intent(inout) :: job
    real(DP), intent(in) :: length                 !< [time]
    associate (now => job%analysis%stepping%total_time)
      call activate_driven(job%analysis%driven_loads, now, now + length)
    end associate
  end subroutine activate_targets


  !> Step time after a length of time; times within TOL_TIME of the end of the step, or beyond, become its end [time].
  pure real(DP) function end_in_step(job, length) result(time)
    type(job_type), intent(in) :: job
    real(DP), intent(in) :: length                 !< [time]
    associate (step => job%analysis%model%steps(current_step(job%analysis)), &
      period => job%analysis%model%steps(current_step(job%analysis))%period)
      time = time_in_step(job%analysis) + length
      if (step%is_riks) return                     ! the path ends elsewhere
      if (time >= period * (1.0_DP - TOL_TIME)) time = period
    end associate
  end function end_in_step


  !> Length of the increment that increment control will propose [time].
  pure real(DP) function next_length(job) result(length)
    type(job_type), intent(in) :: job
    associate (step => job%analysis%model%steps(current_step(job%analysis)))
      if (job%analysis%is_step_start) then
        length = min(step%dt_initial, step%period)
      else
        length = propose_increment(job%analysis%stepping, step)
      end if
    end associate
  end function next_length


  !> A quantity by name, one column per row of the set. The names are in doc/manual/library.md.
  subroutine get_values(job, quantity, set, values, error)
    type(job_type), intent(in) :: job
    character(*), intent(in) :: quantity           !< e.g. 'U', 'CPRESS', 'POINT S', 'TIME'
    character(*), intent(in) :: set                !< node set, surface, element set, or label; '' means all
    real(DP), allocatable, intent(out) :: values(:, :)   !< (components, rows)
    type(error_type), allocatable, intent(out) :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (allocated(job%analysis%state%new%u)) then
      call query_values(job%analysis, quantity, set, values, error)
    else
      call set_error(error, EXIT_USAGE, 'The job has not begun.')
    end if
  end subroutine get_values


  !> Sets a quantity by name. Quantities, and when values are reached: `set_driven_values` and doc/manual/library.md.
  subroutine set_values(job, quantity, set, values, error)
    type(job_type), intent(inout) :: job
    character(*), intent(in) :: quantity
    character(*), intent(in) :: set                !< node set, surface, label of a node, or interaction
    real(DP), intent(in) :: values(:)              !< component by component of each row; the same on all ranks
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: checksum
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (.not. job%is_ready) then
      call set_error(error, EXIT_USAGE, 'The job has not begun or is finished.')
      return
    end if
    checksum = checksum_of_words(transfer(values, [0_I64]))
    call check_agreement([real(ibits(checksum, 0, 32), DP), real(ibits(checksum, 32, 32), DP)], 'values of ' // quantity, error)
    if (.not. allocated(error)) call set_driven_values(job%analysis, quantity, set, values, error)
  end subroutine set_values


  !> The names of a kind: NODE SETS, ELEMENT SETS, SURFACES, PAIRS, INTERACTIONS, MATERIALS; QUANTITIES of get_values.
  subroutine get_names(job, kind, names, error)
    type(job_type), intent(in) :: job
    character(*), intent(in) :: kind
    character(:), allocatable, intent(out) :: names(:)
    type(error_type), allocatable, intent(out) :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (allocated(job%analysis%state%new%u)) then
      call query_names(job%analysis, kind, names, error)
    else
      call set_error(error, EXIT_USAGE, 'The job has not begun.')
    end if
  end subroutine get_names


  !> A matrix at the current configuration: TANGENT, J on the free unknowns; MAP, C of du = C dv + c, (unknowns x free);
  !! STIFFNESS, K of the elements and loads on all unknowns. Unknown 3 (i - 1) + k is component k of node i. And C'R.
  !!
  !! Before: an increment was started or solved. After: the job is unchanged.
  subroutine get_matrix(job, name, matrix, residual, error)
    type(job_type), intent(inout) :: job
    character(*), intent(in) :: name
    type(sparse_type), intent(out) :: matrix       !< general, by compressed rows
    real(DP), allocatable, intent(out) :: residual(:)   !< (n_free) C'R [force]
    type(error_type), allocatable, intent(out) :: error
    type(state_type) :: state
    integer :: trouble
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    associate (analysis => job%analysis, system => job%analysis%system, i_step => job%analysis%stepping%step)
      trouble = 1
      if (i_step > 0) then
        call use_threads(analysis%options%n_threads)
        state = analysis%state
        call evaluate_equilibrium(system, analysis%model, analysis%driven_loads%step, state, trouble, is_frozen=.true.)
        if (trouble == OUTCOME_OK) then
          call undivide_matrix(system, analysis%model)
          call linearize_equilibrium(system, analysis%model, analysis%driven_loads%step, state, trouble, error)
        end if
      end if
      if (allocated(error)) return
      if (trouble /= OUTCOME_OK) then
        call set_error(error, EXIT_USAGE, 'There is no matrix yet: begin or solve an increment first.')
        return
      end if
      allocate (residual(system%constraints%n_free))
      call multiply_transpose(system%constraints%transformation, reshape(system%residual_at_gap, [size(system%residual_at_gap)]), &
        residual)
      select case (name_key(name))
      case ('TANGENT')
        call assemble_tangent_matrix(system, matrix, error)
      case ('MAP')
        matrix = system%constraints%transformation
      case ('STIFFNESS')
        matrix = combine_with_skew(full_from_upper(system%assembly%stiffness), system%assembly%skew)
      case default
        call set_error(error, EXIT_USAGE, 'There is no matrix named ' // name // '; TANGENT, MAP and STIFFNESS are there.')
      end select
    end associate
  end subroutine get_matrix


  !> Discards a log line of a job without a log_sink.
  subroutine discard_line(self, text)
    class(null_sink_type), intent(inout) :: self
    character(*), intent(in) :: text
    if (len(text) < 0) return
    associate (unused => self)
    end associate
  end subroutine discard_line

end module amontons_library
