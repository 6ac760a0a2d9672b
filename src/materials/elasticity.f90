!> Elasticity: Hooke, Hencky and Saint Venant-Kirchhoff laws with consistent tangent and strain energy.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Voigt order xx yy zz xy yz xz. Strains and stresses are tensor components; a tangent multiplies engineering shears:
!! its entries are the components c_ijkl themselves. Theory: doc/theory/materials.md.
module amontons_elasticity
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, is_hyperelastic, LAW_SAINT_VENANT, ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC
  use amontons_tensor, only: VOIGT_IDENTITY, VOIGT_ROW, VOIGT_COLUMN, IDENTITY, determinant_minus_one, double_dot, &
    invert, pack_voigt, push_forward, unpack_voigt
  use amontons_logarithmic_strain, only: principal_strains_type, find_principal_strains, left_cauchy_green, &
    tensor_from_principal, coth_divided_difference, expm1, NEXT_AXIS
  implicit none
  private
  public :: small_strain_stress, finite_strain_stress, kirchhoff_stress, lame_constants, check_gradient
  public :: small_strain_modulus, hooke_stress, isotropic_tangent, green_strain, green_strain_of_stretch, almansi_strain
  public :: gradient_without_swelling
  public :: elasticity_matrix, isochoric_tangent, deviator
  public :: STRESS_OK, STRESS_INVERTED, STRESS_NOT_FINITE, MAX_DISPLACEMENT_GRADIENT

  integer, parameter :: STRESS_OK = 0              !< all is well
  integer, parameter :: STRESS_INVERTED = 1        !< det F is not positive
  integer, parameter :: STRESS_NOT_FINITE = 2      !< NaN or a deformation beyond all bounds

  real(DP), parameter :: MAX_DISPLACEMENT_GRADIENT = 1.0e40_DP   !< larger displacement gradients overflow

