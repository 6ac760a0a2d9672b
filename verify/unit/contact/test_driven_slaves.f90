!> Unit test of driven_slaves: a slave node that supports drive behind its master, and what is none.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_driven_slaves
  use amontons_driven_slaves, only: find_driven_slave
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_state, only: state_type
  use amontons_steps, only: step_type
  use amontons_surfaces, only: BEHAVIOR_LINEAR
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  real(DP), parameter :: GAP = 0.05_DP, FREE(3) = 1.0_DP, HELD(3) = 0.0_DP
  integer, parameter :: S = 6, NODE = 24               ! the slave inside the surface, and its node
  type(suite_type) :: suite
  logical :: is_nlgeom
  integer :: i
  do i = 1, 2
    is_nlgeom = i == 2
    call drive('behind', HELD, -0.1_DP, 0.0_DP, .true.)
    call drive('behind by little', HELD, -0.052_DP, 0.0_DP, .true.)
    call drive('held along the normal alone', [1.0_DP, 1.0_DP, 0.0_DP], -0.1_DP, 0.0_DP, .true.)
    call drive('not yet there', HELD, -0.049_DP, 0.0_DP, .false.)
    call drive('free', FREE, -0.1_DP, 0.0_DP, .false.)
    call drive('held beside the normal', [0.0_DP, 0.0_DP, 1.0_DP], -0.1_DP, 0.0_DP, .false.)
    call drive('the master came', HELD, 0.0_DP, 0.1_DP, .false.)
    call drive('a law', HELD, -0.1_DP, 0.0_DP, .false., has_law=.true.)
    call drive('removed', HELD, -0.1_DP, 0.0_DP, .false., is_removed=.true.)
    call drive('the master is held, too', HELD, -0.1_DP, 0.0_DP, .false., is_master_held=.true.)
  end do
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> Moves the node and the master's surface along the normal.
  subroutine drive(title, free_mask, way, way_of_master, is_found, has_law, is_removed, is_master_held)
    character(*), intent(in) :: title
    real(DP), intent(in) :: free_mask(3)         !< of the slave
    real(DP), intent(in) :: way, way_of_master   !< [length]
    logical, intent(in) :: is_found
    logical, intent(in), optional :: has_law, is_removed, is_master_held
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    real(DP), allocatable :: u(:, :)
    character(:), allocatable :: message
    integer :: k
    call two_blocks(model, 0.0_DP, GAP, [0.0_DP, 0.0_DP, -0.1_DP])
    model%steps(1)%is_nlgeom = is_nlgeom
    call start_blocks(model, system, state)
    system%contact%free_mask(:, S) = free_mask
    if (present(has_law)) system%contact%laws(1)%behavior = BEHAVIOR_LINEAR
    if (present(is_removed)) system%contact%is_removed = is_removed
    if (present(is_master_held)) then
      do k = 1, 27                               ! the supports of the bottom hold the top of the master in their place
        model%steps(1)%prescribed(k)%node = 10 + (k - 1) / 3
      end do
    end if
    state%new%slaves(S)%facet = 0
    allocate (u(3, model%mesh%n_nodes), source=0.0_DP)
    u(3, NODE) = way
    u(3, 10:18) = way_of_master
    call find_driven_slave(model, system%contact, state%new%slaves, u, 1, message)
    call suite%that(title, is_found .eqv. index(message, 'slave-master: supports drive the slave node 124 by') > 0)
    if (.not. is_found) call suite%that(title // ': nothing else', message == '')
  end subroutine drive

end program test_driven_slaves
