!> PRINT, FILE, OUTPUT and TIME POINTS to output requests.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_output
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_card_table, only: NODE_VARIABLES, ELEMENT_VARIABLES, CONTACT_VARIABLES, SECTION_VARIABLES
  use amontons_deck_reader, only: reader_type, time_list_type, open_card, report_error, report_note, read_real, is_card
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_steps, only: step_type, print_request_type, PRINT_NODE, PRINT_ELEMENT, PRINT_CONTACT, PRINT_SECTION, &
    frd_request_type, N_FRD, FRD_ERROR
  use amontons_text, only: to_text, name_key, parse_integer, is_one_of, joined_words, NUMBER_OK
  use amontons_element_kinds, only: is_of_revolution
  implicit none
  private
  public :: output_requests_type, begin_output, read_output_card, set_output_times, read_time_points

  integer, parameter :: MAX_TIME_POINTS = 1000000     !< times of one GENERATE line
  character(*), parameter :: FILE_VARIABLES = 'U|UR|RF|SF|SM|S|E|LE|CDIS|CDISP|CSTR|CSTRESS|COPEN|CSLIP|CPRESS|CSHEAR|' // &
    'CSTATUS|CFORCE|CNORMF|CSHEARF|CELS|PEEQ|CEEQ|PE|CE|ENER|ME|THE|SDV|ERR|NOE|NT|MISES|PRESELECT|ALL|ALLSE|ALLWK|ALLFD|' // &
    'ALLSD'                                               !< contents of the result files
  character(*), parameter :: FRD_WORDS(N_FRD) = [character(24) :: 'U', 'NT', 'S', 'E|THE', 'ME|THE', 'THE', 'RF', &
    'PEEQ|CEEQ|PE|CE', 'ENER', 'CDIS|CDISP|CSTR|CSTRESS', 'CELS', 'SDV', 'ERR|S']   !< variables of the .frd file and their fields
  integer, parameter :: FRD_GROUPS(N_FRD) = [1, 1, 2, 2, 2, 2, 1, 2, 2, 3, 3, 2, 2]   !< cards of nodes, elements, contact

  !> The output cards read so far in a step; the requests are stored in the step.
  type :: output_requests_type
    logical :: has_prints(4) = .false.           !< (PRINT_...) this step has such a card
    logical :: has_files(3) = .false.            !< (nodes, elements, contact) this step has such a FILE or OUTPUT card
    integer :: print_list = 0, file_list = 0     !< lists of TIME POINTS in force; 0: FREQUENCY counts
  end type output_requests_type

