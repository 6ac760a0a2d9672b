!> Radial return mapping for von Mises plasticity with isotropic and kinematic hardening and creep, and the anisotropic return.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The return scales the deviator of the trial stress (less the back stress): q = q_trial - 3 G (dp + dc) - dk(dp), with the
!! plastic and creep parts dp and dc of the increment and the growth dk of the back stress. Implicit (backward Euler).
!! References: J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), sections 3.3 and 3.6; E. A. de Souza
!! Neto, D. Peric, D. R. J. Owen, Computational Methods for Plasticity (2008), sections 7.3, 7.6, 12.
module amontons_plasticity
  use amontons_kinds, only: DP
  use amontons_scalar_root, only: root_search_type, improve_root, MAX_ROOT_ITERATIONS
  use amontons_materials, only: material_type, hardening_curve_type, evaluate_curves, evaluate_table, CREEP_NONE, &
    CREEP_TIME_HARDENING, CREEP_USER, RATE_NONE, LAW_SAINT_VENANT, HISTORY_PEEQ, HISTORY_CEEQ, MAX_HISTORY
  use amontons_rate_dependent_yield, only: yield_point_type, evaluate_rate_yield, estimate_rate_flow
  use amontons_user_routines, only: creep_type, call_creep, USER_NAME_LENGTH
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none
  private
  public :: return_mapping_type, anisotropic_return_type, map_radial_return, return_to_curve, is_inelastic, &
    RETURN_OK, RETURN_FAILED, &
    evaluate_ramberg_osgood, map_anisotropic_return, solve_voigt_system, creep_strain_difference, TOL_YIELD

  integer, parameter :: RETURN_OK = 0              !< all is well
  integer, parameter :: RETURN_FAILED = 1          !< no solution: hardening below -3 G, or a creep increment too large
  integer, parameter :: MAX_STRESS_HALVINGS = 200  !< of the trial stress, to a bracket of the stress after creep
  real(DP), parameter :: TOL_YIELD = 1.0e-9_DP        !< a smaller relative excess over the yield stress is rounding [-]

  !> Result of the return mapping in an increment.
  type :: return_mapping_type
    real(DP) :: plastic = 0                        !< dp, equivalent plastic strain of the increment [-]
    real(DP) :: creep = 0                          !< dc, equivalent creep strain of the increment [-]
    real(DP) :: back_increment = 0                           !< dk, growth of the back stress in tension [stress]
    real(DP) :: ratio = 1                          !< theta = 1 - 3 G (dp + dc)/q_trial [-]
    real(DP) :: slope = 1                          !< kappa = dq/dq_trial = 1 - 3 G d(dp + dc)/dq_trial [-]
    real(DP) :: flow = 0                           !< equivalent strain of deviatoric flow: dp + dc, or a cone's multiplier [-]
    real(DP) :: expansion = 0                      !< plastic increase of volume [-]
    real(DP) :: dq_dp = 0, dp_dq = 0, dp_dp = 1    !< derivatives of von Mises stress q and pressure p by their trial values [-]
  end type return_mapping_type

  !> Result of the return mapping with anisotropic elasticity.
  type :: anisotropic_return_type
    real(DP) :: plastic = 0                        !< dp, equivalent plastic strain of the increment [-]
    real(DP) :: creep = 0                          !< dc, equivalent creep strain of the increment [-]
    real(DP) :: stress(6) = 0                      !< [stress]
    real(DP) :: tangent(6, 6) = 0                  !< engineering shears [stress]
    real(DP) :: flow(6) = 0                        !< dq/dstress: inelastic strain over dp + dc, engineering shears [-]
    real(DP) :: q = 0                              !< von Mises stress [stress]
  end type anisotropic_return_type

  !> The increment's fixed data, for the scalar equations.
  type :: return_problem_type
    real(DP) :: G, q_trial, temperature, time, dt, p_old, c_old, back_old
    real(DP) :: mean_start                         !< of the mean of time hardening, which ends with the increment [time]
    real(DP) :: creep(3)                           !< A, n, m
    real(DP) :: elapsed                            !< time that rates of plastic strain count by [time]
    type(creep_type) :: user = creep_type()        !< what CREEP gets of the point
  end type return_problem_type

  !> The yield condition evaluated at its unknown: the plastic increment, or that of a rate law.
  type :: yield_residual_type
    real(DP) :: f = 0, df = 0                      !< residual of the yield condition and its slope [stress]
    real(DP) :: back_increment = 0                           !< growth of the back stress in tension [stress]
    real(DP) :: p = 0, dp = 0                      !< plastic increment and its slope [-]
    real(DP) :: c = 0, dc = 0                      !< creep increment and its slope [-]
  end type yield_residual_type

