!> The equilibrium equations at one configuration: force imbalance, contact forces and residual, and the data kept between
!! configurations.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `evaluate_equilibrium` evaluates elements and contact; `evaluate_linearized` evaluates contact, with the element forces
!! linearised.
!! Both give forces only. The tangent matrix and the Newton direction are in `newton_step`.
module amontons_equilibrium
  use amontons_kinds, only: DP
  use amontons_containers, only: integer_list_type
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_model, only: model_type, n_nonlinear_mpcs, absent_elements, list_follower_nodes, has_unsymmetric_elements, has_damage
  use amontons_surfaces, only: is_compliant
  use amontons_controls, only: controls_type, PRECONDITIONER_NODAL, PRECONDITIONER_DIAGONAL
  use amontons_steps, only: step_type, SOLVER_AUTO, SOLVER_ITERATIVE, SOLVER_GRADIENTS, SOLVER_BDDC
  use amontons_iteration_records, only: PHASE_ASSEMBLY, PHASE_CONTACT, PHASE_OTHER
  use amontons_phase_clock, only: phase_clock_type
  use amontons_state, only: state_type, fields_type, slave_state_type, create_state, create_material_state, set_temperatures, &
    take_points, DAMPING_NOW, STATUS_OPEN, STATUS_STICK
  use amontons_user_state, only: update_user_fields
  use amontons_model_change, only: find_unconnected_unknowns
  use amontons_sparse, only: sparse_type
  use amontons_factorization, only: lu_type
  use amontons_mpi_ranks, only: n_ranks
  use amontons_reduced_system, only: reduced_system_type, plan_reduced_solver, is_factor_small, choose_division, discard_analysis, &
    discard_iteration, USE_ONCE, USE_REPEATED, USE_NEWTON
  use amontons_schur_interface, only: schur_interface_type
  use amontons_contact_preconditioner, only: skin_type
  use amontons_free_rigid_motions, only: free_motions_type
  use amontons_constraints, only: constraints_type, condense_forces, build_condensation_matrix
  use amontons_nonlinear_mpc, only: extract_support_reactions, list_hessian_nodes, find_rotation_lengths
  use amontons_boundary_conditions, only: build_base_constraints
  use amontons_inertia, only: add_inertia_force
  use amontons_stabilization, only: is_damped, set_damping_factor, find_nodal_volumes, set_first_factor, add_damping_force
  use amontons_assembly_plan, only: assembly_type, create_assembly, ensure_matrix, multiply_stiffness, node_diagonal, &
    stiffness_diagonal, couple_nodes
  use amontons_assembly, only: share_points, assemble_forces
  use amontons_external_loads, only: assemble_external_loads
  use amontons_user_element_forces, only: add_user_forces
  use amontons_user_elements, only: user_unknowns
  use amontons_master_symmetry_planes, only: find_symmetry_planes, find_fixed_directions
  use amontons_contact_step, only: begin_contact_step
  use amontons_midside_constraints, only: hold_all_midsides, begin_midsides, update_midsides
  use amontons_contact_pairs, only: contact_type, create_contact, set_free_directions, current_row, renew_searches
  use amontons_contact_evaluation, only: evaluate_contact
  use amontons_slave_nodes, only: contact_force_rounding
  use amontons_friction_slip_scenarios, only: slip_state_type
  use amontons_contact_initialization, only: initialize_contact
  use amontons_contact_integration_points, only: update_points
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_linearization, only: contact_tangent_type
  implicit none
  private
  public :: equilibrium_type, create_equilibrium, begin_step, plan_solver, begin_increment, evaluate_equilibrium, &
    directional_residual, residual_sizes, largest_above_rounding
  public :: max_components, nodal_norms, configuration_type, save_configuration, evaluate_linearized, restore_configuration
  public :: mean_diagonal_stiffness, is_matrix_free_step, has_moving_supports, evaluate_points
  public :: undivide_matrix, update_base_constraints, update_midside_constraints, discard_bulk_factor, discard_matrices, &
    interface_unknowns, n_interface_unknowns
  public :: OUTCOME_OK, OUTCOME_ELEMENT, OUTCOME_LINEAR_SOLVER, OUTCOME_NOT_FINITE, OUTCOME_UNSUPPORTED, OUTCOME_TUNNELLING, &
    OUTCOME_CONSTRAINTS

  integer, parameter :: OUTCOME_OK = 0
  integer, parameter :: OUTCOME_ELEMENT = 1        !< an element is inverted: system%failed_element is its index
  integer, parameter :: OUTCOME_LINEAR_SOLVER = 2         !< the tangent is singular: no direction found
  integer, parameter :: OUTCOME_NOT_FINITE = 3     !< a number is not finite
  integer, parameter :: OUTCOME_UNSUPPORTED = 4           !< rigid body motion: a body is not supported
  integer, parameter :: OUTCOME_TUNNELLING = 5        !< a slave node passed through its master
  integer, parameter :: OUTCOME_CONSTRAINTS = 6    !< constraints contradict each other: system%conflict says which

  real(DP), parameter :: ROUNDING_FACTOR = 10.0_DP             !< roundings of a gap in the computation of a force, at most [-]

  !> The equilibrium equations, with all data kept between configurations.
  type :: equilibrium_type
    type(assembly_type) :: assembly
    type(contact_type) :: contact
    type(constraints_type) :: base                 !< boundary conditions, equations, midside constraints
    type(constraints_type) :: constraints                !< those and the rows of the closed nodes
    type(contact_tangent_type), allocatable :: contact_tangents(:)       !< linearised contact forces
    type(reduced_system_type) :: reduced_system                  !< A and its factor
    type(lu_type) :: indefinite_factor             !< of J in a RIKS step, where A is not positive
    logical :: is_indefinite = .false.             !< the present direction uses it
    logical :: may_soften = .false.                !< tractions fall by damage
    logical :: may_collapse = .false.              !< so it is, or a limit load is possible: a law flows, and forces alone act
    logical :: seeks_descent = .false.             !< may_collapse, and a shorter increment can follow this attempt; or may_snap
    logical :: may_snap = .false.                  !< may_soften, and this attempt descends to the next equilibrium, however far
    type(schur_interface_type) :: schur_interface              !< the factor of the bulk and the Schur complement of the interface,
                                                               !! where that is cheaper
    type(skin_type) :: skin                        !< the preconditioner of wide contact interfaces
    logical :: is_dividable = .false.              !< products and directions of the iteration alone need K: it may be divided
    type(free_motions_type) :: motions             !< rigid body motions that the supports alone do not restrain
    real(DP) :: skin_tolerance = 1.0e-6_DP         !< of a direction with the skin: residual over right-hand side [-]
    logical :: is_first_direction = .true.         !< of the increment: it sets the origins of slip of the nodes that close
    real(DP) :: forcing_term = 1.0e-2_DP           !< admissible merit of a contact subproblem over that at its start [-]
    type(controls_type) :: controls                !< of the present step
    logical :: is_skin = .false.                   !< the present direction uses the skin
    integer :: max_old_iterations = 0              !< of the present direction with the factor of an earlier K; 0: it has its own
    logical :: has_interface_solver = .false.       !< the present direction has an interface solver: dense, or the contact skin
    logical :: is_subproblem_solved = .false.                !< the contact subproblem of the present direction is solved
    logical :: is_schur_allowed = .true.            !< the interface is not known to be too large
    real(DP), allocatable :: bulk_factor_u(:, :)          !< (3, n_nodes) u at the factorisation of the bulk [length]; not
                                                          !! allocated: no factor
    logical :: is_bulk_factor_current = .false.               !< that factor is one of the present K
    logical :: is_interface_singular = .false.                 !< at the present direction the interface is singular: rigid body
                                                               !! motion
    logical, allocatable :: is_interface_unknown(:)          !< (n_unknowns) on the interface
    logical, allocatable :: is_held(:)             !< (n_unknowns) unknowns restrained by the base constraints at the analysis of
                                                   !! the bulk
    real(DP) :: proximal_shift = 0                          !< fraction of its own diagonal added to K, for unsupported bodies [-]
    logical :: is_bulk_nlgeom = .false.            !< the factor of the bulk is one of a step with NLGEOM
    logical, allocatable :: has_no_element(:)             !< (3 n_nodes) of a node without elements
    real(DP), allocatable :: volume_share(:)              !< (n_nodes) nodal volumes, for damping; not allocated: no step was
                                                          !! damped [length^3]
    real(DP), allocatable :: mass(:)               !< consistent mass of pairs of nodes in a DYNAMIC step, from its first
                                                   !! evaluation on [mass]
    real(DP) :: mpc_violation = 0                      !< largest violation of the nonlinear MPCs at the last evaluation, over
                                                       !! their size [-]
    real(DP), allocatable :: rotation_length(:)              !< (n_nodes) factor from an angle to a length; empty: no angles
                                                             !! [length]
    logical :: is_matrix_free = .false.            !< K is not assembled in this step, only its nodal blocks
    real(DP), allocatable :: nodal_stiffness(:, :, :)   !< (3, 3, n_nodes) diagonal blocks of K, in a matrix-free step
                                                        !! [force/length]
    integer :: n_evaluations = 0                   !< evaluations of the residual by conjugate gradients
    real(DP), allocatable :: u_start(:, :)         !< (3, n_nodes) displacement at the start of the step [length]
    real(DP), allocatable :: reference_force(:, :)   !< (3, n_nodes) RIKS: dF_ext over the load factor, at the linearisation
                                                     !! [force]
    real(DP), allocatable :: reference_offset(:)   !< (n_unknowns) RIKS: dc over the load factor; not allocated: supports do not
                                                   !! move [length]
    real(DP), allocatable :: imbalance(:, :)       !< (3, n_nodes) Rhat = F_ext - F_int, condensed on the free unknowns [force]
    real(DP), allocatable :: residual(:, :)        !< (3, n_nodes) R = Rhat + F_c, condensed [force]
    real(DP), allocatable :: residual_at_gap(:, :)          !< (3, n_nodes) R with the compliant laws evaluated at the present gaps
                                                            !! [force]
    real(DP) :: largest_residual = 0               !< [force]
    real(DP) :: largest_force = 0                  !< largest internal, applied or contact force on a node [force]
    real(DP) :: bulk_force = 0                     !< largest internal or applied force on a node [force]
    real(DP) :: force_rounding = 0                       !< force error from rounding of gaps, treated as zero residual [force]
    real(DP) :: linearized_rounding = 0            !< error of the merit from rounding of K du, at the last linearised evaluation
                                                   !! [force]
    real(DP) :: merit = 0                          !< norm of residual, gaps and stick violations scaled to forces [force]
    logical :: is_nlgeom = .false.
    logical :: is_constant = .false.               !< the stiffness is constant in this step
    logical :: is_assembled = .false.              !< the constant stiffness is assembled
    integer :: n_conflicts = 0                     !< contact rows dropped because of other constraints
    integer :: failed_element = 0
    type(error_type), allocatable :: conflict      !< of constraints, at the last evaluation; not allocated: none
    integer :: n_factorisations = 0                !< since the last reset by increment_control
    integer :: n_factorisations_before = 0                        !< n_factorisations at the start of the direction
    integer :: n_krylov = 0
    integer :: n_subproblem_iterations = 0                        !< corrections of directions in contact subproblems
    integer :: n_halved = 0                        !< halved corrections in contact subproblems
    integer :: n_indefinite = 0                      !< factorisations of the bulk in this attempt that found it indefinite
    integer :: n_shifted = 0                       !< factorisations that needed a shift
    integer :: n_umfpack = 0                         !< directions solved by UMFPACK
    type(phase_clock_type) :: clock
  end type equilibrium_type

  !> An evaluated configuration: the start of linearised evaluations, and the point to restore.
  type :: configuration_type
    real(DP), allocatable :: u(:, :)               !< (3, n_nodes) [length]
    real(DP), allocatable :: internal_force(:, :)  !< (3, n_nodes) [force]
    real(DP), allocatable :: applied_force(:, :)   !< (3, n_nodes) applied force, also that of linearised evaluations from here
                                                   !! [force]
    real(DP), allocatable :: residual(:, :)        !< (3, n_nodes) R [force]
    type(slave_state_type), allocatable :: slaves(:)
    type(slip_state_type), allocatable :: slip_data(:)  !< (n_slaves)
    real(DP) :: merit = 0                          !< [force]
    real(DP) :: load_factor = 0                    !< [-]
  end type configuration_type

