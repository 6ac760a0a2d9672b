!> Expanded elements: the solids of shells and beams, and their nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! | deck | solid | local nodes |
!! |---|---|---|
!! | S3, S4 | CSS6, CSS8; under the calculix dialect C3D6, C3D8I | bottom, top |
!! | S6, S8 | C3D15, C3D20 | bottom, top; mid-sides below, above; middles of the corner fibres |
!! | SAX1, SAX2 | 8 nodes in the plane, two places of points along it at five heights | bottom, top; the sides between them |
!! | B31 | C3D8I | the axes below |
!! | B32 | 20 nodes with points in the cross-section; under the calculix dialect C3D20 | the axes below |
!!
!! The first local axis of a beam's solid lies along the beam, the second against direction 2, the third along direction 1.
!!
!! A composite shell gives one solid for each layer. S4R is S4 under the abaqus dialect and gives C3D8R under that of calculix; S8R
!! gives C3D20R. The faces: 1 is SNEG, 2 is SPOS, 2 + k is edge k of a shell; of an axisymmetric one 1 is SNEG, 3 is SPOS, 2 and 4
!! are its second and first end.
module amontons_expanded_elements
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, append_nodes, replace_element_nodes, finalize_mesh
  use amontons_structural_data, only: structure_type, structural_section_type, director_type, n_section_layers, &
    layer_heights, SECTION_RECT, SECTION_CIRC, SECTION_PIPE, &
    SECTION_BOX
  use amontons_element_kinds, only: KIND_S3, KIND_S4, KIND_S4R, KIND_S6, KIND_S8, KIND_S8R, KIND_B31, KIND_B31R, KIND_B32, &
    KIND_B32R, KIND_C3D6, KIND_C3D8I, KIND_C3D8R, KIND_C3D15, KIND_C3D15_LAYER, KIND_CSS6, KIND_CSS8, KIND_C3D20, &
    KIND_C3D20R, KIND_BEAM_RECT, KIND_BEAM_PIPE, KIND_BEAM_BOX, KIND_BEAM_CIRC, KIND_BEAM_KRONROD, KIND_SAX2, KIND_CAX_SHELL, &
    FAMILY_BEAM
  implicit none
  private
  public :: expand_elements, expanded_kind

  real(DP), parameter :: TOL_EQUAL_PLACE = 1.0e-9_DP    !< difference of equal places over the thickness [-]

