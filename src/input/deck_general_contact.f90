!> CONTACT with its inclusions, exclusions and assignments to the rules of general contact.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_general_contact
  use amontons_kinds, only: DP
  use amontons_containers, only: name_table_type
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_reader, only: reader_type, open_card, report_error, check_n_fields, is_card
  use amontons_deck_structure, only: is_shell
  use amontons_model, only: model_type
  use amontons_element_kinds, only: is_two_sided
  use amontons_surfaces, only: interaction_type, general_contact_type, shell_property_type, contact_initialization_type
  use amontons_text, only: is_one_of, name_key, parse_real, to_text, NUMBER_OK
  implicit none
  private
  public :: read_general_contact

  character(*), parameter :: DEFAULT_INTERACTION = 'GENERAL CONTACT'   !< name of the one for faces without an assignment

contains

  !> Reads the rules; after `read_interactions`. Faces without an assignment have exact contact without friction.
  subroutine read_general_contact(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(general_contact_type) :: rules
    type(interaction_type) :: default
    type(name_table_type) :: initializations
    integer :: c, n, line
    if (.not. any([(is_card(reader, c, 'CONTACT'), c=1, reader%cards%n_cards)])) return
    allocate (rules%properties(0))
    allocate (rules%included(2, 0), rules%excluded(2, 0), rules%assigned(3, 0), rules%roles(2, 0), rules%initialized(3, 0))
    allocate (rules%initial(0))
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'CONTACTINITIALIZATIONDATA')) call read_initialization(reader, c, initializations, rules%initial)
    end do
    default%name = DEFAULT_INTERACTION
    model%interactions = [model%interactions, default]
    rules%assigned = reshape([0, 0, size(model%interactions)], [3, 1])
    n = 0
    line = 0
    do c = 1, reader%cards%n_cards
      if (is_card(reader, c, 'CONTACT')) then
        line = reader%cards%cards(c)%line
        rules%line = reader%cards%line_number(line)
        call read_contact_parameters(reader, c, rules)
      else if (is_card(reader, c, 'CONTACTINCLUSIONS')) then
        n = n + 1
        call read_inclusions(reader, model, c, rules)
      else if (is_card(reader, c, 'CONTACTEXCLUSIONS')) then
        call read_surface_pairs(reader, model, c, '*CONTACT EXCLUSIONS needs data lines: surface, surface.', rules%excluded)
      else if (is_card(reader, c, 'CONTACTPROPERTYASSIGNMENT')) then
        call read_assignments(reader, model, c, reader%interactions, [character(50) :: &
          'There is no surface interaction ''', ''''], '*CONTACT PROPERTY ASSIGNMENT needs data lines: ' // &
          'surface, surface, interaction.', rules%assigned)
      else if (is_card(reader, c, 'CONTACTINITIALIZATIONASSIGNMENT')) then
        call read_assignments(reader, model, c, initializations, [character(50) :: &
          'There is no *CONTACT INITIALIZATION DATA, NAME=', ''], '*CONTACT INITIALIZATION ASSIGNMENT needs data lines: ' // &
          'surface, surface, initialization.', rules%initialized)
      else if (is_card(reader, c, 'CONTACTFORMULATION')) then
        call read_roles(reader, model, c, rules)
      else if (is_card(reader, c, 'SURFACEPROPERTYASSIGNMENT')) then
        call read_surface_properties(reader, model, c, rules%properties)
      end if
    end do
    if (n == 0) call report_error(reader, line, '*CONTACT says nothing without *CONTACT INCLUSIONS: give it with ALL ' // &
      'EXTERIOR, or with pairs of surfaces.')
    model%general_contact = rules
  end subroutine read_general_contact


  !> The parameters TYPE and REACH of CONTACT.
  subroutine read_contact_parameters(reader, c, rules)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(general_contact_type), intent(inout) :: rules
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: status
    call open_card(reader, c, parameters, row)
    rules%is_mortar = parameter_word(parameters, 'TYPE', 'SURFACETOSURFACE') == 'SURFACETOSURFACE'
    if (.not. has_parameter(parameters, 'REACH')) return
    call parse_real(parameter_text(parameters, 'REACH'), rules%reach, status)
    if (status == NUMBER_OK .and. rules%reach >= 0.0_DP) return
    call report_error(reader, reader%cards%cards(c)%line, 'REACH must be a distance that is not negative.')
  end subroutine read_contact_parameters


  !> CONTACT INCLUSIONS: the whole exterior, or pairs of surfaces.
  subroutine read_inclusions(reader, model, c, rules)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(general_contact_type), intent(inout) :: rules
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    call open_card(reader, c, parameters, row)
    if (.not. has_parameter(parameters, 'ALL EXTERIOR')) then
      call read_surface_pairs(reader, model, c, '*CONTACT INCLUSIONS needs ALL EXTERIOR, or data lines: surface, surface.', &
        rules%included)
    else if (next_row(reader%cards, row)) then
      call report_error(reader, row%line, 'With ALL EXTERIOR *CONTACT INCLUSIONS takes no data lines; leave out one of both.')
    else
      rules%included = reshape([rules%included, 0, 0], [2, size(rules%included, 2) + 1])
    end if
  end subroutine read_inclusions


  !> Appends the pairs of surfaces of a card.
  subroutine read_surface_pairs(reader, model, c, needs, pairs)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: needs            !< message where it has no data lines
    integer, allocatable, intent(inout) :: pairs(:, :)   !< (2, pairs) surfaces
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: pair(2), n
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    n = 0
    do while (next_row(reader%cards, row))
      n = n + 1
      call check_n_fields(reader, row, 2)
      call read_surfaces(reader, model, row, pair, is_ok)
      if (is_ok) pairs = reshape([pairs, pair], [2, size(pairs, 2) + 1])
    end do
    if (n == 0) call report_error(reader, reader%cards%cards(c)%line, needs)
  end subroutine read_surface_pairs


  !> CONTACT PROPERTY ASSIGNMENT, CONTACT INITIALIZATION ASSIGNMENT: appends pairs of surfaces and what a line gives them by name.
  subroutine read_assignments(reader, model, c, names, missing, needs, assigned)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(name_table_type), intent(in) :: names   !< what can be assigned
    character(*), intent(in) :: missing(2)       !< message where there is no such name: before and behind the name
    character(*), intent(in) :: needs            !< message where it has no data lines
    integer, allocatable, intent(inout) :: assigned(:, :)   !< (3, :) two surfaces, and what is assigned
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: name
    integer :: pair(2), found, n
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    n = 0
    do while (next_row(reader%cards, row))
      n = n + 1
      call check_n_fields(reader, row, 3)
      call read_surfaces(reader, model, row, pair, is_ok)
      name = field_text(reader%cards, row, 3)
      found = names%find(name)
      if (found == 0) call report_error(reader, row%line, trim(missing(1)) // name // trim(missing(2)) // names%suggest(name))
      if (is_ok .and. found > 0) assigned = reshape([assigned, pair, found], [3, size(assigned, 2) + 1])
    end do
    if (n == 0) call report_error(reader, reader%cards%cards(c)%line, needs)
  end subroutine read_assignments


  !> CONTACT INITIALIZATION DATA: adds one; of several with one name the last counts.
  subroutine read_initialization(reader, c, names, list)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(name_table_type), intent(inout) :: names
    type(contact_initialization_type), allocatable, intent(inout) :: list(:)
    type(contact_initialization_type) :: item
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: k
    logical :: is_new
    call open_card(reader, c, parameters, row)
    item%name = parameter_text(parameters, 'NAME')
    item%is_fit = has_parameter(parameters, 'INTERFERENCE FIT')
    call read_distance('SEARCH ABOVE', item%above)
    call read_distance('SEARCH BELOW', item%below)
    if (item%is_fit .and. (has_parameter(parameters, 'SEARCH ABOVE') .or. has_parameter(parameters, 'SEARCH BELOW'))) call &
      report_error(reader, reader%cards%cards(c)%line, 'With INTERFERENCE FIT nothing is moved: leave out SEARCH ABOVE and ' // &
      'SEARCH BELOW.')
    call names%add(item%name, k, is_new)
    if (is_new) then
      list = [list, item]
    else
      list(k) = item
    end if

  contains

    !> A distance that a parameter gives; without it the value stays.
    subroutine read_distance(name, value)
      character(*), intent(in) :: name
      real(DP), intent(inout) :: value             !< [length]
      integer :: status
      if (.not. has_parameter(parameters, name)) return
      call parse_real(parameter_text(parameters, name), value, status)
      if (status == NUMBER_OK .and. value >= 0.0_DP) return
      call report_error(reader, reader%cards%cards(c)%line, name // ' must be a distance that is not negative.')
    end subroutine read_distance

  end subroutine read_initialization


  !> CONTACT FORMULATION: pairs of surfaces and the role of the first one.
  subroutine read_roles(reader, model, c, rules)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c
    type(general_contact_type), intent(inout) :: rules
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: role
    integer :: pair(2)
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 3)
      call read_surfaces(reader, model, row, pair, is_ok)
      role = name_key(field_text(reader%cards, row, 3))
      if (.not. is_one_of(role, 'SLAVE|MASTER|SECONDARY|MAIN')) then
        call report_error(reader, row%line, 'The third field is ''' // field_text(reader%cards, row, 3) // '''; it must be ' // &
          'the role of the first surface: SLAVE or MASTER (or SECONDARY, MAIN).')
        cycle
      end if
      if (is_one_of(role, 'MASTER|MAIN')) pair = pair(2:1:-1)
      if (is_ok) rules%roles = reshape([rules%roles, pair], [2, size(rules%roles, 2) + 1])
    end do
  end subroutine read_roles


  !> SURFACE PROPERTY ASSIGNMENT: thickness and place of shells. The faces of solids lie where the mesh is; another place is
  !! refused.
  subroutine read_surface_properties(reader, model, c, properties)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c
    type(shell_property_type), allocatable, intent(inout) :: properties(:)
    type(shell_property_type) :: item
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: word, property
    integer :: surface
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    property = parameter_word(parameters, 'PROPERTY', '')
    do while (next_row(reader%cards, row))
      call read_surface(reader, model, row, 1, surface, is_ok)
      if (.not. (is_ok .and. is_one_of(property, 'THICKNESS|OFFSETFRACTION'))) cycle
      word = name_key(field_text(reader%cards, row, 2))
      if (has_shells(model, surface)) then
        item = shell_property_type(surface=surface, is_place=property == 'OFFSETFRACTION')
        call read_shell_property(reader, row, item)
        call check_sections(reader, model, row, item)
        properties = [properties, item]
      else if (.not. (word == '' .or. is_one_of(word, 'ORIGINAL|THINNING|SPOS|SNEG') .or. is_value(word, 0.0_DP))) then
        call report_error(reader, row%line, 'The second field is ''' // field_text(reader%cards, row, 2) // '''. The faces of ' // &
          'solids have no thickness and lie where the mesh is: ORIGINAL or 0. is allowed. Move the nodes, or give the pair a ' // &
          '*CLEARANCE.')
      end if
    end do
  end subroutine read_surface_properties


  !> The second and third field: ORIGINAL, a thickness and its factor, or a place.
  subroutine read_shell_property(reader, row, item)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(shell_property_type), intent(inout) :: item   !< in: its surface and property
    character(:), allocatable :: word, factor
    integer :: status
    word = name_key(field_text(reader%cards, row, 2))
    factor = field_text(reader%cards, row, 3)
    item%is_original = word == '' .or. word == 'ORIGINAL' .or. (word == 'THINNING' .and. .not. item%is_place)
    status = NUMBER_OK
    if (item%is_place .and. word == 'SPOS') then
      item%value = 0.5_DP
    else if (item%is_place .and. word == 'SNEG') then
      item%value = -0.5_DP
    else if (.not. item%is_original) then
      call parse_real(field_text(reader%cards, row, 2), item%value, status)
    end if
    if (item%is_place) then
      if (status == NUMBER_OK .and. abs(item%value) <= 0.5_DP .and. factor == '') return
      call report_error(reader, row%line, 'The fields are ''' // trim(field_text(reader%cards, row, 2) // ' ' // factor) // &
        '''. The place of the nodes of a shell over its thickness, from the middle along its normal, is ORIGINAL, SPOS (0.5), ' // &
        'SNEG (-0.5), or a number from -0.5 to 0.5.')
      return
    end if
    if (status == NUMBER_OK .and. factor /= '') call parse_real(factor, item%factor, status)
    if (status == NUMBER_OK .and. item%value >= 0.0_DP .and. item%factor > 0.0_DP) return
    call report_error(reader, row%line, 'The fields are ''' // trim(field_text(reader%cards, row, 2) // ' ' // factor) // &
      '''. The thickness of a shell is ORIGINAL, THINNING, or a number that is not negative; its factor is positive.')
  end subroutine read_shell_property


  !> Membranes are not in general contact, and NODAL THICKNESS varies over the faces: both have no other thickness or place.
  subroutine check_sections(reader, model, row, item)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(shell_property_type), intent(in) :: item
    integer, allocatable :: elements(:)
    integer :: i, e
    if (item%is_original .and. abs(item%factor - 1.0_DP) <= 0.0_DP) return
    elements = [(i, i=1, model%mesh%n_elements)]
    if (item%surface > 0) elements = model%surfaces(item%surface)%element
    do i = 1, size(elements)
      e = elements(i)
      if (.not. is_shell(model, e)) cycle
      if (is_two_sided(model%mesh%kind(e))) then
        call report_error(reader, row%line, 'General contact does not find membranes, as element ' // &
          to_text(model%mesh%element_label(e)) // ': they have no other thickness or place there. Leave them out of the ' // &
          'surface.')
        return
      end if
      if (.not. model%structure%sections(model%structure%section(e))%has_nodal_thickness) cycle
      call report_error(reader, row%line, 'Element ' // to_text(model%mesh%element_label(e)) // ' has a NODAL THICKNESS, ' // &
        'which varies over its faces: for it ORIGINAL is allowed.')
      return
    end do
  end subroutine check_sections


  !> Whether a surface, or the whole exterior, has faces of shells.
  pure logical function has_shells(model, surface)
    type(model_type), intent(in) :: model
    integer, intent(in) :: surface               !< index; 0: the whole exterior
    integer :: i
    if (surface == 0) then
      has_shells = any([(is_shell(model, i), i=1, model%mesh%n_elements)])
    else
      associate (elements => model%surfaces(surface)%element)
        has_shells = any([(is_shell(model, elements(i)), i=1, size(elements))])
      end associate
    end if
  end function has_shells


  !> Whether a field is this number.
  pure logical function is_value(field, value)
    character(*), intent(in) :: field
    real(DP), intent(in) :: value                !< with a short binary fraction
    real(DP) :: number
    integer :: status
    call parse_real(field, number, status)
    is_value = status == NUMBER_OK
    if (is_value) is_value = abs(number - value) <= 0.0_DP
  end function is_value


  !> The two surfaces of a row. A first one that is left out is the whole exterior, a second one is the first again.
  subroutine read_surfaces(reader, model, row, pair, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(out) :: pair(2)              !< indices; 0: the whole exterior
    logical, intent(out) :: is_ok
    logical :: is_second_ok
    call read_surface(reader, model, row, 1, pair(1), is_ok)
    call read_surface(reader, model, row, 2, pair(2), is_second_ok)
    is_ok = is_ok .and. is_second_ok
    if (field_text(reader%cards, row, 2) == '') pair(2) = pair(1)
  end subroutine read_surfaces


  !> The surface of a field: of element faces, or analytic.
  subroutine read_surface(reader, model, row, field, surface, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: field
    integer, intent(out) :: surface              !< index; 0: the field is empty
    logical, intent(out) :: is_ok
    character(:), allocatable :: name
    surface = 0
    is_ok = .true.
    name = field_text(reader%cards, row, field)
    if (name == '') return
    surface = reader%surfaces%find(name)
    is_ok = surface > 0 .and. surface <= size(model%surfaces)
    if (surface == 0) call report_error(reader, row%line, 'There is no surface ''' // name // '''' // &
      reader%surfaces%suggest(name))
    if (.not. is_ok) return
    is_ok = .not. model%surfaces(surface)%is_node_based
    if (.not. is_ok) call report_error(reader, row%line, 'The surface ''' // name // ''' is made of nodes; general contact ' // &
      'needs element faces.')
  end subroutine read_surface

end module amontons_deck_general_contact
