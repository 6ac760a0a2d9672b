!> The exact tangent of bodies in contact, friction and finite sliding included, against central differences of the residual.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_linearization
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8, KIND_CPE4_FULL, KIND_CAX8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_surfaces, only: interaction_type, surface_type, BEHAVIOR_HARD, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, &
    BEHAVIOR_TABULAR, BEHAVIOR_TIED, ROUGH_FRICTION
  use amontons_steps, only: step_type, TANGENT_EXACT, TANGENT_SYMMETRIC, TANGENT_LAGGED
  use amontons_state, only: state_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_constraints, only: condense_forces
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium, &
    configuration_type, save_configuration, &
    evaluate_linearized
  use amontons_newton_step, only: linearize_equilibrium, solve_newton_step
  use amontons_tangent_solution, only: apply_unconstrained_tangent, assemble_tangent_matrix
  use amontons_contact_evaluation, only: has_other_constraints
  use amontons_contact_pairs, only: contact_type
  use amontons_mortar, only: vertices_of
  use amontons_row_normals, only: normal_cone_type, find_row_normal
  use amontons_contact_linearization, only: linearize_contact, held_friction_spring
  use amontons_contact_operators, only: assemble_contact_tangents, factorise_spring_tangents
  use amontons_woodbury_interface, only: contact_springs_type
  use amontons_sparse, only: sparse_type, multiply, multiply_transpose
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_tangent('flat master, friction, finite sliding', 0.0_DP, 0.3_DP, .true., .false.)
  call check_tangent('curved master, friction, finite sliding', 0.15_DP, 0.4_DP, .true., .false.)
  call check_tangent('curved master, frictionless', 0.15_DP, 0.0_DP, .true., .false.)
  call check_tangent('small sliding', 0.15_DP, 0.3_DP, .true., .true.)
  call check_tangent('small displacements', 0.1_DP, 0.5_DP, .false., .true.)
  call check_tangent('curved master, normals in planes of symmetry', 0.15_DP, 0.4_DP, .true., .false., is_symmetric=.true.)
  call check_tangent('clearance', 0.15_DP, 0.4_DP, .true., .false., shared=5)
  call check_laws()
  call check_mortar()
  call check_planes()
  call check_shared()
  call check_prediction()
  call check_symmetric('symmetric direction')
  call check_symmetric('symmetric direction, compliant', interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=500.0_DP, &
    tension_limit=2.0_DP, cutoff_clearance=10.0_DP, stick_slope=120.0_DP))
  call check_lagged()
  call check_held_friction()
  call suite%finish()

