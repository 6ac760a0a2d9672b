!> Unit test of user_elements: names of types, unknowns, memory.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_user_elements
  use amontons_user_elements, only: user_element_type, user_elements_type, user_kind_number, user_unknowns, n_user_memory
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(user_elements_type), allocatable :: user_elements
  type(user_element_type) :: element
  call suite%that('U1 and U9999', user_kind_number('U1') == 1 .and. user_kind_number('U9999') == 9999)
  call suite%that('no such types', all([user_kind_number('U'), user_kind_number('U10000'), user_kind_number('V1'), &
    user_kind_number('U1A'), user_kind_number('')] == 0))
  element%nodes = [7, 4]
  element%place = [1, 3, 5]
  call suite%that('unknowns', all(user_unknowns(element) == [19, 21, 11]))
  call suite%that('no user elements, no memory', n_user_memory(user_elements) == 0)
  allocate (user_elements)
  user_elements%n_memory = 12
  call suite%that('memory', n_user_memory(user_elements) == 12)
  call suite%finish()
end program test_user_elements
