# Generated from the use lines by `make depends`: each module with the modules that it uses, bottom-up. Do not edit.

# base
uses_kinds =
uses_text = kinds
uses_containers = kinds text
uses_errors =
uses_failure = kinds
uses_iteration_records = kinds failure
uses_posix = kinds errors
uses_logger = kinds text errors iteration_records posix
uses_phase_clock = kinds iteration_records posix
uses_scalar_root = kinds
uses_tensor = kinds
uses_version =

# linear_algebra
uses_blas_lapack = kinds
uses_dense = kinds blas_lapack
uses_anderson_acceleration = kinds dense
uses_sparse = kinds errors
uses_factorization = kinds errors sparse
uses_coarse_factor = kinds errors sparse factorization
uses_column_singletons = kinds
uses_graph_partition = containers errors sparse
uses_incomplete_cholesky = kinds containers sparse
uses_krylov = kinds errors sparse
uses_matrix_reduction = kinds containers errors sparse
uses_midside_interpolation = kinds errors sparse
uses_null_space = kinds dense
uses_point_partition = kinds
uses_sparse_null_space = kinds containers null_space
uses_two_level_preconditioner = kinds containers errors dense sparse coarse_factor incomplete_cholesky midside_interpolation point_partition
uses_woodbury_interface = kinds errors blas_lapack dense sparse krylov

# distributed
uses_mpi_ranks = kinds errors
uses_distributed_solver = kinds errors sparse krylov two_level_preconditioner mpi_ranks
uses_divided_coarse_factor = kinds containers errors dense sparse factorization coarse_factor graph_partition mpi_ranks
uses_halo = kinds containers sparse mpi_ranks
uses_domain_matrix = kinds containers sparse mpi_ranks halo
uses_distributed_two_level = kinds errors sparse krylov two_level_preconditioner mpi_ranks divided_coarse_factor halo domain_matrix

# model
uses_analytic_profiles = kinds tensor
uses_controls = kinds
uses_element_kinds =
uses_embeddings = kinds
uses_loads = kinds
uses_user_routines = kinds text errors
uses_materials = kinds user_routines
uses_mesh = kinds containers tensor element_kinds
uses_restart_file = kinds text errors posix
uses_surfaces = kinds analytic_profiles
uses_mpc_data = kinds tensor
uses_steps = kinds controls loads surfaces
uses_structural_data = kinds
uses_submodels = kinds
uses_user_elements = kinds
uses_model = kinds containers embeddings loads user_routines materials mesh restart_file surfaces mpc_data steps structural_data submodels user_elements
uses_user_utilities = kinds tensor

# materials
uses_logarithmic_strain = kinds tensor
uses_elasticity = kinds tensor materials logarithmic_strain
uses_corotational_elasticity = kinds tensor elasticity
uses_rate_dependent_yield = kinds materials
uses_plasticity = kinds scalar_root user_routines materials rate_dependent_yield
uses_crystal_plasticity = kinds materials logarithmic_strain plasticity
uses_deviatoric_section = kinds scalar_root
uses_drucker_prager = kinds scalar_root materials plasticity
uses_drucker_prager_cap = kinds scalar_root materials plasticity
uses_hyperelasticity = kinds materials logarithmic_strain
uses_invariant_elasticity = kinds tensor materials logarithmic_strain elasticity
uses_one_sided_elasticity = kinds materials logarithmic_strain hyperelasticity
uses_principal_stress_cutoff = kinds tensor logarithmic_strain
uses_linear_viscoplasticity = kinds scalar_root tensor plasticity crystal_plasticity
uses_viscoelasticity = kinds tensor logarithmic_strain elasticity
uses_lode_angle_return = kinds scalar_root materials plasticity deviatoric_section drucker_prager
uses_user_material = kinds errors tensor user_routines materials logarithmic_strain elasticity
uses_material_point = kinds tensor user_routines materials logarithmic_strain elasticity corotational_elasticity plasticity crystal_plasticity drucker_prager drucker_prager_cap hyperelasticity invariant_elasticity one_sided_elasticity principal_stress_cutoff linear_viscoplasticity viscoelasticity lode_angle_return user_material
uses_element_integration_points = kinds tensor element_kinds user_routines materials user_material material_point
uses_material_axes = kinds tensor materials
uses_rubber_fit = kinds dense
uses_traction_separation = kinds materials logarithmic_strain
uses_zero_stress_condition = kinds tensor materials logarithmic_strain elasticity material_point element_integration_points

