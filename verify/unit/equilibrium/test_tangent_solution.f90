!> Tests of the solution of the linearised equations: the direction along a path against differences of the residual.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_tangent_solution
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_loads, only: concentrated_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, STATUS_SLIP
  use amontons_sparse, only: multiply_transpose
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    OUTCOME_OK
  use amontons_newton_step, only: linearize_equilibrium, solve_newton_step
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_path(suite, .false.)
  call check_path(suite, .true.)
  call suite%finish()

contains

  !> Blocks pressed and sheared, their nodes slipping, with forces on slave and master nodes that the load factor scales: a step
  !! along the direction changes the residual as the equations say, and ends on the arc.
  subroutine check_path(suite, are_supports_moving)
    type(suite_type), intent(inout) :: suite
    logical, intent(in) :: are_supports_moving     !< with the load factor, too
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state, there
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), ahead(:, :), slope(:), left(:), start(:, :)
    real(DP), parameter :: H = 1.0e-6_DP
    real(DP) :: d_load
    integer :: n, pass, outcome, i
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.05_DP, 0.02_DP, -0.04_DP])
    model%steps(1)%is_nlgeom = .true.
    model%steps(1)%is_riks = .true.
    if (.not. are_supports_moving) model%steps(1)%prescribed%start = model%steps(1)%prescribed%end
    model%steps(1)%concentrated = [(concentrated_type(end=real(i - 10, DP), node=i, dof=1 + mod(i, 3)), i=12, 32, 4)]
    call start_blocks(model, system, state)
    do n = 19, model%mesh%n_nodes
      state%new%u(:, n) = [0.06_DP, 0.03_DP, merge(-0.06_DP, 0.0_DP, n > 34)]
      state%new%u(1, n) = state%new%u(1, n) + 0.004_DP * sin(real(n, DP))
    end do
    state%new%load_factor = 0.5_DP
    state%new%time_increment = 0.125_DP
    state%new%slaves%status = STATUS_SLIP
    do pass = 1, 2                                 ! the stiffness at the nodes is known after the first
      call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.true.)
      call linearize_equilibrium(system, model, model%steps(1), state, outcome, error)
    end do
    start = system%residual
    state%new%arc_scale = 10.0_DP                  ! the blocks were not in equilibrium: a sphere that reaches the direction
    allocate (du, mold=state%new%u)
    call solve_newton_step(system, model, model%steps(1), state, du, outcome, error, d_load)
    call suite%that('path: found', outcome == OUTCOME_OK .and. .not. allocated(error))
    call suite%that('path: the load changes', abs(d_load) > 1.0e-3_DP)
    associate (step => model%steps(1), C => system%constraints%transformation)
      there = state
      there%new%u = state%new%u + H * du
      there%new%load_factor = state%new%load_factor + H * d_load
      call evaluate_equilibrium(system, model, step, there, outcome, is_frozen=.true.)
      ahead = system%residual
      there = state
      there%new%u = state%new%u - H * du
      there%new%load_factor = state%new%load_factor - H * d_load
      call evaluate_equilibrium(system, model, step, there, outcome, is_frozen=.true.)
      slope = reshape((ahead - system%residual) / (2 * H) + start, [size(du)])
      allocate (left(system%constraints%n_free))
      call multiply_transpose(C, slope, left)
      call suite%near('path: the direction removes the residual', maxval(abs(left)), 0.0_DP, 1.0e-5_DP * maxval(abs(start)))
    end associate
  end subroutine check_path


  include 'sample_blocks.inc'

end program test_tangent_solution
