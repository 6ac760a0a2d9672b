!> Shells, membranes and beams as the deck has them: sections, thickness and normals at the nodes, the elements before expansion.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_structural_data
  use amontons_kinds, only: DP
  implicit none
  private
  public :: structural_section_type, layer_type, structure_type, director_type
  public :: SECTION_RECT, SECTION_CIRC, SECTION_PIPE, SECTION_BOX
  public :: find_node_directors, expanded_nodes, mean_weights, layer_weights, force_weights, n_section_layers, layer_heights, &
    middle_node, parabola_weights, following_nodes, interpolate_added_nodes

  integer, parameter :: SECTION_RECT = 1     !< cross-section of a beam: a rectangle
  integer, parameter :: SECTION_CIRC = 2     !< a circle or an ellipse
  integer, parameter :: SECTION_PIPE = 3     !< a circle with a concentric hole
  integer, parameter :: SECTION_BOX = 4      !< a rectangle with a rectangular hole

  !> A layer of a composite shell.
  type :: layer_type
    real(DP) :: thickness = 0                !< [length]
    integer :: material = 0                  !< index into the materials of the model; 0: an unknown name
    character(:), allocatable :: orientation !< name; empty: that of the section
    real(DP) :: angle = 0                    !< about the normal, from the orientation of the section [rad]
    integer :: line = 0                      !< physical line of its data line, for messages
  end type layer_type

  !> SHELL SECTION, MEMBRANE SECTION or BEAM SECTION.
  type :: structural_section_type
    integer :: family = 0                    !< FAMILY_... of its elements
    real(DP) :: thickness(2) = 0             !< shells: the first; beams: along direction 1 and 2 [length]
    real(DP) :: offset(2) = 0                !< position of the nodes: over the thickness from its middle, towards positive [-]
    logical :: has_nodal_thickness = .false.
    integer :: shape = 1                     !< beams: SECTION_...
    real(DP) :: walls(4) = 0                 !< hollow beams: thickness over the dimension, see module beam_rules [-]
    real(DP) :: direction(3) = 0             !< beams: first local direction
    type(layer_type), allocatable :: layers(:)   !< COMPOSITE: from bottom to top; unallocated: one layer
    character(:), allocatable :: orientation !< shells: name of the ORIENTATION; empty: none
    character(:), allocatable :: card        !< keyword, for messages
    integer :: line = 0                      !< of the deck, for messages
    integer :: deck_line = 0                 !< the same as the reader counts, with included files
  end type structural_section_type

  !> What a node of some elements expands into: the nodes of its fibre (shells) or of its cross-section (beams).
  !!
  !! A fibre through n layers: bottom, top, the n - 1 interfaces, then the middles of the layers at corners of quadratic elements.
  !! One that elements of different layers share has the interfaces of all of them, then the middles; each place once. A
  !! cross-section: its corners, then the middles of its sides at the ends of quadratic elements.
  type :: director_type
    integer :: node = 0                      !< of the deck
    integer :: n_outer = 0                   !< 2: bottom and top of a fibre; 4: corners of a cross-section
    integer, allocatable :: nodes(:)         !< in the order above
    real(DP), allocatable :: height(:)       !< (0:n_layers) of the faces of the layers, from -1/2 to 1/2 [-]
    real(DP), allocatable :: place(:)        !< of a fibre: of its nodes, from 0 at the bottom to 1 on top [-]
    logical :: has_middles = .false.         !< a fibre at a corner of quadratic elements
    real(DP) :: axes(3, 2) = 0               !< unit vectors: the normal of a shell; both local directions of a beam
    real(DP) :: thickness(2) = 0             !< along them [length]
    real(DP) :: offset(2) = 0                !< of the node over the thickness from the middle, along them [-]
    integer :: section = 0                   !< of the first element that has it
    integer, allocatable :: sections(:)      !< of all elements that have it
    logical :: is_meridional = .false.       !< the fibre of an axisymmetric shell: it stays in the plane
    logical :: is_one_solid = .false.        !< of quadratic shells of the calculix dialect: all their layers are one solid each
    logical :: is_parabolic = .false.        !< of them, of several layers: its displacement is one parabola
    logical :: is_round = .false.            !< the corners of the cross-section lie on an ellipse through the middles of its sides
  end type director_type

  !> All of them.
  type :: structure_type
    type(structural_section_type), allocatable :: sections(:)
    integer, allocatable :: section(:)           !< (n_elements) index into sections; 0: not structural
    integer, allocatable :: kind(:)              !< (n_elements) KIND_... of the deck
    integer, allocatable :: first(:)             !< (n_elements + 1) start of an element's nodes of the deck
    integer, allocatable :: nodes(:)             !< nodes of the deck of all elements, one after the other
    real(DP), allocatable :: nodal_thickness(:, :)   !< (2, n_nodes) NODAL THICKNESS; 0: not given [length]
    real(DP), allocatable :: given_normal(:, :)      !< (3, size(nodes)) NORMAL, unit vectors; 0: not given
    logical, allocatable :: is_turned(:)         !< (n_nodes) rotations or moments are prescribed there
    logical, allocatable :: is_driven(:, :)      !< (3, n_nodes) a moment, a coupling or a beam turns it about this axis
    logical, allocatable :: is_constrained(:, :) !< (3, n_nodes) calculix dialect: it is the mean of outer nodes, see mean_weights
    logical, allocatable :: is_follower(:)       !< (n_nodes) a force turns with it, which takes finite rotations
    logical, allocatable :: is_plane(:)          !< (n_nodes) of a beam in the plane or of an axisymmetric shell
    integer, allocatable :: held_from(:, :)      !< (6, n_nodes) first step that prescribes the degree of freedom; 0: none does
    integer, allocatable :: rotation_terms(:, :) !< (3, :) rotations in EQUATION: number of the equation, node, direction 1 to 3
    integer :: n_deck_nodes = 0                  !< nodes before expansion
    ! The expansion:
    type(director_type), allocatable :: directors(:)
    integer, allocatable :: added_between(:, :)  !< (3, :) a node of a cross-section that the reader added between the ends of a
                                                 !! line of two nodes, and the nodes of these ends beside it
    integer, allocatable :: director_of(:)       !< (size(nodes)) index into directors; 0: of an element that is not structural
  end type structure_type

