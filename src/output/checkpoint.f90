!> Snapshot of all data on which the next increment depends, in memory for a rollback and on disk as a checkpoint.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A job resumed from a snapshot gives bitwise the results of the uninterrupted job. All data kept from increment to increment is
!! therefore in the snapshot, recomputed at the start of each increment, or recomputed from the snapshot in the same way:
!! doc/developer/reliability.md has the list and the reasons.
!!
!! The checkpoint, job.restart, is one block of 64-bit words in native byte order: magic, version, length, checksum,
!! then the words of `exchange_all`. It is written under a temporary name, synced and renamed, so that an existing checkpoint is
!! always complete.
module amontons_checkpoint
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_posix, only: continue_checksum, new_file_type, start_new_file, append_words, place_new_file, &
    remove_new_file
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_hdf5_file, only: hdf5_pages_type
  use amontons_state, only: state_type, fields_type, slave_state_type, restore_state
  use amontons_equilibrium, only: equilibrium_type, begin_step
  use amontons_reduced_system, only: discard_analysis
  use amontons_contact_preconditioner, only: skin_memory_type
  use amontons_sparse, only: sparse_type
  use amontons_newton, only: newton_type
  use amontons_increment_control, only: increment_control_type
  implicit none
  private
  public :: snapshot_type, output_lengths_type, checkpoint_draft_type, take_snapshot, restore_snapshot, begin_checkpoint, &
    place_checkpoint, discard_checkpoint, pack_lengths, read_checkpoint, pack_state, unpack_state

  integer(I64), parameter :: MAGIC = transfer('AMONTONS', 0_I64)   !< as a number it also identifies the byte order
  integer(I64), parameter :: FORMAT_VERSION = 20
  integer(I64), parameter :: N_HEADER_WORDS = 4                 !< words before those of exchange_all
  integer(I64), parameter :: N_BUFFER_WORDS = 131072            !< words of a piece of the file

  !> All data on which the next increment depends.
  type :: snapshot_type
    type(fields_type) :: fields                    !< committed; of a batch job without values, but for a job that continues
    type(increment_control_type) :: stepping
    logical :: is_step_start = .true.
    real(DP) :: force_scale = 0                    !< newton%force_scale [force]
    real(DP) :: best_entries = 0                   !< system%reduced_system%best_entries
    integer, allocatable :: node_order(:)          !< system%reduced_system%node_order
    real(DP), allocatable :: u_start(:, :)         !< system%u_start [length]
    integer, allocatable :: interface(:)           !< (n_nodes) bits: the node is on the interface, its unknowns 1, 2, 3 are
                                                   !! restrained,
    !< NLGEOM (system%is_interface_unknown, is_held, is_bulk_nlgeom)
    real(DP), allocatable :: driven(:, :)          !< (8, n) values set by a calling program (list_driven)
    real(DP), allocatable :: friction(:)           !< (n_interactions) the same of coefficients of friction [-]
    real(DP), allocatable :: bulk_factor_u(:, :)          !< system%bulk_factor_u: the factor of the bulk is recomputed from it
                                                          !! [length]
    type(skin_memory_type) :: skin                 !< system%skin%memory
  end type snapshot_type

  !> Lengths and positions of the result files at a snapshot.
  type :: output_lengths_type
    logical :: has_points = .true.                 !< .false.: the job is done, and the checkpoint lacks the values at points
    integer(I64) :: lengths(3) = 0                 !< of .sta, .cvg, .dat [bytes]
    integer(I64) :: restart_file(3) = 0                 !< of .res: last state, bytes, step of it
    integer(I64) :: frd(3) = 0                     !< bytes, frames, blocks of .frd
    type(hdf5_pages_type) :: pages                      !< of .vtkhdf
    integer :: n_partitions = 0                         !< that were requested (`divide_model`); 0: the results are not divided
    type(hdf5_pages_type), allocatable :: partition_pages(:)   !< of the files of the partitions; unallocated: there are none
  end type output_lengths_type

  !> Words to be written to a file, or read from it.
  type :: packer_type
    logical :: is_packing = .true.
    logical :: is_valid = .true.                   !< .false.: the words do not have the requested contents
    type(new_file_type), allocatable :: file       !< takes the words when the buffer is full; not allocated: all stay in memory
    integer(I64), allocatable :: words(:)          !< all of them, or the buffer of the file
    integer(I64) :: n = 0                          !< words packed or unpacked
    integer(I64) :: n_written = 0                  !< of them, those in the file
    integer(I64) :: checksum = 0                   !< of those in the file behind the head
  contains
    generic :: exchange => exchange_integer, exchange_long, exchange_real, exchange_logical, exchange_vector, exchange_matrix
    procedure, private :: exchange_integer, exchange_long, exchange_real, exchange_logical, exchange_vector, exchange_matrix
  end type packer_type

  !> A checkpoint that is being written: it has the snapshot and waits for the lengths of the result files.
  type :: checkpoint_draft_type
    private
    type(packer_type) :: packer
  end type checkpoint_draft_type

