!> Result file: writes job.vtkhdf and others into the working folder, where test_vtkhdf_file.py reads them; error exits.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_results
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, EXIT_INTERNAL, EXIT_IO
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_ELEMENT_NODES, N_SOLID_KINDS
  use amontons_mesh, only: finalize_mesh, mesh_type, set_type
  use amontons_model, only: job_options_type, model_type
  use amontons_iteration_records, only: increment_record_type, iteration_record_type
  use amontons_state, only: fields_type, STATUS_OPEN, STATUS_SLIP, STATUS_STICK
  use amontons_shape_functions, only: node_coordinates
  use amontons_results, only: close_results, open_results, write_model, results_type, write_attempt, write_increment, &
    write_iteration
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite

  call test_job(suite)
  call test_two_at_once(suite)
  call test_not_finite(suite)
  call test_no_folder(suite)
  call suite%finish()

contains

  include 'sample_job.inc'

  !> Three frames, one failed attempt, one increment left out by file_frequency; a copy of the file after each frame.
  subroutine test_job(suite)
    type(suite_type), intent(inout) :: suite
    type(results_type) :: results
    type(model_type) :: model
    type(increment_record_type) :: record
    type(iteration_record_type) :: iteration
    type(error_type), allocatable :: error
    integer :: i
    call make_model(model)
    call open_results(results, model, make_options('job'), error)
    if (.not. allocated(error)) call write_model(results, model, error)
    call suite%that('job.vtkhdf opens', .not. allocated(error))
    call write_frame(suite, results, model, 0, make_record(1, 0, 1, .true.))
    call copy_file('job.vtkhdf', 'after_0.vtkhdf')
    do i = 1, 3
      iteration%iteration = i
      iteration%residual = 10.0_DP**(-i)
      iteration%n_scenario = [i, 0, 0, 1]
      call write_iteration(results, iteration, error)
      call suite%that('iteration is written', .not. allocated(error))
    end do
    call write_frame(suite, results, model, 1, make_record(1, 1, 1, .true.))
    call copy_file('job.vtkhdf', 'after_1.vtkhdf')
    record = make_record(2, 1, 1, .false.)
    record%residual = ieee_value(1.0_DP, ieee_quiet_nan)
    record%reason = 'residual is not a number'
    call write_attempt(results, record, error)
    call suite%that('failed attempt is written', .not. allocated(error))
    call write_frame(suite, results, model, 7, make_record(2, 1, 2, .true.))
    call write_frame(suite, results, model, 2, make_record(2, 2, 1, .true.))
    call close_results(results, error)
    call suite%that('job.vtkhdf closes', .not. allocated(error))
    call close_results(results, error)
    call suite%that('closing twice does no harm', .not. allocated(error))
  end subroutine test_job


  !> Two files that are written in turn do not disturb each other, and closing one leaves the other open.
  subroutine test_two_at_once(suite)
    type(suite_type), intent(inout) :: suite
    type(results_type) :: a, b
    type(model_type) :: model
    type(error_type), allocatable :: error
    call make_model(model)
    call open_results(a, model, make_options('a'), error)
    if (.not. allocated(error)) call write_model(a, model, error)
    call suite%that('a.vtkhdf opens', .not. allocated(error))
    call open_results(b, model, make_options('b'), error)
    if (.not. allocated(error)) call write_model(b, model, error)
    call suite%that('b.vtkhdf opens beside it', .not. allocated(error))
    call write_frame(suite, a, model, 0, make_record(1, 0, 1, .true.))
    call write_frame(suite, b, model, 3, make_record(1, 0, 1, .true.))
    call close_results(a, error)
    call suite%that('a.vtkhdf closes', .not. allocated(error))
    call write_frame(suite, b, model, 4, make_record(1, 1, 1, .true.))
    call close_results(b, error)
    call suite%that('b.vtkhdf closes after it', .not. allocated(error))
  end subroutine test_two_at_once


  !> A NaN in any field is an error with field and position, and the previous frames remain.
  subroutine test_not_finite(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: nan
    type(fields_type) :: fields
    type(model_type) :: model
    call make_model(model)
    nan = ieee_value(1.0_DP, ieee_quiet_nan)
    call make_fields(model, 1, fields)
    fields%u(2, 5) = nan
    call expect_refusal(suite, model, fields, 'U is not a finite number at node 5 ')
    call make_fields(model, 1, fields)
    fields%stress(6, 3) = nan
    call expect_refusal(suite, model, fields, 'S is not a finite number at integration point 3 ')
    call make_fields(model, 1, fields)
    fields%energy(4) = nan
    call expect_refusal(suite, model, fields, 'energy is not a finite number at integration point 4 ')
    call make_fields(model, 1, fields)
    fields%slaves(4)%stiffness = nan
    call expect_refusal(suite, model, fields, 'stiffness is not a finite number at slave 4 ')
    call make_fields(model, 1, fields)
    fields%slaves = fields%slaves(:2)
    call expect_refusal(suite, model, fields, 'The number of slave nodes')
  end subroutine test_not_finite


  !> Frame 0 is written, these fields are rejected, and so are all writes after the error.
  subroutine expect_refusal(suite, model, fields, message)
    type(suite_type), intent(inout) :: suite
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    character(*), intent(in) :: message             !< beginning of the message
    type(results_type) :: results
    type(error_type), allocatable :: error
    call open_results(results, model, make_options('refused'), error)
    if (.not. allocated(error)) call write_model(results, model, error)
    call write_frame(suite, results, model, 0, make_record(1, 0, 1, .true.))
    call write_increment(results, model, fields, make_record(1, 1, 1, .true.), error)
    call expect_error(suite, error, EXIT_INTERNAL, message)
    call write_attempt(results, make_record(1, 1, 2, .false.), error)
    call expect_error(suite, error, EXIT_IO, 'Result file ./refused.vtkhdf: cannot add rows')
    call close_results(results, error)
    call suite%that('a file closed by an error closes again', .not. allocated(error))
  end subroutine expect_refusal


  !> A missing folder is reported with its path.
  subroutine test_no_folder(suite)
    type(suite_type), intent(inout) :: suite
    type(results_type) :: results
    type(model_type) :: model
    type(job_options_type) :: options
    type(error_type), allocatable :: error
    call make_model(model)
    options = make_options('job')
    options%outdir = 'no/such/folder'
    call open_results(results, model, options, error)
    call expect_error(suite, error, EXIT_IO, 'Result file no/such/folder/job.vtkhdf: cannot create it')
  end subroutine test_no_folder


  subroutine expect_error(suite, error, code, message)
    type(suite_type), intent(inout) :: suite
    type(error_type), allocatable, intent(in) :: error
    integer, intent(in) :: code
    character(*), intent(in) :: message             !< beginning of the message
    call suite%that('there is an error: ' // message, allocated(error))
    if (.not. allocated(error)) return
    call suite%that('its code is right: ' // error%message, error%code == code)
    call suite%that('it says: ' // message // ' - not: ' // error%message, index(error%message, message) == 1)
  end subroutine expect_error


  !> Writes the fields of a frame number.
  subroutine write_frame(suite, results, model, frame, record)
    type(suite_type), intent(inout) :: suite
    type(results_type), intent(inout) :: results
    type(model_type), intent(in) :: model
    integer, intent(in) :: frame
    type(increment_record_type), intent(in) :: record
    type(fields_type) :: fields
    type(error_type), allocatable :: error
    call make_fields(model, frame, fields)
    call write_increment(results, model, fields, record, error)
    if (allocated(error)) call suite%that('increment is written: ' // error%message, .false.)
    call suite%that('increment is written', .not. allocated(error))
  end subroutine write_frame


  function make_options(job) result(options)
    character(*), intent(in) :: job
    type(job_options_type) :: options
    options%job = job
    options%outdir = '.'
  end function make_options


  !> Copies a file byte by byte, as a viewer would find it.
  subroutine copy_file(from, to)
    character(*), intent(in) :: from, to
    character(:), allocatable :: bytes
    integer :: source, target, n
    open (newunit=source, file=from, access='stream', form='unformatted', action='read', status='old')
    inquire (unit=source, size=n)
    allocate (character(n) :: bytes)
    read (source) bytes
    close (source)
    open (newunit=target, file=to, access='stream', form='unformatted', action='write', status='replace')
    write (target) bytes
    close (target)
  end subroutine copy_file

end program test_results
