!> The cards EQUATION, EMBEDDED ELEMENT, FOUNDATION, SHELL TO SOLID COUPLING and IMPERFECTION.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_card_constraints
  use amontons_card_schema, only: card_table_type, SCOPE_MODEL, SCOPE_BOTH, VALUE_NAME, VALUE_REAL, VALUE_TEXT, &
    VALUE_WORD, VALUE_OPTIONAL_WORD, ENTRY_IGNORED, ENTRY_REJECTED
  implicit none
  private
  public :: describe_constraints, describe_equation, describe_embedded_elements

contains

  !> All cards of this module.
  subroutine describe_constraints(table)
    type(card_table_type), intent(inout) :: table
    call describe_equation(table)
    call describe_embedded_elements(table)
    call describe_foundation(table)
    call describe_shell_coupling(table)
    call describe_imperfection(table)
  end subroutine describe_constraints


  !> EQUATION.
  subroutine describe_equation(table)
    type(card_table_type), intent(inout) :: table
    call table%card('EQUATION', SCOPE_BOTH, 'Sums of displacements and rotations that are zero; the first term is the one ' // &
      'eliminated.', data='number of terms; then node or node set, degree of freedom, coefficient of each term; with REMOVE, ' // &
      'in a step: node or node set, first and last degree of freedom')
    call table%option('INPUT', VALUE_TEXT, 'File with the data lines.')
    call table%option('REMOVE', VALUE_OPTIONAL_WORD, 'In a step: the equations whose first term is named hold no more, or all.', &
      allowed='ALL')
  end subroutine describe_equation


  !> EMBEDDED ELEMENT.
  subroutine describe_embedded_elements(table)
    type(card_table_type), intent(inout) :: table
    call table%card('EMBEDDED ELEMENT', SCOPE_MODEL, 'Elements such as reinforcing bars whose nodes move with the solids in ' // &
      'which they lie; their rotations are free.', data='elements and element sets')
    call table%option('HOST ELSET', VALUE_NAME, 'The elements in which they lie.', default='all that are not embedded')
    call table%option('EXTERIOR TOLERANCE', VALUE_REAL, 'A node may be so far outside the hosts, over the mean size of their ' // &
      'elements; it moves with the nearest point.', default='0.05')
    call table%option('ABSOLUTE EXTERIOR TOLERANCE', VALUE_REAL, 'The same as a distance; with both the smaller counts.', &
      default='none')
    call table%option('ROUNDOFF TOLERANCE', VALUE_REAL, 'Weights of the nodes of a host below it are left out.', default='1e-6')
    call table%add_dialect_note('CalculiX does not know the card and passes over it; here it holds in both dialects.')
  end subroutine describe_embedded_elements


  !> FOUNDATION.
  subroutine describe_foundation(table)
    type(card_table_type), intent(inout) :: table
    call table%card('FOUNDATION', SCOPE_MODEL, 'Springs to the ground on faces of elements, along their normal, for ' // &
      'pressure and tension alike; under NLGEOM they turn with the face. Abaqus dialect.', data='element or element set; ' // &
      'F1 to F6 for the face of a solid or a plane element, F for a shell or a membrane; stiffness, a force per length and area')
  end subroutine describe_foundation


  !> SHELL TO SOLID COUPLING.
  subroutine describe_shell_coupling(table)
    type(card_table_type), intent(inout) :: table
    call table%card('SHELL TO SOLID COUPLING', SCOPE_MODEL, 'Edges of shells move as the mean of the solid in front of them: ' // &
      'displacements and rotations, over the thickness of the shell. Abaqus dialect.', &
      data='edges of shells (a surface of E1 to E4), faces of solids')
    call table%option('CONSTRAINT NAME', VALUE_NAME, 'A name.', default='required')
    call table%option('POSITION TOLERANCE', VALUE_REAL, 'Edges farther from the solid are not coupled.', &
      default='5 % of the mean edge of the shell''s edges')
    call table%option('INFLUENCE DISTANCE', VALUE_REAL, 'The thickness of the shell decides.', status=ENTRY_IGNORED)
  end subroutine describe_shell_coupling


  !> IMPERFECTION.
  subroutine describe_imperfection(table)
    type(card_table_type), intent(inout) :: table
    call table%card('IMPERFECTION', SCOPE_MODEL, 'Moves nodes before the model is made of them, as by a dent or by a ' // &
      'buckling mode times its height; several cards add up.', data='node or node set, offset along x, y, z')
    call table%option('INPUT', VALUE_TEXT, 'File with the data lines.')
    call table%option('SYSTEM', VALUE_WORD, 'R: offsets along x, y, z; C: of the radius, of the angle about z in degrees, ' // &
      'along z; S: of the radius, of the angle about z, of the angle above the xy plane.', allowed='R|C|S', default='R')
    call table%option('FILE', VALUE_TEXT, 'Modes are not read from the results of another job: write the mode ' // &
      'times its height as data lines, node, x, y, z, into the deck or into the file of INPUT.', status=ENTRY_REJECTED)
    call table%option('STEP|NSET', VALUE_TEXT, 'They belong to FILE.', status=ENTRY_IGNORED)
    call table%add_dialect_note('calculix: refused, as CalculiX has no such card.')
  end subroutine describe_imperfection

end module amontons_card_constraints