contains

  !> Whether a material has plasticity or creep.
  pure function is_inelastic(material) result(is_true)
    type(material_type), intent(in) :: material
    logical :: is_true
    is_true = allocated(material%isotropic_hardening) .or. allocated(material%kinematic_hardening) &
      .or. material%creep_law /= CREEP_NONE
  end function is_inelastic


  !> The increments of plastic and creep strain for a trial stress.
  !!
  !! | hardening | yield stress | back stress |
  !! |---|---|---|
  !! | isotropic | curve at p | 0 |
  !! | kinematic | first value of the curve | grows by the curve's growth |
  !! | combined | curve of CYCLIC HARDENING at p | grows by the growth of the PLASTIC curve |
  pure subroutine map_radial_return(material, G, q_trial, temperature, times, history_old, solution, status, user)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: G                      !< shear modulus [stress]
    real(DP), intent(in) :: q_trial                !< von Mises stress of trial deviator less back stress [stress]
    real(DP), intent(in) :: temperature            !< [temperature]
    real(DP), intent(in) :: times(4)               !< end and length of the increment of creep, start of the mean of time
                                                   !! hardening, length of the increment for rates of plastic strain [time]
    real(DP), intent(in) :: history_old(MAX_HISTORY)      !< committed
    type(return_mapping_type), intent(out) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    type(creep_type), intent(in), optional :: user !< what CREEP gets of the point
    type(return_problem_type) :: problem
    real(DP) :: slope
    if (has_one_curve(material)) then
      call return_to_curve(material%isotropic_hardening(1), G, q_trial, history_old(HISTORY_PEEQ), solution, status)
      return
    end if
    status = RETURN_OK
    problem = return_problem_type(G=G, q_trial=q_trial, temperature=temperature, time=times(1), dt=times(2), mean_start=times(3), &
      p_old=history_old(HISTORY_PEEQ), c_old=history_old(HISTORY_CEEQ), back_old=0, creep=0, elapsed=times(4))
    if (present(user)) problem%user = user
    if (allocated(material%creep%value)) call evaluate_table(material%creep, temperature, problem%creep)
    if (allocated(material%kinematic_hardening)) call evaluate_curves(material%kinematic_hardening, temperature, problem%p_old, &
      problem%back_old, slope)
    if (material%creep_law /= CREEP_NONE .and. times(2) > 0 .and. q_trial > 0) &
      call solve_creep(material, problem, solution, status)
    solution%flow = solution%creep
    if (status /= RETURN_OK) return
    if (.not. yields(material, problem, q_trial - 3 * G * solution%creep)) return
    call solve_plasticity_and_creep(material, problem, solution, status)
    solution%flow = solution%plastic + solution%creep
  end subroutine map_radial_return


  !> Whether a stress before plastic flow is above the yield stress. A rate law has no flow without time.
  pure logical function yields(material, problem, q)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: q                      !< von Mises stress less back stress [stress]
    type(yield_point_type) :: at
    yields = allocated(material%isotropic_hardening) .or. allocated(material%kinematic_hardening)
    if (material%rate_law /= RATE_NONE) yields = yields .and. problem%elapsed > 0
    if (.not. yields) return
    call evaluate_yield_stress(material, problem, 0.0_DP, at)
    yields = q > at%yield * (1 + TOL_YIELD)
  end function yields


  !> Whether the only inelasticity of a material is isotropic hardening by one curve.
  pure logical function has_one_curve(material)
    type(material_type), intent(in) :: material
    has_one_curve = allocated(material%isotropic_hardening) .and. .not. allocated(material%kinematic_hardening) .and. &
      material%creep_law == CREEP_NONE .and. material%rate_law == RATE_NONE
    if (has_one_curve) has_one_curve = size(material%isotropic_hardening) == 1
  end function has_one_curve


  !> The return with isotropic hardening by one curve: q_trial - 3 G p = y(p_old + p) is linear in each segment of the curve, and
  !! the first segment that contains its root has the solution.
  pure subroutine return_to_curve(curve, G, q_trial, p_old, solution, status)
    type(hardening_curve_type), intent(in) :: curve
    real(DP), intent(in) :: G                      !< shear modulus [stress]
    real(DP), intent(in) :: q_trial                !< von Mises stress of the trial deviator [stress]
    real(DP), intent(in) :: p_old                  !< committed equivalent plastic strain [-]
    type(return_mapping_type), intent(out) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    real(DP) :: slope, yield, p
    integer :: i, n
    logical :: is_elastic
    status = RETURN_OK
    n = size(curve%strain)
    is_elastic = .true.
    do i = 1, n
      slope = 0
      if (i < n) then
        if (curve%strain(i + 1) <= p_old) cycle
        slope = (curve%stress(i + 1) - curve%stress(i)) / (curve%strain(i + 1) - curve%strain(i))
      end if
      yield = curve%stress(i) + slope * (p_old - curve%strain(i))   ! the segment's line at p_old
      if (is_elastic .and. q_trial <= yield * (1 + TOL_YIELD)) return
      is_elastic = .false.
      if (.not. 3 * G + slope > 0) status = RETURN_FAILED
      if (status /= RETURN_OK) return
      p = (q_trial - yield) / (3 * G + slope)
      if (i == n) exit
      if (p_old + p <= curve%strain(i + 1)) exit
    end do
    solution%plastic = p
    solution%flow = p
    solution%ratio = 1 - 3 * G * p / q_trial
    solution%slope = slope / (3 * G + slope)
  end subroutine return_to_curve


  !> Creep without yielding: f(c) = c - dt rate(q_trial - 3 G c) = 0, f ascending, bracketed by 0 and q_trial/(3 G).
  pure subroutine solve_creep(material, problem, solution, status)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    type(return_mapping_type), intent(inout) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    type(root_search_type) :: search
    real(DP) :: c, rate, rate_q, rate_c
    integer :: i
    search%high = problem%q_trial / (3 * problem%G)
    status = RETURN_FAILED
    do i = 0, MAX_ROOT_ITERATIONS
      c = search%x
      call evaluate_creep_rate(material, problem, problem%q_trial - 3 * problem%G * c, c, rate, rate_q, rate_c)
      if (search%is_found) status = RETURN_OK
      if (search%is_found) exit
      call improve_root(search, c - problem%dt * rate, 1 + problem%dt * (3 * problem%G * rate_q - rate_c))
    end do
    solution%creep = c
    solution%ratio = 1 - c / (problem%q_trial / (3 * problem%G))
    solution%slope = 1 - 3 * problem%G * problem%dt * rate_q &
      / (1 + problem%dt * (3 * problem%G * rate_q - rate_c))
  end subroutine solve_creep


  !> Yielding, with creep at the stress on the yield surface:
  !! f(p) = q_trial - 3 G (p + c(p)) - y(p) - k(p) = 0, f descending, bracketed by 0 and q_trial/(3 G). Rate laws have an
  !! unknown x in place of p, whose rounding is that of the stress over its slope.
  pure subroutine solve_plasticity_and_creep(material, problem, solution, status)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    type(return_mapping_type), intent(inout) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    type(root_search_type) :: search
    type(yield_residual_type) :: r
    integer :: i
    search%high = problem%q_trial / (3 * problem%G)
    search%scale = search%high                     ! rounding of the stresses
    if (material%rate_law /= RATE_NONE) call estimate_rate_flow(material, problem%temperature, problem%elapsed, problem%p_old, &
      [problem%q_trial, 3 * problem%G], search%x, search%high)
    status = RETURN_FAILED
    do i = 0, MAX_ROOT_ITERATIONS
      r = evaluate_yield_residual(material, problem, search%x)
      if (search%is_found) status = RETURN_OK
      if (search%is_found) exit
      if (.not. r%df < 0) return
      if (material%rate_law /= RATE_NONE) search%scale = -problem%q_trial / r%df
      call improve_root(search, -r%f, -r%df)
    end do
    solution%plastic = r%p
    solution%creep = r%c
    solution%back_increment = r%back_increment
    solution%ratio = 1 - (r%p + r%c) / (problem%q_trial / (3 * problem%G))
    solution%slope = 1 + 3 * problem%G * (r%dp + r%dc) / r%df
  end subroutine solve_plasticity_and_creep


  !> Residual of the yield condition and its slope at its unknown, and the corresponding creep.
  pure function evaluate_yield_residual(material, problem, x) result(r)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: x                      !< plastic increment, or unknown of the rate law
    type(yield_residual_type) :: r
    type(yield_point_type) :: at
    real(DP) :: back_slope
    call evaluate_yield_stress(material, problem, x, at)
    r%p = at%p
    r%dp = at%dp
    back_slope = 0
    if (allocated(material%kinematic_hardening)) then
      call evaluate_curves(material%kinematic_hardening, problem%temperature, problem%p_old + r%p, r%back_increment, back_slope)
      r%back_increment = r%back_increment - problem%back_old
    end if
    call evaluate_creep_increment(material, problem, at%yield, at%slope, r%c, r%dc)
    r%f = problem%q_trial - 3 * problem%G * (r%p + r%c) - at%yield - r%back_increment
    r%df = -3 * problem%G * (r%dp + r%dc) - at%slope - back_slope * r%dp
  end function evaluate_yield_residual


  !> The plastic increment and the size of the yield surface after it.
  pure subroutine evaluate_yield_stress(material, problem, x, at)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: x                      !< plastic increment, or unknown of the rate law
    type(yield_point_type), intent(out) :: at
    if (material%rate_law /= RATE_NONE) then
      call evaluate_rate_yield(material, problem%temperature, problem%elapsed, problem%p_old, x, at)
      return
    end if
    at%p = x
    at%dp = 1
    if (allocated(material%isotropic_hardening)) then
      call evaluate_curves(material%isotropic_hardening, problem%temperature, problem%p_old + x, at%yield, at%slope)
    else
      call evaluate_curves(material%kinematic_hardening, problem%temperature, 0.0_DP, at%yield, at%slope)
      at%slope = 0
    end if
  end subroutine evaluate_yield_stress


  !> The creep increment at a given stress, and its derivative by the plastic increment: c - dt rate(q, c) = 0, at once where the
  !! rate does not depend on c. Not a number where there is none.
  pure subroutine evaluate_creep_increment(material, problem, q, q_slope, c, dc)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: q, q_slope             !< stress and its derivative [stress]
    real(DP), intent(out) :: c, dc                 !< [-]
    type(root_search_type) :: search
    real(DP) :: rate, rate_q, rate_c
    integer :: i
    c = 0
    dc = 0
    if (material%creep_law == CREEP_NONE .or. .not. problem%dt > 0) return
    do i = 1, MAX_ROOT_ITERATIONS
      call evaluate_creep_rate(material, problem, q, search%x, rate, rate_q, rate_c)
      call improve_root(search, search%x - problem%dt * rate, 1 - problem%dt * rate_c)
      if (search%is_found) exit
    end do
    c = search%x
    if (.not. search%is_found) c = ieee_value(c, ieee_quiet_nan)
    dc = problem%dt * rate_q * q_slope / (1 - problem%dt * rate_c)
  end subroutine evaluate_creep_increment


  !> The rate of creep and its derivatives by stress and by the creep strain of the increment.
  !! Time hardening A q^n t^m, its mean from mean_start to the end of the increment (if both are one: there); strain hardening
  !! (A q^n ((m + 1) c)^m)^(1/(m + 1)), here in the integrated form
  !! dc/dt = (C(t_s + dt) - C(t_s))/dt with C(t) = A q^n t^(m+1)/(m + 1) and t_s such that C(t_s) = c_old.
  pure subroutine evaluate_creep_rate(material, problem, q, c, rate, rate_q, rate_c)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: q                      !< von Mises stress [stress]
    real(DP), intent(in) :: c                      !< creep strain of the increment [-]
    real(DP), intent(out) :: rate                  !< [1/time]
    real(DP), intent(out) :: rate_q                !< d rate/dq
    real(DP), intent(out) :: rate_c                !< d rate/dc
    real(DP) :: s, before, k, virtual
    rate = 0
    rate_q = 0
    rate_c = 0
    if (.not. q > 0 .or. c < 0) return
    if (material%creep_law == CREEP_USER) then
      call evaluate_user_rate(material, problem, q, c, rate, rate_q, rate_c)
      return
    end if
    associate (A => problem%creep(1), n => problem%creep(2), m => problem%creep(3), time => problem%time, dt => problem%dt)
      s = A * q**n
      k = m + 1
      if (abs(m) <= epsilon(m)) then
        rate = s
        rate_q = n * s / q
      else if (material%creep_law == CREEP_TIME_HARDENING) then
        before = max(problem%mean_start, 0.0_DP)
        rate = s * time**m
        if (before < time) rate = s * (time**k - before**k) / (k * (time - before))
        rate_q = n * rate / q
      else
        virtual = (problem%c_old * k / s)**(1 / k)
        rate = (s / k * (virtual + dt)**k - problem%c_old) / dt
        ! d virtual/dq = -(n/(k q)) virtual
        rate_q = (n * s / (k * q) * (virtual + dt)**k - s * (virtual + dt)**m * n * virtual / (k * q)) / dt
      end if
    end associate
  end subroutine evaluate_creep_rate


  !> The rate by the routine CREEP; not a number where the routine ends the job.
  pure subroutine evaluate_user_rate(material, problem, q, c, rate, rate_q, rate_c)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: q                      !< von Mises stress [stress]
    real(DP), intent(in) :: c                      !< creep strain of the increment [-]
    real(DP), intent(out) :: rate                  !< [1/time]
    real(DP), intent(out) :: rate_q                !< d rate/dq
    real(DP), intent(out) :: rate_c                !< d rate/dc
    type(creep_type) :: values
    character(USER_NAME_LENGTH) :: name
    name = material%name
    values = problem%user
    values%qtild = q
    values%ec = [problem%c_old, problem%c_old + c]
    values%dtime = problem%dt
    call call_creep(material%routines, name, values)
    rate = values%decra(1) / problem%dt
    rate_q = values%decra(5) / problem%dt
    rate_c = values%decra(2) / problem%dt
    if (values%is_accepted == 0) rate = ieee_value(rate, ieee_quiet_nan)
  end subroutine evaluate_user_rate


  !> What CETOL limits: the difference of the creep strains of an increment by the conditions at its end and at its start [-].
  !!
  !! | law | by |
  !! |---|---|
  !! | LAW_SAINT_VENANT, as CalculiX | the rates of the two instants; a rate at the start without creep before it counts as zero |
  !! | CREEP_USER | the increments that CREEP gives for the stresses of the two instants |
  !! | other | the stresses of the two instants, with t or e integrated: a constant stress has none |
  pure function creep_strain_difference(material, temperature, times, c, q, user) result(difference)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: temperature(2)         !< at the start and at the end [temperature]
    real(DP), intent(in) :: times(2)               !< end and length of the increment [time]
    real(DP), intent(in) :: c(2)                   !< creep strains at the start and at the end [-]
    real(DP), intent(in) :: q(2)                   !< von Mises stresses, likewise [stress]
    type(creep_type), intent(in), optional :: user !< what CREEP gets of the point
    real(DP) :: difference
    type(return_problem_type) :: problem
    real(DP) :: strain(2), unused(2)
    integer :: i
    strain = 0
    do i = 1, 2
      if (.not. (q(i) > 0 .and. times(2) > 0)) cycle
      problem = return_problem_type(G=0, q_trial=0, temperature=temperature(i), time=times(1), dt=times(2), &
        mean_start=times(1) - times(2), p_old=0, c_old=c(1), back_old=0, creep=0, elapsed=times(2))
      if (present(user)) problem%user = user
      if (allocated(material%creep%value)) call evaluate_table(material%creep, temperature(i), problem%creep)
      if (material%law == LAW_SAINT_VENANT .and. material%creep_law /= CREEP_USER) then
        if (i == 1) problem%time = problem%mean_start
        strain(i) = times(2) * instantaneous_rate(material, problem, q(i), c(i))
      else
        call evaluate_creep_increment(material, problem, q(i), 0.0_DP, strain(i), unused(1))
      end if
    end do
    difference = abs(strain(2) - strain(1))
  end function creep_strain_difference


  !> The rate of creep at an instant: A q^n t^m, or (A q^n ((m + 1) c)^m)^(1/(m + 1)); zero where creep only begins and m < 0.
  pure real(DP) function instantaneous_rate(material, problem, q, c) result(rate)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: q                      !< von Mises stress [stress]
    real(DP), intent(in) :: c                      !< creep strain [-]
    associate (A => problem%creep(1), n => problem%creep(2), m => problem%creep(3), time => problem%time)
      rate = 0
      if (abs(m) <= epsilon(m)) then
        rate = A * q**n
      else if (material%creep_law == CREEP_TIME_HARDENING) then
        if (time > 0) rate = A * q**n * time**m
      else if (c > 0) then
        rate = (A * q**n * ((m + 1) * c)**m)**(1 / (m + 1))
      end if
    end associate
  end function instantaneous_rate


  !> Ramberg and Osgood's law, in tension E e = q + alpha q (q/s)^(n-1), for deviators: the stress q of the equivalent
  !! strain q/(3 G) + alpha q (q/s)^(n-1)/E.
  pure subroutine evaluate_ramberg_osgood(constants, G, strain, ratio, slope, status)
    real(DP), intent(in) :: constants(5)           !< E, nu, yield stress s, n, alpha
    real(DP), intent(in) :: G                      !< shear modulus [stress]
    real(DP), intent(in) :: strain                 !< sqrt(2/3 e:e) of the deviator of the strain [-]
    real(DP), intent(out) :: ratio                 !< q over 3 G strain [-]
    real(DP), intent(out) :: slope                 !< dq/dstrain over 3 G [-]
    integer, intent(out) :: status                 !< RETURN_...
    type(root_search_type) :: search
    real(DP) :: q, power
    integer :: i
    ratio = 1
    slope = 1
    status = RETURN_OK
    if (.not. strain > 0) return
    associate (E => constants(1), s => constants(3), n => constants(4), alpha => constants(5))
      search%high = 3 * G * strain
      search%x = min(search%high, s * (strain * E / (alpha * s))**(1 / n))
      status = RETURN_FAILED
      do i = 0, MAX_ROOT_ITERATIONS
        q = search%x
        power = alpha * (q / s)**(n - 1) / E
        if (search%is_found) status = RETURN_OK
        if (search%is_found) exit
        call improve_root(search, q / (3 * G) + power * q - strain, 1 / (3 * G) + n * power)
      end do
      ratio = q / (3 * G * strain)
      slope = 1 / (1 + 3 * G * n * power)
    end associate
  end subroutine evaluate_ramberg_osgood


  !> Von Mises's flow with isotropic hardening, creep and any elasticity C: with the deviatoric projection P, the equivalent
  !! inelastic strain w = dp + dc and g = 3 w/(2 q)
  !!
  !!     stress = B e,   B = (1 + g C P)^-1 C,   e the elastic trial strain
  !!
  !! one equation f(x) = q(stress) - q(x) = 0, f descending. Creep alone: x is q, and w = dc(q). Yielding: x is dp, q the yield
  !! stress y(p + dp), and w = dp + dc(y); a rate law has its own x. The tangent is B less a product of B P stress with itself,
  !! symmetric.
  pure subroutine map_anisotropic_return(material, C, e, temperature, times, history_old, solution, status)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: C(6, 6)                !< elasticity, engineering shears [stress]
    real(DP), intent(in) :: e(6)                   !< elastic trial strain, engineering shears [-]
    real(DP), intent(in) :: temperature            !< [temperature]
    real(DP), intent(in) :: times(4)               !< end and length of the increment of creep, start of the mean of time
                                                   !! hardening, length of the increment for rates of plastic strain [time]
    real(DP), intent(in) :: history_old(MAX_HISTORY)      !< committed
    type(anisotropic_return_type), intent(out) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    type(return_problem_type) :: problem
    status = RETURN_OK
    problem = return_problem_type(G=0, q_trial=0, temperature=temperature, time=times(1), dt=times(2), mean_start=times(3), &
      p_old=history_old(HISTORY_PEEQ), c_old=history_old(HISTORY_CEEQ), back_old=0, creep=0, elapsed=times(4))
    call set_anisotropic_stress(C, e, 0.0_DP, solution)
    problem%q_trial = solution%q
    if (material%creep_law /= CREEP_NONE .and. times(2) > 0 .and. problem%q_trial > 0) then
      if (allocated(material%creep%value)) call evaluate_table(material%creep, temperature, problem%creep)
      call solve_anisotropic_flow(material, problem, C, e, .false., solution, status)
    end if
    if (status /= RETURN_OK) return
    if (yields(material, problem, solution%q)) call solve_anisotropic_flow(material, problem, C, e, .true., solution, status)
  end subroutine map_anisotropic_return


  !> f(x) = 0: x between 0 and the trial's q for creep alone, above 0 for yielding.
  pure subroutine solve_anisotropic_flow(material, problem, C, e, is_yielding, solution, status)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: C(6, 6), e(6)
    logical, intent(in) :: is_yielding             !< else creep alone
    type(anisotropic_return_type), intent(inout) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    type(root_search_type) :: search
    real(DP) :: f, df, unused
    integer :: i
    search%scale = merge(norm2(e), problem%q_trial, is_yielding)        ! what rounding is measured by
    if (is_yielding .and. material%rate_law /= RATE_NONE) call estimate_rate_flow(material, problem%temperature, problem%elapsed, &
      problem%p_old, [problem%q_trial, dot_product(solution%flow, matmul(C, solution%flow))], search%x, unused)
    status = RETURN_FAILED
    if (.not. is_yielding) then                    ! within a factor of two: a rate may relax nearly all of the stress
      search%high = problem%q_trial
      do i = 1, MAX_STRESS_HALVINGS
        search%x = 0.5_DP * search%high
        call evaluate_anisotropic_flow(material, problem, C, e, search%x, is_yielding, solution, f, df)
        if (f >= 0) exit
        search%high = search%x
      end do
      search%low = search%x
      search%x = search%high
    end if
    call evaluate_anisotropic_flow(material, problem, C, e, search%x, is_yielding, solution, f, df)
    do i = 1, MAX_ROOT_ITERATIONS
      if (.not. df < 0) return
      if (is_yielding .and. material%rate_law /= RATE_NONE) search%scale = -norm2(matmul(C, e)) / df
      call improve_root(search, -f, -df)
      call evaluate_anisotropic_flow(material, problem, C, e, search%x, is_yielding, solution, f, df)
      if (.not. search%is_found) cycle
      status = RETURN_OK
      return
    end do
  end subroutine solve_anisotropic_flow


  !> Stress and tangent at x, and the residual of its equation.
  pure subroutine evaluate_anisotropic_flow(material, problem, C, e, x, is_yielding, solution, f, df)
    type(material_type), intent(in) :: material
    type(return_problem_type), intent(in) :: problem
    real(DP), intent(in) :: C(6, 6), e(6)
    real(DP), intent(in) :: x                      !< von Mises stress [stress], or unknown of the yield condition
    logical, intent(in) :: is_yielding
    type(anisotropic_return_type), intent(inout) :: solution
    real(DP), intent(out) :: f, df                 !< residual [stress] and its slope
    type(yield_point_type) :: at
    real(DP) :: creep, creep_slope, w, g, g_slope, Bn(6)
    integer :: k
    at = yield_point_type(yield=x, slope=1)
    if (is_yielding) call evaluate_yield_stress(material, problem, x, at)
    call evaluate_creep_increment(material, problem, at%yield, at%slope, creep, creep_slope)
    solution%plastic = at%p
    solution%creep = creep
    w = solution%plastic + creep
    g = 0
    g_slope = 0
    if (at%yield > 0) then
      g = 1.5_DP * w / at%yield
      g_slope = 1.5_DP * (at%dp + creep_slope - w * at%slope / at%yield) / at%yield
    end if
    call set_anisotropic_stress(C, e, g, solution)
    Bn = matmul(solution%tangent, solution%flow)
    f = solution%q - at%yield
    df = -g_slope * solution%q / 1.5_DP * dot_product(solution%flow, Bn) - at%slope
    do k = 1, 6
      solution%tangent(:, k) = solution%tangent(:, k) + (g_slope * solution%q / (1.5_DP * df) * Bn(k)) * Bn
    end do
  end subroutine evaluate_anisotropic_flow


  !> The stress B e of a given g with its von Mises stress and direction of flow, and B as its tangent.
  pure subroutine set_anisotropic_stress(C, e, g, solution)
    real(DP), intent(in) :: C(6, 6), e(6)
    real(DP), intent(in) :: g                      !< 3 w/(2 q) [1/stress]
    type(anisotropic_return_type), intent(inout) :: solution
    real(DP) :: M(6, 6)
    integer :: k
    do k = 1, 6
      M(k, :) = g * deviatoric(C(k, :))            ! C is symmetric: rows of C P
      M(k, k) = M(k, k) + 1
    end do
    solution%tangent = C
    call solve_voigt_system(M, solution%tangent)
    solution%stress = matmul(solution%tangent, e)
    solution%q = sqrt(1.5_DP * dot_product(solution%stress, deviatoric(solution%stress)))
    solution%flow = 0
    if (solution%q > 0) solution%flow = 1.5_DP / solution%q * deviatoric(solution%stress)
  end subroutine set_anisotropic_stress


  !> P: the deviator of a stress with its shears doubled, so that its product with a stress is one of tensors.
  pure function deviatoric(stress) result(s)
    real(DP), intent(in) :: stress(6)
    real(DP) :: s(6)
    s(:3) = stress(:3) - sum(stress(:3)) / 3
    s(4:) = 2 * stress(4:)
  end function deviatoric


  !> B becomes M^-1 B, by Gaussian elimination with row exchange; M is overwritten.
  pure subroutine solve_voigt_system(M, B)
    real(DP), intent(inout) :: M(6, 6), B(6, 6)
    real(DP) :: row(6), factor
    integer :: i, k, pivot
    do k = 1, 6
      pivot = k - 1 + maxloc(abs(M(k:, k)), dim=1)
      row = M(k, :)
      M(k, :) = M(pivot, :)
      M(pivot, :) = row
      row = B(k, :)
      B(k, :) = B(pivot, :)
      B(pivot, :) = row
      do i = 1, 6
        if (i == k) cycle
        factor = M(i, k) / M(k, k)
        M(i, :) = M(i, :) - factor * M(k, :)
        B(i, :) = B(i, :) - factor * B(k, :)
      end do
    end do
    do k = 1, 6
      B(k, :) = B(k, :) / M(k, k)
    end do
  end subroutine solve_voigt_system

end module amontons_plasticity
