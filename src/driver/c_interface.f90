!> The C API behind an opaque handle (amontons.h).
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_c_interface
  use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_f_procpointer, c_funptr, c_int, &
    c_int32_t, c_int64_t, c_loc, c_null_char, c_null_ptr, c_ptr
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SUCCESS, EXIT_USAGE, EXIT_SOLVER
  use amontons_text, only: name_key, NEWLINE
  use amontons_posix, only: process_lock_type, acquire_lock
  use amontons_version, only: VERSION
  use amontons_model, only: DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_sparse, only: sparse_type
  use amontons_library, only: job_type, job_options_type, log_sink_type, open_job, advance_job, advance_job_to, try_job, &
    begin_job, iterate_job, commit_job, rollback_job, finish_job, close_job, is_job_done, get_values, set_values, &
    get_names, get_matrix, classify_slip_scenarios, friction_limit, slip_state_type, slip_controls_type, slip_result_type, &
    STATUS_STICK, STATUS_SLIP, NO_FRICTION_LIMIT
  implicit none
  private

  integer(c_int32_t), parameter :: ABI = 4         !< AMONTONS_ABI of the header
  !> amontons_options of the header.
  type, bind(C) :: options_type
    integer(c_int32_t) :: abi, n_threads, has_files, has_checkpoint, is_resumed, is_check, n_partitions
    type(c_ptr) :: deck, text, job, outdir, dialect, user, old_job
    type(c_funptr) :: log
    type(c_ptr) :: context
  end type options_type

  !> Target of the handle.
  type :: handle_type
    type(job_type) :: job
    character(kind=c_char), pointer :: message(:) => null()
    type(sparse_type) :: matrix                    !< the last one requested
    real(DP), allocatable :: residual(:)
  end type handle_type

  !> Log sink that passes the lines to a function of the caller.
  type, extends(log_sink_type) :: c_log_sink_type
    type(c_funptr) :: log
    type(c_ptr) :: context = c_null_ptr
  contains
    procedure :: write_lines => forward_lines
  end type c_log_sink_type

  abstract interface
    !> amontons_log of the header.
    subroutine log_function(context, line) bind(C)
      import :: c_char, c_ptr
      implicit none
      type(c_ptr), value :: context
      character(kind=c_char), intent(in) :: line(*)
    end subroutine log_function
  end interface

  interface
    pure function c_strlen(text) bind(C, name='strlen') result(length)
      import :: c_int64_t, c_ptr
      implicit none
      type(c_ptr), value :: text
      integer(c_int64_t) :: length
    end function c_strlen
  end interface

