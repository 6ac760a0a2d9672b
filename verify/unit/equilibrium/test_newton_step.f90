!> Tests of the Newton step: the tangent against differences, the direction against the tangent, shifts and partial corrections.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_newton_step
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_SLIP
  use amontons_sparse, only: sparse_type, multiply, multiply_transpose
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    OUTCOME_OK
  use amontons_newton_step, only: solve_newton_step, solve_correction, linearize_equilibrium, set_proximal_shift
  use amontons_tangent_solution, only: apply_unconstrained_tangent, assemble_tangent_matrix
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_tangent(suite)
  call check_direction(suite, .true.)
  call check_direction(suite, .false.)
  call check_shift(suite)
  call check_correction(suite)
  call suite%finish()

contains

  !> Blocks pressed and sheared, their nodes slipping, NLGEOM; linearised there.
  subroutine pressed_blocks(model, system, state)
    type(model_type), intent(out) :: model
    type(equilibrium_type), allocatable, intent(out) :: system
    type(state_type), intent(out) :: state
    type(error_type), allocatable :: error
    integer :: n, pass, outcome
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.05_DP, 0.02_DP, -0.04_DP])
    model%steps(1)%is_nlgeom = .true.
    call start_blocks(model, system, state)
    do n = 19, model%mesh%n_nodes
      state%new%u(:, n) = [0.06_DP, 0.03_DP, merge(-0.06_DP, 0.0_DP, n > 34)]
      state%new%u(1, n) = state%new%u(1, n) + 0.004_DP * sin(real(n, DP))
    end do
    state%new%slaves%status = STATUS_SLIP
    do pass = 1, 2                                 ! the stiffness at the nodes is known after the first
      call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.true.)
      call linearize_equilibrium(system, model, model%steps(1), state, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) error stop 'linearised'
    end do
  end subroutine pressed_blocks


  !> (K - dF_c) du against central differences of the residual, at unknowns without support.
  subroutine check_tangent(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state, there
    real(DP), allocatable :: du(:, :), w(:), difference(:, :), ahead(:, :)
    real(DP), parameter :: H = 1.0e-6_DP
    integer :: i, outcome
    call pressed_blocks(model, system, state)
    call suite%that('tangent: slave nodes are closed', count(state%new%slaves%status /= STATUS_OPEN) > 4)
    allocate (du, mold=state%new%u)
    du = 0.0_DP
    do i = 10, 34                                  ! the nodes of both faces in contact
      du(:, i) = [sin(real(i, DP)), cos(real(2 * i, DP)), sin(real(3 * i, DP))]
    end do
    allocate (w(size(du)))
    call apply_unconstrained_tangent(system, reshape(du, [size(du)]), w)
    there = state
    there%new%u = state%new%u + H * du
    call evaluate_equilibrium(system, model, model%steps(1), there, outcome, is_frozen=.true.)
    ahead = system%residual
    there = state
    there%new%u = state%new%u - H * du
    call evaluate_equilibrium(system, model, model%steps(1), there, outcome, is_frozen=.true.)
    difference = (ahead - system%residual) / (2 * H)
    ahead = reshape(w, shape(du)) + difference
    call suite%near('tangent: minus the change of the residual', maxval(abs(ahead(:, 10:34))), 0.0_DP, &
      1.0e-5_DP * maxval(abs(difference)))
  end subroutine check_tangent


  !> C' (R - (K - dF_c) du) = 0 for the direction, with and without the condensed interface; the tangent matrix equals the operator.
  subroutine check_direction(suite, has_interface)
    type(suite_type), intent(inout) :: suite
    logical, intent(in) :: has_interface
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(sparse_type) :: J
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), w(:), left(:), v(:), product(:), all_v(:)
    integer :: outcome, i
    call pressed_blocks(model, system, state)
    system%is_schur_allowed = has_interface
    allocate (du, mold=state%new%u)
    call solve_newton_step(system, model, model%steps(1), state, du, outcome, error)
    call suite%that('direction: found', outcome == OUTCOME_OK .and. .not. allocated(error))
    call suite%that('direction: by the requested interface', system%has_interface_solver .eqv. has_interface)
    call suite%near('direction: the supports arrive', maxval(abs(state%new%u(3, 35:) + du(3, 35:) + 0.04_DP)), 0.0_DP, 1.0e-14_DP)
    call suite%that('direction: factorisations are counted', system%n_factorisations >= 1)
    associate (C => system%constraints%transformation, n => system%constraints%n_free)
      allocate (w(size(du)), all_v(size(du)), left(n), product(n))
      call apply_unconstrained_tangent(system, reshape(du, [size(du)]), w)
      call multiply_transpose(C, reshape(system%residual_at_gap, shape(w)) - w, left)
      call suite%near('direction: nothing is left', maxval(abs(left)), 0.0_DP, 1.0e-7_DP * system%largest_force)
      call assemble_tangent_matrix(system, J, error)
      v = [(sin(real(i * i, DP)), i=1, n)]
      call multiply(J, v, product)
      call multiply(C, v, all_v)
      call apply_unconstrained_tangent(system, all_v, w)
      call multiply_transpose(C, w, left)
      call suite%near('direction: matrix and operator', maxval(abs(left - product)), 0.0_DP, 1.0e-12_DP * maxval(abs(product)))
    end associate
  end subroutine check_direction


  !> A shift adds to each node a fraction of its own mean stiffness; a shift of zero removes it.
  subroutine check_shift(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    real(DP), allocatable :: plain(:), shifted(:)
    integer, allocatable :: diagonal(:)
    integer :: outcome
    call pressed_blocks(model, system, state)
    diagonal = system%assembly%stiffness%first(:3 * model%mesh%n_nodes)
    plain = system%assembly%stiffness%value
    call set_proximal_shift(system, model, state%new, 0.25_DP)
    call linearize_equilibrium(system, model, model%steps(1), state, outcome, error)
    shifted = system%assembly%stiffness%value - plain
    call suite%near('shift: a part of the mean', maxval(abs(shifted(diagonal(1:3)) - 0.25_DP * sum(plain(diagonal(1:3))) / 3)), &
      0.0_DP, 1.0e-12_DP * maxval(plain))
    call suite%near('shift: in all', sum(shifted(diagonal)), 0.25_DP * sum(plain(diagonal)), 1.0e-12_DP * sum(plain(diagonal)))
    shifted(diagonal) = 0.0_DP
    call suite%near('shift: on the diagonal alone', maxval(abs(shifted)), 0.0_DP, 0.0_DP)
    call suite%that('shift: no factor of before', .not. system%schur_interface%is_ready)
    call set_proximal_shift(system, model, state%new, 0.0_DP)
    call linearize_equilibrium(system, model, model%steps(1), state, outcome, error)
    call suite%near('shift: taken away', maxval(abs(system%assembly%stiffness%value - plain)), 0.0_DP, 0.0_DP)
  end subroutine check_shift


  !> A correction applies the given fraction of the remaining prescribed displacements, none with 0; it needs the interface.
  subroutine check_correction(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :)
    real(DP) :: missing
    integer :: outcome, i
    call pressed_blocks(model, system, state)
    allocate (du, mold=state%new%u)
    missing = -0.04_DP - state%new%u(3, 40)
    do i = 0, 2
      call solve_correction(system, model, model%steps(1), state, 0.5_DP * real(i, DP), du, outcome, error)
      call suite%that('correction: found', outcome == OUTCOME_OK .and. .not. allocated(error))
      call suite%near('correction: its part of the way', du(3, 40), 0.5_DP * real(i, DP) * missing, 1.0e-14_DP)
    end do
    system%is_schur_allowed = .false.
    call solve_correction(system, model, model%steps(1), state, 1.0_DP, du, outcome, error)
    call suite%that('correction: none without the interface', outcome /= OUTCOME_OK .and. .not. allocated(error))
  end subroutine check_correction


  include 'sample_blocks.inc'

end program test_newton_step
