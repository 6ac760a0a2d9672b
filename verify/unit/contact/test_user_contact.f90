!> Unit test of user_contact: local directions, signs of stresses and forces, derivatives, sticking, in space and in the plane.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_user_contact
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_user_contact, only: user_response_type, call_user_interaction, call_user_friction
  use amontons_user_routines, only: open_routines, close_routines
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-14_DP
  type(suite_type) :: suite
  type(model_type) :: model
  type(fields_type) :: fields
  type(slave_state_type) :: old
  type(error_type), allocatable :: error
  call write_user_file('test_user_contact_routines.f90')
  call open_routines('test_user_contact_routines.f90', model%routines, error)
  call suite%that('opened', .not. allocated(error))
  if (allocated(error)) error stop 'the routines do not compile'
  call make_model()
  call check_interaction()
  call check_plane()
  call check_friction()
  call close_routines(model%routines)
  call suite%finish()

contains

  include 'sample_user.inc'

  !> One slave node of area 2 with two state variables, the second of the list.
  subroutine make_model()
    allocate (model%interactions(1), model%surfaces(2), model%pairs(1))
    model%interactions(1)%name = 'LAW'
    model%interactions(1)%props = [8.0_DP]
    model%interactions(1)%n_statev = 1
    model%surfaces(1)%name = 'S'
    model%surfaces(2)%name = 'M'
    model%pairs(1)%slave = 1
    model%pairs(1)%master = 2
    model%pairs(1)%interaction = 1
    model%mesh%n_nodes = 1
    model%mesh%node_label = [17]
    model%mesh%coordinates = reshape([1.0_DP, 2.0_DP, 3.0_DP], [3, 1])
  end subroutine make_model


  !> The slave as it is before a call.
  subroutine reset(normal, gap)
    real(DP), intent(in) :: normal(3), gap
    type(slave_state_type) :: slave
    slave%pair = 1
    slave%node = 1
    slave%memory = 1
    slave%normal = normal
    slave%gap = gap
    slave%area = 2
    if (allocated(fields%slaves)) deallocate (fields%slaves)
    if (allocated(fields%u)) deallocate (fields%u)
    if (allocated(fields%temperature)) deallocate (fields%temperature)
    fields%slaves = [slave]
    fields%u = reshape([0.0_DP, 0.0_DP, 0.0_DP], [3, 1])
    fields%temperature = [0.0_DP]
    fields%user_memory = [-1.0_DP, -1.0_DP]
    old = slave
  end subroutine reset


  !> UINTER: F = A (s1 n - s2 t1 - s3 t2) with s = 8 times penetration and slip; nothing at an open gap.
  subroutine check_interaction()
    type(user_response_type) :: response
    real(DP), parameter :: N(3) = [0.6_DP, 0.0_DP, 0.8_DP], T1(3) = [0.8_DP, 0.0_DP, -0.6_DP], T2(3) = [0.0_DP, 1.0_DP, 0.0_DP]
    real(DP) :: d(3)
    call reset(N, -0.5_DP)
    d = 0.25_DP * T1 + 0.125_DP * T2
    call call_user_interaction(model, model%interactions(1), .false., d, old, [9.0_DP, 5.0_DP], 1, fields, response)
    associate (slave => fields%slaves(1))
      call suite%near('pressure', maxval(abs(slave%force - 8.0_DP * N)), 0.0_DP, TOL)
      call suite%near('against the slip', maxval(abs(slave%shear + 4.0_DP * T1 + 2.0_DP * T2)), 0.0_DP, TOL)
      call suite%near('energy', slave%energy, 2.0_DP, TOL)
      call suite%that('sticks without dissipation', slave%status == STATUS_STICK)
      call suite%near('state from the committed one', fields%user_memory(2), 6.0_DP, 0.0_DP)
      call suite%near('of no other node', fields%user_memory(1), -1.0_DP, 0.0_DP)
      call suite%near('d F / d g', maxval(abs(response%d_force_d_gap + 16 * N)), 0.0_DP, TOL)
      call suite%near('d F / d slip', maxval(abs(matmul(response%d_force_d_slip, T1 + 2 * T2) + 16 * (T1 + 2 * T2))), 0.0_DP, &
        1.0e-13_DP)
      call suite%near('no derivative along n', maxval(abs(matmul(response%d_force_d_slip, N))), 0.0_DP, TOL)
    end associate
    call reset(N, 0.5_DP)
    call call_user_interaction(model, model%interactions(1), .false., d, old, [9.0_DP, 5.0_DP], 1, fields, response)
    call suite%that('open', fields%slaves(1)%status == STATUS_OPEN .and. norm2(fields%slaves(1)%force) <= 0)
    call reset([1.0_DP, 0.0_DP, 0.0_DP], -0.5_DP)
    call call_user_interaction(model, model%interactions(1), .false., [0.0_DP, 0.0_DP, 0.25_DP], old, [9.0_DP, 5.0_DP], 1, fields, &
      response)
    call suite%near('a normal along x', maxval(abs(fields%slaves(1)%shear - [0.0_DP, 0.0_DP, -4.0_DP])), 0.0_DP, TOL)
  end subroutine check_interaction


  !> In the plane t1 = e_z x n, and two components are passed.
  subroutine check_plane()
    type(user_response_type) :: response
    call reset([0.0_DP, 1.0_DP, 0.0_DP], -0.5_DP)
    call call_user_interaction(model, model%interactions(1), .true., [0.25_DP, 0.0_DP, 0.0_DP], old, [9.0_DP, 5.0_DP], 1, fields, &
      response)
    call suite%near('plane: pressure', maxval(abs(fields%slaves(1)%force - [0.0_DP, 8.0_DP, 0.0_DP])), 0.0_DP, TOL)
    call suite%near('plane: shear', maxval(abs(fields%slaves(1)%shear - [-4.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
    call suite%near('plane: nothing across', maxval(abs(response%d_force_d_slip(3, :))), 0.0_DP, 0.0_DP)
  end subroutine check_plane


  !> FRIC: tau = 2 p + 3 dgam while it slips; it sticks where the required shear is small.
  subroutine check_friction()
    type(user_response_type) :: response
    real(DP), parameter :: N(3) = [0.0_DP, 0.0_DP, 1.0_DP]
    call reset(N, 0.0_DP)
    fields%slaves(1)%status = STATUS_SLIP
    call call_user_friction(model, model%interactions(1), .false., [1.0_DP, 2.0_DP, 0.0_DP], [5.0_DP, 0.0_DP, -4.0_DP], [9.0_DP, &
      5.0_DP], 1, fields, response)
    associate (slave => fields%slaves(1))
      call suite%that('slips', .not. response%is_stuck)
      call suite%near('shear: 2 p + 3 slip over the area 2', maxval(abs(slave%shear + [22.0_DP, 28.0_DP, 0.0_DP])), 0.0_DP, TOL)
      call suite%near('its slip', maxval(abs(slave%slip_increment - [0.5_DP, 1.0_DP, 0.0_DP])), 0.0_DP, TOL)
      call suite%near('by the pressure', maxval(abs(response%by_pressure + [4.0_DP, 4.0_DP, 0.0_DP])), 0.0_DP, TOL)
      call suite%near('by the slip', maxval(abs(matmul(response%d_force_d_slip, [1.0_DP, 2.0_DP, 9.0_DP]) + [6.0_DP, 12.0_DP, &
        0.0_DP])), 0.0_DP, TOL)
    end associate
    call call_user_friction(model, model%interactions(1), .false., [1.0_DP, 2.0_DP, 0.0_DP], [0.5_DP, 0.25_DP, -4.0_DP], [9.0_DP, &
      5.0_DP], 1, fields, response)
    call suite%that('sticks', response%is_stuck)
    call suite%near('with the required shear', maxval(abs(fields%slaves(1)%shear + [1.0_DP, 0.5_DP, 0.0_DP])), 0.0_DP, TOL)
    call suite%near('no derivative', maxval(abs(response%d_force_d_slip)), 0.0_DP, 0.0_DP)
    call reset([0.0_DP, 1.0_DP, 0.0_DP], 0.0_DP)
    fields%slaves(1)%status = STATUS_SLIP
    call call_user_friction(model, model%interactions(1), .true., [1.0_DP, 0.0_DP, 0.0_DP], [5.0_DP, -4.0_DP, 0.0_DP], [9.0_DP, &
      5.0_DP], 1, fields, response)
    ! t1 = -x: the slip along it is -1, so tau = 8 - 3
    call suite%near('plane: along e_z x n', maxval(abs(fields%slaves(1)%shear - [10.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
  end subroutine check_friction

end program test_user_contact
