!> Unit test of amontons_material_axes: rectangular and cylindrical axes, rotations, and the projection on a shell.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_material_axes
  use amontons_kinds, only: DP, PI
  use amontons_material_axes, only: evaluate_orientation
  use amontons_materials, only: orientation_type, SYSTEM_CYLINDRICAL
  use amontons_tensor, only: IDENTITY
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: X(3) = IDENTITY(:, 1), Y(3) = IDENTITY(:, 2), Z(3) = IDENTITY(:, 3), ORIGIN(3) = 0
  real(DP), parameter :: TOL = 1.0e-14_DP
  type(orientation_type) :: turned, cylinder, shell
  real(DP) :: axes(3, 3)

  turned%a = [0.0_DP, 2.0_DP, 0.0_DP]
  turned%b = [-3.0_DP, 1.0_DP, 0.0_DP]
  axes = evaluate_orientation(turned, ORIGIN, Z)
  call suite%near('a gives x, b the side of y', norm2(axes - reshape([Y, -X, Z], [3, 3])), 0.0_DP, TOL)
  turned%rotation_axis = 3
  turned%rotation_angle = PI / 2
  axes = evaluate_orientation(turned, ORIGIN, Z)
  call suite%near('turned about z', norm2(axes - reshape([-X, -Y, Z], [3, 3])), 0.0_DP, TOL)

  cylinder%system = SYSTEM_CYLINDRICAL
  cylinder%a = ORIGIN
  cylinder%b = 2 * Z
  axes = evaluate_orientation(cylinder, [0.0_DP, 3.0_DP, 5.0_DP], Z)
  call suite%near('radial, around, along', norm2(axes - reshape([Y, -X, Z], [3, 3])), 0.0_DP, TOL)
  axes = evaluate_orientation(cylinder, [0.0_DP, 0.0_DP, 5.0_DP], Z)
  call suite%near('on the axis', norm2(axes - IDENTITY), 0.0_DP, TOL)

  shell%is_projected = .true.
  shell%normal_axis = 3                            ! the axis behind it is x
  shell%layer_angle = PI / 6
  axes = evaluate_orientation(shell, ORIGIN, Y)
  call suite%near('x projected and turned about the normal', norm2(axes(:, 1) - cos(PI / 6) * X + sin(PI / 6) * Z), 0.0_DP, TOL)
  call suite%near('the normal is the third', norm2(axes(:, 3) - Y), 0.0_DP, TOL)
  axes = evaluate_orientation(shell, ORIGIN, X)
  call suite%near('x along the normal: z is projected', norm2(axes(:, 3) - X) + abs(dot_product(axes(:, 1), X)), 0.0_DP, TOL)
  call suite%finish()
end program test_material_axes
