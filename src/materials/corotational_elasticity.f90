!> Elasticity that is linear in the stretch U: a second Piola-Kirchhoff stress C : (U - 1), as CalculiX's LIN_EL_COROT.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! U is the root of 1 + 2 E, E Green's strain. In its principal axes 2 dE_ab = (U_a + U_b) dU_ab. The tangent is unsymmetric: there
!! is no potential.
!! Reference: G. Dhondt, CalculiX CrunchiX USER'S MANUAL (name and constants).
module amontons_corotational_elasticity
  use amontons_kinds, only: DP
  use amontons_elasticity, only: STRESS_OK, STRESS_INVERTED
  use amontons_tensor, only: double_dot, pack_voigt, symmetric_eigen, unpack_voigt
  implicit none
  private
  public :: corotational_stress

contains

  !> Stress, tangent and energy of a strain.
  pure subroutine corotational_stress(C, strain, stress, tangent, energy, status)
    real(DP), intent(in) :: C(6, 6)                !< elasticity, engineering shears [stress]
    real(DP), intent(in) :: strain(6)              !< E, tensor components [-]
    real(DP), intent(out) :: stress(6)             !< [stress]
    real(DP), intent(out) :: tangent(6, 6)         !< its derivative, engineering shears [stress]
    real(DP), intent(out) :: energy                !< half the product of stress and U - 1 [stress]
    integer, intent(out) :: status                 !< STRESS_...
    real(DP) :: E(3), axes(3, 3), U(3), stretch(6), unit(3, 3), local(3, 3), dU(6, 6)
    integer :: k, a
    stress = 0
    tangent = 0
    energy = 0
    call symmetric_eigen(strain, E, axes)
    status = merge(STRESS_OK, STRESS_INVERTED, minval(E) > -0.5_DP)
    if (status /= STRESS_OK) return
    U = sqrt(1 + 2 * E)
    do k = 1, 6                                    ! of an engineering strain
      unit = unpack_voigt([(merge(merge(1.0_DP, 0.5_DP, k <= 3), 0.0_DP, a == k), a=1, 6)])
      local = matmul(transpose(axes), matmul(unit, axes))
      do a = 1, 3
        local(:, a) = 2 * local(:, a) / (U + U(a))
      end do
      dU(:, k) = pack_voigt(matmul(axes, matmul(local, transpose(axes))))
    end do
    local = 0
    do a = 1, 3
      local(a, a) = 2 * E(a) / (1 + U(a))          ! U - 1
    end do
    stretch = pack_voigt(matmul(axes, matmul(local, transpose(axes))))
    stress = matmul(C, [stretch(:3), 2 * stretch(4:)])
    dU(4:, :) = 2 * dU(4:, :)
    tangent = matmul(C, dU)
    energy = 0.5_DP * double_dot(stress, stretch)
  end subroutine corotational_stress

end module amontons_corotational_elasticity
