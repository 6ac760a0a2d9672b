!> Converts tie constraints, cyclic symmetry, coupled edges of shells and distributing couplings into linear equations.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_tie_generation
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_tensor, only: cross_product, invert, IDENTITY
  use amontons_text, only: to_text, plural, NEWLINE
  use amontons_element_kinds, only: element_kind_type, element_kind, MAX_FACE_NODES, is_of_revolution
  use amontons_tributary_areas, only: integrate_nodal_areas, out_of_plane_depth
  use amontons_loads, only: equation_type, equation_list_type
  use amontons_mpc_data, only: tie_type, distributing_coupling_type
  use amontons_mesh, only: mesh_type
  use amontons_surfaces, only: surface_type
  use amontons_model, only: model_type, new_equation
  use amontons_shape_functions, only: facet_shapes
  use amontons_shell_edge_coupling, only: couple_shell_edge
  use amontons_structural_data, only: following_nodes, expanded_nodes
  use amontons_facets, only: facets_type, build_facets, facet_nodes
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_surface_projection, only: projection_type, find_projection, evaluate_facet_point, find_facet_distance, &
    PROJECTION_INSIDE
  implicit none
  private
  public :: generate_ties

  real(DP), parameter :: TOL_TIE_DISTANCE = 0.025_DP  !< position tolerance over the mean edge of a facet [-]
  real(DP), parameter :: TOL_NODAL_TIE_DISTANCE = 0.05_DP  !< of a master of nodes: over the mean distance of neighbours [-]
  real(DP), parameter :: TOL_TIE_ROUNDING = 1.0e-9_DP   !< of a distance, over the edge of the facet [-]
  real(DP), parameter :: TOL_CYCLIC_MATCH = 1.0e-3_DP   !< matching tolerance of a sector, over the extent of its dependent side [-]

