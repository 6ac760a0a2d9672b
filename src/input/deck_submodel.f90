!> SUBMODEL: nodes that follow the results of a global model, and the parameters by which cards of a step use them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The reader notes which step of the global model gives a value; `driver/submodel_results` reads the results and sets the values.
module amontons_deck_submodel
  use amontons_kinds, only: DP
  use amontons_cards, only: data_row_type, parameter_type, field_integer, field_text, next_row
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_containers, only: integer_list_type, sort_ascending
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_tolerance, nodes_of_field, is_card
  use amontons_model, only: model_type, job_options_type, DIALECT_CALCULIX
  use amontons_structural_data, only: find_node_directors
  use amontons_submodels, only: submodel_type
  use amontons_text, only: name_key, to_text, parse_integer, NUMBER_OK
  implicit none
  private
  public :: read_submodels, read_global_step, check_driven_nodes, check_driven_dofs, check_driven_temperatures

contains

  !> All SUBMODEL cards. After: reader%submodel_of has the card of each node.
  subroutine read_submodels(reader, options, model)
    type(reader_type), intent(inout) :: reader
    type(job_options_type), intent(in) :: options
    type(model_type), intent(inout) :: model
    type(submodel_type) :: submodel
    integer :: c
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'SUBMODEL') .or. reader%step_of_card(c) > 0) cycle
      if (.not. allocated(model%submodels)) then
        allocate (model%submodels(0))
        allocate (reader%submodel_of(model%mesh%n_nodes), source=0)
      end if
      call read_submodel(reader, options, model, c, submodel)
      model%submodels = [model%submodels, submodel]
    end do
  end subroutine read_submodels


  !> One card.
  subroutine read_submodel(reader, options, model, c, submodel)
    type(reader_type), intent(inout) :: reader
    type(job_options_type), intent(in) :: options
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(submodel_type), intent(out) :: submodel
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    call open_card(reader, c, parameters, row)
    submodel%line = reader%cards%line_number(reader%cards%cards(c)%line)
    submodel%path = parameter_text(parameters, 'INPUT')
    if (submodel%path == '') submodel%path = parameter_text(parameters, 'GLOBAL')
    if (submodel%path == '' .and. .not. allocated(options%global_results)) call report_error(reader, reader%cards%cards(c)%line, &
      'The results of the global model are not named: write INPUT=file on this card, or start with amontons job ' // &
      'globalmodel=file. The file is a .vtkhdf of Amontons, or a .frd of Amontons or CalculiX.')
    submodel%is_exterior_error = reader%dialect /= DIALECT_CALCULIX .or. has_parameter(parameters, 'EXTERIOR TOLERANCE') .or. &
      has_parameter(parameters, 'ABSOLUTE EXTERIOR TOLERANCE')
    if (has_parameter(parameters, 'ABSOLUTE EXTERIOR TOLERANCE') .and. .not. has_parameter(parameters, 'EXTERIOR TOLERANCE')) &
      submodel%exterior_tolerance = huge(1.0_DP)
    call read_tolerance(reader, c, parameters, 'EXTERIOR TOLERANCE', submodel%exterior_tolerance)
    call read_tolerance(reader, c, parameters, 'ABSOLUTE EXTERIOR TOLERANCE', submodel%absolute_tolerance)
    submodel%global_elset = parameter_text(parameters, 'GLOBAL ELSET')
    call read_global_set(reader, submodel)
    call read_members(reader, model, c, row, size(model%submodels) + 1, submodel)
  end subroutine read_submodel


  !> The nodes of a card; a node belongs to one card.
  subroutine read_members(reader, model, c, row, number, submodel)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row
    integer, intent(in) :: number                !< of the submodel
    type(submodel_type), intent(inout) :: submodel
    integer, allocatable :: nodes(:)
    integer :: i, k
    logical :: is_ok, is_shared
    is_shared = .false.
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        if (field_text(reader%cards, row, i) == '') cycle
        is_ok = .true.
        call nodes_of_field(reader, model%mesh, row, i, nodes, is_ok)
        reader%has_bad_submodels = reader%has_bad_submodels .or. .not. is_ok
        do k = 1, size(nodes)
          associate (owner => reader%submodel_of(nodes(k)))
            is_shared = is_shared .or. (owner > 0 .and. owner /= number)
            owner = number
          end associate
          if (reader%dialect /= DIALECT_CALCULIX .or. .not. has_director(model, nodes(k))) cycle
          call report_error(reader, row%line, 'The node ' // to_text(model%mesh%node_label(nodes(k))) // ' belongs to a shell ' // &
            'or beam. In the calculix dialect the driven nodes of a submodel are those of solids, plane or axisym' // &
            'metric elements: mesh the submodel with them, write displacements and rotations by *BOUNDARY, or take the abaqus ' // &
            'dialect.')
          reader%has_bad_submodels = .true.
          exit
        end do
      end do
    end do
    if (is_shared) call report_error(reader, reader%cards%cards(c)%line, 'Some nodes of this card belong to another ' // &
      '*SUBMODEL, too: name each node on one of them.')
    submodel%nodes = pack([(i, i=1, model%mesh%n_nodes)], reader%submodel_of == number)
    if (size(submodel%nodes) == 0 .and. .not. reader%has_bad_submodels) call report_error(reader, &
      reader%cards%cards(c)%line, 'The card names no nodes: its data lines hold the nodes and node sets of the cut boundary.')
    reader%has_bad_submodels = reader%has_bad_submodels .or. size(submodel%nodes) == 0
  end subroutine read_members


  !> Whether a node belongs to a shell or beam that is expanded into solids.
  pure logical function has_director(model, node)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node
    integer :: first, last
    first = 1
    last = 0
    if (allocated(model%structure)) call find_node_directors(model%structure, node, first, last)
    has_director = last >= first
  end function has_director


  !> The numbers in the element set of the global model, if the deck has it. They need not be elements of this deck.
  subroutine read_global_set(reader, submodel)
    type(reader_type), intent(inout) :: reader
    type(submodel_type), intent(inout) :: submodel
    type(integer_list_type) :: labels
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: c, i, label, status
    logical :: is_there
    if (submodel%global_elset == '') return
    is_there = .false.
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'ELSET')) cycle
      call open_card(reader, c, parameters, row)
      if (name_key(parameter_text(parameters, 'ELSET')) /= name_key(submodel%global_elset)) cycle
      is_there = .true.
      do while (next_row(reader%cards, row))
        if (has_parameter(parameters, 'GENERATE')) then
          call add_range()
          cycle
        end if
        do i = 1, row%n
          call field_integer(reader%cards, row, i, label, status)
          if (status == NUMBER_OK) call labels%add(label)
          if (status /= NUMBER_OK .and. field_text(reader%cards, row, i) /= '') call report_error(reader, row%line, &
            'The set of GLOBAL ELSET holds numbers of elements of the global model, not names of sets.')
        end do
      end do
    end do
    if (.not. is_there) return
    submodel%global_labels = labels%trimmed()
    call sort_ascending(submodel%global_labels)

  contains

    !> A row of first, last, step; the reader of sets has reported its errors.
    subroutine add_range()
      integer :: first, last, step
      call field_integer(reader%cards, row, 1, first, status)
      if (status /= NUMBER_OK) return
      call field_integer(reader%cards, row, 2, last, status)
      if (status /= NUMBER_OK) last = first
      call field_integer(reader%cards, row, 3, step, status)
      if (status /= NUMBER_OK .or. step < 1) step = 1
      do label = first, last, step
        call labels%add(label)
      end do
    end subroutine add_range

  end subroutine read_global_set


  !> The step of the global model that a card with SUBMODEL names; 0: the card has no SUBMODEL; negative: a data set.
  subroutine read_global_step(reader, c, parameters, step, global_step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(in) :: step                  !< present step; 0: the model
    integer, intent(out) :: global_step
    integer :: status
    global_step = 0
    associate (line => reader%cards%cards(c)%line)
      if (.not. has_parameter(parameters, 'SUBMODEL')) then
        if (has_parameter(parameters, 'STEP') .or. has_parameter(parameters, 'DATA SET')) call report_error(reader, line, &
          'STEP and DATA SET name results of a global model: they need the parameter SUBMODEL.')
        return
      end if
      if (step == 0) call report_error(reader, line, 'A global model gives values in a step: put this card between *STEP and ' // &
        '*END STEP.')
      if (.not. allocated(reader%submodel_of)) call report_error(reader, line, 'SUBMODEL needs a card *SUBMODEL before the first ' &
        // 'step, which names the nodes and the results of the global model.')
      if (has_parameter(parameters, 'AMPLITUDE') .or. has_parameter(parameters, 'FIXED') .or. has_parameter(parameters, 'USER') &
        .or. parameter_word(parameters, 'TYPE', 'DISPLACEMENT') /= 'DISPLACEMENT') call report_error(reader, line, &
        'With SUBMODEL the global model gives the values over time, without AMPLITUDE, FIXED, USER or TYPE.')
      if (has_parameter(parameters, 'STEP') .and. has_parameter(parameters, 'DATA SET')) call report_error(reader, line, &
        'STEP names a step and DATA SET a data set of the global model: give one of them.')
      if (has_parameter(parameters, 'STEP')) then
        call parse_integer(parameter_text(parameters, 'STEP'), global_step, status)
      else if (has_parameter(parameters, 'DATA SET')) then
        call parse_integer(parameter_text(parameters, 'DATA SET'), global_step, status)
        global_step = -global_step
      else
        call report_error(reader, line, 'SUBMODEL needs the step of the global model: STEP=number.')
        return
      end if
      if (status == NUMBER_OK .and. abs(global_step) > 0 .and. (global_step > 0 .eqv. has_parameter(parameters, 'STEP'))) return
      if (status == NUMBER_OK) call report_error(reader, line, 'The steps and data sets of the global model are counted from 1.')
      global_step = 0
    end associate
  end subroutine read_global_step


  !> Reports nodes that no SUBMODEL card names and, under calculix, nodes with directions of their own.
  subroutine check_driven_nodes(reader, model, row, nodes, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: nodes(:)
    logical, intent(inout) :: is_ok              !< set to .false. on trouble, else untouched
    integer :: i
    if (reader%has_bad_submodels .or. .not. allocated(reader%submodel_of)) then     ! reported with the card
      is_ok = .false.
      return
    end if
    do i = 1, size(nodes)
      if (reader%submodel_of(nodes(i)) == 0) then
        call report_error(reader, row%line, 'The node ' // to_text(model%mesh%node_label(nodes(i))) // ' belongs to no ' // &
          '*SUBMODEL: add it, or its node set, to the data lines of that card.')
        is_ok = .false.
        return
      end if
      if (.not. allocated(model%frame_of) .or. reader%dialect /= DIALECT_CALCULIX) cycle
      if (model%frame_of(nodes(i)) == 0) cycle
      call report_error(reader, row%line, 'The node ' // to_text(model%mesh%node_label(nodes(i))) // ' has directions of its own ' &
        // '(*TRANSFORM), which CalculiX does not allow of driven nodes. Leave it out of the *TRANSFORM; the abaqus dialect ' // &
        'turns the displacements into these directions.')
      is_ok = .false.
      return
    end do
  end subroutine check_driven_nodes


  !> Reports rotations 4 to 6 of nodes whose rotations no shell or beam gives, and a value.
  subroutine check_driven_dofs(reader, model, row, nodes, is_fixed, value, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: nodes(:)
    logical, intent(in) :: is_fixed(6)
    real(DP), intent(in) :: value                !< the fourth field [length]
    logical, intent(inout) :: is_ok              !< set to .false. on trouble, else untouched
    integer :: i
    logical :: is_bad
    is_bad = abs(value) > 0
    if (any(is_fixed(4:)) .and. .not. is_bad) then
      is_bad = .not. any([(has_director(model, nodes(i)), i=1, size(nodes))])
      do i = 1, size(nodes)
        if (is_bad .or. .not. allocated(model%rotation_of)) exit
        is_bad = model%rotation_of(nodes(i)) > 0 .and. .not. has_director(model, nodes(i))
      end do
    end if
    if (.not. is_bad) return
    is_ok = .false.
    call report_error(reader, row%line, 'A global model gives the displacements 1 to 3 of solids, and the rotations 4 to 6 of ' // &
      'shells and beams, too (not of reference nodes and beams by their section): write node or node set, first and last ' // &
      'degree of freedom, and no value.')
  end subroutine check_driven_dofs


  !> Reports driven temperatures of shells and beams.
  subroutine check_driven_temperatures(reader, model, row, nodes, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: nodes(:)
    logical, intent(inout) :: is_ok              !< set to .false. on trouble, else untouched
    integer :: i
    if (.not. allocated(model%structure)) return
    do i = 1, size(nodes)                        ! shells give their temperatures to the nodes of their solids
      if (nodes(i) <= model%structure%n_deck_nodes .and. .not. has_director(model, nodes(i))) cycle
      is_ok = .false.
      call report_error(reader, row%line, 'This row names nodes of shells or beams, whose temperature has gradients over the ' // &
        'thickness: write it by *TEMPERATURE without SUBMODEL.')
      return
    end do
  end subroutine check_driven_temperatures

end module amontons_deck_submodel
