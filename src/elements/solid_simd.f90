!> Vectorized (SIMD) evaluation of eight solid elements of one kind at a time: forces, tangent and point values.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Linear isotropic elasticity only. Results agree with `element` for the kinds whose displacements are those of their nodes alone
!! (small displacements, and Saint Venant's law under NLGEOM) and for C3D8 with mean dilatation (small displacements). The first
!! index of every array is the element: each statement is a vector instruction. With g_a the gradient of a shape function, F the
!! deformation gradient, S the second Piola-Kirchhoff stress, q_a = F g_a and b = F F', Hooke's law gives (doc/theory/elements.md,
!! "Batches")
!!
!!     force_a = sum of w F S g_a
!!     K_ab    = sum of w (g_a . S g_b 1 + lambda q_a q_b' + G q_b q_a' + G (g_a . g_b) b)
!!
!! Mean dilatation: lambda becomes -2/3 G at the points, and the bulk modulus k acts on the mean gradients gm_a: + k V gm_a gm_b'.
module amontons_solid_simd
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, LAW_SAINT_VENANT, HISTORY_INELASTIC
  use amontons_shape_functions, only: shape_functions, quadrature
  use amontons_elasticity, only: lame_constants, MAX_DISPLACEMENT_GRADIENT
  use amontons_element_kinds, only: element_kind_type, element_kind, KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, KIND_C3D10, &
    KIND_C3D15, KIND_C3D15_LAYER, KIND_C3D20, N_SOLID_KINDS, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  implicit none
  private
  public :: batch_type, batch_rule_type, create_batch_rules, is_batch_kind, is_plain_kind, n_node_pairs, set_batch_lane, &
    evaluate_batch_forces, evaluate_batch_tangent, BATCH_WIDTH, MAX_NODE_PAIRS, BATCH_HISTORY
  public :: batch_point_type, evaluate_batch_point, adjugate, deformation_gradient, evaluate_green_strain, unpack_batch_voigt

  integer, parameter :: BATCH_WIDTH = 8                  !< elements of a batch
  integer, parameter :: N = MAX_ELEMENT_NODES            !< most nodes of an element
  integer, parameter :: N_POINTS = 27                     !< most points of these kinds, of C3D20
  integer, parameter :: MAX_NODE_PAIRS = N * (N + 1) / 2 !< pairs of nodes a <= b, those of b = 1 first
  integer, parameter :: BATCH_HISTORY = HISTORY_INELASTIC + 5   !< history variables of plasticity with isotropic hardening

  !> Kinds without modes, hourglass stiffness or mean dilatation. C3D20R is none of them: a strip of it may have modes without
  !! energy, whose pivots are rounding, and another order of summation changes their sign (S8R in trapezoids).
  integer, parameter :: PLAIN_KINDS(7) = [KIND_C3D4, KIND_C3D6, KIND_C3D8_FULL, KIND_C3D10, KIND_C3D15, &
    KIND_C3D15_LAYER, KIND_C3D20]

  !> An element kind: derivatives of the shape functions at the points, and the weights of these.
  type :: batch_rule_type
    integer :: n_nodes = 0, n_points = 0
    logical :: is_mean = .false.                   !< mean dilatation
    real(DP) :: dN(3, N, N_POINTS)                 !< of node a at point p by xi [-]
    real(DP) :: w(N_POINTS)                        !< [-]
  end type batch_rule_type

  !> Eight elements. Unused lanes hold a copy of another element.
  type :: batch_type
    real(DP) :: X(BATCH_WIDTH, 3, N)                     !< reference coordinates [length]
    real(DP) :: u(BATCH_WIDTH, 3, N)                     !< displacements [length]
    real(DP) :: lambda(BATCH_WIDTH), G(BATCH_WIDTH)            !< Lame's constants [stress]
    logical :: is_sound                            !< .false.: an element is inverted or not finite: the output below is invalid
    real(DP) :: force(BATCH_WIDTH, 3, N)                 !< [force]
    real(DP) :: stiffness(BATCH_WIDTH, 3, 3, MAX_NODE_PAIRS)    !< block of each pair [force/length]
    real(DP) :: stress(BATCH_WIDTH, 6, N_POINTS)         !< Cauchy's [stress]
    real(DP) :: strain(BATCH_WIDTH, 6, N_POINTS)         !< small, or Green's; tensor components [-]
    real(DP) :: energy(BATCH_WIDTH, N_POINTS)            !< per reference volume [stress]
    real(DP) :: volume(BATCH_WIDTH, N_POINTS)            !< reference volumes of the points [length^3]
    real(DP) :: history_old(BATCH_WIDTH, BATCH_HISTORY, N_POINTS)   !< committed history; of plastic materials only
    real(DP) :: history(BATCH_WIDTH, BATCH_HISTORY, N_POINTS)   !< at the end of the increment; likewise
  end type batch_type

  !> What has been found at one point of the eight elements.
  type :: batch_point_type
    real(DP) :: g(BATCH_WIDTH, 3, N)                     !< gradients [1/length]
    real(DP) :: w(BATCH_WIDTH)                           !< volumes [length^3]
    real(DP) :: H(BATCH_WIDTH, 3, 3)                     !< du_i/dX_j [-]
  end type batch_point_type

contains

  !> The rules of the supported kinds; the others have no nodes.
  pure function create_batch_rules() result(rules)
    type(batch_rule_type) :: rules(N_SOLID_KINDS)
    integer :: kind
    do kind = 1, N_SOLID_KINDS
      if (is_plain_kind(kind) .or. kind == KIND_C3D8) call set_batch_rule(kind, rules(kind))
    end do
  end function create_batch_rules


  !> The rule of one kind.
  pure subroutine set_batch_rule(kind, rule)
    integer, intent(in) :: kind                    !< KIND_...
    type(batch_rule_type), intent(out) :: rule
    type(element_kind_type) :: entry
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), shape(MAX_ELEMENT_NODES)
    integer :: p
    entry = element_kind(kind)
    rule%n_nodes = entry%n_nodes
    rule%is_mean = entry%is_mean_dilatation
    call quadrature(kind, rule%n_points, xi, w)
    rule%w = w(:N_POINTS)
    do p = 1, rule%n_points
      call shape_functions(kind, xi(:, p), shape, rule%dN(:, :, p))
    end do
  end subroutine set_batch_rule


  !> Whether the displacements of a kind are those of its nodes alone.
  pure logical function is_plain_kind(kind)
    integer, intent(in) :: kind                    !< KIND_...
    is_plain_kind = any(kind == PLAIN_KINDS)
  end function is_plain_kind


  !> Whether this module supports an element.
  elemental logical function is_batch_kind(kind, material, is_nlgeom)
    integer, intent(in) :: kind                    !< KIND_...
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    is_batch_kind = is_plain_kind(kind) .and. (.not. is_nlgeom .or. material%law == LAW_SAINT_VENANT)
    is_batch_kind = (is_batch_kind .or. (kind == KIND_C3D8 .and. .not. is_nlgeom)) .and. material%is_linear_isotropic
  end function is_batch_kind


  !> Puts an element into a lane.
  pure subroutine set_batch_lane(batch, lane, material, X, u)
    type(batch_type), intent(inout) :: batch
    integer, intent(in) :: lane
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :), u(:, :)       !< (3, n_nodes) [length]
    batch%X(lane, :, :size(X, 2)) = X
    batch%u(lane, :, :size(u, 2)) = u
    call lame_constants(material%youngs_modulus, material%poissons_ratio, batch%lambda(lane), batch%G(lane))
  end subroutine set_batch_lane


  !> Forces and point values.
  pure subroutine evaluate_batch_forces(batch, rule, is_nlgeom)
    type(batch_type), intent(inout) :: batch
    type(batch_rule_type), intent(in) :: rule
    logical, intent(in) :: is_nlgeom               !< not with mean dilatation
    type(batch_point_type) :: point
    real(DP) :: P(BATCH_WIDTH, 3, 3), mean(BATCH_WIDTH, 3, N), lambda(BATCH_WIDTH), pressure(BATCH_WIDTH), divergence(BATCH_WIDTH)
    integer :: k, a, i, v
    batch%is_sound = all(ieee_is_finite(batch%u(:, :, :rule%n_nodes)))
    if (.not. batch%is_sound) return
    batch%force(:, :, :rule%n_nodes) = 0
    lambda = batch%lambda
    if (rule%is_mean) then
      lambda = -2 * batch%G / 3
      call evaluate_mean_gradients(batch, rule, mean, divergence)
      pressure = (batch%lambda - lambda) * divergence
    end if
    do k = 1, rule%n_points
      call evaluate_batch_point(batch, rule, k, is_nlgeom, point)
      if (.not. batch%is_sound) return
      if (is_nlgeom) then
        call evaluate_green_stress(batch, k, point, P)
      else
        if (.not. rule%is_mean) divergence = point%H(:, 1, 1) + point%H(:, 2, 2) + point%H(:, 3, 3)
        call evaluate_small_stress(batch, k, point, divergence, P)
        if (rule%is_mean) call subtract_mean_pressure(pressure, P)
      end if
      do a = 1, rule%n_nodes
        do i = 1, 3
          !$omp simd
          do v = 1, BATCH_WIDTH
            batch%force(v, i, a) = batch%force(v, i, a) + point%w(v) * (P(v, i, 1) * point%g(v, 1, a) &
              + P(v, i, 2) * point%g(v, 2, a) + P(v, i, 3) * point%g(v, 3, a))
          end do
        end do
      end do
    end do
    if (.not. rule%is_mean) return
    do a = 1, rule%n_nodes
      do i = 1, 3
        batch%force(:, i, a) = batch%force(:, i, a) + pressure * mean(:, i, a)
      end do
    end do
  end subroutine evaluate_batch_forces


  !> Removes the part of the mean dilatation from the stress of a point: it acts on the mean gradients.
  pure subroutine subtract_mean_pressure(pressure, P)
    real(DP), intent(in) :: pressure(BATCH_WIDTH)        !< [stress]
    real(DP), intent(inout) :: P(BATCH_WIDTH, 3, 3)      !< [stress]
    integer :: i
    do i = 1, 3
      P(:, i, i) = P(:, i, i) - pressure
    end do
  end subroutine subtract_mean_pressure


  !> The tangent.
  pure subroutine evaluate_batch_tangent(batch, rule, is_nlgeom)
    type(batch_type), intent(inout) :: batch
    type(batch_rule_type), intent(in) :: rule
    logical, intent(in) :: is_nlgeom               !< not with mean dilatation
    type(batch_point_type) :: point
    real(DP) :: mean(BATCH_WIDTH, 3, N), lambda(BATCH_WIDTH), divergence(BATCH_WIDTH), volume(BATCH_WIDTH)
    integer :: k
    batch%is_sound = all(ieee_is_finite(batch%u(:, :, :rule%n_nodes)))
    if (.not. batch%is_sound) return
    batch%stiffness(:, :, :, :n_node_pairs(rule%n_nodes)) = 0
    lambda = batch%lambda
    if (rule%is_mean) lambda = -2 * batch%G / 3
    volume = 0
    do k = 1, rule%n_points
      call evaluate_batch_point(batch, rule, k, is_nlgeom, point)
      if (.not. batch%is_sound) return
      volume = volume + point%w
      call add_point_stiffness(batch, rule%n_nodes, lambda, is_nlgeom, point)
    end do
    if (.not. rule%is_mean) return
    call evaluate_mean_gradients(batch, rule, mean, divergence)
    call add_mean_dilatation_stiffness(rule%n_nodes, mean, (batch%lambda - lambda) / volume, batch%stiffness)
  end subroutine evaluate_batch_tangent


  !> Gradients, volumes and displacement gradients of one point. Displacements are relative to node 1: a translation gives zero.
  pure subroutine evaluate_batch_point(batch, rule, k, is_nlgeom, point)
    type(batch_type), intent(inout) :: batch       !< volume of the point and is_sound are set
    type(batch_rule_type), intent(in) :: rule
    integer, intent(in) :: k                       !< point
    logical, intent(in) :: is_nlgeom
    type(batch_point_type), intent(out) :: point
    real(DP) :: J(BATCH_WIDTH, 3, 3), c(BATCH_WIDTH, 3, 3), det(BATCH_WIDTH)
    integer :: a, i, m
    J = 0
    do a = 2, rule%n_nodes
      do m = 1, 3
        do i = 1, 3
          J(:, i, m) = J(:, i, m) + (batch%X(:, i, a) - batch%X(:, i, 1)) * rule%dN(m, a, k)
        end do
      end do
    end do
    call adjugate(J, c, det)
    batch%is_sound = all(det > 0)
    if (.not. batch%is_sound) return
    point%w = rule%w(k) * det
    batch%volume(:, k) = point%w
    do a = 1, rule%n_nodes
      do i = 1, 3
        point%g(:, i, a) = (rule%dN(1, a, k) * c(:, 1, i) + rule%dN(2, a, k) * c(:, 2, i) + rule%dN(3, a, k) * c(:, 3, i)) / det
      end do
    end do
    point%H = 0
    do a = 2, rule%n_nodes
      do m = 1, 3
        do i = 1, 3
          point%H(:, i, m) = point%H(:, i, m) + (batch%u(:, i, a) - batch%u(:, i, 1)) * point%g(:, m, a)
        end do
      end do
    end do
    batch%is_sound = all(abs(point%H) <= MAX_DISPLACEMENT_GRADIENT)
    if (is_nlgeom) batch%is_sound = batch%is_sound .and. all(batch_determinant(point%H) > 0)
  end subroutine evaluate_batch_point


  !> Pairs of nodes a <= b.
  pure integer function n_node_pairs(n_nodes)
    integer, intent(in) :: n_nodes
    n_node_pairs = n_nodes * (n_nodes + 1) / 2
  end function n_node_pairs


  !> Adjugate (the inverse times the determinant) and determinant.
  pure subroutine adjugate(A, c, det)
    real(DP), intent(in) :: A(BATCH_WIDTH, 3, 3)
    real(DP), intent(out) :: c(BATCH_WIDTH, 3, 3), det(BATCH_WIDTH)
    integer :: i, j
    integer, parameter :: NEXT_DIRECTION(3) = [2, 3, 1], PREVIOUS_DIRECTION(3) = [3, 1, 2]
    do j = 1, 3
      do i = 1, 3
        c(:, i, j) = A(:, NEXT_DIRECTION(j), NEXT_DIRECTION(i)) * A(:, PREVIOUS_DIRECTION(j), PREVIOUS_DIRECTION(i)) - A(:, &
          NEXT_DIRECTION(j), PREVIOUS_DIRECTION(i)) * A(:, PREVIOUS_DIRECTION(j), NEXT_DIRECTION(i))
      end do
    end do
    det = A(:, 1, 1) * c(:, 1, 1) + A(:, 1, 2) * c(:, 2, 1) + A(:, 1, 3) * c(:, 3, 1)
  end subroutine adjugate


  !> det(1 + H).
  pure function batch_determinant(H) result(det)
    real(DP), intent(in) :: H(BATCH_WIDTH, 3, 3)
    real(DP) :: det(BATCH_WIDTH), F(BATCH_WIDTH, 3, 3), c(BATCH_WIDTH, 3, 3)
    F = deformation_gradient(H)
    call adjugate(F, c, det)
  end function batch_determinant


  !> F = 1 + H.
  pure function deformation_gradient(H) result(F)
    real(DP), intent(in) :: H(BATCH_WIDTH, 3, 3)
    real(DP) :: F(BATCH_WIDTH, 3, 3)
    integer :: i
    F = H
    do i = 1, 3
      F(:, i, i) = F(:, i, i) + 1
    end do
  end function deformation_gradient


  !> Volume times mean gradients, and the mean of div u, over the reference volume.
  pure subroutine evaluate_mean_gradients(batch, rule, mean, divergence)
    type(batch_type), intent(inout) :: batch
    type(batch_rule_type), intent(in) :: rule
    real(DP), intent(out) :: mean(BATCH_WIDTH, 3, N)     !< [length^2]
    real(DP), intent(out) :: divergence(BATCH_WIDTH)     !< [-]
    type(batch_point_type) :: point
    real(DP) :: volume(BATCH_WIDTH)
    integer :: k, a, i
    mean(:, :, :rule%n_nodes) = 0
    volume = 0
    divergence = 0
    do k = 1, rule%n_points
      call evaluate_batch_point(batch, rule, k, .false., point)
      if (.not. batch%is_sound) return
      volume = volume + point%w
      divergence = divergence + point%w * (point%H(:, 1, 1) + point%H(:, 2, 2) + point%H(:, 3, 3))
      do a = 1, rule%n_nodes
        do i = 1, 3
          mean(:, i, a) = mean(:, i, a) + point%w * point%g(:, i, a)
        end do
      end do
    end do
    divergence = divergence / volume
  end subroutine evaluate_mean_gradients


  !> Small displacements: strain with its dilatation replaced by the one given, stress, energy.
  pure subroutine evaluate_small_stress(batch, k, point, divergence, P)
    type(batch_type), intent(inout) :: batch
    integer, intent(in) :: k
    type(batch_point_type), intent(in) :: point
    real(DP), intent(in) :: divergence(BATCH_WIDTH)      !< [-]
    real(DP), intent(out) :: P(BATCH_WIDTH, 3, 3)        !< [stress]
    real(DP) :: dilatation_change(BATCH_WIDTH), e(BATCH_WIDTH, 6)
    integer :: i
    associate (H => point%H)
      dilatation_change = (divergence - (H(:, 1, 1) + H(:, 2, 2) + H(:, 3, 3))) / 3
      do i = 1, 3
        e(:, i) = H(:, i, i) + dilatation_change
      end do
      e(:, 4) = 0.5_DP * (H(:, 1, 2) + H(:, 2, 1))
      e(:, 5) = 0.5_DP * (H(:, 2, 3) + H(:, 3, 2))
      e(:, 6) = 0.5_DP * (H(:, 1, 3) + H(:, 3, 1))
    end associate
    batch%strain(:, :, k) = e
    call evaluate_hooke_stress(batch, e, batch%stress(:, :, k), batch%energy(:, k))
    call unpack_batch_voigt(batch%stress(:, :, k), P)
  end subroutine evaluate_small_stress


  !> Finite displacements, Saint-Venant's law: Green's strain, Cauchy's stress, and P = F S.
  pure subroutine evaluate_green_stress(batch, k, point, P)
    type(batch_type), intent(inout) :: batch
    integer, intent(in) :: k
    type(batch_point_type), intent(in) :: point
    real(DP), intent(out) :: P(BATCH_WIDTH, 3, 3)        !< [stress]
    real(DP) :: e(BATCH_WIDTH, 6), s(BATCH_WIDTH, 6), full(BATCH_WIDTH, 3, 3), F(BATCH_WIDTH, 3, 3), det(BATCH_WIDTH)
    integer :: i, j
    integer, parameter :: VOIGT_ROW(6) = [1, 2, 3, 1, 2, 1], VOIGT_COLUMN(6) = [1, 2, 3, 2, 3, 3]
    call evaluate_green_strain(point%H, e)
    batch%strain(:, :, k) = e
    call evaluate_hooke_stress(batch, e, s, batch%energy(:, k))
    call unpack_batch_voigt(s, full)
    F = deformation_gradient(point%H)
    do j = 1, 3
      do i = 1, 3
        P(:, i, j) = F(:, i, 1) * full(:, 1, j) + F(:, i, 2) * full(:, 2, j) + F(:, i, 3) * full(:, 3, j)
      end do
    end do
    det = batch_determinant(point%H)
    do j = 1, 6
      batch%stress(:, j, k) = (P(:, VOIGT_ROW(j), 1) * F(:, VOIGT_COLUMN(j), 1) + P(:, VOIGT_ROW(j), 2) * F(:, VOIGT_COLUMN(j), 2) &
        + P(:, VOIGT_ROW(j), 3) * F(:, VOIGT_COLUMN(j), 3)) / det
    end do
  end subroutine evaluate_green_stress


  !> Green's strain without cancellation: the symmetric part of H, and half of H'H.
  pure subroutine evaluate_green_strain(H, e)
    real(DP), intent(in) :: H(BATCH_WIDTH, 3, 3)
    real(DP), intent(out) :: e(BATCH_WIDTH, 6)
    integer :: k, i, j
    integer, parameter :: VOIGT_ROW(6) = [1, 2, 3, 1, 2, 1], VOIGT_COLUMN(6) = [1, 2, 3, 2, 3, 3]
    do k = 1, 6
      i = VOIGT_ROW(k)
      j = VOIGT_COLUMN(k)
      e(:, k) = 0.5_DP * (H(:, i, j) + H(:, j, i) + H(:, 1, i) * H(:, 1, j) + H(:, 2, i) * H(:, 2, j) + H(:, 3, i) * H(:, 3, j))
    end do
  end subroutine evaluate_green_strain


  !> lambda tr(e) 1 + 2 G e, and the energy.
  pure subroutine evaluate_hooke_stress(batch, e, s, energy)
    type(batch_type), intent(in) :: batch
    real(DP), intent(in) :: e(BATCH_WIDTH, 6)
    real(DP), intent(out) :: s(BATCH_WIDTH, 6)           !< [stress]
    real(DP), intent(out) :: energy(BATCH_WIDTH)         !< [stress]
    real(DP) :: part(BATCH_WIDTH)
    integer :: i
    part = batch%lambda * (e(:, 1) + e(:, 2) + e(:, 3))
    do i = 1, 6
      s(:, i) = 2 * batch%G * e(:, i)
      if (i <= 3) s(:, i) = s(:, i) + part
    end do
    energy = 0.5_DP * (s(:, 1) * e(:, 1) + s(:, 2) * e(:, 2) + s(:, 3) * e(:, 3)) &
      + s(:, 4) * e(:, 4) + s(:, 5) * e(:, 5) + s(:, 6) * e(:, 6)
  end subroutine evaluate_hooke_stress


  !> xx yy zz xy yz xz as a matrix.
  pure subroutine unpack_batch_voigt(s, full)
    real(DP), intent(in) :: s(BATCH_WIDTH, 6)
    real(DP), intent(out) :: full(BATCH_WIDTH, 3, 3)
    integer :: i, j
    integer, parameter :: VOIGT_INDEX(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3])
    do j = 1, 3
      do i = 1, 3
        full(:, i, j) = s(:, VOIGT_INDEX(i, j))
      end do
    end do
  end subroutine unpack_batch_voigt


  !> What a point adds to the blocks of all pairs.
  pure subroutine add_point_stiffness(batch, n_nodes, lambda, is_nlgeom, point)
    type(batch_type), intent(inout) :: batch
    integer, intent(in) :: n_nodes
    real(DP), intent(in) :: lambda(BATCH_WIDTH)          !< [stress]
    logical, intent(in) :: is_nlgeom
    type(batch_point_type), intent(in) :: point
    real(DP), dimension(BATCH_WIDTH, 3, N) :: q, lambda_q, G_q, t
    real(DP), dimension(BATCH_WIDTH, 3, 3) :: F, b, full
    real(DP) :: s(BATCH_WIDTH, 6), e(BATCH_WIDTH, 6), energy(BATCH_WIDTH)
    integer :: a, i, j
    if (is_nlgeom) then
      F = deformation_gradient(point%H)
      call evaluate_green_strain(point%H, e)
      call evaluate_hooke_stress(batch, e, s, energy)
      call unpack_batch_voigt(s, full)
    else
      F = deformation_gradient(0 * point%H)
      full = 0
    end if
    do j = 1, 3
      do i = 1, 3
        b(:, i, j) = F(:, i, 1) * F(:, j, 1) + F(:, i, 2) * F(:, j, 2) + F(:, i, 3) * F(:, j, 3)
        full(:, i, j) = point%w * full(:, i, j)
      end do
    end do
    do a = 1, n_nodes
      do i = 1, 3
        q(:, i, a) = F(:, i, 1) * point%g(:, 1, a) + F(:, i, 2) * point%g(:, 2, a) + F(:, i, 3) * point%g(:, 3, a)
        t(:, i, a) = full(:, i, 1) * point%g(:, 1, a) + full(:, i, 2) * point%g(:, 2, a) + full(:, i, 3) * point%g(:, 3, a)
        lambda_q(:, i, a) = point%w * lambda * q(:, i, a)
        G_q(:, i, a) = point%w * batch%G * q(:, i, a)
      end do
    end do
    call add_pair_blocks(n_nodes, point%g, q, lambda_q, G_q, t, b, point%w * batch%G, batch%stiffness)
  end subroutine add_point_stiffness


  !> The innermost loops of the tangent: K_ab = K_ab + (g_a . t_b) 1 + l_a q_b' + q_b m_a' + G (g_a . g_b) b, l = lambda q, m = G q.
  pure subroutine add_pair_blocks(n_nodes, g, q, l, m, t, b, G_w, stiffness)
    integer, intent(in) :: n_nodes
    real(DP), dimension(BATCH_WIDTH, 3, N), intent(in) :: g, q, l, m, t
    real(DP), intent(in) :: b(BATCH_WIDTH, 3, 3), G_w(BATCH_WIDTH)
    real(DP), intent(inout) :: stiffness(BATCH_WIDTH, 3, 3, MAX_NODE_PAIRS)
    real(DP) :: geometric, shear
    integer :: k, i, j, v
    k = 0
    do j = 1, n_nodes
      do i = 1, j
        k = k + 1
        associate (block => stiffness(:, :, :, k))
          !$omp simd private(geometric, shear)
          do v = 1, BATCH_WIDTH
            geometric = g(v, 1, i) * t(v, 1, j) + g(v, 2, i) * t(v, 2, j) + g(v, 3, i) * t(v, 3, j)
            shear = G_w(v) * (g(v, 1, i) * g(v, 1, j) + g(v, 2, i) * g(v, 2, j) + g(v, 3, i) * g(v, 3, j))
            block(v, 1, 1) = block(v, 1, 1) + l(v, 1, i) * q(v, 1, j) + q(v, 1, j) * m(v, 1, i) + shear * b(v, 1, 1) + geometric
            block(v, 2, 1) = block(v, 2, 1) + l(v, 2, i) * q(v, 1, j) + q(v, 2, j) * m(v, 1, i) + shear * b(v, 2, 1)
            block(v, 3, 1) = block(v, 3, 1) + l(v, 3, i) * q(v, 1, j) + q(v, 3, j) * m(v, 1, i) + shear * b(v, 3, 1)
            block(v, 1, 2) = block(v, 1, 2) + l(v, 1, i) * q(v, 2, j) + q(v, 1, j) * m(v, 2, i) + shear * b(v, 1, 2)
            block(v, 2, 2) = block(v, 2, 2) + l(v, 2, i) * q(v, 2, j) + q(v, 2, j) * m(v, 2, i) + shear * b(v, 2, 2) + geometric
            block(v, 3, 2) = block(v, 3, 2) + l(v, 3, i) * q(v, 2, j) + q(v, 3, j) * m(v, 2, i) + shear * b(v, 3, 2)
            block(v, 1, 3) = block(v, 1, 3) + l(v, 1, i) * q(v, 3, j) + q(v, 1, j) * m(v, 3, i) + shear * b(v, 1, 3)
            block(v, 2, 3) = block(v, 2, 3) + l(v, 2, i) * q(v, 3, j) + q(v, 2, j) * m(v, 3, i) + shear * b(v, 2, 3)
            block(v, 3, 3) = block(v, 3, 3) + l(v, 3, i) * q(v, 3, j) + q(v, 3, j) * m(v, 3, i) + shear * b(v, 3, 3) + geometric
          end do
        end associate
      end do
    end do
  end subroutine add_pair_blocks


  !> The part of the mean dilatation: k gm_a gm_b', with gm the mean gradients times the volume and k over the volume.
  pure subroutine add_mean_dilatation_stiffness(n_nodes, mean, k, stiffness)
    integer, intent(in) :: n_nodes
    real(DP), intent(in) :: mean(BATCH_WIDTH, 3, N)      !< [length^2]
    real(DP), intent(in) :: k(BATCH_WIDTH)               !< [stress/length^3]
    real(DP), intent(inout) :: stiffness(BATCH_WIDTH, 3, 3, MAX_NODE_PAIRS)
    integer :: pair, a, b, i, j
    pair = 0
    do b = 1, n_nodes
      do a = 1, b
        pair = pair + 1
        do j = 1, 3
          do i = 1, 3
            stiffness(:, i, j, pair) = stiffness(:, i, j, pair) + k * mean(:, i, a) * mean(:, j, b)
          end do
        end do
      end do
    end do
  end subroutine add_mean_dilatation_stiffness

end module amontons_solid_simd
