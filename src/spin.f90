!> Spin: centrifugal forces of an element that turns about an axis, and how they change as its nodes move.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_spin
  use amontons_kinds, only: DP
  use amontons_topology, only: MAX_NODES, MAX_POINTS, KIND_C3D8R, KIND_C3D8_FULL, KIND_CPS3, KIND_CAX8R, KIND_MASS, KIND_SPRINGA
  use amontons_shapes, only: shape_functions, quadrature
  use amontons_element, only: element_point_volumes, ELEMENT_OK
  implicit none
  private
  public :: centrifugal_forces

contains

  !> Nodal forces f_a = rho omega^2 integral of N_a P (x - p) over the reference volume, P = 1 - a a', and their derivative
  !! rho omega^2 integral of N_a N_b P, which is symmetric. With x = sum N_b x_b both follow from one matrix.
  pure subroutine centrifugal_forces(kind, X, x_now, section, spin, force, stiffness)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: x_now(:, :)            !< (3, nodes) where the nodes are [length]
    real(DP), intent(in) :: section                !< thickness [length], cross-section [length^2] or mass [mass]
    real(DP), intent(in) :: spin(3, 3)             !< columns: p, unit vector a, [rho omega^2, 0, 0]
    real(DP), intent(out) :: force(3, MAX_NODES)   !< zero past the nodes [force]
    real(DP), intent(out) :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)   !< d force/d x, set up to 3 * nodes
    real(DP) :: mass(MAX_NODES, MAX_NODES), P(3, 3)
    integer :: a, b, n
    n = size(X, 2)
    force = 0
    call unit_mass(kind, X, section, mass)
    P = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3]) &
      - spread(spin(:, 2), 2, 3) * spread(spin(:, 2), 1, 3)
    if (kind >= KIND_CPS3 .and. kind <= KIND_CAX8R) P(3, :) = 0   ! nothing moves out of the plane
    P = spin(1, 3) * P
    do b = 1, n
      do a = 1, n
        force(:, a) = force(:, a) + mass(a, b) * matmul(P, x_now(:, b) - spin(:, 1))
        stiffness(3 * a - 2:3 * a, 3 * b - 2:3 * b) = mass(a, b) * P
      end do
    end do
  end subroutine centrifugal_forces


  !> The consistent mass matrix of density 1, by the points that see the whole element; a mass has its own.
  pure subroutine unit_mass(kind, X, section, mass)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :), section
    real(DP), intent(out) :: mass(MAX_NODES, MAX_NODES)
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS), volumes(MAX_POINTS), N(MAX_NODES), dN(3, MAX_NODES)
    integer :: rule, n_rule, p, b, status
    mass = 0
    if (kind == KIND_MASS) mass(1, 1) = section
    if (kind >= KIND_SPRINGA) return
    rule = merge(KIND_C3D8_FULL, kind, kind == KIND_C3D8R)
    call element_point_volumes(rule, X, section, n_rule, volumes, status)
    if (status /= ELEMENT_OK) return               ! told when its forces are asked for
    call quadrature(rule, n_rule, xi, w)
    do p = 1, n_rule
      call shape_functions(rule, xi(:, p), N, dN)
      do b = 1, size(X, 2)
        mass(:size(X, 2), b) = mass(:size(X, 2), b) + (N(b) * volumes(p)) * N(:size(X, 2))
      end do
    end do
  end subroutine unit_mass

end module amontons_spin
