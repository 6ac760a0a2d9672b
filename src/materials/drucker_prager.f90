!> Return mapping for the linear Drucker-Prager model: a cone in the space of mean and deviatoric stress, and its apex.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! With q the von Mises stress and p the pressure the yield condition is q - p tan(beta) = d(e) and the plastic flow has the
!! direction of the gradient of q - p tan(psi): friction angle beta, dilation angle psi, cohesion d, equivalent plastic strain e.
!! Beyond the apex p = -d/tan(beta) a second mechanism, a pure increase of volume, acts beside that of the cone. The result is
!! continuous between both. Implicit (backward Euler).
!! References: D. C. Drucker, W. Prager, Soil mechanics and plastic analysis or limit design, Quart. Appl. Math. 10 (1952)
!! 157-165; W. T. Koiter, Quart. Appl. Math. 11 (1953) 350-354 (several mechanisms); E. A. de Souza Neto, D. Peric, D. R. J. Owen,
!! Computational Methods for Plasticity (2008), section 8.3.
module amontons_drucker_prager
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, evaluate_curves, evaluate_table, CONE_COMPRESSION, CONE_TENSION
  use amontons_plasticity, only: return_mapping_type, RETURN_OK, RETURN_FAILED, TOL_YIELD
  use amontons_scalar_root, only: root_search_type, improve_root, MAX_ROOT_ITERATIONS
  implicit none
  private
  public :: hardening_factor, map_cone_return

  !> The increment's fixed data, for the scalar equations.
  type :: cone_problem_type
    real(DP) :: G, K                               !< shear and bulk modulus [stress]
    real(DP) :: q_trial, p_trial                   !< [stress]
    real(DP) :: argument                           !< temperature, or the field variable that the tables are over
    real(DP) :: e_old                              !< committed equivalent plastic strain [-]
    real(DP) :: friction, dilation                 !< tan(beta), tan(psi) [-]
    real(DP) :: cohesion_factor                    !< d over the stress of the hardening curve [-]
    real(DP) :: strain_factor                      !< c: growth of e over the multiplier of the cone [-]
  end type cone_problem_type

