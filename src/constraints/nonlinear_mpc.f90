!> Nonlinear multi-point constraints (rigid body, plane, straight, distance, rotations): rows, forces and second derivatives.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Each constraint consists of one or several functions g(u) = 0. Its row is dg/du du = -g at the current displacement, so that
!! violations are corrected. In a step without NLGEOM g is linearized at u = 0.
!!
!! | constraint | g |
!! |---|---|
!! | BODY | a (u_i - u_r - (q R(w) - 1) (X_i - X_r)), a a constrained direction; w displacement of the rotation node; q = 1, or
!! 1 + e of a knot, e the first displacement of its expansion node |
!! | PLANE | det(x - x_3, x_1 - x_3, x_2 - x_3) / d^2 |
!! | STRAIGHT | two components of (x - x_2) x (x_1 - x_2) / d |
!! | DISTANCE | (|x_1 - x_2|^2 - |X_1 - X_2|^2) / 2 d |
!! | TURN | mean rotation of the nodes about the axis through their centre - u_1 of the pilot, times the radius |
!! | FIT | L J^-1 sum p_i x R(w)' x_i, p_i = X_i - mean X, J = sum (p_i . p_i 1 - p_i p_i'), L the mean radius: |x_i - R p_i|^2
!! is least in the sum but for a shift, and the forces of the constraint are those of a moment |
!!
!! R(w) is the exponential map (Rodrigues). The multiplier of a row is the force of the constraint; the tangent of the
!! equilibrium gets sum multiplier * d2g/du2 (Belytschko, Liu, Moran, Nonlinear Finite Elements, sec. 6.3), taken from
!! central differences of dg/du: exact for PLANE, STRAIGHT and DISTANCE, whose dg/du is a polynomial of degree 2.
module amontons_nonlinear_mpc
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_tensor, only: cross_product, rotation_matrix, skew_matrix, invert
  use amontons_mesh, only: mesh_extent
  use amontons_loads, only: equation_type, equation_list_type
  use amontons_mpc_data, only: nonlinear_mpc_type, MPC_RIGID_BODY, MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE, MPC_MEAN_ROTATION, &
    MPC_FITTED_ROTATION
  use amontons_model, only: model_type, n_nonlinear_mpcs
  use amontons_constraints, only: constraints_type, constraint_row_type, add_constraint_row, prescribe_unknown, find_multipliers, &
    is_in_constraint_row, ROW_CONFLICT
  use amontons_state, only: fields_type
  use amontons_assembly_plan, only: assembly_type, add_node_block
  implicit none
  private
  public :: add_nonlinear_mpcs, add_mpc_stiffness, fix_unconnected_unknowns, extract_support_reactions, linear_equations
  public :: evaluate_mpc_rows, evaluate_mpc_hessian, list_hessian_nodes, find_rotation_lengths, find_pivot_lengths, TAG_SUPPORT

  integer, parameter :: TAG_SUPPORT = 1           !< rows of supports: of transformed nodes, and those that hold fibres
  integer, parameter :: TAG_MPC = 1000000000      !< rows of nonlinear MPCs have this tag and higher ones
  real(DP), parameter :: PIVOT_ARM_RATIO = 0.1_DP  !< rotations are eliminated by arms longer than this, over their constraint [-]
  integer, parameter :: N_RIGID_BODY_TERMS = 9             !< a row of a BODY: node, reference node, rotation node; then the stretch

