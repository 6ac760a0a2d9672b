!> The result file job.vtkhdf: fields per increment for ParaView, history, iterations, contact states.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Two groups. `/VTKHDF` is an UnstructuredGrid of VTK's HDF format, version 2.0: one mesh, and a block of
!! rows of point data per written increment, restricted to features that VTK 9.3 to 9.7 read alike. VTK ignores `/AMONTONS`:
!!
!! | group                | contents                                                                                   |
!! |----------------------|--------------------------------------------------------------------------------------------|
!! | (itself)             | deck, version, dialect, heading, phases                                                    |
!! | `mesh`               | labels, kinds and materials of nodes and elements; `node_sets`, `element_sets`             |
!! | `materials`          | parameters                                                                                 |
!! | `pairs`              | contact pairs: surfaces, friction, facets of the master                                    |
!! | `steps`, `controls`  | one value per step                                                                         |
!! | `pair_history`       | sums over each pair: a row per pair of the initial state and each converged increment      |
!! | `history`            | one row per attempt at an increment, failed ones included; `frame` of the fields          |
!! | `iterations`         | one row per Newton iteration                                                               |
!! | `failures`           | lines on attempts that failed: worst nodes with their contact, and a remedy                |
!! | `element_integration_points` | stress, strain and energy density of each frame                                            |
!! | `contact`            | contact state of each slave node in each frame                                             |
!!
!! Every data set has attributes `unit` and `description`. Indices count from 0, -1 means none; labels are those of the deck.
!! Lists of lists have `first` (start of each, and the end) beside their members. A frame is one
!! written increment: rows [frame * n, (frame + 1) * n) of the fields, n the number of nodes, points or slave nodes.
!! Fields never contain NaN or infinity. The file is flushed after each increment.
!!
!! The results may be divided into partitions (amontons_result_partitions). Then each partition has a file with its grid, its labels
!! and sets, and its fields at nodes and integration points. job.vtkhdf has all else, and the grids and fields of the partitions
!! as virtual data sets, so that it reads as one file: rows of the first partition, then those of the second, ...; all
!! indices are those of this order. This module writes all three kinds of files.
module amontons_results
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_INTERNAL, EXIT_IO
  use amontons_mesh, only: mesh_type, mesh_extent
  use amontons_steps, only: is_output_due
  use amontons_materials, only: HISTORY_PEEQ, USER_STATE
  use amontons_model, only: job_options_type, job_path, model_type, has_damage_law, DIALECT_CALCULIX
  use amontons_iteration_records, only: increment_record_type, iteration_record_type, REPORT_LINE_LENGTH
  use amontons_state, only: history_variable, fields_type, slave_state_type
  use amontons_hdf5_file, only: append_rows, apply_pages, close_hdf5, create_group, create_hdf5, create_table, &
    discard_hdf5, flush_hdf5, hdf5_layout_type, open_hdf5, open_table, hdf5_pages_type, hdf5_file_type, hdf5_table_type, &
    export_pages, &
    write_attribute, write_data, STORAGE_I64, STORAGE_TEXT, STORAGE_I32
  use amontons_virtual_data_sets, only: source_files_type
  use amontons_nodal_fields, only: node_selection_type, select_all_nodes, select_nodes, point_fields, structure_fields, &
    STATUS_NO_SLAVE
  use amontons_result_partitions, only: partition_type, join_partitions, extract_mesh, first_places, partition_ending
  use amontons_result_model, only: drawn_surfaces_type, draw_nothing, draw_analytic_surfaces, drawn_displacements, write_grid, &
    write_virtual_grid, write_mesh, write_model_data
  use amontons_result_cells, only: number_bodies, write_cells
  use amontons_result_schema, only: append_columns, check_finite, result_column_type, create_columns, create_virtual_columns, &
    open_columns, &
    CONTACT_COLUMNS, HISTORY_COLUMNS, INTEGRATION_COLUMNS, ITERATION_COLUMNS, N_CONTACT_INTEGERS, N_CONTACT_REALS, &
    N_HISTORY_INTEGERS, N_HISTORY_REALS, N_ITERATION_INTEGERS, N_ITERATION_REALS, N_PAIR_INTEGERS, N_PAIR_REALS, &
    N_POINT_INTEGERS, N_POINT_REALS, PAIR_COLUMNS, POINT_COLUMNS, STRUCTURE_COLUMNS, &
    STRAIN_COLUMN
  use amontons_postprocess, only: pair_sums_type, nodal_slaves, sum_pair_forces, damage_variables
  implicit none
  private
  public :: results_type, open_results, write_model, resume_results, write_increment, write_attempt, write_iteration, close_results
  public :: export_result_pages, apply_result_pages, discard_results, is_writing, pair_rows

  character(*), parameter :: REASON_TABLE = '/AMONTONS/history/reason'
  character(*), parameter :: FAILURE_TEXT_GROUP = '/AMONTONS/failures'
  integer, parameter :: REASON_LENGTH = 240        !< characters of the cause of a failed attempt
  type(hdf5_layout_type), parameter :: REASON_FORM = hdf5_layout_type(storage=STORAGE_TEXT, width=REASON_LENGTH)
  type(hdf5_layout_type), parameter :: LINE_FORM = hdf5_layout_type(storage=STORAGE_TEXT, width=REPORT_LINE_LENGTH)
  type(hdf5_layout_type), parameter :: ROW_FORM = hdf5_layout_type(storage=STORAGE_I32)

  !> Tables of the result file.
  type :: failure_text_type
    private
    type(hdf5_table_type) :: reason                     !< a row per attempt
    type(hdf5_table_type) :: line                       !< report lines of attempts
    type(hdf5_table_type) :: attempt                    !< (per line) its row in the history
  end type failure_text_type

  integer, parameter :: CONTENT_ALL = 1                !< a file with all results
  integer, parameter :: CONTENT_TIED = 2               !< a file that ties partitions: their fields lie in their files
  integer, parameter :: CONTENT_PARTITION = 3          !< a file with the fields of a partition

  !> An open result file.
  type :: results_type
    private
    type(hdf5_file_type) :: store
    integer :: content = CONTENT_ALL
    type(partition_type) :: order                      !< nodes and elements of the model in the order of the file
    type(node_selection_type) :: selection             !< of a file with fields: its nodes
    integer, allocatable :: point_index(:)             !< of a partition: its integration points
    type(source_files_type) :: sources                 !< of a file that ties partitions: theirs
    integer, allocatable :: sizes(:, :)                !< (4, n_partitions) points, cells, length of Connectivity, integration
                                                       !! points of each
    integer :: n_nodes = 0                             !< rows of nodes in a frame, with the points of analytic surfaces
    type(drawn_surfaces_type) :: drawn                          !< analytic surfaces
    integer :: n_points = 0
    integer :: n_slaves = 0
    integer :: n_frames = 0                            !< increments with written fields
    real(DP) :: no_projection_gap = 0                                !< COPEN of a node without projection [length]
    type(result_column_type), allocatable :: point_columns(:)
    type(hdf5_table_type), allocatable :: point(:)          !< /VTKHDF/PointData
    type(hdf5_table_type), allocatable :: point_offset(:)   !< /VTKHDF/Steps/PointDataOffsets
    type(hdf5_table_type) :: time                           !< /VTKHDF/Steps/Values
    type(hdf5_table_type), allocatable :: constant(:)       !< the other tables of /VTKHDF/Steps
    type(result_column_type), allocatable :: integration_columns(:)
    type(hdf5_table_type), allocatable :: integration(:)
    type(hdf5_table_type), allocatable :: contact(:)        !< created with the first fields, which define the slave nodes
    type(hdf5_table_type), allocatable :: pairs(:)          !< sums over pairs; only with pairs
    type(hdf5_table_type), allocatable :: history(:)
    type(failure_text_type) :: failure_texts                            !< of attempts, in words
    type(hdf5_table_type), allocatable :: iterations(:)
  end type results_type

  real(DP), parameter :: NOT_FINITE_VALUE = 1.0e30_DP            !< written for NaN and infinity in the history of failed attempts

  ! The constant tables of /VTKHDF/Steps: all frames show the same mesh. The second value is the number of its partitions.
  character(21), parameter :: STEP_TABLES(5) = [character(21) :: &
    'PartOffsets', 'NumberOfParts', 'PointOffsets', 'CellOffsets', 'ConnectivityIdOffsets']
  integer, parameter :: STEP_PARTITIONS = 2
  logical, parameter :: STEP_IS_MATRIX(5) = [.false., .false., .false., .true., .true.]

