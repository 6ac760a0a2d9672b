!> Unit test of amontons_hyperelasticity: stresses and slopes by differences of the energy, and closed forms of each energy.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_hyperelasticity
  use amontons_kinds, only: DP
  use amontons_materials, only: HYPER_POLYNOMIAL, HYPER_OGDEN, HYPER_ARRUDA_BOYCE
  use amontons_hyperelasticity, only: principal_response_type, evaluate_rubber, evaluate_foam
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: FOAM = 0, N_LAWS = 4
  integer, parameter :: KINDS(N_LAWS) = [HYPER_POLYNOMIAL, HYPER_OGDEN, HYPER_ARRUDA_BOYCE, FOAM]
  character(12), parameter :: NAMES(N_LAWS) = [character(12) :: 'polynomial', 'Ogden', 'Arruda-Boyce', 'foam']
  real(DP), parameter :: E_GENERAL(3) = [0.4_DP, -0.25_DP, 0.1_DP], E_LARGE(3) = [1.1_DP, -0.8_DP, -0.2_DP]
  integer :: law
  do law = 1, N_LAWS
    call check_derivatives(law, E_GENERAL)
    call check_derivatives(law, E_LARGE)
    call check_secants(law)
    call check_rest(law)
  end do
  call check_energies()
  call check_closed_forms()
  call suite%finish()

