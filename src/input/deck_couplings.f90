!> TRANSFORM, RIGID BODY, COUPLING, TIE and PRE-TENSION SECTION to constraints.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Linear constraints become equations (MPC TIE and PIN, DISTRIBUTING, PRE-TENSION SECTION), the rest nonlinear MPCs and ties.
!! Rotations are displacements of a rotation node: ROT NODE, or a new node at the reference node.
module amontons_deck_couplings
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_faces, only: find_side_elements
  use amontons_deck_surfaces, only: fill_surface_nodes
  use amontons_deck_ties, only: read_tie, read_tied_pair, read_shell_coupling
  use amontons_deck_mpc, only: read_mpc, make_rotation_node, read_weighted_coupling
  use amontons_deck_analytic_surfaces, only: attach_profile
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, read_integer, check_n_fields, &
    nodes_of_field, is_card
  use amontons_mesh, only: mesh_type, append_node_copies
  use amontons_model, only: model_type, append_equation, append_mpc, gather_constraints, DIALECT_CALCULIX
  use amontons_structural_data, only: expanded_nodes
  use amontons_tensor, only: cross_product
  use amontons_text, only: parse_real, parse_integer, plural, verb, name_key, NUMBER_OK
  use amontons_mpc_data, only: nonlinear_mpc_type, distributing_coupling_type, coordinate_system_type, axes_at, &
    MPC_RIGID_BODY
  use amontons_element_kinds, only: element_kind_type, element_kind, facet_kind_type, facet_kind, FAMILY_TRUSS, FAMILY_BEAM
  implicit none
  private
  public :: read_transforms, read_couplings, find_orientation