# elements
uses_beam_cross_sections = kinds dense
uses_beam_rules = kinds tensor element_kinds
uses_face_separation = kinds
uses_shape_functions = kinds tensor element_kinds beam_rules
uses_membrane_elements = kinds tensor element_kinds materials elasticity material_point element_integration_points zero_stress_condition shape_functions
uses_cohesive_elements = kinds tensor element_kinds materials element_integration_points traction_separation face_separation shape_functions membrane_elements
uses_truss_spring_mass = kinds element_kinds materials elasticity material_point element_integration_points zero_stress_condition shape_functions
uses_incompatible_modes = kinds tensor element_kinds
uses_hourglass = kinds tensor element_kinds materials
uses_hourglass_flow = kinds tensor element_kinds materials elasticity material_point element_integration_points zero_stress_condition hourglass
uses_plane_elements = kinds tensor element_kinds materials logarithmic_strain elasticity material_point element_integration_points zero_stress_condition shape_functions incompatible_modes hourglass hourglass_flow
uses_solid_shell = kinds tensor element_kinds materials logarithmic_strain elasticity material_point element_integration_points zero_stress_condition shape_functions incompatible_modes
uses_quadratic_solid_shell = kinds tensor element_kinds materials logarithmic_strain material_point element_integration_points shape_functions solid_shell
uses_solid_elements = kinds tensor element_kinds materials logarithmic_strain elasticity material_point element_integration_points zero_stress_condition beam_rules shape_functions incompatible_modes hourglass hourglass_flow solid_shell quadratic_solid_shell
uses_element = kinds tensor element_kinds materials element_integration_points shape_functions membrane_elements cohesive_elements truss_spring_mass plane_elements solid_elements
uses_face_foundation = kinds tensor element_kinds shape_functions
uses_solid_simd = kinds element_kinds materials elasticity shape_functions
uses_plastic_solid_simd = kinds tensor element_kinds materials logarithmic_strain plasticity material_point solid_simd
uses_section_beams = kinds tensor user_elements

# expansion
uses_directors = kinds tensor element_kinds mesh structural_data shape_functions
uses_equivalent_layers = kinds tensor dense
uses_expanded_elements = kinds element_kinds mesh structural_data
uses_parabolic_fibres = kinds loads structural_data model
uses_knots = kinds text containers tensor loads mesh mpc_data structural_data model parabolic_fibres
uses_expansion = model directors expanded_elements knots

