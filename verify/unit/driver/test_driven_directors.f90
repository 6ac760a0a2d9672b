!> Unit test of amontons_driven_directors: rotations beyond half a turn, and those of linear fields at fibres and cross-sections.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_driven_directors
  use amontons_kinds, only: DP, PI
  use amontons_driven_directors, only: driven_director_type, add_director_motion, continue_rotations
  use amontons_tensor, only: IDENTITY, cross_product
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer :: n_outer
  do n_outer = 2, 4, 2
    call check_small(n_outer)
    call check_finite(n_outer)
  end do
  call check_lever()
  call check_continuation()
  call suite%finish()

contains

  !> A director along turned axes in a tetrahedron whose corners are the origin and the unit vectors.
  function director(n_outer) result(d)
    integer, intent(in) :: n_outer
    type(driven_director_type) :: d
    d%n_outer = n_outer
    d%axes = rotation([0.3_DP, -0.2_DP, 0.7_DP])
    d%gradient(:, 1) = -1
    d%gradient(:, 2:4) = IDENTITY
  end function director


  !> The rotation of a vector w: sin and cos of its length about its direction.
  function rotation(w) result(R)
    real(DP), intent(in) :: w(3)
    real(DP) :: R(3, 3), n(3), angle
    integer :: k
    angle = norm2(w)
    n = w / angle
    do k = 1, 3
      R(:, k) = cos(angle) * IDENTITY(:, k) + sin(angle) * cross_product(n, IDENTITY(:, k)) + (1 - cos(angle)) * n(k) * n
    end do
  end function rotation


  !> Displacements A x of the corners of the tetrahedron.
  function corners(A) result(u)
    real(DP), intent(in) :: A(3, 3)
    real(DP) :: u(3, 4)
    u(:, 1) = 0
    u(:, 2:) = A
  end function corners


  !> A small rotation is itself; a stretch turns nothing; a shear of the fibre turns a shell by all of it.
  subroutine check_small(n_outer)
    integer, intent(in) :: n_outer
    type(driven_director_type) :: d
    real(DP) :: motion(6), spin(3, 3)
    real(DP), parameter :: W(3) = [0.02_DP, -0.01_DP, 0.03_DP]
    d = director(n_outer)
    spin = reshape([0.0_DP, W(3), -W(2), -W(3), 0.0_DP, W(1), W(2), -W(1), 0.0_DP], [3, 3])
    motion = 1
    call add_director_motion(d, corners(spin), .false., motion)
    call suite%near('small rotation', norm2(motion(4:) - W), 0.0_DP, 1.0e-15_DP)
    call suite%near('displacement', norm2(motion(:3) - 1), 0.0_DP, 0.0_DP)
    call add_director_motion(d, corners(0.1_DP * matmul(d%axes, matmul(diagonal([1.0_DP, 2.0_DP, 3.0_DP]), transpose(d%axes)))), &
      .false., motion)
    call suite%near('stretch', norm2(motion(4:)), 0.0_DP, 1.0e-15_DP)
    if (n_outer == 4) return
    call add_director_motion(d, corners(0.1_DP * spread(d%axes(:, 1), 2, 3) * spread(d%axes(:, 3), 1, 3)), .false., motion)
    call suite%near('shear of a fibre', norm2(motion(4:) - 0.1_DP * d%axes(:, 2)), 0.0_DP, 1.0e-15_DP)
  end subroutine check_small


  !> A finite rotation with a stretch along the axes.
  subroutine check_finite(n_outer)
    integer, intent(in) :: n_outer
    type(driven_director_type) :: d
    real(DP) :: motion(6), F(3, 3)
    real(DP), parameter :: W(3) = [1.2_DP, -0.5_DP, 0.9_DP]
    d = director(n_outer)
    F = matmul(rotation(W), matmul(d%axes, matmul(diagonal([1.1_DP, 0.8_DP, 1.3_DP]), transpose(d%axes))))
    motion = 0
    call add_director_motion(d, corners(F - IDENTITY), .true., motion)
    call suite%near('finite rotation', norm2(motion(4:) - W), 0.0_DP, 1.0e-13_DP)
  end subroutine check_finite


  !> A diagonal matrix.
  function diagonal(values) result(M)
    real(DP), intent(in) :: values(3)
    real(DP) :: M(3, 3)
    M = spread(values, 2, 3) * IDENTITY
  end function diagonal


  !> A node over the middle moves with the fibre.
  subroutine check_lever()
    type(driven_director_type) :: d
    real(DP) :: motion(6)
    d = director(2)
    d%lever = 0.5_DP
    motion = 0
    call add_director_motion(d, corners(0.1_DP * spread(d%axes(:, 1), 2, 3) * spread(d%axes(:, 3), 1, 3)), .false., motion)
    call suite%near('offset', norm2(motion(:3) - 0.05_DP * d%axes(:, 1)), 0.0_DP, 1.0e-15_DP)
    motion = 7
    d%n_outer = 0
    call add_director_motion(d, corners(IDENTITY), .true., motion)
    call suite%near('a node of a solid', norm2(motion - 7), 0.0_DP, 0.0_DP)
  end subroutine check_lever


  !> Of the vectors that turn alike the one nearest to the one before.
  subroutine check_continuation()
    real(DP) :: now(3, 3)
    now(:, 1) = [0.0_DP, 0.0_DP, 3.2_DP - 2 * PI]  ! behind 3.0
    now(:, 2) = [0.1_DP, 0.0_DP, 0.0_DP]
    now(:, 3) = 0
    call continue_rotations(reshape([0.0_DP, 0.0_DP, 3.0_DP, 0.05_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], [3, 3]), now)
    call suite%near('past half a turn', norm2(now(:, 1) - [0.0_DP, 0.0_DP, 3.2_DP]), 0.0_DP, 1.0e-14_DP)
    call suite%near('others stay', norm2(now(:, 2) - [0.1_DP, 0.0_DP, 0.0_DP]) + norm2(now(:, 3)), 0.0_DP, 1.0e-15_DP)
  end subroutine check_continuation

end program test_driven_directors
