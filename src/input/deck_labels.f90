!> Nodes, elements and sets by label, before the generators and parts are resolved.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_labels
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: cards_type, data_row_type, parameter_type, read_parameters, start_rows, next_row, field_text, &
    field_integer, field_real
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_containers, only: integer_list_type, name_table_type
  use amontons_text, only: name_key, parse_integer, NUMBER_OK
  use amontons_element_kinds, only: element_kind_type, element_kind, element_kind_by_name
  use amontons_user_elements, only: user_kind_number
  implicit none
  private
  public :: deck_element_type, label_scope_type, clear_scope, read_mesh_card, find_or_add_set, add_node, add_element, &
    add_members, sort_unique, find_label_index, &
    find_element, n_nodes_of_type, to_cartesian, parameter_value, card_has_parameter

  !> One element as written in the deck.
  type :: deck_element_type
    integer :: label = 0
    character(:), allocatable :: type            !< word of TYPE
    integer, allocatable :: nodes(:)             !< labels
  end type deck_element_type

  !> Nodes, elements and sets read so far of a part or of the model.
  type :: label_scope_type
    integer :: n = 0
    integer, allocatable :: label(:)             !< of the nodes
    real(DP), allocatable :: x(:, :)             !< (3, n) [length]
    integer, allocatable :: at(:)                !< (labels) index of a node of a label that is not too large, 0
    integer :: n_elements = 0
    integer, allocatable :: element_of_label(:)        !< the same of an element
    type(deck_element_type), allocatable :: elements(:)
    type(name_table_type) :: node_names, element_names
    type(integer_list_type), allocatable :: node_sets(:), element_sets(:)   !< labels
  end type label_scope_type

