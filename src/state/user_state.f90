!> Data passed to user routines at element level (UMAT, USDFLD, SDVINI, DLOAD, UTRACLOAD, DISP) and stored from them.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_user_state
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_NOT_CONVERGED
  use amontons_element, only: evaluate_element_volume, set_temperature_weights
  use amontons_user_material, only: umat_point_type, is_deleted
  use amontons_materials, only: material_type, verdict_place, user_field_place, USER_STRESS, USER_STATE, USER_FIELD, &
    HISTORY_PEEQ, HISTORY_INELASTIC
  use amontons_mesh, only: element_nodes, wall_ratios
  use amontons_model, only: model_type, material_in_step
  use amontons_element_integration_points, only: integration_points_type
  use amontons_loads, only: distributed_type, prescribed_type
  use amontons_shape_functions, only: shape_functions, quadrature, facet_shapes, facet_quadrature, MAX_FACET_POINTS
  use amontons_state, only: state_type, fields_type, commit_fields, rotate_stress_to_frame
  use amontons_element_kinds, only: element_kind, element_kind_type, FAMILY_PLANE_STRAIN, FAMILY_AXISYMMETRIC, &
    FAMILY_PLANE_STRESS, FAMILY_MEMBRANE, FAMILY_TRUSS, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, MAX_FACE_NODES
  use amontons_user_routines, only: creep_type, call_dload, call_utracload, call_disp, call_sdvini, call_usdfld, usdfld_type, &
    umat_type, &
    user_library_type, &
    has_routine, ROUTINE_USDFLD, USER_NAME_LENGTH
  use amontons_tensor, only: IDENTITY, cross_product
  implicit none
  private
  public :: max_stress_components, find_point_at_rest, initialize_state_variables, load_umat_points, store_umat_points, &
    load_creep_points
  public :: evaluate_dload, evaluate_utracload, evaluate_disp
  public :: is_deleted_element, field_library
  public :: update_user_fields, load_user_fields, has_invalid_fields

