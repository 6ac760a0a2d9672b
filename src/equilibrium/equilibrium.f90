!> System: the equations at one configuration: imbalance, contact and residual, and what is kept from one to the next.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `evaluate` asks the elements and contact; `foresee` asks contact alone, with the elements as their tangent foretells them.
!! Both give forces only. The matrix, and the direction that it leads to, are in the room `direction`.
module amontons_equilibrium
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type
  use amontons_posix, only: peak_megabytes
  use amontons_model, only: model_type, n_bonds
  use amontons_surfaces, only: is_compliant
  use amontons_steps, only: step_type, SOLVER_AUTO
  use amontons_iteration_records, only: N_PHASES, PHASE_ASSEMBLY, PHASE_CONTACT
  use amontons_state, only: state_type, fields_type, slave_type, create_state, create_material_state, set_temperatures, &
    DAMPING_NOW, STATUS_OPEN, STATUS_STICK
  use amontons_model_change, only: lone_unknowns
  use amontons_sparse, only: multiply_symmetric
  use amontons_reduced_system, only: reduced_type, plan_reduced, is_small
  use amontons_schur_interface, only: condensed_type
  use amontons_constraints, only: constraints_type, condense_forces
  use amontons_nonlinear_mpc, only: keep_supports, curved_nodes, levers
  use amontons_boundary_conditions, only: support_model
  use amontons_stabilization, only: is_damped, begin_damping, share_volumes, brake
  use amontons_assembly, only: assembly_type, create_assembly, assemble_forces
  use amontons_external_loads, only: assemble_loads
  use amontons_master_symmetry_planes, only: find_symmetry, find_held
  use amontons_contact_pairs, only: contact_type, create_contact, begin_contact_step, set_supports, touching_row
  use amontons_contact_evaluation, only: evaluate_contact
  use amontons_slave_nodes, only: rounding_force
  use amontons_slip_scenarios, only: slip_point_type
  use amontons_contact_initialization, only: begin_contact_increment
  use amontons_contact_integration_points, only: renew_points
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_linearization, only: link_type
  implicit none
  private
  public :: system_type, create_system, begin_step, plan_solver, begin_increment, evaluate, residual_pair, residuals_beyond
  public :: components_of, sizes_of
  public :: place_type, place_of, foresee, return_to
  public :: prescribe, forget_bulk, interface_unknowns, start_clock, stop_clock
  public :: TROUBLE_NONE, TROUBLE_ELEMENT, TROUBLE_SOLVER, TROUBLE_NOT_FINITE, TROUBLE_FREE, TROUBLE_THROUGH

  integer, parameter :: TROUBLE_NONE = 0
  integer, parameter :: TROUBLE_ELEMENT = 1        !< an element is inverted: system%trouble_item is its index
  integer, parameter :: TROUBLE_SOLVER = 2         !< the tangent is singular and no direction was found
  integer, parameter :: TROUBLE_NOT_FINITE = 3     !< a number is not finite
  integer, parameter :: TROUBLE_FREE = 4           !< a body flies off
  integer, parameter :: TROUBLE_THROUGH = 5        !< a slave node passed through its master

  real(DP), parameter :: FEW_INCREMENTS = 0.3_DP         !< first increment over the step: a factor serves fewer than that [-]
  real(DP), parameter :: ROUNDINGS = 10.0_DP             !< so many times a gap is rounded on its way to a force, at most [-]
  real(DP), parameter :: NEAR = 0.5_DP                   !< an open node nearer than this times the edge is on the interface [-]

  !> The system, with everything that is kept between configurations.
  type :: system_type
    type(assembly_type) :: assembly
    type(contact_type) :: contact
    type(constraints_type) :: base                 !< boundary conditions, equations, followers
    type(constraints_type) :: whole                !< those and the rows of the closed nodes
    type(link_type), allocatable :: links(:)       !< linearised contact forces
    type(reduced_type) :: reduced                  !< A and its factor
    type(condensed_type) :: condensed              !< the bulk with its interface, where that is cheaper
    logical :: is_condensed = .false.              !< the present direction goes by the condensed interface
    logical :: is_settled = .false.                !< contact has settled ahead along the present direction
    logical :: is_dense_wanted = .true.            !< the interface has not been found too large yet
    real(DP), allocatable :: bulk_u(:, :)          !< (3, n_nodes) where the bulk's factor was made [length]; not there: no factor
    logical :: is_bulk_new = .false.               !< that factor is one of K as it is
    logical :: is_unheld = .false.                 !< along the present direction nothing holds a body: the interface is singular
    logical, allocatable :: is_contact(:)          !< (n_unknowns) on the interface
    logical, allocatable :: is_held(:)             !< (n_unknowns) by the base constraints, where the bulk was analysed
    real(DP) :: carry = 0                          !< part of its own diagonal that K has more, for bodies that nothing holds [-]
    logical :: is_bulk_nlgeom = .false.            !< the factor of the bulk is one of a step with NLGEOM
    logical, allocatable :: is_lone(:)             !< (3 n_nodes) of a node without elements
    real(DP), allocatable :: share(:)              !< (n_nodes) of volume, for damping; not there: no step has had any [length^3]
    real(DP) :: violation = 0                      !< largest of the bonds at the last evaluation, over their size [-]
    real(DP), allocatable :: lever(:)              !< (n_nodes) what makes a length of an angle; empty: there are no angles [length]
    real(DP), allocatable :: u_start(:, :)         !< (3, n_nodes) displacement at the start of the step [length]
    real(DP), allocatable :: imbalance(:, :)       !< (3, n_nodes) Rhat = F_ext - F_int, condensed on the free unknowns [force]
    real(DP), allocatable :: residual(:, :)        !< (3, n_nodes) R = Rhat + F_c, condensed [force]
    real(DP), allocatable :: lawful(:, :)          !< (3, n_nodes) R with what compliant laws give where their nodes are [force]
    real(DP) :: largest_residual = 0               !< [force]
    real(DP) :: largest_force = 0                  !< largest internal, applied or contact force on a node [force]
    real(DP) :: bulk_force = 0                     !< largest internal or applied force on a node [force]
    real(DP) :: rounding = 0                       !< what rounding makes of gaps: no residual [force]
    real(DP) :: merit = 0                          !< norm of residual, gaps and stick violations scaled to forces [force]
    logical :: is_nlgeom = .false.
    logical :: is_constant = .false.               !< the stiffness of this step depends on nothing
    logical :: is_assembled = .false.              !< and is there already
    integer :: n_conflicts = 0                     !< contact rows dropped for stronger constraints
    integer :: trouble_item = 0
    integer :: n_factorisations = 0                !< since the last reset by the stepper
    integer :: n_before = 0                        !< the same when the direction was wanted
    integer :: n_krylov = 0
    integer :: n_rounds = 0                        !< corrections of directions while contact settled
    integer :: n_unstable = 0                      !< factorisations of the bulk in this attempt that found it not stable
    integer :: n_shifted = 0                       !< factorisations that needed a shift
    integer :: n_whole = 0                         !< directions that needed UMFPACK
    real(DP) :: seconds(N_PHASES) = 0              !< [s]
    real(DP) :: megabytes(N_PHASES) = 0            !< by which the peak of memory grew
    real(DP) :: peak = 0                           !< of memory, when the clock was read last [megabytes]
  end type system_type

  !> A configuration as it was evaluated, to start from and to come back to.
  type :: place_type
    real(DP), allocatable :: u(:, :)               !< (3, n_nodes) [length]
    real(DP), allocatable :: internal_force(:, :)  !< (3, n_nodes) [force]
    real(DP), allocatable :: residual(:, :)        !< (3, n_nodes) R [force]
    type(slave_type), allocatable :: slaves(:)
    type(slip_point_type), allocatable :: view(:)  !< (n_slaves)
    real(DP) :: merit = 0                          !< [force]
  end type place_type

