!> Vectorized (SIMD) evaluation of eight solid elements of one kind at a time with von Mises plasticity at finite strain (Simo's
!! law).
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! NLGEOM, isotropic hardening by one curve, one material in all lanes: the law of the calculix dialect. Results
!! agree with `element` and `material_point` (evaluate_simo_law), whose symbols are used here: x = J^(2/3) b - 1 with b the
!! isochoric elastic b, s = G dev b, theta and kappa of the return mapping. The first index of every array is the element: each
!! statement is a vector instruction. The return to the hardening curve and powers are called for each element.
module amontons_plastic_solid_simd
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, LAW_SAINT_VENANT, ELASTIC_ISOTROPIC, CREEP_NONE, RATE_NONE, HISTORY_PEEQ, &
    HISTORY_INELASTIC
  use amontons_plasticity, only: return_mapping_type, return_to_curve, RETURN_OK
  use amontons_logarithmic_strain, only: tensor_log
  use amontons_material_point, only: SQRT_3_2
  use amontons_tensor, only: VOIGT_ROW, VOIGT_COLUMN, VOIGT_INDEX
  use amontons_solid_simd, only: batch_type, batch_rule_type, batch_point_type, evaluate_batch_point, adjugate, &
    deformation_gradient, evaluate_green_strain, unpack_batch_voigt, is_plain_kind, n_node_pairs, BATCH_WIDTH, BATCH_HISTORY, &
    MAX_NODE_PAIRS
  use amontons_element_kinds, only: MAX_ELEMENT_NODES
  implicit none
  private
  public :: is_plastic_batch_kind, evaluate_plastic_batch_forces, evaluate_plastic_batch_tangent

  integer, parameter :: N = MAX_ELEMENT_NODES

  !> The law at one point of the eight elements.
  type :: response_type
    real(DP) :: F(BATCH_WIDTH, 3, 3)                     !< deformation gradient [-]
    real(DP) :: inverse(BATCH_WIDTH, 3, 3)               !< its inverse [-]
    real(DP) :: j(BATCH_WIDTH)                           !< J - 1 [-]
    real(DP) :: scale(BATCH_WIDTH)                       !< J^(-2/3) [-]
    real(DP) :: x(BATCH_WIDTH, 6)                        !< J^(2/3) b - 1 before plastic flow [-]
    real(DP) :: s(BATCH_WIDTH, 6)                        !< G dev b before plastic flow [stress]
    real(DP) :: length(BATCH_WIDTH)                      !< |s| [stress]
    real(DP) :: modulus(BATCH_WIDTH)                     !< G tr b/3 [stress]
    real(DP) :: plastic(BATCH_WIDTH)                     !< dp [-]
    real(DP) :: ratio(BATCH_WIDTH), slope(BATCH_WIDTH)   !< theta, kappa [-]
    real(DP) :: pressure(BATCH_WIDTH)                    !< K/2 (J^2 - 1) [stress]
    real(DP) :: tau(BATCH_WIDTH, 6)                      !< Kirchhoff stress [stress]
  end type response_type

