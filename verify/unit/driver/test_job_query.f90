!> Unit test of job_query: quantities of the stretched cube by name, sets by name and label, values that are set.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_job_query
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use check, only: suite_type
  use samples, only: deck_lines
  use amontons_analysis, only: analysis_type, start_analysis, advance_analysis
  use amontons_errors, only: error_type, EXIT_USAGE
  use amontons_job_query, only: query_values, set_driven_values, query_names, current_step, time_in_step, time_left_in_step
  use amontons_kinds, only: DP
  use amontons_logger, only: logger_type
  use amontons_model, only: job_options_type
  implicit none
  real(DP), parameter :: TOL = 1.0e-9_DP
  type(suite_type) :: suite
  type(analysis_type) :: analysis
  type(logger_type) :: logger                          ! never opened: quiet

  call start()
  call check_names()
  call check_numbers()
  call check_nodes()
  call check_elements()
  call check_setting()
  call check_steps()
  call suite%finish()

contains

  include 'sample_cube.inc'

  !> The cube after two increments: time 0.5, u3 = 0.005, stress 5.
  subroutine start()
    type(job_options_type) :: options
    type(error_type), allocatable :: error
    logical :: is_done
    integer :: i
    options%deck_text = cube_deck()
    options%has_files = .false.
    options%n_threads = 1
    call start_analysis(analysis, options, logger, error)
    do i = 1, 2
      if (.not. allocated(error)) call advance_analysis(analysis, logger, is_done, error)
    end do
    if (allocated(error)) error stop 'the cube is not solved'
  end subroutine start


  !> A quantity of a shape.
  function values_of(quantity, set, n_components, n_rows) result(values)
    character(*), intent(in) :: quantity, set
    integer, intent(in) :: n_components, n_rows
    real(DP), allocatable :: values(:, :)
    type(error_type), allocatable :: error
    call query_values(analysis, quantity, set, values, error)
    if (.not. allocated(values)) allocate (values(0, 0))
    call suite%that('shape of ' // quantity // ' of ' // set, all(shape(values) == [n_components, n_rows]))
    if (all(shape(values) == [n_components, n_rows])) return
    if (allocated(error)) print '(a)', error%message
    deallocate (values)
    allocate (values(n_components, n_rows), source=-1.0e9_DP)
  end function values_of


  !> A single number.
  subroutine expect_number(quantity, expected, set)
    character(*), intent(in) :: quantity
    real(DP), intent(in) :: expected
    character(*), intent(in), optional :: set
    real(DP) :: values(1, 1)
    if (present(set)) then
      values = values_of(quantity, set, 1, 1)
    else
      values = values_of(quantity, '', 1, 1)
    end if
    call suite%near(quantity, values(1, 1), expected, TOL)
  end subroutine expect_number


  !> A query is refused with a message.
  subroutine expect_refusal(quantity, set, piece)
    character(*), intent(in) :: quantity, set, piece
    real(DP), allocatable :: values(:, :)
    type(error_type), allocatable :: error
    call query_values(analysis, quantity, set, values, error)
    call suite%that(quantity // ' of ' // set // ' is refused', allocated(error))
    if (.not. allocated(error)) return
    call suite%that(error%message // ' says: ' // piece, error%code == EXIT_USAGE .and. index(error%message, piece) > 0)
  end subroutine expect_refusal


  !> Names of each kind; each quantity that is listed is known.
  subroutine check_names()
    character(:), allocatable :: names(:)
    type(error_type), allocatable :: error
    real(DP), allocatable :: values(:, :)
    integer :: i
    call query_names(analysis, 'node sets', names, error)
    call suite%that('node sets', any(names == 'TOP') .and. any(names == 'LEFT') .and. .not. any(names == 'CUBE'))
    call query_names(analysis, 'ELEMENT SETS', names, error)
    call suite%that('element sets', any(names == 'CUBE') .and. .not. any(names == 'TOP'))
    call query_names(analysis, 'SURFACES', names, error)
    call suite%that('surfaces', size(names) == 1 .and. names(1) == 'LID')
    call query_names(analysis, 'MATERIALS', names, error)
    call suite%that('materials', size(names) == 1 .and. names(1) == 'SOFT')
    call query_names(analysis, 'INTERACTIONS', names, error)
    call suite%that('no interactions', size(names) == 0)
    call query_names(analysis, 'NONSENSE', names, error)
    call suite%that('names of nonsense', allocated(error))
    call query_names(analysis, 'QUANTITIES', names, error)
    do i = 1, size(names)
      if (names(i) == 'FRICTION' .or. names(i) == 'FACE CENTRES' .or. names(i) == 'P') cycle   ! they need a set
      call query_values(analysis, names(i), '', values, error)
      call suite%that('a listed quantity is known: ' // trim(names(i)), .not. allocated(error))
    end do
  end subroutine check_names


  !> Time, counts, works: the work of a force that grows to 5 over 0.005 is 0.0125.
  subroutine check_numbers()
    call expect_refusal('TIMME', '', 'did you mean TIME?')
    call expect_refusal('U', 'LIDD', 'did you mean LID?')
    call expect_refusal('P', 'LIDS', 'did you mean LID?')
    call expect_refusal('CFN', 'LID', 'There is no contact pair named LID; the deck has none at all')
    call expect_number('TIME', 0.5_DP)
    call expect_number('step time', 0.5_DP)
    call expect_number('Time left', 0.5_DP)
    call expect_number('STEP', 1.0_DP)
    call expect_number('INCREMENTS', 2.0_DP)
    call expect_number('STRAIN ENERGY', 0.0125_DP)
    call expect_number('EXTERNAL WORK', 0.0125_DP)
    call expect_number('FRICTION WORK', 0.0_DP)
    call expect_number('ITERATIONS', real(sum(analysis%records(:2)%n_iterations), DP))
    call expect_refusal('FRICTION', 'RUBBING', 'RUBBING')
    call suite%that('the step', current_step(analysis) == 1)
    call suite%near('time in it', time_in_step(analysis), 0.5_DP, TOL)
    call suite%near('time left', time_left_in_step(analysis), 0.5_DP, TOL)
  end subroutine check_numbers


  !> Vectors and columns at nodes.
  subroutine check_nodes()
    real(DP) :: vectors(3, 8), some(3, 4), labels(1, 4), one(3, 1), tensor(6, 1), load(1, 4)
    labels = values_of('NODES', 'TOP', 1, 4)
    call suite%near('labels', maxval(abs(labels(1, :) - [5.0_DP, 6.0_DP, 7.0_DP, 8.0_DP])), 0.0_DP, 0.0_DP)
    one = values_of('X', '8', 3, 1)
    call suite%near('place of 8', maxval(abs(one(:, 1) - [0.0_DP, 1.0_DP, 1.0_DP])), 0.0_DP, 0.0_DP)
    some = values_of('U', 'TOP', 3, 4)
    call suite%near('displacement', maxval(abs(some(3, :) - 0.005_DP)), 0.0_DP, TOL)
    some = values_of('RF', 'TOP', 3, 4)
    call suite%near('reaction', maxval(abs(some(3, :) - 1.25_DP)), 0.0_DP, TOL)
    some = values_of('INTERNAL FORCE', 'BOTTOM', 3, 4)
    call suite%near('internal force', maxval(abs(some(3, :) + 1.25_DP)), 0.0_DP, TOL)
    vectors = values_of('RESIDUAL', '', 3, 8)
    call suite%near('no residual', maxval(abs(vectors)), 0.0_DP, TOL)
    vectors = values_of('CONTACT FORCE', 'ALL', 3, 8)
    call suite%near('no contact', maxval(abs(vectors)), 0.0_DP, 0.0_DP)
    tensor = values_of('S', '3', 6, 1)
    call suite%near('stress', maxval(abs(tensor(:, 1) - [0.0_DP, 0.0_DP, 5.0_DP, 0.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
    load = values_of('CF3', 'TOP', 1, 4)
    call suite%near('no load', maxval(abs(load)), 0.0_DP, 0.0_DP)
    call expect_refusal('U', 'NOWHERE', 'NOWHERE')
    call expect_refusal('U', '99', '99')
    call expect_refusal('NONSENSE', '', 'NONSENSE')
    call expect_refusal('FACE CENTRES', 'TOP', 'TOP')
    one = values_of('FACE CENTRES', 'LID', 3, 1)
    call suite%near('centre of the lid', maxval(abs(one(:, 1) - [0.5_DP, 0.5_DP, 1.0_DP])), 0.0_DP, TOL)
  end subroutine check_nodes


  !> Points and means of elements.
  subroutine check_elements()
    real(DP) :: points(6, 8), volumes(1, 8), labels(1, 8), mean(6, 1), volume(1, 1)
    points = values_of('POINT S', 'CUBE', 6, 8)
    call suite%near('stress of points', maxval(abs(points(3, :) - 5)), 0.0_DP, TOL)
    points = values_of('POINT E', '11', 6, 8)
    call suite%near('strain of points', maxval(abs(points(3, :) - 0.005_DP)), 0.0_DP, TOL)
    volumes = values_of('POINT VOLUME', '', 1, 8)
    call suite%near('volume of a point', volumes(1, 5), 0.125_DP, TOL)
    labels = values_of('POINT LABEL', '', 1, 8)
    call suite%near('label of a point', labels(1, 8), 11.0_DP, 0.0_DP)
    mean = values_of('ELEMENT S', '', 6, 1)
    call suite%near('mean stress', mean(3, 1), 5.0_DP, TOL)
    volume = values_of('ELEMENT VOLUME', 'CUBE', 1, 1)
    call suite%near('the volume is a sum', volume(1, 1), 1.0_DP, TOL)
    volume = values_of('ELEMENT ENERGY', 'CUBE', 1, 1)
    call suite%near('the energy is a mean', volume(1, 1), 0.0125_DP, TOL)
    volume = values_of('ELEMENT LABEL', '', 1, 1)
    call suite%near('label', volume(1, 1), 11.0_DP, 0.0_DP)
    call expect_refusal('ELEMENT S', 'NOWHERE', 'NOWHERE')
    call expect_refusal('POINT S', '12', '12')
    call expect_refusal('ELEMENT NONSENSE', '', 'NONSENSE')
  end subroutine check_elements


  !> What cannot be set, and a load that is reached in the next increment.
  subroutine check_setting()
    type(error_type), allocatable :: error
    real(DP) :: load(1, 1)
    call set_driven_values(analysis, 'NONSENSE', 'TOP', [1.0_DP], error)
    call suite%that('nonsense', allocated(error))
    call set_driven_values(analysis, 'U3', 'NOWHERE', [1.0_DP], error)
    call suite%that('nowhere', allocated(error))
    call set_driven_values(analysis, 'U3', 'TOP', [1.0_DP, 2.0_DP], error)
    call suite%that('two values for four nodes', allocated(error))
    call set_driven_values(analysis, 'U3', 'TOP', [real(DP) ::], error)
    call suite%that('no values', allocated(error))
    call set_driven_values(analysis, 'U3', 'TOP', [ieee_value(1.0_DP, ieee_quiet_nan)], error)
    call suite%that('no number', allocated(error))
    call set_driven_values(analysis, 'FRICTION', 'RUBBING', [0.1_DP], error)
    call suite%that('no interaction', allocated(error))
    call set_driven_values(analysis, 'P', 'LID', [2.0_DP], error)
    call suite%that('a pressure', .not. allocated(error))
    call set_driven_values(analysis, 'CF1', '7', [0.5_DP], error)
    call suite%that('a force', .not. allocated(error))
    load = values_of('CF1', '7', 1, 1)
    call suite%near('it does not act yet', load(1, 1), 0.0_DP, 0.0_DP)
  end subroutine check_setting


  !> Between steps: the next step is the current one, with all its time left.
  subroutine check_steps()
    type(error_type), allocatable :: error
    logical :: is_done
    integer :: i
    do i = 1, 2
      call advance_analysis(analysis, logger, is_done, error)
    end do
    call suite%that('the end of step 1', analysis%is_step_start .and. .not. allocated(error))
    call suite%that('the next step is current', current_step(analysis) == 2)
    call suite%near('nothing of it is done', time_in_step(analysis), 0.0_DP, TOL)
    call suite%near('all of it is left', time_left_in_step(analysis), 2.0_DP, TOL)
    call expect_number('TIME LEFT', 2.0_DP)
    do i = 1, 2
      call advance_analysis(analysis, logger, is_done, error)
    end do
    call expect_number('TIME LEFT', 0.0_DP)
    call expect_number('TIME', 3.0_DP)
  end subroutine check_steps

end program test_job_query
