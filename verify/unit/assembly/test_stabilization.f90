!> Tests of stabilization: factors of increments, shares of volume, force and stiffness of damping, and the work it takes.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_stabilization
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, DAMPING_NOW, DAMPING_NEXT
  use amontons_stabilization, only: is_damped, set_damping_factor, find_nodal_volumes, add_damping_force, &
    add_damping_stiffness, update_damping
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_factor(suite)
  call check_volumes(suite)
  call check_forces(suite)
  call check_update(suite)
  call suite%finish()

contains

  !> At the start of a step the factor given, unless it is continued; later that of the increment before; none without damping.
  subroutine check_factor(suite)
    type(suite_type), intent(inout) :: suite
    type(step_type) :: step
    type(state_type) :: state
    state%old%damping = [1.0_DP, 3.0_DP]
    state%new%damping = 9.0_DP
    call suite%that('factor: no damping', .not. is_damped(step))
    call set_damping_factor(step, .false., state)
    call suite%near('factor: zero without', sum(abs(state%new%damping)), 0.0_DP, 0.0_DP)
    step%damping_factor = 5.0_DP
    call suite%that('factor: damping', is_damped(step))
    call set_damping_factor(step, .true., state)
    call suite%near('factor: given', state%new%damping(DAMPING_NOW), 5.0_DP, 0.0_DP)
    call set_damping_factor(step, .false., state)
    call suite%near('factor: later', state%new%damping(DAMPING_NOW), 3.0_DP, 0.0_DP)
    step%is_damping_continued = .true.
    call set_damping_factor(step, .true., state)
    call suite%near('factor: continued', state%new%damping(DAMPING_NOW), 3.0_DP, 0.0_DP)
  end subroutine check_factor


  !> Elements of two and three nodes with volumes 6 and 9: each of their nodes has 3; an absent element gives nothing.
  subroutine check_volumes(suite)
    type(suite_type), intent(inout) :: suite
    type(mesh_type) :: mesh
    type(state_type) :: state
    real(DP), allocatable :: volume(:)
    mesh%n_nodes = 4
    mesh%n_elements = 2
    mesh%first = [1, 3, 6]
    mesh%nodes = [1, 2, 2, 3, 4]
    mesh%point_first = [1, 3, 4]
    state%new%volume = [2.0_DP, 4.0_DP, 9.0_DP]
    call find_nodal_volumes(mesh, [.false., .false.], state%new, volume)
    call suite%near('volumes', norm2(volume - [3.0_DP, 6.0_DP, 3.0_DP, 3.0_DP]), 0.0_DP, 1.0e-15_DP)
    call find_nodal_volumes(mesh, [.true., .false.], state%new, volume)
    call suite%near('volumes: one absent', norm2(volume - [0.0_DP, 3.0_DP, 3.0_DP, 3.0_DP]), 0.0_DP, 1.0e-15_DP)
  end subroutine check_volumes


  !> F = -c m du/dt, and its derivative on the diagonal.
  subroutine check_forces(suite)
    type(suite_type), intent(inout) :: suite
    type(state_type) :: state
    type(sparse_type) :: K
    type(error_type), allocatable :: error
    integer :: i
    call two_nodes(state)
    state%new%damping(DAMPING_NOW) = 4.0_DP
    call add_damping_force([2.0_DP, 3.0_DP], state)
    call suite%near('force: what was there and -c m du/dt', norm2(state%new%applied_force(:, 1) - [1 - 1.6_DP, 1.0_DP, 1.0_DP]), &
      0.0_DP, 1.0e-14_DP)
    call suite%near('force: of the other', state%new%applied_force(3, 2), 1 - 7.2_DP, 1.0e-14_DP)
    call sparse_from_triplets(6, 6, [(i, i=1, 6), 1], [(i, i=1, 6), 4], [(1.0_DP, i=1, 6), -1.0_DP], K, error)
    call add_damping_stiffness([2.0_DP, 3.0_DP], state, K)
    call suite%near('stiffness: diagonal', norm2(K%value(K%first(:6)) - [17.0_DP, 17.0_DP, 17.0_DP, 25.0_DP, 25.0_DP, 25.0_DP]), &
      0.0_DP, 1.0e-13_DP)
    call suite%near('stiffness: nothing else', K%value(K%first(1) + 1), -1.0_DP, 0.0_DP)
  end subroutine check_forces


  !> Two nodes that moved by 0.1 along x and 0.3 along z in half a unit of time.
  subroutine two_nodes(state)
    type(state_type), intent(out) :: state
    allocate (state%old%u(3, 2), state%old%v(3, 2), state%old%internal_force(3, 2), source=0.0_DP)
    allocate (state%new%applied_force(3, 2), source=1.0_DP)
    state%old%total_time = 1.0_DP
    state%new%total_time = 1.5_DP
    state%new%u = reshape([0.1_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.3_DP], [3, 2])
    state%new%internal_force = reshape([2.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 6.0_DP], [3, 2])
  end subroutine two_nodes


  !> The factor found from the first increment, the energy dissipated, and the work by the trapezoidal rule.
  subroutine check_update(suite)
    type(suite_type), intent(inout) :: suite
    type(step_type) :: step
    type(state_type) :: state
    real(DP), allocatable :: volume(:)
    real(DP) :: work
    real(DP), parameter :: MOVED = 2 * 0.01_DP + 3 * 0.09_DP, STORED = 0.5_DP * (0.2_DP + 1.8_DP)
    call two_nodes(state)
    step%dissipated_fraction = 2.0e-4_DP
    step%period = 4.0_DP
    call update_damping(volume, step, state, work)
    call suite%near('update: nothing without volumes', abs(work) + state%new%damping(DAMPING_NEXT), 0.0_DP, 0.0_DP)
    volume = [2.0_DP, 3.0_DP]
    call update_damping(volume, step, state, work)
    call suite%near('update: the factor', state%new%damping(DAMPING_NEXT), 2.0e-4_DP * STORED * 4 / MOVED, 1.0e-15_DP)
    call suite%near('update: no work yet', work, 0.0_DP, 0.0_DP)
    state%new%damping = [4.0_DP, 5.0_DP]
    state%old%damping(DAMPING_NOW) = 2.0_DP
    state%old%v(1, 1) = 0.5_DP
    state%old%stabilization_work = 1.0_DP
    call update_damping(volume, step, state, work)
    call suite%near('update: dissipated', state%new%stabilization_work, 1 + 4 * MOVED / 0.5_DP, 1.0e-14_DP)
    call suite%near('update: work', work, -0.5_DP * (4 * MOVED / 0.5_DP + 2 * 2 * 0.1_DP * 0.5_DP), 1.0e-14_DP)
    call suite%near('update: a factor that is known stays', state%new%damping(DAMPING_NEXT), 5.0_DP, 0.0_DP)
  end subroutine check_update

end program test_stabilization
