!> Inertia of DYNAMIC, APPLICATION=QUASI-STATIC: consistent mass, forces and stiffness of backward Euler, energies.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md (the section of amontons_inertia). Backward Euler takes velocity and acceleration from the
!! displacements at the ends of increments,
!!
!!     v = (u - u_old)/dt,        a = (v - v_old)/dt,        F = -M a,        -dF/du = M/dt^2.
!!
!! M is the same for the three components of a node: one number for each pair of nodes in the graph of the stiffness.
module amontons_inertia
  use amontons_kinds, only: DP
  use amontons_assembly_plan, only: assembly_type, add_row_block
  use amontons_external_loads, only: integrate_unit_mass, evaluate_density
  use amontons_mesh, only: element_nodes, wall_ratios
  use amontons_model, only: model_type, is_out
  use amontons_state, only: state_type, fields_type
  use amontons_steps, only: step_type
  use amontons_tensor, only: IDENTITY
  use amontons_element_kinds, only: MAX_ELEMENT_NODES
  implicit none
  private
  public :: begin_motion, assemble_mass, add_inertia_force, add_inertia_stiffness, conclude_inertia, implicit_loss

contains

  !> At the start of a step with inertia after one without, or at the start of the job, bodies are at rest: the velocity of a
  !! quasi-static step is no momentum.
  pure subroutine begin_motion(steps, number, committed)
    type(step_type), intent(in) :: steps(:)
    integer, intent(in) :: number                  !< of the step that begins
    type(fields_type), intent(inout) :: committed
    if (.not. steps(number)%is_dynamic) return
    if (number > 1) then
      if (steps(number - 1)%is_dynamic) return
    end if
    committed%v = 0.0_DP
  end subroutine begin_motion


  !> The consistent mass matrix in the reference configuration. Mass is conserved: a density that depends on temperature is that of
  !! the initial one.
  pure subroutine assemble_mass(assembly, model, step_number, mass)
    type(assembly_type), intent(in) :: assembly    !< with the pattern of K
    type(model_type), intent(in) :: model
    integer, intent(in) :: step_number             !< its elements are present
    real(DP), allocatable, intent(out) :: mass(:)  !< of the pairs of nodes in assembly%graph_node [mass]
    type(fields_type) :: initial
    real(DP) :: unit_mass(MAX_ELEMENT_NODES, MAX_ELEMENT_NODES), density
    integer :: e, n, a, b, k, i, nodes(MAX_ELEMENT_NODES)
    allocate (mass(size(assembly%graph_node)), initial%temperature(model%mesh%n_nodes), source=0.0_DP)
    initial%step = step_number
    if (allocated(model%initial_temperature)) initial%temperature = model%initial_temperature
    do e = 1, model%mesh%n_elements
      if (is_out(model, step_number, e)) cycle
      call element_nodes(model%mesh, e, n, nodes)
      call integrate_unit_mass(model%mesh%kind(e), model%mesh%coordinates(:, nodes(:n)), model%mesh%section_value(e), &
        unit_mass, wall_ratios(model%mesh, e))
      if (all(unit_mass(:n, :n) <= 0.0_DP)) cycle  ! springs
      density = evaluate_density(model, e, initial)
      k = assembly%pair_first(e)
      do b = 1, n
        do a = 1, b
          i = assembly%graph_first(min(nodes(a), nodes(b))) + assembly%pair_offset(k)
          mass(i) = mass(i) + merge(2.0_DP, 1.0_DP, a /= b .and. nodes(a) == nodes(b)) * density * unit_mass(a, b)
          k = k + 1
        end do
      end do
    end do
  end subroutine assemble_mass


  !> M x, component by component.
  pure function apply_mass(assembly, mass, x) result(product)
    type(assembly_type), intent(in) :: assembly
    real(DP), intent(in) :: mass(:)                !< of the pairs of nodes [mass]
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes)
    real(DP) :: product(3, size(x, 2))
    integer :: i, j, k
    product = 0.0_DP
    do i = 1, size(x, 2)
      k = assembly%graph_first(i)                  ! the node itself
      product(:, i) = product(:, i) + mass(k) * x(:, i)
      do k = assembly%graph_first(i) + 1, assembly%graph_first(i + 1) - 1
        j = assembly%graph_node(k)
        product(:, i) = product(:, i) + mass(k) * x(:, j)
        product(:, j) = product(:, j) + mass(k) * x(:, i)
      end do
    end do
  end function apply_mass


  !> Length of the increment [time].
  pure real(DP) function increment_length(state) result(dt)
    type(state_type), intent(in) :: state
    dt = state%new%total_time - state%old%total_time
  end function increment_length


  !> The acceleration of the trial displacements.
  pure function acceleration(state) result(a)
    type(state_type), intent(in) :: state
    real(DP) :: a(3, size(state%new%u, 2))         ! [length/time^2]
    a = ((state%new%u - state%old%u) / increment_length(state) - state%old%v) / increment_length(state)
  end function acceleration


  !> Adds the inertia forces -M a of the trial displacements to the applied forces. The mass is assembled at the first call.
  pure subroutine add_inertia_force(assembly, model, mass, state)
    type(assembly_type), intent(in) :: assembly
    type(model_type), intent(in) :: model
    real(DP), allocatable, intent(inout) :: mass(:)   !< of the pairs of nodes; not allocated at the start of a step [mass]
    type(state_type), intent(inout) :: state
    if (.not. allocated(mass)) call assemble_mass(assembly, model, state%new%step, mass)
    state%new%applied_force = state%new%applied_force - apply_mass(assembly, mass, acceleration(state))
  end subroutine add_inertia_force


  !> Adds M/dt^2 to K.
  pure subroutine add_inertia_stiffness(mass, state, assembly)
    real(DP), intent(in) :: mass(:)                !< of the pairs of nodes [mass]
    type(state_type), intent(in) :: state
    type(assembly_type), intent(inout) :: assembly
    real(DP) :: factor
    integer :: i, k
    factor = 1.0_DP / increment_length(state)**2
    do i = 1, size(state%new%u, 2)
      do k = assembly%graph_first(i), assembly%graph_first(i + 1) - 1
        call add_row_block(assembly%stiffness, i, k - assembly%graph_first(i), factor * mass(k) * IDENTITY)
      end do
    end do
  end subroutine add_inertia_stiffness


  !> After a converged increment: the applied forces are the loads alone, the kinetic energy is v'Mv/2, and the work of the inertia
  !! forces beyond it, dv'M dv/2, is lost.
  pure subroutine conclude_inertia(assembly, mass, state)
    type(assembly_type), intent(in) :: assembly
    real(DP), intent(in) :: mass(:)                !< of the pairs of nodes [mass]
    type(state_type), intent(inout) :: state
    real(DP), allocatable :: force(:, :), velocity(:, :)
    associate (old => state%old, new => state%new)
      force = apply_mass(assembly, mass, acceleration(state))
      velocity = (new%u - old%u) / increment_length(state)
      new%applied_force = new%applied_force + force
      new%kinetic_energy = 0.5_DP * sum(velocity * apply_mass(assembly, mass, velocity))
      new%integration_loss = old%integration_loss + 0.5_DP * sum((velocity - old%v) * force) * increment_length(state)
    end associate
  end subroutine conclude_inertia


  !> What backward Euler dissipates in an increment beside inertia: the work of internal and contact forces at its end beyond what
  !! elements, laws of contact, friction and plastic strains take [energy].
  pure real(DP) function implicit_loss(old, new) result(loss)
    type(fields_type), intent(in) :: old, new      !< at the start and at the end
    loss = sum((new%u - old%u) * (new%internal_force - new%contact_force)) &
      - (new%strain_energy - old%strain_energy) - sum(new%slaves%energy - old%slaves%energy) &
      - (new%friction_work - old%friction_work) - (new%plastic_work - old%plastic_work)
  end function implicit_loss

end module amontons_inertia
