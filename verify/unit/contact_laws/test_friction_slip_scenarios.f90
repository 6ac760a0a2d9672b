!> Tests of the slip scenarios: trial traction, and the scenario table row by row with its angles, safeguards, cut and bounds.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_friction_slip_scenarios
  use amontons_kinds, only: DP, PI
  use amontons_surfaces, only: ROUGH_FRICTION
  use amontons_friction_slip_scenarios, only: trial_traction_type, slip_state_type, slip_controls_type, slip_result_type, &
    split_nodal_imbalance, &
    evaluate_trial_traction, friction_limit, is_friction_capped, classify_slip_scenarios, find_bounded_step_length, STATUS_OPEN, &
    STATUS_STICK, STATUS_SLIP, STATUS_BALANCED, STATUS_OPENS, STATUS_CLOSES, SCENARIO_NONE, SCENARIO_I, SCENARIO_II, SCENARIO_III, &
    SCENARIO_IV, NO_FRICTION_LIMIT, CONTACT_OPEN, CONTACT_CLOSED, CONTACT_KEPT
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: MU = 0.3_DP
  call check_split(suite)
  call check_trial(suite)
  call check_bilateral(suite)
  call check_rows_by_number(suite)
  call check_rows_in_all_directions(suite)
  call check_linear_node(suite)
  call check_cut(suite)
  call check_guards(suite)
  call check_states(suite)
  call check_many(suite)
  call check_limit(suite)
  call check_limits_of_nodes(suite)
  call suite%finish()

