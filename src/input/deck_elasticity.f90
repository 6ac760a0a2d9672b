!> ELASTIC, and the elastic laws that CalculiX takes by the name of the material, to the constants of materials.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_elasticity
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type
  use amontons_card_schema, only: parameter_text, parameter_word
  use amontons_deck_cohesive, only: read_traction_elasticity
  use amontons_deck_property_tables, only: read_table
  use amontons_deck_reader, only: reader_type, open_card, report_error
  use amontons_invariant_elasticity, only: N_FIBRE_CONSTANTS, MAX_FIBRES
  use amontons_materials, only: material_type, ELASTIC_ISOTROPIC, ELASTIC_ORTHOTROPIC, ELASTIC_ANISOTROPIC, &
    ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY, ELASTIC_CIARLET, ELASTIC_FIBRES, is_one_sided
  use amontons_text, only: upper_case, to_text, parse_integer, NUMBER_OK
  implicit none
  private
  public :: read_elastic, read_law_by_name, is_law_by_name, law_of_name, check_isotropic, check_definite

  !> Names of materials begin with these words (calculix dialect).
  character(16), parameter :: LAW_NAMES(5) = [character(16) :: 'TENSION_ONLY', 'COMPRESSION_ONLY', 'CIARLET_EL', 'ELASTIC_FIBER', &
    'LIN_ISO_EL']
  integer, parameter :: LAW_KINDS(5) = [ELASTIC_TENSION_ONLY, ELASTIC_COMPRESSION_ONLY, ELASTIC_CIARLET, ELASTIC_FIBRES, &
    ELASTIC_ISOTROPIC]
  real(DP), parameter :: MIN_COMPRESSIBILITY = 1.0e-10_DP   !< D1 below it [1/stress]: CalculiX takes 1/(20 C1)

