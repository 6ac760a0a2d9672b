!> External loads: concentrated, pressure, traction, body, gravity and centrifugal forces, and their load stiffness.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Loads on faces act at the places of module load_faces. Pressures follow their faces under NLGEOM, forces with FOLLOWER their
!! nodes; tractions, other forces and moments keep their direction. The symmetric part of a load's stiffness is added to K, the
!! skew-symmetric part to assembly%skew.
module amontons_external_loads
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY, rotation_matrix, moment_on_vector
  use amontons_tributary_areas, only: out_of_plane_depth, integrate_nodal_areas
  use amontons_assembly_plan, only: assembly_type, add_node_block, add_row_block, is_own_element
  use amontons_assembly, only: element_material
  use amontons_element, only: integrate_body_force, integrate_facet_pressure, integrate_edge_pressure, evaluate_point_volumes, &
    ELEMENT_OK
  use amontons_loads, only: foundation_type, concentrated_type, distributed_type, DISTRIBUTED_PRESSURE, &
    DISTRIBUTED_CENTRIFUGAL, DISTRIBUTED_BODY_FORCE, DISTRIBUTED_TRACTION
  use amontons_materials, only: evaluate_table
  use amontons_mesh, only: element_nodes, wall_ratios
  use amontons_model, only: model_type, dof_direction, is_out, load_now, find_finite_rotations, DIALECT_CALCULIX
  use amontons_shape_functions, only: choose_face_rule, shape_functions, quadrature
  use amontons_face_foundation, only: integrate_face_foundation, integrate_edge_foundation
  use amontons_unsymmetric_tangent, only: reset_load_skew, add_face_skew
  use amontons_state, only: fields_type, load_time
  use amontons_steps, only: step_type
  use amontons_load_faces, only: load_face_type, find_load_face, add_face_force, spread_stiffness
  use amontons_element_kinds, only: KIND_MASS, has_faces_in_space, MAX_ELEMENT_NODES, &
    MAX_FACE_NODES, MAX_ELEMENT_POINTS, &
    KIND_C3D8R, KIND_C3D8_FULL, KIND_CPS3, KIND_CAX_SHELL, KIND_SPRINGA
  use amontons_user_state, only: evaluate_dload, evaluate_utracload, is_deleted_element
  implicit none
  private
  public :: assemble_external_loads, assemble_reference_loads, add_foundation_stiffness, integrate_unit_mass, evaluate_density