contains

  !> Assembly and contact are made ready, the state is laid out.
  subroutine create_system(system, model, state, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(out) :: state
    type(error_type), allocatable, intent(out) :: error
    call prepare_state(system, model, state, error)
    if (allocated(error)) return
    call prepare_bonds(system, model, error)
    if (allocated(error)) return
    allocate (system%u_start(3, model%mesh%n_nodes), system%imbalance(3, model%mesh%n_nodes), &
      system%residual(3, model%mesh%n_nodes), system%lawful(3, model%mesh%n_nodes), source=0.0_DP)
  end subroutine create_system


  !> The pattern of the stiffness, with what bonds couple, and the unknowns that no element knows.
  subroutine prepare_bonds(system, model, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: first(:), nodes(:)
    integer :: i
    allocate (first(n_bonds(model) + 1), nodes(0))
    first(1) = 1
    do i = 1, n_bonds(model)
      nodes = [nodes, curved_nodes(model%bonds(i))]
      first(i + 1) = size(nodes) + 1
    end do
    call create_assembly(system%assembly, model%mesh, error, first, nodes)
    if (allocated(error)) return
    system%is_lone = lone_unknowns(model)
    system%lever = levers(model)
  end subroutine prepare_bonds


  !> Contact finds its slave nodes; the state is laid out with them.
  subroutine prepare_state(system, model, state, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(out) :: state
    type(error_type), allocatable, intent(out) :: error
    type(slave_type), allocatable :: slaves(:)
    call create_contact(system%contact, model, slaves, error)
    if (allocated(error)) return
    call create_state(state, model%mesh, slaves)
    call create_material_state(state, model)
  end subroutine prepare_state


  !> A step begins: which unknowns its supports hold. Errors: constraints that contradict each other (EXIT_SETUP).
  subroutine begin_step(system, model, step, state, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state
    type(error_type), allocatable, intent(out) :: error
    logical, allocatable :: is_held(:, :)          ! (3, n_nodes)
    integer :: p
    system%u_start = state%old%u
    if (allocated(system%share)) deallocate (system%share)
    system%is_nlgeom = step%is_nlgeom
    system%is_constant = .not. step%is_nlgeom .and. all(model%materials%is_plain) .and. .not. allocated(model%mesh%spring) &
      .and. .not. is_damped(step)
    system%is_assembled = .false.
    if (allocated(step%is_absent)) system%is_lone = lone_unknowns(model)
    system%reduced%asked = step%solver
    system%reduced%is_repeated = size(state%old%slaves) > 0 .or. &
      (system%is_constant .and. step%dt_initial < FEW_INCREMENTS * step%period)
    call prescribe(system, model, step, state%old, error)
    if (allocated(error)) return
    call begin_contact_step(system%contact, model, step)
    allocate (is_held(3, model%mesh%n_nodes))
    call find_held(model, step, system%base%owner, is_held)
    call set_supports(system%contact, model, state%old%slaves, system%base, is_held, error)
    if (allocated(error)) return
    do p = 1, size(system%contact%facets)
      call find_symmetry(system%contact%facets(p), model, is_held)
      if (model%pairs(p)%is_mortar) call find_symmetry(system%contact%mortar(p)%slave, model, is_held)
    end do
  end subroutine begin_step


  !> Chooses the solver of a step before anything is computed, where the model is so large that it matters.
  subroutine plan_solver(system, model, error)
    type(system_type), intent(inout) :: system     !< the step has begun
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    logical :: is_clear
    is_clear = is_small(system%base%n_free, system%reduced%is_repeated)
    if (is_clear .and. system%reduced%asked == SOLVER_AUTO) return
    call plan_reduced(system%reduced, system%assembly%stiffness, system%base, model%mesh, error)
  end subroutine plan_solver


  !> An increment begins: the trial state stands at its end in time and at its start in displacement.
  subroutine begin_increment(system, model, step, is_step_start, state)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(inout) :: state
    call set_temperatures(model, step, state)
    call begin_damping(step, is_step_start, state)
    call renew_points(system%contact, model, state)
    if (.not. system%is_constant) system%is_assembled = .false.
    call begin_contact_increment(system%contact, model, step%is_nlgeom, is_step_start, system%u_start, state%new)
    call drop_bulk(system, model, step, is_step_start, state)
  end subroutine begin_increment


  !> The base constraints for what is still missing to the prescribed displacements at the time of `fields`.
  subroutine prescribe(system, model, step, fields, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    type(error_type), allocatable, intent(out) :: error
    call support_model(system%base, model, step, fields, system%u_start, system%contact%follower, system%is_lone, &
      system%violation, error)
  end subroutine prescribe


  !> Imbalance, contact and residual at state%new%u: forces only.
  subroutine evaluate(system, model, step, state, trouble, is_frozen)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: trouble                !< TROUBLE_...
    logical, intent(in) :: is_frozen               !< every slave node keeps its status
    type(error_type), allocatable :: error         ! rows that contradict each other here
    integer :: failed
    integer(I64) :: clock
    call start_clock(system, clock)
    call assemble_forces(system%assembly, model, step%is_nlgeom, state, failed)
    trouble = merge(TROUBLE_NONE, TROUBLE_ELEMENT, failed == 0)
    system%trouble_item = failed
    if (failed /= 0) return
    call assemble_loads(system%assembly, model, step, state%new, step%is_nlgeom, .false.)
    if (is_damped(step) .and. .not. allocated(system%share)) call share_volumes(model%mesh, state%new, system%share)
    if (state%new%damping(DAMPING_NOW) > 0.0_DP) call brake(system%share, state)
    if (step%is_nlgeom .and. n_bonds(model) > 0) call prescribe(system, model, step, state%new, error)
    if (allocated(error)) trouble = TROUBLE_SOLVER
    if (allocated(error)) return
    call condense_forces(system%base, state%new%applied_force - state%new%internal_force, system%imbalance)
    call stop_clock(system, clock, PHASE_ASSEMBLY)
    call evaluate_contact(system%contact, model, state%old, system%imbalance, is_frozen, state%new)
    call measure(system, state%new)
    system%rounding = ROUNDINGS * rounding_force(system%contact%laws, system%contact%met, state%new%slaves, model%mesh%coordinates)
    call stop_clock(system, clock, PHASE_CONTACT)
    if (.not. system%merit <= huge(1.0_DP)) trouble = TROUBLE_NOT_FINITE
  end subroutine evaluate


  !> Residual, reaction, and the norms by which an iterate is judged.
  subroutine measure(system, fields)
    type(system_type), intent(inout) :: system
    type(fields_type), intent(inout) :: fields
    real(DP) :: violation
    integer :: s
    fields%reaction_force = fields%internal_force - fields%applied_force - fields%contact_force
    call condense_forces(system%base, -fields%reaction_force, system%residual)
    system%lawful = system%residual
    if (any(is_compliant(system%contact%laws))) call condense_forces(system%base, system%contact%ahead - fields%reaction_force, &
      system%lawful)
    call keep_supports(system%base, fields%reaction_force)
    system%largest_residual = maxval(components_of(system, system%residual, -1))
    system%bulk_force = max(maxval(components_of(system, fields%internal_force, -1)), &
      maxval(components_of(system, fields%applied_force, -1)))
    system%largest_force = max(system%bulk_force, maxval(components_of(system, fields%contact_force, -1)))
    violation = 0.0_DP
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        if (slave%status == STATUS_OPEN .or. is_compliant(system%contact%laws(slave%pair))) cycle
        violation = violation + (slave%stiffness * slave%gap)**2
        if (slave%status == STATUS_STICK) violation = violation + (slave%stiffness * norm2(slave%slip_increment))**2
      end associate
    end do
    if (size(system%lever) > 0) then
      system%merit = sqrt(sum(sizes_of(system, system%residual, -1)**2) + violation)
    else
      system%merit = sqrt(sum(system%residual**2) + violation)
    end if
  end subroutine measure


  !> d'R(u): the product that the line search over all unknowns needs.
  pure real(DP) function residual_pair(system, direction) result(product)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: direction(:, :)        !< (3, n_nodes) [length]
    product = sum(direction * system%residual)
  end function residual_pair


  !> The largest component at each node of displacements (power 1) or forces (power -1); angles as lengths, moments as forces.
  pure function components_of(system, field, power) result(largest)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: field(:, :)            !< (3, n_nodes) [length] or [force]
    integer, intent(in) :: power
    real(DP) :: largest(size(field, 2))
    largest = maxval(abs(field), dim=1)
    if (size(system%lever) > 0) largest = largest * system%lever**power
  end function components_of


  !> The same of vectors.
  pure function sizes_of(system, field, power) result(length)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: field(:, :)            !< (3, n_nodes) [length] or [force]
    integer, intent(in) :: power
    real(DP) :: length(size(field, 2))
    length = norm2(field, dim=1)
    if (size(system%lever) > 0) length = length * system%lever**power
  end function sizes_of


  !> The largest residual, and that with laws where their nodes are, beyond what rounding makes of them.
  pure function residuals_beyond(system, u) result(largest)
    type(system_type), intent(in) :: system        !< K was assembled
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP) :: largest(2)                         !< [force]
    largest = [residual_beyond(system, system%residual, u), residual_beyond(system, system%lawful, u)]
  end function residuals_beyond


  !> The largest of a residual beyond what rounding of the displacements makes of it: of what the stiffness of an unknown makes of
  !! the largest displacement, the last digit. A body that moves without any force has nothing but that.
  pure real(DP) function residual_beyond(system, field, u) result(largest)
    type(system_type), intent(in) :: system        !< K was assembled
    real(DP), intent(in) :: field(:, :)            !< (3, n_nodes) R or that of the laws where their nodes are [force]
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP) :: last_digit                         ! [length]
    real(DP), allocatable :: of_node(:)            ! (n_nodes) [force]
    integer :: i
    last_digit = ROUNDINGS * epsilon(1.0_DP) * maxval(components_of(system, u, 1))
    associate (K => system%assembly%stiffness, residual => abs(field))
      allocate (of_node(size(u, 2)))
      do i = 1, size(u, 2)
        of_node(i) = maxval(residual(:, i) - last_digit * abs(K%value(K%first(3 * i - 2:3 * i))))
      end do
    end associate
    if (size(system%lever) > 0) of_node = of_node / system%lever
    largest = max(0.0_DP, maxval(of_node))
  end function residual_beyond


  !> Where the last evaluation was.
  pure type(place_type) function place_of(system, state) result(place)
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state          !< evaluated
    place = place_type(state%new%u, state%new%internal_force, system%residual, state%new%slaves, system%contact%view, &
      system%merit)
  end function place_of


  !> Imbalance, contact and residual at u + du as the tangent at u foretells them: without the elements.
  subroutine foresee(system, model, start, du, state)
    type(system_type), intent(inout) :: system     !< linearised at u
    type(model_type), intent(in) :: model
    type(place_type), intent(in) :: start          !< u, with its internal force
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    type(state_type), intent(inout) :: state       !< its slaves are where they start from
    real(DP), allocatable :: change(:)
    integer(I64) :: clock
    call start_clock(system, clock)
    allocate (change(size(du)))
    call multiply_symmetric(system%assembly%stiffness, reshape(du, [size(du)]), change)
    state%new%u = start%u + du
    state%new%internal_force = start%internal_force + reshape(change, shape(du))
    call condense_forces(system%base, state%new%applied_force - state%new%internal_force, system%imbalance)
    call evaluate_contact(system%contact, model, state%old, system%imbalance, .false., state%new)
    call measure(system, state%new)
    call stop_clock(system, clock, PHASE_CONTACT)
  end subroutine foresee


  !> Back from where was foreseen to where that started. What the next evaluation makes anew is left as it was foreseen: forces, and
  !! the rows of mortar pairs.
  subroutine return_to(system, model, step, start, state, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(place_type), intent(in) :: start
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: error
    state%new%u = start%u
    state%new%slaves = start%slaves
    system%residual = start%residual
    system%contact%view = start%view
    system%merit = start%merit
    if (system%condensed%is_ready .and. allocated(system%bulk_u)) then   ! a factor made meanwhile has the stiffness of u
      if (system%n_factorisations > system%n_before) system%bulk_u = start%u
    end if
    call prescribe(system, model, step, state%new, error)
  end subroutine return_to


  !> Whether the bulk's factor may serve the next increment too, as a preconditioner. It may where its matrix can be made again
  !! from the displacements alone, so that a job that is resumed goes on with the same factor.
  subroutine drop_bulk(system, model, step, is_step_start, state)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(in) :: state          !< trial, at the start of the increment
    logical, allocatable :: is_contact(:)
    logical :: is_kept
    if (size(state%new%slaves) == 0) return
    if (system%n_unstable > 0) system%is_dense_wanted = .true.   ! an attempt knows nothing of those before it
    system%n_unstable = 0
    is_kept = all(model%materials%is_plain) .and. .not. allocated(model%mesh%spring) .and. system%base%n_rows == 0 .and. &
      (.not. step%is_nlgeom .or. size(step%distributed) == 0) .and. .not. is_damped(step)
    if (is_kept .and. is_step_start) is_kept = is_same_bulk(system) .and. .not. (allocated(step%is_absent) .or. &
      allocated(step%material))
    is_contact = interface_unknowns(system, model, state%new, .not. step%is_nlgeom)
    if (is_kept .and. allocated(system%is_contact)) is_kept = .not. any(is_contact .and. .not. system%is_contact)
    if (is_kept .and. allocated(system%is_contact)) return
    call forget_bulk(system)
    if (allocated(system%base%owner)) system%is_held = system%base%owner /= 0   ! not there in the audit before the first step
    system%is_bulk_nlgeom = system%is_nlgeom
    if (allocated(system%is_contact)) then
      if (.not. is_step_start .and. all(is_contact .eqv. system%is_contact)) return   ! a step may have other supports
    end if
    system%condensed%is_analysed = .false.
    system%is_dense_wanted = .true.
    call move_alloc(is_contact, system%is_contact)
  end subroutine drop_bulk


  !> Whether the bulk of a new step is that of the last one: the same unknowns are held, and NLGEOM is as it was.
  pure logical function is_same_bulk(system) result(is_same)
    type(system_type), intent(in) :: system
    is_same = allocated(system%is_held) .and. (system%is_bulk_nlgeom .eqv. system%is_nlgeom)
    if (is_same) is_same = all(system%is_held .eqv. system%base%owner /= 0)
  end function is_same_bulk


  !> The factor of the bulk is not to be used any more.
  subroutine forget_bulk(system)
    type(system_type), intent(inout) :: system
    system%condensed%is_ready = .false.
    if (allocated(system%bulk_u)) deallocate (system%bulk_u)
  end subroutine forget_bulk


  !> What contact can reach: slave nodes near their master, their facets and the facets beside these.
  pure function interface_unknowns(system, model, fields, is_far_too) result(is_contact)
    type(system_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_far_too              !< nodes that are far from their master too
    logical :: is_contact(3 * model%mesh%n_nodes)
    logical :: is_near(model%mesh%n_nodes)
    type(contact_row_type) :: row
    integer :: s, k, i, j
    is_near = .false.
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        if (slave%facet == 0) cycle
        if (slave%gap > NEAR * system%contact%edge(slave%pair) .and. .not. is_far_too) cycle
        call touching_row(system%contact, slave, row)
        is_near(row%nodes) = .true.
        is_near(row%own) = .true.
        associate (facets => system%contact%facets(slave%pair))
          is_near(facets%nodes(facets%first(slave%facet):facets%first(slave%facet + 1) - 1)) = .true.
          do k = 1, 4
            j = facets%neighbour(k, slave%facet)
            if (j > 0 .and. .not. system%contact%is_small(slave%pair)) &
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
    type(system_type), intent(inout) :: system
    integer(I64), intent(out) :: clock
    call system_clock(clock)
    system%peak = peak_megabytes()
  end subroutine start_clock


  !> Adds the time since the clock was started or last read, and what the peak of memory grew, and starts it again.
  subroutine stop_clock(system, clock, phase)
    type(system_type), intent(inout) :: system
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
