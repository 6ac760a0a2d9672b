!> Rigid body modes: simplified basis of the free motions of a body, and their description in words.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A motion is (t, r): u = t + r x (x - centre)/size, with the centre and the size of the body.
module amontons_rigid_modes
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_tensor, only: cross_product
  use amontons_model_check_bodies, only: body_type, join_item
  implicit none
  private
  public :: simplify_motions, motions_text, is_translation, MIN_MOTION_PART

  real(DP), parameter :: MIN_MOTION_PART = 1.0e-3_DP         !< least part of a motion that is described [-]

contains

  !> Replaces the motions by simple combinations: reduced echelon form, body by body, translations first.
  pure subroutine simplify_motions(motions)
    real(DP), intent(inout) :: motions(:, :)       !< (6 members, n) columns
    real(DP), parameter :: MIN_PIVOT_PART(2) = [0.1_DP, 0.0_DP]   ! part of a column that its pivot must have, in two passes
    integer :: pass, row, n
    n = 0
    do pass = 1, 2
      do row = 1, size(motions, 1)
        if (n == size(motions, 2)) return
        call take_pivot(row, MIN_PIVOT_PART(pass), n, motions)
      end do
    end do
  end subroutine simplify_motions


  !> Makes a row the pivot of the next motion if its largest entry suffices: 1 in this motion, 0 in the others.
  pure subroutine take_pivot(row, least, n, motions)
    integer, intent(in) :: row
    real(DP), intent(in) :: least                  !< part of the largest entry of the motion
    integer, intent(inout) :: n                    !< motions that have a pivot
    real(DP), intent(inout) :: motions(:, :)
    real(DP) :: column(size(motions, 1)), part, best
    integer :: j, k
    best = max(least, MIN_MOTION_PART)
    k = 0
    do j = n + 1, size(motions, 2)
      part = abs(motions(row, j)) / max(maxval(abs(motions(:, j))), tiny(1.0_DP))
      if (part <= best) cycle
      best = part
      k = j
    end do
    if (k == 0) return
    n = n + 1
    column = motions(:, k) / motions(row, k)
    motions(:, k) = motions(:, n)
    motions(:, n) = column
    do j = 1, size(motions, 2)
      if (j /= n) motions(:, j) = motions(:, j) - motions(row, j) * column
    end do
  end subroutine take_pivot


  !> 'move along x and turn about z through its centre': translations first.
  function motions_text(body, motions, is_listed) result(text)
    type(body_type), intent(in) :: body
    real(DP), intent(in) :: motions(:, :)          !< (6, n) t, r
    logical, intent(in) :: is_listed(:)            !< (n)
    character(:), allocatable :: text
    logical :: is_turn(size(is_listed))
    integer, allocatable :: list(:)
    integer :: i
    text = ''
    if (count(is_listed) == 6) then
      text = 'move and turn freely'
      return
    end if
    is_turn = [(is_listed(i) .and. .not. is_translation(motions(:, i)), i=1, size(is_listed))]
    list = [(i, i=1, size(is_listed))]
    list = [pack(list, is_listed .and. .not. is_turn), pack(list, is_turn)]
    do i = 1, size(list)
      text = join_item(text, motion_text(body, motions(:, list(i))), i == size(list))
    end do
  end function motions_text


  !> Whether a motion has (nearly) no rotation.
  pure logical function is_translation(motion)
    real(DP), intent(in) :: motion(6)              !< t, r
    is_translation = norm2(motion(4:)) <= MIN_MOTION_PART * norm2(motion(:3))
  end function is_translation


  !> One motion in words: a translation, a rotation about an axis, or a screw motion. The axis of u = t + w x (x - c) passes
  !! through c + (w x t)/w^2.
  function motion_text(body, motion) result(text)
    type(body_type), intent(in) :: body
    real(DP), intent(in) :: motion(6)              !< t, r
    character(:), allocatable :: text
    real(DP) :: t(3), axis(3), turn, offset(3)
    t = motion(:3)
    turn = norm2(motion(4:)) / body%size
    if (is_translation(motion)) then
      text = 'move along ' // direction_text(t / norm2(t))
      return
    end if
    axis = motion(4:) / norm2(motion(4:))
    offset = cross_product(axis, t) / turn
    text = 'turn about ' // direction_text(axis)
    if (norm2(offset) <= MIN_MOTION_PART * body%size) then
      text = text // ' through its centre'
    else
      text = text // ' through the point ' // vector_text(body%centre + offset, 1.0e-3_DP * body%size)
    end if
    if (abs(dot_product(axis, t)) > MIN_MOTION_PART * turn * body%size) text = text // ' while it moves along it'
  end function motion_text


  !> 'x', 'y', 'z', or '(0.6, 0.8, 0)'.
  function direction_text(direction) result(text)
    real(DP), intent(in) :: direction(3)           !< unit vector
    character(:), allocatable :: text
    integer :: k
    k = maxloc(abs(direction), dim=1)
    if (abs(direction(k)) > 1 - 0.5_DP * MIN_MOTION_PART**2) then
      text = 'xyz'
      text = text(k:k)
    else
      text = vector_text(sign(1.0_DP, direction(k)) * direction, 1.0e-3_DP)
    end if
  end function direction_text


  !> '(1, 2.5, 0)', each number rounded to a power of ten not larger than the unit.
  function vector_text(vector, unit) result(text)
    real(DP), intent(in) :: vector(3)
    real(DP), intent(in) :: unit                   !< resolution
    character(:), allocatable :: text
    real(DP) :: step
    integer :: k
    step = 10.0_DP**floor(log10(unit) + 1.0e-9_DP)
    text = '('
    do k = 1, 3
      text = text // to_text(step * anint(vector(k) / step))
      if (k < 3) text = text // ', '
    end do
    text = text // ')'
  end function vector_text

end module amontons_rigid_modes
