!> Section forces of shells and beams from the stresses of their solids, and the rotations of their nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! One value per element, the mean over its area A or its length L, in local axes that turn with the element:
!!
!!     shells   SF1 SF2 SF3 SF4 SF5 SF6 = int (s11, s22, s12, s13, s23, s33) dz,   SM1 SM2 SM3 = int (s11, s22, s12) z dz
!!     beams    SF1 SF2 SF3 = int (stt, st2, st1) dA,   SM1 SM2 SM3 = int (stt x2, -stt x1, st2 x1 - st1 x2) dA
!!
!! z, x1, x2 are measured from the nodes of the deck: over the thickness along the normal, over the cross-section along its axes.
!! Sums over the integration points; under NLGEOM over the deformed element with Cauchy stresses. Names and signs are Abaqus's.
!! Theory: doc/theory/elements.md, section "Section forces".
module amontons_section_forces
  use amontons_kinds, only: DP, PI
  use amontons_element, only: evaluate_point_volumes
  use amontons_element_kinds, only: FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, FAMILY_SHELL, KIND_SAX2, &
    MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS, MAX_FACE_NODES
  use amontons_material_axes, only: evaluate_orientation
  use amontons_materials, only: orientation_type
  use amontons_mesh, only: element_nodes, wall_ratios
  use amontons_model, only: model_type, is_out
  use amontons_shape_functions, only: quadrature, shape_functions, facet_shapes, facet_quadrature, MAX_FACET_POINTS
  use amontons_state, only: fields_type
  use amontons_structural_data, only: director_type, n_section_layers
  use amontons_tensor, only: cross_product, unpack_voigt
  implicit none
  private
  public :: find_section_forces, find_node_rotations, N_SECTION_FORCES, rotation_vector

  integer, parameter :: N_SECTION_FORCES = 9       !< SF1 to SF6, SM1 to SM3
  real(DP), parameter :: TOL_HALF_TURN = 1.0e-6_DP !< sine of an angle near pi, below: its axis from the symmetric part [-]

