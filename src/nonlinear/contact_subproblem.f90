!> Contact subproblem: active-set and semismooth Newton iterations on contact with the bulk linearised (Josephy-Newton).
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, "Contact subproblem". A Newton direction du is valid for the statuses
!! from which its contact rows were built. With the bulk linearised at u, the imbalance at u + du needs no elements,
!!
!!     Rhat(u + du) = Rhat(u) - E K du,
!!
!! so gaps, trial tractions and statuses are evaluated there and the direction is corrected iteratively on the condensed
!! interface with the same factor of the bulk. The next Newton iteration treats the nonlinearity of the bulk.
module amontons_contact_subproblem
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, LINE_SEARCH_AUTO
  use amontons_state, only: state_type, slave_state_type
  use amontons_active_set_history, only: active_set_history_type, record_active_set, is_cycle_repeated
  use amontons_active_set_cycling, only: extend_master_edges, facet_track_type
  use amontons_equilibrium, only: equilibrium_type, configuration_type, save_configuration, evaluate_linearized, &
    restore_configuration, OUTCOME_OK
  use amontons_newton_step, only: solve_correction, skin_merit_tolerance
  use amontons_line_search, only: MERIT_DECREASE_RATIO
  implicit none
  private
  public :: solve_contact_subproblem

  !> The end of a direction.
  type :: subproblem_result_type
    real(DP) :: merit = huge(1.0_DP)
    real(DP), allocatable :: du(:, :)
    real(DP) :: d_load = 0                         !< change of the load factor [-]
    type(slave_state_type), allocatable :: slaves(:)
    integer :: n_subproblem_iterations = 0                        !< corrections made
    integer :: outcome = OUTCOME_OK              !< of the last of them
    logical :: is_subproblem_solved = .false.
  end type subproblem_result_type

