!> Tests of the local equilibrium: at the actual position in equilibrium, its conditions elsewhere, and Newton's iterations of a
!! node on springs.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_slave_node_equilibrium
  use amontons_kinds, only: DP
  use amontons_tensor, only: outer_product, IDENTITY
  use amontons_surfaces, only: interaction_type, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED, &
    ROUGH_FRICTION
  use amontons_pressure_overclosure, only: evaluate_pressure_overclosure, find_activation_gap
  use amontons_slave_node_equilibrium, only: local_solution_type, local_problem_type, solve_local_problem
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(interaction_type) :: laws(6)
  laws = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=500.0_DP, cutoff_clearance=0.0_DP, stick_slope=120.0_DP, &
    friction=0.3_DP)
  laws(2)%tension_limit = 2.0_DP
  laws(2)%cutoff_clearance = 10.0_DP
  laws(3)%behavior = BEHAVIOR_EXPONENTIAL
  laws(3)%cutoff_clearance = 0.3_DP
  laws(3)%pressure = 15.0_DP
  laws(4)%behavior = BEHAVIOR_TABULAR
  laws(4)%cutoff_clearance = 1.0_DP
  laws(4)%table_pressure = [0.0_DP, 12.0_DP, 40.0_DP, 41.0_DP]
  laws(4)%table_overclosure = [-0.05_DP, 0.02_DP, 0.07_DP, 0.4_DP]
  laws(5)%behavior = BEHAVIOR_TIED
  laws(6)%shear_limit = 1.0_DP
  call check_shear()
  call check_equilibrium()
  call check_elsewhere()
  call check_iterations()
  call check_bilateral()
  call suite%finish()

