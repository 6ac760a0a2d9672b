!> Warnings of slips that a deck survives: decimal commas, keywords without a star, sets without members, mixed units, user
!! routines in shells.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_plausibility
  use amontons_cards, only: data_row_type, parameter_type, next_row, field_text
  use amontons_card_schema, only: find_entry, parameter_text, ENTRY_SUPPORTED
  use amontons_deck_reader, only: reader_type, open_card, report_note, has_decimal_comma, DECIMAL_COMMA_TEXT
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type
  use amontons_mesh, only: mesh_type, mesh_extent
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_text, only: name_key, is_one_of, to_text, plural
  implicit none
  private
  public :: report_traps, report_mixed_units, report_routines_of_shells

  character(*), parameter :: BULK_CARDS = 'NODE|ELEMENT'      !< many lines, each of which begins with a number
  character(*), parameter :: REAL_CARDS = 'ELASTIC|DENSITY|EXPANSION|PLASTIC|CREEP|FRICTION|SURFACEBEHAVIOR|STATIC|VISCO|' // &
    'AMPLITUDE|HYPERELASTIC|HYPERFOAM|SOLIDSECTION'
  character(*), parameter :: CONSTANT_CARDS = 'DENSITY|EXPANSION|FRICTION'     !< one number, then those it depends on
  character(*), parameter :: WORD_CARDS = 'HEADING|MPC'       !< their data may begin with a keyword
  character(*), parameter :: WORDS = 'DENSITY'                !< keywords that are also variables of OUTPUT cards

