!> Hyperelastic laws (polynomial, Ogden, Arruda-Boyce, hyperfoam) in principal logarithmic strains.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! | kind | strain energy per reference volume |
!! |---|---|
!! | polynomial | sum C_ij (I1 - 3)^i (I2 - 3)^j + sum (J - 1)^(2 i)/D_i |
!! | Ogden | sum 2 mu_i/alpha_i^2 (l1^alpha_i + l2^alpha_i + l3^alpha_i - 3) + sum (J - 1)^(2 i)/D_i |
!! | Arruda-Boyce | mu sum c_i/lambda_m^(2 i - 2) (I1^i - 3^i) + ((J^2 - 1)/2 - ln J)/D |
!! | foam | sum 2 mu_i/alpha_i^2 (L1^alpha_i + L2^alpha_i + L3^alpha_i - 3 + (J^(-alpha_i beta_i) - 1)/beta_i) |
!!
!! Stretches l and invariants I1, I2 are isochoric (J^(-1/3) L); the foam uses the total stretches L,
!! beta = nu/(1 - 2 nu). D_i = 0 omits its term. The formulas stay accurate for small strains and equal stretches.
!! References: R. W. Ogden, Non-Linear Elastic Deformations (1984), chapter 7; E. M. Arruda, M. C. Boyce, J. Mech. Phys.
!! Solids 41 (1993) 389-412; B. Storakers, J. Mech. Phys. Solids 34 (1986) 125-145.
module amontons_hyperelasticity
  use amontons_kinds, only: DP
  use amontons_materials, only: HYPER_POLYNOMIAL, HYPER_OGDEN, HYPER_ARRUDA_BOYCE
  use amontons_logarithmic_strain, only: expm1, NEXT_AXIS
  implicit none
  private
  public :: principal_response_type, evaluate_rubber, evaluate_foam

  !> Principal Kirchhoff stresses and the data of their tangent.
  type :: principal_response_type
    real(DP) :: tau(3) = 0                         !< principal Kirchhoff stresses [stress]
    real(DP) :: slope(3, 3) = 0                    !< d tau_A/d e_B [stress]
    real(DP) :: secant(3) = 0                      !< (tau_A - tau_B)/(e_A - e_B) of pairs (1, 2), (2, 3), (3, 1) [stress]
    real(DP) :: energy = 0                         !< per reference volume [stress]
  end type principal_response_type

  !> Derivatives of the isochoric energy by the invariants.
  type :: invariant_derivatives_type
    real(DP) :: w = 0, w1 = 0, w2 = 0, w11 = 0, w12 = 0, w22 = 0
  end type invariant_derivatives_type

