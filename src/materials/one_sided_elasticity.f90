!> Materials that carry tension only (sheets, textiles) or compression only (masonry, concrete): each principal stress follows
!! the principal strain of the same direction.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Tension only, with x = e/w:
!!
!!     s(e) = E e (1/2 + atan(x)/pi),   w = pi s0/E,
!!
!! so that the stress is E e far on one side and -s0 far on the other. Compression only: -s(-e). Strains and stresses are those of
!! the caller: small ones, or Green's strain and the second Piola-Kirchhoff stress. There is no Poisson effect.
!! Reference: G. Dhondt, CalculiX CrunchiX USER'S MANUAL, Tension-only and compression-only materials.
module amontons_one_sided_elasticity
  use amontons_kinds, only: DP, PI
  use amontons_hyperelasticity, only: principal_response_type
  use amontons_logarithmic_strain, only: principal_strains_type, find_small_principal_strains, small_principal_tangent, &
    tensor_from_principal, NEXT_AXIS
  use amontons_materials, only: ELASTIC_TENSION_ONLY
  implicit none
  private
  public :: one_sided_stress, evaluate_one_sided

contains

  !> Stress, tangent and energy of a strain.
  pure subroutine one_sided_stress(kind, constants, strain, stress, tangent, energy)
    integer, intent(in) :: kind                    !< ELASTIC_TENSION_ONLY or ELASTIC_COMPRESSION_ONLY
    real(DP), intent(in) :: constants(:)           !< E, s0, both positive [stress]
    real(DP), intent(in) :: strain(6)              !< tensor components [-]
    real(DP), intent(out) :: stress(6)             !< [stress]
    real(DP), intent(out) :: tangent(6, 6)         !< its derivative, engineering shears [stress]
    real(DP), intent(out) :: energy                !< [stress]
    type(principal_strains_type) :: principal
    type(principal_response_type) :: response
    call find_small_principal_strains(strain, principal)
    call evaluate_one_sided(kind, constants, principal%e, response)
    stress = tensor_from_principal(principal, response%tau)
    tangent = small_principal_tangent(principal, response%slope, response%secant)
    energy = response%energy
  end subroutine one_sided_stress


  !> Principal stresses of principal strains.
  pure subroutine evaluate_one_sided(kind, constants, e, response)
    integer, intent(in) :: kind                    !< ELASTIC_TENSION_ONLY or ELASTIC_COMPRESSION_ONLY
    real(DP), intent(in) :: constants(:)           !< E, s0, both positive [stress]
    real(DP), intent(in) :: e(3)                   !< principal strains [-]
    type(principal_response_type), intent(out) :: response
    real(DP) :: w, x(3), angle(3), side
    integer :: A, B
    side = merge(1.0_DP, -1.0_DP, kind == ELASTIC_TENSION_ONLY)
    associate (modulus => constants(1))
      w = PI * constants(2) / modulus
      x = side * e / w
      angle = atan(x)
      response%tau = modulus * e * (0.5_DP + angle / PI)
      response%energy = modulus * sum(0.25_DP * e**2 + w**2 * ((1 + x**2) * angle - x) / (2 * PI))
      do A = 1, 3
        B = NEXT_AXIS(A)
        response%slope(A, A) = modulus * (0.5_DP + (angle(A) + x(A) / (1 + x(A)**2)) / PI)
        response%secant(A) = modulus * (0.5_DP + (0.5_DP * (angle(A) + angle(B)) &
          + 0.5_DP * (x(A) + x(B)) * arctangent_quotient(x(A), x(B))) / PI)
      end do
    end associate
  end subroutine evaluate_one_sided


  !> (atan(a) - atan(b))/(a - b), without cancellation.
  pure real(DP) function arctangent_quotient(a, b) result(quotient)
    real(DP), intent(in) :: a, b
    real(DP) :: t
    real(DP), parameter :: SMALL = 1.0e-3_DP       ! the next term of the series is of t^6
    t = a - b
    if (1 + a * b > 0) t = t / (1 + a * b)
    if (1 + a * b > 0 .and. abs(t) < SMALL) then
      quotient = (1 - t**2 / 3 + t**4 / 5) / (1 + a * b)
    else
      quotient = atan2(a - b, 1 + a * b) / (a - b)
    end if
  end function arctangent_quotient

end module amontons_one_sided_elasticity
