!> Model check: each error and warning, no false reports, and the description of free motions.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_model_check
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, diagnostic_list_type, EXIT_SETUP
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: finalize_mesh
  use amontons_surfaces, only: surface_type, interaction_type, contact_pair_type
  use amontons_loads, only: prescribed_type, concentrated_type, distributed_type, equation_type, &
    DISTRIBUTED_GRAVITY
  use amontons_steps, only: step_type
  use amontons_model, only: model_type
  use amontons_state, only: state_type, slave_state_type, create_state
  use amontons_contact_pairs, only: contact_type, create_contact
  use amontons_contact_initialization, only: initialize_contact
  use amontons_model_check, only: check_model, summarize_model
  use check, only: suite_type
  implicit none
  integer, parameter :: BOTTOM = 1, TOP = 2           ! faces S1 and S2 of C3D8
  type(suite_type) :: suite
  call check_free_body(suite)
  call check_partly_held(suite)
  call check_turned(suite)
  call check_contact_holds(suite)
  call check_chain(suite)
  call check_equations_hold(suite)
  call check_equations_conflict(suite)
  call check_many_bodies(suite)
  call check_elements(suite)
  call check_unattached_nodes(suite)
  call check_projection(suite)
  call check_depth(suite)
  call check_overlap(suite)
  call check_held_normal(suite)
  call check_summary(suite)
  call suite%finish()

