!> Unit test of amontons_model_check_unpaired: who meets whom, who is joined, and the cards.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_model_check_unpaired
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, job_options_type
  use amontons_deck, only: read_deck_text
  use amontons_model_check_unpaired, only: check_unpaired_bodies
  use amontons_text, only: to_text, NEWLINE
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none

  character(*), parameter :: STEP = '*STEP;*STATIC;*BOUNDARY;1,1,3;*END STEP;'
  type(suite_type) :: suite
  type(diagnostic_list_type) :: report
  call check_distances()
  call check_joined()
  call check_cards()
  call check_many()
  call suite%finish()

contains

  !> Bodies that touch, overlap, nearly meet, or do not; faces side by side; the far sides of thin sheets.
  subroutine check_distances()
    call run(blocks(0.0_DP) // STEP)
    call suite%that('touching', report%n_warnings == 1 .and. has('LOW (element 1) and UP (element 2) touch'))
    call run(blocks(-0.1_DP) // STEP)
    call suite%that('overlapping', report%n_warnings == 1)
    call run(blocks(0.03_DP) // STEP)
    call suite%that('nearly touching', report%n_warnings == 1)
    call run(blocks(0.5_DP) // STEP)
    call suite%that('apart', report%n_items == 0)
    call run(block('LOW', 1, [0.0_DP, 0.0_DP, 0.0_DP]) // block('UP', 2, [2.0_DP, 2.0_DP, 0.0_DP]) // STEP)
    call suite%that('diagonal', report%n_items == 0)
  end subroutine check_distances


  !> Pairs, ties, equations, springs, a common reference node, general contact.
  subroutine check_joined()
    character(*), parameter :: LAW = '*SURFACE INTERACTION, NAME=A;'
    call run(blocks(0.0_DP) // LAW // '*CONTACT PAIR, INTERACTION=A;UP_S, LOW_S;' // STEP)
    call suite%that('paired', report%n_items == 0)
    call run(blocks(0.0_DP) // '*TIE, NAME=T;UP_S, LOW_S;' // STEP)
    call suite%that('tied', report%n_items == 0)
    call run(blocks(0.0_DP) // '*EQUATION;2;9,3,1.,5,3,-1.;' // STEP)
    call suite%that('equation', report%n_items == 0)
    call run(blocks(0.0_DP) // '*ELEMENT, TYPE=SPRINGA, ELSET=SP;90,5,9;*SPRING, ELSET=SP;;10.;' // STEP)
    call suite%that('spring', report%n_items == 0)
    call run(blocks(0.0_DP) // '*NODE;99,0,0,9;*EQUATION;2;9,3,1.,99,3,-1.;*EQUATION;2;5,3,1.,99,3,-1.;' // STEP)
    call suite%that('by a node without a body', report%n_items == 0)
    call run(blocks(0.0_DP) // '*NODE;98,0,0,9;99,0,0,9;*EQUATION;2;9,3,1.,99,3,-1.;*EQUATION;2;5,3,1.,98,3,-1.;' // STEP)
    call suite%that('by two nodes', report%n_warnings == 1)
    call run(blocks(0.0_DP) // '*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;' // STEP)
    call suite%that('general contact', report%n_items == 0)
    call run(blocks(0.0_DP) // block('THIRD', 3, [0.0_DP, 0.0_DP, 2.0_DP]) // LAW // &
      '*CONTACT PAIR, INTERACTION=A;UP_S, LOW_S;' // STEP)
    call suite%that('another pair of bodies', report%n_warnings == 1 .and. has('THIRD'))
  end subroutine check_joined


  !> Surfaces and interaction of the deck, else new ones; bodies without a set.
  subroutine check_cards()
    call run(blocks(0.0_DP) // '*SURFACE INTERACTION, NAME=RUBBING;' // STEP)
    call suite%that('surfaces of the deck', has('INTERACTION=RUBBING, TYPE=SURFACE TO SURFACE' // NEWLINE // 'LOW_S, UP_S'))
    call suite%that('no new interaction', .not. has('*SURFACE INTERACTION'))
    call run(block('UP', 2, [0.0_DP, 0.0_DP, 1.0_DP]) // block('', 1, [0.0_DP, 0.0_DP, 0.0_DP]) // STEP)
    call suite%that('interaction', has('*SURFACE INTERACTION, NAME=TOUCH'))
    call suite%that('which', report%n_warnings == 1)
    call suite%that('faces', has('*ELSET, ELSET=UP_S1' // NEWLINE // '2' // NEWLINE // '*SURFACE, NAME=UP_FACES' // NEWLINE // &
      'UP_S1, S1' // NEWLINE // '*ELSET, ELSET=BODY2_S2' // NEWLINE // '1'))
    call suite%that('the pair', has(NEWLINE // 'UP_FACES, BODY2_FACES'))
  end subroutine check_cards


  !> A tower: the first pairs by name, the rest as a number.
  subroutine check_many()
    character(:), allocatable :: deck
    integer :: i
    deck = ''
    do i = 1, 9
      deck = deck // block('B' // to_text(i), i, [0.0_DP, 0.0_DP, real(i, DP)])
    end do
    call run(deck // STEP)
    call suite%that('eight pairs of bodies', report%n_warnings == 6 .and. has('3 more pairs of bodies'))
  end subroutine check_many


  !> Two unit cubes one above the other, with surfaces on both sides of the gap.
  function blocks(gap) result(text)
    real(DP), intent(in) :: gap
    character(:), allocatable :: text
    text = block('LOW', 1, [0.0_DP, 0.0_DP, 0.0_DP]) // block('UP', 2, [0.0_DP, 0.0_DP, 1.0_DP + gap]) // &
      '*SURFACE, NAME=LOW_S;1, S2;*SURFACE, NAME=UP_S;2, S1;'
  end function blocks


  !> A unit cube as element i with a material; without a name it has no set.
  function block(name, i, corner) result(text)
    character(*), intent(in) :: name
    integer, intent(in) :: i
    real(DP), intent(in) :: corner(3)
    character(:), allocatable :: text
    integer, parameter :: OFFSET(3, 8) = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8])
    real(DP) :: x(3)
    integer :: k
    text = '*NODE;'
    do k = 1, 8
      x = corner + real(OFFSET(:, k), DP)
      text = text // to_text(8 * i - 8 + k) // ',' // to_text(x(1)) // ',' // to_text(x(2)) // ',' // to_text(x(3)) // ';'
    end do
    text = text // '*ELEMENT, TYPE=C3D8'
    if (name /= '') text = text // ', ELSET=' // name
    text = text // ';' // to_text(i)
    do k = 1, 8
      text = text // ',' // to_text(8 * i - 8 + k)
    end do
    text = text // ';*MATERIAL, NAME=M' // to_text(i) // ';*ELASTIC;100.,0.;'
    if (name == '') text = text // '*ELSET, ELSET=ALL;1,2;*SOLID SECTION, ELSET=ALL, MATERIAL=M' // to_text(i) // ';'
    if (name /= '') text = text // '*SOLID SECTION, ELSET=' // name // ', MATERIAL=M' // to_text(i) // ';'
  end function block


  !> Whether some warning has these words.
  logical function has(words)
    character(*), intent(in) :: words
    integer :: i
    has = any([(index(report%items(i)%text, words) > 0, i=1, report%n_items)])
  end function has


  !> Reads a deck, whose lines end with semicolons, and checks it.
  subroutine run(cards)
    character(*), intent(in) :: cards
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    integer :: i
    report = diagnostic_list_type()
    call read_deck_text(deck_lines(cards), options, model, diagnostics, error)
    do i = 1, diagnostics%n_items
      call suite%that(diagnostics%items(i)%text, diagnostics%items(i)%is_warning)
    end do
    if (.not. allocated(error)) call check_unpaired_bodies(model, report)
  end subroutine run

end program test_model_check_unpaired
