!> Unit test of result_model: analytic surfaces as points and cells that move with their carriers; grid and model in a file.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_result_model
  use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_ptr
  use amontons_analytic_profiles, only: analytic_profile_type, add_line, add_arc, connect_pieces, PROFILE_PLANAR, &
    PROFILE_EXTRUDED, &
    PROFILE_REVOLVED
  use amontons_errors, only: error_type
  use amontons_hdf5_file, only: hdf5_file_type, create_hdf5, close_hdf5, create_group
  use amontons_iteration_records, only: increment_record_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: finalize_mesh, mesh_type, set_type
  use amontons_model, only: model_type
  use amontons_result_model, only: drawn_surfaces_type, draw_analytic_surfaces, drawn_displacements, write_grid, write_model_data
  use amontons_result_partitions, only: partition_type
  use amontons_shape_functions, only: node_coordinates
  use amontons_state, only: fields_type, STATUS_OPEN, STATUS_SLIP, STATUS_STICK
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_ELEMENT_NODES, N_SOLID_KINDS
  use check, only: suite_type
  use hdf5, only: HID_T, H5F_ACC_RDONLY_F, H5T_NATIVE_INTEGER, h5open_f, h5fopen_f, h5fclose_f, h5dopen_f, h5dread_f, h5dclose_f
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP            ! rounding of coordinates of size 10 over a few products
  type(suite_type) :: suite
  type(model_type) :: model
  type(fields_type) :: fields
  type(increment_record_type) :: record
  record = make_record(1, 1, 1, .true.)
  call make_model(model)
  call make_fields(model, 1, fields)
  call check_planar()
  call check_extruded()
  call check_revolved()
  call check_motion()
  call check_file()
  call suite%finish()

