!> Unit test of deck_mpc: nodes of multi-point constraints, equations of a distributing coupling, the turn of a sector.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_mpc
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_deck_mpc, only: unique_nodes, make_rotation_node
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, gather_constraints, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_mpc_data, only: MPC_RIGID_BODY, MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE, MPC_MEAN_ROTATION
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,2,0,0;4,3,0,0;5,0,1,0;6,1,1,0;7,0,0,1;8,0,1,1;9,1,1,1;' // &
    '10,1,0,1;11,0,0,2;12,0,0,0;13,0,5,5;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,6,5,7,10,9,8;*MATERIAL, NAME=M;*ELASTIC;1.,0.;' // &
    '*SOLID SECTION, ELSET=E, MATERIAL=M;*NSET, NSET=ROW;1,2,3;*NSET, NSET=TWO;7,8;*NSET, NSET=OTHER;5,6;' // &
    '*SURFACE, NAME=LOW;1,S1;*SURFACE, NAME=TOP;1,S2;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  call check_nodes()
  call check_spans()
  call check_pairs()
  call check_mean_rotation()
  call check_distribution()
  call check_sectors()
  call suite%finish()

contains

  !> Nodes once each; one rotation node for a reference node.
  subroutine check_nodes()
    type(model_type) :: model
    integer :: first, again
    call suite%that('in their order', all(unique_nodes([5, 2, 5, 9, 2]) == [5, 2, 9]))
    call expect_read('', model)
    call make_rotation_node(model, 3, first)
    call make_rotation_node(model, 3, again)
    call gather_constraints(model)
    call suite%that('one node', first == 14 .and. again == 14 .and. model%mesh%n_nodes == 14 .and. model%rotation_of(3) == 14)
    call suite%that('without displacements, at the same place', model%mesh%is_auxiliary(14) .and. &
      all(abs(model%mesh%coordinates(:, 14) - model%mesh%coordinates(:, 3)) <= 0))
  end subroutine check_nodes


  !> PLANE takes three nodes that are not on a line, whatever their order; STRAIGHT two that are apart.
  subroutine check_spans()
    type(model_type) :: model
    real(DP) :: a(3), b(3)
    integer :: i
    call expect_read('*MPC;PLANE,1,2,3,4,5,6;', model)
    call suite%that('one for each further node', size(model%nonlinear_mpcs) == 3 .and. all(model%nonlinear_mpcs%kind == MPC_PLANE))
    associate (x => model%mesh%coordinates, n => model%nonlinear_mpcs(1)%node)
      a = x(:, n(3)) - x(:, n(2))
      b = x(:, n(4)) - x(:, n(2))
      call suite%that('its first three span a plane', abs(a(1) * b(2) - a(2) * b(1)) > 0.5_DP)
    end associate
    call suite%that('all nodes are in it', all([(any([model%nonlinear_mpcs(1)%node, model%nonlinear_mpcs(2)%node(1), &
      model%nonlinear_mpcs(3)%node(1)] == i), i=1, 6)]))
    call expect_read('*MPC;STRAIGHT,1,3,2;', model)
    call suite%that('the third on the line of two', model%nonlinear_mpcs(1)%kind == MPC_STRAIGHT .and. &
      all(model%nonlinear_mpcs(1)%node == [2, 1, 3]))
    call expect_message('*MPC;PLANE,1,2,3,4;', 'not on a line')
    call expect_message('*MPC;PLANE,1,2,5;', 'not on a line')
    call expect_message('*MPC;STRAIGHT,1,12,2;', 'two nodes that are apart')
    call expect_message('*MPC;STRAIGHT,1,2;', 'two nodes that are apart')
    call expect_message('*MPC;SLIDER,1,2;', 'SLIDER is not supported')
    call expect_message('*MPC;PLANE,1,2,5,99;', 'no node or node set ''99''')
  end subroutine check_spans


  !> Kinds of two nodes: by sets, in both dialects.
  subroutine check_pairs()
    type(model_type) :: model
    call expect_read('*MPC;LINK,TWO,OTHER;', model)
    call suite%that('two distances', size(model%nonlinear_mpcs) == 2 .and. all(model%nonlinear_mpcs%kind == MPC_DISTANCE))
    call suite%that('place by place', all(model%nonlinear_mpcs(1)%node == [7, 5]) .and. &
      all(model%nonlinear_mpcs(2)%node == [8, 6]))
    call expect_read('*MPC;BEAM,TWO,11;', model)
    call suite%that('two bodies with one node', size(model%nonlinear_mpcs) == 2 .and. all(model%nonlinear_mpcs%kind == &
      MPC_RIGID_BODY) .and. all(model%nonlinear_mpcs%reference == 11) .and. all(model%nonlinear_mpcs%rotation == 14))
    call expect_read('*MPC;BEAM,7,11;', model, DIALECT_CALCULIX)
    call suite%that('a rod', model%nonlinear_mpcs(1)%kind == MPC_DISTANCE .and. model%mesh%n_nodes == 13)
    call expect_read('*MPC;TIE,7,8;', model)
    call suite%that('three equations', size(model%equations) == 3 .and. all(model%equations(2)%node == [7, 8]) .and. &
      all(model%equations(2)%dof == 2))
    call suite%near('equal displacements', maxval(abs(model%equations(2)%coefficient - [1.0_DP, -1.0_DP])), 0.0_DP, 0.0_DP)
    call expect_message('*MPC;PIN,ROW,TWO;', 'Here are 3 and 2')
    call expect_message('*MPC;LINEAR,ROW,TWO,TWO;', 'Here are 3, 2 and 2')
    call expect_message('*MPC;LINK,7;', 'BEAM and LINK need two nodes')
    call expect_message('*MPC;TIE,7,7;', 'TIE and PIN need two nodes')
  end subroutine check_pairs


  !> MEANROT: the last node is the pilot, its coordinates the axis.
  subroutine check_mean_rotation()
    type(model_type) :: model
    call expect_read('*MPC;MEANROT,TWO,OTHER,13;', model)
    associate (mpc => model%nonlinear_mpcs(1))
      call suite%that('kind and pilot', mpc%kind == MPC_MEAN_ROTATION .and. mpc%reference == 13 .and. all(mpc%node == [7, 8, 5, 6]))
      call suite%near('unit axis', maxval(abs(mpc%axis - [0.0_DP, 1.0_DP, 1.0_DP] / sqrt(2.0_DP))), 0.0_DP, 1.0e-15_DP)
    end associate
    call suite%that('the pilot has no displacement', model%mesh%is_auxiliary(13))
    call expect_message('*MPC;MEANROT,7,13;', 'at least two nodes and the pilot')
    call expect_message('*MPC;MEANROT,7,8,12;', 'must not all be zero')
  end subroutine check_mean_rotation


  !> DISTRIBUTING COUPLING: sum of w u = (sum of w) u of the reference node; the first of the list is eliminated. Under the abaqus
  !! dialect a distributing coupling of nodes with weights.
  subroutine check_distribution()
    type(model_type) :: model
    character(*), parameter :: POINT = '*ELEMENT, TYPE=DCOUP3D, ELSET=D;50,11;'
    call expect_read(POINT // '*DISTRIBUTING COUPLING, ELSET=D;TWO,2.;5,3.;', model, DIALECT_CALCULIX)
    call suite%that('three equations', size(model%equations) == 3)
    associate (equation => model%equations(3))
      call suite%that('nodes', all(equation%node == [7, 8, 5, 11]) .and. all(equation%dof == 3))
      call suite%near('weights', maxval(abs(equation%coefficient - [2.0_DP, 2.0_DP, 3.0_DP, -7.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call expect_message(POINT // '*DISTRIBUTING COUPLING, ELSET=D;TWO,0.;', 'must be positive', DIALECT_CALCULIX)
    call expect_message(POINT // '*DISTRIBUTING COUPLING, ELSET=D;', 'data are missing', DIALECT_CALCULIX)
    call expect_message('*DISTRIBUTING COUPLING, ELSET=E;TWO,1.;', 'one element of type DCOUP3D', DIALECT_CALCULIX)
    call expect_read(POINT // '*DISTRIBUTING COUPLING, ELSET=D;TWO,2.;5,3.;7,1.;', model, DIALECT_ABAQUS)
    associate (coupling => model%distributing_couplings(1))
      call suite%that('nodes and rotation', all(coupling%nodes == [5, 7, 8]) .and. coupling%reference == 11 .and. &
        coupling%rotation > 0 .and. all(coupling%is_bound))
      call suite%near('their weights', maxval(abs(coupling%weight - [3.0_DP, 3.0_DP, 2.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call expect_message(POINT // '*DISTRIBUTING COUPLING, ELSET=D;11,1.;', 'is itself in the list', DIALECT_ABAQUS)
  end subroutine check_distribution


  !> CYCLIC SYMMETRY MODEL: the rotation by 2 pi over N about the axis, through its first point.
  subroutine check_sectors()
    type(model_type) :: model
    character(*), parameter :: TIE = '*TIE, NAME=T, CYCLIC SYMMETRY;LOW,TOP;'
    call expect_read(TIE // '*CYCLIC SYMMETRY MODEL, N=4, TIE=T;1,2,3,1,2,9;', model)
    call suite%near('centre', maxval(abs(model%ties(1)%centre - [1.0_DP, 2.0_DP, 3.0_DP])), 0.0_DP, 0.0_DP)
    call suite%near('a quarter: x to y', maxval(abs(matmul(model%ties(1)%turn, [1.0_DP, 0.0_DP, 5.0_DP]) - &
      [0.0_DP, 1.0_DP, 5.0_DP])), 0.0_DP, 1.0e-15_DP)
    call expect_read(TIE // '*CYCLIC SYMMETRY MODEL, N=3, TIE=T;0,0,0,2,2,2;', model)
    call suite%near('a third about the diagonal: x to y to z', maxval(abs(matmul(model%ties(1)%turn, [1.0_DP, 2.0_DP, 3.0_DP]) - &
      [3.0_DP, 1.0_DP, 2.0_DP])), 0.0_DP, 1.0e-14_DP)
    call expect_message(TIE, 'no *CYCLIC SYMMETRY MODEL, TIE=T')
    call expect_message(TIE // '*CYCLIC SYMMETRY MODEL, N=1, TIE=T;0,0,0,0,0,1;', 'at least 2')
    call expect_message(TIE // '*CYCLIC SYMMETRY MODEL, N=4, TIE=T;0,0,1,0,0,1;', 'must differ')
    call expect_message('*TIE, NAME=U;LOW,TOP;*CYCLIC SYMMETRY MODEL, N=4, TIE=U;0,0,0,0,0,1;', 'no *TIE, NAME=U, CYCLIC')
  end subroutine check_sectors


  include 'sample_deck.inc'

end program test_deck_mpc
