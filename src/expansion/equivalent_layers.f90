!> Layers of a shell whose membrane, coupling and bending stiffness are given.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! N equal layers in plane stress have the stiffnesses A, B and D of a section (N = A e + B k, M = B e + D k) if the moments of
!! their own Q over the thickness are A, B and D. Of all positive definite Q the one of largest sum log det Q is taken, the analytic
!! centre: Q^-1 is then a quadratic polynomial of the height, whose 18 coefficients follow from a concave problem by Newton's
!! method (S. Boyd, L. Vandenberghe, Convex Optimization, 2004, section 8.5.3 and 9.5). The thickness is that of a homogeneous
!! plate, h^2 = 12 tr D/tr A in units of A, or a little more. Theory: doc/theory/elements.md, section "Shells by their stiffness".
module amontons_equivalent_layers
  use amontons_kinds, only: DP
  use amontons_dense, only: solve_small, solve_symmetric_eigen, DENSE_OK
  use amontons_tensor, only: VOIGT_ROW, VOIGT_COLUMN
  implicit none
  private
  public :: equivalent_layers_type, find_equivalent_layers, transverse_shear_moduli
  public :: N_EQUIVALENT_LAYERS, LAYERS_OK, LAYERS_INDEFINITE, LAYERS_IMPOSSIBLE

  integer, parameter :: LAYERS_OK = 0
  integer, parameter :: LAYERS_INDEFINITE = 1      !< the section itself has no positive definite stiffness
  integer, parameter :: LAYERS_IMPOSSIBLE = 2      !< no layers have it
  integer, parameter :: N_EQUIVALENT_LAYERS = 5
  integer, parameter :: MAX_ITERATIONS = 100       !< Newton's method takes about ten
  integer, parameter :: ENTRY(18) = [1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6]   !< of coefficient k of L
  integer, parameter :: ORDER(18) = [1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3]   !< and of which L it is
  real(DP), parameter :: THICKNESS(4) = [1.0_DP, 1.1_DP, 1.25_DP, 1.5_DP]   !< attempts, over that of a homogeneous plate [-]
  real(DP), parameter :: MIN_EIGENVALUE = 1.0e-6_DP   !< of a section over its largest one: digits of a deck [-]
  real(DP), parameter :: MIN_LAYER = 1.0e-3_DP     !< least eigenvalue of a layer in units of A: softer layers shear off [-]
  real(DP), parameter :: TOL_MOMENTS = 1.0e-12_DP  !< of A, B, D in units of A and h [-]

  !> Equal layers, from bottom to top.
  type :: equivalent_layers_type
    real(DP) :: thickness = 0                      !< of a layer [length]
    real(DP) :: Q(3, 3, N_EQUIVALENT_LAYERS) = 0   !< of stress 11, 22, 12 over strain, engineering shear; layers last [stress]
    real(DP) :: transverse_shear = 0               !< of the section, shear force over strain, in both directions [force/length]
    real(DP) :: thickness_modulus = 0              !< of stress 33, uncoupled [stress]
  end type equivalent_layers_type

