!> Unit test of dependent_slaves: which pairs get a penalty, how large it is, and what it keeps of the law.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_dependent_slaves
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_surfaces, only: interaction_type, BEHAVIOR_LINEAR
  use amontons_text, only: NEWLINE
  use amontons_dependent_slaves, only: find_penalties, penalty_law
  use check, only: suite_type
  implicit none
  character(*), parameter :: PAIR = '*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I;S, M;'
  character(*), parameter :: RUBBING = '*SURFACE INTERACTION, NAME=I;*FRICTION;0.3;*CONTACT PAIR, INTERACTION=I;S, M;'
  character(*), parameter :: NORMAL = '*EQUATION;2;11, 3, 1., 12, 3, -1.;'
  character(*), parameter :: TANGENT = '*EQUATION;2;11, 1, 1., 12, 1, -1.;'
  character(*), parameter :: RIGID = '*NODE;90, 0.5, 0.5, 2.;*RIGID BODY, ELSET=UP, REF NODE=90;'
  type(suite_type) :: suite
  real(DP), allocatable :: stiffness(:)
  character(:), allocatable :: text
  call check_dependent_nodes()
  call check_free_nodes()
  call check_law()
  call suite%finish()

contains

  !> Equations along the normal, across it with friction, rigid bodies: K = 100 E/a, E of the softer body that deforms, a the
  !! shorter mean edge.
  subroutine check_dependent_nodes()
    call find(PAIR // NORMAL)
    call suite%near('softer body, finer mesh', stiffness(1), 100 * 1000.0_DP / 0.5_DP, 1.0e-9_DP)
    call suite%that('the node is named', index(text, 'pair S / M') > 0 .and. index(text, '1 slave node (11)') > 0)
    call find(RUBBING // TANGENT)
    call suite%that('friction on a dependent tangent', stiffness(1) > 0.0_DP)
    call find(PAIR // RIGID)
    call suite%near('the body that deforms', stiffness(1), 100 * 4000.0_DP / 0.5_DP, 1.0e-9_DP)
    call suite%that('all nodes', index(text, '4 slave nodes (11, ...)') > 0)
    call find('*SURFACE, NAME=N, TYPE=NODE;11,;*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I;N, M;' // TANGENT)
    call suite%near('surface of nodes, whose normal is unknown', stiffness(1), 100 * 4000.0_DP, 1.0e-9_DP)
  end subroutine check_dependent_nodes


  !> What leaves contact exact: no equation, one across the normal without friction, on the master, a law, a tie.
  subroutine check_free_nodes()
    call find(PAIR)
    call suite%that('no equation', .not. stiffness(1) > 0.0_DP .and. text == '')
    call find(PAIR // TANGENT)
    call suite%that('across the normal, without friction', .not. stiffness(1) > 0.0_DP)
    call find(PAIR // '*EQUATION;2;5, 3, 1., 6, 3, -1.;')
    call suite%that('on the master', .not. stiffness(1) > 0.0_DP)
    call find(PAIR // '*EQUATION;2;12, 3, 1., 16, 3, -1.;*EQUATION;2;15, 3, 1., 11, 3, -1.;')
    call suite%that('the retained node is free, the other not', stiffness(1) > 0.0_DP .and. index(text, '1 slave node (12)') > 0)
    call find('*SURFACE INTERACTION, NAME=I;*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR;10.;*CONTACT PAIR, INTERACTION=I;' // &
      'S, M;' // NORMAL)
    call suite%that('a law of the deck', .not. stiffness(1) > 0.0_DP .and. text == '')
  end subroutine check_free_nodes


  !> The penalty keeps friction and name.
  subroutine check_law()
    type(interaction_type) :: law, penalty
    law%name = 'I'
    law%friction = 0.3_DP
    penalty = penalty_law(law, 50.0_DP)
    call suite%that('linear', penalty%behavior == BEHAVIOR_LINEAR .and. penalty%name == 'I')
    call suite%near('numbers', norm2([penalty%stiffness, penalty%stick_slope, penalty%friction, penalty%tension_limit] - &
      [50.0_DP, 50.0_DP, 0.3_DP, 0.0_DP]), 0.0_DP, 1.0e-12_DP)
  end subroutine check_law


  !> The penalties of a cube (E = 1000, edge 0.5 in the plane) on another (E = 4000, edge 1) with cards.
  subroutine find(cards)
    character(*), intent(in) :: cards
    character(*), parameter :: CUBES = '*NODE;1, 0, 0, 0;2, 1, 0, 0;3, 1, 1, 0;4, 0, 1, 0;5, 0, 0, 1;6, 1, 0, 1;7, 1, 1, 1;' // &
      '8, 0, 1, 1;11, .2, .2, 1;12, .7, .2, 1;13, .7, .7, 1;14, .2, .7, 1;15, .2, .2, 2;16, .7, .2, 2;17, .7, .7, 2;' // &
      '18, .2, .7, 2;*ELEMENT, TYPE=C3D8, ELSET=LOW;1, 1, 2, 3, 4, 5, 6, 7, 8;*ELEMENT, TYPE=C3D8, ELSET=UP;' // &
      '2, 11, 12, 13, 14, 15, 16, 17, 18;*SURFACE, NAME=M;1, S2;*SURFACE, NAME=S;2, S1;*MATERIAL, NAME=A;*ELASTIC;4000., 0.3;' // &
      '*MATERIAL, NAME=B;*ELASTIC;1000., 0.3;*SOLID SECTION, ELSET=LOW, MATERIAL=A;*SOLID SECTION, ELSET=UP, MATERIAL=B;'
    character(*), parameter :: STEPS = '*STEP;*STATIC;*BOUNDARY;1, 1, 3;2, 1, 3;3, 1, 3;4, 1, 3;*END STEP;'
    type(model_type) :: model
    type(job_options_type) :: options
    type(diagnostic_list_type) :: complaints
    type(error_type), allocatable :: error
    character(:), allocatable :: deck
    integer :: i
    options%job = 'unit'
    options%deck = 'unit.inp'
    deck = CUBES // cards // STEPS
    do i = 1, len(deck)
      if (deck(i:i) == ';') deck(i:i) = NEWLINE
    end do
    call read_deck_text(deck, options, model, complaints, error)
    call suite%that('the deck is read', .not. allocated(error))
    call find_penalties(model, stiffness, text)
  end subroutine find

end program test_dependent_slaves
