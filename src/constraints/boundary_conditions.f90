!> Base constraints of a step: prescribed displacements, equations, nonlinear MPCs, mid-side constraints, unconnected unknowns.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_boundary_conditions
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_steps, only: step_type
  use amontons_element_kinds, only: element_kind_type, element_kind, FAMILY_MASS, FAMILY_SPRING, FAMILY_USER
  use amontons_mesh, only: mesh_type, mesh_extent
  use amontons_model, only: model_type, dof_direction, load_now, displacement_now
  use amontons_state, only: fields_type, load_time
  use amontons_user_state, only: evaluate_disp
  use amontons_constraints, only: constraints_type, constraint_row_type, reset_constraints, prescribe_unknown, add_constraint_row, &
    eliminate_constraints, ROW_CONFLICT
  use amontons_nonlinear_mpc, only: add_nonlinear_mpcs, find_pivot_lengths, fix_unconnected_unknowns, TAG_SUPPORT
  implicit none
  private
  public :: build_base_constraints, support_powers

  real(DP), parameter :: TOL_ROW_CONFLICT = 1.0e-9_DP      !< tolerance of contradicting rows, over the displacements [-]
  real(DP), parameter :: MIN_DISPLACEMENT_SCALE = 0.1_DP  !< lower bound of the displacement scale, over the size of the model [-]

