!> AMPLITUDE, SURFACE and EQUATION to the model.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_surfaces
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text, field_integer, line_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, read_integer, check_n_fields, &
    read_user_constants, nodes_of_field, elements_of_field, is_card, check_name
  use amontons_deck_analytic_surfaces, only: read_profile, is_analytic_type
  use amontons_deck_structure, only: is_shell, is_shell_edge, structural_face, OTHER_LAYER
  use amontons_deck_faces, only: node_elements_type, find_free_faces, find_omitted_faces, count_shared_faces
  use amontons_loads, only: amplitude_type, equation_type, equation_list_type, AMPLITUDE_TABLE, AMPLITUDE_SMOOTH_STEP, &
    AMPLITUDE_PERIODIC, AMPLITUDE_MODULATED, AMPLITUDE_DECAY
  use amontons_containers, only: integer_list_type, sort_integers
  use amontons_mesh, only: mesh_type, numbered_face
  use amontons_model, only: model_type, dof_direction, DIALECT_CALCULIX
  use amontons_surfaces, only: surface_type
  use amontons_user_routines, only: USER_NAME_LENGTH
  use amontons_text, only: to_text, name_key, is_one_of, parse_real, plural, verb, NUMBER_OK, NEWLINE
  use amontons_element_kinds, only: element_kind_type, element_kind, facet_kind_type, facet_kind
  implicit none
  private
  public :: read_heading, read_amplitudes, read_surfaces, read_equations, find_slave_surface
  public :: face_number, fill_surface_nodes

  character(*), parameter :: NODE_SURFACE_SUFFIX = '\NODES'   !< behind the name of a surface of nodes that shares its name

  !> Terms of one equation during reading.
  type :: terms_type
    integer :: n = 0
    integer, allocatable :: node(:, :)           !< (n copies, n terms) nodes; a set gives several copies
    integer, allocatable :: dof(:)
    real(DP), allocatable :: coefficient(:)
  end type terms_type

