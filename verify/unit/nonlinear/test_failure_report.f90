!> Tests of the failure report: the code of a failure for each outcome and history of an attempt, its lines, and edge events.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_failure_report
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_failure, only: failure_type, FAILURE_MATERIAL, FAILURE_SINGULAR, FAILURE_NOT_FINITE, FAILURE_CONSTRAINTS, &
    FAILURE_FREE_FLYING, FAILURE_FREE_OPEN, &
    FAILURE_LEFT_MASTER, FAILURE_CYCLE, FAILURE_FLIP, FAILURE_PASSED_THROUGH, FAILURE_DEEP, &
    FAILURE_LIMIT_POINT, FAILURE_GROWING, FAILURE_SLOW
  use amontons_iteration_records, only: REPORT_LINE_LENGTH
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_EXTENDED
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_active_set_history, only: active_set_history_type, record_active_set
  use amontons_convergence, only: VERDICT_DIVERGES, VERDICT_TOO_SLOW
  use amontons_newton, only: newton_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    OUTCOME_ELEMENT, OUTCOME_LINEAR_SOLVER, OUTCOME_NOT_FINITE, OUTCOME_UNSUPPORTED, OUTCOME_TUNNELLING, &
    OUTCOME_CONSTRAINTS
  use amontons_failure_report, only: find_failure, describe_failure, describe_edge_events
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call two_blocks(model, 0.2_DP, 0.0_DP, [0.0_DP, 0.0_DP, 0.0_DP])   ! node labels are 100 plus the index
  call start_blocks(model, system, state)
  state%new%slaves%status = STATUS_STICK
  state%new%slaves%facet = 1
  state%old%slaves = state%new%slaves
  call check_outcomes(suite)
  call check_histories(suite)
  call check_lines(suite)
  call check_edges(suite)
  call suite%finish()

