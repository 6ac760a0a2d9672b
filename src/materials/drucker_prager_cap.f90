!> Return mapping for the modified Drucker-Prager model with a cap: shear failure, transition and compaction.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! With the von Mises stress q, the pressure p, b = tan(beta), the cap's yield stress p_b(v) in isotropic compression, v the plastic
!! compaction, p_a = (p_b - R d)/(1 + R b), D = d + p_a b and m = 1 + alpha - alpha/cos(beta):
!!
!! | surface | where | yield | flow along the gradient of |
!! |---|---|---|---|
!! | shear failure | p < p_a - alpha D sin(beta) | q = d + p b | ((p_a - p) b)^2 + (q/m)^2 |
!! | transition | up to p_a | q = (1 - alpha/cos(beta)) D + sqrt((alpha D)^2 - (p - p_a)^2) | the same |
!! | cap | p > p_a | sqrt((p - p_a)^2 + (R q/m)^2) = R D | its own |
!!
!! so that a multiplier k gives the plastic shear k q and the compaction k c (p - p_a), c = (m b)^2 or (m/R)^2. Backward Euler:
!! q = y q_trial with y = 1/(1 + 3 G k); the compaction follows from one equation and has the sign of p_trial - p_a of the start,
!! which decides between both potentials. One equation for y from 0 to 1 is left. Flow is not associated but on the cap.
!! Reference: Abaqus Theory Manual, section 4.4.4 (K = 1).
module amontons_drucker_prager_cap
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, evaluate_curves, evaluate_table
  use amontons_plasticity, only: return_mapping_type, RETURN_OK, RETURN_FAILED, TOL_YIELD
  use amontons_scalar_root, only: root_search_type, improve_root, MAX_ROOT_ITERATIONS
  implicit none
  private
  public :: map_cap_return, N_CAP_CONSTANTS

  integer, parameter :: N_CAP_CONSTANTS = 5        !< beta [rad], d [stress], R, initial compaction, alpha [-]

  !> The fixed data of an increment.
  type :: cap_problem_type
    real(DP) :: G, K                               !< shear and bulk modulus [stress]
    real(DP) :: q_trial, p_trial                   !< [stress]
    real(DP) :: argument                           !< temperature, or the field variable that the tables are over
    real(DP) :: v_old                              !< compaction at the start, with the initial one [-]
    real(DP) :: beta, friction                     !< angle [rad] and its tangent [-]
    real(DP) :: d                                  !< cohesion [stress]
    real(DP) :: R, alpha, m                        !< [-]
    real(DP) :: c                                  !< compaction over k (p - p_a) [-]
    logical :: is_cap                              !< p_trial > p_a
  end type cap_problem_type

  !> The state of an estimate y.
  type :: cap_state_type
    real(DP) :: dv = 0                             !< compaction of the increment [-]
    real(DP) :: dv_dy = 0, dv_dp = 0               !< by y, and by p_trial at constant y
    real(DP) :: f = 0                              !< excess over the yield surface [stress]
    real(DP) :: f_q = 0                            !< its derivative by q [-]
    real(DP) :: f_v = 0                            !< by the compaction, at constant trial values [stress]
    real(DP) :: f_p = 0                            !< by the pressure alone [-]
  end type cap_state_type

