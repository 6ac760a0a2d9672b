!> Unit test of deck_general_contact: inclusions, exclusions, assignments, roles, surface properties, and each refusal.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_general_contact
  use amontons_deck, only: read_deck_text
  use amontons_kinds, only: DP
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_surfaces, only: BEHAVIOR_HARD
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;11,0,0,1;' // &
    '12,1,0,1;13,1,1,1;14,0,1,1;15,0,0,2;16,1,0,2;17,1,1,2;18,0,1,2;*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;' // &
    '2,11,12,13,14,15,16,17,18;*MATERIAL, NAME=M;*ELASTIC;70000.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;' // &
    '*SURFACE, NAME=LOW;1,S2;*SURFACE, NAME=UP;2,S1;*NSET, NSET=N;11,12;*SURFACE, NAME=DOTS, TYPE=NODE;N;' // &
    '*SURFACE INTERACTION, NAME=DRY;*FRICTION;.2;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: GENERAL = '*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;'
  character(*), parameter :: INITIAL = '*CONTACT INITIALIZATION ASSIGNMENT;'
  character(*), parameter :: PROPERTY = '*CONTACT PROPERTY ASSIGNMENT;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_rules()
  call check_refusals()
  call suite%finish()

contains

  !> What the rules hold; without an assignment contact is exact and frictionless.
  subroutine check_rules()
    integer :: i
    call expect_read('')
    call suite%that('no general contact', .not. allocated(model%general_contact) .and. size(model%interactions) == 1)
    call expect_read(GENERAL)
    associate (rules => model%general_contact)
      call suite%that('the whole exterior', all(rules%included == reshape([0, 0], [2, 1])) .and. size(rules%excluded) == 0)
      call suite%that('one interaction by default', all(rules%assigned == reshape([0, 0, 2], [3, 1])))
      call suite%that('exact, frictionless', model%interactions(2)%behavior == BEHAVIOR_HARD .and. &
        .not. model%interactions(2)%friction > 0)
      call suite%that('surface to surface, no reach', rules%is_mortar .and. rules%reach < 0)
      call suite%that('its line', rules%line == 1 + count([(MODEL_PART(i:i) == ';', i=1, len(MODEL_PART))]))
    end associate
    call expect_read('*CONTACT;*CONTACT INCLUSIONS;UP, LOW;UP;,LOW;*CONTACT EXCLUSIONS;LOW, UP;' // PROPERTY // &
      ',,DRY;UP,LOW,DRY;' // '*CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES;UP, LOW, SLAVE;UP, LOW, MASTER;' // &
      '*SURFACE PROPERTY ASSIGNMENT, PROPERTY=THICKNESS;, ORIGINAL, 0.5;UP, 0.;')
    associate (rules => model%general_contact)
      call suite%that('pairs, one alone, one with all', all(rules%included == reshape([2, 1, 2, 2, 0, 1], [2, 3])))
      call suite%that('excluded', all(rules%excluded == reshape([1, 2], [2, 1])))
      call suite%that('assigned', all(rules%assigned(:, 2:) == reshape([0, 0, 1, 2, 1, 1], [3, 2])))
      call suite%that('no initialization', size(rules%initialized) == 0)
      call suite%that('roles: slave, master', all(rules%roles == reshape([2, 1, 1, 2], [2, 2])))
    end associate
    call expect_read('*CONTACT INITIALIZATION DATA, NAME=Fit, INTERFERENCE FIT;*CONTACT INITIALIZATION DATA, NAME=MOVE, ' // &
      'SEARCH ABOVE=0.5, SEARCH BELOW=0.25;*CONTACT INITIALIZATION DATA, NAME=ALL;' // GENERAL // INITIAL // ',,ALL;UP,LOW,FIT;')
    associate (rules => model%general_contact)
      call suite%that('initialized', all(rules%initialized == reshape([0, 0, 3, 2, 1, 1], [3, 2])))
      call suite%that('a fit', all(rules%initial%is_fit .eqv. [.true., .false., .false.]))
      call suite%near('moved from above', sum(abs(rules%initial(2:)%above - [0.5_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
      call suite%that('and below', rules%initial(2)%below < 0.26_DP .and. rules%initial(3)%below >= huge(1.0_DP))
    end associate
  end subroutine check_rules


  !> Each refusal.
  subroutine check_refusals()
    call expect_message('*CONTACT;', 'says nothing without *CONTACT INCLUSIONS')
    call expect_message('*CONTACT;*CONTACT INCLUSIONS;', 'needs ALL EXTERIOR, or data lines')
    call expect_message('*CONTACT INCLUSIONS, ALL EXTERIOR;', 'must be in the block of a *CONTACT')
    call expect_message(GENERAL // 'UP, LOW;', 'takes no data lines')
    call expect_message(GENERAL // '*CONTACT EXCLUSIONS;', '*CONTACT EXCLUSIONS needs data lines')
    call expect_message(GENERAL // '*CONTACT EXCLUSIONS;UPP, LOW;', 'There is no surface ''UPP''')
    call expect_message(GENERAL // '*CONTACT EXCLUSIONS;DOTS, LOW;', 'general contact needs element faces')
    call expect_message(GENERAL // PROPERTY, 'needs data lines: surface, surface, interaction')
    call expect_message(GENERAL // PROPERTY // ',,WET;', 'There is no surface interaction ''WET''')
    call expect_message(GENERAL // '*CONTACT FORMULATION, TYPE=MASTER SLAVE ROLES;UP, LOW, BALANCED;', 'SLAVE or MASTER')
    call expect_message(GENERAL // '*CONTACT FORMULATION, TYPE=EDGE TO EDGE;', 'write MASTER SLAVE ROLES')
    call expect_message(GENERAL // '*SURFACE PROPERTY ASSIGNMENT, PROPERTY=THICKNESS;UP, 0.5;', 'have no thickness')
    call expect_message(GENERAL // '*SURFACE PROPERTY ASSIGNMENT, PROPERTY=OFFSET FRACTION;UP, 0.5;', 'lie where the mesh is')
    call expect_message(GENERAL // INITIAL, 'needs data lines: surface, surface, initialization')
    call expect_message(GENERAL // INITIAL // ',,FIT;', 'There is no *CONTACT INITIALIZATION DATA, NAME=FIT')
    call expect_message('*CONTACT INITIALIZATION DATA, NAME=A, SEARCH ABOVE=-1.;' // GENERAL, 'SEARCH ABOVE must be a distance')
    call expect_message('*CONTACT INITIALIZATION DATA, NAME=A, INTERFERENCE FIT, SEARCH BELOW=1.;' // GENERAL, 'nothing is moved')
    call expect_message('*CONTACT INITIALIZATION DATA, NAME=A, INITIAL CLEARANCE=1.;' // GENERAL, 'with a *CLEARANCE')
    call expect_message('*CONTACT, REACH=-1.;*CONTACT INCLUSIONS, ALL EXTERIOR;', 'REACH must be a distance')
    call expect_message('*CONTACT, TYPE=MORTAR;*CONTACT INCLUSIONS, ALL EXTERIOR;', 'MORTAR')
    call expect_message('*CONTACT, OP=NEW;*CONTACT INCLUSIONS, ALL EXTERIOR;', 'holds for all steps')
  end subroutine check_refusals


  !> Reads a deck of the two blocks with further cards.
  subroutine read_with(cards, diagnostics, error)
    character(*), intent(in) :: cards
    type(diagnostic_list_type), intent(out) :: diagnostics
    type(error_type), allocatable, intent(out) :: error
    type(job_options_type) :: options
    call read_deck_text(deck_lines(MODEL_PART // cards // STEP_PART), options, model, diagnostics, error)
  end subroutine read_with


  !> The deck is read without errors.
  subroutine expect_read(cards)
    character(*), intent(in) :: cards
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    call read_with(cards, diagnostics, error)
    call suite%that('read: ' // cards, .not. allocated(error))
  end subroutine expect_read


  !> The deck is refused with a sentence that has a piece of text.
  subroutine expect_message(cards, piece)
    character(*), intent(in) :: cards, piece
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    logical :: is_found
    call read_with(cards, diagnostics, error)
    is_found = .false.
    do i = 1, diagnostics%n_items
      is_found = is_found .or. (index(diagnostics%items(i)%text, piece) > 0 .and. .not. diagnostics%items(i)%is_warning)
    end do
    call suite%that('refused: ' // piece, allocated(error) .and. is_found)
  end subroutine expect_message

end program test_deck_general_contact
