!> Tests of equilibrium: two blocks against forces known by hand, the linearised evaluation, norms, and restored configurations.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_equilibrium
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, STATUS_OPEN
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    directional_residual, residual_sizes, max_components, nodal_norms, configuration_type, save_configuration, &
    evaluate_linearized, restore_configuration, discard_bulk_factor, interface_unknowns, OUTCOME_OK, &
    OUTCOME_ELEMENT, OUTCOME_NOT_FINITE
  use amontons_newton_step, only: linearize_equilibrium
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_forces(suite)
  call check_outcomes(suite)
  call check_norms(suite)
  call check_forecast(suite)
  call check_interface(suite)
  call suite%finish()

contains

  !> The upper block shortened by 1 %: E A 0.01 at its top, and the same as residual at its free bottom.
  subroutine check_forces(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    real(DP), parameter :: FORCE = 100 * 2.56_DP * 0.01_DP
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, -0.01_DP])
    call start_blocks(model, system, state)
    state%new%u(3, 35:) = -0.01_DP
    call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.false.)
    call suite%that('forces: evaluated', outcome == OUTCOME_OK)
    call suite%near('forces: at the top', sum(state%new%internal_force(3, 35:)), -FORCE, 1.0e-12_DP)
    call suite%near('forces: of the supports there', sum(state%new%reaction_force(3, 35:)), -FORCE, 1.0e-12_DP)
    call suite%near('forces: out of balance at the bottom', sum(system%residual(3, 19:34)), -FORCE, 1.0e-12_DP)
    call suite%near('forces: none where supports hold', maxval(abs(system%residual(:, 35:))), 0.0_DP, 0.0_DP)
    call suite%near('forces: the largest', system%largest_force, FORCE / 9, 1.0e-12_DP)
    call suite%near('forces: merit', system%merit, norm2(system%residual), 1.0e-13_DP)
    call suite%near('forces: product with a direction', directional_residual(system, state%new%u * 0 + 2.0_DP), -2 * FORCE, &
      1.0e-12_DP)
    call suite%that('forces: all slaves are open', all(state%new%slaves%status == STATUS_OPEN))
  end subroutine check_forces


  !> An inverted element is reported with its number; so is a displacement that is NaN.
  subroutine check_outcomes(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, -0.01_DP])
    model%steps(1)%is_nlgeom = .true.
    call start_blocks(model, system, state)
    state%new%u(3, [19, 20, 23, 24]) = 3.0_DP      ! the bottom of element 5 above its top
    call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.false.)
    call suite%that('outcomes: inverted', outcome == OUTCOME_ELEMENT .and. system%failed_element >= 5)
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, -0.01_DP])
    call start_blocks(model, system, state)
    state%new%u(1, 25) = 1.0e308_DP
    call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.false.)
    call suite%that('outcomes: not finite', outcome == OUTCOME_NOT_FINITE)
  end subroutine check_outcomes


  !> Norms of nodes with and without angles, scaled by their rotation length; residuals at rounding level are zero.
  subroutine check_norms(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    real(DP), allocatable :: field(:, :)
    real(DP) :: largest(2)
    integer :: outcome
    call two_blocks(model, 0.2_DP, 0.5_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    call start_blocks(model, system, state)
    call linearize_equilibrium(system, model, model%steps(1), state, outcome, error)
    allocate (field, mold=state%new%u)
    field = 0.0_DP
    field(:, 2) = [3.0_DP, -4.0_DP, 0.0_DP]
    call suite%near('norms: component', sum(max_components(system, field, 1)), 4.0_DP, 0.0_DP)
    call suite%near('norms: vector', sum(nodal_norms(system, field, -1)), 5.0_DP, 1.0e-15_DP)
    system%residual = 0.0_DP
    system%residual_at_gap = 0.0_DP
    system%residual(1, 20) = 1.0e-14_DP
    system%residual_at_gap(1, 20) = 1.0_DP
    field = 1.0_DP
    largest = residual_sizes(system, field)
    call suite%near('norms: rounding alone', largest(1), 0.0_DP, 0.0_DP)
    call suite%near('norms: a residual', largest(2), 1.0_DP, 1.0e-11_DP)
    field = 0.0_DP
    largest = residual_sizes(system, field)
    call suite%near('norms: no displacement, no rounding', largest(1), 1.0e-14_DP, 0.0_DP)
    system%rotation_length = spread(2.0_DP, 1, model%mesh%n_nodes)
    field(:, 2) = [3.0_DP, -4.0_DP, 0.0_DP]
    call suite%near('norms: an angle as a length', sum(max_components(system, field, 1)), 8.0_DP, 0.0_DP)
    call suite%near('norms: a moment as a force', sum(nodal_norms(system, field, -1)), 2.5_DP, 1.0e-15_DP)
  end subroutine check_norms


  !> Small displacements: the linearised evaluation equals the evaluation, and the configuration can be restored after it.
  subroutine check_forecast(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state, there
    type(configuration_type) :: start
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), residual(:, :), forecast(:, :)
    real(DP) :: merit, merit_there
    integer :: outcome, i
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.01_DP])
    call start_blocks(model, system, state)
    call linearize_equilibrium(system, model, model%steps(1), state, outcome, error)
    call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.false.)
    start = save_configuration(system, state)
    residual = system%residual
    merit = system%merit
    allocate (du, mold=state%new%u)
    du = reshape([(0.01_DP * sin(real(i, DP)), i=1, size(du))], shape(du))
    there = state
    call evaluate_linearized(system, model, start, du, there)
    forecast = system%residual
    merit_there = system%merit
    call suite%near('forecast: where it is', norm2(there%new%u - state%new%u - du), 0.0_DP, 1.0e-15_DP)
    call restore_configuration(system, model, model%steps(1), start, there, error)
    call suite%near('restored: residual and merit', norm2(system%residual - residual) + abs(system%merit - merit), 0.0_DP, 0.0_DP)
    call suite%near('restored: displacements', norm2(there%new%u - state%new%u), 0.0_DP, 0.0_DP)
    call suite%that('restored: slaves', all(there%new%slaves%status == state%new%slaves%status))
    there = state
    there%new%u = there%new%u + du
    call evaluate_equilibrium(system, model, model%steps(1), there, outcome, is_frozen=.false.)
    call suite%near('forecast: the residual', maxval(abs(system%residual - forecast)), 0.0_DP, 1.0e-12_DP)
    call suite%near('forecast: the merit', merit_there, system%merit, 1.0e-12_DP * system%merit)
    call suite%that('forecast: something is closed', any(there%new%slaves%status /= STATUS_OPEN))
  end subroutine check_forecast


  !> Unknowns of the interface: slaves and the facets below them; far nodes only on request.
  subroutine check_interface(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    logical, allocatable :: is_contact(:)
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    call start_blocks(model, system, state)
    is_contact = interface_unknowns(system, model, state%new, .false.)
    call suite%that('interface: both faces', all(is_contact(28:102)))
    call suite%that('interface: nothing else', count(is_contact) == 75)
    call two_blocks(model, 0.2_DP, 1.0_DP, [0.0_DP, 0.0_DP, 0.0_DP])   ! the edge of a master facet is 1.2
    call start_blocks(model, system, state)
    call suite%that('interface: far nodes are not on it', .not. any(interface_unknowns(system, model, state%new, .false.)))
    call suite%that('interface: unless they are requested', count(interface_unknowns(system, model, state%new, .true.)) == 75)
    system%schur_interface%is_ready = .true.
    system%bulk_factor_u = state%new%u
    call discard_bulk_factor(system)
    call suite%that('interface: the factor is gone', .not. (system%schur_interface%is_ready .or. allocated(system%bulk_factor_u)))
  end subroutine check_interface


  include 'sample_blocks.inc'

end program test_equilibrium
