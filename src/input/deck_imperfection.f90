!> IMPERFECTION: offsets of nodes from the places that the deck gives them, before anything is made of these.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_imperfection
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_word
  use amontons_deck_labels, only: to_cartesian
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_real, check_n_fields, nodes_of_field, is_card
  use amontons_mesh, only: mesh_type
  use amontons_model, only: DIALECT_CALCULIX
  use amontons_text, only: to_text
  implicit none
  private
  public :: read_imperfections

  character(*), parameter :: NO_CARD = 'CalculiX has no *IMPERFECTION: add the offsets to the coordinates of the nodes, or ' // &
    'run the deck in the abaqus dialect.'

contains

  !> Moves the nodes by all IMPERFECTION cards, which add up. Needs the node sets; comes before sections, normals and surfaces.
  subroutine read_imperfections(reader, mesh)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(inout) :: mesh
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP), allocatable :: offset(:, :)        !< (3, n_nodes), of this card in its system
    integer :: c, n
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'IMPERFECTION')) cycle
      call open_card(reader, c, parameters, row)
      if (reader%dialect == DIALECT_CALCULIX) call report_error(reader, reader%cards%cards(c)%line, NO_CARD)
      if (has_parameter(parameters, 'FILE')) cycle   ! refused; its rows are modes
      allocate (offset(3, mesh%n_nodes), source=0.0_DP)
      n = 0
      do while (next_row(reader%cards, row))
        n = n + 1
        call read_offset(reader, mesh, row, offset)
      end do
      if (n == 0) call report_error(reader, reader%cards%cards(c)%line, '*IMPERFECTION has no data: node, offset along x, y, z.')
      call move_nodes(reader, c, parameter_word(parameters, 'SYSTEM', 'R'), offset, mesh)
      deallocate (offset)
    end do
  end subroutine read_imperfections


  !> Row: node or node set, three offsets; those of a node that is there twice add up.
  subroutine read_offset(reader, mesh, row, offset)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    type(data_row_type), intent(in) :: row
    real(DP), intent(inout) :: offset(:, :)      !< (3, n_nodes)
    integer, allocatable :: nodes(:)
    real(DP) :: given(3)
    integer :: i
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 4)
    call nodes_of_field(reader, mesh, row, 1, nodes, is_ok)
    do i = 1, 3
      call read_real(reader, row, i + 1, 'offset ' // to_text(i), given(i), is_ok, 0.0_DP)
    end do
    if (.not. is_ok) return
    do i = 1, size(nodes)
      offset(:, nodes(i)) = offset(:, nodes(i)) + given
    end do
  end subroutine read_offset


  !> Adds offsets to the coordinates; a node on the axis of a system has no direction away from it, which is an error.
  subroutine move_nodes(reader, c, system, offset, mesh)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: system           !< R, C or S
    real(DP), intent(in) :: offset(:, :)         !< (3, n_nodes) [length], angles in degrees
    type(mesh_type), intent(inout) :: mesh
    integer :: i
    do i = 1, mesh%n_nodes
      associate (X => mesh%coordinates(:, i))
        if (all(abs(offset(:, i)) <= 0)) cycle
        if (system == 'R') then
          X = X + offset(:, i)
        else if (norm2(X(:2)) > 0) then
          X = to_cartesian(system, from_cartesian(system, X) + offset(:, i))
        else
          call report_error(reader, reader%cards%cards(c)%line, 'The node ' // to_text(mesh%node_label(i)) // ' is on the z ' // &
            'axis, where neither radius nor angle have a direction: give its offset by *IMPERFECTION without SYSTEM.')
        end if
      end associate
    end do
  end subroutine move_nodes


  !> The inverse of to_cartesian: radius, angle about z, and z (C) or the angle above the xy plane (S).
  pure function from_cartesian(system, X) result(place)
    character(*), intent(in) :: system           !< C or S
    real(DP), intent(in) :: X(3)                 !< [length], not on the z axis
    real(DP) :: place(3)                         !< angles in degrees
    place = [norm2(X(:2)), atan2(X(2), X(1)) * 180 / PI, X(3)]
    if (system == 'S') place = [norm2(X), place(2), atan2(X(3), place(1)) * 180 / PI]
  end function from_cartesian

end module amontons_deck_imperfection