contains

  !> The same with compliant laws, whose forces follow from gap and slip, and with a limit of the shear. (Not with the limit
  !! 0.5: there mu N of a node is the limit to five digits, and differences would step over the kink.)
  subroutine check_laws()
    type(interaction_type) :: law
    law%shear_limit = 0.4_DP
    call check_tangent('hard, shear limited', 0.15_DP, 0.4_DP, .true., .false., law)
    law = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=500.0_DP, tension_limit=2.0_DP, cutoff_clearance=10.0_DP, &
      stick_slope=120.0_DP)
    call check_tangent('linear', 0.15_DP, 0.3_DP, .true., .false., law)
    call check_tangent('linear, small sliding', 0.15_DP, 0.3_DP, .true., .true., law)
    law%shear_limit = 8.0_DP
    call check_tangent('linear, shear limited', 0.15_DP, 0.5_DP, .true., .false., law)
    law = interaction_type(behavior=BEHAVIOR_EXPONENTIAL, cutoff_clearance=0.3_DP, pressure=15.0_DP, stick_slope=120.0_DP)
    call check_tangent('exponential', 0.15_DP, 0.3_DP, .true., .false., law)
    law = interaction_type(behavior=BEHAVIOR_TABULAR, cutoff_clearance=1.0_DP, stick_slope=120.0_DP)
    law%table_pressure = [0.0_DP, 12.0_DP, 40.0_DP, 41.0_DP]
    law%table_overclosure = [-0.05_DP, 0.02_DP, 0.07_DP, 0.4_DP]
    call check_tangent('tabular', 0.15_DP, 0.3_DP, .true., .false., law)
    law = interaction_type(behavior=BEHAVIOR_TIED, stiffness=300.0_DP, stick_slope=120.0_DP, shear_limit=6.0_DP)
    call check_tangent('tied', 0.15_DP, 0.3_DP, .true., .false., law)
    law = interaction_type(has_no_separation=.true.)
    call check_tangent('no separation', 0.15_DP, 0.4_DP, .true., .false., law)
    call check_tangent('no separation, mortar', 0.15_DP, 0.4_DP, .true., .false., law, shared=3)
    law%shear_limit = 0.4_DP
    call check_tangent('no separation, rough', 0.15_DP, ROUGH_FRICTION, .true., .false., law)
    law = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=500.0_DP, stick_slope=500.0_DP, has_no_separation=.true., &
      is_penalty=.true.)
    call check_tangent('no separation, penalty', 0.15_DP, 4.0_DP, .true., .false., law)
  end subroutine check_laws


  !> The same with edges in the plane and of bodies of revolution.
  subroutine check_planes()
    type(interaction_type) :: law
    call check_tangent('plane strain, friction', 0.15_DP, 0.4_DP, .true., .false., plane=KIND_CPE4_FULL)
    call check_tangent('plane strain, frictionless', 0.15_DP, 0.0_DP, .true., .false., plane=KIND_CPE4_FULL)
    call check_tangent('plane strain, small sliding', 0.15_DP, 0.3_DP, .true., .true., plane=KIND_CPE4_FULL)
    call check_tangent('axisymmetric, quadratic, friction', 0.15_DP, 0.4_DP, .true., .false., plane=KIND_CAX8)
    law = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=500.0_DP, tension_limit=2.0_DP, cutoff_clearance=10.0_DP, &
      stick_slope=120.0_DP)
    call check_tangent('axisymmetric, quadratic, linear law', 0.15_DP, 0.3_DP, .true., .false., law, KIND_CAX8)
  end subroutine check_planes


  !> The same with pairs that share nodes: a symmetric pair with reactions on some of its slaves, and a node closed in two pairs.
  subroutine check_shared()
    call check_tangent('symmetric pair, friction', 0.0_DP, 0.4_DP, .true., .false., plane=KIND_CPE4_FULL, shared=1)
    call check_tangent('symmetric pair, curved', 0.15_DP, 0.4_DP, .true., .false., plane=KIND_CPE4_FULL, shared=1)
    call check_tangent('symmetric pair, quadratic', 0.0_DP, 0.4_DP, .false., .true., plane=KIND_CAX8, shared=1)
    call check_tangent('corner, small displacements', 0.15_DP, 0.4_DP, .false., .true., plane=KIND_CPE4_FULL, shared=2)
  end subroutine check_shared


  !> Surface-to-surface, with fixed rows and with rows integrated anew.
  subroutine check_mortar()
    type(interaction_type) :: law
    call check_tangent('mortar, small sliding', 0.15_DP, 0.3_DP, .true., .true., shared=3)
    call check_tangent('mortar, small displacements', 0.1_DP, 0.5_DP, .false., .true., shared=3)
    law = interaction_type(behavior=BEHAVIOR_EXPONENTIAL, cutoff_clearance=0.3_DP, pressure=15.0_DP, stick_slope=120.0_DP)
    call check_tangent('mortar, exponential', 0.15_DP, 0.3_DP, .true., .true., law, shared=3)
    call check_tangent('mortar, quadratic lines, small sliding', 0.15_DP, 0.3_DP, .true., .true., plane=KIND_CAX8, shared=3)
    call check_tangent('mortar, finite sliding', 0.15_DP, 0.3_DP, .true., .false., shared=3)
    call check_tangent('mortar, finite sliding, frictionless', 0.15_DP, 0.0_DP, .true., .false., shared=3)
    call check_tangent('mortar, finite sliding, exponential', 0.15_DP, 0.3_DP, .true., .false., law, shared=3)
    call check_tangent('mortar, nearly off its master', 0.0_DP, 0.3_DP, .true., .false., shared=4)
    call check_tangent('mortar, finite sliding, lines', 0.15_DP, 0.3_DP, .true., .false., plane=KIND_CPE4_FULL, shared=3)
    call check_tangent('mortar, finite sliding, with a crease', 0.15_DP, 0.3_DP, .true., .false., plane=KIND_CPE4_FULL, shared=6)
    law = interaction_type(behavior=BEHAVIOR_LINEAR, stiffness=300.0_DP, tension_limit=2.0_DP, cutoff_clearance=10.0_DP, &
      stick_slope=120.0_DP)
    call check_tangent('mortar, linear law, with a crease', 0.15_DP, 0.3_DP, .true., .false., law, KIND_CPE4_FULL, shared=6)
    call check_tangent('mortar, finite sliding, quadratic lines', 0.15_DP, 0.3_DP, .true., .false., law, KIND_CAX8, shared=3)
  end subroutine check_mortar


  !> -(K - dF_c) du against the difference of the condensed residual, statuses frozen, for several random directions.
  subroutine check_tangent(name, sag, friction, is_nlgeom, is_small, law, plane, shared, is_symmetric)
    character(*), intent(in) :: name
    real(DP), intent(in) :: sag                    !< height of the master's waves [length]
    real(DP), intent(in) :: friction
    logical, intent(in) :: is_nlgeom, is_small
    type(interaction_type), intent(in), optional :: law   !< with its behaviour; hard without it
    integer, intent(in), optional :: plane         !< KIND_... of two plates in the plane in place of two blocks
    integer, intent(in), optional :: shared  !< 1: with the exchanged pair first; 2: with a second master; 3: none, but
                                             !! surface-to-surface; 4: the same, with a fourteenth of the outer facets covered; 5:
                                             !! none, and a CLEARANCE of zero whatever the mesh; 6: surface-to-surface, with the
                                             !! side of the upper plate
    logical, intent(in), optional :: is_symmetric  !< planes of symmetry take the x of every other vertex normal
    real(DP), parameter :: H = 1.0e-6_DP
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type) :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    real(DP), allocatable :: u(:, :), du(:, :), exact(:, :), plus(:, :), minus(:, :), w(:)
    real(DP) :: stiffness  ! of the trial traction; 0 under a law, which is then evaluated at the actual position
    integer :: trouble, i, s, n
    stiffness = 100.0_DP
    if (present(law)) stiffness = merge(100.0_DP, 0.0_DP, law%behavior == BEHAVIOR_HARD)
    if (present(plane)) then
      call two_plates(model, plane, sag, is_nlgeom, is_small)
    else
      call two_blocks(model, sag, friction, is_nlgeom, is_small)
    end if
    if (present(shared)) then
      if (shared == 3 .or. shared == 4 .or. shared == 6) model%pairs(1)%is_mortar = .true.
      if (shared == 6) call add_side(model)
      if (shared == 5) model%pairs(1)%has_clearance = .true.
      if (shared < 3) call share_nodes(model, shared)
    end if
    if (present(law)) model%interactions(1) = law
    model%interactions(1)%friction = friction
    step = model%steps(1)
    call create_equilibrium(system, model, state, error)
    call suite%that(name // ': the system is made', .not. allocated(error))
    if (allocated(error)) return
    call begin_step(system, model, step, state, error)
    if (present(is_symmetric)) call lean(system%contact%facets(1)%symmetry_projector(:, :, ::2))
    call begin_increment(system, model, step, .true., state)
    n = model%mesh%n_nodes
    allocate (u(3, n), du(3, n), exact(3, n), plus(3, n), minus(3, n), w(3 * n))
    call fill(u, 1, 0.02_DP)
    if (present(plane)) u = 0.25_DP * u
    if (present(plane)) u(3, :) = 0.0_DP

    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%status == STATUS_OPEN) cycle
        slave%status = merge(STATUS_STICK, STATUS_SLIP, mod(s, 3) == 0)
        slave%stiffness = stiffness
        if (.not. present(plane)) u(:, slave%node) = u(:, slave%node) + [0.05_DP, 0.03_DP, merge(0.035_DP, -0.01_DP, &
          model%interactions(1)%is_penalty)]
      end associate
    end do
    if (present(plane)) u(1, model%surfaces(1)%nodes) = u(1, model%surfaces(1)%nodes) + 0.05_DP
    if (present(shared)) then
      if (shared == 4) u(1, model%surfaces(1)%nodes) = u(1, model%surfaces(1)%nodes) + 0.26_DP
    end if
    state%new%u = u
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.true.)
    call suite%that(name // ': evaluated', trouble == 0)
    if (present(shared)) then
      if (shared == 1) call suite%that(name // ': there are levels', system%contact%shared_slaves%n_levels > 1)
      if (shared == 6) call suite%that(name // ': within the cone of the crease', is_within_cone(system, model, u))
      if (shared == 2) call suite%that(name // ': a node touches twice', any([(has_other_constraints(system%contact, s), &
        s=1, size(state%new%slaves))]))
    end if
    if (model%interactions(1)%has_no_separation) then
      associate (N => [(dot_product(state%new%slaves(s)%force, state%new%slaves(s)%normal), s=1, size(state%new%slaves))])
        call suite%that(name // ': pressed and pulled', any(N > 0.1_DP .and. state%new%slaves%status == STATUS_SLIP) .and. &
          any(N < -0.1_DP .and. state%new%slaves%status == STATUS_SLIP))
      end associate
    end if
    call suite%that(name // ': sticking nodes', count(state%new%slaves%status == STATUS_STICK) > merge(0, 1, present(shared)))
    call suite%that(name // ': slipping nodes', count(state%new%slaves%status == STATUS_SLIP) > 2)
    call linearize_equilibrium(system, model, step, state, trouble, error)
    state%new%slaves%stiffness = stiffness
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.true.)
    call linearize_contact(system%contact, model, state%old, state%new, system%contact_tangents)
    if (all(system%contact_tangents%is_compliant_node)) call check_factors(name, system)
    if (friction > 0.0_DP) call check_condensed(name, system, model, step, state)   ! without friction the upper block is free
    do i = 1, 4
      call fill(du, i + 1, 1.0_DP)
      if (present(plane)) du(3, :) = 0.0_DP
      call apply_unconstrained_tangent(system, reshape(du, [3 * n]), w)
      call condense_forces(system%base, reshape(w, [3, n]), exact)
      state%new%u = u + H * du
      call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.true.)
      plus = system%residual
      state%new%u = u - H * du
      call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.true.)
      minus = system%residual
      call check_matrix(name, system, i)
      call suite%near(name // ': tangent', norm2((minus - plus) / (2.0_DP * H) - exact) / norm2(exact), 0.0_DP, 1.0e-7_DP)
    end do
  end subroutine check_tangent


  !> Whether the normal of a row is within the normal cone of a crease.
  logical function is_within_cone(system, model, u)
    type(equilibrium_type), intent(in) :: system
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    type(normal_cone_type) :: cone
    real(DP) :: normal(3)
    integer :: j
    is_within_cone = .false.
    associate (mortar => system%contact%mortar(1))
      do j = 1, size(mortar%nodes)
        if (mortar%places(j)%facet == 0) cycle
        call find_row_normal(mortar%slave, vertices_of(mortar, j), mortar%places(j)%vertex, mortar%cuts%covers, &
          system%contact%facets(1), model%mesh%coordinates + u, normal, cone)
        is_within_cone = is_within_cone .or. cone%n_active == 2
      end do
    end associate
  end function is_within_cone


  !> A symmetry plane that is no global one: the normals lose an oblique direction.
  pure subroutine lean(in_plane)
    real(DP), intent(inout) :: in_plane(:, :, :)
    real(DP), parameter :: A(3) = [0.8_DP, 0.6_DP, 0.0_DP]
    integer :: v
    do v = 1, size(in_plane, 3)
      in_plane(:, :, v) = in_plane(:, :, v) - spread(A, 2, 3) * spread(A, 1, 3)
    end do
  end subroutine lean


  !> With small displacements the bulk is linear: the linearized evaluation at u + du equals the full one there, with nodes that
  !! open and close.
  subroutine check_prediction()
    type(model_type) :: model
    type(equilibrium_type) :: system
    type(state_type) :: state, start
    type(configuration_type) :: place
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), predicted(:, :)
    integer, allocatable :: status(:)
    integer :: trouble, i, n_changes
    call two_blocks(model, 0.1_DP, 0.3_DP, .false., .true.)
    call create_equilibrium(system, model, state, error)
    call begin_step(system, model, model%steps(1), state, error)
    call begin_increment(system, model, model%steps(1), .true., state)
    allocate (du, mold=state%new%u)
    call fill(du, 1, 0.02_DP)
    state%new%u = du
    call evaluate_equilibrium(system, model, model%steps(1), state, trouble, is_frozen=.false.)
    call linearize_equilibrium(system, model, model%steps(1), state, trouble, error)
    start = state
    place = save_configuration(system, state)
    n_changes = 0
    do i = 2, 4
      call fill(du, i, 0.05_DP)
      state = start
      call evaluate_linearized(system, model, place, du, state)
      predicted = system%residual
      status = state%new%slaves%status
      n_changes = n_changes + count(status /= start%new%slaves%status)
      state = start
      state%new%u = start%new%u + du
      call evaluate_equilibrium(system, model, model%steps(1), state, trouble, is_frozen=.false.)
      call suite%that('prediction: the same statuses', all(status == state%new%slaves%status))
      call suite%near('prediction: the same residual', norm2(predicted - system%residual) / norm2(predicted), 0.0_DP, 1.0e-11_DP)
    end do
    call suite%that('prediction: statuses do change on the way', n_changes > 0)
  end subroutine check_prediction


  !> The products of the springs, B A + M X, equal the matrix of their change.
  subroutine check_factors(name, system)
    character(*), intent(in) :: name
    type(equilibrium_type), intent(in) :: system
    type(contact_springs_type) :: springs
    type(sparse_type) :: by_imbalance, by_displacement
    type(error_type), allocatable :: error
    real(DP), allocatable :: du(:, :), force(:), place(:), change(:), w(:), moved(:)
    integer :: n
    n = system%constraints%n_unknowns
    call factorise_spring_tangents(system%contact_tangents, n, springs, error)
    call assemble_contact_tangents(system%contact_tangents, system%contact%force_condensation, n, by_imbalance, by_displacement)
    allocate (du(3, n / 3), change(n), w(n), moved(n), force(springs%spring_tangent%n_rows), &
      place(springs%projection_gradient%n_rows))
    call fill(du, 7, 1.0_DP)
    call multiply(by_displacement, reshape(du, [n]), change)
    call multiply(springs%spring_tangent, reshape(du, [n]), force)
    call multiply(springs%projection_gradient, reshape(du, [n]), place)
    call multiply(springs%force_distribution, force, w)
    call multiply(springs%distribution_change, place, moved)
    call suite%near(name // ': the products of the springs', norm2(w + moved - change) / norm2(change), 0.0_DP, 1.0e-13_DP)
  end subroutine check_factors


  !> With a fresh factor of the bulk the condensed interface is the exact inverse of the tangent: one Krylov iteration.
  subroutine check_condensed(name, system, model, step, state)
    character(*), intent(in) :: name
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    type(error_type), allocatable :: error
    real(DP) :: du(3, model%mesh%n_nodes), stiffness(size(state%new%slaves))
    integer :: trouble, before
    before = system%n_krylov
    stiffness = state%new%slaves%stiffness
    call solve_newton_step(system, model, step, state, du, trouble, error)
    call suite%that(name // ': a direction is found', trouble == 0 .and. .not. allocated(error))
    call suite%that(name // ': by the condensed interface', system%has_interface_solver)
    call suite%that(name // ': which is exact (' // achar(48 + system%n_krylov - before) // ')', system%n_krylov - before <= 2)
    state%new%slaves%stiffness = stiffness
    call linearize_contact(system%contact, model, state%old, state%new, system%contact_tangents)
  end subroutine check_condensed


  !> x'J y = y'J x for SYMMETRIC, and not for the whole tangent of curved surfaces with friction.
  subroutine check_symmetric(name, law)
    character(*), intent(in) :: name
    type(interaction_type), intent(in), optional :: law
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type) :: system
    type(state_type) :: state
    type(sparse_type) :: J
    type(error_type), allocatable :: error
    real(DP), allocatable :: x(:), y(:), Jx(:), Jy(:)
    real(DP) :: skew(2)
    integer :: trouble, i, k
    call two_blocks(model, 0.15_DP, 0.4_DP, .true., .false.)
    if (present(law)) model%interactions(1) = law
    model%interactions(1)%friction = 0.4_DP
    call start_sliding(model, step, system, state)
    do k = 1, 2
      step%direction = merge(TANGENT_EXACT, TANGENT_SYMMETRIC, k == 1)
      call linearize_equilibrium(system, model, step, state, trouble, error)
      call assemble_tangent_matrix(system, J, error)
      x = [(sin(real(7 * i + 1, DP)**2), i=1, system%constraints%n_free)]
      y = [(sin(real(11 * i + 2, DP)**2), i=1, system%constraints%n_free)]
      allocate (Jx(size(x)), Jy(size(x)))
      call multiply(J, x, Jx)
      call multiply(J, y, Jy)
      skew(k) = abs(dot_product(y, Jx) - dot_product(x, Jy)) / (norm2(Jx) * norm2(y))
      deallocate (Jx, Jy)
    end do
    call suite%that(name // ': the whole tangent is not symmetric', skew(1) > 1.0e-6_DP)
    call suite%near(name // ': J is its transpose', skew(2), 0.0_DP, 1.0e-14_DP)
  end subroutine check_symmetric


  !> K of LAGGED is that of the start of the increment until the next one begins; the statuses of contact are those of the iterate.
  subroutine check_lagged()
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type) :: system
    type(state_type) :: state
    type(error_type), allocatable :: error
    real(DP), allocatable :: first(:), u(:, :)
    integer :: trouble, n_links
    call two_blocks(model, 0.15_DP, 0.4_DP, .true., .false.)
    call start_sliding(model, step, system, state)
    step%direction = TANGENT_LAGGED
    call linearize_equilibrium(system, model, step, state, trouble, error)
    first = system%assembly%stiffness%value
    n_links = size(system%contact_tangents)
    u = state%new%u
    u(3, model%surfaces(1)%nodes) = u(3, model%surfaces(1)%nodes) + 0.2_DP
    state%new%u = u
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.false.)
    call linearize_equilibrium(system, model, step, state, trouble, error)
    call suite%near('lagged: K stays', norm2(system%assembly%stiffness%value - first), 0.0_DP, 0.0_DP)
    call suite%that('lagged: contact does not', size(system%contact_tangents) /= n_links)
    call begin_increment(system, model, step, .false., state)
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.false.)
    call linearize_equilibrium(system, model, step, state, trouble, error)
    call suite%that('lagged: the next increment has its own', &
      norm2(system%assembly%stiffness%value - first) > 1.0e-6_DP * norm2(first))
  end subroutine check_lagged


  !> The spring of the friction P_L (f - c g) that conjugate gradients hold, against differences of that formula: below the limit,
  !! beyond it, and far beyond.
  subroutine check_held_friction()
    type(contact_type) :: contact
    type(slave_state_type) :: slave
    real(DP), parameter :: H = 1.0e-6_DP, LIMIT(3) = [9.0_DP, 2.0_DP, 0.01_DP]
    real(DP) :: spring(3, 3), step(3), difference(3)
    integer :: i, k
    slave%normal = [0.36_DP, 0.48_DP, 0.8_DP]
    slave%stiffness = 50.0_DP
    slave%slip_increment = along(slave%normal, [0.02_DP, -0.03_DP, 0.01_DP])
    allocate (contact%held_friction(3, 1), contact%held_limit(1))
    contact%held_friction(:, 1) = along(slave%normal, [1.5_DP, 1.0_DP, -0.5_DP])
    do i = 1, size(LIMIT)
      contact%held_limit = LIMIT(i)
      spring = held_friction_spring(contact, slave, 1)
      do k = 1, 3
        step = 0.0_DP
        step(k) = H
        step = along(slave%normal, step)
        difference = (limited(contact%held_friction(:, 1) - slave%stiffness * (slave%slip_increment - step), LIMIT(i)) - &
          limited(contact%held_friction(:, 1) - slave%stiffness * (slave%slip_increment + step), LIMIT(i))) / (2.0_DP * H)
        call suite%near('held friction: its spring', norm2(difference - spring(:, k)) / slave%stiffness, 0.0_DP, 1.0e-8_DP)
      end do
      call suite%near('held friction: none along the normal', norm2(matmul(spring, slave%normal)), 0.0_DP, 1.0e-13_DP)
      call suite%near('held friction: symmetric', maxval(abs(spring - transpose(spring))), 0.0_DP, 1.0e-13_DP)
    end do
  end subroutine check_held_friction


  !> The part of a vector along the master.
  pure function along(normal, v) result(w)
    real(DP), intent(in) :: normal(3), v(3)
    real(DP) :: w(3)
    w = v - dot_product(normal, v) * normal
  end function along


  !> P_L q: a force shortened to its limit.
  pure function limited(q, limit) result(p)
    real(DP), intent(in) :: q(3), limit            !< [force]
    real(DP) :: p(3)
    p = q
    if (norm2(q) > limit) p = limit * q / norm2(q)
  end function limited


  !> The upper block has slid a little: some nodes stick, most slip.
  subroutine start_sliding(model, step, system, state)
    type(model_type), intent(in) :: model
    type(step_type), intent(out) :: step
    type(equilibrium_type), intent(inout) :: system
    type(state_type), intent(inout) :: state
    type(error_type), allocatable :: error
    integer :: s, trouble
    step = model%steps(1)
    call create_equilibrium(system, model, state, error)
    call begin_step(system, model, step, state, error)
    call begin_increment(system, model, step, .true., state)
    call fill(state%new%u, 1, 0.02_DP)
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (slave%status == STATUS_OPEN) cycle
        slave%status = merge(STATUS_STICK, STATUS_SLIP, mod(s, 3) == 0)
        slave%stiffness = 100.0_DP
        state%new%u(:, slave%node) = state%new%u(:, slave%node) + [0.05_DP, 0.03_DP, -0.01_DP]
      end associate
    end do
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.true.)
  end subroutine start_sliding


  !> The tangent as a matrix on the free unknowns equals the operator.
  subroutine check_matrix(name, system, seed)
    character(*), intent(in) :: name
    type(equilibrium_type), intent(in) :: system
    integer, intent(in) :: seed
    type(sparse_type) :: J
    type(error_type), allocatable :: error
    real(DP), allocatable :: v(:), flat(:), w(:), y(:), z(:)
    integer :: i
    call assemble_tangent_matrix(system, J, error)
    call suite%that(name // ': the matrix is made', .not. allocated(error))
    v = [(sin(real(7 * i + seed, DP)**2), i=1, system%constraints%n_free)]
    allocate (flat(system%constraints%n_unknowns), w(system%constraints%n_unknowns), y(size(v)), z(size(v)))
    call multiply(system%constraints%transformation, v, flat)
    call apply_unconstrained_tangent(system, flat, w)
    call multiply_transpose(system%constraints%transformation, w, y)
    call multiply(J, v, z)
    call suite%near(name // ': matrix and operator', norm2(y - z) / norm2(y), 0.0_DP, 1.0e-13_DP)
  end subroutine check_matrix


  !> Smooth reproducible numbers without a pattern.
  subroutine fill(array, seed, amount)
    real(DP), intent(out) :: array(:, :)
    integer, intent(in) :: seed
    real(DP), intent(in) :: amount
    integer :: i, k
    do i = 1, size(array, 2)
      do k = 1, 3
        array(k, i) = amount * sin(real(17 * i + 5 * k + 31 * seed, DP)**2)
      end do
    end do
  end subroutine fill


  !> A plate of 8 x 1 elements on one of 3 x 1, the upper the slave, away from the axis.
  subroutine two_plates(model, kind, sag, is_nlgeom, is_small)
    type(model_type), intent(out) :: model
    integer, intent(in) :: kind                    !< KIND_CPE4_FULL, KIND_CAX8
    real(DP), intent(in) :: sag
    logical, intent(in) :: is_nlgeom, is_small
    integer, parameter :: M(2) = [3, 8]
    integer :: e, i, body, node, each
    each = merge(8, 4, kind == KIND_CAX8)
    call two_blocks(model, sag, 0.0_DP, is_nlgeom, is_small)
    associate (mesh => model%mesh)
      mesh%n_elements = sum(M)
      mesh%n_nodes = 3 * sum(2 * M + 1)
      mesh%node_label = [(i, i=1, mesh%n_nodes)]
      mesh%element_label = [(i, i=1, mesh%n_elements)]
      mesh%kind = spread(kind, 1, mesh%n_elements)
      mesh%material = spread(1, 1, mesh%n_elements)
      mesh%first = [(each * (i - 1) + 1, i=1, mesh%n_elements + 1)]
      deallocate (mesh%coordinates, mesh%nodes, mesh%section_value, mesh%directions, mesh%is_auxiliary)
      allocate (mesh%coordinates(3, mesh%n_nodes), source=0.0_DP)
      allocate (mesh%nodes(each * mesh%n_elements))
      node = 0
      e = 0
      do body = 1, 2
        call fill_plate(mesh, each, M(body), body == 2, sag, node, e)
      end do
      call finalize_mesh(mesh)
    end associate
    associate (slave => model%surfaces(1), master => model%surfaces(2))
      slave%element = [(M(1) + i, i=1, M(2))]
      slave%face = spread(1, 1, M(2))
      master%element = [(i, i=1, M(1))]
      master%face = spread(3, 1, M(1))
      slave%nodes = [(3 * (2 * M(1) + 1) + i, i=1, 2 * M(2) + 1, merge(1, 2, each == 8))]
      master%nodes = [(2 * (2 * M(1) + 1) + i, i=1, 2 * M(1) + 1, merge(1, 2, each == 8))]
    end associate
    deallocate (model%steps(1)%prescribed)
    allocate (model%steps(1)%prescribed(4))
    do i = 1, 4
      model%steps(1)%prescribed(i)%node = merge(1, 2 * M(1) + 1, i < 3)
      model%steps(1)%prescribed(i)%dof = 1 + mod(i, 2)
    end do
  end subroutine two_plates


  !> Makes pairs of two plates that share nodes.
  subroutine share_nodes(model, shared)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: shared                !< 1: the exchanged pair first; 2: the upper's left edge against a third body
    type(surface_type), allocatable :: surfaces(:)
    allocate (surfaces(4))
    surfaces(:2) = model%surfaces
    surfaces(3) = surfaces(1)
    surfaces(4) = surfaces(2)
    call move_alloc(surfaces, model%surfaces)
    model%pairs = [model%pairs(1), model%pairs(1)]
    if (shared == 1) then
      model%pairs(1)%slave = 2
      model%pairs(1)%master = 1
    else
      call add_wall(model)
      model%pairs(2)%slave = 3
      model%pairs(2)%master = 4
    end if
  end subroutine share_nodes


  !> The left side of the upper plate belongs to the slave surface, too: its lower corner is a crease.
  subroutine add_side(model)
    type(model_type), intent(inout) :: model
    associate (slave => model%surfaces(1), mesh => model%mesh)
      slave%element = [slave%element, 4]
      slave%face = [slave%face, 4]
      slave%nodes = [slave%nodes, mesh%nodes(mesh%first(4) + 3)]
    end associate
  end subroutine add_side


  !> A tilted wall of one element at the left of the upper plate, with a small overlap.
  subroutine add_wall(model)
    type(model_type), intent(inout) :: model
    integer :: n, first
    associate (mesh => model%mesh)
      n = mesh%n_nodes
      first = mesh%nodes(mesh%first(4))            ! lower left node of the upper plate
      mesh%coordinates = reshape([mesh%coordinates, 1.0_DP, -0.5_DP, 0.0_DP, 2.2_DP, -0.5_DP, 0.0_DP, 2.3_DP, 1.5_DP, 0.0_DP, &
        1.0_DP, 1.5_DP, 0.0_DP], [3, n + 4])
      mesh%nodes = [mesh%nodes, n + 1, n + 2, n + 3, n + 4]
      mesh%n_nodes = n + 4
      mesh%n_elements = mesh%n_elements + 1
      mesh%node_label = [mesh%node_label, n + 1, n + 2, n + 3, n + 4]
      mesh%element_label = [mesh%element_label, mesh%n_elements]
      mesh%kind = [mesh%kind, mesh%kind(1)]
      mesh%material = [mesh%material, 1]
      mesh%first = [mesh%first, mesh%first(size(mesh%first)) + 4]
      deallocate (mesh%section_value, mesh%directions, mesh%is_auxiliary)
      call finalize_mesh(mesh)
      model%surfaces(3)%element = [4]
      model%surfaces(3)%face = [4]
      model%surfaces(3)%nodes = mesh%nodes(mesh%first(4) + [0, 3])
      model%surfaces(4)%element = [mesh%n_elements]
      model%surfaces(4)%face = [2]
      model%surfaces(4)%nodes = [n + 2, n + 3]
    end associate
    model%steps(1)%prescribed = [model%steps(1)%prescribed, model%steps(1)%prescribed]
    associate (prescribed => model%steps(1)%prescribed)
      prescribed(5:6)%node = model%mesh%n_nodes - 3
      prescribed(7:8)%node = model%mesh%n_nodes
      prescribed(5:8)%dof = [1, 2, 1, 2]
    end associate
  end subroutine add_wall


  !> One row of m elements; its lattice has three rows of 2 m + 1 nodes; 4-node elements omit the middle ones.
  subroutine fill_plate(mesh, each, m, is_upper, sag, node, e)
    type(mesh_type), intent(inout) :: mesh
    integer, intent(in) :: each, m                 !< nodes of an element, elements
    logical, intent(in) :: is_upper
    real(DP), intent(in) :: sag
    integer, intent(inout) :: node, e              !< numbers used
    integer :: a, b, k(3, 3), row
    real(DP) :: x, y
    row = 2 * m + 1
    do a = 1, m
      do b = 1, 3
        k(:, b) = node + row * (b - 1) + 2 * a - [1, 0, -1]
      end do
      e = e + 1
      mesh%nodes(each * (e - 1) + 1:each * (e - 1) + 4) = [k(1, 1), k(3, 1), k(3, 3), k(1, 3)]
      if (each == 8) mesh%nodes(8 * e - 3:8 * e) = [k(2, 1), k(3, 2), k(2, 3), k(1, 2)]
    end do
    do b = 0, 2
      do a = 0, 2 * m
        node = node + 1
        x = real(a, DP) / real(2 * m, DP) * merge(1.7_DP, 2.4_DP, is_upper) - merge(0.85_DP, 1.2_DP, is_upper)
        y = 0.5_DP * real(b, DP) + merge(0.0_DP, -1.0_DP, is_upper)
        if (abs(y) < 1.0e-9_DP) y = sag * (cos(2.0_DP * x) - 1.0_DP) - merge(0.06_DP, 0.0_DP, is_upper)
        mesh%coordinates(:2, node) = [x + 3.0_DP, y]
      end do
    end do
  end subroutine fill_plate


  !> A block of 3 x 3 x 1 hexahedra on one of 2 x 2 x 1, the upper the slave.
  subroutine two_blocks(model, sag, friction, is_nlgeom, is_small)
    type(model_type), intent(out) :: model
    real(DP), intent(in) :: sag, friction
    logical, intent(in) :: is_nlgeom, is_small
    integer :: i
    associate (mesh => model%mesh)
      mesh%n_nodes = 18 + 32
      mesh%n_elements = 4 + 9
      mesh%node_label = [(i, i=1, mesh%n_nodes)]
      mesh%element_label = [(i, i=1, mesh%n_elements)]
      allocate (mesh%coordinates(3, mesh%n_nodes), mesh%nodes(8 * mesh%n_elements))
      mesh%kind = spread(KIND_C3D8, 1, mesh%n_elements)
      mesh%material = spread(1, 1, mesh%n_elements)
      mesh%first = [(8 * i - 7, i=1, mesh%n_elements + 1)]
      allocate (mesh%node_sets(0), mesh%element_sets(0))
      call fill_block(2, 0, 0, [-1.0_DP, 0.0_DP], sag, mesh)
      call fill_block(3, 18, 4, [0.0_DP, 1.0_DP], sag, mesh)
      call finalize_mesh(mesh)
    end associate
    allocate (model%materials(1), model%surfaces(2), model%interactions(1), model%pairs(1), model%amplitudes(0), &
      model%equations(0), model%steps(1))
    model%materials(1)%youngs_modulus = 100.0_DP
    model%materials(1)%poissons_ratio = 0.3_DP
    model%interactions(1)%friction = friction
    model%surfaces(1)%element = [(4 + i, i=1, 9)]
    model%surfaces(1)%face = spread(1, 1, 9)
    model%surfaces(1)%nodes = [(18 + i, i=1, 16)]
    model%surfaces(2)%element = [1, 2, 3, 4]
    model%surfaces(2)%face = spread(2, 1, 4)
    model%surfaces(2)%nodes = [(9 + i, i=1, 9)]
    model%pairs(1)%slave = 1
    model%pairs(1)%master = 2
    model%pairs(1)%interaction = 1
    model%pairs(1)%is_small_sliding = is_small
    associate (step => model%steps(1))
      step%is_nlgeom = is_nlgeom
      allocate (step%prescribed(27), step%concentrated(0), step%distributed(0), step%prints(0))
      do i = 1, 27                                 ! all of the bottom: else the tangent is singular
        step%prescribed(i)%node = 1 + (i - 1) / 3
        step%prescribed(i)%dof = 1 + mod(i - 1, 3)
      end do
    end associate
  end subroutine two_blocks


  !> One layer of m x m hexahedra between two heights, the contact face waved; numbers start after those given.
  subroutine fill_block(m, nodes_before, elements_before, height, sag, mesh)
    integer, intent(in) :: m, nodes_before, elements_before
    real(DP), intent(in) :: height(2)              !< bottom and top [length]
    real(DP), intent(in) :: sag                    !< [length]
    type(mesh_type), intent(inout) :: mesh
    real(DP) :: x, y, z
    integer :: a, b, c, n, e
    do c = 0, 1
      do b = 0, m
        do a = 0, m
          n = nodes_before + 1 + a + (m + 1) * (b + (m + 1) * c)
          x = 2.4_DP * real(a, DP) / real(m, DP) - 1.2_DP
          y = 2.4_DP * real(b, DP) / real(m, DP) - 1.2_DP
          if (m == 3) x = 0.7_DP * x
          if (m == 3) y = 0.7_DP * y
          z = height(c + 1)
          if (abs(z) < 0.5_DP) z = sag * (cos(x) * cos(0.7_DP * y) - 1.0_DP)
          if (m == 3 .and. c == 0) z = z - 0.06_DP
          mesh%coordinates(:, n) = [x, y, z]
        end do
      end do
    end do
    do b = 1, m
      do a = 1, m
        e = elements_before + a + m * (b - 1)
        n = nodes_before + a + (m + 1) * (b - 1)
        mesh%nodes(8 * e - 7:8 * e - 4) = [n, n + 1, n + m + 2, n + m + 1]
        mesh%nodes(8 * e - 3:8 * e) = mesh%nodes(8 * e - 7:8 * e - 4) + (m + 1)**2
      end do
    end do
  end subroutine fill_block

end program test_contact_linearization
