!> NSET and ELSET to member lists.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! All cards with the name of a set add to it, wherever they are in the deck; sets may name sets that come later. Node sets are in
!! the order of their numbers unless a card has UNSORTED, as in Abaqus: EQUATION and MPC bind nodes of the same place in two sets.
!! Under the calculix dialect they keep the order of the deck, as in CalculiX.
module amontons_deck_sets
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_integer, field_text
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_element_drafts, only: element_draft_type
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_integer, check_n_fields, is_card, &
    count_cards, check_name
  use amontons_containers, only: integer_list_type, label_table_type, name_table_type, sort_integers
  use amontons_mesh, only: mesh_type, set_type
  use amontons_model, only: DIALECT_CALCULIX
  use amontons_text, only: name_key, to_text, NUMBER_OK, NUMBER_EMPTY
  implicit none
  private
  public :: read_sets

  integer, parameter :: SET_UNRESOLVED = 0, SET_IN_PROGRESS = 1, SET_RESOLVED = 2

  !> A set during resolution.
  type :: pending_set_type
    character(:), allocatable :: name            !< as first written
    type(integer_list_type) :: cards             !< the cards that add members
    integer :: state = SET_UNRESOLVED
    integer, allocatable :: members(:)
    logical :: is_of_global_model = .false.      !< GLOBAL ELSET of SUBMODEL: its numbers need not be elements of this deck
    logical :: has_repeats = .false.             !< the deck names a member more than once
  end type pending_set_type

  !> The node sets or the element sets.
  type :: set_family_type
    logical :: is_node = .true.
    character(:), allocatable :: noun            !< 'node' or 'element'
    type(name_table_type) :: names
    type(label_table_type) :: labels             !< label to index
    type(pending_set_type), allocatable :: sets(:)
    integer, allocatable :: stamp(:)             !< (members that exist) last set that took it
  end type set_family_type

