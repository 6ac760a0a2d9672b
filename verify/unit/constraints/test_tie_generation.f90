!> Unit test of tie_generation: tied nodes against linear fields, sectors against a rotation, couplings against rigid motions.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_tie_generation
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type, EXIT_SETUP
  use amontons_kinds, only: DP
  use amontons_loads, only: equation_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use amontons_tie_generation, only: generate_ties
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  real(DP), parameter :: TOL = 1.0e-13_DP            ! rounding of sums of numbers of size 10
  ! Below: two cubes of side 2 side by side. Above: one of side 1, its bottom 0.01 above them.
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,2,0,0;3,4,0,0;4,0,2,0;5,2,2,0;6,4,2,0;11,0,0,2;12,2,0,2;13,4,0,2;' // &
    '14,0,2,2;15,2,2,2;16,4,2,2;21,1,.5,2.01;22,2,.5,2.01;23,2,1.5,2.01;24,1,1.5,2.01;25,1,.5,3;26,2,.5,3;27,2,1.5,3;' // &
    '28,1,1.5,3;' // &
    '90,7,8,9;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,5,4,11,12,15,14;2,2,3,6,5,12,13,16,15;3,21,22,23,24,25,26,27,28;' // &
    '*MATERIAL, NAME=M;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;*ELSET, ELSET=LOW;1,2;*SURFACE, NAME=TABLE;LOW,S2;' // &
    '*SURFACE, NAME=SOLE;3,S1;*SURFACE, NAME=LID;3,S2;*SURFACE, NAME=FRONT;1,S3;*SURFACE, NAME=LEFT;1,S6;*BOUNDARY;1,1;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  type(model_type) :: model
  type(equation_type), allocatable :: equations(:)
  real(DP), allocatable :: coordinates(:, :), u(:, :)
  character(:), allocatable :: warnings
  type(error_type), allocatable :: error
  call check_tie()
  call check_nodal_tie()
  call check_sector()
  call check_coupling()
  call check_errors()
  call suite%finish()

