!> Unit test of amontons_plasticity: closed forms of the return with linear hardening, of creep and of Ramberg and Osgood's law.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_plasticity
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, property_table_type, hardening_curve_type, LAW_SAINT_VENANT, &
    CREEP_TIME_HARDENING, CREEP_STRAIN_HARDENING, RATE_POWER, RATE_RATIO, HISTORY_PEEQ, HISTORY_CEEQ, MAX_HISTORY
  use amontons_plasticity, only: return_mapping_type, anisotropic_return_type, map_radial_return, return_to_curve, &
    map_anisotropic_return, is_inelastic, evaluate_ramberg_osgood, RETURN_OK, RETURN_FAILED
  use amontons_elasticity, only: isotropic_tangent
  use amontons_tensor, only: von_mises
  use check, only: suite_type
  implicit none
  real(DP), parameter :: G = 80000.0_DP, Y0 = 240.0_DP, H_ISO = 1000.0_DP, H_KIN = 3000.0_DP
  real(DP) :: elapsed = 2.0_DP                     !< length of the increment that rates count by [time]
  type(suite_type) :: suite
  call check_linear_hardening()
  call check_segments()
  call check_softening()
  call check_creep()
  call check_creep_hardening()
  call check_creep_and_yield()
  call check_ramberg_osgood()
  call check_anisotropic()
  call check_anisotropic_creep()
  call check_rates()
  call check_power_law()
  call check_anisotropic_rates()
  call suite%finish()

