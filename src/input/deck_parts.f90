!> Flattens parts, instances and assembly into one model.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Works on the text before anything is read. The cards of a part are written once for each of its instances. Numbers are
!! shifted so that instances do not share one. Coordinates are translated, then rotated. The names of sets, surfaces and
!! orientations become INSTANCE.NAME, as the cards of assembly and steps refer to them. Every line keeps the file
!! and the number of its original line, for messages.
module amontons_deck_parts
  use amontons_kinds, only: DP
  use amontons_cards, only: cards_type, data_row_type, parameter_type, deck_messages_type, start_deck_text, append_line, &
    find_cards, read_parameters, start_rows, next_row, field_text, field_integer, field_real, line_text
  use amontons_tensor, only: IDENTITY
  use amontons_text, only: name_key, to_text, is_one_of, parse_integer, parse_real, NUMBER_OK
  use amontons_deck_labels, only: n_nodes_of_type, parameter_value, card_has_parameter
  use amontons_deck_placement, only: placement_type, read_placement, placed_point, is_rotated, format_point, placed_axes, &
    point_row, profile_row, direction_row_number, direction_row
  implicit none
  private
  public :: flatten_parts

  character(*), parameter :: NAME_PARAMETERS = 'NSET|ELSET|SURFACE|ORIENTATION|REFNODE|ROTNODE|NODE|TIENSET|PINNSET|' // &
    'ANALYTICALSURFACE|HOSTELSET'
  !< parameters whose values are names or numbers of a part
  character(*), parameter :: CARDS_WITH_NAME = 'SURFACE|ORIENTATION|DISTRIBUTION'   !< cards whose NAME is one of a part
  character(*), parameter :: UNCHANGED_CARDS = 'SOLIDSECTION|COHESIVESECTION|MEMBRANESECTION|SPRING|MASS|INSTANCE|RIGIDBODY|' // &
    'SYSTEM|USERELEMENT|UELPROPERTY|COUPLING|KINEMATIC|DISTRIBUTING|SURFACEINTERACTION|MATERIAL|ELASTIC|DENSITY|TIE|' // &
    'SHELLTOSOLIDCOUPLING'   !< their data lines have no numbers of a part
  character(*), parameter :: REJECTED_CARDS = 'SHELLGENERALSECTION|GASKETSECTION|SURFACESECTION|' // &
    'CONNECTORSECTION|CONNECTORBEHAVIOR|CONNECTORELASTICITY|DASHPOT|JOINT|' // &
    'ROTARYINERTIA|NONSTRUCTURALMASS|FLUIDCAVITY|REBAR|REBARLAYER'   !< so are those of these

  integer, parameter :: OF_NAME = 0, OF_NODE = 1, OF_ELEMENT = 2   !< what a field names; numbers of names stay

  !> The scope of cards: a part in a certain instance, the assembly, or the model.
  type, extends(placement_type) :: instance_type
    character(:), allocatable :: name            !< of the instance; '' of the assembly and the model
    character(:), allocatable :: part            !< squeezed name of the part
    integer :: first = 0, last = -1              !< cards of the instance itself
    integer :: added(OF_NAME:OF_ELEMENT) = 0     !< to numbers
    integer :: largest(OF_NAME:OF_ELEMENT) = 0   !< number that it has itself; looked at for instances
  end type instance_type

  !> A part: its cards.
  type :: part_type
    character(:), allocatable :: name            !< squeezed
    integer :: first = 0, last = -1              !< cards
    logical :: is_used = .false.
  end type part_type

  !> The state of the flattening.
  type :: flattening_type
    type(cards_type) :: flat                     !< what is written
    type(part_type), allocatable :: parts(:)
    type(instance_type), allocatable :: instances(:)
    type(instance_type) :: assembly                 !< the numbers of its own nodes and elements
    integer, allocatable :: owner(:)             !< (n_cards) 0 model, -1 part, -2 assembly, k > 0 instance k
  end type flattening_type

