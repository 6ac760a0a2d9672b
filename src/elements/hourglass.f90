!> Hourglass control of elements with one integration point: physical stabilization or Flanagan-Belytschko stiffness.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A hexahedron with one point resists only its mean strain; its hourglass modes (four in three dimensions, one in the plane,
!! in each direction) have no stiffness. A stabilization energy controls them ("physical stabilisation"),
!!
!!     W = 1/2 sum M_(i alpha)(j beta) p_i alpha p_j beta,   p_alpha = F^T q_alpha,   q_alpha = sum_a gamma_a alpha u_a
!!
!! with the vectors gamma of Flanagan and Belytschko, which are orthogonal to all linear fields, so that the patch test
!! is passed; with F the mean deformation gradient, so that a rigid rotation has zero energy; and with M the elastic energy of
!! the strains that vary linearly over the element, without those that lock, as in assumed strain and
!! incompatible mode elements. Force and tangent are the exact derivatives of W. There is no user parameter. Where an inelastic law
!! flows the stress follows: `hourglass_flow`.
!!
!! The calculix dialect uses Flanagan and Belytschko's artificial stiffness, as CalculiX: W = k/2 sum |sum_a 8 gamma_a alpha u_a|^2
!! with k = 0.0005 M V sum |grad N_a|^2, which is far softer. M is E of an isotropic elastic material, of all others the first entry
!! of their present tangent (`artificial_modulus`). (CalculiX 2.20 omits the first two coordinates in the orthogonalization of gamma
!! to linear fields; here gamma is orthogonal to all.)
!!
!! References: D. P. Flanagan, T. Belytschko, A uniform strain hexahedron and quadrilateral with orthogonal hourglass
!! control, Int. J. Numer. Meth. Engng 17 (1981) 679-706; T. Belytschko, L. P. Bindeman, Assumed strain stabilization of
!! the eight node hexahedral element, Comput. Meth. Appl. Mech. Engng 105 (1993) 225-260; M. A. Puso, A highly efficient
!! enhanced assumed strain physically stabilized hexahedral element, Int. J. Numer. Meth. Engng 49 (2000) 1029-1064.
!! Theory: doc/theory/elements.md, section "One point and hourglass stiffness".
module amontons_hourglass
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY, invert, unpack_voigt, VOIGT_ROW, VOIGT_COLUMN
  use amontons_element_kinds, only: MAX_ELEMENT_NODES
  use amontons_materials, only: material_type, is_isotropic_elastic, LAW_SAINT_VENANT
  implicit none
  private
  public :: hourglass_type, set_physical_hourglass, set_artificial_hourglass, add_hourglass_forces
  public :: has_present_modulus, artificial_modulus
  public :: hourglass_amplitudes, hourglass_strain, MAX_HOURGLASS_SAMPLES
  public :: add_thickness_stabilization

  integer, parameter :: MAX_ELEMENT_CORNERS = 8, MAX_MODES = 4
  integer, parameter :: MAX_HOURGLASS_SAMPLES = 8                 !< Gauss points of the full rule
  real(DP), parameter :: ARTIFICIAL_HOURGLASS_FACTOR = 0.0005_DP      !< of CalculiX's hourglass stiffness [-]
  real(DP), parameter :: THICKNESS_FACTOR = 1.0e-5_DP   !< of the thickness stabilization, over the stiffness of the material [-]
                                                         !! larger: coarse shells stiffen (doc/theory/elements.md)

  !> Nodes at the bottom and top of the fibres of a C3D20: corners, then mid-sides.
  integer, parameter :: FIBRE(2, 8) = reshape([1, 5, 2, 6, 3, 7, 4, 8, 9, 13, 10, 14, 11, 15, 12, 16], [2, 8])

  integer, parameter :: NEXT_DIRECTION(3) = [2, 3, 1], SHEAR_COMPONENT(3) = [5, 6, 4]   ! Voigt place of 23, 31, 12

  ! Signs of the corners: xi, eta, zeta. Those of the samples are the same.
  real(DP), parameter :: CORNER_SIGNS(3, 8) = reshape([real(DP) :: &
    -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1], [3, 8])

  !> What the hourglass energy of one element needs.
  type :: hourglass_type
    integer :: d = 3                                    !< 3 in space, 2 in the plane
    integer :: n = 8                                    !< corners
    integer :: m = 4                                    !< modes of each component: 4 or 1
    real(DP) :: gamma(MAX_ELEMENT_CORNERS, MAX_MODES) = 0       !< [-]
    real(DP) :: gradient(MAX_ELEMENT_CORNERS, 3) = 0            !< mean dN_a/dX_j [1/length]
    real(DP) :: matrix(3 * MAX_MODES, 3 * MAX_MODES) = 0   !< M; (i, alpha) is i + d (alpha - 1) [force/length]
    real(DP) :: J(3, 3) = 0                             !< dX_k/dxi_i at the centre, column i [length]
    real(DP) :: natural(6, 6) = 0                       !< elastic tangent of the natural strains
    real(DP) :: inelastic(3 * MAX_MODES) = 0            !< amplitudes p that have flowed before [length]
    real(DP) :: start(3 * MAX_MODES) = 0                !< amplitudes at the start of the increment [length]
    real(DP) :: tangent(3 * MAX_MODES, 3 * MAX_MODES) = 0  !< M from there on, that of a flowing material is softer [force/length]
  end type hourglass_type

