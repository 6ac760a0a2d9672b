!> Unit test of unpaired_crossing: bodies that passed through each other, by their edges or on their paths.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_unpaired_crossing
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_unpaired_contact, only: model_faces_type
  use amontons_unpaired_crossing, only: find_unpaired_crossing
  use amontons_state, only: slave_state_type, STATUS_SLIP
  use check, only: suite_type
  use samples, only: two_squares
  implicit none
  character(*), parameter :: GENERAL = '*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;'
  character(*), parameter :: PAIR = '*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I;S_UP, S_LOW;'
  type(suite_type) :: suite
  call move_up('not yet there', 3.0_DP, [0.0_DP, -1.9_DP], .false., GENERAL)
  call move_up('it touches', 3.0_DP, [0.0_DP, -2.0_DP], .false., GENERAL)
  call move_up('into the other one', 3.0_DP, [0.0_DP, -2.3_DP], .true., GENERAL)
  call move_up('into the other one, excluded', 3.0_DP, [0.0_DP, -2.3_DP], .false., GENERAL // '*CONTACT EXCLUSIONS;S_UP, S_LOW;')
  call move_up('right through', 3.0_DP, [0.0_DP, -9.0_DP], .true., GENERAL)
  call move_up('past it', 3.0_DP, [30.0_DP, -9.0_DP], .false., GENERAL)
  call move_up('they cross at the start', 0.5_DP, [0.0_DP, -0.3_DP], .false., GENERAL)
  call move_up('without contact', 3.0_DP, [0.0_DP, -2.3_DP], .false., '')
  call move_up('a pair by hand', 3.0_DP, [0.0_DP, -2.3_DP], .true., PAIR)
  call move_up('a pair by hand beside general contact', 3.0_DP, [0.0_DP, -2.3_DP], .true., PAIR // GENERAL)
  call move_up('they touch', 3.0_DP, [0.0_DP, -2.3_DP], .false., PAIR, &
    slave_state_type(pair=1, node=6, status=STATUS_SLIP, gap=-0.3_DP))
  call move_up('they touch, not so deep', 3.0_DP, [0.0_DP, -2.3_DP], .true., PAIR, &
    slave_state_type(pair=1, node=6, status=STATUS_SLIP))
  call move_up('an overclosure is allowed', 3.0_DP, [0.0_DP, -2.3_DP], .false., PAIR, &
    slave_state_type(pair=1, node=5, offset=0.5_DP))
  call suite%finish()

contains

  !> A square two above another one that is twice as wide, moved in one increment.
  subroutine move_up(title, height, way, is_found, cards, slave)
    character(*), intent(in) :: title
    real(DP), intent(in) :: height               !< of the upper square at the start [length]
    real(DP), intent(in) :: way(2)               !< [length]
    logical, intent(in) :: is_found
    character(*), intent(in) :: cards
    type(slave_state_type), intent(in), optional :: slave
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    type(model_faces_type) :: faces
    character(:), allocatable :: message
    type(slave_state_type), allocatable :: slaves(:)
    real(DP) :: u(3, 8)
    integer :: turn
    call read_deck_text(two_squares(height, cards), options, model, diagnostics, error)
    call suite%that(title // ': deck', .not. allocated(error))
    if (allocated(error)) return
    allocate (slaves(0))
    if (present(slave)) slaves = [slave]
    u = 0
    u(1, 5:8) = way(1)
    u(2, 5:8) = way(2)
    do turn = 1, 2                               ! a crossing is found again: the attempt may be repeated
      call find_unpaired_crossing(model, faces, slaves, u, u, 1, message)
      call suite%that(title, is_found .eqv. index(message, 'passed through element') > 0)
    end do
  end subroutine move_up

end program test_unpaired_crossing
