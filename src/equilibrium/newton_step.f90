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
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type
  use amontons_model, only: model_type, n_nonlinear_mpcs
  use amontons_surfaces, only: is_compliant
  use amontons_steps, only: step_type, LINE_SEARCH_AUTO, TANGENT_SYMMETRIC, TANGENT_LAGGED, INTERFACE_DENSE, INTERFACE_SKIN, &
    SOLVER_AUTO, SOLVER_GRADIENTS
  use amontons_iteration_records, only: PHASE_ASSEMBLY, PHASE_CONTACT, PHASE_FACTOR, PHASE_KRYLOV
  use amontons_state, only: state_type, fields_type, DAMPING_NOW, STATUS_OPEN
  use amontons_sparse, only: sparse_type, multiply, multiply_transpose, multiply_symmetric, sparse_product, sparse_transpose, &
    full_from_upper, sparse_sum
  use amontons_factorization, only: lu_type, lu_factorise, lu_solve, FACTOR_OK
  use amontons_reduced_system, only: reduced_system_type, factorise_reduced_system, apply_reduced_inverse, abandon_iteration, &
    USE_SKIN
  use amontons_woodbury_interface, only: contact_springs_type
  use amontons_contact_preconditioner, only: partition_skin, build_skin_coarse_space, update_skin, apply_bulk, apply_coarse_space, &
    apply_tiles, subtract_contact
  use amontons_free_rigid_motions, only: find_motions, is_singular_along
  use amontons_robin_springs, only: find_near, robin_springs, skin_rows, master_shares
  use amontons_schur_interface, only: is_analysis_valid, analyse_bulk, factorise_bulk, factorise_interface, factorise_woodbury, &
    apply_schur_interface
  use amontons_krylov, only: operator_type, matrix_operator_type, krylov_options_type, krylov_report_type, gmres, &
    conjugate_gradients, KRYLOV_CONVERGED, KRYLOV_STAGNATED
  use amontons_distributed_solver, only: solve_distributed, DISTRIBUTED_NONE
  use amontons_constraints, only: eliminate_constraints, scale_offsets, condense_forces, build_condensation_matrix
  use amontons_nonlinear_mpc, only: add_mpc_stiffness
  use amontons_inertia, only: add_inertia_force, add_inertia_stiffness
  use amontons_stabilization, only: add_damping_force, add_damping_stiffness
  use amontons_unsymmetric_tangent, only: assemble_skew, subtract_skew_product, combine_with_skew
  use amontons_assembly, only: assemble_tangent, assemble_nodal_stiffness
  use amontons_external_loads, only: assemble_external_loads
  use amontons_contact_linearization, only: linearize_contact, drop_unsymmetric_terms, add_contact_rows
  use amontons_contact_operators, only: apply_contact_tangent, assemble_contact_tangents, assemble_spring_matrix, &
    factorise_spring_tangents
  use amontons_equilibrium, only: equilibrium_type, update_base_constraints, discard_bulk_factor, interface_unknowns, &
    mean_diagonal_stiffness, &
    start_clock, stop_clock, OUTCOME_OK, &
    OUTCOME_ELEMENT, OUTCOME_LINEAR_SOLVER
  implicit none
  private
  public :: solve_newton_step, solve_correction, linearize_equilibrium, set_proximal_shift, skin_merit_tolerance, solve_roughly, &
    apply_unconstrained_tangent, assemble_tangent_matrix, factorise_reduced_matrix
  public :: is_skin_chosen, configure_bulk_solver

  real(DP), parameter :: TOL_BACKWARD_ERROR = 8.0_DP * epsilon(1.0_DP)   !< backward error at rounding level [-]

  !> J: the exact tangent as an operator on the free unknowns.
  type, extends(operator_type) :: tangent_type
    type(equilibrium_type), pointer :: system => null()
  contains
    procedure :: apply => apply_tangent
  end type tangent_type

  !> inv(A): the factor as an operator.
  type, extends(operator_type) :: preconditioner_type
    type(equilibrium_type), pointer :: system => null()
  contains
    procedure :: apply => apply_preconditioner
  end type preconditioner_type