# input
uses_cards = kinds text containers errors
uses_card_schema = kinds text containers cards
uses_card_cohesive = card_schema
uses_card_constraints = card_schema
uses_card_submodels = card_schema
uses_card_materials = card_schema card_cohesive card_submodels
uses_card_table = card_schema card_constraints card_submodels card_materials
uses_element_drafts = kinds containers
uses_deck_reader = kinds text containers mesh model cards card_schema
uses_deck_property_tables = kinds text materials model cards card_schema deck_reader
uses_deck_cohesive = kinds text element_kinds materials mesh model cards card_schema deck_reader deck_property_tables
uses_deck_labels = kinds text containers element_kinds user_elements cards card_schema
uses_deck_collapsed_elements = text containers element_kinds mesh element_drafts deck_reader
uses_deck_user_elements = kinds text containers element_kinds mesh steps user_elements model cards card_schema element_drafts deck_reader
uses_deck_mesh = kinds text containers element_kinds materials mesh user_elements model cards card_schema element_drafts deck_reader deck_labels deck_collapsed_elements deck_user_elements
uses_deck_imperfection = kinds text mesh model cards card_schema deck_reader deck_labels
uses_deck_submodel = kinds text containers structural_data submodels model cards card_schema deck_reader
uses_deck_cap = kinds text materials drucker_prager_cap deck_reader deck_property_tables
uses_deck_creep = text user_routines materials cards card_schema deck_reader deck_property_tables
uses_deck_elasticity = kinds text materials invariant_elasticity cards card_schema deck_reader deck_property_tables deck_cohesive
uses_deck_named_laws = kinds text materials model crystal_plasticity linear_viscoplasticity cards card_schema deck_reader deck_property_tables deck_elasticity
uses_deck_rate_dependence = kinds text materials model cards card_schema deck_reader deck_property_tables
uses_deck_test_data = kinds text materials model rubber_fit cards card_schema deck_reader
uses_deck_viscoelasticity = kinds element_kinds materials model cards card_schema deck_reader
uses_deck_materials = kinds text user_routines materials model elasticity plasticity viscoelasticity traction_separation cards card_schema deck_reader deck_property_tables deck_cohesive deck_cap deck_creep deck_elasticity deck_named_laws deck_rate_dependence deck_test_data deck_viscoelasticity
uses_deck_beams = kinds text element_kinds loads mesh structural_data model cards card_schema deck_reader deck_materials
uses_deck_named_nodes = text containers element_kinds model cards card_schema element_drafts deck_reader
uses_deck_transverse_shear = kinds text materials structural_data model elasticity equivalent_layers cards card_schema deck_reader deck_materials
uses_deck_section_beams = kinds text element_kinds materials user_elements model beam_cross_sections section_beams cards card_schema element_drafts deck_reader deck_user_elements deck_beams deck_transverse_shear
uses_deck_shell_stiffness = kinds text structural_data model equivalent_layers cards card_schema deck_reader deck_materials deck_transverse_shear
uses_deck_structure = kinds text controls element_kinds mesh mpc_data structural_data model expansion cards card_schema element_drafts deck_reader deck_beams deck_named_nodes deck_transverse_shear deck_section_beams deck_shell_stiffness
uses_deck_initial_conditions = kinds text containers element_kinds loads materials structural_data model cards card_schema deck_reader deck_submodel deck_structure
uses_deck_analytic_surfaces = kinds text tensor analytic_profiles mesh surfaces mpc_data model cards card_schema deck_reader
uses_deck_faces = containers element_kinds mesh deck_reader
uses_deck_surfaces = kinds text containers element_kinds loads user_routines mesh surfaces model cards card_schema deck_reader deck_structure deck_analytic_surfaces deck_faces
uses_deck_contact = kinds text element_kinds mesh surfaces steps model cards card_schema deck_reader deck_surfaces
uses_deck_embedded = kinds element_kinds embeddings model cards card_schema deck_reader
uses_deck_foundations = kinds text loads mesh model cards deck_reader deck_structure deck_surfaces
uses_deck_general_contact = kinds text containers element_kinds surfaces model cards card_schema deck_reader deck_structure
uses_deck_ties = kinds text surfaces mpc_data model cards card_schema deck_reader deck_structure
uses_deck_mpc = kinds text tensor mpc_data structural_data model cards card_schema deck_reader
uses_deck_couplings = kinds text tensor element_kinds mesh mpc_data structural_data model cards card_schema deck_reader deck_analytic_surfaces deck_faces deck_surfaces deck_ties deck_mpc
uses_deck_placement = kinds text tensor cards
uses_deck_parts = kinds text tensor cards deck_labels deck_placement
uses_deck_generate = kinds text tensor cards card_schema deck_labels
uses_deck_parameters = kinds text containers cards
uses_deck_restart = kinds text errors restart_file model cards card_schema
uses_explain = text element_kinds loads materials surfaces model cards card_schema deck_reader
uses_deck_springs = kinds text element_kinds materials mpc_data model cards card_schema element_drafts deck_reader deck_mesh deck_mpc deck_couplings
uses_deck_sets = text containers mesh model cards card_schema element_drafts deck_reader
uses_deck_output = kinds text element_kinds steps model cards card_schema card_table deck_reader
uses_load_propagation = kinds containers loads model
uses_deck_beam_loads = kinds text element_kinds loads structural_data model cards deck_reader load_propagation
uses_deck_loads = kinds text containers element_kinds loads materials mesh structural_data model cards card_schema deck_reader deck_submodel deck_structure deck_surfaces load_propagation deck_beam_loads
uses_deck_procedures = kinds text distributed_solver element_kinds materials steps structural_data model cards card_schema deck_reader deck_loads
uses_deck_steps = kinds text containers controls element_kinds loads materials mpc_data steps model cards card_schema deck_reader deck_user_elements deck_materials deck_initial_conditions deck_contact deck_output load_propagation deck_loads deck_procedures
uses_deck_plausibility = kinds text materials mesh model cards card_schema deck_reader
uses_deck = text containers errors posix materials mpc_data model cards card_schema card_table element_drafts deck_reader deck_cohesive deck_user_elements deck_mesh deck_imperfection deck_submodel deck_named_laws deck_viscoelasticity deck_materials deck_structure deck_initial_conditions deck_surfaces deck_contact deck_embedded deck_foundations deck_general_contact deck_mpc deck_couplings deck_parts deck_generate deck_parameters deck_restart explain deck_springs deck_sets deck_output deck_steps deck_plausibility

