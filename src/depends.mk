# The floors of the house, bottom-up: a room uses only rooms that stand above it in this list.
# The order is kept by hand; `make lint` proves the whole against the use lines (upward, stale, missing), and
# `python3 verify/lint.py --write` rewrites the right-hand sides.

# 0 ground: numbers, errors, text, and the one place that writes for people
uses_kinds =
uses_errors =
uses_version =
uses_text = kinds
uses_lookup = kinds text
uses_tensor = kinds
uses_profiles = kinds tensor
uses_history = kinds
uses_posix = kinds errors
uses_journal = kinds errors text history posix

# 1 tools: one outer library each
uses_sparse = kinds errors
uses_blas = kinds
uses_dense = kinds blas
uses_null_space = kinds dense
uses_partition = errors sparse
uses_factor = kinds errors sparse
uses_krylov = kinds errors sparse
uses_sprung = kinds errors sparse blas dense krylov
uses_store = kinds errors posix
uses_user = kinds errors text
uses_archive = kinds errors text posix

# 2 model: what the user said, frozen after its check
uses_topology =
uses_mesh = kinds topology
uses_materials = kinds user
uses_surfaces = kinds profiles
uses_loads = kinds
uses_ties = kinds tensor
uses_steps = kinds surfaces loads
uses_model = kinds user archive mesh materials surfaces loads ties steps

# 3 reading: text to cards, cards to model
uses_cards = kinds errors text lookup
uses_card_form = kinds text lookup cards
uses_card_materials = card_form
uses_card_table = card_form card_materials
uses_deck_labels = kinds text lookup topology cards
uses_deck_generate = kinds text tensor cards deck_labels
uses_deck_parts = kinds text tensor topology cards
uses_deck_reader = kinds text lookup mesh model cards card_form
uses_deck_mesh = kinds text lookup topology mesh materials model cards card_form deck_labels deck_reader
uses_deck_sets = text lookup mesh model cards card_form deck_reader deck_mesh
uses_deck_profiles = kinds text tensor profiles mesh surfaces ties model cards card_form deck_reader
uses_deck_faces = lookup topology mesh deck_reader
uses_deck_model = kinds text lookup user topology mesh surfaces loads model cards card_form deck_reader deck_profiles deck_faces
uses_deck_materials = kinds text user materials model cards card_form deck_reader
uses_deck_conditions = kinds text lookup mesh materials loads model cards card_form deck_reader
uses_deck_contact = kinds text mesh surfaces steps model cards card_form deck_reader deck_model
uses_deck_mpc = kinds text tensor mesh ties model cards card_form deck_reader
uses_deck_output = kinds text topology steps model cards card_form card_table deck_reader
uses_deck_bonds = kinds text tensor topology mesh ties model cards card_form deck_reader deck_profiles deck_faces deck_model deck_mpc
uses_standing = kinds loads model
uses_deck_loads = kinds text lookup topology loads model cards card_form deck_reader deck_model standing
uses_deck_springs = kinds text topology materials ties model cards card_form deck_reader deck_mesh deck_mpc deck_bonds
uses_deck_steps = kinds text topology mesh materials ties steps model cards card_form deck_reader deck_materials deck_conditions deck_contact deck_output standing deck_loads
uses_deck_restart = kinds errors text archive model cards card_form
uses_explain = kinds text topology materials surfaces loads steps model cards card_form deck_reader
uses_deck = errors text materials ties model cards card_form card_table deck_generate deck_parts deck_reader deck_mesh deck_sets deck_model deck_materials deck_conditions deck_contact deck_mpc deck_output deck_bonds deck_springs deck_steps deck_restart explain

# 4 kernels: pure, numbers in and out
uses_shapes = kinds topology
uses_log_strain = kinds tensor
uses_stress = kinds tensor materials log_strain
uses_plastic = kinds materials
uses_hyperelastic = kinds materials log_strain
uses_user_material = kinds errors tensor user materials log_strain
uses_material_point = kinds tensor materials log_strain stress plastic hyperelastic user_material
uses_points = kinds tensor topology materials user_material material_point
uses_condition = kinds tensor materials stress material_point points
uses_hourglass = kinds tensor topology
uses_enhanced = kinds tensor topology
uses_plane = kinds tensor topology materials shapes stress material_point points condition hourglass
uses_discrete = kinds topology materials shapes stress material_point points condition
uses_batch = kinds topology materials shapes stress
uses_solid = kinds tensor topology materials shapes log_strain stress material_point points condition hourglass enhanced
uses_element = kinds tensor topology materials shapes points plane discrete solid
uses_facets = kinds errors tensor profiles topology mesh shapes
uses_search = kinds facets
uses_analytic = kinds tensor profiles topology facets
uses_gap = kinds tensor topology shapes facets search analytic
uses_rows = kinds topology shapes facets analytic
uses_dual = kinds dense topology
uses_polygons = kinds topology shapes facets
uses_facing = kinds tensor topology shapes facets search polygons
uses_symmetry = kinds steps model facets gap
uses_slip = kinds
uses_node_overrides = kinds
uses_compliance = kinds surfaces slip
uses_areas = kinds tensor topology mesh surfaces shapes
uses_segments = kinds tensor topology facets search dual polygons
uses_mortar = kinds errors topology mesh facets search gap rows dual polygons areas segments
uses_cut_rates = kinds tensor dense topology shapes facets dual polygons segments
uses_row_rates = kinds topology facets rows segments mortar cut_rates

