!> Unit test of frd_output: mesh block, frames on request, local axes, contact at nodes, continuation after a checkpoint, errors.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_frd_output
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_frd_output, only: frd_type, open_frd, write_frd_mesh, resume_frd, write_frd, frd_file_counts, sync_frd, close_frd
  use amontons_iteration_records, only: increment_record_type
  use amontons_kinds, only: DP, I64
  use amontons_mesh, only: finalize_mesh, mesh_type, set_type
  use amontons_model, only: model_type, job_options_type, DIALECT_CALCULIX
  use amontons_shape_functions, only: node_coordinates
  use amontons_state, only: fields_type, STATUS_OPEN, STATUS_SLIP, STATUS_STICK
  use amontons_steps, only: FRD_DISP, FRD_STRESS, FRD_CONTACT, FRD_FORC
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_ELEMENT_NODES, N_SOLID_KINDS, KIND_C3D20
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(model_type) :: model
  type(job_options_type) :: options
  character(120), allocatable :: lines(:)
  options%job = 'test_frd_output'
  options%outdir = ''
  call make_model(model)
  model%dialect = DIALECT_CALCULIX
  call check_unwanted()
  call check_mesh()
  call check_frames()
  call check_requests()
  call check_contact()
  call check_resume()
  call check_errors()
  call suite%finish()

