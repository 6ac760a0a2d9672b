!> Local equilibrium of a compliant contact law with the stiffness of the body at one slave node (pressure and shear).
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 6. Far from equilibrium, a stiff law amplifies small gap errors into large force errors.
!! Therefore the law is not evaluated at the actual gap, but at the gap where the node would be in equilibrium if it alone moved,
!! against the stiffness c of its body. In equilibrium both gaps are equal.
module amontons_slave_node_equilibrium
  use amontons_kinds, only: DP
  use amontons_tensor, only: outer_product, IDENTITY
  use amontons_surfaces, only: interaction_type, BEHAVIOR_TIED
  use amontons_friction_slip_scenarios, only: is_friction_capped
  use amontons_pressure_overclosure, only: evaluate_pressure_overclosure, find_activation_gap, find_shear_limit
  implicit none
  private
  public :: local_solution_type, local_problem_type, solve_local_problem

  integer, parameter :: MAX_BRACKET_STEPS = 60            !< of the overclosure search, which at least halves its bracket
  real(DP), parameter :: TOL_OVERCLOSURE = 1.0e-14_DP        !< relative tolerance of the overclosure search [-]

  !> Local problem at a slave node: kinematics, stiffness and force imbalance.
  type :: local_problem_type
    real(DP) :: area = 0                           !< [length^2]
    real(DP) :: stiffness = 0                      !< c of its body; 0: the law is evaluated at the actual position [force/length]
    real(DP) :: overclosure = 0                    !< h = -gap [length]
    real(DP) :: normal(3) = 0                      !< out of the master [-]
    real(DP) :: slip(3) = 0                        !< e: trial elastic slip, all slip taken as elastic, tangential [length]
    real(DP) :: slip_rounding = 0                  !< a slip up to this is none: without pressure rounding would choose [length]
    real(DP) :: imbalance(3) = 0                   !< Rhat of the node [force]
    logical :: is_bilateral = .false.              !< it bears tension (NO SEPARATION): the law acts at any gap
    real(DP) :: free(3, 3) = 0                     !< projector on the directions in which contact balances the imbalance [-]
  end type local_problem_type

  !> Solution of the local problem.
  type :: local_solution_type
    logical :: is_open = .true.
    logical :: is_slipping = .false.
    real(DP) :: pressure = 0                       !< [stress]
    real(DP) :: slope = 0                          !< d pressure/d overclosure [stress/length]
    real(DP) :: energy = 0                         !< [energy]
    real(DP) :: shear(3) = 0                       !< S [force]
    real(DP) :: elastic(3) = 0                     !< elastic slip [length]
    real(DP) :: slip(3) = 0                        !< plastic part of e [length]
    real(DP) :: d_force_d_slip(3, 3) = 0                  !< dS/de [force/length]
    real(DP) :: d_force_d_gap(3) = 0                      !< dS/dg [force/length]
    real(DP) :: law_linearization_force(3) = 0  !< force of the linearized law at the actual position minus that of this solution
                                                !! [force]
  end type local_solution_type

