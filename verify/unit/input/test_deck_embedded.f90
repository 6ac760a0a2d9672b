!> Unit test of amontons_deck_embedded: elements, hosts, tolerances, and rejected cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_embedded
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '11,.25,.5,.5;12,.75,.5,0;*ELEMENT,TYPE=C3D8,ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL,NAME=M;*ELASTIC;100.,.3;' // &
    '*SOLID SECTION,ELSET=E,MATERIAL=M;'
  character(*), parameter :: BAR = '*ELEMENT,TYPE=T3D2,ELSET=BAR;11,11,12;*SOLID SECTION,ELSET=BAR,MATERIAL=M;.1;'
  character(*), parameter :: STEP = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite

  call check_card()
  call check_rejected()
  call suite%finish()

contains

  !> Reads a deck; the text of the first error, '' without.
  subroutine read(cards, model, first_error)
    character(*), intent(in) :: cards
    type(model_type), intent(out) :: model
    character(:), allocatable, intent(out) :: first_error
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    integer :: i
    options%dialect = DIALECT_ABAQUS
    call read_deck_text(deck_lines(START // cards // STEP), options, model, diagnostics, error)
    first_error = ''
    do i = diagnostics%n_items, 1, -1
      if (.not. diagnostics%items(i)%is_warning) first_error = diagnostics%items(i)%text
    end do
  end subroutine read


  !> Elements, hosts and tolerances of a card.
  subroutine check_card()
    type(model_type) :: model
    character(:), allocatable :: text
    call read(BAR // '*EMBEDDED ELEMENT,HOST ELSET=E;BAR;', model, text)
    call suite%that('read: ' // text, text == '' .and. size(model%embeddings) == 1)
    associate (embedding => model%embeddings(1))
      call suite%that('elements and hosts', all(embedding%elements == [2]) .and. all(embedding%hosts == [1]))
      call suite%near('tolerances of Abaqus', embedding%exterior_tolerance, 0.05_DP, 0.0_DP)
      call suite%near('weights', embedding%roundoff_tolerance, 1.0e-6_DP, 0.0_DP)
    end associate
    call read(BAR // '*EMBEDDED ELEMENT,ABSOLUTE EXTERIOR TOLERANCE=.2,ROUNDOFF TOLERANCE=.1;11,;', model, text)
    associate (embedding => model%embeddings(1))
      call suite%that('all but the embedded ones', text == '' .and. all(embedding%hosts == [1]))
      call suite%near('a distance alone', embedding%absolute_tolerance, 0.2_DP, 0.0_DP)
      call suite%that('counts alone', embedding%exterior_tolerance > 1.0e100_DP)
      call suite%near('weights of the card', embedding%roundoff_tolerance, 0.1_DP, 0.0_DP)
    end associate
  end subroutine check_card


  !> Rejected cards.
  subroutine check_rejected()
    call bad(BAR // '*EMBEDDED ELEMENT,HOST ELSET=X;BAR;', 'no element set')
    call bad(BAR // '*EMBEDDED ELEMENT;E,BAR;', 'There is no host')
    call bad(BAR // '*EMBEDDED ELEMENT,HOST ELSET=E;', 'needs')
    call bad(BAR // '*EMBEDDED ELEMENT,EXTERIOR TOLERANCE=-1.;BAR;', 'must not be negative')
  end subroutine check_rejected


  !> A deck with an error whose text contains some words.
  subroutine bad(cards, words)
    character(*), intent(in) :: cards, words
    type(model_type) :: model
    character(:), allocatable :: text
    call read(cards, model, text)
    call suite%that(cards // ' is rejected: ' // text, index(text, words) > 0)
  end subroutine bad

end program test_deck_embedded