contains

  !> Takes a snapshot of the data on which the next increment depends.
  subroutine take_snapshot(snapshot, state, system, newton, stepping, is_step_start, has_fields)
    type(snapshot_type), intent(inout) :: snapshot
    type(state_type), intent(in) :: state          !< its committed fields are copied
    type(equilibrium_type), intent(in) :: system
    type(newton_type), intent(in) :: newton
    type(increment_control_type), intent(in) :: stepping
    logical, intent(in) :: is_step_start
    logical, intent(in), optional :: has_fields    !< .false.: the committed fields are not copied
    snapshot%stepping = stepping
    snapshot%is_step_start = is_step_start
    snapshot%force_scale = newton%force_scale
    snapshot%best_entries = system%reduced_system%best_entries
    if (allocated(snapshot%node_order)) deallocate (snapshot%node_order)
    if (allocated(system%reduced_system%node_order)) snapshot%node_order = system%reduced_system%node_order
    snapshot%u_start = system%u_start
    snapshot%skin = system%skin%memory
    call save_bulk_factor(snapshot, system)
    snapshot%fields = fields_type()
    if (present(has_fields)) then
      if (.not. has_fields) return
    end if
    snapshot%fields = state%old
  end subroutine take_snapshot


  !> The displacements and the interface of the factor of the bulk, if the next increment may use it.
  subroutine save_bulk_factor(snapshot, system)
    type(snapshot_type), intent(inout) :: snapshot
    type(equilibrium_type), intent(in) :: system
    integer :: i
    if (allocated(snapshot%interface)) deallocate (snapshot%interface)
    if (allocated(snapshot%bulk_factor_u)) deallocate (snapshot%bulk_factor_u)
    if (.not. allocated(system%is_interface_unknown) .or. .not. allocated(system%is_held)) return
    allocate (snapshot%interface(size(system%is_interface_unknown) / 3))
    do i = 1, size(snapshot%interface)
      snapshot%interface(i) = merge(1, 0, system%is_interface_unknown(3 * i)) + &
        dot_product([2, 4, 8], merge(1, 0, system%is_held(3 * i - 2:3 * i))) + merge(16, 0, system%is_bulk_nlgeom)
    end do
    if (allocated(system%bulk_factor_u)) snapshot%bulk_factor_u = system%bulk_factor_u
  end subroutine save_bulk_factor


  !> Restores a snapshot. Errors: those of begin_step.
  subroutine restore_snapshot(snapshot, model, step, state, system, newton, stepping, is_step_start, error)
    type(snapshot_type), intent(in) :: snapshot
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step            !< of the snapshot, with the loads in force
    type(state_type), intent(inout) :: state
    type(equilibrium_type), intent(inout) :: system
    type(newton_type), intent(inout) :: newton
    type(increment_control_type), intent(inout) :: stepping
    logical, intent(out) :: is_step_start
    type(error_type), allocatable, intent(out) :: error
    state%old = snapshot%fields
    call restore_state(state)
    stepping = snapshot%stepping
    is_step_start = snapshot%is_step_start
    newton%force_scale = snapshot%force_scale
    call restore_node_order(snapshot, system)
    if (.not. is_step_start) call begin_step(system, model, step, state, error)
    system%u_start = snapshot%u_start
    system%skin%memory = snapshot%skin
    call restore_bulk_factor(snapshot, system)
  end subroutine restore_snapshot


  !> Restores the interface. The factor is recomputed when needed, unless the present one is the same.
  subroutine restore_bulk_factor(snapshot, system)
    type(snapshot_type), intent(in) :: snapshot
    type(equilibrium_type), intent(inout) :: system
    integer :: i
    logical :: is_same
    is_same = allocated(snapshot%bulk_factor_u) .and. allocated(system%bulk_factor_u)
    if (is_same) is_same = all(snapshot%bulk_factor_u == system%bulk_factor_u)
    if (is_same .and. (system%schur_interface%is_ready .or. system%skin%is_ready)) return
    system%schur_interface%is_ready = .false.
    system%skin%is_ready = .false.
    system%schur_interface%is_analysed = .false.
    system%is_schur_allowed = .true.
    if (allocated(system%bulk_factor_u)) deallocate (system%bulk_factor_u)
    if (allocated(system%is_interface_unknown)) deallocate (system%is_interface_unknown)
    if (.not. allocated(snapshot%interface)) return
    system%is_interface_unknown = [(btest(snapshot%interface((i + 2) / 3), 0), i=1, 3 * size(snapshot%interface))]
    system%is_held = [(btest(snapshot%interface((i + 2) / 3), 1 + mod(i - 1, 3)), i=1, 3 * size(snapshot%interface))]
    system%is_bulk_nlgeom = any(btest(snapshot%interface, 4))
    if (allocated(snapshot%bulk_factor_u)) system%bulk_factor_u = snapshot%bulk_factor_u
  end subroutine restore_bulk_factor


  !> Restores the order of the nodes, which determines the rounding of the factor: a factor with another order is discarded.
  subroutine restore_node_order(snapshot, system)
    type(snapshot_type), intent(in) :: snapshot
    type(equilibrium_type), intent(inout) :: system
    logical :: is_same
    is_same = allocated(snapshot%node_order) .and. allocated(system%reduced_system%node_order)
    if (is_same) is_same = all(snapshot%node_order == system%reduced_system%node_order)
    if (is_same) return
    call discard_analysis(system%reduced_system)
    if (allocated(system%reduced_system%node_order)) deallocate (system%reduced_system%node_order)
    if (allocated(snapshot%node_order)) system%reduced_system%node_order = snapshot%node_order
    system%reduced_system%best_entries = snapshot%best_entries
  end subroutine restore_node_order


  !> Begins a checkpoint: writes the snapshot to a new file beside the one before. An error is kept until it is placed.
  subroutine begin_checkpoint(draft, path, model, snapshot, has_points, committed)
    type(checkpoint_draft_type), intent(out) :: draft
    character(*), intent(in) :: path
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot   !< not changed
    logical, intent(in) :: has_points                !< .false.: the job is done, and the values at points are not written
    type(fields_type), intent(inout), optional :: committed   !< in place of those of the snapshot; not changed
    integer(I64) :: head(N_HEADER_WORDS)
    logical :: with_points
    associate (packer => draft%packer)
      allocate (packer%words(N_BUFFER_WORDS), packer%file)
      call start_new_file(packer%file, path)
      head = 0
      call append_words(packer%file, head)
      packer%n = N_HEADER_WORDS
      packer%n_written = N_HEADER_WORDS
      with_points = has_points
      call exchange_snapshot(packer, model, snapshot, with_points, committed)
      call empty_buffer(packer)
    end associate
  end subroutine begin_checkpoint


  !> Completes a checkpoint and puts it in the place of the one before. Errors (EXIT_IO): the first one since its beginning.
  subroutine place_checkpoint(draft, lengths, error)
    type(checkpoint_draft_type), intent(inout) :: draft
    integer(I64), intent(inout) :: lengths(:)        !< of pack_lengths; not changed
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: head(N_HEADER_WORDS)
    associate (packer => draft%packer)
      call exchange_words(packer, lengths)
      call empty_buffer(packer)
      head = [MAGIC, FORMAT_VERSION, packer%n, packer%checksum]
      call place_new_file(packer%file, head, error)
    end associate
  end subroutine place_checkpoint


  !> Removes a checkpoint that was begun: the one before stays.
  subroutine discard_checkpoint(draft)
    type(checkpoint_draft_type), intent(inout) :: draft
    call remove_new_file(draft%packer%file)
  end subroutine discard_checkpoint


  !> The lengths and positions of the result files in words, for a checkpoint that another rank writes.
  subroutine pack_lengths(files, words)
    type(output_lengths_type), intent(inout) :: files   !< not changed
    integer(I64), allocatable, intent(out) :: words(:)
    type(packer_type) :: packer
    allocate (packer%words(64))
    call exchange_files(packer, files)
    words = packer%words(:packer%n)
  end subroutine pack_lengths


  !> Writes the words in the buffer to the file.
  subroutine empty_buffer(packer)
    type(packer_type), intent(inout) :: packer
    associate (words => packer%words(:packer%n - packer%n_written))
      !$omp parallel sections
      !$omp section
      packer%checksum = continue_checksum(packer%checksum, words)
      !$omp section
      call append_words(packer%file, words)
      !$omp end parallel sections
    end associate
    packer%n_written = packer%n
  end subroutine empty_buffer


  !> Packs a snapshot into words, for a restart file.
  subroutine pack_state(model, snapshot, words, committed)
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot   !< not changed
    integer(I64), allocatable, intent(out) :: words(:)
    type(fields_type), intent(inout), optional :: committed   !< in place of those of the snapshot; not changed
    type(packer_type) :: packer
    type(output_lengths_type) :: files
    allocate (files%pages%bytes(0, 0), files%pages%index(0))
    allocate (packer%words(4096 + 2 * 6 * int(model%mesh%n_points, I64)))
    call exchange_all(packer, model, snapshot, files, committed)
    words = packer%words(:packer%n)
  end subroutine pack_state


  !> Unpacks a snapshot from words. Before: its arrays have the shapes of the model. Errors (EXIT_IO): they do not fit.
  subroutine unpack_state(path, words, model, snapshot, error)
    character(*), intent(in) :: path                 !< origin of the words, for the message
    integer(I64), allocatable, intent(inout) :: words(:)   !< deallocated on return
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot
    type(error_type), allocatable, intent(out) :: error
    type(packer_type) :: packer
    type(output_lengths_type) :: files
    packer%is_packing = .false.
    call move_alloc(words, packer%words)
    call exchange_all(packer, model, snapshot, files)
    if (packer%n /= size(packer%words, kind=I64)) packer%is_valid = .false.
    if (.not. packer%is_valid) call set_error(error, EXIT_IO, 'The restart file ' // path // ' does not fit the model: it ' // &
      'was written by another version of Amontons.')
  end subroutine unpack_state


  !> Reads a checkpoint. Before: the arrays of the snapshot have the shapes of the model.
  !!
  !! Errors (EXIT_IO): it does not exist, is damaged, or is from another version of the program or another deck.
  subroutine read_checkpoint(path, model, snapshot, files, error)
    character(*), intent(in) :: path
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot
    type(output_lengths_type), intent(inout) :: files
    type(error_type), allocatable, intent(out) :: error
    type(packer_type) :: packer
    integer(I64) :: deck
    packer%is_packing = .false.
    call read_words(path, packer, error)
    if (allocated(error)) return
    call packer%exchange(deck)
    if (deck /= model%deck_checksum) then
      call set_error(error, EXIT_IO, 'The deck is not the one of the checkpoint ' // path // ': it has been changed ' // &
        'since the job was begun, or the results of its global model have. Run the job from its start, without --resume.')
      return
    end if
    packer%n = N_HEADER_WORDS
    call exchange_all(packer, model, snapshot, files)
    if (packer%n /= size(packer%words, kind=I64)) packer%is_valid = .false.
    if (.not. packer%is_valid) call set_damaged_error(path, 'it does not fit the model', error)
  end subroutine read_checkpoint


  !> Reads the words of a file and checks that they are complete.
  subroutine read_words(path, packer, error)
    character(*), intent(in) :: path
    type(packer_type), intent(inout) :: packer
    type(error_type), allocatable, intent(out) :: error
    integer :: unit, status
    integer(I64) :: n_bytes
    inquire (file=path, size=n_bytes)
    if (n_bytes < 0) then
      call set_error(error, EXIT_IO, 'There is no checkpoint ' // path // ': the job was never begun, or has ended well.')
      return
    end if
    if (n_bytes < 8_I64 * N_HEADER_WORDS) then
      call set_damaged_error(path, 'it is too short', error)
      return
    end if
    allocate (packer%words(n_bytes / 8_I64), source=0_I64)
    open (newunit=unit, file=path, access='stream', form='unformatted', action='read', status='old', iostat=status)
    if (status == 0) read (unit, iostat=status) packer%words
    if (status /= 0) then
      call set_error(error, EXIT_IO, 'Cannot read the checkpoint ' // path // '.')
      return
    end if
    close (unit)
    associate (words => packer%words)
      if (words(1) /= MAGIC) then
        call set_damaged_error(path, 'it does not begin as one', error)
      else if (words(2) /= FORMAT_VERSION) then
        call set_error(error, EXIT_IO, 'The checkpoint ' // path // ' is of another version of Amontons.')
      else if (words(3) /= size(words, kind=I64) .or. 8_I64 * words(3) /= n_bytes) then
        call set_damaged_error(path, 'its length is not the one it was written with', error)
      else if (words(4) /= continue_checksum(0_I64, words(N_HEADER_WORDS + 1:))) then
        call set_damaged_error(path, 'its checksum is wrong', error)
      end if
    end associate
    packer%n = N_HEADER_WORDS
  end subroutine read_words


  !> The error of a checkpoint that cannot be used.
  subroutine set_damaged_error(path, reason, error)
    character(*), intent(in) :: path, reason
    type(error_type), allocatable, intent(out) :: error
    call set_error(error, EXIT_IO, 'The checkpoint ' // path // ' is damaged: ' // reason // '. The result files are ' // &
      'as they were; run the job from its start, without --resume.')
  end subroutine set_damaged_error


  !> Packs or unpacks the contents of a checkpoint, in the order of the file.
  subroutine exchange_all(packer, model, snapshot, files, committed)
    type(packer_type), intent(inout) :: packer
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot
    type(output_lengths_type), intent(inout) :: files
    type(fields_type), intent(inout), optional :: committed   !< in place of those of the snapshot
    call exchange_snapshot(packer, model, snapshot, files%has_points, committed)
    call exchange_files(packer, files)
  end subroutine exchange_all


  !> All of them but the lengths of the result files.
  subroutine exchange_snapshot(packer, model, snapshot, has_points, committed)
    type(packer_type), intent(inout) :: packer
    type(model_type), intent(in) :: model
    type(snapshot_type), intent(inout) :: snapshot
    logical, intent(inout) :: has_points
    type(fields_type), intent(inout), optional :: committed   !< in place of those of the snapshot
    integer(I64) :: deck
    deck = model%deck_checksum
    call packer%exchange(deck)
    call packer%exchange(has_points)
    call exchange_stepping(packer, snapshot%stepping)
    call packer%exchange(snapshot%is_step_start)
    call packer%exchange(snapshot%force_scale)
    call packer%exchange(snapshot%best_entries)
    call exchange_order(packer, model%mesh%n_nodes, snapshot%node_order)
    call packer%exchange(snapshot%u_start)
    call exchange_order(packer, model%mesh%n_nodes, snapshot%interface)
    call exchange_bulk(packer, model%mesh%n_nodes, snapshot%bulk_factor_u)
    call exchange_skin(packer, snapshot%skin)
    call exchange_table(packer, 8, snapshot%driven)
    call packer%exchange(snapshot%friction)
    if (present(committed)) then
      call exchange_fields(packer, committed, has_points)
    else
      call exchange_fields(packer, snapshot%fields, has_points)
    end if
  end subroutine exchange_snapshot


  !> The time and the counters of the job.
  subroutine exchange_stepping(packer, stepping)
    type(packer_type), intent(inout) :: packer
    type(increment_control_type), intent(inout) :: stepping
    call packer%exchange(stepping%step)
    call packer%exchange(stepping%increment)
    call packer%exchange(stepping%attempt)
    call packer%exchange(stepping%step_time)
    call packer%exchange(stepping%total_time)
    call packer%exchange(stepping%dt)
    call packer%exchange(stepping%n_fast_increments)
    call packer%exchange(stepping%has_failed)
  end subroutine exchange_stepping


  !> An optional integer for each node: the order, or the interface.
  subroutine exchange_order(packer, n_nodes, order)
    type(packer_type), intent(inout) :: packer
    integer, intent(in) :: n_nodes
    integer, allocatable, intent(inout) :: order(:)
    logical :: is_there
    integer :: i
    is_there = allocated(order)
    call packer%exchange(is_there)
    if (.not. is_there .or. .not. packer%is_valid) return
    if (.not. allocated(order)) allocate (order(n_nodes), source=0)
    do i = 1, n_nodes
      call packer%exchange(order(i))
    end do
    packer%is_valid = packer%is_valid .and. all(order >= 0 .and. order <= max(n_nodes, 31))   ! 31: all bits of the interface
  end subroutine exchange_order


  !> A table with a known number of rows and an unknown number of columns.
  subroutine exchange_table(packer, n_rows, table)
    type(packer_type), intent(inout) :: packer
    integer, intent(in) :: n_rows
    real(DP), allocatable, intent(inout) :: table(:, :)
    integer :: n
    n = 0
    if (packer%is_packing) n = size(table, 2)
    call exchange_count(packer, n)
    if (.not. packer%is_valid) return
    if (.not. packer%is_packing) then
      if (allocated(table)) deallocate (table)
      allocate (table(n_rows, n), source=0.0_DP)
    end if
    call packer%exchange(table)
  end subroutine exchange_table


  !> The displacements at the factorisation of the bulk, if there is a factor.
  subroutine exchange_bulk(packer, n_nodes, u)
    type(packer_type), intent(inout) :: packer
    integer, intent(in) :: n_nodes
    real(DP), allocatable, intent(inout) :: u(:, :)
    logical :: is_there
    is_there = allocated(u)
    call packer%exchange(is_there)
    if (.not. is_there .or. .not. packer%is_valid) return
    if (.not. allocated(u)) allocate (u(3, n_nodes), source=0.0_DP)
    call packer%exchange(u)
  end subroutine exchange_bulk


  !> The springs and counts of the contact skin.
  subroutine exchange_skin(packer, skin)
    type(packer_type), intent(inout) :: packer
    type(skin_memory_type), intent(inout) :: skin
    logical :: is_there
    integer :: i, n
    call packer%exchange(skin%n_slow)
    call packer%exchange(skin%slow_limit)
    call packer%exchange(skin%is_outdated)
    call packer%exchange(skin%is_factor_needed)
    call packer%exchange(skin%is_abandoned)
    is_there = allocated(skin%is_near)
    call packer%exchange(is_there)
    if (.not. is_there .or. .not. packer%is_valid) return
    n = 0
    if (packer%is_packing) n = size(skin%is_near)
    call exchange_count(packer, n)
    if (.not. packer%is_valid) return
    if (.not. packer%is_packing) allocate (skin%is_near(n), source=.false.)
    do i = 1, n
      call packer%exchange(skin%is_near(i))
    end do
    call exchange_sparse(packer, skin%springs)
  end subroutine exchange_skin


  !> A sparse matrix.
  subroutine exchange_sparse(packer, matrix)
    type(packer_type), intent(inout) :: packer
    type(sparse_type), intent(inout) :: matrix
    integer :: i, n
    call exchange_count(packer, matrix%n_rows)
    call exchange_count(packer, matrix%n_columns)
    n = 0
    if (packer%is_packing) n = size(matrix%column)
    call exchange_count(packer, n)
    if (.not. packer%is_valid) return
    if (.not. packer%is_packing) then
      allocate (matrix%first(matrix%n_rows + 1), matrix%column(n), source=0)
      allocate (matrix%value(n), source=0.0_DP)
    end if
    do i = 1, matrix%n_rows + 1
      call packer%exchange(matrix%first(i))
    end do
    do i = 1, n
      call packer%exchange(matrix%column(i))
    end do
    call packer%exchange(matrix%value)
  end subroutine exchange_sparse


  !> A number of entries that follow.
  subroutine exchange_count(packer, n)
    type(packer_type), intent(inout) :: packer
    integer, intent(inout) :: n
    call packer%exchange(n)
    if (.not. packer%is_packing .and. (n < 0 .or. n > size(packer%words))) packer%is_valid = .false.
  end subroutine exchange_count


  !> The committed fields; constant ones come from the model.
  subroutine exchange_fields(packer, fields, has_points)
    type(packer_type), intent(inout) :: packer
    type(fields_type), intent(inout) :: fields
    logical, intent(in) :: has_points              !< the values at points, too
    logical :: has_birth
    call packer%exchange(fields%step)
    call packer%exchange(fields%increment)
    call packer%exchange(fields%time_increment)
    call packer%exchange(fields%user_memory)
    call packer%exchange(fields%step_time)
    call packer%exchange(fields%total_time)
    call packer%exchange(fields%creep_time)
    call packer%exchange(fields%strain_energy)
    call packer%exchange(fields%external_work)
    call packer%exchange(fields%friction_work)
    call packer%exchange(fields%plastic_work)
    call packer%exchange(fields%proximal_work)
    call packer%exchange(fields%damping)
    call packer%exchange(fields%stabilization_work)
    call packer%exchange(fields%kinetic_energy)
    call packer%exchange(fields%integration_loss)
    call packer%exchange(fields%load_factor)
    call packer%exchange(fields%load_rate)
    call packer%exchange(fields%arc_scale)
    call packer%exchange(fields%u)
    call packer%exchange(fields%v)
    if (has_points) call exchange_points(packer, fields)
    call packer%exchange(fields%temperature)
    has_birth = allocated(fields%birth_displacement)
    call packer%exchange(has_birth)
    if (has_birth .and. .not. allocated(fields%birth_displacement)) packer%is_valid = .false.
    if (has_birth .and. packer%is_valid) call packer%exchange(fields%birth_displacement)
    call packer%exchange(fields%internal_force)
    call packer%exchange(fields%applied_force)
    call packer%exchange(fields%contact_force)
    call packer%exchange(fields%reaction_force)
    call exchange_slaves(packer, fields%slaves)
  end subroutine exchange_fields


  !> The values at integration points.
  subroutine exchange_points(packer, fields)
    type(packer_type), intent(inout) :: packer
    type(fields_type), intent(inout) :: fields
    call packer%exchange(fields%stress)
    call packer%exchange(fields%strain)
    call packer%exchange(fields%energy)
    call packer%exchange(fields%dissipated)
    call packer%exchange(fields%volume)
    call packer%exchange(fields%history)
    call packer%exchange(fields%modes)
  end subroutine exchange_points


  !> The slave states as raw memory, so that every component is included.
  subroutine exchange_slaves(packer, slaves)
    type(packer_type), intent(inout) :: packer
    type(slave_state_type), allocatable, intent(inout) :: slaves(:)
    integer(I64), allocatable :: words(:)
    integer :: n_words, n
    n = size(slaves)
    call packer%exchange(n)
    if (.not. packer%is_packing .and. packer%is_valid .and. n /= size(slaves)) then   ! the integration points of slave faces change
      deallocate (slaves)
      allocate (slaves(n))
    end if
    n_words = size(transfer(slaves, [0_I64]))
    allocate (words(n_words))
    if (packer%is_packing) words = transfer(slaves, [0_I64])
    call exchange_words(packer, words)
    if (.not. packer%is_packing .and. packer%is_valid .and. n_words > 0) slaves = transfer(words, slaves)
  end subroutine exchange_slaves


  !> The lengths and positions of the result files.
  subroutine exchange_files(packer, files)
    type(packer_type), intent(inout) :: packer
    type(output_lengths_type), intent(inout) :: files
    integer :: i, n
    do i = 1, 3
      call packer%exchange(files%lengths(i))
      call packer%exchange(files%frd(i))
      call packer%exchange(files%restart_file(i))
    end do
    call exchange_pages(packer, files%pages)
    call packer%exchange(files%n_partitions)
    n = 0
    if (packer%is_packing .and. allocated(files%partition_pages)) n = size(files%partition_pages)
    call exchange_count(packer, n)
    if (.not. packer%is_valid) return
    if (.not. packer%is_packing) allocate (files%partition_pages(n))
    do i = 1, n
      if (packer%is_valid) call exchange_pages(packer, files%partition_pages(i))
    end do
  end subroutine exchange_files


  !> The pages of a file.
  subroutine exchange_pages(packer, pages)
    type(packer_type), intent(inout) :: packer
    type(hdf5_pages_type), intent(inout) :: pages
    integer(I64) :: shape_of(2), k
    integer(I64), allocatable :: words(:)
    call packer%exchange(pages%end)
    shape_of = 0
    if (packer%is_packing) shape_of = shape(pages%bytes, kind=I64)
    call packer%exchange(shape_of(1))
    call packer%exchange(shape_of(2))
    if (.not. packer%is_packing) then
      if (any(shape_of < 0) .or. shape_of(2) > size(packer%words, kind=I64)) packer%is_valid = .false.
      if (shape_of(1) > huge(1) .or. .not. packer%is_valid) return
      allocate (pages%index(shape_of(2)), pages%bytes(shape_of(1), shape_of(2)))
    end if
    call exchange_words(packer, pages%index)
    allocate (words(shape_of(1) / 8_I64))
    do k = 1, shape_of(2)
      if (packer%is_packing) words = transfer(pages%bytes(:, k), words, size(words))
      call exchange_words(packer, words)
      if (.not. packer%is_packing .and. packer%is_valid) pages%bytes(:, k) = transfer(words, pages%bytes(:, k))
    end do
  end subroutine exchange_pages


  !> Packs or unpacks words. If too few words remain, the packer becomes invalid and returns nothing.
  subroutine exchange_words(packer, words)
    type(packer_type), intent(inout) :: packer
    integer(I64), intent(inout) :: words(:)
    integer(I64) :: n, first, last, start
    n = size(words, kind=I64)
    if (.not. packer%is_packing) then
      if (packer%n + n > size(packer%words, kind=I64)) packer%is_valid = .false.
      if (.not. packer%is_valid) return
      words = packer%words(packer%n + 1:packer%n + n)
      packer%n = packer%n + n
      return
    end if
    if (.not. allocated(packer%file)) call grow_buffer(packer, n)
    first = 1
    do while (first <= n)
      start = packer%n - packer%n_written
      last = min(n, first + size(packer%words, kind=I64) - start - 1)
      packer%words(start + 1:start + last - first + 1) = words(first:last)
      packer%n = packer%n + last - first + 1
      if (last < n) call empty_buffer(packer)
      first = last + 1
    end do
  end subroutine exchange_words


  !> Makes space in memory for more words.
  subroutine grow_buffer(packer, n)
    type(packer_type), intent(inout) :: packer
    integer(I64), intent(in) :: n
    integer(I64), allocatable :: larger(:)
    if (packer%n + n <= size(packer%words, kind=I64)) return
    allocate (larger(2 * (packer%n + n)))
    larger(:packer%n) = packer%words(:packer%n)
    call move_alloc(larger, packer%words)
  end subroutine grow_buffer


  !> One long integer.
  subroutine exchange_long(self, value)
    class(packer_type), intent(inout) :: self
    integer(I64), intent(inout) :: value
    integer(I64) :: word(1)
    word = value
    call exchange_words(self, word)
    value = word(1)
  end subroutine exchange_long


  !> One integer.
  subroutine exchange_integer(self, value)
    class(packer_type), intent(inout) :: self
    integer, intent(inout) :: value
    integer(I64) :: word(1)
    word = int(value, I64)
    call exchange_words(self, word)
    value = int(word(1))
  end subroutine exchange_integer


  !> One logical.
  subroutine exchange_logical(self, value)
    class(packer_type), intent(inout) :: self
    logical, intent(inout) :: value
    integer(I64) :: word(1)
    word = merge(1_I64, 0_I64, value)
    call exchange_words(self, word)
    value = word(1) /= 0
  end subroutine exchange_logical


  !> One real.
  subroutine exchange_real(self, value)
    class(packer_type), intent(inout) :: self
    real(DP), intent(inout) :: value
    integer(I64) :: word(1)
    word = transfer(value, word)
    call exchange_words(self, word)
    value = transfer(word(1), value)
  end subroutine exchange_real


  !> A list of reals of known length.
  subroutine exchange_vector(self, values)
    class(packer_type), intent(inout) :: self
    real(DP), intent(inout) :: values(:)
    call exchange_reals(self, size(values, kind=I64), values)
  end subroutine exchange_vector


  !> A matrix of reals of known shape.
  subroutine exchange_matrix(self, values)
    class(packer_type), intent(inout) :: self
    real(DP), intent(inout) :: values(:, :)
    call exchange_reals(self, size(values, kind=I64), values)
  end subroutine exchange_matrix


  !> Reals, in pieces that fit into the cache, each behind a word: 1, or 0 for a piece of zeros, of which no more is written. Fields
  !! of a job that begins, or of laws that it does not have, take no space.
  subroutine exchange_reals(packer, n, values)
    class(packer_type), intent(inout) :: packer
    integer(I64), intent(in) :: n
    real(DP), intent(inout) :: values(n)
    integer, parameter :: N_PIECE = 4096
    integer(I64) :: words(N_PIECE), first, last, n_now
    logical :: has_values
    do first = 1, n, int(N_PIECE, I64)
      last = min(first + N_PIECE - 1, n)
      n_now = last - first + 1
      has_values = .false.                           ! set below, or by the word read
      if (packer%is_packing) then
        words(:n_now) = transfer(values(first:last), words(:n_now))
        has_values = any(words(:n_now) /= 0_I64)     ! -0 is a value
      end if
      call packer%exchange(has_values)
      if (has_values) then
        call exchange_words(packer, words(:n_now))
      else
        words(:n_now) = 0_I64
      end if
      if (.not. packer%is_packing .and. packer%is_valid) values(first:last) = transfer(words(:n_now), values(first:last))
    end do
  end subroutine exchange_reals

end module amontons_checkpoint