contains

  !> The directors of a node: first to last; last < first: it has none. They are ordered by their nodes; a deck with errors in its
  !! mesh is not expanded and has none.
  pure subroutine find_node_directors(structure, node, first, last)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: node
    integer, intent(out) :: first, last
    integer :: above, middle
    first = 1
    last = 0
    if (.not. allocated(structure%directors)) return
    above = size(structure%directors) + 1
    do while (first < above)
      middle = (first + above) / 2
      if (structure%directors(middle)%node < node) then
        first = middle + 1
      else
        above = middle
      end if
    end do
    last = first - 1
    do while (last < size(structure%directors))
      if (structure%directors(last + 1)%node /= node) exit
      last = last + 1
    end do
  end subroutine find_node_directors


  !> The weights of the nodes of a director in the displacement of its node.
  !!
  !! Shells: by Simpson's rule where the fibre has one middle. Under the abaqus dialect a node off the middle moves as the place of
  !! the fibre or cross-section where it is. Fibres through several layers: the displacement of that place in its layer; where these
  !! are one solid, as of this solid. At nodes that more than supports constrain CalculiX takes the mean of bottom and top.
  pure function mean_weights(director, is_calculix, is_constrained) result(weight)
    type(director_type), intent(in) :: director
    logical, intent(in) :: is_calculix           !< dialect
    logical, intent(in) :: is_constrained        !< in this direction, see structure_type
    real(DP) :: weight(size(director%nodes)), s(2)
    s = merge([0.0_DP, 0.0_DP], director%offset, is_calculix)
    weight = 0
    if (director%n_outer == 4) then              ! bilinear in the cross-section
      weight(:4) = (0.5_DP + [-s(1), -s(1), s(1), s(1)]) * (0.5_DP + [s(2), -s(2), -s(2), s(2)])
    else if (is_constrained) then
      weight(:2) = 0.5_DP
    else if (director%is_parabolic) then
      weight(:2) = 0.5_DP
      if (middle_node(director) > 0) weight = solid_weights(director, [real(DP) :: 1, 1, 4] / 6)
    else if (n_director_layers(director) > 1) then
      weight = layer_weights(director, s(1))
    else if (size(director%nodes) == 3 .and. .not. abs(s(1)) > 0) then
      weight(:3) = [real(DP) :: 1, 1, 4] / 6
    else
      weight(:2) = 0.5_DP + [-s(1), s(1)]
    end if
  end function mean_weights


  !> The weights of the faces of the layers at a place of the fibre of a shell: linear in the layer where it lies, or beyond the
  !! outer ones.
  pure function layer_weights(director, place) result(weight)
    type(director_type), intent(in) :: director
    real(DP), intent(in) :: place                !< over the thickness from the middle [-]
    real(DP) :: weight(size(director%nodes)), share
    integer :: k, n
    n = n_director_layers(director)
    k = min(n, max(1, count(director%height(:n - 1) <= place)))   ! its layer
    weight = 0
    share = (place - director%height(k - 1)) / (director%height(k) - director%height(k - 1))
    weight(level_node(k - 1)) = 1 - share
    weight(level_node(k)) = share

  contains

    !> The place of a face of the layers among the nodes.
    pure integer function level_node(level)
      integer, intent(in) :: level               !< 0 to n
      level_node = merge(1, merge(2, 2 + level, level == n), level == 0)
    end function level_node

  end function layer_weights


  !> The places of the faces of the layers of a section over its thickness, from -1/2 to 1/2.
  pure function layer_heights(section) result(height)
    type(structural_section_type), intent(in) :: section
    real(DP) :: height(0:n_section_layers(section))
    integer :: k
    height(0) = -0.5_DP
    height(ubound(height, 1)) = 0.5_DP
    do k = 1, ubound(height, 1) - 1
      height(k) = sum(section%layers(:k)%thickness) / sum(section%layers%thickness) - 0.5_DP
    end do
  end function layer_heights


  !> The inner node nearest to the middle of a fibre at a corner, as an index into its nodes; 0: the fibre is not at a corner. It is
  !! at most a sixth of the thickness off the middle.
  pure integer function middle_node(director) result(middle)
    type(director_type), intent(in) :: director
    middle = 0
    if (director%has_middles) middle = 2 + minloc(abs(director%place(3:) - 0.5_DP), dim=1)
  end function middle_node


  !> Whether nodes of the mesh follow others of their fibre, whose displacement is a parabola.
  pure function following_nodes(structure, n_nodes) result(follows)
    type(structure_type), intent(in), allocatable :: structure
    integer, intent(in) :: n_nodes               !< of the mesh
    logical :: follows(n_nodes)
    integer :: i, k
    follows = .false.
    if (.not. allocated(structure)) return
    if (.not. allocated(structure%directors)) return
    do i = 1, size(structure%directors)
      associate (director => structure%directors(i))
        if (.not. director%is_parabolic) cycle
        k = middle_node(director)
        follows(director%nodes(3:)) = .true.
        if (k > 0) follows(director%nodes(k)) = .false.
      end associate
    end do
  end function following_nodes


  !> The weights of bottom, top and middle_node at a place of a fibre whose displacement is a parabola.
  pure function parabola_weights(director, place) result(weight)
    type(director_type), intent(in) :: director
    real(DP), intent(in) :: place                !< 0 at the bottom, 1 on top
    real(DP) :: weight(3), m
    m = director%place(middle_node(director))
    weight = [(1 - place) * (m - place) / m, place * (place - m) / (1 - m), place * (1 - place) / (m * (1 - m))]
  end function parabola_weights


  !> Weights of bottom, top and middle of a fibre whose displacement is a parabola, as those of its nodes.
  pure function solid_weights(director, of_solid) result(weight)
    type(director_type), intent(in) :: director
    real(DP), intent(in) :: of_solid(3)          !< bottom, top, middle
    real(DP) :: weight(size(director%nodes))
    weight = 0
    weight([1, 2, middle_node(director)]) = of_solid(3) * parabola_weights(director, 0.5_DP) + [of_solid(:2), 0.0_DP]
  end function solid_weights


  !> The number of layers of a director; 1 for beams.
  pure integer function n_director_layers(director) result(n)
    type(director_type), intent(in) :: director
    n = 1
    if (allocated(director%height)) n = ubound(director%height, 1)
  end function n_director_layers


  !> The number of layers of a section; 1 for all but COMPOSITE.
  pure integer function n_section_layers(section) result(n)
    type(structural_section_type), intent(in) :: section
    n = 1
    if (allocated(section%layers)) n = size(section%layers)
  end function n_section_layers


  !> The shares of the nodes of a director in a force at its node: as in the displacement, but a fibre with one middle takes that of
  !! an edge of a quadratic face under an even traction, as in CalculiX; not that of an axisymmetric shell.
  pure function force_weights(director, is_calculix, is_constrained) result(weight)
    type(director_type), intent(in) :: director
    logical, intent(in) :: is_calculix           !< dialect
    logical, intent(in) :: is_constrained        !< in this direction, see structure_type
    real(DP) :: weight(size(director%nodes))
    weight = mean_weights(director, is_calculix, is_constrained)
    if (is_constrained) return
    if (director%is_parabolic .and. middle_node(director) > 0) weight = solid_weights(director, [-0.5_DP, -0.5_DP, 2.0_DP])
    if (director%n_outer == 4 .or. n_director_layers(director) > 1 .or. size(weight) < 3 .or. director%is_meridional) return
    if (abs(weight(3)) > 0) weight = [-0.5_DP, -0.5_DP, 2.0_DP]
  end function force_weights


  !> Gives the nodes that the reader added between the ends of lines the mean of these ends: temperatures, then field variables.
  pure subroutine interpolate_added_nodes(structure, n_nodes, values)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: n_nodes               !< of the mesh
    real(DP), intent(inout) :: values(:)         !< (a multiple of n_nodes) [temperature]
    integer :: k
    if (.not. allocated(structure%added_between)) return
    do k = 0, size(values) - n_nodes, n_nodes
      associate (added => structure%added_between)
        values(k + added(1, :)) = 0.5_DP * (values(k + added(2, :)) + values(k + added(3, :)))
      end associate
    end do
  end subroutine interpolate_added_nodes


  !> Nodes, then those into which they expand.
  pure function expanded_nodes(structure, nodes) result(all_nodes)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: nodes(:)
    integer, allocatable :: all_nodes(:), found(:)
    integer :: i, k, n, first, last
    n = 0
    if (allocated(structure%directors)) n = sum([(size(structure%directors(k)%nodes), k=1, size(structure%directors))])
    allocate (found(n))
    n = 0
    do i = 1, size(nodes)
      call find_node_directors(structure, nodes(i), first, last)
      do k = first, last
        associate (new => structure%directors(k)%nodes)
          found(n + 1:n + size(new)) = new
          n = n + size(new)
        end associate
      end do
    end do
    all_nodes = [nodes, found(:n)]
  end function expanded_nodes

end module amontons_structural_data
