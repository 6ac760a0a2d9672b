!> Slip: what friction does at one slave node: status by trial traction, four slip scenarios, and their step lengths.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The scenarios and step lengths are those of J. Mitchell, "A simple one step line search for use in quasi-static solid
!! mechanics contact calculations", 7th US National Congress on Computational Mechanics, 2003. The symbols are those of
!! doc/theory/contact.md:
!!
!!     Rhat   imbalance of the slave node less its contact force [force]
!!     N      -n.Rhat, the normal force, positive in compression [force]
!!     Rt     Rhat + N n, the tangential imbalance: what drives the node to slip [force]
!!     g      slip vector since the start of the increment [length]
!!     DR     |Rt| - mu max(N, 0), signed excess over what friction can carry [force]
!!     u, ud  the configuration of the iterate, and that after the full search direction d
module amontons_slip_scenarios
  use amontons_kinds, only: DP
  implicit none
  private
  public :: trial_traction_type, slip_state_type, slip_controls_type, slip_result_type
  public :: split_nodal_imbalance, evaluate_trial_traction, classify_slip_scenario, classify_slip_scenarios, &
    find_scenario_step_length, find_bounded_step_length
  public :: STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  public :: SCENARIO_NONE, SCENARIO_I, SCENARIO_II, SCENARIO_III, SCENARIO_IV
  public :: NODE_OPEN, NODE_STICK, NODE_SLIP, NODE_BALANCED, NODE_OPENED, NODE_CLOSED

  ! Status of a node by trial traction; the same numbers stand in the results.
  integer, parameter :: STATUS_OPEN = 0, STATUS_STICK = 1, STATUS_SLIP = 2

  integer, parameter :: SCENARIO_NONE = 0    !< no slip search: open, stick, or slip in balance
  integer, parameter :: SCENARIO_I = 1       !< slipped too far
  integer, parameter :: SCENARIO_II = 2      !< not enough slip
  integer, parameter :: SCENARIO_III = 3     !< backed up too far
  integer, parameter :: SCENARIO_IV = 4      !< backing up

  integer, parameter :: NODE_OPEN = 0        !< open, and stays so
  integer, parameter :: NODE_STICK = 1       !< friction can hold, and there is no slip to take back
  integer, parameter :: NODE_SLIP = 2        !< in one of the four scenarios
  integer, parameter :: NODE_BALANCED = 3    !< slip, in balance: DR = 0 within the tolerance
  integer, parameter :: NODE_OPENED = 4      !< was closed, N < 0: opens
  integer, parameter :: NODE_CLOSED = 5      !< was open, gap < 0: closes

  !> Result of the trial traction.
  type :: trial_traction_type
    integer :: status = STATUS_OPEN          !< STATUS_...
    real(DP) :: sigma = 0                    !< trial normal force, positive in compression [force]
    real(DP) :: tau(3) = 0                   !< trial friction on the slave [force]
    real(DP) :: direction(3) = 0             !< tau/|tau|, of friction on the slave; it slides the other way [-]
    real(DP) :: N = 0                        !< normal force that the imbalance asks for [force]
    real(DP) :: Rt(3) = 0                    !< tangential imbalance [force]
  end type trial_traction_type

  !> One slave node in one configuration.
  type :: slip_state_type
    logical :: is_closed = .true.            !< it is held by contact in this iteration
    real(DP) :: gap = 0                      !< signed distance; read at open nodes only [length]
    real(DP) :: N = 0                        !< normal force, positive in compression [force]
    real(DP) :: Rt(3) = 0                    !< tangential imbalance [force]
    real(DP) :: slip(3) = 0                  !< g [length]
  end type slip_state_type

  !> Tolerances and bounds. The defaults only exclude rounding: the steps of a job give their own.
  type :: slip_controls_type
    real(DP) :: slip_tolerance = 1.0e-12_DP         !< slip is in balance when |DR| <= balance mu N [-]
    real(DP) :: force_zero = 0               !< or when |DR| is at most this [force]
    real(DP) :: slip_zero = 0                !< a slip up to this counts as none [length]
    real(DP) :: alpha_min = 0                !< least step length (the cap to zero slip may be less) [-]
    real(DP) :: alpha_max = huge(1.0_DP)     !< largest step length [-]
  end type slip_controls_type

  !> What the procedure says of one node.
  type :: slip_result_type
    integer :: state = NODE_OPEN             !< NODE_...
    integer :: scenario = SCENARIO_NONE      !< SCENARIO_...
    real(DP) :: alpha = 1                    !< step length [-]
    logical :: becomes_stick = .false.       !< the step ends at zero slip: the node is to be set to stick
    real(DP) :: DR_u = 0, DR_ud = 0          !< signed excess in both configurations [force]
    real(DP) :: numerator = 0                !< d.e(u), e = DR t: a global length sums these over the nodes [energy]
    real(DP) :: denominator = 0              !< d.(e(ud) - e(u)) [energy]
  end type slip_result_type

  real(DP), parameter :: TOL_CANCELLATION = 1.0e-12_DP   !< relative rounding of a sum of a few products

