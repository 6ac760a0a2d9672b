!> Unit test of amontons_hourglass: no force on linear fields, energy against force and stiffness, bending of a brick.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_hourglass
  use amontons_elasticity, only: isotropic_tangent
  use amontons_hourglass, only: hourglass_type, set_physical_hourglass, set_artificial_hourglass, add_hourglass_forces, &
    add_thickness_stabilization, has_present_modulus, artificial_modulus
  use amontons_materials, only: material_type, LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY, VOIGT_INDEX, VOIGT_ROW, VOIGT_COLUMN
  use amontons_element_kinds, only: MAX_ELEMENT_NODES
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: N_DOF = 3 * MAX_ELEMENT_NODES
  real(DP), parameter :: SIGNS(3, 8) = reshape([real(DP) :: &
    -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])
  real(DP), parameter :: A(3, 3) = reshape([1.3_DP, 0.2_DP, -0.1_DP, 0.1_DP, 0.8_DP, 0.3_DP, -0.2_DP, 0.1_DP, 1.1_DP], [3, 3])
  integer :: i, n_seed, d
  logical :: is_artificial
  call random_seed(size=n_seed)
  call random_seed(put=[(122949823 + 31 * i, i=1, n_seed)])
  do d = 2, 3
    is_artificial = .false.
    do i = 1, 2
      call check_linear_fields(d, is_artificial)
      call check_derivatives(d, is_artificial, .false.)
      call check_derivatives(d, is_artificial, .true.)
      is_artificial = .true.
    end do
  end do
  call check_bending()
  call check_thickness(.false.)
  call check_thickness(.true.)
  call check_modulus()
  call suite%finish()

