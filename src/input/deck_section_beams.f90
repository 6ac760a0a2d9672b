!> BEAM SECTION and BEAM GENERAL SECTION of beams that keep the stiffnesses of their cross-section: GENERAL, I, L, BOX, ...
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Their elements become user elements without UEL: B31 in the abaqus dialect, the element U1 in that of calculix.
module amontons_deck_section_beams
  use amontons_kinds, only: DP
  use amontons_beam_cross_sections, only: cross_section_type, i_section, box_section, l_section, hexagon_section, &
    trapezoid_section, wall_section, WALLS_OK, WALLS_LOOSE, WALLS_CELLS
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_reader, only: reader_type, report_error, read_real, read_integer, check_n_fields, is_card
  use amontons_deck_beams, only: pass_integration_points
  use amontons_deck_transverse_shear, only: read_beam_shear
  use amontons_deck_user_elements, only: beam_kind
  use amontons_element_drafts, only: element_draft_type
  use amontons_element_kinds, only: KIND_B31, KIND_B31R, KIND_USER
  use amontons_materials, only: material_type, ELASTIC_ISOTROPIC, CREEP_NONE
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_section_beams, only: find_section_axes
  use amontons_text, only: to_text
  use amontons_user_elements, only: section_stiffness_type, user_properties_type
  implicit none
  private
  public :: is_section_beam, read_section_beam

  integer, parameter :: NUMBER_BEAM = -1           !< of the kind of B31, which no *USER ELEMENT has