contains

  !> Adds the rows of all nonlinear MPCs at u. Errors: rows that contradict rows of higher priority (EXIT_SETUP).
  !! Rows with a free unknown of their own node come first: they are short. If the node depends on others, as a slave of a tie
  !! does, these would enter the expressions of the reference node, and with it each row that follows.
  subroutine add_nonlinear_mpcs(base, model, u, is_nlgeom, violation, error)
    type(constraints_type), intent(inout) :: base
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: violation             !< largest |g| over the size of its constraint [-]
    type(error_type), allocatable, intent(out) :: error
    type(constraint_row_type), allocatable :: rows(:)
    logical, allocatable :: is_added(:)            ! of all rows
    integer :: pass, i, k, n, n_rows
    real(DP) :: mpc_size
    violation = 0.0_DP
    allocate (is_added(sum([(count_rows(model%nonlinear_mpcs(i)), i=1, n_nonlinear_mpcs(model))])), source=.false.)
    do pass = 1, 2
      n = 0
      do i = 1, n_nonlinear_mpcs(model)
        associate (mpc => model%nonlinear_mpcs(i))
          n_rows = count_rows(mpc)
          if (.not. all(is_added(n + 1:n + n_rows))) then
            call evaluate_mpc_rows(mpc, model%mesh%coordinates, u, is_nlgeom, rows)
            rows%tag = TAG_MPC + [(k, k=n + 1, n + n_rows)]
            mpc_size = find_mpc_size(mpc, model%mesh%coordinates)
            violation = max(violation, maxval(abs(rows%rhs)) / mpc_size)
            call add_mpc_rows(base, mpc, rows, mpc_size, pass == 1, is_added(n + 1:n + n_rows), error)
            if (allocated(error)) return
          end if
          n = n + n_rows
        end associate
      end do
    end do
  end subroutine add_nonlinear_mpcs


  !> Adds the rows of one constraint that may be added now.
  subroutine add_mpc_rows(base, mpc, rows, mpc_size, is_free_needed, is_added, error)
    type(constraints_type), intent(inout) :: base
    type(nonlinear_mpc_type), intent(in) :: mpc
    type(constraint_row_type), intent(in) :: rows(:)
    real(DP), intent(in) :: mpc_size               !< [length]
    logical, intent(in) :: is_free_needed          !< only rows that have a free unknown of their own node
    logical, intent(inout) :: is_added(:)          !< of the rows
    type(error_type), allocatable, intent(out) :: error
    character(12) :: line
    integer :: k, n_candidates, row_status
    do k = 1, size(rows)
      if (is_added(k)) cycle
      n_candidates = merge(3, size(rows(k)%unknown), mpc%kind <= MPC_STRAIGHT)
      if (is_free_needed .and. all(base%owner(rows(k)%unknown(:n_candidates)) /= 0)) cycle
      is_added(k) = .true.
      call add_constraint_row(base, rows(k), n_candidates, 1.0e-6_DP * mpc_size, row_status)
      if (row_status /= ROW_CONFLICT) cycle
      write (line, '(i0)') mpc%line
      call set_error(error, EXIT_SETUP, 'The *' // mpc%card // ' of line ' // trim(line) // ' contradicts the ' // &
        'boundary conditions of its nodes or the constraints before it. Release one of them.')
      return
    end do
  end subroutine add_mpc_rows


  !> Converts rotations to displacements and moments to forces: half the size of the model at nodes with rotations, 1 at all others.
  !! Without rotations it is empty.
  function find_rotation_lengths(model) result(rotation_length)
    type(model_type), intent(in) :: model
    real(DP), allocatable :: rotation_length(:)              !< (n_nodes) or (0) [length] or [-]
    logical, allocatable :: is_angle(:)
    integer :: i
    allocate (is_angle(model%mesh%n_nodes), source=.false.)
    do i = 1, n_nonlinear_mpcs(model)
      if (model%nonlinear_mpcs(i)%kind == MPC_MEAN_ROTATION) is_angle(model%nonlinear_mpcs(i)%reference) = .true.
    end do
    if (allocated(model%rotation_of)) then
      do i = 1, size(model%rotation_of)
        if (model%rotation_of(i) > 0) is_angle(model%rotation_of(i)) = .true.
      end do
    end if
    do i = 1, n_nonlinear_mpcs(model)
      if (model%nonlinear_mpcs(i)%expansion > 0) is_angle(model%nonlinear_mpcs(i)%expansion) = .true.
      if (model%nonlinear_mpcs(i)%rotation > 0) is_angle(model%nonlinear_mpcs(i)%rotation) = .true.
    end do
    allocate (rotation_length(0))
    if (any(is_angle)) rotation_length = merge(0.5_DP * mesh_extent(model%mesh), 1.0_DP, is_angle)
  end function find_rotation_lengths


  !> The lengths over which coefficients of rotations are compared with those of displacements when a row's pivot is chosen: a
  !! tenth of the smallest constraint with that rotation, so that rotations are eliminated first in any unit (rolling up a strip
  !! of S4 takes 81 iterations so and 104 otherwise); 1 for displacements. Without rotations it is empty.
  function find_pivot_lengths(model) result(length)
    type(model_type), intent(in) :: model
    real(DP), allocatable :: length(:)             !< (n_nodes) or (0) [length] or [-]
    real(DP) :: mpc_size
    integer :: i, k, angle(3)
    length = find_rotation_lengths(model)
    if (size(length) == 0) return
    do i = 1, n_nonlinear_mpcs(model)
      associate (mpc => model%nonlinear_mpcs(i))
        mpc_size = PIVOT_ARM_RATIO * find_mpc_size(mpc, model%mesh%coordinates)
        angle = [mpc%rotation, mpc%expansion, merge(mpc%reference, 0, mpc%kind == MPC_MEAN_ROTATION)]
        do k = 1, size(angle)
          if (angle(k) > 0) length(angle(k)) = min(length(angle(k)), mpc_size)
        end do
      end associate
    end do
  end function find_pivot_lengths


  !> Fixes displacements of nodes without elements that no row contains.
  subroutine fix_unconnected_unknowns(base, is_unconnected, u, u_start)
    type(constraints_type), intent(inout) :: base
    logical, intent(in) :: is_unconnected(:)              !< (3 n_nodes) of a node without elements
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: u_start(:, :)          !< (3, n_nodes) displacement at the start of the step [length]
    logical, allocatable :: is_unreferenced(:)
    integer :: i
    if (.not. any(is_unconnected)) return
    is_unreferenced = is_unconnected .and. .not. is_in_constraint_row(base)
    do i = 1, size(is_unreferenced)
      if (is_unreferenced(i) .and. base%owner(i) == 0) call prescribe_unknown(base, i, &
        u_start(mod(i - 1, 3) + 1, (i + 2) / 3) - u(mod(i - 1, 3) + 1, (i + 2) / 3))
    end do
  end subroutine fix_unconnected_unknowns


  !> Subtracts the forces of equations and nonlinear MPCs from the residual forces: the rest are support reactions.
  subroutine extract_support_reactions(base, reaction)
    type(constraints_type), intent(in) :: base
    real(DP), intent(inout) :: reaction(:, :)      !< (3, n_nodes) [force]
    real(DP), allocatable :: multiplier(:)
    integer :: k, i, unknown
    if (base%n_rows == 0) return
    call find_multipliers(base, -reaction, multiplier)
    do k = 1, base%n_rows
      if (base%rows(k)%tag == TAG_SUPPORT) cycle
      do i = 1, size(base%rows(k)%original_unknown)
        unknown = base%rows(k)%original_unknown(i)
        associate (force => reaction(mod(unknown - 1, 3) + 1, (unknown + 2) / 3))
          force = force - multiplier(k) * base%rows(k)%original_coefficient(i)
        end associate
      end do
    end do
  end subroutine extract_support_reactions


  !> K = K - sum multiplier * d2g/du2: the constraint forces change as their directions rotate.
  subroutine add_mpc_stiffness(base, assembly, model, fields)
    type(constraints_type), intent(in) :: base     !< finished
    type(assembly_type), intent(inout) :: assembly
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), allocatable :: multiplier(:), of_mpcs(:), H(:, :)
    integer, allocatable :: nodes(:)
    integer :: i, k, n, n_rows, a, b
    call find_multipliers(base, fields%applied_force + fields%contact_force - fields%internal_force, multiplier)
    allocate (of_mpcs(sum([(count_rows(model%nonlinear_mpcs(i)), i=1, n_nonlinear_mpcs(model))])), source=0.0_DP)
    do k = 1, base%n_rows
      if (base%rows(k)%tag > TAG_MPC) of_mpcs(base%rows(k)%tag - TAG_MPC) = multiplier(k)
    end do
    n = 0
    do i = 1, n_nonlinear_mpcs(model)
      n_rows = count_rows(model%nonlinear_mpcs(i))
      call evaluate_mpc_hessian(model%nonlinear_mpcs(i), model%mesh%coordinates, fields%u, of_mpcs(n + 1:n + n_rows), H)
      n = n + n_rows
      nodes = list_hessian_nodes(model%nonlinear_mpcs(i))
      do b = 1, size(nodes)
        do a = 1, size(nodes)
          if (nodes(a) > nodes(b)) cycle
          call add_node_block(assembly, nodes(a), nodes(b), -H(3 * a - 2:3 * a, 3 * b - 2:3 * b))
        end do
      end do
    end do
  end subroutine add_mpc_stiffness


  !> The equations of a model, then its nonlinear MPCs linearized at u = 0.
  subroutine linear_equations(model, equations)
    type(model_type), intent(in) :: model
    type(equation_type), allocatable, intent(out) :: equations(:)
    type(equation_list_type) :: list
    type(equation_type) :: equation
    type(constraint_row_type), allocatable :: rows(:)
    real(DP), allocatable :: u(:, :)
    integer :: i, k
    equations = model%equations
    if (n_nonlinear_mpcs(model) == 0) return
    allocate (u(3, model%mesh%n_nodes), source=0.0_DP)
    do i = 1, n_nonlinear_mpcs(model)
      call evaluate_mpc_rows(model%nonlinear_mpcs(i), model%mesh%coordinates, u, .false., rows)
      do k = 1, size(rows)
        equation%node = (rows(k)%unknown + 2) / 3
        equation%dof = mod(rows(k)%unknown - 1, 3) + 1
        equation%coefficient = rows(k)%coefficient
        equation%n_eliminable = merge(3, size(rows(k)%unknown), model%nonlinear_mpcs(i)%kind <= MPC_STRAIGHT)
        equation%card = model%nonlinear_mpcs(i)%card
        equation%line = model%nonlinear_mpcs(i)%line
        call list%add(equation)
      end do
    end do
    call list%move_to(equations)
  end subroutine linear_equations


  !> The number of rows of a constraint.
  pure integer function count_rows(mpc) result(n)
    type(nonlinear_mpc_type), intent(in) :: mpc
    n = 1
    if (mpc%kind == MPC_STRAIGHT) n = 2
    if (mpc%kind == MPC_FITTED_ROTATION) n = 3
    if (mpc%kind == MPC_RIGID_BODY) n = size(mpc%node) * count(mpc%is_bound)
  end function count_rows


  !> The rows of one constraint: dg/du, and -g as right-hand side.
  subroutine evaluate_mpc_rows(mpc, coordinates, u, is_nlgeom, rows)
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: coordinates(:, :)      !< (3, n_nodes) X [length]
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    logical, intent(in) :: is_nlgeom               !< .false.: linearized at u = 0
    type(constraint_row_type), allocatable, intent(out) :: rows(:)
    if (mpc%kind == MPC_RIGID_BODY) then
      call evaluate_rigid_body_rows(mpc, coordinates, u, is_nlgeom, rows)
    else if (mpc%kind == MPC_FITTED_ROTATION) then
      call evaluate_fitted_rows(mpc, coordinates, u, is_nlgeom, rows)
    else
      call evaluate_geometric_rows(mpc, coordinates, u, is_nlgeom, rows)
    end if
  end subroutine evaluate_mpc_rows


  !> The rows of a BODY, direction by direction of each node.
  subroutine evaluate_rigid_body_rows(mpc, coordinates, u, is_nlgeom, rows)
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: coordinates(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    type(constraint_row_type), allocatable, intent(out) :: rows(:)
    real(DP) :: R(3, 3), dR(3, 3, 3), w(3), arm(3), a(3), residual(3), turn(3, 3), e
    integer :: i, k, n
    w = u(:, mpc%rotation)
    e = 0.0_DP
    if (mpc%expansion > 0) e = u(1, mpc%expansion)
    call rotation_matrix(merge(w, [0.0_DP, 0.0_DP, 0.0_DP], is_nlgeom), R, dR)
    allocate (rows(count_rows(mpc)))
    n = 0
    do i = 1, size(mpc%node)
      arm = coordinates(:, mpc%node(i)) - coordinates(:, mpc%reference)
      turn = reshape([(matmul(dR(:, :, k), arm), k=1, 3)], [3, 3])
      residual = u(:, mpc%node(i)) - u(:, mpc%reference) - matmul(turn, w) - e * arm
      if (is_nlgeom) then
        turn = (1.0_DP + e) * turn
        residual = u(:, mpc%node(i)) - u(:, mpc%reference) - (1.0_DP + e) * matmul(R, arm) + arm
      end if
      do k = 1, 3
        if (.not. mpc%is_bound(k)) cycle
        n = n + 1
        a = 0.0_DP
        a(k) = 1.0_DP
        if (allocated(mpc%axes)) a = mpc%axes(:, k, i)
        allocate (rows(n)%unknown(N_RIGID_BODY_TERMS), rows(n)%coefficient(N_RIGID_BODY_TERMS))
        rows(n)%unknown = [unknowns_of(mpc%node(i)), unknowns_of(mpc%reference), unknowns_of(mpc%rotation)]
        rows(n)%coefficient = [a, -a, -matmul(a, turn)]
        if (mpc%expansion > 0) then
          rows(n)%unknown = [rows(n)%unknown, 3 * mpc%expansion - 2]
          rows(n)%coefficient = [rows(n)%coefficient, -dot_product(a, matmul(R, arm))]
        end if
        rows(n)%rhs = -dot_product(a, residual)
        call drop_zeros(rows(n))
      end do
    end do
  end subroutine evaluate_rigid_body_rows


  !> The rows of the other kinds, which depend on the current positions of their nodes (and the pilot).
  subroutine evaluate_geometric_rows(mpc, coordinates, u, is_nlgeom, rows)
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: coordinates(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    type(constraint_row_type), allocatable, intent(out) :: rows(:)
    real(DP), allocatable :: X(:, :), shift(:, :), dg(:, :)
    real(DP) :: g, pilot(3)
    integer :: k, i
    X = coordinates(:, mpc%node)
    shift = u(:, mpc%node)
    allocate (dg(3, size(mpc%node)))
    allocate (rows(count_rows(mpc)))
    do k = 1, size(rows)
      call evaluate_constraint(mpc, k, X, merge(X + shift, X, is_nlgeom), g, dg)
      if (.not. is_nlgeom) g = g + sum(dg * shift)
      rows(k)%unknown = [(unknowns_of(mpc%node(i)), i=1, size(mpc%node))]
      rows(k)%coefficient = reshape(dg, [size(dg)])
      if (mpc%kind == MPC_MEAN_ROTATION) then
        pilot = 0
        pilot(mpc%pilot_direction) = 1
        if (mpc%is_pilot_turned) pilot = mpc%axis
        pilot = find_mean_radius(mpc%axis, X) * pilot
        g = g - dot_product(pilot, u(:, mpc%reference))
        do i = 1, 3
          if (.not. abs(pilot(i)) > 0) cycle
          rows(k)%unknown = [rows(k)%unknown, 3 * mpc%reference - 3 + i]
          rows(k)%coefficient = [rows(k)%coefficient, -pilot(i)]
        end do
      end if
      rows(k)%rhs = -g
    end do
  end subroutine evaluate_geometric_rows


  !> The three rows of a FIT.
  subroutine evaluate_fitted_rows(mpc, coordinates, u, is_nlgeom, rows)
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: coordinates(:, :), u(:, :)
    logical, intent(in) :: is_nlgeom
    type(constraint_row_type), allocatable, intent(out) :: rows(:)
    real(DP), allocatable :: shift(:, :), dg(:, :, :)
    real(DP) :: g(3)
    integer, allocatable :: nodes(:)
    integer :: k, i
    nodes = list_hessian_nodes(mpc)
    shift = u(:, nodes)
    call evaluate_fit(coordinates(:, mpc%node), merge(shift, 0.0_DP, is_nlgeom), g, dg)
    allocate (rows(3))
    do k = 1, 3
      rows(k)%unknown = [(unknowns_of(nodes(i)), i=1, size(nodes))]
      rows(k)%coefficient = reshape(dg(:, :, k), [size(shift)])
      rows(k)%rhs = -g(k)
      if (.not. is_nlgeom) rows(k)%rhs = -sum(dg(:, :, k) * shift)
    end do
  end subroutine evaluate_fitted_rows


  !> g of a FIT and its derivative with respect to the displacements of the nodes and the rotation vector.
  subroutine evaluate_fit(X, u, g, dg)
    real(DP), intent(in) :: X(:, :)                !< (3, n) reference [length]
    real(DP), intent(in) :: u(:, :)                !< (3, n + 1) displacements [length], then the rotation vector
    real(DP), intent(out) :: g(3)                  !< [length]
    real(DP), allocatable, intent(out) :: dg(:, :, :)   !< (3, n + 1, 3): of g(k) in (:, :, k) [-], [length]
    real(DP) :: R(3, 3), dR(3, 3, 3), arm(3, size(X, 2)), away(3, size(X, 2)), J(3, 3), weight(3, 3), &
      slope(3, 3), moment(3), radius, det
    integer :: i, k, n
    n = size(X, 2)
    arm = X - spread(sum(X, 2) / real(n, DP), 2, n)
    away = arm + u(:, :n) - spread(sum(u(:, :n), 2) / real(n, DP), 2, n)
    call rotation_matrix(u(:, n + 1), R, dR)
    J = -matmul(arm, transpose(arm))
    do k = 1, 3
      J(k, k) = J(k, k) + sum(arm**2)
    end do
    radius = sqrt(sum(arm**2) / real(n, DP))
    call invert(J, weight, det)
    weight = radius * weight
    allocate (dg(3, n + 1, 3))
    moment = 0.0_DP
    slope = 0.0_DP
    do i = 1, n
      moment = moment + cross_product(arm(:, i), matmul(away(:, i), R))
      do k = 1, 3
        slope(:, k) = slope(:, k) + cross_product(arm(:, i), matmul(away(:, i), dR(:, :, k)))
      end do
      dg(:, i, :) = transpose(matmul(weight, matmul(skew_matrix(arm(:, i)), transpose(R))))
    end do
    g = matmul(weight, moment)
    dg(:, n + 1, :) = transpose(matmul(weight, slope))
  end subroutine evaluate_fit


  !> g (for TURN without the pilot) and its derivative with respect to the positions of the nodes.
  subroutine evaluate_constraint(mpc, k, X, position, g, dg)
    type(nonlinear_mpc_type), intent(in) :: mpc
    integer, intent(in) :: k                       !< index of the row in the constraint
    real(DP), intent(in) :: X(:, :)                !< (3, n) reference [length]
    real(DP), intent(in) :: position(:, :)            !< (3, n) current [length]
    real(DP), intent(out) :: g                     !< [length]
    real(DP), intent(out) :: dg(:, :)              !< (3, n) [-]
    real(DP) :: a(3), b(3), c(3), t(3), d
    select case (mpc%kind)
    case (MPC_PLANE)
      d = norm2(cross_product(X(:, 2) - X(:, 4), X(:, 3) - X(:, 4)))
      a = position(:, 1) - position(:, 4)
      b = position(:, 2) - position(:, 4)
      c = position(:, 3) - position(:, 4)
      g = dot_product(a, cross_product(b, c)) / d
      dg(:, 1) = cross_product(b, c) / d
      dg(:, 2) = cross_product(c, a) / d
      dg(:, 3) = cross_product(a, b) / d
      dg(:, 4) = -dg(:, 1) - dg(:, 2) - dg(:, 3)
    case (MPC_STRAIGHT)
      d = norm2(X(:, 2) - X(:, 3))
      a = position(:, 1) - position(:, 3)
      b = position(:, 2) - position(:, 3)
      t = global_axis(b, k)
      g = dot_product(t, cross_product(a, b)) / d
      dg(:, 1) = cross_product(b, t) / d
      dg(:, 2) = cross_product(t, a) / d
      dg(:, 3) = -dg(:, 1) - dg(:, 2)
    case (MPC_DISTANCE)
      d = norm2(X(:, 1) - X(:, 2))
      a = position(:, 1) - position(:, 2)
      g = (dot_product(a, a) - d**2) / (2.0_DP * d)
      dg(:, 1) = a / d
      dg(:, 2) = -a / d
    case default
      call evaluate_mean_rotation(mpc%axis, X, position, g, dg)
    end select
  end subroutine evaluate_constraint


  !> The global axis k (counted without the one nearest to b): the rows of STRAIGHT are components of a x b.
  pure function global_axis(b, k) result(t)
    real(DP), intent(in) :: b(3)
    integer, intent(in) :: k                       !< 1 or 2
    real(DP) :: t(3)
    t = 0.0_DP
    t(mod(maxloc(abs(b), dim=1) + k - 1, 3) + 1) = 1.0_DP
  end function global_axis


  !> The mean rotation of the nodes about an axis through their centre, times the mean radius.
  !!
  !! The rotation of a node is the angle between its arms in the plane normal to the axis; nodes on the axis do not count.
  subroutine evaluate_mean_rotation(axis, X, position, g, dg)
    real(DP), intent(in) :: axis(3)
    real(DP), intent(in) :: X(:, :), position(:, :)   !< (3, n) [length]
    real(DP), intent(out) :: g                     !< [length]
    real(DP), intent(out) :: dg(:, :)              !< (3, n) [-]
    real(DP) :: p(3), q(3), slope(3), mean(3), radius
    real(DP) :: n
    integer :: i, n_counted
    n = real(size(X, 2), DP)
    radius = find_mean_radius(axis, X)
    g = 0.0_DP
    dg = 0.0_DP
    mean = 0.0_DP
    n_counted = 0
    do i = 1, size(X, 2)
      p = X(:, i) - sum(X, 2) / n
      q = position(:, i) - sum(position, 2) / n
      p = p - dot_product(p, axis) * axis
      q = q - dot_product(q, axis) * axis
      if (norm2(p) <= 1.0e-5_DP * radius) cycle
      n_counted = n_counted + 1
      g = g + atan2(dot_product(axis, cross_product(p, q)), dot_product(p, q))
      slope = cross_product(axis, q) / dot_product(q, q)
      dg(:, i) = dg(:, i) + slope
      mean = mean + slope / n
    end do
    g = g * radius / real(max(1, n_counted), DP)
    dg = (dg - spread(mean, 2, size(X, 2))) * radius / real(max(1, n_counted), DP)
  end subroutine evaluate_mean_rotation


  !> The root of the mean square distance of the nodes from the axis through their centre.
  pure function find_mean_radius(axis, X) result(radius)
    real(DP), intent(in) :: axis(3), X(:, :)
    real(DP) :: radius, p(3), n
    integer :: i
    n = real(size(X, 2), DP)
    radius = 0.0_DP
    do i = 1, size(X, 2)
      p = X(:, i) - sum(X, 2) / n
      radius = radius + sum((p - dot_product(p, axis) * axis)**2) / n
    end do
    radius = sqrt(radius)
  end function find_mean_radius


  !> The nodes whose displacements the second derivatives of a constraint couple.
  pure function list_hessian_nodes(mpc) result(nodes)
    type(nonlinear_mpc_type), intent(in) :: mpc
    integer, allocatable :: nodes(:)
    if (mpc%kind == MPC_RIGID_BODY) then
      nodes = [mpc%rotation]
      if (mpc%expansion > 0) nodes = [nodes, mpc%expansion]
    else
      nodes = mpc%node
      if (mpc%kind == MPC_FITTED_ROTATION) nodes = [nodes, mpc%rotation]
    end if
  end function list_hessian_nodes


  !> sum multiplier * d2g/du2 of one constraint, at u, between its nonlinear nodes.
  subroutine evaluate_mpc_hessian(mpc, coordinates, u, multiplier, H)
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: coordinates(:, :), u(:, :)   !< (3, n_nodes) [length]
    real(DP), intent(in) :: multiplier(:)          !< of the rows of the constraint, in their order [force]
    real(DP), allocatable, intent(out) :: H(:, :)  !< (3 n, 3 n) symmetric [force/length]
    real(DP), allocatable :: plus(:), minus(:), moved(:, :)
    integer, allocatable :: nodes(:)
    real(DP) :: h_step
    integer :: j
    nodes = list_hessian_nodes(mpc)
    allocate (H(3 * size(nodes), 3 * size(nodes)))
    moved = u(:, nodes)
    do j = 1, 3 * size(nodes)
      h_step = 1.0e-5_DP                             ! of rotations and stretches
      if (any(nodes((j + 2) / 3) == mpc%node)) h_step = 1.0e-4_DP * find_mpc_size(mpc, coordinates)
      associate (unknown => moved(mod(j - 1, 3) + 1, (j + 2) / 3))
        unknown = unknown + h_step
        plus = sum_weighted_gradients(mpc, coordinates, moved, multiplier)
        unknown = unknown - 2.0_DP * h_step
        minus = sum_weighted_gradients(mpc, coordinates, moved, multiplier)
        unknown = unknown + h_step
      end associate
      H(:, j) = (plus - minus) / (2.0_DP * h_step)
    end do
    H = 0.5_DP * (H + transpose(H))
  end subroutine evaluate_mpc_hessian


  !> sum multiplier * dg/du with respect to the displacements of the nonlinear nodes.
  function sum_weighted_gradients(mpc, coordinates, u_curved, multiplier) result(slope)
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: coordinates(:, :)
    real(DP), intent(in) :: u_curved(:, :)         !< (3, n curved)
    real(DP), intent(in) :: multiplier(:)
    real(DP) :: slope(3 * size(u_curved, 2))
    real(DP) :: R(3, 3), dR(3, 3, 3), torque(3, 3), g, of_fit(3)
    real(DP), allocatable :: dg(:, :), dg_fit(:, :, :)
    integer :: k
    slope = 0.0_DP
    if (mpc%kind == MPC_FITTED_ROTATION) then
      call evaluate_fit(coordinates(:, mpc%node), u_curved, of_fit, dg_fit)
      do k = 1, 3
        slope = slope + multiplier(k) * reshape(dg_fit(:, :, k), [size(u_curved)])
      end do
      return
    end if
    if (mpc%kind == MPC_RIGID_BODY) then
      torque = sum_force_moments(mpc, coordinates, multiplier)
      call rotation_matrix(u_curved(:, 1), R, dR)
      slope(:3) = [(-sum(dR(:, :, k) * torque), k=1, 3)]
      if (mpc%expansion == 0) return
      slope(:3) = (1.0_DP + u_curved(1, 2)) * slope(:3)
      slope(4) = -sum(R * torque)
      return
    end if
    allocate (dg(3, size(mpc%node)))
    do k = 1, size(multiplier)
      call evaluate_constraint(mpc, k, coordinates(:, mpc%node), coordinates(:, mpc%node) + u_curved, g, dg)
      slope = slope + multiplier(k) * reshape(dg, [size(dg)])
    end do
  end function sum_weighted_gradients


  !> sum f_i (X_i - X_r)' of a BODY, with the constraint forces f_i on its nodes.
  pure function sum_force_moments(mpc, coordinates, multiplier) result(torque)
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: coordinates(:, :), multiplier(:)
    real(DP) :: torque(3, 3)
    real(DP) :: a(3), arm(3)
    integer :: i, j, k, n
    torque = 0.0_DP
    n = 0
    do i = 1, size(mpc%node)
      arm = coordinates(:, mpc%node(i)) - coordinates(:, mpc%reference)
      do k = 1, 3
        if (.not. mpc%is_bound(k)) cycle
        n = n + 1
        a = 0.0_DP
        a(k) = 1.0_DP
        if (allocated(mpc%axes)) a = mpc%axes(:, k, i)
        do j = 1, 3
          torque(:, j) = torque(:, j) + multiplier(n) * a * arm(j)
        end do
      end do
    end do
  end function sum_force_moments


  !> The three unknowns of a node.
  pure function unknowns_of(node) result(unknowns)
    integer, intent(in) :: node
    integer :: unknowns(3)
    unknowns = 3 * (node - 1) + [1, 2, 3]
  end function unknowns_of


  !> The size of a constraint: the largest distance of a node from the first one, or from the reference node.
  pure real(DP) function find_mpc_size(mpc, coordinates)
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP), intent(in) :: coordinates(:, :)
    integer :: i, from
    from = mpc%node(1)
    if (mpc%kind == MPC_RIGID_BODY) from = mpc%reference
    find_mpc_size = maxval([(norm2(coordinates(:, mpc%node(i)) - coordinates(:, from)), i=1, size(mpc%node))])
    if (.not. find_mpc_size > 0.0_DP) find_mpc_size = 1.0_DP
  end function find_mpc_size


  !> Removes the terms without a coefficient; the three of the constrained node stay in front.
  pure subroutine drop_zeros(row)
    type(constraint_row_type), intent(inout) :: row
    logical :: is_kept(size(row%unknown))
    is_kept = abs(row%coefficient) > 0.0_DP
    is_kept(:3) = .true.
    row%unknown = pack(row%unknown, is_kept)
    row%coefficient = pack(row%coefficient, is_kept)
  end subroutine drop_zeros

end module amontons_nonlinear_mpc
