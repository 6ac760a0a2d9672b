!> Utility routines that user routines call, with the names and arguments of Abaqus: ROTSIG, SINV, SPRINC and SPRIND.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A tensor of NDI direct and NSHR shear components: those of 11, 22, 33, then those of 12, 13, 23. LSTR says what it is: 1 a
!! stress, 2 a strain, whose shear components are angles. (Abaqus User Subroutines Reference Guide, section Utility routines.)
module amontons_user_utilities
  use, intrinsic :: iso_c_binding, only: c_int, c_double
  use amontons_kinds, only: DP
  use amontons_tensor, only: pack_voigt, symmetric_eigen, trace, von_mises
  implicit none
  private

  integer, parameter :: LSTR_STRAIN = 2
  integer, parameter :: ROW(3) = [1, 1, 2], COLUMN(3) = [2, 3, 3]   ! of the shear components

contains

  !> The matrix of a tensor.
  pure function full_tensor(s, lstr, ndi, nshr) result(A)
    integer(c_int), intent(in) :: lstr, ndi, nshr
    real(DP), intent(in) :: s(ndi + nshr)
    real(DP) :: A(3, 3)
    real(DP) :: factor                           ! of a shear component
    integer :: i
    factor = merge(0.5_DP, 1.0_DP, lstr == LSTR_STRAIN)
    A = 0
    do i = 1, ndi
      A(i, i) = s(i)
    end do
    do i = 1, nshr
      A(ROW(i), COLUMN(i)) = factor * s(ndi + i)
      A(COLUMN(i), ROW(i)) = factor * s(ndi + i)
    end do
  end function full_tensor


  !> ROTSIG: the tensor turned by R, R S R^T.
  pure subroutine rotsig(s, r, sprime, lstr, ndi, nshr) bind(C, name='rotsig_')
    integer(c_int), intent(in) :: lstr, ndi, nshr
    real(c_double), intent(in) :: s(ndi + nshr)
    real(c_double), intent(in) :: r(3, 3)              !< a rotation
    real(c_double), intent(inout) :: sprime(ndi + nshr)
    real(DP) :: A(3, 3)
    integer :: i
    A = matmul(matmul(r, full_tensor(s, lstr, ndi, nshr)), transpose(r))
    sprime(:ndi) = [(A(i, i), i=1, ndi)]
    sprime(ndi + 1:) = [(A(ROW(i), COLUMN(i)), i=1, nshr)] * merge(2.0_DP, 1.0_DP, lstr == LSTR_STRAIN)
  end subroutine rotsig


  !> SINV: the mean of the direct stresses and the stress of von Mises [stress].
  pure subroutine sinv(stress, sinv1, sinv2, ndi, nshr) bind(C, name='sinv_')
    integer(c_int), intent(in) :: ndi, nshr
    real(c_double), intent(in) :: stress(ndi + nshr)
    real(c_double), intent(inout) :: sinv1, sinv2
    real(DP) :: A(3, 3)
    A = full_tensor(stress, 1_c_int, ndi, nshr)
    sinv1 = trace(A) / 3
    sinv2 = von_mises(pack_voigt(A))
  end subroutine sinv


  !> SPRINC: the principal values.
  pure subroutine sprinc(s, ps, lstr, ndi, nshr) bind(C, name='sprinc_')
    integer(c_int), intent(in) :: lstr, ndi, nshr
    real(c_double), intent(in) :: s(ndi + nshr)
    real(c_double), intent(inout) :: ps(3)
    real(DP) :: vectors(3, 3)
    call symmetric_eigen(pack_voigt(full_tensor(s, lstr, ndi, nshr)), ps, vectors)
  end subroutine sprinc


  !> SPRIND: the principal values and directions, one in each row of AN.
  pure subroutine sprind(s, ps, an, lstr, ndi, nshr) bind(C, name='sprind_')
    integer(c_int), intent(in) :: lstr, ndi, nshr
    real(c_double), intent(in) :: s(ndi + nshr)
    real(c_double), intent(inout) :: ps(3), an(3, 3)
    real(DP) :: vectors(3, 3)
    call symmetric_eigen(pack_voigt(full_tensor(s, lstr, ndi, nshr)), ps, vectors)
    an = transpose(vectors)
  end subroutine sprind

end module amontons_user_utilities
