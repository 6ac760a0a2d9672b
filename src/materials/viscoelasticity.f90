!> Linear viscoelasticity by Prony series: relaxation of an instantaneous stress, at small and at finite strain.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The deviator s of the stress is that of the instantaneous elasticity, s0, less what has relaxed, and so is the mean stress m:
!!
!!     s = s0 - sum of g q,     q' = (s0 - q)/tau,     m = m0 - sum of k r,     r' = (m0 - r)/tau
!!
!! In an increment in which s0 is linear in time, x = dt/tau, this is exactly
!!
!!     q = e^-x q_old + a s0_old + b s0,     b = 1 - (1 - e^-x)/x,     a = 1 - e^-x - b
!!
!! so that dt = 0 is the instantaneous response and dt = huge the long-term one. At finite strain s0 and q are pulled back by the
!! isochoric part of F, m is the mean Kirchhoff stress, and the deviator is taken after the push-forward.
!! References: J. C. Simo, Comput. Methods Appl. Mech. Engrg. 60 (1987) 153-173; R. L. Taylor, K. S. Pister, G. L. Goudreau, Int. J.
!! Numer. Methods Engrg. 2 (1970) 45-59 (integration); Abaqus Theory Manual, sections 4.8.1 and 4.8.2.
module amontons_viscoelasticity
  use amontons_kinds, only: DP
  use amontons_elasticity, only: hooke_stress
  use amontons_logarithmic_strain, only: expm1
  use amontons_tensor, only: IDENTITY, VOIGT_IDENTITY, determinant_minus_one, double_dot, invert, push_forward
  implicit none
  private
  public :: viscoelastic_stress, relax_finite_stress, n_viscoelastic_state

  integer, parameter :: N_BRANCH_STATE = 7         !< s0 and m0, then q and r of each term
  real(DP), parameter :: MAX_TIMES = 1.0e20_DP     !< relaxation times after which nothing changes to rounding [-]

