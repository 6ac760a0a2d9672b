!> Accuracy of creep against CETOL: differences by hand in both dialects, the worst element, DIRECT, and materials without it.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_creep_accuracy
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_failure, only: failure_type, FAILURE_NONE, FAILURE_CREEP
  use amontons_materials, only: HISTORY_CEEQ, MAX_HISTORY, ELASTIC_ORTHOTROPIC
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_deck, only: read_deck_text
  use amontons_state, only: state_type
  use amontons_creep_accuracy, only: check_creep, is_limited_by_cetol
  use samples, only: deck_lines
  use check, only: suite_type
  implicit none
  real(DP), parameter :: A = 1.0e-6_DP, CETOL = 1.0e-5_DP, Q(2) = [100.0_DP, 90.0_DP], CEEQ(2) = [0.01_DP, 0.012_DP]
  type(suite_type) :: suite
  call check_law(DIALECT_ABAQUS, 'TIME', 0.0_DP, 2 * A * (Q(1)**2 - Q(2)**2))
  call check_law(DIALECT_CALCULIX, 'TIME', 0.0_DP, 2 * A * (Q(1)**2 - Q(2)**2))
  ! from time 3 to 5 with t^-1/2: by the same mean of t, and by the two instants
  call check_law(DIALECT_ABAQUS, 'TIME', -0.5_DP, 2 * A * (Q(1)**2 - Q(2)**2) * (sqrt(5.0_DP) - sqrt(3.0_DP)))
  call check_law(DIALECT_CALCULIX, 'TIME', -0.5_DP, 2 * A * (Q(1)**2 / sqrt(3.0_DP) - Q(2)**2 / sqrt(5.0_DP)))
  ! e = 2 A q^2 sqrt(t): integrated over 2 from e = 0.01 on, and by the rates 2 (A q^2)^2/e
  call check_law(DIALECT_ABAQUS, 'STRAIN', -0.5_DP, hardened(Q(1)) - hardened(Q(2)))
  call check_law(DIALECT_CALCULIX, 'STRAIN', -0.5_DP, 2 * (2 * (A * Q(1)**2)**2 / CEEQ(1) - 2 * (A * Q(2)**2)**2 / CEEQ(2)))
  call check_start()
  call check_materials()
  call suite%finish()

