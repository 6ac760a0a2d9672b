!> System: the equations at one configuration: imbalance, contact and residual, and what is kept from one to the next.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `evaluate` asks the elements and contact; `foresee` asks contact alone, with the elements as their tangent foretells them.
!! Both give forces only. The matrix, and the direction that it leads to, are in the room `direction`.
module amontons_equilibrium
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type
  use amontons_posix, only: peak_megabytes
  use amontons_model, only: model_type, n_nonlinear_mpcs, absent_elements
  use amontons_surfaces, only: is_compliant
  use amontons_steps, only: step_type, SOLVER_AUTO
  use amontons_iteration_records, only: N_PHASES, PHASE_ASSEMBLY, PHASE_CONTACT
  use amontons_state, only: state_type, fields_type, slave_state_type, create_state, create_material_state, set_temperatures, &
    DAMPING_NOW, STATUS_OPEN, STATUS_STICK
  use amontons_model_change, only: find_unconnected_unknowns
  use amontons_sparse, only: multiply_symmetric
  use amontons_reduced_system, only: reduced_system_type, plan_reduced_solver, is_factor_small
  use amontons_schur_interface, only: schur_interface_type
  use amontons_contact_skin, only: skin_type
  use amontons_free_rigid_motions, only: free_motions_type
  use amontons_constraints, only: constraints_type, condense_forces
  use amontons_nonlinear_mpc, only: extract_support_reactions, list_hessian_nodes, find_rotation_lengths
  use amontons_boundary_conditions, only: build_base_constraints
  use amontons_stabilization, only: is_damped, set_damping_factor, find_nodal_volumes, add_damping_force
  use amontons_assembly, only: assembly_type, create_assembly, assemble_forces
  use amontons_external_loads, only: assemble_external_loads
  use amontons_master_symmetry_planes, only: find_symmetry_planes, find_fixed_directions
  use amontons_contact_pairs, only: contact_type, create_contact, begin_contact_step, set_free_directions, current_row
  use amontons_contact_evaluation, only: evaluate_contact
  use amontons_slave_nodes, only: rounding_force
  use amontons_slip_scenarios, only: slip_state_type
  use amontons_contact_initialization, only: initialize_contact
  use amontons_contact_integration_points, only: update_points
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_linearization, only: contact_tangent_type
  implicit none
  private
  public :: equilibrium_type, create_equilibrium, begin_step, plan_solver, begin_increment, evaluate_equilibrium, &
    directional_residual, residuals_above_rounding
  public :: max_components, nodal_norms
  public :: configuration_type, save_configuration, evaluate_linearized, restore_configuration
  public :: update_base_constraints, discard_bulk_factor, interface_unknowns, start_clock, stop_clock
  public :: OUTCOME_OK, OUTCOME_ELEMENT, OUTCOME_LINEAR_SOLVER, OUTCOME_NOT_FINITE, OUTCOME_UNSUPPORTED, OUTCOME_TUNNELLING, &
    OUTCOME_CONSTRAINTS

  integer, parameter :: OUTCOME_OK = 0
  integer, parameter :: OUTCOME_ELEMENT = 1        !< an element is inverted: system%failed_element is its index
  integer, parameter :: OUTCOME_LINEAR_SOLVER = 2         !< the tangent is singular and no direction was found
  integer, parameter :: OUTCOME_NOT_FINITE = 3     !< a number is not finite
  integer, parameter :: OUTCOME_UNSUPPORTED = 4           !< a body flies off
  integer, parameter :: OUTCOME_TUNNELLING = 5        !< a slave node passed through its master
  integer, parameter :: OUTCOME_CONSTRAINTS = 6    !< constraints contradict each other: system%conflict says which

  real(DP), parameter :: MAX_FIRST_INCREMENT_RATIO = 0.3_DP         !< first increment over the step: a factor serves fewer than
                                                                    !! that [-]
  real(DP), parameter :: ROUNDING_FACTOR = 10.0_DP             !< so many times a gap is rounded on its way to a force, at most [-]
  real(DP), parameter :: MAX_INTERFACE_GAP = 0.5_DP                   !< an open node nearer than this times the edge is on the
                                                                      !! interface [-]

  !> The system, with everything that is kept between configurations.
  type :: equilibrium_type
    type(assembly_type) :: assembly
    type(contact_type) :: contact
    type(constraints_type) :: base                 !< boundary conditions, equations, followers
    type(constraints_type) :: constraints                !< those and the rows of the closed nodes
    type(contact_tangent_type), allocatable :: contact_tangents(:)       !< linearised contact forces
    type(reduced_system_type) :: reduced_system                  !< A and its factor
    type(schur_interface_type) :: schur_interface              !< the bulk with its interface, where that is cheaper
    type(skin_type) :: skin                        !< the preconditioner of contact on wide interfaces
    type(free_motions_type) :: motions             !< of bodies that supports alone do not hold
    logical, allocatable :: is_near(:)             !< (n_slaves) they have a spring in it
    real(DP) :: skin_tolerance = 1.0e-6_DP         !< of a direction by it: residual over right-hand side [-]
    logical :: is_skin = .false.                   !< the present direction goes by it
    logical :: is_schur_active = .false.              !< the present direction goes by the condensed interface, or by the skin
    logical :: is_subproblem_solved = .false.                !< contact has settled ahead along the present direction
    logical :: is_schur_allowed = .true.            !< the interface has not been found too large yet
    real(DP), allocatable :: bulk_factor_u(:, :)          !< (3, n_nodes) where the bulk's factor was made [length]; not there: no
                                                          !! factor
    logical :: is_bulk_factor_current = .false.               !< that factor is one of K as it is
    logical :: is_interface_singular = .false.                 !< along the present direction nothing holds a body: the interface
                                                               !! is singular
    logical, allocatable :: is_interface_unknown(:)          !< (n_unknowns) on the interface
    logical, allocatable :: is_held(:)             !< (n_unknowns) by the base constraints, where the bulk was analysed
    real(DP) :: proximal_shift = 0                          !< part of its own diagonal that K has more, for bodies that nothing
                                                            !! holds [-]
    logical :: is_bulk_nlgeom = .false.            !< the factor of the bulk is one of a step with NLGEOM
    logical, allocatable :: has_no_element(:)             !< (3 n_nodes) of a node without elements
    real(DP), allocatable :: volume_share(:)              !< (n_nodes) of volume, for damping; not there: no step has had any
                                                          !! [length^3]
    real(DP) :: mpc_violation = 0                      !< largest of the bonds at the last evaluation, over their size [-]
    real(DP), allocatable :: rotation_length(:)              !< (n_nodes) what makes a length of an angle; empty: there are no
                                                             !! angles [length]
    real(DP), allocatable :: u_start(:, :)         !< (3, n_nodes) displacement at the start of the step [length]
    real(DP), allocatable :: imbalance(:, :)       !< (3, n_nodes) Rhat = F_ext - F_int, condensed on the free unknowns [force]
    real(DP), allocatable :: residual(:, :)        !< (3, n_nodes) R = Rhat + F_c, condensed [force]
    real(DP), allocatable :: residual_at_gap(:, :)          !< (3, n_nodes) R with what compliant laws give where their nodes are
                                                            !! [force]
    real(DP) :: largest_residual = 0               !< [force]
    real(DP) :: largest_force = 0                  !< largest internal, applied or contact force on a node [force]
    real(DP) :: bulk_force = 0                     !< largest internal or applied force on a node [force]
    real(DP) :: force_rounding = 0                       !< what rounding makes of gaps: no residual [force]
    real(DP) :: merit = 0                          !< norm of residual, gaps and stick violations scaled to forces [force]
    logical :: is_nlgeom = .false.
    logical :: is_constant = .false.               !< the stiffness of this step depends on nothing
    logical :: is_assembled = .false.              !< and is there already
    integer :: n_conflicts = 0                     !< contact rows dropped for stronger constraints
    integer :: failed_element = 0
    type(error_type), allocatable :: conflict      !< of constraints, at the last evaluation; not there: none
    integer :: n_factorisations = 0                !< since the last reset by the stepper
    integer :: n_factorisations_before = 0                        !< the same when the direction was wanted
    integer :: n_krylov = 0
    integer :: n_subproblem_iterations = 0                        !< corrections of directions while contact settled
    integer :: n_halved = 0                        !< corrections that were halved while contact settled along a direction
    integer :: n_indefinite = 0                      !< factorisations of the bulk in this attempt that found it not stable
    integer :: n_shifted = 0                       !< factorisations that needed a shift
    integer :: n_umfpack = 0                         !< directions that needed UMFPACK
    real(DP) :: seconds(N_PHASES) = 0              !< [s]
    real(DP) :: megabytes(N_PHASES) = 0            !< by which the peak of memory grew
    real(DP) :: peak = 0                           !< of memory, when the clock was read last [megabytes]
  end type equilibrium_type

  !> A configuration as it was evaluated, to start from and to come back to.
  type :: configuration_type
    real(DP), allocatable :: u(:, :)               !< (3, n_nodes) [length]
    real(DP), allocatable :: internal_force(:, :)  !< (3, n_nodes) [force]
    real(DP), allocatable :: applied_force(:, :)   !< (3, n_nodes) with which it is balanced, here and where it leads [force]
    real(DP), allocatable :: residual(:, :)        !< (3, n_nodes) R [force]
    type(slave_state_type), allocatable :: slaves(:)
    type(slip_state_type), allocatable :: slip_data(:)  !< (n_slaves)
    real(DP) :: merit = 0                          !< [force]
  end type configuration_type

