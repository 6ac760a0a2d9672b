!> Free bodies under balanced loads: supports at single degrees of freedom that hold the rigid motion and carry no force.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Bodies that can move, alone or as equations couple them, have an equilibrium if the loads do no work on the free motions; their
!! displacement is then determined but for such a motion. Each node with unknowns moves with its own body: the nodes of elements,
!! reference nodes of rigid bodies, nodes of shells and beams, and the rotation nodes of all these. As many degrees of freedom as
!! there are free motions are held, chosen so that they hold them best (largest rows first, with orthogonalization). Their reactions
!! balance the work of the loads on the motions, which is zero: stresses and strains do not depend on the choice. A beam that may
!! turn about its axis is held by the mean rotation of one cross-section, which its deflection does not enter; a shell by mean
!! displacements of its fibres. Bodies with contact are left alone: contact forces are not known beforehand.
module amontons_balanced_bodies
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  use amontons_text, only: to_text, plural
  use amontons_assembly_plan, only: assembly_type
  use amontons_external_loads, only: assemble_external_loads
  use amontons_loads, only: equation_type
  use amontons_model, only: model_type
  use amontons_structural_data, only: find_node_directors
  use amontons_mpc_data, only: MPC_RIGID_BODY
  use amontons_nonlinear_mpc, only: linear_equations
  use amontons_state, only: state_type, fields_type, slave_state_type, create_state
  use amontons_model_check_bodies, only: bodies_type, find_bodies, body_name, join_item, step_list, line_of_nodes
  use amontons_model_check_motion, only: cluster_type, find_free_clusters, rigid_motion
  implicit none
  private
  public :: balancing_support_type, find_balancing_supports, support_equation, find_loaded_support

  real(DP), parameter :: TOL_BALANCED = 1.0e-6_DP      !< work of all loads over the sum of the works of each nodal force [-]
  real(DP), parameter :: MAX_SUPPORT_FORCE = 0.01_DP   !< of all balancing supports over the sum of the loads [-]
  real(DP), parameter :: MAX_SINE = 1.0e-3_DP          !< between a beam and the axis of a rotation about the beam [-]
  real(DP), parameter :: MIN_TURN = 1.0e-9_DP          !< a smaller coefficient of a rotation is rounding [-]
  character(1), parameter :: AXES(3) = ['x', 'y', 'z']
  integer, parameter :: N_TIMES = 4                    !< times of a step at which the loads are compared

  !> A degree of freedom that is held in a step.
  type :: balancing_support_type
    integer :: step = 0
    integer :: node = 0
    integer :: dof = 0
    integer :: director = 0                      !< dof is held in the mean over this fibre or cross-section; 0: at the node
    real(DP) :: axis(3) = 0                      !< the mean rotation about it is held in place of dof: a unit vector; 0: dof
  end type balancing_support_type

