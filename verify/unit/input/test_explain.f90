!> Unit test of explain: status, parameters, defaults and data of each card, messages at their place, and the numbers taken.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_explain
  use amontons_deck, only: explain_deck
  use amontons_errors, only: error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_text, only: NEWLINE
  use check, only: suite_type
  implicit none
  character(*), parameter :: MESH = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;' // &
    '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;'
  character(*), parameter :: MATERIAL = '*MATERIAL, NAME=Steel;*ELASTIC;210.,.25;*DENSITY;7.5;*SOLID SECTION, ELSET=E, ' // &
    'MATERIAL=Steel;'
  character(*), parameter :: STEP = '*STEP, NLGEOM;*STATIC;.25,2.;*BOUNDARY;1,1,3;*DLOAD;1,P1,1.;1,BX,1.;*END STEP;'
  character(:), allocatable :: text
  type(suite_type) :: suite
  call check_cards()
  call check_numbers()
  call check_laws()
  call check_messages()
  call suite%finish()

contains

  !> Explains a deck whose lines end with a semicolon.
  subroutine explain(deck, dialect, has_error)
    character(*), intent(in) :: deck
    integer, intent(in) :: dialect
    logical, intent(in) :: has_error
    type(job_options_type) :: options
    type(model_type) :: model
    type(error_type), allocatable :: error
    integer :: unit, i, first
    open (newunit=unit, file='explain.inp', status='replace', action='write')
    first = 1
    do i = 1, len(deck)
      if (deck(i:i) /= ';') cycle
      write (unit, '(a)') deck(first:i - 1)
      first = i + 1
    end do
    close (unit)
    options%deck = 'explain.inp'
    options%dialect = dialect
    call explain_deck(options, model, text, error)
    call suite%that('verdict', allocated(error) .eqv. has_error)
    open (newunit=unit, file='explain.inp')
    close (unit, status='delete')
  end subroutine explain


  !> The text has a piece, which begins after another one.
  subroutine expect(piece, after)
    character(*), intent(in) :: piece
    character(*), intent(in), optional :: after
    integer :: first
    first = 1
    if (present(after)) first = index(text, after)
    call suite%that('"' // piece // '"', first > 0 .and. index(text(max(1, first):), piece) > 0)
  end subroutine expect


  !> Cards with their place, parameters, defaults and data.
  subroutine check_cards()
    call explain(MESH // MATERIAL // '*PREPRINT, ECHO=YES;*NSET, NSET=N;1;*BOUNDARY;1,1;2,1;3,1;4,1;5,1;' // STEP, &
      DIALECT_ABAQUS, .false.)
    call expect('Deck explain.inp, read in the abaqus dialect.')
    call expect('explain.inp:1: *NODE: used' // NEWLINE // '    by default: SYSTEM=R' // NEWLINE // '    8 data lines')
    call expect('explain.inp:10: *ELEMENT: used' // NEWLINE // '    TYPE=C3D8: used. Kind of element')
    call expect('    dialects differ: ', after='*ELEMENT: used')
    call expect('*PREPRINT: ignored. ')
    call expect('    data: 210.,.25', after='*ELASTIC: used')
    call expect('by default: TYPE=ISOTROPIC')
    call suite%that('a default that is given is not reported again', index(text, 'by default: NLGEOM') == 0)
    call expect('    data: 1,1' // NEWLINE // '    data: 2,1' // NEWLINE // '    data: 3,1' // NEWLINE // &
      '    and 2 data lines more')
    call suite%that('only three rows', index(text, 'data: 4,1') == 0)
  end subroutine check_cards


  !> Mesh, materials and steps.
  subroutine check_numbers()
    call expect('    8 nodes' // NEWLINE // '    1 element C3D8, 8 integration points, mean dilatation', after='Numbers taken')
    call expect('material Steel: E 210, nu 0.25; under NLGEOM Kirchhoff stress by logarithmic strain; density 7.5')
    call expect('step 1: NLGEOM, length 2, first increment 0.25,')
    call expect('largest 2, at most 100 increments')
    call expect('7 prescribed displacements, 0 forces, 1 face under pressure, 0 faces under traction, 1 element with loads')
    call explain(MESH // '*MATERIAL, NAME=R;*HYPERELASTIC, NEO HOOKE;3.,.5;*SOLID SECTION, ELSET=E, MATERIAL=R;*MATERIAL, ' // &
      'NAME=O;*ELASTIC, TYPE=ORTHO;9.,1.,8.,2.,3.,7.,4.,5.;6.;*MATERIAL, NAME=P;' // &
      '*ELASTIC;9.,.25;*PLASTIC;2.,0.;*CREEP;1.,2.,0.;*EXPANSION, ZERO=3.;4.;' // &
      '*INITIAL CONDITIONS, TYPE=TEMPERATURE;1,20.;' // STEP, &
      DIALECT_CALCULIX, .false.)
    call expect('read in the calculix dialect')
    call expect('8 integration points' // NEWLINE)
    call expect('material R: rubber of order 1, constants 3')
    call expect('material O: orthotropic, D 9 1 8 2 3 7 4 5 6')
    call expect('expansion 4 from 3; first yield stress 2; creep A 1, n 2, m 0')
  end subroutine check_numbers


  !> Laws of contact.
  subroutine check_laws()
    call explain(MESH // MATERIAL // '*SURFACE INTERACTION, NAME=I;*FRICTION, TAUMAX=5.;.5;*SURFACE INTERACTION, NAME=J;' // &
      '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR;100.,2.,.5;*FRICTION;.25;*SURFACE INTERACTION, NAME=K;' // &
      '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR;0.,0.;1.,1.;*SURFACE INTERACTION, NAME=L;*FRICTION, ROUGH;' // &
      '*SURFACE INTERACTION, NAME=X;*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL;.1,3.;' // &
      '*SURFACE INTERACTION, NAME=T;*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED;8.;' // STEP, DIALECT_ABAQUS, .false.)
    call expect('interaction I: HARD, exact; friction 0.5, at most 5')
    call expect('interaction J: LINEAR, stiffness 100, tension 2, reach 0.5; friction 0.25, stick slope 1')
    call expect('interaction K: TABULAR, 2 rows; frictionless')
    call expect('interaction L: HARD, exact; rough')
    call expect('interaction X: EXPONENTIAL, reach 0.1, pressure 3')
    call expect('interaction T: TIED, stiffness 8')
  end subroutine check_laws


  !> Errors and notes below their cards; an error in parts stops the reading.
  subroutine check_messages()
    call explain(MESH // MATERIAL // '*MODAL DYNAMIC;*NONSENSE;*NSET, NSET=A;1,99;' // STEP, DIALECT_ABAQUS, .true.)
    call expect('*MODAL DYNAMIC: refused. ')
    call expect('*NONSENSE: not known')
    call expect('    error: There is no node 99.', after='*NSET: used')
    call expect('The deck has ')
    call expect('so it would not run')
    call explain('*PART, NAME=P;' // MESH // '*STEP;*STATIC;*END STEP;', DIALECT_ABAQUS, .true.)
    call expect('error: This part has no *END PART before *STEP;')
    call suite%that('no numbers', index(text, 'Numbers taken') == 0)
  end subroutine check_messages

end program test_explain
