!> Results of a global model for submodels: its mesh, its increments, and nodal fields, from .vtkhdf or .frd.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Elements without an inside (springs, masses, trusses) and those of fewer dimensions than the others (membranes on solids, drawn
!! rigid surfaces) are left out. Shells and beams are the solids to which both programs expand them.
module amontons_global_results
  use amontons_kinds, only: DP, I64
  use amontons_containers, only: sort_ascending
  use amontons_errors, only: error_type, set_error, EXIT_IO, EXIT_SETUP
  use amontons_element_kinds, only: N_SOLID_KINDS, KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D10, KIND_C3D15, KIND_C3D20, &
    KIND_CPS3, KIND_CPS4, KIND_CPS6, KIND_CPS8
  use amontons_frd_input, only: frd_input_type, open_frd_input, close_frd_input, read_frd_block
  use amontons_hdf5_input, only: hdf5_input_type, open_hdf5_input, close_hdf5_input, read_integers, read_reals, read_texts
  use amontons_text, only: name_key, to_text
  implicit none
  private
  public :: global_results_type, global_frame_type, open_global_results, close_global_results, find_global_frames, &
    read_global_field, find_global_set, GLOBAL_DISPLACEMENT, GLOBAL_TEMPERATURE

  integer, parameter :: GLOBAL_DISPLACEMENT = 1, GLOBAL_TEMPERATURE = 2
  character(8), parameter :: FRD_NAMES(2) = ['DISP    ', 'NDTEMP  ']
  character(2), parameter :: VTK_NAMES(2) = ['U ', 'NT']
  integer, parameter :: WIDTHS(2) = [3, 1]             !< values per node

  ! VTK cell types of the shapes, and their kinds.
  integer, parameter :: VTK_TYPES(10) = [10, 12, 13, 24, 25, 26, 5, 9, 22, 23]
  integer, parameter :: VTK_KINDS(10) = [KIND_C3D4, KIND_C3D8, KIND_C3D6, KIND_C3D10, KIND_C3D20, KIND_C3D15, KIND_CPS3, &
    KIND_CPS4, KIND_CPS6, KIND_CPS8]

  !> One increment with a field.
  type :: global_frame_type
    integer :: step = 0                                !< 0: before the first step
    integer :: data_set = 0                            !< of a .frd file its number in CGX, of a .vtkhdf file the frame, from 0
    real(DP) :: step_time = 0                          !< since the start of the step [time]
    integer :: place = 0                               !< block of the .frd file, or frame
  end type global_frame_type

  !> An open result file.
  type :: global_results_type
    character(:), allocatable :: path
    logical :: is_frd = .false.
    logical :: is_solid = .false.                      !< solids; else plane or axisymmetric elements
    integer :: n_nodes = 0
    real(DP), allocatable :: coordinates(:, :)         !< (3, n_nodes) undeformed [length]
    integer, allocatable :: kind(:)                    !< (elements) KIND_... of their shape
    integer, allocatable :: first(:)                   !< (elements + 1)
    integer, allocatable :: nodes(:)                   !< in the order of a deck
    integer, allocatable :: element_label(:)           !< (elements) in the global deck; 0: unknown
    type(frd_input_type), private :: frd
    type(hdf5_input_type), private :: hdf5
  end type global_results_type

