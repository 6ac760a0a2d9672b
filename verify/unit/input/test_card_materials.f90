!> Unit test of card_materials: the entries of materials alone, and what a card gives when it is compared with them.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_card_materials
  use amontons_card_materials, only: describe_materials
  use amontons_card_schema, only: card_table_type, find_entry, match_parameters, SCOPE_STEP, SCOPE_MODEL, ENTRY_IGNORED
  use amontons_cards, only: cards_type, parameter_type, deck_messages_type, open_cards_text, read_parameters
  use check, only: suite_type
  implicit none
  character(*), parameter :: PROPERTIES(11) = [character(22) :: 'ELASTIC', 'DENSITY', 'EXPANSION', 'PLASTIC', &
    'CYCLICHARDENING', 'DEFORMATIONPLASTICITY', 'CREEP', 'USERMATERIAL', 'DEPVAR', 'HYPERELASTIC', 'HYPERFOAM']
  type(suite_type) :: suite
  type(card_table_type) :: table
  integer :: i, k
  logical :: is_short
  call describe_materials(table)
  do k = 1, size(PROPERTIES)
    call find_entry(table, trim(PROPERTIES(k)), i, is_short)
    call suite%that(trim(PROPERTIES(k)) // ' is there', i > 0 .and. .not. is_short)
    if (i > 0) call suite%that(trim(PROPERTIES(k)) // ' belongs to a material of the model', &
      table%entries(i)%parent == 'MATERIAL' .and. table%entries(i)%scope == SCOPE_MODEL .and. table%entries(i)%data /= '')
  end do
  call find_entry(table, 'TEMPERATURE', i, is_short)
  call suite%that('TEMPERATURE is a card of steps', table%entries(i)%scope == SCOPE_STEP .and. table%entries(i)%parent == '')
  call find_entry(table, 'DISTRIBUTIONTABLE', i, is_short)
  call suite%that('DISTRIBUTION TABLE is ignored', table%entries(i)%status == ENTRY_IGNORED)
  call check_matches()
  call suite%finish()

contains

  !> Cards with right and wrong parameters.
  subroutine check_matches()
    call expect('*MATERIAL,NAME=M', 0, 0, '')
    call expect('*MATERIAL', 1, 0, 'needs the parameter NAME')
    call expect('*MATERIAL,NAME=M,RTOL=1', 0, 1, 'It smooths tables of rates')
    call expect('*ELASTIC,TYPE=ENGINEERING CONSTANTS', 0, 0, '')
    call expect('*ELASTIC,TYPE=LAMINA', 0, 0, '')
    call expect('*ELASTIC,TYPE=TRACTION', 0, 0, '')
    call expect('*ELASTIC,TYPE=COUPLED TRACTION', 1, 0, 'whose directions are not coupled')
    call expect('*ELASTIC,DEPENDENCIES=1', 0, 0, '')
    call expect('*ELASTIC,DEPENDENCIES=some', 1, 0, 'DEPENDENCIES=integer')
    call expect('*FIELD,VARIABLE=2,OP=NEW', 0, 0, '')
    call expect('*FIELD,USER', 1, 0, 'Give the values')
    call expect('*EXPANSION,TYPE=SHORT FIBER', 1, 0, 'Give ORTHO')
    call expect('*EXPANSION,ZERO=cold', 1, 0, 'ZERO=real')
    call expect('*PLASTIC,HARDENING=COMBINED,DATA TYPE=HALF CYCLE', 0, 0, '')
    call expect('*PLASTIC,HARDENING=JOHNSON COOK', 1, 0, 'Give a table')
    call expect('*PLASTIC,RATE=1.', 0, 0, '')
    call expect('*PLASTIC,RATE=fast', 1, 0, 'RATE=real')
    call expect('*PLASTIC,EXTRAPOLATION=LINEAR', 1, 0, 'constant stress beyond')
    call expect('*RATE DEPENDENT,TYPE=YIELD RATIO', 0, 0, '')
    call expect('*RATE DEPENDENT,TYPE=JOHNSON COOK', 1, 0, 'Give POWER LAW or YIELD RATIO')
    call expect('*CREEP,LAW=STRAIN', 0, 0, '')
    call expect('*CREEP,LAW=ANAND', 1, 0, 'Use TIME, STRAIN, NORTON or USER')
    call expect('*USER MATERIAL,CONSTANTS=2,UNSYMM', 0, 1, 'DDSDDE')
    call expect('*USER MATERIAL', 1, 0, 'CONSTANTS=integer')
    call expect('*USER MATERIAL,CONSTANTS=2,TYPE=THERMAL', 1, 0, 'no heat transfer')
    call expect('*HYPERELASTIC,OGDEN,N=2', 0, 0, '')
    call expect('*HYPERELASTIC,MARLOW', 1, 0, 'Use one of the others')
    call expect('*HYPERFOAM,N=x', 1, 0, 'N=integer')
    call expect('*SOLID SECTION,ELSET=E,MATERIAL=M,CONTROLS=C', 0, 1, 'type alone')
    call expect('*SOLID SECTION,ELSET=E', 1, 0, 'MATERIAL=name')
    call expect('*SOLID SECTION,ELSET=E,MATERIAL=M,COMPOSITE', 1, 0, 'Layered')
    call expect('*SPRING,ELSET=E,NONLINEAR', 0, 0, '')
    call expect('*ORIENTATION,NAME=O,SYSTEM=SPHERICAL', 1, 0, 'Use RECTANGULAR or CYLINDRICAL')
    call expect('*INITIAL CONDITIONS,TYPE=HARDENING', 0, 0, '')
    call expect('*INITIAL CONDITIONS,TYPE=VELOCITY', 1, 0, 'starts at rest')
    call expect('*TEMPERATURE,OP=NEW', 0, 0, '')
    call expect('*TEMPERATURE,FILE=f', 1, 0, 'Give the values')
  end subroutine check_matches


  !> Compares a card with its entry: numbers of errors and notes, and a piece of their text.
  subroutine expect(text, n_errors, n_notes, piece)
    character(*), intent(in) :: text, piece
    integer, intent(in) :: n_errors, n_notes
    type(cards_type) :: cards
    type(parameter_type), allocatable :: parameters(:)
    type(deck_messages_type) :: messages
    character(:), allocatable :: reported
    integer :: entry, line
    logical :: is_warning, is_abbreviated
    call open_cards_text(text, 'deck', cards, messages)
    call read_parameters(cards, cards%cards(1), parameters)
    call find_entry(table, cards%cards(1)%key, entry, is_abbreviated)
    if (entry == 0) error stop 'a card is not in the table'
    call match_parameters(table%entries(entry), parameters, 1, .false., messages)
    reported = ''
    if (messages%n > 0) call messages%get(1, line, is_warning, reported)
    call suite%that(text // ': counts; ' // reported, messages%n_errors == n_errors .and. messages%n == n_errors + n_notes)
    call suite%that(text // ': ' // reported, index(reported, piece) > 0 .or. piece == '')
  end subroutine expect

end program test_card_materials
