!> Unit test of amontons_face_separation: components, derivatives against differences, rotation of all vectors.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_face_separation
  use amontons_face_separation, only: separation_type, evaluate_separation, N_VARIABLES
  use amontons_kinds, only: DP
  use check, only: suite_type
  implicit none
  real(DP), parameter :: Y(N_VARIABLES) = [1.1_DP, 0.2_DP, -0.1_DP, 0.3_DP, 0.9_DP, 0.25_DP, -0.3_DP, 0.4_DP, 0.7_DP]
  !> A proper rotation.
  real(DP), parameter :: TILT(3, 3) = reshape([real(DP) :: 2, 1, 2, -2, 2, 1, -1, -2, 2], [3, 3]) / 3
  real(DP), parameter :: STEP = 1.0e-6_DP
  type(suite_type) :: suite
  type(separation_type) :: base, before, behind, turned
  real(DP) :: z(N_VARIABLES)
  integer :: i, j

  base = evaluate_separation([2.0_DP, 0.0_DP, 0.0_DP], [1.0_DP, 3.0_DP, 0.0_DP], [0.3_DP, 0.4_DP, 0.5_DP])
  call suite%near('components in the frame', norm2(base%value - [0.5_DP, 0.3_DP, 0.4_DP]), 0.0_DP, 1.0e-15_DP)
  base = evaluate_separation(Y(:3), Y(4:6), Y(7:))
  call suite%near('length', norm2(base%value), norm2(Y(7:)), 1.0e-14_DP)
  do j = 1, N_VARIABLES
    z = Y
    z(j) = Y(j) - STEP
    before = evaluate_separation(z(:3), z(4:6), z(7:))
    z(j) = Y(j) + STEP
    behind = evaluate_separation(z(:3), z(4:6), z(7:))
    call suite%near('slope', norm2(base%slope(j, :) - (behind%value - before%value) / (2 * STEP)), 0.0_DP, 1.0e-8_DP)
    call suite%near('curvature', norm2(base%curvature(:, j, :) - (behind%slope - before%slope) / (2 * STEP)), 0.0_DP, 1.0e-8_DP)
  end do
  do i = 1, 3
    call suite%near('symmetric', maxval(abs(base%curvature(:, :, i) - transpose(base%curvature(:, :, i)))), 0.0_DP, 1.0e-14_DP)
  end do
  turned = evaluate_separation(matmul(TILT, Y(:3)), matmul(TILT, Y(4:6)), matmul(TILT, Y(7:)))
  call suite%near('rotation changes nothing', norm2(turned%value - base%value), 0.0_DP, 1.0e-14_DP)
  call suite%finish()

end program test_face_separation
