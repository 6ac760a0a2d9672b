!> State of the analysis: committed and trial fields, contact state of slave nodes, commit and restore.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_state
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, element_nodes, wall_ratios
  use amontons_material_axes, only: evaluate_orientation
  use amontons_material_point, only: elastic_strain_from_stress
  use amontons_materials, only: material_type, orientation_type, ELASTIC_ISOTROPIC, HISTORY_BACK, HISTORY_CEEQ, HISTORY_INELASTIC, &
    HISTORY_PEEQ, HISTORY_STRETCH, USER_STATE, USER_STRESS
  use amontons_logarithmic_strain, only: tensor_exp
  use amontons_model, only: model_type, load_now, material_in_step, DIALECT_CALCULIX
  use amontons_slave_node_overrides, only: node_overrides_type
  use amontons_shape_functions, only: shape_functions, quadrature, facet_shapes
  use amontons_friction_slip_scenarios, only: STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_steps, only: step_type
  use amontons_structural_data, only: interpolate_added_nodes
  use amontons_user_elements, only: n_user_memory
  use amontons_tensor, only: IDENTITY, cross_product, pack_voigt, unpack_voigt
  use amontons_element_kinds, only: KIND_CSS8, KIND_CSS6, KIND_CAX_SHELL, is_membrane, is_one_point, has_modes, &
    MAX_ELEMENT_NODES, MAX_ELEMENT_AMPLITUDES, &
    MAX_ELEMENT_POINTS, MAX_FACE_NODES, FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8
  implicit none
  private
  public :: set_temperatures, history_variable, n_amplitude_memory, equivalent_plastic_strain, state_variables, n_state_variables
  public :: state_type, fields_type, slave_state_type, create_state, create_material_state, commit_state, restore_state, load_time
  public :: take_points, commit_fields, rotate_stress_to_frame
  public :: STATUS_OPEN, STATUS_STICK, STATUS_SLIP, DAMPING_NOW, DAMPING_NEXT

  integer, parameter :: N_CALCULIX_PLASTIC = 13                      !< values of the plasticity state in CalculiX
  integer, parameter :: DAMPING_NOW = 1, DAMPING_NEXT = 2   !< in force; from the next increment on

  !> The contact state of one slave node of one pair.
  type :: slave_state_type
    integer :: pair = 0                     !< index into model%pairs
    integer :: node = 0                     !< node index
    integer :: memory = 0                   !< offset of its STATEV of FRIC or UINTER in user_memory
    integer :: row = 0                      !< index of its row in the mortar of its pair; 0: the row follows from facet and xi
    integer :: slave_facet = 0                     !< of an integration point on a slave face: facet of the slave surface; 0: a node
    real(DP) :: at(2) = 0                   !< of an integration point: natural coordinates on that facet [-]
    type(node_overrides_type) :: overrides  !< overrides imposed by the solver
    integer :: status = STATUS_OPEN         !< STATUS_OPEN, STATUS_STICK or STATUS_SLIP
    logical :: is_bilateral = .false.       !< it was closed at the start of the increment under NO SEPARATION: it bears tension
    integer :: scenario = 0                 !< 1 to 4 of the last iteration that moved the node in this increment, else 0
    integer :: facet = 0                    !< master facet of its projection; 0: none
    real(DP) :: xi(2) = 0                   !< natural coordinates there
    real(DP) :: gap = 0                     !< signed distance along the normal, negative is penetration [length]
    real(DP) :: normal(3) = 0               !< unit normal out of the master
    logical :: is_in_law_range = .false.  !< it entered the activation range of its compliant law in this increment and is in it
    integer :: origin_facet = 0             !< facet of first touch, at the start of the increment or in it; 0: none
    real(DP) :: origin_xi(2) = 0            !< natural coordinates there
    real(DP) :: origin_offset(3) = 0  !< x_s minus the origin at first touch; nonzero only where the weights are fixed [length]
    real(DP) :: force(3) = 0                !< contact force on the slave node, normal part [force]
    real(DP) :: shear(3) = 0                !< contact force on the slave node, tangential part [force]
    real(DP) :: slip(3) = 0                 !< accumulated slip vector up to the committed state, plus this increment's [length]
    real(DP) :: elastic(3) = 0              !< elastic part of the slip; compliant laws only, not in slip [length]
    logical :: is_initialized = .false.         !< the initial position was evaluated at the start of the job
    real(DP) :: clearance = 0               !< permanently added to the distance to give the gap [length]
    real(DP) :: allowed = 0                 !< overclosure allowed at the start of the step, ramped down over it [length]
    real(DP) :: offset = 0                  !< sum of both at present [length]
    real(DP) :: energy = 0                  !< stored energy of a compliant law [energy]
    real(DP) :: slip_increment(3) = 0       !< of this increment [length]
    real(DP) :: area = 0                    !< tributary area [length^2]
    real(DP) :: force_arm(3) = 0  !< from the node to the point of action of its force, if neighbouring nodes take part [length]
    real(DP) :: stiffness = 0               !< scale c of the trial traction [force/length]
  end type slave_state_type

  !> The fields that an increment changes. Forces are those of the configuration u.
  type :: fields_type
    integer :: step = 0                     !< number, from 1, for user routines
    integer :: increment = 0                !< likewise
    real(DP) :: time_increment = 0          !< [time]
    real(DP), allocatable :: user_memory(:) !< of each amplitude by UAMP its value and its variables, then STATEV of slave nodes,
                                            !! then SVARS and ENERGY of user elements
    real(DP) :: step_time = 0               !< [time]
    real(DP) :: total_time = 0              !< [time]
    real(DP), allocatable :: u(:, :)        !< (3, n_nodes) displacement [length]
    real(DP), allocatable :: v(:, :)        !< (3, n_nodes) mean velocity of the last increment [length/time]
    real(DP), allocatable :: stress(:, :)   !< (6, n_points) Cauchy stress xx yy zz xy yz xz [stress]
    real(DP), allocatable :: strain(:, :)   !< (6, n_points) small, logarithmic (abaqus) or Green's (calculix) strain, tensor
                                            !< components, same order [-]
    real(DP), allocatable :: energy(:)      !< (n_points) strain energy per reference volume [energy/volume]
    real(DP), allocatable :: dissipated(:)  !< (n_points) work on plastic and creep strains; (0): none [energy/volume]
    real(DP), allocatable :: volume(:)      !< (n_points) reference volume [length^3]
    real(DP), allocatable :: history(:, :)  !< (n_history, n_points) HISTORY_... of materials; n_history 0 without history
    real(DP), allocatable :: modes(:, :)    !< (MAX_ELEMENT_AMPLITUDES, n_elements) of laws with history: amplitudes of the
                                            !< incompatible modes without the mean deformation, or those of hourglass modes that
                                            !< have flowed [length] and the energy that this dissipated; (:, 0): none
    real(DP), allocatable :: temperature(:) !< (n_nodes) of the nodes, then field variable 1 of all nodes, ... [temperature]
    real(DP) :: creep_time = 0              !< time spent in creep steps [time]
    real(DP), allocatable :: frame(:, :, :) !< (3, 3, n_points) local axes in columns, fixed; not allocated: global
    real(DP), allocatable :: birth_displacement(:, :)  !< (3, nodes of all elements) displacement of an element's node at its
                                                       !! reactivation; not allocated: no step reactivates elements [length]
    type(slave_state_type), allocatable :: slaves(:)
    real(DP), allocatable :: internal_force(:, :)   !< (3, n_nodes) F_int [force]
    real(DP), allocatable :: applied_force(:, :)    !< (3, n_nodes) F_ext [force]
    real(DP), allocatable :: contact_force(:, :)    !< (3, n_nodes) F_c on slaves and masters [force]
    real(DP), allocatable :: reaction_force(:, :)   !< (3, n_nodes) F_int - F_ext - F_c at supports, else 0 [force]
    real(DP) :: strain_energy = 0           !< of all points, when the increment was accepted [energy]
    real(DP) :: external_work = 0           !< since the start [energy]
    real(DP) :: friction_work = 0           !< since the start [energy]
    real(DP) :: damping(2) = 0              !< factor of STABILIZE: DAMPING_NOW, DAMPING_NEXT [force time/length^4]
    real(DP) :: stabilization_work = 0             !< dissipated by STABILIZE since the start [energy]
    real(DP) :: kinetic_energy = 0          !< of a DYNAMIC step [energy]
    real(DP) :: integration_loss = 0        !< dissipated by backward Euler in DYNAMIC steps, since the start [energy]
    real(DP) :: plastic_work = 0            !< of stresses on plastic and creep strains, since the start [energy]
    real(DP) :: proximal_work = 0            !< of the residual forces in proximal steps and snaps, since the start [energy]
    real(DP) :: load_factor = 0             !< RIKS: load proportionality factor [-]
    real(DP) :: load_rate = 0               !< its change over the last increment, over the arc [1/time]
    real(DP) :: arc_scale = 0               !< RIKS: displacement by the loads at the start of the step, all nodes; 0: not known
                                            !! yet [length]
  end type fields_type

  !> Committed and trial fields.
  type :: state_type
    type(fields_type) :: old                !< last converged increment
    type(fields_type) :: new                !< trial
    logical :: has_trial_points = .true.    !< .false.: the trial fields have no stress, strain, energy and volume until an
                                            !! increment is accepted (take_points)
  end type state_type

