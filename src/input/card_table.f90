!> The table of all cards, including ignored and rejected ones: keyword, scope, parameters, data lines, description.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Checks, messages, `amontons --cards` and the manual come from this table. A new card needs one entry here and one
!! procedure in the reader.
module amontons_card_table
  use amontons_card_materials, only: describe_materials
  use amontons_card_constraints, only: describe_constraints
  use amontons_card_submodels, only: describe_submodel, describe_global_step
  use amontons_card_schema, only: card_table_type, render_card_table, SCOPE_MODEL, SCOPE_STEP, SCOPE_BOTH, ENTRY_IGNORED, &
    ENTRY_REJECTED, VALUE_NONE, VALUE_NAME, VALUE_TEXT, VALUE_INTEGER, VALUE_REAL, VALUE_WORD, VALUE_OPTIONAL_WORD, &
    VALUE_OPTIONAL_REAL
  implicit none
  private
  public :: make_card_table, list_cards, NODE_VARIABLES, ELEMENT_VARIABLES, CONTACT_VARIABLES, &
    SECTION_VARIABLES

  character(*), parameter :: NODE_VARIABLES = 'U|UR|V|RF|NT|COOR'      !< variables of NODE PRINT
  character(*), parameter :: SECTION_VARIABLES = 'SOF|SOM|SOAR'   !< variables of SECTION PRINT, each of which prints all
  character(*), parameter :: ELEMENT_VARIABLES = 'S|E|ME|PEEQ|CEEQ|SDEG|DMIC|SDV|ENER|ELSE|EVOL|COOR|SF|SM' !< of EL PRINT
  character(*), parameter :: CONTACT_VARIABLES = 'CDIS|CSTR|SCEN|CNUM|CELS|CF|CFN|CFS|CFT|CMN|CMS|CMT|CARE|XN|XS|XT'

