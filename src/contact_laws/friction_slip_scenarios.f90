!> Coulomb friction status by trial traction, and Mitchell's slip scenarios with step lengths: one decision per slave node.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! `evaluate_trial_traction` decides the status of a node in one configuration; `classify_slip_scenarios` decides, node by node, the
!! slip scenario and the step length between two configurations. Both use the friction limit of `friction_limit`.
!!
!! The scenarios and step lengths are those of J. Mitchell, "A simple one step line search for use in quasi-static solid
!! mechanics contact calculations", 7th US National Congress on Computational Mechanics, 2003. The symbols are those of
!! doc/theory/contact.md:
!!
!!     Rhat   imbalance of the slave node without its contact force [force]
!!     N      -n.Rhat, the normal force, positive in compression [force]
!!     Rt     Rhat + N n, the tangential imbalance that drives slip [force]
!!     g      slip vector since the start of the increment [length]
!!     L      friction limit min(mu max(N, 0), TAUMAX A), the largest friction force; ROUGH: TAUMAX A [force]
!!     DR     |Rt| - L, signed excess over the friction limit [force]
!!     u, ud  configurations of the iterate and after the full search direction d
module amontons_friction_slip_scenarios
  use amontons_kinds, only: DP
  use amontons_surfaces, only: ROUGH_FRICTION
  implicit none
  private
  public :: trial_traction_type, slip_state_type, slip_controls_type, slip_result_type
  public :: split_nodal_imbalance, evaluate_trial_traction, friction_limit, is_friction_capped, classify_slip_scenarios, &
    find_bounded_step_length
  public :: STATUS_OPEN, STATUS_STICK, STATUS_SLIP, STATUS_BALANCED, STATUS_OPENS, STATUS_CLOSES
  public :: SCENARIO_NONE, SCENARIO_I, SCENARIO_II, SCENARIO_III, SCENARIO_IV, NO_FRICTION_LIMIT
  public :: CONTACT_OPEN, CONTACT_CLOSED, CONTACT_KEPT

  ! Status of a slave node. The trial traction gives the first three, which the results show; the classification of slip scenarios
  ! divides them further. The library gives the same numbers (AMONTONS_NODE_... of amontons.h).
  integer, parameter :: STATUS_OPEN = 0      !< open
  integer, parameter :: STATUS_STICK = 1     !< friction holds it; in the classification: without slip to recover
  integer, parameter :: STATUS_SLIP = 2      !< slides; in the classification: in one of the four scenarios
  integer, parameter :: STATUS_BALANCED = 3  !< slip in equilibrium: DR = 0 within the tolerance
  integer, parameter :: STATUS_OPENS = 4     !< closed at the iterate with N < 0
  integer, parameter :: STATUS_CLOSES = 5    !< open at the iterate, closed after the full search direction

  integer, parameter :: SCENARIO_NONE = 0    !< no slip search: open, stick, or slip in equilibrium
  integer, parameter :: SCENARIO_I = 1       !< slipped too far
  integer, parameter :: SCENARIO_II = 2      !< not enough slip
  integer, parameter :: SCENARIO_III = 3     !< backed up too far
  integer, parameter :: SCENARIO_IV = 4      !< backing up

  ! Contact of a slave node before the trial traction decides on it.
  integer, parameter :: CONTACT_OPEN = 0     !< in the last iteration it was open
  integer, parameter :: CONTACT_CLOSED = 1   !< it was closed
  integer, parameter :: CONTACT_KEPT = 2     !< it is closed for good, and bears tension (NO SEPARATION)

  real(DP), parameter :: NO_FRICTION_LIMIT = huge(1.0_DP)   !< friction without limit (ROUGH, TIED) [force]

  !> Result of the trial traction.
  type :: trial_traction_type
    integer :: status = STATUS_OPEN          !< STATUS_...
    real(DP) :: sigma = 0                    !< trial normal force, positive in compression [force]
    real(DP) :: tau(3) = 0                   !< trial friction on the slave [force]
    real(DP) :: direction(3) = 0             !< tau/|tau|, direction of the friction on the slave, opposite to sliding [-]
    real(DP) :: N = 0                        !< normal force required by the imbalance [force]
    real(DP) :: Rt(3) = 0                    !< tangential imbalance [force]
  end type trial_traction_type

  !> The decision on one slave node in one configuration.
  type :: slip_state_type
    integer :: status = STATUS_OPEN          !< STATUS_OPEN, STATUS_STICK or STATUS_SLIP: by the trial traction
    real(DP) :: N = 0                        !< normal force, positive in compression [force]
    real(DP) :: Rt(3) = 0                    !< tangential imbalance [force]
    real(DP) :: limit = 0                    !< L; NO_FRICTION_LIMIT: none [force]
    real(DP) :: slip(3) = 0                  !< g [length]
    real(DP) :: slip_zero = 0                !< slip up to this counts as zero [length]
    logical :: is_bilateral = .false.        !< it bears tension (NO SEPARATION): N < 0 does not open it
  end type slip_state_type

  !> Tolerances and bounds. The defaults exclude rounding only; each step of a job sets its own.
  type :: slip_controls_type
    real(DP) :: slip_tolerance = 1.0e-12_DP         !< slip is in equilibrium when |DR| <= slip_tolerance L [-]
    real(DP) :: force_zero = 0               !< or when |DR| is at most this [force]
    real(DP) :: alpha_min = 0                !< least step length (the cut at zero slip may be shorter) [-]
    real(DP) :: alpha_max = huge(1.0_DP)     !< largest step length [-]
  end type slip_controls_type

  !> The classification of one node between two configurations.
  type :: slip_result_type
    integer :: status = STATUS_OPEN          !< STATUS_...
    integer :: scenario = SCENARIO_NONE      !< SCENARIO_...
    real(DP) :: alpha = 1                    !< step length [-]
    logical :: becomes_stick = .false.       !< the step ends at zero slip: the node becomes stick
    real(DP) :: DR_u = 0, DR_ud = 0          !< signed excess in both configurations [force]
    real(DP) :: numerator = 0                !< d.e(u), e = DR t: a global step length sums it over the nodes [energy]
    real(DP) :: denominator = 0              !< d.(e(ud) - e(u)) [energy]
  end type slip_result_type

  real(DP), parameter :: TOL_CANCELLATION = 1.0e-12_DP   !< relative rounding of a sum of a few products

