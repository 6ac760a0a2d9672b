!> Newton: one increment, iteration by iteration; reads like the page of the theory manual (doc/theory/newton.md).
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_newton
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_extent
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, SEARCH_AUTO
  use amontons_iteration_records, only: iteration_record_type
  use amontons_state, only: state_type, slave_type, STATUS_OPEN
  use amontons_tunnelling_check, only: farthest_travel, passed_through
  use amontons_active_set_history, only: forensics_type, note_slaves
  use amontons_active_set_cycling, only: act_on_cycle, release_nodes
  use amontons_convergence, only: progress_type, judge, judge_early, VERDICT_GO_ON, VERDICT_DIVERGES, &
    VERDICT_CONVERGED, VERDICT_TOO_SLOW
  use amontons_line_search, only: search_type, search_line
  use amontons_globalization, only: course_type, way_type, choose_way, COURSE_NEWTON, COURSE_SNAP
  use amontons_equilibrium, only: system_type, begin_increment, evaluate, residuals_beyond, components_of, &
    TROUBLE_NONE, TROUBLE_ELEMENT, TROUBLE_FREE, TROUBLE_THROUGH
  use amontons_newton_step, only: carry_bodies
  implicit none
  private
  public :: newton_type, begin_newton, iterate

  real(DP), parameter :: FAR_OFF = 100.0_DP         !< a displacement of this many sizes of the model in an increment is none [-]

  real(DP), parameter :: CARRIED_OFF = 2.0_DP       !< so many sizes of the model are enough for a body that had to be carried [-]

  real(DP), parameter :: FORCE_MEMORY = 1.0e-3_DP   !< forces are at least this times force_scale [-]
  real(DP), parameter :: ROUNDING = 1.0e-13_DP      !< of the largest force of the attempt: no residual is less [-]
  real(DP), parameter :: FAR_TRAVEL = 0.6_DP        !< facets: a slave node that goes farther may meet or leave its master [-]

  !> An increment on its way.
  type :: newton_type
    type(progress_type) :: progress
    type(iteration_record_type) :: record          !< of the last iteration
    integer :: trouble = TROUBLE_NONE
    integer :: farthest = 0                        !< the node that moved farthest, where bodies were carried or fly off
    integer :: gone_through = 0                    !< the node that passed through its master
    logical :: may_be_cut = .false.                !< the increment may be tried again, shorter: a lost attempt may end early
    type(course_type) :: course                    !< directions that lead nowhere, and what was done about them
    integer :: n_uphill = 0                        !< iterations whose direction went against the imbalance
    integer :: n_cycles = 0                        !< cycles of slave nodes that were acted on
    integer :: n_shifted = 0                       !< factorisations before this attempt that needed a shift
    type(forensics_type) :: forensics
    real(DP) :: largest_seen = 0                   !< largest force of the attempt [force]
    real(DP) :: force_scale = 0                    !< largest bulk force where increments began, force where they converged
  end type newton_type

