!> Tables of material properties and hardening curves of the deck, over the temperature or a field variable.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_property_tables
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, check_n_fields, &
    VALUES_PER_LINE
  use amontons_materials, only: property_table_type, hardening_curve_type
  use amontons_model, only: DIALECT_CALCULIX
  use amontons_text, only: to_text, plural, parse_integer, NUMBER_OK
  implicit none
  private
  public :: read_table, read_curves

contains

  !> Values over the temperature or a field variable: a record is the values, a temperature and DEPENDENCIES field variables, in
  !! lines of eight.
  subroutine read_table(reader, c, n, table, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: n                     !< values of a record
    type(property_table_type), intent(out) :: table
    logical, intent(out) :: is_ok
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP), allocatable :: record(:), before(:)
    integer :: i, k, m
    allocate (table%temperature(0), table%value(n, 0))
    is_ok = .true.
    call open_card(reader, c, parameters, row)
    m = n + 1 + n_dependencies(reader, c, parameters)
    allocate (record(m))
    do while (next_row(reader%cards, row))
      i = 0
      do
        call check_record(reader, row, min(VALUES_PER_LINE, m - i))
        do k = 1, min(VALUES_PER_LINE, m - i)
          call read_real(reader, row, k, trim(merge('temperature', 'constant   ', i + k > n)), record(i + k), is_ok, &
            0.0_DP)
        end do
        i = i + min(VALUES_PER_LINE, m - i)
        if (i == m .or. (i > n .and. m == n + 1)) exit
        if (next_row(reader%cards, row)) cycle
        record(i + 1:) = 0
        if (i < n) call report_error(reader, row%line, 'Of ' // to_text(n) // ' constants only ' // to_text(i) // &
          ' are there; they continue in the next line after eight values.')
        if (i < n) is_ok = .false.
        exit
      end do
      if (.not. allocated(before)) before = record(n + 1:)
      if (is_ok) call add_record(reader, row%line, record, before, table, is_ok)
      before = record(n + 1:)
      if (.not. is_ok) exit
    end do
    if (size(table%temperature) == 0 .and. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, '*' // &
        reader%table%entries(reader%cards%cards(c)%entry)%keyword // ' needs a data line: ' // &
        reader%table%entries(reader%cards%cards(c)%entry)%data // '.')
      is_ok = .false.
    end if
  end subroutine read_table


  !> Reports more values than a record has; CalculiX does not read them.
  subroutine check_record(reader, row, n)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: n                     !< values that are read
    if (reader%dialect /= DIALECT_CALCULIX) then
      call check_n_fields(reader, row, n)
    else if (row%n > n) then
      call report_note(reader, row%line, 'Of this line the first ' // plural(n, 'value') // ' count, as in CalculiX.')
    end if
  end subroutine check_record


  !> The number of field variables behind the temperature in the data of a card.
  integer function n_dependencies(reader, c, parameters) result(n)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    integer :: status
    n = 0
    if (.not. has_parameter(parameters, 'DEPENDENCIES')) return
    call parse_integer(parameter_text(parameters, 'DEPENDENCIES'), n, status)
    if (status == NUMBER_OK .and. n >= 1) return
    n = 0
    call report_error(reader, reader%cards%cards(c)%line, 'DEPENDENCIES must be the number of field variables: 1, 2, ...')
  end function n_dependencies


  !> Finds what a table is over, from the arguments (temperature and field variables) of a record and of the one before it: the one
  !! that changes, 0 the temperature, k field variable k. Several that change in one table are reported.
  subroutine find_variable(reader, line, before, now, is_first, variable, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    real(DP), intent(in) :: before(:), now(:)
    logical, intent(in) :: is_first              !< it is the second record: the variable is not known yet
    integer, intent(inout) :: variable
    logical, intent(inout) :: is_ok
    integer :: found
    if (.not. any(abs(now - before) > 0)) return
    found = findloc(abs(now - before) > 0, .true., dim=1) - 1
    if (is_first) variable = found
    if (count(abs(now - before) > 0) == 1 .and. found == variable) return
    call report_error(reader, line, 'The properties of a material may depend on the temperature or on one field variable, not on ' &
      // 'several of them: one column of the table may change.')
    is_ok = .false.
  end subroutine find_variable


  !> Adds a record to a table; the temperatures or values of the field variable ascend.
  subroutine add_record(reader, line, record, before, table, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    real(DP), intent(in) :: record(:)            !< values, temperature, field variables
    real(DP), intent(in) :: before(:)            !< temperature and field variables of the record before
    type(property_table_type), intent(inout) :: table
    logical, intent(inout) :: is_ok
    integer :: n, m
    n = size(table%value, 1)
    m = size(table%temperature)
    if (m > 0) then
      call find_variable(reader, line, before, record(n + 1:), m == 1, table%variable, is_ok)
      if (.not. is_ok) return
      if (m == 1) table%temperature(1) = before(1 + table%variable)
      if (record(n + 1 + table%variable) <= table%temperature(m)) then
        call report_error(reader, line, 'The temperatures of a property must ascend; the last value of each record is ' // &
          'its temperature, or with DEPENDENCIES its field variable.')
        is_ok = .false.
        return
      end if
    end if
    table%temperature = [table%temperature, record(n + 1 + table%variable)]
    table%value = reshape([table%value, record(:n)], [n, m + 1])
  end subroutine add_record


  !> Yield stress over plastic strain, at one or more temperatures; or two other quantities, the first constant below the first
  !! value of the second.
  subroutine read_curves(reader, c, curves, names)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(hardening_curve_type), allocatable, intent(inout) :: curves(:)
    character(*), intent(in), optional :: names(2)   !< of the two in messages
    character(:), allocatable :: ordinate, abscissa
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(hardening_curve_type) :: curve
    real(DP) :: values(2)
    real(DP), allocatable :: arguments(:), before(:)
    integer :: i, n
    logical :: is_ok
    ordinate = 'yield stress'
    abscissa = 'plastic strain'
    if (present(names)) ordinate = trim(names(1))
    if (present(names)) abscissa = trim(names(2))
    if (allocated(curves)) deallocate (curves)
    allocate (curves(0), curve%strain(0), curve%stress(0))
    is_ok = .true.
    call open_card(reader, c, parameters, row)
    n = n_dependencies(reader, c, parameters)
    allocate (arguments(1 + n))
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 3 + n)
      call read_real(reader, row, 1, ordinate, values(1), is_ok)
      call read_real(reader, row, 2, abscissa, values(2), is_ok, 0.0_DP)
      do i = 1, 1 + n
        call read_real(reader, row, 2 + i, 'temperature', arguments(i), is_ok, 0.0_DP)
      end do
      if (.not. is_ok) return
      if (size(curve%strain) > 0) then
        if (any(abs(arguments - before) > 0)) then
          call find_variable(reader, row%line, before, arguments, size(curves) == 0, curve%variable, is_ok)
          if (.not. is_ok) return
          curve%temperature = before(1 + curve%variable)
          call close_curve()
        end if
      end if
      before = arguments
      curve%temperature = arguments(1 + curve%variable)
      curve%stress = [curve%stress, values(1)]
      curve%strain = [curve%strain, values(2)]
    end do
    if (size(curve%strain) > 0) call close_curve()
    if (size(curves) == 0) call report_error(reader, reader%cards%cards(c)%line, &
      'A hardening curve needs data: ' // ordinate // ', equivalent ' // abscissa // ', temperature.')
    do i = 2, size(curves)
      if (curves(i)%temperature <= curves(i - 1)%temperature) call report_error(reader, reader%cards%cards(c)%line, &
        'The temperatures of the hardening curves must ascend.')
    end do

  contains

    !> Stores the curve of one temperature.
    subroutine close_curve()
      integer :: k
      if (any(curve%stress <= 0)) call report_error(reader, reader%cards%cards(c)%line, 'A ' // ordinate // ' must be positive.')
      if (present(names) .and. curve%strain(1) > 0) then
        curve%strain = [0.0_DP, curve%strain]
        curve%stress = [curve%stress(1), curve%stress]
      else if (reader%dialect == DIALECT_CALCULIX .and. curve%strain(1) > 0) then
        call report_note(reader, reader%cards%cards(c)%line, 'The hardening curve begins at the plastic strain ' // &
          to_text(curve%strain(1)) // ': below, its first yield stress is constant, as in CalculiX.')
        curve%strain = [0.0_DP, curve%strain]
        curve%stress = [curve%stress(1), curve%stress]
      end if
      if (abs(curve%strain(1)) > 0) call report_error(reader, reader%cards%cards(c)%line, &
        'The ' // abscissa // ' of the first point of a hardening curve must be 0.')
      k = size(curve%strain)
      if (any(curve%strain(2:) <= curve%strain(:k - 1))) call report_error(reader, reader%cards%cards(c)%line, &
        'The ' // abscissa // 's of a hardening curve must ascend.')
      curves = [curves, curve]
      deallocate (curve%strain, curve%stress)
      allocate (curve%strain(0), curve%stress(0))
    end subroutine close_curve

  end subroutine read_curves

end module amontons_deck_property_tables