contains

  !> The section forces of all elements; of a composite shell at its first layer. 0: no shell or beam, or taken out.
  subroutine find_section_forces(model, fields, forces)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(out) :: forces(:, :)          !< (N_SECTION_FORCES, n_elements) shells: per length; beams
    real(DP), allocatable :: x(:, :)               ! coordinates, under NLGEOM current ones
    integer :: e
    forces = 0
    if (.not. allocated(model%structure)) return
    x = model%mesh%coordinates
    if (model%steps(max(1, fields%step))%is_nlgeom) x = x + fields%u
    do e = 1, model%mesh%n_elements
      associate (s => model%structure%section(e))
        if (s == 0) cycle
        if (model%mesh%layer(e) > 1 .or. is_out(model, fields%step, e)) cycle
        if (model%structure%kind(e) == KIND_SAX2) then
          call sum_meridian(model, fields, x, e, n_section_layers(model%structure%sections(s)), forces(:, e))
        else if (model%structure%sections(s)%family == FAMILY_SHELL) then
          call sum_shell(model, fields, x, e, n_section_layers(model%structure%sections(s)), forces(:, e))
        else
          call sum_beam(model, fields, x, e, forces(:, e))
        end if
      end associate
    end do
  end subroutine find_section_forces


  !> The section forces of a shell of n_layers elements, the first of which is e.
  subroutine sum_shell(model, fields, x, e, n_layers, forces)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: e, n_layers
    real(DP), intent(inout) :: forces(:)           !< in: zero
    integer, parameter :: FACET_OF_NODES(3:8) = [FACET_TRI3, FACET_QUAD4, 0, FACET_TRI6, 0, FACET_QUAD8]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), volumes(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), &
      dN(3, MAX_ELEMENT_NODES), axes(3, 3), origin(3), s(3, 3), z
    integer :: l, p, m, status, facet, n_nodes, nodes(MAX_ELEMENT_NODES)
    associate (structure => model%structure, mesh => model%mesh)
      associate (own => structure%nodes(structure%first(e):structure%first(e + 1) - 1))
        facet = FACET_OF_NODES(size(own))
        do l = e, e + n_layers - 1
          call element_nodes(mesh, l, n_nodes, nodes)
          call quadrature(mesh%kind(l), m, xi, w)
          call evaluate_point_volumes(mesh%kind(l), x(:, nodes(:n_nodes)), mesh%section_value(l), m, volumes, status)
          do p = 1, m
            call find_shell_axes(model, e, facet, xi(:2, p), mesh%coordinates(:, own), x(:, own), axes, origin)
            call shape_functions(mesh%kind(l), xi(:, p), N, dN)
            z = dot_product(axes(:, 3), matmul(x(:, nodes(:n_nodes)), N(:n_nodes)) - origin)
            s = matmul(transpose(axes), matmul(unpack_voigt(fields%stress(:, mesh%point_first(l) + p - 1)), axes))
            forces = forces + volumes(p) * [s(1, 1), s(2, 2), s(1, 2), s(1, 3), s(2, 3), s(3, 3), z * s(1, 1), z * s(2, 2), &
              z * s(1, 2)]
          end do
        end do
        forces = forces / shell_area(facet, x(:, own))
      end associate
    end associate
  end subroutine sum_shell


  !> The local axes of a shell at a place and this place on its surface through the nodes. Undeformed: axis 1 is that of the
  !! orientation, else the projection of global x. Deformed: turned by the rotation of the surface.
  subroutine find_shell_axes(model, e, facet, xi, reference, current, axes, place)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e, facet                !< element, FACET_...
    real(DP), intent(in) :: xi(2)
    real(DP), intent(in) :: reference(:, :), current(:, :)   !< (3, nodes) [length]
    real(DP), intent(out) :: axes(3, 3)            !< in columns, the third is the normal
    real(DP), intent(out) :: place(3)              !< [length]
    type(orientation_type) :: orientation
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), A(3, 2), f(3, 2), G(2, 2), C(2, 2), root, scale
    integer :: k, m
    m = size(reference, 2)
    call facet_shapes(facet, xi, N, dN, ddN)
    place = matmul(current, N(:m))
    A = matmul(reference, transpose(dN(:, :m)))
    orientation%is_projected = .true.
    orientation%normal_axis = 3
    k = 0
    if (allocated(model%element_orientation)) k = model%element_orientation(e)
    if (k > 0) orientation = model%orientations(k)
    orientation%layer_angle = 0                    ! the axes of the shell, not those of its first ply
    axes = evaluate_orientation(orientation, matmul(reference, N(:m)), unit(cross_product(A(:, 1), A(:, 2))))
    G = inverse_of(matmul(transpose(A), A))
    f = matmul(matmul(current, transpose(dN(:, :m))), matmul(G, matmul(transpose(A), axes(:, :2))))   ! dx/dX along both axes
    C = matmul(transpose(f), f)
    root = sqrt(C(1, 1) * C(2, 2) - C(1, 2) * C(2, 1))
    scale = sqrt(C(1, 1) + C(2, 2) + 2 * root)     ! the root of C is (C + root 1)/scale
    C(1, 1) = C(1, 1) + root
    C(2, 2) = C(2, 2) + root
    axes(:, :2) = matmul(f, scale * inverse_of(C))
    axes(:, 3) = cross_product(axes(:, 1), axes(:, 2))
  end subroutine find_shell_axes


  !> The area of a surface through nodes.
  pure real(DP) function shell_area(facet, x) result(area)
    integer, intent(in) :: facet                   !< FACET_...
    real(DP), intent(in) :: x(:, :)                !< (3, nodes) [length]
    real(DP) :: xi(2, MAX_FACET_POINTS), w(MAX_FACET_POINTS), N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), &
      along(3, 2)
    integer :: p, m
    call facet_quadrature(facet, m, xi, w)
    area = 0
    do p = 1, m
      call facet_shapes(facet, xi(:, p), N, dN, ddN)
      along = matmul(x, transpose(dN(:, :size(x, 2))))
      area = area + w(p) * norm2(cross_product(along(:, 1), along(:, 2)))
    end do
  end function shell_area


  !> The section forces of an axisymmetric shell of n_layers elements, the first of which is e: axis 1 along its line, 2 round the
  !! circle.
  subroutine sum_meridian(model, fields, x, e, n_layers, forces)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: e, n_layers
    real(DP), intent(inout) :: forces(:)           !< in: zero
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), volumes(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), &
      dN(3, MAX_ELEMENT_NODES), axes(3, 3), origin(3), s(3, 3), z, area, speed
    integer :: l, p, m, status, n_nodes, nodes(MAX_ELEMENT_NODES)
    associate (mesh => model%mesh, own => model%structure%nodes(model%structure%first(e):model%structure%first(e + 1) - 1))
      area = 0
      do l = e, e + n_layers - 1
        call element_nodes(mesh, l, n_nodes, nodes)
        call quadrature(mesh%kind(l), m, xi, w)
        call evaluate_point_volumes(mesh%kind(l), x(:, nodes(:n_nodes)), mesh%section_value(l), m, volumes, status)
        do p = 1, m
          call find_meridian_axes(x(:, own), xi(1, p), axes, origin, speed)
          call shape_functions(mesh%kind(l), xi(:, p), N, dN)
          z = dot_product(axes(:, 3), matmul(x(:, nodes(:n_nodes)), N(:n_nodes)) - origin)
          s = matmul(transpose(axes), matmul(unpack_voigt(fields%stress(:, mesh%point_first(l) + p - 1)), axes))
          forces = forces + volumes(p) * [s(1, 1), s(2, 2), s(1, 2), s(1, 3), s(2, 3), s(3, 3), z * s(1, 1), z * s(2, 2), &
            z * s(1, 2)]
          if (l == e) area = area + 0.5_DP * w(p) * speed * 2 * PI * origin(1)   ! the weights over the thickness add up to 2
        end do
      end do
      forces = forces / area
    end associate
  end subroutine sum_meridian


  !> Tangent, direction of the circle and normal of the line of an axisymmetric shell at a natural coordinate, and this place.
  pure subroutine find_meridian_axes(x, xi, axes, place, speed)
    real(DP), intent(in) :: x(:, :)                !< (3, 3) end, middle, end [length]
    real(DP), intent(in) :: xi                     !< -1 to 1
    real(DP), intent(out) :: axes(3, 3)            !< in columns
    real(DP), intent(out) :: place(3)              !< [length]
    real(DP), intent(out) :: speed                 !< length per natural coordinate [length]
    real(DP) :: N(3), dN(3)
    call line_shapes(xi, N, dN)
    place = matmul(x, N)
    axes(:, 1) = matmul(x, dN)
    speed = norm2(axes(:, 1))
    axes(:, 1) = axes(:, 1) / speed
    axes(:, 2) = [0.0_DP, 0.0_DP, -1.0_DP]
    axes(:, 3) = cross_product(axes(:, 1), axes(:, 2))
  end subroutine find_meridian_axes


  !> The shape functions of a line with the nodes end, middle, end and their derivatives.
  pure subroutine line_shapes(xi, N, dN)
    real(DP), intent(in) :: xi                     !< -1 to 1
    real(DP), intent(out) :: N(3), dN(3)
    N = [0.5_DP * xi * (xi - 1), 1 - xi**2, 0.5_DP * xi * (xi + 1)]
    dN = [xi - 0.5_DP, -2 * xi, xi + 0.5_DP]
  end subroutine line_shapes


  !> The section forces of a beam.
  subroutine sum_beam(model, fields, x, e, forces)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: e
    real(DP), intent(inout) :: forces(:)           !< in: zero
    real(DP), parameter :: GAUSS(3) = [-sqrt(0.6_DP), 0.0_DP, sqrt(0.6_DP)], WEIGHTS(3) = [real(DP) :: 5, 8, 5] / 9
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), volumes(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), &
      dN(3, MAX_ELEMENT_NODES), axes(3, 3), origin(3), s(3, 3), r(3), length, speed
    integer :: p, m, k, status, n_nodes, nodes(MAX_ELEMENT_NODES)
    associate (mesh => model%mesh)
      call element_nodes(mesh, e, n_nodes, nodes)
      call quadrature(mesh%kind(e), m, xi, w, wall_ratios(mesh, e))
      call evaluate_point_volumes(mesh%kind(e), x(:, nodes(:n_nodes)), mesh%section_value(e), m, volumes, status, &
        wall_ratios(mesh, e))
      do p = 1, m
        call find_beam_axes(model, x, e, xi(1, p), axes, origin, speed)
        call shape_functions(mesh%kind(e), xi(:, p), N, dN)
        r = matmul(transpose(axes), matmul(x(:, nodes(:n_nodes)), N(:n_nodes)) - origin)
        s = matmul(transpose(axes), matmul(unpack_voigt(fields%stress(:, mesh%point_first(e) + p - 1)), axes))
        forces = forces + volumes(p) * [s(3, 3), s(3, 2), s(3, 1), 0.0_DP, 0.0_DP, 0.0_DP, s(3, 3) * r(2), -s(3, 3) * r(1), &
          s(3, 2) * r(1) - s(3, 1) * r(2)]
      end do
      length = 0
      do k = 1, 3
        call find_beam_axes(model, x, e, GAUSS(k), axes, origin, speed)
        length = length + WEIGHTS(k) * speed
      end do
      forces = forces / length
    end associate
  end subroutine sum_beam


  !> Both directions of the cross-section of a beam, its tangent, and its place at a natural coordinate.
  subroutine find_beam_axes(model, x, e, xi, axes, place, speed)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: e
    real(DP), intent(in) :: xi                     !< -1 to 1 along the beam
    real(DP), intent(out) :: axes(3, 3)            !< direction 1, direction 2, tangent in columns
    real(DP), intent(out) :: place(3)              !< [length]
    real(DP), intent(out) :: speed                 !< length per natural coordinate [length]
    real(DP) :: N(3), dN(3), tangent(3), first(3)
    integer :: a, m
    associate (structure => model%structure)
      associate (own => structure%nodes(structure%first(e):structure%first(e + 1) - 1), &
        directors => structure%director_of(structure%first(e):structure%first(e + 1) - 1))
        m = size(own)
        if (m == 2) then
          N(:2) = 0.5_DP * [1 - xi, 1 + xi]
          dN(:2) = [-0.5_DP, 0.5_DP]
        else
          call line_shapes(xi, N, dN)
        end if
        place = matmul(x(:, own), N(:m))
        tangent = matmul(x(:, own), dN(:m))
        first = 0
        do a = 1, m
          first = first + N(a) * section_edge(structure%directors(directors(a)), x, 1)
        end do
      end associate
    end associate
    speed = norm2(tangent)
    axes(:, 3) = tangent / speed
    axes(:, 1) = unit(first - dot_product(first, axes(:, 3)) * axes(:, 3))
    axes(:, 2) = cross_product(axes(:, 3), axes(:, 1))
  end subroutine find_beam_axes


  !> The mean edge of a cross-section along one of its directions.
  pure function section_edge(director, x, direction) result(edge)
    type(director_type), intent(in) :: director
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) positions or displacements [length]
    integer, intent(in) :: direction               !< 1 or 2
    real(DP) :: edge(3)
    associate (n => director%nodes)
      if (direction == 1) then
        edge = 0.5_DP * (x(:, n(3)) + x(:, n(4)) - x(:, n(1)) - x(:, n(2)))
      else
        edge = 0.5_DP * (x(:, n(1)) + x(:, n(4)) - x(:, n(2)) - x(:, n(3)))
      end if
    end associate
  end function section_edge


  !> The rotations of all nodes: those of rotation nodes, of fibres and of cross-sections, which their own nodes have too; else 0. A
  !! fibre has no rotation about itself.
  subroutine find_node_rotations(model, fields, rotation)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(out) :: rotation(:, :)        !< (3, n_nodes) rotation vectors [rad]
    real(DP) :: turn(3)
    logical :: is_nlgeom
    integer :: i, node
    rotation = 0
    if (allocated(model%rotation_of)) then
      do node = 1, size(model%rotation_of)
        if (model%rotation_of(node) > 0) rotation(:, node) = fields%u(:, model%rotation_of(node))
      end do
    end if
    if (.not. allocated(model%structure)) return
    is_nlgeom = model%steps(max(1, fields%step))%is_nlgeom
    associate (directors => model%structure%directors)
      do i = 1, size(directors)
        node = directors(i)%node
        if (has_rotation_node(model, node)) then
          turn = rotation(:, node)
        else
          turn = director_rotation(directors(i), model%mesh%coordinates, fields%u, is_nlgeom)
          rotation(:, node) = turn
        end if
        rotation(:, directors(i)%nodes) = spread(turn, 2, size(directors(i)%nodes))
      end do
    end associate
  end subroutine find_node_rotations


  !> Whether the rotations of a node are unknowns.
  pure logical function has_rotation_node(model, node) result(has)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    has = .false.
    if (.not. allocated(model%rotation_of)) return
    if (node <= size(model%rotation_of)) has = model%rotation_of(node) > 0
  end function has_rotation_node


  !> The rotation vector of a fibre or cross-section.
  pure function director_rotation(director, x, u, is_nlgeom) result(turn)
    type(director_type), intent(in) :: director
    real(DP), intent(in) :: x(:, :), u(:, :)       !< (3, n_nodes) [length]
    logical, intent(in) :: is_nlgeom
    real(DP) :: turn(3), fibre(3), change(3), n(3), edge(3, 2), moved(3, 2), t(3)
    if (director%n_outer == 2) then
      fibre = x(:, director%nodes(2)) - x(:, director%nodes(1))
      change = u(:, director%nodes(2)) - u(:, director%nodes(1))
      if (is_nlgeom) then
        n = cross_product(unit(fibre), unit(fibre + change))
        turn = angle_along(n, dot_product(unit(fibre), unit(fibre + change)))
      else
        turn = cross_product(fibre, change) / dot_product(fibre, fibre)
      end if
      return
    end if
    edge(:, 1) = section_edge(director, x, 1)
    edge(:, 2) = section_edge(director, x, 2)
    moved(:, 1) = section_edge(director, u, 1)
    moved(:, 2) = section_edge(director, u, 2)
    if (is_nlgeom) then
      turn = rotation_vector(matmul(frame_of_edges(edge + moved), transpose(frame_of_edges(edge))))
      return
    end if
    t = unit(cross_product(edge(:, 1), edge(:, 2)))
    moved(:, 1) = moved(:, 1) / norm2(edge(:, 1))
    moved(:, 2) = moved(:, 2) / norm2(edge(:, 2))
    turn = dot_product(moved(:, 2), t) * unit(edge(:, 1)) - dot_product(moved(:, 1), t) * unit(edge(:, 2)) + &
      0.5_DP * (dot_product(moved(:, 1), unit(edge(:, 2))) - dot_product(moved(:, 2), unit(edge(:, 1)))) * t
  end function director_rotation


  !> Unit vectors along the bisector of two edges, across it in their plane, and normal to it.
  pure function frame_of_edges(edge) result(frame)
    real(DP), intent(in) :: edge(3, 2)
    real(DP) :: frame(3, 3)
    frame(:, 1) = unit(unit(edge(:, 1)) + unit(edge(:, 2)))
    frame(:, 3) = unit(cross_product(edge(:, 1), edge(:, 2)))
    frame(:, 2) = cross_product(frame(:, 3), frame(:, 1))
  end function frame_of_edges


  !> The rotation vector of a rotation matrix; angles to pi.
  pure function rotation_vector(R) result(w)
    real(DP), intent(in) :: R(3, 3)
    real(DP) :: w(3), axis(3), cosine
    integer :: k
    axis = 0.5_DP * [R(3, 2) - R(2, 3), R(1, 3) - R(3, 1), R(2, 1) - R(1, 2)]
    cosine = 0.5_DP * (R(1, 1) + R(2, 2) + R(3, 3) - 1)
    w = angle_along(axis, cosine)
    if (norm2(axis) > TOL_HALF_TURN .or. cosine > 0) return
    k = maxloc([R(1, 1), R(2, 2), R(3, 3)], 1)     ! a half turn: R = 2 n n' - 1
    axis = 0.5_DP * (R(:, k) + R(k, :))
    axis(k) = axis(k) + 1
    axis = unit(axis)
    w = sign(norm2(w), dot_product(axis, w)) * axis
    if (.not. norm2(w) > 0) w = PI * axis
  end function rotation_vector


  !> The rotation vector of an axis whose length is the sine of the angle.
  pure function angle_along(axis, cosine) result(w)
    real(DP), intent(in) :: axis(3), cosine
    real(DP) :: w(3), sine
    sine = norm2(axis)
    w = axis
    if (sine > 0) w = axis * (atan2(sine, cosine) / sine)
  end function angle_along


  !> A vector of length one along another.
  pure function unit(a) result(b)
    real(DP), intent(in) :: a(3)
    real(DP) :: b(3)
    b = a / norm2(a)
  end function unit


  !> The inverse of a 2x2 matrix.
  pure function inverse_of(A) result(B)
    real(DP), intent(in) :: A(2, 2)
    real(DP) :: B(2, 2)
    B = reshape([A(2, 2), -A(2, 1), -A(1, 2), A(1, 1)], [2, 2]) / (A(1, 1) * A(2, 2) - A(1, 2) * A(2, 1))
  end function inverse_of

end module amontons_section_forces
