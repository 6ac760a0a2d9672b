!> Postprocessing: nodal averages, stress error estimate, section and pair forces, CalculiX sector quantities.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Section forces follow CalculiX: the stress is extrapolated to the nodes, averaged there, and integrated over the faces, at
!! finite displacements over the current faces. So the force equals that of the loads only as far as the mesh resolves the stress.
!!
!! CalculiX expands axisymmetric elements to a solid sector of two degrees of the circle, and plane elements in the same model
!! to the same part of their thickness.
!! Volumes and energies are those of the sector, a 180th of the circle. Forces are sums of the spatial forces on the
!! nodes into which a node is expanded. The forces of the hoop stress on both sides of the sector point across the radius
!! and cancel except for their rotation by one degree, which the equations between these nodes take. So the
!! radial force is that of the radial and shear stresses alone.
!!
!! CalculiX expands trusses to bars of 8 points, of 27 with a middle node, with tensors in global axes.
module amontons_postprocess
  use amontons_kinds, only: DP, PI
  use amontons_beam_rules, only: is_beam_kind, interpolate_printed_points, MAX_PRINTED_POINTS
  use amontons_element_kinds, only: element_kind, kind_family, facet_kind, facet_kind_type, element_kind_type, is_one_point, &
    FAMILY_AXISYMMETRIC, MAX_ELEMENT_AMPLITUDES, &
    FAMILY_MEMBRANE, FAMILY_SPRING, has_faces_in_space, KIND_C3D6, KIND_C3D8, &
    KIND_C3D8_FULL, KIND_C3D8I, KIND_C3D10, KIND_C3D15, KIND_C3D15_LAYER, KIND_C3D20, KIND_C3D20R, &
    KIND_CAX4, KIND_CAX4_FULL, KIND_CAX4R, KIND_CAX6, KIND_CAX8, KIND_CAX8R, KIND_CPE4, KIND_CPE4_FULL, KIND_CPE6, KIND_CPE8, &
    KIND_CPE8R, KIND_CPS4I, KIND_CPE4I, KIND_CAX4I, &
    KIND_CPS4, KIND_CPS6, KIND_CPS8, KIND_CPS8R, KIND_T3D2, KIND_T3D3, MAX_FACE_NODES, MAX_ELEMENT_NODES, &
    MAX_ELEMENT_POINTS, N_KINDS, N_CIRCLE_SECTORS
  use amontons_mesh, only: mesh_type, element_nodes, wall_ratios
  use amontons_shape_functions, only: extrapolation_matrix, quadrature, shape_functions, choose_face_rule, facet_shapes, &
    facet_quadrature, &
    MAX_FACET_POINTS
  use amontons_tributary_areas, only: out_of_plane_depth
  use amontons_element, only: evaluate_point_volumes, set_temperature_weights
  use amontons_material_point, only: evaluate_thermal_strain
  use amontons_model, only: model_type, material_in_step, DIALECT_CALCULIX
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_SLIP
  use amontons_traction_separation, only: STATE_DELAYED, STATE_CRITERION
  use amontons_tensor, only: IDENTITY, cross_product, unpack_voigt, determinant_minus_one, double_dot, extreme_eigenvalues, &
    von_mises
  use amontons_surfaces, only: surface_type, BEHAVIOR_LINEAR, BEHAVIOR_USER
  use amontons_dual_shape_functions, only: is_transformed, BASIS_ALPHA
  use amontons_materials, only: HISTORY_PEEQ, HISTORY_CEEQ, HISTORY_INELASTIC, user_field_place
  implicit none
  private
  public :: average_at_nodes, estimate_error, integration_point_volumes, integration_point_positions
  public :: mechanical_strain
  public :: section_type, integrate_section
  public :: sector_share, convert_to_sector, rotate_truss_tensors, has_truss_axes, find_printed_points
  public :: nodal_slaves, n_nodal_slaves, printed_slip, printed_contact_energy
  public :: pair_sums_type, find_edge_corners, sum_pair_forces
  public :: add_inelastic_work, printed_energy_density, damage_variables

  real(DP), parameter :: EXTRAPOLATION_WEIGHT = 0.5_DP * (1 + sqrt(5.0_DP / 3.0_DP))   !< weight of the nearer point in a rule
                                                                                       !! of three [-]
  real(DP), parameter :: TRUSS_WEIGHTS(6) = [EXTRAPOLATION_WEIGHT, 1 - EXTRAPOLATION_WEIGHT, EXTRAPOLATION_WEIGHT, &
    1 - EXTRAPOLATION_WEIGHT, EXTRAPOLATION_WEIGHT, 1 - EXTRAPOLATION_WEIGHT]
  integer, parameter :: N_TENSOR = 6            !< components of a symmetric tensor

  !> Sums over a surface.
  type :: section_type
    real(DP) :: force(3) = 0                       !< on the body that the faces belong to [force]
    real(DP) :: moment(3) = 0                      !< about the origin [force length]
    real(DP) :: center(3) = 0                      !< of the area [length]
    real(DP) :: normal(3) = 0                      !< mean over the area, outward: shorter than 1 if curved
    real(DP) :: area = 0                           !< [length^2]
  end type section_type

  !> Sums over the closed slaves of a pair. Columns of matrices: pressure, friction (place: also both).
  type :: pair_sums_type
    real(DP) :: force(3, 2) = 0                    !< on the slave; of bodies of revolution x is the sum of radial forces [force]
    real(DP) :: moment(3, 2) = 0                   !< about the origin; of bodies of revolution in the half plane [force length]
    real(DP) :: place(3, 3) = 0                    !< mean of the positions weighted by force magnitude [length]
    real(DP) :: center(3) = 0                      !< of the area [length]
    real(DP) :: normal(3) = 0                      !< mean over the area, outward: shorter than 1 if curved
    real(DP) :: area = 0                           !< in contact [length^2]
  end type pair_sums_type

