!> Unit test of amontons_knots: rigid motions and stretches satisfy all ties and knots; knots appear where they must.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_knots
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_constraints, only: constraint_row_type
  use amontons_mpc_data, only: MPC_RIGID_BODY, MPC_MEAN_ROTATION, MPC_FITTED_ROTATION
  use amontons_nonlinear_mpc, only: evaluate_mpc_rows
  use amontons_tensor, only: rotation_matrix, cross_product
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,1,0,1;6,1,1,1;*MATERIAL, NAME=M;*ELASTIC;' // &
    '100.,0.3;*ELEMENT, TYPE=S4, ELSET=E;1,1,2,3,4;*SHELL SECTION, ELSET=E, MATERIAL=M;.1;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: WALL = '*ELEMENT, TYPE=S4, ELSET=W;2,2,5,6,3;*SHELL SECTION, ELSET=W, MATERIAL=M;.2;'
  type(suite_type) :: suite
  type(model_type) :: model
  call expect_read('', model)
  call suite%that('ties alone', size(model%nonlinear_mpcs) == 0 .and. size(model%equations) == 12)
  call check_motion('ties')
  call expect_read('*BOUNDARY;1,4,5;', model)
  call suite%that('a turned fibre', size(model%nonlinear_mpcs) == 1 .and. model%nonlinear_mpcs(1)%kind == MPC_RIGID_BODY)
  call suite%that('its drill is held', size(model%equations) == 3 * 3 + 1)
  call check_motion('fibre')
  call expect_read('', model, step='*STEP;*STATIC;*CLOAD;1,6,1.;*END STEP;')
  call suite%that('a moment about the normal turns the shell around', size(model%nonlinear_mpcs) == 2 .and. &
    model%nonlinear_mpcs(2)%kind == MPC_FITTED_ROTATION .and. size(model%nonlinear_mpcs(2)%node) == 4)
  call suite%that('its drill follows', size(model%equations) == 3 * 3 + 1)
  call check_motion('driven fibre')
  call expect_read('*BOUNDARY;1,4,5;', model, DIALECT_CALCULIX)
  call suite%that('mean rotations about x and y', size(model%nonlinear_mpcs) == 2 .and. &
    all(model%nonlinear_mpcs%kind == MPC_MEAN_ROTATION))
  call expect_read(WALL, model)
  call suite%that('knots at the edge', size(model%nonlinear_mpcs) == 2 .and. all(model%nonlinear_mpcs%reference == [2, 3]))
  call suite%that('free to drill', size(model%equations) == 4 * 3)
  call check_motion('edge')
  call expect_read('*BOUNDARY;1,1,1;', model, DIALECT_CALCULIX)
  call suite%that('linear: no inner nodes to hold', size(model%equations) == 12)
  call suite%that('a turned section holds its 4 inner nodes', n_tie_rows('*BOUNDARY;13,6,6;', DIALECT_CALCULIX) == 9 + 12)
  call suite%that('under the abaqus dialect it is a knot, whose sides twist with it', &
    n_tie_rows('*BOUNDARY;13,6,6;', DIALECT_ABAQUS) == 6 + 2)
  call suite%that('a finite rotation takes all inner nodes', n_tie_rows('*BOUNDARY;13,6,6;', DIALECT_ABAQUS, ', NLGEOM') == 6)
  call check_twist()
  call suite%that('nor by a moment', n_tie_rows('*CLOAD;13,6,1.;', DIALECT_CALCULIX) == 9)
  call suite%that('nor by a displacement', n_tie_rows('*BOUNDARY;13,1,1;', DIALECT_CALCULIX) == 9)
  call expect_message('*BOUNDARY;9,1,1;', 'There is no node')
  call suite%finish()