# contact_geometry
uses_facets = kinds containers errors tensor analytic_profiles element_kinds mesh shape_functions
uses_analytic_master = kinds tensor analytic_profiles element_kinds facets
uses_exterior_surface = kinds containers tensor element_kinds mesh facets
uses_facet_crossing = kinds tensor
uses_facet_search = kinds facets
uses_body_thickness = kinds mesh facets exterior_surface facet_crossing facet_search
uses_contact_constraint_rows = kinds element_kinds shape_functions facets analytic_master
uses_surface_projection = kinds tensor element_kinds shape_functions facets analytic_master facet_crossing facet_search
uses_master_symmetry_planes = kinds steps model facets surface_projection
uses_mesh_point_search = kinds element_kinds shape_functions facets facet_search
uses_self_contact_visibility = kinds containers tensor element_kinds facets facet_search surface_projection
uses_tributary_areas = kinds tensor element_kinds mesh surfaces shape_functions

# contact_laws
uses_friction_slip_scenarios = kinds surfaces
uses_pressure_overclosure = kinds surfaces friction_slip_scenarios
uses_slave_node_equilibrium = kinds tensor surfaces friction_slip_scenarios pressure_overclosure
uses_slave_node_overrides = kinds

# mortar
uses_dual_shape_functions = kinds dense element_kinds
uses_polygon_clipping = kinds element_kinds shape_functions facets
uses_mortar_segmentation = kinds tensor element_kinds facets facet_search dual_shape_functions polygon_clipping
uses_face_intersection_points = kinds tensor element_kinds shape_functions facets facet_search polygon_clipping mortar_segmentation
uses_segment_derivatives = kinds tensor dense element_kinds shape_functions facets dual_shape_functions polygon_clipping mortar_segmentation
uses_row_normals = kinds tensor element_kinds facets surface_projection mortar_segmentation segment_derivatives
uses_mortar = kinds containers errors element_kinds mesh facets facet_search contact_constraint_rows tributary_areas dual_shape_functions polygon_clipping mortar_segmentation row_normals
uses_mortar_linearization = kinds element_kinds facets contact_constraint_rows mortar_segmentation segment_derivatives mortar

# state
uses_state = kinds tensor element_kinds materials mesh steps structural_data user_elements model logarithmic_strain material_point material_axes shape_functions friction_slip_scenarios slave_node_overrides
uses_model_change = kinds materials mesh model state
uses_user_state = kinds errors tensor element_kinds loads user_routines materials mesh model user_material element_integration_points shape_functions element state

# assembly
uses_unsymmetric_tangent = kinds errors tensor sparse element_kinds shape_functions
uses_assembly_plan = kinds containers errors sparse graph_partition point_partition mpi_ranks element_kinds mesh solid_simd unsymmetric_tangent
uses_layer_stack = kinds tensor element_kinds structural_data model logarithmic_strain element_integration_points zero_stress_condition state
uses_assembly = kinds sparse mpi_ranks element_kinds materials mesh model user_material truss_spring_mass element solid_simd plastic_solid_simd state user_state unsymmetric_tangent assembly_plan layer_stack
uses_load_faces = kinds element_kinds mesh structural_data model
uses_external_loads = kinds tensor element_kinds loads materials mesh steps model shape_functions element face_foundation tributary_areas state user_state unsymmetric_tangent assembly_plan assembly load_faces
uses_inertia = kinds tensor element_kinds mesh steps model state assembly_plan external_loads
uses_stabilization = kinds sparse mesh steps model elasticity state
uses_user_element_forces = kinds user_routines steps user_elements model section_beams state assembly_plan

# constraints
uses_constraints = kinds errors sparse
uses_nonlinear_mpc = kinds errors tensor loads mesh mpc_data model state assembly_plan constraints
uses_boundary_conditions = kinds errors element_kinds mesh steps model state user_state constraints nonlinear_mpc
uses_embedded_elements = kinds text errors element_kinds embeddings loads model mesh_point_search
uses_shell_edge_coupling = kinds text containers errors tensor dense element_kinds loads mesh mpc_data structural_data model shape_functions facets facet_search mortar_segmentation
uses_tie_generation = kinds text errors tensor element_kinds loads mesh surfaces mpc_data structural_data model shape_functions facets facet_search surface_projection tributary_areas shell_edge_coupling

