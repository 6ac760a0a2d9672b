!> What supports, loads and constraints need at the nodes of shells and beams: found before the expansion.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_named_nodes
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text, field_integer
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_containers, only: integer_list_type
  use amontons_element_drafts, only: element_draft_type
  use amontons_element_kinds, only: element_kind_type, element_kind, FAMILY_SOLID, FAMILY_SPRING, FAMILY_MASS
  use amontons_deck_reader, only: reader_type, support_dofs, open_card, is_card
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_text, only: parse_integer, is_one_of, name_key, NUMBER_OK
  implicit none
  private
  public :: find_turned_nodes, find_constrained_nodes

contains

  !> The nodes at which supports, moments, rigid bodies, couplings or user elements need rotations.
  subroutine find_turned_nodes(reader, draft, model)
    type(reader_type), intent(in) :: reader
    type(element_draft_type), intent(in) :: draft
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: c
    integer, allocatable :: nodes(:)
    logical :: is_follower, turns_all
    turns_all = any([(is_card(reader, c, 'TRANSFORM'), c=1, reader%cards%n_cards)])
    do c = 1, reader%cards%n_cards
      if (turns_all) exit
      if (.not. is_card(reader, c, 'STEP')) cycle
      call open_card(reader, c, parameters, row)
      turns_all = has_parameter(parameters, 'NLGEOM')
    end do
    allocate (model%structure%is_turned(model%mesh%n_nodes), model%structure%is_follower(model%mesh%n_nodes), source=.false.)
    allocate (model%structure%is_driven(3, model%mesh%n_nodes), source=.false.)
    allocate (model%structure%held_from(6, model%mesh%n_nodes), source=0)
    associate (is_turned => model%structure%is_turned)
      do c = 1, reader%cards%n_cards
        if (is_card(reader, c, 'RIGIDBODY') .or. is_card(reader, c, 'COUPLING') .or. is_card(reader, c, 'KINEMATICCOUPLING')) then
          call open_card(reader, c, parameters, row)
          nodes = named_nodes(reader, model, parameter_text(parameters, 'REF NODE'))
          is_turned(nodes) = .true.
          model%structure%is_driven(:, nodes) = .true.
        else if (is_card(reader, c, 'MPC') .and. model%dialect /= DIALECT_CALCULIX) then
          call note_mpc(reader, model, c)
        else if (is_card(reader, c, 'BOUNDARY') .or. is_card(reader, c, 'CLOAD')) then
          call open_card(reader, c, parameters, row)
          is_follower = has_parameter(parameters, 'FOLLOWER') .and. model%dialect /= DIALECT_CALCULIX
          do while (next_row(reader%cards, row))
            call note_dofs(reader, model, c, row, turns_all)
            if (is_follower) model%structure%is_follower(named_nodes(reader, model, field_text(reader%cards, row, 1))) = .true.
          end do
        end if
      end do
      is_turned = is_turned .or. model%structure%is_follower
      do c = 1, draft%n
        if (draft%user_kind(c) == 0 .or. draft%mesh_index(c) == 0) cycle
        nodes = user_rotation_nodes(model, draft%user_kind(c), draft%mesh_index(c))
        is_turned(nodes) = .true.
        model%structure%is_driven(:, nodes) = .true.
      end do
      call find_rotation_terms(reader, model)
      do c = 1, size(model%structure%rotation_terms, 2)
        is_turned(model%structure%rotation_terms(2, c)) = .true.
      end do
    end associate
  end subroutine find_turned_nodes


  !> The second nodes of MPC, BEAM and TIE: the first ones turn with them.
  subroutine note_mpc(reader, model, c)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    call open_card(reader, c, parameters, row)
    do while (next_row(reader%cards, row))
      if (.not. is_one_of(name_key(field_text(reader%cards, row, 1)), 'BEAM|TIE')) cycle
      nodes = named_nodes(reader, model, field_text(reader%cards, row, 3))
      model%structure%is_turned(nodes) = .true.
      model%structure%is_driven(:, nodes) = .true.
    end do
  end subroutine note_mpc


  !> The nodes of a user element, as that of a beam by its section, whose rotations are unknowns of it.
  pure function user_rotation_nodes(model, kind, element) result(nodes)
    type(model_type), intent(in) :: model
    integer, intent(in) :: kind                  !< index into the kinds of user elements
    integer, intent(in) :: element               !< of the mesh
    integer, allocatable :: nodes(:)
    associate (unknowns => model%user_elements%kinds(kind))
      nodes = model%mesh%nodes(model%mesh%first(element) - 1 + pack(unknowns%node, unknowns%dof > 3))
    end associate
    nodes = pack(nodes, nodes > 0)
  end function user_rotation_nodes


  !> The rotations that EQUATION cards name. Malformed rows end a card; their errors are reported where equations are read.
  subroutine find_rotation_terms(reader, model)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(integer_list_type) :: entries
    integer :: c, n_equations, n_copies, n_left, status
    n_equations = 0
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'EQUATION')) cycle
      call open_card(reader, c, parameters, row)
      if (has_parameter(parameters, 'REMOVE')) cycle
      status = NUMBER_OK
      do while (status == NUMBER_OK)
        if (.not. next_row(reader%cards, row)) exit
        call field_integer(reader%cards, row, 1, n_left, status)
        n_copies = 1
        do while (n_left > 0 .and. status == NUMBER_OK)
          if (.not. next_row(reader%cards, row)) exit
          call add_rotation_terms(reader, model, row, n_equations, entries, n_copies, status)
          n_left = n_left - row%n / 3
        end do
        n_equations = n_equations + n_copies
      end do
    end do
    model%structure%rotation_terms = reshape(entries%trimmed(), [3, entries%n / 3])
  end subroutine find_rotation_terms


  !> Adds the rotations of one row of an equation, for each node of a set.
  subroutine add_rotation_terms(reader, model, row, n_equations, entries, n_copies, status)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: n_equations           !< equations before this one
    type(integer_list_type), intent(inout) :: entries   !< number of the equation, node, direction; ...
    integer, intent(inout) :: n_copies           !< equations of this one: the nodes of its largest set so far
    integer, intent(out) :: status               !< not NUMBER_OK: malformed
    integer, allocatable :: nodes(:)
    integer :: i, k, dof
    status = merge(NUMBER_OK, NUMBER_OK + 1, row%n >= 3)
    do i = 1, row%n - 2, 3
      call field_integer(reader%cards, row, i + 1, dof, status)
      if (status /= NUMBER_OK) return
      nodes = named_nodes(reader, model, field_text(reader%cards, row, i))
      n_copies = max(n_copies, size(nodes))
      if (dof < 4 .or. dof > 6) cycle
      do k = 1, size(nodes)
        call entries%add(n_equations + k)
        call entries%add(nodes(k))
        call entries%add(dof - 3)
      end do
    end do
  end subroutine add_rotation_terms


  !> Marks the nodes of a row of BOUNDARY or CLOAD whose rotations it names, and the degrees of freedom that BOUNDARY prescribes.
  subroutine note_dofs(reader, model, c, row, turns_all)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(in) :: row
    logical, intent(in) :: turns_all             !< TRANSFORM or NLGEOM: a moment may get parts along all axes of a fibre
    integer, allocatable :: nodes(:)
    logical :: is_named(6)
    integer :: first, last, status, i, k
    call field_integer(reader%cards, row, 2, first, status)
    if (status == NUMBER_OK) then
      last = 0
      if (is_card(reader, c, 'BOUNDARY')) call field_integer(reader%cards, row, 3, last, status)
      if (last == 0) last = first
      is_named = [(k >= first .and. k <= last, k=1, 6)]
    else
      is_named = support_dofs(field_text(reader%cards, row, 2))
    end if
    nodes = named_nodes(reader, model, field_text(reader%cards, row, 1))
    if (any(is_named(4:))) model%structure%is_turned(nodes) = .true.
    if (.not. is_card(reader, c, 'BOUNDARY')) then
      if (turns_all) is_named(4:) = any(is_named(4:))
      do i = 1, size(nodes)
        model%structure%is_driven(:, nodes(i)) = model%structure%is_driven(:, nodes(i)) .or. is_named(4:)
      end do
      return
    end if
    do i = 1, size(nodes)
      where (is_named .and. model%structure%held_from(:, nodes(i)) == 0) model%structure%held_from(:, nodes(i)) = &
        max(1, reader%step_of_card(c))
    end do
  end subroutine note_dofs


  !> The nodes of a set, or the node of a number; none if the name is unknown.
  function named_nodes(reader, model, name) result(nodes)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(in) :: model
    character(*), intent(in) :: name
    integer, allocatable :: nodes(:)
    integer :: set, label, status
    nodes = [integer ::]
    set = reader%node_sets%find(name)
    call parse_integer(name, label, status)
    if (set > 0) then
      nodes = model%mesh%node_sets(set)%members
    else if (status == NUMBER_OK) then
      nodes = pack([reader%node_labels%find(label)], [reader%node_labels%find(label) > 0])
    end if
  end function named_nodes


  !> In the calculix dialect: the displacements of nodes of shells and beams that rigid bodies, couplings, equations, surfaces of
  !! nodes or other elements constrain. CalculiX ties them to the outer nodes of the fibre alone.
  subroutine find_constrained_nodes(reader, model)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(inout) :: model     !< with structure%section; out: structure%is_constrained
    type(element_kind_type) :: entry
    integer :: c, e
    allocate (model%structure%is_constrained(3, model%mesh%n_nodes), source=.false.)
    if (model%dialect /= DIALECT_CALCULIX) return
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'EQUATION')) call note_equations(reader, model, c)
      if (is_card(reader, c, 'RIGIDBODY') .or. is_card(reader, c, 'COUPLING')) call note_body(reader, model, c)
      if (is_card(reader, c, 'MPC') .or. is_card(reader, c, 'SURFACE')) call note_rows(reader, model, c)
    end do
    do e = 1, model%mesh%n_elements
      entry = element_kind(model%mesh%kind(e))
      if (all(entry%family /= [FAMILY_SOLID, FAMILY_SPRING, FAMILY_MASS]) .or. model%structure%section(e) > 0) cycle
      model%structure%is_constrained(:, model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1)) = .true.
    end do
  end subroutine find_constrained_nodes


  !> The nodes of a rigid body, and the reference node of one or of a coupling.
  subroutine note_body(reader, model, c)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    character(*), parameter :: NAMES(3) = [character(8) :: 'NSET', 'PIN NSET', 'REF NODE']
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    call open_card(reader, c, parameters, row)
    do i = 1, size(NAMES)
      model%structure%is_constrained(:, named_nodes(reader, model, parameter_text(parameters, trim(NAMES(i))))) = .true.
    end do
  end subroutine note_body


  !> The nodes of MPC, and those of surfaces of nodes.
  subroutine note_rows(reader, model, c)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    call open_card(reader, c, parameters, row)
    if (is_card(reader, c, 'SURFACE') .and. parameter_word(parameters, 'TYPE', 'ELEMENT') /= 'NODE') return
    do while (next_row(reader%cards, row))
      do i = 1, merge(row%n, 1, is_card(reader, c, 'MPC'))
        model%structure%is_constrained(:, named_nodes(reader, model, field_text(reader%cards, row, i))) = .true.
      end do
    end do
  end subroutine note_rows


  !> The displacements that an EQUATION card names. Malformed rows end it; their errors are reported where equations are read.
  subroutine note_equations(reader, model, c)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: i, dof, n_left, status
    call open_card(reader, c, parameters, row)
    if (has_parameter(parameters, 'REMOVE')) return
    n_left = 0
    do while (next_row(reader%cards, row))
      if (n_left <= 0) then                      ! the number of terms
        call field_integer(reader%cards, row, 1, n_left, status)
        if (status /= NUMBER_OK) return
        cycle
      end if
      do i = 1, row%n - 2, 3
        call field_integer(reader%cards, row, i + 1, dof, status)
        if (status /= NUMBER_OK) return
        if (dof >= 1 .and. dof <= 3) model%structure%is_constrained(dof, &
          named_nodes(reader, model, field_text(reader%cards, row, i))) = .true.
      end do
      n_left = n_left - max(1, row%n / 3)
    end do
  end subroutine note_equations

end module amontons_deck_named_nodes
