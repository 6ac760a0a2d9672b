!> How far bodies move: before the steps by their loads and supports, after an increment by its displacements.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_body_motion
  use amontons_kinds, only: DP
  use amontons_mesh, only: mesh_extent
  use amontons_loads, only: prescribed_type, amplitude_type
  use amontons_model, only: model_type
  implicit none
  private
  public :: estimate_motion, are_rotations_prescribed, displacement_span

  real(DP), parameter :: LOAD_MOTION_SHARE = 0.05_DP       !< way of bodies under forces, over the extent of the mesh [-]

contains

  !> How far bodies can move in the steps: zero without NLGEOM, where contact follows the positions at the start; else the sum of
  !! the largest prescribed displacements (of the three axes together), rotations by half the extent of the mesh, and
  !! a share of the extent where forces act.
  pure real(DP) function estimate_motion(model) result(motion)
    type(model_type), intent(in) :: model
    integer :: i
    motion = max(0.0_DP, model%general_contact%reach)
    if (model%general_contact%reach >= 0.0_DP) return
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        if (.not. step%is_nlgeom) cycle
        motion = motion + largest_motion(model, step%prescribed)
        if (size(step%concentrated) + size(step%distributed) > 0) motion = max(motion, LOAD_MOTION_SHARE * mesh_extent(model%mesh))
      end associate
    end do
  end function estimate_motion


  !> Whether a step with NLGEOM prescribes rotations, so that faces turn.
  pure logical function are_rotations_prescribed(model)
    type(model_type), intent(in) :: model
    integer :: i
    are_rotations_prescribed = .false.
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        if (step%is_nlgeom) are_rotations_prescribed = are_rotations_prescribed .or. any(model%mesh%is_auxiliary( &
          step%prescribed%node) .and. .not. step%prescribed%is_held .and. abs(step%prescribed%end) > 0.0_DP)
      end associate
    end do
  end function are_rotations_prescribed


  !> A bound of the displacement of nodes relative to each other [length].
  pure real(DP) function displacement_span(model, u) result(span)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    integer :: i
    span = norm2([(maxval(u(i, :), mask=model%mesh%has_elements) - minval(u(i, :), mask=model%mesh%has_elements), i=1, 3)])
  end function displacement_span


  !> The largest prescribed displacement of a step, of the axes together, and rotation; a velocity counts as the extent of the mesh
  !! [length].
  pure real(DP) function largest_motion(model, prescribed) result(largest)
    type(model_type), intent(in) :: model
    type(prescribed_type), intent(in) :: prescribed(:)
    real(DP) :: motion, extent, along(3), rotation
    integer :: i
    extent = mesh_extent(model%mesh)
    along = 0.0_DP
    rotation = 0.0_DP
    do i = 1, size(prescribed)
      associate (load => prescribed(i))
        if (load%is_held) cycle
        motion = max(abs(load%end), abs(load%start))
        if (load%amplitude > 0) motion = largest_factor(model%amplitudes(load%amplitude)) * abs(load%end)
        if (load%is_velocity .or. load%is_user) motion = extent
        if (model%mesh%is_auxiliary(load%node)) then
          rotation = max(rotation, 0.5_DP * motion * extent)
        else
          along(load%dof) = max(along(load%dof), motion)
        end if
      end associate
    end do
    largest = norm2(along) + rotation
  end function largest_motion


  !> The largest factor of an amplitude; of a formula the sum of its constants bounds it.
  pure real(DP) function largest_factor(amplitude) result(largest)
    type(amplitude_type), intent(in) :: amplitude
    if (allocated(amplitude%formula_constants)) then
      largest = sum(abs(amplitude%formula_constants))
    else
      largest = maxval(abs(amplitude%factor))
    end if
  end function largest_factor

end module amontons_body_motion
