!> Unit test of deck_restart: the joined deck of an old job and a new one, the state it starts from, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_restart
  use amontons_cards, only: cards_type, deck_messages_type, open_cards_text, line_text
  use amontons_deck_restart, only: join_decks
  use amontons_errors, only: error_type, EXIT_USAGE, EXIT_IO
  use amontons_kinds, only: DP, I64
  use amontons_model, only: job_options_type, restart_origin_type, DIALECT_CALCULIX
  use amontons_restart_file, only: restart_file_type, state_key_type, create_restart_file, append_restart_state
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: OLD = '*NODE;1,0,0,0;*STEP;*STATIC;*CLOAD;1,1,5.;*END STEP;*STEP;*STATIC;*CLOAD;1,1,6.;*END STEP;' // &
    '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: NEW_STEP = '*STEP;*STATIC;*CLOAD;1,1,9.;*END STEP;'
  type(suite_type) :: suite
  call write_old_job('old.res')
  call check_join()
  call check_states()
  call check_paths()
  call check_errors()
  call remove('old.res')
  call suite%finish()

contains

  !> The restart file of a job with states in its first two steps; the second is not complete.
  subroutine write_old_job(path)
    character(*), intent(in) :: path
    type(restart_file_type) :: file
    type(error_type), allocatable :: error
    integer(I64), parameter :: WORDS(3) = [1_I64, 2_I64, 3_I64]
    call create_restart_file(file, path, deck_lines(OLD), DIALECT_CALCULIX, error)
    call append_restart_state(file, state_key_type(step=1, increment=3, is_step_done=.true., step_time=1.0_DP, total_time=1.0_DP), &
      WORDS, .false., error)
    call append_restart_state(file, state_key_type(step=2, increment=1, step_time=0.25_DP, total_time=1.25_DP), WORDS, .false., &
      error)
    call suite%that('the old job', .not. allocated(error))
  end subroutine write_old_job


  !> Deletes a file.
  subroutine remove(path)
    character(*), intent(in) :: path
    integer :: unit
    open (newunit=unit, file=path)
    close (unit, status='delete')
  end subroutine remove


  !> Joins a deck with that of the old job.
  subroutine join(text, cards, messages, origin, error, old_job)
    character(*), intent(in) :: text
    type(cards_type), intent(out) :: cards
    type(deck_messages_type), intent(out) :: messages
    type(restart_origin_type), intent(out) :: origin
    type(error_type), allocatable, intent(out) :: error
    character(*), intent(in), optional :: old_job    !< default 'old'; empty: not named
    type(job_options_type) :: options
    options%old_job = 'old'
    if (present(old_job)) options%old_job = old_job
    if (options%old_job == '') deallocate (options%old_job)
    call open_cards_text(deck_lines(text), 'new.inp', cards, messages)
    call join_decks(cards, messages, options, origin, error)
  end subroutine join


  !> All lines of a deck, ended by semicolons.
  function deck_text(cards) result(text)
    type(cards_type), intent(in) :: cards
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, cards%n_lines
      text = text // line_text(cards, i) // ';'
    end do
  end function deck_text


  !> Old model, new sets, old steps up to the state, new steps; the heading of the new deck is a comment; lines know their file.
  subroutine check_join()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(restart_origin_type) :: origin
    type(error_type), allocatable :: error
    call join('*HEADING;Again;*RESTART, READ;*NSET, NSET=N;1;' // NEW_STEP, cards, messages, origin, error)
    call suite%that('joined', .not. allocated(error) .and. messages%n == 0)
    call suite%that('the text: ' // deck_text(cards), deck_text(cards) == '*NODE;1,0,0,0;** *HEADING;** Again;*RESTART, READ;' // &
      '*NSET, NSET=N;1;*STEP;*STATIC;*CLOAD;1,1,5.;*END STEP;*STEP;*STATIC;*CLOAD;1,1,6.;*END STEP;' // NEW_STEP)
    call suite%that('cards are found again', cards%n_cards == 15)
    call suite%that('origin', origin%path == 'old.res' .and. origin%dialect == DIALECT_CALCULIX .and. origin%label%step == 2 .and. &
      origin%label%increment == 1 .and. .not. origin%is_step_ended)
    call suite%that('files', size(cards%files) == 2 .and. cards%files(1)%path == 'old.res' .and. cards%files(2)%path == 'new.inp')
    call suite%that('lines of files', cards%line_file(2) == 1 .and. cards%line_number(2) == 2 .and. cards%line_file(3) == 2 .and. &
      cards%line_number(3) == 1 .and. cards%line_file(cards%n_lines) == 2)
  end subroutine check_join


  !> STEP and INC choose the state; END STEP ends its step, if it is not complete.
  subroutine check_states()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(restart_origin_type) :: origin
    type(error_type), allocatable :: error
    call join('*RESTART, READ, STEP=1;' // NEW_STEP, cards, messages, origin, error)
    call suite%that('after step 1', deck_text(cards) == '*NODE;1,0,0,0;*RESTART, READ, STEP=1;*STEP;*STATIC;*CLOAD;1,1,5.;' // &
      '*END STEP;' // NEW_STEP .and. origin%label%increment == 3)
    call join('*RESTART, READ, STEP=2, INC=1, END STEP;' // NEW_STEP, cards, messages, origin, error)
    call suite%that('step 2 ends there', origin%is_step_ended .and. abs(origin%label%step_time - 0.25_DP) <= 0)
    call join('*RESTART, READ, STEP=1, END STEP;' // NEW_STEP, cards, messages, origin, error)
    call suite%that('step 1 was complete', .not. origin%is_step_ended)
    call join('*NODE;1,0,0,0;' // NEW_STEP, cards, messages, origin, error, old_job='')
    call suite%that('a deck of its own', .not. allocated(error) .and. .not. allocated(origin%path) .and. cards%n_cards == 5)
  end subroutine check_states


  !> The old job with and without its ending; without a name job.rin beside the deck.
  subroutine check_paths()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(restart_origin_type) :: origin
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    call join('*RESTART, READ;' // NEW_STEP, cards, messages, origin, error, old_job='old.inp')
    call suite%that('.inp', .not. allocated(error))
    call join('*RESTART, READ;' // NEW_STEP, cards, messages, origin, error, old_job='old.res')
    call suite%that('.res', .not. allocated(error))
    options%deck = 'somewhere/new.inp'
    options%job = 'new'
    call open_cards_text(deck_lines('*RESTART, READ;' // NEW_STEP), 'new.inp', cards, messages)
    call join_decks(cards, messages, options, origin, error)
    call suite%that('beside the deck', origin%path == 'somewhere/new.rin' .and. allocated(error))
    if (allocated(error)) call suite%that('which is not there', error%code == EXIT_IO)
  end subroutine check_paths


  !> No RESTART, READ; no such state; cards that change the model; an amplitude of the user.
  subroutine check_errors()
    type(cards_type) :: cards
    type(deck_messages_type) :: messages
    type(restart_origin_type) :: origin
    type(error_type), allocatable :: error
    call join(NEW_STEP // '*RESTART, READ;', cards, messages, origin, error)
    call suite%that('an old job without a card before the steps', allocated(error))
    if (allocated(error)) call suite%that('is wrong use', error%code == EXIT_USAGE)
    call join('*RESTART, READ, STEP=3;' // NEW_STEP, cards, messages, origin, error)
    call suite%that('no such step', allocated(error))
    call join('*RESTART, READ;*NODE;2,1,1,1;' // NEW_STEP, cards, messages, origin, error)
    call expect(cards, messages, 'NODE is not allowed before the steps')
    call join('*RESTART, READ;*AMPLITUDE, NAME=U, DEFINITION=USER;' // NEW_STEP, cards, messages, origin, error)
    call expect(cards, messages, 'must be in the deck of the old job')
    call join('*RESTART, READ;*AMPLITUDE, NAME=U;0.,1.;' // NEW_STEP, cards, messages, origin, error)
    call suite%that('a table is allowed', messages%n == 0)
  end subroutine check_errors


  !> A join gave one error, at the line of the card in the joined deck.
  subroutine expect(cards, messages, piece)
    type(cards_type), intent(in) :: cards
    type(deck_messages_type), intent(in) :: messages
    character(*), intent(in) :: piece
    character(:), allocatable :: text
    logical :: is_warning
    integer :: line
    call suite%that('one error', messages%n == 1 .and. messages%n_errors == 1)
    if (messages%n == 0) return
    call messages%get(1, line, is_warning, text)
    call suite%that('it says: ' // text, index(text, piece) > 0)
    call suite%that('at its line', cards%line_file(line) == 2 .and. cards%line_number(line) == 2)
  end subroutine expect

end program test_deck_restart
