!> Unit test of deck_labels: nodes, elements and sets of cards by label, cylindrical and spherical coordinates, large labels.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_labels
  use amontons_kinds, only: DP
  use amontons_cards, only: cards_type, deck_messages_type, open_cards_text
  use amontons_containers, only: integer_list_type
  use amontons_deck_labels, only: deck_element_type, label_scope_type, clear_scope, read_mesh_card, find_or_add_set, add_node, &
    add_element, sort_unique, find_label_index, find_element, to_cartesian
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  type(suite_type) :: suite
  call check_coordinates()
  call check_cards()
  call check_ranges()
  call check_large_labels()
  call check_growth()
  call check_sorting()
  call suite%finish()

contains

  !> Reads all cards of a text whose lines end with a semicolon.
  subroutine read(text, scope)
    character(*), intent(in) :: text
    type(label_scope_type), intent(out) :: scope
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    integer :: i
    call open_cards_text(deck_lines(text), 'deck', cards, messages)
    call clear_scope(scope)
    do i = 1, cards%n_cards
      call read_mesh_card(cards, i, scope)
    end do
  end subroutine read


  !> Radius and angles in degrees.
  subroutine check_coordinates()
    real(DP), parameter :: TOL = 1.0e-15_DP            ! rounding of sine and cosine of numbers of size 2
    real(DP) :: x(3)
    x = to_cartesian('C', [2.0_DP, 30.0_DP, 5.0_DP])
    call suite%near('cylindrical', maxval(abs(x - [sqrt(3.0_DP), 1.0_DP, 5.0_DP])), 0.0_DP, 2 * TOL)
    x = to_cartesian('S', [2.0_DP, 60.0_DP, 30.0_DP])
    call suite%near('spherical: angle about z, then above the plane', maxval(abs(x - [sqrt(0.75_DP), 1.5_DP, 1.0_DP])), &
      0.0_DP, 2 * TOL)
    x = to_cartesian('R', [2.0_DP, 90.0_DP, 30.0_DP])
    call suite%near('Cartesian', maxval(abs(x - real([2, 90, 30], DP))), 0.0_DP, 0.0_DP)
  end subroutine check_coordinates


  !> Nodes, an element over two rows, sets of both, members by name.
  subroutine check_cards()
    type(label_scope_type) :: scope
    integer :: m
    call read('*NODE, NSET=N, SYSTEM=C;3,1,90;1,1,0,4;x,1,1,1;*ELEMENT, TYPE=C3D8, ELSET=E;7,1,2,3,4,;5,6,7,8;' // &
      '*ELEMENT, TYPE=NONSENSE, ELSET=F;8,1,2;*NSET, NSET=M;9,N,Q,1;*NSET, NSET=N, ELSET=E;*NSET, NSET=U, UNSORTED;9,2,9;' // &
      '*ELSET, ELSET=G;E,5,5;', scope)
    call suite%that('two nodes; a row without a number is left out', scope%n == 2 .and. all(scope%label(:2) == [3, 1]))
    call suite%near('the system of the card', maxval(abs(scope%x(:, 1) - real([0, 1, 0], DP))), 0.0_DP, 1.0e-15_DP)
    call suite%near('third coordinate', scope%x(3, 2), 4.0_DP, 0.0_DP)
    call suite%that('the set is in order', all(scope%node_sets(1)%items(:2) == [1, 3]) .and. scope%node_sets(1)%n == 2)
    call suite%that('numbers and a set', scope%node_sets(2)%n == 3 .and. all(scope%node_sets(2)%items(:3) == [1, 3, 9]))
    call suite%that('unsorted', all(scope%node_sets(3)%items(:3) == [9, 2, 9]))
    call find_element(scope, 7, m)
    call suite%that('element', m == 1 .and. scope%n_elements == 1)
    call suite%that('over two rows', size(scope%elements(1)%nodes) == 8 .and. scope%elements(1)%nodes(8) == 8)
    call suite%that('type as written', scope%elements(1)%type == 'C3D8')
    call find_element(scope, 8, m)
    call suite%that('an element of an unknown type is left out', m == 0)
    m = scope%element_names%find('G')
    call suite%that('set of elements', scope%element_sets(m)%n == 2 .and. all(scope%element_sets(m)%items(:2) == [5, 7]))
  end subroutine check_cards


  !> GENERATE: first, last, step; rows that are invalid are left out.
  subroutine check_ranges()
    type(label_scope_type) :: scope
    call read('*NSET, NSET=A, GENERATE;2,9,3;*NSET, NSET=B, GENERATE;4;1,x;1,3,0;5,1;x,3;;*NSET, NSET=C, GENERATE;7,8;', scope)
    call suite%that('2, 5, 8', scope%node_sets(1)%n == 3 .and. all(scope%node_sets(1)%items(:3) == [2, 5, 8]))
    call suite%that('no valid range', scope%node_sets(2)%n == 0)
    call suite%that('step 1 by default', all(scope%node_sets(3)%items(:2) == [7, 8]))
  end subroutine check_ranges


  !> Labels that are too large for the direct table are searched; the last of equal labels counts; others are unknown.
  subroutine check_large_labels()
    type(label_scope_type) :: scope
    integer, parameter :: LARGE = 20000001
    call clear_scope(scope)
    call add_node(scope, 5, [0.0_DP, 0.0_DP, 0.0_DP], 0)
    call add_node(scope, LARGE, [1.0_DP, 0.0_DP, 0.0_DP], 0)
    call add_node(scope, 5, [2.0_DP, 0.0_DP, 0.0_DP], 0)
    call suite%that('direct', find_label_index(5, scope%at, scope%label(:scope%n)) == 3)
    call suite%that('searched', find_label_index(LARGE, scope%at, scope%label(:scope%n)) == 2)
    call add_node(scope, LARGE, [3.0_DP, 0.0_DP, 0.0_DP], 0)
    call suite%that('the last of two', find_label_index(LARGE, scope%at, scope%label(:scope%n)) == 4)
    call suite%that('unknown', find_label_index(6, scope%at, scope%label(:scope%n)) == 0 .and. &
      find_label_index(LARGE + 1, scope%at, scope%label(:scope%n)) == 0)
    call suite%that('not positive', find_label_index(0, scope%at, scope%label(:scope%n)) == 0 .and. &
      find_label_index(-3, scope%at, scope%label(:scope%n)) == 0)
  end subroutine check_large_labels


  !> Lists grow and keep what they hold.
  subroutine check_growth()
    type(label_scope_type) :: scope
    type(deck_element_type) :: element
    integer :: i, set, m
    call clear_scope(scope)
    set = find_or_add_set('all', scope%node_names, scope%node_sets)
    call suite%that('an empty name is no set', find_or_add_set('', scope%node_names, scope%node_sets) == 0)
    call suite%that('the same set', find_or_add_set('ALL', scope%node_names, scope%node_sets) == set)
    do i = 1, 1000
      call add_node(scope, 3 * i, [real(i, DP), 0.0_DP, 0.0_DP], set)
      element%label = 2 * i
      element%nodes = [i]
      call add_element(scope, element, 0)
    end do
    call suite%that('a thousand', scope%n == 1000 .and. scope%n_elements == 1000 .and. scope%node_sets(set)%n == 1000)
    i = find_label_index(3 * 257, scope%at, scope%label(:scope%n))
    call suite%that('node of a label', i == 257)
    call suite%near('its place', scope%x(1, i), 257.0_DP, 0.0_DP)
    call find_element(scope, 2 * 999, m)
    call suite%that('element of a label', m == 999 .and. scope%elements(m)%nodes(1) == 999)
  end subroutine check_growth


  !> Ascending, each once.
  subroutine check_sorting()
    type(integer_list_type) :: list
    call sort_unique(list)
    call suite%that('empty', list%n == 0)
    call list%add(5)
    call list%add(-2)
    call list%add(5)
    call list%add(0)
    call sort_unique(list)
    call suite%that('sorted', list%n == 3 .and. all(list%items(:3) == [-2, 0, 5]))
  end subroutine check_sorting

end program test_deck_labels
