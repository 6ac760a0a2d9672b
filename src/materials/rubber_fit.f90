!> Constants of rubber from simple tests: polynomials in the invariants, by least squares of relative errors.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! U = sum C_ij (I1 - 3)^i (I2 - 3)^j of an incompressible rubber has the nominal stress, at the stretch l,
!!
!!     uniaxial       T = 2 (1 - l^-3) (l U,1 + U,2)         I1 = l^2 + 2/l,      I2 = 2 l + l^-2
!!     equibiaxial    T = 2 (l - l^-5) (U,1 + l^2 U,2)       I1 = 2 l^2 + l^-4,   I2 = l^4 + 2 l^-2
!!     planar         T = 2 (l - l^-3) (U,1 + U,2)           I1 = I2 = 1 + l^2 + l^-2
!!
!! which is linear in the constants. The sum of (1 - T/T_test)^2 is least. (R. W. Ogden, Non-Linear Elastic Deformations, 1984,
!! section 7.2; the measure is that of Abaqus.)
module amontons_rubber_fit
  use amontons_dense, only: least_squares, DENSE_OK
  use amontons_kinds, only: DP
  implicit none
  private
  public :: rubber_tests_type, fit_rubber, nominal_stress
  public :: TEST_UNIAXIAL, TEST_BIAXIAL, TEST_PLANAR

  integer, parameter :: TEST_UNIAXIAL = 1, TEST_BIAXIAL = 2, TEST_PLANAR = 3
  real(DP), parameter :: TOL_FIT_RANK = 1.0e-10_DP       !< singular values below it, over the largest, count as 0 [-]

  !> Points of tests.
  type :: rubber_tests_type
    integer, allocatable :: kind(:)                  !< (n) TEST_...
    real(DP), allocatable :: stretch(:)              !< (n) [-]
    real(DP), allocatable :: stress(:)               !< (n) nominal, not 0 [stress]
  end type rubber_tests_type

contains

  !> The constants of least relative errors.
  subroutine fit_rubber(power, tests, constants, deviation, is_determined)
    integer, intent(in) :: power(:, :)               !< (2, n) i and j of each constant
    type(rubber_tests_type), intent(in) :: tests
    real(DP), intent(out) :: constants(:)            !< (n) C_ij [stress]
    real(DP), intent(out) :: deviation               !< largest error of a stress over this stress [-]
    logical, intent(out) :: is_determined            !< .false.: other constants have the same errors
    real(DP) :: A(size(tests%stress), size(constants)), unit(size(constants)), scale(size(constants))
    integer :: k, rank, status
    do k = 1, size(constants)
      unit = 0
      unit(k) = 1
      A(:, k) = nominal_stress(power, unit, tests%kind, tests%stretch) / tests%stress
    end do
    scale = norm2(A, dim=1)                          ! powers of large strains: columns of different size
    where (.not. scale > 0) scale = 1
    call least_squares(A / spread(scale, 1, size(A, 1)), spread(1.0_DP, 1, size(A, 1)), TOL_FIT_RANK, constants, rank, status)
    is_determined = status == DENSE_OK .and. rank == size(constants)
    constants = constants / scale
    deviation = maxval(abs(1 - matmul(A, constants)))
  end subroutine fit_rubber


  !> The nominal stress in a test.
  elemental function term_stress(i, j, kind, stretch) result(stress)
    integer, intent(in) :: i, j                      !< of C_ij = 1
    integer, intent(in) :: kind                      !< TEST_...
    real(DP), intent(in) :: stretch                  !< [-]
    real(DP) :: stress, a, b, U_1, U_2
    associate (l => stretch)
      select case (kind)
      case (TEST_UNIAXIAL)
        a = l**2 + 2 / l - 3
        b = 2 * l + 1 / l**2 - 3
      case (TEST_BIAXIAL)
        a = 2 * l**2 + 1 / l**4 - 3
        b = l**4 + 2 / l**2 - 3
      case default
        a = l**2 + 1 / l**2 - 2
        b = a
      end select
      U_1 = 0
      U_2 = 0
      if (i > 0) U_1 = real(i, DP) * a**(i - 1) * b**j
      if (j > 0) U_2 = real(j, DP) * a**i * b**(j - 1)
      select case (kind)
      case (TEST_UNIAXIAL)
        stress = 2 * (1 - 1 / l**3) * (l * U_1 + U_2)
      case (TEST_BIAXIAL)
        stress = 2 * (l - 1 / l**5) * (U_1 + l**2 * U_2)
      case default
        stress = 2 * (l - 1 / l**3) * (U_1 + U_2)
      end select
    end associate
  end function term_stress


  !> The nominal stress of constants at some points.
  pure function nominal_stress(power, constants, kind, stretch) result(stress)
    integer, intent(in) :: power(:, :)               !< (2, n)
    real(DP), intent(in) :: constants(:)             !< (n) [stress]
    integer, intent(in) :: kind(:)                   !< (points) TEST_...
    real(DP), intent(in) :: stretch(:)               !< (points) [-]
    real(DP) :: stress(size(stretch))
    integer :: k
    stress = 0
    do k = 1, size(constants)
      stress = stress + constants(k) * term_stress(power(1, k), power(2, k), kind, stretch)
    end do
  end function nominal_stress

end module amontons_rubber_fit
