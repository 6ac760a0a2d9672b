!> Expands NGEN, NFILL, NCOPY, ELGEN and ELCOPY.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The expansion works on the text, before parts are flattened, card by card in the order of the deck: a card may refer to
!! earlier cards only. Each part has its own scope; assembly and model have theirs.
module amontons_deck_generate
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: cards_type, data_row_type, parameter_type, deck_messages_type, start_deck_text, append_line, &
    find_cards, &
    line_text, read_parameters, start_rows, next_row, field_text, field_integer, field_real
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_deck_labels, only: deck_element_type, label_scope_type, clear_scope, read_mesh_card, find_or_add_set, add_node, &
    add_element, add_members, &
    sort_unique, find_label_index, find_element
  use amontons_tensor, only: cross_product
  use amontons_text, only: to_text, name_key, is_one_of, joined_words, parse_real, NUMBER_OK
  implicit none
  private
  public :: generate_mesh

  character(*), parameter :: GENERATORS = 'NGEN|NFILL|NCOPY|ELGEN|ELCOPY'

contains

  !> Expands the generating cards; a deck without them is unchanged.
  subroutine generate_mesh(cards, messages)
    type(cards_type), intent(inout) :: cards
    type(deck_messages_type), intent(inout) :: messages
    type(cards_type) :: expanded
    type(label_scope_type) :: scope, outer
    integer :: c, line
    do c = 1, cards%n_cards
      if (is_one_of(cards%cards(c)%key, GENERATORS)) exit
    end do
    if (c > cards%n_cards .or. messages%n_errors > 0) return
    call start_deck_text(expanded)
    expanded%files = cards%files
    call clear_scope(scope)
    do line = 1, cards%cards(1)%line - 1
      call copy_line(cards, line, expanded)
    end do
    do c = 1, cards%n_cards
      if (cards%cards(c)%key == 'PART') then
        outer = scope
        call clear_scope(scope)
      else if (cards%cards(c)%key == 'ENDPART') then
        scope = outer
      end if
      if (is_one_of(cards%cards(c)%key, GENERATORS)) then
        call copy_comment(cards, c, expanded)
        call generate(cards, c, scope, messages, expanded)
      else
        do line = cards%cards(c)%line, cards%cards(c)%data_last
          call copy_line(cards, line, expanded)
        end do
        call read_mesh_card(cards, c, scope)
      end if
    end do
    if (messages%n_errors > 0) return             ! the old text stays, for the messages
    call find_cards(expanded, cards%known_parameters)
    cards = expanded
  end subroutine generate_mesh


  !> Copies one line unchanged.
  subroutine copy_line(cards, line, expanded)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: line
    type(cards_type), intent(inout) :: expanded
    call append_line(expanded, line_text(cards, line), cards%line_file(line), cards%line_number(line))
  end subroutine copy_line


  !> The lines of a generating card as comments, so that the deck stored with the results shows the origin of the mesh.
  subroutine copy_comment(cards, c, expanded)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(cards_type), intent(inout) :: expanded
    integer :: line
    do line = cards%cards(c)%line, cards%cards(c)%data_last
      call append_line(expanded, '** ' // line_text(cards, line), cards%line_file(line), cards%line_number(line))
    end do
  end subroutine copy_comment


  !> One generating card.
  subroutine generate(cards, c, scope, messages, expanded)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(label_scope_type), intent(inout) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(cards_type), intent(inout) :: expanded
    type(parameter_type), allocatable :: parameters(:)
    type(label_scope_type) :: generated                     ! its nodes and elements alone
    call read_parameters(cards, cards%cards(c), parameters)
    call check_generator_parameters(cards, c, parameters, messages)
    call clear_scope(generated)
    select case (cards%cards(c)%key)
    case ('NGEN')
      call generate_line(cards, c, parameters, scope, messages, generated)
      call write_nodes(cards, c, parameter_text(parameters, 'NSET'), generated, scope, expanded)
    case ('NFILL')
      call fill_between(cards, c, parameters, scope, messages, generated)
      call write_nodes(cards, c, parameter_text(parameters, 'NSET'), generated, scope, expanded)
    case ('NCOPY')
      call copy_nodes(cards, c, parameters, scope, messages, generated)
      call write_nodes(cards, c, parameter_text(parameters, 'NEWSET'), generated, scope, expanded)
    case ('ELGEN')
      call generate_elements(cards, c, scope, messages, generated)
      call write_elements(cards, c, parameter_text(parameters, 'ELSET'), generated, scope, expanded)
    case ('ELCOPY')
      call copy_elements(cards, c, parameters, scope, messages, generated)
      call write_elements(cards, c, parameter_text(parameters, 'NEWSET'), generated, scope, expanded)
    end select
  end subroutine generate


  !> Reports unknown parameters.
  subroutine check_generator_parameters(cards, c, parameters, messages)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(deck_messages_type), intent(inout) :: messages
    character(:), allocatable :: words
    integer :: i
    select case (cards%cards(c)%key)
    case ('NGEN')
      words = 'NSET|LINE'
    case ('NFILL')
      words = 'NSET|BIAS'
    case ('NCOPY')
      words = 'OLD SET|NEW SET|CHANGE NUMBER|SHIFT|MULTIPLE'
    case ('ELGEN')
      words = 'ELSET'
    case default
      words = 'OLD SET|NEW SET|ELEMENT SHIFT|SHIFT NODES'
    end select
    do i = 1, size(parameters)
      if (is_one_of(parameters(i)%key, words)) cycle
      call messages%add(cards%cards(c)%line, 'The parameter ' // parameters(i)%key // ' of *' // cards%cards(c)%key // &
        ' is not supported; there are ' // joined_words(words) // '.')
    end do
  end subroutine check_generator_parameters


  !> NGEN: nodes at equal distances between two nodes, on a straight line, a circle (LINE=C) or a parabola (LINE=P).
  subroutine generate_line(cards, c, parameters, scope, messages, generated)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(label_scope_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(label_scope_type), intent(inout) :: generated
    type(data_row_type) :: row
    character(:), allocatable :: line
    real(DP) :: ends(3, 3), normal(3)
    integer :: first, last, step, i, n
    logical :: is_ok
    line = name_key(parameter_text(parameters, 'LINE'))
    if (.not. is_one_of(line, 'C|P') .and. line /= '') call messages%add(cards%cards(c)%line, 'LINE must be C (circle) or P ' // &
      '(parabola).')
    call start_rows(cards%cards(c), row)
    do while (next_row(cards, row))
      is_ok = .true.
      call read_number(cards, row, 1, messages, first, is_ok)
      call read_number(cards, row, 2, messages, last, is_ok)
      call read_number(cards, row, 3, messages, step, is_ok, default=1)
      if (is_ok) call read_node_point(scope, row, first, messages, ends(:, 1), is_ok)
      if (is_ok) call read_node_point(scope, row, last, messages, ends(:, 2), is_ok)
      if (is_ok .and. line /= '') call third_point(cards, row, scope, messages, ends(:, 3), normal, is_ok)
      if (.not. is_ok) cycle
      if (step == 0) step = 1
      step = sign(step, last - first)
      n = abs((last - first) / step)
      if (n * abs(step) /= abs(last - first) .or. n < 1) then
        call messages%add(row%line, 'The numbers from ' // to_text(first) // ' to ' // to_text(last) // ' are no multiple of ' // &
          'the step ' // to_text(abs(step)) // '.')
        cycle
      end if
      do i = 1, n - 1
        call add_node(generated, first + i * step, point_on_curve(line, ends, normal, real(i, DP) / real(n, DP)), 0)
      end do
    end do
  end subroutine generate_line


  !> The third point of a curved line, by number or coordinates, and the normal of a circle.
  subroutine third_point(cards, row, scope, messages, x, normal, is_ok)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    type(label_scope_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    real(DP), intent(out) :: x(3), normal(3)     !< normal zero: not given
    logical, intent(inout) :: is_ok
    integer :: label, status, i
    x = 0
    normal = 0
    call field_integer(cards, row, 4, label, status)
    if (status == NUMBER_OK .and. label > 0) then
      call read_node_point(scope, row, label, messages, x, is_ok)
    else
      do i = 1, 3
        call field_real(cards, row, i + 4, x(i), status)
        if (status /= NUMBER_OK) x(i) = 0
      end do
    end if
    do i = 1, 3
      call field_real(cards, row, i + 7, normal(i), status)
      if (status /= NUMBER_OK) normal(i) = 0
    end do
  end subroutine third_point


  !> A point between two others: s from 0 to 1.
  pure function point_on_curve(line, ends, normal, s) result(x)
    character(*), intent(in) :: line             !< '', C or P
    real(DP), intent(in) :: ends(3, 3)           !< first, last, centre or middle
    real(DP), intent(in) :: normal(3)            !< of a circle; zero: by its three points
    real(DP), intent(in) :: s
    real(DP) :: x(3), a(3), b(3), n(3), t(3), angle, radius
    select case (line)
    case ('C')
      a = ends(:, 1) - ends(:, 3)
      b = ends(:, 2) - ends(:, 3)
      n = cross_product(a, b)
      if (norm2(normal) > 0) n = normal
      n = n / max(norm2(n), tiny(1.0_DP))
      radius = max(norm2(a), tiny(1.0_DP))
      t = cross_product(n, a) / radius
      angle = atan2(dot_product(b, t), dot_product(b, a) / radius)
      if (angle <= 0 .and. norm2(normal) > 0) angle = angle + 2 * PI
      x = ends(:, 3) + radius * (cos(s * angle) * a / radius + sin(s * angle) * t)
    case ('P')
      x = (1 - s) * (1 - 2 * s) * ends(:, 1) + s * (2 * s - 1) * ends(:, 2) + 4 * s * (1 - s) * ends(:, 3)
    case default
      x = ends(:, 1) + s * (ends(:, 2) - ends(:, 1))
    end select
  end function point_on_curve


  !> NFILL: rows of nodes between those of two sets, at equal distances or with BIAS, the ratio of neighbours.
  subroutine fill_between(cards, c, parameters, scope, messages, generated)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(label_scope_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(label_scope_type), intent(inout) :: generated
    type(data_row_type) :: row
    real(DP) :: bias, a(3), b(3), s
    integer :: sets(2), n, step, i, k
    logical :: is_ok
    call read_value(cards, c, parameters, 'BIAS', 1.0_DP, messages, bias)
    if (bias <= 0) call messages%add(cards%cards(c)%line, 'BIAS must be positive.')
    if (bias <= 0) return
    call start_rows(cards%cards(c), row)
    do while (next_row(cards, row))
      is_ok = .true.
      do k = 1, 2
        sets(k) = scope%node_names%find(field_text(cards, row, k))
        if (sets(k) == 0) call messages%add(row%line, 'There is no node set ''' // field_text(cards, row, k) // &
          ''' before this card.')
      end do
      call read_number(cards, row, 3, messages, n, is_ok)
      call read_number(cards, row, 4, messages, step, is_ok, default=1)
      if (any(sets == 0) .or. .not. is_ok) cycle
      associate (from => scope%node_sets(sets(1)), to => scope%node_sets(sets(2)))
        if (from%n /= to%n .or. n < 1) then
          call messages%add(row%line, 'The two sets must have the same number of nodes, and there must be at least one interval.')
          cycle
        end if
        do i = 1, from%n
          call read_node_point(scope, row, from%items(i), messages, a, is_ok)
          call read_node_point(scope, row, to%items(i), messages, b, is_ok)
          if (.not. is_ok) exit
          do k = 1, n - 1
            s = real(k, DP) / real(n, DP)
            if (abs(bias - 1) > 0) s = (1 - (1 / bias)**k) / (1 - (1 / bias)**n)
            call add_node(generated, from%items(i) + k * step, a + s * (b - a), 0)
          end do
        end do
      end associate
    end do
  end subroutine fill_between


  !> NCOPY, SHIFT: copies of a set, translated and rotated.
  subroutine copy_nodes(cards, c, parameters, scope, messages, generated)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(label_scope_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(label_scope_type), intent(inout) :: generated
    type(data_row_type) :: row
    real(DP) :: x(3), shift(7), turn(7), number, n_copies
    integer :: set, i, k
    logical :: is_ok
    set = scope%node_names%find(parameter_text(parameters, 'OLDSET'))
    call read_value(cards, c, parameters, 'CHANGENUMBER', 0.0_DP, messages, number)
    call read_value(cards, c, parameters, 'MULTIPLE', 1.0_DP, messages, n_copies)
    if (set == 0) call messages%add(cards%cards(c)%line, 'There is no node set ''' // parameter_text(parameters, 'OLDSET') // &
      ''' before this card.')
    if (nint(number) == 0) call messages%add(cards%cards(c)%line, '*NCOPY needs CHANGE NUMBER, which is not zero.')
    if (.not. has_parameter(parameters, 'SHIFT')) call messages%add(cards%cards(c)%line, '*NCOPY needs SHIFT.')
    if (set == 0 .or. nint(number) == 0 .or. .not. has_parameter(parameters, 'SHIFT')) return
    shift = 0
    turn = 0
    call start_rows(cards%cards(c), row)
    if (next_row(cards, row)) call read_reals(cards, row, shift)
    if (next_row(cards, row)) call read_reals(cards, row, turn)
    is_ok = .true.
    do k = 1, min(nint(n_copies), 1000000)
      do i = 1, scope%node_sets(set)%n
        call read_node_point(scope, row, scope%node_sets(set)%items(i), messages, x, is_ok)
        if (.not. is_ok) return
        x = rotated_point(x + real(k, DP) * shift(:3), turn, real(k, DP))
        call add_node(generated, scope%node_sets(set)%items(i) + k * nint(number), x, 0)
      end do
    end do
  end subroutine copy_nodes


  !> The reals of a row; missing ones keep their value.
  subroutine read_reals(cards, row, values)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    real(DP), intent(inout) :: values(:)
    real(DP) :: value
    integer :: i, status
    do i = 1, min(size(values), row%n)
      call field_real(cards, row, i, value, status)
      if (status == NUMBER_OK) values(i) = value
    end do
  end subroutine read_reals


  !> A point rotated about the axis through two points by a multiple of an angle in degrees.
  pure function rotated_point(x, turn, times) result(y)
    real(DP), intent(in) :: x(3), turn(7), times
    real(DP) :: y(3), axis(3), r(3), angle
    y = x
    axis = turn(4:6) - turn(:3)
    if (.not. norm2(axis) > 0) return
    axis = axis / norm2(axis)
    r = x - turn(:3)
    angle = times * turn(7) * PI / 180
    y = turn(:3) + cos(angle) * r + sin(angle) * cross_product(axis, r) + (1 - cos(angle)) * dot_product(axis, r) * axis
  end function rotated_point


  !> ELGEN: rows, rows of rows and layers of an element, each with its steps of nodes and elements.
  subroutine generate_elements(cards, c, scope, messages, generated)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(label_scope_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(label_scope_type), intent(inout) :: generated
    type(data_row_type) :: row
    type(deck_element_type) :: element
    integer :: n(3), node_step(3), element_step(3), label, i, j, k, m
    logical :: is_ok
    call start_rows(cards%cards(c), row)
    do while (next_row(cards, row))
      is_ok = .true.
      call read_number(cards, row, 1, messages, label, is_ok)
      do k = 1, 3
        call read_number(cards, row, 3 * k - 1, messages, n(k), is_ok, default=1)
        call read_number(cards, row, 3 * k, messages, node_step(k), is_ok, default=1)
        call read_number(cards, row, 3 * k + 1, messages, element_step(k), is_ok, default=1)
      end do
      if (.not. is_ok) cycle
      n = max(1, n)
      call find_element(scope, label, m)
      if (m == 0) call messages%add(row%line, 'There is no element ' // to_text(label) // ' before this card.')
      if (m == 0) cycle
      if (real(n(1), DP) * real(n(2), DP) * real(n(3), DP) > 1.0e7_DP) then
        call messages%add(row%line, 'These are more than ten million elements.')
        cycle
      end if
      do k = 0, n(3) - 1
        do j = 0, n(2) - 1
          do i = 0, n(1) - 1
            if (i + j + k == 0) cycle
            element = scope%elements(m)
            element%label = label + i * element_step(1) + j * element_step(2) + k * element_step(3)
            element%nodes = element%nodes + i * node_step(1) + j * node_step(2) + k * node_step(3)
            call add_element(generated, element, 0)
          end do
        end do
      end do
      call add_element(generated, deck_element_type(label=label, type='', nodes=[integer ::]), 0)   ! the master, for the set alone
    end do
  end subroutine generate_elements


  !> ELCOPY: a copy of a set of elements, with other numbers of elements and nodes.
  subroutine copy_elements(cards, c, parameters, scope, messages, generated)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(label_scope_type), intent(in) :: scope
    type(deck_messages_type), intent(inout) :: messages
    type(label_scope_type), intent(inout) :: generated
    type(deck_element_type) :: element
    real(DP) :: element_shift, node_shift
    integer :: set, i, m
    set = scope%element_names%find(parameter_text(parameters, 'OLDSET'))
    call read_value(cards, c, parameters, 'ELEMENTSHIFT', 0.0_DP, messages, element_shift)
    call read_value(cards, c, parameters, 'SHIFTNODES', 0.0_DP, messages, node_shift)
    if (set == 0) call messages%add(cards%cards(c)%line, 'There is no element set ''' // parameter_text(parameters, 'OLDSET') // &
      ''' before this card.')
    if (nint(element_shift) == 0) call messages%add(cards%cards(c)%line, '*ELCOPY needs ELEMENT SHIFT, which is not zero.')
    if (set == 0 .or. nint(element_shift) == 0) return
    do i = 1, scope%element_sets(set)%n
      call find_element(scope, scope%element_sets(set)%items(i), m)
      if (m == 0) cycle
      element = scope%elements(m)
      element%label = element%label + nint(element_shift)
      element%nodes = element%nodes + nint(node_shift)
      call add_element(generated, element, 0)
    end do
  end subroutine copy_elements


  !> Writes the generated nodes as a NODE card; existing nodes only join the set.
  subroutine write_nodes(cards, c, name, generated, scope, expanded)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    character(*), intent(in) :: name             !< of the set, may be empty
    type(label_scope_type), intent(in) :: generated
    type(label_scope_type), intent(inout) :: scope
    type(cards_type), intent(inout) :: expanded
    type(data_row_type) :: row
    character(100) :: text
    integer :: i, set
    set = find_or_add_set(name, scope%node_names, scope%node_sets)
    call write_line(cards, c, '*NODE', expanded)
    do i = 1, generated%n
      write (text, '(i0,3(", ",es24.17))') generated%label(i), generated%x(:, i)
      call write_line(cards, c, trim(text), expanded)
      call add_node(scope, generated%label(i), generated%x(:, i), set)
    end do
    if (set == 0) return
    if (cards%cards(c)%key /= 'NCOPY') then      ! the ends belong to the set: two nodes, or two sets
      call start_rows(cards%cards(c), row)
      do while (next_row(cards, row))
        row%n = min(row%n, 2)
        call add_members(cards, row, set, scope%node_names, scope%node_sets)
      end do
    end if
    call sort_unique(scope%node_sets(set))        ! Abaqus sorts sets by number
    call write_line(cards, c, '*NSET, NSET="' // name // '"', expanded)
    do i = 1, scope%node_sets(set)%n
      call write_line(cards, c, to_text(scope%node_sets(set)%items(i)), expanded)
    end do
  end subroutine write_nodes


  !> Writes the generated elements as ELEMENT cards, one for each type in sequence, and the set.
  subroutine write_elements(cards, c, name, generated, scope, expanded)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    character(*), intent(in) :: name             !< of the set, may be empty
    type(label_scope_type), intent(in) :: generated
    type(label_scope_type), intent(inout) :: scope
    type(cards_type), intent(inout) :: expanded
    character(:), allocatable :: text, type
    integer :: i, k, set
    set = find_or_add_set(name, scope%element_names, scope%element_sets)
    type = ''
    do i = 1, generated%n_elements
      associate (element => generated%elements(i))
        if (element%type == '') cycle
        if (element%type /= type) call write_line(cards, c, '*ELEMENT, TYPE=' // element%type, expanded)
        type = element%type
        text = to_text(element%label)
        do k = 1, size(element%nodes)
          text = text // ', ' // to_text(element%nodes(k))
        end do
        call write_line(cards, c, text, expanded)
        call add_element(scope, element, 0)
      end associate
    end do
    if (set == 0) return
    do i = 1, generated%n_elements
      call scope%element_sets(set)%add(generated%elements(i)%label)
    end do
    call sort_unique(scope%element_sets(set))     ! the first one may be in it already
    call write_line(cards, c, '*ELSET, ELSET="' // name // '"', expanded)
    do i = 1, scope%element_sets(set)%n
      call write_line(cards, c, to_text(scope%element_sets(set)%items(i)), expanded)
    end do
  end subroutine write_elements


  !> A new line at the position of the card.
  subroutine write_line(cards, c, text, expanded)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    character(*), intent(in) :: text
    type(cards_type), intent(inout) :: expanded
    associate (line => cards%cards(c)%line)
      call append_line(expanded, text, cards%line_file(line), cards%line_number(line))
    end associate
  end subroutine write_line


  !> An integer of a row, or a message.
  subroutine read_number(cards, row, i, messages, number, is_ok, default)
    type(cards_type), intent(in) :: cards
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i                     !< field
    type(deck_messages_type), intent(inout) :: messages
    integer, intent(out) :: number
    logical, intent(inout) :: is_ok
    integer, intent(in), optional :: default
    integer :: status
    call field_integer(cards, row, i, number, status)
    if (status == NUMBER_OK) return
    if (present(default) .and. field_text(cards, row, i) == '') then
      number = default
      return
    end if
    is_ok = .false.
    call messages%add(row%line, 'Field ' // to_text(i) // ' must be an integer; it is ''' // field_text(cards, row, i) // '''.')
  end subroutine read_number


  !> The coordinates of a node defined before this card, or a message.
  subroutine read_node_point(scope, row, label, messages, x, is_ok)
    type(label_scope_type), intent(in) :: scope
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: label
    type(deck_messages_type), intent(inout) :: messages
    real(DP), intent(out) :: x(3)
    logical, intent(inout) :: is_ok
    integer :: i
    x = 0
    i = find_label_index(label, scope%at, scope%label(:scope%n))
    if (i > 0) x = scope%x(:, i)
    if (i > 0) return
    is_ok = .false.
    call messages%add(row%line, 'There is no node ' // to_text(label) // ' before this card.')
  end subroutine read_node_point


  !> A real parameter, or a message.
  subroutine read_value(cards, c, parameters, key, default, messages, value)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: key
    real(DP), intent(in) :: default
    type(deck_messages_type), intent(inout) :: messages
    real(DP), intent(out) :: value
    integer :: status
    value = default
    if (.not. has_parameter(parameters, key)) return
    call parse_real(parameter_text(parameters, key), value, status)
    if (status == NUMBER_OK .and. abs(value) < 1.0e9_DP) return
    value = default
    call messages%add(cards%cards(c)%line, 'The parameter ' // key // ' must be a number.')
  end subroutine read_value

end module amontons_deck_generate