contains

  !> Creates assembly, contact and the initial state.
  subroutine create_equilibrium(system, model, state, error, has_trial_points)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(out) :: state
    type(error_type), allocatable, intent(out) :: error
    logical, intent(in), optional :: has_trial_points !< of the state
    call prepare_state(system, model, has_trial_points, state, error)
    if (allocated(error)) return
    call prepare_nonlinear_mpcs(system, model, size(state%old%slaves) > 0, error)
    if (allocated(error)) return
    allocate (system%u_start(3, model%mesh%n_nodes), system%imbalance(3, model%mesh%n_nodes), &
      system%residual(3, model%mesh%n_nodes), system%residual_at_gap(3, model%mesh%n_nodes), source=0.0_DP)
  end subroutine create_equilibrium


  !> The pattern of the stiffness, with the couplings of nonlinear MPCs, follower forces and user elements, and the unknowns without
  !! elements.
  subroutine prepare_nonlinear_mpcs(system, model, has_contact, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    logical, intent(in) :: has_contact
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: first(:), nodes(:)
    integer :: i
    call list_coupled_nodes(model, first, nodes)
    system%is_dividable = is_division_possible(model, has_contact .or. size(nodes) > 0)
    if (n_ranks() > 1 .and. .not. system%is_dividable .and. any(model%steps%solver == SOLVER_BDDC)) then
      call set_error(error, EXIT_SETUP, 'SOLVER=BDDC on several ranks takes the stiffness of each rank''s own elements, which ' // &
        'contact, user elements, nonlinear MPCs, forces that turn with nodes, unsymmetric laws, RIKS, DYNAMIC, STABILIZE and ' // &
        'SOLVER=CONJUGATE GRADIENTS do not leave apart. ITERATIVE SCALING, GAMG, HYPRE and MUMPS are allowed; without SOLVER ' // &
        'the program chooses.')
      return
    end if
    call create_assembly(system%assembly, model%mesh, error, first, nodes, &
      is_matrix_free=size(model%steps) > 0 .and. all([(is_matrix_free_step(model%steps(i)), i=1, size(model%steps))]), &
      is_deferred=system%is_dividable)
    if (allocated(error)) return
    system%reduced_system%is_idle = [(system%assembly%is_idle((i + 2) / 3), i=1, 3 * model%mesh%n_nodes)]
    system%skin%robin%is_idle = system%reduced_system%is_idle
    system%has_no_element = find_unconnected(model, absent_elements(model, 1))
    system%rotation_length = find_rotation_lengths(model)
  end subroutine prepare_nonlinear_mpcs


  !> Whether K may be divided among the ranks: there are several, and elements alone contribute to it, symmetrically, with direct
  !! steps that do not look for a path.
  function is_division_possible(model, has_more) result(is_possible)
    type(model_type), intent(in) :: model
    logical, intent(in) :: has_more                !< contact, or nodes that K couples without an element
    logical :: is_possible
    integer :: i
    is_possible = n_ranks() > 1 .and. .not. has_more .and. size(model%steps) > 0
    if (is_possible) is_possible = .not. has_unsymmetric_elements(model)
    if (.not. is_possible) return
    do i = 1, size(model%steps)
      if (model%steps(i)%is_riks .or. has_rate_forces(model%steps(i)) .or. model%steps(i)%solver == SOLVER_GRADIENTS) &
        is_possible = .false.
    end do
  end function is_division_possible


  !> Groups of nodes that K couples besides those of an element of the mesh.
  subroutine list_coupled_nodes(model, first, nodes)
    type(model_type), intent(in) :: model
    integer, allocatable, intent(out) :: first(:)  !< (groups + 1) start of a group
    integer, allocatable, intent(out) :: nodes(:)
    type(integer_list_type) :: starts, list
    integer, allocatable :: turning(:)
    integer :: i
    call starts%add(1)
    do i = 1, n_nonlinear_mpcs(model)              ! second derivatives, which count under NLGEOM
      if (any(model%steps%is_nlgeom)) call add_group(list_hessian_nodes(model%nonlinear_mpcs(i)))
    end do
    turning = list_follower_nodes(model)
    do i = 1, size(turning)
      call add_group([turning(i), model%rotation_of(turning(i))])
    end do
    if (allocated(model%user_elements)) then
      do i = 1, size(model%user_elements%elements)
        call add_group(model%user_elements%elements(i)%nodes)
      end do
    end if
    first = starts%trimmed()
    nodes = list%trimmed()

  contains

    !> Appends a group.
    subroutine add_group(members)
      integer, intent(in) :: members(:)
      integer :: k
      do k = 1, size(members)
        call list%add(members(k))
      end do
      call starts%add(list%n + 1)
    end subroutine add_group

  end subroutine list_coupled_nodes


  !> Creates the slave nodes of contact and the state.
  subroutine prepare_state(system, model, has_trial_points, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    logical, intent(in), optional :: has_trial_points
    type(state_type), intent(out) :: state
    type(error_type), allocatable, intent(out) :: error
    type(slave_state_type), allocatable :: slaves(:)
    call create_contact(system%contact, model, slaves, error)
    if (allocated(error)) return
    call create_state(state, model%mesh, slaves, has_trial_points)
    call create_material_state(state, model)
  end subroutine prepare_state


  !> Begins a step: finds the unknowns that its supports restrain. Errors: constraints that contradict each other (EXIT_SETUP).
  subroutine begin_step(system, model, step, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state
    type(error_type), allocatable, intent(out) :: error
    logical, allocatable :: is_held(:, :)          ! (3, n_nodes)
    integer :: p
    system%u_start = state%old%u
    if (allocated(system%volume_share)) deallocate (system%volume_share)
    if (allocated(system%mass)) deallocate (system%mass)
    system%is_nlgeom = step%is_nlgeom
    system%is_constant = .not. step%is_nlgeom .and. has_linear_bulk(model) .and. .not. has_rate_forces(step)
    system%is_assembled = .false.
    system%is_matrix_free = is_matrix_free_step(step)
    system%skin%memory%is_abandoned = .false.
    if (allocated(step%is_inactive)) system%has_no_element = find_unconnected(model, step%is_inactive)
    system%controls = step%controls
    system%schur_interface%controls = step%controls%krylov
    system%reduced_system%controls = step%controls%linear_solver
    system%reduced_system%requested_solver = step%solver
    system%reduced_system%is_shift_allowed = .not. step%is_riks
    system%may_soften = has_damage(model)
    system%may_collapse = any(model%materials%n_history > 0) .and. (system%may_soften .or. .not. has_moving_supports(step))
    system%reduced_system%use = merge(USE_REPEATED, USE_ONCE, size(state%old%slaves) > 0 .or. &
      (system%is_constant .and. step%dt_initial < step%controls%krylov%max_reuse_increment * step%period))
    if (size(state%old%slaves) == 0 .and. .not. system%is_constant) system%reduced_system%use = USE_NEWTON
    call hold_all_midsides(system%contact%midsides)   ! which follow changes within the step
    call update_base_constraints(system, model, step, state%old, error)
    if (allocated(error)) return
    call prepare_matrix(system, model, error)
    if (allocated(error)) return
    call begin_contact_step(system%contact, model, step)
    allocate (is_held(3, model%mesh%n_nodes))
    call find_fixed_directions(model, step, system%base%owner, is_held)
    call set_free_directions(system%contact, model, state%old%slaves, system%base, is_held, error)
    if (allocated(error)) return
    do p = 1, size(system%contact%facets)
      call find_symmetry_planes(system%contact%facets(p), model, is_held)
      if (model%pairs(p)%is_mortar) call find_symmetry_planes(system%contact%mortar(p)%slave, model, is_held)
    end do
  end subroutine begin_step


  !> The pattern of K for a step: divided among the ranks where the iteration over them serves.
  subroutine prepare_matrix(system, model, error)
    type(equilibrium_type), intent(inout) :: system     !< with the base constraints and the solver of the step
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: coupled
    logical :: is_divided
    if (system%is_matrix_free) return
    is_divided = .false.
    associate (solver => system%reduced_system)
      if (system%is_dividable .and. system%base%n_free > 0 .and. .not. solver%is_iteration_abandoned) then
        is_divided = any(solver%requested_solver == [SOLVER_ITERATIVE, SOLVER_BDDC])
        if (solver%requested_solver == SOLVER_AUTO) is_divided = solver%is_divided .and. solver%cost%is_estimated   ! as before
        if (solver%requested_solver == SOLVER_AUTO .and. .not. is_divided .and. &
          system%base%n_free >= solver%controls%min_unknowns_estimated) then
          call couple_nodes(model%mesh, coupled)
          call choose_division(solver, system%base, coupled, is_divided, error)
          if (allocated(error)) return
        end if
      end if
      if (is_divided .neqv. solver%is_divided) call discard_analysis(solver)
      solver%is_divided = is_divided
      if (is_divided) solver%rank_of = system%assembly%rank_of
    end associate
    call ensure_matrix(system%assembly, model%mesh, is_divided)
  end subroutine prepare_matrix


  !> Gives each rank the pattern of the whole K from now on; K is to be assembled again.
  subroutine undivide_matrix(system, model)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    if (.not. system%assembly%is_divided) return
    call ensure_matrix(system%assembly, model%mesh, .false.)
    system%is_assembled = .false.
    system%reduced_system%is_divided = .false.
    call discard_analysis(system%reduced_system)
  end subroutine undivide_matrix


  !> Whether the stiffness of all elements is constant at small displacements.
  pure logical function has_linear_bulk(model)
    type(model_type), intent(in) :: model
    has_linear_bulk = all(model%materials%is_linear_isotropic) .and. .not. (allocated(model%mesh%spring) .or. &
      allocated(model%user_elements))
  end function has_linear_bulk


  !> Whether prescribed displacements change in a step.
  pure logical function has_moving_supports(step)
    type(step_type), intent(in) :: step
    has_moving_supports = any(.not. step%prescribed%is_held .and. (step%prescribed%is_velocity .or. step%prescribed%is_user .or. &
      step%prescribed%is_from_current .or. abs(step%prescribed%end - step%prescribed%start) > 0.0_DP .or. &
      (step%prescribed%amplitude > 0 .and. abs(step%prescribed%end) > 0.0_DP)))
  end function has_moving_supports


  !> Whether the bulk depends on the length of the increment.
  pure logical function has_rate_forces(step)
    type(step_type), intent(in) :: step
    has_rate_forces = is_damped(step) .or. step%is_dynamic
  end function has_rate_forces


  !> The unknowns without elements; those of a rotation node may be in a user element.
  pure function find_unconnected(model, is_absent) result(is_unconnected)
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_absent(:)            !< (n_elements) inactive
    logical :: is_unconnected(3 * model%mesh%n_nodes)
    integer :: i
    is_unconnected = find_unconnected_unknowns(model%mesh, is_absent)
    if (.not. allocated(model%user_elements)) return
    do i = 1, size(model%user_elements%elements)
      associate (element => model%user_elements%elements(i))
        if (.not. is_absent(element%element)) is_unconnected(user_unknowns(element)) = .false.
      end associate
    end do
  end function find_unconnected


  !> Whether a step needs no matrix.
  pure logical function is_matrix_free_step(step)
    type(step_type), intent(in) :: step
    is_matrix_free_step = step%solver == SOLVER_GRADIENTS .and. &
      any(step%controls%gradients%preconditioner == [PRECONDITIONER_NODAL, PRECONDITIONER_DIAGONAL])
  end function is_matrix_free_step


  !> Chooses the linear solver of a step of a large model, before the first evaluation.
  subroutine plan_solver(system, model, error)
    type(equilibrium_type), intent(inout) :: system     !< the step has begun
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    logical :: is_surely_factor
    if (system%reduced_system%requested_solver == SOLVER_GRADIENTS) return
    is_surely_factor = is_factor_small(system%controls%linear_solver, system%base%n_free, system%reduced_system%use == USE_REPEATED)
    if (is_surely_factor .and. system%reduced_system%requested_solver == SOLVER_AUTO) return
    call plan_reduced_solver(system%reduced_system, system%assembly%stiffness, system%base, model%mesh, error)
  end subroutine plan_solver


  !> Begins an increment: the trial state has the time of its end and the displacement of its start.
  subroutine begin_increment(system, model, step, is_step_start, state)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(inout) :: state
    integer :: outcome                             ! a conflict is found again by the next constraints
    logical :: is_changed
    system%is_first_direction = .true.
    system%reduced_system%is_reusable = .false.    ! a resumed job has no factor
    call set_temperatures(model, step, state)
    call update_user_fields(model, state)
    call set_damping_factor(step, is_step_start, state)
    call update_points(system%contact, model, state)
    if (.not. system%is_constant) system%is_assembled = .false.
    call initialize_contact(system%contact, model, step%is_nlgeom, is_step_start, system%u_start, state%new)
    call begin_midsides(system%contact%midsides, state%new%slaves, is_changed)
    if (is_changed .and. allocated(system%base%owner)) call renew_base_constraints(system, model, step, state, outcome)
    call update_bulk_validity(system, model, step, is_step_start, state)
  end subroutine begin_increment


  !> The base constraints for the remaining prescribed displacements at the time of `fields`.
  subroutine update_base_constraints(system, model, step, fields, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    type(error_type), allocatable, intent(out) :: error
    call build_base_constraints(system%base, model, step, fields, system%u_start, system%contact%midsides%held, &
      system%has_no_element, &
      system%mpc_violation, error)
  end subroutine update_base_constraints


  !> The same for constraints that depend on the motion: rows that contradict each other give OUTCOME_CONSTRAINTS.
  subroutine prescribe_here(system, model, step, fields, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    integer, intent(out) :: outcome                !< OUTCOME_OK or OUTCOME_CONSTRAINTS
    type(error_type), allocatable :: error
    call update_base_constraints(system, model, step, fields, error)
    outcome = merge(OUTCOME_CONSTRAINTS, OUTCOME_OK, allocated(error))
    call move_alloc(error, system%conflict)
  end subroutine prescribe_here


  !> At a converged iterate: lets the mid-side nodes beside closed corners follow them, and no others. If these are other ones than
  !! before, the iterate is evaluated again and is no equilibrium.
  subroutine update_midside_constraints(system, model, step, state, is_changed, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    logical, intent(out) :: is_changed
    integer, intent(out) :: outcome                !< OUTCOME_...
    outcome = OUTCOME_OK
    call update_midsides(system%contact%midsides, state%new%slaves, is_changed)
    if (.not. is_changed) return
    call renew_base_constraints(system, model, step, state, outcome)
    if (outcome == OUTCOME_OK) call evaluate_equilibrium(system, model, step, state, outcome, is_frozen=.false.)
  end subroutine update_midside_constraints


  !> The base constraints after a change of their rows within a step, and what depends on these rows.
  subroutine renew_base_constraints(system, model, step, state, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state
    integer, intent(out) :: outcome                !< OUTCOME_OK or OUTCOME_CONSTRAINTS
    type(error_type), allocatable :: error
    call prescribe_here(system, model, step, state%new, outcome)
    if (outcome == OUTCOME_OK .and. system%contact%shared_slaves%has_reaction_chains) then
      call build_condensation_matrix(system%base, system%contact%force_condensation, error)
      if (allocated(error)) outcome = OUTCOME_CONSTRAINTS
      if (allocated(error)) call move_alloc(error, system%conflict)
    end if
    system%reduced_system%is_reusable = .false.
    system%schur_interface%is_analysed = .false.
    call discard_bulk_factor(system)
    if (allocated(system%is_interface_unknown)) system%is_interface_unknown = system%is_interface_unknown .or. &
      interface_unknowns(system, model, state%new, .not. step%is_nlgeom)
  end subroutine renew_base_constraints


  !> Imbalance, contact and residual at state%new%u: forces only.
  subroutine evaluate_equilibrium(system, model, step, state, outcome, is_frozen)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome                !< OUTCOME_...
    logical, intent(in) :: is_frozen               !< all contact statuses are frozen
    integer :: failed
    call system%clock%read(PHASE_OTHER)
    call assemble_internal_forces(system, model, step, state, failed)
    outcome = merge(OUTCOME_OK, OUTCOME_ELEMENT, failed == 0)
    system%failed_element = failed
    if (failed /= 0) return
    call assemble_external_loads(system%assembly, model, step, state%new, step%is_nlgeom, .false.)
    if (is_damped(step) .and. .not. allocated(system%volume_share)) then
      call share_points(system%assembly, model%mesh, state%new)
      call find_nodal_volumes(model%mesh, absent_elements(model, state%new%step), state%new, system%volume_share)
    end if
    call set_first_factor(model, step, state)
    if (state%new%damping(DAMPING_NOW) > 0.0_DP) call add_damping_force(system%volume_share, state)
    if (step%is_dynamic) call add_inertia_force(system%assembly, model, system%mass, state)
    if (step%is_nlgeom .and. n_nonlinear_mpcs(model) > 0) call prescribe_here(system, model, step, state%new, outcome)
    if (outcome /= OUTCOME_OK) return
    call condense_forces(system%base, state%new%applied_force - state%new%internal_force, system%imbalance)
    call system%clock%read(PHASE_ASSEMBLY)
    call forget_origins(system%contact, state%old%slaves, state%new%slaves)
    if (system%proximal_shift > 0.0_DP) call renew_searches(system%contact, model%mesh%coordinates + state%new%u)   ! masters move
    call evaluate_contact(system%contact, model, state%old, system%imbalance, is_frozen, state%new, .false.)
    call compute_norms(system, state%new%applied_force, state%new)
    system%force_rounding = ROUNDING_FACTOR * contact_force_rounding(system%contact%laws, system%contact%local_equilibrium, &
      state%new%slaves, model%mesh%coordinates)
    call system%clock%read(PHASE_CONTACT)
    if (.not. system%merit <= huge(1.0_DP)) outcome = OUTCOME_NOT_FINITE
  end subroutine evaluate_equilibrium


  !> Internal forces of the elements, those of user elements included.
  subroutine assemble_internal_forces(system, model, step, state, failed)
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: failed                 !< 0, or the first element that is inverted or not finite
    call assemble_forces(system%assembly, model, step%is_nlgeom, state, failed)
    if (failed == 0 .and. allocated(model%user_elements)) call add_user_forces(model, step, state, failed)
  end subroutine assemble_internal_forces


  !> Stress, strain, energy and volume at the points of a converged state, if its trial fields have none: the forces are evaluated
  !! once more.
  subroutine evaluate_points(system, model, step, state, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome                !< OUTCOME_OK or OUTCOME_ELEMENT
    outcome = OUTCOME_OK
    if (state%has_trial_points) return
    call system%clock%read(PHASE_OTHER)
    call take_points(state)
    call assemble_internal_forces(system, model, step, state, system%failed_element)
    if (system%failed_element /= 0) outcome = OUTCOME_ELEMENT
    call system%clock%read(PHASE_ASSEMBLY)
  end subroutine evaluate_points


  !> A node that was open at the start of the increment and is open now, or outside the range of its compliant law, has no origin of
  !! its slip. The first linearised evaluation that closes it sets one, and the corrections of the direction keep it.
  pure subroutine forget_origins(contact, old, new)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: old(:)   !< committed
    type(slave_state_type), intent(inout) :: new(:)   !< trial
    logical :: is_out
    integer :: s
    do s = 1, size(new)
      is_out = new(s)%status == STATUS_OPEN
      if (.not. is_out) is_out = is_compliant(contact%laws(new(s)%pair)) .and. .not. new(s)%is_in_law_range
      if (old(s)%status == STATUS_OPEN .and. is_out) new(s)%origin_facet = 0
    end do
  end subroutine forget_origins


  !> Residual, reaction forces, and the norms of the convergence criteria.
  subroutine compute_norms(system, applied_force, fields)
    type(equilibrium_type), intent(inout) :: system
    real(DP), intent(in) :: applied_force(:, :)    !< (3, n_nodes) applied force of the fields, or a fraction of it [force]
    type(fields_type), intent(inout) :: fields
    real(DP) :: violation
    integer :: s
    fields%reaction_force = fields%internal_force - applied_force - fields%contact_force
    call condense_forces(system%base, -fields%reaction_force, system%residual)
    system%residual_at_gap = system%residual
    if (any(is_compliant(system%contact%laws))) call condense_forces(system%base, &
      system%contact%law_linearization_force - fields%reaction_force, &
      system%residual_at_gap)
    call extract_support_reactions(system%base, fields%reaction_force)
    system%largest_residual = maxval(max_components(system, system%residual, -1))
    system%bulk_force = max(maxval(max_components(system, fields%internal_force, -1)), &
      maxval(max_components(system, applied_force, -1)))
    system%largest_force = max(system%bulk_force, maxval(max_components(system, fields%contact_force, -1)))
    violation = 0.0_DP
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        if (slave%status == STATUS_OPEN .or. is_compliant(system%contact%laws(slave%pair))) cycle
        violation = violation + (slave%stiffness * slave%gap)**2
        if (slave%status == STATUS_STICK) violation = violation + (slave%stiffness * norm2(slave%slip_increment))**2
      end associate
    end do
    if (size(system%rotation_length) > 0) then
      system%merit = sqrt(sum(nodal_norms(system, system%residual, -1)**2) + violation)
    else
      system%merit = sqrt(sum(system%residual**2) + violation)
    end if
  end subroutine compute_norms


  !> d'R(u): the product that the line search over all unknowns needs.
  pure real(DP) function directional_residual(system, direction) result(product)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: direction(:, :)        !< (3, n_nodes) [length]
    product = sum(direction * system%residual)
  end function directional_residual


  !> The largest component at each node of displacements (power 1) or forces (power -1); angles as lengths, moments as forces.
  pure function max_components(system, field, power) result(largest)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: field(:, :)            !< (3, n_nodes) [length] or [force]
    integer, intent(in) :: power
    real(DP) :: largest(size(field, 2))
    largest = maxval(abs(field), dim=1)
    if (size(system%rotation_length) > 0) largest = largest * system%rotation_length**power
  end function max_components


  !> The same of vectors.
  pure function nodal_norms(system, field, power) result(length)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: field(:, :)            !< (3, n_nodes) [length] or [force]
    integer, intent(in) :: power
    real(DP) :: length(size(field, 2))
    length = norm2(field, dim=1)
    if (size(system%rotation_length) > 0) length = length * system%rotation_length**power
  end function nodal_norms


  !> The largest component of the residual, and of the residual at the present gaps, above rounding level.
  pure function residual_sizes(system, u) result(largest)
    type(equilibrium_type), intent(in) :: system        !< K was assembled
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP) :: largest(2)                         !< [force]
    largest = [largest_above_rounding(system, system%residual, u), largest_above_rounding(system, system%residual_at_gap, u)]
  end function residual_sizes


  !> The largest component of a residual above its rounding level: the diagonal stiffness times the last digit of the largest
  !! displacement. A stress-free rigid motion gives a residual at this level.
  pure real(DP) function largest_above_rounding(system, field, u) result(largest)
    type(equilibrium_type), intent(in) :: system        !< K was assembled
    real(DP), intent(in) :: field(:, :)            !< (3, n_nodes) R or the residual at the present gaps [force]
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP) :: last_digit                         ! [length]
    real(DP) :: length                             ! of the unit of the node's unknowns: 1 but for rotations [-]
    integer :: i
    last_digit = ROUNDING_FACTOR * epsilon(1.0_DP) * maxval(max_components(system, u, 1))
    largest = 0
    length = 1
    do i = 1, size(u, 2)
      if (size(system%rotation_length) > 0) length = system%rotation_length(i)
      if (maxval(abs(field(:, i))) <= largest * length) cycle   ! K is looked up for few nodes
      largest = max(largest, maxval(abs(field(:, i)) - last_digit * abs(diagonal_stiffness(system, i))) / length)
    end do
  end function largest_above_rounding


  !> The diagonal entries of K of a node: of the matrix, or of its nodal blocks.
  pure function diagonal_stiffness(system, node) result(k)
    type(equilibrium_type), intent(in) :: system
    integer, intent(in) :: node
    real(DP) :: k(3)                               ! [force/length]
    integer :: i
    if (system%is_matrix_free) then
      k = [(system%nodal_stiffness(i, i, node), i=1, 3)]
    else
      k = node_diagonal(system%assembly, node)
    end if
  end function diagonal_stiffness


  !> Their mean.
  pure real(DP) function mean_diagonal_stiffness(system, node) result(k)
    type(equilibrium_type), intent(in) :: system
    integer, intent(in) :: node
    k = sum(diagonal_stiffness(system, node)) / 3.0_DP
  end function mean_diagonal_stiffness


  !> Saves the configuration of the last evaluation.
  pure type(configuration_type) function save_configuration(system, state) result(configuration)
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state          !< evaluated
    configuration = configuration_type(state%new%u, state%new%internal_force, state%new%applied_force, system%residual, &
      state%new%slaves, &
      system%contact%slip_data, system%merit, state%new%load_factor)
  end function save_configuration


  !> Imbalance, contact and residual at u + du with the element forces linearised at u.
  subroutine evaluate_linearized(system, model, start, du, state, d_load)
    type(equilibrium_type), intent(inout) :: system     !< linearised at u
    type(model_type), intent(in) :: model
    type(configuration_type), intent(in) :: start          !< u, with its internal force
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    type(state_type), intent(inout) :: state       !< in: slaves at u
    real(DP), intent(in), optional :: d_load       !< change of the load factor, 0 by default [-]
    real(DP), allocatable :: change(:), applied_force(:, :)
    call system%clock%read(PHASE_OTHER)
    allocate (change(size(du)))
    call multiply_stiffness(system%assembly, reshape(du, [size(du)]), change)
    system%linearized_rounding = ROUNDING_FACTOR * epsilon(1.0_DP) * norm2(stiffness_diagonal(system%assembly) * &
      reshape(du, [size(du)]))
    state%new%u = start%u + du
    state%new%internal_force = start%internal_force + reshape(change, shape(du))
    applied_force = start%applied_force
    if (present(d_load)) then
      state%new%load_factor = start%load_factor + d_load
      if (abs(d_load) > 0.0_DP) applied_force = applied_force + d_load * system%reference_force
    end if
    call condense_forces(system%base, applied_force - state%new%internal_force, system%imbalance)
    if (system%proximal_shift > 0.0_DP) call renew_searches(system%contact, model%mesh%coordinates + state%new%u)   ! masters move
    call evaluate_contact(system%contact, model, state%old, system%imbalance, .false., state%new, .true.)
    call compute_norms(system, applied_force, state%new)
    call system%clock%read(PHASE_CONTACT)
  end subroutine evaluate_linearized


  !> Restores the configuration after linearised evaluations. Forces and the rows of mortar pairs are not restored: the next
  !! evaluation computes them.
  subroutine restore_configuration(system, model, step, start, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(configuration_type), intent(in) :: start
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: error
    state%new%u = start%u
    state%new%load_factor = start%load_factor
    state%new%slaves = start%slaves
    system%residual = start%residual
    system%contact%slip_data = start%slip_data
    system%merit = start%merit
    ! a factor computed meanwhile is one of K at u
    if ((system%schur_interface%is_ready .or. system%skin%is_ready) .and. allocated(system%bulk_factor_u)) then
      if (system%n_factorisations > system%n_factorisations_before) system%bulk_factor_u = start%u
    end if
    call update_base_constraints(system, model, step, state%new, error)
  end subroutine restore_configuration


  !> Whether the next increment may use the factor of the bulk as a preconditioner. Condition: its matrix follows from the
  !! displacements alone, so that a resumed job continues with the same factor.
  subroutine update_bulk_validity(system, model, step, is_step_start, state)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(in) :: state          !< trial, at the start of the increment
    logical, allocatable :: is_contact(:)
    logical :: is_kept
    if (size(state%new%slaves) == 0) return
    if (system%n_indefinite > 0) system%is_schur_allowed = .true.   ! attempts are independent
    system%n_indefinite = 0
    if (may_keep_skin(system, model, step, is_step_start)) return
    is_kept = has_linear_bulk(model) .and. system%base%n_rows == 0 .and. (.not. step%is_nlgeom .or. size(step%distributed) == 0) &
      .and. .not. has_rate_forces(step)
    if (is_kept .and. is_step_start) is_kept = is_same_bulk(system) .and. .not. (allocated(step%is_inactive) .or. &
      allocated(step%material))
    is_contact = interface_unknowns(system, model, state%new, .not. step%is_nlgeom)
    if (is_kept .and. allocated(system%is_interface_unknown)) is_kept = .not. any(is_contact &
      .and. .not. system%is_interface_unknown)
    if (is_kept .and. allocated(system%is_interface_unknown)) return
    call discard_bulk_factor(system)
    if (allocated(system%base%owner)) system%is_held = system%base%owner /= 0   ! not allocated in the model check before the first
    ! step
    system%is_bulk_nlgeom = system%is_nlgeom
    if (allocated(system%is_interface_unknown)) then
      if (.not. is_step_start .and. all(is_contact .eqv. system%is_interface_unknown)) return   ! a new step may have other supports
    end if
    system%schur_interface%is_analysed = .false.
    system%is_schur_allowed = .true.
    call move_alloc(is_contact, system%is_interface_unknown)
  end subroutine update_bulk_validity


  !> Whether the bulk solver of the skin stays valid: the same unknowns are restrained. It is only a preconditioner, recomputed when
  !! it needs too many iterations, so that it need not match the present bulk. Condition: as for the factor of the bulk its
  !! stiffness follows from displacements alone.
  pure logical function may_keep_skin(system, model, step, is_step_start) result(is_kept)
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    is_kept = (system%skin%is_ready .or. allocated(system%skin%memory%is_near)) .and. is_same_bulk(system)
    if (is_kept) is_kept = has_linear_bulk(model) .and. n_nonlinear_mpcs(model) == 0 .and. .not. has_rate_forces(step)
    if (is_kept .and. is_step_start) is_kept = .not. (allocated(step%is_inactive) .or. allocated(step%material))
  end function may_keep_skin


  !> Whether the bulk of a new step is that of the last one: the same restrained unknowns and the same NLGEOM.
  pure logical function is_same_bulk(system) result(is_same)
    type(equilibrium_type), intent(in) :: system
    is_same = allocated(system%is_held) .and. (system%is_bulk_nlgeom .eqv. system%is_nlgeom)
    if (is_same) is_same = all(system%is_held .eqv. system%base%owner /= 0)
  end function is_same_bulk


  !> Discards the factor of the bulk.
  subroutine discard_bulk_factor(system)
    type(equilibrium_type), intent(inout) :: system
    system%schur_interface%is_ready = .false.
    system%skin%is_ready = .false.
    if (allocated(system%skin%memory%is_near)) deallocate (system%skin%memory%is_near)
    if (allocated(system%bulk_factor_u)) deallocate (system%bulk_factor_u)
  end subroutine discard_bulk_factor


  !> Frees K, A and the preconditioner: no direction will follow, and the last output needs memory.
  subroutine discard_matrices(system)
    type(equilibrium_type), intent(inout) :: system
    system%assembly%stiffness = sparse_type()
    call discard_iteration(system%reduced_system)
  end subroutine discard_matrices


  !> Free unknowns of the contact interface, those of the dense interface.
  pure integer function n_interface_unknowns(system) result(n)
    type(equilibrium_type), intent(in) :: system   !< with its interface and base constraints
    n = count(system%is_interface_unknown .and. system%base%free_of > 0)
  end function n_interface_unknowns


  !> The unknowns of the contact interface: slave nodes near their master, the nodes of their facets and of adjacent facets.
  pure function interface_unknowns(system, model, fields, includes_far_nodes) result(is_contact)
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: includes_far_nodes              !< include nodes far from their master
    logical :: is_contact(3 * model%mesh%n_nodes)
    logical :: is_near(model%mesh%n_nodes)
    type(contact_row_type) :: row
    integer :: s, k, i, j
    is_near = .false.
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        if (slave%facet == 0) cycle
        if (slave%gap > system%controls%contact_interface%max_gap * system%contact%edge(slave%pair) .and. &
          .not. includes_far_nodes) cycle
        call current_row(system%contact, slave, row)
        is_near(row%nodes) = .true.
        is_near(row%imbalance_nodes) = .true.
        associate (facets => system%contact%facets(slave%pair))
          is_near(facets%nodes(facets%first(slave%facet):facets%first(slave%facet + 1) - 1)) = .true.
          do k = 1, 4
            j = facets%neighbour(k, slave%facet)
            if (j > 0 .and. .not. system%contact%has_fixed_geometry(slave%pair)) &
              is_near(facets%nodes(facets%first(j):facets%first(j + 1) - 1)) = .true.
          end do
        end associate
      end associate
    end do
    is_contact = [(is_near((i + 2) / 3), i=1, size(is_contact))]
    do k = 1, system%base%n_rows                   ! a dependent unknown adds those on which it depends
      if (is_contact(system%base%rows(k)%pivot)) is_contact(system%base%rows(k)%unknown) = .true.
    end do
  end function interface_unknowns

end module amontons_equilibrium