contains

  !> Extrapolates values from the integration points of each element to its nodes and takes the mean at each node.
  !!
  !! All elements at a node have equal weight, whatever their size or material (as in CalculiX); bodies in contact do not
  !! mix, since they share no node. Springs and masses have no stress and do not count. A node without elements gets 0.
  !! Cost: linear.
  !!
  !! With `is_calculix`, springs and gaps of two nodes count as elements without stress, the points of C3D6 are extrapolated to
  !! the nodes one by one, as far as those of a rule of three points, and beams and layers of C3D15 as `extrapolation_matrix` says.
  !!
  !! With `elements` and `place` it takes those nodes alone which have a place, and all elements at them.
  subroutine average_at_nodes(mesh, is_absent, values, averages, is_calculix, elements, place)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)         !< (n_elements) removed, not counted
    real(DP), intent(in) :: values(:, :)        !< (n_components, n_points)
    real(DP), intent(out) :: averages(:, :)     !< (n_components, n_nodes), or (n_components, places); same unit
    logical, intent(in), optional :: is_calculix    !< default .false.
    integer, intent(in), optional :: elements(:)    !< ascending
    integer, intent(in), optional :: place(:)       !< (n_nodes) column of averages, or 0
    real(DP), allocatable :: matrix(:, :, :)    ! (nodes, points, N_KINDS) on the heap: it would fill a small stack
    logical :: is_made(N_KINDS)
    integer :: n_elements_at(0:size(averages, 2))
    type(element_kind_type) :: entry
    integer :: i, e, a, p, n, n_points, n_counted, kind, first, nodes(MAX_ELEMENT_NODES)
    logical :: is_as_there
    is_as_there = .false.
    if (present(is_calculix)) is_as_there = is_calculix
    is_made = .false.
    averages = 0
    if (.not. any(values /= 0.0_DP)) return       ! before the first increment; NaN differs
    allocate (matrix(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, N_KINDS))
    n_elements_at = 0
    kind = 0
    n_counted = mesh%n_elements
    if (present(elements)) n_counted = size(elements)
    do i = 1, n_counted
      e = i
      if (present(elements)) e = elements(i)
      if (is_absent(e)) cycle
      if (mesh%kind(e) /= kind) entry = element_kind(mesh%kind(e))
      kind = mesh%kind(e)
      if (entry%family >= FAMILY_SPRING) then
        if (is_as_there .and. entry%n_nodes == 2) call count_spring(mesh, e, n_elements_at(1:))
        cycle
      end if
      if (.not. is_made(kind) .or. is_beam_kind(kind)) call extrapolation_matrix(kind, matrix(:, :, kind), n, n_points, &
        wall_ratios(mesh, e), is_as_there)
      if (is_as_there .and. kind == KIND_C3D6) matrix(:6, :2, kind) = reshape([TRUSS_WEIGHTS, 1 - TRUSS_WEIGHTS], [6, 2])
      is_made(kind) = .true.
      call element_nodes(mesh, e, n, nodes)
      if (present(place)) nodes(:n) = place(nodes(:n))
      first = mesh%point_first(e)
      n_points = mesh%point_first(e + 1) - first
      n_elements_at(nodes(:n)) = n_elements_at(nodes(:n)) + 1
      if (size(values, 1) == N_TENSOR) then
        call add_tensors(matrix(:, :, kind), values(:, first:first + n_points - 1), nodes(:n), averages)
        cycle
      end if
      do a = 1, n
        if (nodes(a) == 0) cycle
        do p = 1, n_points
          averages(:, nodes(a)) = averages(:, nodes(a)) + matrix(a, p, kind) * values(:, first + p - 1)
        end do
      end do
    end do
    do a = 1, size(averages, 2)
      averages(:, a) = averages(:, a) / real(max(1, n_elements_at(a)), DP)
    end do
  end subroutine average_at_nodes


  !> A spring counts at its nodes.
  pure subroutine count_spring(mesh, e, n_elements_at)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                    !< element
    integer, intent(inout) :: n_elements_at(:)  !< (n_nodes)
    integer :: n, nodes(MAX_ELEMENT_NODES)
    call element_nodes(mesh, e, n, nodes)
    n_elements_at(nodes(:n)) = n_elements_at(nodes(:n)) + 1
  end subroutine count_spring


  !> Extrapolates the tensors of one element and adds them at its nodes.
  pure subroutine add_tensors(matrix, values, nodes, averages)
    real(DP), intent(in) :: matrix(:, :)        !< (MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    real(DP), intent(in) :: values(:, :)        !< (6, n_points)
    integer, intent(in) :: nodes(:)             !< columns of averages; 0: none
    real(DP), intent(inout) :: averages(:, :)   !< (6, n_nodes)
    real(DP) :: here(N_TENSOR)
    integer :: a, p
    do a = 1, size(nodes)
      if (nodes(a) == 0) cycle
      here = averages(:N_TENSOR, nodes(a))
      do p = 1, size(values, 2)
        here = here + matrix(a, p) * values(:N_TENSOR, p)
      end do
      averages(:N_TENSOR, nodes(a)) = here
    end do
  end subroutine add_tensors


  !> Estimate of the relative stress error at the nodes in per cent, as in CalculiX.
  !!
  !! Per element: the spread over its points of the principal stress with the largest magnitude, over that stress. The largest
  !! spread of the elements at a corner is converted to an error by lines fitted to known solutions, max(a x, b x - c), which depend
  !! on the kind of element; a mid-side node has the mean of the edge's ends. Elements of one point, wedges of six nodes and trusses
  !! have no lines and do not contribute.
  !! Reference: CalculiX (2.20), errorestimator.f, for the figures of the lines.
  subroutine estimate_error(mesh, is_absent, stress, errors)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)            !< (n_elements) removed, not counted
    real(DP), intent(in) :: stress(:, :)           !< (6, n_points)
    real(DP), intent(out) :: errors(:)             !< (n_nodes) [%]
    real(DP) :: scatter(mesh%n_nodes)              ! largest spread of the elements at a corner [-]
    real(DP), allocatable :: spread(:)             ! (n_elements) [-]
    integer :: e, a, n, n_corners, pass, kind, nodes(MAX_ELEMENT_NODES), ends(2, MAX_ELEMENT_NODES)
    type(element_kind_type) :: entry
    scatter = 0
    errors = 0
    allocate (spread(mesh%n_elements), source=0.0_DP)
    !$omp parallel do schedule(static)
    do e = 1, mesh%n_elements
      if (is_absent(e) .or. mesh%point_first(e + 1) == mesh%point_first(e)) cycle
      spread(e) = stress_spread(stress(:, mesh%point_first(e):mesh%point_first(e + 1) - 1))
    end do
    !$omp end parallel do
    kind = 0
    do pass = 1, 3
      do e = 1, mesh%n_elements
        if (mesh%kind(e) /= kind) then
          kind = mesh%kind(e)
          entry = element_kind(kind)
          if (entry%family <= FAMILY_AXISYMMETRIC) call find_edges(entry, n_corners, ends)
        end if
        if (is_absent(e) .or. entry%family > FAMILY_AXISYMMETRIC) cycle
        call element_nodes(mesh, e, n, nodes)
        select case (pass)
        case (1)
          scatter(nodes(:n_corners)) = max(scatter(nodes(:n_corners)), spread(e))
        case (2)
          errors(nodes(:n_corners)) = max(errors(nodes(:n_corners)), error_from_spread(mesh%kind(e), scatter(nodes(:n_corners))))
        case (3)
          do a = n_corners + 1, n
            errors(nodes(a)) = 0.5_DP * sum(errors(nodes(ends(:, a))))
          end do
        end select
      end do
    end do
  end subroutine estimate_error


  !> Number of corners of an element, and the corners at both ends of the edge of each mid-side node.
  pure subroutine find_edges(entry, n_corners, ends)
    type(element_kind_type), intent(in) :: entry
    integer, intent(out) :: n_corners
    integer, intent(out) :: ends(2, MAX_ELEMENT_NODES)     !< local nodes; 0 for corners
    type(facet_kind_type) :: facet
    integer :: i, j
    ends = 0
    do i = 1, entry%n_faces
      facet = facet_kind(entry%face_kind(i))
      do j = 1, facet%n_nodes - facet%n_corners
        ends(:, entry%face_nodes(facet%n_corners + j, i)) = entry%face_nodes([j, mod(j, facet%n_corners) + 1], i)
      end do
    end do
    n_corners = entry%n_nodes - count(ends(1, :) > 0)
  end subroutine find_edges


  !> Relative spread over the points of an element of the principal stress with the largest magnitude [-].
  pure real(DP) function stress_spread(stress) result(spread)
    real(DP), intent(in) :: stress(:, :)           !< (6, n_points)
    real(DP) :: ends(2), low(2), high(2)
    integer :: p, k
    low = huge(1.0_DP)
    high = -huge(1.0_DP)
    do p = 1, size(stress, 2)
      ends = extreme_eigenvalues(stress(:, p))
      low = min(low, ends)
      high = max(high, ends)
    end do
    k = merge(2, 1, high(2) >= -low(1))
    spread = 0
    if (max(abs(low(k)), abs(high(k))) > tiny(1.0_DP)) spread = (high(k) - low(k)) / max(abs(low(k)), abs(high(k)))
  end function stress_spread


  !> The stress error for a spread [%].
  elemental real(DP) function error_from_spread(kind, spread) result(error)
    integer, intent(in) :: kind
    real(DP), intent(in) :: spread                 !< [-]
    real(DP) :: a, b, c
    a = 0
    b = 0
    c = 0
    select case (kind)
    case (KIND_C3D10)
      a = 30.0_DP
    case (KIND_C3D15, KIND_C3D15_LAYER, KIND_CPS6, KIND_CPE6, KIND_CAX6)
      a = 46.189_DP
    case (KIND_C3D20)
      a = 5.115_DP
      b = 27.792_DP
      c = 5.895_DP
    case (KIND_C3D20R)
      a = 20.278_DP
      b = 74.318_DP
      c = 9.727_DP
    case (KIND_C3D8I)
      a = 30.303_DP
      b = 139.535_DP
      c = 18.023_DP
    case (KIND_C3D8, KIND_C3D8_FULL)
      a = 31.847_DP
      b = 85.324_DP
      c = 8.396_DP
    case (KIND_CPS4, KIND_CPE4, KIND_CPE4_FULL, KIND_CAX4, KIND_CAX4_FULL, KIND_CPS4I, KIND_CPE4I, KIND_CAX4I)   ! as CPS4
      a = 74.074_DP
    case (KIND_CPS8, KIND_CPE8, KIND_CAX8)
      a = 9.538_DP
      b = 53.695_DP
      c = 14.351_DP
    case (KIND_CPS8R, KIND_CPE8R, KIND_CAX8R)
      a = 54.054_DP
    end select
    error = max(a * spread, b * spread - c)
  end function error_from_spread


  !> Coordinates of the integration points for given coordinates of the nodes. Points of springs and masses are at the centre.
  subroutine integration_point_positions(mesh, x, places)
    type(mesh_type), intent(in) :: mesh
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(out) :: places(:, :)          !< (3, n_points) [length]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), shape(MAX_ELEMENT_NODES), slope(3, MAX_ELEMENT_NODES)
    integer :: e, p, n, n_rule, nodes(MAX_ELEMENT_NODES)
    do e = 1, mesh%n_elements
      call element_nodes(mesh, e, n, nodes)
      associate (kind => element_kind(mesh%kind(e)))
        n_rule = 0
        if (kind%family <= FAMILY_MEMBRANE) call quadrature(mesh%kind(e), n_rule, xi, w, wall_ratios(mesh, e))
      end associate
      shape(:n) = 1 / real(n, DP)
      do p = 1, mesh%point_first(e + 1) - mesh%point_first(e)
        if (n_rule > 0) call shape_functions(mesh%kind(e), xi(:, p), shape, slope)
        places(:, mesh%point_first(e) + p - 1) = matmul(x(:, nodes(:n)), shape(:n))
      end do
    end do
  end subroutine integration_point_positions


  !> The reference volume of each integration point of an element: weight times Jacobian.
  pure subroutine integration_point_volumes(mesh, e, n, volumes)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element index
    integer, intent(out) :: n                      !< number of its points
    real(DP), intent(out) :: volumes(MAX_ELEMENT_POINTS)   !< (MAX_ELEMENT_POINTS) the first n are set, 0 past n [length^3]
    integer :: n_nodes, status, nodes(MAX_ELEMENT_NODES)
    call element_nodes(mesh, e, n_nodes, nodes)
    call evaluate_point_volumes(mesh%kind(e), mesh%coordinates(:, nodes(:n_nodes)), mesh%section_value(e), n, volumes, status, &
      wall_ratios(mesh, e))
  end subroutine integration_point_volumes


  !> Total strain less thermal strain, elastic and inelastic together (ME of EL PRINT).
  pure function mechanical_strain(model, fields) result(strain)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields        !< committed
    real(DP) :: strain(6, model%mesh%n_points)     !< tensor components, xx yy zz xy yz xz [-]
    real(DP) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), frame(3, 3), temperature(2), field(2)
    logical :: is_nlgeom
    integer :: e, p, i, k, n, nodes(MAX_ELEMENT_NODES)
    is_nlgeom = model%steps(max(1, fields%step))%is_nlgeom
    strain = fields%strain
    do e = 1, model%mesh%n_elements
      associate (m => max(1, material_in_step(model, fields%step, e)))
        if (.not. allocated(model%materials(m)%expansion%value)) cycle
        call element_nodes(model%mesh, e, n, nodes)
        call set_temperature_weights(model%mesh%kind(e), weight, wall_ratios(model%mesh, e))
        do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
          i = p - model%mesh%point_first(e) + 1
          k = model%materials(m)%table_variable * model%mesh%n_nodes
          temperature = [0.0_DP, dot_product(weight(:n, i), fields%temperature(nodes(:n)))]
          field = [0.0_DP, dot_product(weight(:n, i), fields%temperature(k + nodes(:n)))]
          if (allocated(model%initial_temperature)) then
            temperature(1) = dot_product(weight(:n, i), model%initial_temperature(nodes(:n)))
            field(1) = dot_product(weight(:n, i), model%initial_temperature(k + nodes(:n)))
          end if
          if (model%materials(m)%is_user_field) field(2) = fields%history(user_field_place(model%materials(m), &
            model%materials(m)%table_variable), p)
          frame = IDENTITY
          if (allocated(fields%frame)) frame = fields%frame(:, :, p)
          strain(:, p) = strain(:, p) - evaluate_thermal_strain(model%materials(m), temperature, field, frame, is_nlgeom)
        end do
      end associate
    end do
  end function mechanical_strain


  !> Sums over a surface of element faces.
  subroutine integrate_section(mesh, is_absent, surface, fields, is_nlgeom, is_calculix, section)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)            !< (n_elements) removed, not counted
    type(surface_type), intent(in) :: surface      !< of element faces
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom               !< current faces instead of reference ones
    logical, intent(in) :: is_calculix             !< nodal averages as in CalculiX
    type(section_type), intent(out) :: section
    real(DP) :: stress(6, mesh%n_nodes)
    integer :: i
    call average_at_nodes(mesh, is_absent, fields%stress, stress, is_calculix)
    do i = 1, size(surface%element)
      call add_face(mesh, surface%element(i), surface%face(i), fields, stress, is_nlgeom, section)
    end do
    if (.not. section%area > 0) return
    section%center = section%center / section%area
    section%normal = section%normal / section%area
  end subroutine integrate_section


  !> Adds one face. Faces of a plane body are edges extruded over its thickness, symmetric to its plane.
  subroutine add_face(mesh, e, face, fields, stress, is_nlgeom, section)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e, face
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: stress(:, :)           !< (6, n_nodes) [stress]
    logical, intent(in) :: is_nlgeom
    type(section_type), intent(inout) :: section
    type(element_kind_type) :: kind
    integer :: nodes(MAX_FACE_NODES), n, n_points, p
    real(DP) :: x(3, MAX_FACE_NODES), xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), at(3), along(3, 2), a(3), f(3)
    real(DP) :: shape(MAX_FACE_NODES), slope(2, MAX_FACE_NODES), bend(3, MAX_FACE_NODES)
    kind = element_kind(mesh%kind(e))
    n = count(kind%face_nodes(:, face) > 0)
    nodes(:n) = mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(:n, face))
    x(:, :n) = mesh%coordinates(:, nodes(:n))
    if (is_nlgeom) x(:, :n) = x(:, :n) + fields%u(:, nodes(:n))
    call facet_quadrature(choose_face_rule(mesh%kind(e), kind%face_kind(face), .true.), n_points, xi, w)
    do p = 1, n_points
      call facet_shapes(kind%face_kind(face), xi(:, p), shape, slope, bend)
      at = matmul(x(:, :n), shape(:n))
      along = matmul(x(:, :n), transpose(slope(:, :n)))
      if (.not. has_faces_in_space(mesh%kind(e))) along(:, 2) = [0.0_DP, 0.0_DP, out_of_plane_depth(mesh, e)]
      a = w(p) * cross_product(along(:, 1), along(:, 2))
      f = matmul(unpack_voigt(matmul(stress(:, nodes(:n)), shape(:n))), a)
      section%force = section%force + f
      section%moment = section%moment + cross_product(at, f)
      section%center = section%center + norm2(a) * at
      section%normal = section%normal + a
      section%area = section%area + norm2(a)
    end do
  end subroutine add_face


  !> The part of an element in CalculiX's sector: 1 except in models of its dialect with axisymmetric elements.
  pure real(DP) function sector_share(model) result(share)
    type(model_type), intent(in) :: model
    integer :: e
    share = 1
    if (model%dialect /= DIALECT_CALCULIX) return
    do e = 1, model%mesh%n_elements
      if (is_axisymmetric(model%mesh, e)) share = 1.0_DP / N_CIRCLE_SECTORS
      if (share < 1) return
    end do
  end function sector_share


  !> The points of CalculiX's tables, if they are others than here: rows of the solid to which it expands a truss, all with the mean
  !! of its points; the points of boxes by interpolation.
  pure subroutine find_printed_points(model, e, n, matrix)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                       !< element
    integer, intent(out) :: n                      !< rows of the table; 0: those of the element
    real(DP), intent(out) :: matrix(MAX_PRINTED_POINTS, MAX_ELEMENT_POINTS)   !< table = matrix * points
    n = 0
    matrix = 0
    if (model%dialect /= DIALECT_CALCULIX) return
    if (is_beam_kind(model%mesh%kind(e))) call interpolate_printed_points(model%mesh%kind(e), n, matrix)
    if (.not. is_truss(model%mesh, e)) return
    n = merge(8, 27, model%mesh%kind(e) == KIND_T3D2)
    associate (m => model%mesh%point_first(e + 1) - model%mesh%point_first(e))
      matrix(:n, :m) = 1 / real(m, DP)
    end associate
  end subroutine find_printed_points


  !> Tensors at the points, those of trusses rotated from their axis to global axes, as in CalculiX.
  pure function rotate_truss_tensors(model, fields, is_current, values) result(turned)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_current              !< along the truss in the current configuration
    real(DP), intent(in) :: values(:, :)           !< (6, n_points) of trusses: xx along them
    real(DP) :: turned(6, size(values, 2))
    real(DP) :: chord(3)
    integer :: e, p, n, nodes(MAX_ELEMENT_NODES)
    turned = values
    if (.not. has_truss_axes(model)) return
    do e = 1, model%mesh%n_elements
      if (.not. is_truss(model%mesh, e)) cycle
      call element_nodes(model%mesh, e, n, nodes)
      chord = model%mesh%coordinates(:, nodes(2)) - model%mesh%coordinates(:, nodes(1))
      if (is_current) chord = chord + fields%u(:, nodes(2)) - fields%u(:, nodes(1))
      chord = chord / norm2(chord)
      do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
        associate (along => values(1, p), across => values(2, p))
          turned(:3, p) = across + (along - across) * chord**2
          turned(4:, p) = (along - across) * [chord(1) * chord(2), chord(2) * chord(3), chord(1) * chord(3)]
        end associate
      end do
    end do
  end function rotate_truss_tensors


  !> Whether tensors of trusses are printed along the global axes, those of their points along the truss.
  pure logical function has_truss_axes(model)
    type(model_type), intent(in) :: model
    has_truss_axes = model%dialect == DIALECT_CALCULIX .and. &
      (any(model%mesh%kind == KIND_T3D2) .or. any(model%mesh%kind == KIND_T3D3))
  end function has_truss_axes


  !> Whether an element is a truss.
  pure logical function is_truss(mesh, e)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    is_truss = mesh%kind(e) == KIND_T3D2 .or. mesh%kind(e) == KIND_T3D3
  end function is_truss


  !> Converts the forces of the full circle on the nodes of axisymmetric elements to those that CalculiX prints.
  pure subroutine convert_to_sector(mesh, is_absent, fields, is_nlgeom, force)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)            !< (n_elements) removed, not counted
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom
    real(DP), intent(inout) :: force(:, :)         !< (3, n_nodes) [force]
    logical :: has_circle
    real(DP) :: hoop(MAX_ELEMENT_NODES)
    integer :: e, a, n, nodes(MAX_ELEMENT_NODES)
    has_circle = .false.
    do e = 1, mesh%n_elements
      if (.not. is_axisymmetric(mesh, e) .or. is_absent(e)) cycle
      call element_nodes(mesh, e, n, nodes)
      has_circle = .true.
      call hoop_forces(mesh, e, fields, is_nlgeom, hoop)
      do a = 1, n
        force(1, nodes(a)) = force(1, nodes(a)) - hoop(a)
      end do
    end do
    if (has_circle) force = force / N_CIRCLE_SECTORS
  end subroutine convert_to_sector


  !> Whether an element is axisymmetric.
  pure logical function is_axisymmetric(mesh, e)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    is_axisymmetric = .false.
    if (mesh%kind(e) > 0) is_axisymmetric = kind_family(mesh%kind(e)) == FAMILY_AXISYMMETRIC
  end function is_axisymmetric


  !> The radial forces of the hoop stress on the nodes of an element: sum of N_a/x tau V. Of finite strain Kirchhoff's
  !! stress comes from Cauchy's and from Green's strain, which the calculix dialect keeps.
  pure subroutine hoop_forces(mesh, e, fields, is_nlgeom, hoop)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    type(fields_type), intent(in) :: fields
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: hoop(MAX_ELEMENT_NODES)       !< [force]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), &
      share(MAX_ELEMENT_POINTS)
    real(DP) :: J(2, 2), X(2, MAX_ELEMENT_NODES), tau, stretch
    integer :: rule, p, q, m, n_rule, n_nodes, nodes(MAX_ELEMENT_NODES)
    call element_nodes(mesh, e, n_nodes, nodes)
    X(:, :n_nodes) = mesh%coordinates(:2, nodes(:n_nodes))
    rule = mesh%kind(e)
    if (rule == KIND_CAX4R) rule = KIND_CPE4_FULL  ! one point, but the mean of four
    call quadrature(rule, n_rule, xi, w)
    m = mesh%point_first(e + 1) - mesh%point_first(e)
    hoop = 0
    do p = 1, n_rule
      call shape_functions(rule, xi(:, p), N, dN)
      J = matmul(X(:, :n_nodes), transpose(dN(:2, :n_nodes)))
      share(p) = w(p) * (J(1, 1) * J(2, 2) - J(1, 2) * J(2, 1)) * 2 * PI   ! volume over the radius
      q = mesh%point_first(e) + min(p, m) - 1
      tau = fields%stress(3, q)
      stretch = 1
      if (is_nlgeom) then
        stretch = sqrt(1 + 2 * fields%strain(3, q))
        tau = tau * sqrt(1 + determinant_minus_one(2 * unpack_voigt(fields%strain(:, q))))
      end if
      hoop(:n_nodes) = hoop(:n_nodes) + share(p) * tau / stretch * N(:n_nodes)
    end do
  end subroutine hoop_forces


  !> Number of slaves of `nodal_slaves`: constant during a job.
  pure integer function n_nodal_slaves(model, slaves) result(n)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    integer :: p
    n = count(slaves%slave_facet == 0)
    do p = 1, size(model%pairs)
      if (model%pairs(p)%has_point_contact) n = n + size(model%surfaces(model%pairs(p)%slave)%nodes)
    end do
  end function n_nodal_slaves


  !> The slave nodes, and for a pair with points each node of its slave surface with the sums of the points around it.
  !!
  !! A point contributes to the nodes of its face by the positive shape functions there, so that no node has tension: forces,
  !! areas and energies as sums, gap, normal and slip as means over the areas. A node is closed if one of its points is closed, and
  !! slips if one slips.
  function nodal_slaves(model, slaves) result(nodal)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    type(slave_state_type), allocatable :: nodal(:)
    integer, allocatable :: at(:)                  ! (n_nodes) index of a node among those of the pair
    integer :: p, i, before
    nodal = pack(slaves, slaves%slave_facet == 0)
    do p = 1, size(model%pairs)
      if (.not. model%pairs(p)%has_point_contact) cycle
      before = size(nodal)
      associate (nodes => model%surfaces(model%pairs(p)%slave)%nodes)
        allocate (at(model%mesh%n_nodes), source=0)
        at(nodes) = [(before + i, i=1, size(nodes))]
        nodal = [nodal, [(slave_state_type(pair=p, node=nodes(i)), i=1, size(nodes))]]
      end associate
      do i = 1, size(slaves)
        if (slaves(i)%pair == p) call add_point_to_nodes(model, slaves(i), at, nodal)
      end do
      do i = before + 1, size(nodal)
        call divide_by_area(nodal(i))
      end do
      deallocate (at)
    end do
  end function nodal_slaves


  !> Adds the contribution of one point to the nodes of its face.
  subroutine add_point_to_nodes(model, point, at, nodal)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: point
    integer, intent(in) :: at(:)                   !< (n_nodes)
    type(slave_state_type), intent(inout) :: nodal(:)
    integer :: nodes(MAX_FACE_NODES), n, i
    real(DP) :: N_i(MAX_FACE_NODES), share
    call face_of(model, point, n, nodes, N_i)
    N_i(:n) = max(N_i(:n), 0.0_DP)
    do i = 1, n
      share = N_i(i) / sum(N_i(:n))
      associate (node => nodal(at(nodes(i))))
        node%area = node%area + share * point%area
        node%gap = node%gap + share * point%area * point%gap
        node%normal = node%normal + share * point%area * point%normal
        node%slip = node%slip + share * point%area * point%slip
        node%elastic = node%elastic + share * point%area * point%elastic
        node%slip_increment = node%slip_increment + share * point%area * point%slip_increment
        node%force = node%force + share * point%force
        node%shear = node%shear + share * point%shear
        node%energy = node%energy + share * point%energy
        if (share > 0.0_DP) node%facet = point%facet
        if (point%status == STATUS_OPEN .or. share <= 0.0_DP) cycle
        node%status = max(node%status, point%status)
        if (point%status == STATUS_SLIP) node%scenario = max(node%scenario, point%scenario)
      end associate
    end do
  end subroutine add_point_to_nodes


  !> Divides sums by areas to get means.
  pure subroutine divide_by_area(node)
    type(slave_state_type), intent(inout) :: node
    if (node%area <= 0.0_DP) return
    node%gap = node%gap / node%area
    node%slip = node%slip / node%area
    node%elastic = node%elastic / node%area
    node%slip_increment = node%slip_increment / node%area
    node%normal = node%normal / max(norm2(node%normal), tiny(1.0_DP))
  end subroutine divide_by_area


  !> The nodes of the face of a point and their shape functions there.
  subroutine face_of(model, point, n, nodes, N_i)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: point
    integer, intent(out) :: n
    integer, intent(out) :: nodes(MAX_FACE_NODES)
    real(DP), intent(out) :: N_i(MAX_FACE_NODES)   !< [-]
    real(DP) :: dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    type(element_kind_type) :: kind
    associate (surface => model%surfaces(model%pairs(point%pair)%slave), mesh => model%mesh)
      associate (e => surface%element(point%slave_facet), face => surface%face(point%slave_facet))
        kind = element_kind(mesh%kind(e))
        n = count(kind%face_nodes(:, face) > 0)
        nodes = 0
        nodes(:n) = mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(:n, face))
        call facet_shapes(kind%face_kind(face), point%at, N_i, dN, ddN)
      end associate
    end associate
  end subroutine face_of


  !> The slip of a slave for tables and fields: zero for CalculiX's springs without friction.
  pure function printed_slip(model, slave) result(slip)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slave
    real(DP) :: slip(3)                            !< [length]
    slip = slave%slip + slave%elastic
    if (model%dialect /= DIALECT_CALCULIX .or. slave%row > 0 .and. slave%slave_facet == 0 .or. norm2(slave%elastic) > 0.0_DP) return
    associate (law => model%interactions(model%pairs(slave%pair)%interaction))
      if (law%friction > 0.0_DP) return            ! shear: a calling program may have set friction
      if (law%is_user_friction .or. law%behavior == BEHAVIOR_USER .or. all(slave%shear == 0.0_DP)) slip = 0.0_DP
    end associate
  end function printed_slip


  !> The energy of a slave's spring for CONTACT PRINT. CalculiX multiplies the elastic slip by the full shear instead of half of it,
  !! and under LINEAR takes half the pressure times the overclosure at slave nodes.
  pure real(DP) function printed_contact_energy(model, slave) result(energy)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slave
    real(DP) :: shear_part                         ! half of it
    energy = slave%energy
    if (model%dialect /= DIALECT_CALCULIX .or. slave%row > 0 .and. slave%slave_facet == 0) return
    shear_part = -0.5_DP * dot_product(slave%shear, slave%elastic)
    energy = energy + shear_part
    if (slave%slave_facet > 0 .or. model%pairs(slave%pair)%has_point_contact) return   ! a point, or a node with sums of points
    if (model%interactions(model%pairs(slave%pair)%interaction)%behavior == BEHAVIOR_LINEAR) &
      energy = 2 * shear_part - 0.5_DP * dot_product(slave%force, slave%normal) * slave%gap
  end function printed_contact_energy


  !> Sums over the closed ones of some slaves; all are of one pair.
  subroutine sum_pair_forces(model, u, slaves, sums)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    type(slave_state_type), intent(in) :: slaves(:)
    type(pair_sums_type), intent(out) :: sums
    integer, allocatable :: ends(:, :)             ! (2, n_nodes)
    real(DP) :: f(3, 2), x(3), size_of(3), weight(3)
    integer :: i, k
    if (all(slaves%status == STATUS_OPEN)) return
    associate (pair => model%pairs(slaves(1)%pair))
      if (pair%is_mortar .and. .not. pair%has_point_contact) call find_edge_corners(model, pair%slave, .true., ends)
    end associate
    weight = 0.0_DP
    do i = 1, size(slaves)
      associate (slave => slaves(i))
        if (slave%status == STATUS_OPEN) cycle
        x = force_position(model, slave, u, ends)
        f = reshape([slave%force, slave%shear], [3, 2])
        do k = 1, 2
          sums%moment(:, k) = sums%moment(:, k) + cross_product(x, f(:, k))
        end do
        size_of = [norm2(f, dim=1), norm2(sum(f, dim=2))]
        sums%place = sums%place + spread(x, 2, 3) * spread(size_of, 1, 3)
        weight = weight + size_of
        sums%force = sums%force + f
        sums%center = sums%center + slave%area * x
        sums%normal = sums%normal - slave%area * slave%normal
        sums%area = sums%area + slave%area
      end associate
    end do
    do k = 1, 3
      if (weight(k) > 0.0_DP) sums%place(:, k) = sums%place(:, k) / weight(k)
    end do
    if (.not. sums%area > 0.0_DP) return
    sums%center = sums%center / sums%area
    sums%normal = sums%normal / sums%area
  end subroutine sum_pair_forces


  !> Position of a slave's force: its node, its point on the face, or, for quadratic faces of a mortar pair, the transformed
  !! node (doc/theory/contact.md, "Quadratic slave faces").
  function force_position(model, slave, u, ends) result(x)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slave
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) displacement [length]
    integer, allocatable, intent(in) :: ends(:, :) !< (2, n_nodes) corners beside mid-side nodes of a mortar pair
    real(DP) :: x(3)                               !< [length]
    integer :: nodes(MAX_FACE_NODES), n
    real(DP) :: N_i(MAX_FACE_NODES)
    associate (coordinates => model%mesh%coordinates)
      x = coordinates(:, slave%node) + u(:, slave%node) + slave%force_arm
      if (slave%slave_facet > 0) then
        call face_of(model, slave, n, nodes, N_i)
        x = matmul(coordinates(:, nodes(:n)) + u(:, nodes(:n)), N_i(:n))
      else if (allocated(ends)) then
        if (ends(1, slave%node) == 0 .or. norm2(slave%force_arm) > 0.0_DP) return
        nodes(:2) = ends(:, slave%node)
        x = (x - BASIS_ALPHA * sum(coordinates(:, nodes(:2)) + u(:, nodes(:2)), dim=2)) / (1 - 2 * BASIS_ALPHA)
      end if
    end associate
  end function force_position


  !> The corners beside each mid-side node of the faces of a surface, 0 at all other nodes.
  subroutine find_edge_corners(model, surface, is_of_mortar, ends)
    type(model_type), intent(in) :: model
    integer, intent(in) :: surface                 !< index
    logical, intent(in) :: is_of_mortar            !< only faces with a transformed basis
    integer, allocatable, intent(out) :: ends(:, :)   !< (2, n_nodes)
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    integer :: f, k, m, nodes(MAX_FACE_NODES)
    allocate (ends(2, model%mesh%n_nodes), source=0)
    associate (mesh => model%mesh, faces => model%surfaces(surface))
      if (faces%is_node_based) return
      do f = 1, size(faces%element)
        kind = element_kind(mesh%kind(faces%element(f)))
        shape = facet_kind(kind%face_kind(faces%face(f)))
        m = shape%n_corners
        if (is_of_mortar .and. .not. is_transformed(kind%face_kind(faces%face(f)))) cycle
        nodes(:shape%n_nodes) = mesh%nodes(mesh%first(faces%element(f)) - 1 + kind%face_nodes(:shape%n_nodes, faces%face(f)))
        do k = m + 1, shape%n_nodes
          ends(:, nodes(k)) = [nodes(k - m), nodes(mod(k - m, m) + 1)]
        end do
      end do
    end associate
  end subroutine find_edge_corners


  !> Adds the work of the stresses on the plastic and creep strains between two states (trapezoidal rule): q (dp + dc) where
  !! the flow follows von Mises, T : d_eps_p with kinematic hardening, where rotations within the increment are taken as small.
  !! User materials and linear bodies do not contribute. Cost: linear in the points.
  pure subroutine add_inelastic_work(model, old, new)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: old
    type(fields_type), intent(inout) :: new        !< out: dissipated, plastic_work
    real(DP) :: change(size(old%history, 1)), work
    integer :: e, m, p
    new%plastic_work = old%plastic_work
    if (size(new%dissipated) == 0) return
    new%dissipated = old%dissipated
    do e = 1, model%mesh%n_elements
      m = material_in_step(model, new%step, e)
      if (m == 0) cycle
      associate (material => model%materials(m))
        if (material%is_user .or. material%is_linear_isotropic) cycle
        do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
          change = new%history(:, p) - old%history(:, p)
          if (allocated(material%damage)) then
            work = 0.5_DP * double_dot(old%stress(:, p) + new%stress(:, p), new%strain(:, p) - old%strain(:, p)) - &
              (new%energy(p) - old%energy(p))
          else if (allocated(material%kinematic_hardening)) then
            work = 0.5_DP * double_dot(old%stress(:, p) + new%stress(:, p), change(HISTORY_INELASTIC:HISTORY_INELASTIC + 5))
          else
            work = 0.5_DP * (von_mises(old%stress(:, p)) + von_mises(new%stress(:, p))) * &
              (change(HISTORY_PEEQ) + change(HISTORY_CEEQ))
          end if
          if (is_one_point(model%mesh%kind(e)) .and. size(new%modes, 2) > 0) work = work + &
            (new%modes(MAX_ELEMENT_AMPLITUDES - 1, e) - old%modes(MAX_ELEMENT_AMPLITUDES - 1, e)) / new%volume(p)
          new%dissipated(p) = new%dissipated(p) + work
          new%plastic_work = new%plastic_work + new%volume(p) * work
        end do
      end associate
    end do
  end subroutine add_inelastic_work


  !> SDEG and DMICRT: damage of cohesive laws, and the largest value so far of its criterion.
  pure function damage_variables(model, fields) result(values)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP) :: values(2, model%mesh%n_points)     !< [-]
    integer :: e, m
    values = 0
    do e = 1, model%mesh%n_elements
      m = material_in_step(model, fields%step, e)
      if (m == 0) cycle
      if (.not. allocated(model%materials(m)%damage)) cycle
      associate (points => [model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1], first => model%materials(m)%inner_first)
        values(1, points(1):points(2)) = fields%history(first + STATE_DELAYED - 1, points(1):points(2))
        values(2, points(1):points(2)) = fields%history(first + STATE_CRITERION - 1, points(1):points(2))
      end associate
    end do
  end function damage_variables


  !> ENER for tables and fields: the strain energy; in CalculiX including the work on plastic and creep strains.
  pure function printed_energy_density(model, fields) result(density)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP) :: density(model%mesh%n_points)       !< [energy/volume]
    density = fields%energy
    if (model%dialect == DIALECT_CALCULIX .and. size(fields%dissipated) > 0) density = density + fields%dissipated
  end function printed_energy_density

end module amontons_postprocess
