!> Unit test of deck_parts: numbers, names and places of instances, sets of the assembly, cards that move with a part, refusals.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_parts
  use amontons_kinds, only: DP
  use amontons_analytic_profiles, only: PROFILE_EXTRUDED
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_mesh, only: set_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*PART, NAME=P;*NODE, NSET=ALL;1,0,0,0;2,2,0,0;3,2,1,0;4,0,1,0;5,0,0,1;6,2,0,1;' // &
    '7,2,1,1;8,0,1,1;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,;5,6,7,8;*NSET, NSET=N, GENERATE;1,7,3;*SURFACE, NAME=S;E,S2;' // &
    '*SOLID SECTION, ELSET=E, MATERIAL=M;'
  character(*), parameter :: STEP_PART = '*MATERIAL, NAME=M;*ELASTIC;1.,0.;*STEP;*STATIC;*END STEP;'
  character(*), parameter :: DONE = '*END PART;*ASSEMBLY, NAME=A;', ONE = '*INSTANCE, NAME=I, PART=P;*END INSTANCE;', &
    END = '*END ASSEMBLY;', TURNED = '*INSTANCE, NAME=J, PART=P;10,0,0;10,0,0,10,0,5,90;*END INSTANCE;'
  real(DP), parameter :: TOL = 1.0e-14_DP            ! rounding of coordinates of size 10
  type(suite_type) :: suite
  type(model_type) :: model
  call check_numbers()
  call check_places()
  call check_assembly()
  call check_moving_cards()
  call check_references()
  call check_errors()
  call suite%finish()

