!> Unit test of user_element_forces: arguments of UEL, forces, symmetric and skew stiffness, energies, failures.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_user_element_forces
  use amontons_assembly_plan, only: assembly_type, create_assembly
  use amontons_assembly, only: assemble_tangent
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use amontons_sparse, only: multiply_symmetric
  use amontons_state, only: state_type, slave_state_type, create_state, create_material_state
  use amontons_unsymmetric_tangent, only: assemble_skew, subtract_skew_product
  use amontons_user_element_forces, only: add_user_forces, add_user_stiffness, begin_user_elements, &
    user_strain_energy, user_inelastic_work
  use amontons_user_routines, only: open_routines, close_routines
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,3,0,0;*USER ELEMENT, TYPE=U5, NODES=2, PROPERTIES=1, ' // &
    'I PROPERTIES=1, VARIABLES=2, UNSYMM;1,2;*ELEMENT, TYPE=U5, ELSET=E;11,1,2;12,3,2;*UEL PROPERTY, ELSET=E;2.;3;'
  character(*), parameter :: STEP_PART = '*STEP, NLGEOM;*STATIC;0.5,1.;*END STEP;'
  real(DP), parameter :: TOL = 1.0e-13_DP            ! rounding of sums of size 1
  type(suite_type) :: suite
  type(model_type) :: model
  type(state_type) :: state
  type(assembly_type) :: assembly
  call prepare()
  call check_first_call()
  call check_forces()
  call check_fields()
  call check_stiffness()
  call check_failure()
  call expect_message('*UEL PROPERTY, ELSET=X;1.;', 'no element set', step=STEP_PART)
  call close_routines(model%routines)
  call suite%finish()