contains

  !> Whether this module supports an element.
  pure logical function is_plastic_batch_kind(kind, material, is_nlgeom) result(is_kind)
    integer, intent(in) :: kind                    !< KIND_...
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    is_kind = is_plain_kind(kind) .and. is_nlgeom .and. material%law == LAW_SAINT_VENANT .and. &
      allocated(material%isotropic_hardening) .and. material%n_history == BATCH_HISTORY
    if (.not. is_kind) return
    is_kind = size(material%isotropic_hardening) == 1 .and. material%elastic_kind == ELASTIC_ISOTROPIC .and. .not. &
      (allocated(material%kinematic_hardening) .or. allocated(material%expansion%value) .or. allocated(material%cone%value) .or. &
      material%creep_law /= CREEP_NONE .or. material%rate_law /= RATE_NONE .or. material%has_deformation_plasticity .or. &
      material%is_user .or. material%is_user_field)
    if (is_kind .and. allocated(material%elastic%value)) is_kind = size(material%elastic%value, 2) == 1
  end function is_plastic_batch_kind


  !> Forces and point values.
  pure subroutine evaluate_plastic_batch_forces(batch, rule, material, is_output_wanted)
    type(batch_type), intent(inout) :: batch
    type(batch_rule_type), intent(in) :: rule
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_output_wanted        !< if not, stress, strain, energy and history are not set
    type(batch_point_type) :: point
    type(response_type) :: r
    real(DP) :: P(BATCH_WIDTH, 3, 3), tau(BATCH_WIDTH, 3, 3)
    integer :: k, a, i, j, v
    batch%is_sound = all(ieee_is_finite(batch%u(:, :, :rule%n_nodes)))
    if (.not. batch%is_sound) return
    batch%force(:, :, :rule%n_nodes) = 0
    do k = 1, rule%n_points
      call evaluate_batch_point(batch, rule, k, .true., point)
      if (batch%is_sound) call evaluate_law(batch, material, k, point%H, r)
      if (.not. batch%is_sound) return
      if (is_output_wanted) call store_output(batch, k, point%H, r)
      call unpack_batch_voigt(r%tau, tau)
      do j = 1, 3
        do i = 1, 3
          P(:, i, j) = point%w * (tau(:, i, 1) * r%inverse(:, j, 1) + tau(:, i, 2) * r%inverse(:, j, 2) + tau(:, i, 3) * &
            r%inverse(:, j, 3))
        end do
      end do
      do a = 1, rule%n_nodes
        do i = 1, 3
          !$omp simd
          do v = 1, BATCH_WIDTH
            batch%force(v, i, a) = batch%force(v, i, a) + P(v, i, 1) * point%g(v, 1, a) + P(v, i, 2) * point%g(v, 2, a) &
              + P(v, i, 3) * point%g(v, 3, a)
          end do
        end do
      end do
    end do
  end subroutine evaluate_plastic_batch_forces


  !> The tangent.
  pure subroutine evaluate_plastic_batch_tangent(batch, rule, material)
    type(batch_type), intent(inout) :: batch
    type(batch_rule_type), intent(in) :: rule
    type(material_type), intent(in) :: material
    type(batch_point_type) :: point
    type(response_type) :: r
    real(DP) :: c(BATCH_WIDTH, 6, 6), g(BATCH_WIDTH, 3, N)
    integer :: k, a, i
    batch%is_sound = all(ieee_is_finite(batch%u(:, :, :rule%n_nodes)))
    if (.not. batch%is_sound) return
    batch%stiffness(:, :, :, :n_node_pairs(rule%n_nodes)) = 0
    do k = 1, rule%n_points
      call evaluate_batch_point(batch, rule, k, .true., point)
      if (batch%is_sound) call evaluate_law(batch, material, k, point%H, r)
      if (.not. batch%is_sound) return
      call evaluate_moduli(batch, r, c)
      do i = 1, 6
        do a = 1, 6
          c(:, a, i) = point%w * c(:, a, i)
        end do
        r%tau(:, i) = point%w * r%tau(:, i)
      end do
      do a = 1, rule%n_nodes
        do i = 1, 3
          g(:, i, a) = point%g(:, 1, a) * r%inverse(:, 1, i) + point%g(:, 2, a) * r%inverse(:, 2, i) + point%g(:, 3, a) * &
            r%inverse(:, 3, i)
        end do
      end do
      call add_point_stiffness(rule%n_nodes, g, r%tau, c, batch%stiffness)
    end do
  end subroutine evaluate_plastic_batch_tangent


  !> Stress and return mapping of one point; is_sound is .false. where the return mapping fails.
  pure subroutine evaluate_law(batch, material, k, H, r)
    type(batch_type), intent(inout) :: batch
    type(material_type), intent(in) :: material
    integer, intent(in) :: k                       !< point
    real(DP), intent(in) :: H(BATCH_WIDTH, 3, 3)   !< displacement gradients [-]
    type(response_type), intent(out) :: r
    real(DP) :: det(BATCH_WIDTH), trace(BATCH_WIDTH), C(BATCH_WIDTH, 6), FC(BATCH_WIDTH, 3, 3)
    integer :: i
    r%F = deformation_gradient(H)
    call adjugate(r%F, r%inverse, det)
    do i = 1, 3
      r%inverse(:, :, i) = r%inverse(:, :, i) / spread(det, 2, 3)
    end do
    r%j = determinant_less_one(H)
    do i = 1, BATCH_WIDTH
      r%scale(i) = (1 + r%j(i))**(-2 / 3.0_DP)
    end do
    call exponential_less_one(-2 * batch%history_old(:, HISTORY_INELASTIC:HISTORY_INELASTIC + 5, k), C)
    do i = 1, 3
      FC(:, i, 1) = r%F(:, i, 1) * C(:, 1) + r%F(:, i, 2) * C(:, 4) + r%F(:, i, 3) * C(:, 6)
      FC(:, i, 2) = r%F(:, i, 1) * C(:, 4) + r%F(:, i, 2) * C(:, 2) + r%F(:, i, 3) * C(:, 5)
      FC(:, i, 3) = r%F(:, i, 1) * C(:, 6) + r%F(:, i, 2) * C(:, 5) + r%F(:, i, 3) * C(:, 3)
    end do
    do i = 1, 6
      associate (a => VOIGT_ROW(i), b => VOIGT_COLUMN(i))
        r%x(:, i) = H(:, a, b) + H(:, b, a) + H(:, a, 1) * H(:, b, 1) + H(:, a, 2) * H(:, b, 2) + H(:, a, 3) * H(:, b, 3) &
          + FC(:, a, 1) * r%F(:, b, 1) + FC(:, a, 2) * r%F(:, b, 2) + FC(:, a, 3) * r%F(:, b, 3)
      end associate
    end do
    trace = r%x(:, 1) + r%x(:, 2) + r%x(:, 3)
    r%modulus = batch%G * r%scale * (3 + trace) / 3
    do i = 1, 6
      r%s(:, i) = batch%G * r%scale * r%x(:, i)
      if (i <= 3) r%s(:, i) = r%s(:, i) - batch%G * r%scale * trace / 3
    end do
    r%length = sqrt(double_product(r%s, r%s))
    call return_stresses(batch, material, k, r)
    r%pressure = 0.5_DP * (batch%lambda + 2 * batch%G / 3) * r%j * (2 + r%j)
    do i = 1, 6
      r%tau(:, i) = r%ratio * r%s(:, i)
      if (i <= 3) r%tau(:, i) = r%tau(:, i) + r%pressure
    end do
  end subroutine evaluate_law


  !> The return mapping of the elements whose trial stress exceeds the least yield stress.
  pure subroutine return_stresses(batch, material, k, r)
    type(batch_type), intent(inout) :: batch
    type(material_type), intent(in) :: material
    integer, intent(in) :: k                       !< point
    type(response_type), intent(inout) :: r        !< out: plastic, ratio, slope
    type(return_mapping_type) :: back
    real(DP) :: q(BATCH_WIDTH), least
    integer :: v, status
    r%plastic = 0
    r%ratio = 1
    r%slope = 1
    q = SQRT_3_2 * r%length / (1 + r%j)
    least = minval(material%isotropic_hardening(1)%stress)
    do v = 1, BATCH_WIDTH
      if (q(v) <= least) cycle
      call return_to_curve(material%isotropic_hardening(1), r%modulus(v) / (1 + r%j(v)), q(v), &
        batch%history_old(v, HISTORY_PEEQ, k), back, status)
      batch%is_sound = status == RETURN_OK
      if (.not. batch%is_sound) return
      r%plastic(v) = back%plastic
      r%ratio(v) = back%ratio
      r%slope(v) = back%slope
    end do
  end subroutine return_stresses


  !> The spatial tangent; its terms are those of isochoric_tangent and subtract_plastic_stress of `material_point`.
  pure subroutine evaluate_moduli(batch, r, c)
    type(batch_type), intent(in) :: batch
    type(response_type), intent(in) :: r
    real(DP), intent(out) :: c(BATCH_WIDTH, 6, 6)  !< engineering shears [stress]
    real(DP), dimension(BATCH_WIDTH) :: shear, bulk, factor, trace
    real(DP), dimension(BATCH_WIDTH, 6) :: normal, along, square
    integer :: i, j
    shear = r%ratio * r%modulus
    bulk = (batch%lambda + 2 * batch%G / 3) * (1 + r%j)**2 - 2 * shear / 3
    factor = 0.5_DP * (r%slope - r%ratio)
    do i = 1, 6
      normal(:, i) = r%s(:, i) / max(r%length, tiny(1.0_DP))
    end do
    square = square_symmetric(normal)
    trace = square(:, 1) + square(:, 2) + square(:, 3)
    do i = 1, 3
      square(:, i) = square(:, i) - trace / 3
    end do
    do i = 1, 6
      along(:, i) = factor * (2 * r%modulus * normal(:, i) + 2 * r%length * square(:, i))
    end do
    do j = 1, 6
      do i = 1, 6
        c(:, i, j) = normal(:, i) * along(:, j) + along(:, i) * normal(:, j)
        if (i <= 3) c(:, i, j) = c(:, i, j) - 2 * r%ratio * r%s(:, j) / 3
        if (j <= 3) c(:, i, j) = c(:, i, j) - 2 * r%ratio * r%s(:, i) / 3
        if (i <= 3 .and. j <= 3) c(:, i, j) = c(:, i, j) + bulk
      end do
      c(:, j, j) = c(:, j, j) + merge(2.0_DP, 1.0_DP, j <= 3) * (shear - r%pressure)
    end do
  end subroutine evaluate_moduli


  !> Stress, strain, energy and history of one point.
  pure subroutine store_output(batch, k, H, r)
    type(batch_type), intent(inout) :: batch
    integer, intent(in) :: k                       !< point
    real(DP), intent(in) :: H(BATCH_WIDTH, 3, 3)   !< displacement gradients [-]
    type(response_type), intent(in) :: r
    real(DP) :: bulk
    integer :: i, v
    do i = 1, 6
      batch%stress(:, i, k) = r%tau(:, i) / (1 + r%j)
    end do
    call evaluate_green_strain(H, batch%strain(:, :, k))
    do v = 1, BATCH_WIDTH
      bulk = batch%lambda(v) + 2 * batch%G(v) / 3
      batch%energy(v, k) = 0.25_DP * bulk * (r%j(v) * (2 + r%j(v)) - 2 * log(1 + r%j(v)))
      if (r%plastic(v) > 0 .or. any(abs(batch%history_old(v, HISTORY_INELASTIC:, k)) > 0)) then
        batch%energy(v, k) = batch%energy(v, k) + (r%ratio(v) * r%length(v))**2 / (4 * r%modulus(v))
      else
        batch%energy(v, k) = batch%energy(v, k) + 1.5_DP * (r%modulus(v) - batch%G(v))
      end if
    end do
    batch%history(:, :, k) = batch%history_old(:, :, k)
    if (any(r%plastic > 0)) call store_history(batch, k, H, r)
  end subroutine store_output


  !> The history after plastic flow: exp(-2 E) = inv(F) J^(2/3) b inv(F)' with b after the flow.
  pure subroutine store_history(batch, k, H, r)
    type(batch_type), intent(inout) :: batch
    integer, intent(in) :: k                       !< point
    real(DP), intent(in) :: H(BATCH_WIDTH, 3, 3)   !< displacement gradients [-]
    type(response_type), intent(in) :: r
    real(DP) :: x(BATCH_WIDTH, 6), y(BATCH_WIDTH, 6), factor(BATCH_WIDTH), full(BATCH_WIDTH, 3, 3), half(BATCH_WIDTH, 3, 3), &
      rest(BATCH_WIDTH, 3, 3)
    integer :: i, m, v
    factor = 2 * SQRT_3_2 * r%modulus * r%plastic / (batch%G * r%scale * max(r%length, tiny(1.0_DP)))
    do i = 1, 6
      x(:, i) = r%x(:, i) - factor * r%s(:, i)
    end do
    call unpack_batch_voigt(x, full)
    do m = 1, 3
      do i = 1, 3
        half(:, i, m) = r%inverse(:, i, 1) * full(:, 1, m) + r%inverse(:, i, 2) * full(:, 2, m) + r%inverse(:, i, 3) * full(:, 3, m)
        rest(:, i, m) = -(r%inverse(:, i, 1) * H(:, 1, m) + r%inverse(:, i, 2) * H(:, 2, m) + r%inverse(:, i, 3) * H(:, 3, m))
      end do
    end do
    do i = 1, 6
      associate (a => VOIGT_ROW(i), b => VOIGT_COLUMN(i))
        x(:, i) = half(:, a, 1) * r%inverse(:, b, 1) + half(:, a, 2) * r%inverse(:, b, 2) + half(:, a, 3) * r%inverse(:, b, 3) &
          + rest(:, a, b) + rest(:, b, a) + rest(:, a, 1) * rest(:, b, 1) + rest(:, a, 2) * rest(:, b, 2) + rest(:, a, 3) * &
          rest(:, b, 3)
      end associate
    end do
    call logarithm_of_one_and(x, y)
    do v = 1, BATCH_WIDTH
      if (.not. r%plastic(v) > 0) cycle
      batch%history(v, HISTORY_INELASTIC:HISTORY_INELASTIC + 5, k) = -0.5_DP * y(v, :)
      batch%history(v, HISTORY_PEEQ, k) = batch%history_old(v, HISTORY_PEEQ, k) + r%plastic(v)
    end do
  end subroutine store_history


  !> K_ab = K_ab + sum of g_ak (c_ikjl + tau_kl delta_ij) g_bl over k and l, for all pairs.
  pure subroutine add_point_stiffness(n_nodes, g, tau, c, stiffness)
    integer, intent(in) :: n_nodes
    real(DP), intent(in) :: g(BATCH_WIDTH, 3, N)         !< current gradients [1/length]
    real(DP), intent(in) :: tau(BATCH_WIDTH, 6), c(BATCH_WIDTH, 6, 6)   !< times the volume [stress length^3]
    real(DP), intent(inout) :: stiffness(BATCH_WIDTH, 3, 3, MAX_NODE_PAIRS)   !< [force/length]
    real(DP) :: d(BATCH_WIDTH, 6, 3), t(BATCH_WIDTH, 3), h
    integer :: pair, a, b, i, j, v
    pair = 0
    do b = 1, n_nodes
      do j = 1, 3
        do i = 1, 6
          d(:, i, j) = c(:, i, VOIGT_INDEX(j, 1)) * g(:, 1, b) + c(:, i, VOIGT_INDEX(j, 2)) * g(:, 2, b) &
            + c(:, i, VOIGT_INDEX(j, 3)) * g(:, 3, b)
        end do
        t(:, j) = tau(:, VOIGT_INDEX(j, 1)) * g(:, 1, b) + tau(:, VOIGT_INDEX(j, 2)) * g(:, 2, b) &
          + tau(:, VOIGT_INDEX(j, 3)) * g(:, 3, b)
      end do
      do a = 1, b
        pair = pair + 1
        associate (block => stiffness(:, :, :, pair))
          !$omp simd private(h)
          do v = 1, BATCH_WIDTH
            h = g(v, 1, a) * t(v, 1) + g(v, 2, a) * t(v, 2) + g(v, 3, a) * t(v, 3)
            block(v, 1, 1) = block(v, 1, 1) + g(v, 1, a) * d(v, 1, 1) + g(v, 2, a) * d(v, 4, 1) + g(v, 3, a) * d(v, 6, 1) + h
            block(v, 2, 1) = block(v, 2, 1) + g(v, 1, a) * d(v, 4, 1) + g(v, 2, a) * d(v, 2, 1) + g(v, 3, a) * d(v, 5, 1)
            block(v, 3, 1) = block(v, 3, 1) + g(v, 1, a) * d(v, 6, 1) + g(v, 2, a) * d(v, 5, 1) + g(v, 3, a) * d(v, 3, 1)
            block(v, 1, 2) = block(v, 1, 2) + g(v, 1, a) * d(v, 1, 2) + g(v, 2, a) * d(v, 4, 2) + g(v, 3, a) * d(v, 6, 2)
            block(v, 2, 2) = block(v, 2, 2) + g(v, 1, a) * d(v, 4, 2) + g(v, 2, a) * d(v, 2, 2) + g(v, 3, a) * d(v, 5, 2) + h
            block(v, 3, 2) = block(v, 3, 2) + g(v, 1, a) * d(v, 6, 2) + g(v, 2, a) * d(v, 5, 2) + g(v, 3, a) * d(v, 3, 2)
            block(v, 1, 3) = block(v, 1, 3) + g(v, 1, a) * d(v, 1, 3) + g(v, 2, a) * d(v, 4, 3) + g(v, 3, a) * d(v, 6, 3)
            block(v, 2, 3) = block(v, 2, 3) + g(v, 1, a) * d(v, 4, 3) + g(v, 2, a) * d(v, 2, 3) + g(v, 3, a) * d(v, 5, 3)
            block(v, 3, 3) = block(v, 3, 3) + g(v, 1, a) * d(v, 6, 3) + g(v, 2, a) * d(v, 5, 3) + g(v, 3, a) * d(v, 3, 3) + h
          end do
        end associate
      end do
    end do
  end subroutine add_point_stiffness


  !> det(1 + H) - 1 without cancellation: the sum of the three invariants of H.
  pure function determinant_less_one(H) result(j)
    real(DP), intent(in) :: H(BATCH_WIDTH, 3, 3)   !< [-]
    real(DP) :: j(BATCH_WIDTH), c(BATCH_WIDTH, 3, 3), det(BATCH_WIDTH)
    call adjugate(H, c, det)
    j = (H(:, 1, 1) + H(:, 2, 2) + H(:, 3, 3)) + (c(:, 1, 1) + c(:, 2, 2) + c(:, 3, 3)) + det
  end function determinant_less_one


  !> A : B of symmetric tensors.
  pure function double_product(A, B) result(s)
    real(DP), intent(in) :: A(BATCH_WIDTH, 6), B(BATCH_WIDTH, 6)   !< Voigt vectors
    real(DP) :: s(BATCH_WIDTH)
    s = A(:, 1) * B(:, 1) + A(:, 2) * B(:, 2) + A(:, 3) * B(:, 3) + 2 * (A(:, 4) * B(:, 4) + A(:, 5) * B(:, 5) + A(:, 6) * B(:, 6))
  end function double_product


  !> exp(A) - 1, as tensor_exp: the series of A over a power of two, doubled.
  pure subroutine exponential_less_one(A, y)
    real(DP), intent(in) :: A(BATCH_WIDTH, 6)      !< Voigt vectors
    real(DP), intent(out) :: y(BATCH_WIDTH, 6)
    integer :: k, n_doublings
    real(DP), parameter :: FACTORIALS(19) = [(gamma(real(k + 1, DP)), k=1, 19)]
    y = 0
    if (.not. any(abs(A) > 0)) return
    n_doublings = min(max(0, exponent(sqrt(maxval(double_product(A, A))))), maxexponent(1.0_DP))
    call sum_powers(A / 2.0_DP**n_doublings, 1 / FACTORIALS, y)
    do k = 1, n_doublings
      y = 2 * y + square_symmetric(y)
    end do
  end subroutine exponential_less_one


  !> ln(1 + A), as tensor_log: the series of artanh in Z = inv(2 + A) A, or the eigenvalues of an element whose Z is large.
  pure subroutine logarithm_of_one_and(A, y)
    real(DP), intent(in) :: A(BATCH_WIDTH, 6)      !< Voigt vectors, eigenvalues more than -1
    real(DP), intent(out) :: y(BATCH_WIDTH, 6)
    integer :: k, v, i
    real(DP), parameter :: ODD_NUMBERS(17) = [(real(2 * k + 1, DP), k=1, 17)], MAX_SERIES_ARGUMENT = 1 / 3.0_DP
    real(DP) :: Z(BATCH_WIDTH, 6), full(BATCH_WIDTH, 3, 3), inverse(BATCH_WIDTH, 3, 3), det(BATCH_WIDTH), large(BATCH_WIDTH)
    call unpack_batch_voigt(A, full)
    do i = 1, 3
      full(:, i, i) = full(:, i, i) + 2
    end do
    call adjugate(full, inverse, det)
    do i = 1, 6                                    ! inv(2 + A) A = 1 - 2 inv(2 + A), here without cancellation
      associate (a_ => VOIGT_ROW(i), b_ => VOIGT_COLUMN(i))
        Z(:, i) = (inverse(:, a_, 1) * A(:, VOIGT_INDEX(1, b_)) + inverse(:, a_, 2) * A(:, VOIGT_INDEX(2, b_)) &
          + inverse(:, a_, 3) * A(:, VOIGT_INDEX(3, b_))) / det
      end associate
    end do
    large = double_product(Z, Z)
    call sum_powers(square_symmetric(Z), 1 / ODD_NUMBERS, y)
    y = 2 * (Z + multiply_symmetric(Z, y))
    do v = 1, BATCH_WIDTH
      if (.not. large(v) <= MAX_SERIES_ARGUMENT**2) y(v, :) = tensor_log(A(v, :), 1.0_DP)
    end do
  end subroutine logarithm_of_one_and


  !> c_1 A + c_2 A^2 + ..., by the theorem of Cayley and Hamilton.
  pure subroutine sum_powers(A, c, y)
    real(DP), intent(in) :: A(BATCH_WIDTH, 6)      !< Voigt vectors
    real(DP), intent(in) :: c(:)
    real(DP), intent(out) :: y(BATCH_WIDTH, 6)
    real(DP) :: square(BATCH_WIDTH, 6)
    real(DP), dimension(BATCH_WIDTH) :: i1, i2, i3, p1, p2, p3, last
    integer :: k
    square = square_symmetric(A)
    i1 = A(:, 1) + A(:, 2) + A(:, 3)
    i2 = A(:, 1) * A(:, 2) + A(:, 2) * A(:, 3) + A(:, 3) * A(:, 1) - A(:, 4)**2 - A(:, 5)**2 - A(:, 6)**2
    i3 = A(:, 1) * (A(:, 2) * A(:, 3) - A(:, 5)**2) - A(:, 4) * (A(:, 4) * A(:, 3) - A(:, 5) * A(:, 6)) &
      + A(:, 6) * (A(:, 4) * A(:, 5) - A(:, 2) * A(:, 6))
    p1 = 0
    p2 = 0
    p3 = 0
    do k = size(c), 1, -1
      last = p3
      p3 = p2 + i1 * last
      p2 = p1 - i2 * last
      p1 = i3 * last + c(k)
    end do
    do k = 1, 6
      y(:, k) = (p1 - i2 * p3) * A(:, k) + (p2 + i1 * p3) * square(:, k)
      if (k <= 3) y(:, k) = y(:, k) + i3 * p3
    end do
  end subroutine sum_powers


  !> A A.
  pure function square_symmetric(A) result(y)
    real(DP), intent(in) :: A(BATCH_WIDTH, 6)      !< Voigt vectors
    real(DP) :: y(BATCH_WIDTH, 6)
    y = multiply_symmetric(A, A)
  end function square_symmetric


  !> The product of symmetric tensors that commute.
  pure function multiply_symmetric(A, B) result(y)
    real(DP), intent(in) :: A(BATCH_WIDTH, 6), B(BATCH_WIDTH, 6)   !< Voigt vectors
    real(DP) :: y(BATCH_WIDTH, 6)
    y(:, 1) = A(:, 1) * B(:, 1) + A(:, 4) * B(:, 4) + A(:, 6) * B(:, 6)
    y(:, 2) = A(:, 4) * B(:, 4) + A(:, 2) * B(:, 2) + A(:, 5) * B(:, 5)
    y(:, 3) = A(:, 6) * B(:, 6) + A(:, 5) * B(:, 5) + A(:, 3) * B(:, 3)
    y(:, 4) = A(:, 1) * B(:, 4) + A(:, 4) * B(:, 2) + A(:, 6) * B(:, 5)
    y(:, 5) = A(:, 4) * B(:, 6) + A(:, 2) * B(:, 5) + A(:, 5) * B(:, 3)
    y(:, 6) = A(:, 1) * B(:, 6) + A(:, 4) * B(:, 5) + A(:, 6) * B(:, 3)
  end function multiply_symmetric

end module amontons_plastic_solid_simd
