!> Unit test of section_beams: rigid motions, cantilevers in any direction with coupled bending, a centroid off the node.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_section_beams
  use amontons_kinds, only: DP
  use amontons_section_beams, only: find_section_axes, evaluate_section_beam
  use amontons_tensor, only: cross_product
  use amontons_user_elements, only: section_stiffness_type
  use check, only: suite_type
  implicit none
  real(DP), parameter :: X(3, 2) = reshape([1.0_DP, -2.0_DP, 0.5_DP, 4.0_DP, 2.0_DP, 2.5_DP], [3, 2])
  real(DP), parameter :: ROUNDING = 1.0e-11_DP   !< over the largest value: products of twelve numbers [-]
  type(suite_type) :: suite
  call check_axes()
  call check_rigid_motions()
  call check_cantilever()
  call check_offset()
  call suite%finish()

contains

  !> A section with different stiffnesses in all directions.
  pure function uneven() result(section)
    type(section_stiffness_type) :: section
    section%axial = 900
    section%torsion = 7
    section%bending = reshape([30.0_DP, -6.0_DP, -6.0_DP, 11.0_DP], [2, 2])
    section%shear = [40.0_DP, 60.0_DP]
    section%direction = [0.3_DP, 1.0_DP, 0.2_DP]
  end function uneven


  !> Orthonormal, right-handed; none along the direction, none without a length.
  subroutine check_axes()
    real(DP) :: axes(3, 3), length, unit(3, 3)
    integer :: i
    logical :: is_ok
    unit = 0
    do i = 1, 3
      unit(i, i) = 1
    end do
    call find_section_axes(X, [0.0_DP, 0.0_DP, -2.0_DP], axes, length, is_ok)
    call suite%that('axes', is_ok)
    call suite%near('orthonormal', maxval(abs(matmul(transpose(axes), axes) - unit)), 0.0_DP, 1.0e-14_DP)
    call suite%near('right-handed', norm2(cross_product(axes(:, 1), axes(:, 2)) - axes(:, 3)), 0.0_DP, 1.0e-14_DP)
    call suite%near('length', length, sqrt(29.0_DP), 1.0e-14_DP)
    call find_section_axes(X, X(:, 2) - X(:, 1), axes, length, is_ok)
    call suite%that('along the direction', .not. is_ok)
    call find_section_axes(X(:, [1, 1]), [0.0_DP, 0.0_DP, 1.0_DP], axes, length, is_ok)
    call suite%that('without a length', .not. is_ok)
  end subroutine check_axes


  !> No forces in six rigid motions, with a centroid off the nodes too; symmetric.
  subroutine check_rigid_motions()
    type(section_stiffness_type) :: section
    real(DP) :: K(12, 12), motion(12), turn(3)
    integer :: i
    logical :: is_ok
    section = uneven()
    section%centroid = [0.4_DP, -0.7_DP]
    section%shear_center = [-0.2_DP, 0.3_DP]
    call evaluate_section_beam(section, X, K, is_ok)
    call suite%near('symmetric', maxval(abs(K - transpose(K))) / maxval(abs(K)), 0.0_DP, ROUNDING)
    do i = 1, 3
      motion = 0
      motion([i, 6 + i]) = 1
      call suite%near('translation', maxval(abs(matmul(K, motion))) / maxval(abs(K)), 0.0_DP, ROUNDING)
      turn = 0
      turn(i) = 1
      motion = [cross_product(turn, X(:, 1)), turn, cross_product(turn, X(:, 2)), turn]
      call suite%near('rotation', maxval(abs(matmul(K, motion))) / maxval(abs(K)), 0.0_DP, ROUNDING)
    end do
  end subroutine check_rigid_motions


  !> A force and a couple at the free end of a cantilever: bending by the inverse of the coupled stiffness, shear, stretch, twist.
  subroutine check_cantilever()
    type(section_stiffness_type) :: section
    real(DP) :: K(12, 12), axes(3, 3), L, C(2, 2), u(6), force(6), u_exact(3), turn_exact(3), F(2), m(2)
    logical :: is_ok
    section = uneven()
    call find_section_axes(X, section%direction, axes, L, is_ok)
    call evaluate_section_beam(section, X, K, is_ok)
    associate (B => section%bending)
      C = reshape([B(2, 2), -B(1, 2), -B(1, 2), B(1, 1)], [2, 2]) / (B(1, 1) * B(2, 2) - B(1, 2)**2)
    end associate
    ! u = deflection along axes 1, 2 and stretch: a force F2 makes the moment -F2 (L - z) about axis 1, F1 one about axis 2
    F = [0.3_DP, -0.2_DP]
    m = matmul(C, [-F(2), F(1)])                 ! curvatures over L - z
    u_exact = [m(2) * L**3 / 3 + F(1) * L / section%shear(1), -m(1) * L**3 / 3 + F(2) * L / section%shear(2), &
      0.5_DP * L / section%axial]
    turn_exact = [m(1) * L**2 / 2, m(2) * L**2 / 2, 0.1_DP * L / section%torsion]
    u = [matmul(axes, u_exact), matmul(axes, turn_exact)]
    force = [matmul(axes, [F(1), F(2), 0.5_DP]), matmul(axes, [0.0_DP, 0.0_DP, 0.1_DP])]
    call suite%near('force at the end', maxval(abs(matmul(K(7:, 7:), u) - force)), 0.0_DP, ROUNDING)
    m = matmul(C, [0.4_DP, 0.3_DP])              ! uniform curvature
    u = [matmul(axes, [m(2) * L**2 / 2, -m(1) * L**2 / 2, 0.0_DP]), matmul(axes, [m(1) * L, m(2) * L, 0.0_DP])]
    force = [0.0_DP, 0.0_DP, 0.0_DP, matmul(axes, [0.4_DP, 0.3_DP, 0.0_DP])]
    call suite%near('couple at the end', maxval(abs(matmul(K(7:, 7:), u) - force)), 0.0_DP, ROUNDING)
  end subroutine check_cantilever


  !> A pull at a node off the centroid bends: the curvature is that of its moment about the centroid.
  subroutine check_offset()
    type(section_stiffness_type) :: section
    real(DP) :: K(12, 12), axes(3, 3), L, u(6), turn, force(6)
    logical :: is_ok
    section%axial = 900
    section%torsion = 7
    section%bending = reshape([30.0_DP, 0.0_DP, 0.0_DP, 11.0_DP], [2, 2])
    section%shear = [40.0_DP, 60.0_DP]
    section%direction = [0.0_DP, 0.0_DP, 1.0_DP]
    section%centroid = [0.0_DP, 0.5_DP]
    call find_section_axes(X, section%direction, axes, L, is_ok)
    call evaluate_section_beam(section, X, K, is_ok)
    turn = -0.5_DP * 3.0_DP * L / 30.0_DP        ! arm x pull: centroid at +0.5 along axis 2, pull at the node
    u = [matmul(axes, [0.0_DP, -turn * L / 2, 3.0_DP * L / 900.0_DP - 0.5_DP * turn]), matmul(axes, [turn, 0.0_DP, 0.0_DP])]
    force = [matmul(axes, [0.0_DP, 0.0_DP, 3.0_DP]), 0.0_DP, 0.0_DP, 0.0_DP]
    call suite%near('pull off the centroid', maxval(abs(matmul(K(7:, 7:), u) - force)), 0.0_DP, ROUNDING)
    section%shear_center = [0.3_DP, 0.0_DP]      ! a force along axis 2 through it bends and does not twist
    call evaluate_section_beam(section, X, K, is_ok)
    u = [matmul(axes, [0.0_DP, 2 * (L**3 / 90 + L / 60), 0.0_DP]), matmul(axes, [-L**2 / 30, 0.0_DP, 0.0_DP])]
    u(1:3) = u(1:3) + matmul(axes, [0.0_DP, 0.0_DP, 0.5_DP * L**2 / 30])   ! the centroid at +0.5 along axis 2 stays
    force = [matmul(axes, [0.0_DP, 2.0_DP, 0.0_DP]), matmul(axes, [0.0_DP, 0.0_DP, 0.3_DP * 2])]
    call suite%near('force at the shear centre', maxval(abs(matmul(K(7:, 7:), u) - force)), 0.0_DP, ROUNDING)
  end subroutine check_offset

end program test_section_beams