contains

  !> HEADING: the text, lines joined by newline.
  subroutine read_heading(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer :: c, line
    model%heading = ''
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'HEADING')) cycle
      do line = reader%cards%cards(c)%data_first, reader%cards%cards(c)%data_last
        call add_heading_line(reader, line, model%heading)
      end do
    end do
  end subroutine read_heading


  !> Adds one line to the heading; comments and blank lines are omitted.
  subroutine add_heading_line(reader, line, heading)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: line
    character(:), allocatable, intent(inout) :: heading
    character(:), allocatable :: text
    text = line_text(reader%cards, line)
    text = trim(adjustl(text))
    if (text == '') return
    if (len(text) >= 2) then
      if (text(1:2) == '**') return
    end if
    if (heading /= '') heading = heading // NEWLINE
    heading = heading // text
  end subroutine add_heading_line


  !> AMPLITUDE: pairs time, factor in rows of any length; times ascend.
  subroutine read_amplitudes(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(amplitude_type) :: amplitude
    integer :: c, position
    logical :: is_new
    allocate (model%amplitudes(0))
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'AMPLITUDE')) cycle
      call open_card(reader, c, parameters, row)
      amplitude%name = parameter_text(parameters, 'NAME')
      if (amplitude%name == '') cycle
      call check_name(reader, c, amplitude%name)
      amplitude%is_total_time = parameter_word(parameters, 'TIME', 'STEPTIME') == 'TOTALTIME'
      amplitude%is_absolute = parameter_word(parameters, 'VALUE', 'RELATIVE') == 'ABSOLUTE'
      if (amplitude%is_absolute .and. reader%dialect == DIALECT_CALCULIX) then
        call report_note(reader, reader%cards%cards(c)%line, &
          'VALUE is not known to CalculiX and is passed over: the values are factors.')
        amplitude%is_absolute = .false.
      end if
      call read_amplitude_definition(reader, c, parameters, row, amplitude)
      call reader%amplitudes%add(amplitude%name, position, is_new)
      if (is_new) then
        model%amplitudes = [model%amplitudes, amplitude]
      else
        call report_error(reader, reader%cards%cards(c)%line, 'The amplitude ''' // amplitude%name // &
          ''' is defined twice.')
      end if
    end do
    call delay_amplitudes(reader, model)
  end subroutine read_amplitudes


  !> The data of an amplitude, by its DEFINITION.
  subroutine read_amplitude_definition(reader, c, parameters, row, amplitude)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    type(amplitude_type), intent(inout) :: amplitude
    real(DP), allocatable :: numbers(:)
    integer :: n
    character(:), allocatable :: definition
    definition = parameter_word(parameters, 'DEFINITION', 'TABULAR')
    amplitude%shape = AMPLITUDE_TABLE
    if (allocated(amplitude%formula_constants)) deallocate (amplitude%formula_constants)
    amplitude%time = [0.0_DP]                    ! until there is something better
    amplitude%factor = [0.0_DP]
    if (definition /= 'EQUALLYSPACED' .and. (has_parameter(parameters, 'FIXED INTERVAL') .or. &
      has_parameter(parameters, 'BEGIN'))) call report_error(reader, reader%cards%cards(c)%line, &
      'FIXED INTERVAL and BEGIN belong to DEFINITION=EQUALLY SPACED.')
    amplitude%is_user = definition == 'USER'
    select case (definition)
    case ('USER')
      call read_user_amplitude(reader, c, parameters, row, amplitude)
    case ('TABULAR', 'SMOOTHSTEP')
      if (definition == 'SMOOTHSTEP') amplitude%shape = AMPLITUDE_SMOOTH_STEP
      call read_amplitude_table(reader, row, amplitude)
    case ('EQUALLYSPACED')
      call read_numbers(reader, row, 1, numbers)
      call set_equal_spacing(reader, c, parameters, numbers, amplitude)
    case default
      call read_numbers(reader, row, 4, numbers)
      n = size(numbers)
      call order_formula_constants(definition, numbers, amplitude)
      if (.not. allocated(amplitude%formula_constants)) then
        amplitude%shape = AMPLITUDE_TABLE
        if (n > 0) call report_error(reader, reader%cards%cards(c)%line, &
          'PERIODIC needs the number n of terms, omega, t0, A0 and ' // &
          'below them n pairs A, B; MODULATED needs A0, A, t0, omega 1, omega 2; DECAY needs A0, A, t0 and a positive td.')
      end if
    end select
    amplitude%time = amplitude%time + parameter_real(parameters, 'SHIFTX', 0.0_DP)
    amplitude%factor = amplitude%factor + parameter_real(parameters, 'SHIFTY', 0.0_DP)
    if (amplitude%shape >= AMPLITUDE_PERIODIC .and. (has_parameter(parameters, 'SHIFTX') .or. &
      has_parameter(parameters, 'SHIFTY'))) call report_error(reader, reader%cards%cards(c)%line, &
      'SHIFTX and SHIFTY shift tables; write the shifted numbers.')
  end subroutine read_amplitude_definition


  !> The constants of a formula in the order of amplitude_type; unallocated if they are invalid.
  pure subroutine order_formula_constants(definition, numbers, amplitude)
    character(*), intent(in) :: definition       !< PERIODIC, MODULATED or DECAY
    real(DP), intent(in) :: numbers(:)
    type(amplitude_type), intent(inout) :: amplitude
    integer :: n
    n = size(numbers)
    select case (definition)
    case ('PERIODIC')
      amplitude%shape = AMPLITUDE_PERIODIC
      if (n < 4) return
      if (nint(numbers(1)) >= 1 .and. n == 4 + 2 * nint(min(numbers(1), 1.0e6_DP))) amplitude%formula_constants = numbers(2:)
    case ('MODULATED')
      amplitude%shape = AMPLITUDE_MODULATED
      if (n == 5) amplitude%formula_constants = numbers
    case default
      amplitude%shape = AMPLITUDE_DECAY
      if (n /= 4) return
      if (numbers(4) > 0) amplitude%formula_constants = numbers
    end select
  end subroutine order_formula_constants


  !> EQUALLY SPACED: factors at times BEGIN + i FIXED INTERVAL.
  subroutine set_equal_spacing(reader, c, parameters, numbers, amplitude)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    real(DP), intent(in) :: numbers(:)
    type(amplitude_type), intent(inout) :: amplitude
    real(DP) :: interval
    integer :: i
    interval = parameter_real(parameters, 'FIXED INTERVAL', 0.0_DP)
    if (.not. interval > 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'DEFINITION=EQUALLY SPACED needs a positive FIXED INTERVAL.')
    else if (size(numbers) > 0) then
      amplitude%time = [(parameter_real(parameters, 'BEGIN', 0.0_DP) + real(i, DP) * interval, i=0, size(numbers) - 1)]
      amplitude%factor = numbers
    end if
  end subroutine set_equal_spacing


  !> All numbers in the rows of a card; reports too few.
  subroutine read_numbers(reader, row, n_least, numbers)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    integer, intent(in) :: n_least
    real(DP), allocatable, intent(out) :: numbers(:)   !< empty after an error
    real(DP) :: value
    integer :: i
    logical :: is_ok
    allocate (numbers(0))
    is_ok = .true.
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        call read_real(reader, row, i, 'number', value, is_ok, 0.0_DP)
        numbers = [numbers, value]
      end do
    end do
    if (is_ok .and. size(numbers) < n_least) call report_error(reader, row%line, 'This amplitude needs at least ' // &
      plural(n_least, 'number') // '.')
    if (.not. is_ok .or. size(numbers) < n_least) numbers = [real(DP) ::]
  end subroutine read_numbers


  !> AMPLITUDE, DEFINITION=USER: the properties and variables of UAMP. The factor is zero until the first call.
  subroutine read_user_amplitude(reader, c, parameters, row, amplitude)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    type(amplitude_type), intent(inout) :: amplitude
    integer :: n
    amplitude%is_total_time = .true.
    amplitude%time = [0.0_DP]
    amplitude%factor = [0.0_DP]
    n = nint(min(max(parameter_real(parameters, 'PROPERTIES', 0.0_DP), 0.0_DP), 1.0e6_DP))
    amplitude%n_svars = nint(min(max(parameter_real(parameters, 'VARIABLES', 0.0_DP), 0.0_DP), 1.0e6_DP))
    if (allocated(amplitude%props)) deallocate (amplitude%props)
    allocate (amplitude%props(n), source=0.0_DP)
    if (len(amplitude%name) > USER_NAME_LENGTH) call report_error(reader, reader%cards%cards(c)%line, &
      'The name of an amplitude ' // &
      'that UAMP is given has at most ' // to_text(USER_NAME_LENGTH) // ' letters.')
    call read_user_constants(reader, c, row, 'PROPERTIES', amplitude%props)
  end subroutine read_user_amplitude


  !> The value of a numeric parameter; the default if absent or invalid (already reported).
  function parameter_real(parameters, name, default) result(value)
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name
    real(DP), intent(in) :: default
    real(DP) :: value
    integer :: status
    value = default
    if (.not. has_parameter(parameters, name)) return
    call parse_real(parameter_text(parameters, name), value, status)
    if (status /= NUMBER_OK) value = default
  end function parameter_real


  !> Gives cards with TIME DELAY a shifted copy of their amplitude.
  subroutine delay_amplitudes(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(amplitude_type) :: amplitude
    integer :: c, found
    allocate (reader%delayed_amplitude(reader%cards%n_cards), source=0)
    do c = 1, reader%cards%n_cards
      if (.not. (is_card(reader, c, 'BOUNDARY') .or. is_card(reader, c, 'CLOAD') .or. is_card(reader, c, 'DLOAD') .or. &
        is_card(reader, c, 'DSLOAD'))) cycle
      call open_card(reader, c, parameters, row)
      if (.not. has_parameter(parameters, 'TIME DELAY')) cycle
      found = reader%amplitudes%find(parameter_text(parameters, 'AMPLITUDE'))
      if (found == 0) then
        if (.not. has_parameter(parameters, 'AMPLITUDE')) call report_error(reader, reader%cards%cards(c)%line, &
          'TIME DELAY needs an AMPLITUDE that it delays.')
        cycle
      end if
      if (model%amplitudes(found)%shape >= AMPLITUDE_PERIODIC) call report_error(reader, reader%cards%cards(c)%line, &
        'TIME DELAY delays tables; give the formula of the amplitude ''' // model%amplitudes(found)%name // ''' a later t0.')
      amplitude = model%amplitudes(found)
      if (amplitude%is_user) call report_error(reader, reader%cards%cards(c)%line, &
        'TIME DELAY is not for an amplitude that UAMP gives.')
      amplitude%time = amplitude%time + parameter_real(parameters, 'TIME DELAY', 0.0_DP)
      model%amplitudes = [model%amplitudes, amplitude]
      reader%delayed_amplitude(c) = size(model%amplitudes)
    end do
  end subroutine delay_amplitudes


  !> The rows of an amplitude.
  subroutine read_amplitude_table(reader, row, amplitude)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    type(amplitude_type), intent(inout) :: amplitude
    real(DP), allocatable :: numbers(:)
    real(DP) :: value
    integer :: i, n
    logical :: is_ok
    allocate (numbers(0))
    is_ok = .true.
    do while (next_row(reader%cards, row))
      if (modulo(row%n, 2) /= 0) then
        call report_error(reader, row%line, 'An amplitude has pairs of time and factor; this line has an odd number ' // &
          'of values. CalculiX takes the factor that is missing as 0: write it.')
        is_ok = .false.
      end if
      do i = 1, row%n
        call read_real(reader, row, i, trim(merge('time  ', 'factor', modulo(i, 2) == 1)), value, is_ok)
        numbers = [numbers, value]
      end do
    end do
    n = size(numbers) / 2
    if (is_ok .and. n == 0) then
      call report_error(reader, row%line, 'An amplitude needs at least one pair of time and factor.')
      is_ok = .false.
    end if
    if (is_ok) then
      if (any(numbers(3::2) <= numbers(1:2 * n - 2:2))) call report_error(reader, row%line, &
        'The times of an amplitude must ascend.')
    else
      numbers = [0.0_DP, 0.0_DP]
      n = 1
    end if
    amplitude%time = numbers(1:2 * n:2)
    amplitude%factor = numbers(2:2 * n:2)
  end subroutine read_amplitude_table


  !> SURFACE: of element faces, or of nodes. Names are used once; under the calculix dialect a surface of faces and one of
  !! nodes may share a name: a slave is the one of nodes then, all else the one of faces.
  subroutine read_surfaces(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(surface_type) :: surface
    type(node_elements_type) :: index
    integer, allocatable :: stamp(:)
    integer :: c, position, earlier
    logical :: is_new
    allocate (model%surfaces(0))
    allocate (stamp(max(6 * model%mesh%n_elements, model%mesh%n_nodes)), source=0)
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'SURFACE')) cycle
      call open_card(reader, c, parameters, row)
      surface%name = parameter_text(parameters, 'NAME')
      if (surface%name == '') cycle
      call check_name(reader, c, surface%name)
      call reader%surfaces%add(surface%name, position, is_new)
      surface%is_node_based = parameter_word(parameters, 'TYPE', 'ELEMENT') == 'NODE'
      if (.not. is_new .and. reader%dialect == DIALECT_CALCULIX) then
        if (surface%is_node_based .neqv. model%surfaces(position)%is_node_based) call reader%surfaces%add(surface%name // &
          NODE_SURFACE_SUFFIX, earlier, is_new)
      end if
      if (.not. is_new) then
        call report_error(reader, reader%cards%cards(c)%line, 'The surface ''' // surface%name // ''' is defined twice.')
        cycle
      end if
      if (allocated(surface%profile)) deallocate (surface%profile)
      if (is_analytic_type(parameter_word(parameters, 'TYPE', 'ELEMENT'))) then
        call read_profile(reader, c, surface)
      else if (surface%is_node_based) then
        call read_surface_nodes(reader, model%mesh, c, stamp, surface)
      else
        call read_surface_faces(reader, model, c, stamp, index, surface)
      end if
      model%surfaces = [model%surfaces, surface]
      if (position < size(model%surfaces)) call rename_node_surface(model%surfaces, position)
    end do
  end subroutine read_surfaces


  !> The slave surface of a name, the node-based one first; 0: unknown name.
  pure integer function find_slave_surface(reader, name) result(surface)
    type(reader_type), intent(in) :: reader
    character(*), intent(in) :: name
    surface = reader%surfaces%find(name // NODE_SURFACE_SUFFIX)
    if (surface == 0) surface = reader%surfaces%find(name)
  end function find_slave_surface


  !> Of two surfaces of one name, the node-based one moves to the end and gets a suffix.
  subroutine rename_node_surface(surfaces, position)
    type(surface_type), intent(inout) :: surfaces(:)
    integer, intent(in) :: position                !< of the first one
    type(surface_type) :: first
    associate (last => surfaces(size(surfaces)))
      if (.not. last%is_node_based) then
        first = surfaces(position)
        surfaces(position) = last
        last = first
      end if
      last%name = last%name // ' (nodes)'
    end associate
  end subroutine rename_node_surface


  !> A surface of nodes; a second field (area) is ignored.
  subroutine read_surface_nodes(reader, mesh, c, stamp, surface)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: c
    integer, intent(inout) :: stamp(:)           !< last card that took a node; free to use
    type(surface_type), intent(inout) :: surface
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(integer_list_type) :: list
    integer, allocatable :: nodes(:)
    integer :: i
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    is_ok = .true.
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 2)
      call nodes_of_field(reader, mesh, row, 1, nodes, is_ok)
      do i = 1, size(nodes)
        if (stamp(nodes(i)) == c) cycle
        stamp(nodes(i)) = c
        call list%add(nodes(i))
      end do
    end do
    if (is_ok .and. list%n == 0) call report_error(reader, reader%cards%cards(c)%line, 'The surface ''' // surface%name // &
      ''' has no nodes.')
    surface%nodes = list%trimmed()
    call sort_integers(surface%nodes)
    surface%element = [integer ::]
    surface%face = [integer ::]
  end subroutine read_surface_nodes


  !> A surface of element faces; its nodes follow from them.
  subroutine read_surface_faces(reader, model, c, stamp, index, surface)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c
    integer, intent(inout) :: stamp(:)           !< last card that took a face; free to use
    type(node_elements_type), intent(inout) :: index     !< of faces, created on first use
    type(surface_type), intent(inout) :: surface
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(integer_list_type) :: elements, faces
    integer, allocatable :: found(:)
    character(:), allocatable :: label
    integer :: i, face, n_without, n_hidden
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    is_ok = .true.
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 2)
      if (field_text(reader%cards, row, 2) == '') then
        call add_free_faces(reader, model, row, index, c, stamp, elements, faces, is_ok)
        cycle
      end if
      call elements_of_field(reader, model%mesh, row, 1, found, is_ok)
      label = name_key(field_text(reader%cards, row, 2))
      if (face_number(label, 'S') == 0 .and. .not. is_one_of(label, 'SPOS|SNEG|E1|E2|E3|E4')) then
        call report_error(reader, row%line, 'The second field must be a face S1 to S6, of shells SPOS, SNEG or an edge E1 to ' // &
          'E4, or nothing for all free faces; it is ''' // field_text(reader%cards, row, 2) // '''.')
        is_ok = .false.
        cycle
      end if
      n_without = 0
      do i = 1, size(found)
        face = numbered_face(model%mesh, found(i), face_number(label, 'S'))
        if (is_shell(model, found(i))) face = structural_face(model, found(i), label)
        if (face == OTHER_LAYER) cycle
        if (face > n_faces(model%mesh, found(i))) face = 0
        if (face == 0) n_without = n_without + 1
        if (face == 0) cycle
        if (stamp(6 * found(i) - 6 + face) == -c) cycle
        stamp(6 * found(i) - 6 + face) = -c
        call elements%add(found(i))
        call faces%add(face)
      end do
      if (n_without > 0) is_ok = .false.
      if (n_without > 0) call report_error(reader, row%line, plural(n_without, 'element') // ' here ' // &
        verb(n_without, 'has', 'have') // ' no face ' // label // '; tetrahedra have 4 faces (S1 to S4), wedges 5, ' // &
        'hexahedra 6; shells have SPOS, SNEG and edges E1 to E4, cohesive elements S1 and S2, in the plane S1 and S3.')
    end do
    if (is_ok .and. elements%n == 0) call report_empty_surface(reader, c, surface%name)
    surface%element = elements%trimmed()
    surface%face = faces%trimmed()
    call fill_surface_nodes(model%mesh, surface)
    if (.not. is_ok) return
    n_hidden = count_shared_faces(index, model%mesh, surface%element, surface%face)
    if (n_hidden > 0 .and. n_hidden < size(surface%face)) call report_note(reader, reader%cards%cards(c)%line, 'The surface ''' // &
      surface%name // ''' holds faces inside the body, ' // to_text(n_hidden) // ' of ' // to_text(size(surface%face)) // &
      ': another element shares them. The name of the set alone, without S1 to S6, takes its free faces.')
  end subroutine read_surface_faces


  !> A surface without faces: an error if another card names it, else a note.
  subroutine report_empty_surface(reader, c, name)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of its card
    character(*), intent(in) :: name
    if (is_named(reader, c, name)) then
      call report_error(reader, reader%cards%cards(c)%line, 'The surface ''' // name // ''' has no faces.')
    else
      call report_note(reader, reader%cards%cards(c)%line, 'The surface ''' // name // ''' has no faces, and no card names it.')
    end if
  end subroutine report_empty_surface


  !> Whether a parameter or a field of another card is a name. Cards of nodes, elements and their sets are passed over.
  logical function is_named(reader, c, name)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of a card that may have the name
    character(*), intent(in) :: name
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: k, i
    is_named = .true.
    do k = 1, reader%cards%n_cards
      if (k == c .or. reader%cards%cards(k)%entry == 0) cycle
      if (is_one_of(reader%cards%cards(k)%key, 'NODE|ELEMENT|NSET|ELSET')) cycle
      call open_card(reader, k, parameters, row)
      do i = 1, size(parameters)
        if (name_key(parameters(i)%text) == name_key(name)) return
      end do
      do while (next_row(reader%cards, row))
        do i = 1, row%n
          if (name_key(field_text(reader%cards, row, i)) == name_key(name)) return
        end do
      end do
    end do
    is_named = .false.
  end function is_named


  !> A row without a face: the free faces of solids; for faces written by a mesh generator the element faces under them.
  subroutine add_free_faces(reader, model, row, index, c, stamp, elements, faces, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(node_elements_type), intent(inout) :: index
    integer, intent(in) :: c                     !< index of the card
    integer, intent(inout) :: stamp(:)
    type(integer_list_type), intent(inout) :: elements, faces
    logical, intent(inout) :: is_ok
    integer, allocatable :: left(:), members(:), element(:), face(:)
    integer :: i, n_without
    n_without = 0
    call omitted_of_field(reader, row, left)
    if (size(left) > 0) then
      call find_omitted_faces(reader, index, model%mesh, left, element, face, n_without)
    else
      call elements_of_field(reader, model%mesh, row, 1, members, is_ok)
      call find_free_faces(index, model%mesh, members, element, face)
      if (is_ok .and. size(element) == 0) call report_error(reader, row%line, 'The elements ''' // &
        field_text(reader%cards, row, 1) // ''' have no free face; name the faces S1 to S6.')
      if (size(element) == 0) is_ok = .false.
    end if
    if (n_without > 0) call report_error(reader, row%line, plural(n_without, 'element') // ' here ' // &
      verb(n_without, 'lies', 'lie') // ' on no face of a solid.')
    if (n_without > 0) is_ok = .false.
    do i = 1, size(element)
      if (stamp(6 * element(i) - 6 + face(i)) == -c) cycle
      if (is_shell_edge(model, element(i), face(i))) cycle   ! both sides, not the edges
      stamp(6 * element(i) - 6 + face(i)) = -c
      call elements%add(element(i))
      call faces%add(face(i))
    end do
  end subroutine add_free_faces


  !> The dropped elements that a field names; empty if it names solids, or nothing.
  subroutine omitted_of_field(reader, row, left)
    type(reader_type), intent(in) :: reader
    type(data_row_type), intent(in) :: row
    integer, allocatable, intent(out) :: left(:)
    integer :: label, status, found
    allocate (left(0))
    call field_integer(reader%cards, row, 1, label, status)
    if (status == NUMBER_OK) then
      found = reader%draft_element_labels%find(label)
      if (found == 0) return
      if (reader%omitted_of_draft(found) > 0) left = [reader%omitted_of_draft(found)]
    else
      found = reader%element_sets%find(field_text(reader%cards, row, 1))
      if (found > 0) left = reader%omitted_of_set(found)%trimmed()
    end if
  end subroutine omitted_of_field


  !> The number of faces of an element.
  pure function n_faces(mesh, e) result(n)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    type(element_kind_type) :: entry
    integer :: n
    entry = element_kind(mesh%kind(e))
    n = entry%n_faces
  end function n_faces


  !> The nodes of the faces of a surface, each once, ascending.
  subroutine fill_surface_nodes(mesh, surface)
    type(mesh_type), intent(in) :: mesh
    type(surface_type), intent(inout) :: surface
    type(integer_list_type) :: list
    type(element_kind_type) :: entry
    type(facet_kind_type) :: facet
    integer :: i, k
    do i = 1, size(surface%element)
      entry = element_kind(mesh%kind(surface%element(i)))
      facet = facet_kind(entry%face_kind(surface%face(i)))
      do k = 1, facet%n_nodes
        call list%add(mesh%nodes(mesh%first(surface%element(i)) + entry%face_nodes(k, surface%face(i)) - 1))
      end do
    end do
    surface%nodes = list%trimmed()
    call sort_integers(surface%nodes)
    if (size(surface%nodes) > 1) surface%nodes = pack(surface%nodes, &
      [.true., surface%nodes(2:) /= surface%nodes(:size(surface%nodes) - 1)])
  end subroutine fill_surface_nodes


  !> The number in a face label such as S3 or P3; 0: invalid label.
  pure function face_number(label, letter) result(face)
    character(*), intent(in) :: label
    character(1), intent(in) :: letter           !< 'S' or 'P'
    integer :: face
    character(:), allocatable :: key
    face = 0
    key = name_key(label)
    if (len(key) /= 2) return
    if (key(1:1) == letter .and. scan(key(2:2), '123456') == 1) face = iachar(key(2:2)) - iachar('0')
  end function face_number


  !> EQUATION: a card may contain several; a node set in it gives one equation for each of its nodes. Rotation nodes must exist.
  subroutine read_equations(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(equation_list_type) :: list
    type(equation_type), allocatable :: equations(:)
    type(equation_type) :: equation
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(terms_type) :: terms
    integer :: c, line, n_terms, i
    logical :: is_ok, has_rotations
    has_rotations = .false.
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'EQUATION')) cycle
      call open_card(reader, c, parameters, row)
      if (has_parameter(parameters, 'REMOVE')) cycle       ! read with its step
      if (reader%step_of_card(c) > 0) call report_error(reader, reader%cards%cards(c)%line, &
        'Equations hold from the start of the ' // &
        'job: *EQUATION must be before the first step; in a step it needs REMOVE.')
      do while (next_row(reader%cards, row))
        line = row%line
        is_ok = .true.
        call check_n_fields(reader, row, 1)
        call read_integer(reader, row, 1, 'number of terms', n_terms, is_ok)
        if (is_ok .and. n_terms < 1) call report_error(reader, line, 'An equation needs at least one term.')
        if (.not. is_ok .or. n_terms < 1) exit
        call read_terms(reader, model%mesh, row, n_terms, terms, is_ok)
        if (.not. is_ok) exit
        has_rotations = has_rotations .or. any(terms%dof > 3)
        do i = 1, size(terms%node, 1)
          call merge_terms(reader, terms, i, line, equation)
          call place_rotations(reader, model, line, equation, is_ok)
          if (.not. is_ok) exit
          if (allocated(model%frame_of)) call transform_terms(model, equation)
          call list%add(equation)
        end do
      end do
    end do
    if (has_rotations .and. model%dialect == DIALECT_CALCULIX) call report_note(reader, 0, 'Equations of rotations hold here; ' // &
      'CalculiX 2.20 passes over them.')
    call list%move_to(equations)
    model%equations = [equations, model%equations]   ! equations of other cards, already read, come last
  end subroutine read_equations


  !> The terms of one equation, over as many rows as they need.
  subroutine read_terms(reader, mesh, row, n_terms, terms, is_ok)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    type(data_row_type), intent(inout) :: row
    integer, intent(in) :: n_terms
    type(terms_type), intent(out) :: terms
    logical, intent(inout) :: is_ok              !< .false.: the rest of the card is not read
    integer, allocatable :: nodes(:)
    integer :: i
    allocate (terms%dof(n_terms), terms%coefficient(n_terms))
    allocate (terms%node(1, n_terms), source=0)
    do while (terms%n < n_terms .and. is_ok)
      if (.not. next_row(reader%cards, row)) then
        call report_error(reader, row%line, 'The equation has ' // to_text(n_terms) // ' terms, but only ' // &
          plural(terms%n, 'term') // ' follow.')
        is_ok = .false.
        return
      end if
      if (row%n > 3 * (n_terms - terms%n) .or. modulo(row%n, 3) /= 0) then
        call report_error(reader, row%line, 'This line must hold terms of three values, node, degree of freedom, ' // &
          'coefficient; at most ' // plural(n_terms - terms%n, 'term') // &
          verb(n_terms - terms%n, ' is', ' are') // ' missing.')
        is_ok = .false.
        return
      end if
      do i = 1, row%n, 3
        terms%n = terms%n + 1
        call nodes_of_field(reader, mesh, row, i, nodes, is_ok)
        call read_integer(reader, row, i + 1, 'degree of freedom', terms%dof(terms%n), is_ok)
        call read_real(reader, row, i + 2, 'coefficient', terms%coefficient(terms%n), is_ok)
        if (is_ok .and. (terms%dof(terms%n) < 1 .or. terms%dof(terms%n) > 6)) then
          call report_error(reader, row%line, 'The degree of freedom must be 1 to 3, or 4 to 6 at nodes that have rotations.')
          is_ok = .false.
        end if
        if (is_ok) call store_term_nodes(reader, row%line, nodes, terms, is_ok)
      end do
    end do
  end subroutine read_terms


  !> Stores the nodes of the last term: one for all copies of the equation, or one for each.
  subroutine store_term_nodes(reader, line, nodes, terms, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    integer, intent(in) :: nodes(:)
    type(terms_type), intent(inout) :: terms
    logical, intent(inout) :: is_ok
    integer, allocatable :: copies(:, :)
    integer :: n
    n = size(terms%node, 1)
    if (n == 1 .and. size(nodes) > 1) then
      copies = spread(terms%node(1, :), 1, size(nodes))
      call move_alloc(copies, terms%node)
      n = size(nodes)
    end if
    if (size(nodes) == n) then
      terms%node(:, terms%n) = nodes
    else if (size(nodes) == 1) then
      terms%node(:, terms%n) = nodes(1)
    else
      call report_error(reader, line, 'The node sets of an equation must have the same number of nodes.')
      is_ok = .false.
    end if
  end subroutine store_term_nodes


  !> Builds one equation: terms of the same degree of freedom are summed.
  subroutine merge_terms(reader, terms, copy, line, equation)
    type(reader_type), intent(inout) :: reader
    type(terms_type), intent(in) :: terms
    integer, intent(in) :: copy                  !< which nodes of the sets
    integer, intent(in) :: line
    type(equation_type), intent(out) :: equation
    integer :: i, j, n
    equation%node = terms%node(copy, :)
    equation%dof = terms%dof
    equation%coefficient = terms%coefficient
    equation%line = reader%cards%line_number(line)
    equation%deck_dof = terms%dof(1)
    n = 0
    do i = 1, terms%n
      do j = 1, n
        if (equation%node(j) == terms%node(copy, i) .and. equation%dof(j) == terms%dof(i)) exit
      end do
      if (j > n) then
        n = n + 1
        equation%node(n) = terms%node(copy, i)
        equation%dof(n) = terms%dof(i)
        equation%coefficient(n) = terms%coefficient(i)
      else
        equation%coefficient(j) = equation%coefficient(j) + terms%coefficient(i)
      end if
    end do
    equation%node = equation%node(:n)
    equation%dof = equation%dof(:n)
    equation%coefficient = equation%coefficient(:n)
    if (.not. abs(equation%coefficient(1)) > 0) call report_error(reader, line, &
      'The coefficient of the first term is zero; its degree of freedom is the one eliminated.')
  end subroutine merge_terms


  !> The rotations 4 to 6 of a node are the displacements of its rotation node.
  subroutine place_rotations(reader, model, line, equation, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: line
    type(equation_type), intent(inout) :: equation
    logical, intent(inout) :: is_ok              !< .false.: a node has none; its error is reported
    integer :: i, place
    do i = 1, size(equation%node)
      if (equation%dof(i) <= 3) cycle
      place = model%rotation_of(equation%node(i))
      if (place == 0) then
        call report_error(reader, line, 'The node ' // to_text(model%mesh%node_label(equation%node(i))) // ' has no rotation, ' // &
          'which the degree of freedom ' // to_text(equation%dof(i)) // ' is: nodes of shells and beams and reference nodes ' // &
          'of rigid bodies and couplings have rotations, those of solids, membranes and trusses have none.')
        is_ok = .false.
        return
      end if
      equation%node(i) = place
      equation%dof(i) = equation%dof(i) - 3
    end do
  end subroutine place_rotations


  !> Transforms terms of nodes with local directions to the global directions.
  subroutine transform_terms(model, equation)
    type(model_type), intent(in) :: model
    type(equation_type), intent(inout) :: equation
    type(equation_type) :: turned
    real(DP) :: direction(3)
    integer :: i, k
    turned%node = [integer ::]
    turned%dof = [integer ::]
    turned%coefficient = [real(DP) ::]
    do i = 1, size(equation%node)
      direction = dof_direction(model, equation%node(i), equation%dof(i))
      do k = 1, 3
        if (.not. abs(direction(k)) > 0) cycle
        turned%node = [turned%node, equation%node(i)]
        turned%dof = [turned%dof, k]
        turned%coefficient = [turned%coefficient, equation%coefficient(i) * direction(k)]
      end do
      if (i == 1) turned%n_eliminable = size(turned%node)
    end do
    turned%line = equation%line
    turned%deck_dof = equation%deck_dof
    equation = turned
  end subroutine transform_terms

end module amontons_deck_surfaces
