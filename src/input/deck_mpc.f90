!> MPC, DISTRIBUTING COUPLING and CYCLIC SYMMETRY MODEL to constraints and equations, and shared procedures of such cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_mpc
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text, field_integer
  use amontons_deck_reader, only: reader_type, open_card, report_error, nodes_of_field, read_real, check_n_fields, is_card, &
    check_no_data
  use amontons_model, only: model_type, append_equation, append_mpc, gather_constraints, DIALECT_CALCULIX
  use amontons_structural_data, only: expanded_nodes
  use amontons_tensor, only: cross_product, IDENTITY
  use amontons_text, only: is_one_of, name_key, to_text, NUMBER_OK, parse_integer
  use amontons_mpc_data, only: nonlinear_mpc_type, distributing_coupling_type, MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE, &
    MPC_MEAN_ROTATION
  use amontons_card_schema, only: parameter_text
  implicit none
  private
  public :: read_mpc, read_next_mpc, unique_nodes, make_rotation_node
  public :: read_distributing_couplings, read_weighted_coupling
  public :: read_cyclic_symmetry

contains

  !> MPC: kind and nodes, in one row or several. Ropes (DIST) are read elsewhere.
  subroutine read_mpc(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    character(:), allocatable :: kind
    integer :: line, n_nodes, n_of(3), i
    logical :: is_ok, has_row
    call open_card(reader, c, parameters, row)
    has_row = next_row(reader%cards, row)
    do while (has_row)
      n_of = [(count_field_nodes(reader, model, row, i), i=2, 4)]
      call read_next_mpc(reader, model, row, '', has_row, kind, nodes, line, is_ok)
      if (.not. is_ok .or. kind == 'DIST') cycle
      n_nodes = 0
      if (is_one_of(kind, 'BEAM|LINK|TIE|PIN')) n_nodes = 2
      if (kind == 'LINEAR') n_nodes = 3
      if (n_nodes > 0 .and. size(nodes) > n_nodes) then
        n_of(n_nodes) = size(nodes) - sum(n_of(:n_nodes - 1))   ! also those of further rows
        call add_groups(reader, model, line, kind, nodes, n_of(:n_nodes))
      else
        call add_mpc(reader, model, line, kind, nodes)
      end if
    end do
  end subroutine read_mpc


  !> The number of nodes that a field names: those of a set, else one.
  pure integer function count_field_nodes(reader, model, row, i) result(n)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: i                     !< field
    integer :: set
    n = 1
    set = reader%node_sets%find(field_text(reader%cards, row, i))
    if (set > 0) n = size(model%mesh%node_sets(set)%members)
  end function count_field_nodes


  !> Kinds of two or three nodes over sets, as Abaqus expands them: each node of the first set with those of the same place in the
  !! other ones, or with the one node of a field.
  subroutine add_groups(reader, model, line, kind, nodes, n_of)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line
    character(*), intent(in) :: kind             !< squeezed
    integer, intent(in) :: nodes(:)              !< those of the first field, of the second one, ...
    integer, intent(in) :: n_of(:)               !< nodes of each field
    character(:), allocatable :: numbers
    integer :: group(size(n_of))
    integer :: i, k
    if (any(n_of(2:) /= 1 .and. n_of(2:) /= n_of(1))) then
      numbers = to_text(n_of(1))
      do k = 2, size(n_of)
        numbers = numbers // trim(merge(' and', ',   ', k == size(n_of))) // ' ' // to_text(n_of(k))
      end do
      call report_error(reader, line, kind // ' binds nodes ' // trim(merge('two by two    ', 'three by three', &
        size(n_of) == 2)) // ': give ' // trim(merge('two  ', 'three', size(n_of) == 2)) // ' nodes, sets of as many ' // &
        'nodes, or a set first and then nodes. Here are ' // numbers // '.')
      return
    end if
    do i = 1, n_of(1)
      group = [(nodes(sum(n_of(:k - 1)) + min(i, n_of(k))), k=1, size(n_of))]
      if (.not. any(group(2:) == group(1))) call add_mpc(reader, model, line, kind, group)
    end do
  end subroutine add_groups


  !> The next constraint of a card: its first row, and those after it that begin with a number or a set.
  subroutine read_next_mpc(reader, model, row, wanted, has_row, kind, nodes, line, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(inout) :: row         !< in: its first row; out: that of the one after it
    character(*), intent(in) :: wanted           !< only of this kind nodes are read; empty: of all but DIST
    logical, intent(inout) :: has_row            !< out: whether there is one after it
    character(:), allocatable, intent(out) :: kind   !< squeezed
    integer, allocatable, intent(out) :: nodes(:)
    integer, intent(out) :: line                 !< of its first row
    logical, intent(out) :: is_ok                !< .false.: a node does not exist; its error is reported
    integer, allocatable :: found(:)
    integer :: i, label, status
    logical :: is_read
    allocate (nodes(0))
    is_ok = .true.
    kind = name_key(field_text(reader%cards, row, 1))
    line = row%line
    is_read = kind == wanted .or. (wanted == '' .and. kind /= 'DIST')
    i = 2
    do
      do while (i <= row%n .and. is_read)
        if (name_key(field_text(reader%cards, row, i)) /= '') then
          call nodes_of_field(reader, model%mesh, row, i, found, is_ok)
          nodes = [nodes, found]
        end if
        i = i + 1
      end do
      has_row = next_row(reader%cards, row)
      if (.not. has_row) exit
      call field_integer(reader%cards, row, 1, label, status)
      if (status /= NUMBER_OK .and. reader%node_sets%find(field_text(reader%cards, row, 1)) == 0) exit
      i = 1
    end do
  end subroutine read_next_mpc


  !> The nonlinear constraints of one MPC.
  subroutine add_mpc(reader, model, line, kind, given)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line
    character(*), intent(in) :: kind             !< squeezed
    integer, intent(in) :: given(:)              !< nodes as written in the deck
    type(nonlinear_mpc_type) :: mpc
    integer, allocatable :: nodes(:)
    integer :: i
    nodes = unique_nodes(given)
    if (kind == 'PLANE') call order_spanning_nodes(model, nodes)
    mpc%card = 'MPC'
    mpc%line = reader%cards%line_number(line)
    if (allocated(model%structure) .and. is_one_of(kind, 'BEAM|TIE')) then
      if (size(expanded_nodes(model%structure, nodes)) > size(nodes)) then
        call bind_rotations(reader, model, line, kind, nodes, mpc)
        return
      end if
    end if
    select case (kind)
    case ('PLANE', 'STRAIGHT')
      mpc%kind = merge(MPC_PLANE, MPC_STRAIGHT, kind == 'PLANE')
      if (.not. is_spanning(model, nodes, kind)) then
        call report_error(reader, line, 'PLANE needs three nodes that are not on a line and more, STRAIGHT two nodes that ' // &
          'are apart and more.')
        return
      end if
      do i = merge(4, 3, kind == 'PLANE'), size(nodes)
        mpc%node = [nodes(i), nodes(:merge(3, 2, kind == 'PLANE'))]
        call append_mpc(model, mpc)
      end do
    case ('BEAM', 'LINK')
      call add_beam(reader, model, line, nodes, mpc, is_link=kind == 'LINK')
    case ('TIE', 'PIN')
      call add_pin(reader, model, line, nodes)
    case ('MEANROT')
      call add_mean_rotation(reader, model, line, nodes, mpc)
    case ('LINEAR')
      call add_interpolation(reader, model, line, nodes)
    case default
      call report_error(reader, line, 'The MPC ' // kind // ' is not supported; known are PLANE, STRAIGHT, BEAM, LINK, TIE, ' // &
        'PIN, LINEAR, MEANROT and DIST.')
    end select
  end subroutine add_mpc


  !> Of the nodes of a plane the first three must not be on a line: the third becomes the one farthest from the line of the first
  !! and the one farthest from it, if they are.
  pure subroutine order_spanning_nodes(model, nodes)
    type(model_type), intent(in) :: model
    integer, intent(inout) :: nodes(:)
    real(DP) :: way(3), across(size(nodes))
    integer :: i, k
    if (size(nodes) < 4) return
    if (is_spanning(model, nodes, 'PLANE')) return
    associate (x => model%mesh%coordinates)
      k = maxloc([(norm2(x(:, nodes(i)) - x(:, nodes(1))), i=1, size(nodes))], dim=1)
      nodes([2, k]) = nodes([k, 2])
      way = x(:, nodes(2)) - x(:, nodes(1))
      across = [(norm2(cross_product(way, x(:, nodes(i)) - x(:, nodes(1)))), i=1, size(nodes))]
      k = maxloc(across, dim=1)
      if (k > 3) nodes([3, k]) = nodes([k, 3])
    end associate
  end subroutine order_spanning_nodes


  !> Whether the first nodes span a plane or a line.
  pure logical function is_spanning(model, nodes, kind)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    character(*), intent(in) :: kind
    is_spanning = .false.
    if (size(nodes) < merge(4, 3, kind == 'PLANE')) return
    associate (x => model%mesh%coordinates(:, nodes(:3)))
      is_spanning = norm2(x(:, 2) - x(:, 1)) > 0.0_DP
      if (kind == 'PLANE') is_spanning = norm2(cross_product(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))) > &
        1.0e-6_DP * norm2(x(:, 2) - x(:, 1)) * norm2(x(:, 3) - x(:, 1))
    end associate
  end function is_spanning


  !> Nodes in their order, each once.
  pure function unique_nodes(given) result(nodes)
    integer, intent(in) :: given(:)
    integer, allocatable :: nodes(:)
    integer :: i
    nodes = pack(given, [(.not. any(given(:i - 1) == given(i)), i=1, size(given))])
  end function unique_nodes


  !> LINK, and BEAM in CalculiX: two nodes keep their distance. BEAM in Abaqus: the first is rigidly attached to the second.
  subroutine add_beam(reader, model, line, nodes, mpc, is_link)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line, nodes(:)
    type(nonlinear_mpc_type), intent(inout) :: mpc
    logical, intent(in) :: is_link
    if (size(nodes) /= 2) then
      call report_error(reader, line, 'BEAM and LINK need two nodes.')
    else if (is_link .or. reader%dialect == DIALECT_CALCULIX) then
      mpc%kind = MPC_DISTANCE
      mpc%node = nodes
      call append_mpc(model, mpc)
    else
      mpc%node = nodes(:1)
      if (allocated(model%structure)) mpc%node = expanded_nodes(model%structure, mpc%node)
      mpc%reference = nodes(2)
      call make_rotation_node(model, mpc%reference, mpc%rotation)
      call append_mpc(model, mpc)
    end if
  end subroutine add_beam


  !> BEAM and TIE at nodes of shells and beams: the first node and what it expands into follow the second and its rotation.
  subroutine bind_rotations(reader, model, line, kind, nodes, mpc)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line, nodes(:)
    character(*), intent(in) :: kind
    type(nonlinear_mpc_type), intent(inout) :: mpc
    logical :: is_together
    if (reader%dialect == DIALECT_CALCULIX) then
      call report_error(reader, line, 'The MPC ' // kind // ' binds rotations; at nodes of shells and beams write *RIGID BODY ' // &
        'with TIE NSET, or *MPC, PIN for a hinge.')
      return
    end if
    is_together = size(nodes) == 2
    if (kind == 'TIE' .and. is_together) is_together = size(expanded_nodes(model%structure, nodes(2:))) > 1 .and. &
      .not. any(abs(model%mesh%coordinates(:, nodes(1)) - model%mesh%coordinates(:, nodes(2))) > 0)
    if (is_together .or. kind == 'BEAM') then
      call add_beam(reader, model, line, nodes, mpc, is_link=.false.)
    else
      call report_error(reader, line, 'TIE binds two nodes of shells or beams at one place; elsewhere write *COUPLING with ' // &
        '*KINEMATIC, 1, 6, or *MPC, PIN for a hinge.')
    end if
  end subroutine bind_rotations


  !> TIE, PIN: the first node has the displacements of the second.
  subroutine add_pin(reader, model, line, nodes)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line, nodes(:)
    integer :: k
    if (size(nodes) /= 2) then
      call report_error(reader, line, 'TIE and PIN need two nodes.')
      return
    end if
    do k = 1, 3
      call append_equation(model, nodes, [k, k], [1.0_DP, -1.0_DP], 'MPC', reader%cards%line_number(line))
    end do
  end subroutine add_pin


  !> LINEAR: the displacements of the first node are between those of the second and the third, linear in its place between them.
  subroutine add_interpolation(reader, model, line, nodes)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line, nodes(:)
    real(DP) :: way(3), part
    integer :: k
    if (size(nodes) /= 3) then
      call report_error(reader, line, 'LINEAR needs three nodes, the first between the other two.')
      return
    end if
    associate (x => model%mesh%coordinates(:, nodes))
      way = x(:, 3) - x(:, 2)
      if (.not. norm2(way) > 0.0_DP) then
        call report_error(reader, line, 'The second and the third node of LINEAR are at the same place.')
        return
      end if
      part = dot_product(x(:, 1) - x(:, 2), way) / dot_product(way, way)
    end associate
    do k = 1, 3
      call append_equation(model, nodes, [k, k, k], [1.0_DP, part - 1.0_DP, -part], 'MPC', reader%cards%line_number(line))
    end do
  end subroutine add_interpolation


  !> MEANROT: nodes, and last a pilot: its coordinates are the axis, its first displacement the mean rotation.
  subroutine add_mean_rotation(reader, model, line, nodes, mpc)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: line, nodes(:)
    type(nonlinear_mpc_type), intent(inout) :: mpc
    integer :: n
    n = size(nodes)
    if (n < 3) then
      call report_error(reader, line, 'MEANROT needs at least two nodes and the pilot.')
      return
    end if
    mpc%kind = MPC_MEAN_ROTATION
    mpc%node = nodes(:n - 1)
    mpc%reference = nodes(n)
    mpc%axis = model%mesh%coordinates(:, nodes(n))
    if (.not. norm2(mpc%axis) > 0.0_DP) then
      call report_error(reader, line, 'The coordinates of the last node of MEANROT are the axis; they must not all be zero.')
      return
    end if
    mpc%axis = mpc%axis / norm2(mpc%axis)
    model%mesh%is_auxiliary(mpc%reference) = .true.
    call append_mpc(model, mpc)
  end subroutine add_mean_rotation


  !> The rotation node of a reference node; `gather_constraints` creates those that are new. Cost: constant in the mean.
  subroutine make_rotation_node(model, reference, rotation)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: reference
    integer, intent(out) :: rotation
    rotation = model%rotation_of(reference)
    if (rotation > 0) return
    call model%read_turned%add(reference)
    rotation = model%mesh%n_nodes + model%read_turned%n
    model%rotation_of(reference) = rotation
  end subroutine make_rotation_node


  !> All DISTRIBUTING COUPLING cards of the calculix dialect: sum w_i u_i = (sum w_i) u of the node of the DCOUP3D element, in
  !! three directions. The first node of the list is the one eliminated, as in CalculiX. The equations follow those of other
  !! couplings.
  subroutine read_distributing_couplings(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, allocatable :: list(:)
    real(DP), allocatable :: weights(:)
    integer :: c, k, reference
    if (reader%dialect /= DIALECT_CALCULIX) return
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'DISTRIBUTINGCOUPLING')) cycle
      call read_coupling_weights(reader, model, c, reference, list, weights)
      if (reference == 0) cycle
      do k = 1, 3
        call append_equation(model, [list, reference], spread(k, 1, size(list) + 1), [weights, -sum(weights)], &
          'DISTRIBUTING COUPLING', reader%cards%line_number(reader%cards%cards(c)%line))
      end do
    end do
    call gather_constraints(model)
  end subroutine read_distributing_couplings


  !> One DISTRIBUTING COUPLING card of the abaqus dialect: the node of its element moves with the mean rigid body motion of the
  !! nodes.
  subroutine read_weighted_coupling(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model     !< with distributing_couplings
    integer, intent(in) :: c                     !< index of the card
    type(distributing_coupling_type) :: coupling
    integer, allocatable :: list(:)
    real(DP), allocatable :: weights(:)
    real(DP) :: of_node(model%mesh%n_nodes)
    integer :: i
    call read_coupling_weights(reader, model, c, coupling%reference, list, weights)
    if (coupling%reference == 0) return
    if (any(list == coupling%reference)) then
      call report_error(reader, reader%cards%cards(c)%line, 'The node of the element DCOUP3D is itself in the list: give the ' // &
        'nodes over which its force is spread.')
      return
    end if
    of_node = 0.0_DP
    do i = 1, size(list)
      of_node(list(i)) = of_node(list(i)) + weights(i)   ! a node may stand in several lines
    end do
    coupling%nodes = pack([(i, i=1, model%mesh%n_nodes)], of_node > 0.0_DP)
    coupling%weight = of_node(coupling%nodes)
    call make_rotation_node(model, coupling%reference, coupling%rotation)
    coupling%axes = IDENTITY
    coupling%line = reader%cards%line_number(reader%cards%cards(c)%line)
    model%distributing_couplings = [model%distributing_couplings, coupling]
  end subroutine read_weighted_coupling


  !> The reference node, the nodes and their weights of a DISTRIBUTING COUPLING card. After a reported error the reference node
  !! is 0.
  subroutine read_coupling_weights(reader, model, c, reference, list, weights)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(out) :: reference
    integer, allocatable, intent(out) :: list(:)
    real(DP), allocatable, intent(out) :: weights(:)
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    real(DP) :: weight
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    call find_coupling_node(reader, c, parameter_text(parameters, 'ELSET'), reference)
    if (reference == 0) return
    allocate (list(0), weights(0))
    is_ok = .true.
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 2)
      call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
      call read_real(reader, row, 2, 'weight', weight, is_ok, 0.0_DP)
      if (.not. is_ok) exit
      if (weight <= 0) then
        call report_error(reader, row%line, 'The weight of a node must be positive.')
        is_ok = .false.
        exit
      end if
      list = [list, nodes]
      weights = [weights, spread(weight, 1, size(nodes))]
    end do
    if (is_ok .and. size(list) == 0) call report_error(reader, reader%cards%cards(c)%line, 'The data are missing: nodes and ' // &
      'their weights.')
    if (.not. is_ok .or. size(list) == 0) reference = 0
  end subroutine read_coupling_weights


  !> The node of the one DCOUP3D element of a set; 0 after a reported error.
  subroutine find_coupling_node(reader, c, name, reference)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: name
    integer, intent(out) :: reference
    integer :: set, e
    reference = 0
    set = reader%element_sets%find(name)
    if (set > 0) then
      if (reader%omitted_of_set(set)%n == 1) then
        e = reader%omitted_of_set(set)%items(1)
        if (reader%omitted_first(e + 1) - reader%omitted_first(e) == 1) reference = reader%omitted_nodes(reader%omitted_first(e))
      end if
    end if
    if (reference == 0) call report_error(reader, reader%cards%cards(c)%line, &
      'The set ''' // name // ''' must hold one element ' // &
      'of type DCOUP3D (in the plane DCOUP2D), whose node is the reference node.')
  end subroutine find_coupling_node


  !> Sets the rotation of the ties with CYCLIC SYMMETRY. Ties must be read.
  subroutine read_cyclic_symmetry(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    logical :: has_turn(size(model%ties))
    integer :: c, i
    has_turn = .false.
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'CYCLICSYMMETRYMODEL')) call read_sector_card(reader, c, model, has_turn)
    end do
    do i = 1, size(model%ties)
      if (model%ties(i)%is_cyclic .and. .not. has_turn(i)) call report_error(reader, 0, 'The tie ''' // model%ties(i)%name // &
        ''' has CYCLIC SYMMETRY, but no *CYCLIC SYMMETRY MODEL, TIE=' // model%ties(i)%name // ' defines its axis and N.')
    end do
  end subroutine read_cyclic_symmetry


  !> One card: N sectors in the circle; two points of the axis.
  subroutine read_sector_card(reader, c, model, has_turn)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(model_type), intent(inout) :: model
    logical, intent(inout) :: has_turn(:)
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: name
    real(DP) :: x(6)
    integer :: i, n, status
    logical :: is_ok, is_found
    call open_card(reader, c, parameters, row)
    associate (line => reader%cards%cards(c)%line)
      call parse_integer(parameter_text(parameters, 'N'), n, status)
      if (status /= NUMBER_OK) return            ! already reported by the check of the card
      if (n < 2) call report_error(reader, line, 'N, the number of sectors in the circle, must be at least 2.')
      if (.not. next_row(reader%cards, row)) then
        call report_error(reader, line, '*CYCLIC SYMMETRY MODEL needs a data line: two points of the axis.')
        return
      end if
      is_ok = n >= 2
      call check_n_fields(reader, row, 6)
      do i = 1, 6
        call read_real(reader, row, i, 'coordinate of a point of the axis', x(i), is_ok, 0.0_DP)
      end do
      if (is_ok .and. .not. norm2(x(4:) - x(:3)) > 0) then
        call report_error(reader, row%line, 'The two points of the axis must differ.')
        is_ok = .false.
      end if
      if (next_row(reader%cards, row)) call check_no_data(reader, row)
      name = parameter_text(parameters, 'TIE')
      is_found = .false.
      do i = 1, size(model%ties)
        if (name_key(model%ties(i)%name) /= name_key(name) .or. .not. model%ties(i)%is_cyclic) cycle
        is_found = .true.
        has_turn(i) = .true.
        if (.not. is_ok) cycle
        model%ties(i)%centre = x(:3)
        model%ties(i)%turn = rotation_matrix((x(4:) - x(:3)) / norm2(x(4:) - x(:3)), 2 * PI / real(n, DP))
      end do
      if (.not. is_found) call report_error(reader, line, 'There is no *TIE, NAME=' // name // ', CYCLIC SYMMETRY.')
    end associate
  end subroutine read_sector_card


  !> The rotation matrix of an angle about an axis through the origin (Rodrigues).
  pure function rotation_matrix(axis, angle) result(turn)
    real(DP), intent(in) :: axis(3)              !< unit vector
    real(DP), intent(in) :: angle                !< [rad]
    real(DP) :: turn(3, 3), e(3)
    integer :: k
    do k = 1, 3
      e = 0
      e(k) = 1
      turn(:, k) = e + sin(angle) * cross_product(axis, e) + (1 - cos(angle)) * &
        cross_product(axis, cross_product(axis, e))
    end do
  end function rotation_matrix

end module amontons_deck_mpc