contains

  !> Creep of a strain-hardening bar within an increment.
  pure real(DP) function hardened(stress) result(strain)
    real(DP), intent(in) :: stress
    strain = 2 * A * stress**2 * sqrt((CEEQ(1) / (2 * A * stress**2))**2 + 2) - CEEQ(1)
  end function hardened


  !> Two bars, E = 1000, of which the second is at the stresses Q at the ends of an increment, the first at constant stress.
  subroutine make_bars(dialect, law, m, elastic, direct, model, state)
    integer, intent(in) :: dialect
    character(*), intent(in) :: law, elastic, direct
    real(DP), intent(in) :: m
    type(model_type), intent(out) :: model
    type(state_type), intent(out) :: state
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    character(20) :: exponent
    integer :: i
    options%dialect = dialect
    write (exponent, '(f8.3)') m
    call read_deck_text(deck_lines('*NODE;1,0,0,0;2,1,0,0;3,2,0,0;*ELEMENT, TYPE=T3D2, ELSET=E;7,1,2;8,2,3;*MATERIAL, NAME=M;' // &
      '*ELASTIC' // elastic // '*CREEP, LAW=' // law // ';1e-6,2.,' // trim(exponent) // ';*SOLID SECTION, ELSET=E, ' // &
      'MATERIAL=M;1.;*BOUNDARY;1,1,3;2,2,3;3,2,3;*STEP;*VISCO, CETOL=1e-5' // direct // ';.1,10.;*CLOAD;3,1,100.;*END STEP;'), &
      options, model, diagnostics, error)
    call suite%that('read', .not. allocated(error) .and. size(model%steps) == 1)
    call suite%near('CETOL', model%steps(1)%creep_tolerance, CETOL, 0.0_DP)
    associate (old => state%old)
      old%step = 1
      allocate (old%stress(6, model%mesh%n_points), old%history(MAX_HISTORY, model%mesh%n_points), source=0.0_DP)
      allocate (old%temperature(model%mesh%n_nodes), source=0.0_DP)
      old%stress(1, :) = 50
      old%history(HISTORY_CEEQ, :) = CEEQ(1)
      old%creep_time = 3
      old%total_time = 3
    end associate
    state%new = state%old
    state%new%creep_time = 5
    state%new%total_time = 5
    do i = model%mesh%point_first(2), model%mesh%point_first(3) - 1
      state%old%stress(1, i) = Q(1)
      state%new%stress(1, i) = Q(2)
      state%new%history(HISTORY_CEEQ, i) = CEEQ(2)
    end do
  end subroutine make_bars


  !> The difference, that the attempt fails by it, and that one with DIRECT does not.
  subroutine check_law(dialect, law, m, difference)
    integer, intent(in) :: dialect
    character(*), intent(in) :: law
    real(DP), intent(in) :: m
    real(DP), intent(in) :: difference             !< [-]
    type(model_type) :: model
    type(state_type) :: state
    type(failure_type) :: failure
    real(DP) :: ratio
    call make_bars(dialect, law, m, ';1000.,.3;', '', model, state)
    call check_creep(model, model%steps(1), state, ratio, failure)
    call suite%near(law // ': ratio', ratio, difference / CETOL, 1.0e-12_DP * difference / CETOL)
    call suite%that('too long', failure%code == FAILURE_CREEP .and. ratio > 1)
    call suite%that('in element 8', all(failure%labels == 8))
    call suite%near('by the ratio', failure%number, ratio, 0.0_DP)
    call make_bars(dialect, law, m, ';1000.,.3;', ', DIRECT', model, state)
    failure = failure_type()
    call check_creep(model, model%steps(1), state, ratio, failure)
    call suite%that('DIRECT only reports', failure%code == FAILURE_NONE .and. ratio > 1)
    state%new%stress = state%old%stress
    if (dialect == DIALECT_CALCULIX) return
    call check_creep(model, model%steps(1), state, ratio, failure)
    call suite%that('a constant stress has no difference', ratio <= 0)
  end subroutine check_law


  !> At the start of the job: no stress and no creep before, where the rates of m < 0 are unbounded.
  subroutine check_start()
    type(model_type) :: model
    type(state_type) :: state
    type(failure_type) :: failure
    real(DP) :: ratio
    integer :: i
    character(6), parameter :: LAWS(2) = ['TIME  ', 'STRAIN']
    do i = 1, 2
      call make_bars(DIALECT_CALCULIX, trim(LAWS(i)), -0.5_DP, ';1000.,.3;', '', model, state)
      state%old%stress = 0
      state%old%history = 0
      state%old%total_time = 0
      state%old%creep_time = 0
      state%new%total_time = 2
      state%new%creep_time = 2
      state%new%history(HISTORY_CEEQ, :) = 2 * A * Q(2)**2 * sqrt(2.0_DP)
      state%new%stress(1, :) = Q(2)
      call check_creep(model, model%steps(1), state, ratio, failure)
      call suite%near('the first increment', ratio, 2 * A * Q(2)**2 / sqrt(2.0_DP) / CETOL, 1.0e-8_DP)
    end do
  end subroutine check_start


  !> CalculiX limits creep of isotropic elasticity alone; without creep nothing is limited.
  subroutine check_materials()
    type(model_type) :: model
    type(state_type) :: state
    type(failure_type) :: failure
    real(DP) :: ratio
    call make_bars(DIALECT_CALCULIX, 'TIME', 0.0_DP, ';1000.,.3;', '', model, state)
    model%materials%elastic_kind = ELASTIC_ORTHOTROPIC
    call suite%that('calculix', .not. any(is_limited_by_cetol(model%dialect, model%materials)))
    call check_creep(model, model%steps(1), state, ratio, failure)
    call suite%that('no limit', ratio <= 0 .and. failure%code == FAILURE_NONE)
    call suite%that('abaqus', all(is_limited_by_cetol(DIALECT_ABAQUS, model%materials)))
    model%steps(1)%has_creep = .false.
    model%dialect = DIALECT_ABAQUS
    call check_creep(model, model%steps(1), state, ratio, failure)
    call suite%that('a static step', ratio <= 0)
  end subroutine check_materials

end program test_creep_accuracy
