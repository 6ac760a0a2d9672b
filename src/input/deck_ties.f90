!> TIE, CONTACT PAIR with TIED, and SHELL TO SOLID COUPLING, to ties.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_ties
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_structure, only: is_shell_edge
  use amontons_deck_reader, only: reader_type, open_card, report_error, check_n_fields
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_mpc_data, only: tie_type
  use amontons_surfaces, only: surface_type
  use amontons_text, only: to_text, parse_real, NUMBER_OK
  implicit none
  private
  public :: read_tie, read_tied_pair, read_shell_coupling

contains

  !> TIE: slave surface, master surface; tied from the start.
  subroutine read_tie(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(tie_type) :: common
    call open_tie(reader, c, 'NAME', parameters, row, common)
    common%is_cyclic = has_parameter(parameters, 'CYCLIC SYMMETRY')
    common%may_be_nodal = .true.
    common%is_adjusted = parameter_word(parameters, 'ADJUST', 'YES') == 'YES'
    call add_ties(reader, model, c, row, common, '*TIE needs a data line: slave surface, master surface.')
  end subroutine read_tie


  !> SHELL TO SOLID COUPLING: edges of shells, faces of solids.
  subroutine read_shell_coupling(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(tie_type) :: common
    if (reader%dialect == DIALECT_CALCULIX) then
      call report_error(reader, reader%cards%cards(c)%line, 'CalculiX has no *SHELL TO SOLID COUPLING: use *TIE with the face ' // &
        'as the slave surface, or the abaqus dialect.')
      return
    end if
    call open_tie(reader, c, 'CONSTRAINT NAME', parameters, row, common)
    common%is_shell_edge = .true.
    call add_ties(reader, model, c, row, common, '*SHELL TO SOLID COUPLING needs a data line: edges of shells, faces of solids.')
  end subroutine read_shell_coupling


  !> Name, line and POSITION TOLERANCE of a card with ties.
  subroutine open_tie(reader, c, name_parameter, parameters, row, tie)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    character(*), intent(in) :: name_parameter   !< that names the ties
    type(parameter_type), allocatable, intent(out) :: parameters(:)
    type(data_row_type), intent(out) :: row
    type(tie_type), intent(inout) :: tie
    integer :: status
    call open_card(reader, c, parameters, row)
    tie%name = parameter_text(parameters, name_parameter)
    tie%line = reader%cards%line_number(reader%cards%cards(c)%line)
    if (.not. has_parameter(parameters, 'POSITION TOLERANCE')) return
    call parse_real(parameter_text(parameters, 'POSITION TOLERANCE'), tie%tolerance, status)
    if (status == NUMBER_OK .and. tie%tolerance < 0.0_DP) call report_error(reader, reader%cards%cards(c)%line, &
      'POSITION TOLERANCE must not be negative.')
  end subroutine open_tie


  !> CONTACT PAIR, TIED: the slave nodes that ADJUST moves onto the master are tied to it.
  subroutine read_tied_pair(reader, model, c)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(tie_type) :: common
    integer :: status
    call open_card(reader, c, parameters, row)
    if (.not. has_parameter(parameters, 'TIED')) return
    common%line = reader%cards%line_number(reader%cards%cards(c)%line)
    common%name = 'of the contact pair in line ' // to_text(common%line)
    call parse_real(parameter_text(parameters, 'ADJUST'), common%tolerance, status)
    if (status /= NUMBER_OK .or. common%tolerance < 0.0_DP) then
      call report_error(reader, reader%cards%cards(c)%line, 'TIED needs ADJUST, the distance up to which slave nodes are ' // &
        'moved and tied.')
    else if (reader%dialect == DIALECT_CALCULIX) then
      call report_error(reader, reader%cards%cards(c)%line, 'CalculiX has no TIED here: use *TIE, or *SURFACE BEHAVIOR, ' // &
        'PRESSURE-OVERCLOSURE=TIED.')
    else
      call add_ties(reader, model, c, row, common, '*CONTACT PAIR needs a data line: slave, master.')
    end if
  end subroutine read_tied_pair


  !> All rows of a card: a tie for each.
  subroutine add_ties(reader, model, c, row, common, without_rows)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c
    type(data_row_type), intent(inout) :: row
    type(tie_type), intent(in) :: common
    character(*), intent(in) :: without_rows     !< the message if there is none
    integer :: n
    n = 0
    do while (next_row(reader%cards, row))
      n = n + 1
      call check_n_fields(reader, row, 2)
      call add_tie(reader, model, row, common)
    end do
    if (n == 0) call report_error(reader, reader%cards%cards(c)%line, without_rows)
  end subroutine add_ties


  !> A tie.
  subroutine add_tie(reader, model, row, common)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type), intent(in) :: row
    type(tie_type), intent(in) :: common
    type(tie_type) :: tie
    integer :: i
    tie = common
    tie%slave = reader%surfaces%find(field_text(reader%cards, row, 1))
    tie%master = reader%surfaces%find(field_text(reader%cards, row, 2))
    do i = 1, 2
      if (reader%surfaces%find(field_text(reader%cards, row, i)) == 0) call report_error(reader, row%line, &
        'There is no surface ''' // field_text(reader%cards, row, i) // '''.')
    end do
    if (tie%slave == 0 .or. tie%master == 0) return
    if (tie%slave == tie%master) then
      call report_error(reader, row%line, 'A surface cannot be tied to itself; name two surfaces.')
    else if (.not. is_master_fit(reader, row, tie, model%surfaces(tie%master))) then
      return
    else if (tie%is_shell_edge .and. .not. are_edges(model, tie%slave)) then
      call report_error(reader, row%line, 'The surface ''' // model%surfaces(tie%slave)%name // ''' must consist of edges of ' // &
        'shells, E1 to E4.')
    else
      model%ties = [model%ties, tie]
    end if
  end subroutine add_tie


  !> Whether a surface can be the master of a tie; reports why it cannot.
  logical function is_master_fit(reader, row, tie, master) result(is_fit)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(tie_type), intent(in) :: tie
    type(surface_type), intent(in) :: master
    character(:), allocatable :: start
    is_fit = .true.
    if (.not. master%is_node_based .or. tie%is_cyclic) return
    start = 'The master surface ''' // master%name // ''' '
    if (.not. tie%may_be_nodal) then
      call report_error(reader, row%line, start // 'is made of nodes; a master needs element faces.')
    else if (reader%dialect == DIALECT_CALCULIX) then
      call report_error(reader, row%line, start // 'is made of nodes. CalculiX ties to faces: name a surface of faces, or put ' // &
        '''** dialect: abaqus'' at the top of the deck, which ties to the nearest nodes.')
    else if (tie%tolerance < 0.0_DP .and. size(master%nodes) == 1) then
      call report_error(reader, row%line, start // 'has one node: no distance from others gives a POSITION TOLERANCE. Give one.')
    else
      return
    end if
    is_fit = .false.
  end function is_master_fit


  !> Whether a surface consists of edges of shells.
  pure logical function are_edges(model, s)
    type(model_type), intent(in) :: model
    integer, intent(in) :: s                     !< surface
    integer :: i
    are_edges = .false.
    if (model%surfaces(s)%is_node_based) return
    associate (surface => model%surfaces(s))
      are_edges = all([(is_shell_edge(model, surface%element(i), surface%face(i)), i=1, size(surface%element))])
    end associate
  end function are_edges

end module amontons_deck_ties
