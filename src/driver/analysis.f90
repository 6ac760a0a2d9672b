!> Analysis: the job in three verbs: start, advance by one increment, finish; and the smaller verbs that they are made of.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `advance_analysis` is `solve_increment` and `commit_analysis`. Between the two the solution can be looked at and thrown
!! away: `rollback_analysis` makes everything bitwise what it was at the last commit. Only a commit writes fields.
!!
!! An allocation that fails without a word of what to do ends the process, that of a caller of the library too. The large and
!! foreseeable ones (factor, vectors of GMRES, dense blocks) look at their own status; for the many others their sum is asked for at
!! once, before a job begins to take it piece by piece (`claim_...`).
module amontons_analysis
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, complaints_type, set_error, EXIT_NOT_CONVERGED, EXIT_SOLVER
  use amontons_posix, only: peak_megabytes, is_status_asked, stop_signal, leave_turn, resume_turn, has_memory
  use amontons_version, only: VERSION
  use amontons_text, only: text_of, plural
  use amontons_logger, only: journal_type
  use amontons_model, only: model_type, job_options_type
  use amontons_steps, only: step_type
  use amontons_iteration_records, only: increment_record_type, PHASE_OUTPUT, PHASE_OTHER
  use amontons_deck, only: read_deck, read_deck_text
  use amontons_state, only: state_type, commit_state, restore_state
  use amontons_slave_nodes, only: commit_slip
  use amontons_model_change, only: change_model, bear_elements
  use amontons_contact_initialization, only: adjust_slaves
  use amontons_user_routine_setup, only: start_routines, heed_routines, ask_amplitudes, recall_amplitudes
  use amontons_user_state, only: start_variables
  use amontons_tie_generation, only: fasten_model
  use amontons_stabilization, only: close_damping
  use amontons_equilibrium, only: plan_solver, create_system, begin_step, begin_increment
  use amontons_model_check, only: audit_model, audit_summary
  use amontons_convergence, only: VERDICT_GO_ON, VERDICT_CONVERGED
  use amontons_globalization, only: be_patient
  use amontons_newton, only: begin_newton, iterate
  use amontons_postprocess, only: add_inelastic_work
  use amontons_active_set_history, only: n_changed_since_first
  use amontons_increment_control, only: effort_type, open_step, propose_time, accept_increment, reject_increment, may_cut, &
    STEP_DONE, CUT_BACK, GIVE_UP
  use amontons_failure_report, only: failure_reason, failure_lines, failed_attempts, edge_lines, is_free_for_good
  use amontons_text_output, only: print_iteration, print_increment
  use amontons_checkpoint, only: take_snapshot, put_back, unpack_state
  use amontons_restart_file, only: read_state
  use amontons_driven_loads, only: list_driven, recall_driven
  use amontons_job_files, only: analysis_type, is_at_end, open_files, reopen_files, write_committed, close_files
  use amontons_dense, only: symmetric_eigen
  use amontons_factorization, only: set_blas_threads, choose_blas_kernels
  implicit none
  private
  public :: analysis_type, start_analysis, advance_analysis, finish_analysis
  public :: solve_increment, enter_step, begin_trial, iterate_trial, commit_analysis, rollback_analysis, is_at_end, use_threads

  integer, parameter :: BLAS_BUFFER = 160          !< what OpenBLAS takes at its first call, and some more [megabytes]

  integer, parameter :: SMALL_MODEL = 4000         !< nodes below which threads wait longer for each other than they save

