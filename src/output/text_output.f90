!> The text files job.sta and job.cvg (one line per attempt and iteration), and the handling of job.dat.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The columns are those of CalculiX, so that programs for its files can read them; additional columns follow on the right.
!! Each line of .sta and .cvg is flushed, since such programs monitor the files while the job runs.
module amontons_text_output
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_posix, only: truncate_file, sync_file
  use amontons_steps, only: is_output_due
  use amontons_model, only: job_options_type, job_path, model_type
  use amontons_iteration_records, only: increment_record_type, iteration_record_type
  use amontons_state, only: fields_type
  use amontons_dat_output, only: print_request
  implicit none
  private
  public :: text_output_type, open_text_output, resume_text_output, sync_text_output, text_output_lengths, check_text_output, &
    print_iteration, &
    print_increment, print_fields, close_text_output

  !> The text files of a job. Unit 0: not open.
  type :: text_output_type
    private
    integer :: sta = 0
    integer :: cvg = 0
    integer :: dat = 0
    character(:), allocatable :: sta_path, cvg_path, dat_path
    integer :: status = 0                    !< of the first line that could not be written
  end type text_output_type

contains

  !> Opens job.sta and job.cvg with their head lines, and job.dat if a step has PRINT cards.
  subroutine open_text_output(output, model, options, error)
    type(text_output_type), intent(out) :: output
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    output%sta_path = job_path(options, '.sta')
    call open_text(output%sta_path, output%sta, error)
    if (allocated(error)) return
    write (output%sta, '(a)', iostat=status) 'SUMMARY OF JOB INFORMATION', &
      '  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME' // &
      '    OPEN  STICK   SLIP      S-I     S-II    S-III     S-IV  CUT  FACT  KRYLOV   RESIDUAL  CORRECTION         LPF'
    if (output%status == 0) output%status = status
    call flush_unit(output, output%sta)
    output%cvg_path = job_path(options, '.cvg')
    call open_text(output%cvg_path, output%cvg, error)
    if (allocated(error)) return
    write (output%cvg, '(a)', iostat=status) 'SUMMARY OF C0NVERGENCE INFORMATION', &
      '  STEP   INC  ATT   ITER     CONT.   RESID.        CORR.      RESID.      CORR.' // &
      '    OPEN  STICK   SLIP    S-I   S-II  S-III   S-IV OPENED CLOSED KRYLOV       STEP        WORST BALANC ROUNDS', &
      '                              EL.    FORCE         DISP       FLUX        TEMP.' // &
      '                                                                      LENGTH          GAP', &
      '                              (#)     (%)           (%)        (%)         (%)' // &
      '     (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)         (-)     (LENGTH)'
    if (output%status == 0) output%status = status
    call flush_unit(output, output%cvg)
    if (.not. has_prints(model)) return
    output%dat_path = job_path(options, '.dat')
    call open_text(output%dat_path, output%dat, error)
  end subroutine open_text_output


  !> Reopens the files of a job resumed from a checkpoint, each truncated to its length then.
  subroutine resume_text_output(output, model, options, lengths, error)
    type(text_output_type), intent(out) :: output
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    integer(I64), intent(in) :: lengths(3)         !< of .sta, .cvg, .dat [bytes]
    type(error_type), allocatable, intent(out) :: error
    output%sta_path = job_path(options, '.sta')
    call reopen_text(output%sta_path, lengths(1), output%sta, error)
    if (allocated(error)) return
    output%cvg_path = job_path(options, '.cvg')
    call reopen_text(output%cvg_path, lengths(2), output%cvg, error)
    if (allocated(error) .or. .not. has_prints(model)) return
    output%dat_path = job_path(options, '.dat')
    call reopen_text(output%dat_path, lengths(3), output%dat, error)
  end subroutine resume_text_output


  !> Synchronizes the files with the disk.
  subroutine sync_text_output(output, error)
    type(text_output_type), intent(in) :: output
    type(error_type), allocatable, intent(out) :: error
    call check_text_output(output, error)
    if (.not. allocated(error) .and. output%sta /= 0) call sync_file(output%sta_path, error)
    if (.not. allocated(error) .and. output%cvg /= 0) call sync_file(output%cvg_path, error)
    if (.not. allocated(error) .and. output%dat /= 0) call sync_file(output%dat_path, error)
  end subroutine sync_text_output


  !> Current lengths of the files.
  subroutine text_output_lengths(output, lengths)
    type(text_output_type), intent(inout) :: output
    integer(I64), intent(out) :: lengths(3)        !< of .sta, .cvg, .dat; 0 if not open [bytes]
    lengths = 0
    call unit_length(output%sta, lengths(1))
    call unit_length(output%cvg, lengths(2))
    call unit_length(output%dat, lengths(3))

  contains

    !> Length of one file.
    subroutine unit_length(unit, length)
      integer, intent(in) :: unit
      integer(I64), intent(inout) :: length
      if (unit == 0) return
      call flush_unit(output, unit)
      inquire (unit=unit, size=length)
    end subroutine unit_length

  end subroutine text_output_lengths


  !> Sets an error if a line could not be written since the files were opened: a full disk.
  subroutine check_text_output(output, error)
    type(text_output_type), intent(in) :: output
    type(error_type), allocatable, intent(out) :: error
    if (output%status /= 0) call set_error(error, EXIT_IO, 'Cannot write the file ' // output%sta_path // ' or ' // &
      'the .cvg or .dat beside it (is the disk full?).')
  end subroutine check_text_output


  !> Closes a file; stores the first error status.
  subroutine close_text(output, unit)
    type(text_output_type), intent(inout) :: output
    integer, intent(in) :: unit
    integer :: status
    if (unit == 0) return
    close (unit, iostat=status)
    if (output%status == 0) output%status = status
  end subroutine close_text


  !> Whether a step has PRINT cards.
  pure logical function has_prints(model)
    type(model_type), intent(in) :: model
    integer :: i
    has_prints = .false.
    do i = 1, size(model%steps)
      if (allocated(model%steps(i)%prints)) has_prints = has_prints .or. size(model%steps(i)%prints) > 0
    end do
  end function has_prints


  !> Flushes a file; stores the first error status.
  subroutine flush_unit(output, unit)
    type(text_output_type), intent(inout) :: output
    integer, intent(in) :: unit
    integer :: status
    flush (unit, iostat=status)
    if (output%status == 0) output%status = status
  end subroutine flush_unit


  !> Opens a text file to append after a given length.
  subroutine reopen_text(path, length, unit, error)
    character(*), intent(in) :: path
    integer(I64), intent(in) :: length             !< [bytes]
    integer, intent(out) :: unit
    type(error_type), allocatable, intent(out) :: error
    character(200) :: reason
    integer :: status
    unit = 0
    call truncate_file(path, length, error)
    if (allocated(error)) return
    open (newunit=unit, file=path, status='old', action='write', form='formatted', position='append', iostat=status, &
      iomsg=reason)
    if (status == 0) return
    unit = 0
    call set_error(error, EXIT_IO, 'Cannot open the file ' // path // ': ' // trim(reason) // '.')
  end subroutine reopen_text


  !> Creates a text file, or empties it if it exists.
  subroutine open_text(path, unit, error)
    character(*), intent(in) :: path
    integer, intent(out) :: unit
    type(error_type), allocatable, intent(out) :: error
    character(200) :: reason
    integer :: status
    open (newunit=unit, file=path, status='replace', action='write', form='formatted', iostat=status, iomsg=reason)
    if (status == 0) return
    unit = 0
    call set_error(error, EXIT_IO, 'Cannot create the file ' // path // ': ' // trim(reason) // '.')
  end subroutine open_text


  !> Writes a line of .cvg. Residual and correction are in per cent, as in CalculiX.
  subroutine print_iteration(output, record)
    type(text_output_type), intent(inout) :: output
    type(iteration_record_type), intent(in) :: record
    integer :: status
    if (output%cvg == 0) return
    write (output%cvg, '(2x,i4,2x,i4,2x,i4,2x,i4,2x,i7,4(1x,e11.4),3(1x,i6),4(1x,i6),3(1x,i6),2(1x,e12.5),2(1x,i6))', &
      iostat=status) &
      record%step, record%increment, record%attempt, record%iteration, record%n_closed, 100 * record%residual, &
      100 * record%correction, 0.0_DP, 0.0_DP, record%n_status, record%n_scenario, record%n_newly_opened, &
      record%n_newly_closed, record%n_krylov, record%step_length, record%max_gap_error, record%n_slip_converged, &
      record%n_subproblem_iterations
    if (output%status == 0) output%status = status
    call flush_unit(output, output%cvg)
  end subroutine print_iteration


  !> Writes a line of .sta; a failed attempt has a U after its number and the times of its start.
  subroutine print_increment(output, record)
    type(text_output_type), intent(inout) :: output
    type(increment_record_type), intent(in) :: record
    character(*), parameter :: EXTRA_FORMAT = '3(1x,i6),4(1x,i8),1x,i4,1x,i5,1x,i7,2(1x,e11.4),a)'
    real(DP) :: back
    integer :: status
    character(:), allocatable :: form
    character(14) :: load_factor                   ! of a RIKS step
    if (output%sta == 0) return
    load_factor = ''
    if (record%is_riks) write (load_factor, '(1x,e13.6)') record%load_factor
    if (record%is_converged) then
      form = '(1x,i5,1x,i10,2(1x,i5),3(1x,e13.6),' // EXTRA_FORMAT
      back = 0
    else
      form = '(1x,i5,1x,i10,1x,i5,''U'',1x,i4,3(1x,e13.6),' // EXTRA_FORMAT
      back = record%dt
    end if
    write (output%sta, form, iostat=status) record%step, record%increment, record%attempt, record%n_iterations, &
      record%total_time - back, record%step_time - back, record%dt, record%n_status, record%n_scenario, &
      record%n_cutbacks, record%n_factorisations, record%n_krylov, record%residual, record%correction, &
      trim(load_factor)
    if (output%status == 0) output%status = status
    call flush_unit(output, output%sta)
    if (output%cvg /= 0) call print_attempt_notes(output, record)
    call flush_unit(output, output%cvg)
  end subroutine print_increment


  !> Writes notes below the iterations of an attempt: active-set cycles, proximal steps, cause of failure.
  subroutine print_attempt_notes(output, record)
    type(text_output_type), intent(inout) :: output
    type(increment_record_type), intent(in) :: record
    character(:), allocatable :: words
    integer :: status, i
    status = 0
    if (record%n_cycles_treated > 0) &
      write (output%cvg, '(a,i0)', iostat=status) '  ** active-set cycles treated: ', record%n_cycles_treated
    if (output%status == 0) output%status = status
    if (.not. record%is_converged .and. allocated(record%reason)) &
      write (output%cvg, '(2a)', iostat=status) '  ** ', record%reason
    if (output%status == 0) output%status = status
    if (allocated(record%report_lines)) then
      do i = 1, size(record%report_lines)
        if (record%report_lines(i) /= '') write (output%cvg, '(2a)', iostat=status) '  ** ', trim(record%report_lines(i))
        if (output%status == 0) output%status = status
      end do
    end if
    if (record%is_converged .and. record%n_proximal == 0 .and. record%proximal_work_increment > 0.0_DP) &
      write (output%cvg, '(a,es11.4)', iostat=status) '  ** snap to another equilibrium, energy released ', &
      record%proximal_work_increment
    if (output%status == 0) output%status = status
    if (.not. record%is_converged .or. record%n_proximal == 0) return
    words = '  ** proximal steps in '
    if (record%n_snap_through > 0) words = '  ** snap-through to another equilibrium in '
    write (output%cvg, '(a,i0,a,es11.4,a)', iostat=status) words, record%n_proximal, ' iterations, work ', &
      record%proximal_work_increment, ', none of the regularization left at the end'
    if (output%status == 0) output%status = status
  end subroutine print_attempt_notes


  !> Writes the output of the step's PRINT cards for a converged increment if print_frequency selects it; nothing for
  !! increment 0.
  subroutine print_fields(output, model, fields, record, error)
    type(text_output_type), intent(in) :: output
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields                  !< committed
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: i, status
    character(200) :: reason
    if (output%dat == 0 .or. record%increment == 0) return
    associate (step => model%steps(record%step))
      if (.not. allocated(step%prints)) return
      if (size(step%prints) == 0) return
      if (.not. is_output_due(step, step%print_frequency, record%increment, record%step_time, &
        step%print_times, record%is_step_end)) return
      write (output%dat, '(/24x,a,i5,///,32x,a,i5,/)') 'S T E P   ', record%step, 'INCREMENT ', record%increment
      do i = 1, size(step%prints)
        call print_request(output%dat, model, fields, step%prints(i), step%is_nlgeom)
      end do
    end associate
    flush (output%dat, iostat=status, iomsg=reason)
    if (status /= 0) call set_error(error, EXIT_IO, 'Cannot write the file ' // output%dat_path // ': ' // &
      trim(reason) // '.')
  end subroutine print_fields


  !> Closes the files that are open.
  subroutine close_text_output(output)
    type(text_output_type), intent(inout) :: output
    call close_text(output, output%sta)
    call close_text(output, output%cvg)
    call close_text(output, output%dat)
    output = text_output_type()
  end subroutine close_text_output

end module amontons_text_output
