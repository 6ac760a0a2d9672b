!> Unit test of deck_structure: sections, thickness, faces and loads of shells and beams, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_structure
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=N;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,3,0,0;6,4,0,0;*MATERIAL, NAME=M;' // &
    '*ELASTIC;100.,0.3;*ELEMENT, TYPE=S4, ELSET=E;1,1,2,3,4;*ELEMENT, TYPE=B31, ELSET=B;2,5,6;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: SHELL = '*SHELL SECTION, ELSET=E, MATERIAL=M;.1;'
  character(*), parameter :: BEAM = '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT;.1,.2;0,1,0;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_sections()
  call check_surfaces()
  call check_loads()
  call check_layers()
  call check_contact()
  call check_transforms()
  call check_temperatures()
  call check_errors()
  call suite%finish()

contains

  !> Thickness of a section and of nodes, offsets, default direction of a beam.
  subroutine check_sections()
    call expect_read(SHELL // '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT, OFFSET2=-.5;.1,.2;', model)
    associate (d => model%structure%directors)
      call suite%near('thickness', maxval(abs(d(:4)%thickness(1) - 0.1_DP)), 0.0_DP, 0.0_DP)
      call suite%near('default direction', norm2(d(5)%axes(:, 1) - [0.0_DP, 0.0_DP, -1.0_DP]), 0.0_DP, 0.0_DP)
      call suite%near('offset', norm2(d(5)%offset - [0.0_DP, -0.5_DP]), 0.0_DP, 0.0_DP)
    end associate
    call expect_read('*SHELL SECTION, ELSET=E, MATERIAL=M, NODAL THICKNESS;.1;*NODAL THICKNESS;2,.3;' // BEAM, model)
    call suite%near('of nodes', sum(abs(model%structure%directors(:4)%thickness(1) - [0.1_DP, 0.3_DP, 0.1_DP, 0.1_DP])), 0.0_DP, &
      0.0_DP)
  end subroutine check_sections


  !> SPOS, SNEG, edges; a set alone gives both sides.
  subroutine check_surfaces()
    call expect_read(SHELL // BEAM // '*SURFACE, NAME=A;E,SPOS;*SURFACE, NAME=C;1,SNEG;*SURFACE, NAME=D;E,E3;*SURFACE, ' // &
      'NAME=F;E;', model)
    call suite%that('faces', all([model%surfaces(1)%face, model%surfaces(2)%face, model%surfaces(3)%face] == [2, 1, 5]))
    call suite%that('both sides', size(model%surfaces(4)%face) == 2 .and. all(model%surfaces(4)%face <= 2))
    call suite%near('the top', minval(model%mesh%coordinates(3, model%surfaces(1)%nodes)), 0.05_DP, 1.0e-15_DP)
    call expect_read(SHELL // BEAM // '*SURFACE, NAME=A;E,S2;', model, DIALECT_CALCULIX)
    call suite%that('calculix: S2 is SPOS', all(model%surfaces(1)%face == [2]))
  end subroutine check_surfaces


  !> P acts on the bottom, EDNOR on an edge as a force per length.
  subroutine check_loads()
    call expect_read(SHELL // BEAM, model, step='*STEP;*STATIC;*DLOAD;E,P,2.;1,EDNOR2,3.;*END STEP;')
    associate (loads => model%steps(1)%distributed)
      call suite%that('faces', size(loads) == 2 .and. all(loads%element == 1) .and. all(loads%face == [1, 4]))
      call suite%near('pressures', sum(abs(loads%end - [2.0_DP, 30.0_DP])), 0.0_DP, 1.0e-14_DP)
    end associate
  end subroutine check_loads


  !> A stack of two layers of 0.1 and 0.3: labels, materials, faces, loads on both sides, axes.
  subroutine check_layers()
    call expect_read('*MATERIAL, NAME=M2;*ELASTIC;7.,0.;*SHELL SECTION, ELSET=E, COMPOSITE;.1,3,M,90.;.3,3,M2,0.;' // BEAM // &
      '*SURFACE, NAME=A;E,SPOS;*SURFACE, NAME=C;1,SNEG;*SURFACE, NAME=D;1,E2;*SURFACE, NAME=F;E;', model, &
      step='*STEP;*STATIC;*DLOAD;1,P,2.;1,EDNOR2,3.;*END STEP;')
    associate (mesh => model%mesh, loads => model%steps(1)%distributed)
      call suite%that('labels', all(mesh%element_label(:2) == [1, 11]))
      call suite%that('materials', model%materials(mesh%material(1))%name /= model%materials(mesh%material(2))%name)
      call suite%near('place of the interface', mesh%coordinates(3, mesh%nodes(mesh%first(2))), -0.1_DP, 1.0e-15_DP)
      call suite%that('one load on the bottom, two on the edge', all(loads%element == [1, 1, 2]) .and. &
        all(loads%face == [1, 4, 4]))
      call suite%near('over the whole thickness', loads(3)%end, 7.5_DP, 1.0e-14_DP)
    end associate
    call suite%that('top', all(model%surfaces(1)%element == [2]) .and. all(model%surfaces(1)%face == [2]))
    call suite%that('bottom', all(model%surfaces(2)%element == [1]) .and. all(model%surfaces(2)%face == [1]))
    call suite%that('edge', all(model%surfaces(3)%element == [1, 2]) .and. all(model%surfaces(3)%face == [4, 4]))
    call suite%that('both sides', all(model%surfaces(4)%element == [1, 2]) .and. all(model%surfaces(4)%face == [1, 2]))
    associate (axes => model%orientations(model%element_orientation(:2)))
      call suite%near('angle', sum(abs(axes%layer_angle - [acos(0.0_DP), 0.0_DP])), 0.0_DP, 1.0e-14_DP)
      call suite%that('projected', all(axes%is_projected))
    end associate
  end subroutine check_layers


  !> In ties slave nodes are eliminated last; slave nodes of knots are reported.
  subroutine check_contact()
    character(*), parameter :: PAIR = '*NODE;21,0,0,.2;22,1,0,.2;23,1,1,.2;24,0,1,.2;*ELEMENT, TYPE=S4, ELSET=U;' // &
      '21,21,22,23,24;*SHELL SECTION, ELSET=U, MATERIAL=M;.1;*SURFACE, NAME=A;U,SNEG;*SURFACE, NAME=C;E,SPOS;' // &
      '*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I;A,C;'
    integer :: i
    call expect_read(SHELL // BEAM // PAIR, model)
    do i = 1, size(model%equations)
      associate (last => model%equations(i)%node(size(model%equations(i)%node)))
        if (model%mesh%node_label(model%equations(i)%node(1)) < 21) cycle
        call suite%that('the slave comes last', any(model%surfaces(1)%nodes == last))
      end associate
    end do
    call expect_message(SHELL // BEAM // PAIR // '*BOUNDARY;21,1,6;', '1 slave node', is_note=.true.)
  end subroutine check_contact


  !> TRANSFORM: the rotations of a node have its directions too; a force at it stays there.
  subroutine check_transforms()
    call expect_read(SHELL // BEAM // '*NSET, NSET=T;1;*TRANSFORM, NSET=T;0,1,0,-1,0,0;*BOUNDARY;1,4,4;', model, &
      step='*STEP;*STATIC;*CLOAD;1,1,3.;2,1,4.;*END STEP;')
    call suite%that('a rotation node', model%rotation_of(1) > 0)
    call suite%that('its directions', model%frame_of(model%rotation_of(1)) == model%frame_of(1) .and. model%frame_of(1) > 0)
    call suite%that('forces', count(model%steps(1)%concentrated%node == 1) == 1 .and. &
      size(model%steps(1)%concentrated) == 3)
  end subroutine check_transforms


  !> A gradient through the thickness.
  subroutine check_temperatures()
    call expect_read(SHELL // BEAM // '*INITIAL CONDITIONS, TYPE=TEMPERATURE;N,10.,100.;', model)
    associate (d => model%structure%directors(1), t => model%initial_temperature)
      call suite%near('shell', norm2(t([d%node, d%nodes(1), d%nodes(2)]) - [10.0_DP, 5.0_DP, 15.0_DP]), 0.0_DP, 1.0e-13_DP)
    end associate
    associate (d => model%structure%directors(5), t => model%initial_temperature)
      call suite%near('beam, along direction 2', norm2(t(d%nodes(:4)) - [20.0_DP, 0.0_DP, 0.0_DP, 20.0_DP]), 0.0_DP, 1.0e-13_DP)
    end associate
  end subroutine check_temperatures


  !> What is refused.
  subroutine check_errors()
    call expect_message(SHELL, 'no section: no *BEAM SECTION')
    call expect_message(BEAM, 'no section: no *SHELL SECTION')
    call expect_message(SHELL // '*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT;.1,.2;' // BEAM, 'is for beams')
    call expect_message(SHELL // BEAM // '*SOLID SECTION, ELSET=E, MATERIAL=M;', 'shells a *SHELL SECTION')
    call expect_message('*SHELL SECTION, ELSET=E, MATERIAL=M;-.1;' // BEAM, 'thickness must be positive')
    call expect_message('*SHELL SECTION, ELSET=E, MATERIAL=M;' // BEAM, 'needs a data line')
    call expect_message('*SHELL SECTION, ELSET=E, MATERIAL=M, OFFSET=TOP;.1;' // BEAM, 'OFFSET must be a number')
    call expect_message('*SHELL SECTION, ELSET=E, MATERIAL=M, COMPOSITE;.1,,M;' // BEAM, 'leave MATERIAL out')
    call expect_message('*SHELL SECTION, ELSET=E;.1;' // BEAM, 'needs MATERIAL, or COMPOSITE')
    call expect_message('*SHELL SECTION, ELSET=E, COMPOSITE;' // BEAM, 'needs a data line for each layer')
    call expect_message('*SHELL SECTION, ELSET=E, COMPOSITE;.1,3,X;' // BEAM, 'there is no material ''X''')
    call expect_message('*SHELL SECTION, ELSET=E, COMPOSITE;0.,3,M;' // BEAM, 'thickness must be positive')
    call expect_message('*SHELL SECTION, ELSET=E, COMPOSITE;.1,3,M,O;' // BEAM, 'There is no orientation ''O''')
    call expect_message('*SHELL SECTION, ELSET=E, MATERIAL=M, ORIENTATION=O;.1;' // BEAM, 'There is no orientation ''O''')
    call expect_message('*MATERIAL, NAME=L;*ELASTIC, TYPE=LAMINA;9,9,0,9,9,9;' // SHELL // '*BEAM SECTION, ELSET=B, ' // &
      'MATERIAL=L, SECTION=RECT;.1,.2;0,1,0;', 'LAMINA, which is for shells')
    call expect_message(SHELL // '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=HEX;.1,.2;', 'HEX')
    call expect_message(SHELL // '*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT;.1,0.;', 'dimensions must be positive')
    call expect_message('*SHELL SECTION, ELSET=E, MATERIAL=M;.001;' // BEAM, 'too thin at element 1')
    call expect_message(SHELL // BEAM // '*NORMAL;1,2,0,0,0;', 'normal must not be zero')
    call expect_message('*SHELL SECTION, ELSET=E, MATERIAL=M, NODAL THICKNESS;*NODAL THICKNESS;1,.1;2,.1;3,.1;' // BEAM, &
      'The node 4 has no thickness')
    call expect_message(SHELL // BEAM // '*SURFACE, NAME=A;B,SPOS;', 'has no face SPOS')
    call expect_message(SHELL // BEAM // '*MPC;BEAM,1,5;', 'binds rotations', DIALECT_CALCULIX)
    call expect_message(SHELL // BEAM // '*MPC;TIE,1,5;', 'at one place')
    call expect_message('*NODE;9,9,9,9;' // SHELL // BEAM // '*SURFACE, NAME=A, TYPE=NODE;1;2;*COUPLING, REF NODE=9, ' // &
      'SURFACE=A, CONSTRAINT NAME=C;*KINEMATIC;1,4;', 'binds all three')
    call expect_message(SHELL // BEAM, 'takes no load P1', step='*STEP;*STATIC;*DLOAD;E,P1,2.;*END STEP;')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_structure
