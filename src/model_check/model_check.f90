!> Model check before the first step: elements, materials, constraints, contact, unsupported bodies; and the model summary.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! All errors and warnings are reported together, before the first step. Messages and remedies: doc/manual/messages.md.
!!
!! A body that only contact from one side supports needs a load that presses it against its master.
!! A contact force lies within the friction cone about its normal n. If for some direction t all normals on a body
!! have n't > mu sqrt(1 - (n't)^2), every contact force on it has a part along t. Without supports and loads the only
!! equilibrium is then without contact. t is the mean of the normals. Cost: linear in nodes and slaves.
module amontons_model_check
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, diagnostic_list_type, set_error, EXIT_SETUP
  use amontons_text, only: to_text, plural, NEWLINE
  use amontons_containers, only: integer_list_type
  use amontons_element_kinds, only: element_kind, element_kind_type, is_cohesive, KIND_SPRINGA, N_KINDS
  use amontons_element, only: evaluate_element_volume, ELEMENT_OK
  use amontons_mesh, only: mesh_type, wall_ratios
  use amontons_loads, only: equation_type, load_value, integrated_velocity, DISTRIBUTED_PRESSURE, DISTRIBUTED_GRAVITY, &
    DISTRIBUTED_CENTRIFUGAL, &
    DISTRIBUTED_BODY_FORCE, DISTRIBUTED_TRACTION
  use amontons_steps, only: step_type
  use amontons_model, only: model_type, dof_direction, n_nonlinear_mpcs
  use amontons_mpc_data, only: MPC_RIGID_BODY
  use amontons_slave_node_overrides, only: gives_way
  use amontons_state, only: slave_state_type
  use amontons_nonlinear_mpc, only: linear_equations
  use amontons_constraints, only: constraints_type, constraint_row_type, reset_constraints, prescribe_unknown, &
    add_constraint_row, ROW_REDUNDANT, &
    ROW_CONFLICT
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_contact_pairs, only: contact_type, current_row
  use amontons_model_check_bodies, only: report_error, report_warning, counted_noun, label_list, bodies_type, find_bodies, &
    weigh_bodies, body_name, line_of_nodes
  use amontons_model_check_contact, only: check_contact, collect_pair_statistics, pair_statistics_type, is_closed
  use amontons_model_check_motion, only: check_rigid_motions
  use amontons_model_check_unpaired, only: check_unpaired_bodies
  implicit none
  private
  public :: check_model, summarize_model

  real(DP), parameter :: TOL_EQUAL_DISPLACEMENT = 1.0e-9_DP          !< difference of equal displacements, over the largest [-]

