!> Surface interactions, contact pairs, clearances and their changes in steps.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_contact
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, check_n_fields, check_no_data, &
    is_card, check_name, VALUES_PER_LINE
  use amontons_deck_surfaces, only: find_slave_surface
  use amontons_mesh, only: mesh_type
  use amontons_element_kinds, only: has_midsides
  use amontons_model, only: model_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_steps, only: step_type
  use amontons_surfaces, only: surface_type, interaction_type, contact_pair_type, is_compliant, is_self_contact, &
    BEHAVIOR_HARD, BEHAVIOR_LINEAR, BEHAVIOR_EXPONENTIAL, BEHAVIOR_TABULAR, BEHAVIOR_TIED, BEHAVIOR_USER, ROUGH_FRICTION, &
    NO_SHEAR_LIMIT
  use amontons_text, only: to_text, parse_real, NUMBER_OK
  implicit none
  private
  public :: read_interactions, read_pairs, read_clearances, read_contact_change

  ! CalculiX's defaults, in terms of Young's modulus E of the first material
  real(DP), parameter :: DEFAULT_STIFFNESS_RATIO = 50.0_DP        !< K/E [1/length]
  real(DP), parameter :: TENSION = 1.0_DP / 70000.0_DP   !< sigma_inf/E [-]
  real(DP), parameter :: MIN_REPORTED_STRAIN = 1.0e-3_DP             !< a strain of this size is reported [-]
  real(DP), parameter :: REACH = 1.0e-3_DP               !< c0 over the root of the area [-]
  real(DP), parameter :: STICK_SLOPE = 0.5_DP            !< lambda/E [1/length]
  ! The ratio of two of them, which has no unit
  real(DP), parameter :: STICK_TO_NORMAL_RATIO = STICK_SLOPE / DEFAULT_STIFFNESS_RATIO   !< lambda/K [-]

