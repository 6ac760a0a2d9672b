!> Unit test of global_results: the mesh, the increments, fields and sets of a global model in a .vtkhdf file of two parts and in a
!! .frd file.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_global_results
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: KIND_C3D4, KIND_CPS4
  use amontons_errors, only: error_type, EXIT_IO, EXIT_SETUP
  use amontons_global_results, only: global_results_type, global_frame_type, open_global_results, close_global_results, &
    find_global_frames, read_global_field, find_global_set, GLOBAL_DISPLACEMENT, GLOBAL_TEMPERATURE
  use amontons_hdf5_file, only: hdf5_file_type, create_hdf5, close_hdf5, create_group, write_data, STORAGE_I64, STORAGE_U8
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_vtkhdf()
  call check_frd()
  call check_errors()
  call suite%finish()

contains

  !> A tetrahedron and a truss in the first part, a tetrahedron and a quadrilateral in the second; three frames.
  subroutine write_vtkhdf()
    type(hdf5_file_type) :: store
    type(error_type), allocatable :: error
    integer :: i
    call create_hdf5(store, 'global.vtkhdf', error)
    call create_group(store, '/VTKHDF', error)
    call create_group(store, '/VTKHDF/PointData', error)
    call create_group(store, '/VTKHDF/CellData', error)
    call create_group(store, '/AMONTONS', error)
    call create_group(store, '/AMONTONS/history', error)
    call create_group(store, '/AMONTONS/mesh', error)
    call create_group(store, '/AMONTONS/mesh/element_sets', error)
    call write_data(store, '/VTKHDF/NumberOfPoints', [4, 5], '[-]', 'x', error, STORAGE_I64)
    call write_data(store, '/VTKHDF/NumberOfCells', [2, 2], '[-]', 'x', error, STORAGE_I64)
    call write_data(store, '/VTKHDF/NumberOfConnectivityIds', [6, 8], '[-]', 'x', error, STORAGE_I64)
    call write_data(store, '/VTKHDF/Connectivity', [0, 1, 2, 3, 0, 1, 4, 3, 2, 1, 0, 1, 2, 3], '[-]', 'x', error, STORAGE_I64)
    call write_data(store, '/VTKHDF/Offsets', [0, 4, 6, 0, 4, 8], '[-]', 'x', error, STORAGE_I64)
    call write_data(store, '/VTKHDF/Types', [10, 3, 10, 9], '[-]', 'x', error, STORAGE_U8)
    call write_data(store, '/VTKHDF/Points', reshape([(real(i, DP), i=1, 27)], [3, 9]), '[length]', 'x', error)
    call write_data(store, '/VTKHDF/CellData/ELEMENT', [11, 12, 21, 22], '[-]', 'x', error)
    call write_data(store, '/VTKHDF/PointData/U', reshape([(0.5_DP * real(i, DP), i=1, 81)], [3, 27]), '[length]', 'x', error)
    call write_data(store, '/VTKHDF/PointData/NT', [(100.0_DP + real(i, DP), i=1, 27)], '[temperature]', 'x', error)
    call write_data(store, '/AMONTONS/history/step', [0, 1, 1, 1, 2], '[-]', 'x', error)
    call write_data(store, '/AMONTONS/history/frame', [0, -1, -1, 1, 2], '[-]', 'x', error)
    call write_data(store, '/AMONTONS/history/step_time', [0.0_DP, 0.25_DP, 0.5_DP, 1.0_DP, 2.0_DP], '[time]', 'x', error)
    call write_data(store, '/AMONTONS/mesh/element_label', [11, 12, 21, 22], '[-]', 'x', error)
    call write_data(store, '/AMONTONS/mesh/element_sets/name', ['ALL ', 'Some'], '[-]', 'x', error)
    call write_data(store, '/AMONTONS/mesh/element_sets/first', [0, 4, 6], '[-]', 'x', error)
    call write_data(store, '/AMONTONS/mesh/element_sets/members', [0, 1, 2, 3, 2, 0], '[-]', 'x', error)
    call close_hdf5(store, error)
    call suite%that('the sample is written', .not. allocated(error))
  end subroutine write_vtkhdf


  !> Solids alone count; nodes of the second part come after those of the first.
  subroutine check_vtkhdf()
    type(global_results_type) :: results
    type(global_frame_type), allocatable :: frames(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: values(:, :)
    logical, allocatable :: is_given(:)
    integer, allocatable :: labels(:)
    integer :: i
    call write_vtkhdf()
    call open_global_results(results, 'global.vtkhdf', error)
    call suite%that('opened', .not. allocated(error))
    if (allocated(error)) return
    call suite%that('mesh', results%n_nodes == 9 .and. results%is_solid .and. all(results%kind == KIND_C3D4) .and. &
      all(results%element_label == [11, 21]) .and. all(results%first == [1, 5, 9]))
    call suite%that('nodes of both parts', all(results%nodes == [1, 2, 3, 4, 9, 8, 7, 6]))
    call suite%near('coordinates', results%coordinates(3, 9), 27.0_DP, 0.0_DP)
    call find_global_frames(results, GLOBAL_DISPLACEMENT, frames, error)
    call suite%that('frames', all(frames%step == [0, 1, 2]) .and. all(frames%data_set == [0, 1, 2]))
    call suite%near('time in the step', frames(3)%step_time, 2.0_DP, 0.0_DP)
    call read_global_field(results, GLOBAL_DISPLACEMENT, frames(2), values, is_given, error)
    call suite%that('shape', all(shape(values) == [3, 9]) .and. all(is_given))
    call suite%near('displacements', maxval(abs(values - reshape([(0.5_DP * real(i, DP), i=28, 54)], [3, 9]))), 0.0_DP, 0.0_DP)
    call read_global_field(results, GLOBAL_TEMPERATURE, frames(3), values, is_given, error)
    call suite%near('temperatures', maxval(abs(values(1, :) - [(100.0_DP + real(i, DP), i=19, 27)])), 0.0_DP, 0.0_DP)
    call find_global_set(results, 'SOME', labels, error)
    call suite%that('set', all(labels == [11, 21]) .and. .not. allocated(error))
    call find_global_set(results, 'NONE', labels, error)
    call suite%that('no set', allocated(error))
    if (allocated(error)) call suite%that('its code', error%code == EXIT_SETUP)
    call close_global_results(results)
  end subroutine check_vtkhdf


  !> One quadrilateral; the times are those in the steps.
  subroutine check_frd()
    type(global_results_type) :: results
    type(global_frame_type), allocatable :: frames(:)
    type(error_type), allocatable :: error
    integer, allocatable :: labels(:)
    call write_frd(9)
    call open_global_results(results, 'global.frd', error)
    call suite%that('frd opened', .not. allocated(error))
    if (allocated(error)) return
    call suite%that('frd mesh', .not. results%is_solid .and. all(results%kind == KIND_CPS4) .and. results%n_nodes == 4)
    call find_global_frames(results, GLOBAL_DISPLACEMENT, frames, error)
    call suite%that('frd frames', all(frames%step == [1, 1, 2]))
    call suite%near('frd times', maxval(abs(frames%step_time - [0.5_DP, 1.0_DP, 0.25_DP])), 0.0_DP, 1.0e-12_DP)
    call find_global_frames(results, GLOBAL_TEMPERATURE, frames, error)
    call suite%that('no temperatures', size(frames) == 0)
    call find_global_set(results, 'SOME', labels, error)
    call suite%that('no sets', allocated(error))
    call close_global_results(results)
  end subroutine check_frd


  !> A .frd file with an element of four nodes at least.
  subroutine write_frd(shape)
    integer, intent(in) :: shape                   !< of CGX
    integer :: unit, i, k
    real(DP), parameter :: TIMES(3) = [0.5_DP, 1.0_DP, 1.25_DP]
    open (newunit=unit, file='global.frd', action='write', status='replace')
    write (unit, '(a,18x,i12,37x,i1)') '    2C', 4, 1
    do i = 1, 4
      write (unit, '(a,i10,3es12.5)') ' -1', i, real(i, DP), 0.0_DP, 0.0_DP
    end do
    write (unit, '(a)') ' -3'
    write (unit, '(a,18x,i12,37x,i1)') '    3C', 1, 1
    write (unit, '(a,i10,3i5)') ' -1', 5, shape, 0, 1
    write (unit, '(a,4i10)') ' -2', 1, 2, 3, 4
    write (unit, '(a)') ' -3'
    do k = 1, 3
      write (unit, '(a,i26,2i12)') '    1PSTEP', k, k, merge(1, 2, k < 3)
      write (unit, '(a,i5,es12.5,i12,20x,i2,i5,10x,i2)') '  100CL', 100 + k, TIMES(k), 4, 0, k, 1
      write (unit, '(a)') ' -4  DISP        3    1', ' -5  D1          1    2    1    0', ' -5  D2          1    2    2    0', &
        ' -5  D3          1    2    3    0'
      do i = 1, 4
        write (unit, '(a,i10,3es12.5)') ' -1', i, 0.0_DP, 0.0_DP, 1.0_DP
      end do
      write (unit, '(a)') ' -3'
    end do
    write (unit, '(a)') ' 9999'
    close (unit)
  end subroutine write_frd


  !> A missing file; a model without elements of an inside.
  subroutine check_errors()
    type(global_results_type) :: results
    type(error_type), allocatable :: error
    call open_global_results(results, 'missing.vtkhdf', error)
    call suite%that('missing', allocated(error))
    if (allocated(error)) call suite%that('its code is that of files', error%code == EXIT_IO .and. &
      index(error%message, 'missing.vtkhdf') > 0)
    call write_frd(11)
    call open_global_results(results, 'global.frd', error)
    call suite%that('trusses alone', allocated(error))
    if (allocated(error)) call suite%that('in words', index(error%message, 'no solid') > 0)
  end subroutine check_errors

end program test_global_results