# contact
uses_body_motion = kinds containers loads materials mesh model exterior_surface
uses_slave_nodes = kinds surfaces slave_node_equilibrium state
uses_user_contact = kinds tensor user_routines surfaces model state
uses_shared_slave_nodes = kinds containers surfaces facets slave_node_overrides state
uses_midside_constraints = state
uses_contact_pairs = kinds containers errors tensor sparse analytic_profiles controls element_kinds surfaces steps model facets analytic_master exterior_surface facet_crossing facet_search contact_constraint_rows surface_projection self_contact_visibility tributary_areas friction_slip_scenarios slave_node_equilibrium slave_node_overrides mortar state constraints slave_nodes user_contact shared_slave_nodes midside_constraints
uses_mortar_seams = kinds surfaces contact_constraint_rows mortar state shared_slave_nodes contact_pairs
uses_first_touch = kinds model contact_constraint_rows state contact_pairs
uses_contact_evaluation = kinds sparse surfaces model facets contact_constraint_rows friction_slip_scenarios pressure_overclosure slave_node_equilibrium slave_node_overrides state slave_nodes user_contact shared_slave_nodes contact_pairs mortar_seams first_touch
uses_contact_heights = kinds model deck_structure exterior_surface
uses_contact_step = kinds element_kinds surfaces steps model facets state contact_pairs
uses_contact_initialization = kinds containers errors element_kinds surfaces model facets facet_search contact_constraint_rows surface_projection tributary_areas slave_node_overrides mortar state slave_nodes shared_slave_nodes contact_pairs mortar_seams contact_step
uses_contact_integration_points = kinds element_kinds model shape_functions facets facet_search contact_constraint_rows face_intersection_points mortar state contact_pairs
uses_contact_linearization = kinds tensor sparse surfaces model contact_constraint_rows surface_projection friction_slip_scenarios segment_derivatives row_normals mortar mortar_linearization state constraints contact_pairs contact_evaluation
uses_contact_operators = kinds containers errors tensor sparse woodbury_interface contact_linearization
uses_dependent_slaves = kinds text errors surfaces structural_data model elasticity tributary_areas constraints nonlinear_mpc
uses_driven_slaves = kinds text surfaces model contact_constraint_rows slave_node_overrides state constraints contact_pairs contact_step
uses_exterior_membership = mesh surfaces mpc_data model exterior_surface
uses_rigid_exterior = kinds text element_kinds mpc_data model
uses_face_proximity = kinds tensor facets exterior_surface facet_search mortar_segmentation contact_pairs rigid_exterior
uses_general_contact = kinds text containers surfaces model elasticity facets analytic_master exterior_surface facet_search body_thickness mortar_segmentation body_motion shared_slave_nodes contact_pairs contact_heights exterior_membership rigid_exterior face_proximity
uses_self_contact_pairs = kinds text element_kinds surfaces model exterior_surface mortar_segmentation general_contact
uses_unpaired_contact = kinds text containers model facets exterior_surface facet_search mortar_segmentation body_motion contact_pairs exterior_membership face_proximity general_contact self_contact_pairs
uses_unpaired_crossing = kinds text containers surfaces model facets analytic_master exterior_surface facet_crossing facet_search mortar_segmentation state body_motion exterior_membership rigid_exterior face_proximity general_contact unpaired_contact

