!> Console output: messages, diagnostics, progress lines and the final summary.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A failure is a line that starts with `*ERROR`, a warning one that starts with `*WARNING`. Calling programs search for these
!! words; so a job that succeeds never prints the first of them, whatever its deck contains.
module amontons_logger
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: output_unit
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: diagnostic_list_type, diagnostic_type
  use amontons_text, only: plural, to_text, BLANK_CHARACTERS, NEWLINE
  use amontons_iteration_records, only: iteration_record_type, increment_record_type, N_PHASES, PHASE_NAMES, PHASE_OTHER
  use amontons_posix, only: peak_megabytes, heartbeat_type, start_heartbeat, postpone_heartbeat, set_heartbeat, &
    stop_heartbeat
  implicit none
  private
  public :: logger_type, log_sink_type, open_logger, PROGRESS_AUTO, PROGRESS_PLAIN, PROGRESS_NONE

  real(DP), parameter :: MEGABYTE_IN_KB = 1024.0_DP**2 / 1000.0_DP   !< the program's megabytes are those of the system [kB]
  integer, parameter :: PROGRESS_AUTO = 0       !< a line per increment, and a live line if the output is a terminal
  integer, parameter :: PROGRESS_PLAIN = 1      !< a line per increment
  integer, parameter :: PROGRESS_NONE = 2       !< no line per increment

  integer, parameter :: MAX_ECHO_LENGTH = 1000         !< characters of a line of the deck that are shown
  integer, parameter :: MAX_DIAGNOSTICS_SHOWN = 500  !< diagnostics beyond this number are only counted
  real(DP), parameter :: HEARTBEAT = 30         !< where nothing is written for so long, a line reports the progress [s]
  integer, parameter :: LIVE_WIDTH = 79         !< a live line must not wrap
  character(*), parameter :: ESCAPE = achar(27), RETURN_KEY = achar(13)

  !> Receives the lines of the logger instead of the output unit.
  type, abstract :: log_sink_type
  contains
    procedure(write_lines_interface), deferred :: write_lines
  end type log_sink_type

  abstract interface
    !> Receives lines of the logger.
    subroutine write_lines_interface(self, text)
      import :: log_sink_type
      implicit none
      class(log_sink_type), intent(inout) :: self
      character(*), intent(in) :: text         !< one line, or several separated by NEWLINE
    end subroutine write_lines_interface
  end interface

  !> Output unit and verbosity; one for each job.
  type :: logger_type
    private
    integer :: unit = output_unit
    class(log_sink_type), allocatable :: sink   !< receives the lines instead of the unit
    logical :: is_quiet = .true.                !< only failures are written
    logical :: is_terminal = .false.            !< colour
    logical :: is_live = .false.                !< a line that is overwritten repeatedly
    type(heartbeat_type) :: heartbeat           !< on the screen, where there is no live line
    logical :: has_increments = .false.         !< a line per increment
    logical :: has_header = .false.               !< the header above the lines of the increments is written
    logical :: has_live_line = .false.          !< a live line is on the screen
    integer(I64) :: start = 0                   !< clock reading when the logger was opened
    real(DP) :: fraction = 0                    !< of the whole job done at the last increment [-]
  contains
    procedure, public :: say
    procedure, public :: warn
    procedure, public :: fail
    procedure, public :: show_diagnostics => complain
    procedure, public :: show_report => explain
    procedure, public :: show_increment
    procedure, public :: show_iteration
    procedure, public :: show_summary
    procedure, public :: elapsed
  end type logger_type

  interface
    !> POSIX: 1 if the file descriptor is a terminal.
    function isatty(descriptor) bind(C, name='isatty') result(answer)
      import :: c_int
      implicit none
      integer(c_int), value :: descriptor
      integer(c_int) :: answer
    end function isatty
  end interface