contains

  !> The plastic strain of the increment and the derivatives of the stress, for a trial stress.
  pure subroutine map_cone_return(material, moduli, trial, argument, e_old, solution, status)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: moduli(2)              !< shear and bulk modulus [stress]
    real(DP), intent(in) :: trial(2)               !< von Mises stress and pressure of the trial stress [stress]
    real(DP), intent(in) :: argument               !< temperature, or the field variable that the tables are over
    real(DP), intent(in) :: e_old                  !< committed equivalent plastic strain [-]
    type(return_mapping_type), intent(out) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    type(cone_problem_type) :: problem
    real(DP) :: f, df, d
    status = RETURN_OK
    problem = pose_problem(material, moduli, trial, argument, e_old)
    call evaluate_cone(material, problem, 0.0_DP, f, df, d)
    if (f <= TOL_YIELD * (d + problem%q_trial)) return
    call evaluate_cone(material, problem, problem%q_trial / (3 * problem%G), f, df, d)
    if (f > 0) then
      call return_to_apex(material, problem, solution, status)
    else
      call return_to_cone(material, problem, solution, status)
    end if
  end subroutine map_cone_return


  !> The fixed data. The hardening curve is one of uniaxial compression, uniaxial tension or pure shear: stress and equivalent
  !! plastic strain e are those of this test, so that the plastic work of associated flow is the stress of the curve times e.
  pure function pose_problem(material, moduli, trial, argument, e_old) result(problem)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: moduli(2), trial(2), argument, e_old
    type(cone_problem_type) :: problem
    real(DP) :: angle(2)
    call evaluate_table(material%cone, argument, angle)
    problem%G = moduli(1)
    problem%K = moduli(2)
    problem%q_trial = trial(1)
    problem%p_trial = trial(2)
    problem%argument = argument
    problem%e_old = e_old
    problem%friction = tan(angle(1))
    problem%dilation = tan(angle(2))
    problem%cohesion_factor = hardening_factor(material%cone_hardening, 1.0_DP, problem%friction)
    problem%strain_factor = hardening_factor(material%cone_hardening, 1.0_DP, problem%dilation)
  end function pose_problem


  !> What the cohesion is over the stress of the hardening curve, with the tangent of the angle of friction; and the growth of the
  !! equivalent plastic strain over the multiplier, with that of dilation.
  pure real(DP) function hardening_factor(test, K, tangent) result(factor)
    integer, intent(in) :: test                    !< CONE_... of the hardening curve
    real(DP), intent(in) :: K                      !< yield stress in extension over that in compression [-]
    real(DP), intent(in) :: tangent                !< [-]
    select case (test)
    case (CONE_COMPRESSION)
      factor = 1 - tangent / 3
    case (CONE_TENSION)
      factor = 1 / K + tangent / 3
    case default
      factor = 0.5_DP * sqrt(3.0_DP) * (1 + 1 / K)
    end select
  end function hardening_factor


  !> Excess over the cone and its slope, after a multiplier m: q = q_trial - 3 G m, p = p_trial + K m tan(psi).
  pure subroutine evaluate_cone(material, problem, m, f, df, d)
    type(material_type), intent(in) :: material
    type(cone_problem_type), intent(in) :: problem
    real(DP), intent(in) :: m                      !< [-]
    real(DP), intent(out) :: f, df                 !< [stress]
    real(DP), intent(out) :: d                     !< cohesion [stress]
    real(DP) :: slope
    call evaluate_cohesion(material, problem, problem%strain_factor * m, d, slope)
    f = problem%q_trial - 3 * problem%G * m - (problem%p_trial + problem%K * problem%dilation * m) * problem%friction - d
    df = -3 * problem%G - problem%K * problem%dilation * problem%friction - problem%strain_factor * slope
  end subroutine evaluate_cone


  !> Cohesion and its slope after a growth of the equivalent plastic strain.
  pure subroutine evaluate_cohesion(material, problem, growth, d, slope)
    type(material_type), intent(in) :: material
    type(cone_problem_type), intent(in) :: problem
    real(DP), intent(in) :: growth                 !< [-]
    real(DP), intent(out) :: d, slope              !< [stress]
    call evaluate_curves(material%isotropic_hardening, problem%argument, problem%e_old + growth, d, slope)
    d = problem%cohesion_factor * d
    slope = problem%cohesion_factor * slope
  end subroutine evaluate_cohesion


  !> f(m) = 0, descending, between 0 and q_trial/(3 G).
  pure subroutine return_to_cone(material, problem, solution, status)
    type(material_type), intent(in) :: material
    type(cone_problem_type), intent(in) :: problem
    type(return_mapping_type), intent(inout) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    type(root_search_type) :: search
    real(DP) :: m, f, df, d
    integer :: i
    search%high = problem%q_trial / (3 * problem%G)
    search%scale = search%high
    status = RETURN_FAILED
    do i = 0, MAX_ROOT_ITERATIONS
      m = search%x
      call evaluate_cone(material, problem, m, f, df, d)
      if (search%is_found) status = RETURN_OK
      if (search%is_found) exit
      if (.not. df < 0) return
      call improve_root(search, -f, -df)
    end do
    solution%plastic = problem%strain_factor * m
    solution%flow = m
    solution%expansion = problem%dilation * m
    solution%ratio = 1 - m / search%scale
    solution%slope = 1 + 3 * problem%G / df
    solution%dq_dp = -3 * problem%G * problem%friction / df
    solution%dp_dq = -problem%K * problem%dilation / df
    solution%dp_dp = 1 + problem%K * problem%dilation * problem%friction / df
  end subroutine return_to_cone


  !> The apex: q = 0, and p_trial + K (m tan(psi) + v) + d/tan(beta) = 0 for the increase of volume v of the second mechanism,
  !! ascending; m = q_trial/(3 G). The plastic work of the second mechanism gives e its growth d/(y tan(beta)) v.
  pure subroutine return_to_apex(material, problem, solution, status)
    type(material_type), intent(in) :: material
    type(cone_problem_type), intent(in) :: problem
    type(return_mapping_type), intent(inout) :: solution
    integer, intent(out) :: status                 !< RETURN_...
    type(root_search_type) :: search
    real(DP) :: m, v, d, slope, df, growth, dv_dq, dv_dp
    integer :: i
    m = problem%q_trial / (3 * problem%G)
    growth = problem%cohesion_factor / problem%friction
    search%high = -problem%p_trial / problem%K - m * problem%dilation   ! without pressure
    search%scale = search%high + m
    status = RETURN_FAILED
    do i = 0, MAX_ROOT_ITERATIONS
      v = search%x
      call evaluate_cohesion(material, problem, problem%strain_factor * m + growth * v, d, slope)
      if (search%is_found) status = RETURN_OK
      if (search%is_found) exit
      df = problem%K + growth * slope / problem%friction
      if (.not. df > 0) return
      call improve_root(search, problem%p_trial + problem%K * (m * problem%dilation + v) + d / problem%friction, df)
    end do
    slope = slope / problem%friction
    df = problem%K + growth * slope
    dv_dp = -1 / df
    dv_dq = -(problem%K * problem%dilation + problem%strain_factor * slope) / (3 * problem%G * df)
    solution%plastic = problem%strain_factor * m + growth * v
    solution%flow = m
    solution%expansion = problem%dilation * m + v
    solution%ratio = 0
    solution%slope = 0
    solution%dq_dp = 0
    solution%dp_dq = -slope * (problem%strain_factor / (3 * problem%G) + growth * dv_dq)
    solution%dp_dp = -slope * growth * dv_dp
  end subroutine return_to_apex

end module amontons_drucker_prager
