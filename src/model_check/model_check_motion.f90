!> Rigid body motions that supports, equations and contact leave free in a step (null space of the constraint Gram matrix).
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A body has six rigid body modes, u = t + r x (x - centre)/size. A support, an equation, or a contact that is
!! closed or can close is a row a'u = 0 on these. The supports leave each body a basis of motions (the null space of its
!! 6 x 6 Gram matrix); equations and contacts are rows on these bases, and couple bodies. The null space of the Gram matrix
!! R'R of each cluster of coupled bodies contains its free motions. Cost: linear in nodes and rows, for a cluster
!! that of a sparse factorization.
module amontons_model_check_motion
  use amontons_kinds, only: DP
  use amontons_errors, only: diagnostic_list_type
  use amontons_text, only: to_text
  use amontons_containers, only: integer_list_type
  use amontons_tensor, only: cross_product
  use amontons_element_kinds, only: element_kind, element_kind_type, kind_family, KIND_T3D2, KIND_SPRING1, FAMILY_AXISYMMETRIC
  use amontons_null_space, only: find_null_space
  use amontons_column_singletons, only: solve_column_singletons
  use amontons_surfaces, only: BEHAVIOR_USER
  use amontons_steps, only: step_type
  use amontons_stabilization, only: is_damped
  use amontons_mesh, only: mean_face_normal
  use amontons_loads, only: equation_type
  use amontons_model, only: model_type, dof_direction, absent_elements
  use amontons_nonlinear_mpc, only: linear_equations
  use amontons_state, only: slave_state_type, STATUS_OPEN, STATUS_SLIP
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_pairs, only: contact_type, current_row
  use amontons_containers, only: find_root, unite_trees
  use amontons_model_check_bodies, only: step_list, join_item, body_type, bodies_type, body_name, find_bodies, &
    mean_element_sizes
  use amontons_model_check_contact, only: is_closed, can_close_later
  use amontons_motion_rows, only: bases_type, rows_type, motion_matrix_type, allocate_rows, end_row, build_matrix, &
    find_scaled_null_space
  use amontons_rigid_modes, only: simplify_motions, motions_text, is_translation, MIN_MOTION_PART
  implicit none
  private
  public :: check_rigid_motions, find_free_motion, cluster_type, find_free_clusters, rigid_motion

  ! An eigenvalue or pivot of a Gram matrix that is a smaller part of the largest than this counts as 0 [-]. With
  ! contacts it is the square of a slope: the normals carry the rounding of the coordinates in the deck.
  real(DP), parameter :: SUPPORT_TOLERANCE = 1.0e-12_DP
  real(DP), parameter :: CONTACT_TOLERANCE = 1.0e-10_DP

  ! Supports on a line whose coordinates are rounded by 1 are up to sqrt(2) off it, and the line that fits them best as far again.
  real(DP), parameter :: MAX_OFFSET_OF_ROUNDED = 2 * sqrt(2.0_DP)
  real(DP), parameter :: MAX_ROUNDING_IN_EDGE = 3.0e-4_DP   !< over the mean size of the elements: no two nodes are that near [-]

  ! Kinds of findings.
  integer, parameter :: FINDING_FREE = 1           !< no restraint
  integer, parameter :: FINDING_OPEN = 2           !< only contact that is open at the start can restrain them
  integer, parameter :: FINDING_PLACED = 3         !< unrestrained at the position in the deck; earlier steps may move the body
  integer, parameter :: FINDING_DAMPED = 4         !< no restraint but the damping of STABILIZE

  !> Unrestrained motions of some bodies, and the steps concerned.
  type :: finding_type
    integer :: code = FINDING_FREE                 !< FINDING_...
    integer, allocatable :: bodies(:)              !< those that move together
    real(DP), allocatable :: motions(:, :)         !< (6, n) of the first of them: t, r
    character(:), allocatable :: motion            !< both in words
    type(integer_list_type) :: steps
  end type finding_type

  !> Bodies that rows couple, and their free motions.
  type :: cluster_type
    integer, allocatable :: bodies(:)              !< indices into bodies%list, ascending: those with elements come first
    real(DP), allocatable :: motions(:, :)         !< (6 bodies, n) t, r of each body, as in `rigid_motion`; not allocated: none
  end type cluster_type

