!> Text output: .sta, .cvg and .dat line by line in CalculiX's columns.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_text_output
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_ELEMENT_NODES, N_SOLID_KINDS
  use amontons_mesh, only: finalize_mesh, mesh_type, set_type
  use amontons_steps, only: print_request_type, PRINT_CONTACT, PRINT_ELEMENT, PRINT_NODE
  use amontons_model, only: job_options_type, model_type, DIALECT_CALCULIX
  use amontons_iteration_records, only: increment_record_type, iteration_record_type
  use amontons_state, only: fields_type, STATUS_OPEN, STATUS_SLIP, STATUS_STICK
  use amontons_shape_functions, only: node_coordinates
  use amontons_text_output, only: close_text_output, open_text_output, print_fields, print_increment, print_iteration, &
    text_output_type
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite

  call test_sta(suite)
  call test_cvg(suite)
  call test_node_blocks(suite)
  call test_element_blocks(suite)
  call test_contact_blocks(suite)
  call test_frequency(suite)
  call test_no_dat(suite)
  call test_no_folder(suite)
  call suite%finish()

contains

  include 'sample_job.inc'

  !> Converged and failed attempts; the file is complete on disk while it is open.
  subroutine test_sta(suite)
    type(suite_type), intent(inout) :: suite
    type(text_output_type) :: printed
    type(model_type) :: model
    type(error_type), allocatable :: error
    call make_model(model)
    call open_text_output(printed, model, make_options('sta'), error)
    call suite%that('open_printed', .not. allocated(error))
    call print_increment(printed, make_record(1, 1, 1, .false.))
    call print_increment(printed, make_record(2, 12, 2, .true.))
    call expect_line(suite, 'sta.sta', 1, 'SUMMARY OF JOB INFORMATION')
    call expect_line(suite, 'sta.sta', 2, '  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME')
    call expect_line(suite, 'sta.sta', 3, '     1          1     1U    4  0.000000E+00  0.000000E+00  0.500000E+00' // &
      '      3      1      1        1        2        3        4    0     0       0  0.1000E-06  0.0000E+00')
    call expect_line(suite, 'sta.sta', 4, '     2         12     2     4  0.650000E+01  0.600000E+01  0.500000E+00')
    call suite%that('four lines', count_lines('sta.sta') == 4)
    call close_text_output(printed)
    call print_increment(printed, make_record(2, 13, 1, .true.))
    call suite%that('nothing is written after closing', count_lines('sta.sta') == 4)
  end subroutine test_sta


  !> Four head lines, and residual and correction in per cent.
  subroutine test_cvg(suite)
    type(suite_type), intent(inout) :: suite
    type(text_output_type) :: printed
    type(model_type) :: model
    type(iteration_record_type) :: record
    type(error_type), allocatable :: error
    call make_model(model)
    call open_text_output(printed, model, make_options('cvg'), error)
    record = iteration_record_type(step=1, increment=2, attempt=3, iteration=4, n_closed=243, residual=0.007734_DP, &
      correction=1.0_DP, n_status=[5, 6, 7], n_scenario=[1, 2, 3, 4], n_newly_opened=8, n_newly_closed=9, step_length=0.5_DP, &
      n_krylov=11, max_gap_error=-1.0e-9_DP, n_slip_converged=12, n_subproblem_iterations=13)
    call print_iteration(printed, record)
    call expect_line(suite, 'cvg.cvg', 1, 'SUMMARY OF C0NVERGENCE INFORMATION')
    call expect_line(suite, 'cvg.cvg', 2, &
      '  STEP   INC  ATT   ITER     CONT.   RESID.        CORR.      RESID.      CORR.')
    call expect_line(suite, 'cvg.cvg', 3, &
      '                              EL.    FORCE         DISP       FLUX        TEMP.')
    call expect_line(suite, 'cvg.cvg', 4, &
      '                              (#)     (%)           (%)        (%)         (%)')
    call expect_line(suite, 'cvg.cvg', 5, &
      '     1     2     3     4      243  0.7734E+00  0.1000E+03  0.0000E+00  0.0000E+00' // &
      '      5      6      7      1      2      3      4      8      9     11  0.50000E+00 -0.10000E-08     12     13')
    call close_text_output(printed)
  end subroutine test_cvg


  !> U and RF with totals; RF means reactions under abaqus, all external forces under calculix.
  subroutine test_node_blocks(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call make_model(model)
    call add_request(model, PRINT_NODE, 1, [character(4) :: 'U', 'RF'], is_totals=.true.)
    call add_request(model, PRINT_NODE, 1, [character(4) :: 'RF'], is_only_totals=.true.)
    call print_one(suite, model, 'node')
    call expect_line(suite, 'node.dat', 1, '')
    call expect_line(suite, 'node.dat', 2, '                        S T E P       1')
    call expect_line(suite, 'node.dat', 3, '')
    call expect_line(suite, 'node.dat', 4, '')
    call expect_line(suite, 'node.dat', 5, '                                INCREMENT     1')
    call expect_line(suite, 'node.dat', 6, '')
    call expect_line(suite, 'node.dat', 7, '')
    call expect_line(suite, 'node.dat', 8, ' displacements (vx,vy,vz) for set CORNER and time  0.5000000E+00')
    call expect_line(suite, 'node.dat', 9, '')
    call expect_line(suite, 'node.dat', 10, '        90  8.000000E+00  4.000000E+00 -1.000000E+00')
    call expect_line(suite, 'node.dat', 11, '        50  4.000000E+00  8.000000E+00  0.000000E+00')
    call expect_line(suite, 'node.dat', 12, '')
    call expect_line(suite, 'node.dat', 13, ' forces (fx,fy,fz) for set CORNER and time  0.5000000E+00')
    call expect_line(suite, 'node.dat', 15, '        90  2.000000E+00  2.000000E+00  2.000000E+00')
    call expect_line(suite, 'node.dat', 18, ' total force (fx,fy,fz) for set CORNER and time  0.5000000E+00')
    call expect_line(suite, 'node.dat', 20, '        4.000000E+00  4.000000E+00  4.000000E+00')
    call expect_line(suite, 'node.dat', 22, ' total force (fx,fy,fz) for set CORNER and time  0.5000000E+00')
    call suite%that('no rows with TOTALS=ONLY', count_lines('node.dat') == 24)
    model%dialect = DIALECT_CALCULIX
    call print_one(suite, model, 'node')
    call expect_line(suite, 'node.dat', 15, '        90  3.000000E+00  3.000000E+00  3.000000E+00')
  end subroutine test_node_blocks


  !> Points in CalculiX's order xx yy zz xy xz yz, and integrals over elements.
  subroutine test_element_blocks(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call make_model(model)
    call add_request(model, PRINT_ELEMENT, 1, [character(4) :: 'S', 'E', 'ENER', 'ELSE', 'EVOL'], is_totals=.true.)
    call add_request(model, PRINT_ELEMENT, 2, [character(4) :: 'EVOL'], is_only_totals=.true.)
    call print_one(suite, model, 'element')
    call expect_line(suite, 'element.dat', 8, &
      ' stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set TET and time  0.5000000E+00')
    call expect_line(suite, 'element.dat', 10, &
      '       101   1  1.000000E+00  2.000000E+00  3.000000E+00  4.000000E+00  6.000000E+00  5.000000E+00')
    call expect_line(suite, 'element.dat', 13, &
      ' strains (elem, integ.pnt.,exx,eyy,ezz,exy,exz,eyz) for set TET and time  0.5000000E+00')
    call expect_line(suite, 'element.dat', 16, &
      '       102   1  1.000000E-01  2.000000E-01  3.000000E-01  4.000000E-01  6.000000E-01  5.000000E-01')
    call expect_line(suite, 'element.dat', 18, &
      ' internal energy density (elem, integ.pnt.,energy) for set TET and time  0.5000000E+00')
    call expect_line(suite, 'element.dat', 20, '       101   1  1.000000E+00')
    call expect_line(suite, 'element.dat', 23, ' internal energy (element, energy) for set TET and time  0.5000000E+00')
    call expect_line(suite, 'element.dat', 25, '       101  1.666667E-01')
    call expect_line(suite, 'element.dat', 28, ' total internal energy for set TET and time  0.5000000E+00')
    call expect_line(suite, 'element.dat', 30, '        3.333333E-01')
    call expect_line(suite, 'element.dat', 32, ' volume (element, volume) for set TET and time  0.5000000E+00')
    call expect_line(suite, 'element.dat', 37, ' total volume for set TET and time  0.5000000E+00')
    call expect_line(suite, 'element.dat', 41, ' total volume for set BRICK and time  0.5000000E+00')
    call expect_line(suite, 'element.dat', 43, '        8.000000E+00')
    call suite%that('43 lines', count_lines('element.dat') == 43)
  end subroutine test_element_blocks


  !> Closed slave nodes only; the block of scenarios; the statistics of a pair.
  subroutine test_contact_blocks(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call make_model(model)
    call add_request(model, PRINT_CONTACT, 0, [character(4) :: 'CDIS', 'CSTR', 'SCEN', 'CNUM', 'CF'])
    call print_one(suite, model, 'contact')
    call expect_line(suite, 'contact.dat', 8, ' relative contact displacement (slave node,normal,tang1,tang2) ' // &
      'for all contact elements and time 0.5000000E+00')
    call expect_line(suite, 'contact.dat', 10, '        10  0.000000E+00  1.000000E-02  0.000000E+00')
    call expect_line(suite, 'contact.dat', 11, '        20  0.000000E+00  0.000000E+00  0.000000E+00')
    call expect_line(suite, 'contact.dat', 13, ' contact stress (slave node,press,tang1,tang2) ' // &
      'for all contact elements and time 0.5000000E+00')
    ! Pressure 10/2; the slave slips along +x, so the corresponding shear stress is +3/2.
    call expect_line(suite, 'contact.dat', 15, '        10  5.000000E+00  1.500000E+00')
    call expect_line(suite, 'contact.dat', 18, &
      ' slip scenario (slave node,status,scenario) for all contact elements and time 0.5000000E+00')
    call expect_line(suite, 'contact.dat', 20, '        10          2          3')
    call expect_line(suite, 'contact.dat', 21, '        20          1          0')
    call expect_line(suite, 'contact.dat', 22, '        40          0          1')
    call expect_line(suite, 'contact.dat', 25, ' total number of contact elements for time  0.5000000E+00')
    call expect_line(suite, 'contact.dat', 27, '                2')
    call expect_line(suite, 'contact.dat', 30, &
      ' statistics for slave set SLAVENODES, master set BRICKS and time  0.5000000E+00')
    call expect_line(suite, 'contact.dat', 32, &
      '   total surface force (fx,fy,fz) and moment about the origin (mx,my,mz)')
    ! Forces (-3 0 10) and (0 1 4) at 2 (4 4 0) and 2 (5 4 0): the frame has u = X.
    call expect_line(suite, 'contact.dat', 34, &
      '   -3.000000E+00  1.000000E+00  1.400000E+01  1.120000E+02 -1.200000E+02  3.400000E+01')
    call expect_line(suite, 'contact.dat', 36, '   center of gravity and mean normal')
    call expect_line(suite, 'contact.dat', 38, '    9.000000E+00  8.000000E+00  0.000000E+00')
    call expect_line(suite, 'contact.dat', 40, '   moment about the center of gravity(mx,my,mz)')
    call expect_line(suite, 'contact.dat', 44, '   area,  normal force (+ = tension) and shear force (size)')
    call expect_line(suite, 'contact.dat', 46, '    4.000000E+00 -1.400000E+01  3.162278E+00')
    call expect_line(suite, 'contact.dat', 48, '   center of the force')
    ! By their sizes, sqrt(109) and sqrt(17).
    call expect_line(suite, 'contact.dat', 50, '    8.566228E+00  8.000000E+00  0.000000E+00')
    call expect_line(suite, 'contact.dat', 53, ' statistics for slave set SLAVENODES, master set TETS and time')
  end subroutine test_contact_blocks


  !> Only what is due: not increment 0, every second increment, and the last of the step.
  subroutine test_frequency(suite)
    type(suite_type), intent(inout) :: suite
    type(text_output_type) :: printed
    type(model_type) :: model
    type(fields_type) :: fields
    type(error_type), allocatable :: error
    integer, parameter :: LINES(0:5) = [0, 0, 11, 11, 22, 33]
    integer :: increment
    call make_model(model)
    call make_fields(model, 1, fields)
    call add_request(model, PRINT_NODE, 1, [character(4) :: 'U'])
    model%steps(1)%print_frequency = 2
    model%steps(1)%period = 2.5_DP
    call open_text_output(printed, model, make_options('often'), error)
    do increment = 0, 5
      call print_fields(printed, model, fields, make_record(1, increment, 1, .true.), error)
      call suite%that('print_fields', .not. allocated(error))
      call suite%that('lines after increment ' // achar(48 + increment), count_lines('often.dat') == LINES(increment))
    end do
    call print_fields(printed, model, fields, make_record(2, 1, 1, .true.), error)
    call suite%that('a step without PRINT cards prints nothing', count_lines('often.dat') == 33)
    model%steps(1)%print_frequency = 0
    call print_fields(printed, model, fields, make_record(1, 5, 1, .true.), error)
    call suite%that('FREQUENCY=0 prints nothing', count_lines('often.dat') == 33)
    call close_text_output(printed)
  end subroutine test_frequency


  !> Without PRINT cards there is no .dat file.
  subroutine test_no_dat(suite)
    type(suite_type), intent(inout) :: suite
    type(text_output_type) :: printed
    type(model_type) :: model
    type(error_type), allocatable :: error
    logical :: is_there
    call make_model(model)
    call open_text_output(printed, model, make_options('silent'), error)
    call close_text_output(printed)
    inquire (file='silent.dat', exist=is_there)
    call suite%that('no .dat', .not. is_there)
    inquire (file='silent.sta', exist=is_there)
    call suite%that('but .sta', is_there)
  end subroutine test_no_dat


  !> A missing folder is reported with its path.
  subroutine test_no_folder(suite)
    type(suite_type), intent(inout) :: suite
    type(text_output_type) :: printed
    type(model_type) :: model
    type(job_options_type) :: options
    type(error_type), allocatable :: error
    call make_model(model)
    options = make_options('job')
    options%outdir = 'no/such/folder'
    call open_text_output(printed, model, options, error)
    call suite%that('there is an error', allocated(error))
    if (.not. allocated(error)) return
    call suite%that('its code', error%code == EXIT_IO)
    call suite%that(error%message, index(error%message, 'Cannot create the file no/such/folder/job.sta: ') == 1)
  end subroutine test_no_folder


  !> Adds a PRINT card to the first step.
  subroutine add_request(model, kind, set, variables, is_totals, is_only_totals)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: kind, set
    character(4), intent(in) :: variables(:)
    logical, intent(in), optional :: is_totals, is_only_totals
    type(print_request_type), allocatable :: longer(:)
    integer :: n
    n = size(model%steps(1)%prints)
    allocate (longer(n + 1))
    longer(:n) = model%steps(1)%prints
    longer(n + 1)%kind = kind
    longer(n + 1)%set = set
    longer(n + 1)%variables = variables
    if (present(is_totals)) longer(n + 1)%is_totals = is_totals
    if (present(is_only_totals)) longer(n + 1)%is_only_totals = is_only_totals
    call move_alloc(longer, model%steps(1)%prints)
  end subroutine add_request


  !> Prints frame 1 as increment 1 of step 1 into NAME.dat.
  subroutine print_one(suite, model, name)
    type(suite_type), intent(inout) :: suite
    type(model_type), intent(in) :: model
    character(*), intent(in) :: name
    type(text_output_type) :: printed
    type(fields_type) :: fields
    type(error_type), allocatable :: error
    call make_fields(model, 1, fields)
    call open_text_output(printed, model, make_options(name), error)
    call suite%that('open_printed', .not. allocated(error))
    call print_fields(printed, model, fields, make_record(1, 1, 1, .true.), error)
    call suite%that('print_fields', .not. allocated(error))
    call close_text_output(printed)
  end subroutine print_one


  !> A line of a file begins with a text; an empty text means an empty line.
  subroutine expect_line(suite, path, number, text)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: path
    integer, intent(in) :: number                   !< counted from 1
    character(*), intent(in) :: text
    character(300) :: line
    integer :: unit, i, status
    line = ''
    open (newunit=unit, file=path, action='read', status='old')
    do i = 1, number
      read (unit, '(a)', iostat=status) line
      if (status /= 0) line = '(end of the file)'
    end do
    close (unit)
    if (len(text) == 0) then
      call suite%that(path // ' has an empty line, not: ' // trim(line), len_trim(line) == 0)
    else
      call suite%that(path // ' has the line ' // text // ' not: ' // trim(line), index(line, text) == 1)
    end if
  end subroutine expect_line


  function count_lines(path) result(n)
    character(*), intent(in) :: path
    integer :: n, unit, status
    n = -1
    open (newunit=unit, file=path, action='read', status='old')
    status = 0
    do while (status == 0)
      read (unit, '(a)', iostat=status)
      n = n + 1
    end do
    close (unit)
  end function count_lines


  function make_options(job) result(options)
    character(*), intent(in) :: job
    type(job_options_type) :: options
    options%job = job
    options%outdir = ''
  end function make_options

end program test_text_output