# equilibrium
uses_arc_length = kinds steps model state
uses_reduced_system = kinds text errors posix sparse factorization graph_partition krylov matrix_reduction two_level_preconditioner mpi_ranks distributed_solver distributed_two_level controls element_kinds mesh steps constraints
uses_schur_interface = kinds errors dense sparse factorization graph_partition matrix_reduction woodbury_interface controls constraints
uses_contact_coarse_space = kinds blas_lapack sparse point_partition constraints reduced_system
uses_contact_tiles = kinds errors blas_lapack sparse
uses_contact_preconditioner = kinds errors dense sparse point_partition controls constraints reduced_system contact_coarse_space contact_tiles
uses_free_rigid_motions = kinds containers dense sparse two_level_preconditioner controls constraints
uses_equilibrium = kinds containers errors iteration_records phase_clock sparse factorization mpi_ranks controls surfaces steps user_elements model contact_constraint_rows master_symmetry_planes friction_slip_scenarios state model_change user_state assembly_plan assembly external_loads inertia stabilization user_element_forces constraints nonlinear_mpc boundary_conditions slave_nodes midside_constraints contact_pairs contact_evaluation contact_step contact_initialization contact_integration_points contact_linearization reduced_system schur_interface contact_preconditioner free_rigid_motions
uses_robin_springs = kinds errors tensor dense sparse controls contact_constraint_rows state shared_slave_nodes contact_pairs contact_linearization contact_operators
uses_tangent_solution = kinds errors sparse factorization krylov distributed_solver steps state unsymmetric_tangent assembly_plan constraints contact_operators arc_length reduced_system schur_interface contact_preconditioner equilibrium
uses_newton_step = kinds errors iteration_records sparse factorization woodbury_interface surfaces steps model contact_constraint_rows state unsymmetric_tangent assembly_plan assembly external_loads inertia stabilization user_element_forces constraints nonlinear_mpc contact_pairs contact_linearization contact_operators reduced_system schur_interface contact_preconditioner free_rigid_motions equilibrium robin_springs tangent_solution
uses_conjugate_gradient_preconditioner = kinds errors sparse controls steps model constraints contact_linearization reduced_system equilibrium newton_step

# model_check
uses_model_check_bodies = kinds text errors tensor element_kinds loads mesh model element
uses_model_check_contact = kinds text containers errors element_kinds loads surfaces model slave_node_overrides state shared_slave_nodes contact_pairs contact_initialization exterior_membership rigid_exterior model_check_bodies
uses_joined_bodies = kinds containers blas_lapack
uses_motion_rows = kinds containers column_singletons sparse_null_space joined_bodies
uses_rigid_modes = kinds text tensor model_check_bodies
uses_model_check_motion = kinds text containers errors tensor column_singletons null_space element_kinds loads mesh surfaces steps model contact_constraint_rows state stabilization nonlinear_mpc contact_pairs model_check_bodies model_check_contact motion_rows rigid_modes
uses_balanced_bodies = kinds text tensor loads mpc_data structural_data model state assembly_plan external_loads nonlinear_mpc model_check_bodies model_check_motion
uses_model_check_unpaired = kinds text containers errors element_kinds mesh surfaces model exterior_surface facet_search face_proximity general_contact model_check_bodies
uses_model_check = kinds text containers errors element_kinds loads mesh mpc_data steps model element contact_constraint_rows slave_node_overrides state constraints nonlinear_mpc contact_pairs model_check_bodies model_check_contact model_check_motion model_check_unpaired

# nonlinear
uses_active_set_history = kinds state
uses_active_set_cycling = kinds controls surfaces surface_projection slave_node_overrides state contact_pairs active_set_history
uses_convergence = kinds controls
uses_tunnelling_check = kinds element_kinds model facets analytic_master facet_crossing facet_search contact_constraint_rows slave_node_overrides mortar_segmentation state contact_pairs
uses_line_search = kinds sparse surfaces steps model friction_slip_scenarios slave_node_overrides state equilibrium tangent_solution tunnelling_check
uses_nonlinear_conjugate_gradients = kinds sparse controls mesh steps model contact_constraint_rows friction_slip_scenarios slave_node_overrides state contact_pairs equilibrium conjugate_gradient_preconditioner
uses_contact_rounds = kinds errors iteration_records anderson_acceleration controls surfaces steps model slave_node_overrides state contact_pairs equilibrium newton_step conjugate_gradient_preconditioner convergence line_search nonlinear_conjugate_gradients
uses_contact_subproblem = kinds errors steps model state equilibrium newton_step active_set_history active_set_cycling line_search
uses_creep_accuracy = kinds failure tensor element_kinds user_routines materials mesh steps model plasticity element state user_state
uses_failure_messages = kinds text failure
uses_proximal_step = kinds errors controls mesh steps model contact_constraint_rows state contact_pairs equilibrium newton_step contact_subproblem
uses_globalization = kinds errors controls steps model state equilibrium newton_step contact_subproblem proximal_step
uses_newton = kinds errors iteration_records controls mesh steps model state boundary_conditions equilibrium newton_step active_set_history active_set_cycling convergence tunnelling_check line_search contact_rounds globalization
uses_failure_report = kinds text failure iteration_records element_kinds model contact_constraint_rows slave_node_overrides state contact_pairs equilibrium model_check_bodies model_check_motion active_set_history convergence creep_accuracy failure_messages globalization newton
uses_increment_control = kinds failure steps convergence

