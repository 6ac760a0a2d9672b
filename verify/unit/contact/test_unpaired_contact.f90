!> Unit test of unpaired_contact: faces of one body that met without a pair; two bodies that did, with and without a pair.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_unpaired_contact
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_unpaired_contact, only: model_faces_type, find_unpaired_contact, find_unpaired_self_contact
  use check, only: suite_type
  use samples, only: deck_lines, horseshoe, last_step, two_squares
  implicit none
  character(*), parameter :: GENERAL = '*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;'
  type(suite_type) :: suite
  call look_at_arms(0.3_DP, 0.0_DP, .false.)
  call look_at_arms(1.6_DP, 0.0_DP, .true.)
  call look_at_arms(1.3_DP, 0.3_DP, .true.)
  call look_at_arms(1.3_DP, 0.1_DP, .false.)
  call look_at_blocks('', .true.)
  call look_at_blocks('*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I;S_UP, S_LOW;', .false.)
  call suite%finish()

contains

  !> Arms with a slot of 1.5 and no pair, the upper one moved down by a way, the last part of it in this increment.
  subroutine look_at_arms(way, last, is_found)
    real(DP), intent(in) :: way, last            !< [length]
    logical, intent(in) :: is_found              !< they met, or will in the next increment
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    type(model_faces_type) :: faces
    character(:), allocatable :: message
    real(DP) :: u(3, 12), du(3, 12)
    integer :: turn
    call read_deck_text(deck_lines(horseshoe(1.5_DP) // GENERAL // last_step('')), options, model, diagnostics, error)
    call suite%that('deck', .not. allocated(error))
    u = 0
    du = 0
    u(2, [8, 9, 11, 12]) = -way
    du(2, [8, 9, 11, 12]) = -last
    do turn = 1, 2                               ! the faces are built in the first turn and serve in the second
      call find_unpaired_self_contact(model, faces, u, du, 1, message)
      call suite%that('arms that met without a pair', is_found .eqv. index(message, 'of the same body') > 0)
    end do
    call suite%that('built if something moved by half an element', allocated(faces%is_uncounted) .eqv. way > 0.5_DP)
  end subroutine look_at_arms


  !> Two squares one above the other, the upper one moved down onto the lower one, from beyond what was searched at the start.
  subroutine look_at_blocks(pair, is_found)
    character(*), intent(in) :: pair             !< cards of a pair
    logical, intent(in) :: is_found
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    type(model_faces_type) :: faces
    character(:), allocatable :: message
    real(DP) :: u(3, 8)
    integer :: i
    call read_deck_text(two_squares(9.0_DP, GENERAL // pair), options, model, diagnostics, error)
    do i = 1, diagnostics%n_items
      call suite%that(diagnostics%items(i)%text, diagnostics%items(i)%is_warning)
    end do
    if (allocated(error)) return
    u = 0
    u(2, 5:8) = -8
    call find_unpaired_contact(model, faces, u, 0 * u, 1, message)
    call suite%that('blocks that met', is_found .eqv. index(message, 'there is no pair of them') > 0)
    call find_unpaired_contact(model, faces, 0 * u, 0 * u, 1, message)
    call suite%that('blocks at the start', message == '')
  end subroutine look_at_blocks

end program test_unpaired_contact
