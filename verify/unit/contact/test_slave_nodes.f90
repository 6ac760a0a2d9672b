!> Tests of slave nodes: forces by status, detachment, what rounding makes of a gap, and the slip that a committed increment adds.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_slave_nodes
  use amontons_kinds, only: DP
  use amontons_surfaces, only: interaction_type, is_compliant, ROUGH_FRICTION
  use amontons_slave_node_equilibrium, only: local_solution_type
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_slave_nodes, only: detach_slave, is_rough, set_force, contact_force_rounding, accumulate_slip
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_forces(suite)
  call check_detached(suite)
  call check_rough(suite)
  call check_rounding(suite)
  call check_slip(suite)
  call suite%finish()

contains

  !> Open: none; stick: all of the imbalance is answered; slip: the friction given. The normal part is N n in both.
  subroutine check_forces(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type) :: slave
    real(DP), parameter :: IMBALANCE(3) = [1.0_DP, 2.0_DP, -5.0_DP], FRICTION(3) = [-0.3_DP, 0.4_DP, 0.0_DP]
    slave%normal = [0.0_DP, 0.0_DP, 1.0_DP]
    slave%status = STATUS_STICK
    call set_force(slave, IMBALANCE, 5.0_DP, FRICTION)
    call suite%near('stick: normal part', norm2(slave%force - [0.0_DP, 0.0_DP, 5.0_DP]), 0.0_DP, 0.0_DP)
    call suite%near('stick: in balance', norm2(slave%force + slave%shear + IMBALANCE), 0.0_DP, 1.0e-15_DP)
    slave%status = STATUS_SLIP
    call set_force(slave, IMBALANCE, 4.0_DP, FRICTION)
    call suite%near('slip: normal part', norm2(slave%force - [0.0_DP, 0.0_DP, 4.0_DP]), 0.0_DP, 0.0_DP)
    call suite%near('slip: friction', norm2(slave%shear - FRICTION), 0.0_DP, 0.0_DP)
    slave%status = STATUS_OPEN
    call set_force(slave, IMBALANCE, 4.0_DP, FRICTION)
    call suite%near('open: none', norm2(slave%force) + norm2(slave%shear), 0.0_DP, 0.0_DP)
  end subroutine check_forces


  !> A node off its master keeps its slip and its place in the pair, but no facet, gap, force or energy.
  subroutine check_detached(suite)
    type(suite_type), intent(inout) :: suite
    type(slave_state_type) :: slave
    slave%pair = 2
    slave%node = 9
    slave%facet = 4
    slave%status = STATUS_SLIP
    slave%gap = -0.1_DP
    slave%force = 1.0_DP
    slave%shear = 1.0_DP
    slave%energy = 1.0_DP
    slave%slip = 0.5_DP
    call detach_slave(slave)
    call suite%that('detached: open, on no facet', slave%status == STATUS_OPEN .and. slave%facet == 0)
    call suite%near('detached: nothing acts', abs(slave%gap) + norm2(slave%force) + norm2(slave%shear) + abs(slave%energy), &
      0.0_DP, 0.0_DP)
    call suite%that('detached: it is what it was', slave%pair == 2 .and. slave%node == 9 .and. all(slave%slip >= 0.5_DP))
  end subroutine check_detached


  !> ROUGH by its coefficient, unless a routine of the user gives the friction.
  subroutine check_rough(suite)
    type(suite_type), intent(inout) :: suite
    type(interaction_type) :: law
    law%friction = ROUGH_FRICTION
    call suite%that('rough', is_rough(law))
    law%is_user_friction = .true.
    call suite%that('a routine decides', .not. is_rough(law))
    law%is_user_friction = .false.
    law%friction = 5.0_DP
    call suite%that('a large coefficient is none', .not. is_rough(law))
  end subroutine check_rough


  !> The stiffness of the body times one unit in the last place of the largest coordinate; open nodes give none.
  subroutine check_rounding(suite)
    type(suite_type), intent(inout) :: suite
    type(interaction_type) :: laws(1)
    type(local_solution_type) :: solutions(3)
    type(slave_state_type) :: slaves(3)
    real(DP) :: x(3, 2)
    call suite%that('rounding: the law is exact', .not. is_compliant(laws(1)))
    x = reshape([1.0_DP, 2.0_DP, -50.0_DP, 3.0_DP, 4.0_DP, 5.0_DP], [3, 2])
    slaves%pair = 1
    slaves%status = [STATUS_OPEN, STATUS_STICK, STATUS_SLIP]
    slaves%stiffness = [1.0e9_DP, 100.0_DP, 300.0_DP]
    call suite%near('rounding: of the stiffest closed node', contact_force_rounding(laws, solutions, slaves, x), &
      300 * 50 * epsilon(1.0_DP), 1.0e-25_DP)
    slaves%status = STATUS_OPEN
    call suite%near('rounding: all open', contact_force_rounding(laws, solutions, slaves, x), 0.0_DP, 0.0_DP)
  end subroutine check_rounding


  !> Slip and work are added up for nodes that slip; the increment of others is forgotten.
  subroutine check_slip(suite)
    type(suite_type), intent(inout) :: suite
    type(fields_type) :: old, new
    integer :: s
    allocate (old%slaves(3), new%slaves(3))
    old%friction_work = 7.0_DP
    new%slaves%status = [STATUS_SLIP, STATUS_STICK, STATUS_OPEN]
    do s = 1, 3
      old%slaves(s)%slip = [1.0_DP, 0.0_DP, 0.0_DP]
      new%slaves(s)%slip_increment = [0.5_DP, 0.25_DP, 0.0_DP]
      new%slaves(s)%shear = [-4.0_DP, -8.0_DP, 0.0_DP]
    end do
    call accumulate_slip(old, new)
    call suite%near('slip: added', norm2(new%slaves(1)%slip - [1.5_DP, 0.25_DP, 0.0_DP]), 0.0_DP, 0.0_DP)
    call suite%near('slip: not where it sticks or is open', norm2(new%slaves(2)%slip - old%slaves(2)%slip) &
      + norm2(new%slaves(3)%slip - old%slaves(3)%slip), 0.0_DP, 0.0_DP)
    call suite%near('slip: the increment is forgotten there', norm2(new%slaves(2)%slip_increment), 0.0_DP, 0.0_DP)
    call suite%near('slip: work', new%friction_work, 7 + 4 * 0.5_DP + 8 * 0.25_DP, 0.0_DP)
  end subroutine check_slip

end program test_slave_nodes