contains

  subroutine check_split(suite)
    type(suite_type), intent(inout) :: suite
    real(DP) :: N, Rt(3)
    real(DP), parameter :: NORMAL(3) = [0.6_DP, 0.0_DP, 0.8_DP]
    call split_nodal_imbalance([1.0_DP, 2.0_DP, -3.0_DP], NORMAL, N, Rt)
    call suite%near('N = -n.Rhat', N, 1.8_DP, 1.0e-14_DP)
    call suite%near('Rt is tangential', dot_product(Rt, NORMAL), 0.0_DP, 1.0e-14_DP)
    call suite%near('Rt = Rhat + N n', norm2(Rt - [2.08_DP, 2.0_DP, -1.56_DP]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_split


  !> Status by trial traction: each branch, with numbers that can be followed by hand; c = 10, normal z.
  subroutine check_trial(suite)
    type(suite_type), intent(inout) :: suite
    type(trial_traction_type) :: trial
    real(DP), parameter :: NORMAL(3) = [0.0_DP, 0.0_DP, 1.0_DP], NONE(3) = 0, C = 10
    call evaluate_trial_traction([2.0_DP, 0.0_DP, -10.0_DP], 0.0_DP, NONE, NORMAL, MU, C, CONTACT_CLOSED, 1.0e3_DP, trial)
    call suite%that('pressed, small shear: stick', trial%status == STATUS_STICK)
    call suite%near('sigma = N', trial%sigma, 10.0_DP, 1.0e-14_DP)
    call suite%near('tau = -Rt', norm2(trial%tau - [-2.0_DP, 0.0_DP, 0.0_DP]), 0.0_DP, 1.0e-14_DP)
    call evaluate_trial_traction([4.0_DP, 0.0_DP, -10.0_DP], 0.0_DP, NONE, NORMAL, MU, C, CONTACT_CLOSED, 1.0e3_DP, trial)
    call suite%that('pressed, large shear: slip', trial%status == STATUS_SLIP)
    call suite%near('friction against the drive', trial%direction(1), -1.0_DP, 1.0e-14_DP)
    call evaluate_trial_traction([2.0_DP, 0.0_DP, -10.0_DP], 0.0_DP, [0.05_DP, 0.0_DP, 7.0_DP], NORMAL, MU, C, CONTACT_CLOSED, &
      1.0e3_DP, trial)
    call suite%near('tau = -Rt - c P g', trial%tau(1), -2.5_DP, 1.0e-14_DP)
    call suite%near('the normal part of g does not count', trial%tau(3), 0.0_DP, 1.0e-14_DP)
    call suite%that('still stick', trial%status == STATUS_STICK)
    call evaluate_trial_traction([2.0_DP, 0.0_DP, -10.0_DP], 0.0_DP, [-0.06_DP, 0.0_DP, 0.0_DP], NORMAL, MU, C, CONTACT_CLOSED, &
      1.0e3_DP, trial)
    call suite%that('slip against the drive goes back to stick', trial%status == STATUS_STICK)
    call evaluate_trial_traction([0.0_DP, 0.0_DP, -10.0_DP], 0.9_DP, NONE, NORMAL, MU, C, CONTACT_CLOSED, 1.0e3_DP, trial)
    call suite%near('sigma = N - c g', trial%sigma, 1.0_DP, 1.0e-14_DP)
    call evaluate_trial_traction([0.0_DP, 0.0_DP, -10.0_DP], 1.0_DP, NONE, NORMAL, MU, C, CONTACT_CLOSED, 1.0e3_DP, trial)
    call suite%that('sigma = 0 is open', trial%status == STATUS_OPEN)
    call evaluate_trial_traction([0.0_DP, 0.0_DP, 1.0_DP], 0.0_DP, NONE, NORMAL, MU, C, CONTACT_CLOSED, 1.0e3_DP, trial)
    call suite%that('tension opens', trial%status == STATUS_OPEN)
    call evaluate_trial_traction([5.0_DP, 0.0_DP, -10.0_DP], 0.01_DP, NONE, NORMAL, MU, C, CONTACT_OPEN, 1.0e3_DP, trial)
    call suite%that('an open node with a gap stays open whatever its imbalance', trial%status == STATUS_OPEN)
    call evaluate_trial_traction([5.0_DP, 0.0_DP, 3.0_DP], -0.01_DP, NONE, NORMAL, MU, C, CONTACT_OPEN, 1.0e3_DP, trial)
    call suite%that('an open node that penetrates closes, as stick', trial%status == STATUS_STICK)
    call suite%near('its sigma', trial%sigma, 0.1_DP, 1.0e-14_DP)
    call evaluate_trial_traction([5.0_DP, 0.0_DP, 3.0_DP], -0.01_DP, [0.1_DP, 0.0_DP, 0.0_DP], NORMAL, MU, C, CONTACT_OPEN, &
      1.0e3_DP, trial)
    call suite%that('or as slip if it slid since it touched', trial%status == STATUS_SLIP .and. trial%direction(1) < 0)
    call evaluate_trial_traction([0.0_DP, 0.0_DP, -10.0_DP], 0.0_DP, NONE, NORMAL, 0.0_DP, C, CONTACT_CLOSED, 1.0e3_DP, trial)
    call suite%that('without friction a closed node slips', &
      trial%status == STATUS_SLIP .and. norm2(trial%direction) <= 0)
  end subroutine check_trial


  !> A node that bears tension: closed at any sigma; in tension it slips without friction, with ROUGH it sticks. Compression is as
  !! of any node. It has no status OPENS.
  subroutine check_bilateral(suite)
    type(suite_type), intent(inout) :: suite
    type(trial_traction_type) :: trial, unilateral
    type(slip_state_type) :: u
    type(slip_result_type) :: verdict
    real(DP), parameter :: NORMAL(3) = [0.0_DP, 0.0_DP, 1.0_DP], NONE(3) = 0, C = 10, CAP = 5
    real(DP), parameter :: SHEAR(2) = [2.0_DP, 4.0_DP]
    integer :: i
    call evaluate_trial_traction([0.0_DP, 0.0_DP, 1.0_DP], 0.0_DP, NONE, NORMAL, MU, C, CONTACT_KEPT, CAP, trial)
    call suite%that('bilateral: tension slips, without shear too', trial%status == STATUS_SLIP)
    call suite%near('bilateral: its sigma', trial%sigma, -1.0_DP, 0.0_DP)
    call evaluate_trial_traction([4.0_DP, 0.0_DP, 1.0_DP], 0.5_DP, NONE, NORMAL, ROUGH_FRICTION, C, CONTACT_KEPT, CAP, trial)
    call suite%that('bilateral: ROUGH sticks in tension', trial%status == STATUS_STICK)
    call evaluate_trial_traction([6.0_DP, 0.0_DP, 1.0_DP], 0.0_DP, NONE, NORMAL, ROUGH_FRICTION, C, CONTACT_KEPT, CAP, trial)
    call suite%that('bilateral: ROUGH slips at TAUMAX A', trial%status == STATUS_SLIP)
    do i = 1, size(SHEAR)
      call evaluate_trial_traction([SHEAR(i), 0.0_DP, -10.0_DP], 0.0_DP, NONE, NORMAL, MU, C, CONTACT_KEPT, CAP, trial)
      call evaluate_trial_traction([SHEAR(i), 0.0_DP, -10.0_DP], 0.0_DP, NONE, NORMAL, MU, C, CONTACT_CLOSED, CAP, unilateral)
      call suite%that('bilateral: compression as of any node', trial%status == unilateral%status)
    end do
    call suite%that('bilateral: limits', norm2(friction_limit([MU, MU, MU, ROUGH_FRICTION, ROUGH_FRICTION, 0.0_DP], [-1.0_DP, &
      10.0_DP, 20.0_DP, -1.0_DP, 1.0_DP, -1.0_DP], CAP, .true.) - [0.0_DP, 3.0_DP, 5.0_DP, 5.0_DP, 5.0_DP, 0.0_DP]) <= 0.0_DP)
    call suite%that('bilateral: limits that are constant', all(is_friction_capped([MU, MU, MU, ROUGH_FRICTION], [-1.0_DP, &
      10.0_DP, 20.0_DP, -1.0_DP], CAP, .true.) .eqv. [.true., .false., .true., .true.]))
    u = slip_state_type(STATUS_SLIP, -1.0_DP, [2.0_DP, 0.0_DP, 0.0_DP], 0.0_DP, [0.1_DP, 0.0_DP, 0.0_DP])
    call classify(u, u, [0.1_DP, 0.0_DP, 0.0_DP], verdict)
    call suite%that('bilateral: another node in tension opens', verdict%status == STATUS_OPENS)
    u%is_bilateral = .true.
    call classify(u, u, [0.1_DP, 0.0_DP, 0.0_DP], verdict)
    call expect(suite, 'bilateral: not enough slip', verdict, SCENARIO_II, 1.0_DP)
  end subroutine check_bilateral


  !> The four rows with numbers from the formulas: mu N = 3 in both configurations, angles of 60 degrees.
  subroutine check_rows_by_number(suite)
    type(suite_type), intent(inout) :: suite
    type(slip_result_type) :: verdict
    real(DP) :: rt_u(3), rt_ud(3), x(3)
    x = along(0.0_DP)
    rt_u = 5 * along(0.0_DP)
    rt_ud = 2 * along(60.0_DP)
    call classify(point(rt_u, 0 * rt_u), point(rt_ud, 0 * rt_u), 0.1_DP * x, verdict)
    call expect(suite, 'I: a = 2, b = 1', verdict, SCENARIO_I, 2.0_DP / 3.0_DP)
    rt_ud = 4 * along(60.0_DP)
    call classify(point(rt_u, 0 * rt_u), point(rt_ud, 0 * rt_u), 0.1_DP * x, verdict)
    call expect(suite, 'II: a = 2, b = 1, gamma = 60', verdict, SCENARIO_II, 2.0_DP / (2.0_DP - 0.5_DP))
    rt_u = 1 * along(60.0_DP)
    rt_ud = 4 * along(60.0_DP)
    call classify(point(rt_u, x), point(rt_ud, 0.9_DP * x), -0.1_DP * x, verdict)
    call expect(suite, 'III: a = 2, b = 1, beta = 60, theta = 60', verdict, SCENARIO_III, 1.0_DP / (0.5_DP + 1.0_DP))
    rt_ud = 2 * along(0.0_DP)
    rt_u = 2 * along(60.0_DP)
    call classify(point(0.5_DP * rt_u, x), point(rt_ud, 0.9_DP * x), -0.1_DP * x, verdict)
    call expect(suite, 'IV: a = 2, b = 1, beta = 60, theta = 0: no denominator', verdict, SCENARIO_IV, 1.0_DP)
    rt_ud = 2.5_DP * along(0.0_DP)
    call classify(point(0.5_DP * rt_u, x), point(rt_ud, 0.9_DP * x), -0.1_DP * x, verdict)
    call expect(suite, 'IV: a = 2, b = 0.5, beta = 60, theta = 0', verdict, SCENARIO_IV, 1.0_DP / (1.0_DP - 0.5_DP))
    call suite%near('numerator', verdict%numerator, -0.1_DP * (-2.0_DP * 0.5_DP), 1.0e-15_DP)
    call suite%near('denominator', verdict%denominator, -0.1_DP * (-0.5_DP) - 0.1_DP, 1.0e-15_DP)
    call suite%near('DR at u', verdict%DR_u, -2.0_DP, 1.0e-14_DP)
    call suite%near('DR at ud', verdict%DR_ud, -0.5_DP, 1.0e-14_DP)
  end subroutine check_rows_by_number


  !> For increments along t_u or -t_g the general formula is the table, in random directions of a random plane.
  subroutine check_rows_in_all_directions(suite)
    type(suite_type), intent(inout) :: suite
    real(DP), parameter :: RATIOS(8) = [0.618034_DP, 0.754878_DP, 0.569840_DP, 0.324718_DP, 0.220744_DP, 0.850651_DP, &
      0.671044_DP, 0.549700_DP]
    integer :: i, n(4)
    real(DP) :: r(8), t_u(3), t_d(3), t_g(3), normal(3), a, b, expected, d(3), worst, size_d
    type(slip_result_type) :: verdict
    n = 0
    worst = 0
    do i = 1, 400
      r = modulo(RATIOS * real(i, DP), 1.0_DP)
      normal = unit(r(1:3) - 0.5_DP)
      t_u = in_plane(normal, 2 * PI * r(4))
      t_d = in_plane(normal, 2 * PI * (r(4) + 0.4_DP * (r(5) - 0.5_DP)))
      t_g = in_plane(normal, 2 * PI * (r(4) + 0.3_DP * (r(6) - 0.5_DP)))
      size_d = 0.2_DP + r(7)
      a = 0.1_DP + r(8)
      b = 0.1_DP + r(1)
      select case (modulo(i, 4))
      case (0)
        d = size_d * t_u
        call classify(point((3 + a) * t_u, t_g), point((3 - b) * t_d, t_g), d, verdict)
        expected = table_length(SCENARIO_I, a, b, 0.0_DP, 0.0_DP, 0.0_DP)
      case (1)
        d = size_d * t_u
        call classify(point((3 + a) * t_u, t_g), point((3 + b) * t_d, t_g), d, verdict)
        expected = table_length(SCENARIO_II, a, b, 0.0_DP, dot_product(t_u, t_d), 0.0_DP)
      case (2)
        d = -size_d * t_g
        call classify(point((3 - a) * t_u, 99 * t_g), point((3 + b) * t_d, 99 * t_g + d), d, verdict)
        expected = table_length(SCENARIO_III, a, b, dot_product(t_u, t_g), 0.0_DP, dot_product(t_g, t_d))
      case default
        d = -size_d * t_g
        call classify(point((3 - a) * t_u, 9999 * t_g), point((3 - b) * t_d, 9999 * t_g + d), d, verdict)
        expected = table_length(SCENARIO_IV, a, b, dot_product(t_u, t_g), 0.0_DP, dot_product(t_g, t_d))
      end select
      if (expected < 0) expected = 1
      if (verdict%becomes_stick) cycle
      n(verdict%scenario) = n(verdict%scenario) + 1
      worst = max(worst, abs(verdict%alpha / expected - 1))
      if (verdict%scenario /= 1 + modulo(i, 4)) worst = huge(1.0_DP)
    end do
    call suite%that('all rows came', all(n > 90))
    call suite%near('general formula and table', worst, 0.0_DP, 1.0e-9_DP)
  end subroutine check_rows_in_all_directions


  !> A node on a spring: Rt = F - k s with N constant. I and II on a straight path reach equilibrium in one step.
  subroutine check_linear_node(suite)
    type(suite_type), intent(inout) :: suite
    type(slip_result_type) :: verdict
    real(DP) :: t(3), d(3), slip
    integer :: i
    t = unit([1.0_DP, -2.0_DP, 0.5_DP])
    do i = 1, 2
      d = merge(0.05_DP, 0.5_DP, i == 1) * t
      call classify(point(8 * t, 0 * t), point((8 - 20 * norm2(d)) * t, d), d, verdict)
      slip = verdict%alpha * norm2(d)
      call suite%that('spring: scenario', verdict%scenario == merge(SCENARIO_II, SCENARIO_I, i == 1))
      if (verdict%scenario == SCENARIO_II) call suite%near('spring: left is mu N', 8 - 20 * slip, 3.0_DP, 1.0e-12_DP)
      ! In I with opposite Rt the formula of the slides sets t_d = t_u: a / (a + b), a = 5, b = 1
      if (verdict%scenario == SCENARIO_I) call suite%near('spring: too far', verdict%alpha, 5.0_DP / 6, 1.0e-12_DP)
    end do
    d = 0.3_DP * t
    call classify(point(8 * t, 0 * t), point(2 * t, d), d, verdict)
    call suite%near('spring: I lands on balance', 8 - 20 * verdict%alpha * 0.3_DP, 3.0_DP, 1.0e-12_DP)
  end subroutine check_linear_node


  !> Backing up never passes zero slip: the cut ends there for every length of the step, and the node becomes stick.
  subroutine check_cut(suite)
    type(suite_type), intent(inout) :: suite
    real(DP), parameter :: STEPS(6) = [0.5_DP, 1.0_DP, 1.5_DP, 2.0_DP, 2.5_DP, 40.0_DP]
    type(slip_result_type) :: verdict
    type(slip_controls_type) :: controls
    type(slip_state_type) :: at_ud
    real(DP) :: t(3), g(3), d(3), alpha
    integer :: i
    t = along(25.0_DP)
    g = 0.2_DP * t
    do i = 1, 6
      d = -STEPS(i) * g
      call classify(point(1 * t, g), point(1.5_DP * t, g + d), d, verdict)
      call suite%that('IV: becomes stick', verdict%scenario == SCENARIO_IV .and. verdict%becomes_stick)
      call suite%near('IV: at zero slip', norm2(g + verdict%alpha * d), 0.0_DP, 1.0e-15_DP)
    end do
    d = -4 * g
    call classify(point(1 * t, g), point(3.1_DP * t, g + d), d, verdict)
    call suite%that('III: is cut too', verdict%scenario == SCENARIO_III .and. verdict%becomes_stick)
    call suite%near('III: at zero slip', norm2(g + verdict%alpha * d), 0.0_DP, 1.0e-15_DP)
    d = -0.5_DP * g
    call classify(point(1 * t, g), point(4 * t, g + d), d, verdict)
    call suite%that('III: not cut where it stops before', (.not. verdict%becomes_stick))
    call suite%near('III: there its own length', verdict%alpha, 2.0_DP / 3.0_DP, 1.0e-14_DP)
    d = -1 * g                                       ! a = b, angles zero: alpha = 1/2 by the formula, half the distance back
    call classify(point(2 * t, g), point(4 * t, g + d), d, verdict)
    call suite%that('III: half way is not zero', &
      .not. verdict%becomes_stick .and. abs(verdict%alpha - 0.5_DP) < 1.0e-14_DP)
    ! The full step ends at zero slip exactly, and the safeguard gives 1.
    call classify(point(1 * t, g), point(1 * t, 0 * g), -1 * g, verdict)
    call suite%that('a full step that ends at zero slip is stick', &
      verdict%becomes_stick .and. abs(verdict%alpha - 1) < 1.0e-14_DP)
    ! A slip that turns: |g_d| = |g| although the projection is behind zero. The slides' cap would be infinite.
    d = -1.5_DP * g + 0.15_DP * along(115.0_DP)
    call classify(point(1 * t, g), point(2.9_DP * t, g + d), d, verdict)
    alpha = verdict%alpha
    call suite%that('a general direction is cut', verdict%becomes_stick)
    call suite%near('where the projection vanishes', dot_product(t, g + alpha * d), 0.0_DP, 1.0e-15_DP)
    ! A node that is open after the step has no slip there: nothing is cut.
    at_ud = point(2.9_DP * t, 0 * g)
    at_ud%status = STATUS_OPEN
    call classify(point(1 * t, g), at_ud, -1 * g, verdict)
    call suite%that('a node that opens does not become stick', verdict%scenario == SCENARIO_IV .and. .not. verdict%becomes_stick)
    ! Moving on instead of back is never cut; the bounds do not apply to the cut.
    call classify(point(1 * t, g), point(2.9_DP * t, 2 * g), g, verdict)
    call suite%that('moving on is not cut', (.not. verdict%becomes_stick))
    controls%alpha_min = 0.25_DP
    controls%alpha_max = 1.01_DP
    call classify(point(1 * t, g), point(2.9_DP * t, -9 * g), -10 * g, verdict, controls)
    call suite%near('the cut may go below the least length', verdict%alpha, 0.1_DP, 1.0e-14_DP)
    call classify(point(1 * t, g), point(2.9_DP * t, 0.9_DP * g), -0.1_DP * g, verdict, controls)
    call suite%near('but never above the largest', verdict%alpha, 1.01_DP, 1.0e-14_DP)
    call suite%that('and then it is not stick', (.not. verdict%becomes_stick))
  end subroutine check_cut


  !> Vanishing denominators and negative lengths mean 1; bounds; missing directions.
  subroutine check_guards(suite)
    type(suite_type), intent(inout) :: suite
    type(slip_result_type) :: verdict
    type(slip_controls_type) :: controls
    real(DP) :: t(3), zero(3)
    t = along(10.0_DP)
    zero = 0
    call classify(point(5 * t, zero), point(5 * t, 0.1_DP * t), 0.1_DP * t, verdict)
    call expect(suite, 'II: nothing changed', verdict, SCENARIO_II, 1.0_DP)
    call classify(point(5 * t, zero), point(6 * t, 0.1_DP * t), 0.1_DP * t, verdict)
    call expect(suite, 'II: it grows', verdict, SCENARIO_II, 1.0_DP)
    call classify(point(5 * t, zero), point(2 * t, zero), zero, verdict)
    call expect(suite, 'I: no increment', verdict, SCENARIO_I, 1.0_DP)
    call classify(point(5 * t, zero), point(1 * t, zero), 0.1_DP * along(100.0_DP), verdict)
    call expect(suite, 'I: increment across', verdict, SCENARIO_I, 1.0_DP)
    controls%alpha_max = 1.5_DP
    controls%alpha_min = 0.4_DP
    call classify(point(5 * t, zero), point(4.9_DP * t, zero), t, verdict, controls)
    call expect(suite, 'II: upper bound', verdict, SCENARIO_II, 1.5_DP)
    call classify(point(3.1_DP * t, zero), point(1 * t, zero), t, verdict, controls)
    call expect(suite, 'I: lower bound', verdict, SCENARIO_I, 0.4_DP)
    call suite%near('guarded: plain', find_bounded_step_length(-1.0_DP, 2.0_DP, controls), 0.5_DP, 1.0e-15_DP)
    call suite%near('guarded: no denominator', find_bounded_step_length(1.0_DP, 1.0e-14_DP, controls), 1.0_DP, 0.0_DP)
    call suite%near('guarded: negative', find_bounded_step_length(1.0_DP, 2.0_DP, controls), 1.0_DP, 0.0_DP)
    call suite%near('guarded: nothing at all', find_bounded_step_length(0.0_DP, 0.0_DP, controls), 1.0_DP, 0.0_DP)
    ! N < 0 after the step carries no friction: DR = |Rt|.
    call classify(point(5 * t, zero), slip_state_type(status=STATUS_SLIP, N=-4.0_DP, Rt=1 * t), t, verdict)
    call expect(suite, 'II: N < 0 at ud', verdict, SCENARIO_II, 2.0_DP)
    ! Rt = 0 with some slip: t_u := t_g, so e(u) = -3 t_g.
    call classify(point(zero, 9 * t), point(1 * t, 8.9_DP * t), -0.1_DP * t, verdict)
    call expect(suite, 'IV: Rt = 0 at u', verdict, SCENARIO_IV, 3.0_DP)
    call classify(point(1 * t, 9 * t), point(zero, 8.9_DP * t), -0.1_DP * t, verdict)
    call expect(suite, 'IV: Rt = 0 at ud', verdict, SCENARIO_IV, 1.0_DP)
    call classify(point(5 * t, zero), point(3 * t, zero), t, verdict)
    call expect(suite, 'in balance after the step', verdict, SCENARIO_I, 1.0_DP)
  end subroutine check_guards


  !> The states without a scenario.
  subroutine check_states(suite)
    type(suite_type), intent(inout) :: suite
    type(slip_result_type) :: verdict
    type(slip_controls_type) :: controls
    type(slip_state_type) :: at
    real(DP) :: t(3), zero(3)
    t = along(200.0_DP)
    zero = 0
    call classify(slip_state_type(), slip_state_type(), zero, verdict)
    call suite%that('state: open', verdict%status == STATUS_OPEN .and. verdict%scenario == SCENARIO_NONE)
    call expect_state(suite, slip_state_type(Rt=9 * t), controls, STATUS_CLOSES, 'closes')
    call expect_state(suite, slip_state_type(status=STATUS_SLIP, N=-1.0e-9_DP, Rt=t), controls, STATUS_OPENS, 'opens')
    call expect_state(suite, point(2 * t, zero), controls, STATUS_STICK, 'stick')
    call expect_state(suite, point(zero, zero), controls, STATUS_STICK, 'no force and no slip')
    call expect_state(suite, point(2 * t, t), controls, STATUS_SLIP, 'slip to take back')
    call expect_state(suite, point(4 * t, zero), controls, STATUS_SLIP, 'slip to come')
    call expect_state(suite, point((3 + 1.0e-13_DP) * t, t), controls, STATUS_BALANCED, 'balance above')
    call expect_state(suite, point((3 - 1.0e-13_DP) * t, t), controls, STATUS_BALANCED, 'balance below')
    call expect_state(suite, point((3 + 1.0e-13_DP) * t, zero), controls, STATUS_STICK, 'at the limit without slip')
    call expect_state(suite, point(3.001_DP * t, t), controls, STATUS_SLIP, 'out of balance')
    controls%slip_tolerance = 1.0e-3_DP
    call expect_state(suite, point(3.001_DP * t, t), controls, STATUS_BALANCED, 'a wider balance')
    controls%slip_tolerance = 0
    controls%force_zero = 0.01_DP
    call expect_state(suite, point(3.009_DP * t, t), controls, STATUS_BALANCED, 'a balance in force')
    at = point(2 * t, 0.4_DP * t)
    at%slip_zero = 0.5_DP
    call expect_state(suite, at, controls, STATUS_STICK, 'a slip that counts as none')
    controls = slip_controls_type()
    call classify(point(3 * t, t), point(5 * t, 2 * t), t, verdict, controls)
    call suite%near('balance adds to the global denominator', verdict%denominator, 2.0_DP, 1.0e-14_DP)
  end subroutine check_states


  !> At u the given node: its state, and for all but slip no scenario and a full step.
  subroutine expect_state(suite, at_u, controls, expected, name)
    type(suite_type), intent(inout) :: suite
    type(slip_state_type), intent(in) :: at_u
    type(slip_controls_type), intent(in) :: controls
    integer, intent(in) :: expected
    character(*), intent(in) :: name
    type(slip_result_type) :: verdict
    real(DP) :: t(3)
    t = along(200.0_DP)
    call classify(at_u, point(4 * t, 0 * t), 0.1_DP * t, verdict, controls)
    call suite%that('state: ' // name, verdict%status == expected)
    call suite%that('state: ' // name // ', scenario', &
      (verdict%scenario == SCENARIO_NONE) .eqv. (expected /= STATUS_SLIP))
    if (expected /= STATUS_SLIP) call suite%near('state: ' // name // ', length', verdict%alpha, 1.0_DP, 0.0_DP)
  end subroutine expect_state


  !> Many nodes at once, one in each scenario and one that opens.
  subroutine check_many(suite)
    type(suite_type), intent(inout) :: suite
    integer, parameter :: M = 5
    real(DP), parameter :: AT_U(M) = [5.0_DP, 5.0_DP, 1.0_DP, 1.0_DP, 1.0_DP]     ! Rt along t
    real(DP), parameter :: AT_UD(M) = [2.0_DP, 4.0_DP, 4.0_DP, 2.0_DP, 1.0_DP]
    real(DP), parameter :: G_U(M) = [0.0_DP, 0.0_DP, 0.2_DP, 0.2_DP, 0.0_DP], G_UD(M) = [0.0_DP, 0.0_DP, 0.1_DP, -0.1_DP, 0.0_DP]
    type(slip_state_type) :: u(M), ud(M)
    type(slip_result_type) :: verdicts(M)
    real(DP) :: d(3, M), t(3)
    integer :: i
    t = along(33.0_DP)
    u = [(point(AT_U(i) * t, G_U(i) * t), i=1, M)]
    ud = [(point(AT_UD(i) * t, G_UD(i) * t), i=1, M)]
    u(5)%N = -1
    d = spread(t, 2, M) * spread([0.1_DP, 0.1_DP, -0.1_DP, -0.3_DP, 0.1_DP], 1, 3)
    call classify_slip_scenarios(u, ud, d, slip_controls_type(), verdicts)
    call suite%that('many: scenarios', &
      all(verdicts%scenario == [SCENARIO_I, SCENARIO_II, SCENARIO_III, SCENARIO_IV, SCENARIO_NONE]))
    call suite%that('many: states', all(verdicts%status == [STATUS_SLIP, STATUS_SLIP, STATUS_SLIP, STATUS_SLIP, STATUS_OPENS]))
    call suite%that('many: one is cut at zero slip', all(verdicts%becomes_stick .eqv. [(i == 4, i=1, M)]))
    call suite%near('many: lengths', &
      norm2(verdicts%alpha - [2.0_DP / 3, 2.0_DP, 2.0_DP / 3, 2.0_DP / 3, 1.0_DP]), 0.0_DP, 1.0e-14_DP)
  end subroutine check_many


  !> The friction limit: mu N, capped, homogeneous; a straight line below N = 0. The trial traction slips where it is exceeded.
  subroutine check_limit(suite)
    type(suite_type), intent(inout) :: suite
    type(trial_traction_type) :: trial
    real(DP), parameter :: NORMAL(3) = [0.0_DP, 0.0_DP, 1.0_DP], NONE(3) = 0
    real(DP), parameter :: PULL(3) = [1.0_DP, 0.0_DP, -10.0_DP]   ! |Rt| = 1, N = 10
    call suite%near('limit: mu N', friction_limit(MU, 10.0_DP, 5.0_DP), 3.0_DP, 1.0e-15_DP)
    call suite%near('limit: capped', friction_limit(MU, 20.0_DP, 5.0_DP), 5.0_DP, 0.0_DP)
    call suite%that('limit: is capped', all(is_friction_capped(MU, [10.0_DP, 20.0_DP], 5.0_DP) .eqv. [.false., .true.]))
    call suite%near('limit: a straight line below N = 0', friction_limit(MU, -10.0_DP, 5.0_DP), -3.0_DP, 1.0e-15_DP)
    call suite%near('limit: of stresses', 4 * friction_limit(MU, 20.0_DP / 4, 5.0_DP / 4), 5.0_DP, 1.0e-15_DP)
    call evaluate_trial_traction(PULL, 0.0_DP, NONE, NORMAL, MU, 10.0_DP, CONTACT_CLOSED, 1.01_DP, trial)
    call suite%that('limit: below TAUMAX A it sticks', trial%status == STATUS_STICK)
    call evaluate_trial_traction(PULL, 0.0_DP, NONE, NORMAL, MU, 10.0_DP, CONTACT_CLOSED, 0.99_DP, trial)
    call suite%that('limit: above it slips', trial%status == STATUS_SLIP)
  end subroutine check_limit


  !> Effect of the friction limit on the scenario: TAUMAX, no limit, and zero (frictionless).
  subroutine check_limits_of_nodes(suite)
    type(suite_type), intent(inout) :: suite
    type(slip_result_type) :: verdict
    type(slip_controls_type) :: controls
    type(slip_state_type) :: u, ud
    real(DP) :: t(3), zero(3)
    t = along(70.0_DP)
    zero = 0
    u = point(1.5_DP * t, 0.2_DP * t)               ! slides at TAUMAX A = 1.5 while mu N = 3
    ud = point(1.5_DP * t, 0.3_DP * t)
    call classify(u, ud, 0.1_DP * t, verdict)
    call suite%that('TAUMAX: with mu N it would be backing up', verdict%scenario == SCENARIO_IV)
    u%limit = friction_limit(MU, u%N, 1.5_DP)
    ud%limit = u%limit
    call classify(u, ud, 0.1_DP * t, verdict)
    call suite%that('TAUMAX: slip in equilibrium', verdict%status == STATUS_BALANCED .and. verdict%scenario == SCENARIO_NONE)
    u%Rt = 2.5_DP * t
    ud%Rt = 2 * t
    call classify(u, ud, 0.1_DP * t, verdict)
    call expect(suite, 'TAUMAX: not enough slip', verdict, SCENARIO_II, 2.0_DP)
    u = point(5 * t, 0.2_DP * t)
    u%limit = NO_FRICTION_LIMIT
    call classify(u, point(5 * t, zero), -0.2_DP * t, verdict)
    call suite%that('no limit: stick', verdict%status == STATUS_STICK .and. verdict%scenario == SCENARIO_NONE)
    call suite%near('no limit: adds nothing to a global length', abs(verdict%numerator) + abs(verdict%denominator), 0.0_DP, 0.0_DP)
    ud = point(9 * t, zero)
    ud%limit = NO_FRICTION_LIMIT
    call classify(point(5 * t, zero), ud, 0.1_DP * t, verdict)
    call expect(suite, 'no limit after the step', verdict, SCENARIO_I, 1.0_DP)
    u = without_friction(4 * t, zero)
    call classify(u, without_friction(1 * t, 0.1_DP * t), 0.1_DP * t, verdict)
    call expect(suite, 'frictionless: not enough slip', verdict, SCENARIO_II, 4.0_DP / 3.0_DP)
    call suite%near('frictionless: DR = |Rt|', verdict%DR_u, 4.0_DP, 1.0e-15_DP)
    call classify(u, without_friction(-1 * t, 0.1_DP * t), 0.1_DP * t, verdict)
    call expect(suite, 'frictionless: passed, in the vector', verdict, SCENARIO_II, 4.0_DP / 5.0_DP)
    call classify(u, without_friction(zero, 0.1_DP * t), 0.1_DP * t, verdict)
    call expect(suite, 'frictionless: Rt is gone', verdict, SCENARIO_I, 1.0_DP)
    controls%force_zero = 0.01_DP
    call classify(without_friction(0.009_DP * t, 0.1_DP * t), u, 0.1_DP * t, verdict, controls)
    call suite%that('frictionless: in equilibrium by a force', verdict%status == STATUS_BALANCED)
    call classify(without_friction(0.009_DP * t, zero), u, 0.1_DP * t, verdict, controls)
    call suite%that('frictionless: without slip it stands', verdict%status == STATUS_STICK)
  end subroutine check_limits_of_nodes


  !> One node by the procedure for many.
  subroutine classify(at_u, at_ud, d, verdict, controls)
    type(slip_state_type), intent(in) :: at_u, at_ud
    real(DP), intent(in) :: d(3)
    type(slip_result_type), intent(out) :: verdict
    type(slip_controls_type), intent(in), optional :: controls
    type(slip_controls_type) :: bounds
    type(slip_result_type) :: verdicts(1)
    if (present(controls)) bounds = controls
    call classify_slip_scenarios([at_u], [at_ud], reshape(d, [3, 1]), bounds, verdicts)
    verdict = verdicts(1)
  end subroutine classify


  !> The step length of the slides' table, for a search along t_u (I, II) or -t_g (III, IV); unguarded and unbounded.
  pure function table_length(scenario, a, b, cos_beta, cos_gamma, cos_theta) result(alpha)
    integer, intent(in) :: scenario                   !< SCENARIO_...
    real(DP), intent(in) :: a, b                      !< |DR(u)|, |DR(ud)| [force]
    real(DP), intent(in) :: cos_beta, cos_gamma, cos_theta   !< [-]
    real(DP) :: alpha
    alpha = 1
    if (scenario == SCENARIO_I) alpha = a / (b + a)
    if (scenario == SCENARIO_II) alpha = a / (a - b * cos_gamma)
    if (scenario == SCENARIO_III) alpha = a * cos_beta / (b * cos_theta + a * cos_beta)
    if (scenario == SCENARIO_IV) alpha = a * cos_beta / (a * cos_beta - b * cos_theta)
  end function table_length


  subroutine expect(suite, name, verdict, scenario, alpha)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: name
    type(slip_result_type), intent(in) :: verdict
    integer, intent(in) :: scenario
    real(DP), intent(in) :: alpha
    call suite%that(name // ': scenario', verdict%scenario == scenario .and. verdict%status == STATUS_SLIP)
    call suite%near(name // ': length', verdict%alpha, alpha, 1.0e-13_DP * alpha)
  end subroutine expect


  !> A closed node with N = 10, so mu N = 3.
  pure function point(Rt, slip) result(at)
    real(DP), intent(in) :: Rt(3), slip(3)
    type(slip_state_type) :: at
    at = slip_state_type(STATUS_SLIP, 10.0_DP, Rt, friction_limit(MU, 10.0_DP, NO_FRICTION_LIMIT), slip)
  end function point


  !> The same without friction.
  pure function without_friction(Rt, slip) result(at)
    real(DP), intent(in) :: Rt(3), slip(3)
    type(slip_state_type) :: at
    at = slip_state_type(status=STATUS_SLIP, N=10.0_DP, Rt=Rt, slip=slip)
  end function without_friction


  !> The unit vector in the plane z = 0 at an angle.
  pure function along(degrees) result(t)
    real(DP), intent(in) :: degrees
    real(DP) :: t(3)
    t = [cos(degrees * PI / 180), sin(degrees * PI / 180), 0.0_DP]
  end function along


  pure function unit(v) result(u)
    real(DP), intent(in) :: v(3)
    real(DP) :: u(3)
    u = v / norm2(v)
  end function unit


  !> A unit vector normal to another.
  pure function in_plane(normal, angle) result(t)
    real(DP), intent(in) :: normal(3), angle
    real(DP) :: t(3), e(3), f(3)
    e = unit([normal(2) - normal(3), normal(3) - normal(1), normal(1) - normal(2)])
    f = [normal(2) * e(3) - normal(3) * e(2), normal(3) * e(1) - normal(1) * e(3), normal(1) * e(2) - normal(2) * e(1)]
    t = cos(angle) * e + sin(angle) * f
  end function in_plane

end program test_friction_slip_scenarios
