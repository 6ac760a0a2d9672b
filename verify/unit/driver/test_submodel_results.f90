!> Unit test of submodel_results: values and times of driven displacements and temperatures in both dialects, nodes outside, and
!! what a file does not have.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_submodel_results
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: error_type, diagnostic_list_type, EXIT_IO, EXIT_SETUP
  use amontons_loads, only: load_value
  use amontons_logger, only: logger_type, open_logger, PROGRESS_NONE
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_submodel_results, only: drive_submodels
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: NODES = '*NODE;1,.2,.2,.2;2,.8,.2,.2;3,.8,.8,.2;4,.2,.8,.2;' // &
    '5,.2,.2,.8;6,.8,.2,.8;7,.8,.8,.8;8,.2,.8,.8;'
  character(*), parameter :: REST = '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL, NAME=M;*ELASTIC;50.,0.;' // &
    '*SOLID SECTION, ELSET=E, MATERIAL=M;*NSET, NSET=N, GENERATE;1,8;'
  character(*), parameter :: CARD = '*SUBMODEL, INPUT=global.frd;N;'
  type(suite_type) :: suite
  call write_global()
  call check_history()
  call check_last()
  call check_temperatures()
  call check_outside()
  call check_errors()
  call suite%finish()

contains

  !> The displacement of the global model, trilinear.
  pure function field(x) result(u)
    real(DP), intent(in) :: x(3)
    real(DP) :: u(3)
    u = [1 + 2 * x(1), x(2) - x(3), 3 * x(1) * x(2)]
  end function field


  !> A unit cube; step 1 with increments at 0.5 and 2 of 1/4 and once the field, step 2 of length 1 with twice the field and the
  !! temperature 10 + x.
  subroutine write_global()
    integer :: unit, i, k
    real(DP), parameter :: X(3, 8) = reshape([real(DP) :: 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, &
      1], [3, 8])
    real(DP), parameter :: TIMES(3) = [0.5_DP, 2.0_DP, 3.0_DP], FACTORS(4) = [0.25_DP, 1.0_DP, 2.0_DP, 0.0_DP]
    open (newunit=unit, file='global.frd', action='write', status='replace')
    write (unit, '(a,18x,i12,37x,i1)') '    2C', 8, 1
    do i = 1, 8
      write (unit, '(a,i10,3es12.5)') ' -1', i, X(:, i)
    end do
    write (unit, '(a)') ' -3'
    write (unit, '(a,18x,i12,37x,i1)') '    3C', 1, 1
    write (unit, '(a,i10,3i5)') ' -1', 5, 1, 0, 1
    write (unit, '(a,8i10)') ' -2', 1, 2, 3, 4, 5, 6, 7, 8
    write (unit, '(a)') ' -3'
    do k = 1, 4
      write (unit, '(a,i26,2i12)') '    1PSTEP', k, k, merge(1, 2, k < 3)
      write (unit, '(a,i5,es12.5,i12,20x,i2,i5,10x,i2)') '  100CL', 100 + k, TIMES(min(k, 3)), 8, 0, min(k, 3), 1
      if (k < 4) write (unit, '(a)') ' -4  DISP        3    1', ' -5  D1          1    2    1    0', &
        ' -5  D2          1    2    2    0', ' -5  D3          1    2    3    0'
      if (k == 4) write (unit, '(a)') ' -4  NDTEMP      1    1', ' -5  T           1    1    0    0'
      do i = 1, 8
        if (k < 4) write (unit, '(a,i10,3es12.5)') ' -1', i, FACTORS(k) * field(X(:, i))
        if (k == 4) write (unit, '(a,i10,3es12.5)') ' -1', i, 10 + X(1, i)
      end do
      write (unit, '(a)') ' -3'
    end do
    write (unit, '(a)') ' 9999'
    close (unit)
  end subroutine write_global


  !> Reads a deck and drives it.
  subroutine drive(deck, dialect, model, error)
    character(*), intent(in) :: deck
    integer, intent(in) :: dialect
    type(model_type), intent(out) :: model
    type(error_type), allocatable, intent(out) :: error
    type(job_options_type) :: options
    type(diagnostic_list_type) :: diagnostics
    type(logger_type) :: logger
    options%dialect = dialect
    call open_logger(logger, .true., PROGRESS_NONE)
    call read_deck_text(deck_lines(deck), options, model, diagnostics, error)
    call suite%that('read: ' // deck, .not. allocated(error))
    if (.not. allocated(error)) call drive_submodels(model, options, logger, error)
  end subroutine drive


  !> A step that drives all nodes.
  pure function step(parameters, period) result(cards)
    character(*), intent(in) :: parameters, period
    character(:), allocatable :: cards
    cards = '*STEP;*STATIC;1.,' // period // ';*BOUNDARY, SUBMODEL' // parameters // ';N,1,3;*END STEP;'
  end function step


  !> The largest difference of a step's displacements at a time from a factor times the field.
  real(DP) function deviation(model, i, time, factor)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i
    real(DP), intent(in) :: time, factor
    real(DP) :: u(3)
    integer :: k
    deviation = -1
    do k = 1, size(model%steps(i)%prescribed)
      associate (load => model%steps(i)%prescribed(k))
        u = factor * field(model%mesh%coordinates(:, load%node))
        deviation = max(deviation, abs(load_value(load, model%amplitudes, time, time, model%steps(i)%period) - u(load%dof)))
      end associate
    end do
  end function deviation


  !> abaqus: all increments, linear between them, constant after; step 2 starts where step 1 ends; TIMESCALE.
  subroutine check_history()
    type(model_type) :: model
    type(error_type), allocatable :: error
    real(DP), parameter :: TOL = 1.0e-12_DP
    call drive(NODES // REST // CARD // step(', STEP=1', '4.') // step(', STEP=2', '1.') // step(', STEP=1, TIMESCALE', '4.'), &
      DIALECT_ABAQUS, model, error)
    call suite%that('driven', .not. allocated(error))
    if (allocated(error)) return
    call suite%that('24 displacements', size(model%steps(1)%prescribed) == 24)
    call suite%near('at the start', deviation(model, 1, 0.0_DP, 0.0_DP), 0.0_DP, TOL)
    call suite%near('at an increment', deviation(model, 1, 0.5_DP, 0.25_DP), 0.0_DP, TOL)
    call suite%near('between two', deviation(model, 1, 1.25_DP, 0.625_DP), 0.0_DP, TOL)
    call suite%near('after the global step', deviation(model, 1, 3.5_DP, 1.0_DP), 0.0_DP, TOL)
    call suite%near('step 2 at its start', deviation(model, 2, 0.0_DP, 1.0_DP), 0.0_DP, TOL)
    call suite%near('step 2 within', deviation(model, 2, 0.25_DP, 1.25_DP), 0.0_DP, TOL)
    call suite%near('scaled', deviation(model, 3, 1.0_DP, 0.25_DP), 0.0_DP, TOL)
    call suite%near('scaled, end', deviation(model, 3, 4.0_DP, 1.0_DP), 0.0_DP, TOL)
    call drive(NODES // REST // CARD // step(', DATA SET=1', '1.'), DIALECT_ABAQUS, model, error)
    call suite%near('data set', deviation(model, 1, 1.0_DP, 0.25_DP), 0.0_DP, TOL)
    call drive(NODES // REST // '*TRANSFORM, NSET=N;0,1,0,-1,0,0;' // CARD // step(', STEP=1', '2.'), DIALECT_ABAQUS, model, error)
    associate (load => model%steps(1)%prescribed(1))     ! node 1, direction 1, which is y
      call suite%near('own directions', load_value(load, model%amplitudes, 2.0_DP, 2.0_DP, 2.0_DP), 0.0_DP, TOL)
      call suite%that('of node 1', load%node == 1 .and. load%dof == 1)
    end associate
  end subroutine check_history


  !> calculix: the last increment of the step.
  subroutine check_last()
    type(model_type) :: model
    type(error_type), allocatable :: error
    call drive(NODES // REST // CARD // step(', STEP=1', '1.'), DIALECT_CALCULIX, model, error)
    call suite%that('last: no error', .not. allocated(error))
    call suite%that('no amplitude', all(model%steps(1)%prescribed%amplitude == 0) .and. &
      all(model%steps(1)%prescribed%is_from_current))
    call suite%near('half of it', deviation(model, 1, 0.5_DP, 0.5_DP), 0.0_DP, 1.0e-12_DP)
  end subroutine check_last


  !> Temperatures start from those before the step, and those that follow start where they end.
  subroutine check_temperatures()
    type(model_type) :: model
    type(error_type), allocatable :: error
    real(DP) :: worst
    integer :: k
    call drive(NODES // REST // CARD // '*INITIAL CONDITIONS, TYPE=TEMPERATURE;N,4.;*STEP;*STATIC;*TEMPERATURE, SUBMODEL, STEP=2;' &
      // 'N;*END STEP;*STEP;*STATIC;*TEMPERATURE;N,20.;*END STEP;', DIALECT_CALCULIX, model, error)
    call suite%that('temperatures', .not. allocated(error))
    worst = -1
    do k = 1, 8
      associate (first => model%steps(1)%temperatures(k), then => model%steps(2)%temperatures(k))
        worst = max(worst, abs(first%start - 4), abs(first%end - 10 - model%mesh%coordinates(1, first%node)), &
          abs(then%start - 10 - model%mesh%coordinates(1, then%node)), abs(then%end - 20))
      end associate
    end do
    call suite%near('chained', worst, 0.0_DP, 1.0e-12_DP)
  end subroutine check_temperatures


  !> A node outside takes the value of the nearest point; abaqus: within the tolerance.
  subroutine check_outside()
    character(*), parameter :: MOVED = '*NODE;1,-.04,.2,.2;2,.8,.2,.2;3,.8,.8,.2;4,.2,.8,.2;5,.2,.2,.8;' // &
      '6,.8,.2,.8;7,.8,.8,1.04;8,.2,.8,.8;'
    type(model_type) :: model
    type(error_type), allocatable :: error
    real(DP) :: u(3)
    call drive(MOVED // REST // CARD // step(', STEP=1', '2.'), DIALECT_ABAQUS, model, error)
    call suite%that('within 0.05', .not. allocated(error))
    u = field([0.0_DP, 0.2_DP, 0.2_DP])
    associate (load => model%steps(1)%prescribed(1))
      call suite%near('nearest point', load_value(load, model%amplitudes, 2.0_DP, 2.0_DP, 2.0_DP), u(load%dof), 1.0e-12_DP)
    end associate
    call expect_error(MOVED // REST // '*SUBMODEL, INPUT=global.frd, EXTERIOR TOLERANCE=.03;N;' // step(', STEP=1', '1.'), &
      DIALECT_ABAQUS, EXIT_SETUP, '2 driven nodes are outside')
    call expect_error(MOVED // REST // '*SUBMODEL, INPUT=global.frd, ABSOLUTE EXTERIOR TOLERANCE=.03;N;' // step(', STEP=1', &
      '1.'), DIALECT_CALCULIX, EXIT_SETUP, 'outside the global model')
    call drive(MOVED // REST // CARD // step(', STEP=1', '1.'), DIALECT_CALCULIX, model, error)
    call suite%that('calculix takes any distance', .not. allocated(error))
  end subroutine check_outside


  !> What the file does not have.
  subroutine check_errors()
    call expect_error(NODES // REST // '*SUBMODEL, INPUT=none.frd;N;' // step(', STEP=1', '1.'), DIALECT_ABAQUS, EXIT_IO, &
      'does not exist')
    call expect_error(NODES // REST // CARD // step(', STEP=3', '1.'), DIALECT_ABAQUS, EXIT_SETUP, 'its steps are 1 to 2')
    call expect_error(NODES // REST // CARD // step(', DATA SET=9', '1.'), DIALECT_ABAQUS, EXIT_SETUP, 'no data set 9')
    call expect_error(NODES // REST // CARD // '*STEP;*STATIC;*TEMPERATURE, SUBMODEL, STEP=1;N;*END STEP;', DIALECT_ABAQUS, &
      EXIT_SETUP, 'no temperatures of step 1')
    call expect_error(NODES // REST // '*SUBMODEL, INPUT=global.frd, GLOBAL ELSET=G;N;*ELSET, ELSET=G;77;' // step(', STEP=1', &
      '1.'), DIALECT_CALCULIX, EXIT_SETUP, 'no element of')
    call expect_error(NODES // REST // '*SUBMODEL, INPUT=global.frd, GLOBAL ELSET=G;N;' // step(', STEP=1', '1.'), &
      DIALECT_CALCULIX, EXIT_SETUP, 'has no sets')
  end subroutine check_errors


  !> A deck whose results are refused, with the line of the card.
  subroutine expect_error(deck, dialect, code, piece)
    character(*), intent(in) :: deck, piece
    integer, intent(in) :: dialect, code
    type(model_type) :: model
    type(error_type), allocatable :: error
    call drive(deck, dialect, model, error)
    call suite%that('error: ' // piece, allocated(error))
    if (.not. allocated(error)) return
    call suite%that('code of: ' // piece, error%code == code)
    call suite%that('message "' // error%message // '" has ' // piece, index(error%message, piece) > 0 .and. &
      index(error%message, '*SUBMODEL of line ') == 1)
  end subroutine expect_error

end program test_submodel_results