contains

  !> Reports the slips of all cards. All names must be read.
  subroutine report_traps(reader, mesh)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    character(:), allocatable :: key
    integer :: c
    do c = 1, reader%cards%n_cards
      if (reader%cards%cards(c)%entry == 0) cycle
      associate (entry => reader%table%entries(reader%cards%cards(c)%entry))
        if (entry%status /= ENTRY_SUPPORTED) cycle
        key = entry%key
      end associate
      call open_card(reader, c, parameters, row)
      if (.not. is_one_of(key, 'NODE|ELEMENT|NSET|ELSET')) call report_empty_sets(reader, mesh, c, parameters)
      if (is_one_of(key, BULK_CARDS) .and. reader%messages%n_errors == 0 .or. is_one_of(key, WORD_CARDS)) cycle
      do while (next_row(reader%cards, row))
        if (is_one_of(key, REAL_CARDS)) call report_decimal_commas(reader, row, is_one_of(key, CONSTANT_CARDS))
        call report_missing_star(reader, row, c)
      end do
    end do
  end subroutine report_traps


  !> Reports a line whose commas look like decimal commas.
  subroutine report_decimal_commas(reader, row, is_constant)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    logical, intent(in) :: is_constant           !< a line of two integers is one number with a decimal comma
    logical :: is_suspect
    is_suspect = has_decimal_comma(reader%cards, row, is_mixed=.true.)
    if (.not. is_suspect .and. is_constant .and. row%n == 2) is_suspect = has_decimal_comma(reader%cards, row, is_mixed=.false.)
    if (is_suspect) call report_note(reader, row%line, DECIMAL_COMMA_TEXT)
  end subroutine report_decimal_commas


  !> Reports a data line that begins with a keyword, which is no name of the deck.
  subroutine report_missing_star(reader, row, c)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    integer, intent(in) :: c                     !< card of the line
    character(:), allocatable :: key
    integer :: position
    logical :: is_abbreviated
    if (row%n == 0) return
    key = name_key(field_text(reader%cards, row, 1))
    if (scan(key // ' ', 'ABCDEFGHIJKLMNOPQRSTUVWXYZ') /= 1 .or. is_one_of(key, WORDS)) return
    call find_entry(reader%table, key, position, is_abbreviated)
    if (position == 0 .or. is_abbreviated) return
    if (reader%node_sets%find(key) + reader%element_sets%find(key) + reader%surfaces%find(key) > 0) return
    call report_note(reader, row%line, 'This line begins with the keyword ' // reader%table%entries(position)%keyword // &
      ' without its star; it counts as data of *' // reader%table%entries(reader%cards%cards(c)%entry)%keyword // '.')
  end subroutine report_missing_star


  !> Reports sets without members that a card names by NSET or ELSET.
  subroutine report_empty_sets(reader, mesh, c, parameters)
    type(reader_type), intent(inout) :: reader
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: c
    type(parameter_type), intent(in) :: parameters(:)
    character(:), allocatable :: name
    integer :: s
    name = parameter_text(parameters, 'NSET')
    s = reader%node_sets%find(name)
    if (s > 0) then
      if (size(mesh%node_sets(s)%members) == 0) call report_note(reader, reader%cards%cards(c)%line, 'The node set ''' // name // &
        ''' has no members.')
    end if
    name = parameter_text(parameters, 'ELSET')
    s = reader%element_sets%find(name)
    if (s > 0) then
      if (size(mesh%element_sets(s)%members) == 0 .and. .not. reader%has_omitted_elements(s)) call report_note(reader, &
        reader%cards%cards(c)%line, 'The element set ''' // name // ''' has no members.')
    end if
  end subroutine report_empty_sets


  !> Reports user routines in shells and beams: Abaqus calls them with the components of plane stress, of beams.
  subroutine report_routines_of_shells(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    logical :: is_used(0:size(model%materials))
    integer :: e, m
    if (reader%dialect == DIALECT_CALCULIX .or. .not. allocated(model%structure)) return
    is_used = .false.
    do e = 1, model%mesh%n_elements
      if (model%structure%section(e) > 0) is_used(model%mesh%material(e)) = .true.
    end do
    do m = 1, size(model%materials)
      associate (material => model%materials(m))
        if (is_used(m) .and. material%is_user .and. .not. (material%is_called_in_3d .or. material%is_shell_law)) call report_note( &
          reader, 0, 'The routine of the material ''' // material%name // ''' is called with NTENS = 6 in shells and beams, ' // &
          'which are solids here; one for plane stress gives wrong stresses. *TRANSVERSE SHEAR STIFFNESS below the section of ' // &
          'shells calls it with NTENS = 3, as Abaqus does; SPATIAL on *USER MATERIAL says that it serves, and ends this note.')
      end associate
    end do
  end subroutine report_routines_of_shells


  !> Hints at moduli, densities and lengths that no solid has together in N, m, kg or N, mm, t. Of all solids the speed of sound
  !! sqrt(E/rho) is 10 to 20000 m/s, and diamond is the stiffest with 1.2e12 Pa.
  subroutine report_mixed_units(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    logical :: is_used(0:size(model%materials))
    real(DP) :: extent
    integer :: m
    is_used = .false.
    is_used(model%mesh%material) = .true.
    extent = mesh_extent(model%mesh)
    do m = 1, size(model%materials)
      if (is_used(m) .and. model%materials(m)%youngs_modulus > 0.0_DP) call report_material(reader, model%materials(m), extent)
    end do
  end subroutine report_mixed_units


  !> The hints at one material.
  subroutine report_material(reader, material, extent)
    type(reader_type), intent(inout) :: reader
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: extent               !< of the mesh [length]
    real(DP), parameter :: STIFFEST = 2.0e12_DP, SURELY_IN_PA = 5.0e9_DP, LONGEST_IN_M = 50.0_DP
    real(DP), parameter :: METALS(2) = [1.0e4_DP, 1.3e6_DP], SHORTEST_IN_MM = 0.2_DP       ! [MPa], [mm]
    real(DP), parameter :: NO_UNITS(2) = [1.0e3_DP, 5.0e2_DP]           ! smaller moduli with smaller densities: no units
    real(DP), parameter :: SLOWEST = 10.0_DP, FASTEST = 2.0e7_DP        ! [m/s] in N, m, kg; [mm/s] in N, mm, t
    real(DP), parameter :: SOFT_METALS(2) = [1.0e3_DP, 2.0e6_DP], IN_KG_PER_MM3(2) = [5.0e-7_DP, 3.0e-5_DP]
    character(*), parameter :: STEEL = ' Steel has 210000 and 7.85e-9 in N, mm, t; 2.1e11 and 7850 in N, m, kg.'
    real(DP) :: speed
    associate (modulus => material%youngs_modulus, density => material%density)
      if (modulus > STIFFEST) then
        call report_note(reader, 0, 'No solid has the Young''s modulus ' // to_text(modulus) // ' of ''' // material%name // &
          ''' in Pa or MPa.' // STEEL)
      else if (modulus >= SURELY_IN_PA .and. extent > LONGEST_IN_M) then
        call report_note(reader, 0, 'The Young''s modulus ' // to_text(modulus) // ' of ''' // material%name // &
          ''' is in Pa, which belongs to lengths in m; the model is ' // to_text(extent) // ' long. Is it in mm?' // STEEL)
      else if (modulus >= METALS(1) .and. modulus <= METALS(2) .and. extent < SHORTEST_IN_MM) then
        call report_note(reader, 0, 'The Young''s modulus ' // to_text(modulus) // ' of ''' // material%name // &
          ''' looks like MPa, which belong to lengths in mm; the model is ' // to_text(extent) // ' long. Is it in m?' // STEEL)
      end if
      if (.not. density > 0.0_DP .or. (modulus < NO_UNITS(1) .and. density < NO_UNITS(2))) return
      speed = sqrt(modulus / density)
      if (speed >= SLOWEST .and. speed <= FASTEST .and. .not. (modulus >= SOFT_METALS(1) .and. modulus <= SOFT_METALS(2) .and. &
        density >= IN_KG_PER_MM3(1) .and. density <= IN_KG_PER_MM3(2))) return
      call report_note(reader, 0, 'No solid has both the Young''s modulus ' // to_text(modulus) // ' and the density ' // &
        to_text(density) // ' of ''' // material%name // ''' in one system of units: the speed of sound would be ' // &
        to_text(speed) // '.' // STEEL)
    end associate
  end subroutine report_material

end module amontons_deck_plausibility