# 5 system: unknowns, residual, matrix
uses_state = kinds tensor topology mesh materials loads steps model shapes log_strain material_point slip node_overrides
uses_user_state = kinds errors user topology mesh materials loads model shapes points element state
uses_changes = mesh model state
uses_constraints = kinds errors sparse
uses_condensed = kinds errors sparse dense partition factor sprung constraints
uses_skew = kinds errors tensor sparse topology shapes
uses_assembly = kinds errors sparse partition topology mesh materials model batch element state user_state skew
uses_applied = kinds tensor topology mesh materials loads steps model shapes element areas state user_state skew assembly
uses_bonds = kinds errors tensor mesh loads ties model state constraints assembly
uses_supports = kinds errors mesh loads steps model state user_state constraints bonds
uses_damping = kinds sparse mesh steps state
uses_fasten = kinds errors tensor topology loads ties model shapes facets search gap areas
uses_meeting = kinds tensor surfaces slip compliance
uses_slaves = kinds surfaces state meeting
uses_derived = kinds tensor topology mesh materials surfaces model shapes material_point element dual state
uses_user_contact = kinds tensor user surfaces model state
uses_overlaps = kinds facets node_overrides state
uses_contact = kinds errors tensor profiles sparse topology surfaces steps model facets search analytic gap rows slip node_overrides areas mortar state constraints meeting slaves user_contact overlaps
uses_contact_forces = kinds sparse surfaces model facets rows slip node_overrides compliance state meeting slaves user_contact overlaps contact
uses_contact_start = kinds errors topology surfaces model search gap rows node_overrides areas mortar state slaves overlaps contact
uses_contact_points = kinds topology model shapes facets search rows facing mortar state contact
uses_contact_tangent = kinds tensor surfaces model gap rows slip cut_rates row_rates state constraints contact contact_forces
uses_contact_matrices = kinds errors tensor sparse sprung contact_tangent
uses_iterative = kinds sparse dense
uses_reduced = kinds errors text posix sparse partition factor mesh steps constraints iterative
uses_system = kinds errors history posix sparse surfaces steps model rows symmetry slip state changes constraints condensed assembly applied bonds supports damping slaves contact contact_forces contact_start contact_points contact_tangent reduced
uses_direction = kinds errors history sparse factor krylov sprung steps model state constraints condensed skew assembly applied bonds damping contact_tangent contact_matrices reduced system
uses_audit_bodies = kinds errors text topology mesh model element
uses_audit_contact = kinds errors text lookup topology surfaces loads model node_overrides state contact audit_bodies
uses_motions = kinds text tensor audit_bodies
uses_audit_motion = kinds errors text lookup tensor null_space topology surfaces steps model rows state contact audit_bodies audit_contact motions
uses_audit = kinds errors text lookup topology loads steps model element rows node_overrides state constraints bonds contact audit_bodies audit_contact audit_motion

# 6 solution: the increment, the steps, the results
uses_travel = kinds tensor topology model facets search analytic rows node_overrides state contact
uses_converge = kinds steps
uses_forensics = kinds state
uses_cycles = kinds surfaces gap node_overrides state contact forensics
uses_settle = kinds errors steps model state system direction forensics cycles
uses_line_search = kinds sparse surfaces steps model slip node_overrides state condensed reduced system travel
uses_carry = kinds errors mesh steps model rows state contact system direction settle
uses_course = kinds errors steps model state system direction converge settle carry
uses_newton = kinds errors history mesh steps model state system direction travel converge forensics cycles line_search course
uses_stepper = kinds steps converge
uses_columns = kinds errors history store
uses_inventory = kinds errors version profiles history store topology mesh materials surfaces steps model analytic columns
uses_results = kinds errors tensor history store mesh materials steps model state derived columns inventory
uses_dat_surfaces = kinds text tensor topology steps model state derived
uses_dat = kinds text tensor topology mesh materials steps model state derived dat_surfaces
uses_printed = kinds errors history posix steps model state dat
uses_frd = kinds errors version text lookup history posix dense topology mesh steps model shapes state derived dat_surfaces dat

# 7 roof: the job
uses_restart = kinds errors posix store model state reduced system newton stepper
uses_failure = kinds text history model node_overrides state system audit_motion converge forensics course newton
uses_user_job = kinds errors journal user materials surfaces model user_material state user_state
uses_drive = kinds errors text loads steps model
uses_job = kinds errors history store archive model state derived system newton stepper results printed frd restart drive
uses_analysis = kinds errors version text history posix journal dense factor archive steps model deck state user_state changes damping fasten slaves derived contact_start system audit converge forensics course newton stepper printed restart failure user_job drive job
uses_values = kinds errors text topology mesh materials state constraints derived columns results drive analysis
uses_library = kinds errors text posix journal sparse model slip state skew system direction converge stepper user_job drive analysis values
uses_capi = kinds errors version text posix sparse model library
uses_main = errors version posix journal model card_table deck analysis