contains

  !> Pressure and shear in local equilibrium, and their derivatives.
  pure subroutine solve_local_problem(law, problem, solution)
    type(interaction_type), intent(in) :: law
    type(local_problem_type), intent(in) :: problem
    type(local_solution_type), intent(out) :: solution
    real(DP) :: law_force(3), required_force(3), h, N, excess
    call evaluate_law(law, problem, law_force, solution%is_open)
    required_force = law_force
    if (problem%stiffness > 0.0_DP) required_force = law_force - matmul(problem%free, problem%imbalance + law_force)
    N = dot_product(problem%normal, required_force)
    if (problem%stiffness > 0.0_DP) call solve_overclosure(law, problem, N, solution%is_open, h)
    if (.not. problem%stiffness > 0.0_DP) h = problem%overclosure
    if (solution%is_open) return
    call evaluate_pressure_overclosure(law, h, solution%pressure, solution%slope, solution%energy)
    solution%energy = problem%area * solution%energy
    excess = problem%area * solution%slope * (problem%overclosure - h)
    call solve_shear(law, problem, N * problem%normal - required_force, excess, solution)
    solution%law_linearization_force = solution%law_linearization_force + excess * problem%normal
  end subroutine solve_local_problem


  !> The largest gap at which the law acts at the node [length].
  pure real(DP) function activation_gap_of(law, problem) result(reach)
    type(interaction_type), intent(in) :: law
    type(local_problem_type), intent(in) :: problem
    reach = merge(huge(1.0_DP), find_activation_gap(law, problem%area), problem%is_bilateral)
  end function activation_gap_of


  !> Force of the law at the actual position of the node.
  pure subroutine evaluate_law(law, problem, force, is_open)
    type(interaction_type), intent(in) :: law
    type(local_problem_type), intent(in) :: problem
    real(DP), intent(out) :: force(3)              !< [force]
    logical, intent(out) :: is_open                !< outside the activation range of the law
    real(DP) :: p, slope, energy, length, shear
    force = 0.0_DP
    is_open = -problem%overclosure > activation_gap_of(law, problem)
    if (is_open) return
    call evaluate_pressure_overclosure(law, problem%overclosure, p, slope, energy)
    length = norm2(problem%slip)
    shear = min(law%stick_slope * problem%area * length, find_shear_limit(law, problem%area, p, problem%is_bilateral))
    force = problem%area * p * problem%normal
    if (length > 0.0_DP) force = force - shear / length * problem%slip
  end subroutine evaluate_law


  !> Overclosure h' that solves A p(h') + c (h' - h) = N, with N the required normal force.
  !!
  !! Within the activation range of the law the left side grows with h'. At the end of the range it may jump; if there is no root on
  !! either side, or one on both sides, the node is open if its actual position is outside the range.
  pure subroutine solve_overclosure(law, problem, required_force, is_open, h)
    type(interaction_type), intent(in) :: law
    type(local_problem_type), intent(in) :: problem
    real(DP), intent(in) :: required_force                 !< N [force]
    logical, intent(inout) :: is_open              !< in: by the actual position of the node
    real(DP), intent(out) :: h                     !< [length]
    real(DP) :: low, high, gap_free_force, p, slope, energy, residual
    integer :: i
    logical :: is_reached
    gap_free_force = problem%overclosure + required_force / problem%stiffness   ! overclosure without any pressure
    low = -activation_gap_of(law, problem)
    is_reached = .true.
    if (low > -huge(1.0_DP)) then
      call evaluate_pressure_overclosure(law, low, p, slope, energy)
      is_reached = problem%area * p + problem%stiffness * (low - gap_free_force) <= 0.0_DP
    end if
    if (is_reached .neqv. gap_free_force < low) is_open = .not. is_reached
    h = max(low, problem%overclosure)
    if (is_open) return
    if (.not. is_reached) h = low
    if (.not. is_reached) return
    high = huge(1.0_DP)
    do i = 1, MAX_BRACKET_STEPS
      call evaluate_pressure_overclosure(law, h, p, slope, energy)
      residual = problem%area * p + problem%stiffness * (h - gap_free_force)
      if (residual > 0.0_DP) high = min(high, h)
      if (residual <= 0.0_DP) low = max(low, h)
      if (abs(residual) <= TOL_OVERCLOSURE * (problem%area * abs(p) + problem%stiffness * (abs(h) + abs(gap_free_force)))) exit
      h = h - residual / (problem%area * slope + problem%stiffness)
      if (h <= low .or. h >= high) h = 0.5_DP * (low + high)
    end do
  end subroutine solve_overclosure


  !> Shear force up to its limit at the pressure found, by the same local equilibrium.
  pure subroutine solve_shear(law, problem, required_force, excess, solution)
    type(interaction_type), intent(in) :: law
    type(local_problem_type), intent(in) :: problem
    real(DP), intent(in) :: required_force(3)              !< minus the tangential imbalance [force]
    real(DP), intent(in) :: excess                 !< normal force at the actual position minus that of the solution [force]
    type(local_solution_type), intent(inout) :: solution
    real(DP) :: trial(3), k, c, limit, length, q(3)
    k = law%stick_slope * problem%area
    c = merge(problem%stiffness, k, problem%stiffness > 0.0_DP)   ! no stiffness: the required force is that of the law, for any c
    limit = find_shear_limit(law, problem%area, solution%pressure, problem%is_bilateral)
    solution%is_slipping = k <= 0.0_DP
    if (solution%is_slipping) then
      solution%slip = problem%slip
      return
    end if
    trial = required_force + c * problem%slip
    length = norm2(trial)
    solution%is_slipping = k / (k + c) * (length - c * problem%slip_rounding) > limit
    if (.not. solution%is_slipping) then
      solution%elastic = trial / (k + c)
      solution%shear = -k * solution%elastic
      solution%d_force_d_slip = -k * IDENTITY
      solution%law_linearization_force = -k * (problem%slip - solution%elastic)
      solution%energy = solution%energy + 0.5_DP * k * dot_product(solution%elastic, solution%elastic)
      return
    end if
    q = trial / length
    solution%elastic = limit / k * q
    solution%slip = problem%slip - solution%elastic
    solution%shear = -limit * q
    solution%energy = solution%energy + 0.5_DP * limit**2 / k
    solution%d_force_d_slip = -limit * c / (length - limit) * (IDENTITY - outer_product(q, q))
    solution%law_linearization_force = matmul(solution%d_force_d_slip, problem%slip)
    if (law%behavior == BEHAVIOR_TIED .or. solution%pressure <= 0.0_DP .or. &
      is_friction_capped(law%friction, solution%pressure, law%shear_limit, problem%is_bilateral)) return
    solution%d_force_d_gap = law%friction * solution%slope * problem%area * q
    solution%law_linearization_force = solution%law_linearization_force - law%friction * excess * q
  end subroutine solve_shear

end module amontons_slave_node_equilibrium
