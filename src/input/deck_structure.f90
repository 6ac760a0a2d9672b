!> Sections of shells and beams, NODAL THICKNESS and NORMAL; expansion of shells and beams into solids.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_structure
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text, field_integer, field_real
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_controls, only: controls_type
  use amontons_deck_beams, only: read_beam_section, pass_integration_points, read_general_material, section_offset, &
    add_middle_nodes, mark_plane_beams, hold_plane_beams
  use amontons_deck_named_nodes, only: find_turned_nodes, find_constrained_nodes
  use amontons_deck_section_beams, only: is_section_beam, read_section_beam
  use amontons_deck_shell_stiffness, only: read_shell_stiffness
  use amontons_deck_transverse_shear, only: has_transverse_shear, report_lost_shear, refuse_beam_shear, replace_materials
  use amontons_element_drafts, only: element_draft_type
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, check_n_fields, &
    nodes_of_field, elements_of_field, is_card, check_no_data
  use amontons_expansion, only: expand_structure
  use amontons_mesh, only: mesh_type, face_number_here
  use amontons_model, only: model_type, free_unknowns, dof_direction, DIALECT_CALCULIX
  use amontons_structural_data, only: structure_type, director_type, structural_section_type, layer_type, find_node_directors, &
    n_section_layers
  use amontons_mpc_data, only: MPC_MEAN_ROTATION
  use amontons_text, only: plural, verb, to_text, NUMBER_OK
  use amontons_element_kinds, only: element_kind_type, element_kind, FAMILY_SHELL, FAMILY_BEAM, KIND_S6, KIND_S8, KIND_S8R, &
    KIND_SAX1, KIND_SAX2, KIND_CAX_SHELL, FAMILY_RIGID, is_two_sided, is_structural_family
  implicit none
  private
  public :: read_structural_sections, read_structure, free_slave_nodes, order_slave_terms, structural_face, is_shell, &
    is_shell_edge, spread_temperature, refine_thin_shells, OTHER_LAYER

  integer, parameter :: OTHER_LAYER = -1         !< the face belongs to another layer of the shell

