!> Tests of the partition of points: even parts that cover all points once, boxes that do not overlap, equal coordinates.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_point_partition
  use amontons_kinds, only: DP
  use amontons_point_partition, only: partition_points
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: k
  call random_seed(put=[(17 * k, k=1, 64)])
  call test_cuts()
  call test_halves()
  call suite%finish()

contains

  !> Every point has a part, none is too large, and halves of a grid are halves.
  subroutine test_cuts()
    real(DP) :: place(3, 640)
    integer :: part(640), n_parts, i, members
    place = reshape([(real(mod(i, 32), DP), real(i / 32, DP), 0.0_DP, i=0, 639)], [3, 640])
    call partition_points(place, 64, part, n_parts)
    call suite%that('every point lies in a part', &
      minval(part) == 1 .and. maxval(part) == n_parts)
    do i = 1, n_parts
      members = count(part == i)
      call suite%that('a part is neither empty nor too large', &
      members > 0 .and. members <= 64)
    end do
    call suite%that('halves of halves: 640 points in 16 parts of 40', &
      n_parts == 16)
    call partition_points(place(:, :0), 64, part(:0), n_parts)
    call suite%that('no point, no part', &
      n_parts == 0)
  end subroutine test_cuts


  !> Two halves of random points are those below and above the median of the longest side; of equal points those with the smaller
  !! and with the larger indices.
  subroutine test_halves()
    integer, parameter :: N = 1001
    real(DP) :: place(3, N)
    integer :: part(N), n_parts, i
    call random_number(place)
    place(2, :) = 3.0_DP * place(2, :)
    call partition_points(place, 501, part, n_parts)
    call suite%that('two parts', n_parts == 2 .and. count(part == 1) == 501)
    call suite%that('below and above', maxval(place(2, :), mask=part == 1) < minval(place(2, :), mask=part == 2))
    place = 1.0_DP
    call partition_points(place, 501, part, n_parts)
    call suite%that('equal points by their index', all(part == [(merge(1, 2, i <= 501), i=1, N)]))
  end subroutine test_halves

end program test_point_partition
