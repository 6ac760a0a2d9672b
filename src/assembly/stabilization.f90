!> Automatic stabilization by viscous forces (STATIC, STABILIZE): factor, forces, stiffness, dissipated work.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md (the section of amontons_stabilization). Each node has a share m of the volume of its elements; a
!! nodal displacement du in an increment dt causes the viscous force
!!
!!     F = -c m du/dt,
!!
!! with one factor c for the whole model. The first increment of a step is not damped: its displacements define c such that a given
!! fraction of the strain energy is dissipated if the step continues at the same rate. Where nothing else holds a body, the first
!! increment would have no solution: c then follows from the mean stiffness of the elements.
module amontons_stabilization
  use amontons_kinds, only: DP
  use amontons_elasticity, only: small_strain_modulus
  use amontons_mesh, only: mesh_type
  use amontons_model, only: model_type, material_in_step
  use amontons_sparse, only: sparse_type
  use amontons_steps, only: step_type
  use amontons_state, only: state_type, fields_type, DAMPING_NOW, DAMPING_NEXT
  implicit none
  private
  public :: is_damped, set_damping_factor, find_nodal_volumes, set_first_factor, add_damping_force, add_damping_stiffness, &
    update_damping

contains

  !> Whether a step has stabilization.
  pure logical function is_damped(step)
    type(step_type), intent(in) :: step
    is_damped = step%dissipated_fraction > 0.0_DP .or. step%damping_factor > 0.0_DP
  end function is_damped


  !> The factor of the current increment.
  pure subroutine set_damping_factor(step, is_step_start, state)
    type(step_type), intent(in) :: step
    logical, intent(in) :: is_step_start
    type(state_type), intent(inout) :: state
    associate (old => state%old%damping, new => state%new%damping)
      new = 0.0_DP
      if (.not. is_damped(step)) return
      new = old(DAMPING_NEXT)
      if (is_step_start .and. .not. step%is_damping_continued) new = step%damping_factor
    end associate
  end subroutine set_damping_factor


  !> The nodal shares of the element volumes; the nodes of an element have equal shares.
  pure subroutine find_nodal_volumes(mesh, is_absent, fields, nodal_volume)
    type(mesh_type), intent(in) :: mesh
    logical, intent(in) :: is_absent(:)            !< (n_elements) inactive
    type(fields_type), intent(in) :: fields
    real(DP), allocatable, intent(out) :: nodal_volume(:) !< (n_nodes) [length^3]
    real(DP) :: volume
    integer :: e
    allocate (nodal_volume(mesh%n_nodes), source=0.0_DP)
    do e = 1, mesh%n_elements
      if (is_absent(e)) cycle
      volume = sum(fields%volume(mesh%point_first(e):mesh%point_first(e + 1) - 1))
      associate (nodes => mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))
        nodal_volume(nodes) = nodal_volume(nodes) + volume / real(size(nodes), DP)
      end associate
    end do
  end subroutine find_nodal_volumes


  !> The factor of a first increment in which damping alone holds a body: over the period T of the step c m/T is the given fraction
  !! of the stiffness of an element, both in the mean. An element of volume V and modulus E has a stiffness of E V^(1/3).
  pure subroutine set_first_factor(model, step, state)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP) :: volume, stiffness, total
    integer :: e, m
    if (.not. step%has_free_motion .or. state%new%damping(DAMPING_NOW) > 0.0_DP) return
    stiffness = 0.0_DP
    total = 0.0_DP
    do e = 1, model%mesh%n_elements
      m = material_in_step(model, state%new%step, e)
      if (m == 0) cycle
      volume = sum(state%new%volume(model%mesh%point_first(e):model%mesh%point_first(e + 1) - 1))
      stiffness = stiffness + small_strain_modulus(model%materials(m)) * volume**(1.0_DP / 3.0_DP)
      total = total + volume
    end do
    if (total > 0.0_DP) state%new%damping = step%dissipated_fraction * step%period * stiffness / total
  end subroutine set_first_factor


  !> Adds the viscous forces of the trial displacements to the applied forces.
  pure subroutine add_damping_force(nodal_volume, state)
    real(DP), intent(in) :: nodal_volume(:)               !< (n_nodes) [length^3]
    type(state_type), intent(inout) :: state
    real(DP) :: factor
    integer :: i
    associate (old => state%old, new => state%new)
      factor = new%damping(DAMPING_NOW) / (new%total_time - old%total_time)
      do i = 1, size(nodal_volume)
        new%applied_force(:, i) = new%applied_force(:, i) - factor * nodal_volume(i) * (new%u(:, i) - old%u(:, i))
      end do
    end associate
  end subroutine add_damping_force


  !> Adds the viscous stiffness, c m/dt on the diagonal.
  pure subroutine add_damping_stiffness(nodal_volume, state, K)
    real(DP), intent(in) :: nodal_volume(:)               !< (n_nodes) [length^3]
    type(state_type), intent(in) :: state
    type(sparse_type), intent(inout) :: K          !< upper triangle by rows, the diagonal first
    real(DP) :: factor
    integer :: i
    factor = state%new%damping(DAMPING_NOW) / (state%new%total_time - state%old%total_time)
    do i = 1, K%n_rows
      K%value(K%first(i)) = K%value(K%first(i)) + factor * nodal_volume((i + 2) / 3)
    end do
  end subroutine add_damping_stiffness


  !> After a converged increment: the dissipated work, and the factor of the next increment if it is not known yet.
  !!
  !! If all nodes kept their velocity v = du/dt over the period T, c sum m v^2 T would be dissipated, and the strain energy would
  !! grow by du'dF_int/2 (T/dt)^2: c = fraction du'dF_int/2 T / sum m du^2.
  pure subroutine update_damping(nodal_volume, step, state, work)
    real(DP), allocatable, intent(in) :: nodal_volume(:)  !< (n_nodes) not allocated: no step was stabilized yet [length^3]
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(out) :: work                  !< work of the viscous forces by the trapezoidal rule, negative [energy]
    real(DP) :: moved, stored, du_dot_force
    integer :: i
    work = 0.0_DP
    if (.not. allocated(nodal_volume)) return
    associate (old => state%old, new => state%new)
      moved = 0.0_DP
      du_dot_force = 0.0_DP
      do i = 1, size(nodal_volume)
        moved = moved + nodal_volume(i) * sum((new%u(:, i) - old%u(:, i))**2)
        du_dot_force = du_dot_force + nodal_volume(i) * dot_product(new%u(:, i) - old%u(:, i), old%v(:, i))
      end do
      moved = moved / (new%total_time - old%total_time)
      new%stabilization_work = old%stabilization_work + new%damping(DAMPING_NOW) * moved
      work = -0.5_DP * (new%damping(DAMPING_NOW) * moved + old%damping(DAMPING_NOW) * du_dot_force)
      if (.not. is_damped(step) .or. new%damping(DAMPING_NEXT) > 0.0_DP .or. .not. moved > 0.0_DP) return
      stored = 0.5_DP * abs(sum((new%u - old%u) * (new%internal_force - old%internal_force)))
      new%damping(DAMPING_NEXT) = step%dissipated_fraction * stored * step%period / (moved * (new%total_time - old%total_time))
    end associate
  end subroutine update_damping

end module amontons_stabilization