contains

  !> Whether a card gives such a section.
  logical function is_section_beam(reader, c, parameters)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    character(:), allocatable :: word
    is_section_beam = .false.
    if (is_card(reader, c, 'SHELLSECTION')) return
    word = parameter_word(parameters, 'SECTION', 'RECT')
    is_section_beam = word == 'GENERAL' .or. word == 'I' .or. word == 'L' .or. word == 'HEX' .or. word == 'TRAPEZOID' .or. &
      word == 'ARBITRARY' .or. (word == 'BOX' .and. reader%dialect /= DIALECT_CALCULIX)
  end function is_section_beam


  !> One card: its data lines, and the elements of its set.
  subroutine read_section_beam(reader, c, parameters, row, set, material, model, draft)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    integer, intent(in) :: set, material         !< 0: none, reported
    type(model_type), intent(inout) :: model     !< with the element sets of drafts
    type(element_draft_type), intent(inout) :: draft
    type(user_properties_type) :: properties
    type(cross_section_type) :: geometry
    real(DP) :: E, G
    logical :: is_ok
    call check_offsets(reader, c, parameters)
    call read_geometry(reader, c, parameters, row, geometry, is_ok)
    associate (section => properties%section)
      section%direction = [0.0_DP, 0.0_DP, -1.0_DP]
      if (is_ok) call read_direction(reader, row, section%direction, is_ok)
      E = 1
      G = 1
      if (is_card(reader, c, 'BEAMGENERALSECTION') .and. .not. has_parameter(parameters, 'MATERIAL')) then
        if (is_ok) call read_moduli(reader, c, row, E, G, is_ok)
      else if (material > 0) then
        call find_moduli(reader, reader%cards%cards(c)%line, model%materials(material), E, G)
      end if
      if (is_ok) call pass_integration_points(reader, row)
      section%axial = E * geometry%area
      section%torsion = G * geometry%torsion
      section%bending = E * reshape([geometry%about(1), -geometry%product, -geometry%product, geometry%about(2)], [2, 2])
      section%shear = geometry%shear_factor * G * geometry%area
      call read_beam_shear(reader, c, section%shear)
      section%centroid = geometry%centroid
      section%shear_center = geometry%shear_center
    end associate
    properties%reals = [real(DP) ::]
    properties%integers = [integer ::]
    if (set > 0) call assign_elements(reader, c, set, properties, model, draft)
  end subroutine read_section_beam


  !> Offsets move a solid in its section; here the nodes are at the origin of the section.
  subroutine check_offsets(reader, c, parameters)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    if (has_parameter(parameters, 'OFFSET1') .or. has_parameter(parameters, 'OFFSET2')) call report_error(reader, &
      reader%cards%cards(c)%line, 'Only SECTION=RECT, CIRC and PIPE take OFFSET1 and OFFSET2 here.')
  end subroutine check_offsets


  !> The numbers of the cross-section, in one line or more.
  subroutine read_geometry(reader, c, parameters, row, geometry, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    type(cross_section_type), intent(out) :: geometry
    logical, intent(out) :: is_ok
    character(:), allocatable :: word
    real(DP) :: v(7)
    word = parameter_word(parameters, 'SECTION', 'RECT')
    is_ok = next_row(reader%cards, row)
    if (.not. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, 'The data line with the numbers of the section is missing.')
    else if (reader%dialect == DIALECT_CALCULIX .and. word /= 'GENERAL') then
      call report_error(reader, reader%cards%cards(c)%line, 'CalculiX has no SECTION=' // word // '.')
      is_ok = .false.
    else if (reader%dialect /= DIALECT_CALCULIX .and. word == 'GENERAL' .and. is_card(reader, c, 'BEAMSECTION')) then
      call report_error(reader, reader%cards%cards(c)%line, 'SECTION=GENERAL belongs to *BEAM GENERAL SECTION.')
      is_ok = .false.
    end if
    if (.not. is_ok) return
    if (word == 'ARBITRARY') then
      call read_walls(reader, c, row, geometry, is_ok)
      return
    end if
    call read_numbers(reader, row, word, v, is_ok)
    if (.not. is_ok) return
    select case (word)
    case ('I')
      call set_i_section(reader, row, v, geometry, is_ok)
    case ('BOX')
      is_ok = all(v(:6) > 0) .and. v(3) + v(5) < v(1) .and. v(4) + v(6) < v(2)
      if (is_ok) geometry = box_section(v(:2), v(3:4), v(5:6))
      if (.not. is_ok) call report_error(reader, row%line, 'The numbers of a BOX must be positive, and opposite walls thinner ' // &
        'than it: the line gives its dimensions along direction 1 and 2, then the walls at +1, +2, -1, -2.')
    case ('L')
      is_ok = all(v(:4) > 0) .and. v(4) < v(1) .and. v(3) < v(2)
      if (is_ok) geometry = l_section(v(:2), v(3:4))
      if (.not. is_ok) call report_error(reader, row%line, 'The line of an L gives the lengths of its legs along direction 1 ' // &
        'and 2, from the outer corner, and their thicknesses: all positive, and each leg longer than the other is thick.')
    case ('HEX')
      is_ok = all(v(:2) > 0) .and. v(2) < 0.5_DP * sqrt(3.0_DP) * v(1)
      if (is_ok) geometry = hexagon_section(v(1), v(2))
      if (.not. is_ok) call report_error(reader, row%line, 'The line of a HEX gives the radius of its outer corners and the ' // &
        'thickness of its walls, both positive and the wall thinner than 0.866 of the radius.')
    case ('TRAPEZOID')
      is_ok = all(v(:3) > 0)
      if (is_ok) geometry = trapezoid_section(v(1), v(2), v(3), v(4))
      if (.not. is_ok) call report_error(reader, row%line, 'The line of a TRAPEZOID gives its width at the bottom, its ' // &
        'height, its width at the top, all positive, and the height of the node over the bottom.')
    case default
      call set_general(reader, row, v(:5), geometry, is_ok)
    end select
  end subroutine read_geometry


  !> The numbers of one line.
  subroutine read_numbers(reader, row, word, v, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: word             !< of SECTION
    real(DP), intent(out) :: v(7)                !< [length, length^2, length^4]
    logical, intent(out) :: is_ok
    integer :: i, n, n_fields
    n = 5
    if (word == 'I') n = 7
    if (word == 'BOX') n = 6
    if (word == 'L' .or. word == 'TRAPEZOID') n = 4
    if (word == 'HEX') n = 2
    n_fields = n
    if (word == 'GENERAL' .and. reader%dialect /= DIALECT_CALCULIX) n_fields = 7   ! the others belong to warping
    call check_n_fields(reader, row, n_fields)
    v = 0
    is_ok = .true.
    do i = 1, n
      call read_real(reader, row, i, 'number of the section', v(i), is_ok)
    end do
  end subroutine read_numbers


  !> The lines of ARBITRARY: number of walls, first and second point, thickness between them; then for each wall its end and
  !! thickness.
  subroutine read_walls(reader, c, row, geometry, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row    !< in: the first line
    type(cross_section_type), intent(out) :: geometry
    logical, intent(out) :: is_ok
    integer, parameter :: MAX_WALLS = 10000      !< more are a number in a wrong field
    real(DP), allocatable :: points(:, :), thickness(:)
    integer :: k, n, status
    is_ok = .true.
    call check_n_fields(reader, row, 6)
    call read_integer(reader, row, 1, 'number of walls', n, is_ok)
    if (is_ok .and. (n < 2 .or. n > MAX_WALLS)) then
      call report_error(reader, row%line, 'An ARBITRARY section has 2 to ' // to_text(MAX_WALLS) // ' walls; a single one ' // &
        'is a RECT.')
      is_ok = .false.
    end if
    if (.not. is_ok) return
    allocate (points(2, n + 1), thickness(n), source=0.0_DP)
    call read_real(reader, row, 2, 'place along direction 1', points(1, 1), is_ok)
    call read_real(reader, row, 3, 'place along direction 2', points(2, 1), is_ok)
    do k = 1, n
      if (k > 1) then
        if (.not. next_row(reader%cards, row)) then
          call report_error(reader, reader%cards%cards(c)%line, 'The section has ' // to_text(n) // ' walls, but lines of ' // &
            'only ' // to_text(k - 1) // ' follow.')
          is_ok = .false.
          return
        end if
        call check_n_fields(reader, row, 3)
      end if
      associate (first => merge(4, 1, k == 1))
        call read_real(reader, row, first, 'place along direction 1', points(1, k + 1), is_ok)
        call read_real(reader, row, first + 1, 'place along direction 2', points(2, k + 1), is_ok)
        call read_real(reader, row, first + 2, 'thickness', thickness(k), is_ok)
      end associate
      if (thickness(k) < 0 .or. .not. norm2(points(:, k + 1) - points(:, k)) > 0) then
        if (is_ok) call report_error(reader, row%line, 'A wall has a length and a thickness, which must not be negative.')
        is_ok = .false.
      end if
    end do
    if (.not. is_ok) return
    call wall_section(points, thickness, geometry, status)
    is_ok = status == WALLS_OK
    if (is_ok) return
    if (status == WALLS_LOOSE) then
      call report_error(reader, reader%cards%cards(c)%line, 'A wall of thickness 0 only goes back along a wall before it, ' // &
        'to start a branch: it must have the two points of that wall.')
    else if (status == WALLS_CELLS) then
      call report_error(reader, reader%cards%cards(c)%line, 'An ARBITRARY section is open, or one cell whose last point is ' // &
        'the first: it has no fins on a cell and no second cell. Give its area and moments of inertia by *BEAM GENERAL ' // &
        'SECTION, SECTION=GENERAL.')
    else
      call report_error(reader, reader%cards%cards(c)%line, 'All walls of the section lie on one line, about which they ' // &
        'have no bending stiffness: take RECT.')
    end if
  end subroutine read_walls


  !> The numbers of GENERAL. Abaqus: area, I11, I12, I22, J, where I11 resists moments about direction 1. CalculiX: area, I11, I12,
  !! I22, shear factor, where I11 resists bending along direction 1, I12 must be 0, and J = I11 + I22.
  subroutine set_general(reader, row, v, geometry, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    real(DP), intent(in) :: v(5)
    type(cross_section_type), intent(out) :: geometry
    logical, intent(out) :: is_ok
    is_ok = v(1) > 0 .and. v(2) > 0 .and. v(4) > 0 .and. v(5) > 0 .and. v(2) * v(4) > v(3)**2
    if (.not. is_ok) call report_error(reader, row%line, 'The area, I11, I22 and the fifth number must be positive, and ' // &
      'I11 I22 > I12^2.')
    if (is_ok .and. reader%dialect == DIALECT_CALCULIX .and. abs(v(3)) > 0) then
      call report_error(reader, row%line, 'I12 must be 0, as in CalculiX: give directions along the principal axes.')
      is_ok = .false.
    end if
    if (.not. is_ok) return
    geometry%area = v(1)
    geometry%about = v([2, 4])
    geometry%product = v(3)
    geometry%torsion = v(5)
    if (reader%dialect /= DIALECT_CALCULIX) return
    geometry%about = v([4, 2])
    geometry%torsion = v(2) + v(4)
    geometry%shear_factor = v(5)
  end subroutine set_general


  !> The numbers of an I; a flange without width and thickness is not there.
  subroutine set_i_section(reader, row, v, geometry, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    real(DP), intent(in) :: v(7)                 !< l, h, b1, b2, t1, t2, t3 [length]
    type(cross_section_type), intent(out) :: geometry
    logical, intent(out) :: is_ok
    logical :: is_flange(2)
    is_flange = v(3:4) > 0 .and. v(5:6) > 0
    is_ok = v(2) > 0 .and. v(7) > 0 .and. any(is_flange) .and. all(is_flange .or. max(abs(v(3:4)), abs(v(5:6))) <= 0) .and. &
      v(5) + v(6) < v(2) .and. v(7) <= max(v(3), v(4))
    if (is_ok) geometry = i_section(v(1), v(2), v(3:4), v(5:6), v(7))
    if (.not. is_ok) call report_error(reader, row%line, 'The line of an I gives the height of the node over the bottom, the ' // &
      'height, the widths of the lower and the upper flange, their thicknesses, and that of the web. All but the first must ' // &
      'be positive, and the flanges must leave a web; a T has one flange, the other with width and thickness 0.')
  end subroutine set_i_section


  !> The second data line, which may be missing.
  subroutine read_direction(reader, row, direction, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    real(DP), intent(inout) :: direction(3)      !< in: the default
    logical, intent(inout) :: is_ok
    integer :: i
    if (.not. next_row(reader%cards, row)) return
    call check_n_fields(reader, row, 3)
    if (row%n == 0) return
    do i = 1, 3
      call read_real(reader, row, i, 'first direction', direction(i), is_ok, 0.0_DP)
    end do
    if (norm2(direction) > 0) return
    if (is_ok) call report_error(reader, row%line, 'The direction must not be zero.')
    direction = [0.0_DP, 0.0_DP, -1.0_DP]
  end subroutine read_direction


  !> The third data line of BEAM GENERAL SECTION.
  subroutine read_moduli(reader, c, row, E, G, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row
    real(DP), intent(inout) :: E, G              !< [stress]
    logical, intent(inout) :: is_ok
    real(DP) :: expansion
    is_ok = next_row(reader%cards, row)
    if (.not. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, '*BEAM GENERAL SECTION needs a third data line with Young''s ' // &
        'modulus and the shear modulus.')
      return
    end if
    call check_n_fields(reader, row, 3)
    call read_real(reader, row, 1, 'Young''s modulus', E, is_ok)
    call read_real(reader, row, 2, 'shear modulus', G, is_ok)
    call read_real(reader, row, 3, 'thermal expansion', expansion, is_ok, 0.0_DP)
    if (.not. is_ok) return
    if (.not. (E > 0 .and. G > 0)) call report_error(reader, row%line, 'Both moduli must be positive.')
    if (abs(expansion) > 0) call check_temperature(reader, row%line)
  end subroutine read_moduli


  !> The moduli of a material, which must be linear, isotropic and constant.
  subroutine find_moduli(reader, line, material, E, G)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the card
    type(material_type), intent(in) :: material
    real(DP), intent(inout) :: E, G              !< [stress]
    logical :: is_linear
    is_linear = material%has_elastic .and. material%elastic_kind == ELASTIC_ISOTROPIC .and. .not. (material%is_user .or. &
      material%is_user_field .or. material%has_plastic .or. material%has_deformation_plasticity .or. material%is_lamina .or. &
      allocated(material%cone%value)) .and. material%creep_law == CREEP_NONE
    if (is_linear .and. allocated(material%elastic%temperature)) is_linear = size(material%elastic%temperature) == 1
    if (.not. is_linear) then
      call report_error(reader, line, 'Beams by their section take a linear isotropic elastic material without tables; ' // &
        'build the beam of shells, or take RECT, CIRC or PIPE.')
      return
    end if
    if (.not. material%youngs_modulus > 0) return   ! reported with the material
    E = material%youngs_modulus
    G = E / (2 + 2 * material%poissons_ratio)
    if (allocated(material%expansion%value)) call check_temperature(reader, line)
  end subroutine find_moduli


  !> These beams have no thermal strain.
  subroutine check_temperature(reader, line)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    integer :: c
    if (any([(is_card(reader, c, 'TEMPERATURE'), c=1, reader%cards%n_cards)])) call report_error(reader, line, 'Beams by ' // &
      'their section do not expand with *TEMPERATURE: leave the thermal expansion out.')
  end subroutine check_temperature


  !> Makes the elements of a set beams by their section.
  subroutine assign_elements(reader, c, set, properties, model, draft)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c, set                !< card, element set
    type(user_properties_type), intent(in) :: properties
    type(model_type), intent(inout) :: model     !< with the element sets of drafts
    type(element_draft_type), intent(inout) :: draft
    real(DP) :: axes(3, 3), length
    integer :: i, e, kind
    logical :: is_ok
    if (.not. allocated(model%user_elements)) then
      allocate (model%user_elements)
      allocate (model%user_elements%kinds(0), model%user_elements%properties(0), model%user_elements%elements(0))
    end if
    model%user_elements%properties = [model%user_elements%properties, properties]
    if (reader%dialect /= DIALECT_CALCULIX .and. .not. any(model%user_elements%kinds%number == NUMBER_BEAM)) &
      model%user_elements%kinds = [model%user_elements%kinds, beam_kind(NUMBER_BEAM)]
    kind = findloc(model%user_elements%kinds%is_beam, .true., dim=1)
    do i = 1, size(model%mesh%element_sets(set)%members)
      e = model%mesh%element_sets(set)%members(i)
      draft%section_card(e) = c
      draft%section_value(e) = 1
      if (draft%kind(e) == 0) cycle              ! reported with the card of its type
      is_ok = .not. draft%is_in_plane(e)
      if (draft%user_kind(e) > 0) then
        is_ok = model%user_elements%kinds(draft%user_kind(e))%is_beam
      else
        is_ok = is_ok .and. reader%dialect /= DIALECT_CALCULIX .and. (draft%kind(e) == KIND_B31 .or. draft%kind(e) == KIND_B31R)
      end if
      if (.not. is_ok) then
        call report_error(reader, reader%cards%cards(c)%line, 'The element ' // to_text(draft%label(e)) // ' is no ' // &
          trim(merge('U1 ', 'B31', reader%dialect == DIALECT_CALCULIX)) // ', which alone takes such a section.')
        draft%material(model%mesh%element_sets(set)%members) = -1   ! one message is enough
        return
      end if
      draft%kind(e) = KIND_USER
      draft%user_kind(e) = kind
      draft%user_properties(e) = size(model%user_elements%properties)
      associate (nodes => draft%nodes%items(draft%first(e):draft%first(e) + 1))
        if (any(nodes < 1)) cycle                ! a missing node: its error is reported
        call find_section_axes(model%mesh%coordinates(:, nodes), properties%section%direction, axes, length, is_ok)
      end associate
      if (is_ok) cycle
      call report_error(reader, reader%cards%cards(c)%line, 'The element ' // to_text(draft%label(e)) // ' has no length, or ' // &
        'lies along the first direction of its section: give another one in the second data line.')
      draft%material(model%mesh%element_sets(set)%members) = -1
      return
    end do
  end subroutine assign_elements

end module amontons_deck_section_beams