contains

  !> The layers of a section.
  subroutine find_equivalent_layers(stiffness, layers, status)
    real(DP), intent(in) :: stiffness(6, 6)        !< symmetric; N, M over membrane strains, curvatures, all 11, 22, 12
    type(equivalent_layers_type), intent(out) :: layers
    integer, intent(out) :: status                 !< LAYERS_...
    real(DP) :: root(3, 3), inverse(3, 3), h, scaled(6, 6), moments(3, 3, 3), P(3, 3, N_EQUIVALENT_LAYERS), values(3)
    integer :: i, k
    logical :: is_ok
    status = LAYERS_INDEFINITE
    if (.not. all([(stiffness(i, i) > 0, i=1, 6)])) return
    if (.not. is_positive(stiffness(:3, :3), MIN_EIGENVALUE)) return
    call find_root(stiffness(:3, :3), root, inverse, values)
    moments(:, :, 1) = matmul(inverse, matmul(stiffness(:3, :3), inverse))
    moments(:, :, 2) = matmul(inverse, matmul(0.5_DP * (stiffness(:3, 4:) + transpose(stiffness(:3, 4:))), inverse))
    moments(:, :, 3) = matmul(inverse, matmul(stiffness(4:, 4:), inverse))
    h = sqrt(4 * (moments(1, 1, 3) + moments(2, 2, 3) + moments(3, 3, 3)))
    scaled(:3, :3) = moments(:, :, 1)              ! curvatures times h/sqrt(12) compare with strains
    scaled(:3, 4:) = moments(:, :, 2) * sqrt(12.0_DP) / h
    scaled(4:, :3) = scaled(:3, 4:)
    scaled(4:, 4:) = moments(:, :, 3) * 12 / h**2
    if (.not. is_positive(scaled, MIN_EIGENVALUE)) return
    status = LAYERS_IMPOSSIBLE
    do i = 1, size(THICKNESS)
      associate (total => h * THICKNESS(i))
        call find_center(scaled_moments(moments, total), P, is_ok)
        if (.not. is_ok) cycle
        if (.not. all([(is_positive(P(:, :, k), 0.0_DP, MIN_LAYER), k=1, N_EQUIVALENT_LAYERS)])) cycle
        status = LAYERS_OK
        layers%thickness = total / N_EQUIVALENT_LAYERS
        do k = 1, N_EQUIVALENT_LAYERS
          layers%Q(:, :, k) = matmul(root, matmul(P(:, :, k), root)) / total
        end do
        layers%transverse_shear = (stiffness(1, 1) + stiffness(2, 2)) / 6 + stiffness(3, 3) / 3
        layers%thickness_modulus = 0.5_DP * (stiffness(1, 1) + stiffness(2, 2)) / total
      end associate
      return
    end do
  end subroutine find_equivalent_layers


  !> The shear moduli 13, 23 that all layers of a stack need to have a given transverse shear stiffness.
  !!
  !! A shear force Q_a makes the shear stress c_a(z) Q_a by the equilibrium of the bending stresses along direction a, as the
  !! elements of the layers have it: constant over a layer of linear elements, linear over one of quadratic elements. The work of
  !! the stresses gives K^-1_ab = G^-1_ab integral of c_a c_b. One linear layer: G = K/h. Theory: doc/theory/elements.md.
  pure function transverse_shear_moduli(K, thickness, modulus, is_quadratic) result(G)
    real(DP), intent(in) :: K(2, 2)                !< positive definite: shear forces over strains 13, 23 [force/length]
    real(DP), intent(in) :: thickness(:)           !< (layers) from bottom to top [length]
    real(DP), intent(in) :: modulus(:, :)          !< (2, layers) of stress 11 and 22 over its strain [stress]
    logical, intent(in) :: is_quadratic            !< the displacement of a layer is quadratic over its thickness
    real(DP) :: G(2, 2)                            !< [stress]
    real(DP) :: middle(size(thickness)), mean(size(thickness), 2), slope(size(thickness), 2), compliance(2, 2)
    real(DP) :: neutral, bending, before, lever
    integer :: a, b, l
    middle = [(sum(thickness(:l)) - 0.5_DP * thickness(l), l=1, size(thickness))]
    do a = 1, 2
      associate (E => modulus(a, :), t => thickness)
        neutral = sum(E * t * middle) / sum(E * t)
        bending = sum(E * t * ((middle - neutral)**2 + t**2 / 12))
        before = 0                                 ! shear stress at the bottom of the layer
        do l = 1, size(t)
          lever = E(l) * (middle(l) - neutral) / bending
          mean(l, a) = before - t(l) * (lever / 2 - E(l) * t(l) / (12 * bending))
          before = before - t(l) * lever
          slope(l, a) = merge(-0.5_DP * t(l) * lever, 0.0_DP, is_quadratic)
        end do
      end associate
    end do
    compliance = inverse_of(K)
    do b = 1, 2
      do a = 1, 2
        compliance(a, b) = compliance(a, b) / sum(thickness * (mean(:, a) * mean(:, b) + slope(:, a) * slope(:, b) / 3))
      end do
    end do
    G = inverse_of(compliance)

  contains

    !> The inverse of a symmetric matrix.
    pure function inverse_of(M) result(inverse)
      real(DP), intent(in) :: M(2, 2)
      real(DP) :: inverse(2, 2)
      inverse = reshape([M(2, 2), -M(2, 1), -M(1, 2), M(1, 1)], [2, 2]) / (M(1, 1) * M(2, 2) - M(1, 2) * M(2, 1))
    end function inverse_of

  end function transverse_shear_moduli


  !> The analytic centre of positive definite P of equal layers on -1/2 to 1/2 with given moments: P^-1 = L_0 + z L_1 + z^2 L_2,
  !! z^2 in the mean over a layer. Newton's method on L with a line search along the concave function sum log det P^-1 - L .
  !! moments.
  subroutine find_center(moments, P, is_ok)
    real(DP), intent(in) :: moments(3, 3, 3)       !< of order 0, 1, 2 [-]
    real(DP), intent(out) :: P(3, 3, N_EQUIVALENT_LAYERS)   !< [-]
    logical, intent(out) :: is_ok
    real(DP), parameter :: MIN_STEP = 1.0e-8_DP    !< of the line search [-]
    real(DP) :: weight(3, N_EQUIVALENT_LAYERS), x(18), next(18), change(18), residual(18), K(18, 18), value, new_value, step, t, z
    integer :: l, iteration, status
    t = 1 / real(N_EQUIVALENT_LAYERS, DP)
    do l = 1, N_EQUIVALENT_LAYERS
      z = (real(l, DP) - 0.5_DP) * t - 0.5_DP
      weight(:, l) = [1.0_DP, z, z**2 + t**2 / 12]
    end do
    x = 0
    x(:3) = 1                                      ! 11, 22, 33 of the constant part
    is_ok = .false.
    call evaluate(x, value, P)
    do iteration = 1, MAX_ITERATIONS
      call assemble(residual, K)
      is_ok = maxval(abs(residual)) <= TOL_MOMENTS
      if (is_ok) return
      call solve_small(K, residual, change, status)
      if (status /= DENSE_OK) return
      step = 1
      do
        next = x + step * change
        call evaluate(next, new_value, P)
        if (new_value >= value + 1.0e-4_DP * step * dot_product(residual, change) - 1.0e-12_DP) exit   ! rounding of log det
        step = step / 2
        if (step < MIN_STEP) return
      end do
      x = next
      value = new_value
    end do

  contains

    !> The gradient of the function and its negative Hessian.
    subroutine assemble(gradient, hessian)
      real(DP), intent(out) :: gradient(18), hessian(18, 18)
      real(DP) :: block(6, 6)
      integer :: layer, m, n, k
      hessian = 0
      gradient = [(-contract(ENTRY(k), moments(:, :, ORDER(k))), k=1, 18)]
      do layer = 1, N_EQUIVALENT_LAYERS
        block = hessian_of_inverse(P(:, :, layer))
        do m = 1, 3
          gradient(6 * m - 5:6 * m) = gradient(6 * m - 5:6 * m) + t * weight(m, layer) * [(contract(k, P(:, :, layer)), k=1, 6)]
          do n = 1, 3
            hessian(6 * m - 5:6 * m, 6 * n - 5:6 * n) = hessian(6 * m - 5:6 * m, 6 * n - 5:6 * n) + &
              t * weight(m, layer) * weight(n, layer) * block
          end do
        end do
      end do
    end subroutine assemble

    !> The function, and the inverses of the polynomial; far below others where it is not positive definite.
    subroutine evaluate(at, f, inverses)
      real(DP), intent(in) :: at(18)
      real(DP), intent(out) :: f, inverses(3, 3, N_EQUIVALENT_LAYERS)
      real(DP) :: polynomial(3, 3), root(3, 3), inverse(3, 3), values(3)
      integer :: layer, k
      f = 0
      inverses = 0
      do layer = 1, N_EQUIVALENT_LAYERS
        polynomial = 0
        do k = 1, 18
          polynomial = polynomial + at(k) * weight(ORDER(k), layer) * unit(ENTRY(k))
        end do
        call find_root(polynomial, root, inverse, values)
        if (.not. values(1) > 0) then
          f = -huge(f)
          return
        end if
        f = f + t * sum(log(values))
        inverses(:, :, layer) = matmul(inverse, inverse)
      end do
      do k = 1, 18
        f = f - at(k) * contract(ENTRY(k), moments(:, :, ORDER(k)))
      end do
    end subroutine evaluate

  end subroutine find_center


  !> The negative Hessian of log det P^-1 by the entries of P^-1.
  pure function hessian_of_inverse(P) result(block)
    real(DP), intent(in) :: P(3, 3)
    real(DP) :: block(6, 6)
    integer :: i, j
    do j = 1, 6
      do i = 1, 6
        block(i, j) = contract(i, matmul(P, matmul(unit(j), P)))
      end do
    end do
  end function hessian_of_inverse


  !> Moments of a thickness of 1.
  pure function scaled_moments(moments, total) result(scaled)
    real(DP), intent(in) :: moments(3, 3, 3)       !< [length^order]
    real(DP), intent(in) :: total                  !< thickness [length]
    real(DP) :: scaled(3, 3, 3)
    integer :: k
    do k = 1, 3
      scaled(:, :, k) = moments(:, :, k) / total**(k - 1)
    end do
  end function scaled_moments


  !> The symmetric matrices of which one entry is 1, in Voigt order.
  pure function unit(i)
    integer, intent(in) :: i                       !< 1 to 6: 11, 22, 33, 12, 13, 23
    real(DP) :: unit(3, 3)
    unit = 0
    unit(VOIGT_ROW(i), VOIGT_COLUMN(i)) = 1
    unit(VOIGT_COLUMN(i), VOIGT_ROW(i)) = 1
  end function unit


  !> The product of such a matrix with a symmetric one.
  pure real(DP) function contract(i, a)
    integer, intent(in) :: i                       !< 1 to 6
    real(DP), intent(in) :: a(3, 3)
    contract = a(VOIGT_ROW(i), VOIGT_COLUMN(i)) * merge(1.0_DP, 2.0_DP, i <= 3)
  end function contract


  !> The square root of a symmetric matrix, its inverse, and the eigenvalues of the matrix; both 0 unless all are positive.
  subroutine find_root(a, root, inverse, values)
    real(DP), intent(in) :: a(3, 3)
    real(DP), intent(out) :: root(3, 3), inverse(3, 3)
    real(DP), intent(out) :: values(3)             !< ascending; 0 on trouble
    real(DP) :: vectors(3, 3)
    integer :: k, status
    root = 0
    inverse = 0
    call solve_symmetric_eigen(a, values, vectors, status)
    if (status /= DENSE_OK) values = 0
    if (.not. values(1) > 0) return
    do k = 1, 3
      associate (v => vectors(:, k))
        root = root + sqrt(values(k)) * spread(v, 2, 3) * spread(v, 1, 3)
        inverse = inverse + spread(v, 2, 3) * spread(v, 1, 3) / sqrt(values(k))
      end associate
    end do
  end subroutine find_root


  !> Whether the least eigenvalue of a symmetric matrix is above a part of the largest one and above a bound.
  logical function is_positive(a, part, bound)
    real(DP), intent(in) :: a(:, :)
    real(DP), intent(in) :: part                   !< [-]
    real(DP), intent(in), optional :: bound        !< default 0
    real(DP) :: values(size(a, 1)), vectors(size(a, 1), size(a, 1))
    integer :: status
    call solve_symmetric_eigen(a, values, vectors, status)
    is_positive = status == DENSE_OK .and. values(1) > part * values(size(values))
    if (present(bound)) is_positive = is_positive .and. values(1) > bound
  end function is_positive

end module amontons_equivalent_layers
