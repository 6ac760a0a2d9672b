!> Job driver: start, advance by one increment, finish; attempts, cut-back, commit and rollback.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `advance_analysis` is `solve_increment` and `commit_analysis`. Between the two the solution can be inspected and
!! discarded: `rollback_analysis` restores the state of the last commit bitwise. Only a commit writes fields.
!!
!! An allocation without `stat=` that fails ends the process, including that of a caller of the library. The large and
!! predictable allocations (factor, vectors of GMRES, dense blocks) check their own status. For the many others the job tests
!! beforehand whether their sum is available (`reserve_...`).
module amontons_analysis
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, diagnostic_list_type, set_error, EXIT_USAGE, EXIT_NOT_CONVERGED, EXIT_SOLVER, &
    EXIT_INTERNAL
  use amontons_posix, only: is_status_requested, pending_stop_signal, suspend_lock, resume_lock, has_memory
  use amontons_version, only: VERSION
  use amontons_distributed_two_level, only: compare_messages, describe_messages
  use amontons_mpi_ranks, only: n_ranks, min_over_ranks, share_error, check_agreement
  use amontons_assembly, only: share_points, sum_spring_energies
  use amontons_text, only: to_text, plural
  use amontons_logger, only: logger_type
  use amontons_materials, only: has_no_energy
  use amontons_model, only: model_type, job_options_type
  use amontons_steps, only: step_type, SOLVER_GRADIENTS
  use amontons_contact_rounds, only: comparable_iterations
  use amontons_iteration_records, only: increment_record_type, PHASE_READING, PHASE_MODEL, PHASE_PLANNING, PHASE_CONTACT, &
    PHASE_OUTPUT, PHASE_OTHER
  use amontons_deck, only: read_deck, read_deck_text
  use amontons_state, only: fields_type, state_type, commit_state, restore_state
  use amontons_slave_nodes, only: accumulate_slip
  use amontons_user_element_forces, only: begin_user_elements, user_strain_energy, user_inelastic_work
  use amontons_contact_checks, only: find_contact_fault, find_avoidable_crossing
  use amontons_balanced_bodies, only: find_loaded_support
  use amontons_model_change, only: activate_elements, relieve_elements
  use amontons_model_setup, only: set_up_model
  use amontons_user_routine_setup, only: call_external_databases, handle_user_messages, update_user_amplitudes, &
    restore_user_amplitudes
  use amontons_user_routines, only: LOP_INCREMENT_START, LOP_INCREMENT_END, LOP_JOB_END, LOP_RESTART, LOP_STEP_START, LOP_STEP_END
  use amontons_user_state, only: initialize_state_variables
  use amontons_stabilization, only: is_damped, update_damping
  use amontons_arc_length, only: begin_path, is_path_done, path_fraction
  use amontons_inertia, only: begin_motion, conclude_inertia, implicit_loss
  use amontons_equilibrium, only: plan_solver, create_equilibrium, begin_step, begin_increment, evaluate_points, &
    discard_matrices, is_matrix_free_step, OUTCOME_OK, OUTCOME_ELEMENT
  use amontons_model_check, only: check_model, summarize_model
  use amontons_model_check_motion, only: find_free_motion
  use amontons_convergence, only: VERDICT_CONTINUE, VERDICT_CONVERGED, VERDICT_DIVERGES
  use amontons_globalization, only: delay_snap_through
  use amontons_newton, only: begin_newton, choose_descent, iterate
  use amontons_postprocess, only: add_inelastic_work, mechanical_strain
  use amontons_active_set_history, only: count_changed_statuses
  use amontons_increment_control, only: attempt_effort_type, begin_stepping, propose_increment, accept_increment, &
    reject_increment, can_cut_back, OUTCOME_STEP_DONE, OUTCOME_CUT_BACK, OUTCOME_GIVE_UP
  use amontons_failure, only: failure_type, FAILURE_NONE, FAILURE_USER_ROUTINE, FAILURE_SIGNAL, FAILURE_CROSSING
  use amontons_creep_accuracy, only: check_creep
  use amontons_failure_messages, only: failure_words
  use amontons_failure_report, only: find_failure, describe_failure, summarize_attempts, describe_events, is_always_unsupported
  use amontons_text_output, only: print_iteration, print_increment
  use amontons_checkpoint, only: take_snapshot, restore_snapshot, unpack_state
  use amontons_restart_file, only: read_restart_state
  use amontons_driven_loads, only: create_driven_loads, select_step_loads, list_driven, restore_driven
  use amontons_job_files, only: analysis_type, is_at_end, is_batch, open_files, reopen_files, write_committed, close_files, &
    describe_result_files
  use amontons_dense, only: solve_symmetric_eigen
  use amontons_factorization, only: set_blas_threads, choose_blas_kernels
  implicit none
  private
  public :: analysis_type, start_analysis, advance_analysis, finish_analysis
  public :: solve_increment, enter_step, begin_trial, iterate_trial, commit_analysis, rollback_analysis, is_at_end, use_threads

  integer(I64), parameter :: MEGABYTE = 1048576              !< [bytes]
  integer, parameter :: BLAS_BUFFER_MEGABYTES = 160          !< allocated by OpenBLAS at its first call, with a margin [megabytes]

  real(DP), parameter :: ENERGY_ROUNDING = 1.0e-9_DP   !< of an energy balance over its energies [-]
  integer, parameter :: MIN_NODES_THREADED = 4000         !< below, synchronization of threads costs more than it saves

