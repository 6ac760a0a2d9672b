!> Unit test of contact_evaluation: status and force of each node by its imbalance, supports, compliant laws, reactions, counts.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_evaluation
  use amontons_contact_evaluation, only: evaluate_contact
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_steps, only: step_type
  use amontons_surfaces, only: BEHAVIOR_LINEAR
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-12_DP
  integer, parameter :: S = 6                          ! the slave of node 24, inside the surface
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  real(DP), allocatable :: imbalance(:, :)
  call check_stick()
  call check_slip()
  call check_limit()
  call check_open()
  call check_frozen()
  call check_supported()
  call check_compliant()
  call check_sliding()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> Blocks that touch, without an imbalance; all slave nodes stick.
  subroutine start(friction, gap)
    real(DP), intent(in) :: friction, gap
    call two_blocks(model, friction, gap, [0.0_DP, 0.0_DP, -0.1_DP])
    model%steps(1)%is_nlgeom = .true.
    call start_blocks(model, system, state)
    state%new%slaves%stiffness = 1000                ! known after the first linearization of a job
    if (allocated(imbalance)) deallocate (imbalance)
    allocate (imbalance(3, model%mesh%n_nodes), source=0.0_DP)
  end subroutine start


  !> Evaluates with the imbalance of node 24.
  subroutine evaluate(Rhat, is_frozen)
    real(DP), intent(in) :: Rhat(3)
    logical, intent(in), optional :: is_frozen
    logical :: keeps
    keeps = .false.
    if (present(is_frozen)) keeps = is_frozen
    imbalance(:, 24) = Rhat
    call evaluate_contact(system%contact, model, state%old, imbalance, keeps, state%new, .false.)
  end subroutine evaluate


  !> Force, shear and status of the slave.
  subroutine expect(name, status, force, shear)
    character(*), intent(in) :: name
    integer, intent(in) :: status
    real(DP), intent(in) :: force(3), shear(3)
    associate (slave => state%new%slaves(S))
      call suite%that(name // ': status', slave%status == status)
      call suite%near(name // ': force', maxval(abs(slave%force - force)), 0.0_DP, TOL)
      call suite%near(name // ': shear', maxval(abs(slave%shear - shear)), 0.0_DP, TOL)
    end associate
    call suite%near(name // ': action and reaction', maxval(abs(sum(state%new%contact_force, 2))), 0.0_DP, TOL)
  end subroutine expect


  !> Pressed with 10, pulled sideways with less than 3: contact balances all of it.
  subroutine check_stick()
    call start(0.3_DP, 0.0_DP)
    call evaluate([1.0_DP, 2.0_DP, -10.0_DP])
    call expect('stick', STATUS_STICK, [0.0_DP, 0.0_DP, 10.0_DP], [-1.0_DP, -2.0_DP, 0.0_DP])
    call suite%near('stick: on the node', maxval(abs(state%new%contact_force(:, 24) - [-1.0_DP, -2.0_DP, 10.0_DP])), 0.0_DP, TOL)
    call suite%near('stick: the pressure required', system%contact%slip_data(S)%N, 10.0_DP, TOL)
    call suite%near('stick: no gap error', system%contact%max_gap_error, 0.0_DP, TOL)
  end subroutine check_stick


  !> Pulled with 5: friction 3 along the pull; without friction nothing.
  subroutine check_slip()
    call start(0.3_DP, 0.0_DP)
    call evaluate([3.0_DP, 4.0_DP, -10.0_DP])
    call expect('slip', STATUS_SLIP, [0.0_DP, 0.0_DP, 10.0_DP], [-1.8_DP, -2.4_DP, 0.0_DP])
    call suite%that('slip: one change', system%contact%n_changed >= 1 .and. system%contact%n_newly_opened == 0)
    call start(0.0_DP, 0.0_DP)
    call evaluate([3.0_DP, 4.0_DP, -10.0_DP])
    call expect('frictionless', STATUS_SLIP, [0.0_DP, 0.0_DP, 10.0_DP], [0.0_DP, 0.0_DP, 0.0_DP])
  end subroutine check_slip


  !> TAUMAX over the area limits the shear; rough surfaces hold any.
  subroutine check_limit()
    call start(0.3_DP, 0.0_DP)
    system%contact%laws(1)%shear_limit = 2 / state%new%slaves(S)%area
    call evaluate([3.0_DP, 4.0_DP, -10.0_DP])
    call expect('TAUMAX', STATUS_SLIP, [0.0_DP, 0.0_DP, 10.0_DP], [-1.2_DP, -1.6_DP, 0.0_DP])
    call start(1.0e30_DP, 0.0_DP)
    call evaluate([3.0_DP, 4.0_DP, -1.0e-3_DP])
    call expect('rough', STATUS_STICK, [0.0_DP, 0.0_DP, 1.0e-3_DP], [-3.0_DP, -4.0_DP, 0.0_DP])
  end subroutine check_limit


  !> Pulled off: open, no force, counted; an open node at a gap stays open whatever its imbalance.
  subroutine check_open()
    call start(0.3_DP, 0.0_DP)
    call evaluate([0.0_DP, 0.0_DP, 1.0_DP])
    call expect('pulled off', STATUS_OPEN, [0.0_DP, 0.0_DP, 0.0_DP], [0.0_DP, 0.0_DP, 0.0_DP])
    call suite%that('pulled off: counted', system%contact%n_newly_opened == 1 .and. system%contact%n_closed == 0)
    call start(0.3_DP, 0.1_DP)
    call evaluate([0.0_DP, 0.0_DP, -0.01_DP])
    call expect('at a gap', STATUS_OPEN, [0.0_DP, 0.0_DP, 0.0_DP], [0.0_DP, 0.0_DP, 0.0_DP])
    state%new%u(3, 24) = -0.2_DP                       ! through the master
    call evaluate([0.0_DP, 0.0_DP, -0.01_DP])
    call suite%that('closed: by penetration', state%new%slaves(S)%status == STATUS_STICK .and. system%contact%n_closed == 1)
    call suite%near('closed: its error over the edge', system%contact%max_gap_error, 0.1_DP / 1.2_DP, TOL)
    call suite%that('closed: which', system%contact%worst_slave == S)
    call suite%that('closed: with an origin', state%new%slaves(S)%origin_facet > 0)
  end subroutine check_open


  !> A frozen status: a node that sticks keeps sticking, in tension too.
  subroutine check_frozen()
    call start(0.3_DP, 0.0_DP)
    call evaluate([0.0_DP, 5.0_DP, 1.0_DP], is_frozen=.true.)
    call expect('frozen', STATUS_STICK, [0.0_DP, 0.0_DP, -1.0_DP], [0.0_DP, -5.0_DP, 0.0_DP])
    call suite%that('frozen: no change', system%contact%n_changed == 0)
  end subroutine check_frozen


  !> A support along the normal leaves nothing to contact; one across it takes that part of the friction.
  subroutine check_supported()
    call start(0.3_DP, 0.0_DP)
    system%contact%free_mask(:, S) = [1.0_DP, 1.0_DP, 0.0_DP]
    call evaluate([0.0_DP, 0.0_DP, -10.0_DP])
    call expect('normal held', STATUS_OPEN, [0.0_DP, 0.0_DP, 0.0_DP], [0.0_DP, 0.0_DP, 0.0_DP])
    call suite%that('normal held: facet dropped', system%contact%n_lost_master == 1)
    call start(0.3_DP, 0.0_DP)
    system%contact%free_mask(:, S) = [0.0_DP, 1.0_DP, 1.0_DP]
    call evaluate([9.0_DP, 4.0_DP, -10.0_DP])
    call expect('x held', STATUS_SLIP, [0.0_DP, 0.0_DP, 10.0_DP], [0.0_DP, -3.0_DP, 0.0_DP])
  end subroutine check_supported


  !> LINEAR: force K h A; the imbalance does not matter where other slaves act on the row. Stick slope until the friction limit.
  subroutine check_compliant()
    real(DP) :: area
    call two_blocks(model, 0.3_DP, 0.0_DP, [0.0_DP, 0.0_DP, -0.1_DP])
    model%steps(1)%is_nlgeom = .true.
    model%interactions(1)%behavior = BEHAVIOR_LINEAR
    model%interactions(1)%stiffness = 1000.0_DP
    model%interactions(1)%stick_slope = 100.0_DP
    call start_blocks(model, system, state)
    if (allocated(imbalance)) deallocate (imbalance)
    allocate (imbalance(3, model%mesh%n_nodes), source=0.0_DP)
    system%contact%is_uncoupled = .false.
    area = state%new%slaves(S)%area
    state%new%slaves(S)%origin_facet = 0
    state%new%u(:, 24) = [0.0_DP, 0.0_DP, -0.01_DP]
    call evaluate([0.0_DP, 0.0_DP, 77.0_DP])
    call suite%near('linear: pressure 1000 h', maxval(abs(state%new%slaves(S)%force - [0.0_DP, 0.0_DP, 10 * area])), 0.0_DP, &
      1.0e-6_DP)
    call suite%near('linear: reaction', maxval(abs(sum(state%new%contact_force, 2))), 0.0_DP, TOL)
    call suite%near('linear: energy K h^2/2 A', state%new%slaves(S)%energy, 0.05_DP * area, 1.0e-6_DP)
    state%new%u(:, 24) = [0.0_DP, 0.0_DP, 0.1_DP]
    call evaluate([0.0_DP, 0.0_DP, -77.0_DP])
    call expect('linear: open', STATUS_OPEN, [0.0_DP, 0.0_DP, 0.0_DP], [0.0_DP, 0.0_DP, 0.0_DP])
  end subroutine check_compliant


  !> A node that slid by 0.1 since its origin slips against that slide, without an imbalance along the surface.
  subroutine check_sliding()
    call start(0.3_DP, 0.0_DP)
    state%new%u(1, 24) = 0.1_DP
    call evaluate([0.0_DP, 0.0_DP, -10.0_DP])
    call expect('sliding', STATUS_SLIP, [0.0_DP, 0.0_DP, 10.0_DP], [-3.0_DP, 0.0_DP, 0.0_DP])
    call suite%near('sliding: its slip', maxval(abs(state%new%slaves(S)%slip_increment - [0.1_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
    call start(0.3_DP, 0.0_DP)
    state%new%u(1, 24) = 0.4_DP                      ! onto the next facet: with the nodes 11, 12, 14 and 15
    call evaluate([0.0_DP, 0.0_DP, -10.0_DP])
    call suite%that('onto the next facet: its nodes carry the reaction', abs(state%new%contact_force(3, 12)) > 0.1_DP)
  end subroutine check_sliding

end program test_contact_evaluation
