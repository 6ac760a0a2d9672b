!> BEAM SECTION, BEAM GENERAL SECTION; lines of two nodes that need a middle one, beams and shells in the plane.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_beams
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_materials, only: add_section_material
  use amontons_deck_reader, only: reader_type, report_error, read_real, read_integer, check_n_fields, check_no_data, is_card
  use amontons_mesh, only: mesh_type, append_nodes, replace_element_nodes
  use amontons_loads, only: equation_type
  use amontons_model, only: model_type, new_equation, gather_constraints, DIALECT_CALCULIX
  use amontons_structural_data, only: structural_section_type, structure_type, find_node_directors, SECTION_RECT, &
    SECTION_CIRC, SECTION_PIPE, SECTION_BOX
  use amontons_text, only: parse_real, name_key, NUMBER_OK
  use amontons_element_kinds, only: FAMILY_BEAM, KIND_B31, KIND_B31R, KIND_B32, KIND_SAX1, KIND_SAX2
  implicit none
  private
  public :: read_beam_section, pass_integration_points, read_general_material, section_offset, add_middle_nodes, &
    mark_plane_beams, hold_plane_beams

contains

  !> BEAM SECTION, BEAM GENERAL SECTION: dimensions along direction 1 and 2, or those of the section; then the first direction.
  subroutine read_beam_section(reader, c, parameters, row, section)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row    !< out: that of the direction, if there is one
    type(structural_section_type), intent(inout) :: section
    integer :: i
    logical :: is_ok
    section%family = FAMILY_BEAM
    section%card = trim(merge('BEAM GENERAL SECTION', 'BEAM SECTION        ', is_card(reader, c, 'BEAMGENERALSECTION')))
    section%offset = [section_offset(reader, c, parameters, 'OFFSET1'), section_offset(reader, c, parameters, 'OFFSET2')]
    section%direction = [0.0_DP, 0.0_DP, -1.0_DP]
    if (.not. next_row(reader%cards, row)) then
      call report_error(reader, reader%cards%cards(c)%line, '*' // section%card // ' needs a data line with the dimensions of ' // &
        'the section.')
      return
    end if
    call read_dimensions(reader, row, parameter_word(parameters, 'SECTION', 'RECT'), section)
    if (.not. next_row(reader%cards, row)) return
    is_ok = .true.
    call check_n_fields(reader, row, 3)
    do i = 1, 3
      call read_real(reader, row, i, 'first direction', section%direction(i), is_ok, &
        merge(-1.0_DP, 0.0_DP, i == 3 .and. row%n == 0))   ! a line without fields: the default
    end do
    if (is_ok .and. .not. norm2(section%direction) > 0) call report_error(reader, row%line, 'The direction must not be zero.')
  end subroutine read_beam_section


  !> The third line of BEAM SECTION, which CalculiX has not: numbers of integration points, which are those of the solids here.
  subroutine pass_integration_points(reader, row)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row    !< in: that of the direction
    integer :: i, n
    logical :: is_ok
    if (.not. next_row(reader%cards, row)) return
    if (reader%dialect == DIALECT_CALCULIX) then
      call check_no_data(reader, row)
      return
    end if
    is_ok = .true.
    call check_n_fields(reader, row, 3)
    do i = 1, row%n
      call read_integer(reader, row, i, 'number of integration points', n, is_ok, 1)
    end do
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
  end subroutine pass_integration_points


  !> The third line of BEAM GENERAL SECTION: Young's modulus, shear modulus and thermal expansion of the section.
  subroutine read_general_material(reader, c, parameters, row, model)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row    !< in: that of the direction
    type(model_type), intent(inout) :: model     !< out: with the material as the last one
    real(DP) :: E, G, expansion, density, zero
    logical :: is_ok
    integer :: status
    is_ok = next_row(reader%cards, row)
    if (.not. is_ok) call report_error(reader, reader%cards%cards(c)%line, '*BEAM GENERAL SECTION needs a third data line ' // &
      'with Young''s modulus and the shear modulus.')
    E = 1
    G = 0.5_DP
    expansion = 0
    if (is_ok) then
      call check_n_fields(reader, row, 3)
      call read_real(reader, row, 1, 'Young''s modulus', E, is_ok)
      call read_real(reader, row, 2, 'shear modulus', G, is_ok)
      call read_real(reader, row, 3, 'thermal expansion', expansion, is_ok, 0.0_DP)
    end if
    if (is_ok .and. .not. (E > 0 .and. 3 * G > E)) then
      call report_error(reader, row%line, 'The shear modulus must be more than a third of Young''s modulus, both ' // &
        'positive: the beam becomes a solid of Poisson''s ratio E/(2 G) - 1, which must be less than 0.5.')
      is_ok = .false.
    end if
    if (.not. is_ok) then
      E = 1
      G = 0.5_DP
    end if
    density = 0
    if (has_parameter(parameters, 'DENSITY')) call parse_real(parameter_text(parameters, 'DENSITY'), density, status)
    zero = 0
    if (has_parameter(parameters, 'ZERO')) call parse_real(parameter_text(parameters, 'ZERO'), zero, status)
    call add_section_material(reader, c, model, [E, E / (2 * G) - 1], density, [expansion, zero])
    if (next_row(reader%cards, row)) call report_error(reader, row%line, 'Constants over the temperature are not supported in ' // &
      '*BEAM GENERAL SECTION; use *BEAM SECTION with a *MATERIAL.')
  end subroutine read_general_material


  !> The dimensions of a section. Circles: the radius, in CalculiX the diameters along both directions; pipes: radius, thickness;
  !! boxes: dimensions, then the walls at +1, +2, -1, -2.
  subroutine read_dimensions(reader, row, word, section)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: word             !< RECT, CIRC, PIPE, or BOX of the calculix dialect
    type(structural_section_type), intent(inout) :: section
    real(DP) :: value(6)
    integer :: i, n
    logical :: is_ok
    is_ok = .true.
    section%shape = SECTION_RECT
    n = 2
    if (word == 'CIRC') section%shape = SECTION_CIRC
    if (word == 'PIPE' .or. word == 'THICKPIPE') section%shape = SECTION_PIPE
    if (word == 'BOX') section%shape = SECTION_BOX
    if (word == 'BOX') n = 6
    if (word == 'CIRC' .and. reader%dialect /= DIALECT_CALCULIX) n = 1
    call check_n_fields(reader, row, n)
    do i = 1, n
      if (i == 2 .and. reader%dialect == DIALECT_CALCULIX .and. (word == 'RECT' .or. word == 'CIRC')) then
        call read_real(reader, row, i, 'dimension of the section', value(i), is_ok, value(1))
      else
        call read_real(reader, row, i, 'dimension of the section', value(i), is_ok)
      end if
    end do
    if (.not. is_ok) then
      section%thickness = 1
    else if (.not. all(value(:n) > 0)) then
      call report_error(reader, row%line, 'The dimensions must be positive.')
      section%thickness = 1
    else if (section%shape == SECTION_PIPE) then
      section%thickness = 2 * value(1)
      section%walls(1) = value(2) / section%thickness(1)
      if (value(2) > value(1)) call report_error(reader, row%line, 'The wall of a pipe must not be thicker than its ' // &
        'radius: the line gives radius, thickness.')
    else if (section%shape == SECTION_BOX) then
      section%thickness = value(:2)
      section%walls = value(3:) / value([1, 2, 1, 2])
      if (any(section%walls(:2) + section%walls(3:) > 1)) call report_error(reader, row%line, 'Opposite walls of a box must ' // &
        'not be thicker than the box: the line gives its dimensions along direction 1 and 2, then the walls at +1, +2, -1, -2.')
    else
      section%thickness = value(:2)
      if (n == 1) section%thickness = 2 * value(1)
    end if
  end subroutine read_dimensions


  !> An offset: a number, or SPOS and SNEG, the nodes lie on the top or the bottom.
  real(DP) function section_offset(reader, c, parameters, name) result(offset)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    character(*), intent(in) :: name             !< of the parameter
    character(:), allocatable :: text
    integer :: status
    offset = 0
    if (.not. has_parameter(parameters, name)) return
    text = name_key(parameter_text(parameters, name))
    if (text == 'SPOS') offset = 0.5_DP
    if (text == 'SNEG') offset = -0.5_DP
    if (text == 'SPOS' .or. text == 'SNEG') return
    call parse_real(text, offset, status)
    if (status == NUMBER_OK) return
    offset = 0
    call report_error(reader, reader%cards%cards(c)%line, name // ' must be a number, the place of the nodes over the ' // &
      'thickness from its middle' // trim(merge(', or SPOS or SNEG', '                 ', name == 'OFFSET')) // '; it is ''' // &
      parameter_text(parameters, name) // '''.')
  end function section_offset


  !> Beams of two nodes with another section than RECT become beams of three nodes, with a new node between them: the points of
  !! these sections belong to solids of 20 nodes. So do axisymmetric shells, whose solid has eight nodes.
  subroutine add_middle_nodes(mesh, structure)
    type(mesh_type), intent(inout) :: mesh       !< not yet expanded
    type(structure_type), intent(in) :: structure   !< with the sections of the elements
    logical :: is_changed(mesh%n_elements)
    integer, allocatable :: first(:), nodes(:)
    real(DP), allocatable :: x(:, :)
    integer :: e, n, m
    is_changed = .false.
    do e = 1, mesh%n_elements
      if (structure%section(e) == 0) cycle
      is_changed(e) = mesh%kind(e) == KIND_SAX1 .or. ((mesh%kind(e) == KIND_B31 .or. mesh%kind(e) == KIND_B31R) .and. &
        structure%sections(structure%section(e))%shape /= SECTION_RECT)
    end do
    if (.not. any(is_changed)) return
    n = mesh%n_nodes
    allocate (first(mesh%n_elements + 1), nodes(size(mesh%nodes) + count(is_changed)))
    allocate (x(3, count(is_changed .and. mesh%layer == 1)))
    first(1) = 1
    m = 0
    do e = 1, mesh%n_elements
      associate (ends => mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))
        first(e + 1) = first(e) + size(ends) + merge(1, 0, is_changed(e))
        if (is_changed(e)) then
          if (mesh%layer(e) == 1) m = m + 1      ! the other layers of an element have the same nodes
          x(:, m) = 0.5_DP * (mesh%coordinates(:, ends(1)) + mesh%coordinates(:, ends(2)))
          nodes(first(e):first(e + 1) - 1) = [ends(1), n + m, ends(2)]
          mesh%kind(e) = merge(KIND_SAX2, KIND_B32, mesh%kind(e) == KIND_SAX1)
        else
          nodes(first(e):first(e + 1) - 1) = ends
        end if
      end associate
    end do
    call append_nodes(mesh, x)
    call replace_element_nodes(mesh, first, nodes)
  end subroutine add_middle_nodes


  !> Beams in the plane and axisymmetric shells: their nodes keep the third displacement and the rotations about axes of the plane.
  !! Every node of a beam is turned for this.
  subroutine mark_plane_beams(mesh, structure)
    type(mesh_type), intent(inout) :: mesh       !< not yet expanded; out: these beams are no trusses in the plane
    type(structure_type), intent(inout) :: structure   !< out: their nodes are turned and held
    logical :: is_meridian(mesh%n_nodes)
    integer :: e
    allocate (structure%is_plane(mesh%n_nodes), source=.false.)
    is_meridian = .false.
    do e = 1, mesh%n_elements
      if (structure%section(e) == 0) cycle
      associate (nodes => mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))
        if (mesh%kind(e) == KIND_SAX2) is_meridian(nodes) = .true.
        if (mesh%is_in_plane(e)) structure%is_plane(nodes) = .true.
      end associate
      mesh%is_in_plane(e) = .false.
    end do
    where (structure%is_plane)
      structure%is_turned = .true.
      structure%held_from(3, :) = 1
      structure%held_from(4, :) = 1
      structure%held_from(5, :) = 1
    end where
    structure%is_plane = structure%is_plane .or. is_meridian
  end subroutine mark_plane_beams


  !> Holds the nodes of beams in the plane and of axisymmetric shells, once the rotation nodes exist; those of the shells until a
  !! step prescribes the displacement or rotation itself.
  subroutine hold_plane_beams(model)
    type(model_type), intent(inout) :: model     !< expanded
    integer :: i, k, held_from(6), first, last
    character(:), allocatable :: card
    do i = 1, size(model%structure%is_plane)
      if (.not. model%structure%is_plane(i)) cycle
      held_from = 0
      card = 'BEAM SECTION'
      call find_node_directors(model%structure, i, first, last)
      if (model%structure%directors(first)%is_meridional) then
        held_from = model%structure%held_from(:, i)
        card = 'SHELL SECTION'
      end if
      call hold(i, 3, held_from(3))
      if (model%rotation_of(i) == 0) cycle
      do k = 1, 2
        call hold(model%rotation_of(i), k, held_from(3 + k))
      end do
    end do
    call gather_constraints(model)

  contains

    !> Holds a displacement of a node until a step.
    subroutine hold(node, dof, step)
      integer, intent(in) :: node, dof
      integer, intent(in) :: step                !< 0: for good
      type(equation_type) :: equation
      equation = new_equation([node], [dof], [1.0_DP], card, 0)
      if (step > 0) equation%last_step = step - 1
      call model%read_equations%add(equation)
    end subroutine hold

  end subroutine hold_plane_beams

end module amontons_deck_beams
