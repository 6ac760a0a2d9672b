!> Unit test of deck: each card's valid form and its errors, and the propagation of loads over steps.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck, read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type, EXIT_DECK, EXIT_IO
  use amontons_loads, only: prescribed_type, concentrated_type, distributed_type, DISTRIBUTED_GRAVITY, &
    DISTRIBUTED_PRESSURE
  use amontons_materials, only: LAW_HENCKY, LAW_SAINT_VENANT
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_steps, only: step_type, LINE_SEARCH_AUTO, LINE_SEARCH_NODAL, LINE_SEARCH_NONE, PRINT_NODE, PRINT_ELEMENT, &
    PRINT_CONTACT, &
    N_FRD, FRD_DISP, FRD_STRESS, FRD_TOSTRAIN, FRD_CONTACT, FRD_SDV, FRD_ERROR
  use amontons_text, only: NEWLINE, to_text
  use amontons_element_kinds, only: KIND_C3D4, KIND_C3D6, KIND_C3D8, KIND_C3D8_FULL, KIND_C3D8I, KIND_C3D10, KIND_C3D20, &
    KIND_CPS4, &
    KIND_CPE4, KIND_T3D3, KIND_SPRINGA, KIND_SPRING2, KIND_MASS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: NL = NEWLINE
  ! Two cubes of side 1: element 1 below (z from 0 to 1), element 2 above it with nodes of its own (z from 1 to 2).
  character(*), parameter :: NODES = '*NODE, NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,' // &
    '1,1;11,0,0,1;12,1,0,1;13,1,1,1;14,0,1,1;15,0,0,2;16,1,0,2;17,1,1,2;18,0,1,2;'
  character(*), parameter :: CUBES = '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;2,11,12,13,14,15,16,17,18;'
  character(*), parameter :: STEEL = '*MATERIAL, NAME=steel;*ELASTIC;210000, .3;*DENSITY;7.8e-9;*SOLID SECTION, ' // &
    'ELSET=E, MATERIAL=STEEL;'
  character(*), parameter :: SETS = '*NSET, NSET=bot;1,2,3,4;*NSET, NSET=TOP;15,16,17,18;'
  character(*), parameter :: MODEL_PART = NODES // CUBES // STEEL // SETS
  character(*), parameter :: STEP_START = '*STEP;*STATIC;.1, 1.;'
  character(*), parameter :: STEP_END = '*END STEP;'
  character(*), parameter :: STEP_PART = STEP_START // STEP_END
  character(*), parameter :: SURFACES = '*SURFACE, NAME=low;1, S2;*SURFACE, NAME=high;2,S1;'
  type(suite_type) :: suite
  call test_whole(suite)
  call test_order(suite)
  call test_files(suite)
  call test_dialect(suite)
  call test_nodes(suite)
  call test_elements(suite)
  call test_sections(suite)
  call test_leftovers(suite)
  call test_sets(suite)
  call test_materials(suite)
  call test_surfaces(suite)
  call test_interactions(suite)
  call test_pairs(suite)
  call test_amplitudes(suite)
  call test_equations(suite)
  call test_boundary(suite)
  call test_boundary_steps(suite)
  call test_cload(suite)
  call test_cload_steps(suite)
  call test_dload(suite)
  call test_steps(suite)
  call test_static(suite)
  call test_controls(suite)
  call test_line_search(suite)
  call test_prints(suite)
  call test_file_cards(suite)
  call test_refused(suite)
  call test_several_errors(suite)
  call suite%finish()