contains

  !> Initializes the state at rest for a mesh with its contact slaves.
  subroutine create_state(state, mesh, slaves, has_trial_points)
    type(state_type), intent(out) :: state
    type(mesh_type), intent(in) :: mesh
    type(slave_state_type), intent(in) :: slaves(:)   !< all slave nodes of all pairs
    logical, intent(in), optional :: has_trial_points !< .true. by default
    integer :: n, m
    if (present(has_trial_points)) state%has_trial_points = has_trial_points
    n = mesh%n_nodes
    m = mesh%n_points
    associate (new => state%new)
      allocate (new%u(3, n), new%v(3, n), new%internal_force(3, n), new%applied_force(3, n), new%contact_force(3, n), &
        new%reaction_force(3, n), source=0.0_DP)
      allocate (new%stress(6, m), new%strain(6, m))
      call clear_points(new%stress)
      call clear_points(new%strain)
      allocate (new%energy(m), new%volume(m), source=0.0_DP)
      allocate (new%history(0, m), new%modes(MAX_ELEMENT_AMPLITUDES, 0), new%temperature(n), new%user_memory(0), &
        new%dissipated(0), source=0.0_DP)
      allocate (new%slaves, source=slaves)
    end associate
    call commit_fields(state)
  end subroutine create_state


  !> Allocates the history of the materials and sets initial temperatures and histories.
  subroutine create_material_state(state, model)
    type(state_type), intent(inout) :: state
    type(model_type), intent(in) :: model
    integer :: n_history, n_memory, i
    n_history = 0
    if (size(model%materials) > 0) n_history = maxval(model%materials%n_history)
    associate (new => state%new)
      if (allocated(model%initial_temperature)) new%temperature = model%initial_temperature
      deallocate (new%history, new%user_memory)
      n_memory = n_amplitude_memory(model)
      do i = 1, size(new%slaves)
        n_memory = n_memory + model%interactions(model%pairs(new%slaves(i)%pair)%interaction)%n_statev
      end do
      allocate (new%user_memory(n_memory + n_user_memory(model%user_elements)), source=0.0_DP)
      allocate (new%history(n_history, model%mesh%n_points), source=0.0_DP)
      if (n_history > 0 .and. any(has_modes(model%mesh%kind) .or. model%mesh%kind == KIND_CSS8 .or. &
        model%mesh%kind == KIND_CSS6 .or. is_one_point(model%mesh%kind))) then
        deallocate (new%modes)
        allocate (new%modes(MAX_ELEMENT_AMPLITUDES, model%mesh%n_elements), source=0.0_DP)
      end if
      if (n_history >= HISTORY_INELASTIC + 5) new%dissipated = [(0.0_DP, i=1, model%mesh%n_points)]
      if (allocated(model%initial_history)) then
        n_history = min(n_history, size(model%initial_history, 1))
        new%history(:n_history, :) = model%initial_history(:n_history, :)
      end if
      if (allocated(model%orientations)) then
        if (size(model%orientations) > 0) call find_material_frames(model, new%frame)
      end if
      if (allocated(model%initial_stress)) call apply_initial_stress(model, new)
      call store_initial_stretch(model, new)
      if (any([(allocated(model%steps(i)%is_reactivated), i=1, size(model%steps))])) &
        allocate (new%birth_displacement(3, size(model%mesh%nodes)), source=0.0_DP)
    end associate
    call commit_fields(state)
  end subroutine create_material_state


  !> The volume of the initial state apart, for the law that needs it: its flow changes the trace of the inelastic strain to the
  !! second order.
  subroutine store_initial_stretch(model, fields)
    type(model_type), intent(in) :: model
    type(fields_type), intent(inout) :: fields
    integer :: e, p
    do e = 1, model%mesh%n_elements
      if (model%mesh%material(e) == 0) cycle
      if (model%materials(model%mesh%material(e))%n_history /= HISTORY_STRETCH) cycle
      do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
        fields%history(HISTORY_STRETCH, p) = sum(fields%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 2, p)) / 3
      end do
    end do
  end subroutine store_initial_stretch


  !> The length of the stored data of amplitudes by UAMP.
  pure integer function n_amplitude_memory(model) result(n)
    type(model_type), intent(in) :: model
    n = 0
    if (allocated(model%amplitudes)) n = sum(merge(1 + model%amplitudes%n_svars, 0, model%amplitudes%is_user))
  end function n_amplitude_memory


  !> The local axes of the points from the orientations of their elements.
  subroutine find_material_frames(model, frame)
    type(model_type), intent(in) :: model
    real(DP), allocatable, intent(out) :: frame(:, :, :)
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), &
      normal(3)                                       ! of the first two natural directions: that of a shell
    type(orientation_type) :: orientation
    integer :: e, k, p, n_rule, n_nodes, nodes(MAX_ELEMENT_NODES)
    allocate (frame(3, 3, model%mesh%n_points), source=spread(IDENTITY, 3, model%mesh%n_points))
    do e = 1, model%mesh%n_elements
      k = model%element_orientation(e)
      if (k == 0) cycle
      if (model%dialect == DIALECT_CALCULIX .and. model%orientations(k)%is_projected .and. allocated(model%structure)) then
        if (model%structure%section(e) > 0) then
          frame(:, :, model%mesh%point_first(e):model%mesh%point_first(e + 1) - 1) = spread(find_shell_frame(model, e), 3, &
            model%mesh%point_first(e + 1) - model%mesh%point_first(e))
          cycle
        end if
      end if
      call element_nodes(model%mesh, e, n_nodes, nodes)
      call quadrature(model%mesh%kind(e), n_rule, xi, w, wall_ratios(model%mesh, e))
      do p = 1, model%mesh%point_first(e + 1) - model%mesh%point_first(e)
        call shape_functions(model%mesh%kind(e), xi(:, p), N, dN)
        associate (X => model%mesh%coordinates(:, nodes(:n_nodes)))
          normal = 0
          orientation = model%orientations(k)
          if (model%mesh%kind(e) == KIND_CAX_SHELL .and. orientation%is_projected) then   ! along the line, round the circle
            orientation%a = matmul(X, dN(1, :n_nodes))
            orientation%b = [0.0_DP, 0.0_DP, -1.0_DP]
            normal = unit_normal(orientation%a, orientation%b)
          else if (orientation%is_projected) then
            normal = unit_normal(matmul(X, dN(1, :n_nodes)), matmul(X, dN(2, :n_nodes)))
          end if
          frame(:, :, model%mesh%point_first(e) + p - 1) = evaluate_orientation(orientation, matmul(X, N(:n_nodes)), normal)
        end associate
      end do
    end do
  end subroutine find_material_frames


  !> The local axes of a shell of the calculix dialect: as in CalculiX those at the origin of its natural coordinates, the centre
  !! of a quadrilateral or the first node of a triangle, for all its points (found by experiment with CalculiX 2.20).
  pure function find_shell_frame(model, e) result(frame)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                       !< its solid
    real(DP) :: frame(3, 3)                        !< axes in columns
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer, parameter :: OF_NODES(3:8) = [FACET_TRI3, FACET_QUAD4, 0, FACET_TRI6, 0, FACET_QUAD8]
    integer :: m
    associate (nodes => model%structure%nodes(model%structure%first(e):model%structure%first(e + 1) - 1))
      m = size(nodes)
      call facet_shapes(OF_NODES(m), [0.0_DP, 0.0_DP], N, dN, ddN)
      associate (X => model%mesh%coordinates(:, nodes))
        frame = evaluate_orientation(model%orientations(model%element_orientation(e)), matmul(X, N(:m)), &
          unit_normal(matmul(X, dN(1, :m)), matmul(X, dN(2, :m))))
      end associate
    end associate
  end function find_shell_frame


  !> The unit vector across two others.
  pure function unit_normal(a, b) result(normal)
    real(DP), intent(in) :: a(3), b(3)
    real(DP) :: normal(3)
    normal = cross_product(a, b)
    normal = normal / norm2(normal)
  end function unit_normal


  !> Converts initial stresses to inelastic strains of opposite sign.
  subroutine apply_initial_stress(model, fields)
    type(model_type), intent(in) :: model
    type(fields_type), intent(inout) :: fields
    real(DP) :: frame(3, 3), temperature
    integer :: e, p, n, nodes(MAX_ELEMENT_NODES)
    frame = IDENTITY
    do e = 1, model%mesh%n_elements
      if (model%mesh%material(e) == 0) cycle
      call element_nodes(model%mesh, e, n, nodes)
      temperature = sum(fields%temperature(model%materials(model%mesh%material(e))%table_variable * model%mesh%n_nodes &
        + nodes(:n))) / real(n, DP)
      do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
        if (allocated(fields%frame)) frame = fields%frame(:, :, p)
        if (is_membrane(model%mesh%kind(e))) frame = IDENTITY   ! the components are those along its axes
        if (model%materials(model%mesh%material(e))%is_user) then
          fields%history(USER_STRESS:USER_STRESS + 5, p) = rotate_stress_to_frame(model%initial_stress(:, p), frame)
          cycle
        end if
        associate (strain => fields%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5, p))
          strain = strain - elastic_strain_from_stress(model%materials(model%mesh%material(e)), temperature, frame, &
            model%initial_stress(:, p))
        end associate
      end do
    end do
  end subroutine apply_initial_stress


  !> The components 11 22 33 12 13 23 of a stress in local axes.
  pure function rotate_stress_to_frame(stress, frame) result(x)
    real(DP), intent(in) :: stress(6)              !< xx yy zz xy yz xz, global [stress]
    real(DP), intent(in) :: frame(3, 3)            !< local axes in columns
    real(DP) :: x(6)
    x = pack_voigt(matmul(transpose(frame), matmul(unpack_voigt(stress), frame)))
    x(5:6) = x([6, 5])
  end function rotate_stress_to_frame


  !> The temperatures at the time of the trial state, and the accumulated creep time.
  subroutine set_temperatures(model, step, state)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< in: times; out: new temperature, creep_time
    integer :: i
    associate (new => state%new)
      new%creep_time = state%old%creep_time
      if (step%has_creep) new%creep_time = new%creep_time + (new%total_time - state%old%total_time)
      if (.not. allocated(step%temperatures)) return
      do i = 1, size(step%temperatures)
        new%temperature(step%temperatures(i)%node) = load_now(model, step, step%temperatures(i), new%step_time, new%total_time)
      end do
      if (allocated(model%structure)) call interpolate_added_nodes(model%structure, model%mesh%n_nodes, new%temperature)
    end associate
  end subroutine set_temperatures


  !> One history variable at all points; zero for materials without it.
  pure function history_variable(fields, row) result(values)
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: row              !< HISTORY_...
    real(DP) :: values(size(fields%energy))
    values = 0
    if (row <= size(fields%history, 1)) values = fields%history(row, :)
  end function history_variable


  !> PEEQ: the equivalent plastic strain; in CalculiX including creep.
  pure function equivalent_plastic_strain(model, fields) result(strain)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP) :: strain(model%mesh%n_points)
    strain = history_variable(fields, HISTORY_PEEQ)
    if (model%dialect == DIALECT_CALCULIX) strain = strain + history_variable(fields, HISTORY_CEEQ)
  end function equivalent_plastic_strain


  !> The number of SDV values per point.
  pure integer function n_state_variables(model, fields) result(n)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    integer :: i
    n = 0
    if (size(fields%history, 1) >= USER_STATE) n = maxval(model%materials%n_statev)
    if (model%dialect /= DIALECT_CALCULIX) return
    if (any([(has_isotropic_plasticity(model%materials(i)), i=1, size(model%materials))])) n = max(n, N_CALCULIX_PLASTIC)
  end function n_state_variables


  !> Whether a material hardens by a built-in law. CalculiX stores other values for anisotropic materials.
  pure logical function has_isotropic_plasticity(material)
    type(material_type), intent(in) :: material
    has_isotropic_plasticity = (allocated(material%isotropic_hardening) .or. allocated(material%kinematic_hardening)) &
      .and. material%elastic_kind == ELASTIC_ISOTROPIC
  end function has_isotropic_plasticity


  !> SDV at all points: STATEV of a routine UMAT; under the calculix dialect also the plasticity state of CalculiX, in its order:
  !! the equivalent plastic strain, the plastic strain, the back stress, xx yy zz xy xz yz. Under NLGEOM the plastic strain is
  !! (1 - inv(Cp))/2, with Cp the right Cauchy-Green tensor of the plastic deformation.
  pure function state_variables(model, fields) result(values)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP) :: values(n_state_variables(model, fields), model%mesh%n_points)
    integer, parameter :: ABAQUS_ORDER(6) = [1, 2, 3, 4, 6, 5]
    real(DP) :: strain(6), back_stress(6)
    integer :: e, m, p, n_user
    values = 0
    n_user = 0
    if (size(fields%history, 1) >= USER_STATE) n_user = maxval(model%materials%n_statev)
    if (n_user > 0) values(:n_user, :) = fields%history(USER_STATE:USER_STATE + n_user - 1, :)
    if (size(values, 1) == n_user) return
    do e = 1, model%mesh%n_elements
      m = material_in_step(model, fields%step, e)
      if (m == 0) cycle
      if (.not. has_isotropic_plasticity(model%materials(m))) cycle
      do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
        strain = fields%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5, p)
        if (model%steps(max(1, fields%step))%is_nlgeom) strain = -0.5_DP * tensor_exp(strain, -2.0_DP)
        back_stress = 0
        if (size(fields%history, 1) >= HISTORY_BACK + 5) back_stress = fields%history(HISTORY_BACK:HISTORY_BACK + 5, p)
        values(:N_CALCULIX_PLASTIC, p) = [fields%history(HISTORY_PEEQ, p) + fields%history(HISTORY_CEEQ, p), &
          strain(ABAQUS_ORDER), back_stress(ABAQUS_ORDER)]
      end do
    end do
  end function state_variables


  !> Commits the trial fields.
  subroutine commit_state(state)
    type(state_type), intent(inout) :: state
    real(DP) :: dt
    dt = state%new%total_time - state%old%total_time
    if (dt > 0.0_DP) state%new%v = (state%new%u - state%old%u) / dt
    if (dt > 0.0_DP) state%new%load_rate = (state%new%load_factor - state%old%load_factor) / dt
    call commit_fields(state)
  end subroutine commit_state


  !> The committed fields become those of the trial state, with the only set of values at points if there is only one.
  subroutine commit_fields(state)
    type(state_type), intent(inout) :: state
    if (.not. (state%has_trial_points .or. allocated(state%new%stress))) call move_points(state%old, state%new)
    call copy_fields(state%has_trial_points, state%new, state%old)
    if (.not. state%has_trial_points) call move_points(state%new, state%old)
  end subroutine commit_fields


  !> The time within a step at which its loads are taken: the loads of a RIKS step are linear in the load factor [time].
  pure real(DP) function load_time(step, fields) result(time)
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    time = fields%step_time
    if (step%is_riks) time = fields%load_factor * step%period
  end function load_time


  !> Restores the trial fields from the last commit, bitwise.
  subroutine restore_state(state)
    type(state_type), intent(inout) :: state
    call copy_fields(state%has_trial_points, state%old, state%new)
  end subroutine restore_state


  !> Gives the values at points of the last commit to the trial fields, zero, to be evaluated there. The committed fields have none
  !! until the trial ones are committed.
  subroutine take_points(state)
    type(state_type), intent(inout) :: state
    call move_points(state%old, state%new)
    call clear_points(state%new%stress)
    call clear_points(state%new%strain)
    state%new%energy = 0.0_DP
    state%new%volume = 0.0_DP
  end subroutine take_points


  !> Sets values at points to zero. The threads that do so share the first use of the memory, which costs more than the zeros.
  subroutine clear_points(values)
    real(DP), intent(out) :: values(:, :)
    integer :: i
    !$omp parallel do schedule(static)
    do i = 1, size(values, 2)
      values(:, i) = 0.0_DP
    end do
    !$omp end parallel do
  end subroutine clear_points


  !> Copies fields; without values at points the copy has none. Its arrays keep their memory, because new memory for all of them in
  !! each attempt takes longer than the copy.
  subroutine copy_fields(has_points, from, to)
    logical, intent(in) :: has_points
    type(fields_type), intent(inout) :: from       !< not changed
    type(fields_type), intent(inout) :: to
    type(fields_type) :: source, copy
    call move_points(from, source)
    call move_other_arrays(from, source)
    call move_other_arrays(to, copy)
    if (has_points) then
      call move_points(to, copy)
      call copy_points(source, copy)
    end if
    call copy_other_arrays(source, copy)
    to = from                                      ! the rest
    call move_points(copy, to)
    call move_other_arrays(copy, to)
    call move_points(source, from)
    call move_other_arrays(source, from)
  end subroutine copy_fields


  !> Moves the values at points, without a copy.
  subroutine move_points(from, to)
    type(fields_type), intent(inout) :: from, to
    call move_alloc(from%stress, to%stress)
    call move_alloc(from%strain, to%strain)
    call move_alloc(from%energy, to%energy)
    call move_alloc(from%volume, to%volume)
  end subroutine move_points


  !> Copies the values at points.
  pure subroutine copy_points(from, to)
    type(fields_type), intent(in) :: from
    type(fields_type), intent(inout) :: to
    call copy_matrix(from%stress, to%stress)
    call copy_matrix(from%strain, to%strain)
    call copy_vector(from%energy, to%energy)
    call copy_vector(from%volume, to%volume)
  end subroutine copy_points


  !> Moves the arrays by points, elements and nodes that are not those of move_points.
  subroutine move_other_arrays(from, to)
    type(fields_type), intent(inout) :: from, to
    call move_alloc(from%u, to%u)
    call move_alloc(from%v, to%v)
    call move_alloc(from%dissipated, to%dissipated)
    call move_alloc(from%history, to%history)
    call move_alloc(from%modes, to%modes)
    call move_alloc(from%temperature, to%temperature)
    call move_alloc(from%internal_force, to%internal_force)
    call move_alloc(from%applied_force, to%applied_force)
    call move_alloc(from%contact_force, to%contact_force)
    call move_alloc(from%reaction_force, to%reaction_force)
  end subroutine move_other_arrays


  !> Copies them.
  pure subroutine copy_other_arrays(from, to)
    type(fields_type), intent(in) :: from
    type(fields_type), intent(inout) :: to
    call copy_matrix(from%u, to%u)
    call copy_matrix(from%v, to%v)
    call copy_vector(from%dissipated, to%dissipated)
    call copy_matrix(from%history, to%history)
    call copy_matrix(from%modes, to%modes)
    call copy_vector(from%temperature, to%temperature)
    call copy_matrix(from%internal_force, to%internal_force)
    call copy_matrix(from%applied_force, to%applied_force)
    call copy_matrix(from%contact_force, to%contact_force)
    call copy_matrix(from%reaction_force, to%reaction_force)
  end subroutine copy_other_arrays


  !> Copies an array, or that there is none.
  pure subroutine copy_matrix(from, to)
    real(DP), allocatable, intent(in) :: from(:, :)
    real(DP), allocatable, intent(inout) :: to(:, :)
    if (allocated(from)) then
      to = from
    else if (allocated(to)) then
      deallocate (to)
    end if
  end subroutine copy_matrix


  !> Likewise.
  pure subroutine copy_vector(from, to)
    real(DP), allocatable, intent(in) :: from(:)
    real(DP), allocatable, intent(inout) :: to(:)
    if (allocated(from)) then
      to = from
    else if (allocated(to)) then
      deallocate (to)
    end if
  end subroutine copy_vector

end module amontons_state
