!> Return mapping in principal stresses for laws of the pressure and the Lode angle: Drucker-Prager with K, Mohr-Coulomb.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Yield t_y(s) - p tan(phi) = d(e), with the sections t of `deviatoric_section`. The plastic strain is mu n + v 1/3, n the
!! gradient of the section t of the flow potential, v the increase of volume:
!!
!! | law | t_y | t | v | growth of e |
!! |---|---|---|---|---|
!! | Drucker-Prager with K | by K | the same | mu tan(psi) | c mu, c by the test of the hardening curve |
!! | Mohr-Coulomb | hexagon | Menetrey and Willam's | mu tan(psi) sqrt(1 + (a/t)^2), a = eps c tan(psi) | plastic work over d |
!!
!! One equation for y = 1/(1 + 3 G mu/t) from 0 to 1 is left, with the deviator of `return_deviator`. Where the cone ends at an apex
!! (a = 0), a pure increase of volume acts there beside mu, as in `drucker_prager`; else the hyperbola meets the axis at a right
!! angle, and the flow is unique everywhere, at the corners of the hexagon, too; c
!! is the first cohesion. Implicit (backward Euler).
!! References: Abaqus Theory Manual, sections 4.4.2 (K) and 4.4.5 (Mohr-Coulomb).
module amontons_lode_angle_return
  use amontons_kinds, only: DP
  use amontons_deviatoric_section, only: deviatoric_section_type, deviator_return_type, evaluate_section, return_deviator, &
    lode_axes, lode_angle, SECTION_RATIO, SECTION_MENETREY_WILLAM, SECTION_MOHR_COULOMB
  use amontons_materials, only: material_type, evaluate_curves, evaluate_table, YIELD_MOHR_COULOMB
  use amontons_drucker_prager, only: hardening_factor
  use amontons_plasticity, only: RETURN_OK, RETURN_FAILED, TOL_YIELD
  use amontons_scalar_root, only: root_search_type, improve_root, MAX_ROOT_ITERATIONS
  implicit none
  private
  public :: principal_return_type, map_principal_return

  !> Result of the return mapping in an increment.
  type :: principal_return_type
    real(DP) :: plastic = 0                         !< growth of the equivalent plastic strain [-]
    real(DP) :: tau(3) = 0                          !< principal stresses, in the order of the trial ones [stress]
    real(DP) :: flow(3) = 0                         !< plastic strains of the increment [-]
    real(DP) :: slope(3, 3) = 0                     !< tau by the trial strains [stress]
    real(DP) :: secant(3) = 0                       !< (tau_A - tau_B)/(e_A - e_B) of pairs (1, 2), (2, 3), (3, 1) [stress]
  end type principal_return_type

  !> The increment's fixed data.
  type :: problem_type
    real(DP) :: G, K                                !< shear and bulk modulus [stress]
    real(DP) :: rho, theta, p                       !< trial stress: |s|, Lode angle, pressure [stress, rad, stress]
    real(DP) :: argument                            !< temperature, or the field variable that the tables are over
    real(DP) :: e_old                               !< committed equivalent plastic strain [-]
    type(deviatoric_section_type) :: yield, flow
    real(DP) :: friction, dilation                  !< tan of both angles [-]
    real(DP) :: vertex = 0                          !< a of the hyperbola [stress]
    real(DP) :: cohesion_factor = 1                 !< d over the stress of the hardening curve [-]
    real(DP) :: strain_factor = 1                   !< growth of e over mu; Mohr-Coulomb: at the apex [-]
    logical :: is_work_hardening = .false.          !< e grows by the plastic work over d
  end type problem_type

  !> The state after a flow of given y. Derivatives by the trial deviator along e and across it, by p_trial and by y.
  type :: flow_state_type
    type(deviator_return_type) :: deviator
    real(DP) :: volume = 0, dvolume(4) = 0          !< plastic increase of volume v [-]
    real(DP) :: growth = 0, dgrowth(4) = 0          !< of e [-]
    real(DP) :: f = 0, df(4) = 0                    !< excess over the yield surface [stress]
    real(DP) :: d = 0                               !< cohesion [stress]
  end type flow_state_type

