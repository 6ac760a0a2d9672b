!> USER ELEMENT and UEL PROPERTY to kinds, properties and unknowns of user elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_user_elements
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_containers, only: integer_list_type
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_real, read_integer, is_card
  use amontons_element_drafts, only: element_draft_type, NOT_GIVEN
  use amontons_element_kinds, only: KIND_USER, MAX_ELEMENT_NODES
  use amontons_mesh, only: mesh_type, append_nodes
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_steps, only: step_type, SOLVER_GRADIENTS
  use amontons_text, only: to_text, plural, parse_integer, NUMBER_OK
  use amontons_user_elements, only: user_kind_type, user_properties_type, user_element_type, user_elements_type, user_kind_number, &
    N_UEL_ENERGIES
  implicit none
  private
  public :: read_user_kinds, read_user_properties, beam_kind, mark_user_directions, connect_user_elements, check_user_element_step

contains

  !> All USER ELEMENT cards, before the elements are read. Without such a card the model has no user elements.
  subroutine read_user_kinds(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(user_kind_type) :: kind
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: c
    logical :: is_ok, has_temperature
    has_temperature = .false.
    reader%bad_user_kinds = [integer ::]
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'TEMPERATURE')) has_temperature = .true.
      if (is_card(reader, c, 'INITIALCONDITIONS')) then
        call open_card(reader, c, parameters, row)
        if (parameter_word(parameters, 'TYPE', '') == 'TEMPERATURE') has_temperature = .true.
      end if
      if (.not. is_card(reader, c, 'USERELEMENT')) cycle
      if (.not. allocated(model%user_elements)) then
        allocate (model%user_elements)
        allocate (model%user_elements%kinds(0), model%user_elements%properties(0), model%user_elements%elements(0))
      end if
      call read_user_kind(reader, model, c, kind, is_ok)
      if (is_ok) call add_user_kind(reader, kind, model%user_elements)
      if (.not. is_ok) reader%bad_user_kinds = [reader%bad_user_kinds, kind%number]
    end do
    if (allocated(model%user_elements)) model%user_elements%has_temperature = has_temperature
  end subroutine read_user_kinds


  !> Adds a kind; the same one again, of a part with several instances, is one kind.
  subroutine add_user_kind(reader, kind, user_elements)
    type(reader_type), intent(inout) :: reader
    type(user_kind_type), intent(in) :: kind
    type(user_elements_type), intent(inout) :: user_elements
    logical :: is_same
    integer :: i
    i = findloc(user_elements%kinds%number, kind%number, dim=1)
    if (i == 0) then
      user_elements%kinds = [user_elements%kinds, kind]
      return
    end if
    associate (old => user_elements%kinds(i))
      is_same = size(old%dof) == size(kind%dof) .and. (old%is_unsymmetric .eqv. kind%is_unsymmetric) .and. &
        all([old%n_nodes, old%n_coordinates, old%n_reals, old%n_integers, old%n_svars] == &
        [kind%n_nodes, kind%n_coordinates, kind%n_reals, kind%n_integers, kind%n_svars])
      if (is_same) is_same = all(old%dof == kind%dof .and. old%node == kind%node)
    end associate
    if (.not. is_same) call report_error(reader, kind%line, 'The type U' // to_text(kind%number) // ' is defined twice, here ' // &
      'in another way.')
  end subroutine add_user_kind


  !> One USER ELEMENT card.
  subroutine read_user_kind(reader, model, c, kind, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(user_kind_type), intent(out) :: kind
    logical, intent(out) :: is_ok
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    is_ok = .true.
    call open_card(reader, c, parameters, row)
    kind%line = reader%cards%cards(c)%line
    associate (line => kind%line)
      kind%number = user_kind_number(parameter_word(parameters, 'TYPE', ''))
      if (model%dialect == DIALECT_CALCULIX) then
        call read_calculix_kind()
        return
      end if
      if (kind%number == 0 .and. has_parameter(parameters, 'TYPE')) call refuse('TYPE must be U1 to U9999; it is ' // &
        parameter_word(parameters, 'TYPE', '') // '.')
      call read_count(reader, parameters, line, 'NODES', 1, kind%n_nodes, is_ok)
      call read_count(reader, parameters, line, 'COORDINATES', 0, kind%n_coordinates, is_ok, 1)
      call read_count(reader, parameters, line, 'PROPERTIES', 0, kind%n_reals, is_ok, 0)
      call read_count(reader, parameters, line, 'IPROPERTIES', 0, kind%n_integers, is_ok, 0)
      call read_count(reader, parameters, line, 'VARIABLES', 1, kind%n_svars, is_ok, 1)
      if (has_parameter(parameters, 'VAR')) call read_count(reader, parameters, line, 'VAR', 1, kind%n_svars, is_ok)
      if (kind%n_nodes > MAX_ELEMENT_NODES) call refuse('An element has at most ' // to_text(MAX_ELEMENT_NODES) // &
        ' nodes here; NODES is ' // to_text(kind%n_nodes) // '.')
      if (kind%n_coordinates > 3) call refuse('COORDINATES must be 1, 2 or 3.')
    end associate
    kind%is_unsymmetric = has_parameter(parameters, 'UNSYMM')
    if (is_ok) call read_unknowns(reader, row, kind, is_ok)
    if (is_ok) kind%n_coordinates = max(kind%n_coordinates, maxval([1, kind%dof], mask=[1, kind%dof] <= 3))

  contains

    !> The beam U1 of CalculiX.
    subroutine read_calculix_kind()
      if (kind%number /= 1 .or. .not. has_parameter(parameters, 'MAXDOF')) then
        call refuse('Of the user elements of CalculiX, which are compiled into it, only the beam TYPE=U1, NODES=2, ' // &
          'INTEGRATION POINTS=2, MAXDOF=6 is supported. Under the abaqus dialect *USER ELEMENT takes the routine UEL.')
      else
        kind = beam_kind(1)
        kind%line = reader%cards%cards(c)%line
      end if
    end subroutine read_calculix_kind

    !> Reports an error of the card.
    subroutine refuse(text)
      character(*), intent(in) :: text
      call report_error(reader, kind%line, text)
      is_ok = .false.
    end subroutine refuse

  end subroutine read_user_kind


  !> The kind of beams by their section: two nodes with displacements and rotations.
  pure function beam_kind(number) result(kind)
    integer, intent(in) :: number                !< JTYPE
    type(user_kind_type) :: kind
    integer :: k
    kind%number = number
    kind%n_nodes = 2
    kind%n_svars = 0
    kind%is_beam = .true.
    kind%node = [(1, k=1, 6), (2, k=1, 6)]
    kind%dof = [1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6]
  end function beam_kind


  !> A parameter that is a count.
  subroutine read_count(reader, parameters, line, name, least, value, is_ok, default)
    type(reader_type), intent(inout) :: reader
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(in) :: line                  !< of the card
    character(*), intent(in) :: name
    integer, intent(in) :: least                 !< smallest value
    integer, intent(inout) :: value
    logical, intent(inout) :: is_ok
    integer, intent(in), optional :: default     !< of an optional parameter
    integer :: status
    if (present(default)) value = default
    if (.not. has_parameter(parameters, name)) then
      if (.not. present(default)) is_ok = .false.   ! a required one, which is reported with the parameters
      return
    end if
    call parse_integer(parameter_text(parameters, name), value, status)
    if (status /= NUMBER_OK) then                ! reported with the parameters
      is_ok = .false.
    else if (value < least) then
      call report_error(reader, line, name // ' must be ' // to_text(least) // ' or more; it is ' // to_text(value) // '.')
      is_ok = .false.
    end if
  end subroutine read_count


  !> The unknowns of a kind: the degrees of freedom of the first node; in later lines a node of the element and those from it on. A
  !! line for a node that is not behind that of the line before begins a further list, which follows the unknowns before it.
  subroutine read_unknowns(reader, row, kind, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row    !< before the data lines
    type(user_kind_type), intent(inout) :: kind
    logical, intent(inout) :: is_ok
    type(integer_list_type) :: nodes, dofs
    integer, allocatable :: list(:), next(:)
    integer :: first, place, a
    list = [integer ::]
    first = 1
    place = 1
    do while (next_row(reader%cards, row))
      if (size(list) > 0) call read_integer(reader, row, 1, 'node of the element', place, is_ok)
      call read_dof_list(reader, row, merge(2, 1, size(list) > 0), next, is_ok)
      if (is_ok .and. (place < 1 .or. place > kind%n_nodes)) then
        call report_error(reader, row%line, 'The first field must be a node of the element, 1 to ' // to_text(kind%n_nodes) // &
          ', from which on it has other degrees of freedom.')
        is_ok = .false.
      end if
      if (.not. is_ok) return
      call close_list(merge(place - 1, kind%n_nodes, place > first))
      first = place
      list = next
    end do
    if (size(list) == 0) then
      call report_error(reader, kind%line, 'The data lines are missing: the degrees of freedom of the nodes.')
      is_ok = .false.
      return
    end if
    call close_list(kind%n_nodes)
    kind%node = nodes%trimmed()
    kind%dof = dofs%trimmed()

  contains

    !> Appends the unknowns of the present list, up to a node.
    subroutine close_list(last)
      integer, intent(in) :: last
      integer :: k
      if (size(list) == 0) return
      do a = first, last
        do k = 1, size(list)
          call nodes%add(a)
          call dofs%add(list(k))
        end do
      end do
    end subroutine close_list

  end subroutine read_unknowns


  !> Degrees of freedom of a data line.
  subroutine read_dof_list(reader, row, from, list, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: from                  !< first field
    integer, allocatable, intent(out) :: list(:)
    logical, intent(inout) :: is_ok
    integer :: i, dof
    list = [integer ::]
    do i = from, row%n
      call read_integer(reader, row, i, 'degree of freedom', dof, is_ok)
      if (.not. is_ok) return
      if (dof < 1 .or. dof > 6) then
        call report_error(reader, row%line, 'The degree of freedom ' // to_text(dof) // ' is not one of 1 to 6, displacements ' // &
          'and rotations. Another field may use a free one of these: UEL gives it its meaning.')
        is_ok = .false.
        return
      end if
      list = [list, dof]
    end do
    if (size(list) > 0) return
    call report_error(reader, row%line, 'The degrees of freedom are missing.')
    is_ok = .false.
  end subroutine read_dof_list


  !> All UEL PROPERTY cards. The members of the element sets are indices of drafts here.
  subroutine read_user_properties(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model     !< with the element sets of drafts
    type(element_draft_type), intent(inout) :: draft
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    type(user_properties_type) :: properties
    integer :: c, set, e
    if (allocated(model%user_elements)) then
      do e = 1, draft%n
        if (draft%user_kind(e) == 0) cycle
        associate (kind => model%user_elements%kinds(draft%user_kind(e)))
          if (kind%n_reals + kind%n_integers > 0 .or. (kind%is_beam .and. draft%user_properties(e) == 0)) &
            draft%section_value(e) = NOT_GIVEN
        end associate
      end do
    end if
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'UELPROPERTY')) cycle
      call open_card(reader, c, parameters, row)
      if (.not. has_parameter(parameters, 'ELSET')) cycle   ! reported with the parameters
      set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
      if (set == 0) then
        call report_error(reader, reader%cards%cards(c)%line, 'There is no element set ''' // &
          parameter_text(parameters, 'ELSET') // '''' // reader%element_sets%suggest(parameter_text(parameters, 'ELSET')))
        cycle
      end if
      associate (members => model%mesh%element_sets(set)%members)
        if (any(draft%user_kind(members) == 0) .and. size(reader%bad_user_kinds) > 0) then
          cycle                                  ! the card of their type has errors
        else if (any(draft%user_kind(members) == 0)) then
          e = findloc(draft%user_kind(members) == 0, .true., dim=1)
          call report_error(reader, reader%cards%cards(c)%line, 'The element ' // to_text(draft%label(members(e))) // &
            ' is no user element (*USER ELEMENT).')
        else if (size(members) > 0) then
          draft%section_value(members) = 1
          draft%section_card(members) = c
          if (any(draft%user_kind(members) /= draft%user_kind(members(1)))) then
            call report_error(reader, reader%cards%cards(c)%line, 'The set ''' // parameter_text(parameters, 'ELSET') // &
              ''' holds user elements of different types. Give each type its *UEL PROPERTY.')
            cycle
          end if
          call read_property_values(reader, c, row, model%user_elements%kinds(draft%user_kind(members(1))), properties)
          model%user_elements%properties = [model%user_elements%properties, properties]
          draft%user_properties(members) = size(model%user_elements%properties)
        end if
      end associate
    end do
  end subroutine read_user_properties


  !> The values of UEL PROPERTY: reals, then integers, in any number of lines.
  subroutine read_property_values(reader, c, row, kind, properties)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row    !< before the data lines
    type(user_kind_type), intent(in) :: kind
    type(user_properties_type), intent(out) :: properties
    integer :: i, k
    logical :: is_ok
    allocate (properties%reals(kind%n_reals), source=0.0_DP)
    allocate (properties%integers(kind%n_integers), source=0)
    is_ok = .true.
    i = 0
    do while (next_row(reader%cards, row))
      do k = 1, row%n
        i = i + 1
        if (i <= kind%n_reals) then
          call read_real(reader, row, k, 'property', properties%reals(i), is_ok)
        else if (i <= kind%n_reals + kind%n_integers) then
          call read_integer(reader, row, k, 'integer property', properties%integers(i - kind%n_reals), is_ok)
        end if
      end do
    end do
    if (is_ok .and. i /= kind%n_reals + kind%n_integers) call report_error(reader, reader%cards%cards(c)%line, &
      '*USER ELEMENT, TYPE=U' // to_text(kind%number) // ' has PROPERTIES=' // to_text(kind%n_reals) // ' and I PROPERTIES=' // &
      to_text(kind%n_integers) // '; here ' // merge('is ', 'are', i == 1) // ' ' // plural(i, 'value') // '.')
  end subroutine read_property_values


  !> The displacements that user elements stiffen, before the mesh is finished.
  subroutine mark_user_directions(draft, model)
    type(element_draft_type), intent(in) :: draft
    type(model_type), intent(inout) :: model     !< with the elements of the mesh
    integer :: e, k
    if (.not. any(draft%user_kind > 0)) return
    associate (mesh => model%mesh)
      allocate (mesh%user_directions(3, size(mesh%nodes)), source=.false.)
      do e = 1, draft%n
        if (draft%user_kind(e) == 0 .or. draft%mesh_index(e) == 0) cycle
        associate (kind => model%user_elements%kinds(draft%user_kind(e)), first => mesh%first(draft%mesh_index(e)))
          do k = 1, size(kind%dof)
            if (kind%dof(k) <= 3) mesh%user_directions(kind%dof(k), first + kind%node(k) - 1) = .true.
          end do
        end associate
      end do
    end associate
  end subroutine mark_user_directions


  !> The user elements of the model, with rotation nodes for degrees of freedom 4 to 6. After all cards that create nodes.
  subroutine connect_user_elements(draft, model)
    type(element_draft_type), intent(in) :: draft
    type(model_type), intent(inout) :: model
    integer, allocatable :: drafts(:)
    integer :: e, i, memory
    if (.not. allocated(model%user_elements)) return
    drafts = pack([(e, e=1, draft%n)], draft%user_kind > 0 .and. draft%mesh_index > 0)
    drafts = pack(drafts, [(has_all_nodes(model%mesh, draft%mesh_index(drafts(i))), i=1, size(drafts))])
    if (size(drafts) == 0) then
      deallocate (model%user_elements)
      return
    end if
    call create_rotation_nodes(draft, drafts, model)
    memory = 0
    deallocate (model%user_elements%elements)
    allocate (model%user_elements%elements(size(drafts)))
    do i = 1, size(drafts)
      associate (element => model%user_elements%elements(i), kind => model%user_elements%kinds(draft%user_kind(drafts(i))))
        element%element = draft%mesh_index(drafts(i))
        element%kind = draft%user_kind(drafts(i))
        element%properties = draft%user_properties(drafts(i))
        element%memory = memory
        memory = memory + kind%n_svars + N_UEL_ENERGIES
        call place_unknowns(model, kind, element)
      end associate
    end do
    model%user_elements%n_memory = memory
  end subroutine connect_user_elements


  !> Whether the deck defines all nodes of an element; else an error was reported.
  pure logical function has_all_nodes(mesh, e)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                     !< element
    has_all_nodes = all(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1) > 0)
  end function has_all_nodes


  !> Reports what a step with user elements cannot be.
  subroutine check_user_element_step(reader, line, user_elements, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of its STEP card
    type(user_elements_type), intent(in) :: user_elements
    type(step_type), intent(in) :: step
    if (step%is_nlgeom .and. any(user_elements%kinds%is_beam)) call report_error(reader, line, 'Beams by their section ' // &
      'have small rotations: leave out NLGEOM, or take RECT, CIRC or PIPE.')
    if (step%is_riks) call report_error(reader, line, 'A RIKS step cannot have user elements: UEL would give loads too. Use ' // &
      '*STATIC with prescribed displacements.')
    if (step%is_dynamic) call report_error(reader, line, 'A *DYNAMIC step cannot have user elements: UEL does not give their ' // &
      'mass here. Use *STATIC.')
    if (step%solver == SOLVER_GRADIENTS) call report_error(reader, line, 'CONJUGATE GRADIENTS have no matrix, which user ' // &
      'elements need: leave out SOLVER.')
  end subroutine check_user_element_step


  !> A rotation node for each node with a degree of freedom 4 to 6 of a user element that has none.
  subroutine create_rotation_nodes(draft, drafts, model)
    type(element_draft_type), intent(in) :: draft
    integer, intent(in) :: drafts(:)             !< of user elements
    type(model_type), intent(inout) :: model
    logical, allocatable :: is_wanted(:)
    integer, allocatable :: nodes(:)
    integer :: i, k, n_before
    associate (mesh => model%mesh)
      n_before = mesh%n_nodes
      allocate (is_wanted(n_before), source=.false.)
      do i = 1, size(drafts)
        associate (kind => model%user_elements%kinds(draft%user_kind(drafts(i))), &
          first => mesh%first(draft%mesh_index(drafts(i))))
          do k = 1, size(kind%dof)
            if (kind%dof(k) > 3) is_wanted(mesh%nodes(first + kind%node(k) - 1)) = .true.
          end do
        end associate
      end do
      nodes = pack([(i, i=1, n_before)], is_wanted .and. model%rotation_of == 0)
      if (size(nodes) == 0) return
      call append_nodes(mesh, mesh%coordinates(:, nodes))
      mesh%is_auxiliary(n_before + 1:) = .true.
      model%rotation_of = [model%rotation_of, spread(0, 1, size(nodes))]
      model%rotation_of(nodes) = n_before + [(i, i=1, size(nodes))]
      if (allocated(model%frame_of)) model%frame_of = [model%frame_of, model%frame_of(nodes)]
    end associate
  end subroutine create_rotation_nodes


  !> The nodes and the places of the unknowns of an element.
  subroutine place_unknowns(model, kind, element)
    type(model_type), intent(in) :: model
    type(user_kind_type), intent(in) :: kind
    type(user_element_type), intent(inout) :: element
    integer :: k, node, i
    allocate (element%place(size(kind%dof)))
    element%nodes = [integer ::]
    do k = 1, size(kind%dof)
      node = model%mesh%nodes(model%mesh%first(element%element) + kind%node(k) - 1)
      if (kind%dof(k) > 3) node = model%rotation_of(node)
      i = findloc(element%nodes, node, dim=1)
      if (i == 0) then
        element%nodes = [element%nodes, node]
        i = size(element%nodes)
      end if
      element%place(k) = 3 * i - 3 + mod(kind%dof(k) - 1, 3) + 1
    end do
  end subroutine place_unknowns

end module amontons_deck_user_elements