contains

  !> The place of a set; 0: it does not exist.
  integer function find_set(sets, name) result(i)
    type(set_type), intent(in) :: sets(:)
    character(*), intent(in) :: name
    do i = 1, size(sets)
      if (sets(i)%name == name) return
    end do
    i = 0
  end function find_set


  !> Members of a node set by label.
  subroutine expect_nodes(name, labels)
    character(*), intent(in) :: name
    integer, intent(in) :: labels(:)
    integer :: i
    i = find_set(model%mesh%node_sets, name)
    call suite%that('set ' // name, i > 0)
    if (i == 0) return
    call suite%that('size of ' // name, size(model%mesh%node_sets(i)%members) == size(labels))
    if (size(model%mesh%node_sets(i)%members) /= size(labels)) return
    call suite%that('members of ' // name, all(model%mesh%node_label(model%mesh%node_sets(i)%members) == labels))
  end subroutine expect_nodes


  !> The first instance keeps the numbers of its part, the next ones are higher; names become INSTANCE.NAME; ranges keep their step.
  subroutine check_numbers()
    call expect_read(DONE // ONE // TURNED // END, model)
    call suite%that('two cubes', model%mesh%n_nodes == 16 .and. model%mesh%n_elements == 2 .and. &
      all(model%mesh%element_label == [1, 2]))   ! rows that continue an element have no label
    call suite%that('nodes of the second', all(model%mesh%node_label(model%mesh%nodes(9:)) == [9, 10, 11, 12, 13, 14, 15, 16]))
    call expect_nodes('I.N', [1, 4, 7])
    call expect_nodes('J.N', [9, 12, 15])
    call suite%that('surfaces', size(model%surfaces) == 2 .and. model%surfaces(2)%name == 'J.S' .and. &
      model%surfaces(2)%element(1) == 2)
    call suite%that('sections', all(model%mesh%material == 1))
    call expect_message(DONE // ONE // TURNED // END, 'Of the instance J the numbers of nodes are 8,', &
      is_note=.true.)
    call expect_message(DONE // '*INSTANCE, NAME=I, PART=P;*END INSTANCE;*INSTANCE, NAME=K, PART=Q;*END INSTANCE;' // END, &
      'There is no part ''Q''')
  end subroutine check_numbers


  !> Translation first, then the rotation about the axis.
  subroutine check_places()
    call expect_read(DONE // ONE // TURNED // END, model)
    call suite%near('the first stays', maxval(abs(model%mesh%coordinates(:, 2) - [2.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
    call suite%near('the second: x to y about (10, 0)', maxval(abs(model%mesh%coordinates(:, 10) - [10.0_DP, 2.0_DP, 0.0_DP])), &
      0.0_DP, TOL)
    call suite%near('y to -x', maxval(abs(model%mesh%coordinates(:, 16) - [9.0_DP, 0.0_DP, 1.0_DP])), 0.0_DP, TOL)
    call expect_read(DONE // '*INSTANCE, NAME=I, PART=P;0,0,0;0,0,0,1,1,1,120;*END INSTANCE;' // END, model)
    call suite%near('a third about the diagonal', maxval(abs(model%mesh%coordinates(:, 3) - [0.0_DP, 2.0_DP, 1.0_DP])), 0.0_DP, TOL)
  end subroutine check_places


  !> Nodes, elements and sets of the assembly, by instance; the numbers of its own nodes come last.
  subroutine check_assembly()
    call expect_read(DONE // ONE // TURNED // '*NODE, NSET=REF;1,5,5,5;*NSET, NSET=B, INSTANCE=J;1,2;*NSET, NSET=B, ' // &
      'INSTANCE=I;N,;*NSET, NSET=C;J.N,I.8;*ELSET, ELSET=EE, INSTANCE=J;E;*SURFACE, NAME=T;EE,S1;' // END, model)
    call suite%that('the node of the assembly', model%mesh%n_nodes == 17 .and. model%mesh%node_label(17) == 17)
    call suite%near('at its place', model%mesh%coordinates(1, 17), 5.0_DP, 0.0_DP)
    call expect_nodes('REF', [17])
    call expect_nodes('B', [1, 4, 7, 9, 10])
    call expect_nodes('C', [8, 9, 12, 15])
    call suite%that('its surface', model%surfaces(size(model%surfaces))%element(1) == 2)
  end subroutine check_assembly


  !> Orientations turn with an instance, analytic surfaces move with it; equations and supports are renumbered.
  subroutine check_moving_cards()
    call expect_read('*ORIENTATION, NAME=O;1,0,0,0,1,0;' // DONE // ONE // TURNED // END, model)
    call suite%that('two', size(model%orientations) == 2 .and. model%orientations(2)%name == 'J.O')
    call suite%near('turned, not moved', maxval(abs(model%orientations(2)%a - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, TOL)
    call expect_read('*ORIENTATION, NAME=O;1,0,0,0,1,0;*NODE;11,5,5,5;12,6,5,5;13,6,6,5;14,5,6,5;*ELEMENT, TYPE=S4, ELSET=W;9,' // &
      '11,12,13,14;*SHELL SECTION, ELSET=W, COMPOSITE;.1,3,M,O;.1,3,M,30.;' // DONE // ONE // TURNED // END, model)
    call suite%that('layers', size(model%orientations) == 6)
    if (size(model%orientations) == 6) call suite%near('orientation or angle', model%orientations(4)%layer_angle, &
      acos(-1.0_DP) / 6, TOL)
    call expect_read('*EQUATION;2;1,1,1.,2,1,-1.;' // DONE // ONE // '*INSTANCE, NAME=J, PART=P;5,0,0;*END INSTANCE;' // END, &
      model)
    call suite%that('an equation each', size(model%equations) == 2 .and. all(model%equations(2)%node == [9, 10]) .and. &
      all(model%equations(2)%dof == 1))
    call expect_read('*BOUNDARY;N,1,1,.5;' // DONE // '*INSTANCE, NAME=J, PART=P;5,0,0;*END INSTANCE;' // END, model)
    call suite%that('supports of a part', all(model%steps(1)%prescribed%node == [1, 4, 7]))
    call expect_read('*NODE;9,5,5,5;*SURFACE, NAME=R, TYPE=CYLINDER;START,0,0;LINE,4,0;*RIGID BODY, ANALYTICAL SURFACE=R, ' // &
      'REF NODE=9;' // DONE // TURNED // END, model)
    associate (p => model%surfaces(2)%profile)
      call suite%that('of the instance', p%kind == PROFILE_EXTRUDED .and. model%surfaces(2)%name == 'J.R')
      call suite%near('origin', maxval(abs(p%origin - [10.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
      call suite%near('x turned to y', maxval(abs(p%axes(:, 1) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, TOL)
    end associate
  end subroutine check_moving_cards


  !> Cards of steps name INSTANCE.SET and INSTANCE.NUMBER.
  subroutine check_references()
    character(*), parameter :: MATERIAL = '*MATERIAL, NAME=M;*ELASTIC;1.,0.;'
    call expect_read(DONE // ONE // TURNED // END, model, step=MATERIAL // &
      '*STEP;*STATIC;*BOUNDARY;I.N,1;J.3,2;*CLOAD;J.8,1,1.;' // &
      '*END STEP;')
    call suite%that('set and number', all(model%steps(1)%prescribed%node == [1, 4, 7, 11]) .and. &
      model%steps(1)%concentrated(1)%node == 16)
    call expect_read(DONE // ONE // TURNED // '*ELSET, ELSET=X;J.1,;*SURFACE, NAME=T;J.1,S1;' // END, model, step=MATERIAL // &
      '*STEP;*STATIC;*DLOAD;J.1,P2,1.;*END STEP;')   ! numbers of elements, of which a part has fewer than nodes
    call suite%that('elements', all(model%mesh%element_sets(find_set(model%mesh%element_sets, 'X'))%members == [2]) .and. &
      all(model%surfaces(size(model%surfaces))%element == [2]) .and. model%steps(1)%distributed(1)%element == 2)
  end subroutine check_references


  !> What is refused.
  subroutine check_errors()
    call expect_message(ONE, '*INSTANCE must be between', step='*END PART;' // STEP_PART)
    call expect_message('*PART, NAME=Q;' // DONE // ONE // END, 'This part has no *END PART before *PART, NAME=Q;')
    call expect_message('*ASSEMBLY, NAME=A;' // ONE // END, 'This part has no *END PART before *ASSEMBLY, NAME=A;')
    call expect_message('', 'This part has no *END PART before *STEP; write it after the last card of the part. A deck')
    call expect_message(DONE // ONE, 'A step must be after *END ASSEMBLY.')
    call expect_message(DONE // '*INSTANCE, NAME=K, PART=P;' // ONE // END, 'no *END INSTANCE')
    call expect_message(DONE // '*INSTANCE, NAME=I, PART=P;1,2,3,4;*END INSTANCE;' // END, 'at most two data lines')
    call expect_message(DONE // '*INSTANCE, NAME=I, PART=P;0,0,0;1,1,1,1,1,1,9;*END INSTANCE;' // END, 'must differ')
    call expect_message(DONE // '*INSTANCE, NAME=I, PART=P;x,0,0;*END INSTANCE;' // END, 'Field 1 must be a real number')
    call expect_message(DONE // ONE // ONE // END, 'is defined twice')
    call expect_message(DONE // '*INSTANCE, NAME=I;*END INSTANCE;' // END, 'needs the parameter PART=name')
    call expect_message(DONE // ONE // '*NSET, NSET=X, INSTANCE=K;1;' // END, 'There is no instance ''K''')
    call expect_message('*BOUNDARY;N,1;' // DONE // TURNED // END, 'whose instance is rotated')
    call expect_message('*NODE, SYSTEM=C;9,1,90,0;' // DONE // TURNED // END, 'give Cartesian coordinates')
    call expect_message('*PRE-TENSION SECTION, SURFACE=S, NODE=1;0,0,1;' // DONE // TURNED // END, 'inside a part or an instance')
    call expect_message('*CLOAD;1,1,1.;' // DONE // TURNED // END, 'write it after *END ASSEMBLY')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_parts