contains

  !> ELASTIC.
  subroutine read_elastic(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(inout) :: material
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    material%has_elastic = .true.                ! errors of the card are reported below
    select case (parameter_word(parameters, 'TYPE', 'ISO'))
    case ('ISO', 'ISOTROPIC')
      material%elastic_kind = ELASTIC_ISOTROPIC
      call read_table(reader, c, 2, material%elastic, is_ok)
      if (.not. is_ok) return
      do i = 1, size(material%elastic%temperature)
        call check_isotropic(reader, c, material%elastic%value(:, i))
      end do
      material%youngs_modulus = material%elastic%value(1, 1)
      material%poissons_ratio = material%elastic%value(2, 1)
    case ('ORTHO', 'ORTHOTROPIC', 'ENGINEERINGCONSTANTS')
      material%elastic_kind = ELASTIC_ORTHOTROPIC
      call read_table(reader, c, 9, material%elastic, is_ok)
      if (is_ok .and. parameter_word(parameters, 'TYPE', '') == 'ENGINEERINGCONSTANTS') then
        do i = 1, size(material%elastic%temperature)
          call convert_constants(reader, c, material%elastic%value(:, i), is_ok)
        end do
      end if
    case ('LAMINA')
      material%elastic_kind = ELASTIC_ORTHOTROPIC
      material%is_lamina = .true.
      call read_table(reader, c, 6, material%elastic, is_ok)
      if (.not. is_ok) return
      associate (x => material%elastic%value)    ! E1, E2, nu12, G12, G13, G23; the thickness as direction 2, without nu13, nu23
        material%elastic%value = reshape([(x(1, i), x(2, i), x(2, i), x(3, i), 0.0_DP, 0.0_DP, x(4:, i), i=1, size(x, 2))], &
          [9, size(x, 2)])
      end associate
      do i = 1, size(material%elastic%temperature)
        call convert_constants(reader, c, material%elastic%value(:, i), is_ok)
      end do
    case ('ANISO', 'ANISOTROPIC')
      material%elastic_kind = ELASTIC_ANISOTROPIC
      call read_table(reader, c, 21, material%elastic, is_ok)
    case ('TRACTION')
      call read_traction_elasticity(reader, c, material)
      return
    case default
      return                                     ! already reported by the check of the card
    end select
    if (material%elastic_kind /= ELASTIC_ISOTROPIC .and. is_ok) call check_definite(reader, c, material)
  end subroutine read_elastic


  !> Reports E and nu out of bounds.
  subroutine check_isotropic(reader, c, constants)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    real(DP), intent(in) :: constants(2)
    integer :: line
    line = reader%cards%cards(c)%line
    if (constants(1) <= 0) call report_error(reader, line, 'Young''s modulus must be positive.')
    if (constants(2) <= -1 .or. constants(2) >= 0.5_DP) call report_error(reader, line, &
      'Poisson''s ratio must be greater than -1 and less than 0.5; what hardly changes its volume has 0.49 or 0.4999, ' // &
      'in elements that do not lock (see Elements in the manual).')
  end subroutine check_isotropic


  !> Engineering constants to the nine D. Reference: the inverse of the compliance 1/E_i, -nu_ij/E_i.
  subroutine convert_constants(reader, c, x, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    real(DP), intent(inout) :: x(9)              !< in: E1 E2 E3 nu12 nu13 nu23 G12 G13 G23; out: D1111 D1122 ...
    logical, intent(inout) :: is_ok
    real(DP) :: e(3), n12, n13, n23, n21, n31, n32, d
    e = x(:3)
    if (any(e <= 0) .or. any(x(7:9) <= 0)) then
      call report_error(reader, reader%cards%cards(c)%line, 'Young''s and shear moduli must be positive.')
      is_ok = .false.
      return
    end if
    n12 = x(4)
    n13 = x(5)
    n23 = x(6)
    n21 = n12 * e(2) / e(1)
    n31 = n13 * e(3) / e(1)
    n32 = n23 * e(3) / e(2)
    d = 1 - n12 * n21 - n23 * n32 - n13 * n31 - 2 * n21 * n32 * n13
    if (.not. d > 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'These Poisson''s ratios give an elasticity that is not ' // &
        'positive.')
      is_ok = .false.
      return
    end if
    x(1) = e(1) * (1 - n23 * n32) / d
    x(2) = e(1) * (n21 + n31 * n23) / d
    x(3) = e(2) * (1 - n13 * n31) / d
    x(4) = e(1) * (n31 + n21 * n32) / d
    x(5) = e(2) * (n32 + n12 * n31) / d
    x(6) = e(3) * (1 - n12 * n21) / d
  end subroutine convert_constants


  !> Reports an elasticity matrix that is not positive definite, by Cholesky's factors.
  subroutine check_definite(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(material_type), intent(in) :: material
    real(DP) :: A(6, 6)
    integer :: t, i, j, k
    do t = 1, size(material%elastic%temperature)
      A = 0
      k = 0
      do j = 1, 6
        do i = 1, j
          if (material%elastic_kind == ELASTIC_ORTHOTROPIC .and. j > 3 .and. i < j) cycle
          k = k + 1
          A(i, j) = material%elastic%value(k, t)
          A(j, i) = A(i, j)
        end do
      end do
      do k = 1, 6
        if (.not. A(k, k) > 0) then
          call report_error(reader, reader%cards%cards(c)%line, 'The elasticity is not positive definite: it would ' // &
            'give energy away. Check the order of the constants.')
          return
        end if
        do j = k + 1, 6
          A(k + 1:, j) = A(k + 1:, j) - A(k + 1:, k) * (A(k, j) / A(k, k))
        end do
      end do
    end do
  end subroutine check_definite


  !> Whether CalculiX has a law of its own for a name.
  pure logical function is_law_by_name(name)
    character(*), intent(in) :: name
    is_law_by_name = law_of_name(name, LAW_NAMES) > 0
  end function is_law_by_name


  !> The first of some laws by whose name that of a material begins; 0: none.
  pure integer function law_of_name(name, laws) result(k)
    character(*), intent(in) :: name             !< of the material
    character(*), intent(in) :: laws(:)          !< their names
    do k = 1, size(laws)
      if (index(upper_case(name), trim(laws(k))) == 1) return
    end do
    k = 0
  end function law_of_name


  !> USER MATERIAL of such a name.
  subroutine read_law_by_name(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: n, i, status
    logical :: is_ok
    if (material%has_elastic) call report_error(reader, reader%cards%cards(c)%line, 'The material ''' // material%name &
      // ''' has a law of stress before this card; give one.')
    material%has_elastic = .true.                ! errors of the card are reported below
    material%elastic_kind = LAW_KINDS(law_of_name(material%name, LAW_NAMES))
    n = 2
    if (material%elastic_kind == ELASTIC_FIBRES) then
      call open_card(reader, c, parameters, row)
      call parse_integer(parameter_text(parameters, 'CONSTANTS'), n, status)
      if (status /= NUMBER_OK .or. .not. any(n == [(2 + N_FIBRE_CONSTANTS * i, i=1, MAX_FIBRES)])) then
        call report_error(reader, reader%cards%cards(c)%line, 'CONSTANTS must be 6, 10, 14 or 18 for a material ''' // &
          material%name // ''': C1, D1, and two components of the direction, k1, k2 of each of 1 to 4 fibres.')
        return
      end if
    end if
    call read_table(reader, c, n, material%elastic, is_ok)
    if (.not. is_ok) return
    do i = 1, size(material%elastic%temperature)
      call check_constants(reader, c, material, material%elastic%value(:, i))
    end do
    if (material%elastic_kind /= ELASTIC_ISOTROPIC) return
    material%youngs_modulus = material%elastic%value(1, 1)
    material%poissons_ratio = material%elastic%value(2, 1)
  end subroutine read_law_by_name


  !> Reports constants of a law by name out of bounds.
  subroutine check_constants(reader, c, material, constants)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(in) :: material
    real(DP), intent(inout) :: constants(:)      !< D1 that is hardly there is set
    integer :: line, i
    line = reader%cards%cards(c)%line
    if (is_one_sided(material)) then
      if (.not. all(constants > 0)) call report_error(reader, line, 'The material ''' // material%name // ''' needs a ' // &
        'positive Young''s modulus and a positive largest stress of the side that does not carry.')
    else if (material%elastic_kind /= ELASTIC_FIBRES) then
      call check_isotropic(reader, c, constants(:2))
    else
      if (.not. constants(1) > 0 .or. constants(2) < 0) call report_error(reader, line, 'The material ''' // material%name // &
        ''' needs a positive C1 and a D1 of 0 or more.')
      if (constants(2) < MIN_COMPRESSIBILITY .and. constants(1) > 0) constants(2) = 1 / (20 * constants(1))
      do i = 3, size(constants), N_FIBRE_CONSTANTS
        if (constants(i)**2 + constants(i + 1)**2 > 1) call report_error(reader, line, 'The direction of fibre ' // &
          to_text((i + 1) / N_FIBRE_CONSTANTS) // ' is longer than 1: give two components of a unit vector.')
        if (any(constants(i + 2:i + 3) < 0)) call report_error(reader, line, 'k1 and k2 of fibre ' // &
          to_text((i + 1) / N_FIBRE_CONSTANTS) // ' must not be negative.')
      end do
    end if
  end subroutine check_constants

end module amontons_deck_elasticity