contains

  !> Runs all checks. Errors: EXIT_SETUP if the report contains an error; the report names each. Cost: linear, except for bodies
  !! that contact couples (amontons_model_check_motion).
  subroutine check_model(model, contact, slaves, report, error)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)      !< at the start of the first increment: facet, gap and normal are set
    type(diagnostic_list_type), intent(inout) :: report
    type(error_type), allocatable, intent(out) :: error
    call check_volumes(model, report)
    call check_materials(model, report)
    call check_equations(model, report)
    call check_idle_moments(model, report)
    call check_contact(model, contact, slaves, report)
    if (report%n_errors == 0) call check_unpaired_bodies(model, report)   ! a faulty pair may be the one that joins them
    call check_bodies(model, contact, slaves, report)
    if (report%n_errors > 0) call set_error(error, EXIT_SETUP, 'The model check found ' // &
      plural(report%n_errors, 'error') // '. No step was started.')
  end subroutine check_model


  !> Checks nodes without elements and free rigid body motions.
  subroutine check_bodies(model, contact, slaves, report)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    type(diagnostic_list_type), intent(inout) :: report
    type(equation_type), allocatable :: equations(:)
    type(bodies_type) :: bodies
    call linear_equations(model, equations)
    call find_bodies(model, equations, 1, bodies)
    call check_unattached_nodes(model, bodies, report)
    call check_rigid_motions(model, contact, slaves, bodies, report)
    call check_unilateral_support(model, contact, slaves, bodies, report)
  end subroutine check_bodies


  !> Finds elements whose volume is not positive at all integration points.
  subroutine check_volumes(model, report)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(inout) :: report
    type(integer_list_type) :: bad
    logical, allocatable :: is_sound(:)
    integer :: e
    allocate (is_sound(model%mesh%n_elements))
    !$omp parallel do schedule(static)
    do e = 1, model%mesh%n_elements
      is_sound(e) = has_sound_volume(model%mesh, e)
    end do
    !$omp end parallel do
    do e = 1, model%mesh%n_elements
      if (.not. is_sound(e)) call bad%add(model%mesh%element_label(e))
    end do
    if (bad%n > 0) call report_error(report, 'The volume of ' // counted_noun('element', bad%trimmed(), 'is', 'is') // &
      ' zero or negative at an integration point. Check the order of the nodes (the first face counts round the ' // &
      'direction to the opposite one by the right-hand rule), and move nodes that make an element fold or collapse.')
  end subroutine check_volumes


  !> Whether the volume of an element is positive at all of its integration points; true without such points.
  pure logical function has_sound_volume(mesh, e) result(is_sound)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element
    real(DP) :: volume
    integer :: status
    associate (nodes => mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))
      call evaluate_element_volume(mesh%kind(e), mesh%coordinates(:, nodes), mesh%section_value(e), volume, status, &
        wall_ratios(mesh, e))
    end associate
    is_sound = status == ELEMENT_OK
    if (mesh%point_first(e + 1) > mesh%point_first(e)) is_sound = is_sound .and. volume > 0.0_DP
  end function has_sound_volume


  !> Finds elements without a material, materials without *ELASTIC, and gravity on elements without density.
  subroutine check_materials(model, report)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(inout) :: report
    type(integer_list_type) :: none
    logical, allocatable :: is_used(:), is_heavy(:)
    integer :: e, i, k, m
    allocate (is_used(size(model%materials)), is_heavy(size(model%materials)), source=.false.)
    do e = 1, model%mesh%n_elements
      if (model%mesh%kind(e) >= KIND_SPRINGA .and. .not. is_cohesive(model%mesh%kind(e))) cycle   ! need no material
      if (model%mesh%material(e) == 0) then
        call none%add(model%mesh%element_label(e))
      else
        is_used(model%mesh%material(e)) = .true.
      end if
    end do
    if (none%n > 0) call report_error(report, 'No material is given for ' // plural(none%n, 'element') // ' (' // &
      label_list(none%trimmed()) // '). Add a *SOLID SECTION for them.')
    do i = 1, size(model%steps)
      if (allocated(model%steps(i)%material)) then
        associate (later => pack(model%steps(i)%material, model%steps(i)%material > 0))
          is_used(later) = .true.
        end associate
      end if
      do k = 1, size(model%steps(i)%distributed)
        associate (load => model%steps(i)%distributed(k))
          m = model%mesh%material(load%element)
          if (any(load%kind == [DISTRIBUTED_GRAVITY, DISTRIBUTED_CENTRIFUGAL]) .and. m > 0) is_heavy(m) = .true.
        end associate
      end do
    end do
    do m = 1, size(model%materials)
      if (is_used(m) .and. .not. (model%materials(m)%has_elastic .or. model%materials(m)%is_user)) &
        call report_error(report, 'The material ' // model%materials(m)%name // &
        ' is used by a *SOLID SECTION but has no *ELASTIC. Give it E and nu.')
      if (is_heavy(m) .and. .not. model%materials(m)%has_density) call report_error(report, &
        'Gravity (*DLOAD, GRAV) acts on elements of the material ' // model%materials(m)%name // &
        ', which has no *DENSITY. Give it one.')
    end do
  end subroutine check_materials


  !> Moments on a rigid body about the line on which all its nodes lie: they turn nothing, so that they would be lost.
  subroutine check_idle_moments(model, report)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(inout) :: report
    real(DP), parameter :: TOL_IDLE = 1.0e-6_DP    !< part of a moment about the line, distance from the line over its length [-]
    real(DP) :: axis(3)
    integer :: i, k
    do i = 1, n_nonlinear_mpcs(model)
      associate (mpc => model%nonlinear_mpcs(i))
        if (mpc%kind /= MPC_RIGID_BODY .or. mpc%expansion > 0 .or. .not. all(mpc%is_bound)) cycle
        axis = line_of_nodes(model%mesh%coordinates(:, [mpc%reference, mpc%node]), TOL_IDLE)
        if (.not. norm2(axis) > 0 .or. is_turned_elsewhere(model, i)) cycle
        do k = 1, size(model%steps)
          if (.not. abs(dot_product(sum_of_forces(model, k, mpc%rotation), axis)) > TOL_IDLE * norm2(sum_of_forces(model, k, &
            mpc%rotation))) cycle
          call report_error(report, 'In step ' // to_text(k) // ' a moment on the node ' // &
            to_text(model%mesh%node_label(mpc%reference)) // ' acts about the line on which all nodes of its *' // mpc%card // &
            ' (line ' // to_text(mpc%line) // ') lie: it turns nothing. Hold this rotation, or bind a node beside the ' // &
            'line, or at shells and beams their rotations (TIE NSET).')
          return
        end do
      end associate
    end do
  end subroutine check_idle_moments


  !> Whether other constraints than the nonlinear MPC i, or shells and beams, contain its rotation node.
  pure logical function is_turned_elsewhere(model, i) result(is_turned)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i                       !< a rigid body
    integer :: k
    associate (node => model%nonlinear_mpcs(i)%rotation)
      is_turned = any(model%mesh%nodes == node)
      if (allocated(model%user_elements)) then
        do k = 1, size(model%user_elements%elements)
          is_turned = is_turned .or. any(model%user_elements%elements(k)%nodes == node)
        end do
      end if
      do k = 1, size(model%equations)
        is_turned = is_turned .or. any(model%equations(k)%node == node)
      end do
      do k = 1, n_nonlinear_mpcs(model)
        if (k == i) cycle
        associate (other => model%nonlinear_mpcs(k))
          is_turned = is_turned .or. other%rotation == node .or. other%reference == node .or. any(other%node == node)
        end associate
      end do
    end associate
  end function is_turned_elsewhere


  !> The sum of the concentrated forces on a node at the end of a step; 0 if its displacement is prescribed.
  pure function sum_of_forces(model, step, node) result(force)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step, node
    real(DP) :: force(3)
    integer :: i
    force = 0
    associate (forces => model%steps(step)%concentrated)
      if (any(model%steps(step)%prescribed%node == node)) return
      do i = 1, size(forces)
        if (forces(i)%node == node) force = force + forces(i)%end * dof_direction(model, node, forces(i)%dof)
      end do
    end associate
  end function sum_of_forces


  !> Warns of nodes without elements and equations that have loads or supports: these have no effect.
  subroutine check_unattached_nodes(model, bodies, report)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(diagnostic_list_type), intent(inout) :: report
    type(integer_list_type) :: loaded, held
    logical, allocatable :: was_loaded(:), was_held(:)
    integer :: i, k
    allocate (was_loaded(model%mesh%n_nodes), was_held(model%mesh%n_nodes), source=.false.)
    do i = 1, size(model%steps)
      associate (nodes => model%steps(i)%distributed%node)
        was_held(pack(nodes, nodes > 0)) = .true.    ! their displacement is a pressure
      end associate
    end do
    if (allocated(model%user_elements)) then
      do i = 1, size(model%user_elements%elements)   ! their rotation nodes
        was_loaded(model%user_elements%elements(i)%nodes) = .true.
        was_held(model%user_elements%elements(i)%nodes) = .true.
      end do
    end if
    do i = 1, size(model%steps)
      do k = 1, size(model%steps(i)%concentrated)
        call add_node_once(model%steps(i)%concentrated(k)%node, was_loaded, loaded)
      end do
      do k = 1, size(model%steps(i)%prescribed)
        call add_node_once(model%steps(i)%prescribed(k)%node, was_held, held)
      end do
    end do
    if (loaded%n > 0) call report_warning(report, 'A force (*CLOAD) acts on ' // plural(loaded%n, 'node') // &
      ' without elements (' // label_list(loaded%trimmed()) // '): it has no effect. Check the node labels of ' // &
      'the load.')
    if (held%n > 0) call report_warning(report, 'A displacement (*BOUNDARY) is given for ' // plural(held%n, 'node') // &
      ' without elements (' // label_list(held%trimmed()) // '): it has no effect. Check the node labels ' // &
      'of the support.')

  contains

    !> Adds a node to the list, once, if it belongs to no body.
    subroutine add_node_once(node, was_noted, list)
      integer, intent(in) :: node
      logical, intent(inout) :: was_noted(:)
      type(integer_list_type), intent(inout) :: list
      if (bodies%of_node(node) > 0 .or. was_noted(node)) return
      was_noted(node) = .true.
      if (allocated(model%springs)) then
        if (any(model%springs%length_node == node)) return   ! length node of a spring: CalculiX requires a support
      end if
      call list%add(model%mesh%node_label(node))
    end subroutine add_node_once

  end subroutine check_unattached_nodes


  !> Equations that contradict the supports at the end of a step or one another (errors), or are redundant (warnings).
  subroutine check_equations(model, report)
    type(model_type), intent(in) :: model
    type(diagnostic_list_type), intent(inout) :: report
    type(constraints_type) :: constraints
    type(integer_list_type) :: idle
    integer, allocatable :: reported(:)            ! (n_equations) the strongest verdict reported
    real(DP), allocatable :: u(:, :)               ! prescribed displacements at the end of the step
    logical, allocatable :: is_known(:, :)
    real(DP) :: largest
    integer :: i, k, row_verdict
    logical :: is_whole
    integer :: n_idle
    character(:), allocatable :: cards             ! of the redundant equations, each once
    if (size(model%equations) == 0) return
    allocate (reported(size(model%equations)), source=0)
    allocate (u(3, model%mesh%n_nodes), source=0.0_DP)
    allocate (is_known(3, model%mesh%n_nodes), source=.false.)
    do i = 1, size(model%steps)
      call build_step_constraints(model, i, u, is_known, is_whole, constraints)
      largest = maxval(abs(u), mask=is_known)
      idle = integer_list_type()
      n_idle = 0
      cards = ''
      do k = 1, size(model%equations)
        if (model%equations(k)%last_step < i) cycle
        call add_equation(model, k, largest, constraints, row_verdict)
        if (row_verdict == ROW_CONFLICT .and. .not. is_whole) cycle
        if (row_verdict == ROW_CONFLICT .and. reported(k) < ROW_CONFLICT) call report_error(report, 'In step ' // to_text(i) // &
          ' the *' // trim(model%equations(k)%card) // ' of line ' // &
          to_text(model%equations(k)%line) // ' contradicts the prescribed displacements ' // &
          'of its nodes or the equations before it. Release one of them.')
        if (row_verdict == ROW_REDUNDANT .and. reported(k) == 0) call note_idle(model%equations(k))
        reported(k) = max(reported(k), row_verdict)
      end do
      if (n_idle > 0) call report_warning(report, 'In step ' // to_text(i) // ' ' // plural(n_idle, 'equation') // &
        ' (' // cards // ' of line ' // label_list(idle%trimmed()) // ') dropped: supports and the equations before hold ' // &
        'all terms already.')
    end do

  contains

    !> Counts a redundant equation; its card and its line are noted once.
    subroutine note_idle(equation)
      type(equation_type), intent(in) :: equation
      n_idle = n_idle + 1
      if (index(cards, '*' // trim(equation%card)) == 0) cards = cards // merge('  ', ', ', cards == '') // '*' // &
        trim(equation%card)
      cards = trim(adjustl(cards))
      if (.not. any(idle%trimmed() == equation%line)) call idle%add(equation%line)
    end subroutine note_idle

  end subroutine check_equations


  !> The constraints of a step without the equations.
  subroutine build_step_constraints(model, step, u, is_known, is_whole, constraints)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step
    real(DP), intent(inout) :: u(:, :)             !< (3, n_nodes) at the end of this step, where known [length]
    logical, intent(inout) :: is_known(:, :)       !< (3, n_nodes) prescribed now, or when it was fixed
    logical, intent(out) :: is_whole               !< no unknown is fixed at a computed displacement
    type(constraints_type), intent(inout) :: constraints
    logical, allocatable :: is_prescribed(:, :)
    integer :: i
    allocate (is_prescribed(3, model%mesh%n_nodes))
    call reset_constraints(constraints, 3 * model%mesh%n_nodes)
    is_whole = .true.
    is_prescribed = .false.
    do i = 1, size(model%steps(step)%prescribed)
      associate (load => model%steps(step)%prescribed(i), period => model%steps(step)%period)
        if (maxval(dof_direction(model, load%node, load%dof)) < 1.0_DP) cycle   ! in a rotated direction
        if (load%is_held) then
          if (step == 1) is_known(load%dof, load%node) = .true.
          is_whole = is_whole .and. is_known(load%dof, load%node)
        else if (load%is_velocity) then
          if (step == 1) is_known(load%dof, load%node) = .true.
          u(load%dof, load%node) = u(load%dof, load%node) + integrated_velocity(load, model%amplitudes, period, &
            sum(model%steps(:step)%period))
          is_whole = is_whole .and. is_known(load%dof, load%node)
        else
          u(load%dof, load%node) = load_value(load, model%amplitudes, period, sum(model%steps(:step)%period), period)
          is_known(load%dof, load%node) = .true.
        end if
        is_prescribed(load%dof, load%node) = is_known(load%dof, load%node)
        call prescribe_unknown(constraints, 3 * (load%node - 1) + load%dof, u(load%dof, load%node))
      end associate
    end do
    is_known = is_prescribed
  end subroutine build_step_constraints


  !> Adds one equation; returns whether it is independent, redundant or in conflict.
  subroutine add_equation(model, k, largest, constraints, row_verdict)
    type(model_type), intent(in) :: model
    integer, intent(in) :: k
    real(DP), intent(in) :: largest                !< largest prescribed displacement [length]
    type(constraints_type), intent(inout) :: constraints
    integer, intent(out) :: row_verdict                !< ROW_...
    type(constraint_row_type) :: row
    real(DP) :: tolerance
    associate (equation => model%equations(k))
      row%unknown = 3 * (equation%node - 1) + equation%dof
      row%coefficient = equation%coefficient
      tolerance = TOL_EQUAL_DISPLACEMENT * max(largest, 0.0_DP) * sum(abs(equation%coefficient)) + tiny(1.0_DP)
      call add_constraint_row(constraints, row, equation%n_eliminable, tolerance, row_verdict)
    end associate
  end subroutine add_equation


  !> Model summary as tables: mesh, materials, bodies, contact pairs, steps.
  subroutine summarize_model(model, contact, slaves, text)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)      !< at the start of the first increment
    character(:), allocatable, intent(out) :: text
    type(bodies_type) :: bodies
    call find_bodies(model, model%equations, 1, bodies)
    call weigh_bodies(model, 1, bodies)
    text = mesh_table(model) // material_table(model) // body_table(model, bodies, contact, slaves)
    if (size(model%pairs) > 0) text = text // pair_table(model, contact, slaves)
    text = text // step_table(model)
    text = text(:len(text) - len(NEWLINE))
  end subroutine summarize_model


  !> Nodes, elements by kind, unknowns.
  function mesh_table(model) result(text)
    type(model_type), intent(in) :: model
    character(:), allocatable :: text
    type(element_kind_type) :: kind
    integer :: k, n
    text = table_entry('nodes', model%mesh%n_nodes) // NEWLINE // table_entry('elements', model%mesh%n_elements)
    do k = 1, N_KINDS
      n = count(model%mesh%kind == k)
      kind = element_kind(k)
      if (n > 0) text = text // '   ' // trim(kind%name) // ' ' // to_text(n)
    end do
    text = text // NEWLINE // table_entry('unknowns', 3 * model%mesh%n_nodes)
    if (size(model%steps) > 0) text = text // '   ' // to_text(size(model%steps(1)%prescribed)) // &
      ' prescribed in step 1'
    if (size(model%equations) > 0) text = text // ', ' // plural(size(model%equations), 'equation')
    text = text // NEWLINE
  end function mesh_table


  !> One line for each material.
  function material_table(model) result(text)
    type(model_type), intent(in) :: model
    character(:), allocatable :: text
    integer :: m
    text = table_entry('materials', size(model%materials)) // NEWLINE
    do m = 1, size(model%materials)
      associate (material => model%materials(m))
        text = text // '    ' // material%name
        if (material%has_elastic) text = text // ', E ' // to_text(material%youngs_modulus) // ', nu ' // &
          to_text(material%poissons_ratio)
        if (material%is_user) text = text // ', of the user, at rest as E ' // to_text(material%youngs_modulus) // ', nu ' // &
          to_text(material%poissons_ratio)
        if (material%has_density) text = text // ', density ' // to_text(material%density)
        text = text // NEWLINE
      end associate
    end do
  end function material_table


  !> One line for each body.
  function body_table(model, bodies, contact, slaves) result(text)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    character(:), allocatable :: text
    integer, parameter :: MAX_BODY_LINES = 50                ! lines; of the other bodies only the number appears
    integer :: b
    text = table_entry('bodies', bodies%n) // NEWLINE
    do b = 1, min(bodies%n, MAX_BODY_LINES)
      text = text // '    ' // body_name(model, bodies%list(b))
      if (bodies%list(b)%n_elements > 0) text = text // ', volume ' // to_text(bodies%list(b)%volume)
      if (bodies%list(b)%mass > 0.0_DP) text = text // ', mass ' // to_text(bodies%list(b)%mass)
      if (size(model%steps) > 0) text = text // restraint_text(model, bodies, contact, slaves, b)
      text = text // NEWLINE
    end do
    if (bodies%n > MAX_BODY_LINES) text = text // '    and ' // to_text(bodies%n - MAX_BODY_LINES) // ' more' // NEWLINE
  end function body_table


  !> Restraints of a body in step 1: supports, equations and similar constraints, contact.
  function restraint_text(model, bodies, contact, slaves, b) result(text)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(in) :: bodies
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: b                       !< body
    character(:), allocatable :: text
    integer :: k, p, n, n_closed(size(model%pairs)), n_open(size(model%pairs))
    text = ''
    n = count(bodies%of_node(model%steps(1)%prescribed%node) == b)
    if (n > 0) text = text // ', ' // plural(n, 'support')
    n = count([(any(bodies%of_node(model%equations(k)%node) == b), k=1, size(model%equations))])
    if (n > 0) text = text // ', ' // plural(n, 'equation')
    n = count([(any(bodies%of_node(model%nonlinear_mpcs(k)%node) == b), k=1, n_nonlinear_mpcs(model))])
    if (n > 0) text = text // ', ' // plural(n, 'nonlinear constraint')
    call count_touching(bodies, contact, slaves, b, n_closed, n_open)
    do p = 1, size(model%pairs)
      if (n_closed(p) + n_open(p) == 0) cycle
      text = text // ', contact ' // model%surfaces(model%pairs(p)%slave)%name // ' / ' // &
        model%surfaces(model%pairs(p)%master)%name // ' (' // to_text(n_closed(p)) // ' closed, ' // to_text(n_open(p)) // ' open)'
    end do
    if (text == '') then
      text = '; held by nothing'
    else
      text = '; held by ' // text(3:)
    end if
  end function restraint_text


  !> Counts the closed and open slave nodes of each pair that are on a body, or face it.
  subroutine count_touching(bodies, contact, slaves, b, n_closed, n_open)
    type(bodies_type), intent(in) :: bodies
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: b                       !< body
    integer, intent(out) :: n_closed(:), n_open(:) !< (n_pairs)
    type(contact_row_type) :: row
    integer :: s
    n_closed = 0
    n_open = 0
    do s = 1, size(slaves)
      if (slaves(s)%facet == 0 .or. gives_way(slaves(s)%overrides)) cycle
      call current_row(contact, slaves(s), row)
      if (.not. any(bodies%of_node(row%nodes) == b)) cycle
      if (is_closed(contact, slaves(s))) then
        n_closed(slaves(s)%pair) = n_closed(slaves(s)%pair) + 1
      else
        n_open(slaves(s)%pair) = n_open(slaves(s)%pair) + 1
      end if
    end do
  end subroutine count_touching


  !> One line for each contact pair.
  function pair_table(model, contact, slaves) result(text)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    character(:), allocatable :: text
    type(pair_statistics_type), allocatable :: tallies(:)
    character(110) :: line
    integer :: p
    call collect_pair_statistics(model, contact, slaves, tallies)
    text = table_entry('contact pairs', size(tallies)) // NEWLINE // &
      '      slaves projected    closed   flipped      held    least gap  largest gap  friction  slave / master' // NEWLINE
    do p = 1, size(tallies)
      write (line, '(2x,5i10,2(1x,a12),a10,2x)') tallies(p)%n_slaves, tallies(p)%n_projected, tallies(p)%n_closed, &
        merge(tallies(p)%n_facing_away, tallies(p)%n_same_direction, tallies(p)%n_facing_away == tallies(p)%n_projected), &
        tallies(p)%n_held, &
        gap_text(tallies(p), tallies(p)%least_gap, contact%edge(p)), &
        gap_text(tallies(p), tallies(p)%largest_gap, contact%edge(p)), &
        to_text(model%interactions(model%pairs(p)%interaction)%friction)
      text = text // line(:90) // model%surfaces(model%pairs(p)%slave)%name // ' / ' // &
        model%surfaces(model%pairs(p)%master)%name // NEWLINE
    end do
  end function pair_table


  !> A gap, or '-' where no node has one; values at rounding level appear as 0.
  pure function gap_text(tally, gap, edge) result(text)
    type(pair_statistics_type), intent(in) :: tally
    real(DP), intent(in) :: gap, edge              !< [length]
    character(12) :: text
    text = '-'
    if (tally%largest_gap >= tally%least_gap) text = to_text(merge(gap, 0.0_DP, abs(gap) > TOL_EQUAL_DISPLACEMENT * edge))
    text = adjustr(text)
  end function gap_text


  !> Two lines for each step: times and loads.
  function step_table(model) result(text)
    type(model_type), intent(in) :: model
    character(:), allocatable :: text
    integer :: i
    text = table_entry('steps', size(model%steps)) // NEWLINE
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        text = text // '    ' // to_text(i) // ': '
        if (allocated(step%title)) then
          if (len_trim(step%title) > 0) text = text // trim(step%title) // ', '
        end if
        text = text // trim(merge('NLGEOM             ', 'small displacements', step%is_nlgeom)) // ', period ' // &
          to_text(step%period) // ', first increment ' // to_text(step%dt_initial)
        if (step%is_direct) text = text // ' (fixed)'
        text = text // ', at most ' // plural(step%max_increments, 'increment') // NEWLINE // &
          '       ' // loads_text(step) // NEWLINE
      end associate
    end do
  end function step_table


  !> '48 prescribed displacements, 3 forces'.
  pure function loads_text(step) result(text)
    type(step_type), intent(in) :: step
    character(:), allocatable :: text
    integer :: n
    text = plural(size(step%prescribed), 'prescribed displacement')
    if (size(step%concentrated) > 0) text = text // ', ' // plural(size(step%concentrated), 'force')
    n = count(step%distributed%kind == DISTRIBUTED_PRESSURE)
    if (n > 0) text = text // ', ' // plural(n, 'face') // ' under pressure'
    n = count(step%distributed%kind == DISTRIBUTED_TRACTION)
    if (n > 0) text = text // ', ' // plural(n, 'face') // ' under traction'
    n = count(step%distributed%kind == DISTRIBUTED_GRAVITY)
    if (n > 0) text = text // ', ' // plural(n, 'element') // ' under gravity'
    n = count(step%distributed%kind == DISTRIBUTED_CENTRIFUGAL)
    if (n > 0) text = text // ', ' // plural(n, 'turning element')
    n = count(step%distributed%kind == DISTRIBUTED_BODY_FORCE)
    if (n > 0) text = text // ', ' // plural(n, 'element') // ' with a body force'
  end function loads_text


  !> A name and a number in columns.
  pure function table_entry(name, value) result(text)
    character(*), intent(in) :: name
    integer, intent(in) :: value
    character(:), allocatable :: text
    character(16) :: left
    character(10) :: right
    left = name
    write (right, '(i10)') value
    text = '  ' // left // right
  end function table_entry


  !> Warns of each body that only contact from one side supports.
  subroutine check_unilateral_support(model, contact, slaves, bodies, report)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)      !< at the start of the first increment
    type(bodies_type), intent(in) :: bodies
    type(diagnostic_list_type), intent(inout) :: report
    real(DP), allocatable :: mean_normal(:, :)             ! (3, n_bodies) mean of the normals of the contact forces
    logical, allocatable :: is_only_pushed(:)           ! (n_bodies) supported by contact alone, from one side
    integer :: b
    if (size(slaves) == 0) return
    allocate (mean_normal(3, bodies%n), source=0.0_DP)
    allocate (is_only_pushed(bodies%n), source=.true.)
    call mark_supported_bodies(model, slaves, bodies, is_only_pushed)
    call sum_contact_normals(model, contact, slaves, bodies, .false., mean_normal, is_only_pushed)
    do b = 1, bodies%n
      if (norm2(mean_normal(:, b)) > 0.0_DP) mean_normal(:, b) = mean_normal(:, b) / norm2(mean_normal(:, b))
    end do
    call sum_contact_normals(model, contact, slaves, bodies, .true., mean_normal, is_only_pushed)
    do b = 1, bodies%n
      if (is_only_pushed(b) .and. norm2(mean_normal(:, b)) > 0.5_DP) call report_warning(report, &
        'Nothing but contact holds the ' // &
        body_name(model, bodies%list(b)) // ', no load acts on it, and all contact pushes it in one direction: it will ' // &
        'move away. Hold it by *BOUNDARY, or load it against what it touches.')
    end do
  end subroutine check_unilateral_support


  !> Excludes bodies with a support, an equation, a spring or a load in some step, and those of pairs without any projection, which
  !! may close later.
  subroutine mark_supported_bodies(model, slaves, bodies, is_only_pushed)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    type(bodies_type), intent(in) :: bodies
    logical, intent(inout) :: is_only_pushed(:)
    logical, allocatable :: is_apart(:)            ! (n_pairs)
    integer :: i, k, s, p
    where (bodies%list%n_elements == 0) is_only_pushed = .false.
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        call mark_bodies(bodies%of_node(step%prescribed%node))
        call mark_bodies(bodies%of_node(step%concentrated%node))
        call mark_bodies(bodies%of_element(step%distributed%element))
      end associate
    end do
    do k = 1, size(bodies%equations)
      call mark_bodies(bodies%of_node(bodies%equations(k)%node))
    end do
    call mark_bodies(pack(bodies%of_element, model%mesh%kind >= KIND_SPRINGA))
    if (allocated(model%foundations)) call mark_bodies(bodies%of_element(model%foundations%element))
    allocate (is_apart(size(model%pairs)), source=.true.)
    do s = 1, size(slaves)
      if (slaves(s)%facet > 0) is_apart(slaves(s)%pair) = .false.
    end do
    do p = 1, size(model%pairs)
      if (.not. is_apart(p)) cycle
      call mark_bodies(bodies%of_node(model%surfaces(model%pairs(p)%slave)%nodes))
      call mark_bodies(bodies%of_node(model%surfaces(model%pairs(p)%master)%nodes))
    end do

  contains

    !> Excludes bodies that are supported or loaded.
    subroutine mark_bodies(list)
      integer, intent(in) :: list(:)               !< bodies; 0: none
      integer :: j
      do j = 1, size(list)
        if (list(j) > 0) is_only_pushed(list(j)) = .false.
      end do
    end subroutine mark_bodies

  end subroutine mark_supported_bodies


  !> Sums the normals on each body, or (`is_judging`) compares each with their mean.
  subroutine sum_contact_normals(model, contact, slaves, bodies, is_judging, mean_normal, is_only_pushed)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    type(bodies_type), intent(in) :: bodies
    logical, intent(in) :: is_judging
    real(DP), intent(inout) :: mean_normal(:, :)           !< (3, n_bodies)
    logical, intent(inout) :: is_only_pushed(:)
    type(contact_row_type) :: row
    real(DP) :: contact_normal(3)
    integer :: s, i, b
    do s = 1, size(slaves)
      if (slaves(s)%facet == 0 .or. gives_way(slaves(s)%overrides)) cycle
      call current_row(contact, slaves(s), row)
      do i = 1, size(row%nodes)
        b = bodies%of_node(row%nodes(i))
        if (b == 0) cycle
        contact_normal = row%weights(i) * slaves(s)%normal
        if (.not. is_judging) mean_normal(:, b) = mean_normal(:, b) + contact_normal
        if (is_judging .and. .not. is_cone_one_sided(model, slaves(s)%pair, contact_normal, mean_normal(:, &
          b))) is_only_pushed(b) = .false.
      end do
    end do
  end subroutine sum_contact_normals


  !> Whether every force of the friction cone of a contact has a positive part along a direction.
  pure logical function is_cone_one_sided(model, pair, contact_normal, mean_normal)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    real(DP), intent(in) :: contact_normal(3)                !< (3) along the normal, of any length
    real(DP), intent(in) :: mean_normal(3)                 !< unit vector
    real(DP) :: along
    is_cone_one_sided = .true.
    if (.not. norm2(contact_normal) > 0.0_DP) return
    along = dot_product(contact_normal, mean_normal) / norm2(contact_normal)
    associate (law => model%interactions(model%pairs(pair)%interaction))
      is_cone_one_sided = .not. law%is_user_friction .and. along > law%friction * sqrt(max(0.0_DP, 1.0_DP - along**2))
    end associate
  end function is_cone_one_sided

end module amontons_model_check
