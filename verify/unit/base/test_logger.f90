!> Unit test of the logger: the printed lines, and the marks that calling programs search for.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_logger
  use check, only: suite_type
  use amontons_kinds, only: DP
  use amontons_errors, only: diagnostic_list_type
  use amontons_text, only: NEWLINE
  use amontons_iteration_records, only: increment_record_type, iteration_record_type
  use amontons_logger, only: logger_type, open_logger, PROGRESS_AUTO, PROGRESS_NONE
  implicit none
  integer, parameter :: WIDTH = 200
  type(suite_type) :: suite

  call test_failure()
  call test_harmless_echo()
  call test_complaints()
  call test_quiet()
  call test_increments()
  call test_summary()
  call suite%finish()

contains

  !> A logger that writes to a scratch file.
  subroutine open_scratch(logger, unit, is_quiet, progress)
    type(logger_type), intent(out) :: logger
    integer, intent(out) :: unit
    logical, intent(in) :: is_quiet
    integer, intent(in) :: progress
    open (newunit=unit, status='scratch', action='readwrite')
    call open_logger(logger, is_quiet, progress, unit)
  end subroutine open_scratch


  !> All lines written.
  function lines_of(unit) result(lines)
    integer, intent(in) :: unit
    character(WIDTH), allocatable :: lines(:)
    integer :: i, n, status
    rewind (unit)
    n = 0
    do
      read (unit, '(a)', iostat=status)
      if (status /= 0) exit
      n = n + 1
    end do
    rewind (unit)
    allocate (lines(n))
    do i = 1, n
      read (unit, '(a)') lines(i)
    end do
    close (unit)
  end function lines_of


  !> The first line of a message comes last, and starts with the mark.
  subroutine test_failure()
    type(logger_type) :: logger
    character(WIDTH), allocatable :: lines(:)
    integer :: unit
    call open_scratch(logger, unit, .false., PROGRESS_NONE)
    call logger%fail('It broke.' // NEWLINE // 'Look at node 7.' // NEWLINE // 'Or at node 8.')
    lines = lines_of(unit)
    call suite%that('a failure of three lines writes three', size(lines) == 3)
    call suite%that('the details come first', lines(1) == 'Look at node 7.' .and. lines(2) == 'Or at node 8.')
    call suite%that('the last line starts with the word', lines(3) == '*ERROR: It broke.')
  end subroutine test_failure


  !> Echoed deck lines do not look like a failure.
  subroutine test_harmless_echo()
    type(logger_type) :: logger
    character(WIDTH), allocatable :: lines(:)
    character(30) :: details(1)
    integer :: unit
    call open_scratch(logger, unit, .false., PROGRESS_NONE)
    details = 'a *ERROR'
    call logger%say('*ERROR and *ERROR')
    call logger%warn('Heading: *ERROR')
    call logger%show_report('Why *ERROR', details)
    lines = lines_of(unit)
    call suite%that('four lines', size(lines) == 4)
    call suite%that('none has the word', all(index(lines, '*ERROR') == 0))
    call suite%that('a warning starts with its word', index(lines(2), '*WARNING: Heading') == 1)
    call suite%that('lines that explain are set in', index(lines(4), '  a ') == 1)
  end subroutine test_harmless_echo


  !> File, line, text, card, and the count at the end.
  subroutine test_complaints()
    type(logger_type) :: logger
    type(diagnostic_list_type) :: diagnostics
    character(WIDTH), allocatable :: lines(:)
    integer :: unit
    call open_scratch(logger, unit, .false., PROGRESS_NONE)
    call diagnostics%add('a.inp', 12, '*ELASTIK', 'There is no such card.')
    call diagnostics%add('a.inp', 0, '', 'There is no step.')
    call diagnostics%add('b.inc', 3, '1, 2', 'Two nodes are one.', is_warning=.true.)
    call logger%show_diagnostics(diagnostics)
    lines = lines_of(unit)
    call suite%that('six lines', size(lines) == 6)
    call suite%that('place and text', lines(1) == 'a.inp:12: *ERROR: There is no such card.')
    call suite%that('the card as written', lines(2) == '    *ELASTIK')
    call suite%that('no line, no card', lines(3) == 'a.inp: *ERROR: There is no step.')
    call suite%that('a warning', lines(4) == 'b.inc:3: *WARNING: Two nodes are one.')
    call suite%that('the count', lines(6) == 'The deck has 2 errors and 1 warning.')
  end subroutine test_complaints


  !> A quiet logger writes failures and errors of the deck, nothing else.
  subroutine test_quiet()
    type(logger_type) :: logger
    type(diagnostic_list_type) :: diagnostics
    type(increment_record_type) :: record
    type(iteration_record_type) :: iteration
    character(WIDTH), allocatable :: lines(:)
    integer :: unit
    call open_scratch(logger, unit, .true., PROGRESS_AUTO)
    call diagnostics%add('a.inp', 1, '*X', 'A warning.', is_warning=.true.)
    call logger%say('Hello')
    call logger%warn('Hello')
    call logger%show_diagnostics(diagnostics)
    call logger%show_iteration(iteration)
    call logger%show_increment(record, 0.5_DP)
    call logger%show_summary([record], 1000000)
    call logger%fail('The end.')
    lines = lines_of(unit)
    call suite%that('one line', size(lines) == 1)
    call suite%that('the failure', lines(1) == '*ERROR: The end.')
  end subroutine test_quiet


  !> One header, one line for each attempt, and the reason of a failed attempt.
  subroutine test_increments()
    type(logger_type) :: logger
    type(increment_record_type) :: record
    character(WIDTH), allocatable :: lines(:)
    integer :: unit
    call open_scratch(logger, unit, .false., PROGRESS_AUTO)
    record = increment_record_type(step=2, increment=7, attempt=1, total_time=1.25_DP, dt=0.25_DP, n_iterations=5, &
      n_status=[10, 20, 30])
    record%reason = 'the residual grew'
    call logger%show_increment(record, 0.25_DP)
    record%is_converged = .true.
    call logger%show_increment(record, 0.5_DP)
    lines = lines_of(unit)
    call suite%that('four lines', size(lines) == 4)
    call suite%that('the head comes once', index(lines(1), 'step') > 0 .and. all(index(lines(2:), 'step') == 0))
    call suite%that('the reason', index(lines(3), 'failed: the residual grew') > 0)
    call suite%that('how far the job is', index(lines(4), ' 50 %') > 0)
    call suite%that('columns stand under their names', len_trim(lines(2)) == len_trim(lines(1)))
    call compare_columns(lines(4))
  end subroutine test_increments


  !> The numbers of the line of an increment, in their order.
  subroutine compare_columns(line)
    character(*), intent(in) :: line
    integer :: i(3), n(4)
    real(DP) :: x(2)
    read (line, *) i, x, n
    call suite%that('step, increment, attempt', all(i == [2, 7, 1]))
    call suite%near('time', x(1), 1.25_DP, epsilon(1.0_DP))
    call suite%near('size', x(2), 0.25_DP, epsilon(1.0_DP))
    call suite%that('iterations, open, stick, slip', all(n == [5, 10, 20, 30]))
  end subroutine compare_columns


  !> Sums over all attempts; the largest force imbalance is that of a converged increment.
  subroutine test_summary()
    type(logger_type) :: logger
    type(increment_record_type) :: records(3)
    character(WIDTH), allocatable :: lines(:)
    integer :: unit
    call open_scratch(logger, unit, .false., PROGRESS_NONE)
    records%n_iterations = [4, 9, 5]
    records%is_converged = [.true., .false., .true.]
    records%residual = [1.0e-8_DP, 0.5_DP, 2.0e-8_DP]
    records%step = 1
    records%increment = [1, 2, 2]
    records(3)%n_status = [1, 2, 3]
    call logger%show_summary(records, 1000000)
    lines = lines_of(unit)
    call suite%that('converged', has(lines, 'increments converged', '2'))
    call suite%that('failed', has(lines, 'attempts that failed', '1'))
    call suite%that('iterations, and their mean by increment', has(lines, 'Newton iterations', '18   (9.00 per'))
    call suite%that('memory by unknown', has(lines, 'peak of memory by unknown', ' kB   (1000000 unknowns)'))
    call suite%that('the last status', has(lines, 'slave nodes at the end', 'open 1,  stick 2,  slip 3'))
    call suite%that('the worst balance', has(lines, 'imbalance', '2.0E-08 of the largest force, in step 1, inc'))
  end subroutine test_summary


  !> Whether one line contains both texts.
  pure function has(lines, first, second) result(is_there)
    character(*), intent(in) :: lines(:), first, second
    logical :: is_there
    is_there = any(index(lines, first) > 0 .and. index(lines, second) > 0)
  end function has

end program test_logger
