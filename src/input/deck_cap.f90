!> CAP PLASTICITY and CAP HARDENING to the constants of materials.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_cap
  use amontons_kinds, only: DP, PI
  use amontons_drucker_prager_cap, only: N_CAP_CONSTANTS
  use amontons_deck_property_tables, only: read_table, read_curves
  use amontons_deck_reader, only: reader_type, report_error
  use amontons_materials, only: material_type, property_table_type
  use amontons_text, only: to_text
  implicit none
  private
  public :: read_cap, read_cap_hardening, is_cap_complete

  integer, parameter :: OF_CAP = 0               !< the test of the hardening curve is isotropic compression

contains

  !> CAP PLASTICITY: cohesion, friction angle in degrees, R, initial volumetric plastic strain, alpha, K.
  subroutine read_cap(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(property_table_type) :: table
    real(DP), parameter :: MAX_CAP_FRICTION = 71.5_DP   ! [degree]: tan is 3
    integer, parameter :: N_GIVEN = 6
    logical :: is_ok
    integer :: line
    line = reader%cards%cards(c)%line
    if (allocated(material%cone%value)) call report_error(reader, line, 'The material ''' // material%name // &
      ''' has a law of yield before this card; give one of *DRUCKER PRAGER, *MOHR COULOMB and *CAP PLASTICITY.')
    material%has_cap = .true.
    call read_table(reader, c, N_GIVEN, table, is_ok)
    if (.not. is_ok) return
    associate (d => table%value(1, :), beta => table%value(2, :), R => table%value(3, :), start => table%value(4, :), &
      alpha => table%value(5, :), K => table%value(6, :))
      if (any(d < 0)) call report_error(reader, line, 'The cohesion must not be negative.')
      if (any(beta < 0) .or. any(beta > MAX_CAP_FRICTION)) call report_error(reader, line, &
        'The friction angle must be from 0 to ' // to_text(MAX_CAP_FRICTION) // ' degrees, in the plane of pressure and von ' // &
        'Mises stress.')
      if (any(.not. d + beta > 0)) call report_error(reader, line, 'Cohesion and friction angle must not both be 0.')
      if (any(.not. R > 0)) call report_error(reader, line, 'The cap eccentricity R must be positive.')
      if (any(start < 0)) call report_error(reader, line, 'The initial volumetric plastic strain must not be negative.')
      if (any(alpha < 0) .or. any(alpha >= 1)) call report_error(reader, line, &
        'alpha, the size of the transition surface, must be from 0 to less than 1, and small.')
      if (any(abs(K) > 0 .and. abs(K - 1) > 0)) call report_error(reader, line, 'K must be 1, 0 or blank: a yield stress in ' // &
        'triaxial tension other than that in compression is not supported with a cap. *DRUCKER PRAGER has K.')
      if (any(alpha * (1 / cos(beta * PI / 180) - 1) >= 1)) call report_error(reader, line, &
        'alpha is too large for the friction angle: the transition surface would have no cap.')
    end associate
    material%cone%temperature = table%temperature
    material%cone%variable = table%variable
    material%cone%value = table%value([2, 1, 3, 4, 5], :)
    material%cone%value(1, :) = PI / 180 * material%cone%value(1, :)
  end subroutine read_cap


  !> Whether both cards of a cap are its own.
  pure logical function is_cap_complete(material)
    type(material_type), intent(in) :: material
    is_cap_complete = size(material%cone%value, 1) == N_CAP_CONSTANTS .and. material%cone_hardening == OF_CAP
  end function is_cap_complete


  !> CAP HARDENING: yield stress in isotropic compression over the volumetric plastic strain.
  subroutine read_cap_hardening(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    integer :: i
    material%has_cone_hardening = .true.
    material%has_cap = .true.
    material%cone_hardening = OF_CAP
    call read_curves(reader, c, material%isotropic_hardening)
    do i = 1, size(material%isotropic_hardening)
      associate (stress => material%isotropic_hardening(i)%stress)
        if (any(stress <= 0)) call report_error(reader, reader%cards%cards(c)%line, &
          'The yield stress in isotropic compression must be positive.')
        if (any(stress(2:) < stress(:size(stress) - 1))) call report_error(reader, reader%cards%cards(c)%line, &
          'The yield stress in isotropic compression must not decrease with the volumetric plastic strain.')
      end associate
    end do
  end subroutine read_cap_hardening

end module amontons_deck_cap
