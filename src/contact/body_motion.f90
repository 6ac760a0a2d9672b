!> How far bodies move: before the steps by their loads and supports, after an increment by its displacements.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A body of rubber or foam, or with REACH any body, *folds* if its way in the steps is as long as the half circle around its
!! thickness, 2 V/A. Its faces can turn to any direction: each can meet the others and all faces of other bodies.
module amontons_body_motion
  use amontons_kinds, only: DP, PI
  use amontons_containers, only: list_groups
  use amontons_mesh, only: mesh_extent
  use amontons_materials, only: is_hyperelastic
  use amontons_loads, only: prescribed_type, amplitude_type
  use amontons_model, only: model_type
  use amontons_exterior_surface, only: exterior_type
  implicit none
  private
  public :: estimate_motion, are_rotations_prescribed, displacement_span, find_folding_bodies, body_thickness, FOLD_RATIO

  real(DP), parameter :: LOAD_MOTION_SHARE = 0.05_DP       !< way of bodies under forces, over the extent of the mesh [-]
  real(DP), parameter :: FOLD_RATIO = 0.5_DP * PI          !< way of a body that folds, over its thickness [-]

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


  !> Whether each body folds; none does without general contact.
  pure function find_folding_bodies(model, exterior, is_rigid, motion) result(folds)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    logical, intent(in) :: is_rigid(:)             !< faces of rigid bodies
    real(DP), intent(in) :: motion                 !< way of the bodies (estimate_motion) [length]
    logical :: folds(exterior%n_bodies)
    integer, allocatable :: first(:), members(:), own(:)
    integer :: b
    folds = .false.
    if (.not. allocated(model%general_contact)) return
    call list_groups(exterior%body, exterior%n_bodies, first, members)
    do b = 1, exterior%n_bodies
      own = members(first(b):first(b + 1) - 1)
      own = pack(own, .not. is_rigid(own))
      folds(b) = motion > 0.0_DP .and. size(own) > 0
      if (folds(b)) folds(b) = model%general_contact%reach > 0.0_DP .or. all(is_rubber(model, exterior%element(own)))
      if (folds(b)) folds(b) = motion >= FOLD_RATIO * body_thickness(exterior, own)
    end do
  end function find_folding_bodies


  !> Whether the material of an element is rubber or foam.
  elemental logical function is_rubber(model, e)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    is_rubber = .false.
    if (model%mesh%material(e) > 0) is_rubber = is_hyperelastic(model%materials(model%mesh%material(e)))
  end function is_rubber


  !> The mean thickness of a body, 2 V/A: of a sheet its thickness, of a cube a third of its edge. Method: divergence theorem.
  pure real(DP) function body_thickness(exterior, own) result(thickness)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: own(:)                  !< faces of the body
    real(DP) :: middle(3), n_dimensions
    integer :: i
    middle = sum(exterior%centre(:, own), dim=2) / real(size(own), DP)
    n_dimensions = merge(2.0_DP, 3.0_DP, all(exterior%n_corners(own) == 2))
    thickness = 0.0_DP
    do i = 1, size(own)
      thickness = thickness + exterior%area(own(i)) * dot_product(exterior%centre(:, own(i)) - middle, exterior%normal(:, own(i)))
    end do
    thickness = abs(2 * thickness / n_dimensions / sum(exterior%area(own)))
  end function body_thickness


  !> A bound of the displacement of nodes relative to each other [length].
  pure real(DP) function displacement_span(model, u) result(span)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    integer :: i
    span = norm2([(maxval(u(i, :), mask=model%mesh%has_elements) - minval(u(i, :), mask=model%mesh%has_elements), i=1, 3)])
  end function displacement_span


  !> The way by which prescribed displacements of a step, of the axes together, and rotations can bring nodes together: along an
  !! axis the difference of the largest and the least, of which supports are zero; a velocity counts as the extent of the mesh
  !! [length].
  pure real(DP) function largest_motion(model, prescribed) result(largest)
    type(model_type), intent(in) :: model
    type(prescribed_type), intent(in) :: prescribed(:)
    real(DP) :: values(2), extent, along(3, 2), rotation
    integer :: i
    extent = mesh_extent(model%mesh)
    along = 0.0_DP
    rotation = 0.0_DP
    do i = 1, size(prescribed)
      associate (load => prescribed(i))
        if (load%is_held) cycle
        values = [load%start, load%end]
        if (load%amplitude > 0) values = factor_range(model%amplitudes(load%amplitude)) * load%end
        if (load%is_velocity .or. load%is_user) values = extent
        if (model%mesh%is_auxiliary(load%node)) then
          rotation = max(rotation, 0.5_DP * maxval(abs(values)) * extent)
        else
          along(load%dof, 1) = min(along(load%dof, 1), minval(values))
          along(load%dof, 2) = max(along(load%dof, 2), maxval(values))
        end if
      end associate
    end do
    largest = norm2(along(:, 2) - along(:, 1)) + rotation
  end function largest_motion


  !> The least and the largest factor of an amplitude; of a formula the sum of its constants bounds both.
  pure function factor_range(amplitude) result(range)
    type(amplitude_type), intent(in) :: amplitude
    real(DP) :: range(2)
    if (allocated(amplitude%formula_constants)) then
      range = [-1.0_DP, 1.0_DP] * sum(abs(amplitude%formula_constants))
    else
      range = [minval(amplitude%factor), maxval(amplitude%factor)]
    end if
  end function factor_range

end module amontons_body_motion