contains

  !> Opens a file: .frd by its name, else .vtkhdf. Errors: EXIT_IO.
  subroutine open_global_results(results, path, error)
    type(global_results_type), intent(out) :: results
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    logical :: is_there
    results%path = path
    results%is_frd = .false.
    if (len(path) > 4) results%is_frd = path(len(path) - 3:) == '.frd'
    inquire (file=path, exist=is_there)
    if (.not. is_there) then
      call set_error(error, EXIT_IO, 'The file ' // path // ' with the results of the global model does not exist.')
    else if (results%is_frd) then
      call open_frd_input(results%frd, path, error)
      if (.not. allocated(error)) call take_frd_mesh(results)
    else
      call open_hdf5_input(results%hdf5, path, error)
      if (.not. allocated(error)) call read_vtk_mesh(results, error)
    end if
    if (allocated(error)) return
    call keep_largest_dimension(results)
    if (size(results%kind) == 0) call set_error(error, EXIT_IO, 'The global model of ' // path // ' has no solid, plane or ' // &
      'axisymmetric elements, in which its results could be interpolated.')
  end subroutine open_global_results


  !> Closes the file.
  subroutine close_global_results(results)
    type(global_results_type), intent(inout) :: results
    call close_frd_input(results%frd)
    call close_hdf5_input(results%hdf5)
  end subroutine close_global_results


  !> The mesh of a .frd file.
  subroutine take_frd_mesh(results)
    type(global_results_type), intent(inout) :: results
    results%n_nodes = results%frd%n_nodes
    call move_alloc(results%frd%coordinates, results%coordinates)
    call move_alloc(results%frd%kind, results%kind)
    call move_alloc(results%frd%first, results%first)
    call move_alloc(results%frd%nodes, results%nodes)
    call move_alloc(results%frd%element_label, results%element_label)
  end subroutine take_frd_mesh


  !> The mesh of a .vtkhdf file: the parts one after the other, whose connectivity counts within each.
  subroutine read_vtk_mesh(results, error)
    type(global_results_type), intent(inout) :: results
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: n_points(:), n_cells(:), n_ids(:), ids(:), offsets(:), types(:), labels(:)
    integer :: part, e, node_base, cell_base, id_base
    associate (hdf5 => results%hdf5)
      call read_integers(hdf5, '/VTKHDF/NumberOfPoints', n_points, error)
      if (.not. allocated(error)) call read_integers(hdf5, '/VTKHDF/NumberOfCells', n_cells, error)
      if (.not. allocated(error)) call read_integers(hdf5, '/VTKHDF/NumberOfConnectivityIds', n_ids, error)
      if (.not. allocated(error)) call read_integers(hdf5, '/VTKHDF/Connectivity', ids, error)
      if (.not. allocated(error)) call read_integers(hdf5, '/VTKHDF/Offsets', offsets, error)
      if (.not. allocated(error)) call read_integers(hdf5, '/VTKHDF/Types', types, error)
      if (.not. allocated(error)) call read_integers(hdf5, '/VTKHDF/CellData/ELEMENT', labels, error)
      if (.not. allocated(error)) call read_reals(hdf5, '/VTKHDF/Points', results%coordinates, error)
    end associate
    if (allocated(error)) return
    results%n_nodes = sum(n_points)
    allocate (results%first(sum(n_cells) + 1), results%nodes(sum(n_ids)))
    results%first(1) = 1
    node_base = 0
    cell_base = 0
    id_base = 0
    do part = 1, size(n_points)
      do e = 1, n_cells(part)                          ! a part has one offset more than cells
        results%first(cell_base + e + 1) = id_base + 1 + offsets(cell_base + part + e)
      end do
      results%nodes(id_base + 1:id_base + n_ids(part)) = ids(id_base + 1:id_base + n_ids(part)) + 1 + node_base
      node_base = node_base + n_points(part)
      cell_base = cell_base + n_cells(part)
      id_base = id_base + n_ids(part)
    end do
    results%kind = [(kind_of(types(e)), e=1, size(types))]
    results%element_label = labels
  end subroutine read_vtk_mesh


  !> The kind of a VTK cell type; 0: none.
  pure integer function kind_of(vtk_type) result(kind)
    integer, intent(in) :: vtk_type
    integer :: at
    at = findloc(VTK_TYPES, vtk_type, dim=1)
    kind = 0
    if (at > 0) kind = VTK_KINDS(at)
  end function kind_of


  !> Leaves out elements without an inside, and plane ones if there are solids.
  subroutine keep_largest_dimension(results)
    type(global_results_type), intent(inout) :: results
    integer, allocatable :: first(:), nodes(:)
    logical, allocatable :: is_kept(:)
    integer :: e, n, n_kept
    results%is_solid = any(results%kind > 0 .and. results%kind <= N_SOLID_KINDS)
    is_kept = results%kind > 0 .and. (results%kind <= N_SOLID_KINDS .or. .not. results%is_solid)
    allocate (first(count(is_kept) + 1), nodes(size(results%nodes)))
    first(1) = 1
    n_kept = 0
    do e = 1, size(results%kind)
      if (.not. is_kept(e)) cycle
      n_kept = n_kept + 1
      n = results%first(e + 1) - results%first(e)
      first(n_kept + 1) = first(n_kept) + n
      nodes(first(n_kept):first(n_kept + 1) - 1) = results%nodes(results%first(e):results%first(e + 1) - 1)
    end do
    results%nodes = nodes(:first(n_kept + 1) - 1)
    call move_alloc(first, results%first)
    results%element_label = pack(results%element_label, is_kept)
    results%kind = pack(results%kind, is_kept)
  end subroutine keep_largest_dimension


  !> The increments that have a field, in the order of the file. Errors: EXIT_IO.
  subroutine find_global_frames(results, field, frames, error)
    type(global_results_type), intent(in) :: results
    integer, intent(in) :: field                       !< GLOBAL_...
    type(global_frame_type), allocatable, intent(out) :: frames(:)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: step(:), frame(:)
    real(DP), allocatable :: time(:, :)
    real(DP) :: start, last                            ! total time as the present step began, and of the increment before
    integer :: i, n
    allocate (frames(0))
    start = 0
    last = 0
    if (results%is_frd) then
      associate (blocks => results%frd%blocks)
        do i = 1, size(blocks)
          if (blocks(i)%name /= FRD_NAMES(field) .or. blocks(i)%n_values < WIDTHS(field)) cycle
          n = size(frames)
          if (n > 0) then
            if (frames(n)%step /= blocks(i)%step) start = last
          end if
          last = blocks(i)%time
          frames = [frames, global_frame_type(blocks(i)%step, blocks(i)%data_set, last - start, i)]
        end do
      end associate
      return
    end if
    call read_integers(results%hdf5, '/AMONTONS/history/step', step, error)
    if (.not. allocated(error)) call read_integers(results%hdf5, '/AMONTONS/history/frame', frame, error)
    if (.not. allocated(error)) call read_reals(results%hdf5, '/AMONTONS/history/step_time', time, error)
    if (allocated(error)) return
    do i = 1, size(step)
      if (frame(i) >= 0) frames = [frames, global_frame_type(step(i), frame(i), time(1, i), frame(i))]
    end do
  end subroutine find_global_frames


  !> A field at all nodes in one increment. Errors: EXIT_IO.
  subroutine read_global_field(results, field, frame, values, is_given, error)
    type(global_results_type), intent(inout) :: results
    integer, intent(in) :: field                       !< GLOBAL_...
    type(global_frame_type), intent(in) :: frame
    real(DP), allocatable, intent(out) :: values(:, :) !< (width of the field, n_nodes)
    logical, allocatable, intent(out) :: is_given(:)   !< (n_nodes) the file has the values of the node; else they are 0
    type(error_type), allocatable, intent(out) :: error
    if (results%is_frd) then
      call read_frd_block(results%frd, results%frd%blocks(frame%place), values, is_given, error)
    else
      call read_reals(results%hdf5, '/VTKHDF/PointData/' // trim(VTK_NAMES(field)), values, error, &
        int(frame%place, I64) * int(results%n_nodes, I64), int(results%n_nodes, I64))
      allocate (is_given(results%n_nodes), source=.true.)
    end if
  end subroutine read_global_field


  !> The numbers of the elements in a set of the global deck, which a .vtkhdf file has. Errors: EXIT_SETUP, EXIT_IO.
  subroutine find_global_set(results, name, labels, error)
    type(global_results_type), intent(in) :: results
    character(*), intent(in) :: name
    integer, allocatable, intent(out) :: labels(:)     !< ascending
    type(error_type), allocatable, intent(out) :: error
    character(*), parameter :: SETS = '/AMONTONS/mesh/element_sets/'
    character(:), allocatable :: names(:)
    integer, allocatable :: first(:), members(:), all_labels(:)
    integer :: s
    if (results%is_frd) then
      call set_error(error, EXIT_SETUP, 'GLOBAL ELSET=' // name // ': a .frd file has no sets. Write *ELSET, ELSET=' // name // &
        ' with the numbers of the global elements into this deck.')
      return
    end if
    call read_texts(results%hdf5, SETS // 'name', names, error)
    if (.not. allocated(error)) call read_integers(results%hdf5, SETS // 'first', first, error)
    if (.not. allocated(error)) call read_integers(results%hdf5, SETS // 'members', members, error)
    if (.not. allocated(error)) call read_integers(results%hdf5, '/AMONTONS/mesh/element_label', all_labels, error)
    if (allocated(error)) return
    do s = 1, size(names)
      if (name_key(names(s)) /= name_key(name)) cycle
      labels = all_labels(1 + members(first(s) + 1:first(s + 1)))
      call sort_ascending(labels)
      return
    end do
    call set_error(error, EXIT_SETUP, 'GLOBAL ELSET=' // name // ': neither this deck nor ' // results%path // ' has an ' // &
      'element set of this name; the file has ' // to_text(size(names)) // ' sets.')
  end subroutine find_global_set

end module amontons_global_results
