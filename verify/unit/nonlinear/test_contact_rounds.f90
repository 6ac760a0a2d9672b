!> Tests of the rounds of contact around conjugate gradients: two blocks pressed, dragged and lowered, against Newton's method.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_rounds
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_controls, only: controls_type, PRECONDITIONER_NODAL, PRECONDITIONER_FACTOR
  use amontons_steps, only: step_type, SOLVER_GRADIENTS, LINE_SEARCH_ALL, LINE_SEARCH_NODAL
  use amontons_state, only: state_type
  use amontons_convergence, only: VERDICT_CONTINUE, VERDICT_CONVERGED, VERDICT_TOO_SLOW
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_newton, only: newton_type, begin_newton, iterate
  use amontons_contact_rounds, only: round_controls, comparable_iterations
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_against_newton(suite, 'pressed', 0.5_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.02_DP])
  call check_against_newton(suite, 'dragged', 0.2_DP, 0.0_DP, [0.1_DP, 0.0_DP, -0.02_DP])
  call check_against_newton(suite, 'between stick and slip', 0.5_DP, 0.0_DP, [0.008_DP, 0.003_DP, -0.02_DP])
  call check_against_newton(suite, 'a gap that closes', 0.5_DP, 0.05_DP, [0.0_DP, 0.0_DP, -0.07_DP])
  call check_modes(suite)
  call check_controls(suite)
  call suite%finish()

contains

  !> Iterations or rounds until the verdict is not to continue.
  subroutine run(model, newton, system, state, verdict)
    type(model_type), intent(in) :: model
    type(newton_type), intent(out) :: newton
    type(equilibrium_type), allocatable, intent(out) :: system
    type(state_type), intent(out) :: state
    integer, intent(out) :: verdict
    type(error_type), allocatable :: error
    call start_blocks(model, system, state)
    call begin_newton(newton, system, model, model%steps(1), .true., state)
    do
      call iterate(newton, system, model, model%steps(1), state, verdict, error)
      if (allocated(error)) error stop 'an iteration'
      if (verdict /= VERDICT_CONTINUE) exit
    end do
  end subroutine run


  !> Displacements, statuses and forces are those of Newton's method, whatever the preconditioner; nothing stays held.
  subroutine check_against_newton(suite, name, mu, gap, motion)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: name
    real(DP), intent(in) :: mu, gap, motion(3)
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: exact, state
    integer :: verdict, kind
    call two_blocks(model, mu, gap, motion)
    call run(model, newton, system, exact, verdict)
    call suite%that(name // ': Newton converges', verdict == VERDICT_CONVERGED)
    model%steps(1)%solver = SOLVER_GRADIENTS
    do kind = PRECONDITIONER_NODAL, PRECONDITIONER_FACTOR, PRECONDITIONER_FACTOR - PRECONDITIONER_NODAL
      model%steps(1)%controls%gradients%preconditioner = kind
      call run(model, newton, system, state, verdict)
      call suite%that(name // ': converged', verdict == VERDICT_CONVERGED)
      call suite%near(name // ': displacements', maxval(abs(state%new%u - exact%new%u)), 0.0_DP, &
        1.0e-5_DP * maxval(abs(exact%new%u)))
      call suite%that(name // ': statuses', all(state%new%slaves%status == exact%new%slaves%status))
      call suite%that(name // ': evaluated in full', .not. (allocated(system%contact%held_friction) .or. &
        allocated(system%contact%held_limit)))
      call suite%that(name // ': counted', newton%rounds%n_iterations == system%n_krylov .and. &
        system%n_evaluations >= newton%rounds%n_iterations .and. newton%record%iteration == newton%rounds%n_rounds)
    end do
  end subroutine check_against_newton


  !> One length and a length for each slave node end at the same solution: all nodes stick or begin to slip.
  subroutine check_modes(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: MODES(2) = [LINE_SEARCH_ALL, LINE_SEARCH_NODAL]
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: exact, state
    integer :: verdict, i
    call two_blocks(model, 0.5_DP, 0.0_DP, [0.008_DP, 0.003_DP, -0.02_DP])
    call run(model, newton, system, exact, verdict)
    model%steps(1)%solver = SOLVER_GRADIENTS
    do i = 1, size(MODES)
      model%steps(1)%line_search = MODES(i)
      call run(model, newton, system, state, verdict)
      call suite%that('modes: converged', verdict == VERDICT_CONVERGED)
      call suite%near('modes: displacements', maxval(abs(state%new%u - exact%new%u)), 0.0_DP, 1.0e-5_DP * maxval(abs(exact%new%u)))
    end do
  end subroutine check_modes


  !> Limits of the rounds, and of the iterations in all of them.
  subroutine check_controls(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(controls_type) :: controls
    integer :: verdict
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.1_DP, 0.0_DP, -0.02_DP])
    model%steps(1)%solver = SOLVER_GRADIENTS
    controls = round_controls(model%steps(1))
    call suite%that('controls: rounds', controls%i_c == model%steps(1)%controls%gradients%max_rounds .and. &
      controls%i_0 == controls%i_c)                ! no test of divergence
    call suite%that('controls: a full attempt', comparable_iterations(model%steps(1), &
      model%steps(1)%controls%gradients%max_rounds) == model%steps(1)%controls%i_c)
    model%steps(1)%controls%gradients%max_iterations = 3
    call run(model, newton, system, state, verdict)
    call suite%that('controls: iterations', verdict == VERDICT_TOO_SLOW .and. newton%rounds%n_iterations == 3)
    model%steps(1)%controls%gradients%max_iterations = 1000
    model%steps(1)%controls%gradients%max_rounds = 1
    call run(model, newton, system, state, verdict)
    call suite%that('controls: one round', verdict == VERDICT_TOO_SLOW .and. newton%measures%iteration == 1)
  end subroutine check_controls


  include 'sample_blocks.inc'

end program test_contact_rounds
