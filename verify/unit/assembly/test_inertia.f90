!> Tests of inertia: consistent mass, force against its stiffness by differences, rest at the start, energies of backward Euler.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_inertia
  use amontons_assembly_plan, only: assembly_type, create_assembly
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_inertia, only: begin_motion, assemble_mass, add_inertia_force, add_inertia_stiffness, conclude_inertia, &
    implicit_loss
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, job_options_type
  use amontons_sparse, only: multiply_symmetric
  use amontons_state, only: state_type, slave_state_type, create_state, create_material_state
  use amontons_steps, only: step_type
  use amontons_text, only: NEWLINE
  use check, only: suite_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP          !< rounding of some hundred operations on numbers near 1 [-]
  real(DP), parameter :: DT = 0.25_DP              !< [time]
  type(suite_type) :: suite
  type(model_type) :: model
  type(assembly_type) :: assembly
  type(state_type) :: state
  real(DP), allocatable :: mass(:)
  call read_model()
  call check_mass()
  call check_force()
  call check_energies()
  call check_rest()
  call suite%finish()

contains

  !> A block of 2 x 3 x 4 with density 0.5, and a mass of 7 at a corner.
  subroutine read_model()
    character(*), parameter :: DECK = '*NODE;1,0,0,0;2,2,0,0;3,2,3,0;4,0,3,0;5,0,0,4;6,2,0,4;7,2,3,4;8,0,3,4;' // &
      '*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*ELEMENT,TYPE=MASS,ELSET=M;2,7;*MASS,ELSET=M;7.;' // &
      '*MATERIAL,NAME=STEEL;*ELASTIC;1000.,0.3;*DENSITY;0.5;*SOLID SECTION,ELSET=E,MATERIAL=STEEL;' // &
      '*STEP;*DYNAMIC,APPLICATION=QUASI-STATIC;0.25,1.;*END STEP;*STEP;*STATIC;*END STEP;' // &
      '*STEP;*DYNAMIC,APPLICATION=QUASI-STATIC;0.25,1.;*END STEP;*STEP;*DYNAMIC,APPLICATION=QUASI-STATIC;0.25,1.;*END STEP;'
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(slave_state_type) :: slaves(0)
    integer :: i
    options%deck_text = DECK
    do i = 1, len(DECK)
      if (DECK(i:i) == ';') options%deck_text(i:i) = NEWLINE
    end do
    options%deck = 'deck'
    call read_deck_text(options%deck_text, options, model, diagnostics, error)
    call suite%that('the deck is read', .not. allocated(error))
    if (allocated(error)) print '(a)', error%message
    call create_assembly(assembly, model%mesh, error)
    call create_state(state, model%mesh, slaves)
    call create_material_state(state, model)
    state%new%step = 1
    state%old%total_time = 1.0_DP
    state%new%total_time = 1.0_DP + DT
    call random_number(state%new%u)
    call random_number(state%old%u)
    call random_number(state%old%v)
  end subroutine read_model


  !> Of a corner V rho/27, of an edge V rho/54, ... (products of 1/3 and 1/6 of each edge); in sum all of it.
  subroutine check_mass()
    real(DP), parameter :: BLOCK_MASS = 12.0_DP    ! 2 x 3 x 4 x 0.5
    real(DP) :: total
    integer :: i
    call assemble_mass(assembly, model, 1, mass)
    total = 2 * sum(mass)
    do i = 1, 8
      total = total - mass(assembly%graph_first(i))
    end do
    call suite%near('mass: total', total, BLOCK_MASS + 7, TOL * BLOCK_MASS)
    call suite%near('mass: corner', mass(assembly%graph_first(1)), BLOCK_MASS / 27, TOL * BLOCK_MASS)
    call suite%near('mass: along an edge', mass(assembly%graph_first(1) + 1), BLOCK_MASS / 54, TOL * BLOCK_MASS)
    call suite%near('mass: across the block', mass(assembly%graph_first(1) + 6), BLOCK_MASS / 216, TOL * BLOCK_MASS)
    call suite%near('mass: with the point mass', mass(assembly%graph_first(7)), BLOCK_MASS / 27 + 7, TOL * BLOCK_MASS)
  end subroutine check_mass


  !> The force is -M a, and its change over a displacement minus the product of M/dt^2 with it.
  subroutine check_force()
    real(DP), allocatable :: before(:, :), move(:, :), product(:)
    if (allocated(mass)) deallocate (mass)
    state%new%applied_force = 0.0_DP
    call add_inertia_force(assembly, model, mass, state)
    call suite%that('force: assembles the mass', allocated(mass))
    before = state%new%applied_force
    call suite%near('force: sum, on the trial motion', norm2(sum(before, 2) + total_momentum_rate()), 0.0_DP, 1.0e3_DP * TOL)
    allocate (move(3, 8), product(24))
    call random_number(move)
    state%new%u = state%new%u + move
    state%new%applied_force = 0.0_DP
    call add_inertia_force(assembly, model, mass, state)
    assembly%stiffness%value = 0.0_DP
    call add_inertia_stiffness(mass, state, assembly)
    call multiply_symmetric(assembly%stiffness, reshape(move, [24]), product)
    call suite%near('force: its derivative', maxval(abs(reshape(before - state%new%applied_force, [24]) - product)), 0.0_DP, &
      1.0e3_DP * TOL)
    call suite%that('force: stiffness is there', maxval(abs(product)) > 1.0_DP)
  end subroutine check_force


  !> Sum of mass times acceleration: each corner has an eighth of the block, by the sum of its row.
  function total_momentum_rate() result(rate)
    real(DP) :: rate(3), a(3, 8)
    a = ((state%new%u - state%old%u) / DT - state%old%v) / DT
    rate = 12.0_DP / 8 * sum(a, 2) + 7 * a(:, 7)
  end function total_momentum_rate


  !> A translation: v'Mv/2, dv'M dv/2, and the loads alone remain; the work of a linear spring at the end of the increment is twice
  !! what it stores.
  subroutine check_energies()
    real(DP) :: velocity(3)
    integer :: i
    velocity = [1.0_DP, -2.0_DP, 3.0_DP]
    state%old%u = 0.0_DP
    do i = 1, 8
      state%old%v(:, i) = 0.5_DP * velocity
      state%new%u(:, i) = DT * velocity
    end do
    state%old%integration_loss = 3.0_DP
    state%new%applied_force = 2.0_DP
    call add_inertia_force(assembly, model, mass, state)
    call conclude_inertia(assembly, mass, state)
    call suite%near('energy: loads alone', maxval(abs(state%new%applied_force - 2)), 0.0_DP, 1.0e3_DP * TOL)
    call suite%near('energy: kinetic', state%new%kinetic_energy, 0.5_DP * 19 * 14, 1.0e3_DP * TOL)
    call suite%near('energy: lost', state%new%integration_loss, 3 + 0.5_DP * 19 * 3.5_DP, 1.0e3_DP * TOL)
    state%new%internal_force = 10 * state%new%u
    state%new%strain_energy = 0.5_DP * 10 * sum(state%new%u**2)
    state%new%friction_work = 0.25_DP
    call suite%near('energy: implicit', implicit_loss(state%old, state%new), 5 * sum(state%new%u**2) - 0.25_DP, 1.0e3_DP * TOL)
  end subroutine check_energies


  !> Velocities of a static step are no momentum; those of a dynamic one are.
  subroutine check_rest()
    state%old%v = 1.0_DP
    call begin_motion(model%steps, 2, state%old)
    call suite%near('rest: a static step', minval(state%old%v), 1.0_DP, 0.0_DP)
    call begin_motion(model%steps, 4, state%old)
    call suite%near('rest: after a dynamic one', minval(state%old%v), 1.0_DP, 0.0_DP)
    call begin_motion(model%steps, 3, state%old)
    call suite%near('rest: after a static one', maxval(state%old%v), 0.0_DP, 0.0_DP)
    state%old%v = 1.0_DP
    call begin_motion(model%steps, 1, state%old)
    call suite%near('rest: first', maxval(state%old%v), 0.0_DP, 0.0_DP)
  end subroutine check_rest

end program test_inertia
