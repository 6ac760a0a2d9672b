!> Unit test of rubber_fit: stresses against differences of the energy; constants of exact points; one constant by hand.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_rubber_fit
  use amontons_kinds, only: DP
  use amontons_rubber_fit, only: rubber_tests_type, fit_rubber, nominal_stress, TEST_UNIAXIAL, TEST_BIAXIAL, TEST_PLANAR
  use check, only: suite_type
  implicit none
  integer, parameter :: POWER(2, 9) = reshape([1, 0, 0, 1, 2, 0, 1, 1, 0, 2, 3, 0, 2, 1, 1, 2, 0, 3], [2, 9])   ! 10, 01, 20, ...
  real(DP), parameter :: C(9) = [0.4_DP, 0.1_DP, -0.02_DP, 0.01_DP, 0.003_DP, 0.002_DP, -0.0004_DP, 0.0003_DP, 0.00005_DP]
  type(suite_type) :: suite
  call check_energy()
  call check_exact()
  call check_one()
  call check_undetermined()
  call suite%finish()

contains

  !> The energy at a stretch.
  pure real(DP) function energy(kind, l) result(U)
    integer, intent(in) :: kind
    real(DP), intent(in) :: l
    real(DP) :: s(3)
    integer :: k
    s = [l, 1 / sqrt(l), 1 / sqrt(l)]
    if (kind == TEST_BIAXIAL) s = [l, l, 1 / l**2]
    if (kind == TEST_PLANAR) s = [l, 1.0_DP, 1 / l]
    U = sum([(C(k) * (sum(s**2) - 3)**POWER(1, k) * (sum(1 / s**2) - 3)**POWER(2, k), k=1, 9)])
  end function energy


  !> dU/dl is the stress, in two directions of the equibiaxial test.
  subroutine check_energy()
    real(DP), parameter :: STEP = 1.0e-5_DP, STRETCHES(5) = [0.6_DP, 0.9_DP, 1.1_DP, 1.6_DP, 2.2_DP]
    real(DP) :: stress(1), slope
    integer :: kind, i
    do kind = TEST_UNIAXIAL, TEST_PLANAR
      do i = 1, size(STRETCHES)
        associate (l => STRETCHES(i))
          stress = nominal_stress(POWER, C, [kind], [l])
          slope = (energy(kind, l + STEP) - energy(kind, l - STEP)) / (2 * STEP)
          if (kind == TEST_BIAXIAL) slope = slope / 2
          call suite%near('stress as the slope of the energy', stress(1), slope, 1.0e-7_DP * max(1.0_DP, abs(slope)))
        end associate
      end do
    end do
  end subroutine check_energy


  !> Points of a law give its constants.
  subroutine check_exact()
    type(rubber_tests_type) :: tests
    real(DP) :: found(9), deviation
    logical :: is_determined
    integer :: i, n
    tests%stretch = [([0.7_DP, 0.85_DP, 1.2_DP, 1.5_DP, 2.0_DP, 2.6_DP], i=1, 3)]
    tests%kind = [(TEST_UNIAXIAL, i=1, 6), (TEST_BIAXIAL, i=1, 6), (TEST_PLANAR, i=1, 6)]
    do n = 1, 9, 4                                   ! 1, 5 and 9 constants
      tests%stress = nominal_stress(POWER(:, :n), C(:n), tests%kind, tests%stretch)
      call fit_rubber(POWER(:, :n), tests, found(:n), deviation, is_determined)
      call suite%that('exact: determined', is_determined)
      call suite%near('exact: constants', maxval(abs(found(:n) - C(:n))), 0.0_DP, 1.0e-11_DP)
      call suite%near('exact: deviation', deviation, 0.0_DP, 1.0e-11_DP)
    end do
  end subroutine check_exact


  !> One constant: C10 = sum s/T / sum (s/T)^2, s the stress of C10 = 1.
  subroutine check_one()
    type(rubber_tests_type) :: tests
    real(DP) :: found(1), deviation, s(3)
    logical :: is_determined
    tests%kind = [TEST_UNIAXIAL, TEST_UNIAXIAL, TEST_BIAXIAL]
    tests%stretch = [1.5_DP, 2.0_DP, 1.2_DP]
    tests%stress = [1.0_DP, 1.4_DP, 0.9_DP]
    s = [2 * (1.5_DP - 1 / 1.5_DP**2), 2 * (2 - 1 / 4.0_DP), 2 * (1.2_DP - 1 / 1.2_DP**5)] / tests%stress
    call fit_rubber(POWER(:, :1), tests, found, deviation, is_determined)
    call suite%near('one constant', found(1), sum(s) / sum(s**2), 1.0e-14_DP)
    call suite%near('its deviation', deviation, maxval(abs(1 - found(1) * s)), 1.0e-14_DP)
  end subroutine check_one


  !> Planar tests have I1 = I2.
  subroutine check_undetermined()
    type(rubber_tests_type) :: tests
    real(DP) :: found(2), deviation
    logical :: is_determined
    tests%kind = [TEST_PLANAR, TEST_PLANAR, TEST_PLANAR]
    tests%stretch = [1.1_DP, 1.5_DP, 2.0_DP]
    tests%stress = [0.3_DP, 0.9_DP, 1.5_DP]
    call fit_rubber(POWER(:, :2), tests, found, deviation, is_determined)
    call suite%that('planar tests alone', .not. is_determined)
  end subroutine check_undetermined

end program test_rubber_fit