contains

  !> Reads the deck, builds and checks the model, and opens the result files; or resumes from the checkpoint
  !! (options%is_resumed). With options%is_check it stops before the files.
  !!
  !! Errors: EXIT_DECK, EXIT_SETUP (nothing has been written), EXIT_IO, EXIT_SOLVER.
  subroutine start_analysis(analysis, options, logger, error)
    type(analysis_type), intent(inout) :: analysis
    type(job_options_type), intent(in) :: options
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    call analysis%system%clock%start()
    analysis%options = options
    allocate (analysis%records(64), analysis%iterations(64))
    call reserve_blas(error)
    if (.not. allocated(error)) call reserve_deck(options, error)
    if (allocated(error)) return
    call use_threads(options%n_threads)
    if (allocated(options%deck_text)) then
      call read_deck_text(options%deck_text, options, analysis%model, analysis%diagnostics, error)
    else
      call read_deck(options, analysis%model, analysis%diagnostics, error)
    end if
    call logger%show_diagnostics(analysis%diagnostics)
    if (allocated(error)) return
    call analysis%system%clock%read(PHASE_READING)
    if (n_ranks() > 1) call check_ranks(analysis%model, options, error)
    if (allocated(error)) return
    analysis%options%is_check = options%is_check .or. analysis%model%is_checked_only
    if (options%n_threads == 0 .and. analysis%model%mesh%n_nodes < MIN_NODES_THREADED) analysis%options%n_threads = 1
    call use_threads(analysis%options%n_threads)
    if (.not. analysis%options%is_check) call log_threads(analysis%options%n_threads, logger)
    call set_up_model(analysis%model, options, logger, error)
    if (allocated(error)) return
    call create_driven_loads(analysis%driven_loads, analysis%model)
    call analysis%system%clock%read(PHASE_MODEL)
    call reserve_matrices(analysis%model, .not. is_batch(analysis), error)
    if (allocated(error)) return
    call create_equilibrium(analysis%system, analysis%model, analysis%state, error, &
      needs_trial_points(analysis%model, .not. is_batch(analysis)))
    if (.not. allocated(error)) call initialize_state_variables(analysis%model, analysis%state, error)
    if (allocated(error)) return
    call analysis%system%clock%read(PHASE_PLANNING)
    if (allocated(analysis%model%user_elements)) then
      call begin_user_elements(analysis%model, analysis%state)
      call handle_user_messages(analysis%model, logger, analysis%smallest_pnewdt, error)
    end if
    if (allocated(error)) return
    if (.not. (options%is_resumed .or. allocated(analysis%model%origin%path))) call check_initial_model(analysis, logger, error)
    if (allocated(error) .or. analysis%options%is_check) return
    call analysis%system%clock%read(PHASE_MODEL)
    call save_commit(analysis, .not. is_batch(analysis) .or. options%is_resumed .or. allocated(analysis%model%origin%path))
    if (options%is_resumed) then
      call resume_from_checkpoint(analysis, logger, error)
    else if (allocated(analysis%model%origin%path)) then
      call continue_from_restart(analysis, logger, error)
    end if
    if (allocated(error)) return
    if (options%is_resumed .or. allocated(analysis%model%origin%path)) call call_external_databases(analysis%model, LOP_RESTART, &
      analysis%state%old)
    if (is_batch(analysis)) analysis%snapshot%fields = fields_type()
    if (options%has_files .and. .not. options%is_resumed) then
      !$omp critical (result_files)
      call open_files(analysis, error)
      !$omp end critical (result_files)
      call share_error(error)
    end if
    if (allocated(analysis%model%deck_text)) deallocate (analysis%model%deck_text)   ! the result file contains it
    analysis%is_open = .not. allocated(error)
    call analysis%system%clock%read(PHASE_OUTPUT)
  end subroutine start_analysis


  !> Whether stress, strain, energy and volume of a trial state are needed before it is accepted: they are read between, damping
  !! takes its volumes from them, or a law with history compares them with those at the start of the increment.
  pure logical function needs_trial_points(model, is_inspected) result(is_needed)
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_inspected            !< between the commits
    integer :: i
    is_needed = is_inspected .or. any(model%materials%n_history > 0) .or. &
      any([(is_damped(model%steps(i)), i=1, size(model%steps))])
  end function needs_trial_points


  !> What several ranks cannot do: different decks or files, and user routines, which keep data of their own between calls.
  subroutine check_ranks(model, options, error)
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    associate (checksum => model%deck_checksum)
      call check_agreement([real(ibits(checksum, 0, 32), DP), real(ibits(checksum, 32, 32), DP)], 'decks', error)
    end associate
    if (.not. allocated(error)) call check_agreement([real(options%n_partitions, DP), merge(1.0_DP, 0.0_DP, &
      [options%has_files, options%is_guarded, options%is_resumed])], 'options', error)
    if (allocated(error)) return
    if (allocated(options%user) .or. any(model%materials%is_user)) call set_error(error, EXIT_USAGE, &
      'User routines run with one rank; the job has ' // to_text(n_ranks()) // '.')
  end subroutine check_ranks


  !> Continues from the state of another job.
  subroutine continue_from_restart(analysis, logger, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable :: words(:)
    associate (origin => analysis%model%origin)
      call read_restart_state(origin%path, origin%label, words, error)
      if (.not. allocated(error)) call unpack_state(origin%path, words, analysis%model, analysis%snapshot, error)
      if (allocated(error)) return
      if (origin%is_step_ended) analysis%snapshot%is_step_start = .true.
      call restore_driven(analysis%driven_loads, analysis%model, analysis%snapshot%driven, analysis%snapshot%friction)
      call rollback_analysis(analysis, error)
      if (allocated(error)) return
      call logger%say('The job continues from increment ' // to_text(origin%label%increment) // ' of step ' // &
        to_text(origin%label%step) // ' in ' // origin%path // ', at time ' // to_text(origin%label%total_time) // '.')
    end associate
  end subroutine continue_from_restart


  !> Restores the checkpoint.
  subroutine resume_from_checkpoint(analysis, logger, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    call reopen_files(analysis, error)
    call share_error(error)
    if (allocated(error)) return
    call restore_driven(analysis%driven_loads, analysis%model, analysis%snapshot%driven, analysis%snapshot%friction)
    call rollback_analysis(analysis, error)
    if (allocated(error)) return
    if (analysis%stepping%step == 0) then
      call logger%say('The job starts again from its beginning.')
    else
      call logger%say('The job continues after the checkpoint at time ' // to_text(analysis%stepping%total_time) // &
        ' in step ' // to_text(analysis%stepping%step) // '.')
    end if
  end subroutine resume_from_checkpoint


  !> Sets the number of threads of this job; no effect without OpenMP. The number is a property of the calling thread.
  subroutine use_threads(n_threads)
!$  use omp_lib, only: omp_set_num_threads
    integer, intent(in) :: n_threads               !< 0: as many as OpenMP has
    integer :: n
    n = n_threads
    if (n < 1) return
!$  call omp_set_num_threads(n)
  end subroutine use_threads


  !> Head of the log: the version, and how reproducible the results are.
  subroutine log_threads(n_threads, logger)
!$  use omp_lib, only: omp_get_max_threads
    integer, intent(in) :: n_threads               !< 0: as many as OpenMP has
    type(logger_type), intent(inout) :: logger
    integer :: n
    n = max(1, n_threads)
!$  n = omp_get_max_threads()
    if (n_ranks() > 1) call logger%say('Amontons ' // VERSION // ' with ' // plural(n_ranks(), 'rank') // ' of ' // &
      plural(n, 'thread') // '.')
    if (n_ranks() == 1) call logger%say('Amontons ' // VERSION // ' with ' // plural(n, 'thread') // &
      ': run again so, all results are the same to the last bit; with another number of threads, to 1e-10.')
  end subroutine log_threads


  !> Model check with the contact before the first increment.
  subroutine check_initial_model(analysis, logger, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(diagnostic_list_type) :: report
    character(:), allocatable :: summary
    if (size(analysis%model%steps) == 0) return
    call begin_increment(analysis%system, analysis%model, analysis%driven_loads%step, .true., analysis%state)
    call check_model(analysis%model, analysis%system%contact, analysis%state%new%slaves, report, error)
    call logger%show_diagnostics(report)
    if (analysis%options%is_check) then
      call summarize_model(analysis%model, analysis%system%contact, analysis%state%new%slaves, summary)
      call logger%say(summary)
    end if
    analysis%initial_slaves = analysis%state%new%slaves
    call restore_state(analysis%state)
  end subroutine check_initial_model


  !> Solves one increment with cut-backs, commits and writes it.
  !!
  !! Errors: EXIT_NOT_CONVERGED after the last cut-back, EXIT_SETUP for a step whose constraints contradict each other,
  !! EXIT_SOLVER, EXIT_IO. Every converged increment is on disk.
  subroutine advance_analysis(analysis, logger, is_done, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    logical, intent(out) :: is_done                !< .true.: all steps are done
    type(error_type), allocatable, intent(out) :: error
    integer :: signal
    is_done = is_at_end(analysis)
    if (is_done) return
    analysis%is_trial = .false.
    call solve_increment(analysis, logger, huge(1.0_DP), error)
    if (allocated(error)) return
    call commit_analysis(analysis, logger, error)
    if (allocated(error)) return
    is_done = is_at_end(analysis)
    if (is_done) return
    signal = shared_stop_signal()
    associate (stepping => analysis%stepping)
      if (analysis%options%handles_signals .and. signal /= 0) then
        call set_error(error, EXIT_NOT_CONVERGED, signal_message(analysis))
      else if (.not. analysis%is_step_start .and. &
          stepping%increment > analysis%model%steps(stepping%step)%max_increments) then
        call set_error(error, EXIT_NOT_CONVERGED, 'The step needs more increments than INC on its *STEP card allows. ' // &
          'All converged increments are on disk.')
      end if
    end associate
  end subroutine advance_analysis


  !> Solves one increment with cut-backs; it ends at `until` at the latest. Nothing is committed.
  !!
  !! After: without an error the stepping and the committed fields of the state are those at the end of the increment; the
  !! snapshot contains those of the last commit. After an error they are unchanged.
  subroutine solve_increment(analysis, logger, until, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    real(DP), intent(in) :: until                  !< step time [time]
    type(error_type), allocatable, intent(out) :: error
    integer :: verdict
    real(DP) :: dt
    call enter_step(analysis, error)
    if (allocated(error)) return
    if (analysis%is_step_start) call plan_solver(analysis%system, analysis%model, error)
    if (allocated(error)) return
    call analysis%system%clock%read(PHASE_PLANNING)
    call log_solver_choice(analysis, logger)
    associate (step => analysis%driven_loads%step)
      do
        dt = min(propose_increment(analysis%stepping, step), until - analysis%stepping%step_time)
        call begin_trial(analysis, dt, error)
        analysis%newton%can_be_cut_back = can_cut_back(analysis%stepping, step, dt)
        call choose_descent(analysis%newton, analysis%system, analysis%stepping%attempt)
        if (analysis%newton%can_be_cut_back .and. analysis%stepping%attempt == 1) &
          call delay_snap_through(analysis%newton%globalization, step%controls%globalization)
        do
          call iterate_trial(analysis, logger, verdict, error)
          if (allocated(error)) return
          if (analysis%options%handles_signals) call handle_signals(analysis, logger, verdict, error)
          if (allocated(error)) return
          if (verdict /= VERDICT_CONTINUE) exit
        end do
        call log_solver_choice(analysis, logger)
        if (verdict == VERDICT_CONVERGED) exit
        call reject_attempt(analysis, step, dt, verdict, logger, error)
        if (allocated(error)) return
      end do
    end associate
  end subroutine solve_increment


  !> Logs what the linear solver and the contact skin say about their method, if anything.
  subroutine log_solver_choice(analysis, logger)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    call log_once(analysis%system%reduced_system%message)
    call log_once(analysis%system%skin%message)

  contains

    !> Logs a message and forgets it.
    subroutine log_once(message)
      character(:), allocatable, intent(inout) :: message
      if (.not. allocated(message)) return
      call logger%say(message)
      deallocate (message)
    end subroutine log_once

  end subroutine log_solver_choice


  !> Starts the next step if the last one is done.
  subroutine enter_step(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: motion
    if (.not. analysis%is_step_start) return
    if (analysis%stepping%step > 0 .and. analysis%stepping%step_time == 0.0_DP) return   ! it has started
    call analysis%system%clock%read(PHASE_OTHER)
    call begin_stepping(analysis%stepping, analysis%model%steps(analysis%stepping%step + 1))
    call begin_motion(analysis%model%steps, analysis%stepping%step, analysis%state%old)
    call begin_path(analysis%state%old)
    analysis%state%old%total_time = analysis%stepping%total_time   ! a step may set the clock
    call select_step_loads(analysis%driven_loads, analysis%model, analysis%stepping%step)
    call activate_elements(analysis%model, analysis%stepping%step, analysis%state)
    if (allocated(analysis%model%steps(analysis%stepping%step)%is_relieved)) call relieve_elements(analysis%model, &
      analysis%stepping%step, mechanical_strain(analysis%model, analysis%state%old), analysis%state)
    associate (step => analysis%driven_loads%step)
      if (step%dissipated_fraction > 0.0_DP .and. size(analysis%model%pairs) == 0) call find_free_motion(analysis%model, &
        analysis%system%contact, analysis%state%old%slaves, analysis%stepping%step, step%has_free_motion, motion)
    end associate
    call begin_step(analysis%system, analysis%model, analysis%driven_loads%step, analysis%state, error)
    call analysis%system%clock%read(PHASE_PLANNING)
    if (.not. allocated(error)) call call_external_databases(analysis%model, LOP_STEP_START, analysis%state%old)
  end subroutine enter_step


  !> Starts an attempt at an increment of length dt, from the last converged one.
  subroutine begin_trial(analysis, dt, error)
    type(analysis_type), intent(inout) :: analysis
    real(DP), intent(in) :: dt                     !< [time]
    type(error_type), allocatable, intent(out) :: error
    call enter_step(analysis, error)
    if (allocated(error)) return
    call start_attempt(analysis, dt)
    call call_external_databases(analysis%model, LOP_INCREMENT_START, analysis%state%new)
    call begin_newton(analysis%newton, analysis%system, analysis%model, analysis%driven_loads%step, &
      analysis%is_step_start, analysis%state)
  end subroutine begin_trial


  !> One Newton iteration of the attempt. A converged attempt is accepted: stepping and state advance to its end. One in which
  !! bodies passed through each other counts as diverged where a shorter one is possible.
  subroutine iterate_trial(analysis, logger, verdict, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    integer, intent(out) :: verdict                !< VERDICT_...
    type(error_type), allocatable, intent(out) :: error
    integer :: turn, outcome
    character(:), allocatable :: crossing
    crossing = ''
    outcome = OUTCOME_ELEMENT
    associate (step => analysis%driven_loads%step)
      turn = suspend_lock()                            ! other jobs of the process may read, write and log meanwhile
      call iterate(analysis%newton, analysis%system, analysis%model, step, analysis%state, verdict, error)
      call resume_lock(turn)
      if (.not. allocated(error)) call handle_user_messages(analysis%model, logger, analysis%smallest_pnewdt, error)
      if (allocated(error)) return
      call log_iteration(analysis, logger)
      if (verdict /= VERDICT_CONVERGED) return
      if (analysis%newton%can_be_cut_back) call find_avoidable_crossing(analysis%model, analysis%faces, analysis%state, &
        analysis%stepping%step, crossing)
      if (crossing /= '') analysis%refusal = failure_type(FAILURE_CROSSING, detail=crossing)
      if (crossing == '') call evaluate_points(analysis%system, analysis%model, step, analysis%state, outcome)
      if (outcome == OUTCOME_OK) call share_points(analysis%system%assembly, analysis%model%mesh, analysis%state%new)
      if (outcome == OUTCOME_OK) call check_creep(analysis%model, step, analysis%state, analysis%creep_ratio, analysis%refusal)
      if (analysis%refusal%code /= FAILURE_NONE) then
        verdict = VERDICT_DIVERGES
      else if (outcome == OUTCOME_OK) then
        call accept_attempt(analysis, step)
      else
        call set_error(error, EXIT_INTERNAL, 'The forces of a converged state cannot be evaluated again.')
      end if
    end associate
  end subroutine iterate_trial


  !> Accepts a converged attempt: sums forces and works, and makes the trial fields the committed ones.
  subroutine accept_attempt(analysis, step)
    type(analysis_type), intent(inout) :: analysis
    type(step_type), intent(in) :: step
    integer :: outcome, n_iterations
    real(DP) :: damping_work
    logical :: is_path_end
    associate (record => analysis%records(analysis%n_records))
      record%is_converged = .true.
      record%load_factor = analysis%state%new%load_factor
      is_path_end = step%is_riks
      if (is_path_end) is_path_end = is_path_done(analysis%model, step, record%increment, analysis%state)
      record%n_proximal = analysis%newton%globalization%n_proximal
      record%n_snap_through = analysis%newton%globalization%n_snap_through + analysis%newton%rounds%n_unstable
      call update_damping(analysis%system%volume_share, step, analysis%state, damping_work)
      if (step%is_dynamic) call conclude_inertia(analysis%system%assembly, analysis%system%mass, analysis%state)
      call sum_works(analysis%model, step, analysis%state, record, damping_work)
      record%report_lines = describe_events(analysis%model, analysis%state)
      call complete_record(analysis, record)
      call commit_state(analysis%state)
      n_iterations = record%n_iterations
      if (step%solver == SOLVER_GRADIENTS) n_iterations = comparable_iterations(step, n_iterations)
      call accept_increment(analysis%stepping, step, record%dt, attempt_effort_type(n_iterations, record%n_status_changes, &
        record%n_cycles_treated, analysis%creep_ratio), outcome, is_path_end)
      analysis%is_step_start = outcome == OUTCOME_STEP_DONE
      record%is_step_end = analysis%is_step_start
    end associate
  end subroutine accept_attempt


  !> Commits the increments solved since the last commit: writes them, and the fields of the last one, to the files.
  subroutine commit_analysis(analysis, logger, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    integer :: first
    call analysis%system%clock%read(PHASE_OTHER)
    first = analysis%n_committed + 1
    if (analysis%n_records < first) return
    if (is_at_end(analysis) .and. is_batch(analysis)) call discard_matrices(analysis%system)
    call save_commit(analysis, .not. is_batch(analysis))
    call call_external_databases(analysis%model, LOP_INCREMENT_END, analysis%state%old)
    if (analysis%is_step_start) call call_external_databases(analysis%model, LOP_STEP_END, analysis%state%old)
    if (analysis%has_files) then
      !$omp critical (result_files)
      call write_committed(analysis, first, error)
      !$omp end critical (result_files)
    end if
    call share_error(error)
    if (.not. allocated(error)) call handle_user_messages(analysis%model, logger, analysis%smallest_pnewdt, error)
    if (allocated(error)) return
    associate (record => analysis%records(analysis%n_records))
      call logger%show_increment(record, done_fraction(analysis))
    end associate
    call analysis%system%clock%read(PHASE_OUTPUT)
    call check_balance(analysis, error)
    if (.not. allocated(error)) call check_unpaired_contact(analysis, error)
    call analysis%system%clock%read(PHASE_CONTACT)
  end subroutine commit_analysis


  !> Ends the job where loads that held each other in balance do so no longer.
  subroutine check_balance(analysis, error)
    type(analysis_type), intent(in) :: analysis
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: message
    call find_loaded_support(analysis%model, max(1, analysis%stepping%step), analysis%system%rotation_length, &
      analysis%state%old, message)
    if (message /= '') call set_error(error, EXIT_NOT_CONVERGED, message // ' The converged increments are on disk.')
  end subroutine check_balance


  !> Ends the job where contact did not act between faces that came together.
  subroutine check_unpaired_contact(analysis, error)
    type(analysis_type), intent(inout) :: analysis !< its faces
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: message
    call find_contact_fault(analysis%model, analysis%system%contact, analysis%system%base, analysis%faces, analysis%state%old, &
      max(1, analysis%stepping%step), message)
    if (message /= '') call set_error(error, EXIT_NOT_CONVERGED, message // ' The converged increments are on disk.')
  end subroutine check_unpaired_contact


  !> Stores the state as the last commit.
  subroutine save_commit(analysis, has_fields)
    type(analysis_type), intent(inout) :: analysis
    logical, intent(in) :: has_fields              !< the committed fields are copied
    analysis%n_committed = analysis%n_records
    call take_snapshot(analysis%snapshot, analysis%state, analysis%system, analysis%newton, analysis%stepping, &
      analysis%is_step_start, has_fields)
    call list_driven(analysis%driven_loads, analysis%model, analysis%snapshot%driven, analysis%snapshot%friction)
  end subroutine save_commit


  !> Restores the state of the last commit bitwise and discards what was solved since.
  subroutine rollback_analysis(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    analysis%n_records = analysis%n_committed
    analysis%n_iterations = 0
    call select_step_loads(analysis%driven_loads, analysis%model, max(1, analysis%snapshot%stepping%step))
    call restore_snapshot(analysis%snapshot, analysis%model, analysis%driven_loads%step, analysis%state, analysis%system, &
      analysis%newton, &
      analysis%stepping, analysis%is_step_start, error)
    if (allocated(analysis%driven_loads%step%amplitudes)) call restore_user_amplitudes(analysis%driven_loads%step%amplitudes, &
      analysis%state%old)
  end subroutine rollback_analysis


  !> SIGUSR1: logs a status line. SIGINT and SIGTERM: end the attempt and the job.
  subroutine handle_signals(analysis, logger, verdict, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    integer, intent(in) :: verdict                 !< VERDICT_...
    type(error_type), allocatable, intent(out) :: error
    associate (record => analysis%records(analysis%n_records), newton => analysis%newton%record)
      if (is_status_requested()) call logger%say('Status: step ' // to_text(record%step) // ', increment ' // &
        to_text(record%increment) // ', attempt ' // to_text(record%attempt) // ', iteration ' // &
        to_text(newton%iteration) // ': imbalance ' // to_text(newton%residual) // ' of the largest force, time ' // &
        to_text(record%total_time) // ', ' // to_text(nint(100.0_DP * done_fraction(analysis))) // ' % done.')
      if (shared_stop_signal() == 0 .or. verdict == VERDICT_CONVERGED) return
      record%failure%code = FAILURE_SIGNAL
      record%reason = failure_words(record%failure)
      call complete_record(analysis, record)
      call log_attempt(analysis, logger)
      call set_error(error, EXIT_NOT_CONVERGED, signal_message(analysis))
    end associate
  end subroutine handle_signals


  !> The stop signal of a rank, the same on all ranks; 0: none.
  integer function shared_stop_signal() result(signal)
    signal = -nint(min_over_ranks(-real(pending_stop_signal(), DP)))
  end function shared_stop_signal


  !> Message after a signal stopped the job.
  function signal_message(analysis) result(sentence)
    type(analysis_type), intent(in) :: analysis
    character(:), allocatable :: sentence
    integer, parameter :: SIGINT = 2               ! POSIX
    sentence = 'The job was stopped by ' // trim(merge('SIGINT ', 'SIGTERM', shared_stop_signal() == SIGINT)) // &
      ' at time ' // to_text(analysis%stepping%total_time) // '. All converged increments are on disk; amontons ' // &
      '--resume ' // analysis%options%job // ' continues after them.'
  end function signal_message


  !> Resets the trial state to the committed one at the end time of the increment, and the counters to zero.
  subroutine start_attempt(analysis, dt)
    type(analysis_type), intent(inout) :: analysis
    real(DP), intent(in) :: dt                     !< [time]
    call restore_state(analysis%state)
    analysis%smallest_pnewdt = 1.0_DP
    analysis%refusal = failure_type()
    analysis%faces%is_free_of_crossings = .false.
    analysis%state%new%step_time = analysis%stepping%step_time + dt
    analysis%state%new%total_time = analysis%stepping%total_time + dt
    analysis%state%new%step = analysis%stepping%step
    analysis%state%new%increment = analysis%stepping%increment
    analysis%state%new%time_increment = dt
    if (allocated(analysis%driven_loads%step%amplitudes)) call update_user_amplitudes(analysis%model, &
      analysis%driven_loads%step%amplitudes, &
      analysis%state)
    analysis%system%n_factorisations = 0
    analysis%system%n_krylov = 0
    analysis%n_records = analysis%n_records + 1
    if (analysis%n_records > size(analysis%records)) call enlarge_records(analysis%records)
    analysis%records(analysis%n_records) = increment_record_type(step=analysis%stepping%step, &
      increment=analysis%stepping%increment, attempt=analysis%stepping%attempt, n_cutbacks=analysis%stepping%attempt - 1, &
      dt=dt, step_time=analysis%state%new%step_time, total_time=analysis%state%new%total_time, &
      is_riks=analysis%driven_loads%step%is_riks, load_factor=analysis%state%old%load_factor, reason='')
  end subroutine start_attempt


  !> Doubles the capacity for records.
  subroutine enlarge_records(records)
    type(increment_record_type), allocatable, intent(inout) :: records(:)
    type(increment_record_type), allocatable :: larger(:)
    allocate (larger(2 * size(records)))
    larger(:size(records)) = records
    call move_alloc(larger, records)
  end subroutine enlarge_records


  !> Logs an iteration, writes it to .cvg and to the list for the iteration table, and adds its counts to the attempt.
  subroutine log_iteration(analysis, logger)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    associate (record => analysis%newton%record, total => analysis%records(analysis%n_records))
      if (record%iteration == 0) return            ! no iteration was completed
      record%step = total%step
      record%increment = total%increment
      record%attempt = total%attempt
      total%n_iterations = record%iteration
      total%n_status = record%n_status
      total%n_scenario = total%n_scenario + record%n_scenario
      total%smallest_step_length = min(total%smallest_step_length, record%step_length)
      total%n_cycles_treated = analysis%newton%n_cycles_treated
      total%n_status_changes = count_changed_statuses(analysis%newton%active_set_history)
      total%residual = record%residual
      total%correction = record%correction
      call logger%show_iteration(record)
      analysis%n_iterations = analysis%n_iterations + 1
      if (analysis%n_iterations > size(analysis%iterations)) then
        analysis%iterations = [analysis%iterations, analysis%iterations]
      end if
      analysis%iterations(analysis%n_iterations) = record
      if (analysis%has_files .and. .not. analysis%is_trial) call print_iteration(analysis%text_output, record)
    end associate
  end subroutine log_iteration


  !> Rejects a failed attempt: reports it, restores the committed state, then cuts back or gives up.
  subroutine reject_attempt(analysis, step, dt, verdict, logger, error)
    type(analysis_type), intent(inout) :: analysis
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: dt                     !< [time]
    integer, intent(in) :: verdict                 !< VERDICT_...
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    logical :: is_always_free                      ! no shorter increment holds a body
    integer :: outcome
    character(120) :: location, ending
    associate (record => analysis%records(analysis%n_records))
      record%failure = find_failure(analysis%model, analysis%system, analysis%state, analysis%newton, verdict)
      if (analysis%refusal%code /= FAILURE_NONE) record%failure = analysis%refusal
      if (analysis%smallest_pnewdt < 1.0_DP) record%failure = failure_type(FAILURE_USER_ROUTINE, number=analysis%smallest_pnewdt)
      record%reason = failure_words(record%failure)
      call complete_record(analysis, record)
      call reject_increment(analysis%stepping, step, dt, verdict, record%failure, outcome)
      is_always_free = is_always_unsupported(analysis%records(:analysis%n_records), &
        step%controls%increments%max_unsupported_attempts) .and. .not. step%is_dynamic
      if (is_always_free) outcome = OUTCOME_GIVE_UP
      record%report_lines = describe_failure(analysis%model, analysis%system, analysis%state, analysis%newton, record%failure)
      if (outcome /= OUTCOME_CUT_BACK) record%report_lines = [summarize_attempts(analysis%records(:analysis%n_records)), &
        record%report_lines]
      call log_attempt(analysis, logger)
      if (outcome /= OUTCOME_CUT_BACK) then
        write (location, '(a,i0,a,i0,a,i0,a,i0,a)') 'Step ', record%step, ', increment ', record%increment, ', attempt ', &
          record%attempt, ', iteration ', record%n_iterations, ': '
        call logger%show_report(trim(location) // ' ' // record%reason, record%report_lines)
        ending = 'No smaller increment is allowed.'
        if (analysis%stepping%attempt > step%controls%i_a) ending = 'No further cut-back is allowed (I_A of *CONTROLS).'
        if (is_always_free) ending = 'A smaller increment does not hold it.'
        call set_error(error, EXIT_NOT_CONVERGED, trim(location) // ' ' // record%reason // ' ' // trim(ending) // &
          ' All converged increments are on disk.')
      end if
    end associate
    call restore_state(analysis%state)
  end subroutine reject_attempt


  !> Logs a failed attempt and writes it to .sta.
  subroutine log_attempt(analysis, logger)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    associate (record => analysis%records(analysis%n_records))
      call logger%show_increment(record, done_fraction(analysis))
      if (analysis%has_files .and. .not. analysis%is_trial) call print_increment(analysis%text_output, record)
    end associate
  end subroutine log_attempt


  !> Computes slip, work and force sums of a converged increment.
  subroutine sum_works(model, step, state, record, damping_work)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    type(increment_record_type), intent(inout) :: record
    real(DP), intent(in) :: damping_work                 !< work of damping forces, included in the applied ones [energy]
    real(DP) :: start_share                        ! of the forces at the start in the work: half, but none for backward Euler [-]
    integer :: s
    call accumulate_slip(state%old, state%new)
    state%new%strain_energy = sum(state%new%energy * state%new%volume) + user_strain_energy(model, state%new) &
      + sum_spring_energies(model, step%is_nlgeom, state)
    start_share = merge(0.0_DP, 0.5_DP, step%is_dynamic)
    associate (old => state%old, new => state%new, is_abstract => model%mesh%is_auxiliary)
      call add_inelastic_work(model, old, new)
      new%plastic_work = new%plastic_work + user_inelastic_work(model, new) - user_inelastic_work(model, old)
      new%external_work = old%external_work + sum((new%u - old%u) * (start_share * (old%applied_force + old%reaction_force) &
        + (1.0_DP - start_share) * (new%applied_force + new%reaction_force))) - damping_work
      if (step%is_dynamic) new%integration_loss = new%integration_loss + implicit_loss(old, new)
      if (step%is_dynamic) new%proximal_work = old%proximal_work   ! it is in the integration loss
      if (.not. step%is_dynamic) new%kinetic_energy = 0.0_DP
      record%applied_force = sum(new%applied_force, dim=2, mask=spread(.not. is_abstract, 1, 3))
      record%reaction_force = sum(new%reaction_force, dim=2, mask=spread(.not. is_abstract, 1, 3))
      record%contact_force = sum(new%contact_force, dim=2)
      record%slave_force = 0.0_DP
      do s = 1, size(new%slaves)
        record%slave_force = record%slave_force + new%slaves(s)%force + new%slaves(s)%shear
      end do
      if (has_energy_balance(model, step) .and. .not. allocated(model%user_elements) .and. new%proximal_work <= old%proximal_work) &
        new%proximal_work = old%proximal_work + released_energy(old, new)
      record%external_work = new%external_work
      record%friction_work = new%friction_work
      record%proximal_work = new%proximal_work
      record%stabilization_work = new%stabilization_work
      record%plastic_work = new%plastic_work
      record%kinetic_energy = new%kinetic_energy
      record%integration_loss = new%integration_loss
      record%proximal_work_increment = new%proximal_work - old%proximal_work
      record%strain_energy = new%strain_energy
      record%contact_energy = sum(new%slaves%energy)
    end associate
  end subroutine sum_works


  !> Whether loads and supports alone change the energies: temperatures, elements and materials that change, interferences, and
  !! viscoelastic materials take or give energy that no work measures.
  pure logical function has_energy_balance(model, step)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    has_energy_balance = .not. (step%is_dynamic .or. step%is_riks .or. step%has_creep .or. allocated(step%is_inactive) .or. &
      allocated(step%is_reactivated) .or. allocated(step%is_relieved) .or. allocated(step%material) .or. &
      allocated(step%is_removed) .or. allocated(step%interference) .or. allocated(step%is_shrink_fit))
    if (has_energy_balance .and. allocated(step%temperatures)) has_energy_balance = size(step%temperatures) == 0
    has_energy_balance = has_energy_balance .and. .not. any(has_no_energy(model%materials))
  end function has_energy_balance


  !> Energy that a snap releases within an increment [energy]: the external work beyond all energies, if no path of equilibria from
  !! its start to its end can explain it. Forces that change monotonically do a work within 1/2 |dF'du| of the trapezoidal rule;
  !! half of what friction, plasticity and contact took is allowed for the error of their rules.
  pure real(DP) function released_energy(old, new) result(energy)
    type(fields_type), intent(in) :: old, new      !< at the start and at the end
    real(DP) :: external, stored, taken, allowed
    external = new%external_work - old%external_work
    stored = new%strain_energy - old%strain_energy
    taken = (new%friction_work - old%friction_work) + (new%plastic_work - old%plastic_work) &
      + sum(new%slaves%energy - old%slaves%energy) + (new%stabilization_work - old%stabilization_work)
    allowed = 0.5_DP * sum(abs((new%u - old%u) * (new%applied_force + new%reaction_force - old%applied_force &
      - old%reaction_force))) + 0.5_DP * abs(taken) + ENERGY_ROUNDING * (abs(external) + sum(abs(new%energy * new%volume)))
    energy = external - stored - taken
    if (energy <= allowed) energy = 0.0_DP
  end function released_energy


  !> Sets counters of the attempt, and the times since the record before.
  subroutine complete_record(analysis, record)
    type(analysis_type), intent(inout) :: analysis
    type(increment_record_type), intent(inout) :: record
    call analysis%system%clock%read(PHASE_OTHER)
    record%n_factorisations = analysis%system%n_factorisations
    record%n_krylov = analysis%system%n_krylov
    call analysis%system%clock%collect(record%seconds, record%megabytes)
  end subroutine complete_record


  !> Completed fraction of the time of all steps [-].
  pure real(DP) function done_fraction(analysis) result(fraction)
    type(analysis_type), intent(in) :: analysis
    associate (steps => analysis%model%steps, stepping => analysis%stepping)
      fraction = (sum(steps(:max(0, stepping%step - 1))%period) + stepping%step_time) / sum(steps%period)
      if (.not. steps(max(1, stepping%step))%is_riks) return
      fraction = 1.0_DP                            ! of the path: it is the last step
      if (.not. is_at_end(analysis)) fraction = path_fraction(analysis%model, steps(stepping%step), stepping%increment, &
        analysis%state%old)
    end associate
  end function done_fraction


  !> Closes the files and prints the table. May be called after any error.
  subroutine finish_analysis(analysis, logger, error)
    type(analysis_type), intent(inout) :: analysis
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    if (.not. analysis%is_open) return
    analysis%is_open = .false.
    call call_external_databases(analysis%model, LOP_JOB_END, analysis%state%old)
    call analysis%system%clock%read(PHASE_OTHER)
    if (analysis%has_files) then
      !$omp critical (result_files)
      call close_files(analysis, error)
      !$omp end critical (result_files)
    end if
    call analysis%system%clock%read(PHASE_OUTPUT)
    if (analysis%n_records > 0) then
      associate (last => analysis%records(analysis%n_records))
        call analysis%system%clock%collect(last%seconds, last%megabytes)
      end associate
    end if
    call logger%show_summary(analysis%records(:analysis%n_records), 3 * analysis%model%mesh%n_nodes)
    associate (divided => analysis%system%reduced_system%divided)
      if (divided%n_iterations > 0) then
        call compare_messages(divided)
        call logger%say(describe_messages(divided))
      end if
    end associate
    call share_error(error)
    if (analysis%has_files .and. .not. allocated(error)) call logger%say(describe_result_files(analysis))
    analysis%has_files = .false.
  end subroutine finish_analysis


  !> Chooses the kernels of the BLAS and checks the memory for its buffer: OpenBLAS allocates it at its first call, and retries
  !! forever if memory is short. The BLAS runs with one thread: the program's threads share the loops above it, and the busy
  !! waiting of further threads would slow them down.
  subroutine reserve_blas(error)
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: kernels
    real(DP) :: values(2), vectors(2, 2)
    integer :: unused
    call choose_blas_kernels(kernels)
    call set_blas_threads(1)
    if (has_memory(BLAS_BUFFER_MEGABYTES)) then
      call solve_symmetric_eigen(reshape([2.0_DP, 1.0_DP, 1.0_DP, 2.0_DP], [2, 2]), values, vectors, unused)
    else
      call set_error(error, EXIT_SOLVER, 'There is not enough memory to begin: ' // to_text(BLAS_BUFFER_MEGABYTES) // &
        ' megabytes are needed.')
    end if
  end subroutine reserve_blas


  !> Checks the memory for the text of a deck and its tables in advance, so that a lack of memory is an error message.
  subroutine reserve_deck(options, error)
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    integer(I64), parameter :: COPIES = 4            ! the text, its lines and fields, the mesh
    integer(I64) :: n_bytes
    n_bytes = 0
    if (allocated(options%deck_text)) then
      n_bytes = len(options%deck_text, I64)
    else if (allocated(options%deck)) then
      inquire (file=options%deck, size=n_bytes)
    end if
    call reserve_memory('read the deck', COPIES * max(0_I64, n_bytes), error)
  end subroutine reserve_deck


  !> Checks the least memory of a model of this size without its factor, which is checked later: structure and entries of the
  !! stiffness and of one more matrix if a step has one, and the fields of committed and trial state, of the last commit too where
  !! a program inspects them.
  subroutine reserve_matrices(model, is_inspected, error)
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_inspected            !< between the commits
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: n_pairs, n_bytes, n_copies
    integer :: e, n
    associate (mesh => model%mesh)
      n_pairs = 0
      do e = 1, mesh%n_elements
        n = mesh%first(e + 1) - mesh%first(e)
        n_pairs = n_pairs + int(n * (n + 1) / 2, I64)
      end do
      if (all([(is_matrix_free_step(model%steps(n)), n=1, size(model%steps))])) n_pairs = 0
      n_copies = merge(3_I64, 2_I64, is_inspected)
      n_bytes = n_copies * 8 * 24 * int(mesh%n_nodes, I64)
      if (.not. needs_trial_points(model, is_inspected)) n_copies = 1
      n_bytes = n_bytes + n_copies * 8 * 14 * int(mesh%n_points, I64)
    end associate
    call reserve_memory('solve a model of this size', n_bytes, error)
    if (allocated(error) .or. n_pairs == 0) return
    call reserve_memory('solve a model of this size', n_bytes + 40 * n_pairs, error)
    if (allocated(error)) error%message = error%message // ' *STATIC, SOLVER=CONJUGATE GRADIENTS needs no matrix: ' // &
      to_text(int(n_bytes / MEGABYTE) + 1) // ' megabytes at least.'
  end subroutine reserve_matrices


  !> Checks whether so much memory is available. Errors: EXIT_SOLVER.
  subroutine reserve_memory(what, n_bytes, error)
    character(*), intent(in) :: what                 !< to follow 'to'
    integer(I64), intent(in) :: n_bytes
    type(error_type), allocatable, intent(out) :: error
    integer :: megabytes
    megabytes = int(min(n_bytes / MEGABYTE, int(huge(1), I64))) + 1
    if (.not. has_memory(megabytes)) call set_error(error, EXIT_SOLVER, 'There is not enough memory to ' // what // &
      ': at least ' // to_text(megabytes) // ' megabytes are needed.')
  end subroutine reserve_memory

end module amontons_analysis
