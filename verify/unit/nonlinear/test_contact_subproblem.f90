!> Tests of the contact subproblem: with linear blocks its solution is the solution of the increment.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_subproblem
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_loads, only: concentrated_type
  use amontons_steps, only: step_type, LINE_SEARCH_AUTO, LINE_SEARCH_ALL
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN, STATUS_SLIP
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    OUTCOME_OK
  use amontons_newton_step, only: solve_newton_step
  use amontons_contact_subproblem, only: solve_contact_subproblem
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_solution(suite, 'stick', 1.0_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.02_DP])
  call check_solution(suite, 'slip', 0.1_DP, 0.0_DP, [0.1_DP, 0.05_DP, -0.02_DP])
  call check_solution(suite, 'closes', 0.3_DP, 0.01_DP, [0.02_DP, 0.0_DP, -0.03_DP])
  call check_left_alone(suite)
  call check_corrections(suite)
  call check_statuses(suite)
  call check_substeps(suite)
  call suite%finish()

contains

  !> The first direction of an increment, at the start of it.
  subroutine first_direction(model, system, state, du)
    type(model_type), intent(in) :: model
    type(equilibrium_type), allocatable, intent(out) :: system
    type(state_type), intent(out) :: state
    real(DP), allocatable, intent(out) :: du(:, :) !< [length]
    type(error_type), allocatable :: error
    integer :: outcome
    call start_blocks(model, system, state)
    allocate (du, mold=state%new%u)
    call solve_newton_step(system, model, model%steps(1), state, du, outcome, error)
    if (allocated(error) .or. outcome /= OUTCOME_OK) error stop 'the direction'
  end subroutine first_direction


  !> The blocks are linear: where contact is solved at the end of the direction, u + du is the solution. The state stays at u.
  subroutine check_solution(suite, name, friction, gap, push)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: name
    real(DP), intent(in) :: friction, gap, push(3)
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), u(:, :), residual(:, :)
    real(DP) :: merit
    integer :: outcome
    call two_blocks(model, friction, gap, push)
    call first_direction(model, system, state, du)
    call suite%that(name // ': by the interface', system%has_interface_solver .or. gap > 0.0_DP)
    u = state%new%u
    residual = system%residual
    merit = system%merit
    call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
    call suite%that(name // ': solved', system%is_subproblem_solved .and. .not. allocated(error))
    call suite%near(name // ': the state is where it was', norm2(state%new%u - u), 0.0_DP, 0.0_DP)
    call suite%near(name // ': with its residual', norm2(system%residual - residual) + abs(system%merit - merit), 0.0_DP, 0.0_DP)
    state%new%u = u + du
    state%new%slaves = slaves
    call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.false.)
    call suite%that(name // ': no status changes at its end', system%contact%n_changed == 0)
    call suite%near(name // ': in balance at its end', system%largest_residual, 0.0_DP, 1.0e-2_DP * system%largest_force)
    call suite%near(name // ': the supports have arrived', maxval(abs(state%new%u(3, 35:) - push(3))), 0.0_DP, 1.0e-12_DP)
    call suite%that(name // ': contact is active', any(state%new%slaves%status /= STATUS_OPEN))
    if (name == 'slip') call suite%that('slip: nodes slip', count(state%new%slaves%status == STATUS_SLIP) > 4)
  end subroutine check_solution


  !> Line searches other than AUTO see the direction as it is, and so does AUTO without the condensed interface.
  subroutine check_left_alone(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), before(:, :)
    call two_blocks(model, 0.1_DP, 0.0_DP, [0.1_DP, 0.05_DP, -0.02_DP])
    call first_direction(model, system, state, du)
    before = du
    model%steps(1)%line_search = LINE_SEARCH_ALL
    call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
    call suite%near('another line search: the direction as it was', norm2(du - before), 0.0_DP, 0.0_DP)
    call suite%that('another line search: the slaves as they were', size(slaves) == 16 .and. &
      all(slaves%status == state%new%slaves%status))
    model%steps(1)%line_search = LINE_SEARCH_AUTO
    system%has_interface_solver = .false.
    call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
    call suite%near('no interface: the direction as it was', norm2(du - before), 0.0_DP, 0.0_DP)
    call suite%that('no interface: nothing was corrected', system%n_subproblem_iterations == 0 .and. &
      .not. system%is_subproblem_solved)
  end subroutine check_left_alone


  !> Corrections are counted; a second run from the corrected direction needs few.
  subroutine check_corrections(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), corrected(:, :)
    integer :: n
    call two_blocks(model, 0.1_DP, 0.0_DP, [0.1_DP, 0.05_DP, -0.02_DP])
    call first_direction(model, system, state, du)
    call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
    n = system%n_subproblem_iterations
    call suite%that('corrections: some were made', n > 0 .and. n <= 90)
    corrected = du
    state%new%slaves = slaves
    call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
    call suite%that('corrections: fewer from there', system%n_subproblem_iterations - n < n)
    call suite%near('corrections: the same end', norm2(du - corrected), 0.0_DP, 1.0e-3_DP * norm2(du))
  end subroutine check_corrections


  !> A merit within its tolerance does not end the corrections while statuses change.
  subroutine check_statuses(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :)
    integer :: outcome
    call loaded_blocks(model)
    model%steps(1)%controls%subproblem%tolerance = 1.0e6_DP
    call first_direction(model, system, state, du)
    call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
    call suite%that('statuses: corrected although the merit is admissible', system%n_subproblem_iterations > 0)
    state%new%u = state%new%u + du
    state%new%slaves = slaves
    call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.false.)
    call suite%that('statuses: none changes at the end', system%is_subproblem_solved .and. system%contact%n_changed == 0)
  end subroutine check_statuses


  !> Where the whole direction takes more corrections than allowed, substeps end at the same solution; where they fail too, the
  !! subproblem is reported as unsolved.
  subroutine check_substeps(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), whole(:, :)
    integer :: limit, max_substep(2)
    call loaded_blocks(model)
    call first_direction(model, system, state, du)
    call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
    whole = du
    max_substep = [12, 3]                          ! corrections of a substep; the second starts with the whole and halves it
    do limit = 1, 2
      call loaded_blocks(model)
      model%steps(1)%controls%subproblem%max_iterations = 1
      model%steps(1)%controls%subproblem%max_iterations_per_substep = max_substep(limit)
      if (limit == 2) model%steps(1)%controls%subproblem%initial_substep = 1.0_DP
      call first_direction(model, system, state, du)
      call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
      call suite%that('substeps: solved', system%is_subproblem_solved .and. .not. allocated(error))
      call suite%near('substeps: the same solution', norm2(du - whole), 0.0_DP, 1.0e-3_DP * norm2(whole))
      call suite%that('substeps: so many corrections', system%n_subproblem_iterations == merge(8, 4, limit == 1))
      call suite%near('substeps: the supports have arrived', maxval(abs(state%new%u(3, 35:) + du(3, 35:) + 0.02_DP)), 0.0_DP, &
        1.0e-12_DP)
    end do
    call loaded_blocks(model)
    model%steps(1)%controls%subproblem%max_iterations = 1
    model%steps(1)%controls%subproblem%max_iterations_all_substeps = 1
    call first_direction(model, system, state, du)
    call solve_contact_subproblem(system, model, model%steps(1), state, du, slaves, error)
    call suite%that('substeps: too few are reported', .not. system%is_subproblem_solved .and. .not. allocated(error))
  end subroutine check_substeps


  !> The sliding blocks with a force on the slave surface from the start: the increment begins with an imbalance.
  subroutine loaded_blocks(model)
    type(model_type), intent(out) :: model
    integer :: i
    call two_blocks(model, 0.1_DP, 0.0_DP, [0.1_DP, 0.05_DP, -0.02_DP])
    model%steps(1)%concentrated = [(concentrated_type(start=-0.05_DP, end=-0.05_DP, node=18 + i, dof=1 + 2 * mod(i, 2)), i=1, 16)]
  end subroutine loaded_blocks


  include 'sample_blocks.inc'

end program test_contact_subproblem
