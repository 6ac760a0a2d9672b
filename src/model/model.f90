!> The complete model as read from the deck, and the job options.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_model
  use amontons_kinds, only: DP, I64
  use amontons_restart_file, only: state_key_type
  use amontons_containers, only: integer_list_type
  use amontons_mesh, only: mesh_type, append_nodes
  use amontons_materials, only: material_type, orientation_type, spring_type
  use amontons_surfaces, only: surface_type, interaction_type, contact_pair_type, general_contact_type
  use amontons_loads, only: foundation_type, amplitude_type, equation_type, equation_list_type, load_type, load_value, &
    integrated_velocity
  use amontons_mpc_data, only: nonlinear_mpc_type, nonlinear_mpc_list_type, tie_type, distributing_coupling_type
  use amontons_steps, only: step_type
  use amontons_structural_data, only: structure_type
  use amontons_embeddings, only: embedding_type
  use amontons_submodels, only: submodel_type
  use amontons_user_elements, only: user_elements_type
  use amontons_user_routines, only: user_library_type
  implicit none
  private
  public :: model_type, restart_origin_type, job_options_type, job_path, dof_direction, n_nonlinear_mpcs, list_follower_nodes, &
    find_finite_rotations, &
    has_unsymmetric_elements, has_damage, has_damage_law, with_pretension_copies, new_equation, append_equation, append_mpc, &
    gather_constraints, &
    is_out, absent_elements, free_unknowns, material_in_step, load_now, displacement_now, &
    MAX_PARTITIONS, DIALECT_ABAQUS, DIALECT_CALCULIX, DIALECT_FROM_DECK

  real(DP), parameter :: TOL_ZERO_COEFFICIENT = 1.0e-14_DP   !< coefficients below this times the largest are dropped [-]
  integer, parameter :: DIALECT_FROM_DECK = 0   !< option only: the deck's first comments decide, else abaqus
  integer, parameter :: DIALECT_ABAQUS = 1
  integer, parameter :: DIALECT_CALCULIX = 2
  integer, parameter :: MAX_PARTITIONS = 9999    !< of the results: four digits in the names of their files

  !> Job options from the command line or a calling program.
  type :: job_options_type
    character(:), allocatable :: deck           !< path of the deck
    character(:), allocatable :: job            !< name of the job: the deck's name without folder and .inp
    character(:), allocatable :: outdir         !< folder of the result files
    integer :: dialect = DIALECT_FROM_DECK
    integer :: n_threads = 1                    !< 0: as many as OpenMP has, one for a small model
    logical :: is_check = .false.               !< read, check the model, stop
    character(:), allocatable :: deck_text      !< the deck itself; then `deck` only names it in messages
    character(:), allocatable :: old_job        !< the job that *RESTART, READ continues
    character(:), allocatable :: global_results   !< results of the global model, for SUBMODEL cards that name no file
    character(:), allocatable :: user           !< file with user routines, Fortran or a shared library
    logical :: has_files = .true.               !< write result files
    logical :: has_frd = .false.                !< write all fields to job.frd, whatever the cards request
    integer :: n_partitions = 0                 !< of the results, a file each, up to MAX_PARTITIONS; 0: one file has all
    logical :: is_guarded = .false.             !< a checkpoint after each converged increment
    logical :: is_resumed = .false.             !< continue from the checkpoint
    logical :: handles_signals = .false.          !< SIGINT and SIGTERM stop the job, SIGUSR1 requests its status
  end type job_options_type

  !> The state of another job from which this one continues.
  type :: restart_origin_type
    character(:), allocatable :: path           !< its restart file; unallocated: the job starts from the undeformed state
    integer :: dialect = DIALECT_ABAQUS         !< of the old job
    type(state_key_type) :: label                   !< the state
    logical :: is_step_ended = .false.                 !< END STEP: its step ends there
  end type restart_origin_type

  !> The model.
  type :: model_type
    integer :: dialect = DIALECT_ABAQUS
    character(:), allocatable :: heading        !< text of *HEADING, lines joined by newline
    character(:), allocatable :: deck_text      !< all lines read, includes in place, joined by newline; until the job has started
    integer(I64) :: deck_checksum = 0           !< of this text, and of what submodels take from global models
    type(mesh_type) :: mesh
    type(structure_type), allocatable :: structure    !< shells, membranes and beams before expansion; unallocated: there are none
    type(material_type), allocatable :: materials(:)
    type(user_elements_type), allocatable :: user_elements   !< unallocated: there are none
    type(spring_type), allocatable :: springs(:)      !< spring laws beyond a constant; unallocated: none
    type(surface_type), allocatable :: surfaces(:)
    type(interaction_type), allocatable :: interactions(:)
    type(contact_pair_type), allocatable :: pairs(:)
    type(general_contact_type), allocatable :: general_contact   !< *CONTACT; converted to pairs before the start
    type(amplitude_type), allocatable :: amplitudes(:)
    type(equation_type), allocatable :: equations(:)
    real(DP), allocatable :: initial_temperature(:)   !< (n_nodes) of INITIAL CONDITIONS, then field variable 1 of all nodes, ...;
                                                      !! unallocated: 0 [temperature]
    real(DP), allocatable :: initial_history(:, :)    !< (HISTORY_..., n_points) of INITIAL CONDITIONS; unallocated: 0
    real(DP), allocatable :: initial_stress(:, :)     !< (6, n_points) of INITIAL CONDITIONS; unallocated: 0 [stress]
    type(orientation_type), allocatable :: orientations(:)
    integer, allocatable :: element_orientation(:)    !< (n_elements) index into orientations, 0: global; unallocated: 0
    type(nonlinear_mpc_type), allocatable :: nonlinear_mpcs(:)    !< nonlinear multi-point constraints
    type(equation_list_type) :: read_equations         !< of the cards being read; `gather_constraints` moves them to `equations`
    type(nonlinear_mpc_list_type) :: read_mpcs         !< the same for nonlinear_mpcs
    type(integer_list_type) :: read_turned             !< nodes that get a rotation node: n_nodes + 1, ... in this order
    type(tie_type), allocatable :: ties(:)      !< tie constraints; converted to equations before the start
    type(distributing_coupling_type), allocatable :: distributing_couplings(:)   !< distributing couplings; converted to equations
                                                                                 !! before the start
    integer, allocatable :: rotation_of(:)      !< (n_nodes) rotation node of a reference node, 0
    integer, allocatable :: pretension_node_pairs(:, :)         !< (2, n) pairs of nodes at pre-tension sections; unallocated: none
    integer, allocatable :: frame_of(:)         !< (n_nodes) index into frames of a transformed node, 0; else not allocated
    real(DP), allocatable :: frames(:, :, :)    !< (3, 3, n) directions of transformed nodes, columns
    type(embedding_type), allocatable :: embeddings(:)  !< EMBEDDED ELEMENT cards; unallocated: none
    type(submodel_type), allocatable :: submodels(:)  !< SUBMODEL cards; unallocated: none
    type(foundation_type), allocatable :: foundations(:)   !< FOUNDATION cards; unallocated: none
    type(step_type), allocatable :: steps(:)
    logical :: is_checked_only = .false.        !< NO ANALYSIS: the deck is read and checked, nothing is solved
    type(user_library_type) :: routines             !< of the user routines; opened before the start
    real(DP), allocatable :: initial_statev(:, :)   !< (STATEV, n_points) of INITIAL CONDITIONS, TYPE=SOLUTION; unallocated: 0
    logical :: has_sdvini = .false.             !< SDVINI gives the initial state variables
    type(restart_origin_type) :: origin                 !< of a job that continues from the restart file of another one
    logical :: keeps_checkpoint = .false.          !< RESTART, WRITE: the checkpoint is kept when the job is done
  end type model_type

