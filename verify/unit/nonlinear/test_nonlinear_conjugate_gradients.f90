!> Tests of conjugate gradients with contact held: each preconditioner solves a linear system; a body
!! without support ends the attempt.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_nonlinear_conjugate_gradients
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_controls, only: PRECONDITIONER_NODAL, PRECONDITIONER_DIAGONAL, PRECONDITIONER_TWO_LEVEL, PRECONDITIONER_FACTOR
  use amontons_steps, only: step_type, SOLVER_GRADIENTS
  use amontons_state, only: state_type, slave_state_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    OUTCOME_OK
  use amontons_newton_step, only: linearize_equilibrium
  use amontons_conjugate_gradient_preconditioner, only: gradient_preconditioner_type, update_gradient_preconditioner
  use amontons_nonlinear_conjugate_gradients, only: gradient_report_type, solve_held_equilibrium, evaluate_held
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_linear(suite, PRECONDITIONER_NODAL, 60)
  call check_linear(suite, PRECONDITIONER_DIAGONAL, 80)
  call check_linear(suite, PRECONDITIONER_TWO_LEVEL, 40)
  call check_linear(suite, PRECONDITIONER_FACTOR, 2)
  call suite%finish()

contains

  !> Blocks far from each other, the supports of the upper one lowered by 0.02: each block moves as a whole, without a residual. The
  !! factor needs one iteration, the other preconditioners fewer than there are unknowns.
  subroutine check_linear(suite, kind, most)
    type(suite_type), intent(inout) :: suite
    integer, intent(in) :: kind                    !< PRECONDITIONER_...
    integer, intent(in) :: most                    !< iterations
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(gradient_preconditioner_type) :: preconditioner
    type(gradient_report_type) :: report
    type(error_type), allocatable :: error
    type(slave_state_type), allocatable :: slaves(:)
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, -0.02_DP])
    model%steps(1)%solver = SOLVER_GRADIENTS
    model%steps(1)%controls%gradients%preconditioner = kind
    call start_blocks(model, system, state)
    call suite%that('linear: a matrix where it is needed', (kind >= PRECONDITIONER_TWO_LEVEL) .eqv. &
      allocated(system%assembly%stiffness%value))
    call linearize_equilibrium(system, model, model%steps(1), state, outcome, error)
    if (allocated(error) .or. outcome /= OUTCOME_OK) error stop 'the linearization'
    call update_gradient_preconditioner(preconditioner, system, model, model%steps(1), .true., outcome, error)
    if (allocated(error) .or. outcome /= OUTCOME_OK) error stop 'the preconditioner'
    slaves = state%new%slaves
    call evaluate_held(system, model, model%steps(1), slaves, reshape(system%constraints%offset, shape(state%new%u)), state, &
      outcome)
    call suite%that('linear: not in equilibrium', system%largest_residual > 1.0e-3_DP)
    call solve_held_equilibrium(system, model, model%steps(1), preconditioner, 1.0e-6_DP, 1.0_DP, 200, state, report)
    call suite%that('linear: solved', report%outcome == OUTCOME_OK .and. .not. report%is_interrupted)
    call suite%that('linear: iterations', report%n_iterations >= 1 .and. report%n_iterations <= most)
    call suite%near('linear: moved as a whole', maxval(abs(state%new%u(3, 19:) + 0.02_DP)), 0.0_DP, 1.0e-6_DP)
    call suite%near('linear: no force', system%largest_residual, 0.0_DP, 1.0e-6_DP)
  end subroutine check_linear


  include 'sample_blocks.inc'

end program test_nonlinear_conjugate_gradients
