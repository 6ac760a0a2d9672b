!> Report of how each card is interpreted, with defaults.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The report quotes the sentences of the card table, the messages of the reader and the numbers of the model. So it cannot
!! differ from what the program does.
module amontons_explain
  use amontons_card_schema, only: card_entry_type, match_parameters, ENTRY_SUPPORTED, ENTRY_IGNORED, &
    ENTRY_REJECTED
  use amontons_cards, only: parameter_type, read_parameters, line_text, data_row_type, start_rows, next_row
  use amontons_deck_reader, only: reader_type
  use amontons_loads, only: DISTRIBUTED_PRESSURE, DISTRIBUTED_TRACTION
  use amontons_materials, only: material_type, ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC, ELASTIC_HYPER, &
    ELASTIC_FOAM, ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY, ELASTIC_CIARLET, ELASTIC_FIBRES, LAW_SAINT_VENANT, &
    RATE_NONE, law_name
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_surfaces, only: interaction_type, BEHAVIOR_HARD, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, &
    ROUGH_FRICTION, NO_SHEAR_LIMIT
  use amontons_text, only: name_key, upper_case, to_text, plural, is_one_of, NEWLINE
  use amontons_element_kinds, only: element_kind_type, element_kind, N_KINDS
  implicit none
  private
  public :: explain_cards

  integer, parameter :: MAX_ROWS_SHOWN = 3              !< data lines of a card that are shown
  character(*), parameter :: COUNTED_CARDS = 'NODE|ELEMENT|NSET|ELSET|HEADING'   !< their data lines are only counted
  character(*), parameter :: INDENT = '    '

