!> NODE, ELEMENT and SOLID SECTION to mesh and sections.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Elements are first collected as written (drafts), including unsupported kinds: mesh generators write
!! the lines and faces of a body together with its solids. When the sections are known, such leftovers are dropped if
!! nothing needs them, else rejected.
module amontons_deck_mesh
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_integer, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_labels, only: to_cartesian
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, &
    check_n_fields, check_no_data, has_decimal_comma, is_card, DECIMAL_COMMA_TEXT
  use amontons_containers, only: integer_list_type, label_table_type
  use amontons_deck_collapsed_elements, only: collapse_elements
  use amontons_element_drafts, only: element_draft_type, resize_draft, NOT_GIVEN
  use amontons_materials, only: material_type
  use amontons_mesh, only: mesh_type, finalize_mesh, N_NUMBERED_FACES
  use amontons_deck_user_elements, only: mark_user_directions
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_text, only: to_text, plural, verb, is_one_of, NUMBER_OK
  use amontons_user_elements, only: user_elements_type, user_kind_number
  use amontons_element_kinds, only: element_kind_type, element_kind, kind_family, element_kind_by_name, KIND_C3D8, &
    KIND_C3D8_FULL, KIND_C3D8I, KIND_CPE4, KIND_CPE4_FULL, KIND_CAX4, KIND_CAX4_FULL, KIND_T3D3, KIND_GAPUNI, FAMILY_SOLID, &
    FAMILY_TRUSS, FAMILY_SPRING, FAMILY_MASS, FAMILY_SHELL, FAMILY_MEMBRANE, FAMILY_BEAM, FAMILY_RIGID, &
    FAMILY_USER, FAMILY_COHESIVE, KIND_USER, is_structural_family
  implicit none
  private
  public :: read_nodes, read_elements, read_sections, select_elements, count_rows, is_in_family

  character(*), parameter :: RIGID_TYPES = 'R3D3|R3D4|R2D2|RAX2'   !< no section: their *RIGID BODY holds them

