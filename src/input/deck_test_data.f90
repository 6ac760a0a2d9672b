!> UNIAXIAL, BIAXIAL and PLANAR TEST DATA below HYPERELASTIC, TEST DATA INPUT, to constants of rubber.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_test_data
  use amontons_cards, only: data_row_type, parameter_type, next_row
  use amontons_card_schema, only: has_parameter, parameter_text
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, is_card
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, HYPER_POLYNOMIAL
  use amontons_model, only: DIALECT_CALCULIX
  use amontons_rubber_fit, only: rubber_tests_type, fit_rubber, nominal_stress, TEST_UNIAXIAL, TEST_PLANAR
  use amontons_text, only: to_text, parse_real, plural, NUMBER_OK
  implicit none
  private
  public :: fit_hyperelastic, hyperelastic_powers, check_test_place

  character(8), parameter :: TEST_NAMES(3) = [character(8) :: 'UNIAXIAL', 'BIAXIAL', 'PLANAR']   !< in the order of TEST_...

contains

  !> The powers of I1 - 3 and I2 - 3 of the constants of a polynomial: 10, 01, 20, 11, 02, 30, ...
  pure function hyperelastic_powers(order) result(power)
    integer, intent(in) :: order
    integer :: power(2, order * (order + 3) / 2), i, j
    power = reshape([((j - i, i, i=0, j), j=1, order)], shape(power))
  end function hyperelastic_powers


  !> HYPERELASTIC, TEST DATA INPUT: the constants C of a polynomial that fit the test data best, and D1 from POISSON; the rest
  !! is 0. A note says what they are and how well they fit.
  subroutine fit_hyperelastic(reader, c, place, material, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                         !< index of the card HYPERELASTIC
    integer, intent(in) :: place(:)                  !< of the constants that the law has, as in hyperelasticity: C, then D
    type(material_type), intent(inout) :: material   !< with hyper_kind and hyper_order; out: elastic
    logical, intent(out) :: is_ok
    integer :: n
    is_ok = material%hyper_kind == HYPER_POLYNOMIAL
    if (.not. is_ok) call report_error(reader, reader%cards%cards(c)%line, 'Test data give the constants of polynomials (NEO ' // &
      'HOOKE, MOONEY-RIVLIN, YEOH, REDUCED POLYNOMIAL, POLYNOMIAL); those of other laws must be given.')
    if (.not. is_ok) return
    n = material%hyper_order * (material%hyper_order + 3) / 2
    material%elastic%temperature = [0.0_DP]
    allocate (material%elastic%value(n + material%hyper_order, 1))
    call fit_polynomial(reader, c, material%hyper_order, pack(place, place <= n), material%elastic%value(:, 1), is_ok)
  end subroutine fit_hyperelastic


  !> The constants C, and D1.
  subroutine fit_polynomial(reader, c, order, place, constants, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                         !< index of the card HYPERELASTIC
    integer, intent(in) :: order                     !< of the polynomial
    integer, intent(in) :: place(:)                  !< of the constants C that the law has, in the order 10, 01, 20, ...
    real(DP), intent(out) :: constants(:)            !< C, then D1 to D(order) [stress, 1/stress]
    logical, intent(out) :: is_ok
    type(rubber_tests_type) :: tests
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: power(2, order * (order + 3) / 2)
    real(DP) :: fitted(size(place)), deviation
    character(:), allocatable :: list
    integer :: i, line
    line = reader%cards%cards(c)%line
    constants = 0
    call open_card(reader, c, parameters, row)
    if (reader%dialect == DIALECT_CALCULIX) call report_error(reader, line, 'CalculiX has no TEST DATA INPUT: the abaqus ' // &
      'dialect prints the constants.')
    is_ok = reader%dialect /= DIALECT_CALCULIX
    if (next_row(reader%cards, row)) call report_error(reader, row%line, 'With TEST DATA INPUT the data lines are those of ' // &
      '*UNIAXIAL TEST DATA, *BIAXIAL TEST DATA and *PLANAR TEST DATA below this card.')
    call read_tests(reader, c, tests, is_ok)
    if (.not. is_ok) return
    if (size(tests%stress) < size(place)) then
      call report_error(reader, line, plural(size(place), 'constant') // ' cannot be found from ' // plural(size(tests%stress), &
        'point') // ' of tests.')
      is_ok = .false.
      return
    end if
    power = hyperelastic_powers(order)
    call fit_rubber(power(:, place), tests, fitted, deviation, is_ok)
    if (.not. is_ok) then
      call report_error(reader, line, 'The tests do not determine the constants: planar tests alone do not separate C10 and ' // &
        'C01, for example. Give other tests, or a law with fewer constants.')
      return
    end if
    constants(place) = fitted
    list = ''
    do i = 1, size(place)
      list = list // 'C' // to_text(power(1, place(i))) // to_text(power(2, place(i))) // ' = ' // to_text(fitted(i)) // ', '
    end do
    call report_note(reader, line, 'The test data give ' // list // 'with ' // to_text(real(nint(1000 * deviation), DP) / 10) // &
      ' % as the largest error of a stress.')
    call report_decrease(reader, line, power(:, place), fitted, tests)
    call read_poisson(reader, line, parameters, 2 * (constants(1) + constants(2)), constants(order * (order + 3) / 2 + 1), is_ok)
  end subroutine fit_polynomial


  !> TEST_... of a card; 0: another card.
  pure integer function test_kind(reader, c) result(kind)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c
    do kind = 1, size(TEST_NAMES)
      if (is_card(reader, c, trim(TEST_NAMES(kind)) // 'TESTDATA')) return
    end do
    kind = 0
  end function test_kind


  !> Reports test data that no HYPERELASTIC reads.
  subroutine check_test_place(reader, c)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                         !< index of the card with test data
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: i
    do i = c - 1, 1, -1
      if (test_kind(reader, i) == 0) exit
    end do
    if (i > 0) then
      if (is_card(reader, i, 'HYPERELASTIC')) then
        call open_card(reader, i, parameters, row)
        if (has_parameter(parameters, 'TEST DATA INPUT')) return
      end if
    end if
    call report_error(reader, reader%cards%cards(c)%line, 'Test data must be directly below a *HYPERELASTIC with TEST DATA INPUT.')
  end subroutine check_test_place


  !> The points of all test cards below HYPERELASTIC.
  subroutine read_tests(reader, c, tests, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c
    type(rubber_tests_type), intent(out) :: tests
    logical, intent(inout) :: is_ok
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    real(DP) :: stress, strain
    integer :: i, kind
    allocate (tests%kind(0), tests%stretch(0), tests%stress(0))
    do i = c + 1, reader%cards%n_cards
      kind = test_kind(reader, i)
      if (kind == 0) exit
      call open_card(reader, i, parameters, row)
      do while (next_row(reader%cards, row))
        stress = 0
        strain = 0
        call read_real(reader, row, 1, 'the nominal stress', stress, is_ok)
        call read_real(reader, row, 2, 'the nominal strain', strain, is_ok)
        if (.not. is_ok) cycle
        if (strain <= -1 .or. (stress > 0 .neqv. strain > 0) .or. (stress < 0 .neqv. strain < 0)) then
          call report_error(reader, row%line, 'The strain must be above -1, and stress and strain have the same sign.')
          is_ok = .false.
        else if (abs(stress) > 0) then
          tests%kind = [tests%kind, kind]
          tests%stretch = [tests%stretch, 1 + strain]
          tests%stress = [tests%stress, stress]
        end if
      end do
    end do
  end subroutine read_tests


  !> D1 = 2/K from Poisson's ratio; without it 0.
  subroutine read_poisson(reader, line, parameters, G, D1, is_ok)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    type(parameter_type), intent(in) :: parameters(:)
    real(DP), intent(in) :: G                        !< shear modulus at rest [stress]
    real(DP), intent(out) :: D1                      !< [1/stress]
    logical, intent(inout) :: is_ok
    real(DP) :: ratio
    integer :: status
    D1 = 0
    if (.not. has_parameter(parameters, 'POISSON') .or. .not. G > 0) return
    call parse_real(parameter_text(parameters, 'POISSON'), ratio, status)
    if (status /= NUMBER_OK) return                  ! reported with the parameters of the card
    if (ratio <= -1 .or. ratio > 0.5_DP) then
      call report_error(reader, line, 'POISSON must be above -1 and at most 0.5.')
      is_ok = .false.
      return
    end if
    D1 = 3 * (1 - 2 * ratio) / (G * (1 + ratio))
  end subroutine read_poisson


  !> Reports tests in whose range the stress of the fitted law falls with the stretch.
  subroutine report_decrease(reader, line, power, constants, tests)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line, power(:, :)
    real(DP), intent(in) :: constants(:)
    type(rubber_tests_type), intent(in) :: tests
    integer, parameter :: N_STRETCHES = 101
    real(DP) :: stretch(N_STRETCHES), stress(N_STRETCHES), low, high
    integer :: kind, i
    do kind = TEST_UNIAXIAL, TEST_PLANAR
      if (.not. any(tests%kind == kind)) cycle
      low = min(1.0_DP, minval(tests%stretch, mask=tests%kind == kind))
      high = max(1.0_DP, maxval(tests%stretch, mask=tests%kind == kind))
      stretch = [(low + (high - low) * real(i, DP) / (N_STRETCHES - 1), i=0, N_STRETCHES - 1)]
      stress = nominal_stress(power, constants, spread(kind, 1, N_STRETCHES), stretch)
      i = findloc(stress(2:) > stress(:N_STRETCHES - 1), .false., dim=1)
      if (i > 0) call report_note(reader, line, 'The fitted stress falls with the stretch near the strain ' // &
        to_text(stretch(i) - 1) // ' of *' // trim(TEST_NAMES(kind)) // ' TEST DATA: the material is unstable there. Take ' // &
        'fewer constants or other data.')
    end do
  end subroutine report_decrease

end module amontons_deck_test_data
