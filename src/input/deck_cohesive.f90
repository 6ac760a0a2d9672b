!> COHESIVE SECTION and the damage of cohesive laws, to the mesh and to materials.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_cohesive
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_property_tables, only: read_table
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_real, check_n_fields, check_no_data, &
    is_card
  use amontons_element_kinds, only: is_cohesive, has_faces_in_space, opposite_node
  use amontons_materials, only: material_type, property_table_type, damage_type, ELASTIC_TRACTION, SOFTENING_LINEAR, &
    SOFTENING_EXPONENTIAL, SOFTENING_TABULAR, MIX_NONE, MIX_POWER_LAW, MIX_BENZEGGAGH_KENANE
  use amontons_mesh, only: mesh_type, mean_face_normal
  use amontons_model, only: model_type
  use amontons_text, only: to_text, name_key, parse_real
  implicit none
  private
  public :: read_traction_elasticity, read_damage, check_damage, set_cohesive_sections

contains

  !> ELASTIC, TYPE=TRACTION: stiffnesses of normal, first and second shear direction.
  subroutine read_traction_elasticity(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    material%elastic_kind = ELASTIC_TRACTION
    call read_directions(reader, c, material%elastic)
    if (size(material%elastic%value, 2) > 0) material%youngs_modulus = material%elastic%value(1, 1)
  end subroutine read_traction_elasticity


  !> Three positive values over the temperature; a second shear value that is blank or 0 is that of the first.
  subroutine read_directions(reader, c, table)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(property_table_type), intent(out) :: table
    logical :: is_ok
    call read_table(reader, c, 3, table, is_ok)
    if (.not. is_ok) return
    where (.not. abs(table%value(3, :)) > 0) table%value(3, :) = table%value(2, :)
    if (.not. all(table%value > 0)) call report_error(reader, reader%cards%cards(c)%line, 'The values of the normal and of the ' &
      // 'shear directions must be positive; the second shear direction may be blank, and is then as the first.')
  end subroutine read_directions


  !> DAMAGE INITIATION, EVOLUTION or STABILIZATION.
  subroutine read_damage(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    if (.not. allocated(material%damage)) allocate (material%damage)
    if (is_card(reader, c, 'DAMAGEINITIATION')) call read_damage_initiation(reader, c, material)
    if (is_card(reader, c, 'DAMAGEEVOLUTION')) call read_damage_evolution(reader, c, material)
    if (is_card(reader, c, 'DAMAGESTABILIZATION')) call read_damage_stabilization(reader, c, material)
  end subroutine read_damage


  !> DAMAGE INITIATION.
  subroutine read_damage_initiation(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    character(:), allocatable :: word
    call open_card(reader, c, parameters, row)
    word = parameter_word(parameters, 'CRITERION', '')
    if (allocated(material%damage%initiation%value)) call report_error(reader, reader%cards%cards(c)%line, 'The material ''' // &
      material%name // ''' has *DAMAGE INITIATION before this card; a cohesive law has one criterion.')
    material%damage%is_of_strain = word == 'MAXE' .or. word == 'QUADE'
    material%damage%is_quadratic = word == 'QUADS' .or. word == 'QUADE'
    call read_directions(reader, c, material%damage%initiation)
  end subroutine read_damage_initiation


  !> DAMAGE EVOLUTION.
  subroutine read_damage_evolution(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: n, status
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    associate (law => material%damage, line => reader%cards%cards(c)%line)
      law%has_evolution = .true.
      law%is_by_energy = parameter_word(parameters, 'TYPE', '') == 'ENERGY'
      select case (parameter_word(parameters, 'SOFTENING', 'LINEAR'))
      case ('EXPONENTIAL')
        law%softening = SOFTENING_EXPONENTIAL
      case ('TABULAR')
        law%softening = SOFTENING_TABULAR
      case default
        law%softening = SOFTENING_LINEAR
      end select
      select case (parameter_word(parameters, 'MIXED MODE BEHAVIOR', 'MODEINDEPENDENT'))
      case ('POWERLAW')
        law%mode_mix = MIX_POWER_LAW
      case ('BK')
        law%mode_mix = MIX_BENZEGGAGH_KENANE
      case default
        law%mode_mix = MIX_NONE
      end select
      if (law%mode_mix /= MIX_NONE) then
        call parse_real(parameter_text(parameters, 'POWER'), law%mix_exponent, status)
        if (.not. law%mix_exponent > 0) call report_error(reader, line, 'POWER LAW and BK need POWER, a positive exponent.')
        if (.not. law%is_by_energy) call report_error(reader, line, 'POWER LAW and BK mix fracture energies: give TYPE=ENERGY.')
      end if
      if (law%softening == SOFTENING_TABULAR) then
        if (law%is_by_energy) call report_error(reader, line, 'SOFTENING=TABULAR needs TYPE=DISPLACEMENT: its table is damage ' // &
          'over separation.')
        call read_softening_table(reader, row, line, law)
        return
      end if
      n = 1
      if (law%is_by_energy .and. law%mode_mix /= MIX_NONE) n = 3
      if (.not. law%is_by_energy .and. law%softening == SOFTENING_EXPONENTIAL) n = 2
      if (n == 3) then
        call read_directions(reader, c, law%evolution)
        return
      end if
      call read_table(reader, c, n, law%evolution, is_ok)
      if (is_ok) is_ok = .not. all(law%evolution%value(1, :) > 0)
      if (is_ok) call report_error(reader, line, 'Fracture energy and separation must be positive.')
    end associate
  end subroutine read_damage_evolution


  !> SOFTENING=TABULAR: damage and separation since its start, both ascending from 0.
  subroutine read_softening_table(reader, row, line, law)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(inout) :: row
    integer, intent(in) :: line
    type(damage_type), intent(inout) :: law
    real(DP) :: values(2)
    logical :: is_ok
    allocate (law%table(2, 0))
    is_ok = .true.
    do while (next_row(reader%cards, row))
      call check_n_fields(reader, row, 2)
      call read_real(reader, row, 1, 'damage', values(2), is_ok)
      call read_real(reader, row, 2, 'separation', values(1), is_ok)
      law%table = reshape([law%table, values], [2, size(law%table, 2) + 1])
    end do
    if (.not. is_ok) return
    associate (n => size(law%table, 2))
      is_ok = n > 1
      if (is_ok) is_ok = all(abs(law%table(:, 1)) <= 0) .and. all(law%table(1, 2:) > law%table(1, :n - 1)) .and. &
        all(law%table(2, 2:) >= law%table(2, :n - 1)) .and. law%table(2, n) <= 1
    end associate
    if (.not. is_ok) call report_error(reader, line, 'A table of damage and separation begins with 0, 0 and has two lines or ' // &
      'more; separations ascend, and damage does not fall and is at most 1.')
  end subroutine read_softening_table


  !> DAMAGE STABILIZATION.
  subroutine read_damage_stabilization(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(property_table_type) :: table
    logical :: is_ok
    call read_table(reader, c, 1, table, is_ok)
    if (is_ok) material%damage%viscosity = table%value(1, 1)
    if (material%damage%viscosity < 0) call report_error(reader, reader%cards%cards(c)%line, 'The viscosity must not be negative.')
  end subroutine read_damage_stabilization


  !> Reports damage that does not go with its material.
  subroutine check_damage(reader, line, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    type(material_type), intent(inout) :: material
    character(:), allocatable :: who
    if (.not. allocated(material%damage)) return
    who = 'The material ''' // material%name // ''' '
    associate (law => material%damage)
      if (material%elastic_kind /= ELASTIC_TRACTION) then
        call report_error(reader, line, who // 'has damage without *ELASTIC, TYPE=TRACTION: damage is one of cohesive elements. ' &
          // 'That of solids needs a routine UMAT.')
        deallocate (material%damage)
        return
      else if (.not. allocated(law%initiation%value)) then
        call report_error(reader, line, who // 'has *DAMAGE EVOLUTION or *DAMAGE STABILIZATION without *DAMAGE INITIATION.')
        deallocate (material%damage)
        return
      end if
    end associate
  end subroutine check_damage


  !> Thickness, width and viscosity of the cohesive elements, which have materials; reports laws of the wrong kind.
  subroutine set_cohesive_sections(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model     !< with mesh and element sets
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP) :: values(2), viscosity
    integer :: c, set, i
    logical :: is_ok
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'COHESIVESECTION')) cycle
      if (.not. allocated(model%mesh%cohesive)) allocate (model%mesh%cohesive(2, model%mesh%n_elements), source=spread([1.0_DP, &
        0.0_DP], 2, model%mesh%n_elements))
      call open_card(reader, c, parameters, row)
      values = 1
      is_ok = .true.
      if (next_row(reader%cards, row)) then
        call check_n_fields(reader, row, 2)
        call read_real(reader, row, 1, 'thickness', values(1), is_ok, 1.0_DP)
        call read_real(reader, row, 2, 'width', values(2), is_ok, 1.0_DP)
        if (is_ok .and. .not. all(values > 0)) call report_error(reader, row%line, 'Thickness and width must be positive.')
        is_ok = is_ok .and. all(values > 0)
        if (next_row(reader%cards, row)) call check_no_data(reader, row)
      end if
      viscosity = viscosity_of(reader, c, parameter_text(parameters, 'CONTROLS'))
      set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
      if (set == 0 .or. .not. is_ok) cycle
      associate (members => model%mesh%element_sets(set)%members, mesh => model%mesh)
        do i = 1, size(members)
          if (.not. is_cohesive(mesh%kind(members(i)))) cycle   ! reported with the materials
          mesh%cohesive(:, members(i)) = [values(1), viscosity]
          if (parameter_word(parameters, 'THICKNESS', '') == 'GEOMETRY') mesh%cohesive(1, members(i)) = distance_of_faces(mesh, &
            members(i))
          if (mesh%cohesive(1, members(i)) <= 0) then
            call report_error(reader, reader%cards%cards(c)%line, 'THICKNESS=GEOMETRY needs faces that are apart, in the ' // &
              'direction from the first half of the nodes to the second; those of element ' // &
              to_text(mesh%element_label(members(i))) // ' are not. Give THICKNESS=SPECIFIED.')
            exit
          end if
          mesh%section_value(members(i)) = mesh%cohesive(1, members(i))
          if (.not. has_faces_in_space(mesh%kind(members(i)))) mesh%section_value(members(i)) = mesh%cohesive(1, members(i)) * &
            values(2)
        end do
        if (size(members) == 0) cycle
        associate (m => mesh%material(members(1)))
          if (m > 0) call check_energies(reader, reader%cards%cards(c)%line, model%materials(m), maxval(mesh%cohesive(1, members)))
        end associate
      end associate
    end do
    call check_laws(reader, model)
  end subroutine set_cohesive_sections


  !> Reports fracture energies below the energy which is stored where damage starts. Laws over the temperature and limits of strains
  !! are not looked at.
  subroutine check_energies(reader, line, material, thickness)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the section
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: thickness            !< [length]
    real(DP) :: stored
    integer :: k
    if (.not. allocated(material%damage)) return
    associate (law => material%damage)
      if (.not. law%is_by_energy .or. law%is_of_strain .or. material%elastic_kind /= ELASTIC_TRACTION) return
      if (.not. (allocated(law%evolution%value) .and. allocated(law%initiation%value))) return
      if (any([size(law%initiation%value, 2), size(law%evolution%value, 2), size(material%elastic%value, 2)] /= 1)) return
      do k = 1, 3
        associate (stiffness => material%elastic%value(k, 1), limit => law%initiation%value(k, 1), &
          G => law%evolution%value(min(k, size(law%evolution%value, 1)), 1))
          if (.not. min(stiffness, limit, G) > 0) cycle
          stored = limit**2 * thickness / (2 * stiffness)
          if (stored < G) cycle
          call report_error(reader, line, 'The material ''' // material%name // ''' has a fracture energy of ' // to_text(G) // &
            ', which is not above that stored where its damage starts, limit^2 thickness/(2 stiffness) = ' // to_text(stored) // &
            ': raise the stiffness, or lower the limit.')
          return
        end associate
      end do
    end associate
  end subroutine check_energies


  !> VISCOSITY of the SECTION CONTROLS of a name.
  real(DP) function viscosity_of(reader, section, name) result(viscosity)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: section               !< index of the card of the section
    character(*), intent(in) :: name             !< '': none
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: c, status
    viscosity = 0
    if (name == '') return
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'SECTIONCONTROLS')) cycle
      call open_card(reader, c, parameters, row)
      if (name_key(parameter_text(parameters, 'NAME')) /= name_key(name)) cycle
      if (has_parameter(parameters, 'VISCOSITY')) call parse_real(parameter_text(parameters, 'VISCOSITY'), viscosity, status)
      if (viscosity < 0) call report_error(reader, reader%cards%cards(c)%line, 'The viscosity must not be negative.')
      return
    end do
    call report_error(reader, reader%cards%cards(section)%line, 'There are no *SECTION CONTROLS ''' // name // '''.')
  end function viscosity_of


  !> Mean distance of the two faces of an element along the normal of the second.
  pure real(DP) function distance_of_faces(mesh, e) result(distance)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e
    real(DP) :: apart(3)
    integer :: a, n
    apart = 0
    associate (nodes => mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))
      n = size(nodes) / 2
      do a = 1, n
        apart = apart + (mesh%coordinates(:, nodes(opposite_node(mesh%kind(e), a))) - mesh%coordinates(:, nodes(a))) / real(n, DP)
      end do
    end associate
    distance = dot_product(apart, mean_face_normal(mesh, e, 2))
  end function distance_of_faces


  !> Reports cohesive elements without a cohesive law, and other elements with one; the first of each.
  subroutine check_laws(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    character(:), allocatable :: trouble
    logical :: is_reported(2)
    integer :: e, k
    is_reported = .false.
    do e = 1, model%mesh%n_elements
      if (model%mesh%material(e) == 0) cycle
      associate (material => model%materials(model%mesh%material(e)))
        if (is_cohesive(model%mesh%kind(e)) .eqv. material%elastic_kind == ELASTIC_TRACTION) cycle
        k = merge(1, 2, is_cohesive(model%mesh%kind(e)))
        if (is_reported(k)) cycle
        is_reported(k) = .true.
        trouble = ', which is one of cohesive elements alone.'
        if (k == 1) trouble = ', which is not a cohesive law: give it *ELASTIC, TYPE=TRACTION.'
        call report_error(reader, 0, 'The element ' // to_text(model%mesh%element_label(e)) // ' has the material ''' // &
          material%name // '''' // trouble)
      end associate
    end do
  end subroutine check_laws

end module amontons_deck_cohesive