contains

  !> The Newton direction du at the configuration of the last evaluation.
  recursive subroutine solve_newton_step(system, model, step, state, du, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error   !< out of memory and the like
    integer(I64) :: clock
    if (system%skin%memory%is_outdated) call discard_bulk_factor(system)
    system%skin%memory%is_outdated = .false.
    call linearize_equilibrium(system, model, step, state, outcome, error)
    if (allocated(error) .or. outcome /= OUTCOME_OK) return
    call start_clock(system, clock)
    call prepare_interface_solver(system, model, step, state, error)
    if (allocated(error)) return
    if (system%is_interface_singular) outcome = OUTCOME_LINEAR_SOLVER
    if (.not. (system%has_interface_solver .or. system%is_interface_singular)) call factorise_reduced_matrix(system, model, &
      outcome, error)
    if (allocated(error) .or. outcome /= OUTCOME_OK) return
    call stop_clock(system, clock, PHASE_FACTOR)
    system%n_factorisations_before = system%n_factorisations
    system%is_subproblem_solved = .false.
    system%skin_tolerance = step%controls%skin%tolerance_single
    if (step%line_search == LINE_SEARCH_AUTO) system%skin_tolerance = merge(step%controls%skin%tolerance_origin, &
      step%controls%skin%tolerance_changing, sets_origins(system, state))
    system%is_first_direction = .false.
    call solve_constrained_system(system, admissible_residual(system, step), du, outcome, error)
    if (allocated(error)) return
    if (outcome == OUTCOME_LINEAR_SOLVER .and. system%is_skin .and. .not. system%skin%is_ready) then
      call solve_newton_step(system, model, step, state, du, outcome, error)
      return
    end if
    if (outcome == OUTCOME_LINEAR_SOLVER .and. .not. system%has_interface_solver .and. system%reduced_system%is_iterative) then
      call abandon_iteration(system%reduced_system)
      call factorise_reduced_matrix(system, model, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) return
      call solve_constrained_system(system, admissible_residual(system, step), du, outcome, error)
    end if
    call stop_clock(system, clock, PHASE_KRYLOV)
  end subroutine solve_newton_step


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


  !> The direction from a configuration of the linearised model, with the present tangent of the bulk.
  subroutine solve_correction(system, model, step, state, offset_fraction, du, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(in) :: offset_fraction                  !< fraction of the remaining prescribed displacements that the
                                                             !! direction applies [-]
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    integer, intent(out) :: outcome                !< OUTCOME_...
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: allowed_residual                              ! [force]
    integer(I64) :: clock
    call start_clock(system, clock)
    outcome = OUTCOME_LINEAR_SOLVER
    call build_constraints(system, model, step, state%old, state%new, offset_fraction, error)
    if (allocated(error)) return
    call stop_clock(system, clock, PHASE_CONTACT)
    call prepare_interface_solver(system, model, step, state, error)
    if (allocated(error) .or. .not. system%has_interface_solver) return
    call stop_clock(system, clock, PHASE_FACTOR)
    system%skin_tolerance = merge(step%controls%skin%tolerance_changing, step%controls%skin%tolerance_unchanged, &
      system%contact%n_changed > 0)
    if (system%n_halved > 1) system%skin_tolerance = min(system%skin_tolerance, step%controls%skin%tolerance_halved)
    allowed_residual = system%controls%krylov%newton_tolerance_share * step%controls%r_n * system%largest_force
    if (system%is_skin) allowed_residual = 0.5_DP * skin_merit_tolerance(system, step)
    call solve_constrained_system(system, allowed_residual, du, outcome, error)
    call stop_clock(system, clock, PHASE_KRYLOV)
  end subroutine solve_correction


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
    integer(I64) :: clock
    outcome = OUTCOME_OK
    call start_clock(system, clock)
    if (.not. system%is_assembled) then
      system%reduced_system%is_current = .false.
      call assemble_bulk(system, model, step, state, outcome, error)
      if (allocated(error) .or. outcome /= OUTCOME_OK) return
      system%is_assembled = system%is_constant .or. step%direction == TANGENT_LAGGED .or. step%solver == SOLVER_GRADIENTS
      system%is_bulk_factor_current = system%is_constant .and. (system%schur_interface%is_ready .or. system%skin%is_ready)
    end if
    call set_slave_stiffness(system, step, state%new)
    call stop_clock(system, clock, PHASE_ASSEMBLY)
    call build_constraints(system, model, step, state%old, state%new, 1.0_DP, error)
    call stop_clock(system, clock, PHASE_CONTACT)
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
    call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
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
  end subroutine assemble_bulk


  !> The scale c of the trial traction: the mean diagonal stiffness of the node in K. Conjugate gradients evaluate compliant laws at
  !! the gap itself: c = 0.
  subroutine set_slave_stiffness(system, step, fields)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    type(fields_type), intent(inout) :: fields
    integer :: s
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        slave%stiffness = mean_diagonal_stiffness(system, slave%node)
        if (step%solver == SOLVER_GRADIENTS .and. is_compliant(system%contact%laws(slave%pair))) slave%stiffness = 0.0_DP
      end associate
    end do
  end subroutine set_slave_stiffness


  !> C and c of all constraints, contact rows included.
  subroutine build_constraints(system, model, step, old, fields, offset_fraction, error)
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
  end subroutine build_constraints


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
    is_skin_chosen = count(system%is_interface_unknown) > system%controls%contact_interface%max_unknowns .or. &
      system%reduced_system%is_iterative .or. is_skin_cheaper(system, system%controls%contact_interface%usual_skin_iterations)
  end function is_skin_chosen


  !> Whether a round with so many Krylov iterations on the skin costs less than one on the dense interface.
  pure logical function is_skin_cheaper(system, n_iterations)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: n_iterations
    associate (limits => system%controls%contact_interface)
      is_skin_cheaper = limits%dense_work_ratio * real(count(system%is_interface_unknown), DP)**3 * limits%usual_skin_iterations > &
        n_iterations * real(system%base%n_free, DP)
    end associate
  end function is_skin_cheaper


  !> Contact by the skin: the bulk solver is computed if none is available, the tiles always. After: is_skin and
  !! has_interface_solver.
  subroutine factorise_skin(system, model, step, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< not changed
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: imbalance_tangent, displacement_tangent, rows, shares
    call ensure_bulk_factor(system, model, step, state, .true., error)
    if (allocated(error) .or. .not. system%skin%is_ready) return
    call assemble_contact_tangents(system%contact_tangents, system%contact%force_condensation, system%constraints%n_unknowns, &
      imbalance_tangent, displacement_tangent)
    if (any(model%pairs%has_point_contact)) system%skin%memory%is_near = &   ! points change
      find_near(system%contact, state%new, step%controls%contact_interface%max_gap)
    call skin_rows(system%contact, state%new, system%skin%memory%is_near, system%contact_tangents, model%mesh%n_nodes, rows)
    call master_shares(system%contact_tangents, model%mesh%n_nodes, shares, error)
    if (allocated(error)) return
    call update_skin(system%skin, system%base, system%constraints, system%assembly%stiffness, imbalance_tangent, &
      displacement_tangent, rows, shares, error)
    if (allocated(error)) return
    system%is_skin = .true.
    system%is_interface_singular = has_free_motion(system)
    system%has_interface_solver = .not. system%is_interface_singular
  end subroutine factorise_skin


  !> Whether the tangent is singular along a rigid body motion.
  logical function has_free_motion(system)
    type(equilibrium_type), intent(inout), target :: system
    type(tangent_type) :: tangent
    real(DP), allocatable :: images(:, :), scales(:, :)
    integer :: i, k, f
    has_free_motion = .false.
    if (system%motions%n == 0) return
    tangent%system => system
    allocate (images(system%constraints%n_free, system%motions%n), scales(system%constraints%n_free, system%motions%n))
    do k = 1, system%motions%n
      do i = 1, system%constraints%n_unknowns
        f = system%constraints%free_of(i)
        if (f > 0) scales(f, k) = system%motions%value(i, k)
      end do
      call tangent%apply(scales(:, k), images(:, k))
      do i = 1, system%constraints%n_unknowns
        f = system%constraints%free_of(i)
        if (f > 0) scales(f, k) = scales(f, k) * system%assembly%stiffness%value(system%assembly%stiffness%first(i))
      end do
    end do
    has_free_motion = is_singular_along(images, scales, system%controls%skin%free_motion_ratio)
  end function has_free_motion


  !> K with Robin springs, and its solver: a factor, or the two-level preconditioner where that is too large.
  subroutine update_bulk_solver(system, model, step, fields, is_resumed, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_resumed              !< with the springs of the interrupted job
    type(error_type), allocatable, intent(out) :: error
    logical :: is_slave(model%mesh%n_nodes)
    logical, allocatable :: is_angle(:)
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
        system%base%n_unknowns, system%skin%memory%springs, error)
      if (allocated(error)) return
    end if
    call configure_bulk_solver(system%skin%robin, step)
    if (system%skin%memory%is_factor_needed .and. system%skin%robin%is_iterative) call abandon_iteration(system%skin%robin)
    system%skin%robin%is_iteration_abandoned = system%skin%memory%is_factor_needed
    call factorise_reduced_system(system%skin%robin, sparse_sum(system%assembly%stiffness, 1.0_DP, system%skin%memory%springs), &
      .true., system%base, &
      model%mesh, &
      status, error)
    if (allocated(error)) return
    allocate (is_angle(model%mesh%n_nodes), source=.false.)
    if (size(system%rotation_length) > 0) is_angle = system%rotation_length < 1.0_DP .or. system%rotation_length > 1.0_DP
    call find_motions(system%controls%skin, system%assembly%stiffness, system%base, model%mesh%coordinates + fields%u, is_angle, &
      system%motions)
    system%n_factorisations = system%n_factorisations + system%skin%robin%n_factorised
    system%skin%is_ready = status == FACTOR_OK
    if (system%skin%is_ready) call build_skin_coarse_space(system%skin, system%base, model%mesh%coordinates, &
      system%controls%skin%coarse_patches)
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
    call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
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
      if (count(system%is_interface_unknown) > system%controls%contact_interface%max_unknowns) return
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


  !> A and its factor, with the springs of compliant contact in K, which improve the preconditioner.
  subroutine factorise_reduced_matrix(system, model, outcome, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: springs
    integer :: status
    outcome = OUTCOME_OK
    if (any(system%contact_tangents%is_compliant_node)) then
      call assemble_spring_matrix(system%contact_tangents, system%constraints%n_unknowns, springs, error)
      if (allocated(error)) return
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
    if (status /= FACTOR_OK) outcome = OUTCOME_LINEAR_SOLVER
  end subroutine factorise_reduced_matrix


  !> Solves J dv = C' (R - (K - dF_c) c) and gives du = C dv + c.
  subroutine solve_constrained_system(system, allowed_residual, du, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: allowed_residual                  !< residual that is small enough [force]
    real(DP), intent(out) :: du(:, :)
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: b(:), v(:), start(:), flat(:)
    outcome = OUTCOME_OK
    allocate (b(system%constraints%n_free), v(system%constraints%n_free), start(system%constraints%n_unknowns), &
      flat(system%constraints%n_unknowns))
    v = 0.0_DP
    flat = system%constraints%offset
    call right_hand_side(system, flat, b)
    if (system%constraints%n_free > 0) then
      call run_krylov(system, allowed_residual, b, v, outcome, error)
      if (allocated(error)) return
      call multiply(system%constraints%transformation, v, start)
      flat = flat + start
    end if
    du = reshape(flat, shape(du))
  end subroutine solve_constrained_system


  !> Solves J v = b by conjugate gradients where J = A and A is not factorised, else by GMRES.
  subroutine run_krylov(system, allowed_residual, b, v, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: allowed_residual                  !< residual that is small enough [force]
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(tangent_type) :: tangent
    type(matrix_operator_type) :: matrix
    type(preconditioner_type) :: preconditioner
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    logical :: is_iterative, is_symmetric
    outcome = OUTCOME_OK
    is_iterative = system%reduced_system%is_iterative .and. .not. system%has_interface_solver
    if (system%is_skin) then
      call solve_by_skin(system, allowed_residual, b, v, outcome, error)
      return
    end if
    tangent%system => system
    matrix%matrix => system%reduced_system%matrix
    preconditioner%system => system
    options%tolerance = system%controls%krylov%tolerance
    options%absolute_tolerance = allowed_residual
    options%max_iterations = merge(system%reduced_system%max_iterations, system%controls%krylov%max_iterations, is_iterative)
    if (is_iterative) options%tolerance = system%controls%krylov%iterative_tolerance
    system%schur_interface%allowed_residual = max(options%tolerance, allowed_residual / max(norm2(b), tiny(allowed_residual)))
    is_symmetric = size(system%contact_tangents) == 0 .and. .not. allocated(system%assembly%skew%matrix%first)
    if (is_iterative .and. is_symmetric .and. system%reduced_system%distributed_kind /= DISTRIBUTED_NONE) then
      call solve_distributed(system%reduced_system%distributed, b, v, options, report, error)
      if (allocated(error)) return
    else if (is_iterative .and. is_symmetric) then
      call conjugate_gradients(matrix, preconditioner, b, v, options, report)
    else
      call gmres(tangent, preconditioner, b, v, options, report, error)
      if (allocated(error)) return
    end if
    system%n_krylov = system%n_krylov + report%n_iterations
    if (system%has_interface_solver .and. report%n_iterations > system%controls%krylov%max_stale_iterations &
      .and. .not. system%is_bulk_factor_current) call discard_bulk_factor(system)
    if (report%status == KRYLOV_CONVERGED) return
    if (report%status == KRYLOV_STAGNATED .and. is_at_rounding_level(system, report%residual * norm2(b), v)) return
    if (is_iterative .and. report%residual <= system%controls%krylov%tolerance) return   ! at rounding level for a slender body
    if (is_iterative) outcome = OUTCOME_LINEAR_SOLVER
    if (.not. is_iterative) call solve_by_umfpack(system, b, v, outcome, error)
  end subroutine run_krylov


  !> Solves J v = b with the contact skin. The linearised model includes the remaining residual, and the next correction reduces it.
  subroutine solve_by_skin(system, allowed_residual, b, v, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: allowed_residual                  !< residual that is small enough [force]
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(tangent_type) :: tangent
    type(preconditioner_type) :: preconditioner
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    outcome = OUTCOME_OK
    tangent%system => system
    preconditioner%system => system
    options%tolerance = system%skin_tolerance
    options%absolute_tolerance = allowed_residual
    options%max_iterations = system%controls%skin%max_iterations
    options%restart = system%controls%skin%restart
    call gmres(tangent, preconditioner, b, v, options, report, error)
    if (allocated(error)) return
    system%n_krylov = system%n_krylov + report%n_iterations
    if (report%status /= KRYLOV_CONVERGED .and. report%residual > system%controls%skin%max_residual) outcome = OUTCOME_LINEAR_SOLVER
    call check_skin_convergence(system, report, outcome)
  end subroutine solve_by_skin


  !> Recomputes the bulk solver after slow solves. Where that did not help, or no direction was found, the step continues with a
  !! factor of the bulk in place of two levels, then with the dense interface if that is allowed and cheaper.
  subroutine check_skin_convergence(system, report, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(krylov_report_type), intent(in) :: report !< of a direction
    integer, intent(in) :: outcome                 !< OUTCOME_LINEAR_SOLVER: no direction was found
    real(DP) :: n_iterations, digits, slow_iterations
    logical :: is_lost, is_slow_again, is_replaced
    is_lost = outcome /= OUTCOME_OK
    n_iterations = real(report%n_iterations, DP)
    digits = -log10(max(report%residual, tiny(1.0_DP)))
    associate (memory => system%skin%memory)
      slow_iterations = system%controls%skin%slow_iterations * max(2.0_DP, digits)
      if (system%skin%robin%is_iterative) slow_iterations = slow_iterations * system%controls%skin%two_level_ratio
      if (n_iterations > slow_iterations) memory%n_slow = memory%n_slow + 1
      if (memory%n_slow <= memory%slow_limit .and. .not. is_lost) return
      is_slow_again = memory%slow_limit > system%controls%skin%max_slow_solves
      if (system%skin%robin%is_iterative) then
        if (.not. system%skin%robin%cost%is_factor_too_large) memory%is_factor_needed = is_lost .or. &
          (is_slow_again .and. system%skin%robin%requested_solver == SOLVER_AUTO)
      else
        memory%is_abandoned = count(system%is_interface_unknown) <= system%controls%contact_interface%max_unknowns .and. &
          (is_lost .or. (is_slow_again .and. .not. is_skin_cheaper(system, n_iterations)))
      end if
      is_replaced = memory%is_abandoned .or. (system%skin%robin%is_iterative .and. memory%is_factor_needed)
      if (is_lost .and. .not. is_replaced) return
      memory%is_outdated = .not. (system%is_constant .or. memory%is_abandoned .or. is_lost)
      if (.not. memory%is_outdated) call discard_bulk_factor(system)
      memory%n_slow = 0
      memory%slow_limit = 2 * memory%slow_limit        ! recompute it later next time
      if (is_replaced) memory%slow_limit = system%controls%skin%max_slow_solves
    end associate
  end subroutine check_skin_convergence


  !> v ~ inv(J) b with the present factor. Cost: one solution; with the skin the Krylov iterations for one digit.
  subroutine solve_roughly(system, b, v)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(out) :: v(:)                  !< (n_free) [length]
    type(preconditioner_type) :: preconditioner
    type(error_type), allocatable :: error         ! out of memory: v keeps the initial guess
    integer :: outcome
    preconditioner%system => system
    v = 0.0_DP
    if (system%is_skin) then
      system%skin_tolerance = system%controls%skin%tolerance_length
      call solve_by_skin(system, 0.0_DP, b, v, outcome, error)
    else
      call preconditioner%apply(b, v)
    end if
  end subroutine solve_roughly


  !> Whether the residual of a direction is at rounding level of the product of stiffness and direction (backward error), as with
  !! large displacements of weakly supported bodies. No factorisation would give a better direction (N. J. Higham, Accuracy and
  !! Stability of Numerical Algorithms, 2nd ed., SIAM 2002, section 7.1).
  pure logical function is_at_rounding_level(system, residual, v)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: residual               !< norm of the residual [force]
    real(DP), intent(in) :: v(:)                   !< (n_free) [length]
    is_at_rounding_level = residual <= TOL_BACKWARD_ERROR * maxval(abs(system%assembly%stiffness%value)) * norm2(v)
  end function is_at_rounding_level


  !> The fall-back when GMRES does not converge: J as a matrix, factorised by UMFPACK with pivoting.
  subroutine solve_by_umfpack(system, b, v, outcome, error)
    type(equilibrium_type), intent(inout) :: system
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: J
    type(lu_type) :: lu
    integer :: status
    outcome = OUTCOME_OK
    call assemble_tangent_matrix(system, J, error)
    if (allocated(error)) return
    call lu_factorise(lu, J, status, error)
    if (allocated(error)) return
    system%n_factorisations = system%n_factorisations + 1
    system%n_umfpack = system%n_umfpack + 1
    if (status == FACTOR_OK) call lu_solve(lu, b, v)
    if (status /= FACTOR_OK .or. .not. all(abs(v) <= huge(1.0_DP))) outcome = OUTCOME_LINEAR_SOLVER
  end subroutine solve_by_umfpack


  !> J = C' (K + D_R E K - D_u) C, with dF_c = D_R dRhat + D_u du and dRhat = -E K du.
  subroutine assemble_tangent_matrix(system, J, error)
    type(equilibrium_type), intent(in) :: system
    type(sparse_type), intent(out) :: J            !< (n_free x n_free)
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: K, E, imbalance_tangent, displacement_tangent
    K = combine_with_skew(full_from_upper(system%assembly%stiffness), system%assembly%skew)
    call build_condensation_matrix(system%base, E, error)
    if (allocated(error)) return
    call assemble_contact_tangents(system%contact_tangents, system%contact%force_condensation, system%constraints%n_unknowns, &
      imbalance_tangent, displacement_tangent)
    K = sparse_sum(K, 1.0_DP, sparse_product(imbalance_tangent, sparse_product(E, K)))
    K = sparse_sum(K, -1.0_DP, displacement_tangent)
    J = sparse_product(sparse_transpose(system%constraints%transformation), sparse_product(K, system%constraints%transformation))
  end subroutine assemble_tangent_matrix


  !> b = C' (R + F_a - K c + dF_c(c)), with F_a the force of the linearised compliant laws at the present gaps less that in R.
  subroutine right_hand_side(system, offset, b)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: offset(:)              !< c [length]
    real(DP), intent(out) :: b(:)
    real(DP), allocatable :: change(:)
    allocate (change(size(offset)))
    change = 0.0_DP
    if (any(offset /= 0.0_DP)) call apply_unconstrained_tangent(system, offset, change)
    call multiply_transpose(system%constraints%transformation, reshape(system%residual_at_gap, shape(change)) - change, b)
  end subroutine right_hand_side


  !> w = (K - dF_c) du over all unknowns: minus the change of the residual.
  subroutine apply_unconstrained_tangent(system, flat, w)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: flat(:)                !< du (n_unknowns) [length]
    real(DP), intent(out) :: w(:)                  !< (n_unknowns) [force]
    real(DP), allocatable :: du(:, :), d_imbalance(:, :), d_force(:, :)
    call multiply_symmetric(system%assembly%stiffness, flat, w)
    call subtract_skew_product(system%assembly%skew, flat, w)
    if (size(system%contact_tangents) == 0) return
    allocate (d_imbalance(3, size(flat) / 3), d_force(3, size(flat) / 3))
    du = reshape(flat, [3, size(flat) / 3])
    call condense_forces(system%base, reshape(-w, shape(du)), d_imbalance)
    if (system%is_skin) then
      call subtract_contact(system%skin, flat, reshape(d_imbalance, shape(w)), w)
      return
    end if
    call apply_contact_tangent(system%contact_tangents, system%contact%force_condensation, du, d_imbalance, d_force)
    w = w - reshape(d_force, shape(w))
  end subroutine apply_unconstrained_tangent


  !> y = J x.
  subroutine apply_tangent(self, x, y)
    class(tangent_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [length]
    real(DP), intent(out) :: y(:)                  !< (n_free) [force]
    real(DP), allocatable :: flat(:), w(:)
    allocate (flat(self%system%constraints%n_unknowns), w(self%system%constraints%n_unknowns))
    call multiply(self%system%constraints%transformation, x, flat)
    call apply_unconstrained_tangent(self%system, flat, w)
    call multiply_transpose(self%system%constraints%transformation, w, y)
  end subroutine apply_tangent


  !> y = inv(A) x.
  subroutine apply_preconditioner(self, x, y)
    class(preconditioner_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    if (self%system%is_skin) then
      call apply_skin_preconditioner(self%system, x, y)
    else if (self%system%has_interface_solver) then
      call apply_schur_interface(self%system%schur_interface, x, y)
    else
      call apply_reduced_inverse(self%system%reduced_system, x, y)
    end if
  end subroutine apply_preconditioner


  !> y ~ inv(J) x by the bulk solver, then by the coarse space and the tiles.
  subroutine apply_skin_preconditioner(system, x, y)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    type(tangent_type) :: tangent
    real(DP), allocatable :: rest(:)
    tangent%system => system
    allocate (rest(size(x)))
    call apply_bulk(system%skin, x, y)
    call tangent%apply(y, rest)
    rest = x - rest
    call apply_coarse_space(system%skin, rest, y)
    call apply_tiles(system%skin, rest, y)
  end subroutine apply_skin_preconditioner

end module amontons_newton_step