contains

  !> Reads the deck, builds and audits the system, and opens the result files; or goes on after the checkpoint
  !! (options%is_resumed). With options%is_check it stops before the files.
  !!
  !! Errors: EXIT_DECK, EXIT_SETUP (nothing has been written), EXIT_IO, EXIT_SOLVER.
  subroutine start_analysis(analysis, options, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(job_options_type), intent(in) :: options
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    analysis%options = options
    allocate (analysis%records(64), analysis%iterations(64))
    call claim_blas(error)
    if (.not. allocated(error)) call claim_deck(options, error)
    if (allocated(error)) return
    call use_threads(options%n_threads)
    if (allocated(options%deck_text)) then
      call read_deck_text(options%deck_text, options, analysis%model, analysis%complaints, error)
    else
      call read_deck(options, analysis%model, analysis%complaints, error)
    end if
    call journal%complain(analysis%complaints)
    if (allocated(error)) return
    analysis%options%is_check = options%is_check .or. analysis%model%is_checked_only
    if (options%n_threads == 0 .and. analysis%model%mesh%n_nodes < SMALL_MODEL) analysis%options%n_threads = 1
    call use_threads(analysis%options%n_threads)
    if (.not. analysis%options%is_check) call tell_threads(analysis%options%n_threads, journal)
    call start_routines(analysis%model, options, error)
    if (allocated(error)) return
    call fasten_model(analysis%model, error)
    if (allocated(error)) return
    call adjust(analysis%model, journal, error)
    if (allocated(error)) return
    call change_model(analysis%model, 0)
    call claim_matrices(analysis%model, error)
    if (allocated(error)) return
    call create_system(analysis%system, analysis%model, analysis%state, error)
    if (.not. allocated(error)) call start_variables(analysis%model, analysis%state, error)
    if (allocated(error)) return
    if (.not. (options%is_resumed .or. allocated(analysis%model%origin%path))) call audit(analysis, journal, error)
    if (allocated(error) .or. analysis%options%is_check) return
    call note_commit(analysis)
    if (options%is_resumed) then
      call resume(analysis, journal, error)
    else if (allocated(analysis%model%origin%path)) then
      call go_on(analysis, journal, error)
    end if
    if (allocated(error)) return
    if (options%has_files .and. .not. options%is_resumed) then
      !$omp critical (result_files)
      call open_files(analysis, error)
      !$omp end critical (result_files)
    end if
    analysis%is_open = .not. allocated(error)
  end subroutine start_analysis


  !> ADJUST: slave nodes are moved onto their master, and it is told how many and how far.
  subroutine adjust(model, journal, error)
    type(model_type), intent(inout) :: model
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    integer :: n_moved
    real(DP) :: largest
    call adjust_slaves(model, n_moved, largest, error)
    if (allocated(error) .or. n_moved == 0) return
    call journal%say('ADJUST moved ' // plural(n_moved, 'node') // ' onto the master, at most by ' // text_of(largest) // '.')
  end subroutine adjust


  !> Goes on from the state of another job.
  subroutine go_on(analysis, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable :: words(:)
    associate (origin => analysis%model%origin)
      call read_state(origin%path, origin%label, words, error)
      if (.not. allocated(error)) call unpack_state(origin%path, words, analysis%model, analysis%snapshot, error)
      if (allocated(error)) return
      if (origin%is_cut) analysis%snapshot%is_step_start = .true.
      call recall_driven(analysis%drive, analysis%model, analysis%snapshot%driven, analysis%snapshot%friction)
      call rollback_analysis(analysis, error)
      if (allocated(error)) return
      call journal%say('The job goes on from increment ' // text_of(origin%label%increment) // ' of step ' // &
        text_of(origin%label%step) // ' in ' // origin%path // ', at time ' // text_of(origin%label%total_time) // '.')
    end associate
  end subroutine go_on


  !> Goes back to the checkpoint.
  subroutine resume(analysis, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    call reopen_files(analysis, error)
    if (allocated(error)) return
    call recall_driven(analysis%drive, analysis%model, analysis%snapshot%driven, analysis%snapshot%friction)
    call rollback_analysis(analysis, error)
    if (allocated(error)) return
    if (analysis%stepper%step == 0) then
      call journal%say('The job goes on from its start.')
    else
      call journal%say('The job goes on after the checkpoint at time ' // text_of(analysis%stepper%total_time) // &
        ' in step ' // text_of(analysis%stepper%step) // '.')
    end if
  end subroutine resume


  !> Threads of the element loop of this job; without OpenMP nothing happens. The number belongs to the calling thread.
  subroutine use_threads(n_threads)
!$  use omp_lib, only: omp_set_num_threads
    integer, intent(in) :: n_threads               !< 0: as many as OpenMP has
    integer :: n
    n = n_threads
    if (n < 1) return
!$  call omp_set_num_threads(n)
  end subroutine use_threads


  !> The head of the log: the version, and how far results are the same when the job is run again.
  subroutine tell_threads(n_threads, journal)
!$  use omp_lib, only: omp_get_max_threads
    integer, intent(in) :: n_threads               !< 0: as many as OpenMP has
    type(journal_type), intent(inout) :: journal
    integer :: n
    n = max(1, n_threads)
!$  n = omp_get_max_threads()
    call journal%say('Amontons ' // VERSION // ' with ' // plural(n, 'thread') // &
      ': run again so, all results are the same to the last bit; with another number of threads, to 1e-10.')
  end subroutine tell_threads


  !> The model's audit on the contact as it stands before the first increment.
  subroutine audit(analysis, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    type(complaints_type) :: report
    character(:), allocatable :: summary
    if (size(analysis%model%steps) == 0) return
    call begin_increment(analysis%system, analysis%model, analysis%model%steps(1), .true., analysis%state)
    call audit_model(analysis%model, analysis%system%contact, analysis%state%new%slaves, report, error)
    call journal%complain(report)
    if (analysis%options%is_check) then
      call audit_summary(analysis%model, analysis%system%contact, analysis%state%new%slaves, summary)
      call journal%say(summary)
    end if
    analysis%at_start = analysis%state%new%slaves
    call restore_state(analysis%state)
  end subroutine audit


  !> One increment, with as many attempts as it takes, committed and written.
  !!
  !! Errors: EXIT_NOT_CONVERGED after the last cut-back, EXIT_SETUP for a step whose constraints contradict each other,
  !! EXIT_SOLVER, EXIT_IO. Every converged increment is on disk.
  subroutine advance_analysis(analysis, journal, is_done, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    logical, intent(out) :: is_done                !< .true.: all steps are done
    type(error_type), allocatable, intent(out) :: error
    integer :: signal
    is_done = is_at_end(analysis)
    if (is_done) return
    analysis%is_trial = .false.
    call solve_increment(analysis, journal, huge(1.0_DP), error)
    if (allocated(error)) return
    call commit_analysis(analysis, journal, error)
    if (allocated(error)) return
    is_done = is_at_end(analysis)
    if (is_done) return
    signal = stop_signal()
    associate (stepper => analysis%stepper)
      if (analysis%options%heeds_signals .and. signal /= 0) then
        call set_error(error, EXIT_NOT_CONVERGED, stop_sentence(analysis))
      else if (.not. analysis%is_step_start .and. &
          stepper%increment > analysis%model%steps(stepper%step)%max_increments) then
        call set_error(error, EXIT_NOT_CONVERGED, 'The step needs more increments than INC on its *STEP card allows. ' // &
          'All converged increments are on disk.')
      end if
    end associate
  end subroutine advance_analysis


  !> One increment, with as many attempts as it takes; it ends at `until` at the latest. Nothing is committed.
  !!
  !! After: without an error the stepper and the committed fields of the state stand at the end of the increment; what
  !! was there at the last commit is in the snapshot. With an error they stand where they stood.
  subroutine solve_increment(analysis, journal, until, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    real(DP), intent(in) :: until                  !< step time [time]
    type(error_type), allocatable, intent(out) :: error
    integer :: verdict
    real(DP) :: dt
    call enter_step(analysis, error)
    if (allocated(error)) return
    if (analysis%is_step_start) call plan_solver(analysis%system, analysis%model, error)
    if (allocated(error)) return
    call tell_solver(analysis, journal)
    associate (step => analysis%model%steps(analysis%stepper%step))
      do
        dt = min(propose_time(analysis%stepper, step), until - analysis%stepper%step_time)
        call begin_trial(analysis, dt, error)
        analysis%newton%may_be_cut = may_cut(analysis%stepper, step, dt)
        if (analysis%newton%may_be_cut .and. analysis%stepper%attempt == 1) call be_patient(analysis%newton%course)
        do
          call iterate_trial(analysis, journal, verdict, error)
          if (allocated(error)) return
          if (analysis%options%heeds_signals) call heed_signals(analysis, journal, verdict, error)
          if (allocated(error)) return
          if (verdict /= VERDICT_GO_ON) exit
        end do
        call tell_solver(analysis, journal)
        if (verdict == VERDICT_CONVERGED) exit
        call give_back(analysis, step, dt, verdict, journal, error)
        if (allocated(error)) return
      end do
    end associate
  end subroutine solve_increment


  !> Says how the equations are solved, where that is worth a word.
  subroutine tell_solver(analysis, journal)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    associate (reduced => analysis%system%reduced)
      if (.not. allocated(reduced%news)) return
      call journal%say(reduced%news)
      deallocate (reduced%news)
    end associate
  end subroutine tell_solver


  !> The next step begins if the last one is done.
  subroutine enter_step(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    if (.not. analysis%is_step_start) return
    if (analysis%stepper%step > 0 .and. analysis%stepper%step_time == 0.0_DP) return   ! it has begun
    call open_step(analysis%stepper, analysis%model%steps(analysis%stepper%step + 1))
    analysis%state%old%total_time = analysis%stepper%total_time   ! a step may set the clock
    call change_model(analysis%model, analysis%stepper%step)
    call bear_elements(analysis%model, analysis%stepper%step, analysis%state)
    call begin_step(analysis%system, analysis%model, analysis%model%steps(analysis%stepper%step), analysis%state, error)
  end subroutine enter_step


  !> An attempt at an increment of length dt begins, from the last converged one.
  subroutine begin_trial(analysis, dt, error)
    type(analysis_type), intent(inout) :: analysis
    real(DP), intent(in) :: dt                     !< [time]
    type(error_type), allocatable, intent(out) :: error
    call enter_step(analysis, error)
    if (allocated(error)) return
    call start_attempt(analysis, dt)
    call begin_newton(analysis%newton, analysis%system, analysis%model, analysis%model%steps(analysis%stepper%step), &
      analysis%is_step_start, analysis%state)
  end subroutine begin_trial


  !> One Newton iteration of the attempt. A converged one is accepted: stepper and state stand at its end.
  subroutine iterate_trial(analysis, journal, verdict, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    integer, intent(out) :: verdict                !< VERDICT_...
    type(error_type), allocatable, intent(out) :: error
    integer :: turn
    associate (step => analysis%model%steps(analysis%stepper%step))
      turn = leave_turn()                            ! other jobs of the process may read, write and tell meanwhile
      call iterate(analysis%newton, analysis%system, analysis%model, step, analysis%state, verdict, error)
      call resume_turn(turn)
      if (.not. allocated(error)) call heed_routines(analysis%model, journal, analysis%pnewdt, error)
      if (allocated(error)) return
      call tell_iteration(analysis, journal)
      if (verdict == VERDICT_CONVERGED) call accept(analysis, step)
    end associate
  end subroutine iterate_trial


  !> A converged attempt: its forces and works are added up, and the trial fields become the ones to go on from.
  subroutine accept(analysis, step)
    type(analysis_type), intent(inout) :: analysis
    type(step_type), intent(in) :: step
    integer :: outcome
    real(DP) :: damped
    associate (record => analysis%records(analysis%n_records))
      record%is_converged = .true.
      record%n_carried = analysis%newton%course%n_carried
      record%n_snapped = analysis%newton%course%n_snapped
      record%story = edge_lines(analysis%model, analysis%state)
      call close_damping(analysis%system%share, step, analysis%state, damped)
      call close_ledger(analysis%model, analysis%state, record, damped)
      call close_record(analysis, record)
      call commit_state(analysis%state)
      call accept_increment(analysis%stepper, step, record%dt, effort_type(record%n_iterations, record%n_unforeseen, &
        record%n_cycles), outcome)
      analysis%is_step_start = outcome == STEP_DONE
    end associate
  end subroutine accept


  !> Commits what was solved since the last commit: the increments go to the files, the fields of the last of them too.
  subroutine commit_analysis(analysis, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: start, now, rate
    integer :: first
    real(DP) :: peak
    call system_clock(start)
    peak = peak_megabytes()
    first = analysis%n_committed + 1
    if (analysis%n_records < first) return
    call note_commit(analysis)
    if (analysis%has_files) then
      !$omp critical (result_files)
      call write_committed(analysis, first, error)
      !$omp end critical (result_files)
    end if
    if (allocated(error)) return
    associate (record => analysis%records(analysis%n_records))
      call system_clock(now, rate)
      record%seconds(PHASE_OUTPUT) = record%seconds(PHASE_OUTPUT) + real(now - start, DP) / real(rate, DP)
      record%megabytes(PHASE_OUTPUT) = record%megabytes(PHASE_OUTPUT) + peak_megabytes() - peak
      call journal%show_increment(record, done_fraction(analysis))
    end associate
  end subroutine commit_analysis


  !> Notes the state as the last commit.
  subroutine note_commit(analysis)
    type(analysis_type), intent(inout) :: analysis
    analysis%n_committed = analysis%n_records
    call take_snapshot(analysis%snapshot, analysis%state, analysis%system, analysis%newton, analysis%stepper, &
      analysis%is_step_start)
    call list_driven(analysis%drive, analysis%model, analysis%snapshot%driven, analysis%snapshot%friction)
  end subroutine note_commit


  !> Everything is as at the last commit, bitwise; what was solved since then is forgotten.
  subroutine rollback_analysis(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    analysis%n_records = analysis%n_committed
    analysis%n_iterations = 0
    call change_model(analysis%model, analysis%snapshot%stepper%step)
    call put_back(analysis%snapshot, analysis%model, analysis%state, analysis%system, analysis%newton, analysis%stepper, &
      analysis%is_step_start, error)
    call recall_amplitudes(analysis%model, analysis%state%old)
  end subroutine rollback_analysis


  !> SIGUSR1: a line that tells where the job is. SIGINT and SIGTERM: the attempt ends here, and with it the job.
  subroutine heed_signals(analysis, journal, verdict, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    integer, intent(in) :: verdict                 !< VERDICT_...
    type(error_type), allocatable, intent(out) :: error
    associate (record => analysis%records(analysis%n_records), newton => analysis%newton%record)
      if (is_status_asked()) call journal%say('Status: step ' // text_of(record%step) // ', increment ' // &
        text_of(record%increment) // ', attempt ' // text_of(record%attempt) // ', iteration ' // &
        text_of(newton%iteration) // ': imbalance ' // text_of(newton%residual) // ' of the largest force, time ' // &
        text_of(record%total_time) // ', ' // text_of(nint(100.0_DP * done_fraction(analysis))) // ' % done.')
      if (stop_signal() == 0 .or. verdict == VERDICT_CONVERGED) return
      record%reason = 'The job was stopped by a signal.'
      call close_record(analysis, record)
      call tell_attempt(analysis, journal)
      call set_error(error, EXIT_NOT_CONVERGED, stop_sentence(analysis))
    end associate
  end subroutine heed_signals


  !> What is told when a signal has stopped the job.
  function stop_sentence(analysis) result(sentence)
    type(analysis_type), intent(in) :: analysis
    character(:), allocatable :: sentence
    integer, parameter :: SIGINT = 2               ! POSIX
    sentence = 'The job was stopped by ' // trim(merge('SIGINT ', 'SIGTERM', stop_signal() == SIGINT)) // &
      ' at time ' // text_of(analysis%stepper%total_time) // '. All converged increments are on disk; amontons ' // &
      '--resume ' // analysis%options%job // ' goes on after them.'
  end function stop_sentence


  !> The trial state starts from the committed one, at the time of the end of the increment; counters start from zero.
  subroutine start_attempt(analysis, dt)
    type(analysis_type), intent(inout) :: analysis
    real(DP), intent(in) :: dt                     !< [time]
    call restore_state(analysis%state)
    analysis%pnewdt = 1.0_DP
    analysis%state%new%step_time = analysis%stepper%step_time + dt
    analysis%state%new%total_time = analysis%stepper%total_time + dt
    analysis%state%new%step = analysis%stepper%step
    analysis%state%new%increment = analysis%stepper%increment
    analysis%state%new%time_increment = dt
    call ask_amplitudes(analysis%model, analysis%state)
    analysis%system%seconds = 0.0_DP
    analysis%system%megabytes = 0.0_DP
    analysis%system%n_factorisations = 0
    analysis%system%n_krylov = 0
    call system_clock(analysis%clock)
    analysis%n_records = analysis%n_records + 1
    if (analysis%n_records > size(analysis%records)) call double(analysis%records)
    analysis%records(analysis%n_records) = increment_record_type(step=analysis%stepper%step, &
      increment=analysis%stepper%increment, attempt=analysis%stepper%attempt, n_cutbacks=analysis%stepper%attempt - 1, &
      dt=dt, step_time=analysis%state%new%step_time, total_time=analysis%state%new%total_time, reason='')
  end subroutine start_attempt


  !> Room for twice as many records.
  subroutine double(records)
    type(increment_record_type), allocatable, intent(inout) :: records(:)
    type(increment_record_type), allocatable :: larger(:)
    allocate (larger(2 * size(records)))
    larger(:size(records)) = records
    call move_alloc(larger, records)
  end subroutine double


  !> Iteration to the screen, to .cvg and to the list for the iteration table; its counts into the record of the attempt.
  subroutine tell_iteration(analysis, journal)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    associate (record => analysis%newton%record, total => analysis%records(analysis%n_records))
      if (record%iteration == 0) return            ! no iteration was completed
      record%step = total%step
      record%increment = total%increment
      record%attempt = total%attempt
      total%n_iterations = record%iteration
      total%n_status = record%n_status
      total%n_scenario = total%n_scenario + record%n_scenario
      total%smallest_step_length = min(total%smallest_step_length, record%step_length)
      total%n_cycles = analysis%newton%n_cycles
      total%n_unforeseen = n_changed_since_first(analysis%newton%forensics)
      total%residual = record%residual
      total%correction = record%correction
      call journal%show_iteration(record)
      analysis%n_iterations = analysis%n_iterations + 1
      if (analysis%n_iterations > size(analysis%iterations)) then
        analysis%iterations = [analysis%iterations, analysis%iterations]
      end if
      analysis%iterations(analysis%n_iterations) = record
      if (analysis%has_files .and. .not. analysis%is_trial) call print_iteration(analysis%printed, record)
    end associate
  end subroutine tell_iteration


  !> A failed attempt: tell it, go back to the committed state, cut back or give up.
  subroutine give_back(analysis, step, dt, verdict, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: dt                     !< [time]
    integer, intent(in) :: verdict                 !< VERDICT_...
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    integer :: outcome
    character(120) :: place
    associate (record => analysis%records(analysis%n_records))
      record%reason = failure_reason(analysis%model, analysis%system, analysis%state, analysis%newton, verdict)
      if (analysis%pnewdt < 1.0_DP) record%reason = 'A user routine asks for a smaller increment: PNEWDT is ' // &
        text_of(analysis%pnewdt) // '.'
      call close_record(analysis, record)
      call reject_increment(analysis%stepper, step, dt, verdict, outcome)
      if (analysis%pnewdt < 1.0_DP .and. outcome == CUT_BACK) analysis%stepper%dt = max(step%dt_min, analysis%pnewdt * dt)
      if (is_free_for_good(analysis%records(:analysis%n_records))) outcome = GIVE_UP
      record%story = failure_lines(analysis%model, analysis%system, analysis%state, analysis%newton, record%reason)
      if (outcome /= CUT_BACK) record%story = [failed_attempts(analysis%records(:analysis%n_records)), record%story]
      call tell_attempt(analysis, journal)
      if (outcome /= CUT_BACK) then
        write (place, '(a,i0,a,i0,a,i0,a,i0,a)') 'Step ', record%step, ', increment ', record%increment, ', attempt ', &
          record%attempt, ', iteration ', record%n_iterations, ': '
        call journal%explain(trim(place) // ' ' // record%reason, record%story)
        call set_error(error, EXIT_NOT_CONVERGED, trim(place) // ' ' // record%reason // trim(merge( &
          ' A smaller increment does not hold it.', ' No smaller increment is allowed.     ', &
          is_free_for_good(analysis%records(:analysis%n_records)))) // ' All converged increments are on disk.')
      end if
    end associate
    call restore_state(analysis%state)
  end subroutine give_back


  !> A failed attempt to the screen and to .sta.
  subroutine tell_attempt(analysis, journal)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    associate (record => analysis%records(analysis%n_records))
      call journal%show_increment(record, done_fraction(analysis))
      if (analysis%has_files .and. .not. analysis%is_trial) call print_increment(analysis%printed, record)
    end associate
  end subroutine tell_attempt


  !> Slip, work and the sums of the forces of a converged increment.
  subroutine close_ledger(model, state, record, damped)
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state
    type(increment_record_type), intent(inout) :: record
    real(DP), intent(in) :: damped                 !< work of damping forces, which are among the applied ones [energy]
    integer :: s
    call commit_slip(state%old, state%new)
    associate (old => state%old, new => state%new, is_abstract => model%mesh%is_abstract)
      call add_inelastic_work(model, old, new)
      new%external_work = old%external_work + 0.5_DP * sum((new%u - old%u) * &
        (old%applied_force + old%reaction_force + new%applied_force + new%reaction_force)) - damped
      record%applied_force = sum(new%applied_force, dim=2, mask=spread(.not. is_abstract, 1, 3))
      record%reaction_force = sum(new%reaction_force, dim=2, mask=spread(.not. is_abstract, 1, 3))
      record%contact_force = sum(new%contact_force, dim=2)
      record%slave_force = 0.0_DP
      do s = 1, size(new%slaves)
        record%slave_force = record%slave_force + new%slaves(s)%force + new%slaves(s)%shear
      end do
      record%external_work = new%external_work
      record%friction_work = new%friction_work
      record%carried_work = new%carried_work
      record%damped_work = new%damped_work
      record%plastic_work = new%plastic_work
      record%carried_now = new%carried_work - old%carried_work
      record%strain_energy = sum(new%energy * new%volume)
      record%contact_energy = sum(new%slaves%energy)
    end associate
  end subroutine close_ledger


  !> Counters and seconds of the attempt.
  subroutine close_record(analysis, record)
    type(analysis_type), intent(in) :: analysis
    type(increment_record_type), intent(inout) :: record
    integer(I64) :: now, rate
    call system_clock(now, rate)
    record%n_factorisations = analysis%system%n_factorisations
    record%n_krylov = analysis%system%n_krylov
    record%seconds = analysis%system%seconds
    record%megabytes = analysis%system%megabytes
    record%seconds(PHASE_OTHER) = max(0.0_DP, real(now - analysis%clock, DP) / real(rate, DP) - sum(record%seconds))
  end subroutine close_record


  !> How much of the time of all steps is done.
  pure real(DP) function done_fraction(analysis) result(fraction)
    type(analysis_type), intent(in) :: analysis
    associate (steps => analysis%model%steps, stepper => analysis%stepper)
      fraction = (sum(steps(:max(0, stepper%step - 1))%period) + stepper%step_time) / sum(steps%period)
    end associate
  end function done_fraction


  !> Closes the files and prints the table. May be called after any error.
  subroutine finish_analysis(analysis, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    if (.not. analysis%is_open) return
    analysis%is_open = .false.
    call journal%show_summary(analysis%records(:analysis%n_records))
    if (.not. analysis%has_files) return
    analysis%has_files = .false.
    !$omp critical (result_files)
    call close_files(analysis, error)
    !$omp end critical (result_files)
  end subroutine finish_analysis


  !> Kernels of the BLAS, and its buffer: OpenBLAS takes it at its first call, and asks for ever if there is no room. It works with
  !! one thread: threads share what is above it, and its own, which wait by asking, would only be in their way.
  subroutine claim_blas(error)
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: kernels
    real(DP) :: values(2), vectors(2, 2)
    integer :: unused
    call choose_blas_kernels(kernels)
    call set_blas_threads(1)
    if (has_memory(BLAS_BUFFER)) then
      call symmetric_eigen(reshape([2.0_DP, 1.0_DP, 1.0_DP, 2.0_DP], [2, 2]), values, vectors, unused)
    else
      call set_error(error, EXIT_SOLVER, 'There is not enough memory to begin: ' // text_of(BLAS_BUFFER) // &
        ' megabytes are wanted.')
    end if
  end subroutine claim_blas


  !> Room for the text of a deck and what is made of it. Asked for at once, so that a lack of memory is told and ends no process.
  subroutine claim_deck(options, error)
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
    call claim('read the deck', COPIES * max(0_I64, n_bytes), error)
  end subroutine claim_deck


  !> Room for what a model of this size has at least beside its factor, which is asked for later: places and entries of the
  !! stiffness and of one more matrix, stresses and histories of three states.
  subroutine claim_matrices(model, error)
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: n_pairs, n_bytes
    integer :: e, n
    associate (mesh => model%mesh)
      n_pairs = 0
      do e = 1, mesh%n_elements
        n = mesh%first(e + 1) - mesh%first(e)
        n_pairs = n_pairs + int(n * (n + 1) / 2, I64)
      end do
      n_bytes = 40 * n_pairs + 3 * 8 * 14 * int(mesh%n_points, I64) + 3 * 8 * 24 * int(mesh%n_nodes, I64)
    end associate
    call claim('solve a model of this size', n_bytes, error)
  end subroutine claim_matrices


  !> Whether so much memory can be had at once. Errors: EXIT_SOLVER.
  subroutine claim(what, n_bytes, error)
    character(*), intent(in) :: what                 !< to follow 'to'
    integer(I64), intent(in) :: n_bytes
    type(error_type), allocatable, intent(out) :: error
    integer(I64), parameter :: MEGABYTE = 1048576
    integer :: megabytes
    megabytes = int(min(n_bytes / MEGABYTE, int(huge(1), I64))) + 1
    if (.not. has_memory(megabytes)) call set_error(error, EXIT_SOLVER, 'There is not enough memory to ' // what // &
      ': at least ' // text_of(megabytes) // ' megabytes are wanted.')
  end subroutine claim

end module amontons_analysis