contains

  !> The direction of a degree of freedom: a global axis, or an axis of the node's own frame.
  pure function dof_direction(model, node, dof) result(direction)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, dof
    real(DP) :: direction(3)
    direction = 0.0_DP
    direction(dof) = 1.0_DP
    if (.not. allocated(model%frame_of)) return
    if (model%frame_of(node) > 0) direction = model%frames(:, dof, model%frame_of(node))
  end function dof_direction


  !> The number of nonlinear MPCs; a model built by a program may have no list.
  pure integer function n_nonlinear_mpcs(model) result(n)
    type(model_type), intent(in) :: model
    n = 0
    if (allocated(model%nonlinear_mpcs)) n = size(model%nonlinear_mpcs)
  end function n_nonlinear_mpcs


  !> Whether the tangent of some element may be unsymmetric.
  pure logical function has_unsymmetric_elements(model) result(has)
    type(model_type), intent(in) :: model
    has = any(model%materials%is_unsymmetric)
    if (allocated(model%user_elements)) has = has .or. any(model%user_elements%kinds%is_unsymmetric)
  end function has_unsymmetric_elements


  !> Whether tractions of some material fall by damage.
  pure logical function has_damage(model)
    type(model_type), intent(in) :: model
    integer :: m
    has_damage = .false.
    do m = 1, size(model%materials)
      if (allocated(model%materials(m)%damage)) has_damage = has_damage .or. model%materials(m)%damage%has_evolution
    end do
  end function has_damage


  !> Whether some material has a criterion of damage.
  pure logical function has_damage_law(model)
    type(model_type), intent(in) :: model
    integer :: m
    has_damage_law = any([(allocated(model%materials(m)%damage), m=1, size(model%materials))])
  end function has_damage_law


  !> Nodes on which forces turn with their rotation nodes in some step, each once.
  pure function list_follower_nodes(model) result(nodes)
    type(model_type), intent(in) :: model
    integer, allocatable :: nodes(:)
    logical, allocatable :: is_follower(:)
    integer :: i
    allocate (is_follower(model%mesh%n_nodes), source=.false.)
    do i = 1, size(model%steps)
      if (.not. allocated(model%steps(i)%concentrated)) cycle
      associate (forces => model%steps(i)%concentrated)
        if (model%steps(i)%is_nlgeom) is_follower(pack(forces%node, forces%is_follower)) = .true.
      end associate
    end do
    nodes = pack([(i, i=1, model%mesh%n_nodes)], is_follower)
  end function list_follower_nodes


  !> Nodes whose displacement is the vector w of a finite rotation R(w): of rigid bodies, KINEMATIC couplings, shells and beams.
  pure function find_finite_rotations(model) result(is_rotation)
    type(model_type), intent(in) :: model
    logical, allocatable :: is_rotation(:)       !< (n_nodes)
    integer :: i
    allocate (is_rotation(model%mesh%n_nodes), source=.false.)
    do i = 1, n_nonlinear_mpcs(model)
      if (model%nonlinear_mpcs(i)%rotation > 0) is_rotation(model%nonlinear_mpcs(i)%rotation) = .true.
    end do
  end function find_finite_rotations


  !> Nodes and their duplicates: the nodes on both sides of a pre-tension section have the same position.
  pure function with_pretension_copies(model, nodes) result(all_nodes)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    integer, allocatable :: all_nodes(:)
    logical, allocatable :: is_member(:)
    integer :: i
    all_nodes = nodes
    if (.not. allocated(model%pretension_node_pairs)) return
    allocate (is_member(model%mesh%n_nodes), source=.false.)
    is_member(nodes) = .true.
    do i = 1, size(model%pretension_node_pairs, 2)                 ! a duplicate may have a duplicate, which comes later
      if (.not. is_member(model%pretension_node_pairs(1, i)) .or. is_member(model%pretension_node_pairs(2, i))) cycle
      is_member(model%pretension_node_pairs(2, i)) = .true.
      all_nodes = [all_nodes, model%pretension_node_pairs(2, i)]
    end do
  end function with_pretension_copies


  !> The path of a result file of the job: folder, name, extension.
  pure function job_path(options, extension) result(path)
    type(job_options_type), intent(in) :: options
    character(*), intent(in) :: extension       !< with its dot, e.g. '.sta'
    character(:), allocatable :: path
    path = options%job // extension
    if (.not. allocated(options%outdir)) return
    if (len(options%outdir) > 0) path = options%outdir // '/' // path
  end function job_path


  !> Whether an element is inactive in a step. Step 0, before the first step, counts as step 1.
  pure logical function is_out(model, step, e)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< index into model%steps, or 0
    integer, intent(in) :: e                       !< element index
    is_out = .false.
    if (.not. allocated(model%steps)) return
    if (size(model%steps) < max(1, step)) return
    if (allocated(model%steps(max(1, step))%is_inactive)) is_out = model%steps(max(1, step))%is_inactive(e)
  end function is_out


  !> The same of all elements.
  pure function absent_elements(model, step) result(is_absent)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< index into model%steps, or 0
    logical :: is_absent(model%mesh%n_elements)
    integer :: e
    is_absent = [(is_out(model, step, e), e=1, model%mesh%n_elements)]
  end function absent_elements


  !> The displacements that no support prescribes in a step.
  pure function free_unknowns(model, step) result(is_free)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step
    logical :: is_free(3, model%mesh%n_nodes)
    integer :: i
    is_free = .true.
    if (step > size(model%steps)) return
    do i = 1, size(model%steps(step)%prescribed)
      is_free(model%steps(step)%prescribed(i)%dof, model%steps(step)%prescribed(i)%node) = .false.
    end do
  end function free_unknowns


  !> The material of an element in a step; 0: the element has no material.
  pure integer function material_in_step(model, step, e) result(material)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< index into model%steps, or 0
    integer, intent(in) :: e                       !< element index
    material = model%mesh%material(e)
    if (.not. allocated(model%steps)) return
    if (size(model%steps) < max(1, step)) return
    if (allocated(model%steps(max(1, step))%material)) material = model%steps(max(1, step))%material(e)
  end function material_in_step


  !> The magnitude of a load of a step at a time.
  pure real(DP) function load_now(model, step, load, step_time, total_time) result(magnitude)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    class(load_type), intent(in) :: load
    real(DP), intent(in) :: step_time, total_time  !< [time]
    if (allocated(step%amplitudes)) then
      magnitude = load_value(load, step%amplitudes, step_time, total_time, step%period)
    else
      magnitude = load_value(load, model%amplitudes, step_time, total_time, step%period)
    end if
  end function load_now


  !> The displacement by a prescribed velocity since the start of a step.
  pure real(DP) function displacement_now(model, step, load, step_time, total_time) result(displacement)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    class(load_type), intent(in) :: load
    real(DP), intent(in) :: step_time, total_time  !< [time]
    if (allocated(step%amplitudes)) then
      displacement = integrated_velocity(load, step%amplitudes, step_time, total_time)
    else
      displacement = integrated_velocity(load, model%amplitudes, step_time, total_time)
    end if
  end function displacement_now


  !> An equation, sum of coefficients times displacements = 0, without the terms negligible beside the largest.
  pure function new_equation(node, dof, coefficient, card, line) result(equation)
    integer, intent(in) :: node(:), dof(:)         !< (terms) node, 1 to 3
    real(DP), intent(in) :: coefficient(:)         !< (terms) [-]
    character(*), intent(in) :: card               !< its name, for messages
    integer, intent(in) :: line                    !< of the deck
    type(equation_type) :: equation
    logical :: is_kept(size(node))
    is_kept = abs(coefficient) > TOL_ZERO_COEFFICIENT * maxval(abs(coefficient))
    equation%node = pack(node, is_kept)
    equation%dof = pack(dof, is_kept)
    equation%coefficient = pack(coefficient, is_kept)
    equation%card = card
    equation%line = line
  end function new_equation


  !> Appends such an equation to those read. Cost: constant in the mean.
  subroutine append_equation(model, node, dof, coefficient, card, line, n_eliminable)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: node(:), dof(:)         !< (terms) node, 1 to 3
    real(DP), intent(in) :: coefficient(:)         !< (terms) [-]
    character(*), intent(in) :: card               !< its name, for messages
    integer, intent(in) :: line                    !< of the deck
    integer, intent(in), optional :: n_eliminable  !< first terms that may be eliminated; 1 without it
    call model%read_equations%add(new_equation(node, dof, coefficient, card, line))
    if (present(n_eliminable)) model%read_equations%items(model%read_equations%n)%n_eliminable = n_eliminable
  end subroutine append_equation


  !> Appends a nonlinear multi-point constraint to those read. Cost: constant in the mean.
  subroutine append_mpc(model, mpc)
    type(model_type), intent(inout) :: model
    type(nonlinear_mpc_type), intent(in) :: mpc
    call model%read_mpcs%add(mpc)
  end subroutine append_mpc


  !> Moves the equations and constraints read to those of the model, in their order, and creates the rotation nodes they name.
  !! Cost: linear.
  subroutine gather_constraints(model)
    type(model_type), intent(inout) :: model
    integer :: n
    call model%read_equations%move_to(model%equations)
    call model%read_mpcs%move_to(model%nonlinear_mpcs)
    n = model%read_turned%n
    if (n == 0) return
    call append_nodes(model%mesh, model%mesh%coordinates(:, model%read_turned%items(:n)))
    model%mesh%is_auxiliary(model%mesh%n_nodes - n + 1:) = .true.
    model%rotation_of = [model%rotation_of, spread(0, 1, n)]
    model%read_turned%n = 0
  end subroutine gather_constraints

end module amontons_model
