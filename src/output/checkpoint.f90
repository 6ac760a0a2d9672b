!> Restart: a snapshot of all that the next increment depends on, in memory for a rollback and on disk for a restart.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! What goes on from a snapshot gives bitwise what went on without it. Everything that is kept from increment to
!! increment is therefore in the snapshot, made again at the start of each increment, or made again from the snapshot in
!! the same way: doc/developer/reliability.md has the list and the reasons.
!!
!! The checkpoint, job.restart, is one block of 64-bit words in the machine's own order: magic, version, length, checksum,
!! then the words of `carry_all`. It is written under a temporary name, synced and renamed, so the one there is whole.
module amontons_checkpoint
  use amontons_kinds, only: DP, I8, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_posix, only: checksum_of_text, checksum_of_words, write_whole_file
  use amontons_model, only: model_type
  use amontons_hdf5_file, only: pages_type
  use amontons_state, only: state_type, fields_type, slave_type
  use amontons_equilibrium, only: system_type, begin_step
  use amontons_reduced_system, only: forget_analysis
  use amontons_newton, only: newton_type
  use amontons_increment_control, only: stepper_type
  implicit none
  private
  public :: snapshot_type, files_type, take_snapshot, put_back, write_checkpoint, read_checkpoint, pack_state, unpack_state

  integer(I64), parameter :: MAGIC = transfer('AMONTONS', 0_I64)   !< as a number it tells the byte order too
  integer(I64), parameter :: FORMAT_VERSION = 10
  integer, parameter :: N_HEAD = 4                 !< words before those of carry_all

  !> All that the next increment depends on.
  type :: snapshot_type
    type(fields_type) :: fields                    !< committed
    type(stepper_type) :: stepper
    logical :: is_step_start = .true.
    real(DP) :: force_scale = 0                    !< newton%force_scale [force]
    real(DP) :: best_entries = 0                   !< system%reduced%best_entries
    integer, allocatable :: node_order(:)          !< system%reduced%node_order
    real(DP), allocatable :: u_start(:, :)         !< system%u_start [length]
    integer, allocatable :: interface(:)           !< (n_nodes) bits: the node is on the interface, its unknowns 1, 2, 3 are held,
    !< NLGEOM (system%is_contact, is_held, is_bulk_nlgeom)
    real(DP), allocatable :: driven(:, :)          !< (8, n) what a calling program has set (list_driven)
    real(DP), allocatable :: friction(:)           !< (n_interactions) the same of coefficients of friction [-]
    real(DP), allocatable :: bulk_u(:, :)          !< system%bulk_u: the factor of the bulk is made again from it [length]
  end type snapshot_type

  !> What the result files were at a snapshot.
  type :: files_type
    integer(I64) :: lengths(3) = 0                 !< of .sta, .cvg, .dat [bytes]
    integer(I64) :: archive(3) = 0                 !< of .res: last state, bytes, step of it
    integer(I64) :: frd(3) = 0                     !< bytes, frames, blocks of .frd
    type(pages_type) :: pages                      !< of .vtkhdf
  end type files_type

  !> Words on their way into a file or out of it.
  type :: parcel_type
    logical :: is_packing = .true.
    logical :: is_sound = .true.                   !< .false.: it does not hold what was asked for
    integer(I64), allocatable :: words(:)
    integer(I64) :: n = 0                          !< words packed or taken out
  contains
    generic :: carry => carry_integer, carry_long, carry_real, carry_logical, carry_vector, carry_matrix
    procedure, private :: carry_integer, carry_long, carry_real, carry_logical, carry_vector, carry_matrix
  end type parcel_type

