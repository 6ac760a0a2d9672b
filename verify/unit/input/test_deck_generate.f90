!> Unit test of deck_generate: nodes on lines, arcs and parabolas, between sets, copies; rows, layers and copies of elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_generate
  use amontons_kinds, only: DP
  use amontons_cards, only: cards_type, deck_messages_type, open_cards_text, line_text
  use amontons_deck_generate, only: generate_mesh
  use amontons_deck_labels, only: label_scope_type, clear_scope, read_mesh_card, find_label_index, find_element
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  real(DP), parameter :: TOL = 1.0e-14_DP            ! rounding of coordinates of size 10
  type(suite_type) :: suite
  call check_lines()
  call check_fill()
  call check_copies()
  call check_elements()
  call check_scopes()
  call check_errors()
  call suite%finish()

contains

  !> Expands a deck whose lines end with a semicolon, and reads what it gives.
  subroutine expand(text, cards, messages, scope)
    character(*), intent(in) :: text
    type(cards_type), intent(out) :: cards
    type(deck_messages_type), intent(out) :: messages
    type(label_scope_type), intent(out) :: scope
    integer :: i
    call open_cards_text(deck_lines(text), 'deck', cards, messages)
    call generate_mesh(cards, messages)
    call clear_scope(scope)
    do i = 1, cards%n_cards
      call read_mesh_card(cards, i, scope)
    end do
  end subroutine expand


  !> The place of a node.
  subroutine expect(scope, label, x)
    type(label_scope_type), intent(in) :: scope
    integer, intent(in) :: label
    real(DP), intent(in) :: x(3)
    character(8) :: name
    integer :: i
    write (name, '(i0)') label
    i = find_label_index(label, scope%at, scope%label(:scope%n))
    call suite%that('node ' // name, i > 0)
    if (i > 0) call suite%near('place of node ' // name, maxval(abs(scope%x(:, i) - x)), 0.0_DP, TOL)
  end subroutine expect


  !> Whether a set of nodes has given members.
  logical function has_members(scope, name, members)
    type(label_scope_type), intent(in) :: scope
    character(*), intent(in) :: name
    integer, intent(in) :: members(:)
    integer :: set
    has_members = .false.
    set = scope%node_names%find(name)
    if (set == 0) return
    if (scope%node_sets(set)%n /= size(members)) return
    has_members = all(scope%node_sets(set)%items(:size(members)) == members)
  end function has_members


  !> NGEN on a straight line, up and down in number; on a quarter circle by its centre; on three quarters by the normal; on a
  !! parabola through its middle.
  subroutine check_lines()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(label_scope_type) :: scope
    real(DP), parameter :: HALF = sqrt(0.5_DP)
    call expand('*NODE;1,0,0,0;5,8,4,0;*NGEN, NSET=L;1,5;', cards, messages, scope)
    call suite%that('three new nodes', scope%n == 5 .and. messages%n == 0)
    call expect(scope, 2, [2.0_DP, 1.0_DP, 0.0_DP])
    call expect(scope, 4, [6.0_DP, 3.0_DP, 0.0_DP])
    call suite%that('set with both ends', has_members(scope, 'L', [1, 2, 3, 4, 5]))
    call suite%that('the card is kept as a comment', line_text(cards, 4) == '** *NGEN, NSET=L')
    call expand('*NODE;10,0,0,0;2,8,0,0;*NGEN;10,2,4;', cards, messages, scope)
    call expect(scope, 6, [4.0_DP, 0.0_DP, 0.0_DP])
    call expand('*NODE;1,2,0,1;3,0,2,1;9,0,0,1;*NGEN, LINE=C;1,3,1,9;', cards, messages, scope)
    call expect(scope, 2, [2 * HALF, 2 * HALF, 1.0_DP])
    call expand('*NODE;1,2,0,0;4,0,2,0;*NGEN, LINE=C;1,4,1,0,0,0,0,0,0,-1;', cards, messages, scope)
    call expect(scope, 2, [0.0_DP, -2.0_DP, 0.0_DP])
    call expect(scope, 3, [-2.0_DP, 0.0_DP, 0.0_DP])
    call expand('*NODE;1,0,0,0;5,4,0,0;*NGEN, LINE=P;1,5,1,0,2,1,0;', cards, messages, scope)
    call expect(scope, 2, [1.0_DP, 0.75_DP, 0.0_DP])
    call expect(scope, 3, [2.0_DP, 1.0_DP, 0.0_DP])
  end subroutine check_lines


  !> NFILL at equal distances, and with a bias of 2: each interval is twice the next one.
  subroutine check_fill()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(label_scope_type) :: scope
    character(*), parameter :: ENDS = '*NODE;1,0,0,0;2,0,1,0;101,7,0,0;102,7,1,0;*NSET,NSET=A;1,2;*NSET,NSET=B;101,102;'
    call expand(ENDS // '*NFILL, NSET=F;A,B,2,50;', cards, messages, scope)
    call expect(scope, 51, [3.5_DP, 0.0_DP, 0.0_DP])
    call expect(scope, 52, [3.5_DP, 1.0_DP, 0.0_DP])
    call suite%that('set with both sets', has_members(scope, 'F', [1, 2, 51, 52, 101, 102]))
    call expand(ENDS // '*NFILL, BIAS=2.;A,B,3,10;', cards, messages, scope)
    call expect(scope, 11, [4.0_DP, 0.0_DP, 0.0_DP])
    call expect(scope, 22, [6.0_DP, 1.0_DP, 0.0_DP])
  end subroutine check_fill


  !> NCOPY: moved, then turned about an axis, twice.
  subroutine check_copies()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(label_scope_type) :: scope
    call expand('*NODE, NSET=A;1,1,0,0;*NCOPY, OLD SET=A, NEW SET=B, CHANGE NUMBER=10, SHIFT, MULTIPLE=2;1,0,5;' // &
      '0,0,0,0,0,2,90;', cards, messages, scope)
    call expect(scope, 11, [0.0_DP, 2.0_DP, 5.0_DP])
    call expect(scope, 21, [-3.0_DP, 0.0_DP, 10.0_DP])
    call suite%that('set of the copies', has_members(scope, 'B', [11, 21]))
    call expand('*NODE, NSET=A;1,2,0,0;*NCOPY, OLD SET=A, CHANGE NUMBER=1, SHIFT;0,0,0;1,0,0,1,0,1,180;', cards, messages, scope)
    call expect(scope, 2, [0.0_DP, 0.0_DP, 0.0_DP])
  end subroutine check_copies


  !> ELGEN with three directions; ELCOPY.
  subroutine check_elements()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(label_scope_type) :: scope
    integer :: m, set
    call expand('*ELEMENT, TYPE=C3D4;1,1,2,3,4;*ELGEN, ELSET=G;1,3,10,1,2,100,20,2,1000,500;' // &
      '*ELCOPY, OLD SET=G, NEW SET=H, ELEMENT SHIFT=5000, SHIFT NODES=7;', cards, messages, scope)
    call suite%that('twelve and their copies', scope%n_elements == 24)
    call find_element(scope, 1 + 2 * 1 + 1 * 20 + 1 * 500, m)
    call suite%that('the last', m > 0)
    call suite%that('its nodes', all(scope%elements(m)%nodes == [1, 2, 3, 4] + 2 * 10 + 100 + 1000))
    set = scope%element_names%find('G')
    call suite%that('set with the first', scope%element_sets(set)%n == 12 .and. scope%element_sets(set)%items(1) == 1)
    call find_element(scope, 5001, m)
    call suite%that('copy of the first', all(scope%elements(m)%nodes == [8, 9, 10, 11]) .and. scope%elements(m)%type == 'C3D4')
    set = scope%element_names%find('H')
    call suite%that('set of the copies alone', scope%element_sets(set)%n == 12 .and. scope%element_sets(set)%items(1) == 5001)
  end subroutine check_elements


  !> A part has its own numbers; after it those of the model count again. A deck without generators stays as it is.
  subroutine check_scopes()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(label_scope_type) :: scope
    call expand('*NODE;1,0,0,0;*PART, NAME=P;*NODE;1,9,9,9;3,9,9,9;*END PART;*NGEN;1,3;', cards, messages, scope)
    call suite%that('node 3 of the part is unknown outside', messages%n_errors == 1)
    call expand('*NODE;1,0,0,0;*NSET, NSET=A;1;', cards, messages, scope)
    call suite%that('unchanged', cards%n_lines == 4 .and. cards%n_cards == 2)
  end subroutine check_scopes


  !> One error each, and the deck stays as it was.
  subroutine check_errors()
    character(*), parameter :: ENDS = '*NODE;1,0,0,0;5,8,4,0;*NSET,NSET=A;1;*NSET,NSET=B;1,5;'
    call expect_error(ENDS // '*NGEN;1,9;', 'no node 9 before this card')
    call expect_error(ENDS // '*NGEN;1,5,3;', 'no multiple of the step 3')
    call expect_error(ENDS // '*NGEN;1,1;', 'no multiple')
    call expect_error(ENDS // '*NGEN;1,x;', 'must be an integer')
    call expect_error(ENDS // '*NGEN, LINE=S;1,5;', 'LINE must be C')
    call expect_error(ENDS // '*NGEN, FOO=1;1,5;', 'FOO of *NGEN is not supported')
    call expect_error(ENDS // '*NFILL;A,B,2,1;', 'same number of nodes')
    call expect_error(ENDS // '*NFILL;A,A,0,1;', 'at least one interval')
    call expect_error(ENDS // '*NFILL;A,Q,2,1;', 'no node set ''Q''')
    call expect_error(ENDS // '*NFILL, BIAS=-1.;A,A,2,1;', 'BIAS must be positive')
    call expect_error(ENDS // '*NFILL, BIAS=x;A,A,2,1;', 'BIAS must be a number')
    call expect_error(ENDS // '*NCOPY, OLD SET=Q, CHANGE NUMBER=1, SHIFT;;', 'no node set ''Q''')
    call expect_error(ENDS // '*NCOPY, OLD SET=A, SHIFT;;', 'needs CHANGE NUMBER')
    call expect_error(ENDS // '*NCOPY, OLD SET=A, CHANGE NUMBER=1;;', 'needs SHIFT')
    call expect_error(ENDS // '*ELGEN;3,2;', 'no element 3 before this card')
    call expect_error('*ELEMENT, TYPE=MASS, ELSET=E;1,1;*ELGEN;1,3000,1,1,3000,1,1,3000;', 'more than ten million')
    call expect_error('*ELEMENT, TYPE=MASS, ELSET=E;1,1;*ELCOPY, OLD SET=E;', 'needs ELEMENT SHIFT')
    call expect_error('*ELEMENT, TYPE=MASS, ELSET=E;1,1;*ELCOPY, OLD SET=F, ELEMENT SHIFT=1;', 'no element set ''F''')
  end subroutine check_errors


  !> Expands a deck that gives one error with a piece of text.
  subroutine expect_error(text, piece)
    character(*), intent(in) :: text, piece
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(label_scope_type) :: scope
    character(:), allocatable :: reported
    logical :: is_warning
    integer :: line, c
    call expand(text, cards, messages, scope)
    reported = 'none'
    if (messages%n > 0) call messages%get(1, line, is_warning, reported)
    call suite%that(piece // ': ' // reported, messages%n_errors == 1 .and. messages%n == 1 .and. index(reported, piece) > 0)
    call suite%that('the deck stays, for ' // piece, any([(index('NGEN|NFILL|NCOPY|ELGEN|ELCOPY', cards%cards(c)%key) > 0, &
      c=1, cards%n_cards)]))
  end subroutine expect_error

end program test_deck_generate
