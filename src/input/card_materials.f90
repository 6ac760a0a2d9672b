!> Entries of the card table for materials, sections, orientations and initial conditions.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_card_materials
  use amontons_card_cohesive, only: describe_cohesive
  use amontons_card_submodels, only: describe_global_step
  use amontons_card_schema, only: card_table_type, describe_field_variables, SCOPE_MODEL, SCOPE_STEP, ENTRY_IGNORED, &
    ENTRY_REJECTED, VALUE_NONE, VALUE_NAME, VALUE_TEXT, VALUE_INTEGER, VALUE_REAL, VALUE_WORD, VALUE_OPTIONAL_WORD
  implicit none
  private
  public :: describe_materials

contains

  !> Materials, sections, directions, initial conditions and temperatures.
  subroutine describe_materials(table)
    type(card_table_type), intent(inout) :: table
    call table%card('MATERIAL', SCOPE_MODEL, 'Starts a material; the cards of its properties follow.')
    call table%option('NAME', VALUE_NAME, 'Name of the material.', default='required')
    call table%option('SRATE FACTOR|RTOL', VALUE_TEXT, 'It smooths tables of rates in Abaqus/Explicit.', status=ENTRY_IGNORED)
    call describe_elastic(table)
    call table%card('DENSITY', SCOPE_MODEL, 'Mass density, needed by gravity.', parent='MATERIAL', data= &
      'density, temperature')
    call table%add_dialect_note('A density over the temperature: abaqus that of the temperature at the start, calculix of ' // &
      'the present one.')
    call describe_field_variables(table)
    call describe_expansion(table)
    call describe_inelastic(table)
    call describe_cone(table)
    call describe_hyperelastic(table)
    call describe_user(table)
    call describe_section(table)
    call describe_cohesive(table)
    call describe_user_elements(table)
    call describe_initial_conditions(table)
  end subroutine describe_materials


  !> ELASTIC.
  subroutine describe_elastic(table)
    type(card_table_type), intent(inout) :: table
    call table%card('ELASTIC', SCOPE_MODEL, 'Linear elasticity; at finite strain between logarithmic strains and ' // &
      'Kirchhoff stresses (abaqus dialect) or Green''s strains and second Piola-Kirchhoff stresses (calculix).', &
      parent='MATERIAL', data='the constants of TYPE, temperature; a line (or more, of eight values) for each ' // &
      'temperature. ISOTROPIC: Young''s modulus, Poisson''s ratio. ENGINEERING CONSTANTS: E1, E2, E3, nu12, nu13, ' // &
      'nu23, G12, G13, G23. LAMINA: E1, E2, nu12, G12, G13, G23. ' // &
      'ORTHO: D1111, D1122, D2222, D1133, D2233, D3333, D1212, D1313, D2323. ANISO: 21 D. ' // &
      'TRACTION (cohesive elements): stiffness of normal, first shear, second shear direction (blank: as the first)')
    call table%option('TYPE', VALUE_WORD, 'Kind of elasticity.', allowed='ISOTROPIC|ISO|ORTHO|ORTHOTROPIC|' // &
      'ENGINEERING CONSTANTS|LAMINA|ANISO|ANISOTROPIC|TRACTION', default='ISOTROPIC')
    call table%reject_words('COUPLED TRACTION|SHEAR', 'Give TRACTION for cohesive elements, whose directions are not coupled.')
    call table%option('MODULI', VALUE_WORD, 'With VISCOELASTIC: which moduli the constants are.', allowed= &
      'LONG TERM|INSTANTANEOUS', default='LONG TERM')
    call describe_field_variables(table)
    call table%card('NO COMPRESSION', SCOPE_MODEL, 'Modifies ELASTIC: negative principal stresses of the elasticity ' // &
      'become zero. Abaqus dialect.', parent='MATERIAL')
    call table%card('NO TENSION', SCOPE_MODEL, 'Modifies ELASTIC: positive principal stresses of the elasticity become ' // &
      'zero. Abaqus dialect.', parent='MATERIAL')
  end subroutine describe_elastic


  !> EXPANSION.
  subroutine describe_expansion(table)
    type(card_table_type), intent(inout) :: table
    call table%card('EXPANSION', SCOPE_MODEL, 'Thermal expansion, as secant coefficients from the temperature ZERO on.', &
      parent='MATERIAL', data='coefficient, temperature; ORTHO: three coefficients; ANISO: six (11 22 33 12 13 23)')
    call table%option('TYPE', VALUE_WORD, 'Kind of expansion.', allowed='ISO|ISOTROPIC|ORTHO|ORTHOTROPIC|ANISO|' // &
      'ANISOTROPIC', default='ISO')
    call table%reject_words('SHORT FIBER', 'Give ORTHO.')
    call table%option('ZERO', VALUE_REAL, 'Temperature at which the coefficients start.', default='0')
    call table%option('USER', VALUE_NONE, 'Give a table.', status=ENTRY_REJECTED)
    call describe_field_variables(table)
  end subroutine describe_expansion


  !> Plasticity and creep.
  subroutine describe_inelastic(table)
    type(card_table_type), intent(inout) :: table
    call table%card('PLASTIC', SCOPE_MODEL, 'Plasticity after von Mises, at finite strain too.', parent='MATERIAL', &
      data='yield stress, equivalent plastic strain (the first 0), temperature')
    call table%option('HARDENING', VALUE_WORD, 'ISOTROPIC: the surface grows; KINEMATIC: it moves, by the growth of ' // &
      'the curve; COMBINED: it moves by the growth of this curve and grows as CYCLIC HARDENING says.', &
      allowed='ISOTROPIC|KINEMATIC|COMBINED', default='ISOTROPIC')
    call table%reject_words('USER|JOHNSON COOK|STATIC RECOVERY', 'Give a table.')
    call table%add_dialect_note('calculix: the first strain may be greater than 0; the yield stress is constant below it.')
    call table%option('DATA TYPE', VALUE_WORD, 'What the curve of COMBINED is.', allowed='HALF CYCLE', &
      default='HALF CYCLE')
    call table%reject_words('PARAMETERS|STABILIZED', 'Give the curve of a half cycle.')
    call table%option('NUMBER BACKSTRESSES', VALUE_TEXT, 'The curve is followed piece by piece.', status=ENTRY_IGNORED)
    call table%option('RATE', VALUE_REAL, 'Abaqus dialect, HARDENING=ISOTROPIC: the rate of the equivalent plastic strain at ' // &
      'which the curve holds, in 1/time. Several cards give several rates; linear between them, constant outside.', default='0')
    call table%option('EXTRAPOLATION|PROPERTIES', VALUE_TEXT, 'Only constant stress beyond the last point.', &
      status=ENTRY_REJECTED)
    call describe_field_variables(table)
    call table%card('RATE DEPENDENT', SCOPE_MODEL, 'The yield stress of PLASTIC rises with the rate of the equivalent plastic ' // &
      'strain by a ratio R, in all steps. Abaqus dialect.', parent='MATERIAL', data='POWER LAW: D, n, temperature; YIELD ' // &
      'RATIO: R, rate, temperature; a line for each rate')
    call table%option('TYPE', VALUE_WORD, 'POWER LAW: rate D (R - 1)^n; YIELD RATIO: R over the rate, linear between the ' // &
      'points, constant outside.', allowed='POWER LAW|YIELD RATIO', default='POWER LAW')
    call table%reject_words('JOHNSON COOK|USER', 'Give POWER LAW or YIELD RATIO.')
    call describe_field_variables(table)
    call table%card('CYCLIC HARDENING', SCOPE_MODEL, 'Size of the yield surface of PLASTIC, HARDENING=COMBINED.', &
      parent='MATERIAL', data='yield stress, equivalent plastic strain (the first 0), temperature')
    call table%option('PARAMETERS|USER|PROPERTIES', VALUE_TEXT, 'Give a table.', status=ENTRY_REJECTED)
    call describe_field_variables(table)
    call table%card('VISCOELASTIC', SCOPE_MODEL, 'Relaxation of isotropic ELASTIC or of HYPERELASTIC in VISCO steps: the ' // &
      'moduli are G0 (1 - sum g (1 - exp(-t/tau))) and K0 (1 - sum k (1 - exp(-t/tau))). In STATIC steps nothing relaxes, ' // &
      'with LONG TERM all does.', parent='MATERIAL', data='g, k, tau; a line for each term')
    call table%option('TIME', VALUE_WORD, 'How the moduli are given.', allowed='PRONY', default='required')
    call table%reject_words('CREEP TEST DATA|RELAXATION TEST DATA|FREQUENCY DATA', 'Give g, k and tau of a Prony series.')
    call table%option('TYPE', VALUE_WORD, 'Kind of viscoelasticity.', allowed='ISOTROPIC', default='ISOTROPIC')
    call table%reject_words('TRACTION', 'Only solids relax.')
    call table%option('ERRTOL|NMAX', VALUE_TEXT, 'They count for test data.', status=ENTRY_IGNORED)
    call table%option('FREQUENCY|PRELOAD|NONLINEAR', VALUE_TEXT, 'Give TIME=PRONY.', status=ENTRY_REJECTED)
    call table%card('CAP PLASTICITY', SCOPE_MODEL, 'Soil that fails in shear and is compacted: Drucker and Prager''s line ' // &
      'with a cap; with CAP HARDENING.', parent='MATERIAL', data='cohesion d, friction angle beta in degrees, R, initial ' // &
      'volumetric plastic strain, alpha, K (1, 0 or blank), temperature')
    call describe_field_variables(table)
    call table%card('CAP HARDENING', SCOPE_MODEL, 'Yield stress of CAP PLASTICITY in isotropic compression.', parent='MATERIAL', &
      data='yield stress, volumetric plastic strain as a positive number (the first 0), temperature')
    call describe_field_variables(table)
    call table%card('DEFORMATION PLASTICITY', SCOPE_MODEL, 'Ramberg and Osgood''s law, in place of ELASTIC: E e = s + ' // &
      'a s (s/s0)^(n-1).', parent='MATERIAL', data='E, nu, s0, n, a, temperature')
    call table%add_dialect_note('It turns NLGEOM on for all steps under calculix, with Almansi''s strain.')
    call table%card('CREEP', SCOPE_MODEL, 'Creep, in VISCO steps only. t is the total time of the job, e the ' // &
      'equivalent creep strain.', &
      parent='MATERIAL', data='A, n, m, temperature; USER: none')
    call table%option('LAW', VALUE_WORD, 'TIME: rate A q^n t^m; STRAIN: (A q^n ((m+1) e)^m)^(1/(m+1)); NORTON: TIME; ' // &
      'USER: the routine CREEP of the user, amontons job user=file.', allowed='TIME|STRAIN|NORTON|USER', &
      default='TIME (abaqus), NORTON (calculix)')
    call table%reject_words('HYPERB|ANAND|DARVEAUX|DOUBLE POWER|TIMEPOWER|STRAINPOWER|HYPERBOLIC|BASE FUNCTION', &
      'Use TIME, STRAIN, NORTON or USER.')
    call table%option('TIME', VALUE_WORD, 'Time of LAW=TIME.', allowed='TOTAL', default='TOTAL')
    call table%reject_words('CREEP', 'Time counts from the start of the job.')
    call describe_field_variables(table)
  end subroutine describe_inelastic


  !> Yield that depends on the pressure.
  subroutine describe_cone(table)
    type(card_table_type), intent(inout) :: table
    call table%card('DRUCKER PRAGER', SCOPE_MODEL, 'Plasticity of soils, rock and polymers after Drucker and Prager: yield at ' // &
      't - p tan(beta) = d, flow along t - p tan(psi); t is the von Mises stress or, with K, less in compression; p is the ' // &
      'pressure. DRUCKER PRAGER HARDENING gives d.', parent='MATERIAL', &
      data='friction angle beta, K (0.778 to 1; blank: 1), dilation angle psi, in degrees, temperature')
    call table%option('SHEAR CRITERION', VALUE_WORD, 'The line in the plane of p and q.', allowed='LINEAR', default='LINEAR')
    call table%reject_words('HYPERBOLIC|EXPONENT FORM', 'Only the linear cone is here; it ends in an apex.')
    call table%option('ECCENTRICITY|TEST DATA', VALUE_TEXT, 'They belong to the other criteria.', status=ENTRY_REJECTED)
    call describe_field_variables(table)
    call table%card('DRUCKER PRAGER HARDENING', SCOPE_MODEL, 'Yield stress of DRUCKER PRAGER over the equivalent plastic ' // &
      'strain, as measured in the test of TYPE.', parent='MATERIAL', data='yield stress, equivalent plastic strain (the ' // &
      'first 0), temperature; SHEAR: cohesion (shear stress), plastic shear strain')
    call table%option('TYPE', VALUE_WORD, 'The test: uniaxial compression, uniaxial tension or pure shear.', &
      allowed='COMPRESSION|TENSION|SHEAR', default='COMPRESSION')
    call table%option('RATE', VALUE_TEXT, 'Rates of strain do not count here.', status=ENTRY_REJECTED)
    call describe_field_variables(table)
    call table%card('MOHR COULOMB', SCOPE_MODEL, 'Plasticity of soils and rock after Mohr and Coulomb: shear stress and ' // &
      'pressure on the worst plane, tau = c + sigma tan(phi); flow along a smooth potential. MOHR COULOMB HARDENING gives c.', &
      parent='MATERIAL', data='friction angle phi, dilation angle psi, in degrees, temperature')
    call table%option('ECCENTRICITY', VALUE_REAL, 'Rounding of the potential near the hydrostatic axis, over the first ' // &
      'cohesion.', default='0.1')
    call table%option('DEVIATORIC ECCENTRICITY', VALUE_REAL, 'Size of the potential in triaxial extension over compression.', &
      default='(3 - sin phi)/(3 + sin phi)')
    call describe_field_variables(table)
    call table%card('MOHR COULOMB HARDENING', SCOPE_MODEL, 'Cohesion of MOHR COULOMB over the equivalent plastic strain: ' // &
      'plastic work over cohesion.', parent='MATERIAL', data='cohesion, equivalent plastic strain (the first 0), temperature')
    call describe_field_variables(table)
  end subroutine describe_cone


  !> USER MATERIAL, USER DEFINED FIELD and DEPVAR.
  subroutine describe_user(table)
    type(card_table_type), intent(inout) :: table
    call table%card('USER MATERIAL', SCOPE_MODEL, 'The stress by a routine UMAT of the user, with the arguments of Abaqus, ' // &
      'in place of ELASTIC: amontons job user=file. NTENS is 6 in space, 4 in plane strain and around an axis, 3 in plane ' // &
      'stress and in shells above TRANSVERSE SHEAR STIFFNESS, 1 in trusses. Calculix dialect: names that ' // &
      'begin with TENSION_ONLY, COMPRESSION_ONLY (E and the largest stress of the other side), CIARLET_EL, LIN_ISO_EL ' // &
      '(E and nu), ELASTIC_FIBER (C1, D1; a1, a2, k1, k2 of each fibre), ' // &
      'SINGLE_CRYSTAL, SINGLE_CRYSTAL_CREEP, ANISO_PLAS, ANISO_CREEP, LIN_EL_COROT or UNDO_NLGEOM_LIN need no routine.', &
      parent='MATERIAL', data='the constants, in lines of eight')
    call table%option('CONSTANTS', VALUE_INTEGER, 'Number of constants (NPROPS).', default='required')
    call table%option('LIBRARY', VALUE_TEXT, 'File that holds the routine, Fortran or a shared library, beside the deck; it ' // &
      'counts before that of the command line (our own parameter).')
    call table%option('SPATIAL', VALUE_NONE, 'The routine is called with NTENS = 6 for all elements; the strains that ' // &
      'are free in plane stress and in trusses are found by us (our own parameter).')
    call table%option('TYPE', VALUE_WORD, 'What the routine gives.', allowed='MECHANICAL', default='MECHANICAL')
    call table%reject_words('THERMAL', 'There is no heat transfer.')
    call table%option('UNSYMM', VALUE_NONE, 'DDSDDE is taken as it is, with this word and without; of C3D8I its ' // &
      'symmetric part.', status=ENTRY_IGNORED)
    call table%option('HYBRID FORMULATION|EFFMOD', VALUE_TEXT, 'Only stress from strain.', status=ENTRY_REJECTED)
    call table%card('USER DEFINED FIELD', SCOPE_MODEL, 'The field variables at the points of the material by a routine USDFLD ' // &
      'of the user, with the arguments of Abaqus: amontons job user=file. Tables with DEPENDENCIES take them.', parent='MATERIAL')
    call table%card('DEPVAR', SCOPE_MODEL, 'Number of variables that UMAT or USDFLD keeps at each point (STATEV), zero at the ' // &
      'start unless INITIAL CONDITIONS, TYPE=SOLUTION says otherwise.', parent='MATERIAL', &
      data='number; further lines that name the variables are passed over')
    call table%option('DELETE', VALUE_INTEGER, 'Number of the variable, 1 at the start, that deletes a point for good where ' // &
      'UMAT makes it 0: its stress is then 0.')
  end subroutine describe_user


  !> Rubber and foam.
  subroutine describe_hyperelastic(table)
    type(card_table_type), intent(inout) :: table
    call table%card('HYPERELASTIC', SCOPE_MODEL, 'Rubber; D1 = 0 is taken as 0.1/G, G the shear modulus (a Poisson''s ' // &
      'ratio of 0.475).', parent='MATERIAL', data='the constants, temperature; in lines of eight values. NEO HOOKE: ' // &
      'C10, D1. MOONEY-RIVLIN: C10, C01, D1. YEOH: C10, C20, C30, D1, D2, D3. POLYNOMIAL: C10, C01, C20, C11, C02, ' // &
      '..., D1 to DN. REDUCED POLYNOMIAL: C10, C20, ..., D1 to DN. OGDEN: mu1, alpha1, ..., D1 to DN. ARRUDA-BOYCE: ' // &
      'mu, lambda, D')
    call table%option('NEO HOOKE|MOONEY-RIVLIN|YEOH|POLYNOMIAL|REDUCED POLYNOMIAL|OGDEN|ARRUDA-BOYCE', VALUE_NONE, &
      'Kind of rubber.', default='POLYNOMIAL')
    call table%option('N', VALUE_INTEGER, 'Order: POLYNOMIAL 1 to 3, OGDEN and REDUCED POLYNOMIAL 1 to 6.', default='1')
    call table%add_dialect_note('It turns NLGEOM on for all steps under calculix.')
    call table%option('MODULI', VALUE_WORD, 'With VISCOELASTIC: which moduli the constants are.', allowed= &
      'LONG TERM|INSTANTANEOUS', default='LONG TERM')
    call table%option('MARLOW|VAN DER WAALS|USER|ANISOTROPIC|VALANIS-LANDEL', VALUE_TEXT, 'Use one of the others.', &
      status=ENTRY_REJECTED)
    call table%option('TEST DATA INPUT', VALUE_NONE, 'Polynomials: the cards below give the constants, by least squares of ' // &
      'relative errors. Abaqus dialect.')
    call table%option('POISSON', VALUE_REAL, 'With TEST DATA INPUT: Poisson''s ratio at rest.', default='0.475')
    call table%option('BETA|PROPERTIES|TYPE', VALUE_TEXT, 'Give the constants.', status=ENTRY_REJECTED)
    call describe_field_variables(table)
    call table%card('UNIAXIAL TEST DATA', SCOPE_MODEL, 'Points of a test in one direction.', parent='MATERIAL', data= &
      'nominal stress, nominal strain')
    call table%option('SMOOTH', VALUE_TEXT, 'The points are taken as they are.', status=ENTRY_IGNORED)
    call table%card('BIAXIAL TEST DATA', SCOPE_MODEL, 'Points of a test with equal stretches in two directions.', &
      parent='MATERIAL', data='nominal stress, nominal strain')
    call table%option('SMOOTH', VALUE_TEXT, 'The points are taken as they are.', status=ENTRY_IGNORED)
    call table%card('PLANAR TEST DATA', SCOPE_MODEL, 'Points of a test in one direction, with the width held.', &
      parent='MATERIAL', data='nominal stress, nominal strain')
    call table%option('SMOOTH', VALUE_TEXT, 'The points are taken as they are.', status=ENTRY_IGNORED)
    call table%card('HYPERFOAM', SCOPE_MODEL, 'Compressible foam.', parent='MATERIAL', data= &
      'mu1, alpha1, mu2, alpha2, ..., nu1, nu2, ..., temperature; in lines of eight values')
    call table%option('N', VALUE_INTEGER, 'Order, 1 to 6.', default='1')
    call table%option('MODULI', VALUE_TEXT, 'Without viscoelasticity both moduli are the same.', status=ENTRY_IGNORED)
    call table%option('TEST DATA INPUT|POISSON', VALUE_TEXT, 'Give the constants.', status=ENTRY_REJECTED)
    call describe_field_variables(table)
    call table%add_dialect_note('It turns NLGEOM on for all steps under calculix.')
  end subroutine describe_hyperelastic


  !> Sections and local directions.
  subroutine describe_section(table)
    type(card_table_type), intent(inout) :: table
    call table%card('SOLID SECTION', SCOPE_MODEL, 'Gives the elements of a set their material.', data= &
      'thickness of plane elements or cross-section of trusses, default 1; of no meaning for the others')
    call table%option('ELSET', VALUE_NAME, 'The elements.', default='required')
    call table%option('MATERIAL', VALUE_NAME, 'Their material.', default='required')
    call table%option('ORIENTATION', VALUE_NAME, 'Local axes: of the constants, and of stresses and strains in the ' // &
      '.dat file.')
    call table%option('CONTROLS|STACK DIRECTION|LAYUP|OFFSET|NODAL THICKNESS', VALUE_TEXT, &
      'The elements are chosen by their type alone.', status=ENTRY_IGNORED)
    call table%option('COMPOSITE|SYMMETRIC', VALUE_TEXT, 'Layered solids do not exist here: give each layer elements of its ' // &
      'own, or use shells with *SHELL SECTION, COMPOSITE.', status=ENTRY_REJECTED)
    call table%option('REF NODE', VALUE_TEXT, 'Generalised plane strain does not exist here.', status=ENTRY_REJECTED)
    call describe_structural_sections(table)
    call table%card('SPRING', SCOPE_MODEL, 'Gives springs their constant, or with NONLINEAR their force over the elongation.', &
      data= &
      'SPRING1, SPRING2: direction at the first node, at the second; then, and for SPRINGA at once: spring constant, a ' // &
      'field that is passed over, temperature; NONLINEAR: force, elongation, temperature, constant outside the table')
    call table%option('ELSET', VALUE_NAME, 'The springs.', default='required')
    call table%option('NONLINEAR', VALUE_NONE, 'The data are tables of force and elongation.')
    call table%option('ORIENTATION', VALUE_NAME, 'Directions 1 to 3 are those of these axes, which are rectangular.')
    call table%option('DEPENDENCIES|COMPLEX STIFFNESS', VALUE_TEXT, 'Springs depend on elongation and temperature alone.', &
      status=ENTRY_REJECTED)
    call table%option('RTOL', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%card('GAP', SCOPE_MODEL, 'Gives gaps (GAPUNI) their clearance: the second node may come nearer to the first ' // &
      'by so ' // &
      'much, along the direction from the first to the second; closed, the gap is a stiff spring.', data= &
      'clearance, direction x, y, z (none: the line of the nodes), a field that is passed over, stiffness (default ' // &
      '1e12), force of the open gap (default 1e-3)')
    call table%option('ELSET', VALUE_NAME, 'The gaps.', default='required')
    call table%card('MASS', SCOPE_MODEL, 'Gives point masses their mass; it counts for gravity.', data='mass')
    call table%option('ELSET', VALUE_NAME, 'The masses.', default='required')
    call table%option('ALPHA|COMPOSITE|TYPE|ORIENTATION|DEPENDENCIES', VALUE_TEXT, 'A mass is one number.', &
      status=ENTRY_REJECTED)
    call describe_axes(table)
  end subroutine describe_section


  !> Sections of shells and beams.
  subroutine describe_structural_sections(table)
    type(card_table_type), intent(inout) :: table
    call table%card('SHELL SECTION', SCOPE_MODEL, 'Gives shells their material and thickness; they are expanded into solids.', &
      data='thickness; number of section points, which are those of the solids here. COMPOSITE: for each layer, from bottom ' // &
      'to top, thickness; number of section points; material; name of its ORIENTATION, or its angle about the normal in degrees')
    call table%option('ELSET', VALUE_NAME, 'The shells.', default='required')
    call table%option('MATERIAL', VALUE_NAME, 'Their material.', default='required without COMPOSITE')
    call table%option('COMPOSITE', VALUE_NONE, 'Layers, each with its own material: one solid for each of them.')
    call table%option('ORIENTATION', VALUE_NAME, 'Local axes of the constants, and of stresses and strains in the .dat file.')
    call table%option('OFFSET', VALUE_TEXT, 'Place of the nodes over the thickness from its middle, towards the normal; ' // &
      'SPOS is 0.5, SNEG -0.5.', default='0')
    call table%option('NODAL THICKNESS', VALUE_NONE, 'The thickness is that of *NODAL THICKNESS.')
    call table%option('SECTION INTEGRATION|CONTROLS|TEMPERATURE|POISSON', VALUE_TEXT, 'The thickness is a solid one, which ' // &
      'stretches freely.', status=ENTRY_IGNORED)
    call table%option('LAYUP', VALUE_TEXT, 'A name only.', status=ENTRY_IGNORED)
    call table%option('STACK DIRECTION|SYMMETRIC|SHELL THICKNESS|THICKNESS MODULUS|DENSITY', VALUE_TEXT, &
      'Write each layer with its thickness, from the bottom to the top.', status=ENTRY_REJECTED)
    call table%add_dialect_note('ORIENTATION: direction 1 is the projection on the shell of the axis behind the one that its ' // &
      'second line names (default 1) in the abaqus dialect, of axis 1 in that of calculix. Without it direction 1 is the ' // &
      'projection of global x in the abaqus dialect; the calculix dialect keeps the global axes. COMPOSITE is for S6 and S8R ' // &
      'in the calculix dialect, without angles.')
    call table%card('SHELL GENERAL SECTION', SCOPE_MODEL, 'Gives shells their material and thickness, or the stiffness of ' // &
      'their section, for which layers of solids are found.', data='with MATERIAL or COMPOSITE as SHELL SECTION; ' // &
      'without both three lines of 8, 8 and 5 numbers: the upper triangle of the stiffness of membrane forces and moments ' // &
      '11, 22, 12, column by column')
    call table%option('ELSET', VALUE_NAME, 'The shells.', default='required')
    call table%option('MATERIAL', VALUE_NAME, 'Their material.', default='none')
    call table%option('COMPOSITE', VALUE_NONE, 'Layers, as in SHELL SECTION.')
    call table%option('ORIENTATION', VALUE_NAME, 'As in SHELL SECTION.')
    call table%option('OFFSET', VALUE_TEXT, 'As in SHELL SECTION.', default='0')
    call table%option('NODAL THICKNESS', VALUE_NONE, 'As in SHELL SECTION, with MATERIAL.')
    call table%option('DENSITY', VALUE_REAL, 'Mass per area of a section by its stiffness, needed by gravity.', default='none')
    call table%option('POISSON|THICKNESS MODULUS|CONTROLS|TEMPERATURE', VALUE_TEXT, 'The thickness is a solid one.', &
      status=ENTRY_IGNORED)
    call table%option('LAYUP', VALUE_TEXT, 'A name only.', status=ENTRY_IGNORED)
    call table%option('ZERO|DEPENDENCIES|USER|VARIABLES|PROPERTIES|I PROPERTIES|BENDING ONLY|MEMBRANE ONLY|SMEAR ALL LAYERS|' // &
      'STACK DIRECTION|SYMMETRIC|SHELL THICKNESS|UNSYMM', VALUE_TEXT, 'Give constant numbers, or each layer.', &
      status=ENTRY_REJECTED)
    call table%card('TRANSVERSE SHEAR STIFFNESS', SCOPE_MODEL, 'Directly below the section of shells, or of beams by their ' // &
      'section: its stiffness against transverse shear, in place of that of the material. Abaqus dialect.', &
      parent='SHELL SECTION|SHELL GENERAL SECTION|BEAM SECTION|BEAM GENERAL SECTION', data='shells: K11, K22, K12, forces per ' // &
      'length over the shear strains 13, 23; beams: K23, K13, forces over the shear strains along direction 2, 1, and a ' // &
      'slenderness compensation factor or SCF, which has no effect. Of the first two one may be blank, and is then the other')
    call table%card('MEMBRANE SECTION', SCOPE_MODEL, 'Gives membranes their material and thickness.', data='thickness')
    call table%option('ELSET', VALUE_NAME, 'The membranes.', default='required')
    call table%option('MATERIAL', VALUE_NAME, 'Their material.', default='required')
    call table%option('ORIENTATION', VALUE_NAME, 'Its first axis, projected on the membrane, is local direction 1.')
    call table%option('CONTROLS|POISSON', VALUE_TEXT, 'The thickness changes by the material.', status=ENTRY_IGNORED)
    call table%option('OFFSET', VALUE_TEXT, 'A membrane has no bending: its place over the thickness does not count.', &
      status=ENTRY_IGNORED)
    call table%option('NODAL THICKNESS|MEMBRANE THICKNESS', VALUE_TEXT, 'Give one thickness.', status=ENTRY_REJECTED)
    call table%card('BEAM SECTION', SCOPE_MODEL, 'Gives beams their material and cross-section; they are expanded into solids.', &
      data='RECT: dimensions along direction 1 and 2; CIRC: radius (calculix dialect: diameters along direction 1 and 2); ' // &
      'PIPE: outer radius, thickness; BOX: dimensions along direction 1 and 2, thickness of the walls at +1, +2, -1, -2; ' // &
      'I: height of the node over the bottom, height, widths of both flanges, their thicknesses, that of the web; ' // &
      'L: lengths of the legs along direction 1 and 2, their thicknesses; HEX: radius of the outer corners, thickness; ' // &
      'TRAPEZOID: width of the bottom, height, width of the top, height of the node over the bottom; ' // &
      'ARBITRARY: number of walls, two coordinates of the first and of the second point, thickness, then in a line for each ' // &
      'further wall its end and thickness; GENERAL ' // &
      '(calculix dialect, U1): area, I11, I12, I22, shear factor; ' // &
      'next line: direction 1, default 0, 0, -1; a last line of numbers of integration points is passed over')
    call table%option('ELSET', VALUE_NAME, 'The beams.', default='required')
    call table%option('MATERIAL', VALUE_NAME, 'Their material.', default='required')
    call describe_beam_shapes(table)
    call table%option('OFFSET1|OFFSET2', VALUE_REAL, 'Place of the nodes over the dimension from the middle, along ' // &
      'direction 1 and 2.', default='0')
    call table%option('TEMPERATURE', VALUE_WORD, 'A node has one temperature, for all of its cross-section.', &
      status=ENTRY_IGNORED)
    call table%option('POISSON', VALUE_REAL, 'The area changes by the material, as that of a solid.', status=ENTRY_IGNORED)
    call table%option('LUMPED|ROTARY INERTIA', VALUE_TEXT, 'Statics has no inertia.', status=ENTRY_IGNORED)
    call table%option('NODAL THICKNESS', VALUE_TEXT, 'Give the dimensions.', status=ENTRY_REJECTED)
    call table%card('BEAM GENERAL SECTION', SCOPE_MODEL, 'Gives beams a cross-section and its elasticity, without a *MATERIAL.', &
      data='dimensions as in BEAM SECTION; GENERAL: area, I11, I12, I22, J; second line: direction 1; ' // &
      'third line: Young''s modulus, shear modulus, thermal expansion')
    call table%option('ELSET', VALUE_NAME, 'The beams.', default='required')
    call describe_beam_shapes(table)
    call table%option('MATERIAL', VALUE_NAME, 'A material in place of the third line, as in CalculiX.', default='none')
    call table%option('DENSITY', VALUE_REAL, 'Mass density, needed by gravity.', default='none')
    call table%option('ZERO', VALUE_REAL, 'Temperature from which the thermal expansion counts.', default='0')
    call table%option('OFFSET1|OFFSET2', VALUE_REAL, 'As in BEAM SECTION.', default='0')
  call table%option('POISSON', VALUE_REAL, 'The area changes with Poisson''s ratio E/(2 G) - 1 of the solid.', status=ENTRY_IGNORED)
    call table%option('ROTARY INERTIA', VALUE_TEXT, 'Statics has no inertia of rotation.', status=ENTRY_IGNORED)
    call table%option('TAPER|DEPENDENCIES', VALUE_TEXT, 'Give one cross-section and constants.', status=ENTRY_REJECTED)
    call table%card('NODAL THICKNESS', SCOPE_MODEL, 'Thickness at the nodes, for sections with NODAL THICKNESS.', &
      data='node or node set, thickness, second thickness of beams')
    call table%card('NORMAL', SCOPE_MODEL, 'Normal of a shell, or first direction of a beam, at a node of an element.', &
      data='element or element set, node or node set, x, y, z')
  end subroutine describe_structural_sections


  !> The cross-sections of beams.
  subroutine describe_beam_shapes(table)
    type(card_table_type), intent(inout) :: table
    call table%option('SECTION', VALUE_WORD, 'Cross-section.', allowed= &
      'RECT|CIRC|PIPE|THICK PIPE|BOX|I|L|HEX|TRAPEZOID|ARBITRARY|GENERAL', default='required')
    call table%reject_words('T|CHANNEL|ELBOW|MESHED|NONLINEAR GENERAL', 'A T is an I with one flange, the other with width ' // &
      'and thickness 0; a channel is an ARBITRARY section of three walls; any other is *BEAM GENERAL SECTION, ' // &
      'SECTION=GENERAL with area and moments of inertia.')
  end subroutine describe_beam_shapes


  !> Local axes.
  subroutine describe_axes(table)
    type(card_table_type), intent(inout) :: table
    call table%card('ORIENTATION', SCOPE_MODEL, 'Local axes, of sections and *COUPLING.', data='RECTANGULAR: a point ' // &
      'on local x, a point of the local xy plane, six coordinates; CYLINDRICAL: two points of the axis, which is ' // &
      'local z, local x is radial; or the name of a distribution; second line: local axis to turn about, angle in ' // &
      'degrees or the name of a distribution of angles')
    call table%option('NAME', VALUE_NAME, 'Name of the orientation.', default='required')
    call table%option('SYSTEM', VALUE_WORD, 'Kind of axes.', allowed='RECTANGULAR|CYLINDRICAL', default='RECTANGULAR')
    call table%reject_words('SPHERICAL|Z RECTANGULAR|USER', 'Use RECTANGULAR or CYLINDRICAL.')
    call table%option('DEFINITION', VALUE_WORD, 'How the points are given.', allowed='COORDINATES', &
      default='COORDINATES')
    call table%reject_words('NODES|OFFSET TO NODES', 'Give coordinates.')
    call table%option('LOCAL DIRECTIONS', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%card('DISTRIBUTION', SCOPE_MODEL, 'Local axes or angles element by element; ORIENTATION names it. In a part ' // &
      'they move with its instances.', data= &
      'first line: blank, six default coordinates; then element or element set, six coordinates; of angles one angle in ' // &
      'degrees in place of coordinates')
    call table%option('NAME', VALUE_NAME, 'Name of the distribution.', default='required')
    call table%option('LOCATION|TABLE', VALUE_TEXT, '', status=ENTRY_IGNORED)
    call table%card('DISTRIBUTION TABLE', SCOPE_MODEL, 'DISTRIBUTION gives coordinates or angles.', data='anything', &
      status=ENTRY_IGNORED)
  end subroutine describe_axes


  !> Initial conditions and temperatures.
  subroutine describe_initial_conditions(table)
    type(card_table_type), intent(inout) :: table
    call table%card('INITIAL CONDITIONS', SCOPE_MODEL, 'What the bodies start with.', data='TEMPERATURE, FIELD: node or node ' // &
      'set, temperature or value. STRESS, PLASTIC STRAIN: element or element set, in the calculix dialect integration point, ' // &
      'six components 11 22 33 12 13 23. HARDENING: element or element set, equivalent plastic strain, six back ' // &
      'stresses. SOLUTION: element or element set, the STATEV of its points, in further lines of eight')
    call table%option('TYPE', VALUE_WORD, 'What is given. DISPLACEMENT, which CalculiX takes too, changes nothing in a static ' // &
      'step.', allowed='TEMPERATURE|FIELD|STRESS|PLASTIC STRAIN|HARDENING|SOLUTION|DISPLACEMENT', default='required')
    call table%reject_words('VELOCITY|FLUID VELOCITY|PRESSURE|MASS FLOW|TOTAL PRESSURE|' // &
      'RATIO|SATURATION|PORE PRESSURE|SPECIFIC ENERGY|SPUD EMBEDMENT|SPUD PRELOAD|RELATIVE DENSITY|CONCENTRATION|' // &
      'ENRICHMENT|FLUID PRESSURE|ROTATING VELOCITY|NODE REF COORDINATE|REF COORDINATE|REBAR STRESS|POROSITY|' // &
      'INITIAL GAP|ACOUSTIC STATIC PRESSURE', 'A quasi-static job starts at rest and undeformed.')
    call table%option('VARIABLE', VALUE_INTEGER, 'FIELD: number of the field variable.', default='1')
    call table%option('USER', VALUE_NONE, 'SOLUTION: the routine SDVINI of the user gives the STATEV.')
    call table%option('FILE|INPUT|STEP|INC|GEOSTATIC|SECTION POINTS|UNBALANCED STRESS|MIDSIDE|INTERPOLATE|NUMBER ' // &
      'BACKSTRESSES|DRIVING ELSETS|REBAR', VALUE_TEXT, 'Give the values.', status=ENTRY_REJECTED)
    call table%card('TEMPERATURE', SCOPE_STEP, 'Prescribes nodal temperatures, which go to their values over the step.', &
      data='node or node set, temperature')
    call table%option('AMPLITUDE', VALUE_NAME, 'The temperature is the value times the amplitude.')
    call table%option('OP', VALUE_WORD, 'NEW: nodes not given again go back to their initial temperature.', &
      allowed='MOD|NEW', default='MOD')
    call describe_global_step(table, 'The temperatures')
    call reject_fields_of_files(table)
    call table%card('FIELD', SCOPE_STEP, 'Prescribes a field variable at nodes, on which material properties depend ' // &
      '(DEPENDENCIES); it goes to its values over the step.', data='node or node set, value')
    call table%option('VARIABLE', VALUE_INTEGER, 'Number of the field variable.', default='1')
    call table%option('AMPLITUDE', VALUE_NAME, 'The field variable is the value times the amplitude.')
    call table%option('OP', VALUE_WORD, 'NEW: nodes not given again go back to their initial value.', &
      allowed='MOD|NEW', default='MOD')
    call table%option('SUBMODEL|STEP|DATA SET', VALUE_TEXT, 'Give the values.', status=ENTRY_REJECTED)
    call reject_fields_of_files(table)
  end subroutine describe_initial_conditions


  !> Temperatures and field variables by a routine, or from files.
  subroutine reject_fields_of_files(table)
    type(card_table_type), intent(inout) :: table
    call table%option('USER', VALUE_NONE, 'Give the values.', status=ENTRY_REJECTED)
    call table%option('FILE|BSTEP|BINC|ESTEP|EINC|INPUT|MIDSIDE|INTERPOLATE|TIME DELAY|OUTPUT VARIABLE', &
      VALUE_TEXT, 'Give the values.', status=ENTRY_REJECTED)
  end subroutine reject_fields_of_files


  !> User elements.
  subroutine describe_user_elements(table)
    type(card_table_type), intent(inout) :: table
    character(*), parameter :: NO_MATRIX = 'The routine UEL gives force and stiffness.'
    call table%card('USER ELEMENT', SCOPE_MODEL, 'Defines a type of elements whose force and stiffness are by the user ' // &
      'routine UEL.', data='degrees of freedom (1 to 6) of the nodes; in further lines a node of the element, 1 to NODES, and ' // &
      'those from it on, or, for a node that is not behind the one before, those that follow in a second list')
    call table%option('TYPE', VALUE_TEXT, 'Name of the type, U1 to U9999; JTYPE is its number.', default='required')
    call table%option('NODES', VALUE_INTEGER, 'Number of nodes, at most 20.', default='required')
    call table%option('COORDINATES', VALUE_INTEGER, 'Number of coordinates in COORDS; at least the largest displacement of ' // &
      'the data lines.', default='1')
    call table%option('PROPERTIES', VALUE_INTEGER, 'Number of real properties.', default='0')
    call table%option('I PROPERTIES', VALUE_INTEGER, 'Number of integer properties.', default='0')
    call table%option('VARIABLES|VAR', VALUE_INTEGER, 'Number of SVARS of an element.', default='1')
    call table%option('UNSYMM', VALUE_NONE, 'AMATRX is not symmetric; without it its symmetric part counts.')
    call table%option('LINEAR|FILE|OLD ELEMENT|STEP|INCREMENT', VALUE_OPTIONAL_WORD, NO_MATRIX, status=ENTRY_REJECTED)
    call table%option('INTEGRATION|TENSOR', VALUE_TEXT, 'There is no UELMAT. ' // NO_MATRIX, status=ENTRY_REJECTED)
    call table%option('INTEGRATION POINTS|MAXDOF', VALUE_INTEGER, 'Of the beam U1 of CalculiX, in its dialect.', default='none')
    call table%card('UEL PROPERTY', SCOPE_MODEL, 'Gives user elements their properties.', data='reals, then integers, in any ' // &
      'number of lines')
    call table%option('ELSET', VALUE_NAME, 'Element set of user elements of one type.', default='required')
    call table%option('MATERIAL|ORIENTATION', VALUE_TEXT, 'UEL has its own law; give its constants as properties.', &
      status=ENTRY_REJECTED)
  end subroutine describe_user_elements

end module amontons_card_materials
