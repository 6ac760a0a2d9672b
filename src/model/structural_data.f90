!> Shells, membranes and beams as the deck has them: sections, thickness and normals at the nodes, the elements before expansion.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_structural_data
  use amontons_kinds, only: DP
  implicit none
  private
  public :: structural_section_type, structure_type, director_type
  public :: MAX_DIRECTOR_NODES, find_node_directors, expanded_nodes, mean_weights, force_weights

  integer, parameter :: MAX_DIRECTOR_NODES = 8   !< most nodes into which one node expands

  !> SHELL SECTION, MEMBRANE SECTION or BEAM SECTION.
  type :: structural_section_type
    integer :: family = 0                    !< FAMILY_... of its elements
    real(DP) :: thickness(2) = 0             !< shells: the first; beams: along direction 1 and 2 [length]
    real(DP) :: offset(2) = 0                !< position of the nodes: over the thickness from its middle, towards positive [-]
    logical :: has_nodal_thickness = .false.
    real(DP) :: direction(3) = 0             !< beams: first local direction
    character(:), allocatable :: card        !< keyword, for messages
    integer :: line = 0                      !< of the deck, for messages
  end type structural_section_type

  !> What a node of some elements expands into: the nodes of its fibre (shells) or of its cross-section (beams).
  type :: director_type
    integer :: node = 0                      !< of the deck
    integer :: n_outer = 0                   !< 2: bottom and top of a fibre; 4: corners of a cross-section
    integer :: nodes(MAX_DIRECTOR_NODES) = 0 !< the outer ones; then the middle of the fibre, or those of the sides; 0: none
    real(DP) :: axes(3, 2) = 0               !< unit vectors: the normal of a shell; both local directions of a beam
    real(DP) :: thickness(2) = 0             !< along them [length]
    real(DP) :: offset(2) = 0                !< of the node over the thickness from the middle, along them [-]
    integer :: section = 0                   !< of the first element that has it
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
    integer, allocatable :: held_from(:, :)      !< (6, n_nodes) first step that prescribes the degree of freedom; 0: none does
    integer :: n_deck_nodes = 0                  !< nodes before expansion
    ! The expansion:
    type(director_type), allocatable :: directors(:)
    integer, allocatable :: director_of(:)       !< (size(nodes)) index into directors; 0: of an element that is not structural
  end type structure_type

contains

  !> The directors of a node: first to last; last < first: it has none. They are ordered by their nodes.
  pure subroutine find_node_directors(structure, node, first, last)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: node
    integer, intent(out) :: first, last
    integer :: above, middle
    first = 1
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
  !! Shells: by Simpson's rule where the fibre has a middle. Under the abaqus dialect a node off the middle moves as the place of
  !! the fibre or cross-section where it is.
  pure function mean_weights(director, is_calculix) result(weight)
    type(director_type), intent(in) :: director
    logical, intent(in) :: is_calculix           !< dialect
    real(DP) :: weight(MAX_DIRECTOR_NODES), s(2)
    s = merge([0.0_DP, 0.0_DP], director%offset, is_calculix)
    weight = 0
    if (director%n_outer == 4) then              ! bilinear in the cross-section
      weight(:4) = (0.5_DP + [-s(1), -s(1), s(1), s(1)]) * (0.5_DP + [s(2), -s(2), -s(2), s(2)])
    else if (director%nodes(3) > 0 .and. .not. abs(s(1)) > 0) then
      weight(:3) = [real(DP) :: 1, 1, 4] / 6
    else
      weight(:2) = 0.5_DP + [-s(1), s(1)]
    end if
  end function mean_weights


  !> The shares of the nodes of a director in a force at its node: as in the displacement, but a fibre with a middle takes that of
  !! an edge of a quadratic face under an even traction, as in CalculiX.
  pure function force_weights(director, is_calculix) result(weight)
    type(director_type), intent(in) :: director
    logical, intent(in) :: is_calculix           !< dialect
    real(DP) :: weight(MAX_DIRECTOR_NODES)
    weight = mean_weights(director, is_calculix)
    if (director%n_outer == 2 .and. abs(weight(3)) > 0) weight(:3) = [-0.5_DP, -0.5_DP, 2.0_DP]
  end function force_weights


  !> Nodes, then those into which they expand.
  pure function expanded_nodes(structure, nodes) result(all_nodes)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: nodes(:)
    integer, allocatable :: all_nodes(:), found(:)
    integer :: i, k, n, first, last
    allocate (found(MAX_DIRECTOR_NODES * size(structure%directors)))
    n = 0
    do i = 1, size(nodes)
      call find_node_directors(structure, nodes(i), first, last)
      do k = first, last
        associate (new => pack(structure%directors(k)%nodes, structure%directors(k)%nodes > 0))
          found(n + 1:n + size(new)) = new
          n = n + size(new)
        end associate
      end do
    end do
    all_nodes = [nodes, found(:n)]
  end function expanded_nodes

end module amontons_structural_data