contains

  !> UEL with RHS = -A u, A(i, j) = props i j for i /= j, 10 for i = j, and A(1, 2) + jprops.
  subroutine prepare()
    type(error_type), allocatable :: error
    type(slave_state_type) :: no_slaves(0)
    integer :: unit
    open (newunit=unit, file='test_user_element_forces_uel.f90', status='replace', action='write')
    write (unit, '(a)') &
      'subroutine uel(rhs, amatrx, svars, energy, ndofel, nrhs, nsvars, props, nprops, coords, mcrd, nnode, u, du, v, a, &', &
      '  jtype, time, dtime, kstep, kinc, jelem, params, ndload, jdltyp, adlmag, predef, npredf, lflags, mlvarx, ddlmag, &', &
      '  mdload, pnewdt, jprops, njprop, period)', &
      '  include "aba_param.inc"', &
      '  dimension rhs(mlvarx, *), amatrx(ndofel, ndofel), svars(*), energy(8), props(*), coords(mcrd, nnode), u(ndofel), &', &
      '    du(mlvarx, *), v(ndofel), a(ndofel), time(2), predef(2, npredf, nnode), lflags(*), jprops(*)', &
      '  integer, save :: n_begun = 0', &
      '  if (lflags(3) == 4 .and. kinc == 0 .and. kstep == 1 .and. dtime == 0 .and. time(2) == 0) n_begun = n_begun + 1', &
      '  if (maxval(lflags(4:7)) /= 0 .or. pnewdt < 1d9) call xit', &
      '  energy(1) = n_begun', &
      '  energy(5) = lflags(1)', &
      '  energy(6) = npredf + 10 * predef(1, 1, 2)', &
      '  do i = 1, ndofel', &
      '    amatrx(:, i) = props(1) * i * [(k, k = 1, ndofel)]', &
      '    amatrx(i, i) = 10', &
      '  end do', &
      '  amatrx(1, 2) = amatrx(1, 2) + jprops(1)', &
      '  rhs(1:ndofel, 1) = -matmul(amatrx, u)', &
      '  svars(1) = svars(1) + 1', &
      '  svars(2) = jelem + 100 * jtype + 1000 * kinc + 0.5d0 * lflags(2) + 0.25d0 * lflags(1) + 0.125d0 * lflags(3)', &
      '  energy(2) = coords(1, 1) + 10 * coords(1, 2)', &
      '  energy(3) = du(1, 1)', &
      '  energy(4) = predef(1, 1, 2) + 10 * predef(2, 1, 2) + 100 * time(1) + 1000 * dtime + period + sum(abs(v)) + sum(abs(a))', &
      '  if (u(1) > 99) rhs(1, 1) = transfer(9218868437227405312_8, 1d0)', &
      '  if (u(1) < -99) call xit', &
      '  if (u(2) > 99) pnewdt = 0.5', &
      'end subroutine uel'
    close (unit)
    call expect_read('', model)
    call open_routines('test_user_element_forces_uel.f90', model%routines, error)
    if (allocated(error)) error stop 'the routine does not compile'
    call create_assembly(assembly, model%mesh, error)
    call create_state(state, model%mesh, no_slaves)
    call create_material_state(state, model)
  end subroutine prepare


  !> One call at the start for each element, which changes nothing.
  subroutine check_first_call()
    call begin_user_elements(model, state)
    call suite%near('nothing is kept', maxval(abs(state%new%user_memory)), 0.0_DP, 0.0_DP)
    state%new%step = 1
    state%new%increment = 4
    state%new%step_time = 0.5_DP
    state%new%total_time = 0.5_DP
    state%new%temperature = [7.0_DP, 5.0_DP, 6.0_DP]
    state%new%u(:2, :) = reshape([0.1_DP, -0.2_DP, 0.3_DP, 0.4_DP, 0.7_DP, -0.6_DP], [2, 3])
    state%old%u(1, 1) = 0.04_DP
  end subroutine check_first_call


  !> The matrix of one element.
  function matrix() result(A)
    real(DP) :: A(4, 4)
    integer :: i
    A = 2 * matmul(reshape([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP], [4, 1]), reshape([1.0_DP, 2.0_DP, 3.0_DP, 4.0_DP], [1, 4]))
    do i = 1, 4
      A(i, i) = 10
    end do
    A(1, 2) = A(1, 2) + 3
  end function matrix


  !> Forces at the nodes, memory, energies.
  subroutine check_forces()
    real(DP) :: expected(2, 3), f(4)
    integer :: failed
    expected = 0
    associate (u => state%new%u(:2, :))
      f = matmul(matrix(), [u(:, 1), u(:, 2)])
      expected(:, 1) = f(:2)
      expected(:, 2) = f(3:)
      f = matmul(matrix(), [u(:, 3), u(:, 2)])
      expected(:, 3) = f(:2)
      expected(:, 2) = expected(:, 2) + f(3:)
    end associate
    state%new%internal_force = 0
    call add_user_forces(model, model%steps(1), state, failed)
    call suite%that('no failure', failed == 0)
    call suite%near('internal force', maxval(abs(state%new%internal_force(:2, :) - expected)), 0.0_DP, TOL * 100)
    associate (memory => state%new%user_memory)
      call suite%that('two blocks', size(memory) == 20)
      call suite%near('SVARS from the committed ones', maxval(abs(memory([1, 11]) - 1)), 0.0_DP, 0.0_DP)
      call suite%near('element, type, increment, LFLAGS', memory(12), 12 + 500 + 4000 + 0.5_DP + 0.25_DP + 0.125_DP, 0.0_DP)
      call suite%near('U and its increment', memory(5), 0.06_DP, TOL)
      call suite%near('both elements were called at the start', memory(3), 2.0_DP, 0.0_DP)
      call suite%near('procedure: automatic increments', memory(7), 1.0_DP, 0.0_DP)
      call suite%near('temperature and its change, times', memory(6), 5 + 50 + 50 + 500 + 1.0_DP, TOL * 1000)
      call suite%near('elastic energy: COORDS', user_strain_energy(model, state%new), 10.0_DP + 13.0_DP, TOL)
      call suite%near('inelastic work', user_inelastic_work(model, state%new), sum(memory([5, 6, 15, 16])), TOL * 1000)
    end associate
    call add_user_forces(model, model%steps(1), state, failed)
    call suite%near('a second call starts from the committed SVARS too', state%new%user_memory(1), 1.0_DP, 0.0_DP)
  end subroutine check_forces


  !> PREDEF begins with the temperature, or with the first field variable where the deck gives no temperature; DIRECT in LFLAGS.
  subroutine check_fields()
    type(state_type) :: other
    integer :: failed
    other = state
    other%new%temperature = [7.0_DP, 5.0_DP, 6.0_DP, 1.0_DP, 2.0_DP, 3.0_DP]
    other%old%temperature = other%new%temperature
    model%steps(1)%is_direct = .true.
    call add_user_forces(model, model%steps(1), other, failed)
    call suite%near('first field variable', other%new%user_memory(8), 1 + 10 * 2.0_DP, 0.0_DP)
    call suite%near('procedure: DIRECT', other%new%user_memory(7), 2.0_DP, 0.0_DP)
    model%steps(1)%is_direct = .false.
    model%steps(1)%has_creep = .true.
    model%user_elements%has_temperature = .true.
    call add_user_forces(model, model%steps(1), other, failed)
    call suite%near('temperature and field variable', other%new%user_memory(8), 2 + 10 * 5.0_DP, 0.0_DP)
    call suite%near('procedure: VISCO', other%new%user_memory(7), 21.0_DP, 0.0_DP)
    model%steps(1)%has_creep = .false.
    model%user_elements%has_temperature = .false.
  end subroutine check_fields


  !> K and W together are the derivative of the forces.
  subroutine check_stiffness()
    type(error_type), allocatable :: error
    type(state_type) :: moved
    real(DP) :: du(9), got(9)
    integer :: failed, i
    du = [(sin(real(i, DP)), i=1, 9)]
    du(3::3) = 0
    call assemble_tangent(assembly, model, .true., state, failed)
    call add_user_stiffness(assembly, model, model%steps(1), state, failed)
    call suite%that('no failure', failed == 0)
    call assemble_skew(assembly%skew, 9, error)
    call multiply_symmetric(assembly%stiffness, du, got)
    call subtract_skew_product(assembly%skew, du, got)
    state%new%internal_force = 0
    call add_user_forces(model, model%steps(1), state, failed)
    moved = state
    moved%new%u = state%new%u + reshape(du, [3, 3])
    moved%new%internal_force = 0
    call add_user_forces(model, model%steps(1), moved, failed)
    call suite%near('stiffness of a linear UEL', maxval(abs(reshape(moved%new%internal_force - state%new%internal_force, [9]) - &
      got)), 0.0_DP, 1.0e-11_DP)
  end subroutine check_stiffness


  !> What is not finite, XIT and PNEWDT < 1 are failures of their element.
  subroutine check_failure()
    type(state_type) :: other
    integer :: failed
    other = state
    other%new%u(2, 3) = 100
    call add_user_forces(model, model%steps(1), other, failed)
    call suite%that('PNEWDT', failed == 2)
    other = state
    other%new%u(1, 1) = 100
    call add_user_forces(model, model%steps(1), other, failed)
    call suite%that('not finite', failed == 1)
    other%new%u(1, 1) = -100
    call add_user_stiffness(assembly, model, model%steps(1), other, failed)
    call suite%that('XIT', failed == 1)
  end subroutine check_failure


  include 'sample_deck.inc'

end program test_user_element_forces
