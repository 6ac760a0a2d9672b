!> Directors: the normals of shells and the axes of beam sections at the nodes, shared by elements that meet smoothly.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A node has one director for all its elements whose normals lie within 20 degrees of that of the first of them, and that have
!! the same thickness, offset and, unless they are one solid, layers: the mean of these normals. Elements with a *NORMAL come first
!! and are gathered within 0.5 degrees. A node with several directors is a knot (module knots). In rigid bodies, which need no
!! knots, elements share it over right angles too, so that their faces stay connected. Source: CalculiX CrunchiX manual,
!! Eight-node shell element.
module amontons_directors
  use amontons_kinds, only: DP, PI
  use amontons_mesh, only: mesh_type
  use amontons_shape_functions, only: facet_shapes, facet_node_coordinates
  use amontons_structural_data, only: structure_type, structural_section_type, director_type, n_section_layers, layer_heights, &
    SECTION_CIRC
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: element_kind_type, element_kind, FACET_TRI3, FACET_QUAD4, FACET_TRI6, FACET_QUAD8, &
    FAMILY_BEAM, KIND_S6, KIND_S8, KIND_S8R, KIND_SAX2, MAX_FACE_NODES
  implicit none
  private
  public :: find_directors, find_element_normals

  real(DP), parameter :: SMOOTH_ANGLE = 20.0_DP * PI / 180   !< largest angle between normals that become one [rad]
  real(DP), parameter :: GIVEN_ANGLE = 0.5_DP * PI / 180     !< the same, of *NORMAL [rad]
  real(DP), parameter :: RIGID_ANGLE = 91.0_DP * PI / 180    !< the same, of rigid elements: their mean is never zero [rad]
  real(DP), parameter :: TOL_FLAT = 1.0e-10_DP   !< area at a node over the square of the element's size, below: no normal [-]
  real(DP), parameter :: TOL_SAME = 1.0e-9_DP    !< relative difference of equal thicknesses and offsets [-]