contains

  !> The number of state variables.
  pure integer function n_viscoelastic_state(n_terms) result(n)
    integer, intent(in) :: n_terms                 !< of the Prony series
    n = N_BRANCH_STATE * (n_terms + 1)
  end function n_viscoelastic_state


  !> Stress, tangent and stored energy of a small strain.
  pure subroutine viscoelastic_stress(prony, moduli, dt, strain, state, stress, tangent, energy)
    real(DP), intent(in) :: prony(:, :)            !< (3, terms) g, k [-] and tau [time]
    real(DP), intent(in) :: moduli(2)              !< instantaneous Lame constants lambda and G [stress]
    real(DP), intent(in) :: dt                     !< 0: instantaneous; huge: long-term [time]
    real(DP), intent(in) :: strain(6)              !< tensor components [-]
    real(DP), intent(inout) :: state(:)            !< in: at the start; out: at the end of the increment
    real(DP), intent(out) :: stress(6)             !< [stress]
    real(DP), intent(out) :: tangent(6, 6)         !< engineering shears [stress]
    real(DP), intent(out) :: energy                !< of the springs of all terms [stress]
    real(DP) :: s0(6), m0, past(7), factor(2), bulk, rest(6)
    integer :: i
    bulk = moduli(1) + 2 * moduli(2) / 3
    s0 = hooke_stress(moduli(1), moduli(2), strain)
    m0 = sum(s0(:3)) / 3
    s0 = s0 - m0 * VOIGT_IDENTITY
    call relax(prony, dt, [s0, m0], state, factor, past)
    stress = factor(1) * s0 - past(:6) + (factor(2) * m0 - past(7)) * VOIGT_IDENTITY
    tangent = 0
    tangent(:3, :3) = factor(2) * bulk - 2 * factor(1) * moduli(2) / 3
    do i = 1, 6
      tangent(i, i) = tangent(i, i) + merge(2.0_DP, 1.0_DP, i <= 3) * factor(1) * moduli(2)
    end do
    energy = (1 - sum(prony(1, :))) * double_dot(s0, s0) / (4 * moduli(2)) + (1 - sum(prony(2, :))) * m0**2 / (2 * bulk)
    do i = 1, size(prony, 2)
      rest = s0 - state(N_BRANCH_STATE * i + 1:N_BRANCH_STATE * i + 6)
      energy = energy + prony(1, i) * double_dot(rest, rest) / (4 * moduli(2)) &
        + prony(2, i) * (m0 - state(N_BRANCH_STATE * i + 7))**2 / (2 * bulk)
    end do
  end subroutine viscoelastic_stress


  !> The Kirchhoff stress and its spatial tangent of rubber: those of the instantaneous law change to the relaxed ones.
  pure subroutine relax_finite_stress(prony, dt, H, state, stress, tangent)
    real(DP), intent(in) :: prony(:, :)            !< (3, terms) g, k [-] and tau [time]
    real(DP), intent(in) :: dt                     !< 0: instantaneous; huge: long-term [time]
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient, det(1 + H) above 0 [-]
    real(DP), intent(inout) :: state(:)            !< in: at the start; out: at the end of the increment
    real(DP), intent(inout) :: stress(6)           !< in: instantaneous [stress]
    real(DP), intent(inout) :: tangent(6, 6)       !< the same; engineering shears [stress]
    real(DP) :: F(3, 3), inverse(3, 3), det, s0(6), m0, m, past(7), factor(2), a(6), change(6), trace_a
    integer :: i
    F = (IDENTITY + H) / (1 + determinant_minus_one(H))**(1 / 3.0_DP)
    call invert(F, inverse, det)
    m0 = sum(stress(:3)) / 3
    s0 = stress - m0 * VOIGT_IDENTITY
    change = (tangent(1, :) + tangent(2, :) + tangent(3, :) + 2 * stress) / 3   ! of m0
    call relax(prony, dt, [push_forward(inverse, s0), m0], state, factor, past)
    a = push_forward(F, past(:6))
    trace_a = a(1) + a(2) + a(3)
    m = factor(2) * m0 - past(7)
    stress = factor(1) * s0 - a + (m + trace_a / 3) * VOIGT_IDENTITY
    do i = 1, 3
      tangent(i, :) = tangent(i, :) - change
    end do
    tangent = factor(1) * tangent
    do i = 1, 6
      tangent(i, i) = tangent(i, i) + merge(2.0_DP, 1.0_DP, i <= 3) * (factor(1) * m0 - m - trace_a / 3)
    end do
    do i = 1, 3
      tangent(i, :) = tangent(i, :) + factor(2) * change + 2 * a / 3
      tangent(:, i) = tangent(:, i) + 2 * a / 3
    end do
    tangent(:3, :3) = tangent(:3, :3) - 2 * trace_a / 9
  end subroutine relax_finite_stress


  !> What remains of the new stress, and what is left of the past: s = factor(1) s0 - past, m = factor(2) m0 - past.
  pure subroutine relax(prony, dt, new, state, factor, past)
    real(DP), intent(in) :: prony(:, :)
    real(DP), intent(in) :: dt                     !< [time]
    real(DP), intent(in) :: new(7)                 !< s0 and m0 [stress]
    real(DP), intent(inout) :: state(:)
    real(DP), intent(out) :: factor(2)             !< [-]
    real(DP), intent(out) :: past(7)               !< [stress]
    real(DP) :: x, decay, a, b, g(7)
    integer :: i
    factor = 1
    past = 0
    do i = 1, size(prony, 2)
      x = min(dt, MAX_TIMES * prony(3, i)) / prony(3, i)
      decay = 1
      b = 0
      if (x > 0) then
        decay = exp(-x)
        b = 1 - (1 - decay) / x
        if (x < 1) b = 1 + expm1(-x) / x
      end if
      a = 1 - decay - b
      g = [spread(prony(1, i), 1, 6), prony(2, i)]
      associate (branch => state(N_BRANCH_STATE * i + 1:N_BRANCH_STATE * i + N_BRANCH_STATE))
        branch = decay * branch + a * state(:N_BRANCH_STATE)
        past = past + g * branch
        branch = branch + b * new
      end associate
      factor = factor - prony(:2, i) * b
    end do
    state(:N_BRANCH_STATE) = new
  end subroutine relax

end module amontons_viscoelasticity
