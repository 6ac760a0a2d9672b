!> Unit test of first_touch: the origin where a node meets its master, and where it comes over the border.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_first_touch
  use amontons_contact_pairs, only: contact_slip_vector, update_gap
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_first_touch, only: set_first_touch_origin
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP            ! rounding of coordinates of size 1 over a projection
  integer, parameter :: INNER = 6                  ! slave of node 24
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_touch()
  call check_entry()
  call suite%finish()

contains

  include 'sliding_blocks.inc'

  !> A node that closes on a straight path: its origin is where it touches, whatever it slides after it.
  subroutine check_touch()
    real(DP), allocatable :: u_old(:, :), u(:, :)
    real(DP) :: d(3)
    call start(0.1_DP)
    allocate (u_old(3, model%mesh%n_nodes), u(3, model%mesh%n_nodes), source=0.0_DP)
    associate (slave => state%new%slaves(INNER))
      u(:, slave%node) = [0.04_DP, 0.0_DP, -0.4_DP]  ! touches after a quarter of the way
      call update_gap(system%contact, model%mesh%coordinates + u, slave)
      call suite%near('penetration', slave%gap, -0.3_DP, TOL)
      call set_first_touch_origin(system%contact, model, u_old, u, slave)
      d = contact_slip_vector(system%contact, model, u, slave)
      call suite%near('slip since the touch', maxval(abs(d - [0.03_DP, 0.0_DP, -0.3_DP])), 0.0_DP, TOL)
    end associate
  end subroutine check_touch


  !> A node that starts beyond the border and below the surface touches where it comes over the border, in the middle of its way.
  !! All nodes move along, which changes nothing.
  subroutine check_entry()
    real(DP), parameter :: DEPTH = 0.02_DP, BEYOND = 0.3_DP
    real(DP), allocatable :: u_old(:, :), u(:, :)
    real(DP) :: d(3), border
    call start(0.05_DP)
    allocate (u_old(3, model%mesh%n_nodes), u(3, model%mesh%n_nodes), source=0.0_DP)
    border = maxval(model%mesh%coordinates(1, :18))
    associate (slave => state%new%slaves(INNER))
      u_old(:, slave%node) = [border + BEYOND - model%mesh%coordinates(1, slave%node), 0.0_DP, -0.05_DP - DEPTH]
      u(:, slave%node) = u_old(:, slave%node) - [2.0_DP * BEYOND, 0.0_DP, 0.0_DP]
      u(2, :) = u(2, :) + 0.5_DP
      call update_gap(system%contact, model%mesh%coordinates + u, slave)
      call suite%near('penetration at the end', slave%gap, -DEPTH, TOL)
      call set_first_touch_origin(system%contact, model, u_old, u, slave)
      d = contact_slip_vector(system%contact, model, u, slave)
      call suite%near('slip since the border and its extension, a tenth of a facet', d(1), -BEYOND - 0.1_DP * &
        system%contact%edge(1), 2.0e-3_DP * BEYOND)
      call suite%near('none across', d(2), 0.0_DP, TOL)
    end associate
  end subroutine check_entry

end program test_first_touch
