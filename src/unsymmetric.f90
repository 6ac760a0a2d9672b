!> Unsymmetric: what an unsymmetric tangent of a material gives an element beside the symmetric stiffness.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The kernels of the elements take the symmetric part of the tangent c of a point. The rest, w = (c - c')/2, is linear in the
!! stiffness: W = sum of V B' w B over the points, B the strains of the displacements, with the mean dilatation and the mean
!! gradients of the kinds that have them; c is that of the Kirchhoff stress, so V are the volumes at rest and B has the current
!! gradients. W' = -W. Left out are C3D8I, whose modes would have to be condensed with W, and trusses, whose w is zero.
!! Theory: doc/theory/elements.md for B, doc/theory/solver.md for what is done with W.
module amontons_unsymmetric
  use amontons_kinds, only: DP, PI
  use amontons_shapes, only: shape_functions, quadrature
  use amontons_tensor, only: IDENTITY, invert
  use amontons_topology, only: element_kind, kind_type, KIND_C3D8R, KIND_C3D8_FULL, KIND_C3D8I, KIND_CPS4R, KIND_CPE4R, &
    KIND_CAX4R, KIND_CPE4_FULL, FAMILY_SOLID, FAMILY_AXISYMMETRIC, FAMILY_PLANE_STRAIN, FAMILY_PLANE_STRESS, MAX_NODES, &
    MAX_POINTS
  implicit none
  private
  public :: element_skew

  !> The points of an element at rest.
  type :: rest_type
    integer :: n = 0                               !< nodes
    integer :: m = 0                               !< points
    real(DP) :: gradient(3, MAX_NODES, MAX_POINTS) = 0   !< dN_a/dX [1/length]
    real(DP) :: hoop(MAX_NODES, MAX_POINTS) = 0    !< N_a/X; 0 but around an axis [1/length]
    real(DP) :: volume(MAX_POINTS) = 0             !< [length^3]
  end type rest_type

contains

  !> W of an element.
  pure subroutine element_skew(kind, X, u, is_nlgeom, section, w, stiffness)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(in) :: X(:, :), u(:, :)       !< (3, nodes) [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: section                !< thickness [length]
    real(DP), intent(in) :: w(:, :, :)             !< (6, 6, points), engineering shears [stress]
    real(DP), intent(out) :: stiffness(3 * MAX_NODES, 3 * MAX_NODES)   !< set up to 3 * nodes [force/length]
    type(kind_type) :: entry
    type(rest_type) :: rest
    real(DP) :: B(6, 3 * MAX_NODES, MAX_POINTS), current(MAX_POINTS)
    integer :: p, k
    entry = element_kind(kind)
    k = 3 * entry%n_nodes
    stiffness(:k, :k) = 0
    if (kind == KIND_C3D8I .or. .not. any(entry%family == [FAMILY_SOLID, FAMILY_PLANE_STRAIN, FAMILY_PLANE_STRESS, &
      FAMILY_AXISYMMETRIC])) return
    call find_rest(kind, entry, X, section, rest)
    do p = 1, rest%m
      call strains_of(entry, rest, p, u, is_nlgeom, B(:, :, p), current(p))
    end do
    if (entry%is_mean_dilatation) call take_mean_dilatation(rest, current, B)
    do p = 1, rest%m
      stiffness(:k, :k) = stiffness(:k, :k) + rest%volume(p) * matmul(transpose(B(:, :k, p)), matmul(w(:, :, p), B(:, :k, p)))
    end do
  end subroutine element_skew


  !> Gradients and volumes at rest; kinds of one point take their mean over the element.
  pure subroutine find_rest(kind, entry, X, section, rest)
    integer, intent(in) :: kind
    type(kind_type), intent(in) :: entry
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) [length]
    real(DP), intent(in) :: section                !< [length]
    type(rest_type), intent(out) :: rest
    real(DP) :: xi(3, MAX_POINTS), weight(MAX_POINTS), N(MAX_NODES), dN(3, MAX_NODES), J(3, 3), inverse(3, 3), det, radius
    integer :: rule, p, d
    d = merge(3, 2, entry%family == FAMILY_SOLID)
    rule = kind
    if (kind == KIND_C3D8R) rule = KIND_C3D8_FULL
    if (any(kind == [KIND_CPS4R, KIND_CPE4R, KIND_CAX4R])) rule = KIND_CPE4_FULL
    rest%n = entry%n_nodes
    call quadrature(rule, rest%m, xi, weight)
    do p = 1, rest%m
      call shape_functions(rule, xi(:, p), N, dN)
      J = IDENTITY
      J(:d, :d) = matmul(X(:d, :rest%n), transpose(dN(:d, :rest%n)))
      call invert(J, inverse, det)
      rest%gradient(:d, :rest%n, p) = matmul(transpose(inverse(:d, :d)), dN(:d, :rest%n))
      rest%volume(p) = weight(p) * det
      if (entry%family == FAMILY_AXISYMMETRIC) then
        radius = dot_product(N(:rest%n), X(1, :rest%n))
        rest%volume(p) = rest%volume(p) * 2 * PI * radius
        rest%hoop(:rest%n, p) = N(:rest%n) / radius
      else if (d == 2) then
        rest%volume(p) = rest%volume(p) * section
      end if
    end do
    if (rule /= kind) call take_mean(rest)
  end subroutine find_rest


  !> Puts the mean over all points into the first and only one.
  pure subroutine take_mean(rest)
    type(rest_type), intent(inout) :: rest
    real(DP) :: share(rest%m), gradient(3, MAX_NODES), hoop(MAX_NODES)
    integer :: p
    share = rest%volume(:rest%m) / sum(rest%volume(:rest%m))
    gradient = 0
    hoop = 0
    do p = 1, rest%m
      gradient = gradient + share(p) * rest%gradient(:, :, p)
      hoop = hoop + share(p) * rest%hoop(:, p)
    end do
    rest%volume(1) = sum(rest%volume(:rest%m))
    rest%gradient(:, :, 1) = gradient
    rest%hoop(:, 1) = hoop
    rest%m = 1
  end subroutine take_mean


  !> B of a point, rows xx yy zz xy yz xz with engineering shears, by the current gradients under NLGEOM; its current volume.
  pure subroutine strains_of(entry, rest, p, u, is_nlgeom, B, current)
    type(kind_type), intent(in) :: entry
    type(rest_type), intent(in) :: rest
    integer, intent(in) :: p                       !< point
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: B(6, 3 * MAX_NODES)   !< [1/length]
    real(DP), intent(out) :: current               !< [length^3]
    real(DP) :: F(3, 3), inverse(3, 3), det, g(3), hoop
    integer :: a
    inverse = IDENTITY
    current = rest%volume(p)
    hoop = 1
    if (is_nlgeom) then
      F = IDENTITY + matmul(u(:, :rest%n), transpose(rest%gradient(:, :rest%n, p)))
      if (entry%family == FAMILY_AXISYMMETRIC) F(3, 3) = 1 + dot_product(u(1, :rest%n), rest%hoop(:rest%n, p))
      hoop = F(3, 3)
      call invert(F, inverse, det)
      current = det * current
    end if
    B = 0
    do a = 1, rest%n
      g = matmul(rest%gradient(:, a, p), inverse)
      B(:, 3 * a - 2) = [g(1), 0.0_DP, rest%hoop(a, p) / hoop, g(2), 0.0_DP, g(3)]
      B(:, 3 * a - 1) = [0.0_DP, g(2), 0.0_DP, g(1), g(3), 0.0_DP]
      B(:, 3 * a) = [0.0_DP, 0.0_DP, g(3), 0.0_DP, g(2), g(1)]
    end do
  end subroutine strains_of


  !> Replaces the change of volume of each point by its mean over the current volume.
  pure subroutine take_mean_dilatation(rest, current, B)
    type(rest_type), intent(in) :: rest
    real(DP), intent(in) :: current(:)             !< (points) [length^3]
    real(DP), intent(inout) :: B(:, :, :)          !< (6, 3 nodes, points) [1/length]
    real(DP) :: mean(size(B, 2)), change(size(B, 2))
    integer :: p, i
    mean = 0
    do p = 1, rest%m
      mean = mean + current(p) / sum(current(:rest%m)) * (B(1, :, p) + B(2, :, p) + B(3, :, p))
    end do
    do p = 1, rest%m
      change = (mean - (B(1, :, p) + B(2, :, p) + B(3, :, p))) / 3
      do i = 1, 3
        B(i, :, p) = B(i, :, p) + change
      end do
    end do
  end subroutine take_mean_dilatation

end module amontons_unsymmetric
