!> The file job.frd: mesh and nodal fields in CalculiX's text format, for CGX, PrePoMax and other programs.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Written for FILE or OUTPUT cards under the calculix dialect, or with the option `--frd`. It is a copy with six digits;
!! job.vtkhdf contains double precision. One frame per written increment, one block per field. The file contains no date, so that
!! the same job gives the same file.
!!
!! As in CalculiX's own file, nodes without elements are omitted, in each frame also those whose elements are all removed
!! (MODEL CHANGE), and elements of one node. Nodes and elements are sorted by number.
!!
!! Layers of composite shells share no nodes here: each has its own stresses at the interfaces.
!!
!! Reference: CGX manual, "Result Format": fixed columns, long form; element types 1 to 12 with their order of nodes,
!! in which the mid-side nodes of the upright edges come before those of the top.
module amontons_frd_output
  use amontons_kinds, only: DP, I64
  use amontons_dense, only: least_squares
  use amontons_errors, only: error_type, set_error, EXIT_IO
  use amontons_posix, only: truncate_file, sync_file
  use amontons_text, only: format_value_rows, place_integer, to_text
  use amontons_containers, only: sort_integers
  use amontons_element_kinds, only: element_kind, facet_kind, element_kind_type, facet_kind_type, N_KINDS, MAX_FACE_NODES, &
    FACET_LINE2, FACET_QUAD4, FACET_TRI3, FAMILY_MASS, FAMILY_RIGID, FAMILY_SOLID
  use amontons_mesh, only: mesh_type
  use amontons_shape_functions, only: facet_shapes
  use amontons_frd_input, only: FRD_VALUES_PER_LINE
  use amontons_steps, only: frd_request_type, is_output_due, step_type, FRD_CELS, FRD_CONTACT, FRD_DISP, FRD_ENER, FRD_ERROR, &
    FRD_FORC, FRD_MESTRAIN, FRD_NDTEMP, FRD_PE, FRD_SDV, FRD_STRESS, FRD_THSTRAIN, FRD_TOSTRAIN, N_FRD
  use amontons_model, only: job_options_type, job_path, model_type, absent_elements, DIALECT_CALCULIX
  use amontons_iteration_records, only: increment_record_type
  use amontons_state, only: equivalent_plastic_strain, state_variables, n_state_variables, fields_type, slave_state_type, &
    STATUS_OPEN
  use amontons_layer_nodes, only: separate_layers
  use amontons_nodal_fields, only: fill_midside_values, list_midside_nodes
  use amontons_postprocess, only: average_at_nodes, estimate_error, mechanical_strain, nodal_slaves, &
    n_nodal_slaves, &
    printed_energy_density, printed_contact_energy, printed_slip, rotate_truss_tensors, has_truss_axes
  use amontons_dat_output, only: in_orientation, in_transform, printed_forces
  use amontons_dat_contact_output, only: contact_axes
  use amontons_version, only: VERSION
  implicit none
  private
  public :: frd_type, open_frd, is_frd_open, write_frd_mesh, resume_frd, write_frd, frd_file_counts, sync_frd, close_frd

  real(DP), parameter :: TOL_EQUAL_PRESSURE = 1.0e-6_DP         !< relative difference of equal pressures [-]
  integer, parameter :: KIND_SCALAR = 1, KIND_VECTOR = 2, KIND_TENSOR = 4   !< of CGX

  !> An open file; unit 0: not open.
  type :: frd_type
    private
    integer :: unit = 0
    character(:), allocatable :: path
    integer :: n_frames = 0
    integer :: n_blocks = 0
    logical :: is_all = .false.                    !< all fields, not only those requested by cards
    type(mesh_type), allocatable :: layered        !< the mesh with separate layers of composite shells; unallocated: no such shells
    integer, allocatable :: origin(:)              !< (n_nodes of layered) node of the model
    integer, allocatable :: nodes(:)               !< nodes with elements: those written
    integer, allocatable :: present(:)             !< those with elements in the current frame
    integer :: status = 0                          !< of the first line that could not be written
  end type frd_type

  !> The head of a block: scalars, a vector with its magnitude, or a symmetric tensor.
  type :: head_type
    character(8) :: name = ''
    integer :: n = 1                               !< components that are written
    integer :: kind = KIND_SCALAR                  !< KIND_...
    character(8) :: components(6) = ''
  end type head_type

  type(head_type), parameter :: HEADS(N_FRD) = [ &
    head_type('DISP', 3, KIND_VECTOR, [character(8) :: 'D1', 'D2', 'D3', 'ALL', '', '']), &
    head_type('NDTEMP', 1, KIND_SCALAR, [character(8) :: 'T', '', '', '', '', '']), &
    head_type('STRESS', 6, KIND_TENSOR, [character(8) :: 'SXX', 'SYY', 'SZZ', 'SXY', 'SYZ', 'SZX']), &
    head_type('TOSTRAIN', 6, KIND_TENSOR, [character(8) :: 'EXX', 'EYY', 'EZZ', 'EXY', 'EYZ', 'EZX']), &
    head_type('MESTRAIN', 6, KIND_TENSOR, [character(8) :: 'MEXX', 'MEYY', 'MEZZ', 'MEXY', 'MEYZ', 'MEZX']), &
    head_type('THSTRAIN', 6, KIND_TENSOR, [character(8) :: 'THXX', 'THYY', 'THZZ', 'THXY', 'THYZ', 'THZX']), &
    head_type('FORC', 3, KIND_VECTOR, [character(8) :: 'F1', 'F2', 'F3', 'ALL', '', '']), &
    head_type('PE', 1, KIND_SCALAR, [character(8) :: 'PE', '', '', '', '', '']), &
    head_type('ENER', 1, KIND_SCALAR, [character(8) :: 'ENER', '', '', '', '', '']), &
    head_type('CONTACT', 6, KIND_TENSOR, [character(8) :: 'COPEN', 'CSLIP1', 'CSLIP2', 'CPRESS', 'CSHEAR1', 'CSHEAR2']), &
    head_type('CELS', 1, KIND_SCALAR, [character(8) :: 'CELS', '', '', '', '', '']), &
    head_type('SDV', 0, KIND_SCALAR, ''), &
    head_type('ERROR', 1, KIND_SCALAR, [character(8) :: 'STR(%)', '', '', '', '', ''])]

