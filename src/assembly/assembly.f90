!> Assembly of internal forces and tangent stiffness: the element loop.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Elements are scattered in the order of the plan. Forces are summed over the ranks, in their order, and so is the stiffness unless
!! it is divided. Values at integration points stay with their rank until `share_points`.
module amontons_assembly
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: has_modes, KIND_C3D15, KIND_CSS8, KIND_CSS6, KIND_SPRINGA, KIND_SPRING1, KIND_SPRING2, &
    KIND_GAPUNI, MAX_ELEMENT_NODES, is_cohesive
  use amontons_mesh, only: mesh_type, element_nodes, wall_ratios
  use amontons_materials, only: material_type, CREEP_USER, MAX_HISTORY
  use amontons_model, only: DIALECT_CALCULIX, model_type, is_out, material_in_step, has_unsymmetric_elements
  use amontons_state, only: fields_type, state_type
  use amontons_sparse, only: sparse_type
  use amontons_unsymmetric_tangent, only: reset_element_skew, evaluate_element_skew
  use amontons_mpi_ranks, only: sum_over_ranks, min_over_ranks
  use amontons_assembly_plan, only: assembly_type, ensure_matrix, is_own_element, add_row_block
  use amontons_solid_simd, only: batch_type, batch_rule_type, is_batch_kind, set_batch_lane, evaluate_batch_forces, &
    evaluate_batch_tangent, BATCH_WIDTH, MAX_NODE_PAIRS, BATCH_HISTORY
  use amontons_plastic_solid_simd, only: is_plastic_batch_kind, evaluate_plastic_batch_forces, evaluate_plastic_batch_tangent
  use amontons_truss_spring_mass, only: spring_energy
  use amontons_element, only: evaluate_element_forces, evaluate_element_tangent, integration_points_type, ELEMENT_OK
  use amontons_layer_stack, only: is_stacked_triangle, load_stack_bending
  use amontons_user_state, only: load_creep_points, load_umat_points, store_umat_points, load_user_fields, has_invalid_fields, &
    is_deleted_element
  use amontons_user_material, only: DELETED_STIFFNESS
  implicit none
  private
  public :: share_points, assemble_forces, assemble_tangent, assemble_nodal_stiffness, element_material, sum_spring_energies

  integer, parameter :: SPRING_KINDS(4) = [KIND_SPRINGA, KIND_SPRING1, KIND_SPRING2, KIND_GAPUNI]
  integer, parameter :: MIN_BATCH_ELEMENTS = 3                       !< for fewer elements a batch is not worth its empty lanes

