!> Deck generate: the cards NGEN, NFILL, NCOPY, ELGEN and ELCOPY written out as the nodes and elements that they stand for.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! It is done on the text, before parts are written flat, card by card in the order of the deck: what a card speaks of must
!! stand before it. A part starts from nothing; the assembly and the model know their own nodes.
module amontons_deck_generate
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: cards_type, row_type, parameter_type, remarks_type, start_text, append_line, find_cards, &
    line_text, read_parameters, start_rows, next_row, field_text, field_integer, field_real
  use amontons_deck_labels, only: element_type, scope_type, clear, take_card, set_of, add_node, add_element, add_members, &
    sort_items, index_of, find_element, has, value_of
  use amontons_tensor, only: cross_product
  use amontons_text, only: text_of, squeezed, is_one_of, joined_words, parse_real, NUMBER_OK
  implicit none
  private
  public :: generate_mesh

  character(*), parameter :: GENERATORS = 'NGEN|NFILL|NCOPY|ELGEN|ELCOPY'

contains

  !> Writes the generating cards out; a deck without them stays as it is.
  subroutine generate_mesh(cards, remarks)
    type(cards_type), intent(inout) :: cards
    type(remarks_type), intent(inout) :: remarks
    type(cards_type) :: flat
    type(scope_type) :: scope, outer
    integer :: c, line
    do c = 1, cards%n_cards
      if (is_one_of(cards%cards(c)%key, GENERATORS)) exit
    end do
    if (c > cards%n_cards .or. remarks%n_errors > 0) return
    call start_text(flat)
    flat%files = cards%files
    call clear(scope)
    do line = 1, cards%cards(1)%line - 1
      call copy_line(cards, line, flat)
    end do
    do c = 1, cards%n_cards
      if (cards%cards(c)%key == 'PART') then
        outer = scope
        call clear(scope)
      else if (cards%cards(c)%key == 'ENDPART') then
        scope = outer
      end if
      if (is_one_of(cards%cards(c)%key, GENERATORS)) then
        call copy_comment(cards, c, flat)
        call generate(cards, c, scope, remarks, flat)
      else
        do line = cards%cards(c)%line, cards%cards(c)%data_last
          call copy_line(cards, line, flat)
        end do
        call take_card(cards, c, scope)
      end if
    end do
    if (remarks%n_errors > 0) return             ! the old text stays, for the messages
    call find_cards(flat)
    cards = flat
  end subroutine generate_mesh


  !> One line as it is.
  subroutine copy_line(cards, line, flat)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: line
    type(cards_type), intent(inout) :: flat
    call append_line(flat, line_text(cards, line), cards%line_file(line), cards%line_number(line))
  end subroutine copy_line


  !> The lines of a generating card as comments, so that the deck kept with the results tells where the mesh is from.
  subroutine copy_comment(cards, c, flat)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(cards_type), intent(inout) :: flat
    integer :: line
    do line = cards%cards(c)%line, cards%cards(c)%data_last
      call append_line(flat, '** ' // line_text(cards, line), cards%line_file(line), cards%line_number(line))
    end do
  end subroutine copy_comment


  !> One generating card.
  subroutine generate(cards, c, scope, remarks, flat)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(scope_type), intent(inout) :: scope
    type(remarks_type), intent(inout) :: remarks
    type(cards_type), intent(inout) :: flat
    type(parameter_type), allocatable :: parameters(:)
    type(scope_type) :: made                     ! its nodes and elements alone
    call read_parameters(cards, cards%cards(c), parameters)
    call check_words(cards, c, parameters, remarks)
    call clear(made)
    select case (cards%cards(c)%key)
    case ('NGEN')
      call generate_line(cards, c, parameters, scope, remarks, made)
      call write_nodes(cards, c, value_of(parameters, 'NSET'), made, scope, flat)
    case ('NFILL')
      call fill_between(cards, c, parameters, scope, remarks, made)
      call write_nodes(cards, c, value_of(parameters, 'NSET'), made, scope, flat)
    case ('NCOPY')
      call copy_nodes(cards, c, parameters, scope, remarks, made)
      call write_nodes(cards, c, value_of(parameters, 'NEWSET'), made, scope, flat)
    case ('ELGEN')
      call generate_elements(cards, c, scope, remarks, made)
      call write_elements(cards, c, value_of(parameters, 'ELSET'), made, scope, flat)
    case ('ELCOPY')
      call copy_elements(cards, c, parameters, scope, remarks, made)
      call write_elements(cards, c, value_of(parameters, 'NEWSET'), made, scope, flat)
    end select
  end subroutine generate


  !> Tells parameters that the card does not have.
  subroutine check_words(cards, c, parameters, remarks)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(remarks_type), intent(inout) :: remarks
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
      call remarks%add(cards%cards(c)%line, 'The parameter ' // parameters(i)%key // ' of *' // cards%cards(c)%key // &
        ' is not supported; there are ' // joined_words(words) // '.')
    end do
  end subroutine check_words


  !> NGEN: nodes at equal distances between two nodes, on a straight line, a circle (LINE=C) or a parabola (LINE=P).
  subroutine generate_line(cards, c, parameters, scope, remarks, made)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(scope_type), intent(in) :: scope
    type(remarks_type), intent(inout) :: remarks
    type(scope_type), intent(inout) :: made
    type(row_type) :: row
    character(:), allocatable :: line
    real(DP) :: ends(3, 3), normal(3)
    integer :: first, last, step, i, n
    logical :: is_ok
    line = squeezed(value_of(parameters, 'LINE'))
    if (.not. is_one_of(line, 'C|P') .and. line /= '') call remarks%add(cards%cards(c)%line, 'LINE must be C (circle) or P ' // &
      '(parabola).')
    call start_rows(cards%cards(c), row)
    do while (next_row(cards, row))
      is_ok = .true.
      call need_number(cards, row, 1, remarks, first, is_ok)
      call need_number(cards, row, 2, remarks, last, is_ok)
      call need_number(cards, row, 3, remarks, step, is_ok, default=1)
      if (is_ok) call need_node(scope, row, first, remarks, ends(:, 1), is_ok)
      if (is_ok) call need_node(scope, row, last, remarks, ends(:, 2), is_ok)
      if (is_ok .and. line /= '') call third_point(cards, row, scope, remarks, ends(:, 3), normal, is_ok)
      if (.not. is_ok) cycle
      if (step == 0) step = 1
      step = sign(step, last - first)
      n = abs((last - first) / step)
      if (n * abs(step) /= abs(last - first) .or. n < 1) then
        call remarks%add(row%line, 'The numbers from ' // text_of(first) // ' to ' // text_of(last) // ' are no multiple of ' // &
          'the step ' // text_of(abs(step)) // '.')
        cycle
      end if
      do i = 1, n - 1
        call add_node(made, first + i * step, point_on(line, ends, normal, real(i, DP) / real(n, DP)), 0)
      end do
    end do
  end subroutine generate_line


  !> The third point of a curved line, by number or coordinates, and the normal of a circle.
  subroutine third_point(cards, row, scope, remarks, x, normal, is_ok)
    type(cards_type), intent(in) :: cards
    type(row_type), intent(in) :: row
    type(scope_type), intent(in) :: scope
    type(remarks_type), intent(inout) :: remarks
    real(DP), intent(out) :: x(3), normal(3)     !< normal zero: not given
    logical, intent(inout) :: is_ok
    integer :: label, status, i
    x = 0
    normal = 0
    call field_integer(cards, row, 4, label, status)
    if (status == NUMBER_OK .and. label > 0) then
      call need_node(scope, row, label, remarks, x, is_ok)
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
  pure function point_on(line, ends, normal, s) result(x)
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
  end function point_on


  !> NFILL: rows of nodes between those of two sets, at equal distances or with BIAS, the ratio of neighbours.
  subroutine fill_between(cards, c, parameters, scope, remarks, made)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(scope_type), intent(in) :: scope
    type(remarks_type), intent(inout) :: remarks
    type(scope_type), intent(inout) :: made
    type(row_type) :: row
    real(DP) :: bias, a(3), b(3), s
    integer :: sets(2), n, step, i, k
    logical :: is_ok
    call need_value(cards, c, parameters, 'BIAS', 1.0_DP, remarks, bias)
    if (bias <= 0) call remarks%add(cards%cards(c)%line, 'BIAS must be positive.')
    if (bias <= 0) return
    call start_rows(cards%cards(c), row)
    do while (next_row(cards, row))
      is_ok = .true.
      do k = 1, 2
        sets(k) = scope%node_names%find(field_text(cards, row, k))
        if (sets(k) == 0) call remarks%add(row%line, 'There is no node set ''' // field_text(cards, row, k) // &
          ''' before this card.')
      end do
      call need_number(cards, row, 3, remarks, n, is_ok)
      call need_number(cards, row, 4, remarks, step, is_ok, default=1)
      if (any(sets == 0) .or. .not. is_ok) cycle
      associate (from => scope%node_sets(sets(1)), to => scope%node_sets(sets(2)))
        if (from%n /= to%n .or. n < 1) then
          call remarks%add(row%line, 'The two sets must have the same number of nodes, and there must be at least one interval.')
          cycle
        end if
        do i = 1, from%n
          call need_node(scope, row, from%items(i), remarks, a, is_ok)
          call need_node(scope, row, to%items(i), remarks, b, is_ok)
          if (.not. is_ok) exit
          do k = 1, n - 1
            s = real(k, DP) / real(n, DP)
            if (abs(bias - 1) > 0) s = (1 - (1 / bias)**k) / (1 - (1 / bias)**n)
            call add_node(made, from%items(i) + k * step, a + s * (b - a), 0)
          end do
        end do
      end associate
    end do
  end subroutine fill_between


  !> NCOPY, SHIFT: copies of a set, moved and turned.
  subroutine copy_nodes(cards, c, parameters, scope, remarks, made)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(scope_type), intent(in) :: scope
    type(remarks_type), intent(inout) :: remarks
    type(scope_type), intent(inout) :: made
    type(row_type) :: row
    real(DP) :: x(3), shift(7), turn(7), number, n_copies
    integer :: set, i, k
    logical :: is_ok
    set = scope%node_names%find(value_of(parameters, 'OLDSET'))
    call need_value(cards, c, parameters, 'CHANGENUMBER', 0.0_DP, remarks, number)
    call need_value(cards, c, parameters, 'MULTIPLE', 1.0_DP, remarks, n_copies)
    if (set == 0) call remarks%add(cards%cards(c)%line, 'There is no node set ''' // value_of(parameters, 'OLDSET') // &
      ''' before this card.')
    if (nint(number) == 0) call remarks%add(cards%cards(c)%line, '*NCOPY needs CHANGE NUMBER, which is not zero.')
    if (.not. has(parameters, 'SHIFT')) call remarks%add(cards%cards(c)%line, '*NCOPY needs SHIFT.')
    if (set == 0 .or. nint(number) == 0 .or. .not. has(parameters, 'SHIFT')) return
    shift = 0
    turn = 0
    call start_rows(cards%cards(c), row)
    if (next_row(cards, row)) call take_reals(cards, row, shift)
    if (next_row(cards, row)) call take_reals(cards, row, turn)
    is_ok = .true.
    do k = 1, min(nint(n_copies), 1000000)
      do i = 1, scope%node_sets(set)%n
        call need_node(scope, row, scope%node_sets(set)%items(i), remarks, x, is_ok)
        if (.not. is_ok) return
        x = turned(x + real(k, DP) * shift(:3), turn, real(k, DP))
        call add_node(made, scope%node_sets(set)%items(i) + k * nint(number), x, 0)
      end do
    end do
  end subroutine copy_nodes


  !> The reals of a row; those that are missing stay.
  subroutine take_reals(cards, row, values)
    type(cards_type), intent(in) :: cards
    type(row_type), intent(in) :: row
    real(DP), intent(inout) :: values(:)
    real(DP) :: value
    integer :: i, status
    do i = 1, min(size(values), row%n)
      call field_real(cards, row, i, value, status)
      if (status == NUMBER_OK) values(i) = value
    end do
  end subroutine take_reals


  !> A point turned about the axis through two points by an angle in degrees, some times.
  pure function turned(x, turn, times) result(y)
    real(DP), intent(in) :: x(3), turn(7), times
    real(DP) :: y(3), axis(3), r(3), angle
    y = x
    axis = turn(4:6) - turn(:3)
    if (.not. norm2(axis) > 0) return
    axis = axis / norm2(axis)
    r = x - turn(:3)
    angle = times * turn(7) * PI / 180
    y = turn(:3) + cos(angle) * r + sin(angle) * cross_product(axis, r) + (1 - cos(angle)) * dot_product(axis, r) * axis
  end function turned


  !> ELGEN: rows, rows of rows and layers of an element, each with its steps of nodes and elements.
  subroutine generate_elements(cards, c, scope, remarks, made)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(scope_type), intent(in) :: scope
    type(remarks_type), intent(inout) :: remarks
    type(scope_type), intent(inout) :: made
    type(row_type) :: row
    type(element_type) :: element
    integer :: n(3), node_step(3), element_step(3), label, i, j, k, m
    logical :: is_ok
    call start_rows(cards%cards(c), row)
    do while (next_row(cards, row))
      is_ok = .true.
      call need_number(cards, row, 1, remarks, label, is_ok)
      do k = 1, 3
        call need_number(cards, row, 3 * k - 1, remarks, n(k), is_ok, default=1)
        call need_number(cards, row, 3 * k, remarks, node_step(k), is_ok, default=1)
        call need_number(cards, row, 3 * k + 1, remarks, element_step(k), is_ok, default=1)
      end do
      if (.not. is_ok) cycle
      n = max(1, n)
      call find_element(scope, label, m)
      if (m == 0) call remarks%add(row%line, 'There is no element ' // text_of(label) // ' before this card.')
      if (m == 0) cycle
      if (real(n(1), DP) * real(n(2), DP) * real(n(3), DP) > 1.0e7_DP) then
        call remarks%add(row%line, 'These are more than ten million elements.')
        cycle
      end if
      do k = 0, n(3) - 1
        do j = 0, n(2) - 1
          do i = 0, n(1) - 1
            if (i + j + k == 0) cycle
            element = scope%elements(m)
            element%label = label + i * element_step(1) + j * element_step(2) + k * element_step(3)
            element%nodes = element%nodes + i * node_step(1) + j * node_step(2) + k * node_step(3)
            call add_element(made, element, 0)
          end do
        end do
      end do
      call add_element(made, element_type(label=label, type='', nodes=[integer ::]), 0)   ! the master, for the set alone
    end do
  end subroutine generate_elements


  !> ELCOPY: a copy of a set of elements, with other numbers of elements and nodes.
  subroutine copy_elements(cards, c, parameters, scope, remarks, made)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(scope_type), intent(in) :: scope
    type(remarks_type), intent(inout) :: remarks
    type(scope_type), intent(inout) :: made
    type(element_type) :: element
    real(DP) :: element_shift, node_shift
    integer :: set, i, m
    set = scope%element_names%find(value_of(parameters, 'OLDSET'))
    call need_value(cards, c, parameters, 'ELEMENTSHIFT', 0.0_DP, remarks, element_shift)
    call need_value(cards, c, parameters, 'SHIFTNODES', 0.0_DP, remarks, node_shift)
    if (set == 0) call remarks%add(cards%cards(c)%line, 'There is no element set ''' // value_of(parameters, 'OLDSET') // &
      ''' before this card.')
    if (nint(element_shift) == 0) call remarks%add(cards%cards(c)%line, '*ELCOPY needs ELEMENT SHIFT, which is not zero.')
    if (set == 0 .or. nint(element_shift) == 0) return
    do i = 1, scope%element_sets(set)%n
      call find_element(scope, scope%element_sets(set)%items(i), m)
      if (m == 0) cycle
      element = scope%elements(m)
      element%label = element%label + nint(element_shift)
      element%nodes = element%nodes + nint(node_shift)
      call add_element(made, element, 0)
    end do
  end subroutine copy_elements


  !> Writes what was made as a NODE card; nodes that are there already only join the set.
  subroutine write_nodes(cards, c, name, made, scope, flat)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    character(*), intent(in) :: name             !< of the set, may be empty
    type(scope_type), intent(in) :: made
    type(scope_type), intent(inout) :: scope
    type(cards_type), intent(inout) :: flat
    type(row_type) :: row
    character(100) :: text
    integer :: i, set
    set = set_of(name, scope%node_names, scope%node_sets)
    call write_line(cards, c, '*NODE', flat)
    do i = 1, made%n
      write (text, '(i0,3(", ",es24.17))') made%label(i), made%x(:, i)
      call write_line(cards, c, trim(text), flat)
      call add_node(scope, made%label(i), made%x(:, i), set)
    end do
    if (set == 0) return
    if (cards%cards(c)%key /= 'NCOPY') then      ! the ends belong to the set: two nodes, or two sets
      call start_rows(cards%cards(c), row)
      do while (next_row(cards, row))
        row%n = min(row%n, 2)
        call add_members(cards, row, set, scope%node_names, scope%node_sets)
      end do
    end if
    call sort_items(scope%node_sets(set))        ! Abaqus keeps sets in the order of the numbers
    call write_line(cards, c, '*NSET, NSET="' // name // '"', flat)
    do i = 1, scope%node_sets(set)%n
      call write_line(cards, c, text_of(scope%node_sets(set)%items(i)), flat)
    end do
  end subroutine write_nodes


  !> Writes what was made as ELEMENT cards, one for each type in a row, and the set.
  subroutine write_elements(cards, c, name, made, scope, flat)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    character(*), intent(in) :: name             !< of the set, may be empty
    type(scope_type), intent(in) :: made
    type(scope_type), intent(inout) :: scope
    type(cards_type), intent(inout) :: flat
    character(:), allocatable :: text, type
    integer :: i, k, set
    set = set_of(name, scope%element_names, scope%element_sets)
    type = ''
    do i = 1, made%n_elements
      associate (element => made%elements(i))
        if (element%type == '') cycle
        if (element%type /= type) call write_line(cards, c, '*ELEMENT, TYPE=' // element%type, flat)
        type = element%type
        text = text_of(element%label)
        do k = 1, size(element%nodes)
          text = text // ', ' // text_of(element%nodes(k))
        end do
        call write_line(cards, c, text, flat)
        call add_element(scope, element, 0)
      end associate
    end do
    if (set == 0) return
    do i = 1, made%n_elements
      call scope%element_sets(set)%add(made%elements(i)%label)
    end do
    call sort_items(scope%element_sets(set))     ! the first one may be in it already
    call write_line(cards, c, '*ELSET, ELSET="' // name // '"', flat)
    do i = 1, scope%element_sets(set)%n
      call write_line(cards, c, text_of(scope%element_sets(set)%items(i)), flat)
    end do
  end subroutine write_elements


  !> A new line, which stands where the card stands.
  subroutine write_line(cards, c, text, flat)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    character(*), intent(in) :: text
    type(cards_type), intent(inout) :: flat
    associate (line => cards%cards(c)%line)
      call append_line(flat, text, cards%line_file(line), cards%line_number(line))
    end associate
  end subroutine write_line


  !> An integer of a row, or a remark.
  subroutine need_number(cards, row, i, remarks, number, is_ok, default)
    type(cards_type), intent(in) :: cards
    type(row_type), intent(in) :: row
    integer, intent(in) :: i                     !< field
    type(remarks_type), intent(inout) :: remarks
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
    call remarks%add(row%line, 'Field ' // text_of(i) // ' must be an integer; it is ''' // field_text(cards, row, i) // '''.')
  end subroutine need_number


  !> The place of a node that stands before this card, or a remark.
  subroutine need_node(scope, row, label, remarks, x, is_ok)
    type(scope_type), intent(in) :: scope
    type(row_type), intent(in) :: row
    integer, intent(in) :: label
    type(remarks_type), intent(inout) :: remarks
    real(DP), intent(out) :: x(3)
    logical, intent(inout) :: is_ok
    integer :: i
    x = 0
    i = index_of(label, scope%at, scope%label(:scope%n))
    if (i > 0) x = scope%x(:, i)
    if (i > 0) return
    is_ok = .false.
    call remarks%add(row%line, 'There is no node ' // text_of(label) // ' before this card.')
  end subroutine need_node


  !> A real parameter, or a remark.
  subroutine need_value(cards, c, parameters, key, default, remarks, value)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: key
    real(DP), intent(in) :: default
    type(remarks_type), intent(inout) :: remarks
    real(DP), intent(out) :: value
    integer :: status
    value = default
    if (.not. has(parameters, key)) return
    call parse_real(value_of(parameters, key), value, status)
    if (status == NUMBER_OK .and. abs(value) < 1.0e9_DP) return
    value = default
    call remarks%add(cards%cards(c)%line, 'The parameter ' // key // ' must be a number.')
  end subroutine need_value

end module amontons_deck_generate
