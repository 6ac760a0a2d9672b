!> Unit test of checkpoint: a snapshot through words and through a file, the interface of a job, and files that cannot be used.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_checkpoint
  use amontons_checkpoint, only: snapshot_type, output_lengths_type, checkpoint_draft_type, take_snapshot, restore_snapshot, &
    begin_checkpoint, place_checkpoint, discard_checkpoint, pack_lengths, read_checkpoint, pack_state, unpack_state
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_increment_control, only: increment_control_type
  use amontons_kinds, only: DP, I64
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_newton, only: newton_type
  use amontons_state, only: state_type
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  character(*), parameter :: PATH = 'test_checkpoint.restart'
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call two_blocks(model, 0.3_DP, 0.0_DP, [0.01_DP, 0.0_DP, -0.02_DP])
  model%deck_checksum = 1
  call start_blocks(model, system, state)
  call check_words()
  call check_file()
  call check_restore()
  call check_damage()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> A snapshot with a number of its own in every place.
  subroutine make_snapshot(snapshot, shift)
    type(snapshot_type), intent(out) :: snapshot
    real(DP), intent(in) :: shift
    integer :: i
    snapshot%fields = state%old
    snapshot%u_start = state%old%u
    allocate (snapshot%driven(8, 2), snapshot%friction(1))
    call number(snapshot%fields%u, 1 + 10 * nint(shift))
    call number(snapshot%fields%v, 2 + 10 * nint(shift))
    call number(snapshot%fields%stress, 3 + 10 * nint(shift))
    call number(snapshot%u_start, 4 + 10 * nint(shift))
    call number(snapshot%driven, 5 + 10 * nint(shift))
    snapshot%friction = shift + 0.125_DP
    snapshot%fields%energy = shift + 0.25_DP
    snapshot%fields%external_work = shift + 1.5_DP
    snapshot%fields%total_time = shift + 2.5_DP
    snapshot%fields%increment = 7 + nint(shift)
    snapshot%fields%slaves%gap = [(shift + 0.01_DP * real(i, DP), i=1, size(snapshot%fields%slaves))]
    snapshot%fields%slaves%status = [(mod(i, 3), i=1, size(snapshot%fields%slaves))]
    snapshot%stepping = increment_control_type(step=2 + nint(shift), increment=3 + nint(shift), attempt=4 + nint(shift), &
      step_time=0.5_DP + shift, total_time=1.5_DP + shift, dt=0.25_DP + shift, n_fast_increments=5 + nint(shift), &
      has_failed=shift < 0.5_DP)
    snapshot%is_step_start = shift > 0.5_DP
    snapshot%force_scale = shift + 3.5_DP
    snapshot%best_entries = 1234.0_DP + shift
    snapshot%node_order = [(1 + mod(i + nint(shift), model%mesh%n_nodes), i=1, model%mesh%n_nodes)]
    snapshot%interface = [(mod(i + nint(shift), 32), i=1, model%mesh%n_nodes)]
    allocate (snapshot%bulk_factor_u(3, model%mesh%n_nodes))
    call number(snapshot%bulk_factor_u, 6 + 10 * nint(shift))
  end subroutine make_snapshot


  !> Numbers that differ from each other.
  subroutine number(values, what)
    real(DP), intent(inout) :: values(:, :)
    integer, intent(in) :: what
    integer :: i, j
    do j = 1, size(values, 2)
      do i = 1, size(values, 1)
        values(i, j) = sin(real(i + 10 * j + 1000 * what, DP))
      end do
    end do
  end subroutine number


  !> Two snapshots agree to the last bit.
  subroutine compare(name, a, b)
    character(*), intent(in) :: name
    type(snapshot_type), intent(in) :: a, b
    call suite%that(name // ': fields', all(a%fields%u == b%fields%u) .and. all(a%fields%v == b%fields%v) .and. &
      all(a%fields%stress == b%fields%stress) .and. all(a%fields%energy == b%fields%energy))
    call suite%that(name // ': numbers', a%fields%external_work == b%fields%external_work .and. &
      a%fields%total_time == b%fields%total_time .and. a%fields%increment == b%fields%increment)
    call suite%that(name // ': slave nodes', all(a%fields%slaves%gap == b%fields%slaves%gap) .and. &
      all(a%fields%slaves%status == b%fields%slaves%status))
    call suite%that(name // ': time', a%stepping%step == b%stepping%step .and. a%stepping%attempt == b%stepping%attempt .and. &
      a%stepping%step_time == b%stepping%step_time .and. a%stepping%dt == b%stepping%dt .and. &
      a%stepping%n_fast_increments == b%stepping%n_fast_increments .and. (a%stepping%has_failed .eqv. b%stepping%has_failed))
    call suite%that(name // ': scales', a%force_scale == b%force_scale .and. a%best_entries == b%best_entries .and. &
      (a%is_step_start .eqv. b%is_step_start))
    call suite%that(name // ': order and interface', all(a%node_order == b%node_order) .and. all(a%interface == b%interface))
    call suite%that(name // ': displacements', all(a%u_start == b%u_start) .and. all(a%bulk_factor_u == b%bulk_factor_u))
    call suite%that(name // ': driven values', size(b%driven, 2) == 2 .and. all(a%driven == b%driven) .and. &
      all(a%friction == b%friction))
  end subroutine compare


  !> Words of the snapshot alone: all of it returns; too few words, and too many, do not fit.
  subroutine check_words()
    type(snapshot_type) :: kept, found
    type(error_type), allocatable :: error
    integer(I64), allocatable :: words(:), longer(:)
    call make_snapshot(kept, 0.0_DP)
    call make_snapshot(found, 1.0_DP)
    call pack_state(model, kept, words)
    longer = [words, 0_I64]
    call unpack_state('x', words, model, found, error)
    call suite%that('unpacked', .not. allocated(error))
    call compare('words', kept, found)
    call unpack_state('somewhere', longer, model, found, error)
    call suite%that('a word too many', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_IO .and. index(error%message, 'somewhere') > 0)
    call pack_state(model, kept, words)
    words = words(:size(words) - 1)
    call unpack_state('x', words, model, found, error)
    call suite%that('a word too few', allocated(error))
    deallocate (kept%bulk_factor_u, kept%interface)
    call pack_state(model, kept, words)
    call make_snapshot(found, 1.0_DP)
    deallocate (found%bulk_factor_u, found%interface)
    call unpack_state('x', words, model, found, error)
    call suite%that('without a factor', .not. allocated(error) .and. .not. allocated(found%bulk_factor_u) .and. &
      .not. allocated(found%interface))
  end subroutine check_words


  !> The same by a file, with the lengths of the result files and pages of one of them.
  subroutine check_file()
    type(snapshot_type) :: kept, found
    type(output_lengths_type) :: files, lengths
    type(checkpoint_draft_type) :: draft
    type(error_type), allocatable :: error
    integer :: i
    logical :: is_there
    call make_snapshot(kept, 0.0_DP)
    files%lengths = [11_I64, 12_I64, 13_I64]
    files%frd = [21_I64, 22_I64, 23_I64]
    files%restart_file = [31_I64, 32_I64, 33_I64]
    files%pages%end = 4096
    files%pages%index = [5_I64, 9_I64]
    allocate (files%pages%bytes(16, 2))
    files%pages%bytes = reshape([(int(mod(i, 100), kind(files%pages%bytes)), i=1, 32)], [16, 2])
    call write_checkpoint(PATH, kept, files, error)
    call suite%that('written', .not. allocated(error))
    call make_snapshot(found, 1.0_DP)
    call read_checkpoint(PATH, model, found, lengths, error)
    call suite%that('read', .not. allocated(error))
    call compare('file', kept, found)
    call suite%that('lengths', all(lengths%lengths == files%lengths) .and. all(lengths%frd == files%frd) .and. &
      all(lengths%restart_file == files%restart_file))
    call suite%that('pages', lengths%pages%end == 4096 .and. all(lengths%pages%index == files%pages%index) .and. &
      all(lengths%pages%bytes == files%pages%bytes))
    call write_checkpoint('no/such/folder/x', kept, files, error)
    call suite%that('no folder', allocated(error))
    call begin_checkpoint(draft, PATH, model, kept, .true.)
    inquire (file=PATH // '.new', exist=is_there)
    call suite%that('begun', is_there)
    call discard_checkpoint(draft)
    inquire (file=PATH // '.new', exist=is_there)
    call suite%that('removed', .not. is_there)
    lengths = output_lengths_type()
    call read_checkpoint(PATH, model, found, lengths, error)
    call suite%that('the one before stays', .not. allocated(error))
  end subroutine check_file


  !> Writes the whole file.
  subroutine write_checkpoint(path, snapshot, files, error)
    character(*), intent(in) :: path
    type(snapshot_type), intent(inout) :: snapshot
    type(output_lengths_type), intent(inout) :: files
    type(error_type), allocatable, intent(out) :: error
    type(checkpoint_draft_type) :: draft
    integer(I64), allocatable :: words(:)
    call begin_checkpoint(draft, path, model, snapshot, .true.)
    call pack_lengths(files, words)
    call place_checkpoint(draft, words, error)
  end subroutine write_checkpoint


  !> Taken from a job and given back after the job went on.
  subroutine check_restore()
    type(snapshot_type) :: snapshot
    type(newton_type) :: newton
    type(increment_control_type) :: stepping
    type(error_type), allocatable :: error
    logical :: is_step_start
    integer :: i
    real(DP), allocatable :: u(:, :)
    state%old = state%new
    u = state%old%u
    u(1, 20) = 0.5_DP
    state%old%u = u
    newton%force_scale = 42.0_DP
    stepping%step = 1
    stepping%increment = 3
    system%is_interface_unknown = [(mod(i - 1, 3) == 0 .and. i > 60, i=1, 150)]
    system%is_interface_unknown(61:63) = .true.      ! node 21
    system%is_held = [(i == 62, i=1, 150)]
    system%is_bulk_nlgeom = .true.
    system%bulk_factor_u = u
    call take_snapshot(snapshot, state, system, newton, stepping, .false.)
    call suite%that('bits of a node on the interface, held in direction 2, NLGEOM', snapshot%interface(21) == 1 + 4 + 16)
    call suite%that('of another node', snapshot%interface(1) == 16)
    state%old%u = -1
    state%new%u = -1
    newton%force_scale = 0
    stepping%increment = 9
    system%bulk_factor_u = 0 * u
    system%is_held = .true.
    system%is_interface_unknown = .false.
    system%is_bulk_nlgeom = .false.
    system%u_start = 7
    call restore_snapshot(snapshot, model, model%steps(1), state, system, newton, stepping, is_step_start, error)
    call suite%that('restored', .not. allocated(error) .and. .not. is_step_start)
    call suite%that('committed and trial fields', all(state%old%u == u) .and. all(state%new%u == u))
    call suite%that('time and scale', stepping%increment == 3 .and. newton%force_scale == 42.0_DP)
    call suite%that('held', count(system%is_held) == 1 .and. system%is_held(62))
    call suite%that('on the interface', all(system%is_interface_unknown(61:63)) .and. .not. any(system%is_interface_unknown(:60)))
    call suite%that('factor', all(system%bulk_factor_u == u) .and. system%is_bulk_nlgeom .and. &
      .not. system%schur_interface%is_ready)
    call suite%that('start of the step', all(system%u_start == snapshot%u_start))
  end subroutine check_restore


  !> Overwrites one word of the file.
  subroutine set_word(place, word)
    integer, intent(in) :: place                     !< from 1
    integer(I64), intent(in) :: word
    integer :: unit
    open (newunit=unit, file=PATH, access='stream', form='unformatted', action='readwrite', status='old')
    write (unit, pos=8 * place - 7) word
    close (unit)
  end subroutine set_word


  !> Reads the file and expects a message.
  subroutine expect(piece)
    character(*), intent(in) :: piece
    type(snapshot_type) :: found
    type(output_lengths_type) :: lengths
    type(error_type), allocatable :: error
    call make_snapshot(found, 1.0_DP)
    call read_checkpoint(PATH, model, found, lengths, error)
    call suite%that('error: ' // piece, allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_IO .and. index(error%message, piece) > 0)
  end subroutine expect


  !> Each damage has its message; the deck must be the same.
  subroutine check_damage()
    type(snapshot_type) :: kept
    type(output_lengths_type) :: files
    type(error_type), allocatable :: error
    integer :: unit
    call make_snapshot(kept, 0.0_DP)
    allocate (files%pages%bytes(0, 0), files%pages%index(0))
    call write_checkpoint(PATH, kept, files, error)
    model%deck_checksum = 2
    call expect('has been changed')
    model%deck_checksum = 1
    call set_word(100, 12345_I64)
    call expect('its checksum is wrong')
    call write_checkpoint(PATH, kept, files, error)
    call set_word(3, 12345_I64)
    call expect('its length is not')
    call set_word(2, 0_I64)
    call expect('of another version')
    call set_word(1, 0_I64)
    call expect('does not begin as one')
    open (newunit=unit, file=PATH, access='stream', form='unformatted', status='replace')
    write (unit) 1_I64
    close (unit)
    call expect('too short')
    open (newunit=unit, file=PATH)
    close (unit, status='delete')
    call expect('There is no checkpoint')
  end subroutine check_damage

end program test_checkpoint