contains

  !> Flattens the parts of a deck; a deck without parts is unchanged. Only the files have been read at this point; the lines of
  !! messages so far are those of the old text, so reading stops here for a deck with errors.
  subroutine flatten_parts(cards, messages, is_flat)
    type(cards_type), intent(inout) :: cards
    type(deck_messages_type), intent(inout) :: messages
    logical, intent(out) :: is_flat              !< .false.: the deck has parts and errors, and cannot be read further
    type(flattening_type) :: work
    integer :: c
    is_flat = .true.
    do c = 1, cards%n_cards
      if (is_one_of(cards%cards(c)%key, 'PART|ASSEMBLY|INSTANCE')) exit
    end do
    if (c > cards%n_cards) return
    is_flat = .false.
    if (messages%n > 0) return
    call find_scopes(cards, work, messages)
    if (messages%n_errors == 0) call number_scopes(cards, work)
    if (messages%n_errors == 0) call write_flat(cards, work, messages)
    if (messages%n_errors > 0) return             ! the old text stays, for the messages
    call find_cards(work%flat, cards%known_parameters)
    cards = work%flat
    is_flat = .true.
    do c = 1, size(work%instances)
      if (work%instances(c)%added(OF_NODE) > 0) call messages%add(0, 'Of the instance ' // work%instances(c)%name // ' the ' // &
        'numbers of nodes are ' // to_text(work%instances(c)%added(OF_NODE)) // ', those of elements ' // &
        to_text(work%instances(c)%added(OF_ELEMENT)) // ' higher than in its part.', is_warning=.true.)
    end do
  end subroutine flatten_parts


  !> Finds parts and instances, and the scope of every card.
  subroutine find_scopes(cards, work, messages)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(inout) :: work
    type(deck_messages_type), intent(inout) :: messages
    integer :: c, part
    logical :: is_in_assembly, is_in_instance
    allocate (work%parts(0), work%instances(0), work%owner(cards%n_cards))
    part = 0
    is_in_assembly = .false.
    is_in_instance = .false.
    do c = 1, cards%n_cards
      work%owner(c) = merge(-2, 0, is_in_assembly)
      if (part > 0) work%owner(c) = -1
      if (is_in_instance) work%owner(c) = size(work%instances)
      associate (card => cards%cards(c))
        select case (card%key)
        case ('PART')
          if (part > 0) call report_open_part(cards, work, part, c, messages)
          call begin_part(cards, c, work)
          part = size(work%parts)
          work%owner(c) = -1
        case ('ENDPART')
          if (part == 0) call messages%add(card%line, 'There is no *PART before this *END PART.')
          if (part > 0) work%parts(part)%last = c - 1
          part = 0
        case ('ASSEMBLY')
          if (part > 0) call report_open_part(cards, work, part, c, messages)
          part = 0
          is_in_assembly = .true.
          work%owner(c) = -2
        case ('ENDASSEMBLY')
          is_in_assembly = .false.
        case ('INSTANCE')
          if (.not. is_in_assembly) call messages%add(card%line, '*INSTANCE must be between *ASSEMBLY and *END ASSEMBLY.')
          if (is_in_instance) call messages%add(card%line, 'The instance before this one has no *END INSTANCE.')
          call begin_instance(cards, c, work, messages)
          is_in_instance = .true.
          work%owner(c) = size(work%instances)
        case ('ENDINSTANCE')
          if (.not. is_in_instance) call messages%add(card%line, 'There is no *INSTANCE before this *END INSTANCE.')
          if (is_in_instance) work%instances(size(work%instances))%last = c - 1
          is_in_instance = .false.
        case ('STEP')
          if (part > 0) call report_open_part(cards, work, part, c, messages)
          if (is_in_assembly) call messages%add(card%line, 'A step must be after *END ASSEMBLY.')
          if (part > 0 .or. is_in_assembly) return
        end select
      end associate
    end do
    if (part > 0) call report_open_part(cards, work, part, cards%n_cards + 1, messages)
    if (is_in_instance) call messages%add(0, 'The last instance has no *END INSTANCE.')
    if (is_in_assembly) call messages%add(0, 'The assembly has no *END ASSEMBLY.')
  end subroutine find_scopes


  !> Reports a part that is still open at card c, at the line where it begins.
  subroutine report_open_part(cards, work, part, c, messages)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(in) :: work
    integer, intent(in) :: part, c               !< c = n_cards + 1: the end of the deck
    type(deck_messages_type), intent(inout) :: messages
    character(:), allocatable :: place
    place = 'the end of the deck'
    if (c <= cards%n_cards) place = line_text(cards, cards%cards(c)%line)
    call messages%add(cards%cards(work%parts(part)%first - 1)%line, 'This part has no *END PART before ' // place // '; write ' // &
      'it after the last card of the part. A deck without *INSTANCE needs no *PART.')
  end subroutine report_open_part


  !> A new part.
  subroutine begin_part(cards, c, work)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c                     !< its PART card
    type(flattening_type), intent(inout) :: work
    type(part_type) :: part
    part%name = name_key(parameter_value(cards, c, 'NAME'))
    part%first = c + 1
    part%last = cards%n_cards
    work%parts = [work%parts, part]
  end subroutine begin_part


  !> A new instance: its part and its position.
  subroutine begin_instance(cards, c, work, messages)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c                     !< its INSTANCE card
    type(flattening_type), intent(inout) :: work
    type(deck_messages_type), intent(inout) :: messages
    type(instance_type) :: instance
    integer :: i
    instance%name = parameter_value(cards, c, 'NAME')
    instance%part = name_key(parameter_value(cards, c, 'PART'))
    instance%first = c + 1
    instance%last = cards%n_cards
    associate (line => cards%cards(c)%line)
      if (instance%name == '' .or. instance%part == '') call messages%add(line, &
        '*INSTANCE needs NAME=name and PART=name.')
      do i = 1, size(work%instances)
        if (name_key(work%instances(i)%name) == name_key(instance%name)) call messages%add(line, 'The instance ''' // &
          instance%name // ''' is defined twice.')
      end do
      do i = 1, size(work%parts)
        if (work%parts(i)%name /= instance%part) cycle
        work%parts(i)%is_used = .true.
        exit
      end do
      if (i > size(work%parts) .and. instance%part /= '') call messages%add(line, 'There is no part ''' // &
        parameter_value(cards, c, 'PART') // ''' before this instance.')
    end associate
    call read_placement(cards, c, instance, messages)
    work%instances = [work%instances, instance]
  end subroutine begin_instance


  !> Shifts that give every instance, and last the assembly, unique numbers. The first instance keeps those of its part.
  subroutine number_scopes(cards, work)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(inout) :: work
    integer :: i, n_nodes, n_elements, p
    n_nodes = 0
    n_elements = 0
    do i = 1, size(work%instances)
      associate (instance => work%instances(i))
        instance%added(OF_NODE) = n_nodes
        instance%added(OF_ELEMENT) = n_elements
        p = find_part(work, instance)
        instance%largest(OF_NODE) = max(largest_label(cards, 'NODE', work%parts(p)%first, work%parts(p)%last), &
          largest_label(cards, 'NODE', instance%first, instance%last))
        instance%largest(OF_ELEMENT) = max(largest_label(cards, 'ELEMENT', work%parts(p)%first, work%parts(p)%last), &
          largest_label(cards, 'ELEMENT', instance%first, instance%last))
        n_nodes = n_nodes + instance%largest(OF_NODE)
        n_elements = n_elements + instance%largest(OF_ELEMENT)
      end associate
    end do
    work%assembly%name = ''
    work%assembly%added(OF_NODE) = n_nodes
    work%assembly%added(OF_ELEMENT) = n_elements
  end subroutine number_scopes


  !> The part of an instance.
  pure integer function find_part(work, instance) result(p)
    type(flattening_type), intent(in) :: work
    type(instance_type), intent(in) :: instance
    do p = 1, size(work%parts)
      if (work%parts(p)%name == instance%part) return
    end do
  end function find_part


  !> The largest label of the nodes or elements of some cards; rows that continue an element have none.
  integer function largest_label(cards, key, first, last) result(largest)
    type(cards_type), intent(in) :: cards
    character(*), intent(in) :: key
    integer, intent(in) :: first, last           !< cards
    type(data_row_type) :: row
    integer :: c, label, status, n_nodes, n_left
    largest = 0
    do c = first, last
      if (cards%cards(c)%key /= key) cycle
      n_nodes = 0
      if (key == 'ELEMENT') n_nodes = n_nodes_of_type(cards, parameter_value(cards, c, 'TYPE'))
      n_left = 0
      call start_rows(cards%cards(c), row)
      do while (next_row(cards, row))
        if (n_left > 0) then                       ! further nodes of an element
          n_left = n_left - row%n
          cycle
        end if
        if (n_nodes > 0) n_left = n_nodes + 1 - row%n
        call field_integer(cards, row, 1, label, status)
        if (status == NUMBER_OK) largest = max(largest, label)
      end do
    end do
  end function largest_label


  !> Writes all cards: those of the model unchanged except INSTANCE.NUMBER, an instance with the cards of its part.
  subroutine write_flat(cards, work, messages)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(inout) :: work
    type(deck_messages_type), intent(inout) :: messages
    type(instance_type) :: model
    integer :: c, k, line
    call start_deck_text(work%flat)
    work%flat%files = cards%files
    model%name = ''
    do line = 1, merge(cards%cards(1)%line - 1, 0, cards%n_cards > 0)
      call append_line(work%flat, line_text(cards, line), cards%line_file(line), cards%line_number(line))
    end do
    do c = 1, cards%n_cards
      select case (work%owner(c))
      case (0)
        if (is_one_of(cards%cards(c)%key, 'ENDASSEMBLY')) cycle
        call write_card(cards, work, c, model, messages)
      case (-2)
        if (is_one_of(cards%cards(c)%key, 'ASSEMBLY|ENDASSEMBLY')) cycle
        call write_card(cards, work, c, work%assembly, messages)
      case (1:)
        if (cards%cards(c)%key /= 'INSTANCE') cycle
        associate (instance => work%instances(work%owner(c)))
          do k = work%parts(find_part(work, instance))%first, work%parts(find_part(work, instance))%last
            call write_card(cards, work, k, instance, messages)
          end do
          do k = instance%first, instance%last
            call write_card(cards, work, k, instance, messages)
          end do
        end associate
      end select
    end do
    do k = 1, size(work%parts)
      if (work%parts(k)%is_used) cycle
      associate (card => cards%cards(work%parts(k)%first - 1))
        call append_line(work%flat, '** ' // line_text(cards, card%line) // ' has no instance', &
          cards%line_file(card%line), cards%line_number(card%line))
      end associate
    end do
  end subroutine write_flat


  !> One card with its data lines, in terms of the model. NSET and ELSET of the assembly may refer to an instance.
  subroutine write_card(cards, work, c, given, messages)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(inout) :: work
    integer, intent(in) :: c                     !< card
    type(instance_type), intent(in) :: given
    type(deck_messages_type), intent(inout) :: messages
    type(instance_type) :: scope
    character(:), allocatable :: key, head
    integer :: line, i
    key = cards%cards(c)%key
    if (is_one_of(key, 'ENDPART|ENDINSTANCE')) return
    associate (card => cards%cards(c))
      if (work%owner(c) == 0) then
        do line = card%line, card%data_first - 1
          call append_line(work%flat, line_text(cards, line), cards%line_file(line), cards%line_number(line))
        end do
        call write_plain(cards, work, c)
        return
      end if
      head = card_header(cards, work, c, given)
      call append_line(work%flat, head, cards%line_file(card%line), cards%line_number(card%line))
      scope = given
      if (parameter_value(cards, c, 'INSTANCE') /= '') then
        i = find_instance(work, parameter_value(cards, c, 'INSTANCE'))
        if (i == 0) call messages%add(card%line, 'There is no instance ''' // parameter_value(cards, c, 'INSTANCE') // '''.')
        if (i == 0) return
        scope = work%instances(i)
        scope%has_placement = .false.
      end if
      if (scope%name == '' .and. scope%added(OF_NODE) + scope%added(OF_ELEMENT) == 0) then
        call write_plain(cards, work, c)
      else if (is_one_of(key, UNCHANGED_CARDS // '|' // REJECTED_CARDS)) then
        do line = card%data_first, card%data_last
          call append_line(work%flat, line_text(cards, line), cards%line_file(line), cards%line_number(line))
        end do
      else
        call write_rows(cards, work, c, scope, messages)
      end if
    end associate
  end subroutine write_card


  !> The instance of a name; 0: none.
  pure integer function find_instance(work, name) result(i)
    type(flattening_type), intent(in) :: work
    character(*), intent(in) :: name
    do i = 1, size(work%instances)
      if (name_key(work%instances(i)%name) == name_key(name)) return
    end do
    i = 0
  end function find_instance


  !> The keyword line with the names of an instance, without INSTANCE.
  function card_header(cards, work, c, scope) result(head)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(in) :: work
    integer, intent(in) :: c                     !< card
    type(instance_type), intent(in) :: scope
    character(:), allocatable :: head
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: text, key
    integer :: i
    logical :: is_name
    key = cards%cards(c)%key
    text = line_text(cards, cards%cards(c)%line)
    head = text(:index(text // ',', ',') - 1)
    call read_parameters(cards, cards%cards(c), parameters)
    do i = 1, size(parameters)
      if (parameters(i)%key == 'INSTANCE' .and. is_one_of(key, 'NSET|ELSET')) cycle
      head = head // ', ' // parameters(i)%key
      if (.not. parameters(i)%has_value) cycle
      text = parameters(i)%text
      is_name = is_one_of(parameters(i)%key, NAME_PARAMETERS) .or. (parameters(i)%key == 'NAME' .and. is_one_of(key, &
        CARDS_WITH_NAME))
      if (is_name) text = qualified_reference(work, scope, text, OF_NODE)
      if (index(text, ',') > 0) text = '"' // text // '"'
      head = head // '=' // text
    end do
  end function card_header


  !> A name or a number in terms of the model: NAME becomes INSTANCE.NAME, a number is shifted, INSTANCE.NUMBER too.
  function qualified_reference(work, scope, text, what) result(taken)
    type(flattening_type), intent(in) :: work
    type(instance_type), intent(in) :: scope
    character(*), intent(in) :: text
    integer, intent(in) :: what                  !< OF_NAME: numbers stay; OF_NODE, OF_ELEMENT
    character(:), allocatable :: taken
    integer :: status, number, dot, i
    taken = text
    if (text == '') return
    call parse_integer(text, number, status)
    if (status == NUMBER_OK) then
      taken = model_number(scope, number, what)
      return
    end if
    dot = index(text, '.', back=.true.)
    if (dot > 1) then
      i = find_instance(work, text(:dot - 1))
      call parse_integer(text(dot + 1:), number, status)
      if (i > 0 .and. status == NUMBER_OK) taken = model_number(work%instances(i), number, what)
    end if
    if (scope%name /= '') taken = scope%name // '.' // taken
  end function qualified_reference


  !> A number of an instance in the model. One beyond its nodes or elements, which would be that of the next instance, becomes
  !! INSTANCE.NUMBER, which no node or element has: the readers report it as written so.
  function model_number(scope, number, what) result(text)
    type(instance_type), intent(in) :: scope
    integer, intent(in) :: number
    integer, intent(in) :: what                  !< OF_NAME, ...
    character(:), allocatable :: text
    text = to_text(number + scope%added(what))
    if (scope%name == '' .or. what == OF_NAME) return
    if (number < 1 .or. number > scope%largest(what)) text = scope%name // '.' // to_text(number)
  end function model_number


  !> What the first field of a data line of a card names.
  integer function first_reference(cards, c) result(what)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c                     !< card
    character(:), allocatable :: type
    type = name_key(parameter_value(cards, c, 'TYPE'))
    what = merge(OF_ELEMENT, OF_NODE, is_one_of(cards%cards(c)%key, 'DLOAD|ELSET|FOUNDATION|MODELCHANGE|EMBEDDEDELEMENT'))
    if (cards%cards(c)%key == 'SURFACE' .and. type /= 'NODE') what = OF_ELEMENT
    if (cards%cards(c)%key == 'INITIALCONDITIONS' .and. is_one_of(type, 'STRESS|PLASTICSTRAIN|HARDENING|SOLUTION')) &
      what = OF_ELEMENT
  end function first_reference


  !> The data lines of a card of the model: only INSTANCE.NUMBER is replaced by a number.
  subroutine write_plain(cards, work, c)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(inout) :: work
    integer, intent(in) :: c                     !< card
    type(instance_type) :: model
    character(:), allocatable :: text, first
    integer :: line
    model%name = ''
    do line = cards%cards(c)%data_first, cards%cards(c)%data_last
      text = line_text(cards, line)
      first = trim(adjustl(text(:index(text // ',', ',') - 1)))
      if (scan(first, '.') > 1 .and. verify(first(:min(1, len(first))), '0123456789+-.*') == 1) text = &
        qualified_reference(work, model, first, first_reference(cards, c)) // text(index(text // ',', ','):)
      call append_line(work%flat, text, cards%line_file(line), cards%line_number(line))
    end do
  end subroutine write_plain


  !> The data lines of a card of an instance or of the assembly.
  subroutine write_rows(cards, work, c, scope, messages)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(inout) :: work
    integer, intent(in) :: c                     !< card
    type(instance_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(data_row_type) :: row
    character(:), allocatable :: text
    integer :: n_left, n, n_direction
    n_left = 0                                   ! nodes of an element that are still missing
    n = 0
    n_direction = 0                              ! of the row of the first direction of beams
    if (is_one_of(cards%cards(c)%key, 'BEAMSECTION|BEAMGENERALSECTION')) n_direction = direction_row_number(cards, c, &
      name_key(parameter_value(cards, c, 'SECTION')))
    call start_rows(cards%cards(c), row)
    do while (next_row(cards, row))
      n = n + 1
      select case (cards%cards(c)%key)
      case ('NODE')
        if (is_one_of(name_key(parameter_value(cards, c, 'SYSTEM')), 'C|S')) then
          if (n == 1) call messages%add(cards%cards(c)%line, 'SYSTEM of *NODE inside a part or an assembly is not supported; ' // &
            'give Cartesian coordinates.')
          cycle
        end if
        text = node_row(cards, row, scope)
      case ('ELEMENT')
        call element_row(cards, work, row, scope, n_nodes_of_type(cards, parameter_value(cards, c, 'TYPE')), n_left, text)
      case ('NSET', 'ELSET', 'EMBEDDEDELEMENT')
        text = set_row(cards, work, row, scope, card_has_parameter(cards, c, 'GENERATE'), first_reference(cards, c))
      case ('SURFACE')
        if (is_one_of(name_key(parameter_value(cards, c, 'TYPE')), 'SEGMENTS|CYLINDER|REVOLUTION')) then
          if (row%n <= 1 .and. field_text(cards, row, 1) == '') n = n - 1   ! a blank line for the axes
          if (row%n <= 1 .and. field_text(cards, row, 1) == '') cycle
          if (n == 1) call write_axes(cards, work, c, row, scope)
          text = profile_row(cards, row, scope, name_key(parameter_value(cards, c, 'TYPE')) == 'SEGMENTS')
        else
          text = first_row(cards, work, row, scope, first_reference(cards, c), 1)
        end if
      case ('BEAMSECTION', 'BEAMGENERALSECTION')
        text = line_text(cards, row%line)
        if (is_rotated(scope) .and. n == n_direction) text = direction_row(cards, row, scope)
      case ('SHELLSECTION', 'SHELLGENERALSECTION')   ! the fourth field of a layer is an angle or the name of an orientation
        text = first_row(cards, work, row, scope, OF_NAME, merge(4, 0, has_name(cards, row, 4)))
      case ('NODALTHICKNESS', 'FOUNDATION')
        text = first_row(cards, work, row, scope, first_reference(cards, c), 1)
      case ('EQUATION')
        text = first_row(cards, work, row, scope, OF_NODE, merge(0, 3, row%n == 1))
      case ('MPC')
        text = set_row(cards, work, row, scope, .false., OF_NODE)
        if (n == 1) text = field_text(cards, row, 1) // text(index(text // ',', ','):)
      case ('ORIENTATION', 'TRANSFORM')
        text = point_row(cards, row, scope, n == 1, name_key(parameter_value(cards, c, 'SYSTEM') // parameter_value(cards, c, &
          'TYPE')))
        if (has_own_distribution(cards, work, scope, field_text(cards, row, min(n, 2)))) &   ! of axes, of angles
          text = first_row(cards, work, row, scope, OF_NAME, min(n, 2))
      case ('DISTRIBUTION')
        text = distribution_row(cards, work, row, scope, system_of(cards, parameter_value(cards, c, 'NAME')))
      case ('DISTRIBUTIONTABLE', 'HOURGLASSSTIFFNESS', 'TRANSVERSESHEARSTIFFNESS')   ! as it is
        text = line_text(cards, row%line)
      case ('CONTACTPAIR', 'SUBMODEL')
        text = set_row(cards, work, row, scope, .false., merge(OF_NAME, OF_NODE, cards%cards(c)%key == 'CONTACTPAIR'))
      case ('BOUNDARY', 'INITIALCONDITIONS')
        if (is_rotated(scope)) then
          call messages%add(cards%cards(c)%line, 'The card *' // cards%cards(c)%key // ' inside a part whose instance is ' // &
            'rotated is not supported; write it after *END ASSEMBLY, with the names INSTANCE.SET.')
          return
        end if
        text = first_row(cards, work, row, scope, first_reference(cards, c), 1)
      case ('PRE-TENSIONSECTION')
        if (scope%name /= '') then
          call messages%add(cards%cards(c)%line, 'The card *PRE-TENSION SECTION inside a part or an instance is not ' // &
            'supported; write it after *END ASSEMBLY, with the names INSTANCE.SET.')
          return
        end if
        text = first_row(cards, work, row, scope, OF_NODE, 1)
      case default
        call messages%add(cards%cards(c)%line, 'The card *' // cards%cards(c)%key // ' inside a part, an instance or the ' // &
          'assembly is not supported; write it after *END ASSEMBLY, with the names INSTANCE.SET.')
        return
      end select
      call append_line(work%flat, text, cards%line_file(row%line), cards%line_number(row%line))
    end do
    if (n == 0 .or. n /= n_direction - 1 .or. .not. is_rotated(scope)) return
    associate (line => cards%cards(c)%line)
      call append_line(work%flat, direction_row(cards, scope=scope), cards%line_file(line), cards%line_number(line))
    end associate
  end subroutine write_rows


  !> A row of NODE.
  function node_row(cards, row, scope) result(text)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    type(instance_type), intent(in) :: scope
    character(:), allocatable :: text
    real(DP) :: x(3)
    integer :: i, label, status
    call field_integer(cards, row, 1, label, status)
    text = field_text(cards, row, 1)
    if (status == NUMBER_OK) text = to_text(label + scope%added(OF_NODE))
    x = 0
    do i = 2, min(row%n, 4)
      call field_real(cards, row, i, x(i - 1), status)
      if (status /= NUMBER_OK .and. field_text(cards, row, i) /= '') then
        text = text // ', ' // field_text(cards, row, i)   ! the final reader reports it
        return
      end if
    end do
    text = text // format_point(placed_point(scope, x))
  end function node_row


  !> A row of ELEMENT: the first one of an element begins with its number.
  subroutine element_row(cards, work, row, scope, n_nodes, n_left, text)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(in) :: work
    type(data_row_type), intent(in) :: row
    type(instance_type), intent(in) :: scope
    integer, intent(in) :: n_nodes               !< of the type; 0: not known
    integer, intent(inout) :: n_left             !< nodes missing in the element; < 0: as long as rows end with a comma
    character(:), allocatable, intent(out) :: text
    integer :: i, label, status
    logical :: is_first
    text = ''
    is_first = n_left == 0
    if (is_first) n_left = merge(n_nodes, -1, n_nodes > 0)
    do i = 1, row%n
      if (i > 1) text = text // ', '
      call field_integer(cards, row, i, label, status)
      if (status /= NUMBER_OK) then
        text = text // qualified_reference(work, scope, field_text(cards, row, i), OF_NODE)   ! INSTANCE.NUMBER
        if (n_left > 0 .and. field_text(cards, row, i) /= '') n_left = n_left - 1
        cycle
      end if
      if (is_first .and. i == 1) then
        text = text // to_text(label + scope%added(OF_ELEMENT))
      else
        text = text // model_number(scope, label, OF_NODE)
        if (n_left > 0) n_left = n_left - 1
      end if
    end do
    if (row%has_trailing_comma) text = text // ','
    if (n_left < 0 .and. .not. row%has_trailing_comma) n_left = 0
  end subroutine element_row


  !> A row of numbers and names of sets; the increment of a range is unchanged, and numbers beyond its instance are left out.
  function set_row(cards, work, row, scope, is_range, what) result(text)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(in) :: work
    type(data_row_type), intent(in) :: row
    type(instance_type), intent(in) :: scope
    logical, intent(in) :: is_range
    integer, intent(in) :: what                  !< OF_NAME, ...
    character(:), allocatable :: text
    integer :: i, label, status
    text = ''
    do i = 1, row%n
      if (i > 1) text = text // ', '
      call field_integer(cards, row, i, label, status)
      if (is_range .and. i == 2 .and. status == NUMBER_OK .and. scope%name /= '') then
        text = text // model_number(scope, min(label, scope%largest(what)), what)
      else
        text = text // qualified_reference(work, scope, field_text(cards, row, i), merge(OF_NAME, what, is_range .and. i == 3))
      end if
    end do
  end function set_row


  !> A row whose first field, or every field after `every` others, is a name or a number of the part.
  function first_row(cards, work, row, scope, what, every) result(text)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(in) :: work
    type(data_row_type), intent(in) :: row
    type(instance_type), intent(in) :: scope
    integer, intent(in) :: what                  !< OF_NAME, ...
    integer, intent(in) :: every                 !< 0: no field; 1, 2, 4: this one; 3: the first, the fourth, ...
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, row%n
      if (i > 1) text = text // ', '
      if (merge(modulo(i, 3) == 1, every == i, every == 3)) then
        text = text // qualified_reference(work, scope, field_text(cards, row, i), what)
      else
        text = text // field_text(cards, row, i)
      end if
    end do
  end function first_row


  !> Whether a field is a name: neither a number nor empty.
  logical function has_name(cards, row, i)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i                     !< field
    real(DP) :: value
    integer :: status
    call parse_real(field_text(cards, row, i), value, status)
    has_name = status /= NUMBER_OK .and. field_text(cards, row, i) /= ''
  end function has_name


  !> The local axes of an analytic surface that begins with START: those of the part, transformed to the instance.
  subroutine write_axes(cards, work, c, row, scope)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(inout) :: work
    integer, intent(in) :: c                     !< card
    type(data_row_type), intent(in) :: row            !< its first
    type(instance_type), intent(in) :: scope
    character(:), allocatable :: text, type
    type = name_key(parameter_value(cards, c, 'TYPE'))
    if (name_key(field_text(cards, row, 1)) /= 'START' .or. type == 'SEGMENTS') return
    text = format_point(placed_point(scope, [0.0_DP, 0.0_DP, 0.0_DP]))
    text = text(3:) // format_point(placed_point(scope, IDENTITY(:, merge(2, 1, type == 'REVOLUTION'))))
    call append_line(work%flat, text, cards%line_file(row%line), cards%line_number(row%line))
    if (type == 'REVOLUTION') return
    text = format_point(placed_point(scope, [0.0_DP, 0.0_DP, -1.0_DP]))
    call append_line(work%flat, text(3:), cards%line_file(row%line), cards%line_number(row%line))
  end subroutine write_axes


  !> Whether the part or the instance of a scope has a distribution of a name.
  logical function has_own_distribution(cards, work, scope, name) result(is_own)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(in) :: work
    type(instance_type), intent(in) :: scope
    character(*), intent(in) :: name
    integer :: c
    is_own = .false.
    if (scope%name == '' .or. name == '') return
    associate (part => work%parts(find_part(work, scope)))
      do c = 1, cards%n_cards
        if (cards%cards(c)%key /= 'DISTRIBUTION') cycle
        if ((c < part%first .or. c > part%last) .and. (c < scope%first .or. c > scope%last)) cycle
        if (name_key(parameter_value(cards, c, 'NAME')) == name_key(name)) is_own = .true.
      end do
    end associate
  end function has_own_distribution


  !> The SYSTEM of the orientation that names a distribution; '' is RECTANGULAR.
  function system_of(cards, name) result(system)
    type(cards_type), intent(in) :: cards
    character(*), intent(in) :: name
    character(:), allocatable :: system
    type(data_row_type) :: row
    integer :: c
    system = ''
    do c = 1, cards%n_cards
      if (cards%cards(c)%key /= 'ORIENTATION') cycle
      call start_rows(cards%cards(c), row)
      if (.not. next_row(cards, row)) cycle
      if (name_key(field_text(cards, row, 1)) /= name_key(name)) cycle
      system = name_key(parameter_value(cards, c, 'SYSTEM'))
      return
    end do
  end function system_of


  !> A row of DISTRIBUTION: nothing, an element or a set, then two points of axes as ORIENTATION has them, or an angle.
  function distribution_row(cards, work, row, scope, system) result(text)
    type(cards_type), intent(in) :: cards
    type(flattening_type), intent(in) :: work
    type(data_row_type), intent(in) :: row
    type(instance_type), intent(in) :: scope
    character(*), intent(in) :: system           !< begins with C if cylindrical
    character(:), allocatable :: text
    real(DP) :: x(6)
    integer :: i, status
    text = first_row(cards, work, row, scope, OF_ELEMENT, 1)
    if (.not. scope%has_placement .or. row%n <= 2) return
    x = 0
    do i = 2, min(7, row%n)
      call field_real(cards, row, i, x(i - 1), status)
      if (status /= NUMBER_OK) return            ! the reader of the card reports it
    end do
    text = qualified_reference(work, scope, field_text(cards, row, 1), OF_ELEMENT) // placed_axes(scope, system, x)
  end function distribution_row

end module amontons_deck_parts
