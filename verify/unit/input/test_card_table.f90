!> Unit test of card_table: what holds for all entries, and decisions for single cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_card_table
  use amontons_card_schema, only: card_table_type, find_entry, SCOPE_MODEL, SCOPE_STEP, SCOPE_BOTH, ENTRY_SUPPORTED, &
    ENTRY_IGNORED, ENTRY_REJECTED, VALUE_WORD, VALUE_OPTIONAL_WORD, VALUE_NAME
  use amontons_card_table, only: make_card_table, list_cards, NODE_VARIABLES, ELEMENT_VARIABLES, CONTACT_VARIABLES, &
    SECTION_VARIABLES
  use amontons_text, only: count_words, nth_word, is_one_of
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(card_table_type) :: table
  call make_card_table(table)
  call check_entries()
  call check_options()
  call check_decisions()
  call check_text()
  call suite%finish()

contains

  !> Sentences are there, parents are supported cards, keys are unique, data lines of cards that are read are described.
  subroutine check_entries()
    integer :: i, k, j
    logical :: is_there
    call suite%that('more than a hundred cards', table%n > 100)
    do i = 1, table%n
      associate (entry => table%entries(i))
        call suite%that(entry%keyword // ' has a sentence', len_trim(entry%description) > 0)
        call suite%that(entry%keyword // ' has a scope', any(entry%scope == [SCOPE_MODEL, SCOPE_STEP, SCOPE_BOTH]))
        call suite%that(entry%keyword // ' stands once', count([(table%entries(k)%key == entry%key, k=1, table%n)]) == 1)
        do j = 1, count_words(entry%parent)
          is_there = .false.
          do k = 1, table%n
            if (table%entries(k)%key == nth_word(entry%parent, j)) is_there = table%entries(k)%status == ENTRY_SUPPORTED
          end do
          call suite%that(entry%keyword // ' follows a card that is read', is_there)
        end do
      end associate
    end do
  end subroutine check_entries


  !> Options: words are listed, a default is one of them, no word is both allowed and refused, names are unique.
  subroutine check_options()
    integer :: i, j, k
    do i = 1, table%n
      do j = 1, table%entries(i)%n_options
        associate (option => table%entries(i)%options(j), key => table%entries(i)%keyword)
          call suite%that(key // ', ' // option%name // ' stands once', &
            count([(table%entries(i)%options(k)%name == option%name, k=1, table%entries(i)%n_options)]) == 1)
          if (option%status == ENTRY_REJECTED) call suite%that(key // ', ' // option%name // ' says why', option%description /= '')
          if (all(option%kind /= [VALUE_WORD, VALUE_OPTIONAL_WORD]) .or. option%status /= ENTRY_SUPPORTED) cycle
          call suite%that(key // ', ' // option%name // ' has words', option%allowed /= '')
          if (option%refused /= '') call suite%that(key // ', ' // option%name // ' says why', option%message /= '')
          do k = 1, count_words(option%refused)
            call suite%that(key // ': ' // nth_word(option%refused, k) // ' is not allowed, too', &
              .not. is_one_of(nth_word(option%refused, k), option%allowed))
          end do
        end associate
      end do
    end do
  end subroutine check_options


  !> Scope and status of single cards, which the reader relies on.
  subroutine check_decisions()
    call expect('NODE', SCOPE_MODEL, ENTRY_SUPPORTED)
    call expect('BOUNDARY', SCOPE_BOTH, ENTRY_SUPPORTED)
    call expect('CLOAD', SCOPE_STEP, ENTRY_SUPPORTED)
    call expect('CONTACTPAIR', SCOPE_MODEL, ENTRY_SUPPORTED)
    call expect('STATIC', SCOPE_STEP, ENTRY_SUPPORTED)
    call expect('MODAL DYNAMIC', SCOPE_BOTH, ENTRY_REJECTED)
    call expect('FREQUENCY', SCOPE_BOTH, ENTRY_REJECTED)
    call expect('GASKETSECTION', SCOPE_BOTH, ENTRY_REJECTED)
    call expect('MEMBRANESECTION', SCOPE_MODEL, ENTRY_SUPPORTED)
    call expect('PREPRINT', SCOPE_BOTH, ENTRY_IGNORED)
    call suite%that('variables of prints', is_one_of('RF', NODE_VARIABLES) .and. is_one_of('PEEQ', ELEMENT_VARIABLES) .and. &
      is_one_of('CSTR', CONTACT_VARIABLES) .and. is_one_of('SOF', SECTION_VARIABLES))
    call expect_required('CONTACTPAIR', 'INTERACTION')
    call expect_required('MATERIAL', 'NAME')
    call expect_required('SOLIDSECTION', 'ELSET')
  end subroutine check_decisions


  !> Where a card is allowed, and what becomes of it.
  subroutine expect(key, scope, status)
    character(*), intent(in) :: key
    integer, intent(in) :: scope, status
    integer :: i
    logical :: is_short
    call find_entry(table, key, i, is_short)
    call suite%that(key // ' is in the table', i > 0 .and. .not. is_short)
    if (i == 0) return
    call suite%that(key // ': scope', table%entries(i)%scope == scope)
    call suite%that(key // ': status', table%entries(i)%status == status)
  end subroutine expect


  !> A name that a card needs.
  subroutine expect_required(key, name)
    character(*), intent(in) :: key, name
    integer :: i, j
    logical :: is_short, is_needed
    call find_entry(table, key, i, is_short)
    is_needed = .false.
    do j = 1, table%entries(i)%n_options
      if (table%entries(i)%options(j)%name == name) is_needed = table%entries(i)%options(j)%default == 'required' .and. &
        table%entries(i)%options(j)%kind == VALUE_NAME
    end do
    call suite%that(key // ' needs ' // name, is_needed)
  end subroutine expect_required


  !> The text for the manual names each card once as a heading or in a list.
  subroutine check_text()
    character(:), allocatable :: text
    integer :: i
    call list_cards(text)
    do i = 1, table%n
      if (table%entries(i)%status == ENTRY_SUPPORTED) then
        call suite%that('heading of ' // table%entries(i)%keyword, index(text, '*' // table%entries(i)%keyword // '  (') > 0)
      else
        call suite%that('line of ' // table%entries(i)%keyword, index(text, '    *' // table%entries(i)%keyword) > 0)
      end if
    end do
  end subroutine check_text

end program test_card_table
