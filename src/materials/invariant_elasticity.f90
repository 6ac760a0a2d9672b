!> Elastic laws in invariants of the right Cauchy-Green tensor C: Ciarlet's, and rubber with fibres.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! | kind | strain energy per reference volume |
!! |---|---|
!! | Ciarlet | mu/2 (tr C - 3) + lambda/4 (det C - 1) - (lambda/4 + mu/2) ln det C |
!! | fibres | C1 (I1 - 3) + (J - 1)^2/D1 + sum k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1), of stretched fibres only |
!!
!! I1 = J^(-2/3) tr C, I4 = J^(-2/3) a'Ca of a fibre along a, J^2 = det C = 1 + j. With K = inv(C), S = 2 dU/dC and
!! dS/dE = 4 d2U/dC dC:
!!
!!     I = J^(-2/3) A:C :   dI = J^(-2/3) (A - (A:C)/3 K),   d2I = J^(-2/3) (-(A K + K A)/3 + (A:C)/9 K K + (A:C)/3 K.K)
!!     ln det C         :   d = K,   d2 = -K.K,   (K.K)_ijkl = (K_ik K_jl + K_il K_jk)/2
!!
!! Strains and stresses are those of the caller: Green's strain and the second Piola-Kirchhoff stress, or small ones. The formulas
!! stay accurate for small strains: 1 - K = 2 E K.
!! References: P. G. Ciarlet, Mathematical Elasticity I (1988), section 4.10; G. A. Holzapfel, T. C. Gasser, R. W. Ogden,
!! J. Elasticity 61 (2000) 1-48; G. Dhondt, CalculiX CrunchiX USER'S MANUAL (names and constants).
module amontons_invariant_elasticity
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_elasticity, only: lame_constants, STRESS_OK, STRESS_INVERTED, STRESS_NOT_FINITE
  use amontons_logarithmic_strain, only: expm1, log1p
  use amontons_materials, only: ELASTIC_CIARLET
  use amontons_tensor, only: IDENTITY, VOIGT_ROW, VOIGT_COLUMN, determinant_minus_one, invert, outer_product, pack_voigt, trace, &
    unpack_voigt
  implicit none
  private
  public :: invariant_law_stress, invariant_law_at_rest, N_FIBRE_CONSTANTS, MAX_FIBRES

  integer, parameter :: N_FIBRE_CONSTANTS = 4      !< of a fibre: two components of its direction, k1, k2
  integer, parameter :: MAX_FIBRES = 4

  !> The deformation, and what the terms of the energy have added.
  type :: sum_type
    real(DP) :: E(3, 3)                            !< strain [-]
    real(DP) :: K(3, 3)                            !< inverse of C [-]
    real(DP) :: j                                  !< det C - 1 [-]
    real(DP) :: S(3, 3) = 0                        !< [stress]
    real(DP) :: tangent(6, 6) = 0                  !< [stress]
    real(DP) :: energy = 0                         !< [stress]
  end type sum_type

