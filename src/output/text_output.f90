!> Printed: job.sta and job.cvg, a line per attempt and per iteration, and the file job.dat for the PRINT cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The columns are those of CalculiX, so that programs which read its files read ours; what we add stands to the right.
!! Lines of .sta and .cvg are brought to disk one by one, since such programs watch them while the job runs.
module amontons_text_output
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_posix, only: cut_file, sync_file
  use amontons_steps, only: is_output_due
  use amontons_model, only: job_options_type, job_path, model_type
  use amontons_iteration_records, only: increment_record_type, iteration_record_type
  use amontons_state, only: fields_type
  use amontons_dat_output, only: print_request
  implicit none
  private
  public :: printed_type, open_printed, resume_printed, sync_printed, measure_printed, check_printed, print_iteration, &
    print_increment, print_fields, close_printed

  !> The text files of a job that are being written. Units are 0 if not open.
  type :: printed_type
    private
    integer :: sta = 0
    integer :: cvg = 0
    integer :: dat = 0
    character(:), allocatable :: sta_path, cvg_path, dat_path
    integer :: status = 0                    !< of the first line that could not be written
  end type printed_type

contains

  !> Opens job.sta and job.cvg with their head lines, and job.dat if a step has PRINT cards.
  subroutine open_printed(printed, model, options, error)
    type(printed_type), intent(out) :: printed
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    printed%sta_path = job_path(options, '.sta')
    call open_text(printed%sta_path, printed%sta, error)
    if (allocated(error)) return
    write (printed%sta, '(a)', iostat=status) 'SUMMARY OF JOB INFORMATION', &
      '  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME' // &
      '    OPEN  STICK   SLIP      S-I     S-II    S-III     S-IV  CUT  FACT  KRYLOV   RESIDUAL  CORRECTION'
    if (printed%status == 0) printed%status = status
    call bring_out(printed, printed%sta)
    printed%cvg_path = job_path(options, '.cvg')
    call open_text(printed%cvg_path, printed%cvg, error)
    if (allocated(error)) return
    write (printed%cvg, '(a)', iostat=status) 'SUMMARY OF C0NVERGENCE INFORMATION', &
      '  STEP   INC  ATT   ITER     CONT.   RESID.        CORR.      RESID.      CORR.' // &
      '    OPEN  STICK   SLIP    S-I   S-II  S-III   S-IV OPENED CLOSED KRYLOV       STEP        WORST BALANC ROUNDS', &
      '                              EL.    FORCE         DISP       FLUX        TEMP.' // &
      '                                                                      LENGTH          GAP', &
      '                              (#)     (%)           (%)        (%)         (%)' // &
      '     (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)    (#)         (-)     (LENGTH)'
    if (printed%status == 0) printed%status = status
    call bring_out(printed, printed%cvg)
    if (.not. has_prints(model)) return
    printed%dat_path = job_path(options, '.dat')
    call open_text(printed%dat_path, printed%dat, error)
  end subroutine open_printed


  !> Opens the files of a job that goes on after a checkpoint: each is cut off where it was then.
  subroutine resume_printed(printed, model, options, lengths, error)
    type(printed_type), intent(out) :: printed
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    integer(I64), intent(in) :: lengths(3)         !< of .sta, .cvg, .dat [bytes]
    type(error_type), allocatable, intent(out) :: error
    printed%sta_path = job_path(options, '.sta')
    call reopen_text(printed%sta_path, lengths(1), printed%sta, error)
    if (allocated(error)) return
    printed%cvg_path = job_path(options, '.cvg')
    call reopen_text(printed%cvg_path, lengths(2), printed%cvg, error)
    if (allocated(error) .or. .not. has_prints(model)) return
    printed%dat_path = job_path(options, '.dat')
    call reopen_text(printed%dat_path, lengths(3), printed%dat, error)
  end subroutine resume_printed


  !> Brings the files to the medium.
  subroutine sync_printed(printed, error)
    type(printed_type), intent(in) :: printed
    type(error_type), allocatable, intent(out) :: error
    call check_printed(printed, error)
    if (.not. allocated(error) .and. printed%sta /= 0) call sync_file(printed%sta_path, error)
    if (.not. allocated(error) .and. printed%cvg /= 0) call sync_file(printed%cvg_path, error)
    if (.not. allocated(error) .and. printed%dat /= 0) call sync_file(printed%dat_path, error)
  end subroutine sync_printed


  !> How long the files are now.
  subroutine measure_printed(printed, lengths)
    type(printed_type), intent(inout) :: printed
    integer(I64), intent(out) :: lengths(3)        !< of .sta, .cvg, .dat; 0 if not open [bytes]
    lengths = 0
    call measure(printed%sta, lengths(1))
    call measure(printed%cvg, lengths(2))
    call measure(printed%dat, lengths(3))

  contains

    !> One of them.
    subroutine measure(unit, length)
      integer, intent(in) :: unit
      integer(I64), intent(inout) :: length
      if (unit == 0) return
      call bring_out(printed, unit)
      inquire (unit=unit, size=length)
    end subroutine measure

  end subroutine measure_printed


  !> An error if a line could not be written since the files were opened: a full disk.
  subroutine check_printed(printed, error)
    type(printed_type), intent(in) :: printed
    type(error_type), allocatable, intent(out) :: error
    if (printed%status /= 0) call set_error(error, EXIT_IO, 'Cannot write the file ' // printed%sta_path // ' or ' // &
      'the .cvg or .dat beside it (is the disk full?).')
  end subroutine check_printed


  !> Closes a file; the first trouble is kept.
  subroutine close_text(printed, unit)
    type(printed_type), intent(inout) :: printed
    integer, intent(in) :: unit
    integer :: status
    if (unit == 0) return
    close (unit, iostat=status)
    if (printed%status == 0) printed%status = status
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


  !> Flushes a file; the first trouble is kept.
  subroutine bring_out(printed, unit)
    type(printed_type), intent(inout) :: printed
    integer, intent(in) :: unit
    integer :: status
    flush (unit, iostat=status)
    if (printed%status == 0) printed%status = status
  end subroutine bring_out


  !> Opens a text file to go on behind a length that it has.
  subroutine reopen_text(path, length, unit, error)
    character(*), intent(in) :: path
    integer(I64), intent(in) :: length             !< [bytes]
    integer, intent(out) :: unit
    type(error_type), allocatable, intent(out) :: error
    character(200) :: reason
    integer :: status
    unit = 0
    call cut_file(path, length, error)
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
  subroutine print_iteration(printed, record)
    type(printed_type), intent(inout) :: printed
    type(iteration_record_type), intent(in) :: record
    integer :: status
    if (printed%cvg == 0) return
    write (printed%cvg, '(2x,i4,2x,i4,2x,i4,2x,i4,2x,i7,4(1x,e11.4),3(1x,i6),4(1x,i6),3(1x,i6),2(1x,e12.5),2(1x,i6))', &
      iostat=status) &
      record%step, record%increment, record%attempt, record%iteration, record%n_closed, 100 * record%residual, &
      100 * record%correction, 0.0_DP, 0.0_DP, record%n_status, record%n_scenario, record%n_opened, &
      record%n_closed_now, record%n_krylov, record%step_length, record%worst_gap, record%n_balanced, record%n_rounds
    if (printed%status == 0) printed%status = status
    call bring_out(printed, printed%cvg)
  end subroutine print_iteration


  !> Writes a line of .sta; an attempt that failed has a U behind its number and the times at which it began.
  subroutine print_increment(printed, record)
    type(printed_type), intent(inout) :: printed
    type(increment_record_type), intent(in) :: record
    character(*), parameter :: OURS = '3(1x,i6),4(1x,i8),1x,i4,1x,i5,1x,i7,2(1x,e11.4))'
    real(DP) :: back
    integer :: status
    character(:), allocatable :: form
    if (printed%sta == 0) return
    if (record%is_converged) then
      form = '(1x,i5,1x,i10,2(1x,i5),3(1x,e13.6),' // OURS
      back = 0
    else
      form = '(1x,i5,1x,i10,1x,i5,''U'',1x,i4,3(1x,e13.6),' // OURS
      back = record%dt
    end if
    write (printed%sta, form, iostat=status) record%step, record%increment, record%attempt, record%n_iterations, &
      record%total_time - back, record%step_time - back, record%dt, record%n_status, record%n_scenario, &
      record%n_cutbacks, record%n_factorisations, record%n_krylov, record%residual, record%correction
    if (printed%status == 0) printed%status = status
    call bring_out(printed, printed%sta)
    if (printed%cvg /= 0) call print_course(printed, record)
    call bring_out(printed, printed%cvg)
  end subroutine print_increment


  !> Writes below the iterations of an attempt what they do not tell: cycles, bodies that were carried, why it failed.
  subroutine print_course(printed, record)
    type(printed_type), intent(inout) :: printed
    type(increment_record_type), intent(in) :: record
    character(:), allocatable :: words
    integer :: status, i
    status = 0
    if (record%n_cycles > 0) &
      write (printed%cvg, '(a,i0)', iostat=status) '  ** cycles of slave nodes that were acted on: ', record%n_cycles
    if (printed%status == 0) printed%status = status
    if (.not. record%is_converged .and. allocated(record%reason)) &
      write (printed%cvg, '(2a)', iostat=status) '  ** ', record%reason
    if (printed%status == 0) printed%status = status
    if (allocated(record%story)) then
      do i = 1, size(record%story)
        if (record%story(i) /= '') write (printed%cvg, '(2a)', iostat=status) '  ** ', trim(record%story(i))
        if (printed%status == 0) printed%status = status
      end do
    end if
    if (.not. record%is_converged .or. record%n_carried == 0) return
    words = '  ** carried in '
    if (record%n_snapped > 0) words = '  ** carried to another balance in '
    write (printed%cvg, '(a,i0,a,es11.4,a)', iostat=status) words, record%n_carried, ' iterations, work ', &
      record%carried_now, ', nothing of it left at the end'
    if (printed%status == 0) printed%status = status
  end subroutine print_course


  !> Writes what the PRINT cards of the step ask of a converged increment; nothing if its turn has not come
  !! (print_frequency), and nothing for increment 0.
  subroutine print_fields(printed, model, fields, record, error)
    type(printed_type), intent(in) :: printed
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields                  !< committed
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: i, status
    character(200) :: reason
    if (printed%dat == 0 .or. record%increment == 0) return
    associate (step => model%steps(record%step))
      if (.not. allocated(step%prints)) return
      if (size(step%prints) == 0) return
      if (.not. is_output_due(step, step%print_frequency, record%increment, record%step_time, &
        step%print_times)) return
      write (printed%dat, '(/24x,a,i5,///,32x,a,i5,/)') 'S T E P   ', record%step, 'INCREMENT ', record%increment
      do i = 1, size(step%prints)
        call print_request(printed%dat, model, fields, step%prints(i), step%is_nlgeom)
      end do
    end associate
    flush (printed%dat, iostat=status, iomsg=reason)
    if (status /= 0) call set_error(error, EXIT_IO, 'Cannot write the file ' // printed%dat_path // ': ' // &
      trim(reason) // '.')
  end subroutine print_fields


  !> Closes the files that are open.
  subroutine close_printed(printed)
    type(printed_type), intent(inout) :: printed
    call close_text(printed, printed%sta)
    call close_text(printed, printed%cvg)
    call close_text(printed, printed%dat)
    printed = printed_type()
  end subroutine close_printed

end module amontons_text_output
