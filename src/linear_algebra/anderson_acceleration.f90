!> Anderson acceleration of a fixed-point iteration x = G(x).
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! With f = G(x) - x, and dF, dG the last changes of f and of G(x), the next iterate is
!!
!!     x = G(x) - dG gamma,      gamma = argmin |f - dF gamma|.
!!
!! For a linear G it is GMRES, so that it also converges where the plain iteration diverges. References: D. G. Anderson, J. ACM 12
!! (1965) 547-560; H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49 (2011) 1715-1735.
module amontons_anderson_acceleration
  use amontons_kinds, only: DP
  use amontons_dense, only: least_squares, DENSE_OK
  implicit none
  private
  public :: anderson_type, forget_iterates, accelerate

  integer, parameter :: DEPTH = 6                  !< changes kept
  real(DP), parameter :: FIRST_RELAXATION = 0.5_DP   !< of a step without history [-]
  real(DP), parameter :: TOL_RANK = 0.1_DP         !< changes of f, scaled to length 1, that depend on others up to this do not
                                                   !! count: G is known that exactly [-]

  !> The last iterates.
  type :: anderson_type
    integer :: n = 0                               !< changes stored
    logical :: has_last = .false.
    real(DP), allocatable :: f(:), g(:)            !< of the last iterate
    real(DP), allocatable :: df(:, :), dg(:, :)    !< (:, DEPTH) changes, newest first
  end type anderson_type

contains

  !> Forgets all iterates: the problem has changed.
  pure subroutine forget_iterates(self)
    type(anderson_type), intent(inout) :: self
    self%n = 0
    self%has_last = .false.
  end subroutine forget_iterates


  !> The next iterate from x and G(x). Without history it lies between the two.
  subroutine accelerate(self, x, g, next)
    type(anderson_type), intent(inout) :: self
    real(DP), intent(in) :: x(:), g(:)
    real(DP), intent(out) :: next(:)
    real(DP) :: gamma(DEPTH), lengths(DEPTH)
    integer :: status, rank
    if (allocated(self%f)) then
      if (size(self%f) /= size(x)) then
        call forget_iterates(self)
        deallocate (self%f, self%g, self%df, self%dg)
      end if
    end if
    if (.not. allocated(self%f)) allocate (self%f(size(x)), self%g(size(x)), self%df(size(x), DEPTH), self%dg(size(x), DEPTH))
    next = x + FIRST_RELAXATION * (g - x)
    if (self%has_last) then
      self%df(:, 2:) = self%df(:, :DEPTH - 1)
      self%dg(:, 2:) = self%dg(:, :DEPTH - 1)
      self%df(:, 1) = g - x - self%f
      self%dg(:, 1) = g - self%g
      self%n = min(self%n + 1, DEPTH, size(x))
      lengths(:self%n) = max(norm2(self%df(:, :self%n), dim=1), tiny(1.0_DP))
      call least_squares(self%df(:, :self%n) / spread(lengths(:self%n), 1, size(x)), g - x, TOL_RANK, gamma(:self%n), rank, &
        status)
      if (status == DENSE_OK .and. rank > 0) next = g - matmul(self%dg(:, :self%n), gamma(:self%n) / lengths(:self%n))
    end if
    self%f = g - x
    self%g = g
    self%has_last = .true.
  end subroutine accelerate

end module amontons_anderson_acceleration