contains

  !> Reads all NODE cards.
  subroutine read_nodes(reader, draft, mesh)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(inout) :: draft
    type(mesh_type), intent(inout) :: mesh
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: line(:)
    integer :: c, n_rows
    n_rows = count_rows(reader, 'NODE')
    allocate (mesh%node_label(n_rows), mesh%coordinates(3, n_rows), line(n_rows))
    allocate (draft%node_first(reader%cards%n_cards), draft%node_last(reader%cards%n_cards))
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'SYSTEM')) call check_global_axes(reader, c)
      if (.not. is_card(reader, c, 'NODE')) cycle
      call open_card(reader, c, parameters, row)
      draft%node_first(c) = mesh%n_nodes + 1
      do while (next_row(reader%cards, row))
        call read_node(reader, row, parameter_word(parameters, 'SYSTEM', 'R'), mesh, line)
      end do
      draft%node_last(c) = mesh%n_nodes
    end do
    mesh%node_label = mesh%node_label(:mesh%n_nodes)
    mesh%coordinates = mesh%coordinates(:, :mesh%n_nodes)
    call reader%node_labels%build(mesh%node_label)
    call merge_repeated_nodes(reader, mesh, draft, line)
    if (mesh%n_nodes == 0) call report_error(reader, 0, 'The deck has no nodes: there is no *NODE card with data.')
  end subroutine read_nodes


  !> SYSTEM with data: local axes of the coordinates, which are refused.
  subroutine check_global_axes(reader, c)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    call open_card(reader, c, parameters, row)
    if (next_row(reader%cards, row)) call report_error(reader, row%line, 'Local axes of coordinates are not supported: give ' // &
      'those of the nodes in the global axes, and *SYSTEM without data or not at all.')
  end subroutine check_global_axes


  !> Nodes that are given again at the same place are one node, with a note. In CalculiX the later place counts; else another place
  !! is an error.
  subroutine merge_repeated_nodes(reader, mesh, draft, line)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(inout) :: mesh
    type(element_draft_type), intent(inout) :: draft
    integer, intent(inout) :: line(:)            !< line of each row
    integer :: i, first, n, n_moved
    allocate (draft%node_at(mesh%n_nodes))
    n = 0
    n_moved = 0
    do i = 1, mesh%n_nodes
      first = reader%node_labels%find(mesh%node_label(i))
      if (first < i) then
        draft%node_at(i) = draft%node_at(first)
        associate (X => mesh%coordinates(:, draft%node_at(first)))
          if (all(abs(X - mesh%coordinates(:, i)) <= 0.0_DP)) cycle
          n_moved = n_moved + 1
          if (reader%dialect /= DIALECT_CALCULIX) call report_error(reader, line(i), 'The node ' // to_text(mesh%node_label(i)) // &
            ' is defined twice, here at another place; the first time in ' // line_location(reader, line(first)) // '.')
          X = mesh%coordinates(:, i)
        end associate
      else
        n = n + 1
        draft%node_at(i) = n
        mesh%node_label(n) = mesh%node_label(i)
        mesh%coordinates(:, n) = mesh%coordinates(:, i)
      end if
    end do
    if (n == mesh%n_nodes) return
    call report_note(reader, 0, 'The deck defines ' // plural(mesh%n_nodes - n, 'node') // ' more than once, ' &
      // to_text(n_moved) // &
      ' of them with other coordinates; the last definition counts.')
    mesh%n_nodes = n
    mesh%node_label = mesh%node_label(:n)
    mesh%coordinates = mesh%coordinates(:, :n)
    call reader%node_labels%build(mesh%node_label)
  end subroutine merge_repeated_nodes


  !> One node: number, x, y, z; missing coordinates are zero. Up to three further values (a normal) are ignored.
  subroutine read_node(reader, row, system, mesh, line)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: system           !< R, C or S
    type(mesh_type), intent(inout) :: mesh
    integer, intent(inout) :: line(:)            !< line of each node
    character(1), parameter :: AXES(3) = ['x', 'y', 'z']
    integer :: label, i
    logical :: is_ok
    is_ok = .true.
    call read_label(reader, row, 'node', label, is_ok)
    call check_n_fields(reader, row, 7)            ! three more for a normal, which solids do not need
    if (row%n > 4 .and. .not. reader%has_decimal_commas) then
      reader%has_decimal_commas = has_decimal_comma(reader%cards, row, is_mixed=.true.)
      if (reader%has_decimal_commas) call report_note(reader, row%line, DECIMAL_COMMA_TEXT)
    end if
    mesh%n_nodes = mesh%n_nodes + 1
    do i = 1, 3
      call read_real(reader, row, i + 1, AXES(i), mesh%coordinates(i, mesh%n_nodes), is_ok, 0.0_DP)
    end do
    mesh%coordinates(:, mesh%n_nodes) = to_cartesian(system, mesh%coordinates(:, mesh%n_nodes))
    mesh%node_label(mesh%n_nodes) = label
    line(mesh%n_nodes) = row%line
    if (.not. is_ok) mesh%n_nodes = mesh%n_nodes - 1
  end subroutine read_node


  !> The number of a node or element in the first field: a positive integer.
  subroutine read_label(reader, row, what, label, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: what             !< 'node' or 'element'
    integer, intent(out) :: label
    logical, intent(inout) :: is_ok
    integer :: status
    call field_integer(reader%cards, row, 1, label, status)
    if (status == NUMBER_OK .and. label > 0) return
    is_ok = .false.
    call report_error(reader, row%line, 'The first field must be the number of the ' // what // &
      ', a positive integer; it is ''' // field_text(reader%cards, row, 1) // '''.')
  end subroutine read_label


  !> Upper bound of the data rows of all cards with a keyword.
  pure function count_rows(reader, key) result(n)
    type(reader_type), intent(in) :: reader
    character(*), intent(in) :: key
    integer :: n, c
    n = 0
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, key)) n = n + max(0, reader%cards%cards(c)%data_last - reader%cards%cards(c)%data_first + &
        1)
    end do
  end function count_rows


  !> Reports duplicate numbers.
  subroutine report_duplicate_labels(reader, table, label, line, what)
    type(reader_type), intent(inout) :: reader
    type(label_table_type), intent(in) :: table
    integer, intent(in) :: label(:)              !< labels in the order of the deck
    integer, intent(in) :: line(:)               !< their lines
    character(*), intent(in) :: what             !< 'node' or 'element'
    integer :: i, first
    do i = 1, size(label)
      first = table%find(label(i))
      if (first /= i) call report_error(reader, line(i), 'The ' // what // ' ' // to_text(label(i)) // &
        ' is defined twice; the first time in ' // line_location(reader, line(first)) // '.')
    end do
  end subroutine report_duplicate_labels


  !> A line by its number and its file.
  function line_location(reader, line) result(text)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: line
    character(:), allocatable :: text
    text = 'line ' // to_text(reader%cards%line_number(line)) // ' of ' // reader%cards%files(reader%cards%line_file(line))%path
  end function line_location


  !> Reads all ELEMENT cards.
  subroutine read_elements(reader, mesh, user_elements, draft)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    type(user_elements_type), allocatable, intent(in) :: user_elements   !< with kinds
    type(element_draft_type), intent(inout) :: draft
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: c, kind, n_rows, n_wanted, user_kind
    logical :: is_ok
    n_rows = count_rows(reader, 'ELEMENT')
    call resize_draft(draft, n_rows)
    allocate (draft%element_first(reader%cards%n_cards), draft%element_last(reader%cards%n_cards))
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'ELEMENT')) cycle
      call open_card(reader, c, parameters, row)
      draft%element_first(c) = draft%n + 1
      kind = kind_of_type(reader, c, parameter_word(parameters, 'TYPE', ''))
      n_wanted = 0
      if (kind > 0) n_wanted = node_count(kind)
      user_kind = find_user_kind(user_elements, parameter_word(parameters, 'TYPE', ''))
      if (user_kind > 0) then
        kind = KIND_USER
        n_wanted = user_elements%kinds(user_kind)%n_nodes
      end if
      is_ok = .true.
      do while (is_ok)
        if (.not. next_row(reader%cards, row)) exit
        call read_element(reader, row, c, kind, n_wanted, draft, is_ok)
      end do
      draft%element_last(c) = draft%n
      draft%user_kind(draft%element_first(c):draft%n) = user_kind
      draft%is_in_plane(draft%element_first(c):draft%n) = kind > 0 .and. (begins_with(parameter_word(parameters, 'TYPE', ''), &
        'T2D') .or. begins_with(parameter_word(parameters, 'TYPE', ''), 'B2'))
      draft%is_rigid(draft%element_first(c):draft%n) = kind > 0 .and. is_one_of(parameter_word(parameters, 'TYPE', ''), &
        RIGID_TYPES)
    end do
    call resize_draft(draft, draft%n)
    call draft%labels%build(draft%label)
    call report_duplicate_labels(reader, draft%labels, draft%label, draft%line, 'element')
    call collapse_elements(reader, mesh, draft)
    if (draft%n == 0) call report_error(reader, 0, 'The deck has no elements: there is no *ELEMENT card with data.')
  end subroutine read_elements


  !> The index of the kind of a user element; 0: no such kind.
  pure integer function find_user_kind(user_elements, type) result(kind)
    type(user_elements_type), allocatable, intent(in) :: user_elements
    character(*), intent(in) :: type             !< upper case
    kind = 0
    if (allocated(user_elements) .and. user_kind_number(type) > 0) kind = findloc(user_elements%kinds%number, &
      user_kind_number(type), dim=1)
  end function find_user_kind


  !> The number of nodes of an element kind.
  pure function node_count(kind) result(n)
    integer, intent(in) :: kind                  !< KIND_...
    type(element_kind_type) :: entry
    integer :: n
    entry = element_kind(kind)
    n = entry%n_nodes
  end function node_count


  !> The kind of an element type; 0: unsupported. Hybrid (H), modified (M) and heated (T) kinds are treated as the kind
  !! without that letter, or as the default of their shape, with a note.
  function kind_of_type(reader, c, type) result(kind)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: type             !< upper case
    integer :: kind
    character(2), parameter :: ENDINGS(7) = ['H ', 'M ', 'T ', 'MH', 'MT', 'RH', 'RT']
    character(:), allocatable :: taken
    integer :: i
    taken = type
    if (type == 'T2D2') taken = 'T3D2'           ! with the third displacement held, see is_in_plane
    if (type == 'T2D3') taken = 'T3D3'
    if (is_one_of(type, 'B21|B22')) taken = 'B3' // type(3:)
    if (is_one_of(type, 'S3R|STRI3')) taken = 'S3'
    if (type == 'STRI65') taken = 'S6'
    if (is_one_of(type, 'S4R5|S8R5')) taken = type(:3)
    if (is_one_of(type, 'R3D3|R3D4') .and. reader%dialect /= DIALECT_CALCULIX) taken = 'S' // type(4:)   ! CalculiX has none
    if (ends_with(type, 'RI')) taken = type(:len(type) - 1)     ! C3D20RI
    do i = 1, size(ENDINGS)
      if (element_kind_by_name(taken) > 0) exit
      if (.not. ends_with(type, trim(ENDINGS(i)))) cycle
      taken = type(:len(type) - len_trim(ENDINGS(i)))
    end do
    kind = element_kind_by_name(taken)
    if (reader%dialect == DIALECT_CALCULIX .and. is_one_of(type, RIGID_TYPES // '|SAX1|SAX2')) kind = 0   ! CalculiX has none
    if (kind == 0) return
    if (taken /= type .and. .not. is_one_of(type(:min(3, len(type))), 'T2D|R3D|B21|B22')) call report_note(reader, &
      reader%cards%cards(c)%line, 'The elements ' // type // ' are taken as ' // taken // '.')
    if (reader%dialect /= DIALECT_CALCULIX) return
    if (kind == KIND_C3D8) kind = KIND_C3D8_FULL
    if (kind == KIND_CPE4) kind = KIND_CPE4_FULL
    if (kind == KIND_CAX4) kind = KIND_CAX4_FULL
  end function kind_of_type


  !> One element: its number and its nodes, on one row or several. The next row continues it after a trailing comma and
  !! while nodes are missing.
  subroutine read_element(reader, row, c, kind, n_wanted, draft, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: kind                  !< 0: unknown, then any number of nodes
    integer, intent(in) :: n_wanted              !< nodes of the kind; 0 if unknown
    type(element_draft_type), intent(inout) :: draft
    logical, intent(out) :: is_ok                !< .false.: the rest of the card is not read
    integer :: label, start, line
    is_ok = .true.
    line = row%line
    start = draft%nodes%n
    call read_label(reader, row, 'element', label, is_ok)
    if (.not. is_ok) return
    call read_node_fields(reader, row, 2, draft%nodes, is_ok)
    do while (is_ok .and. (draft%nodes%n - start < n_wanted .or. (kind == 0 .and. row%has_trailing_comma)))
      if (.not. next_row(reader%cards, row)) exit
      call read_node_fields(reader, row, 1, draft%nodes, is_ok)
    end do
    if (.not. is_ok) return
    ! Old decks of CalculiX give a C3D8I up to three extra nodes, for its modes; here the modes are internal.
    if (kind == KIND_C3D8I .and. draft%nodes%n - start <= n_wanted + 3) draft%nodes%n = min(draft%nodes%n, start + n_wanted)
    if (kind > 0 .and. draft%nodes%n - start /= n_wanted) then
      is_ok = .false.
      call report_error(reader, line, 'The element ' // to_text(label) // ' has ' // plural(draft%nodes%n - start, 'node') &
        // '; its kind has ' // to_text(n_wanted) // '. The rest of this card is not read.')
      draft%nodes%n = start
      return
    end if
    draft%n = draft%n + 1
    draft%label(draft%n) = label
    draft%kind(draft%n) = kind
    draft%card(draft%n) = c
    draft%line(draft%n) = line
    draft%first(draft%n + 1) = draft%nodes%n + 1
  end subroutine read_element


  !> Appends the nodes of a row; an invalid number is reported and stops the card.
  subroutine read_node_fields(reader, row, first, nodes, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: first                 !< first field that is a node
    type(integer_list_type), intent(inout) :: nodes
    logical, intent(inout) :: is_ok
    integer :: i, label, status, node
    do i = first, row%n
      call field_integer(reader%cards, row, i, label, status)
      if (status /= NUMBER_OK) then
        call report_error(reader, row%line, 'Field ' // to_text(i) // ' must be the number of a node; it is ''' // &
          field_text(reader%cards, row, i) // '''. The rest of this card is not read.')
        is_ok = .false.
        return
      end if
      node = reader%node_labels%find(label)
      if (node == 0) call report_error(reader, row%line, 'There is no node ' // to_text(label) // '.')
      call nodes%add(node)
    end do
  end subroutine read_node_fields


  !> Reads all SOLID SECTION cards: element to material. The members of the element sets are indices of drafts here.
  subroutine read_sections(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model        !< with the element sets of drafts
    type(element_draft_type), intent(inout) :: draft
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    real(DP) :: thickness
    integer :: c, set, material
    logical :: is_thick
    do c = 1, reader%cards%n_cards
      if (.not. (is_card(reader, c, 'SOLIDSECTION') .or. is_card(reader, c, 'MEMBRANESECTION') .or. &
        is_card(reader, c, 'COHESIVESECTION'))) cycle
      call open_card(reader, c, parameters, row)
      set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
      material = reader%materials%find(parameter_text(parameters, 'MATERIAL'))
      associate (line => reader%cards%cards(c)%line)
        if (set == 0 .and. has_parameter(parameters, 'ELSET')) call report_error(reader, line, 'There is no element set ''' // &
          parameter_text(parameters, 'ELSET') // '''' // reader%element_sets%suggest(parameter_text(parameters, 'ELSET')))
        if (material == 0 .and. has_parameter(parameters, 'MATERIAL')) call report_error(reader, line, &
          'There is no material ''' // &
          parameter_text(parameters, 'MATERIAL') // '''' // reader%materials%suggest(parameter_text(parameters, 'MATERIAL')))
        if (has_parameter(parameters, 'COMPOSITE')) then   ! refused: neither material nor layers are missing
          if (set > 0) call assign_material(reader, c, model%mesh%element_sets(set)%members, 0, 1.0_DP, draft)
          cycle
        end if
        thickness = 1
        if (is_card(reader, c, 'COHESIVESECTION')) then   ! its data lines are read when the mesh is known
          if (set > 0) call assign_material(reader, c, model%mesh%element_sets(set)%members, material, thickness, draft)
          cycle
        end if
        if (next_row(reader%cards, row)) then
          is_thick = .true.
          if (needs_thickness(model, draft, set)) then
            call read_real(reader, row, 1, 'thickness or cross-section', thickness, is_thick, 1.0_DP)
            if (.not. thickness > 0) call report_error(reader, row%line, 'The thickness or cross-section must be positive.')
          end if
          if (next_row(reader%cards, row)) call check_no_data(reader, row)
        end if
        if (set == 0) cycle
        call assign_material(reader, c, model%mesh%element_sets(set)%members, material, thickness, draft)
      end associate
    end do
  end subroutine read_sections


  !> Gives elements the material and thickness of a section, unless they are not of its kind.
  subroutine assign_material(reader, c, members, material, thickness, draft)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< card
    integer, intent(in) :: members(:)            !< drafts
    integer, intent(in) :: material              !< 0: unknown, which is reported
    real(DP), intent(in) :: thickness            !< or cross-section [length]
    type(element_draft_type), intent(inout) :: draft
    integer :: i, e, n_overridden
    n_overridden = 0
    associate (line => reader%cards%cards(c)%line)
      do i = 1, size(members)
        e = members(i)
        if (draft%material(e) > 0 .and. draft%material(e) /= material) n_overridden = n_overridden + 1
        draft%material(e) = merge(material, -1, material > 0)
        draft%section_card(e) = c
        if (is_thin(draft%kind(e))) draft%section_value(e) = thickness
        if (draft%kind(e) == 0) cycle              ! not supported: reported with its card
        if ((is_in_family(draft%kind(e), FAMILY_MEMBRANE) .eqv. is_card(reader, c, 'MEMBRANESECTION')) .and. &
          (is_in_family(draft%kind(e), FAMILY_COHESIVE) .eqv. is_card(reader, c, 'COHESIVESECTION'))) then
          if (.not. is_expanded_kind(draft%kind(e))) cycle
        end if
        call report_error(reader, line, 'The element ' // to_text(draft%label(e)) // ' is a ' // kind_name(draft%kind(e)) // &
          '; solids, plane elements and trusses have a *SOLID SECTION, shells a *SHELL SECTION, membranes a *MEMBRANE ' // &
          'SECTION, beams a *BEAM SECTION, cohesive elements a *COHESIVE SECTION.')
        exit
      end do
      if (n_overridden > 0) call report_note(reader, line, plural(n_overridden, 'element') // &
        ' had another material by an earlier section; this one counts.')
    end associate
  end subroutine assign_material


  !> The name of a kind.
  pure function kind_name(kind) result(name)
    integer, intent(in) :: kind                  !< KIND_..., 0: unknown
    character(:), allocatable :: name
    type(element_kind_type) :: entry
    if (kind > 0) entry = element_kind(kind)
    name = trim(entry%name)
  end function kind_name


  !> Whether a kind has a thickness or a cross-section.
  pure function is_thin(kind) result(is_so)
    integer, intent(in) :: kind                  !< KIND_..., 0: unknown
    logical :: is_so
    integer :: family
    is_so = .false.
    if (kind == 0) return
    family = kind_family(kind)
    is_so = all(family /= [FAMILY_SOLID, FAMILY_SPRING, FAMILY_MASS, FAMILY_RIGID, FAMILY_USER, FAMILY_COHESIVE]) .and. .not. &
      is_structural_family(family)
  end function is_thin


  !> Whether a kind is that of a shell or a beam.
  pure logical function is_expanded_kind(kind)
    integer, intent(in) :: kind                  !< KIND_..., 0: unknown
    is_expanded_kind = is_in_family(kind, FAMILY_SHELL) .or. is_in_family(kind, FAMILY_BEAM)
  end function is_expanded_kind


  !> Whether a set contains elements with a thickness or a cross-section.
  pure function needs_thickness(model, draft, set) result(does_so)
    type(model_type), intent(in) :: model        !< with the element sets of drafts
    type(element_draft_type), intent(in) :: draft
    integer, intent(in) :: set                   !< 0: none
    logical :: does_so
    integer :: i
    does_so = .false.
    if (set == 0) return
    associate (members => model%mesh%element_sets(set)%members)
      do i = 1, size(members)
        does_so = is_thin(draft%kind(members(i)))
        if (does_so) return
      end do
    end associate
  end function needs_thickness


  !> Whether a kind belongs to a family.
  pure function is_in_family(kind, family) result(is_so)
    integer, intent(in) :: kind                  !< KIND_..., 0: unknown
    integer, intent(in) :: family                !< FAMILY_...
    logical :: is_so
    is_so = .false.
    if (kind > 0) is_so = kind_family(kind) == family
  end function is_in_family


  !> Builds the mesh from the drafts; drops leftovers; reports unsupported elements in use.
  subroutine select_elements(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(element_draft_type), intent(inout) :: draft
    integer :: e, n
    call omit_boundary_elements(reader, model%mesh%n_nodes, draft)
    if (maxval([1, draft%n_layers]) > huge(n) / label_step(draft)) then
      call report_error(reader, 0, 'Layer k of an element has its number plus (k - 1) times ' // to_text(label_step(draft)) // &
        ', which is too large here. Use smaller element numbers.')
      draft%n_layers = 1
    end if
    allocate (draft%mesh_index(draft%n), source=0)
    n = 0
    do e = 1, draft%n
      if (draft%kind(e) == 0) cycle
      draft%mesh_index(e) = n + 1
      n = n + draft%n_layers(e)
    end do
    call build_mesh(draft, n, model%mesh)
    call mark_user_directions(draft, model)
    call finalize_mesh(model%mesh)
    if (size(model%materials) == 0) model%materials = [material_type(name='')]   ! springs and masses need no material
    call reader%element_labels%build(model%mesh%element_label)
    reader%draft_element_labels = draft%labels
    call report_missing_sections(reader, draft)
    call report_omitted_elements(reader, model%mesh, draft)
    call map_set_members(reader, model%mesh, draft)
  end subroutine select_elements


  !> Faces and lines that mesh generators write beside a body: the elements of a card without any section, all of whose
  !! nodes belong to elements of higher dimension, get no kind.
  subroutine omit_boundary_elements(reader, n_nodes, draft)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: n_nodes
    type(element_draft_type), intent(inout) :: draft
    integer, allocatable :: dimensions(:)        ! (0:n_nodes) most of the elements at a node
    integer :: c, e, i, n
    allocate (dimensions(0:n_nodes), source=0)
    do e = 1, draft%n
      n = n_dimensions(draft%kind(e))
      if (n < 3 .and. draft%material(e) == 0) cycle
      do i = draft%first(e), draft%first(e + 1) - 1
        dimensions(draft%nodes%items(i)) = max(dimensions(draft%nodes%items(i)), n)
      end do
    end do
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'ELEMENT')) cycle
      associate (first => draft%element_first(c), last => draft%element_last(c))
        if (first > last) cycle
        n = n_dimensions(draft%kind(first))
        if (n == 0 .or. n == 3 .or. any(draft%material(first:last) /= 0)) cycle
        if (all(dimensions(draft%nodes%items(draft%first(first):draft%first(last + 1) - 1)) > n)) draft%kind(first:last) = 0
      end associate
    end do
  end subroutine omit_boundary_elements


  !> Dimensions of the body that an element is a piece of: 3 solids, 2 plane kinds, 1 trusses, 0 the rest.
  pure function n_dimensions(kind) result(n)
    integer, intent(in) :: kind                  !< KIND_..., 0: unknown
    integer :: n
    n = 0
    if (is_thin(kind)) n = 2
    if (is_in_family(kind, FAMILY_SHELL) .or. is_in_family(kind, FAMILY_MEMBRANE)) n = 2
    if (is_in_family(kind, FAMILY_TRUSS) .or. is_in_family(kind, FAMILY_BEAM)) n = 1
    if (is_in_family(kind, FAMILY_SOLID) .or. is_in_family(kind, FAMILY_COHESIVE)) n = 3
  end function n_dimensions


  !> Copies the kept drafts into the mesh.
  subroutine build_mesh(draft, n, mesh)
    type(element_draft_type), intent(in) :: draft
    integer, intent(in) :: n                     !< elements kept
    type(mesh_type), intent(inout) :: mesh
    integer, allocatable :: numbers(:)
    integer :: e, k, n_nodes, start, layer, step
    integer, parameter :: T3D3_NODE_ORDER(3) = [1, 3, 2]   ! a deck lists the middle node of T3D3 second
    mesh%n_elements = n
    allocate (mesh%section_value(n), mesh%directions(2, n), mesh%section(n))
    numbers = section_numbers(draft%section_card)
    step = label_step(draft)
    if (any(draft%spring > 0)) allocate (mesh%spring(n), source=0)
    allocate (mesh%element_label(n), mesh%kind(n), mesh%first(n + 1), mesh%material(n), mesh%is_in_plane(n), mesh%layer(n))
    if (allocated(draft%face_places)) allocate (mesh%face_places(N_NUMBERED_FACES, n))
    n_nodes = 0
    do e = 1, draft%n
      if (draft%mesh_index(e) > 0) n_nodes = n_nodes + draft%n_layers(e) * (draft%first(e + 1) - draft%first(e))
    end do
    allocate (mesh%nodes(n_nodes))
    mesh%first(1) = 1
    do e = 1, draft%n
      if (draft%mesh_index(e) == 0) cycle
      do layer = 1, draft%n_layers(e)
        k = draft%mesh_index(e) + layer - 1
        mesh%element_label(k) = draft%label(e) + (layer - 1) * step
        mesh%section(k) = numbers(e)
        mesh%layer(k) = layer
        mesh%kind(k) = draft%kind(e)
        if (allocated(draft%face_places)) mesh%face_places(:, k) = draft%face_places(:, e)
        mesh%is_in_plane(k) = draft%is_in_plane(e)
        mesh%material(k) = max(0, draft%material(e))
        mesh%section_value(k) = draft%section_value(e)
        mesh%directions(:, k) = draft%directions(:, e)
        if (allocated(mesh%spring)) mesh%spring(k) = draft%spring(e)
        start = mesh%first(k)
        mesh%first(k + 1) = start + draft%first(e + 1) - draft%first(e)
        mesh%nodes(start:mesh%first(k + 1) - 1) = draft%nodes%items(draft%first(e):draft%first(e + 1) - 1)
        if (mesh%kind(k) == KIND_T3D3) mesh%nodes(start:start + 2) = mesh%nodes(start - 1 + T3D3_NODE_ORDER)
      end do
    end do
  end subroutine build_mesh


  !> What the labels of the layers of an element differ by: the power of ten above all labels of the deck.
  pure integer function label_step(draft) result(step)
    type(element_draft_type), intent(in) :: draft
    integer, parameter :: LARGEST = 1000000000     !< power of ten that an integer holds
    step = 10
    do while (step <= maxval(draft%label) .and. step < LARGEST)
      step = 10 * step
    end do
  end function label_step


  !> The sections of elements, numbered in the order of their cards.
  pure function section_numbers(card) result(number)
    integer, intent(in) :: card(:)               !< of each element, 0: none
    integer :: number(size(card))
    integer :: place(0:maxval([0, card])), c
    place = 0
    place(card) = 1
    place(0) = 0
    do c = 1, ubound(place, 1)
      place(c) = place(c) + place(c - 1)
    end do
    number = place(card)
  end function section_numbers


  !> Reports elements without a section, once for each ELEMENT card.
  subroutine report_missing_sections(reader, draft)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    character(:), allocatable :: card
    integer :: e, c, n, first
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'ELEMENT')) cycle
      n = 0
      first = 0
      card = 'SOLID SECTION'
      do e = draft%element_first(c), draft%element_last(c)
        if (draft%kind(e) == 0) cycle
        if (is_in_family(draft%kind(e), FAMILY_SHELL)) card = 'SHELL SECTION'
        if (is_in_family(draft%kind(e), FAMILY_MEMBRANE)) card = 'MEMBRANE SECTION'
        if (is_in_family(draft%kind(e), FAMILY_BEAM)) card = 'BEAM SECTION'
        if (is_in_family(draft%kind(e), FAMILY_COHESIVE)) card = 'COHESIVE SECTION'
        if (is_in_family(draft%kind(e), FAMILY_SPRING)) card = 'SPRING'
        if (draft%kind(e) == KIND_GAPUNI) card = 'GAP'
        if (is_in_family(draft%kind(e), FAMILY_MASS)) card = 'MASS'
        if (is_in_family(draft%kind(e), FAMILY_RIGID)) card = 'RIGID BODY'
        if (draft%kind(e) == KIND_USER) card = trim(merge('BEAM SECTION, SECTION=GENERAL', 'UEL PROPERTY                 ', &
          reader%dialect == DIALECT_CALCULIX))
        if (merge(draft%material(e) /= 0, draft%section_value(e) > NOT_GIVEN, index(card, 'SECTION') > 0 .and. &
          draft%kind(e) /= KIND_USER)) cycle
        n = n + 1
        if (first == 0) first = draft%label(e)
      end do
      if (n > 0) call report_error(reader, reader%cards%cards(c)%line, plural(n, 'element') // &
        ' of this card (the first is ' // to_text(first) // ') ' // verb(n, 'has', 'have') // ' no section: no *' // card // &
        ' names a set that holds ' // verb(n, 'it', 'them') // '.')
    end do
  end subroutine report_missing_sections


  !> Elements of unsupported kinds, card by card: a note if they are lines or faces of solids without a section,
  !! else an error.
  subroutine report_omitted_elements(reader, mesh, draft)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    type(element_draft_type), intent(in) :: draft
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: type
    logical, allocatable :: is_solid(:)
    integer :: c, i, k, n_dropped
    logical :: is_left
    allocate (is_solid(0:mesh%n_nodes), source=.false.)
    do i = 1, size(mesh%nodes)
      is_solid(mesh%nodes(i)) = .true.
    end do
    n_dropped = 0
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'ELEMENT')) cycle
      call open_card(reader, c, parameters, row)
      type = parameter_word(parameters, 'TYPE', '')
      associate (first => draft%element_first(c), last => draft%element_last(c))
        if (first > last) then
          if (element_kind_by_name(type) == 0) call report_unsupported_type(reader, c, type)
          cycle
        end if
        if (draft%kind(first) /= 0) cycle
        if (begins_with(type, 'DCOUP3D') .or. (type == 'DCOUP2D' .and. reader%dialect /= DIALECT_CALCULIX)) then
          if (reader%dialect /= DIALECT_CALCULIX .and. .not. any([(is_card(reader, k, 'DISTRIBUTINGCOUPLING'), k=1, &
            reader%cards%n_cards)])) call report_error(reader, reader%cards%cards(c)%line, 'An element ' // type // &
            ' couples nothing without *DISTRIBUTING COUPLING, ELSET=, which names its nodes and their weights.')
          cycle
        end if
        if (reader%dialect == DIALECT_CALCULIX .and. begins_with(type, 'DASHPOT')) then
          call report_note(reader, reader%cards%cards(c)%line, 'Dashpots resist rates, which do not count in a quasi-static ' // &
            'step; they are left out.')
          cycle
        end if
        is_left = all(draft%material(first:last) == 0) .and. is_lower_dimensional(type)
        if (is_left) is_left = all(is_solid(draft%nodes%items(draft%first(first):draft%first(last + 1) - 1)))
        if (is_left) then
          n_dropped = n_dropped + last - first + 1
        else
          call report_unsupported_type(reader, c, type)
        end if
      end associate
    end do
    if (n_dropped > 0) call report_note(reader, 0, plural(n_dropped, 'element') // verb(n_dropped, &
      ' that is a line or face of solids and has no section is left out', &
      ' that are lines or faces of solids and have no section are left out') // ' (mesh generators write them).')
  end subroutine report_omitted_elements


  !> Reports an unsupported element type, with a replacement.
  subroutine report_unsupported_type(reader, c, type)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: type             !< upper case
    character(:), allocatable :: advice
    reader%has_unsupported_kinds = .true.
    if (type == '') return
    if (user_kind_number(type) > 0 .and. allocated(reader%bad_user_kinds)) then
      if (any(reader%bad_user_kinds == user_kind_number(type) .or. reader%bad_user_kinds == 0)) return
    end if
    advice = 'The kinds are C3D4, C3D6, C3D8, C3D8I, C3D8R, C3D10, C3D15, C3D20, C3D20R; CPS, CPE, CAX with 3, 4, ' // &
      '4I, 4R, 6, 8, 8R; S3, S4, S4R, S6, S8, S8R, SAX1, SAX2; M3D3 to M3D8R; B21 to B32R; T2D2, T2D3, T3D2, T3D3; R3D3, ' // &
      'R3D4, R2D2, RAX2; SPRINGA, SPRING1, SPRING2; GAPUNI; MASS.'
    if (begins_with(type, 'C3D8')) advice = 'Use C3D8, which has a mean dilatation against locking, or C3D8I.'
    if (begins_with(type, 'C3D20')) advice = 'Use C3D20 or C3D20R.'
    if (begins_with(type, 'C3D10')) advice = 'Use C3D10.'
    if (begins_with(type, 'C3D4')) advice = 'Use C3D4, or better C3D10.'
    if (begins_with(type, 'C3D6')) advice = 'Use C3D6.'
    if (begins_with(type, 'C3D15')) advice = 'Use C3D15.'
    if (begins_with(type, 'CPS') .or. begins_with(type, 'CPE') .or. begins_with(type, &
      'CAX')) advice = 'Plane kinds have 3, 4, 4I, ' &
      // '4R, 6, 8 or 8R nodes: CPE4, CPE8R and so on.'
    if (is_structural(type)) advice = 'The shells are S3, S4, S4R, S6, S8, S8R, the membranes M3D3, M3D4, M3D4R, M3D6, ' // &
      'M3D8, M3D8R, the beams B21, B22, B31, B31R, B32, B32R.'
    if (begins_with(type, 'SAX')) advice = 'The axisymmetric shells are SAX1 and SAX2, in the abaqus dialect (CalculiX has none).'
    if (begins_with(type, 'R')) advice = 'Rigid tools are R3D3, R3D4, in the plane R2D2, RAX2 (abaqus ' // &
      'dialect), or solids in a *RIGID BODY; or *SURFACE, TYPE=SEGMENTS with *RIGID BODY, ANALYTICAL SURFACE.'
    if (begins_with(type, 'DCOUP')) advice = 'Use *COUPLING with *DISTRIBUTING below it, on a surface.'
    if (begins_with(type, 'DASHPOT')) advice = 'Rates do not count in a quasi-static step; leave the dashpots out.'
    if (user_kind_number(type) > 0) advice = 'A user element needs *USER ELEMENT, TYPE=' // type // ' and the routine UEL.'
    if (begins_with(type, 'GAP')) advice = 'Use GAPUNI, or *CONTACT PAIR.'
    call report_error(reader, reader%cards%cards(c)%line, 'The element type ' // type // ' is not supported. ' // advice)
  end subroutine report_unsupported_type


  !> Whether a type is a line, a face, a shell, or the like.
  pure function is_lower_dimensional(type) result(is_so)
    character(*), intent(in) :: type             !< upper case
    logical :: is_so
    character(3), parameter :: BEGINNINGS(5) = ['T2D', 'T3D', 'CPS', 'CPE', 'CAX']
    integer :: i
    is_so = is_structural(type) .or. any([(begins_with(type, BEGINNINGS(i)), i=1, size(BEGINNINGS))])
  end function is_lower_dimensional


  !> Whether a type is a beam, a shell, a membrane, or a rigid or surface element.
  pure function is_structural(type) result(is_so)
    character(*), intent(in) :: type             !< upper case
    logical :: is_so
    character(5), parameter :: BEGINNINGS(8) = [character(5) :: 'B2', 'B3', 'M3D', 'R3D', 'R2D', 'STRI', 'SFM3D', 'SC']
    integer :: i
    is_so = any([(begins_with(type, trim(BEGINNINGS(i))), i=1, size(BEGINNINGS))])
    if (.not. is_so .and. len(type) >= 2) is_so = type(1:1) == 'S' .and. scan(type(2:2), '3468A') == 1
  end function is_structural


  !> Whether a word ends with another one.
  pure function ends_with(word, ending) result(does_so)
    character(*), intent(in) :: word, ending
    logical :: does_so
    does_so = len(word) > len(ending)
    if (does_so) does_so = word(len(word) - len(ending) + 1:) == ending
  end function ends_with


  !> Whether a word starts with another one.
  pure function begins_with(word, beginning) result(does_so)
    character(*), intent(in) :: word, beginning
    logical :: does_so
    does_so = len(word) >= len(beginning)
    if (does_so) does_so = word(:len(beginning)) == beginning
  end function begins_with


  !> Converts the members of the element sets from drafts to elements of the mesh.
  subroutine map_set_members(reader, mesh, draft)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(inout) :: mesh
    type(element_draft_type), intent(in) :: draft
    integer :: s, n, i
    allocate (reader%has_omitted_elements(size(mesh%element_sets)), source=.false.)
    allocate (reader%omitted_of_set(size(mesh%element_sets)))
    call store_omitted_nodes(reader, draft)
    do s = 1, size(mesh%element_sets)
      associate (set => mesh%element_sets(s))
        n = size(set%members)
        do i = 1, n
          if (draft%mesh_index(set%members(i)) == 0) call reader%omitted_of_set(s)%add(reader%omitted_of_draft(set%members(i)))
        end do
        reader%has_omitted_elements(s) = any(draft%mesh_index(set%members) == 0)
        set%members = indices_of_layers(draft, set%members)
      end associate
    end do
  end subroutine map_set_members


  !> The elements of the mesh for some drafts: all their layers; none for dropped ones.
  pure function indices_of_layers(draft, members) result(elements)
    type(element_draft_type), intent(in) :: draft
    integer, intent(in) :: members(:)            !< drafts
    integer, allocatable :: elements(:)
    integer :: i, k, n
    allocate (elements(sum(draft%n_layers(members), mask=draft%mesh_index(members) > 0)))
    n = 0
    do i = 1, size(members)
      if (draft%mesh_index(members(i)) == 0) cycle
      do k = 1, draft%n_layers(members(i))
        n = n + 1
        elements(n) = draft%mesh_index(members(i)) + k - 1
      end do
    end do
  end function indices_of_layers


  !> Stores the nodes of the dropped elements: surfaces may name them.
  subroutine store_omitted_nodes(reader, draft)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(in) :: draft
    type(integer_list_type) :: nodes
    integer :: e, i, n
    allocate (reader%omitted_of_draft(draft%n), source=0)
    allocate (reader%omitted_first(count(draft%mesh_index == 0) + 1), source=1)
    n = 0
    do e = 1, draft%n
      if (draft%mesh_index(e) > 0) cycle
      n = n + 1
      reader%omitted_of_draft(e) = n
      do i = draft%first(e), draft%first(e + 1) - 1
        if (draft%nodes%items(i) > 0) call nodes%add(draft%nodes%items(i))
      end do
      reader%omitted_first(n + 1) = nodes%n + 1
    end do
    reader%omitted_nodes = nodes%trimmed()
  end subroutine store_omitted_nodes

end module amontons_deck_mesh
