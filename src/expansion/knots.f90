!> Knots and ties: how the nodes of the deck move with the nodes into which they expand.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A node with one director moves with the mean of it. Where rotations or moments act, the mean rotations of the fibre or of the
!! cross-section are those of a rotation node (calculix dialect, and cross-sections without nodes on their sides), or it is a knot.
!!
!! A node with several directors is a knot: all their nodes follow the node, its rotation w and a uniform stretch e,
!! u_i = u + ((1 + e) R(w) - 1) (X_i - X). The stretch leaves the Poisson strain across the thickness free; a single
!! fibre of a shell as a knot is no constraint of its outer nodes, since it has as many degrees of freedom. The drill about
!! fibres that are all parallel has no stiffness and is held, unless an EQUATION names it: each equation releases one drill,
!! which follows the other terms and so holds none of them.
module amontons_knots
  use amontons_kinds, only: DP
  use amontons_containers, only: list_groups, owners_of_entries
  use amontons_text, only: to_text
  use amontons_loads, only: equation_type
  use amontons_mesh, only: append_nodes
  use amontons_model, only: model_type, new_equation, n_nonlinear_mpcs, DIALECT_CALCULIX
  use amontons_mpc_data, only: nonlinear_mpc_type, MPC_RIGID_BODY, MPC_MEAN_ROTATION, MPC_FITTED_ROTATION
  use amontons_structural_data, only: structure_type, structural_section_type, director_type, mean_weights, find_node_directors, &
    middle_node
  use amontons_parabolic_fibres, only: add_parabolic_fibres
  use amontons_tensor, only: cross_product
  implicit none
  private
  public :: connect_nodes, describe_oblique_turns

  real(DP), parameter :: TOL_PARALLEL = 1.0e-6_DP   !< sine between fibres taken as parallel [-]
  real(DP), parameter :: TOL_HELD = 0.1_DP          !< part of an axis along a fibre that counts as holding its drill [-]
  real(DP), parameter :: TOL_OBLIQUE = 1.0e-3_DP    !< product of inertia about global axes over the largest moment of inertia [-]
  real(DP), parameter :: TOL_DRILL = 1.0e-2_DP      !< sine between a fibre and an axis, below: no rotation about this axis [-]

