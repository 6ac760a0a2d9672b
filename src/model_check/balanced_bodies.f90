!> Free bodies under balanced loads: supports at single degrees of freedom that hold the rigid motion and carry no force.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A body that can move as a rigid body has an equilibrium if its loads do no work on the free motions; its displacement is then
!! determined but for such a motion. As many degrees of freedom as there are free motions are held, chosen so that they hold them
!! best (largest rows first, with orthogonalization). Their reactions balance the work of the loads on the motions, which is zero:
!! stresses and strains do not depend on the choice. Bodies with contact are left alone: contact forces are not known beforehand.
module amontons_balanced_bodies
  use amontons_kinds, only: DP
  use amontons_text, only: to_text, plural
  use amontons_assembly, only: assembly_type
  use amontons_external_loads, only: assemble_external_loads
  use amontons_loads, only: equation_type
  use amontons_model, only: model_type, n_nonlinear_mpcs
  use amontons_nonlinear_mpc, only: linearize_mpcs
  use amontons_state, only: state_type, slave_state_type, create_state
  use amontons_model_check_bodies, only: bodies_type, find_bodies, body_name, join_item, step_list
  use amontons_model_check_motion, only: free_body_type, find_free_bodies, rigid_motion
  implicit none
  private
  public :: balancing_support_type, find_balancing_supports

  real(DP), parameter :: TOL_BALANCED = 1.0e-6_DP      !< work of all loads over the sum of the works of each nodal force [-]
  integer, parameter :: N_TIMES = 4                    !< times of a step at which the loads are compared

  !> A degree of freedom that is held in a step.
  type :: balancing_support_type
    integer :: step = 0
    integer :: node = 0
    integer :: dof = 0
  end type balancing_support_type

