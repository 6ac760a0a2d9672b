!> Von Mises viscoplasticity of any elasticity with linear isotropic and kinematic hardening: the return mapping.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! With s the deviator of the stress, a the plastic strain that makes the back stress, g n the plastic strain of the increment (n a
!! unit tensor), p the equivalent plastic strain and c = sqrt(2/3)
!!
!!     |s - d2 a| = c (r0 + d1 p + (c g/w)^(1/n)),      w = A t^m dt of the increment dt from time t; without viscosity 1/w = 0
!!
!! Backward Euler: with b = g/S, S = |s - d2 a| + d2 g, the tensor S n is (1 + b P C)^-1 (P C e - d2 a_0), P the deviatoric
!! projection, and one equation for b is left, descending in b. Its unknown is b^(1/n), which has a finite slope at zero.
!! References: J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), sections 2.7 and 3.3; G. Dhondt, The Finite Element
!! Method for Three-Dimensional Thermomechanical Applications, Wiley 2004, section 5.5, and CalculiX CrunchiX USER'S MANUAL
!! (names, constants, state variables).
module amontons_linear_viscoplasticity
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_crystal_plasticity, only: STATE_ORDER
  use amontons_plasticity, only: RETURN_OK, RETURN_FAILED, TOL_YIELD, solve_voigt_system
  use amontons_scalar_root, only: root_search_type, improve_root, MAX_ROOT_ITERATIONS
  use amontons_tensor, only: double_dot, VOIGT_IDENTITY
  implicit none
  private
  public :: linear_return_type, map_linear_return, N_LINEAR_STATE, N_LINEAR_CONSTANTS

  integer, parameter :: N_LINEAR_CONSTANTS = 6     !< r0, d1, d2, A, n, m
  integer, parameter :: N_LINEAR_STATE = 14        !< p, plastic strain 11 22 33 12 13 23, p since the start, a in the same order
  integer, parameter :: MAX_BRACKET_DOUBLINGS = 300
  real(DP), parameter :: C_NORM = sqrt(2 / 3.0_DP)

  !> Result of an increment.
  type :: linear_return_type
    real(DP) :: stress(6) = 0                      !< [stress]
    real(DP) :: tangent(6, 6) = 0                  !< engineering shears [stress]
    real(DP) :: flow(6) = 0                        !< plastic strain of the increment, tensor components [-]
    real(DP) :: plastic = 0                        !< its equivalent [-]
  end type linear_return_type

  !> The fixed data of an increment.
  type :: linear_problem_type
    real(DP) :: PC(6, 6)                           !< P C, its columns times 1 1 1 2 2 2: of tensor components [stress]
    real(DP) :: start(6)                           !< P C e - d2 a_0 [stress]
    real(DP) :: yield                              !< r0 + d1 p of the start [stress]
    real(DP) :: d1, d2                             !< [stress]
    real(DP) :: w = 0                              !< A t^m dt [-]
    real(DP) :: exponent = 1                       !< n
    logical :: is_viscous = .false.
  end type linear_problem_type

  !> The state of an estimate.
  type :: linear_flow_type
    real(DP) :: b = 0                              !< [1/stress]
    real(DP) :: scaled(6) = 0                      !< S n [stress]
    real(DP) :: S = 0                              !< its size [stress]
    real(DP) :: v(6) = 0                           !< d(S n)/db = -v
    real(DP) :: f = 0                              !< excess over the yield condition [stress]
    real(DP) :: f_b = 0, f_S = 0                   !< its derivatives by b at constant S, and by S
    real(DP) :: db_dz = 1                          !< of the unknown z = b^(1/n)
  end type linear_flow_type

