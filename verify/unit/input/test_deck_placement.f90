!> Unit test of deck_placement: the place of an instance, axes and points of its part, the first direction of its beams.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_placement
  use amontons_kinds, only: DP
  use amontons_cards, only: cards_type, data_row_type, deck_messages_type, open_cards_text, start_rows, next_row
  use amontons_deck_placement, only: placement_type, read_placement, placed_point, is_rotated, format_point, placed_axes, &
    point_row, profile_row, direction_row_number, direction_row
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  real(DP), parameter :: TOL = 1.0e-14_DP              ! rounding of coordinates of size 10
  character(*), parameter :: TURNED = '*INSTANCE;10,0,0;10,0,0,10,0,5,90;'   ! x to y about (10, 0)
  type(suite_type) :: suite
  call check_places()
  call check_rows()
  call check_directions()
  call suite%finish()

contains

  !> The placement of an INSTANCE card, the first of a deck.
  subroutine read(text, cards, place, messages)
    character(*), intent(in) :: text
    type(cards_type), intent(out) :: cards
    type(placement_type), intent(out) :: place
    type(deck_messages_type), intent(out) :: messages
    call open_cards_text(deck_lines(text), 'deck', cards, messages)
    call read_placement(cards, 1, place, messages)
  end subroutine read


  !> The first numbers of a text.
  function numbers(text, n) result(x)
    character(*), intent(in) :: text
    integer, intent(in) :: n
    real(DP) :: x(n)
    read (text(verify(text, ', '):), *) x
  end function numbers


  !> Translation first, then the rotation; errors.
  subroutine check_places()
    type(cards_type) :: cards
    type(placement_type) :: place
    type(deck_messages_type) :: messages
    real(DP) :: x(3)
    call read(TURNED, cards, place, messages)
    x = placed_point(place, [2.0_DP, 0.0_DP, 1.0_DP])
    call suite%near('x to y about (10, 0)', maxval(abs(x - [10.0_DP, 2.0_DP, 1.0_DP])), 0.0_DP, TOL)
    call suite%that('rotated', is_rotated(place) .and. messages%n == 0)
    x = numbers(format_point([1.0_DP / 3, -2.0e-300_DP, 0.0_DP]), 3)
    call suite%that('numbers without loss', all(abs(x - [1.0_DP / 3, -2.0e-300_DP, 0.0_DP]) <= 0))
    call read('*INSTANCE;1,2,3;', cards, place, messages)
    x = placed_point(place, [1.0_DP, 1.0_DP, 1.0_DP])
    call suite%near('translated', maxval(abs(x - [2.0_DP, 3.0_DP, 4.0_DP])), 0.0_DP, 0.0_DP)
    call suite%that('not rotated', .not. is_rotated(place))
    call read('*INSTANCE;1,2,3;0,0,0,0,0,0,90;', cards, place, messages)
    call suite%that('an axis without length', messages%n_errors == 1)
    call read('*INSTANCE;1,2,3,4;', cards, place, messages)
    call suite%that('four numbers of a translation', messages%n_errors == 1)
  end subroutine check_places


  !> Axes through the origin are rotated, those of a cylinder moved as well; points of a profile.
  subroutine check_rows()
    type(cards_type) :: cards
    type(placement_type) :: place
    type(deck_messages_type) :: messages
    type(data_row_type) :: row
    real(DP), parameter :: X(6) = [1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 2.0_DP]
    real(DP) :: y(6)
    call read(TURNED // '*ORIENTATION;1,0,0,0,0,2;', cards, place, messages)
    y = numbers(placed_axes(place, '', X), 6)
    call suite%near('axes', maxval(abs(y - real([0, 1, 0, 0, 0, 2], DP))), 0.0_DP, TOL)
    y = numbers(placed_axes(place, 'CYLINDRICAL', X), 6)
    call suite%near('axes of a cylinder', maxval(abs(y - real([10, 1, 0, 10, 0, 2], DP))), 0.0_DP, TOL)
    call start_rows(cards%cards(2), row)
    call suite%that('a row', next_row(cards, row))
    y = numbers(point_row(cards, row, place, .true., ''), 6)
    call suite%near('the row of axes', maxval(abs(y - real([0, 1, 0, 0, 0, 2], DP))), 0.0_DP, TOL)
    y = numbers(profile_row(cards, row, place, .false.), 6)
    call suite%near('points of a profile', maxval(abs(y - real([10, 1, 0, 10, 0, 2], DP))), 0.0_DP, TOL)
  end subroutine check_rows


  !> The given direction and the default are rotated; walls of ARBITRARY are before it; what is no number stays.
  subroutine check_directions()
    type(cards_type) :: cards
    type(placement_type) :: place
    type(deck_messages_type) :: messages
    type(data_row_type) :: row
    real(DP) :: x(3)
    call read('*INSTANCE;0,0,0;0,0,0,0,1,0,90;*BEAM SECTION;1,2;1,0;*BEAM SECTION;4,0,0,1,0,.1;,;1,x;', cards, place, messages)
    call suite%that('its row', direction_row_number(cards, 2, 'RECT') == 2 .and. direction_row_number(cards, 3, 'ARBITRARY') == 5)
    call start_rows(cards%cards(2), row)
    call suite%that('two rows', next_row(cards, row) .and. next_row(cards, row))
    x = numbers(direction_row(cards, row, place), 3)
    call suite%near('x to -z about y', maxval(abs(x - [0.0_DP, 0.0_DP, -1.0_DP])), 0.0_DP, TOL)
    x = numbers(direction_row(cards, scope=place), 3)
    call suite%near('the default, -z to -x', maxval(abs(x - [-1.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
    call start_rows(cards%cards(3), row)
    call suite%that('a row without numbers', next_row(cards, row) .and. next_row(cards, row))
    row%n = 0
    x = numbers(direction_row(cards, row, place), 3)
    call suite%near('the default of a row without fields', maxval(abs(x - [-1.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
    call suite%that('the last row', next_row(cards, row))
    call suite%that('no number', direction_row(cards, row, place) == '1, x')
  end subroutine check_directions

end program test_deck_placement
