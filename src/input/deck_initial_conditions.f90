!> ORIENTATION, INITIAL CONDITIONS, and TEMPERATURE and FIELD over the steps.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_initial_conditions
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text, field_real
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_submodel, only: read_global_step, check_driven_nodes, check_driven_temperatures
  use amontons_deck_structure, only: spread_temperature, is_shell
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_real, read_integer, check_n_fields, &
    check_no_data, report_note, nodes_of_field, elements_of_field, find_amplitude, is_card, count_cards, check_name
  use amontons_element_kinds, only: is_membrane
  use amontons_loads, only: temperature_type, load_value
  use amontons_structural_data, only: interpolate_added_nodes
  use amontons_containers, only: name_table_type, list_groups
  use amontons_materials, only: orientation_type, SYSTEM_RECTANGULAR, SYSTEM_CYLINDRICAL, HISTORY_PEEQ, &
    HISTORY_INELASTIC, HISTORY_BACK, material_type, ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC, is_one_sided, &
    is_law_of_invariants, law_name, INELASTIC_NONE
  use amontons_model, only: model_type, with_pretension_copies, DIALECT_CALCULIX
  use amontons_structural_data, only: n_section_layers
  use amontons_text, only: to_text, name_key, parse_integer, NUMBER_OK, NUMBER_EMPTY
  implicit none
  private
  public :: read_orientations, read_initial_conditions
  public :: active_temperatures_type, init_temperatures, propagate_temperatures, read_temperature, get_step_temperatures, &
    truncate_temperatures

  integer, parameter :: DECK_VOIGT_ORDER(6) = [1, 2, 3, 4, 6, 5]   !< the decks order shears 12 13 23, the program xy yz xz

  !> The temperatures active at this point of the deck.
  type :: active_temperatures_type
    integer :: step = 0                          !< present step
    logical :: is_step = .false.                 !< STEP, AMPLITUDE=STEP
    real(DP), allocatable :: before(:)           !< (n_nodes) at the end of the step before [temperature]
    type(temperature_type), allocatable :: loads(:)   !< what acts in this step
    integer, allocatable :: at(:)                !< (n_nodes) index into loads, 0: none
    integer :: n = 0
  end type active_temperatures_type