contains

  !> Notes what the next increment depends on.
  subroutine take_snapshot(snapshot, state, system, newton, stepper, is_step_start)
    type(snapshot_type), intent(inout) :: snapshot
    type(state_type), intent(in) :: state          !< its committed fields are noted
    type(system_type), intent(in) :: system
    type(newton_type), intent(in) :: newton
    type(stepper_type), intent(in) :: stepper
    logical, intent(in) :: is_step_start
    snapshot%fields = state%old
    snapshot%stepper = stepper
    snapshot%is_step_start = is_step_start
    snapshot%force_scale = newton%force_scale
    snapshot%best_entries = system%reduced%best_entries
    if (allocated(snapshot%node_order)) deallocate (snapshot%node_order)
    if (allocated(system%reduced%node_order)) snapshot%node_order = system%reduced%node_order
    snapshot%u_start = system%u_start
    call note_bulk(snapshot, system)
  end subroutine take_snapshot


  !> Where the factor of the bulk was made, and with which interface, if it may serve the next increment.
  subroutine note_bulk(snapshot, system)
    type(snapshot_type), intent(inout) :: snapshot
    type(system_type), intent(in) :: system
    integer :: i
    if (allocated(snapshot%interface)) deallocate (snapshot%interface)
    if (allocated(snapshot%bulk_u)) deallocate (snapshot%bulk_u)
    if (.not. allocated(system%is_contact) .or. .not. allocated(system%is_held)) return
    allocate (snapshot%interface(size(system%is_contact) / 3))
    do i = 1, size(snapshot%interface)
      snapshot%interface(i) = merge(1, 0, system%is_contact(3 * i)) + &
        dot_product([2, 4, 8], merge(1, 0, system%is_held(3 * i - 2:3 * i))) + merge(16, 0, system%is_bulk_nlgeom)
    end do
    if (allocated(system%bulk_u)) snapshot%bulk_u = system%bulk_u
  end subroutine note_bulk


  !> Goes back to a snapshot. Errors: those of begin_step.
  subroutine put_back(snapshot, model, state, system, newton, stepper, is_step_start, error)
    type(snapshot_type), intent(in) :: snapshot
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state
    type(system_type), intent(inout) :: system
    type(newton_type), intent(inout) :: newton
    type(stepper_type), intent(inout) :: stepper
    logical, intent(out) :: is_step_start
    type(error_type), allocatable, intent(out) :: error
    state%old = snapshot%fields
    state%new = snapshot%fields
    stepper = snapshot%stepper
    is_step_start = snapshot%is_step_start
    newton%force_scale = snapshot%force_scale
    call put_order_back(snapshot, system)
    if (.not. is_step_start) call begin_step(system, model, model%steps(stepper%step), state, error)
    system%u_start = snapshot%u_start
    call put_bulk_back(snapshot, system)
  end subroutine put_back


  !> The interface as it was; the factor is made again when it is asked for, unless it is the same one still.
  subroutine put_bulk_back(snapshot, system)
    type(snapshot_type), intent(in) :: snapshot
    type(system_type), intent(inout) :: system
    integer :: i
    logical :: is_same
    is_same = allocated(snapshot%bulk_u) .and. allocated(system%bulk_u)
    if (is_same) is_same = all(snapshot%bulk_u == system%bulk_u)
    if (is_same .and. system%condensed%is_ready) return
    system%condensed%is_ready = .false.
    system%condensed%is_analysed = .false.
    system%is_dense_wanted = .true.
    if (allocated(system%bulk_u)) deallocate (system%bulk_u)
    if (allocated(system%is_contact)) deallocate (system%is_contact)
    if (.not. allocated(snapshot%interface)) return
    system%is_contact = [(btest(snapshot%interface((i + 2) / 3), 0), i=1, 3 * size(snapshot%interface))]
    system%is_held = [(btest(snapshot%interface((i + 2) / 3), 1 + mod(i - 1, 3)), i=1, 3 * size(snapshot%interface))]
    system%is_bulk_nlgeom = any(btest(snapshot%interface, 4))
    if (allocated(snapshot%bulk_u)) system%bulk_u = snapshot%bulk_u
  end subroutine put_bulk_back


  !> The order of the nodes decides the rounding of the factor: a factor analysed in another one is forgotten.
  subroutine put_order_back(snapshot, system)
    type(snapshot_type), intent(in) :: snapshot
    type(system_type), intent(inout) :: system
    logical :: is_same
    is_same = allocated(snapshot%node_order) .and. allocated(system%reduced%node_order)
    if (is_same) is_same = all(snapshot%node_order == system%reduced%node_order)
    if (is_same) return
    call forget_analysis(system%reduced)
    if (allocated(system%reduced%node_order)) deallocate (system%reduced%node_order)
    if (allocated(snapshot%node_order)) system%reduced%node_order = snapshot%node_order
    system%reduced%best_entries = snapshot%best_entries
  end subroutine put_order_back


  !> Writes a checkpoint in place of the one before.
  subroutine write_checkpoint(path, model, snapshot, files, error)
    character(*), intent(in) :: path
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot   !< not changed
    type(files_type), intent(inout) :: files         !< not changed
    type(error_type), allocatable, intent(out) :: error
    type(parcel_type) :: parcel
    allocate (parcel%words(4096 + size(files%pages%bytes, kind=I64) / 8 + 2 * size(snapshot%fields%stress, kind=I64)))
    parcel%n = N_HEAD
    call carry_all(parcel, model, snapshot, files)
    parcel%words(:3) = [MAGIC, FORMAT_VERSION, parcel%n]
    parcel%words(4) = checksum_of_words(parcel%words(N_HEAD + 1:parcel%n))
    call write_whole_file(path, parcel%words(:parcel%n), error)
  end subroutine write_checkpoint


  !> A snapshot as words, for a restart file.
  subroutine pack_state(model, snapshot, words)
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot   !< not changed
    integer(I64), allocatable, intent(out) :: words(:)
    type(parcel_type) :: parcel
    type(files_type) :: files
    allocate (files%pages%bytes(0, 0), files%pages%index(0))
    allocate (parcel%words(4096 + 2 * size(snapshot%fields%stress, kind=I64)))
    call carry_all(parcel, model, snapshot, files)
    words = parcel%words(:parcel%n)
  end subroutine pack_state


  !> The snapshot of some words. Before: its arrays have the shapes of the model. Errors (EXIT_IO): they do not fit.
  subroutine unpack_state(path, words, model, snapshot, error)
    character(*), intent(in) :: path                 !< where they come from, for the message
    integer(I64), allocatable, intent(inout) :: words(:)   !< gone on return
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot
    type(error_type), allocatable, intent(out) :: error
    type(parcel_type) :: parcel
    type(files_type) :: files
    parcel%is_packing = .false.
    call move_alloc(words, parcel%words)
    call carry_all(parcel, model, snapshot, files)
    if (parcel%n /= size(parcel%words, kind=I64)) parcel%is_sound = .false.
    if (.not. parcel%is_sound) call set_error(error, EXIT_IO, 'The restart file ' // path // ' does not fit the model: it ' // &
      'was written by another version of Amontons.')
  end subroutine unpack_state


  !> Reads a checkpoint. Before: the arrays of the snapshot have the shapes of the model.
  !!
  !! Errors (EXIT_IO): it is not there, damaged, from another version of the program, or of another deck.
  subroutine read_checkpoint(path, model, snapshot, files, error)
    character(*), intent(in) :: path
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot
    type(files_type), intent(inout) :: files
    type(error_type), allocatable, intent(out) :: error
    type(parcel_type) :: parcel
    integer(I64) :: deck
    parcel%is_packing = .false.
    call read_words(path, parcel, error)
    if (allocated(error)) return
    call parcel%carry(deck)
    if (deck /= checksum_of_text(model%deck_text)) then
      call set_error(error, EXIT_IO, 'The deck is not the one of the checkpoint ' // path // ': it has been changed ' // &
        'since the job was begun. Run the job from its start, without --resume.')
      return
    end if
    parcel%n = N_HEAD
    call carry_all(parcel, model, snapshot, files)
    if (parcel%n /= size(parcel%words, kind=I64)) parcel%is_sound = .false.
    if (.not. parcel%is_sound) call damaged(path, 'it does not fit the model', error)
  end subroutine read_checkpoint


  !> Reads the words of a file and checks that they are whole.
  subroutine read_words(path, parcel, error)
    character(*), intent(in) :: path
    type(parcel_type), intent(inout) :: parcel
    type(error_type), allocatable, intent(out) :: error
    integer :: unit, status
    integer(I64) :: n_bytes
    inquire (file=path, size=n_bytes)
    if (n_bytes < 0) then
      call set_error(error, EXIT_IO, 'There is no checkpoint ' // path // ': the job was never begun, or has ended well.')
      return
    end if
    if (n_bytes < 8_I64 * N_HEAD) then
      call damaged(path, 'it is too short', error)
      return
    end if
    allocate (parcel%words(n_bytes / 8_I64), source=0_I64)
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=status)
    if (status == 0) read (unit, iostat=status) parcel%words
    if (status /= 0) then
      call set_error(error, EXIT_IO, 'Cannot read the checkpoint ' // path // '.')
      return
    end if
    close (unit)
    associate (words => parcel%words)
      if (words(1) /= MAGIC) then
        call damaged(path, 'it does not begin as one', error)
      else if (words(2) /= FORMAT_VERSION) then
        call set_error(error, EXIT_IO, 'The checkpoint ' // path // ' is of another version of Amontons.')
      else if (words(3) /= size(words, kind=I64) .or. 8_I64 * words(3) /= n_bytes) then
        call damaged(path, 'its length is not the one it was written with', error)
      else if (words(4) /= checksum_of_words(words(N_HEAD + 1:))) then
        call damaged(path, 'its checksum is wrong', error)
      end if
    end associate
    parcel%n = N_HEAD
  end subroutine read_words


  !> The error of a checkpoint that cannot be used.
  subroutine damaged(path, reason, error)
    character(*), intent(in) :: path, reason
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_IO, 'The checkpoint ' // path // ' is damaged: ' // reason // '. The result files are ' // &
      'as they were; run the job from its start, without --resume.')
  end subroutine damaged


  !> The contents of a checkpoint, in the order of the file: into the parcel or out of it.
  subroutine carry_all(parcel, model, snapshot, files)
    type(parcel_type), intent(inout) :: parcel
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot
    type(files_type), intent(inout) :: files
    integer(I64) :: deck
    deck = checksum_of_text(model%deck_text)
    call parcel%carry(deck)
    call carry_stepper(parcel, snapshot%stepper)
    call parcel%carry(snapshot%is_step_start)
    call parcel%carry(snapshot%force_scale)
    call parcel%carry(snapshot%best_entries)
    call carry_order(parcel, model%mesh%n_nodes, snapshot%node_order)
    call parcel%carry(snapshot%u_start)
    call carry_order(parcel, model%mesh%n_nodes, snapshot%interface)
    call carry_bulk(parcel, model%mesh%n_nodes, snapshot%bulk_u)
    call carry_table(parcel, 8, snapshot%driven)
    call parcel%carry(snapshot%friction)
    call carry_fields(parcel, snapshot%fields)
    call carry_files(parcel, files)
  end subroutine carry_all


  !> Where the job is in time.
  subroutine carry_stepper(parcel, stepper)
    type(parcel_type), intent(inout) :: parcel
    type(stepper_type), intent(inout) :: stepper
    call parcel%carry(stepper%step)
    call parcel%carry(stepper%increment)
    call parcel%carry(stepper%attempt)
    call parcel%carry(stepper%step_time)
    call parcel%carry(stepper%total_time)
    call parcel%carry(stepper%dt)
    call parcel%carry(stepper%n_fast)
    call parcel%carry(stepper%has_failed)
  end subroutine carry_stepper


  !> A number for each node, if there are any: their order, or the interface.
  subroutine carry_order(parcel, n_nodes, order)
    type(parcel_type), intent(inout) :: parcel
    integer, intent(in) :: n_nodes
    integer, allocatable, intent(inout) :: order(:)
    logical :: is_there
    integer :: i
    is_there = allocated(order)
    call parcel%carry(is_there)
    if (.not. is_there .or. .not. parcel%is_sound) return
    if (.not. allocated(order)) allocate (order(n_nodes), source=0)
    do i = 1, n_nodes
      call parcel%carry(order(i))
    end do
    parcel%is_sound = parcel%is_sound .and. all(order >= 0 .and. order <= max(n_nodes, 31))   ! 31: all bits of the interface
  end subroutine carry_order


  !> A table whose rows are known and whose columns are not.
  subroutine carry_table(parcel, n_rows, table)
    type(parcel_type), intent(inout) :: parcel
    integer, intent(in) :: n_rows
    real(DP), allocatable, intent(inout) :: table(:, :)
    integer :: n
    n = 0
    if (parcel%is_packing) n = size(table, 2)
    call parcel%carry(n)
    if (.not. parcel%is_packing) then
      if (n < 0 .or. n > size(parcel%words)) parcel%is_sound = .false.
      if (.not. parcel%is_sound) return
      if (allocated(table)) deallocate (table)
      allocate (table(n_rows, n), source=0.0_DP)
    end if
    call parcel%carry(table)
  end subroutine carry_table


  !> Where the factor of the bulk was made, if there is one.
  subroutine carry_bulk(parcel, n_nodes, u)
    type(parcel_type), intent(inout) :: parcel
    integer, intent(in) :: n_nodes
    real(DP), allocatable, intent(inout) :: u(:, :)
    logical :: is_there
    is_there = allocated(u)
    call parcel%carry(is_there)
    if (.not. is_there .or. .not. parcel%is_sound) return
    if (.not. allocated(u)) allocate (u(3, n_nodes), source=0.0_DP)
    call parcel%carry(u)
  end subroutine carry_bulk


  !> The committed fields; those that are fixed come from the model.
  subroutine carry_fields(parcel, fields)
    type(parcel_type), intent(inout) :: parcel
    type(fields_type), intent(inout) :: fields
    logical :: has_birth
    call parcel%carry(fields%step)
    call parcel%carry(fields%increment)
    call parcel%carry(fields%time_increment)
    call parcel%carry(fields%user_memory)
    call parcel%carry(fields%step_time)
    call parcel%carry(fields%total_time)
    call parcel%carry(fields%creep_time)
    call parcel%carry(fields%external_work)
    call parcel%carry(fields%friction_work)
    call parcel%carry(fields%plastic_work)
    call parcel%carry(fields%carried_work)
    call parcel%carry(fields%damping)
    call parcel%carry(fields%damped_work)
    call parcel%carry(fields%u)
    call parcel%carry(fields%v)
    call parcel%carry(fields%stress)
    call parcel%carry(fields%strain)
    call parcel%carry(fields%energy)
    call parcel%carry(fields%dissipated)
    call parcel%carry(fields%volume)
    call parcel%carry(fields%history)
    call parcel%carry(fields%temperature)
    has_birth = allocated(fields%birth)
    call parcel%carry(has_birth)
    if (has_birth .and. .not. allocated(fields%birth)) parcel%is_sound = .false.
    if (has_birth .and. parcel%is_sound) call parcel%carry(fields%birth)
    call parcel%carry(fields%internal_force)
    call parcel%carry(fields%applied_force)
    call parcel%carry(fields%contact_force)
    call parcel%carry(fields%reaction_force)
    call carry_slaves(parcel, fields%slaves)
  end subroutine carry_fields


  !> The memory of the slave nodes as it lies in the machine: a component that is added later is carried too.
  subroutine carry_slaves(parcel, slaves)
    type(parcel_type), intent(inout) :: parcel
    type(slave_type), allocatable, intent(inout) :: slaves(:)
    integer(I64), allocatable :: words(:)
    integer :: n_words, n
    n = size(slaves)
    call parcel%carry(n)
    if (.not. parcel%is_packing .and. parcel%is_sound .and. n /= size(slaves)) then   ! points of slave faces come and go
      deallocate (slaves)
      allocate (slaves(n))
    end if
    n_words = size(transfer(slaves, [0_I64]))
    allocate (words(n_words))
    if (parcel%is_packing) words = transfer(slaves, [0_I64])
    call carry_words(parcel, words)
    if (.not. parcel%is_packing .and. parcel%is_sound .and. n_words > 0) slaves = transfer(words, slaves)
  end subroutine carry_slaves


  !> What the result files were.
  subroutine carry_files(parcel, files)
    type(parcel_type), intent(inout) :: parcel
    type(files_type), intent(inout) :: files
    integer(I64) :: shape_of(2)
    integer(I64), allocatable :: words(:)
    integer :: i
    do i = 1, 3
      call parcel%carry(files%lengths(i))
      call parcel%carry(files%frd(i))
      call parcel%carry(files%archive(i))
    end do
    associate (pages => files%pages)
      call parcel%carry(pages%end)
      shape_of = 0
      if (parcel%is_packing) shape_of = shape(pages%bytes, kind=I64)
      call parcel%carry(shape_of(1))
      call parcel%carry(shape_of(2))
      if (.not. parcel%is_packing) then
        if (any(shape_of < 0) .or. shape_of(2) > size(parcel%words, kind=I64)) parcel%is_sound = .false.
        if (shape_of(1) > huge(1) .or. .not. parcel%is_sound) return
        allocate (pages%index(shape_of(2)), pages%bytes(shape_of(1), shape_of(2)))
      end if
      allocate (words(shape_of(1) * shape_of(2) / 8_I64))
      if (parcel%is_packing) words = transfer(pages%bytes, words, size(words))
      call carry_words(parcel, pages%index)
      call carry_words(parcel, words)
      if (.not. parcel%is_packing .and. parcel%is_sound) pages%bytes = reshape(transfer(words, pages%bytes), &
        shape(pages%bytes))
    end associate
  end subroutine carry_files


  !> Words into the parcel or out of it. A parcel that is too short is not sound, and gives nothing.
  subroutine carry_words(parcel, words)
    type(parcel_type), intent(inout) :: parcel
    integer(I64), intent(inout) :: words(:)
    integer(I64), allocatable :: larger(:)
    integer(I64) :: n
    n = size(words, kind=I64)
    if (parcel%is_packing) then
      if (parcel%n + n > size(parcel%words, kind=I64)) then
        allocate (larger(2 * (parcel%n + n)))
        larger(:parcel%n) = parcel%words(:parcel%n)
        call move_alloc(larger, parcel%words)
      end if
      parcel%words(parcel%n + 1:parcel%n + n) = words
    else
      if (parcel%n + n > size(parcel%words, kind=I64)) parcel%is_sound = .false.
      if (.not. parcel%is_sound) return
      words = parcel%words(parcel%n + 1:parcel%n + n)
    end if
    parcel%n = parcel%n + n
  end subroutine carry_words


  !> One long integer.
  subroutine carry_long(self, value)
    class(parcel_type), intent(inout) :: self
    integer(I64), intent(inout) :: value
    integer(I64) :: word(1)
    word = value
    call carry_words(self, word)
    value = word(1)
  end subroutine carry_long


  !> One integer.
  subroutine carry_integer(self, value)
    class(parcel_type), intent(inout) :: self
    integer, intent(inout) :: value
    integer(I64) :: word(1)
    word = int(value, I64)
    call carry_words(self, word)
    value = int(word(1))
  end subroutine carry_integer


  !> One logical.
  subroutine carry_logical(self, value)
    class(parcel_type), intent(inout) :: self
    logical, intent(inout) :: value
    integer(I64) :: word(1)
    word = merge(1_I64, 0_I64, value)
    call carry_words(self, word)
    value = word(1) /= 0
  end subroutine carry_logical


  !> One real.
  subroutine carry_real(self, value)
    class(parcel_type), intent(inout) :: self
    real(DP), intent(inout) :: value
    integer(I64) :: word(1)
    word = transfer(value, word)
    call carry_words(self, word)
    value = transfer(word(1), value)
  end subroutine carry_real


  !> A list of reals, whose length is known.
  subroutine carry_vector(self, values)
    class(parcel_type), intent(inout) :: self
    real(DP), intent(inout) :: values(:)
    integer(I64), allocatable :: words(:)
    words = transfer(values, [0_I64])
    call carry_words(self, words)
    if (.not. self%is_packing) values = transfer(words, values)
  end subroutine carry_vector


  !> A matrix of reals, whose shape is known.
  subroutine carry_matrix(self, values)
    class(parcel_type), intent(inout) :: self
    real(DP), intent(inout) :: values(:, :)
    integer(I64), allocatable :: words(:)
    words = transfer(values, [0_I64])
    call carry_words(self, words)
    if (.not. self%is_packing) values = reshape(transfer(words, [0.0_DP]), shape(values))
  end subroutine carry_matrix

end module amontons_checkpoint