contains

  !> Splits an imbalance into normal force and tangential imbalance: N = -n.Rhat, Rt = Rhat + N n.
  pure subroutine split_nodal_imbalance(imbalance, normal, N, Rt)
    real(DP), intent(in) :: imbalance(3)     !< Rhat [force]
    real(DP), intent(in) :: normal(3)        !< unit normal out of the master [-]
    real(DP), intent(out) :: N               !< positive in compression [force]
    real(DP), intent(out) :: Rt(3)           !< [force]
    N = -dot_product(normal, imbalance)
    Rt = imbalance + N * normal
  end subroutine split_nodal_imbalance


  !> The friction limit at a normal force: min(mu N, limit_cap).
  !!
  !! It is homogeneous: stresses in place of forces give a stress. It is linear for negative N too, as Newton's method requires
  !! during the iteration; DR takes max(N, 0). A node that bears tension has no friction there, min(mu max(N, 0), limit_cap); where
  !! it never slips (ROUGH), its limit is limit_cap at any N.
  elemental real(DP) function friction_limit(mu, N, limit_cap, is_bilateral) result(limit)
    real(DP), intent(in) :: mu               !< coefficient, over the part of the normal that supports leave free [-]
    real(DP), intent(in) :: N                !< normal force, positive in compression [force]
    real(DP), intent(in) :: limit_cap             !< upper bound of the friction for any N: TAUMAX times the area [force]
    logical, intent(in), optional :: is_bilateral   !< the node bears tension (NO SEPARATION); default: it does not
    limit = min(mu * N, limit_cap)
    if (.not. present(is_bilateral)) return
    if (is_bilateral) limit = merge(limit_cap, max(limit, 0.0_DP), mu >= ROUGH_FRICTION)
  end function friction_limit


  !> Whether the friction limit does not change with the normal force: it is TAUMAX, or that of a node in tension.
  elemental logical function is_friction_capped(mu, N, limit_cap, is_bilateral)
    real(DP), intent(in) :: mu, N, limit_cap      !< as of friction_limit
    logical, intent(in), optional :: is_bilateral   !< as of friction_limit
    is_friction_capped = mu * N > limit_cap
    if (.not. present(is_bilateral)) return
    is_friction_capped = is_friction_capped .or. (is_bilateral .and. (N <= 0 .or. mu >= ROUGH_FRICTION))
  end function is_friction_capped


  !> Status of a slave node by trial traction: the primal-dual active set in the form of an augmented Lagrangian.
  !!
  !!     sigma = N - c gap           closed if sigma > 0, or for good
  !!     tau   = -Rt - c P slip      P = 1 - n n';  stick if |tau| <= friction_limit(mu, sigma, limit_cap), else slip
  !!                                 with friction along tau/|tau|
  !!
  !! A node that is closed for good (NO SEPARATION) has the gap zero and a force of any sign: the inequality of sigma does not hold
  !! there. In tension it slips without friction, unless it never slips (ROUGH).
  !!
  !! A node that was open has no contact force yet, so its imbalance is not a contact force: N = 0 and Rt = 0. Its slip counts from
  !! the point of first touch: it starts as stick if it approached along the normal, as slip if it approached obliquely. Without
  !! friction (mu = 0) a closed node always slips. At a solution both conditions are equivalent to the laws of Signorini and Coulomb
  !! for any c > 0.
  !!
  !! Reference: P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution
  !! methods, Comput. Methods Appl. Mech. Engrg. 92 (1991) 353-375.
  pure subroutine evaluate_trial_traction(imbalance, gap, slip, normal, mu, stiffness, contact, limit_cap, trial)
    real(DP), intent(in) :: imbalance(3)     !< Rhat of the slave node [force]
    real(DP), intent(in) :: gap              !< signed distance, negative is penetration [length]
    real(DP), intent(in) :: slip(3)          !< x_s - x_m(origin), g before its projection [length]
    real(DP), intent(in) :: normal(3)        !< unit normal out of the master [-]
    real(DP), intent(in) :: mu               !< coefficient of friction [-]
    real(DP), intent(in) :: stiffness        !< c, the node's own stiffness, > 0 [force/length]
    integer, intent(in) :: contact           !< CONTACT_...: before this evaluation
    real(DP), intent(in) :: limit_cap             !< upper bound of the friction for any normal force [force]
    type(trial_traction_type), intent(out) :: trial
    real(DP) :: size_tau, limit
    if (contact /= CONTACT_OPEN) call split_nodal_imbalance(imbalance, normal, trial%N, trial%Rt)
    trial%sigma = trial%N - stiffness * gap
    trial%tau = -trial%Rt - stiffness * (slip - dot_product(normal, slip) * normal)
    size_tau = norm2(trial%tau)
    if (size_tau > 0) trial%direction = trial%tau / size_tau
    limit = friction_limit(mu, trial%sigma, limit_cap, contact == CONTACT_KEPT)
    if (trial%sigma <= 0 .and. contact /= CONTACT_KEPT) then
      trial%status = STATUS_OPEN
    else if (limit > 0 .and. size_tau <= limit) then
      trial%status = STATUS_STICK
    else
      trial%status = STATUS_SLIP
    end if
  end subroutine evaluate_trial_traction


  !> Slip scenarios node by node: status, scenario and step length of each slave node from two configurations.
  !!
  !! | DR at u | slip at u | DR at ud | result |
  !! |---|---|---|---|
  !! | > 0 | any | <= 0 | I, slipped too far |
  !! | > 0 | any | > 0 | II, not enough slip |
  !! | < 0 | nonzero | > 0 | III, backed up too far |
  !! | < 0 | nonzero | <= 0 | IV, backing up |
  !! | <= 0 | zero | any | stick |
  !! | 0 within the tolerance | nonzero | any | slip in equilibrium |
  !!
  !! A node without a friction limit sticks. A node open at u stays open or closes; a node closed with N < 0 opens, unless it bears
  !! tension.
  !!
  !! The step length is one secant step on d.e with the vector e = DR t: alpha = - d.e(u) / d.(e(ud) - e(u)). For d along t_u (I,
  !! II) or -t_g (III, IV) it is the formula of the table in the slides. In III and IV the step is cut where the projection of the
  !! slip on t_g reaches zero, unless the node is open at ud; then the node becomes stick. Order: formula, safeguard (a vanishing
  !! denominator or a negative length gives 1), bounds, cut.
  pure subroutine classify_slip_scenarios(at_u, at_ud, d, controls, verdicts)
    type(slip_state_type), intent(in) :: at_u(:)      !< (n) the nodes at the iterate
    type(slip_state_type), intent(in) :: at_ud(:)     !< (n) the nodes after the full search direction
    real(DP), intent(in) :: d(:, :)                   !< (3, n) their tangential increments relative to the master [length]
    type(slip_controls_type), intent(in) :: controls
    type(slip_result_type), intent(out) :: verdicts(:)   !< (n)
    integer :: s
    do s = 1, size(verdicts)
      call classify_node(at_u(s), at_ud(s), d(:, s), controls, verdicts(s))
    end do
  end subroutine classify_slip_scenarios


  !> Classification of one node.
  pure subroutine classify_node(at_u, at_ud, d, controls, slip_result)
    type(slip_state_type), intent(in) :: at_u, at_ud
    real(DP), intent(in) :: d(3)                      !< [length]
    type(slip_controls_type), intent(in) :: controls
    type(slip_result_type), intent(inout) :: slip_result !< in: its defaults
    real(DP) :: e_u(3), e_ud(3), rounding
    slip_result%DR_u = evaluate_slip_excess(at_u)
    slip_result%DR_ud = evaluate_slip_excess(at_ud)
    slip_result%status = refined_status(at_u, at_ud%status, slip_result%DR_u, controls)
    if (slip_result%status /= STATUS_SLIP .and. slip_result%status /= STATUS_BALANCED) return
    if (slip_result%status == STATUS_SLIP) slip_result%scenario = choose_scenario(slip_result%DR_u, slip_result%DR_ud)
    call evaluate_excess_vectors(at_u, at_ud, slip_result, e_u, e_ud)
    rounding = TOL_CANCELLATION * norm2(d) * (abs(slip_result%DR_u) + abs(slip_result%DR_ud))
    slip_result%numerator = drop_rounding(dot_product(d, e_u), rounding)
    slip_result%denominator = drop_rounding(dot_product(d, e_ud) - slip_result%numerator, rounding)
    if (slip_result%status == STATUS_BALANCED) return
    slip_result%alpha = find_bounded_step_length(slip_result%numerator, slip_result%denominator, controls)
    if (slip_result%scenario == SCENARIO_I .or. slip_result%scenario == SCENARIO_II) return
    if (at_ud%status == STATUS_OPEN) return           ! the node has lost contact: no slip at ud
    call limit_to_zero_slip(at_u%slip, at_ud%slip, slip_result%alpha, slip_result%becomes_stick)
  end subroutine classify_node


  !> - numerator / denominator, safeguarded: 1 if one of them vanishes or the length is negative; then bounded. With sums over all
  !! slave nodes it is the global step length of the slides.
  pure function find_bounded_step_length(numerator, denominator, controls) result(alpha)
    real(DP), intent(in) :: numerator                 !< d.e(u) [energy]
    real(DP), intent(in) :: denominator               !< d.(e(ud) - e(u)) [energy]
    type(slip_controls_type), intent(in) :: controls
    real(DP) :: alpha
    alpha = 1
    if (abs(denominator) > TOL_CANCELLATION * (abs(numerator) + abs(numerator + denominator))) alpha = -numerator / denominator
    if (alpha < 0 .or. numerator == 0) alpha = 1
    alpha = min(max(alpha, controls%alpha_min), controls%alpha_max)
  end function find_bounded_step_length


  !> A value, or zero at rounding level.
  pure function drop_rounding(value, rounding) result(clean)
    real(DP), intent(in) :: value, rounding
    real(DP) :: clean
    clean = merge(value, 0.0_DP, abs(value) > rounding)
  end function drop_rounding


  !> DR = |Rt| - L; 0 if friction has no limit.
  pure function evaluate_slip_excess(point) result(DR)
    type(slip_state_type), intent(in) :: point
    real(DP) :: DR
    DR = 0.0_DP
    if (point%limit < NO_FRICTION_LIMIT) DR = norm2(point%Rt) - point%limit
  end function evaluate_slip_excess


  !> The status at the iterate, refined by excess and slip.
  pure function refined_status(point, status_ud, DR, controls) result(status)
    type(slip_state_type), intent(in) :: point
    integer, intent(in) :: status_ud                  !< status after the full search direction
    real(DP), intent(in) :: DR                        !< at the iterate [force]
    type(slip_controls_type), intent(in) :: controls
    integer :: status
    logical :: has_slip, is_balanced
    has_slip = norm2(point%slip) > point%slip_zero
    is_balanced = abs(DR) <= max(controls%slip_tolerance * point%limit, controls%force_zero)
    if (point%status == STATUS_OPEN) then
      status = merge(STATUS_OPEN, STATUS_CLOSES, status_ud == STATUS_OPEN)
    else if (point%N < 0 .and. .not. point%is_bilateral) then
      status = STATUS_OPENS
    else if (.not. point%limit < NO_FRICTION_LIMIT) then
      status = STATUS_STICK
    else if (.not. has_slip .and. (DR <= 0 .or. is_balanced)) then
      status = STATUS_STICK
    else if (is_balanced) then
      status = STATUS_BALANCED
    else
      status = STATUS_SLIP
    end if
  end function refined_status


  !> The scenario by the signs of DR.
  pure function choose_scenario(DR_u, DR_ud) result(scenario)
    real(DP), intent(in) :: DR_u, DR_ud               !< [force]
    integer :: scenario
    if (DR_u > 0) then
      scenario = merge(SCENARIO_II, SCENARIO_I, DR_ud > 0)
    else
      scenario = merge(SCENARIO_III, SCENARIO_IV, DR_ud > 0)
    end if
  end function choose_scenario


  !> The vectors e = DR t of both configurations. If Rt vanishes, t is the direction of the slip; in I t_d is t_u.
  pure subroutine evaluate_excess_vectors(at_u, at_ud, slip_result, e_u, e_ud)
    type(slip_state_type), intent(in) :: at_u, at_ud
    type(slip_result_type), intent(in) :: slip_result    !< with scenario and DR
    real(DP), intent(out) :: e_u(3), e_ud(3)          !< [force]
    real(DP) :: t_g(3), t_u(3), t_d(3)
    t_g = unit_vector(at_u%slip, [0.0_DP, 0.0_DP, 0.0_DP])
    t_u = unit_vector(at_u%Rt, t_g)
    t_d = unit_vector(at_ud%Rt, t_g)
    if (slip_result%scenario == SCENARIO_I) t_d = t_u
    e_u = slip_result%DR_u * t_u
    e_ud = slip_result%DR_ud * t_d
  end subroutine evaluate_excess_vectors


  !> v/|v|, or a fallback direction if v vanishes.
  pure function unit_vector(v, otherwise) result(t)
    real(DP), intent(in) :: v(3), otherwise(3)
    real(DP) :: t(3)
    t = otherwise
    if (norm2(v) > 0) t = v / norm2(v)
  end function unit_vector


  !> Cuts a step that would back up past zero slip: |g| / (|g| - t_g.g_d) makes the projection of the slip on t_g zero. (The slides
  !! give |g| / (|g| - |g_d|), which is equal as long as the full step does not pass zero slip.)
  pure subroutine limit_to_zero_slip(slip_u, slip_ud, alpha, becomes_stick)
    real(DP), intent(in) :: slip_u(3), slip_ud(3)     !< g and g_d [length]
    real(DP), intent(inout) :: alpha                  !< step length [-]
    logical, intent(out) :: becomes_stick             !< the step ends there
    real(DP) :: length, projected_slip_change
    length = norm2(slip_u)
    becomes_stick = .false.
    if (length <= 0) return
    projected_slip_change = length - dot_product(slip_u, slip_ud) / length
    if (projected_slip_change <= 0) return
    becomes_stick = alpha * projected_slip_change >= length * (1 - TOL_CANCELLATION)
    if (becomes_stick) alpha = length / projected_slip_change
  end subroutine limit_to_zero_slip

end module amontons_friction_slip_scenarios
