!> The place of an instance: its translation and rotation, and rows with points and directions of its part in terms of the model.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_placement
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: cards_type, data_row_type, deck_messages_type, start_rows, next_row, field_text, field_integer, &
    field_real
  use amontons_tensor, only: cross_product, IDENTITY
  use amontons_text, only: name_key, to_text, is_one_of, NUMBER_OK
  implicit none
  private
  public :: placement_type, read_placement, placed_point, is_rotated, format_point
  public :: placed_axes, point_row, profile_row, direction_row_number, direction_row

  !> A translation, then a rotation.
  type :: placement_type
    real(DP) :: shift(3) = 0                     !< translation [length]
    real(DP) :: turn(3, 3) = 0                   !< rotation, after the translation
    real(DP) :: centre(3) = 0                    !< a point of its axis [length]
    logical :: has_placement = .false.
  end type placement_type

contains

  !> The data lines of an instance: translation; two points of an axis and an angle in degrees.
  subroutine read_placement(cards, c, instance, messages)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    class(placement_type), intent(inout) :: instance
    type(deck_messages_type), intent(inout) :: messages
    type(data_row_type) :: row
    real(DP) :: x(7), axis(3), s, k
    integer :: i, n, n_wanted, status
    n = 0
    call start_rows(cards%cards(c), row)
    do while (next_row(cards, row))
      n = n + 1
      n_wanted = merge(3, 7, n == 1)
      x = 0
      if (n > 2 .or. row%n > n_wanted) then
        call messages%add(row%line, 'An instance has at most two data lines: a translation of three numbers, and two ' // &
          'points and an angle, seven numbers.')
        return
      end if
      do i = 1, row%n
        call field_real(cards, row, i, x(i), status)
        if (status /= NUMBER_OK) call messages%add(row%line, 'Field ' // to_text(i) // ' must be a real number.')
      end do
      instance%has_placement = .true.
      if (n == 1) then
        instance%shift = x(:3)
        instance%turn = IDENTITY
        cycle
      end if
      instance%centre = x(:3)
      axis = x(4:6) - x(:3)
      if (.not. norm2(axis) > 0) then
        call messages%add(row%line, 'The two points of the axis must differ.')
        return
      end if
      axis = axis / norm2(axis)
      s = sin(x(7) * PI / 180)
      k = 1 - cos(x(7) * PI / 180)
      do i = 1, 3                                ! Rodrigues: 1 + s [a] + (1 - cos) [a] [a]
        instance%turn(:, i) = IDENTITY(:, i) + s * cross_product(axis, IDENTITY(:, i)) + &
          k * cross_product(axis, cross_product(axis, IDENTITY(:, i)))
      end do
    end do
  end subroutine read_placement


  !> Transforms a point of a part to its position in the instance.
  pure function placed_point(scope, x) result(place)
    class(placement_type), intent(in) :: scope
    real(DP), intent(in) :: x(3)
    real(DP) :: place(3)
    place = x
    if (scope%has_placement) place = scope%centre + matmul(scope%turn, x + scope%shift - scope%centre)
  end function placed_point


  !> Three numbers, each after a comma, without loss.
  function format_point(x) result(text)
    real(DP), intent(in) :: x(3)
    character(:), allocatable :: text
    character(81) :: line
    write (line, '(3(", ",es25.17e3))') x
    text = trim(line)
  end function format_point


  !> Whether an instance is rotated, not only translated.
  pure logical function is_rotated(scope)
    class(placement_type), intent(in) :: scope
    is_rotated = scope%has_placement .and. any(abs(scope%turn - IDENTITY) > 1.0e-12_DP)
  end function is_rotated


  !> Two points of axes in the instance, each with a comma before: of axes through the origin they are only rotated.
  function placed_axes(scope, system, x) result(text)
    class(placement_type), intent(in) :: scope
    character(*), intent(in) :: system           !< begins with C if cylindrical
    real(DP), intent(in) :: x(6)
    character(:), allocatable :: text
    type(placement_type) :: mover
    mover = placement_type(scope%shift, scope%turn, scope%centre, scope%has_placement)
    if (index(system, 'C') /= 1) then
      mover%shift = 0
      mover%centre = 0
    end if
    text = format_point(placed_point(mover, x(:3))) // format_point(placed_point(mover, x(4:)))
  end function placed_axes


  !> A row of ORIENTATION or TRANSFORM: the first has two points. Those of axes through the origin are only rotated.
  function point_row(cards, row, scope, is_first, system) result(text)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    class(placement_type), intent(in) :: scope
    logical, intent(in) :: is_first
    character(*), intent(in) :: system           !< begins with C if cylindrical
    character(:), allocatable :: text
    real(DP) :: x(6)
    integer :: i, status
    text = field_text(cards, row, 1)
    do i = 2, row%n
      text = text // ', ' // field_text(cards, row, i)
    end do
    if (.not. (is_first .and. scope%has_placement)) return
    x = 0
    do i = 1, min(6, row%n)
      call field_real(cards, row, i, x(i), status)
      if (status /= NUMBER_OK) return
    end do
    text = placed_axes(scope, system, x)
    text = text(3:)
  end function point_row


  !> A row of an analytic surface: points of axes, and those of a profile in the plane, transformed to the instance.
  function profile_row(cards, row, scope, is_flat) result(text)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    class(placement_type), intent(in) :: scope
    logical, intent(in) :: is_flat               !< SEGMENTS
    character(:), allocatable :: text
    real(DP) :: x(3)
    integer :: i, k, n, status
    logical :: is_word
    is_word = is_one_of(name_key(field_text(cards, row, 1)), 'START|LINE|CIRCL|PARAB')
    n = merge(2, 3, is_flat)
    text = ''
    if (is_word) text = ', ' // field_text(cards, row, 1)
    do i = merge(2, 1, is_word), row%n, n
      x = 0
      do k = i, min(i + n - 1, row%n)
        call field_real(cards, row, k, x(k - i + 1), status)
      end do
      if (status /= NUMBER_OK .or. (is_word .and. .not. is_flat) .or. .not. scope%has_placement) then   ! as it is
        do k = i, min(i + n - 1, row%n)
          text = text // ', ' // field_text(cards, row, k)
        end do
        cycle
      end if
      x = placed_point(scope, x)
      text = text // format_point(x)
      if (is_flat) text = text(:index(text, ',', back=.true.) - 1)
    end do
    text = text(3:)
  end function profile_row


  !> The data line of BEAM SECTION and BEAM GENERAL SECTION with the first direction: the second, but behind the walls of ARBITRARY.
  integer function direction_row_number(cards, c, shape) result(n)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c                     !< card
    character(*), intent(in) :: shape            !< squeezed value of SECTION
    type(data_row_type) :: row
    integer :: n_walls, status
    n = 2
    if (shape /= 'ARBITRARY') return
    call start_rows(cards%cards(c), row)
    if (.not. next_row(cards, row)) return
    call field_integer(cards, row, 1, n_walls, status)
    if (status == NUMBER_OK .and. n_walls > 0) n = n_walls + 1
  end function direction_row_number


  !> The first direction of beams in the instance, [n] in the part: the given one, or without fields 0, 0, -1, is rotated with it.
  function direction_row(cards, row, scope) result(text)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in), optional :: row   !< the line; absent: the card ends before it
    class(placement_type), intent(in) :: scope
    character(:), allocatable :: text
    real(DP) :: x(3), value
    integer :: i, status
    x = [0.0_DP, 0.0_DP, -1.0_DP]
    if (present(row)) then
      if (row%n > 0) x = 0
      text = field_text(cards, row, 1)
      do i = 1, row%n
        if (i > 1) text = text // ', ' // field_text(cards, row, i)
        call field_real(cards, row, i, value, status)
        if (i > 3 .or. (status /= NUMBER_OK .and. field_text(cards, row, i) /= '')) return   ! the reader of the card reports it
        if (status == NUMBER_OK) x(i) = value
      end do
    end if
    text = format_point(matmul(scope%turn, x))
    text = text(3:)
  end function direction_row

end module amontons_deck_placement
