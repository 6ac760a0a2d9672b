!> Unit test of mortar_seams: which other pairs count at a slave node of two surface-to-surface pairs.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_mortar_seams
  use amontons_kinds, only: DP
  use amontons_mortar_seams, only: update_mortar_rows
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_SLIP
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_counted()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> The same two surfaces twice: a pair that is closed, on its master or beside the master of the other one counts; one whose
  !! master is farther by more than an edge (1.2), on another side of the body, or removed, does not.
  subroutine check_counted()
    integer, parameter :: SECOND = 17              ! the first slave of the second pair
    call two_blocks(model, 0.3_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.1_DP])
    model%steps(1)%is_nlgeom = .true.
    model%pairs(1)%is_mortar = .true.
    model%pairs = [model%pairs, model%pairs]
    call start_blocks(model, system, state)
    state%new%slaves%status = STATUS_OPEN
    call suite%that('on its master', all(counted()))
    state%new%slaves(SECOND:)%offset = 1.1_DP      ! its gap is larger than the distance of the faces
    call suite%that('beside the other master', all(counted()))
    system%contact%slave_normal(:, SECOND:) = spread([1.0_DP, 0.0_DP, 0.0_DP], 2, 16)
    call suite%that('on another side of the body', .not. any(counted()))
    state%new%slaves(SECOND:)%offset = 0.01_DP
    call suite%that('within a hundredth of an edge', all(counted()))
    state%new%slaves(SECOND:)%offset = 0.013_DP
    call suite%that('and not beyond', .not. any(counted()))
    state%new%slaves(SECOND:)%status = STATUS_SLIP
    call suite%that('closed', all(counted()))
    system%contact%is_removed(2) = .true.
    call suite%that('removed', .not. any(counted()))
    system%contact%is_removed = .false.
    state%new%slaves%status = STATUS_OPEN
    system%contact%slave_normal(:, SECOND:) = system%contact%slave_normal(:, :16)
    state%new%slaves(SECOND:)%offset = 1.3_DP
    call suite%that('farther than an edge', .not. any(counted()))
    state%new%slaves(:16)%offset = 0.2_DP
    call suite%that('as far as the other one', all(counted()))
  end subroutine check_counted


  !> Which nodes of the first pair have another pair that counts.
  function counted() result(has_other)
    logical :: has_other(16)
    call update_mortar_rows(system%contact, state%new%slaves, [.true., .true.], .true., model%mesh%coordinates + state%new%u)
    has_other = system%contact%mortar(1)%has_other_masters
  end function counted

end program test_mortar_seams
