!> Unit test of contact_pairs: slave nodes of a pair, rows, slip from the origin, gap, refusals.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_pairs
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_pairs, only: contact_type, create_contact, current_row, origin_row, &
    contact_slip_vector, origin_offset_derivative, search_lost_slave, update_gap, set_stick_origin, &
    is_stuck_to_mortar_row
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type, EXIT_SETUP
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP            ! rounding of coordinates of size 1 over a projection
  integer, parameter :: CORNER = 1, INNER = 6        ! slaves of nodes 19 and 24
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_created()
  call check_rows()
  call check_slip()
  call check_lost()
  call check_dimensions()
  call suite%finish()

contains

  include 'sliding_blocks.inc'

  !> One open slave for each node of the surface, outward normals, the longest edge of the master; the same surface twice.
  subroutine check_created()
    type(contact_type) :: contact
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    integer :: i
    call two_blocks(model, 0.3_DP, 0.1_DP, [0.0_DP, 0.0_DP, -0.1_DP])
    call create_contact(contact, model, slaves, error)
    call suite%that('sixteen, open', .not. allocated(error) .and. size(slaves) == 16 .and. all(slaves%node == [(18 + i, i=1, 16)]) &
      .and. all(slaves%status == STATUS_OPEN) .and. all(slaves%pair == 1))
    call suite%near('edge of the master', contact%edge(1), 1.2_DP, TOL)
    call suite%near('outward from the slave', maxval(abs(contact%slave_normal - spread([0.0_DP, 0.0_DP, -1.0_DP], 2, 16))), &
      0.0_DP, TOL)
    call suite%near('areas add up', sum(slaves%area), 1.6_DP**2, TOL)
    call suite%near('a corner has a quarter of a face', slaves(CORNER)%area, 0.25_DP * (1.6_DP / 3)**2, TOL)
    model%pairs = [model%pairs, model%pairs]
    call create_contact(contact, model, slaves, error)
    call suite%that('two pairs', size(slaves) == 32 .and. all(slaves(17:)%pair == 2))
  end subroutine check_created


  !> The row of a node has weights of sum zero and gives the gap vector.
  subroutine check_rows()
    type(contact_row_type) :: row
    real(DP) :: d(3)
    integer :: i
    call start(0.05_DP)
    associate (slave => state%new%slaves(INNER))
      call suite%that('projected', slave%facet > 0)
      call suite%near('gap', slave%gap, 0.05_DP, TOL)
      call suite%near('normal', maxval(abs(slave%normal - [0.0_DP, 0.0_DP, 1.0_DP])), 0.0_DP, TOL)
      call current_row(system%contact, slave, row)
      call suite%near('sum of the weights', sum(row%weights), 0.0_DP, TOL)
      d = 0
      do i = 1, size(row%nodes)
        d = d + row%weights(i) * model%mesh%coordinates(:, row%nodes(i))
      end do
      call suite%near('gap vector', maxval(abs(d - [0.0_DP, 0.0_DP, 0.05_DP])), 0.0_DP, TOL)
      call suite%that('no mortar row', .not. is_stuck_to_mortar_row(system%contact, slave))
    end associate
  end subroutine check_rows


  !> The slip from the origin: the relative motion since then; a common motion of both bodies is none; what an overclosure allows is
  !! part of the origin.
  subroutine check_slip()
    type(contact_row_type) :: row
    real(DP), allocatable :: u(:, :)
    call start(0.0_DP)
    allocate (u(3, model%mesh%n_nodes), source=0.0_DP)
    associate (slave => state%new%slaves(INNER))
      call set_stick_origin(system%contact, model, u, slave%facet, slave%xi, slave)
      call suite%near('none at the origin', maxval(abs(contact_slip_vector(system%contact, model, u, slave))), 0.0_DP, TOL)
      u = 0.25_DP
      call suite%near('a common motion', maxval(abs(contact_slip_vector(system%contact, model, u, slave))), 0.0_DP, TOL)
      u(:, slave%node) = u(:, slave%node) + [0.01_DP, 0.02_DP, 0.03_DP]
      call suite%near('a relative motion', maxval(abs(contact_slip_vector(system%contact, model, u, slave) - [0.01_DP, 0.02_DP, &
        0.03_DP])), 0.0_DP, TOL)
      call origin_row(system%contact, slave, row)
      call suite%that('the row of the origin', size(row%nodes) == 5 .and. any(row%nodes == slave%node))
      slave%offset = 0.125_DP
      u = 0
      call suite%near('an allowed overclosure', maxval(abs(contact_slip_vector(system%contact, model, u, slave) - [0.0_DP, 0.0_DP, &
        0.125_DP])), 0.0_DP, TOL)
      call suite%near('its derivative by the normal', maxval(abs(matmul(origin_offset_derivative(system%contact, slave), [1.0_DP, &
        2.0_DP, 3.0_DP]) + 0.125_DP * [1.0_DP, 2.0_DP, 3.0_DP])), 0.0_DP, TOL)
    end associate
  end subroutine check_slip


  !> A node beyond the master has no facet; it gets one when it is back.
  subroutine check_lost()
    real(DP), allocatable :: x(:, :)
    call start(0.05_DP)
    x = model%mesh%coordinates
    associate (slave => state%new%slaves(INNER))
      x(1, slave%node) = 3.0_DP
      call update_gap(system%contact, x, slave)
      call suite%that('lost', slave%facet == 0)
      x(1, slave%node) = 0.5_DP
      call search_lost_slave(system%contact, x, INNER, slave)
      call suite%that('found', slave%facet > 0)
      call suite%near('its gap', slave%gap, 0.05_DP, TOL)
      system%contact%is_removed(1) = .true.
      slave%facet = 0
      call search_lost_slave(system%contact, x, INNER, slave)
      call suite%that('not of a pair that was removed', slave%facet == 0)
    end associate
  end subroutine check_lost


  !> A master whose face is collapsed is refused.
  subroutine check_dimensions()
    type(contact_type) :: contact
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    call two_blocks(model, 0.3_DP, 0.1_DP, [0.0_DP, 0.0_DP, -0.1_DP])
    model%mesh%coordinates(:, 10:18) = 0             ! all nodes of the master at one place
    call create_contact(contact, model, slaves, error)
    call suite%that('a master without area', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_SETUP)
  end subroutine check_dimensions

end program test_contact_pairs
