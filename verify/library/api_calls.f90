!> Every verb of the module amontons_library once; api_calls.c and test_api_calls.py do the same in the same order.
!! SPDX-License-Identifier: GPL-3.0-or-later
module line_counter
  use amontons_library, only: log_sink_type
  implicit none
  private
  public :: counter_type

  !> Counts the lines that it receives; of a line that holds several, each.
  type, extends(log_sink_type) :: counter_type
    integer, pointer :: n_lines => null()
  contains
    procedure :: write_lines
  end type counter_type

contains

  subroutine write_lines(self, text)
    class(counter_type), intent(inout) :: self
    character(*), intent(in) :: text
    integer :: i, first
    first = 1
    do i = 1, len(text) + 1
      if (i <= len(text)) then
        if (text(i:i) /= new_line('a')) cycle
      end if
      if (i > first) self%n_lines = self%n_lines + 1
      first = i + 1
    end do
  end subroutine write_lines

end module line_counter


program api_calls
  use, intrinsic :: iso_fortran_env, only: real64, int64
  use amontons_library, only: job_type, job_options_type, error_type, sparse_type, open_job, advance_job, advance_job_to, &
    try_job, begin_job, iterate_job, commit_job, rollback_job, finish_job, close_job, is_job_done, get_values, set_values, &
    get_names, get_matrix, VERDICT_CONTINUE, classify_slip_scenarios, friction_limit, slip_state_type, slip_controls_type, &
    slip_result_type, STATUS_STICK, STATUS_SLIP, NO_FRICTION_LIMIT
  use line_counter, only: counter_type
  implicit none
  type(job_type), allocatable :: job
  type(job_options_type) :: options
  type(error_type), allocatable :: error
  type(counter_type) :: counter
  character(:), allocatable :: deck
  character(500) :: path
  integer :: verdict, n_iterations, i
  real(real64), allocatable :: values(:, :), first(:, :), second(:, :)
  call get_command_argument(1, path)
  deck = text_of(trim(path))
  options%deck_text = deck
  options%has_files = .false.
  options%n_threads = 1
  allocate (counter%n_lines, source=0)
  allocate (job)
  call print_scenarios()
  call open_job(job, options, error, communicator=0)
  write (*, '(a,i0,2a)') 'a communicator: ', error%code, ', ', error%message
  call open_job(job, options, error, counter)
  call judge()
  call print_names('NODE SETS')
  call print_names('QUANTITIES')
  call advance_job(job, error)
  call judge()
  call advance_job_to(job, 0.35_real64, error)
  call judge()
  call print_all()
  call set_values(job, 'U3', 'UPPER_TOP', [-0.0011_real64], error)
  call judge()
  call set_values(job, 'CF', 'LOWER_TOP', [0.0_real64, 0.02_real64, 0.0_real64], error)
  call judge()
  call set_values(job, 'P', 'LOWER_TOP', [0.5_real64], error)
  call judge()
  call set_values(job, 'NT', 'UPPER_TOP', [35.0_real64], error)
  call judge()
  call set_values(job, 'FRICTION', 'RUBBING', [0.25_real64], error)
  call judge()
  call try_job(job, 0.2_real64, error)
  call judge()
  call print_all()
  call rollback_job(job, error)
  call judge()
  call print_all()
  call begin_job(job, 0.1_real64, error)
  call judge()
  n_iterations = 0
  do
    call iterate_job(job, verdict, error)
    call judge()
    n_iterations = n_iterations + 1
    if (verdict /= VERDICT_CONTINUE) exit
  end do
  write (*, '(a,i0,a,i0)') 'verdict ', verdict, ' after ', n_iterations
  call commit_job(job, error)
  call judge()
  call print_all()
  call print_matrix('TANGENT')
  call print_matrix('MAP')
  call print_matrix('STIFFNESS')
  call get_values(job, 'NONSENSE', '', values, error)
  write (*, '(a,i0,2a)') 'an unknown name: ', error%code, ', ', error%message
  call advance_job_to(job, 1.2_real64, error)
  call judge()
  write (*, '(a,i0)') 'done: ', merge(1, 0, is_job_done(job))
  do while (.not. is_job_done(job))
    call advance_job(job, error)
    call judge()
  end do
  call finish_job(job, error)
  call judge()
  call print_all()
  call advance_job(job, error)
  write (*, '(a,i0,2a)') 'after the end: ', error%code, ', ', error%message
  call close_job(job, error)
  write (*, '(a,i0)') 'heard: ', counter%n_lines

  !$omp parallel sections num_threads(2)
  !$omp section
  call work(first)
  !$omp section
  call work(second)
  !$omp end parallel sections
  do i = 1, 2
    if (i == 1) values = first
    if (i == 2) values = second
    write (*, '(a,i0,a,z16.16)') 'thread ', i, ': ', mixed(transfer(values, [0_int64]))
  end do

