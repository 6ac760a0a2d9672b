!> Unit test of arc_length: the sphere, the choice of the root, the miss, angles as lengths, and the ends of a path.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_arc_length
  use amontons_arc_length, only: begin_path, close_arc, is_path_done, path_fraction
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_state, only: state_type, commit_state
  use amontons_steps, only: step_type
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP          !< rounding of some operations on numbers near 1 [-]
  real(DP), parameter :: NO_ANGLES(0) = [real(DP) ::]
  type(suite_type) :: suite
  call check_first()
  call check_roots()
  call check_levers()
  call check_ends()
  call suite%finish()

contains

  !> Two nodes at rest, before a path.
  type(state_type) function at_rest() result(state)
    allocate (state%new%u(3, 2), state%new%v(3, 2), source=0.0_DP)
    state%new%load_factor = 4.0_DP
    call begin_path(state%new)
    state%old = state%new
  end function at_rest


  !> Twice the arc squared less what the trial displacements with a direction have of it.
  real(DP) function miss(state, arc, du, d_load)
    type(state_type), intent(in) :: state
    real(DP), intent(in) :: arc, du(:, :), d_load
    miss = 2 * arc**2 - sum((state%new%u + du - state%old%u)**2) / state%new%arc_scale**2 &
      - (state%new%load_factor + d_load - state%old%load_factor)**2
  end function miss


  !> The first increment of a linear problem takes the arc as load factor, and the next one too.
  subroutine check_first()
    type(state_type) :: state
    real(DP) :: du_load(3, 2), du(3, 2), d_load
    state = at_rest()
    du_load = reshape([3.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, -4.0_DP, 0.0_DP], [3, 2])
    du = 0.0_DP
    call close_arc(state, 0.1_DP, NO_ANGLES, du_load, du, d_load)
    call suite%near('first: the scale', state%new%arc_scale, 5.0_DP, TOL)
    call suite%near('first: the load factor is the arc', d_load, 0.1_DP, TOL)
    call suite%near('first: along the load', maxval(abs(du - 0.1_DP * du_load)), 0.0_DP, TOL)
    state%new%u = du
    state%new%load_factor = d_load
    state%new%total_time = 0.5_DP
    call commit_state(state)
    call suite%near('first: the rate over the arc', state%old%load_rate, 0.2_DP, TOL)
    du = 0.0_DP
    call close_arc(state, 0.3_DP, NO_ANGLES, -2 * du_load, du, d_load)   ! beyond a limit point the load acts the other way
    call suite%near('second: continues in the last direction', d_load, -0.3_DP * sqrt(0.4_DP), TOL)
    du = 0.0_DP
    state%new%load_factor = state%old%load_factor
    call close_arc(state, 0.3_DP, NO_ANGLES, du_load, du, d_load)
    call suite%near('second: the scale is that of the start', d_load, 0.3_DP, TOL)
  end subroutine check_first


  !> Both roots end on the sphere; the one in the direction of the increment so far is taken. Without a root: the nearest point.
  subroutine check_roots()
    type(state_type) :: state
    real(DP) :: du_load(3, 2), by_residual(3, 2), du(3, 2), d_load, step
    integer :: i
    state = at_rest()
    state%new%arc_scale = 2.0_DP
    du_load = reshape([1.0_DP, 0.5_DP, 0.0_DP, 2.0_DP, 0.1_DP, -0.3_DP], [3, 2])
    by_residual = reshape([0.02_DP, -0.01_DP, 0.03_DP, 0.0_DP, 0.05_DP, 0.01_DP], [3, 2])
    do i = -1, 1, 2
      state%new%u = real(i, DP) * 0.2_DP * du_load
      state%new%load_factor = real(i, DP) * 0.2_DP
      du = by_residual
      call close_arc(state, 0.25_DP, NO_ANGLES, du_load, du, d_load)
      call suite%near('root: on the sphere', miss(state, 0.25_DP, du, d_load), 0.0_DP, TOL)
      step = real(i, DP) * (state%new%load_factor + d_load)
      call suite%that('root: continues', step > 0.1_DP)
    end do
    state%new%u = 0.0_DP
    state%new%load_factor = 0.0_DP
    by_residual = reshape([0.0_DP, 0.0_DP, 9.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], [3, 2])
    du_load(3, :) = 0.0_DP
    du = by_residual
    call close_arc(state, 0.25_DP, NO_ANGLES, du_load, du, d_load)
    call suite%near('root: none, the nearest point', maxval(abs(du - by_residual)) + abs(d_load), 0.0_DP, TOL)
  end subroutine check_roots


  !> An angle counts with its lever arm. Loads that move nothing give no direction.
  subroutine check_levers()
    type(state_type) :: state
    real(DP) :: du_load(3, 2), du(3, 2), d_load
    state = at_rest()
    du_load = reshape([3.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 2.0_DP, 0.0_DP], [3, 2])
    du = 0.0_DP
    call close_arc(state, 0.1_DP, [1.0_DP, 2.0_DP], du_load, du, d_load)
    call suite%near('angles: with their lever', state%new%arc_scale, 5.0_DP, TOL)
    state = at_rest()
    du = 0.0_DP
    call close_arc(state, 0.1_DP, NO_ANGLES, 0.0_DP * du_load, du, d_load)
    call suite%that('no motion: no direction', d_load <= 0.0_DP .and. state%new%arc_scale <= 0.0_DP)
  end subroutine check_levers


  !> The largest load factor, a displacement that is crossed from either side, the number of increments.
  subroutine check_ends()
    type(model_type) :: model
    type(step_type) :: step
    type(state_type) :: state
    state = at_rest()
    step%is_riks = .true.
    step%max_increments = 10
    state%new%load_factor = 2.0_DP
    call suite%that('end: none is given', .not. is_path_done(model, step, 9, state))
    call suite%that('end: the last increment', is_path_done(model, step, 10, state))
    step%path_end%load_factor = 2.0_DP
    call suite%that('end: the load factor', is_path_done(model, step, 1, state))
    call suite%near('end: of the way by the load factor', path_fraction(model, step, 1, state%new), 1.0_DP, TOL)
    step%path_end%load_factor = 4.0_DP
    call suite%near('end: half of the way', path_fraction(model, step, 1, state%new), 0.5_DP, TOL)
    step%path_end%nodes = [1, 2]
    step%path_end%dof = 2
    step%path_end%displacement = -1.0_DP
    state%old%u(2, :) = [0.0_DP, -1.0_DP]
    state%new%u(2, :) = [-0.9_DP, -1.0_DP]
    call suite%that('end: not yet crossed', .not. is_path_done(model, step, 1, state))
    call suite%near('end: of the way by the displacement', path_fraction(model, step, 1, state%new), 0.95_DP, TOL)
    state%new%u(2, 1) = -1.1_DP
    call suite%that('end: crossed by the mean', is_path_done(model, step, 1, state))
    state%old%u(2, :) = -2.0_DP
    state%new%u(2, :) = -0.5_DP
    call suite%that('end: crossed from below', is_path_done(model, step, 1, state))
    state%old%u(2, :) = -0.9_DP
    call suite%that('end: passed long ago', .not. is_path_done(model, step, 1, state))
  end subroutine check_ends

end program test_arc_length