contains

  !> Creates the nodes of the directors and replaces the structural elements by solids.
  subroutine expand_elements(mesh, structure, is_calculix)
    type(mesh_type), intent(inout) :: mesh
    type(structure_type), intent(inout) :: structure   !< in: with directors; out: with their nodes
    logical, intent(in) :: is_calculix           !< dialect
    integer, allocatable :: first(:), nodes(:), solid(:)
    integer :: e, n
    call create_nodes(mesh, structure)
    allocate (first(mesh%n_elements + 1), nodes(20 * mesh%n_elements))
    allocate (mesh%is_shell(mesh%n_elements), source=.false.)
    first(1) = 1
    do e = 1, mesh%n_elements
      associate (from => structure%first(e), to => structure%first(e + 1) - 1)
        if (structure%section(e) == 0) then
          solid = structure%nodes(from:to)
        else
          mesh%kind(e) = expanded_kind(structure%kind(e), is_calculix)
          if (mesh%kind(e) == KIND_C3D15 .and. is_calculix .and. n_section_layers(structure%sections(structure%section(e))) > 1) &
            mesh%kind(e) = KIND_C3D15_LAYER      ! CalculiX has two points over each layer
          call set_beam_section(mesh, structure%sections(structure%section(e)), structure%kind(e), is_calculix, e)
          if (structure%directors(structure%director_of(from))%n_outer == 4) then
            solid = beam_nodes(structure%directors(structure%director_of(from:to)))
          else if (mesh%kind(e) == KIND_CAX_SHELL) then
            mesh%is_shell(e) = .true.
            solid = meridian_nodes(structure%directors(structure%director_of(from:to)), &
              layer_heights(structure%sections(structure%section(e))), mesh%layer(e))
          else
            mesh%is_shell(e) = mesh%kind(e) /= KIND_C3D15 .or. .not. is_calculix
            if (mesh%kind(e) == KIND_CSS6) mesh%is_shell(e) = n_section_layers(structure%sections(structure%section(e))) == 1
            solid = shell_nodes(structure%directors(structure%director_of(from:to)), &
              layer_heights(structure%sections(structure%section(e))), mesh%layer(e))
          end if
        end if
      end associate
      n = size(solid)
      first(e + 1) = first(e) + n
      nodes(first(e):first(e + 1) - 1) = solid
    end do
    call replace_element_nodes(mesh, first, nodes(:first(mesh%n_elements + 1) - 1))
    call finalize_mesh(mesh)
  end subroutine expand_elements


  !> The kind and the walls of a beam by its cross-section. Three places along a curved beam lock: B32 of the abaqus dialect has
  !! two, as B32R. CalculiX integrates B32 at three, and B32R at 5 x 5 points over the section.
  subroutine set_beam_section(mesh, section, kind, is_calculix, e)
    type(mesh_type), intent(inout) :: mesh
    type(structural_section_type), intent(in) :: section
    integer, intent(in) :: kind                  !< KIND_... of the deck
    logical, intent(in) :: is_calculix           !< dialect
    integer, intent(in) :: e                     !< element
    if (section%family /= FAMILY_BEAM) return
    if (kind == KIND_B32 .and. .not. is_calculix) mesh%kind(e) = KIND_BEAM_RECT
    if (kind == KIND_B32R) mesh%kind(e) = merge(KIND_BEAM_KRONROD, KIND_BEAM_RECT, is_calculix)
    select case (section%shape)
    case (SECTION_CIRC)
      if (.not. is_calculix) mesh%kind(e) = KIND_BEAM_CIRC
    case (SECTION_PIPE)
      mesh%kind(e) = KIND_BEAM_PIPE
    case (SECTION_BOX)
      mesh%kind(e) = KIND_BEAM_BOX
    end select
    if (section%shape /= SECTION_PIPE .and. section%shape /= SECTION_BOX .and. (is_calculix .or. mesh%kind(e) /= KIND_C3D8I)) return
    if (.not. allocated(mesh%walls)) allocate (mesh%walls(4, mesh%n_elements), source=0.0_DP)
    mesh%walls(:, e) = section%walls
    if (section%shape == SECTION_RECT) mesh%walls(:, e) = 0.5_DP   ! walls that meet: it bends by a gradient of the temperature
  end subroutine set_beam_section


  !> The solid of a structural kind.
  pure integer function expanded_kind(kind, is_calculix) result(solid)
    integer, intent(in) :: kind                  !< KIND_... of the deck
    logical, intent(in) :: is_calculix           !< dialect
    select case (kind)
    case (KIND_S3)
      solid = merge(KIND_C3D6, KIND_CSS6, is_calculix)
    case (KIND_S4)
      solid = merge(KIND_C3D8I, KIND_CSS8, is_calculix)
    case (KIND_S4R)
      solid = merge(KIND_C3D8R, KIND_CSS8, is_calculix)
    case (KIND_B31)
      solid = KIND_C3D8I
    case (KIND_B31R)
      solid = merge(KIND_C3D8R, KIND_C3D8I, is_calculix)
    case (KIND_S6)
      solid = KIND_C3D15
    case (KIND_S8)
      solid = KIND_C3D20
    case (KIND_B32, KIND_B32R)                   ! a row of C3D20R has hourglass modes
      solid = KIND_C3D20
    case (KIND_S8R)
      solid = KIND_C3D20R
    case (KIND_SAX2)                             ! SAX1 has got a middle node
      solid = KIND_CAX_SHELL
    case default                                 ! not structural
      solid = kind
    end select
  end function expanded_kind


  !> The nodes of all directors; those between the outer ones only where a quadratic element has a corner.
  subroutine create_nodes(mesh, structure)
    type(mesh_type), intent(inout) :: mesh
    type(structure_type), intent(inout) :: structure
    logical, allocatable :: is_corner(:)
    real(DP), allocatable :: x(:, :)
    integer :: e, i, k, n, n_corners
    allocate (is_corner(size(structure%directors)), source=.false.)
    do e = 1, mesh%n_elements
      if (structure%section(e) == 0) cycle
      n_corners = quadratic_corners(structure%kind(e))
      associate (of => structure%director_of(structure%first(e):structure%first(e + 1) - 1))
        if (n_corners == 2) then                 ! a line: end, middle, end
          is_corner(of([1, 3])) = .true.
        else
          is_corner(of(:n_corners)) = .true.
        end if
      end associate
    end do
    n = 0
    do i = 1, size(structure%directors)
      associate (director => structure%directors(i))
        if (director%n_outer == 2) then
          director%has_middles = is_corner(i)
          director%place = fibre_places(structure, director)
          director%nodes = mesh%n_nodes + n + [(k, k=1, size(director%place))]
        else
          director%nodes = mesh%n_nodes + n + [(k, k=1, merge(8, 4, is_corner(i)))]
        end if
        n = n + size(director%nodes)
      end associate
    end do
    allocate (x(3, n))
    do i = 1, size(structure%directors)
      associate (director => structure%directors(i))
        do k = 1, size(director%nodes)
          x(:, director%nodes(k) - mesh%n_nodes) = director_position(director, mesh%coordinates(:, director%node), k)
        end do
      end associate
    end do
    call append_nodes(mesh, x)
  end subroutine create_nodes


  !> The number of corners of a quadratic kind; 0: the kind is linear.
  pure integer function quadratic_corners(kind) result(n)
    integer, intent(in) :: kind                  !< KIND_... of the deck
    select case (kind)
    case (KIND_S6)
      n = 3
    case (KIND_S8, KIND_S8R)
      n = 4
    case (KIND_B32, KIND_B32R, KIND_SAX2)
      n = 2
    case default                                 ! linear
      n = 0
    end select
  end function quadratic_corners


  !> The places of the nodes of a fibre: bottom, top, interfaces and, at a corner of quadratic elements, middles of the layers of
  !! all its sections.
  pure function fibre_places(structure, director) result(place)
    type(structure_type), intent(in) :: structure
    type(director_type), intent(in) :: director
    real(DP), allocatable :: place(:)            !< from 0 at the bottom to 1 on top
    integer :: i, k, n, pass
    place = [0.0_DP, 1.0_DP]
    do pass = 1, merge(2, 1, director%has_middles)
      do i = 1, size(director%sections)
        n = n_section_layers(structure%sections(director%sections(i)))
        associate (height => 0.5_DP + layer_heights(structure%sections(director%sections(i))))
          do k = 1, merge(n - 1, n, pass == 1)   ! height(k) is the bottom of layer k here
            call add_place(merge(height(k + 1), 0.5_DP * (height(k) + height(k + 1)), pass == 1))
          end do
        end associate
      end do
    end do

  contains

    !> Adds a place that is not there yet.
    pure subroutine add_place(at)
      real(DP), intent(in) :: at
      if (all(abs(place - at) > TOL_EQUAL_PLACE)) place = [place, at]
    end subroutine add_place

  end function fibre_places


  !> The position of a node of a director. Shells: bottom, top, interfaces, middles of the layers; beams: corners (-1, +2),
  !! (-1, -2), (+1, -2), (+1, +2), then the sides between them.
  pure function director_position(director, x, k) result(position)
    type(director_type), intent(in) :: director
    real(DP), intent(in) :: x(3)                 !< of the node of the deck [length]
    integer, intent(in) :: k                     !< index into director%nodes
    real(DP) :: position(3)
    real(DP) :: scale                            ! of the corners
    real(DP), parameter :: CROSS_SECTION(2, 8) = 0.5_DP * reshape([real(DP) :: -1, 1, -1, -1, 1, -1, 1, 1, &
      -1, 0, 0, -1, 1, 0, 0, 1], [2, 8])
    if (director%n_outer == 2) then
      position = x + (director%place(k) - 0.5_DP - director%offset(1)) * director%thickness(1) * director%axes(:, 1)
    else
      scale = merge(sqrt(0.5_DP), 1.0_DP, director%is_round .and. k <= 4)
      position = x + matmul(director%axes, (scale * CROSS_SECTION(:, k) - director%offset) * director%thickness)
    end if
  end function director_position


  !> The nodes of the solid of a layer of a shell with 3, 4, 6 or 8 nodes.
  pure function shell_nodes(directors, height, layer) result(nodes)
    type(director_type), intent(in) :: directors(:)   !< at its nodes
    real(DP), intent(in) :: height(0:)           !< of the faces of its layers, from -1/2 to 1/2
    integer, intent(in) :: layer                 !< from the bottom
    integer, allocatable :: nodes(:)
    integer :: n, m, a, below(size(directors)), above(size(directors)), middle(size(directors))
    m = size(directors)
    do a = 1, m
      associate (director => directors(a))
        call find_layer(director, height, layer, below(a), above(a), middle(a))
        below(a) = director%nodes(below(a))
        above(a) = director%nodes(above(a))
        middle(a) = director%nodes(middle(a))
      end associate
    end do
    n = merge(m, m / 2, m <= 4)
    nodes = [below(:n), above(:n)]
    if (m > 4) nodes = [nodes, below(n + 1:), above(n + 1:), middle(:n)]
  end function shell_nodes


  !> The nodes of a fibre at the bottom, the top and the middle of a layer, as indices into its nodes; middle: only at a corner.
  pure subroutine find_layer(director, height, layer, below, above, middle)
    type(director_type), intent(in) :: director
    real(DP), intent(in) :: height(0:)           !< of the faces of the layers, from -1/2 to 1/2
    integer, intent(in) :: layer                 !< from the bottom
    integer, intent(out) :: below, above, middle
    below = minloc(abs(director%place - 0.5_DP - height(layer - 1)), dim=1)
    above = minloc(abs(director%place - 0.5_DP - height(layer)), dim=1)
    middle = minloc(abs(director%place - 0.5_DP - 0.5_DP * (height(layer - 1) + height(layer))), dim=1)
  end subroutine find_layer


  !> The nodes of the solid of a layer of an axisymmetric shell: the normal lies to the left of its line.
  pure function meridian_nodes(directors, height, layer) result(nodes)
    type(director_type), intent(in) :: directors(3)   !< at its nodes: end, middle, end
    real(DP), intent(in) :: height(0:)           !< of the faces of its layers, from -1/2 to 1/2
    integer, intent(in) :: layer                 !< from the bottom
    integer :: nodes(8), below, above, middle
    call find_layer(directors(1), height, layer, below, above, middle)
    associate (p => directors(1)%nodes, m => directors(2)%nodes, q => directors(3)%nodes)
      nodes = [p(below), q(below), q(above), p(above), m(below), q(middle), m(above), p(middle)]
    end associate
  end function meridian_nodes


  !> The nodes of the solid of a beam with 2 or 3 nodes.
  pure function beam_nodes(directors) result(nodes)
    type(director_type), intent(in) :: directors(:)   !< at its nodes: end, (middle,) end
    integer, allocatable :: nodes(:)
    associate (p => directors(1)%nodes, q => directors(size(directors))%nodes)
      nodes = [p(1), q(1), q(2), p(2), p(4), q(4), q(3), p(3)]
      if (size(directors) == 2) return
      associate (m => directors(2)%nodes)
        nodes = [nodes, m(1), q(5), m(2), p(5), m(4), q(7), m(3), p(7), p(8), q(8), q(6), p(6)]
      end associate
    end associate
  end function beam_nodes

end module amontons_expanded_elements