contains

  !> Creates job.frd, if requested.
  subroutine open_frd(frd, model, options, error)
    type(frd_type), intent(out) :: frd
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    type(error_type), allocatable, intent(out) :: error
    call prepare(frd, model, options)
    if (.not. is_wanted(model, options)) return
    call open_file(frd, 'replace', error)
  end subroutine open_frd


  !> Whether the job writes the file, by this rank.
  pure logical function is_frd_open(frd)
    type(frd_type), intent(in) :: frd
    is_frd_open = frd%unit /= 0
  end function is_frd_open


  !> Writes the mesh, if the file is open.
  subroutine write_frd_mesh(frd, model, error)
    type(frd_type), intent(inout) :: frd
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    if (frd%unit == 0) return
    call write_head(frd, model)
    if (allocated(frd%layered)) then
      call write_nodes(frd, frd%layered)
      call write_elements(frd, frd%layered)
    else
      call write_nodes(frd, model%mesh)
      call write_elements(frd, model%mesh)
    end if
    call check_written(frd, error)
  end subroutine write_frd_mesh


  !> Reopens the file of a job resumed from a checkpoint, truncated to its length then.
  subroutine resume_frd(frd, model, options, counts, error)
    type(frd_type), intent(out) :: frd
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    integer(I64), intent(in) :: counts(3)          !< bytes, frames, blocks at the checkpoint (frd_file_counts)
    type(error_type), allocatable, intent(out) :: error
    call prepare(frd, model, options)
    if (counts(1) == 0) then
      call open_frd(frd, model, options, error)
      if (.not. allocated(error)) call write_frd_mesh(frd, model, error)
      return
    end if
    frd%is_all = frd%is_all .or. .not. is_wanted(model, options)
    frd%n_frames = int(counts(2))
    frd%n_blocks = int(counts(3))
    call truncate_file(frd%path, counts(1), error)
    if (.not. allocated(error)) call open_file(frd, 'old', error)
  end subroutine resume_frd


  !> Sets path, nodes, and the choice of fields.
  subroutine prepare(frd, model, options)
    type(frd_type), intent(inout) :: frd
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    logical :: has_layers
    integer :: e
    frd%path = job_path(options, '.frd')
    frd%is_all = options%has_frd
    has_layers = allocated(model%mesh%layer)
    if (has_layers) has_layers = any(model%mesh%layer > 1)
    if (has_layers) then
      allocate (frd%layered)
      call separate_layers(model%mesh, frd%layered, frd%origin)
      frd%nodes = nodes_of(frd%layered, [(.false., e=1, model%mesh%n_elements)])
    else
      frd%nodes = nodes_of(model%mesh, [(.false., e=1, model%mesh%n_elements)])
    end if
  end subroutine prepare


  !> The nodes of elements, by their numbers (has_elements of the mesh excludes those of pre-tension sections).
  pure function nodes_of(mesh, is_absent) result(nodes)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)            !< (n_elements) removed
    integer, allocatable :: nodes(:)
    logical :: is_used(mesh%n_nodes)
    integer :: e, i
    is_used = .false.
    do e = 1, mesh%n_elements
      if (is_absent(e)) cycle
      is_used(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) = .true.
    end do
    nodes = pack([(i, i=1, mesh%n_nodes)], is_used)
    nodes = nodes(places_by_number(mesh%node_label(nodes)))
  end function nodes_of


  !> The permutation that sorts numbers in ascending order.
  pure function places_by_number(numbers) result(places)
    integer, intent(in) :: numbers(:)
    integer :: places(size(numbers)), ascending(size(numbers)), i
    places = [(i, i=1, size(numbers))]
    ascending = numbers
    call sort_integers(ascending, places)
  end function places_by_number


  !> Whether the job has such a file.
  pure logical function is_wanted(model, options)
    type(model_type), intent(in) :: model
    type(job_options_type), intent(in) :: options
    integer :: i
    is_wanted = options%has_frd
    if (model%dialect /= DIALECT_CALCULIX) return
    do i = 1, size(model%steps)
      is_wanted = is_wanted .or. any(model%steps(i)%frd%is_wanted)
    end do
  end function is_wanted


  !> Opens the file: new, or to append.
  subroutine open_file(frd, status_word, error)
    type(frd_type), intent(inout) :: frd
    character(*), intent(in) :: status_word
    type(error_type), allocatable, intent(out) :: error
    character(200) :: reason
    integer :: status
    open (newunit=frd%unit, file=frd%path, status=status_word, action='write', form='formatted', position='append', &
      iostat=status, iomsg=reason)
    if (status == 0) return
    frd%unit = 0
    call set_error(error, EXIT_IO, 'Cannot open the file ' // frd%path // ': ' // trim(reason) // '.')
  end subroutine open_file


  !> The head: program, heading, names of the materials.
  subroutine write_head(frd, model)
    type(frd_type), intent(inout) :: frd
    type(model_type), intent(in) :: model
    character(5) :: number
    integer :: i
    call write_line(frd, '    1C')
    if (allocated(model%heading)) then
      if (len(model%heading) > 0) call write_line(frd, '    1U' // first_line(model%heading))
    end if
    call write_line(frd, '    1UPGM               Amontons')
    call write_line(frd, '    1UVERSION           ' // VERSION)
    do i = 1, size(model%materials)
      write (number, '(i5)') i
      call write_line(frd, '    1UMAT' // number // model%materials(i)%name)
    end do
  end subroutine write_head


  !> The first line of a text, at most 66 characters.
  pure function first_line(text) result(line)
    character(*), intent(in) :: text
    character(:), allocatable :: line
    integer :: n
    n = scan(text, new_line('a')) - 1
    if (n < 0) n = len(text)
    line = text(:min(n, 66))
  end function first_line


  !> Block 2C: reference coordinates.
  subroutine write_nodes(frd, mesh)
    type(frd_type), intent(inout) :: frd
    type(mesh_type), intent(in) :: mesh
    character(90) :: line
    write (line, '(a,18x,i12,37x,i1)') '    2C', size(frd%nodes), 1
    call write_line(frd, line)
    call put_rows(frd, frd%nodes, mesh%node_label, mesh%coordinates)
    call write_line(frd, ' -3')
  end subroutine write_nodes


  !> Block 3C: elements of two nodes or more, many at a time.
  subroutine write_elements(frd, mesh)
    type(frd_type), intent(inout) :: frd
    type(mesh_type), intent(in) :: mesh
    character(120) :: line
    integer, parameter :: BUFFER = 1000000            ! characters
    integer :: shape_of_kind(N_KINDS), e, i, k, n_used
    integer, allocatable :: order(:), labels(:)
    character(:), allocatable :: text
    shape_of_kind = [(cgx_shape(element_kind(k)), k=1, N_KINDS)]
    write (line, '(a,18x,i12,37x,i1)') '    3C', count(shape_of_kind(mesh%kind) > 0), 1
    call write_line(frd, line)
    order = places_by_number(mesh%element_label)
    allocate (character(BUFFER) :: text)
    n_used = 0
    do k = 1, size(order)
      e = order(k)
      if (shape_of_kind(mesh%kind(e)) == 0) cycle
      call start_line(' -1')
      call put_number(mesh%element_label(e), 10)
      call put_number(shape_of_kind(mesh%kind(e)), 5)
      call put_number(0, 5)
      call put_number(mesh%material(e), 5)
      labels = in_cgx_order(mesh%node_label(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)))
      do i = 1, size(labels)
        if (mod(i, 10) == 1) call start_line(' -2')
        call put_number(labels(i), 10)
      end do
      if (n_used < BUFFER - 1000 .and. k < size(order)) cycle
      call write_line(frd, text(:n_used))
      n_used = 0
    end do
    if (n_used > 0) call write_line(frd, text(:n_used))
    call write_line(frd, ' -3')

  contains

    !> Begins a line of the buffer, which ends the one before.
    subroutine start_line(mark)
      character(3), intent(in) :: mark
      if (n_used > 0) then
        n_used = n_used + 1
        text(n_used:n_used) = new_line('a')
      end if
      text(n_used + 1:n_used + 3) = mark
      n_used = n_used + 3
    end subroutine start_line

    !> Appends a number to the line, at the right of its columns.
    subroutine put_number(number, width)
      integer, intent(in) :: number, width
      call place_integer(number, text(n_used + 1:n_used + width))
      n_used = n_used + width
    end subroutine put_number

  end subroutine write_elements


  !> The type number of CGX; 0 for elements of one node.
  pure integer function cgx_shape(entry) result(shape)
    type(element_kind_type), intent(in) :: entry
    shape = 0
    if (entry%family == FAMILY_MASS) return
    if (entry%family == FAMILY_SOLID) then
      select case (entry%n_nodes)
      case (4); shape = 3
      case (6); shape = 2
      case (8); shape = 1
      case (10); shape = 6
      case (15); shape = 5
      case (20); shape = 4
      end select
    else if (entry%n_faces > 0 .and. entry%family /= FAMILY_RIGID) then   ! plane, axisymmetric, membranes
      select case (entry%n_nodes)
      case (3); shape = 7
      case (6); shape = 8
      case (4); shape = 9
      case (8); shape = 10
      end select
    else if (entry%n_nodes == 2) then
      shape = 11
    else if (entry%n_nodes == 3) then
      shape = 12
    end if
  end function cgx_shape


  !> The nodes of an element in the order of CGX: of hexahedra and wedges with mid-side nodes the upright edges come
  !! before those of the top.
  pure function in_cgx_order(labels) result(ordered)
    integer, intent(in) :: labels(:)               !< in the order of the deck
    integer :: ordered(size(labels))
    ordered = labels
    if (size(labels) == 20) ordered(13:) = labels([17, 18, 19, 20, 13, 14, 15, 16])
    if (size(labels) == 15) ordered(10:) = labels([13, 14, 15, 10, 11, 12])
  end function in_cgx_order


  !> Writes a converged increment if the output frequency of its step selects it; nothing for increment 0.
  subroutine write_frd(frd, model, fields, record, error)
    type(frd_type), intent(inout) :: frd
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields        !< committed
    type(increment_record_type), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    logical :: shown(N_FRD)
    if (frd%unit == 0 .or. record%increment == 0) return
    associate (step => model%steps(record%step))
      if (.not. is_output_due(step, step%file_frequency, record%increment, record%step_time, step%file_times, &
        record%is_step_end)) return
      shown = is_shown(frd, model, step, fields, n_nodal_slaves(model, fields%slaves))
    end associate
    if (.not. any(shown)) return
    frd%n_frames = frd%n_frames + 1
    if (allocated(frd%layered)) then
      call write_fields(frd, model, frd%layered, frd%origin, fields, record, shown)
    else
      call write_fields(frd, model, model%mesh, [integer ::], fields, record, shown)
    end if
    call check_written(frd, error)
  end subroutine write_frd


  !> The blocks of a frame, on a mesh whose nodes have an origin in that of the model; without origins on this one.
  subroutine write_fields(frd, model, mesh, origin, fields, record, shown)
    type(frd_type), intent(inout) :: frd
    type(model_type), intent(in) :: model
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: origin(:)               !< (n_nodes) or empty
    type(fields_type), intent(in) :: fields        !< committed
    type(increment_record_type), intent(in) :: record
    logical, intent(in) :: shown(:)                !< (N_FRD)
    type(frd_request_type) :: request
    type(head_type) :: head
    integer :: i
    do i = 1, N_FRD
      if (.not. shown(i)) cycle
      request = model%steps(record%step)%frd(i)
      frd%present = nodes_of(mesh, absent_elements(model, fields%step))
      if (request%set > 0 .and. .not. frd%is_all) frd%present = nodes_in_set(model%mesh, origin, frd%present, request%set)
      head = HEADS(i)
      if (i == FRD_SDV) head%n = n_state_variables(model, fields)
      if (i == FRD_CONTACT .and. any(model%pairs%is_mortar .and. .not. model%pairs%has_point_contact)) head%kind = KIND_SCALAR
      call write_block(frd, head, mesh%node_label, block_values(model, mesh, origin, fields, i, request%is_local), &
        fields%total_time, record)
    end do
  end subroutine write_fields


  !> The fields of a frame: those requested by cards, or all fields of the job.
  pure function is_shown(frd, model, step, fields, n_slaves)
    type(frd_type), intent(in) :: frd
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: n_slaves                !< slave nodes
    logical :: is_shown(N_FRD)
    is_shown = step%frd%is_wanted
    if (frd%is_all) then
      is_shown = .true.
      is_shown(FRD_NDTEMP) = any(fields%temperature /= 0) .or. step%frd(FRD_NDTEMP)%is_wanted
      is_shown(FRD_MESTRAIN) = is_shown(FRD_NDTEMP) .or. step%frd(FRD_MESTRAIN)%is_wanted
      is_shown(FRD_THSTRAIN) = step%frd(FRD_THSTRAIN)%is_wanted
      is_shown(FRD_PE) = size(fields%history, 1) > 0 .or. step%frd(FRD_PE)%is_wanted
      is_shown(FRD_CELS) = step%frd(FRD_CELS)%is_wanted
    end if
    is_shown(FRD_SDV) = is_shown(FRD_SDV) .and. n_state_variables(model, fields) > 0
    is_shown([FRD_CONTACT, FRD_CELS]) = is_shown([FRD_CONTACT, FRD_CELS]) .and. n_slaves > 0
  end function is_shown


  !> The intersection of some nodes with a set.
  pure function nodes_in_set(mesh, origin, nodes, set) result(chosen)
    type(mesh_type), intent(in) :: mesh            !< of the model
    integer, intent(in) :: origin(:)               !< of the nodes in it; empty: they are its own
    integer, intent(in) :: nodes(:)
    integer, intent(in) :: set                     !< index
    integer, allocatable :: chosen(:)
    logical :: is_in(mesh%n_nodes)
    is_in = .false.
    is_in(mesh%node_sets(set)%members) = .true.
    if (size(origin) > 0) then
      chosen = pack(nodes, is_in(origin(nodes)))
    else
      chosen = pack(nodes, is_in(nodes))
    end if
  end function nodes_in_set


  !> The values of a field at all nodes.
  function block_values(model, mesh, origin, fields, field, is_local) result(values)
    type(model_type), intent(in) :: model
    type(mesh_type), intent(in) :: mesh            !< that is written
    integer, intent(in) :: origin(:)               !< of its nodes in that of the model; empty: they are the same
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: field                   !< FRD_...
    logical, intent(in) :: is_local                !< in the directions of TRANSFORM or ORIENTATION
    real(DP), allocatable :: values(:, :)          !< (components, n_nodes)
    integer :: n_components, n
    n_components = HEADS(field)%n
    if (field == FRD_SDV) n_components = n_state_variables(model, fields)
    n = merge(mesh%n_nodes, model%mesh%n_nodes, has_mean(field))
    allocate (values(n_components, n))
    associate (is_nlgeom => model%steps(max(1, fields%step))%is_nlgeom)
      select case (field)
      case (FRD_DISP)
        values = in_transform(model, fields%u, is_local)
      case (FRD_FORC)
        values = in_transform(model, printed_forces(model, fields, is_field=.true.), is_local)
      case (FRD_NDTEMP)
        values(1, :) = fields%temperature(:model%mesh%n_nodes)
      case (FRD_STRESS)
        call average_tensors(fields%stress, is_nlgeom)
      case (FRD_TOSTRAIN)
        call average_tensors(fields%strain, .false.)
      case (FRD_MESTRAIN)
        call average_tensors(mechanical_strain(model, fields), .false.)
      case (FRD_THSTRAIN)
        call average_tensors(fields%strain - mechanical_strain(model, fields), .false.)
      case (FRD_PE)
        call average_scalars(reshape(equivalent_plastic_strain(model, fields), [1, model%mesh%n_points]))
      case (FRD_ENER)
        call average_scalars(reshape(printed_energy_density(model, fields), [1, model%mesh%n_points]))
      case (FRD_SDV)
        call average_scalars(state_variables(model, fields))
      case (FRD_ERROR)
        call estimate_error(mesh, absent_elements(model, fields%step), fields%stress, values(1, :))
      case (FRD_CONTACT)
        values = contact_values(model, nodal_slaves(model, fields%slaves))
        if (any(fields%slaves%slave_facet > 0)) call fill_point_values(model, fields%slaves, values)
      case (FRD_CELS)
        values(1, :) = contact_energies(model, nodal_slaves(model, fields%slaves))
      end select
    end associate
    if (size(origin) == 0 .or. has_mean(field)) return
    values = values(:, origin)
    if (field == FRD_FORC .or. field == FRD_CELS) values(:, n + 1:) = 0   ! sums count once

  contains

    !> Whether a field is a mean of the elements at a node.
    pure logical function has_mean(field)
      integer, intent(in) :: field                 !< FRD_...
      has_mean = any(field == [FRD_STRESS, FRD_TOSTRAIN, FRD_MESTRAIN, FRD_THSTRAIN, FRD_PE, FRD_ENER, FRD_SDV, FRD_ERROR])
    end function has_mean

    !> Nodal averages, under the calculix dialect as in CalculiX.
    subroutine average_scalars(at_points)
      real(DP), intent(in) :: at_points(:, :)      !< (components, n_points)
      call average_at_nodes(mesh, absent_elements(model, fields%step), at_points, values, &
        model%dialect == DIALECT_CALCULIX)
    end subroutine average_scalars

    !> The same for tensors, without a copy of all points where nothing is turned.
    subroutine average_tensors(at_points, is_current)
      real(DP), intent(in) :: at_points(:, :)      !< (6, n_points) global, but for trusses
      logical, intent(in) :: is_current            !< trusses in the current configuration
      if (has_truss_axes(model)) then
        call average_oriented(rotate_truss_tensors(model, fields, is_current, at_points))
      else
        call average_oriented(at_points)
      end if
    end subroutine average_tensors

    !> The same in the directions of the orientations.
    subroutine average_oriented(at_points)
      real(DP), intent(in) :: at_points(:, :)      !< (6, n_points) global
      if (is_local .and. allocated(fields%frame)) then
        call average_scalars(in_orientation(model%mesh, fields, at_points, is_local))
      else
        call average_scalars(at_points)
      end if
    end subroutine average_oriented

  end function block_values


  !> The energies of the springs of contact at the closed slave nodes, 0 elsewhere.
  pure function contact_energies(model, slaves) result(energy)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP) :: energy(model%mesh%n_nodes)         !< [energy]
    integer :: i
    energy = 0
    do i = 1, size(slaves)
      if (slaves(i)%status == STATUS_OPEN) cycle
      energy(slaves(i)%node) = energy(slaves(i)%node) + printed_contact_energy(model, slaves(i))
    end do
  end function contact_energies


  !> Gap, slip, pressure and shear stress of the closed slave nodes in the axes of the .dat file; 0 elsewhere. Of two
  !! pairs at a node the one with the larger pressure is shown, of two equal ones the later.
  function contact_values(model, slaves) result(values)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP) :: values(6, model%mesh%n_nodes)
    real(DP) :: row(6)
    integer, allocatable :: midside_nodes(:, :)
    integer :: i
    values = 0
    do i = 1, size(slaves)
      if (slaves(i)%status == STATUS_OPEN) cycle
      row = table_row(model, slaves(i))
      if (abs(row(4)) >= (1 - TOL_EQUAL_PRESSURE) * abs(values(4, slaves(i)%node))) values(:, slaves(i)%node) = row
    end do
    call fill_midside_values(model, slaves, 4, 6, values)
    call list_midside_nodes(model, slaves, midside_nodes)
    do i = 1, size(midside_nodes, 2)
      values(:, midside_nodes(1, i)) = 0.5_DP * sum(values(:, midside_nodes(2:3, i)), dim=2)
    end do
  end function contact_values


  !> Gap, two slips, pressure and two shear stresses of a slave in the axes of the .dat file.
  pure function table_row(model, slave) result(row)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slave
    real(DP) :: row(6), axes(3, 3)
    axes = contact_axes(slave%normal)
    row(:3) = matmul(printed_slip(model, slave), axes)
    row(1) = slave%gap
    row(4:) = matmul(slave%force - slave%shear, axes)
    if (slave%area > 0) row(4:) = row(4:) / slave%area
  end function table_row


  !> Nodal values of pairs with integration points, as in CalculiX (found by experiment,
  !! verify/cases/contact/test_contact_integration_points.py): each face fits the values at its closed points (least squares) by
  !! the shape functions of its corners, limited to the range of these values; the mean of the corners at a mid-side node; the mean
  !! over the faces with closed points at a node.
  subroutine fill_point_values(model, slaves, values)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)      !< points in the order of facets and pairs
    real(DP), intent(inout) :: values(:, :)        !< (6, n_nodes) of nodes with points they are set anew
    integer :: counts(model%mesh%n_nodes), first, last, n
    counts = 0
    first = findloc(slaves%slave_facet > 0, .true., dim=1)
    do while (first <= size(slaves))
      last = first
      do while (last < size(slaves))
        if (slaves(last + 1)%slave_facet /= slaves(first)%slave_facet .or. slaves(last + 1)%pair /= slaves(first)%pair) exit
        last = last + 1
      end do
      if (any(slaves(first:last)%status /= STATUS_OPEN)) call add_face_values(model, pack(slaves(first:last), &
        slaves(first:last)%status /= STATUS_OPEN), counts, values)
      first = last + 1
    end do
    do n = 1, size(counts)
      if (counts(n) > 0) values(:, n) = values(:, n) / real(counts(n), DP)
    end do
  end subroutine fill_point_values


  !> Adds the contribution of the closed points of one face to its nodes.
  subroutine add_face_values(model, points, counts, values)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: points(:)
    integer, intent(inout) :: counts(:)            !< (n_nodes) contributing faces
    real(DP), intent(inout) :: values(:, :)        !< (6, n_nodes) sums
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    real(DP) :: rows(6, size(points)), basis(MAX_FACE_NODES, size(points)), at_corner(MAX_FACE_NODES, 6), row(6)
    real(DP) :: dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer, parameter :: LINEAR(2:4) = [FACET_LINE2, FACET_TRI3, FACET_QUAD4]
    integer :: nodes(MAX_FACE_NODES), i, m
    associate (faces => model%surfaces(model%pairs(points(1)%pair)%slave), mesh => model%mesh, side => points(1)%slave_facet)
      kind = element_kind(mesh%kind(faces%element(side)))
      shape = facet_kind(kind%face_kind(faces%face(side)))
      nodes(:shape%n_nodes) = mesh%nodes(mesh%first(faces%element(side)) - 1 + kind%face_nodes(:shape%n_nodes, faces%face(side)))
    end associate
    m = shape%n_corners
    do i = 1, size(points)
      rows(:, i) = table_row(model, points(i))
      call facet_shapes(LINEAR(m), points(i)%at, basis(:, i), dN, ddN)
    end do
    at_corner(:m, :) = fit_at_corners(basis(:m, :), rows)
    at_corner(:m, :) = min(max(at_corner(:m, :), spread(minval(rows, dim=2), 1, m)), spread(maxval(rows, dim=2), 1, m))
    do i = 1, shape%n_nodes
      if (i <= m) row = at_corner(i, :)
      if (i > m) row = 0.5_DP * (at_corner(i - m, :) + at_corner(mod(i - m, m) + 1, :))
      if (counts(nodes(i)) == 0) values(:, nodes(i)) = 0.0_DP
      values(:, nodes(i)) = values(:, nodes(i)) + row
      counts(nodes(i)) = counts(nodes(i)) + 1
    end do
  end subroutine add_face_values


  !> Values at the corners of a face by a least-squares fit to those at points; with too few points the fit nearest to their mean.
  function fit_at_corners(basis, rows) result(at_corner)
    real(DP), intent(in) :: basis(:, :)            !< (m, n) functions of the corners at the points [-]
    real(DP), intent(in) :: rows(:, :)             !< (6, n)
    real(DP) :: at_corner(size(basis, 1), 6), mean
    real(DP), parameter :: RANK_LIMIT = 1.0e-6_DP  ! part of the largest singular value
    integer :: k, rank, status
    do k = 1, 6
      mean = sum(rows(k, :)) / real(size(rows, 2), DP)
      call least_squares(transpose(basis), rows(k, :) - mean, RANK_LIMIT, at_corner(:, k), rank, status)
      at_corner(:, k) = at_corner(:, k) + mean
    end do
  end function fit_at_corners


  !> A time with as many digits as fit into twelve characters.
  pure function time_text(time) result(text)
    real(DP), intent(in) :: time                   !< [time]
    character(12) :: text
    integer :: digits
    digits = 9
    if (time >= 10.0_DP) digits = 9 - floor(log10(time))
    if (time < 1.0e-3_DP .or. digits < 4) then
      write (text, '(1p,e12.5)') time
    else
      write (text, '(f12.' // achar(iachar('0') + digits) // ')') time
    end if
  end function time_text


  !> One block: its number, time, head lines, and a row per node.
  subroutine write_block(frd, head, labels, values, time, record)
    type(frd_type), intent(inout) :: frd
    type(head_type), intent(in) :: head
    integer, intent(in) :: labels(:)               !< (n_nodes)
    real(DP), intent(in) :: values(:, :)           !< (head%n, n_nodes)
    real(DP), intent(in) :: time                   !< total time [time]
    type(increment_record_type), intent(in) :: record
    character(90) :: line
    integer :: i
    frd%n_blocks = frd%n_blocks + 1
    write (line, '(a,i26,2i12)') '    1PSTEP', frd%n_blocks, record%increment, record%step
    call write_line(frd, line)
    write (line, '(a,i5,a,i12,20x,i2,i5,10x,i2)') '  100CL', 100 + frd%n_frames, time_text(time), size(frd%present), 0, &
      frd%n_frames, 1
    call write_line(frd, line)
    write (line, '(a,a8,2i5)') ' -4  ', head%name, head%n + merge(1, 0, head%kind == KIND_VECTOR), 1
    call write_line(frd, line)
    do i = 1, head%n
      if (head%components(1) /= '') then
        write (line, '(a,a8,4i5)') ' -5  ', head%components(i), 1, head%kind, component_position(head, i)
      else
        write (line, '(a,a8,4i5)') ' -5  ', trim(head%name) // to_text(i) // repeat(' ', 8), 1, head%kind, &
          component_position(head, i)
      end if
      call write_line(frd, line)
    end do
    if (head%kind == KIND_VECTOR) call write_line(frd, ' -5  ALL         1    2    0    0    1ALL')
    call put_rows(frd, frd%present, labels, values)
    call write_line(frd, ' -3')
  end subroutine write_block


  !> Row and column of a component in the convention of CGX.
  pure function component_position(head, i) result(row_column)
    type(head_type), intent(in) :: head
    integer, intent(in) :: i                       !< component
    integer :: row_column(2)
    integer, parameter :: ROWS(6) = [1, 2, 3, 1, 2, 3], COLUMNS(6) = [1, 2, 3, 2, 3, 1]
    row_column = 0
    if (head%kind == KIND_VECTOR) row_column(1) = i
    if (head%kind == KIND_TENSOR) row_column = [ROWS(i), COLUMNS(i)]
  end function component_position


  !> A row per written node, many rows at a time.
  subroutine put_rows(frd, nodes, labels, values)
    type(frd_type), intent(inout) :: frd
    integer, intent(in) :: nodes(:)                !< those that are written
    integer, intent(in) :: labels(:)               !< (n_nodes)
    real(DP), intent(in) :: values(:, :)           !< (width, n_nodes)
    integer, parameter :: ROWS_PER_WRITE = 10000
    integer :: i, status
    do i = 1, size(nodes), ROWS_PER_WRITE
      associate (some => nodes(i:min(i + ROWS_PER_WRITE - 1, size(nodes))))
        if (size(values, 1) > FRD_VALUES_PER_LINE) then
          call put_long_rows(frd, some, labels, values)
          cycle
        end if
        write (frd%unit, '(a)', iostat=status) format_value_rows(labels(some), values(:, some))
      end associate
      if (frd%status == 0) frd%status = status
    end do
  end subroutine put_rows


  !> A row per node with continuation lines.
  subroutine put_long_rows(frd, nodes, labels, values)
    type(frd_type), intent(inout) :: frd
    integer, intent(in) :: nodes(:)
    integer, intent(in) :: labels(:)               !< (n_nodes)
    real(DP), intent(in) :: values(:, :)           !< (width, n_nodes)
    character(90) :: line
    character(:), allocatable :: text
    integer :: i, j
    do i = 1, size(nodes)
      write (line, '(a,i10)') ' -1', labels(nodes(i))
      text = format_value_rows([1], values(:, nodes(i:i)))
      text = text(14:)
      do j = 1, len(text), 12 * FRD_VALUES_PER_LINE
        call write_line(frd, line(:13) // text(j:min(j + 12 * FRD_VALUES_PER_LINE - 1, len(text))))
        line = ' -2'
      end do
    end do
  end subroutine put_long_rows


  !> Writes a line; stores the first error status.
  subroutine write_line(frd, line)
    type(frd_type), intent(inout) :: frd
    character(*), intent(in) :: line
    integer :: status
    write (frd%unit, '(a)', iostat=status) trim(line)
    if (frd%status == 0) frd%status = status
  end subroutine write_line


  !> Length and contents of the file, for the checkpoint.
  subroutine frd_file_counts(frd, counts)
    type(frd_type), intent(inout) :: frd
    integer(I64), intent(out) :: counts(3)         !< bytes, frames, blocks; 0 if not open
    integer :: status
    counts = 0
    if (frd%unit == 0) return
    flush (frd%unit, iostat=status)
    if (frd%status == 0) frd%status = status
    inquire (unit=frd%unit, size=counts(1))
    counts(2:) = int([frd%n_frames, frd%n_blocks], I64)
  end subroutine frd_file_counts


  !> Synchronizes the file with the disk.
  subroutine sync_frd(frd, error)
    type(frd_type), intent(in) :: frd
    type(error_type), allocatable, intent(out) :: error
    call check_written(frd, error)
    if (.not. allocated(error) .and. frd%unit /= 0) call sync_file(frd%path, error)
  end subroutine sync_frd


  !> Writes the end mark and closes the file; no effect if it is not open.
  subroutine close_frd(frd, error)
    type(frd_type), intent(inout) :: frd
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    if (frd%unit == 0) return
    call write_line(frd, ' 9999')
    close (frd%unit, iostat=status)
    if (frd%status == 0) frd%status = status
    frd%unit = 0
    call check_written(frd, error)
  end subroutine close_frd


  !> Sets an error if a line could not be written.
  subroutine check_written(frd, error)
    type(frd_type), intent(in) :: frd
    type(error_type), allocatable, intent(out) :: error
    if (frd%status /= 0) call set_error(error, EXIT_IO, 'Cannot write the file ' // frd%path // ' (is the disk full?).')
  end subroutine check_written

end module amontons_frd_output
