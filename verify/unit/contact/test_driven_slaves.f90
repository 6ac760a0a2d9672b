!> Unit test of driven_slaves: a slave node that supports drive behind its master, and what is none.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_driven_slaves
  use amontons_driven_slaves, only: find_driven_slave
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_loads, only: equation_type, prescribed_type
  use amontons_state, only: state_type
  use amontons_steps, only: step_type
  use amontons_surfaces, only: BEHAVIOR_LINEAR
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  real(DP), parameter :: GAP = 0.05_DP
  integer, parameter :: NODE = 24, UPPER = 40          ! a slave node inside the surface, and the one above it, which is held
  integer, parameter :: NOWHERE(0) = 0, ALL_AXES(3) = [1, 2, 3]
  integer, parameter :: AT_MASTER = 1, AT_SLAVE = 2    ! what the sentence says that supports hold beside the slave node
  type(suite_type) :: suite
  logical :: is_nlgeom
  integer :: i
  do i = 1, 2
    is_nlgeom = i == 2
    call drive('behind', ALL_AXES, -0.1_DP, 0.0_DP, AT_SLAVE)
    call drive('behind by little', ALL_AXES, -0.052_DP, 0.0_DP, AT_SLAVE)
    call drive('held along the normal alone', [3], -0.1_DP, 0.0_DP, AT_SLAVE)
    call drive('not yet there', ALL_AXES, -0.049_DP, 0.0_DP, 0)
    call drive('free', NOWHERE, -0.1_DP, 0.0_DP, 0)
    call drive('held beside the normal', [1, 2], -0.1_DP, 0.0_DP, 0)
    call drive('the master came', ALL_AXES, 0.0_DP, 0.1_DP, AT_SLAVE)
    call drive('the master came, others carry', ALL_AXES, 0.0_DP, 0.1_DP, 0, is_loaded=.true.)
    call drive('behind, others carry', ALL_AXES, -0.1_DP, 0.0_DP, AT_SLAVE, is_loaded=.true.)
    call drive('a law', ALL_AXES, -0.1_DP, 0.0_DP, 0, has_law=.true.)
    call drive('removed', ALL_AXES, -0.1_DP, 0.0_DP, 0, is_removed=.true.)
    call drive('a penalty pushes the master', ALL_AXES, -0.1_DP, 0.0_DP, 0, has_law=.true., is_penalty=.true.)
    call drive('the master is held, too', ALL_AXES, -0.1_DP, 0.0_DP, AT_MASTER, is_master_held=.true.)
    call drive('a penalty, the master is held', ALL_AXES, -0.1_DP, 0.0_DP, AT_MASTER, has_law=.true., is_penalty=.true., &
      is_master_held=.true.)
    call drive('a law, the master is held', ALL_AXES, -0.1_DP, 0.0_DP, 0, has_law=.true., is_master_held=.true.)
    call drive('supports move the master', ALL_AXES, 0.0_DP, 0.1_DP, AT_MASTER, is_master_held=.true.)
    call drive('supports move both as much', ALL_AXES, -0.1_DP, -0.1_DP, 0, is_master_held=.true.)
    call drive('by an equation with a held node', NOWHERE, -0.1_DP, 0.0_DP, AT_SLAVE, followed=UPPER)
    call drive('by an equation with a free node', NOWHERE, -0.1_DP, 0.0_DP, 0, followed=NODE + 1)
  end do
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> Moves the node and the master's surface along the normal.
  subroutine drive(title, held, way, way_of_master, expected, has_law, is_removed, is_master_held, is_penalty, followed, &
    is_loaded)
    character(*), intent(in) :: title
    integer, intent(in) :: held(:)               !< axes along which a support holds the slave node
    real(DP), intent(in) :: way, way_of_master   !< [length]
    integer, intent(in) :: expected              !< AT_...; 0: no sentence
    logical, intent(in), optional :: has_law, is_removed, is_master_held, is_penalty
    logical, intent(in), optional :: is_loaded   !< another slave node pushes the master
    integer, intent(in), optional :: followed    !< a node whose motion equations give the slave node
    character(*), parameter :: ENDS(2) = [character(32) :: 'whose motion they prescribe, too', 'exact contact cannot push a node']
    type(model_type) :: model
    type(equilibrium_type), allocatable :: system
    type(state_type) :: state
    real(DP), allocatable :: u(:, :)
    character(:), allocatable :: message
    character(5) :: verb
    integer :: k
    call two_blocks(model, 0.0_DP, GAP, [0.0_DP, 0.0_DP, -0.1_DP])
    model%steps(1)%is_nlgeom = is_nlgeom
    call hold(model%steps(1), [(NODE, k=1, size(held))], held)
    if (present(is_master_held)) call hold(model%steps(1), [(10 + (k - 1) / 3, k=1, 27)], &
      [(1 + mod(k - 1, 3), k=1, 27)])
    if (present(followed)) model%equations = [(equation_type(node=[NODE, followed], dof=[k, k], coefficient=[1.0_DP, -1.0_DP], &
      n_eliminable=1), k=1, 3)]
    call start_blocks(model, system, state)
    if (present(has_law)) system%contact%laws(1)%behavior = BEHAVIOR_LINEAR
    if (present(is_penalty)) system%contact%laws(1)%is_penalty = .true.
    if (present(is_removed)) system%contact%is_removed = is_removed
    state%new%slaves(NODE - 18)%facet = 0
    if (present(is_loaded)) state%new%slaves(NODE - 17)%force(3) = 1.0_DP
    allocate (u(3, model%mesh%n_nodes), source=0.0_DP)
    u(3, NODE) = way
    u(3, 10:18) = way_of_master
    call find_driven_slave(model, system%contact, system%base, state%new%slaves, u, message)
    if (expected == 0) then
      call suite%that(title, message == '')
    else
      verb = merge('hold ', 'drive', expected == AT_SLAVE .and. .not. abs(way) > 0)
      call suite%that(title, index(message, 'slave-master: supports ' // trim(verb) // ' the slave node 124 by') > 0)
      call suite%that(title // ', and why', index(message, trim(ENDS(expected))) > 0)
    end if
  end subroutine drive


  !> Adds supports of nodes along axes to the step.
  subroutine hold(step, nodes, axes)
    type(step_type), intent(inout) :: step
    integer, intent(in) :: nodes(:), axes(:)
    type(prescribed_type) :: supports(size(nodes))
    supports%node = nodes
    supports%dof = axes
    step%prescribed = [step%prescribed, supports]
  end subroutine hold

end program test_driven_slaves