contains

  !> The equations of all ties and distributing couplings, and the coordinates of tied nodes moved to their masters.
  subroutine generate_ties(model, equations, coordinates, text, error)
    type(model_type), intent(in) :: model
    type(equation_type), allocatable, intent(out) :: equations(:)
    real(DP), allocatable, intent(out) :: coordinates(:, :)   !< (3, n_nodes) of all nodes [length]
    character(:), allocatable, intent(out) :: text   !< warnings; empty: there are none
    type(error_type), allocatable, intent(out) :: error
    type(mesh_type) :: mesh                        ! with tied nodes moved to their masters
    type(equation_list_type) :: list
    integer :: i
    mesh = model%mesh
    text = ''
    if (allocated(model%ties)) then
      do i = 1, size(model%ties)
        if (model%ties(i)%is_cyclic) then
          call convert_cyclic_symmetry(model, mesh, model%ties(i), list, error)
        else if (model%ties(i)%is_shell_edge) then
          call couple_shell_edge(model, model%ties(i), mesh, list, text, error)
        else if (model%surfaces(model%ties(i)%master)%is_node_based) then
          call convert_nodal_tie(model, model%ties(i), mesh, list, text, error)
        else
          call convert_tie(model, model%ties(i), mesh, list, error)
        end if
        if (allocated(error)) return
      end do
    end if
    if (allocated(model%distributing_couplings)) then
      do i = 1, size(model%distributing_couplings)
        call convert_distributing_coupling(model, mesh, model%distributing_couplings(i), list, error)
        if (allocated(error)) return
      end do
    end if
    call list%move_to(equations)
    call move_alloc(mesh%coordinates, coordinates)
  end subroutine generate_ties


  !> Ties the slave nodes to the facets of the master: u = sum N_i u_i; nodes inside a composite shell follow others that are tied.
  subroutine convert_tie(model, tie, mesh, equations, error)
    type(model_type), intent(in) :: model
    type(tie_type), intent(in) :: tie
    type(mesh_type), intent(inout) :: mesh         !< out: slave nodes moved to their masters
    type(equation_list_type), intent(inout) :: equations
    type(error_type), allocatable, intent(out) :: error
    type(facets_type) :: facets
    type(facet_search_type) :: search
    type(projection_type) :: projection
    real(DP), allocatable :: x(:, :)
    integer, allocatable :: slaves(:)
    real(DP) :: tolerance_length
    logical :: is_master(size(mesh%coordinates, 2)), follows(size(mesh%coordinates, 2))
    integer :: i, n_tied
    associate (master => model%surfaces(tie%master))
      call build_facets(mesh, master%element, master%face, facets, error)
    end associate
    if (allocated(error)) return
    x = mesh%coordinates
    tolerance_length = tie%tolerance
    if (tie%tolerance < 0.0_DP) tolerance_length = TOL_TIE_DISTANCE * sum(facets%edge_length) / real(facets%n, DP)
    call build_facet_search(facets, x, tolerance_length, search)
    slaves = model%surfaces(tie%slave)%nodes
    is_master = .false.
    is_master(facets%nodes) = .true.
    follows = following_nodes(model%structure, size(follows))
    n_tied = 0
    do i = 1, size(slaves)
      if (is_master(slaves(i))) cycle    ! a common node of both surfaces needs no tie
      call find_projection(facets, search, x, x(:, slaves(i)), tolerance_length, projection)
      if (projection%status /= PROJECTION_INSIDE .or. projection%facet == 0) cycle
      if (tie%tolerance >= 0.0_DP .and. find_facet_distance(facets, projection) > tolerance_length + TOL_TIE_ROUNDING &
        * facets%edge_length(projection%facet)) cycle   ! beside the master
      n_tied = n_tied + 1
      if (tie%is_adjusted) call evaluate_facet_point(facets, x, projection%facet, projection%xi, mesh%coordinates(:, slaves(i)))
      if (.not. follows(slaves(i))) call add_tie_equations(facets, projection, slaves(i), tie%line, equations)
    end do
    if (n_tied == 0) call set_error(error, EXIT_SETUP, 'The *TIE ' // tie%name // ' ties no node: none of the slave ' // &
      'surface is within POSITION TOLERANCE of the master surface.')
  end subroutine convert_tie


  !> Ties the slave nodes to the nearest nodes of a master that is made of nodes: u = u_i, of equally near ones the node with the
  !! lowest label. A warning counts the slave nodes that are not tied. Cost: slave nodes times master nodes.
  subroutine convert_nodal_tie(model, tie, mesh, equations, text, error)
    type(model_type), intent(in) :: model
    type(tie_type), intent(in) :: tie
    type(mesh_type), intent(inout) :: mesh         !< out: slave nodes moved to their masters
    type(equation_list_type), intent(inout) :: equations
    character(:), allocatable, intent(inout) :: text   !< warnings so far
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: x(:, :)
    real(DP) :: tolerance_length, distance, nearest_untied
    logical :: is_master(size(mesh%coordinates, 2)), follows(size(mesh%coordinates, 2))
    integer :: i, k, node, n_tied, n_slaves
    x = mesh%coordinates
    is_master = .false.
    is_master(model%surfaces(tie%master)%nodes) = .true.
    follows = following_nodes(model%structure, size(follows))
    n_tied = 0
    n_slaves = 0
    nearest_untied = huge(1.0_DP)
    associate (slaves => model%surfaces(tie%slave)%nodes, masters => model%surfaces(tie%master)%nodes)
      tolerance_length = tie%tolerance
      if (tie%tolerance < 0.0_DP) tolerance_length = TOL_NODAL_TIE_DISTANCE * mean_spacing(x(:, masters))
      do i = 1, size(slaves)
        if (is_master(slaves(i)) .or. follows(slaves(i))) cycle   ! a common node of both surfaces needs no tie
        n_slaves = n_slaves + 1
        call find_nearest_node(x, masters, mesh%node_label, x(:, slaves(i)), node, distance)
        if (distance > tolerance_length + TOL_TIE_ROUNDING * norm2(x(:, node))) then
          nearest_untied = min(nearest_untied, distance)
          cycle
        end if
        n_tied = n_tied + 1
        if (have_both_rotations(model, slaves(i), node)) then
          call set_error(error, EXIT_SETUP, 'The *TIE ' // tie%name // ' ties node ' // to_text(mesh%node_label(slaves(i))) // &
            ' to node ' // to_text(mesh%node_label(node)) // ', both of shells or beams: their displacements are tied here, ' // &
            'not their rotations. Write *MPC, TIE for two nodes at one place, or *COUPLING with *KINEMATIC, 1, 6.')
          return
        end if
        if (tie%is_adjusted) mesh%coordinates(:, slaves(i)) = x(:, node)
        do k = 1, 3
          call equations%add(new_equation([slaves(i), node], [k, k], [1.0_DP, -1.0_DP], 'TIE', tie%line))
        end do
      end do
    end associate
    if (n_tied == n_slaves) return
    if (n_tied == 0) then
      call set_error(error, EXIT_SETUP, 'The *TIE ' // tie%name // ' ties no node: none of the slave surface is within ' // &
        'POSITION TOLERANCE (' // to_text(tolerance_length) // ') of a node of the master surface; the nearest one is ' // &
        to_text(nearest_untied) // ' away.')
      return
    end if
    if (text /= '') text = text // NEWLINE
    text = text // 'The *TIE ' // tie%name // ' ties ' // to_text(n_tied) // ' of ' // plural(n_slaves, 'slave node') // &
      ' to nodes of its master; the next one is ' // to_text(nearest_untied) // ' away, farther than POSITION TOLERANCE (' // &
      to_text(tolerance_length) // ').'
  end subroutine convert_nodal_tie


  !> The node nearest to a point; of those at the same distance but for rounding that with the lowest label.
  pure subroutine find_nearest_node(x, nodes, label, point, node, distance)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: nodes(:)                !< to choose from, at least one
    integer, intent(in) :: label(:)                !< (n_nodes)
    real(DP), intent(in) :: point(3)               !< [length]
    integer, intent(out) :: node
    real(DP), intent(out) :: distance              !< [length]
    real(DP) :: distances(size(nodes))
    integer :: i
    do i = 1, size(nodes)
      distances(i) = norm2(x(:, nodes(i)) - point)
    end do
    distance = minval(distances)
    i = minloc(label(nodes), mask=distances <= distance * (1.0_DP + TOL_TIE_ROUNDING), dim=1)
    node = nodes(i)
  end subroutine find_nearest_node


  !> The mean distance of nodes from the nearest other one [length]; 0 for a single node.
  pure real(DP) function mean_spacing(x) result(spacing)
    real(DP), intent(in) :: x(:, :)                !< (3, n) [length]
    real(DP) :: nearest
    integer :: i, j
    spacing = 0.0_DP
    do i = 1, size(x, 2)
      nearest = huge(1.0_DP)
      do j = 1, size(x, 2)
        if (j /= i) nearest = min(nearest, norm2(x(:, j) - x(:, i)))
      end do
      if (nearest < huge(1.0_DP)) spacing = spacing + nearest / real(size(x, 2), DP)
    end do
  end function mean_spacing


  !> Whether both nodes belong to shells or beams.
  pure logical function have_both_rotations(model, a, b) result(have)
    type(model_type), intent(in) :: model
    integer, intent(in) :: a, b
    have = .false.
    if (allocated(model%structure)) have = size(expanded_nodes(model%structure, [a])) > 1 .and. &
      size(expanded_nodes(model%structure, [b])) > 1
  end function have_both_rotations


  !> The three equations of one tied node.
  subroutine add_tie_equations(facets, projection, slave, line, equations)
    type(facets_type), intent(in) :: facets
    type(projection_type), intent(in) :: projection
    integer, intent(in) :: slave, line
    type(equation_list_type), intent(inout) :: equations
    real(DP) :: N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: nodes(MAX_FACE_NODES), n, k
    call facet_nodes(facets, projection%facet, n, nodes)
    call facet_shapes(facets%kind(projection%facet), projection%xi, N_i, dN, ddN)
    do k = 1, 3
      call equations%add(new_equation([slave, nodes(:n)], spread(k, 1, n + 1), [1.0_DP, -N_i(:n)], 'TIE', line))
    end do
  end subroutine add_tie_equations


  !> Appends u_s = R sum N_i u_i for every node s of the dependent side, with the rotation R of the independent side onto it.
  !!
  !! Of the two senses of rotation the one with more matching nodes applies. Errors: nodes without a partner (EXIT_SETUP).
  subroutine convert_cyclic_symmetry(model, mesh, tie, equations, error)
    type(model_type), intent(in) :: model
    type(mesh_type), intent(in) :: mesh            !< with tied nodes moved to their masters
    type(tie_type), intent(in) :: tie
    type(equation_list_type), intent(inout) :: equations
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: first(:), nodes(:), best_first(:), best_nodes(:)
    real(DP), allocatable :: weight(:), best_weight(:)
    real(DP) :: rotation_map(3, 3), best_rotation(3, 3)
    logical :: follows(size(mesh%coordinates, 2))
    integer :: rotation_sign, s, k, n_found, n_best
    character(12) :: number
    n_best = -1
    do rotation_sign = 1, 2
      rotation_map = tie%turn
      if (rotation_sign == 2) rotation_map = transpose(tie%turn)
      call find_cyclic_partners(model, mesh, tie, rotation_map, first, nodes, weight, error)
      if (allocated(error)) return
      n_found = count(first(2:) > first(:size(first) - 1))
      if (n_found <= n_best) cycle
      n_best = n_found
      best_rotation = rotation_map
      best_first = first
      best_nodes = nodes
      best_weight = weight
    end do
    associate (slaves => model%surfaces(tie%slave)%nodes)
      if (n_best < size(slaves)) then
        write (number, '(i0)') size(slaves) - n_best
        call set_error(error, EXIT_SETUP, 'Of the dependent side of the cyclic symmetry ' // tie%name // ' ' // trim(number) // &
          ' nodes have no partner on the other side, turned by the angle of the sector. Look at N, the axis and POSITION ' // &
          'TOLERANCE.')
        return
      end if
      follows = following_nodes(model%structure, size(follows))
      do s = 1, size(slaves)
        if (follows(slaves(s))) cycle
        do k = 1, 3
          call add_rotated_equation(slaves(s), k, best_nodes(best_first(s):best_first(s + 1) - 1), &
            best_weight(best_first(s):best_first(s + 1) - 1), best_rotation(k, :), tie%line, equations)
        end do
      end do
    end associate
  end subroutine convert_cyclic_symmetry


  !> For each node of the dependent side the nodes and weights of its matching point on the independent side, if any.
  subroutine find_cyclic_partners(model, mesh, tie, rotation_map, first, nodes, weight, error)
    type(model_type), intent(in) :: model
    type(mesh_type), intent(in) :: mesh            !< with tied nodes moved to their masters
    type(tie_type), intent(in) :: tie
    real(DP), intent(in) :: rotation_map(3, 3)             !< rotates the independent side onto the dependent one
    integer, allocatable, intent(out) :: first(:)  !< (n + 1)
    integer, allocatable, intent(out) :: nodes(:)
    real(DP), allocatable, intent(out) :: weight(:)
    type(error_type), allocatable, intent(out) :: error
    type(facets_type) :: facets
    type(facet_search_type) :: search
    real(DP) :: position(3), reach
    integer :: s, i
    logical :: has_faces
    associate (slaves => model%surfaces(tie%slave)%nodes, master => model%surfaces(tie%master), X => mesh%coordinates)
      allocate (first(size(slaves) + 1), source=1)
      allocate (nodes(0), weight(0))
      reach = tie%tolerance
      if (reach < 0.0_DP) reach = TOL_CYCLIC_MATCH * norm2(maxval(X(:, slaves), dim=2) - minval(X(:, slaves), dim=2))
      has_faces = .not. master%is_node_based
      if (has_faces) call build_facets(mesh, master%element, master%face, facets, error)
      if (allocated(error)) return
      if (has_faces) call build_facet_search(facets, X, reach, search)
      do s = 1, size(slaves)
        position = tie%centre + matmul(transpose(rotation_map), X(:, slaves(s)) - tie%centre)
        i = minloc(sum((X(:, master%nodes) - spread(position, 2, size(master%nodes)))**2, dim=1), dim=1)
        if (norm2(X(:, master%nodes(i)) - position) <= reach) then
          nodes = [nodes, master%nodes(i)]
          weight = [weight, 1.0_DP]
        else if (has_faces) then
          call append_facet_weights(facets, search, X, position, reach, nodes, weight)
        end if
        first(s + 1) = size(nodes) + 1
      end do
    end associate
  end subroutine find_cyclic_partners


  !> Appends the nodes of the facet at a point, if one is within the tolerance.
  subroutine append_facet_weights(facets, search, X, position, reach, nodes, weight)
    type(facets_type), intent(in) :: facets
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: X(:, :), position(3), reach   !< [length]
    integer, allocatable, intent(inout) :: nodes(:)
    real(DP), allocatable, intent(inout) :: weight(:)
    type(projection_type) :: projection
    real(DP) :: N_i(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES)
    integer :: corners(MAX_FACE_NODES), n
    call find_projection(facets, search, X, position, reach, projection)
    if (projection%status /= PROJECTION_INSIDE .or. projection%facet == 0) return
    call facet_nodes(facets, projection%facet, n, corners)
    call facet_shapes(facets%kind(projection%facet), projection%xi, N_i, dN, ddN)
    nodes = [nodes, corners(:n)]
    weight = [weight, N_i(:n)]
  end subroutine append_facet_weights


  !> u_s(k) - sum_j R(k, j) sum_i N_i u_i(j) = 0; the terms of a node on the axis, which is its own partner, are summed.
  subroutine add_rotated_equation(slave, k, partners, weight, rotation_map, line, equations)
    integer, intent(in) :: slave, k
    integer, intent(in) :: partners(:)
    real(DP), intent(in) :: weight(:), rotation_map(3)     !< row k of R
    integer, intent(in) :: line                    !< of the deck
    type(equation_list_type), intent(inout) :: equations
    type(equation_type) :: equation
    real(DP) :: coefficient
    integer :: i, j, n
    n = 3 * size(partners) + 3
    equation%node = [spread(slave, 1, 3), [(spread(partners(i), 1, 3), i=1, size(partners))]]
    equation%dof = [k, mod(k, 3) + 1, mod(k + 1, 3) + 1, [(1, 2, 3, i=1, size(partners))]]
    equation%coefficient = [1.0_DP, 0.0_DP, 0.0_DP, [((-weight(i) * rotation_map(j), j=1, 3), i=1, size(partners))]]
    do i = 4, n
      if (equation%node(i) /= slave) cycle
      coefficient = equation%coefficient(i)
      equation%coefficient(i) = 0
      do j = 1, 3
        if (equation%dof(j) == equation%dof(i)) equation%coefficient(j) = equation%coefficient(j) + coefficient
      end do
    end do
    associate (is_kept => abs(equation%coefficient) > 1.0e-14_DP)
      if (.not. any(is_kept)) return               ! a node on the axis is free along it
      equation%node = pack(equation%node, is_kept)
      equation%dof = pack(equation%dof, is_kept)
      equation%coefficient = pack(equation%coefficient, is_kept)
    end associate
    equation%n_eliminable = count(equation%node == slave)
    equation%card = 'CYCLIC SYMMETRY'
    equation%line = line
    call equations%add(equation)
  end subroutine add_rotated_equation


  !> Couples the reference node to the mean rigid motion of the surface, weighted by area, or of the given nodes and weights.
  !!
  !! Mean displacement at the centre c and mean rotation t = inverse(J) sum w r x u, J = sum w (r r 1 - r r'); the reference node
  !! has u = u_c + t x (X - c) and the rotation t. Its forces and moments are thereby distributed over the nodes as w (f +
  !! inverse(J) m x r). The arms are those of the undeformed body, under NLGEOM too (as in CalculiX).
  subroutine convert_distributing_coupling(model, mesh, coupling, equations, error)
    type(model_type), intent(in) :: model
    type(mesh_type), intent(in) :: mesh            !< with tied nodes on their masters
    type(distributing_coupling_type), intent(in) :: coupling
    type(equation_list_type), intent(inout) :: equations
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: weight(:), rotation_map(:, :, :), coefficient(:)
    real(DP) :: centre(3), arm(3), mean(3, 3)
    integer, allocatable :: nodes(:), node(:), dof(:)
    integer :: i, k, n
    logical :: is_ok, is_plane
    character(:), allocatable :: card
    card = 'COUPLING'
    if (coupling%surface == 0) card = 'DISTRIBUTING COUPLING'
    if (coupling%surface > 0) then
      nodes = model%surfaces(coupling%surface)%nodes
      call find_nodal_weights(model%surfaces(coupling%surface), mesh, weight)
    else
      nodes = coupling%nodes
      weight = coupling%weight / sum(coupling%weight)
    end if
    n = size(nodes)
    is_plane = all(mesh%is_unstiffened(3, nodes))
    call find_mean_rotation(mesh%coordinates(:, nodes), weight, is_plane, centre, rotation_map, is_ok)
    if (.not. is_ok) then
      call set_error(error, EXIT_SETUP, 'The nodes of a distributing coupling (line ' // to_text(coupling%line) // &
        ') lie on a line; a rotation cannot be spread over them.')
    else if (is_axisymmetric(mesh, nodes)) then
      call set_error(error, EXIT_SETUP, 'A distributing coupling (line ' // to_text(coupling%line) // &
        ') is of axisymmetric elements, which have no mean rigid motion but along their axis; an *EQUATION can bind the mean ' // &
        'displacement along it.')
    end if
    if (allocated(error)) return
    arm = mesh%coordinates(:, coupling%reference) - centre
    node = [0, [(spread(nodes(i), 1, 3), i=1, n)]]
    dof = [0, [(1, 2, 3, i=1, n)]]
    coefficient = [(1.0_DP, i=0, 3 * n)]
    do k = 1, 6
      if (k > 3 .and. .not. coupling%is_bound(modulo(k - 1, 3) + 1)) cycle
      if (is_plane .and. any(k == [3, 4, 5])) cycle
      node(1) = merge(coupling%reference, coupling%rotation, k <= 3)
      dof(1) = modulo(k - 1, 3) + 1
      do i = 1, n
        mean = rotation_map(:, :, i)
        if (k <= 3) mean = weight(i) * IDENTITY + rotation_moment_matrix(arm, rotation_map(:, :, i))
        coefficient(3 * i - 1:3 * i + 1) = -matmul(coupling%axes(:, dof(1)), mean)
      end do
      call equations%add(new_equation(node, dof, coefficient, card, coupling%line))
    end do
  end subroutine convert_distributing_coupling


  !> Whether nodes belong to axisymmetric elements.
  pure logical function is_axisymmetric(mesh, nodes)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: nodes(:)
    logical :: is_coupled(mesh%n_nodes)
    integer :: e
    is_coupled = .false.
    is_coupled(nodes) = .true.
    is_axisymmetric = .false.
    do e = 1, mesh%n_elements
      if (.not. any(is_coupled(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)))) cycle
      is_axisymmetric = is_axisymmetric .or. is_of_revolution(mesh%kind(e))
    end do
  end function is_axisymmetric


  !> The share of each node of a surface in its area, by the shape functions.
  subroutine find_nodal_weights(faces, mesh, weight)
    type(surface_type), intent(in) :: faces
    type(mesh_type), intent(in) :: mesh
    real(DP), allocatable, intent(out) :: weight(:)   !< of surface%nodes, sum 1
    type(element_kind_type) :: kind
    real(DP) :: of_node(mesh%n_nodes)
    integer :: i, e
    integer, allocatable :: nodes(:)
    of_node = 0.0_DP
    do i = 1, size(faces%element)
      e = faces%element(i)
      kind = element_kind(mesh%kind(e))
      associate (local => kind%face_nodes(:, faces%face(i)), facet => kind%face_kind(faces%face(i)))
        nodes = mesh%nodes(mesh%first(e) - 1 + pack(local, local > 0))
        of_node(nodes) = of_node(nodes) + integrate_nodal_areas(mesh%coordinates(:, nodes), facet, out_of_plane_depth(mesh, e))
      end associate
    end do
    weight = of_node(faces%nodes) / sum(of_node(faces%nodes))
  end subroutine find_nodal_weights


  !> The matrix of u -> (rotation of u) x arm.
  pure function rotation_moment_matrix(arm, rotation_map) result(M)
    real(DP), intent(in) :: arm(3), rotation_map(3, 3)
    real(DP) :: M(3, 3)
    integer :: j
    do j = 1, 3
      M(:, j) = cross_product(rotation_map(:, j), arm)
    end do
  end function rotation_moment_matrix


  !> The centre of weighted nodes, and the matrices of the mean rotation t = sum turn_i u_i. In the plane nodes rotate about z
  !! alone.
  pure subroutine find_mean_rotation(x, weight, is_plane, centre, rotation_map, is_ok)
    real(DP), intent(in) :: x(:, :)              !< (3, n) [length]
    real(DP), intent(in) :: weight(:)            !< (n) sum 1
    logical, intent(in) :: is_plane
    real(DP), intent(out) :: centre(3)
    real(DP), allocatable, intent(out) :: rotation_map(:, :, :)   !< (3, 3, n) [1/length]
    logical, intent(out) :: is_ok
    real(DP) :: J_matrix(3, 3), inverse(3, 3), r(3), det, size2
    integer :: i, k
    centre = matmul(x, weight)
    J_matrix = 0.0_DP
    do i = 1, size(weight)
      r = x(:, i) - centre
      J_matrix = J_matrix + weight(i) * dot_product(r, r) * IDENTITY
      do k = 1, 3
        J_matrix(:, k) = J_matrix(:, k) - weight(i) * r * r(k)
      end do
    end do
    if (is_plane) J_matrix = J_matrix(3, 3) * IDENTITY
    size2 = J_matrix(1, 1) + J_matrix(2, 2) + J_matrix(3, 3)
    call invert(J_matrix, inverse, det)
    allocate (rotation_map(3, 3, size(weight)))
    is_ok = abs(det) > 1.0e-12_DP * size2**3
    if (.not. is_ok) return
    do i = 1, size(weight)
      r = x(:, i) - centre
      rotation_map(:, :, i) = weight(i) * matmul(inverse, reshape([0.0_DP, r(3), -r(2), -r(3), 0.0_DP, r(1), r(2), -r(1), &
        0.0_DP], [3, 3]))
    end do
  end subroutine find_mean_rotation

end module amontons_tie_generation