contains

  !> A material with linear hardening: isotropic, kinematic or both.
  function metal(is_isotropic, is_kinematic) result(material)
    logical, intent(in) :: is_isotropic, is_kinematic
    type(material_type) :: material
    if (is_isotropic) then
      allocate (material%isotropic_hardening(1))
      material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 1.0_DP], [Y0, Y0 + H_ISO])
    end if
    if (is_kinematic) then
      allocate (material%kinematic_hardening(1))
      material%kinematic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 1.0_DP], [Y0, Y0 + H_KIN])
    end if
  end function metal


  !> Adds a creep law A q^n t^m.
  subroutine add_creep(material, law, constants)
    type(material_type), intent(inout) :: material
    integer, intent(in) :: law
    real(DP), intent(in) :: constants(3)           !< A, n, m
    material%creep_law = law
    material%creep = property_table_type([0.0_DP], reshape(constants, [3, 1]))
  end subroutine add_creep


  !> The return at 0 degrees, from time 1 to 3. LAW_SAINT_VENANT: time hardening at the end of the increment.
  function solve(material, q_trial, p_old, c_old) result(solution)
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: q_trial, p_old, c_old
    type(return_mapping_type) :: solution
    real(DP) :: history(MAX_HISTORY)
    integer :: status
    history = 0
    history(HISTORY_PEEQ) = p_old
    history(HISTORY_CEEQ) = c_old
    call map_radial_return(material, G, q_trial, 0.0_DP, [3.0_DP, 2.0_DP, merge(3.0_DP, 1.0_DP, material%law == &
      LAW_SAINT_VENANT), elapsed], history, solution, status)
    call suite%that('the return succeeds', status == RETURN_OK)
  end function solve


  !> The closed form over the segments of a curve is the root that the search finds with the same curve at two temperatures; a
  !! segment whose slope is below -3 G has none.
  subroutine check_segments()
    type(material_type) :: closed, searched
    type(return_mapping_type) :: a, b
    real(DP) :: q
    integer :: i, j, status
    real(DP), parameter :: P_OLD(4) = [0.0_DP, 0.005_DP, 0.01_DP, 0.5_DP]
    allocate (closed%isotropic_hardening(1))
    closed%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 0.002_DP, 0.01_DP, 0.05_DP], [Y0, 400.0_DP, 380.0_DP, &
      500.0_DP])
    searched%isotropic_hardening = [closed%isotropic_hardening, closed%isotropic_hardening]
    searched%isotropic_hardening(2)%temperature = 100
    do j = 1, size(P_OLD)
      do i = 1, 12
        q = 200.0_DP * 1.5_DP**i                   ! from elastic to over all segments
        a = solve(closed, q, P_OLD(j), 0.0_DP)
        b = solve(searched, q, P_OLD(j), 0.0_DP)
        call suite%near('segments: dp', a%plastic, b%plastic, 1.0e-14_DP)
        call suite%near('segments: flow', a%flow, b%flow, 1.0e-14_DP)
        call suite%near('segments: theta', a%ratio, b%ratio, 1.0e-11_DP)
        call suite%near('segments: kappa', a%slope, b%slope, 1.0e-12_DP)
      end do
    end do
    call return_to_curve(hardening_curve_type(0.0_DP, [0.0_DP, 0.001_DP, 1.0_DP], [Y0, 1.0_DP, 2.0_DP]), 1000.0_DP, 300.0_DP, &
      0.0_DP, a, status)
    call suite%that('too much softening', status == RETURN_FAILED)
  end subroutine check_segments


  !> dp = (q - y)/(3 G + h), with the hardening that counts, from a committed plastic strain on.
  subroutine check_linear_hardening()
    type(return_mapping_type) :: s
    real(DP) :: dp_exact
    real(DP), parameter :: Q = 600.0_DP, P = 0.02_DP
    call suite%that('elastic', .not. is_inelastic(material_type()))
    call suite%that('inelastic', is_inelastic(metal(.true., .false.)) .and. is_inelastic(metal(.false., .true.)))
    s = solve(metal(.true., .false.), Y0, 0.0_DP, 0.0_DP)
    call suite%that('on the yield surface nothing flows', s%plastic == 0 .and. s%ratio == 1 .and. s%slope == 1)
    s = solve(metal(.true., .false.), Q, P, 0.0_DP)
    dp_exact = (Q - Y0 - H_ISO * P) / (3 * G + H_ISO)
    call suite%near('isotropic: dp', s%plastic, dp_exact, 1.0e-14_DP)
    call suite%near('isotropic: theta', s%ratio, 1 - 3 * G * dp_exact / Q, 1.0e-11_DP)
    call suite%near('isotropic: kappa', s%slope, H_ISO / (3 * G + H_ISO), 1.0e-12_DP)
    call suite%near('isotropic: no back stress', s%back_increment, 0.0_DP, 0.0_DP)
    s = solve(metal(.false., .true.), Q, P, 0.0_DP)
    dp_exact = (Q - Y0) / (3 * G + H_KIN)
    call suite%near('kinematic: dp', s%plastic, dp_exact, 1.0e-14_DP)
    call suite%near('kinematic: back stress', s%back_increment, H_KIN * dp_exact, 1.0e-9_DP)
    s = solve(metal(.true., .true.), Q, P, 0.0_DP)
    dp_exact = (Q - Y0 - H_ISO * P) / (3 * G + H_ISO + H_KIN)
    call suite%near('combined: dp', s%plastic, dp_exact, 1.0e-14_DP)
    call suite%near('combined: kappa', s%slope, (H_ISO + H_KIN) / (3 * G + H_ISO + H_KIN), 1.0e-12_DP)
  end subroutine check_linear_hardening


  !> A yield stress that falls faster than 3 G has no solution; one that falls more slowly has.
  subroutine check_softening()
    type(material_type) :: material
    type(return_mapping_type) :: s
    integer :: status
    real(DP) :: history(MAX_HISTORY)
    history = 0
    material = metal(.true., .false.)
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 1.0e-3_DP], [Y0, Y0 - 3.1_DP * G * 1.0e-3_DP])
    call map_radial_return(material, G, 2 * Y0, 0.0_DP, [1.0_DP, 1.0_DP, 0.0_DP, 1.0_DP], history, s, status)
    call suite%that('softening below -3 G fails', status /= RETURN_OK)
    material%isotropic_hardening(1) = hardening_curve_type(0.0_DP, [0.0_DP, 2.0e-3_DP], [Y0, Y0 - G * 2.0e-3_DP])
    s = solve(material, Y0 + 100, 0.0_DP, 0.0_DP)
    call suite%near('softening by -G: dp', s%plastic, 100 / (2 * G), 1.0e-14_DP)
    call suite%near('softening by -G: kappa', s%slope, -0.5_DP, 1.0e-12_DP)
  end subroutine check_softening


  !> n = 1: c = dt A q/(1 + 3 G dt A); any n: the implicit equation holds and the slope is that of differences.
  subroutine check_creep()
    type(material_type) :: material
    type(return_mapping_type) :: s, plus, minus
    real(DP), parameter :: Q = 100.0_DP, DT = 2.0_DP, A = 1.0e-5_DP, STEP = 1.0e-3_DP
    call add_creep(material, CREEP_TIME_HARDENING, [A, 1.0_DP, 0.0_DP])
    call suite%that('creep is inelastic', is_inelastic(material))
    s = solve(material, Q, 0.0_DP, 0.0_DP)
    call suite%near('n = 1: dc', s%creep, DT * A * Q / (1 + 3 * G * DT * A), 1.0e-15_DP)
    call suite%near('n = 1: theta', s%ratio, 1 / (1 + 3 * G * DT * A), 1.0e-12_DP)
    call suite%near('n = 1: kappa', s%slope, 1 / (1 + 3 * G * DT * A), 1.0e-12_DP)
    call add_creep(material, CREEP_TIME_HARDENING, [1.0e-12_DP, 4.5_DP, 0.0_DP])
    s = solve(material, Q, 0.0_DP, 0.0_DP)
    call suite%near('n = 4.5: implicit rate', s%creep, DT * 1.0e-12_DP * (Q - 3 * G * s%creep)**4.5_DP, 1.0e-15_DP)
    plus = solve(material, Q + STEP, 0.0_DP, 0.0_DP)
    minus = solve(material, Q - STEP, 0.0_DP, 0.0_DP)
    call suite%near('n = 4.5: kappa', s%slope, 1 - 3 * G * (plus%creep - minus%creep) / (2 * STEP), 1.0e-7_DP)
    call suite%that('it creeps much', s%ratio < 0.9_DP .and. s%plastic == 0)
  end subroutine check_creep


  !> Time hardening integrates t^m over the increment, or takes its end; strain hardening starts from the committed strain.
  subroutine check_creep_hardening()
    type(material_type) :: material
    type(return_mapping_type) :: s
    real(DP) :: q, c_at_1, c_at_3
    real(DP), parameter :: A = 1.0e-12_DP, M = -0.5_DP
    call add_creep(material, CREEP_TIME_HARDENING, [A, 3.0_DP, M])
    s = solve(material, 100.0_DP, 0.0_DP, 0.0_DP)
    q = 100 - 3 * G * s%creep
    call suite%near('time hardening: integral from 1 to 3', s%creep, A * q**3 * 2 * (sqrt(3.0_DP) - 1), 1.0e-18_DP)
    material%law = LAW_SAINT_VENANT
    s = solve(material, 100.0_DP, 0.0_DP, 0.0_DP)
    q = 100 - 3 * G * s%creep
    call suite%near('the rate at the end', s%creep, 2 * A * q**3 / sqrt(3.0_DP), 1.0e-18_DP)
    call add_creep(material, CREEP_STRAIN_HARDENING, [A, 3.0_DP, M])
    c_at_1 = 2 * A * 80.0_DP**3
    c_at_3 = c_at_1 * sqrt(3.0_DP)
    s = solve(material, 80 + 3 * G * (c_at_3 - c_at_1), 0.0_DP, c_at_1)
    call suite%near('strain hardening at a stress of 80', s%creep, c_at_3 - c_at_1, 1.0e-17_DP)
  end subroutine check_creep_hardening


  !> Both at once: the yield condition and the creep rate hold, and kappa is that of differences.
  subroutine check_creep_and_yield()
    type(material_type) :: material
    type(return_mapping_type) :: s, plus, minus
    real(DP) :: yield
    real(DP), parameter :: Q = 500.0_DP, STEP = 1.0e-3_DP
    material = metal(.true., .true.)
    call add_creep(material, CREEP_TIME_HARDENING, [1.0e-13_DP, 4.0_DP, 0.0_DP])
    s = solve(material, Q, 0.0_DP, 0.0_DP)
    yield = Y0 + H_ISO * s%plastic
    call suite%that('both flow', s%plastic > 1.0e-5_DP .and. s%creep > 1.0e-5_DP)
    call suite%near('on the yield surface', Q - 3 * G * (s%plastic + s%creep) - s%back_increment, yield, 1.0e-8_DP)
    call suite%near('creep at the yield stress', s%creep, 2 * 1.0e-13_DP * yield**4, 1.0e-15_DP)
    plus = solve(material, Q + STEP, 0.0_DP, 0.0_DP)
    minus = solve(material, Q - STEP, 0.0_DP, 0.0_DP)
    call suite%near('kappa', s%slope, 1 - 3 * G * (plus%plastic + plus%creep - minus%plastic - minus%creep) / (2 * STEP), &
      1.0e-6_DP)
    call suite%near('theta', s%ratio, 1 - 3 * G * (s%plastic + s%creep) / Q, 1.0e-13_DP)
  end subroutine check_creep_and_yield


  !> From a stress to its strain and back.
  subroutine check_ramberg_osgood()
    real(DP), parameter :: CONSTANTS(5) = [210000.0_DP, 0.3_DP, 300.0_DP, 8.0_DP, 0.4_DP]
    real(DP), parameter :: Q(3) = [1.0_DP, 300.0_DP, 900.0_DP]
    real(DP) :: strain, plastic, ratio, slope
    integer :: i, status
    do i = 1, 3
      plastic = 0.4_DP * Q(i) / 210000 * (Q(i) / 300)**7
      strain = Q(i) / (3 * G) + plastic
      call evaluate_ramberg_osgood(CONSTANTS, G, strain, ratio, slope, status)
      call suite%that('Ramberg-Osgood: solved', status == RETURN_OK)
      call suite%near('Ramberg-Osgood: stress', ratio * 3 * G * strain, Q(i), 1.0e-10_DP * Q(i))
      call suite%near('Ramberg-Osgood: slope', slope, 1 / (1 + 3 * G * 8 * plastic / Q(i)), 1.0e-10_DP)
    end do
    call evaluate_ramberg_osgood(CONSTANTS, G, 0.0_DP, ratio, slope, status)
    call suite%that('Ramberg-Osgood: at rest', status == RETURN_OK .and. ratio == 1 .and. slope == 1)
  end subroutine check_ramberg_osgood


  !> With isotropic elasticity it is the radial return; the tangent is that of differences, also for a cubic crystal.
  subroutine check_anisotropic()
    type(material_type) :: material
    type(anisotropic_return_type) :: s, plus, minus
    real(DP) :: C(6, 6), e(6), de(6), q_trial, history(MAX_HISTORY)
    integer :: status, k, crystal
    real(DP), parameter :: STEP = 1.0e-7_DP
    material = metal(.true., .false.)
    history = 0
    history(HISTORY_PEEQ) = 0.01_DP
    C = isotropic_tangent(120000.0_DP, G)
    e = [0.004_DP, -0.001_DP, 0.0005_DP, 0.003_DP, -0.001_DP, 0.002_DP]
    q_trial = von_mises(matmul(C, e))
    call map_anisotropic_return(material, C, e, 0.0_DP, [1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP], history, s, status)
    call suite%near('anisotropic: dp', s%plastic, (q_trial - Y0 - 0.01_DP * H_ISO) / (3 * G + H_ISO), 1.0e-13_DP)
    call suite%near('anisotropic: pressure', sum(s%stress(:3)), sum(matmul(C(:3, :), e)), 1.0e-8_DP)
    call suite%near('anisotropic: q', von_mises(s%stress), Y0 + H_ISO * (0.01_DP + s%plastic), 1.0e-8_DP)
    call suite%near('anisotropic: the flow is a deviator', sum(s%flow(:3)), 0.0_DP, 1.0e-14_DP)
    do crystal = 1, 2
      if (crystal == 2) C(4, 4) = 2.5_DP * C(4, 4)
      call map_anisotropic_return(material, C, e, 0.0_DP, [1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP], history, s, status)
      call suite%near('stress = C (e - dp n)', norm2(s%stress - matmul(C, e - s%plastic * s%flow)), 0.0_DP, 1.0e-8_DP)
      do k = 1, 6
        de = 0
        de(k) = STEP
        call map_anisotropic_return(material, C, e + de, 0.0_DP, [1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP], history, plus, status)
        call map_anisotropic_return(material, C, e - de, 0.0_DP, [1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP], history, minus, status)
        call suite%near('anisotropic: tangent', norm2(s%tangent(:, k) - (plus%stress - minus%stress) / (2 * STEP)), 0.0_DP, &
          1.0e-6_DP * norm2(C))
      end do
    end do
    call map_anisotropic_return(material, C, 0.01_DP * e, 0.0_DP, [1.0_DP, 0.0_DP, 1.0_DP, 1.0_DP], 0 * history, s, status)
    call suite%that('anisotropic: elastic', status == RETURN_OK .and. s%plastic == 0 .and. all(s%tangent == C))
  end subroutine check_anisotropic


  !> Creep with anisotropic elasticity, alone and with yielding: the radial return where C is isotropic, rate and yield condition
  !! for a cubic crystal, and the tangent by differences.
  subroutine check_anisotropic_creep()
    type(material_type) :: material
    type(return_mapping_type) :: radial
    type(anisotropic_return_type) :: s, plus, minus
    real(DP) :: C(6, 6), e(6), de(6), history(MAX_HISTORY)
    integer :: status, k, crystal, law, yields
    real(DP), parameter :: STEP = 1.0e-7_DP, TIMES(4) = [3.0_DP, 2.0_DP, 1.0_DP, 2.0_DP]
    e = [0.004_DP, -0.001_DP, 0.0005_DP, 0.003_DP, -0.001_DP, 0.002_DP]
    history = 0
    history(HISTORY_CEEQ) = 2.0e-4_DP
    do law = CREEP_TIME_HARDENING, CREEP_STRAIN_HARDENING
      do yields = 0, 1
        material = metal(yields == 1, .false.)
        call add_creep(material, law, [1.0e-13_DP, 4.0_DP, -0.4_DP])
        C = isotropic_tangent(120000.0_DP, G)
        radial = solve(material, von_mises(matmul(C, e)), 0.0_DP, history(HISTORY_CEEQ))
        call map_anisotropic_return(material, C, e, 0.0_DP, TIMES, history, s, status)
        call suite%near('anisotropic creep: dp', s%plastic, radial%plastic, 1.0e-13_DP)
        call suite%near('anisotropic creep: dc', s%creep, radial%creep, 1.0e-13_DP)
        call suite%that('anisotropic creep: it flows', s%creep > 1.0e-5_DP .and. (s%plastic > 1.0e-5_DP .eqv. yields == 1))
        do crystal = 1, 2
          if (crystal == 2) C(4, 4) = 2.5_DP * C(4, 4)
          call map_anisotropic_return(material, C, e, 0.0_DP, TIMES, history, s, status)
          call suite%that('anisotropic creep: status', status == RETURN_OK)
          call suite%near('stress = C (e - (dp + dc) n)', norm2(s%stress - matmul(C, e - (s%plastic + s%creep) * s%flow)), 0.0_DP, &
            1.0e-7_DP)
          if (yields == 1) call suite%near('yield', von_mises(s%stress), Y0 + H_ISO * s%plastic, 1.0e-7_DP)
          do k = 1, 6
            de = 0
            de(k) = STEP
            call map_anisotropic_return(material, C, e + de, 0.0_DP, TIMES, history, plus, status)
            call map_anisotropic_return(material, C, e - de, 0.0_DP, TIMES, history, minus, status)
            call suite%near('anisotropic creep: tangent', norm2(s%tangent(:, k) - (plus%stress - minus%stress) / (2 * STEP)), &
              0.0_DP, 1.0e-6_DP * norm2(C))
          end do
        end do
      end do
    end do
  end subroutine check_anisotropic_creep


  !> A metal with linear hardening whose yield stress follows rate = D (ratio - 1)^n.
  function fast_metal(D, n) result(material)
    real(DP), intent(in) :: D, n
    type(material_type) :: material
    material = metal(.true., .false.)
    material%rate_law = RATE_POWER
    material%rate_power = property_table_type([0.0_DP], reshape([D, n], [2, 1]))
  end function fast_metal


  !> Closed forms without hardening: n = 1 is linear in p, n = 2 quadratic in its root; a table is linear in its segment. No flow
  !! without time.
  subroutine check_rates()
    type(material_type) :: material
    type(return_mapping_type) :: s
    real(DP), parameter :: D = 0.01_DP, OVER = 300.0_DP
    real(DP) :: root
    material = fast_metal(D, 1.0_DP)
    material%isotropic_hardening(1)%stress = Y0
    s = solve(material, Y0 + OVER, 0.3_DP, 0.0_DP)
    call suite%near('n = 1: dp', s%plastic, OVER / (3 * G + Y0 / (elapsed * D)), 1.0e-15_DP)
    call suite%near('n = 1: ratio', s%ratio, 1 - 3 * G * s%plastic / (Y0 + OVER), 1.0e-14_DP)
    call suite%near('n = 1: slope', s%slope, 1 - 3 * G / (3 * G + Y0 / (elapsed * D)), 1.0e-13_DP)
    call suite%near('flow', s%flow, s%plastic, 0.0_DP)
    s = solve(material, Y0, 0.3_DP, 0.0_DP)
    call suite%that('at the static yield stress', s%plastic == 0)
    material = fast_metal(D, 2.0_DP)
    material%isotropic_hardening(1)%stress = Y0
    s = solve(material, Y0 + OVER, 0.3_DP, 0.0_DP)
    root = (-Y0 + sqrt(Y0**2 + 4 * OVER * 3 * G * elapsed * D)) / (2 * 3 * G * elapsed * D)   ! of 3 G dt D x^2 + Y0 x = OVER
    call suite%near('n = 2: dp', s%plastic, elapsed * D * root**2, 1.0e-15_DP)
    material = metal(.true., .false.)
    material%isotropic_hardening(1)%stress = Y0
    material%rate_law = RATE_RATIO
    material%rate_ratio = [hardening_curve_type(0.0_DP, [0.0_DP, 1.0_DP], [1.0_DP, 101.0_DP])]
    s = solve(material, Y0 + OVER, 0.3_DP, 0.0_DP)
    call suite%near('table: dp', s%plastic, OVER / (3 * G + 100 * Y0 / elapsed), 1.0e-15_DP)
    elapsed = 0
    s = solve(material, Y0 + OVER, 0.3_DP, 0.0_DP)
    elapsed = 2
    call suite%that('no flow without time', s%plastic == 0 .and. s%slope == 1)
  end subroutine check_rates


  !> The power law from almost rigid to almost static, with exponents from 0.3 to 200 and overstresses from 1e-8 to 1e6: the yield
  !! condition holds to the rounding of the stress, and the slope is that of differences.
  subroutine check_power_law()
    type(return_mapping_type) :: s, plus, minus
    real(DP) :: q, D, n, static, ratio
    real(DP), parameter :: EXPONENTS(6) = [0.3_DP, 1.0_DP, 3.0_DP, 5.0_DP, 20.0_DP, 200.0_DP], STEP = 1.0e-5_DP
    integer :: i, j, k
    do i = 1, size(EXPONENTS)
      n = EXPONENTS(i)
      do j = -12, 12, 3
        D = 10.0_DP**j
        do k = -8, 6, 2
          q = Y0 * (1 + 10.0_DP**k)
          s = solve(fast_metal(D, n), q, 0.0_DP, 0.0_DP)
          static = Y0 + H_ISO * min(s%plastic, 1.0_DP)
          ratio = (q - 3 * G * s%plastic) / static
          call suite%that('stress between static yield and trial', ratio >= 1 - 1.0e-12_DP .and. s%plastic >= 0)
          if (s%plastic > 1.0e-12_DP * q / (3 * G)) call suite%near('rate', static * (1 + (s%plastic / (elapsed * D))**(1 / n)) &
            + 3 * G * s%plastic, q, 1.0e-10_DP * q)
          plus = solve(fast_metal(D, n), q * (1 + STEP * 10.0_DP**k / (1 + 10.0_DP**k)), 0.0_DP, 0.0_DP)
          minus = solve(fast_metal(D, n), q * (1 - STEP * 10.0_DP**k / (1 + 10.0_DP**k)), 0.0_DP, 0.0_DP)
          if (k > -4) call suite%near('slope', s%slope, 1 - 3 * G * (plus%plastic - minus%plastic) / &
            (2 * q * STEP * 10.0_DP**k / (1 + 10.0_DP**k)), 1.0e-5_DP)
        end do
      end do
    end do
  end subroutine check_power_law


  !> A rate law with anisotropic elasticity: the radial return where C is isotropic, the yield condition for a cubic crystal, and
  !! the tangent by differences.
  subroutine check_anisotropic_rates()
    type(material_type) :: material
    type(return_mapping_type) :: radial
    type(anisotropic_return_type) :: s, plus, minus
    real(DP) :: C(6, 6), e(6), de(6), history(MAX_HISTORY)
    integer :: status, k, crystal, i
    real(DP), parameter :: STEP = 1.0e-7_DP, TIMES(4) = [3.0_DP, 0.0_DP, 3.0_DP, 2.0_DP]
    real(DP), parameter :: LAWS(2, 4) = reshape([0.01_DP, 5.0_DP, 1.0e-6_DP, 30.0_DP, 100.0_DP, 1.5_DP, 0.001_DP, 0.5_DP], [2, 4])
    e = [0.004_DP, -0.001_DP, 0.0005_DP, 0.003_DP, -0.001_DP, 0.002_DP]
    history = 0
    do i = 1, size(LAWS, 2)
      material = fast_metal(LAWS(1, i), LAWS(2, i))
      C = isotropic_tangent(120000.0_DP, G)
      radial = solve(material, von_mises(matmul(C, e)), 0.0_DP, 0.0_DP)
      call map_anisotropic_return(material, C, e, 0.0_DP, TIMES, history, s, status)
      call suite%near('anisotropic rate: dp', s%plastic, radial%plastic, 1.0e-13_DP)
      do crystal = 1, 2
        if (crystal == 2) C(4, 4) = 2.5_DP * C(4, 4)
        call map_anisotropic_return(material, C, e, 0.0_DP, TIMES, history, s, status)
        call suite%that('anisotropic rate: status', status == RETURN_OK .and. s%plastic > 0)
        call suite%near('stress = C (e - dp n)', norm2(s%stress - matmul(C, e - s%plastic * s%flow)), 0.0_DP, 1.0e-7_DP)
        call suite%near('yield at the rate', von_mises(s%stress), (Y0 + H_ISO * s%plastic) * &
          (1 + (s%plastic / (TIMES(4) * LAWS(1, i)))**(1 / LAWS(2, i))), 1.0e-7_DP)
        do k = 1, 6
          de = 0
          de(k) = STEP
          call map_anisotropic_return(material, C, e + de, 0.0_DP, TIMES, history, plus, status)
          call map_anisotropic_return(material, C, e - de, 0.0_DP, TIMES, history, minus, status)
          call suite%near('anisotropic rate: tangent', norm2(s%tangent(:, k) - (plus%stress - minus%stress) / (2 * STEP)), &
            0.0_DP, 1.0e-6_DP * norm2(C))
        end do
      end do
    end do
  end subroutine check_anisotropic_rates

end program test_plasticity
