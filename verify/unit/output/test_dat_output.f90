!> Unit test of dat_output: local axes, the forces of both dialects, totals, current places, removed elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_dat_output
  use amontons_kinds, only: DP
  use amontons_dat_output, only: print_request, printed_forces, in_transform, in_orientation
  use amontons_iteration_records, only: increment_record_type
  use amontons_mesh, only: finalize_mesh, mesh_type, set_type
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_shape_functions, only: node_coordinates
  use amontons_state, only: fields_type, STATUS_OPEN, STATUS_SLIP, STATUS_STICK
  use amontons_steps, only: print_request_type, PRINT_NODE, PRINT_ELEMENT
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_ELEMENT_NODES, N_SOLID_KINDS, KIND_C3D4, KIND_COH2D4
  use check, only: suite_type
  implicit none
  real(DP), parameter :: QUARTER(3, 3) = reshape([0.0_DP, 1.0_DP, 0.0_DP, -1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
  type(suite_type) :: suite
  type(model_type) :: model
  type(fields_type) :: fields
  type(increment_record_type) :: record
  integer :: unit
  record = make_record(1, 1, 1, .true.)
  call check_axes()
  call check_forces()
  call check_node_tables()
  call check_point_tables()
  call check_element_tables()
  call suite%finish()

contains

  include 'sample_job.inc'

  !> Vectors in the axes of TRANSFORM, tensors in those of an orientation: local x is global y.
  subroutine check_axes()
    real(DP) :: v(3, 2), t(6, 2)
    type(mesh_type) :: mesh
    mesh%n_elements = 2
    mesh%kind = [KIND_C3D4, KIND_COH2D4]
    mesh%point_first = [1, 2, 3]
    model%frame_of = [1, 0]
    model%frames = reshape(QUARTER, [3, 3, 1])
    v = in_transform(model, reshape([1.0_DP, 2.0_DP, 3.0_DP, 1.0_DP, 2.0_DP, 3.0_DP], [3, 2]), .true.)
    call suite%near('vector', maxval(abs(v(:, 1) - [2.0_DP, -1.0_DP, 3.0_DP])), 0.0_DP, 0.0_DP)
    call suite%near('a node without axes', maxval(abs(v(:, 2) - [1.0_DP, 2.0_DP, 3.0_DP])), 0.0_DP, 0.0_DP)
    v = in_transform(model, reshape([1.0_DP, 2.0_DP, 3.0_DP, 1.0_DP, 2.0_DP, 3.0_DP], [3, 2]), .false.)
    call suite%near('global', maxval(abs(v(:, 1) - [1.0_DP, 2.0_DP, 3.0_DP])), 0.0_DP, 0.0_DP)
    t = in_orientation(mesh, fields, spread([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP], 2, 2), .true.)
    call suite%near('without axes', t(1, 1), 1.0_DP, 0.0_DP)
    allocate (fields%frame(3, 3, 2))
    fields%frame = spread(QUARTER, 3, 2)
    t = in_orientation(mesh, fields, spread([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP], 2, 2), .true.)
    ! xx' = yy, xy' = -xy, yz' = -xz, xz' = yz
    call suite%near('tensor of a cohesive element', maxval(abs(t(:, 2) - [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP])), &
      0.0_DP, 0.0_DP)
    call suite%near('tensor', maxval(abs(t(:, 1) - [2.0_DP, 1.0_DP, 3.0_DP, -4.0_DP, -6.0_DP, 5.0_DP])), 0.0_DP, 0.0_DP)
    t = in_orientation(mesh, fields, spread([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP], 2, 2), .false.)
    call suite%near('global tensor', t(1, 1), 1.0_DP, 0.0_DP)
  end subroutine check_axes


  !> Reactions, or in CalculiX internal forces less those of contact springs; mortar forces count in fields only.
  subroutine check_forces()
    real(DP), allocatable :: force(:, :)
    call make_model(model)
    call make_fields(model, 1, fields)
    fields%contact_force = 0.5_DP
    fields%applied_force = 0.25_DP
    force = printed_forces(model, fields)
    call suite%near('reactions', maxval(abs(force - 2)), 0.0_DP, 0.0_DP)
    model%dialect = DIALECT_CALCULIX
    force = printed_forces(model, fields)
    call suite%near('internal forces less contact', maxval(abs(force - 2.5_DP)), 0.0_DP, 0.0_DP)
    model%pairs%is_mortar = .true.
    force = printed_forces(model, fields)
    call suite%near('without that of mortar pairs', maxval(abs(force - 3)), 0.0_DP, 0.0_DP)
    force = printed_forces(model, fields, is_field=.true.)
    call suite%near('with it in fields', maxval(abs(force - 2.5_DP)), 0.0_DP, 0.0_DP)
    model%mesh%n_nodes = model%mesh%n_nodes + 1
    fields%reaction_force = reshape([fields%reaction_force, [2.0_DP, 2.0_DP, 2.0_DP]], [3, model%mesh%n_nodes])
    fields%applied_force = reshape([fields%applied_force, [1.0_DP, 1.0_DP, 1.0_DP]], [3, model%mesh%n_nodes])
    force = printed_forces(model, fields)
    call suite%near('a reference node: supports and loads', maxval(abs(force(:, model%mesh%n_nodes) - 3)), 0.0_DP, 0.0_DP)
  end subroutine check_forces


  !> Prints a request; its table is read again from the scratch file.
  subroutine print_table(request, is_nlgeom)
    type(print_request_type), intent(in) :: request
    logical, intent(in) :: is_nlgeom
    open (newunit=unit, status='scratch', action='readwrite')
    call print_request(unit, model, fields, request, is_nlgeom)
  end subroutine print_table


  !> The numbers in a line of the table, after some integers.
  subroutine expect(name, line, labels, values)
    character(*), intent(in) :: name
    integer, intent(in) :: line                      !< from 1
    integer, intent(in) :: labels(:)
    real(DP), intent(in) :: values(:)
    integer :: found(size(labels)), i, status
    real(DP) :: numbers(size(values))
    rewind (unit)
    status = 0
    do i = 1, line - 1
      if (status == 0) read (unit, '(a)', iostat=status)
    end do
    found = -1
    if (status == 0) read (unit, *, iostat=status) found, numbers
    call suite%that(name // ': row', status == 0 .and. all(found == labels))
    if (status == 0) call suite%near(name, maxval(abs(numbers - values)), 0.0_DP, 1.0e-6_DP)   ! seven digits are printed
  end subroutine expect


  !> Number of lines of the table that hold text.
  integer function n_lines() result(n)
    character(200) :: line
    integer :: status
    rewind (unit)
    n = 0
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (line /= '') n = n + 1
    end do
    close (unit)
  end function n_lines


  !> The heading of a table.
  logical function has_title(title)
    character(*), intent(in) :: title
    character(200) :: line
    rewind (unit)
    read (unit, '(/a)') line
    has_title = index(line, ' ' // title // ' for set ') == 1
  end function has_title


  !> U, RF in local axes with a global total, NT, COORD under NLGEOM.
  subroutine check_node_tables()
    type(print_request_type) :: request
    integer :: n
    call make_model(model)
    call make_fields(model, 1, fields)
    n = model%mesh%n_nodes
    request%kind = PRINT_NODE
    request%set = 1                                  ! nodes 9 and 5, with labels 90 and 50
    allocate (model%frame_of(n), source=0)
    model%frame_of(9) = 1
    model%frames = reshape(QUARTER, [3, 3, 1])
    fields%reaction_force = spread([1.0_DP, 2.0_DP, 3.0_DP], 2, n)
    request%variables = [character(4) :: 'RF']
    request%is_local = .true.
    request%is_totals = .true.
    call print_table(request, .false.)
    call suite%that('title', has_title('forces (fx,fy,fz)'))
    call expect('local', 4, [90], [2.0_DP, -1.0_DP, 3.0_DP])
    call expect('global', 5, [50], [1.0_DP, 2.0_DP, 3.0_DP])
    call expect('the sum is global', 9, [integer ::], [2.0_DP, 4.0_DP, 6.0_DP])
    call suite%that('five lines', n_lines() == 5)
    request%variables = [character(4) :: 'COOR']
    call print_table(request, .false.)
    call expect('reference', 4, [90], model%mesh%coordinates(:, 9))
    close (unit)
    call print_table(request, .true.)
    call expect('current', 4, [90], 2 * model%mesh%coordinates(:, 9))
    close (unit)
    fields%temperature(5) = 7.0_DP
    request%variables = [character(4) :: 'NT']
    call print_table(request, .true.)
    call expect('temperature', 5, [50], [7.0_DP])
    close (unit)
    request%set = 0
    call print_table(request, .true.)
    call suite%that('all nodes', n_lines() == n + 1)
  end subroutine check_node_tables


  !> Points of a set: tensors in the order of CalculiX, only elements that are there, variables that the job has.
  subroutine check_point_tables()
    type(print_request_type) :: request
    integer :: n
    call make_model(model)
    call make_fields(model, 1, fields)
    fields%step = 1
    request%kind = PRINT_ELEMENT
    request%set = 1                                  ! two tetrahedra of one point each, 101 and 102
    request%variables = [character(4) :: 'S']
    call print_table(request, .false.)
    call expect('stress', 5, [102, 1], [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 6.0_DP, 5.0_DP])
    close (unit)
    allocate (model%steps(1)%is_inactive(model%mesh%n_elements), source=.false.)
    model%steps(1)%is_inactive(1) = .true.
    call print_table(request, .false.)
    call expect('the one that is there', 4, [102, 1], [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 6.0_DP, 5.0_DP])
    call suite%that('no other', n_lines() == 2)
    request%variables = [character(4) :: 'SDV']
    call print_table(request, .false.)
    call suite%that('no state variables: no table', n_lines() == 0)
    request%variables = [character(4) :: 'PEEQ']
    call print_table(request, .false.)
    call suite%that('PEEQ of an elastic job', n_lines() == 2)
    model%dialect = DIALECT_CALCULIX
    call print_table(request, .false.)
    call suite%that('no such table in CalculiX', n_lines() == 0)
    n = model%mesh%n_points
    allocate (fields%frame(3, 3, n))
    fields%frame = spread(QUARTER, 3, n)
    request%variables = [character(4) :: 'S']
    request%is_local = .true.
    call print_table(request, .false.)
    call expect('in local axes', 4, [102, 1], [2.0_DP, 1.0_DP, 3.0_DP, -4.0_DP, 5.0_DP, -6.0_DP])
    close (unit)
  end subroutine check_point_tables


  !> Integrals over elements: volume and energy, rows and totals.
  subroutine check_element_tables()
    type(print_request_type) :: request
    call make_model(model)
    call make_fields(model, 3, fields)
    request%kind = PRINT_ELEMENT
    request%set = 1
    request%is_totals = .true.
    request%variables = [character(4) :: 'EVOL']
    call print_table(request, .false.)
    call expect('volume of the parent tetrahedron', 4, [101], [1 / 6.0_DP])
    call expect('of both', 9, [integer ::], [1 / 3.0_DP])
    close (unit)
    request%is_totals = .false.
    request%is_only_totals = .true.
    request%variables = [character(4) :: 'ELSE']
    call print_table(request, .false.)
    call expect('energy density 3', 4, [integer ::], [1.0_DP])
    call suite%that('no rows', n_lines() == 2)
  end subroutine check_element_tables

end program test_dat_output