contains

  !> The plastic strain of the increment, and stress and slopes, for a trial stress.
  pure subroutine map_principal_return(material, moduli, trial, argument, e_old, response, status)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: moduli(2)               !< shear and bulk modulus [stress]
    real(DP), intent(in) :: trial(3)                !< principal stresses [stress]
    real(DP), intent(in) :: argument                !< temperature, or the field variable that the tables are over
    real(DP), intent(in) :: e_old                   !< committed equivalent plastic strain [-]
    type(principal_return_type), intent(out) :: response   !< not set beside plastic = 0 if the trial stress does not yield
    integer, intent(out) :: status                  !< RETURN_...
    type(problem_type) :: problem
    type(flow_state_type) :: state
    real(DP) :: s(3)
    integer :: order(3)
    problem = pose_problem(material, moduli, argument, e_old)
    order(1) = maxloc(trial, dim=1)
    order(3) = modulo(order(1), 3) + 1
    order(2) = modulo(order(1) + 1, 3) + 1
    if (trial(order(3)) > trial(order(2))) order(2:3) = order([3, 2])
    problem%p = -sum(trial) / 3
    s = trial(order) + problem%p
    problem%rho = norm2(s)
    problem%theta = lode_angle(s)
    call evaluate_flow(material, problem, 1.0_DP, state, status)
    if (status /= RETURN_OK) return
    if (state%f <= TOL_YIELD * (state%d + state%deviator%t)) return
    call solve_flow(material, problem, state, status)
    if (status /= RETURN_OK) return
    call set_response(problem, state, order, response)
  end subroutine map_principal_return


  !> The fixed data of the law.
  pure function pose_problem(material, moduli, argument, e_old) result(problem)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: moduli(2), argument, e_old
    type(problem_type) :: problem
    real(DP) :: values(4), c0, slope
    problem%G = moduli(1)
    problem%K = moduli(2)
    problem%argument = argument
    problem%e_old = e_old
    call evaluate_table(material%cone, argument, values(:size(material%cone%value, 1)))
    problem%friction = tan(values(1))
    problem%dilation = tan(values(2))
    if (material%yield_surface == YIELD_MOHR_COULOMB) then
      problem%yield = deviatoric_section_type(SECTION_MOHR_COULOMB, friction=values(1))
      problem%flow = deviatoric_section_type(SECTION_MENETREY_WILLAM, ratio=values(3), &
        factor=(3 - sin(values(1))) / (6 * cos(values(1))))
      call evaluate_curves(material%isotropic_hardening, argument, 0.0_DP, c0, slope)
      problem%vertex = values(4) * c0 * problem%dilation
      problem%is_work_hardening = .true.
      if (problem%friction > 0) problem%strain_factor = problem%dilation / problem%friction
      return
    end if
    associate (K => values(3))
      problem%yield = deviatoric_section_type(SECTION_RATIO, ratio=K)
      problem%flow = problem%yield
      problem%cohesion_factor = hardening_factor(material%cone_hardening, K, problem%friction)
      problem%strain_factor = hardening_factor(material%cone_hardening, K, problem%dilation)
    end associate
  end function pose_problem


  !> The root of the yield condition: y from 0 to 1, or the apex.
  pure subroutine solve_flow(material, problem, state, status)
    type(material_type), intent(in) :: material
    type(problem_type), intent(in) :: problem
    type(flow_state_type), intent(out) :: state
    integer, intent(out) :: status                  !< RETURN_...
    type(root_search_type) :: search
    integer :: i
    if (.not. problem%vertex > 0) then
      call evaluate_flow(material, problem, 0.0_DP, state, status)
      if (status /= RETURN_OK) return
      if (state%f > 0) then
        call solve_apex(material, problem, state, status)
        return
      end if
      search%scale = 1
    end if
    search%x = 1
    search%high = 1
    do i = 0, MAX_ROOT_ITERATIONS
      call evaluate_flow(material, problem, search%x, state, status)
      if (search%is_found .or. status /= RETURN_OK) return
      if (.not. state%df(4) > 0) exit
      call improve_root(search, state%f, state%df(4))
    end do
    status = RETURN_FAILED
  end subroutine solve_flow


  !> Volume, equivalent plastic strain and excess over the yield surface after a flow.
  pure subroutine evaluate_flow(material, problem, y, state, status)
    type(material_type), intent(in) :: material
    type(problem_type), intent(in) :: problem
    real(DP), intent(in) :: y                       !< from 0 (only without a hyperbola) to 1 [-]
    type(flow_state_type), intent(out) :: state
    integer, intent(out) :: status                  !< RETURN_...
    real(DP) :: H, dH, ddH, p, dpressure(4), slope, hyperbola, work, dwork(4), dt(4), dmu(4)
    logical :: is_found
    call return_deviator(problem%flow, problem%G, problem%rho, problem%theta, y, state%deviator, is_found)
    status = merge(RETURN_OK, RETURN_FAILED, is_found)
    if (.not. is_found) return
    associate (back => state%deviator)
      dt = [back%dt(:2), 0.0_DP, back%dt(3)]
      dmu = [back%dmu(:2), 0.0_DP, back%dmu(3)]
      if (problem%vertex > 0) then
        hyperbola = sqrt(problem%vertex**2 + back%t**2)
        state%volume = problem%dilation * (1 / y - 1) / (3 * problem%G) * hyperbola
        state%dvolume = problem%dilation * (1 / y - 1) / (3 * problem%G) * back%t / hyperbola * dt
        state%dvolume(4) = state%dvolume(4) - problem%dilation * hyperbola / (3 * problem%G * y**2)
      else
        state%volume = problem%dilation * back%mu
        state%dvolume = problem%dilation * dmu
      end if
      p = problem%p + problem%K * state%volume
      dpressure = problem%K * state%dvolume
      dpressure(3) = dpressure(3) + 1
      if (problem%is_work_hardening) then
        work = back%mu * back%t - p * state%volume
        dwork = back%t * dmu + back%mu * dt - p * state%dvolume - state%volume * dpressure
        call find_growth(material, problem, work, dwork, state, status)
        if (status /= RETURN_OK) return
      else
        state%growth = problem%strain_factor * back%mu
        state%dgrowth = problem%strain_factor * dmu
      end if
      call evaluate_cohesion(material, problem, state%growth, state%d, slope)
      call evaluate_section(problem%yield, back%theta, H, dH, ddH)
      state%f = back%rho * H - p * problem%friction - state%d
      state%df = -problem%friction * dpressure - slope * state%dgrowth
      state%df([1, 2, 4]) = state%df([1, 2, 4]) + matmul([H, dH], back%ds)
    end associate
  end subroutine evaluate_flow


  !> The growth of e by work: growth d(e_old + growth) = work. Negative work counts as none.
  pure subroutine find_growth(material, problem, work, dwork, state, status)
    type(material_type), intent(in) :: material
    type(problem_type), intent(in) :: problem
    real(DP), intent(in) :: work, dwork(4)          !< plastic work and its derivatives [stress]
    type(flow_state_type), intent(inout) :: state
    integer, intent(out) :: status                  !< RETURN_...
    type(root_search_type) :: search
    real(DP) :: d, slope
    integer :: i
    status = RETURN_OK
    if (.not. work > 0) return
    do i = 0, MAX_ROOT_ITERATIONS
      call evaluate_cohesion(material, problem, search%x, d, slope)
      slope = d + search%x * slope
      if (.not. slope > 0) exit
      state%growth = search%x
      state%dgrowth = dwork / slope
      if (search%is_found) return
      call improve_root(search, search%x * d - work, slope)
    end do
    status = RETURN_FAILED
  end subroutine find_growth


  !> Cohesion and its slope after a growth of the equivalent plastic strain.
  pure subroutine evaluate_cohesion(material, problem, growth, d, slope)
    type(material_type), intent(in) :: material
    type(problem_type), intent(in) :: problem
    real(DP), intent(in) :: growth                  !< [-]
    real(DP), intent(out) :: d, slope               !< [stress]
    call evaluate_curves(material%isotropic_hardening, problem%argument, problem%e_old + growth, d, slope)
    d = problem%cohesion_factor * d
    slope = problem%cohesion_factor * slope
  end subroutine evaluate_cohesion


  !> The apex: s = 0 and p = -d/tan(phi), with a further increase of volume w that enters e with its work over the stress of
  !! the hardening curve.
  pure subroutine solve_apex(material, problem, state, status)
    type(material_type), intent(in) :: material
    type(problem_type), intent(in) :: problem
    type(flow_state_type), intent(inout) :: state   !< in: at y = 0
    integer, intent(out) :: status                  !< RETURN_...
    type(root_search_type) :: search
    real(DP) :: growth, base, dbase(4), slope, df, dw(4), dvolume(4)
    integer :: i
    growth = problem%cohesion_factor / problem%friction
    base = problem%strain_factor * state%deviator%mu
    dbase = problem%strain_factor * [state%deviator%dmu(:2), 0.0_DP, 0.0_DP]
    dvolume = problem%dilation * [state%deviator%dmu(:2), 0.0_DP, 0.0_DP]
    search%high = -problem%p / problem%K - state%volume    ! without pressure
    search%scale = search%high + state%deviator%mu
    status = RETURN_FAILED
    do i = 0, MAX_ROOT_ITERATIONS
      call evaluate_cohesion(material, problem, base + growth * search%x, state%d, slope)
      df = problem%K + growth * slope / problem%friction
      if (.not. df > 0) return
      if (search%is_found) exit
      call improve_root(search, problem%p + problem%K * (state%volume + search%x) + state%d / problem%friction, df)
    end do
    if (.not. search%is_found) return
    status = RETURN_OK
    dw = -(problem%K * dvolume + slope / problem%friction * dbase) / df
    dw(3) = dw(3) - 1 / df
    state%volume = state%volume + search%x
    state%dvolume = dvolume + dw
    state%growth = base + growth * search%x
    state%dgrowth = dbase + growth * dw
    state%df = [0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP]     ! y stays 0
  end subroutine solve_apex


  !> Stress, plastic strain, slopes and secants in the order of the trial stresses.
  pure subroutine set_response(problem, state, order, response)
    type(problem_type), intent(in) :: problem
    type(flow_state_type), intent(in) :: state
    integer, intent(in) :: order(3)                 !< of the trial stresses, descending
    type(principal_return_type), intent(inout) :: response
    real(DP), parameter :: MIN_DIFFERENCE = 1.0e-5_DP   ! of trial stresses over |s|: nearer ones count as equal [-]
    real(DP) :: axes(3, 2), change(4), s(3), trial(3), secant(3), slope(3, 3), difference
    integer :: i, A, B
    axes = lode_axes(state%deviator%theta)
    s = state%deviator%rho * axes(:, 1)
    response%plastic = state%growth
    response%tau(order) = s - problem%p - problem%K * state%volume
    axes = lode_axes(problem%theta)
    trial = problem%rho * axes(:, 1)
    response%flow(order) = (trial - s) / (2 * problem%G) + state%volume / 3
    axes = lode_axes(state%deviator%theta)
    do i = 1, 3                                     ! the trial strain of place i grows
      change(:2) = 2 * problem%G * axes(i, :)
      change(3) = -problem%K
      change(4) = 0
      change(4) = -dot_product(state%df, change) / state%df(4)
      slope(:, i) = matmul(axes, matmul(state%deviator%ds, change([1, 2, 4]))) + problem%K &
        - problem%K * dot_product(state%dvolume, change)
    end do
    do A = 1, 3
      B = modulo(A, 3) + 1
      difference = trial(A) - trial(B)
      if (abs(difference) > MIN_DIFFERENCE * problem%rho) then
        secant(A) = 2 * problem%G * (s(A) - s(B)) / difference
      else
        secant(A) = 0.5_DP * (slope(A, A) - slope(B, A) + slope(B, B) - slope(A, B))
      end if
    end do
    response%slope(order, order) = slope
    do A = 1, 3                                     ! of the pair without place 3, 1, 2, in the order of the pairs
      i = order(modulo(A + 1, 3) + 1)
      response%secant(modulo(i, 3) + 1) = secant(A)
    end do
  end subroutine set_response

end module amontons_lode_angle_return