contains

  !> Finds the supports of all steps. After: text names the bodies and nodes, '' if there are none. Nonlinear constraints restrain
  !! motions by their linearization: the rotation of a beam about its axis is held at its nodes by them alone.
  !!
  !! A body without loads and moved supports gets none: a support was more often forgotten. Nor does one between moved supports that
  !! an earlier step held. But a straight beam on hinges always turns about its axis.
  subroutine find_balancing_supports(model, supports, text)
    type(model_type), intent(in) :: model
    type(balancing_support_type), allocatable, intent(out) :: supports(:)
    character(:), allocatable, intent(out) :: text
    type(equation_type), allocatable :: equations(:)
    type(bodies_type) :: bodies
    type(cluster_type), allocatable :: free(:)
    type(balancing_support_type), allocatable :: added(:)
    logical, allocatable :: is_usable(:)
    integer, allocatable :: place(:)               ! (n_nodes) of the body of a node in its cluster; 0: another
    logical :: has_loads
    character(:), allocatable :: sentence
    integer :: i, k
    allocate (supports(0))
    text = ''
    call linear_equations(model, equations)
    do i = 1, size(model%steps)
      if (model%steps(i)%is_dynamic) cycle         ! inertia holds all bodies
      call find_bodies(model, equations, i, bodies)
      call find_free_clusters(model, bodies, i, free)
      do k = 1, size(free)
        place = places_in_cluster(bodies, free(k))
        if (has_contact(model, place)) cycle
        if (.not. are_loads_balanced(model, bodies, free(k), place, i, has_loads)) cycle
        has_loads = has_loads .or. is_hinge(model, bodies, free(k))
        if (i == 1 .or. any(place(supports%node) > 0)) has_loads = has_loads .or. is_moved(model, place, i)
        call hold_spin(model, place, free(k), i, added)
        if (size(added) == 0) then
          if (.not. has_loads) cycle
          is_usable = find_usable_nodes(model, bodies%equations, place, i, is_hinge(model, bodies, free(k)))
          call choose_supports(model, bodies, free(k), place, is_usable, i, added)
        end if
        associate (n => size(free(k)%motions, 2))
          if (size(added) < n) cycle
          sentence = 'The loads on the ' // body_name(model, bodies%list(free(k)%bodies(1))) // ' balance each other; ' // &
            node_list(model, added) // ' hold' // trim(merge('s', ' ', all(added%node == added(1)%node))) // ' its ' // &
            plural(n, 'free rigid motion') // ' without a force.'
        end associate
        supports = [supports, added]
        if (index(text, sentence) > 0) cycle
        if (text /= '') text = text // ' '
        text = text // sentence
      end do
    end do
  end subroutine find_balancing_supports


  !> Whether bodies are no more than reference and rotation nodes of rigid bodies whose nodes lie on a line: the rotation about it
  !! moves nothing else, and needs no loads to be held.
  pure logical function is_hinge(model, bodies, cluster)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(cluster_type), intent(in) :: cluster
    real(DP), parameter :: TOL_LINE = 1.0e-6_DP    !< distance from the line over its length [-]
    logical :: is_of_hinge(model%mesh%n_nodes)
    integer :: i
    is_hinge = .false.
    if (.not. allocated(model%nonlinear_mpcs) .or. any(bodies%list(cluster%bodies)%n_elements > 0)) return
    is_of_hinge = .false.
    do i = 1, size(model%nonlinear_mpcs)
      associate (mpc => model%nonlinear_mpcs(i))
        if (mpc%kind /= MPC_RIGID_BODY .or. mpc%expansion > 0 .or. .not. all(mpc%is_bound)) cycle
        if (norm2(line_of_nodes(model%mesh%coordinates(:, mpc%node), TOL_LINE)) > 0) is_of_hinge([mpc%reference, &
          mpc%rotation]) = .true.
      end associate
    end do
    is_hinge = all(is_of_hinge(bodies%list(cluster%bodies)%node))
  end function is_hinge


  !> 'node 7 along x, node 7 along y and node 9 along z'.
  function node_list(model, supports) result(text)
    type(model_type), intent(in) :: model
    type(balancing_support_type), intent(in) :: supports(:)
    character(:), allocatable :: text, label
    integer :: i
    text = ''
    do i = 1, size(supports)
      label = to_text(model%mesh%node_label(supports(i)%node))
      if (supports(i)%dof == 0) then
        text = 'the mean rotation of the cross-section at node ' // label
      else
        text = join_item(text, 'node ' // label // ' along ' // AXES(supports(i)%dof), i == size(supports))
      end if
    end do
  end function node_list


  !> The place in a cluster of the body of each node.
  pure function places_in_cluster(bodies, cluster) result(place)
    type(bodies_type), intent(in) :: bodies
    type(cluster_type), intent(in) :: cluster
    integer :: place(size(bodies%of_node))         !< 0: no body, or one outside the cluster
    integer :: of_body(0:bodies%n), i
    of_body = 0
    of_body(cluster%bodies) = [(i, i=1, size(cluster%bodies))]
    place = of_body(bodies%of_node)
  end function places_in_cluster


  !> Whether bodies have a node on a contact surface.
  logical function has_contact(model, place)
    type(model_type), intent(in) :: model
    integer, intent(in) :: place(:)                !< (n_nodes) 0: outside the cluster
    integer :: p
    has_contact = .false.
    do p = 1, size(model%pairs)
      has_contact = has_contact .or. any(place(model%surfaces(model%pairs(p)%slave)%nodes) > 0) .or. &
        any(place(model%surfaces(model%pairs(p)%master)%nodes) > 0)
    end do
  end function has_contact


  !> The displacement of a node in each free motion of its cluster [length], as columns.
  pure function node_motions(model, bodies, cluster, node, place) result(motions)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(cluster_type), intent(in) :: cluster
    integer, intent(in) :: node
    integer, intent(in) :: place                   !< of its body in the cluster
    real(DP) :: motions(3, size(cluster%motions, 2))
    integer :: i
    motions = matmul(rigid_motion(bodies%list(cluster%bodies(place)), model%mesh%coordinates(:, node)), &
      cluster%motions([(i, i=6 * place - 5, 6 * place)], :))
  end function node_motions


  !> Whether the loads on bodies do no work on their free motions, at several times of the step.
  logical function are_loads_balanced(model, bodies, free, place, step, has_loads) result(are_balanced)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(cluster_type), intent(in) :: free
    integer, intent(in) :: place(:)                !< (n_nodes) of the body of a node in the cluster; 0: another
    integer, intent(in) :: step
    logical, intent(out) :: has_loads              !< there are loads on them
    type(assembly_type) :: assembly
    type(state_type) :: state
    type(slave_state_type) :: no_slaves(0)
    real(DP), dimension(size(free%motions, 2)) :: work, sizes
    real(DP) :: motions(3, size(free%motions, 2)), before
    integer :: i, t
    call create_state(state, model%mesh, no_slaves)
    has_loads = any(place(model%steps(step)%temperatures%node) > 0)
    are_balanced = .true.
    before = sum(model%steps(:step - 1)%period)
    do t = 1, N_TIMES
      state%new%step_time = model%steps(step)%period * real(t, DP) / real(N_TIMES, DP)
      state%new%total_time = before + state%new%step_time
      state%new%load_factor = real(t, DP) / real(N_TIMES, DP)
      call assemble_external_loads(assembly, model, model%steps(step), state%new, .false., .false.)
      work = 0.0_DP
      sizes = 0.0_DP
      do i = 1, model%mesh%n_nodes
        if (place(i) == 0) cycle
        motions = node_motions(model, bodies, free, i, place(i))
        work = work + matmul(state%new%applied_force(:, i), motions)
        sizes = sizes + norm2(motions, dim=1) * norm2(state%new%applied_force(:, i))
        has_loads = has_loads .or. norm2(state%new%applied_force(:, i)) > 0.0_DP
      end do
      are_balanced = are_balanced .and. all(abs(work) <= TOL_BALANCED * sizes)
    end do
  end function are_loads_balanced


  !> Whether a boundary condition moves a node of bodies, now or before.
  pure logical function is_moved(model, place, step)
    type(model_type), intent(in) :: model
    integer, intent(in) :: place(:)                !< (n_nodes) 0: outside the cluster
    integer, intent(in) :: step
    integer :: i
    is_moved = .false.
    do i = 1, size(model%steps(step)%prescribed)
      associate (load => model%steps(step)%prescribed(i))
        if (place(load%node) == 0) cycle
        is_moved = is_moved .or. load%is_user .or. load%is_velocity .or. load%is_held .or. abs(load%start) > 0.0_DP .or. &
          abs(load%end) > 0.0_DP
      end associate
    end do
  end function is_moved


  !> Holds the only free motion of beams, if it is a rotation about their axis, by the mean rotation of a cross-section: that of the
  !! first node without supports, else of the first one. None: another motion, no beam.
  subroutine hold_spin(model, place, free, step, supports)
    type(model_type), intent(in) :: model
    integer, intent(in) :: place(:)                !< (n_nodes) of the body of a node in the cluster; 0: another
    type(cluster_type), intent(in) :: free
    integer, intent(in) :: step
    type(balancing_support_type), allocatable, intent(out) :: supports(:)
    real(DP) :: axis(3)
    integer :: i, chosen
    logical :: is_held
    allocate (supports(0))
    if (size(free%motions, 2) /= 1 .or. .not. allocated(model%structure)) return
    axis = free%motions(4:6, 1)
    if (.not. norm2(axis) > 0) return
    axis = axis / norm2(axis)
    associate (directors => model%structure%directors)
      chosen = 0
      do i = size(directors), 1, -1
        if (directors(i)%n_outer /= 4 .or. place(directors(i)%nodes(1)) /= 1) cycle
        is_held = any(model%steps(step)%prescribed%node == directors(i)%node)
        if (chosen == 0 .or. .not. is_held) chosen = i
      end do
      if (chosen == 0) return
      if (norm2(cross_product(axis, cross_product(directors(chosen)%axes(:, 1), directors(chosen)%axes(:, 2)))) > MAX_SINE) return
      supports = [balancing_support_type(step, directors(chosen)%node, director=chosen, axis=axis)]
    end associate
  end subroutine hold_spin


  !> The displacements of the corners of a cross-section in a unit rotation about an axis through its node.
  pure function turned_arms(model, i, axis) result(along)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i                     !< director
    real(DP), intent(in) :: axis(3)
    real(DP) :: along(3, 4)                      !< [length]
    integer :: k
    associate (director => model%structure%directors(i), x => model%mesh%coordinates)
      do k = 1, 4
        along(:, k) = cross_product(axis, x(:, director%nodes(k)) - x(:, director%node))
      end do
    end associate
  end function turned_arms


  !> The equation of a support that holds the mean rotation of a cross-section, or the mean displacement of a fibre; any of its
  !! terms may be eliminated.
  function support_equation(model, support) result(equation)
    type(model_type), intent(in) :: model
    type(balancing_support_type), intent(in) :: support
    type(equation_type) :: equation
    real(DP) :: coefficient(12)
    logical :: is_used(12)
    associate (director => model%structure%directors(support%director))
      if (support%dof == 0) then
        coefficient = reshape(turned_arms(model, support%director, support%axis), [12])
        coefficient = coefficient / norm2(coefficient)
        is_used = abs(coefficient) > MIN_TURN
        equation%node = pack(reshape(spread(director%nodes(:4), 1, 3), [12]), is_used)
        equation%dof = pack([1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3], is_used)
        equation%coefficient = pack(coefficient, is_used)
        equation%card = 'BEAM SECTION'
      else
        equation%node = director%nodes(:director%n_outer)
        equation%dof = spread(support%dof, 1, director%n_outer)
        equation%coefficient = spread(1 / real(director%n_outer, DP), 1, director%n_outer)
        equation%card = 'SHELL SECTION'
      end if
    end associate
    equation%n_eliminable = size(equation%node)
    equation%is_balancing = .true.
    equation%first_step = support%step
    equation%last_step = support%step
  end function support_equation


  !> Whether balancing supports carry a force after an increment: the loads have lost their balance since, between the times at
  !! which they were compared or, under NLGEOM, because forces of fixed direction have other arms about a body that has bent or
  !! turned. Message says at which node most; '': none.
  subroutine find_loaded_support(model, step, rotation_length, fields, message)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< of the model, from 1
    real(DP), intent(in) :: rotation_length(:)     !< of `find_rotation_lengths`: moments count by the force at this arm
    type(fields_type), intent(in) :: fields        !< in equilibrium
    character(:), allocatable, intent(out) :: message
    logical, allocatable :: is_balancing(:, :)     ! (3, n_nodes) held by these supports
    real(DP) :: loads(model%mesh%n_nodes)
    integer :: i, k, worst(2)
    message = ''
    if (.not. (any(model%steps(step)%prescribed%is_balancing) .or. any(model%equations%is_balancing))) return
    allocate (is_balancing(3, model%mesh%n_nodes), source=.false.)
    associate (prescribed => model%steps(step)%prescribed)
      do i = 1, size(prescribed)
        if (prescribed(i)%is_balancing) is_balancing(prescribed(i)%dof, prescribed(i)%node) = .true.
      end do
    end associate
    do i = 1, size(model%equations)
      associate (equation => model%equations(i))
        if (.not. equation%is_balancing .or. step < equation%first_step .or. step > equation%last_step) cycle
        do k = 1, size(equation%node)
          is_balancing(equation%dof(k), equation%node(k)) = .true.
        end do
      end associate
    end do
    if (.not. any(is_balancing)) return
    loads = norm2(fields%applied_force, dim=1)
    if (size(rotation_length) > 0) loads = loads / rotation_length
    if (sum(loads) <= 0.0_DP .or. sum(abs(fields%reaction_force), mask=is_balancing) <= MAX_SUPPORT_FORCE * sum(loads)) return
    worst = maxloc(abs(fields%reaction_force), mask=is_balancing)
    message = 'The loads no longer balance each other: node ' // to_text(model%mesh%node_label(worst(2))) // ', which holds a ' // &
      'free rigid motion in place of a support, carries a force of ' // &
      to_text(fields%reaction_force(worst(1), worst(2))) // ' along ' // AXES(worst(1)) // '. Forces that keep their ' // &
      'direction lose their balance as a body bends or turns. Support the body as it is in reality, or let the loads turn ' // &
      'with it (pressure; *CLOAD, FOLLOWER).'
  end subroutine find_loaded_support


  !> The nodes of bodies that may be held: with elements, in global directions, in no support, equation or multi-point constraint.
  !! Equations connect all nodes of shells: of bodies without other nodes those are held whose fibre is in no support and in no
  !! rigid body, which moves all its nodes.
  function find_usable_nodes(model, equations, place, step, has_hinges) result(is_usable)
    type(model_type), intent(in) :: model
    type(equation_type), intent(in) :: equations(:)
    integer, intent(in) :: place(:)                !< (n_nodes) 0: outside the cluster
    integer, intent(in) :: step
    logical, intent(in) :: has_hinges              !< the bodies are reference and rotation nodes of hinges
    logical :: is_usable(model%mesh%n_nodes)
    logical, allocatable :: is_rigid(:)            ! (n_nodes)
    integer :: i
    is_usable = place > 0 .and. (has_hinges .or. (model%mesh%has_elements .and. .not. model%mesh%is_auxiliary))
    if (allocated(model%frame_of)) is_usable = is_usable .and. model%frame_of == 0
    is_usable(model%steps(step)%prescribed%node) = .false.
    if (has_hinges) return
    do i = 1, size(equations)
      is_usable(equations(i)%node) = .false.
    end do
    allocate (is_rigid(model%mesh%n_nodes), source=.false.)
    if (allocated(model%nonlinear_mpcs)) then
      do i = 1, size(model%nonlinear_mpcs)
        is_usable(model%nonlinear_mpcs(i)%node) = .false.
        if (model%nonlinear_mpcs(i)%kind == MPC_RIGID_BODY) is_rigid(model%nonlinear_mpcs(i)%node) = .true.
      end do
    end if
    if (any(is_usable) .or. .not. allocated(model%structure)) return
    do i = 1, size(model%structure%directors)
      associate (director => model%structure%directors(i))
        is_usable(director%node) = single_fibre(model, director%node) == i .and. place(director%nodes(1)) > 0 .and. &
          place(director%node) > 0 .and. .not. any(is_rigid([director%node, director%nodes]))
      end associate
    end do
    if (allocated(model%frame_of)) is_usable = is_usable .and. model%frame_of == 0
    is_usable(model%steps(step)%prescribed%node) = .false.
  end function find_usable_nodes


  !> The only fibre of a node of a shell; 0: none, a beam, or several at a knot.
  integer function single_fibre(model, node) result(fibre)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    integer :: first, last
    fibre = 0
    if (.not. allocated(model%structure)) return
    if (node > model%structure%n_deck_nodes) return
    call find_node_directors(model%structure, node, first, last)
    if (first == last) fibre = first
    if (fibre == 0) return
    if (model%structure%directors(fibre)%n_outer /= 2) fibre = 0
  end function single_fibre


  !> Chooses degrees of freedom that hold the motions: the one that moves most, then the one that moves most in the motions that
  !! the first leaves, and so on. Of equal ones the first.
  subroutine choose_supports(model, bodies, free, place, is_usable, step, supports)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(cluster_type), intent(in) :: free
    integer, intent(in) :: place(:)                !< (n_nodes) of the body of a node in the cluster
    logical, intent(in) :: is_usable(:)            !< (n_nodes)
    integer, intent(in) :: step
    type(balancing_support_type), allocatable, intent(out) :: supports(:)
    real(DP), parameter :: MIN_PART = 1.0e-3_DP    !< a smaller motion of a degree of freedom does not hold [-]
    real(DP), parameter :: MIN_GAIN = 1.001_DP     !< a later node is taken only if it moves more by this factor [-]
    type(cluster_type) :: left                     ! with the motions that the supports leave
    real(DP), dimension(3, size(free%motions, 2)) :: rows
    real(DP) :: direction(size(free%motions, 2)), largest
    integer :: i, k, m, node, dof, fibre
    allocate (supports(0))
    left = free
    do m = 1, size(free%motions, 2)
      largest = 0.0_DP
      node = 0
      dof = 0
      do i = 1, model%mesh%n_nodes
        if (.not. is_usable(i)) cycle
        rows = node_motions(model, bodies, left, i, place(i))
        fibre = single_fibre(model, i)
        do k = 1, 3
          if (norm2(rows(k, :)) <= MIN_GAIN * largest .or. (fibre == 0 .and. model%mesh%is_unstiffened(k, i))) cycle
          largest = norm2(rows(k, :))
          direction = rows(k, :) / largest
          node = i
          dof = k
        end do
      end do
      if (largest <= MIN_PART) return
      supports = [supports, balancing_support_type(step, node, dof, single_fibre(model, node))]
      left%motions = left%motions - &
        matmul(reshape(matmul(left%motions, direction), [size(left%motions, 1), 1]), reshape(direction, [1, size(direction)]))
    end do
  end subroutine choose_supports

end module amontons_balanced_bodies