contains

  !> The modulus of the artificial stiffness: E of an elastic material, else the first entry of the tangent pulled back.
  subroutine check_modulus()
    type(material_type) :: material
    real(DP) :: c(6, 6), spatial(6, 6), H(3, 3), F(3, 3), modulus
    integer :: p, q, i, j, k, l
    material%law = LAW_SAINT_VENANT
    c = isotropic_tangent(3.0_DP, 2.0_DP)
    spatial = -1
    H = 0
    modulus = artificial_modulus(material, c, spatial, H)
    call suite%near('the modulus of an elastic material', modulus, 5.2_DP, 1.0e-12_DP)
    call suite%that('an elastic material needs no tangent', .not. has_present_modulus(material))
    allocate (material%isotropic_hardening(1))
    call suite%that('a plastic one does', has_present_modulus(material))
    call suite%near('the modulus of a plastic one at rest', artificial_modulus(material, -c, c, H), 7.0_DP, 1.0e-12_DP)
    call random_number(c)
    c = c + transpose(c)
    call random_number(H)
    F = IDENTITY + H
    spatial = 0
    do p = 1, 6
      do q = 1, 6
        do i = 1, 3
          do j = 1, 3
            do k = 1, 3
              do l = 1, 3
                associate (m => VOIGT_INDEX(i, j), n => VOIGT_INDEX(k, l))
                  spatial(p, q) = spatial(p, q) + F(VOIGT_ROW(p), i) * F(VOIGT_COLUMN(p), j) * F(VOIGT_ROW(q), k) &
                    * F(VOIGT_COLUMN(q), l) * c(m, n)
                end associate
              end do
            end do
          end do
        end do
      end do
    end do
    call suite%near('the modulus at finite strain', artificial_modulus(material, -c, spatial, H), c(1, 1), 1.0e-9_DP)
    material%law = LAW_HENCKY
    call suite%that('the abaqus dialect needs none', .not. has_present_modulus(material))
  end subroutine check_modulus


  !> A parallelepiped or a parallelogram: its mean gradients are those of its middle.
  subroutine make(d, is_artificial, X, hourglass)
    integer, intent(in) :: d
    logical, intent(in) :: is_artificial
    real(DP), intent(out) :: X(3, 8)
    type(hourglass_type), intent(out) :: hourglass
    real(DP) :: inverse(3, 3), gradient(8, 3), volume, across(8)
    integer :: n
    n = 2**d
    X = 0
    X(:d, :n) = matmul(A(:d, :d), SIGNS(:d, :n))
    inverse = IDENTITY
    volume = A(1, 1) * A(2, 2) - A(1, 2) * A(2, 1)
    inverse(:2, :2) = reshape([A(2, 2), -A(2, 1), -A(1, 2), A(1, 1)], [2, 2]) / volume
    if (d == 3) call invert_matrix(inverse, volume)
    gradient(:n, :d) = matmul(transpose(SIGNS(:d, :n)), inverse(:d, :d)) / real(n, DP)
    volume = volume * real(n, DP)
    call set_physical_hourglass(d, X, gradient(:n, :d), volume, isotropic_tangent(3.0_DP, 2.0_DP), hourglass)
    across = 0.25_DP
    if (is_artificial) call set_artificial_hourglass(hourglass, volume, 5.2_DP, across(:n), 1.0_DP)
  end subroutine make


  !> The inverse of A and its determinant.
  subroutine invert_matrix(inverse, det)
    real(DP), intent(out) :: inverse(3, 3), det
    integer :: r, c
    do r = 1, 3
      do c = 1, 3
        inverse(c, r) = A(modulo(r, 3) + 1, modulo(c, 3) + 1) * A(modulo(r + 1, 3) + 1, modulo(c + 1, 3) + 1) &
          - A(modulo(r, 3) + 1, modulo(c + 1, 3) + 1) * A(modulo(r + 1, 3) + 1, modulo(c, 3) + 1)
      end do
    end do
    det = dot_product(A(1, :), inverse(:, 1))
    inverse = inverse / det
  end subroutine invert_matrix


  !> No energy and no force where the displacements are linear, also in large rotations.
  subroutine check_linear_fields(d, is_artificial)
    integer, intent(in) :: d
    logical, intent(in) :: is_artificial
    type(hourglass_type) :: hourglass
    real(DP) :: X(3, 8), u(3, 8), force(3, MAX_ELEMENT_NODES), energy, H(3, 3)
    call make(d, is_artificial, X, hourglass)
    call random_number(H)
    u = matmul(H, X)
    u(1, :) = u(1, :) + 7
    u(d + 1:, :) = 0
    force = 0
    call add_hourglass_forces(hourglass, u, .true., energy, force)
    call suite%near('a linear field: energy', energy, 0.0_DP, 1.0e-25_DP)
    call suite%near('a linear field: force', norm2(force), 0.0_DP, 1.0e-12_DP)
    u(1, 1) = u(1, 1) + 1
    call add_hourglass_forces(hourglass, u, .true., energy, force)
    call suite%that('one corner moved: energy', energy > 1.0e-4_DP)
  end subroutine check_linear_fields


  !> The force is the derivative of the energy, the stiffness that of the force, and what was there stays.
  subroutine check_derivatives(d, is_artificial, is_nlgeom)
    integer, intent(in) :: d
    logical, intent(in) :: is_artificial, is_nlgeom
    type(hourglass_type) :: hourglass
    real(DP) :: X(3, 8), u(3, 8), v(3, 8), force(3, MAX_ELEMENT_NODES), K(N_DOF, N_DOF), plus, minus, energy, row(24)
    real(DP) :: other(3, MAX_ELEMENT_NODES), before(3, MAX_ELEMENT_NODES)
    real(DP), parameter :: STEP = 1.0e-5_DP
    integer :: n, i, k_node, j
    n = 2**d
    call make(d, is_artificial, X, hourglass)
    call random_number(u)
    u(d + 1:, :) = 0
    force = 1
    K = 0
    call add_hourglass_forces(hourglass, u, is_nlgeom, energy, force, K)
    do k_node = 1, n
      do i = 1, d
        v = u
        v(i, k_node) = u(i, k_node) + STEP
        other = 0
        call add_hourglass_forces(hourglass, v, is_nlgeom, plus, other)
        v(i, k_node) = u(i, k_node) - STEP
        before = 0
        call add_hourglass_forces(hourglass, v, is_nlgeom, minus, before)
        call suite%near('force', force(i, k_node) - 1, (plus - minus) / (2 * STEP), 1.0e-8_DP)
        other = (other - before) / (2 * STEP)
        j = d * (k_node - 1) + i
        row(:d * n) = reshape(other(:d, :n), [d * n])
        if (d == 2) j = 3 * (k_node - 1) + i
        if (d == 2) call suite%near('stiffness', norm2(reshape(K(j, :3 * n), [3, n]) - other(:, :n)), 0.0_DP, 1.0e-7_DP)
        if (d == 3) call suite%near('stiffness', norm2(K(j, :d * n) - row(:d * n)), 0.0_DP, 1.0e-7_DP)
      end do
    end do
    call suite%that('symmetric', all(K == transpose(K)) .and. norm2(K) > 1.0e-4_DP)
  end subroutine check_derivatives


  !> Thickness stabilization of a C3D20R shell: no energy where the thickness strain is bilinear, nor in a finite rotation; the mode
  !! s = eta^2 - 1/3, that two by two points do not see, has some; force and stiffness are derivatives.
  subroutine check_thickness(is_nlgeom)
    logical, intent(in) :: is_nlgeom
    real(DP), parameter :: XI(2, 8) = reshape([real(DP) :: -1, -1, 1, -1, 1, 1, -1, 1, 0, -1, 1, 0, 0, 1, -1, 0], [2, 8])
    real(DP), parameter :: STEP = 1.0e-5_DP, ANGLE = 0.7_DP
    integer, parameter :: BOTTOM(8) = [1, 2, 3, 4, 9, 10, 11, 12], TOP(8) = [5, 6, 7, 8, 13, 14, 15, 16]
    real(DP) :: X(3, 20), u(3, 20), v(3, 20), c(6, 6), energy, plus, minus, R(3, 3)
    real(DP), dimension(3, MAX_ELEMENT_NODES) :: force, other, before
    real(DP) :: K(N_DOF, N_DOF)
    integer :: a, i
    c = isotropic_tangent(3.0_DP, 2.0_DP)
    X = 0
    X(:2, BOTTOM) = XI
    X(:2, TOP) = XI
    X(3, TOP) = 0.1_DP
    force = 0
    u = 0
    u(3, TOP) = 0.01_DP * (1 + XI(1, :)) * (2 - XI(2, :))
    call add_thickness_stabilization(X, u, .false., c, 0.4_DP, energy, force)
    call suite%near('bilinear: energy', energy, 0.0_DP, 1.0e-25_DP)
    call suite%near('bilinear: force', norm2(force), 0.0_DP, 1.0e-12_DP)
    if (is_nlgeom) then
      R = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, cos(ANGLE), sin(ANGLE), 0.0_DP, -sin(ANGLE), cos(ANGLE)], [3, 3])
      u = matmul(R, X) - X
      call add_thickness_stabilization(X, u, .true., c, 0.4_DP, energy, force)
      call suite%near('rotated: energy', energy, 0.0_DP, 1.0e-25_DP)
    end if
    u = 0
    u(3, TOP) = 0.01_DP * (XI(2, :)**2 - 1.0_DP / 3)
    call add_thickness_stabilization(X, u, .false., c, 0.4_DP, energy, force)
    call suite%near('eta^2 - 1/3: energy', energy, 0.5_DP * 1.0e-5_DP * 7 * 0.1_DP * 2 * 0.1_DP**2, 1.0e-17_DP)   ! c33 = 7, g = 0.1
    call random_number(u)
    force = 1
    K = 0
    call add_thickness_stabilization(X, u, is_nlgeom, c, 0.4_DP, energy, force, K)
    do a = 1, 20
      do i = 1, 3
        v = u
        v(i, a) = u(i, a) + STEP
        other = 0
        call add_thickness_stabilization(X, v, is_nlgeom, c, 0.4_DP, plus, other)
        v(i, a) = u(i, a) - STEP
        before = 0
        call add_thickness_stabilization(X, v, is_nlgeom, c, 0.4_DP, minus, before)
        call suite%near('thickness: force', force(i, a) - 1, (plus - minus) / (2 * STEP), 1.0e-6_DP)
        call suite%near('thickness: stiffness', norm2(reshape(K(3 * a - 3 + i, :60), [3, 20]) - (other(:, :20) - before(:, :20)) &
          / (2 * STEP)), 0.0_DP, 1.0e-6_DP)
      end do
    end do
    call suite%that('thickness: symmetric', all(K == transpose(K)) .and. norm2(K) > 1.0e-4_DP)
  end subroutine check_thickness


  !> Bending of a cube, u_x = xi eta: the strain xx = eta has the energy E/2 times the integral of eta^2.
  subroutine check_bending()
    type(hourglass_type) :: hourglass
    real(DP) :: u(3, 8), force(3, MAX_ELEMENT_NODES), energy
    real(DP), parameter :: LAMBDA = 0, G = 2
    call set_physical_hourglass(3, SIGNS, transpose(SIGNS) / 8, 8.0_DP, isotropic_tangent(LAMBDA, G), hourglass)
    u = 0
    u(1, :) = SIGNS(1, :) * SIGNS(2, :)
    force = 0
    call add_hourglass_forces(hourglass, u, .false., energy, force)
    call suite%near('bending of a cube', energy, 0.5_DP * 2 * G * 8 / 3, 1.0e-13_DP)
    call suite%near('its force does that work', sum(force(:, :8) * u), 2 * energy, 1.0e-13_DP)
  end subroutine check_bending

end program test_hourglass
