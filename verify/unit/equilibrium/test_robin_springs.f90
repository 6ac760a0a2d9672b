!> Unit test of robin_springs: the springs between two blocks oppose their relative motion with the known sums, and no common one.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_robin_springs
  use amontons_contact_linearization, only: contact_tangent_type
  use amontons_contact_pairs, only: current_row
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_errors, only: error_type
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_controls, only: skin_controls_type
  use amontons_robin_springs, only: find_near, robin_springs, skin_rows, master_shares, following_motion
  use amontons_sparse, only: sparse_type, sparse_from_triplets
  use amontons_state, only: state_type, STATUS_STICK
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: KIND_C3D8
  use check, only: suite_type
  implicit none
  integer, parameter :: N_SLAVES = 16
  real(DP), parameter :: OWN = 2.0_DP, TOL = 1.0e-13_DP   ! stiffness of each slave; rounding of weights over it
  type(suite_type) :: suite
  type(model_type) :: model
  type(equilibrium_type), allocatable :: system
  type(state_type) :: state
  call check_near()
  call check_hard()
  call check_compliant()
  call check_rows()
  call check_shares()
  call check_following()
  call suite%finish()

contains

  include 'sample_blocks.inc'

  !> Blocks at a gap, evaluated at the start of the first increment; all slaves have the same stiffness.
  subroutine start(gap)
    real(DP), intent(in) :: gap
    integer :: outcome
    call two_blocks(model, 0.3_DP, gap, [0.0_DP, 0.0_DP, -0.1_DP])
    call start_blocks(model, system, state)
    call evaluate_equilibrium(system, model, model%steps(1), state, outcome, is_frozen=.false.)
    state%new%slaves%stiffness = OWN
  end subroutine start


  !> The work of the springs, twice their energy, at a unit translation of the upper block against the lower one, or of both.
  real(DP) function work(closed, axis, is_relative)
    type(contact_tangent_type), intent(in) :: closed(:)
    integer, intent(in) :: axis
    logical, intent(in) :: is_relative
    type(sparse_type) :: springs
    real(DP) :: u(3 * model%mesh%n_nodes)
    integer :: i, p
    call robin_springs(skin_controls_type(), system%contact, state%new, find_near(system%contact, state%new, 0.5_DP), &
      closed, size(u), springs)
    u = 0.0_DP
    u(54 + axis::3) = 1.0_DP
    if (.not. is_relative) u(axis::3) = 1.0_DP
    work = 0.0_DP
    do i = 1, springs%n_rows                       ! rows of other nodes are empty
      do p = springs%first(i), springs%first(i + 1) - 1
        work = work + merge(1.0_DP, 2.0_DP, springs%column(p) == i) * springs%value(p) * u(i) * u(springs%column(p))
      end do
    end do
  end function work


  !> Slaves are near up to half an edge, 0.6 here; a closed one is near at any gap.
  subroutine check_near()
    call start(0.59_DP)
    call suite%that('within half an edge', all(find_near(system%contact, state%new, 0.5_DP)))
    call start(0.61_DP)
    call suite%that('beyond it', .not. any(find_near(system%contact, state%new, 0.5_DP)))
    state%new%slaves(5)%status = STATUS_STICK
    call suite%that('but closed', count(find_near(system%contact, state%new, 0.5_DP)) == 1)
    state%new%slaves(5)%facet = 0
    call suite%that('without a facet', .not. any(find_near(system%contact, state%new, 0.5_DP)))
  end subroutine check_near


  !> Exact contact: c along the normal and c/10 across it, for each of the sixteen slaves.
  subroutine check_hard()
    type(contact_tangent_type) :: none(0)
    call start(0.1_DP)
    call suite%near('along the normal', work(none, 3, .true.), N_SLAVES * OWN, N_SLAVES * OWN * TOL)
    call suite%near('across it', work(none, 1, .true.), 0.1_DP * N_SLAVES * OWN, N_SLAVES * OWN * TOL)
    call suite%near('no force at a common translation', work(none, 3, .false.), 0.0_DP, N_SLAVES * OWN * TOL)
  end subroutine check_hard


  !> A compliant law: the mean slopes of two closed slaves times the areas of all, at most the springs of exact contact. The law
  !! needs no directions that the supports leave free: the evaluation of exact contact, which finds them, did not run.
  subroutine check_compliant()
    type(contact_tangent_type) :: closed(2)
    real(DP), parameter :: ALONG = 3.0_DP, ACROSS = 0.2_DP
    real(DP) :: area
    integer :: i
    call start(0.1_DP)
    system%contact%free = 0.0_DP
    area = sum(state%new%slaves%area)
    closed%slave = [1, 6]
    closed%is_compliant_node = .true.
    state%new%slaves([1, 6])%status = STATUS_STICK
    do i = 1, 2
      closed(i)%spring(1, 1) = ACROSS * state%new%slaves(closed(i)%slave)%area
      closed(i)%spring(2, 2) = closed(i)%spring(1, 1)
      closed(i)%spring(3, 3) = ALONG * state%new%slaves(closed(i)%slave)%area
    end do
    call suite%near('slope of the pressure', work(closed, 3, .true.), ALONG * area, ALONG * area * TOL)
    call suite%near('slope of the shear', work(closed, 2, .true.), ACROSS * area, ACROSS * area * TOL)
    do i = 1, 2
      closed(i)%spring = 1.0e3_DP * closed(i)%spring
    end do
    call suite%near('a stiff law', work(closed, 3, .true.), N_SLAVES * OWN, N_SLAVES * OWN * TOL)
    call suite%near('its shear', work(closed, 2, .true.), 0.1_DP * N_SLAVES * OWN, N_SLAVES * OWN * TOL)
    closed%is_compliant_node = .false.
    call suite%near('exact contact has no slope', work(closed, 3, .true.), N_SLAVES * OWN, N_SLAVES * OWN * TOL)
  end subroutine check_compliant


  !> The skin: each near slave with the nodes of its facet, the slave first; a closed one with those of its tangent.
  subroutine check_rows()
    type(contact_tangent_type) :: closed(1)
    type(sparse_type) :: rows
    type(contact_row_type) :: row
    logical :: is_near(N_SLAVES)
    call start(0.1_DP)
    is_near = .false.
    is_near([2, 4]) = .true.
    closed%slave = 3
    closed%node = 21
    closed%n_weights = 2
    closed(1)%nodes = [21, 10]
    closed(1)%weights = [1.0_DP, -0.5_DP]
    closed(1)%imbalance_nodes = [22]
    call skin_rows(system%contact, state%new, is_near, closed, model%mesh%n_nodes, rows)
    call suite%that('three rows', rows%n_rows == 3)
    call suite%that('slaves first', all(rows%column(rows%first(:3)) == [20, 21, 22]))
    call suite%that('a tangent''s nodes', all(rows%column(rows%first(2):rows%first(3) - 1) == [21, 21, 10, 22]))
    call suite%near('sizes of its weights', maxval(abs(rows%value(rows%first(2):rows%first(3) - 1) &
      - [1.0_DP, 1.0_DP, 0.5_DP, 0.0_DP])), 0.0_DP, TOL)
    call current_row(system%contact, state%new%slaves(4), row)
    call suite%that('a near slave''s row', all(rows%column(rows%first(3) + 1:rows%first(4) - 1) == row%nodes))
  end subroutine check_rows


  !> Shares of masters: those of a node's row; the mean over the rows of points; none through a node that is slave and master, nor
  !! of exact contact. A master beside which a node lies on its extended facet remains a master.
  subroutine check_shares()
    type(contact_tangent_type) :: closed(5)
    type(sparse_type) :: shares
    type(error_type), allocatable :: error
    integer :: i
    closed%is_compliant_node = [.true., .true., .true., .true., .false.]
    closed%n_weights = 3
    closed(1)%nodes = [1, 8, 9]                    ! a node
    closed(1)%weights = [1.0_DP, -0.25_DP, -0.75_DP]
    closed(2)%nodes = [2, 3, 9]                    ! points of a face
    closed(2)%weights = [0.5_DP, 0.5_DP, -1.0_DP]
    closed(3)%nodes = [2, 3, 8]
    closed(3)%weights = [1.0_DP, 0.0_DP, -1.0_DP]
    closed(4)%nodes = [9, 1, 4]                    ! a master that is a slave of another pair
    closed(4)%weights = [1.0_DP, -0.5_DP, -0.5_DP]
    closed(5)%nodes = [5, 8, 9]
    closed(5)%weights = [1.0_DP, -0.5_DP, -0.5_DP]
    call master_shares(closed, 10, shares, error)
    call suite%that('shares: no error', .not. allocated(error))
    call suite%that('rows of the slaves', all(shares%first == [1, 3, 5, 6, 6, 6, 6, 6, 6, 6, 6]))
    call suite%that('their masters', all(shares%column == [8, 9, 8, 9, 9]))
    call suite%near('their shares', maxval(abs(shares%value - [0.25_DP, 0.75_DP, 2.0_DP / 3.0_DP, 1.0_DP / 3.0_DP, 1.0_DP])), &
      0.0_DP, TOL)
    call master_shares(closed(5:), 10, shares, error)
    call suite%that('exact contact has no jumps', size(shares%column) == 0 .and. all([(shares%first(i) == 1, i=1, 11)]))
    closed(1)%weights = [1.0_DP, 0.1_DP, -1.1_DP]  ! on a facet that is extended beyond its nodes 9
    closed(2)%nodes = [2, 8, 9]
    closed(2)%weights = [1.0_DP, -0.75_DP, -0.25_DP]
    call master_shares(closed(:2), 10, shares, error)
    call suite%that('extended: the slaves alone follow', all(shares%first(1:4) == [1, 2, 4, 4]) .and. size(shares%column) == 3)
    call suite%that('extended: both are masters', all(shares%column == [9, 8, 9]))
  end subroutine check_shares


  !> A slave with the stiffness c under a law with the slope k along the third axis follows its masters there by k/(k + c) of their
  !! shares, and nowhere else; exact contact has no such motion.
  subroutine check_following()
    real(DP), parameter :: C = 2.0_DP, SLOPE = 6.0_DP
    type(contact_tangent_type) :: closed(1)
    type(sparse_type) :: stiffness, shares, motion
    type(error_type), allocatable :: error
    integer :: i
    closed%is_compliant_node = .true.
    closed%n_weights = 3
    closed(1)%nodes = [1, 3, 4]
    closed(1)%weights = [1.0_DP, -0.25_DP, -0.75_DP]
    closed(1)%spring(3, 3) = SLOPE
    call sparse_from_triplets(12, 12, [(i, i=1, 12)], [(i, i=1, 12)], [(C, i=1, 12)], stiffness, error)
    call master_shares(closed, 4, shares, error)
    call following_motion(closed, stiffness, shares, motion, error)
    call suite%that('following: no error', .not. allocated(error) .and. motion%n_rows == 12)
    call suite%that('the slave alone follows', all(motion%first(4:) == size(motion%column) + 1))
    call suite%near('along the normal', sum(motion%value), SLOPE / (SLOPE + C), TOL)
    call suite%near('the first master', sum(pack(motion%value, motion%column == 9)), 0.25_DP * SLOPE / (SLOPE + C), TOL)
    closed%is_compliant_node = .false.
    call master_shares(closed, 4, shares, error)
    call following_motion(closed, stiffness, shares, motion, error)
    call suite%that('exact contact has none', size(motion%column) == 0)
  end subroutine check_following

end program test_robin_springs