contains

  !> The plastic strain of the increment and the derivatives of the stress, for a trial stress.
  pure subroutine map_cap_return(material, moduli, trial, argument, v_old, solution, status)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: moduli(2)              !< shear and bulk modulus [stress]
    real(DP), intent(in) :: trial(2)               !< von Mises stress and pressure of the trial stress [stress]
    real(DP), intent(in) :: argument               !< temperature, or the field variable that the tables are over
    real(DP), intent(in) :: v_old                  !< committed plastic compaction [-]
    type(return_mapping_type), intent(out) :: solution   !< plastic: the growth of the compaction, which may be negative
    integer, intent(out) :: status                 !< RETURN_...
    type(cap_problem_type) :: problem
    type(cap_state_type) :: state
    type(root_search_type) :: search
    real(DP) :: y, df_dy, dy_dq, dy_dp
    integer :: i
    call pose_problem(material, moduli, trial, argument, v_old, problem)
    call evaluate_cap(material, problem, 1.0_DP, state, status)
    if (state%f <= TOL_YIELD * (problem%d + abs(problem%p_trial) + problem%q_trial)) return
    search%x = 1
    search%high = 1
    search%scale = 1
    do i = 0, MAX_ROOT_ITERATIONS
      y = search%x
      call evaluate_cap(material, problem, y, state, status)
      if (status /= RETURN_OK) return
      df_dy = state%f_q * problem%q_trial + state%f_v * state%dv_dy
      if (search%is_found) exit
      status = RETURN_FAILED
      if (.not. df_dy > 0) return                  ! softening beyond the stiffness
      call improve_root(search, state%f, df_dy)
      search%x = max(search%x, 0.01_DP * y)        ! 0 is an infinite multiplier
    end do
    if (.not. (search%is_found .and. df_dy > 0)) return
    dy_dq = -state%f_q * y / df_dy
    dy_dp = -(state%f_p + state%f_v * state%dv_dp) / df_dy
    solution%plastic = state%dv
    solution%flow = (1 - y) * problem%q_trial / (3 * problem%G)
    solution%expansion = -state%dv
    solution%ratio = y
    solution%slope = y + problem%q_trial * dy_dq
    solution%dq_dp = problem%q_trial * dy_dp
    solution%dp_dq = -problem%K * state%dv_dy * dy_dq
    solution%dp_dp = 1 - problem%K * (state%dv_dp + state%dv_dy * dy_dp)
  end subroutine map_cap_return


  !> The fixed data.
  pure subroutine pose_problem(material, moduli, trial, argument, v_old, problem)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: moduli(2), trial(2), argument, v_old
    type(cap_problem_type), intent(out) :: problem
    real(DP) :: values(N_CAP_CONSTANTS), p_a, slope
    call evaluate_table(material%cone, argument, values)
    problem%G = moduli(1)
    problem%K = moduli(2)
    problem%q_trial = trial(1)
    problem%p_trial = trial(2)
    problem%argument = argument
    problem%beta = values(1)
    problem%friction = tan(values(1))
    problem%d = values(2)
    problem%R = values(3)
    problem%v_old = v_old + values(4)
    problem%alpha = values(5)
    problem%m = 1 + problem%alpha - problem%alpha / cos(problem%beta)
    call find_cap(material, problem, 0.0_DP, p_a, slope)
    problem%is_cap = problem%p_trial > p_a
    problem%c = (problem%m * problem%friction)**2
    if (problem%is_cap) problem%c = (problem%m / problem%R)**2
  end subroutine pose_problem


  !> p_a and its slope after a compaction.
  pure subroutine find_cap(material, problem, dv, p_a, slope)
    type(material_type), intent(in) :: material
    type(cap_problem_type), intent(in) :: problem
    real(DP), intent(in) :: dv                     !< of the increment [-]
    real(DP), intent(out) :: p_a, slope            !< [stress]
    call evaluate_curves(material%isotropic_hardening, problem%argument, problem%v_old + dv, p_a, slope)
    if (problem%v_old + dv < 0) slope = 0          ! the curve is constant before its first point
    p_a = (p_a - problem%R * problem%d) / (1 + problem%R * problem%friction)
    slope = slope / (1 + problem%R * problem%friction)
  end subroutine find_cap


  !> Compaction and excess over the yield surface at y.
  pure subroutine evaluate_cap(material, problem, y, state, status)
    type(material_type), intent(in) :: material
    type(cap_problem_type), intent(in) :: problem
    real(DP), intent(in) :: y                      !< above 0 [-]
    type(cap_state_type), intent(out) :: state
    integer, intent(out) :: status                 !< RETURN_...
    real(DP) :: p_a, slope, w, w_y, p, f_pa, k, k_y
    k = (1 / y - 1) / (3 * problem%G)
    k_y = -1 / (3 * problem%G * y**2)
    w = k * problem%c / (1 + k * problem%c * problem%K)
    w_y = k_y * problem%c / (1 + k * problem%c * problem%K)**2
    call solve_compaction(material, problem, w, state%dv, p_a, slope, status)
    if (status /= RETURN_OK) return
    state%dv_dy = w_y * (problem%p_trial - p_a) / (1 + w * slope)
    state%dv_dp = w / (1 + w * slope)
    p = problem%p_trial - problem%K * state%dv
    call evaluate_surface(problem, p, y * problem%q_trial, p_a, state%f, state%f_q, state%f_p, f_pa)
    state%f_v = f_pa * slope - problem%K * state%f_p
  end subroutine evaluate_cap


  !> dv = w (p_trial - p_a(dv)), ascending: between 0 and the value at constant p_a.
  pure subroutine solve_compaction(material, problem, w, dv, p_a, slope, status)
    type(material_type), intent(in) :: material
    type(cap_problem_type), intent(in) :: problem
    real(DP), intent(in) :: w                      !< [1/stress]
    real(DP), intent(out) :: dv, p_a, slope        !< p_a and its slope there
    integer, intent(out) :: status                 !< RETURN_...
    type(root_search_type) :: search
    integer :: i
    status = RETURN_OK
    call find_cap(material, problem, 0.0_DP, p_a, slope)
    dv = w * (problem%p_trial - p_a)
    if (.not. abs(dv) > 0) return
    search%low = min(0.0_DP, dv)
    search%high = max(0.0_DP, dv)
    search%scale = w * max(abs(problem%p_trial), abs(p_a))   ! what rounding of the pressure is in the compaction
    do i = 0, MAX_ROOT_ITERATIONS
      dv = search%x
      call find_cap(material, problem, dv, p_a, slope)
      if (search%is_found) return
      call improve_root(search, dv - w * (problem%p_trial - p_a), 1 + w * slope)
    end do
    status = RETURN_FAILED
  end subroutine solve_compaction


  !> The excess over the yield surface and its derivatives.
  pure subroutine evaluate_surface(problem, p, q, p_a, f, f_q, f_p, f_pa)
    type(cap_problem_type), intent(in) :: problem
    real(DP), intent(in) :: p, q, p_a              !< [stress]
    real(DP), intent(out) :: f                     !< [stress]
    real(DP), intent(out) :: f_q, f_p, f_pa        !< [-]
    real(DP) :: D, s
    D = problem%d + p_a * problem%friction
    f_pa = 0
    if (problem%is_cap) then
      s = sqrt((p - p_a)**2 + (problem%R * q / problem%m)**2)
      f = s - problem%R * D
      s = max(s, tiny(s))
      f_q = (problem%R / problem%m)**2 * q / s
      f_p = (p - p_a) / s
      f_pa = -f_p - problem%R * problem%friction
    else if (p < p_a - problem%alpha * D * sin(problem%beta) .or. .not. problem%alpha > 0) then
      f = q - p * problem%friction - problem%d
      f_q = 1
      f_p = -problem%friction
    else
      s = sqrt((problem%alpha * D)**2 - (p - p_a)**2)
      f = q - (1 - problem%alpha / cos(problem%beta)) * D - s
      f_q = 1
      f_p = (p - p_a) / s
      f_pa = -(1 - problem%alpha / cos(problem%beta)) * problem%friction - (problem%alpha**2 * D * problem%friction + p - p_a) / s
    end if
  end subroutine evaluate_surface

end module amontons_drucker_prager_cap