contains

  !> Data of the points of an element for UMAT: committed history, times, positions, numbers.
  pure subroutine load_umat_points(model, state, e, is_nlgeom, points)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state          !< old history; new times, numbers, displacements
    integer, intent(in) :: e                       !< element
    logical, intent(in) :: is_nlgeom
    type(integration_points_type), intent(inout) :: points     !< out: user
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), x(3, &
      MAX_ELEMENT_NODES), volume, dt
    real(DP) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    integer :: n_rule, n_nodes, nodes(MAX_ELEMENT_NODES), p, m, first, n_history, status, components(2)
    m = material_in_step(model, state%new%step, e)
    components = umat_components(model%materials(m), model%mesh%kind(e))
    call element_nodes(model%mesh, e, n_nodes, nodes)
    x(:, :n_nodes) = model%mesh%coordinates(:, nodes(:n_nodes))
    call evaluate_element_volume(model%mesh%kind(e), x(:, :n_nodes), model%mesh%section_value(e), volume, status, &
      wall_ratios(model%mesh, e))
    if (is_nlgeom) x(:, :n_nodes) = x(:, :n_nodes) + state%new%u(:, nodes(:n_nodes))
    call quadrature(model%mesh%kind(e), n_rule, xi, w, wall_ratios(model%mesh, e))
    if (model%materials(m)%n_fields > 0) call set_temperature_weights(model%mesh%kind(e), weight, wall_ratios(model%mesh, e))
    dt = state%new%total_time - state%old%total_time
    first = model%mesh%point_first(e)
    n_history = model%materials(m)%n_history
    if (allocated(points%user)) deallocate (points%user)
    allocate (points%user(model%mesh%point_first(e + 1) - first))
    do p = 1, size(points%user)
      call shape_functions(model%mesh%kind(e), xi(:, p), N, dN)
      associate (user => points%user(p), values => points%user(p)%values)
        user%history_old = state%old%history(USER_STRESS:n_history, first + p - 1)
        if (allocated(model%element_orientation)) user%has_orientation = model%element_orientation(e) > 0
        values%time = [state%new%step_time - dt, state%old%total_time]
        values%dtime = dt
        values%temp = sum(state%old%temperature(nodes(:n_nodes))) / real(n_nodes, DP)
        values%coords = matmul(x(:, :n_nodes), N(:n_nodes))
        values%celent = max(volume, 0.0_DP)**(1 / 3.0_DP)
        values%noel = model%mesh%element_label(e)
        values%npt = p
        values%ndi = components(1)
        values%nshr = components(2)
        values%step = state%new%step
        values%increment = state%new%increment
        if (model%materials(m)%n_fields == 0) cycle
        if (model%materials(m)%is_user_field) then
          call load_field_call(model%materials(m), state%new%history(:, first + p - 1), user)
        else
          call load_fields(model%materials(m)%n_fields, state, nodes(:n_nodes), weight(:n_nodes, p), user)
        end if
      end associate
    end do
  end subroutine load_umat_points


  !> What a routine CREEP gets of the points of an element. TIME is at the end of the increment; of creep: that of VISCO steps.
  pure subroutine load_creep_points(model, state, e, is_nlgeom, creep)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    integer, intent(in) :: e
    logical, intent(in) :: is_nlgeom
    type(creep_type), allocatable, intent(out) :: creep(:)    !< (points)
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), x(3, &
      MAX_ELEMENT_NODES), weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    integer :: n_rule, n_nodes, nodes(MAX_ELEMENT_NODES), p
    call element_nodes(model%mesh, e, n_nodes, nodes)
    x(:, :n_nodes) = model%mesh%coordinates(:, nodes(:n_nodes))
    if (is_nlgeom) x(:, :n_nodes) = x(:, :n_nodes) + state%new%u(:, nodes(:n_nodes))
    call quadrature(model%mesh%kind(e), n_rule, xi, w, wall_ratios(model%mesh, e))
    call set_temperature_weights(model%mesh%kind(e), weight, wall_ratios(model%mesh, e))
    allocate (creep(model%mesh%point_first(e + 1) - model%mesh%point_first(e)))
    do p = 1, size(creep)
      call shape_functions(model%mesh%kind(e), xi(:, p), N, dN)
      associate (values => creep(p), old => state%old, new => state%new)
        values%time = [new%step_time, new%total_time, new%creep_time]
        values%temp = dot_product(weight(:n_nodes, p), new%temperature(nodes(:n_nodes)))
        values%dtemp = values%temp - dot_product(weight(:n_nodes, p), old%temperature(nodes(:n_nodes)))
        values%coords = matmul(x(:, :n_nodes), N(:n_nodes))
        values%noel = model%mesh%element_label(e)
        values%npt = p
        values%step = new%step
        values%increment = new%increment
      end associate
    end do
  end subroutine load_creep_points


  !> Field variables of a point from those of the nodes: at the start of the increment, and their changes.
  pure subroutine load_fields(n_fields, state, nodes, weight, user)
    integer, intent(in) :: n_fields
    type(state_type), intent(in) :: state
    integer, intent(in) :: nodes(:)                !< of the element
    real(DP), intent(in) :: weight(:)              !< of its nodes [-]
    type(umat_point_type), intent(inout) :: user   !< out: fields
    integer :: k, n
    n = size(state%new%u, 2)
    allocate (user%fields(n_fields, 2))
    user%fields(:, 1) = [(dot_product(weight, state%old%temperature(k * n + nodes)), k=1, n_fields)]
    user%fields(:, 2) = [(dot_product(weight, state%new%temperature(k * n + nodes)), k=1, n_fields)] - user%fields(:, 1)
  end subroutine load_fields


  !> Field variables and STATEV of a point from USDFLD, which stay the same over the increment.
  pure subroutine load_field_call(material, history, user)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: history(:)             !< of the trial state
    type(umat_point_type), intent(inout) :: user   !< out: fields, history_old
    integer :: first
    first = user_field_place(material, 1)
    allocate (user%fields(material%n_fields, 2), source=0.0_DP)
    user%fields(:, 1) = history(first:first + material%n_fields - 1)
    user%history_old(verdict_place(material) - USER_STRESS + 1:) = history(verdict_place(material):material%n_history)
    user%history_old(USER_STATE - USER_STRESS + 1:USER_STATE - USER_STRESS + material%n_statev) = history(first + &
      material%n_fields:first + material%n_fields + material%n_statev - 1)
  end subroutine load_field_call


  !> Whether all points of an element are deleted by UMAT.
  pure logical function is_deleted_element(model, fields, e) result(is_so)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: e
    integer :: p, m
    is_so = .false.
    m = material_in_step(model, fields%step, e)
    if (m == 0) return
    if (model%materials(m)%deletion == 0) return
    is_so = all([(is_deleted(model%materials(m), fields%history(USER_STATE:, p)), p=model%mesh%point_first(e), &
      model%mesh%point_first(e + 1) - 1)])
  end function is_deleted_element


  !> Number of normal and shear components that UMAT gets in an element.
  pure function umat_components(material, kind) result(components)
    type(material_type), intent(in) :: material
    integer, intent(in) :: kind                    !< KIND_...
    integer :: components(2)
    components = count_stress_components(kind)
    if (material%is_shell_law) components = [2, 1]
    if (material%is_called_in_3d) components = [3, 3]
  end function umat_components


  !> Number of normal and shear components of an element kind in Abaqus.
  pure function count_stress_components(kind) result(components)
    integer, intent(in) :: kind                    !< KIND_...
    integer :: components(2)
    type(element_kind_type) :: entry
    entry = element_kind(kind)
    components = [3, 3]
    select case (entry%family)
    case (FAMILY_PLANE_STRAIN, FAMILY_AXISYMMETRIC)
      components = [3, 1]
    case (FAMILY_PLANE_STRESS, FAMILY_MEMBRANE)
      components = [2, 1]
    case (FAMILY_TRUSS)
      components = [1, 0]
    end select
  end function count_stress_components


  !> The largest number of components over the elements of a material. One without elements whose name a law of shells has is that
  !! law.
  pure function max_stress_components(model, m) result(components)
    type(model_type), intent(in) :: model
    integer, intent(in) :: m                       !< material
    integer :: components(2)
    integer :: element_components(2), e, k
    logical :: is_used
    components = [1, 0]
    if (model%materials(m)%is_called_in_3d) components = [3, 3]
    is_used = .false.
    do e = 1, model%mesh%n_elements
      if (model%mesh%material(e) /= m) cycle
      is_used = .true.
      element_components = umat_components(model%materials(m), model%mesh%kind(e))
      if (sum(element_components) > sum(components)) components = element_components
    end do
    if (is_used) return
    do k = m, size(model%materials)
      if (model%materials(k)%is_shell_law .and. model%materials(k)%name == model%materials(m)%name) components = [2, 1]
    end do
  end function max_stress_components


  !> The arguments of UMAT, but for DTIME, at the first point of the first element of a material, before the first increment; their
  !! number is the largest over its elements. A material without elements gets element 1 at the origin.
  subroutine find_point_at_rest(model, m, values, statev, fields)
    type(model_type), intent(in) :: model
    integer, intent(in) :: m                       !< material
    type(umat_type), intent(out) :: values
    real(DP), allocatable, intent(out) :: statev(:)   !< of the deck or of SDVINI; else 0, 1 for that which deletes the point
    real(DP), allocatable, intent(out) :: fields(:, :)   !< (n, 2) field variables in the middle of the element, and zero
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), volume
    integer :: components(2), nodes(MAX_ELEMENT_NODES), e, n_rule, n_nodes, status, k
    logical :: is_accepted
    components = max_stress_components(model, m)
    values%ndi = components(1)
    values%nshr = components(2)
    values%noel = 1
    values%npt = 1
    values%step = 1
    values%increment = 1
    values%celent = 1
    values%drot = IDENTITY
    values%dfgrd0 = IDENTITY
    values%dfgrd1 = IDENTITY
    allocate (statev(model%materials(m)%n_statev), fields(model%materials(m)%n_fields, 2), source=0.0_DP)
    if (model%materials(m)%deletion > 0) statev(model%materials(m)%deletion) = 1
    e = findloc(model%mesh%material, m, dim=1)
    if (e == 0) return
    associate (mesh => model%mesh)
      call element_nodes(mesh, e, n_nodes, nodes)
      call evaluate_element_volume(mesh%kind(e), mesh%coordinates(:, nodes(:n_nodes)), mesh%section_value(e), volume, status, &
        wall_ratios(mesh, e))
      call quadrature(mesh%kind(e), n_rule, xi, w, wall_ratios(mesh, e))
      call shape_functions(mesh%kind(e), xi(:, 1), N, dN)
      values%coords = matmul(mesh%coordinates(:, nodes(:n_nodes)), N(:n_nodes))
      values%celent = max(volume, 0.0_DP)**(1 / 3.0_DP)
      values%noel = mesh%element_label(e)
      if (allocated(model%initial_temperature)) then
        values%temp = sum(model%initial_temperature(nodes(:n_nodes))) / real(n_nodes, DP)
        fields(:, 1) = [(sum(model%initial_temperature(k * mesh%n_nodes + nodes(:n_nodes))) / real(n_nodes, DP), &
          k=1, size(fields, 1))]
      end if
      if (allocated(model%initial_statev)) statev = model%initial_statev(:size(statev), mesh%point_first(e))
    end associate
    if (model%has_sdvini .and. size(statev) > 0) call call_sdvini(model%materials(m)%routines, statev, values%coords, values%noel, &
      values%npt, is_accepted)
  end subroutine find_point_at_rest


  !> The initial STATEV of the points: SDVINI's, else those of the deck. Errors: EXIT_NOT_CONVERGED (SDVINI calls XIT).
  subroutine initialize_state_variables(model, state, error)
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    type(user_library_type) :: routines
    integer :: e, p, first, n_rule, n_nodes, nodes(MAX_ELEMENT_NODES)
    logical :: is_accepted
    if (.not. (model%has_sdvini .or. allocated(model%initial_statev) .or. any(model%materials%deletion > 0))) return
    is_accepted = .true.
    do e = 1, model%mesh%n_elements
      if (model%mesh%material(e) == 0) cycle
      associate (material => model%materials(model%mesh%material(e)), statev => state%new%history)
        if (material%n_statev == 0) cycle
        call element_nodes(model%mesh, e, n_nodes, nodes)
        call quadrature(model%mesh%kind(e), n_rule, xi, w, wall_ratios(model%mesh, e))
        first = model%mesh%point_first(e)
        routines = model%routines
        if (material%is_user) routines = material%routines
        do p = first, model%mesh%point_first(e + 1) - 1
          if (material%deletion > 0) statev(USER_STATE + material%deletion - 1, p) = 1
          if (allocated(model%initial_statev)) statev(USER_STATE:USER_STATE + material%n_statev - 1, p) = &
            model%initial_statev(:material%n_statev, p)
          if (.not. model%has_sdvini) cycle
          call shape_functions(model%mesh%kind(e), xi(:, p - first + 1), N, dN)
          call call_sdvini(routines, statev(USER_STATE:USER_STATE + material%n_statev - 1, p), &
            matmul(model%mesh%coordinates(:, nodes(:n_nodes)), N(:n_nodes)), model%mesh%element_label(e), p - first + 1, &
            is_accepted)
        end do
      end associate
      if (.not. is_accepted) exit
    end do
    call commit_fields(state)
    if (.not. is_accepted) call set_error(error, EXIT_NOT_CONVERGED, 'The user routine SDVINI has ended the job (XIT).')
  end subroutine initialize_state_variables


  !> Before an attempt: USDFLD gives field variables and STATEV of the points of its materials from the state at the start.
  subroutine update_user_fields(model, state)
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state       !< old fields; new times, numbers, temperatures; out: new history
    integer :: e, m
    if (.not. any(model%materials%is_user_field)) return
    do e = 1, model%mesh%n_elements
      m = material_in_step(model, state%new%step, e)
      if (m == 0) cycle
      if (model%materials(m)%is_user_field) call call_at_points(model, m, e, state)
    end do
  end subroutine update_user_fields


  !> The same for one element.
  subroutine call_at_points(model, m, e, state)
    type(model_type), intent(in) :: model
    integer, intent(in) :: m, e                    !< material, element
    type(state_type), intent(inout) :: state
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), &
      weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    real(DP), allocatable :: field(:), statev(:)
    character(USER_NAME_LENGTH) :: names(2)
    type(usdfld_type) :: values
    integer :: n_rule, n_nodes, nodes(MAX_ELEMENT_NODES), i, k, p, status, components(2)
    components = umat_components(model%materials(m), model%mesh%kind(e))
    call element_nodes(model%mesh, e, n_nodes, nodes)
    call quadrature(model%mesh%kind(e), n_rule, xi, w, wall_ratios(model%mesh, e))
    call set_temperature_weights(model%mesh%kind(e), weight, wall_ratios(model%mesh, e))
    names = [character(USER_NAME_LENGTH) :: model%materials(m)%name, '']
    associate (mesh => model%mesh, old => state%old, new => state%new)
      call evaluate_element_volume(mesh%kind(e), mesh%coordinates(:, nodes(:n_nodes)), mesh%section_value(e), values%celent, &
        status, wall_ratios(mesh, e))
      values%celent = max(values%celent, 0.0_DP)**(1 / 3.0_DP)
      values%time = [new%step_time - new%time_increment, old%total_time]
      values%dtime = new%time_increment
      values%noel = mesh%element_label(e)
      values%ndi = components(1)
      values%nshr = components(2)
      values%step = new%step
      values%increment = new%increment
      do i = 1, mesh%point_first(e + 1) - mesh%point_first(e)
        p = mesh%point_first(e) + i - 1
        call shape_functions(mesh%kind(e), xi(:, i), N, dN)
        call load_point(old, p, values)
        values%npt = i
        values%coords = matmul(mesh%coordinates(:, nodes(:n_nodes)), N(:n_nodes))
        values%temp = dot_product(weight(:n_nodes, i), old%temperature(nodes(:n_nodes)))
        field = [(dot_product(weight(:n_nodes, i), new%temperature(k * mesh%n_nodes + nodes(:n_nodes))), &
          k=1, size(new%temperature) / mesh%n_nodes - 1)]
        if (size(field) == 0) field = [0.0_DP]
        statev = old%history(USER_STATE:USER_STATE - 1 + model%materials(m)%n_statev, p)
        call call_usdfld(field_library(model, model%materials(m)), names, field, statev, values)
        call store_field_call(model%materials(m), field, statev, values%is_accepted == 1, new%history(:, p))
      end do
    end associate
  end subroutine call_at_points


  !> Stores what USDFLD gave at a point. STATEV of UMAT start from those of USDFLD, which are kept apart for each iteration.
  pure subroutine store_field_call(material, field, statev, is_accepted, history)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: field(:), statev(:)
    logical, intent(in) :: is_accepted
    real(DP), intent(inout) :: history(:)
    integer :: first
    history(verdict_place(material)) = merge(1.0_DP, 0.0_DP, is_accepted .and. all(abs([field, statev]) <= huge(1.0_DP)))
    if (material%is_user) then
      first = user_field_place(material, 1)
      history(first:first + material%n_fields - 1) = field(:material%n_fields)
      first = first + material%n_fields
    else
      history(USER_FIELD) = field(max(1, material%table_variable))
      first = USER_STATE
    end if
    history(first:first + size(statev) - 1) = statev
  end subroutine store_field_call


  !> The library whose USDFLD a material takes: its own, if it has the routine, else that of the job.
  function field_library(model, material) result(routines)
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material
    type(user_library_type) :: routines
    routines = model%routines
    if (.not. material%is_user) return
    if (has_routine(material%routines, ROUTINE_USDFLD)) routines = material%routines
  end function field_library


  !> What GETVRM gives at a point, in the local axes, and these.
  pure subroutine load_point(fields, p, values)
    type(fields_type), intent(in) :: fields        !< at the start of the increment
    integer, intent(in) :: p                       !< point
    type(usdfld_type), intent(inout) :: values
    values%direct = IDENTITY
    if (allocated(fields%frame)) values%direct = fields%frame(:, :, p)
    values%stress = rotate_stress_to_frame(fields%stress(:, p), values%direct)
    values%strain = rotate_stress_to_frame(fields%strain(:, p), values%direct)
    values%plastic(:6) = rotate_stress_to_frame(fields%history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5, p), values%direct)
    values%strain(4:) = 2 * values%strain(4:)      ! engineering shears
    values%plastic(4:6) = 2 * values%plastic(4:6)
    values%plastic(7) = fields%history(HISTORY_PEEQ, p)
  end subroutine load_point


  !> The field variable that USDFLD gave at the points of an element, if its material has such ones.
  pure subroutine load_user_fields(model, state, e, points)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    integer, intent(in) :: e
    type(integration_points_type), intent(inout) :: points     !< out: point_field
    integer :: p, m, k
    m = material_in_step(model, state%new%step, e)
    if (m == 0) return
    if (.not. model%materials(m)%is_user_field) return
    k = user_field_place(model%materials(m), max(1, model%materials(m)%table_variable))
    p = model%mesh%point_first(e)
    m = model%mesh%point_first(e + 1) - p
    points%point_field(:m) = state%new%history(k, p:p + m - 1)
  end subroutine load_user_fields


  !> Whether USDFLD requests a shorter increment for a point of an element, or gave a value that is not finite.
  pure logical function has_invalid_fields(model, fields, e)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    integer, intent(in) :: e
    integer :: m
    has_invalid_fields = .false.
    m = material_in_step(model, fields%step, e)
    if (m == 0) return
    if (model%materials(m)%is_user_field) has_invalid_fields = any(fields%history(verdict_place(model%materials(m)), &
      model%mesh%point_first(e):model%mesh%point_first(e + 1) - 1) < 1)
  end function has_invalid_fields


  !> Stores the history that UMAT returned for the points of an element.
  pure subroutine store_umat_points(model, e, points, fields)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                       !< element
    type(integration_points_type), intent(in) :: points
    type(fields_type), intent(inout) :: fields
    integer :: p, n_history
    n_history = model%materials(material_in_step(model, fields%step, e))%n_history
    do p = 1, size(points%user)
      fields%history(:USER_STRESS - 1, model%mesh%point_first(e) + p - 1) = 0
      fields%history(USER_STRESS:n_history, model%mesh%point_first(e) + p - 1) = points%user(p)%history
    end do
  end subroutine store_umat_points


  !> The pressures of DLOAD at the points of a face.
  pure subroutine evaluate_dload(model, load, facet_kind, x, fields, pressures)
    type(model_type), intent(in) :: model
    type(distributed_type), intent(in) :: load
    integer, intent(in) :: facet_kind              !< FACET_...
    real(DP), intent(in) :: x(:, :)                !< (3, nodes) of the face; current under NLGEOM [length]
    type(fields_type), intent(in) :: fields        !< times, numbers
    real(DP), allocatable, intent(out) :: pressures(:)   !< (points) [stress]
    integer, parameter :: JLTYP_BASE = 20             ! JLTYP of P1NU is 21
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS)
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    character(USER_NAME_LENGTH) :: name
    integer :: n_rule, p
    logical :: is_accepted
    name = ''
    call facet_quadrature(facet_kind, n_rule, xi, w)
    allocate (pressures(n_rule), source=load%end)
    do p = 1, n_rule
      call facet_shapes(facet_kind, xi(:, p), N, dN, ddN)
      call call_dload(model%routines, pressures(p), [fields%step_time, fields%total_time], matmul(x, N(:size(x, 2))), name, &
        [fields%step, fields%increment, model%mesh%element_label(load%element), p, JLTYP_BASE + load%face], is_accepted)
    end do
  end subroutine evaluate_dload


  !> The nodal forces of a traction by UTRACLOAD on a face, per reference area. JLTYP is 510 + n of TRSHRnNU, 520 + n of TRVECnNU,
  !! 510 and 520 on a surface, whose name is SNAME. DIRCOS: the reference face's first tangent, inward normal x it, inward normal.
  pure subroutine evaluate_utracload(model, load, facet_kind, X, now, fields, force)
    type(model_type), intent(in) :: model
    type(distributed_type), intent(in) :: load
    integer, intent(in) :: facet_kind              !< FACET_...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) of the face, undeformed [length]
    real(DP), intent(in) :: now(:, :)              !< (3, nodes) where COORDS counts: current under NLGEOM [length]
    type(fields_type), intent(in) :: fields        !< times, numbers
    real(DP), intent(out) :: force(:, :)           !< (3, nodes) [force]
    integer, parameter :: JLTYP_SHEAR = 510, JLTYP_GENERAL = 520
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), &
      ddN(3, MAX_FACE_NODES), tangent(3), area(3), axes(3, 3), direction(3), magnitude
    character(USER_NAME_LENGTH) :: name
    integer :: n_rule, p, a, m
    logical :: is_accepted
    m = size(X, 2)
    name = ''
    if (load%surface > 0) name = model%surfaces(load%surface)%name
    call facet_quadrature(facet_kind, n_rule, xi, w)
    force = 0
    do p = 1, n_rule
      call facet_shapes(facet_kind, xi(:, p), N, dN, ddN)
      tangent = matmul(X, dN(1, :m))
      area = cross_product(tangent, matmul(X, dN(2, :m)))   ! outward
      axes(:, 1) = tangent / norm2(tangent)
      axes(:, 3) = -area / norm2(area)
      axes(:, 2) = cross_product(axes(:, 3), axes(:, 1))
      magnitude = load%end
      direction = load%direction
      call call_utracload(model%routines, magnitude, direction, [fields%step_time, fields%total_time], reshape([matmul(now, &
        N(:m)), axes], [3, 4]), name, [fields%step, fields%increment, model%mesh%element_label(load%element), p, &
        merge(JLTYP_SHEAR, JLTYP_GENERAL, load%is_shear) + merge(0, load%face, load%surface > 0)], is_accepted)
      if (.not. is_accepted .or. .not. abs(magnitude) > 0) cycle
      if (load%is_shear) direction = direction - dot_product(direction, axes(:, 3)) * axes(:, 3)
      do a = 1, m
        force(:, a) = force(:, a) + w(p) * norm2(area) * N(a) * magnitude * direction / norm2(direction)
      end do
    end do
  end subroutine evaluate_utracload


  !> The displacement prescribed by DISP.
  pure subroutine evaluate_disp(model, load, fields, value)
    type(model_type), intent(in) :: model
    type(prescribed_type), intent(in) :: load
    type(fields_type), intent(in) :: fields        !< times, numbers, displacements
    real(DP), intent(inout) :: value               !< in: of the card; out: of DISP [length]
    logical :: is_accepted
    if (.not. fields%time_increment > 0) return    ! before the first increment only the prescribed unknowns matter
    call call_disp(model%routines, value, [fields%step_time, fields%total_time, fields%time_increment], &
      model%mesh%coordinates(:, load%node) + fields%u(:, load%node), &
      [fields%step, fields%increment, model%mesh%node_label(load%node), load%dof], is_accepted)
  end subroutine evaluate_disp

end module amontons_user_state
