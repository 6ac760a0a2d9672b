!> The files of a job: result and text output, checkpoint and restart file, written at each commit.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! All files are written at a commit, from the committed state alone. The checkpoint comes last: at any moment it and the files
!! belong to one commit, or the checkpoint contains the pages that restore the files to that commit. Partitions of the results are
!! written before the file that ties them.
!!
!! Of several ranks the first one writes the result file and the texts, the second one the checkpoint meanwhile, the last one .frd.
module amontons_job_files
  use amontons_failure, only: failure_type
  use amontons_kinds, only: DP, I64
  use amontons_text, only: NEWLINE, to_text, plural
  use amontons_errors, only: error_type, diagnostic_list_type, set_error, EXIT_USAGE, EXIT_IO
  use amontons_model, only: model_type, job_options_type, job_path, DIALECT_CALCULIX
  use amontons_iteration_records, only: increment_record_type, iteration_record_type
  use amontons_state, only: state_type, slave_state_type
  use amontons_equilibrium, only: equilibrium_type
  use amontons_unpaired_contact, only: model_faces_type
  use amontons_newton, only: newton_type
  use amontons_postprocess, only: n_nodal_slaves
  use amontons_increment_control, only: increment_control_type
  use amontons_hdf5_file, only: repair_hdf5
  use amontons_results, only: results_type, open_results, write_model, resume_results, write_increment, write_attempt, &
    write_iteration, close_results, export_result_pages, apply_result_pages, discard_results, &
    is_writing
  use amontons_text_output, only: text_output_type, open_text_output, resume_text_output, print_iteration, print_increment, &
    print_fields, &
    sync_text_output, text_output_lengths, check_text_output, close_text_output
  use amontons_frd_output, only: frd_type, open_frd, is_frd_open, write_frd_mesh, resume_frd, write_frd, frd_file_counts, &
    sync_frd, close_frd
  use amontons_checkpoint, only: snapshot_type, output_lengths_type, checkpoint_draft_type, begin_checkpoint, place_checkpoint, &
    discard_checkpoint, pack_lengths, read_checkpoint, pack_state
  use amontons_restart_file, only: restart_file_type, state_key_type, create_restart_file, reopen_restart_file, append_restart_state
  use amontons_driven_loads, only: driven_loads_type
  use amontons_result_partitions, only: partition_ending
  use amontons_partition_files, only: partition_files_type, divide_results, create_partitions, resume_partitions, &
    write_partition_models, write_partitions, export_partition_pages, apply_partition_pages, close_partitions, discard_partitions
  use amontons_mpi_ranks, only: this_rank, n_ranks, is_first_rank, is_last_rank, min_over_ranks, sum_over_ranks, &
    broadcast_words, share_error
  implicit none
  private
  public :: analysis_type, is_at_end, is_batch, open_files, reopen_files, write_committed, close_files, describe_result_files

  real(DP), parameter :: MAX_CHECKPOINT_SHARE = 0.03_DP     !< largest share of checkpoints in the run time [-]

  !> All data of one job.
  type :: analysis_type
    type(job_options_type) :: options
    type(model_type) :: model
    type(state_type) :: state
    type(slave_state_type), allocatable :: initial_slaves(:)   !< at the start of the first increment: facets and gaps before
                                                               !! anything moves
    type(equilibrium_type) :: system
    type(model_faces_type) :: faces                !< for the search of faces that meet without a pair
    type(failure_type) :: refusal                  !< of the present attempt, which has converged; FAILURE_NONE: none
    real(DP) :: creep_ratio = 0                    !< of it: difference of creep strains over CETOL [-]
    type(newton_type) :: newton
    type(increment_control_type) :: stepping
    type(results_type) :: results
    type(partition_files_type) :: partition_files   !< of this rank
    integer :: n_partitions = 0                     !< that were requested when the job was begun
    type(text_output_type) :: text_output
    type(frd_type) :: frd
    type(restart_file_type) :: restart_file                  !< states written by RESTART, WRITE
    type(driven_loads_type) :: driven_loads                      !< values set by a calling program
    type(diagnostic_list_type) :: diagnostics            !< errors, warnings and notes of the deck
    type(snapshot_type) :: snapshot                !< the last commit
    type(increment_record_type), allocatable :: records(:)   !< all attempts
    integer :: n_records = 0
    integer :: n_committed = 0                     !< records up to the last commit
    logical :: is_open = .false.                   !< the job has started and is not finished
    logical :: has_files = .false.                 !< the ranks have opened the result files
    type(iteration_record_type), allocatable :: iterations(:)   !< those not yet in the result file
    integer :: n_iterations = 0
    real(DP) :: smallest_pnewdt = 1                         !< smallest PNEWDT of user routines in this attempt [-]
    logical :: is_trial = .false.                  !< .sta and .cvg are written at the commit only
    logical :: is_step_start = .true.              !< the next increment is the first of its step
    integer(I64) :: lengths(3) = 0                 !< of .sta, .cvg, .dat at the last commit [bytes]
    integer(I64) :: frd_counts(3) = 0              !< the same for .frd: bytes, frames, blocks
    type(checkpoint_draft_type), allocatable :: draft   !< checkpoint of the last commit that this rank has begun
    logical :: is_guarded = .false.                !< the checkpoint is that of the last commit
    integer(I64) :: checkpoint_clock = 0                !< when the last checkpoint was written
    real(DP) :: checkpoint_seconds = 0                  !< its duration [s]
  end type analysis_type

