!> Linear solve of one Newton step at the configuration last evaluated: linearisation, factorisation, Krylov iteration.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!!     K      stiffness of the elements and loads, symmetric; the antisymmetric part of the tangent is in assembly%skew
!!     C, c   du = C dv + c: boundary conditions, equations, midside constraints, contact rows (constraints)
!!     A      C' K C, factorised by Cholesky                                             (reduced_system, schur_interface)
!!     J      C' (K - d F_c) C, with the consistent linearisation of the contact forces, unsymmetric (contact_linearization)
!!
!! J dv = C' R is solved by GMRES with A as the preconditioner (doc/theory/solver.md).
module amontons_newton_step
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_model, only: model_type, n_nonlinear_mpcs
  use amontons_surfaces, only: is_compliant
  use amontons_steps, only: step_type, LINE_SEARCH_AUTO, TANGENT_SYMMETRIC, TANGENT_LAGGED, INTERFACE_DENSE, INTERFACE_SKIN, &
    SOLVER_GRADIENTS
  use amontons_iteration_records, only: PHASE_ASSEMBLY, PHASE_CONTACT, PHASE_FACTOR, PHASE_KRYLOV, PHASE_OTHER
  use amontons_state, only: state_type, fields_type, slave_state_type, DAMPING_NOW, STATUS_OPEN
  use amontons_sparse, only: sparse_type, sparse_sum
  use amontons_factorization, only: FACTOR_OK
  use amontons_reduced_system, only: reduced_system_type, factorise_reduced_system, abandon_iteration, &
    old_factor_iterations, renew_matrix, USE_SKIN
  use amontons_woodbury_interface, only: contact_springs_type
  use amontons_contact_preconditioner, only: partition_skin, build_skin_coarse_space, update_skin
  use amontons_free_rigid_motions, only: sparse_vector_type, find_motions, motion_of, compressed, is_singular_along
  use amontons_robin_springs, only: find_near, robin_springs, skin_rows, master_shares, following_motion
  use amontons_schur_interface, only: is_analysis_valid, is_factor_of, analyse_bulk, factorise_bulk, &
    factorise_interface, factorise_woodbury
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_pairs, only: current_row
  use amontons_constraints, only: eliminate_constraints, scale_offsets
  use amontons_nonlinear_mpc, only: add_mpc_stiffness
  use amontons_inertia, only: add_inertia_force, add_inertia_stiffness
  use amontons_stabilization, only: add_damping_force, add_damping_stiffness
  use amontons_unsymmetric_tangent, only: assemble_skew, has_unsymmetric_law
  use amontons_assembly_plan, only: complete_diagonal
  use amontons_assembly, only: assemble_tangent, assemble_nodal_stiffness
  use amontons_external_loads, only: assemble_external_loads, assemble_reference_loads, add_foundation_stiffness
  use amontons_user_element_forces, only: add_user_stiffness
  use amontons_tangent_solution, only: solve_constrained_system, follow_path, tangent_type, is_skin_cheaper
  use amontons_contact_linearization, only: linearize_contact, drop_unsymmetric_terms, add_contact_rows, has_spring
  use amontons_contact_operators, only: assemble_contact_tangents, assemble_spring_matrix, factorise_spring_tangents
  use amontons_equilibrium, only: equilibrium_type, update_base_constraints, discard_bulk_factor, interface_unknowns, &
    undivide_matrix, has_moving_supports, n_interface_unknowns, mean_diagonal_stiffness, OUTCOME_OK, &
    OUTCOME_ELEMENT, OUTCOME_LINEAR_SOLVER
  implicit none
  private
  public :: solve_newton_step, solve_correction, linearize_equilibrium, set_proximal_shift, skin_merit_tolerance, &
    factorise_reduced_matrix
  public :: is_skin_chosen, configure_bulk_solver