contains

  !> SURFACE INTERACTION with SURFACE BEHAVIOR and FRICTION.
  subroutine read_interactions(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(interaction_type) :: interaction
    integer :: c, k
    logical :: is_new
    allocate (model%interactions(0))
    k = 0
    do c = 1, reader%cards%n_cards
      if (reader%step_of_card(c) > 0) cycle
      if (is_card(reader, c, 'SURFACEINTERACTION')) then
        call open_card(reader, c, parameters, row)
        interaction%name = parameter_text(parameters, 'NAME')
        if (interaction%name == '') cycle
        call check_name(reader, c, interaction%name)
        call reader%interactions%add(interaction%name, k, is_new)
        if (is_new) then
          model%interactions = [model%interactions, interaction]
        else
          call report_error(reader, reader%cards%cards(c)%line, 'The surface interaction ''' // interaction%name // &
            ''' is defined twice.')
        end if
        if (next_row(reader%cards, row)) call check_n_fields(reader, row, 1)
        if (k > 0 .and. is_new .and. has_parameter(parameters, 'USER')) then
          model%interactions(k)%behavior = BEHAVIOR_USER
          call read_properties(reader, parameters, row, model%interactions(k))
        end if
      else if (k > 0 .and. is_card(reader, c, 'SURFACEBEHAVIOR')) then
        call read_behavior(reader, model, c, model%interactions(k))
      else if (k > 0 .and. is_card(reader, c, 'FRICTION')) then
        call read_friction(reader, c, model%interactions(k))
      end if
    end do
    do k = 1, size(model%interactions)
      call complete_law(reader, model, model%interactions(k))
    end do
  end subroutine read_interactions


  !> Young's modulus of the first material, which scales CalculiX's defaults; 0: no such modulus.
  pure real(DP) function first_modulus(model) result(modulus)
    type(model_type), intent(in) :: model
    modulus = 0.0_DP
    if (size(model%materials) > 0) modulus = model%materials(1)%youngs_modulus
  end function first_modulus


  !> The largest growth of pressure with the overclosure of a compliant law, EXPONENTIAL at gap zero [stress/length].
  pure real(DP) function max_pressure_slope(law) result(slope)
    type(interaction_type), intent(in) :: law
    integer :: n
    slope = law%stiffness
    if (law%behavior == BEHAVIOR_EXPONENTIAL) slope = law%pressure * log(100.0_DP) / law%cutoff_clearance
    if (law%behavior /= BEHAVIOR_TABULAR) return
    n = size(law%table_pressure)
    slope = maxval((law%table_pressure(2:n) - law%table_pressure(:n - 1)) / &
      (law%table_overclosure(2:n) - law%table_overclosure(:n - 1)))
  end function max_pressure_slope


  !> A compliant law with friction needs a stick slope. What is tied has that of its law of pressure; under the calculix dialect
  !! with FRICTION that of all others.
  subroutine complete_law(reader, model, law)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(interaction_type), intent(inout) :: law
    if (.not. is_compliant(law) .or. law%stick_slope > 0.0_DP) return
    if (law%behavior == BEHAVIOR_USER) return
    if (law%behavior == BEHAVIOR_TIED .and. (law%friction <= 0.0_DP .or. reader%dialect == DIALECT_ABAQUS)) then
      law%stick_slope = law%stiffness
      return
    end if
    if (law%friction <= 0.0_DP .and. .not. law%is_user_friction) return
    if (reader%dialect == DIALECT_ABAQUS) then
      law%stick_slope = STICK_TO_NORMAL_RATIO * max_pressure_slope(law)
      call report_note(reader, 0, 'The surface interaction ''' // law%name // ''' has no stick slope; a hundredth of the slope ' &
        // &
        'of its law of pressure is taken: ' // to_text(law%stick_slope) // '.')
    else
      law%stick_slope = STICK_SLOPE * first_modulus(model)
      call report_note(reader, 0, 'The surface interaction ''' // law%name // ''' has no stick slope; half of Young''s modulus ' &
        // &
        'of the first material is taken: ' // to_text(law%stick_slope) // '.')
    end if
  end subroutine complete_law


  !> SURFACE BEHAVIOR: the law of pressure.
  subroutine read_behavior(reader, model, c, law)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(interaction_type), intent(inout) :: law
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    logical :: has_row
    call open_card(reader, c, parameters, row)
    if (law%behavior == BEHAVIOR_USER) then
      call report_error(reader, reader%cards%cards(c)%line, 'UINTER gives the pressure too; *SURFACE BEHAVIOR has no ' // &
        'place in this interaction.')
      return
    end if
    select case (parameter_word(parameters, 'PRESSURE-OVERCLOSURE', 'HARD'))
    case ('LINEAR')
      has_row = next_row(reader%cards, row)
      call read_linear(reader, model, row, has_row, law)
    case ('TIED')
      has_row = next_row(reader%cards, row)
      call read_linear(reader, model, row, has_row, law)
      law%behavior = BEHAVIOR_TIED
    case ('EXPONENTIAL')
      has_row = next_row(reader%cards, row)
      call read_exponential(reader, row, has_row, law)
    case ('TABULAR')
      call read_table(reader, row, law)
      has_row = .false.
    case default
      law%behavior = BEHAVIOR_HARD
      has_row = next_row(reader%cards, row)
      if (has_row .and. row%n > 0) call check_no_data(reader, row)
      if (reader%dialect == DIALECT_CALCULIX) call replace_hard_by_linear(reader, model, c, law)
    end select
    if (has_row) has_row = next_row(reader%cards, row)
    if (has_row) call check_no_data(reader, row)
    law%has_no_separation = has_parameter(parameters, 'NO SEPARATION')
    if (law%has_no_separation) call check_no_separation(reader, reader%cards%cards(c)%line, &
      parameter_word(parameters, 'PRESSURE-OVERCLOSURE', 'HARD'))
  end subroutine read_behavior


  !> NO SEPARATION: of hard contact alone, as in Abaqus/Standard; CalculiX does not know it.
  subroutine check_no_separation(reader, line, word)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the card
    character(*), intent(in) :: word             !< PRESSURE-OVERCLOSURE
    if (reader%dialect == DIALECT_CALCULIX) then
      call report_error(reader, line, 'CalculiX does not know NO SEPARATION: put ''** dialect: abaqus'' at the top of the ' // &
        'deck, or take PRESSURE-OVERCLOSURE=TIED, a spring in tension and compression.')
    else if (word /= 'HARD') then
      call report_error(reader, line, 'NO SEPARATION is of hard contact: ' // word // ' has no pressure in tension. Leave out ' // &
        'PRESSURE-OVERCLOSURE, or take TIED, a spring in tension and compression.')
    end if
  end subroutine check_no_separation


  !> HARD as in CalculiX: LINEAR with 50 times Young's modulus of the first material, for its mortar pairs too.
  subroutine replace_hard_by_linear(reader, model, c, law)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(interaction_type), intent(inout) :: law
    if (first_modulus(model) <= 0.0_DP) return
    law%behavior = BEHAVIOR_LINEAR
    law%stiffness = DEFAULT_STIFFNESS_RATIO * first_modulus(model)
    call set_default_tension(reader, model, reader%cards%cards(c)%line, law)
    law%cutoff_clearance = REACH
    call report_note(reader, reader%cards%cards(c)%line, 'HARD is LINEAR under the calculix dialect, with K = ' // &
      to_text(law%stiffness) // ', 50 times Young''s modulus of the first material; the abaqus dialect enforces it exactly.')
  end subroutine replace_hard_by_linear


  !> LINEAR and TIED: K, sigma_inf, c0; the last two and a missing K by CalculiX's defaults. Under the abaqus dialect the tension
  !! is zero unless given: K h, and nothing outside contact.
  subroutine read_linear(reader, model, row, has_row, law)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(inout) :: row
    logical, intent(in) :: has_row
    type(interaction_type), intent(inout) :: law
    logical :: is_ok
    is_ok = .true.
    if (.not. has_row) row%n = 0
    law%behavior = BEHAVIOR_LINEAR
    call check_n_fields(reader, row, 3)
    call read_real(reader, row, 1, 'stiffness', law%stiffness, is_ok, 0.0_DP)
    call read_real(reader, row, 2, 'tension at large gaps', law%tension_limit, is_ok, 0.0_DP)
    call read_real(reader, row, 3, 'reach', law%cutoff_clearance, is_ok, 0.0_DP)
    if (law%tension_limit <= 0.0_DP .and. reader%dialect == DIALECT_ABAQUS) then
      law%cutoff_clearance = 0.0_DP
    else
      if (law%tension_limit <= 0.0_DP) call set_default_tension(reader, model, row%line, law)
      if (law%cutoff_clearance <= 0.0_DP) law%cutoff_clearance = REACH
    end if
    if (law%stiffness > 0.0_DP .or. .not. is_ok) return
    law%stiffness = DEFAULT_STIFFNESS_RATIO * first_modulus(model)
    call report_note(reader, row%line, 'The stiffness must be positive; 50 times Young''s modulus of the first material is ' // &
      'taken: ' // to_text(law%stiffness) // '.')
  end subroutine read_linear


  !> CalculiX's default tension limit; a note if it would stretch a soft body by a thousandth.
  subroutine set_default_tension(reader, model, line, law)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: line
    type(interaction_type), intent(inout) :: law
    real(DP) :: softest
    integer :: k
    law%tension_limit = TENSION * first_modulus(model)
    softest = minval(model%materials%youngs_modulus, mask=model%materials%youngs_modulus > 0.0_DP .and. &
      [(any(model%mesh%material == k), k=1, size(model%materials))])
    if (law%tension_limit <= MIN_REPORTED_STRAIN * softest) return
    call report_note(reader, line, 'Bodies pull at each other by up to ' // to_text(law%tension_limit) // ' before they part: ' // &
      'CalculiX''s default, a 70000th of Young''s modulus of the first material, which is much for the softest one (' // &
      to_text(softest) // '). Give a smaller second number with PRESSURE-OVERCLOSURE=LINEAR, or take the abaqus dialect, ' // &
      'which has no tension.')
  end subroutine set_default_tension


  !> EXPONENTIAL: c0, p0.
  subroutine read_exponential(reader, row, has_row, law)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    logical, intent(in) :: has_row
    type(interaction_type), intent(inout) :: law
    logical :: is_ok
    is_ok = has_row
    law%behavior = BEHAVIOR_EXPONENTIAL
    law%cutoff_clearance = 1.0_DP
    if (has_row) then
      call check_n_fields(reader, row, 2)
      call read_real(reader, row, 1, 'gap c0 where the pressure begins', law%cutoff_clearance, is_ok)
      call read_real(reader, row, 2, 'pressure p0 at gap zero', law%pressure, is_ok)
      if (is_ok .and. (law%cutoff_clearance <= 0.0_DP .or. law%pressure < 0.0_DP)) call report_error(reader, row%line, &
        'EXPONENTIAL needs a positive gap c0 and a pressure p0 that is not negative.')
    else
      call report_error(reader, row%line, 'EXPONENTIAL needs a data line: c0, p0.')
    end if
  end subroutine read_exponential


  !> TABULAR: pressure, overclosure; the overclosures ascend.
  subroutine read_table(reader, row, law)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    type(interaction_type), intent(inout) :: law
    real(DP) :: p, h
    logical :: is_ok
    is_ok = .true.
    law%behavior = BEHAVIOR_TABULAR
    law%cutoff_clearance = REACH
    allocate (law%table_pressure(0), law%table_overclosure(0))
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 3)
      call read_real(reader, row, 1, 'pressure', p, is_ok)
      call read_real(reader, row, 2, 'overclosure', h, is_ok)
      if (.not. is_ok) cycle
      if (size(law%table_pressure) > 0) then
        if (h <= law%table_overclosure(size(law%table_overclosure))) call report_error(reader, row%line, &
          'The overclosures of the table must ascend.')
      end if
      law%table_pressure = [law%table_pressure, p]
      law%table_overclosure = [law%table_overclosure, h]
    end do
    if (size(law%table_pressure) == 0 .and. is_ok) call report_error(reader, row%line, &
      'TABULAR needs data lines: pressure, overclosure.')
    if (size(law%table_pressure) == 0) then
      law%table_pressure = [0.0_DP]
      law%table_overclosure = [0.0_DP]
    end if
    if (reader%dialect == DIALECT_ABAQUS) law%clearance = max(0.0_DP, -law%table_overclosure(1))
    if (reader%dialect == DIALECT_CALCULIX .and. law%table_overclosure(1) < 0.0_DP) call report_note(reader, row%line, &
      'The table begins before bodies touch. Under the calculix dialect contact acts from where they touch on, as in ' // &
      'CalculiX: its pressure jumps there, and there may be no balance. Begin with 0., 0. or use the abaqus dialect.')
  end subroutine read_table


  !> DEPVAR and PROPERTIES of FRIC and UINTER, and the properties, eight in each line.
  subroutine read_properties(reader, parameters, row, law)
    type(reader_type), intent(inout) :: reader
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    type(interaction_type), intent(inout) :: law
    integer :: i, k, n
    logical :: is_ok
    n = parameter_count(parameters, 'PROPERTIES')
    law%n_statev = parameter_count(parameters, 'DEPVAR')
    if (allocated(law%props)) deallocate (law%props)
    allocate (law%props(n), source=0.0_DP)
    i = 0
    is_ok = .true.
    do while (next_row(reader%cards, row) .and. is_ok)
      call check_n_fields(reader, row, min(VALUES_PER_LINE, n - i))
      do k = 1, min(VALUES_PER_LINE, n - i)
        call read_real(reader, row, k, 'property', law%props(i + k), is_ok, 0.0_DP)
      end do
      i = i + min(VALUES_PER_LINE, n - i)
    end do
    if (i < n .and. is_ok) call report_error(reader, row%line, 'PROPERTIES is ' // to_text(n) // ', but the data lines hold only ' &
      // &
      to_text(i) // ', eight in each.')
  end subroutine read_properties


  !> A counting parameter; 0 if absent.
  pure integer function parameter_count(parameters, name) result(n)
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name
    real(DP) :: value
    integer :: status
    n = 0
    if (.not. has_parameter(parameters, name)) return
    call parse_real(parameter_text(parameters, name), value, status)
    if (status == NUMBER_OK) n = nint(min(max(value, 0.0_DP), 1.0e6_DP))
  end function parameter_count


  !> FRICTION: mu >= 0; the second value is a stick slope (calculix) or a slip rate (abaqus).
  subroutine read_friction(reader, c, law)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(interaction_type), intent(inout) :: law
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    real(DP) :: second
    integer :: status
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    law%shear_limit = NO_SHEAR_LIMIT
    law%is_user_friction = has_parameter(parameters, 'USER')
    if (law%behavior == BEHAVIOR_USER) then
      call report_error(reader, reader%cards%cards(c)%line, 'UINTER gives friction too; *FRICTION has no place in this ' // &
        'interaction.')
      return
    end if
    if (law%is_user_friction) then
      law%friction = 0.0_DP
      call read_properties(reader, parameters, row, law)
      return
    end if
    if (has_parameter(parameters, 'TAUMAX')) then
      call parse_real(parameter_text(parameters, 'TAUMAX'), law%shear_limit, status)
      if (status == NUMBER_OK .and. law%shear_limit <= 0.0_DP) call report_error(reader, reader%cards%cards(c)%line, &
        'TAUMAX must be positive.')
    end if
    call check_elastic_slip(reader, parameters, reader%cards%cards(c)%line)
    if (has_parameter(parameters, 'ROUGH')) law%friction = ROUGH_FRICTION
    if (.not. next_row(reader%cards, row)) then
      if (.not. has_parameter(parameters, 'ROUGH')) call report_error(reader, row%line, &
        '*FRICTION needs a data line: the coefficient of friction.')
      return
    end if
    if (has_parameter(parameters, 'ROUGH')) then
      call check_no_data(reader, row)
      return
    end if
    is_ok = .true.
    call read_real(reader, row, 1, 'coefficient of friction', law%friction, is_ok)
    call read_real(reader, row, 2, merge('slip rate  ', 'stick slope', reader%dialect == DIALECT_ABAQUS), second, &
      is_ok, 0.0_DP)
    call check_n_fields(reader, row, merge(4, 2, reader%dialect == DIALECT_ABAQUS))
    if (is_ok .and. law%friction < 0) call report_error(reader, row%line, &
      'The coefficient of friction must not be negative; 0 is frictionless.')
    if (is_ok .and. abs(second) > 0) call read_second_value(reader, row, second, law)
    if (next_row(reader%cards, row)) call report_error(reader, row%line, 'A second line would be for another slip ' // &
      'rate, pressure or temperature; the coefficient of friction is a constant.')
  end subroutine read_friction


  !> Checks the stick slope of FRICTION where it has no effect: only one definition, above zero.
  subroutine check_elastic_slip(reader, parameters, line)
    type(reader_type), intent(inout) :: reader
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(in) :: line
    character(14), parameter :: SLIP_PARAMETERS(3) = [character(14) :: 'SLIP TOLERANCE', 'ELASTIC SLIP', 'LAGRANGE']
    logical :: is_given(3)
    real(DP) :: slip
    integer :: i, status
    is_given = [(has_parameter(parameters, trim(SLIP_PARAMETERS(i))), i=1, 3)]
    if (count(is_given) > 1) call report_error(reader, line, 'SLIP TOLERANCE, ELASTIC SLIP and LAGRANGE exclude each other.')
    if (any(is_given) .and. has_parameter(parameters, 'ROUGH')) call report_error(reader, line, &
      'Rough surfaces never slip; leave out SLIP TOLERANCE, ELASTIC SLIP and LAGRANGE.')
    do i = 1, 2
      if (.not. is_given(i)) cycle
      call parse_real(parameter_text(parameters, trim(SLIP_PARAMETERS(i))), slip, status)
      if (status /= NUMBER_OK) slip = 0.0_DP
      if (slip <= 0.0_DP) call report_error(reader, line, trim(SLIP_PARAMETERS(i)) // ' must be a positive number.')
    end do
  end subroutine check_elastic_slip


  !> The second value of FRICTION.
  subroutine read_second_value(reader, row, second, law)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    real(DP), intent(in) :: second
    type(interaction_type), intent(inout) :: law
    if (reader%dialect == DIALECT_ABAQUS) then
      call report_error(reader, row%line, 'The second value is a slip rate (abaqus dialect), on which friction ' // &
        'cannot depend; leave it out. If it is the stick slope of CalculiX, put ''** dialect: calculix'' at the ' // &
        'top of the deck.')
      return
    end if
    law%stick_slope = second
    if (second < 0.0_DP) call report_error(reader, row%line, 'The stick slope must not be negative.')
    if (.not. is_compliant(law)) call report_note(reader, row%line, 'The second value is taken as the stick slope (calculix ' // &
      'dialect); without a *SURFACE BEHAVIOR before it, sticking is enforced exactly and does not use it.')
  end subroutine read_second_value


  !> CONTACT PAIR: slave, master; several rows define several pairs.
  subroutine read_pairs(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(contact_pair_type) :: common
    integer :: c, n, line
    allocate (model%pairs(0))
    line = 0
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'CONTACTPAIR')) cycle
      line = reader%cards%cards(c)%line
      call open_card(reader, c, parameters, row)
      if (has_parameter(parameters, 'TIED')) cycle   ! a tie
      common = contact_pair_type()
      common%interaction = reader%interactions%find(parameter_text(parameters, 'INTERACTION'))
      if (common%interaction == 0 .and. parameter_text(parameters, 'INTERACTION') /= '') call report_error(reader, &
        line, 'There is no surface interaction ''' // parameter_text(parameters, 'INTERACTION') &
        // '''' // reader%interactions%suggest(parameter_text(parameters, 'INTERACTION')))
      common%is_small_sliding = has_parameter(parameters, 'SMALL SLIDING')
      common%is_mortar = parameter_word(parameters, 'TYPE', 'NODETOSURFACE') /= 'NODETOSURFACE'
      common%has_point_contact = reader%dialect == DIALECT_CALCULIX .and. index(parameter_word(parameters, 'TYPE', ''), &
        'SURFACE') == 1
      call read_adjust(reader, model%mesh, c, parameters, common)
      n = 0
      do while (next_row(reader%cards, row))
        n = n + 1
        call check_n_fields(reader, row, 2)
        call read_pair(reader, row, common, model)
      end do
      if (n == 0) call report_error(reader, reader%cards%cards(c)%line, '*CONTACT PAIR needs a data line: slave, master.')
    end do
    if (any(model%pairs%interaction == 0)) return
    if (.not. all(is_compliant(model%interactions(model%pairs%interaction)))) model%pairs%has_point_contact = .false.
    if (.not. any(model%interactions%is_user_friction .or. model%interactions%behavior == BEHAVIOR_USER)) return
    if (any(model%pairs%has_point_contact)) call report_note(reader, line, &
      'The values STATEV of a routine of the user belong to slave ' // &
      'nodes: surface to surface contact is by the dual mortar method here, and not by points of the faces.')
    model%pairs%has_point_contact = .false.
  end subroutine read_pairs


  !> The parameter ADJUST: a distance, or the nodes that are moved.
  subroutine read_adjust(reader, mesh, c, parameters, pair)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    type(contact_pair_type), intent(inout) :: pair
    integer :: status, set
    pair%has_adjust = has_parameter(parameters, 'ADJUST')
    if (.not. pair%has_adjust) return
    call parse_real(parameter_text(parameters, 'ADJUST'), pair%adjust, status)
    set = 0
    if (status /= NUMBER_OK) set = reader%node_sets%find(parameter_text(parameters, 'ADJUST'))
    if (set > 0) then
      pair%adjust_nodes = mesh%node_sets(set)%members
      return
    end if
    if (status /= NUMBER_OK .or. pair%adjust < 0) call report_error(reader, reader%cards%cards(c)%line, 'ADJUST=' // &
      parameter_text(parameters, 'ADJUST') // ' must be a distance that is not negative, or a node set.')
  end subroutine read_adjust


  !> Errors of a surface in contact with itself.
  subroutine check_self_contact(reader, row, name, model, pair)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: name
    type(model_type), intent(in) :: model
    type(contact_pair_type), intent(in) :: pair
    character(:), allocatable :: surface
    surface = 'The surface ''' // name // ''' touches itself'
    if (pair%is_small_sliding) call report_error(reader, row%line, surface // &
      ', which needs finite sliding: leave out SMALL SLIDING.')
    if (pair%has_adjust) call report_error(reader, row%line, surface // ': ADJUST needs two surfaces, one of which is moved.')
    if (pair%interaction > 0) then
      if (is_compliant(model%interactions(pair%interaction))) call report_error(reader, row%line, surface // '; such a pair ' // &
        'has hard contact only. Leave out the PRESSURE-OVERCLOSURE, or name two surfaces, slave and master.')
    end if
    if (pair%is_mortar .or. model%surfaces(pair%slave)%is_node_based) return
    associate (faces => model%surfaces(pair%slave))
      if (any(has_midsides(model%mesh%kind(faces%element)))) call report_error(reader, row%line, surface // &
        '. Its elements have mid-side nodes, which contact at nodes would keep straight everywhere: give the pair ' // &
        'TYPE=SURFACE TO SURFACE.')
    end associate
  end subroutine check_self_contact


  !> One row of CONTACT PAIR.
  subroutine read_pair(reader, row, common, model)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(contact_pair_type), intent(in) :: common
    type(model_type), intent(inout) :: model
    type(contact_pair_type) :: pair
    character(:), allocatable :: slave, master
    slave = field_text(reader%cards, row, 1)
    master = field_text(reader%cards, row, 2)
    if (slave == '') then
      call report_error(reader, row%line, 'A contact pair needs two surfaces: slave, master; or one that touches itself.')
      return
    end if
    if (master == '') master = slave
    pair = common
    pair%name = slave // ' / ' // master
    pair%slave = find_slave_surface(reader, slave)
    pair%master = reader%surfaces%find(master)
    if (pair%slave == 0) call report_error(reader, row%line, 'There is no surface ''' // slave // '''' &
      // reader%surfaces%suggest(slave))
    if (pair%master == 0) call report_error(reader, row%line, 'There is no surface ''' // master // '''' // &
      reader%surfaces%suggest(master))
    if (pair%slave > 0 .and. is_self_contact(pair)) call check_self_contact(reader, row, slave, model, pair)
    if (pair%master > 0) then
      call set_analytic_master(reader, row, model%surfaces(pair%master), pair)
      if (model%surfaces(pair%master)%is_node_based) call report_error(reader, row%line, 'The master surface ''' // master &
        // ''' is made of nodes; a master needs element faces.')
    end if
    if (pair%slave > 0) then
      if (allocated(model%surfaces(pair%slave)%profile)) call report_error(reader, row%line, 'The slave surface ''' // slave // &
        ''' is analytic; only a master can be.')
    end if
    if (pair%slave > 0) call set_node_based_slave(reader, row, slave, model%surfaces(pair%slave), pair)
    model%pairs = [model%pairs, pair]
  end subroutine read_pair


  !> A pair with a slave of nodes: TYPE=SURFACE TO SURFACE, which Abaqus/CAE writes there too, reverts to the nodes as in Abaqus.
  subroutine set_node_based_slave(reader, row, name, slave, pair)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: name
    type(surface_type), intent(in) :: slave
    type(contact_pair_type), intent(inout) :: pair
    if (.not. (slave%is_node_based .and. pair%is_mortar)) return
    if (reader%dialect == DIALECT_CALCULIX) then
      call report_error(reader, row%line, 'The slave surface ''' // name // ''' is made of nodes; surface-to-surface ' // &
        'contact needs element faces. Give faces, or use TYPE=NODE TO SURFACE.')
      return
    end if
    call report_note(reader, row%line, 'The slave surface ''' // name // ''' is made of nodes: contact is enforced at ' // &
      'them, as with TYPE=NODE TO SURFACE.')
    pair%is_mortar = .false.
    pair%has_point_contact = .false.
  end subroutine set_node_based_slave


  !> A pair with an analytic master: contact is enforced at the nodes of the slave, whatever its TYPE.
  subroutine set_analytic_master(reader, row, master, pair)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(surface_type), intent(in) :: master
    type(contact_pair_type), intent(inout) :: pair
    if (.not. allocated(master%profile)) return
    if (pair%is_mortar) call report_note(reader, row%line, 'The master is analytic: contact is enforced at the nodes of the ' // &
      'slave, as with TYPE=NODE TO SURFACE.')
    pair%is_mortar = .false.
    pair%has_point_contact = .false.
  end subroutine set_analytic_master


  !> CLEARANCE: the initial gap of a pair, in place of that of the mesh.
  subroutine read_clearances(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: c, p, status
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'CLEARANCE')) cycle
      call open_card(reader, c, parameters, row)
      p = find_pair(reader, model, parameter_text(parameters, 'SLAVE'), parameter_text(parameters, 'MASTER'), &
        reader%cards%cards(c)%line)
      if (p == 0) cycle
      if (ignores_clearance(reader, model, model%pairs(p))) then
        call report_note(reader, reader%cards%cards(c)%line, &
          'CLEARANCE has no effect on a pair of TYPE=NODE TO SURFACE under the ' // &
          'calculix dialect, as in CalculiX.')
        cycle
      end if
      model%pairs(p)%has_clearance = .true.
      call parse_real(parameter_text(parameters, 'VALUE'), model%pairs(p)%clearance, status)
      if (status == NUMBER_OK .and. model%pairs(p)%has_adjust) call report_error(reader, reader%cards%cards(c)%line, &
        'The pair has both ADJUST and CLEARANCE; give one of them.')
    end do
  end subroutine read_clearances


  !> Whether CalculiX ignores CLEARANCE of a pair: a pair with springs at slave nodes.
  pure logical function ignores_clearance(reader, model, pair)
    type(reader_type), intent(in) :: reader
    type(model_type), intent(in) :: model
    type(contact_pair_type), intent(in) :: pair
    ignores_clearance = reader%dialect == DIALECT_CALCULIX .and. .not. pair%is_mortar .and. pair%interaction > 0
    if (ignores_clearance) ignores_clearance = is_compliant(model%interactions(pair%interaction))
  end function ignores_clearance


  !> The pair of two surfaces; reports a missing pair.
  integer function find_pair(reader, model, slave, master, line) result(pair)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    character(*), intent(in) :: slave, master
    integer, intent(in) :: line                  !< of the deck
    character(:), allocatable :: advice
    integer :: p
    pair = 0
    do p = 1, size(model%pairs)
      if (model%pairs(p)%slave == 0 .or. model%pairs(p)%slave /= find_slave_surface(reader, slave)) cycle
      if (model%pairs(p)%master == reader%surfaces%find(master)) pair = p
    end do
    if (pair > 0) return
    advice = ''
    if (any([(is_card(reader, p, 'CONTACT'), p=1, reader%cards%n_cards)])) advice = ' The pairs of *CONTACT have no names and ' // &
      'hold in all steps: give the two surfaces a *CONTACT PAIR, which *CONTACT leaves out then.'
    call report_error(reader, line, 'There is no contact pair of the slave ''' // slave // ''' and the master ''' // master // &
      '''.' // advice)
  end function find_pair


  !> Changes in a step: CHANGE FRICTION, CHANGE SURFACE BEHAVIOR and the cards below them, MODEL CHANGE, CONTACT
  !! INTERFERENCE. Changes persist in later steps, but an interference applies to one step.
  subroutine read_contact_change(reader, model, c, interaction, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(inout) :: interaction        !< the one that a CHANGE card names; its FRICTION or BEHAVIOR follows
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    call open_card(reader, c, parameters, row)
    if (is_card(reader, c, 'CHANGEFRICTION') .or. is_card(reader, c, 'CHANGESURFACEBEHAVIOR')) then
      interaction = reader%interactions%find(parameter_text(parameters, 'INTERACTION'))
      if (interaction == 0) call report_error(reader, reader%cards%cards(c)%line, 'There is no surface interaction ''' // &
        parameter_text(parameters, 'INTERACTION') // '''.')
      return
    end if
    if (is_card(reader, c, 'MODELCHANGE')) then
      call change_pairs(reader, model, c, parameters, row, step)
    else if (is_card(reader, c, 'CONTACTINTERFERENCE')) then
      call read_interference(reader, model, c, parameters, row, step)
    else if (interaction > 0) then
      call change_law(reader, model, c, interaction, step)
    end if
  end subroutine read_contact_change


  !> FRICTION or SURFACE BEHAVIOR of an interaction from this step on.
  subroutine change_law(reader, model, c, interaction, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: interaction
    type(step_type), intent(inout) :: step
    type(interaction_type) :: law
    if (.not. allocated(step%interactions)) step%interactions = model%interactions
    law = step%interactions(interaction)
    if (is_card(reader, c, 'FRICTION')) then
      law%stick_slope = 0.0_DP
      call read_friction(reader, c, law)
    else
      if (allocated(law%table_pressure)) deallocate (law%table_pressure, law%table_overclosure)
      call read_behavior(reader, model, c, law)
      if (is_compliant(law) .neqv. is_compliant(step%interactions(interaction))) call report_error(reader, &
        reader%cards%cards(c)%line, 'A step cannot change a HARD interaction to a compliant one, or back: their slave ' // &
        'nodes are not the same. Use one kind in all steps.')
    end if
    if (law%n_statev /= model%interactions(interaction)%n_statev) then
      call report_error(reader, reader%cards%cards(c)%line, 'A step cannot change DEPVAR of an interaction.')
    end if
    call complete_law(reader, model, law)
    step%interactions(interaction) = law
  end subroutine change_law


  !> MODEL CHANGE, TYPE=CONTACT PAIR: removes pairs or adds them again.
  subroutine change_pairs(reader, model, c, parameters, row, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    type(step_type), intent(inout) :: step
    integer :: p
    if (has_parameter(parameters, 'ADD') .eqv. has_parameter(parameters, 'REMOVE')) then
      call report_error(reader, reader%cards%cards(c)%line, '*MODEL CHANGE needs either ADD or REMOVE.')
      return
    end if
    if (parameter_word(parameters, 'TYPE', 'CONTACTPAIR') /= 'CONTACTPAIR') return
    if (.not. allocated(step%is_removed)) allocate (step%is_removed(size(model%pairs)), source=.false.)
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 2)
      p = find_pair(reader, model, field_text(reader%cards, row, 1), field_text(reader%cards, row, 2), row%line)
      if (p > 0) step%is_removed(p) = has_parameter(parameters, 'REMOVE')
    end do
  end subroutine change_pairs


  !> CONTACT INTERFERENCE: an overclosure allowed at the start of the step and removed by its end.
  subroutine read_interference(reader, model, c, parameters, row, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    type(step_type), intent(inout) :: step
    logical :: is_ok
    integer :: p, n
    is_ok = .true.
    n = 0
    if (.not. allocated(step%interference)) then
      allocate (step%interference(size(model%pairs)), source=0.0_DP)
      allocate (step%is_shrink_fit(size(model%pairs)), source=.false.)
    end if
    do while (next_row(reader%cards, row))
      n = n + 1
      call check_n_fields(reader, row, 3)
      p = find_pair(reader, model, field_text(reader%cards, row, 1), field_text(reader%cards, row, 2), row%line)
      if (p == 0) cycle
      step%is_shrink_fit(p) = has_parameter(parameters, 'SHRINK')
      call read_real(reader, row, 3, 'allowed interference', step%interference(p), is_ok, 0.0_DP)
    end do
    if (n == 0) call report_error(reader, reader%cards%cards(c)%line, '*CONTACT INTERFERENCE needs data lines: slave, ' // &
      'master, interference.')
  end subroutine read_interference

end module amontons_deck_contact