contains

  !> Opens a logger and starts its clock. A logger that was never opened is quiet.
  subroutine open_logger(logger, is_quiet, progress, unit, log_sink)
    type(logger_type), intent(out) :: logger
    logical, intent(in) :: is_quiet            !< .true.: only failures are written
    integer, intent(in) :: progress            !< PROGRESS_...
    integer, intent(in), optional :: unit      !< default: the screen
    class(log_sink_type), intent(in), optional :: log_sink   !< instead of a unit
    call system_clock(logger%start)
    logger%is_quiet = is_quiet
    logger%has_increments = progress /= PROGRESS_NONE
    if (present(log_sink)) then
      allocate (logger%sink, source=log_sink)
    else if (present(unit)) then
      logger%unit = unit
    else
      logger%is_terminal = isatty(1_c_int) == 1
    end if
    logger%is_live = progress == PROGRESS_AUTO .and. logger%is_terminal
    if (is_quiet .or. logger%is_live .or. progress == PROGRESS_NONE .or. present(unit) .or. present(log_sink)) return
    call start_heartbeat(logger%heartbeat, 1_c_int, HEARTBEAT)
    call set_heartbeat(logger%heartbeat, '        At work: the first iteration is not done yet.')
  end subroutine open_logger


  !> Seconds since the logger was opened.
  function elapsed(self) result(seconds)
    class(logger_type), intent(in) :: self
    real(DP) :: seconds
    integer(I64) :: now, rate
    call system_clock(now, rate)
    seconds = real(now - self%start, DP) / real(rate, DP)
  end function elapsed


  !> Prints complete sentences, separated by NEWLINE.
  subroutine say(self, text)
    class(logger_type), intent(inout) :: self
    character(*), intent(in) :: text
    if (.not. self%is_quiet) call write_line(self, sanitized(text))
  end subroutine say


  !> Prints a warning; the job continues.
  subroutine warn(self, text)
    class(logger_type), intent(inout) :: self
    character(*), intent(in) :: text
    if (self%is_quiet) return
    call write_line(self, colored_word(self, '*WARNING', '33') // ': ' // sanitized(text))
  end subroutine warn


  !> Prints the error that ends a job. The first line of the text is printed last, because calling programs read the
  !! last line.
  subroutine fail(self, text)
    class(logger_type), intent(inout) :: self
    character(*), intent(in) :: text
    integer :: first
    call stop_heartbeat(self%heartbeat)
    first = index(text, NEWLINE)
    if (first > 0) call write_line(self, text(first + 1:))
    if (first == 0) first = len(text) + 1
    call write_line(self, colored_word(self, '*ERROR', '31') // ': ' // text(:first - 1))
  end subroutine fail


  !> Prints all diagnostics of the reader: file, line, what is wrong and what is allowed, and below it the card as written.
  subroutine complain(self, diagnostics)
    class(logger_type), intent(inout) :: self
    type(diagnostic_list_type), intent(in) :: diagnostics
    integer :: i, n_shown
    n_shown = 0
    do i = 1, diagnostics%n_items
      if (self%is_quiet .and. diagnostics%items(i)%is_warning) cycle
      n_shown = n_shown + 1
      if (n_shown > MAX_DIAGNOSTICS_SHOWN) exit
      call write_diagnostic(self, diagnostics%items(i))
    end do
    if (diagnostics%n_items > MAX_DIAGNOSTICS_SHOWN) then
      call write_line(self, 'These are the first ' // to_text(MAX_DIAGNOSTICS_SHOWN) // ' remarks.')
    end if
    if (diagnostics%n_items > 0 .and. n_shown > 0) then
      call write_line(self, 'The deck has ' // plural(diagnostics%n_errors, 'error') // ' and ' // &
        plural(diagnostics%n_warnings, 'warning') // '.')
    end if
  end subroutine complain


  !> Prints one diagnostic of the reader.
  subroutine write_diagnostic(logger, diagnostic)
    class(logger_type), intent(inout) :: logger
    type(diagnostic_type), intent(in) :: diagnostic
    character(:), allocatable :: mark, place
    if (diagnostic%is_warning) then
      mark = colored_word(logger, '*WARNING', '33')
    else
      mark = colored_word(logger, '*ERROR', '31')
    end if
    place = ''
    if (allocated(diagnostic%file)) place = diagnostic%file
    if (diagnostic%line > 0) place = place // ':' // to_text(diagnostic%line)
    if (len(place) > 0) place = place // ': '
    call write_line(logger, place // mark // ': ' // sanitized(diagnostic%text))
    if (.not. allocated(diagnostic%card)) return
    if (len_trim(diagnostic%card) > MAX_ECHO_LENGTH) then
      call write_line(logger, '    ' // sanitized(diagnostic%card(:MAX_ECHO_LENGTH)) // ' ...')
    else if (len_trim(diagnostic%card) > 0) then
      call write_line(logger, '    ' // trim(sanitized(diagnostic%card)))
    end if
  end subroutine write_diagnostic


  !> Prints a report: one sentence and the indented lines that explain it.
  subroutine explain(self, text, lines)
    class(logger_type), intent(inout) :: self
    character(*), intent(in) :: text           !< what happened
    character(*), intent(in) :: lines(:)       !< remedies
    integer :: i
    call write_line(self, sanitized(text))
    do i = 1, size(lines)
      if (lines(i) /= '') call write_line(self, '  ' // trim(sanitized(lines(i))))
    end do
  end subroutine explain


  !> Prints one attempt at an increment: cost, status of the slave nodes, progress of the job.
  subroutine show_increment(self, record, fraction)
    class(logger_type), intent(inout) :: self
    type(increment_record_type), intent(in) :: record
    real(DP), intent(in) :: fraction           !< of the whole job done, 0 to 1 [-]
    character(100) :: line
    integer :: i
    self%fraction = fraction
    if (self%is_quiet .or. .not. self%has_increments) return
    if (.not. self%has_header) then
      call write_line(self, ' step   inc  att        time        size  iter    open   stick    slip    done  elapsed     left')
      self%has_header = .true.
    end if
    write (line, '(i5,i6,i5,2(1x,a11),i6,3i8,i6,a,a9,a9)') record%step, record%increment, record%attempt, &
      to_text(record%total_time), to_text(record%dt), record%n_iterations, record%n_status, &
      int(100 * fraction + 0.01_DP), ' %', duration(self%elapsed()), remaining_time(self)
    call write_line(self, trim(line))
    if (record%is_riks) call write_line(self, '        Load proportionality factor ' // to_text(record%load_factor) // &
      trim(merge('.                            ', ' at the start of the attempt.', record%is_converged)))
    if (record%n_cycles_treated > 0) call write_line(self, '        Active-set cycling was treated at the cycling ' // &
      'slave nodes alone: ' // &
      plural(record%n_cycles_treated, 'time') // '.')
    if (record%is_converged .and. record%n_snap_through > 0) then
      call write_line(self, '        No equilibrium nearby: snap-through to another equilibrium in ' // &
        plural(record%n_snap_through, 'iteration') // ', work ' // to_text(record%proximal_work_increment) // '.')
    else if (record%is_converged .and. record%n_proximal > 0) then
      call write_line(self, '        Unsupported bodies were moved into contact ' // &
        'by regularization in ' // plural(record%n_proximal, 'iteration') // ', work ' // to_text(record%proximal_work_increment) &
        // '.')
    else if (record%is_converged .and. record%proximal_work_increment > 0.0_DP) then
      call write_line(self, '        The structure snapped to another equilibrium: energy released ' // &
        to_text(record%proximal_work_increment) // '.')
    end if
    if (record%is_converged .and. allocated(record%report_lines)) then
      do i = 1, size(record%report_lines)
        call write_line(self, '        ' // trim(sanitized(record%report_lines(i))))
      end do
    end if
    write (line, '(8x,2(a,i0))') 'At work after step ', record%step, ', increment ', record%increment
    call set_heartbeat(self%heartbeat, trim(line) // '.')
    if (record%is_converged) return
    if (allocated(record%reason)) then
      call write_line(self, '        This attempt failed: ' // sanitized(record%reason))
    else
      call write_line(self, '        This attempt failed.')
    end if
  end subroutine show_increment


  !> Shows one iteration on the live line of a terminal; elsewhere only where nothing else is written for half a minute.
  subroutine show_iteration(self, record)
    class(logger_type), intent(inout) :: self
    type(iteration_record_type), intent(in) :: record
    character(160) :: line
    if (self%is_quiet) return
    if (.not. self%is_live) then
      write (line, '(8x,3(a,i0),a,es8.1,2(a,i0),a)') 'At work after step ', record%step, ', increment ', record%increment, &
        ', iteration ', record%iteration, ': residual', record%residual, ', stick ', record%n_status(1), ', slip ', &
        record%n_status(2), '.'
      call set_heartbeat(self%heartbeat, trim(line))
      return
    end if
    write (line, '(3(a,i0),a,es7.1,2a)') 'Step ', record%step, ' inc ', record%increment, ' iter ', record%iteration, &
      ': ', record%residual, ', left ', adjustl(remaining_time(self))
    if (sum(record%n_status) > 0) write (line(len_trim(line) + 1:), '(2(a,i0),a,4(1x,i0))') ', stick ', &
      record%n_status(1), ', slip ', record%n_status(2), ', I-IV', record%n_scenario
    write (self%unit, '(3a)', advance='no') RETURN_KEY, trim(line(:LIVE_WIDTH)), ESCAPE // '[K'
    flush (self%unit)
    self%has_live_line = .true.
  end subroutine show_iteration


  !> Prints the final summary: cost by phase, iterations, scenarios, contact, force balance.
  subroutine show_summary(self, records, n_unknowns)
    class(logger_type), intent(inout) :: self
    type(increment_record_type), intent(in) :: records(:)   !< all attempts of the job, in order
    integer, intent(in) :: n_unknowns              !< components of the displacements
    call stop_heartbeat(self%heartbeat)
    if (self%is_quiet .or. size(records) == 0) return
    call write_line(self, '')
    call write_counts(self, records)
    call write_phase_times(self, records, n_unknowns)
    call write_contact_summary(self, records)
    call write_force_balance(self, records)
  end subroutine show_summary


  !> Increments, attempts, iterations, factorisations.
  subroutine write_counts(logger, records)
    class(logger_type), intent(inout) :: logger
    type(increment_record_type), intent(in) :: records(:)
    integer :: n_converged, n_iterations
    character(60) :: mean
    n_converged = count(records%is_converged)
    n_iterations = sum(records%n_iterations)
    mean = ''
    if (n_converged > 0) write (mean, '(a,f0.2,a)') '   (', real(n_iterations, DP) / real(n_converged, DP), &
      ' per increment, failed attempts counted)'
    call write_count(logger, 'increments converged', n_converged, '')
    call write_count(logger, 'attempts that failed', size(records) - n_converged, '')
    call write_count(logger, 'Newton iterations', n_iterations, trim(mean))
    call write_count(logger, 'factorisations', sum(records%n_factorisations), '')
    call write_count(logger, 'Krylov iterations', sum(records%n_krylov), '')
  end subroutine write_counts


  !> One line of the table: a name, a number, a remark.
  subroutine write_count(logger, name, value, remark)
    class(logger_type), intent(inout) :: logger
    character(*), intent(in) :: name
    integer, intent(in) :: value
    character(*), intent(in) :: remark
    character(30) :: left
    character(10) :: right
    left = name
    write (right, '(i10)') value
    call write_line(logger, '  ' // left // right // remark)
  end subroutine write_count


  !> Seconds by phase and their share of the total; the peak of memory, in all and by unknown.
  subroutine write_phase_times(logger, records, n_unknowns)
    class(logger_type), intent(inout) :: logger
    type(increment_record_type), intent(in) :: records(:)
    integer, intent(in) :: n_unknowns
    real(DP) :: seconds(N_PHASES), megabytes(N_PHASES), whole, peak
    integer :: i, phase
    character(28) :: name
    character(80) :: line
    seconds = 0
    megabytes = 0
    do i = 1, size(records)
      seconds = seconds + records(i)%seconds
      megabytes = megabytes + records(i)%megabytes
    end do
    peak = peak_megabytes()
    megabytes(PHASE_OTHER) = peak - sum(megabytes)   ! the program itself, reading, the state
    whole = max(sum(seconds), tiny(whole))
    call write_line(logger, '  by phase                          seconds             MB by which the peak of memory grew')
    do phase = 1, N_PHASES
      name = PHASE_NAMES(phase)
      write (line, '(4x,a28,f10.2,f7.1,a,f10.0)') name, seconds(phase), 100 * seconds(phase) / whole, ' %', megabytes(phase)
      call write_line(logger, trim(line))
    end do
    name = 'the whole job'
    write (line, '(4x,a28,f10.2,9x,f10.0)') name, logger%elapsed(), peak
    call write_line(logger, trim(line))
    write (line, '(a,f10.2,a,i0,a)') '  peak of memory by unknown     ', MEGABYTE_IN_KB * peak / real(max(1, n_unknowns), DP), &
      ' kB   (', n_unknowns, ' unknowns)'
    call write_line(logger, trim(line))
  end subroutine write_phase_times


  !> Scenarios of the line search, summed over all nodes and iterations, and the final status of the slave nodes.
  subroutine write_contact_summary(logger, records)
    class(logger_type), intent(inout) :: logger
    type(increment_record_type), intent(in) :: records(:)
    integer :: i, last
    character(100) :: line
    last = 0
    do i = 1, size(records)
      if (records(i)%is_converged) last = i
    end do
    if (last == 0) return
    if (sum(records(last)%n_status) == 0) return
    write (line, '(a,4(a,i0))') '  nodes by scenario, summed over the iterations:', '  I ', &
      sum(records%n_scenario(1)), ',  II ', sum(records%n_scenario(2)), ',  III ', sum(records%n_scenario(3)), &
      ',  IV ', sum(records%n_scenario(4))
    call write_line(logger, trim(line))
    write (line, '(3(a,i0))') '  slave nodes at the end:  open ', records(last)%n_status(0), ',  stick ', &
      records(last)%n_status(1), ',  slip ', records(last)%n_status(2)
    call write_line(logger, trim(line))
    if (any(records%is_converged .and. records%n_status(1) + records%n_status(2) > 0)) return
    call write_line(logger, '*WARNING: No slave node touched its master at the end of any increment: these are results of ' // &
      'bodies without contact. Look at the gaps (COPEN) and at which surface is the slave (the finer or smaller one).')
  end subroutine write_contact_summary


  !> The largest force imbalance of a converged increment, and its increment.
  subroutine write_force_balance(logger, records)
    class(logger_type), intent(inout) :: logger
    type(increment_record_type), intent(in) :: records(:)
    integer :: worst
    character(120) :: line
    if (.not. any(records%is_converged)) return
    worst = maxloc(records%residual, dim=1, mask=records%is_converged)
    write (line, '(a,es8.1,2(a,i0))') '  largest force imbalance:', records(worst)%residual, &
      ' of the largest force, in step ', records(worst)%step, ', increment ', records(worst)%increment
    call write_line(logger, trim(line))
  end subroutine write_force_balance


  !> Erases the live line and writes whole lines.
  subroutine write_line(logger, text)
    class(logger_type), intent(inout) :: logger
    character(*), intent(in) :: text
    integer :: unused                          ! a closed or full output must not end the job
    if (allocated(logger%sink)) then
      call logger%sink%write_lines(text)
      return
    end if
    if (logger%has_live_line) write (logger%unit, '(2a)', advance='no', iostat=unused) RETURN_KEY, ESCAPE // '[K'
    logger%has_live_line = .false.
    write (logger%unit, '(a)', iostat=unused) text
    flush (logger%unit, iostat=unused)
    call postpone_heartbeat(logger%heartbeat)
  end subroutine write_line


  !> A word in colour if the output is a terminal.
  pure function colored_word(logger, word, colour) result(text)
    class(logger_type), intent(in) :: logger
    character(*), intent(in) :: word
    character(*), intent(in) :: colour         !< number of the colour (ECMA-48)
    character(:), allocatable :: text
    text = word
    if (logger%is_terminal) text = ESCAPE // '[' // colour // 'm' // word // ESCAPE // '[0m'
  end function colored_word


  !> The text with each `*ERROR` replaced by `* ERROR`, and each control character by a question mark: echoed deck lines
  !! must not look like a failure or control the terminal.
  pure function sanitized(text) result(safe)
    character(*), intent(in) :: text
    character(:), allocatable :: safe
    integer :: place
    safe = text
    do place = 1, len(safe)
      if (index(BLANK_CHARACTERS, safe(place:place)) > 0) safe(place:place) = ' '
      if (safe(place:place) == NEWLINE) cycle
      if (iachar(safe(place:place)) < 32 .or. iachar(safe(place:place)) == 127) safe(place:place) = '?'
    end do
    place = index(safe, '*ERROR')
    do while (place > 0)
      safe = safe(:place) // ' ' // safe(place + 1:)
      place = index(safe, '*ERROR')
    end do
  end function sanitized


  !> The estimated remaining time, proportional: elapsed time over the fraction done.
  function remaining_time(logger) result(text)
    class(logger_type), intent(in) :: logger
    character(:), allocatable :: text
    text = '?'
    if (logger%fraction > 0) text = duration(logger%elapsed() * max(0.0_DP, 1 - logger%fraction) / logger%fraction)
  end function remaining_time


  !> Seconds as 0:07, 12:30 or 3:05:59.
  pure function duration(seconds) result(text)
    real(DP), intent(in) :: seconds            !< [s]
    character(:), allocatable :: text
    character(16) :: clock
    integer :: whole
    whole = int(min(seconds, 3.5e6_DP))
    if (whole < 3600) then
      write (clock, '(i0,a,i2.2)') whole / 60, ':', mod(whole, 60)
    else
      write (clock, '(i0,2(a,i2.2))') whole / 3600, ':', mod(whole / 60, 60), ':', mod(whole, 60)
    end if
    text = trim(clock)
  end function duration

end module amontons_logger