contains

  !> Young's modulus at small strain, for a comparison of bodies; of rubber and foam three times the sum of the first constants,
  !! which is of the size of the shear modulus.
  pure real(DP) function small_strain_modulus(material) result(modulus)
    type(material_type), intent(in) :: material
    modulus = material%youngs_modulus
    if (modulus > 0.0_DP .or. .not. allocated(material%elastic%value)) return
    modulus = abs(material%elastic%value(1, 1))
    if (is_hyperelastic(material)) modulus = 6 * modulus
  end function small_strain_modulus


  !> Lame's constants of Young's modulus and Poisson's ratio: lambda = E nu / ((1 + nu)(1 - 2 nu)), G = E / (2 (1 + nu)).
  pure subroutine lame_constants(E, nu, lambda, G)
    real(DP), intent(in) :: E                      !< [stress]
    real(DP), intent(in) :: nu                     !< [-]
    real(DP), intent(out) :: lambda                !< [stress]
    real(DP), intent(out) :: G                     !< [stress]
    G = E / (2 * (1 + nu))
    lambda = E * nu / ((1 + nu) * (1 - 2 * nu))
  end subroutine lame_constants


  !> Hooke's law at small strain, for all elastic laws: stress = lambda tr(strain) 1 + 2 G strain.
  pure subroutine small_strain_stress(material, strain, stress, tangent, energy)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: strain(6)              !< small strain, tensor components [-]
    real(DP), intent(out) :: stress(6)             !< [stress]
    real(DP), intent(out) :: tangent(6, 6)         !< d stress / d strain, engineering shears [stress]
    real(DP), intent(out) :: energy                !< per volume [stress]
    real(DP) :: lambda, G
    call lame_constants(material%youngs_modulus, material%poissons_ratio, lambda, G)
    stress = hooke_stress(lambda, G, strain)
    energy = 0.5_DP * double_dot(stress, strain)
    tangent = isotropic_tangent(lambda, G)
  end subroutine small_strain_stress


  !> Kirchhoff stress, its spatial tangent, the strain and the energy at finite strain.
  !!
  !! The tangent is that of the Lie (Oldroyd) rate: L_v tau = tangent : d.
  !!
  !! | law            | energy                                  | tau                     |
  !! |----------------|-----------------------------------------|-------------------------|
  !! | Hencky         | lambda/2 (tr e)^2 + G e:e, e = 1/2 ln b | lambda tr(e) 1 + 2 G e  |
  !! | Saint-Venant   | lambda/2 (tr E)^2 + G E:E               | F (lambda tr(E) 1 + 2 G E) F^T |
  !!
  !! The argument is the displacement gradient H = F - 1, not F: strains of 1e-9 keep full relative precision, and H = 0
  !! gives zero. Reference: J. Bonet, R. D. Wood, Nonlinear continuum mechanics for finite element analysis, 2nd ed.,
  !! sections 6.5, 6.6.
  pure subroutine finite_strain_stress(material, H, tau, tangent, strain, energy, status)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient du_i/dX_j, F = 1 + H [-]
    real(DP), intent(out) :: tau(6)                !< Kirchhoff stress [stress]
    real(DP), intent(out) :: tangent(6, 6)         !< spatial tangent, engineering shears [stress]
    real(DP), intent(out) :: strain(6)         !< of the law: ln(b)/2, or Green's; tensor components [-]
    real(DP), intent(out) :: energy                !< per reference volume [stress]
    integer, intent(out) :: status                 !< STRESS_...; if not STRESS_OK the rest is zero
    type(principal_strains_type) :: principal
    real(DP) :: lambda, G
    tangent = 0
    call evaluate_elastic_law(material, H, principal, tau, strain, energy, status)
    if (status /= STRESS_OK) return
    call lame_constants(material%youngs_modulus, material%poissons_ratio, lambda, G)
    if (material%law == LAW_SAINT_VENANT) then
      tangent = saint_venant_tangent(lambda, G, H)
    else
      tangent = hencky_tangent(lambda, G, principal)
    end if
  end subroutine finite_strain_stress


  !> The same without the tangent, for the residual alone.
  pure subroutine kirchhoff_stress(material, H, tau, strain, energy, status)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient du_i/dX_j [-]
    real(DP), intent(out) :: tau(6)                !< Kirchhoff stress [stress]
    real(DP), intent(out) :: strain(6)         !< of the law: ln(b)/2, or Green's; tensor components [-]
    real(DP), intent(out) :: energy                !< per reference volume [stress]
    integer, intent(out) :: status                 !< STRESS_...
    type(principal_strains_type) :: principal
    call evaluate_elastic_law(material, H, principal, tau, strain, energy, status)
  end subroutine kirchhoff_stress


  !> Checks a displacement gradient: finite, bounded, not inverted.
  pure function check_gradient(H) result(status)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    integer :: status                              !< STRESS_...
    status = STRESS_NOT_FINITE
    if (.not. all(ieee_is_finite(H))) return
    if (any(abs(H) > MAX_DISPLACEMENT_GRADIENT)) return
    status = STRESS_INVERTED
    if (determinant_minus_one(H) > -1) status = STRESS_OK
  end function check_gradient


  !> Green's strain, (F^T F - 1)/2, computed without cancellation.
  pure function green_strain(H) result(strain)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    real(DP) :: strain(6)                          !< tensor components [-]
    strain = pack_voigt(H + 0.5_DP * matmul(transpose(H), H))
  end function green_strain


  !> Strain, stress and energy of either law.
  pure subroutine evaluate_elastic_law(material, H, principal, tau, strain, energy, status)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: H(3, 3)
    type(principal_strains_type), intent(out) :: principal
    real(DP), intent(out) :: tau(6), strain(6), energy
    integer, intent(out) :: status
    real(DP) :: lambda, G, S(6)
    logical :: is_positive
    tau = 0
    strain = 0
    energy = 0
    status = check_gradient(H)
    if (status /= STRESS_OK) return
    call lame_constants(material%youngs_modulus, material%poissons_ratio, lambda, G)
    if (material%law == LAW_SAINT_VENANT) then
      strain = green_strain(H)
      S = hooke_stress(lambda, G, strain)
      energy = 0.5_DP * double_dot(S, strain)
      tau = push_forward(IDENTITY + H, S)
    else
      call find_principal_strains(left_cauchy_green(H), principal, is_positive)
      status = merge(STRESS_OK, STRESS_INVERTED, is_positive)
      if (.not. is_positive) return
      strain = tensor_from_principal(principal, principal%e)
      tau = hooke_stress(lambda, G, strain)
      energy = 0.5_DP * double_dot(tau, strain)
    end if
  end subroutine evaluate_elastic_law


  !> The tangent of Hencky's law in its principal axes, rotated to global axes:
  !! c_AABB = lambda + (2 G - 2 tau_A) delta_AB, c_ABAB = G d coth(d) - (tau_A + tau_B)/2 with d = e_A - e_B.
  !! Reference: C. Miehe, M. Lambrecht, Algorithms for computation of stresses and elasticity moduli in terms of
  !! Seth-Hill's family of generalized strain tensors, Commun. Numer. Meth. Engng 17 (2001) 337-353.
  pure function hencky_tangent(lambda, G, principal) result(c)
    real(DP), intent(in) :: lambda, G              !< [stress]
    type(principal_strains_type), intent(in) :: principal
    real(DP) :: c(6, 6)                            !< [stress]
    real(DP) :: tau(3), normal(3), shear(3)
    integer :: A, B, j
    tau = lambda * (principal%e(1) + principal%e(2) + principal%e(3)) + 2 * G * principal%e
    do A = 1, 3
      B = NEXT_AXIS(A)
      normal(A) = 2 * G - 2 * tau(A)
      shear(A) = G * coth_divided_difference(principal, A, B) - 0.5_DP * (tau(A) + tau(B))
    end do
    associate (m => principal%m, s => principal%s)
      do j = 1, 6
        c(:, j) = lambda * VOIGT_IDENTITY(j) * VOIGT_IDENTITY &
          + (normal(1) * m(j, 1)) * m(:, 1) + (normal(2) * m(j, 2)) * m(:, 2) + (normal(3) * m(j, 3)) * m(:, 3) &
          + (shear(1) * s(j, 1)) * s(:, 1) + (shear(2) * s(j, 2)) * s(:, 2) + (shear(3) * s(j, 3)) * s(:, 3)
      end do
    end associate
  end function hencky_tangent


  !> The push-forward of Hooke's tangent: c_ijkl = lambda b_ij b_kl + G (b_ik b_jl + b_il b_jk).
  pure function saint_venant_tangent(lambda, G, H) result(c)
    real(DP), intent(in) :: lambda, G              !< [stress]
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    real(DP) :: c(6, 6)                            !< [stress]
    real(DP) :: b(3, 3)
    integer :: p, q, i, j, k, l
    b = IDENTITY + H + transpose(H) + matmul(H, transpose(H))
    do q = 1, 6
      k = VOIGT_ROW(q)
      l = VOIGT_COLUMN(q)
      do p = 1, 6
        i = VOIGT_ROW(p)
        j = VOIGT_COLUMN(p)
        c(p, q) = lambda * b(i, j) * b(k, l) + G * (b(i, k) * b(j, l) + b(i, l) * b(j, k))
      end do
    end do
  end function saint_venant_tangent


  !> lambda tr(e) 1 + 2 G e.
  pure function hooke_stress(lambda, G, strain) result(stress)
    real(DP), intent(in) :: lambda, G              !< [stress]
    real(DP), intent(in) :: strain(6)              !< tensor components [-]
    real(DP) :: stress(6)
    stress = 2 * G * strain
    stress(:3) = stress(:3) + lambda * (strain(1) + strain(2) + strain(3))
  end function hooke_stress


  !> Hooke's matrix for engineering shears.
  pure function isotropic_tangent(lambda, G) result(c)
    real(DP), intent(in) :: lambda, G              !< [stress]
    real(DP) :: c(6, 6)
    integer :: i
    c = 0
    c(:3, :3) = lambda
    do i = 1, 3
      c(i, i) = lambda + 2 * G
      c(i + 3, i + 3) = G
    end do
  end function isotropic_tangent


  !> Green's strain of the stretch 1 + e.
  pure function green_strain_of_stretch(e) result(strain)
    real(DP), intent(in) :: e(6)                   !< tensor components [-]
    real(DP) :: strain(6)
    strain = 0
    if (any(abs(e) > 0)) strain = green_strain(unpack_voigt(e))
  end function green_strain_of_stretch


  !> The displacement gradient of F inv((1 + e) exp(s)) of a body that has swollen by e and s, no difference of numbers near 1:
  !! a body that has swollen freely has no stress.
  pure function gradient_without_swelling(H, e, s) result(rest)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient of F [-]
    real(DP), intent(in) :: e(6)                   !< thermal strain, tensor components, 1 + e positive definite [-]
    real(DP), intent(in) :: s                      !< logarithmic, the same in all directions [-]
    real(DP) :: rest(3, 3), swelling(3, 3), inverse(3, 3), det
    swelling = unpack_voigt(e)
    swelling = swelling + (IDENTITY + swelling) * expm1(s)
    call invert(IDENTITY + swelling, inverse, det)
    rest = matmul(H - swelling, inverse)
  end function gradient_without_swelling


  !> (1 - inv(b))/2 = -(h + h' + h'h)/2 with h = inv(F) - 1 = -inv(F) H, without loss of digits at small strain.
  pure function almansi_strain(H) result(strain)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    real(DP) :: strain(6)
    real(DP) :: inverse(3, 3), det
    call invert(IDENTITY + H, inverse, det)
    strain = -green_strain(-matmul(inverse, H))
  end function almansi_strain


  !> The elasticity matrix in the local axes from the constants in the order of the decks.
  pure function elasticity_matrix(kind, constants) result(C)
    integer, intent(in) :: kind                    !< ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC or ELASTIC_ANISOTROPIC
    real(DP), intent(in) :: constants(:)           !< [stress]; isotropic: E and nu
    real(DP) :: C(6, 6)                            !< 11 22 33 12 23 13, engineering shears [stress]
    integer, parameter :: ABAQUS_ORDER(6) = [1, 2, 3, 4, 6, 5]   !< the decks order the shears 12 13 23
    real(DP) :: lambda, G
    integer :: i, j, k
    if (kind == ELASTIC_ISOTROPIC) then
      call lame_constants(constants(1), constants(2), lambda, G)
      C = isotropic_tangent(lambda, G)
      return
    end if
    C = 0
    k = 0
    do j = 1, 6
      do i = 1, j
        if (kind == ELASTIC_ORTHOTROPIC .and. j > 3 .and. i < j) cycle
        k = k + 1
        C(ABAQUS_ORDER(i), ABAQUS_ORDER(j)) = constants(k)
        C(ABAQUS_ORDER(j), ABAQUS_ORDER(i)) = constants(k)
      end do
    end do
  end function elasticity_matrix


  !> The tangent of s = G dev b: 2 G' (I - 1 1/3) - 2/3 (1 s + s 1), G' = G tr b/3.
  pure function isochoric_tangent(s, modulus) result(tangent)
    real(DP), intent(in) :: s(6)                   !< [stress]
    real(DP), intent(in) :: modulus                !< G' [stress]
    real(DP) :: tangent(6, 6)                      !< engineering shears [stress]
    integer :: i
    tangent = isotropic_tangent(-2 * modulus / 3, modulus)
    do i = 1, 3
      tangent(:, i) = tangent(:, i) - 2 * s / 3
      tangent(i, :) = tangent(i, :) - 2 * s / 3
    end do
  end function isochoric_tangent


  !> The deviator of a symmetric tensor.
  pure function deviator(T) result(D)
    real(DP), intent(in) :: T(6)                   !< Voigt vector
    real(DP) :: D(6)
    D = T - (T(1) + T(2) + T(3)) / 3 * VOIGT_IDENTITY
  end function deviator

end module amontons_elasticity
