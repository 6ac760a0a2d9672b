!> Path following of RIKS steps: the arc-length constraint, the choice of its root, and the end of the path.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md (the section of amontons_arc_length). With the change Du of the displacements and DL of the load
!! factor since the last increment, every direction ends on the sphere
!!
!!     |Du|^2/U^2 + DL^2 = 2 s^2,
!!
!! where U is the displacement by the whole reference load at the start of the step, all nodes, and s the arc of the increment over
!! that of the step: of the two parts the load and the displacements have one each in a linear problem, so that DL = s there.
!! M. A. Crisfield, A fast incremental/iterative solution procedure that handles snap-through, Comput. Struct. 13 (1981) 55-62.
module amontons_arc_length
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, dof_direction
  use amontons_state, only: state_type, fields_type
  use amontons_steps, only: step_type, path_end_type
  implicit none
  private
  public :: begin_path, close_arc, is_path_done, path_fraction

contains

  !> At the start of a step: the load factor is 0, and the path has no length yet.
  pure subroutine begin_path(committed)
    type(fields_type), intent(inout) :: committed
    committed%load_factor = 0.0_DP
    committed%load_rate = 0.0_DP
    committed%arc_scale = 0.0_DP
  end subroutine begin_path


  !> Completes a direction at the trial displacements: du = du_residual + d_load du_load ends on the sphere. Of the two roots it
  !! takes the one that continues in the direction of the increment so far, or of the last increment where this one has not moved
  !! yet, or of growing loads at the start of the step. Where the direction misses the sphere it goes to the nearest point.
  pure subroutine close_arc(state, arc, lever, du_load, du, d_load)
    type(state_type), intent(inout) :: state       !< in: trial and committed; out: arc_scale of the trial fields, if not known
    real(DP), intent(in) :: arc                    !< s, over the total arc of the step [-]
    real(DP), intent(in) :: lever(:)               !< (n_nodes) factor from an angle to a length; (0): no angles [length]
    real(DP), intent(in) :: du_load(:, :)          !< (3, n_nodes) direction by the unit load [length]
    real(DP), intent(inout) :: du(:, :)            !< (3, n_nodes) in: direction by the residual; out: completed [length]
    real(DP), intent(out) :: d_load                !< change of the load factor along it [-]
    real(DP), allocatable :: moved(:, :), ahead(:, :)
    real(DP) :: weight, load_moved, load_ahead, a, b, c, root, slope
    d_load = 0.0_DP
    associate (old => state%old, new => state%new)
      if (new%arc_scale <= 0.0_DP) new%arc_scale = sqrt(product_of(lever, du_load, du_load))
      if (.not. new%arc_scale > 0.0_DP) return     ! the loads move nothing
      weight = 1.0_DP / new%arc_scale**2
      moved = new%u - old%u
      load_moved = new%load_factor - old%load_factor
      ahead = moved
      load_ahead = load_moved
      if (all(abs(moved) <= 0.0_DP) .and. abs(load_moved) <= 0.0_DP) then
        ahead = old%v
        load_ahead = old%load_rate
        if (abs(old%load_factor) <= 0.0_DP .and. abs(old%load_rate) <= 0.0_DP) then   ! the step begins
          ahead = 0.0_DP
          load_ahead = 1.0_DP
        end if
      end if
    end associate
    moved = moved + du
    a = weight * product_of(lever, du_load, du_load) + 1.0_DP
    b = weight * product_of(lever, moved, du_load) + load_moved
    c = weight * product_of(lever, moved, moved) + load_moved**2 - 2.0_DP * arc**2
    slope = weight * product_of(lever, ahead, du_load) + load_ahead
    root = sqrt(max(0.0_DP, b**2 - a * c))
    if (slope < 0.0_DP) root = -root
    d_load = (root - b) / a
    if (b * root > 0.0_DP) d_load = -c / (root + b)   ! the same without cancellation
    du = du + d_load * du_load
  end subroutine close_arc


  !> Sum over all nodes of the products of two displacements; angles as lengths.
  pure real(DP) function product_of(lever, a, b) result(total)
    real(DP), intent(in) :: lever(:)               !< (n_nodes) or (0) [length]
    real(DP), intent(in) :: a(:, :), b(:, :)       !< (3, n_nodes) [length]
    if (size(lever) > 0) then
      total = sum(sum(a * b, dim=1) * lever**2)
    else
      total = sum(a * b)
    end if
  end function product_of


  !> Whether a converged increment ends the path: its load factor reaches the largest one, the monitored displacement crosses its
  !! value, or no further increment is allowed.
  pure logical function is_path_done(model, step, increment, state)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    integer, intent(in) :: increment               !< number of the converged one
    type(state_type), intent(in) :: state          !< trial: its end; committed: its start
    real(DP) :: before, after
    associate (limit => step%path_end)
      is_path_done = state%new%load_factor >= limit%load_factor .or. increment >= step%max_increments
      if (is_path_done .or. .not. allocated(limit%nodes)) return
      before = monitored_displacement(model, limit, state%old%u) - limit%displacement
      after = monitored_displacement(model, limit, state%new%u) - limit%displacement
      is_path_done = (before < 0.0_DP .and. after >= 0.0_DP) .or. (before > 0.0_DP .and. after <= 0.0_DP)
    end associate
  end function is_path_done


  !> The displacement that may end the path, the mean of its nodes [length].
  pure real(DP) function monitored_displacement(model, limit, u) result(displacement)
    type(model_type), intent(in) :: model
    type(path_end_type), intent(in) :: limit
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    integer :: i
    displacement = 0.0_DP
    do i = 1, size(limit%nodes)
      displacement = displacement + dot_product(dof_direction(model, limit%nodes(i), limit%dof), u(:, limit%nodes(i)))
    end do
    displacement = displacement / real(size(limit%nodes), DP)
  end function monitored_displacement


  !> How much of the path is done, by its nearest end, 0 to 1 [-].
  pure real(DP) function path_fraction(model, step, increment, fields) result(fraction)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    integer, intent(in) :: increment               !< the present one
    type(fields_type), intent(in) :: fields
    associate (limit => step%path_end)
      fraction = real(increment - 1, DP) / real(step%max_increments, DP)
      if (limit%load_factor < huge(1.0_DP)) fraction = max(fraction, fields%load_factor / limit%load_factor)
      if (allocated(limit%nodes)) then
        if (abs(limit%displacement) > 0.0_DP) fraction = max(fraction, monitored_displacement(model, limit, fields%u) &
          / limit%displacement)
      end if
    end associate
    fraction = max(0.0_DP, min(1.0_DP, fraction))
  end function path_fraction

end module amontons_arc_length
