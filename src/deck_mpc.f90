!> Deck MPC: the kinds of *MPC to bonds and equations, and what all such cards share: equations and rotation nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_mpc
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, row_type, next_row, field_text, field_integer
  use amontons_deck_reader, only: reader_type, open_card, complain, nodes_of_field
  use amontons_loads, only: equation_type
  use amontons_mesh, only: append_node
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_tensor, only: cross_product
  use amontons_text, only: squeezed, NUMBER_OK
  use amontons_ties, only: bond_type, BOND_PLANE, BOND_STRAIGHT, BOND_DISTANCE, BOND_TURN
  implicit none
  private
  public :: read_mpc, next_mpc, each_once, make_rotation, add_equation

contains

  !> MPC: kind and nodes, in one row or several. Ropes (DIST) are read elsewhere.
  subroutine read_mpc(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    character(:), allocatable :: kind
    integer :: line
    logical :: is_ok, has_row
    call open_card(reader, c, parameters, row)
    has_row = next_row(reader%cards, row)
    do while (has_row)
      call next_mpc(reader, model, row, '', has_row, kind, nodes, line, is_ok)
      if (is_ok .and. kind /= 'DIST') call add_mpc(reader, model, line, kind, nodes)
    end do
  end subroutine read_mpc


  !> The next constraint of a card: its first row, and those after it that begin with a number or a set.
  subroutine next_mpc(reader, model, row, wanted, has_row, kind, nodes, line, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(row_type), intent(inout) :: row         !< in: its first row; out: that of the one after it
    character(*), intent(in) :: wanted           !< only of this kind nodes are read; empty: of all but DIST
    logical, intent(inout) :: has_row            !< out: whether there is one after it
    character(:), allocatable, intent(out) :: kind   !< squeezed
    integer, allocatable, intent(out) :: nodes(:)
    integer, intent(out) :: line                 !< of its first row
    logical, intent(out) :: is_ok                !< .false.: a node is not there, which was told
    integer, allocatable :: found(:)
    integer :: i, label, status
    logical :: is_read
    allocate (nodes(0))
    is_ok = .true.
    kind = squeezed(field_text(reader%cards, row, 1))
    line = row%line
    is_read = kind == wanted .or. (wanted == '' .and. kind /= 'DIST')
    i = 2
    do
      do while (i <= row%n .and. is_read)
        if (squeezed(field_text(reader%cards, row, i)) /= '') then
          call nodes_of_field(reader, model%mesh, row, i, found, is_ok)
          nodes = [nodes, found]
        end if
        i = i + 1
      end do
      has_row = next_row(reader%cards, row)
      if (.not. has_row) exit
      call field_integer(reader%cards, row, 1, label, status)
      if (status /= NUMBER_OK .and. reader%node_sets%find(field_text(reader%cards, row, 1)) == 0) exit
      i = 1
    end do
  end subroutine next_mpc


  !> The bonds of one MPC.
  subroutine add_mpc(reader, model, line, kind, given)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line
    character(*), intent(in) :: kind             !< squeezed
    integer, intent(in) :: given(:)              !< nodes as they stand in the deck
    type(bond_type) :: bond
    integer, allocatable :: nodes(:)
    integer :: i
    nodes = each_once(given)
    if (kind == 'PLANE') call put_spanning_first(model, nodes)
    bond%card = 'MPC'
    bond%line = reader%cards%line_number(line)
    select case (kind)
    case ('PLANE', 'STRAIGHT')
      bond%kind = merge(BOND_PLANE, BOND_STRAIGHT, kind == 'PLANE')
      if (.not. spans(model, nodes, kind)) then
        call complain(reader, line, 'PLANE needs three nodes that are not on a line and more, STRAIGHT two nodes that ' // &
          'are apart and more.')
        return
      end if
      do i = merge(4, 3, kind == 'PLANE'), size(nodes)
        bond%node = [nodes(i), nodes(:merge(3, 2, kind == 'PLANE'))]
        model%bonds = [model%bonds, bond]
      end do
    case ('BEAM', 'LINK')
      call add_beam(reader, model, line, nodes, bond, is_link=kind == 'LINK')
    case ('TIE', 'PIN')
      call add_pin(reader, model, line, nodes)
    case ('MEANROT')
      call add_turn(reader, model, line, nodes, bond)
    case default
      call complain(reader, line, 'The MPC ' // kind // ' is not supported; known are PLANE, STRAIGHT, BEAM, LINK, TIE, PIN, ' // &
        'MEANROT and DIST.')
    end select
  end subroutine add_mpc


  !> Of the nodes of a plane the first three must not be on a line: the third becomes the one farthest from the line of the first
  !! and the one farthest from it, if they are.
  pure subroutine put_spanning_first(model, nodes)
    type(model_type), intent(in) :: model
    integer, intent(inout) :: nodes(:)
    real(DP) :: way(3), across(size(nodes))
    integer :: i, k
    if (size(nodes) < 4) return
    if (spans(model, nodes, 'PLANE')) return
    associate (x => model%mesh%coordinates)
      k = maxloc([(norm2(x(:, nodes(i)) - x(:, nodes(1))), i=1, size(nodes))], dim=1)
      nodes([2, k]) = nodes([k, 2])
      way = x(:, nodes(2)) - x(:, nodes(1))
      across = [(norm2(cross_product(way, x(:, nodes(i)) - x(:, nodes(1)))), i=1, size(nodes))]
      k = maxloc(across, dim=1)
      if (k > 3) nodes([3, k]) = nodes([k, 3])
    end associate
  end subroutine put_spanning_first


  !> Whether the first nodes span a plane or a line.
  pure logical function spans(model, nodes, kind)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    character(*), intent(in) :: kind
    spans = .false.
    if (size(nodes) < merge(4, 3, kind == 'PLANE')) return
    associate (x => model%mesh%coordinates(:, nodes(:3)))
      spans = norm2(x(:, 2) - x(:, 1)) > 0.0_DP
      if (kind == 'PLANE') spans = norm2(cross_product(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))) > &
        1.0e-6_DP * norm2(x(:, 2) - x(:, 1)) * norm2(x(:, 3) - x(:, 1))
    end associate
  end function spans


  !> Nodes in their order, each once.
  pure function each_once(given) result(nodes)
    integer, intent(in) :: given(:)
    integer, allocatable :: nodes(:)
    integer :: i
    nodes = pack(given, [(.not. any(given(:i - 1) == given(i)), i=1, size(given))])
  end function each_once


  !> LINK, and BEAM in CalculiX: two nodes keep their distance. BEAM in Abaqus: the first is fixed rigidly to the second.
  subroutine add_beam(reader, model, line, nodes, bond, is_link)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line, nodes(:)
    type(bond_type), intent(inout) :: bond
    logical, intent(in) :: is_link
    if (size(nodes) /= 2) then
      call complain(reader, line, 'BEAM and LINK need two nodes.')
    else if (is_link .or. reader%dialect == DIALECT_CALCULIX) then
      bond%kind = BOND_DISTANCE
      bond%node = nodes
      model%bonds = [model%bonds, bond]
    else
      bond%node = nodes(:1)
      bond%reference = nodes(2)
      call make_rotation(model, bond%reference, bond%rotation)
      model%bonds = [model%bonds, bond]
    end if
  end subroutine add_beam


  !> TIE, PIN: the first node moves as the second.
  subroutine add_pin(reader, model, line, nodes)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line, nodes(:)
    integer :: k
    if (size(nodes) /= 2) then
      call complain(reader, line, 'TIE and PIN need two nodes.')
      return
    end if
    do k = 1, 3
      call add_equation(model, nodes, [k, k], [1.0_DP, -1.0_DP], 'MPC', reader%cards%line_number(line))
    end do
  end subroutine add_pin


  !> MEANROT: nodes, and last a pilot: its coordinates are the axis, its first displacement the mean rotation.
  subroutine add_turn(reader, model, line, nodes, bond)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line, nodes(:)
    type(bond_type), intent(inout) :: bond
    integer :: n
    n = size(nodes)
    if (n < 3) then
      call complain(reader, line, 'MEANROT needs at least two nodes and the pilot.')
      return
    end if
    bond%kind = BOND_TURN
    bond%node = nodes(:n - 1)
    bond%reference = nodes(n)
    bond%axis = model%mesh%coordinates(:, nodes(n))
    if (.not. norm2(bond%axis) > 0.0_DP) then
      call complain(reader, line, 'The coordinates of the last node of MEANROT are the axis; they must not all be zero.')
      return
    end if
    bond%axis = bond%axis / norm2(bond%axis)
    model%mesh%is_abstract(bond%reference) = .true.
    model%bonds = [model%bonds, bond]
  end subroutine add_turn


  !> The rotation node of a reference node; one is made if there is none yet.
  subroutine make_rotation(model, reference, rotation)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: reference
    integer, intent(out) :: rotation
    rotation = model%rotation_of(reference)
    if (rotation > 0) return
    call append_node(model%mesh, model%mesh%coordinates(:, reference), rotation)
    model%mesh%is_abstract(rotation) = .true.
    model%rotation_of = [model%rotation_of, 0]
    model%rotation_of(reference) = rotation
  end subroutine make_rotation


  !> Appends an equation.
  subroutine add_equation(model, node, dof, coefficient, card, line)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: node(:), dof(:)
    real(DP), intent(in) :: coefficient(:)
    character(*), intent(in) :: card
    integer, intent(in) :: line                  !< of the deck
    type(equation_type) :: equation
    logical :: is_kept(size(node))
    is_kept = abs(coefficient) > 0.0_DP
    equation%node = pack(node, is_kept)
    equation%dof = pack(dof, is_kept)
    equation%coefficient = pack(coefficient, is_kept)
    equation%card = card
    equation%line = line
    model%equations = [model%equations, equation]
  end subroutine add_equation

end module amontons_deck_mpc