contains

  !> Finds the supports of all steps. After: text names the bodies and nodes, '' if there are none. Nonlinear constraints restrain
  !! motions by their linearization: the rotation of a beam about its axis is held at its nodes by them alone.
  subroutine find_balancing_supports(model, supports, text)
    type(model_type), intent(in) :: model
    type(balancing_support_type), allocatable, intent(out) :: supports(:)
    character(:), allocatable, intent(out) :: text
    type(model_type), allocatable :: linear        ! with nonlinear MPCs linearized to equations, if any
    type(equation_type), allocatable :: equations(:)
    if (n_nonlinear_mpcs(model) > 0) then
      allocate (linear, source=model)
      call linearize_mpcs(model, equations)
      linear%equations = [model%equations, equations]
      call find_linear_supports(linear, supports, text)
    else
      call find_linear_supports(model, supports, text)
    end if
  end subroutine find_balancing_supports


  !> The supports of a model whose constraints are equations. Without loads on the body there is no support: that is more often a
  !! support forgotten.
  subroutine find_linear_supports(model, supports, text)
    type(model_type), intent(in) :: model
    type(balancing_support_type), allocatable, intent(out) :: supports(:)
    character(:), allocatable, intent(out) :: text
    type(bodies_type) :: bodies
    type(free_body_type), allocatable :: free(:)
    type(balancing_support_type), allocatable :: added(:)
    logical, allocatable :: is_usable(:)
    character(:), allocatable :: sentence
    integer :: i, k
    allocate (supports(0))
    text = ''
    do i = 1, size(model%steps)
      if (model%steps(i)%is_dynamic) cycle         ! inertia holds all bodies
      call find_bodies(model, i, bodies)
      call find_free_bodies(model, bodies, i, free)
      do k = 1, size(free)
        if (has_contact(model, bodies, free(k)%body)) cycle
        if (.not. are_loads_balanced(model, bodies, free(k), i)) cycle
        is_usable = find_usable_nodes(model, bodies, free(k)%body, i)
        call choose_supports(model, bodies, free(k), is_usable, i, added)
        if (size(added) < free(k)%n) cycle
        supports = [supports, added]
        sentence = 'The loads on the ' // body_name(model, bodies%list(free(k)%body)) // ' balance each other; ' // &
          node_list(model, added) // ' hold' // trim(merge('s', ' ', all(added%node == added(1)%node))) // ' its ' // &
          plural(free(k)%n, 'free rigid motion') // ' without a force.'
        if (index(text, sentence) > 0) cycle
        if (text /= '') text = text // ' '
        text = text // sentence
      end do
    end do
  end subroutine find_linear_supports


  !> 'node 7 along x, node 7 along y and node 9 along z'.
  function node_list(model, supports) result(text)
    type(model_type), intent(in) :: model
    type(balancing_support_type), intent(in) :: supports(:)
    character(:), allocatable :: text
    character(1), parameter :: AXES(3) = ['x', 'y', 'z']
    integer :: i
    text = ''
    do i = 1, size(supports)
      text = join_item(text, 'node ' // to_text(model%mesh%node_label(supports(i)%node)) // ' along ' // &
        AXES(supports(i)%dof), i == size(supports))
    end do
  end function node_list


  !> Whether a body has a node on a contact surface.
  logical function has_contact(model, bodies, body)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    integer, intent(in) :: body
    integer :: p
    has_contact = .false.
    do p = 1, size(model%pairs)
      has_contact = has_contact .or. any(bodies%of_node(model%surfaces(model%pairs(p)%slave)%nodes) == body) .or. &
        any(bodies%of_node(model%surfaces(model%pairs(p)%master)%nodes) == body)
    end do
  end function has_contact


  !> Whether loads act on a body and do no work on its free motions, at several times of the step.
  logical function are_loads_balanced(model, bodies, free, step) result(are_balanced)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(free_body_type), intent(in) :: free
    integer, intent(in) :: step
    type(assembly_type) :: assembly
    type(state_type) :: state
    type(slave_state_type) :: no_slaves(0)
    real(DP) :: work(free%n), sizes(free%n), motion(3), before
    integer :: i, k, t
    logical :: has_loads
    call create_state(state, model%mesh, no_slaves)
    has_loads = any([(bodies%of_node(model%steps(step)%temperatures(i)%node) == free%body, &
      i=1, size(model%steps(step)%temperatures))])
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
        if (bodies%of_node(i) /= free%body) cycle
        do k = 1, free%n
          motion = matmul(rigid_motion(bodies%list(free%body), model%mesh%coordinates(:, i)), free%motions(:, k))
          work(k) = work(k) + dot_product(motion, state%new%applied_force(:, i))
          sizes(k) = sizes(k) + norm2(motion) * norm2(state%new%applied_force(:, i))
        end do
        has_loads = has_loads .or. norm2(state%new%applied_force(:, i)) > 0.0_DP
      end do
      are_balanced = are_balanced .and. all(abs(work) <= TOL_BALANCED * sizes)
    end do
    are_balanced = are_balanced .and. has_loads
  end function are_loads_balanced


  !> The nodes of a body that may be held: with elements, in global directions, in no support, equation or multi-point constraint.
  function find_usable_nodes(model, bodies, body, step) result(is_usable)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    integer, intent(in) :: body, step
    logical :: is_usable(model%mesh%n_nodes)
    integer :: i
    is_usable = bodies%of_node == body .and. model%mesh%has_elements .and. .not. model%mesh%is_auxiliary
    if (allocated(model%frame_of)) is_usable = is_usable .and. model%frame_of == 0
    is_usable(model%steps(step)%prescribed%node) = .false.
    do i = 1, size(model%equations)
      is_usable(model%equations(i)%node) = .false.
    end do
    if (.not. allocated(model%nonlinear_mpcs)) return
    do i = 1, size(model%nonlinear_mpcs)
      is_usable(model%nonlinear_mpcs(i)%node) = .false.
    end do
  end function find_usable_nodes


  !> Chooses degrees of freedom that hold the motions: the one that moves most, then the one that moves most in the motions that
  !! the first leaves, and so on. Of equal ones the first.
  subroutine choose_supports(model, bodies, free, is_usable, step, supports)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(free_body_type), intent(in) :: free
    logical, intent(in) :: is_usable(:)            !< (n_nodes)
    integer, intent(in) :: step
    type(balancing_support_type), allocatable, intent(out) :: supports(:)
    real(DP), parameter :: MIN_PART = 1.0e-3_DP    !< a smaller motion of a degree of freedom does not hold [-]
    real(DP), parameter :: MIN_GAIN = 1.001_DP     !< a later node is taken only if it moves more by this factor [-]
    real(DP) :: motions(6, free%n), rows(3, free%n), largest, direction(free%n)
    integer :: i, k, m, node, dof
    allocate (supports(0))
    motions = free%motions(:, :free%n)
    do m = 1, free%n
      largest = 0.0_DP
      node = 0
      dof = 0
      do i = 1, model%mesh%n_nodes
        if (.not. is_usable(i)) cycle
        rows = matmul(rigid_motion(bodies%list(free%body), model%mesh%coordinates(:, i)), motions)
        do k = 1, 3
          if (norm2(rows(k, :)) <= MIN_GAIN * largest .or. model%mesh%is_unstiffened(k, i)) cycle
          largest = norm2(rows(k, :))
          direction = rows(k, :) / largest
          node = i
          dof = k
        end do
      end do
      if (largest <= MIN_PART) return
      supports = [supports, balancing_support_type(step, node, dof)]
      motions = motions - matmul(reshape(matmul(motions, direction), [6, 1]), reshape(direction, [1, free%n]))
    end do
  end subroutine choose_supports

end module amontons_balanced_bodies
