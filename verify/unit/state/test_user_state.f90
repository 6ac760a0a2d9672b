!> Unit test of user_state: what UMAT, SDVINI, DLOAD and DISP are given at the points of elements, and what is stored.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_user_state
  use amontons_errors, only: error_type, EXIT_NOT_CONVERGED
  use amontons_element_integration_points, only: integration_points_type
  use amontons_kinds, only: DP
  use amontons_loads, only: distributed_type, prescribed_type
  use amontons_materials, only: USER_STRESS, USER_STATE, HISTORY_PEEQ, HISTORY_INELASTIC
  use amontons_mesh, only: finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type, slave_state_type, create_state, create_material_state
  use amontons_element_kinds, only: KIND_C3D8, KIND_CPE4, KIND_CPS4, KIND_T3D2, FACET_QUAD4
  use amontons_tensor, only: IDENTITY
  use amontons_user_routines, only: umat_type, open_routines, close_routines, collect_user_messages
  use amontons_user_state, only: max_stress_components, find_point_at_rest, initialize_state_variables, load_umat_points, &
    store_umat_points, evaluate_dload, evaluate_utracload, evaluate_disp, update_user_fields, load_user_fields, has_invalid_fields
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP, NEAR = 1 - 1 / sqrt(3.0_DP)   ! place of the first point of two on [0, 2]
  type(suite_type) :: suite
  type(model_type) :: model
  type(state_type) :: state
  type(error_type), allocatable :: error
  call write_user_file('test_user_state_routines.f90')
  call make_model()
  call open_routines('test_user_state_routines.f90', model%routines, error)
  call suite%that('opened', .not. allocated(error))
  if (allocated(error)) error stop 'the routines do not compile'
  model%materials(1)%routines = model%routines
  call check_components()
  call check_at_rest()
  call check_points()
  call check_stored()
  call check_fields()
  call check_initial()
  call check_loads()
  call close_routines(model%routines)
  call suite%finish()

