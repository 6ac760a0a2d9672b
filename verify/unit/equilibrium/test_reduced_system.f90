!> Tests of the reduced system: factor and iteration against a product, reuse and recomputation of the factor, shifts.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_reduced_system
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_mesh, only: mesh_type
  use amontons_element_kinds, only: KIND_T3D2
  use amontons_steps, only: SOLVER_ITERATIVE
  use amontons_sparse, only: sparse_type, sparse_from_triplets, multiply_symmetric
  use amontons_factorization, only: FACTOR_OK
  use amontons_constraints, only: constraints_type, constraint_row_type, reset_constraints, prescribe_unknown, &
    add_constraint_row, eliminate_constraints
  use amontons_controls, only: linear_solver_controls_type
  use amontons_reduced_system, only: reduced_system_type, is_factor_small, factorise_reduced_system, apply_reduced_inverse, &
    abandon_iteration, discard_analysis
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  integer, parameter :: N_NODES = 20, N = 3 * N_NODES
  call check_factor(suite)
  call check_kept(suite)
  call check_shift(suite)
  call check_iteration(suite)
  call check_sizes(suite)
  call suite%finish()

contains

  !> A chain of nodes, bars between neighbours, each direction by itself; the first node fixed, and a row between two others.
  subroutine make_chain(stiffness, constraints, mesh, bar)
    type(sparse_type), intent(out) :: stiffness
    type(constraints_type), intent(inout) :: constraints
    type(mesh_type), intent(out) :: mesh
    real(DP), intent(in) :: bar                    !< stiffness of a bar [force/length]
    type(constraint_row_type) :: row
    type(error_type), allocatable :: error
    integer :: i, status
    call sparse_from_triplets(N, N, [(i, i=1, N), (i, i=1, N - 3)], [(i, i=1, N), (i + 3, i=1, N - 3)], &
      [(merge(1.0_DP, 2.0_DP, i <= 3 .or. i > N - 3) * bar, i=1, N), (-bar, i=1, N - 3)], stiffness, error)
    call reset_constraints(constraints, N)
    do i = 1, 3
      call prescribe_unknown(constraints, i, 0.0_DP)
    end do
    row%unknown = [10, 13]
    row%coefficient = [1.0_DP, -1.0_DP]
    call add_constraint_row(constraints, row, 1, 1.0e-9_DP, status)
    call eliminate_constraints(constraints)
    mesh%n_nodes = N_NODES
    mesh%n_elements = N_NODES - 1
    allocate (mesh%kind(N_NODES - 1), source=KIND_T3D2)
    mesh%coordinates = reshape([(real(mod(i, 7), DP) + real(i, DP), i=1, N)], [3, N_NODES])
    mesh%first = [(2 * i - 1, i=1, N_NODES)]
    mesh%nodes = [((i + 1) / 2 + mod(i + 1, 2), i=1, 2 * (N_NODES - 1))]
  end subroutine make_chain


  !> A times inv(A) x is x.
  real(DP) function error_of_inverse(system) result(largest)
    type(reduced_system_type), intent(inout) :: system
    real(DP), allocatable :: x(:), y(:), back(:)
    integer :: i
    x = [(sin(real(i * i, DP)), i=1, system%matrix%n_rows)]
    allocate (y, back, mold=x)
    call apply_reduced_inverse(system, x, y)
    call multiply_symmetric(system%matrix, y, back)
    largest = maxval(abs(back - x))
  end function error_of_inverse


  !> The factor of A = C' K C: 60 unknowns less three fixed ones and a dependent one.
  subroutine check_factor(suite)
    type(suite_type), intent(inout) :: suite
    type(reduced_system_type) :: system
    type(sparse_type) :: stiffness
    type(constraints_type) :: constraints
    type(mesh_type) :: mesh
    type(error_type), allocatable :: error
    real(DP) :: unit(N - 4), y(N - 4)
    integer :: status
    call make_chain(stiffness, constraints, mesh, 3.0_DP)
    call factorise_reduced_system(system, stiffness, .false., constraints, mesh, status, error)
    call suite%that('factor: made', status == FACTOR_OK .and. system%n_factorised == 1 .and. system%n_shifted == 0 .and. &
      .not. (system%is_iterative .or. allocated(error)))
    call suite%that('factor: unknowns', system%matrix%n_rows == N - 4)
    call suite%near('factor: inverse', error_of_inverse(system), 0.0_DP, 1.0e-11_DP)
    unit = 0.0_DP
    unit(constraints%free_of(N)) = 1.0_DP
    call apply_reduced_inverse(system, unit, y)
    call suite%near('factor: 19 bars of 3', y(constraints%free_of(N)), 19.0_DP / 3.0_DP, 1.0e-12_DP)
    call suite%near('factor: in x one bar is rigid', y(constraints%free_of(N - 2)), 0.0_DP, 1.0e-12_DP)
    unit = 0.0_DP
    unit(constraints%free_of(N - 2)) = 1.0_DP
    call apply_reduced_inverse(system, unit, y)
    call suite%near('factor: 18 bars of 3 in x', y(constraints%free_of(N - 2)), 18.0_DP / 3.0_DP, 1.0e-12_DP)
  end subroutine check_factor


  !> A current factor is kept, and recomputed when it is declared outdated, with other values or with springs.
  subroutine check_kept(suite)
    type(suite_type), intent(inout) :: suite
    type(reduced_system_type) :: system
    type(sparse_type) :: stiffness
    type(constraints_type) :: constraints
    type(mesh_type) :: mesh
    type(error_type), allocatable :: error
    integer :: status, i
    call make_chain(stiffness, constraints, mesh, 3.0_DP)
    do i = 1, 2
      call factorise_reduced_system(system, stiffness, .false., constraints, mesh, status, error)
      call suite%that('kept: made once', system%n_factorised == merge(1, 0, i == 1) .and. system%is_current)
    end do
    stiffness%value = 2 * stiffness%value
    system%is_current = .false.                    ! as the owner of K declares
    call factorise_reduced_system(system, stiffness, .false., constraints, mesh, status, error)
    call suite%that('kept: made anew', system%n_factorised == 1)
    call suite%near('kept: of the new values', error_of_inverse(system), 0.0_DP, 1.0e-11_DP)
    call factorise_reduced_system(system, stiffness, .true., constraints, mesh, status, error)
    call suite%that('kept: not with springs', system%n_factorised == 1)
    call discard_analysis(system)
    call suite%that('kept: nothing after that', .not. (system%is_current .or. allocated(system%analysed_map%first)))
    call prescribe_all(constraints)
    call factorise_reduced_system(system, stiffness, .false., constraints, mesh, status, error)
    call suite%that('kept: nothing to do where all is prescribed', status == FACTOR_OK .and. system%n_factorised == 0)
  end subroutine check_kept


  !> No free unknowns.
  subroutine prescribe_all(constraints)
    type(constraints_type), intent(inout) :: constraints
    integer :: i
    call reset_constraints(constraints, N)
    do i = 1, N
      call prescribe_unknown(constraints, i, 0.0_DP)
    end do
    call eliminate_constraints(constraints)
  end subroutine prescribe_all


  !> A matrix that is not positive definite is shifted, at most five times; the status says if no shift helps.
  subroutine check_shift(suite)
    type(suite_type), intent(inout) :: suite
    type(reduced_system_type) :: system
    type(sparse_type) :: stiffness
    type(constraints_type) :: constraints
    type(mesh_type) :: mesh
    type(error_type), allocatable :: error
    integer :: status
    call make_chain(stiffness, constraints, mesh, 3.0_DP)
    stiffness%value(stiffness%first(N)) = 2.9_DP - 3.0_DP / 19.0_DP   ! the last unknown: softer than the chain can bear
    call factorise_reduced_system(system, stiffness, .false., constraints, mesh, status, error)
    call suite%that('shift: found', status == FACTOR_OK .and. system%n_shifted >= 1 .and. system%n_shifted <= 5)
    call suite%that('shift: counted, and not kept', system%n_factorised == system%n_shifted + 1 .and. .not. system%is_current)
    stiffness%value = -stiffness%value
    call factorise_reduced_system(system, stiffness, .false., constraints, mesh, status, error)
    call suite%that('shift: none helps', status /= FACTOR_OK .and. system%n_shifted == 5)
  end subroutine check_shift


  !> Iteration where the step requests it: a preconditioner, with a message; after it is abandoned, a factor.
  subroutine check_iteration(suite)
    type(suite_type), intent(inout) :: suite
    type(reduced_system_type) :: system
    type(sparse_type) :: stiffness
    type(constraints_type) :: constraints
    type(mesh_type) :: mesh
    type(error_type), allocatable :: error
    integer :: status
    call make_chain(stiffness, constraints, mesh, 3.0_DP)
    system%requested_solver = SOLVER_ITERATIVE
    call factorise_reduced_system(system, stiffness, .false., constraints, mesh, status, error)
    call suite%that('iteration: chosen', system%is_iterative .and. system%n_factorised == 0 .and. allocated(system%message))
    call abandon_iteration(system)
    call suite%that('iteration: given up', .not. system%is_iterative .and. system%is_iteration_abandoned)
    call suite%that('iteration: and said so', index(system%message, 'a factor is used in its place') > 0)
    call factorise_reduced_system(system, stiffness, .false., constraints, mesh, status, error)
    call suite%that('iteration: a factor', status == FACTOR_OK .and. system%n_factorised == 1 .and. .not. system%is_iterative)
    call suite%near('iteration: and its inverse', error_of_inverse(system), 0.0_DP, 1.0e-11_DP)
  end subroutine check_iteration


  !> A factor is small for small systems, not for very large ones, and not for one use from 30000 unknowns on.
  subroutine check_sizes(suite)
    type(suite_type), intent(inout) :: suite
    call suite%that('sizes: small', is_factor_small(linear_solver_controls_type(), 29999, .false.))
    call suite%that('sizes: small, for many uses', is_factor_small(linear_solver_controls_type(), 29999, .true.))
    call suite%that('sizes: for one use', .not. is_factor_small(linear_solver_controls_type(), 30000, .false.))
    call suite%that('sizes: beyond any memory', .not. is_factor_small(linear_solver_controls_type(), huge(1), .true.))
  end subroutine check_sizes

end program test_reduced_system
