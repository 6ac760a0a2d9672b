!> Unit test of card_constraints: the entries of EQUATION and EMBEDDED ELEMENT.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_card_constraints
  use amontons_card_constraints, only: describe_equation, describe_embedded_elements
  use amontons_card_schema, only: card_table_type, find_entry, SCOPE_MODEL, SCOPE_BOTH, ENTRY_SUPPORTED
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(card_table_type) :: table
  integer :: i
  logical :: is_short
  call describe_equation(table)
  call find_entry(table, 'EQUATION', i, is_short)
  call suite%that('in the model, and with REMOVE in steps', table%entries(i)%scope == SCOPE_BOTH .and. &
    table%entries(i)%n_options == 2)
  call describe_embedded_elements(table)
  call find_entry(table, 'EMBEDDEDELEMENT', i, is_short)
  call suite%that('a card of the model with data', i > 0 .and. .not. is_short .and. table%entries(i)%scope == SCOPE_MODEL .and. &
    table%entries(i)%data /= '' .and. table%entries(i)%status == ENTRY_SUPPORTED)
  call suite%that('hosts and three tolerances', table%entries(i)%n_options == 4)
  call suite%finish()
end program test_card_constraints