contains

  !> The response of one of the laws, of order 2 where it has one.
  function respond(law, e) result(response)
    integer, intent(in) :: law                     !< 1 to N_LAWS
    real(DP), intent(in) :: e(3)                   !< principal logarithmic strains [-]
    type(principal_response_type) :: response
    select case (KINDS(law))
    case (HYPER_POLYNOMIAL)
      call evaluate_rubber(HYPER_POLYNOMIAL, 2, [0.5_DP, 0.2_DP, 0.05_DP, 0.02_DP, 0.01_DP, 0.1_DP, 0.3_DP], e, response)
    case (HYPER_OGDEN)
      call evaluate_rubber(HYPER_OGDEN, 2, [0.6_DP, 1.3_DP, 0.2_DP, -2.0_DP, 0.1_DP, 0.3_DP], e, response)
    case (HYPER_ARRUDA_BOYCE)
      call evaluate_rubber(HYPER_ARRUDA_BOYCE, 1, [0.8_DP, 2.0_DP, 0.1_DP], e, response)
    case (FOAM)
      call evaluate_foam(2, [0.5_DP, 4.0_DP, 0.3_DP, -2.0_DP, 0.2_DP, 0.1_DP], e, response)
    end select
  end function respond


  !> tau = dW/de and slope = d tau/de by central differences; slope is symmetric.
  subroutine check_derivatives(law, e)
    integer, intent(in) :: law
    real(DP), intent(in) :: e(3)
    type(principal_response_type) :: r, plus, minus
    real(DP) :: de(3), size_of
    real(DP), parameter :: STEP = 1.0e-5_DP
    integer :: k
    r = respond(law, e)
    size_of = maxval(abs(r%slope))
    call suite%that(NAMES(law) // ': strained', size_of > 0.1_DP .and. r%energy > 0)
    do k = 1, 3
      de = 0
      de(k) = STEP
      plus = respond(law, e + de)
      minus = respond(law, e - de)
      call suite%near(NAMES(law) // ': tau', r%tau(k), (plus%energy - minus%energy) / (2 * STEP), 1.0e-8_DP * size_of)
      call suite%near(NAMES(law) // ': slope', norm2(r%slope(:, k) - (plus%tau - minus%tau) / (2 * STEP)), 0.0_DP, &
        1.0e-8_DP * size_of)
    end do
    call suite%near(NAMES(law) // ': symmetric', norm2(r%slope - transpose(r%slope)), 0.0_DP, 1.0e-13_DP * size_of)
  end subroutine check_derivatives


  !> The secants are the quotients; for equal strains their limit slope_AA - slope_AB.
  subroutine check_secants(law)
    integer, intent(in) :: law
    type(principal_response_type) :: r
    integer, parameter :: NEXT(3) = [2, 3, 1]
    integer :: A, B
    r = respond(law, E_GENERAL)
    do A = 1, 3
      B = NEXT(A)
      call suite%near(NAMES(law) // ': secant', r%secant(A), (r%tau(A) - r%tau(B)) / (E_GENERAL(A) - E_GENERAL(B)), &
        1.0e-12_DP * maxval(abs(r%slope)))
    end do
    r = respond(law, [0.3_DP, 0.3_DP, -0.2_DP])
    call suite%near(NAMES(law) // ': secant of equal strains', r%secant(1), r%slope(1, 1) - r%slope(1, 2), &
      1.0e-12_DP * maxval(abs(r%slope)))
  end subroutine check_secants


  !> At rest nothing; strains of 1e-12 give stresses with all their digits.
  subroutine check_rest(law)
    integer, intent(in) :: law
    type(principal_response_type) :: rest, r
    real(DP), parameter :: TINY_STRAIN(3) = [1.0e-12_DP, -2.0e-12_DP, 0.5e-12_DP]
    real(DP) :: linear(3)
    rest = respond(law, [0.0_DP, 0.0_DP, 0.0_DP])
    call suite%that(NAMES(law) // ': no stress at rest', all(rest%tau == 0) .and. rest%energy == 0)
    r = respond(law, TINY_STRAIN)
    linear = matmul(rest%slope, TINY_STRAIN)
    call suite%near(NAMES(law) // ': tiny strains', norm2(r%tau - linear), 0.0_DP, 1.0e-9_DP * norm2(linear))
    call suite%near(NAMES(law) // ': energy of tiny strains', r%energy, dot_product(linear, TINY_STRAIN) / 2, &
      1.0e-9_DP * dot_product(linear, TINY_STRAIN))
  end subroutine check_rest


  !> The energies as they are written in books, at finite strain.
  subroutine check_energies()
    type(principal_response_type) :: r
    real(DP) :: J, l(3), s(3), i1, i2, beta
    l = exp(E_GENERAL)
    J = product(l)
    s = l / J**(1 / 3.0_DP)
    i1 = sum(s**2) - 3
    i2 = sum(1 / s**2) - 3
    r = respond(1, E_GENERAL)
    call suite%near('polynomial: energy', r%energy, 0.5_DP * i1 + 0.2_DP * i2 + 0.05_DP * i1**2 + 0.02_DP * i1 * i2 &
      + 0.01_DP * i2**2 + (J - 1)**2 / 0.1_DP + (J - 1)**4 / 0.3_DP, 1.0e-13_DP)
    r = respond(2, E_GENERAL)
    call suite%near('Ogden: energy', r%energy, 2 * 0.6_DP / 1.69_DP * (sum(s**1.3_DP) - 3) + 0.1_DP * (sum(s**(-2)) - 3) &
      + (J - 1)**2 / 0.1_DP + (J - 1)**4 / 0.3_DP, 1.0e-13_DP)
    r = respond(3, E_GENERAL)
    i1 = i1 + 3
    call suite%near('Arruda-Boyce: energy', r%energy, 0.8_DP * ((i1 - 3) / 2 + (i1**2 - 9) / (20 * 4.0_DP) &
      + 11 * (i1**3 - 27) / (1050 * 16.0_DP) + 19 * (i1**4 - 81) / (7000 * 64.0_DP) &
      + 519 * (i1**5 - 243) / (673750 * 256.0_DP)) + ((J**2 - 1) / 2 - log(J)) / 0.1_DP, 1.0e-13_DP)
    r = respond(4, E_GENERAL)
    beta = 0.2_DP / 0.6_DP
    i1 = 2 * 0.5_DP / 16 * (sum(l**4) - 3 + (J**(-4 * beta) - 1) / beta)
    beta = 0.1_DP / 0.8_DP
    call suite%near('foam: energy', r%energy, i1 + 2 * 0.3_DP / 4 * (sum(l**(-2)) - 3 + (J**(2 * beta) - 1) / beta), 1.0e-13_DP)
  end subroutine check_energies


  !> A Neo-Hookean solid, a foam without transverse strain, and the initial moduli.
  subroutine check_closed_forms()
    type(principal_response_type) :: r
    real(DP) :: l(3), J
    l = exp(E_GENERAL)
    J = product(l)
    call evaluate_rubber(HYPER_POLYNOMIAL, 1, [0.5_DP, 0.0_DP, 0.1_DP], E_GENERAL, r)
    call suite%near('Neo-Hooke: shear', r%tau(1) - r%tau(2), (l(1)**2 - l(2)**2) / J**(2 / 3.0_DP), 1.0e-14_DP)
    call suite%near('Neo-Hooke: pressure', sum(r%tau) / 3, 2 * (J - 1) * J / 0.1_DP, 1.0e-13_DP)
    call evaluate_rubber(HYPER_POLYNOMIAL, 1, [0.5_DP, 0.0_DP, 0.0_DP], E_GENERAL, r)
    call suite%near('D = 0 leaves no pressure', sum(r%tau), 0.0_DP, 1.0e-14_DP)
    call evaluate_foam(1, [0.5_DP, 4.0_DP, 0.0_DP], [0.2_DP, 0.0_DP, 0.0_DP], r)
    call suite%near('foam, nu = 0: along', r%tau(1), 0.25_DP * (exp(0.8_DP) - 1), 1.0e-15_DP)
    call suite%near('foam, nu = 0: across', abs(r%tau(2)) + abs(r%tau(3)), 0.0_DP, 1.0e-15_DP)
    r = respond(4, [0.0_DP, 0.0_DP, 0.0_DP])
    call suite%near('foam: initial shear modulus', r%secant(1), 2 * (0.5_DP + 0.3_DP), 1.0e-15_DP)
    call suite%near('foam: initial lambda', r%slope(1, 2), 2 * (0.5_DP / 3 + 0.3_DP / 8), 1.0e-15_DP)
    r = respond(2, [0.0_DP, 0.0_DP, 0.0_DP])
    call suite%near('Ogden: initial shear modulus', r%secant(1), 2 * 0.8_DP, 1.0e-15_DP)
    call suite%near('Ogden: initial bulk modulus', sum(r%slope) / 9, 2 / 0.1_DP, 1.0e-12_DP)
    r = respond(3, [0.0_DP, 0.0_DP, 0.0_DP])
    call suite%near('Arruda-Boyce: initial shear modulus', r%secant(3), 2 * 0.8_DP * (1 + 3 / 20.0_DP + 99 / 2800.0_DP &
      + 513 / 56000.0_DP + 42039 / (67375 * 256.0_DP)), 1.0e-14_DP)
    call suite%near('Arruda-Boyce: initial bulk modulus', sum(r%slope) / 9, 2 / 0.1_DP, 1.0e-12_DP)
  end subroutine check_closed_forms

end program test_hyperelasticity
