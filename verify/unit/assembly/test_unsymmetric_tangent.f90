!> Tests of the tangent of bodies under follower pressures, against central differences of the residual.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_unsymmetric_tangent
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_model, only: model_type, job_options_type
  use amontons_deck, only: read_deck_text
  use amontons_state, only: state_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium, begin_step, begin_increment, evaluate_equilibrium
  use amontons_newton_step, only: linearize_equilibrium
  use amontons_tangent_solution, only: apply_unconstrained_tangent, assemble_tangent_matrix
  use amontons_sparse, only: sparse_type, multiply, multiply_transpose
  use check, only: suite_type
  implicit none
  character(*), parameter :: NL = new_line('a')
  character(*), parameter :: CORNERS = '*NODE' // NL // '1, 0, 0, 0' // NL // '2, 1, 0, 0' // NL // '3, 1, 1.1, 0' // NL // &
    '4, 0, 1, 0.1' // NL // '5, 0, 0, 1' // NL // '6, 1, 0, 1' // NL // '7, 1, 1, 1.2' // NL // '8, 0, 1, 1' // NL // &
    '9, 2, 0, 0' // NL // '10, 2, 1, 0' // NL // '11, 2, 0, 1.1' // NL // '12, 2.1, 1, 1' // NL
  character(*), parameter :: FLAT = '*NODE' // NL // '1, 1, 0' // NL // '2, 2, 0' // NL // '3, 2.1, 1' // NL // '4, 1, 1' // NL
  type(suite_type) :: suite
  call check_tangent('solid', CORNERS // '*ELEMENT, TYPE=C3D8, ELSET=E' // NL // '1, 1, 2, 3, 4, 5, 6, 7, 8' // NL // &
    '2, 2, 9, 10, 3, 6, 11, 12, 7' // NL, '1, P2, 30.' // NL // '2, P2, 30.' // NL // '2, P4, -20.' // NL, 0)
  call check_tangent('plane strain', FLAT // '*ELEMENT, TYPE=CPE4, ELSET=E' // NL // '1, 1, 2, 3, 4' // NL, '1, P2, 30.' // NL, 0)
  call check_tangent('axisymmetric', FLAT // '*ELEMENT, TYPE=CAX4, ELSET=E' // NL // '1, 1, 2, 3, 4' // NL, '1, P2, 30.' // NL, 0)
  call check_tangent('held rim', CORNERS // '*ELEMENT, TYPE=C3D8, ELSET=E' // NL // '1, 1, 2, 3, 4, 5, 6, 7, 8' // NL // &
    '2, 2, 9, 10, 3, 6, 11, 12, 7' // NL, '1, P1, 30.' // NL // '1, P2, 30.' // NL // '1, P3, 30.' // NL // '1, P5, 30.' &
    // NL // '1, P6, 30.' // NL // '2, P1, 30.' // NL // '2, P2, 30.' // NL // '2, P3, 30.' // NL // '2, P4, 30.' // NL // &
    '2, P5, 30.' // NL, -1)
  call suite%finish()

contains

  !> The change of the residual by a deck's pressures for random displacements: operator and matrix against differences.
  subroutine check_tangent(name, mesh, loads, expected)
    character(*), intent(in) :: name, mesh, loads
    integer, intent(in) :: expected                !< 0: W is nonzero; -1: a closed surface, W is zero
    real(DP), parameter :: H = 1.0e-6_DP
    type(model_type) :: model
    type(equilibrium_type) :: system
    type(state_type) :: state
    type(sparse_type) :: J
    type(error_type), allocatable :: error
    real(DP), allocatable :: u(:, :), du(:, :), w(:), v(:), x(:), y(:), z(:), plus(:, :), minus(:, :), difference(:, :)
    integer :: n, i, trouble
    call make(mesh, loads, model, system, state)
    n = model%mesh%n_nodes
    allocate (u(3, n), du(3, n), w(3 * n), v(3 * n), plus(3, n), minus(3, n), difference(3, n))
    u = 0.05_DP * random(n, 1)
    do i = 2, 5
      du = random(n, i)
      call residual_at(system, model, state, u + H * du, plus)
      call residual_at(system, model, state, u - H * du, minus)
      difference = (plus - minus) / (2 * H)
      call residual_at(system, model, state, u, plus)
      call linearize_equilibrium(system, model, model%steps(1), state, trouble, error)
      call suite%that(name // ': linearised', trouble == 0 .and. .not. allocated(error))
      call suite%that(name // ': what is left of W', allocated(system%assembly%skew%matrix%first) .eqv. expected == 0)
      call apply_unconstrained_tangent(system, reshape(du, [3 * n]), w)
      call suite%near(name // ': operator', norm2(reshape(w, [3, n]) + difference), 0.0_DP, 1.0e-7_DP * norm2(w))
      call assemble_tangent_matrix(system, J, error)
      call suite%that(name // ': the matrix is made', .not. allocated(error) .and. J%n_rows >= 2 * n)
      allocate (x(J%n_rows), y(J%n_rows), z(J%n_rows))
      call multiply_transpose(system%constraints%transformation, reshape(du, [3 * n]), x)   ! the free unknowns among du
      call multiply(system%constraints%transformation, x, v)
      call apply_unconstrained_tangent(system, v, w)
      call multiply_transpose(system%constraints%transformation, w, z)
      call multiply(J, x, y)
      call suite%near(name // ': matrix', norm2(y - z), 0.0_DP, 1.0e-12_DP * norm2(z))
      deallocate (x, y, z)
    end do
  end subroutine check_tangent


  !> The residual of displacements.
  subroutine residual_at(system, model, state, u, residual)
    type(equilibrium_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(state_type), intent(inout) :: state
    real(DP), intent(in) :: u(:, :)
    real(DP), intent(out) :: residual(:, :)
    integer :: trouble
    state%new%u = u
    call evaluate_equilibrium(system, model, model%steps(1), state, trouble, is_frozen=.true.)
    call suite%that('evaluated', trouble == 0)
    residual = system%residual
  end subroutine residual_at


  !> A system without supports, its loads at their full size.
  subroutine make(mesh, loads, model, system, state)
    character(*), intent(in) :: mesh, loads
    type(model_type), intent(out) :: model
    type(equilibrium_type), intent(out) :: system
    type(state_type), intent(out) :: state
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    call read_deck_text(mesh // '*MATERIAL, NAME=M' // NL // '*ELASTIC' // NL // '100., 0.3' // NL // &
      '*SOLID SECTION, ELSET=E, MATERIAL=M' // NL // '*STEP, NLGEOM' // NL // '*STATIC' // NL // '*DLOAD' // NL // loads // &
      '*END STEP' // NL, options, model, diagnostics, error)
    call suite%that('the deck is read', .not. allocated(error))
    call create_equilibrium(system, model, state, error)
    call begin_step(system, model, model%steps(1), state, error)
    call suite%that('the system is made', .not. allocated(error))
    state%new%step_time = 1
    state%new%total_time = 1
    call begin_increment(system, model, model%steps(1), .true., state)
  end subroutine make


  !> Reproducible numbers between -1 and 1.
  pure function random(n, seed) result(x)
    integer, intent(in) :: n, seed
    real(DP) :: x(3, n)
    integer :: i, j
    do j = 1, n
      do i = 1, 3
        x(i, j) = sin(real(1000 * seed + 17 * i + 131 * j, DP)**2)
      end do
    end do
  end function random

end program test_unsymmetric_tangent
