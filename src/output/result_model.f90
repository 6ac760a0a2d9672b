!> Static model data of the result file: grid, mesh with sets, materials, pairs, steps, drawn analytic surfaces.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The grid contains analytic surfaces as points and cells for display, after the nodes and elements of the mesh. They move with
!! their carrier nodes and have no effect on the solution.
module amontons_result_model
  use amontons_kinds, only: DP, PI, NAME_LENGTH
  use amontons_errors, only: error_type
  use amontons_version, only: VERSION
  use amontons_element_kinds, only: element_kind, element_kind_type, MAX_FACE_NODES, KIND_T3D2, KIND_CPS4
  use amontons_mesh, only: mesh_type, set_type
  use amontons_surfaces, only: surface_type
  use amontons_steps, only: step_type
  use amontons_materials, only: law_name, MAX_LAW_NAME_LENGTH
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_iteration_records, only: PHASE_NAMES
  use amontons_hdf5_file, only: create_group, hdf5_file_type, hdf5_layout_type, write_attribute, write_data, STORAGE_I64, STORAGE_U8
  use amontons_virtual_data_sets, only: source_files_type, create_virtual
  use amontons_result_partitions, only: partition_type, first_places
  use amontons_result_schema, only: write_columns, CONTROL_COLUMNS, STEP_COLUMNS
  use amontons_analytic_profiles, only: analytic_profile_type, profile_coordinates, PROFILE_PLANAR, PROFILE_EXTRUDED, &
    PROFILE_REVOLVED
  use amontons_analytic_master, only: evaluate_carrier_weights
  implicit none
  private
  public :: drawn_surfaces_type, draw_nothing, draw_analytic_surfaces, drawn_displacements, write_grid, write_virtual_grid, &
    write_mesh, write_model_data

  integer, parameter :: MAX_NAME_LENGTH = 2 * NAME_LENGTH   !< of a set with the name of its instance before it
  real(DP), parameter :: MAX_ARC_ANGLE = PI / 36.0_DP   !< largest angle of a cell on an arc [rad]
  real(DP), parameter :: TOL_ANGLE = 1.0e-9_DP        !< of the number of angle steps: rounding to an integer [-]
  real(DP), parameter :: DRAWN_MARGIN = 0.1_DP       !< margin of an extruded surface beyond the mesh, over its size [-]

  !> Points and cells.
  type :: drawn_surfaces_type
    integer :: n_points = 0
    integer :: n_cells = 0
    real(DP), allocatable :: points(:, :)      !< (3, n_points) undeformed [length]
    integer, allocatable :: carriers(:, :)     !< (4, n_points) nodes; 0: none
    real(DP), allocatable :: weights(:, :)     !< (4, n_points) [-]
    integer, allocatable :: nodes(:)           !< points of all cells, from 1
    integer, allocatable :: last(:)            !< (n_cells) end of each cell in nodes
    integer, allocatable :: vtk_type(:)        !< (n_cells)
  end type drawn_surfaces_type

  ! Descriptions of the data sets of the grid.
  character(*), parameter :: GRID = '/VTKHDF/'
  character(*), parameter :: ABOUT_POINTS = 'Reference coordinates of the nodes.'
  character(*), parameter :: ABOUT_CONNECTIVITY = 'Nodes of all elements, one after the other.'
  character(*), parameter :: ABOUT_OFFSETS = 'Start of the nodes of each element in Connectivity, and the end.'
  character(*), parameter :: ABOUT_TYPES = 'VTK cell types.'

