!> Whole steps: the steps that CalculiX takes in one increment, whatever increments they ask for.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Where nothing in a model is nonlinear, neither motion nor material nor contact nor constraint, CalculiX solves once, for
!! the loads at the end of the step, and prints once; a list of TIME POINTS is not met either. Under its dialect so do we.
module amontons_whole_steps
  use amontons_materials, only: material_type, ELASTIC_HYPER, ELASTIC_FOAM, CREEP_NONE
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_ties, only: BOND_PLANE, BOND_STRAIGHT, BOND_DISTANCE
  implicit none
  private
  public :: take_whole_steps

contains

  !> Makes each linear step of a linear model one increment.
  pure subroutine take_whole_steps(model)
    type(model_type), intent(inout) :: model
    integer :: i
    if (model%dialect /= DIALECT_CALCULIX .or. .not. is_linear(model)) return
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        if (step%is_nlgeom .or. step%is_creeping .or. allocated(step%is_absent)) cycle
        step%dt_initial = step%period
        step%dt_max = step%period
        if (allocated(step%print_times)) deallocate (step%print_times)
        if (allocated(step%file_times)) deallocate (step%file_times)
      end associate
    end do
  end subroutine take_whole_steps


  !> Whether contact, materials and constraints are linear at small displacements.
  pure logical function is_linear(model)
    type(model_type), intent(in) :: model
    integer :: i
    is_linear = size(model%pairs) == 0
    do i = 1, size(model%materials)
      is_linear = is_linear .and. has_linear_law(model%materials(i))
    end do
    if (.not. allocated(model%bonds)) return
    do i = 1, size(model%bonds)
      is_linear = is_linear .and. all(model%bonds(i)%kind /= [BOND_PLANE, BOND_STRAIGHT, BOND_DISTANCE])
    end do
  end function is_linear


  !> Whether the stress is linear in the strain.
  pure logical function has_linear_law(material)
    type(material_type), intent(in) :: material
    has_linear_law = .not. (allocated(material%isotropic) .or. allocated(material%kinematic) .or. material%is_user .or. &
      material%has_deformation_plasticity .or. material%creep_law /= CREEP_NONE .or. &
      material%elastic_kind == ELASTIC_HYPER .or. material%elastic_kind == ELASTIC_FOAM)
  end function has_linear_law

end module amontons_whole_steps