contains

  !> Internal forces F_int and the stresses, strains and energies at u, if the fields have them.
  !! Stress and history are updated from the committed history, never from a trial one.
  subroutine assemble_forces(assembly, model, is_nlgeom, state, failed_element)
    type(assembly_type), intent(in) :: assembly
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(inout) :: state       !< in: old history, new u, times and temperature; out: new
    !< internal_force, stress, strain, energy, volume, history
    integer, intent(out) :: failed_element         !< 0, or the first element that is inverted or not finite
    type(batch_type), allocatable :: batch         ! of a thread
    integer :: g, i, failed
    failed = huge(failed)
    state%new%internal_force = 0.0_DP
    !$omp parallel private(g, i, batch) reduction(min: failed) if (is_threading_useful(assembly))
    !$omp do schedule(dynamic)
    do g = 1, assembly%n_parts
      do i = assembly%group_first(g), assembly%group_first(g + 1) - 1, BATCH_WIDTH
        call add_group_forces(assembly, model, list_batch_span(assembly, g, i), is_nlgeom, state, batch, failed)
      end do
    end do
    do g = assembly%n_parts + 1, assembly%n_groups
      !$omp do schedule(static)
      do i = assembly%group_first(g), assembly%group_first(g + 1) - 1, BATCH_WIDTH
        call add_group_forces(assembly, model, list_batch_span(assembly, g, i), is_nlgeom, state, batch, failed)
      end do
    end do
    !$omp end parallel
    failed_element = first_failed(failed)
    call sum_over_ranks(state%new%internal_force)
  end subroutine assemble_forces


  !> The first failed element of all ranks; 0: none.
  integer function first_failed(failed)
    integer, intent(in) :: failed                  !< of this rank; huge: none
    first_failed = nint(min_over_ranks(real(failed, DP)))
    if (first_failed == huge(failed)) first_failed = 0
  end function first_failed


  !> The values at the integration points of all ranks, complete on each.
  subroutine share_points(assembly, mesh, fields)
    type(assembly_type), intent(in) :: assembly
    type(mesh_type), intent(in) :: mesh
    type(fields_type), intent(inout) :: fields     !< forces were evaluated
    integer :: e
    if (.not. (allocated(assembly%rank_of) .and. allocated(fields%stress))) return
    do e = 1, mesh%n_elements
      if (is_own_element(assembly, e)) cycle
      call clear_points(mesh, e, fields)
      fields%history(:, mesh%point_first(e):mesh%point_first(e + 1) - 1) = 0.0_DP
      if (size(fields%modes, 2) > 0) fields%modes(:, e) = 0.0_DP
    end do
    call sum_over_ranks(fields%stress)
    call sum_over_ranks(fields%strain)
    call sum_over_ranks(fields%energy)
    call sum_over_ranks(fields%volume)
    call sum_over_ranks(fields%history)
    call sum_over_ranks(fields%modes)
  end subroutine share_points


  !> The elements of a group from a position on, up to the width of a batch.
  pure function list_batch_span(assembly, g, i) result(elements)
    type(assembly_type), intent(in) :: assembly
    integer, intent(in) :: g                       !< group
    integer, intent(in) :: i                       !< position in the order of the elements
    integer, allocatable :: elements(:)
    elements = assembly%element_order(i:min(i + BATCH_WIDTH, assembly%group_first(g + 1)) - 1)
  end function list_batch_span


  !> Marks the elements that one batch can hold, of the kind of the first of them, and with its material if that is plastic; the
  !! others are evaluated one by one.
  pure subroutine choose_batch_elements(model, i_step, elements, is_nlgeom, is_chosen, is_plastic)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i_step                  !< index into model%steps
    integer, intent(in) :: elements(:)             !< at most BATCH_WIDTH
    logical, intent(in) :: is_nlgeom
    logical, intent(out) :: is_chosen(:)              !< of the elements
    logical, intent(out) :: is_plastic             !< of the chosen ones: plastic_solid_simd evaluates them
    integer :: k, m, first, material_of_first
    logical :: is_plastic_k
    first = 0
    material_of_first = 0
    is_chosen = .false.
    is_plastic = .false.
    do k = 1, size(elements)
      associate (e => elements(k))
        if (is_out(model, i_step, e) .or. is_quadratic_solid_shell(model%mesh, e)) cycle
        m = element_material(model, i_step, e)
        is_plastic_k = is_plastic_batch_kind(model%mesh%kind(e), model%materials(m), is_nlgeom)
        if (.not. (is_plastic_k .or. is_batch_kind(model%mesh%kind(e), model%materials(m), is_nlgeom))) cycle
        if (first == 0) then
          first = e
          material_of_first = m
          is_plastic = is_plastic_k
        end if
        is_chosen(k) = model%mesh%kind(e) == model%mesh%kind(first) .and. (is_plastic_k .eqv. is_plastic) .and. &
          (m == material_of_first .or. .not. is_plastic)
      end associate
    end do
    if (count(is_chosen) < MIN_BATCH_ELEMENTS) is_chosen = .false.
  end subroutine choose_batch_elements


  !> Whether an element is the solid of S6 with assumed strains.
  pure logical function is_quadratic_solid_shell(mesh, e)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element
    is_quadratic_solid_shell = mesh%kind(e) == KIND_C3D15 .and. allocated(mesh%is_shell)
    if (is_quadratic_solid_shell) is_quadratic_solid_shell = mesh%is_shell(e)
  end function is_quadratic_solid_shell


  !> Puts the chosen elements into the lanes of a batch; unused lanes repeat the last element. The batch is on the heap, once for
  !! a thread: with it the stack of half a megabyte that threads of some systems have was full.
  pure subroutine load_batch(model, rule, list, state, is_plastic, batch)
    type(model_type), intent(in) :: model
    type(batch_rule_type), intent(in) :: rule      !< of their kind
    integer, intent(in) :: list(:)                 !< elements, at least one
    type(state_type), intent(in) :: state
    logical, intent(in) :: is_plastic              !< with the committed history
    type(batch_type), allocatable, intent(inout) :: batch
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES)
    integer :: lane, p
    if (.not. allocated(batch)) allocate (batch)
    do lane = 1, BATCH_WIDTH
      associate (e => list(min(lane, size(list))))
        call set_element_configuration(model%mesh, e, state%new, X, u)
        call set_batch_lane(batch, lane, model%materials(element_material(model, state%new%step, e)), X(:, :rule%n_nodes), &
          u(:, :rule%n_nodes))
        p = model%mesh%point_first(e)
        if (is_plastic) batch%history_old(lane, :, :rule%n_points) = state%old%history(:BATCH_HISTORY, p:p + rule%n_points - 1)
      end associate
    end do
  end subroutine load_batch


  !> Forces and point results of some elements: in a batch where possible, else one by one; all one by one if a batch fails.
  subroutine add_group_forces(assembly, model, elements, is_nlgeom, state, batch, failed)
    type(assembly_type), intent(in) :: assembly
    type(model_type), intent(in) :: model
    integer, intent(in) :: elements(:)             !< at most BATCH_WIDTH, all of one group
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(inout) :: state
    type(batch_type), allocatable, intent(inout) :: batch   !< of the thread
    integer, intent(inout) :: failed
    integer, allocatable :: list(:)
    logical :: is_chosen(size(elements)), is_plastic
    integer :: k, lane, a, p, last, first, kind
    call choose_batch_elements(model, state%new%step, elements, is_nlgeom, is_chosen, is_plastic)
    list = pack(elements, is_chosen)
    if (size(list) > 0) then
      kind = model%mesh%kind(list(1))
      call load_batch(model, assembly%rules(kind), list, state, is_plastic, batch)
      if (is_plastic) then
        k = element_material(model, state%new%step, list(1))
        call evaluate_plastic_batch_forces(batch, assembly%rules(kind), model%materials(k), allocated(state%new%stress))
      else
        call evaluate_batch_forces(batch, assembly%rules(kind), is_nlgeom)
      end if
      if (.not. batch%is_sound) is_chosen = .false.
    end if
    do k = 1, size(elements)
      if (.not. is_chosen(k)) call add_element_forces(model, elements(k), is_nlgeom, state, failed)
    end do
    if (.not. any(is_chosen)) return
    associate (mesh => model%mesh, fields => state%new)
      do lane = 1, size(list)
        first = mesh%first(list(lane)) - 1
        do a = 1, assembly%rules(kind)%n_nodes
          associate (node => mesh%nodes(first + a))
            fields%internal_force(:, node) = fields%internal_force(:, node) + batch%force(lane, :, a)
          end associate
        end do
        if (.not. allocated(fields%stress)) cycle
        p = mesh%point_first(list(lane))
        associate (n_points => assembly%rules(kind)%n_points)
          last = p + n_points - 1
          fields%stress(:, p:last) = batch%stress(lane, :, :n_points)
          fields%strain(:, p:last) = batch%strain(lane, :, :n_points)
          fields%energy(p:last) = batch%energy(lane, :n_points)
          fields%volume(p:last) = batch%volume(lane, :n_points)
          if (is_plastic) fields%history(:BATCH_HISTORY, p:last) = batch%history(lane, :, :n_points)
        end associate
      end do
    end associate
  end subroutine add_group_forces


  !> Adds the stiffness of some elements to the matrix, in a batch where possible.
  subroutine add_group_tangent(assembly, model, elements, is_nlgeom, state, batch, failed)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    integer, intent(in) :: elements(:)             !< at most BATCH_WIDTH, all of one group
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(in) :: state
    type(batch_type), allocatable, intent(inout) :: batch   !< of the thread
    integer, intent(inout) :: failed
    integer, allocatable :: list(:)
    logical :: is_chosen(size(elements)), is_plastic
    integer :: k, lane, kind
    call choose_batch_elements(model, state%new%step, elements, is_nlgeom, is_chosen, is_plastic)
    list = pack(elements, is_chosen)
    if (size(list) > 0) then
      kind = model%mesh%kind(list(1))
      call load_batch(model, assembly%rules(kind), list, state, is_plastic, batch)
      if (is_plastic) then
        k = element_material(model, state%new%step, list(1))
        call evaluate_plastic_batch_tangent(batch, assembly%rules(kind), model%materials(k))
      else
        call evaluate_batch_tangent(batch, assembly%rules(kind), is_nlgeom)
      end if
      if (.not. batch%is_sound) is_chosen = .false.
    end if
    do k = 1, size(elements)
      if (.not. is_chosen(k)) call add_element_tangent(assembly, model, elements(k), is_nlgeom, state, failed)
    end do
    if (.not. any(is_chosen)) return
    do lane = 1, size(list)
      call scatter_lane(assembly, model%mesh, list(lane), assembly%rules(kind)%n_nodes, batch%stiffness, lane)
    end do
  end subroutine add_group_tangent


  !> Adds the blocks of one lane to the matrix.
  pure subroutine scatter_lane(assembly, mesh, e, n_nodes, stiffness, lane)
    type(assembly_type), intent(inout) :: assembly
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, n_nodes
    real(DP), intent(in) :: stiffness(BATCH_WIDTH, 3, 3, MAX_NODE_PAIRS)
    integer, intent(in) :: lane
    integer :: nodes(MAX_ELEMENT_NODES), a, b, k, pair
    nodes(:n_nodes) = mesh%nodes(mesh%first(e):mesh%first(e) + n_nodes - 1)
    pair = 0
    k = assembly%pair_first(e)
    do b = 1, n_nodes
      do a = 1, b
        pair = pair + 1
        if (nodes(a) <= nodes(b)) then
          call add_row_block(assembly%stiffness, nodes(a), assembly%pair_offset(k), stiffness(lane, :, :, pair))
        else
          call add_row_block(assembly%stiffness, nodes(b), assembly%pair_offset(k), transpose(stiffness(lane, :, :, pair)))
        end if
        k = k + 1
      end do
    end do
  end subroutine scatter_lane


  !> For few elements the start of threads costs more than it saves.
  pure logical function is_threading_useful(assembly)
    type(assembly_type), intent(in) :: assembly
    is_threading_useful = size(assembly%element_order) > 64
  end function is_threading_useful


  !> Forces and point results of one element to the fields.
  subroutine add_element_forces(model, e, is_nlgeom, state, failed)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(inout) :: state
    integer, intent(inout) :: failed
    type(integration_points_type) :: points
    real(DP) :: force(3, MAX_ELEMENT_NODES), X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES)
    integer :: n, m, status, a, nodes(MAX_ELEMENT_NODES)
    call element_nodes(model%mesh, e, n, nodes)
    if (is_out(model, state%new%step, e)) then
      call clear_points(model%mesh, e, state%new)
      return
    end if
    if (is_deleted_element(model, state%old, e)) then
      call clear_points(model%mesh, e, state%new)
      associate (first => model%mesh%point_first(e), last => model%mesh%point_first(e + 1) - 1)
        state%new%history(:, first:last) = state%old%history(:, first:last)
      end associate
      return
    end if
    m = element_material(model, state%new%step, e)      ! gfortran 14 takes no function of this module within associate
    associate (material => model%materials(m), fields => state%new)
      call load_points(model, state, e, points)
      points%is_output_wanted = allocated(fields%stress)
      if (is_stacked_triangle(model, e)) call load_stack_bending(model, state, e, is_nlgeom, points)
      if (material%is_user) call load_umat_points(model, state, e, is_nlgeom, points)
      if (material%creep_law == CREEP_USER) call load_creep_points(model, state, e, is_nlgeom, points%creep)
      call set_element_configuration(model%mesh, e, fields, X, u)
      call evaluate_element_forces(model%mesh%kind(e), material, X(:, :n), u(:, :n), is_nlgeom, force, points, status)
      if (status /= ELEMENT_OK .or. has_invalid_fields(model, fields, e)) then
        failed = min(failed, e)
        return
      end if
      call store_points(model%mesh, e, merge(0, min(MAX_HISTORY, material%n_history), material%is_user), points, fields)
      if (allocated(points%inner) .and. points%is_output_wanted) fields%history(material%inner_first:material%inner_first + &
        material%n_inner - 1, model%mesh%point_first(e):model%mesh%point_first(e + 1) - 1) = points%inner
      if (material%n_history > 0 .and. size(fields%modes, 2) > 0) fields%modes(:, e) = points%modes
      if (material%is_user) call store_umat_points(model, e, points, fields)
      do a = 1, n
        fields%internal_force(:, nodes(a)) = fields%internal_force(:, nodes(a)) + force(:, a)
      end do
    end associate
  end subroutine add_element_forces


  !> The energy of all springs and gaps at the new displacements [energy].
  real(DP) function sum_spring_energies(model, is_nlgeom, state) result(energy)
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(in) :: state
    type(integration_points_type) :: points
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES)
    integer :: e, n
    energy = 0
    do e = 1, model%mesh%n_elements
      if (all(SPRING_KINDS /= model%mesh%kind(e))) cycle
      if (is_out(model, state%new%step, e)) cycle
      n = model%mesh%first(e + 1) - model%mesh%first(e)
      call load_points(model, state, e, points)
      call set_element_configuration(model%mesh, e, state%new, X, u)
      energy = energy + spring_energy(model%mesh%kind(e), X(:, :n), u(:, :n), is_nlgeom, points)
    end do
  end function sum_spring_energies


  !> Sets the stress of an inactive element to zero.
  pure subroutine clear_points(mesh, e, fields)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    type(fields_type), intent(inout) :: fields
    if (.not. allocated(fields%stress)) return
    associate (first => mesh%point_first(e), last => mesh%point_first(e + 1) - 1)
      fields%stress(:, first:last) = 0
      fields%strain(:, first:last) = 0
      fields%energy(first:last) = 0
      fields%volume(first:last) = 0
    end associate
  end subroutine clear_points


  !> Reference coordinates and displacements of an element: from the mesh, or since its reactivation.
  pure subroutine set_element_configuration(mesh, e, fields, X, u)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    type(fields_type), intent(in) :: fields
    real(DP), intent(out) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES)   !< [length]
    integer :: n, nodes(MAX_ELEMENT_NODES)
    call element_nodes(mesh, e, n, nodes)
    X(:, :n) = mesh%coordinates(:, nodes(:n))
    u(:, :n) = fields%u(:, nodes(:n))
    if (.not. allocated(fields%birth_displacement)) return
    associate (birth => fields%birth_displacement(:, mesh%first(e):mesh%first(e + 1) - 1))
      X(:, :n) = X(:, :n) + birth
      u(:, :n) = u(:, :n) - birth
    end associate
  end subroutine set_element_configuration


  !> The material of an element. Springs and masses have none and ignore it: the first one is returned.
  pure integer function element_material(model, i_step, e)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i_step                  !< index into model%steps, or 0
    integer, intent(in) :: e
    element_material = max(1, material_in_step(model, i_step, e))
  end function element_material


  !> Input data of an element: its section; unless its material is plain elastic, committed history, temperatures, time.
  pure subroutine load_points(model, state, e, points)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    integer, intent(in) :: e
    type(integration_points_type), intent(inout) :: points
    integer :: n, m, p, k, nodes(MAX_ELEMENT_NODES)
    points%section_value = model%mesh%section_value(e)
    if (allocated(model%mesh%is_shell)) points%is_shell = model%mesh%is_shell(e)
    points%walls = wall_ratios(model%mesh, e)
    points%directions = model%mesh%directions(:, e)
    if (allocated(model%mesh%cohesive)) points%cohesive = model%mesh%cohesive(:, e)
    if (allocated(model%mesh%spring)) call load_spring(model, state, e, points)
    if (model%materials(element_material(model, state%new%step, e))%is_linear_isotropic) return
    call element_nodes(model%mesh, e, n, nodes)
    p = model%mesh%point_first(e)
    m = model%mesh%point_first(e + 1) - p
    k = min(MAX_HISTORY, model%materials(element_material(model, state%new%step, e))%n_history)
    points%history_old = 0.0_DP
    points%history_old(:k, :m) = state%old%history(:k, p:p + m - 1)
    if (k > 0 .and. size(state%old%modes, 2) > 0) points%modes_old = state%old%modes(:, e)
    call load_inner_history(model%materials(element_material(model, state%new%step, e)), state, p, m, points)
    points%temperature(:n) = state%new%temperature(nodes(:n))
    points%initial_temperature(:n) = 0.0_DP
    if (allocated(model%initial_temperature)) points%initial_temperature(:n) = model%initial_temperature(nodes(:n))
    k = model%materials(element_material(model, state%new%step, e))%table_variable * model%mesh%n_nodes
    if (k > 0) then
      points%field(:n) = state%new%temperature(k + nodes(:n))
      points%initial_field(:n) = 0.0_DP
      if (allocated(model%initial_temperature)) points%initial_field(:n) = model%initial_temperature(k + nodes(:n))
    end if
    call load_user_fields(model, state, e, points)
    points%time = state%new%total_time
    points%time_increment = state%new%creep_time - state%old%creep_time
    points%is_rate_at_end = model%dialect == DIALECT_CALCULIX .and. model%steps(max(1, state%new%step))%is_direct
    if (allocated(model%materials(element_material(model, state%new%step, e))%prony) .and. model%steps(max(1, &
      state%new%step))%is_long_term) points%time_increment = huge(points%time_increment)
    points%has_frame = allocated(state%new%frame)
    if (points%has_frame) points%frame(:, :, :m) = state%new%frame(:, :, p:p + m - 1)
  end subroutine load_points


  !> The history of a law that has more of it, and the times that it counts.
  pure subroutine load_inner_history(material, state, first, m, points)
    type(material_type), intent(in) :: material
    type(state_type), intent(in) :: state
    integer, intent(in) :: first, m                !< first point and number of points of the element
    type(integration_points_type), intent(inout) :: points
    if (allocated(points%inner_old)) deallocate (points%inner_old, points%inner)
    points%elapsed_time = state%new%total_time - state%old%total_time
    if (material%n_inner == 0) return
    allocate (points%inner_old(material%n_inner, m), source=state%old%history(material%inner_first:material%inner_first + &
      material%n_inner - 1, first:first + m - 1))
    points%inner = points%inner_old
  end subroutine load_inner_history


  !> The law of a spring, and the temperatures of its nodes.
  pure subroutine load_spring(model, state, e, points)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    integer, intent(in) :: e
    type(integration_points_type), intent(inout) :: points
    integer :: n, nodes(MAX_ELEMENT_NODES)
    if (allocated(points%spring)) deallocate (points%spring)
    if (model%mesh%spring(e) == 0) return
    points%spring = model%springs(model%mesh%spring(e))
    call element_nodes(model%mesh, e, n, nodes)
    points%temperature(:n) = state%new%temperature(nodes(:n))
  end subroutine load_spring


  !> Copies the point values of an element to the fields.
  pure subroutine store_points(mesh, e, n_history, points, fields)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    integer, intent(in) :: n_history               !< of its material
    type(integration_points_type), intent(in) :: points
    type(fields_type), intent(inout) :: fields
    integer :: m, p
    p = mesh%point_first(e)
    m = mesh%point_first(e + 1) - p
    if (allocated(fields%stress)) then
      fields%stress(:, p:p + m - 1) = points%stress(:, :m)
      fields%strain(:, p:p + m - 1) = points%strain(:, :m)
      fields%energy(p:p + m - 1) = points%energy(:m)
      fields%volume(p:p + m - 1) = points%volume(:m)
    end if
    if (n_history > 0 .and. points%is_output_wanted) fields%history(:n_history, p:p + m - 1) = points%history(:n_history, :m)
  end subroutine store_points


  !> The stiffness K = d F_int / d u of the elements.
  subroutine assemble_tangent(assembly, model, is_nlgeom, state, failed_element)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(in) :: state          !< old history; new u, times, temperature
    integer, intent(out) :: failed_element         !< 0, or the first element that is inverted or not finite
    type(batch_type), allocatable :: batch         ! of a thread
    integer :: g, i, failed
    failed = huge(failed)
    call ensure_matrix(assembly, model%mesh)
    !$omp parallel do schedule(static) if (is_threading_useful(assembly))
    do i = 1, size(assembly%stiffness%value)
      assembly%stiffness%value(i) = 0.0_DP
    end do
    !$omp end parallel do
    call reset_element_skew(assembly%skew, assembly%stiffness, has_unsymmetric_elements(model))
    !$omp parallel private(g, i, batch) reduction(min: failed) if (is_threading_useful(assembly))
    !$omp do schedule(dynamic)
    do g = 1, assembly%n_parts
      do i = assembly%group_first(g), assembly%group_first(g + 1) - 1, BATCH_WIDTH
        call add_group_tangent(assembly, model, list_batch_span(assembly, g, i), is_nlgeom, state, batch, failed)
      end do
    end do
    do g = assembly%n_parts + 1, assembly%n_groups
      !$omp do schedule(static)
      do i = assembly%group_first(g), assembly%group_first(g + 1) - 1, BATCH_WIDTH
        call add_group_tangent(assembly, model, list_batch_span(assembly, g, i), is_nlgeom, state, batch, failed)
      end do
    end do
    !$omp end parallel
    failed_element = first_failed(failed)
    if (.not. assembly%is_divided) call sum_over_ranks(assembly%stiffness%value)
    if (allocated(assembly%skew%elements%value)) call sum_over_ranks(assembly%skew%elements%value)
  end subroutine assemble_tangent


  !> The diagonal blocks of K alone, one for each node, without the matrix.
  subroutine assemble_nodal_stiffness(assembly, model, is_nlgeom, state, blocks, failed_element)
    type(assembly_type), intent(in) :: assembly
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(in) :: state          !< as of assemble_tangent
    real(DP), intent(out) :: blocks(:, :, :)       !< (3, 3, n_nodes) [force/length]
    integer, intent(out) :: failed_element         !< 0, or the first element that is inverted or not finite
    integer :: g, i, failed
    failed = huge(failed)
    blocks = 0.0_DP
    !$omp parallel private(g, i) reduction(min: failed) if (is_threading_useful(assembly))
    !$omp do schedule(dynamic)
    do g = 1, assembly%n_parts
      do i = assembly%group_first(g), assembly%group_first(g + 1) - 1
        call add_nodal_blocks(model, assembly%element_order(i), is_nlgeom, state, blocks, failed)
      end do
    end do
    do g = assembly%n_parts + 1, assembly%n_groups
      !$omp do schedule(static)
      do i = assembly%group_first(g), assembly%group_first(g + 1) - 1
        call add_nodal_blocks(model, assembly%element_order(i), is_nlgeom, state, blocks, failed)
      end do
    end do
    !$omp end parallel
    failed_element = first_failed(failed)
    call sum_over_ranks(blocks)
  end subroutine assemble_nodal_stiffness


  !> Adds the diagonal blocks of one element to those of its nodes.
  subroutine add_nodal_blocks(model, e, is_nlgeom, state, blocks, failed)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(in) :: state
    real(DP), intent(inout) :: blocks(:, :, :)     !< (3, 3, n_nodes) [force/length]
    integer, intent(inout) :: failed
    type(integration_points_type) :: points
    real(DP) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES)
    integer :: n, a, nodes(MAX_ELEMENT_NODES)
    logical :: is_sound
    if (is_out(model, state%new%step, e)) return
    call evaluate_one_tangent(model, e, is_nlgeom, state, X, u, stiffness, points, is_sound)
    if (.not. is_sound) then
      failed = min(failed, e)
      return
    end if
    call element_nodes(model%mesh, e, n, nodes)
    do a = 1, n
      associate (block => stiffness(3 * a - 2:3 * a, 3 * a - 2:3 * a))
        blocks(:, :, nodes(a)) = blocks(:, :, nodes(a)) + 0.5_DP * (block + transpose(block))
      end associate
    end do
  end subroutine add_nodal_blocks


  !> The stiffness of one element at the trial state.
  subroutine evaluate_one_tangent(model, e, is_nlgeom, state, X, u, stiffness, points, is_sound)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(in) :: state
    real(DP), intent(out) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES)   !< of its nodes [length]
    real(DP), intent(out) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< set up to 3 * nodes [force/length]
    type(integration_points_type), intent(out) :: points
    logical, intent(out) :: is_sound               !< neither inverted nor not finite
    integer :: n, status
    logical :: is_gone                             ! all its points are deleted
    n = model%mesh%first(e + 1) - model%mesh%first(e)
    call load_points(model, state, e, points)
    points%is_output_wanted = .false.
    if (is_stacked_triangle(model, e)) call load_stack_bending(model, state, e, is_nlgeom, points)
    is_gone = is_deleted_element(model, state%old, e)
    if (model%materials(element_material(model, state%new%step, e))%is_user .and. .not. is_gone) call load_umat_points(model, &
      state, e, is_nlgeom, points)
    if (model%materials(element_material(model, state%new%step, e))%creep_law == CREEP_USER) call load_creep_points(model, state, &
      e, is_nlgeom, points%creep)
    call set_element_configuration(model%mesh, e, state%new, X, u)
    if (is_gone) u(:, :n) = 0                      ! that at rest keeps the matrix regular, however far its nodes move
    call evaluate_element_tangent(model%mesh%kind(e), model%materials(element_material(model, state%new%step, e)), &
      X(:, :n), u(:, :n), is_nlgeom, stiffness, points, status)
    if (is_gone) stiffness = DELETED_STIFFNESS * stiffness
    is_sound = status == ELEMENT_OK
  end subroutine evaluate_one_tangent


  !> Adds the stiffness of one element to the matrix, block by block.
  subroutine add_element_tangent(assembly, model, e, is_nlgeom, state, failed)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    logical, intent(in) :: is_nlgeom
    type(state_type), intent(in) :: state
    integer, intent(inout) :: failed
    type(integration_points_type) :: points
    real(DP) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES), skew(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: X(3, MAX_ELEMENT_NODES), u(3, MAX_ELEMENT_NODES)
    integer :: n
    logical :: is_sound
    if (is_out(model, state%new%step, e)) return
    call evaluate_one_tangent(model, e, is_nlgeom, state, X, u, stiffness, points, is_sound)
    if (.not. is_sound) then
      failed = min(failed, e)
      return
    end if
    n = model%mesh%first(e + 1) - model%mesh%first(e)
    associate (offset => assembly%pair_offset(assembly%pair_first(e):assembly%pair_first(e + 1) - 1))
      if (.not. allocated(points%skew)) then
        call scatter_element(model%mesh, e, offset, stiffness, assembly%stiffness)
        return
      end if
      skew(:3 * n, :3 * n) = 0.5_DP * (stiffness(:3 * n, :3 * n) - transpose(stiffness(:3 * n, :3 * n)))   ! of kinds with modes
      stiffness(:3 * n, :3 * n) = stiffness(:3 * n, :3 * n) - skew(:3 * n, :3 * n)
      call scatter_element(model%mesh, e, offset, stiffness, assembly%stiffness)
      if (all(model%mesh%kind(e) /= [KIND_CSS8, KIND_CSS6]) .and. .not. (has_modes(model%mesh%kind(e)) .or. &
        is_cohesive(model%mesh%kind(e)) .or. is_quadratic_solid_shell(model%mesh, e))) &
        call evaluate_element_skew(model%mesh%kind(e), X(:, :n), u(:, :n), is_nlgeom, points%section_value, points%skew, skew, &
        points%walls)
      call scatter_element(model%mesh, e, offset, skew, assembly%skew%elements)
    end associate
  end subroutine add_element_tangent


  !> Adds the blocks of an element to the upper triangle of a matrix with the pattern of K.
  pure subroutine scatter_element(mesh, e, offset, stiffness, matrix)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    integer, intent(in) :: offset(:)               !< positions of the blocks of its pairs of nodes
    real(DP), intent(in) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< set up to 3 * nodes [force/length]
    type(sparse_type), intent(inout) :: matrix
    integer :: n, a, b, k, nodes(MAX_ELEMENT_NODES)
    call element_nodes(mesh, e, n, nodes)
    k = 1
    do b = 1, n
      do a = 1, b
        if (nodes(a) <= nodes(b)) then
          call add_row_block(matrix, nodes(a), offset(k), stiffness(3 * a - 2:3 * a, 3 * b - 2:3 * b))
        else
          call add_row_block(matrix, nodes(b), offset(k), stiffness(3 * b - 2:3 * b, 3 * a - 2:3 * a))
        end if
        k = k + 1
      end do
    end do
  end subroutine scatter_element

end module amontons_assembly
