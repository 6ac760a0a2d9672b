!> Unit test of amontons_card_cohesive: the entries of sections and damage.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_card_cohesive
  use amontons_card_cohesive, only: describe_cohesive
  use amontons_card_schema, only: card_table_type, find_entry, SCOPE_MODEL, ENTRY_SUPPORTED, ENTRY_IGNORED, ENTRY_REJECTED
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(card_table_type) :: table
  integer :: i, k
  logical :: is_short
  call describe_cohesive(table)
  call find_entry(table, 'COHESIVE SECTION', i, is_short)
  call suite%that('COHESIVE SECTION is a card of the model with data', i > 0 .and. .not. is_short .and. &
    table%entries(i)%scope == SCOPE_MODEL .and. table%entries(i)%data /= '')
  call suite%that('its parameters', status_of('ELSET') == ENTRY_SUPPORTED .and. status_of('THICKNESS') == ENTRY_SUPPORTED)
  call find_entry(table, 'SECTION CONTROLS', i, is_short)
  call suite%that('VISCOSITY counts', status_of('VISCOSITY') == ENTRY_SUPPORTED)
  call suite%that('HOURGLASS does not', status_of('HOURGLASS') == ENTRY_IGNORED)
  call suite%that('MAX DEGRADATION is rejected', status_of('MAX DEGRADATION') == ENTRY_REJECTED)
  call find_entry(table, 'DAMAGE EVOLUTION', i, is_short)
  call suite%that('DAMAGE EVOLUTION belongs to a material', table%entries(i)%parent == 'MATERIAL')
  call suite%that('its mixture', status_of('MIXED MODE BEHAVIOR') == ENTRY_SUPPORTED .and. status_of('POWER') == ENTRY_SUPPORTED)
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

end program test_card_cohesive