contains

  !> The equations of a quadratic beam 11, 12, 13 with a card.
  integer function n_tie_rows(card, dialect, parameters) result(n)
    character(*), intent(in) :: card
    integer, intent(in) :: dialect
    character(*), intent(in), optional :: parameters   !< of the step
    type(model_type) :: beam
    character(:), allocatable :: of_step
    integer :: k
    of_step = ''
    if (present(parameters)) of_step = parameters
    call expect_read('*NODE;11,0,0,2;12,1,0,2;13,2,0,2;*ELEMENT, TYPE=B32, ELSET=B;2,11,12,13;*BEAM SECTION, ELSET=B, ' // &
      'MATERIAL=M, SECTION=RECT;.1,.2;0.,1.,0.;', beam, dialect, '*STEP' // of_step // ';*STATIC;' // card // '*END STEP;')
    n = count([(beam%equations(k)%card == 'BEAM SECTION', k=1, size(beam%equations))])
  end function n_tie_rows


  !> The rows of a turned end of an oblique beam: a small rotation with an even stretch satisfies all; where the nodes of the sides
  !! do not turn about the beam, those of the sides are as long as the cross-section is wide.
  subroutine check_twist()
    type(model_type) :: beam
    real(DP), allocatable :: u(:, :)
    real(DP), parameter :: TANGENT(3) = [0.48_DP, 0.6_DP, 0.64_DP], W(3) = [0.3_DP, -0.2_DP, 0.1_DP]
    real(DP) :: row, largest(2)
    integer :: i, k, end_node, rotation
    call expect_read('*NODE;11,0,0,2;12,.48,.6,2.64;13,.96,1.2,3.28;*ELEMENT, TYPE=B32, ELSET=B;2,11,12,13;*BEAM SECTION, ' // &
      'ELSET=B, MATERIAL=M, SECTION=RECT;.1,.2;.6,-.48,0.;', beam, step='*STEP;*STATIC;*BOUNDARY;13,4,6;*END STEP;')
    end_node = findloc(beam%rotation_of > 0, .true., dim=1)
    rotation = beam%rotation_of(end_node)
    allocate (u(3, beam%mesh%n_nodes))
    do i = 1, size(u, 2)
      u(:, i) = cross_product(W, beam%mesh%coordinates(:, i)) + 0.1_DP * (beam%mesh%coordinates(:, i) - &
        beam%mesh%coordinates(:, end_node))
    end do
    largest = 0
    do i = 1, size(beam%equations)
      associate (equation => beam%equations(i))
        if (.not. any(equation%node == rotation)) cycle
        row = sum([(equation%coefficient(k) * merge(W(equation%dof(k)), u(equation%dof(k), equation%node(k)), &
          equation%node(k) == rotation), k=1, size(equation%node))])
        largest(1) = max(largest(1), abs(row))
        row = sum([(merge(equation%coefficient(k) * TANGENT(equation%dof(k)), 0.0_DP, equation%node(k) == rotation), k=1, &
          size(equation%node))])
        largest(2) = largest(2) + abs(row)
      end associate
    end do
    call suite%near('turned sides: a rotation and a stretch violate nothing', largest(1), 0.0_DP, 1.0e-14_DP)
    call suite%near('turned sides: they twist with the knot', largest(2), 0.1_DP + 0.2_DP, 1.0e-12_DP)
  end subroutine check_twist


  !> A finite rotation about an axis through the origin, with a shift, satisfies every row.
  subroutine check_motion(name)
    character(*), intent(in) :: name
    type(constraint_row_type), allocatable :: rows(:)
    real(DP), parameter :: W(3) = [0.3_DP, -0.2_DP, 0.0_DP]
    real(DP) :: u(3, model%mesh%n_nodes), R(3, 3), dR(3, 3, 3), largest
    integer :: i, k
    call rotation_matrix(W, R, dR)
    u = matmul(R, model%mesh%coordinates) - model%mesh%coordinates + spread([0.1_DP, 0.2_DP, 0.3_DP], 2, model%mesh%n_nodes)
    do i = 1, size(model%nonlinear_mpcs)
      u(:, model%nonlinear_mpcs(i)%rotation) = W
      if (model%nonlinear_mpcs(i)%expansion > 0) u(:, model%nonlinear_mpcs(i)%expansion) = 0
    end do
    largest = 0
    do i = 1, size(model%equations)
      associate (equation => model%equations(i))
        largest = max(largest, abs(sum([(equation%coefficient(k) * u(equation%dof(k), equation%node(k)), k=1, &
          size(equation%node))])))
      end associate
    end do
    do i = 1, size(model%nonlinear_mpcs)
      call evaluate_mpc_rows(model%nonlinear_mpcs(i), model%mesh%coordinates, u, .true., rows)
      largest = max(largest, maxval(abs(rows%rhs)))
    end do
    call suite%near(name // ': a rotation violates nothing', largest, 0.0_DP, 1.0e-14_DP)
  end subroutine check_motion


  include 'sample_deck.inc'

end program test_knots
