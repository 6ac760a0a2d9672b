!> Model set-up: equations and coordinates of ties and moves of ADJUST are returned; only the set-up changes the model.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_model_setup
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_deck, only: read_deck_text
  use amontons_loads, only: equation_type
  use amontons_logger, only: logger_type
  use amontons_model, only: model_type, job_options_type
  use amontons_contact_initialization, only: find_adjustment
  use amontons_model_setup, only: set_up_model
  use amontons_tie_generation, only: generate_ties
  use check, only: suite_type
  implicit none
  character(*), parameter :: NL = new_line('a')
  real(DP), parameter :: GAP = 0.01_DP             !< between the two cubes [length]
  character(*), parameter :: CUBES = '*NODE' // NL // '1, 0, 0, 0' // NL // '2, 1, 0, 0' // NL // '3, 1, 1, 0' // NL // &
    '4, 0, 1, 0' // NL // '5, 0, 0, 1' // NL // '6, 1, 0, 1' // NL // '7, 1, 1, 1' // NL // '8, 0, 1, 1' // NL // &
    '11, .2, .2, 1.01' // NL // '12, .8, .2, 1.01' // NL // '13, .8, .8, 1.01' // NL // '14, .2, .8, 1.01' // NL // &
    '15, .2, .2, 2' // NL // '16, .8, .2, 2' // NL // '17, .8, .8, 2' // NL // '18, .2, .8, 2' // NL // &
    '*ELEMENT, TYPE=C3D8, ELSET=E' // NL // '1, 1, 2, 3, 4, 5, 6, 7, 8' // NL // '2, 11, 12, 13, 14, 15, 16, 17, 18' // NL // &
    '*SURFACE, NAME=M' // NL // '1, S2' // NL // '*SURFACE, NAME=S' // NL // '2, S1' // NL // '*MATERIAL, NAME=A' // NL // &
    '*ELASTIC' // NL // '1000., 0.3' // NL // '*SOLID SECTION, ELSET=E, MATERIAL=A' // NL
  character(*), parameter :: TIED = '*TIE, NAME=T, POSITION TOLERANCE=0.1, ADJUST=YES' // NL // 'S, M' // NL
  character(*), parameter :: PAIR = '*SURFACE INTERACTION, NAME=I' // NL // '*CONTACT PAIR, INTERACTION=I, ADJUST=0.05' // NL // &
    'S, M' // NL
  character(*), parameter :: STEPS = '*STEP' // NL // '*STATIC' // NL // '*BOUNDARY' // NL // '1, 1, 3' // NL // '2, 1, 3' // &
    NL // '3, 1, 3' // NL // '4, 1, 3' // NL // '*END STEP' // NL
  type(suite_type) :: suite
  call check_ties()
  call check_adjustment()
  call suite%finish()

contains

  !> The model of a deck.
  subroutine read_model(deck, options, model)
    character(*), intent(in) :: deck
    type(job_options_type), intent(out) :: options
    type(model_type), intent(out) :: model
    type(diagnostic_list_type) :: complaints
    type(error_type), allocatable :: error
    options%job = 'unit'
    options%deck = 'unit.inp'
    call read_deck_text(deck, options, model, complaints, error)
    call suite%that('the deck is read', .not. allocated(error))
  end subroutine read_model


  !> Four slave nodes with three equations each; the weights of each sum to zero.
  subroutine check_ties()
    type(model_type) :: model
    type(job_options_type) :: options
    type(logger_type) :: logger
    type(error_type), allocatable :: error
    type(equation_type), allocatable :: equations(:)
    character(:), allocatable :: warnings
    real(DP), allocatable :: coordinates(:, :)
    integer :: i
    call read_model(CUBES // TIED // STEPS, options, model)
    call generate_ties(model, equations, coordinates, warnings, error)
    call suite%that('ties: no error', .not. allocated(error))
    call suite%that('ties: three equations for each of four nodes', size(equations) == 12)
    call suite%near('ties: weights', maxval([(abs(sum(equations(i)%coefficient)), i=1, size(equations))]), 0.0_DP, 1.0e-14_DP)
    call suite%near('ties: the nodes are on the master', maxval(abs(coordinates(3, 9:12) - 1.0_DP)), 0.0_DP, 1.0e-14_DP)
    call suite%that('ties: the others are where they were', all(coordinates(:, :8) == model%mesh%coordinates(:, :8)))
    call suite%near('ties: the model is as it was', minval(model%mesh%coordinates(3, 9:12)), 1.0_DP + GAP, 1.0e-14_DP)
    call suite%that('ties: it has no equations', size(model%equations) == 0)
    call set_up_model(model, options, logger, error)
    call suite%that('set-up: it has them now', .not. allocated(error) .and. size(model%equations) == 12)
    call suite%that('set-up: and the coordinates', all(model%mesh%coordinates == coordinates))
  end subroutine check_ties


  !> Slave nodes within the distance move along the normal onto their master.
  subroutine check_adjustment()
    type(model_type) :: model
    type(job_options_type) :: options
    type(logger_type) :: logger
    type(error_type), allocatable :: error
    real(DP), allocatable :: way(:, :), before(:, :)
    call read_model(CUBES // PAIR // STEPS, options, model)
    before = model%mesh%coordinates
    allocate (way(3, model%mesh%n_nodes))
    call find_adjustment(model, way, error)
    call suite%that('adjust: no error', .not. allocated(error))
    call suite%near('adjust: down by the gap', maxval(abs(way(3, 9:12) + GAP)), 0.0_DP, 1.0e-12_DP)
    call suite%near('adjust: not sideways', maxval(abs(way(:2, :))), 0.0_DP, 1.0e-14_DP)
    call suite%near('adjust: no other node', maxval(abs(way(:, :8))) + maxval(abs(way(:, 13:))), 0.0_DP, 0.0_DP)
    call suite%that('adjust: the model is as it was', all(model%mesh%coordinates == before))
    call set_up_model(model, options, logger, error)
    call suite%that('set-up: no error', .not. allocated(error))
    call suite%near('set-up: the nodes are moved', maxval(abs(model%mesh%coordinates - before - way)), 0.0_DP, 1.0e-15_DP)
  end subroutine check_adjustment

end program test_model_setup
