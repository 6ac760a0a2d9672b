!> Deck spreads: the card DISTRIBUTING COUPLING of CalculiX: the displacement of a node is the mean of others.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_spreads
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, row_type, next_row
  use amontons_card_form, only: parameter_text
  use amontons_deck_mpc, only: add_equation
  use amontons_deck_reader, only: reader_type, open_card, complain, need_real, need_at_most, nodes_of_field, is_card
  use amontons_model, only: model_type, DIALECT_CALCULIX
  implicit none
  private
  public :: read_spreads

contains

  !> All DISTRIBUTING COUPLING cards.
  subroutine read_spreads(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer :: c
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'DISTRIBUTINGCOUPLING')) cycle
      if (reader%dialect == DIALECT_CALCULIX) then
        call read_spread(reader, model, c)
      else
        call complain(reader, reader%cards%cards(c)%line, 'The card *DISTRIBUTING COUPLING is that of CalculiX, which ' // &
          'binds no rotation; under the abaqus dialect use *COUPLING with *DISTRIBUTING below it, on a surface.')
      end if
    end do
  end subroutine read_spreads


  !> One card: sum w_i u_i = (sum w_i) u of the node of the DCOUP3D element, in three directions. The first node of the list
  !! is the one eliminated, as in CalculiX.
  subroutine read_spread(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:), list(:)
    real(DP), allocatable :: weights(:)
    real(DP) :: weight
    integer :: reference, k
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    call find_reference(reader, c, parameter_text(parameters, 'ELSET'), reference)
    if (reference == 0) return
    allocate (list(0), weights(0))
    do while (next_row(reader%cards, row))
      is_ok = .true.
      call need_at_most(reader, row, 2)
      call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
      call need_real(reader, row, 2, 'weight', weight, is_ok, 0.0_DP)
      if (.not. is_ok) return
      if (weight <= 0) then
        call complain(reader, row%line, 'The weight of a node must be positive.')
        return
      end if
      list = [list, nodes]
      weights = [weights, spread(weight, 1, size(nodes))]
    end do
    if (size(list) == 0) then
      call complain(reader, reader%cards%cards(c)%line, 'The data are missing: nodes and their weights.')
      return
    end if
    do k = 1, 3
      call add_equation(model, [list, reference], spread(k, 1, size(list) + 1), [weights, -sum(weights)], &
        'DISTRIBUTING COUPLING', reader%cards%line_number(reader%cards%cards(c)%line))
    end do
  end subroutine read_spread


  !> The node of the one DCOUP3D element of a set; 0 on trouble, which is told.
  subroutine find_reference(reader, c, name, reference)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: name
    integer, intent(out) :: reference
    integer :: set, e
    reference = 0
    set = reader%element_sets%find(name)
    if (set > 0) then
      if (reader%left_of_set(set)%n == 1) then
        e = reader%left_of_set(set)%items(1)
        if (reader%left_first(e + 1) - reader%left_first(e) == 1) reference = reader%left_nodes(reader%left_first(e))
      end if
    end if
    if (reference == 0) call complain(reader, reader%cards%cards(c)%line, 'The set ''' // name // ''' must hold one element ' // &
      'of type DCOUP3D, whose node is the reference node.')
  end subroutine find_reference

end module amontons_deck_spreads
