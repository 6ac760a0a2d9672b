!> Unit test of equivalent_layers: equal layers have the A, B and D that are given; homogeneous plates; what no layers have.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_equivalent_layers
  use amontons_kinds, only: DP
  use amontons_equivalent_layers, only: equivalent_layers_type, find_equivalent_layers, transverse_shear_moduli, &
    N_EQUIVALENT_LAYERS, LAYERS_OK, LAYERS_INDEFINITE, LAYERS_IMPOSSIBLE
  use check, only: suite_type
  implicit none
  real(DP), parameter :: FIBRES(3, 3) = reshape([25.0_DP, 0.25_DP, 0.0_DP, 0.25_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.5_DP], [3, 3])
  type(suite_type) :: suite
  call check_homogeneous()
  call check_laminates()
  call check_refusals()
  call check_shear()
  call suite%finish()

contains

  !> A homogeneous plate: layers of its stiffness.
  subroutine check_homogeneous()
    type(equivalent_layers_type) :: layers
    real(DP) :: stiffness(6, 6)
    integer :: status, k
    stiffness = 0
    stiffness(:3, :3) = 2 * FIBRES
    stiffness(4:, 4:) = 2.0_DP**3 / 12 * FIBRES
    call find_equivalent_layers(stiffness, layers, status)
    call suite%that('homogeneous', status == LAYERS_OK)
    call suite%near('its thickness', N_EQUIVALENT_LAYERS * layers%thickness, 2.0_DP, 1.0e-13_DP)
    do k = 1, N_EQUIVALENT_LAYERS
      call suite%near('its material', maxval(abs(layers%Q(:, :, k) - FIBRES)), 0.0_DP, 1.0e-10_DP)
    end do
    call suite%near('transverse shear', layers%transverse_shear, 2 * (26 / 6.0_DP + 0.5_DP / 3), 1.0e-13_DP)
  end subroutine check_homogeneous


  !> The stiffness of plies of one thickness at angles comes back; two plies, a sandwich, an angle ply.
  subroutine check_laminates()
    call check_plies([0.5_DP, 0.5_DP], [0.0_DP, 90.0_DP], [1.0_DP, 1.0_DP], 'cross ply')
    call check_plies([0.5_DP, 0.5_DP], [45.0_DP, -45.0_DP], [1.0_DP, 1.0_DP], 'angle ply')
    call check_plies([0.1_DP, 0.8_DP, 0.1_DP], [0.0_DP, 0.0_DP, 0.0_DP], [1.0_DP, 1.0e-2_DP, 1.0_DP], 'sandwich')
    call check_plies([0.1_DP, 0.2_DP, 0.3_DP, 0.4_DP], [0.0_DP, 30.0_DP, 60.0_DP, 90.0_DP], [1.0_DP, 1.0_DP, 1.0_DP, 1.0_DP], &
      'plies')
  end subroutine check_laminates


  !> Shear moduli: of one layer K/h; of many K/(5/6 h); of unequal layers those of the same stack of thin sublayers in the limit.
  subroutine check_shear()
    real(DP), parameter :: K(2, 2) = reshape([4.0_DP, 1.0_DP, 1.0_DP, 6.0_DP], [2, 2])
    real(DP) :: G(2, 2), fine(2, 2)
    integer :: i
    G = transverse_shear_moduli(K, [0.5_DP], reshape([7.0_DP, 3.0_DP], [2, 1]), .false.)
    call suite%near('one layer', maxval(abs(G - 2 * K)), 0.0_DP, 1.0e-13_DP)
    G = transverse_shear_moduli(K, [0.5_DP], reshape([7.0_DP, 3.0_DP], [2, 1]), .true.)
    call suite%near('one quadratic layer', maxval(abs(G - 2 * K)), 0.0_DP, 1.0e-13_DP)
    G = transverse_shear_moduli(K, [(0.01_DP, i=1, 50)], reshape([(1.0_DP, i=1, 100)], [2, 50]), .false.)
    call suite%near('many layers', maxval(abs(G - 2.4_DP * K)) / 8, 0.0_DP, 1.0e-3_DP)
    G = transverse_shear_moduli(K, [0.1_DP, 0.1_DP, 0.3_DP], reshape([7.0_DP, 1.0_DP, 2.0_DP, 5.0_DP, 1.0_DP, 1.0_DP], [2, 3]), &
      .true.)
    fine = transverse_shear_moduli(K, [(0.01_DP, i=1, 50)], reshape([(7.0_DP, 1.0_DP, i=1, 10), (2.0_DP, 5.0_DP, i=1, 10), &
      (1.0_DP, 1.0_DP, i=1, 30)], [2, 50]), .true.)
    call suite%near('unequal layers', maxval(abs(G - fine)) / maxval(abs(fine)), 0.0_DP, 0.02_DP)
    call suite%that('symmetric', abs(G(1, 2) - G(2, 1)) < 1.0e-12_DP)
  end subroutine check_shear


  !> Layers of plies: those of the same stiffness, positive definite.
  subroutine check_plies(thickness, angle, factor, name)
    real(DP), intent(in) :: thickness(:), angle(:), factor(:)   !< [length], [degrees], over FIBRES
    character(*), intent(in) :: name
    type(equivalent_layers_type) :: layers
    real(DP) :: stiffness(6, 6), Q(3, 3), z
    integer :: k, status
    stiffness = 0
    z = -0.5_DP * sum(thickness)
    do k = 1, size(thickness)
      Q = factor(k) * turned(angle(k) * acos(-1.0_DP) / 180)
      stiffness(:3, :3) = stiffness(:3, :3) + thickness(k) * Q
      stiffness(:3, 4:) = stiffness(:3, 4:) + ((z + thickness(k))**2 - z**2) / 2 * Q
      stiffness(4:, 4:) = stiffness(4:, 4:) + ((z + thickness(k))**3 - z**3) / 3 * Q
      z = z + thickness(k)
    end do
    stiffness(4:, :3) = transpose(stiffness(:3, 4:))
    call find_equivalent_layers(stiffness, layers, status)
    call suite%that(name, status == LAYERS_OK)
    call suite%near(name // ': stiffness', maxval(abs(layers_stiffness(layers) - stiffness)), 0.0_DP, 1.0e-10_DP)   ! 25
  end subroutine check_plies


  !> A, B and D of layers by classical lamination theory.
  pure function layers_stiffness(layers) result(stiffness)
    type(equivalent_layers_type), intent(in) :: layers
    real(DP) :: stiffness(6, 6), low, high
    integer :: k
    stiffness = 0
    do k = 1, N_EQUIVALENT_LAYERS
      low = (real(k - 1, DP) - 0.5_DP * N_EQUIVALENT_LAYERS) * layers%thickness
      high = low + layers%thickness
      stiffness(:3, :3) = stiffness(:3, :3) + (high - low) * layers%Q(:, :, k)
      stiffness(:3, 4:) = stiffness(:3, 4:) + (high**2 - low**2) / 2 * layers%Q(:, :, k)
      stiffness(4:, 4:) = stiffness(4:, 4:) + (high**3 - low**3) / 3 * layers%Q(:, :, k)
    end do
    stiffness(4:, :3) = transpose(stiffness(:3, 4:))
  end function layers_stiffness


  !> FIBRES turned by an angle.
  pure function turned(angle) result(Q)
    real(DP), intent(in) :: angle                  !< [rad]
    real(DP) :: Q(3, 3), T(3, 3), c, s
    c = cos(angle)
    s = sin(angle)
    T = reshape([c**2, s**2, -2 * c * s, s**2, c**2, 2 * c * s, c * s, -c * s, c**2 - s**2], [3, 3])   ! strains along the fibres
    Q = matmul(transpose(T), matmul(FIBRES, T))
  end function turned


  !> An indefinite section; one that bends a thousand times stiffer in one direction than it stretches.
  subroutine check_refusals()
    type(equivalent_layers_type) :: layers
    real(DP) :: stiffness(6, 6)
    integer :: status, k
    stiffness = 0
    do k = 1, 6
      stiffness(k, k) = 1
    end do
    stiffness(1, 4) = 1.5_DP
    stiffness(4, 1) = 1.5_DP
    call find_equivalent_layers(stiffness, layers, status)
    call suite%that('indefinite', status == LAYERS_INDEFINITE)
    stiffness(1, 4) = 0
    stiffness(4, 1) = 0
    stiffness(4, 4) = 1000
    call find_equivalent_layers(stiffness, layers, status)
    call suite%that('a rib', status == LAYERS_IMPOSSIBLE)
    stiffness(4, 4) = 0
    call find_equivalent_layers(stiffness, layers, status)
    call suite%that('no bending', status == LAYERS_INDEFINITE)
  end subroutine check_refusals

end program test_equivalent_layers
