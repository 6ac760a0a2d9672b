!> Unit test of amontons_crystal_plasticity: the law of each system at the result, the tangent by differences, turned crystals, and
!! the elastic range.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_crystal_plasticity
  use amontons_kinds, only: DP
  use amontons_crystal_plasticity, only: crystal_return_type, map_crystal_return, expand_creep_constants, N_SYSTEMS, &
    N_CRYSTAL_STATE, N_CRYSTAL_CREEP_STATE
  use amontons_logarithmic_strain, only: voigt_transformation
  use amontons_materials, only: INELASTIC_CRYSTAL, INELASTIC_CRYSTAL_CREEP
  use amontons_plasticity, only: RETURN_OK
  use amontons_tensor, only: IDENTITY, double_dot, pack_voigt, rotation_matrix
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  ! K, n, c, d, phi, delta, r0, Q, b of octahedral and of cubic slip [MPa, s]
  real(DP), parameter :: CONSTANTS(18) = [300.0_DP, 6.0_DP, 5.0e4_DP, 700.0_DP, 0.6_DP, 20.0_DP, 80.0_DP, 40.0_DP, 15.0_DP, &
    450.0_DP, 4.0_DP, 2.0e4_DP, 300.0_DP, 1.0_DP, 0.0_DP, 60.0_DP, -15.0_DP, 8.0_DP]
  real(DP), parameter :: CREEP(4) = [1500.0_DP, 5.0_DP, 1700.0_DP, 4.0_DP]
  real(DP), parameter :: STRAINS(6, 5) = reshape([0.0_DP, 0.0_DP, 0.012_DP, 0.0_DP, 0.0_DP, 0.0_DP, &
    0.01_DP, -0.006_DP, -0.003_DP, 0.004_DP, -0.007_DP, 0.002_DP, &
    0.0_DP, 0.0_DP, 0.0_DP, 0.02_DP, 0.0_DP, 0.0_DP, &
    -0.02_DP, 0.03_DP, -0.01_DP, -0.04_DP, 0.01_DP, 0.05_DP, &
    0.002_DP, 0.001_DP, 0.0_DP, 0.0015_DP, 0.0_DP, 0.0005_DP], [6, 5])
  real(DP) :: turned(3, 3), dR(3, 3, 3)
  integer :: i
  call rotation_matrix([0.4_DP, -0.3_DP, 0.7_DP], turned, dR)
  do i = 1, 5
    call check_law(INELASTIC_CRYSTAL, IDENTITY, STRAINS(:, i))
    call check_law(INELASTIC_CRYSTAL, turned, STRAINS(:, i))
    call check_law(INELASTIC_CRYSTAL_CREEP, turned, STRAINS(:, i))
  end do
  call check_turned(STRAINS(:, 2))
  call check_elastic()
  call check_steady()
  call suite%finish()