contains

  !> Builds the table. It is not a module variable, so that two jobs can read simultaneously.
  subroutine make_card_table(table)
    type(card_table_type), intent(out) :: table
    call describe_structure(table)
    call describe_mesh(table)
    call describe_materials(table)
    call describe_contact(table)
    call describe_general_contact(table)
    call describe_constraints(table)
    call describe_submodel(table)
    call describe_contact_changes(table)
    call describe_amplitude(table)
    call describe_couplings(table)
    call describe_loads(table)
    call describe_steps(table)
    call describe_controls(table)
    call describe_prints(table)
    call describe_files(table)
    call describe_ignored(table)
    call describe_rejected_materials(table)
    call describe_rejected_procedures(table)
    call describe_rejected_parts(table)
  end subroutine make_card_table


  !> The table as text, for `amontons --cards` and the manual.
  subroutine list_cards(text)
    character(:), allocatable, intent(out) :: text
    type(card_table_type) :: table
    call make_card_table(table)
    call render_card_table(table, text)
  end subroutine list_cards


  !> Heading, included files, parameters, parts and assembly.
  subroutine describe_structure(table)
    type(card_table_type), intent(inout) :: table
    call table%card('HEADING', SCOPE_MODEL, 'Text that describes the job; it is kept with the results.', data='free text')
    call table%card('INCLUDE', SCOPE_BOTH, 'Reads another file in place of this card; the file is looked for beside ' // &
      'this one first.')
    call table%option('INPUT|FILE', VALUE_TEXT, 'Path of the file.')
    call table%card('PARAMETER', SCOPE_BOTH, 'Gives names to numbers; <name> in a later line is replaced by the number.', &
      data='name = expression, of numbers, earlier names, + - * / **, parentheses and functions (sqrt, sin, ...)')

    call table%card('PART', SCOPE_MODEL, 'Starts a part: nodes, elements, sets, surfaces and sections, written once for each of ' &
      // &
      'its instances before the deck is read.')
    call table%option('NAME', VALUE_NAME, 'Name of the part.', default='required')
    call table%card('END PART', SCOPE_MODEL, 'Ends the part.')
    call table%card('ASSEMBLY', SCOPE_MODEL, 'Starts the assembly: instances, and sets and surfaces over them.')
    call table%option('NAME', VALUE_NAME, 'A name.', status=ENTRY_IGNORED)
    call table%card('END ASSEMBLY', SCOPE_MODEL, 'Ends the assembly.')
    call table%card('INSTANCE', SCOPE_MODEL, 'Puts a part into the assembly; its sets are called INSTANCE.SET from then on, its ' &
      // &
      'nodes INSTANCE.NUMBER.', data='translation of three numbers; second line two points of an axis and an angle in degrees')
    call table%option('NAME', VALUE_NAME, 'Name of the instance.', default='required')
    call table%option('PART', VALUE_NAME, 'Name of the part.', default='required')
    call table%option('LIBRARY|INSTANCE', VALUE_TEXT, 'Write the part itself.', status=ENTRY_REJECTED)
    call table%card('END INSTANCE', SCOPE_MODEL, 'Ends the instance.')
  end subroutine describe_structure


  !> Nodes, elements, sets, surfaces.
  subroutine describe_mesh(table)
    type(card_table_type), intent(inout) :: table
    call table%card('NODE', SCOPE_MODEL, 'Defines nodes.', data='number, x, y, z')
    call table%option('NSET', VALUE_NAME, 'Puts the nodes into this node set as well.')
    call table%option('SYSTEM', VALUE_WORD, 'R: x, y, z; C: radius, angle about z in degrees, z; S: radius, angle about z, ' // &
      'angle above the xy plane.', allowed='R|C|S', default='R')
    call table%option('INPUT', VALUE_TEXT, 'File with the data lines.')

    call table%card('ELEMENT', SCOPE_MODEL, 'Defines elements; the nodes of an element may continue in further lines.', &
      data='number, node, node, ...')
    call table%option('TYPE', VALUE_TEXT, 'Kind of element: C3D4, C3D6, C3D8, C3D8I, C3D8R, C3D10, C3D15, C3D20, C3D20R; ' // &
      'CPS, CPE, CAX with 3, 4, 4I, 4R, 6, 8, 8R; S3, S4, S4R, S6, S8, S8R, SAX1, SAX2; M3D3, M3D4, M3D4R, M3D6, M3D8, ' // &
      'M3D8R; B21, B22, B31, B31R, B32, B32R; T2D2, T2D3, T3D2, T3D3; R3D3, R3D4, R2D2, RAX2; SPRINGA, SPRING1, SPRING2; ' // &
      'GAPUNI; MASS; COH2D4, COHAX4, COH3D6, COH3D8; U1 to U9999 of *USER ELEMENT.', default='required')
    call table%option('ELSET', VALUE_NAME, 'Puts the elements into this element set as well.')
    call table%option('INPUT', VALUE_TEXT, 'File with the data lines.')
    call table%add_dialect_note('abaqus: C3D8, CPE4 and CAX4 have a mean dilatation; calculix: they are integrated in full, ' // &
      'and rigid elements are refused.')

    call table%card('NGEN', SCOPE_MODEL, 'Makes nodes at equal distances between two nodes.', &
      data='first and last node, step of ' // &
      'the numbers; with LINE: third node or 0, its x, y, z, with C the normal x, y, z')
    call table%option('NSET', VALUE_NAME, 'Puts these nodes, and the two, into this set.')
    call table%option('LINE', VALUE_WORD, 'C: circle, the third point is its centre; P: parabola, it is the middle.', &
      allowed='C|P', default='straight')
    call table%card('NFILL', SCOPE_MODEL, 'Makes rows of nodes between the nodes of two sets.', data='first and second set, ' // &
      'intervals, step of the numbers')
    call table%option('NSET', VALUE_NAME, 'Puts these nodes, and those of the two sets, into this set.')
    call table%option('BIAS', VALUE_REAL, 'Length of an interval over that of the next.', default='1')
    call table%card('NCOPY', SCOPE_MODEL, 'Copies the nodes of a set.', &
      data='translation x, y, z; second line two points of an ' // &
      'axis and an angle in degrees')
    call table%option('OLD SET', VALUE_NAME, 'The set.', default='required')
    call table%option('CHANGE NUMBER', VALUE_INTEGER, 'Added to the numbers.', default='required')
    call table%option('SHIFT', VALUE_NONE, 'The copies are moved and turned.', default='required')
    call table%option('MULTIPLE', VALUE_INTEGER, 'Number of copies.', default='1')
    call table%option('NEW SET', VALUE_NAME, 'Set of the copies.')
    call table%card('ELGEN', SCOPE_MODEL, 'Makes rows and layers of an element.', data='element; then for row, rows, ' // &
      'layers: their number, step of the nodes, step of the elements')
    call table%option('ELSET', VALUE_NAME, 'Puts the elements, and the first, into this set.')
    call table%card('ELCOPY', SCOPE_MODEL, 'Copies the elements of a set.')
    call table%option('OLD SET', VALUE_NAME, 'The set.', default='required')
    call table%option('ELEMENT SHIFT', VALUE_INTEGER, 'Added to the numbers of the elements.', default='required')
    call table%option('SHIFT NODES', VALUE_INTEGER, 'Added to the numbers of the nodes.', default='0')
    call table%option('NEW SET', VALUE_NAME, 'Set of the copies.')

    call table%card('NSET', SCOPE_BOTH, 'Defines a node set or extends it.', &
      data='node numbers and names of node sets; with GENERATE first, last, step')
    call table%option('NSET', VALUE_NAME, 'Name of the set.', default='required')
    call table%option('GENERATE', VALUE_NONE, 'Each data line is a range of node numbers.')
    call table%option('ELSET', VALUE_NAME, 'Takes the nodes of the elements of this element set.')
    call table%option('UNSORTED', VALUE_NONE, 'Keeps the order of the nodes, by which *EQUATION and *MPC bind those of two sets.')
    call table%option('INTERNAL', VALUE_NONE, '', status=ENTRY_IGNORED)
    call table%option('INSTANCE', VALUE_NAME, 'In an assembly: numbers and names are those of this instance.')
    call table%add_dialect_note('Numbers of nodes that do not exist are errors under abaqus, notes under calculix. calculix: ' // &
      'always UNSORTED.')

    call table%card('ELSET', SCOPE_BOTH, 'Defines an element set or extends it.', &
      data='element numbers and names of element sets; with GENERATE first, last, step')
    call table%option('ELSET', VALUE_NAME, 'Name of the set.', default='required')
    call table%option('GENERATE', VALUE_NONE, 'Each data line is a range of element numbers.')
    call table%option('UNSORTED|INTERNAL', VALUE_NONE, '', status=ENTRY_IGNORED)
    call table%option('INSTANCE', VALUE_NAME, 'In an assembly: numbers and names are those of this instance.')

    call table%card('SURFACE', SCOPE_MODEL, 'Defines a surface: element faces, nodes, or an analytic rigid one.', &
      data='element or element set, face S1 to S6 or nothing: all free faces, or the faces ' // &
      'under plane elements that a mesh generator wrote with the solids; with TYPE=NODE node or node set; with ' // &
      'SEGMENTS, CYLINDER, REVOLUTION the local axes, then START, LINE, CIRCL')
    call table%option('NAME', VALUE_NAME, 'Name of the surface.', default='required')
    call table%option('TYPE', VALUE_WORD, 'Faces, nodes (slaves only), or an analytic surface (masters only, with *RIGID ' // &
      'BODY): a profile in the plane, drawn out, or turned about an axis.', allowed= &
      'ELEMENT|NODE|SEGMENTS|CYLINDER|REVOLUTION', default='ELEMENT')
    call table%reject_words('CUTTING SURFACE|USER|EULERIAN MATERIAL', &
      'Mesh the body and give its element faces.')
    call table%option('INTERNAL', VALUE_NONE, '', status=ENTRY_IGNORED)
    call table%option('TRIM|PROPERTY|DEFINITION', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%option('FILLET RADIUS', VALUE_REAL, 'Rounds corners between lines of an analytic surface.')
    call table%option('COMBINE|CROP|SCALE|MAX RATIO', VALUE_TEXT, 'Give element faces.', &
      status=ENTRY_REJECTED)
  end subroutine describe_mesh


  !> Interactions and contact pairs.
  subroutine describe_contact(table)
    type(card_table_type), intent(inout) :: table
    character(*), parameter :: HARD_CONTACT_TEXT = 'HARD contact is enforced exactly, without a penalty.'
    call table%card('SURFACE INTERACTION', SCOPE_MODEL, 'Starts an interaction; SURFACE BEHAVIOR and FRICTION follow.', &
      data='one line, which is ignored; with USER the properties of UINTER, eight in each')
    call table%option('NAME', VALUE_NAME, 'Name of the interaction.', default='required')
    call table%option('PAD THICKNESS|TRACKING THICKNESS', VALUE_TEXT, 'Surfaces have no thickness.', &
      status=ENTRY_REJECTED)
    call table%option('USER', VALUE_NONE, 'The whole law is by the user routine UINTER; the properties follow the first line.')
    call table%option('DEPVAR', VALUE_INTEGER, 'USER: number of STATEV at each slave node.', default='0')
    call table%option('PROPERTIES', VALUE_INTEGER, 'USER: number of properties, in lines of eight.', default='0')
    call table%option('UNSYMM', VALUE_NONE, 'The tangent always is what it is.', status=ENTRY_IGNORED)

    call table%card('SURFACE BEHAVIOR', SCOPE_BOTH, 'The law normal to the surfaces; without this card it is HARD.', &
      parent='SURFACE INTERACTION|CHANGE SURFACE BEHAVIOR', data='none with HARD; LINEAR: stiffness, tension at large ' // &
      'gaps (missing: none; calculix dialect: E/70000), reach; EXPONENTIAL: gap where pressure begins, pressure at ' // &
      'gap zero; TABULAR: pressure, overclosure in each line; TIED: stiffness')
    call table%option('PRESSURE-OVERCLOSURE', VALUE_WORD, 'HARD: no penetration and no tension, exactly (calculix ' // &
      'dialect: LINEAR with 50 times Young''s modulus of the first material). The others give way.', allowed= &
      'HARD|LINEAR|EXPONENTIAL|TABULAR|TIED', default='HARD')
    call table%reject_words('SCALE FACTOR|USER', 'Use HARD, which needs no stiffness.')
    call table%option('PENALTY|AUGMENTED LAGRANGE|DIRECT', VALUE_OPTIONAL_WORD, HARD_CONTACT_TEXT, allowed='LINEAR|NONLINEAR', &
      status=ENTRY_IGNORED)
    call table%option('NO SEPARATION', VALUE_NONE, 'HARD: a node that touched at the end of an increment stays on its ' // &
      'master, and bears tension; abaqus dialect.')
    call table%add_dialect_note('abaqus: HARD is exact; calculix: HARD is LINEAR with 50 E of the first material.')

    call table%card('FRICTION', SCOPE_BOTH, 'Coulomb friction; without this card the surfaces are frictionless.', &
      parent='SURFACE INTERACTION|CHANGE FRICTION', data='coefficient of friction; one line (calculix ' // &
      'dialect: coefficient, stick slope)')
    call table%option('SLIP TOLERANCE|ELASTIC SLIP', VALUE_REAL, 'Under exact contact a node sticks ' // &
      'without any slip, which every tolerance allows; a compliant law has a stick slope of its own.', status=ENTRY_IGNORED)
    call table%option('LAGRANGE', VALUE_NONE, 'Under exact contact sticking is exact; a compliant law has a ' // &
      'stick slope.', status=ENTRY_IGNORED)
    call table%option('ROUGH', VALUE_NONE, 'Surfaces that touch never slip; no data line.')
    call table%option('TAUMAX', VALUE_REAL, 'Largest shear stress, whatever the pressure.')
    call table%option('USER', VALUE_OPTIONAL_WORD, 'Friction is by the user routine FRIC; the data lines are its properties.', &
      allowed='FRIC')
    call table%reject_words('COEFFICIENT', 'Write it as FRIC.')
    call table%option('DEPVAR', VALUE_INTEGER, 'USER: number of STATEV at each slave node.', default='0')
    call table%option('PROPERTIES', VALUE_INTEGER, 'USER: number of properties, in lines of eight.', default='0')
    call table%option('EXPONENTIAL DECAY|ANISOTROPIC|DEPENDENCIES|TEST DATA', VALUE_TEXT, &
      'The coefficient of friction is one constant.', status=ENTRY_REJECTED)
    call table%add_dialect_note('The second number is a slip rate under abaqus, which is refused, and the stick slope under ' // &
      'calculix. A ' // &
      'compliant law without one takes a hundredth of its slope of pressure (abaqus), half of E (calculix).')

    call table%card('SYSTEM', SCOPE_MODEL, 'Without data: coordinates of nodes are in the global axes, as they are ' // &
      'anyway. *NODE, SYSTEM=C or S takes cylindrical and spherical ones.')

    call table%card('CONTACT PAIR', SCOPE_MODEL, 'Two surfaces that may touch, or one that may touch itself.', &
      data='slave surface, master surface')
    call table%option('INTERACTION', VALUE_NAME, 'Their interaction.', default='required')
    call table%option('TYPE', VALUE_WORD, 'How contact is enforced: at the nodes of the slave, or in the mean over its ' // &
      'faces by a dual mortar method (all other words); SURFACE TO SURFACE in the calculix dialect: by springs at points ' // &
      'of its faces.', &
      allowed='NODE TO SURFACE|SURFACE TO SURFACE|MORTAR|LINMORTAR|PGLINMORTAR', default='NODE TO SURFACE')
    call table%reject_words('MASSLESS', 'Use NODE TO SURFACE or SURFACE TO SURFACE.')
    call table%option('SMALL SLIDING', VALUE_NONE, 'Each slave node keeps the facet and the normal of the start ' // &
      'of the step.')
    call table%option('ADJUST', VALUE_TEXT, 'Slave nodes nearer than this distance are moved onto the master, ' // &
      'without stress.')
    call table%option('SMOOTH|EXTENSION ZONE|HCRIT|TRACKING|SUPPLEMENTARY CONSTRAINTS|CPSET|MINIMUM DISTANCE|' // &
      'MECHANICAL CONSTRAINT|WEIGHT|GEOMETRIC CORRECTION', VALUE_TEXT, 'Amontons defines the search and the normals itself.', &
      status=ENTRY_IGNORED)
    call table%option('NO THICKNESS', VALUE_NONE, 'The faces of solids have none.', status=ENTRY_IGNORED)
    call table%option('TIED', VALUE_NONE, 'Abaqus dialect: slave nodes nearer than ADJUST are tied to the master from the ' // &
      'start, as by *TIE with this POSITION TOLERANCE; the others touch nothing.')
    call table%option('OP', VALUE_TEXT, 'Use *MODEL CHANGE, TYPE=CONTACT PAIR.', status=ENTRY_REJECTED)

    call table%card('CLEARANCE', SCOPE_MODEL, 'The gap of a contact pair at the start, whatever the mesh says.')
    call table%add_dialect_note('calculix: without effect on TYPE=NODE TO SURFACE.')
    call table%option('SLAVE', VALUE_NAME, 'Slave surface of the pair.', default='required')
    call table%option('MASTER', VALUE_NAME, 'Its master surface.', default='required')
    call table%option('VALUE', VALUE_REAL, 'The gap; negative is overclosure.', default='required')
    call table%option('TABULAR|BOLT|CPSET', VALUE_TEXT, 'Give one VALUE for the pair.', status=ENTRY_REJECTED)
  end subroutine describe_contact


  !> General contact.
  subroutine describe_general_contact(table)
    type(card_table_type), intent(inout) :: table
    call table%card('CONTACT', SCOPE_MODEL, 'Starts general contact: the faces that may touch are found from the ' // &
      'geometry, and become contact pairs. CONTACT INCLUSIONS and the assignments follow.')
    call table%option('TYPE', VALUE_WORD, 'How contact is enforced, as in CONTACT PAIR (our own parameter).', &
      allowed='NODE TO SURFACE|SURFACE TO SURFACE', default='SURFACE TO SURFACE')
    call table%option('OP', VALUE_TEXT, 'General contact holds for all steps.', status=ENTRY_REJECTED)
    call table%option('REACH', VALUE_REAL, 'How far bodies move towards each other in the job (our own parameter); by ' // &
      'default the largest prescribed displacements of NLGEOM steps, and a twentieth of the extent of the mesh where forces act.')
    call table%card('CONTACT INCLUSIONS', SCOPE_MODEL, 'The faces that may touch each other.', parent='CONTACT', &
      data='surface, surface (none: the first again); a first one that is left out is the whole exterior')
    call table%option('ALL EXTERIOR', VALUE_NONE, 'All free faces of all bodies, and all analytic surfaces.')
    call table%card('CONTACT EXCLUSIONS', SCOPE_MODEL, 'Faces that do not touch each other. Tied faces and those of ' // &
      'CONTACT PAIR are left out without it.', parent='CONTACT', data='surface, surface, as in CONTACT INCLUSIONS')
    call table%card('CONTACT PROPERTY ASSIGNMENT', SCOPE_MODEL, 'Gives faces their interaction; the last line that holds for ' // &
      'two faces counts. Without one contact is exact and frictionless.', parent='CONTACT', &
      data='surface, surface (as in CONTACT INCLUSIONS), interaction')
    call table%card('CONTACT INITIALIZATION DATA', SCOPE_MODEL, 'What becomes of overclosures of general contact at the ' // &
      'start: the slave nodes are moved onto the master, without stress.')
    call table%option('NAME', VALUE_NAME, 'Its name for CONTACT INITIALIZATION ASSIGNMENT.', default='required')
    call table%option('INTERFERENCE FIT', VALUE_NONE, 'They go to zero over the first step, which strains the bodies; ' // &
      'nothing is moved.')
    call table%option('SEARCH ABOVE', VALUE_REAL, 'Slave nodes within this distance before the master are moved, too.', &
      default='0')
    call table%option('SEARCH BELOW', VALUE_REAL, 'Slave nodes deeper in the master are not moved.', default='none')
    call table%option('INITIAL CLEARANCE', VALUE_TEXT, 'Give the two surfaces a *CONTACT PAIR with a *CLEARANCE.', &
      status=ENTRY_REJECTED)
    call table%card('CONTACT INITIALIZATION ASSIGNMENT', SCOPE_MODEL, 'Gives faces their initialization; the last line that ' // &
      'holds for two faces counts. Overclosures without one are pushed out in the first increment.', parent='CONTACT', &
      data='surface, surface (as in CONTACT INCLUSIONS), initialization')
    call table%card('CONTACT FORMULATION', SCOPE_MODEL, 'Says which of two surfaces is the slave; without it ' // &
      'the program chooses.', parent='CONTACT', &
      data='surface, surface (as in CONTACT INCLUSIONS), role of the first: SLAVE or MASTER')
    call table%option('TYPE', VALUE_WORD, 'What is given.', default='required', allowed='MASTER SLAVE ROLES|MAIN SECONDARY ROLES')
    call table%reject_words('EDGE TO EDGE|PURE MASTER-SLAVE|PURE MAIN-SECONDARY', 'Faces touch faces, and of two ' // &
      'surfaces one is the slave: write MASTER SLAVE ROLES.')
    call table%card('SURFACE PROPERTY ASSIGNMENT', SCOPE_MODEL, 'Thickness and place of shells in general contact; solids ' // &
      'lie where the mesh is.', parent='CONTACT', data='surface (none: all), ORIGINAL, or for THICKNESS: THINNING or a ' // &
      'thickness, factor; for OFFSET FRACTION: SPOS, SNEG or -0.5 to 0.5; of solids ORIGINAL or 0.')
    call table%option('PROPERTY', VALUE_WORD, 'What is given. FEATURE EDGE CRITERIA and GEOMETRIC CORRECTION have no effect: ' // &
      'Amontons defines edges and normals itself.', default='required', &
      allowed='THICKNESS|OFFSET FRACTION|FEATURE EDGE CRITERIA|GEOMETRIC CORRECTION')
  end subroutine describe_general_contact


  !> Changes of interactions and pairs by a step.
  subroutine describe_contact_changes(table)
    type(card_table_type), intent(inout) :: table
    call table%card('CHANGE FRICTION', SCOPE_STEP, 'Changes friction from this step on; FRICTION follows.')
    call table%option('INTERACTION', VALUE_NAME, 'The surface interaction.', default='required')
    call table%option('RESET', VALUE_NONE, 'Write the *FRICTION that holds from this step on.', status=ENTRY_REJECTED)
    call table%card('CHANGE SURFACE BEHAVIOR', SCOPE_STEP, 'Changes the law of pressure from this step on; SURFACE ' // &
      'BEHAVIOR follows.')
    call table%option('INTERACTION', VALUE_NAME, 'The surface interaction.', default='required')
    call table%card('MODEL CHANGE', SCOPE_STEP, 'Takes elements or contact pairs out of the model or puts them back, from ' // &
      'this step on.', data='slave surface, master surface; or elements and element sets')
    call table%option('TYPE', VALUE_WORD, 'What is changed.', allowed='CONTACT PAIR|ELEMENT', default='ELEMENT')
    call table%option('ADD', VALUE_OPTIONAL_WORD, 'Puts back; elements start free of strain where their nodes are then, or ' // &
      'with the strain since the start of the job.', allowed='STRAIN FREE|WITH STRAIN', default='STRAIN FREE')
    call table%option('REMOVE', VALUE_NONE, 'Takes out; nodes without elements then stay where they are.')
    call table%option('MECHSTRAINTORESIDUAL', VALUE_NONE, 'Calculix dialect, TYPE=ELEMENT alone: the elements stay, and their ' // &
      'stress goes as the step begins; strain counts from there.')
    call table%card('CHANGE MATERIAL', SCOPE_STEP, 'Changes a material from this step on; CHANGE PLASTIC follows.')
    call table%option('NAME', VALUE_NAME, 'The material.', default='required')
    call table%card('CHANGE PLASTIC', SCOPE_STEP, 'Changes the hardening curve from this step on.', parent='CHANGE MATERIAL', &
      data='yield stress, equivalent plastic strain (the first 0), temperature')
    call table%option('HARDENING', VALUE_WORD, 'As with PLASTIC, which must have the same.', &
      allowed='ISOTROPIC|KINEMATIC|COMBINED', default='ISOTROPIC')
    call table%reject_words('USER', 'Give a table.')
    call table%card('CHANGE SOLID SECTION', SCOPE_STEP, 'Gives the elements of a set another material from this step on.')
    call table%option('ELSET', VALUE_NAME, 'The elements.', default='required')
    call table%option('MATERIAL', VALUE_NAME, 'Their material.', default='required')
    call table%option('ORIENTATION', VALUE_NAME, 'The axes stay those of *SOLID SECTION.', status=ENTRY_REJECTED)
    call table%card('CONTACT INTERFERENCE', SCOPE_STEP, 'An overclosure that is allowed at the start of the step and goes ' // &
      'to zero over it.', data='slave surface, master surface, overclosure; with SHRINK no overclosure')
    call table%option('SHRINK', VALUE_NONE, 'Each node is allowed the overclosure that it has at the start of the step.')
    call table%option('AMPLITUDE|OP|TYPE', VALUE_TEXT, 'The overclosure goes linearly to zero.', status=ENTRY_REJECTED)
  end subroutine describe_contact_changes


  !> Amplitudes and times of output.
  subroutine describe_amplitude(table)
    type(card_table_type), intent(inout) :: table
    call table%card('AMPLITUDE', SCOPE_BOTH, 'Factors over time: a table, linear in between and constant outside, or a formula.', &
      data='time, factor, time, factor, ...; EQUALLY SPACED: factors; PERIODIC: n, omega, t0, A0, then n pairs A, B; ' // &
      'MODULATED: A0, A, t0, omega 1, omega 2; DECAY: A0, A, t0, td')
    call table%option('NAME', VALUE_NAME, 'Name of the amplitude.', default='required')
    call table%option('TIME', VALUE_WORD, 'Time since the start of the step or of the job.', allowed= &
      'STEP TIME|TOTAL TIME', default='STEP TIME')
    call table%option('VALUE', VALUE_WORD, 'The values multiply that of the load, or are the load themselves.', &
      allowed='RELATIVE|ABSOLUTE', default='RELATIVE')
    call table%add_dialect_note('VALUE=ABSOLUTE is ignored under calculix, which does not have it.')
    call table%option('DEFINITION', VALUE_WORD, 'A table; factors at equal distances; a table with smooth steps; Fourier ' // &
      'series; product of two sines; exponential decay; the routine UAMP.', allowed= &
      'TABULAR|EQUALLY SPACED|SMOOTH STEP|PERIODIC|MODULATED|DECAY|USER', default='TABULAR')
    call table%reject_words('SOLUTION DEPENDENT|ACTUATOR|SPECTRUM|BUBBLE', 'Give a table of time and factor.')
    call table%option('FIXED INTERVAL', VALUE_REAL, 'EQUALLY SPACED: the distance of the times.')
    call table%option('INPUT', VALUE_TEXT, 'File with the data lines.')
    call table%option('BEGIN', VALUE_REAL, 'EQUALLY SPACED: the first time.', default='0')
    call table%option('SHIFTX|SHIFTY', VALUE_REAL, 'Added to all times, to all factors.', default='0')
    call table%option('SMOOTH', VALUE_TEXT, 'It rounds the corners of rates, which do not count here.', status=ENTRY_IGNORED)
    call table%option('PROPERTIES', VALUE_INTEGER, 'DEFINITION=USER: number of properties of UAMP, in lines of eight.', &
      default='0')
    call table%option('VARIABLES', VALUE_INTEGER, 'DEFINITION=USER: number of variables that UAMP keeps.', default='0')
    call table%option('USER', VALUE_TEXT, 'Write DEFINITION=USER.', status=ENTRY_REJECTED)

    call table%card('TIME POINTS', SCOPE_BOTH, 'Output times; increments end there. PRINT, FILE and ' // &
      'OUTPUT cards name them.', data='times in ascending order, any number in a line; with GENERATE first, last, distance')
    call table%option('NAME', VALUE_NAME, 'Name of the list.', default='required')
    call table%option('TIME', VALUE_WORD, 'Time since the start of the step or of the job.', allowed= &
      'STEP TIME|TOTAL TIME', default='STEP TIME')
    call table%option('GENERATE', VALUE_NONE, 'Each data line is a range of times.')
  end subroutine describe_amplitude


  !> Nodal directions, and kinematic constraints.
  subroutine describe_couplings(table)
    type(card_table_type), intent(inout) :: table
    call table%card('TRANSFORM', SCOPE_MODEL, 'Gives the degrees of freedom of nodes directions of their own, for ' // &
      '*BOUNDARY, *CLOAD, *EQUATION and *NODE PRINT.', data='TYPE=R: a point on the local x axis, one in the xy ' // &
      'plane; TYPE=C: two points of the axis (directions: out, around, along)')
    call table%option('NSET', VALUE_NAME, 'The nodes.', default='required')
    call table%option('TYPE', VALUE_WORD, 'Rectangular or cylindrical.', allowed='R|C', default='R')
    call table%reject_words('S', 'Use R or C.')

    call table%card('MPC', SCOPE_MODEL, 'Constraints between nodes: PLANE (all nodes stay in the plane of the first ' // &
      'three), STRAIGHT (on the line through the first two), BEAM (calculix: the distance of two nodes stays; ' // &
      'abaqus: the first is fixed rigidly to the second), LINK (their distance stays), TIE and PIN (the first moves ' // &
      'as the second), LINEAR (the first is between the other two), MEANROT (the mean ' // &
      'rotation of the nodes is the first displacement of the last node, whose coordinates are the axis), DIST (a rope: ' // &
      'node, node, node, other, other, other, last node, whose first coordinate is the largest distance).', &
      data='kind, nodes or node sets; of a kind of two nodes, and of LINEAR, also sets of as many nodes, or a set and nodes')
    call table%option('INPUT|USER|MODE', VALUE_TEXT, 'Write the nodes into the deck; in place of a routine MPC use *EQUATION, ' // &
      '*RIGID BODY, *COUPLING or *USER ELEMENT.', status=ENTRY_REJECTED)
    call table%add_dialect_note('BEAM: abaqus fixes the first node rigidly to the second; calculix keeps their distance. ' // &
      'PLANE, STRAIGHT, BEAM and DIST turn NLGEOM on for all steps under calculix.')

    call table%card('RIGID BODY', SCOPE_MODEL, 'Nodes that move with a reference node (4 to 6: its rotation vector).')
    call table%option('REF NODE', VALUE_NAME, 'The reference node.', default='required')
    call table%option('NSET', VALUE_NAME, 'The nodes; or')
    call table%option('ELSET', VALUE_NAME, 'the elements whose nodes are taken.')
    call table%option('ANALYTICAL SURFACE', VALUE_NAME, 'A surface of TYPE SEGMENTS, CYLINDER or REVOLUTION that moves along.')
    call table%option('ROT NODE', VALUE_NAME, 'A node whose displacement is the rotation vector.')
    call table%option('PIN NSET', VALUE_NAME, 'The nodes without rotations: a hinge of shells and beams.')
    call table%option('TIE NSET', VALUE_NAME, 'The nodes with the rotations of shells and beams.')
    call table%option('POSITION', VALUE_WORD, 'Where the reference node is: where *NODE says.', allowed='INPUT', default='INPUT')
    call table%reject_words('CENTER OF MASS', 'Give the reference node its place.')
    call table%option('ISOTHERMAL|DENSITY|OFFSET|NODAL THICKNESS', VALUE_TEXT, 'A rigid body has neither mass nor thickness.', &
      status=ENTRY_IGNORED)
    call table%add_dialect_note('NSET: with the rotations of shells and beams in the abaqus dialect, without them under calculix.')

    call table%card('COUPLING', SCOPE_MODEL, 'Couples a surface to a reference node; *KINEMATIC or *DISTRIBUTING follows.')
    call table%option('REF NODE', VALUE_NAME, 'The reference node.', default='required')
    call table%option('SURFACE', VALUE_NAME, 'The surface.', default='required')
    call table%option('ORIENTATION', VALUE_NAME, 'Directions: of the nodes of the surface (KINEMATIC), or of the ' // &
      'reference node (DISTRIBUTING).')
    call table%option('CONSTRAINT NAME', VALUE_NAME, 'A name.')
    call table%option('INFLUENCE RADIUS', VALUE_REAL, 'Name a surface with exactly these nodes.', status=ENTRY_REJECTED)
    call table%option('ALPHA', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%card('KINEMATIC', SCOPE_MODEL, 'The nodes move with the reference node as a rigid body, in these directions.', &
      parent='COUPLING', data='first and last degree of freedom (1 to 3; rotations of solids do not exist); none: all')
    call table%card('DISTRIBUTING', SCOPE_MODEL, 'The reference node moves with the mean rigid motion of the surface; its ' // &
      'forces and moments spread over the surface.', parent='COUPLING', &
      data='first and last degree of freedom; of the rotations only those named are bound; none: all')
    call table%option('COUPLING|WEIGHTING METHOD', VALUE_TEXT, 'Nodes weigh by their area.', status=ENTRY_IGNORED)
    call table%option('CYCLIC SYMMETRY', VALUE_NONE, 'Couple the whole surface.', status=ENTRY_REJECTED)

    call table%card('TIE', SCOPE_MODEL, 'Makes two surfaces one: the nodes of the slave stay where they are on the faces ' // &
      'of the master; of a master of nodes (abaqus dialect) they move with the nearest one.', data='slave surface, master surface')
    call table%option('NAME', VALUE_NAME, 'A name.', default='required')
    call table%option('POSITION TOLERANCE', VALUE_REAL, 'Nodes farther from the master are not tied.', &
      default='2.5 % of the mean edge of the master''s faces, 5 % of the mean distance of its nodes')
    call table%option('ADJUST', VALUE_WORD, 'Moves tied nodes onto the master before the start.', allowed='YES|NO', &
      default='YES')
    call table%option('CYCLIC SYMMETRY', VALUE_NONE, 'The slave side moves as the master side, turned by the angle of a ' // &
      'sector; see *CYCLIC SYMMETRY MODEL. The surfaces may be of nodes.')
    call table%option('MULTISTAGE|FLUID PERIODIC|FLUID CYCLIC', VALUE_NONE, 'Model the whole body.', &
      status=ENTRY_REJECTED)
    call table%option('TIED NSET|NO ROTATION|NO THICKNESS|CONSTRAINT RATIO|CYCLIC', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%option('TYPE', VALUE_WORD, 'How the surfaces are tied.', &
      allowed='NODE TO SURFACE|SURFACE TO SURFACE', default='NODE TO SURFACE')

    call table%card('CYCLIC SYMMETRY MODEL', SCOPE_MODEL, 'The model is one of N equal sectors in the circle, loaded alike.', &
      data='two points of the axis: x, y, z, x, y, z')
    call table%option('N', VALUE_INTEGER, 'Sectors in the circle.', default='required')
    call table%option('TIE', VALUE_NAME, 'The *TIE, CYCLIC SYMMETRY of both sides.', default='required')
    call table%option('ELSET|NGRAPH|CHECK', VALUE_TEXT, 'One sector is computed and written.', status=ENTRY_IGNORED)

    call table%card('KINEMATIC COUPLING', SCOPE_MODEL, 'Nodes move with a reference node as a rigid body, in these directions.', &
      data='node or node set, first and last degree of freedom (1 to 3; rotations of solids do not exist)')
    call table%option('REF NODE', VALUE_NAME, 'The reference node.', default='required')
    call table%option('ORIENTATION', VALUE_NAME, 'Directions at the nodes.')

    call table%card('DISTRIBUTING COUPLING', SCOPE_MODEL, 'A node moves with the weighted mean rigid body motion of others; its ' &
      // 'force and moment spread over them by their weights. Calculix dialect: the force alone.', data='node or node set, weight')
    call table%option('ELSET', VALUE_NAME, 'Set of one element DCOUP3D (DCOUP2D), whose node is the one bound.', &
      default='required')

    call table%card('PRE-TENSION SECTION', SCOPE_MODEL, 'Cuts a body open at the faces of a surface; the first ' // &
      'displacement of the pre-tension node is the overlap along the normal, a force on it the pre-tension.', &
      data='normal; without it that of the faces, out of their elements: a positive force then pulls the two sides together')
    call table%option('SURFACE', VALUE_NAME, 'Faces of the elements on one side of the section; or')
    call table%option('ELEMENT', VALUE_NAME, 'a truss T3D2 or a beam, cut at its second end; in the calculix ' // &
      'dialect the beam itself does not count, as there.')
    call table%option('NODE', VALUE_NAME, 'The pre-tension node.', default='required')
  end subroutine describe_couplings


  !> Prescribed displacements, forces, pressures, gravity.
  subroutine describe_loads(table)
    type(card_table_type), intent(inout) :: table
    character(*), parameter :: TIME_DELAY_TEXT = 'The amplitude runs this much later.'
    call table%card('BOUNDARY', SCOPE_BOTH, 'Prescribes displacements; before the first step it goes to them ' // &
      'linearly over the first step, of whatever kind.', &
      data='node or node set, first and last degree of freedom (1 to 3), displacement; or node and a ' // &
      'word: PINNED (1 to 3), ENCASTRE (1 to 6), XSYMM (1, 5, 6), YSYMM (2, 4, 6), ZSYMM (3, 4, 5), XASYMM (2, 3, 4), ' // &
      'YASYMM (1, 3, 5) or ZASYMM (1, 2, 6); 4 to 6 are the rotations of the reference nodes of rigid bodies and couplings')
    call table%option('OP', VALUE_WORD, 'NEW releases what earlier steps prescribed.', allowed='MOD|NEW', default='MOD')
    call table%option('AMPLITUDE', VALUE_NAME, 'Factor over time; without it the displacement grows linearly over ' // &
      'the step, in VISCO steps it acts at once.')
    call table%option('FIXED', VALUE_NONE, 'Keeps the displacement that the nodes have at the start of the step.')
    call table%option('TYPE', VALUE_WORD, 'What is prescribed. VELOCITY: the displacement grows by the integral of the ' // &
      'velocity, which is constant over the step unless it has an amplitude.', allowed='DISPLACEMENT|VELOCITY', &
      default='DISPLACEMENT')
    call table%reject_words('ACCELERATION', 'Prescribe displacements.')
    call table%option('TIME DELAY', VALUE_REAL, TIME_DELAY_TEXT, default='0')
    call table%option('USER', VALUE_NONE, 'The routine DISP of the user gives the displacements.')
    call describe_load_case(table)
    call table%option('MASSLESS|MODEL', VALUE_TEXT, 'Inertia does not count.', status=ENTRY_IGNORED)
    call describe_global_step(table, 'The displacements')
    call table%option('REGION TYPE|BASE NAME', VALUE_TEXT, 'Give the displacements themselves.', status=ENTRY_REJECTED)

    call table%card('CLOAD', SCOPE_STEP, 'Forces on nodes.', data='node or node set, degree of freedom (1 to 3), force')
    call table%option('OP', VALUE_WORD, 'NEW lets the forces of earlier steps go to zero.', allowed='MOD|NEW', &
      default='MOD')
    call table%option('AMPLITUDE', VALUE_NAME, 'Factor over time; without it the force grows linearly over the step, ' // &
      'in VISCO steps it acts at once.')
    call table%option('TIME DELAY', VALUE_REAL, TIME_DELAY_TEXT, default='0')
    call describe_load_case(table)
    call table%option('OMEGA0', VALUE_TEXT, 'The sectors do not turn.', status=ENTRY_IGNORED)
    call table%option('FOLLOWER', VALUE_NONE, 'Under NLGEOM the force turns with its node (of shells and beams, reference ' // &
      'nodes of rigid bodies and *KINEMATIC couplings); its components are those of the undeformed state.')
    call table%option('USER', VALUE_NONE, 'Give the forces an AMPLITUDE; it may be by the routine UAMP.', status=ENTRY_REJECTED)
    call table%option('SUBMODEL|STEP|DATA SET', VALUE_TEXT, 'Forces are not taken from a global model: drive the ' // &
      'displacements of the cut by *BOUNDARY, SUBMODEL; their reactions RF are the forces.', status=ENTRY_REJECTED)
    call table%option('CYCLIC MODE|REGION TYPE', VALUE_TEXT, 'Write the forces themselves.', status=ENTRY_REJECTED)

    call table%card('DLOAD', SCOPE_STEP, 'Pressure on element faces, positive when it pushes into the element, gravity, ' // &
      'rotation and body forces.', data='element or element set, P1 to P6, pressure; calculix dialect: P1NP to P6NP, ' // &
      'node, whose prescribed displacement 2 is the pressure; or surface, P, pressure; or ' // &
      'element or element set, GRAV, acceleration, direction x, y, z; CENTRIF, square of the angular velocity, point ' // &
      'x, y, z and direction x, y, z of the axis; BX, BY, BZ or BR, force per volume; without a region the whole model; ' // &
      'abaqus dialect: TRVECn or TRSHRn, traction on face n, direction x, y, z, as of DSLOAD; with NU by a user routine')
    call describe_distributed(table)
    call table%card('DSLOAD', SCOPE_STEP, 'Pressure on a surface, positive when it pushes into the body; traction, a force per ' &
      // &
      'area of the undeformed surface in a direction that stays.', data= &
      'surface, P, pressure; surface, TRVEC, magnitude, direction x, y, z; surface, TRSHR, magnitude, a direction, ' // &
      'whose part along each face counts; PNU, TRVECNU, TRSHRNU: by a user routine')
    call describe_distributed(table)
  end subroutine describe_loads


  !> What loads and supports share: the words for vibrations and for sectors, of which statics has the first.
  subroutine describe_load_case(table)
    type(card_table_type), intent(inout) :: table
    call table%option('LOAD CASE', VALUE_WORD, 'The real part of a load; in statics there is no other.', allowed='1', &
      default='1')
    call table%reject_words('2', 'Only vibrations have an imaginary part.')
    call table%option('SECTOR', VALUE_WORD, 'The sector of a cyclic structure.', allowed='1', default='1')
    call table%reject_words('2|3|4|5|6|7|8|9|10|11|12', 'All sectors are loaded alike.')
  end subroutine describe_load_case


  !> What DLOAD and DSLOAD share.
  subroutine describe_distributed(table)
    type(card_table_type), intent(inout) :: table
    call table%option('OP', VALUE_WORD, 'NEW lets the loads of earlier steps go to zero.', allowed='MOD|NEW', default= &
      'MOD')
    call table%option('AMPLITUDE', VALUE_NAME, 'Factor over time; without it the load grows linearly over the step, ' // &
      'in VISCO steps it acts at once.')
    call table%option('FOLLOWER', VALUE_WORD, 'Under NLGEOM a pressure follows the face (YES), a traction does not (NO, which ' // &
      'TRVEC and TRSHR then need).', allowed='YES|NO', default='YES')
    call table%option('CONSTANT RESULTANT', VALUE_WORD, 'Under NLGEOM a traction is per undeformed area, so that TRVEC ' // &
      'and TRSHR need YES.', allowed='YES|NO', default='NO')
    call table%option('TIME DELAY', VALUE_REAL, 'The amplitude runs this much later.', default='0')
    call describe_load_case(table)
    call table%option('SUBMODEL|STEP|DATA SET', VALUE_TEXT, 'Stresses are not taken from a global model: drive the ' // &
      'displacements of the cut by *SUBMODEL, TYPE=NODE and *BOUNDARY, SUBMODEL.', status=ENTRY_REJECTED)
    call table%option('CYCLIC MODE|REGION TYPE|ORIENTATION|REF NODE', VALUE_TEXT, 'Give pressures on faces.', &
      status=ENTRY_REJECTED)
  end subroutine describe_distributed


  !> Steps, the procedure, the line search.
  subroutine describe_steps(table)
    type(card_table_type), intent(inout) :: table
    character(*), parameter :: NOT_NEEDED_TEXT = 'Newton''s method does not use this setting.'
    call table%card('STEP', SCOPE_BOTH, 'Starts a load step; a line of text after it is its title.', data='free text')
    call table%option('NLGEOM', VALUE_OPTIONAL_WORD, 'Finite displacements and strains, in this step and all ' // &
      'later ones.', allowed='YES|NO', default='as in the step before')
    call table%option('INC', VALUE_INTEGER, 'Most increments of the step.', default='100')
    call table%option('AMPLITUDE', VALUE_WORD, 'Loads without an amplitude grow linearly, or act in full at once.', &
      allowed='RAMP|STEP', default='RAMP; with VISCO: STEP')
    call table%option('NAME', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%option('UNSYMM|CONVERT SDI|EXTRAPOLATION|SOLVER', VALUE_TEXT, NOT_NEEDED_TEXT, status=ENTRY_IGNORED)
    call table%option('PERTURBATION', VALUE_NONE, 'The linear response to the loads of this step alone, which do not act in ' // &
      'later steps; of linear models, before any general step. Calculix dialect: the only step.')
    call table%option('THERMAL STEADY STATE', VALUE_TEXT, 'There is no flow of heat.', status=ENTRY_IGNORED)

    call table%card('STATIC', SCOPE_STEP, 'The step is quasi-static.', &
      data='first increment, length of the step, least increment, largest increment; all optional; RIKS: first arc, arc of ' // &
      'the step, least arc, largest arc, largest load proportionality factor, node, degree of freedom, displacement')
    call describe_static(table)
    call table%card('NO ANALYSIS', SCOPE_STEP, 'The deck is read and checked, as by amontons --check; nothing is solved.')

    call table%card('VISCO', SCOPE_STEP, 'The step is quasi-static, and materials creep. Loads and supports without ' // &
      'an amplitude act in full from its start (STEP, AMPLITUDE=RAMP: they grow linearly).', &
      data='first increment, length of the step, least increment, largest increment; all optional')
    call describe_static(table)
    call table%option('CETOL', VALUE_REAL, 'Most difference of the creep strains of an increment by the conditions at its end ' // &
      'and at its start: longer increments are cut back, and the next one is as long as this allows.', &
      default='with CREEP no increment is longer than the first')
    call table%option('CREEP', VALUE_WORD, 'Creep is always integrated implicitly.', status=ENTRY_IGNORED)

    call describe_dynamic(table)

    call table%card('LINE SEARCH', SCOPE_STEP, 'The one-step line search of contact, in this step and all later ones ' // &
      '(specific to Amontons).')
    call table%option('TYPE', VALUE_WORD, 'NONE: full steps; ALL: one length from all unknowns; GLOBAL: one ' // &
      'length from the slave nodes; NODAL: a length for each slave node; AUTO: automatic.', allowed= &
      'NONE|ALL|GLOBAL|NODAL|AUTO', default='required')
    call table%option('DIRECTION', VALUE_WORD, 'For studies. EXACT: by the consistent tangent; SYMMETRIC: without the ' // &
      'unsymmetric terms of friction and sliding; LAGGED: by the stiffness of the bodies at the start of the attempt.', &
      allowed='EXACT|SYMMETRIC|LAGGED', default='EXACT')
    call table%option('INTERFACE', VALUE_WORD, 'For studies. DENSE: the contact subproblem is solved on the dense matrix of ' // &
      'the interface; SKIN: iteratively, with the contact skin as preconditioner; AUTO: the ' // &
      'cheaper one by the unknowns of interface and model; above 6000 of the interface SKIN.', &
      allowed='AUTO|DENSE|SKIN', default='AUTO')

    call table%card('SOLVER CONTROLS', SCOPE_STEP, 'The solver STATIC, SOLVER=CONJUGATE GRADIENTS, in this step and all later ' // &
      'ones; no other solver uses it.', data='residual of a round over that at its start while statuses change, most ' // &
      'iterations of an increment, most rounds; a blank field keeps its value')
    call table%option('PRECONDITIONER', VALUE_WORD, 'NODAL (specific to Amontons, as the others): the stiffness of each node; ' // &
      'DIAGONAL: its diagonal; neither assembles a matrix. TWO LEVEL: incomplete factor and rigid motions of parts; AMG: ' // &
      'algebraic multigrid of PETSc (amontons-mpi); FACTOR: the factor of the tangent at the start of the increment.', &
      allowed='NODAL|DIAGONAL|TWO LEVEL|AMG|FACTOR', default='NODAL')
    call table%option('RESET', VALUE_NONE, 'Back to the defaults.')
    call table%option('ANALYSIS', VALUE_TEXT, 'The defaults serve contact.', status=ENTRY_IGNORED)

    call table%card('RESTART', SCOPE_BOTH, 'Keeps states in the restart file job.res, from which another job can continue. ' // &
      '(To continue the same deck after a crash, use amontons --resume job without this card.)')
    call table%option('WRITE', VALUE_NONE, 'States are kept from this step on, with the deck, in job.res.')
    call table%option('FREQUENCY', VALUE_INTEGER, 'Every n-th increment and the last of each step; 0: none. Under the ' // &
      'calculix dialect the last of every n-th step.', default='1')
    call table%option('OVERLAY', VALUE_NONE, 'Of each step the last state alone is kept; under the calculix dialect the last ' // &
      'of all.')
    call table%option('READ', VALUE_NONE, 'The deck continues from the restart file of another job: amontons new oldjob=old ' // &
      'reads old.res; without oldjob new.rin is read, a copy of it. It holds new steps, and before them sets, surfaces, ' // &
      'amplitudes and time points.')
    call table%option('STEP', VALUE_INTEGER, 'READ: the step from which to continue.', default='the last')
    call table%option('INC', VALUE_INTEGER, 'READ: its increment. The rest of the step is done first.', default='the last')
    call table%option('END STEP', VALUE_NONE, 'READ: the step ends at that increment, with the loads that it has reached.')
    call table%option('ITERATION', VALUE_TEXT, 'There is one state for an increment.', status=ENTRY_IGNORED)
    call table%option('NUMBER INTERVAL|TIME MARKS', VALUE_TEXT, 'States are kept as FREQUENCY says.', status=ENTRY_IGNORED)

    call table%card('END STEP', SCOPE_STEP, 'Ends the step.')
  end subroutine describe_steps


  !> The parameters common to STATIC and VISCO.
  subroutine describe_static(table)
    type(card_table_type), intent(inout) :: table
    call table%option('DIRECT', VALUE_OPTIONAL_WORD, 'All increments are as long as the first one.', &
      allowed='YES|NO|NO STOP')
    call table%option('SOLVER', VALUE_TEXT, 'ITERATIVE CHOLESKY, ITERATIVE SCALING: by iteration, without a factor; ' // &
      'CONJUGATE GRADIENTS (specific to Amontons): nonlinear, without a matrix, see SOLVER CONTROLS; GAMG, HYPRE, MUMPS ' // &
      '(amontons-mpi): distributed over the ranks; any other: as the program finds best.', default='as the program finds best')
    call table%option('TIME RESET', VALUE_NONE, 'The total time at the end of the step is that at its start.')
    call table%option('TOTAL TIME AT START', VALUE_REAL, 'The total time at the start of the step.', default= &
      'that at the end of the step before')
    call table%option('EXPLICIT', VALUE_TEXT, 'There is no flow.', status=ENTRY_IGNORED)
    call table%option('STABILIZE', VALUE_OPTIONAL_REAL, 'Volumetric damping stabilizes the step at a loss of stability: the ' // &
      'part of the strain energy that it would dissipate if the step continued like its first increment.', default= &
      'no damping; alone: 0.0002')
    call table%option('FACTOR', VALUE_REAL, 'STABILIZE: the damping itself, a force per volume and velocity.')
    call table%option('CONTINUE', VALUE_OPTIONAL_WORD, 'STABILIZE: with the factor of the step before.', allowed='YES|NO', &
      default='NO')
    call table%option('ALLSDTOL', VALUE_TEXT, 'The factor is constant in the step; history/damped_work has the dissipated ' // &
      'work.', status=ENTRY_IGNORED)
    call table%add_dialect_note('STABILIZE is ignored under calculix, which does not have it.')
    call table%option('LONG TERM', VALUE_NONE, 'STATIC: viscoelastic materials are relaxed.', default='they respond at once')
    call table%option('ADIABATIC', VALUE_TEXT, 'Only heat uses it, which is refused.', status=ENTRY_IGNORED)
    call table%option('RIKS', VALUE_NONE, 'The loads of the step follow the path of equilibria past limit points, by the ' // &
      'arc-length method; the last step of the deck.')
    call table%option('FULLY PLASTIC', VALUE_TEXT, 'Choose the length of the step instead.', status=ENTRY_REJECTED)
  end subroutine describe_static


  !> DYNAMIC: the quasi-static application alone.
  subroutine describe_dynamic(table)
    type(card_table_type), intent(inout) :: table
    character(*), parameter :: ELSE_TEXT = 'Waves and vibration are not resolved: only QUASI-STATIC is computed. For slow ' // &
      'loads use *STATIC with the same loads and amplitudes, for a known acceleration *DLOAD with GRAV; vibration and impact ' // &
      'need a program for dynamics.'
    call table%card('DYNAMIC', SCOPE_STEP, 'With APPLICATION=QUASI-STATIC: inertia carries bodies through falls, snaps and ' // &
      'buckling to rest, by backward Euler with the consistent mass of *DENSITY.', &
      data='first increment, length of the step, least increment, largest increment; all optional')
    call table%option('APPLICATION', VALUE_WORD, 'What the motion is for.', allowed='QUASI-STATIC')
    call table%reject_words('TRANSIENT FIDELITY|MODERATE DISSIPATION', ELSE_TEXT)
    call table%option('DIRECT', VALUE_OPTIONAL_WORD, 'All increments are as long as the first one.', allowed='YES|NO|NO STOP')
    call table%option('TIME INTEGRATOR', VALUE_WORD, 'BWE: backward Euler.', allowed='BWE', default='BWE')
    call table%reject_words('HHT-TF|HHT-MD', 'Backward Euler is the only rule: leave out TIME INTEGRATOR.')
    call table%option('INITIAL|IMPACT', VALUE_OPTIONAL_WORD, 'Backward Euler needs no acceleration at the start or at an impact.', &
      status=ENTRY_IGNORED)
    call table%option('HAFTOL|HALFINC SCALE FACTOR|NOHAF', VALUE_TEXT, 'Increments follow the iterations, as in *STATIC.', &
      status=ENTRY_IGNORED)
    call table%option('ADIABATIC', VALUE_TEXT, 'There is no flow of heat.', status=ENTRY_IGNORED)
    call table%option('ALPHA|BETA|GAMMA', VALUE_TEXT, 'Backward Euler has no such parameter.', status=ENTRY_REJECTED)
    call table%option('EXPLICIT|SUBSPACE|FIXED TIME INCREMENTATION|DIRECT USER CONTROL|ELEMENT BY ELEMENT|RELATIVE TO ABSOLUTE', &
      VALUE_TEXT, ELSE_TEXT, status=ENTRY_REJECTED)
  end subroutine describe_dynamic


  !> The controls of a step.
  subroutine describe_controls(table)
    type(card_table_type), intent(inout) :: table
    call table%card('CONTROLS', SCOPE_BOTH, 'Changes how a step is solved, in this step and all later ones; in the ' // &
      'model, in all steps.', data= &
      'TIME INCREMENTATION: I0, IR, IP, IC, IL, IG, -, IA; second line DF, DC, DB, DA, -, -, DD. FIELD: Rn, Cn, -, ' // &
      '-, Rp, -, -, Rl. LINE SEARCH: -, s max, s min. GAP: penetration allowed over the edge of a facet. A blank ' // &
      'field keeps its value.')
    call table%option('PARAMETERS', VALUE_WORD, 'What is changed.', &
      allowed='TIME INCREMENTATION|FIELD|LINE SEARCH|GAP|CONTACT|CONSTRAINTS')
    call table%reject_words('VCCT LINEAR SCALING|DIRECT CYCLIC|CFD', &
      'Use TIME INCREMENTATION, FIELD or LINE SEARCH.')
    call table%option('RESET', VALUE_NONE, 'Back to the defaults.')
    call table%option('ANALYSIS|TYPE', VALUE_TEXT, 'The defaults serve contact.', status=ENTRY_IGNORED)
    call table%option('FIELD', VALUE_WORD, 'The field that the numbers are for; displacements are the only one ' // &
      'here, and the numbers of others have no effect.', allowed='DISPLACEMENT|GLOBAL|' // &
      'ROTATION|TEMPERATURE|PORE FLUID PRESSURE|ELECTRICAL POTENTIAL|HYDROSTATIC FLUID PRESSURE|CONCENTRATION|WARPING|' // &
      'MATERIAL FLOW|PRESSURE LAGRANGE MULTIPLIER|VOLUMETRIC LAGRANGE MULTIPLIER', default='DISPLACEMENT')
    call table%add_dialect_note('The defaults under calculix are near those of CalculiX, under abaqus tighter; --explain ' // &
      'shows them.')
  end subroutine describe_controls


  !> Requests for the .dat file.
  subroutine describe_prints(table)
    type(card_table_type), intent(inout) :: table
    call table%card('NODE PRINT', SCOPE_STEP, 'Prints values of nodes to the .dat file.', data='variables: U, RF, NT, COORD')
    call describe_print(table)
    call table%option('NSET', VALUE_NAME, 'The nodes.', default='all (abaqus), required (calculix)')
    call table%option('GLOBAL', VALUE_WORD, 'Values are in global directions, or in those of *TRANSFORM.', &
      allowed='YES|NO', default='YES (abaqus), NO (calculix)')
    call table%option('SUMMARY', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%add_dialect_note('RF: abaqus the reactions of supports; calculix the internal forces. GLOBAL: YES or NO by default.')

    call table%card('EL PRINT', SCOPE_STEP, 'Prints values of integration points to the .dat file.', data= &
      'variables: S, E, ME (without the thermal strain), PEEQ, CEEQ, SDEG, DMICRT, ENER, ELSE, EVOL, COORD')
    call describe_print(table)
    call table%option('ELSET', VALUE_NAME, 'The elements.', default='all (abaqus), required (calculix)')
    call table%option('GLOBAL', VALUE_WORD, 'Tensors are in global directions, or in the axes of the section.', &
      allowed='YES|NO', default='NO')
    call table%option('SUMMARY', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%option('POSITION', VALUE_TEXT, 'Values are at the integration points; those at nodes are in the result file.', &
      status=ENTRY_IGNORED)

    call table%card('CONTACT PRINT', SCOPE_STEP, 'Prints values of slave nodes, and sums over pairs, to the .dat file.', &
      data='variables: CDIS, CSTR, CELS, CNUM, SCEN; sums over each pair: CF (CFT, CMT, XT, CAREA), CFN (CMN, XN), CFS (CMS, XS)')
    call describe_print(table)
    call table%option('NSET', VALUE_NAME, 'Only these slave nodes; else all.')
    call table%option('SLAVE', VALUE_NAME, 'Only pairs with this slave surface.')
    call table%option('MASTER', VALUE_NAME, 'Only pairs with this master surface.')
    call table%option('SET', VALUE_NAME, 'All slave nodes are printed.', status=ENTRY_IGNORED)
    call table%option('SUMMARY', VALUE_TEXT, '', status=ENTRY_IGNORED)

    call table%card('SECTION PRINT', SCOPE_STEP, 'Prints the force and the moment that the stress transmits through a ' // &
      'surface, its area, centre and mean normal to the .dat file.', data='variables: SOF, SOM, SOAREA; each of them ' // &
      'prints all')
    call table%option('SURFACE', VALUE_NAME, 'A surface of element faces.', default='required')
    call table%option('NAME', VALUE_NAME, 'Name of the section, which is not needed.')
    call table%option('FREQUENCY', VALUE_INTEGER, 'Every n-th increment and the last one of the step; 0 none.', &
      default='1')
    call table%option('FREQUENCYF', VALUE_TEXT, 'There is no flow.', status=ENTRY_IGNORED)
    call table%option('AXES|UPDATE|OP', VALUE_TEXT, 'Vectors are in global directions.', status=ENTRY_IGNORED)
  end subroutine describe_prints


  !> The parameters common to the PRINT cards.
  subroutine describe_print(table)
    type(card_table_type), intent(inout) :: table
    call table%option('FREQUENCY', VALUE_INTEGER, 'Every n-th increment and the last one of the step; 0 none.', &
      default='1')
    call table%option('FREQUENCYF', VALUE_TEXT, 'There is no flow.', status=ENTRY_IGNORED)
    call table%option('MODE|LAST MODE', VALUE_TEXT, 'There are no eigenmodes.', status=ENTRY_IGNORED)
    call table%option('TOTALS', VALUE_WORD, 'Prints the sum too, or only the sum.', allowed='NO|YES|ONLY', default='NO')
    call table%option('TIME POINTS', VALUE_NAME, 'Only at these times of *TIME POINTS, and at the end of the step.')
  end subroutine describe_print


  !> Requests for the result file.
  subroutine describe_files(table)
    type(card_table_type), intent(inout) :: table
    character(*), parameter :: NAMES(9) = [character(14) :: 'NODE FILE', 'NODE OUTPUT', 'EL FILE', 'EL OUTPUT', &
      'ELEMENT OUTPUT', 'CONTACT FILE', 'CONTACT OUTPUT', 'ENERGY OUTPUT', 'ENERGY FILE']
    character(*), parameter :: ALL_FIELDS = 'The result file holds all fields at all nodes.'
    integer :: i
    do i = 1, size(NAMES)
      call table%card(trim(NAMES(i)), SCOPE_STEP, 'Requests results: job.vtkhdf always holds all fields; under the calculix ' // &
        'dialect job.frd holds the requested ones.', data='variables: U, RF, NT; S, E, ME, THE, PEEQ, ENER, SDV, ERR, NOE; ' // &
        'CDIS, CSTR, CELS')
      call table%option('FREQUENCY', VALUE_INTEGER, 'Every n-th increment and the last one of the step.', default='1')
      call table%option('TIME POINTS', VALUE_NAME, 'Only at these times of *TIME POINTS, and at the end of the step.')
      call table%option('FREQUENCYF', VALUE_TEXT, 'There is no flow.', status=ENTRY_IGNORED)
      call table%option('GLOBAL', VALUE_WORD, 'NO: job.frd has vectors in the directions of *TRANSFORM, tensors in the axes ' // &
        'of the section.', allowed='YES|NO', default='YES')
      call table%option('NSET', VALUE_NAME, 'Calculix dialect: job.frd has these variables at these nodes alone.', &
        default='all nodes')
      call table%option('ELSET|SET|SLAVE|MASTER|SURFACE|INTERACTION', VALUE_NAME, ALL_FIELDS, status=ENTRY_IGNORED)
      call table%option('OUTPUT|OUTPUT ALL|POSITION|VARIABLE|DIRECTIONS|LAST ITERATIONS|CONTACT ELEMENTS|' // &
        'EXTERIOR|SECTION FORCES|TOTALS|MODE|REBAR|ELASTIC', VALUE_TEXT, '', status=ENTRY_IGNORED)
    end do
    call table%card('OUTPUT', SCOPE_STEP, 'Requests results in the file; it always holds all fields.', data='none')
    call table%option('FIELD|HISTORY|DIAGNOSTICS', VALUE_NONE, 'Kind of output.')
    call table%option('FREQUENCY', VALUE_INTEGER, 'Every n-th increment and the last one of the step.', default='1')
    call table%option('TIME POINTS', VALUE_NAME, 'Only at these times of *TIME POINTS, and at the end of the step.')
    call table%option('NUMBER INTERVAL|TIME INTERVAL', VALUE_TEXT, 'Use FREQUENCY or TIME POINTS.', status=ENTRY_IGNORED)
    call table%option('NAME|OP|VARIABLE|TIME MARKS|MODE LIST|FILTER', VALUE_TEXT, '', status=ENTRY_IGNORED)
  end subroutine describe_files


  !> Cards that cannot change the solution.
  subroutine describe_ignored(table)
    type(card_table_type), intent(inout) :: table
    call table%cards_with(ENTRY_IGNORED, 'HOURGLASS STIFFNESS', 'The stiffness of one-point elements against hourglass modes ' // &
      'follows from their material.')
    call table%cards_with(ENTRY_IGNORED, 'PREPRINT|MONITOR|PRINT|ENERGY PRINT|FILE FORMAT|FILE OUTPUT|SECTION FILE|' // &
      'SECTION OUTPUT|FACE PRINT|INTEGRATED OUTPUT|INTEGRATED OUTPUT SECTION|INCREMENTATION OUTPUT|MODAL FILE|MODAL OUTPUT|' // &
      'MODAL PRINT|RADIATION FILE|RADIATION OUTPUT|RADIATION PRINT|SURFACE OUTPUT|USER OUTPUT VARIABLES|ELEMENT RESPONSE|' // &
      'NODE RESPONSE|CONTACT RESPONSE|ELEMENT MATRIX OUTPUT|MATRIX OUTPUT|DIAGNOSTICS|FILTER|DATA CHECK|DISPLAY BODY|' // &
      'LOAD CASE NAME|END LOAD CASE NAME|FAIL STRAIN|FAIL STRESS', 'Amontons does not write this output; the result file ' // &
      'holds all fields, and forces and moments are in its tables.')
    call table%cards_with(ENTRY_IGNORED, 'CONDUCTIVITY|SPECIFIC HEAT|LATENT HEAT|INELASTIC HEAT FRACTION|' // &
      'ELECTRICAL CONDUCTIVITY|JOULE HEAT FRACTION|MAGNETIC PERMEABILITY|FLUID CONSTANTS|SPECIFIC GAS CONSTANT|' // &
      'PHYSICAL CONSTANTS|ABSOLUTE ZERO|GAP CONDUCTANCE|GAP HEAT GENERATION|EMISSIVITY', 'There is no flow of ' // &
      'heat here, so it has no effect.')
    call table%cards_with(ENTRY_IGNORED, 'DASHPOT|DAMPING|GLOBAL DAMPING|MODAL DAMPING|CONTACT DAMPING|BULK VISCOSITY|' // &
      'FIXED MASS SCALING', 'It has no effect: rates do not count in quasi-static steps, and backward Euler alone damps ' // &
      '*DYNAMIC, APPLICATION=QUASI-STATIC.')
    call table%cards_with(ENTRY_IGNORED, 'CONTACT CONTROLS|CONTACT CONTROLS ASSIGNMENT|CONTACT STABILIZATION|' // &
      'SOLUTION TECHNIQUE|CONSTRAINT CONTROLS', 'Contact and the solver of Amontons do not use ' // &
      'these settings.')
  end subroutine describe_ignored


  !> Materials, temperatures and directions that are not supported.
  subroutine describe_rejected_materials(table)
    type(card_table_type), intent(inout) :: table
    call table%cards_with(ENTRY_REJECTED, 'ANISOTROPIC HYPERELASTIC|HYPOELASTIC|DRUCKER PRAGER CREEP|CAP CREEP|' // &
      'CLAY PLASTICITY|CLAY HARDENING|' // &
      'CRUSHABLE FOAM|CRUSHABLE FOAM HARDENING|CONCRETE|CONCRETE DAMAGED PLASTICITY|CONCRETE COMPRESSION ' // &
      'HARDENING|CONCRETE TENSION STIFFENING|BRITTLE CRACKING|CAST IRON PLASTICITY|CAST IRON COMPRESSION ' // &
      'HARDENING|CAST IRON TENSION HARDENING|' // &
      'POTENTIAL|POROUS ELASTIC|POROUS METAL PLASTICITY|MULLINS EFFECT|HYSTERESIS|LOW DENSITY FOAM|' // &
      'SHEAR FAILURE|TENSILE FAILURE|ANNEAL TEMPERATURE|SWELLING|' // &
      'JOINTED MATERIAL|SUPERELASTIC|SHAPE MEMORY ALLOY|EOS|FABRIC|GASKET ELASTICITY|GASKET THICKNESS BEHAVIOR|' // &
      'VISCOUS|SIMPLE SHEAR TEST DATA|VOLUMETRIC TEST DATA', &
      'Give the material with *ELASTIC, *PLASTIC, *DRUCKER PRAGER, *MOHR COULOMB, *CREEP, *HYPERELASTIC or *HYPERFOAM, or by ' // &
      'a routine UMAT (*USER MATERIAL).')
    call table%cards_with(ENTRY_REJECTED, 'TRS', 'Relaxation times that depend on the temperature are not supported: give ' // &
      'those of the temperature of the job in *VISCOELASTIC.')
    call table%cards_with(ENTRY_REJECTED, 'TENSION CUTOFF', 'Give the law by a routine UMAT (*USER MATERIAL), whose DDSDDE ' // &
      'need not be symmetric.')
    call table%cards_with(ENTRY_REJECTED, 'USER SECTION', &
      'Of the user subroutines there are UMAT, UEL, USDFLD, CREEP, FRIC, UINTER, DLOAD, DISP, UAMP and SDVINI.')
    call table%cards_with(ENTRY_REJECTED, 'INITIAL STRAIN INCREASE', 'Give the strain as a thermal one: *EXPANSION, ' // &
      'TYPE=ANISO with *TEMPERATURE, or by *INITIAL CONDITIONS, TYPE=PLASTIC STRAIN.')
    call table%cards_with(ENTRY_REJECTED, 'PRESSURE STRESS|MASS FLOW RATE', 'Give *INITIAL CONDITIONS and *TEMPERATURE.')
    call table%cards_with(ENTRY_REJECTED, 'TRANSFORMF|NODAL ROTATION', &
      'Supports and forces are in the global Cartesian directions; with skew supports use *EQUATION.')
  end subroutine describe_rejected_materials


  !> Procedures, changes of the model and loads that are not supported.
  subroutine describe_rejected_procedures(table)
    type(card_table_type), intent(inout) :: table
    call table%cards_with(ENTRY_REJECTED, 'MODAL DYNAMIC|STEADY STATE DYNAMICS|RANDOM RESPONSE|RESPONSE SPECTRUM', &
      'Vibration is not computed. For slow loads use *STATIC with the same loads and amplitudes, for a known acceleration ' // &
      '*DLOAD with GRAV; vibration and impact need a program for dynamics.')
    call table%cards_with(ENTRY_REJECTED, 'FREQUENCY|COMPLEX FREQUENCY|COMPLEX EIGENVALUE EXTRACTION', 'Natural ' // &
      'frequencies are not computed: let an eigenvalue program do this step. Whether supports and contact hold all bodies ' // &
      'is checked by amontons --check.')
    call table%cards_with(ENTRY_REJECTED, 'CONTACT CLEARANCE|CONTACT CLEARANCE ASSIGNMENT', 'Give *CONTACT INITIALIZATION ' // &
      'DATA with SEARCH ABOVE to close gaps without stress, or a *CONTACT PAIR of the two surfaces with a *CLEARANCE.')
    call table%cards_with(ENTRY_REJECTED, 'BUCKLE', 'Buckling factors are not computed. Move the nodes by a small ' // &
      '*IMPERFECTION, and increase the load as a prescribed displacement in a *STEP, NLGEOM: the largest reaction is the ' // &
      'buckling load.')
    call table%cards_with(ENTRY_REJECTED, 'HEAT TRANSFER|UNCOUPLED TEMPERATURE-DISPLACEMENT|COUPLED TEMPERATURE-DISPLACEMENT|' // &
      'COUPLED THERMAL-ELECTRICAL', 'Heat flow is not computed: take the temperatures from another program and give them ' // &
      'to the nodes by *TEMPERATURE in a *STATIC step; *EXPANSION makes strains of them.')
    call table%cards_with(ENTRY_REJECTED, 'ELECTROMAGNETICS|MASS DIFFUSION|ACOUSTIC|PIEZOELECTRIC|CFD', 'This field is not ' // &
      'computed: take its result from another program, as pressures (*DLOAD) or temperatures (*TEMPERATURE) of a *STATIC step.')
    call table%cards_with(ENTRY_REJECTED, 'GEOSTATIC|SOILS', 'Pore pressure is not computed. For dry or drained soil use ' // &
      '*STATIC with *INITIAL CONDITIONS, TYPE=STRESS and the weight by *DLOAD with GRAV.')
    call table%cards_with(ENTRY_REJECTED, 'GREEN|SUBSTRUCTURE GENERATE|MATRIX GENERATE|MATRIX ASSEMBLE', 'The library returns ' // &
      'the matrices: get_matrix in Fortran, amontons_matrix in C, Job.matrix in Python.')
    call table%cards_with(ENTRY_REJECTED, 'SENSITIVITY|ROBUST DESIGN|FEASIBLE DIRECTION|DESIGN PARAMETER|' // &
      'DESIGN GRADIENT|DESIGN RESPONSE|DESIGN VARIABLES|OBJECTIVE|CONSTRAINT', 'Run the deck with changed numbers ' // &
      'from a script; the Python package amontons runs jobs and returns their results.')
    call table%cards_with(ENTRY_REJECTED, 'DIRECT CYCLIC|STEADY STATE TRANSPORT|STEADY STATE DETECTION', 'Repeat the ' // &
      'motion in *STATIC steps until the results repeat.')
    call table%cards_with(ENTRY_REJECTED, 'ANNEAL', 'Write a deck with the deformed coordinates and the material without ' // &
      'hardening, and continue there.')
    call table%cards_with(ENTRY_REJECTED, 'REFINE MESH', 'Refine the mesh in the program that made it.')
    call table%cards_with(ENTRY_REJECTED, 'HCF|CRACK PROPAGATION|ENRICHMENT|ENRICHMENT ACTIVATION', 'Fatigue and cracks ' // &
      'through elements are not computed: give the path of a crack cohesive elements, as COH3D8, or take the stresses of ' // &
      'a *STATIC step from job.vtkhdf or job.frd to a program for them.')
    call table%cards_with(ENTRY_REJECTED, 'LOAD CASE|END LOAD CASE', 'Give each load case a *STEP of its own, with OP=NEW.')
    call table%cards_with(ENTRY_REJECTED, 'CHANGE CONTACT TYPE|IMPORT|IMPORT ' // &
      'CONTROLS|MAP SOLUTION|ADAPTIVE MESH|ADAPTIVE MESH CONTROLS', 'The model is the same in all steps.')
    call table%cards_with(ENTRY_REJECTED, 'CFLUX|DFLUX|DSFLUX|FILM|SFILM|CFILM|RADIATE|CRADIATE|SRADIATE|VIEWFACTOR|' // &
      'CAVITY DEFINITION', 'Heat flow is not computed: take the temperatures from another program and give them to the nodes ' // &
      'by *TEMPERATURE.')
    call table%cards_with(ENTRY_REJECTED, 'BASE MOTION|CORRELATION LENGTH|FLOW|SFLOW|DFLOW|DECHARGE|CECHARGE|MASS FLOW|LIMIT ' // &
      'VELOCITY|VALUES AT INFINITY|SELECT CYCLIC SYMMETRY MODES|SELECT EIGENMODES|INERTIA RELIEF|INCIDENT WAVE|' // &
      'GEOMETRIC CONSTRAINT|GEOMETRIC TOLERANCES|RANDOM FIELD|RETAINED NODAL DOFS|SUBSTRUCTURE MATRIX OUTPUT|' // &
      'SUBSTRUCTURE PATH|SUBSTRUCTURE LOAD CASE', 'The loads are those of *BOUNDARY, *CLOAD and *DLOAD.')
  end subroutine describe_rejected_procedures


  !> Constraints, structural elements, parts and generators that are not supported.
  subroutine describe_rejected_parts(table)
    type(card_table_type), intent(inout) :: table
    call table%cards_with(ENTRY_REJECTED, 'NETWORK MPC|RELEASE|TIE COEFFICIENT', &
      'Use *EQUATION, or mesh the bodies together.')
    call table%cards_with(ENTRY_REJECTED, 'REBAR|REBAR LAYER', 'Mesh the bars as trusses with *EMBEDDED ELEMENT.')
    call table%cards_with(ENTRY_REJECTED, 'GASKET SECTION|FLUID SECTION|SURFACE SECTION|RIGID SURFACE|' // &
      'ROTARY INERTIA|NONSTRUCTURAL MASS|JOINT|CONNECTOR SECTION|CONNECTOR BEHAVIOR|CONNECTOR ELASTICITY|CONNECTOR MOTION|' // &
      'CONNECTOR LOAD|EULERIAN SECTION|INTERFACE', &
      'The sections are *SOLID SECTION, *SHELL SECTION, *MEMBRANE SECTION and *BEAM SECTION.')
    call table%cards_with(ENTRY_REJECTED, 'FLUID CAVITY|FLUID BEHAVIOR|FLUID DENSITY|FLUID BULK MODULUS|FLUID EXPANSION', &
      'A fluid in a cavity is not computed: give its pressure on the walls by *DSLOAD.')
    call table%cards_with(ENTRY_REJECTED, 'NMAP|PARAMETER DEPENDENCE|PARAMETER TABLE', &
      'Write the nodes, elements and numbers themselves.')
    call table%cards_with(ENTRY_REJECTED, 'SURFACE SMOOTHING|COHESIVE BEHAVIOR|CLEARANCE TABLE|SLIDE LINE|' // &
      'IMPACTOR|BOND|GAP ELECTRICAL CONDUCTANCE', 'Name the pairs that may touch with *CONTACT PAIR, or let *CONTACT find them.')
  end subroutine describe_rejected_parts

end module amontons_card_table
