!> Unit test of amontons_deck_named_nodes: nodes of shells that cards turn, hold or constrain.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_named_nodes
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: START = '*NODE,NSET=ALL;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,2,0,0;6,2,1,0;7,3,0,0;8,3,1,0;9,3,0,1;' // &
    '*ELEMENT,TYPE=S4,ELSET=E;1,1,2,3,4;2,2,5,6,3;3,5,7,8,6;*ELEMENT,TYPE=SPRINGA,ELSET=S;11,7,9;*SPRING,ELSET=S;;1.;' // &
    '*MATERIAL,NAME=M;*ELASTIC;100.,.3;*SHELL SECTION,ELSET=E,MATERIAL=M;.1;'
  character(*), parameter :: STEP = '*BOUNDARY;1,ENCASTRE;4,1,3;9,1,3;*STEP;*STATIC;*CLOAD;3,5,1.;*END STEP;'
  type(suite_type) :: suite

  call check_rotations()
  call check_constrained()
  call suite%finish()

contains

  !> Reads a deck without errors.
  subroutine read(cards, dialect, model)
    character(*), intent(in) :: cards
    integer, intent(in) :: dialect
    type(model_type), intent(out) :: model
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    options%dialect = dialect
    call read_deck_text(deck_lines(START // cards // STEP), options, model, diagnostics, error)
    call suite%that('read: ' // cards, .not. allocated(error))
  end subroutine read


  !> Supports, moments and equations of rotations.
  subroutine check_rotations()
    type(model_type) :: model
    call read('*EQUATION;2;5,5,1.,6,5,-1.;', DIALECT_ABAQUS, model)
    associate (structure => model%structure)
      call suite%that('turned nodes', all(structure%is_turned(:8) .eqv. [.true., .false., .true., .false., .true., .true., &
        .false., .false.]))
      call suite%that('a moment drives about its axis', all(structure%is_driven(:, 3) .eqv. [.false., .true., .false.]))
      call suite%that('held from the first step', all(structure%held_from(:, 1) == 1))
      call suite%that('displacements alone', all(structure%held_from(:, 4) == [1, 1, 1, 0, 0, 0]))
      call suite%that('rotations of the equation', all(structure%rotation_terms == reshape([1, 5, 2, 1, 6, 2], [3, 2])))
      call suite%that('abaqus: the mean of the fibre', .not. any(structure%is_constrained))
    end associate
  end subroutine check_rotations


  !> Rigid bodies, equations, surfaces of nodes, springs.
  subroutine check_constrained()
    type(model_type) :: model
    call read('*NSET,NSET=TWO;2,;*NODE;21,5,0,0;*RIGID BODY,NSET=TWO,REF NODE=21;*EQUATION;2;3,1,1.,6,2,-1.;' // &
      '*SURFACE,NAME=N,TYPE=NODE;8,1;', DIALECT_CALCULIX, model)
    associate (is_constrained => model%structure%is_constrained)
      call suite%that('a rigid body', all(is_constrained(:, 2)))
      call suite%that('directions of an equation', all(is_constrained(:, 3) .eqv. [.true., .false., .false.]) .and. &
        all(is_constrained(:, 6) .eqv. [.false., .true., .false.]))
      call suite%that('a surface of nodes, its area is no node', all(is_constrained(:, 8)) .and. .not. any(is_constrained(:, 1)))
      call suite%that('a spring', all(is_constrained(:, 7)))
      call suite%that('others', .not. any(is_constrained(:, [1, 4, 5])))
    end associate
  end subroutine check_constrained

end program test_deck_named_nodes