contains

  !> Starts an empty scope.
  subroutine clear_scope(scope)
    type(label_scope_type), intent(out) :: scope
    allocate (scope%label(256), scope%x(3, 256), scope%elements(256), scope%node_sets(0), scope%element_sets(0))
    allocate (scope%at(256), scope%element_of_label(256), source=0)
  end subroutine clear_scope


  !> Reads nodes, elements and sets of a card. The final readers report errors later.
  subroutine read_mesh_card(cards, c, scope)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(label_scope_type), intent(inout) :: scope
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: set, n_nodes
    call read_parameters(cards, cards%cards(c), parameters)
    call start_rows(cards%cards(c), row)
    select case (cards%cards(c)%key)
    case ('NODE')
      set = find_or_add_set(parameter_text(parameters, 'NSET'), scope%node_names, scope%node_sets)
      do while (next_row(cards, row))
        call read_node_row(cards, row, name_key(parameter_text(parameters, 'SYSTEM')), set, scope)
      end do
      if (set > 0) call sort_unique(scope%node_sets(set))   ! sets are in the order of the numbers, but for UNSORTED
    case ('ELEMENT')
      set = find_or_add_set(parameter_text(parameters, 'ELSET'), scope%element_names, scope%element_sets)
      n_nodes = n_nodes_of_type(cards, parameter_text(parameters, 'TYPE'))
      if (n_nodes == 0) return
      do while (next_row(cards, row))
        call read_element_rows(cards, row, parameter_text(parameters, 'TYPE'), n_nodes, set, scope)
      end do
    case ('NSET')
      if (has_parameter(parameters, 'ELSET')) return
      set = find_or_add_set(parameter_text(parameters, 'NSET'), scope%node_names, scope%node_sets)
      call read_set_members(cards, row, has_parameter(parameters, 'GENERATE'), set, scope%node_names, scope%node_sets)
      if (set > 0 .and. .not. has_parameter(parameters, 'UNSORTED')) call sort_unique(scope%node_sets(set))
    case ('ELSET')
      set = find_or_add_set(parameter_text(parameters, 'ELSET'), scope%element_names, scope%element_sets)
      call read_set_members(cards, row, has_parameter(parameters, 'GENERATE'), set, scope%element_names, scope%element_sets)
      if (set > 0) call sort_unique(scope%element_sets(set))
    end select
  end subroutine read_mesh_card


  !> The number of nodes of an element type, of a user element by its card; 0: unknown type.
  integer function n_nodes_of_type(cards, type) result(n)
    type(cards_type), intent(in) :: cards
    character(*), intent(in) :: type
    type(parameter_type), allocatable :: parameters(:)
    type(element_kind_type) :: entry
    character(:), allocatable :: name
    integer :: i, kind, c, status
    n = 0
    name = name_key(type)
    if (user_kind_number(name) > 0) then
      do c = 1, cards%n_cards
        if (cards%cards(c)%key /= 'USERELEMENT') cycle
        call read_parameters(cards, cards%cards(c), parameters)
        if (name_key(parameter_text(parameters, 'TYPE')) == name) call parse_integer(parameter_text(parameters, 'NODES'), n, status)
      end do
      return
    end if
    do i = 0, 2                                  ! without up to two letters at the end: H, M, ...
      if (len(name) - i < 1) return
      kind = element_kind_by_name(name(:len(name) - i))
      if (kind == 0) cycle
      entry = element_kind(kind)
      n = entry%n_nodes
      return
    end do
  end function n_nodes_of_type


  !> The set of a name, created if new; 0 for an empty name.
  integer function find_or_add_set(name, names, sets)
    character(*), intent(in) :: name
    type(name_table_type), intent(inout) :: names
    type(integer_list_type), allocatable, intent(inout) :: sets(:)
    logical :: is_new
    find_or_add_set = 0
    if (name == '') return
    call names%add(name, find_or_add_set, is_new)
    if (is_new) sets = [sets, integer_list_type()]
  end function find_or_add_set


  !> A row of NODE.
  subroutine read_node_row(cards, row, system, set, scope)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: system           !< '', R, C or S
    integer, intent(in) :: set
    type(label_scope_type), intent(inout) :: scope
    real(DP) :: x(3)
    integer :: label, status, i
    call field_integer(cards, row, 1, label, status)
    if (status /= NUMBER_OK) return
    x = 0
    do i = 1, 3
      call field_real(cards, row, i + 1, x(i), status)
      if (status /= NUMBER_OK) x(i) = 0
    end do
    call add_node(scope, label, to_cartesian(system, x), set)
  end subroutine read_node_row


  !> Coordinates of NODE, SYSTEM=: cylindrical (radius, angle, z) and spherical ones (radius, angle about z, angle above the
  !! xy plane).
  pure function to_cartesian(system, x) result(place)
    character(*), intent(in) :: system           !< C, S, or Cartesian already
    real(DP), intent(in) :: x(3)                 !< [length], angles in degrees
    real(DP) :: place(3), turn(2)
    place = x
    turn = x(2:) * PI / 180
    if (system == 'C') place(:2) = x(1) * [cos(turn(1)), sin(turn(1))]
    if (system == 'S') place = x(1) * [cos(turn(1)) * cos(turn(2)), sin(turn(1)) * cos(turn(2)), sin(turn(2))]
  end function to_cartesian


  !> Adds a node.
  subroutine add_node(scope, label, x, set)
    type(label_scope_type), intent(inout) :: scope
    integer, intent(in) :: label
    real(DP), intent(in) :: x(3)                   !< [length]
    integer, intent(in) :: set
    integer, allocatable :: labels(:)
    real(DP), allocatable :: places(:, :)
    if (scope%n == size(scope%label)) then
      allocate (labels(2 * scope%n), places(3, 2 * scope%n))
      labels(:scope%n) = scope%label
      places(:, :scope%n) = scope%x
      call move_alloc(labels, scope%label)
      call move_alloc(places, scope%x)
    end if
    scope%n = scope%n + 1
    scope%label(scope%n) = label
    scope%x(:, scope%n) = x
    call store_label_index(label, scope%n, scope%at)
    if (set > 0) call scope%node_sets(set)%add(label)
  end subroutine add_node


  !> Stores the index of a label, if the label is not too large.
  subroutine store_label_index(label, i, at)
    integer, intent(in) :: label, i
    integer, allocatable, intent(inout) :: at(:)
    integer, parameter :: MAX_DIRECT_LABEL = 20000000
    integer, allocatable :: longer(:)
    if (label < 1 .or. label > MAX_DIRECT_LABEL) return
    if (label > size(at)) then
      allocate (longer(max(label, 2 * size(at))), source=0)
      longer(:size(at)) = at
      call move_alloc(longer, at)
    end if
    at(label) = i
  end subroutine store_label_index


  !> The index of a label; 0: unknown label.
  pure integer function find_label_index(label, at, labels)
    integer, intent(in) :: label
    integer, intent(in) :: at(:)
    integer, intent(in) :: labels(:)             !< all, for those that are too large
    find_label_index = 0
    if (label < 1) return
    if (label <= size(at)) find_label_index = at(label)
    if (find_label_index == 0 .and. label > size(at)) find_label_index = findloc(labels, label, dim=1, back=.true.)
  end function find_label_index


  !> The rows of one element.
  subroutine read_element_rows(cards, row, type, n_nodes, set, scope)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(inout) :: row
    character(*), intent(in) :: type
    integer, intent(in) :: n_nodes, set
    type(label_scope_type), intent(inout) :: scope
    type(deck_element_type) :: element
    integer :: i, first, number, status
    call field_integer(cards, row, 1, element%label, status)
    if (status /= NUMBER_OK) return
    element%type = type
    allocate (element%nodes(0))
    first = 2
    do
      do i = first, row%n
        call field_integer(cards, row, i, number, status)
        if (status == NUMBER_OK) element%nodes = [element%nodes, number]
      end do
      if (size(element%nodes) >= n_nodes) exit
      if (.not. next_row(cards, row)) exit
      first = 1
    end do
    call add_element(scope, element, set)
  end subroutine read_element_rows


  !> Adds an element.
  subroutine add_element(scope, element, set)
    type(label_scope_type), intent(inout) :: scope
    type(deck_element_type), intent(in) :: element
    integer, intent(in) :: set
    type(deck_element_type), allocatable :: elements(:)
    if (scope%n_elements == size(scope%elements)) then
      allocate (elements(2 * scope%n_elements))
      elements(:scope%n_elements) = scope%elements
      call move_alloc(elements, scope%elements)
    end if
    scope%n_elements = scope%n_elements + 1
    scope%elements(scope%n_elements) = element
    call store_label_index(element%label, scope%n_elements, scope%element_of_label)
    if (set > 0) call scope%element_sets(set)%add(element%label)
  end subroutine add_element


  !> The members of a set: labels, names of sets, ranges.
  subroutine read_set_members(cards, row, is_range, set, names, sets)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(inout) :: row
    logical, intent(in) :: is_range
    integer, intent(in) :: set
    type(name_table_type), intent(in) :: names
    type(integer_list_type), intent(inout) :: sets(:)
    integer :: numbers(3), i, k, status
    logical :: is_valid
    if (set == 0) return
    do while (next_row(cards, row))
      if (is_range) then
        numbers = [0, -1, 1]
        is_valid = row%n > 0
        do i = 1, min(3, row%n)
          call field_integer(cards, row, i, numbers(i), status)
          is_valid = is_valid .and. status == NUMBER_OK
        end do
        if (.not. is_valid .or. numbers(3) < 1 .or. (numbers(2) - numbers(1)) / max(1, numbers(3)) > 10000000) cycle
        do k = numbers(1), numbers(2), numbers(3)
          call sets(set)%add(k)
        end do
        cycle
      end if
      call add_members(cards, row, set, names, sets)
    end do
  end subroutine read_set_members


  !> The members of a set in one row.
  subroutine add_members(cards, row, set, names, sets)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: set
    type(name_table_type), intent(in) :: names
    type(integer_list_type), intent(inout) :: sets(:)
    integer :: i, k, status, other
    do i = 1, row%n
      call field_integer(cards, row, i, k, status)
      if (status == NUMBER_OK) call sets(set)%add(k)
      if (status == NUMBER_OK) cycle
      other = names%find(field_text(cards, row, i))
      if (other == 0 .or. other == set) cycle
      do k = 1, sets(other)%n
        call sets(set)%add(sets(other)%items(k))
      end do
    end do
  end subroutine add_members


  !> The last element of a label; 0: none.
  pure subroutine find_element(scope, label, m)
    type(label_scope_type), intent(in) :: scope
    integer, intent(in) :: label
    integer, intent(out) :: m
    m = find_label_index(label, scope%element_of_label, scope%elements(:scope%n_elements)%label)
  end subroutine find_element


  !> Sorts a list and removes duplicates.
  subroutine sort_unique(list)
    type(integer_list_type), intent(inout) :: list
    integer, allocatable :: items(:)
    logical, allocatable :: is_there(:)
    integer :: i, low
    if (list%n == 0) return
    items = list%items(:list%n)
    low = minval(items)
    if (maxval(items) - low > 100000000) return
    allocate (is_there(low:maxval(items)), source=.false.)
    is_there(items) = .true.
    list%n = 0
    do i = lbound(is_there, 1), ubound(is_there, 1)
      if (is_there(i)) call list%add(i)
    end do
  end subroutine sort_unique


  !> The value of a parameter as written.
  function parameter_value(cards, c, name) result(text)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c                     !< card
    character(*), intent(in) :: name
    character(:), allocatable :: text
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    text = ''
    call read_parameters(cards, cards%cards(c), parameters)
    do i = 1, size(parameters)
      if (parameters(i)%key == name) text = parameters(i)%text
    end do
  end function parameter_value


  !> Whether a card has a parameter.
  logical function card_has_parameter(cards, c, name) result(is_given)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    character(*), intent(in) :: name
    type(parameter_type), allocatable :: parameters(:)
    call read_parameters(cards, cards%cards(c), parameters)
    is_given = has_parameter(parameters, name)
  end function card_has_parameter

end module amontons_deck_labels
