!> Unit test of dat_contact_output: tangents, names of blocks, rows and statistics of pairs, sums over a section.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_dat_contact_output
  use amontons_kinds, only: DP
  use amontons_dat_contact_output, only: print_contact_variable, print_section_sums, block_name, contact_axes
  use amontons_iteration_records, only: increment_record_type
  use amontons_mesh, only: finalize_mesh, mesh_type, set_type
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_shape_functions, only: node_coordinates
  use amontons_state, only: fields_type, STATUS_OPEN, STATUS_SLIP, STATUS_STICK
  use amontons_steps, only: print_request_type
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_ELEMENT_NODES, N_SOLID_KINDS
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(model_type) :: model
  type(fields_type) :: fields
  type(increment_record_type) :: record
  character(200), allocatable :: lines(:)
  record = make_record(1, 1, 1, .true.)
  call check_axes()
  call check_names()
  call check_rows()
  call check_choice()
  call check_points()
  call check_statistics()
  call check_section()
  call suite%finish()

contains

  include 'sample_job.inc'

  !> Right-handed and orthonormal; the first tangent is x projected, z where the normal is along x.
  subroutine check_axes()
    real(DP) :: axes(3, 3)
    axes = contact_axes([0.0_DP, 0.0_DP, 1.0_DP])
    call suite%near('up', maxval(abs(axes - reshape([0.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP], &
      [3, 3]))), 0.0_DP, 0.0_DP)
    axes = contact_axes([-1.0_DP, 0.0_DP, 0.0_DP])
    call suite%near('along x', maxval(abs(axes(:, 2) - [0.0_DP, 0.0_DP, 1.0_DP])), 0.0_DP, 0.0_DP)
    call suite%near('n x t1', maxval(abs(axes(:, 3) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
    axes = contact_axes([0.6_DP, 0.0_DP, 0.8_DP])
    call suite%near('inclined', maxval(abs(axes(:, 2) - [0.8_DP, 0.0_DP, -0.6_DP])), 0.0_DP, 1.0e-15_DP)
    call suite%near('orthonormal', maxval(abs(matmul(transpose(axes), axes) - reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, &
      0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3]))), 0.0_DP, 1.0e-15_DP)
  end subroutine check_axes


  !> Sums of Abaqus stand in three blocks.
  subroutine check_names()
    call suite%that('pressure', all(block_name([character(4) :: 'CFN', 'CMN', 'XN']) == 'CFN'))
    call suite%that('friction', all(block_name([character(4) :: 'CFS', 'CMS', 'XS']) == 'CFS'))
    call suite%that('both', all(block_name([character(4) :: 'CF', 'CFT', 'CMT', 'XT', 'CARE']) == 'CF'))
    call suite%that('others', block_name('CSTR') == 'CSTR' .and. block_name('CNUM') == 'CNUM')
  end subroutine check_names


  !> Prints one variable of a request; the lines that are not blank.
  subroutine print_variable(request, variable)
    type(print_request_type), intent(in) :: request
    character(*), intent(in) :: variable
    integer :: unit
    open (newunit=unit, status='scratch', action='readwrite')
    call print_contact_variable(unit, model, fields, request, variable)
    call gather(unit)
  end subroutine print_variable


  !> The lines of a scratch file that are not blank.
  subroutine gather(unit)
    integer, intent(in) :: unit
    character(200) :: line
    integer :: status
    rewind (unit)
    lines = [character(200) ::]
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (line /= '') lines = [character(200) :: lines, line]
    end do
    close (unit)
  end subroutine gather


  !> The numbers of a line.
  subroutine expect(name, i, values)
    character(*), intent(in) :: name
    integer, intent(in) :: i                         !< line that is not blank
    real(DP), intent(in) :: values(:)
    real(DP) :: numbers(size(values))
    integer :: status
    status = 1
    if (i <= size(lines)) read (lines(i), *, iostat=status) numbers
    call suite%that(name // ': numbers', status == 0)
    if (status == 0) call suite%near(name, maxval(abs(numbers - values)), 0.0_DP, 2.0e-5_DP)   ! six digits of numbers up to 20
  end subroutine expect


  !> Gap and slip, pressure and shear on the master over the area: forces (0 0 10) and shear (-3 0 0) on an area of 2.
  subroutine check_rows()
    type(print_request_type) :: request
    call make_model(model)
    call make_fields(model, 1, fields)
    call print_variable(request, 'CSTR')
    call suite%that('two closed nodes', size(lines) == 3)
    call expect('slipping', 2, [10.0_DP, 5.0_DP, 1.5_DP, 0.0_DP])
    call expect('sticking', 3, [20.0_DP, 2.0_DP, 0.0_DP, -0.5_DP])
    fields%slaves(1)%gap = -0.125_DP
    call print_variable(request, 'CDIS')
    call expect('gap, slip', 2, [10.0_DP, -0.125_DP, 0.01_DP, 0.0_DP])
    fields%slaves(1)%area = 0
    call print_variable(request, 'CSTR')
    call expect('without an area the forces', 2, [10.0_DP, 10.0_DP, 3.0_DP, 0.0_DP])
    call print_variable(request, 'SCEN')
    call suite%that('those with a status or a scenario', size(lines) == 5)
    call expect('status and scenario', 2, [10.0_DP, 2.0_DP, 3.0_DP])
    call print_variable(request, 'CNUM')
    call expect('two', 2, [2.0_DP])
    request%is_totals = .true.
    call print_variable(request, 'CELS')
    call suite%that('rows and their sum', size(lines) == 5)
  end subroutine check_rows


  !> NSET, SLAVE and MASTER choose nodes and pairs.
  subroutine check_choice()
    type(print_request_type) :: request
    call make_model(model)
    call make_fields(model, 1, fields)
    model%mesh%node_sets(1)%members = [2, 3]
    request%set = 1
    call print_variable(request, 'CSTR')
    call suite%that('of a set', size(lines) == 2)
    call expect('node 2', 2, [20.0_DP, 2.0_DP, 0.0_DP, -0.5_DP])
    request%set = 0
    request%master = 3                               ! pair 2, whose one node is open
    call print_variable(request, 'CNUM')
    call expect('of a master', 2, [0.0_DP])
    request%slave = 2                                ! no pair
    call print_variable(request, 'CF')
    call suite%that('no pair: no statistics', size(lines) == 0)
  end subroutine check_choice


  !> Points of faces have the labels of element and face.
  subroutine check_points()
    type(print_request_type) :: request
    call make_model(model)
    call make_fields(model, 1, fields)
    model%pairs%slave = 2
    fields%slaves(1)%slave_facet = 2                 ! face 1 of element 6
    call print_variable(request, 'CSTR')
    call suite%that('heading', index(lines(1), 'slave element+face') > 0)
    call expect('element and face', 2, [106.0_DP, 1.0_DP, 5.0_DP, 1.5_DP, 0.0_DP])
  end subroutine check_points


  !> Force, moment, centre, area of pressure, friction and both; the centre of force is not in CalculiX's table.
  subroutine check_statistics()
    type(print_request_type) :: request
    integer :: n
    call make_model(model)
    call make_fields(model, 1, fields)
    fields%u = 0
    model%mesh%coordinates(:, 1) = [4.0_DP, 4.0_DP, 0.0_DP]
    model%mesh%coordinates(:, 2) = [5.0_DP, 4.0_DP, 0.0_DP]
    request%master = 2
    call print_variable(request, 'CFN')
    ! 10 and 4 upward: moments y F and -x F
    call expect('pressure', 3, [0.0_DP, 0.0_DP, 14.0_DP, 56.0_DP, -60.0_DP, 0.0_DP])
    call expect('centre of the area', 5, [4.5_DP, 4.0_DP, 0.0_DP])
    call expect('area, normal and shear force', 9, [4.0_DP, -14.0_DP, 0.0_DP])
    call expect('centre of force', 11, [60.0_DP / 14, 4.0_DP, 0.0_DP])
    call print_variable(request, 'CFS')
    call expect('friction', 3, [-3.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 17.0_DP])
    call expect('shear force', 9, [4.0_DP, 0.0_DP, sqrt(10.0_DP)])
    call print_variable(request, 'CF')
    call expect('both', 3, [-3.0_DP, 1.0_DP, 14.0_DP, 56.0_DP, -60.0_DP, 17.0_DP])
    n = size(lines)
    model%dialect = DIALECT_CALCULIX
    call print_variable(request, 'CF')
    call suite%that('CalculiX has no centre of force', size(lines) == n - 2)
  end subroutine check_statistics


  !> SECTION PRINT over the top of a cube of side 2: 4 times the traction of stress (1 2 3 4 5 6).
  subroutine check_section()
    integer :: unit
    call make_model(model)
    call make_fields(model, 1, fields)
    model%surfaces(2)%element = [5]
    model%surfaces(2)%face = [2]
    fields%u = 0
    open (newunit=unit, status='scratch', action='readwrite')
    call print_section_sums(unit, model, fields, 2, .false.)
    call gather(unit)
    call suite%that('heading', index(lines(1), 'statistics for surface set BRICKS') > 0)
    call check_force(lines(3))
    call expect('area, tension, shear, torque, bending', 9, [4.0_DP, 12.0_DP, 4 * sqrt(61.0_DP), 0.0_DP, 0.0_DP])
  end subroutine check_section


  !> The force: xz, yz and zz times the area.
  subroutine check_force(line)
    character(*), intent(in) :: line
    real(DP) :: numbers(3)
    integer :: status
    read (line, *, iostat=status) numbers
    call suite%that('a row of force', status == 0)
    if (status == 0) call suite%near('force', maxval(abs(numbers - [24.0_DP, 20.0_DP, 12.0_DP])), 0.0_DP, 2.0e-5_DP)
  end subroutine check_force

end program test_dat_contact_output