contains

  !> An empty model with one elastic material, one frictionless and one rough interaction, and some steps.
  subroutine start_model(model, n_steps)
    type(model_type), intent(out) :: model
    integer, intent(in) :: n_steps
    integer :: i
    allocate (model%mesh%node_label(0), model%mesh%element_label(0), model%mesh%kind(0), model%mesh%nodes(0), &
      model%mesh%material(0), model%mesh%coordinates(3, 0), model%mesh%node_sets(0), model%mesh%element_sets(0))
    model%mesh%first = [1]
    allocate (model%materials(1), model%interactions(2), model%surfaces(0), model%pairs(0), model%amplitudes(0), &
      model%equations(0), model%steps(n_steps))
    model%materials(1)%name = 'STEEL'
    model%materials(1)%has_elastic = .true.
    model%interactions(2)%friction = 0.3_DP
    do i = 1, n_steps
      allocate (model%steps(i)%prescribed(0), model%steps(i)%concentrated(0), model%steps(i)%distributed(0))
    end do
  end subroutine start_model


  !> Adds a block of n(1) x n(2) x n(3) cubes of a size; labels are 1000 above the indices.
  subroutine add_block(model, corner, n, size_of)
    type(model_type), intent(inout) :: model
    real(DP), intent(in) :: corner(3)
    integer, intent(in) :: n(3)
    real(DP), intent(in) :: size_of
    integer :: i, j, k, base, row, layer
    integer :: nodes(8)
    real(DP) :: x(3)
    associate (mesh => model%mesh)
      base = mesh%n_nodes
      row = n(1) + 1
      layer = row * (n(2) + 1)
      do k = 0, n(3)
        do j = 0, n(2)
          do i = 0, n(1)
            x = corner + size_of * real([i, j, k], DP)
            mesh%coordinates = reshape([mesh%coordinates, x], [3, mesh%n_nodes + 1])
            mesh%n_nodes = mesh%n_nodes + 1
            mesh%node_label = [mesh%node_label, 1000 + mesh%n_nodes]
          end do
        end do
      end do
      do k = 0, n(3) - 1
        do j = 0, n(2) - 1
          do i = 0, n(1) - 1
            nodes(:4) = base + 1 + i + row * j + layer * k + [0, 1, 1 + row, row]
            nodes(5:) = nodes(:4) + layer
            mesh%nodes = [mesh%nodes, nodes]
            mesh%n_elements = mesh%n_elements + 1
            mesh%element_label = [mesh%element_label, 1000 + mesh%n_elements]
            mesh%kind = [mesh%kind, KIND_C3D8]
            mesh%material = [mesh%material, 1]
            mesh%first = [mesh%first, mesh%first(mesh%n_elements) + 8]
          end do
        end do
      end do
      if (allocated(mesh%section_value)) deallocate (mesh%section_value, mesh%directions, mesh%is_auxiliary)   ! outdated
    end associate
    call finalize_mesh(model%mesh)
  end subroutine add_block


  !> The surface of one face number of some elements; its name is a letter.
  subroutine add_surface(model, elements, face)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: elements(:), face
    type(surface_type), allocatable :: more(:)
    integer, parameter :: LOCAL(4, 2) = reshape([1, 2, 3, 4, 5, 6, 7, 8], [4, 2])
    logical, allocatable :: is_in(:)
    integer :: i, n
    n = size(model%surfaces)
    allocate (more(n + 1))
    more(:n) = model%surfaces
    allocate (is_in(model%mesh%n_nodes), source=.false.)
    do i = 1, size(elements)
      is_in(model%mesh%nodes(model%mesh%first(elements(i)) - 1 + LOCAL(:, face))) = .true.
    end do
    more(n + 1)%name = achar(iachar('A') + n)
    more(n + 1)%element = elements
    more(n + 1)%face = spread(face, 1, size(elements))
    more(n + 1)%nodes = pack([(i, i=1, size(is_in))], is_in)
    call move_alloc(more, model%surfaces)
  end subroutine add_surface


  subroutine add_pair(model, slave, master, interaction)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: slave, master, interaction
    type(contact_pair_type), allocatable :: more(:)
    integer :: n
    n = size(model%pairs)
    allocate (more(n + 1))
    more(:n) = model%pairs
    more(n + 1)%slave = slave
    more(n + 1)%master = master
    more(n + 1)%interaction = interaction
    call move_alloc(more, model%pairs)
  end subroutine add_pair


  !> Prescribes some displacement components of some nodes in a step.
  subroutine hold(model, step, nodes, dofs, amount)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: step, nodes(:), dofs(:)
    real(DP), intent(in), optional :: amount
    type(prescribed_type) :: load
    integer :: i, k
    if (present(amount)) load%end = amount
    do i = 1, size(nodes)
      do k = 1, size(dofs)
        load%node = nodes(i)
        load%dof = dofs(k)
        model%steps(step)%prescribed = [model%steps(step)%prescribed, load]
      end do
    end do
  end subroutine hold


  !> Loads a node by a downward force in the first step.
  subroutine press(model, node)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: node
    type(concentrated_type) :: load
    load%end = -1.0_DP
    load%node = node
    load%dof = 3
    model%steps(1)%concentrated = [model%steps(1)%concentrated, load]
  end subroutine press


  !> u(node(1), dof(1)) c(1) + ... = 0.
  subroutine add_equation(model, node, dof, coefficient)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: node(:), dof(:)
    real(DP), intent(in) :: coefficient(:)
    type(equation_type), allocatable :: more(:)
    integer :: n
    n = size(model%equations)
    allocate (more(n + 1))
    more(:n) = model%equations
    more(n + 1)%node = node
    more(n + 1)%dof = dof
    more(n + 1)%coefficient = coefficient
    more(n + 1)%line = 100 + n
    call move_alloc(more, model%equations)
  end subroutine add_equation


  !> Contact as at the start of the first increment.
  subroutine start_contact(model, contact, state)
    type(model_type), intent(in) :: model
    type(contact_type), intent(out) :: contact
    type(state_type), intent(out) :: state
    type(slave_state_type), allocatable :: slaves(:)
    type(error_type), allocatable :: error
    call create_contact(contact, model, slaves, error)
    if (allocated(error)) error stop 'the contact of a test cannot be made'
    call create_state(state, model%mesh, slaves)
    call initialize_contact(contact, model, model%steps(1)%is_nlgeom, .true., state%new%u, state%new)
  end subroutine start_contact


  !> Checks a model as the job does.
  subroutine audit(model, report, error)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(out) :: report
    type(error_type), allocatable, intent(out) :: error
    type(contact_type) :: contact
    type(state_type) :: state
    call start_contact(model, contact, state)
    call check_model(model, contact, state%new%slaves, report, error)
  end subroutine audit


  !> Checks a model: numbers of errors and warnings, and the text of one of the messages.
  subroutine expect(suite, name, model, n_errors, n_warnings, words)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: name
    type(model_type), intent(in) :: model
    integer, intent(in) :: n_errors, n_warnings
    character(*), intent(in) :: words                  !< empty: none
    type(diagnostic_list_type) :: report
    type(error_type), allocatable :: error
    logical :: is_said, is_right
    integer :: i
    call audit(model, report, error)
    is_said = words == ''
    do i = 1, report%n_items
      is_said = is_said .or. index(report%items(i)%text, words) > 0
    end do
    is_right = report%n_errors == n_errors .and. report%n_warnings == n_warnings
    call suite%that(name // ': counts', is_right)
    call suite%that(name // ': "' // words // '"', is_said)
    if (.not. (is_right .and. is_said)) then
      do i = 1, report%n_items
        print '(l2,1x,a)', report%items(i)%is_warning, report%items(i)%text
      end do
    end if
    call suite%that(name // ': verdict', allocated(error) .eqv. n_errors > 0)
    if (.not. allocated(error)) return
    call suite%that(name // ': exit code', error%code == EXIT_SETUP)
    call suite%that(name // ': last words', index(error%message, merge('1 error.', ' errors.', n_errors == 1)) > 0)
  end subroutine expect


  !> A cube without supports, in one step of two.
  subroutine check_free_body(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call start_model(model, 3)
    call add_block(model, [0.0_DP, 0.0_DP, 0.0_DP], [2, 1, 1], 1.0_DP)
    call hold(model, 2, [1, 2, 3, 4], [1, 2, 3])
    call expect(suite, 'a free body', model, 1, 0, &
      'In steps 1 and 3 the body of element 1001 (2 elements) can move and turn freely: no support')
    call hold(model, 1, [1, 2, 3, 4], [1, 2, 3])
    call expect(suite, 'free in the last step', model, 1, 0, 'In step 3 the body')
    call hold(model, 3, [1, 2, 3, 4], [1, 2, 3])
    call expect(suite, 'held in all steps', model, 0, 0, '')
  end subroutine check_free_body


  !> Supports that leave some motions free: their description.
  subroutine check_partly_held(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model, whole
    call start_model(whole, 1)
    call add_block(whole, [0.0_DP, 0.0_DP, 0.0_DP], [2, 2, 2], 1.0_DP)
    model = whole
    call hold(model, 1, [1, 2, 3, 4, 5], [3])
    call expect(suite, 'on a smooth table', model, 1, 0, &
      '(8 elements) can move along x, move along y and turn about z through its centre:')
    model = whole
    call hold(model, 1, [1, 10, 19], [1, 2, 3])
    call expect(suite, 'a hinge', model, 1, 0, 'can turn about z through the point (0, 0, 1):')
    model = whole
    call hold(model, 1, [1], [1, 2, 3])
    call expect(suite, 'a ball joint', model, 1, 0, 'can turn about ')
    model = whole
    call hold(model, 1, [1], [1, 2, 3])
    call hold(model, 1, [3], [2, 3])
    call hold(model, 1, [7], [3])
    call expect(suite, 'statically determinate', model, 0, 0, '')
    model = whole
    call hold(model, 1, [1, 3, 7], [2, 3])
    call hold(model, 1, [19], [3])
    call expect(suite, 'a slider', model, 1, 0, 'can move along x:')
  end subroutine check_partly_held


  !> The same in a model that is rotated, far from the origin, and small: the message has the direction.
  subroutine check_turned(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    real(DP), parameter :: TURN(3, 3) = reshape([0.6_DP, 0.8_DP, 0.0_DP, -0.8_DP, 0.6_DP, 0.0_DP, &
      0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    integer :: i
    call start_model(model, 1)
    call add_block(model, [0.0_DP, 0.0_DP, 0.0_DP], [4, 4, 1], 1.0e-3_DP)
    call add_block(model, [1.0e-3_DP, 1.0e-3_DP, 1.0e-3_DP], [3, 3, 1], 0.7e-3_DP)
    call add_surface(model, [(i, i=1, 16)], TOP)
    call add_surface(model, [(i, i=17, 25)], BOTTOM)
    call add_pair(model, 2, 1, 1)
    call hold(model, 1, [(i, i=1, 25)], [1, 2, 3])
    call add_equation(model, [70, 70], [1, 2], [0.8_DP, -0.6_DP])
    call add_equation(model, [76, 76], [1, 2], [0.8_DP, -0.6_DP])
    model%mesh%coordinates = matmul(TURN, model%mesh%coordinates) + 2.0_DP
    call expect(suite, 'turned and small', model, 1, 0, '(9 elements) can move along (0.6, 0.8, 0):')
    model%mesh%coordinates = anint(model%mesh%coordinates * 1.0e9_DP) * 1.0e-9_DP
    call expect(suite, 'coordinates rounded as in a deck', model, 1, 0, '(9 elements) can move along (0.6, 0.8, 0):')
  end subroutine check_turned


  !> A block on a supported one: free to slide without friction, restrained with friction; open contact gives a warning.
  subroutine check_contact_holds(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call two_blocks(model, 0.0_DP, 1)
    call expect(suite, 'on a smooth block', model, 1, 0, &
      'body of element 1010 (4 elements) can move along x, move along y and turn about z through its centre: no')
    call two_blocks(model, 0.0_DP, 2)
    call expect(suite, 'on a rough block', model, 0, 0, '')
    deallocate (model%steps(1)%concentrated)
    allocate (model%steps(1)%concentrated(0))
    call expect(suite, 'not pressed on it', model, 0, 1, 'Nothing but contact holds the body of element 1010 (4 elements)')
    call two_blocks(model, 0.1_DP, 2)
    call expect(suite, 'above a rough block', model, 0, 1, '(4 elements) can move and turn freely until its ' // &
      'contact closes')
    call hold(model, 1, [42, 44, 48], [1, 2, 3], -0.1_DP)
    call expect(suite, 'driven onto it', model, 0, 0, '')
  end subroutine check_contact_holds


  !> A supported block of 9 cubes with surface A (top); a gap above its middle, a block of 4 smaller cubes: nodes 33 to 50,
  !! surface B (bottom), pressed on it.
  subroutine two_blocks(model, gap, interaction)
    type(model_type), intent(out) :: model
    real(DP), intent(in) :: gap
    integer, intent(in) :: interaction
    integer :: i
    call start_model(model, 1)
    call add_block(model, [0.0_DP, 0.0_DP, 0.0_DP], [3, 3, 1], 1.0_DP)
    call add_block(model, [0.9_DP, 0.9_DP, 1.0_DP + gap], [2, 2, 1], 0.6_DP)
    call add_surface(model, [(i, i=1, 9)], TOP)
    call add_surface(model, [(i, i=10, 13)], BOTTOM)
    call add_pair(model, 2, 1, interaction)
    call hold(model, 1, [(i, i=1, 16)], [1, 2, 3])
    call press(model, 50)
  end subroutine two_blocks


  !> Three bodies: friction couples the upper two, which slide together on the lowest.
  subroutine check_chain(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    integer :: i
    call two_blocks(model, 0.0_DP, 1)
    call add_block(model, [1.0_DP, 1.0_DP, 1.6_DP], [1, 1, 1], 0.8_DP)
    call press(model, 58)
    call add_surface(model, [(i, i=10, 13)], TOP)
    call add_surface(model, [14], BOTTOM)
    call add_pair(model, 4, 3, 2)
    call expect(suite, 'two of three slide', model, 1, 0, 'In step 1 the body of element 1010 (4 elements) and ' // &
      'with it the ' // &
      'body of element 1014 (1 element) can move along x, move along y and turn about z')
    model%pairs(2)%interaction = 1
    model%pairs(1)%interaction = 2
    call expect(suite, 'the last of three slides', model, 1, 0, 'In step 1 the body of element 1014 (1 element) ' // &
      'can move along x, ' // &
      'move along y and turn about z')
  end subroutine check_chain


  !> Equations to a node without elements restrain a body if that node is prescribed, else not.
  subroutine check_equations_hold(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    integer :: i, k
    call start_model(model, 1)
    call add_block(model, [0.0_DP, 0.0_DP, 0.0_DP], [1, 1, 1], 1.0_DP)
    call add_block(model, [5.0_DP, 0.0_DP, 0.0_DP], [0, 0, 0], 1.0_DP)
    do i = 1, 3
      do k = 1, 3
        call add_equation(model, [i, 9], [k, k], [1.0_DP, -1.0_DP])
      end do
    end do
    call expect(suite, 'tied to a free node', model, 1, 0, &
      'the body of element 1001 (1 element) and with it the node 1009 (without elements) can move along x, move ' // &
      'along y and')
    call hold(model, 1, [9], [1, 2, 3], 0.1_DP)
    call expect(suite, 'tied to a driven node', model, 0, 0, '')
    model%equations(9)%dof = 2                          ! node 3 is free along z, and its y is tied twice
    call expect(suite, 'one direction missing', model, 1, 1, 'can turn about x through the point (0.5, 0, 0):')
  end subroutine check_equations_hold


  !> Equations that contradict supports and one another.
  subroutine check_equations_conflict(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    integer :: k
    call start_model(model, 2)
    call add_block(model, [0.0_DP, 0.0_DP, 0.0_DP], [1, 1, 1], 1.0_DP)
    do k = 1, 2
      call hold(model, k, [1, 2, 3, 4], [1, 2, 3])
    end do
    call add_equation(model, [5, 6], [3, 3], [1.0_DP, -1.0_DP])
    call add_equation(model, [6, 5], [3, 3], [1.0_DP, -1.0_DP])
    call expect(suite, 'a cycle of equations', model, 0, 1, 'In step 1 1 equation (*EQUATION of line 101)')
    model%equations = model%equations(:1)
    call hold(model, 2, [5], [3], 0.1_DP)
    call hold(model, 2, [6], [3], 0.2_DP)
    call expect(suite, 'a conflict', model, 1, 0, 'In step 2 the *EQUATION of line 100 contradicts')
    model%steps(2)%prescribed(14)%end = 0.1_DP
    call expect(suite, 'no conflict', model, 0, 1, 'In step 2 1 equation (*EQUATION of line 100)')
    model%steps(2)%prescribed(14)%is_held = .true.
    call expect(suite, 'held where the solution has brought it', model, 0, 0, '')
  end subroutine check_equations_conflict


  !> A tower of 200 cubes with friction: one cluster of 1200 motions, 6 of them free; the cost stays low.
  subroutine check_many_bodies(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    integer, parameter :: N = 200
    integer :: i, clock(2), rate
    call start_model(model, 1)
    do i = 1, N
      call add_block(model, [0.01_DP * real(mod(i, 2), DP), 0.0_DP, real(i, DP)], [1, 1, 1], 1.0_DP)
    end do
    do i = 1, N - 1
      call add_surface(model, [i], TOP)
      call add_surface(model, [i + 1], BOTTOM)
      call add_pair(model, 2 * i, 2 * i - 1, 2)
    end do
    call press(model, 8 * N)
    call system_clock(clock(1), rate)
    call expect(suite, 'a tower', model, 1, 0, &
      'body of element 1001 (1 element) and with it the body of element 1002 (1 element) and 198 more can move ' // &
      'and turn freely')
    call system_clock(clock(2))
    call suite%that('200 bodies in less than 20 s', real(clock(2) - clock(1), DP) / real(rate, DP) < 20.0_DP)
    call hold(model, 1, [1, 2, 3, 4], [1, 2, 3])
    call expect(suite, 'a tower that stands', model, 0, 0, '')
  end subroutine check_many_bodies


  !> Volumes, materials, gravity.
  subroutine check_elements(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model, good
    type(distributed_type) :: gravity
    call start_model(good, 1)
    call add_block(good, [0.0_DP, 0.0_DP, 0.0_DP], [12, 1, 1], 1.0_DP)
    call hold(good, 1, [1, 2, 3, 14], [1, 2, 3])
    model = good
    model%mesh%nodes(9:16) = [model%mesh%nodes(13:16), model%mesh%nodes(9:12)]
    call expect(suite, 'one element inside out', model, 1, 0, 'The volume of element 1002 is zero or negative')
    model%mesh%coordinates(3, :) = -model%mesh%coordinates(3, :)
    call expect(suite, 'all but one inside out', model, 1, 0, &
      'The volume of 11 elements (1001, 1003, 1004, 1005, 1006, 1007, 1008, 1009, 1010, 1011 and 1 more) is zero')
    model = good
    model%materials(1)%has_elastic = .false.
    call expect(suite, 'no elasticity', model, 1, 0, 'The material STEEL is used by a *SOLID SECTION but has no ' // &
      '*ELASTIC.')
    model = good
    model%mesh%material(3:4) = 0
    call expect(suite, 'no section', model, 1, 0, 'No material is given for 2 elements (1003 and 1004).')
    model = good
    gravity%kind = DISTRIBUTED_GRAVITY
    gravity%element = 5
    model%steps(1)%distributed = [gravity]
    call expect(suite, 'weight without density', model, 1, 0, 'Gravity (*DLOAD, GRAV) acts on elements of the ' // &
      'material STEEL')
    model%materials(1)%has_density = .true.
    call expect(suite, 'weight', model, 0, 0, '')
  end subroutine check_elements


  !> A support and a force at a node without elements.
  subroutine check_unattached_nodes(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(concentrated_type) :: load
    call start_model(model, 1)
    call add_block(model, [0.0_DP, 0.0_DP, 0.0_DP], [1, 1, 1], 1.0_DP)
    call add_block(model, [5.0_DP, 0.0_DP, 0.0_DP], [0, 0, 0], 1.0_DP)
    call hold(model, 1, [1, 2, 3], [1, 2, 3])
    call expect(suite, 'a node that nothing uses', model, 0, 0, '')
    call hold(model, 1, [9], [1, 2])
    call expect(suite, 'a support alone', model, 0, 1, 'A displacement (*BOUNDARY) is given for 1 node without ' // &
      'elements (1009)')
    load%node = 9
    load%dof = 1
    load%end = 1.0_DP
    model%steps(1)%concentrated = [load]
    call expect(suite, 'a force alone', model, 0, 2, 'A force (*CLOAD) acts on 1 node without elements (1009)')
  end subroutine check_unattached_nodes


  !> Pairs that do not face each other, or are too far apart.
  subroutine check_projection(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    integer :: i
    call two_blocks(model, 0.0_DP, 2)
    call hold(model, 1, [42, 44, 48], [1, 2, 3], -0.1_DP)
    call expect(suite, 'a pair in order', model, 0, 0, '')
    model%mesh%coordinates(3, 33:50) = model%mesh%coordinates(3, 33:50) + 10.0_DP
    call expect(suite, 'far apart', model, 1, 0, &
      'None of the 9 slave nodes of the contact pair B / A projects on the master at the start: the surfaces')
    model%steps(1)%is_nlgeom = .true.
    model%steps(1)%prescribed(49:)%end = -20.0_DP
    call expect(suite, 'far apart, but driven', model, 0, 1, 'may bring the surfaces together later')
    model%mesh%coordinates(3, 33:50) = model%mesh%coordinates(3, 33:50) - 10.0_DP
    model%mesh%coordinates(1, 33:50) = model%mesh%coordinates(1, 33:50) + 1.5_DP
    call expect(suite, 'overhang', model, 0, 1, '3 of the 9 slave nodes of the contact pair B / A do not project')
    call two_blocks(model, 0.0_DP, 2)
    call hold(model, 1, [33, 35, 39], [1, 2, 3])
    call add_surface(model, [(i, i=10, 13)], TOP)
    model%pairs(1)%slave = 3
    call expect(suite, 'the wrong face', model, 1, 0, &
      'The surfaces of the contact pair C / A face the same way at 9 of 9 slave nodes near the master')
  end subroutine check_projection


  !> Penetration at the start.
  subroutine check_depth(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call two_blocks(model, -0.0005_DP, 2)
    call expect(suite, 'a scratch', model, 0, 0, '')
    call two_blocks(model, -0.25_DP, 2)
    call expect(suite, 'penetration', model, 0, 1, 'lies 0.25 inside the master at the start, where an edge is ' // &
      '1 long; this')
    call two_blocks(model, -0.6_DP, 2)
    call expect(suite, 'deep penetration', model, 1, 0, 'are probably swapped, on the wrong side')
  end subroutine check_depth


  !> Surfaces with common nodes.
  subroutine check_overlap(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call two_blocks(model, 0.0_DP, 2)
    call add_surface(model, [5], TOP)
    call hold(model, 1, [42, 44, 48], [1, 2, 3])
    model%pairs(1)%slave = 3
    call expect(suite, 'both sides of a pair', model, 1, 0, &
      '4 nodes (1022, 1023, 1026 and 1027) belong to both surfaces of the contact pair C / A')
  end subroutine check_overlap


  !> Slave nodes with supports along the normal.
  subroutine check_held_normal(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call two_blocks(model, 0.0_DP, 2)
    call hold(model, 1, [33], [1, 2])
    call expect(suite, 'held across the normal', model, 0, 0, '')
    call hold(model, 1, [33, 34], [3])
    call expect(suite, 'held along the normal', model, 0, 1, &
      'is held by a support or an equation at 2 slave nodes of the contact pair B / A (1033 and 1034): the ' // &
      'contact cannot')
  end subroutine check_held_normal


  !> The tables of --check.
  subroutine check_summary(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(contact_type) :: contact
    type(state_type) :: state
    character(:), allocatable :: text
    call two_blocks(model, 0.0_DP, 2)
    model%materials(1)%has_density = .true.
    model%materials(1)%density = 2.0_DP
    call start_contact(model, contact, state)
    call summarize_model(model, contact, state%new%slaves, text)
    call says(suite, text, 'nodes                   50')
    call says(suite, text, '13   C3D8 13')
    call says(suite, text, '150   48 prescribed in step 1')
    call says(suite, text, 'body of element 1001 (9 elements), volume 9, mass 18')
    call says(suite, text, '9         9         9         0         0            0            0       0.3  B / A')
    call says(suite, text, '1: small displacements, period 1, first increment 1, at most 100 increments')

  end subroutine check_summary


  subroutine says(suite, text, words)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: text, words
    call suite%that('the summary says "' // words // '"', index(text, words) > 0)
    if (index(text, words) == 0) print '(a)', text
  end subroutine says

end program test_model_check