contains

  !> Ties and knots of all expanded nodes, into the equations and nonlinear constraints of the model.
  subroutine connect_nodes(model, turns_far)
    type(model_type), intent(inout) :: model     !< expanded
    logical, intent(in) :: turns_far             !< rotations may be finite
    type(equation_type), allocatable :: equations(:)
    type(nonlinear_mpc_type), allocatable :: mpcs(:)
    logical, allocatable :: is_drill_free(:), is_drill_named(:)
    integer, allocatable :: first_at(:), elements_at(:)
    integer :: i, last, n, n_mpcs, n_new
    call release_drills(model, is_drill_free, is_drill_named)
    call list_elements_of_nodes(model%structure, first_at, elements_at)
    associate (structure => model%structure)
      n = sum([(3 * (1 + size(structure%directors(i)%nodes)), i=1, size(structure%directors))])
      allocate (equations(n), mpcs(3 * size(structure%directors)))
      call create_rotation_nodes(model, n_new)
      n = 0
      n_mpcs = 0
      i = 1
      do while (i <= size(structure%directors))  ! those of a node lie together
        last = last_of_node(structure, i)
        if (is_knot(model, i, last)) then
          call add_knot(model, turns_far, turns_far .or. .not. is_coarse(model, structure%directors(i), &
            elements_at(first_at(structure%directors(i)%node):first_at(structure%directors(i)%node + 1) - 1)), i, last, mpcs, &
            n_mpcs)
          if (.not. turns_far .and. model%dialect /= DIALECT_CALCULIX) call add_twist(model, i, last, equations, n)
          if (is_drill_driven(model, i, last)) call add_drill_mpc(model, structure%directors(i), &
            elements_at(first_at(structure%directors(i)%node):first_at(structure%directors(i)%node + 1) - 1), mpcs, n_mpcs)
          if (.not. is_drill_free(structure%directors(i)%node)) call hold_drill(model, structure%directors(i:last), &
            is_drill_driven(model, i, last), equations, n)
        else
          call add_tie(model, structure%directors(i), equations, n)
          if (structure%is_turned(structure%directors(i)%node)) &
            call add_rotations(model, structure%directors(i), mpcs, n_mpcs)
          if (is_drill_named(structure%directors(i)%node) .and. .not. is_drill_free(structure%directors(i)%node)) &
            call hold_drill(model, structure%directors(i:i), .false., equations, n)
        end if
        i = last + 1
      end do
      call add_parabolic_fibres(structure, equations, n)
    end associate
    model%equations = equations(:n)
    model%nonlinear_mpcs = mpcs(:n_mpcs)
  end subroutine connect_nodes


  !> The last director of the node of director i.
  pure integer function last_of_node(structure, i) result(last)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: i
    last = i
    do while (last < size(structure%directors))
      if (structure%directors(last + 1)%node /= structure%directors(i)%node) exit
      last = last + 1
    end do
  end function last_of_node


  !> Whether the directors first to last of a node make a knot, which turns by finite rotations: several; under the abaqus dialect a
  !! single fibre that is turned, a cross-section with which a force turns, and one of a solid of 20 nodes that the deck turns: a
  !! moment on some of its nodes would bend it out of its plane, the more the finer the mesh.
  pure logical function is_knot(model, first, last)
    type(model_type), intent(in) :: model
    integer, intent(in) :: first, last
    associate (director => model%structure%directors(first))
      is_knot = last > first .or. model%structure%is_follower(director%node)
      if (is_knot .or. model%dialect == DIALECT_CALCULIX) return
      if (director%n_outer == 2) is_knot = model%structure%is_turned(director%node)
      if (director%n_outer == 4 .and. size(director%nodes) > 4) is_knot = is_turned_by_deck(model%structure, director%node)
    end associate
  end function is_knot


  !> Whether the deck names rotations or moments at a node; all nodes of beams in the plane are turned, to hold them there.
  pure logical function is_turned_by_deck(structure, node)
    type(structure_type), intent(in) :: structure
    integer, intent(in) :: node                  !< of the deck
    is_turned_by_deck = structure%is_turned(node)
    if (structure%is_plane(node)) is_turned_by_deck = any(structure%is_driven(:, node)) .or. structure%held_from(6, node) > 0
  end function is_turned_by_deck


  !> A rotation node, and for a knot the node of its stretch behind it; then that of the rotation of the shell around it if driven.
  subroutine create_rotation_nodes(model, n_new)
    type(model_type), intent(inout) :: model
    integer, intent(out) :: n_new                !< nodes created
    real(DP), allocatable :: x(:, :)
    integer, allocatable :: owner(:)
    integer :: i, last, n_before
    associate (structure => model%structure)
      allocate (owner(3 * size(structure%directors)), source=0)
      n_new = 0
      i = 1
      do while (i <= size(structure%directors))
        last = last_of_node(structure, i)
        if (is_knot(model, i, last)) then
          owner(n_new + 1:n_new + 3) = structure%directors(i)%node * [1, -1, -1]
          n_new = n_new + merge(3, 2, is_drill_driven(model, i, last))
        else if (structure%is_turned(structure%directors(i)%node)) then
          n_new = n_new + 1
          owner(n_new) = structure%directors(i)%node
        end if
        i = last + 1
      end do
      x = model%mesh%coordinates(:, abs(owner(:n_new)))
    end associate
    n_before = model%mesh%n_nodes
    call append_nodes(model%mesh, x)
    model%mesh%is_auxiliary(n_before + 1:) = .true.
    allocate (model%rotation_of(model%mesh%n_nodes), source=0)
    do i = 1, n_new
      if (owner(i) > 0) model%rotation_of(owner(i)) = n_before + i
    end do
  end subroutine create_rotation_nodes


  !> The displacement of the node is the mean of those of its director; that of an axisymmetric shell stays in the plane. Where it
  !! is prescribed the inner nodes of the director are held between the outer ones (held_inner_from).
  subroutine add_tie(model, director, equations, n)
    type(model_type), intent(in) :: model
    type(director_type), intent(in) :: director
    type(equation_type), intent(inout) :: equations(:)
    integer, intent(inout) :: n                  !< number of equations
    integer, parameter :: BESIDE(2, 5:8) = reshape([1, 2, 2, 3, 3, 4, 4, 1], [2, 4])   !< corners beside the side of a cross-section
    real(DP) :: weight(size(director%nodes))
    logical :: is_used(size(director%nodes))
    integer :: nodes(3), k, i, first_step
    real(DP) :: share
    associate (section => model%structure%sections(director%section))
      do k = 1, merge(2, 3, director%is_meridional)
        weight = mean_weights(director, model%dialect == DIALECT_CALCULIX, model%structure%is_constrained(k, director%node))
        is_used = abs(weight) > 0
        n = n + 1
        equations(n) = new_equation([director%node, pack(director%nodes, is_used)], spread(k, 1, 1 + count(is_used)), &
          [1.0_DP, -pack(weight, is_used)], section%card, section%line)
        first_step = held_inner_from(model, director, k)
        if (first_step == 0) cycle
        do i = director%n_outer + 1, size(director%nodes)
          if (director%is_parabolic .and. i /= middle_node(director)) cycle   ! it follows
          n = n + 1
          if (director%n_outer == 2) then
            nodes = director%nodes([i, 1, 2])
            share = director%place(i)
          else
            nodes = [director%nodes(i), director%nodes(BESIDE(:, i))]
            share = 0.5_DP
          end if
          equations(n) = new_equation(nodes, [k, k, k], [1.0_DP, share - 1, -share], section%card, section%line)
          equations(n)%first_step = first_step
        end do
      end do
    end associate
  end subroutine add_tie


  !> The first step from which the inner nodes of a director are held between the outer ones along direction k; 0: never.
  !!
  !! That in which this displacement of the node is prescribed. Under the calculix dialect a prescribed rotation of a cross-section
  !! holds them along all directions, a prescribed displacement or a moment along none, as in CalculiX (found by experiment with
  !! CalculiX 2.20).
  pure integer function held_inner_from(model, director, k) result(step)
    type(model_type), intent(in) :: model
    type(director_type), intent(in) :: director
    integer, intent(in) :: k                     !< 1, 2, 3
    integer, allocatable :: steps(:)
    if (model%dialect == DIALECT_CALCULIX .and. director%n_outer == 4) then
      steps = model%structure%held_from(4:, director%node)
    else
      steps = model%structure%held_from([k], director%node)
    end if
    steps = pack(steps, steps > 0)
    step = 0
    if (size(steps) > 0) step = minval(steps)
  end function held_inner_from


  !> The rotation of a cross-section, or in the calculix dialect of a fibre too, is that of its rotation node: one that fits the
  !! outer nodes best, which does not depend on the direction of the beam and whose forces are those of the moment; the
  !! cross-section may warp. In the calculix dialect the mean rotations about the global axes; a fibre has none along it.
  subroutine add_rotations(model, director, mpcs, n)
    type(model_type), intent(in) :: model
    type(director_type), intent(in) :: director
    type(nonlinear_mpc_type), intent(inout) :: mpcs(:)
    integer, intent(inout) :: n                  !< number of mpcs
    type(nonlinear_mpc_type) :: mpc
    integer :: k
    mpc%node = director%nodes(:director%n_outer)
    mpc%card = model%structure%sections(director%section)%card
    mpc%line = model%structure%sections(director%section)%line
    if (model%dialect /= DIALECT_CALCULIX) then
      mpc%kind = MPC_FITTED_ROTATION
      mpc%reference = director%node
      mpc%rotation = model%rotation_of(director%node)
      n = n + 1
      mpcs(n) = mpc
      return
    end if
    mpc%kind = MPC_MEAN_ROTATION
    mpc%reference = model%rotation_of(director%node)
    do k = 1, 3
      mpc%axis = 0
      mpc%axis(k) = 1
      if (director%n_outer == 2 .and. norm2(cross_product(mpc%axis, director%axes(:, 1))) < TOL_DRILL) cycle
      mpc%pilot_direction = k
      n = n + 1
      mpcs(n) = mpc
    end do
  end subroutine add_rotations


  !> The first node of the calculix dialect at which a moment or a prescribed rotation acts wrongly, as in CalculiX: mean rotations
  !! about each global axis, or local one of *TRANSFORM, by itself are those of the cross-section only if these axes are its
  !! principal ones. '': none.
  function describe_oblique_turns(model) result(text)
    type(model_type), intent(in) :: model
    character(:), allocatable :: text
    integer :: i, node
    text = ''
    if (model%dialect /= DIALECT_CALCULIX .or. .not. allocated(model%structure)) return
    do i = 1, n_nonlinear_mpcs(model)
      associate (mpc => model%nonlinear_mpcs(i))
        if (mpc%kind /= MPC_MEAN_ROTATION .or. index(mpc%card, 'SECTION') == 0) cycle
        if (.not. is_oblique(along_axes(model, mpc)) .or. .not. is_turned_by_loads(model, mpc%reference)) cycle
        node = findloc(model%rotation_of, mpc%reference, dim=1)
        text = 'Node ' // to_text(model%mesh%node_label(node)) // ': moments and rotations ' // &
          'of beams and shells act in the mean about each global axis (or local one of *TRANSFORM) by itself, as in CalculiX. ' // &
          'These are no axes of the cross-section, so that a moment also bends it about another one. --dialect=abaqus is ' // &
          'right in every direction.'
        return
      end associate
    end do
  end function describe_oblique_turns


  !> The places of the nodes of a mean rotation along the axes about which it is taken.
  pure function along_axes(model, mpc) result(points)
    type(model_type), intent(in) :: model
    type(nonlinear_mpc_type), intent(in) :: mpc
    real(DP) :: points(3, size(mpc%node))
    points = model%mesh%coordinates(:, mpc%node)
    if (mpc%is_pilot_turned) points = matmul(transpose(model%frames(:, :, model%frame_of(mpc%reference))), points)
  end function along_axes


  !> Whether the inertia of points about their centre has products about the global axes.
  pure logical function is_oblique(points)
    real(DP), intent(in) :: points(:, :)         !< (3, n) [length]
    real(DP) :: arm(3, size(points, 2)), J(3, 3)
    arm = points - spread(sum(points, 2) / real(size(points, 2), DP), 2, size(points, 2))
    J = matmul(arm, transpose(arm))
    is_oblique = max(abs(J(1, 2)), abs(J(2, 3)), abs(J(1, 3))) > TOL_OBLIQUE * (J(1, 1) + J(2, 2) + J(3, 3))
  end function is_oblique


  !> Whether moments or prescribed rotations act at a rotation node in any step.
  pure logical function is_turned_by_loads(model, node) result(is_turned)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    integer :: i
    is_turned = .false.
    do i = 1, size(model%steps)
      associate (forces => model%steps(i)%concentrated, supports => model%steps(i)%prescribed)
        is_turned = is_turned .or. any(forces%node == node .and. abs(forces%end) > 0.0_DP) .or. &
          any(supports%node == node .and. abs(supports%end) > 0.0_DP)
      end associate
    end do
  end function is_turned_by_loads


  !> Whether the elements at a fibre are longer than it is thick.
  pure logical function is_coarse(model, director, elements)
    type(model_type), intent(in) :: model
    type(director_type), intent(in) :: director
    integer, intent(in) :: elements(:)           !< at its node
    real(DP) :: edge
    integer :: i, k
    is_coarse = director%n_outer == 2
    if (.not. is_coarse) return
    edge = huge(edge)
    do i = 1, size(elements)
      associate (nodes => model%structure%nodes(model%structure%first(elements(i)):model%structure%first(elements(i) + 1) - 1))
        do k = 1, size(nodes)
          if (nodes(k) /= director%node) edge = min(edge, norm2(model%mesh%coordinates(:, nodes(k)) - &
            model%mesh%coordinates(:, director%node)))
        end do
      end associate
    end do
    is_coarse = edge > director%thickness(1)
  end function is_coarse


  !> A knot of the directors first to last.
  !!
  !! Where elements are longer than thick the interfaces of layers are free across the shell: held, they would take Poisson's strain
  !! of bending from each layer, over the length of an element. In finer meshes the shear force goes through them: they are held.
  subroutine add_knot(model, turns_far, holds_layers, first, last, mpcs, n_mpcs)
    type(model_type), intent(in) :: model
    logical, intent(in) :: turns_far             !< rotations may be finite
    logical, intent(in) :: holds_layers          !< the fibre through several layers stretches evenly
    integer, intent(in) :: first, last
    type(nonlinear_mpc_type), intent(inout) :: mpcs(:)
    integer, intent(inout) :: n_mpcs            !< number of mpcs
    integer :: i, k, a
    associate (directors => model%structure%directors(first:last), section => &
      model%structure%sections(model%structure%directors(first)%section))
      n_mpcs = n_mpcs + 1
      associate (mpc => mpcs(n_mpcs))
        mpc%kind = MPC_RIGID_BODY
        mpc%reference = directors(1)%node
        mpc%rotation = model%rotation_of(mpc%reference)
        mpc%expansion = mpc%rotation + 1
        mpc%card = section%card
        mpc%line = section%line
        mpc%node = [integer ::]
        do i = 1, size(directors)
          if (directors(i)%is_parabolic) then    ! the other nodes follow
            k = middle_node(directors(i))
            mpc%node = [mpc%node, directors(i)%nodes(:2), pack(directors(i)%nodes, [(a == k, a=1, size(directors(i)%nodes))])]
            cycle
          end if
          k = merge(size(directors(i)%nodes), directors(i)%n_outer, model%dialect == DIALECT_CALCULIX .or. &
            (holds_layers .and. ubound(directors(i)%height, 1) > 1))
          mpc%node = [mpc%node, directors(i)%nodes(:k)]
          if (k == size(directors(i)%nodes)) cycle
          n_mpcs = n_mpcs + 1
          mpcs(n_mpcs) = inner_nodes_of_knot(mpc, directors(i), turns_far)
        end do
      end associate
    end associate
  end subroutine add_knot


  !> The inner nodes of a fibre or cross-section follow the knot within the shell and along the beam, so that clamped edges and
  !! joints are as stiff in tension as the rest. Across them they are free: bending strains thickness and cross-section. Where a
  !! cross-section may turn by finite rotations, its inner nodes follow the knot in all directions, since the axes of rows do not
  !! turn; else its sides twist with the knot alone (add_twist).
  pure function inner_nodes_of_knot(knot, director, turns_far) result(mpc)
    type(nonlinear_mpc_type), intent(in) :: knot !< of the outer nodes
    type(director_type), intent(in) :: director  !< with inner nodes that the knot leaves
    logical, intent(in) :: turns_far             !< rotations may be finite
    type(nonlinear_mpc_type) :: mpc
    real(DP) :: axes(3, 3)
    integer :: m
    mpc = knot
    mpc%node = director%nodes(director%n_outer + 1:)
    if (director%n_outer == 4) then
      axes(:, 1) = cross_product(director%axes(:, 1), director%axes(:, 2))
      axes(:, 2:) = director%axes
      mpc%is_bound = [.true., turns_far, turns_far]
    else
      axes(:, 3) = director%axes(:, 1)
      axes(:, 1) = 0
      m = merge(3, minloc(abs(axes(:, 3)), dim=1), director%is_meridional)
      axes(m, 1) = 1                             ! out of the plane of an axisymmetric shell
      axes(:, 2) = cross_product(axes(:, 3), axes(:, 1))
      axes(:, 2) = axes(:, 2) / norm2(axes(:, 2))
      axes(:, 1) = cross_product(axes(:, 2), axes(:, 3))
      mpc%is_bound = [.not. director%is_meridional, .true., .false.]
    end if
    mpc%axes = spread(axes, 3, size(mpc%node))
  end function inner_nodes_of_knot


  !> Opposite sides of a cross-section of 8 nodes twist with the knot: the difference of the displacements of their middles along
  !! them is that of the knot's rotation about the beam. Without it a torque would enter at the corners alone, and the twist grow
  !! with every refinement of the mesh. The mean of both stays free, as bending moves both alike where Poisson's ratio curves the
  !! sides.
  subroutine add_twist(model, first, last, equations, n)
    type(model_type), intent(in) :: model
    integer, intent(in) :: first, last           !< directors of the knot
    type(equation_type), intent(inout) :: equations(:)
    integer, intent(inout) :: n                  !< number of equations
    integer, parameter :: SIDES(2, 2) = reshape([5, 7, 6, 8], [2, 2])   !< pairs of opposite sides: against and along direction 1, 2
    real(DP) :: along(3), tangent(3)
    integer :: i, k, two(2), rotation
    do i = first, last
      associate (director => model%structure%directors(i))
        if (director%n_outer /= 4 .or. size(director%nodes) == director%n_outer) cycle
        rotation = model%rotation_of(director%node)
        tangent = cross_product(director%axes(:, 1), director%axes(:, 2))
        do k = 1, 2
          two = director%nodes(SIDES(:, k))
          along = director%axes(:, 3 - k)
          n = n + 1
          associate (section => model%structure%sections(director%section))
            equations(n) = new_equation([spread(two(1), 1, 3), spread(two(2), 1, 3), spread(rotation, 1, 3)], [1, 2, 3, 1, 2, 3, &
              1, 2, 3], [along, -along, &
              real(3 - 2 * k, DP) * director%thickness(k) * tangent], section%card, section%line)
          end associate
          equations(n)%n_eliminable = count(equations(n)%node /= rotation)
        end do
      end associate
    end do
  end subroutine add_twist


  !> The drills that EQUATION names, and one for each equation that is not held: a drill that is free in no other equation and that
  !! no support of the first step prescribes. Equations with one drill come first, because others have a choice.
  pure subroutine release_drills(model, is_free, is_named)
    type(model_type), intent(in) :: model
    logical, allocatable, intent(out) :: is_free(:), is_named(:)   !< (n_deck_nodes)
    integer, allocatable :: n_drills(:)          !< of each equation
    logical, allocatable :: is_drill_term(:), is_released(:)   !< is_released: of each equation
    integer :: i, pass
    associate (structure => model%structure, terms => model%structure%rotation_terms)
      allocate (is_free(structure%n_deck_nodes), is_named(structure%n_deck_nodes), source=.false.)
      if (size(terms, 2) == 0) return
      allocate (n_drills(maxval(terms(1, :))), source=0)
      allocate (is_released(size(n_drills)), source=.false.)
      is_drill_term = [(is_drill(model, terms(2, i), terms(3, i)), i=1, size(terms, 2))]
      do i = 1, size(terms, 2)
        if (.not. is_drill_term(i)) cycle
        is_named(terms(2, i)) = .true.
        n_drills(terms(1, i)) = n_drills(terms(1, i)) + 1
      end do
      do pass = 1, 2
        do i = 1, size(terms, 2)
          if (.not. is_drill_term(i) .or. is_released(terms(1, i))) cycle
          if ((n_drills(terms(1, i)) == 1 .neqv. pass == 1) .or. is_free(terms(2, i))) cycle
          if (structure%held_from(3 + terms(3, i), terms(2, i)) == 1) cycle
          is_free(terms(2, i)) = .true.
          is_released(terms(1, i)) = .true.
        end do
      end do
    end associate
  end subroutine release_drills


  !> Whether the rotation of a node about an axis turns fibres that are all parallel about themselves, at least in part where the
  !! node is a knot.
  pure logical function is_drill(model, node, axis)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, axis            !< 1 to 3
    integer :: first, last
    is_drill = .false.
    call find_node_directors(model%structure, node, first, last)
    if (first > last) return
    associate (directors => model%structure%directors(first:last))
      if (.not. are_parallel(directors)) return
      is_drill = abs(directors(1)%axes(axis, 1)) > merge(TOL_HELD, sqrt(1 - TOL_DRILL**2), is_knot(model, first, last))
    end associate
  end function is_drill


  !> Whether directors are fibres of shells and all parallel; fibres of axisymmetric shells turn in their plane alone.
  pure logical function are_parallel(directors)
    type(director_type), intent(in) :: directors(:)   !< of a node
    integer :: i
    are_parallel = .not. any(directors%n_outer == 4 .or. directors%is_meridional)
    do i = 2, size(directors)
      are_parallel = are_parallel .and. norm2(cross_product(directors(1)%axes(:, 1), directors(i)%axes(:, 1))) <= TOL_PARALLEL
    end do
  end function are_parallel


  !> Whether, in the abaqus dialect, something turns a knot about its parallel fibres, and no support holds that rotation from the
  !! first step on.
  pure logical function is_drill_driven(model, first, last) result(is_driven)
    type(model_type), intent(in) :: model
    integer, intent(in) :: first, last           !< directors of the node
    logical :: has_part(3)
    is_driven = .false.
    if (model%dialect == DIALECT_CALCULIX .or. .not. is_knot(model, first, last)) return
    associate (directors => model%structure%directors(first:last))
      if (.not. are_parallel(directors)) return
      has_part = abs(directors(1)%axes(:, 1)) > TOL_HELD
      is_driven = any(has_part .and. model%structure%is_driven(:, directors(1)%node)) .and. &
        .not. any(has_part .and. model%structure%held_from(4:, directors(1)%node) == 1)
    end associate
  end function is_drill_driven


  !> The rotation of the shell around a node: that which fits the nodes of its elements best.
  subroutine add_drill_mpc(model, director, elements, mpcs, n)
    type(model_type), intent(in) :: model
    type(director_type), intent(in) :: director
    integer, intent(in) :: elements(:)           !< structural elements of its node
    type(nonlinear_mpc_type), intent(inout) :: mpcs(:)
    integer, intent(inout) :: n                  !< number of mpcs
    integer, allocatable :: nodes(:)
    integer :: e, i
    nodes = [integer ::]
    associate (structure => model%structure)
      do e = 1, size(elements)
        do i = structure%first(elements(e)), structure%first(elements(e) + 1) - 1
          if (.not. any(nodes == structure%nodes(i))) nodes = [nodes, structure%nodes(i)]
        end do
      end do
      n = n + 1
      mpcs(n)%card = structure%sections(director%section)%card
      mpcs(n)%line = structure%sections(director%section)%line
    end associate
    mpcs(n)%kind = MPC_FITTED_ROTATION
    mpcs(n)%node = nodes
    mpcs(n)%reference = director%node
    mpcs(n)%rotation = model%rotation_of(director%node) + 2
  end subroutine add_drill_mpc


  !> The structural elements of each node of the deck. Cost: linear.
  pure subroutine list_elements_of_nodes(structure, first_at, elements_at)
    type(structure_type), intent(in) :: structure
    integer, allocatable, intent(out) :: first_at(:)      !< (n_deck_nodes + 1) start of those of a node
    integer, allocatable, intent(out) :: elements_at(:)
    integer, allocatable :: element(:), members(:)
    element = owners_of_entries(structure%first)
    call list_groups(merge(structure%nodes(:size(element)), 0, structure%section(element) > 0), structure%n_deck_nodes, &
      first_at, members)
    elements_at = element(members)
  end subroutine list_elements_of_nodes


  !> Holds the rotation about fibres that are all parallel, or ties it to that of the shell around the node where something turns
  !! it, until a step prescribes a rotation that has a part along them.
  subroutine hold_drill(model, directors, is_driven, equations, n)
    type(model_type), intent(in) :: model
    type(director_type), intent(in) :: directors(:)   !< of a node
    logical, intent(in) :: is_driven             !< the node behind that of the stretch is the rotation of the shell
    type(equation_type), intent(inout) :: equations(:)
    integer, intent(inout) :: n                  !< number of equations
    integer :: k
    if (.not. are_parallel(directors)) return
    associate (normal => directors(1)%axes(:, 1), section => model%structure%sections(directors(1)%section), &
      rotation => model%rotation_of(directors(1)%node), held_from => model%structure%held_from(4:, directors(1)%node))
      n = n + 1
      if (is_driven) then
        equations(n) = new_equation([spread(rotation, 1, 3), spread(rotation + 2, 1, 3)], [1, 2, 3, 1, 2, 3], &
          [normal, -normal], section%card, section%line)
      else
        equations(n) = new_equation(spread(rotation, 1, 3), [1, 2, 3], normal, section%card, section%line)
      end if
      do k = 1, 3
        if (held_from(k) > 0 .and. abs(normal(k)) > TOL_HELD) equations(n)%last_step = min(equations(n)%last_step, &
          held_from(k) - 1)
      end do
    end associate
  end subroutine hold_drill

end module amontons_knots
