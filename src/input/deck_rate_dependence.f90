!> RATE DEPENDENT and PLASTIC, RATE to the laws of materials whose yield stress depends on the rate of plastic strain.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_rate_dependence
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_property_tables, only: read_table, read_curves
  use amontons_deck_reader, only: reader_type, open_card, report_error
  use amontons_materials, only: material_type, hardening_curve_type, rate_curves_type, evaluate_curves, CREEP_NONE, RATE_NONE, &
    RATE_POWER, RATE_RATIO, RATE_CURVES
  use amontons_model, only: DIALECT_CALCULIX
  use amontons_text, only: to_text, parse_real
  implicit none
  private
  public :: read_rate_dependent, read_isotropic_plastic, complete_rate_dependence

contains

  !> RATE DEPENDENT: D and n, or ratios over rates.
  subroutine read_rate_dependent(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    integer :: line, i
    logical :: is_ok
    line = reader%cards%cards(c)%line
    if (reader%dialect == DIALECT_CALCULIX) call refuse_dialect(reader, line, '*RATE DEPENDENT')
    if (material%rate_law == RATE_POWER .or. material%rate_law == RATE_RATIO) call report_error(reader, line, 'The material ''' // &
      material%name // ''' has *RATE DEPENDENT before this card; give one.')
    call open_card(reader, c, parameters, row)
    if (parameter_word(parameters, 'TYPE', 'POWERLAW') == 'POWERLAW') then
      material%rate_law = RATE_POWER
      call read_table(reader, c, 2, material%rate_power, is_ok)
      if (.not. is_ok) return
      if (any(.not. material%rate_power%value > 0)) call report_error(reader, line, &
        'D and n must be positive: the rate of plastic strain is D (R - 1)^n.')
      return
    end if
    material%rate_law = RATE_RATIO
    call read_curves(reader, c, material%rate_ratio, ['yield stress ratio ', 'plastic strain rate'])
    do i = 1, size(material%rate_ratio)
      associate (ratio => material%rate_ratio(i)%stress)
        if (any(ratio < 1)) call report_error(reader, line, 'The yield stress ratio must be at least 1: it multiplies the ' // &
          'static yield stress of *PLASTIC.')
        if (any(ratio(2:) < ratio(:size(ratio) - 1))) call report_error(reader, line, &
          'The yield stress ratio must not decrease with the rate: the flow would have no unique rate.')
      end associate
    end do
  end subroutine read_rate_dependent


  !> PLASTIC with isotropic hardening: curves, with RATE at their rate; a card without it beside others is of rate 0.
  subroutine read_isotropic_plastic(reader, c, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(material_type), intent(inout) :: material
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    type(hardening_curve_type), allocatable :: curves(:)
    real(DP) :: rate
    integer :: line, status
    line = reader%cards%cards(c)%line
    call open_card(reader, c, parameters, row)
    call read_curves(reader, c, curves)
    rate = 0
    if (has_parameter(parameters, 'RATE')) then
      if (reader%dialect == DIALECT_CALCULIX) call refuse_dialect(reader, line, 'RATE on *PLASTIC')
      call parse_real(parameter_text(parameters, 'RATE'), rate, status)
      if (.not. rate >= 0) call report_error(reader, line, 'RATE must be a rate of the equivalent plastic strain, 0 or more.')
      if (.not. allocated(material%rate_curves)) then
        allocate (material%rate_curves(0))
        if (allocated(material%isotropic_hardening)) material%rate_curves = [rate_curves_type(0.0_DP, material%isotropic_hardening)]
      end if
    end if
    if (size(curves) == 0 .or. .not. allocated(material%rate_curves)) then   ! none: reported
      material%isotropic_hardening = curves
      return
    end if
    if (any(abs(material%rate_curves%rate - rate) <= 0)) call report_error(reader, line, 'The material ''' // material%name // &
      ''' has *PLASTIC of this rate before this card; without RATE it is 0.')
    material%rate_curves = [pack_slower(material%rate_curves, rate), rate_curves_type(rate, curves), &
      pack_faster(material%rate_curves, rate)]
    material%isotropic_hardening = material%rate_curves(1)%curves
  end subroutine read_isotropic_plastic


  !> The curves below a rate.
  pure function pack_slower(all, rate) result(part)
    type(rate_curves_type), intent(in) :: all(:)
    real(DP), intent(in) :: rate                 !< [1/time]
    type(rate_curves_type), allocatable :: part(:)
    part = all(:count(all%rate < rate))
  end function pack_slower


  !> The curves at a rate or above.
  pure function pack_faster(all, rate) result(part)
    type(rate_curves_type), intent(in) :: all(:)
    real(DP), intent(in) :: rate                 !< [1/time]
    type(rate_curves_type), allocatable :: part(:)
    part = all(count(all%rate < rate) + 1:)
  end function pack_faster


  !> Completes the law of the curves of several rates; reports what rates do not go with.
  subroutine complete_rate_dependence(reader, line, material)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    type(material_type), intent(inout) :: material
    character(:), allocatable :: who
    who = 'The material ''' // material%name // ''' '
    if (allocated(material%rate_curves)) then
      if (material%rate_law /= RATE_NONE) call report_error(reader, line, who // 'has both *RATE DEPENDENT and *PLASTIC, ' // &
        'RATE; give one.')
      if (size(material%rate_curves) > 1) material%rate_law = RATE_CURVES
      call check_order(reader, line, who, material%rate_curves)
    end if
    if (material%rate_law == RATE_NONE) return
    if (allocated(material%kinematic_hardening)) then
      call report_error(reader, line, who // 'has kinematic hardening with a yield stress that depends on the rate, which is ' // &
        'not supported; isotropic hardening is.')
    else if (allocated(material%cone%value) .or. material%has_cone_hardening) then
      call report_error(reader, line, who // 'has *RATE DEPENDENT or *PLASTIC, RATE beside *DRUCKER PRAGER, *MOHR COULOMB or ' // &
        '*CAP PLASTICITY, which is not supported; rates count for *PLASTIC alone.')
    else if (.not. allocated(material%isotropic_hardening)) then
      call report_error(reader, line, who // 'has *RATE DEPENDENT but no *PLASTIC, whose static yield stress it multiplies.')
    end if
    if (material%creep_law /= CREEP_NONE) call report_error(reader, line, who // 'has *CREEP beside a yield stress that ' // &
      'depends on the rate, which is not supported; give one of them.')
  end subroutine complete_rate_dependence


  !> Reports curves that are below those of a lower rate. Between the points of both all is bilinear: the points decide.
  subroutine check_order(reader, line, who, rates)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of the MATERIAL card
    character(*), intent(in) :: who
    type(rate_curves_type), intent(in) :: rates(:)   !< ascending
    type(hardening_curve_type) :: points
    real(DP) :: lower, upper, slope
    integer :: i, j, k, m
    do i = 2, size(rates)
      m = size(rates(i)%curves)
      do j = 1, m + size(rates(i - 1)%curves)
        if (j <= m) points = rates(i)%curves(j)
        if (j > m) points = rates(i - 1)%curves(j - m)
        do k = 1, size(points%strain)
          call evaluate_curves(rates(i - 1)%curves, points%temperature, points%strain(k), lower, slope)
          call evaluate_curves(rates(i)%curves, points%temperature, points%strain(k), upper, slope)
          if (upper >= lower .or. rates(i)%rate <= rates(i - 1)%rate) cycle
          call report_error(reader, line, who // 'has at the plastic strain ' // to_text(points%strain(k)) // ' a yield stress ' &
            // 'of ' // to_text(upper) // ' at the rate ' // to_text(rates(i)%rate) // ', and more, ' // to_text(lower) // &
            ', at the lower rate ' // to_text(rates(i - 1)%rate) // '. It must not decrease with the rate: the flow would have ' &
            // 'no unique rate.')
          return
        end do
      end do
    end do
  end subroutine check_order


  !> CalculiX has no such law.
  subroutine refuse_dialect(reader, line, what)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    character(*), intent(in) :: what
    call report_error(reader, line, what // ' is of the abaqus dialect: CalculiX has no yield stress over the rate by a power ' // &
      'law or tables. Take that dialect, or give *CREEP in a *VISCO step.')
  end subroutine refuse_dialect

end module amontons_deck_rate_dependence
