!> Joins a deck with RESTART, READ to the deck of the old job.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The restart file holds the whole deck of the old job. The deck of the new job consists of the old model, the new deck's cards
!! before its steps (sets, amplitudes), the old steps up to the restart and the new steps, in this order: the result
!! is that of one deck with all steps.
module amontons_deck_restart
  use amontons_restart_file, only: read_restart_deck, find_restart_state
  use amontons_cards, only: cards_type, deck_messages_type, parameter_type, read_parameters, start_deck_text, append_line, &
    find_cards, &
    line_text
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_errors, only: error_type, set_error, EXIT_USAGE
  use amontons_kinds, only: I64
  use amontons_model, only: job_options_type, restart_origin_type
  use amontons_text, only: parse_integer, is_one_of, NUMBER_OK, NEWLINE
  implicit none
  private
  public :: join_decks, folder_name

  ! before new steps
  character(*), parameter :: CARDS_BEFORE_STEPS = 'HEADING|RESTART|AMPLITUDE|NSET|ELSET|SURFACE|TIMEPOINTS|PREPRINT'

contains

  !> If the deck has *RESTART, READ: the joined deck, and the state of the restart.
  !!
  !! Errors: EXIT_USAGE (an old job is named for a deck without RESTART, READ), EXIT_IO (no such file or state, damaged).
  subroutine join_decks(cards, messages, options, origin, error)
    type(cards_type), intent(inout) :: cards
    type(deck_messages_type), intent(inout) :: messages
    type(job_options_type), intent(in) :: options
    type(restart_origin_type), intent(out) :: origin       !< its path stays empty if the deck reads no restart file
    type(error_type), allocatable, intent(out) :: error
    type(cards_type) :: old, joined
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: text
    integer :: c, step, increment, line
    c = find_restart_read(cards)
    if (c == 0) then
      if (allocated(options%old_job)) call set_error(error, EXIT_USAGE, 'The old job ' // options%old_job // &
        ' is named, but the deck has no *RESTART, READ before its steps.')
      return
    end if
    call read_parameters(cards, cards%cards(c), parameters)
    origin%path = restart_path(options)
    call read_restart_deck(origin%path, text, origin%dialect, error)
    if (allocated(error)) return
    step = parameter_integer(parameters, 'STEP')
    increment = parameter_integer(parameters, 'INC')
    call find_restart_state(origin%path, step, increment, origin%label, error)
    if (allocated(error)) return
    origin%is_step_ended = has_parameter(parameters, 'ENDSTEP') .and. .not. origin%label%is_step_done
    call read_lines(text, old)
    call start_deck_text(joined)
    call join_file_lists(cards, origin%path, joined)
    call copy_lines(old, 1, card_line(old, 'STEP', 1, old%n_lines + 1) - 1, 0, joined)
    line = card_line(cards, 'STEP', 1, cards%n_lines + 1)
    call copy_model(cards, line - 1, joined, messages)
    call copy_lines(old, card_line(old, 'STEP', 1, old%n_lines + 1), &
      card_line(old, 'ENDSTEP', origin%label%step, old%n_lines), 0, joined)
    call copy_lines(cards, line, cards%n_lines, 1, joined)
    call find_cards(joined, cards%known_parameters)
    cards = joined
  end subroutine join_decks


  !> The card *RESTART, READ before the steps; 0: none.
  integer function find_restart_read(cards) result(c)
    type(cards_type), intent(in) :: cards
    type(parameter_type), allocatable :: parameters(:)
    do c = 1, cards%n_cards
      if (cards%cards(c)%key == 'STEP') exit
      if (cards%cards(c)%key /= 'RESTART') cycle
      call read_parameters(cards, cards%cards(c), parameters)
      if (has_parameter(parameters, 'READ')) return
    end do
    c = 0
  end function find_restart_read


  !> The restart file: that of the old job if one is named, else job.rin beside the deck, as with CalculiX.
  function restart_path(options) result(path)
    type(job_options_type), intent(in) :: options
    character(:), allocatable :: path
    integer :: last
    if (.not. allocated(options%old_job)) then
      path = 'job.rin'
      if (allocated(options%job)) path = options%job // '.rin'
      if (allocated(options%deck)) path = folder_name(options%deck) // path
      return
    end if
    path = options%old_job
    last = len(path)
    if (last > 4) then
      if (any(path(last - 3:) == ['.inp', '.res'])) path = path(:last - 4)
    end if
    path = path // '.res'
  end function restart_path


  !> The folder of a path with its slash; empty: no folder.
  pure function folder_name(path) result(folder)
    character(*), intent(in) :: path
    character(:), allocatable :: folder
    folder = path(:index(path, '/', back=.true.))
  end function folder_name


  !> An integer parameter; 0 if absent or invalid (the check of the cards reports that).
  integer function parameter_integer(parameters, key) result(number)
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: key
    integer :: status
    number = 0
    if (.not. has_parameter(parameters, key)) return
    call parse_integer(parameter_text(parameters, key), number, status)
    if (status /= NUMBER_OK) number = 0
  end function parameter_integer


  !> The lines and cards of a text; its includes are already in place.
  subroutine read_lines(text, cards)
    character(*), intent(in) :: text
    type(cards_type), intent(out) :: cards
    integer(I64) :: first, last
    integer :: number
    call start_deck_text(cards)
    first = 1
    number = 0
    do while (first <= len(text, I64))
      last = first
      do while (text(last:last) /= NEWLINE)
        last = last + 1
        if (last > len(text, I64)) exit
      end do
      number = number + 1
      call append_line(cards, text(first:last - 1), 1, number)
      first = last + 1
    end do
    call find_cards(cards)
  end subroutine read_lines


  !> The files of the joined deck: the restart file, then those of the new deck.
  subroutine join_file_lists(cards, path, joined)
    type(cards_type), intent(in) :: cards
    character(*), intent(in) :: path
    type(cards_type), intent(inout) :: joined
    integer :: f
    deallocate (joined%files)
    allocate (joined%files(size(cards%files) + 1))
    joined%files(1)%path = path
    do f = 1, size(cards%files)
      joined%files(f + 1) = cards%files(f)
      if (cards%files(f)%parent > 0) joined%files(f + 1)%parent = cards%files(f)%parent + 1
    end do
  end subroutine join_file_lists


  !> Line of the i-th card of a keyword; `none` if there are fewer.
  pure integer function card_line(cards, key, i, none) result(line)
    type(cards_type), intent(in) :: cards
    character(*), intent(in) :: key                !< squeezed
    integer, intent(in) :: i
    integer, intent(in) :: none
    integer :: c, n
    n = 0
    do c = 1, cards%n_cards
      if (cards%cards(c)%key == key) n = n + 1
      line = cards%cards(c)%line
      if (n == i) return
    end do
    line = none
  end function card_line


  !> Copies lines unchanged.
  subroutine copy_lines(from, first, last, shift, to)
    type(cards_type), intent(in) :: from
    integer, intent(in) :: first, last             !< lines
    integer, intent(in) :: shift                   !< from the indices of files there to those here
    type(cards_type), intent(inout) :: to
    integer :: i
    do i = first, last
      call append_line(to, line_text(from, i), from%line_file(i) + shift, from%line_number(i))
    end do
  end subroutine copy_lines


  !> Copies the part before the new steps: heading and stray text become comments; cards that change the model are reported.
  subroutine copy_model(cards, last, joined, messages)
    type(cards_type), intent(in) :: cards
    integer, intent(in) :: last                    !< line before the first new step
    type(cards_type), intent(inout) :: joined
    type(deck_messages_type), intent(inout) :: messages
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: comment
    integer :: i, c
    c = 0
    comment = '** '
    do i = 1, last
      if (c < cards%n_cards) then
        if (cards%cards(c + 1)%line == i) then
          c = c + 1
          comment = ''
          if (cards%cards(c)%key == 'HEADING') comment = '** '
          if (.not. is_one_of(cards%cards(c)%key, CARDS_BEFORE_STEPS)) call messages%add(joined%n_lines + 1, 'The card *' // &
            cards%cards(c)%key // ' is not allowed before the steps of a deck that continues from a restart file: the model ' // &
            'comes from that file.')
          call read_parameters(cards, cards%cards(c), parameters)
          if (cards%cards(c)%key == 'AMPLITUDE' .and. parameter_text(parameters, 'DEFINITION') == 'USER') &
            call messages%add(joined%n_lines + 1, 'An amplitude of the user must be in the deck of the old job: its ' // &
            'variables are in the restart file.')
        end if
      end if
      call append_line(joined, comment // line_text(cards, i), cards%line_file(i) + 1, cards%line_number(i))
    end do
  end subroutine copy_model

end module amontons_deck_restart