contains

  !> Reads a deck and returns the outcome. In the decks of this test a semicolon ends a line.
  subroutine read(text, model, diagnostics, error, dialect)
    character(*), intent(in) :: text
    type(model_type), intent(out) :: model
    type(diagnostic_list_type), intent(out) :: diagnostics
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in), optional :: dialect
    type(job_options_type) :: options
    if (present(dialect)) options%dialect = dialect
    call read_deck_text(deck_lines(text), options, model, diagnostics, error)
  end subroutine read


  !> Reads a valid deck.
  subroutine read_good(suite, name, text, model, n_notes, dialect)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: name, text
    type(model_type), intent(out) :: model
    integer, intent(in), optional :: n_notes     !< notes expected, default 0
    integer, intent(in), optional :: dialect
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: n
    call read(text, model, diagnostics, error, dialect)
    call suite%that(name // ' is read' // first_text(diagnostics), .not. allocated(error) .and. diagnostics%n_errors == 0)
    n = 0
    if (present(n_notes)) n = n_notes
    call suite%that(name // ' gives ' // to_text(n) // ' notes, not ' // to_text(diagnostics%n_warnings) // &
      first_text(diagnostics), diagnostics%n_warnings == n)
  end subroutine read_good


  !> Reads a deck that must give exactly one error, with a given piece of text in its message, at a given line.
  subroutine expect_error(suite, text, piece, line, dialect)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: text
    character(*), intent(in) :: piece            !< part of the message
    character(*), intent(in), optional :: line   !< the line as written; absent: not compared
    integer, intent(in), optional :: dialect
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    call read(text, model, diagnostics, error, dialect)
    call suite%that('one error for: ' // piece // first_text(diagnostics), diagnostics%n_errors == 1)
    call suite%that('deck is refused for: ' // piece, allocated(error))
    if (.not. allocated(error)) return
    call suite%that('exit code for: ' // piece, error%code == EXIT_DECK .and. error%message == '1 error in the deck.')
    do i = 1, diagnostics%n_items
      if (diagnostics%items(i)%is_warning) cycle
      call suite%that('message has: ' // piece // ' / ' // diagnostics%items(i)%text, index(diagnostics%items(i)%text, &
        piece) > 0)
      if (present(line)) call suite%that('line of: ' // piece // ' / ' // diagnostics%items(i)%card, &
        diagnostics%items(i)%card == line .and. diagnostics%items(i)%line > 0)
      return
    end do
  end subroutine expect_error


  !> The first error, for the name of a check.
  function first_text(diagnostics) result(text)
    type(diagnostic_list_type), intent(in) :: diagnostics
    character(:), allocatable :: text
    text = ''
    if (diagnostics%n_items > 0) text = ' [' // diagnostics%items(1)%text // ']'
  end function first_text


  !> The whole deck of two cubes.
  subroutine test_whole(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'whole deck', '*HEADING; Two cubes;** no;Unit system: mm;' // MODEL_PART // SURFACES // &
      '*SURFACE INTERACTION, NAME=I;*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD;*FRICTION;.3;*CONTACT PAIR, ' // &
      'INTERACTION=i, TYPE=NODE TO SURFACE;high, LOW;*BOUNDARY;BOT,1,3;' // STEP_START // '*BOUNDARY;top,3,3,-.01;' // &
      STEP_END, model)
    call suite%that('heading', model%heading == 'Two cubes' // NL // 'Unit system: mm')
    call suite%that('deck text', index(model%deck_text, '*SURFACE, NAME=high' // NL // '2,S1') > 0)
    call suite%that('dialect', model%dialect == DIALECT_ABAQUS)
    call suite%that('mesh sizes', model%mesh%n_nodes == 16 .and. model%mesh%n_elements == 2 .and. model%mesh%n_points &
      == 16)
    call suite%that('labels', all(model%mesh%node_label([1, 9, 16]) == [1, 11, 18]))
    call suite%that('connectivity', all(model%mesh%nodes(model%mesh%first(2):model%mesh%first(3) - 1) == [9, 10, 11, &
      12, 13, 14, 15, 16]))
    call suite%near('a coordinate', model%mesh%coordinates(3, 16), 2.0_DP, 0.0_DP)
    call suite%that('names as written', model%mesh%node_sets(2)%name == 'bot' .and. model%materials(1)%name == 'steel')
    call suite%that('material of the elements', all(model%mesh%material == 1))
    call suite%that('pair', model%pairs(1)%slave == 2 .and. model%pairs(1)%master == 1 .and. &
      model%pairs(1)%interaction == 1 .and. model%pairs(1)%name == 'high / LOW')
    call suite%near('friction', model%interactions(1)%friction, 0.3_DP, 0.0_DP)
    call suite%that('16 prescribed', size(model%steps(1)%prescribed) == 16)
  end subroutine test_whole


  !> The order of the cards in the model does not matter.
  subroutine test_order(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: a, b
    call read_good(suite, 'usual order', NODES // CUBES // SETS // STEEL // SURFACES // '*BOUNDARY;BOT,1;' // &
      STEP_PART, a)
    call read_good(suite, 'turned order', '*BOUNDARY;BOT,1;' // SURFACES // STEEL // SETS // CUBES // NODES // &
      STEP_PART, b)
    call suite%that('same surfaces', all(a%surfaces(2)%nodes == b%surfaces(2)%nodes) .and. size(b%surfaces(2)%nodes) &
      == 4)
    call suite%that('same supports', all(a%steps(1)%prescribed%node == b%steps(1)%prescribed%node))
    call suite%that('same materials', all(a%mesh%material == b%mesh%material))
  end subroutine test_order


  !> From a file; a missing file.
  subroutine test_files(suite)
    type(suite_type), intent(inout) :: suite
    type(job_options_type) :: options
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    character(1000) :: folder
    integer :: unit, status
    call get_environment_variable('TMPDIR', folder, status=status)
    if (status /= 0 .or. folder == '') folder = '/tmp'
    options%deck = trim(folder) // '/amontons_test_deck'
    open (newunit=unit, file=options%deck // '.inp', access='stream', form='unformatted', status='replace')
    write (unit) deck_lines(MODEL_PART // STEP_PART)
    close (unit)
    call read_deck(options, model, diagnostics, error)
    call suite%that('deck from a file', .not. allocated(error) .and. model%mesh%n_nodes == 16)
    open (newunit=unit, file=options%deck // '.inp')
    close (unit, status='delete')
    call read_deck(options, model, diagnostics, error)
    call suite%that('no deck', allocated(error))
    if (allocated(error)) call suite%that('code of no deck', error%code == EXIT_IO)
  end subroutine test_files


  !> The dialect: from the deck, from the caller, and its effects.
  subroutine test_dialect(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'abaqus by default', MODEL_PART // STEP_PART, model)
    call suite%that('C3D8 and Hencky', all(model%mesh%kind == KIND_C3D8) .and. model%materials(1)%law == LAW_HENCKY)
    call suite%near('our tolerance', model%steps(1)%controls%r_n, 1.0e-6_DP, 0.0_DP)
    call read_good(suite, 'calculix by comment', '*HEADING;** Dialect : CalculiX;' // MODEL_PART // STEP_PART, model)
    call suite%that('calculix', model%dialect == DIALECT_CALCULIX)
    call suite%that('full C3D8 and Saint Venant', all(model%mesh%kind == KIND_C3D8_FULL) .and. model%materials(1)%law &
      == LAW_SAINT_VENANT)
    call suite%near('its tolerance', model%steps(1)%controls%r_n, 0.0005_DP, 0.0_DP)
    call read_good(suite, 'caller wins', '** dialect: calculix;' // MODEL_PART // STEP_PART, model, &
      dialect=DIALECT_ABAQUS)
    call suite%that('abaqus', model%dialect == DIALECT_ABAQUS)
    call read_good(suite, 'a late comment is a comment', MODEL_PART // '** dialect: calculix;' // STEP_PART, model)
    call suite%that('still abaqus', model%dialect == DIALECT_ABAQUS)
    call expect_error(suite, '** dialect: ansys;' // MODEL_PART // STEP_PART, 'abaqus or calculix', '** dialect: ansys')
    call expect_error(suite, MODEL_PART // '*NSET,NSET=A,FOO=1;1;' // STEP_PART, 'no parameter FOO')
    call read_good(suite, 'calculix passes over unknown parameters', MODEL_PART // '*NSET,NSET=A,FOO=1;1,99;' // &
      STEP_PART, model, n_notes=2, dialect=DIALECT_CALCULIX)
  end subroutine test_dialect


  !> NODE.
  subroutine test_nodes(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'node forms', MODEL_PART // '*NODE;100;101,1+2, -1.d-1 ,1e0,;' // STEP_PART, model)
    call suite%near('missing coordinates are zero', norm2(model%mesh%coordinates(:, 17)), 0.0_DP, 0.0_DP)
    call suite%near('1+2', model%mesh%coordinates(1, 18), 100.0_DP, 0.0_DP)
    call expect_error(suite, MODEL_PART // '*NODE;1,5,5,5;' // STEP_PART, 'node 1 is defined twice, here at another', '1,5,5,5')
    call expect_error(suite, MODEL_PART // '*NODE;A,5,5,5;' // STEP_PART, 'number of the node', 'A,5,5,5')
    call expect_error(suite, MODEL_PART // '*NODE;0,5,5,5;' // STEP_PART, 'positive integer')
    call expect_error(suite, MODEL_PART // '*NODE;99,x,5,5;' // STEP_PART, 'Field 2 (x) is ''x''')
    call expect_error(suite, MODEL_PART // '*NODE;99,0,0,NaN;' // STEP_PART, 'finite')
    call expect_error(suite, MODEL_PART // '*NODE;99,0,0,0,1,0,0,1;' // STEP_PART, '8 values')
    call expect_error(suite, MODEL_PART // '*NODE, SYSTEM=Q;99,0,0,0;' // STEP_PART, 'value Q of SYSTEM is not known')
  end subroutine test_nodes


  !> ELEMENT.
  subroutine test_elements(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: T = '*ELEMENT, TYPE=C3D8, ELSET=E;'
    integer :: i
    character(:), allocatable :: twenty
    call read_good(suite, 'other kinds', MODEL_PART // '*ELEMENT, TYPE=C3D4, ELSET=E;3,1,2,3,5;*element, ' // &
      'type=c3d6, elset=e;4,1,2,3,;5,6,7;' // STEP_PART, model)
    call suite%that('kinds', all(model%mesh%kind == [KIND_C3D8, KIND_C3D8, KIND_C3D4, KIND_C3D6]))
    twenty = '*NODE;'
    do i = 101, 120
      twenty = twenty // to_text(i) // ',0,0,' // to_text(i) // ';'
    end do
    call read_good(suite, 'twenty nodes on two lines, on one, and without a comma', MODEL_PART // twenty // &
      '*ELEMENT,TYPE=C3D20,ELSET=E;3,101,102,103,104,105,106,107,108,109,110,111,112,113,114,115,;116,117,118,119,' // &
      '120;4,101,102,103,104,105,106,107,108,109,110,111,112,113,114,115,116,117,118,119,120;5,101,102,103,104,' // &
      '105,106,107,108,109,110;111,112,113,114,115,116,117,118,119,120;' // STEP_PART, model)
    call suite%that('three of twenty', count(model%mesh%kind == KIND_C3D20) == 3)
    call read_good(suite, 'a name of meshio', MODEL_PART // twenty // '*ELEMENT,TYPE=C3D10MH,ELSET=E;3,101,102,103,' // &
      '104,105,106,107,108,109,110;' // STEP_PART, model, n_notes=1)
    call suite%that('taken as C3D10', model%mesh%kind(3) == KIND_C3D10)
    call expect_error(suite, MODEL_PART // T // '1,1,2,3,4,5,6,7,8;' // STEP_PART, 'element 1 is defined twice')
    call expect_error(suite, MODEL_PART // T // '3,1,2,3,4,5,6,7,99;' // STEP_PART, 'no node 99')
    call expect_error(suite, MODEL_PART // T // '3,1,2,3,4,5,6,7,7;' // STEP_PART, 'degenerate: node 7')
    call expect_error(suite, MODEL_PART // T // '3,1,2,3,4,5,6,7;' // STEP_PART, 'has 7 nodes')
    call expect_error(suite, MODEL_PART // T // '3,1,2,3,4,5,6,7,8,11;' // STEP_PART, 'has 9 nodes')
    call expect_error(suite, MODEL_PART // T // '3,1,2,x,4,5,6,7,8;' // STEP_PART, 'number of a node')
    call expect_error(suite, MODEL_PART // '*ELEMENT, TYPE=C3D8, ELSET=F;3,1,2,3,4,5,6,7,8;' // STEP_PART, &
      'no section', '*ELEMENT, TYPE=C3D8, ELSET=F')
    call expect_error(suite, MODEL_PART // '*ELEMENT, TYPE=C3D8P, ELSET=E;3,1,2,3,4,5,6,7,8;' // STEP_PART, &
      'C3D8P is not supported. Use C3D8')
    call expect_error(suite, MODEL_PART // '*ELEMENT, TYPE=SPRINGA;3,1,2;' // STEP_PART, 'no *SPRING names')
    call expect_error(suite, NODES // '*ELEMENT, ELSET=E;' // CUBES // STEEL // SETS // STEP_PART, 'TYPE=text')
  end subroutine test_elements


  !> Plane elements, trusses, springs and masses: names, sections, constants.
  subroutine test_sections(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: T = '*ELEMENT, TYPE=T3D3, ELSET=T;11,1,2,3;', A = '*ELEMENT, TYPE=SPRINGA, ELSET=A;12,1,2;', &
      B = '*ELEMENT, TYPE=SPRING2, ELSET=B;13,1,2;', M = '*ELEMENT, TYPE=MASS, ELSET=M;14,4;'
    call read_good(suite, 'trusses, springs, masses', MODEL_PART // T // A // B // M // &
      '*SOLID SECTION,ELSET=T,MATERIAL=steel;0.25,;*SPRING,ELSET=A;;7.5,;*SPRING,ELSET=B;3,1;2.;*MASS,ELSET=M;9.;' // &
      STEP_PART, model)
    call suite%that('kinds', all(model%mesh%kind(3:) == [KIND_T3D3, KIND_SPRINGA, KIND_SPRING2, KIND_MASS]))
    call suite%near('constants', maxval(abs(model%mesh%section_value - [1.0_DP, 1.0_DP, 0.25_DP, 7.5_DP, 2.0_DP, 9.0_DP])), &
      0.0_DP, &
      0.0_DP)
    call suite%that('directions', all(model%mesh%directions(:, 5) == [3, 1]))
    call suite%that('the middle of a truss comes last', all(model%mesh%nodes(model%mesh%first(3):model%mesh%first(4) - 1) &
      == [1, 3, 2]))
    call read_good(suite, 'plane', NODES // '*ELEMENT,TYPE=CPE4H,ELSET=E;1,1,2,3,4;*ELEMENT,TYPE=T3D2,ELSET=L;2,1,2;' // &
      STEEL // STEP_START // '*CLOAD;1,1,1.;' // STEP_END, model, n_notes=2)
    call suite%that('mean dilatation; the line is left out', all(model%mesh%kind == [KIND_CPE4]))
    call suite%that('the third displacement is idle', all(model%mesh%is_unstiffened(3, :4)) .and. &
      .not. any(model%mesh%is_unstiffened(:2, :4)))
    call read_good(suite, 'a C3D8I with nodes for its modes', MODEL_PART // '*ELEMENT,TYPE=C3D8I,ELSET=E;3,1,2,3,4,5,6,7,8,11,' &
      // '12,;4,1,2,3,4,5,6,7,8;' // STEP_PART, model)
    call suite%that('eight stay', all(model%mesh%kind(3:) == KIND_C3D8I) .and. size(model%mesh%nodes) == 32)
    call expect_error(suite, MODEL_PART // T // '*SOLID SECTION,ELSET=T,MATERIAL=steel;-1.;' // STEP_PART, 'positive')
    call expect_error(suite, MODEL_PART // A // '*SPRING,ELSET=A;' // STEP_PART, 'data are missing')
    call expect_error(suite, MODEL_PART // A // '*SPRING,ELSET=A;x;' // STEP_PART, 'constant')
    call expect_error(suite, MODEL_PART // A // '*SPRING,ELSET=A;1.,0.;2.,1.;' // STEP_PART, 'must ascend')
    call expect_error(suite, MODEL_PART // A // '*SPRING,ELSET=A,NONLINEAR;' // STEP_PART, 'with NONLINEAR lines')
    call expect_error(suite, MODEL_PART // B // '*SPRING,ELSET=B;1,4;1.;' // STEP_PART, 'direction 1, 2 or 3')
    call expect_error(suite, MODEL_PART // B // '*SPRING,ELSET=B;1,x;1.;' // STEP_PART, 'direction')
    call expect_error(suite, MODEL_PART // '*SPRING,ELSET=nowhere;1.;' // STEP_PART, 'no element set')
    call expect_error(suite, MODEL_PART // '*MASS,ELSET=E;1.;' // STEP_PART, 'is no mass')
    call expect_error(suite, MODEL_PART // M // STEP_PART, 'no *MASS names')
    call expect_error(suite, MODEL_PART // '*ELEMENT,TYPE=S4R,ELSET=S;15,1,2,3,4;*SOLID SECTION,ELSET=S,MATERIAL=steel;' // &
      STEP_PART, 'is a S4R; solids, plane elements')
  end subroutine test_sections


  !> Lines and faces that mesh generators leave beside the solids.
  subroutine test_leftovers(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: LINES = '******* E L E M E N T S *************;*ELEMENT, type=T3D2, ELSET=Line1;51,' // &
      ' 1, 2;52, 2, 3;*ELEMENT, type=CPS4, ELSET=Surface1;53, 1, 2, 3, 4;'
    call read_good(suite, 'gmsh leftovers', MODEL_PART // LINES // '*ELSET,ELSET=PhysicalSurface1;53, ;*ELSET,' // &
      'ELSET=Mixed;53, 1;*NSET,NSET=OfFace,ELSET=Surface1;' // STEP_PART, model, n_notes=1)
    call suite%that('only solids stay', model%mesh%n_elements == 2)
    call suite%that('sets hold solids only', size(model%mesh%element_sets(4)%members) == 0 .and. &
      all(model%mesh%element_sets(5)%members == [1]))
    call suite%that('nodes of the face', all(model%mesh%node_sets(4)%members == [1, 2, 3, 4]))
    call read_good(suite, 'a face with a section stays', MODEL_PART // LINES // &
      '*SOLID SECTION, ELSET=Surface1, MATERIAL=steel;0.5;' // STEP_PART, model, n_notes=1)
    call suite%that('with its thickness', model%mesh%kind(3) == KIND_CPS4 .and. abs(model%mesh%section_value(3) - 0.5_DP) &
      <= 0)
    call expect_error(suite, MODEL_PART // '*NODE;99,9,9,9;*ELEMENT,TYPE=T3D2;60,1,99;' // STEP_PART, &
      'no section')
    call expect_error(suite, MODEL_PART // LINES // '*SURFACE,NAME=S;Surface1,S1;' // STEP_PART, 'no solids')
    call expect_error(suite, MODEL_PART // LINES // STEP_START // '*DLOAD;53,P1,1.;' // STEP_END, 'no solid;')
  end subroutine test_leftovers


  !> NSET and ELSET.
  subroutine test_sets(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'sets', MODEL_PART // '*NSET, NSET=Outer;Inner, 8, 7,;*NSET,NSET=Inner,GENERATE;2,6,2;' // &
      '12,11000000,3;*NSET,NSET=INNER,UNSORTED;3, Inner, 3;*NSET,NSET="my set";1;*ELSET,ELSET=one,GENERATE;1;' // &
      '*NSET,NSET=OfOne,ELSET=One;*NSET,NSET=again;MySet;' // STEP_PART, model)
    associate (sets => model%mesh%node_sets)
      call suite%that('generated, extended', all(label(model, 5) == [2, 4, 6, 12, 15, 18, 3]))
      call suite%that('forward name', all(label(model, 4) == [2, 3, 4, 6, 7, 8, 12, 15, 18]))
      call suite%that('nodes of elements', all(label(model, 7) == [1, 2, 3, 4, 5, 6, 7, 8]))
      call suite%that('names without blanks', sets(6)%name == 'my set' .and. all(label(model, 8) == [1]))
      call suite%that('implicit set', size(sets(1)%members) == 16)
    end associate
    call expect_error(suite, MODEL_PART // '*NSET,NSET=A;1,B;' // STEP_PART, 'no node set ''B''', '1,B')
    call expect_error(suite, MODEL_PART // '*NSET,NSET=A;99;' // STEP_PART, 'no node 99')
    call expect_error(suite, MODEL_PART // '*ELSET,ELSET=A;99;' // STEP_PART, 'no element 99')
    call expect_error(suite, MODEL_PART // '*NSET,NSET=A;B;*NSET,NSET=B;A;' // STEP_PART, 'contain each other')
    call expect_error(suite, MODEL_PART // '*NSET,NSET=A,GENERATE;5,1;' // STEP_PART, 'first <= last')
    call expect_error(suite, MODEL_PART // '*NSET,NSET=A,GENERATE;x,1;' // STEP_PART, 'must be an integer')
    call expect_error(suite, MODEL_PART // '*NSET,NSET=A,ELSET=Q;' // STEP_PART, 'no element set ''Q''')
    call expect_error(suite, MODEL_PART // '*NSET,NSET=' // repeat('x', 81) // ';1;' // STEP_PART, '80 characters')
  end subroutine test_sets


  !> The labels of a node set.
  function label(model, s) result(labels)
    type(model_type), intent(in) :: model
    integer, intent(in) :: s
    integer, allocatable :: labels(:)
    labels = model%mesh%node_label(model%mesh%node_sets(s)%members)
  end function label


  !> MATERIAL, ELASTIC, DENSITY, SOLID SECTION.
  subroutine test_materials(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: M = '*MATERIAL, NAME=M;'
    call read_good(suite, 'materials', MODEL_PART // M // '*DENSITY;2.;*DAMPING, ALPHA=1.;*ELASTIC, ' // &
      'TYPE=ISOTROPIC;100., 0.4;*ELSET,ELSET=two;2;*SOLID SECTION, ELSET=two, MATERIAL=m;1.,;' // STEP_PART, model, &
      n_notes=2)
    call suite%near('E', model%materials(2)%youngs_modulus, 100.0_DP, 0.0_DP)
    call suite%near('nu', model%materials(2)%poissons_ratio, 0.4_DP, 0.0_DP)
    call suite%near('rho', model%materials(2)%density, 2.0_DP, 0.0_DP)
    call suite%that('the later section counts', all(model%mesh%material == [1, 2]))
    call expect_error(suite, MODEL_PART // M // STEP_PART, 'no *ELASTIC', '*MATERIAL, NAME=M')
    call expect_error(suite, MODEL_PART // M // '*MULLINS EFFECT;1.,0.;' // STEP_PART, '*MULLINS EFFECT is not')
    call expect_error(suite, MODEL_PART // M // '*ELASTIC;' // STEP_PART, 'needs a data line')
    call expect_error(suite, MODEL_PART // M // '*ELASTIC;0.,.3;' // STEP_PART, 'must be positive')
    call expect_error(suite, MODEL_PART // M // '*ELASTIC;1.,.5;' // STEP_PART, 'less than 0.5')
    call expect_error(suite, MODEL_PART // M // '*ELASTIC;1.,-1.;' // STEP_PART, 'greater than -1')
    call expect_error(suite, MODEL_PART // M // '*ELASTIC;1.,.3,20.;2.,.3,20.;' // STEP_PART, 'must ascend', &
      '2.,.3,20.')
    call expect_error(suite, MODEL_PART // M // '*ELASTIC;1.,.3;*DENSITY;-1.;' // STEP_PART, 'density must be positive')
    call expect_error(suite, MODEL_PART // '*MATERIAL, NAME=Steel;' // STEP_PART, 'defined twice')
    call expect_error(suite, MODEL_PART // '*ELASTIC;1.,.3;' // STEP_PART, 'block of a *MATERIAL')
    call expect_error(suite, MODEL_PART // '*SOLID SECTION, ELSET=X, MATERIAL=steel;' // STEP_PART, &
      'no element set ''X''')
    call expect_error(suite, MODEL_PART // '*SOLID SECTION, ELSET=E, MATERIAL=wood;' // STEP_PART, &
      'no material ''wood''')
  end subroutine test_materials


  !> SURFACE.
  subroutine test_surfaces(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'surfaces', MODEL_PART // '*SURFACE, NAME=faces;E, s2;1, S2;1,S6;*SURFACE, NAME=points, ' // &
      'TYPE=NODE;TOP;3, 1.;15;' // STEP_PART, model)
    call suite%that('faces once each', all(model%surfaces(1)%element == [1, 2, 1]) .and. all(model%surfaces(1)%face == &
      [2, 2, 6]))
    call suite%that('their nodes', all(model%surfaces(1)%nodes == [1, 4, 5, 6, 7, 8, 13, 14, 15, 16]))
    call suite%that('nodes ascending', model%surfaces(2)%is_node_based .and. all(model%surfaces(2)%nodes == [3, 13, &
      14, 15, 16]) .and. size(model%surfaces(2)%element) == 0)
    call expect_error(suite, MODEL_PART // '*SURFACE, NAME=A;1, S7;' // STEP_PART, 'S1 to S6')
    call read_good(suite, 'surface of free faces', MODEL_PART // '*SURFACE, NAME=A;1;' // STEP_PART, model)
    call expect_error(suite, MODEL_PART // '*ELEMENT,TYPE=C3D4,ELSET=E;3,1,2,3,5;*SURFACE, NAME=A;3, S5;' // &
      STEP_PART, 'no face S5')
    call expect_error(suite, MODEL_PART // '*SURFACE, NAME=A;X, S1;' // STEP_PART, 'element set ''X''')
    call expect_error(suite, MODEL_PART // '*SURFACE, NAME=A, TYPE=NODE;X;' // STEP_PART, 'node set ''X''')
    call expect_error(suite, MODEL_PART // '*SURFACE, NAME=A;*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, ' // &
      'INTERACTION=I;A;' // STEP_PART, 'no faces')
    call expect_error(suite, MODEL_PART // '*SURFACE, NAME=A, TYPE=NODE;' // STEP_PART, 'no nodes')
    call expect_error(suite, MODEL_PART // SURFACES // '*SURFACE, NAME=LOW;1,S1;' // STEP_PART, 'defined twice')
    call test_duplicates(suite)
    call expect_error(suite, MODEL_PART // '*SURFACE, NAME=A, TYPE=CUTTING SURFACE;1,S1;' // STEP_PART, 'not supported')
  end subroutine test_surfaces


  !> SURFACE INTERACTION, SURFACE BEHAVIOR, FRICTION.
  subroutine test_interactions(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: I = '*SURFACE INTERACTION, NAME=I;'
    call read_good(suite, 'without friction', MODEL_PART // I // '1.,;*FRICTION, SLIP TOLERANCE=.005;0., ,;' // &
      STEP_PART, model, n_notes=1)
    call suite%near('mu 0', model%interactions(1)%friction, 0.0_DP, 0.0_DP)
    call read_good(suite, 'stick slope of calculix', MODEL_PART // I // '*SURFACE BEHAVIOR;*FRICTION;0.2,1.e5;' // &
      STEP_PART, model, n_notes=1, dialect=DIALECT_CALCULIX)
    call suite%near('mu 0.2', model%interactions(1)%friction, 0.2_DP, 0.0_DP)
    call suite%near('lambda', model%interactions(1)%stick_slope, 1.0e5_DP, 0.0_DP)
    call suite%near('hard of calculix', model%interactions(1)%stiffness, 50 * model%materials(1)%youngs_modulus, 1.0e-6_DP)
    call read_good(suite, 'tabular', MODEL_PART // I // '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR;0.,0.;5.,.1;' // &
      STEP_PART, model)
    call suite%near('table', model%interactions(1)%table_pressure(2), 5.0_DP, 0.0_DP)
    call read_good(suite, 'no slope, table', MODEL_PART // I // '*FRICTION;0.2;*SURFACE BEHAVIOR, ' // &
      'PRESSURE-OVERCLOSURE=TABULAR;0.,0.;5.,.1;25.,.2;' // STEP_PART, model, n_notes=1)
    call suite%near('steepest of the table, a hundredth', model%interactions(1)%stick_slope, 2.0_DP, 1.0e-9_DP)
    call read_good(suite, 'no slope, exponential', MODEL_PART // I // '*FRICTION;0.2;*SURFACE BEHAVIOR, ' // &
      'PRESSURE-OVERCLOSURE=EXPONENTIAL;.1,3.;' // STEP_PART, model, n_notes=1)
    call suite%near('slope at gap zero, a hundredth', model%interactions(1)%stick_slope, 0.3_DP * log(100.0_DP), 1.0e-9_DP)
    call read_good(suite, 'no slope, linear', MODEL_PART // I // '*FRICTION;0.2;*SURFACE BEHAVIOR, ' // &
      'PRESSURE-OVERCLOSURE=LINEAR;7.,;' // STEP_PART, model, n_notes=1)
    call suite%near('slope of the pressure, a hundredth', model%interactions(1)%stick_slope, 0.07_DP, 1.0e-15_DP)
    call read_good(suite, 'no slope, calculix', MODEL_PART // I // '*FRICTION;0.2;*SURFACE BEHAVIOR, ' // &
      'PRESSURE-OVERCLOSURE=LINEAR;7.,;' // STEP_PART, model, n_notes=1, dialect=DIALECT_CALCULIX)
    call suite%near('half of E', model%interactions(1)%stick_slope, 0.5_DP * model%materials(1)%youngs_modulus, 0.0_DP)
    call read_good(suite, 'shear limit', MODEL_PART // I // '*FRICTION, TAUMAX=7.;.2;' // STEP_PART, model)
    call suite%near('TAUMAX', model%interactions(1)%shear_limit, 7.0_DP, 0.0_DP)
    call expect_error(suite, MODEL_PART // I // '*FRICTION;0.2,1.e5;' // STEP_PART, 'slip rate', '0.2,1.e5')
    call expect_error(suite, MODEL_PART // I // '*FRICTION;-.2;' // STEP_PART, 'must not be negative')
    call expect_error(suite, MODEL_PART // I // '*FRICTION;.2;.1;' // STEP_PART, 'is a constant')
    call expect_error(suite, MODEL_PART // I // '*FRICTION;' // STEP_PART, 'needs a data line')
    call expect_error(suite, MODEL_PART // I // '*FRICTION, ROUGH;.2;' // STEP_PART, 'takes no data here')
    call expect_error(suite, MODEL_PART // I // '*FRICTION, ELASTIC SLIP=0.;.2;' // STEP_PART, 'ELASTIC SLIP must be a positive')
    call expect_error(suite, MODEL_PART // I // '*FRICTION, SLIP TOLERANCE=wide;.2;' // STEP_PART, 'SLIP TOLERANCE must')
    call expect_error(suite, MODEL_PART // I // '*FRICTION, LAGRANGE, SLIP TOLERANCE=.01;.2;' // STEP_PART, 'exclude each other')
    call expect_error(suite, MODEL_PART // I // '*FRICTION, ROUGH, ELASTIC SLIP=.01;' // STEP_PART, 'never slip')
    call expect_error(suite, MODEL_PART // '*FRICTION;.2;' // STEP_PART, 'block of a *SURFACE INTERACTION')
    call expect_error(suite, MODEL_PART // I // '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=USER;' // STEP_PART, 'Use HARD')
    call expect_error(suite, MODEL_PART // I // '*FRICTION, TAUMAX=-1.;.2;' // STEP_PART, 'TAUMAX must be positive')
    call expect_error(suite, MODEL_PART // I // '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL;' // STEP_PART, &
      'needs a data line')
    call expect_error(suite, MODEL_PART // I // '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR;1.,0.;2.,0.;' // &
      STEP_PART, 'must ascend')
    call expect_error(suite, MODEL_PART // I // '*SURFACE BEHAVIOR;1.e7;' // STEP_PART, 'takes no data', '1.e7')
    call expect_error(suite, MODEL_PART // I // I // STEP_PART, 'defined twice')
  end subroutine test_interactions


  !> CalculiX allows a surface of faces and one of nodes with one name: the slave is that of nodes, the master that of faces.
  subroutine test_duplicates(suite)
    type(suite_type), intent(inout) :: suite
    character(*), parameter :: DUPLICATES(2) = [character(80) :: '*SURFACE,NAME=a,TYPE=NODE;TOP;*SURFACE,NAME=a;1,S2;', &
      '*SURFACE,NAME=A;1,S2;*SURFACE,NAME=a,TYPE=NODE;TOP;']
    character(*), parameter :: REST = '*SURFACE, NAME=high;2,S1;*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I, ' // &
      'TYPE=NODE TO SURFACE;'
    type(model_type) :: model
    integer :: i
    do i = 1, 2
      call read_good(suite, 'slave', MODEL_PART // trim(DUPLICATES(i)) // REST // 'A, high;' // STEP_PART, model, &
        dialect=DIALECT_CALCULIX)
      call suite%that('the slave is of nodes', model%surfaces(model%pairs(1)%slave)%is_node_based)
      call read_good(suite, 'master', MODEL_PART // trim(DUPLICATES(i)) // REST // 'high, a;' // STEP_PART, model, &
        dialect=DIALECT_CALCULIX)
      call suite%that('the master is of faces', .not. model%surfaces(model%pairs(1)%master)%is_node_based)
      call expect_error(suite, MODEL_PART // trim(DUPLICATES(i)) // STEP_PART, 'defined twice', dialect=DIALECT_ABAQUS)
    end do
    call expect_error(suite, MODEL_PART // trim(DUPLICATES(1)) // '*SURFACE,NAME=A;1,S1;' // STEP_PART, 'defined twice', &
      dialect=DIALECT_CALCULIX)
  end subroutine test_duplicates


  !> CONTACT PAIR.
  subroutine test_pairs(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: BASE = MODEL_PART // SURFACES // '*SURFACE INTERACTION, NAME=I;*SURFACE, ' // &
      'NAME=points, TYPE=NODE;11,12,;'
    character(*), parameter :: PAIR = '*CONTACT PAIR, INTERACTION=I'
    call read_good(suite, 'pairs', BASE // PAIR // ', ADJUST=0.01, SMALL SLIDING;high, low;' // PAIR // &
      ';points, low;' // STEP_PART, model)
    call suite%that('two pairs', size(model%pairs) == 2)
    call suite%that('small sliding', model%pairs(1)%is_small_sliding .and. .not. model%pairs(2)%is_small_sliding)
    call suite%that('adjust', model%pairs(1)%has_adjust .and. .not. model%pairs(2)%has_adjust)
    call suite%near('its distance', model%pairs(1)%adjust, 0.01_DP, 0.0_DP)
    call expect_error(suite, BASE // '*CONTACT PAIR;high,low;' // STEP_PART, 'INTERACTION=name')
    call expect_error(suite, BASE // '*CONTACT PAIR, INTERACTION=J;high,low;' // STEP_PART, 'interaction ''J''')
    call expect_error(suite, BASE // PAIR // ',TYPE=MASSLESS;high,low;' // STEP_PART, 'Use NODE TO SURFACE')
    call expect_error(suite, BASE // PAIR // ',TYPE=SURFACE TO SURFACE;points,low;' // STEP_PART, 'needs element faces', &
      dialect=DIALECT_CALCULIX)
    call read_good(suite, 'a slave of nodes', BASE // PAIR // ',TYPE=SURFACE TO SURFACE;points,low;' // STEP_PART, model, n_notes=1)
    call suite%that('at the nodes', .not. (model%pairs(1)%is_mortar .or. model%pairs(1)%has_point_contact))
    call expect_error(suite, BASE // PAIR // ';high,nix;' // STEP_PART, 'no surface ''nix''')
    call expect_error(suite, BASE // PAIR // ';nix,low;' // STEP_PART, 'no surface ''nix''')
    call expect_error(suite, BASE // PAIR // NL // STEP_PART, 'needs a data line')
    call expect_error(suite, BASE // PAIR // ';low,points;' // STEP_PART, 'a master needs element faces')
    call expect_error(suite, BASE // PAIR // ',ADJUST=-1.;high,low;' // STEP_PART, 'must be a distance')
  end subroutine test_pairs


  !> AMPLITUDE.
  subroutine test_amplitudes(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: A = '*AMPLITUDE, NAME=A'
    call read_good(suite, 'amplitudes', MODEL_PART // A // ';0.,0.,.5,1.,;1.,0.;*AMPLITUDE, NAME=B, TIME=TOTAL ' // &
      'TIME;2.,3.;' // STEP_PART, model)
    call suite%that('three points', size(model%amplitudes(1)%time) == 3 .and. .not. model%amplitudes(1)%is_total_time)
    call suite%near('a time', model%amplitudes(1)%time(2), 0.5_DP, 0.0_DP)
    call suite%near('a factor', model%amplitudes(1)%factor(2), 1.0_DP, 0.0_DP)
    call suite%that('total time', model%amplitudes(2)%is_total_time)
    call expect_error(suite, MODEL_PART // A // ';0.,0.,1.;' // STEP_PART, 'odd number')
    call expect_error(suite, MODEL_PART // A // ';0.,0.,1.,1.,1.,2.;' // STEP_PART, 'must ascend')
    call expect_error(suite, MODEL_PART // A // NL // STEP_PART, 'at least one pair')
    call expect_error(suite, MODEL_PART // A // ';0.,x;' // STEP_PART, 'factor')
    call expect_error(suite, MODEL_PART // A // ',VALUE=NONSENSE;0.,1.;' // STEP_PART, 'NONSENSE')
    call expect_error(suite, MODEL_PART // A // ';0.,1.;' // A // ';0.,1.;' // STEP_PART, 'defined twice')
    call expect_error(suite, MODEL_PART // STEP_START // '*CLOAD,AMPLITUDE=X;TOP,3,1.;' // STEP_END, &
      'no amplitude ''X''')
  end subroutine test_amplitudes


  !> EQUATION.
  subroutine test_equations(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: E = '*EQUATION;'
    call read_good(suite, 'equations', MODEL_PART // E // '3;5,1,1.,6,1,-.5,;7,1,-.5;2;TOP,2,1., BOT,2,-1.;3;1,3,' // &
      '1.,2,3,-1.,1,3,1.;' // STEP_PART, model)
    call suite%that('one, four of the sets, one', size(model%equations) == 6)
    call suite%that('terms', all(model%equations(1)%node == [5, 6, 7]) .and. all(model%equations(1)%dof == 1))
    call suite%near('coefficient', model%equations(1)%coefficient(3), -0.5_DP, 0.0_DP)
    call suite%that('node by node', all(model%equations(3)%node == [14, 2]))
    call suite%that('equal terms are added', size(model%equations(6)%node) == 2)
    call suite%near('their sum', model%equations(6)%coefficient(1), 2.0_DP, 0.0_DP)
    call expect_error(suite, MODEL_PART // E // '0;' // STEP_PART, 'at least one term')
    call expect_error(suite, MODEL_PART // E // '2;1,1,1.;' // STEP_PART, 'only 1 term')
    call expect_error(suite, MODEL_PART // E // '1;1,1,1.,2,1,1.;' // STEP_PART, 'at most 1 term')
    call expect_error(suite, MODEL_PART // E // '2;1,1,1.,2,1;' // STEP_PART, 'terms of three values')
    call expect_error(suite, MODEL_PART // E // '2;1,4,1.,2,1,1.;' // STEP_PART, 'The node 1 has no rotation')
    call expect_error(suite, MODEL_PART // E // '2;99,1,1.,2,1,1.;' // STEP_PART, 'node set ''99''')
    call expect_error(suite, MODEL_PART // E // '2;1,1,0.,2,1,1.;' // STEP_PART, 'first term is zero')
    call expect_error(suite, MODEL_PART // E // '2;ALL,1,1.,TOP,1,1.;' // STEP_PART, 'same number of nodes')
  end subroutine test_equations


  !> BOUNDARY: its forms.
  subroutine test_boundary(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: B = '*BOUNDARY;'
    call read_good(suite, 'boundary', MODEL_PART // B // '1,PINNED;2,xsymm;3,YASYMM;4,2;5,1,2,.5;6,3,,.25;' // &
      STEP_PART, model)
    associate (p => model%steps(1)%prescribed)
      call suite%that('their degrees of freedom', all(p%node == [1, 1, 1, 2, 3, 3, 4, 5, 5, 6]) .and. all(p%dof == [1, &
        2, 3, 1, 1, 3, 2, 1, 2, 3]))
      call suite%near('a value', p(9)%end, 0.5_DP, 0.0_DP)
      call suite%near('another', p(10)%end, 0.25_DP, 0.0_DP)
      call suite%that('line', p(1)%line == 32)
    end associate
    call read_good(suite, 'rotations', MODEL_PART // B // '1,1,6;' // STEP_PART, model, n_notes=1)
    call suite%that('three of six', size(model%steps(1)%prescribed) == 3)
    call read_good(suite, 'the later value counts', MODEL_PART // STEP_START // B // '1,1,1,.5;BOT,1,1,.25;' // &
      STEP_END, model, n_notes=1)
    call suite%near('the later one', model%steps(1)%prescribed(1)%end, 0.25_DP, 0.0_DP)
    call read_good(suite, 'words at nodes of solids', MODEL_PART // B // '1,ENCASTRE;2,ZSYMM;3,XASYMM;' // STEP_PART, model)
    call suite%that('no rotations', all(model%steps(1)%prescribed%dof == [1, 2, 3, 3, 2, 3]))
    call expect_error(suite, MODEL_PART // B // 'nix,1;' // STEP_PART, 'node set ''nix''')
    call expect_error(suite, MODEL_PART // B // '1,WELDED;' // STEP_PART, 'ENCASTRE')
    call expect_error(suite, MODEL_PART // B // '1,3,2;' // STEP_PART, 'not above the last')
    call expect_error(suite, MODEL_PART // B // '1,11,11,20.;' // STEP_PART, '*TEMPERATURE')
    call expect_error(suite, MODEL_PART // B // '1,4,4,.1;' // STEP_PART, 'no rotations')
    call expect_error(suite, MODEL_PART // B // '1,1,1,inf;' // STEP_PART, 'finite')
    call expect_error(suite, MODEL_PART // '*BOUNDARY,TYPE=ACCELERATION;1,1;' // STEP_PART, 'Prescribe')
    call expect_error(suite, MODEL_PART // STEP_START // '*BOUNDARY,TYPE=VELOCITY,FIXED;1,1;' // STEP_END, 'FIXED or USER')
    call expect_error(suite, MODEL_PART // STEP_PART // B // '1,1;', 'before the first step or in a step')
  end subroutine test_boundary


  !> BOUNDARY over steps: kept, changed, released, fixed.
  subroutine test_boundary_steps(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'boundary over steps', MODEL_PART // '*AMPLITUDE,NAME=A;0.,0.,1.,.5;*AMPLITUDE,NAME=T,' // &
      'TIME=TOTAL TIME;0.,0.,10.,1.;*BOUNDARY;1,1,3;' // STEP_START // '*BOUNDARY;5,1,1,.4;6,1,1,.6;*BOUNDARY,' // &
      'AMPLITUDE=A;7,1,1,2.;*BOUNDARY,AMPLITUDE=T;8,1,1,3.;' // STEP_END // STEP_START // &
      '*BOUNDARY;5,1,1,.1;*BOUNDARY,FIXED;11,2;' // STEP_END // '*STEP, AMPLITUDE=STEP;*STATIC;*BOUNDARY,OP=NEW;5,' // &
      '1,1,.7;*BOUNDARY,OP=NEW;1,1,3;' // STEP_END // STEP_START // '*BOUNDARY;6,1,1,.9;5,1,1,1.;' // STEP_END, model)
    call expect_prescribed(suite, 'step 1 support', model%steps(1), 1, 1, 0.0_DP, 0.0_DP)
    call expect_prescribed(suite, 'step 1 new', model%steps(1), 5, 1, 0.0_DP, 0.4_DP)
    call expect_prescribed(suite, 'step 2 changed', model%steps(2), 5, 1, 0.4_DP, 0.1_DP)
    call expect_prescribed(suite, 'step 2 kept', model%steps(2), 6, 1, 0.6_DP, 0.6_DP)
    call expect_prescribed(suite, 'step 2 kept from an amplitude', model%steps(2), 7, 1, 1.0_DP, 1.0_DP)
    call suite%that('step 1 amplitude', model%steps(1)%prescribed(find_prescribed(model%steps(1), 7, 1))%amplitude == 1)
    call suite%that('step 2 no amplitude', model%steps(2)%prescribed(find_prescribed(model%steps(2), 7, 1))%amplitude &
      == 0)
    call suite%that('total time continues', model%steps(2)%prescribed(find_prescribed(model%steps(2), 8, 1))%amplitude &
      == 2)
    call suite%that('fixed', model%steps(2)%prescribed(find_prescribed(model%steps(2), 11, 2))%is_held)
    call expect_prescribed(suite, 'step 3 at once', model%steps(3), 5, 1, 0.7_DP, 0.7_DP)
    call suite%that('step 3 only what is given', size(model%steps(3)%prescribed) == 4)
    call suite%that('step 4 anew from where it is', model%steps(4)%prescribed(find_prescribed(model%steps(4), 6, &
      1))%is_from_current)
    call expect_prescribed(suite, 'step 4 changed', model%steps(4), 5, 1, 0.7_DP, 1.0_DP)
    call suite%that('not from where it is', .not. model%steps(4)%prescribed(find_prescribed(model%steps(4), 5, &
      1))%is_from_current)
  end subroutine test_boundary_steps


  !> The index of a prescribed displacement; 0: not prescribed.
  function find_prescribed(step, node, dof) result(i)
    type(step_type), intent(in) :: step
    integer, intent(in) :: node, dof             !< the label of nodes 1 to 8 is their index, 11 is 9
    integer :: i
    do i = 1, size(step%prescribed)
      if (step%prescribed(i)%node == merge(9, node, node == 11) .and. step%prescribed(i)%dof == dof) return
    end do
    i = 0
  end function find_prescribed


  subroutine expect_prescribed(suite, name, step, node, dof, start, end)
    type(suite_type), intent(inout) :: suite
    character(*), intent(in) :: name
    type(step_type), intent(in) :: step
    integer, intent(in) :: node, dof
    real(DP), intent(in) :: start, end
    integer :: i
    i = find_prescribed(step, node, dof)
    call suite%that(name // ' is there', i > 0)
    if (i == 0) return
    call suite%near(name // ' start', step%prescribed(i)%start, start, 1.0e-14_DP)
    call suite%near(name // ' end', step%prescribed(i)%end, end, 1.0e-14_DP)
  end subroutine expect_prescribed


  !> CLOAD: its forms.
  subroutine test_cload(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'cload', MODEL_PART // STEP_START // '*CLOAD;TOP,3,-5.;15,3,-1.;1,2,7.;' // STEP_END, model)
    call suite%that('five forces', size(model%steps(1)%concentrated) == 5)
    call suite%near('forces of one step add up', force(model%steps(1), 13, 3, .true.), -6.0_DP, 0.0_DP)
    call suite%near('another', force(model%steps(1), 1, 2, .true.), 7.0_DP, 0.0_DP)
    call expect_error(suite, MODEL_PART // STEP_START // '*CLOAD;TOP,4,1.;' // STEP_END, 'moments')
    call expect_error(suite, MODEL_PART // STEP_START // '*CLOAD;nix,3,1.;' // STEP_END, 'node set ''nix''')
    call expect_error(suite, MODEL_PART // STEP_START // '*CLOAD;TOP,3,1.,2.;' // STEP_END, '4 values')
    call expect_error(suite, MODEL_PART // '*STEP, NLGEOM;*STATIC;*CLOAD,FOLLOWER;TOP,3,1.;' // STEP_END, 'have rotations')
    call expect_error(suite, MODEL_PART // STEP_START // '*CLOAD,FOLLOWER;TOP,3,1.;' // STEP_END // '*STEP, NLGEOM;*STATIC;' // &
      STEP_END, 'have rotations')
    call expect_error(suite, MODEL_PART // STEP_START // '*CLOAD,FOLLOWER;TOP,4,1.;' // STEP_END, 'FOLLOWER turns forces')
    call expect_error(suite, MODEL_PART // '*CLOAD;TOP,3,1.;' // STEP_PART, 'must be in a step')
  end subroutine test_cload


  !> The sum of the forces on a degree of freedom at the end or the start of a step.
  function force(step, node, dof, is_end) result(value)
    type(step_type), intent(in) :: step
    integer, intent(in) :: node, dof             !< index of the node
    logical, intent(in) :: is_end
    real(DP) :: value
    integer :: i
    value = 0
    do i = 1, size(step%concentrated)
      if (step%concentrated(i)%node /= node .or. step%concentrated(i)%dof /= dof) cycle
      value = value + merge(step%concentrated(i)%end, step%concentrated(i)%start, is_end)
    end do
  end function force


  !> CLOAD over steps: kept, replaced, ramped to zero.
  subroutine test_cload_steps(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'cload over steps', MODEL_PART // '*AMPLITUDE,NAME=A;0.,0.,2.,2.;' // STEP_START // &
      '*CLOAD;1,1,10.;2,1,20.;*CLOAD,AMPLITUDE=A;3,1,30.;2,1,4.;' // STEP_END // STEP_START // '*CLOAD;1,1,5.;1,1,1.;' &
      // STEP_END // STEP_START // '*CLOAD,OP=NEW;3,1,12.;' // STEP_END // STEP_PART // '*STEP,AMPLITUDE=STEP;' // &
      '*STATIC;*CLOAD,OP=NEW;5,1,8.;5,1,1.;' // STEP_END, model)
    call suite%near('1 grows', force(model%steps(1), 1, 1, .false.), 0.0_DP, 0.0_DP)
    call suite%that('two loads on one, of two amplitudes', size(model%steps(1)%concentrated) == 4)
    call suite%near('replaced: start', force(model%steps(2), 1, 1, .false.), 10.0_DP, 0.0_DP)
    call suite%near('replaced: end', force(model%steps(2), 1, 1, .true.), 6.0_DP, 0.0_DP)
    call suite%near('kept: start', force(model%steps(2), 2, 1, .false.), 24.0_DP, 1.0e-13_DP)
    call suite%near('kept: end', force(model%steps(2), 2, 1, .true.), 24.0_DP, 1.0e-13_DP)
    call suite%near('faded: start', force(model%steps(3), 2, 1, .false.), 24.0_DP, 1.0e-13_DP)
    call suite%near('faded: end', force(model%steps(3), 2, 1, .true.), 0.0_DP, 0.0_DP)
    call suite%near('new after OP=NEW: start', force(model%steps(3), 3, 1, .false.), 30.0_DP, 1.0e-13_DP)
    call suite%near('new after OP=NEW: end', force(model%steps(3), 3, 1, .true.), 12.0_DP, 0.0_DP)
    call suite%that('faded ones are gone', size(model%steps(4)%concentrated) == 1)
    call suite%near('at once: start', force(model%steps(5), 5, 1, .false.), 9.0_DP, 0.0_DP)
    call suite%near('at once: old one', force(model%steps(5), 3, 1, .false.), 0.0_DP, 0.0_DP)
  end subroutine test_cload_steps


  !> DLOAD and DSLOAD.
  subroutine test_dload(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'dload', MODEL_PART // SURFACES // STEP_START // '*DLOAD;E,P2,3.;2, p2, 1.;low, P, 2.;E,' // &
      'Grav,9.81,0,0,-2;*DSLOAD;high,P,5.;' // STEP_END // STEP_START // '*DLOAD;2,P2,10.;E,GRAV,5.,0.,0.,-1.;' // &
      STEP_END // STEP_START // '*DLOAD,OP=NEW;' // STEP_END // STEP_PART, model, n_notes=1)   ! gravity in m/s2
    associate (d => model%steps(1)%distributed)
      call suite%that('five loads', size(d) == 5)
      call suite%that('kinds', count(d%kind == DISTRIBUTED_PRESSURE) == 3 .and. count(d%kind == DISTRIBUTED_GRAVITY) &
        == 2)
      call suite%near('pressures add up', sum(d%end, mask=d%kind == DISTRIBUTED_PRESSURE .and. d%face == 2 .and. &
        d%element == 1), 5.0_DP, 0.0_DP)
      call suite%near('on the other', sum(d%end, mask=d%face == 2 .and. d%element == 2), 4.0_DP, 0.0_DP)
      call suite%near('on a surface', sum(d%end, mask=d%face == 1), 5.0_DP, 0.0_DP)
      call suite%near('direction', d(4)%direction(3), -1.0_DP, 0.0_DP)
    end associate
    associate (d => model%steps(2)%distributed)
      call suite%near('replaced: start', sum(d%start, mask=d%face == 2 .and. d%element == 2), 4.0_DP, 0.0_DP)
      call suite%near('replaced: end', sum(d%end, mask=d%face == 2 .and. d%element == 2), 10.0_DP, 0.0_DP)
      call suite%near('gravity: start', sum(d%start, mask=d%kind == DISTRIBUTED_GRAVITY), 19.62_DP, 1.0e-12_DP)
      call suite%near('gravity: end', sum(d%end, mask=d%kind == DISTRIBUTED_GRAVITY), 10.0_DP, 0.0_DP)
    end associate
    call suite%near('OP=NEW fades', sum(abs(model%steps(3)%distributed%end)), 0.0_DP, 0.0_DP)
    call suite%near('from what it was', sum(model%steps(3)%distributed%start), 30.0_DP, 1.0e-12_DP)
    call suite%that('then it is gone', size(model%steps(4)%distributed) == 0)
    call expect_error(suite, MODEL_PART // STEP_START // '*DLOAD;E,P7,1.;' // STEP_END, 'P1 to P6')
    call expect_error(suite, MODEL_PART // STEP_START // '*DLOAD;E,NEWTON;' // STEP_END, 'it is ''NEWTON''')
    call expect_error(suite, MODEL_PART // STEP_START // '*DLOAD;X,P1,1.;' // STEP_END, 'element set ''X''')
    call expect_error(suite, MODEL_PART // STEP_START // '*DLOAD;X,P,1.;' // STEP_END, 'surface ''X''')
    call expect_error(suite, MODEL_PART // STEP_START // '*DSLOAD;X,P1,1.;' // STEP_END, 'must be P')
    call expect_error(suite, MODEL_PART // STEP_START // '*DLOAD;E,GRAV,9.81;' // STEP_END, 'must not be zero')
    call expect_error(suite, MODEL_PART // '*ELEMENT,TYPE=C3D4,ELSET=E;3,1,2,3,5;' // STEP_START // '*DLOAD;E,P6,1.;' &
      // STEP_END, 'takes no load P6')
    call expect_error(suite, NODES // CUBES // '*MATERIAL,NAME=STEEL;*ELASTIC;1.,0.;*SOLID SECTION,ELSET=E,' // &
      'MATERIAL=STEEL;' // STEP_START // '*DLOAD;E,GRAV,9.81,0,0,-1;' // STEP_END, 'no *DENSITY')
    call expect_error(suite, MODEL_PART // '*SURFACE,NAME=N,TYPE=NODE;1;' // STEP_START // '*DLOAD;N,P,1.;' // &
      STEP_END, 'needs element faces')
  end subroutine test_dload


  !> STEP and END STEP.
  subroutine test_steps(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'steps', MODEL_PART // '*STEP, NLGEOM, INC=7, NAME=Step-1, UNSYMM=YES;Press it;*STATIC;' // &
      STEP_END // STEP_PART // '*STEP,NLGEOM=NO;*STATIC;' // STEP_END, model, n_notes=1)
    call suite%that('title', model%steps(1)%title == 'Press it' .and. model%steps(2)%title == '')
    call suite%that('nlgeom stays, until NO', model%steps(1)%is_nlgeom .and. model%steps(2)%is_nlgeom .and. .not. &
      model%steps(3)%is_nlgeom)
    call suite%that('inc does not stay', model%steps(1)%max_increments == 7 .and. model%steps(2)%max_increments == 100)
    call expect_error(suite, MODEL_PART, 'no step')
    call expect_error(suite, MODEL_PART // '*STEP;' // STEP_END, 'no *STATIC', '*STEP')
    call expect_error(suite, MODEL_PART // '*STEP;*MODAL DYNAMIC;.1,1.;' // STEP_END, 'Vibration is not computed.')
    call test_dynamic(suite)
    call expect_error(suite, MODEL_PART // STEP_START // STEP_PART, 'no *END STEP')
    call expect_error(suite, MODEL_PART // STEP_START, 'no *END STEP')
    call expect_error(suite, MODEL_PART // STEP_PART // STEP_END, 'must be in a step')
    call expect_error(suite, MODEL_PART // '*STEP,INC=0;*STATIC;' // STEP_END, 'INC must be')
    call expect_error(suite, MODEL_PART // STEP_START // '*HEADING;' // STEP_END, 'before the first step')
    call expect_error(suite, MODEL_PART // STEP_START // STEP_END // 'text;', 'takes no data', 'text')
  end subroutine test_steps


  !> DYNAMIC.
  subroutine test_dynamic(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: QUASI_STATIC = '*STEP;*DYNAMIC,APPLICATION=QUASI-STATIC;'
    call read_good(suite, 'dynamic', MODEL_PART // QUASI_STATIC // '.1,2.;' // STEP_END // STEP_PART, model)
    call suite%that('dynamic: in its step alone', model%steps(1)%is_dynamic .and. .not. model%steps(2)%is_dynamic)
    call suite%that('dynamic: times', maxval(abs([model%steps(1)%period, model%steps(1)%dt_max] - 2)) < 1.0e-12_DP)
    call expect_error(suite, MODEL_PART // '*STEP;*DYNAMIC;.1,1.;' // STEP_END, 'APPLICATION=QUASI-STATIC', '*DYNAMIC')
    call expect_error(suite, MODEL_PART // '*STEP;*DYNAMIC,APPLICATION=MODERATE DISSIPATION;' // STEP_END, 'vibration')
    call expect_error(suite, NODES // CUBES // '*MATERIAL,NAME=M;*ELASTIC;1.,0.;*SOLID SECTION,ELSET=E,MATERIAL=M;' // &
      QUASI_STATIC // STEP_END, 'give *DENSITY to the material')
    call expect_error(suite, MODEL_PART // '*STEP;*DYNAMIC,APPLICATION=QUASI-STATIC,ALPHA=-0.1;' // STEP_END, 'no such parameter')
    call expect_error(suite, MODEL_PART // '*STEP,PERTURBATION;*DYNAMIC,APPLICATION=QUASI-STATIC;' // STEP_END, 'PERTURBATION')
  end subroutine test_dynamic


  !> STATIC.
  subroutine test_static(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: S = MODEL_PART // '*STEP;*STATIC;'
    call read_good(suite, 'static', S // STEP_END // '*STEP;*STATIC, DIRECT;.25,2.;' // STEP_END // &
      '*STEP;*STATIC, SOLVER=SPOOLES;.5,4.,.001,1.;' // STEP_END, model)
    call expect_times(suite, model%steps(1), [1.0_DP, 1.0_DP, 1.0e-6_DP, 1.0_DP])
    call expect_times(suite, model%steps(2), [0.25_DP, 2.0_DP, 2.0e-6_DP, 2.0_DP])
    call expect_times(suite, model%steps(3), [0.5_DP, 4.0_DP, 0.001_DP, 1.0_DP])
    call suite%that('direct', model%steps(2)%is_direct .and. .not. model%steps(3)%is_direct)
    call read_good(suite, 'first increment above the largest', S // '.5,1.,,.1;' // STEP_END, model, n_notes=1)
    call expect_times(suite, model%steps(1), [0.1_DP, 1.0_DP, 1.0e-6_DP, 0.1_DP])
    call expect_error(suite, S // '2.,1.;' // STEP_END, 'longer than the step', '2.,1.')
    call expect_error(suite, S // '-.1,1.;' // STEP_END, 'must be positive')
    call expect_error(suite, S // '.1,1.,-.2;' // STEP_END, 'must be positive')
    call expect_error(suite, S // 'x,1.;' // STEP_END, 'first increment')
    call expect_error(suite, S // '.1,1.,1e-5,1.,1.,1.;' // STEP_END, '6 values')
    call expect_error(suite, S // '.1,1.;.1,1.;' // STEP_END, 'takes no data')
    call expect_error(suite, MODEL_PART // '*STEP;*STATIC, RIKS;' // STEP_END, 'No load changes in this RIKS step')
  end subroutine test_static


  subroutine expect_times(suite, step, times)
    type(suite_type), intent(inout) :: suite
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: times(4)             !< first increment, period, least, largest
    call suite%near('first increment', step%dt_initial, times(1), 1.0e-15_DP)
    call suite%near('period', step%period, times(2), 1.0e-15_DP)
    call suite%near('least increment', step%dt_min, times(3), 1.0e-18_DP)
    call suite%near('largest increment', step%dt_max, times(4), 1.0e-15_DP)
  end subroutine expect_times


  !> CONTROLS.
  subroutine test_controls(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(*), parameter :: C = '*CONTROLS, PARAMETERS='
    call read_good(suite, 'controls', MODEL_PART // STEP_START // C // 'TIME INCREMENTATION;5,,10,20,11,5,,6;.3,' // &
      '.4,.8,,,,2.;' // C // 'FIELD;1e-3,1e-2,.01,,.02,1.E-5,1.E-3,1e-7;' // C // 'LINE SEARCH;,1.5,.1;' // C // &
      'GAP;1e-6;' // C // 'CONTACT;.001,.1,100,60;' // STEP_END // STEP_PART // STEP_START // '*CONTROLS, RESET;' // &
      STEP_END, model, n_notes=1)
    associate (k => model%steps(2)%controls)
      call suite%that('counts, and they stay', all([k%i_0, k%i_r, k%i_p, k%i_c, k%i_l, k%i_g, k%i_a] == [5, 12, 10, &
        20, 11, 5, 6]))
      call suite%near('D_F', k%d_f, 0.3_DP, 0.0_DP)
      call suite%near('D_C', k%d_c, 0.4_DP, 0.0_DP)
      call suite%near('D_B', k%d_b, 0.8_DP, 0.0_DP)
      call suite%near('D_D', k%d_d, 2.0_DP, 0.0_DP)
      call suite%near('R_n', k%r_n, 1.0e-3_DP, 0.0_DP)
      call suite%near('C_n', k%c_n, 1.0e-2_DP, 0.0_DP)
      call suite%near('R_p', k%r_p, 0.02_DP, 0.0_DP)
      call suite%near('R_l', k%r_l, 1.0e-7_DP, 0.0_DP)
      call suite%near('s max', k%s_max, 1.5_DP, 0.0_DP)
      call suite%near('s min', k%s_min, 0.1_DP, 0.0_DP)
      call suite%near('gap', k%gap_tolerance, 1.0e-6_DP, 0.0_DP)
    end associate
    call suite%near('reset', model%steps(3)%controls%r_n, 1.0e-6_DP, 0.0_DP)
    call expect_error(suite, MODEL_PART // STEP_START // '*CONTROLS;' // STEP_END, 'needs PARAMETERS')
    call expect_error(suite, MODEL_PART // STEP_START // C // 'X;' // STEP_END, 'value X of PARAMETERS is not known')
    call expect_error(suite, MODEL_PART // STEP_START // C // 'TIME INCREMENTATION;0;' // STEP_END, 'at least 1')
    call expect_error(suite, MODEL_PART // STEP_START // C // 'TIME INCREMENTATION;4;1.5;' // STEP_END, '0 < DF < 1')
    call expect_error(suite, MODEL_PART // STEP_START // C // 'FIELD;0.;' // STEP_END, 'must be positive')
    call expect_error(suite, MODEL_PART // STEP_START // C // 'LINE SEARCH;,.1,.5;' // STEP_END, 's min <= s max')
    call expect_error(suite, MODEL_PART // STEP_START // C // 'GAP;-1.;' // STEP_END, 'must be positive')
    call expect_error(suite, MODEL_PART // STEP_START // '*CONTROLS,RESET;1;' // STEP_END, 'takes no data')
  end subroutine test_controls


  !> LINE SEARCH.
  subroutine test_line_search(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'line search', MODEL_PART // STEP_PART // STEP_START // '*LINE SEARCH, TYPE=nodal;' // &
      STEP_END // STEP_PART // STEP_START // '*LINESEARCH,TYPE=NONE;' // STEP_END, model)
    call suite%that('sticky', all(model%steps%line_search == [LINE_SEARCH_AUTO, LINE_SEARCH_NODAL, LINE_SEARCH_NODAL, &
      LINE_SEARCH_NONE]))
    call expect_error(suite, MODEL_PART // STEP_START // '*LINE SEARCH;' // STEP_END, 'TYPE=')
    call expect_error(suite, MODEL_PART // STEP_START // '*LINE SEARCH, TYPE=ARMIJO;' // STEP_END, 'ARMIJO')
    call expect_error(suite, MODEL_PART // '*LINE SEARCH, TYPE=ALL;' // STEP_PART, 'must be in a step')
  end subroutine test_line_search


  !> NODE PRINT, EL PRINT, CONTACT PRINT.
  subroutine test_prints(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    call read_good(suite, 'prints', MODEL_PART // STEP_START // '*NODE PRINT, NSET=TOP, TOTALS=YES, FREQUENCY=5;U,' // &
      ' rf;*NODE PRINT, NSET=BOT, TOTALS=ONLY;RF;*EL PRINT, ELSET=E;S,;E;*CONTACT PRINT;CDISP,CSTRESS,SCEN;' // &
      STEP_END // STEP_START // '*NODE PRINT, NSET=ALL;U,ENER;' // STEP_END, model, n_notes=1)
    associate (p => model%steps(1)%prints)
      call suite%that('kinds', all(p%kind == [PRINT_NODE, PRINT_NODE, PRINT_ELEMENT, PRINT_CONTACT]))
      call suite%that('totals', p(1)%is_totals .and. .not. p(1)%is_only_totals .and. p(2)%is_only_totals)
      call suite%that('sets', p(1)%set == 3 .and. p(2)%set == 2 .and. p(3)%set == 1)
      call suite%that('variables', all(p(1)%variables == ['U   ', 'RF  ']) .and. all(p(3)%variables == ['S   ', &
        'E   ']))
      call suite%that('long names', all(p(4)%variables == ['CDIS', 'CSTR', 'SCEN']))
    end associate
    call suite%that('frequency stays', all(model%steps%print_frequency == 5))
    call suite%that('a new card wipes its kind', all(model%steps(2)%prints%kind == [PRINT_ELEMENT, PRINT_CONTACT, &
      PRINT_NODE]))
    call expect_error(suite, MODEL_PART // STEP_START // '*NODE PRINT,NSET=X;U;' // STEP_END, 'node set ''X''')
    call expect_error(suite, MODEL_PART // STEP_START // '*EL PRINT,ELSET=X;S;' // STEP_END, 'element set ''X''')
    call expect_error(suite, MODEL_PART // STEP_START // '*EL PRINT,ELSET=E,FREQUENCY=-1;S;' // STEP_END, &
      'FREQUENCY must not')
  end subroutine test_prints


  !> NODE FILE and its likes.
  subroutine test_file_cards(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    integer :: i
    call read_good(suite, 'file cards', MODEL_PART // STEP_START // '*NODE FILE, FREQUENCY=3, OUTPUT=3D;U;*EL ' // &
      'FILE;S,E;*CONTACT FILE;CDIS,CSTR;*OUTPUT, HISTORY, FREQUENCY=9;*ELEMENT OUTPUT;S, SDV;' // STEP_END, model, &
      n_notes=0)
    call suite%that('frequency', model%steps(1)%file_frequency == 3)
    call suite%that('fields of the .frd file', all(model%steps(1)%frd%is_wanted .eqv. [(any(i == [FRD_DISP, &
      FRD_STRESS, FRD_TOSTRAIN, FRD_CONTACT, FRD_SDV, FRD_ERROR]), i=1, N_FRD)]))
  end subroutine test_file_cards


  !> Cards and places that are rejected or noted.
  subroutine test_refused(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    character(18), parameter :: REFUSED(6) = [character(18) :: 'RELEASE', 'GASKET SECTION', 'REBAR', &
      'TRANSFORMF', 'JOINT', 'NETWORK MPC']
    integer :: i
    do i = 1, size(REFUSED)
      call expect_error(suite, MODEL_PART // '*' // trim(REFUSED(i)) // ', A=B;1,2,3;' // STEP_PART, '*' // &
        trim(REFUSED(i)) // ' is not supported.')
    end do
    call expect_error(suite, MODEL_PART // '*NONSENSE;1;' // STEP_PART, 'is not known', '*NONSENSE')
    call expect_error(suite, MODEL_PART // STEP_START // '*FREQUENCY;10;' // STEP_END, 'Natural frequencies are not computed')
    call read_good(suite, 'noted cards', 'text;' // MODEL_PART // '*PREPRINT, ECHO=NO;*FILTER, NAME=T;1.,2.;' // &
      STEP_START // '*RESTART, WRITE;*MONITOR, NODE=1;' // STEP_END, model, n_notes=4)
    call suite%that('RESTART, WRITE keeps the checkpoint', model%keeps_checkpoint)
    call read_good(suite, 'abbreviations', MODEL_PART // '*BOUND;1,1;' // STEP_PART, model, n_notes=1)
    call suite%that('are expanded', size(model%steps(1)%prescribed) == 1)
  end subroutine test_refused


  !> All errors are reported together, in the order of the deck.
  subroutine test_several_errors(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    logical :: is_ordered
    call read('*RELEASE;' // MODEL_PART // '*BOUNDARY;nix,1;*FRICTION;' // STEP_START // '*CLOAD;1,9,1.;' // STEP_END // &
      '*NODE;x;', model, diagnostics, error)
    call suite%that('six errors', diagnostics%n_errors == 6 .and. diagnostics%n_items == 6)
    is_ordered = all(diagnostics%items(2:6)%line >= diagnostics%items(1:5)%line)
    call suite%that('in the order of the deck', is_ordered)
    call suite%that('the deck is refused', allocated(error))
    if (allocated(error)) call suite%that('message', error%message == '6 errors in the deck.')
    call read('', model, diagnostics, error)
    call suite%that('an empty deck has no nodes, elements, steps', diagnostics%n_errors == 3)
  end subroutine test_several_errors

end program test_deck
