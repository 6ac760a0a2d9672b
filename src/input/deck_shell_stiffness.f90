!> SHELL GENERAL SECTION with the stiffness of a section: layers of materials that have it.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_shell_stiffness
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_deck_materials, only: add_anisotropic_material
  use amontons_deck_reader, only: reader_type, report_error, read_real, check_n_fields
  use amontons_deck_transverse_shear, only: read_shell_shear
  use amontons_equivalent_layers, only: equivalent_layers_type, find_equivalent_layers, transverse_shear_moduli, &
    N_EQUIVALENT_LAYERS, LAYERS_OK, LAYERS_INDEFINITE
  use amontons_model, only: model_type
  use amontons_structural_data, only: structural_section_type, layer_type
  use amontons_text, only: parse_real
  implicit none
  private
  public :: read_shell_stiffness

contains

  !> Three lines of eight, eight and five numbers: the upper triangle of the 6 x 6 stiffness, column by column. The section gets
  !! layers of new materials.
  subroutine read_shell_stiffness(reader, c, parameters, row, is_quadratic, section, model)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), intent(in) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    logical, intent(in) :: is_quadratic          !< the elements are
    type(structural_section_type), intent(inout) :: section
    type(model_type), intent(inout) :: model     !< out: with more materials
    type(equivalent_layers_type) :: layers
    type(layer_type) :: layer
    real(DP) :: numbers(21), stiffness(6, 6), density, shear(2, 2), G(2, 2)
    integer :: i, j, k, status
    logical :: is_ok, is_given
    section%thickness(1) = 1                     ! after an error
    call read_triangle(reader, c, row, numbers, is_ok)
    if (.not. is_ok) return
    k = 0
    do j = 1, 6
      do i = 1, j
        k = k + 1
        stiffness(i, j) = numbers(k)
        stiffness(j, i) = numbers(k)
      end do
    end do
    call find_equivalent_layers(stiffness, layers, status)
    if (status == LAYERS_INDEFINITE) then
      call report_error(reader, reader%cards%cards(c)%line, 'The stiffness of the section must be positive definite: membrane ' // &
        'forces and moments 11, 22, 12 over the strains and curvatures that they cause.')
      return
    else if (status /= LAYERS_OK) then
      call report_error(reader, reader%cards%cards(c)%line, 'No layers of solids have this stiffness: it bends much ' // &
        'stiffer or softer in one direction than its stretching allows, like a ribbed or corrugated sheet. Model the ribs, as ' // &
        'beams or shells, or build the sheet of *SHELL SECTION, COMPOSITE.')
      return
    end if
    shear = reshape([1.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [2, 2]) * layers%transverse_shear
    call read_shell_shear(reader, c, shear, is_given)
    G = transverse_shear_moduli(shear, [(layers%thickness, k=1, N_EQUIVALENT_LAYERS)], reshape([(layers%Q(1, 1, k), &
      layers%Q(2, 2, k), k=1, N_EQUIVALENT_LAYERS)], [2, N_EQUIVALENT_LAYERS]), is_quadratic)
    density = 0
    if (has_parameter(parameters, 'DENSITY')) call parse_real(parameter_text(parameters, 'DENSITY'), density, status)
    section%thickness(1) = N_EQUIVALENT_LAYERS * layers%thickness
    allocate (section%layers(0))
    do k = 1, N_EQUIVALENT_LAYERS
      call add_anisotropic_material(reader, c, model, plane_constants(layers, k, G), density / section%thickness(1))
      layer = layer_type(thickness=layers%thickness, material=size(model%materials), line=reader%cards%cards(c)%line)
      layer%orientation = ''
      section%layers = [section%layers, layer]
    end do
  end subroutine read_shell_stiffness


  !> The numbers of the triangle.
  subroutine read_triangle(reader, c, row, numbers, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row
    real(DP), intent(out) :: numbers(21)
    logical, intent(out) :: is_ok
    integer :: i, k
    is_ok = .true.
    numbers = 0
    do k = 1, 3
      if (.not. next_row(reader%cards, row)) then
        is_ok = .false.
        call report_error(reader, reader%cards%cards(c)%line, '*SHELL GENERAL SECTION needs a MATERIAL and a line with the ' // &
          'thickness, or COMPOSITE and its layers, or three lines of 8, 8 and 5 numbers: the upper triangle of the stiffness, ' // &
          'column by column.')
        return
      end if
      call check_n_fields(reader, row, merge(5, 8, k == 3))
      do i = 1, merge(5, 8, k == 3)
        call read_real(reader, row, i, 'stiffness of the section', numbers(8 * (k - 1) + i), is_ok, 0.0_DP)
      end do
    end do
    if (next_row(reader%cards, row)) then
      is_ok = .false.
      call report_error(reader, row%line, 'Thermal forces and scale factors over the temperature are not supported in ' // &
        '*SHELL GENERAL SECTION; use *SHELL SECTION, COMPOSITE with materials that expand.')
    end if
  end subroutine read_triangle


  !> The 21 constants of a layer: plane stress without coupling to the thickness.
  pure function plane_constants(layers, k, G) result(constants)
    type(equivalent_layers_type), intent(in) :: layers
    integer, intent(in) :: k                     !< layer
    real(DP), intent(in) :: G(2, 2)              !< of stress 13, 23 over its strain [stress]
    real(DP) :: constants(21)                    !< as *ELASTIC, TYPE=ANISO gives them [stress]
    constants = 0
    associate (Q => layers%Q(:, :, k))
      constants(1:3) = [Q(1, 1), Q(1, 2), Q(2, 2)]
      constants(6:8) = [layers%thickness_modulus, Q(1, 3), Q(2, 3)]
      constants(10) = Q(3, 3)
    end associate
    constants(15) = G(1, 1)                      ! 1313
    constants(20:21) = G(:, 2)                   ! 1323, 2323
  end function plane_constants

end module amontons_deck_shell_stiffness
