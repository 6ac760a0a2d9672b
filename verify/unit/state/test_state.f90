!> Tests of state: at rest for a mesh, commit with its velocity, restore, and what of history is not kept.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_state
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type
  use amontons_state, only: state_type, slave_state_type, create_state, commit_state, restore_state, take_points, &
    history_variable, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_rest(suite)
  call check_commit(suite)
  call check_points(suite)
  call check_history(suite)
  call suite%finish()

contains

  !> Three nodes, four points, two slaves of which one sticks.
  subroutine make_state(state)
    type(state_type), intent(out) :: state
    type(mesh_type) :: mesh
    type(slave_state_type) :: slaves(2)
    mesh%n_nodes = 3
    mesh%n_points = 4
    slaves%node = [2, 3]
    slaves(2)%status = STATUS_STICK
    call create_state(state, mesh, slaves)
  end subroutine make_state


  !> Zeros of the right shapes, the slaves as they were given, trial and committed alike; statuses are distinct.
  subroutine check_rest(suite)
    type(suite_type), intent(inout) :: suite
    type(state_type) :: state
    call make_state(state)
    call suite%that('rest: shapes', all(shape(state%new%u) == [3, 3]) .and. all(shape(state%new%stress) == [6, 4]) .and. &
      size(state%new%volume) == 4 .and. size(state%new%temperature) == 3)
    call suite%near('rest: zeros', sum(abs(state%new%u)) + sum(abs(state%new%stress)) + sum(abs(state%new%reaction_force)), &
      0.0_DP, 0.0_DP)
    call suite%that('rest: slaves', all(state%new%slaves%node == [2, 3]) .and. all(state%old%slaves%status == [STATUS_OPEN, &
      STATUS_STICK]))
    call suite%that('rest: as files have them', STATUS_OPEN == 0 .and. STATUS_STICK == 1 .and. STATUS_SLIP == 2)
  end subroutine check_rest


  !> A commit takes the trial and its mean velocity; without time the velocity stays; a restore takes the trial back.
  subroutine check_commit(suite)
    type(suite_type), intent(inout) :: suite
    type(state_type) :: state
    call make_state(state)
    state%new%u(1, 2) = 0.5_DP
    state%new%total_time = 0.25_DP
    state%new%slaves(1)%status = STATUS_SLIP
    call commit_state(state)
    call suite%near('commit: velocity', state%old%v(1, 2), 2.0_DP, 0.0_DP)
    call suite%near('commit: displacement', state%old%u(1, 2), 0.5_DP, 0.0_DP)
    call suite%that('commit: slaves', state%old%slaves(1)%status == STATUS_SLIP)
    state%new%u(1, 2) = 9.0_DP
    call commit_state(state)
    call suite%near('commit: no time, the velocity as it was', state%old%v(1, 2), 2.0_DP, 0.0_DP)
    state%new%u = -1.0_DP
    state%new%slaves%status = STATUS_OPEN
    state%new%total_time = 7.0_DP
    call restore_state(state)
    call suite%near('restore: displacement and time', abs(state%new%u(1, 2) - 9.0_DP) + abs(state%new%total_time - 0.25_DP), &
      0.0_DP, 0.0_DP)
    call suite%that('restore: slaves', all(state%new%slaves%status == [STATUS_SLIP, STATUS_STICK]))
  end subroutine check_commit


  !> Trial fields without values at points: one set of them exists at any time, and moves with acceptance and commit.
  subroutine check_points(suite)
    type(suite_type), intent(inout) :: suite
    type(state_type) :: state
    call make_state(state)
    state%old%stress = 3.0_DP
    state%old%volume = 2.0_DP
    state%has_trial_points = .false.
    call restore_state(state)
    call suite%that('points: none in the trial', .not. (allocated(state%new%stress) .or. allocated(state%new%strain) .or. &
      allocated(state%new%energy) .or. allocated(state%new%volume)) .and. allocated(state%new%u))
    call suite%that('points: committed', all(state%old%stress == 3.0_DP) .and. all(state%old%volume == 2.0_DP))
    call take_points(state)
    call suite%that('points: taken, zero', all(state%new%stress == 0.0_DP) .and. .not. allocated(state%old%stress))
    state%new%stress = 5.0_DP
    state%new%u(1, 2) = 0.5_DP
    call commit_state(state)
    call suite%that('points: committed again', all(state%old%stress == 5.0_DP) .and. .not. allocated(state%new%stress))
    call suite%near('points: the rest is copied', state%old%u(1, 2) + state%new%u(1, 2), 1.0_DP, 0.0_DP)
  end subroutine check_points


  !> A variable that no material keeps is zero.
  subroutine check_history(suite)
    type(suite_type), intent(inout) :: suite
    type(state_type) :: state
    integer :: i
    call make_state(state)
    call suite%near('history: none', sum(abs(history_variable(state%new, 1))), 0.0_DP, 0.0_DP)
    state%new%history = reshape([(real(i, DP), i=1, 8)], [2, 4])
    call suite%near('history: the second', norm2(history_variable(state%new, 2) - [2.0_DP, 4.0_DP, 6.0_DP, 8.0_DP]), 0.0_DP, &
      0.0_DP)
    call suite%near('history: a third is not kept', sum(abs(history_variable(state%new, 3))), 0.0_DP, 0.0_DP)
  end subroutine check_history

end program test_state