contains

  !> The start of an increment: the loads are those of its end, and every node goes on with the velocity of the last
  !! increment. Slave nodes keep their status, unless they go so far that they may meet or leave their master.
  subroutine begin_newton(newton, system, model, step, is_step_start, state)
    type(newton_type), intent(inout) :: newton     !< force_scale is kept from increment to increment, all else begins anew
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(inout) :: state       !< trial = committed, with the new times
    real(DP) :: dt, travel
    newton = newton_type(progress_type(), iteration_record_type(), forensics=forensics_type(), n_shifted=system%n_shifted, &
      force_scale=newton%force_scale)
    if (system%carry > 0.0_DP) call carry_bodies(system, model, state%new, 0.0_DP)   ! an attempt ended in the midst of it
    call begin_increment(system, model, step, is_step_start, state)
    newton%trouble = TROUBLE_ELEMENT
    if (.not. is_step_start) then
      dt = state%new%total_time - state%old%total_time
      travel = farthest_travel(system%contact, model, state%old%slaves, dt * state%old%v)
      state%new%u = state%old%u + dt * state%old%v
      call evaluate(system, model, step, state, newton%trouble, is_frozen=travel < FAR_TRAVEL)
    end if
    if (newton%trouble /= TROUBLE_NONE) then
      state%new%u = state%old%u
      state%new%slaves = state%old%slaves
      call begin_increment(system, model, step, is_step_start, state)
      call evaluate(system, model, step, state, newton%trouble, is_frozen=.true.)
    end if
    call note_slaves(newton%forensics, state%new%slaves, system%merit)
    newton%force_scale = max(newton%force_scale, system%bulk_force)   ! nodes go on into a stiff law with any force
    call note_residual(newton, system, [system%largest_residual, maxval(components_of(system, system%lawful, -1))], &
      step%controls%r_n)                           ! K may not be there yet
  end subroutine begin_newton


  !> One iteration: a direction along which contact settles, a step along it, and the verdict on where it leads.
  subroutine iterate(newton, system, model, step, state, verdict, error)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: verdict                !< VERDICT_...; newton%trouble tells more
    type(error_type), allocatable, intent(out) :: error
    type(way_type) :: way
    integer :: n_krylov, n_rounds
    verdict = VERDICT_DIVERGES
    if (newton%trouble /= TROUBLE_NONE) return
    n_krylov = system%n_krylov
    n_rounds = system%n_rounds
    call choose_way(newton%course, system, model, step, newton%progress, state, way, newton%trouble, error)
    if (allocated(error) .or. newton%trouble /= TROUBLE_NONE) return
    call go_along(newton, system, model, step, way, state)
    if (newton%trouble /= TROUBLE_NONE) return
    newton%record%n_krylov = system%n_krylov - n_krylov
    newton%record%n_rounds = system%n_rounds - n_rounds
    call judge_iterate(newton, system, model, step, state, verdict)
  end subroutine iterate


  !> A step along the direction, of the length that the line search gives it, and what is noted where it ends.
  subroutine go_along(newton, system, model, step, way, state)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(way_type), intent(in) :: way
    type(state_type), intent(inout) :: state       !< in: evaluated at u; out: evaluated at the new iterate
    type(search_type) :: search
    real(DP), allocatable :: u(:, :), residual(:, :)
    u = state%new%u
    residual = system%residual
    call search_line(system, model, step, way%du, way%ahead, state, search, newton%trouble)
    if (search%is_uphill .and. newton%progress%residual(0) > step%controls%r_n) newton%n_uphill = newton%n_uphill + 1
    newton%course%is_refused = search%is_refused
    if (newton%course%now /= COURSE_NEWTON) call put_down(newton, system, model, state, u, residual)
    if (newton%trouble /= TROUBLE_NONE) return
    call note_slaves(newton%forensics, state%new%slaves, system%merit)
    call watch_bodies(newton, system, model, state)
    if (newton%trouble /= TROUBLE_NONE) return
    call note_residual(newton, system, residuals_beyond(system, state%new%u), step%controls%r_n)
    call note_step(newton, system, state, search)
  end subroutine go_along


  !> The verdict on the iterate: by its residual and correction, by cycles of slave nodes, and by slave nodes that passed through
  !! their master.
  subroutine judge_iterate(newton, system, model, step, state, verdict)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: verdict                !< VERDICT_...
    logical :: is_contact                          ! what does not converge
    is_contact = any(state%new%slaves%status /= STATUS_OPEN) .and. (all(model%materials%n_history == 0) .or. &
      newton%forensics%hash(1) /= newton%forensics%hash(3))   ! bodies that begin to flow take their time
    verdict = judge(step%controls, newton%progress)
    if (newton%course%now == COURSE_SNAP .and. verdict /= VERDICT_CONVERGED .and. newton%progress%iteration < step%controls%i_c) &
      verdict = VERDICT_GO_ON                      ! through a snap imbalances grow
    if (verdict == VERDICT_GO_ON .and. newton%may_be_cut .and. is_contact .and. newton%course%now == COURSE_NEWTON) &
      call judge_early(newton%progress, verdict)
    if (verdict == VERDICT_CONVERGED .and. system%contact%n_imposed > 0) &   ! stick that friction does not hold: once more
      verdict = merge(VERDICT_GO_ON, VERDICT_TOO_SLOW, newton%progress%iteration < step%controls%i_c)
    if (step%line_search == SEARCH_AUTO) call watch_cycles(newton, system, model, step, state, verdict)
    if (verdict == VERDICT_CONVERGED) call watch_masters(newton, system, model, state, verdict)
    if (verdict == VERDICT_CONVERGED) newton%force_scale = max(newton%force_scale, system%largest_force)
  end subroutine judge_iterate


  !> Cycles are acted on as they are found; nodes that were held for one are let go when all else is in balance, and the verdict
  !! waits for what they do.
  subroutine watch_cycles(newton, system, model, step, state, verdict)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(inout) :: verdict
    logical :: is_found, is_changed
    if (size(state%new%slaves) == 0) return
    if (verdict == VERDICT_CONVERGED) then
      call release_nodes(system%contact, model%mesh%coordinates + state%new%u, state%new%slaves, is_changed)
    else
      call act_on_cycle(system%contact, newton%forensics, state%new%slaves, is_found, is_changed)
      if (is_changed) newton%n_cycles = newton%n_cycles + 1
      if (is_changed .and. newton%progress%iteration < step%controls%i_c) verdict = VERDICT_GO_ON
      if (is_found .and. .not. is_changed .and. newton%may_be_cut .and. verdict == VERDICT_GO_ON) verdict = VERDICT_TOO_SLOW
    end if
    if (.not. is_changed) return
    call evaluate(system, model, step, state, newton%trouble, is_frozen=.false.)
    call note_residual(newton, system, residuals_beyond(system, state%new%u), step%controls%r_n)
    if (newton%trouble /= TROUBLE_NONE) then
      verdict = VERDICT_DIVERGES
    else if (verdict == VERDICT_CONVERGED .and. (system%contact%n_changed > 0 .or. &
      newton%progress%residual(0) > step%controls%r_n)) then
      verdict = VERDICT_GO_ON
    end if
  end subroutine watch_cycles


  !> After an iteration that carried bodies: K is as it is again; the work that the forces did which nothing balanced is added up.
  subroutine put_down(newton, system, model, state, u, residual)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) before the iteration [length]
    real(DP), intent(in) :: residual(:, :)         !< (3, n_nodes) there [force]
    newton%course%n_carried = newton%course%n_carried + 1
    call carry_bodies(system, model, state%new, 0.0_DP)
    state%new%slaves%is_within = .false.           ! where they were carried to is not where they touched first
    state%new%carried_work = state%new%carried_work + 0.5_DP * sum((residual + system%residual) * (state%new%u - u))
  end subroutine put_down


  !> A balance in which a slave node has passed through its master within the increment is none.
  subroutine watch_masters(newton, system, model, state, verdict)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    integer, intent(inout) :: verdict
    integer :: s
    s = passed_through(system%contact, model%mesh%coordinates + state%old%u, model%mesh%coordinates + state%new%u, &
      state%old%slaves, state%new%slaves)
    if (s == 0) return
    newton%trouble = TROUBLE_THROUGH
    newton%gone_through = state%new%slaves(s)%node
    verdict = VERDICT_DIVERGES
  end subroutine watch_masters


  !> A body that moves by many times the size of the model in one increment is held by nothing.
  subroutine watch_bodies(newton, system, model, state)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    real(DP) :: most, moves(size(state%new%u, 2))  ! [length]
    logical :: is_carried
    moves = components_of(system, state%new%u - state%old%u, 1)
    is_carried = newton%course%now /= COURSE_NEWTON
    if (is_carried) newton%farthest = maxloc(moves, dim=1)
    most = merge(CARRIED_OFF, FAR_OFF, is_carried) * mesh_extent(model%mesh)
    if (maxval(moves) <= most) return
    newton%trouble = TROUBLE_FREE
    newton%farthest = maxloc(moves, dim=1)
  end subroutine watch_bodies


  !> The residual over the largest force, and the two before it. What rounding makes of gaps and of displacements counts as no
  !! residual: bodies that only touch, or move without any force, have no larger force.
  subroutine note_residual(newton, system, residual, tolerance)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: residual(2)            !< the largest: R, and with laws where their nodes are [force]
    real(DP), intent(in) :: tolerance              !< of the residual [-]
    real(DP) :: scale
    newton%largest_seen = max(newton%largest_seen, system%largest_force)
    scale = max(system%largest_force, FORCE_MEMORY * newton%force_scale, ROUNDING / tolerance * newton%largest_seen, tiny(1.0_DP))
    newton%progress%residual = [max(residual(1) - system%rounding, 0.0_DP) / scale, newton%progress%residual(0:1)]
    newton%progress%law = max(residual(2) - system%rounding, 0.0_DP) / scale
    newton%progress%gap = max(system%contact%worst_gap, system%violation)
  end subroutine note_residual


  !> Correction and record of the iteration.
  subroutine note_step(newton, system, state, search)
    type(newton_type), intent(inout) :: newton
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    type(search_type), intent(in) :: search
    real(DP) :: largest
    integer :: status
    largest = max(maxval(components_of(system, state%new%u - state%old%u, 1)), tiny(1.0_DP))
    newton%progress%iteration = newton%progress%iteration + 1
    newton%progress%correction = search%correction / largest
    newton%progress%is_whole_step = search%is_whole_step
    newton%progress%is_arrived = search%is_arrived
    associate (record => newton%record)
      record%iteration = newton%progress%iteration
      record%residual = max(newton%progress%residual(0), newton%progress%law)
      record%correction = newton%progress%correction
      record%n_status = [(count(state%new%slaves%status == status), status=0, 2)]
      record%n_closed = record%n_status(1) + record%n_status(2)
      record%n_scenario = search%n_scenario
      record%n_balanced = search%n_balanced
      record%n_opened = search%n_opened
      record%n_closed_now = search%n_closed
      record%step_length = search%step_length
      record%worst_gap = 0.0_DP
      if (system%contact%worst_slave > 0) record%worst_gap = &
        system%contact%worst_gap * system%contact%edge(state%new%slaves(system%contact%worst_slave)%pair)
    end associate
  end subroutine note_step

end module amontons_newton