contains

  !> Assembly and contact are made ready, the state is laid out.
  subroutine create_equilibrium(system, model, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(out) :: state
    type(error_type), allocatable, intent(out) :: error
    call prepare_state(system, model, state, error)
    if (allocated(error)) return
    call prepare_nonlinear_mpcs(system, model, error)
    if (allocated(error)) return
    allocate (system%u_start(3, model%mesh%n_nodes), system%imbalance(3, model%mesh%n_nodes), &
      system%residual(3, model%mesh%n_nodes), system%residual_at_gap(3, model%mesh%n_nodes), source=0.0_DP)
  end subroutine create_equilibrium


  !> The pattern of the stiffness, with what bonds couple, and the unknowns that no element knows.
  subroutine prepare_nonlinear_mpcs(system, model, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: first(:), nodes(:)
    integer :: i
    allocate (first(n_nonlinear_mpcs(model) + 1), nodes(0))
    first(1) = 1
    do i = 1, n_nonlinear_mpcs(model)
      nodes = [nodes, list_hessian_nodes(model%nonlinear_mpcs(i))]
      first(i + 1) = size(nodes) + 1
    end do
    call create_assembly(system%assembly, model%mesh, error, first, nodes)
    if (allocated(error)) return
    system%has_no_element = find_unconnected_unknowns(model%mesh, absent_elements(model, 1))
    system%rotation_length = find_rotation_lengths(model)
  end subroutine prepare_nonlinear_mpcs


  !> Contact finds its slave nodes; the state is laid out with them.
  subroutine prepare_state(system, model, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(out) :: state
    type(error_type), allocatable, intent(out) :: error
    type(slave_state_type), allocatable :: slaves(:)
    call create_contact(system%contact, model, slaves, error)
    if (allocated(error)) return
    call create_state(state, model%mesh, slaves)
    call create_material_state(state, model)
  end subroutine prepare_state


  !> A step begins: which unknowns its supports hold. Errors: constraints that contradict each other (EXIT_SETUP).
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
    system%is_nlgeom = step%is_nlgeom
    system%is_constant = .not. step%is_nlgeom .and. all(model%materials%is_linear_isotropic) &
      .and. .not. allocated(model%mesh%spring) &
      .and. .not. is_damped(step)
    system%is_assembled = .false.
    if (allocated(step%is_inactive)) system%has_no_element = find_unconnected_unknowns(model%mesh, step%is_inactive)
    system%reduced_system%requested_solver = step%solver
    system%reduced_system%is_factor_reused = size(state%old%slaves) > 0 .or. &
      (system%is_constant .and. step%dt_initial < MAX_FIRST_INCREMENT_RATIO * step%period)
    call update_base_constraints(system, model, step, state%old, error)
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


  !> Chooses the solver of a step before anything is computed, where the model is so large that it matters.
  subroutine plan_solver(system, model, error)
    type(equilibrium_type), intent(inout) :: system     !< the step has begun
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    logical :: is_surely_factor
    is_surely_factor = is_factor_small(system%base%n_free, system%reduced_system%is_factor_reused)
    if (is_surely_factor .and. system%reduced_system%requested_solver == SOLVER_AUTO) return
    call plan_reduced_solver(system%reduced_system, system%assembly%stiffness, system%base, model%mesh, error)
  end subroutine plan_solver


  !> An increment begins: the trial state stands at its end in time and at its start in displacement.
  subroutine begin_increment(system, model, step, is_step_start, state)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(inout) :: state
    call set_temperatures(model, step, state)
    call set_damping_factor(step, is_step_start, state)
    call update_points(system%contact, model, state)
    if (.not. system%is_constant) system%is_assembled = .false.
    call initialize_contact(system%contact, model, step%is_nlgeom, is_step_start, system%u_start, state%new)
    call update_bulk_validity(system, model, step, is_step_start, state)
  end subroutine begin_increment


  !> The base constraints for what is still missing to the prescribed displacements at the time of `fields`.
  subroutine update_base_constraints(system, model, step, fields, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    type(error_type), allocatable, intent(out) :: error
    call build_base_constraints(system%base, model, step, fields, system%u_start, system%contact%midside_followers, &
      system%has_no_element, &
      system%mpc_violation, error)
  end subroutine update_base_constraints


  !> The same where constraints follow the motion: rows that contradict each other there are a trouble of this configuration.
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


  !> Imbalance, contact and residual at state%new%u: forces only.
  subroutine evaluate_equilibrium(system, model, step, state, outcome, is_frozen)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: outcome                !< TROUBLE_...
    logical, intent(in) :: is_frozen               !< every slave node keeps its status
    integer :: failed
    integer(I64) :: clock
    call start_clock(system, clock)
    call assemble_forces(system%assembly, model, step%is_nlgeom, state, failed)
    outcome = merge(OUTCOME_OK, OUTCOME_ELEMENT, failed == 0)
    system%failed_element = failed
    if (failed /= 0) return
    call assemble_external_loads(system%assembly, model, step, state%new, step%is_nlgeom, .false.)
    if (is_damped(step) .and. .not. allocated(system%volume_share)) &
      call find_nodal_volumes(model%mesh, absent_elements(model, state%new%step), state%new, system%volume_share)
    if (state%new%damping(DAMPING_NOW) > 0.0_DP) call add_damping_force(system%volume_share, state)
    if (step%is_nlgeom .and. n_nonlinear_mpcs(model) > 0) call prescribe_here(system, model, step, state%new, outcome)
    if (outcome /= OUTCOME_OK) return
    call condense_forces(system%base, state%new%applied_force - state%new%internal_force, system%imbalance)
    call stop_clock(system, clock, PHASE_ASSEMBLY)
    call evaluate_contact(system%contact, model, state%old, system%imbalance, is_frozen, state%new)
    call compute_norms(system, state%new%applied_force, state%new)
    system%force_rounding = ROUNDING_FACTOR * rounding_force(system%contact%laws, system%contact%local_equilibrium, &
      state%new%slaves, model%mesh%coordinates)
    call stop_clock(system, clock, PHASE_CONTACT)
    if (.not. system%merit <= huge(1.0_DP)) outcome = OUTCOME_NOT_FINITE
  end subroutine evaluate_equilibrium


  !> Residual, reaction, and the norms by which an iterate is judged.
  subroutine compute_norms(system, applied_force, fields)
    type(equilibrium_type), intent(inout) :: system
    real(DP), intent(in) :: applied_force(:, :)    !< (3, n_nodes) those of the fields, or a part of them [force]
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


  !> The largest residual, and that with laws where their nodes are, beyond what rounding makes of them.
  pure function residuals_above_rounding(system, u) result(largest)
    type(equilibrium_type), intent(in) :: system        !< K was assembled
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP) :: largest(2)                         !< [force]
    largest = [residual_above_rounding(system, system%residual, u), residual_above_rounding(system, system%residual_at_gap, u)]
  end function residuals_above_rounding


  !> The largest of a residual beyond what rounding of the displacements makes of it: of what the stiffness of an unknown makes of
  !! the largest displacement, the last digit. A body that moves without any force has nothing but that.
  pure real(DP) function residual_above_rounding(system, field, u) result(largest)
    type(equilibrium_type), intent(in) :: system        !< K was assembled
    real(DP), intent(in) :: field(:, :)            !< (3, n_nodes) R or that of the laws where their nodes are [force]
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP) :: last_digit                         ! [length]
    real(DP), allocatable :: of_node(:)            ! (n_nodes) [force]
    integer :: i
    last_digit = ROUNDING_FACTOR * epsilon(1.0_DP) * maxval(max_components(system, u, 1))
    associate (K => system%assembly%stiffness, residual => abs(field))
      allocate (of_node(size(u, 2)))
      do i = 1, size(u, 2)
        of_node(i) = maxval(residual(:, i) - last_digit * abs(K%value(K%first(3 * i - 2:3 * i))))
      end do
    end associate
    if (size(system%rotation_length) > 0) of_node = of_node / system%rotation_length
    largest = max(0.0_DP, maxval(of_node))
  end function residual_above_rounding


  !> Where the last evaluation was.
  pure type(configuration_type) function save_configuration(system, state) result(configuration)
    type(equilibrium_type), intent(in) :: system
    type(state_type), intent(in) :: state          !< evaluated
    configuration = configuration_type(state%new%u, state%new%internal_force, state%new%applied_force, system%residual, &
      state%new%slaves, &
      system%contact%slip_data, system%merit)
  end function save_configuration


  !> Imbalance, contact and residual at u + du as the tangent at u foretells them: without the elements.
  subroutine evaluate_linearized(system, model, start, du, state)
    type(equilibrium_type), intent(inout) :: system     !< linearised at u
    type(model_type), intent(in) :: model
    type(configuration_type), intent(in) :: start          !< u, with its internal force
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    type(state_type), intent(inout) :: state       !< its slaves are where they start from
    real(DP), allocatable :: change(:)
    integer(I64) :: clock
    call start_clock(system, clock)
    allocate (change(size(du)))
    call multiply_symmetric(system%assembly%stiffness, reshape(du, [size(du)]), change)
    state%new%u = start%u + du
    state%new%internal_force = start%internal_force + reshape(change, shape(du))
    call condense_forces(system%base, start%applied_force - state%new%internal_force, system%imbalance)
    call evaluate_contact(system%contact, model, state%old, system%imbalance, .false., state%new)
    call compute_norms(system, start%applied_force, state%new)
    call stop_clock(system, clock, PHASE_CONTACT)
  end subroutine evaluate_linearized


  !> Back from where was foreseen to where that started. What the next evaluation makes anew is left as it was foreseen: forces, and
  !! the rows of mortar pairs.
  subroutine restore_configuration(system, model, step, start, state, error)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(configuration_type), intent(in) :: start
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: error
    state%new%u = start%u
    state%new%slaves = start%slaves
    system%residual = start%residual
    system%contact%slip_data = start%slip_data
    system%merit = start%merit
    if ((system%schur_interface%is_ready .or. system%skin%is_ready) .and. allocated(system%bulk_factor_u)) then   ! a factor made
                                                                                                                  ! meanwhile has
                                                                                                     ! the stiffness of u
      if (system%n_factorisations > system%n_factorisations_before) system%bulk_factor_u = start%u
    end if
    call update_base_constraints(system, model, step, state%new, error)
  end subroutine restore_configuration


  !> Whether the bulk's factor may serve the next increment too, as a preconditioner. It may where its matrix can be made again
  !! from the displacements alone, so that a job that is resumed goes on with the same factor.
  subroutine update_bulk_validity(system, model, step, is_step_start, state)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(in) :: state          !< trial, at the start of the increment
    logical, allocatable :: is_contact(:)
    logical :: is_kept
    if (size(state%new%slaves) == 0) return
    if (system%n_indefinite > 0) system%is_schur_allowed = .true.   ! an attempt knows nothing of those before it
    system%n_indefinite = 0
    if (may_keep_skin(system, step, is_step_start)) return
    is_kept = all(model%materials%is_linear_isotropic) .and. .not. allocated(model%mesh%spring) .and. system%base%n_rows == 0 &
      .and. &
      (.not. step%is_nlgeom .or. size(step%distributed) == 0) .and. .not. is_damped(step)
    if (is_kept .and. is_step_start) is_kept = is_same_bulk(system) .and. .not. (allocated(step%is_inactive) .or. &
      allocated(step%material))
    is_contact = interface_unknowns(system, model, state%new, .not. step%is_nlgeom)
    if (is_kept .and. allocated(system%is_interface_unknown)) is_kept = .not. any(is_contact &
      .and. .not. system%is_interface_unknown)
    if (is_kept .and. allocated(system%is_interface_unknown)) return
    call discard_bulk_factor(system)
    if (allocated(system%base%owner)) system%is_held = system%base%owner /= 0   ! not there in the audit before the first step
    system%is_bulk_nlgeom = system%is_nlgeom
    if (allocated(system%is_interface_unknown)) then
      if (.not. is_step_start .and. all(is_contact .eqv. system%is_interface_unknown)) return   ! a step may have other supports
    end if
    system%schur_interface%is_analysed = .false.
    system%is_schur_allowed = .true.
    call move_alloc(is_contact, system%is_interface_unknown)
  end subroutine update_bulk_validity


  !> Whether the bulk solver of the skin goes on serving: the same unknowns are held. It is a preconditioner, and given up where it
  !! takes too many iterations, so that it need not be that of the present bulk.
  pure logical function may_keep_skin(system, step, is_step_start) result(is_kept)
    type(equilibrium_type), intent(in) :: system
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    is_kept = system%skin%is_ready .and. is_same_bulk(system)
    if (is_kept .and. is_step_start) is_kept = .not. (allocated(step%is_inactive) .or. allocated(step%material))
  end function may_keep_skin


  !> Whether the bulk of a new step is that of the last one: the same unknowns are held, and NLGEOM is as it was.
  pure logical function is_same_bulk(system) result(is_same)
    type(equilibrium_type), intent(in) :: system
    is_same = allocated(system%is_held) .and. (system%is_bulk_nlgeom .eqv. system%is_nlgeom)
    if (is_same) is_same = all(system%is_held .eqv. system%base%owner /= 0)
  end function is_same_bulk


  !> The factor of the bulk is not to be used any more.
  subroutine discard_bulk_factor(system)
    type(equilibrium_type), intent(inout) :: system
    system%schur_interface%is_ready = .false.
    system%skin%is_ready = .false.
    if (allocated(system%bulk_factor_u)) deallocate (system%bulk_factor_u)
  end subroutine discard_bulk_factor


  !> What contact can reach: slave nodes near their master, their facets and the facets beside these.
  pure function interface_unknowns(system, model, fields, includes_far_nodes) result(is_contact)
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: includes_far_nodes              !< nodes that are far from their master too
    logical :: is_contact(3 * model%mesh%n_nodes)
    logical :: is_near(model%mesh%n_nodes)
    type(contact_row_type) :: row
    integer :: s, k, i, j
    is_near = .false.
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        if (slave%facet == 0) cycle
        if (slave%gap > MAX_INTERFACE_GAP * system%contact%edge(slave%pair) .and. .not. includes_far_nodes) cycle
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
    do k = 1, system%base%n_rows                   ! a dependent unknown brings those on which it depends
      if (is_contact(system%base%rows(k)%pivot)) is_contact(system%base%rows(k)%unknown) = .true.
    end do
  end function interface_unknowns


  !> Starts a clock.
  subroutine start_clock(system, clock)
    type(equilibrium_type), intent(inout) :: system
    integer(I64), intent(out) :: clock
    call system_clock(clock)
    system%peak = peak_megabytes()
  end subroutine start_clock


  !> Adds the time since the clock was started or last read, and what the peak of memory grew, and starts it again.
  subroutine stop_clock(system, clock, phase)
    type(equilibrium_type), intent(inout) :: system
    integer(I64), intent(inout) :: clock
    integer, intent(in) :: phase                   !< PHASE_...
    integer(I64) :: now, rate
    real(DP) :: peak
    call system_clock(now, rate)
    peak = peak_megabytes()
    system%seconds(phase) = system%seconds(phase) + real(now - clock, DP) / real(rate, DP)
    system%megabytes(phase) = system%megabytes(phase) + peak - system%peak
    clock = now
    system%peak = peak
  end subroutine stop_clock

end module amontons_equilibrium