contains

  !> The failure of an attempt with an outcome.
  type(failure_type) function failure_of(outcome) result(failure)
    integer, intent(in) :: outcome
    type(newton_type) :: newton
    newton%outcome = outcome
    newton%farthest_node = 7
    newton%tunnelled_node = 21
    failure = find_failure(model, system, state, newton, VERDICT_DIVERGES)
    if (.not. allocated(failure%labels)) allocate (failure%labels(0))
  end function failure_of


  !> Outcomes that name their cause.
  subroutine check_outcomes(suite)
    type(suite_type), intent(inout) :: suite
    call expect(suite, 'an element', OUTCOME_ELEMENT, FAILURE_MATERIAL, [4])
    call expect(suite, 'a singular tangent', OUTCOME_LINEAR_SOLVER, FAILURE_SINGULAR, [integer ::])
    call expect(suite, 'a number', OUTCOME_NOT_FINITE, FAILURE_NOT_FINITE, [integer ::])
    call expect(suite, 'a slave that passed through', OUTCOME_TUNNELLING, FAILURE_PASSED_THROUGH, [121])
    call expect(suite, 'constraints', OUTCOME_CONSTRAINTS, FAILURE_CONSTRAINTS, [integer ::])
    call expect(suite, 'far away, but the supports hold it', OUTCOME_UNSUPPORTED, FAILURE_LIMIT_POINT, [integer ::])
    model%steps(1)%prescribed = model%steps(1)%prescribed(:27)
    call expect(suite, 'far away, and nothing holds it', OUTCOME_UNSUPPORTED, FAILURE_FREE_FLYING, [107])
    state%new%slaves%status = STATUS_OPEN
    call expect(suite, 'a singular tangent, all open, and nothing holds it', OUTCOME_LINEAR_SOLVER, FAILURE_FREE_OPEN, [integer ::])
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    call expect(suite, 'a singular tangent, all open, but clamped', OUTCOME_LINEAR_SOLVER, FAILURE_SINGULAR, [integer ::])
    state%new%slaves%status = STATUS_STICK
    call two_blocks(model, 0.2_DP, 0.0_DP, [0.0_DP, 0.0_DP, 0.0_DP])
  end subroutine check_outcomes


  !> Code and labels of an outcome; of constraints also the words of the conflict.
  subroutine expect(suite, name, outcome, code, labels)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: name
    integer, intent(in) :: outcome, code, labels(:)
    type(failure_type) :: failure
    if (.not. allocated(system%conflict)) allocate (system%conflict)
    system%conflict%message = 'two rows'
    system%failed_element = 4
    failure = failure_of(outcome)
    call suite%that(name // ': code', failure%code == code)
    call suite%that(name // ': as many labels', size(failure%labels) == size(labels))
    if (size(failure%labels) == size(labels)) call suite%that(name // ': labels', all(failure%labels == labels))
    if (code == FAILURE_CONSTRAINTS) call suite%that(name // ': in their own words', failure%detail == 'two rows')
  end subroutine expect


  !> Attempts without trouble that do not converge: slow, growing, left master, cycles with and without opening, deep, limit point.
  subroutine check_histories(suite)
    type(suite_type), intent(inout) :: suite
    call suite%that('slow', code_after([STATUS_STICK], [1], [0.0_DP], VERDICT_TOO_SLOW) == FAILURE_SLOW)
    call suite%that('growing', code_after([STATUS_STICK], [1], [0.0_DP], VERDICT_DIVERGES) == FAILURE_GROWING)
    call suite%that('flip', code_after([STATUS_SLIP, STATUS_STICK], [1, 1], [0.0_DP, 0.0_DP], VERDICT_TOO_SLOW) == FAILURE_FLIP)
    call suite%that('cycle', code_after([STATUS_OPEN, STATUS_STICK], [1, 1], [0.0_DP, 0.0_DP], VERDICT_TOO_SLOW) == FAILURE_CYCLE)
    call suite%that('deep at once', code_after([STATUS_STICK, STATUS_STICK], [1, 1], [0.0_DP, -1.0_DP], VERDICT_TOO_SLOW) &
      == FAILURE_DEEP)
    call suite%that('left its master', code_after([STATUS_OPEN], [0], [0.0_DP], VERDICT_TOO_SLOW) == FAILURE_LEFT_MASTER)
    call suite%that('limit point', code_after([STATUS_STICK], [1], [0.0_DP], VERDICT_TOO_SLOW, 2) == FAILURE_LIMIT_POINT)
    call suite%that('one ascent is none', code_after([STATUS_STICK], [1], [0.0_DP], VERDICT_TOO_SLOW, 1) == FAILURE_SLOW)
  end subroutine check_histories


  !> The code after six iterations in which slave 5 has these statuses, facets and gaps by turns; the last ones last.
  integer function code_after(statuses, facets, gaps, verdict, n_ascents) result(code)
    integer, intent(in) :: statuses(:), facets(:)
    real(DP), intent(in) :: gaps(:)                !< [length]
    integer, intent(in) :: verdict
    integer, intent(in), optional :: n_ascents     !< directions that went against the imbalance
    type(newton_type) :: newton
    type(failure_type) :: failure
    type(state_type) :: trial
    integer :: i, k
    trial = state
    if (present(n_ascents)) newton%n_ascent_directions = n_ascents
    do i = 1, 6
      k = 1 + mod(i - 1, size(statuses))
      trial%new%slaves(5)%status = statuses(k)
      trial%new%slaves(5)%facet = facets(k)
      trial%new%slaves(5)%gap = gaps(k)
      call record_active_set(newton%active_set_history, trial%new%slaves, 1.0_DP)
    end do
    failure = find_failure(model, system, trial, newton, verdict)
    code = failure%code
    if (code == FAILURE_CYCLE .or. code == FAILURE_FLIP) then
      if (failure%length /= 2 .or. any(failure%labels /= [model%mesh%node_label(trial%new%slaves(5)%node)])) code = -1
    end if
  end function code_after


  !> The lines: the measures, the nodes by their imbalance, the contact of a slave node, the remedy; of an element the remedy alone.
  subroutine check_lines(suite)
    type(suite_type), intent(inout) :: suite
    type(newton_type) :: newton
    type(failure_type) :: failure
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    newton%measures%iteration = 17
    newton%measures%residual(0) = 0.125_DP
    call record_active_set(newton%active_set_history, state%new%slaves, 1.0_DP)
    system%residual = 0.0_DP
    system%residual(3, 2) = -3.0_DP
    system%residual(1, state%new%slaves(5)%node) = 4.0_DP
    failure%code = FAILURE_SLOW
    lines = describe_failure(model, system, state, newton, failure)
    call suite%that('lines: as many as nodes out of balance', size(lines) == 5)
    call suite%that('lines: measures', index(lines(1), 'After 17 iterations') == 1 .and. index(lines(1), '1.250E-01') > 0)
    call suite%that('lines: the worst first, with its contact', index(lines(3), 'node 123: imbalance  4.000E+00') > 0 .and. &
      index(lines(3), 'slave-master') > 0 .and. index(lines(3), 'stick') > 0)
    call suite%that('lines: then the other, without', index(lines(4), 'node 102: imbalance  3.000E+00') > 0 .and. &
      index(lines(4), 'pair') == 0)
    call suite%that('lines: the remedy', index(lines(5), 'Remedy: ') == 1)
    newton%outcome = OUTCOME_ELEMENT
    lines = describe_failure(model, system, state, newton, failure)
    call suite%that('lines: of an element the remedy alone', size(lines) == 1)
    failure%code = FAILURE_MATERIAL
    system%failed_element = 2                      ! of the upper block, whose foot is the slave
    lines = describe_failure(model, system, state, newton, failure)
    call suite%that('lines: the contact that presses an element', count(index(lines, 'slave-master') > 0) >= 1 .and. &
      any(index(lines, 'C3D8I') > 0))
    newton%outcome = OUTCOME_UNSUPPORTED
    newton%direction = 0.0_DP * state%new%u
    newton%direction(:, 3) = [0.0_DP, 0.0_DP, -0.5_DP]
    newton%direction(:, 4) = [0.2_DP, 0.0_DP, 0.0_DP]
    failure%code = FAILURE_LIMIT_POINT
    lines = describe_failure(model, system, state, newton, failure)
    call suite%that('lines: the mode, its largest node first', any(index(lines, 'node 103:   0.000  0.000 -1.000') > 0) .and. &
      any(index(lines, 'node 104:   0.400  0.000  0.000') > 0))
    failure%code = FAILURE_FREE_FLYING
    failure%labels = [107]
    state%new%u = state%old%u
    state%new%u(3, 27) = state%old%u(3, 27) - 0.25_DP
    lines = describe_failure(model, system, state, newton, failure)
    call suite%that('lines: the bodies that moved', count(index(lines, 'body of element') > 0) == 1 .and. &
      any(index(lines, '2.500E-01') > 0))
  end subroutine check_lines


  !> After an increment: edges that are extended since then, and nodes that ran off, each in a sentence with its label.
  subroutine check_edges(suite)
    type(suite_type), intent(inout) :: suite
    type(state_type) :: after
    character(REPORT_LINE_LENGTH), allocatable :: lines(:)
    after = state
    call suite%that('edges: nothing to say', size(describe_edge_events(model, after)) == 0)
    after%new%slaves(2)%overrides%edge = NODE_OVERRIDE_EXTENDED
    lines = describe_edge_events(model, after)
    call suite%that('edges: extended', size(lines) == 1)
    call suite%that('edges: its label', index(lines(1), '120') > 0)
    after%old%slaves(2)%overrides%edge = NODE_OVERRIDE_EXTENDED
    after%new%slaves(3)%facet = 0
    lines = describe_edge_events(model, after)
    call suite%that('edges: one of before is not reported again; one ran off', size(lines) == 1)
    call suite%that('edges: the label of that', index(lines(1), '121') > 0 .and. index(lines(1), 'ran off') > 0)
  end subroutine check_edges


  include 'sample_blocks.inc'

end program test_failure_report
