!> Unit test of self_contact_pairs: pairs of slots and bodies that fold.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_self_contact_pairs
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_surfaces, only: is_self_contact
  use amontons_general_contact, only: general_pairs_type
  use amontons_self_contact_pairs, only: add_self_pairs
  use check, only: suite_type
  use samples, only: deck_lines, horseshoe, last_step
  implicit none
  character(*), parameter :: GENERAL = '*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;'
  type(suite_type) :: suite
  type(general_pairs_type) :: found
  character(:), allocatable :: text
  call find(horseshoe(0.5_DP) // GENERAL // last_step(', NLGEOM'))
  call suite%that('one pair of one surface', size(found%pairs) == 1 .and. size(found%surfaces) == 1)
  call suite%that('slave and master', all(is_self_contact(found%pairs)) .and. all(found%pairs%is_general .and. &
    found%pairs%is_mortar))
  call suite%that('the faces of the slot and their neighbours', any(found%surfaces(1)%element == 1) .and. &
    any(found%surfaces(1)%element == 3))
  call suite%that('named', index(text, 'SHOE#SELF') > 0 .and. index(text, 'touches itself') > 0)
  call find(horseshoe(0.5_DP) // GENERAL // last_step(''))
  call suite%that('a slot narrower than an edge without NLGEOM', size(found%pairs) == 1)
  call find(horseshoe(1.5_DP) // GENERAL // last_step(''))
  call suite%that('nothing moves without NLGEOM', size(found%pairs) == 0)
  call find(horseshoe(5.0_DP) // GENERAL // last_step(', NLGEOM'))
  call suite%that('a wide slot', size(found%pairs) == 0)
  call find(horseshoe(0.5_DP) // GENERAL // '*CONTACT EXCLUSIONS;SHOE_S, SHOE_S;' // last_step(', NLGEOM'))
  call suite%that('left out by the deck', size(found%pairs) == 0)
  call find(horseshoe(0.5_DP) // last_step(', NLGEOM'))
  call suite%that('no general contact', size(found%pairs) == 0 .and. text == '')
  call find(horseshoe(0.5_DP) // '*SURFACE INTERACTION, NAME=SOFT;*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR;100.;' // &
    GENERAL // '*CONTACT PROPERTY ASSIGNMENT;,, SOFT;' // last_step(', NLGEOM'))
  call suite%that('a law that is not hard', size(found%pairs) == 0 .and. index(text, 'SOFT is not hard') > 0)
  call find(horseshoe(5.0_DP) // GENERAL(:8) // ', REACH=2.' // GENERAL(9:) // last_step(', NLGEOM'))
  call suite%that('a body that folds: all its faces', size(found%pairs) == 1)
  if (size(found%pairs) == 1) call suite%that('every exterior face', size(found%surfaces(1)%face) == 12)
  call find('*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;*ELEMENT, TYPE=S4, ELSET=E;1,1,2,3,4;*MATERIAL, NAME=A;*ELASTIC;4000., 0.3;' // &
    '*SHELL SECTION, ELSET=E, MATERIAL=A;0.2;' // GENERAL(:8) // ', REACH=2.' // GENERAL(9:) // &
    '*SURFACE PROPERTY ASSIGNMENT, PROPERTY=THICKNESS;, 0.5;*STEP, NLGEOM;*STATIC;*END STEP;')
  call suite%that('another thickness', size(found%pairs) == 0 .and. index(text, 'another thickness or place') > 0)
  call suite%finish()

contains

  !> Reads a deck and finds its pairs.
  subroutine find(cards)
    character(*), intent(in) :: cards
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    integer :: i
    call read_deck_text(deck_lines(cards), options, model, diagnostics, error)
    call suite%that('deck', .not. allocated(error))
    if (allocated(error)) then
      do i = 1, diagnostics%n_items
        call suite%that(diagnostics%items(i)%text, diagnostics%items(i)%is_warning)
      end do
      return
    end if
    found = general_pairs_type()
    allocate (found%pairs(0), found%surfaces(0))
    text = ''
    call add_self_pairs(model, found, text)
  end subroutine find

end program test_self_contact_pairs
