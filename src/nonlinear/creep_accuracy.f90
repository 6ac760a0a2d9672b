!> Accuracy of creep: the difference of the creep strains of an increment by the conditions at its end and at its start.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! CETOL limits this difference, as in Abaqus and CalculiX (*VISCO): with backward Euler twice the error of the increment.
module amontons_creep_accuracy
  use amontons_kinds, only: DP
  use amontons_tensor, only: von_mises
  use amontons_failure, only: failure_type, FAILURE_CREEP
  use amontons_mesh, only: element_nodes, wall_ratios
  use amontons_element_kinds, only: MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  use amontons_materials, only: material_type, CREEP_NONE, CREEP_USER, HISTORY_CEEQ, user_field_place, ELASTIC_ISOTROPIC
  use amontons_model, only: model_type, material_in_step, DIALECT_CALCULIX
  use amontons_steps, only: step_type
  use amontons_plasticity, only: creep_strain_difference
  use amontons_element, only: set_temperature_weights
  use amontons_state, only: state_type
  use amontons_user_routines, only: creep_type
  use amontons_user_state, only: load_creep_points
  implicit none
  private
  public :: check_creep, is_limited_by_cetol

contains

  !> Compares a converged attempt with CETOL. Before: the points of all ranks are known. With DIRECT nothing fails; the ratio is
  !! reported. Cost: linear in the points of materials that creep.
  subroutine check_creep(model, step, state, ratio, failure)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(in) :: state          !< new: the attempt
    real(DP), intent(out) :: ratio                 !< largest difference of creep strains over CETOL; 0: none [-]
    type(failure_type), intent(inout) :: failure   !< FAILURE_CREEP where the increment is too long
    real(DP) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS), ratio_e
    integer :: e, m, n, worst, nodes(MAX_ELEMENT_NODES)
    ratio = 0
    worst = 1
    if (.not. (step%has_creep .and. step%creep_tolerance > 0)) return
    do e = 1, model%mesh%n_elements
      m = material_in_step(model, state%new%step, e)
      if (m == 0) cycle
      if (.not. is_limited_by_cetol(model%dialect, model%materials(m))) cycle
      call element_nodes(model%mesh, e, n, nodes)
      call set_temperature_weights(model%mesh%kind(e), weight, wall_ratios(model%mesh, e))
      ratio_e = element_difference(model, model%materials(m), state, e, nodes(:n), weight(:n, :)) / step%creep_tolerance
      if (ratio_e > ratio) worst = e
      ratio = max(ratio, ratio_e)
    end do
    if (ratio > 1 .and. .not. step%is_direct) failure = failure_type(FAILURE_CREEP, [model%mesh%element_label(worst)], number=ratio)
  end subroutine check_creep


  !> Whether CETOL acts on a material: on creep, in CalculiX with isotropic elasticity only.
  elemental logical function is_limited_by_cetol(dialect, material) result(is_limited)
    integer, intent(in) :: dialect                 !< DIALECT_...
    type(material_type), intent(in) :: material
    is_limited = material%creep_law /= CREEP_NONE .and. (dialect /= DIALECT_CALCULIX .or. &
      material%elastic_kind == ELASTIC_ISOTROPIC)
  end function is_limited_by_cetol


  !> The largest difference at the points of an element [-].
  pure real(DP) function element_difference(model, material, state, e, nodes, weight) result(difference)
    type(model_type), intent(in) :: model
    type(material_type), intent(in) :: material
    type(state_type), intent(in) :: state
    integer, intent(in) :: e, nodes(:)
    real(DP), intent(in) :: weight(:, :)           !< (nodes, points) of the nodal temperatures [-]
    real(DP) :: argument(2)                        ! of the table, at the start and at the end
    type(creep_type), allocatable :: user(:)
    integer :: p, i, k
    difference = 0
    if (material%creep_law == CREEP_USER) then
      call load_creep_points(model, state, e, model%steps(max(1, state%new%step))%is_nlgeom, user)
    else
      allocate (user(model%mesh%point_first(e + 1) - model%mesh%point_first(e)))
    end if
    k = material%table_variable * model%mesh%n_nodes
    associate (old => state%old, new => state%new)
      do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
        i = p - model%mesh%point_first(e) + 1
        argument = [dot_product(weight(:, i), old%temperature(k + nodes)), dot_product(weight(:, i), new%temperature(k + nodes))]
        if (material%is_user_field) argument = [old%history(user_field_place(material, material%table_variable), p), &
          new%history(user_field_place(material, material%table_variable), p)]
        difference = max(difference, creep_strain_difference(material, argument, [new%total_time, new%creep_time &
          - old%creep_time], [old%history(HISTORY_CEEQ, p), new%history(HISTORY_CEEQ, p)], &
          [von_mises(old%stress(:, p)), von_mises(new%stress(:, p))], user(i)))
      end do
    end associate
  end function element_difference

end module amontons_creep_accuracy