contains

  !> The Newton direction du at the configuration of the last evaluation; in a RIKS step it ends on the arc.
  recursive subroutine solve_newton_step(system, model, step, state, du, outcome, error, d_load)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error   !< out of memory and the like
    real(DP), intent(out), optional :: d_load      !< change of the load factor along du [-]
    real(DP) :: allowed_residual                   ! [force]
    if (present(d_load)) d_load = 0.0_DP
    if (system%skin%memory%is_outdated) call discard_bulk_factor(system)
    system%skin%memory%is_outdated = .false.
    call linearize_equilibrium(system, model, step, state, outcome, error)
    if (allocated(error) .or. outcome /= OUTCOME_OK) return
    call system%clock%read(PHASE_OTHER)
    call prepare_interface_solver(system, model, step, state, error)
    if (allocated(error)) return
    if (system%is_interface_singular) outcome = OUTCOME_LINEAR_SOLVER
    system%max_old_iterations = 0
    if (is_old_factor_allowed(system, step)) system%max_old_iterations = old_factor_iterations(system%reduced_system, &
      system%constraints)
    if (system%max_old_iterations > 0 .and. system%reduced_system%is_iterative) then
      call renew_matrix(system%reduced_system, system%assembly%stiffness, system%constraints, error)
    else if (.not. (system%has_interface_solver .or. system%is_interface_singular .or. system%max_old_iterations > 0)) then
      call prepare_reduced_solver(system, model, step, state, outcome, error)
    end if
    if (allocated(error) .or. outcome /= OUTCOME_OK) return
    call system%clock%read(PHASE_FACTOR)
    system%n_factorisations_before = system%n_factorisations
    if (system%has_interface_solver) system%is_indefinite = .false.
    system%is_subproblem_solved = .false.
    allowed_residual = admissible_residual(system, step)
    system%skin_tolerance = step%controls%skin%tolerance_single
    if (step%line_search == LINE_SEARCH_AUTO) system%skin_tolerance = merge(step%controls%skin%tolerance_origin, &
      step%controls%skin%tolerance_changing, sets_origins(system, state))
    call follow_criteria(system, step)
    system%is_first_direction = .false.
    call solve_constrained_system(system, allowed_residual, du, outcome, error)
    if (allocated(error)) return
    if (outcome == OUTCOME_LINEAR_SOLVER .and. is_interface_discarded(system)) then
      call solve_newton_step(system, model, step, state, du, outcome, error, d_load)
      return
    end if
    do while (outcome == OUTCOME_LINEAR_SOLVER .and. (system%max_old_iterations > 0 .or. (.not. system%has_interface_solver .and. &
      system%reduced_system%is_iterative)))
      if (system%max_old_iterations == 0) call abandon_iteration(system%reduced_system)
      system%max_old_iterations = 0
      call system%clock%read(PHASE_KRYLOV)
      call prepare_reduced_solver(system, model, step, state, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) return
      call system%clock%read(PHASE_FACTOR)
      call solve_constrained_system(system, admissible_residual(system, step), du, outcome, error)
      if (allocated(error)) return
    end do
    if (step%is_riks .and. outcome == OUTCOME_OK .and. present(d_load)) call follow_path(system, step, state, du, d_load, outcome, &
      error)
    call system%clock%read(PHASE_KRYLOV)
  end subroutine solve_newton_step


  !> A and its factor or preconditioner. A divided K is made whole if the iteration over the ranks does not serve.
  subroutine prepare_reduced_solver(system, model, step, state, outcome, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< at which K was assembled
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    logical :: is_constant                         ! the stiffness of later increments
    if (.not. system%reduced_system%is_iteration_abandoned) then
      call factorise_reduced_matrix(system, model, outcome, error)
      if (allocated(error) .or. .not. (system%assembly%is_divided .and. system%reduced_system%is_iteration_abandoned)) return
    end if
    if (system%assembly%is_divided) then
      is_constant = system%is_assembled
      call undivide_matrix(system, model)
      call assemble_bulk(system, model, step, state, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) return
      system%is_assembled = is_constant
    end if
    call factorise_reduced_matrix(system, model, outcome, error)
  end subroutine prepare_reduced_solver


  !> Whether the factor of an earlier iteration may precondition the direction: K changes, the constraints do not.
  pure logical function is_old_factor_allowed(system, step)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    is_old_factor_allowed = size(system%contact_tangents) == 0 .and. .not. (system%has_interface_solver .or. &
      system%is_interface_singular .or. system%reduced_system%is_current .or. system%is_indefinite .or. step%is_riks) .and. &
      system%proximal_shift <= 0.0_DP .and. step%line_search == LINE_SEARCH_AUTO
  end function is_old_factor_allowed


  !> Whether the direction may close nodes with friction, whose slip counts from where it sees them touch.
  pure logical function sets_origins(system, state)
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state
    integer :: s
    sets_origins = .false.
    if (.not. system%is_first_direction) return
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%status == STATUS_OPEN .and. slave%facet > 0) &
          sets_origins = system%contact%laws(slave%pair)%friction > 0.0_DP .or. system%contact%laws(slave%pair)%is_user_friction
      end associate
      if (sets_origins) return
    end do
  end function sets_origins


  !> Whether the solver of the interface served the last direction and has been discarded: a new one gives the direction.
  pure logical function is_interface_discarded(system) result(is_discarded)
    type(equilibrium_type), intent(in) :: system
    is_discarded = system%has_interface_solver
    if (is_discarded) is_discarded = .not. merge(system%skin%is_ready, system%schur_interface%is_ready, system%is_skin)
  end function is_interface_discarded


  !> The direction from a configuration of the linearised model, with the present tangent of the bulk.
  recursive subroutine solve_correction(system, model, step, state, offset_fraction, du, outcome, error, d_load)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(in) :: offset_fraction                  !< fraction of the remaining prescribed displacements that the
                                                             !! direction applies [-]
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    real(DP), intent(out), optional :: d_load      !< change of the load factor along du [-]
    real(DP) :: allowed_residual                              ! [force]
    call system%clock%read(PHASE_OTHER)
    outcome = OUTCOME_LINEAR_SOLVER
    if (present(d_load)) d_load = 0.0_DP
    call build_constraints(system, model, step, state, offset_fraction, error)
    if (allocated(error)) return
    call system%clock%read(PHASE_CONTACT)
    call prepare_interface_solver(system, model, step, state, error)
    if (allocated(error) .or. .not. system%has_interface_solver) return
    call system%clock%read(PHASE_FACTOR)
    system%skin_tolerance = merge(step%controls%skin%tolerance_changing, step%controls%skin%tolerance_unchanged, &
      system%contact%n_changed > 0)
    if (system%n_halved > 1) system%skin_tolerance = min(system%skin_tolerance, step%controls%skin%tolerance_halved)
    if (system%contact%n_changed > 0 .or. system%proximal_shift > 0.0_DP) call follow_criteria(system, step)
    allowed_residual = system%controls%krylov%newton_tolerance_share * step%controls%r_n * system%largest_force
    if (system%is_skin) allowed_residual = 0.5_DP * skin_merit_tolerance(system, step)
    call solve_constrained_system(system, allowed_residual, du, outcome, error)
    if (allocated(error)) return
    if (outcome == OUTCOME_LINEAR_SOLVER .and. .not. system%is_skin .and. is_interface_discarded(system)) then
      call solve_correction(system, model, step, state, offset_fraction, du, outcome, error, d_load)
      return
    end if
    if (step%is_riks .and. outcome == OUTCOME_OK .and. present(d_load)) call follow_path(system, step, state, du, d_load, outcome, &
      error)
    call system%clock%read(PHASE_KRYLOV)
  end subroutine solve_correction


  !> Directions are solved tighter in proportion where the criteria are tighter than usual: slip counts from where they see nodes
  !! touch, as bodies do that a proximal step moves.
  pure subroutine follow_criteria(system, step)
    type(equilibrium_type), intent(inout) :: system
    type(step_type), intent(in) :: step
    associate (controls => step%controls)
      if (system%proximal_shift > 0.0_DP) system%skin_tolerance = min(system%skin_tolerance, controls%skin%tolerance_origin)
      system%skin_tolerance = max(controls%krylov%tolerance, system%skin_tolerance * min(1.0_DP, controls%r_n / &
        controls%skin%usual_r_n))
    end associate
  end subroutine follow_criteria


  !> The merit at which corrections with the contact skin stop.
  pure real(DP) function skin_merit_tolerance(system, step) result(goal)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    goal = system%controls%skin%newton_tolerance_share * step%controls%r_n * system%largest_force
  end function skin_merit_tolerance


  !> The admissible residual of a direction: larger than 0 where another Newton iteration follows, to save work. Within the
  !! tolerance of Newton's residual it is r_l at most: only the estimate of the error requires another direction then, and a
  !! direction of zero would satisfy it without any work.
  pure real(DP) function admissible_residual(system, step) result(allowed_residual)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    allowed_residual = 0
    if (system%has_interface_solver .or. (system%reduced_system%is_iterative .and. .not. system%is_constant)) &
      allowed_residual = system%controls%krylov%newton_tolerance_share * step%controls%r_n * system%largest_force
    if (maxval(abs(system%residual)) <= step%controls%r_n * system%largest_force) &
      allowed_residual = min(allowed_residual, 0.5_DP * step%controls%r_l * system%largest_force)
  end function admissible_residual


  !> K, the linearised contact forces, and C with c, at the configuration of the last evaluation.
  subroutine linearize_equilibrium(system, model, step, state, outcome, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    outcome = OUTCOME_OK
    call system%clock%read(PHASE_OTHER)
    if (.not. system%is_assembled) then
      system%reduced_system%is_current = .false.
      system%motions%is_current = .false.
      call assemble_bulk(system, model, step, state, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) return
      system%is_assembled = system%is_constant .or. step%direction == TANGENT_LAGGED .or. step%solver == SOLVER_GRADIENTS
      system%is_bulk_factor_current = system%is_constant .and. (system%schur_interface%is_ready .or. system%skin%is_ready)
    end if
    call set_slave_stiffness(system, step, state%new)
    call system%clock%read(PHASE_ASSEMBLY)
    if (step%is_riks) call assemble_reference_loads(system%assembly, model, step, state%new, step%is_nlgeom, system%reference_force)
    call build_constraints(system, model, step, state, 1.0_DP, error)
    call system%clock%read(PHASE_CONTACT)
  end subroutine linearize_equilibrium


  !> K of elements, loads, damping, inertia, proximal shift and nonlinear MPCs.
  subroutine assemble_bulk(system, model, step, state, outcome, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome                !< OUTCOME_OK or OUTCOME_ELEMENT
    type(error_type), allocatable, intent(out) :: error
    integer :: failed
    if (system%is_matrix_free) then
      if (.not. allocated(system%nodal_stiffness)) allocate (system%nodal_stiffness(3, 3, model%mesh%n_nodes))
      call assemble_nodal_stiffness(system%assembly, model, step%is_nlgeom, state, system%nodal_stiffness, failed)
      outcome = merge(OUTCOME_OK, OUTCOME_ELEMENT, failed == 0)
      return
    end if
    call assemble_element_tangent(system, model, step, state, failed)
    outcome = merge(OUTCOME_OK, OUTCOME_ELEMENT, failed == 0)
    if (failed /= 0) return
    call assemble_external_loads(system%assembly, model, step, state%new, step%is_nlgeom, .true.)
    if (state%new%damping(DAMPING_NOW) > 0.0_DP) call add_damping_force(system%volume_share, state)
    if (step%is_dynamic) call add_inertia_force(system%assembly, model, system%mass, state)
    call assemble_skew(system%assembly%skew, 3 * model%mesh%n_nodes, error)
    if (allocated(error)) return
    if (state%new%damping(DAMPING_NOW) > 0.0_DP) call add_damping_stiffness(system%volume_share, state, system%assembly%stiffness)
    if (step%is_dynamic) call add_inertia_stiffness(system%mass, state, system%assembly)
    call add_proximal_shift(system)
    if (step%is_nlgeom .and. n_nonlinear_mpcs(model) > 0) call add_mpc_stiffness(system%base, system%assembly, model, state%new)
    call complete_diagonal(system%assembly)
  end subroutine assemble_bulk


  !> K of the elements, user elements and foundations included.
  subroutine assemble_element_tangent(system, model, step, state, failed)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state
    integer, intent(out) :: failed                 !< 0, or the first element that is inverted or not finite
    call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
    if (failed == 0 .and. allocated(model%user_elements)) call add_user_stiffness(system%assembly, model, step, state, failed)
    if (failed == 0) call add_foundation_stiffness(system%assembly, model, state%new, step%is_nlgeom)
  end subroutine assemble_element_tangent


  !> The scale c of the trial traction: the mean diagonal stiffness of the node in K. Conjugate gradients have springs of stiffness
  !! c, so that a soft master counts; they evaluate compliant laws at the gap itself: c = 0.
  subroutine set_slave_stiffness(system, step, fields)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    type(fields_type), intent(inout) :: fields
    integer :: s
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        slave%stiffness = mean_diagonal_stiffness(system, slave%node)
        if (step%solver == SOLVER_GRADIENTS) slave%stiffness = stiffness_in_series(system, slave)
        if (step%solver == SOLVER_GRADIENTS .and. is_compliant(system%contact%laws(slave%pair))) slave%stiffness = 0.0_DP
      end associate
    end do
  end subroutine set_slave_stiffness


  !> The stiffness of a slave node in series with that of the point of its master: 1/c is the sum of w**2/k over the nodes of its
  !! row, k their mean diagonal stiffness.
  pure real(DP) function stiffness_in_series(system, slave) result(c)
    type(equilibrium_type), intent(in) :: system
    type(slave_state_type), intent(in) :: slave    !< with its own stiffness
    type(contact_row_type) :: row
    real(DP) :: k
    integer :: j
    c = slave%stiffness
    if (slave%facet == 0 .or. c <= 0.0_DP) return
    call current_row(system%contact, slave, row)
    c = 1.0_DP / c
    do j = 1, size(row%nodes)
      if (row%nodes(j) == slave%node) cycle
      k = mean_diagonal_stiffness(system, row%nodes(j))
      if (k > 0.0_DP) c = c + row%weights(j)**2 / k
    end do
    c = 1.0_DP / c
  end function stiffness_in_series


  !> C and c of all constraints, contact rows included; in a RIKS step whose supports move the change of c with the load factor.
  subroutine build_constraints(system, model, step, state, offset_fraction, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< as before in the end
    real(DP), intent(in) :: offset_fraction                  !< fraction of the remaining prescribed displacements in c [-]
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: load_factor
    if (allocated(system%reference_offset)) deallocate (system%reference_offset)
    if (step%is_riks .and. has_moving_supports(step)) then
      load_factor = state%new%load_factor
      call collect_constraints(system, model, step, state%old, state%new, 1.0_DP, error)
      if (allocated(error)) return
      system%reference_offset = -system%constraints%offset
      state%new%load_factor = load_factor + 1.0_DP
      call collect_constraints(system, model, step, state%old, state%new, 1.0_DP, error)
      if (allocated(error)) return
      system%reference_offset = system%reference_offset + system%constraints%offset
      state%new%load_factor = load_factor
    end if
    call collect_constraints(system, model, step, state%old, state%new, offset_fraction, error)
  end subroutine build_constraints


  !> C and c of all constraints at the load factor of the fields.
  subroutine collect_constraints(system, model, step, old, fields, offset_fraction, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: old           !< committed
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: offset_fraction                  !< fraction of the remaining prescribed displacements in c [-]
    type(error_type), allocatable, intent(out) :: error
    call update_base_constraints(system, model, step, fields, error)
    if (allocated(error)) return
    if (offset_fraction < 1.0_DP) call scale_offsets(system%base, offset_fraction)
    call linearize_contact(system%contact, model, old, fields, system%contact_tangents)
    if (step%direction == TANGENT_SYMMETRIC) call drop_unsymmetric_terms(system%contact_tangents)
    system%constraints = system%base
    call add_contact_rows(system%contact, model, fields, system%contact_tangents, system%constraints, system%n_conflicts)
    call eliminate_constraints(system%constraints)
  end subroutine collect_constraints


  !> Sets the proximal shift s, the fraction of its own diagonal that is added to K; 0: no shift.
  subroutine set_proximal_shift(system, model, fields, shift)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: shift                   !< [-]
    logical, allocatable :: is_reachable(:)
    system%proximal_shift = shift
    if (shift > 0.0_DP) then                        ! the bodies may come into contact anywhere
      is_reachable = interface_unknowns(system, model, fields, .true.)
      if (any(is_reachable .and. .not. system%is_interface_unknown)) system%schur_interface%is_analysed = .false.
      system%is_interface_unknown = system%is_interface_unknown .or. is_reachable
    end if
    system%is_assembled = .false.
    system%is_schur_allowed = .true.
    call discard_bulk_factor(system)
  end subroutine set_proximal_shift


  !> Adds the proximal shift to the diagonal of K.
  subroutine add_proximal_shift(system)
    type(equilibrium_type), intent(inout) :: system
    integer :: i, j
    real(DP) :: mean_stiffness                                ! [force/length]
    if (system%proximal_shift <= 0.0_DP) return
    associate (K => system%assembly%stiffness)
      do i = 1, K%n_rows, 3                        ! mean diagonal stiffness of a node: invariant to the choice of axes
        mean_stiffness = sum(K%value(K%first(i:i + 2))) / 3.0_DP
        do j = i, i + 2
          K%value(K%first(j)) = K%value(K%first(j)) + system%proximal_shift * mean_stiffness
        end do
      end do
    end associate
  end subroutine add_proximal_shift


  !> The interface solver: the contact skin, or the Schur complement of the interface. The bulk is factorised if no factor is
  !! available, the interface always. After: has_interface_solver is .false. where the dense interface is too large, the
  !! bulk is not positive definite, or is_interface_singular.
  subroutine prepare_interface_solver(system, model, step, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< not changed
    type(error_type), allocatable, intent(out) :: error
    logical :: is_complete
    integer :: attempt
    system%has_interface_solver = .false.
    system%is_interface_singular = .false.
    system%is_skin = .false.
    if (size(state%new%slaves) == 0) return
    if (is_skin_chosen(system, step)) then
      call factorise_skin(system, model, step, state, error)
      return
    end if
    if (.not. system%is_schur_allowed .or. system%reduced_system%is_iterative) return
    if (system%schur_interface%is_ready) then
      system%is_bulk_factor_current = system%is_bulk_factor_current .and. is_factor_of(system%schur_interface, system%base)
      if (.not. is_analysis_valid(system%schur_interface, system%base)) call discard_bulk_factor(system)
    end if
    do attempt = 1, 2
      call ensure_bulk_factor(system, model, step, state, .false., error)
      if (allocated(error) .or. .not. system%schur_interface%is_ready) return
      call factorise_contact_interface(system, is_complete, error)
      if (allocated(error)) return
      system%is_interface_singular = is_complete .and. system%schur_interface%is_singular
      system%has_interface_solver = is_complete .and. .not. system%is_interface_singular
      if (is_complete) return
      system%is_interface_unknown = system%is_interface_unknown .or. interface_unknowns(system, model, state%new, .false.)
      system%schur_interface%is_analysed = .false.
      call discard_bulk_factor(system)
    end do
  end subroutine prepare_interface_solver


  !> Whether the contact subproblem is solved on the contact skin: by the cost of a round. The dense interface takes n_c^3
  !! operations, the skin some number of products with the bulk. The choice depends on nothing but the model and the interface,
  !! which a checkpoint keeps.
  pure logical function is_skin_chosen(system, step)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    is_skin_chosen = .false.
    if (system%skin%memory%is_abandoned .or. step%interface == INTERFACE_DENSE) return
    is_skin_chosen = step%interface == INTERFACE_SKIN
    if (is_skin_chosen .or. .not. allocated(system%is_interface_unknown)) return
    is_skin_chosen = n_interface_unknowns(system) > system%controls%contact_interface%max_unknowns .or. &
      system%reduced_system%is_iterative .or. is_skin_cheaper(system, system%controls%contact_interface%usual_skin_iterations)
  end function is_skin_chosen


  !> Contact by the skin: the bulk solver is computed if none is available, the tiles always. After: is_skin and
  !! has_interface_solver, or is_interface_singular.
  subroutine factorise_skin(system, model, step, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< not changed
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: rows, shares, motion
    call assemble_contact_tangents(system%contact_tangents, system%contact%force_condensation, system%constraints%n_unknowns, &
      system%skin%by_imbalance, system%skin%by_displacement)
    system%is_interface_singular = has_free_motion(system, model, step, state%new)
    if (system%is_interface_singular) return
    call ensure_bulk_factor(system, model, step, state, .true., error)
    if (allocated(error) .or. .not. system%skin%is_ready) return
    if (any(model%pairs%has_point_contact)) system%skin%memory%is_near = &   ! points change
      find_near(system%contact, state%new, step%controls%contact_interface%max_gap)
    call skin_rows(system%contact, state%new, system%skin%memory%is_near, system%contact_tangents, model%mesh%n_nodes, rows)
    call master_shares(system%contact_tangents, model%mesh%n_nodes, shares, error)
    if (allocated(error)) return
    call following_motion(system%contact_tangents, system%assembly%stiffness, shares, motion, error)
    if (allocated(error)) return
    call update_skin(system%skin, system%base, system%constraints, system%assembly%stiffness, rows, motion, error)
    if (allocated(error)) return
    system%is_skin = .true.
    system%has_interface_solver = .true.
  end subroutine factorise_skin


  !> Whether the tangent is singular along a rigid body motion.
  logical function has_free_motion(system, model, step, fields)
    type(equilibrium_type), intent(inout), target :: system   !< linearised at the fields, with the contact tangents of its skin
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    type(tangent_type) :: tangent
    type(sparse_vector_type) :: images(system%controls%skin%max_motions), scales(system%controls%skin%max_motions)
    real(DP), allocatable :: z(:), x(:), y(:)
    integer, allocatable :: unknown_of(:)          ! (n_free)
    integer :: i, k
    if (.not. system%motions%is_current) call update_motions(system, model, step, fields)
    allocate (x(system%constraints%n_free), y(system%constraints%n_free))
    unknown_of = pack([(i, i=1, system%constraints%n_unknowns)], system%constraints%free_of > 0)
    tangent%system => system
    system%is_skin = .true.                        ! J by the sparse contact tangents: closed points are many
    associate (stiffness => system%assembly%stiffness, free_of => system%constraints%free_of)
      do k = 1, system%motions%n
        z = motion_of(system%motions, k)
        x(free_of(unknown_of)) = z(unknown_of)
        call tangent%apply(x, y)
        images(k) = compressed(y)
        x(free_of(unknown_of)) = z(unknown_of) * stiffness%value(stiffness%first(unknown_of))
        scales(k) = compressed(x)
      end do
    end associate
    system%is_skin = .false.
    has_free_motion = is_singular_along(size(x), images(:system%motions%n), scales(:system%motions%n), &
      system%controls%skin%free_motion_ratio)
  end function has_free_motion


  !> The rigid motions without energy of the present stiffness, about the places where it is assembled.
  subroutine update_motions(system, model, step, fields)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    real(DP), allocatable :: place(:, :)           ! (3, n_nodes) [length]
    logical, allocatable :: is_angle(:)
    place = model%mesh%coordinates
    if (step%is_nlgeom) place = place + fields%u
    allocate (is_angle(model%mesh%n_nodes), source=.false.)
    if (size(system%rotation_length) > 0) is_angle = system%rotation_length < 1.0_DP .or. system%rotation_length > 1.0_DP
    call find_motions(system%controls%skin, system%assembly%stiffness, system%base, place, is_angle, system%motions)
  end subroutine update_motions


  !> K with Robin springs, and its solver: a factor, or the two-level preconditioner where that is too large.
  subroutine update_bulk_solver(system, model, step, fields, is_resumed, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_resumed              !< with the springs of the interrupted job
    type(error_type), allocatable, intent(out) :: error
    logical :: is_slave(model%mesh%n_nodes)
    integer :: status, i
    if (system%base%n_free == 0) return
    is_slave = .false.
    is_slave(fields%slaves%node) = .true.
    do i = 1, size(model%pairs)                    ! integration points change their nearest node
      if (model%pairs(i)%has_point_contact) is_slave(system%contact%mortar(i)%slave%nodes) = .true.
    end do
    call partition_skin(system%skin, model%mesh%coordinates, pack([(i, i=1, size(is_slave))], is_slave), &
      system%controls%skin%slaves_per_tile)
    if (.not. is_resumed .or. .not. allocated(system%skin%memory%is_near)) then
      system%skin%memory%is_near = find_near(system%contact, fields, system%controls%contact_interface%max_gap)
      call robin_springs(system%controls%skin, system%contact, fields, system%skin%memory%is_near, system%contact_tangents, &
        system%base%n_unknowns, system%skin%memory%springs)
    end if
    call configure_bulk_solver(system%skin%robin, step)
    if (system%skin%memory%is_factor_needed .and. system%skin%robin%is_iterative) call abandon_iteration(system%skin%robin)
    system%skin%robin%is_iteration_abandoned = system%skin%memory%is_factor_needed
    call factorise_reduced_system(system%skin%robin, sparse_sum(system%assembly%stiffness, 1.0_DP, system%skin%memory%springs), &
      .true., system%base, &
      model%mesh, &
      status, error)
    if (allocated(error)) return
    system%n_factorisations = system%n_factorisations + system%skin%robin%n_factorised
    system%skin%is_ready = status == FACTOR_OK
    associate (controls => system%controls%skin)
      if (system%skin%is_ready) call build_skin_coarse_space(system%skin, system%base, model%mesh%coordinates, &
        min(controls%max_coarse_patches, max(controls%min_coarse_patches, count(is_slave) / controls%slaves_per_patch)))
    end associate
  end subroutine update_bulk_solver


  !> The accuracy required of the bulk solver of the skin.
  subroutine configure_bulk_solver(robin, step)
    type(reduced_system_type), intent(inout) :: robin
    type(step_type), intent(in) :: step
    if (allocated(robin%node_order)) deallocate (robin%node_order)   ! as in a resumed job
    robin%requested_solver = step%solver
    robin%controls = step%controls%linear_solver
    robin%use = USE_SKIN
  end subroutine configure_bulk_solver


  !> The interface for the present contact: by the Woodbury formula where all contact is compliant and the bodies are supported
  !! without it.
  subroutine factorise_contact_interface(system, is_complete, error)
    type(equilibrium_type), intent(inout) :: system
    logical, intent(out) :: is_complete            !< .false.: contact extends beyond the interface
    type(error_type), allocatable, intent(out) :: error
    type(contact_springs_type) :: springs
    type(sparse_type) :: imbalance_tangent, displacement_tangent
    logical :: is_fit
    if (all(system%contact_tangents%is_compliant_node) .and. size(system%contact_tangents) > 0 .and. 3 &
      * size(system%contact_tangents) < system%schur_interface%n_contact &
      .and. system%schur_interface%is_invertible) then
      call factorise_spring_tangents(system%contact_tangents, system%constraints%n_unknowns, springs, error)
      if (allocated(error)) return
      call factorise_woodbury(system%schur_interface, system%base, system%constraints, springs, is_complete, is_fit, error)
      if (allocated(error) .or. is_fit .or. .not. is_complete) return
    end if
    call assemble_contact_tangents(system%contact_tangents, system%contact%force_condensation, system%constraints%n_unknowns, &
      imbalance_tangent, displacement_tangent)
    call factorise_interface(system%schur_interface, system%base, system%constraints, imbalance_tangent, displacement_tangent, &
      is_complete, error)
  end subroutine factorise_contact_interface


  !> The factor of the bulk: the present one, else that at bulk_factor_u (of a resumed job), else a new one.
  subroutine ensure_bulk_factor(system, model, step, state, is_skin, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< not changed
    logical, intent(in) :: is_skin                 !< the bulk solver of the skin, else the factor with the interface last
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: u(:, :)
    integer :: failed, outcome
    logical :: is_resumed
    if (is_ready()) return
    is_resumed = allocated(system%bulk_factor_u)
    system%is_bulk_factor_current = system%is_constant .or. .not. is_resumed        ! as in the uninterrupted job
    if (.not. (is_resumed .or. has_load_stiffness())) then
      call renew()
      if (is_ready()) system%bulk_factor_u = state%new%u
      return
    end if
    u = state%new%u
    if (is_resumed) state%new%u = system%bulk_factor_u
    call assemble_element_tangent(system, model, step, state, failed)
    call renew()
    if (is_ready() .and. .not. is_resumed) system%bulk_factor_u = u
    state%new%u = u
    if (allocated(error)) return
    if (is_ready() .and. is_resumed) system%n_factorisations = system%n_factorisations - 1   ! not counted without interruption
    call assemble_bulk(system, model, step, state, outcome, error)

  contains

    !> Whether the solver is available.
    pure logical function is_ready()
      is_ready = merge(system%skin%is_ready, system%schur_interface%is_ready, is_skin)
    end function is_ready

    !> Whether K has the stiffness of loads, which the bulk solver of the skin leaves out: it serves other loads too.
    pure logical function has_load_stiffness()
      has_load_stiffness = is_skin .and. step%is_nlgeom .and. size(step%distributed) > 0 .and. system%proximal_shift <= 0.0_DP
    end function has_load_stiffness

    !> Computes the solver for the present stiffness.
    subroutine renew()
      if (is_skin) then
        call update_bulk_solver(system, model, step, state%new, is_resumed, error)
      else
        call refactorise_bulk(system, error)
      end if
    end subroutine renew

  end subroutine ensure_bulk_factor


  !> Factorises the bulk with the present stiffness, if the interface is small enough.
  subroutine refactorise_bulk(system, error)
    type(equilibrium_type), intent(inout) :: system
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    system%is_schur_allowed = .false.
    if (system%base%n_free == 0) return            ! all unknowns are prescribed
    if (.not. is_analysis_valid(system%schur_interface, system%base)) then
      if (n_interface_unknowns(system) > system%controls%contact_interface%max_unknowns) return
      call analyse_bulk(system%schur_interface, system%assembly%stiffness, system%base, system%is_interface_unknown, error)
      if (allocated(error) .or. .not. system%schur_interface%is_analysed) return
    end if
    if (system%schur_interface%n_contact == 0) return
    call factorise_bulk(system%schur_interface, system%assembly%stiffness, system%base, status, error)
    if (allocated(error)) return
    system%n_factorisations = system%n_factorisations + 1
    if (status /= FACTOR_OK) system%n_indefinite = system%n_indefinite + 1   ! the next iterate may be positive definite
    system%is_schur_allowed = system%n_indefinite < system%controls%krylov%max_indefinite_factors
  end subroutine refactorise_bulk


  !> A and its factor, with the springs of contact in K, which improve the preconditioner.
  subroutine factorise_reduced_matrix(system, model, outcome, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: springs
    integer :: status
    outcome = OUTCOME_OK
    system%indefinite_factor%is_ready = .false.
    if (has_unsymmetric_law(system%assembly%skew) .and. .not. system%may_soften) system%reduced_system%is_shift_allowed = .false.
    if (any(has_spring(system%contact_tangents))) then
      call assemble_spring_matrix(system%contact_tangents, system%constraints%n_unknowns, springs)
      call factorise_reduced_system(system%reduced_system, sparse_sum(system%assembly%stiffness, 1.0_DP, springs), .true., &
        system%constraints, &
        model%mesh, status, error)
    else
      call factorise_reduced_system(system%reduced_system, system%assembly%stiffness, .false., system%constraints, model%mesh, &
        status, error)
    end if
    system%n_factorisations = system%n_factorisations + system%reduced_system%n_factorised
    system%n_shifted = system%n_shifted + system%reduced_system%n_shifted
    if (allocated(error)) return
    system%is_indefinite = status /= FACTOR_OK .and. .not. system%reduced_system%is_shift_allowed
    if (status /= FACTOR_OK .and. .not. system%is_indefinite) outcome = OUTCOME_LINEAR_SOLVER
  end subroutine factorise_reduced_matrix

end module amontons_newton_step
