!> Unit test of job_estimate: counts and costs of two known decks, what is chosen and why, and the errors of a deck.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_job_estimate
  use check, only: suite_type
  use samples, only: deck_lines
  use amontons_errors, only: error_type, EXIT_DECK
  use amontons_job_estimate, only: estimate_job, job_estimate_type, describe_estimate
  use amontons_kinds, only: DP
  use amontons_logger, only: logger_type
  use amontons_model, only: job_options_type
  use amontons_text, only: NEWLINE
  implicit none
  type(suite_type) :: suite

  call check_factor()
  call check_iteration()
  call check_contact()
  call check_errors()
  call suite%finish()

contains

  include 'sample_cube.inc'

  !> The estimate of a deck of lines that end with semicolons.
  subroutine estimate_deck(deck, estimate, error)
    character(*), intent(in) :: deck
    type(job_estimate_type), intent(out) :: estimate
    type(error_type), allocatable, intent(out) :: error
    type(logger_type) :: logger                    ! never opened: quiet
    type(job_options_type) :: options
    options%deck_text = deck_lines(deck)
    options%n_threads = 1
    call estimate_job(options, logger, estimate, error)
  end subroutine estimate_deck


  !> A piece of a deck replaced.
  pure function changed(deck, old, new) result(text)
    character(*), intent(in) :: deck, old, new
    character(:), allocatable :: text
    integer :: at
    at = index(deck, old)
    text = deck(:at - 1) // new // deck(at + len(old):)
  end function changed


  !> The cube: of its 24 unknowns 4 are held at the bottom, 4 at the top, 4 left, 4 in front. The factor of the 8 that are free, 4
  !! in x and 4 in y, coupled by nu = 0 through shear alone, has no more than 36 entries.
  subroutine check_factor()
    type(job_estimate_type) :: estimate
    type(error_type), allocatable :: error
    character(:), allocatable :: text
    call estimate_deck(cube_deck(), estimate, error)
    call suite%that('no error', .not. allocated(error))
    call suite%that('counts', all([estimate%n_nodes, estimate%n_elements, estimate%n_unknowns, estimate%n_free] == [8, 1, 24, 8]))
    call suite%that('increments of the first step', estimate%n_increments == 4 .and. estimate%is_linear)
    call suite%that('no contact', estimate%n_slaves == 0 .and. estimate%n_interface == 0)
    call suite%that('entries', estimate%cost%factor_entries >= 8.0_DP .and. estimate%cost%factor_entries <= 36.0_DP)
    call suite%that('operations of a factor', estimate%cost%factor_operations >= estimate%cost%factor_entries .and. &
      estimate%cost%factor_operations <= 204.0_DP)                       ! sum of k^2 for k = 1 to 8
    call suite%that('a factor', .not. estimate%is_iterative .and. estimate%speed > 0.0_DP .and. estimate%megabytes > 0.0_DP)
    text = describe_estimate(estimate, 'cube.inp')
    call suite%that('words', index(text, '24, of them 8 free; 8 nodes, 1 element') > 0 .and. &
      index(text, 'choice        factor') > 0)
  end subroutine check_factor


  !> SOLVER=ITERATIVE is taken, and the reason is reported.
  subroutine check_iteration()
    type(job_estimate_type) :: estimate
    type(error_type), allocatable :: error
    call estimate_deck(changed(cube_deck(), '*STATIC', '*STATIC, SOLVER=ITERATIVE SCALING'), estimate, error)
    call suite%that('iteration', .not. allocated(error) .and. estimate%is_iterative)
    call suite%that('its reason', index(describe_estimate(estimate, 'cube.inp'), 'iteration, as SOLVER requests') > 0)
    call suite%that('its cost', estimate%cost%iteration_operations > 0.0_DP .and. estimate%cost%iteration_megabytes > 0.0_DP)
    call estimate_deck(changed(cube_deck(), '*STATIC', '*STATIC, SOLVER=CONJUGATE GRADIENTS'), estimate, error)
    call suite%that('no matrix', .not. (allocated(error) .or. estimate%has_matrix))
  end subroutine check_iteration


  !> A second cube on the first: four slave nodes, and the interface holds the free unknowns of both faces.
  subroutine check_contact()
    type(job_estimate_type) :: estimate
    type(error_type), allocatable :: error
    character(:), allocatable :: deck
    deck = changed(cube_deck(), '*SOLID SECTION', '*NODE, NSET=UPPER' // NEWLINE // '11,.2,.2,1.' // NEWLINE // '12,.8,.2,1.' // &
      NEWLINE // '13,.8,.8,1.' // NEWLINE // '14,.2,.8,1.' // NEWLINE // '15,.2,.2,2.' // NEWLINE // '16,.8,.2,2.' // NEWLINE // &
      '17,.8,.8,2.' // NEWLINE // '18,.2,.8,2.' // NEWLINE // '*ELEMENT, TYPE=C3D8, ELSET=CUBE' // NEWLINE // &
      '12,11,12,13,14,15,16,17,18' // NEWLINE // '*SURFACE, NAME=SLAVE' // NEWLINE // '12, S1' // NEWLINE // &
      '*SURFACE, NAME=MASTER' // NEWLINE // '11, S2' // NEWLINE // '*SURFACE INTERACTION, NAME=I' // NEWLINE // &
      '*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE' // NEWLINE // 'SLAVE, MASTER' // NEWLINE // '*SOLID SECTION')
    deck = changed(deck, 'TOP,3,3,0.01', '15,1,3,-.01' // NEWLINE // '16,1,3,-.01' // NEWLINE // '17,1,3,-.01' // NEWLINE // &
      '18,1,3,-.01')
    call estimate_deck(deck, estimate, error)
    call suite%that('contact', .not. allocated(error) .and. estimate%n_slaves == 4 .and. .not. estimate%is_linear)
    call suite%that('interface of two faces', estimate%n_interface == 20)   ! four of 24 are held
    call suite%that('factor of the bulk', estimate%cost%factor_entries > 24.0_DP)
    call suite%that('words of contact', index(describe_estimate(estimate, 'two.inp'), '4 slave nodes, interface of 20') > 0)
  end subroutine check_contact


  !> Errors of the deck are those of a job.
  subroutine check_errors()
    type(job_estimate_type) :: estimate
    type(error_type), allocatable :: error
    call estimate_deck(changed(cube_deck(), '*STATIC', '*STATIK'), estimate, error)
    call suite%that('deck', allocated(error))
    if (allocated(error)) call suite%that('exit code', error%code == EXIT_DECK)
  end subroutine check_errors

end program test_job_estimate
