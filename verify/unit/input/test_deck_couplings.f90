!> Unit test of deck_couplings: valid and rejected forms of TRANSFORM, MPC, RIGID BODY, COUPLING and PRE-TENSION SECTION.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_couplings
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, dof_direction, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_mpc_data, only: MPC_RIGID_BODY, MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE, MPC_MEAN_ROTATION
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;11,0,0,2;12,1,0,2;13,1,1,2;14,0,1,2;90,0,0,3;91,5,5,5;*ELEMENT, TYPE=C3D8, ELSET=E;' // &
    '1,1,2,3,4,5,6,7,8;2,5,6,7,8,11,12,13,14;*MATERIAL, NAME=M;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;' // &
    '*NSET, NSET=TOP;11,12,13,14;*NSET, NSET=REF;90;*SURFACE, NAME=UP;2,S2;*SURFACE, NAME=CUT;2,S1;' // &
    '*SURFACE, NAME=DOTS, TYPE=NODE;TOP;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  call test_transforms(suite)
  call test_mpcs(suite)
  call test_rigid_bodies(suite)
  call test_couplings(suite)
  call test_pretension(suite)
  call test_rotations(suite)
  call suite%finish()

contains

  !> Reads a deck whose lines are separated by semicolons, with the model part before and a step after it.
  subroutine read(text, model, diagnostics, error, dialect, step)
    character(*), intent(in) :: text
    type(model_type), intent(out) :: model
    type(diagnostic_list_type), intent(inout) :: diagnostics
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in), optional :: dialect
    character(*), intent(in), optional :: step
    type(job_options_type) :: options
    character(:), allocatable :: whole
    whole = MODEL_PART // text
    if (present(step)) then
      whole = whole // step
    else
      whole = whole // STEP_PART
    end if
    options%dialect = DIALECT_ABAQUS
    if (present(dialect)) options%dialect = dialect
    call read_deck_text(deck_lines(whole), options, model, diagnostics, error)
  end subroutine read


  !> Reads a valid deck.
  subroutine read_good(text, model, dialect, step)
    character(*), intent(in) :: text
    type(model_type), intent(out) :: model
    integer, intent(in), optional :: dialect
    character(*), intent(in), optional :: step
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    call read(text, model, diagnostics, error, dialect, step)
    if (diagnostics%n_items > 0) then
      call suite%that(text // ' is read: ' // diagnostics%items(1)%text, diagnostics%n_errors == 0)
    else
      call suite%that(text // ' is read', .not. allocated(error))
    end if
  end subroutine read_good


  !> Reads a deck that must give one error with a given piece of text.
  subroutine expect_error(text, piece, step)
    character(*), intent(in) :: text, piece
    character(*), intent(in), optional :: step
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i, n
    call read(text, model, diagnostics, error, step=step)
    call suite%that('one error: ' // piece, diagnostics%n_errors == 1 .and. allocated(error))
    n = 0
    do i = 1, diagnostics%n_items
      if (diagnostics%items(i)%is_warning) cycle
      if (index(diagnostics%items(i)%text, piece) > 0) n = n + 1
    end do
    call suite%that('it says: ' // piece, n == 1)
  end subroutine expect_error


  !> TRANSFORM, and EQUATION in its directions.
  subroutine test_transforms(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good('*TRANSFORM, NSET=TOP, TYPE=C;0,0,0,0,0,1;*EQUATION;1;13,1,1.;', model)
    call suite%near('out', maxval(abs(dof_direction(model, 11, 1) - [1.0_DP, 1.0_DP, 0.0_DP] / sqrt(2.0_DP))), 0.0_DP, &
      1.0e-14_DP)
    call suite%near('other nodes are global', maxval(abs(dof_direction(model, 1, 2) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, &
      1.0e-14_DP)
    call suite%that('the equation has two terms that may be eliminated', size(model%equations(1)%node) == 2 .and. &
      model%equations(1)%n_eliminable == 2)
    call expect_error('*TRANSFORM, NSET=TOP, TYPE=S;1,0,0,0,1,0;', 'R or C')
    call expect_error('*TRANSFORM, NSET=NIX;1,0,0,0,1,0;', 'no node or node set ''NIX''')
    call expect_error('*TRANSFORM, NSET=TOP;1,0,0,2,0,0;', 'give no directions')
    call expect_error('*TRANSFORM, NSET=TOP, TYPE=C;1,0,0,1,0,0;', 'give no directions')
    call expect_error('*TRANSFORM, NSET=TOP;', 'two points is missing')
  end subroutine test_transforms


  !> MPC of all kinds.
  subroutine test_mpcs(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good('*MPC;PLANE, TOP;STRAIGHT, 1, 5,;11, 90;', model)
    call suite%that('one plane, two lines', size(model%nonlinear_mpcs) == 3)
    call suite%that('kinds', all(model%nonlinear_mpcs%kind == [MPC_PLANE, MPC_STRAIGHT, MPC_STRAIGHT]))
    call suite%that('the fourth in the plane of three', all(model%nonlinear_mpcs(1)%node == [12, 9, 10, 11]))
    call read_good('*MPC;BEAM, 1, 7;', model, DIALECT_CALCULIX)
    call suite%that('BEAM in CalculiX', model%nonlinear_mpcs(1)%kind == MPC_DISTANCE .and. model%mesh%n_nodes == 14)
    call read_good('*MPC;BEAM, 1, 7;', model)
    call suite%that('BEAM in Abaqus', model%nonlinear_mpcs(1)%kind == MPC_RIGID_BODY .and. model%mesh%n_nodes == 15)
    call read_good('*MPC;TIE, 1, 7;PIN, 2, 8;', model)
    call suite%that('TIE and PIN', size(model%equations) == 6)
    call read_good('*MPC;MEANROT, 11, 11, 11, 12, 12, 12, 13, 13, 13, 90;', model)
    call suite%that('MEANROT', model%nonlinear_mpcs(1)%kind == MPC_MEAN_ROTATION .and. size(model%nonlinear_mpcs(1)%node) == 3)
    call suite%that('its pilot is no displacement', model%mesh%is_auxiliary(13))
    call expect_error('*MPC;WHAT, 1, 2;', 'MPC WHAT is not supported')
    call expect_error('*MPC;PLANE, 1, 2, 3;', 'three nodes')
    call expect_error('*MPC;PLANE, 1, 5, 11, 90;', 'three nodes')
    call expect_error('*MPC;DIST, 1, 1, 1, 5, 5;', 'DIST needs a node three times')
    call expect_error('*MPC;DIST, 1, 1, 1, 5, 5, 5, 90;', 'apart at the start')
    call read_good('*MPC;PLANE, 1, 5, 11, 2;', model)
    call suite%that('PLANE: three nodes that span it are found', size(model%nonlinear_mpcs) == 1 &
      .and. any(model%nonlinear_mpcs(1)%node(2:) == 2))
    call expect_error('*MPC;BEAM, 1;', 'two nodes')
    call expect_error('*MPC;PIN, 1, 2, 3;', 'two nodes')
    call expect_error('*MPC;MEANROT, 11, 90;', 'at least two nodes')
    call expect_error('*MPC;MEANROT, 11, 12, 1;', 'must not all be zero')
    call expect_error('*MPC;PLANE, NIX;', 'NIX')
  end subroutine test_mpcs


  !> RIGID BODY.
  subroutine test_rigid_bodies(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good('*RIGID BODY, NSET=TOP, REF NODE=REF, ROT NODE=91;', model)
    call suite%that('given rotation node', model%nonlinear_mpcs(1)%rotation == 14 .and. model%nonlinear_mpcs(1)%reference == 13)
    call read_good('*RIGID BODY, ELSET=E, REF NODE=90;', model)
    call suite%that('rotation node made', model%nonlinear_mpcs(1)%rotation == 15 .and. size(model%nonlinear_mpcs(1)%node) == 12)
    call expect_error('*RIGID BODY, NSET=TOP;', 'REF NODE')
    call expect_error('*RIGID BODY, NSET=TOP, REF NODE=ALL;', 'must hold one node')
    call expect_error('*RIGID BODY, NSET=TOP, REF NODE=90, ROT NODE=1;', 'belongs to an element')
    call expect_error('*RIGID BODY, REF NODE=90;', 'needs NSET or ELSET')
    call expect_error('*RIGID BODY, NSET=REF, REF NODE=90;', 'has no nodes')
    call expect_error('*RIGID BODY, POSITION=CENTER OF MASS, NSET=TOP, REF NODE=90;', 'its place')
  end subroutine test_rigid_bodies


  !> COUPLING.
  subroutine test_couplings(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: COUPLING = '*COUPLING, REF NODE=90, SURFACE=UP, CONSTRAINT NAME=C;'
    call read_good(COUPLING // '*KINEMATIC;3;5,6;', model)
    call suite%that('bound', all(model%nonlinear_mpcs(1)%is_bound .eqv. [.false., .false., .true.]))
    call read_good('*ORIENTATION, NAME=O, SYSTEM=CYLINDRICAL;0,0,0,0,0,1;*COUPLING, REF NODE=90, SURFACE=DOTS, ' // &
      'ORIENTATION=o;*KINEMATIC;', model)
    call suite%that('all bound, with axes', all(model%nonlinear_mpcs(1)%is_bound) .and. allocated(model%nonlinear_mpcs(1)%axes))
    call read_good(COUPLING // '*DISTRIBUTING;1,4;', model)
    call suite%that('distributing', all(model%distributing_couplings(1)%is_bound .eqv. [.true., .false., .false.]))
    call expect_error(COUPLING // '*MPC;PIN, 1, 2;', 'must be followed by')
    call expect_error(COUPLING // '*KINEMATIC;4,6;', 'at least one of the degrees of freedom 1 to 3')
    call expect_error(COUPLING // '*KINEMATIC;3,7;', '1 to 6')
    call expect_error('*COUPLING, REF NODE=90, SURFACE=NIX;*KINEMATIC;', 'no surface ''NIX''')
    call expect_error('*COUPLING, REF NODE=90, SURFACE=UP, ORIENTATION=O;*KINEMATIC;', 'no orientation')
    call expect_error('*COUPLING, REF NODE=90, SURFACE=DOTS;*DISTRIBUTING;', 'element faces')
  end subroutine test_couplings


  !> PRE-TENSION SECTION.
  subroutine test_pretension(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good('*PRE-TENSION SECTION, SURFACE=CUT, NODE=90;', model)
    call suite%that('four new nodes', model%mesh%n_nodes == 18 .and. size(model%equations) == 12)
    call suite%that('the upper cube has them', all(model%mesh%nodes(9:12) > 14) .and. all(model%mesh%nodes(:8) <= 14))
    call suite%that('the normal comes out of the faces', any(abs(model%equations(3)%coefficient - 1.0_DP) < 1.0e-12_DP))
    call read_good('*PRE-TENSION SECTION, SURFACE=CUT, NODE=REF;0,0,2.;', model)
    call suite%near('normal of length 1', model%equations(3)%coefficient(3), -1.0_DP, 1.0e-14_DP)
    call expect_error('*PRE-TENSION SECTION, SURFACE=CUT, NODE=90;0,0,0;', 'must not be zero')
    call expect_error('*PRE-TENSION SECTION, SURFACE=CUT, NODE=1;', 'belongs to an element')
    call expect_error('*PRE-TENSION SECTION, SURFACE=DOTS, NODE=90;', 'element faces')
    call expect_error('*PRE-TENSION SECTION, SURFACE=NIX, NODE=90;', 'no surface')
  end subroutine test_pretension


  !> Degrees of freedom 4 to 6.
  subroutine test_rotations(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: BODY = '*RIGID BODY, NSET=TOP, REF NODE=90;'
    call read_good(BODY, model, step='*STEP;*STATIC;*BOUNDARY;90,6,6,.1;*CLOAD;90,4,2.;*END STEP;')
    call suite%that('a rotation', model%steps(1)%prescribed(1)%node == 15 .and. model%steps(1)%prescribed(1)%dof == 3)
    call suite%that('a moment', model%steps(1)%concentrated(1)%node == 15 .and. model%steps(1)%concentrated(1)%dof == 1)
    call expect_error(BODY, 'TIME DELAY needs', '*STEP;*STATIC;*CLOAD, TIME DELAY=1.;90,1,1.;*END STEP;')
    call expect_error(BODY, 'no rotations', '*STEP;*STATIC;*BOUNDARY;1,6,6,.1;*END STEP;')
    call expect_error(BODY, 'no moments', '*STEP;*STATIC;*CLOAD;1,4,1.;*END STEP;')
    call expect_error(BODY, '4, 5 or 6', '*STEP;*STATIC;*CLOAD;90,7,1.;*END STEP;')
  end subroutine test_rotations

end program test_deck_couplings