contains

  !> /VTKHDF: the mesh.
  !! Reference: VTK, Documentation/docs/vtk_file_formats/vtkhdf_file_format/vtkhdf_specifications.md, UnstructuredGrid.
  subroutine write_grid(store, mesh, drawn, error)
    type(hdf5_file_type), intent(in) :: store
    type(mesh_type), intent(in) :: mesh
    type(drawn_surfaces_type), intent(in) :: drawn           !< analytic surfaces, after the mesh
    type(error_type), allocatable, intent(out) :: error
    type(element_kind_type) :: entry
    real(DP), allocatable :: points(:, :)
    integer, allocatable :: nodes(:), first(:), vtk_type(:)
    integer :: e, kind
    allocate (vtk_type(mesh%n_elements))
    kind = 0
    do e = 1, mesh%n_elements
      if (mesh%kind(e) /= kind) entry = element_kind(mesh%kind(e))
      kind = mesh%kind(e)
      vtk_type(e) = entry%vtk_type
    end do
    vtk_type = [vtk_type, drawn%vtk_type]
    nodes = [mesh%nodes, mesh%n_nodes + drawn%nodes] - 1
    first = [mesh%first - 1, size(mesh%nodes) + drawn%last]
    allocate (points(3, mesh%n_nodes + drawn%n_points))
    points(:, :mesh%n_nodes) = mesh%coordinates
    points(:, mesh%n_nodes + 1:) = drawn%points
    call write_sizes(store, [mesh%n_nodes + drawn%n_points], [mesh%n_elements + drawn%n_cells], [size(nodes)], error)
    if (.not. allocated(error)) call write_data(store, GRID // 'Points', points, '[length]', ABOUT_POINTS, error)
    if (.not. allocated(error)) call write_data(store, GRID // 'Connectivity', nodes, '[-]', ABOUT_CONNECTIVITY, error, STORAGE_I64)
    if (.not. allocated(error)) call write_data(store, GRID // 'Offsets', first, '[-]', ABOUT_OFFSETS, error, STORAGE_I64)
    if (.not. allocated(error)) call write_data(store, GRID // 'Types', vtk_type, '[-]', ABOUT_TYPES, error, STORAGE_U8)
  end subroutine write_grid


  !> /VTKHDF of the file that ties partitions: their grids.
  subroutine write_virtual_grid(store, sources, n_points, n_cells, n_ids, error)
    type(hdf5_file_type), intent(in) :: store
    type(source_files_type), intent(in) :: sources           !< files of the partitions
    integer, intent(in) :: n_points(:), n_cells(:), n_ids(:) !< points, cells and length of Connectivity of each
    type(error_type), allocatable, intent(out) :: error
    type(hdf5_layout_type) :: long
    long = hdf5_layout_type(storage=STORAGE_I64)
    call write_sizes(store, n_points, n_cells, n_ids, error)
    if (.not. allocated(error)) call create_virtual(store, sources, n_points, GRID // 'Points', &
      hdf5_layout_type(width=3, is_matrix=.true.), .false., '[length]', ABOUT_POINTS, error)
    if (.not. allocated(error)) call create_virtual(store, sources, n_ids, GRID // 'Connectivity', long, .false., '[-]', &
      ABOUT_CONNECTIVITY, error)
    if (.not. allocated(error)) call create_virtual(store, sources, n_cells + 1, GRID // 'Offsets', long, .false., '[-]', &
      ABOUT_OFFSETS, error)
    if (.not. allocated(error)) call create_virtual(store, sources, n_cells, GRID // 'Types', &
      hdf5_layout_type(storage=STORAGE_U8), .false., '[-]', ABOUT_TYPES, error)
  end subroutine write_virtual_grid


  !> The group with its type, and the sizes of its parts.
  subroutine write_sizes(store, n_points, n_cells, n_ids, error)
    type(hdf5_file_type), intent(in) :: store
    integer, intent(in) :: n_points(:), n_cells(:), n_ids(:)
    type(error_type), allocatable, intent(out) :: error
    call create_group(store, '/VTKHDF', error)
    if (.not. allocated(error)) call write_attribute(store, '/VTKHDF', 'Version', [2, 0], error)
    if (.not. allocated(error)) call write_attribute(store, '/VTKHDF', 'Type', 'UnstructuredGrid', error)
    if (.not. allocated(error)) call write_data(store, GRID // 'NumberOfPoints', n_points, '[-]', &
      'Nodes, and points of analytic surfaces.', error, STORAGE_I64)
    if (.not. allocated(error)) call write_data(store, GRID // 'NumberOfCells', n_cells, '[-]', &
      'Elements, and cells of analytic surfaces.', error, STORAGE_I64)
    if (.not. allocated(error)) call write_data(store, GRID // 'NumberOfConnectivityIds', n_ids, '[-]', &
      'Length of Connectivity.', error, STORAGE_I64)
  end subroutine write_sizes


  !> /AMONTONS: data of the model before the first increment.
  subroutine write_model_data(store, model, mesh, order, error)
    type(hdf5_file_type), intent(in) :: store
    type(model_type), intent(in) :: model
    type(mesh_type), intent(in) :: mesh            !< in the order of the file
    type(partition_type), intent(in) :: order      !< nodes and elements of the model in this order
    type(error_type), allocatable, intent(out) :: error
    call write_texts(store, model, error)
    if (.not. allocated(error)) call write_mesh(store, mesh, error)
    if (.not. allocated(error)) call write_materials(store, model, error)
    if (.not. allocated(error)) call write_pairs(store, model, first_places(order%nodes, model%mesh%n_nodes), &
      first_places(order%elements, model%mesh%n_elements), error)
    if (.not. allocated(error)) call write_steps(store, model%steps, error)
  end subroutine write_model_data


  !> Deck, version, dialect, heading, names of the phases.
  subroutine write_texts(store, model, error)
    type(hdf5_file_type), intent(in) :: store
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    character(*), parameter :: ROOT = '/AMONTONS/'
    call write_data(store, ROOT // 'deck', text_or_empty(model%deck_text), '[-]', 'The deck, includes in place.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'heading', text_or_empty(model%heading), '[-]', &
      'Text of *HEADING.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'version', VERSION, &
      '[-]', 'Version of Amontons.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'dialect', &
      trim(merge('calculix', 'abaqus  ', model%dialect == DIALECT_CALCULIX)), '[-]', 'Dialect of the deck.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'phases', PHASE_NAMES, '[-]', &
      'Names of the columns of history/seconds.', error)
  end subroutine write_texts


  !> A text, empty if it was never set.
  pure function text_or_empty(text) result(value)
    character(:), allocatable, intent(in) :: text
    character(:), allocatable :: value
    value = ''
    if (allocated(text)) value = text
  end function text_or_empty


  !> /AMONTONS/mesh: labels, kinds, materials, first integration points and sets.
  subroutine write_mesh(store, mesh, error)
    type(hdf5_file_type), intent(in) :: store
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    character(*), parameter :: ROOT = '/AMONTONS/mesh/'
    type(element_kind_type) :: entry
    character(len(entry%name)) :: kind_name(mesh%n_elements)
    integer :: e, kind
    kind = 0
    do e = 1, mesh%n_elements
      if (mesh%kind(e) /= kind) entry = element_kind(mesh%kind(e))
      kind = mesh%kind(e)
      kind_name(e) = entry%name
    end do
    call create_group(store, '/AMONTONS/mesh', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'node_label', mesh%node_label, '[-]', &
      'Label of each node in the deck.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'element_label', mesh%element_label, '[-]', &
      'Label of each element in the deck.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'element_kind', kind_name, '[-]', &
      'Kind of each element.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'element_material', mesh%material - 1, '[-]', &
      'Index of the material of each element; -1: none.', error)
    if (.not. allocated(error)) call write_data(store, '/AMONTONS/integration_points/first', mesh%point_first - 1, &
      '[-]', &
      'First integration point of each element within a frame, and the end.', error)
    if (.not. allocated(error)) call write_sets(store, ROOT // 'node_sets', mesh%node_sets, error)
    if (.not. allocated(error)) call write_sets(store, ROOT // 'element_sets', mesh%element_sets, error)
  end subroutine write_mesh


  !> Named sets as three lists: name, first, members.
  subroutine write_sets(store, folder, sets, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: folder
    type(set_type), allocatable, intent(in) :: sets(:)
    type(error_type), allocatable, intent(out) :: error
    character(MAX_NAME_LENGTH), allocatable :: names(:)
    integer, allocatable :: first(:), members(:)
    integer :: i, n
    n = 0
    if (allocated(sets)) n = size(sets)
    allocate (names(n), first(n + 1), members(0))
    first(1) = 0
    do i = 1, n
      names(i) = sets(i)%name
      members = [members, sets(i)%members - 1]
      first(i + 1) = size(members)
    end do
    call create_group(store, folder, error)
    if (.not. allocated(error)) call write_data(store, folder // '/name', names, '[-]', 'Name of each set.', error)
    if (.not. allocated(error)) call write_data(store, folder // '/first', first, '[-]', &
      'Start of each set in members, and the end.', error)
    if (.not. allocated(error)) call write_data(store, folder // '/members', members, '[-]', &
      'Indices of all sets, one after the other.', error)
  end subroutine write_sets


  !> /AMONTONS/materials.
  subroutine write_materials(store, model, error)
    type(hdf5_file_type), intent(in) :: store
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    character(*), parameter :: ROOT = '/AMONTONS/materials/'
    character(MAX_NAME_LENGTH), allocatable :: names(:)
    character(MAX_LAW_NAME_LENGTH), allocatable :: laws(:)
    integer :: i, n
    n = size(model%materials)
    allocate (names(n), laws(n))
    do i = 1, n
      names(i) = model%materials(i)%name
      laws(i) = law_name(model%materials(i))
    end do
    call create_group(store, '/AMONTONS/materials', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'name', names, '[-]', 'Name of each material.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'law', laws, &
      '[-]', 'Law: the elastic one at finite strain, and what is added to it.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'youngs_modulus', (model%materials%youngs_modulus), &
      '[stress]', &
      'Young''s modulus.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'poissons_ratio', (model%materials%poissons_ratio), &
      '[-]', &
      'Poisson''s ratio.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'density', (model%materials%density), &
      '[mass/length^3]', 'Density.', error)
  end subroutine write_materials


  !> /AMONTONS/pairs: surfaces, friction and facets of the master of each contact pair.
  subroutine write_pairs(store, model, node_place, element_place, error)
    type(hdf5_file_type), intent(in) :: store
    type(model_type), intent(in) :: model
    integer, intent(in) :: node_place(:)           !< (n_nodes) in the file, from 1
    integer, intent(in) :: element_place(:)        !< (n_elements) likewise
    type(error_type), allocatable, intent(out) :: error
    character(*), parameter :: ROOT = '/AMONTONS/pairs/'
    character(MAX_NAME_LENGTH), allocatable :: names(:, :)
    real(DP), allocatable :: friction(:)
    integer, allocatable :: first(:), facets(:, :), small(:)
    integer :: i, n
    n = size(model%pairs)
    allocate (names(n, 2), friction(n), first(n + 1), small(n))
    first(1) = 0
    do i = 1, n
      associate (pair => model%pairs(i))
        names(i, 1) = model%surfaces(pair%slave)%name
        names(i, 2) = model%surfaces(pair%master)%name
        friction(i) = model%interactions(pair%interaction)%friction
        small(i) = merge(1, 0, pair%is_small_sliding)
        first(i + 1) = first(i) + size(model%surfaces(pair%master)%element)
      end associate
    end do
    allocate (facets(MAX_FACE_NODES + 2, first(n + 1)))
    do i = 1, n
      call list_facets(model%mesh, model%surfaces(model%pairs(i)%master), node_place, element_place, &
        facets(:, first(i) + 1:first(i + 1)))
    end do
    call create_group(store, '/AMONTONS/pairs', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'slave', names(:, 1), &
      '[-]', 'Slave surface of each pair.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'master', names(:, 2), &
      '[-]', 'Its master surface.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'friction', friction, &
      '[-]', 'Its coefficient of friction.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'is_small_sliding', small, '[-]', &
      '1: weights and normal kept from the start of the step.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'first', first, '[-]', &
      'Start of its facets in facet_nodes, facet_element and facet_face, and the end.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'facet_nodes', (facets(:MAX_FACE_NODES, :)), '[-]', &
      'Nodes of each facet: corners, then mid-sides, outward by the right-hand rule; -1 fills up.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'facet_element', (facets(MAX_FACE_NODES + 1, :)), &
      '[-]', 'Element of each facet.', error)
    if (.not. allocated(error)) call write_data(store, ROOT // 'facet_face', (facets(MAX_FACE_NODES + 2, :)), '[-]', &
      'Number of the facet in its element, 1 to 6 as in the deck (S1 to S6).', error)
  end subroutine write_pairs


  !> Nodes, element and face number of the facets of a surface; all but the face numbers from 0, -1 fills up.
  pure subroutine list_facets(mesh, surface, node_place, element_place, facets)
    type(mesh_type), intent(in) :: mesh
    type(surface_type), intent(in) :: surface
    integer, intent(in) :: node_place(:), element_place(:)   !< in the file, from 1
    integer, intent(out) :: facets(:, :)            !< (MAX_FACE_NODES + 2, n_facets)
    type(element_kind_type) :: entry
    integer :: i, k, e, local
    do i = 1, size(surface%element)
      e = surface%element(i)
      entry = element_kind(mesh%kind(e))
      do k = 1, MAX_FACE_NODES
        local = entry%face_nodes(k, surface%face(i))
        facets(k, i) = -1
        if (local > 0) facets(k, i) = node_place(mesh%nodes(mesh%first(e) + local - 1)) - 1
      end do
      facets(MAX_FACE_NODES + 1, i) = element_place(e) - 1
      facets(MAX_FACE_NODES + 2, i) = surface%face(i)
    end do
  end subroutine list_facets


  !> /AMONTONS/steps and /AMONTONS/controls: values used in each step.
  subroutine write_steps(store, steps, error)
    type(hdf5_file_type), intent(in) :: store
    type(step_type), intent(in) :: steps(:)
    type(error_type), allocatable, intent(out) :: error
    character(240) :: titles(size(steps))
    integer :: integers(7, size(steps)), i
    real(DP) :: reals(12, size(steps))
    do i = 1, size(steps)
      associate (step => steps(i))
        titles(i) = text_or_empty(step%title)
        integers(:6, i) = [merge(1, 0, step%is_nlgeom), step%max_increments, merge(1, 0, step%is_direct), &
          step%line_search, step%file_frequency, step%print_frequency]
        reals(:5, i) = [step%dt_initial, step%period, step%dt_min, step%dt_max, step%creep_tolerance]
      end associate
    end do
    call write_columns(store, '/AMONTONS/steps', STEP_COLUMNS, integers, reals, error)
    if (.not. allocated(error)) call write_data(store, '/AMONTONS/steps/title', titles, &
      '[-]', 'Line after *STEP.', error)
    do i = 1, size(steps)
      associate (c => steps(i)%controls)
        integers(:, i) = [c%i_0, c%i_r, c%i_p, c%i_c, c%i_l, c%i_g, c%i_a]
        reals(:, i) = [c%d_f, c%d_c, c%d_b, c%d_a, c%d_d, c%r_n, c%c_n, c%r_p, c%r_l, c%s_max, c%s_min, c%gap_tolerance]
      end associate
    end do
    if (.not. allocated(error)) call write_columns(store, '/AMONTONS/controls', CONTROL_COLUMNS, integers, reals, error)
  end subroutine write_steps


  !> All analytic surfaces of a model. Before: their carriers are known.
  subroutine draw_analytic_surfaces(model, drawn)
    type(model_type), intent(in) :: model
    type(drawn_surfaces_type), intent(out) :: drawn
    integer :: s, k
    call draw_nothing(drawn)
    if (.not. allocated(model%surfaces)) return
    do s = 1, size(model%surfaces)
      if (.not. allocated(model%surfaces(s)%profile)) cycle
      do k = 1, model%surfaces(s)%profile%n
        call draw_piece(model, model%surfaces(s)%profile, k, drawn)
      end do
    end do
  end subroutine draw_analytic_surfaces


  !> No surface.
  pure subroutine draw_nothing(drawn)
    type(drawn_surfaces_type), intent(out) :: drawn
    allocate (drawn%points(3, 0), drawn%carriers(4, 0), drawn%weights(4, 0), drawn%nodes(0), drawn%last(0), drawn%vtk_type(0))
  end subroutine draw_nothing


  !> One piece: points along it and across, cells between them.
  subroutine draw_piece(model, profile, k, drawn)
    type(model_type), intent(in) :: model
    type(analytic_profile_type), intent(in) :: profile
    integer, intent(in) :: k
    type(drawn_surfaces_type), intent(inout) :: drawn
    real(DP) :: X(3), p(2), normal(2), at(2)
    integer :: n_along, n_across, i, j, first, corner
    n_along = 1
    if (abs(profile%signed_radius(k)) > 0.0_DP) n_along = ceiling((1.0_DP - TOL_ANGLE) * profile%piece_length(k) &
      / (abs(profile%signed_radius(k)) * MAX_ARC_ANGLE))
    n_across = merge(0, 1, profile%kind == PROFILE_PLANAR)
    if (profile%kind == PROFILE_REVOLVED) n_across = nint(2.0_DP * PI / MAX_ARC_ANGLE)
    at = transverse_range(model, profile)
    first = drawn%n_points
    do j = 0, n_across
      do i = 0, n_along
        call profile_coordinates(profile, k, [real(i, DP) / real(n_along, DP), at(1) + (at(2) - at(1)) * real(j, DP) / &
          real(max(n_across, 1), DP)], X, p, normal)
        call add_point(profile, X, drawn)
      end do
    end do
    do j = 1, max(n_across, 1)
      do i = 1, n_along
        corner = first + (j - 1) * (n_along + 1) + i
        if (n_across == 0) call add_cell([corner, corner + 1], drawn)
        if (n_across > 0) call add_cell([corner, corner + 1, corner + n_along + 2, corner + n_along + 1], drawn)
      end do
    end do
  end subroutine draw_piece


  !> Range of a surface across its profile: the mesh with a margin, or the full circle.
  pure function transverse_range(model, profile) result(at)
    type(model_type), intent(in) :: model
    type(analytic_profile_type), intent(in) :: profile
    real(DP) :: at(2), along(model%mesh%n_nodes)
    at = 0.0_DP
    if (profile%kind == PROFILE_REVOLVED) at = [0.0_DP, 2.0_DP * PI]
    if (profile%kind /= PROFILE_EXTRUDED) return
    along = matmul(profile%axes(:, 3), model%mesh%coordinates - spread(profile%origin, 2, model%mesh%n_nodes))
    at = [minval(along, mask=model%mesh%has_elements), maxval(along, mask=model%mesh%has_elements)]
    at = at + DRAWN_MARGIN * (at(2) - at(1)) * [-1.0_DP, 1.0_DP]
  end function transverse_range


  !> Adds a point.
  pure subroutine add_point(profile, X, drawn)
    type(analytic_profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)               !< [length]
    type(drawn_surfaces_type), intent(inout) :: drawn
    integer :: n
    n = drawn%n_points + 1
    drawn%n_points = n
    drawn%points = reshape([drawn%points, X], [3, n])
    drawn%carriers = reshape([drawn%carriers, profile%carriers], [4, n])
    drawn%weights = reshape([drawn%weights, evaluate_carrier_weights(profile, X)], [4, n])
  end subroutine add_point


  !> Adds a cell: a line or a quadrilateral.
  pure subroutine add_cell(corners, drawn)
    integer, intent(in) :: corners(:)
    type(drawn_surfaces_type), intent(inout) :: drawn
    type(element_kind_type) :: entry
    entry = element_kind(merge(KIND_T3D2, KIND_CPS4, size(corners) == 2))
    drawn%nodes = [drawn%nodes, corners]
    drawn%last = [drawn%last, size(drawn%nodes)]
    drawn%vtk_type = [drawn%vtk_type, entry%vtk_type]
    drawn%n_cells = drawn%n_cells + 1
  end subroutine add_cell


  !> The displacements of the points.
  pure function drawn_displacements(drawn, u) result(moved)
    type(drawn_surfaces_type), intent(in) :: drawn
    real(DP), intent(in) :: u(:, :)            !< (3, n_nodes) [length]
    real(DP) :: moved(3, drawn%n_points)
    integer :: i, k
    moved = 0.0_DP
    do i = 1, drawn%n_points
      do k = 1, 4
        if (drawn%carriers(k, i) > 0) moved(:, i) = moved(:, i) + drawn%weights(k, i) * u(:, drawn%carriers(k, i))
      end do
    end do
  end function drawn_displacements

end module amontons_result_model
