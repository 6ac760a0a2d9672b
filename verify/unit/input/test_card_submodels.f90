!> Unit test of card_submodels: the entry of SUBMODEL, and the parameters of cards that use it.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_card_submodels
  use amontons_card_schema, only: card_table_type, find_entry, SCOPE_MODEL, SCOPE_STEP, ENTRY_SUPPORTED, ENTRY_REJECTED
  use amontons_card_submodels, only: describe_submodel, describe_global_step
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(card_table_type) :: table
  integer :: i, k
  logical :: is_short
  call describe_submodel(table)
  call find_entry(table, 'SUBMODEL', i, is_short)
  call suite%that('SUBMODEL is a card of the model with data', i > 0 .and. .not. is_short .and. &
    table%entries(i)%scope == SCOPE_MODEL .and. table%entries(i)%data /= '' .and. table%entries(i)%dialects /= '')
  call suite%that('INPUT and GLOBAL', status_of('INPUT') == ENTRY_SUPPORTED .and. status_of('GLOBAL') == ENTRY_SUPPORTED)
  call suite%that('tolerances', status_of('EXTERIOR TOLERANCE') == ENTRY_SUPPORTED .and. &
    status_of('ABSOLUTE EXTERIOR TOLERANCE') == ENTRY_SUPPORTED)
  call suite%that('shells to solids are rejected', status_of('SHELL TO SOLID') == ENTRY_REJECTED)
  call table%card('TEMPERATURE', SCOPE_STEP, 'Temperatures.', data='node')
  call describe_global_step(table, 'The temperatures')
  call find_entry(table, 'TEMPERATURE', i, is_short)
  call suite%that('STEP and DATA SET', status_of('STEP') == ENTRY_SUPPORTED .and. status_of('DATA SET') == ENTRY_SUPPORTED)
  call suite%that('INC is rejected', status_of('INC') == ENTRY_REJECTED)
  call suite%finish()

contains

  !> The status of a parameter of the card; -1: it has none of this name.
  integer function status_of(name)
    character(*), intent(in) :: name
    status_of = -1
    do k = 1, table%entries(i)%n_options
      if (table%entries(i)%options(k)%name == name) status_of = table%entries(i)%options(k)%status
    end do
  end function status_of

end program test_card_submodels