contains

  !> The directors of all nodes of structural elements.
  subroutine find_directors(mesh, structure, is_calculix, bad_element)
    type(mesh_type), intent(in) :: mesh          !< not yet expanded
    type(structure_type), intent(inout) :: structure   !< out: with directors, director_of
    logical, intent(in) :: is_calculix           !< dialect, which knows no symmetry planes
    integer, intent(out) :: bad_element          !< an element without a normal at one of its nodes; 0: none
    type(director_type), allocatable :: own(:), found(:)
    integer, allocatable :: first(:), position(:)
    integer :: e, i, n, node
    allocate (own(size(structure%nodes)), found(size(structure%nodes)))
    allocate (structure%director_of(size(structure%nodes)), source=0)
    bad_element = 0
    do e = 1, mesh%n_elements
      if (structure%section(e) == 0) cycle
      call find_own_directors(mesh, structure, e, is_calculix, own(structure%first(e):structure%first(e + 1) - 1))
      do i = structure%first(e), structure%first(e + 1) - 1
        if (.not. norm2(own(i)%axes(:, 1)) > 0) bad_element = e
      end do
    end do
    if (bad_element > 0) return
    call list_positions(mesh, structure, first, position)
    n = 0
    do node = 1, mesh%n_nodes
      call join_directors(structure, position(first(node):first(node + 1) - 1), own, found, n)
    end do
    structure%directors = found(:n)
    if (.not. is_calculix) call reflect_normals(structure)
  end subroutine find_directors


  !> At nodes of a symmetry plane the normal lies in the plane: it is the mean with its mirror image, if they meet smoothly. Nodes
  !! of an axisymmetric shell are held so by one displacement and the rotation in the plane.
  subroutine reflect_normals(structure)
    type(structure_type), intent(inout) :: structure
    logical :: is_held(6)
    integer :: i, k
    do i = 1, size(structure%directors)
      associate (director => structure%directors(i))
        if (director%n_outer == 4) cycle
        is_held = structure%held_from(:, director%node) > 0
        do k = 1, 3
          if (director%is_meridional) is_held(4:) = is_held(6) .and. .not. all(is_held(:2)) .and. [4, 5, 6] /= 3 + k
          if (.not. is_held(k) .or. any(is_held(4:) .eqv. [4, 5, 6] == 3 + k)) cycle   ! its symmetry: u_k and the other rotations
          associate (normal => director%axes(:, 1))
            if (2 * abs(normal(k)) > sin(SMOOTH_ANGLE)) cycle
            normal(k) = 0
            normal = normal / norm2(normal)
          end associate
        end do
      end associate
    end do
  end subroutine reflect_normals


  !> For each node, its places in the node lists of structural elements.
  pure subroutine list_positions(mesh, structure, first, position)
    type(mesh_type), intent(in) :: mesh
    type(structure_type), intent(in) :: structure
    integer, allocatable, intent(out) :: first(:), position(:)   !< (n_nodes + 1); places of node i: first(i) to first(i + 1) - 1
    integer :: e, i
    allocate (first(mesh%n_nodes + 1), source=0)
    do e = 1, mesh%n_elements
      if (structure%section(e) == 0) cycle
      do i = structure%first(e), structure%first(e + 1) - 1
        first(structure%nodes(i)) = first(structure%nodes(i)) + 1
      end do
    end do
    first(mesh%n_nodes + 1) = 1 + sum(first)
    do i = mesh%n_nodes, 1, -1
      first(i) = first(i + 1) - first(i)
    end do
    allocate (position(first(mesh%n_nodes + 1) - 1))
    call fill_positions(mesh, structure, first, position)
  end subroutine list_positions


  !> Fills the places in the order of the elements.
  pure subroutine fill_positions(mesh, structure, first, position)
    type(mesh_type), intent(in) :: mesh
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: first(:)
    integer, intent(out) :: position(:)
    integer, allocatable :: next(:)
    integer :: e, i
    next = first
    do e = 1, mesh%n_elements
      if (structure%section(e) == 0) cycle
      do i = structure%first(e), structure%first(e + 1) - 1
        position(next(structure%nodes(i))) = i
        next(structure%nodes(i)) = next(structure%nodes(i)) + 1
      end do
    end do
  end subroutine fill_positions


  !> The directors of one element by itself.
  subroutine find_own_directors(mesh, structure, e, is_calculix, own)
    type(mesh_type), intent(in) :: mesh
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: e
    logical, intent(in) :: is_calculix           !< dialect
    type(director_type), intent(out) :: own(:)   !< (nodes of the element)
    real(DP) :: normals(3, size(own))
    integer :: a, i
    associate (section => structure%sections(structure%section(e)), nodes => structure%nodes(structure%first(e): &
      structure%first(e + 1) - 1))
      own%section = structure%section(e)
      own%node = nodes
      own%n_outer = merge(4, 2, section%family == FAMILY_BEAM)
      own%is_meridional = structure%kind(e) == KIND_SAX2
      do a = 1, size(own)
        allocate (own(a)%height(0:n_section_layers(section)), source=layer_heights(section))
      end do
      if (structure%kind(e) == KIND_SAX2) then
        call find_meridian_normals(mesh%coordinates(:, nodes), normals)
      else if (section%family /= FAMILY_BEAM) then
        call find_element_normals(mesh%coordinates(:, nodes), normals)
      end if
      do a = 1, size(own)
        own(a)%offset = section%offset
        own(a)%is_round = is_calculix .and. section%shape == SECTION_CIRC
        own(a)%is_one_solid = is_calculix .and. any(structure%kind(e) == [KIND_S6, KIND_S8, KIND_S8R])
        own(a)%is_parabolic = own(a)%is_one_solid .and. n_section_layers(section) > 1
        own(a)%sections = [own(a)%section]
        own(a)%thickness = section%thickness
        if (section%has_nodal_thickness) own(a)%thickness = structure%nodal_thickness(:, nodes(a))
        i = structure%first(e) + a - 1
        if (section%family == FAMILY_BEAM) then
          own(a)%axes = beam_axes(mesh%coordinates(:, nodes), a, section%direction, structure%given_normal(:, i))
        else if (norm2(structure%given_normal(:, i)) > 0) then
          own(a)%axes(:, 1) = structure%given_normal(:, i)
        else
          own(a)%axes(:, 1) = normals(:, a)
        end if
      end do
    end associate
  end subroutine find_own_directors


  !> Both local directions of a beam at one of its nodes: the first is the part of the given direction normal to the tangent, the
  !! second tangent x first. Zero where the direction is along the beam.
  pure function beam_axes(x, a, direction, given) result(axes)
    real(DP), intent(in) :: x(:, :)              !< (3, 2 or 3) coordinates: end, (middle,) end [length]
    integer, intent(in) :: a                     !< local node
    real(DP), intent(in) :: direction(3)         !< of the section
    real(DP), intent(in) :: given(3)             !< NORMAL; 0: none
    real(DP) :: axes(3, 2), tangent(3)
    tangent = line_tangent(x, a)
    axes = 0
    if (.not. norm2(tangent) > 0) return
    tangent = tangent / norm2(tangent)
    axes(:, 1) = merge(given, direction, norm2(given) > 0)
    if (norm2(cross_product(axes(:, 1), tangent)) > TOL_FLAT * norm2(axes(:, 1))) then
      axes(:, 1) = normal_part(axes(:, 1), tangent)
      axes(:, 2) = cross_product(tangent, axes(:, 1))
    else
      axes = 0
    end if
  end function beam_axes


  !> The tangent of a line at one of its nodes, per natural coordinate.
  pure function line_tangent(x, a) result(tangent)
    real(DP), intent(in) :: x(:, :)              !< (3, 2 or 3) coordinates: end, (middle,) end [length]
    integer, intent(in) :: a                     !< local node
    real(DP) :: tangent(3), xi
    if (size(x, 2) == 2) then
      tangent = x(:, 2) - x(:, 1)
    else
      xi = real(a - 2, DP)
      tangent = matmul(x, [xi - 0.5_DP, -2 * xi, xi + 0.5_DP])
    end if
  end function line_tangent


  !> The unit normals of an axisymmetric shell at its nodes, to the left of its line; zero where it has none. On the axis of
  !! revolution a fibre lies along it.
  pure subroutine find_meridian_normals(x, normals)
    real(DP), intent(in) :: x(:, :)              !< (3, 3) coordinates: end, middle, end; the first is the radius [length]
    real(DP), intent(out) :: normals(:, :)       !< (3, 3)
    real(DP) :: tangent(3)
    integer :: a
    normals = 0
    do a = 1, size(x, 2)
      tangent = line_tangent(x, a)
      normals(:2, a) = [-tangent(2), tangent(1)]
      if (abs(x(1, a)) <= TOL_FLAT * maxval(abs(x))) normals(1, a) = 0
      if (norm2(normals(:, a)) > TOL_FLAT * norm2(tangent)) then
        normals(:, a) = normals(:, a) / norm2(normals(:, a))
      else
        normals(:, a) = 0
      end if
    end do
  end subroutine find_meridian_normals


  !> The unit normals of a surface of 3, 4, 6 or 8 nodes at its nodes; zero where it has none.
  pure subroutine find_element_normals(x, normals)
    real(DP), intent(in) :: x(:, :)              !< (3, n) coordinates [length]
    real(DP), intent(out) :: normals(:, :)       !< (3, n)
    real(DP) :: N(MAX_FACE_NODES), dN(2, MAX_FACE_NODES), ddN(3, MAX_FACE_NODES), places(2, MAX_FACE_NODES), across(3), extent
    integer :: kind, a, m
    integer, parameter :: KINDS(3:8) = [FACET_TRI3, FACET_QUAD4, 0, FACET_TRI6, 0, FACET_QUAD8]
    m = size(x, 2)
    kind = KINDS(m)
    extent = norm2(maxval(x, dim=2) - minval(x, dim=2))
    normals = 0
    call facet_node_coordinates(kind, places)
    do a = 1, m
      call facet_shapes(kind, places(:, a), N, dN, ddN)
      across = cross_product(matmul(x, dN(1, :m)), matmul(x, dN(2, :m)))
      if (norm2(across) > TOL_FLAT * extent**2) normals(:, a) = across / norm2(across)
    end do
  end subroutine find_element_normals


  !> Joins the directors of one node: those with *NORMAL first, then the others, each time from the first that is left.
  subroutine join_directors(structure, position, own, found, n)
    type(structure_type), intent(inout) :: structure   !< out: director_of of these places
    integer, intent(in) :: position(:)           !< places of the node
    type(director_type), intent(in) :: own(:)    !< at all places
    type(director_type), intent(inout) :: found(:)
    integer, intent(inout) :: n                  !< number of those found
    logical :: is_given(size(position)), is_left(size(position))
    integer :: pass, i, k
    real(DP) :: angle
    is_given = [(norm2(structure%given_normal(:, position(i))) > 0, i=1, size(position))]
    is_left = .true.
    do pass = 1, 2
      do i = 1, size(position)
        if (.not. is_left(i) .or. (pass == 1 .and. .not. is_given(i))) cycle
        angle = merge(GIVEN_ANGLE, SMOOTH_ANGLE, pass == 1)
        n = n + 1
        found(n) = own(position(i))
        found(n)%axes = 0
        if (is_of_rigid_body(structure, found(n)%section)) angle = RIGID_ANGLE
        do k = 1, size(position)
          if (.not. is_left(k)) cycle
          if (.not. is_smooth(own(position(i)), own(position(k)), angle)) cycle
          is_left(k) = .false.
          structure%director_of(position(k)) = n
          found(n)%axes = found(n)%axes + own(position(k))%axes
          found(n)%is_parabolic = found(n)%is_parabolic .or. own(position(k))%is_parabolic
          if (.not. any(found(n)%sections == own(position(k))%section)) &
            found(n)%sections = [found(n)%sections, own(position(k))%section]
        end do
        found(n)%axes(:, 1) = found(n)%axes(:, 1) / norm2(found(n)%axes(:, 1))
        if (found(n)%n_outer == 4) found(n)%axes(:, 2) = normal_part(found(n)%axes(:, 2), found(n)%axes(:, 1))
      end do
    end do
  end subroutine join_directors


  !> Whether a section is that of rigid elements.
  pure logical function is_of_rigid_body(structure, section)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: section               !< index into its sections
    is_of_rigid_body = allocated(structure%sections(section)%card)
    if (is_of_rigid_body) is_of_rigid_body = structure%sections(section)%card == 'RIGID BODY'
  end function is_of_rigid_body


  !> The unit vector of the part of a normal to b.
  pure function normal_part(a, b) result(across)
    real(DP), intent(in) :: a(3), b(3)           !< b: a unit vector
    real(DP) :: across(3)
    across = a - dot_product(a, b) * b
    across = across / norm2(across)
  end function normal_part


  !> Whether two elements may share a director at a node.
  pure logical function is_smooth(one, other, angle)
    type(director_type), intent(in) :: one, other
    real(DP), intent(in) :: angle                !< largest [rad]
    real(DP) :: turn
    integer :: k
    is_smooth = .false.
    if (one%n_outer /= other%n_outer .or. (one%is_round .neqv. other%is_round)) return
    if (any(abs(one%thickness - other%thickness) > TOL_SAME * maxval(one%thickness))) return
    if (any(abs(one%offset - other%offset) > TOL_SAME)) return
    if (.not. (one%is_one_solid .and. other%is_one_solid)) then
      if (size(one%height) /= size(other%height)) return
      if (any(abs(one%height - other%height) > TOL_SAME)) return
    end if
    do k = 1, merge(2, 1, one%n_outer == 4)
      turn = atan2(norm2(cross_product(one%axes(:, k), other%axes(:, k))), dot_product(one%axes(:, k), other%axes(:, k)))
      if (turn > angle) return
    end do
    is_smooth = .true.
  end function is_smooth

end module amontons_directors
