!> Deck sectors: the cards CYCLIC SYMMETRY MODEL to the turn of the ties that they name.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_sectors
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: parameter_type, row_type, next_row
  use amontons_card_form, only: parameter_text
  use amontons_deck_reader, only: reader_type, open_card, complain, need_real, need_no_data, need_at_most, is_card
  use amontons_model, only: model_type
  use amontons_tensor, only: cross_product
  use amontons_text, only: squeezed, parse_integer, NUMBER_OK
  implicit none
  private
  public :: read_sectors

contains

  !> Gives the ties with CYCLIC SYMMETRY their turn. Before: ties are read.
  subroutine read_sectors(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    logical :: has_turn(size(model%ties))
    integer :: c, i
    has_turn = .false.
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'CYCLICSYMMETRYMODEL')) call read_sector(reader, c, model, has_turn)
    end do
    do i = 1, size(model%ties)
      if (model%ties(i)%is_cyclic .and. .not. has_turn(i)) call complain(reader, 0, 'The tie ''' // model%ties(i)%name // &
        ''' has CYCLIC SYMMETRY, but no *CYCLIC SYMMETRY MODEL, TIE=' // model%ties(i)%name // ' tells its axis and N.')
    end do
  end subroutine read_sectors


  !> One card: N sectors in the circle; two points of the axis.
  subroutine read_sector(reader, c, model, has_turn)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(model_type), intent(inout) :: model
    logical, intent(inout) :: has_turn(:)
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: name
    real(DP) :: x(6)
    integer :: i, n, status
    logical :: is_ok, is_found
    call open_card(reader, c, parameters, row)
    associate (line => reader%cards%cards(c)%line)
      call parse_integer(parameter_text(parameters, 'N'), n, status)
      if (status /= NUMBER_OK) return            ! told when the card was checked
      if (n < 2) call complain(reader, line, 'N, the number of sectors in the circle, must be at least 2.')
      if (.not. next_row(reader%cards, row)) then
        call complain(reader, line, '*CYCLIC SYMMETRY MODEL needs a data line: two points of the axis.')
        return
      end if
      is_ok = n >= 2
      call need_at_most(reader, row, 6)
      do i = 1, 6
        call need_real(reader, row, i, 'coordinate of a point of the axis', x(i), is_ok, 0.0_DP)
      end do
      if (is_ok .and. .not. norm2(x(4:) - x(:3)) > 0) then
        call complain(reader, row%line, 'The two points of the axis must differ.')
        is_ok = .false.
      end if
      if (next_row(reader%cards, row)) call need_no_data(reader, row)
      name = parameter_text(parameters, 'TIE')
      is_found = .false.
      do i = 1, size(model%ties)
        if (squeezed(model%ties(i)%name) /= squeezed(name) .or. .not. model%ties(i)%is_cyclic) cycle
        is_found = .true.
        has_turn(i) = .true.
        if (.not. is_ok) cycle
        model%ties(i)%centre = x(:3)
        model%ties(i)%turn = turn_about((x(4:) - x(:3)) / norm2(x(4:) - x(:3)), 2 * PI / real(n, DP))
      end do
      if (.not. is_found) call complain(reader, line, 'There is no *TIE, NAME=' // name // ', CYCLIC SYMMETRY.')
    end associate
  end subroutine read_sector


  !> The matrix that turns by an angle about an axis through the origin (Rodrigues).
  pure function turn_about(axis, angle) result(turn)
    real(DP), intent(in) :: axis(3)              !< unit vector
    real(DP), intent(in) :: angle                !< [rad]
    real(DP) :: turn(3, 3), e(3)
    integer :: k
    do k = 1, 3
      e = 0
      e(k) = 1
      turn(:, k) = e + sin(angle) * cross_product(axis, e) + (1 - cos(angle)) * &
        cross_product(axis, cross_product(axis, e))
    end do
  end function turn_about

end module amontons_deck_sectors
