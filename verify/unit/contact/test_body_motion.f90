!> Unit test of body_motion: displacements, rotations, amplitudes, velocities and forces of the steps, REACH, and the span of nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_body_motion
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use amontons_body_motion, only: estimate_motion, are_rotations_prescribed, displacement_span
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: CUBE = '*NODE;1,0,0,0;2,2,0,0;3,2,2,0;4,0,2,0;5,0,0,1;6,2,0,1;7,2,2,1;8,0,2,1;90,0,0,0;' // &
    '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL, NAME=A;*ELASTIC;4000., 0.3;*SOLID SECTION, ELSET=E, MATERIAL=A;' // &
    '*AMPLITUDE, NAME=TWICE;0.,0.,0.5,-2.,1.,1.;'
  character(*), parameter :: GENERAL = '*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;'
  character(*), parameter :: RIGID = '*RIGID BODY, ELSET=E, REF NODE=90;'
  real(DP), parameter :: EXTENT = 3.0_DP           !< of the cube: its diagonal
  real(DP), parameter :: TOL = 1.0e-12_DP          !< sums of a few terms
  type(suite_type) :: suite
  type(model_type) :: model
  call check_motion('without NLGEOM', '', '*BOUNDARY;1,1,1,5.;', 0.0_DP)
  call check_motion('displacements from one side', ', NLGEOM', '*BOUNDARY;1,1,1,5.;2,1,1,3.;', 5.0_DP)
  call check_motion('displacements from both sides', ', NLGEOM', '*BOUNDARY;1,1,1,-5.;2,1,1,3.;', 8.0_DP)
  call check_motion('a displacement across the axes', ', NLGEOM', '*BOUNDARY;1,1,1,-3.;2,2,2,4.;', 5.0_DP)
  call check_motion('an amplitude of both signs', ', NLGEOM', '*BOUNDARY, AMPLITUDE=TWICE;1,1,1,5.;', 15.0_DP)
  call check_motion('a velocity', ', NLGEOM', '*BOUNDARY, TYPE=VELOCITY;1,1,1,5.;', EXTENT)
  call check_motion('a rotation', ', NLGEOM', '*BOUNDARY;90,4,4,0.5;', 0.25_DP * EXTENT)
  call check_motion('a force', ', NLGEOM', '*CLOAD;1,1,7.;', 0.05_DP * EXTENT)
  call read_deck(RIGID // '*CONTACT, REACH=7.;*CONTACT INCLUSIONS, ALL EXTERIOR;', '', '')
  call suite%near('REACH', estimate_motion(model), 7.0_DP, TOL)
  call check_span()
  call suite%finish()

contains

  !> The way of a step with some loads.
  subroutine check_motion(name, parameters, loads, expected)
    character(*), intent(in) :: name, parameters, loads
    real(DP), intent(in) :: expected               !< [length]
    character(:), allocatable :: cards
    cards = GENERAL
    if (name == 'a rotation') cards = GENERAL // RIGID
    call read_deck(cards, parameters, loads)
    call suite%near(name, estimate_motion(model), expected, TOL)
    call suite%that(name // ' turns', are_rotations_prescribed(model) .eqv. name == 'a rotation')
  end subroutine check_motion


  !> A translation is no motion of nodes relative to each other; one node that moves is.
  subroutine check_span()
    real(DP) :: u(3, size(model%mesh%has_elements))
    u = 5.0_DP
    call suite%near('a translation', displacement_span(model, u), 0.0_DP, TOL)
    u(:, findloc(model%mesh%has_elements, .true., dim=1)) = [8.0_DP, 1.0_DP, 5.0_DP]
    call suite%near('a node', displacement_span(model, u), 5.0_DP, TOL)
  end subroutine check_span


  !> Reads the cube with model cards and the loads of a step.
  subroutine read_deck(cards, parameters, loads)
    character(*), intent(in) :: cards, parameters, loads
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    call read_deck_text(deck_lines(CUBE // cards // '*STEP' // parameters // ';*STATIC;' // loads // '*END STEP;'), options, &
      model, diagnostics, error)
    call suite%that('deck', .not. allocated(error))
  end subroutine read_deck

end program test_body_motion