contains

  !> ORIENTATION and DISTRIBUTION, and the sections that name them.
  subroutine read_orientations(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(name_table_type) :: names
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(orientation_type) :: orientation
    integer, allocatable :: distribution(:, :)   !< (2, orientations) its DISTRIBUTION cards of axes and of angles, 0: none
    integer :: c, k, n, cards(2)
    logical :: is_new
    n = count_cards(reader, 'ORIENTATION')
    allocate (model%orientations(n), distribution(2, n))
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'ORIENTATION')) cycle
      call open_card(reader, c, parameters, row)
      orientation = orientation_type()
      orientation%name = parameter_text(parameters, 'NAME')
      if (orientation%name == '') cycle
      call check_name(reader, c, orientation%name)
      orientation%system = merge(SYSTEM_CYLINDRICAL, SYSTEM_RECTANGULAR, &
        parameter_word(parameters, 'SYSTEM', 'RECTANGULAR') == 'CYLINDRICAL')
      call names%add(orientation%name, k, is_new)
      if (.not. is_new) then
        call report_error(reader, reader%cards%cards(c)%line, 'The orientation ''' // orientation%name // &
          ''' is defined twice.')
        cycle
      end if
      call read_axes(reader, c, row, orientation, cards)
      distribution(:, k) = cards
      model%orientations(k) = orientation
    end do
    if (names%n < n) model%orientations = model%orientations(:names%n)
    allocate (model%element_orientation(model%mesh%n_elements), source=0)
    call read_section_axes(reader, names, distribution, model)
    call set_membrane_axes(reader, names, distribution, model)
    if (allocated(model%structure)) call set_shell_axes(reader, names, distribution, model)
    if (size(model%orientations) == 0) deallocate (model%element_orientation)
    call check_laminae(reader, model)
  end subroutine read_orientations


  !> The data lines of an orientation.
  subroutine read_axes(reader, c, row, orientation, distribution)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row
    type(orientation_type), intent(inout) :: orientation
    integer, intent(out) :: distribution(2)      !< DISTRIBUTION cards that it names, of axes and of angles; 0: none
    real(DP) :: value
    integer :: status
    logical :: is_ok
    distribution = 0
    is_ok = .true.
    if (.not. next_row(reader%cards, row)) then
      call report_error(reader, reader%cards%cards(c)%line, '*ORIENTATION needs a data line: the coordinates of two points.')
      return
    end if
    call field_real(reader%cards, row, 1, value, status)
    if (status /= NUMBER_OK .and. status /= NUMBER_EMPTY) then
      call name_distribution(1)
    else
      call read_points(reader, row, 1, orientation, is_ok)
    end if
    if (.not. next_row(reader%cards, row)) return
    call check_n_fields(reader, row, 2)
    call read_integer(reader, row, 1, 'local axis', orientation%rotation_axis, is_ok, 1)
    call field_real(reader%cards, row, 2, value, status)
    if (status /= NUMBER_OK .and. status /= NUMBER_EMPTY) then
      call name_distribution(2)
    else
      call read_real(reader, row, 2, 'angle', orientation%rotation_angle, is_ok, 0.0_DP)
    end if
    orientation%rotation_angle = orientation%rotation_angle * PI / 180
    if (orientation%rotation_axis < 1 .or. orientation%rotation_axis > 3) call report_error(reader, row%line, &
      'The local axis to turn about must be 1, 2 or 3.')
    if (next_row(reader%cards, row)) call check_no_data(reader, row)

  contains

    !> Finds the distribution that a field of the row names: of axes in the first line, of angles in the second.
    subroutine name_distribution(i)
      integer, intent(in) :: i                   !< field and kind: 1 axes, 2 angles
      distribution(i) = find_distribution(reader, field_text(reader%cards, row, i))
      if (distribution(i) == 0) call report_error(reader, row%line, 'There is no distribution ''' // &
        field_text(reader%cards, row, i) // '''.')
    end subroutine name_distribution

  end subroutine read_axes


  !> The DISTRIBUTION card of a name; 0: unknown name.
  integer function find_distribution(reader, name) result(c)
    type(reader_type), intent(in) :: reader
    character(*), intent(in) :: name
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'DISTRIBUTION')) cycle
      call open_card(reader, c, parameters, row)
      if (name_key(parameter_text(parameters, 'NAME')) == name_key(name)) return
    end do
    c = 0
  end function find_distribution


  !> Two points, six coordinates.
  subroutine read_points(reader, row, first, orientation, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: first                 !< field of the first coordinate
    type(orientation_type), intent(inout) :: orientation
    logical, intent(inout) :: is_ok
    real(DP) :: x(6), cross(3)
    integer :: i
    call check_n_fields(reader, row, first + 5)
    do i = 1, 6
      call read_real(reader, row, first + i - 1, 'coordinate', x(i), is_ok, 0.0_DP)
    end do
    orientation%a = x(:3)
    orientation%b = x(4:)
    if (.not. is_ok) return
    associate (a => orientation%a, b => orientation%b)
      cross = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
      if (orientation%system == SYSTEM_CYLINDRICAL) then
        is_ok = norm2(b - a) > 0
      else
        is_ok = norm2(cross) > 1.0e-10_DP * norm2(a) * norm2(b)
      end if
    end associate
    if (.not. is_ok) call report_error(reader, row%line, 'These two points give no axes: they must not coincide, nor lie ' // &
      'on one line through the origin (RECTANGULAR).')
  end subroutine read_points


  !> ORIENTATION of the sections; a distribution defines one orientation for each of its lines.
  subroutine read_section_axes(reader, names, distribution, model)
    type(reader_type), intent(inout) :: reader
    type(name_table_type), intent(in) :: names
    integer, intent(in) :: distribution(:, :)    !< (2, orientations)
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: c, k, set
    do c = 1, reader%cards%n_cards
      if (.not. (is_card(reader, c, 'SOLIDSECTION') .or. is_card(reader, c, 'COHESIVESECTION'))) cycle
      call open_card(reader, c, parameters, row)
      if (parameter_text(parameters, 'ORIENTATION') == '') cycle
      k = names%find(parameter_text(parameters, 'ORIENTATION'))
      set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
      if (k == 0) call report_error(reader, reader%cards%cards(c)%line, 'There is no orientation ''' // &
        parameter_text(parameters, 'ORIENTATION') // '''.')
      if (k == 0 .or. set == 0) cycle
      associate (members => model%mesh%element_sets(set)%members)
        model%element_orientation(members) = k
        call read_distributions(reader, distribution(:, k), members, model)
      end associate
    end do
  end subroutine read_section_axes


  !> Axes of shells: each layer has an orientation of its own, projected on the shell. Where the deck names none, the global axes:
  !! in the calculix dialect always, in that of abaqus where the layers or the material have directions.
  subroutine set_shell_axes(reader, names, distribution, model)
    type(reader_type), intent(inout) :: reader
    type(name_table_type), intent(in) :: names
    integer, intent(in) :: distribution(:, :)    !< (2, orientations)
    type(model_type), intent(inout) :: model
    type(orientation_type) :: orientation
    integer, allocatable :: members(:), first(:), of_section(:)
    integer :: s, l, k, m, n
    logical :: is_given
    if (.not. allocated(model%structure%section)) return
    call list_groups(model%structure%section, size(model%structure%sections), first, of_section)
    n = size(model%orientations)
    do s = 1, size(model%structure%sections)
      associate (section => model%structure%sections(s), elements => of_section(first(s):first(s + 1) - 1))
        if (.not. allocated(section%orientation)) cycle
        do l = 1, n_section_layers(section)
          members = pack(elements, model%mesh%layer(elements) == l)
          if (size(members) == 0) cycle
          call find_layer_axes(reader, names, model, s, l, orientation, k, is_given)
          m = model%mesh%material(members(1))
          if (m == 0) cycle                        ! an unknown name, which is reported
          if (.not. (is_given .or. reader%dialect == DIALECT_CALCULIX .or. allocated(section%layers) .or. &
            has_directions(model%materials(m)))) cycle
          call append_orientation(model%orientations, n, orientation)
          model%element_orientation(members) = n
          if (k == 0) cycle
          if (all(distribution(:, k) == 0)) cycle
          model%orientations = model%orientations(:n)
          call read_distributions(reader, distribution(:, k), members, model)
          n = size(model%orientations)
        end do
      end associate
    end do
    model%orientations = model%orientations(:n)
  end subroutine set_shell_axes


  !> Appends an orientation to a list that grows to twice its size.
  subroutine append_orientation(orientations, n, orientation)
    type(orientation_type), allocatable, intent(inout) :: orientations(:)
    integer, intent(inout) :: n                  !< the first n count
    type(orientation_type), intent(in) :: orientation
    type(orientation_type), allocatable :: larger(:)
    if (n == size(orientations)) then
      allocate (larger(2 * n + 8))
      larger(:n) = orientations
      call move_alloc(larger, orientations)
    end if
    n = n + 1
    orientations(n) = orientation
  end subroutine append_orientation


  !> Axes of membranes: an orientation, or the global axes where the material has directions, projected on the membrane.
  subroutine set_membrane_axes(reader, names, distribution, model)
    type(reader_type), intent(inout) :: reader
    type(name_table_type), intent(in) :: names
    integer, intent(in) :: distribution(:, :)    !< (2, orientations)
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(orientation_type) :: orientation
    character(:), allocatable :: name
    integer :: c, k, n, set, material
    n = size(model%orientations)
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'MEMBRANESECTION')) cycle
      call open_card(reader, c, parameters, row)
      name = parameter_text(parameters, 'ORIENTATION')
      set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
      material = reader%materials%find(parameter_text(parameters, 'MATERIAL'))
      k = names%find(name)
      if (name /= '' .and. k == 0) call report_error(reader, reader%cards%cards(c)%line, 'There is no orientation ''' // name &
        // '''' // names%suggest(name))
      if (set == 0 .or. material == 0) cycle
      if (k == 0 .and. .not. has_directions(model%materials(material))) cycle
      orientation = orientation_type()
      if (k > 0) orientation = model%orientations(k)
      orientation%is_projected = .true.
      orientation%normal_axis = 3
      if (k > 0 .and. reader%dialect /= DIALECT_CALCULIX) orientation%normal_axis = max(1, orientation%rotation_axis)
      call append_orientation(model%orientations, n, orientation)
      associate (members => model%mesh%element_sets(set)%members)
        model%element_orientation(members) = n
        if (k == 0) cycle
        if (all(distribution(:, k) == 0)) cycle
        model%orientations = model%orientations(:n)
        call read_distributions(reader, distribution(:, k), members, model)
        n = size(model%orientations)
      end associate
    end do
    model%orientations = model%orientations(:n)
  end subroutine set_membrane_axes


  !> Laminae are in plane stress: they are materials of shells.
  subroutine check_laminae(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer :: e
    do e = 1, model%mesh%n_elements
      if (model%mesh%material(e) == 0) cycle
      if (.not. model%materials(model%mesh%material(e))%is_lamina) cycle
      if (is_shell(model, e)) cycle
      call report_error(reader, 0, 'The material ''' // model%materials(model%mesh%material(e))%name // ''' of element ' // &
        to_text(model%mesh%element_label(e)) // ' has *ELASTIC, TYPE=LAMINA, which is for shells. Use ENGINEERING CONSTANTS.')
      return
    end do
  end subroutine check_laminae


  !> Whether a material is not the same in all directions.
  pure logical function has_directions(material)
    type(material_type), intent(in) :: material
    has_directions = material%elastic_kind == ELASTIC_ORTHOTROPIC .or. material%elastic_kind == ELASTIC_ANISOTROPIC .or. &
      material%is_shell_law
    if (allocated(material%expansion%value)) has_directions = has_directions .or. size(material%expansion%value, 1) > 1
  end function has_directions


  !> The orientation of a layer of a section: its own, that of the section with its angle, or the global axes.
  subroutine find_layer_axes(reader, names, model, s, l, orientation, k, is_given)
    type(reader_type), intent(inout) :: reader
    type(name_table_type), intent(in) :: names
    type(model_type), intent(in) :: model
    integer, intent(in) :: s, l                  !< section, layer
    type(orientation_type), intent(out) :: orientation
    integer, intent(out) :: k                    !< the orientation of the deck; 0: none
    logical, intent(out) :: is_given             !< the deck names one
    character(:), allocatable :: name
    integer :: line                              ! where it is named
    logical :: is_own
    associate (section => model%structure%sections(s))
      name = section%orientation
      line = section%deck_line
      is_own = .false.
      if (allocated(section%layers)) is_own = section%layers(l)%orientation /= ''
      if (is_own) then
        name = section%layers(l)%orientation
        line = section%layers(l)%line
      end if
      k = names%find(name)
      is_given = name /= ''
      if (is_given .and. k == 0) call report_error(reader, line, 'There is no orientation ''' // name // '''' // &
        names%suggest(name))
      if (k > 0) orientation = model%orientations(k)
      orientation%is_projected = .true.
      orientation%normal_axis = 3
      if (k > 0 .and. reader%dialect /= DIALECT_CALCULIX) orientation%normal_axis = max(1, orientation%rotation_axis)
      if (allocated(section%layers)) orientation%layer_angle = section%layers(l)%angle
    end associate
  end subroutine find_layer_axes


  !> The distributions of an orientation for the elements of a section: axes, then angles about one of them.
  subroutine read_distributions(reader, cards, members, model)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: cards(2)              !< DISTRIBUTION cards of axes and of angles; 0: none
    integer, intent(in) :: members(:)            !< elements of the section
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(orientation_type) :: orientation
    type(orientation_type), allocatable :: orientations(:)   ! and capacity for more
    integer, allocatable :: elements(:), base(:), last_row(:), turned(:)
    logical :: is_inside(model%mesh%n_elements), is_ok
    integer :: kind, i, n, b, n_rows
    if (size(members) == 0 .or. all(cards == 0)) return
    is_inside = .false.
    is_inside(members) = .true.
    n = size(model%orientations)
    orientations = model%orientations
    orientation = orientations(model%element_orientation(members(1)))   ! its system
    do kind = 1, 2
      if (cards(kind) == 0) cycle
      base = model%element_orientation           ! orientations before the lines of this card
      allocate (last_row(n), turned(n), source=0)
      call open_card(reader, cards(kind), parameters, row)
      n_rows = 0
      do while (next_row(reader%cards, row))
        n_rows = n_rows + 1
        call read_distribution_row(reader, row, kind, orientation, is_ok)
        if (field_text(reader%cards, row, 1) == '') then
          elements = members
        else
          call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
        end if
        if (.not. is_ok) cycle
        do i = 1, size(elements)
          if (.not. is_inside(elements(i))) cycle
          b = base(elements(i))
          if (last_row(b) /= n_rows) call add_orientation(b)
          model%element_orientation(elements(i)) = turned(b)
        end do
      end do
      deallocate (last_row, turned)
    end do
    model%orientations = orientations(:n)

  contains

    !> Adds the orientation of the row, with all else as in another one.
    subroutine add_orientation(old)
      integer, intent(in) :: old
      type(orientation_type) :: like
      like = orientations(old)
      call append_orientation(orientations, n, like)
      if (kind == 1) orientations(n)%a = orientation%a
      if (kind == 1) orientations(n)%b = orientation%b
      if (kind == 2) orientations(n)%rotation_angle = orientation%rotation_angle
      last_row(old) = n_rows
      turned(old) = n
    end subroutine add_orientation

  end subroutine read_distributions


  !> A row of a distribution behind its first field: six coordinates, or an angle in degrees.
  subroutine read_distribution_row(reader, row, kind, orientation, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: kind                  !< 1: axes, 2: angles
    type(orientation_type), intent(inout) :: orientation
    logical, intent(out) :: is_ok
    is_ok = .true.
    if (kind == 1) then
      call read_points(reader, row, 2, orientation, is_ok)
      return
    end if
    call check_n_fields(reader, row, 2)
    call read_real(reader, row, 2, 'angle', orientation%rotation_angle, is_ok)
    orientation%rotation_angle = orientation%rotation_angle * PI / 180
  end subroutine read_distribution_row


  !> INITIAL CONDITIONS.
  subroutine read_initial_conditions(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: what
    integer :: c, variable
    if (n_predefined(model) > model%mesh%n_nodes) allocate (model%initial_temperature(n_predefined(model)), source=0.0_DP)
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'INITIALCONDITIONS')) cycle
      call open_card(reader, c, parameters, row)
      what = parameter_word(parameters, 'TYPE', '')
      if (what == 'DISPLACEMENT') call report_note(reader, reader%cards%cards(c)%line, &
        'Initial displacements have no effect in a ' // &
        'static step: the loads and supports of the first increment decide where it ends, as in CalculiX.')
      if (what == 'TEMPERATURE' .and. .not. allocated(model%initial_temperature)) &
        allocate (model%initial_temperature(n_predefined(model)), source=0.0_DP)
      variable = 0
      if (what == 'FIELD') call read_variable(reader, c, parameters, model, variable)
      if (what == 'STRESS' .and. .not. allocated(model%initial_stress)) &
        allocate (model%initial_stress(6, model%mesh%n_points), source=0.0_DP)
      if ((what == 'PLASTICSTRAIN' .or. what == 'HARDENING') .and. .not. allocated(model%initial_history)) &
        allocate (model%initial_history(HISTORY_BACK + 5, model%mesh%n_points), source=0.0_DP)
      if (has_parameter(parameters, 'USER')) then
        if (what /= 'SOLUTION') call report_error(reader, reader%cards%cards(c)%line, 'USER goes with TYPE=SOLUTION alone.')
        model%has_sdvini = .true.
      else if (what == 'SOLUTION') then
        call read_initial_variables(reader, row, model)
      end if
      do while (next_row(reader%cards, row))
        select case (what)
        case ('TEMPERATURE', 'FIELD')
          if (variable >= 0) call read_initial_temperature(reader, row, variable, model)
        case ('STRESS', 'PLASTICSTRAIN', 'HARDENING')
          call read_initial_points(reader, row, what, model)
        end select
      end do
    end do
    if (allocated(model%structure) .and. allocated(model%initial_temperature)) call interpolate_added_nodes(model%structure, &
      model%mesh%n_nodes, model%initial_temperature)
  end subroutine read_initial_conditions


  !> Rows: element or element set, seven STATEV; then eight in a line up to the number of the material.
  subroutine read_initial_variables(reader, row, model)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    type(model_type), intent(inout) :: model
    integer, allocatable :: elements(:)
    real(DP), allocatable :: values(:)
    integer :: i, k, n, first
    logical :: is_ok
    n = 0
    if (size(model%materials) > 0) n = maxval(model%materials%n_statev)
    if (.not. allocated(model%initial_statev)) allocate (model%initial_statev(n, model%mesh%n_points), source=0.0_DP)
    do i = 1, model%mesh%n_elements
      if (model%mesh%material(i) == 0) cycle
      k = model%materials(model%mesh%material(i))%deletion
      if (k > 0) model%initial_statev(k, model%mesh%point_first(i):model%mesh%point_first(i + 1) - 1) = 1
    end do
    do while (next_row(reader%cards, row))
      is_ok = .true.
      call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
      if (.not. is_ok .or. size(elements) == 0) cycle
      n = 0
      do i = 1, size(elements)
        if (model%mesh%material(elements(i)) > 0) n = max(n, model%materials(model%mesh%material(elements(i)))%n_statev)
      end do
      if (any(model%materials%inelastic_law /= INELASTIC_NONE)) call report_error(reader, row%line, 'Laws by the name of the ' // &
        'material start from rest: TYPE=SOLUTION is for UMAT and USDFLD.')
      if (n == 0) call report_error(reader, row%line, 'The material of these elements has no *DEPVAR: there are no STATEV to set.')
      allocate (values(n), source=0.0_DP)
      first = 2
      k = 0
      do
        call check_n_fields(reader, row, min(first - 1 + n - k, 8))
        do i = first, min(first - 1 + n - k, 8)
          call read_real(reader, row, i, 'STATEV', values(k + i - first + 1), is_ok, 0.0_DP)
        end do
        k = min(n, k + 9 - first)
        if (k >= n) exit
        first = 1
        if (.not. next_row(reader%cards, row)) exit
      end do
      do i = 1, merge(size(elements), 0, is_ok)
        associate (e => elements(i))
          model%initial_statev(:n, model%mesh%point_first(e):model%mesh%point_first(e + 1) - 1) = &
            spread(values, 2, model%mesh%point_first(e + 1) - model%mesh%point_first(e))
        end associate
      end do
      deallocate (values)
    end do
  end subroutine read_initial_variables


  !> The number of temperatures and of values of field variables at the nodes, as far as tables are over them or UMAT gets them.
  pure integer function n_predefined(model)
    type(model_type), intent(in) :: model
    n_predefined = model%mesh%n_nodes * (1 + maxval([0, model%materials%table_variable, model%materials%n_fields]))
  end function n_predefined


  !> The number of a field variable; -1: no table is over it, so that its values have no effect.
  subroutine read_variable(reader, c, parameters, model, variable)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(model_type), intent(in) :: model
    integer, intent(out) :: variable
    integer :: status
    call parse_integer(parameter_word(parameters, 'VARIABLE', '1'), variable, status)
    if (status /= NUMBER_OK .or. variable < 1) then
      call report_error(reader, reader%cards%cards(c)%line, 'VARIABLE must be the number of a field variable: 1, 2, ...')
      variable = -1
    else if (all(model%materials%table_variable /= variable .and. model%materials%n_fields < variable)) then
      call report_note(reader, reader%cards%cards(c)%line, 'No property of a material depends on field variable ' // &
        to_text(variable) // '; its values have no effect.')
      variable = -1
    end if
  end subroutine read_variable


  !> Row: node or node set, temperature; gradients of shells may follow and are ignored.
  subroutine read_initial_temperature(reader, row, variable, model)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: variable              !< field variable, or 0: the temperature
    type(model_type), intent(inout) :: model
    integer, allocatable :: nodes(:)
    real(DP), allocatable :: values(:)
    logical :: is_ok
    is_ok = .true.
    call read_node_temperatures(reader, row, model, nodes, values, is_ok)
    if (is_ok) model%initial_temperature(variable * model%mesh%n_nodes + nodes) = values
  end subroutine read_initial_temperature


  !> Row: node or node set, temperature, at shells and beams its gradients: of the nodes and of those into which they expand.
  subroutine read_node_temperatures(reader, row, model, nodes, values, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(model_type), intent(in) :: model
    integer, allocatable, intent(out) :: nodes(:)
    real(DP), allocatable, intent(out) :: values(:)   !< [temperature]
    logical, intent(inout) :: is_ok
    integer, allocatable :: named(:)
    real(DP) :: value(3)
    integer :: i
    call nodes_of_field(reader, model%mesh, row, 1, named, is_ok)
    call read_real(reader, row, 2, 'temperature', value(1), is_ok, 0.0_DP)
    value(2:) = 0
    if (allocated(model%structure)) then
      do i = 2, 3
        call read_real(reader, row, i + 1, 'gradient of the temperature', value(i), is_ok, 0.0_DP)
      end do
    end if
    call spread_temperature(model, with_pretension_copies(model, named), value(1), value(2:), nodes, values)
  end subroutine read_node_temperatures


  !> Row: element or element set, in the calculix dialect an integration point, then six components; HARDENING has the
  !! equivalent plastic strain before them.
  subroutine read_initial_points(reader, row, what, model)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: what             !< STRESS, PLASTICSTRAIN or HARDENING
    type(model_type), intent(inout) :: model
    integer, allocatable :: elements(:)
    real(DP) :: x(7)
    integer :: point, i, p, first, last, n
    logical :: is_ok
    is_ok = .true.
    call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
    first = 2
    point = 0
    if (reader%dialect == DIALECT_CALCULIX .and. what /= 'HARDENING') then
      call read_integer(reader, row, 2, 'integration point', point, is_ok)
      first = 3
    end if
    n = merge(7, 6, what == 'HARDENING')
    call check_n_fields(reader, row, first + n - 1)
    do i = 1, n
      call read_real(reader, row, first + i - 1, 'component', x(i), is_ok, 0.0_DP)
    end do
    if (.not. is_ok) return
    do i = 1, size(elements)
      if (first == 3 .and. is_membrane(model%mesh%kind(elements(i)))) then
        call report_error(reader, row%line, 'The element ' // to_text(model%mesh%element_label(elements(i))) // ' is a ' // &
          'membrane: CalculiX numbers the points of a solid here. Use --dialect=abaqus, with one line for all points.')
        return
      end if
      if (model%mesh%material(elements(i)) > 0) then
        associate (material => model%materials(model%mesh%material(elements(i))))
          if ((is_one_sided(material) .or. is_law_of_invariants(material) .or. material%is_corotational) .and. what /= &
            'HARDENING') then
            call report_error(reader, row%line, 'The element ' // to_text(model%mesh%element_label(elements(i))) // &
              ' has the law ''' // trim(law_name(material)) // '''; it can have no initial stress and no plastic strain.')
            return
          end if
          if (what == 'HARDENING' .and. material%inelastic_law /= INELASTIC_NONE) then
            call report_error(reader, row%line, 'The element ' // to_text(model%mesh%element_label(elements(i))) // &
              ' has the law ''' // trim(law_name(material)) // ''', which starts from rest: HARDENING is for *PLASTIC.')
            return
          end if
        end associate
      end if
      p = model%mesh%point_first(elements(i))
      last = model%mesh%point_first(elements(i) + 1) - 1
      if (first == 3 .and. (point < 1 .or. p + point - 1 > last)) then
        call report_error(reader, row%line, 'The element ' // to_text(model%mesh%element_label(elements(i))) // &
          ' has no integration point ' // to_text(point) // '; it has ' // to_text(last - p + 1) // '.')
        return
      end if
      if (first == 3) p = p + point - 1
      if (first == 3) last = p
      if (what == 'STRESS') then
        model%initial_stress(:, p:last) = spread(x(DECK_VOIGT_ORDER), 2, last - p + 1)
      else if (what == 'PLASTICSTRAIN') then
        model%initial_history(HISTORY_INELASTIC:HISTORY_INELASTIC + 5, p:last) = spread(x(DECK_VOIGT_ORDER), 2, last - p + 1)
      else
        model%initial_history(HISTORY_PEEQ, p:last) = x(1)
        model%initial_history(HISTORY_BACK:HISTORY_BACK + 5, p:last) = spread(x(1 + DECK_VOIGT_ORDER), 2, last - p + 1)
      end if
    end do
  end subroutine read_initial_points


  !> The temperatures before the first step.
  subroutine init_temperatures(model, thermal)
    type(model_type), intent(in) :: model
    type(active_temperatures_type), intent(out) :: thermal
    allocate (thermal%before(n_predefined(model)), source=0.0_DP)
    if (allocated(model%initial_temperature)) thermal%before = model%initial_temperature
    allocate (thermal%at(n_predefined(model)), source=0)
    allocate (thermal%loads(0))
  end subroutine init_temperatures


  !> Starts a step: all nodes keep their temperature of the end of the last step; amplitudes in total time
  !! continue.
  subroutine propagate_temperatures(model, period, total_time, is_step, thermal)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: period               !< length of the step before [time]
    real(DP), intent(in) :: total_time           !< total time at its end [time]
    logical, intent(in) :: is_step               !< AMPLITUDE=STEP holds in the new step
    type(active_temperatures_type), intent(inout) :: thermal
    integer :: i, n
    thermal%step = thermal%step + 1
    thermal%is_step = is_step
    n = 0
    do i = 1, thermal%n
      associate (load => thermal%loads(i))
        thermal%before(load%node) = load_value(load, model%amplitudes, period, total_time, period)
        thermal%at(load%node) = 0
        if (load%global_step /= 0) thermal%before(load%node) = huge(1.0_DP)      ! set with the results of the global model
        if (load%amplitude == 0) cycle
        if (.not. model%amplitudes(load%amplitude)%is_total_time) cycle
        n = n + 1
        thermal%loads(n) = load
        thermal%at(load%node) = n
      end associate
    end do
    thermal%n = n
  end subroutine propagate_temperatures


  !> Values of the temperatures of a step that ends early.
  subroutine truncate_temperatures(thermal, fraction)
    type(active_temperatures_type), intent(inout) :: thermal
    real(DP), intent(in) :: fraction             !< of the step that was done [-]
    integer :: i
    do i = 1, thermal%n
      associate (load => thermal%loads(i))
        if (load%amplitude == 0 .and. load%global_step == 0) load%end = load%start + (load%end - load%start) * fraction
      end associate
    end do
  end subroutine truncate_temperatures


  !> TEMPERATURE or FIELD in the current step.
  subroutine read_temperature(reader, model, c, thermal)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(active_temperatures_type), intent(inout) :: thermal
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    real(DP), allocatable :: values(:)
    real(DP) :: value
    type(temperature_type) :: common
    integer :: i, variable, first
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    call find_amplitude(reader, c, parameters, common%amplitude)
    call read_global_step(reader, c, parameters, thermal%step, common%global_step)
    if (has_parameter(parameters, 'SUBMODEL') .and. common%global_step == 0) return      ! reported
    common%line = reader%cards%line_number(reader%cards%cards(c)%line)
    common%is_time_scaled = has_parameter(parameters, 'TIMESCALE')
    variable = 0
    if (is_card(reader, c, 'FIELD')) call read_variable(reader, c, parameters, model, variable)
    if (variable < 0) return
    first = variable * model%mesh%n_nodes
    if (parameter_word(parameters, 'OP', 'MOD') == 'NEW') then
      do i = first + 1, first + model%mesh%n_nodes
        value = 0
        if (allocated(model%initial_temperature)) value = model%initial_temperature(i)
        if (abs(value - thermal%before(i)) > 0 .or. thermal%at(i) > 0) call set_temperature(i, value, temperature_type(), thermal)
      end do
    end if
    do while (next_row(reader%cards, row))
      is_ok = .true.
      call read_node_temperatures(reader, row, model, nodes, values, is_ok)
      if (is_ok .and. common%global_step /= 0) then
        call check_driven_temperatures(reader, model, row, nodes, is_ok)
        if (is_ok) call check_driven_nodes(reader, model, row, nodes, is_ok)
        if (is_ok .and. row%n > 1) then
          if (field_text(reader%cards, row, 2) /= '') call report_error(reader, row%line, 'The global model gives the ' // &
            'temperature: write the node or node set alone.')
        end if
      end if
      if (.not. is_ok) cycle
      do i = 1, size(nodes)
        call set_temperature(first + nodes(i), values(i), common, thermal)
      end do
    end do
  end subroutine read_temperature


  !> The temperature of one node at the end of the step.
  subroutine set_temperature(node, value, common, thermal)
    integer, intent(in) :: node
    real(DP), intent(in) :: value                !< [temperature]
    type(temperature_type), intent(in) :: common !< with amplitude and global_step
    type(active_temperatures_type), intent(inout) :: thermal
    type(temperature_type), allocatable :: larger(:)
    integer :: i
    i = thermal%at(node)
    if (i == 0) then
      if (thermal%n == size(thermal%loads)) then
        allocate (larger(max(256, 2 * thermal%n)))
        larger(:thermal%n) = thermal%loads(:thermal%n)
        call move_alloc(larger, thermal%loads)
      end if
      thermal%n = thermal%n + 1
      i = thermal%n
      thermal%at(node) = i
    end if
    associate (load => thermal%loads(i))
      load = common
      load%node = node
      load%start = merge(value, thermal%before(node), thermal%is_step)
      load%end = value
      load%is_from_current = .not. thermal%is_step
    end associate
  end subroutine set_temperature


  !> The list of the current step.
  subroutine get_step_temperatures(thermal, temperatures)
    type(active_temperatures_type), intent(in) :: thermal
    type(temperature_type), allocatable, intent(out) :: temperatures(:)
    temperatures = thermal%loads(:thermal%n)
  end subroutine get_step_temperatures

end module amontons_deck_initial_conditions
