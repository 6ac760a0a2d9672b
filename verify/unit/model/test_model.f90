!> Unit test of amontons_model: directions, copies across pre-tension sections, paths, elements and materials in steps, equations.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_model
  use amontons_kinds, only: DP
  use amontons_loads, only: load_type, equation_type
  use amontons_mpc_data, only: nonlinear_mpc_type
  use amontons_model, only: model_type, job_options_type, job_path, dof_direction, n_nonlinear_mpcs, with_pretension_copies, &
    new_equation, append_equation, append_mpc, gather_constraints, is_out, absent_elements, material_in_step, load_now
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_directions()
  call check_copies()
  call check_paths()
  call check_steps()
  call check_loads()
  call check_equations()
  call suite%finish()

contains

  !> Global axes, or those of the node's frame.
  subroutine check_directions()
    type(model_type) :: model
    call suite%near('global', norm2(dof_direction(model, 1, 2) - [0.0_DP, 1.0_DP, 0.0_DP]), 0.0_DP, 0.0_DP)
    model%frame_of = [0, 1]
    model%frames = reshape([0.6_DP, 0.8_DP, 0.0_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3, 1])
    call suite%near('not transformed', norm2(dof_direction(model, 1, 1) - [1.0_DP, 0.0_DP, 0.0_DP]), 0.0_DP, 0.0_DP)
    call suite%near('transformed', norm2(dof_direction(model, 2, 2) - [-0.8_DP, 0.6_DP, 0.0_DP]), 0.0_DP, 0.0_DP)
    call suite%that('no list of constraints', n_nonlinear_mpcs(model) == 0)
    allocate (model%nonlinear_mpcs(3))
    call suite%that('three', n_nonlinear_mpcs(model) == 3)
  end subroutine check_directions


  !> Duplicates, and pretension_node_pairs of pretension_node_pairs, each once.
  subroutine check_copies()
    type(model_type) :: model
    integer, allocatable :: nodes(:)
    model%mesh%n_nodes = 8
    call suite%that('none', all(with_pretension_copies(model, [3, 1]) == [3, 1]))
    model%pretension_node_pairs = reshape([1, 6, 2, 7, 6, 8], [2, 3])
    nodes = with_pretension_copies(model, [3, 1])
    call suite%that('a node and its duplicate', size(nodes) == 4)
    call suite%that('in order', all(nodes == [3, 1, 6, 8]))
    call suite%that('not twice', size(with_pretension_copies(model, [1, 6, 8])) == 3)
  end subroutine check_copies


  subroutine check_paths()
    type(job_options_type) :: options
    options%job = 'beam'
    call suite%that('here', job_path(options, '.sta') == 'beam.sta')
    options%outdir = ''
    call suite%that('no folder', job_path(options, '.sta') == 'beam.sta')
    options%outdir = 'out'
    call suite%that('a folder', job_path(options, '.dat') == 'out/beam.dat')
  end subroutine check_paths


  !> Before the first step what holds in the first step holds.
  subroutine check_steps()
    type(model_type) :: model
    model%mesh%n_elements = 2
    model%mesh%material = [7, 8]
    call suite%that('no steps', .not. is_out(model, 0, 1) .and. material_in_step(model, 0, 2) == 8)
    allocate (model%steps(2))
    model%steps(1)%is_inactive = [.true., .false.]
    model%steps(2)%material = [7, 9]
    call suite%that('before the first step', all(absent_elements(model, 0) .eqv. [.true., .false.]))
    call suite%that('in the first', all(absent_elements(model, 1) .eqv. [.true., .false.]))
    call suite%that('in the second none', .not. any(absent_elements(model, 2)))
    call suite%that('material of the section', material_in_step(model, 1, 2) == 8)
    call suite%that('another from the second on', material_in_step(model, 2, 2) == 9)
  end subroutine check_steps


  !> The step's own amplitudes come before those of the model.
  subroutine check_loads()
    type(model_type) :: model
    type(load_type) :: load
    allocate (model%steps(1), model%amplitudes(1))
    model%amplitudes(1)%time = [0.0_DP, 1.0_DP]
    model%amplitudes(1)%factor = [0.0_DP, 1.0_DP]
    load%end = 8
    load%amplitude = 1
    call suite%near('of the model', load_now(model, model%steps(1), load, 0.25_DP, 0.25_DP), 2.0_DP, 1.0e-15_DP)
    model%steps(1)%amplitudes = model%amplitudes
    model%steps(1)%amplitudes(1)%factor = [0.5_DP, 0.5_DP]
    call suite%near('of the step', load_now(model, model%steps(1), load, 0.25_DP, 0.25_DP), 4.0_DP, 1.0e-15_DP)
  end subroutine check_loads


  !> Terms that are nothing beside the largest are left out.
  subroutine check_equations()
    type(model_type) :: model
    type(equation_type) :: equation
    type(nonlinear_mpc_type) :: mpc
    integer :: i
    call append_equation(model, [1, 2, 3], [1, 1, 2], [1.0_DP, 1.0e-17_DP, -2.0_DP], 'EQUATION', 12)
    call append_equation(model, [4, 5], [3, 3], [1.0e-20_DP, -1.0e-20_DP], 'TIE', 13)
    do i = 1, 100
      mpc%node = [i, i + 1]
      mpc%card = 'MPC'
      mpc%line = i
      call append_mpc(model, mpc)
    end do
    call gather_constraints(model)
    call append_equation(model, [6, 7], [1, 1], [1.0_DP, -1.0_DP], 'PIN', 14, n_eliminable=2)
    call gather_constraints(model)
    call suite%that('all in their order', size(model%equations) == 3 .and. size(model%nonlinear_mpcs) == 100)
    call suite%that('the last one', model%equations(3)%n_eliminable == 2 .and. all(model%equations(3)%node == [6, 7]))
    do i = 1, 100
      call suite%that('a constraint whole', all(model%nonlinear_mpcs(i)%node == [i, i + 1]) .and. &
        model%nonlinear_mpcs(i)%line == i .and. model%nonlinear_mpcs(i)%card == 'MPC')
    end do
    associate (first => model%equations(1), second => model%equations(2))
      call suite%that('two terms are left', all(first%node == [1, 3]) .and. all(first%dof == [1, 2]))
      call suite%that('their coefficients', all(first%coefficient == [1.0_DP, -2.0_DP]))
      call suite%that('small ones beside each other stay', size(second%node) == 2)
      call suite%that('card and line', second%card == 'TIE' .and. second%line == 13)
      call suite%that('it holds to the end', first%last_step > 1000000 .and. first%n_eliminable == 1)
    end associate
    equation = new_equation([1, 2], [1, 1], [1.0_DP, 0.0_DP], 'MPC', 1)
    call suite%that('a zero goes', size(equation%coefficient) == 1)
  end subroutine check_equations

end program test_model