contains

  !> TRANSFORM: the directions of the degrees of freedom of a node set.
  subroutine read_transforms(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(coordinate_system_type) :: rule
    integer, allocatable :: nodes(:)
    real(DP), allocatable :: frames(:, :, :)
    integer :: c, i, n
    logical :: is_ok
    n = 0
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'TRANSFORM')) cycle
      call open_card(reader, c, parameters, row)
      is_ok = .true.
      rule = coordinate_system_type(is_cylindrical=parameter_word(parameters, 'TYPE', 'R') == 'C')
      call nodes_of_set(reader, model, c, parameter_text(parameters, 'NSET'), nodes, is_ok)
      call read_coordinate_system(reader, row, rule, is_ok)
      if (.not. is_ok) cycle
      if (.not. allocated(model%frame_of)) then
        allocate (model%frame_of(model%mesh%n_nodes), source=0)
        allocate (model%frames(3, 3, 0))
      end if
      allocate (frames(3, 3, n + size(nodes)))
      frames(:, :, :n) = model%frames(:, :, :n)
      do i = 1, size(nodes)
        n = n + 1
        frames(:, :, n) = axes_at(rule, model%mesh%coordinates(:, nodes(i)))
        model%frame_of(nodes(i)) = n
        if (.not. allocated(model%rotation_of)) cycle   ! else: nodes of shells and beams, whose rotations have these directions too
        if (model%rotation_of(nodes(i)) > 0) model%frame_of(model%rotation_of(nodes(i))) = n
      end do
      call move_alloc(frames, model%frames)
    end do
  end subroutine read_transforms


  !> The six coordinates of a local system, in the next row.
  subroutine read_coordinate_system(reader, row, rule, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    type(coordinate_system_type), intent(inout) :: rule
    logical, intent(inout) :: is_ok
    integer :: k
    if (.not. next_row(reader%cards, row)) then
      call report_error(reader, row%line, 'A line with the coordinates of two points is missing.')
      is_ok = .false.
      return
    end if
    do k = 1, 3
      call read_real(reader, row, k, 'coordinate of the first point', rule%a(k), is_ok, 0.0_DP)
      call read_real(reader, row, k + 3, 'coordinate of the second point', rule%b(k), is_ok, 0.0_DP)
    end do
    if (.not. is_ok) return
    if (rule%is_cylindrical) then
      is_ok = norm2(rule%a - rule%b) > 0.0_DP
    else
      is_ok = norm2(cross_product(rule%a, rule%b)) > 0.0_DP
    end if
    if (.not. is_ok) call report_error(reader, row%line, 'The two points give no directions: those of an axis must ' // &
      'differ, those of a rectangular system must not lie on one line with the origin.')
  end subroutine read_coordinate_system


  !> The nodes of a set by its name, or one node by its number.
  subroutine nodes_of_set(reader, model, c, name, nodes, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: name
    integer, allocatable, intent(out) :: nodes(:)
    logical, intent(inout) :: is_ok
    integer :: found, label, status
    allocate (nodes(0))
    found = reader%node_sets%find(name)
    if (found > 0) then
      nodes = model%mesh%node_sets(found)%members
      return
    end if
    call parse_integer(name, label, status)
    if (status == NUMBER_OK) found = reader%node_labels%find(label)
    if (found > 0) nodes = [found]
    if (found > 0) return
    is_ok = .false.
    if (name /= '') call report_error(reader, reader%cards%cards(c)%line, 'There is no node or node set ''' // name // '''.')
  end subroutine nodes_of_set


  !> One node: of a set with one member, or by its number.
  subroutine single_node(reader, model, c, name, node, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c
    character(*), intent(in) :: name
    integer, intent(out) :: node
    logical, intent(inout) :: is_ok
    integer, allocatable :: nodes(:)
    node = 0
    call nodes_of_set(reader, model, c, name, nodes, is_ok)
    if (.not. is_ok) return
    if (size(nodes) /= 1) then
      call report_error(reader, reader%cards%cards(c)%line, 'The node set ''' // name // ''' must hold one node.')
      is_ok = .false.
      return
    end if
    node = nodes(1)
  end subroutine single_node


  !> All other cards of this module. Sets, surfaces and transforms must be read.
  subroutine read_couplings(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer :: c
    allocate (model%ties(0), model%distributing_couplings(0))
    if (.not. allocated(model%equations)) allocate (model%nonlinear_mpcs(0), model%equations(0))   ! else: of shells and beams
    if (.not. allocated(model%rotation_of)) allocate (model%rotation_of(model%mesh%n_nodes), source=0)
    do c = 1, reader%cards%n_cards               ! first, since nodes of surfaces become others
      if (is_card(reader, c, 'PRE-TENSIONSECTION')) call read_pretension(reader, model, c)
    end do
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'MPC')) call read_mpc(reader, model, c)
      if (is_card(reader, c, 'RIGIDBODY')) call read_rigid_body(reader, model, c)
      if (is_card(reader, c, 'COUPLING')) call read_coupling(reader, model, c)
      if (is_card(reader, c, 'KINEMATICCOUPLING')) call read_kinematic(reader, model, c)
      if (is_card(reader, c, 'DISTRIBUTINGCOUPLING') .and. model%dialect /= DIALECT_CALCULIX) call read_weighted_coupling(reader, &
        model, c)
      if (is_card(reader, c, 'TIE')) call read_tie(reader, model, c)
      if (is_card(reader, c, 'SHELLTOSOLIDCOUPLING')) call read_shell_coupling(reader, model, c)
      if (is_card(reader, c, 'CONTACTPAIR')) call read_tied_pair(reader, model, c)
    end do
    call gather_constraints(model)
    call release_out_of_plane(model)
    call check_analytic_carrier(reader, model)
    if (allocated(model%frame_of)) call extend_frames(model)
  end subroutine read_couplings


  !> The nodes made for couplings have global directions, except rotations of reference nodes: they have those of the node.
  subroutine extend_frames(model)
    type(model_type), intent(inout) :: model     !< with frame_of of the nodes before
    integer :: i, n_before
    n_before = size(model%frame_of)
    model%frame_of = [model%frame_of, spread(0, 1, model%mesh%n_nodes - n_before)]
    do i = 1, n_before
      if (model%rotation_of(i) > n_before) model%frame_of(model%rotation_of(i)) = model%frame_of(i)
    end do
  end subroutine extend_frames


  !> Nodes of plane and axisymmetric elements stay in their plane. A rigid body of such nodes alone provides no support of its
  !! reference node out of plane, and need not constrain them there.
  subroutine release_out_of_plane(model)
    type(model_type), intent(inout) :: model
    integer :: i
    do i = 1, size(model%nonlinear_mpcs)
      if (model%nonlinear_mpcs(i)%kind /= MPC_RIGID_BODY .or. allocated(model%nonlinear_mpcs(i)%axes)) cycle
      if (all(model%mesh%is_unstiffened(3, model%nonlinear_mpcs(i)%node))) model%nonlinear_mpcs(i)%is_bound(3) = .false.
    end do
  end subroutine release_out_of_plane


  !> RIGID BODY: the nodes of a node set or of an element set, and a reference node.
  subroutine read_rigid_body(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(nonlinear_mpc_type) :: mpc
    integer, allocatable :: nodes(:)
    integer :: i, surface
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    is_ok = .true.
    mpc%card = 'RIGID BODY'
    mpc%line = reader%cards%line_number(reader%cards%cards(c)%line)
    surface = rigid_surface(reader, model, c, parameters, is_ok)
    call rigid_body_nodes(reader, model, c, parameters, nodes, is_ok)
    call single_node(reader, model, c, parameter_text(parameters, 'REF NODE'), mpc%reference, is_ok)
    if (has_parameter(parameters, 'ROT NODE')) call single_node(reader, model, c, &
      parameter_text(parameters, 'ROT NODE'), mpc%rotation, is_ok)
    if (.not. is_ok) return
    if (mpc%rotation == 0) then
      call make_rotation_node(model, mpc%reference, mpc%rotation)
    else
      model%mesh%is_auxiliary(mpc%rotation) = .true.
      model%rotation_of(mpc%reference) = mpc%rotation
    end if
    mpc%node = pack(nodes, [(nodes(i) /= mpc%reference .and. nodes(i) /= mpc%rotation, i=1, size(nodes))])
    if (surface > 0) call attach_profile(model, surface, mpc)
    if (size(mpc%node) == 0 .and. surface == 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'The rigid body has no nodes: its sets ' // &
        'hold no node and no element of a supported type. Rigid elements are R3D3, R3D4, R2D2, RAX2.')
    else if (any(mpc%rotation == model%mesh%nodes)) then
      call report_error(reader, reader%cards%cards(c)%line, 'The ROT NODE belongs to an element; its displacement would ' // &
        'be a rotation. Name a node of its own.')
    else if (size(mpc%node) > 0) then
      call append_mpc(model, mpc)
    end if
  end subroutine read_rigid_body


  !> The analytic surface of a rigid body; 0: none.
  integer function rigid_surface(reader, model, c, parameters, is_ok) result(surface)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    logical, intent(inout) :: is_ok
    character(:), allocatable :: name, wrong
    surface = 0
    if (.not. has_parameter(parameters, 'ANALYTICAL SURFACE')) return
    name = parameter_text(parameters, 'ANALYTICAL SURFACE')
    surface = reader%surfaces%find(name)
    wrong = ''
    if (surface == 0) then
      wrong = 'There is no surface ''' // name // '''.'
    else if (.not. allocated(model%surfaces(surface)%profile)) then
      wrong = 'The surface ''' // name // ''' is not analytic; name the elements of the body with ELSET.'
    else if (model%surfaces(surface)%profile%n_carrier_nodes > 0) then
      wrong = 'The surface ''' // name // ''' belongs to another rigid body already.'
    end if
    if (wrong == '') return
    is_ok = .false.
    call report_error(reader, reader%cards%cards(c)%line, wrong)
  end function rigid_surface


  !> An analytic surface needs a rigid body that moves it.
  subroutine check_analytic_carrier(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer :: s
    do s = 1, size(model%surfaces)
      if (.not. allocated(model%surfaces(s)%profile)) cycle
      if (.not. allocated(model%surfaces(s)%profile%piece_length)) cycle   ! its error is reported
      if (model%surfaces(s)%profile%n_carrier_nodes == 0) call report_error(reader, 0, 'The analytic surface ''' // &
        model%surfaces(s)%name // ''' needs a *RIGID BODY, ANALYTICAL SURFACE=' // model%surfaces(s)%name // ', REF NODE=.')
    end do
  end subroutine check_analytic_carrier


  !> The nodes of NSET, PIN NSET and TIE NSET and of the elements of ELSET, each once.
  subroutine rigid_body_nodes(reader, model, c, parameters, nodes, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    integer, allocatable, intent(out) :: nodes(:)
    logical, intent(inout) :: is_ok
    logical, allocatable :: is_member(:)
    character(*), parameter :: NAMES(3) = [character(8) :: 'NSET', 'PIN NSET', 'TIE NSET']
    integer, allocatable :: named(:)
    integer :: set, i, e
    allocate (is_member(0:model%mesh%n_nodes), source=.false.)   ! 0: node missing in the deck; its error is reported
    do i = 1, size(NAMES)
      if (.not. has_parameter(parameters, trim(NAMES(i)))) cycle
      call nodes_of_set(reader, model, c, parameter_text(parameters, trim(NAMES(i))), named, is_ok)
      if (allocated(model%structure)) then
        if (NAMES(i) == 'TIE NSET' .or. (NAMES(i) == 'NSET' .and. model%dialect /= DIALECT_CALCULIX)) then
          named = expanded_nodes(model%structure, named)
        else if (NAMES(i) == 'NSET' .and. size(expanded_nodes(model%structure, named)) > size(named)) then
          call report_note(reader, reader%cards%cards(c)%line, 'As in CalculiX this rigid body binds the displacements of ' // &
            'nodes of shells and beams, not their rotations: nodes on one line are a hinge. TIE NSET binds both.')
        end if
      end if
      is_member(named) = .true.
    end do
    nodes = pack([(i, i=1, model%mesh%n_nodes)], is_member(1:))
    if (size(nodes) > 0 .and. .not. has_parameter(parameters, 'ELSET')) return
    set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
    if (set == 0) then
      if (has_parameter(parameters, 'ANALYTICAL SURFACE') .and. .not. has_parameter(parameters, 'ELSET')) return
      if (is_ok) call report_error(reader, reader%cards%cards(c)%line, &
        'The rigid body needs NSET or ELSET, the name of a set, ' // &
        'or ANALYTICAL SURFACE.')
      is_ok = .false.
      return
    end if
    do i = 1, size(model%mesh%element_sets(set)%members)
      e = model%mesh%element_sets(set)%members(i)
      is_member(model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1)) = .true.
    end do
    nodes = pack([(i, i=1, model%mesh%n_nodes)], is_member(1:))
  end subroutine rigid_body_nodes


  !> COUPLING with KINEMATIC or DISTRIBUTING below it.
  subroutine read_coupling(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(coordinate_system_type) :: rule
    type(distributing_coupling_type) :: spread_out
    logical :: is_bound(6), is_ok, is_kinematic, has_rule
    integer :: reference, surface
    call open_card(reader, c, parameters, row)
    is_ok = .true.
    call single_node(reader, model, c, parameter_text(parameters, 'REF NODE'), reference, is_ok)
    surface = reader%surfaces%find(parameter_text(parameters, 'SURFACE'))
    if (surface == 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'There is no surface ''' // &
        parameter_text(parameters, 'SURFACE') // '''.')
      is_ok = .false.
    end if
    has_rule = has_parameter(parameters, 'ORIENTATION')
    if (has_rule) call find_orientation(reader, c, parameter_text(parameters, 'ORIENTATION'), rule, is_ok)
    is_kinematic = .false.
    if (c < reader%cards%n_cards) is_kinematic = is_card(reader, c + 1, 'KINEMATIC')
    if (.not. is_kinematic) then
      if (c == reader%cards%n_cards) is_ok = .false.
      if (is_ok) is_ok = is_card(reader, c + 1, 'DISTRIBUTING')
      if (.not. is_ok) call report_error(reader, reader%cards%cards(c)%line, &
        '*COUPLING must be followed by *KINEMATIC or *DISTRIBUTING.')
    end if
    if (.not. is_ok) return
    call read_coupled_dofs(reader, c + 1, is_bound, is_ok)
    if (.not. is_ok) return
    if (is_kinematic) then
      call add_kinematic(reader, model, c, reference, surface, is_bound)
      if (has_rule) call set_mpc_axes(model, rule)
    else
      if (model%surfaces(surface)%is_node_based) then
        call report_error(reader, reader%cards%cards(c)%line, 'DISTRIBUTING needs a surface of element faces.')
        return
      end if
      spread_out%reference = reference
      call make_rotation_node(model, reference, spread_out%rotation)
      spread_out%surface = surface
      spread_out%is_bound = is_bound(4:6)
      spread_out%axes = axes_at(rule, model%mesh%coordinates(:, reference))
      spread_out%line = reader%cards%line_number(reader%cards%cards(c)%line)
      model%distributing_couplings = [model%distributing_couplings, spread_out]
    end if
  end subroutine read_coupling


  !> The degrees of freedom below KINEMATIC or DISTRIBUTING: rows first, last; no rows: all, in CalculiX without the rotations
  !! of DISTRIBUTING.
  subroutine read_coupled_dofs(reader, c, is_bound, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of that card
    logical, intent(out) :: is_bound(6)
    logical, intent(inout) :: is_ok
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: first, last, n
    call open_card(reader, c, parameters, row)
    is_bound = .false.
    n = 0
    do while (next_row(reader%cards, row))
      n = n + 1
      call check_n_fields(reader, row, 2)
      call read_integer(reader, row, 1, 'first degree of freedom', first, is_ok, default=1)
      call read_integer(reader, row, 2, 'last degree of freedom', last, is_ok, default=first)
      if (.not. is_ok) return
      if (first < 1 .or. last < first .or. last > 6) then
        call report_error(reader, row%line, 'The degrees of freedom must be 1 to 6, the first not above the last.')
        is_ok = .false.
        return
      end if
      is_bound(first:last) = .true.
    end do
    if (n > 0) return
    is_bound = .true.
    if (reader%dialect /= DIALECT_CALCULIX) return
    if (is_card(reader, c, 'DISTRIBUTING')) then
      is_bound(4:6) = .false.
      call report_note(reader, reader%cards%cards(c)%line, 'Without a row 1, 6 below it this card binds no rotation, as in ' // &
        'CalculiX: ' // &
        'moments on the reference node do nothing.')
    else
      call report_note(reader, reader%cards%cards(c)%line, 'Without a row below it this card binds all directions, as in ' // &
        'Abaqus; ' // &
        'CalculiX binds none. Write 1, 3.')
    end if
  end subroutine read_coupled_dofs


  !> KINEMATIC COUPLING, the older card: rows of node or node set, first and last degree of freedom.
  subroutine read_kinematic(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(coordinate_system_type) :: rule
    type(nonlinear_mpc_type) :: mpc
    integer, allocatable :: nodes(:)
    integer :: first, last, n
    logical :: is_ok, is_row
    call open_card(reader, c, parameters, row)
    is_ok = .true.
    call single_node(reader, model, c, parameter_text(parameters, 'REF NODE'), mpc%reference, is_ok)
    if (has_parameter(parameters, 'ORIENTATION')) call find_orientation(reader, c, parameter_text(parameters, 'ORIENTATION'), &
      rule, is_ok)
    if (.not. is_ok) return
    call make_rotation_node(model, mpc%reference, mpc%rotation)
    mpc%card = 'KINEMATIC COUPLING'
    mpc%line = reader%cards%line_number(reader%cards%cards(c)%line)
    n = 0
    do while (next_row(reader%cards, row))
      n = n + 1
      is_row = .true.
      call check_n_fields(reader, row, 3)
      call nodes_of_field(reader, model%mesh, row, 1, nodes, is_row)
      call read_integer(reader, row, 2, 'first degree of freedom', first, is_row, default=1)
      call read_integer(reader, row, 3, 'last degree of freedom', last, is_row, default=merge(6, first, row%n < 2))
      if (.not. is_row) cycle
      if (first < 1 .or. last < first .or. last > 6 .or. first > 3) then
        call report_error(reader, row%line, 'The degrees of freedom must be 1 to 3, the first not above the last; rotations of ' &
          // &
          'solids do not exist.')
        cycle
      end if
      mpc%is_bound = [first <= 1, first <= 2 .and. last >= 2, last >= 3]
      if (last == 6 .and. allocated(model%structure)) nodes = expanded_nodes(model%structure, nodes)   ! their rotations too
      mpc%node = pack(nodes, nodes /= mpc%reference)
      call append_mpc(model, mpc)
      if (has_parameter(parameters, 'ORIENTATION')) call set_mpc_axes(model, rule)
    end do
    if (n == 0) call report_error(reader, reader%cards%cards(c)%line, &
      '*KINEMATIC COUPLING needs data lines: node or node set, ' // &
      'first and last degree of freedom.')
  end subroutine read_kinematic


  !> The local system of an ORIENTATION card by its name.
  subroutine find_orientation(reader, c, name, rule, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card that names it
    character(*), intent(in) :: name
    type(coordinate_system_type), intent(out) :: rule
    logical, intent(inout) :: is_ok
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: k
    do k = 1, reader%cards%n_cards
      if (.not. is_card(reader, k, 'ORIENTATION')) cycle
      call open_card(reader, k, parameters, row)
      if (name_key(parameter_text(parameters, 'NAME')) /= name_key(name)) cycle
      rule%is_cylindrical = parameter_word(parameters, 'SYSTEM', 'RECTANGULAR') == 'CYLINDRICAL'
      call read_coordinate_system(reader, row, rule, is_ok)
      return
    end do
    is_ok = .false.
    call report_error(reader, reader%cards%cards(c)%line, 'There is no orientation ''' // name // '''.')
  end subroutine find_orientation


  !> KINEMATIC: the nodes of the surface move with the reference node in the constrained directions.
  subroutine add_kinematic(reader, model, c, reference, surface, is_bound)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c, reference, surface
    logical, intent(in) :: is_bound(6)
    type(nonlinear_mpc_type) :: mpc
    if (.not. any(is_bound(:3))) then
      call report_error(reader, reader%cards%cards(c)%line, 'KINEMATIC binds displacements of the surface: name at ' // &
        'least one of the degrees of freedom 1 to 3.')
      return
    end if
    mpc%card = 'COUPLING'
    mpc%line = reader%cards%line_number(reader%cards%cards(c)%line)
    mpc%reference = reference
    call make_rotation_node(model, reference, mpc%rotation)
    mpc%is_bound = is_bound(:3)
    mpc%node = pack(model%surfaces(surface)%nodes, model%surfaces(surface)%nodes /= reference)
    if (allocated(model%structure)) then         ! with the rotations of shells and beams
      if (any(is_bound(4:)) .and. .not. all(is_bound(4:)) .and. &
        size(expanded_nodes(model%structure, mpc%node)) > size(mpc%node)) call report_error(reader, &
        reader%cards%cards(c)%line, 'Of the rotations of shells and beams a coupling binds all three (1, 6) or none (1, 3).')
      if (all(is_bound(4:))) mpc%node = expanded_nodes(model%structure, mpc%node)
    end if
    call append_mpc(model, mpc)
  end subroutine add_kinematic


  !> Directions of a local system for the last nonlinear MPC.
  subroutine set_mpc_axes(model, rule)
    type(model_type), intent(inout) :: model
    type(coordinate_system_type), intent(in) :: rule
    integer :: i
    if (model%read_mpcs%n == 0) return           ! its error is reported
    associate (mpc => model%read_mpcs%items(model%read_mpcs%n))
      if (allocated(mpc%axes)) return
      allocate (mpc%axes(3, 3, size(mpc%node)))
      do i = 1, size(mpc%node)
        mpc%axes(:, :, i) = axes_at(rule, model%mesh%coordinates(:, mpc%node(i)))
      end do
    end associate
  end subroutine set_mpc_axes


  !> PRE-TENSION SECTION: the elements on the surface's side of it get duplicate nodes there. The offset of the new nodes is the
  !! first displacement of the pre-tension node along the normal: u_new = u_old + n u_1.
  subroutine read_pretension(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: partner(:), side(:)
    real(DP) :: normal(3)
    integer :: surface, pilot, line
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    line = reader%cards%line_number(reader%cards%cards(c)%line)
    is_ok = .true.
    call single_node(reader, model, c, parameter_text(parameters, 'NODE'), pilot, is_ok)
    if (has_parameter(parameters, 'ELEMENT') .eqv. has_parameter(parameters, 'SURFACE')) then
      call report_error(reader, reader%cards%cards(c)%line, '*PRE-TENSION SECTION needs either SURFACE or ELEMENT.')
      return
    end if
    if (has_parameter(parameters, 'ELEMENT')) then
      call pretension_bar(reader, model, c, parameter_text(parameters, 'ELEMENT'), pilot, is_ok)
      return
    end if
    surface = reader%surfaces%find(parameter_text(parameters, 'SURFACE'))
    if (surface == 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'There is no surface ''' // &
        parameter_text(parameters, 'SURFACE') // '''.')
      return
    end if
    if (model%surfaces(surface)%is_node_based) then
      call report_error(reader, reader%cards%cards(c)%line, 'A pre-tension section needs a surface of element faces.')
      return
    end if
    if (any(model%mesh%nodes < 1)) return        ! an element with a missing node: already reported
    call read_normal(reader, model, row, surface, normal, is_ok)
    if (.not. is_ok) return
    if (any(model%mesh%nodes == pilot)) then
      call report_error(reader, reader%cards%cards(c)%line, 'The pre-tension node belongs to an element; name a node of its own.')
      return
    end if
    call find_side_elements(model%mesh, model%surfaces(surface)%element, model%surfaces(surface)%face, side, is_ok)
    if (model%dialect == DIALECT_CALCULIX) then
      call restrict_to_face_elements(reader, c, model%surfaces(surface)%element, side)
    else if (.not. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, 'The surface ''' // parameter_text(parameters, 'SURFACE') // &
        ''' does not cut its body through: elements on its two sides hang together around its edge, or it names faces of ' // &
        'both sides.')
      return
    end if
    call split_body(model, side, surface, partner)
    call add_pretension_equations(model, partner, pilot, normal, line)
  end subroutine read_pretension


  !> PRE-TENSION SECTION of a truss or a beam: the nodes at its second end get copies in this element, with an offset from them
  !! along its axis.
  subroutine pretension_bar(reader, model, c, name, pilot, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: name             !< of an element, or of a set that contains one
    integer, intent(in) :: pilot
    logical, intent(in) :: is_ok
    integer, allocatable :: partner(:), nodes(:)
    real(DP) :: axis(3)
    integer :: e, label, status, set
    e = 0
    call parse_integer(name, label, status)
    if (status == NUMBER_OK) e = reader%element_labels%find(label)
    set = reader%element_sets%find(name)
    if (e == 0 .and. set > 0) then
      if (size(model%mesh%element_sets(set)%members) == 1) e = model%mesh%element_sets(set)%members(1)
    end if
    allocate (nodes(0))
    if (e > 0) call find_bar_end(model, e, nodes, axis)
    if (size(nodes) == 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'ELEMENT must name one truss T3D2 or one beam; bodies of solids ' // &
        'are cut at a SURFACE.')
      return
    end if
    if (.not. is_ok .or. .not. norm2(axis) > 0) return   ! no length: the model check reports it
    associate (line => reader%cards%line_number(reader%cards%cards(c)%line))
      if (model%dialect == DIALECT_CALCULIX .and. size(nodes) > 1) then
        call replace_beam(model, e, pilot, axis / norm2(axis), line)
        return
      end if
      call copy_element_nodes(model%mesh, e, nodes, partner)
      call add_pretension_equations(model, partner, pilot, axis / norm2(axis), line)
    end associate
  end subroutine pretension_bar


  !> Gives an element copies of some nodes.
  subroutine copy_element_nodes(mesh, e, nodes, partner)
    type(mesh_type), intent(inout) :: mesh
    integer, intent(in) :: e
    integer, intent(in) :: nodes(:)
    integer, allocatable, intent(out) :: partner(:)   !< (old nodes) copy of each, 0
    integer :: i
    allocate (partner(mesh%n_nodes), source=0)
    partner(nodes) = mesh%n_nodes + [(i, i=1, size(nodes))]
    call append_node_copies(mesh, nodes)
    do i = mesh%first(e), mesh%first(e + 1) - 1
      if (partner(mesh%nodes(i)) > 0) mesh%nodes(i) = partner(mesh%nodes(i))
    end do
  end subroutine copy_element_nodes


  !> CalculiX drops the beam of a pre-tension section: the section alone connects its ends along its axis. Here its solid has nodes
  !! of its own, which move as its first end without strain. Cross-sections that no other beam has do not strain either.
  subroutine replace_beam(model, e, pilot, normal, line)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: e
    integer, intent(in) :: pilot
    real(DP), intent(in) :: normal(3)
    integer, intent(in) :: line                  !< of the deck
    integer, allocatable :: partner(:), deck_nodes(:), nodes(:)
    integer :: a, i, k, n
    model%mesh%is_auxiliary(pilot) = .true.
    associate (mesh => model%mesh, structure => model%structure)
      deck_nodes = structure%nodes(structure%first(e):structure%first(e + 1) - 1)
      n = size(deck_nodes)
      nodes = mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)
      call copy_element_nodes(mesh, e, nodes, partner)
      do i = 1, size(nodes)
        do k = 1, 3
          call append_equation(model, [partner(nodes(i)), deck_nodes(1)], [k, k], [1.0_DP, -1.0_DP], 'PRE-TENSION SECT', line)
        end do
      end do
      do a = 1, n
        nodes = structure%directors(structure%director_of(structure%first(e) + a - 1))%nodes
        if (any(mesh%nodes == nodes(1))) cycle     ! of other beams, too
        do i = merge(2, 1, a == 1 .or. a == n), size(nodes)
          do k = 1, 3
            call append_equation(model, [nodes(i), merge(nodes(1), deck_nodes(1), a == 1 .or. a == n)], [k, k], &
              [1.0_DP, -1.0_DP], 'PRE-TENSION SECT', line)
          end do
        end do
      end do
    end associate
    call append_equation(model, [pilot, spread(deck_nodes(n), 1, 3), spread(deck_nodes(1), 1, 3)], [1, 1, 2, 3, 1, 2, 3], &
      [1.0_DP, normal, -normal], 'PRE-TENSION SECT', line, n_eliminable=7)
  end subroutine replace_beam


  !> The nodes at the second end of a truss of two nodes or of a beam, and the vector from end to end; none of other elements.
  subroutine find_bar_end(model, e, nodes, axis)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    integer, allocatable, intent(inout) :: nodes(:)   !< in: none
    real(DP), intent(inout) :: axis(3)           !< [length]
    type(element_kind_type) :: entry
    integer :: last
    entry = element_kind(model%mesh%kind(e))
    if (entry%family == FAMILY_TRUSS .and. entry%n_nodes == 2) then
      nodes = model%mesh%nodes(model%mesh%first(e) + 1:model%mesh%first(e) + 1)
      axis = model%mesh%coordinates(:, nodes(1)) - model%mesh%coordinates(:, model%mesh%nodes(model%mesh%first(e)))
    end if
    if (.not. allocated(model%structure)) return
    associate (structure => model%structure)
      if (structure%section(e) == 0) return
      if (structure%sections(structure%section(e))%family /= FAMILY_BEAM) return
      last = structure%first(e + 1) - 1
      nodes = structure%directors(structure%director_of(last))%nodes
      axis = model%mesh%coordinates(:, structure%nodes(last)) - model%mesh%coordinates(:, structure%nodes(structure%first(e)))
    end associate
  end subroutine find_bar_end


  !> The equations of a section: u_new = u_old + n u_1 of the pilot. The first of each is bound: the new node, unless contact is to
  !! push it and not the old one.
  subroutine add_pretension_equations(model, partner, pilot, normal, line)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: partner(:)            !< new node of each old one, 0
    integer, intent(in) :: pilot
    real(DP), intent(in) :: normal(3)
    integer, intent(in) :: line                  !< of the deck
    logical :: is_slave(model%mesh%n_nodes)
    integer :: i, k
    model%mesh%is_auxiliary(pilot) = .true.
    is_slave = .false.
    do i = 1, size(model%pairs)
      is_slave(model%surfaces(model%pairs(i)%slave)%nodes) = .true.
    end do
    if (.not. allocated(model%pretension_node_pairs)) allocate (model%pretension_node_pairs(2, 0))
    do i = 1, size(partner)
      if (partner(i) == 0) cycle
      model%pretension_node_pairs = reshape([model%pretension_node_pairs, i, partner(i)], &
        [2, size(model%pretension_node_pairs, 2) + 1])
      do k = 1, 3
        if (is_slave(partner(i)) .and. .not. is_slave(i)) then
          call append_equation(model, [i, partner(i), pilot], [k, k, 1], [1.0_DP, -1.0_DP, normal(k)], 'PRE-TENSION SECT', line)
        else
          call append_equation(model, [partner(i), i, pilot], [k, k, 1], [1.0_DP, -1.0_DP, -normal(k)], 'PRE-TENSION SECT', line)
        end if
      end do
    end do
    model%rotation_of = [model%rotation_of, spread(0, 1, model%mesh%n_nodes - size(model%rotation_of))]
  end subroutine add_pretension_equations


  !> The normal of a section: given, or the mean normal of its faces.
  subroutine read_normal(reader, model, row, surface, normal, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(inout) :: row
    integer, intent(in) :: surface
    real(DP), intent(out) :: normal(3)
    logical, intent(inout) :: is_ok
    integer, allocatable :: nodes(:)
    integer :: i, k
    normal = 0.0_DP
    if (next_row(reader%cards, row)) then
      do k = 1, 3
        call read_real(reader, row, k, 'component of the normal', normal(k), is_ok, 0.0_DP)
      end do
    else
      do i = 1, size(model%surfaces(surface)%element)
        nodes = face_nodes(model, surface, i)
        associate (x => model%mesh%coordinates(:, nodes))
          if (size(nodes) == 2 .or. size(nodes) == 3 .and. is_plane_edge(model, surface, i)) then
            normal = normal + [x(2, 2) - x(2, 1), x(1, 1) - x(1, 2), 0.0_DP]
          else
            normal = normal + cross_product(x(:, 2) - x(:, 1), x(:, 3) - x(:, 1))
          end if
        end associate
      end do
    end if
    if (.not. is_ok) return
    is_ok = norm2(normal) > 0.0_DP
    if (is_ok) normal = normal / norm2(normal)
    if (.not. is_ok) call report_error(reader, row%line, 'The normal of the pre-tension section must not be zero.')
  end subroutine read_normal


  !> Whether a face of a surface is an edge of a plane element.
  pure logical function is_plane_edge(model, surface, i)
    type(model_type), intent(in) :: model
    integer, intent(in) :: surface, i
    type(element_kind_type) :: entry
    type(facet_kind_type) :: shape
    entry = element_kind(model%mesh%kind(model%surfaces(surface)%element(i)))
    shape = facet_kind(entry%face_kind(model%surfaces(surface)%face(i)))
    is_plane_edge = shape%n_corners == 2
  end function is_plane_edge


  !> The nodes of a face of a surface: corners first.
  pure function face_nodes(model, surface, i) result(nodes)
    type(model_type), intent(in) :: model
    integer, intent(in) :: surface, i            !< the surface, its face
    integer, allocatable :: nodes(:)
    type(element_kind_type) :: entry
    integer :: e
    e = model%surfaces(surface)%element(i)
    entry = element_kind(model%mesh%kind(e))
    associate (local => entry%face_nodes(:, model%surfaces(surface)%face(i)))
      nodes = model%mesh%nodes(model%mesh%first(e) - 1 + pack(local, local > 0))
    end associate
  end function face_nodes


  !> CalculiX separates the elements of the faces only; a note reports the other elements on that side.
  subroutine restrict_to_face_elements(reader, c, element, side)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: element(:)            !< of the faces
    integer, allocatable, intent(inout) :: side(:)
    integer :: i, n
    n = size(side)
    side = pack(side, [(any(element == side(i)), i=1, n)])
    if (size(side) == n) return
    call report_note(reader, reader%cards%cards(c)%line, plural(n - size(side), &
      'element') // verb(n - size(side), ' beside the section touches it with no ', &
      ' beside the section touch it with no ') // &
      'more than an edge or a corner. CalculiX leaves them tied to its other side, where they carry load past the section, ' // &
      'and so does its dialect here; the abaqus dialect parts them.')
  end subroutine restrict_to_face_elements


  !> Gives elements duplicate nodes on a surface, in the order of its faces; the nodes of all surfaces follow.
  subroutine split_body(model, side, surface, partner)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: side(:)               !< elements
    integer, intent(in) :: surface
    integer, allocatable, intent(out) :: partner(:)   !< (n_nodes) new node of each old one, 0
    integer, allocatable :: nodes(:), face(:)
    integer :: e, i, k
    allocate (partner(model%mesh%n_nodes + size(model%surfaces(surface)%nodes)), source=0)
    allocate (nodes(0))
    do i = 1, size(model%surfaces(surface)%element)
      face = face_nodes(model, surface, i)
      do k = 1, size(face)
        if (partner(face(k)) > 0) cycle
        nodes = [nodes, face(k)]
        partner(face(k)) = model%mesh%n_nodes + size(nodes)
      end do
    end do
    associate (mesh => model%mesh)
      call append_node_copies(mesh, nodes)
      do e = 1, size(side)
        do i = mesh%first(side(e)), mesh%first(side(e) + 1) - 1
          if (partner(mesh%nodes(i)) > 0) mesh%nodes(i) = partner(mesh%nodes(i))
        end do
      end do
    end associate
    do i = 1, size(model%surfaces)
      if (.not. (model%surfaces(i)%is_node_based .or. allocated(model%surfaces(i)%profile))) &
        call fill_surface_nodes(model%mesh, model%surfaces(i))
    end do
  end subroutine split_body

end module amontons_deck_couplings