contains

  !> Below the limit all slip is elastic; beyond it the force is the limit and the rest of the displacement is slip. The law at the
  !! actual position of the node.
  subroutine check_shear()
    type(interaction_type) :: law
    type(local_solution_type) :: solution
    law = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=10.0_DP, stick_slope=2.0_DP, friction=1.05_DP)
    call solve_local_problem(law, place(law, 1.0_DP, [3.0_DP, 4.0_DP, 0.0_DP]), solution)
    call suite%that('shear: sticks', .not. (solution%is_slipping .or. solution%is_open))
    call suite%near('shear: pressure', solution%pressure, 10.0_DP, 1.0e-14_DP)
    call suite%near('shear: elastic', solution%elastic(1), 3.0_DP, 1.0e-14_DP)
    call suite%near('shear: no slip', norm2(solution%slip), 0.0_DP, 0.0_DP)
    call suite%near('shear: energy', solution%energy, 5.0_DP + 25.0_DP, 1.0e-13_DP)
    law%friction = 0.4_DP
    call solve_local_problem(law, place(law, 1.0_DP, [3.0_DP, 4.0_DP, 0.0_DP]), solution)
    call suite%that('shear: slips', solution%is_slipping)
    call suite%near('shear: at the limit', norm2(solution%shear), 4.0_DP, 1.0e-14_DP)
    call suite%near('shear: slip and elastic slip make the whole', norm2(solution%elastic + solution%slip), 5.0_DP, 1.0e-14_DP)
    call suite%near('shear: slip', solution%slip(2), 2.4_DP, 1.0e-14_DP)
    call check_tie(law)
    law%stick_slope = 0.0_DP
    law%friction = 0.0_DP
    call solve_local_problem(law, place(law, 1.0_DP, [3.0_DP, 4.0_DP, 0.0_DP]), solution)
    call suite%that('shear: frictionless slips', solution%is_slipping .and. norm2(solution%elastic) <= 0.0_DP)
  end subroutine check_shear


  !> A node that touches without pressure has no friction: it sticks as long as its slip is rounding, beyond that it slips freely.
  subroutine check_tie(law)
    type(interaction_type), intent(in) :: law
    type(local_problem_type) :: problem
    type(local_solution_type) :: solution
    problem = place(law, 0.0_DP, [3.0e-17_DP, 4.0e-17_DP, 0.0_DP])
    problem%slip_rounding = 1.0e-16_DP
    call solve_local_problem(law, problem, solution)
    call suite%that('no pressure: sticks', .not. (solution%is_slipping .or. solution%is_open))
    problem%slip = 3 * problem%slip
    call solve_local_problem(law, problem, solution)
    call suite%that('no pressure: slips', solution%is_slipping)
    call suite%near('no pressure: no shear', norm2(solution%shear), 0.0_DP, 0.0_DP)
  end subroutine check_tie


  !> A node in equilibrium: the force of the law balances the imbalance, so the solution is the actual position for any stiffness.
  subroutine check_equilibrium()
    real(DP), parameter :: AT(5) = [-0.2_DP, 0.0_DP, 0.01_DP, 0.06_DP, 0.3_DP], SLIPS(3) = [0.0_DP, 0.005_DP, 0.4_DP], &
      STIFFNESS(3) = [1.0e-2_DP, 1.0e2_DP, 1.0e9_DP]
    type(local_problem_type) :: problem
    type(local_solution_type) :: solution, law_alone
    integer :: l, i, j, k
    do l = 1, size(laws)
      do i = 1, size(AT)
        do j = 1, size(SLIPS)
          problem = place(laws(l), AT(i), SLIPS(j) * [0.6_DP, 0.8_DP, 0.0_DP])
          call solve_local_problem(laws(l), problem, law_alone)
          problem%imbalance = -force_of(problem, law_alone)
          problem%free = IDENTITY - outer_product([0.0_DP, 1.0_DP, 0.0_DP], [0.0_DP, 1.0_DP, 0.0_DP])   ! a support takes the rest
          do k = 1, size(STIFFNESS)
            problem%stiffness = STIFFNESS(k)
            call solve_local_problem(laws(l), problem, solution)
            call suite%that('equilibrium: open or not', solution%is_open .eqv. law_alone%is_open)
            if (SLIPS(j) > 0.0_DP .and. abs(norm2(law_alone%shear) - limit_of(laws(l), law_alone)) > 1.0e-9_DP) &
              call suite%that('equilibrium: sticks or slips', solution%is_slipping .eqv. law_alone%is_slipping)
            call suite%near('equilibrium: force', norm2(force_of(problem, solution) - force_of(problem, law_alone)), 0.0_DP, &
              1.0e-9_DP * (1.0_DP + norm2(force_of(problem, law_alone))))
            call suite%near('equilibrium: nothing ahead', norm2(solution%law_linearization_force), 0.0_DP, &
              1.0e-6_DP * (1.0_DP + norm2(problem%imbalance)))
          end do
        end do
      end do
    end do
  end subroutine check_equilibrium


  !> Any node: A p(h') = N + c (h - h') with N the required normal force, the required shear up to its limit.
  subroutine check_elsewhere()
    real(DP), parameter :: AT(4) = [-0.02_DP, 0.01_DP, 0.06_DP, 0.3_DP], PULL(4) = [-30.0_DP, -1.0_DP, 0.0_DP, 5.0_DP]
    type(local_problem_type) :: problem
    type(local_solution_type) :: solution
    real(DP) :: h, p, slope, energy
    integer :: l, i, j
    do l = 1, size(laws)
      do i = 1, size(AT)
        do j = 1, size(PULL)
          problem = place(laws(l), AT(i), [0.02_DP, 0.0_DP, 0.0_DP])
          problem%stiffness = 40.0_DP
          problem%free = IDENTITY
          problem%imbalance = [-3.0_DP, 1.0_DP, PULL(j)]
          call solve_local_problem(laws(l), problem, solution)
          h = problem%overclosure + (-PULL(j) - problem%area * solution%pressure) / problem%stiffness
          if (solution%is_open) then
            call suite%that('elsewhere: beyond the reach', -h > find_activation_gap(laws(l), &
              problem%area) .or. laws(l)%tension_limit > 0.0_DP)
            call suite%near('elsewhere: open', norm2(force_of(problem, solution)), 0.0_DP, 0.0_DP)
            cycle
          end if
          call evaluate_pressure_overclosure(laws(l), h, p, slope, energy)
          call suite%near('elsewhere: pressure', solution%pressure, p, 1.0e-8_DP * (1.0_DP + abs(p)))
          call suite%that('elsewhere: shear within its limit', norm2(solution%shear) <= limit_of(laws(l), solution) &
            * (1.0_DP + 1.0e-12_DP))
          if (.not. solution%is_slipping) call suite%near('elsewhere: elastic', norm2(120.0_DP * problem%area * solution%elastic &
            + solution%shear), 0.0_DP, 1.0e-12_DP)
        end do
      end do
    end do
  end subroutine check_elsewhere


  !> A node on springs C that hold it at x0, pressed on a plane under LINEAR K: depth d of x0 gives N = C d/(1 + C/(K A)); it slips
  !! by what mu N leaves of its displacement. From a start deeper than x0 and off its path Newton's method takes no more iterations
  !! for a law of 1e9 C than for one of 1000 C.
  subroutine check_iterations()
    real(DP), parameter :: C = 3.0_DP, DEPTH = 0.2_DP, AREA = 0.7_DP, WAY(3) = [0.5_DP, -0.3_DP, 0.0_DP], STIFF(4) = [1.0_DP, &
      1.0e3_DP, 1.0e6_DP, 1.0e9_DP]
    integer, parameter :: N_ITERATIONS(4) = [2, 4, 4, 4]
    type(interaction_type) :: law
    type(local_problem_type) :: problem
    type(local_solution_type) :: solution
    real(DP) :: x(3), x0(3), J(3, 3), left(3), N
    integer :: i, n_done
    x0 = [0.0_DP, 0.0_DP, -DEPTH] + WAY
    do i = 1, size(STIFF)
      law = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=C * STIFF(i) / AREA, stick_slope=0.1_DP * C * STIFF(i) / AREA, &
        friction=0.4_DP)
      x = [0.2_DP, 0.7_DP, -1.5_DP * DEPTH]
      do n_done = 0, 20
        problem = place(law, -x(3), [x(1), x(2), 0.0_DP])
        problem%area = AREA
        problem%stiffness = 2.0_DP * C                 ! not that of the springs: only its order of magnitude matters
        problem%free = IDENTITY
        problem%imbalance = C * (x0 - x)
        call solve_local_problem(law, problem, solution)
        left = problem%imbalance + force_of(problem, solution)
        if (norm2(left) <= 1.0e-11_DP) exit
        J = C * IDENTITY + solution%slope * AREA * outer_product(problem%normal, problem%normal) &
          - outer_product(solution%d_force_d_gap, problem%normal) &
          - matmul(solution%d_force_d_slip, IDENTITY - outer_product(problem%normal, problem%normal))
        x = x + solved(J, left + solution%law_linearization_force)
      end do
      N = C * DEPTH / (1.0_DP + 1.0_DP / STIFF(i))
      call suite%near('iterations: pressure', solution%pressure * AREA, N, 1.0e-9_DP)
      call suite%near('iterations: way', norm2(x(:2)), norm2(WAY) - 0.4_DP * N / C, 1.0e-9_DP)
      call suite%that('iterations: slips', solution%is_slipping)
      call suite%near('iterations: count', real(n_done, DP), real(N_ITERATIONS(i), DP), 0.0_DP)
    end do
  end subroutine check_iterations


  !> A node that bears tension: LINEAR without a tension of its own is K h at any gap, in equilibrium with the body too; friction is
  !! that of compression, with ROUGH without limit.
  subroutine check_bilateral()
    real(DP), parameter :: AT(3) = [-0.3_DP, -1.0e-3_DP, 0.2_DP], SLIP(3) = [0.3_DP, 0.4_DP, 0.0_DP]
    type(interaction_type) :: law
    type(local_problem_type) :: problem
    type(local_solution_type) :: solution, elsewhere
    integer :: i
    law = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=20.0_DP, stick_slope=20.0_DP, friction=0.4_DP)
    do i = 1, size(AT)
      problem = place(law, AT(i), SLIP)
      call solve_local_problem(law, problem, solution)
      call suite%that('bilateral: else it opens', solution%is_open .eqv. AT(i) < 0.0_DP)
      problem%is_bilateral = .true.
      call solve_local_problem(law, problem, solution)
      call suite%near('bilateral: pressure', solution%pressure, 20.0_DP * AT(i), 1.0e-14_DP)
      call suite%near('bilateral: shear', norm2(solution%shear), 0.4_DP * 20.0_DP * max(AT(i), 0.0_DP) * problem%area, 1.0e-14_DP)
      problem%stiffness = 3.0_DP
      problem%free = IDENTITY
      problem%imbalance = [0.0_DP, 0.0_DP, 1.0_DP]
      call solve_local_problem(law, problem, elsewhere)
      call suite%near('bilateral: A p = N + c (h - h'')', elsewhere%pressure * problem%area, -1.0_DP + 3.0_DP * (AT(i) - &
        elsewhere%pressure / 20.0_DP), 1.0e-12_DP)
    end do
    law%friction = ROUGH_FRICTION
    problem = place(law, -0.3_DP, SLIP)
    problem%is_bilateral = .true.
    call solve_local_problem(law, problem, solution)
    call suite%that('bilateral: ROUGH sticks in tension', .not. solution%is_slipping)
    call suite%near('bilateral: its shear', norm2(solution%shear + 20.0_DP * problem%area * SLIP), 0.0_DP, 1.0e-14_DP)
  end subroutine check_bilateral


  !> A node with an overclosure and a slip, on a plane along x and y; without stiffness.
  pure type(local_problem_type) function place(law, overclosure, slip) result(problem)
    type(interaction_type), intent(in) :: law
    real(DP), intent(in) :: overclosure, slip(3)
    problem%area = merge(0.7_DP, 1.0_DP, law%behavior /= BEHAVIOR_LINEAR)
    problem%overclosure = overclosure
    problem%normal = [0.0_DP, 0.0_DP, 1.0_DP]
    problem%slip = slip
  end function place


  !> The whole force at a node.
  pure function force_of(problem, solution) result(force)
    type(local_problem_type), intent(in) :: problem
    type(local_solution_type), intent(in) :: solution
    real(DP) :: force(3)
    force = problem%area * solution%pressure * problem%normal + solution%shear
  end function force_of


  !> The limit of the shear at a pressure.
  pure real(DP) function limit_of(law, solution)
    type(interaction_type), intent(in) :: law
    type(local_solution_type), intent(in) :: solution
    real(DP) :: area
    area = merge(0.7_DP, 1.0_DP, law%behavior /= BEHAVIOR_LINEAR)
    limit_of = min(law%friction * max(solution%pressure, 0.0_DP), law%shear_limit) * area
    if (law%behavior == BEHAVIOR_TIED) limit_of = law%shear_limit * area
  end function limit_of


  !> inv(J) b by Cramer's rule.
  pure function solved(J, b) result(x)
    real(DP), intent(in) :: J(3, 3), b(3)
    real(DP) :: x(3), one(3, 3)
    integer :: k
    do k = 1, 3
      one = J
      one(:, k) = b
      x(k) = determinant(one) / determinant(J)
    end do
  end function solved


  !> Of a matrix.
  pure real(DP) function determinant(a)
    real(DP), intent(in) :: a(3, 3)
    determinant = a(1, 1) * (a(2, 2) * a(3, 3) - a(2, 3) * a(3, 2)) - a(1, 2) * (a(2, 1) * a(3, 3) - a(2, 3) * a(3, 1)) &
      + a(1, 3) * (a(2, 1) * a(3, 2) - a(2, 2) * a(3, 1))
  end function determinant

end program test_slave_node_equilibrium
