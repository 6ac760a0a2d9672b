!> Unit test of amontons_model_check_bodies: lists in words, and the report.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_model_check_bodies
  use amontons_errors, only: diagnostic_list_type
  use amontons_model_check_bodies, only: report_error, report_warning, label_list, step_list, join_item, counted_noun
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  call check_lists()
  call check_report()
  call suite%finish()

contains

  !> One, two, several, too many.
  subroutine check_lists()
    integer :: i
    call suite%that('one label', label_list([7]) == '7')
    call suite%that('three labels', label_list([3, 5, 8]) == '3, 5 and 8')
    call suite%that('many labels', index(label_list([(i, i=1, 17)]), '7 more') > 0)
    call suite%that('one step', step_list([2]) == 'step 2')
    call suite%that('two steps', step_list([1, 3]) == 'steps 1 and 3')
    call suite%that('a run of steps', step_list([2, 3, 4, 5]) == 'steps 2 to 5')
    call suite%that('a subject', counted_noun('node', [7], 'is', 'are') == 'node 7 is')
    call suite%that('two subjects', counted_noun('node', [7, 9], 'is', 'are') == '2 nodes (7 and 9) are')
    call suite%that('an enumeration', join_item(join_item('', 'a', .false.), 'b', .true.) == 'a and b')
  end subroutine check_lists


  !> Errors and warnings are counted apart.
  subroutine check_report()
    type(diagnostic_list_type) :: report
    call report_error(report, 'It moves.')
    call report_warning(report, 'It may move.')
    call suite%that('counts', report%n_errors == 1 .and. report%n_warnings == 1)
    call suite%that('words', report%items(1)%text == 'It moves.')
  end subroutine check_report

end program test_model_check_bodies