contains

  !> The elasticity of a nickel alloy in turned axes.
  function elasticity(frame) result(C)
    real(DP), intent(in) :: frame(3, 3)
    real(DP) :: C(6, 6), Q(6, 6)
    integer :: k
    C = 0
    C(:3, :3) = 130.0e3_DP
    do k = 1, 3
      C(k, k) = 210.0e3_DP
      C(k + 3, k + 3) = 100.0e3_DP
    end do
    Q = voigt_transformation(frame)
    C = matmul(Q, matmul(C, transpose(Q)))
  end function elasticity


  !> An increment from a state.
  subroutine advance(law, frame, e, dt, state, response)
    integer, intent(in) :: law
    real(DP), intent(in) :: frame(3, 3), e(6), dt
    real(DP), intent(inout) :: state(:)
    type(crystal_return_type), intent(out) :: response
    integer :: status
    if (law == INELASTIC_CRYSTAL) then
      call map_crystal_return(law, CONSTANTS, elasticity(frame), frame, e, dt, state, response, status)
    else
      call map_crystal_return(law, expand_creep_constants(CREEP), elasticity(frame), frame, e, dt, state, response, status)
    end if
    call suite%that('it converges', status == RETURN_OK)
  end subroutine advance


  !> Two increments: the law at their ends, and the tangent of the second by differences.
  subroutine check_law(law, frame, e)
    integer, intent(in) :: law
    real(DP), intent(in) :: frame(3, 3), e(6)
    real(DP), parameter :: DT = 0.3_DP, STEP = 1.0e-8_DP
    type(crystal_return_type) :: first, second, plus, minus
    real(DP), allocatable :: start(:), before(:), after(:), other(:)
    real(DP) :: engineering(6), de(6)
    integer :: k
    allocate (start(merge(N_CRYSTAL_STATE, N_CRYSTAL_CREEP_STATE, law == INELASTIC_CRYSTAL)), source=0.0_DP)
    before = start
    call advance(law, frame, 0.6_DP * e, DT, before, first)
    call check_systems(law, frame, DT, start, before, first)
    engineering = first%flow
    engineering(4:) = 2 * engineering(4:)
    after = before
    call advance(law, frame, e - engineering, 2 * DT, after, second)
    call check_systems(law, frame, 2 * DT, before, after, second)
    do k = 1, 6
      de = 0
      de(k) = STEP
      other = before
      call advance(law, frame, e - engineering + de, 2 * DT, other, plus)
      other = before
      call advance(law, frame, e - engineering - de, 2 * DT, other, minus)
      call suite%near('tangent', norm2(second%tangent(:, k) - (plus%stress - minus%stress) / (2 * STEP)), 0.0_DP, &
        1.0e-5_DP * norm2(second%tangent))
    end do
  end subroutine check_law


  !> The law of each system from the stress and the change of its state alone.
  subroutine check_systems(law, frame, dt, before, after, response)
    integer, intent(in) :: law
    real(DP), intent(in) :: frame(3, 3), dt, before(:), after(:)
    type(crystal_return_type), intent(in) :: response
    real(DP) :: slip(N_SYSTEMS), back(N_SYSTEMS), limit(N_SYSTEMS), viscous, tau, m(6), flow(6), x(9), hardening, excess
    integer :: i, first, last
    back = 0
    limit = 0
    if (law == INELASTIC_CRYSTAL) then
      limit = -after(7:24)
      back = after(25:42)
      slip = after(43:60) - before(43:60)
    else
      slip = after(7:24) - before(7:24)
    end if
    flow = 0
    do i = 1, N_SYSTEMS
      first = merge(1, 13, i <= 12)
      last = merge(12, 18, i <= 12)
      x = [CREEP(merge(1, 3, i <= 12):merge(2, 4, i <= 12)), 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]
      if (law == INELASTIC_CRYSTAL) x = CONSTANTS(merge(1, 10, i <= 12):merge(9, 18, i <= 12))
      m = pack_voigt(matmul(frame, matmul(system(i), transpose(frame))))
      tau = double_dot(m, response%stress) + back(i)
      hardening = limit(i) - 0.1_DP * (sum(limit(first:last)) - limit(i))
      viscous = x(1) * (slip(i) / dt)**(1 / x(2))
      excess = abs(tau) - x(7) - hardening
      call suite%near('overstress', max(excess, 0.0_DP), viscous, 1.0e-7_DP * norm2(response%stress))
      flow = flow + sign(slip(i), tau) * m
      if (law /= INELASTIC_CRYSTAL) cycle
      call suite%near('limit', limit(i), (-before(6 + i) + x(9) * x(8) * slip(i)) / (1 + x(9) * slip(i)), 1.0e-9_DP)
      call suite%near('back stress', back(i) * (1 + x(4) * slip(i)), before(24 + i) - x(3) * (x(5) + (1 - x(5)) * &
        exp(-x(6) * after(42 + i))) * sign(slip(i), tau), 1.0e-6_DP)
    end do
    call suite%near('flow', norm2(flow - response%flow), 0.0_DP, 1.0e-12_DP)
    call suite%near('plastic strain', norm2(after(:6) - before(:6) - flow([1, 2, 3, 4, 6, 5])), 0.0_DP, 1.0e-12_DP)
  end subroutine check_systems


  !> The orientation tensor of a system, by its family of planes and directions.
  pure function system(i) result(m)
    integer, intent(in) :: i
    real(DP) :: m(3, 3), n(3), l(3)
    integer, parameter :: PLANES(3, 7) = reshape([1, 1, 1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 7])
    integer, parameter :: LINES(3, 18) = reshape([1, -1, 0, 1, 0, -1, 0, 1, -1, 0, 1, 1, 1, 0, -1, 1, 1, 0, 0, 1, -1, 1, 0, 1, &
      1, 1, 0, 0, 1, 1, 1, 0, 1, 1, -1, 0, 0, 1, 1, 0, 1, -1, 1, 0, 1, 1, 0, -1, 1, 1, 0, 1, -1, 0], [3, 18])
    integer :: a, b
    n = real(PLANES(:, merge((i + 2) / 3, 4 + (i - 11) / 2, i <= 12)), DP)
    l = real(LINES(:, i), DP)
    n = n / norm2(n)
    l = l / norm2(l)
    do a = 1, 3
      do b = 1, 3
        m(a, b) = 0.5_DP * (l(a) * n(b) + l(b) * n(a))
      end do
    end do
  end function system


  !> A turned crystal under a turned strain has the turned stress.
  subroutine check_turned(e)
    real(DP), intent(in) :: e(6)
    type(crystal_return_type) :: plain, there
    real(DP) :: state(N_CRYSTAL_STATE), other(N_CRYSTAL_STATE), Q(6, 6), tensor(6)
    state = 0
    other = 0
    Q = voigt_transformation(turned)
    tensor = [e(:3), 0.5_DP * e(4:)]
    tensor = matmul(Q, tensor)
    call advance(INELASTIC_CRYSTAL, IDENTITY, e, 0.3_DP, state, plain)
    call advance(INELASTIC_CRYSTAL, turned, [tensor(:3), 2 * tensor(4:)], 0.3_DP, other, there)
    call suite%near('turned', norm2(there%stress - matmul(Q, plain%stress)), 0.0_DP, 1.0e-8_DP * norm2(plain%stress))
    call suite%near('the same slip', norm2(state(43:) - other(43:)), 0.0_DP, 1.0e-11_DP)
  end subroutine check_turned


  !> Below the limit nothing flows.
  subroutine check_elastic()
    real(DP), parameter :: E(6) = [0.0_DP, 0.0_DP, 1.0e-3_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    type(crystal_return_type) :: response
    real(DP) :: state(N_CRYSTAL_STATE)
    state = 0
    call advance(INELASTIC_CRYSTAL, IDENTITY, E, 0.3_DP, state, response)
    call suite%that('no flow', all(abs(state) <= 0) .and. response%plastic <= 0)
    call suite%near('elastic', norm2(response%stress - matmul(elasticity(IDENTITY), E)), 0.0_DP, 1.0e-9_DP)
  end subroutine check_elastic


  !> A long increment of creep along [001]: eight octahedral systems slip alike and the rest do not; all deviatoric stress relaxes.
  subroutine check_steady()
    type(crystal_return_type) :: response
    real(DP) :: state(N_CRYSTAL_CREEP_STATE)
    state = 0
    call advance(INELASTIC_CRYSTAL_CREEP, IDENTITY, [0.0_DP, 0.0_DP, 0.01_DP, 0.0_DP, 0.0_DP, 0.0_DP], 1.0e30_DP, state, response)
    call suite%near('slips', maxval(state(7:18)), sqrt(6.0_DP) * 0.01_DP / 12, 1.0e-6_DP)
    call suite%that('eight', count(state(7:) > 1.0e-6_DP) == 8)
    call suite%near('pressure is left', response%stress(3), response%stress(1), 1.0e-2_DP * response%stress(1))
  end subroutine check_steady

end program test_crystal_plasticity
