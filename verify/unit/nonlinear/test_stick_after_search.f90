!> Stick set by the line search NODAL: nodes whose step is cut at zero slip stick where it ends, and only there.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_stick_after_search
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_element_kinds, only: KIND_C3D8
  use amontons_mesh, only: mesh_type, finalize_mesh
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, LINE_SEARCH_NODAL
  use amontons_state, only: state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  use amontons_slave_node_overrides, only: NODE_OVERRIDE_NONE
  use amontons_friction_slip_scenarios, only: slip_state_type, slip_result_type, slip_controls_type, classify_slip_scenarios
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_newton_step, only: linearize_equilibrium
  use amontons_line_search, only: line_search_report_type, perform_line_search
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_back_slip('small displacements', .false.)
  call check_back_slip('finite sliding', .true.)
  call suite%finish()

contains

  !> Nodes slid with their body since the start of the increment, so friction is below its limit. The direction moves them back and
  !! three times as far beyond. NODAL cuts each at zero slip (a fourth of the step, its least length) and sets it to stick, although
  !! the force of its body exceeds the friction limit: the next evaluation sets it to slip.
  subroutine check_back_slip(name, is_nlgeom)
    character(*), intent(in) :: name
    logical, intent(in) :: is_nlgeom
    type(model_type) :: model
    type(step_type) :: step
    type(equilibrium_type) :: system
    type(state_type) :: state, there
    type(line_search_report_type) :: search
    type(slip_state_type), allocatable :: at_u(:), at_ud(:)
    type(slip_result_type), allocatable :: verdicts(:)
    type(slip_controls_type) :: controls
    real(DP), allocatable :: du(:, :), d(:, :)
    logical, allocatable :: is_cut(:)
    integer :: trouble, s
    call two_blocks(model, 0.0_DP, 0.2_DP, is_nlgeom, .not. is_nlgeom)
    step = model%steps(1)
    model%materials(1)%poissons_ratio = 0.0_DP     ! pressure causes no lateral strain
    call slide(model, step, system, state)
    allocate (at_u, source=system%contact%slip_data)
    allocate (du, mold=state%new%u)
    du = 0.0_DP
    do s = 1, size(at_u)
      if (at_u(s)%status == STATUS_SLIP) du(:, state%new%slaves(s)%node) = -4 * at_u(s)%slip
    end do
    there = state
    there%new%u = state%new%u + du
    call evaluate_equilibrium(system, model, step, there, trouble, is_frozen=.false.)
    allocate (at_ud, source=system%contact%slip_data)
    controls%force_zero = step%controls%r_n * system%largest_force
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.true.)   ! back at u
    allocate (verdicts(size(at_u)), d(3, size(at_u)))
    do s = 1, size(at_u)
      d(:, s) = at_ud(s)%slip - at_u(s)%slip
    end do
    controls%slip_tolerance = step%controls%r_n
    controls%alpha_min = step%controls%s_min
    controls%alpha_max = step%controls%s_max
    call classify_slip_scenarios(at_u, at_ud, d, controls, verdicts)
    is_cut = verdicts%becomes_stick
    call suite%that(name // ': some nodes are cut', count(is_cut) > 1)
    step%line_search = LINE_SEARCH_NODAL
    call perform_line_search(system, model, step, du, state%new%slaves, state, search, trouble)
    call suite%that(name // ': the lengths of the nodes are taken', trouble == 0 .and. .not. search%is_whole_step)
    call suite%that(name // ': they stick', all(state%new%slaves%status == STATUS_STICK .or. .not. is_cut))
    call suite%that(name // ': against the trial traction of some', system%contact%n_imposed > 0)
    do s = 1, size(at_u)
      if (is_cut(s)) call suite%near(name // ': at zero slip', norm2(system%contact%slip_data(s)%slip), 0.0_DP, &
        1.0e-3_DP * norm2(at_u(s)%slip))
    end do
    call suite%that(name // ': the next evaluation decides anew', all(state%new%slaves%overrides%status == NODE_OVERRIDE_NONE))
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.false.)
    call suite%that(name // ': by the trial traction', system%contact%n_imposed == 0 .and. &
      any(state%new%slaves%status == STATUS_SLIP .and. is_cut))
  end subroutine check_back_slip


  !> The upper block pressed on the lower one and shifted along it; all closed nodes slip.
  subroutine slide(model, step, system, state)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(equilibrium_type), intent(inout) :: system
    type(state_type), intent(inout) :: state
    type(error_type), allocatable :: error
    integer :: n, trouble
    call create_equilibrium(system, model, state, error)
    call begin_step(system, model, step, state, error)
    call begin_increment(system, model, step, .true., state)
    do n = 19, model%mesh%n_nodes                  ! the upper block
      state%new%u(:, n) = [0.06_DP, 0.03_DP, merge(-0.06_DP, 0.0_DP, n > 34)]
    end do
    where (state%new%slaves%status /= STATUS_OPEN) state%new%slaves%status = STATUS_SLIP
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.true.)
    call linearize_equilibrium(system, model, step, state, trouble, error)
    call evaluate_equilibrium(system, model, step, state, trouble, is_frozen=.true.)
  end subroutine slide


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

end program test_stick_after_search
