!> Course: which direction an iteration takes: Newton's, one that carries bodies, or one that takes them on to the next balance.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, "Which direction is taken". What is remembered of the directions of an attempt is here alone: how
!! many running led to no balance, whether the last one was refused, and what part of their stiffness held nodes where bodies were
!! carried.
module amontons_globalization
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, SEARCH_AUTO
  use amontons_state, only: state_type, slave_type
  use amontons_convergence, only: progress_type
  use amontons_contact_subproblem, only: settle_contact
  use amontons_proximal_step, only: is_carried_off, find_carried_direction, find_snap_direction
  use amontons_equilibrium, only: system_type, TROUBLE_NONE
  use amontons_newton_step, only: find_direction
  implicit none
  private
  public :: course_type, way_type, be_patient, choose_way, is_lost, COURSE_NEWTON, COURSE_SNAP

  integer, parameter :: COURSE_NEWTON = 0          !< the direction is that of K
  integer, parameter :: COURSE_CARRY = 1           !< a part of its stiffness holds every node: nothing holds a body yet
  integer, parameter :: COURSE_SNAP = 2            !< the same, on the way from one balance to the next

  integer, parameter :: AT_ONCE = 0, LATE = 2, NEVER = huge(1)   !< for patience

  real(DP), parameter :: HELD_MORE = 36.0_DP       !< of the part that holds drifting bodies: six times the last iteration [-]

  !> The course of an attempt.
  type :: course_type
    integer :: now = COURSE_NEWTON                 !< COURSE_... of the last iteration
    integer :: n_carried = 0                       !< iterations in which a part of its stiffness held every node
    integer :: n_snapped = 0                       !< of them, those from one balance to the next
    logical :: is_refused = .false.                !< no length of the last direction was any good
    integer, private :: n_astray = 0               !< last directions running that lead to no balance
    integer, private :: patience = AT_ONCE         !< more directions astray than these, and bodies are carried on
    real(DP), private :: carried_part = 0          !< part of their stiffness that is expected to carry bodies [-]
    real(DP), private :: snap_part = 0             !< part of their stiffness that held nodes through a snap [-]
  end type course_type

  !> Where an iteration goes.
  type :: way_type
    real(DP), allocatable :: du(:, :)              !< (3, n_nodes) [length]
    type(slave_type), allocatable :: ahead(:)      !< memory of the slave nodes at its end
  end type way_type

contains

  !> Bodies are carried on only after several directions astray: the attempt may be cut back instead.
  pure subroutine be_patient(course)
    type(course_type), intent(inout) :: course
    course%patience = LATE
  end subroutine be_patient


  !> Whether more than one direction led to no balance.
  pure logical function is_lost(course)
    type(course_type), intent(in) :: course
    is_lost = max(course%n_astray, course%n_snapped) > 1
  end function is_lost


  !> The way. Where too many directions led to no balance, running, bodies are carried on to the next one. That the next direction
  !! will not do is known before it is made if no length of the last one was any good, or if a body drifts along a motion that
  !! hardly anything holds.
  subroutine choose_way(course, system, model, step, progress, state, way, trouble, error)
    type(course_type), intent(inout) :: course
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(progress_type), intent(in) :: progress
    type(state_type), intent(inout) :: state       !< evaluated at u, and stands there after
    type(way_type), intent(out) :: way
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    logical :: is_drifting, is_hopeless
    trouble = TROUBLE_NONE
    allocate (way%du, mold=state%new%u)
    is_drifting = drifts(course, step, progress, state)
    if (is_drifting) course%snap_part = course%snap_part * HELD_MORE
    is_hopeless = is_drifting .or. (course%is_refused .and. course%patience <= LATE)
    course%is_refused = .false.
    if (is_hopeless) then
      course%n_astray = max(course%n_astray, course%patience) + 1
    else
      call find_newton_way(course, system, model, step, state, way, trouble, error)
      if (allocated(error) .or. trouble /= TROUBLE_NONE) return
      course%n_astray = merge(course%n_astray + 1, 0, is_astray(course, system, step))
    end if
    if (course%n_astray > course%patience) call find_snap_way(course, system, model, step, state, way, trouble, error)
  end subroutine choose_way


  !> Newton's direction, with contact settled at its end; where nothing holds a body there, one that carries it.
  subroutine find_newton_way(course, system, model, step, state, way, trouble, error)
    type(course_type), intent(inout) :: course
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< evaluated at u, and stands there after
    type(way_type), intent(inout) :: way
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    logical :: is_off
    call find_direction(system, model, step, state, way%du, trouble, error)
    if (allocated(error)) return
    is_off = is_carried_off(system, model, way%du, trouble)
    if (trouble == TROUBLE_NONE .and. .not. is_off) then
      call settle_contact(system, model, step, state, way%du, way%ahead, error)
      if (allocated(error)) return
      is_off = is_carried_off(system, model, way%du, trouble)   ! where it slips nothing may hold it
    end if
    course%now = merge(COURSE_CARRY, COURSE_NEWTON, is_off)
    if (is_off) call find_carried_direction(system, model, step, state, course%carried_part, way%du, way%ahead, trouble, error)
  end subroutine find_newton_way


  !> A direction towards the next balance. Where contact does not settle along it, there is no other one in this attempt.
  subroutine find_snap_way(course, system, model, step, state, way, trouble, error)
    type(course_type), intent(inout) :: course
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< evaluated at u, and stands there after
    type(way_type), intent(inout) :: way
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    call find_snap_direction(system, model, step, state, course%snap_part, way%du, way%ahead, trouble, error)
    course%patience = merge(AT_ONCE, NEVER, system%is_settled)
    course%now = COURSE_SNAP
    course%n_snapped = course%n_snapped + 1
  end subroutine find_snap_way


  !> Whether a body drifts: it is in balance, but the corrections do not end.
  pure logical function drifts(course, step, progress, state)
    type(course_type), intent(in) :: course
    type(step_type), intent(in) :: step
    type(progress_type), intent(in) :: progress
    type(state_type), intent(in) :: state
    integer :: oldest
    oldest = merge(0, 2, course%n_snapped > 0)
    drifts = step%line_search == SEARCH_AUTO .and. size(state%new%slaves) > 0 .and. course%patience <= LATE .and. &
      progress%iteration > 3 .and. all(progress%residual(0:oldest) <= step%controls%r_n)
  end function drifts


  !> Whether the direction leads to no balance: contact did not settle along it.
  pure logical function is_astray(course, system, step)
    type(course_type), intent(in) :: course
    type(system_type), intent(in) :: system
    type(step_type), intent(in) :: step
    is_astray = step%line_search == SEARCH_AUTO .and. system%is_condensed .and. .not. system%is_settled .and. &
      course%now == COURSE_NEWTON .and. size(system%contact%view) > 0
  end function is_astray

end module amontons_globalization