contains

  !> The hourglass vectors and the matrix M of an element.
  pure subroutine set_physical_hourglass(d, X, gradient, volume, c, hourglass)
    integer, intent(in) :: d                       !< 3: hexahedron of 8 nodes, 2: square of 4
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: gradient(:, :)         !< (nodes, d) mean dN_a/dX_j [1/length]
    real(DP), intent(in) :: volume                 !< [length^3]
    real(DP), intent(in) :: c(6, 6)                !< elastic tangent at rest, engineering shears [stress]
    type(hourglass_type), intent(out) :: hourglass
    real(DP) :: base(MAX_ELEMENT_CORNERS, MAX_MODES), J(3, 3)
    integer :: n, m, i, alpha
    hourglass%d = d
    n = 2**d
    m = merge(4, 1, d == 3)
    hourglass%n = n
    hourglass%m = m
    hourglass%gradient(:n, :d) = gradient(:n, :d)
    base(:, 1) = CORNER_SIGNS(1, :) * CORNER_SIGNS(2, :)
    if (d == 3) then
      base(:, 3) = base(:, 1)
      base(:, 1) = CORNER_SIGNS(2, :) * CORNER_SIGNS(3, :)
      base(:, 2) = CORNER_SIGNS(3, :) * CORNER_SIGNS(1, :)
      base(:, 4) = base(:, 1) * CORNER_SIGNS(1, :)
    end if
    J = 0
    J(3, 3) = 1
    do i = 1, d
      J(:d, i) = matmul(X(:d, :n), CORNER_SIGNS(i, :n)) / real(n, DP)
    end do
    do alpha = 1, m
      hourglass%gamma(:n, alpha) = base(:n, alpha)
      do i = 1, d
        hourglass%gamma(:n, alpha) = hourglass%gamma(:n, alpha) - dot_product(base(:n, alpha), X(i, :n)) * gradient(:n, i)
      end do
      hourglass%gamma(:n, alpha) = hourglass%gamma(:n, alpha) / real(n, DP)
    end do
    hourglass%J = J
    hourglass%natural = natural_tangent(J, c)
    if (d == 3) call set_solid_matrix(J, volume, hourglass%natural, hourglass%matrix)
    if (d == 2) call set_plane_matrix(J, volume, hourglass%natural, hourglass%matrix)
    hourglass%tangent = hourglass%matrix
  end subroutine set_physical_hourglass


  !> Replaces M by CalculiX's stiffness. CalculiX models a plane element as a hexahedron of one layer: its mode moves both sides
  !! equally, and it has gradients across.
  pure subroutine set_artificial_hourglass(hourglass, volume, modulus, thickness_gradients, n_sectors)
    type(hourglass_type), intent(inout) :: hourglass
    real(DP), intent(in) :: volume                 !< [length^3]
    real(DP), intent(in) :: modulus                !< M, of `artificial_modulus` [stress]
    real(DP), intent(in) :: thickness_gradients(:)              !< plane: (nodes) mean gradients along the third axis, of either
                                                                !! side [1/length]
    real(DP), intent(in) :: n_sectors              !< of the circle, 1 for all but axisymmetric elements
    real(DP) :: k
    integer :: i
    k = sum(hourglass%gradient(:hourglass%n, :hourglass%d)**2)
    if (hourglass%d == 2) k = 0.5_DP * k + 2 * sum(thickness_gradients**2)
    k = ARTIFICIAL_HOURGLASS_FACTOR * modulus * (volume / n_sectors) * k
    hourglass%matrix = 0
    do i = 1, 3 * MAX_MODES
      hourglass%matrix(i, i) = 64 * k * n_sectors
    end do
    hourglass%tangent = hourglass%matrix
  end subroutine set_artificial_hourglass


  !> Whether the hourglass stiffness of a material needs its present tangent.
  pure logical function has_present_modulus(material) result(has)
    type(material_type), intent(in) :: material
    has = material%law == LAW_SAINT_VENANT .and. .not. is_isotropic_elastic(material)
  end function has_present_modulus


  !> M of the artificial stiffness, as CalculiX takes it: the first constant of the elasticity that it has at a point. That is E of
  !! an isotropic elastic material; of all others the derivative of the second Piola-Kirchhoff stress 11 by Green's strain 11 in
  !! global axes, of the present state. It falls where the material flows, and varies with the stretch of rubber. The stiffness
  !! leaves its derivative out: the mean strain does not depend on the modes, so that this costs an iteration at most.
  pure real(DP) function artificial_modulus(material, at_rest, tangent, H) result(modulus)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: at_rest(6, 6)          !< tangent at rest, engineering shears [stress]
    real(DP), intent(in) :: tangent(6, 6)          !< present one, if has_present_modulus; spatial at finite strain [stress]
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient; zero at small strain [-]
    real(DP) :: inverse(3, 3), det, row(6)
    integer :: p
    if (.not. has_present_modulus(material)) then
      modulus = uniaxial_modulus(at_rest, 1, 2, 3)
      return
    end if
    call invert(IDENTITY + H, inverse, det)
    do p = 1, 6
      row(p) = merge(1.0_DP, 2.0_DP, p <= 3) * inverse(1, VOIGT_ROW(p)) * inverse(1, VOIGT_COLUMN(p))
    end do
    modulus = dot_product(row, matmul(tangent, row))
  end function artificial_modulus


  !> M of the hexahedron. With P_alpha = J^T p_alpha the strains in natural components are
  !!
  !! | varies with | normal strains               | shear                        | free to follow (enhanced) |
  !! |-------------|------------------------------|------------------------------|---------------------------|
  !! | xi          | 22: P_3(2), 33: P_2(3)       | 2 * 23: P_3(3) + P_2(2)      | 11                        |
  !! | eta         | 33: P_1(3), 11: P_3(1)       | 2 * 31: P_1(1) + P_3(3)      | 22                        |
  !! | zeta        | 11: P_2(1), 22: P_1(2)       | 2 * 12: P_2(2) + P_1(1)      | 33                        |
  !! | eta zeta    | 11: P_4(1)                   |                              | 22, 33                    |
  !!
  !! and so on round for the last; the mean squares of these functions are 1/3 and 1/9.
  pure subroutine set_solid_matrix(J, volume, natural, matrix)
    real(DP), intent(in) :: J(3, 3)                !< dX_k/dxi_i at the centre, column i [length]
    real(DP), intent(in) :: volume                 !< [length^3]
    real(DP), intent(in) :: natural(6, 6)          !< of `natural_tangent`
    real(DP), intent(out) :: matrix(12, 12)
    real(DP) :: block(3, 3), map(3, 12), jacobians(12, 12)
    integer :: i, k, l, alpha
    matrix = 0
    do i = 1, 3
      k = NEXT_DIRECTION(i)
      l = NEXT_DIRECTION(k)
      block = condense_strain(natural, i, [k, l, SHEAR_COMPONENT(i)])
      map = 0                                      ! columns: component + 3 (mode - 1)
      map(1, k + 3 * (l - 1)) = 1
      map(2, l + 3 * (k - 1)) = 1
      map(3, l + 3 * (l - 1)) = 1
      map(3, k + 3 * (k - 1)) = 1
      matrix = matrix + (volume / 3) * matmul(transpose(map), matmul(block, map))
      matrix(9 + i, 9 + i) = (volume / 9) * uniaxial_modulus(natural, i, k, l)
    end do
    jacobians = 0
    do alpha = 1, 4
      jacobians(3 * alpha - 2:3 * alpha, 3 * alpha - 2:3 * alpha) = transpose(J)
    end do
    matrix = matmul(transpose(jacobians), matmul(matrix, jacobians))
    matrix = 0.5_DP * (matrix + transpose(matrix))
  end subroutine set_solid_matrix


  !> M of the plane square: strain 11 varies as eta P(1), strain 22 as xi P(2), the other one free to follow.
  pure subroutine set_plane_matrix(J, volume, natural, matrix)
    real(DP), intent(in) :: J(3, 3)                !< dX_k/dxi_i at the centre, column i; third axis of length one
    real(DP), intent(in) :: volume                 !< [length^3]
    real(DP), intent(in) :: natural(6, 6)          !< of `natural_tangent`
    real(DP), intent(out) :: matrix(12, 12)
    real(DP) :: diagonal(2, 2)
    diagonal = 0
    diagonal(1, 1) = natural(1, 1) - natural(1, 2)**2 / natural(2, 2)
    diagonal(2, 2) = natural(2, 2) - natural(1, 2)**2 / natural(1, 1)
    matrix = 0
    matrix(:2, :2) = (volume / 3) * matmul(J(:2, :2), matmul(diagonal, transpose(J(:2, :2))))
    matrix(1, 2) = matrix(2, 1)
  end subroutine set_plane_matrix


  !> The tangent for strains in natural (covariant) components: T^T c T, E = J^-T E_natural J^-1.
  pure function natural_tangent(J, c) result(natural)
    real(DP), intent(in) :: J(3, 3), c(6, 6)
    real(DP) :: natural(6, 6)
    real(DP) :: inverse(3, 3), det, T(6, 6)
    integer :: p, q
    call invert(J, inverse, det)
    do q = 1, 6
      do p = 1, 6
        associate (k => VOIGT_ROW(p), l => VOIGT_COLUMN(p), i => VOIGT_ROW(q), m => VOIGT_COLUMN(q))
          T(p, q) = 0.5_DP * (inverse(i, k) * inverse(m, l) + inverse(m, k) * inverse(i, l))
          if (p > 3) T(p, q) = 2 * T(p, q)         ! engineering shears on both sides
        end associate
      end do
    end do
    natural = matmul(transpose(T), matmul(c, T))
  end function natural_tangent


  !> The modulus of three strains when a fourth has zero stress and the rest are zero.
  pure function condense_strain(c, free, kept) result(block)
    real(DP), intent(in) :: c(6, 6)
    integer, intent(in) :: free, kept(3)
    real(DP) :: block(3, 3)
    integer :: i, j
    do j = 1, 3
      do i = 1, 3
        block(i, j) = c(kept(i), kept(j)) - c(kept(i), free) * c(free, kept(j)) / c(free, free)
      end do
    end do
  end function condense_strain


  !> The modulus of one normal strain when the stresses of the other two are zero.
  pure real(DP) function uniaxial_modulus(c, i, k, l) result(modulus)
    real(DP), intent(in) :: c(6, 6)
    integer, intent(in) :: i, k, l
    real(DP) :: det
    det = c(k, k) * c(l, l) - c(k, l)**2
    modulus = c(i, i) - (c(i, k)**2 * c(l, l) - 2 * c(i, k) * c(i, l) * c(k, l) + c(i, l)**2 * c(k, k)) / det
  end function uniaxial_modulus


  !> The amplitudes p.
  pure function hourglass_amplitudes(hourglass, u, is_nlgeom) result(p)
    type(hourglass_type), intent(in) :: hourglass
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP) :: p(3 * MAX_MODES)                   !< [length]
    real(DP) :: F(3, 3), q(3, MAX_MODES)
    call find_amplitudes(hourglass, u, is_nlgeom, F, q, p)
  end function hourglass_amplitudes


  !> The strain of amplitudes p at a sample, in addition to the mean one, with the strains that are free to follow: that whose
  !! energy is W. Referred to the undeformed element.
  pure function hourglass_strain(hourglass, p, sample) result(strain)
    type(hourglass_type), intent(in) :: hourglass
    real(DP), intent(in) :: p(:)                   !< [length]
    integer, intent(in) :: sample                  !< 1 to 2^d
    real(DP) :: strain(3, 3)                       !< tensor components [-]
    real(DP) :: natural(6), inverse(3, 3), det, place(3), amplitudes(3, MAX_MODES)
    integer :: alpha
    place = CORNER_SIGNS(:, sample) / sqrt(3.0_DP)
    amplitudes = 0
    associate (d => hourglass%d)
      do alpha = 1, hourglass%m
        amplitudes(:d, alpha) = matmul(transpose(hourglass%J(:d, :d)), p(d * (alpha - 1) + 1:d * alpha))
      end do
      if (d == 3) natural = natural_solid_strain(hourglass%natural, amplitudes, place)
      if (d == 2) natural = natural_plane_strain(hourglass%natural, amplitudes(:, 1), place)
    end associate
    natural(4:) = natural(4:) / 2
    call invert(hourglass%J, inverse, det)
    strain = matmul(transpose(inverse), matmul(unpack_voigt(natural), inverse))
  end function hourglass_strain


  !> The natural strains of the hexahedron at a place: the table of `set_solid_matrix`.
  pure function natural_solid_strain(c, P, place) result(strain)
    real(DP), intent(in) :: c(6, 6)                !< of `natural_tangent`
    real(DP), intent(in) :: P(3, MAX_MODES)        !< J^T p [length^2]
    real(DP), intent(in) :: place(3)
    real(DP) :: strain(6), kept(3), det
    integer :: i, k, l
    strain = 0
    do i = 1, 3
      k = NEXT_DIRECTION(i)
      l = NEXT_DIRECTION(k)
      kept = place(i) * [P(k, l), P(l, k), P(l, l) + P(k, k)]
      associate (at => [k, l, SHEAR_COMPONENT(i)])
        strain(at) = strain(at) + kept
        strain(i) = strain(i) - dot_product(c(i, at), kept) / c(i, i)
      end associate
      kept(1) = place(k) * place(l) * P(i, 4)
      det = c(k, k) * c(l, l) - c(k, l)**2
      strain(i) = strain(i) + kept(1)
      strain(k) = strain(k) - (c(l, l) * c(k, i) - c(k, l) * c(l, i)) / det * kept(1)
      strain(l) = strain(l) - (c(k, k) * c(l, i) - c(k, l) * c(k, i)) / det * kept(1)
    end do
  end function natural_solid_strain


  !> Those of the square.
  pure function natural_plane_strain(c, P, place) result(strain)
    real(DP), intent(in) :: c(6, 6)                !< of `natural_tangent`
    real(DP), intent(in) :: P(3)                   !< J^T p [length^2]
    real(DP), intent(in) :: place(3)
    real(DP) :: strain(6)
    strain = 0
    strain(1) = place(2) * P(1) - c(1, 2) / c(1, 1) * place(1) * P(2)
    strain(2) = place(1) * P(2) - c(1, 2) / c(2, 2) * place(2) * P(1)
  end function natural_plane_strain


  !> The mean deformation gradient, q, and the amplitudes p.
  pure subroutine find_amplitudes(hourglass, u, is_nlgeom, F, q, p)
    type(hourglass_type), intent(in) :: hourglass
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: F(3, 3), q(3, MAX_MODES), p(3 * MAX_MODES)
    integer :: a, i, alpha
    F = IDENTITY
    q = 0
    p = 0
    associate (d => hourglass%d, gamma => hourglass%gamma)
      do a = 2, hourglass%n
        do alpha = 1, hourglass%m
          q(:d, alpha) = q(:d, alpha) + gamma(a, alpha) * (u(:d, a) - u(:d, 1))
        end do
        if (.not. is_nlgeom) cycle
        do i = 1, d
          F(:d, i) = F(:d, i) + hourglass%gradient(a, i) * (u(:d, a) - u(:d, 1))
        end do
      end do
      do alpha = 1, hourglass%m
        do i = 1, d
          p(i + d * (alpha - 1)) = dot_product(F(:d, i), q(:d, alpha))
        end do
      end do
    end associate
  end subroutine find_amplitudes


  !> Adds force and, if wanted, stiffness of the hourglass energy. Without flow it is p . M p / 2.
  pure subroutine add_hourglass_forces(hourglass, u, is_nlgeom, energy, force, stiffness)
    type(hourglass_type), intent(in) :: hourglass
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: energy                !< W [energy]
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES) !< [force]
    real(DP), intent(inout), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< [force/length]
    real(DP) :: F(3, 3), q(3, MAX_MODES), p(3 * MAX_MODES), s(3 * MAX_MODES), slope(3 * MAX_MODES, 3 * MAX_ELEMENT_CORNERS)
    integer :: a, k, rows
    associate (d => hourglass%d)
      rows = d * hourglass%m
      call find_amplitudes(hourglass, u, is_nlgeom, F, q, p)
      s(:rows) = matmul(hourglass%matrix(:rows, :rows), hourglass%start(:rows) - hourglass%inelastic(:rows)) &
        + matmul(hourglass%tangent(:rows, :rows), p(:rows) - hourglass%start(:rows))
      energy = 0.5_DP * dot_product(p(:rows) - hourglass%inelastic(:rows), s(:rows))
      call set_strain_derivative(hourglass, F, q, is_nlgeom, slope)
      do a = 1, hourglass%n
        do k = 1, d
          force(k, a) = force(k, a) + dot_product(s(:rows), slope(:rows, d * (a - 1) + k))
        end do
      end do
    end associate
    if (present(stiffness)) call add_stiffness(hourglass, slope, s, is_nlgeom, stiffness)
  end subroutine add_hourglass_forces


  !> The derivative of p by the displacements: gamma F^T, and under NLGEOM the change of F times q.
  pure subroutine set_strain_derivative(hourglass, F, q, is_nlgeom, slope)
    type(hourglass_type), intent(in) :: hourglass
    real(DP), intent(in) :: F(3, 3), q(3, MAX_MODES)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: slope(3 * MAX_MODES, 3 * MAX_ELEMENT_CORNERS)
    integer :: a, i, k, alpha
    associate (d => hourglass%d)
      do a = 1, hourglass%n
        do k = 1, d
          do concurrent(i=1:d, alpha=1:hourglass%m)
            slope(i + d * (alpha - 1), d * (a - 1) + k) = hourglass%gamma(a, alpha) * F(k, i) &
              + merge(hourglass%gradient(a, i) * q(k, alpha), 0.0_DP, is_nlgeom)
          end do
        end do
      end do
    end associate
  end subroutine set_strain_derivative


  !> The second derivative of W: slope^T M slope, and under NLGEOM the change of the slope times s. Written to both
  !! sides of the diagonal: symmetric to the last bit.
  pure subroutine add_stiffness(hourglass, slope, s, is_nlgeom, stiffness)
    type(hourglass_type), intent(in) :: hourglass
    real(DP), intent(in) :: slope(3 * MAX_MODES, 3 * MAX_ELEMENT_CORNERS), s(3 * MAX_MODES)
    logical, intent(in) :: is_nlgeom
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: product(3 * MAX_MODES, 3 * MAX_ELEMENT_CORNERS), sb(MAX_ELEMENT_CORNERS, MAX_MODES), term
    integer :: a, b, i, j, r, c, alpha, rows
    associate (d => hourglass%d, n => hourglass%n, m => hourglass%m)
      rows = d * m
      product(:rows, :d * n) = matmul(hourglass%tangent(:rows, :rows), slope(:rows, :d * n))
      sb = 0
      do alpha = 1, m
        do i = 1, d
          sb(:n, alpha) = sb(:n, alpha) + s(i + d * (alpha - 1)) * hourglass%gradient(:n, i)
        end do
      end do
      do c = 1, d * n
        b = (c - 1) / d + 1
        j = c - d * (b - 1)
        do r = c, d * n
          a = (r - 1) / d + 1
          i = r - d * (a - 1)
          term = dot_product(slope(:rows, r), product(:rows, c))
          if (is_nlgeom .and. i == j) term = term + dot_product(sb(a, :m), hourglass%gamma(b, :m)) &
            + dot_product(sb(b, :m), hourglass%gamma(a, :m))
          associate (row => 3 * (a - 1) + i, column => 3 * (b - 1) + j)
            stiffness(row, column) = stiffness(row, column) + term
            if (row /= column) stiffness(column, row) = stiffness(column, row) + term
          end associate
        end do
      end do
    end associate
  end subroutine add_stiffness


  !> Thickness stabilization of a shell of one layer of C3D20R. The four points of each half see a thickness strain s that is
  !! bilinear along the middle surface; the mid-side fibres can add modes without energy that neighbours share. With g = s at a
  !! mid-side fibre minus the mean of s at the corner fibres beside it, W = k/2 sum g^2 with k = THICKNESS_FACTOR c V / 4, c along
  !! the mean fibre. s is Green's strain of the fibre, (|d|^2 - |D|^2) / (2 |D|^2), linearised without NLGEOM.
  pure subroutine add_thickness_stabilization(X, u, is_nlgeom, c, volume, energy, force, stiffness)
    real(DP), intent(in) :: X(:, :)                !< (3, 20) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, 20) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: c(6, 6)                !< elastic tangent at rest [stress]
    real(DP), intent(in) :: volume                 !< [length^3]
    real(DP), intent(out) :: energy                !< W [energy]
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES) !< [force]
    real(DP), intent(inout), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< [force/length]
    real(DP) :: D(3, 8), change(3, 8), length(8), strain(8), slope(3, 8), weight(8), fibre_strain(6), n(3), g, k
    integer :: i, side
    D = X(:, FIBRE(2, :)) - X(:, FIBRE(1, :))
    change = u(:, FIBRE(2, :)) - u(:, FIBRE(1, :))
    length = norm2(D, 1)
    do i = 1, 8
      strain(i) = dot_product(D(:, i), change(:, i)) / length(i)**2
      if (is_nlgeom) strain(i) = strain(i) + 0.5_DP * dot_product(change(:, i), change(:, i)) / length(i)**2
      slope(:, i) = D(:, i) / length(i)**2
      if (is_nlgeom) slope(:, i) = slope(:, i) + change(:, i) / length(i)**2
    end do
    n = sum(D, dim=2) / norm2(sum(D, dim=2))
    fibre_strain = [n**2, 2 * n * n([2, 3, 1])]    ! xx yy zz xy yz xz
    k = THICKNESS_FACTOR * dot_product(fibre_strain, matmul(c, fibre_strain)) * volume / 4.0_DP
    energy = 0
    do side = 1, 4
      weight = 0
      weight([side, 1 + mod(side, 4), 4 + side]) = [-0.5_DP, -0.5_DP, 1.0_DP]
      g = dot_product(weight, strain)
      energy = energy + 0.5_DP * k * g**2
      do i = 1, 8
        force(:, FIBRE(1, i)) = force(:, FIBRE(1, i)) - k * g * weight(i) * slope(:, i)
        force(:, FIBRE(2, i)) = force(:, FIBRE(2, i)) + k * g * weight(i) * slope(:, i)
      end do
      if (present(stiffness)) call add_fibre_stiffness(k, merge(k * g, 0.0_DP, is_nlgeom) * weight / length**2, &
        spread(weight, 1, 3) * slope, stiffness)
    end do
  end subroutine add_thickness_stabilization


  !> k dg dg' + k g d2g of one side, to both sides of the diagonal.
  pure subroutine add_fibre_stiffness(k, geometric, slope, stiffness)
    real(DP), intent(in) :: k                      !< [energy]
    real(DP), intent(in) :: geometric(8)           !< k g times the second derivative of g by the fibres [force/length]
    real(DP), intent(in) :: slope(3, 8)            !< of g by the fibres [1/length]
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: gradient(48)                       ! the middles of the corner fibres, 49 to 60, take no part
    integer :: i, j, row, column
    do i = 1, 8
      do j = 1, 3
        gradient(3 * FIBRE(1, i) - 3 + j) = -slope(j, i)
        gradient(3 * FIBRE(2, i) - 3 + j) = slope(j, i)
      end do
    end do
    do column = 1, 48
      stiffness(:48, column) = stiffness(:48, column) + k * (gradient * gradient(column))
    end do
    do i = 1, 8
      do j = 1, 3
        row = 3 * FIBRE(1, i) - 3 + j
        column = 3 * FIBRE(2, i) - 3 + j
        stiffness(row, row) = stiffness(row, row) + geometric(i)
        stiffness(column, column) = stiffness(column, column) + geometric(i)
        stiffness(row, column) = stiffness(row, column) - geometric(i)
        stiffness(column, row) = stiffness(column, row) - geometric(i)
      end do
    end do
  end subroutine add_fibre_stiffness

end module amontons_hourglass