# output
uses_hdf5_file = kinds errors posix
uses_checkpoint = kinds errors posix sparse steps model state reduced_system contact_preconditioner equilibrium newton increment_control hdf5_file
uses_postprocess = kinds tensor element_kinds materials mesh surfaces model material_point traction_separation beam_rules shape_functions element tributary_areas dual_shape_functions state
uses_dat_contact_output = kinds text tensor element_kinds steps model state postprocess
uses_section_forces = kinds tensor element_kinds materials mesh structural_data model material_axes shape_functions element state
uses_dat_output = kinds text tensor element_kinds materials mesh steps model beam_rules state postprocess dat_contact_output section_forces
uses_frd_input = kinds text containers errors element_kinds
uses_layer_nodes = mesh
uses_virtual_data_sets = kinds errors hdf5_file
uses_result_schema = kinds errors iteration_records hdf5_file virtual_data_sets
uses_nodal_fields = kinds tensor materials mesh surfaces model dual_shape_functions state postprocess section_forces result_schema
uses_frd_output = kinds text containers errors iteration_records posix version dense element_kinds mesh steps model shape_functions state postprocess dat_contact_output dat_output frd_input layer_nodes nodal_fields
uses_hdf5_input = kinds errors hdf5_file
uses_global_results = kinds text containers errors element_kinds frd_input hdf5_input
uses_result_cells = errors mesh hdf5_file virtual_data_sets
uses_result_partitions = containers errors graph_partition mesh model nodal_fields
uses_result_model = kinds errors iteration_records version analytic_profiles element_kinds materials mesh surfaces steps model analytic_master hdf5_file virtual_data_sets result_schema result_partitions
uses_results = kinds errors iteration_records materials mesh steps model state hdf5_file postprocess virtual_data_sets result_schema nodal_fields result_cells result_partitions result_model
uses_text_output = kinds errors iteration_records posix steps model state dat_output

# driver
uses_contact_checks = kinds model state constraints body_motion contact_pairs driven_slaves unpaired_contact unpaired_crossing
uses_driven_directors = kinds text containers errors tensor element_kinds structural_data model shape_functions mesh_point_search section_forces
uses_submodel_results = kinds text errors posix logger element_kinds loads steps submodels model deck_restart mesh_point_search global_results driven_directors
uses_user_routine_setup = kinds errors logger loads user_routines materials surfaces user_elements model user_material state user_state
uses_model_setup = kinds text errors logger loads model knots deck_structure embedded_elements tie_generation contact_initialization dependent_slaves general_contact self_contact_pairs balanced_bodies submodel_results user_routine_setup
uses_driven_loads = kinds text errors loads steps model
uses_partition_files = kinds errors iteration_records mpi_ranks model state hdf5_file result_partitions results
uses_job_files = kinds text errors failure iteration_records mpi_ranks restart_file model state unpaired_contact equilibrium newton increment_control hdf5_file checkpoint postprocess frd_output result_partitions results text_output driven_loads partition_files
uses_analysis = kinds text errors failure iteration_records posix logger version dense factorization mpi_ranks distributed_two_level user_routines materials restart_file steps model deck state model_change user_state assembly inertia stabilization user_element_forces slave_nodes arc_length equilibrium model_check_motion balanced_bodies model_check active_set_history convergence contact_rounds creep_accuracy failure_messages globalization newton failure_report increment_control checkpoint postprocess text_output contact_checks user_routine_setup model_setup driven_loads job_files
uses_job_query = kinds text containers errors element_kinds materials mesh state constraints postprocess result_schema nodal_fields results driven_loads analysis
uses_library = kinds text errors posix logger sparse mpi_ranks model friction_slip_scenarios state unsymmetric_tangent assembly equilibrium tangent_solution newton_step convergence increment_control user_routine_setup driven_loads analysis job_query
uses_c_interface = kinds text errors posix version sparse model library
uses_job_estimate = kinds text errors posix logger blas_lapack steps model assembly_plan assembly reduced_system schur_interface equilibrium newton_step job_files analysis
uses_main = errors posix logger version mpi_ranks model card_table deck model_setup analysis job_estimate