contains

  !> Corrects a direction until the contact subproblem converges at its end; if it does not, in substeps.
  !!
  !! Only for AUTO, and only with the condensed interface: the other line searches use the uncorrected direction.
  !! After: du, and the slave states with which u + du is to be evaluated; the state is at u as before.
  subroutine solve_contact_subproblem(system, model, step, state, du, slaves, error, d_load)
    type(equilibrium_type), intent(inout), target :: system   !< with the direction's factor
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< evaluated at u
    real(DP), intent(inout) :: du(:, :)            !< (3, n_nodes) [length]
    type(slave_state_type), allocatable, intent(out) :: slaves(:)
    type(error_type), allocatable, intent(out) :: error
    real(DP), intent(inout), optional :: d_load    !< change of the load factor along du, in a RIKS step [-]
    type(configuration_type) :: start
    type(subproblem_result_type) :: best, candidate
    real(DP) :: initial_d_load
    logical :: has_interface_solver, is_interface_singular             ! at the end of the whole direction
    slaves = state%new%slaves
    if (step%line_search /= LINE_SEARCH_AUTO .or. .not. system%has_interface_solver) return
    start = save_configuration(system, state)
    initial_d_load = 0.0_DP
    if (present(d_load)) initial_d_load = d_load
    call solve_whole_step(system, model, step, start, state, du, initial_d_load, best, error)
    if (allocated(error)) return
    system%n_subproblem_iterations = system%n_subproblem_iterations + best%n_subproblem_iterations
    if (.not. best%is_subproblem_solved .and. system%proximal_shift <= 0.0_DP) then
      has_interface_solver = system%has_interface_solver
      is_interface_singular = system%is_interface_singular
      call solve_by_substeps(system, model, step, start, state, candidate, error)
      if (allocated(error)) return
      system%n_subproblem_iterations = system%n_subproblem_iterations + candidate%n_subproblem_iterations
      if (candidate%is_subproblem_solved) best = candidate
      system%has_interface_solver = has_interface_solver .or. candidate%is_subproblem_solved   ! regardless of failures in a substep
      system%is_interface_singular = is_interface_singular .and. .not. candidate%is_subproblem_solved
    end if
    du = best%du
    if (present(d_load)) d_load = best%d_load
    slaves = best%slaves
    system%is_subproblem_solved = best%is_subproblem_solved            ! if not, the factor may be missing
    call restore_configuration(system, model, step, start, state, error)
  end subroutine solve_contact_subproblem


  !> All corrections at the end of the whole direction. The result is the iterate with the least merit.
  subroutine solve_whole_step(system, model, step, start, state, du, initial_d_load, best, error)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(configuration_type), intent(inout) :: start       !< u; out: slaves fixed to their extended edges are marked
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: du(:, :)            !< (3, n_nodes) [length]
    real(DP), intent(in) :: initial_d_load         !< change of the load factor along du [-]
    type(subproblem_result_type), intent(out) :: best
    type(error_type), allocatable, intent(out) :: error
    type(active_set_history_type) :: active_set_history
    real(DP), allocatable :: correction(:, :), initial_du(:, :)
    type(facet_track_type) :: facet_tracks(size(start%slaves))   ! of the slave nodes
    real(DP) :: largest_merit, d_load, d_correction
    integer :: n_extended
    logical :: is_lost, is_cycle_found
    is_cycle_found = .false.
    system%n_halved = 0
    largest_merit = 0.0_DP
    initial_du = du
    d_load = initial_d_load
    best%du = du
    best%d_load = d_load
    best%slaves = start%slaves
    allocate (correction, mold=du)
    call evaluate_linearized(system, model, start, du, state, d_load)
    do
      call extend_master_edges(system%contact, step%controls%cycling, start%slaves, state%new%slaves, facet_tracks, n_extended, &
        is_lost)
      if (n_extended > 0 .and. best%n_subproblem_iterations < step%controls%subproblem%max_iterations) then
        if (is_lost) then                          ! restart, with these slaves fixed to their extended edges
          du = initial_du
          d_load = initial_d_load
          state%new%slaves = start%slaves
          best%n_subproblem_iterations = best%n_subproblem_iterations + 1
        else                                       ! between facets: the corrections continue
          where (state%new%slaves%overrides%edge /= start%slaves%overrides%edge)
            state%new%slaves%facet = start%slaves%facet
            state%new%slaves%overrides%edge = start%slaves%overrides%edge
          end where
        end if
        best%merit = huge(1.0_DP)                  ! the next iterate is the best one
        call evaluate_linearized(system, model, start, du, state, d_load)
        system%contact%n_changed = system%contact%n_changed + n_extended
      end if
      call record_best(system, state, du, d_load, best)
      call record_active_set(active_set_history, state%new%slaves, system%merit)
      largest_merit = max(largest_merit, system%merit)
      if (has_subproblem_converged(system, step, start, largest_merit)) exit
      is_cycle_found = is_cycle_repeated(active_set_history, step%controls%subproblem%stagnation_ratio)
      if (best%n_subproblem_iterations == step%controls%subproblem%max_iterations .or. is_cycle_found) exit
      best%n_subproblem_iterations = best%n_subproblem_iterations + 1
      call solve_correction(system, model, step, state, 1.0_DP, correction, best%outcome, error, d_correction)
      if (allocated(error)) return
      if (best%outcome /= OUTCOME_OK .or. all(correction == 0.0_DP)) exit   ! GMRES finds no correction
      call apply_damped_correction(system, model, step, start, correction, d_correction, state, du, d_load)
    end do
    best%is_subproblem_solved = best%n_subproblem_iterations < step%controls%subproblem%max_iterations .and. .not. is_cycle_found &
      .and. best%outcome == OUTCOME_OK
  end subroutine solve_whole_step


  !> Incremental solution of the subproblem. At the fraction t the fraction t of the remaining prescribed displacements is applied,
  !! and a force on every node balances the fraction 1 - t of the imbalance at u. Each substep starts from the solution of the last
  !! one; where the subproblem does not converge, the substep is halved.
  subroutine solve_by_substeps(system, model, step, start, state, accepted, error)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(configuration_type), intent(in) :: start          !< u
    type(state_type), intent(inout) :: state
    type(subproblem_result_type), intent(out) :: accepted            !< solved only if the last substep is
    type(error_type), allocatable, intent(out) :: error
    type(subproblem_result_type) :: candidate
    type(configuration_type) :: from                       ! u with the forces at t
    real(DP) :: t, substep_length
    integer :: n_rounds
    associate (limits => step%controls%subproblem)
      from = start
      allocate (accepted%du(size(start%u, 1), size(start%u, 2)), source=0.0_DP)
      accepted%slaves = start%slaves
      t = 0.0_DP
      n_rounds = 0
      substep_length = limits%initial_substep
      do while (t < 1.0_DP .and. substep_length >= limits%min_substep .and. n_rounds < limits%max_iterations_all_substeps)
        candidate = accepted
        from%applied_force = start%applied_force - (1.0_DP - t - substep_length) * start%residual
        call solve_substep(system, model, step, from, substep_length / (1.0_DP - t), state, candidate, error)
        if (allocated(error)) return
        n_rounds = n_rounds + candidate%n_subproblem_iterations
        if (candidate%is_subproblem_solved) then
          accepted = candidate
          t = t + substep_length                            ! sums of powers of two: exact
          if (2 * candidate%n_subproblem_iterations <= limits%max_iterations_per_substep) substep_length = 2.0_DP * substep_length
          substep_length = min(1.0_DP - t, substep_length)
        else
          substep_length = 0.5_DP * substep_length
        end if
      end do
      accepted%n_subproblem_iterations = n_rounds
      accepted%is_subproblem_solved = t >= 1.0_DP
    end associate
  end subroutine solve_by_substeps


  !> One substep: the full first correction, which moves the supports, then damped corrections as for the whole direction.
  subroutine solve_substep(system, model, step, start, offset_fraction, state, candidate, error)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(configuration_type), intent(in) :: start          !< u, with the applied forces at the end of the substep
    real(DP), intent(in) :: offset_fraction                  !< the substep over the remaining fraction of the direction [-]
    type(state_type), intent(inout) :: state
    type(subproblem_result_type), intent(inout) :: candidate         !< in: start of the substep; out: its end
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: correction(:, :)
    type(active_set_history_type) :: active_set_history
    real(DP) :: largest_merit, d_correction
    integer :: n
    candidate%is_subproblem_solved = .false.
    system%n_halved = 0
    largest_merit = 0.0_DP
    allocate (correction, mold=candidate%du)
    state%new%slaves = candidate%slaves
    call evaluate_linearized(system, model, start, candidate%du, state, candidate%d_load)
    do n = 1, step%controls%subproblem%max_iterations_per_substep
      candidate%n_subproblem_iterations = n
      call solve_correction(system, model, step, state, merge(offset_fraction, 0.0_DP, n == 1), correction, candidate%outcome, &
        error, d_correction)
      if (allocated(error) .or. candidate%outcome /= OUTCOME_OK) return
      if (n == 1) then
        candidate%du = candidate%du + correction
        candidate%d_load = candidate%d_load + d_correction
        call evaluate_linearized(system, model, start, candidate%du, state, candidate%d_load)
      else
        call apply_damped_correction(system, model, step, start, correction, d_correction, state, candidate%du, candidate%d_load)
      end if
      largest_merit = max(largest_merit, system%merit)
      call record_active_set(active_set_history, state%new%slaves, system%merit)
      candidate%is_subproblem_solved = has_subproblem_converged(system, step, start, largest_merit) .or. all(correction == 0.0_DP)
      if (candidate%is_subproblem_solved) exit
      if (is_cycle_repeated(active_set_history, step%controls%subproblem%stagnation_ratio)) exit
    end do
    candidate%slaves = state%new%slaves
  end subroutine solve_substep


  !> Whether no status changes and the merit is within its tolerance.
  pure logical function has_subproblem_converged(system, step, start, largest_merit)
    type(equilibrium_type), intent(in) :: system        !< linearised evaluation
    type(step_type), intent(in) :: step
    type(configuration_type), intent(in) :: start          !< u
    real(DP), intent(in) :: largest_merit                !< merit of the iterations [force]
    real(DP) :: tolerance, negligible_force          ! [-], [force]
    tolerance = merge(system%forcing_term, step%controls%subproblem%tolerance, system%is_skin)
    negligible_force = step%controls%subproblem%newton_tolerance_share * step%controls%r_n * system%largest_force
    if (system%is_skin .and. system%is_constant) then   ! no further Newton iteration is needed
      tolerance = step%controls%newton%min_forcing_term
      negligible_force = skin_merit_tolerance(system, step)
    end if
    has_subproblem_converged = system%contact%n_changed == 0 .and. system%merit <= max(tolerance * start%merit, &
      step%controls%subproblem%rounding * largest_merit, &
      negligible_force, system%linearized_rounding, system%force_rounding * sqrt(real(size(start%u), DP)))
  end function has_subproblem_converged


  !> Records the iterate if its merit is the least so far; of equal ones the first.
  subroutine record_best(system, state, du, d_load, best)
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    real(DP), intent(in) :: du(:, :)
    real(DP), intent(in) :: d_load
    type(subproblem_result_type), intent(inout) :: best
    if (.not. system%merit < MERIT_DECREASE_RATIO * best%merit) return
    best%merit = system%merit
    best%du = du
    best%d_load = d_load
    best%slaves = state%new%slaves
  end subroutine record_best


  !> Applies the longest of the tried lengths of a correction at which the merit does not grow, else the one with the least merit;
  !! of
  !! equal ones the longest.
  subroutine apply_damped_correction(system, model, step, start, correction, d_correction, state, du, d_load)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(configuration_type), intent(in) :: start
    real(DP), intent(in) :: correction(:, :)
    real(DP), intent(in) :: d_correction           !< change of the load factor along it [-]
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: du(:, :)
    real(DP), intent(inout) :: d_load              !< [-]
    type(slave_state_type), allocatable :: slaves(:)
    real(DP) :: start_merit, least_merit, length, best_length
    integer :: halving
    start_merit = system%merit
    slaves = state%new%slaves
    least_merit = huge(1.0_DP)
    best_length = 1.0_DP
    length = 1.0_DP
    do halving = 0, step%controls%line_search%max_halvings
      length = 0.5_DP**halving
      state%new%slaves = slaves
      call evaluate_linearized(system, model, start, du + length * correction, state, d_load + length * d_correction)
      if (system%merit < MERIT_DECREASE_RATIO * least_merit) best_length = length
      least_merit = min(least_merit, system%merit)
      if (MERIT_DECREASE_RATIO * system%merit <= start_merit) exit
    end do
    if (best_length < 1.0_DP) system%n_halved = system%n_halved + 1
    if (best_length < length .or. best_length > length) then
      state%new%slaves = slaves
      call evaluate_linearized(system, model, start, du + best_length * correction, state, d_load + best_length * d_correction)
    end if
    du = du + best_length * correction
    d_load = d_load + best_length * d_correction
  end subroutine apply_damped_correction

end module amontons_contact_subproblem
