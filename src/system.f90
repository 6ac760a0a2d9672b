!> System: the equations at one configuration, and the Newton direction from there.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Two verbs. `evaluate` gives imbalance, contact and residual of a configuration: forces only, no matrix.
!! `find_direction` linearises there and solves:
!!
!!     K      stiffness of the elements and loads, symmetric; what the tangent has beside it is in assembly%skew
!!     C, c   du = C dv + c: boundary conditions, equations, followers, contact rows     (constraints)
!!     A      C' K C, factorised by Cholesky                                             (factor)
!!     J      C' (K - d F_c) C, with the exact change of the contact forces, unsymmetric (contact_tangent)
!!
!! J dv = C' R is solved by GMRES with A as the preconditioner (doc/theory/solver.md).
module amontons_system
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type
  use amontons_posix, only: peak_megabytes
  use amontons_model, only: model_type, n_bonds
  use amontons_surfaces, only: is_compliant
  use amontons_steps, only: step_type, SOLVER_AUTO
  use amontons_history, only: N_PHASES, PHASE_ASSEMBLY, PHASE_CONTACT, PHASE_FACTOR, PHASE_KRYLOV
  use amontons_state, only: set_temperatures, state_type, fields_type, DAMPING_NOW, STATUS_OPEN
  use amontons_changes, only: lone_unknowns
  use amontons_sparse, only: sparse_type, multiply, multiply_transpose, multiply_symmetric, product_of, transpose_of, &
    full_of, sum_of
  use amontons_factor, only: lu_type, lu_factorise, lu_solve, FACTOR_OK
  use amontons_reduced, only: reduced_type, plan_reduced, is_small, factorise_reduced, apply_reduced, give_up_iterative
  use amontons_sprung, only: springs_type
  use amontons_condensed, only: condensed_type, is_analysed_for, analyse_bulk, factorise_bulk, factorise_interface, &
    factorise_springs, apply_condensed, is_interface_worth
  use amontons_krylov, only: operator_type, matrix_operator_type, krylov_options_type, krylov_report_type, gmres, &
    conjugate_gradients, KRYLOV_CONVERGED
  use amontons_constraints, only: constraints_type, finish_constraints, condense_forces, condensation
  use amontons_bonds, only: add_curvatures, keep_supports, curved_nodes
  use amontons_supports, only: support_model
  use amontons_damping, only: is_damped, begin_damping, share_volumes, brake, stiffen
  use amontons_skew, only: finish_skew, subtract_skew, with_skew
  use amontons_assembly, only: assembly_type, create_assembly, assemble_forces, assemble_tangent
  use amontons_applied, only: assemble_loads
  use amontons_symmetry, only: find_symmetry, find_held
  use amontons_contact, only: contact_type, create_contact, begin_contact_step, set_supports, evaluate_contact, &
    touching_row
  use amontons_slaves, only: rounding_force
  use amontons_contact_start, only: begin_contact_increment
  use amontons_contact_points, only: renew_points
  use amontons_rows, only: contact_row_type
  use amontons_contact_tangent, only: link_type, linearise_contact, add_contact_rows, apply_contact_tangent, &
    contact_matrices, contact_springs, spring_factors
  implicit none
  private
  public :: system_type, create_system, begin_step, plan_solver, begin_increment, evaluate, linearise, find_direction, &
    change_forces, foresee, correct_direction, return_to, carry_bodies, &
    tangent_matrix, residual_pair
  public :: TROUBLE_NONE, TROUBLE_ELEMENT, TROUBLE_SOLVER, TROUBLE_NOT_FINITE

  integer, parameter :: TROUBLE_NONE = 0
  integer, parameter :: TROUBLE_ELEMENT = 1        !< an element is inverted: system%trouble_item is its index
  integer, parameter :: TROUBLE_SOLVER = 2         !< the tangent is singular and no direction was found
  integer, parameter :: TROUBLE_NOT_FINITE = 3     !< a number is not finite

  real(DP), parameter :: KRYLOV_TOLERANCE = 1.0e-9_DP    !< of a direction, relative to the right-hand side [-]
  real(DP), parameter :: KRYLOV_SHARE = 1.0e-3_DP        !< of the residual that Newton allows: what a direction may leave [-]
  integer, parameter :: KRYLOV_MOST = 200                !< Krylov iterations of one direction
  real(DP), parameter :: ITERATIVE_TOLERANCE = 1.0e-11_DP   !< of a direction without a factor: its error is seen less well [-]
  real(DP), parameter :: FEW_INCREMENTS = 0.3_DP         !< first increment over the step: a factor serves fewer than that [-]
  integer, parameter :: MOST_OLD = 8                     !< Krylov iterations after which an old factor of the bulk is given up
  integer, parameter :: MOST_UNSTABLE = 3                !< such factorisations after which an attempt goes on without the interface
  integer, parameter :: MOST_INTERFACE = 6000            !< largest interface [unknowns]
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
    logical, allocatable :: is_contact(:)          !< (n_unknowns) on the interface
    logical, allocatable :: is_held(:)             !< (n_unknowns) by the base constraints, where the bulk was analysed
    real(DP) :: carry = 0                          !< part of its own diagonal that K has more, for bodies that nothing holds [-]
    logical :: is_bulk_nlgeom = .false.            !< the factor of the bulk is one of a step with NLGEOM
    logical, allocatable :: is_lone(:)             !< (3 n_nodes) of a node without elements
    real(DP), allocatable :: share(:)              !< (n_nodes) of volume, for damping; not there: no step has had any [length^3]
    real(DP) :: violation = 0                      !< largest of the bonds at the last evaluation, over their size [-]
    real(DP), allocatable :: u_start(:, :)         !< (3, n_nodes) displacement at the start of the step [length]
    real(DP), allocatable :: imbalance(:, :)       !< (3, n_nodes) Rhat = F_ext - F_int, condensed on the free unknowns [force]
    real(DP), allocatable :: residual(:, :)        !< (3, n_nodes) R = Rhat + F_c, condensed [force]
    real(DP) :: largest_residual = 0               !< [force]
    real(DP) :: largest_force = 0                  !< largest internal, applied or contact force on a node [force]
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
    integer :: n_unstable = 0                      !< factorisations of the bulk in this attempt that found it not stable
    integer :: n_shifted = 0                       !< factorisations that needed a shift
    integer :: n_whole = 0                         !< directions that needed UMFPACK
    real(DP) :: seconds(N_PHASES) = 0              !< [s]
    real(DP) :: megabytes(N_PHASES) = 0            !< by which the peak of memory grew
    real(DP) :: peak = 0                           !< of memory, when the clock was read last [megabytes]
  end type system_type

  !> J: the exact tangent as an operator on the free unknowns.
  type, extends(operator_type) :: tangent_type
    type(system_type), pointer :: system => null()
  contains
    procedure :: apply => apply_tangent
  end type tangent_type

  !> inv(A): the factor as an operator.
  type, extends(operator_type) :: preconditioner_type
    type(system_type), pointer :: system => null()
  contains
    procedure :: apply => apply_preconditioner
  end type preconditioner_type

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
      system%residual(3, model%mesh%n_nodes), source=0.0_DP)
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
  end subroutine prepare_bonds


  !> Contact finds its slave nodes; the state is laid out with them.
  subroutine prepare_state(system, model, state, error)
    use amontons_state, only: slave_type, create_state, create_material_state
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
  subroutine evaluate(system, model, step, is_frozen, state, trouble)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_frozen               !< .true.: every slave node keeps its status
    type(state_type), intent(inout) :: state
    integer, intent(out) :: trouble                !< TROUBLE_...
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
    system%rounding = ROUNDINGS * rounding_force(system%contact%laws, state%new%slaves, model%mesh%coordinates)
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
    call keep_supports(system%base, fields%reaction_force)
    system%largest_residual = maxval(abs(system%residual))
    system%largest_force = max(maxval(abs(fields%internal_force)), maxval(abs(fields%applied_force)), &
      maxval(abs(fields%contact_force)))
    violation = 0.0_DP
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        if (slave%status == STATUS_OPEN .or. is_compliant(system%contact%laws(slave%pair))) cycle
        violation = violation + (slave%stiffness * slave%gap)**2
        if (slave%status == 1) violation = violation + (slave%stiffness * norm2(slave%slip_increment))**2
      end associate
    end do
    system%merit = sqrt(sum(system%residual**2) + violation)
  end subroutine measure


  !> d'R(u): the product that the line search over all unknowns needs.
  pure real(DP) function residual_pair(system, direction) result(product)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: direction(:, :)        !< (3, n_nodes) [length]
    product = sum(direction * system%residual)
  end function residual_pair


  !> The Newton direction du at the configuration of the last evaluation.
  subroutine find_direction(system, model, step, state, du, trouble, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error   !< out of memory and the like
    integer(I64) :: clock
    call linearise(system, model, step, state, trouble, error)
    if (allocated(error) .or. trouble /= TROUBLE_NONE) return
    call start_clock(system, clock)
    call factorise_condensed(system, model, step, state, error)
    if (allocated(error)) return
    if (.not. system%is_condensed) call factorise_whole(system, model, trouble, error)
    if (allocated(error) .or. trouble /= TROUBLE_NONE) return
    call stop_clock(system, clock, PHASE_FACTOR)
    system%n_before = system%n_factorisations
    system%is_settled = .false.
    call solve_direction(system, floor_of(system, step), du, trouble, error)
    if (trouble == TROUBLE_SOLVER .and. .not. system%is_condensed .and. system%reduced%is_iterative) then
      call give_up_iterative(system%reduced)
      call factorise_whole(system, model, trouble, error)
      if (allocated(error) .or. trouble /= TROUBLE_NONE) return
      call solve_direction(system, floor_of(system, step), du, trouble, error)
    end if
    call stop_clock(system, clock, PHASE_KRYLOV)
  end subroutine find_direction


  !> The residual that a direction may leave, where another Newton iteration follows and work can be saved.
  pure real(DP) function floor_of(system, step) result(floor)
    type(system_type), intent(in) :: system
    type(step_type), intent(in) :: step
    floor = 0
    if (system%is_condensed .or. (system%reduced%is_iterative .and. .not. system%is_constant)) &
      floor = KRYLOV_SHARE * step%controls%r_n * system%largest_force
  end function floor_of


  !> Imbalance, contact and residual at u + du as the tangent at u foretells them: without the elements.
  subroutine foresee(system, model, state, u, force, du)
    type(system_type), intent(inout) :: system     !< linearised at u
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state       !< its slaves are where they start from
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: force(:, :)            !< (3, n_nodes) internal force at u [force]
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    real(DP), allocatable :: change(:)
    integer(I64) :: clock
    call start_clock(system, clock)
    allocate (change(size(du)))
    call multiply_symmetric(system%assembly%stiffness, reshape(du, [size(du)]), change)
    state%new%u = u + du
    state%new%internal_force = force + reshape(change, shape(du))
    call condense_forces(system%base, state%new%applied_force - state%new%internal_force, system%imbalance)
    call evaluate_contact(system%contact, model, state%old, system%imbalance, .false., state%new)
    call measure(system, state%new)
    call stop_clock(system, clock, PHASE_CONTACT)
  end subroutine foresee


  !> The direction from a place that was foreseen, with the tangent of the bulk as it is.
  subroutine correct_direction(system, model, step, state, du, trouble, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: clock
    call start_clock(system, clock)
    trouble = TROUBLE_SOLVER
    call constrain(system, model, step, state%old, state%new, error)
    if (allocated(error)) return
    call stop_clock(system, clock, PHASE_CONTACT)
    call factorise_condensed(system, model, step, state, error)
    if (allocated(error) .or. .not. system%is_condensed) return
    call stop_clock(system, clock, PHASE_FACTOR)
    call solve_direction(system, KRYLOV_SHARE * step%controls%r_n * system%largest_force, du, trouble, error)
    call stop_clock(system, clock, PHASE_KRYLOV)
  end subroutine correct_direction


  !> Back from where was foreseen to u: displacements, slaves, and the base constraints there.
  subroutine return_to(system, model, step, u, slaves, state, error)
    use amontons_state, only: slave_type
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: u(:, :)
    type(slave_type), intent(in) :: slaves(:)
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: error
    state%new%u = u
    state%new%slaves = slaves
    if (system%condensed%is_ready .and. allocated(system%bulk_u)) then   ! a factor made meanwhile has the stiffness of u
      if (system%n_factorisations > system%n_before) system%bulk_u = u
    end if
    call prescribe(system, model, step, state%new, error)
  end subroutine return_to


  !> K, the linearised contact forces, and C with c, at the configuration of the last evaluation.
  subroutine linearise(system, model, step, state, trouble, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    integer :: failed
    integer(I64) :: clock
    trouble = TROUBLE_NONE
    call start_clock(system, clock)
    if (.not. system%is_assembled) then
      system%reduced%is_current = .false.
      call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
      trouble = merge(TROUBLE_NONE, TROUBLE_ELEMENT, failed == 0)
      if (failed /= 0) return
      call assemble_loads(system%assembly, model, step, state%new, step%is_nlgeom, .true.)
      if (state%new%damping(DAMPING_NOW) > 0.0_DP) call brake(system%share, state)
      call finish_skew(system%assembly%skew, 3 * model%mesh%n_nodes, error)
      if (allocated(error)) return
      if (state%new%damping(DAMPING_NOW) > 0.0_DP) call stiffen(system%share, state, system%assembly%stiffness)
      system%is_assembled = system%is_constant
      call add_carry(system)
    end if
    if (step%is_nlgeom .and. n_bonds(model) > 0) call add_curvatures(system%base, system%assembly, model, state%new)
    call scale_slaves(system, state%new)
    call stop_clock(system, clock, PHASE_ASSEMBLY)
    call constrain(system, model, step, state%old, state%new, error)
    call stop_clock(system, clock, PHASE_CONTACT)
  end subroutine linearise


  !> From now on K has so much more of its own diagonal; 0: as it is.
  subroutine carry_bodies(system, model, fields, part)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: part                   !< [-]
    logical, allocatable :: is_reached(:)
    system%carry = part
    if (part > 0.0_DP) then                        ! contact anywhere is what they are carried to
      is_reached = interface_unknowns(system, model, fields, .true.)
      if (any(is_reached .and. .not. system%is_contact)) system%condensed%is_analysed = .false.
      system%is_contact = system%is_contact .or. is_reached
    end if
    system%is_assembled = .false.
    system%is_dense_wanted = .true.
    call forget_bulk(system)
  end subroutine carry_bodies


  !> K with a part of its own diagonal.
  subroutine add_carry(system)
    type(system_type), intent(inout) :: system
    integer :: i
    if (system%carry <= 0.0_DP) return
    associate (K => system%assembly%stiffness)
      do i = 1, K%n_rows
        K%value(K%first(i)) = (1.0_DP + system%carry) * K%value(K%first(i))
      end do
    end associate
  end subroutine add_carry


  !> The scale c of the trial traction: the mean of the node's own stiffness, a diagonal block of K.
  subroutine scale_slaves(system, fields)
    type(system_type), intent(in) :: system
    type(fields_type), intent(inout) :: fields
    integer :: s, i
    do s = 1, size(fields%slaves)
      i = 3 * (fields%slaves(s)%node - 1)
      associate (K => system%assembly%stiffness)
        fields%slaves(s)%stiffness = (K%value(K%first(i + 1)) + K%value(K%first(i + 2)) + K%value(K%first(i + 3))) / 3.0_DP
      end associate
    end do
  end subroutine scale_slaves


  !> C and c of all constraints, contact rows included.
  subroutine constrain(system, model, step, old, fields, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: old           !< committed
    type(fields_type), intent(in) :: fields
    type(error_type), allocatable, intent(out) :: error
    call prescribe(system, model, step, fields, error)
    if (allocated(error)) return
    call linearise_contact(system%contact, model, old, fields, system%links)
    system%whole = system%base
    call add_contact_rows(system%contact, model, fields, system%links, system%whole, system%n_conflicts)
    call finish_constraints(system%whole)
  end subroutine constrain


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


  !> Contact by the condensed interface: the bulk is factorised if its factor is gone, the interface always.
  !! After: is_condensed is .false. where the interface is too large or the bulk is not stable.
  subroutine factorise_condensed(system, model, step, state, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< not changed
    type(error_type), allocatable, intent(out) :: error
    logical :: is_complete
    integer :: attempt
    system%is_condensed = .false.
    if (size(state%new%slaves) == 0 .or. .not. system%is_dense_wanted .or. system%reduced%is_iterative) return
    do attempt = 1, 2
      call provide_bulk(system, model, step, state, error)
      if (allocated(error) .or. .not. system%condensed%is_ready) return
      call factorise_contact(system, is_complete, error)
      if (allocated(error)) return
      system%is_condensed = is_complete
      if (is_complete) return
      system%is_contact = system%is_contact .or. interface_unknowns(system, model, state%new, .false.)
      system%condensed%is_analysed = .false.
      call forget_bulk(system)
    end do
  end subroutine factorise_condensed


  !> The interface for the present contact: by its springs where all contact is compliant and the bodies are held without it.
  subroutine factorise_contact(system, is_complete, error)
    type(system_type), intent(inout) :: system
    logical, intent(out) :: is_complete            !< .false.: contact reaches beyond the interface
    type(error_type), allocatable, intent(out) :: error
    type(springs_type) :: springs
    type(sparse_type) :: by_imbalance, by_displacement
    logical :: is_fit
    if (all(system%links%is_spring) .and. size(system%links) > 0 .and. 3 * size(system%links) < system%condensed%n_contact &
      .and. system%condensed%is_invertible) then
      call spring_factors(system%links, system%whole%n_unknowns, springs, error)
      if (allocated(error)) return
      call factorise_springs(system%condensed, system%base, system%whole, springs, is_complete, is_fit, error)
      if (allocated(error) .or. is_fit .or. .not. is_complete) return
    end if
    call contact_matrices(system%links, system%contact%passing, system%whole%n_unknowns, by_imbalance, by_displacement)
    call factorise_interface(system%condensed, system%base, system%whole, by_imbalance, by_displacement, is_complete, error)
  end subroutine factorise_contact


  !> The factor of the bulk: the one at hand, else that of bulk_u (of a job that was resumed), else a new one.
  subroutine provide_bulk(system, model, step, state, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< not changed
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: u(:, :)
    integer :: failed
    if (system%condensed%is_ready) return
    if (.not. allocated(system%bulk_u)) then
      call renew_bulk(system, error)
      if (system%condensed%is_ready) system%bulk_u = state%new%u
      return
    end if
    u = state%new%u
    state%new%u = system%bulk_u
    call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
    call renew_bulk(system, error)
    state%new%u = u
    if (allocated(error)) return
    if (system%condensed%is_ready) system%n_factorisations = system%n_factorisations - 1   ! the job that ran on had it
    call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
  end subroutine provide_bulk


  !> Factorises the bulk with the present stiffness, if the interface is small enough.
  subroutine renew_bulk(system, error)
    type(system_type), intent(inout) :: system
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    system%is_dense_wanted = .false.
    if (system%base%n_free == 0) return            ! all is prescribed
    if (.not. is_analysed_for(system%condensed, system%base)) then
      if (count(system%is_contact) > MOST_INTERFACE .or. system%base%n_free == 0) return   ! all may be prescribed
      call analyse_bulk(system%condensed, system%assembly%stiffness, system%base, system%is_contact, error)
      if (allocated(error) .or. .not. system%condensed%is_analysed) return
    end if
    if (.not. is_interface_worth(system%condensed%n_contact, system%condensed%factor%n_operations)) return
    call factorise_bulk(system%condensed, system%assembly%stiffness, system%base, status, error)
    if (allocated(error)) return
    system%n_factorisations = system%n_factorisations + 1
    if (status /= FACTOR_OK) system%n_unstable = system%n_unstable + 1   ! the next iterate may be a better place
    system%is_dense_wanted = system%n_unstable < MOST_UNSTABLE
  end subroutine renew_bulk


  !> A and its factor, with the springs of compliant contact in K: they make it the better preconditioner.
  subroutine factorise_whole(system, model, trouble, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    integer, intent(out) :: trouble
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: springs
    integer :: status
    trouble = TROUBLE_NONE
    if (any(system%links%is_spring)) then
      call contact_springs(system%links, system%whole%n_unknowns, springs, error)
      if (allocated(error)) return
      call factorise_reduced(system%reduced, sum_of(system%assembly%stiffness, 1.0_DP, springs), .true., system%whole, &
        model%mesh, status, error)
    else
      call factorise_reduced(system%reduced, system%assembly%stiffness, .false., system%whole, model%mesh, status, error)
    end if
    system%n_factorisations = system%n_factorisations + system%reduced%n_made
    system%n_shifted = system%n_shifted + system%reduced%n_shifted
    if (allocated(error)) return
    if (status /= FACTOR_OK) trouble = TROUBLE_SOLVER
  end subroutine factorise_whole


  !> Solves J dv = C' (R - (K - dF_c) c) and gives du = C dv + c.
  subroutine solve_direction(system, floor, du, trouble, error)
    type(system_type), intent(inout), target :: system
    real(DP), intent(in) :: floor                  !< residual that is small enough [force]
    real(DP), intent(out) :: du(:, :)
    integer, intent(out) :: trouble
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: b(:), v(:), start(:), flat(:)
    trouble = TROUBLE_NONE
    allocate (b(system%whole%n_free), v(system%whole%n_free), start(system%whole%n_unknowns), flat(system%whole%n_unknowns))
    v = 0.0_DP
    flat = system%whole%offset
    call right_hand_side(system, flat, b)
    if (system%whole%n_free > 0) then
      call iterate_direction(system, floor, b, v, trouble, error)
      if (allocated(error)) return
      call multiply(system%whole%map, v, start)
      flat = flat + start
    end if
    du = reshape(flat, shape(du))
  end subroutine solve_direction


  !> J v = b: by conjugate gradients where J is A and that is not factorised, else by GMRES.
  subroutine iterate_direction(system, floor, b, v, trouble, error)
    type(system_type), intent(inout), target :: system
    real(DP), intent(in) :: floor                  !< residual that is small enough [force]
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: trouble
    type(error_type), allocatable, intent(out) :: error
    type(tangent_type) :: tangent
    type(matrix_operator_type) :: matrix
    type(preconditioner_type) :: preconditioner
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    logical :: is_iterative
    trouble = TROUBLE_NONE
    is_iterative = system%reduced%is_iterative .and. .not. system%is_condensed
    tangent%system => system
    matrix%matrix => system%reduced%matrix
    preconditioner%system => system
    options%tolerance = KRYLOV_TOLERANCE
    options%floor = floor
    options%max_iterations = merge(system%reduced%most_iterations, KRYLOV_MOST, is_iterative)
    if (is_iterative) options%tolerance = ITERATIVE_TOLERANCE
    system%condensed%allowed = max(options%tolerance, floor / max(norm2(b), tiny(floor)))
    if (is_iterative .and. size(system%links) == 0 .and. .not. allocated(system%assembly%skew%matrix%first)) then
      call conjugate_gradients(matrix, preconditioner, b, v, options, report)
    else
      call gmres(tangent, preconditioner, b, v, options, report, error)
      if (allocated(error)) return
    end if
    system%n_krylov = system%n_krylov + report%n_iterations
    if (system%is_condensed .and. report%n_iterations > MOST_OLD) call forget_bulk(system)
    if (report%status == KRYLOV_CONVERGED) return
    if (is_iterative .and. report%residual <= KRYLOV_TOLERANCE) return   ! to rounding: a slender body allows no more
    if (is_iterative) trouble = TROUBLE_SOLVER
    if (.not. is_iterative) call solve_whole(system, b, v, trouble, error)
  end subroutine iterate_direction


  !> The fall-back when GMRES does not arrive: J as a matrix, factorised by UMFPACK with pivoting.
  subroutine solve_whole(system, b, v, trouble, error)
    type(system_type), intent(inout) :: system
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: trouble
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: J
    type(lu_type) :: lu
    integer :: status
    trouble = TROUBLE_NONE
    call tangent_matrix(system, J, error)
    if (allocated(error)) return
    call lu_factorise(lu, J, status, error)
    if (allocated(error)) return
    system%n_factorisations = system%n_factorisations + 1
    system%n_whole = system%n_whole + 1
    if (status == FACTOR_OK) call lu_solve(lu, b, v)
    if (status /= FACTOR_OK .or. .not. all(abs(v) <= huge(1.0_DP))) trouble = TROUBLE_SOLVER
  end subroutine solve_whole


  !> J = C' (K + D_R E K - D_u) C, with dF_c = D_R dRhat + D_u du and dRhat = -E K du.
  subroutine tangent_matrix(system, J, error)
    type(system_type), intent(in) :: system
    type(sparse_type), intent(out) :: J            !< (n_free x n_free)
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: K, E, by_imbalance, by_displacement
    K = with_skew(full_of(system%assembly%stiffness), system%assembly%skew)
    call condensation(system%base, E, error)
    if (allocated(error)) return
    call contact_matrices(system%links, system%contact%passing, system%whole%n_unknowns, by_imbalance, by_displacement)
    K = sum_of(K, 1.0_DP, product_of(by_imbalance, product_of(E, K)))
    K = sum_of(K, -1.0_DP, by_displacement)
    J = product_of(transpose_of(system%whole%map), product_of(K, system%whole%map))
  end subroutine tangent_matrix


  !> b = C' (R - K c + dF_c(c)).
  subroutine right_hand_side(system, offset, b)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: offset(:)              !< c [length]
    real(DP), intent(out) :: b(:)
    real(DP), allocatable :: change(:)
    allocate (change(size(offset)))
    change = 0.0_DP
    if (any(offset /= 0.0_DP)) call change_forces(system, offset, change)
    call multiply_transpose(system%whole%map, reshape(system%residual, shape(change)) - change, b)
  end subroutine right_hand_side


  !> w = (K - dF_c) du over all unknowns: minus the change of the residual.
  subroutine change_forces(system, flat, w)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: flat(:)                !< du (n_unknowns) [length]
    real(DP), intent(out) :: w(:)                  !< (n_unknowns) [force]
    real(DP), allocatable :: du(:, :), d_imbalance(:, :), d_force(:, :)
    call multiply_symmetric(system%assembly%stiffness, flat, w)
    call subtract_skew(system%assembly%skew, flat, w)
    if (size(system%links) == 0) return
    allocate (d_imbalance(3, size(flat) / 3), d_force(3, size(flat) / 3))
    du = reshape(flat, [3, size(flat) / 3])
    call condense_forces(system%base, reshape(-w, shape(du)), d_imbalance)
    call apply_contact_tangent(system%links, system%contact%passing, du, d_imbalance, d_force)
    w = w - reshape(d_force, shape(w))
  end subroutine change_forces


  !> y = J x.
  subroutine apply_tangent(self, x, y)
    class(tangent_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [length]
    real(DP), intent(out) :: y(:)                  !< (n_free) [force]
    real(DP), allocatable :: flat(:), w(:)
    allocate (flat(self%system%whole%n_unknowns), w(self%system%whole%n_unknowns))
    call multiply(self%system%whole%map, x, flat)
    call change_forces(self%system, flat, w)
    call multiply_transpose(self%system%whole%map, w, y)
  end subroutine apply_tangent


  !> y = inv(A) x.
  subroutine apply_preconditioner(self, x, y)
    class(preconditioner_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    if (self%system%is_condensed) then
      call apply_condensed(self%system%condensed, x, y)
    else
      call apply_reduced(self%system%reduced, x, y)
    end if
  end subroutine apply_preconditioner


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

end module amontons_system
