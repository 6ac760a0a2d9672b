!> Unit test of balanced_bodies: which bodies are held, by as many degrees of freedom as they have free motions, and which are not.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_balanced_bodies
  use amontons_balanced_bodies, only: balancing_support_type, find_balancing_supports
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: CUBE = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;9,5,5,5;' // &
    '*ELEMENT, TYPE=C3D8, ELSET=CUBE;1,1,2,3,4,5,6,7,8;*MATERIAL, NAME=M;*ELASTIC;1000.,0.3;*EXPANSION;1E-5;' // &
    '*SOLID SECTION, ELSET=CUBE, MATERIAL=M;'
  character(*), parameter :: SHEET = '*NODE;21,9,0,0;22,10,0,0;23,10,1,0;24,9,1,0;*ELEMENT, TYPE=S4, ELSET=SHEET;' // &
    '9,21,22,23,24;*SHELL SECTION, ELSET=SHEET, MATERIAL=M;0.1;'
  character(*), parameter :: SQUEEZE = '*DLOAD;1,P4,5.;1,P6,5.;'
  type(suite_type) :: suite
  type(balancing_support_type), allocatable :: supports(:)
  character(:), allocatable :: text
  call check_free()
  call check_partly_held()
  call check_refused()
  call suite%finish()

contains

  !> A cube under opposite pressures has six free motions; six degrees of freedom hold them in each step.
  subroutine check_free()
    call find('', SQUEEZE)
    call suite%that('six supports', size(supports) == 6 .and. all(supports%step == 1))
    call suite%that('no degree of freedom twice', are_different())
    call suite%that('reported', index(text, 'set CUBE') > 0 .and. index(text, '6 free rigid motions') > 0)
    call find('', SQUEEZE // '*END STEP;*STEP;*STATIC;')
    call suite%that('in both steps', size(supports) == 12 .and. count(supports%step == 2) == 6)
    call suite%that('reported once', index(text, 'balance each other', back=.true.) == index(text, 'balance each other'))
    call find('', '*CLOAD;1,1,-3.;2,1,3.;')
    call suite%that('forces on a line', size(supports) == 6)
    call find('', '*CLOAD;1,1,-3.;4,1,3.;1,2,-3.;2,2,3.;')
    call suite%that('couples that balance', size(supports) == 6)
    call find('', '*TEMPERATURE;1,50.;')
    call suite%that('temperature', size(supports) == 6)
  end subroutine check_free


  !> Of a cube on rollers only the motions along them are held; where the loads do work on no free motion it does not matter that
  !! they are not balanced otherwise.
  subroutine check_partly_held()
    call find('*NSET, NSET=FLOOR;1,2,3,4;*BOUNDARY;FLOOR,3,3;', '*DLOAD;1,P2,5.;')
    call suite%that('on rollers', size(supports) == 3 .and. all(supports%dof < 3))
    call find('*BOUNDARY;1,1,3;2,2,3;3,3,3;', '*DLOAD;1,P2,5.;')
    call suite%that('held well', size(supports) == 0 .and. text == '')
    call find('*NODE;10,6,5,5;*ELEMENT, TYPE=B31, ELSET=ROD;7,9,10;*BEAM SECTION, ELSET=ROD, MATERIAL=M, SECTION=RECT;' // &
      '.1,.2;0,0,1;*BOUNDARY;1,1,3;2,2,3;3,3,3;9,1,6;', '*CLOAD;10,2,-1.;')
    call suite%that('a beam whose clamp holds its rotation', size(supports) == 0)
    call find(SHEET // '*BOUNDARY;21,1,3;24,1,3;', '*CLOAD;22,1,5.;')
    call suite%that('a shell on a hinge', size(supports) == 1 .and. index(text, 'set SHEET') > 0)
    if (size(supports) == 1) call suite%that('by the mean of a fibre', supports(1)%director > 0 .and. supports(1)%dof == 3)
    call find(SHEET // '*BOUNDARY;21,1,3;24,1,3;', '*CLOAD;22,3,5.;')
    call suite%that('a shell that its load turns about the hinge', size(supports) == 0)
  end subroutine check_partly_held


  !> Loads that do work on a free motion, a body without loads, and a body with contact are left to the check of the model.
  subroutine check_refused()
    call find('', '*DLOAD;1,P4,5.;')
    call suite%that('a resultant force', size(supports) == 0)
    call find('', '*CLOAD;1,1,-3.;4,1,3.;')
    call suite%that('a resultant couple', size(supports) == 0)
    call find('*AMPLITUDE, NAME=A;0.,0.,1.,1.;*AMPLITUDE, NAME=B;0.,1.,1.,1.;', '*CLOAD, AMPLITUDE=A;1,1,-3.;*CLOAD, ' // &
      'AMPLITUDE=B;2,1,3.;')
    call suite%that('balanced at the end only', size(supports) == 0)
    call find('', '*CLOAD;9,1,1.;')
    call suite%that('no load on the body', size(supports) == 0)
    call find('*NODE;11,0,0,-1;12,1,0,-1;13,1,1,-1;14,0,1,-1;15,0,0,0;16,1,0,0;17,1,1,0;18,0,1,0;*ELEMENT, TYPE=C3D8, ' // &
      'ELSET=FOOT;2,11,12,13,14,15,16,17,18;*SOLID SECTION, ELSET=FOOT, MATERIAL=M;*SURFACE, NAME=UP;1,S1;*SURFACE, NAME=LOW;' // &
      '2,S2;*SURFACE INTERACTION, NAME=I;*CONTACT PAIR, INTERACTION=I;UP,LOW;*NSET, NSET=HELD;11,12,13,14;*BOUNDARY;HELD,1,3;', &
      SQUEEZE)
    call suite%that('with contact', size(supports) == 0)
  end subroutine check_refused


  !> Whether no degree of freedom is held twice in a step.
  logical function are_different()
    integer :: i
    are_different = all([(count(supports%node == supports(i)%node .and. supports%dof == supports(i)%dof .and. &
      supports%step == supports(i)%step) == 1, i=1, size(supports))])
  end function are_different


  !> Reads a deck of the cube and finds its supports.
  subroutine find(cards, loads)
    character(*), intent(in) :: cards              !< of the model
    character(*), intent(in) :: loads              !< of the step
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    call read_deck_text(deck_lines(CUBE // cards // '*STEP;*STATIC;' // loads // '*END STEP;'), options, model, diagnostics, error)
    call suite%that('deck: ' // loads, .not. allocated(error))
    call find_balancing_supports(model, supports, text)
  end subroutine find

end program test_balanced_bodies