contains

  include 'sample_job.inc'

  !> Makes surface 1 analytic: a line of length 4 along x, or an arc of a quarter circle of radius 2; carriers are nodes 1 to 4.
  subroutine set_profile(kind, is_arc)
    integer, intent(in) :: kind
    logical, intent(in) :: is_arc
    type(analytic_profile_type) :: profile
    profile%kind = kind
    profile%carriers = [1, 2, 3, merge(0, 4, kind == PROFILE_PLANAR)]
    profile%n_carrier_nodes = merge(3, 4, kind == PROFILE_PLANAR)
    profile%span = 2.0_DP
    profile%anchor = 0
    if (is_arc) then
      call add_arc(profile, [2.0_DP, 0.0_DP], [0.0_DP, 2.0_DP], [0.0_DP, 0.0_DP])
    else
      call add_line(profile, [1.0_DP, 0.0_DP], [5.0_DP, 0.0_DP])
    end if
    call connect_pieces(profile)
    model%surfaces(1)%profile = profile
  end subroutine set_profile


  !> A line is one cell of two points; an arc has cells of at most five degrees.
  subroutine check_planar()
    type(drawn_surfaces_type) :: drawn
    call draw_analytic_surfaces(model, drawn)
    call suite%that('no profile, no points', drawn%n_points == 0 .and. drawn%n_cells == 0 .and. size(drawn%points, 2) == 0)
    call set_profile(PROFILE_PLANAR, .false.)
    call draw_analytic_surfaces(model, drawn)
    call suite%that('line', drawn%n_points == 2 .and. drawn%n_cells == 1 .and. all(drawn%nodes == [1, 2]) .and. &
      drawn%vtk_type(1) == 3)
    call suite%near('its end', maxval(abs(drawn%points(:, 2) - [5.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
    call set_profile(PROFILE_PLANAR, .true.)
    call draw_analytic_surfaces(model, drawn)
    call suite%that('90 degrees', drawn%n_points == 19 .and. drawn%n_cells == 18 .and. drawn%last(18) == 36)
    call suite%near('on the circle', maxval(abs(norm2(drawn%points, 1) - 2)), 0.0_DP, TOL)
  end subroutine check_planar


  !> Extruded over the mesh and a tenth of its size beyond it on both sides.
  subroutine check_extruded()
    type(drawn_surfaces_type) :: drawn
    real(DP) :: low, high
    call set_profile(PROFILE_EXTRUDED, .false.)
    model%surfaces(1)%profile%origin = 0
    model%surfaces(1)%profile%axes = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    low = minval(model%mesh%coordinates(3, :))
    high = maxval(model%mesh%coordinates(3, :))
    call draw_analytic_surfaces(model, drawn)
    call suite%that('one quadrilateral', drawn%n_points == 4 .and. drawn%n_cells == 1 .and. drawn%vtk_type(1) == 9 .and. &
      all(drawn%nodes == [1, 2, 4, 3]))
    call suite%near('from', minval(drawn%points(3, :)), low - 0.1_DP * (high - low), TOL)
    call suite%near('to', maxval(drawn%points(3, :)), high + 0.1_DP * (high - low), TOL)
  end subroutine check_extruded


  !> A full circle of 72 cells.
  subroutine check_revolved()
    type(drawn_surfaces_type) :: drawn
    call set_profile(PROFILE_REVOLVED, .false.)
    model%surfaces(1)%profile%origin = 0
    model%surfaces(1)%profile%axes = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    call draw_analytic_surfaces(model, drawn)
    call suite%that('a ring', drawn%n_cells == 72 .and. drawn%n_points == 2 * 73)
    call suite%near('its radii', maxval(abs(norm2(drawn%points(:2, :), 1) - [spread([1.0_DP, 5.0_DP], 2, 73)])), 0.0_DP, TOL)
  end subroutine check_revolved


  !> Carriers at the anchor and at the span along the axes: a rigid motion and a stretch of them move the points alike.
  subroutine check_motion()
    type(drawn_surfaces_type) :: drawn
    real(DP), allocatable :: u(:, :)
    call set_profile(PROFILE_EXTRUDED, .false.)
    model%surfaces(1)%profile%axes = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    call draw_analytic_surfaces(model, drawn)
    allocate (u(3, model%mesh%n_nodes), source=0.0_DP)
    u(:, :4) = spread([0.5_DP, 0.25_DP, 0.125_DP], 2, 4)
    call suite%near('translation', maxval(abs(drawn_displacements(drawn, u) - spread([0.5_DP, 0.25_DP, 0.125_DP], 2, 4))), &
      0.0_DP, TOL)
    u = 0
    u(2, 2) = 0.5_DP                                 ! the carrier at x = 2 moves along y: u_y = x/4
    call suite%near('shear', maxval(abs(matmul(reshape([0.0_DP, 1.0_DP, 0.0_DP], [1, 3]), drawn_displacements(drawn, u)) - &
      0.25_DP * drawn%points(1:1, :))), 0.0_DP, TOL)
  end subroutine check_motion


  !> Cells of the mesh and of the surface, pairs, sets and steps in a file; a second grid is refused.
  subroutine check_file()
    type(drawn_surfaces_type) :: drawn
    type(hdf5_file_type) :: store
    type(error_type), allocatable :: error
    integer :: n, m
    call set_profile(PROFILE_PLANAR, .false.)
    call draw_analytic_surfaces(model, drawn)
    call create_hdf5(store, 'test_result_model.h5', error)
    call write_grid(store, model%mesh, drawn, error)
    call suite%that('grid', .not. allocated(error))
    call create_group(store, '/AMONTONS', error)
    call create_group(store, '/AMONTONS/integration_points', error)
    call write_model_data(store, model, model%mesh, partition_type(elements=[(n, n=1, model%mesh%n_elements)], &
      nodes=[(n, n=1, model%mesh%n_nodes)]), error)
    call suite%that('model', .not. allocated(error))
    call write_grid(store, model%mesh, drawn, error)
    call suite%that('once', allocated(error))
    call close_hdf5(store, error)
    n = model%mesh%n_nodes
    m = size(model%mesh%nodes)
    call expect('/VTKHDF/NumberOfPoints', [n + 2])
    call expect('/VTKHDF/Connectivity', [model%mesh%nodes - 1, n, n + 1])
    call expect('/VTKHDF/Offsets', [model%mesh%first - 1, m + 2])
    call expect('/AMONTONS/mesh/node_sets/first', [0, 2, 2])
    call expect('/AMONTONS/mesh/node_sets/members', [8, 4])
    call expect('/AMONTONS/pairs/first', [0, 2, 3])
    call expect('/AMONTONS/pairs/facet_element', [4, 5, 8])
    call expect('/AMONTONS/pairs/facet_face', [2, 1, 3])
    call expect('/AMONTONS/steps/is_nlgeom', [0, 1])
    call expect('/AMONTONS/steps/file_frequency', [1, 2])
    call expect('/AMONTONS/controls/i_c', [model%steps(1)%controls%i_c, 33])
    call expect('/AMONTONS/mesh/element_material', spread(0, 1, model%mesh%n_elements))
  end subroutine check_file


  !> Integers of the file, by HDF5 itself.
  subroutine expect(name, values)
    character(*), intent(in) :: name
    integer, intent(in) :: values(:)
    integer(c_int), target :: found(size(values))
    type(c_ptr) :: place
    integer(HID_T) :: file, set
    integer :: status
    call h5open_f(status)
    call h5fopen_f('test_result_model.h5', H5F_ACC_RDONLY_F, file, status)
    call h5dopen_f(file, name, set, status)
    found = -9
    place = c_loc(found)
    if (status == 0) call h5dread_f(set, H5T_NATIVE_INTEGER, place, status)
    call suite%that(name, status == 0 .and. all(found == values))
    call h5dclose_f(set, status)
    call h5fclose_f(file, status)
  end subroutine expect

end program test_result_model
