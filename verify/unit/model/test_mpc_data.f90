!> Unit test of amontons_mpc_data: axes of coordinate systems.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_mpc_data
  use amontons_kinds, only: DP
  use amontons_mpc_data, only: coordinate_system_type, axes_at, nonlinear_mpc_type, tie_type, MPC_RIGID_BODY, MPC_PLANE, &
    MPC_STRAIGHT, MPC_DISTANCE, MPC_MEAN_ROTATION
  use amontons_tensor, only: IDENTITY, determinant
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_rectangular()
  call check_cylindrical()
  call check_defaults()
  call suite%finish()

contains

  !> x through a, y towards b, wherever the point is.
  subroutine check_rectangular()
    type(coordinate_system_type) :: rule
    real(DP) :: axes(3, 3)
    call suite%near('default', norm2(axes_at(rule, [5.0_DP, 6.0_DP, 7.0_DP]) - IDENTITY), 0.0_DP, 0.0_DP)
    rule%a = [0.0_DP, 3.0_DP, 0.0_DP]
    rule%b = [-2.0_DP, 1.0_DP, 0.0_DP]
    axes = axes_at(rule, [1.0_DP, 1.0_DP, 1.0_DP])
    call suite%near('turned', norm2(axes - reshape([real(DP) :: 0, 1, 0, -1, 0, 0, 0, 0, 1], [3, 3])), 0.0_DP, 1.0e-15_DP)
  end subroutine check_rectangular


  !> Radial, around, along; on the axis some right-handed axes.
  subroutine check_cylindrical()
    type(coordinate_system_type) :: rule
    real(DP) :: axes(3, 3)
    rule%is_cylindrical = .true.
    rule%a = [1.0_DP, 0.0_DP, 0.0_DP]
    rule%b = [1.0_DP, 0.0_DP, 4.0_DP]
    axes = axes_at(rule, [1.0_DP, 7.0_DP, -3.0_DP])
    call suite%near('radial', norm2(axes(:, 1) - [0.0_DP, 1.0_DP, 0.0_DP]), 0.0_DP, 1.0e-15_DP)
    call suite%near('around', norm2(axes(:, 2) - [-1.0_DP, 0.0_DP, 0.0_DP]), 0.0_DP, 1.0e-15_DP)
    axes = axes_at(rule, [1.0_DP, 0.0_DP, 9.0_DP])
    call suite%near('on the axis: orthonormal', norm2(matmul(transpose(axes), axes) - IDENTITY), 0.0_DP, 1.0e-14_DP)
    call suite%near('on the axis: right-handed', determinant(axes), 1.0_DP, 1.0e-14_DP)
    call suite%near('on the axis: along', axes(3, 3), 1.0_DP, 1.0e-15_DP)
  end subroutine check_cylindrical


  !> What a card that says nothing means.
  subroutine check_defaults()
    type(nonlinear_mpc_type) :: mpc
    type(tie_type) :: tie
    integer :: i
    call suite%that('all directions are bound', all(mpc%is_bound) .and. mpc%kind == MPC_RIGID_BODY)
    call suite%that('a tie moves its nodes, by a tolerance of its own', tie%is_adjusted .and. tie%tolerance < 0)
    call suite%that('kinds', all([MPC_RIGID_BODY, MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE, MPC_MEAN_ROTATION] == [(i, i=1, 5)]))
  end subroutine check_defaults

end program test_mpc_data
