!> The card SUBMODEL and the parameters by which other cards take values from a global model.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_card_submodels
  use amontons_card_schema, only: card_table_type, SCOPE_MODEL, ENTRY_REJECTED, VALUE_NONE, VALUE_NAME, VALUE_TEXT, &
    VALUE_INTEGER, VALUE_REAL, VALUE_WORD
  implicit none
  private
  public :: describe_submodel, describe_global_step

contains

  !> SUBMODEL.
  subroutine describe_submodel(table)
    type(card_table_type), intent(inout) :: table
    call table%card('SUBMODEL', SCOPE_MODEL, 'Nodes of a cut that follow the results of a global model, which *BOUNDARY, ' // &
      'SUBMODEL and *TEMPERATURE, SUBMODEL take at their places.', data='nodes and node sets')
    call table%option('TYPE', VALUE_WORD, 'The displacements or temperatures of nodes.', allowed='NODE', default='NODE')
    call table%reject_words('SURFACE', 'Stresses are not taken from a global model: drive the displacements of the nodes of ' // &
      'the surface by TYPE=NODE.')
    call table%option('INPUT|GLOBAL', VALUE_TEXT, 'File with the results of the global model, beside the deck or in the ' // &
      'working directory: .vtkhdf of Amontons, .frd of Amontons or CalculiX.', default='that of globalmodel=')
    call table%option('GLOBAL ELSET', VALUE_NAME, 'Elements of the global model that count: an *ELSET of their numbers in ' // &
      'this deck, or a set of the .vtkhdf file, which comes first in the abaqus dialect.', default='all')
    call table%option('EXTERIOR TOLERANCE', VALUE_REAL, 'A driven node may be so far outside the global model, over the mean ' // &
      'size of its elements; it takes the values of the nearest point.', default='0.05; calculix dialect: any')
    call table%option('ABSOLUTE EXTERIOR TOLERANCE', VALUE_REAL, 'The same as a distance; with both the smaller counts.', &
      default='none')
    call table%option('ACOUSTIC TO STRUCTURE|SHELL TO SOLID|SHELL THICKNESS|INTERSECTION ONLY', VALUE_TEXT, 'Shells of the ' // &
      'global model are solids in its results: leave it out.', status=ENTRY_REJECTED)
    call table%add_dialect_note('abaqus: the displacements follow all increments of the global step over its time. calculix: ' // &
      'those of its last increment, linear over the step; a message lists nodes outside.')
  end subroutine describe_submodel


  !> Which results of a global model a card takes.
  subroutine describe_global_step(table, what)
    type(card_table_type), intent(inout) :: table
    character(*), intent(in) :: what             !< what the global model gives: 'The displacements'
    call table%option('SUBMODEL', VALUE_NONE, what // ' are those of the global model of *SUBMODEL, at the places of the nodes.')
    call table%option('STEP', VALUE_INTEGER, 'Step of the global model.', default='none')
    call table%option('DATA SET', VALUE_INTEGER, 'In place of STEP: number of one of its results, as cgx counts them in a ' // &
      '.frd file; of a .vtkhdf file its frame, from 0.', default='none')
    call table%option('MASTER', VALUE_WORD, 'Dimensions of the global model.', allowed='3D', default='3D')
    call table%reject_words('2D', 'A submodel of solids needs a global model of solids.')
    call table%option('TIMESCALE', VALUE_NONE, 'Abaqus dialect: the step of the global model takes as long as this one; ' // &
      'without it both times run alike, and the last values stay.')
    call table%option('INC', VALUE_TEXT, 'The history of the step is followed, or its last increment (calculix dialect): ' // &
      'leave INC out.', status=ENTRY_REJECTED)
  end subroutine describe_global_step

end module amontons_card_submodels
