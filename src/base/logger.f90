!> Journal: the one place that writes for people: sentences, warnings, progress, the table at the end.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A failure is a line that starts with `*ERROR`, a warning one that starts with `*WARNING`: programs that start us look
!! for these words, so a job that ends well never shows the first of them, whatever its deck says.
module amontons_logger
  use, intrinsic :: iso_c_binding, only: c_int
  use, intrinsic :: iso_fortran_env, only: output_unit
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: complaints_type, complaint_type
  use amontons_text, only: plural, text_of, BLANK_CHARACTERS, NEWLINE
  use amontons_iteration_records, only: iteration_record_type, increment_record_type, N_PHASES, PHASE_NAMES, PHASE_OTHER
  use amontons_posix, only: peak_megabytes
  implicit none
  private
  public :: journal_type, listener_type, open_journal, PROGRESS_AUTO, PROGRESS_PLAIN, PROGRESS_NONE

  integer, parameter :: PROGRESS_AUTO = 0       !< a line per increment, and a live line if a person looks at a terminal
  integer, parameter :: PROGRESS_PLAIN = 1      !< a line per increment
  integer, parameter :: PROGRESS_NONE = 2       !< no line per increment

  integer, parameter :: LONGEST_ECHO = 1000         !< characters of a line of the deck that are shown
  integer, parameter :: COMPLAINTS_SHOWN = 500  !< more than these are only counted
  integer, parameter :: LIVE_WIDTH = 79         !< a live line must not wrap
  character(*), parameter :: ESCAPE = achar(27), RETURN_KEY = achar(13)

  !> Hears the lines of a journal instead of the screen.
  type, abstract :: listener_type
  contains
    procedure(hear_lines), deferred :: hear
  end type listener_type

  abstract interface
    !> Lines that the journal would write.
    subroutine hear_lines(self, text)
      import :: listener_type
      implicit none
      class(listener_type), intent(inout) :: self
      character(*), intent(in) :: text         !< one line, or several parted by NEWLINE
    end subroutine hear_lines
  end interface

  !> Where and how much is written; one for each job.
  type :: journal_type
    private
    integer :: unit = output_unit
    class(listener_type), allocatable :: listener   !< hears the lines instead of the unit
    logical :: is_quiet = .true.                !< only failures are written
    logical :: is_terminal = .false.            !< colour
    logical :: is_live = .false.                !< a line that is written over again and again
    logical :: has_increments = .false.         !< a line per increment
    logical :: has_head = .false.               !< the head above the lines of the increments is written
    logical :: has_live_line = .false.          !< a live line stands on the screen
    integer(I64) :: start = 0                   !< reading of the clock when the journal was opened
    real(DP) :: fraction = 0                    !< of the whole job done at the last increment [-]
  contains
    procedure, public :: say
    procedure, public :: warn
    procedure, public :: fail
    procedure, public :: complain
    procedure, public :: explain
    procedure, public :: show_increment
    procedure, public :: show_iteration
    procedure, public :: show_summary
    procedure, public :: elapsed
  end type journal_type

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

  !> Opens a journal and starts its clock. A journal that was never opened is quiet.
  subroutine open_journal(journal, is_quiet, progress, unit, listener)
    type(journal_type), intent(out) :: journal
    logical, intent(in) :: is_quiet            !< .true.: only failures are written
    integer, intent(in) :: progress            !< PROGRESS_...
    integer, intent(in), optional :: unit      !< default: the screen
    class(listener_type), intent(in), optional :: listener   !< instead of a unit
    call system_clock(journal%start)
    journal%is_quiet = is_quiet
    journal%has_increments = progress /= PROGRESS_NONE
    if (present(listener)) then
      allocate (journal%listener, source=listener)
    else if (present(unit)) then
      journal%unit = unit
    else
      journal%is_terminal = isatty(1_c_int) == 1
    end if
    journal%is_live = progress == PROGRESS_AUTO .and. journal%is_terminal
  end subroutine open_journal


  !> Seconds since the journal was opened.
  function elapsed(self) result(seconds)
    class(journal_type), intent(in) :: self
    real(DP) :: seconds
    integer(I64) :: now, rate
    call system_clock(now, rate)
    seconds = real(now - self%start, DP) / real(rate, DP)
  end function elapsed


  !> Whole sentences; lines are parted by NEWLINE.
  subroutine say(self, text)
    class(journal_type), intent(inout) :: self
    character(*), intent(in) :: text
    if (.not. self%is_quiet) call put(self, harmless(text))
  end subroutine say


  !> Something a person should know, though the job goes on.
  subroutine warn(self, text)
    class(journal_type), intent(inout) :: self
    character(*), intent(in) :: text
    if (self%is_quiet) return
    call put(self, painted(self, '*WARNING', '33') // ': ' // harmless(text))
  end subroutine warn


  !> The end of a job that failed. The first line of the text comes last, after its other lines: programs that start us
  !! read the last line.
  subroutine fail(self, text)
    class(journal_type), intent(inout) :: self
    character(*), intent(in) :: text
    integer :: first
    first = index(text, NEWLINE)
    if (first > 0) call put(self, text(first + 1:))
    if (first == 0) first = len(text) + 1
    call put(self, painted(self, '*ERROR', '31') // ': ' // text(:first - 1))
  end subroutine fail


  !> All remarks of the reader: file, line, what is wrong and what is allowed, and below it the card as written.
  subroutine complain(self, complaints)
    class(journal_type), intent(inout) :: self
    type(complaints_type), intent(in) :: complaints
    integer :: i, n_shown
    n_shown = 0
    do i = 1, complaints%n_items
      if (self%is_quiet .and. complaints%items(i)%is_warning) cycle
      n_shown = n_shown + 1
      if (n_shown > COMPLAINTS_SHOWN) exit
      call put_complaint(self, complaints%items(i))
    end do
    if (complaints%n_items > COMPLAINTS_SHOWN) then
      call put(self, 'These are the first ' // text_of(COMPLAINTS_SHOWN) // ' remarks.')
    end if
    if (complaints%n_items > 0 .and. n_shown > 0) then
      call put(self, 'The deck has ' // plural(complaints%n_errors, 'error') // ' and ' // &
        plural(complaints%n_warnings, 'warning') // '.')
    end if
  end subroutine complain


  !> One remark of the reader.
  subroutine put_complaint(journal, complaint)
    class(journal_type), intent(inout) :: journal
    type(complaint_type), intent(in) :: complaint
    character(:), allocatable :: mark, place
    if (complaint%is_warning) then
      mark = painted(journal, '*WARNING', '33')
    else
      mark = painted(journal, '*ERROR', '31')
    end if
    place = ''
    if (allocated(complaint%file)) place = complaint%file
    if (complaint%line > 0) place = place // ':' // text_of(complaint%line)
    if (len(place) > 0) place = place // ': '
    call put(journal, place // mark // ': ' // harmless(complaint%text))
    if (.not. allocated(complaint%card)) return
    if (len_trim(complaint%card) > LONGEST_ECHO) then
      call put(journal, '    ' // harmless(complaint%card(:LONGEST_ECHO)) // ' ...')
    else if (len_trim(complaint%card) > 0) then
      call put(journal, '    ' // trim(harmless(complaint%card)))
    end if
  end subroutine put_complaint


  !> A report: one sentence and the lines that explain it, set in.
  subroutine explain(self, text, lines)
    class(journal_type), intent(inout) :: self
    character(*), intent(in) :: text           !< what happened
    character(*), intent(in) :: lines(:)       !< what a person can do with it
    integer :: i
    call put(self, harmless(text))
    do i = 1, size(lines)
      if (lines(i) /= '') call put(self, '  ' // trim(harmless(lines(i))))
    end do
  end subroutine explain


  !> One attempt at an increment: what it cost, the status of the slave nodes, how far the job is.
  subroutine show_increment(self, record, fraction)
    class(journal_type), intent(inout) :: self
    type(increment_record_type), intent(in) :: record
    real(DP), intent(in) :: fraction           !< of the whole job done, 0 to 1 [-]
    character(100) :: line
    integer :: i
    self%fraction = fraction
    if (self%is_quiet .or. .not. self%has_increments) return
    if (.not. self%has_head) then
      call put(self, ' step   inc  att        time        size  iter    open   stick    slip    done  elapsed     left')
      self%has_head = .true.
    end if
    write (line, '(i5,i6,i5,2(1x,a11),i6,3i8,i6,a,a9,a9)') record%step, record%increment, record%attempt, &
      text_of(record%total_time), text_of(record%dt), record%n_iterations, record%n_status, &
      int(100 * fraction + 0.01_DP), ' %', duration(self%elapsed()), time_left(self)
    call put(self, trim(line))
    if (record%n_cycles > 0) call put(self, '        Slave nodes went in cycles, which were acted on for those nodes alone: ' // &
      plural(record%n_cycles, 'time') // '.')
    if (record%is_converged .and. record%n_snapped > 0) then
      call put(self, '        There was no balance near by: bodies were carried on to the next one in ' // &
        plural(record%n_snapped, 'iteration') // ', work ' // text_of(record%carried_now) // '.')
    else if (record%is_converged .and. record%n_carried > 0) then
      call put(self, '        Bodies that nothing held were carried to ' // &
        'where they touch in ' // plural(record%n_carried, 'iteration') // ', work ' // text_of(record%carried_now) // '.')
    end if
    if (record%is_converged .and. allocated(record%story)) then
      do i = 1, size(record%story)
        call put(self, '        ' // trim(harmless(record%story(i))))
      end do
    end if
    if (record%is_converged) return
    if (allocated(record%reason)) then
      call put(self, '        This attempt failed: ' // harmless(record%reason))
    else
      call put(self, '        This attempt failed.')
    end if
  end subroutine show_increment


  !> One iteration, on the live line of a terminal; elsewhere nothing is written.
  subroutine show_iteration(self, record)
    class(journal_type), intent(inout) :: self
    type(iteration_record_type), intent(in) :: record
    character(160) :: line
    if (self%is_quiet .or. .not. self%is_live) return
    write (line, '(3(a,i0),a,es7.1,2a)') 'Step ', record%step, ' inc ', record%increment, ' iter ', record%iteration, &
      ': ', record%residual, ', left ', adjustl(time_left(self))
    if (sum(record%n_status) > 0) write (line(len_trim(line) + 1:), '(2(a,i0),a,4(1x,i0))') ', stick ', &
      record%n_status(1), ', slip ', record%n_status(2), ', I-IV', record%n_scenario
    write (self%unit, '(3a)', advance='no') RETURN_KEY, trim(line(:LIVE_WIDTH)), ESCAPE // '[K'
    flush (self%unit)
    self%has_live_line = .true.
  end subroutine show_iteration


  !> The table at the end: the cost by phase, iterations, scenarios, contact, the balance of forces.
  subroutine show_summary(self, records)
    class(journal_type), intent(inout) :: self
    type(increment_record_type), intent(in) :: records(:)   !< all attempts of the job in their order
    if (self%is_quiet .or. size(records) == 0) return
    call put(self, '')
    call put_counts(self, records)
    call put_phases(self, records)
    call put_contact(self, records)
    call put_balance(self, records)
  end subroutine show_summary


  !> Increments, attempts, iterations, factorisations.
  subroutine put_counts(journal, records)
    class(journal_type), intent(inout) :: journal
    type(increment_record_type), intent(in) :: records(:)
    integer :: n_converged, n_iterations
    character(60) :: mean
    n_converged = count(records%is_converged)
    n_iterations = sum(records%n_iterations)
    mean = ''
    if (n_converged > 0) write (mean, '(a,f0.2,a)') '   (', real(n_iterations, DP) / real(n_converged, DP), &
      ' per increment, failed attempts counted)'
    call put_count(journal, 'increments converged', n_converged, '')
    call put_count(journal, 'attempts that failed', size(records) - n_converged, '')
    call put_count(journal, 'Newton iterations', n_iterations, trim(mean))
    call put_count(journal, 'factorisations', sum(records%n_factorisations), '')
    call put_count(journal, 'Krylov iterations', sum(records%n_krylov), '')
  end subroutine put_counts


  !> One line of the table: a name, a number, a remark.
  subroutine put_count(journal, name, value, remark)
    class(journal_type), intent(inout) :: journal
    character(*), intent(in) :: name
    integer, intent(in) :: value
    character(*), intent(in) :: remark
    character(30) :: left
    character(10) :: right
    left = name
    write (right, '(i10)') value
    call put(journal, '  ' // left // right // remark)
  end subroutine put_count


  !> Seconds by phase and their share.
  subroutine put_phases(journal, records)
    class(journal_type), intent(inout) :: journal
    type(increment_record_type), intent(in) :: records(:)
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
    call put(journal, '  by phase                          seconds             MB by which the peak of memory grew')
    do phase = 1, N_PHASES
      name = PHASE_NAMES(phase)
      write (line, '(4x,a28,f10.2,f7.1,a,f10.0)') name, seconds(phase), 100 * seconds(phase) / whole, ' %', megabytes(phase)
      call put(journal, trim(line))
    end do
    name = 'the whole job'
    write (line, '(4x,a28,f10.2,9x,f10.0)') name, journal%elapsed(), peak
    call put(journal, trim(line))
  end subroutine put_phases


  !> Scenarios of the line search, summed over all nodes and iterations, and the last status of the slave nodes.
  subroutine put_contact(journal, records)
    class(journal_type), intent(inout) :: journal
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
    call put(journal, trim(line))
    write (line, '(3(a,i0))') '  slave nodes at the end:  open ', records(last)%n_status(0), ',  stick ', &
      records(last)%n_status(1), ',  slip ', records(last)%n_status(2)
    call put(journal, trim(line))
    if (any(records%is_converged .and. records%n_status(1) + records%n_status(2) > 0)) return
    call put(journal, '*WARNING: No slave node touched its master at the end of any increment: these are results of ' // &
      'bodies without contact. Look at the gaps (COPEN) and at which surface is the slave (the finer or smaller one).')
  end subroutine put_contact


  !> The largest force imbalance of a converged increment, and where it was.
  subroutine put_balance(journal, records)
    class(journal_type), intent(inout) :: journal
    type(increment_record_type), intent(in) :: records(:)
    integer :: worst
    character(120) :: line
    if (.not. any(records%is_converged)) return
    worst = maxloc(records%residual, dim=1, mask=records%is_converged)
    write (line, '(a,es8.1,2(a,i0))') '  largest force imbalance:', records(worst)%residual, &
      ' of the largest force, in step ', records(worst)%step, ', increment ', records(worst)%increment
    call put(journal, trim(line))
  end subroutine put_balance


  !> Writes whole lines, after the live line is wiped out.
  subroutine put(journal, text)
    class(journal_type), intent(inout) :: journal
    character(*), intent(in) :: text
    integer :: unused                          ! a screen that is gone or full must not end the job
    if (allocated(journal%listener)) then
      call journal%listener%hear(text)
      return
    end if
    if (journal%has_live_line) write (journal%unit, '(2a)', advance='no', iostat=unused) RETURN_KEY, ESCAPE // '[K'
    journal%has_live_line = .false.
    write (journal%unit, '(a)', iostat=unused) text
    flush (journal%unit, iostat=unused)
  end subroutine put


  !> A word in colour if a person looks at a terminal.
  pure function painted(journal, word, colour) result(text)
    class(journal_type), intent(in) :: journal
    character(*), intent(in) :: word
    character(*), intent(in) :: colour         !< number of the colour (ECMA-48)
    character(:), allocatable :: text
    text = word
    if (journal%is_terminal) text = ESCAPE // '[' // colour // 'm' // word // ESCAPE // '[0m'
  end function painted


  !> The text with every `*ERROR` in it made `* ERROR`, and a question mark for what would steer a terminal: no echo of a
  !! deck may look like a failure, or do anything.
  pure function harmless(text) result(safe)
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
  end function harmless


  !> The rest of the job by the rule of three: elapsed time over the fraction done.
  function time_left(journal) result(text)
    class(journal_type), intent(in) :: journal
    character(:), allocatable :: text
    text = '?'
    if (journal%fraction > 0) text = duration(journal%elapsed() * max(0.0_DP, 1 - journal%fraction) / journal%fraction)
  end function time_left


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