contains

  !> Reads all sections of shells and beams. The members of the element sets are indices of drafts here.
  subroutine read_structural_sections(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model     !< with the element sets of drafts; out: with structure%sections
    type(element_draft_type), intent(inout) :: draft
    type(structural_section_type) :: section
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: c, set, material
    logical :: is_quadratic
    do c = 1, reader%cards%n_cards
      if (.not. (is_card(reader, c, 'SHELLSECTION') .or. is_card(reader, c, 'SHELLGENERALSECTION') .or. &
        is_card(reader, c, 'BEAMSECTION') .or. is_card(reader, c, 'BEAMGENERALSECTION'))) cycle
      call open_card(reader, c, parameters, row)
      set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
      material = reader%materials%find(parameter_text(parameters, 'MATERIAL'))
      associate (line => reader%cards%cards(c)%line)
        if (set == 0 .and. has_parameter(parameters, 'ELSET')) call report_error(reader, line, 'There is no element set ''' // &
          parameter_text(parameters, 'ELSET') // '''' // reader%element_sets%suggest(parameter_text(parameters, 'ELSET')))
        if (material == 0 .and. has_parameter(parameters, 'MATERIAL')) call report_error(reader, line, &
          'There is no material ''' // parameter_text(parameters, 'MATERIAL') // '''' // &
          reader%materials%suggest(parameter_text(parameters, 'MATERIAL')))
      end associate
      if (is_section_beam(reader, c, parameters)) then
        call read_section_beam(reader, c, parameters, row, set, material, model, draft)
        cycle
      end if
      section = structural_section_type()
      section%line = reader%cards%line_number(reader%cards%cards(c)%line)
      section%deck_line = reader%cards%cards(c)%line
      if (is_card(reader, c, 'SHELLSECTION') .or. is_card(reader, c, 'SHELLGENERALSECTION')) then
        is_quadratic = has_quadratic_shells(reader, c, parameters, model, set, draft)
        call read_shell_section(reader, c, parameters, row, is_quadratic, section, model)
        if (has_parameter(parameters, 'MATERIAL') .or. has_parameter(parameters, 'COMPOSITE')) call replace_materials(reader, c, &
          is_quadratic, section, material, model)
        if (set > 0 .and. material > 0) call refuse_axisymmetric_law(reader, c, model, set, material, draft)
        if (allocated(section%layers)) material = section%layers(1)%material
      else
        call read_beam_section(reader, c, parameters, row, section)
        call refuse_beam_shear(reader, c)
        if (is_card(reader, c, 'BEAMGENERALSECTION') .and. .not. has_parameter(parameters, 'MATERIAL')) then
          call read_general_material(reader, c, parameters, row, model)
          material = size(model%materials)
        else
          call pass_integration_points(reader, row)
        end if
      end if
      if (set == 0) cycle
      if (.not. allocated(model%structure)) then
        allocate (model%structure)
        allocate (model%structure%sections(0))
      end if
      model%structure%sections = [model%structure%sections, section]
      call assign_section(reader, model, c, set, material, draft)
    end do
    call report_lost_shear(reader)
    if (any(draft%is_rigid)) call add_rigid_sections(reader, model, draft)
  end subroutine read_structural_sections


  !> Reports axisymmetric shells whose UMAT would be called for the plane stress of shells.
  subroutine refuse_axisymmetric_law(reader, c, model, set, material, draft)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    type(model_type), intent(in) :: model        !< with the element sets of drafts
    integer, intent(in) :: set, material         !< of the section
    type(element_draft_type), intent(in) :: draft
    integer :: i
    if (.not. model%materials(material)%is_shell_law) return
    associate (members => model%mesh%element_sets(set)%members)
      if (any([(any(draft%kind(members(i)) == [KIND_SAX1, KIND_SAX2]), i=1, size(members))])) call report_error(reader, &
        reader%cards%cards(c)%line, 'SAX1 and SAX2 of a *USER MATERIAL take no *TRANSVERSE SHEAR STIFFNESS: they are ' // &
        'axisymmetric solids here, for which UMAT is called with NTENS = 4. Leave the card out.')
    end associate
  end subroutine refuse_axisymmetric_law


  !> Whether the displacement of the shells of a section is quadratic over the thickness, on which the materials of layers with a
  !! transverse shear stiffness depend.
  logical function has_quadratic_shells(reader, c, parameters, model, set, draft) result(is_so)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    type(parameter_type), intent(in) :: parameters(:)
    type(model_type), intent(in) :: model        !< with the element sets of drafts
    integer, intent(in) :: set                   !< 0: none, reported
    type(element_draft_type), intent(in) :: draft
    integer, parameter :: QUADRATIC(5) = [KIND_S6, KIND_S8, KIND_S8R, KIND_SAX1, KIND_SAX2]
    logical, allocatable :: is_quadratic(:)
    integer :: i
    is_so = .false.
    if (set == 0) return
    associate (members => model%mesh%element_sets(set)%members)
      is_quadratic = [(any(draft%kind(members(i)) == QUADRATIC), i=1, size(members))]
    end associate
    is_so = all(is_quadratic)
    if ((is_so .eqv. any(is_quadratic)) .or. .not. has_transverse_shear(reader, c)) return
    if (has_parameter(parameters, 'COMPOSITE') .or. .not. has_parameter(parameters, 'MATERIAL')) call report_error(reader, &
      reader%cards%cards(c)%line, 'A section of layers with *TRANSVERSE SHEAR STIFFNESS is for S3 and S4 or for S6, S8, S8R, ' // &
      'SAX1 and SAX2, not for both: give each group a section of its own.')
  end function has_quadratic_shells


  !> Rigid elements become thin shells whose nodes all belong to their rigid body: they do not strain, whatever their material. A
  !! millionth of the mean edge is thin enough for their faces and thick enough for the numbers of a body that does not bend.
  subroutine add_rigid_sections(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model     !< with the element sets of drafts; out: with structure%sections
    type(element_draft_type), intent(inout) :: draft
    real(DP), parameter :: THICKNESS_RATIO = 1.0e-6_DP   !< over the mean edge [-]
    type(structural_section_type) :: section
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer, allocatable :: members(:)
    integer :: c, set
    call report_sections_of_rigid(reader, draft)
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'RIGIDBODY')) cycle
      call open_card(reader, c, parameters, row)
      set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
      if (set == 0) cycle                        ! without ELSET, or its error is reported later
      associate (all_members => model%mesh%element_sets(set)%members)
        members = pack(all_members, draft%is_rigid(all_members))
      end associate
      draft%section_card(members) = c
      members = pack(members, is_expanded_rigid(draft%kind(members)))
      if (size(members) == 0) cycle
      section = structural_section_type(family=FAMILY_SHELL, card='RIGID BODY')
      section%line = reader%cards%line_number(reader%cards%cards(c)%line)
      section%thickness(1) = THICKNESS_RATIO * mean_edge(model%mesh%coordinates, draft, members)
      if (.not. allocated(model%structure)) then
        allocate (model%structure)
        allocate (model%structure%sections(0))
      end if
      model%structure%sections = [model%structure%sections, section]
      draft%material(members) = merge(1, -1, size(model%materials) > 0)
      draft%section(members) = size(model%structure%sections)
    end do
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'ELEMENT')) cycle
      associate (first => draft%element_first(c), last => draft%element_last(c))
        if (.not. any(draft%is_rigid(first:last) .and. draft%section_card(first:last) == 0)) cycle
        set = first - 1 + findloc(draft%is_rigid(first:last) .and. draft%section_card(first:last) == 0, .true., dim=1)
        draft%material(first:last) = -1          ! one message is enough
        call report_error(reader, reader%cards%cards(c)%line, 'The rigid element ' // to_text(draft%label(set)) // &
          ' belongs to no *RIGID BODY, ELSET=, REF NODE=.')
      end associate
    end do
  end subroutine add_rigid_sections


  !> Whether a rigid element becomes a thin shell: R3D3, R3D4. Those in the plane have faces of their own.
  elemental logical function is_expanded_rigid(kind)
    integer, intent(in) :: kind                  !< KIND_..., 0: unknown
    type(element_kind_type) :: entry
    is_expanded_rigid = kind > 0
    if (kind == 0) return
    entry = element_kind(kind)
    is_expanded_rigid = entry%family /= FAMILY_RIGID
  end function is_expanded_rigid


  !> Reports the first rigid element that a section names.
  subroutine report_sections_of_rigid(reader, draft)
    type(reader_type), intent(inout) :: reader
    type(element_draft_type), intent(inout) :: draft
    integer :: e
    do e = 1, draft%n
      if (.not. draft%is_rigid(e) .or. draft%section_card(e) == 0) cycle
      call report_error(reader, reader%cards%cards(draft%section_card(e))%line, 'The element ' // to_text(draft%label(e)) // &
        ' is rigid and needs no section; *RIGID BODY, ELSET= holds it. Take it out of this set.')
      return
    end do
  end subroutine report_sections_of_rigid


  !> The mean edge of some elements of three or four nodes [length].
  pure real(DP) function mean_edge(x, draft, members) result(edge)
    real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) coordinates of the nodes [length]
    type(element_draft_type), intent(in) :: draft
    integer, intent(in) :: members(:)            !< drafts
    integer :: i, k, n, n_edges
    edge = 0
    n_edges = 0
    do i = 1, size(members)
      associate (nodes => draft%nodes%items(draft%first(members(i)):draft%first(members(i) + 1) - 1))
        n = size(nodes)
        if (any(nodes < 1)) cycle                ! a missing node: its error is reported
        edge = edge + sum([(norm2(x(:, nodes(modulo(k, n) + 1)) - x(:, nodes(k))), k=1, n)])
        n_edges = n_edges + n
      end associate
    end do
    edge = merge(edge / real(max(n_edges, 1), DP), 1.0_DP, n_edges > 0)
  end function mean_edge


  !> Gives the members of a set the last section.
  subroutine assign_section(reader, model, c, set, material, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c, set, material      !< card, element set, material or 0
    type(element_draft_type), intent(inout) :: draft
    type(element_kind_type) :: entry
    integer :: i, e, family
    logical :: is_ok
    family = model%structure%sections(size(model%structure%sections))%family
    do i = 1, size(model%mesh%element_sets(set)%members)
      e = model%mesh%element_sets(set)%members(i)
      draft%material(e) = merge(material, -1, material > 0)
      draft%section(e) = size(model%structure%sections)
      draft%section_card(e) = c
      draft%n_layers(e) = n_section_layers(model%structure%sections(draft%section(e)))
      if (draft%kind(e) == 0) cycle
      entry = element_kind(draft%kind(e))
      if (draft%kind(e) == KIND_SAX1 .or. draft%kind(e) == KIND_SAX2) then
        call check_meridian_axes(reader, reader%cards%cards(c)%line, model%structure%sections(size(model%structure%sections)), &
          is_ok)
        if (.not. is_ok) return
      end if
      if (entry%family == family) then
        if (draft%n_layers(e) == 1 .or. reader%dialect /= DIALECT_CALCULIX) cycle
        if (draft%kind(e) == KIND_S6 .or. draft%kind(e) == KIND_S8R) cycle
        call report_error(reader, reader%cards%cards(c)%line, 'The element ' // to_text(draft%label(e)) // ' is a ' // &
          trim(entry%name) // '; COMPOSITE is for S6 and S8R in the calculix dialect.')
        return
      end if
      draft%n_layers(e) = 1
      draft%section(e) = 0
      call report_error(reader, reader%cards%cards(c)%line, 'The element ' // to_text(draft%label(e)) // ' is a ' // &
        trim(entry%name) // '; *' // model%structure%sections(size(model%structure%sections))%card // ' is for ' // &
        trim(merge('shells', 'beams ', family == FAMILY_SHELL)) // '.')
      return
    end do
  end subroutine assign_section


  !> Axes of axisymmetric shells: direction 1 follows the line, layers lie along or across it.
  subroutine check_meridian_axes(reader, line, section, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the section
    type(structural_section_type), intent(in) :: section
    logical, intent(out) :: is_ok
    real(DP), parameter :: TOL_RIGHT_ANGLE = 1.0e-9_DP   !< of a multiple of the right angle [-]
    integer :: l
    is_ok = .true.
    if (allocated(section%orientation)) is_ok = section%orientation == ''
    do l = 1, n_section_layers(section)
      if (.not. allocated(section%layers)) exit
      if (allocated(section%layers(l)%orientation)) is_ok = is_ok .and. section%layers(l)%orientation == ''
      is_ok = is_ok .and. abs(sin(2 * section%layers(l)%angle)) <= TOL_RIGHT_ANGLE
    end do
    if (.not. is_ok) call report_error(reader, line, 'Direction 1 of SAX1 and SAX2 follows their line, direction 2 the ' // &
      'circle: leave ORIENTATION out; the angles of layers are multiples of 90.')
  end subroutine check_meridian_axes


  !> SHELL SECTION, SHELL GENERAL SECTION: thickness and number of points, which are those of the solids here; layers; stiffness.
  subroutine read_shell_section(reader, c, parameters, row, is_quadratic, section, model)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    logical, intent(in) :: is_quadratic          !< the elements are
    type(structural_section_type), intent(inout) :: section
    type(model_type), intent(inout) :: model     !< out: with the materials that a stiffness needs
    logical :: is_ok
    section%family = FAMILY_SHELL
    section%card = trim(merge('SHELL SECTION        ', 'SHELL GENERAL SECTION', is_card(reader, c, 'SHELLSECTION')))
    section%has_nodal_thickness = has_parameter(parameters, 'NODAL THICKNESS')
    section%offset(1) = section_offset(reader, c, parameters, 'OFFSET')
    section%orientation = parameter_text(parameters, 'ORIENTATION')
    is_ok = .true.
    if (is_card(reader, c, 'SHELLGENERALSECTION') .and. reader%dialect == DIALECT_CALCULIX) call report_error(reader, &
      reader%cards%cards(c)%line, 'CalculiX has no *SHELL GENERAL SECTION; use *SHELL SECTION.')
    if (has_parameter(parameters, 'COMPOSITE')) then
      if (has_parameter(parameters, 'MATERIAL')) call report_error(reader, reader%cards%cards(c)%line, 'With COMPOSITE the ' // &
        'data lines name the materials; leave MATERIAL out.')
      call read_layers(reader, c, row, section)
      return
    end if
    if (is_card(reader, c, 'SHELLGENERALSECTION') .and. .not. has_parameter(parameters, 'MATERIAL')) then
      if (section%has_nodal_thickness) call report_error(reader, reader%cards%cards(c)%line, 'A section that is given by its ' // &
        'stiffness has no NODAL THICKNESS.')
      call read_shell_stiffness(reader, c, parameters, row, is_quadratic, section, model)
      return
    end if
    if (.not. has_parameter(parameters, 'MATERIAL')) call report_error(reader, reader%cards%cards(c)%line, &
      '*SHELL SECTION needs MATERIAL, or COMPOSITE with a material on each data line.')
    if (next_row(reader%cards, row)) then
      call check_n_fields(reader, row, 2)
      call read_real(reader, row, 1, 'thickness', section%thickness(1), is_ok, 0.0_DP)
      if (is_ok .and. .not. section%thickness(1) > 0) call report_error(reader, row%line, 'The thickness must be positive.')
      if (next_row(reader%cards, row)) call check_no_data(reader, row)
    else if (.not. section%has_nodal_thickness) then
      call report_error(reader, reader%cards%cards(c)%line, '*' // section%card // &
        ' needs a data line with the thickness.')
    end if
  end subroutine read_shell_section


  !> The layers of a composite shell: thickness, points, material, orientation or angle, name of the ply.
  subroutine read_layers(reader, c, row, section)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row
    type(structural_section_type), intent(inout) :: section
    type(layer_type) :: layer
    character(:), allocatable :: name
    integer :: status
    logical :: is_ok
    allocate (section%layers(0))
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 5)
      layer = layer_type(line=row%line)
      is_ok = .true.
      call read_real(reader, row, 1, 'thickness of the layer', layer%thickness, is_ok)
      if (is_ok .and. .not. layer%thickness > 0) call report_error(reader, row%line, 'The thickness must be positive.')
      name = field_text(reader%cards, row, 3)
      layer%material = reader%materials%find(name)
      if (layer%material == 0) call report_error(reader, row%line, 'The third field must name the material of the layer; ' // &
        'there is no material ''' // name // '''' // reader%materials%suggest(name))
      layer%orientation = field_text(reader%cards, row, 4)
      if (reader%dialect /= DIALECT_CALCULIX) then
        call field_real(reader%cards, row, 4, layer%angle, status)
        if (status == NUMBER_OK) layer%orientation = ''
        layer%angle = merge(layer%angle * PI / 180, 0.0_DP, status == NUMBER_OK)
      end if
      section%layers = [section%layers, layer]
    end do
    section%thickness(1) = sum(section%layers%thickness)
    if (size(section%layers) > 0) return
    call report_error(reader, reader%cards%cards(c)%line, '*' // section%card // ', COMPOSITE needs a data line for each ' // &
      'layer: thickness, number of points, material, orientation or angle.')
    deallocate (section%layers)
  end subroutine read_layers


  !> Expands the structural elements of the mesh. Sets, sections and elements must be read.
  subroutine read_structure(reader, model, draft)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(element_draft_type), intent(in) :: draft
    type(element_kind_type) :: entry
    integer :: e, bad_element, n_given
    if (.not. allocated(model%structure)) return
    associate (structure => model%structure, mesh => model%mesh)
      allocate (structure%section(mesh%n_elements), source=0)
      do e = 1, draft%n
        if (draft%mesh_index(e) == 0) cycle
        structure%section(draft%mesh_index(e):draft%mesh_index(e) + draft%n_layers(e) - 1) = draft%section(e)
      end do
      do e = 1, mesh%n_elements
        if (structure%section(e) == 0) cycle
        associate (section => structure%sections(structure%section(e)))
          if (allocated(section%layers)) mesh%material(e) = max(1, section%layers(mesh%layer(e))%material)
        end associate
      end do
      do e = 1, mesh%n_elements
        entry = element_kind(mesh%kind(e))
        if (is_structural_family(entry%family) .and. structure%section(e) == 0) return   ! without a section: its error is reported
      end do
      if (any(mesh%nodes < 1)) return            ! so are those of missing nodes
      n_given = mesh%n_nodes
      call add_middle_nodes(mesh, structure)
      structure%kind = mesh%kind
      structure%first = mesh%first
      structure%nodes = mesh%nodes
      call read_nodal_thickness(reader, n_given, model)
      call read_normals(reader, model)
      call find_turned_nodes(reader, draft, model)
      call find_constrained_nodes(reader, model)
      call mark_plane_beams(mesh, structure)
      call expand_structure(model, bad_element, has_nlgeom(reader))
      if (bad_element == 0) call list_added_nodes(n_given, mesh, structure)
      if (bad_element == 0) call hold_plane_beams(model)
      if (bad_element > 0 .and. reader%messages%n_errors == 0) call report_error(reader, 0, 'The element ' // &
        to_text(mesh%element_label(bad_element)) // ' has no normal at one of its nodes: it has no area ' // &
        'there, or the first direction of a beam is along the beam.')
    end associate
  end subroutine read_structure


  !> The part of bending that one linear solution loses by rounding. The stiffness across the thickness t exceeds that of the
  !! softest bending of a body of extent L with elements of size h by (h L/t^2)^2, in layers of t_l by h^2 L^2/(t_l t^3);
  !! displacements of cantilevers of S4 err by less than 1e-14 times that (`python -m verify.study.thin_shells`). Shells whose nodes
  !! are held along the normal do not bend.
  pure subroutine estimate_rounding(model, error, element)
    type(model_type), intent(in) :: model
    real(DP), intent(out) :: error                 !< of the displacements [-]
    integer, intent(out) :: element                !< where it is largest; 0: there is no shell
    real(DP), parameter :: ERROR_OF_ROUNDING = 1.0e-14_DP   !< over (h L/t^2)^2 [-]
    real(DP) :: extent, worst, slenderness, t, thinnest
    logical, allocatable :: is_held(:, :)
    integer :: e
    worst = 0
    element = 0
    error = 0
    if (.not. allocated(model%structure)) return
    associate (structure => model%structure, X => model%mesh%coordinates)
      if (.not. allocated(structure%directors)) return
      extent = norm2(maxval(X(:, structure%directors%node), 2) - minval(X(:, structure%directors%node), 2))
      is_held = held_directions(model)
      do e = 1, size(structure%kind)
        if (structure%section(e) == 0) cycle
        if (structure%sections(structure%section(e))%family == FAMILY_BEAM) cycle
        if (structure%sections(structure%section(e))%card == 'RIGID BODY') cycle
        associate (of => structure%director_of(structure%first(e):structure%first(e + 1) - 1), nodes => &
          structure%nodes(structure%first(e):structure%first(e + 1) - 1))
          if (all(is_held_along_normal(structure%directors(of)))) cycle
          t = minval(structure%directors(of)%thickness(1))
          associate (height => structure%directors(of(1))%height)
            thinnest = t * minval(height(1:) - height(:ubound(height, 1) - 1))
          end associate
          slenderness = norm2(maxval(X(:, nodes), 2) - minval(X(:, nodes), 2)) * extent / sqrt(thinnest * t**3)
        end associate
        if (slenderness > worst) element = e
        worst = max(worst, slenderness)
      end do
    end associate
    error = ERROR_OF_ROUNDING * worst**2

  contains

    !> Whether the node of a fibre is held along it: only where that is a global axis.
    elemental logical function is_held_along_normal(director)
      type(director_type), intent(in) :: director
      integer :: k
      k = maxloc(abs(director%axes(:, 1)), 1)
      is_held_along_normal = is_held(k, director%node) .and. abs(director%axes(k, 1)) > 1 - epsilon(1.0_DP)**0.5_DP
    end function is_held_along_normal

  end subroutine estimate_rounding


  !> The global directions in which the steps hold nodes, in each of them.
  pure function held_directions(model) result(is_held)
    type(model_type), intent(in) :: model
    logical :: is_held(3, model%mesh%n_nodes)
    integer :: i, k
    is_held = size(model%steps) > 0
    do k = 1, size(model%steps)
      is_held = is_held .and. .not. free_unknowns(model, k)
    end do
    if (.not. allocated(model%frame_of)) return
    do i = 1, size(model%frame_of)
      if (model%frame_of(i) > 0) is_held(:, i) = .false.
    end do
  end function held_directions


  !> In thin shells a small residual does not make a small error: bending is soft beside the thickness. The residual of the elements
  !! is exact, so that a second correction removes what rounding spoiled in the first: no residual is small enough to go without the
  !! estimate of the error. Shells so thin that rounding hides their bending are refused. Steps must be read.
  subroutine refine_thin_shells(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    real(DP), parameter :: MAX_ERROR = 0.3_DP                !< of the first solution: corrections converge below [-]
    type(controls_type) :: standard
    real(DP), parameter :: MAX_UNREFINED = 1.0e-10_DP        !< of small displacements, one solution as a rule [-]
    real(DP), parameter :: MAX_UNREFINED_FINITE = 1.0e-6_DP  !< of NLGEOM, which iterates anyway [-]
    real(DP) :: error
    integer :: e, k
    if (reader%messages%n_errors > 0) return
    call estimate_rounding(model, error, e)
    if (error > MAX_ERROR) call report_error(reader, 0, 'The shell is too thin at element ' // &
      to_text(model%mesh%element_label(e)) // ' for its size and the extent of the shells: rounding would hide its bending. ' // &
      'Use smaller elements or a plane element, or hold the displacement along the normal if it is flat and does not bend.')
    do k = 1, size(model%steps)
      if (error < merge(MAX_UNREFINED_FINITE, MAX_UNREFINED, model%steps(k)%is_nlgeom)) cycle
      if (abs(model%steps(k)%controls%r_l - standard%r_l) <= 0) model%steps(k)%controls%r_l = 0
    end do
  end subroutine refine_thin_shells


  !> Orders the ties of shells and beams by `order_slave_terms`. Knots make all their nodes dependent: a note says how many of them
  !! are slaves. Pairs and couplings must be read.
  subroutine free_slave_nodes(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    logical, allocatable :: is_bound(:)
    integer :: n
    if (allocated(model%structure) .and. allocated(model%frame_of)) then
      call turn_inner_ties(model)
      call turn_mean_rotations(model)
    end if
    call order_slave_terms(model, is_bound)
    n = count(is_bound)
    if (n > 0) call report_note(reader, 0, plural(n, 'slave node') // verb(n, ' belongs', ' belong') // &
      ' to knots of shells or beams (edges between plates, nodes whose rotations are held or loaded): contact does not ' // &
      'act there. Make this surface the master if they may touch.')
  end subroutine free_slave_nodes


  !> Inner nodes of a fibre that are held between the outer ones along a prescribed displacement (`knots`) are so along the local
  !! direction of the node of the deck. (Those of a parabolic fibre follow in all directions, which may be the local ones.)
  subroutine turn_inner_ties(model)
    type(model_type), intent(inout) :: model
    integer :: i, j, owner(model%mesh%n_nodes)   ! of an inner node: that of the deck; 0
    real(DP) :: direction(3)
    owner = 0
    do i = 1, size(model%structure%directors)
      associate (director => model%structure%directors(i))
        if (model%frame_of(director%node) == 0) cycle
        owner(director%nodes(director%n_outer + 1:)) = director%node
      end associate
    end do
    do i = 1, size(model%equations)
      associate (equation => model%equations(i))
        if (owner(equation%node(1)) == 0 .or. size(equation%node) /= 3) cycle
        direction = dof_direction(model, owner(equation%node(1)), equation%dof(1))
        equation%n_eliminable = 3
        equation%node = [(spread(equation%node(j), 1, 3), j=1, 3)]
        equation%dof = [1, 2, 3, 1, 2, 3, 1, 2, 3]
        equation%coefficient = [(equation%coefficient(j) * direction, j=1, 3)]
      end associate
    end do
  end subroutine turn_inner_ties


  !> The mean rotations of cross-sections (calculix dialect) are those about the local axes of their node, as in CalculiX.
  subroutine turn_mean_rotations(model)
    type(model_type), intent(inout) :: model
    integer :: i
    do i = 1, size(model%nonlinear_mpcs)
      associate (mpc => model%nonlinear_mpcs(i))
        if (mpc%kind /= MPC_MEAN_ROTATION .or. index(mpc%card, 'BEAM') /= 1) cycle
        if (model%frame_of(mpc%reference) == 0) cycle
        mpc%axis = dof_direction(model, mpc%reference, mpc%pilot_direction)
        mpc%is_pilot_turned = .true.
      end associate
    end do
  end subroutine turn_mean_rotations


  !> Contact acts on unknowns that no equation makes dependent: in the ties of shells and beams slave nodes come last. The pairs of
  !! general contact are known after the deck is read: then this is done again.
  subroutine order_slave_terms(model, is_bound)
    type(model_type), intent(inout) :: model
    logical, allocatable, intent(out) :: is_bound(:)   !< (n_nodes) slaves whose unknowns are dependent all the same
    logical, allocatable :: is_slave(:)
    integer, allocatable :: order(:)
    integer :: i, k
    allocate (is_slave(model%mesh%n_nodes), is_bound(model%mesh%n_nodes), source=.false.)
    if (.not. allocated(model%structure) .or. size(model%pairs) == 0) return
    do i = 1, size(model%pairs)
      if (model%pairs(i)%slave == 0) cycle       ! an error: there is no such surface
      if (allocated(model%surfaces(model%pairs(i)%slave)%nodes)) is_slave(model%surfaces(model%pairs(i)%slave)%nodes) = .true.
    end do
    do i = 1, size(model%equations)
      associate (equation => model%equations(i))
        if (equation%card /= 'SHELL SECTION' .and. equation%card /= 'BEAM SECTION') cycle
        order = [pack([(k, k=1, size(equation%node))], .not. is_slave(equation%node)), &
          pack([(k, k=1, size(equation%node))], is_slave(equation%node))]
        equation%node = equation%node(order)
        equation%dof = equation%dof(order)
        equation%coefficient = equation%coefficient(order)
        if (count(is_slave(equation%node)) == size(equation%node) - 1 .and. size(order) > 2) is_bound(equation%node(2)) = &
          is_clamped_across(model, equation%node)
      end associate
    end do
    do i = 1, size(model%nonlinear_mpcs)
      if (model%nonlinear_mpcs(i)%expansion > 0) is_bound(model%nonlinear_mpcs(i)%node) = .true.
    end do
    is_bound = is_bound .and. is_slave
  end subroutine order_slave_terms


  !> Whether supports hold the middle node of a shell or beam across it, so that its faces cannot move together along their normal.
  pure logical function is_clamped_across(model, nodes)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)              !< the middle, then nodes of the two faces
    real(DP), parameter :: MIN_FREE_ACROSS = 1.0e-6_DP  !< of the normal [-]
    real(DP) :: normal(3)
    normal = model%mesh%coordinates(:, nodes(2)) - model%mesh%coordinates(:, nodes(3))
    is_clamped_across = norm2(merge(normal, 0.0_DP, model%structure%held_from(:3, min(nodes(1), model%structure%n_deck_nodes)) &
      == 0)) < MIN_FREE_ACROSS * norm2(normal)
  end function is_clamped_across


  !> Whether a step has finite rotations.
  logical function has_nlgeom(reader)
    type(reader_type), intent(in) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: c
    has_nlgeom = .false.
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'STEP')) cycle
      call open_card(reader, c, parameters, row)
      has_nlgeom = has_nlgeom .or. has_parameter(parameters, 'NLGEOM')
    end do
  end function has_nlgeom


  !> Lists the nodes that the expansion made of middle nodes that the reader added, with those of both ends beside them.
  pure subroutine list_added_nodes(n_given, mesh, structure)
    integer, intent(in) :: n_given               !< nodes of the deck; those behind are such middle nodes
    type(mesh_type), intent(in) :: mesh          !< expanded
    type(structure_type), intent(inout) :: structure
    integer, allocatable :: list(:, :, :)
    integer :: e, i, n
    integer, parameter :: LINES_OF_SOLID(3, 4) = reshape([9, 1, 2, 11, 3, 4, 13, 5, 6, 15, 7, 8], [3, 4])
    integer, parameter :: LINES_OF_MERIDIAN(3, 2) = reshape([5, 1, 2, 7, 3, 4], [3, 2])
    if (all(structure%nodes <= n_given)) return
    allocate (list(3, 4, mesh%n_elements))
    n = 0
    do e = 1, mesh%n_elements
      if (structure%section(e) == 0) cycle
      if (.not. any(structure%nodes(structure%first(e):structure%first(e + 1) - 1) > n_given)) cycle
      n = n + 1
      associate (nodes => mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))
        do i = 1, 4
          if (size(nodes) == 20) list(:, i, n) = nodes(LINES_OF_SOLID(:, i))
          if (size(nodes) == 8) list(:, i, n) = nodes(LINES_OF_MERIDIAN(:, min(i, 2)))
        end do
      end associate
    end do
    if (n > 0) structure%added_between = reshape(list(:, :, :n), [3, 4 * n])
  end subroutine list_added_nodes


  !> NODAL THICKNESS: node or set, thickness, of beams the second too. Middle nodes that the reader adds have the mean of the ends.
  subroutine read_nodal_thickness(reader, n_given, model)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: n_given               !< nodes of the deck; those behind are such middle nodes
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    real(DP) :: thickness(2)
    integer :: c, e, i
    logical :: is_ok
    allocate (model%structure%nodal_thickness(2, model%mesh%n_nodes), source=0.0_DP)
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'NODALTHICKNESS')) cycle
      call open_card(reader, c, parameters, row)
      do while (next_row(reader%cards, row))
        is_ok = .true.
        call check_n_fields(reader, row, 3)
        call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
        call read_real(reader, row, 2, 'thickness', thickness(1), is_ok)
        call read_real(reader, row, 3, 'second thickness', thickness(2), is_ok, thickness(1))
        if (is_ok .and. .not. all(thickness > 0)) call report_error(reader, row%line, 'The thickness must be positive.')
        if (is_ok) model%structure%nodal_thickness(:, nodes) = spread(thickness, 2, size(nodes))
      end do
    end do
    do e = 1, model%mesh%n_elements
      if (model%structure%section(e) == 0) cycle
      associate (section => model%structure%sections(model%structure%section(e)))
        if (.not. section%has_nodal_thickness) cycle
        do i = model%mesh%first(e), model%mesh%first(e + 1) - 1
          if (model%mesh%nodes(i) > n_given) cycle
          associate (given => model%structure%nodal_thickness(:, model%mesh%nodes(i)))
            if (given(1) > 0) cycle
            given = section%thickness            ! the thickness of the section where there is no other
            if (section%thickness(1) > 0) cycle
            given = 1
          end associate
          call report_error(reader, 0, 'The node ' // to_text(model%mesh%node_label(model%mesh%nodes(i))) // ' has no ' // &
            'thickness: neither *NODAL THICKNESS nor the section gives one.')
        end do
        associate (nodes => model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1), thickness => &
          model%structure%nodal_thickness)
          if (any(nodes > n_given)) thickness(:, nodes(2)) = 0.5_DP * (thickness(:, nodes(1)) + thickness(:, nodes(3)))
        end associate
      end associate
    end do
  end subroutine read_nodal_thickness


  !> NORMAL: element or set, node or set, three components.
  subroutine read_normals(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: elements(:), nodes(:)
    real(DP) :: normal(3)
    integer :: c, i, k
    logical :: is_ok
    allocate (model%structure%given_normal(3, size(model%structure%nodes)), source=0.0_DP)
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'NORMAL')) cycle
      call open_card(reader, c, parameters, row)
      do while (next_row(reader%cards, row))
        is_ok = .true.
        call check_n_fields(reader, row, 5)
        call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
        call nodes_of_field(reader, model%mesh, row, 2, nodes, is_ok)
        do i = 1, 3
          call read_real(reader, row, 2 + i, 'component of the normal', normal(i), is_ok, 0.0_DP)
        end do
        if (is_ok .and. .not. norm2(normal) > 0) call report_error(reader, row%line, 'The normal must not be zero.')
        if (.not. is_ok .or. .not. norm2(normal) > 0) cycle
        do i = 1, size(elements)
          do k = model%structure%first(elements(i)), model%structure%first(elements(i) + 1) - 1
            if (any(nodes == model%structure%nodes(k))) model%structure%given_normal(:, k) = normal / norm2(normal)
          end do
        end do
      end do
    end do
  end subroutine read_normals


  !> Whether an element of the mesh has the faces of a shell: its solid, a membrane, a rigid edge.
  pure logical function is_shell(model, e)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                     !< element
    is_shell = is_two_sided(model%mesh%kind(e))
    if (is_shell .or. .not. allocated(model%structure)) return
    if (model%structure%section(e) > 0) is_shell = model%structure%sections(model%structure%section(e))%family == FAMILY_SHELL
  end function is_shell


  !> The face of the solid of a shell that a label names: P the side from which a positive pressure acts along the normal, SNEG,
  !! SPOS, En and EDNORn edge n, Sn under the calculix dialect; 0: it names none; OTHER_LAYER: one of another layer. Axisymmetric
  !! shells have no edges.
  pure integer function structural_face(model, e, label) result(face)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                     !< element, a shell or a membrane
    character(*), intent(in) :: label            !< squeezed
    integer :: n_faces, n_layers, top
    type(element_kind_type) :: entry
    top = merge(3, 2, model%mesh%kind(e) == KIND_CAX_SHELL)
    entry = element_kind(model%mesh%kind(e))
    n_faces = entry%n_faces
    face = 0
    select case (label)
    case ('P', 'PNU', 'SNEG')
      face = 1
    case ('SPOS')
      face = top
    case ('E1', 'E2', 'E3', 'E4', 'EDNOR1', 'EDNOR2', 'EDNOR3', 'EDNOR4')
      if (top == 2) face = edge_face(iachar(label(len(label):)) - iachar('0'))
    case ('S1', 'S2', 'S3', 'S4', 'S5', 'S6')
      if (model%dialect == DIALECT_CALCULIX) face = iachar(label(2:)) - iachar('0')
      if (face > 2 .and. top == 2) face = edge_face(face - 2)
    end select
    if (face > n_faces) face = 0
    if (is_two_sided(model%mesh%kind(e))) return
    n_layers = n_section_layers(model%structure%sections(model%structure%section(e)))
    if (face == 1 .and. model%mesh%layer(e) > 1) face = OTHER_LAYER
    if (face == top .and. model%mesh%layer(e) < n_layers) face = OTHER_LAYER

  contains

    !> The face of an edge by its number in the deck; 0: its ends are one node.
    pure integer function edge_face(number)
      integer, intent(in) :: number
      edge_face = face_number_here(model%mesh, e, number)
      if (edge_face > 0) edge_face = edge_face + 2
    end function edge_face

  end function structural_face


  !> Whether a face of the mesh is the edge of a shell, neither SNEG nor SPOS.
  pure logical function is_shell_edge(model, e, face)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e, face               !< element, face of its solid
    is_shell_edge = .false.
    if (.not. is_shell(model, e)) return
    is_shell_edge = face > 1 .and. face /= merge(3, 2, model%mesh%kind(e) == KIND_CAX_SHELL)
  end function is_shell_edge


  !> The temperatures of nodes and of those into which they expand, from the value at the node and its gradients.
  subroutine spread_temperature(model, nodes, value, gradient, all_nodes, values)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    real(DP), intent(in) :: value                !< [temperature]
    real(DP), intent(in) :: gradient(2)          !< along the normal of shells, direction 2 of beams; along direction 1 of beams
    integer, allocatable, intent(out) :: all_nodes(:)
    real(DP), allocatable, intent(out) :: values(:)   !< [temperature]
    real(DP) :: slope(3)
    integer :: i, k, first, last, n
    all_nodes = nodes
    values = spread(value, 1, size(nodes))
    if (.not. allocated(model%structure)) return
    do i = 1, size(nodes)
      call find_node_directors(model%structure, nodes(i), first, last)
      do k = first, last
        associate (director => model%structure%directors(k))
          n = size(director%nodes)
          all_nodes = [all_nodes, director%nodes]
          slope = matmul(director%axes, merge(gradient([2, 1]), [gradient(1), 0.0_DP], director%n_outer == 4))
          values = [values, value + matmul(slope, model%mesh%coordinates(:, director%nodes) - &
            spread(model%mesh%coordinates(:, director%node), 2, n))]
        end associate
      end do
    end do
  end subroutine spread_temperature

end module amontons_deck_structure