contains

  !> The complete explanation. The deck must be read, with or without errors.
  subroutine explain_cards(reader, model, text)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(in) :: model
    character(:), allocatable, intent(out) :: text
    integer :: c, next
    text = 'Deck ' // reader%cards%files(1)%path // ', read in the ' // &
      trim(merge('calculix', 'abaqus  ', reader%dialect == DIALECT_CALCULIX)) // ' dialect.' // NEWLINE // NEWLINE
    call explain_remarks(reader, 0, 0, text)
    if (.not. allocated(reader%step_of_card)) then   ! parts have errors: reading stopped there
      call explain_remarks(reader, 1, huge(1), text)
      return
    end if
    do c = 1, reader%cards%n_cards
      next = reader%cards%n_lines
      if (c < reader%cards%n_cards) next = reader%cards%cards(c + 1)%line - 1
      call explain_card(reader, c, text)
      call explain_remarks(reader, reader%cards%cards(c)%line, next, text)
    end do
    text = text // NEWLINE // 'Numbers taken' // NEWLINE
    call explain_elements(model, text)
    call explain_materials(model, text)
    call explain_interactions(model, text)
    call explain_steps(model, text)
    if (reader%messages%n_errors > 0) text = text // NEWLINE // 'The deck has ' // plural(reader%messages%n_errors, 'error') // &
      ', so it would not run; what could not be read is missing here.' // NEWLINE
  end subroutine explain_cards


  !> One card: status, parameters, defaults of those not given, data lines, and the dialects.
  subroutine explain_card(reader, c, text)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                       !< index of the card
    character(:), allocatable, intent(inout) :: text
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    associate (card => reader%cards%cards(c))
      text = text // reader%cards%files(reader%cards%line_file(card%line))%path // ':' // &
        to_text(reader%cards%line_number(card%line)) // ': *'
      if (card%entry == 0) then
        text = text // card%key // ': not known' // NEWLINE
        return
      end if
      associate (entry => reader%table%entries(card%entry))
        text = text // entry%keyword // ': ' // status_word(entry%status)
        if (entry%status /= ENTRY_SUPPORTED) then
          text = text // '. ' // entry%description // NEWLINE
          return
        end if
        text = text // NEWLINE
        call read_parameters(reader%cards, card, parameters)
        call match_parameters(entry, parameters, card%line, .true.)
        do i = 1, size(parameters)
          text = text // INDENT // parameter_line(entry, parameters(i), is_refused(reader, card%line, parameters(i))) // NEWLINE
        end do
        text = text // default_line(entry, parameters)
        call explain_data(reader, c, is_one_of(entry%key, COUNTED_CARDS), text)
        if (entry%dialects /= '') text = text // INDENT // 'dialects differ: ' // entry%dialects // NEWLINE
      end associate
    end associate
  end subroutine explain_card


  !> Whether an error at the line of a card quotes the value of a parameter: a kind of element that is not supported, say.
  logical function is_refused(reader, line, parameter)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: line
    type(parameter_type), intent(in) :: parameter
    character(*), parameter :: PUNCTUATION = ' .,;:''='
    character(:), allocatable :: remark, value
    integer :: i, at, first
    logical :: is_warning
    is_refused = .false.
    value = parameter%text
    if (len(value) < 2) return
    value = upper_case(value)
    do i = 1, reader%messages%n
      call reader%messages%get(i, at, is_warning, remark)
      if (at /= line .or. is_warning) cycle
      remark = ' ' // remark // ' '
      remark = upper_case(remark)
      first = index(remark, value)
      if (first == 0) cycle
      at = first + len(value)
      is_refused = is_refused .or. (is_one_sign(remark(first - 1:first - 1)) .and. is_one_sign(remark(at:at)))
    end do

  contains

    !> Whether a letter ends a word.
    pure logical function is_one_sign(letter)
      character(1), intent(in) :: letter
      is_one_sign = scan(letter, PUNCTUATION) > 0
    end function is_one_sign

  end function is_refused


  !> The word for a status.
  pure function status_word(status) result(word)
    integer, intent(in) :: status                  !< STATUS_...
    character(:), allocatable :: word
    select case (status)
    case (ENTRY_IGNORED)
      word = 'ignored'
    case (ENTRY_REJECTED)
      word = 'refused'
    case default
      word = 'used'
    end select
  end function status_word


  !> 'INC=100: used. Most increments of the step.'
  function parameter_line(entry, parameter, has_error) result(line)
    type(card_entry_type), intent(in) :: entry
    type(parameter_type), intent(in) :: parameter
    logical, intent(in) :: has_error               !< an error of the card names its value
    character(:), allocatable :: line
    integer :: i
    line = parameter%key
    if (parameter%has_value) line = line // '=' // parameter%text
    do i = 1, entry%n_options
      associate (option => entry%options(i))
        if (name_key(option%name) /= parameter%key) cycle
        line = option%name
        if (parameter%has_value) line = line // '=' // parameter%text
        if (is_one_of(parameter%text, option%refused) .and. option%refused /= '' .and. parameter%text /= '') then
          line = line // ': refused. ' // option%message
        else if (has_error) then
          line = line // ': refused, see the error below.'
        else
          line = line // ': ' // status_word(option%status) // '. ' // option%description
        end if
        return
      end associate
    end do
    line = line // ': not known'
  end function parameter_line


  !> 'by default: AMPLITUDE=RAMP, INC=100'; empty without defaults.
  function default_line(entry, parameters) result(line)
    type(card_entry_type), intent(in) :: entry
    type(parameter_type), intent(in) :: parameters(:)
    character(:), allocatable :: line, list
    integer :: i, k
    list = ''
    do i = 1, entry%n_options
      associate (option => entry%options(i))
        if (option%status /= ENTRY_SUPPORTED .or. option%default == '' .or. option%default == 'required') cycle
        if (any([(parameters(k)%key == name_key(option%name), k=1, size(parameters))])) cycle
        if (list /= '') list = list // ', '
        list = list // option%name // '=' // option%default
      end associate
    end do
    line = ''
    if (list /= '') line = INDENT // 'by default: ' // list // NEWLINE
  end function default_line


  !> The data lines: their number, and the first ones as written.
  subroutine explain_data(reader, c, is_bulk, text)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c
    logical, intent(in) :: is_bulk                 !< only their number
    character(:), allocatable, intent(inout) :: text
    type(data_row_type) :: row
    integer :: n
    n = 0
    call start_rows(reader%cards%cards(c), row)
    do while (next_row(reader%cards, row))
      n = n + 1
      if (n <= MAX_ROWS_SHOWN .and. .not. is_bulk) text = text // INDENT // 'data: ' // &
        trim(adjustl(line_text(reader%cards, row%line))) // NEWLINE
    end do
    if (is_bulk .and. n > 0) text = text // INDENT // plural(n, 'data line') // NEWLINE
    if (n > MAX_ROWS_SHOWN .and. .not. is_bulk) text = text // INDENT // 'and ' // plural(n - MAX_ROWS_SHOWN, &
      'data line') // ' more' // &
      NEWLINE
  end subroutine explain_data


  !> The messages of the reader for some lines.
  subroutine explain_remarks(reader, first, last, text)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: first, last             !< lines of the deck; 0, 0: no lines
    character(:), allocatable, intent(inout) :: text
    character(:), allocatable :: remark
    integer :: i, line
    logical :: is_warning
    do i = 1, reader%messages%n
      call reader%messages%get(i, line, is_warning, remark)
      if (line < first .or. line > last) cycle
      text = text // INDENT // trim(merge('note: ', 'error:', is_warning)) // ' ' // &
        remark // NEWLINE
    end do
  end subroutine explain_remarks


  !> The number of elements of each kind, and their integration.
  subroutine explain_elements(model, text)
    type(model_type), intent(in) :: model
    character(:), allocatable, intent(inout) :: text
    type(element_kind_type) :: entry
    integer :: kind, n
    if (.not. allocated(model%mesh%kind)) return
    text = text // INDENT // plural(model%mesh%n_nodes, 'node') // NEWLINE
    do kind = 1, N_KINDS
      n = count(model%mesh%kind == kind)
      if (n == 0) cycle
      entry = element_kind(kind)
      text = text // INDENT // plural(n, 'element') // ' ' // trim(entry%name)
      if (entry%n_points > 0) text = text // ', ' // plural(entry%n_points, 'integration point')
      if (entry%is_mean_dilatation) text = text // ', mean dilatation'
      text = text // NEWLINE
    end do
  end subroutine explain_elements


  !> The constants of the materials at their first temperature.
  subroutine explain_materials(model, text)
    type(model_type), intent(in) :: model
    character(:), allocatable, intent(inout) :: text
    integer :: m
    if (.not. allocated(model%materials)) return
    do m = 1, size(model%materials)
      associate (material => model%materials(m))
        if (material%name == '') cycle
        text = text // INDENT // 'material ' // material%name // ': ' // elasticity_text(material)
        if (material%has_density) text = text // '; density ' // to_text(material%density)
        if (allocated(material%expansion%value)) text = text // '; expansion ' // to_text(material%expansion%value(1, 1)) // &
          ' from ' // to_text(material%expansion_reference)
        if (allocated(material%isotropic_hardening)) text = text // '; first yield stress ' &
          // to_text(material%isotropic_hardening(1)%stress(1))
        if (material%rate_law /= RATE_NONE) text = text // '; it depends on the rate of plastic strain'
        if (allocated(material%kinematic_hardening)) text = text // '; kinematic hardening from ' // &
          to_text(material%kinematic_hardening(1)%stress(1))
        if (allocated(material%creep%value)) text = text // '; creep A ' // to_text(material%creep%value(1, 1)) // ', n ' // &
          to_text(material%creep%value(2, 1)) // ', m ' // to_text(material%creep%value(3, 1))
        text = text // NEWLINE
      end associate
    end do
  end subroutine explain_materials


  !> The elastic law and its constants.
  function elasticity_text(material) result(text)
    type(material_type), intent(in) :: material
    character(:), allocatable :: text
    integer :: i
    select case (material%elastic_kind)
    case (ELASTIC_ISOTROPIC)
      text = 'E ' // to_text(material%youngs_modulus) // ', nu ' // to_text(material%poissons_ratio)
      if (material%law == LAW_SAINT_VENANT) then
        text = text // '; under NLGEOM second Piola-Kirchhoff stress by Green''s strain'
      else
        text = text // '; under NLGEOM Kirchhoff stress by logarithmic strain'
      end if
      if (.not. material%has_elastic) text = 'no elasticity'
      return
    case (ELASTIC_ORTHOTROPIC)
      text = 'orthotropic, D'
    case (ELASTIC_ANISOTROPIC)
      text = 'anisotropic, D'
    case (ELASTIC_HYPER)
      text = 'rubber of order ' // to_text(material%hyper_order) // ', constants'
    case (ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY)
      text = trim(law_name(material)) // ', E and largest stress of the other side'
    case (ELASTIC_CIARLET)
      text = 'Ciarlet, E and nu'
    case (ELASTIC_FIBRES)
      text = 'rubber with fibres, C1, D1, and two components of the direction, k1, k2 of each fibre'
    case (ELASTIC_FOAM)
      text = 'foam of order ' // to_text(material%hyper_order) // ', constants'
    end select
    if (.not. allocated(material%elastic%value)) return
    do i = 1, size(material%elastic%value, 1)
      text = text // ' ' // to_text(material%elastic%value(i, 1))
    end do
    if (size(material%elastic%value, 2) > 1) text = text // ' at the first of ' // &
      plural(size(material%elastic%value, 2), 'temperature')
  end function elasticity_text


  !> The laws of contact.
  subroutine explain_interactions(model, text)
    type(model_type), intent(in) :: model
    character(:), allocatable, intent(inout) :: text
    integer :: i
    if (.not. allocated(model%interactions)) return
    do i = 1, size(model%interactions)
      associate (law => model%interactions(i))
        text = text // INDENT // 'interaction ' // law%name // ': ' // behavior_text(law)
        if (law%friction >= ROUGH_FRICTION) then
          text = text // '; rough'
        else if (law%friction > 0) then
          text = text // '; friction ' // to_text(law%friction)
        else
          text = text // '; frictionless'
        end if
        if (law%behavior /= BEHAVIOR_HARD .and. law%friction > 0) text = text // ', stick slope ' // to_text(law%stick_slope)
        if (law%shear_limit < NO_SHEAR_LIMIT) text = text // ', at most ' // to_text(law%shear_limit)
        text = text // NEWLINE
      end associate
    end do
  end subroutine explain_interactions


  !> The law of pressure and its numbers.
  function behavior_text(law) result(text)
    type(interaction_type), intent(in) :: law
    character(:), allocatable :: text
    select case (law%behavior)
    case (BEHAVIOR_HARD)
      text = 'HARD, exact'
    case (BEHAVIOR_LINEAR)
      text = 'LINEAR, stiffness ' // to_text(law%stiffness) // ', tension ' // to_text(law%tension_limit) // ', reach ' // &
        to_text(law%cutoff_clearance)
    case (BEHAVIOR_EXPONENTIAL)
      text = 'EXPONENTIAL, reach ' // to_text(law%cutoff_clearance) // ', pressure ' // to_text(law%pressure)
    case (BEHAVIOR_TABULAR)
      text = 'TABULAR, ' // plural(size(law%table_pressure), 'row')
    case default
      text = 'TIED, stiffness ' // to_text(law%stiffness)
    end select
  end function behavior_text


  !> Times, tolerances and loads of the steps.
  subroutine explain_steps(model, text)
    type(model_type), intent(in) :: model
    character(:), allocatable, intent(inout) :: text
    integer :: i
    if (.not. allocated(model%steps)) return
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        if (.not. allocated(step%prescribed)) cycle      ! the step before had errors
        text = text // INDENT // 'step ' // to_text(i) // ': ' // &
          trim(merge('NLGEOM       ', 'small strains', step%is_nlgeom)) // ', length ' // to_text(step%period) // &
          ', first increment ' // to_text(step%dt_initial) // ', least ' // to_text(step%dt_min) // &
          ', largest ' // to_text(step%dt_max) // ', at most ' // plural(step%max_increments, 'increment')
        if (step%is_direct) text = text // ', all as long as the first'
        if (step%creep_tolerance > 0) text = text // ', CETOL ' // to_text(step%creep_tolerance)
        text = text // NEWLINE // INDENT // INDENT // 'Rn ' // to_text(step%controls%r_n) // ', Cn ' // &
          to_text(step%controls%c_n) // ', I0 ' // to_text(step%controls%i_0) // ', IR ' // to_text(step%controls%i_r) // &
          ', IC ' // to_text(step%controls%i_c) // ', IA ' // to_text(step%controls%i_a) // NEWLINE
        text = text // INDENT // INDENT // plural(size(step%prescribed), 'prescribed displacement') // ', ' // &
          plural(size(step%concentrated), 'force') // ', ' // &
          plural(count(step%distributed%kind == DISTRIBUTED_PRESSURE), 'face') // ' under pressure, ' // &
          plural(count(step%distributed%kind == DISTRIBUTED_TRACTION), 'face') // ' under traction, ' // &
          plural(count(.not. (step%distributed%kind == DISTRIBUTED_PRESSURE .or. step%distributed%kind == &
          DISTRIBUTED_TRACTION)), 'element') // ' with loads on their volume' // NEWLINE
      end associate
    end do
  end subroutine explain_steps

end module amontons_explain
