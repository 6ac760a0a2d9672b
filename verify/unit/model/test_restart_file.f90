!> Unit test of amontons_restart_file: records, overlay, search, cuts and damage.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_restart_file
  use amontons_errors, only: error_type, EXIT_IO
  use amontons_kinds, only: I64, DP
  use amontons_restart_file, only: restart_file_type, state_key_type, create_restart_file, reopen_restart_file, &
    append_restart_state, read_restart_deck, find_restart_state, read_restart_state
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  character(*), parameter :: PATH = 'test_restart_file.restart', DECK = '*HEADING' // new_line('a') // 'odd length'
  call check_states()
  call check_overlay()
  call check_errors()
  call suite%finish()

contains

  !> Keeps the state of an increment; its words identify it.
  subroutine keep(restart_file, step, increment, is_overlay)
    type(restart_file_type), intent(inout) :: restart_file
    integer, intent(in) :: step, increment
    logical, intent(in) :: is_overlay
    type(error_type), allocatable :: error
    integer(I64) :: i
    call append_restart_state(restart_file, state_key_type(step=step, increment=increment, step_time=0.5_DP, total_time=1.5_DP), &
      [(int(100 * step + increment, I64) * i, i=1_I64, 50_I64)], is_overlay, error)
    call suite%that('kept', .not. allocated(error))
  end subroutine keep


  !> Looks for a state and compares its words.
  subroutine expect(step, increment, found_step, found_increment)
    integer, intent(in) :: step, increment, found_step, found_increment
    type(state_key_type) :: label
    type(error_type), allocatable :: error
    integer(I64), allocatable :: words(:)
    call find_restart_state(PATH, step, increment, label, error)
    call suite%that('there', .not. allocated(error))
    if (allocated(error)) return
    call suite%that('the right one', label%step == found_step .and. label%increment == found_increment)
    call suite%that('its times', label%step_time == 0.5_DP .and. label%total_time == 1.5_DP)
    call read_restart_state(PATH, label, words, error)
    call suite%that('sound', .not. allocated(error))
    call suite%that('its words', size(words) == 50 .and. words(50) == 50_I64 * int(100 * found_step + found_increment, I64))
  end subroutine expect


  !> The deck to the last letter, states by number, the last of a step, the last of all.
  subroutine check_states()
    type(restart_file_type) :: restart_file
    type(error_type), allocatable :: error
    character(:), allocatable :: text
    integer :: dialect
    call create_restart_file(restart_file, PATH, DECK, 2, error)
    call suite%that('created', .not. allocated(error))
    call keep(restart_file, 1, 1, .false.)
    call keep(restart_file, 1, 2, .false.)
    call keep(restart_file, 2, 1, .false.)
    call read_restart_deck(PATH, text, dialect, error)
    call suite%that('the deck', text == DECK .and. len(text) == len(DECK) .and. dialect == 2)
    call expect(1, 1, 1, 1)
    call expect(1, 0, 1, 2)
    call expect(0, 0, 2, 1)
  end subroutine check_states


  !> OVERLAY keeps the last of each step; a file is cut back to what a checkpoint knew.
  subroutine check_overlay()
    type(restart_file_type) :: restart_file, other
    type(state_key_type) :: label
    type(error_type), allocatable :: error
    integer(I64) :: counts(3)
    call create_restart_file(restart_file, PATH, DECK, 1, error)
    call keep(restart_file, 1, 1, .true.)
    call keep(restart_file, 1, 2, .true.)
    call keep(restart_file, 2, 1, .true.)
    call expect(1, 0, 1, 2)
    call find_restart_state(PATH, 1, 1, label, error)
    call suite%that('gone', allocated(error))
    counts = [restart_file%last, restart_file%end, int(restart_file%step, I64)]
    call keep(restart_file, 2, 5, .false.)
    call reopen_restart_file(other, PATH, counts, error)
    call suite%that('reopened', .not. allocated(error))
    call expect(0, 0, 2, 1)
    call keep(other, 2, 2, .true.)
    call expect(2, 0, 2, 2)
  end subroutine check_overlay


  !> No such state, no such file, a flipped bit.
  subroutine check_errors()
    type(state_key_type) :: label
    type(error_type), allocatable :: error
    character(:), allocatable :: text
    integer(I64), allocatable :: words(:)
    integer(I64) :: n_bytes
    integer :: dialect, unit
    call find_restart_state(PATH, 7, 0, label, error)
    call suite%that('no such step', allocated(error))
    call read_restart_deck('no_such_file.restart', text, dialect, error)
    call suite%that('no such file', allocated(error))
    if (allocated(error)) call suite%that('by its code', error%code == EXIT_IO)
    call find_restart_state(PATH, 0, 0, label, error)
    inquire (file=PATH, size=n_bytes)
    open (newunit=unit, file=PATH, access='stream', form='unformatted', action='readwrite', status='old')
    write (unit, pos=n_bytes - 20) '!'
    close (unit)
    call read_restart_state(PATH, label, words, error)
    call suite%that('damaged', allocated(error))
    open (newunit=unit, file=PATH, status='old')
    close (unit, status='delete')
  end subroutine check_errors

end program test_restart_file
