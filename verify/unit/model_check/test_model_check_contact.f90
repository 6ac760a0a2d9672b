!> Unit test of model_check_contact: two blocks that face each other, overlap, face the same way or lie apart, and the messages.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_model_check_contact
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_model_check_contact, only: check_contact, is_closed, can_close_later
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_STICK
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_depth()
  call check_direction()
  call check_closed()
  call check_later()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> Blocks at a gap at the start of the first increment.
  subroutine start(gap)
    real(DP), intent(in) :: gap
    call two_blocks(model, 0.3_DP, gap, [0.0_DP, 0.0_DP, -0.1_DP])
    call start_blocks(model, system, state)
  end subroutine start


  !> Errors and warnings, and whether one of them contains a piece of text.
  subroutine expect(name, n_errors, n_warnings, piece)
    character(*), intent(in) :: name, piece
    integer, intent(in) :: n_errors, n_warnings
    type(diagnostic_list_type) :: report
    integer :: i
    logical :: is_found
    call check_contact(model, system%contact, state%new%slaves, report)
    is_found = piece == ''
    do i = 1, report%n_items
      is_found = is_found .or. index(report%items(i)%text, piece) > 0
    end do
    call suite%that(name // ': errors', report%n_errors == n_errors)
    call suite%that(name // ': warnings', report%n_items - report%n_errors == n_warnings)
    call suite%that(name // ': words', is_found)
    if (is_found) return
    do i = 1, report%n_items
      print '(a)', report%items(i)%text
    end do
  end subroutine expect


  !> A slave node inside the master: a warning of a shallow one, an error of a deep one, nothing at a gap.
  subroutine check_depth()
    call start(0.1_DP)
    call expect('at a gap', 0, 0, '')
    call start(0.0_DP)
    call expect('touching', 0, 0, '')
    call start(-0.05_DP)
    call expect('a little inside', 0, 1, '0.05 inside the master')
    call start(-0.9_DP)
    call expect('deep inside', 1, 0, 'probably swapped')
  end subroutine check_depth


  !> The upper sides of both blocks face the same way, one a little above the other.
  subroutine check_direction()
    call two_blocks(model, 0.3_DP, -0.95_DP, [0.0_DP, 0.0_DP, -0.1_DP])
    model%surfaces(1)%face = spread(2, 1, 9)
    model%surfaces(1)%nodes = model%surfaces(1)%nodes + 16
    call start_blocks(model, system, state)
    call expect('the same way, apart', 1, 0, 'None of the 16 slave nodes')
    call two_blocks(model, 0.3_DP, -1.0_DP, [0.0_DP, 0.0_DP, -0.1_DP])
    model%surfaces(2)%face = spread(1, 1, 4)       ! both lower sides, in one plane
    model%surfaces(2)%nodes = model%surfaces(2)%nodes - 9
    call start_blocks(model, system, state)
    call expect('the same way, in one plane', 1, 0, 'face the same way at 16 of 16 slave nodes')
  end subroutine check_direction


  !> Closed: by its status, or by its gap at the start.
  subroutine check_closed()
    call start(0.1_DP)
    associate (slave => state%new%slaves(6))
      call suite%that('open at a gap', slave%status == STATUS_OPEN .and. .not. is_closed(system%contact, slave))
      slave%gap = 0.0_DP
      call suite%that('no gap', is_closed(system%contact, slave))
      slave%gap = 0.1_DP
      slave%status = STATUS_STICK
      call suite%that('by its status', is_closed(system%contact, slave))
      slave%status = STATUS_OPEN
      slave%gap = -1.0_DP
      slave%facet = 0
      call suite%that('without a facet', .not. is_closed(system%contact, slave))
    end associate
  end subroutine check_closed


  !> A pair far apart closes later only by finite sliding, and only if something moves far enough.
  subroutine check_later()
    call start(20.0_DP)
    call suite%that('small displacements', .not. can_close_later(model, system%contact, 1))
    model%steps(1)%is_nlgeom = .true.
    call suite%that('too short a way', .not. can_close_later(model, system%contact, 1))
    model%steps(1)%prescribed%end = -20.0_DP
    call suite%that('far enough', can_close_later(model, system%contact, 1))
    model%pairs(1)%is_small_sliding = .true.
    call suite%that('small sliding', .not. can_close_later(model, system%contact, 1))
  end subroutine check_later

end program test_model_check_contact