contains

  !> Whether all steps are done.
  pure logical function is_at_end(analysis)
    type(analysis_type), intent(in) :: analysis
    is_at_end = analysis%options%is_check .or. &
      (analysis%is_step_start .and. analysis%stepping%step >= size(analysis%model%steps))
  end function is_at_end


  !> Whether no program looks at the state between two commits, or returns to the last one: each increment is committed as soon as
  !! it is solved. Then the committed fields are those of the last commit.
  pure logical function is_batch(analysis)
    type(analysis_type), intent(in) :: analysis
    is_batch = analysis%options%handles_signals
  end function is_batch


  !> Opens new result files, and writes the model and the state before the first increment.
  subroutine open_files(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: frd_error
    analysis%n_partitions = analysis%options%n_partitions
    call divide_results(analysis%partition_files, analysis%model, analysis%n_partitions, error)
    if (is_first_rank() .and. .not. allocated(error)) call create_first_files(analysis, error)
    call share_error(error)                        ! of another job's files none is replaced
    if (allocated(error)) return
    call create_partitions(analysis%partition_files, analysis%model, analysis%options, error)
    if (is_last_rank() .and. .not. allocated(error)) call open_frd(analysis%frd, analysis%model, analysis%options, error)
    call share_error(error)
    if (allocated(error)) return
    call write_partition_models(analysis%partition_files, analysis%model, error)
    if (.not. allocated(error)) call write_first(analysis, .true., error)
    call share_error(error)
    if (allocated(error)) return
    !$omp parallel sections num_threads(2) if(has_two_tasks(analysis))
    !$omp section
    if (is_first_rank()) call begin_first_files(analysis, error)
    !$omp section
    call write_frd_mesh(analysis%frd, analysis%model, frd_error)
    !$omp end parallel sections
    if (.not. allocated(error) .and. allocated(frd_error)) call move_alloc(frd_error, error)
    call share_error(error)
    if (allocated(error)) return
    analysis%has_files = .true.
    call share_frd_counts(analysis, .true., error)
    if (.not. allocated(error)) call save_checkpoint(analysis, .false., error)
  end subroutine open_files


  !> Creates those of the first rank.
  subroutine create_first_files(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    call open_results(analysis%results, analysis%model, analysis%options, error, analysis%partition_files%partitions, 0)
    if (allocated(error)) return
    call open_text_output(analysis%text_output, analysis%model, analysis%options, error)
  end subroutine create_first_files


  !> Writes the model and the first frame into them.
  subroutine begin_first_files(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    call write_model(analysis%results, analysis%model, error)
    if (allocated(error)) return
    call write_first(analysis, .false., error)
    if (allocated(error)) return
    if (any(analysis%model%steps%restart_frequency > 0)) call create_restart_file(analysis%restart_file, &
      job_path(analysis%options, '.res'), analysis%model%deck_text, analysis%model%dialect, error)
    call text_output_lengths(analysis%text_output, analysis%lengths)
  end subroutine begin_first_files


  !> What the checkpoint, which the first rank writes, must know of the .frd file of the last rank.
  subroutine share_frd_counts(analysis, is_checkpoint, error)
    type(analysis_type), intent(inout) :: analysis
    logical, intent(in) :: is_checkpoint           !< a checkpoint follows: the file is brought to the disk
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: counts(size(analysis%frd_counts))
    if (is_checkpoint .and. analysis%options%is_guarded) call sync_frd(analysis%frd, error)
    call share_error(error)
    call frd_file_counts(analysis%frd, analysis%frd_counts)
    counts = real(analysis%frd_counts, DP)
    call sum_over_ranks(counts)
    analysis%frd_counts = nint(counts, I64)
  end subroutine share_frd_counts


  !> Writes the frame before the first increment, with the gaps of the model check, which the state does not contain yet: into the
  !! partitions of this rank, or into the result file.
  subroutine write_first(analysis, is_of_partitions, error)
    type(analysis_type), intent(inout) :: analysis
    logical, intent(in) :: is_of_partitions
    type(error_type), allocatable, intent(out) :: error
    type(slave_state_type), allocatable :: kept(:)
    logical :: has_gaps
    has_gaps = allocated(analysis%initial_slaves)
    if (has_gaps) then
      call move_alloc(analysis%state%old%slaves, kept)
      allocate (analysis%state%old%slaves, source=kept)
      analysis%state%old%slaves%facet = analysis%initial_slaves%facet
      analysis%state%old%slaves%gap = analysis%initial_slaves%gap
    end if
    if (is_of_partitions) then
      call write_partitions(analysis%partition_files, analysis%model, analysis%state%old, first_record(analysis), error)
    else
      call write_increment(analysis%results, analysis%model, analysis%state%old, first_record(analysis), error)
    end if
    if (has_gaps) call move_alloc(kept, analysis%state%old%slaves)
  end subroutine write_first


  !> Row of the history before the first increment; a restarted job takes the values of the previous job.
  pure function first_record(analysis) result(record)
    type(analysis_type), intent(in) :: analysis
    type(increment_record_type) :: record
    associate (old => analysis%state%old)
      record = increment_record_type(reason='', step=analysis%stepping%step, step_time=old%step_time, &
        total_time=old%total_time, external_work=old%external_work, friction_work=old%friction_work, &
        stabilization_work=old%stabilization_work, plastic_work=old%plastic_work, &
        kinetic_energy=old%kinetic_energy, integration_loss=old%integration_loss, load_factor=old%load_factor, &
        strain_energy=old%strain_energy)
    end associate
  end function first_record


  !> Restores the checkpoint: result files and snapshot are those of its commit.
  subroutine reopen_files(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    type(output_lengths_type) :: files
    associate (options => analysis%options, model => analysis%model)
      call read_checkpoint(job_path(options, '.restart'), model, analysis%snapshot, files, error)
      if (.not. (allocated(error) .or. files%has_points .or. is_batch(analysis))) call set_error(error, EXIT_IO, 'The job was ' // &
        'done when it was stopped, so that its checkpoint lacks stresses. Resume it by the program, which completes its files.')
      if (.not. allocated(error)) call check_partitions(options%n_partitions, files%n_partitions, error)
      if (allocated(error)) return
      analysis%n_partitions = files%n_partitions
      call divide_results(analysis%partition_files, model, files%n_partitions, error)
      if (.not. allocated(error)) call resume_partitions(analysis%partition_files, model, options, files%partition_pages, error)
      if (allocated(error)) return
      if (is_last_rank()) call resume_frd(analysis%frd, model, options, files%frd, error)
      if (allocated(error)) return
      if (is_first_rank()) call reopen_first_files(analysis, files, error)
      if (allocated(error)) return
      analysis%has_files = .true.
      analysis%is_guarded = .true.
      analysis%lengths = files%lengths
      analysis%frd_counts = files%frd
    end associate
  end subroutine reopen_files


  !> Checks that a job is resumed with the partitions of its files. Errors: EXIT_USAGE.
  subroutine check_partitions(n_requested, n_begun, error)
    integer, intent(in) :: n_requested             !< 0: those of the files
    integer, intent(in) :: n_begun                 !< of the files
    type(error_type), allocatable, intent(out) :: error
    if (n_requested == 0 .or. n_requested == n_begun) return
    if (n_begun == 0) call set_error(error, EXIT_USAGE, 'The job was begun without partitions: resume it without ' // &
      '--partitions.')
    if (n_begun > 0) call set_error(error, EXIT_USAGE, 'The job was begun with --partitions ' // to_text(n_begun) // &
      ': resume it with these, or without the option.')
  end subroutine check_partitions


  !> Reopens those of the first rank.
  subroutine reopen_first_files(analysis, files, error)
    type(analysis_type), intent(inout) :: analysis
    type(output_lengths_type), intent(in) :: files !< at the checkpoint
    type(error_type), allocatable, intent(out) :: error
    associate (options => analysis%options, model => analysis%model)
      call repair_hdf5(job_path(options, '.vtkhdf'), files%pages, error)
      if (allocated(error)) return
      call resume_results(analysis%results, model, n_nodal_slaves(model, analysis%state%old%slaves), options, error, &
        analysis%partition_files%partitions, 0)
      if (allocated(error)) return
      call resume_text_output(analysis%text_output, model, options, files%lengths, error)
      if (allocated(error)) return
      if (any(model%steps%restart_frequency > 0)) call reopen_restart_file(analysis%restart_file, job_path(options, '.res'), &
        files%restart_file, error)
    end associate
  end subroutine reopen_first_files


  !> Writes the iterations and attempts since the last commit, and the fields of the last increment; and the checkpoint, if it is
  !! due.
  subroutine write_committed(analysis, first, error)
    type(analysis_type), intent(inout) :: analysis
    integer, intent(in) :: first                   !< record
    type(error_type), allocatable, intent(out) :: error
    logical :: is_due
    is_due = .false.
    if (is_first_rank()) is_due = is_checkpoint_due(analysis)      ! its clock decides for all
    is_due = min_over_ranks(merge(-1.0_DP, 0.0_DP, is_due)) < 0.0_DP
    if (is_due) is_due = .not. is_finished(analysis)
    call write_increment_files(analysis, first, is_due, error)
    if (.not. allocated(error)) call share_frd_counts(analysis, is_due, error)
    if (allocated(error)) then
      call discard_draft(analysis)
      return
    end if
    call text_output_lengths(analysis%text_output, analysis%lengths)
    analysis%is_guarded = .false.
    if (is_due) call save_checkpoint(analysis, .false., error)
  end subroutine write_committed


  !> All but the end of the checkpoint. Collective; an error of one rank is that of all.
  subroutine write_increment_files(analysis, first, is_due, error)
    type(analysis_type), intent(inout) :: analysis
    integer, intent(in) :: first                   !< record
    logical, intent(in) :: is_due                  !< a checkpoint follows
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: text_error
    if (is_first_rank()) call write_attempts(analysis, first, analysis%n_records - 1, error)
    analysis%n_iterations = 0
    call share_error(error)
    if (allocated(error)) return
    associate (record => analysis%records(analysis%n_records))
      if (allocated(analysis%partition_files%partitions)) then
        call write_partitions(analysis%partition_files, analysis%model, analysis%state%old, record, error)
        call share_error(error)
        if (allocated(error)) return
      end if
      !$omp parallel sections num_threads(2) if(has_two_tasks(analysis))
      !$omp section
      if (is_first_rank()) call write_increment(analysis%results, analysis%model, analysis%state%old, record, error)
      !$omp section
      call write_texts(analysis, record, text_error)
      !$omp end parallel sections
      if (.not. allocated(error) .and. allocated(text_error)) call move_alloc(text_error, error)
      if (.not. allocated(error)) then
        if (is_first_rank()) call keep_state(analysis, record, error)
      end if
    end associate
    if (is_due .and. .not. allocated(error)) call begin_draft(analysis)
    call share_error(error)
  end subroutine write_increment_files


  !> Writes .sta, .cvg, .dat and .frd as far as this rank has opened them; a second thread can compress the result file meanwhile.
  subroutine write_texts(analysis, record, error)
    type(analysis_type), intent(inout) :: analysis
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    call print_increment(analysis%text_output, record)
    call print_fields(analysis%text_output, analysis%model, analysis%state%old, record, error)
    if (.not. allocated(error)) call check_text_output(analysis%text_output, error)
    if (.not. allocated(error)) call write_frd(analysis%frd, analysis%model, analysis%state%old, record, error)
  end subroutine write_texts


  !> Whether there is a kind of file for each of exactly two threads. More threads, and two for the result file alone, share the
  !! compression and conversion of each file.
  logical function has_two_tasks(analysis)
!$  use omp_lib, only: omp_get_max_threads, omp_get_level
    type(analysis_type), intent(in) :: analysis
    has_two_tasks = .false.
!$  if (omp_get_level() == 0) has_two_tasks = omp_get_max_threads() == 2 .and. is_frd_open(analysis%frd)
  end function has_two_tasks


  !> RESTART, WRITE: writes the state of an increment if it is due: every n-th and the last of the step; under the calculix
  !! dialect the last of every n-th step.
  subroutine keep_state(analysis, record, error)
    type(analysis_type), intent(inout) :: analysis
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable :: words(:)
    logical :: is_due, is_calculix
    associate (step => analysis%model%steps(record%step))
      if (step%restart_frequency == 0 .or. .not. allocated(analysis%restart_file%path)) return
      is_calculix = analysis%model%dialect == DIALECT_CALCULIX
      is_due = analysis%is_step_start .or. mod(record%increment, step%restart_frequency) == 0
      if (is_calculix) is_due = analysis%is_step_start .and. mod(record%step, step%restart_frequency) == 0
      if (.not. is_due) return
      call pack_snapshot(analysis, words)
      if (is_calculix .and. step%is_restart_overlay) analysis%restart_file%step = record%step   ! OVERLAY keeps only the last state
      call append_restart_state(analysis%restart_file, state_key_type(step=record%step, increment=record%increment, &
        is_step_done=analysis%is_step_start, step_time=record%step_time, total_time=record%total_time), words, &
        step%is_restart_overlay, error)
    end associate
  end subroutine keep_state


  !> Writes the iterations that are not in the file, and some attempts without their fields.
  subroutine write_attempts(analysis, first, last, error)
    type(analysis_type), intent(inout) :: analysis
    integer, intent(in) :: first, last             !< records
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    do i = 1, analysis%n_iterations
      if (analysis%is_trial) call print_iteration(analysis%text_output, analysis%iterations(i))
      call write_iteration(analysis%results, analysis%iterations(i), error)
      if (allocated(error)) return
    end do
    do i = first, last
      if (analysis%is_trial .or. analysis%records(i)%is_converged) then   ! the others were written when they failed
        call print_increment(analysis%text_output, analysis%records(i))
      end if
      call write_attempt(analysis%results, analysis%records(i), error)
      if (allocated(error)) return
    end do
  end subroutine write_attempts


  !> Whether a checkpoint is due: at each commit unless it would exceed MAX_CHECKPOINT_SHARE of the run time. At the end
  !! of a step it is always due.
  logical function is_checkpoint_due(analysis)
    type(analysis_type), intent(in) :: analysis
    integer(I64) :: now, rate
    call system_clock(now, rate)
    is_checkpoint_due = analysis%is_step_start .or. &
      MAX_CHECKPOINT_SHARE * real(now - analysis%checkpoint_clock, DP) / real(rate, DP) >= analysis%checkpoint_seconds
  end function is_checkpoint_due


  !> Whether a batch job has done all its steps and its checkpoint will not be needed: it is written once, as the files are closed,
  !! for their pages, without values at points.
  !! (A program that calls the library may read the result file before it closes the job.)
  logical function is_finished(analysis)
    type(analysis_type), intent(in) :: analysis
    is_finished = is_at_end(analysis) .and. analysis%n_committed == analysis%n_records .and. &
      is_batch(analysis) .and. .not. analysis%model%keeps_checkpoint
  end function is_finished


  !> Writes the checkpoint, then updates the result files, partitions first: at any moment either the result files match the
  !! checkpoint, or the checkpoint contains the pages that make them match. Collective; an error of one rank is that of all.
  subroutine save_checkpoint(analysis, is_old, error)
    type(analysis_type), intent(inout) :: analysis
    logical, intent(in) :: is_old                  !< .true.: the pages restore the last commit
    type(error_type), allocatable, intent(out) :: error
    type(output_lengths_type) :: files
    integer(I64) :: start, rate
    if (.not. analysis%options%is_guarded) return
    call system_clock(start)
    call begin_draft(analysis)
    files%n_partitions = analysis%n_partitions
    call export_partition_pages(analysis%partition_files, is_old, files%partition_pages, error)
    if (is_first_rank() .and. .not. allocated(error)) then
      call export_result_pages(analysis%results, is_old, files%pages, error)
      if (.not. (allocated(error) .or. is_old)) call sync_text_output(analysis%text_output, error)
      files%lengths = analysis%lengths
      files%frd = analysis%frd_counts
      files%restart_file = [analysis%restart_file%last, analysis%restart_file%end, int(analysis%restart_file%step, I64)]
    end if
    call share_error(error)
    if (.not. allocated(error)) call complete_draft(analysis, files, error)
    call discard_draft(analysis)
    call share_error(error)
    if (.not. allocated(error)) call apply_partition_pages(analysis%partition_files, error)
    call share_error(error)
    if (is_first_rank() .and. .not. allocated(error)) call apply_result_pages(analysis%results, error)
    call share_error(error)
    if (allocated(error)) call discard_files(analysis)
    analysis%is_guarded = .not. allocated(error)
    call system_clock(analysis%checkpoint_clock, rate)
    analysis%checkpoint_seconds = real(analysis%checkpoint_clock - start, DP) / real(rate, DP)
  end subroutine save_checkpoint


  !> Closes the result files of this rank; pages that were not applied are lost.
  subroutine discard_files(analysis)
    type(analysis_type), intent(inout) :: analysis
    call discard_partitions(analysis%partition_files)
    call discard_results(analysis%results)
  end subroutine discard_files


  !> The second rank, if there are several, begins the checkpoint of the last commit, unless it has done so.
  subroutine begin_draft(analysis)
    type(analysis_type), intent(inout) :: analysis
    character(:), allocatable :: path
    logical :: has_points
    integer :: rank, writer
    rank = this_rank()
    writer = min(1, n_ranks() - 1)
    if (.not. analysis%options%is_guarded .or. allocated(analysis%draft) .or. rank /= writer) return
    path = job_path(analysis%options, '.restart')
    has_points = .not. is_finished(analysis)
    allocate (analysis%draft)
    if (is_batch(analysis)) then
      call begin_checkpoint(analysis%draft, path, analysis%model, analysis%snapshot, has_points, analysis%state%old)
    else
      call begin_checkpoint(analysis%draft, path, analysis%model, analysis%snapshot, has_points)
    end if
  end subroutine begin_draft


  !> It appends the lengths of the first rank and puts the checkpoint in its place.
  subroutine complete_draft(analysis, files, error)
    type(analysis_type), intent(inout) :: analysis
    type(output_lengths_type), intent(inout) :: files   !< not changed
    type(error_type), allocatable, intent(out) :: error
    integer(I64), allocatable :: words(:)
    if (is_first_rank()) call pack_lengths(files, words)
    call broadcast_words(words, 0)
    if (.not. allocated(analysis%draft)) return
    call place_checkpoint(analysis%draft, words, error)
    deallocate (analysis%draft)
  end subroutine complete_draft


  !> Removes a checkpoint that this rank has begun and not placed.
  subroutine discard_draft(analysis)
    type(analysis_type), intent(inout) :: analysis
    if (.not. allocated(analysis%draft)) return
    call discard_checkpoint(analysis%draft)
    deallocate (analysis%draft)
  end subroutine discard_draft


  !> Packs the last commit into words.
  subroutine pack_snapshot(analysis, words)
    type(analysis_type), intent(inout) :: analysis
    integer(I64), allocatable, intent(out) :: words(:)
    if (is_batch(analysis)) then
      call pack_state(analysis%model, analysis%snapshot, words, analysis%state%old)
    else
      call pack_state(analysis%model, analysis%snapshot, words)
    end if
  end subroutine pack_snapshot


  !> Writes the attempts that failed since the last commit and closes the files. The checkpoint then contains the pages that
  !! restore the last commit; a finished job needs none.
  subroutine close_files(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: frd_error
    integer :: unit, status
    logical :: is_open
    call share_frd_counts(analysis, .true., error)
    if (.not. allocated(error)) call check_text_output(analysis%text_output, error)
    call share_error(error)
    is_open = .false.
    if (is_first_rank()) is_open = is_writing(analysis%results)
    is_open = min_over_ranks(merge(-1.0_DP, 0.0_DP, is_open)) < 0.0_DP
    if (is_open .and. .not. allocated(error)) call close_result_files(analysis, error)
    call close_text_output(analysis%text_output)
    call close_frd(analysis%frd, frd_error)
    if (.not. allocated(error)) call move_alloc(frd_error, error)
    if (allocated(error) .or. .not. analysis%options%is_guarded) return
    if (.not. is_first_rank()) return
    if (.not. is_at_end(analysis) .or. analysis%model%keeps_checkpoint) return
    open (newunit=unit, file=job_path(analysis%options, '.restart'), status='old', iostat=status)
    if (status == 0) close (unit, status='delete')
  end subroutine close_files


  !> Closes the result files: checkpoint of the last commit, failed attempts since then, end mark, and pages to restore the commit.
  !! Collective.
  subroutine close_result_files(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    if (is_finished(analysis) .and. .not. analysis%is_guarded) then
      call end_result_files(analysis, error)
      if (.not. allocated(error)) call save_checkpoint(analysis, .false., error)
      call discard_files(analysis)
      return
    end if
    if (.not. analysis%is_guarded) call save_checkpoint(analysis, .false., error)
    if (allocated(error)) return
    if (is_first_rank()) call write_attempts(analysis, analysis%n_committed + 1, analysis%n_records, error)
    call share_error(error)
    if (.not. allocated(error)) call end_result_files(analysis, error)
    if (.not. allocated(error)) call save_checkpoint(analysis, .true., error)
    call discard_files(analysis)
  end subroutine close_result_files


  !> Closes the partitions, then the result file; the last pages of guarded files remain in memory. Collective.
  subroutine end_result_files(analysis, error)
    type(analysis_type), intent(inout) :: analysis
    type(error_type), allocatable, intent(out) :: error
    call close_partitions(analysis%partition_files, error)
    call share_error(error)
    if (is_first_rank() .and. .not. allocated(error)) call close_results(analysis%results, error)
    call share_error(error)
  end subroutine end_result_files


  !> Two lines for the end of a job: its result files, and the command for its report page.
  function describe_result_files(analysis) result(text)
    type(analysis_type), intent(in) :: analysis    !< with result files
    character(:), allocatable :: text
    character(:), allocatable :: fields
    fields = job_path(analysis%options, '.vtkhdf')
    text = '  result files:  ' // fields // '  ' // job_path(analysis%options, '.sta') // '  ' // job_path(analysis%options, '.cvg')
    if (allocated(analysis%partition_files%partitions)) text = text // NEWLINE // '                 fields in ' // &
      plural(size(analysis%partition_files%partitions), 'file') // ' ' // job_path(analysis%options, trim(partition_ending(1))) // &
      ', ...'
    if (analysis%lengths(3) > 0) text = text // '  ' // job_path(analysis%options, '.dat')
    if (analysis%frd_counts(1) > 0) text = text // '  ' // job_path(analysis%options, '.frd')
    if (allocated(analysis%restart_file%path)) text = text // '  ' // analysis%restart_file%path
    text = text // NEWLINE // '  report page:   make report JOB=' // fields // '   (installed: amontons-report ' // fields // ')'
  end function describe_result_files

end module amontons_job_files