contains

  !> The applied forces F_ext at a time, and under NLGEOM their stiffness subtracted from K.
  !!
  !! The load stiffness is unsymmetric in general: the symmetric part goes into K, the rest into assembly%skew, which assemble_skew
  !! completes.
  subroutine assemble_external_loads(assembly, model, step, fields, is_nlgeom, has_stiffness)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(inout) :: fields     !< in: u, times; out: applied_force
    logical, intent(in) :: is_nlgeom
    logical, intent(in) :: has_stiffness       !< .true.: subtract the load stiffness from K
    logical, allocatable :: is_rotation(:)
    integer :: i
    real(DP) :: magnitude
    fields%applied_force = 0.0_DP
    if (has_stiffness) call reset_load_skew(assembly%skew)
    allocate (is_rotation(model%mesh%n_nodes), source=.false.)
    if (is_nlgeom .and. size(step%concentrated) > 0 .and. model%dialect /= DIALECT_CALCULIX) &
      is_rotation = find_finite_rotations(model)
    do i = 1, size(step%concentrated)
      associate (load => step%concentrated(i))
        magnitude = load_now(model, step, load, load_time(step, fields), fields%total_time)
        if (load%is_follower .and. is_nlgeom) then
          call add_follower_force(assembly, model, load, magnitude, fields, has_stiffness)
        else
          call add_force(assembly, load%node, magnitude * dof_direction(model, load%node, load%dof), &
            is_rotation(load%node), fields, has_stiffness)
        end if
      end associate
    end do
    do i = 1, size(step%distributed)
      associate (load => step%distributed(i))
        magnitude = load_now(model, step, load, load_time(step, fields), fields%total_time)
        if (is_out(model, step%number, load%element)) cycle
        if (load%element > 0) then
          if (is_deleted_element(model, fields, load%element)) cycle
        end if
        if (magnitude == 0.0_DP .and. .not. load%is_user) cycle
        select case (load%kind)
        case (DISTRIBUTED_PRESSURE)
          call add_pressure(assembly, model, load, magnitude, fields, is_nlgeom, has_stiffness)
        case (DISTRIBUTED_TRACTION)
          if (load%is_user) then
            call add_user_traction(model, load, fields, is_nlgeom)
          else
            call add_traction(model, load%element, load%face, magnitude * load%direction, fields)
          end if
        case (DISTRIBUTED_CENTRIFUGAL)
          call add_centrifugal_forces(assembly, model, load, magnitude, fields, is_nlgeom, has_stiffness)
        case default
          call add_body_force(model, load%element, load%kind == DISTRIBUTED_BODY_FORCE, magnitude * load%direction, fields)
        end select
      end associate
    end do
    if (allocated(model%foundations)) call add_foundation_forces(assembly, model, fields, is_nlgeom, has_stiffness)
  end subroutine assemble_external_loads


  !> The forces of all foundations, and what of their stiffness is not symmetric; add_foundation_stiffness adds the rest.
  subroutine add_foundation_forces(assembly, model, fields, is_nlgeom, has_stiffness)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(fields_type), intent(inout) :: fields     !< in: u, step; out: applied_force
    logical, intent(in) :: is_nlgeom, has_stiffness
    type(load_face_type) :: place
    real(DP) :: force(3, MAX_FACE_NODES), stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)
    integer :: i
    do i = 1, size(model%foundations)
      if (is_out(model, fields%step, model%foundations(i)%element)) cycle
      call evaluate_foundation(model, model%foundations(i), fields, is_nlgeom, place, force, stiffness)
      call add_face_force(place, force, fields%applied_force)
      if (is_nlgeom .and. has_stiffness) call add_face_skew(assembly%skew, place%nodes(:place%n_nodes), &
        spread_stiffness(place, stiffness))
    end do
  end subroutine add_foundation_forces


  !> Adds the symmetric part of the stiffness of all foundations to K. It belongs to the bulk like that of the elements.
  subroutine add_foundation_stiffness(assembly, model, fields, is_nlgeom)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom
    type(load_face_type) :: place
    real(DP) :: force(3, MAX_FACE_NODES), stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)
    integer :: i
    if (.not. allocated(model%foundations)) return
    do i = 1, size(model%foundations)
      if (is_out(model, fields%step, model%foundations(i)%element)) cycle
      call evaluate_foundation(model, model%foundations(i), fields, is_nlgeom, place, force, stiffness)
      call subtract_symmetric_part(assembly, place%element, place%local(:place%n_nodes), place%nodes(:place%n_nodes), &
        spread_stiffness(place, stiffness))
    end do
  end subroutine add_foundation_stiffness


  !> Forces and stiffness of one foundation.
  subroutine evaluate_foundation(model, foundation, fields, is_nlgeom, place, force, stiffness)
    type(model_type), intent(in) :: model
    type(foundation_type), intent(in) :: foundation
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom
    type(load_face_type), intent(out) :: place
    real(DP), intent(out) :: force(3, MAX_FACE_NODES)   !< at the places [force]
    real(DP), intent(out) :: stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)   !< d force/d u [force/length]
    associate (mesh => model%mesh, e => foundation%element)
      call find_load_face(model, e, foundation%face, fields%u, place)
      associate (X => place%X(:, :place%n_places), u => place%u(:, :place%n_places))
        if (has_faces_in_space(mesh%kind(e))) then
          call integrate_face_foundation(place%kind, X, u, foundation%stiffness, is_nlgeom, force, stiffness)
        else
          call integrate_edge_foundation(place%kind, X, u, out_of_plane_depth(mesh, e), foundation%stiffness, &
            is_nlgeom, force, stiffness)
        end if
      end associate
    end associate
  end subroutine evaluate_foundation


  !> The change of the applied forces of a RIKS step with its load factor, at the displacements of the fields.
  subroutine assemble_reference_loads(assembly, model, step, fields, is_nlgeom, force)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(inout) :: fields     !< as before in the end
    logical, intent(in) :: is_nlgeom
    real(DP), allocatable, intent(out) :: force(:, :)   !< (3, n_nodes) [force]
    real(DP), allocatable :: applied_force(:, :)
    real(DP) :: load_factor
    applied_force = fields%applied_force
    load_factor = fields%load_factor
    fields%load_factor = 0.0_DP
    call assemble_external_loads(assembly, model, step, fields, is_nlgeom, .false.)
    force = fields%applied_force
    fields%load_factor = 1.0_DP
    call assemble_external_loads(assembly, model, step, fields, is_nlgeom, .false.)
    force = fields%applied_force - force
    fields%load_factor = load_factor
    fields%applied_force = applied_force
  end subroutine assemble_reference_loads


  !> A force, or a moment on a finite rotation, of fixed direction.
  !!
  !! The moment does the work M . dtheta, so its forces on the rotation vector depend on it. Their stiffness by central differences;
  !! it is skew at w = 0. (In the calculix dialect moments are those forces, as in CalculiX.)
  subroutine add_force(assembly, node, force, is_moment, fields, has_stiffness)
    type(assembly_type), intent(inout) :: assembly
    integer, intent(in) :: node
    real(DP), intent(in) :: force(3)               !< [force], [force length]
    logical, intent(in) :: is_moment
    type(fields_type), intent(inout) :: fields
    logical, intent(in) :: has_stiffness
    real(DP), parameter :: H = 1.0e-5_DP
    real(DP) :: stiffness(3, 3), shift(3)
    integer :: k
    if (.not. is_moment) then
      fields%applied_force(:, node) = fields%applied_force(:, node) + force
      return
    end if
    associate (w => fields%u(:, node))
      fields%applied_force(:, node) = fields%applied_force(:, node) + moment_on_vector(w, force)
      if (.not. has_stiffness .or. .not. any(abs(force) > 0.0_DP)) return
      do k = 1, 3
        shift = 0.0_DP
        shift(k) = H
        stiffness(:, k) = (moment_on_vector(w + shift, force) - moment_on_vector(w - shift, force)) / (2.0_DP * H)
      end do
    end associate
    call add_node_block(assembly, node, node, -0.5_DP * (stiffness + transpose(stiffness)))
    call add_face_skew(assembly%skew, [node], stiffness)
    assembly%skew%has_follower_forces = .true.
  end subroutine add_force


  !> A force that turns with its node: F = R(w) F0, w the displacement of the rotation node. Its stiffness dR/dw F0 has rows of the
  !! node and columns of the rotation node.
  subroutine add_follower_force(assembly, model, load, magnitude, fields, has_stiffness)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(concentrated_type), intent(in) :: load
    real(DP), intent(in) :: magnitude              !< [force]
    type(fields_type), intent(inout) :: fields
    logical, intent(in) :: has_stiffness
    real(DP) :: R(3, 3), dR(3, 3, 3), force(3), stiffness(6, 6)
    integer :: k
    associate (node => load%node, rotation => model%rotation_of(load%node))
      force = magnitude * dof_direction(model, node, load%dof)
      call rotation_matrix(fields%u(:, rotation), R, dR)
      fields%applied_force(:, node) = fields%applied_force(:, node) + matmul(R, force)
      if (.not. has_stiffness) return
      stiffness = 0
      do k = 1, 3
        stiffness(:3, 3 + k) = matmul(dR(:, :, k), force)
      end do
      call add_node_block(assembly, min(node, rotation), max(node, rotation), merge(-0.5_DP * stiffness(:3, 4:), &
        -0.5_DP * transpose(stiffness(:3, 4:)), node < rotation))
      call add_face_skew(assembly%skew, [node, rotation], stiffness)
      assembly%skew%has_follower_forces = .true.
    end associate
  end subroutine add_follower_force


  !> Nodal forces of a pressure on a face, in the current configuration under NLGEOM.
  subroutine add_pressure(assembly, model, load, pressure, fields, is_nlgeom, has_stiffness)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(distributed_type), intent(in) :: load
    real(DP), intent(in) :: pressure
    type(fields_type), intent(inout) :: fields
    logical, intent(in) :: is_nlgeom, has_stiffness
    type(load_face_type) :: place
    real(DP) :: x(3, MAX_FACE_NODES), force(3, MAX_FACE_NODES), stiffness(3 * MAX_FACE_NODES, 3 * MAX_FACE_NODES)
    real(DP), allocatable :: pressure_factors(:)
    integer :: n, rule
    associate (mesh => model%mesh, e => load%element)
      call find_load_face(model, e, load%face, fields%u, place)
      n = place%n_places
      x = place%X
      if (is_nlgeom) x = x + place%u
      rule = choose_face_rule(mesh%kind(e), place%kind, model%dialect == DIALECT_CALCULIX)
      if (load%is_user) then
        call evaluate_dload(model, load, place%kind, x(:, :n), fields, pressure_factors)
        call integrate_facet_pressure(place%kind, x, 1.0_DP, force, stiffness, pressure_factors)
      else if (has_faces_in_space(mesh%kind(e))) then
        call integrate_facet_pressure(place%kind, x, pressure, force, stiffness, rule=rule)
      else
        call integrate_edge_pressure(place%kind, x(:, :n), out_of_plane_depth(mesh, e), pressure, force, stiffness, rule)
      end if
    end associate
    call add_face_force(place, force, fields%applied_force)
    if (.not. (is_nlgeom .and. has_stiffness)) return
    associate (nodes => place%nodes(:place%n_nodes), of_nodes => spread_stiffness(place, stiffness))
      call subtract_symmetric_part(assembly, place%element, place%local(:place%n_nodes), nodes, of_nodes)
      call add_face_skew(assembly%skew, nodes, of_nodes)
    end associate
  end subroutine add_pressure


  !> Nodal forces of a force per reference area of a face.
  subroutine add_traction(model, e, face, traction, fields)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e, face                 !< element, number of its face
    real(DP), intent(in) :: traction(3)            !< [stress]
    type(fields_type), intent(inout) :: fields
    type(load_face_type) :: place
    call find_load_face(model, e, face, fields%u, place)
    call add_face_force(place, spread(traction, 2, place%n_places) * spread(integrate_nodal_areas(place%X(:, :place%n_places), &
      place%kind, out_of_plane_depth(model%mesh, e)), 1, 3), fields%applied_force)
  end subroutine add_traction


  !> Nodal forces of a traction by UTRACLOAD, per reference area.
  subroutine add_user_traction(model, load, fields, is_nlgeom)
    type(model_type), intent(in) :: model
    type(distributed_type), intent(in) :: load
    type(fields_type), intent(inout) :: fields
    logical, intent(in) :: is_nlgeom               !< the routine gets current places
    type(load_face_type) :: place
    real(DP) :: now(3, MAX_FACE_NODES), force(3, MAX_FACE_NODES)
    call find_load_face(model, load%element, load%face, fields%u, place)
    now = place%X
    if (is_nlgeom) now = now + place%u
    associate (n => place%n_places)
      call evaluate_utracload(model, load, place%kind, place%X(:, :n), now(:, :n), fields, force(:, :n))
    end associate
    call add_face_force(place, force, fields%applied_force)
  end subroutine add_user_traction


  !> K = K - (k + k')/2 for a face stiffness k, through the element's own table of positions.
  subroutine subtract_symmetric_part(assembly, e, local, nodes, stiffness)
    type(assembly_type), intent(inout) :: assembly
    integer, intent(in) :: e
    integer, intent(in) :: local(:)                !< numbers of some of its nodes in the element
    integer, intent(in) :: nodes(:)                !< of the mesh, the same nodes
    real(DP), intent(in) :: stiffness(:, :)
    real(DP) :: block(3, 3)
    integer :: i, j, a, b, k
    if (assembly%is_divided .and. .not. is_own_element(assembly, e)) return
    do j = 1, size(local)
      do i = 1, size(local)
        if (nodes(i) > nodes(j)) cycle
        a = local(i)
        b = local(j)
        k = assembly%pair_first(e) - 1 + max(a, b) * (max(a, b) - 1) / 2 + min(a, b)
        block = -0.5_DP * (stiffness(3 * i - 2:3 * i, 3 * j - 2:3 * j) &
          + transpose(stiffness(3 * j - 2:3 * j, 3 * i - 2:3 * i)))
        call add_row_block(assembly%stiffness, nodes(i), assembly%pair_offset(k), block)
      end do
    end do
  end subroutine subtract_symmetric_part


  !> Centrifugal forces of an element, in the current configuration under NLGEOM, with their exact stiffness.
  subroutine add_centrifugal_forces(assembly, model, load, omega2, fields, is_nlgeom, has_stiffness)
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(distributed_type), intent(in) :: load
    real(DP), intent(in) :: omega2                 !< square of the angular velocity [1/time^2]
    type(fields_type), intent(inout) :: fields
    logical, intent(in) :: is_nlgeom, has_stiffness
    real(DP) :: x(3, MAX_ELEMENT_NODES), spin(3, 3), force(3, MAX_ELEMENT_NODES), stiffness(3 * MAX_ELEMENT_NODES, &
      3 * MAX_ELEMENT_NODES)
    integer :: n, a, nodes(MAX_ELEMENT_NODES)
    call element_nodes(model%mesh, load%element, n, nodes)
    x(:, :n) = model%mesh%coordinates(:, nodes(:n))
    if (is_nlgeom) x(:, :n) = x(:, :n) + fields%u(:, nodes(:n))
    spin = reshape([load%point, load%direction, omega2 * evaluate_density(model, load%element, fields), 0.0_DP, 0.0_DP], [3, 3])
    call evaluate_centrifugal_forces(model%mesh%kind(load%element), model%mesh%coordinates(:, nodes(:n)), x(:, :n), &
      model%mesh%section_value(load%element), spin, force, stiffness, wall_ratios(model%mesh, load%element))
    do a = 1, n
      fields%applied_force(:, nodes(a)) = fields%applied_force(:, nodes(a)) + force(:, a)
    end do
    if (is_nlgeom .and. has_stiffness) call subtract_symmetric_part(assembly, load%element, [(a, a=1, n)], nodes(:n), &
      stiffness)
  end subroutine add_centrifugal_forces


  !> The density of an element; the section of a point mass is its mass.
  !!
  !! A temperature-dependent density is evaluated at the mean temperature of the nodes: in CalculiX at the current one, else, as in
  !! Abaqus, at the initial one, since mass is conserved.
  pure real(DP) function evaluate_density(model, e, fields) result(density)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    type(fields_type), intent(in) :: fields
    real(DP) :: values(1), temperature
    integer :: n, nodes(MAX_ELEMENT_NODES)
    density = 1
    if (model%mesh%kind(e) == KIND_MASS) return
    associate (material => model%materials(element_material(model, fields%step, e)))
      density = material%density
      if (.not. allocated(material%density_table%value)) return
      call element_nodes(model%mesh, e, n, nodes)
      temperature = 0
      if (allocated(model%initial_temperature)) temperature = sum(model%initial_temperature(nodes(:n))) / real(n, DP)
      if (model%dialect == DIALECT_CALCULIX) temperature = sum(fields%temperature(nodes(:n))) / real(n, DP)
      call evaluate_table(material%density_table, temperature, values)
      density = values(1)
    end associate
  end function evaluate_density


  !> Body force of an acceleration: mass is conserved, so it is integrated over the reference volume.
  subroutine add_body_force(model, e, is_by_volume, acceleration, fields)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    logical, intent(in) :: is_by_volume            !< .true.: a force per volume; a point mass has none
    real(DP), intent(in) :: acceleration(3)        !< [length/time^2] or [force/length^3]
    type(fields_type), intent(inout) :: fields
    real(DP) :: force(3, MAX_ELEMENT_NODES)
    real(DP) :: density
    integer :: n, a, nodes(MAX_ELEMENT_NODES)
    call element_nodes(model%mesh, e, n, nodes)
    density = evaluate_density(model, e, fields)
    if (is_by_volume) density = merge(0.0_DP, 1.0_DP, model%mesh%kind(e) == KIND_MASS)
    call integrate_body_force(model%mesh%kind(e), model%mesh%coordinates(:, nodes(:n)), model%mesh%section_value(e), &
      density * acceleration, force, wall_ratios(model%mesh, e))
    do a = 1, n
      fields%applied_force(:, nodes(a)) = fields%applied_force(:, nodes(a)) + force(:, a)
    end do
  end subroutine add_body_force


  !> Nodal forces f_a = rho omega^2 integral of N_a P (x - p) over the reference volume, P = 1 - a a', and their derivative
  !! rho omega^2 integral of N_a N_b P, which is symmetric. With x = sum N_b x_b both follow from one matrix.
  pure subroutine evaluate_centrifugal_forces(kind, X, x_now, section, spin, force, stiffness, walls)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: x_now(:, :)            !< (3, nodes) current coordinates [length]
    real(DP), intent(in) :: section                !< thickness [length], cross-section [length^2] or mass [mass]
    real(DP), intent(in) :: spin(3, 3)             !< columns: p, unit vector a, [rho omega^2, 0, 0]
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< zero past the nodes [force]
    real(DP), intent(out) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d x, set up to 3 * nodes
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    real(DP) :: mass(MAX_ELEMENT_NODES, MAX_ELEMENT_NODES), P(3, 3)
    integer :: a, b, n
    n = size(X, 2)
    force = 0
    call integrate_unit_mass(kind, X, section, mass, walls)
    P = IDENTITY - spread(spin(:, 2), 2, 3) * spread(spin(:, 2), 1, 3)
    if (kind >= KIND_CPS3 .and. kind <= KIND_CAX_SHELL) P(3, :) = 0   ! no component out of the plane
    P = spin(1, 3) * P
    do b = 1, n
      do a = 1, n
        force(:, a) = force(:, a) + mass(a, b) * matmul(P, x_now(:, b) - spin(:, 1))
        stiffness(3 * a - 2:3 * a, 3 * b - 2:3 * b) = mass(a, b) * P
      end do
    end do
  end subroutine evaluate_centrifugal_forces


  !> The consistent mass matrix of density 1, by full integration of the element; a point mass has its own.
  pure subroutine integrate_unit_mass(kind, X, section, mass, walls)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :), section
    real(DP), intent(out) :: mass(MAX_ELEMENT_NODES, MAX_ELEMENT_NODES)
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), volumes(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, &
      MAX_ELEMENT_NODES)
    integer :: rule, n_rule, p, b, status
    mass = 0
    if (kind == KIND_MASS) mass(1, 1) = section
    if (kind >= KIND_SPRINGA) return
    rule = merge(KIND_C3D8_FULL, kind, kind == KIND_C3D8R)
    call evaluate_point_volumes(rule, X, section, n_rule, volumes, status, walls)
    if (status /= ELEMENT_OK) return               ! the evaluation of the internal forces reports it
    call quadrature(rule, n_rule, xi, w, walls)
    do p = 1, n_rule
      call shape_functions(rule, xi(:, p), N, dN)
      do b = 1, size(X, 2)
        mass(:size(X, 2), b) = mass(:size(X, 2), b) + (N(b) * volumes(p)) * N(:size(X, 2))
      end do
    end do
  end subroutine integrate_unit_mass

end module amontons_external_loads
