!> Unit test of user_utilities: the routines that user routines call, against formulas of their own.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_user_utilities
  use amontons_kinds, only: DP
  use check, only: suite_type
  implicit none

  interface
    subroutine rotsig(s, r, sprime, lstr, ndi, nshr) bind(C, name='rotsig_')
      use, intrinsic :: iso_c_binding, only: c_int, c_double
      integer(c_int), intent(in) :: lstr, ndi, nshr
      real(c_double), intent(in) :: s(ndi + nshr), r(3, 3)
      real(c_double), intent(inout) :: sprime(ndi + nshr)
    end subroutine rotsig
    subroutine sinv(stress, sinv1, sinv2, ndi, nshr) bind(C, name='sinv_')
      use, intrinsic :: iso_c_binding, only: c_int, c_double
      integer(c_int), intent(in) :: ndi, nshr
      real(c_double), intent(in) :: stress(ndi + nshr)
      real(c_double), intent(inout) :: sinv1, sinv2
    end subroutine sinv
    subroutine sprinc(s, ps, lstr, ndi, nshr) bind(C, name='sprinc_')
      use, intrinsic :: iso_c_binding, only: c_int, c_double
      integer(c_int), intent(in) :: lstr, ndi, nshr
      real(c_double), intent(in) :: s(ndi + nshr)
      real(c_double), intent(inout) :: ps(3)
    end subroutine sprinc
    subroutine sprind(s, ps, an, lstr, ndi, nshr) bind(C, name='sprind_')
      use, intrinsic :: iso_c_binding, only: c_int, c_double
      integer(c_int), intent(in) :: lstr, ndi, nshr
      real(c_double), intent(in) :: s(ndi + nshr)
      real(c_double), intent(inout) :: ps(3), an(3, 3)
    end subroutine sprind
  end interface

  real(DP), parameter :: TOL = 1.0e-14_DP
  type(suite_type) :: suite
  call check_rotation()
  call check_invariants()
  call check_principal()
  call suite%finish()

contains

  !> All components.
  subroutine near(what, actual, expected, tolerance)
    character(*), intent(in) :: what
    real(DP), intent(in) :: actual(:), expected(:), tolerance
    call suite%near(what, maxval(abs(actual - expected)), 0.0_DP, tolerance)
  end subroutine near


  !> A quarter turn about z: 11 and 22 change places, 12 its sign, 13 becomes 23 and 23 minus 13; angles of strains keep their
  !! factor. In the plane with three and with two direct components.
  subroutine check_rotation()
    real(DP), parameter :: QUARTER(3, 3) = reshape([real(DP) :: 0, 1, 0, -1, 0, 0, 0, 0, 1], [3, 3])
    real(DP), parameter :: c = cos(0.3_DP), s = sin(0.3_DP)
    real(DP), parameter :: PART(3, 3) = reshape([c, s, 0.0_DP, -s, c, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    real(DP) :: turned(6)
    integer :: lstr
    do lstr = 1, 2
      call rotsig([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP, 5.0_DP, 6.0_DP], QUARTER, turned, lstr, 3, 3)
      call near('a quarter turn', turned, [2.0_DP, 1.0_DP, 3.0_DP, -4.0_DP, -6.0_DP, 5.0_DP], TOL)
    end do
    turned = 7
    call rotsig([1.0_DP, 0.0_DP, 3.0_DP, 0.0_DP], PART, turned, 2, 3, 1)
    call near('an angle in the plane', turned, [c * c, s * s, 3.0_DP, 2 * s * c, 7.0_DP, 7.0_DP], TOL)
    turned = 7
    call rotsig([0.0_DP, 0.0_DP, 1.0_DP], PART, turned, 1, 2, 1)
    call near('shear in the plane', turned, [-2 * s * c, 2 * s * c, c * c - s * s, 7.0_DP, 7.0_DP, 7.0_DP], TOL)
  end subroutine check_rotation


  !> Uniaxial stress, pure shear and pressure.
  subroutine check_invariants()
    real(DP) :: mean, mises
    call sinv([6.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], mean, mises, 3, 3)
    call near('uniaxial', [mean, mises], [2.0_DP, 6.0_DP], TOL)
    call sinv([0.0_DP, 0.0_DP, 2.0_DP], mean, mises, 2, 1)
    call near('shear', [mean, mises], [0.0_DP, sqrt(12.0_DP)], TOL)
    call sinv([-3.0_DP, -3.0_DP, -3.0_DP, 0.0_DP], mean, mises, 3, 1)
    call near('pressure', [mean, mises], [-3.0_DP, 0.0_DP], TOL)
  end subroutine check_invariants


  !> The sum of value times direction times direction is the tensor; values alone are the same.
  subroutine check_principal()
    real(DP), parameter :: s(6) = [3.0_DP, -1.0_DP, 0.5_DP, 0.7_DP, -0.2_DP, 1.1_DP]
    real(DP) :: A(3, 3), B(3, 3), ps(3), alone(3), an(3, 3), t(6)
    integer :: lstr, k, i, j
    do lstr = 1, 2
      t = s * [1.0_DP, 1.0_DP, 1.0_DP, spread(1.0_DP / real(lstr, DP), 1, 3)]
      A = reshape([t(1), t(4), t(5), t(4), t(2), t(6), t(5), t(6), t(3)], [3, 3])
      call sprind(s, ps, an, lstr, 3, 3)
      B = 0
      do k = 1, 3
        B = B + ps(k) * reshape([((an(k, i) * an(k, j), i=1, 3), j=1, 3)], [3, 3])
      end do
      call near('directions', reshape(B, [9]), reshape(A, [9]), 10 * TOL)
      call sprinc(s, alone, lstr, 3, 3)
      call near('values', alone, ps, TOL)
    end do
  end subroutine check_principal

end program test_user_utilities