contains

  !> Starts a step without output cards.
  pure subroutine begin_output(output)
    type(output_requests_type), intent(inout) :: output
    output%has_prints = .false.
    output%has_files = .false.
  end subroutine begin_output


  !> Reads one card of a step, if it requests output.
  subroutine read_output_card(reader, model, c, output, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card, which is in the table
    type(output_requests_type), intent(inout) :: output
    type(step_type), intent(inout) :: step
    select case (reader%table%entries(reader%cards%cards(c)%entry)%key)
    case ('NODEPRINT')
      call read_print(reader, c, PRINT_NODE, NODE_VARIABLES, output, step)
    case ('ELPRINT')
      call read_print(reader, c, PRINT_ELEMENT, ELEMENT_VARIABLES, output, step)
    case ('CONTACTPRINT')
      call read_print(reader, c, PRINT_CONTACT, CONTACT_VARIABLES, output, step)
    case ('SECTIONPRINT')
      call read_section_print(reader, model, c, output, step)
    case ('NODEFILE', 'NODEOUTPUT', 'ELFILE', 'ELOUTPUT', 'ELEMENTOUTPUT', 'CONTACTFILE', 'CONTACTOUTPUT', &
      'ENERGYFILE', 'ENERGYOUTPUT', 'OUTPUT')
      call read_file_request(reader, c, output, step)
    end select
  end subroutine read_output_card


  !> NODE PRINT, EL PRINT, CONTACT PRINT: the first of a kind in a step replaces those of earlier steps.
  subroutine read_print(reader, c, kind, known, output, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: kind                  !< PRINT_...
    character(*), intent(in) :: known            !< variables separated by |
    type(output_requests_type), intent(inout) :: output
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(print_request_type) :: request
    character(:), allocatable :: name
    call open_card(reader, c, parameters, row)
    call begin_prints(kind, output, step)
    call read_print_frequency(reader, c, parameters, output, step)
    request%kind = kind
    name = ''
    request%is_totals = parameter_word(parameters, 'TOTALS', 'NO') == 'YES'
    request%is_only_totals = parameter_word(parameters, 'TOTALS', 'NO') == 'ONLY'
    if (kind == PRINT_NODE) then
      name = parameter_text(parameters, 'NSET')
      request%set = reader%node_sets%find(name)
      request%is_local = parameter_word(parameters, 'GLOBAL', &
        trim(merge('NO ', 'YES', reader%dialect == DIALECT_CALCULIX))) == 'NO'
    else if (kind == PRINT_ELEMENT) then
      name = parameter_text(parameters, 'ELSET')
      request%set = reader%element_sets%find(name)
      request%is_local = parameter_word(parameters, 'GLOBAL', 'NO') == 'NO'
    else
      call read_contact_choice(reader, c, parameters, request)
    end if
    if (kind /= PRINT_CONTACT .and. request%set == 0 .and. (name /= '' .or. reader%dialect == DIALECT_CALCULIX)) then
      call report_print_set(reader, c, kind == PRINT_NODE, name)
      return
    end if
    call read_variables(reader, row, known, request%variables)
    if (size(request%variables) > 0) step%prints = [step%prints, request]
  end subroutine read_print


  !> Reports a PRINT card without a set: CalculiX passes over it with a warning.
  subroutine report_print_set(reader, c, is_of_nodes, name)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    logical, intent(in) :: is_of_nodes           !< else of elements
    character(*), intent(in) :: name             !< of the set; empty: none is named
    character(:), allocatable :: text
    if (name /= '') then
      text = 'There is no ' // trim(merge('node   ', 'element', is_of_nodes)) // ' set ''' // name // ''''
    else
      text = trim(merge('*NODE PRINT needs NSET', '*EL PRINT needs ELSET ', is_of_nodes)) // ' under the calculix dialect'
    end if
    if (reader%dialect == DIALECT_CALCULIX) then
      call report_note(reader, reader%cards%cards(c)%line, text // '; the card is passed over.')
    else
      call report_error(reader, reader%cards%cards(c)%line, text // '.')
    end if
  end subroutine report_print_set


  !> The slave nodes of a CONTACT PRINT: NSET, SLAVE, MASTER.
  subroutine read_contact_choice(reader, c, parameters, request)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(print_request_type), intent(inout) :: request
    request%set = reader%node_sets%find(parameter_text(parameters, 'NSET'))
    request%slave = reader%surfaces%find(parameter_text(parameters, 'SLAVE'))
    request%master = reader%surfaces%find(parameter_text(parameters, 'MASTER'))
    call report_unknown('NSET', 'node set', request%set)
    call report_unknown('SLAVE', 'surface', request%slave)
    call report_unknown('MASTER', 'surface', request%master)

  contains

    !> Reports a parameter that names an unknown object.
    subroutine report_unknown(parameter, what, found)
      character(*), intent(in) :: parameter, what
      integer, intent(in) :: found
      if (found > 0 .or. .not. has_parameter(parameters, parameter)) return
      call report_error(reader, reader%cards%cards(c)%line, 'There is no ' // what // ' ''' // &
        parameter_text(parameters, parameter) // '''.')
    end subroutine report_unknown

  end subroutine read_contact_choice


  !> The first PRINT card of a kind in a step deletes those of earlier steps.
  subroutine begin_prints(kind, output, step)
    integer, intent(in) :: kind                  !< PRINT_...
    type(output_requests_type), intent(inout) :: output
    type(step_type), intent(inout) :: step
    if (.not. output%has_prints(kind)) step%prints = pack(step%prints, step%prints%kind &
      /= kind)
    output%has_prints(kind) = .true.
  end subroutine begin_prints


  !> SECTION PRINT: the surface must consist of faces; each of its variables requests the same block.
  subroutine read_section_print(reader, model, c, output, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(output_requests_type), intent(inout) :: output
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(print_request_type) :: request
    character(:), allocatable :: name, trouble
    integer :: i
    call open_card(reader, c, parameters, row)
    call begin_prints(PRINT_SECTION, output, step)
    call read_print_frequency(reader, c, parameters, output, step)
    request%kind = PRINT_SECTION
    name = parameter_text(parameters, 'SURFACE')
    if (name == '') return
    request%set = reader%surfaces%find(name)
    trouble = ''
    if (request%set == 0) then
      trouble = 'There is no surface ''' // name // '''.'
    else if (model%surfaces(request%set)%is_node_based) then
      trouble = '*SECTION PRINT needs a surface of element faces; ''' // name // ''' is one of nodes.'
    else
      associate (surface => model%surfaces(request%set))
        do i = 1, size(surface%element)
          if (is_of_revolution(model%mesh%kind(surface%element(i)))) trouble = '*SECTION PRINT is not supported for ' // &
            'axisymmetric elements, of which the surface ''' // name // ''' has some. Sum up the RF of *NODE PRINT.'
        end do
      end associate
    end if
    if (trouble /= '') call report_error(reader, reader%cards%cards(c)%line, trouble)
    call read_variables(reader, row, SECTION_VARIABLES, request%variables)
    if (size(request%variables) > 0 .and. trouble == '') step%prints = [step%prints, request]
  end subroutine read_section_print


  !> The variables of a PRINT card; long names such as CDISP are matched by their first four letters.
  subroutine read_variables(reader, row, known, variables)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    character(*), intent(in) :: known            !< variables separated by |
    character(4), allocatable, intent(out) :: variables(:)
    character(:), allocatable :: key
    integer :: i
    allocate (variables(0))
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        key = name_key(field_text(reader%cards, row, i))
        if (key == '') cycle
        if (len(key) > 4) key = key(:4)
        if (is_one_of(key, known)) then
          if (.not. any(variables == key)) variables = [character(4) :: variables, key]
        else
          call report_note(reader, row%line, 'The variable ' // field_text(reader%cards, row, i) // &
            ' is not printed; known is ' // joined_words(known) // '.')
        end if
      end do
    end do
  end subroutine read_variables


  !> FREQUENCY or TIME POINTS of a PRINT card; in CalculiX FILE cards follow it.
  subroutine read_print_frequency(reader, c, parameters, output, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(output_requests_type), intent(inout) :: output
    type(step_type), intent(inout) :: step
    call read_frequency(reader, c, parameters, step%print_frequency, output%print_list)
    if (reader%dialect == DIALECT_CALCULIX) call share_frequency(parameters, step%print_frequency, &
      output%print_list, step%file_frequency, output%file_list)
  end subroutine read_print_frequency


  !> FREQUENCY or TIME POINTS of a FILE or OUTPUT card; in CalculiX PRINT cards follow it.
  subroutine read_file_frequency(reader, c, parameters, output, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(output_requests_type), intent(inout) :: output
    type(step_type), intent(inout) :: step
    call read_frequency(reader, c, parameters, step%file_frequency, output%file_list)
    if (reader%dialect == DIALECT_CALCULIX) call share_frequency(parameters, step%file_frequency, output%file_list, &
      step%print_frequency, output%print_list)
  end subroutine read_file_frequency


  !> FREQUENCY or TIME POINTS of a card; the last one of all cards wins.
  subroutine read_frequency(reader, c, parameters, frequency, list)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(inout) :: frequency
    integer, intent(inout) :: list               !< active TIME POINTS list; 0: none
    integer :: value, status
    if (has_parameter(parameters, 'TIME POINTS')) then
      call find_time_points(reader, c, parameter_text(parameters, 'TIME POINTS'), list)
    else if (has_parameter(parameters, 'FREQUENCY')) then
      list = 0
    end if
    if (.not. has_parameter(parameters, 'FREQUENCY')) return
    call parse_integer(parameter_text(parameters, 'FREQUENCY'), value, status)
    if (status /= NUMBER_OK) return              ! already reported by the check of the card
    if (value < 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'FREQUENCY must not be negative.')
    else
      frequency = value
    end if
  end subroutine read_frequency


  !> In CalculiX the last FREQUENCY or TIME POINTS of PRINT and FILE cards counts for all of them; 0 only for its own kind.
  pure subroutine share_frequency(parameters, frequency, list, other_frequency, other_list)
    type(parameter_type), intent(in) :: parameters(:)
    integer, intent(in) :: frequency, list       !< of the kind of the card
    integer, intent(inout) :: other_frequency, other_list
    if (.not. (has_parameter(parameters, 'TIME POINTS') .or. has_parameter(parameters, 'FREQUENCY')) .or. frequency == 0) return
    other_list = list
    if (other_frequency > 0) other_frequency = frequency
  end subroutine share_frequency


  !> A FILE or OUTPUT card: its frequency; its variables apply to the .frd file only, because the result file contains all
  !! fields. The first card of a kind in a step replaces those of earlier steps. HISTORY does not apply to fields.
  subroutine read_file_request(reader, c, output, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(output_requests_type), intent(inout) :: output
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: unknown, word
    type(frd_request_type) :: request
    logical :: has_no_error                      ! NOE: stress does not add its error
    integer :: i, group
    call open_card(reader, c, parameters, row)
    if (has_parameter(parameters, 'HISTORY')) return
    request%is_wanted = .true.
    request%is_local = parameter_word(parameters, 'GLOBAL', 'YES') == 'NO'
    if (reader%dialect == DIALECT_CALCULIX .and. has_parameter(parameters, 'NSET')) then
      request%set = reader%node_sets%find(parameter_text(parameters, 'NSET'))
      if (request%set == 0) call report_error(reader, reader%cards%cards(c)%line, 'There is no node set ''' // &
        parameter_text(parameters, 'NSET') // '''.')
    end if
    call read_file_frequency(reader, c, parameters, output, step)
    group = file_group(reader%cards%cards(c)%key)
    if (group > 0) then
      if (.not. output%has_files(group)) where (FRD_GROUPS == group) step%frd%is_wanted = .false.
      output%has_files(group) = .true.
    end if
    unknown = ''
    has_no_error = .false.
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        word = field_text(reader%cards, row, i)
        call request_frd_fields(word, request, step%frd)
        has_no_error = has_no_error .or. is_one_of(word, 'NOE')
        if (is_one_of(word, FILE_VARIABLES) .or. is_one_of(strip_digits(word), FILE_VARIABLES)) cycle
        if (unknown /= '') unknown = unknown // ', '
        unknown = unknown // word
      end do
    end do
    if (has_no_error) step%frd(FRD_ERROR)%is_wanted = .false.
    if (unknown /= '') call report_note(reader, reader%cards%cards(c)%line, 'job.vtkhdf always holds the same fields, and ' // &
      'job.frd the requested ones; what is in neither: ' // unknown // '.')
  end subroutine read_file_request


  !> The field of a component: RF of RF3, S of S12.
  pure function strip_digits(word) result(field)
    character(*), intent(in) :: word
    character(:), allocatable :: field
    field = word(:verify(word, '0123456789', back=.true.))
  end function strip_digits


  !> The category of a card: 1 values of nodes, 2 of elements, 3 of contact, 0 other.
  pure integer function file_group(card) result(group)
    character(*), intent(in) :: card             !< its name without blanks
    group = 0
    if (index(card, 'NODE') == 1) group = 1
    if (index(card, 'EL') == 1) group = 2
    if (index(card, 'CONTACT') == 1) group = 3
  end function file_group


  !> Requests the fields of the .frd file for a variable, if there are any. Stress adds its error, as in
  !! CalculiX.
  subroutine request_frd_fields(word, request, frd)
    character(*), intent(in) :: word
    type(frd_request_type), intent(in) :: request
    type(frd_request_type), intent(inout) :: frd(:)   !< (N_FRD)
    integer :: i
    do i = 1, N_FRD
      if (is_one_of(word, trim(FRD_WORDS(i)))) frd(i) = request
    end do
  end subroutine request_frd_fields


  !> At the end of a step: its output times by TIME POINTS.
  subroutine set_output_times(reader, output, total_time, step)
    type(reader_type), intent(in) :: reader
    type(output_requests_type), intent(in) :: output
    real(DP), intent(in) :: total_time           !< at the start of the step [time]
    type(step_type), intent(inout) :: step
    call times_in_step(reader, output%print_list, total_time, step%period, step%print_times)
    call times_in_step(reader, output%file_list, total_time, step%period, step%file_times)
  end subroutine set_output_times


  !> Reads all TIME POINTS cards, wherever they are in the deck.
  subroutine read_time_points(reader)
    type(reader_type), intent(inout) :: reader
    type(time_list_type) :: list
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: c, position, n_errors
    logical :: is_new
    allocate (reader%time_lists(0))
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'TIMEPOINTS')) cycle
      call open_card(reader, c, parameters, row)
      if (parameter_text(parameters, 'NAME') == '') cycle
      list%is_total_time = parameter_word(parameters, 'TIME', 'STEPTIME') == 'TOTALTIME'
      n_errors = reader%messages%n_errors
      call read_times(reader, row, has_parameter(parameters, 'GENERATE'), list%times)
      associate (line => reader%cards%cards(c)%line)
        if (reader%messages%n_errors == n_errors) then
          if (size(list%times) == 0) then
            call report_error(reader, line, '*TIME POINTS needs a data line with times.')
          else if (any(list%times(2:) <= list%times(:size(list%times) - 1))) then
            call report_error(reader, line, 'The times of *TIME POINTS must ascend.')
          end if
        end if
        call reader%time_names%add(parameter_text(parameters, 'NAME'), position, is_new)
        if (.not. is_new) call report_error(reader, line, 'The time points ''' // parameter_text(parameters, 'NAME') // &
          ''' are defined twice.')
      end associate
      if (is_new) reader%time_lists = [reader%time_lists, list]
    end do
  end subroutine read_time_points


  !> The times in the rows of a card.
  subroutine read_times(reader, row, is_generated, times)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    logical, intent(in) :: is_generated
    real(DP), allocatable, intent(out) :: times(:)
    real(DP), allocatable :: of_row(:)
    integer :: i
    logical :: is_ok
    allocate (times(0))
    do while (next_row(reader%cards, row))
      is_ok = .true.
      allocate (of_row(row%n), source=0.0_DP)
      do i = 1, row%n
        call read_real(reader, row, i, 'time', of_row(i), is_ok)
      end do
      if (is_ok .and. is_generated) call generate_times(reader, row, of_row)
      if (is_ok) times = [times, of_row]
      deallocate (of_row)
    end do
  end subroutine read_times


  !> GENERATE: first time, last time, distance; the last time is always included.
  subroutine generate_times(reader, row, times)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    real(DP), allocatable, intent(inout) :: times(:)   !< in: the fields of the row; out: the times
    real(DP) :: first, last, distance
    integer :: i, n
    if (size(times) == 3) then
      first = times(1)
      last = times(2)
      distance = times(3)
      if (distance > 0 .and. last >= first .and. last - first <= distance * MAX_TIME_POINTS) then
        n = floor((last - first) / distance * (1 + 1.0e-9_DP))
        times = [(first + real(i, DP) * distance, i=0, n)]
        if (times(n + 1) < last - 1.0e-6_DP * distance) times = [times, last]
        return
      end if
    end if
    times = [real(DP) ::]
    call report_error(reader, row%line, 'A line of *TIME POINTS, GENERATE must hold first time, last time and a positive ' // &
      'distance, for at most ' // to_text(MAX_TIME_POINTS) // ' times.')
  end subroutine generate_times


  !> The list named by TIME POINTS on a card; reports an unknown name.
  subroutine find_time_points(reader, c, name, list)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< card that names it
    character(*), intent(in) :: name
    integer, intent(out) :: list                 !< index into reader%time_lists; 0: none
    list = reader%time_names%find(name)
    if (list == 0 .and. name /= '') call report_error(reader, reader%cards%cards(c)%line, 'There are no time points ''' // &
      name // '''; *TIME POINTS, NAME=' // name // ' defines them.')
  end subroutine find_time_points


  !> The times of a list that lie in a step; unallocated without a list.
  subroutine times_in_step(reader, list, total_time, period, times)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: list                  !< index into reader%time_lists; 0: none
    real(DP), intent(in) :: total_time           !< at the start of the step [time]
    real(DP), intent(in) :: period               !< its length [time]
    real(DP), allocatable, intent(out) :: times(:)   !< [step time]
    if (list == 0) return
    times = reader%time_lists(list)%times
    if (reader%time_lists(list)%is_total_time) times = times - total_time
    times = pack(times, times > 1.0e-6_DP * period .and. times < period * (1 - 1.0e-6_DP))
  end subroutine times_in_step

end module amontons_deck_output
