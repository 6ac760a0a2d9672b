!> Analysis: the job in three verbs: start, advance by one increment, finish.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_analysis
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, complaints_type, set_error, EXIT_NOT_CONVERGED
  use amontons_journal, only: journal_type
  use amontons_model, only: model_type, job_options_type
  use amontons_steps, only: step_type
  use amontons_history, only: increment_record_type, PHASE_OUTPUT, PHASE_OTHER, N_PHASES
  use amontons_factor, only: set_blas_threads
  use amontons_deck, only: read_deck
  use amontons_state, only: state_type, commit_state, restore_state
  use amontons_contact, only: commit_slip
  use amontons_system, only: system_type, create_system, begin_step, begin_increment
  use amontons_audit, only: audit_model, audit_summary
  use amontons_converge, only: VERDICT_GO_ON, VERDICT_CONVERGED
  use amontons_newton, only: newton_type, begin_newton, iterate
  use amontons_stepper, only: stepper_type, open_step, propose_time, accept_increment, reject_increment, &
    STEP_DONE, STEP_OUT_OF_INCREMENTS, CUT_BACK
  use amontons_failure, only: failure_reason, failure_lines
  use amontons_results, only: results_type, open_results, write_increment, write_attempt, write_iteration, close_results
  use amontons_printed, only: printed_type, open_printed, print_iteration, print_increment, print_fields, close_printed
  implicit none
  private
  public :: analysis_type, start_analysis, advance_analysis, finish_analysis

  !> One job: nothing of it lives outside.
  type :: analysis_type
    type(job_options_type) :: options
    type(model_type) :: model
    type(state_type) :: state
    type(system_type) :: system
    type(newton_type) :: newton
    type(stepper_type) :: stepper
    type(results_type) :: results
    type(printed_type) :: printed
    type(increment_record_type), allocatable :: records(:)   !< all attempts
    integer :: n_records = 0
    logical :: is_open = .false.                   !< result files are open
    logical :: is_step_start = .true.              !< the next increment is the first of its step
    integer(I64) :: clock = 0                      !< when the attempt began
    real(DP) :: output_seconds = 0                 !< spent on the files since the last record [s]
  end type analysis_type

