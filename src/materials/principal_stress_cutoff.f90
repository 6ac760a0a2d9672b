!> NO COMPRESSION and NO TENSION: the principal stresses of one sign are set to zero.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The stress of linear elasticity sigma becomes P(sigma) = sum max(sigma_A, 0) n_A n_A, or min for NO TENSION. P is an isotropic
!! function of sigma: its derivative D has 1 or 0 on its diagonal and (P_A - P_B)/(sigma_A - sigma_B) across. Tangents are D c at
!! small strain. At finite strain Jaumann's rate of P(tau) is D times that of tau, c + [tau], [tau] d = d tau + tau d, so that the
!! tangent of Lie's derivative is D (c + [tau]) - [P(tau)]. It is not symmetric where some principal stresses are cut and others are
!! not, since there is no energy of which the stress is the derivative. Theory: doc/theory/materials.md.
module amontons_principal_stress_cutoff
  use amontons_kinds, only: DP
  use amontons_logarithmic_strain, only: principal_strains_type, find_small_principal_strains, tensor_from_principal, &
    small_principal_tangent, NEXT_AXIS
  use amontons_tensor, only: pack_voigt, unpack_voigt
  implicit none
  private
  public :: cut_principal_stresses

  !> Part of the elastic tangent that stays, so that what carries nothing has a regular matrix. Stresses do not contain it [-].
  real(DP), parameter :: REMAINING_STIFFNESS = 1.0e-4_DP
  !> A principal stress of the other sign that is smaller than this part of the largest is zero: its tangent stays [-].
  real(DP), parameter :: TOL_ZERO = 1.0e-9_DP

contains

  !> Cuts a stress and its tangent.
  pure subroutine cut_principal_stresses(side, is_nlgeom, is_tangent_wanted, stress, tangent)
    integer, intent(in) :: side                    !< 1: tension is carried, -1: compression
    logical, intent(in) :: is_nlgeom               !< Kirchhoff's stress and the tangent of Lie's derivative
    logical, intent(in) :: is_tangent_wanted       !< if not, the tangent is not changed
    real(DP), intent(inout) :: stress(6)           !< [stress]
    real(DP), intent(inout) :: tangent(6, 6)       !< engineering shears [stress]
    type(principal_strains_type) :: principal
    real(DP) :: sign_kept, kept(3), slope(3, 3), secant(3), D(6, 6), rate(6, 6), cut(6)
    logical :: is_kept(3)
    integer :: A, B
    sign_kept = real(side, DP)
    call find_small_principal_strains(stress, principal)
    associate (values => principal%e)
      if (all(sign_kept * values >= 0.0_DP)) return     ! nothing is cut; at rest, too
      kept = sign_kept * max(sign_kept * values, 0.0_DP)
      is_kept = sign_kept * values >= -TOL_ZERO * maxval(abs(values))
      cut = tensor_from_principal(principal, kept)
      if (is_tangent_wanted) then
        slope = 0
        do A = 1, 3
          B = NEXT_AXIS(A)
          slope(A, A) = merge(1.0_DP, 0.0_DP, is_kept(A))
          secant(A) = slope(A, A)
          if (is_kept(A) .neqv. is_kept(B)) secant(A) = (kept(A) - kept(B)) / (values(A) - values(B))
        end do
        D = small_principal_tangent(principal, slope, secant)
        D(:, 4:) = 2 * D(:, 4:)                    ! of the tensor components of a stress, not of engineering shears
        rate = tangent
        if (is_nlgeom) rate = rate + spin_terms(stress)
        rate = matmul(D, rate)
        if (is_nlgeom) rate = rate - spin_terms(cut)
        tangent = rate + REMAINING_STIFFNESS * tangent
      end if
    end associate
    stress = cut
  end subroutine cut_principal_stresses


  !> [tau]: d tau + tau d over the strains d, engineering shears.
  pure function spin_terms(tau) result(terms)
    real(DP), intent(in) :: tau(6)                 !< [stress]
    real(DP) :: terms(6, 6)                        !< [stress]
    real(DP) :: unit(6), d(3, 3), s(3, 3)
    integer :: j
    s = unpack_voigt(tau)
    do j = 1, 6
      unit = 0
      unit(j) = merge(1.0_DP, 0.5_DP, j <= 3)
      d = unpack_voigt(unit)
      terms(:, j) = pack_voigt(matmul(d, s) + matmul(s, d))
    end do
  end function spin_terms

end module amontons_principal_stress_cutoff