contains

  !> Creates options%outdir/job.vtkhdf, or the file of a partition. It is readable once increment 0 is written.
  subroutine open_results(results, model, options, error, partitions, partition)
    type(results_type), intent(out) :: results
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    type(partition_type), intent(in), optional :: partitions(:)   !< all of them; default: the results are not divided
    integer, intent(in), optional :: partition     !< 0: the file that ties them; else the number of the partition
    call prepare_results(results, model, options, partitions, partition)
    call create_hdf5(results%store, path_of(options, partition), error, options%is_guarded)
    if (allocated(error)) call abandon(results)
  end subroutine open_results


  !> The path of a file.
  function path_of(options, partition) result(path)
    type(job_options_type), intent(in) :: options
    integer, intent(in), optional :: partition
    character(:), allocatable :: path
    path = job_path(options, '.vtkhdf')
    if (.not. present(partition)) return
    if (partition > 0) path = job_path(options, trim(partition_ending(partition)))
  end function path_of


  !> Sets what a file contains, before it is created or opened.
  subroutine prepare_results(results, model, options, partitions, partition)
    type(results_type), intent(inout) :: results
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(partition_type), intent(in), optional :: partitions(:)
    integer, intent(in), optional :: partition
    integer :: p, i, n
    results%no_projection_gap = mesh_extent(model%mesh)
    results%point_columns = columns_of_nodes(model)
    results%integration_columns = columns_of_points(model)
    call draw_analytic_surfaces(model, results%drawn)
    if (.not. present(partitions)) then
      results%selection = select_all_nodes(model%mesh)
      results%order = partition_type(elements=[(p, p=1, model%mesh%n_elements)], nodes=results%selection%nodes, &
        n_points=model%mesh%n_points, n_ids=size(model%mesh%nodes))
    else if (partition == 0) then
      results%content = CONTENT_TIED
      results%order = join_partitions(partitions)
      n = size(partitions)
      allocate (results%sizes(4, n))
      allocate (character(len(options%job) + len(partition_ending(1))) :: results%sources%name(n))
      do p = 1, n
        results%sources%name(p) = options%job // partition_ending(p)
        results%sizes(:, p) = [size(partitions(p)%nodes), size(partitions(p)%elements), partitions(p)%n_ids, partitions(p)%n_points]
      end do
      results%sizes(:3, n) = results%sizes(:3, n) + [results%drawn%n_points, results%drawn%n_cells, size(results%drawn%nodes)]
    else
      results%content = CONTENT_PARTITION
      results%order = partitions(partition)
      results%selection = select_nodes(model%mesh, first_places(results%order%nodes, model%mesh%n_nodes) > 0)
      allocate (results%point_index(results%order%n_points))
      n = 0
      do p = 1, size(results%order%elements)
        associate (first => model%mesh%point_first(results%order%elements(p):results%order%elements(p) + 1))
          results%point_index(n + 1:n + first(2) - first(1)) = [(i, i=first(1), first(2) - 1)]
          n = n + first(2) - first(1)
        end associate
      end do
      if (partition < size(partitions)) call draw_nothing(results%drawn)
    end if
    results%n_nodes = size(results%order%nodes) + results%drawn%n_points
    results%n_points = results%order%n_points
  end subroutine prepare_results


  !> Writes what all frames share: grid, cells and data of the model.
  subroutine write_model(results, model, error)
    type(results_type), intent(inout) :: results   !< open
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    type(mesh_type) :: extract
    select case (results%content)
    case (CONTENT_ALL)
      call write_mesh_and_frames(results, model%mesh, number_bodies(model%mesh), error)
      if (.not. allocated(error)) call write_model_data(results%store, model, model%mesh, results%order, error)
    case (CONTENT_TIED)
      call write_virtual_grid(results%store, results%sources, results%sizes(1, :), results%sizes(2, :), results%sizes(3, :), error)
      if (.not. allocated(error)) call write_cells(results%store, model%mesh, [integer ::], 0, error, results%sources, &
        results%sizes(2, :))
      if (.not. allocated(error)) call create_frames(results, error)
      call extract_mesh(model%mesh, results%order, extract)
      if (.not. allocated(error)) call write_model_data(results%store, model, extract, results%order, error)
    case (CONTENT_PARTITION)
      call extract_mesh(model%mesh, results%order, extract)
      call write_mesh_and_frames(results, extract, bodies_of(model%mesh, results%order%elements), error)
      if (.not. allocated(error)) call write_mesh(results%store, extract, error)
    end select
    if (.not. allocated(error) .and. results%content /= CONTENT_PARTITION) call create_histories(results, size(model%pairs), error)
    if (allocated(error)) call abandon(results)
  end subroutine write_model


  !> Body of some elements, numbered in the whole mesh.
  function bodies_of(mesh, elements) result(body)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: elements(:)
    integer, allocatable :: body(:)
    body = number_bodies(mesh)
    body = body(elements)
  end function bodies_of


  !> Grid, cells and tables of the fields.
  subroutine write_mesh_and_frames(results, mesh, body, error)
    type(results_type), intent(inout) :: results
    type(mesh_type), intent(in) :: mesh            !< in the order of the file
    integer, intent(in) :: body(:)                 !< of each element
    type(error_type), allocatable, intent(out) :: error
    call write_grid(results%store, mesh, results%drawn, error)
    if (.not. allocated(error)) call write_cells(results%store, mesh, body, results%drawn%n_cells, error)
    if (.not. allocated(error)) call create_frames(results, error)
  end subroutine write_mesh_and_frames


  !> Opens the file of a job resumed from a checkpoint; the file has already been restored to that commit.
  subroutine resume_results(results, model, n_slaves, options, error, partitions, partition)
    type(results_type), intent(out) :: results
    type(model_type), intent(in) :: model
    integer, intent(in) :: n_slaves
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    type(partition_type), intent(in), optional :: partitions(:)   !< as of open_results
    integer, intent(in), optional :: partition     !< as of open_results
    call prepare_results(results, model, options, partitions, partition)
    results%n_slaves = n_slaves
    call open_hdf5(results%store, path_of(options, partition), error)
    if (.not. allocated(error)) call open_frames(results, error)
    if (.not. allocated(error) .and. results%content /= CONTENT_PARTITION) call open_histories(results, size(model%pairs), error)
    if (allocated(error)) call discard_hdf5(results%store)
  end subroutine resume_results


  !> Opens the tables that grow by a row at a time.
  subroutine open_histories(results, n_pairs, error)
    type(results_type), intent(inout) :: results
    integer, intent(in) :: n_pairs
    type(error_type), allocatable, intent(out) :: error
    associate (store => results%store)
      call open_columns(store, '/AMONTONS/contact', CONTACT_COLUMNS, max(1, results%n_slaves), results%contact, error)
      if (.not. allocated(error) .and. n_pairs > 0) call open_columns(store, '/AMONTONS/pair_history', PAIR_COLUMNS, n_pairs, &
        results%pairs, error)
      if (.not. allocated(error)) call open_columns(store, '/AMONTONS/history', HISTORY_COLUMNS, 1, results%history, error)
      if (.not. allocated(error)) call open_failure_texts(results%failure_texts, store, error)
      if (.not. allocated(error)) call open_columns(store, '/AMONTONS/iterations', ITERATION_COLUMNS, 1, results%iterations, error)
    end associate
  end subroutine open_histories


  !> Opens the tables that grow by a frame.
  subroutine open_frames(results, error)
    type(results_type), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    associate (store => results%store)
      call open_table(store, results%time, '/VTKHDF/Steps/Values', hdf5_layout_type(), error)
      results%n_frames = int(results%time%n_rows)
      allocate (results%constant(size(STEP_TABLES)))
      do i = 1, size(STEP_TABLES)
        if (.not. allocated(error)) call open_table(store, results%constant(i), '/VTKHDF/Steps/' // &
          trim(STEP_TABLES(i)), hdf5_layout_type(storage=STORAGE_I64, is_matrix=STEP_IS_MATRIX(i)), error)
      end do
      if (.not. allocated(error) .and. results%content /= CONTENT_TIED) call open_columns(store, '/VTKHDF/PointData', &
        results%point_columns, results%n_nodes, results%point, error)
      allocate (results%point_offset(size(results%point_columns)))
      do i = 1, size(results%point_columns)
        if (.not. allocated(error)) call open_table(store, results%point_offset(i), &
          '/VTKHDF/Steps/PointDataOffsets/' // trim(results%point_columns(i)%name), hdf5_layout_type(storage=STORAGE_I64), error)
      end do
      if (.not. allocated(error) .and. results%content /= CONTENT_TIED) call open_columns(store, '/AMONTONS/integration_points', &
        results%integration_columns, results%n_points, results%integration, error)
      if (allocated(error) .or. results%content == CONTENT_TIED) return
      if (results%point(1)%n_rows /= int(results%n_frames, I64) * int(results%n_nodes, I64)) call set_error(error, EXIT_IO, &
        'Result file ' // store%path // ': its frames do not fit the model.')
    end associate
  end subroutine open_frames


  !> The pages of a guarded file that are still in memory, for the checkpoint (amontons_hdf5_file).
  subroutine export_result_pages(results, is_old, pages, error)
    type(results_type), intent(in) :: results
    logical, intent(in) :: is_old                            !< .true.: as they are on disk
    type(hdf5_pages_type), intent(out) :: pages
    type(error_type), allocatable, intent(out) :: error
    call export_pages(results%store, is_old, pages, error)
  end subroutine export_result_pages


  !> Writes the pages of a guarded file.
  subroutine apply_result_pages(results, error)
    type(results_type), intent(in) :: results
    type(error_type), allocatable, intent(out) :: error
    call apply_pages(results%store, error)
  end subroutine apply_result_pages


  !> Whether the file is open and has had no error.
  pure logical function is_writing(results)
    type(results_type), intent(in) :: results
    is_writing = results%store%is_open
  end function is_writing


  !> Closes the file; pages that were not applied are lost.
  subroutine discard_results(results)
    type(results_type), intent(inout) :: results
    call discard_hdf5(results%store)
  end subroutine discard_results


  !> Writes a converged increment (or the initial state, increment 0): its history row and, if file_frequency of its step
  !! selects it (the initial state always), its fields. Then flushes the file. A partition gets fields alone.
  subroutine write_increment(results, model, fields, record, error)
    type(results_type), intent(inout) :: results
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields                  !< committed
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    logical :: is_due
    is_due = record%increment == 0
    if (.not. is_due) then
      associate (step => model%steps(record%step))
        is_due = is_output_due(step, step%file_frequency, record%increment, record%step_time, step%file_times, record%is_step_end)
      end associate
    end if
    if (is_due) call write_frame(results, model, fields, nodal_slaves(model, fields%slaves), error)
    if (results%content == CONTENT_PARTITION) then
      if (is_due .and. .not. allocated(error)) call flush_hdf5(results%store, error)
      if (allocated(error)) call abandon(results)
      return
    end if
    if (.not. allocated(error) .and. size(model%pairs) > 0) call write_pair_sums(results, model, fields, record, error)
    if (allocated(error)) then
      call abandon(results)
    else
      call write_row(results, record, merge(results%n_frames - 1, -1, is_due), error)
    end if
  end subroutine write_increment


  !> Writes the sums over all pairs.
  subroutine write_pair_sums(results, model, fields, record, error)
    type(results_type), intent(inout) :: results
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields                  !< committed
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: integers(N_PAIR_INTEGERS, size(model%pairs))
    real(DP) :: reals(N_PAIR_REALS, size(model%pairs))
    call pair_rows(model, fields, [record%step, record%increment], record%total_time, integers, reals)
    call check_finite('pair', PAIR_COLUMNS, reals, error)
    if (.not. allocated(error)) call append_columns(results%store, PAIR_COLUMNS, integers, reals, results%pairs, error)
  end subroutine write_pair_sums


  !> Rows of PAIR_COLUMNS: the sums over each pair.
  subroutine pair_rows(model, fields, count_of, total_time, integers, reals)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: count_of(2)                       !< step and increment
    real(DP), intent(in) :: total_time                       !< [time]
    integer, intent(out) :: integers(:, :)                   !< (N_PAIR_INTEGERS, n_pairs)
    real(DP), intent(out) :: reals(:, :)                     !< (N_PAIR_REALS, n_pairs)
    type(slave_state_type), allocatable :: slaves(:)
    type(pair_sums_type) :: s
    integer :: p, k
    do p = 1, size(model%pairs)
      slaves = pack(fields%slaves, fields%slaves%pair == p)
      call sum_pair_forces(model, fields%u, slaves, s)
      integers(:, p) = [count_of, p - 1, (count(slaves%status == k), k=0, 2)]
      reals(:, p) = [total_time, s%force, s%moment, s%area, s%place(:, :2)]
    end do
  end subroutine pair_rows


  !> Writes the history row of a failed attempt, without fields, and flushes the file.
  subroutine write_attempt(results, record, error)
    type(results_type), intent(inout) :: results
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    call write_row(results, record, -1, error)
  end subroutine write_attempt


  !> Writes a row of the table of iterations.
  subroutine write_iteration(results, record, error)
    type(results_type), intent(inout) :: results
    type(iteration_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    integer :: integers(N_ITERATION_INTEGERS, 1)
    real(DP) :: reals(N_ITERATION_REALS, 1)
    integers(:, 1) = [record%step, record%increment, record%attempt, record%iteration, record%n_closed, &
      record%n_status, record%n_scenario, record%n_newly_opened, record%n_newly_closed, record%n_krylov, &
      record%n_slip_converged, record%n_subproblem_iterations]
    reals(:, 1) = finite_or_marker([record%residual, record%correction, record%step_length, record%max_gap_error])
    call append_columns(results%store, ITERATION_COLUMNS, integers, reals, results%iterations, error)
    if (allocated(error)) call abandon(results)
  end subroutine write_iteration


  !> Closes the file; no effect if it is not open. The last pages of a guarded file remain in memory.
  subroutine close_results(results, error)
    type(results_type), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    call close_hdf5(results%store, error)
  end subroutine close_results


  !> Abandons the file after an error: the last consistent state remains on disk.
  subroutine abandon(results)
    type(results_type), intent(inout) :: results
    call discard_hdf5(results%store)
  end subroutine abandon


  !> The tables that grow by a frame: point data, their offsets, times, integration points.
  subroutine create_frames(results, error)
    type(results_type), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    type(hdf5_layout_type) :: form
    integer :: i
    call create_group(results%store, '/VTKHDF/Steps', error)
    if (.not. allocated(error)) call write_attribute(results%store, '/VTKHDF/Steps', 'NSteps', [0], error)
    if (.not. allocated(error)) call create_table(results%store, results%time, '/VTKHDF/Steps/Values', hdf5_layout_type(), &
      '[time]', 'Total time of each frame.', error)
    allocate (results%constant(size(STEP_TABLES)))
    do i = 1, size(STEP_TABLES)
      if (allocated(error)) return
      form = hdf5_layout_type(storage=STORAGE_I64, is_matrix=STEP_IS_MATRIX(i))
      call create_table(results%store, results%constant(i), '/VTKHDF/Steps/' // trim(STEP_TABLES(i)), form, '[-]', &
        'The same mesh for all frames.', error)
    end do
    if (.not. allocated(error)) call create_field_columns(results, '/VTKHDF/PointData', results%point_columns, 1, results%n_nodes, &
      results%point, error)
    if (.not. allocated(error)) call create_group(results%store, '/VTKHDF/Steps/PointDataOffsets', error)
    allocate (results%point_offset(size(results%point_columns)))
    do i = 1, size(results%point_columns)
      if (allocated(error)) return
      call create_table(results%store, results%point_offset(i), &
        '/VTKHDF/Steps/PointDataOffsets/' // trim(results%point_columns(i)%name), hdf5_layout_type(storage=STORAGE_I64), '[-]', &
        'First row of each frame.', error)
    end do
    if (.not. allocated(error)) call create_group(results%store, '/AMONTONS', error)
    if (.not. allocated(error)) call create_field_columns(results, '/AMONTONS/integration_points', results%integration_columns, 4, &
      results%n_points, results%integration, error)
  end subroutine create_frames


  !> Tables of fields, which a file that ties partitions takes from them.
  subroutine create_field_columns(results, folder, columns, size_row, n_rows, tables, error)
    type(results_type), intent(in) :: results
    character(*), intent(in) :: folder
    type(result_column_type), intent(in) :: columns(:)
    integer, intent(in) :: size_row                 !< row of results%sizes
    integer, intent(in) :: n_rows                   !< in a frame
    type(hdf5_table_type), allocatable, intent(inout) :: tables(:)
    type(error_type), allocatable, intent(out) :: error
    if (results%content == CONTENT_TIED) then
      call create_virtual_columns(results%store, folder, columns, results%sources, results%sizes(size_row, :), error)
    else
      call create_columns(results%store, folder, columns, n_rows, tables, error)
    end if
  end subroutine create_field_columns


  !> The columns of the nodes: LE in place of E under NLGEOM, and those of shells and beams.
  pure function columns_of_nodes(model) result(columns)
    type(model_type), intent(in) :: model
    type(result_column_type), allocatable :: columns(:)
    columns = POINT_COLUMNS
    if (any(model%steps%is_nlgeom) .and. model%dialect /= DIALECT_CALCULIX) columns(STRAIN_COLUMN)%name = 'LE'
    if (allocated(model%structure)) columns = [columns, STRUCTURE_COLUMNS]
  end function columns_of_nodes


  !> The columns of the integration points, with STATEV if a user material has state variables, and with damage.
  pure function columns_of_points(model) result(columns)
    type(model_type), intent(in) :: model
    type(result_column_type), allocatable :: columns(:)
    integer :: n
    columns = INTEGRATION_COLUMNS
    n = 0
    if (size(model%materials) > 0) n = maxval(model%materials%n_statev)
    if (n > 0) columns = [columns, result_column_type('SDV', n, '[-]', 'State variables of UMAT or USDFLD (STATEV).')]
    if (has_damage_law(model)) columns = [columns, &
      result_column_type('SDEG', 1, '[-]', 'Damage of cohesive elements; 0 elsewhere.'), &
      result_column_type('DMICRT', 1, '[-]', 'Largest value so far of the criterion of damage, at most 1; 0 elsewhere.')]
  end function columns_of_points


  !> The tables that grow by a row at a time.
  subroutine create_histories(results, n_pairs, error)
    type(results_type), intent(inout) :: results
    integer, intent(in) :: n_pairs
    type(error_type), allocatable, intent(out) :: error
    if (n_pairs > 0) call create_columns(results%store, '/AMONTONS/pair_history', PAIR_COLUMNS, n_pairs, results%pairs, error)
    if (allocated(error)) return
    call create_columns(results%store, '/AMONTONS/history', HISTORY_COLUMNS, 1, results%history, error)
    if (.not. allocated(error)) call create_failure_texts(results%failure_texts, results%store, error)
    if (.not. allocated(error)) call create_columns(results%store, '/AMONTONS/iterations', ITERATION_COLUMNS, 1, &
      results%iterations, error)
  end subroutine create_histories


  !> Writes the fields of an increment as a new frame. All values are checked first, so that an error leaves the file consistent.
  subroutine write_frame(results, model, fields, slaves, error)
    type(results_type), intent(inout) :: results
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(slave_state_type), intent(in) :: slaves(:)       !< as nodal_slaves gives them
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: reals(:, :), contact_reals(:, :)
    integer, allocatable :: integers(:, :), contact_integers(:, :)
    if (results%content /= CONTENT_PARTITION) then
      if (.not. allocated(results%contact)) call create_contact(results, slaves, model%mesh%n_nodes, error)
      if (allocated(error)) return
      if (size(slaves) /= results%n_slaves) then
        call set_error(error, EXIT_INTERNAL, 'The number of slave nodes has changed since the first increment.')
        return
      end if
    end if
    if (results%content /= CONTENT_TIED) then
      call check_points(results, model, fields, error)
      if (.not. allocated(error)) call pack_nodes(results, model, fields, slaves, reals, integers, error)
      if (allocated(error)) return
    end if
    if (results%content /= CONTENT_PARTITION) then
      call pack_slaves(slaves, contact_integers, contact_reals)
      call check_finite('slave', CONTACT_COLUMNS, contact_reals, error)
      if (allocated(error)) return
    end if
    associate (store => results%store)
      if (results%content /= CONTENT_TIED) then
        call append_columns(store, results%point_columns, integers, reals, results%point, error)
        deallocate (integers, reals)
        if (.not. allocated(error)) call append_points(results, model, fields, error)
      end if
      if (results%content /= CONTENT_PARTITION .and. .not. allocated(error)) call append_columns(store, CONTACT_COLUMNS, &
        contact_integers, contact_reals, results%contact, error)
    end associate
    if (.not. allocated(error)) call write_step(results, fields%total_time, error)
  end subroutine write_frame


  !> The fields at the nodes of the file, then at the points of analytic surfaces.
  subroutine pack_nodes(results, model, fields, slaves, reals, integers, error)
    type(results_type), intent(in) :: results
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP), allocatable, intent(out) :: reals(:, :)     !< (widths of the real columns, n_nodes)
    integer, allocatable, intent(out) :: integers(:, :)   !< (N_POINT_INTEGERS, n_nodes)
    type(error_type), allocatable, intent(out) :: error
    allocate (reals(sum(results%point_columns%width, mask=.not. results%point_columns%is_integer), results%n_nodes), &
      integers(N_POINT_INTEGERS, results%n_nodes))
    associate (n => size(results%order%nodes))
      call point_fields(model, results%selection, fields, slaves, results%no_projection_gap, reals(:N_POINT_REALS, :n), &
        integers(:, :n))
      if (size(reals, 1) > N_POINT_REALS) call structure_fields(model, results%selection, fields, reals(N_POINT_REALS + 1:, :n))
      reals(:, n + 1:) = 0.0_DP
      reals(:3, n + 1:) = drawn_displacements(results%drawn, fields%u)
      integers(:, n + 1:) = 0
      integers(1, n + 1:) = STATUS_NO_SLAVE
    end associate
    call check_finite('node', results%point_columns, reals, error, results%order%nodes)
  end subroutine pack_nodes


  !> Sets an error if a value at an integration point is NaN or infinite.
  subroutine check_points(results, model, fields, error)
    type(results_type), intent(in) :: results
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(error_type), allocatable, intent(out) :: error
    character(*), parameter :: WHERE = 'integration point'
    associate (columns => results%integration_columns)
      call check_finite(WHERE, columns(1:1), fields%stress, error)
      if (.not. allocated(error)) call check_finite(WHERE, columns(2:2), fields%strain, error)
      if (.not. allocated(error)) call check_finite(WHERE, columns(3:3), reshape(fields%energy, [1, size(fields%energy)]), error)
      if (allocated(error) .or. size(fields%history, 1) == 0) return
      call check_finite(WHERE, columns(4:4), reshape(history_variable(fields, HISTORY_PEEQ), [1, size(fields%energy)]), error)
      if (.not. allocated(error) .and. has_column('SDV', columns)) call check_finite(WHERE, columns(5:5), &
        fields%history(USER_STATE:USER_STATE + columns(5)%width - 1, :), error)
      if (.not. allocated(error) .and. has_column('SDEG', columns)) call check_finite(WHERE, columns(size(columns) - 1:), &
        damage_variables(model, fields), error)
    end associate
  end subroutine check_points


  !> Appends the fields at the integration points, without a common copy.
  subroutine append_points(results, model, fields, error)
    type(results_type), intent(inout) :: results
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: damage(:, :)
    integer :: n
    n = size(fields%energy)
    associate (table => results%integration)
      call append_values(results, table(1), fields%stress, error)
      if (.not. allocated(error)) call append_values(results, table(2), fields%strain, error)
      if (.not. allocated(error)) call append_values(results, table(3), reshape(fields%energy, [1, n]), error)
      if (.not. allocated(error)) call append_values(results, table(4), reshape(history_variable(fields, HISTORY_PEEQ), [1, n]), &
        error)
      if (.not. allocated(error) .and. has_column('SDV', results%integration_columns)) call append_values(results, table(5), &
        fields%history(USER_STATE:USER_STATE + results%integration_columns(5)%width - 1, :), error)
      if (allocated(error) .or. .not. has_column('SDEG', results%integration_columns)) return
      damage = damage_variables(model, fields)
      call append_values(results, table(size(table) - 1), damage(1:1, :), error)
      if (.not. allocated(error)) call append_values(results, table(size(table)), damage(2:2, :), error)
    end associate
  end subroutine append_points


  !> Whether there is a column of a name.
  pure logical function has_column(name, columns)
    character(*), intent(in) :: name
    type(result_column_type), intent(in) :: columns(:)
    integer :: i
    has_column = any([(columns(i)%name == name, i=1, size(columns))])
  end function has_column


  !> Appends values at the integration points of the file.
  subroutine append_values(results, table, values, error)
    type(results_type), intent(in) :: results
    type(hdf5_table_type), intent(inout) :: table
    real(DP), intent(in) :: values(:, :)            !< (width, points of the model)
    type(error_type), allocatable, intent(out) :: error
    if (allocated(results%point_index)) then
      call append_rows(results%store, table, values(:, results%point_index), error)
    else
      call append_rows(results%store, table, values, error)
    end if
  end subroutine append_values


  !> Creates the contact tables, with pair and node of each row.
  subroutine create_contact(results, slaves, n_nodes, error)
    type(results_type), intent(inout) :: results
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: n_nodes                  !< of the model
    type(error_type), allocatable, intent(out) :: error
    integer :: place(n_nodes)
    place = first_places(results%order%nodes, n_nodes)
    results%n_slaves = size(slaves)
    call create_columns(results%store, '/AMONTONS/contact', CONTACT_COLUMNS, max(1, size(slaves)), &
      results%contact, error)
    if (.not. allocated(error)) call write_data(results%store, '/AMONTONS/contact/pair', slaves%pair - 1, '[-]', &
      'Pair of each slave node.', error)
    if (.not. allocated(error)) call write_data(results%store, '/AMONTONS/contact/node', place(slaves%node) - 1, '[-]', &
      'Node of each slave node.', error)
  end subroutine create_contact


  !> The rows of /VTKHDF/Steps; the number of steps last, so that a reader never sees an incomplete frame.
  subroutine write_step(results, time, error)
    type(results_type), intent(inout) :: results
    real(DP), intent(in) :: time                    !< total time [time]
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: values(size(STEP_TABLES))
    integer :: i
    values = 0
    values(STEP_PARTITIONS) = 1
    if (results%content == CONTENT_TIED) values(STEP_PARTITIONS) = size(results%sizes, 2, kind=I64)
    associate (store => results%store)
      call append_rows(store, results%time, reshape([time], [1, 1]), error)
      do i = 1, size(results%constant)
        if (.not. allocated(error)) call append_rows(store, results%constant(i), values(i), error)
      end do
      do i = 1, size(results%point_offset)
        if (.not. allocated(error)) call append_rows(store, results%point_offset(i), &
          int(results%n_frames, I64) * int(results%n_nodes, I64), error)
      end do
      if (.not. allocated(error)) call write_attribute(store, '/VTKHDF/Steps', 'NSteps', [results%n_frames + 1], error)
    end associate
    if (.not. allocated(error)) results%n_frames = results%n_frames + 1
  end subroutine write_step


  !> The contact state of all slaves in the order of CONTACT_COLUMNS.
  pure subroutine pack_slaves(slaves, integers, reals)
    type(slave_state_type), intent(in) :: slaves(:)
    integer, allocatable, intent(out) :: integers(:, :)
    real(DP), allocatable, intent(out) :: reals(:, :)
    integer :: i
    allocate (integers(N_CONTACT_INTEGERS, size(slaves)), reals(N_CONTACT_REALS, size(slaves)))
    do i = 1, size(slaves)
      associate (slave => slaves(i))
        integers(:, i) = [slave%facet - 1, slave%status, slave%scenario]
        reals(:, i) = [slave%xi, slave%gap, slave%normal, slave%force, slave%shear, slave%slip, slave%area, &
          slave%stiffness]
      end associate
    end do
  end subroutine pack_slaves


  !> Writes a history row and flushes the file.
  subroutine write_row(results, record, frame, error)
    type(results_type), intent(inout) :: results
    type(increment_record_type), intent(in) :: record
    integer, intent(in) :: frame                    !< its frame, from 0; -1: none
    type(error_type), allocatable, intent(out) :: error
    integer :: integers(N_HISTORY_INTEGERS, 1)
    real(DP) :: reals(N_HISTORY_REALS, 1)
    integers(:, 1) = [record%step, record%increment, record%attempt, merge(1, 0, record%is_converged), &
      record%n_iterations, record%n_cutbacks, record%n_status, record%n_scenario, record%n_factorisations, &
      record%n_krylov, record%n_cycles_treated, record%n_status_changes, frame]
    reals(:, 1) = [record%total_time, record%step_time, record%dt, record%smallest_step_length, record%residual, &
      record%correction, record%seconds, record%applied_force, record%reaction_force, record%contact_force, &
      record%slave_force, record%external_work, record%friction_work, record%strain_energy, &
      record%contact_energy, record%proximal_work, record%stabilization_work, &
      record%plastic_work, record%kinetic_energy, record%integration_loss, record%load_factor]
    if (record%is_converged) call check_finite('history row', HISTORY_COLUMNS, reals, error)
    if (.not. allocated(error)) then
      reals(:, 1) = finite_or_marker(reals(:, 1))
      call append_columns(results%store, HISTORY_COLUMNS, integers, reals, results%history, error)
    end if
    if (.not. allocated(error)) call append_failure_texts(results%failure_texts, results%store, record, error)
    if (.not. allocated(error)) call flush_hdf5(results%store, error)
    if (allocated(error)) call abandon(results)
  end subroutine write_row


  !> A value for the history: NaN and infinity of a failed attempt become 1e30.
  elemental function finite_or_marker(value) result(written)
    real(DP), intent(in) :: value
    real(DP) :: written
    written = NOT_FINITE_VALUE
    if (ieee_is_finite(value)) written = value
  end function finite_or_marker


  !> Creates the tables; the group of the history exists.
  subroutine create_failure_texts(failure_texts, store, error)
    type(failure_text_type), intent(out) :: failure_texts
    type(hdf5_file_type), intent(in) :: store
    type(error_type), allocatable, intent(out) :: error
    call create_table(store, failure_texts%reason, REASON_TABLE, REASON_FORM, '[-]', &
      'Why the attempt failed; empty if it converged.', error)
    if (.not. allocated(error)) call create_group(store, FAILURE_TEXT_GROUP, error)
    if (.not. allocated(error)) call create_table(store, failure_texts%line, FAILURE_TEXT_GROUP // '/line', LINE_FORM, '[-]', &
      'Reports on failed attempts: worst nodes with their contact, and a remedy.', error)
    if (.not. allocated(error)) call create_table(store, failure_texts%attempt, FAILURE_TEXT_GROUP // '/attempt', ROW_FORM, '[-]', &
      'Row of the history for each line.', error)
  end subroutine create_failure_texts


  !> Opens the tables of an existing file.
  subroutine open_failure_texts(failure_texts, store, error)
    type(failure_text_type), intent(out) :: failure_texts
    type(hdf5_file_type), intent(in) :: store
    type(error_type), allocatable, intent(out) :: error
    call open_table(store, failure_texts%reason, REASON_TABLE, REASON_FORM, error)
    if (.not. allocated(error)) call open_table(store, failure_texts%line, FAILURE_TEXT_GROUP // '/line', LINE_FORM, error)
    if (.not. allocated(error)) call open_table(store, failure_texts%attempt, FAILURE_TEXT_GROUP // '/attempt', ROW_FORM, error)
  end subroutine open_failure_texts


  !> Appends the report of an attempt.
  subroutine append_failure_texts(failure_texts, store, record, error)
    type(failure_text_type), intent(inout) :: failure_texts
    type(hdf5_file_type), intent(in) :: store
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: words
    integer :: row, i
    row = int(failure_texts%reason%n_rows)
    words = ''
    if (allocated(record%reason)) words = record%reason
    call append_rows(store, failure_texts%reason, words, error)
    if (.not. allocated(record%report_lines)) return
    do i = 1, size(record%report_lines)
      if (.not. allocated(error)) call append_rows(store, failure_texts%line, trim(record%report_lines(i)), error)
      if (.not. allocated(error)) call append_rows(store, failure_texts%attempt, reshape([row], [1, 1]), error)
      if (allocated(error)) return
    end do
  end subroutine append_failure_texts

end module amontons_results