contains

  !> Normal force and tangential imbalance of an imbalance: N = -n.Rhat, Rt = Rhat + N n.
  pure subroutine split_nodal_imbalance(imbalance, normal, N, Rt)
    real(DP), intent(in) :: imbalance(3)     !< Rhat [force]
    real(DP), intent(in) :: normal(3)        !< unit normal out of the master [-]
    real(DP), intent(out) :: N               !< positive in compression [force]
    real(DP), intent(out) :: Rt(3)           !< [force]
    N = -dot_product(normal, imbalance)
    Rt = imbalance + N * normal
  end subroutine split_nodal_imbalance


  !> Status of a slave node by trial traction: the primal-dual active set in the form of an augmented Lagrangian.
  !!
  !!     sigma = N - c gap           closed if sigma > 0
  !!     tau   = -Rt - c P slip      P = 1 - n n';  stick if |tau| <= min(mu sigma, most), else slip with friction along
  !!                                 tau/|tau|
  !!
  !! A node that was open has no contact force yet: its imbalance is not what contact carries, and N = 0, Rt = 0 are
  !! taken; its slip counts from the point of first touch, so it starts as stick where it came straight down and as slip
  !! where it came along. Without friction (mu = 0) a closed node always slips. At a solution both lines say what the laws of
  !! Signorini and Coulomb say, for any c > 0.
  !!
  !! Reference: P. Alart, A. Curnier, A mixed formulation for frictional contact problems prone to Newton like solution
  !! methods, Comput. Methods Appl. Mech. Engrg. 92 (1991) 353-375.
  pure subroutine evaluate_trial_traction(imbalance, gap, slip, normal, mu, stiffness, was_closed, limit_cap, trial)
    real(DP), intent(in) :: imbalance(3)     !< Rhat of the slave node [force]
    real(DP), intent(in) :: gap              !< signed distance, negative is penetration [length]
    real(DP), intent(in) :: slip(3)          !< x_s - x_m(origin), g before its projection [length]
    real(DP), intent(in) :: normal(3)        !< unit normal out of the master [-]
    real(DP), intent(in) :: mu               !< coefficient of friction [-]
    real(DP), intent(in) :: stiffness        !< c, the node's own stiffness, > 0 [force/length]
    logical, intent(in) :: was_closed        !< it was held by contact in the last iteration
    real(DP), intent(in) :: limit_cap             !< largest friction, whatever the normal force [force]
    type(trial_traction_type), intent(out) :: trial
    real(DP) :: size_tau
    if (was_closed) call split_nodal_imbalance(imbalance, normal, trial%N, trial%Rt)
    trial%sigma = trial%N - stiffness * gap
    trial%tau = -trial%Rt - stiffness * (slip - dot_product(normal, slip) * normal)
    size_tau = norm2(trial%tau)
    if (size_tau > 0) trial%direction = trial%tau / size_tau
    if (trial%sigma <= 0) then
      trial%status = STATUS_OPEN
    else if (mu > 0 .and. size_tau <= min(mu * trial%sigma, limit_cap)) then
      trial%status = STATUS_STICK
    else
      trial%status = STATUS_SLIP
    end if
  end subroutine evaluate_trial_traction


  !> State, scenario and step length of one slave node from its two configurations.
  !!
  !! | DR at u | slip at u | DR at ud | says |
  !! |---|---|---|---|
  !! | > 0 | any | <= 0 | I, slipped too far |
  !! | > 0 | any | > 0 | II, not enough slip |
  !! | < 0 | some | > 0 | III, backed up too far |
  !! | < 0 | some | <= 0 | IV, backing up |
  !! | <= 0 | none | any | stick |
  !! | 0 within the tolerance | some | any | slip, in balance |
  !!
  !! The length is one secant step on d.e with the vector e = DR t: alpha = - d.e(u) / d.(e(ud) - e(u)). For d along t_u
  !! (I, II) or -t_g (III, IV) it is the formula of the table (`find_scenario_step_length`). In III and IV the step is cut where the
  !! projection on t_g of the slip comes to zero; then the node becomes stick. Order: formula, guard (a vanishing
  !! denominator or a negative length means 1), bounds, cut.
  pure subroutine classify_slip_scenario(at_u, at_ud, d, mu, controls, slip_result)
    type(slip_state_type), intent(in) :: at_u         !< the node at the iterate
    type(slip_state_type), intent(in) :: at_ud        !< the node after the full search direction
    real(DP), intent(in) :: d(3)                      !< its tangential increment relative to the master [length]
    real(DP), intent(in) :: mu                        !< coefficient of friction [-]
    type(slip_controls_type), intent(in) :: controls
    type(slip_result_type), intent(out) :: slip_result
    real(DP) :: e_u(3), e_ud(3), rounding
    slip_result%state = classify_node(at_u, mu, controls)
    slip_result%DR_u = evaluate_slip_excess(at_u, mu)
    slip_result%DR_ud = evaluate_slip_excess(at_ud, mu)
    if (slip_result%state /= NODE_SLIP .and. slip_result%state /= NODE_BALANCED) return
    if (slip_result%state == NODE_SLIP) slip_result%scenario = choose_scenario(slip_result%DR_u, slip_result%DR_ud)
    call evaluate_excess_vectors(at_u, at_ud, slip_result, e_u, e_ud)
    rounding = TOL_CANCELLATION * norm2(d) * (abs(slip_result%DR_u) + abs(slip_result%DR_ud))
    slip_result%numerator = drop_rounding(dot_product(d, e_u), rounding)
    slip_result%denominator = drop_rounding(dot_product(d, e_ud) - slip_result%numerator, rounding)
    if (slip_result%state == NODE_BALANCED) return
    slip_result%alpha = find_bounded_step_length(slip_result%numerator, slip_result%denominator, controls)
    if (slip_result%scenario == SCENARIO_I .or. slip_result%scenario == SCENARIO_II) return
    call limit_to_zero_slip(at_u%slip, at_ud%slip, slip_result%alpha, slip_result%becomes_stick)
  end subroutine classify_slip_scenario


  !> The same for many nodes, in plain arrays for other programs: last index 1 is the iterate, 2 is after the full
  !! direction. All nodes are closed; an N < 0 at the iterate says opened.
  pure subroutine classify_slip_scenarios(Rt, N, slip, d, mu, controls, scenario, state, alpha)
    real(DP), intent(in) :: Rt(:, :, :)               !< (3, n, 2) tangential imbalance [force]
    real(DP), intent(in) :: N(:, :)                   !< (n, 2) normal force, positive in compression [force]
    real(DP), intent(in) :: slip(:, :, :)             !< (3, n, 2) slip since the start of the increment [length]
    real(DP), intent(in) :: d(:, :)                   !< (3, n) tangential increments [length]
    real(DP), intent(in) :: mu(:)                     !< (n) coefficients of friction [-]
    type(slip_controls_type), intent(in) :: controls
    integer, intent(out) :: scenario(:)               !< (n) SCENARIO_...
    integer, intent(out) :: state(:)                  !< (n) NODE_...; NODE_STICK also where the step ends at zero slip
    real(DP), intent(out) :: alpha(:)                 !< (n) step lengths [-]
    type(slip_state_type) :: at_u, at_ud
    type(slip_result_type) :: slip_result
    integer :: i
    do i = 1, size(mu)
      at_u = slip_state_type(N=N(i, 1), Rt=Rt(:, i, 1), slip=slip(:, i, 1))
      at_ud = slip_state_type(N=N(i, 2), Rt=Rt(:, i, 2), slip=slip(:, i, 2))
      call classify_slip_scenario(at_u, at_ud, d(:, i), mu(i), controls, slip_result)
      scenario(i) = slip_result%scenario
      state(i) = merge(NODE_STICK, slip_result%state, slip_result%becomes_stick)
      alpha(i) = slip_result%alpha
    end do
  end subroutine classify_slip_scenarios


  !> The step length of the slides' table, for a search along t_u (I, II) or -t_g (III, IV); unguarded and unbounded.
  !!
  !! | scenario | step length | angles |
  !! |---|---|---|
  !! | I | a / (b + a) | |
  !! | II | a / (a - b cos(gamma)) | cos(gamma) = t_u.t_d |
  !! | III | a cos(beta) / (b cos(theta) + a cos(beta)) | cos(beta) = t_u.t_g, cos(theta) = t_g.t_d |
  !! | IV | a cos(beta) / (a cos(beta) - b cos(theta)) | the same |
  pure function find_scenario_step_length(scenario, a, b, cos_beta, cos_gamma, cos_theta) result(alpha)
    integer, intent(in) :: scenario                   !< SCENARIO_...
    real(DP), intent(in) :: a, b                      !< |DR(u)|, |DR(ud)| [force]
    real(DP), intent(in) :: cos_beta, cos_gamma, cos_theta   !< [-]
    real(DP) :: alpha
    select case (scenario)
    case (SCENARIO_I)
      alpha = a / (b + a)
    case (SCENARIO_II)
      alpha = a / (a - b * cos_gamma)
    case (SCENARIO_III)
      alpha = a * cos_beta / (b * cos_theta + a * cos_beta)
    case (SCENARIO_IV)
      alpha = a * cos_beta / (a * cos_beta - b * cos_theta)
    case default
      alpha = 1
    end select
  end function find_scenario_step_length


  !> - numerator / denominator, made safe: 1 if the denominator vanishes or the length is negative; then bounded.
  !! With sums over all slave nodes it is the global step length of the slides' code.
  pure function find_bounded_step_length(numerator, denominator, controls) result(alpha)
    real(DP), intent(in) :: numerator                 !< d.e(u) [energy]
    real(DP), intent(in) :: denominator               !< d.(e(ud) - e(u)) [energy]
    type(slip_controls_type), intent(in) :: controls
    real(DP) :: alpha
    alpha = 1
    if (abs(denominator) > TOL_CANCELLATION * (abs(numerator) + abs(numerator + denominator))) alpha = -numerator / denominator
    if (alpha < 0) alpha = 1
    alpha = min(max(alpha, controls%alpha_min), controls%alpha_max)
  end function find_bounded_step_length


  !> A value, or zero where it is only rounding.
  pure function drop_rounding(value, rounding) result(clean)
    real(DP), intent(in) :: value, rounding
    real(DP) :: clean
    clean = merge(value, 0.0_DP, abs(value) > rounding)
  end function drop_rounding


  !> DR = |Rt| - mu max(N, 0).
  pure function evaluate_slip_excess(point, mu) result(DR)
    type(slip_state_type), intent(in) :: point
    real(DP), intent(in) :: mu                        !< [-]
    real(DP) :: DR
    DR = norm2(point%Rt) - mu * max(point%N, 0.0_DP)
  end function evaluate_slip_excess


  !> State of a node by what is known at the iterate.
  pure function classify_node(point, mu, controls) result(state)
    type(slip_state_type), intent(in) :: point
    real(DP), intent(in) :: mu                        !< [-]
    type(slip_controls_type), intent(in) :: controls
    integer :: state
    real(DP) :: DR
    logical :: has_slip, is_balanced
    DR = evaluate_slip_excess(point, mu)
    has_slip = norm2(point%slip) > controls%slip_zero
    is_balanced = abs(DR) <= max(controls%slip_tolerance * mu * max(point%N, 0.0_DP), controls%force_zero)
    if (.not. point%is_closed) then
      state = merge(NODE_CLOSED, NODE_OPEN, point%gap < 0)
    else if (point%N < 0) then
      state = NODE_OPENED
    else if (.not. has_slip .and. (DR <= 0 .or. is_balanced)) then
      state = NODE_STICK
    else if (is_balanced) then
      state = NODE_BALANCED
    else
      state = NODE_SLIP
    end if
  end function classify_node


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


  !> The vectors e = DR t of both configurations. Without an Rt its direction is that of the slip; in I t_d is t_u.
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


  !> v/|v|, or the given other direction if v vanishes.
  pure function unit_vector(v, otherwise) result(t)
    real(DP), intent(in) :: v(3), otherwise(3)
    real(DP) :: t(3)
    t = otherwise
    if (norm2(v) > 0) t = v / norm2(v)
  end function unit_vector


  !> Cuts a step that would back up past zero slip: |g| / (|g| - t_g.g_d) brings the slip's projection on t_g to zero.
  !! (The slides print |g| / (|g| - |g_d|), which is the same as long as the full step does not pass zero slip.)
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

end module amontons_slip_scenarios