contains

  !> Ends the program if there is an error.
  subroutine judge()
    if (.not. allocated(error)) return
    write (*, '(a,i0,2a)') 'status ', error%code, ': ', error%message
    error stop 1
  end subroutine judge


  !> A job of its own for a thread: from the file, to the time 0.4.
  subroutine work(u)
    real(real64), allocatable, intent(out) :: u(:, :)
    type(job_type), allocatable :: mine
    type(job_options_type) :: wanted
    type(error_type), allocatable :: wrong
    wanted%deck = trim(path)
    wanted%has_files = .false.
    wanted%n_threads = 1
    allocate (mine)
    call open_job(mine, wanted, wrong)
    if (.not. allocated(wrong)) call advance_job_to(mine, 0.4_real64, wrong)
    if (.not. allocated(wrong)) call get_values(mine, 'U', '', u, wrong)
    if (allocated(wrong)) error stop 1
    call close_job(mine, wrong)
  end subroutine work


  !> One number of all bits of some numbers, in their order.
  pure integer(int64) function mixed(bits) result(sum)
    integer(int64), intent(in) :: bits(:)
    integer :: k
    sum = 0
    do k = 1, size(bits)
      sum = ieor(sum, ishftc(bits(k), mod(k - 1, 63) + 1))
    end do
  end function mixed


  subroutine print_values(quantity, set)
    character(*), intent(in) :: quantity, set
    call get_values(job, quantity, set, values, error)
    call judge()
    write (*, '(4a,i0,a,i0,1x,z16.16)') quantity, ' of ''', set, ''': ', size(values, 2), ' x ', size(values, 1), &
      mixed(transfer(values, [0_int64]))
  end subroutine print_values


  subroutine print_all()
    character(14), parameter :: NODAL(*) = [character(14) :: 'NODES', 'X', 'U', 'RF', 'S', 'E', 'NT', 'CPRESS', 'CSHEAR', &
      'COPEN', 'CSLIP', 'CNORMF', 'CSHEARF', 'CSTATUS', 'CSCENARIO', 'CONTACT FORCE', 'INTERNAL FORCE', 'APPLIED FORCE', &
      'RESIDUAL']
    character(13), parameter :: NUMBERS(*) = [character(13) :: 'TIME', 'STEP TIME', 'TIME LEFT', 'STEP', 'INCREMENTS', &
      'ITERATIONS', 'FRICTION', 'FRICTION WORK', 'EXTERNAL WORK', 'STRAIN ENERGY']
    integer :: k
    do k = 1, size(NODAL)
      call print_values(trim(NODAL(k)), '')
    end do
    do k = 1, size(NUMBERS)
      call print_values(trim(NUMBERS(k)), '')
    end do
    call print_values('P', 'LOWER_TOP')
    call print_values('FACE CENTRES', 'LOWER_TOP')
    call print_values('CF', 'LOWER_TOP')
    call print_values('U', 'UPPER_TOP')
    call print_values('POINT S', 'UPPER')
    call print_values('ELEMENT S', 'UPPER')
    call print_values('ELEMENT LABEL', 'UPPER')
  end subroutine print_all


  !> Nodes in scenarios I to IV, and one that opens. The compiler sees to it that there are arrays: the second line is C's.
  subroutine print_scenarios()
    real(real64) :: Rt(3, 5, 2), N(5, 2), slip(3, 5, 2), d(3, 5), alpha(5)
    type(slip_state_type) :: at(5, 2)
    type(slip_result_type) :: found(5)
    integer :: i, k
    Rt = 0
    Rt(1, :, 1) = [5, 5, 1, 1, 1]
    Rt(1, :, 2) = [2, 4, 4, 2, 1]
    N = 10
    N(5, 1) = -1
    slip = 0
    slip(1, 3:4, 1) = 0.2_real64
    slip(1, 3:4, 2) = [0.1_real64, -0.1_real64]
    d = 0
    d(1, :) = [0.1_real64, 0.1_real64, -0.1_real64, -0.3_real64, 0.1_real64]
    at = reshape([((slip_state_type(STATUS_SLIP, N(i, k), Rt(:, i, k), &
      friction_limit(0.3_real64, max(N(i, k), 0.0_real64), NO_FRICTION_LIMIT), slip(:, i, k)), i=1, 5), k=1, 2)], [5, 2])
    call classify_slip_scenarios(at(:, 1), at(:, 2), d, slip_controls_type(), found)
    alpha = found%alpha
    write (*, '(a,10(1x,i0),1x,z16.16)') 'scenarios: 0', found%scenario, &
      merge(STATUS_STICK, found%status, found%becomes_stick), mixed(transfer(alpha, [0_int64]))
    write (*, '(a)') 'no nodes: 2'
  end subroutine print_scenarios


  !> The indices of the module count from 1, those of C and Python from 0.
  subroutine print_matrix(name)
    character(*), intent(in) :: name
    type(sparse_type) :: matrix
    real(real64), allocatable :: residual(:)
    call get_matrix(job, name, matrix, residual, error)
    call judge()
    write (*, '(2a,2(i0,a),i0,a,3(1x,z16.16),a,z16.16)') name, ': ', matrix%n_rows, ' x ', matrix%n_columns, ', ', &
      size(matrix%value), ' entries', mixed(int(matrix%first, int64) - 1), mixed(int(matrix%column, int64) - 1), &
      mixed(transfer(matrix%value, [0_int64])), ', residual ', mixed(transfer(residual, [0_int64]))
  end subroutine print_matrix


  subroutine print_names(kind)
    character(*), intent(in) :: kind
    character(:), allocatable :: names(:), line
    integer :: k
    call get_names(job, kind, names, error)
    call judge()
    line = kind // ': '
    do k = 1, size(names)
      line = line // trim(names(k))
      if (k < size(names)) line = line // ' '
    end do
    write (*, '(a)') line
  end subroutine print_names


  function text_of(file) result(text)
    character(*), intent(in) :: file
    character(:), allocatable :: text
    integer :: unit, length
    open (newunit=unit, file=file, access='stream', form='unformatted', status='old', action='read')
    inquire (unit, size=length)
    allocate (character(length) :: text)
    read (unit) text
    close (unit)
  end function text_of

end program api_calls
