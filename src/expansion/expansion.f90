!> Expansion of shells, membranes and beams into solids: directors, elements, then knots and ties.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The nodes of the deck remain, with their numbers: supports, loads, sets and results refer to them.
module amontons_expansion
  use amontons_directors, only: find_directors
  use amontons_expanded_elements, only: expand_elements
  use amontons_knots, only: connect_nodes
  use amontons_model, only: model_type, DIALECT_CALCULIX
  implicit none
  private
  public :: expand_structure

contains

  !> Expands all structural elements of a model; nothing has constraints yet.
  subroutine expand_structure(model, bad_element, turns_far)
    type(model_type), intent(inout) :: model     !< in: with structure and a mesh of the kinds of the deck
    logical, intent(in) :: turns_far             !< NLGEOM in a step: rotations may be finite
    integer, intent(out) :: bad_element          !< an element without a normal at one of its nodes, and nothing is done; 0: none
    call find_directors(model%mesh, model%structure, model%dialect == DIALECT_CALCULIX, bad_element)
    if (bad_element > 0) return
    model%structure%n_deck_nodes = model%mesh%n_nodes
    allocate (model%mesh%is_expanded(model%mesh%n_nodes), source=.false.)
    model%mesh%is_expanded(model%structure%directors%node) = .true.
    call expand_elements(model%mesh, model%structure, model%dialect == DIALECT_CALCULIX)
    call connect_nodes(model, turns_far)
  end subroutine expand_structure

end module amontons_expansion
