!> Tests of the line search: lengths on two blocks whose residual is known along the direction, and invalid configurations.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_line_search
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, LINE_SEARCH_NONE, LINE_SEARCH_ALL, LINE_SEARCH_GLOBAL, LINE_SEARCH_NODAL, LINE_SEARCH_AUTO
  use amontons_state, only: state_type, STATUS_OPEN
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    OUTCOME_OK, OUTCOME_ELEMENT
  use amontons_newton_step, only: linearize_equilibrium, solve_newton_step
  use amontons_line_search, only: line_search_report_type, perform_line_search
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: ALL_MODES(5) = [LINE_SEARCH_NONE, LINE_SEARCH_ALL, LINE_SEARCH_GLOBAL, LINE_SEARCH_NODAL, LINE_SEARCH_AUTO]
  call check_linear_direction(suite)
  call check_lengths(suite)
  call check_overshoot_by_flow(suite)
  call check_missing_displacements(suite)
  call check_inverted_elements(suite)
  call check_counts(suite)
  call suite%finish()

contains

  !> Blocks far from each other, all supports at their prescribed displacements, and one free node of the slave moved: linear, with
  !! one solution.
  subroutine disturb(model, step, system, state, du)
    type(model_type), intent(out) :: model
    type(step_type), intent(out) :: step
    type(equilibrium_type), allocatable, intent(out) :: system
    type(state_type), intent(out) :: state
    real(DP), allocatable, intent(out) :: du(:, :) !< the direction to the solution [length]
    type(error_type), allocatable :: error
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    step = model%steps(1)
    call start_blocks(model, system, state)
    state%new%u(:, 20) = [0.01_DP, 0.02_DP, -0.01_DP]
    call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.false.)
    allocate (du, mold=state%new%u)
    call solve_newton_step(system, model, step, state, du, outcome, error)
    if (allocated(error) .or. outcome /= OUTCOME_OK) error stop 'the direction'
  end subroutine disturb


  !> The Newton direction of a linear system: every mode accepts the full step.
  subroutine check_linear_direction(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(line_search_report_type) :: report
    real(DP), allocatable :: du(:, :)
    integer :: i, outcome
    do i = 1, 5
      call disturb(model, step, system, state, du)
      step%line_search = ALL_MODES(i)
      call perform_line_search(system, model, step, du, state%new%slaves, state, report, outcome)
      call suite%that('linear: whole step', outcome == OUTCOME_OK .and. report%is_whole_step .and. &
        abs(report%step_length - 1.0_DP) <= 0.0_DP)
      call suite%near('linear: solved', maxval(abs(state%new%u)), 0.0_DP, 1.0e-12_DP)
      call suite%near('linear: correction', report%correction, 0.02_DP, 1.0e-12_DP)
      call suite%that('linear: downhill', .not. report%is_ascent_direction .and. report%is_displacement_complete)
    end do
  end subroutine check_linear_direction


  !> Directions longer and shorter than Newton's: (LS) finds the inverse of the factor, within s_min and s_max; NONE takes the full
  !! step.
  subroutine check_lengths(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(line_search_report_type) :: report
    real(DP), allocatable :: du(:, :)
    real(DP), parameter :: FACTORS(5) = [2.0_DP, 2.5_DP, 8.0_DP, 0.5_DP, 3.0_DP]
    real(DP), parameter :: LENGTHS(5) = [0.5_DP, 0.4_DP, 0.25_DP, 1.01_DP, 1.0_DP]
    integer, parameter :: MODES(5) = [LINE_SEARCH_ALL, LINE_SEARCH_ALL, LINE_SEARCH_ALL, LINE_SEARCH_ALL, LINE_SEARCH_NONE]
    integer :: i, outcome
    do i = 1, 5
      call disturb(model, step, system, state, du)
      step%line_search = MODES(i)
      call perform_line_search(system, model, step, FACTORS(i) * du, state%new%slaves, state, report, outcome)
      call suite%near('length', report%step_length, LENGTHS(i), 1.0e-9_DP)
      call suite%near('where it leads', norm2(state%new%u(:, 20) - (1.0_DP - LENGTHS(i) * FACTORS(i)) * [0.01_DP, 0.02_DP, &
        -0.01_DP]), 0.0_DP, 1.0e-12_DP)
      call suite%that('whole or not', report%is_whole_step .eqv. MODES(i) == LINE_SEARCH_NONE)
    end do
    call disturb(model, step, system, state, du)
    step%line_search = LINE_SEARCH_ALL
    call perform_line_search(system, model, step, -du, state%new%slaves, state, report, outcome)
    call suite%that('against the imbalance', report%is_ascent_direction)
  end subroutine check_lengths


  !> AUTO without contact: where a material has history, (LS) shortens a step that passed the minimum of the energy by more than its
  !! way to it, below s_min too; never where nothing flows.
  subroutine check_overshoot_by_flow(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(line_search_report_type) :: report
    real(DP), allocatable :: du(:, :)
    real(DP), parameter :: FACTORS(4) = [1.9_DP, 2.5_DP, 3.9_DP, 40.0_DP]
    real(DP), parameter :: LENGTHS(4) = [1.0_DP, 1.0_DP / 2.5_DP, 1.0_DP / 3.9_DP, 1.0_DP / 40.0_DP]
    integer :: i, n_history, outcome
    do n_history = 0, 1
      do i = 1, 4
        call disturb(model, step, system, state, du)
        model%materials%n_history = n_history
        call perform_line_search(system, model, step, FACTORS(i) * du, state%new%slaves, state, report, outcome)
        call suite%near('overshoot: length', report%step_length, merge(LENGTHS(i), 1.0_DP, n_history > 0), 1.0e-9_DP)
      end do
    end do
  end subroutine check_overshoot_by_flow


  !> While prescribed displacements are incomplete, merits cannot be compared: the full step is taken, and completes them.
  subroutine check_missing_displacements(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    type(line_search_report_type) :: report
    real(DP), allocatable :: du(:, :)
    integer :: i, outcome
    do i = 1, 5
      call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, 0.03_DP])
      model%steps(1)%line_search = ALL_MODES(i)
      call start_blocks(model, system, state)
      allocate (du, mold=state%new%u)
      call solve_newton_step(system, model, model%steps(1), state, du, outcome, error)
      call perform_line_search(system, model, model%steps(1), du, state%new%slaves, state, report, outcome)
      call suite%that('missing: whole step', report%is_whole_step .and. report%is_displacement_complete)
      call suite%near('missing: arrived', maxval(abs(state%new%u(3, 35:) - 0.03_DP)), 0.0_DP, 1.0e-14_DP)
      call suite%that('missing: no word about ascent', .not. report%is_ascent_direction)
      deallocate (du)
    end do
  end subroutine check_missing_displacements


  !> A node that would invert its element: the step is halved until no element is inverted, and fails after four halvings.
  subroutine check_inverted_elements(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    type(line_search_report_type) :: report
    real(DP), allocatable :: du(:, :)
    integer :: i, outcome
    do i = 1, 2
      call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, 0.0_DP])
      model%steps(1)%is_nlgeom = .true.
      model%steps(1)%line_search = LINE_SEARCH_NONE
      step = model%steps(1)
      call start_blocks(model, system, state)
      call linearize_equilibrium(system, model, step, state, outcome, error)
      allocate (du, mold=state%new%u)
      du = 0.0_DP
      du(3, 19:34) = merge(2.2_DP, 100.0_DP, i == 1)   ! the bottom of the upper block beyond its top
      call perform_line_search(system, model, step, du, state%new%slaves, state, report, outcome)
      if (i == 1) call suite%that('inverted: a shorter step', outcome == OUTCOME_OK .and. .not. report%is_whole_step .and. &
        report%step_length < 0.5_DP)
      if (i == 2) call suite%that('inverted: given up', outcome == OUTCOME_ELEMENT)
      deallocate (du)
    end do
  end subroutine check_inverted_elements


  !> Nodes that close and open along a direction are counted.
  subroutine check_counts(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    type(line_search_report_type) :: report
    real(DP), allocatable :: du(:, :)
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.05_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    model%steps(1)%line_search = LINE_SEARCH_NONE
    step = model%steps(1)
    call start_blocks(model, system, state)
    call linearize_equilibrium(system, model, step, state, outcome, error)
    allocate (du, mold=state%new%u)
    du = 0.0_DP
    du(3, 19:34) = -0.06_DP
    call perform_line_search(system, model, step, du, state%new%slaves, state, report, outcome)
    call suite%that('counts: all close', report%n_closed == 16 .and. report%n_newly_opened == 0)
    call suite%near('counts: correction', report%correction, 0.06_DP, 1.0e-14_DP)
    call perform_line_search(system, model, step, -10 * du, state%new%slaves, state, report, outcome)
    call suite%that('counts: all open', report%n_newly_opened == 16 .and. report%n_closed == 0 .and. &
      all(state%new%slaves%status == STATUS_OPEN))
  end subroutine check_counts


  include 'sample_blocks.inc'

end program test_line_search
