!> Unit test of contact_checks: crossings that a shorter increment can avoid, and what ends the job.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_contact_checks
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_state, only: state_type
  use amontons_constraints, only: constraints_type
  use amontons_contact_pairs, only: contact_type
  use amontons_unpaired_contact, only: model_faces_type
  use amontons_contact_checks, only: find_contact_fault, find_avoidable_crossing
  use check, only: suite_type
  use samples, only: two_squares
  implicit none
  type(suite_type) :: suite
  call move_up('a long way into the other one', -2.3_DP, -2.3_DP, .true., is_avoidable=.true., is_fault=.true.)
  call move_up('the last bit of that way', -2.3_DP, -0.01_DP, .true., is_avoidable=.false., is_fault=.true.)
  call move_up('contact does not follow', -2.3_DP, -2.3_DP, .false., is_avoidable=.false., is_fault=.true.)
  call move_up('not yet there', -1.9_DP, -1.9_DP, .true., is_avoidable=.false., is_fault=.false.)
  call suite%finish()

contains

  !> A square two above another one, moved down; du: within the last increment.
  subroutine move_up(title, way, du, is_nlgeom, is_avoidable, is_fault)
    character(*), intent(in) :: title
    real(DP), intent(in) :: way, du              !< [length]
    logical, intent(in) :: is_nlgeom, is_avoidable, is_fault
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    type(model_faces_type) :: faces
    type(state_type) :: state
    type(contact_type) :: contact
    type(constraints_type) :: base
    character(:), allocatable :: message
    call read_deck_text(two_squares(3.0_DP, '*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I;S_UP, S_LOW;'), options, &
      model, diagnostics, error)
    call suite%that(title // ': deck', .not. allocated(error))
    if (allocated(error)) return
    model%steps%is_nlgeom = is_nlgeom
    allocate (state%new%u(3, 8), state%old%u(3, 8), state%new%v(3, 8), source=0.0_DP)
    allocate (state%new%slaves(0))
    state%new%u(2, 5:8) = way
    state%old%u(2, 5:8) = way - du
    state%new%v = state%new%u - state%old%u
    state%new%time_increment = 1.0_DP
    call find_avoidable_crossing(model, faces, state, 1, message)
    call suite%that(title // ': avoidable', is_avoidable .eqv. index(message, 'passed through element') > 0)
    call suite%that(title // ': known to be free', faces%is_free_of_crossings .eqv. (is_nlgeom .and. .not. is_fault))
    call find_contact_fault(model, contact, base, faces, state%new, 1, message)
    call suite%that(title // ': fault', is_fault .eqv. index(message, 'passed through element') > 0)
    call suite%that(title // ': looked for again', .not. faces%is_free_of_crossings)
  end subroutine move_up

end program test_contact_checks
