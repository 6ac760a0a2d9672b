!> Tests of the proximal step: when a motion counts as unrestrained, and how far a block goes that nothing holds yet.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_proximal_step
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, slave_state_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    update_base_constraints, OUTCOME_OK, OUTCOME_LINEAR_SOLVER, OUTCOME_ELEMENT
  use amontons_newton_step, only: set_proximal_shift
  use amontons_proximal_step, only: is_motion_unrestrained, find_proximal_step, find_snap_through_step
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_unrestrained(suite)
  call check_free_block(suite, 0.1_DP)
  call check_free_block(suite, 0.4_DP)
  call check_snap_through(suite)
  call suite%finish()

contains

  !> A singular tangent, an interface without an inverse, or a direction beyond the size of the model and what supports still miss.
  subroutine check_unrestrained(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :)
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.0_DP, 0.0_DP, 0.0_DP])   ! the model is 2.4 by 2.4 by 2
    call start_blocks(model, system, state)
    allocate (du, mold=state%new%u)
    du = 0.0_DP
    call suite%that('no motion', .not. is_motion_unrestrained(system, model, du, OUTCOME_OK))
    call suite%that('a singular tangent', is_motion_unrestrained(system, model, du, OUTCOME_LINEAR_SOLVER))
    call suite%that('an inverted element says nothing', .not. is_motion_unrestrained(system, model, du, OUTCOME_ELEMENT))
    du(1, 50) = 2.0_DP
    call suite%that('within the model', .not. is_motion_unrestrained(system, model, du, OUTCOME_OK))
    du(1, 50) = 10.0_DP
    call suite%that('beyond the model', is_motion_unrestrained(system, model, du, OUTCOME_OK))
    du = 0.0_DP
    system%is_interface_singular = .true.
    call suite%that('a singular interface', is_motion_unrestrained(system, model, du, OUTCOME_OK))
    call two_blocks(model, 0.2_DP, 0.0_DP, [20.0_DP, 0.0_DP, 0.0_DP])
    call start_blocks(model, system, state)
    call update_base_constraints(system, model, model%steps(1), state%new, error)
    du(1, 50) = 10.0_DP
    call suite%that('supports that still miss more than that', .not. is_motion_unrestrained(system, model, du, OUTCOME_OK))
  end subroutine check_unrestrained


  !> A block above its master under forces: it goes to where it touches, not farther than ten times the way, nor out of sight, and
  !! the part of the stiffness is within its bounds and is remembered.
  subroutine check_free_block(suite, gap)
    type(suite_type), intent(inout) :: suite
    real(DP), intent(in) :: gap                    !< [length]
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :)
    real(DP) :: shift
    integer :: outcome, i
    call two_blocks(model, 0.2_DP, gap, [0.0_DP, 0.0_DP, 0.0_DP])
    associate (step => model%steps(1))
      step%prescribed = step%prescribed(:27)
      deallocate (step%concentrated)
      allocate (step%concentrated(16))
      do i = 1, 16
        step%concentrated(i)%node = 34 + i
        step%concentrated(i)%dof = 3
        step%concentrated(i)%start = -1.0e-3_DP
        step%concentrated(i)%end = -1.0e-3_DP
      end do
    end associate
    call start_blocks(model, system, state)
    allocate (du, mold=state%new%u)
    shift = 0.0_DP
    call find_proximal_step(system, model, model%steps(1), state, shift, du, slaves, outcome, error)
    call suite%that('free: a direction', outcome == OUTCOME_OK .and. .not. allocated(error))
    call suite%that('free: finite and downward', all(du(3, 19:) < 0.0_DP) .and. maxval(abs(du)) < 20.0_DP)
    call suite%that('free: it touches', minval(du(3, 19:34)) <= -0.99_DP * gap)
    call suite%that('free: not out of sight', maxval(norm2(du, dim=1)) <= 2.0_DP * 2.5_DP * 1.2_DP)
    call suite%that('free: the shift is known now', shift > 0.0_DP .and. shift <= 1.0_DP)
    call suite%that('free: the slaves at its end', size(slaves) == 16)
    call suite%near('free: the state stands where it was', norm2(state%new%u), 0.0_DP, 0.0_DP)
    call set_proximal_shift(system, model, state%new, 0.0_DP)
    call suite%that('free: K as it was can be had again', system%proximal_shift <= 0.0_DP .and. .not. system%is_assembled)
  end subroutine check_free_block


  !> A part of the stiffness through a snap: a thousandth at first, a sixth of what was enough the next time; contact is solved.
  subroutine check_snap_through(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :)
    real(DP) :: shift
    integer :: outcome
    call two_blocks(model, 0.3_DP, 0.0_DP, [0.02_DP, 0.0_DP, -0.02_DP])
    call start_blocks(model, system, state)
    allocate (du, mold=state%new%u)
    shift = 0.0_DP
    call find_snap_through_step(system, model, model%steps(1), state, shift, du, slaves, outcome, error)
    call suite%that('snap: contact is solved', outcome == OUTCOME_OK .and. system%is_subproblem_solved)
    call suite%near('snap: the first part', shift, 1.0e-3_DP, 1.0e-18_DP)
    call find_snap_through_step(system, model, model%steps(1), state, shift, du, slaves, outcome, error)
    call suite%near('snap: the next one', shift, 1.0e-3_DP / 6.0_DP, 1.0e-18_DP)
    call suite%near('snap: the supports arrive all the same', maxval(abs(du(3, 35:) + 0.02_DP)), 0.0_DP, 1.0e-12_DP)
  end subroutine check_snap_through


  include 'sample_blocks.inc'

end program test_proximal_step