contains

  !> Reads all sets. The members of element sets are indices of drafts.
  subroutine read_sets(reader, draft, mesh)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    type(mesh_type), intent(inout) :: mesh
    type(set_family_type) :: elements, nodes
    elements%is_node = .false.
    elements%noun = 'element'
    elements%labels = draft%labels
    allocate (elements%stamp(draft%n), source=0)
    call gather_family(reader, 'ELEMENT', 'ELSET', elements)
    call resolve_family(reader, draft, mesh, elements)
    reader%element_set_repeats = elements%sets%has_repeats
    call store_sets(elements, mesh%element_sets)
    reader%element_sets = elements%names

    nodes%noun = 'node'
    nodes%labels = reader%node_labels
    allocate (nodes%stamp(mesh%n_nodes), source=0)
    call gather_family(reader, 'NODE', 'NSET', nodes)
    call resolve_family(reader, draft, mesh, nodes)
    reader%node_set_repeats = nodes%sets%has_repeats
    call store_sets(nodes, mesh%node_sets)
    reader%node_sets = nodes%names
  end subroutine read_sets


  !> Finds the names of all sets and the cards that add members to them.
  subroutine gather_family(reader, block_key, set_key, family)
    type(reader_type), intent(inout) :: reader
    character(*), intent(in) :: block_key        !< 'NODE' or 'ELEMENT'
    character(*), intent(in) :: set_key          !< 'NSET' or 'ELSET': card, and parameter of both cards
    type(set_family_type), intent(inout) :: family
    type(pending_set_type), allocatable :: larger(:)
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    character(:), allocatable :: name
    integer :: c, s
    logical :: is_new, has_submodel
    allocate (family%sets(64))
    has_submodel = count_cards(reader, 'SUBMODEL') > 0
    do c = 1, reader%cards%n_cards
      if (.not. (is_card(reader, c, block_key) .or. is_card(reader, c, set_key))) cycle
      call open_card(reader, c, parameters, row)
      name = parameter_text(parameters, set_key)
      if (name == '') cycle
      if (index(name_key(name), 'GMSH:') == 1) then
        call report_note(reader, reader%cards%cards(c)%line, 'The set ''' // name // ''' describes the geometry of gmsh, no ' // &
          'members of the mesh; it is left out.')
        cycle
      end if
      if (has_parameter(parameters, 'INSTANCE')) call report_error(reader, reader%cards%cards(c)%line, 'INSTANCE belongs to the ' &
        // 'sets of an assembly; this deck has none here.')
      call check_name(reader, c, name)
      call family%names%add(name, s, is_new)
      if (s > size(family%sets)) then
        allocate (larger(2 * s))
        larger(:size(family%sets)) = family%sets
        call move_alloc(larger, family%sets)
      end if
      if (is_new) family%sets(s)%name = name
      if (is_new .and. has_submodel .and. .not. family%is_node) family%sets(s)%is_of_global_model = is_global_set(reader, name)
      call family%sets(s)%cards%add(c)
    end do
  end subroutine gather_family


  !> Whether a SUBMODEL card names a set as that of the global model.
  logical function is_global_set(reader, name)
    type(reader_type), intent(in) :: reader
    character(*), intent(in) :: name
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: c
    is_global_set = .false.
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'SUBMODEL')) cycle
      call open_card(reader, c, parameters, row)
      is_global_set = is_global_set .or. name_key(parameter_text(parameters, 'GLOBAL ELSET')) == name_key(name)
    end do
  end function is_global_set


  !> Finds the members of all sets of a family.
  subroutine resolve_family(reader, draft, mesh, family)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    type(mesh_type), intent(in) :: mesh
    type(set_family_type), intent(inout) :: family
    integer :: s
    do s = 1, family%names%n
      call resolve_set(reader, draft, mesh, family, s)
    end do
  end subroutine resolve_family


  !> Moves the sets to the model.
  subroutine store_sets(family, sets)
    type(set_family_type), intent(inout) :: family
    type(set_type), allocatable, intent(out) :: sets(:)
    integer :: s
    allocate (sets(family%names%n))
    do s = 1, family%names%n
      sets(s)%name = family%sets(s)%name
      call move_alloc(family%sets(s)%members, sets(s)%members)
    end do
  end subroutine store_sets


  !> Finds the members of one set: first those of the sets that it names, then its own.
  recursive subroutine resolve_set(reader, draft, mesh, family, s)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    type(mesh_type), intent(in) :: mesh
    type(set_family_type), intent(inout) :: family
    integer, intent(in) :: s                     !< the set
    type(integer_list_type) :: members
    integer :: i
    if (family%sets(s)%state /= SET_UNRESOLVED) return
    family%sets(s)%state = SET_IN_PROGRESS
    do i = 1, family%sets(s)%cards%n
      call resolve_named(reader, draft, mesh, family, s, family%sets(s)%cards%items(i))
    end do
    do i = 1, family%sets(s)%cards%n
      call add_card_members(reader, draft, mesh, family, s, family%sets(s)%cards%items(i), members)
    end do
    family%sets(s)%members = members%trimmed()
    if (family%is_node .and. reader%dialect /= DIALECT_CALCULIX) then
      if (.not. has_unsorted(reader, family%sets(s)%cards%trimmed())) call sort_by_label(mesh, family%sets(s)%members)
    end if
    family%sets(s)%state = SET_RESOLVED
  end subroutine resolve_set


  !> Whether one of some cards has UNSORTED.
  logical function has_unsorted(reader, cards)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: cards(:)              !< NSET or NODE
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: i
    has_unsorted = .false.
    do i = 1, size(cards)
      call open_card(reader, cards(i), parameters, row)
      has_unsorted = has_unsorted .or. has_parameter(parameters, 'UNSORTED')
    end do
  end function has_unsorted


  !> Sorts nodes by their numbers in the deck.
  pure subroutine sort_by_label(mesh, nodes)
    type(mesh_type), intent(in) :: mesh
    integer, intent(inout) :: nodes(:)           !< different ones
    integer :: labels(size(nodes))
    labels = mesh%node_label(nodes)
    call sort_integers(labels, nodes)
  end subroutine sort_by_label


  !> Resolves the sets named by one card; reports unknown sets and circular references.
  recursive subroutine resolve_named(reader, draft, mesh, family, s, c)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    type(mesh_type), intent(in) :: mesh
    type(set_family_type), intent(inout) :: family
    integer, intent(in) :: s, c                  !< the set and the card
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: i, label, status, other
    if (is_block(reader, c)) return
    call open_card(reader, c, parameters, row)
    if (has_parameter(parameters, 'GENERATE')) return
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        call field_integer(reader%cards, row, i, label, status)
        if (status == NUMBER_OK .or. status == NUMBER_EMPTY) cycle
        other = family%names%find(field_text(reader%cards, row, i))
        if (other == 0) then
          call report_error(reader, row%line, 'There is no ' // family%noun // ' set ''' // &
            field_text(reader%cards, row, i) // '''.')
        else if (other /= s .and. family%sets(other)%state == SET_IN_PROGRESS) then
          call report_error(reader, row%line, 'The ' // family%noun // ' sets ''' // family%sets(s)%name // ''' and ''' // &
            family%sets(other)%name // ''' contain each other.')
        else
          call resolve_set(reader, draft, mesh, family, other)
        end if
      end do
    end do
  end subroutine resolve_named


  !> Whether a card is NODE or ELEMENT, whose set is all that it defines.
  pure function is_block(reader, c) result(is_so)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c
    logical :: is_so
    is_so = is_card(reader, c, 'NODE') .or. is_card(reader, c, 'ELEMENT')
  end function is_block


  !> Adds the members of one card.
  subroutine add_card_members(reader, draft, mesh, family, s, c, members)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    type(mesh_type), intent(in) :: mesh
    type(set_family_type), intent(inout) :: family
    integer, intent(in) :: s, c                  !< the set and the card
    type(integer_list_type), intent(inout) :: members
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: i
    call open_card(reader, c, parameters, row)
    if (is_card(reader, c, 'NODE')) then
      do i = draft%node_first(c), draft%node_last(c)
        call add_member(family, s, draft%node_at(i), members)
      end do
    else if (is_card(reader, c, 'ELEMENT')) then
      do i = draft%element_first(c), draft%element_last(c)
        call add_member(family, s, i, members)
      end do
    else if (has_parameter(parameters, 'GENERATE')) then
      call add_ranges(reader, row, family, s, members)
    else if (family%is_node .and. has_parameter(parameters, 'ELSET')) then
      call add_element_nodes(reader, draft, mesh, family, s, c, members)
    else
      call add_rows(reader, row, family, s, members)
    end if
  end subroutine add_card_members


  !> Adds one member unless the set has it already.
  subroutine add_member(family, s, i, members)
    type(set_family_type), intent(inout) :: family
    integer, intent(in) :: s                     !< the set
    integer, intent(in) :: i                     !< the member
    type(integer_list_type), intent(inout) :: members
    family%sets(s)%has_repeats = family%sets(s)%has_repeats .or. family%stamp(i) == s
    if (family%stamp(i) == s) return
    family%stamp(i) = s
    call members%add(i)
  end subroutine add_member


  !> Rows first, last, step. Missing numbers in between are skipped; an empty range is reported.
  subroutine add_ranges(reader, row, family, s, members)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    type(set_family_type), intent(inout) :: family
    integer, intent(in) :: s
    type(integer_list_type), intent(inout) :: members
    integer :: first, last, step, label, found, n_found
    logical :: is_ok
    do while (next_row(reader%cards, row))
      is_ok = .true.
      call check_n_fields(reader, row, 3)
      call read_integer(reader, row, 1, 'first ' // family%noun, first, is_ok)
      call read_integer(reader, row, 2, 'last ' // family%noun, last, is_ok, default=first)
      call read_integer(reader, row, 3, 'step', step, is_ok, default=1)
      if (.not. is_ok) cycle
      if (step < 1 .or. last < first) then
        call report_error(reader, row%line, 'A range needs first <= last and a step of at least 1.')
        cycle
      end if
      n_found = 0
      do label = first, last, step
        found = family%labels%find(label)
        if (found == 0) cycle
        n_found = n_found + 1
        call add_member(family, s, found, members)
      end do
      if (n_found == 0 .and. .not. family%sets(s)%is_of_global_model) call report_note(reader, row%line, 'This range holds no ' &
        // family%noun // ' that exists.')
    end do
  end subroutine add_ranges


  !> The nodes of the elements of a set.
  subroutine add_element_nodes(reader, draft, mesh, family, s, c, members)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    type(mesh_type), intent(in) :: mesh          !< with its element sets
    type(set_family_type), intent(inout) :: family
    integer, intent(in) :: s, c
    type(integer_list_type), intent(inout) :: members
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: set, i, j, e
    call open_card(reader, c, parameters, row)
    set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
    if (set == 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'There is no element set ''' // &
        parameter_text(parameters, 'ELSET') // '''.')
      return
    end if
    do i = 1, size(mesh%element_sets(set)%members)
      e = mesh%element_sets(set)%members(i)
      do j = draft%first(e), draft%first(e + 1) - 1
        if (draft%nodes%items(j) > 0) call add_member(family, s, draft%nodes%items(j), members)
      end do
    end do
  end subroutine add_element_nodes


  !> Rows of numbers and of names of sets already resolved.
  subroutine add_rows(reader, row, family, s, members)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    type(set_family_type), intent(inout) :: family
    integer, intent(in) :: s
    type(integer_list_type), intent(inout) :: members
    integer :: i, j, label, status, found
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        call field_integer(reader%cards, row, i, label, status)
        if (status == NUMBER_OK) then
          found = family%labels%find(label)
          if (found > 0) call add_member(family, s, found, members)
          if (found == 0 .and. .not. family%sets(s)%is_of_global_model) call reader%messages%add(row%line, 'There is no ' // &
            family%noun // ' ' // to_text(label) // '.', is_warning=reader%dialect == DIALECT_CALCULIX)
        else if (status /= NUMBER_EMPTY) then
          found = family%names%find(field_text(reader%cards, row, i))
          if (found == 0 .or. found == s) cycle
          if (family%sets(found)%state /= SET_RESOLVED) cycle
          do j = 1, size(family%sets(found)%members)
            call add_member(family, s, family%sets(found)%members(j), members)
          end do
        end if
      end do
    end do
  end subroutine add_rows

end module amontons_deck_sets
