!> Unit test of contact_initialization: status at the start, prescribed clearance, interference over the step, adjustment, areas.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_initialization
  use amontons_contact_initialization, only: initialize_contact, find_adjustment
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_steps, only: step_type
  use amontons_surfaces, only: BEHAVIOR_LINEAR, BEHAVIOR_TIED
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP            ! rounding of coordinates of size 1 over a projection
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_status()
  call check_clearance()
  call check_interference()
  call check_removed()
  call check_areas()
  call check_adjustment()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> Blocks at a gap; made ready for their first increment with the settings of the model.
  subroutine start(gap)
    real(DP), intent(in) :: gap
    call two_blocks(model, 0.3_DP, gap, [0.0_DP, 0.0_DP, 0.0_DP])
    model%steps(1)%is_nlgeom = .true.
  end subroutine start


  !> The start of an increment that ends at a part of the step.
  subroutine initialize(time, is_step_start)
    real(DP), intent(in) :: time
    logical, intent(in) :: is_step_start
    state%new%step = 1
    state%new%step_time = time
    state%new%time_increment = time
    call initialize_contact(system%contact, model, .true., is_step_start, state%old%u, state%new)
  end subroutine initialize


  !> Touching nodes stick, with an origin where they are; others are open; under small sliding the geometry is fixed.
  subroutine check_status()
    call start(0.0_DP)
    call start_blocks(model, system, state)
    state%new%slaves%is_initialized = .false.
    state%new%slaves%status = STATUS_OPEN
    call initialize(1.0_DP, .true.)
    call suite%that('touching nodes stick', all(state%new%slaves%status == STATUS_STICK) .and. &
      all(state%new%slaves%origin_facet > 0))
    call suite%that('finite sliding', .not. system%contact%has_fixed_geometry(1))
    state%new%slaves%status = STATUS_SLIP
    system%contact%laws(1)%friction = 1.0e30_DP
    call initialize(1.0_DP, .false.)
    call suite%that('rough nodes stick where they are', all(state%new%slaves%status == STATUS_STICK))
    model%pairs(1)%is_small_sliding = .true.
    call initialize(1.0_DP, .true.)
    call suite%that('small sliding', system%contact%has_fixed_geometry(1))
    call start(0.01_DP)
    call start_blocks(model, system, state)
    call suite%that('a gap: open', all(state%new%slaves%status == STATUS_OPEN) .and. all(state%new%slaves%facet > 0))
    call suite%near('its size', maxval(abs(state%new%slaves%gap - 0.01_DP)), 0.0_DP, TOL)
  end subroutine check_status


  !> CLEARANCE replaces the gap of the mesh, TIED makes it zero.
  subroutine check_clearance()
    call start(0.01_DP)
    model%pairs(1)%has_clearance = .true.
    model%pairs(1)%clearance = 0.25_DP
    call start_blocks(model, system, state)
    call suite%near('prescribed', maxval(abs(state%new%slaves%gap - 0.25_DP)), 0.0_DP, TOL)
    call start(0.01_DP)
    model%interactions(1)%behavior = BEHAVIOR_TIED
    model%interactions(1)%stiffness = 1000
    call start_blocks(model, system, state)
    call suite%near('tied', maxval(abs(state%new%slaves%gap)), 0.0_DP, TOL)
  end subroutine check_clearance


  !> An allowed overclosure goes to zero over the step; SHRINK allows what each node has.
  subroutine check_interference()
    call start(-0.1_DP)
    model%steps(1)%interference = [0.04_DP]
    model%steps(1)%is_shrink_fit = [.false.]
    call start_blocks(model, system, state)
    call initialize(0.25_DP, .true.)
    call suite%near('three quarters are left', maxval(abs(state%new%slaves%gap - (-0.1_DP + 0.03_DP))), 0.0_DP, TOL)
    call initialize(1.0_DP, .false.)
    call suite%near('nothing at the end', maxval(abs(state%new%slaves%gap + 0.1_DP)), 0.0_DP, TOL)
    system%contact%is_shrink_fit = .true.
    call initialize(0.25_DP, .true.)
    call suite%near('shrink fit', maxval(abs(state%new%slaves%gap + 0.025_DP)), 0.0_DP, TOL)
  end subroutine check_interference


  !> Slaves of a removed pair have no facet.
  subroutine check_removed()
    call start(0.0_DP)
    call start_blocks(model, system, state)
    system%contact%is_removed = .true.
    call initialize(1.0_DP, .true.)
    call suite%that('removed', all(state%new%slaves%facet == 0) .and. all(state%new%slaves%status == STATUS_OPEN) .and. &
      all(state%new%slaves%origin_facet == 0))
  end subroutine check_removed


  !> Areas of compliant laws are those of now: twice as wide after a stretch by two.
  subroutine check_areas()
    call start(0.0_DP)
    model%interactions(1)%behavior = BEHAVIOR_LINEAR
    model%interactions(1)%stiffness = 1000
    call start_blocks(model, system, state)
    call suite%near('at the start', sum(state%new%slaves%area), 1.6_DP**2, TOL)
    state%new%u(1, :) = model%mesh%coordinates(1, :)
    call initialize(1.0_DP, .false.)
    call suite%near('stretched', sum(state%new%slaves%area), 2 * 1.6_DP**2, TOL)
  end subroutine check_areas


  !> ADJUST: nodes within the distance and those that penetrate; or the nodes of a set, wherever they are.
  subroutine check_adjustment()
    type(error_type), allocatable :: error
    real(DP), allocatable :: adjustment(:, :)
    call start(0.01_DP)
    allocate (adjustment(3, model%mesh%n_nodes))
    model%mesh%coordinates(3, 19) = 0.1_DP           ! farther away
    model%mesh%coordinates(3, 24) = -0.02_DP         ! inside
    call find_adjustment(model, adjustment, error)
    call suite%near('not requested', maxval(abs(adjustment)), 0.0_DP, 0.0_DP)
    model%pairs(1)%has_adjust = .true.
    model%pairs(1)%adjust = 0.05_DP
    call find_adjustment(model, adjustment, error)
    call suite%that('adjusted', .not. allocated(error))
    call suite%near('onto the master', maxval(abs(adjustment(3, 20:23) + 0.01_DP)), 0.0_DP, TOL)
    call suite%near('out of it', adjustment(3, 24), 0.02_DP, TOL)
    call suite%near('the far one and the other nodes stay', maxval(abs(adjustment(:, 19))) + maxval(abs(adjustment(:, 35:))) + &
      maxval(abs(adjustment(:, :18))), 0.0_DP, 0.0_DP)
    model%pairs(1)%adjust_nodes = [19]
    call find_adjustment(model, adjustment, error)
    call suite%near('of a set alone', abs(adjustment(3, 19) + 0.1_DP) + abs(adjustment(3, 24)), 0.0_DP, TOL)
  end subroutine check_adjustment

end program test_contact_initialization