contains

  !> Reads the deck, builds and audits the system, and opens the result files. With --check it stops before the files.
  !!
  !! Errors: EXIT_DECK, EXIT_SETUP (nothing has been written), EXIT_IO, EXIT_SOLVER.
  subroutine start_analysis(analysis, options, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(job_options_type), intent(in) :: options
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    type(complaints_type) :: complaints
    analysis%options = options
    allocate (analysis%records(64))
    call set_blas_threads(options%n_threads)
    !$ call omp_set_num_threads_of(options%n_threads)
    call read_deck(options, analysis%model, complaints, error)
    call journal%complain(complaints)
    if (allocated(error)) return
    call create_system(analysis%system, analysis%model, analysis%state, error)
    if (allocated(error)) return
    call audit(analysis, journal, error)
    if (allocated(error) .or. options%is_check) return
    call open_results(analysis%results, analysis%model, options, error)
    if (allocated(error)) return
    call open_printed(analysis%printed, analysis%model, options, error)
    if (allocated(error)) return
    analysis%is_open = .true.
    call write_increment(analysis%results, analysis%model, analysis%state%old, increment_record_type(reason=''), error)
  end subroutine start_analysis


  !> Threads of the element loop; without OpenMP nothing happens.
  subroutine omp_set_num_threads_of(n_threads)
    !$ use omp_lib, only: omp_set_num_threads
    integer, intent(in) :: n_threads
    integer :: n
    n = n_threads
    !$ call omp_set_num_threads(n)
    if (n < 1) return
  end subroutine omp_set_num_threads_of


  !> The model's audit on the contact as it stands before the first increment.
  subroutine audit(analysis, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    type(complaints_type) :: report
    type(state_type) :: first
    character(:), allocatable :: summary
    if (size(analysis%model%steps) == 0) return
    first = analysis%state
    call begin_increment(analysis%system, analysis%model, analysis%model%steps(1), .true., first)
    call audit_model(analysis%model, analysis%system%contact, first%new%slaves, report, error)
    call journal%complain(report)
    if (analysis%options%is_check) then
      call audit_summary(analysis%model, analysis%system%contact, first%new%slaves, summary)
      call journal%say(summary)
    end if
  end subroutine audit


  !> One increment, with as many attempts as it takes.
  !!
  !! Errors: EXIT_NOT_CONVERGED after the last cut-back, EXIT_SETUP for a step whose constraints contradict each other,
  !! EXIT_SOLVER, EXIT_IO. Every converged increment is on disk.
  subroutine advance_analysis(analysis, journal, is_done, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    logical, intent(out) :: is_done                !< .true.: all steps are done
    type(error_type), allocatable, intent(out) :: error
    integer :: verdict, outcome
    real(DP) :: dt
    is_done = analysis%options%is_check .or. size(analysis%model%steps) == 0
    if (is_done) return
    if (analysis%is_step_start .and. analysis%stepper%step < size(analysis%model%steps)) then
      call open_step(analysis%stepper, analysis%model%steps(analysis%stepper%step + 1))
      call begin_step(analysis%system, analysis%model, analysis%model%steps(analysis%stepper%step), analysis%state, error)
      if (allocated(error)) return
    end if
    associate (step => analysis%model%steps(analysis%stepper%step))
      do
        dt = propose_time(analysis%stepper, step)
        call attempt(analysis, step, dt, journal, verdict, error)
        if (allocated(error)) return
        if (verdict == VERDICT_CONVERGED) exit
        call give_back(analysis, step, dt, verdict, journal, error)
        if (allocated(error)) return
      end do
      call keep(analysis, step, dt, journal, outcome, error)
    end associate
    if (allocated(error)) return
    analysis%is_step_start = outcome == STEP_DONE
    is_done = outcome == STEP_DONE .and. analysis%stepper%step == size(analysis%model%steps)
    if (outcome == STEP_OUT_OF_INCREMENTS) call set_error(error, EXIT_NOT_CONVERGED, 'The step needs more increments ' // &
      'than INC on its *STEP card allows. All converged increments are on disk.')
  end subroutine advance_analysis


  !> One attempt at an increment of length dt: Newton until a verdict.
  subroutine attempt(analysis, step, dt, journal, verdict, error)
    type(analysis_type), intent(inout) :: analysis
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: dt                     !< [time]
    type(journal_type), intent(inout) :: journal
    integer, intent(out) :: verdict                !< VERDICT_...
    type(error_type), allocatable, intent(out) :: error
    call start_attempt(analysis, dt)
    call begin_newton(analysis%newton, analysis%system, analysis%model, step, analysis%is_step_start, analysis%state)
    do
      call iterate(analysis%newton, analysis%system, analysis%model, step, analysis%state, verdict, error)
      if (allocated(error)) return
      call tell_iteration(analysis, journal, error)
      if (allocated(error)) return
      if (verdict /= VERDICT_GO_ON) exit
    end do
  end subroutine attempt


  !> The trial state starts from the committed one, at the time of the end of the increment; counters start from zero.
  subroutine start_attempt(analysis, dt)
    type(analysis_type), intent(inout) :: analysis
    real(DP), intent(in) :: dt                     !< [time]
    call restore_state(analysis%state)
    analysis%state%new%step_time = analysis%stepper%step_time + dt
    analysis%state%new%total_time = analysis%stepper%total_time + dt
    analysis%system%seconds = 0.0_DP
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


  !> Iteration to the screen, .cvg and the iteration table; its counts into the record of the attempt.
  subroutine tell_iteration(analysis, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    associate (record => analysis%newton%record, total => analysis%records(analysis%n_records))
      if (record%iteration == 0) return            ! no iteration was completed
      record%step = total%step
      record%increment = total%increment
      record%attempt = total%attempt
      total%n_iterations = record%iteration
      total%n_status = record%n_status
      total%n_scenario = total%n_scenario + record%n_scenario
      total%smallest_step_length = min(total%smallest_step_length, record%step_length)
      total%residual = record%residual
      total%correction = record%correction
      call journal%show_iteration(record)
      call print_iteration(analysis%printed, record)
      call write_iteration(analysis%results, record, error)
    end associate
  end subroutine tell_iteration


  !> A converged attempt is committed and written.
  subroutine keep(analysis, step, dt, journal, outcome, error)
    type(analysis_type), intent(inout) :: analysis
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: dt                     !< [time]
    type(journal_type), intent(inout) :: journal
    integer, intent(out) :: outcome                !< STEP_...
    type(error_type), allocatable, intent(out) :: error
    logical :: is_due
    associate (record => analysis%records(analysis%n_records), stepper => analysis%stepper, state => analysis%state)
      record%is_converged = .true.
      call close_ledger(state, record)
      call close_record(analysis, record)
      call commit_state(state)
      call accept_increment(stepper, step, dt, record%n_iterations, outcome)
      is_due = outcome /= 0 .or. is_multiple(record%increment, step%file_frequency)
      if (is_due) then
        call write_increment(analysis%results, analysis%model, state%old, record, error)
      else
        call write_attempt(analysis%results, record, error)
      end if
      if (allocated(error)) return
      call print_increment(analysis%printed, record)
      if (outcome /= 0 .or. is_multiple(record%increment, step%print_frequency)) &
        call print_fields(analysis%printed, analysis%model, state%old, record, error)
      if (allocated(error)) return
      call journal%show_increment(record, done_fraction(analysis))
    end associate
  end subroutine keep


  !> Whether an increment is due by a FREQUENCY; 0 means never.
  pure logical function is_multiple(increment, frequency)
    integer, intent(in) :: increment, frequency
    is_multiple = .false.
    if (frequency > 0) is_multiple = mod(increment, frequency) == 0
  end function is_multiple


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
      record%reason = failure_reason(analysis%model, analysis%system, analysis%newton, verdict)
      call close_record(analysis, record)
      call write_attempt(analysis%results, record, error)
      if (allocated(error)) return
      call print_increment(analysis%printed, record)
      call journal%show_increment(record, done_fraction(analysis))
      call reject_increment(analysis%stepper, step, dt, verdict, outcome)
      if (outcome /= CUT_BACK) then
        write (place, '(a,i0,a,i0,a,i0,a,i0,a)') 'Step ', record%step, ', increment ', record%increment, ', attempt ', &
          record%attempt, ', iteration ', record%n_iterations, ': '
        call journal%explain(trim(place) // ' ' // record%reason, &
          failure_lines(analysis%model, analysis%system, analysis%state, analysis%newton))
        call set_error(error, EXIT_NOT_CONVERGED, trim(place) // ' ' // record%reason // &
          ' No smaller increment is allowed. All converged increments are on disk.')
      end if
    end associate
    call restore_state(analysis%state)
  end subroutine give_back


  !> Slip, work and the sums of the forces of a converged increment.
  subroutine close_ledger(state, record)
    type(state_type), intent(inout) :: state
    type(increment_record_type), intent(inout) :: record
    integer :: s
    call commit_slip(state%old, state%new)
    associate (old => state%old, new => state%new)
      new%external_work = old%external_work + 0.5_DP * sum((new%u - old%u) * &
        (old%applied_force + old%reaction_force + new%applied_force + new%reaction_force))
      record%applied_force = sum(new%applied_force, dim=2)
      record%reaction_force = sum(new%reaction_force, dim=2)
      record%contact_force = sum(new%contact_force, dim=2)
      record%slave_force = 0.0_DP
      do s = 1, size(new%slaves)
        record%slave_force = record%slave_force + new%slaves(s)%force + new%slaves(s)%shear
      end do
      record%external_work = new%external_work
      record%friction_work = new%friction_work
      record%strain_energy = sum(new%energy * new%volume)
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
    record%seconds(PHASE_OTHER) = max(0.0_DP, real(now - analysis%clock, DP) / real(rate, DP) - sum(record%seconds))
  end subroutine close_record


  !> How much of the time of all steps is done.
  pure real(DP) function done_fraction(analysis) result(fraction)
    type(analysis_type), intent(in) :: analysis
    fraction = analysis%stepper%total_time / sum(analysis%model%steps%period)
  end function done_fraction


  !> Closes the files and prints the table. May be called after any error.
  subroutine finish_analysis(analysis, journal, error)
    type(analysis_type), intent(inout) :: analysis
    type(journal_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    if (.not. analysis%is_open) return
    analysis%is_open = .false.
    call journal%show_summary(analysis%records(:analysis%n_records))
    call close_printed(analysis%printed)
    call close_results(analysis%results, error)
  end subroutine finish_analysis

end module amontons_analysis