contains

  !> The version of the binary interface.
  integer(c_int) function capi_abi() bind(C, name='amontons_abi')
    capi_abi = ABI
  end function capi_abi


  !> Status, scenario and step length of the caller's own slave nodes; array indices have the reverse order in C.
  integer(c_int) function capi_classify(n, Rt, normal_force, slip, direction, mu, controls, verdicts, alpha) &
    bind(C, name='amontons_classify') result(status)
    integer(c_int64_t), value :: n                 !< nodes
    real(c_double), intent(in), optional :: Rt(3, n, 2)   !< tangential imbalance at u and at u + d [force]
    real(c_double), intent(in), optional :: normal_force(n, 2)   !< the same [force]
    real(c_double), intent(in), optional :: slip(3, n, 2)   !< since the start of the increment [length]
    real(c_double), intent(in), optional :: direction(3, n)   !< d, tangential, relative to the master [length]
    real(c_double), intent(in), optional :: mu(n)  !< coefficients of friction [-]
    real(c_double), intent(in), optional :: controls(5)   !< balance, force_zero, slip_zero, alpha_min, alpha_max
    integer(c_int32_t), intent(out), optional :: verdicts(2, n)   !< scenario and state
    real(c_double), intent(out), optional :: alpha(n)   !< [-]
    type(slip_controls_type) :: bounds
    type(slip_state_type), allocatable :: at(:, :)   ! (n, 2) at u and at u + d
    type(slip_result_type), allocatable :: found(:)
    real(DP) :: slip_zero
    integer :: i, k
    status = EXIT_USAGE
    if (n < 0 .or. .not. (present(Rt) .and. present(normal_force) .and. present(slip) .and. present(direction) .and. &
      present(mu))) return
    allocate (at(n, 2), found(n))
    slip_zero = 0.0_DP
    if (present(controls)) then
      bounds = slip_controls_type(controls(1), controls(2), controls(4), controls(5))
      slip_zero = controls(3)
    end if
    do k = 1, 2
      do i = 1, int(n)
        at(i, k) = slip_state_type(STATUS_SLIP, normal_force(i, k), Rt(:, i, k), &
          friction_limit(mu(i), max(normal_force(i, k), 0.0_DP), NO_FRICTION_LIMIT), slip(:, i, k), slip_zero)
      end do
    end do
    call classify_slip_scenarios(at(:, 1), at(:, 2), direction, bounds, found)
    if (present(verdicts)) verdicts = transpose(reshape([found%scenario, &
      merge(STATUS_STICK, found%status, found%becomes_stick)], [size(found), 2]))
    if (present(alpha)) alpha = found%alpha
    status = EXIT_SUCCESS
  end function capi_classify


  !> The version of the program, truncated to the buffer.
  subroutine capi_version(text, buffer_size) bind(C, name='amontons_version')
    integer(c_int), value :: buffer_size                  !< characters, the ending 0 included
    character(kind=c_char), intent(out) :: text(buffer_size)
    integer :: i
    do i = 1, min(buffer_size - 1, len(VERSION))
      text(i) = VERSION(i:i)
    end do
    if (buffer_size > 0) text(min(buffer_size, len(VERSION) + 1)) = c_null_char
  end subroutine capi_version


  !> Opens a job.
  integer(c_int) function capi_open(options, handle) bind(C, name='amontons_open') result(status)
    type(c_ptr), value :: options                  !< amontons_options
    type(c_ptr), intent(out), optional :: handle   !< optional like all output arguments here: NULL is allowed
    status = open_handle(options, handle)
  end function capi_open


  !> Opens a job on the ranks of a communicator.
  integer(c_int) function capi_open_on(options, communicator, handle) bind(C, name='amontons_open_on') result(status)
    type(c_ptr), value :: options                  !< amontons_options
    integer(c_int), value :: communicator          !< MPI_Comm_c2f of an MPI_Comm
    type(c_ptr), intent(out), optional :: handle
    status = open_handle(options, handle, int(communicator))
  end function capi_open_on


  !> Allocates a handle and opens its job.
  integer(c_int) function open_handle(options, handle, communicator) result(status)
    type(c_ptr), intent(in) :: options             !< amontons_options
    type(c_ptr), intent(out), optional :: handle
    integer, intent(in), optional :: communicator
    type(options_type), pointer :: given
    type(handle_type), pointer :: self
    type(job_options_type) :: wanted
    type(c_log_sink_type) :: log_sink
    type(error_type), allocatable :: error
    integer :: no_memory
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    status = EXIT_USAGE
    if (.not. present(handle)) return
    handle = c_null_ptr
    if (.not. c_associated(options)) return
    call c_f_pointer(options, given)
    allocate (self, stat=no_memory)
    status = EXIT_SOLVER
    if (no_memory /= 0) return
    handle = c_loc(self)
    call convert_options(given, wanted, error)
    if (.not. allocated(error)) then
      log_sink%log = given%log
      log_sink%context = given%context
      if (c_associated(given%log)) then
        call open_job(self%job, wanted, error, log_sink, communicator)
      else
        call open_job(self%job, wanted, error, communicator=communicator)
      end if
    end if
    status = status_of(self, error)
  end function open_handle


  !> Converts the options of C. Errors: another binary interface, an unknown dialect.
  subroutine convert_options(options, wanted, error)
    type(options_type), intent(in) :: options
    type(job_options_type), intent(inout) :: wanted
    type(error_type), allocatable, intent(out) :: error
    if (options%abi /= ABI) then
      call set_error(error, EXIT_USAGE, 'The calling program was built for another binary interface of Amontons: ' // &
        'build it again with the amontons.h of this library.')
      return
    end if
    if (c_associated(options%deck)) wanted%deck = text_at(options%deck)
    if (c_associated(options%text)) wanted%deck_text = text_at(options%text)
    if (c_associated(options%job)) wanted%job = text_at(options%job)
    if (c_associated(options%outdir)) wanted%outdir = text_at(options%outdir)
    if (c_associated(options%user)) wanted%user = text_at(options%user)
    if (c_associated(options%old_job)) wanted%old_job = text_at(options%old_job)
    wanted%n_threads = max(1, options%n_threads)
    wanted%is_guarded = options%has_checkpoint /= 0
    wanted%is_resumed = options%is_resumed /= 0
    wanted%n_partitions = options%n_partitions
    wanted%has_files = options%has_files /= 0 .or. wanted%is_guarded .or. wanted%is_resumed .or. wanted%n_partitions /= 0
    wanted%is_check = options%is_check /= 0
    if (.not. c_associated(options%dialect)) return
    select case (name_key(text_at(options%dialect)))
    case ('ABAQUS')
      wanted%dialect = DIALECT_ABAQUS
    case ('CALCULIX')
      wanted%dialect = DIALECT_CALCULIX
    case default
      call set_error(error, EXIT_USAGE, 'The dialect can be abaqus or calculix.')
    end select
  end subroutine convert_options


  !> Closes a job and frees its memory.
  subroutine capi_close(handle) bind(C, name='amontons_close')
    type(c_ptr), value :: handle
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    if (.not. c_associated(handle)) return
    call c_f_pointer(handle, self)
    call close_job(self%job, error)
    if (associated(self%message)) deallocate (self%message)
    deallocate (self)
  end subroutine capi_close


  !> The message of the last call that failed.
  type(c_ptr) function capi_message(handle) bind(C, name='amontons_message') result(text)
    type(c_ptr), value :: handle
    type(handle_type), pointer :: self
    text = c_null_ptr
    if (.not. c_associated(handle)) return
    call c_f_pointer(handle, self)
    if (.not. associated(self%message)) call keep_message(self, '')
    text = c_loc(self%message)
  end function capi_message


  !> 1: all steps are done.
  integer(c_int) function capi_is_done(handle) bind(C, name='amontons_is_done') result(answer)
    type(c_ptr), value :: handle
    type(handle_type), pointer :: self
    answer = 1
    if (.not. c_associated(handle)) return
    call c_f_pointer(handle, self)
    answer = merge(1_c_int, 0_c_int, is_job_done(self%job))
  end function capi_is_done


  !> Solves and commits one increment.
  integer(c_int) function capi_advance(handle) bind(C, name='amontons_advance') result(status)
    type(c_ptr), value :: handle
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    if (.not. is_handle_valid(handle, self, status)) return
    call advance_job(self%job, error)
    status = status_of(self, error)
  end function capi_advance


  !> Solves increments until a total time, each committed.
  integer(c_int) function capi_advance_to(handle, total_time) bind(C, name='amontons_advance_to') result(status)
    type(c_ptr), value :: handle
    real(c_double), value :: total_time            !< [time]
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    if (.not. is_handle_valid(handle, self, status)) return
    call advance_job_to(self%job, total_time, error)
    status = status_of(self, error)
  end function capi_advance_to


  !> Solves to the current time + dt without a commit.
  integer(c_int) function capi_try(handle, dt) bind(C, name='amontons_try') result(status)
    type(c_ptr), value :: handle
    real(c_double), value :: dt                    !< [time]
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    if (.not. is_handle_valid(handle, self, status)) return
    call try_job(self%job, dt, error)
    status = status_of(self, error)
  end function capi_try


  !> Starts an increment to be iterated.
  integer(c_int) function capi_begin(handle, dt) bind(C, name='amontons_begin') result(status)
    type(c_ptr), value :: handle
    real(c_double), value :: dt                    !< [time]
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    if (.not. is_handle_valid(handle, self, status)) return
    call begin_job(self%job, dt, error)
    status = status_of(self, error)
  end function capi_begin


  !> One Newton iteration.
  integer(c_int) function capi_iterate(handle, verdict) bind(C, name='amontons_iterate') result(status)
    type(c_ptr), value :: handle
    integer(c_int), intent(out), optional :: verdict   !< AMONTONS_GO_ON, ...
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    integer :: found
    if (present(verdict)) verdict = 0
    if (.not. is_handle_valid(handle, self, status)) return
    call iterate_job(self%job, found, error)
    if (present(verdict)) verdict = found
    status = status_of(self, error)
  end function capi_iterate


  !> Commits the increments solved since the last commit.
  integer(c_int) function capi_commit(handle) bind(C, name='amontons_commit') result(status)
    type(c_ptr), value :: handle
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    if (.not. is_handle_valid(handle, self, status)) return
    call commit_job(self%job, error)
    status = status_of(self, error)
  end function capi_commit


  !> Restores the last commit.
  integer(c_int) function capi_rollback(handle) bind(C, name='amontons_rollback') result(status)
    type(c_ptr), value :: handle
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    if (.not. is_handle_valid(handle, self, status)) return
    call rollback_job(self%job, error)
    status = status_of(self, error)
  end function capi_rollback


  !> Closes the files.
  integer(c_int) function capi_finish(handle) bind(C, name='amontons_finish') result(status)
    type(c_ptr), value :: handle
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    if (.not. is_handle_valid(handle, self, status)) return
    call finish_job(self%job, error)
    status = status_of(self, error)
  end function capi_finish


  !> A quantity by name; with values = NULL only its shape.
  integer(c_int) function capi_get(handle, quantity, set, values, capacity, rows, columns) &
    bind(C, name='amontons_get') result(status)
    type(c_ptr), value :: handle, quantity, set
    type(c_ptr), value :: values                   !< double[capacity], or NULL
    integer(c_int64_t), value :: capacity
    integer(c_int64_t), intent(out), optional :: rows, columns
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    real(DP), allocatable :: found(:, :)
    real(c_double), pointer :: target(:, :)
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (present(rows)) rows = 0
    if (present(columns)) columns = 0
    if (.not. is_handle_valid(handle, self, status)) return
    call get_values(self%job, text_at(quantity), text_at(set), found, error)
    if (.not. allocated(error)) then
      if (present(columns)) columns = size(found, 1, kind=c_int64_t)
      if (present(rows)) rows = size(found, 2, kind=c_int64_t)
      if (c_associated(values) .and. capacity < size(found, kind=c_int64_t)) then
        call set_error(error, EXIT_USAGE, 'The array is too small for the values of ' // text_at(quantity) // '.')
      else if (c_associated(values)) then
        call c_f_pointer(values, target, shape(found))
        target = found
      end if
    end if
    status = status_of(self, error)
  end function capi_get


  !> Sets a quantity by name.
  integer(c_int) function capi_set(handle, quantity, set, values, n) bind(C, name='amontons_set') result(status)
    type(c_ptr), value :: handle, quantity, set
    type(c_ptr), value :: values                   !< double[n]
    integer(c_int64_t), value :: n
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    real(c_double), pointer :: given(:)
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (.not. is_handle_valid(handle, self, status)) return
    if (n <= 0 .or. .not. c_associated(values)) then
      call set_error(error, EXIT_USAGE, 'No values of ' // text_at(quantity) // ' are given.')
    else
      call c_f_pointer(values, given, [n])
      call set_values(self%job, text_at(quantity), text_at(set), given, error)
    end if
    status = status_of(self, error)
  end function capi_set


  !> The names of a kind, one per line, ended by 0; with text = NULL only the size needed, including the 0.
  integer(c_int) function capi_names(handle, kind, text, buffer_size, needed) bind(C, name='amontons_names') result(status)
    type(c_ptr), value :: handle, kind
    type(c_ptr), value :: text                     !< char[capacity], or NULL
    integer(c_int64_t), value :: buffer_size
    integer(c_int64_t), intent(out), optional :: needed
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    character(:), allocatable :: names(:)
    character(kind=c_char), pointer :: letters(:)
    integer :: i, at
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (present(needed)) needed = 0
    if (.not. is_handle_valid(handle, self, status)) return
    call get_names(self%job, text_at(kind), names, error)
    if (.not. allocated(error)) then
      at = max(1, sum(len_trim(names) + 1))
      if (present(needed)) needed = int(at, c_int64_t)
      if (c_associated(text) .and. buffer_size < int(at, c_int64_t)) then
        call set_error(error, EXIT_USAGE, 'The buffer is too small for the names of ' // text_at(kind) // '.')
      else if (c_associated(text)) then
        call c_f_pointer(text, letters, [at])
        at = 0
        do i = 1, size(names)
          letters(at + 1:at + len_trim(names(i)) + 1) = transfer(trim(names(i)) // NEWLINE, letters)
          at = at + len_trim(names(i)) + 1
        end do
        letters(max(1, at)) = c_null_char
      end if
    end if
    status = status_of(self, error)
  end function capi_names


  !> Computes a matrix and returns its sizes.
  integer(c_int) function capi_matrix(handle, name, rows, columns, entries) bind(C, name='amontons_matrix') &
    result(status)
    type(c_ptr), value :: handle, name
    integer(c_int64_t), intent(out), optional :: rows, columns, entries
    type(handle_type), pointer :: self
    type(error_type), allocatable :: error
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (present(rows)) rows = 0
    if (present(columns)) columns = 0
    if (present(entries)) entries = 0
    if (.not. is_handle_valid(handle, self, status)) return
    call get_matrix(self%job, text_at(name), self%matrix, self%residual, error)
    if (.not. allocated(error)) then
      if (present(rows)) rows = int(self%matrix%n_rows, c_int64_t)
      if (present(columns)) columns = int(self%matrix%n_columns, c_int64_t)
      if (present(entries)) entries = size(self%matrix%value, kind=c_int64_t)
    end if
    status = status_of(self, error)
  end function capi_matrix


  !> Copies the matrix computed last.
  integer(c_int) function capi_matrix_copy(handle, first, column, values) bind(C, name='amontons_matrix_copy') &
    result(status)
    type(c_ptr), value :: handle
    integer(c_int64_t), intent(out), optional :: first(*)    !< (rows + 1), from 0
    integer(c_int64_t), intent(out), optional :: column(*)   !< (entries), from 0
    real(c_double), intent(out), optional :: values(*)       !< (entries)
    type(handle_type), pointer :: self
    if (.not. is_handle_valid(handle, self, status)) return
    status = EXIT_USAGE
    if (.not. allocated(self%matrix%first)) return
    if (present(first)) first(:size(self%matrix%first)) = int(self%matrix%first, c_int64_t) - 1_c_int64_t
    if (present(column)) column(:size(self%matrix%column)) = int(self%matrix%column, c_int64_t) - 1_c_int64_t
    if (present(values)) values(:size(self%matrix%value)) = self%matrix%value
    status = EXIT_SUCCESS
  end function capi_matrix_copy


  !> Copies the residual of the free unknowns.
  integer(c_int) function capi_residual_copy(handle, values) bind(C, name='amontons_residual_copy') result(status)
    type(c_ptr), value :: handle
    real(c_double), intent(out), optional :: values(*)   !< (free unknowns) [force]
    type(handle_type), pointer :: self
    if (.not. is_handle_valid(handle, self, status)) return
    status = EXIT_USAGE
    if (.not. allocated(self%residual)) return
    if (present(values)) values(:size(self%residual)) = self%residual
    status = EXIT_SUCCESS
  end function capi_residual_copy


  !> Dereferences a handle; every procedure calls this first. NULL is invalid.
  logical function is_handle_valid(handle, self, status)
    type(c_ptr), intent(in) :: handle
    type(handle_type), pointer, intent(out) :: self
    integer(c_int), intent(out) :: status          !< EXIT_USAGE for an invalid handle
    nullify (self)
    status = EXIT_SUCCESS
    is_handle_valid = c_associated(handle)
    if (is_handle_valid) call c_f_pointer(handle, self)
    if (.not. is_handle_valid) status = EXIT_USAGE
  end function is_handle_valid


  !> Status of a call; stores the message of an error.
  integer(c_int) function status_of(self, error) result(status)
    type(handle_type), intent(inout) :: self
    type(error_type), allocatable, intent(in) :: error
    status = EXIT_SUCCESS
    if (.not. allocated(error)) return
    status = error%code
    call keep_message(self, error%message)
  end function status_of


  !> Stores a message as a C string.
  subroutine keep_message(self, text)
    type(handle_type), intent(inout) :: self
    character(*), intent(in) :: text
    integer :: i
    if (associated(self%message)) deallocate (self%message)
    allocate (self%message(len(text) + 1))
    do i = 1, len(text)
      self%message(i) = text(i:i)
    end do
    self%message(len(text) + 1) = c_null_char
  end subroutine keep_message


  !> Text of a C string; NULL gives an empty text.
  function text_at(address) result(text)
    type(c_ptr), intent(in) :: address
    character(:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    integer :: i
    if (.not. c_associated(address)) then
      text = ''
      return
    end if
    call c_f_pointer(address, letters, [c_strlen(address)])
    allocate (character(size(letters)) :: text)
    do i = 1, size(letters)
      text(i:i) = letters(i)
    end do
  end function text_at


  !> Passes lines on one by one.
  subroutine forward_lines(self, text)
    class(c_log_sink_type), intent(inout) :: self
    character(*), intent(in) :: text
    procedure(log_function), pointer :: log
    integer :: first, length
    call c_f_procpointer(self%log, log)
    first = 1
    do
      length = index(text(first:), NEWLINE) - 1
      if (length < 0) exit
      call log(self%context, text(first:first + length - 1) // c_null_char)
      first = first + length + 1
    end do
    call log(self%context, text(first:) // c_null_char)
  end subroutine forward_lines

end module amontons_c_interface