contains

  include 'sample_user.inc'

  !> A cube of side 2 with label 7, of a material by UMAT with two state variables.
  subroutine make_model()
    type(slave_state_type) :: no_slaves(0)
    integer :: i
    associate (mesh => model%mesh)
      mesh%n_nodes = 8
      mesh%n_elements = 1
      mesh%coordinates = 2 * reshape([0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, &
        0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP], [3, 8])
      mesh%nodes = [(i, i=1, 8)]
      mesh%first = [1, 9]
      mesh%kind = [KIND_C3D8]
      mesh%material = [1]
      mesh%node_label = [(10 * i, i=1, 8)]
      mesh%element_label = [7]
      call finalize_mesh(mesh)
    end associate
    allocate (model%materials(1), model%steps(1), model%amplitudes(0), model%interactions(0))
    model%materials(1)%is_user = .true.
    model%materials(1)%n_statev = 2
    model%materials(1)%n_history = USER_STATE + 1
    call create_state(state, model%mesh, no_slaves)
    call create_material_state(state, model)
  end subroutine make_model


  !> NDI and NSHR by the kind of element: the largest over the elements of a material.
  subroutine check_components()
    type(model_type) :: other
    other%mesh%n_elements = 3
    other%mesh%kind = [KIND_T3D2, KIND_CPS4, KIND_CPE4]
    other%mesh%material = [1, 2, 2]
    allocate (other%materials(3))
    call suite%that('truss', all(max_stress_components(other, 1) == [1, 0]))
    call suite%that('plane stress and strain: those of strain', all(max_stress_components(other, 2) == [3, 1]))
    call suite%that('of no element', all(max_stress_components(other, 3) == [1, 0]))
    other%materials(1)%is_called_in_3d = .true.
    call suite%that('called in space', all(max_stress_components(other, 1) == [3, 3]))
    call suite%that('solids', all(max_stress_components(model, 1) == [3, 3]))
  end subroutine check_components


  !> At rest: number, place and size of the first element, and the STATEV there.
  subroutine check_at_rest()
    type(umat_type) :: values
    real(DP), allocatable :: statev(:), fields(:, :)
    call find_point_at_rest(model, 1, values, statev, fields)
    call suite%that('element 7, point 1', values%noel == 7 .and. values%npt == 1 .and. values%ndi == 3 .and. values%nshr == 3)
    call suite%near('place', norm2(values%coords - [NEAR, NEAR, NEAR]), 0.0_DP, TOL)
    call suite%that('no STATEV yet', size(statev) == 2 .and. all(abs(statev) <= 0.0_DP))
    call suite%near('DFGRD1', norm2(values%dfgrd1 - IDENTITY), 0.0_DP, 0.0_DP)
    model%has_sdvini = .true.
    call find_point_at_rest(model, 1, values, statev, fields)
    call suite%near('SDVINI', maxval(abs(statev - [NEAR, 701.0_DP])), 0.0_DP, TOL)
    model%has_sdvini = .false.
  end subroutine check_at_rest


  !> Times at the start of the increment, positions, numbers, length, mean temperature, committed history.
  subroutine check_points()
    type(integration_points_type) :: points
    integer :: i
    state%old%total_time = 1.0_DP
    state%new%total_time = 1.5_DP
    state%new%step_time = 0.75_DP
    state%new%step = 1
    state%new%increment = 4
    state%old%temperature = [(real(i, DP), i=1, 8)]
    do i = 1, 8
      state%old%history(:, i) = real(i, DP)
    end do
    state%new%history = -1
    state%new%u = 0.5_DP
    call load_umat_points(model, state, 1, .false., points)
    call suite%that('eight', size(points%user) == 8)
    associate (values => points%user(8)%values)
      call suite%near('times', maxval(abs([values%time, values%dtime] - [0.25_DP, 1.0_DP, 0.5_DP])), 0.0_DP, TOL)
      call suite%near('temperature', values%temp, 4.5_DP, TOL)
      call suite%near('place', maxval(abs(values%coords - (2 - NEAR))), 0.0_DP, TOL)
      call suite%near('length: root of the volume', values%celent, 2.0_DP, TOL)
      call suite%that('numbers', values%noel == 7 .and. values%npt == 8 .and. values%step == 1 .and. values%increment == 4 .and. &
        values%ndi == 3 .and. values%nshr == 3)
    end associate
    call suite%near('committed history', maxval(abs(points%user(8)%history_old - 8)), 0.0_DP, 0.0_DP)
    call suite%that('from the stress on', size(points%user(8)%history_old) == USER_STATE + 2 - USER_STRESS)
    call load_umat_points(model, state, 1, .true., points)
    call suite%near('current place under NLGEOM', maxval(abs(points%user(1)%values%coords - (NEAR + 0.5_DP))), 0.0_DP, TOL)
    call suite%that('no axes', .not. points%user(1)%has_orientation)
    model%element_orientation = [1]
    call load_umat_points(model, state, 1, .true., points)
    call suite%that('axes', points%user(1)%has_orientation)
    deallocate (model%element_orientation)
  end subroutine check_points


  !> The history of UMAT goes to its points; what stands before it is zero.
  subroutine check_stored()
    type(integration_points_type) :: points
    integer :: p
    allocate (points%user(8))
    do p = 1, 8
      allocate (points%user(p)%history(USER_STATE + 2 - USER_STRESS), source=real(10 * p, DP))
    end do
    call store_umat_points(model, 1, points, state%new)
    call suite%near('stored', maxval(abs(state%new%history(USER_STRESS:, 3) - 30)), 0.0_DP, 0.0_DP)
    call suite%near('before it', maxval(abs(state%new%history(:USER_STRESS - 1, :))), 0.0_DP, 0.0_DP)
  end subroutine check_stored


  !> USDFLD: its arguments, GETVRM, the field of the points, and refused increments.
  subroutine check_fields()
    type(integration_points_type) :: points
    model%materials(1)%is_user = .false.
    model%materials(1)%is_user_field = .true.
    model%materials(1)%table_variable = 1
    model%materials(1)%name = 'M'
    state%new%temperature = [spread(3.0_DP, 1, 8), spread(40.0_DP, 1, 8)]
    state%old%temperature = spread(2.0_DP, 1, 16)
    state%old%history = 0
    state%old%history(HISTORY_PEEQ, :) = 0.25_DP
    state%old%history(HISTORY_INELASTIC + 5, 8) = 0.5_DP
    state%old%history(USER_STATE, 8) = 6
    state%old%stress(:, 8) = [1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP]
    state%old%strain(:, 8) = [0.1_DP, 0.2_DP, 0.3_DP, 0.4_DP, 0.5_DP, 0.6_DP]
    state%new%time_increment = 0.5_DP
    call update_user_fields(model, state)
    call load_user_fields(model, state, 1, points)
    ! FIELD + NOEL + NPT/10 + S12 S13 S23, E13, PEEQ, PE13, DTIME, TIME(1), TEMP, x; Mises is sqrt(3 + 3 (16 + 25 + 36))
    call suite%near('FIELD', points%point_field(8), 40 + 7 + 0.8_DP + 100 * 4 + 1000 * 6 + 1.0e4_DP * 5 + 1.2_DP + 0.25_DP &
      + 1.0_DP + 0.5_DP + 0.25_DP + 2.0_DP + 2 - NEAR, 1.0e-9_DP)
    call suite%near('STATEV', maxval(abs(state%new%history(USER_STATE:USER_STATE + 1, 8) - [7.0_DP, sqrt(234.0_DP) - 2])), &
      0.0_DP, TOL)
    call suite%that('valid', .not. has_invalid_fields(model, state%new, 1))
    state%new%time_increment = 100
    call update_user_fields(model, state)
    call suite%that('PNEWDT', has_invalid_fields(model, state%new, 1))
    model%materials(1)%is_user = .true.
    model%materials(1)%is_user_field = .false.
    call suite%that('no such material', .not. has_invalid_fields(model, state%new, 1))
  end subroutine check_fields


  !> STATEV of the deck, of SDVINI, and a job that SDVINI ends.
  subroutine check_initial()
    state%new%history = 0
    call initialize_state_variables(model, state, error)
    call suite%near('none', maxval(abs(state%new%history)), 0.0_DP, 0.0_DP)
    model%initial_statev = reshape([3.0_DP, 4.0_DP], [2, 8], pad=[5.0_DP])
    call initialize_state_variables(model, state, error)
    call suite%near('of the deck', maxval(abs(state%new%history(USER_STATE:USER_STATE + 1, 1) - [3.0_DP, 4.0_DP])), 0.0_DP, 0.0_DP)
    call suite%near('committed, too', state%old%history(USER_STATE, 2), 5.0_DP, 0.0_DP)
    model%has_sdvini = .true.
    call initialize_state_variables(model, state, error)
    call suite%near('SDVINI: place and numbers', maxval(abs(state%new%history(USER_STATE:USER_STATE + 1, 8) - [2 - NEAR, &
      708.0_DP])), &
      0.0_DP, TOL)
    call suite%that('no error', .not. allocated(error))
    model%mesh%element_label = [99]
    call initialize_state_variables(model, state, error)
    call suite%that('XIT', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_NOT_CONVERGED)
    model%mesh%element_label = [7]
  end subroutine check_initial


  !> DLOAD at the points of a face; DISP after the first increment has begun.
  subroutine check_loads()
    type(distributed_type) :: load
    type(prescribed_type) :: support
    real(DP), allocatable :: pressures(:)
    real(DP) :: value, force(3, 4), area, smallest
    character(:), allocatable :: text
    logical :: is_stopped, has_crashed
    load%element = 1
    load%face = 2
    state%new%step_time = 0.25_DP
    state%new%total_time = 1.25_DP
    call evaluate_dload(model, load, FACET_QUAD4, model%mesh%coordinates(:, 5:8), state%new, pressures)
    call suite%that('four points', size(pressures) == 4)
    ! mean over the face of x + 10 y + 1000 (JLTYP - 20) + time, JLTYP of face 2 being 22; NPT counts them
    call suite%near('mean', sum(pressures) / 4, 11.0_DP + 250.0_DP + 2000.0_DP + 0.25_DP, 1.0e-11_DP)
    ! 2 along the inward normal (0 0 -1) beside 1 along x: T_USER has the length sqrt(5); ALPHA of face 2 in the mean, NOEL is 7
    load%direction = [1.0_DP, 0.0_DP, 0.0_DP]
    call collect_user_messages(model%routines, smallest, text, is_stopped, has_crashed)   ! of calls before
    call evaluate_utracload(model, load, FACET_QUAD4, model%mesh%coordinates(:, 5:8), model%mesh%coordinates(:, 5:8), state%new, &
      force)
    area = face_area(model%mesh%coordinates(:, 5:8))
    call suite%near('traction', norm2(sum(force, dim=2) - area * (sum(pressures) / 4 + 7) * [1.0_DP, 0.0_DP, -2.0_DP] / &
      sqrt(5.0_DP)), 0.0_DP, 1.0e-9_DP)
    support%node = 7
    support%dof = 3
    value = 5
    state%new%time_increment = 0
    state%new%u = 0.5_DP
    call evaluate_disp(model, support, state%new, value)
    call suite%near('before the first increment', value, 5.0_DP, 0.0_DP)
    state%new%time_increment = 0.25_DP
    call evaluate_disp(model, support, state%new, value)
    call suite%near('time, label, direction, current place', value, 1.25_DP + 700.0_DP + 300.0_DP + 2.5_DP, TOL)
  end subroutine check_loads


  !> The area of a parallelogram.
  pure real(DP) function face_area(x)
    real(DP), intent(in) :: x(:, :)
    face_area = norm2(x(:, 2) - x(:, 1)) * norm2(x(:, 4) - x(:, 1))
  end function face_area

end program test_user_state