contains

  !> The base constraints for the missing part of the prescribed displacements at the time of `fields`.
  subroutine build_base_constraints(base, model, step, fields, u_start, midside_nodes, is_unconnected, violation, error)
    type(constraints_type), intent(inout) :: base
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields        !< displacements and times
    real(DP), intent(in) :: u_start(:, :)          !< (3, n_nodes) displacement at the start of the step [length]
    integer, intent(in) :: midside_nodes(:, :)          !< (3, n) mid-side slave nodes and their corners
    logical, intent(in) :: is_unconnected(:)              !< (3 n_nodes) of a node without elements
    real(DP), intent(out) :: violation             !< largest of the nonlinear MPCs, over their size [-]
    type(error_type), allocatable, intent(out) :: error
    logical :: is_point(model%mesh%n_nodes)        ! of point masses and springs alone
    violation = 0.0_DP
    is_point = find_point_nodes(model%mesh)
    call reset_constraints(base, 3 * model%mesh%n_nodes, find_pivot_lengths(model))
    call fix_unresisted_unknowns(base, model, is_point, fields%u)
    call add_prescribed_displacements(base, model, step, fields, u_start, error)
    if (allocated(error)) return
    call add_equations(base, model, step, fields%u, error)
    if (allocated(error)) return
    call add_nonlinear_mpcs(base, model, fields%u, step%is_nlgeom, violation, error)
    if (allocated(error)) return
    call add_midside_constraints(base, midside_nodes, fields%u)
    call fix_unconnected_unknowns(base, is_unconnected .or. reshape(spread(is_point, 1, 3) .and. model%mesh%is_unstiffened, &
      [3 * model%mesh%n_nodes]), fields%u, u_start)
    call eliminate_constraints(base)
  end subroutine build_base_constraints


  !> The prescribed displacements; those of a transformed node are rows in its local directions.
  subroutine add_prescribed_displacements(base, model, step, fields, u_start, error)
    type(constraints_type), intent(inout) :: base
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: u_start(:, :)
    type(error_type), allocatable, intent(out) :: error
    type(constraint_row_type) :: row
    real(DP) :: direction(3), residual, tolerance
    integer :: i, pass, row_status
    logical :: is_global
    tolerance = find_conflict_tolerance(model, fields%u)
    do pass = 1, 2                                 ! fixed unknowns come before all rows
      do i = 1, size(step%prescribed)
        associate (load => step%prescribed(i))
          direction = dof_direction(model, load%node, load%dof)
          is_global = direction(load%dof) >= 1.0_DP
          if (is_global .neqv. pass == 1) cycle
          residual = prescribed_value(model, step, i, fields, dot_product(direction, u_start(:, load%node))) &
            - dot_product(direction, fields%u(:, load%node))
          if (is_global) then
            call prescribe_unknown(base, 3 * (load%node - 1) + load%dof, residual)
            cycle
          end if
          row%unknown = 3 * (load%node - 1) + [1, 2, 3]
          row%coefficient = direction
          row%rhs = residual
          row%tag = TAG_SUPPORT
          call add_constraint_row(base, row, 3, tolerance, row_status)
          if (row_status == ROW_CONFLICT) call set_error(error, EXIT_SETUP, &
            'Boundary conditions of one node in different directions contradict each other.')
        end associate
        if (allocated(error)) return
      end do
    end do
  end subroutine add_prescribed_displacements


  !> Tolerance within which rows do not contradict each other. Cost: linear in the nodes.
  pure real(DP) function find_conflict_tolerance(model, u) result(length)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    length = TOL_ROW_CONFLICT * (MIN_DISPLACEMENT_SCALE * mesh_extent(model%mesh) + maxval(abs(u)))
  end function find_conflict_tolerance


  !> Nodes of point masses, springs and user elements alone. Directions in which none of these has stiffness may move with other
  !! nodes, which hold them by rigid bodies, couplings, ties and equations: they are fixed only if no row has them.
  pure function find_point_nodes(mesh) result(is_point)
    type(mesh_type), intent(in) :: mesh
    logical :: is_point(mesh%n_nodes)
    type(element_kind_type) :: entry
    integer :: e, kind
    logical :: is_of_points
    is_point = .false.
    if (.not. any(mesh%is_unstiffened)) return
    is_point = mesh%has_elements
    kind = 0
    do e = 1, mesh%n_elements
      if (mesh%kind(e) /= kind) then
        kind = mesh%kind(e)
        entry = element_kind(kind)
        is_of_points = any(entry%family == [FAMILY_MASS, FAMILY_SPRING, FAMILY_USER])
      end if
      if (.not. is_of_points) is_point(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) = .false.
    end do
  end function find_point_nodes


  !> Displacements without stiffness (the third of plane models) remain zero, unless a support prescribes them; those of points come
  !! after all rows.
  subroutine fix_unresisted_unknowns(base, model, is_point, u)
    type(constraints_type), intent(inout) :: base
    type(model_type), intent(in) :: model
    logical, intent(in) :: is_point(:)             !< (n_nodes)
    real(DP), intent(in) :: u(:, :)
    integer :: i, k
    if (.not. allocated(model%mesh%is_unstiffened)) return
    if (.not. any(model%mesh%is_unstiffened)) return
    do i = 1, model%mesh%n_nodes
      if (is_point(i)) cycle
      do k = 1, 3
        if (model%mesh%is_unstiffened(k, i)) call prescribe_unknown(base, 3 * (i - 1) + k, -u(k, i))
      end do
    end do
  end subroutine fix_unresisted_unknowns


  !> The current displacement of a support. One that is new in this step is linear from its value at the start of the step.
  pure real(DP) function prescribed_value(model, step, i, fields, u_start) result(value)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    integer, intent(in) :: i                       !< index into step%prescribed
    type(fields_type), intent(in) :: fields        !< times
    real(DP), intent(in) :: u_start                !< [length]
    associate (load => step%prescribed(i))
      if (load%is_held) then
        value = u_start
      else if (load%is_velocity) then
        value = u_start + displacement_now(model, step, load, load_time(step, fields), fields%total_time)
      else if (load%amplitude == 0 .and. load%is_from_current) then
        value = u_start + (load%end - u_start) * (load_time(step, fields) / step%period)
      else
        value = load_now(model, step, load, load_time(step, fields), fields%total_time)
      end if
      if (load%is_user) call evaluate_disp(model, load, fields, value)
    end associate
  end function prescribed_value


  !> What the supports of each node have to move from u on, times a velocity there [length^2/time].
  pure function support_powers(model, step, fields, u_start, u, v) result(power)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: fields        !< times
    real(DP), intent(in) :: u_start(:, :)          !< (3, n_nodes) displacement at the start of the step [length]
    real(DP), intent(in) :: u(:, :), v(:, :)       !< (3, n_nodes) [length], [length/time]
    real(DP) :: power(size(u, 2))
    real(DP) :: direction(3)
    integer :: i
    power = 0.0_DP
    do i = 1, size(step%prescribed)
      associate (load => step%prescribed(i))
        direction = dof_direction(model, load%node, load%dof)
        power(load%node) = power(load%node) + dot_product(direction, v(:, load%node)) * (prescribed_value(model, step, i, fields, &
          dot_product(direction, u_start(:, load%node))) - dot_product(direction, u(:, load%node)))
      end associate
    end do
  end function support_powers


  !> The rows of *EQUATION that hold in a step, with the violation at u as right-hand side.
  subroutine add_equations(base, model, step, u, error)
    type(constraints_type), intent(inout) :: base
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: u(:, :)
    type(error_type), allocatable, intent(out) :: error
    type(constraint_row_type) :: row
    integer :: i, k, row_status
    real(DP) :: tolerance
    character(12) :: line
    tolerance = find_conflict_tolerance(model, u)
    do i = 1, size(model%equations)
      associate (equation => model%equations(i))
        if (step%number < equation%first_step .or. step%number > equation%last_step) cycle
        row%unknown = 3 * (equation%node - 1) + equation%dof
        row%coefficient = equation%coefficient
        row%rhs = -sum([(equation%coefficient(k) * u(equation%dof(k), equation%node(k)), k=1, size(equation%node))])
        row%tag = merge(TAG_SUPPORT, 0, equation%is_balancing)
        call add_constraint_row(base, row, equation%n_eliminable, tolerance, row_status)
        if (row_status == ROW_CONFLICT) then
          write (line, '(i0)') equation%line
          call set_error(error, EXIT_SETUP, 'The *' // trim(equation%card) // ' of line ' // trim(line) // &
            ' contradicts the boundary ' // &
            'conditions of its nodes or the equations before it. Release one of them.')
          return
        end if
      end associate
    end do
  end subroutine add_equations


  !> A mid-side node of a slave face remains in the middle of its corners: u_m = (u_a + u_b)/2 (doc/theory/contact.md).
  subroutine add_midside_constraints(base, midside_nodes, u)
    type(constraints_type), intent(inout) :: base
    integer, intent(in) :: midside_nodes(:, :)          !< (3, n) the node and its two corners
    real(DP), intent(in) :: u(:, :)
    type(constraint_row_type) :: row
    integer :: i, k, row_status
    do i = 1, size(midside_nodes, 2)
      do k = 1, 3
        row%unknown = 3 * (midside_nodes(:, i) - 1) + k
        if (base%owner(row%unknown(1)) /= 0) cycle
        row%coefficient = [1.0_DP, -0.5_DP, -0.5_DP]
        row%rhs = -dot_product(row%coefficient, u(k, midside_nodes(:, i)))
        call add_constraint_row(base, row, 1, huge(1.0_DP), row_status)
      end do
    end do
  end subroutine add_midside_constraints

end module amontons_boundary_conditions
