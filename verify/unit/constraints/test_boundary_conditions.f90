!> Tests of boundary conditions: what is missing in time, equations, mid-side nodes, nodes without elements, conflicts.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_boundary_conditions
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_loads, only: equation_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type
  use amontons_constraints, only: constraints_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_boundary_conditions, only: build_base_constraints
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_prescribed(suite)
  call check_rows(suite)
  call check_conflict(suite)
  call suite%finish()

contains

  !> What is missing to the displacement prescribed at a time: by its amplitude, from where the step began, held.
  subroutine check_prescribed(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(constraints_type) :: base
    type(error_type), allocatable :: error
    real(DP) :: violation
    real(DP), allocatable :: u_start(:, :)
    logical :: is_alone(150)
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, -0.02_DP])
    call start_blocks(model, system, state)
    is_alone = .false.
    u_start = state%new%u
    u_start(3, 35:) = 0.04_DP
    state%new%u(3, 35) = 0.01_DP
    call build_base_constraints(base, model, model%steps(1), state%new, u_start, reshape([integer ::], [3, 0]), is_alone, &
      violation, error)
    call suite%that('prescribed: free are the others', base%n_free == 150 - 75 .and. .not. allocated(error))
    call suite%near('prescribed: what is missing', base%offset(105), -0.03_DP, 1.0e-16_DP)
    call suite%near('prescribed: nothing at the bottom', maxval(abs(base%offset(:27))), 0.0_DP, 0.0_DP)
    model%steps(1)%prescribed(30)%is_held = .true.     ! node 35, z
    model%steps(1)%prescribed(33)%is_from_current = .true.   ! node 36, z
    state%new%step_time = 0.25_DP
    call build_base_constraints(base, model, model%steps(1), state%new, u_start, reshape([integer ::], [3, 0]), is_alone, &
      violation, error)
    call suite%near('prescribed: held', base%offset(105), 0.04_DP - 0.01_DP, 1.0e-16_DP)
    call suite%near('prescribed: from where it was', base%offset(108), 0.04_DP - 0.06_DP * 0.25_DP, 1.0e-16_DP)
    is_alone(28:30) = .true.
    call build_base_constraints(base, model, model%steps(1), state%new, u_start, reshape([integer ::], [3, 0]), is_alone, &
      violation, error)
    call suite%that('prescribed: nodes without elements are held', base%n_free == 72)
    call suite%near('prescribed: no constraints, no violation', violation, 0.0_DP, 0.0_DP)
  end subroutine check_prescribed


  !> An equation with what it is violated by, and a mid-side node between its corners.
  subroutine check_rows(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(constraints_type) :: base
    type(error_type), allocatable :: error
    real(DP) :: violation, du(150)
    integer :: i
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    call start_blocks(model, system, state)
    model%equations = [equation_between(19, 20)]
    state%new%u(1, 19) = 0.3_DP
    state%new%u(:, 26) = [0.1_DP, 0.2_DP, 0.3_DP]
    call build_base_constraints(base, model, model%steps(1), state%new, 0 * state%new%u, reshape([26, 27, 28], [3, 1]), &
      [(.false., i=1, 150)], violation, error)
    call suite%that('rows: accepted', base%n_rows == 4 .and. base%n_free == 75 - 4 .and. .not. allocated(error))
    call complete(base, du)
    call suite%near('rows: the equation holds after it', state%new%u(1, 19) + du(55) - 2 * (state%new%u(1, 20) + du(58)), 0.0_DP, &
      1.0e-14_DP)
    call suite%near('rows: the node is in the middle', maxval(abs(state%new%u(:, 26) + du(76:78) &
      - 0.5_DP * (du(79:81) + du(82:84)))), 0.0_DP, 1.0e-14_DP)
    model%steps(1)%number = 2
    call build_base_constraints(base, model, model%steps(1), state%new, 0 * state%new%u, reshape([integer ::], [3, 0]), &
      [(.false., i=1, 150)], violation, error)
    call suite%that('rows: an equation of the step before', base%n_rows == 0)
  end subroutine check_rows


  !> du = C v + c for some v.
  subroutine complete(base, du)
    type(constraints_type), intent(in) :: base
    real(DP), intent(out) :: du(:)
    integer :: i, p
    du = base%offset
    do i = 1, base%n_unknowns
      do p = base%transformation%first(i), base%transformation%first(i + 1) - 1
        du(i) = du(i) + base%transformation%value(p) * sin(real(base%transformation%column(p), DP))
      end do
    end do
  end subroutine complete


  !> u_x(a) - 2 u_x(b) = 0, in the first step alone.
  function equation_between(a, b) result(equation)
    integer, intent(in) :: a, b
    type(equation_type) :: equation
    equation%node = [a, b]
    equation%dof = [1, 1]
    equation%coefficient = [1.0_DP, -2.0_DP]
    equation%n_eliminable = 1
    equation%last_step = 1
    equation%line = 77
    equation%card = 'EQUATION'
  end function equation_between


  !> An equation between two fixed nodes: fulfilled it is redundant, else an error that names its line.
  subroutine check_conflict(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(constraints_type) :: base
    type(error_type), allocatable :: error
    real(DP) :: violation
    integer :: i
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.1_DP, 0.0_DP, 0.0_DP])
    call start_blocks(model, system, state)
    model%equations = [equation_between(1, 2)]
    call build_base_constraints(base, model, model%steps(1), state%new, 0 * state%new%u, reshape([integer ::], [3, 0]), &
      [(.false., i=1, 150)], violation, error)
    call suite%that('conflict: none', .not. allocated(error) .and. base%n_rows == 0)
    model%equations = [equation_between(1, 40)]
    call build_base_constraints(base, model, model%steps(1), state%new, 0 * state%new%u, reshape([integer ::], [3, 0]), &
      [(.false., i=1, 150)], violation, error)
    call suite%that('conflict: an error', allocated(error))
    if (allocated(error)) call suite%that('conflict: its line', index(error%message, 'line 77') > 0)
  end subroutine check_conflict


  include 'sample_blocks.inc'

end program test_boundary_conditions
