!> Entries of the card table for cohesive elements: section, its controls, damage.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_card_cohesive
  use amontons_card_schema, only: card_table_type, describe_field_variables, SCOPE_MODEL, ENTRY_IGNORED, ENTRY_REJECTED, &
    VALUE_NAME, VALUE_TEXT, VALUE_REAL, VALUE_WORD
  implicit none
  private
  public :: describe_cohesive

contains

  !> COHESIVE SECTION, SECTION CONTROLS, DAMAGE INITIATION, EVOLUTION, STABILIZATION.
  subroutine describe_cohesive(table)
    type(card_table_type), intent(inout) :: table
    call table%card('COHESIVE SECTION', SCOPE_MODEL, 'Gives cohesive elements (COH2D4, COHAX4, COH3D6, COH3D8) their law: ' // &
      'tractions over the separation of the two faces, of *ELASTIC, TYPE=TRACTION.', data='thickness that strains refer to ' // &
      '(default 1: strains are separations), width of COH2D4 (default 1)')
    call table%option('ELSET', VALUE_NAME, 'The elements.', default='required')
    call table%option('MATERIAL', VALUE_NAME, 'Their material.', default='required')
    call table%option('RESPONSE', VALUE_WORD, 'Kind of law.', allowed='TRACTION SEPARATION', default='required')
    call table%reject_words('CONTINUUM|GASKET', 'A layer of finite thickness is one of solid elements; else give TRACTION ' // &
      'SEPARATION.')
    call table%option('THICKNESS', VALUE_WORD, 'SPECIFIED: the data line gives it; GEOMETRY: the distance of the faces.', &
      allowed='SPECIFIED|GEOMETRY', default='SPECIFIED')
    call table%option('ORIENTATION', VALUE_NAME, 'Its first axis, projected on the element, is the direction of the first shear.', &
      default='projection of x; of z where x is within 0.1 degrees of the normal')
    call table%option('CONTROLS', VALUE_NAME, 'Name of *SECTION CONTROLS, of which VISCOSITY counts.')
    call table%option('STACK DIRECTION', VALUE_WORD, 'From the first to the second half of the nodes of an element.', allowed='3', &
      default='3')
    call table%reject_words('1|2|ORIENTATION', 'Number the nodes of the lower face first, those of the upper face second.')
    call describe_section_controls(table)
    call describe_damage(table)
  end subroutine describe_cohesive


  !> SECTION CONTROLS.
  subroutine describe_section_controls(table)
    type(card_table_type), intent(inout) :: table
    call table%card('SECTION CONTROLS', SCOPE_MODEL, 'Settings of sections, of which cohesive ones take VISCOSITY; the others ' // &
      'have no effect.', data='scale factors, which have no effect')
    call table%option('NAME', VALUE_NAME, 'Name.', default='required')
    call table%option('VISCOSITY', VALUE_REAL, 'Time mu by which the damage that acts lags behind that of the law: ' // &
      'mu dDv/dt = D - Dv.', default='0')
    call table%option('ELEMENT DELETION', VALUE_TEXT, 'Cohesive elements stay: after full damage they still resist pressure.', &
      status=ENTRY_IGNORED)
    call table%option('HOURGLASS|KINEMATIC SPLIT|SECOND ORDER ACCURACY|DISTORTION CONTROL|LENGTH RATIO|DRILLING STIFFNESS|' // &
      'RAMP INITIAL STRESS|WEIGHT FACTOR|INITIAL GAP OPENING|CONVERSION CRITERION|PERTURBATION', VALUE_TEXT, &
      'The elements are chosen by their type alone.', status=ENTRY_IGNORED)
    call table%option('MAX DEGRADATION', VALUE_TEXT, 'Damage ends at 1, or at the end of its table.', status=ENTRY_REJECTED)
  end subroutine describe_section_controls


  !> DAMAGE INITIATION, EVOLUTION, STABILIZATION.
  subroutine describe_damage(table)
    type(card_table_type), intent(inout) :: table
    call table%card('DAMAGE INITIATION', SCOPE_MODEL, 'Where the damage of a cohesive law starts: normal traction (tension ' // &
      'alone), first and second shear over their limits, or their strains over theirs, reach 1.', parent='MATERIAL', data= &
      'limits: normal, first shear, second shear (blank: as the first), temperature')
    call table%option('CRITERION', VALUE_WORD, 'MAXS, MAXE: the largest of the three; QUADS, QUADE: the sum of squares; of ' // &
      'tractions (S) or strains (E).', allowed='MAXS|QUADS|MAXE|QUADE', default='required')
    call table%reject_words('DUCTILE|SHEAR|FLD|FLSD|MSFLD|MK|JOHNSON COOK|HYSTERESIS ENERGY|MAXPS|MAXPE|USER|HASHIN', &
      'Damage is one of cohesive elements, with MAXS, QUADS, MAXE or QUADE; that of solids needs a routine UMAT.')
    call describe_field_variables(table)
    call table%option('TOLERANCE|POSITION', VALUE_TEXT, 'Increments are cut back where they do not converge alone.', &
      status=ENTRY_IGNORED)
    call table%card('DAMAGE EVOLUTION', SCOPE_MODEL, 'How tractions fall from the start of damage on; without it damage does ' // &
      'not act, and its criterion is printed alone.', parent='MATERIAL', data='ENERGY: fracture energy, or with MIXED MODE ' // &
      'BEHAVIOR those of normal, first and second shear mode; DISPLACEMENT: separation from the start of damage to its end, ' // &
      'with EXPONENTIAL and alpha; TABULAR: damage, separation since its start; then temperature')
    call table%option('TYPE', VALUE_WORD, 'What the data are.', allowed='ENERGY|DISPLACEMENT', default='required')
    call table%reject_words('HYSTERESIS ENERGY', 'Damage by cycles does not exist here.')
    call table%option('SOFTENING', VALUE_WORD, 'How tractions fall over the separation; TABULAR of DISPLACEMENT alone.', &
      allowed='LINEAR|EXPONENTIAL|TABULAR', default='LINEAR')
    call table%option('MIXED MODE BEHAVIOR', VALUE_WORD, 'Fracture energy of mixed modes: MODE INDEPENDENT: the same for all; ' // &
      'POWER LAW: sum of (G_i/G_ic)^POWER is 1; BK: Benzeggagh and Kenane''s law.', allowed='MODE INDEPENDENT|POWER LAW|BK', &
      default='MODE INDEPENDENT')
    call table%reject_words('TABULAR', 'Give POWER LAW or BK, which TYPE=ENERGY has.')
    call table%option('POWER', VALUE_REAL, 'Exponent of POWER LAW or BK.', default='required with them')
    call table%option('MODE MIX RATIO', VALUE_WORD, 'Shares of the modes are those of the energy.', allowed='ENERGY', &
      default='ENERGY')
    call table%reject_words('TRACTION', 'Shares of tractions do not exist here; leave it out, or give ENERGY.')
    call table%option('DEGRADATION', VALUE_TEXT, 'There is one criterion of damage.', status=ENTRY_IGNORED)
    call describe_field_variables(table)
    call table%card('DAMAGE STABILIZATION', SCOPE_MODEL, 'Viscosity of the damage of a cohesive law, as VISCOSITY of SECTION ' // &
      'CONTROLS; the larger one counts.', parent='MATERIAL', data='viscosity [time]')
  end subroutine describe_damage

end module amontons_card_cohesive
