!> Deck times: the cards TIME POINTS to the times of a step at which results are wanted.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_times
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, row_type, next_row
  use amontons_card_form, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_reader, only: reader_type, time_list_type, open_card, complain, need_real, is_card
  use amontons_text, only: text_of
  implicit none
  private
  public :: read_time_points, find_time_points, times_in_step

  integer, parameter :: MOST_POINTS = 1000000     !< of one GENERATE line

contains

  !> Reads all TIME POINTS cards, wherever they stand.
  subroutine read_time_points(reader)
    type(reader_type), intent(inout) :: reader
    type(time_list_type) :: list
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: c, position, n_errors
    logical :: is_new
    allocate (reader%time_lists(0))
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'TIMEPOINTS')) cycle
      call open_card(reader, c, parameters, row)
      if (parameter_text(parameters, 'NAME') == '') cycle
      list%is_total_time = parameter_word(parameters, 'TIME', 'STEPTIME') == 'TOTALTIME'
      n_errors = reader%remarks%n_errors
      call read_times(reader, row, has_parameter(parameters, 'GENERATE'), list%times)
      associate (line => reader%cards%cards(c)%line)
        if (reader%remarks%n_errors == n_errors) then
          if (size(list%times) == 0) then
            call complain(reader, line, '*TIME POINTS needs a data line with times.')
          else if (any(list%times(2:) <= list%times(:size(list%times) - 1))) then
            call complain(reader, line, 'The times of *TIME POINTS must ascend.')
          end if
        end if
        call reader%time_names%add(parameter_text(parameters, 'NAME'), position, is_new)
        if (.not. is_new) call complain(reader, line, 'The time points ''' // parameter_text(parameters, 'NAME') // &
          ''' are defined twice.')
      end associate
      if (is_new) reader%time_lists = [reader%time_lists, list]
    end do
  end subroutine read_time_points


  !> The times in the rows of a card.
  subroutine read_times(reader, row, is_generated, times)
    type(reader_type), intent(inout) :: reader
    type(row_type), intent(inout) :: row
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
        call need_real(reader, row, i, 'time', of_row(i), is_ok)
      end do
      if (is_ok .and. is_generated) call generate_times(reader, row, of_row)
      if (is_ok) times = [times, of_row]
      deallocate (of_row)
    end do
  end subroutine read_times


  !> GENERATE: first time, last time, distance; the last time is always among them.
  subroutine generate_times(reader, row, times)
    type(reader_type), intent(inout) :: reader
    type(row_type), intent(in) :: row
    real(DP), allocatable, intent(inout) :: times(:)   !< in: the fields of the row; out: the times
    real(DP) :: first, last, distance
    integer :: i, n
    if (size(times) == 3) then
      first = times(1)
      last = times(2)
      distance = times(3)
      if (distance > 0 .and. last >= first .and. last - first <= distance * MOST_POINTS) then
        n = floor((last - first) / distance * (1 + 1.0e-9_DP))
        times = [(first + real(i, DP) * distance, i=0, n)]
        if (times(n + 1) < last - 1.0e-6_DP * distance) times = [times, last]
        return
      end if
    end if
    times = [real(DP) ::]
    call complain(reader, row%line, 'A line of *TIME POINTS, GENERATE must hold first time, last time and a positive ' // &
      'distance, for at most ' // text_of(MOST_POINTS) // ' times.')
  end subroutine generate_times


  !> The list that a card names by TIME POINTS; tells it if there is none.
  subroutine find_time_points(reader, c, name, list)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< card that names it
    character(*), intent(in) :: name
    integer, intent(out) :: list                 !< index into reader%time_lists; 0: none
    list = reader%time_names%find(name)
    if (list == 0 .and. name /= '') call complain(reader, reader%cards%cards(c)%line, 'There are no time points ''' // &
      name // '''; *TIME POINTS, NAME=' // name // ' defines them.')
  end subroutine find_time_points


  !> The times of a list that lie in a step; not allocated without a list.
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

end module amontons_deck_times
