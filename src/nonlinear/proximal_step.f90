!> Carry: bodies that nothing holds yet are carried towards what will hold them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, "Bodies that nothing holds yet". Where the tangent is singular because a body has not met its
!! master, a part s of the stiffness' own diagonal holds each node where it is in this iteration alone:
!!
!!     (K + s diag K) du = R,
!!
!! so that the direction is finite, and s is as small as lets the body go on to where it touches, and some way beyond. The
!! residual knows nothing of s: the next iteration starts from where the body is, and what converges is in balance without it.
module amontons_proximal_step
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_extent
  use amontons_model, only: model_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, slave_type, STATUS_OPEN
  use amontons_contact_constraint_rows, only: contact_row_type, relative_position
  use amontons_contact_pairs, only: touching_row
  use amontons_contact_subproblem, only: settle_contact
  use amontons_equilibrium, only: system_type, evaluate, components_of, sizes_of, TROUBLE_NONE, TROUBLE_SOLVER
  use amontons_newton_step, only: find_direction, carry_bodies
  implicit none
  private
  public :: is_carried_off, find_carried_direction, find_snap_direction

  real(DP), parameter :: LEAST = 1.0e-9_DP         !< part of the stiffness that carries at first [-]
  real(DP), parameter :: MOST = 1.0_DP             !< at most [-]
  real(DP), parameter :: BEYOND = 10.0_DP          !< a body may go this many times the way to where it first touches [-]
  real(DP), parameter :: IN_SIGHT = 2.5_DP         !< but not more than this many edges of a master [-]
  real(DP), parameter :: ENOUGH = 2.0_DP           !< a direction may exceed its way by this [-]
  integer, parameter :: MOST_TRIES = 6
  real(DP), parameter :: LEAST_SNAP = 1.0e-3_DP    !< part of the stiffness that holds nodes through a snap, at first [-]
  real(DP), parameter :: SNAP_RATIO = 6.0_DP       !< of one part tried to the next [-]

contains

  !> Whether a direction says that nothing holds a body: there is none, there was none when contact had settled along it, or it goes
  !! farther than the whole model.
  logical function is_carried_off(system, model, du, trouble)
    type(system_type), intent(in) :: system
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) direction; read if trouble is none [length]
    integer, intent(in) :: trouble                 !< TROUBLE_... of the direction
    real(DP) :: missing(size(du, 2))               ! prescribed displacements that are [length]
    is_carried_off = trouble == TROUBLE_SOLVER .and. size(system%contact%view) > 0
    if (trouble /= TROUBLE_NONE .or. size(system%contact%view) == 0) return
    missing = components_of(system, reshape(system%base%offset, shape(du)), 1)
    is_carried_off = .not. maxval(sizes_of(system, du, 1)) <= mesh_extent(model%mesh) + 2.0_DP * maxval(missing)
    is_carried_off = is_carried_off .or. system%is_unheld
  end function is_carried_off


  !> A direction with every node held by a part of its own stiffness, which is chosen so that bodies go where they touch; contact
  !! has settled at its end where it does.
  subroutine find_carried_direction(system, model, step, state, part, du, ahead, trouble, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: part                !< to try first, 0: none is known; out: to try in the next iteration [-]
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    type(slave_type), allocatable, intent(out) :: ahead(:)   !< memory of the slave nodes at its end
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: excess, too_small
    integer :: attempt
    part = max(LEAST, part)
    too_small = 0.0_DP
    do attempt = 1, MOST_TRIES
      call evaluate(system, model, step, state, trouble, is_frozen=.true.)   ! contact had settled elsewhere
      if (trouble /= TROUBLE_NONE) return
      call carry_bodies(system, model, state%new, part)
      call find_direction(system, model, step, state, du, trouble, error)
      if (allocated(error)) return
      if (trouble == TROUBLE_SOLVER .and. part < MOST) then
        part = min(MOST, 1.0e3_DP * part)
        cycle
      end if
      if (trouble /= TROUBLE_NONE) return
      excess = maxval(sizes_of(system, du, 1)) / free_way(system, model, state, du)
      if (excess <= ENOUGH .or. attempt == MOST_TRIES) then
        call settle_contact(system, model, step, state, du, ahead, error)
        if (allocated(error)) return
        excess = maxval(sizes_of(system, du, 1)) / free_way(system, model, state, du)
      end if
      if (excess <= ENOUGH .or. part >= MOST) exit
      too_small = part
      part = min(MOST, part * excess)
    end do
    part = max(part * min(1.0_DP, excess), sqrt(part * too_small))
    if (.not. allocated(ahead)) ahead = state%new%slaves
  end subroutine find_carried_direction


  !> A direction along which contact settles, where it does not with K as it is: friction lets go faster than the bodies follow, so
  !! that no balance is near. Each node is held by a part of its own stiffness, the least that is tried with which contact settles.
  !! system%is_settled tells whether it does; the state stands at u in any case.
  subroutine find_snap_direction(system, model, step, state, part, du, ahead, trouble, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: part                !< that was enough in the iteration before, 0: none; out: in this one [-]
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    type(slave_type), allocatable, intent(out) :: ahead(:)   !< memory of the slave nodes at its end
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    part = merge(max(LEAST, part / SNAP_RATIO), LEAST_SNAP, part > 0.0_DP)
    do
      call evaluate(system, model, step, state, trouble, is_frozen=.true.)
      if (trouble /= TROUBLE_NONE) return
      call carry_bodies(system, model, state%new, part)
      call find_direction(system, model, step, state, du, trouble, error)
      if (allocated(error) .or. trouble /= TROUBLE_NONE) return
      call settle_contact(system, model, step, state, du, ahead, error)
      if (allocated(error)) return
      if (system%is_settled .or. part >= MOST) exit
      part = min(MOST, SNAP_RATIO * part)
    end do
  end subroutine find_snap_direction


  !> How far a direction may go: to where the first slave node touches and some way beyond, and never out of sight.
  real(DP) function free_way(system, model, state, du) result(way)
    type(system_type), intent(in) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    type(contact_row_type) :: row
    real(DP) :: closing, share
    integer :: s
    way = IN_SIGHT * minval(system%contact%edge)
    share = huge(1.0_DP)
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%facet == 0 .or. slave%status /= STATUS_OPEN) cycle
        call touching_row(system%contact, slave, row)
        closing = -dot_product(slave%normal, relative_position(row, du))
        if (closing > 0.0_DP) share = min(share, max(slave%gap, 1.0e-3_DP * system%contact%edge(slave%pair)) / closing)
      end associate
    end do
    way = min(way, merge(BEYOND, 1.0_DP, system%is_condensed) * share * maxval(sizes_of(system, du, 1)))
    way = max(way, 1.0e-6_DP * mesh_extent(model%mesh))
  end function free_way

end module amontons_proximal_step