contains

  !> Stress, tangent and energy of a strain.
  pure subroutine invariant_law_stress(kind, constants, frame, strain, stress, tangent, energy, status)
    integer, intent(in) :: kind                    !< ELASTIC_CIARLET or ELASTIC_FIBRES
    real(DP), intent(in) :: constants(:)           !< as defined there [stress; D1: 1/stress]
    real(DP), intent(in) :: frame(3, 3)            !< local axes of the material in its columns
    real(DP), intent(in) :: strain(6)              !< tensor components [-]
    real(DP), intent(out) :: stress(6)             !< [stress]
    real(DP), intent(out) :: tangent(6, 6)         !< its derivative, engineering shears [stress]
    real(DP), intent(out) :: energy                !< [stress]
    integer, intent(out) :: status                 !< STRESS_...; NOT_FINITE: a fibre is stretched beyond all bounds, too
    type(sum_type) :: total
    real(DP) :: det, lambda, G
    total%E = unpack_voigt(strain)
    total%j = determinant_minus_one(2 * total%E)
    call invert(IDENTITY + 2 * total%E, total%K, det)
    stress = 0
    tangent = 0
    energy = 0
    status = STRESS_INVERTED
    if (.not. (total%j > -1 .and. 1 + 2 * total%E(1, 1) > 0 .and. total%K(3, 3) > 0)) return   ! the leading minors of C
    call invariant_law_at_rest(kind, constants, lambda, G)
    if (kind == ELASTIC_CIARLET) then
      total%S = 2 * G * matmul(total%E, total%K)   ! of G/2 (tr C - 3 - ln det C)
      total%energy = G * trace(total%E) - 0.5_DP * G * log1p(total%j)
      call add_products(0.0_DP, 2 * G, total)
      call add_volume(0.25_DP * lambda * total%j, 0.25_DP * lambda * (1 + total%j), &
        0.25_DP * lambda * (total%j - log1p(total%j)), total)
    else
      call add_fibre_rubber(constants, frame, total)
    end if
    stress = pack_voigt(total%S)
    tangent = total%tangent
    energy = total%energy
    status = merge(STRESS_OK, STRESS_NOT_FINITE, ieee_is_finite(energy) .and. all(ieee_is_finite(tangent)))
  end subroutine invariant_law_stress


  !> Lame's constants at rest; without the fibres, which carry only when they are stretched.
  pure subroutine invariant_law_at_rest(kind, constants, lambda, G)
    integer, intent(in) :: kind                    !< ELASTIC_CIARLET or ELASTIC_FIBRES
    real(DP), intent(in) :: constants(:)           !< as defined there
    real(DP), intent(out) :: lambda, G             !< [stress]
    if (kind == ELASTIC_CIARLET) then
      call lame_constants(constants(1), constants(2), lambda, G)
    else
      G = 2 * constants(1)
      lambda = 2 / constants(2) - 2 * G / 3
    end if
  end subroutine invariant_law_at_rest


  !> Rubber and its fibres.
  pure subroutine add_fibre_rubber(constants, frame, total)
    real(DP), intent(in) :: constants(:)           !< C1, D1, and two components of a, k1, k2 of each fibre; k1 = 0: none
    real(DP), intent(in) :: frame(3, 3)
    type(sum_type), intent(inout) :: total
    real(DP) :: J, a(3), stretch, exponential
    integer :: i
    associate (C1 => constants(1), D1 => constants(2))
      call add_isochoric(IDENTITY, C1, 0.0_DP, total)
      total%energy = total%energy + C1 * isochoric_growth(IDENTITY, total)
      J = sqrt(1 + total%j)
      call add_volume(J * (J - 1) / D1, J * (2 * J - 1) / (2 * D1), (J - 1)**2 / D1, total)
    end associate
    do i = 1, min(MAX_FIBRES, (size(constants) - 2) / N_FIBRE_CONSTANTS)
      associate (fibre => constants(N_FIBRE_CONSTANTS * i - 1:N_FIBRE_CONSTANTS * i + 2))
        if (.not. fibre(3) > 0) cycle
        a = matmul(frame, [fibre(1), fibre(2), sqrt(max(0.0_DP, 1 - fibre(1)**2 - fibre(2)**2))])
        stretch = isochoric_growth(outer_product(a, a), total)
        if (stretch < 0) cycle
        exponential = exp(fibre(4) * stretch**2)
        call add_isochoric(outer_product(a, a), fibre(3) * stretch * exponential, fibre(3) * (1 + 2 * fibre(4) * stretch**2) * &
          exponential, total)
        if (fibre(4) > 0) then
          total%energy = total%energy + fibre(3) / (2 * fibre(4)) * expm1(fibre(4) * stretch**2)
        else
          total%energy = total%energy + 0.5_DP * fibre(3) * stretch**2
        end if
      end associate
    end do
  end subroutine add_fibre_rubber


  !> J^(-2/3) A:C - tr A.
  pure real(DP) function isochoric_growth(A, total) result(growth)
    real(DP), intent(in) :: A(3, 3)
    type(sum_type), intent(in) :: total
    real(DP) :: change
    change = expm1(-log1p(total%j) / 3)
    growth = 2 * (1 + change) * sum(A * total%E) + change * trace(A)
  end function isochoric_growth


  !> Adds stress and tangent of an energy g(I), I = J^(-2/3) A:C.
  pure subroutine add_isochoric(A, g1, g2, total)
    real(DP), intent(in) :: A(3, 3)
    real(DP), intent(in) :: g1, g2                 !< first and second derivative of g [stress]
    type(sum_type), intent(inout) :: total
    real(DP) :: scale, AC, D(3, 3), voigt_A(6), voigt_K(6), voigt_D(6)
    scale = (1 + total%j)**(-1 / 3.0_DP)
    AC = trace(A) + 2 * sum(A * total%E)
    D = scale * ((A - trace(A) / 3 * IDENTITY) + (trace(A) / 3) * 2 * matmul(total%E, total%K) - 2 * sum(A * total%E) / 3 * total%K)
    total%S = total%S + 2 * g1 * D
    voigt_A = pack_voigt(A)
    voigt_K = pack_voigt(total%K)
    voigt_D = pack_voigt(D)
    total%tangent = total%tangent + 4 * g2 * outer(voigt_D, voigt_D) - 4 * g1 * scale / 3 * (outer(voigt_A, voigt_K) + &
      outer(voigt_K, voigt_A))
    call add_products(4 * g1 * scale * AC / 9, 4 * g1 * scale * AC / 3, total)
  end subroutine add_isochoric


  !> Adds stress, tangent and energy of a function of the volume ratio.
  pure subroutine add_volume(slope, curvature, energy, total)
    real(DP), intent(in) :: slope, curvature       !< its derivatives by ln det C [stress]
    real(DP), intent(in) :: energy                 !< its value [stress]
    type(sum_type), intent(inout) :: total
    total%S = total%S + 2 * slope * total%K
    total%energy = total%energy + energy
    call add_products(4 * curvature, -4 * slope, total)
  end subroutine add_volume


  !> Adds p K K + q K.K to the tangent.
  pure subroutine add_products(p, q, total)
    real(DP), intent(in) :: p, q                   !< [stress]
    type(sum_type), intent(inout) :: total
    integer :: i, j, k, l, row, column
    do column = 1, 6
      k = VOIGT_ROW(column)
      l = VOIGT_COLUMN(column)
      do row = 1, 6
        i = VOIGT_ROW(row)
        j = VOIGT_COLUMN(row)
        total%tangent(row, column) = total%tangent(row, column) + p * total%K(i, j) * total%K(k, l) &
          + 0.5_DP * q * (total%K(i, k) * total%K(j, l) + total%K(i, l) * total%K(j, k))
      end do
    end do
  end subroutine add_products


  !> x y'.
  pure function outer(x, y) result(product)
    real(DP), intent(in) :: x(6), y(6)
    real(DP) :: product(6, 6)
    product = spread(x, 2, 6) * spread(y, 1, 6)
  end function outer

end module amontons_invariant_elasticity
