!> Tests of Newton: two blocks pressed on each other have a closed solution; iterations, verdicts and failures on the way.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_newton
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_convergence, only: VERDICT_CONTINUE, VERDICT_CONVERGED, VERDICT_DIVERGES, VERDICT_TOO_SLOW
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    OUTCOME_OK, OUTCOME_UNSUPPORTED, OUTCOME_TUNNELLING
  use amontons_newton, only: newton_type, begin_newton, iterate
  use amontons_active_set_history, only: record_active_set
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_FROZEN, NODE_OVERRIDE_OFF_MASTER
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_pressed(suite)
  call check_sliding(suite)
  call check_gap(suite)
  call check_limits(suite)
  call check_cycle(suite)
  call check_tunnelling(suite)
  call check_forcing_term(suite)
  call suite%finish()

contains

  !> Iterations until the verdict is not to continue.
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


  !> Pressed straight down: all slave nodes stick, top and bottom are in balance. Poisson's ratio is 0, so that the force lies
  !! between that of two columns of the smaller area and of the larger one: 100 * 0.02 / 2 times 2.56 and 5.76.
  subroutine check_pressed(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    integer :: verdict
    real(DP) :: top, bottom
    call two_blocks(model, 0.5_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.02_DP])
    call run(model, newton, system, state, verdict)
    call suite%that('pressed: converged', verdict == VERDICT_CONVERGED .and. newton%outcome == OUTCOME_OK)
    call suite%that('pressed: in a few iterations', newton%measures%iteration <= 6)
    call suite%that('pressed: the record is that of the last iteration', newton%record%iteration == newton%measures%iteration &
      .and. newton%record%n_closed == count(state%new%slaves%status /= STATUS_OPEN))
    call suite%that('pressed: all are closed', all(state%new%slaves%status /= STATUS_OPEN))
    top = sum(state%new%reaction_force(3, 35:50))
    bottom = sum(state%new%reaction_force(3, 1:9))
    call suite%near('pressed: forces in balance', top + bottom, 0.0_DP, 1.0e-6_DP * abs(top))
    call suite%near('pressed: contact passes them on', sum(state%new%slaves%force(3)), bottom, 1.0e-6_DP * bottom)
    call suite%that('pressed: between the columns', bottom > 2.56_DP .and. bottom < 5.76_DP)
    call suite%near('pressed: no gap', maxval(abs(state%new%slaves%gap)), 0.0_DP, 1.0e-9_DP)
    call suite%that('pressed: the force is kept as the scale', newton%force_scale >= system%largest_force)
  end subroutine check_pressed


  !> Dragged far beyond friction: every node slips, and the shear is mu times the pressure.
  subroutine check_sliding(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    integer :: verdict
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.1_DP, 0.0_DP, -0.02_DP])
    call run(model, newton, system, state, verdict)
    call suite%that('sliding: converged', verdict == VERDICT_CONVERGED)
    call suite%that('sliding: all that are closed slip', all(state%new%slaves%status /= STATUS_STICK) .and. &
      count(state%new%slaves%status == STATUS_SLIP) > 4)
    call suite%near('sliding: shear over force', norm2(state%new%slaves%shear(1)) / norm2(state%new%slaves%force(3)), 0.2_DP, &
      1.0e-2_DP)
    call suite%near('sliding: the top is dragged by it', sum(state%new%reaction_force(1, 35:50)), &
      -sum(state%new%slaves%shear(1)), 1.0e-5_DP)
    call suite%that('sliding: friction acts against the slip', all(state%new%slaves%shear(1) <= 0.0_DP))
  end subroutine check_sliding


  !> A gap that is not closed: the block moves as a whole, without a force; one that is closed on the way presses by what is left.
  subroutine check_gap(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    integer :: verdict
    real(DP) :: force
    call two_blocks(model, 0.5_DP, 0.05_DP, [0.0_DP, 0.0_DP, -0.02_DP])
    call run(model, newton, system, state, verdict)
    call suite%that('gap: converged', verdict == VERDICT_CONVERGED)
    call suite%that('gap: open', all(state%new%slaves%status == STATUS_OPEN))
    call suite%near('gap: moved as a whole', maxval(abs(state%new%u(3, 19:) + 0.02_DP)), 0.0_DP, 1.0e-12_DP)
    call suite%near('gap: what is left of it', minval(state%new%slaves%gap), 0.03_DP, 1.0e-12_DP)
    call two_blocks(model, 0.5_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.02_DP])
    call run(model, newton, system, state, verdict)
    force = sum(state%new%reaction_force(3, 1:9))
    call two_blocks(model, 0.5_DP, 0.05_DP, [0.0_DP, 0.0_DP, -0.07_DP])
    call run(model, newton, system, state, verdict)
    call suite%that('closed gap: converged', verdict == VERDICT_CONVERGED)
    call suite%near('closed gap: pressed as without it', sum(state%new%reaction_force(3, 1:9)), force, 1.0e-3_DP * force)
  end subroutine check_gap


  !> The last iteration allowed, and an outcome that ends the attempt before it begins.
  subroutine check_limits(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    integer :: verdict
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.1_DP, 0.0_DP, -0.02_DP])
    model%steps(1)%controls%i_c = 1
    model%steps(1)%is_nlgeom = .true.
    call run(model, newton, system, state, verdict)
    call suite%that('limit: too slow after one iteration', verdict == VERDICT_TOO_SLOW .and. newton%measures%iteration == 1)
    newton%outcome = OUTCOME_UNSUPPORTED
    call iterate(newton, system, model, model%steps(1), state, verdict, error)
    call suite%that('limit: nothing is done after a trouble', verdict == VERDICT_DIVERGES .and. newton%measures%iteration == 1)
    call begin_newton(newton, system, model, model%steps(1), .true., state)
    call suite%that('limit: a new attempt begins anew', newton%measures%iteration == 0 .and. newton%outcome == OUTCOME_OK .and. &
      newton%active_set_history%n == 1)
    call two_blocks(model, 0.5_DP, 0.05_DP, [0.0_DP, 0.0_DP, -1.0e4_DP])
    model%steps(1)%controls%i_c = 50
    call run(model, newton, system, state, verdict)
    call suite%that('limit: a motion of many sizes of the model', verdict == VERDICT_DIVERGES .and. &
      newton%outcome == OUTCOME_UNSUPPORTED .and. newton%farthest_node > 0)
  end subroutine check_limits


  !> Statuses that return without a smaller merit: the cycle is counted, and the iteration continues with the node frozen.
  subroutine check_cycle(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state, other
    type(error_type), allocatable :: error
    integer :: verdict, i
    call two_blocks(model, 5.0_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.3_DP])
    model%steps(1)%is_nlgeom = .true.                ! the second iteration does not converge yet
    call start_blocks(model, system, state)
    call begin_newton(newton, system, model, model%steps(1), .true., state)
    call iterate(newton, system, model, model%steps(1), state, verdict, error)
    other = state
    other%new%slaves(5)%status = STATUS_SLIP
    do i = 1, 2
      call record_active_set(newton%active_set_history, other%new%slaves, 0.0_DP)
      call record_active_set(newton%active_set_history, state%new%slaves, 0.0_DP)
    end do
    call record_active_set(newton%active_set_history, other%new%slaves, 0.0_DP)
    call suite%that('cycle: none yet', newton%n_cycles_treated == 0)
    call iterate(newton, system, model, model%steps(1), state, verdict, error)
    call suite%that('cycle: counted, and iterated again', newton%n_cycles_treated == 1 .and. verdict == VERDICT_CONTINUE)
    call suite%that('cycle: the node is frozen', state%new%slaves(5)%overrides%status == NODE_OVERRIDE_FROZEN)
  end subroutine check_cycle


  !> Slave nodes that were closed at the start and end deep below their master, without contact: no converged increment.
  subroutine check_tunnelling(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    integer :: verdict
    call two_blocks(model, 0.0_DP, 0.05_DP, [0.0_DP, 0.0_DP, -6.0_DP])
    model%steps(1)%is_nlgeom = .true.
    call start_blocks(model, system, state)
    state%old%slaves = state%new%slaves
    call begin_newton(newton, system, model, model%steps(1), .true., state)
    state%new%slaves%overrides%edge = NODE_OVERRIDE_OFF_MASTER
    state%new%slaves%facet = 0
    do
      call iterate(newton, system, model, model%steps(1), state, verdict, error)
      if (allocated(error) .or. verdict /= VERDICT_CONTINUE) exit
    end do
    call suite%that('tunnelling: no convergence', verdict == VERDICT_DIVERGES .and. newton%outcome == OUTCOME_TUNNELLING)
    call suite%that('tunnelling: a slave node is named', newton%tunnelled_node > 18 .and. newton%tunnelled_node <= 34)
  end subroutine check_tunnelling


  !> Choice 2 of Eisenstat and Walker: the square of the last decrease of the residual, within its limits.
  subroutine check_forcing_term(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(newton_type) :: newton
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    real(DP), parameter :: RESIDUALS(4) = [0.5_DP, 0.05_DP, 1.0e-5_DP, 2.0_DP], &
      EXPECTED(4) = [1.0e-2_DP, 2.5e-3_DP, 1.0e-6_DP, 1.0e-2_DP]
    integer :: verdict, i
    call two_blocks(model, 0.5_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.02_DP])
    call start_blocks(model, system, state)
    do i = 1, 4
      call begin_newton(newton, system, model, model%steps(1), .true., state)
      newton%measures%residual(0) = RESIDUALS(i)
      newton%measures%residual(1) = 1.0_DP
      call iterate(newton, system, model, model%steps(1), state, verdict, error)
      call suite%near('forcing term', system%forcing_term, EXPECTED(i), 1.0e-12_DP)
    end do
  end subroutine check_forcing_term


  include 'sample_blocks.inc'

end program test_newton