contains

  include 'sample_job.inc'

  !> Writes frames of step 1, increments 1 to n, into a new file and reads its lines.
  subroutine write_job(n)
    integer, intent(in) :: n
    type(frd_type) :: frd
    type(fields_type) :: fields
    type(error_type), allocatable :: error
    integer :: i
    call open_frd(frd, model, options, error)
    call write_frd_mesh(frd, model, error)
    call suite%that('opened', .not. allocated(error))
    do i = 1, n
      call make_fields(model, i, fields)
      fields%step = 1
      call write_frd(frd, model, fields, make_record(1, i, 1, .true.), error)
      call suite%that('written', .not. allocated(error))
    end do
    call close_frd(frd, error)
    call suite%that('closed', .not. allocated(error))
    call read_lines()
  end subroutine write_job


  !> The lines of the file.
  subroutine read_lines()
    character(120) :: line
    integer :: unit, status
    lines = [character(120) ::]
    open (newunit=unit, file='test_frd_output.frd', status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      lines = [character(120) :: lines, line]
    end do
    close (unit)
  end subroutine read_lines


  !> The first line that begins with a text, after another line; 0: none.
  integer function find_line(text, after) result(i)
    character(*), intent(in) :: text
    integer, intent(in), optional :: after
    integer :: first
    first = 0
    if (present(after)) first = after
    do i = first + 1, size(lines)
      if (index(lines(i), text) == 1) return
    end do
    i = 0
  end function find_line


  !> The values of a node in the block that begins at a line: twelve columns each.
  function values_of(block, label, n) result(values)
    integer, intent(in) :: block, label, n
    real(DP) :: values(n)
    character(13) :: head
    integer :: i, status
    values = huge(1.0_DP)
    write (head, '(a,i10)') ' -1', label
    i = find_line(head, block)
    if (i == 0) return
    read (lines(i) (14:), '(6e12.5)', iostat=status) values
    if (status /= 0) values = huge(1.0_DP)
  end function values_of


  !> No file without a request, in the abaqus dialect not even with one.
  subroutine check_unwanted()
    integer :: unit
    open (newunit=unit, file='test_frd_output.frd')
    close (unit, status='delete')
    call write_job(1)
    call suite%that('no file', size(lines) == 0)
    model%dialect = DIALECT_CALCULIX - 1
    model%steps(1)%frd(FRD_DISP)%is_wanted = .true.
    call write_job(1)
    call suite%that('not in the abaqus dialect', size(lines) == 0)
    model%dialect = DIALECT_CALCULIX
  end subroutine check_unwanted


  !> Nodes and elements with their numbers; the upright edges of a brick of 20 nodes come before those of the top.
  subroutine check_mesh()
    integer :: i, e, first, numbers(10)
    call write_job(0)
    i = find_line('    2C')
    call suite%that('nodes', i > 0)
    read (lines(i) (25:36), *) numbers(1)
    call suite%that('all nodes', numbers(1) == model%mesh%n_nodes)
    call suite%near('a place', maxval(abs(values_of(i, 90, 3) - model%mesh%coordinates(:, 9))), 0.0_DP, 1.0e-4_DP)
    i = find_line('    3C')
    read (lines(i) (25:36), *) numbers(1)
    call suite%that('all elements', numbers(1) == model%mesh%n_elements)
    e = findloc(model%mesh%kind, KIND_C3D20, dim=1)
    first = model%mesh%first(e)
    do i = i + 1, size(lines)
      if (lines(i) (:3) /= ' -1') cycle
      read (lines(i) (4:), *) numbers(:2)
      if (numbers(1) == model%mesh%element_label(e)) exit
    end do
    call suite%that('type of CGX', numbers(2) == 4)
    read (lines(i + 1) (4:), *) numbers
    call suite%that('corners first', all(numbers == model%mesh%node_label(model%mesh%nodes(first:first + 9))))
    read (lines(i + 2) (4:), *) numbers
    call suite%that('then the bottom, the upright edges, the top', &
      all(numbers == model%mesh%node_label(model%mesh%nodes(first - 1 + &
      [11, 12, 17, 18, 19, 20, 13, 14, 15, 16]))))
    call suite%that('end', lines(size(lines)) == ' 9999')
  end subroutine check_mesh


  !> Each increment is a frame with its number and time; the same job gives the same file.
  subroutine check_frames()
    integer :: i, k, numbers(4)
    character(120), allocatable :: before(:)
    call write_job(2)
    i = find_line('  100CL  101')
    k = find_line('  100CL  102')
    call suite%that('two frames', i > 0 .and. k > i .and. find_line('  100CL  103') == 0)
    call suite%that('time', index(lines(i), ' 0.500000000') > 0 .and. index(lines(k), ' 1.000000000') > 0)
    call suite%that('head of the block', lines(k + 1) == ' -4  DISP        4    1')
    read (lines(k - 1) (11:), *) numbers(:3)
    call suite%that('block 2, increment 2, step 1', all(numbers(:3) == [2, 2, 1]))
    call suite%near('displacement of frame 2', maxval(abs(values_of(k, 50, 3) - 2 * model%mesh%coordinates(:, 5))), 0.0_DP, &
      1.0e-4_DP)
    before = lines
    call write_job(2)
    call suite%that('the same file again', size(lines) == size(before) .and. all(lines == before))
    model%steps(1)%file_frequency = 2
    model%steps(1)%period = 10
    call write_job(2)
    call suite%that('every second increment', find_line('  100CL  101') > 0 .and. find_line('  100CL  102') == 0)
    model%steps(1)%file_frequency = 1
  end subroutine check_frames


  !> Local axes, the nodes of a set, removed elements, all fields by --frd.
  subroutine check_requests()
    integer :: i
    allocate (model%frame_of(model%mesh%n_nodes), source=0)
    model%frame_of(5) = 1
    model%frames = reshape([0.0_DP, 1.0_DP, 0.0_DP, -1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3, 1])
    model%steps(1)%frd(FRD_DISP)%is_local = .true.
    model%steps(1)%frd(FRD_DISP)%set = 1
    model%steps(1)%frd(FRD_STRESS)%is_wanted = .true.
    call write_job(1)
    i = find_line(' -4  DISP')
    associate (x => model%mesh%coordinates(:, 5))
      call suite%near('local', maxval(abs(values_of(i, 50, 3) - [x(2), -x(1), x(3)])), 0.0_DP, 1.0e-4_DP)
    end associate
    call suite%that('two nodes of the set', find_line(' -3', i) - find_line(' -5  ALL', i) == 3)
    i = find_line(' -4  STRESS')
    call suite%that('all nodes of the other field', find_line(' -3', i) - i - 7 == model%mesh%n_nodes)
    call suite%near('stress, xx yy zz xy yz zx', maxval(abs(values_of(i, 90, 6) - [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, &
      6.0_DP])), &
      0.0_DP, 1.0e-4_DP)
    call suite%that('place of a component', find_line(' -5  SYZ         1    4    2    3', i) > 0)
    allocate (model%steps(1)%is_inactive(model%mesh%n_elements), source=.false.)
    model%steps(1)%is_inactive(1) = .true.
    call write_job(1)
    i = find_line(' -4  STRESS')
    call suite%that('without the four nodes of a removed tetrahedron', find_line(' -3', i) - i - 7 == model%mesh%n_nodes - 4)
    deallocate (model%steps(1)%is_inactive, model%frame_of)
    model%steps(1)%frd(FRD_DISP)%set = 0
    model%steps(1)%frd(FRD_DISP)%is_local = .false.
    options%has_frd = .true.
    call write_job(1)
    call suite%that('all fields', find_line(' -4  FORC') > 0 .and. find_line(' -4  TOSTRAIN') > 0 .and. &
      find_line(' -4  ERROR') > 0 &
      .and. find_line(' -4  CONTACT') > 0)
    call suite%that('temperatures that are not zero', find_line(' -4  NDTEMP') > 0)
    call suite%that('no plastic strain of an elastic job', find_line(' -4  PE ') == 0)
    options%has_frd = .false.
  end subroutine check_requests


  !> Gap, slip, pressure and shear at closed nodes: force (0 0 10), shear (-3 0 0), area 2.
  subroutine check_contact()
    integer :: i
    model%steps(1)%frd%is_wanted = .false.
    model%steps(1)%frd(FRD_CONTACT)%is_wanted = .true.
    call write_job(1)
    i = find_line(' -4  CONTACT')
    call suite%near('slipping', maxval(abs(values_of(i, 10, 6) - [0.0_DP, 0.01_DP, 0.0_DP, 5.0_DP, 1.5_DP, 0.0_DP])), 0.0_DP, &
      1.0e-5_DP)
    call suite%near('sticking', maxval(abs(values_of(i, 20, 6) - [0.0_DP, 0.0_DP, 0.0_DP, 2.0_DP, 0.0_DP, -0.5_DP])), 0.0_DP, &
      1.0e-5_DP)
    call suite%near('open', maxval(abs(values_of(i, 30, 6))), 0.0_DP, 0.0_DP)
  end subroutine check_contact


  !> A job that was resumed gives the file of the job that was not interrupted.
  subroutine check_resume()
    type(frd_type) :: frd, other
    type(fields_type) :: fields
    type(error_type), allocatable :: error
    character(120), allocatable :: whole(:)
    integer(I64) :: counts(3)
    model%steps(1)%frd(FRD_FORC)%is_wanted = .true.
    call write_job(2)
    whole = lines
    call open_frd(frd, model, options, error)
    call write_frd_mesh(frd, model, error)
    call make_fields(model, 1, fields)
    fields%step = 1
    call write_frd(frd, model, fields, make_record(1, 1, 1, .true.), error)
    call frd_file_counts(frd, counts)
    call sync_frd(frd, error)
    call suite%that('one frame, two blocks', .not. allocated(error) .and. counts(1) > 0 .and. counts(2) == 1 .and. counts(3) == 2)
    call write_frd(frd, model, fields, make_record(1, 2, 1, .true.), error)   ! lost
    call close_frd(frd, error)
    call resume_frd(other, model, options, counts, error)
    call suite%that('resumed', .not. allocated(error))
    call make_fields(model, 2, fields)
    fields%step = 1
    call write_frd(other, model, fields, make_record(1, 2, 1, .true.), error)
    call close_frd(other, error)
    call read_lines()
    call suite%that('the same file', size(lines) == size(whole) .and. all(lines == whole))
    call close_frd(other, error)
    call suite%that('closing twice', .not. allocated(error))
    call frd_file_counts(other, counts)
    call suite%that('no counts of a closed file', all(counts == 0))
  end subroutine check_resume


  !> A folder that does not exist; increment 0 writes nothing.
  subroutine check_errors()
    type(frd_type) :: frd
    type(fields_type) :: fields
    type(error_type), allocatable :: error
    type(job_options_type) :: nowhere
    integer(I64) :: counts(3)
    nowhere = options
    nowhere%outdir = 'no/such/folder'
    call open_frd(frd, model, nowhere, error)
    call suite%that('no folder', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_IO .and. index(error%message, 'no/such/folder') > 0)
    call open_frd(frd, model, options, error)
    call write_frd_mesh(frd, model, error)
    call make_fields(model, 1, fields)
    call write_frd(frd, model, fields, make_record(1, 0, 1, .true.), error)
    call frd_file_counts(frd, counts)
    call suite%that('no frame of increment 0', counts(2) == 0)
    call close_frd(frd, error)
  end subroutine check_errors

end program test_frd_output