contains

  !> Rubber: an isochoric part and a volumetric one.
  pure subroutine evaluate_rubber(kind, order, constants, e, response)
    integer, intent(in) :: kind                    !< HYPER_...
    integer, intent(in) :: order                   !< N
    real(DP), intent(in) :: constants(:)           !< as defined at HYPER_...
    real(DP), intent(in) :: e(3)                   !< principal logarithmic strains [-]
    type(principal_response_type), intent(out) :: response
    real(DP) :: log_volume_ratio
    log_volume_ratio = e(1) + e(2) + e(3)
    if (kind == HYPER_OGDEN) then
      call add_ogden_terms(order, constants, e - log_volume_ratio / 3, response)
    else
      call add_invariant_terms(kind, order, constants, e - log_volume_ratio / 3, response)
    end if
    call project_deviatoric(response)
    call add_volumetric_terms(kind, order, constants, log_volume_ratio, response)
  end subroutine evaluate_rubber


  !> Foam.
  pure subroutine evaluate_foam(order, constants, e, response)
    integer, intent(in) :: order                   !< N
    real(DP), intent(in) :: constants(:)           !< mu_1 alpha_1 ... mu_N alpha_N nu_1 ... nu_N
    real(DP), intent(in) :: e(3)                   !< principal logarithmic strains [-]
    type(principal_response_type), intent(out) :: response
    real(DP) :: log_volume_ratio, beta, power
    integer :: i
    call add_ogden_terms(order, constants, e, response)
    log_volume_ratio = e(1) + e(2) + e(3)
    do i = 1, order
      associate (mu => constants(2 * i - 1), alpha => constants(2 * i), nu => constants(2 * order + i))
        beta = nu / (1 - 2 * nu)
        power = expm1(-alpha * beta * log_volume_ratio)
        response%tau = response%tau - 2 * mu / alpha * power
        response%slope = response%slope + 2 * mu * beta * (1 + power)
        if (abs(beta) > 0) then
          response%energy = response%energy + 2 * mu / alpha**2 * exp_minus_linear(-alpha * beta * log_volume_ratio) / beta
        end if
      end associate
    end do
  end subroutine evaluate_foam


  !> Powers of the stretches: adds sum 2 mu/alpha^2 (exp(alpha e_A) - 1 - alpha e_A); of the stress the part without the
  !! constant 2 mu/alpha, which the deviator or the volume term of the foam cancels.
  pure subroutine add_ogden_terms(order, constants, e, response)
    integer, intent(in) :: order
    real(DP), intent(in) :: constants(:), e(3)
    type(principal_response_type), intent(inout) :: response
    integer :: i, A, B
    do i = 1, order
      associate (mu => constants(2 * i - 1), alpha => constants(2 * i))
        do A = 1, 3
          B = NEXT_AXIS(A)
          response%tau(A) = response%tau(A) + 2 * mu / alpha * expm1(alpha * e(A))
          response%slope(A, A) = response%slope(A, A) + 2 * mu * exp(alpha * e(A))
          response%secant(A) = response%secant(A) + 2 * mu * exp(0.5_DP * alpha * (e(A) + e(B))) &
            * sinhc(0.5_DP * alpha * (e(A) - e(B)))
          response%energy = response%energy + 2 * mu / alpha**2 * exp_minus_linear(alpha * e(A))
        end do
      end associate
    end do
  end subroutine add_ogden_terms


  !> Functions of the isochoric invariants I1 = sum exp(2 e_A), I2 = sum exp(-2 e_A).
  pure subroutine add_invariant_terms(kind, order, constants, e, response)
    integer, intent(in) :: kind, order
    real(DP), intent(in) :: constants(:)
    real(DP), intent(in) :: e(3)                   !< isochoric: their sum is 0 [-]
    type(principal_response_type), intent(inout) :: response
    type(invariant_derivatives_type) :: d
    real(DP) :: p(3), m(3), i1, i2
    integer :: A, B
    i1 = sum(exp_minus_linear(2 * e))
    i2 = sum(exp_minus_linear(-2 * e))
    d = invariant_derivatives_type()
    if (kind == HYPER_POLYNOMIAL) call differentiate_polynomial(order, constants, i1, i2, d)
    if (kind == HYPER_ARRUDA_BOYCE) call differentiate_arruda_boyce(constants, i1, d)
    p = expm1(2 * e)                      ! the deviator cancels the constant 1
    m = expm1(-2 * e)
    response%energy = d%w
    response%tau = 2 * d%w1 * p - 2 * d%w2 * m
    do A = 1, 3
      B = NEXT_AXIS(A)
      response%slope(:, A) = 4 * (d%w11 * p(A) - d%w12 * m(A)) * p + 4 * (d%w22 * m(A) - d%w12 * p(A)) * m
      response%slope(A, A) = response%slope(A, A) + 4 * d%w1 * (1 + p(A)) + 4 * d%w2 * (1 + m(A))
      response%secant(A) = 4 * (d%w1 * exp(e(A) + e(B)) + d%w2 * exp(-e(A) - e(B))) * sinhc(e(A) - e(B))
    end do
  end subroutine add_invariant_terms


  !> The polynomial and its derivatives at i1 = I1 - 3, i2 = I2 - 3.
  pure subroutine differentiate_polynomial(order, constants, i1, i2, d)
    integer, intent(in) :: order
    real(DP), intent(in) :: constants(:), i1, i2
    type(invariant_derivatives_type), intent(inout) :: d
    real(DP) :: x(0:2), y(0:2), c
    integer :: n, i, j, k
    k = 0
    do n = 1, order
      do j = 0, n
        i = n - j
        k = k + 1
        c = constants(k)
        if (.not. abs(c) > 0) cycle
        x = power_derivatives(i1, i)
        y = power_derivatives(i2, j)
        d%w = d%w + c * x(0) * y(0)
        d%w1 = d%w1 + c * x(1) * y(0)
        d%w2 = d%w2 + c * x(0) * y(1)
        d%w11 = d%w11 + c * x(2) * y(0)
        d%w12 = d%w12 + c * x(1) * y(1)
        d%w22 = d%w22 + c * x(0) * y(2)
      end do
    end do
  end subroutine differentiate_polynomial


  !> x^n with its first and second derivative.
  pure function power_derivatives(x, n) result(y)
    real(DP), intent(in) :: x
    integer, intent(in) :: n
    real(DP) :: y(0:2)
    y = 0
    y(0) = x**n
    if (n > 0) y(1) = real(n, DP) * x**(n - 1)
    if (n > 1) y(2) = real(n * (n - 1), DP) * x**(n - 2)
  end function power_derivatives


  !> Arruda and Boyce's eight-chain model, five terms of the inverse Langevin function.
  pure subroutine differentiate_arruda_boyce(constants, i1, d)
    real(DP), intent(in) :: constants(:), i1
    type(invariant_derivatives_type), intent(inout) :: d
    real(DP), parameter :: C(5) = [1 / 2.0_DP, 1 / 20.0_DP, 11 / 1050.0_DP, 19 / 7000.0_DP, 519 / 673750.0_DP]
    real(DP) :: factor, total
    integer :: i, k
    do i = 1, 5
      factor = constants(1) * C(i) / constants(2)**(2 * i - 2)
      total = 0                                    ! (I1^i - 3^i)/(I1 - 3)
      do k = 0, i - 1
        total = total + (3 + i1)**k * 3.0_DP**(i - 1 - k)
      end do
      d%w = d%w + factor * i1 * total
      d%w1 = d%w1 + factor * real(i, DP) * (3 + i1)**(i - 1)
      if (i > 1) d%w11 = d%w11 + factor * real(i * (i - 1), DP) * (3 + i1)**(i - 2)
    end do
  end subroutine differentiate_arruda_boyce


  !> Subtracts the mean from stresses and derivatives: the isochoric strains are the deviator of the strains.
  pure subroutine project_deviatoric(response)
    type(principal_response_type), intent(inout) :: response
    integer :: A
    response%tau = response%tau - sum(response%tau) / 3
    do A = 1, 3
      response%slope(:, A) = response%slope(:, A) - sum(response%slope(:, A)) / 3
    end do
    do A = 1, 3
      response%slope(A, :) = response%slope(A, :) - sum(response%slope(A, :)) / 3
    end do
  end subroutine project_deviatoric


  !> The volumetric part.
  pure subroutine add_volumetric_terms(kind, order, constants, log_volume_ratio, response)
    integer, intent(in) :: kind, order
    real(DP), intent(in) :: constants(:)
    real(DP), intent(in) :: log_volume_ratio                 !< ln J [-]
    type(principal_response_type), intent(inout) :: response
    real(DP) :: J, j1, pressure, stiffness, power(0:2)
    integer :: i, n
    j1 = expm1(log_volume_ratio)
    J = 1 + j1
    pressure = 0
    stiffness = 0
    if (kind == HYPER_ARRUDA_BOYCE) then
      response%energy = response%energy + 0.5_DP * exp_minus_linear(2 * log_volume_ratio) / constants(3)
      response%tau = response%tau + j1 * (1 + J) / constants(3)
      response%slope = response%slope + 2 * J * J / constants(3)
      return
    end if
    n = merge(2 * order, order * (order + 3) / 2, kind == HYPER_OGDEN)
    do i = 1, order
      if (.not. abs(constants(n + i)) > 0) cycle
      power = power_derivatives(j1, 2 * i) / constants(n + i)
      response%energy = response%energy + power(0)
      pressure = pressure + power(1) * J
      stiffness = stiffness + power(2) * J * J + power(1) * J
    end do
    response%tau = response%tau + pressure
    response%slope = response%slope + stiffness
  end subroutine add_volumetric_terms


  !> sinh(x)/x.
  pure elemental function sinhc(x) result(y)
    real(DP), intent(in) :: x
    real(DP) :: y
    y = 1 + x * x / 6
    if (abs(x) > 1.0e-4_DP) y = sinh(x) / x
  end function sinhc


  !> exp(x) - 1 - x, by its series where the terms would cancel.
  pure elemental function exp_minus_linear(x) result(y)
    real(DP), intent(in) :: x
    real(DP) :: y
    if (abs(x) > 0.1_DP) then
      y = expm1(x) - x
    else
      y = x * x / 2 * (1 + x / 3 * (1 + x / 4 * (1 + x / 5 * (1 + x / 6 * (1 + x / 7 * (1 + x / 8 * (1 + x / 9)))))))
    end if
  end function exp_minus_linear

end module amontons_hyperelasticity
