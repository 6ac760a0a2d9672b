!> Unit test of model_check_motion: a block on another one, held by supports or contact, and the motion that is left.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_model_check_motion
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_mpc_data, only: MPC_RIGID_BODY
  use amontons_model_check_bodies, only: bodies_type, find_bodies
  use amontons_model_check_motion, only: check_rigid_motions, find_free_motion
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  integer, parameter :: BOTTOM = 27                ! supports of the lower block
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_supports()
  call check_contacts()
  call check_mpcs()
  call check_report()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> Blocks with the upper one held at nodes of its top in given directions.
  subroutine hold(nodes, directions)
    integer, intent(in) :: nodes(:), directions(:)
    integer :: i, d
    call two_blocks(model, 0.3_DP, 0.0_DP, [0.0_DP, 0.0_DP, 0.0_DP])
    call start_blocks(model, system, state)
    associate (step => model%steps(1))
      step%prescribed = [step%prescribed(:BOTTOM), step%prescribed(BOTTOM + 1:BOTTOM + size(nodes) * size(directions))]
      do i = 1, size(nodes)
        do d = 1, size(directions)
          step%prescribed(BOTTOM + d + (i - 1) * size(directions))%node = nodes(i)
          step%prescribed(BOTTOM + d + (i - 1) * size(directions))%dof = directions(d)
        end do
      end do
    end associate
  end subroutine hold


  !> Whether a motion is left with all slaves of a status.
  subroutine expect(name, status, is_expected)
    character(*), intent(in) :: name
    integer, intent(in) :: status
    logical, intent(in) :: is_expected
    character(:), allocatable :: motion
    logical :: is_free
    state%new%slaves%status = status
    call find_free_motion(model, system%contact, state%new%slaves, 1, is_free, motion)
    call suite%that(name, is_free .eqv. is_expected)
    call suite%that(name // ': in words', allocated(motion) .eqv. is_expected)
    if (allocated(motion)) call suite%that(name // ': not empty', len_trim(motion) > 0)
  end subroutine expect


  !> Open contact: nodes on a line leave the rotation about it, one more node does not; one direction leaves much.
  subroutine check_supports()
    call hold([35, 36, 37, 38], [1, 2, 3])
    call expect('held on a line', STATUS_OPEN, .true.)
    call hold([35, 36, 39], [1, 2, 3])
    call expect('held at three corners', STATUS_OPEN, .false.)
    call hold([35, 36, 39], [1, 2])
    call expect('free along z', STATUS_OPEN, .true.)
    call hold([35], [1, 2, 3])
    call expect('held at a node', STATUS_OPEN, .true.)
  end subroutine check_supports


  !> Sticking slaves hold all, slipping ones the height and the tilt.
  subroutine check_contacts()
    call hold([35], [3])
    call expect('sticking', STATUS_STICK, .false.)
    call expect('slipping', STATUS_SLIP, .true.)
    call hold([35, 36], [1, 2])
    call expect('slipping, held across', STATUS_SLIP, .false.)
    call expect('the same, open', STATUS_OPEN, .true.)
    state%new%slaves%facet = 0
    call expect('closed without a facet', STATUS_STICK, .true.)
  end subroutine check_contacts


  !> A nonlinear MPC makes nodes of the top one rigid body with fixed nodes of the bottom, and holds the upper block; one that
  !! leaves the direction z leaves three motions.
  subroutine check_mpcs()
    call hold([35], [3])
    call expect('without an MPC', STATUS_OPEN, .true.)
    allocate (model%nonlinear_mpcs(1))
    associate (mpc => model%nonlinear_mpcs(1))
      mpc%kind = MPC_RIGID_BODY
      mpc%node = [35, 36, 39]
      mpc%reference = 1
      mpc%rotation = 2
      mpc%card = 'MPC'
    end associate
    call expect('held by an MPC', STATUS_OPEN, .false.)
    call expect('the same, slipping', STATUS_SLIP, .false.)
    model%nonlinear_mpcs(1)%is_bound(3) = .false.
    call expect('an MPC that leaves z', STATUS_OPEN, .true.)
    call expect('the same, slipping: contact holds the rest', STATUS_SLIP, .false.)
  end subroutine check_mpcs


  !> The check before the job: an error where nothing can hold the body, none where its contact touches.
  subroutine check_report()
    call hold([35, 36], [1, 2])
    call suite%that('touching: no error', n_errors() == 0)
    state%new%slaves%facet = 0
    state%new%slaves%status = STATUS_OPEN
    call suite%that('without a master: an error', n_errors() == 1)
    call hold([35, 36, 39], [1, 2, 3])
    state%new%slaves%facet = 0
    state%new%slaves%status = STATUS_OPEN
    call suite%that('supported: none', n_errors() == 0)
  end subroutine check_report


  !> Errors of the check with the slaves as they are.
  integer function n_errors()
    type(diagnostic_list_type) :: report
    type(bodies_type) :: bodies
    call find_bodies(model, model%equations, 1, bodies)
    call check_rigid_motions(model, system%contact, state%new%slaves, bodies, report)
    n_errors = report%n_errors
  end function n_errors

end program test_model_check_motion
