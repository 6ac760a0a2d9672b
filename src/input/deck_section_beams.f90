!> BEAM SECTION and BEAM GENERAL SECTION of beams that keep the stiffnesses of their cross-section: GENERAL, I, BOX.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Their elements become user elements without UEL: B31 in the abaqus dialect, the element U1 in that of calculix. Shear factors
!! are those of Abaqus: 0.44 for I and BOX, 1 for GENERAL (Abaqus Analysis User's Guide, Choosing a beam cross-section). An I has
!! the torsion constant of an open section, sum b t^3/3, a BOX that of Bredt (S. Timoshenko, J. Goodier, Theory of Elasticity).
module amontons_deck_section_beams
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_reader, only: reader_type, report_error, read_real, check_n_fields, check_no_data, is_card
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

  !> The numbers of a cross-section.
  type :: geometry_type
    real(DP) :: area = 1                           !< [length^2]
    real(DP) :: about(2) = 1, product = 0          !< second moments about axes 1, 2, product of inertia [length^4]
    real(DP) :: torsion = 1                        !< J [length^4]
    real(DP) :: shear_factor = 1                   !< k [-]
    real(DP) :: centroid(2) = 0                    !< from the node along axes 1, 2 [length]
  end type geometry_type

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
    is_section_beam = word == 'GENERAL' .or. word == 'I' .or. (word == 'BOX' .and. reader%dialect /= DIALECT_CALCULIX)
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
    type(geometry_type) :: geometry
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
      if (is_ok) then
        if (next_row(reader%cards, row)) call check_no_data(reader, row)
      end if
      section%axial = E * geometry%area
      section%torsion = G * geometry%torsion
      section%bending = E * reshape([geometry%about(1), -geometry%product, -geometry%product, geometry%about(2)], [2, 2])
      section%shear = geometry%shear_factor * G * geometry%area
      section%centroid = geometry%centroid
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
      reader%cards%cards(c)%line, 'SECTION=GENERAL, I and BOX take no OFFSET1 and OFFSET2.')
  end subroutine check_offsets


  !> The first data line.
  subroutine read_geometry(reader, c, parameters, row, geometry, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    type(geometry_type), intent(out) :: geometry
    logical, intent(out) :: is_ok
    character(:), allocatable :: word
    real(DP) :: v(7)
    integer :: i, n
    word = parameter_word(parameters, 'SECTION', 'RECT')
    is_ok = next_row(reader%cards, row)
    if (.not. is_ok) then
      call report_error(reader, reader%cards%cards(c)%line, 'The data line with the numbers of the section is missing.')
      return
    end if
    if (reader%dialect == DIALECT_CALCULIX .and. word == 'I' .or. reader%dialect /= DIALECT_CALCULIX .and. word == 'GENERAL' &
      .and. is_card(reader, c, 'BEAMSECTION')) then
      call report_error(reader, reader%cards%cards(c)%line, trim(merge('CalculiX has no SECTION=I.                       ', &
        'SECTION=GENERAL belongs to *BEAM GENERAL SECTION.', word == 'I')))
      is_ok = .false.
      return
    end if
    n = merge(7, merge(6, 5, word == 'BOX'), word == 'I' .or. (word == 'GENERAL' .and. reader%dialect /= DIALECT_CALCULIX))
    call check_n_fields(reader, row, n)
    v = 0
    do i = 1, merge(5, n, word == 'GENERAL')
      call read_real(reader, row, i, 'number of the section', v(i), is_ok)
    end do
    if (.not. is_ok) return
    select case (word)
    case ('I')
      call check_i_section(reader, row, v, is_ok)
      if (is_ok) geometry = i_section(v)
    case ('BOX')
      is_ok = all(v(:6) > 0) .and. v(3) + v(5) < v(1) .and. v(4) + v(6) < v(2)
      if (.not. is_ok) call report_error(reader, row%line, 'The numbers of a BOX must be positive, and opposite walls thinner ' // &
        'than it: the line gives its dimensions along direction 1 and 2, then the walls at +1, +2, -1, -2.')
      if (is_ok) geometry = box_section(v(:6))
    case default
      call set_general(reader, row, v(:5), geometry, is_ok)
    end select
  end subroutine read_geometry


  !> The numbers of GENERAL. Abaqus: area, I11, I12, I22, J, where I11 resists moments about direction 1. CalculiX: area, I11, I12,
  !! I22, shear factor, where I11 resists bending along direction 1, I12 must be 0, and J = I11 + I22.
  subroutine set_general(reader, row, v, geometry, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    real(DP), intent(in) :: v(5)
    type(geometry_type), intent(out) :: geometry
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


  !> Reports wrong numbers of an I.
  subroutine check_i_section(reader, row, v, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    real(DP), intent(in) :: v(7)                 !< l, h, b1, b2, t1, t2, t3 [length]
    logical, intent(out) :: is_ok
    is_ok = all(v(2:) > 0) .and. v(5) + v(6) < v(2) .and. v(7) <= max(v(3), v(4))
    if (.not. is_ok) call report_error(reader, row%line, 'The line of an I gives the height of the node over the bottom, the ' // &
      'height, the widths of the lower and the upper flange, their thicknesses, and that of the web. All but the first must ' // &
      'be positive, and the flanges must leave a web.')
  end subroutine check_i_section


  !> An I: web along direction 2.
  pure function i_section(v) result(geometry)
    real(DP), intent(in) :: v(7)                 !< l, h, b1, b2, t1, t2, t3 [length]
    type(geometry_type) :: geometry
    real(DP) :: width(3), height(3), middle(3), area(3)
    width = [v(3), v(4), v(7)]                   ! lower flange, upper flange, web
    height = [v(5), v(6), v(2) - v(5) - v(6)]
    middle = [v(5) / 2, v(2) - v(6) / 2, v(5) + height(3) / 2] - v(1)
    area = width * height
    geometry%area = sum(area)
    geometry%centroid = [0.0_DP, sum(area * middle) / geometry%area]
    geometry%about = [sum(area * (height**2 / 12 + (middle - geometry%centroid(2))**2)), sum(area * width**2) / 12]
    geometry%torsion = (v(3) * v(5)**3 + v(4) * v(6)**3 + height(3) * v(7)**3) / 3
    geometry%shear_factor = 0.44_DP
  end function i_section


  !> A box: the outer rectangle less the hole; its node is at the middle of the outer rectangle.
  pure function box_section(v) result(geometry)
    real(DP), intent(in) :: v(6)                 !< dimensions along axes 1, 2, walls at +1, +2, -1, -2 [length]
    type(geometry_type) :: geometry
    real(DP) :: hole(2), place(2), area(2), line(2)
    hole = v(:2) - v(3:4) - v(5:6)
    place = 0.5_DP * (v(5:6) - v(3:4))           ! middle of the hole
    area = [v(1) * v(2), -hole(1) * hole(2)]
    geometry%area = sum(area)
    geometry%centroid = area(2) * place / geometry%area
    geometry%about = (area(1) * v([2, 1])**2 + area(2) * hole([2, 1])**2) / 12 + area(2) * place([2, 1])**2 - &
      geometry%area * geometry%centroid([2, 1])**2
    geometry%product = area(2) * place(1) * place(2) - geometry%area * product(geometry%centroid)
    line = v(:2) - 0.5_DP * (v(3:4) + v(5:6))    ! middle lines of the walls
    geometry%torsion = 4 * product(line)**2 / (line(2) / v(3) + line(1) / v(4) + line(2) / v(5) + line(1) / v(6))
    geometry%shear_factor = 0.44_DP
  end function box_section


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
      call report_error(reader, line, 'SECTION=GENERAL, I and BOX take a linear isotropic elastic material without tables; ' // &
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
    if (any([(is_card(reader, c, 'TEMPERATURE'), c=1, reader%cards%n_cards)])) call report_error(reader, line, 'Beams of ' // &
      'SECTION=GENERAL, I and BOX do not expand with *TEMPERATURE: leave the thermal expansion out.')
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
