!> Tests of globalization: which direction is taken, on two blocks that are held, and on one that nothing holds yet.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_globalization
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_controls, only: globalization_controls_type
  use amontons_steps, only: step_type
  use amontons_loads, only: concentrated_type
  use amontons_state, only: state_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    OUTCOME_OK
  use amontons_newton_step, only: solve_newton_step
  use amontons_globalization, only: globalization_type, trial_step_type, delay_snap_through, choose_step, &
    is_repeatedly_unsolved, STEP_KIND_NEWTON, STEP_KIND_SNAP_THROUGH
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_newton_step(suite)
  call check_free_block(suite)
  call check_rejected_step(suite)
  call suite%finish()

contains

  !> A block that is held: the direction is Newton's, as the module of the linear system gives it.
  subroutine check_newton_step(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(globalization_type) :: strategy
    type(trial_step_type) :: trial
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :)
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    model%steps(1)%concentrated = [concentrated_type(start=0.1_DP, end=0.1_DP, node=19, dof=1)]
    call start_blocks(model, system, state)
    call choose_step(strategy, system, model, model%steps(1), state, trial, outcome, error)
    call suite%that('held: Newton', outcome == OUTCOME_OK .and. strategy%step_kind == STEP_KIND_NEWTON .and. &
      strategy%n_proximal == 0 .and. strategy%n_snap_through == 0)
    call suite%that('held: the slaves at its end', allocated(trial%predicted_slaves))
    allocate (du, mold=trial%du)
    call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.true.)
    call solve_newton_step(system, model, model%steps(1), state, du, outcome, error)
    call suite%near('held: its direction', norm2(trial%du - du), 0.0_DP, 1.0e-12_DP * norm2(du))
    call suite%that('held: nothing is unsolved', .not. is_repeatedly_unsolved(strategy))
  end subroutine check_newton_step


  !> A block pressed down by forces with nothing below it but a gap: a direction with a part of its stiffness, towards the master.
  subroutine check_free_block(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(globalization_type) :: strategy
    type(trial_step_type) :: trial
    type(error_type), allocatable :: error
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.1_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    call press_by_forces(model%steps(1))
    call start_blocks(model, system, state)
    call choose_step(strategy, system, model, model%steps(1), state, trial, outcome, error)
    call suite%that('free: a direction', outcome == OUTCOME_OK .and. .not. allocated(error))
    call suite%that('free: neither Newton nor snap through', strategy%step_kind /= STEP_KIND_NEWTON .and. &
      strategy%step_kind /= STEP_KIND_SNAP_THROUGH)
    call suite%that('free: towards the master', all(trial%du(3, 19:) < 0.0_DP))
    call suite%that('free: it reaches it', minval(trial%du(3, 19:34)) < -0.05_DP)
    call suite%that('free: not beyond 2.5 edges, or twice that', maxval(norm2(trial%du, dim=1)) < 2 * 2.5_DP * 1.2_DP)
  end subroutine check_free_block


  !> No support at the top: a force on each of its nodes instead, and none along the plane.
  subroutine press_by_forces(step)
    type(step_type), intent(inout) :: step
    integer :: i
    step%prescribed = step%prescribed(:27)
    deallocate (step%concentrated)
    allocate (step%concentrated(16))
    do i = 1, 16
      step%concentrated(i)%node = 34 + i
      step%concentrated(i)%dof = 3
      step%concentrated(i)%start = -0.01_DP
      step%concentrated(i)%end = -0.01_DP
    end do
  end subroutine press_by_forces


  !> After a step without an accepted length, the next direction approaches the next equilibrium, without Newton's before; with
  !! the delay, the count has to pass it first: a rejected step counts as the third.
  subroutine check_rejected_step(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(globalization_type) :: strategy, delayed
    type(trial_step_type) :: trial
    type(error_type), allocatable :: error
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.02_DP, 0.0_DP, -0.02_DP])
    call start_blocks(model, system, state)
    call choose_step(strategy, system, model, model%steps(1), state, trial, outcome, error)
    strategy%is_rejected = .true.
    call choose_step(strategy, system, model, model%steps(1), state, trial, outcome, error)
    call suite%that('rejected: snap through', strategy%step_kind == STEP_KIND_SNAP_THROUGH .and. strategy%n_snap_through == 1)
    call suite%that('rejected: forgotten after it', .not. strategy%is_rejected)
    call suite%that('rejected: contact is solved along it', system%is_subproblem_solved)
    call suite%that('rejected: K has a part of its diagonal', system%proximal_shift > 0.0_DP)
    call suite%that('rejected: once is not repeatedly', .not. is_repeatedly_unsolved(strategy))
    strategy%is_rejected = .true.
    call choose_step(strategy, system, model, model%steps(1), state, trial, outcome, error)
    call suite%that('rejected: twice is', is_repeatedly_unsolved(strategy) .and. strategy%n_snap_through == 2)
    call delay_snap_through(delayed, globalization_controls_type())
    delayed%is_rejected = .true.
    call choose_step(delayed, system, model, model%steps(1), state, trial, outcome, error)
    call suite%that('rejected: it counts beyond the delay', delayed%step_kind == STEP_KIND_SNAP_THROUGH)
  end subroutine check_rejected_step


  include 'sample_blocks.inc'

end program test_globalization
