!> Unit test of amontons_containers: names, labels, lists, order, disjoint sets and the distance of words.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_containers
  use amontons_containers, only: name_table_type, label_table_type, integer_list_type, list_groups, &
    owners_of_entries, sort_ascending, &
    sort_integers, ascending_order, find_root, unite_trees, edit_distance
  use amontons_kinds, only: DP
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_names()
  call check_labels()
  call check_list()
  call check_groups()
  call check_sort()
  call check_order()
  call check_trees()
  call check_distance()
  call suite%finish()

contains

  !> A thousand names are found again; what is not there is not.
  subroutine check_names()
    type(name_table_type) :: table
    character(12) :: name
    integer :: i, position
    logical :: is_new
    call suite%that('empty', table%find('A') == 0)
    do i = 1, 1000
      write (name, '(a,i0)') 'SET-', i
      call table%add(trim(name), position, is_new)
      call suite%that('new', is_new .and. position == i)
    end do
    call table%add('SET-500', position, is_new)
    call suite%that('known', .not. is_new .and. position == 500 .and. table%n == 1000)
    call suite%that('found', table%find('SET-1') == 1 .and. table%find('SET-1000') == 1000)
    call suite%that('not there', table%find('SET-1001') == 0)
    table = name_table_type()
    call table%add('BOTTOM', position, is_new)
    call table%add('TOP', position, is_new)
    call suite%that('one letter wrong', table%nearest('BOTOM') == 1)
    call suite%that('nothing near', table%nearest('XYZQWERTY') == 0)
    call suite%that('a suggestion', index(table%suggest('BOTOM'), 'BOTTOM') > 0)
  end subroutine check_names


  !> Dense labels, labels far apart, labels that come twice.
  subroutine check_labels()
    type(label_table_type) :: table
    integer :: i
    call table%build([(10 + i, i=1, 50)])
    call suite%that('dense', all([(table%find(10 + i), i=1, 50)] == [(i, i=1, 50)]))
    call suite%that('outside', table%find(10) == 0 .and. table%find(61) == 0 .and. table%find(-5) == 0)
    call table%build([1000000000, 3, 70000, 5, 3])
    call suite%that('far apart', table%find(1000000000) == 1 .and. table%find(70000) == 3 .and. table%find(5) == 4)
    call suite%that('twice: the first', table%find(3) == 2)
    call suite%that('between', table%find(4) == 0 .and. table%find(999999999) == 0)
  end subroutine check_labels


  subroutine check_list()
    type(integer_list_type) :: list
    integer :: i
    call suite%that('empty', size(list%trimmed()) == 0)
    do i = 1, 300
      call list%add(i * i)
    end do
    call suite%that('all', all(list%trimmed() == [(i * i, i=1, 300)]))
  end subroutine check_list


  !> Members ascending, an empty group, members of no group, no members at all.
  subroutine check_groups()
    integer, allocatable :: first(:), members(:)
    call list_groups([3, 1, 0, 3, 1, 4], 5, first, members)
    call suite%that('starts', all(first == [1, 3, 3, 5, 6, 6]))
    call suite%that('members', size(members) == 5)
    call suite%that('ascending', all(members == [2, 5, 1, 4, 6]))
    call list_groups([integer ::], 2, first, members)
    call suite%that('no members', all(first == 1) .and. size(members) == 0)
    call suite%that('owners', all(owners_of_entries([1, 3, 3, 4]) == [1, 1, 3]))
    call suite%that('no entries', size(owners_of_entries([1, 1])) == 0 .and. size(owners_of_entries([1])) == 0)
  end subroutine check_groups


  !> Sorted, and stable: of equal keys the companion keeps its order.
  subroutine check_sort()
    integer :: keys(997), companion(997), short(13), i, n
    logical :: is_sorted, is_stable
    do n = 0, 997, 1 + 83
      keys(:n) = [(modulo(7919 * modulo(i * i, 101), 101) - 50, i=1, n)]
      companion(:n) = [(i, i=1, n)]
      call sort_integers(keys(:n), companion(:n))
      is_sorted = all(keys(2:n) >= keys(:n - 1))
      is_stable = all(keys(2:n) > keys(:n - 1) .or. companion(2:n) > companion(:n - 1))
      call suite%that('sorted', is_sorted)
      call suite%that('stable', is_stable)
      call suite%that('keys and companions', all([(keys(i) == modulo(7919 * modulo(companion(i)**2, 101), 101) - 50, i=1, n)]))
    end do
    do n = 0, 13
      short(:n) = [(modulo(7919 * i * i, 7) - 3, i=1, n)]
      keys(:n) = short(:n)
      call sort_integers(keys(:n))
      call sort_ascending(short(:n))
      call suite%that('short list sorted', all(short(:n) == keys(:n)))
    end do
  end subroutine check_sort


  subroutine check_distance()
    call suite%that('the same', edit_distance('NODE', 'NODE') == 0)
    call suite%that('changed', edit_distance('NODE', 'NOSE') == 1)
    call suite%that('put in, left out', edit_distance('NODE', 'NODES') == 1 .and. edit_distance('NODES', 'NODE') == 1)
    call suite%that('exchanged', edit_distance('NODE', 'NDOE') == 1)
    call suite%that('of nothing', edit_distance('', 'ABC') == 3)
    call suite%that('several', edit_distance('KITTEN', 'SITTING') == 3)
  end subroutine check_distance


  !> Equal keys keep their order.
  subroutine check_order()
    real(DP), parameter :: KEYS(6) = [2.5_DP, -1.0_DP, 2.5_DP, 0.0_DP, -1.0_DP, 7.0_DP]
    call suite%that('order', all(ascending_order(KEYS) == [2, 5, 4, 1, 3, 6]))
    call suite%that('one key', all(ascending_order(KEYS(:1)) == [1]))
    call suite%that('no key', size(ascending_order(KEYS(:0))) == 0)
  end subroutine check_order


  !> Nodes that were put together have one root, the smallest number.
  subroutine check_trees()
    integer :: parent(10), roots(10), i
    parent = [(i, i=1, 10)]
    call unite_trees(parent, 9, 4)
    call unite_trees(parent, 7, 9)
    call unite_trees(parent, 2, 10)
    roots = [(find_root(parent, i), i=1, 10)]
    call suite%that('two trees and nodes alone', all(roots == [1, 2, 3, 4, 5, 6, 4, 8, 4, 2]))
    call unite_trees(parent, 10, 7)
    roots = [(find_root(parent, i), i=1, 10)]
    call suite%that('both together', all(roots == [1, 2, 3, 2, 5, 6, 2, 8, 2, 2]))
  end subroutine check_trees

end program test_containers
