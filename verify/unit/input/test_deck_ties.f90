!> Unit test of deck_ties: valid and rejected forms of TIE and of CONTACT PAIR with TIED.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_ties
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;' // &
    '8,0,1,1;11,0,0,2;12,1,0,2;13,1,1,2;14,0,1,2;90,0,0,3;91,5,5,5;*ELEMENT, TYPE=C3D8, ELSET=E;' // &
    '1,1,2,3,4,5,6,7,8;2,5,6,7,8,11,12,13,14;*MATERIAL, NAME=M;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;' // &
    '*NSET, NSET=TOP;11,12,13,14;*NSET, NSET=REF;90;*SURFACE, NAME=UP;2,S2;*SURFACE, NAME=CUT;2,S1;' // &
    '*SURFACE, NAME=DOTS, TYPE=NODE;TOP;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: PAIR = '*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I, TIED'
  type(suite_type) :: suite
  call test_tie_cards(suite)
  call test_tied_pairs(suite)
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


  !> TIE.
  subroutine test_tie_cards(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    call read_good('*TIE, NAME=T, POSITION TOLERANCE=.5, ADJUST=NO;DOTS, UP;', model)
    call suite%that('one tie', size(model%ties) == 1 .and. .not. model%ties(1)%is_adjusted)
    call suite%near('tolerance', model%ties(1)%tolerance, 0.5_DP, 0.0_DP)
    call read_good('*TIE, NAME=T;UP, DOTS;', model)
    call suite%that('a master of nodes', size(model%ties) == 1 .and. model%ties(1)%may_be_nodal)
    call read('*TIE, NAME=T;UP, DOTS;', model, diagnostics, error, dialect=DIALECT_CALCULIX)
    call suite%that('CalculiX has none', allocated(error) .and. diagnostics%n_errors == 1)
    if (diagnostics%n_items > 0) call suite%that(diagnostics%items(1)%text, index(diagnostics%items(1)%text, &
      'CalculiX ties to faces') > 0)
    call expect_error('*SURFACE, NAME=DOT, TYPE=NODE;90;*TIE, NAME=T;UP, DOT;', 'has one node')
    call read_good('*SURFACE, NAME=DOT, TYPE=NODE;90;*TIE, NAME=T, POSITION TOLERANCE=.5;UP, DOT;', model)
    call expect_error('*TIE, NAME=T;UP, UP;', 'tied to itself')
    call expect_error('*TIE, NAME=T;UP, NIX;', 'no surface ''NIX''')
    call expect_error('*TIE, NAME=T;', 'needs a data line')
    call expect_error('*TIE, NAME=T, POSITION TOLERANCE=-1.;UP, CUT;', 'must not be negative')
    call expect_error('*TIE, NAME=T, MULTISTAGE;UP, CUT;', 'whole body')
  end subroutine test_tie_cards


  !> CONTACT PAIR, TIED: a tie in place of a pair, in the abaqus dialect.
  subroutine test_tied_pairs(suite)
    type(suite_type), intent(inout) :: suite
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    call read_good(PAIR // ', ADJUST=.25;DOTS, UP;', model)
    call suite%that('a tie and no pair', size(model%ties) == 1 .and. size(model%pairs) == 0)
    call suite%near('its tolerance', model%ties(1)%tolerance, 0.25_DP, 0.0_DP)
    call suite%that('the nodes are moved', model%ties(1)%is_adjusted)
    call expect_error(PAIR // ';DOTS, UP;', 'TIED needs ADJUST')
    call expect_error(PAIR // ', ADJUST=TOP;DOTS, UP;', 'TIED needs ADJUST')
    call expect_error(PAIR // ', ADJUST=-1.;DOTS, UP;', 'TIED needs ADJUST')
    call expect_error(PAIR // ', ADJUST=.25;DOTS, NIX;', 'no surface ''NIX''')
    call expect_error(PAIR // ', ADJUST=.25;UP, DOTS;', 'a master needs element faces')
    call read(PAIR // ', ADJUST=.25;DOTS, UP;', model, diagnostics, error, dialect=DIALECT_CALCULIX)
    call suite%that('CalculiX has no such pair', allocated(error) .and. diagnostics%n_errors == 1)
  end subroutine test_tied_pairs

end program test_deck_ties