contains

  !> The equations of a deck.
  subroutine generate(text)
    character(*), intent(in) :: text
    if (allocated(error)) deallocate (error)
    call expect_read(text, model)
    call generate_ties(model, equations, coordinates, warnings, error)
  end subroutine generate


  !> The largest violation of the equations of a card by u.
  real(DP) function violation(card) result(worst)
    character(*), intent(in) :: card
    integer :: i, k
    real(DP) :: total
    worst = -1
    do i = 1, size(equations)
      if (equations(i)%card /= card) cycle
      total = 0
      do k = 1, size(equations(i)%node)
        total = total + equations(i)%coefficient(k) * u(equations(i)%dof(k), equations(i)%node(k))
      end do
      worst = max(worst, abs(total))
    end do
  end function violation


  !> Four nodes on a master of linear shape functions: any field that is linear holds; they are moved unless ADJUST=NO.
  subroutine check_tie()
    call generate('*TIE, NAME=T;SOLE, TABLE;')
    call suite%that('tie: three for each of four nodes', .not. allocated(error) .and. size(equations) == 12)
    call suite%near('tie: moved', maxval(abs(coordinates(3, 13:16) - 2)), 0.0_DP, TOL)
    call suite%near('tie: the lid stays', maxval(abs(coordinates(3, 17:20) - 3)), 0.0_DP, 0.0_DP)
    u = matmul(reshape([0.5_DP, 0.25_DP, 0.125_DP, 1.0_DP, -1.0_DP, 2.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], [3, 3]), &
      model%mesh%coordinates)
    call suite%near('tie: a linear field', violation('TIE'), 0.0_DP, TOL)
    u(1, 13) = u(1, 13) + 0.5_DP
    call suite%near('tie: a node that moves away', violation('TIE'), 0.5_DP, TOL)
    call suite%that('tie: line of the card', all(equations%line == model%ties(1)%line))
    call generate('*TIE, NAME=T, ADJUST=NO;SOLE, TABLE;')
    call suite%near('tie: not moved', maxval(abs(coordinates(3, 13:16) - 2.01_DP)), 0.0_DP, TOL)
    call generate('*TIE, NAME=T, POSITION TOLERANCE=.02;SOLE, TABLE;')
    call suite%that('tie: within a tolerance', .not. allocated(error))
    call generate('*TIE, NAME=T, POSITION TOLERANCE=.005;SOLE, TABLE;')
    call suite%that('tie: beyond it', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_SETUP .and. index(error%message, 'ties no node') > 0)
  end subroutine check_tie


  !> Nodes on a master of nodes: three equations with the nearest one each, of two as near the one of the lower label.
  subroutine check_nodal_tie()
    character(*), parameter :: DOTS = '*SURFACE, NAME=DOTS, TYPE=NODE;16;15;14;13;12;11;'
    integer, parameter :: NEAREST(4) = [11, 12, 15, 14]   ! of the nodes 21 to 24; 12 and 15 are as near to 21 and 24
    integer :: i
    call generate(DOTS // '*TIE, NAME=T, POSITION TOLERANCE=1.2, ADJUST=NO;SOLE, DOTS;')
    call suite%that('nodal tie: three for each of four nodes', .not. allocated(error) .and. size(equations) == 12)
    if (allocated(error)) return
    call suite%that('nodal tie: the nearest', all([(model%mesh%node_label(equations(i)%node(2)) == NEAREST((i + 2) / 3) .and. &
      equations(i)%dof(1) == modulo(i - 1, 3) + 1 .and. equations(i)%dof(2) == equations(i)%dof(1), i=1, 12)]))
    call suite%near('nodal tie: not moved', maxval(abs(coordinates(3, 13:16) - 2.01_DP)), 0.0_DP, TOL)
    call suite%that('nodal tie: no warning', warnings == '')
    u = 0 * model%mesh%coordinates
    u(:, 8) = [1.0_DP, 2.0_DP, 3.0_DP]             ! node 12
    u(:, 14) = u(:, 8)                             ! node 22
    call suite%near('nodal tie: moves with its master', violation('TIE'), 0.0_DP, TOL)
    u(2, 14) = 1.0_DP
    call suite%near('nodal tie: and not by itself', violation('TIE'), 1.0_DP, TOL)
    call generate(DOTS // '*TIE, NAME=T, POSITION TOLERANCE=.51;SOLE, DOTS;')
    call suite%that('nodal tie: within a tolerance', .not. allocated(error) .and. size(equations) == 6)
    call suite%that(warnings, index(warnings, 'ties 2 of 4 slave nodes') > 0)
    call suite%near('nodal tie: moved onto the node', norm2(coordinates(:, 14) - [2.0_DP, 0.0_DP, 2.0_DP]), 0.0_DP, TOL)
    call suite%near('nodal tie: not where it is not tied', coordinates(3, 13), 2.01_DP, TOL)
    call generate(DOTS // '*TIE, NAME=T;SOLE, DOTS;')   ! 5 % of 2
    call suite%that('nodal tie: beyond the default', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_SETUP .and. index(error%message, 'ties no node') > 0 &
      .and. index(error%message, 'TOLERANCE (0.1)') > 0)
  end subroutine check_nodal_tie


  !> A quarter: the faces x = 0 and y = 0 of the first cube. A field turned with the sector holds, in both senses.
  subroutine check_sector()
    character(*), parameter :: SECTOR = '*CYCLIC SYMMETRY MODEL, N=4, TIE=T;0,0,0,0,0,1;'
    call generate('*TIE, NAME=T, CYCLIC SYMMETRY;LEFT, FRONT;' // SECTOR)
    call suite%that('sector: made', .not. allocated(error))
    call check_turn()
    call generate('*TIE, NAME=T, CYCLIC SYMMETRY;FRONT, LEFT;' // SECTOR)
    call suite%that('sector: the other way', .not. allocated(error))
    call check_turn()
    call generate('*TIE, NAME=T, CYCLIC SYMMETRY;LEFT, FRONT;*CYCLIC SYMMETRY MODEL, N=5, TIE=T;0,0,0,0,0,1;')
    call suite%that('sector: another angle', allocated(error))
    if (allocated(error)) call suite%that(error%message, error%code == EXIT_SETUP .and. index(error%message, ' 2 ' // &
      'nodes have no partner') > 0)
  end subroutine check_sector


  !> u of cylindrical components that depend on radius and height alone; a node on the axis moves along it only.
  subroutine check_turn()
    integer :: i
    real(DP) :: r
    u = 0 * model%mesh%coordinates
    do i = 1, model%mesh%n_nodes
      associate (x => model%mesh%coordinates(:, i))
        r = norm2(x(:2))
        u(:2, i) = 0.5_DP * x(:2) * r + 0.25_DP * [-x(2), x(1)]
        u(3, i) = r + x(3)
      end associate
    end do
    call suite%near('sector: a field that turns', violation('CYCLIC SYMMETRY'), 0.0_DP, TOL)
    u(1, 1) = 1
    call suite%that('sector: the axis does not move sideways', violation('CYCLIC SYMMETRY') > 0.5_DP)
  end subroutine check_turn


  !> A rigid motion of the lid moves the reference node with it; its mean does, whatever else happens.
  subroutine check_coupling()
    real(DP), parameter :: SHIFT(3) = [0.5_DP, 0.25_DP, -1.0_DP], TURN(3) = [0.125_DP, 0.5_DP, 0.25_DP]
    integer :: i, reference, rotation
    call generate('*COUPLING, REF NODE=90, SURFACE=LID, CONSTRAINT NAME=C;*DISTRIBUTING;')
    call suite%that('coupling: six', .not. allocated(error) .and. size(equations) == 6)
    reference = model%distributing_couplings(1)%reference
    rotation = model%distributing_couplings(1)%rotation
    u = 0 * model%mesh%coordinates
    do i = 1, model%mesh%n_nodes
      associate (x => model%mesh%coordinates(:, i))
        u(:, i) = SHIFT + [TURN(2) * x(3) - TURN(3) * x(2), TURN(3) * x(1) - TURN(1) * x(3), TURN(1) * x(2) - TURN(2) * x(1)]
      end associate
    end do
    u(:, rotation) = TURN
    call suite%near('coupling: a rigid motion', violation('COUPLING'), 0.0_DP, TOL)
    u(1, 17:20) = u(1, 17:20) + [0.5_DP, -0.5_DP, 0.5_DP, -0.5_DP]   ! an hourglass has no mean, nor a mean rotation
    call suite%near('coupling: an hourglass', violation('COUPLING'), 0.0_DP, TOL)
    u(3, reference) = u(3, reference) + 0.5_DP
    call suite%near('coupling: the reference node away', violation('COUPLING'), 0.5_DP, TOL)
    call generate('*COUPLING, REF NODE=90, SURFACE=LID, CONSTRAINT NAME=C;*DISTRIBUTING;1,4;')
    call suite%that('coupling: one rotation', size(equations) == 4)
  end subroutine check_coupling


  !> A surface of bodies of revolution has no mean rigid motion; a model without ties has no equations.
  subroutine check_errors()
    call generate('')
    call suite%that('nothing', size(equations) == 0 .and. all(abs(coordinates - model%mesh%coordinates) <= 0))
    call generate('*NODE;31,1,9,0;32,2,9,0;33,2,10,0;34,1,10,0;*ELEMENT, TYPE=CAX4, ELSET=A;9,31,32,33,34;' // &
      '*SOLID SECTION, ELSET=A, ' // &
      'MATERIAL=M;*SURFACE, NAME=RIM;9,S2;*COUPLING, REF NODE=90, SURFACE=RIM, CONSTRAINT NAME=C;*DISTRIBUTING;')
    call suite%that('axisymmetric', allocated(error))
    if (allocated(error)) call suite%that(error%message, index(error%message, 'axisymmetric elements') > 0)
    call expect_message('*TIE, NAME=T;SOLE, NOWHERE;', 'no surface ''NOWHERE''')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_tie_generation