contains

  !> The clusters of bodies that can move in a step, without regard to contact: a body alone, one of shells or beams with the
  !! nodes of its fibres, and what equations couple to them, like the reference node of a rigid body. Those that damping or an
  !! earlier step may hold do not count.
  subroutine find_free_clusters(model, bodies, step, free)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    integer, intent(in) :: step                    !< its number
    type(cluster_type), allocatable, intent(out) :: free(:)   !< the first body of each moves and has elements if one has
    type(bases_type) :: bases
    type(rows_type) :: rows
    type(cluster_type), allocatable :: clusters(:)
    integer, allocatable :: order(:)
    logical, allocatable :: is_free(:)
    integer :: i, k, first
    allocate (free(0))
    call find_bases(model, bodies, model%steps(step), bases)
    if (all(bases%n == 0) .or. is_held_by_damping(model, step)) return
    call allocate_rows(bodies%n, rows)
    call add_equations(model, bodies, bases, rows)
    call find_clusters(bodies, bases, rows, .false., clusters)
    allocate (is_free(size(clusters)), source=.false.)
    do i = 1, size(clusters)
      associate (members => clusters(i)%bodies, motions => clusters(i)%motions)
        first = 0
        do k = size(members), 1, -1
          if (bodies%list(members(k))%n_elements > 0 .and. maxval(abs(motions(6 * k - 5:6 * k, :))) > &
            MIN_MOTION_PART * maxval(abs(motions))) first = k
        end do
        if (all(bodies%list(members)%n_elements == 0)) first = 1
        if (first == 0) cycle
        is_free(i) = .not. may_be_held_later(model, step, motions(6 * first - 5:6 * first, :))
        if (.not. is_free(i) .or. first == 1) cycle
        order = [first, (k, k=1, first - 1), (k, k=first + 1, size(members))]
        motions = motions([(6 * order(k) + [-5, -4, -3, -2, -1, 0], k=1, size(order))], :)
        members = members(order)
      end associate
    end do
    free = pack(clusters, is_free)
  end subroutine find_free_clusters


  !> Reports unrestrained rigid motions of each step (errors), and those that only open contact restrains at the start (warnings).
  subroutine check_rigid_motions(model, contact, slaves, bodies, report)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)      !< at the start of the first increment
    type(bodies_type), intent(in) :: bodies
    type(diagnostic_list_type), intent(inout) :: report
    type(finding_type), allocatable :: findings(:)
    integer :: i
    allocate (findings(0))
    do i = 1, size(model%steps)
      if (model%steps(i)%is_dynamic) cycle         ! inertia holds all bodies
      call check_step(model, contact, slaves, present_bodies(model, bodies, i), i, findings)
    end do
    do i = 1, size(findings)
      associate (finding => findings(i))
        call report%add('', 0, '', 'In ' // step_list(finding%steps%trimmed()) // ' the ' // finding%motion &
          // remedy_text(finding%code), is_warning=finding%code /= FINDING_FREE)
      end associate
    end do
  end subroutine check_rigid_motions


  !> The bodies of the first step; those without elements in a step count as nodes alone, which need no supports.
  pure function present_bodies(model, bodies, step) result(present)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    integer, intent(in) :: step                    !< its number
    type(bodies_type) :: present
    logical :: is_absent(model%mesh%n_elements), has_element(0:bodies%n)
    present = bodies
    is_absent = absent_elements(model, step)
    if (.not. any(is_absent)) return
    has_element = .false.
    has_element(pack(bodies%of_element, .not. is_absent)) = .true.
    where (.not. has_element(1:)) present%list%n_elements = 0
  end function present_bodies


  !> Finds a motion that supports, equations, nonlinear MPCs and closed slave nodes leave free in a step.
  !! Slipping slave nodes restrain their bodies along the normal only; nonlinear MPCs restrain by their linearization.
  subroutine find_free_motion(model, contact, slaves, step, is_free, motion)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: step                    !< its number
    logical, intent(out) :: is_free                !< there is one
    character(:), allocatable, intent(out) :: motion   !< body and motion in words; not allocated if none is free
    type(equation_type), allocatable :: equations(:)
    type(bodies_type) :: bodies
    type(bases_type) :: bases
    type(rows_type) :: rows
    type(finding_type), allocatable :: findings(:)
    integer :: s
    is_free = .false.
    call linear_equations(model, equations)
    call find_bodies(model, equations, step, bodies)
    call find_bases(model, bodies, model%steps(step), bases)
    if (all(bases%n == 0)) return
    allocate (findings(0))
    call allocate_rows(bodies%n, rows)
    call add_equations(model, bodies, bases, rows)
    do s = 1, size(slaves)
      if (slaves(s)%status == STATUS_OPEN .or. slaves(s)%facet == 0) cycle
      call add_contact(model, contact, slaves(s), bodies, bases, rows)
    end do
    call check_clusters(model, bodies, bases, rows, step, .false., findings)
    is_free = size(findings) > 0
    if (is_free) motion = findings(1)%motion
  end subroutine find_free_motion


  !> Finds the free motions of one step.
  subroutine check_step(model, contact, slaves, bodies, step, findings)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    type(bodies_type), intent(in) :: bodies
    integer, intent(in) :: step                    !< its number
    type(finding_type), allocatable, intent(inout) :: findings(:)
    type(bases_type) :: bases
    type(rows_type) :: rows
    call find_bases(model, bodies, model%steps(step), bases)
    if (all(bases%n == 0)) return
    call allocate_rows(bodies%n, rows)
    call add_equations(model, bodies, bases, rows)
    call add_contacts(model, contact, slaves, bodies, bases, rows)
    call check_clusters(model, bodies, bases, rows, step, .false., findings)
    if (step > 1 .or. size(findings) > 0) return
    if (any(rows%is_open(:rows%n))) call check_clusters(model, bodies, bases, rows, step, .true., findings)
  end subroutine check_step


  !> The displacement of a point by the six motions of a body: u_k = sum row(k, :) (t, r).
  pure function rigid_motion(body, x) result(rows)
    type(body_type), intent(in) :: body
    real(DP), intent(in) :: x(3)                   !< [length]
    real(DP) :: rows(3, 6)
    real(DP) :: arm(3)
    arm = (x - body%centre) / body%size
    rows = reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, &
      0.0_DP, -arm(3), arm(2), arm(3), 0.0_DP, -arm(1), -arm(2), arm(1), 0.0_DP], [3, 6])
  end function rigid_motion


  !> Bases of the motions that the supports of a step leave free.
  subroutine find_bases(model, bodies, step, bases)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(step_type), intent(in) :: step
    type(bases_type), intent(out) :: bases
    real(DP), allocatable :: gram(:, :, :), eigenvalues(:, :)
    real(DP) :: row(6)
    integer, allocatable :: n_rows(:)              ! (n_bodies) of supports
    integer :: i, b
    allocate (gram(6, 6, bodies%n), source=0.0_DP)
    allocate (eigenvalues(6, bodies%n))
    allocate (bases%n(bodies%n), n_rows(bodies%n), source=0)
    allocate (bases%motion(6, 6, bodies%n), source=0.0_DP)
    call constrain_unattached_nodes(bodies, gram)
    do i = 1, size(step%prescribed)
      associate (load => step%prescribed(i))
        b = bodies%of_node(load%node)
        if (b == 0) cycle
        row = matmul(dof_direction(model, load%node, load%dof), &
          rigid_motion(bodies%list(b), model%mesh%coordinates(:, load%node)))
        call add_product(row, row, gram(:, :, b))
        n_rows(b) = n_rows(b) + 1
      end associate
    end do
    call constrain_by_elements(model, bodies, gram)
    call constrain_line_rotation(model, bodies, gram)
    do b = 1, bodies%n
      call find_null_space(gram(:, :, b), SUPPORT_TOLERANCE, bases%n(b), bases%motion(:, :, b), eigenvalues(:, b))
    end do
    call release_rounded_motions(model, bodies, step, n_rows, eigenvalues, bases)
    if (.not. allocated(model%user_elements)) return
    do i = 1, size(model%user_elements%elements)   ! UEL alone knows what its unknowns are and what they resist
      b = bodies%of_element(model%user_elements%elements(i)%element)
      if (b > 0) bases%n(b) = 0
    end do
  end subroutine find_bases


  !> Adds the motions that only the rounding of the coordinates restrains: they move no support by more than its coordinates are
  !! rounded. Supports on an inclined line, written with a few digits, leave the rotation about that line free.
  subroutine release_rounded_motions(model, bodies, step, n_rows, eigenvalues, bases)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(step_type), intent(in) :: step
    integer, intent(in) :: n_rows(:)               !< (n_bodies) of supports
    real(DP), intent(in) :: eigenvalues(:, :)      !< (6, n_bodies) of the Gram matrices, ascending
    type(bases_type), intent(inout) :: bases       !< with all six eigenvectors of each body
    real(DP), allocatable :: slack(:)              ! (n_bodies) of the displacement of a support [-]
    real(DP), allocatable :: element_size(:)       ! (n_bodies) [length]
    integer :: n_candidates(bodies%n), i, b, k
    real(DP) :: row(6), rounding
    allocate (slack(bodies%n), source=0.0_DP)
    n_candidates = 0
    do b = 1, bodies%n
      if (bodies%list(b)%n_elements == 0 .or. n_rows(b) == 0) cycle
      rounding = coordinate_rounding(model%mesh%coordinates, bodies%list(b))
      do k = 1, 2                                  ! with the sizes of the elements only if it counts
        slack(b) = MAX_OFFSET_OF_ROUNDED * rounding / bodies%list(b)%size
        n_candidates(b) = max(bases%n(b), count(eigenvalues(:, b) <= real(n_rows(b), DP) * slack(b)**2))
        if (n_candidates(b) == bases%n(b) .or. k == 2) exit
        if (.not. allocated(element_size)) element_size = mean_element_sizes(model%mesh, bodies)
        rounding = min(rounding, MAX_ROUNDING_IN_EDGE * element_size(b))
      end do
    end do
    if (all(n_candidates <= bases%n)) return
    do i = 1, size(step%prescribed)
      associate (load => step%prescribed(i))
        b = bodies%of_node(load%node)
        if (b == 0) cycle
        row = matmul(dof_direction(model, load%node, load%dof), &
          rigid_motion(bodies%list(b), model%mesh%coordinates(:, load%node)))
        do while (n_candidates(b) > bases%n(b))
          if (abs(dot_product(row, bases%motion(:, n_candidates(b), b))) <= slack(b)) exit
          n_candidates(b) = n_candidates(b) - 1
        end do
      end associate
    end do
    bases%n = n_candidates
  end subroutine release_rounded_motions


  !> How far the coordinates of a body may be rounded [length]: half a unit of their last digit if they have four to six digits or
  !! few decimals, else of the seventh digit.
  pure real(DP) function coordinate_rounding(x, body) result(rounding)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes)
    type(body_type), intent(in) :: body
    integer, parameter :: MIN_DIGITS = 4, MAX_DIGITS = 6, MAX_SAMPLED_NODES = 1000
    real(DP), parameter :: SINGLE = 5.0e-7_DP      ! half a unit of the seventh digit [-]
    real(DP) :: largest, written
    integer :: digits, stride
    largest = max(maxval(abs(body%low)), maxval(abs(body%high)))
    rounding = SINGLE * largest
    stride = max(1, size(x, 2) / MAX_SAMPLED_NODES)
    do digits = MIN_DIGITS, MAX_DIGITS
      written = 10.0_DP**(floor(log10(max(largest, tiny(1.0_DP)))) - digits + 1)
      if (.not. all(is_written_with(x(:, ::stride), digits) .or. is_multiple(x(:, ::stride), written))) cycle
      rounding = max(rounding, 0.5_DP * written)
      exit
    end do
  end function coordinate_rounding


  !> Whether a number has at most so many significant digits.
  elemental logical function is_written_with(x, digits)
    real(DP), intent(in) :: x
    integer, intent(in) :: digits
    is_written_with = is_multiple(x, 10.0_DP**(floor(log10(max(abs(x), tiny(1.0_DP)))) - digits + 1))
  end function is_written_with


  !> Whether a number is a multiple of a unit, but for rounding.
  elemental logical function is_multiple(x, unit)
    real(DP), intent(in) :: x, unit
    real(DP), parameter :: ROUNDING = 1.0e-15_DP   ! of the number [-]
    real(DP) :: n
    n = x / unit
    is_multiple = abs(n - anint(n)) <= max(1.0e-9_DP, 10 * ROUNDING * abs(n))
  end function is_multiple


  !> Motions that the elements themselves restrain: displacements without stiffness are fixed at zero (the third of plane
  !! models); an axisymmetric element resists its radial displacement, a spring to the ground its own.
  subroutine constrain_by_elements(model, bodies, gram)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    real(DP), intent(inout) :: gram(:, :, :)       !< (6, 6, n_bodies)
    type(element_kind_type) :: entry
    integer :: e, i, k
    associate (mesh => model%mesh)
      if (.not. allocated(mesh%is_unstiffened)) return
      do i = 1, mesh%n_nodes
        do k = 1, 3
          if (mesh%is_unstiffened(k, i)) call constrain_dof(i, k)
        end do
      end do
      do e = 1, mesh%n_elements
        if (kind_family(mesh%kind(e)) == FAMILY_AXISYMMETRIC) then
          do i = mesh%first(e), mesh%first(e + 1) - 1
            call constrain_dof(mesh%nodes(i), 1)
          end do
        else if (mesh%kind(e) == KIND_SPRING1) then
          do k = 1, 3                              ! 0: its direction is not a coordinate axis
            if (mesh%directions(1, e) == k .or. mesh%directions(1, e) == 0) call constrain_dof(mesh%nodes(mesh%first(e)), k)
          end do
        end if
      end do
      if (.not. allocated(model%foundations)) return
      do i = 1, size(model%foundations)
        call constrain_face(model%foundations(i)%element, model%foundations(i)%face)
      end do
    end associate

  contains

    !> A foundation: supports of the nodes of a face along its mean normal.
    subroutine constrain_face(e, face)
      integer, intent(in) :: e, face
      real(DP) :: rows(3, 6), normal(3)
      integer :: a, b
      entry = element_kind(model%mesh%kind(e))
      normal = mean_face_normal(model%mesh, e, face)
      do a = 1, count(entry%face_nodes(:, face) > 0)
        associate (node => model%mesh%nodes(model%mesh%first(e) - 1 + entry%face_nodes(a, face)))
          b = bodies%of_node(node)
          if (b == 0) cycle
          rows = rigid_motion(bodies%list(b), model%mesh%coordinates(:, node))
          call add_product(matmul(normal, rows), matmul(normal, rows), gram(:, :, b))
        end associate
      end do
    end subroutine constrain_face

    !> A support of one displacement of a node.
    subroutine constrain_dof(node, dof)
      integer, intent(in) :: node, dof
      real(DP) :: rows(3, 6)
      integer :: b
      b = bodies%of_node(node)
      if (b == 0) return
      rows = rigid_motion(bodies%list(b), model%mesh%coordinates(:, node))
      call add_product(rows(dof, :), rows(dof, :), gram(:, :, b))
    end subroutine constrain_dof

  end subroutine constrain_by_elements


  !> A body of trusses, springs or masses may be a line or a point: rotations that move no node count as restrained.
  subroutine constrain_line_rotation(model, bodies, gram)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    real(DP), intent(inout) :: gram(:, :, :)       !< (6, 6, n_bodies)
    real(DP), allocatable :: moved(:, :, :)
    logical :: is_thin(bodies%n)
    real(DP) :: rows(3, 6), vectors(6, 6)
    integer :: i, k, b, n
    is_thin = .false.
    do i = 1, model%mesh%n_elements
      if (model%mesh%kind(i) >= KIND_T3D2 .and. bodies%of_element(i) > 0) is_thin(bodies%of_element(i)) = .true.
    end do
    if (.not. any(is_thin)) return
    allocate (moved(6, 6, bodies%n), source=0.0_DP)
    do i = 1, model%mesh%n_nodes
      b = bodies%of_node(i)
      if (b == 0) cycle
      if (.not. is_thin(b)) cycle
      rows = rigid_motion(bodies%list(b), model%mesh%coordinates(:, i))
      do k = 1, 3
        call add_product(rows(k, :), rows(k, :), moved(:, :, b))
      end do
    end do
    do b = 1, bodies%n
      if (.not. is_thin(b)) cycle
      call find_null_space(moved(:, :, b), SUPPORT_TOLERANCE, n, vectors)
      do k = 1, n
        call add_product(vectors(:, k), vectors(:, k), gram(:, :, b))
      end do
    end do
  end subroutine constrain_line_rotation


  !> A node without elements does not rotate, and moves only in the directions that occur in equations.
  subroutine constrain_unattached_nodes(bodies, gram)
    type(bodies_type), intent(in) :: bodies
    real(DP), intent(inout) :: gram(:, :, :)       !< (6, 6, n_bodies)
    logical, allocatable :: is_used(:, :)
    integer :: b, i, k
    allocate (is_used(6, bodies%n), source=.false.)
    do i = 1, size(bodies%equations)
      do k = 1, size(bodies%equations(i)%node)
        is_used(bodies%equations(i)%dof(k), bodies%of_node(bodies%equations(i)%node(k))) = .true.
      end do
    end do
    do b = 1, bodies%n
      if (bodies%list(b)%n_elements > 0) cycle
      do k = 1, 6
        if (.not. is_used(k, b)) gram(k, k, b) = 1.0_DP
      end do
    end do
  end subroutine constrain_unattached_nodes


  !> Adds a'u(node) to the current row.
  subroutine add_term(model, bodies, node, a, rows)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    integer, intent(in) :: node
    real(DP), intent(in) :: a(3)
    type(rows_type), intent(inout) :: rows
    integer :: b
    b = bodies%of_node(node)
    if (b == 0) return
    if (.not. any(rows%touched(:rows%n_touched) == b)) then
      rows%n_touched = rows%n_touched + 1
      rows%touched(rows%n_touched) = b
    end if
    rows%work(:, b) = rows%work(:, b) + matmul(a, rigid_motion(bodies%list(b), model%mesh%coordinates(:, node)))
  end subroutine add_term


  !> The rows of all equations.
  subroutine add_equations(model, bodies, bases, rows)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(bases_type), intent(in) :: bases
    type(rows_type), intent(inout) :: rows
    real(DP) :: a(3)
    integer :: i, k
    do i = 1, size(bodies%equations)
      associate (equation => bodies%equations(i))
        do k = 1, size(equation%node)
          a = 0.0_DP
          a(equation%dof(k)) = equation%coefficient(k) / maxval(abs(equation%coefficient))
          call add_term(model, bodies, equation%node(k), a, rows)
        end do
      end associate
      call end_row(bases, .false., rows)
    end do
  end subroutine add_equations


  !> The rows of all slave nodes that are or may come into contact.
  subroutine add_contacts(model, contact, slaves, bodies, bases, rows)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    type(bodies_type), intent(in) :: bodies
    type(bases_type), intent(in) :: bases
    type(rows_type), intent(inout) :: rows
    type(slave_state_type) :: slave
    logical, allocatable :: is_later(:)            ! (n_pairs) without projection now, may close later
    integer :: s, p
    allocate (is_later(size(model%pairs)), source=.true.)
    do s = 1, size(slaves)
      if (slaves(s)%facet > 0) is_later(slaves(s)%pair) = .false.
    end do
    do p = 1, size(model%pairs)
      if (is_later(p)) is_later(p) = can_close_later(model, contact, p)
    end do
    do s = 1, size(slaves)
      slave = slaves(s)
      if (is_later(slave%pair)) then               ! the facet of later contact is unknown: take any
        slave%facet = 1
        slave%row = 0
        slave%normal = -contact%slave_normal(:, s)
      end if
      if (slave%facet == 0 .or. norm2(slave%normal) < 0.5_DP) cycle
      call add_contact(model, contact, slave, bodies, bases, rows)
    end do
  end subroutine add_contacts


  !> The normal row of one slave node, and with friction the two tangential ones.
  subroutine add_contact(model, contact, slave, bodies, bases, rows)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    type(bodies_type), intent(in) :: bodies
    type(bases_type), intent(in) :: bases
    type(rows_type), intent(inout) :: rows
    type(contact_row_type) :: row
    real(DP) :: direction(3, 3)
    integer :: i, k, n_directions
    logical :: is_open
    call current_row(contact, slave, row)
    is_open = .not. is_closed(contact, slave)
    associate (law => contact%laws(slave%pair))
      n_directions = merge(3, 1, law%friction > 0.0_DP .or. law%is_user_friction .or. law%behavior == BEHAVIOR_USER)
    end associate
    if (slave%status == STATUS_SLIP) n_directions = 1
    direction(:, 1) = slave%normal
    direction(:, 2) = 0.0_DP
    direction(minloc(abs(slave%normal), dim=1), 2) = 1.0_DP
    direction(:, 2) = cross_product(slave%normal, direction(:, 2))
    direction(:, 2) = direction(:, 2) / norm2(direction(:, 2))
    direction(:, 3) = cross_product(slave%normal, direction(:, 2))
    do k = 1, n_directions
      do i = 1, size(row%nodes)
        call add_term(model, bodies, row%nodes(i), row%weights(i) * direction(:, k), rows)
      end do
      call end_row(bases, is_open, rows)
    end do
  end subroutine add_contact


  !> Reports the free motions of each cluster of bodies coupled by rows.
  subroutine check_clusters(model, bodies, bases, rows, step, is_start, findings)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(bases_type), intent(in) :: bases
    type(rows_type), intent(in) :: rows
    integer, intent(in) :: step
    logical, intent(in) :: is_start                !< .true.: without the contacts that are open at the start
    type(finding_type), allocatable, intent(inout) :: findings(:)
    type(cluster_type), allocatable :: clusters(:)
    integer :: i
    call find_clusters(bodies, bases, rows, is_start, clusters)
    do i = 1, size(clusters)
      call report_motions(model, bodies, clusters(i)%bodies, clusters(i)%motions, step, is_start, findings)
    end do
  end subroutine check_clusters


  !> Finds the clusters of bodies coupled by rows that have free motions.
  subroutine find_clusters(bodies, bases, rows, is_start, clusters)
    type(bodies_type), intent(in) :: bodies
    type(bases_type), intent(in) :: bases
    type(rows_type), intent(in) :: rows
    logical, intent(in) :: is_start                !< .true.: without the contacts that are open at the start
    type(cluster_type), allocatable, intent(out) :: clusters(:)
    type(cluster_type), allocatable :: found(:)
    type(motion_matrix_type) :: matrix
    integer, allocatable :: parent(:)
    type(integer_list_type), allocatable :: members(:), rows_of(:)   ! of a cluster, at its root
    integer :: b, r, i, root, n
    call build_matrix(bases, rows, is_start, matrix)
    allocate (members(bodies%n), rows_of(bodies%n))
    parent = [(b, b=1, bodies%n)]
    do r = 1, rows%n
      if (is_start .and. rows%is_open(r)) cycle
      do i = rows%first(r) + 1, rows%first(r + 1) - 1
        call unite_trees(parent, rows%body(rows%first(r)), rows%body(i))
      end do
    end do
    do b = 1, bodies%n
      if (bases%n(b) == 0) cycle
      root = find_root(parent, b)
      call members(root)%add(b)
    end do
    do r = 1, rows%n
      if ((is_start .and. rows%is_open(r)) .or. matrix%is_solved_row(r)) cycle
      root = find_root(parent, rows%body(rows%first(r)))
      call rows_of(root)%add(r)
    end do
    allocate (found(count(members%n > 0)))
    n = 0
    do b = 1, bodies%n
      if (members(b)%n == 0) cycle
      found(n + 1)%bodies = members(b)%trimmed()
      call find_cluster_motions(bases, matrix, rows_of(b), found(n + 1))
      if (allocated(found(n + 1)%motions)) n = n + 1
    end do
    clusters = found(:n)
  end subroutine find_clusters


  !> The null space of the Gram matrix of one cluster as motions, if any.
  subroutine find_cluster_motions(bases, matrix, rows_of, cluster)
    type(bases_type), intent(in) :: bases
    type(motion_matrix_type), intent(inout) :: matrix
    type(integer_list_type), intent(in) :: rows_of !< that are not solved
    type(cluster_type), intent(inout) :: cluster   !< with its bodies
    real(DP), allocatable :: vectors(:, :), x(:)
    integer, allocatable :: n_left(:)              ! (bodies) motions that are not solved
    integer :: i, k, m, n, c
    associate (members => cluster%bodies)
      allocate (n_left(size(members)))
      m = 0
      do i = 1, size(members)
        n_left(i) = -m
        do c = matrix%first_motion(members(i)), matrix%first_motion(members(i) + 1) - 1
          if (matrix%place(c) == 0) cycle
          m = m + 1
          matrix%place(c) = m
        end do
        n_left(i) = n_left(i) + m
      end do
      if (m == 0) return
      call find_scaled_null_space(matrix, rows_of, n_left, CONTACT_TOLERANCE, n, vectors)
      if (n == 0) return
      allocate (cluster%motions(6 * size(members), n), x(size(matrix%place)))
      do k = 1, n
        x = 0.0_DP
        do i = 1, size(members)
          do c = matrix%first_motion(members(i)), matrix%first_motion(members(i) + 1) - 1
            if (matrix%place(c) > 0) x(c) = vectors(matrix%place(c), k)
          end do
        end do
        call solve_column_singletons(matrix%first, matrix%column, matrix%value, matrix%solved_columns, matrix%solved_rows, x)
        cluster%motions(:, k) = 0.0_DP
        do i = 1, size(members)
          do c = matrix%first_motion(members(i)), matrix%first_motion(members(i) + 1) - 1
            cluster%motions(6 * i - 5:6 * i, k) = cluster%motions(6 * i - 5:6 * i, k) + &
              x(c) * bases%motion(:, c - matrix%first_motion(members(i)) + 1, members(i))
          end do
        end do
      end do
    end associate
    call simplify_motions(cluster%motions)
  end subroutine find_cluster_motions


  !> G = G + a b'.
  pure subroutine add_product(a, b, gram)
    real(DP), intent(in) :: a(:), b(:)
    real(DP), intent(inout) :: gram(:, :)          !< (size of a, size of b)
    integer :: j
    do j = 1, size(b)
      gram(:, j) = gram(:, j) + b(j) * a
    end do
  end subroutine add_product


  !> One finding for each set of bodies that moves together.
  subroutine report_motions(model, bodies, members, motions, step, is_start, findings)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    integer, intent(in) :: members(:)              !< bodies
    real(DP), intent(in) :: motions(:, :)          !< (6 members, n)
    integer, intent(in) :: step
    logical, intent(in) :: is_start
    type(finding_type), allocatable, intent(inout) :: findings(:)
    logical :: is_moved(size(members), size(motions, 2)), is_reported(size(motions, 2)), is_same(size(motions, 2))
    type(finding_type) :: finding
    real(DP) :: limit
    integer :: i, j, first
    do j = 1, size(motions, 2)
      limit = MIN_MOTION_PART * maxval(abs(motions(:, j)))
      do i = 1, size(members)
        is_moved(i, j) = maxval(abs(motions(6 * i - 5:6 * i, j))) > limit
      end do
    end do
    is_reported = .false.
    do j = 1, size(motions, 2)
      if (is_reported(j)) cycle
      is_same = [(all(is_moved(:, i) .eqv. is_moved(:, j)), i=1, size(motions, 2))]
      is_reported = is_reported .or. is_same
      first = findloc(is_moved(:, j), .true., dim=1)
      finding%bodies = pack(members, is_moved(:, j))
      finding%motions = motions(6 * first - 5:6 * first, pack([(i, i=1, size(is_same))], is_same))
      finding%motion = body_name(model, bodies%list(members(first)))
      if (size(finding%bodies) > 1) finding%motion = finding%motion // ' and with it ' // &
        other_bodies(model, bodies, finding%bodies)
      finding%motion = finding%motion // ' can ' // motions_text(bodies%list(members(first)), &
        motions(6 * first - 5:6 * first, :), is_same)
      finding%code = merge(FINDING_OPEN, FINDING_FREE, is_start)
      if (may_be_held_later(model, step, finding%motions)) finding%code = FINDING_PLACED
      if (is_held_by_damping(model, step) .and. bodies%list(members(first))%n_elements > 0) finding%code = FINDING_DAMPED
      call add_finding(finding, step, findings)
    end do
  end subroutine report_motions


  !> The second and third body by name, the others by number.
  function other_bodies(model, bodies, moved) result(text)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    integer, intent(in) :: moved(:)                !< bodies; the first is named already
    character(:), allocatable :: text
    text = 'the ' // body_name(model, bodies%list(moved(2)))
    if (size(moved) == 3) text = join_item(text, 'the ' // body_name(model, bodies%list(moved(3))), .true.)
    if (size(moved) > 3) text = join_item(text, to_text(size(moved) - 2) // ' more', .true.)
  end function other_bodies


  !> Whether a body that can rotate at its position in the deck may be restrained after an earlier step under NLGEOM has moved it.
  !! A free translation is free at every position.
  pure logical function may_be_held_later(model, step, motions) result(may_be)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step
    real(DP), intent(in) :: motions(:, :)          !< (6, n) of one body
    integer :: i
    may_be = step > 1 .and. any(model%steps(:step)%is_nlgeom) .and. &
      .not. any([(is_translation(motions(:, i)), i=1, size(motions, 2))])
  end function may_be_held_later


  !> Whether damping holds free bodies: its factor is given, or is found in a first increment that contact does not change.
  pure logical function is_held_by_damping(model, step) result(is_held)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step
    is_held = is_damped(model%steps(step)) .and. (model%steps(step)%damping_factor > 0 .or. size(model%pairs) == 0)
  end function is_held_by_damping


  !> Missing restraint and remedy.
  pure function remedy_text(code) result(text)
    integer, intent(in) :: code                    !< FINDING_...
    character(:), allocatable :: text
    select case (code)
    case (FINDING_PLACED)
      text = ' as the deck places it: no support, no equation and no contact holds it there. Under NLGEOM it may be ' // &
        'held after the previous steps have moved it.'
    case (FINDING_DAMPED)
      text = ': only the damping of STABILIZE holds it, and it moves as far as its loads and the factor let it.'
    case (FINDING_OPEN)
      text = ' until its contact closes: what could hold it is open at the start. Proximal steps will move it to ' // &
        'first contact; to control this motion, prescribe a displacement.'
    case default
      text = ': no support, no equation and no contact holds it. Hold it by *BOUNDARY, or let it touch a body ' // &
        'that is held (only friction holds it along the surface).'
    end select
  end function remedy_text


  !> Adds a finding, or its step to an equal one.
  subroutine add_finding(finding, step, findings)
    type(finding_type), intent(in) :: finding      !< without steps
    integer, intent(in) :: step
    type(finding_type), allocatable, intent(inout) :: findings(:)
    integer :: i, n
    n = size(findings)
    do i = 1, n
      if (.not. is_same_finding(findings(i), finding)) cycle
      call findings(i)%steps%add(step)
      return
    end do
    findings = [findings, finding]
    call findings(n + 1)%steps%add(step)
  end subroutine add_finding


  !> Whether two findings are of the same motions of the same bodies, to the digits that are shown.
  pure logical function is_same_finding(a, b) result(is_same)
    type(finding_type), intent(in) :: a, b
    is_same = a%code == b%code .and. size(a%bodies) == size(b%bodies) .and. size(a%motions) == size(b%motions)
    if (is_same) is_same = all(a%bodies == b%bodies)
    if (is_same) is_same = maxval(abs(a%motions - b%motions)) <= MIN_MOTION_PART * maxval(abs(a%motions))
  end function is_same_finding

end module amontons_model_check_motion
