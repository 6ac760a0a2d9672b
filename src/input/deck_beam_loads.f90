!> Forces per length on beams by DLOAD: P1 and P2 along the directions of the cross-section, PX, PY and PZ along the axes.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! P1 and P2 are pressures on the side of the solid whose inward normal is direction 1 or 2: the force over the dimension across;
!! in the calculix dialect the value is this pressure, as in CalculiX 2.20. They follow the beam under NLGEOM. PX, PY and PZ are
!! forces per volume: the force over the area of the cross-section.
module amontons_deck_beam_loads
  use amontons_kinds, only: DP, PI
  use amontons_cards, only: data_row_type, field_text
  use amontons_deck_reader, only: reader_type, report_error, read_real, check_n_fields, elements_of_field
  use amontons_element_kinds, only: FAMILY_BEAM
  use amontons_load_propagation, only: active_loads_type, load_region_type, add_load, find_or_add_place
  use amontons_loads, only: DISTRIBUTED_BODY_FORCE
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_structural_data, only: structural_section_type, SECTION_CIRC, SECTION_PIPE, SECTION_BOX
  use amontons_text, only: name_key, to_text
  implicit none
  private
  public :: is_beam, read_line_load

  integer, parameter :: SIDE_OF_DIRECTION(2) = [1, 5]   !< the face of the solid whose inward normal is direction 1, 2

contains

  !> Whether an element is a beam that expands into a solid.
  pure logical function is_beam(model, e)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                     !< element
    is_beam = .false.
    if (.not. allocated(model%structure)) return
    if (model%structure%section(e) == 0) return
    is_beam = model%structure%sections(model%structure%section(e))%family == FAMILY_BEAM
  end function is_beam


  !> Row: element or element set of beams, P1, P2, PX, PY or PZ, force per length.
  subroutine read_line_load(reader, model, row, amplitude, active_loads)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: amplitude
    type(active_loads_type), intent(inout) :: active_loads
    integer, allocatable :: elements(:)
    character(:), allocatable :: label
    real(DP) :: value, thickness
    integer :: i, s, direction, place
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 3)
    call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
    call read_real(reader, row, 3, 'force per length', value, is_ok, 0.0_DP)
    if (.not. is_ok) return
    label = name_key(field_text(reader%cards, row, 2))
    do i = 1, size(elements)
      if (is_beam(model, elements(i))) cycle
      call report_error(reader, row%line, label // ', a force per length, is for beams of solid and hollow sections; the element ' &
        // to_text(model%mesh%element_label(elements(i))) // ' is none. Beams by their section take *CLOAD at their nodes.')
      return
    end do
    direction = index('12', label(2:2))
    if (direction > 0) then
      do i = 1, size(elements)
        thickness = 1
        if (reader%dialect /= DIALECT_CALCULIX) thickness = thickness_across(model, elements(i), 3 - direction)
        call add_load(6 * elements(i) - 6 + SIDE_OF_DIRECTION(direction), value / thickness, amplitude, active_loads%step, &
          active_loads%is_step, active_loads%pressures)
      end do
      return
    end if
    do s = 1, size(model%structure%sections)
      associate (region => pack(elements, model%structure%section(elements) == s))
        if (size(region) == 0) cycle
        if (model%structure%sections(s)%has_nodal_thickness) then
          call report_error(reader, row%line, label // ' is for beams of constant cross-section, without NODAL THICKNESS: ' // &
            'P1 and P2 act on others, too.')
          return
        end if
        call find_or_add_place(active_loads, new_region(reader, row, label, region, s), place)
        call add_load(place, value / section_area(model%structure%sections(s)), amplitude, active_loads%step, &
          active_loads%is_step, active_loads%volumes)
      end associate
    end do
  end subroutine read_line_load


  !> The region of a load along an axis on the elements of one section.
  function new_region(reader, row, label, elements, s) result(region)
    type(reader_type), intent(in) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: label            !< PX, PY or PZ
    integer, intent(in) :: elements(:)
    integer, intent(in) :: s                     !< section
    type(load_region_type) :: region
    region%kind = DISTRIBUTED_BODY_FORCE
    region%region = name_key(field_text(reader%cards, row, 1)) // '.' // label // to_text(s)
    region%elements = elements
    region%direction(index('XYZ', label(2:2))) = 1
  end function new_region


  !> The mean dimension of a beam's solid along direction 1 or 2.
  pure real(DP) function thickness_across(model, e, direction) result(thickness)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                     !< element
    integer, intent(in) :: direction             !< 1 or 2
    integer :: k
    thickness = 0
    associate (structure => model%structure)
      do k = structure%first(e), structure%first(e + 1) - 1
        thickness = thickness + structure%directors(structure%director_of(k))%thickness(direction)
      end do
      thickness = thickness / real(structure%first(e + 1) - structure%first(e), DP)
    end associate
  end function thickness_across


  !> The area of a cross-section, as its points have it.
  pure real(DP) function section_area(section) result(area)
    type(structural_section_type), intent(in) :: section
    real(DP) :: inner(2)
    area = product(section%thickness)
    select case (section%shape)
    case (SECTION_CIRC)
      area = 0.25_DP * PI * area
    case (SECTION_PIPE)
      area = 0.25_DP * PI * area * (1 - (1 - 2 * section%walls(1))**2)
    case (SECTION_BOX)
      inner = 1 - 0.5_DP * (section%walls([1, 2]) + section%walls([3, 4]))
      area = area * (sum(section%walls([2, 4])) * inner(1) + sum(section%walls([1, 3])) * inner(2))
    end select
  end function section_area

end module amontons_deck_beam_loads