contains

  !> Stress, tangent and state at the end of an increment.
  pure subroutine map_linear_return(constants, C, e, times, is_viscous, state, response, status)
    real(DP), intent(in) :: constants(:)           !< (6) r0, d1, d2, A, n, m; A below 0: no viscosity
    real(DP), intent(in) :: C(6, 6)                !< elasticity in the global axes, engineering shears [stress]
    real(DP), intent(in) :: e(6)                   !< elastic trial strain, engineering shears [-]
    real(DP), intent(in) :: times(2)               !< end and length of the increment [time]
    logical, intent(in) :: is_viscous              !< rates count: it is a VISCO step
    real(DP), intent(inout) :: state(:)            !< in: at the start; out: at the end
    type(linear_return_type), intent(out) :: response
    integer, intent(out) :: status                 !< RETURN_...
    type(linear_problem_type) :: problem
    type(linear_flow_type) :: now
    real(DP) :: D(6, 6), n(6)
    integer :: k
    status = RETURN_OK
    response%stress = matmul(C, e)
    response%tangent = C
    if (.not. is_viscous .and. all(abs(constants(:3)) <= 0)) return   ! creep alone
    problem = pose_problem(constants, C, response%stress, times, is_viscous, state)
    if (problem%is_viscous .and. .not. problem%w > 0) return           ! an infinite viscosity
    call evaluate_flow(problem, 0.0_DP, now)
    if (now%f <= TOL_YIELD * now%S) return
    call solve_flow(problem, now, status)
    if (status /= RETURN_OK) return
    n = now%scaled / now%S
    response%flow = now%b * now%scaled
    response%plastic = C_NORM * now%b * now%S
    D = 0
    do k = 1, 6
      D(k, k) = merge(1.0_DP, 2.0_DP, k <= 3)
    end do
    response%stress = matmul(C, e - matmul(D, response%flow))
    response%tangent = consistent_tangent(problem, now, C, D)
    if (.not. all(ieee_is_finite(response%tangent))) status = RETURN_FAILED
    state(1) = state(1) + response%plastic
    state(2:7) = state(2:7) + response%flow(STATE_ORDER)
    state(8) = state(8) + response%plastic
    state(9:14) = state(9:14) + response%flow(STATE_ORDER)
  end subroutine map_linear_return


  !> The fixed data of the increment.
  pure function pose_problem(constants, C, trial, times, is_viscous, state) result(problem)
    real(DP), intent(in) :: constants(:), C(6, 6)
    real(DP), intent(in) :: trial(6)               !< elastic trial stress [stress]
    real(DP), intent(in) :: times(2)
    logical, intent(in) :: is_viscous
    real(DP), intent(in) :: state(:)
    type(linear_problem_type) :: problem
    real(DP) :: back(6)
    integer :: k
    associate (A => constants(4), n => constants(5), m => constants(6))
      back(STATE_ORDER) = constants(3) * state(9:14)
      problem%start = deviator(trial) - back
      problem%yield = constants(1) + constants(2) * state(8)
      problem%d1 = constants(2)
      problem%d2 = constants(3)
      problem%is_viscous = is_viscous .and. A > 0
      if (problem%is_viscous) then
        problem%exponent = n
        problem%w = A * times(2)
        if (abs(m) > 0) problem%w = problem%w * max(times(1) - times(2), 0.0_DP)**m
        if (.not. problem%w <= huge(problem%w)) problem%is_viscous = .false.   ! t^m of t = 0 and m < 0: no overstress
      end if
      do k = 1, 6
        problem%PC(:, k) = merge(1.0_DP, 2.0_DP, k <= 3) * deviator(C(:, k))
      end do
    end associate
  end function pose_problem


  !> The root of the yield condition.
  pure subroutine solve_flow(problem, now, status)
    type(linear_problem_type), intent(in) :: problem
    type(linear_flow_type), intent(inout) :: now   !< in: without flow; out: at the root
    integer, intent(out) :: status                 !< RETURN_...
    type(root_search_type) :: search
    real(DP) :: high, n
    integer :: i
    n = merge(problem%exponent, 1.0_DP, problem%is_viscous)
    status = RETURN_FAILED
    high = (1 / maxval(abs(problem%PC)))**(1 / n)
    search%scale = high                            ! what rounding of the stress is in the unknown
    if (problem%is_viscous) search%scale = min(high, now%S / (C_NORM * (C_NORM * now%S / problem%w)**(1 / n)))
    do i = 1, MAX_BRACKET_DOUBLINGS
      call evaluate_flow(problem, high, now)
      if (now%f <= 0) exit
      high = 2 * high
    end do
    if (.not. now%f <= 0) return                   ! softening beyond the stiffness
    search%high = high
    search%x = 0.5_DP * high
    do i = 0, MAX_ROOT_ITERATIONS
      call evaluate_flow(problem, search%x, now)
      if (search%is_found) status = RETURN_OK
      if (search%is_found) return
      call improve_root(search, -now%f, -(now%f_b - now%f_S * double_dot(now%scaled, now%v) / now%S) * now%db_dz)
    end do
  end subroutine solve_flow


  !> The excess over the yield condition and its derivatives.
  pure subroutine evaluate_flow(problem, z, now)
    type(linear_problem_type), intent(in) :: problem
    real(DP), intent(in) :: z                      !< b^(1/n), or b without viscosity
    type(linear_flow_type), intent(out) :: now
    real(DP) :: M(6, 6), right(6, 6), overstress, slope
    integer :: k
    now%b = z
    if (problem%is_viscous) then
      now%b = z**problem%exponent
      now%db_dz = problem%exponent * z**(problem%exponent - 1)
    end if
    M = now%b * problem%PC
    do k = 1, 6
      M(k, k) = M(k, k) + 1
    end do
    right = problem%PC
    right(:, 1) = problem%start
    call solve_voigt_system(M, right)
    now%scaled = right(:, 1)
    now%S = sqrt(double_dot(now%scaled, now%scaled))
    M = now%b * problem%PC
    do k = 1, 6
      M(k, k) = M(k, k) + 1
    end do
    right = 0
    right(:, 1) = matmul(problem%PC, now%scaled)
    call solve_voigt_system(M, right)
    now%v = right(:, 1)
    overstress = 0
    slope = 0                                      ! of the overstress by g
    if (problem%is_viscous) then
      overstress = z * (C_NORM * now%S / problem%w)**(1 / problem%exponent)
      slope = overstress / problem%exponent        ! times g
    end if
    now%f = now%S * (1 - problem%d2 * now%b) - C_NORM * (problem%yield + problem%d1 * C_NORM * now%b * now%S + overstress)
    now%f_b = -problem%d2 * now%S - C_NORM**2 * problem%d1 * now%S
    now%f_S = 1 - problem%d2 * now%b - C_NORM**2 * problem%d1 * now%b
    if (problem%is_viscous .and. now%b > 0) then
      now%f_b = now%f_b - C_NORM * slope / now%b
      if (now%S > 0) now%f_S = now%f_S - C_NORM * slope / now%S
    else if (problem%is_viscous) then              ! the slope by z is finite
      now%f_b = now%f_b - C_NORM * (C_NORM * now%S / problem%w)**(1 / problem%exponent)
      now%db_dz = 1
    end if
  end subroutine evaluate_flow


  !> ds/de = C - C D (b d(S n)/de + S n db/de).
  pure function consistent_tangent(problem, now, C, D) result(tangent)
    type(linear_problem_type), intent(in) :: problem
    type(linear_flow_type), intent(in) :: now
    real(DP), intent(in) :: C(6, 6)
    real(DP), intent(in) :: D(6, 6)                !< of tensor components to engineering shears
    real(DP) :: tangent(6, 6)
    real(DP) :: M(6, 6), u(6, 6), n(6), db(6), denominator
    integer :: k
    M = now%b * problem%PC
    do k = 1, 6
      M(k, k) = M(k, k) + 1
      u(:, k) = deviator(C(:, k))
    end do
    call solve_voigt_system(M, u)
    n = now%scaled / now%S
    denominator = now%f_b - now%f_S * double_dot(n, now%v)
    do k = 1, 6
      db(k) = -now%f_S * double_dot(n, u(:, k)) / denominator
      u(:, k) = now%b * u(:, k) + (now%scaled - now%b * now%v) * db(k)
    end do
    tangent = C - matmul(C, matmul(D, u))
  end function consistent_tangent


  !> The deviator of a stress.
  pure function deviator(stress) result(s)
    real(DP), intent(in) :: stress(6)
    real(DP) :: s(6)
    s = stress - sum(stress(:3)) / 3 * VOIGT_IDENTITY
  end function deviator

end module amontons_linear_viscoplasticity
