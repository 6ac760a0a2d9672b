!> TRANSVERSE SHEAR STIFFNESS below the section of shells or beams.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Shells are solids: their materials are replaced by ones whose shear moduli 13 and 23 make the stiffness of the section, with
!! `transverse_shear_moduli` of `expansion/equivalent_layers`. Beams by their section have the numbers themselves.
module amontons_deck_transverse_shear
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: ENTRY_IGNORED
  use amontons_deck_materials, only: add_sheared_material
  use amontons_deck_reader, only: reader_type, open_card, report_error, read_real, check_n_fields, is_card, &
    check_no_data
  use amontons_equivalent_layers, only: transverse_shear_moduli
  use amontons_elasticity, only: elasticity_matrix
  use amontons_materials, only: material_type, is_linear_elastic, CREEP_NONE, INELASTIC_NONE
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_structural_data, only: structural_section_type, layer_type
  use amontons_text, only: upper_case
  implicit none
  private
  public :: has_transverse_shear, report_lost_shear, read_beam_shear, refuse_beam_shear, read_shell_shear, replace_materials

contains

  !> Whether a TRANSVERSE SHEAR STIFFNESS is below a section.
  logical function has_transverse_shear(reader, c)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    has_transverse_shear = shear_card(reader, c) > 0
  end function has_transverse_shear


  !> The TRANSVERSE SHEAR STIFFNESS below a section, behind cards without effect; 0: none.
  integer function shear_card(reader, c)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    integer :: k
    shear_card = 0
    do k = c + 1, reader%cards%n_cards
      if (is_card(reader, k, 'TRANSVERSESHEARSTIFFNESS')) shear_card = k
      if (shear_card > 0 .or. .not. is_ignored(reader, k)) return
    end do
  end function shear_card


  !> The line of the TRANSVERSE SHEAR STIFFNESS below a section.
  integer function shear_line(reader, c)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card of the section, which has one below
    shear_line = reader%cards%cards(shear_card(reader, c))%line
  end function shear_line


  !> Whether a card has no effect.
  logical function is_ignored(reader, c)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    is_ignored = .false.
    if (reader%cards%cards(c)%entry > 0) is_ignored = reader%table%entries(reader%cards%cards(c)%entry)%status == ENTRY_IGNORED
  end function is_ignored


  !> Reports cards that are not below a section, and so are not read.
  subroutine report_lost_shear(reader)
    type(reader_type), intent(inout) :: reader
    integer :: c, k
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'TRANSVERSESHEARSTIFFNESS')) cycle
      k = c - 1
      do while (k > 0)
        if (.not. is_ignored(reader, k)) exit
        k = k - 1
      end do
      if (k > 0) then
        if (is_card(reader, k, 'SHELLSECTION') .or. is_card(reader, k, 'SHELLGENERALSECTION') .or. is_card(reader, k, &
          'BEAMSECTION') .or. is_card(reader, k, 'BEAMGENERALSECTION')) cycle
      end if
      call report_error(reader, reader%cards%cards(c)%line, '*TRANSVERSE SHEAR STIFFNESS must be directly below *SHELL ' // &
        'SECTION, *SHELL GENERAL SECTION or the section of a beam, once.')
    end do
  end subroutine report_lost_shear


  !> The shear stiffnesses of beams that keep those of their section: the first number is along direction 2, as in Abaqus.
  subroutine read_beam_shear(reader, c, shear)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    real(DP), intent(inout) :: shear(2)          !< along direction 1, 2 [force]
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP) :: K(2), factor
    logical :: is_ok
    if (.not. has_transverse_shear(reader, c)) return
    call open_below(reader, c, parameters, row, is_ok)
    if (.not. is_ok) return
    call check_n_fields(reader, row, 3)
    call read_pair(reader, row, ['K23', 'K13'], K, is_ok)
    if (upper_case(field_text(reader%cards, row, 3)) /= 'SCF') then
      call read_real(reader, row, 3, 'slenderness compensation factor', factor, is_ok, 0.25_DP)
      if (is_ok .and. factor < 0) call report_error(reader, row%line, 'The slenderness compensation factor is not negative.')
    end if
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
    if (is_ok) shear = [K(2), K(1)]
  end subroutine read_beam_shear


  !> Beams that are solids.
  subroutine refuse_beam_shear(reader, c)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    if (has_transverse_shear(reader, c)) call report_error(reader, shear_line(reader, c), 'Beams of this ' // &
      'cross-section are solids, whose shear stiffness is that of their material: leave the card out, or give the beam by ' // &
      '*BEAM GENERAL SECTION, SECTION=GENERAL (small displacements), which takes K23 and K13.')
  end subroutine refuse_beam_shear


  !> K11, K22, K12 of a shell.
  subroutine read_shell_shear(reader, c, K, is_given)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    real(DP), intent(inout) :: K(2, 2)           !< shear forces 1, 2 over the strains 13, 23 [force/length]
    logical, intent(out) :: is_given             !< .false.: there is no card, or its errors are reported
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    real(DP) :: pair(2), mixed
    is_given = has_transverse_shear(reader, c)
    if (.not. is_given) return
    call open_below(reader, c, parameters, row, is_given)
    if (.not. is_given) return
    call check_n_fields(reader, row, 3)
    call read_pair(reader, row, ['K11', 'K22'], pair, is_given)
    call read_real(reader, row, 3, 'K12', mixed, is_given, 0.0_DP)
    if (is_given .and. .not. pair(1) * pair(2) > mixed**2) then
      call report_error(reader, row%line, 'K11 K22 must be larger than the square of K12: else the section has no stiffness ' // &
        'against some shear.')
      is_given = .false.
    end if
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
    if (is_given) K = reshape([pair(1), mixed, mixed, pair(2)], [2, 2])
  end subroutine read_shell_shear


  !> The card below a section and its first data line.
  subroutine open_below(reader, c, parameters, row, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    type(parameter_type), allocatable, intent(out) :: parameters(:)
    type(data_row_type), intent(inout) :: row
    logical, intent(out) :: is_ok
    call open_card(reader, shear_card(reader, c), parameters, row)
    is_ok = reader%dialect /= DIALECT_CALCULIX
    if (.not. is_ok) then
      call report_error(reader, shear_line(reader, c), 'CalculiX has no *TRANSVERSE SHEAR STIFFNESS: give G13 and ' // &
        'G23 of the material (*ELASTIC, TYPE=ENGINEERING CONSTANTS), or run the deck in the abaqus dialect.')
      return
    end if
    is_ok = next_row(reader%cards, row)
    if (.not. is_ok) call report_error(reader, shear_line(reader, c), 'The data line is missing: K11, K22, K12 of ' // &
      'shells [force/length]; K23, K13 and the slenderness compensation factor of beams [force].')
  end subroutine open_below


  !> Two positive numbers; where one is blank or zero it is the other.
  subroutine read_pair(reader, row, names, pair, is_ok)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    character(*), intent(in) :: names(2)
    real(DP), intent(out) :: pair(2)
    logical, intent(out) :: is_ok
    integer :: i
    is_ok = .true.
    pair = 0
    do i = 1, 2
      call read_real(reader, row, i, names(i), pair(i), is_ok, 0.0_DP)
    end do
    if (.not. is_ok) return
    where (.not. abs(pair) > 0) pair = pair([2, 1])
    is_ok = all(pair > 0)
    if (.not. is_ok) call report_error(reader, row%line, names(1) // ' and ' // names(2) // ' must be positive; where one of ' // &
      'them is blank it is the other.')
  end subroutine read_pair


  !> Gives the layers of a section, or its one layer, materials with the shear moduli that make the stiffness of the card below it.
  subroutine replace_materials(reader, c, is_quadratic, section, material, model)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    logical, intent(in) :: is_quadratic          !< the elements are
    type(structural_section_type), intent(inout) :: section
    integer, intent(inout) :: material           !< of the section; 0: none, reported
    type(model_type), intent(inout) :: model     !< out: with more materials
    type(layer_type), allocatable :: layers(:)
    real(DP), allocatable :: Q(:, :)
    real(DP) :: K(2, 2), G(2, 2)
    integer :: l
    logical :: is_given
    call read_shell_shear(reader, c, K, is_given)
    if (.not. (is_given .and. section%thickness(1) > 0)) return
    if (section%has_nodal_thickness) then
      call report_error(reader, shear_line(reader, c), 'A shell with NODAL THICKNESS takes no *TRANSVERSE SHEAR ' // &
        'STIFFNESS: give G13 and G23 of the material (*ELASTIC, TYPE=ENGINEERING CONSTANTS or LAMINA), from which it follows ' // &
        'at each thickness.')
      return
    end if
    if (allocated(section%layers)) then
      layers = section%layers
    else
      layers = [layer_type(thickness=section%thickness(1), material=material)]
    end if
    if (any(layers%material == 0)) return        ! reported
    call check_user_layers(reader, c, layers, model%materials, is_given)
    if (.not. is_given) return
    allocate (Q(2, size(layers)), source=1.0_DP)     ! of UMAT: all the same
    do l = 1, size(layers)
      if (.not. has_constants(model%materials(layers(l)%material))) return   ! reported
      call check_layer(reader, c, layers(l), model%materials(layers(l)%material), is_given)
      if (.not. is_given) return
      associate (material => model%materials(layers(l)%material))
        if (.not. material%is_user) Q(:, l) = bending_moduli(material, layers(l)%angle)
      end associate
    end do
    G = transverse_shear_moduli(K, layers%thickness, Q, is_quadratic)
    do l = 1, size(layers)
      call add_sheared_material(model, layers(l)%material, turned(G, layers(l)%angle))
      if (allocated(section%layers)) section%layers(l)%material = size(model%materials)
    end do
    material = size(model%materials)
  end subroutine replace_materials


  !> Whether a material has elastic constants, or a routine UMAT in place of them.
  pure logical function has_constants(material)
    type(material_type), intent(in) :: material
    has_constants = material%is_user
    if (allocated(material%elastic%value)) has_constants = has_constants .or. size(material%elastic%value, 2) > 0
  end function has_constants


  !> Reports layers by UMAT unless all are of one law in one direction: the stiffness of others is not known when the deck is read.
  subroutine check_user_layers(reader, c, layers, materials, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    type(layer_type), intent(in) :: layers(:)
    type(material_type), intent(in) :: materials(:)
    logical, intent(out) :: is_ok
    is_ok = .not. any(materials(layers%material)%is_user) .or. (all(layers%material == layers(1)%material) .and. &
      maxval(abs(layers%angle - layers(1)%angle)) <= 0)
    if (.not. is_ok) call report_error(reader, shear_line(reader, c), 'Above *TRANSVERSE SHEAR STIFFNESS the layers of a ' // &
      '*USER MATERIAL all have the same material and angle: the shear moduli of others follow from their stiffness, which ' // &
      'UMAT alone knows. Leave the card out; UMAT is then called with NTENS = 6.')
  end subroutine check_user_layers


  !> Reports a layer with axes of its own, or a material that is not plain.
  subroutine check_layer(reader, c, layer, material, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card of the section
    type(layer_type), intent(in) :: layer
    type(material_type), intent(in) :: material
    logical, intent(out) :: is_ok
    is_ok = .true.
    if (allocated(layer%orientation)) is_ok = layer%orientation == ''
    if (.not. is_ok) then
      call report_error(reader, layer%line, 'Above *TRANSVERSE SHEAR STIFFNESS the layers take angles, no ORIENTATION of ' // &
        'their own: the stiffness is that of the axes of the section.')
      return
    end if
    is_ok = .not. (material%is_user .and. material%is_called_in_3d)
    if (.not. is_ok) then
      call report_error(reader, shear_line(reader, c), 'The material ''' // material%name // &
        ''' is by UMAT in space (SPATIAL): its transverse shear is part of its law. Leave the card out, or SPATIAL, without ' // &
        'which UMAT gives the plane stress of shells.')
      return
    end if
    is_ok = has_plain_elasticity(material) .or. material%is_user
    if (.not. is_ok) call report_error(reader, shear_line(reader, c), 'The material ''' // material%name // &
      ''' is not linear elastic: its transverse shear is part of its law here. Leave the card out, which gives the shell the ' // &
      'shear stiffness of the material.')
  end subroutine check_layer


  !> Whether nothing but linear elasticity, expansion and density counts.
  pure logical function has_plain_elasticity(material) result(is_so)
    type(material_type), intent(in) :: material
    is_so = material%has_elastic .and. is_linear_elastic(material) .and. .not. (material%is_user .or. material%is_user_field .or. &
      material%is_corotational .or. material%has_deformation_plasticity .or. allocated(material%isotropic_hardening) .or. &
      allocated(material%kinematic_hardening) .or. allocated(material%prony) .or. allocated(material%cone%value) .or. &
      material%cutoff_sign /= 0) .and. material%creep_law == CREEP_NONE .and. material%inelastic_law == INELASTIC_NONE
  end function has_plain_elasticity


  !> The moduli of a layer in cylindrical bending along the axes 1 and 2 of the section: of stress 11 over strain 11 and of 22 over
  !! 22 without other strains in the plane and without stress across it, at the first temperature of its table.
  pure function bending_moduli(material, angle) result(Q)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: angle                !< of its axes against those of the section [rad]
    real(DP) :: Q(2)                             !< [stress]
    real(DP) :: C(6, 6), P(3, 3), cc, ss, cs
    integer, parameter :: IN_PLANE(3) = [1, 2, 4]   !< 11, 22, 12
    integer :: i, j
    C = elasticity_matrix(material%elastic_kind, material%elastic%value(:, 1))
    do j = 1, 3
      do i = 1, 3
        P(i, j) = C(IN_PLANE(i), IN_PLANE(j)) - C(IN_PLANE(i), 3) * C(3, IN_PLANE(j)) / C(3, 3)
      end do
    end do
    cc = cos(angle)**2
    ss = sin(angle)**2
    cs = cos(angle) * sin(angle)
    Q(1) = along([cc, ss, cs])
    Q(2) = along([ss, cc, -cs])

  contains

    !> The modulus of a strain along a direction whose tensor components 11, 22, 12 are given.
    pure real(DP) function along(n)
      real(DP), intent(in) :: n(3)
      along = dot_product([n(1), n(2), 2 * n(3)], matmul(P, [n(1), n(2), 2 * n(3)]))
    end function along

  end function bending_moduli


  !> A symmetric matrix in axes that are turned by an angle.
  pure function turned(G, angle)
    real(DP), intent(in) :: G(2, 2)
    real(DP), intent(in) :: angle                !< of the new axes against the old ones [rad]
    real(DP) :: turned(2, 2), R(2, 2)
    R = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])   ! columns: the new axes
    turned = matmul(transpose(R), matmul(G, R))
  end function turned

end module amontons_deck_transverse_shear
