!> Submodels: the displacements and temperatures that driven nodes take from the results of a global model.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Each driven node is located once in the undeformed global mesh; its values are interpolated there by the shape functions, its
!! rotations by their gradient (`driven_directors`). Nodes outside take those of the nearest point. The history of the global step
!! becomes a table over the step time for each displacement; under the calculix dialect, as in CalculiX, the last increment of the
!! step is approached linearly.
module amontons_submodel_results
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_element_kinds, only: N_SOLID_KINDS
  use amontons_global_results, only: global_results_type, global_frame_type, open_global_results, close_global_results, &
    find_global_frames, read_global_field, find_global_set, GLOBAL_DISPLACEMENT, GLOBAL_TEMPERATURE
  use amontons_deck_restart, only: folder_name
  use amontons_driven_directors, only: driven_director_type, find_driven_directors, add_director_motion, continue_rotations
  use amontons_loads, only: amplitude_type, load_type, load_value, AMPLITUDE_TABLE
  use amontons_logger, only: logger_type
  use amontons_mesh_point_search, only: located_point_type, locate_points, mean_element_size, &
    select_elements, exterior_limit
  use amontons_model, only: model_type, job_options_type, dof_direction, DIALECT_CALCULIX
  use amontons_posix, only: continue_checksum
  use amontons_steps, only: TOL_STOP_TIME
  use amontons_submodels, only: submodel_type
  use amontons_text, only: to_text, plural, verb
  implicit none
  private
  public :: drive_submodels

  !> The driven nodes of one SUBMODEL card in the global model.
  type :: driven_nodes_type
    integer, allocatable :: nodes(:)                 !< driven in some step
    integer, allocatable :: at(:)                    !< (n_nodes of the mesh) index into nodes, of rotation nodes too; 0: not driven
                                                     !! by this card
    type(located_point_type), allocatable :: located(:)   !< (nodes)
    integer, allocatable :: owner(:)                 !< (n_nodes of the mesh) the node itself, of a rotation node its node
    type(driven_director_type), allocatable :: directors(:)   !< (nodes) of shells and beams
    type(global_frame_type), allocatable :: frames(:)     !< increments with the field of the last request
    integer :: field = 0                             !< this field, GLOBAL_...
  end type driven_nodes_type

  !> What a step of the global model gives.
  type :: history_type
    integer :: step = 0                              !< the step, or minus the data set
    logical :: is_scaled = .false.                   !< TIMESCALE
    real(DP), allocatable :: time(:)                 !< (increments) step time [time]
    real(DP), allocatable :: values(:, :, :)         !< (width of the field, nodes, increments)
  end type history_type

contains

  !> Gives all driven displacements and temperatures their values. Errors: EXIT_IO (the file), EXIT_SETUP (what it has, nodes
  !! outside).
  subroutine drive_submodels(model, options, logger, error)
    type(model_type), intent(inout) :: model
    type(job_options_type), intent(in) :: options
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(global_results_type) :: results
    type(driven_nodes_type) :: driven
    type(amplitude_type), allocatable :: amplitudes(:)   ! those of the model, then one for each driven value
    integer :: s, i, n_used, n_driven
    if (.not. allocated(model%submodels)) return
    n_driven = 0
    do i = 1, size(model%steps)
      n_driven = n_driven + count(model%steps(i)%prescribed%global_step /= 0) + &
        count(model%steps(i)%temperatures%global_step /= 0)
    end do
    if (n_driven == 0) then
      call logger%warn('The deck has *SUBMODEL, but no *BOUNDARY or *TEMPERATURE with SUBMODEL uses it: the cut is free.')
      return
    end if
    n_used = size(model%amplitudes)
    allocate (amplitudes(n_used + n_driven))
    amplitudes(:n_used) = model%amplitudes
    do s = 1, size(model%submodels)
      call find_driven_nodes(model, s, driven)
      if (size(driven%nodes) == 0) cycle
      call open_global_results(results, path_of(model%submodels(s), options), error)
      if (.not. allocated(error)) call locate_driven_nodes(model, s, results, driven, logger, error)
      do i = 1, size(model%steps)
        if (.not. allocated(error)) call drive_displacements(model, i, results, driven, amplitudes, n_used, logger, error)
        if (.not. allocated(error)) call drive_temperatures(model, i, results, driven, amplitudes, n_used, logger, error)
      end do
      call close_global_results(results)
      if (.not. allocated(error)) cycle
      error%message = '*SUBMODEL of line ' // to_text(model%submodels(s)%line) // ': ' // error%message
      return
    end do
    model%amplitudes = amplitudes(:n_used)
    call chain_temperatures(model)
  end subroutine drive_submodels


  !> The file of the results: beside the deck, else as written.
  function path_of(submodel, options) result(path)
    type(submodel_type), intent(in) :: submodel
    type(job_options_type), intent(in) :: options
    character(:), allocatable :: path, beside
    logical :: is_there
    path = submodel%path
    if (path == '' .and. allocated(options%global_results)) then
      path = options%global_results
      return
    end if
    if (path(1:1) == '/' .or. .not. allocated(options%deck)) return
    beside = folder_name(options%deck) // path
    inquire (file=beside, exist=is_there)
    if (is_there) path = beside
  end function path_of


  !> The nodes of a card that some step drives.
  subroutine find_driven_nodes(model, s, driven)
    type(model_type), intent(in) :: model
    integer, intent(in) :: s                         !< the card
    type(driven_nodes_type), intent(out) :: driven
    logical :: is_member(model%mesh%n_nodes), is_driven(model%mesh%n_nodes)
    integer :: i, k
    is_member = .false.
    is_member(model%submodels(s)%nodes) = .true.
    is_driven = .false.
    driven%owner = [(k, k=1, model%mesh%n_nodes)]
    if (allocated(model%rotation_of)) then
      do k = 1, size(model%rotation_of)
        if (model%rotation_of(k) > 0) driven%owner(model%rotation_of(k)) = k
      end do
    end if
    do i = 1, size(model%steps)
      associate (prescribed => model%steps(i)%prescribed, temperatures => model%steps(i)%temperatures)
        is_driven(driven%owner(pack(prescribed%node, prescribed%global_step /= 0))) = .true.
        is_driven(pack(temperatures%node, temperatures%global_step /= 0)) = .true.
      end associate
    end do
    driven%nodes = pack([(k, k=1, model%mesh%n_nodes)], is_member .and. is_driven)
    allocate (driven%at(model%mesh%n_nodes), source=0)
    driven%at(driven%nodes) = [(k, k=1, size(driven%nodes))]
    driven%at = driven%at(driven%owner)
  end subroutine find_driven_nodes


  !> Locates the driven nodes in the elements that count, and reports those outside.
  subroutine locate_driven_nodes(model, s, results, driven, logger, error)
    type(model_type), intent(in) :: model
    integer, intent(in) :: s                         !< the card
    type(global_results_type), intent(in) :: results
    type(driven_nodes_type), intent(inout) :: driven
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: kind(:), first(:), nodes(:)
    real(DP) :: tolerance
    if (.not. results%is_solid .and. any(model%mesh%kind <= N_SOLID_KINDS)) then
      call set_error(error, EXIT_SETUP, 'The global model of ' // results%path // ' is of plane or axisymmetric elements, ' // &
        'this deck of solids. Both must be of solids, or both of plane or axisymmetric elements.')
      return
    end if
    call find_elements(model%submodels(s), results, model%dialect == DIALECT_CALCULIX .or. results%is_frd, kind, first, nodes, &
      error)
    if (allocated(error)) return
    call locate_points(kind, first, nodes, results%coordinates, model%mesh%coordinates(:, driven%nodes), driven%located)
    associate (submodel => model%submodels(s))
      tolerance = exterior_limit(submodel%exterior_tolerance, submodel%absolute_tolerance, &
        mean_element_size(first, nodes, results%coordinates))
      call report_nodes_outside(model, submodel, results, driven, tolerance, logger, error)
    end associate
    if (allocated(error)) return
    call find_driven_directors(model, driven%nodes, kind, first, nodes, results%coordinates, driven%located, driven%directors, &
      error)
    if (allocated(error)) error%message = error%message // ' (global model: ' // results%path // ')'
  end subroutine locate_driven_nodes


  !> The global elements that count.
  subroutine find_elements(submodel, results, is_set_of_deck, kind, first, nodes, error)
    type(submodel_type), intent(in) :: submodel
    type(global_results_type), intent(in) :: results
    logical, intent(in) :: is_set_of_deck            !< a set of the deck comes before one of the file
    integer, allocatable, intent(out) :: kind(:), first(:), nodes(:)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: labels(:)
    logical, allocatable :: is_wanted(:)
    integer :: e
    if (submodel%global_elset == '') then
      kind = results%kind
      first = results%first
      nodes = results%nodes
      return
    end if
    if (.not. (allocated(submodel%global_labels) .and. is_set_of_deck)) then
      call find_global_set(results, submodel%global_elset, labels, error)
      if (allocated(error) .and. .not. allocated(submodel%global_labels)) return
      if (allocated(error)) deallocate (error)
    end if
    if (.not. allocated(labels)) labels = submodel%global_labels
    is_wanted = [(is_in(results%element_label(e)), e=1, size(results%kind))]
    call select_elements(results%kind, results%first, results%nodes, pack([(e, e=1, size(is_wanted))], is_wanted), kind, first, &
      nodes)
    if (size(kind) == 0) call set_error(error, EXIT_SETUP, 'GLOBAL ELSET=' // submodel%global_elset // ' has ' // &
      plural(size(labels), 'number') // ', but no element of ' // results%path // ' has one of them.')

  contains

    !> Whether a number is in the list, by bisection.
    pure logical function is_in(label)
      integer, intent(in) :: label
      integer :: low, high, middle
      low = 1
      high = size(labels)
      do while (low < high)
        middle = (low + high) / 2
        if (labels(middle) < label) then
          low = middle + 1
        else
          high = middle
        end if
      end do
      is_in = .false.
      if (size(labels) > 0) is_in = labels(low) == label
    end function is_in

  end subroutine find_elements


  !> Says how many driven nodes are outside the global model; farther than the tolerance they end the job, in Abaqus and here.
  subroutine report_nodes_outside(model, submodel, results, driven, tolerance, logger, error)
    type(model_type), intent(in) :: model
    type(submodel_type), intent(in) :: submodel
    type(global_results_type), intent(in) :: results
    type(driven_nodes_type), intent(in) :: driven
    real(DP), intent(in) :: tolerance                !< [length]
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: where
    integer :: n_outside, n_beyond, worst
    n_outside = count(driven%located%distance > 0)
    if (n_outside == 0) return
    worst = maxloc(driven%located%distance, dim=1)
    where = 'The farthest is node ' // to_text(model%mesh%node_label(driven%nodes(worst))) // ', by ' // &
      to_text(driven%located(worst)%distance) // '.'
    n_beyond = count(driven%located%distance > tolerance)
    if (submodel%is_exterior_error .and. n_beyond > 0) then
      call set_error(error, EXIT_SETUP, plural(n_beyond, 'driven node') // ' ' // verb(n_beyond, 'is', 'are') // &
        ' outside the global model of ' // results%path // ' by more than ' // to_text(tolerance) // '. ' // where // &
        ' Is the submodel in the coordinates and units of the global one? If its surface deviates so far, enlarge EXTERIOR ' // &
        'TOLERANCE (over the mean size of the global elements) or ABSOLUTE EXTERIOR TOLERANCE.')
      return
    end if
    where = 'Of the ' // plural(size(driven%nodes), 'driven node') // ' of the *SUBMODEL of line ' // to_text(submodel%line) // &
      ' ' // to_text(n_outside) // ' ' // verb(n_outside, 'is', 'are') // ' outside the global model and ' // &
      verb(n_outside, 'takes', 'take') // ' the values of its nearest point. ' // where
    if (n_beyond > 0 .and. .not. submodel%is_exterior_error) then
      call logger%warn(where)
    else
      call logger%say(where)
    end if
  end subroutine report_nodes_outside


  !> The displacements of a step.
  subroutine drive_displacements(model, i, results, driven, amplitudes, n_used, logger, error)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: i                         !< the step
    type(global_results_type), intent(inout) :: results
    type(driven_nodes_type), intent(inout) :: driven
    type(amplitude_type), intent(inout) :: amplitudes(:)
    integer, intent(inout) :: n_used                 !< of them
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(history_type) :: history
    logical :: is_done(size(model%steps(i)%prescribed))
    real(DP) :: direction(3)
    integer :: k, m, row
    associate (loads => model%steps(i)%prescribed)
      is_done = loads%global_step == 0 .or. driven%at(loads%node) == 0
      do while (.not. all(is_done))                  ! loads of one global step at a time
        k = findloc(is_done, .false., dim=1)
        history%step = loads(k)%global_step
        history%is_scaled = loads(k)%is_time_scaled
        call read_history(model, i, results, driven, GLOBAL_DISPLACEMENT, history, logger, error)
        if (allocated(error)) return
        model%deck_checksum = continue_checksum(model%deck_checksum, transfer(history%values, [0_I64]))
        do k = k, size(loads)
          if (is_done(k) .or. loads(k)%global_step /= history%step .or. (loads(k)%is_time_scaled .neqv. history%is_scaled)) cycle
          direction = dof_direction(model, loads(k)%node, loads(k)%dof)
          row = merge(1, 4, driven%owner(loads(k)%node) == loads(k)%node)   ! rotations follow the displacements
          associate (values => history%values(row:row + 2, driven%at(loads(k)%node), :))
            call set_load(history%time, [(dot_product(direction, values(:, m)), m=1, size(history%time))], &
              loads(k)%load_type, amplitudes, n_used)
          end associate
          is_done(k) = .true.
        end do
      end do
    end associate
  end subroutine drive_displacements


  !> The temperatures of a step. They start from those before the step, which `chain_temperatures` sets.
  subroutine drive_temperatures(model, i, results, driven, amplitudes, n_used, logger, error)
    type(model_type), intent(inout) :: model
    integer, intent(in) :: i                         !< the step
    type(global_results_type), intent(inout) :: results
    type(driven_nodes_type), intent(inout) :: driven
    type(amplitude_type), intent(inout) :: amplitudes(:)
    integer, intent(inout) :: n_used                 !< of them
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(history_type) :: history
    logical :: is_done(size(model%steps(i)%temperatures))
    integer :: k
    associate (loads => model%steps(i)%temperatures)
      is_done = loads%global_step == 0
      do k = 1, size(loads)
        if (.not. is_done(k)) is_done(k) = driven%at(loads(k)%node) == 0
      end do
      do while (.not. all(is_done))                  ! loads of one global step at a time
        k = findloc(is_done, .false., dim=1)
        history%step = loads(k)%global_step
        history%is_scaled = loads(k)%is_time_scaled
        call read_history(model, i, results, driven, GLOBAL_TEMPERATURE, history, logger, error)
        if (allocated(error)) return
        model%deck_checksum = continue_checksum(model%deck_checksum, transfer(history%values, [0_I64]))
        do k = k, size(loads)
          if (is_done(k) .or. loads(k)%global_step /= history%step .or. (loads(k)%is_time_scaled .neqv. history%is_scaled)) cycle
          call set_load(history%time, history%values(1, driven%at(loads(k)%node), :), loads(k)%load_type, amplitudes, n_used)
          is_done(k) = .true.
        end do
      end do
    end associate
  end subroutine drive_temperatures


  !> One value alone is approached linearly; a history becomes an amplitude of its value of the largest magnitude.
  pure subroutine set_load(time, values, load, amplitudes, n_used)
    real(DP), intent(in) :: time(:), values(:)       !< step times and values
    type(load_type), intent(inout) :: load
    type(amplitude_type), intent(inout) :: amplitudes(:)
    integer, intent(inout) :: n_used
    if (size(values) == 1) then
      load%start = 0
      load%end = values(1)
      return
    end if
    n_used = n_used + 1
    associate (amplitude => amplitudes(n_used))
      amplitude%name = ''
      amplitude%shape = AMPLITUDE_TABLE
      amplitude%time = time
      amplitude%factor = values
      load%end = values(maxloc(abs(values), dim=1))
      if (abs(load%end) > 0) amplitude%factor = values / load%end
    end associate
    load%amplitude = n_used
  end subroutine set_load


  !> Reads and interpolates what a step of the global model gives: its increments after the state at its start, or the last alone.
  subroutine read_history(model, i, results, driven, field, history, logger, error)
    type(model_type), intent(in) :: model
    integer, intent(in) :: i                         !< step of this deck
    type(global_results_type), intent(inout) :: results
    type(driven_nodes_type), intent(inout) :: driven
    integer, intent(in) :: field                     !< GLOBAL_...
    type(history_type), intent(inout) :: history     !< in: step, is_scaled
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: chosen(:)                ! frames; 0: the zero state before the first step
    real(DP), allocatable :: values(:, :)
    integer :: m
    if (driven%field /= field) call find_global_frames(results, field, driven%frames, error)
    if (allocated(error)) return
    driven%field = field
    call choose_frames(results, driven%frames, field, history%step, model%dialect == DIALECT_CALCULIX .or. &
      model%steps(i)%is_perturbation, chosen, error)
    if (allocated(error)) return
    history%time = spread(0.0_DP, 1, size(chosen))
    if (allocated(history%values)) deallocate (history%values)
    do m = 1, size(chosen)
      if (chosen(m) == 0) then
        if (field == GLOBAL_DISPLACEMENT) allocate (values(6, size(driven%nodes)), source=0.0_DP)
        if (field == GLOBAL_TEMPERATURE) values = reshape(initial_temperatures(model, driven%nodes), [1, size(driven%nodes)])
      else
        call interpolate_frame(model, results, driven, field, driven%frames(chosen(m)), model%steps(i)%is_nlgeom, values, error)
        if (allocated(error)) return
        if (m > 1 .or. size(chosen) == 1) history%time(m) = driven%frames(chosen(m))%step_time
      end if
      if (m == 1) allocate (history%values(size(values, 1), size(values, 2), size(chosen)))
      if (m > 1 .and. field == GLOBAL_DISPLACEMENT .and. model%steps(i)%is_nlgeom) call continue_rotations( &
        history%values(4:, :, m - 1), values(4:, :))
      history%values(:, :, m) = values
      deallocate (values)
    end do
    call logger%say('In step ' // to_text(i) // ' ' // plural(size(driven%nodes), 'node') // ' of the *SUBMODEL ' // &
      verb(size(driven%nodes), 'follows', 'follow') // ' ' // described_history(results, chosen, history) // '.')
    if (history%is_scaled .and. size(chosen) > 1) history%time = history%time * (model%steps(i)%period / maxval(history%time))
  end subroutine read_history


  !> What is followed, in words.
  function described_history(results, chosen, history) result(text)
    type(global_results_type), intent(in) :: results
    integer, intent(in) :: chosen(:)                 !< frames
    type(history_type), intent(in) :: history
    character(:), allocatable :: text
    if (history%step < 0) then
      text = 'the data set ' // to_text(-history%step) // ' of ' // results%path
    else if (size(chosen) == 1) then
      text = 'the last increment of step ' // to_text(history%step) // ' of ' // results%path
    else
      text = plural(size(chosen) - 1, 'increment') // ' of step ' // to_text(history%step) // ' of ' // results%path // &
        ', over the time ' // to_text(maxval(history%time))
    end if
  end function described_history


  !> The temperatures of nodes before the first step.
  pure function initial_temperatures(model, nodes) result(values)
    type(model_type), intent(in) :: model
    integer, intent(in) :: nodes(:)
    real(DP) :: values(size(nodes))
    values = 0
    if (allocated(model%initial_temperature)) values = model%initial_temperature(nodes)
  end function initial_temperatures


  !> The increments to read: the state at the start of the step (0: before the first), then those of the step by their time.
  subroutine choose_frames(results, frames, field, step, is_last_alone, chosen, error)
    type(global_results_type), intent(in) :: results
    type(global_frame_type), intent(in) :: frames(:)
    integer, intent(in) :: field, step
    logical, intent(in) :: is_last_alone
    integer, allocatable, intent(out) :: chosen(:)   !< indices into frames; 0: the state before the first step
    type(error_type), allocatable, intent(out) :: error
    character(13) :: what
    integer :: k, before
    real(DP) :: last
    what = merge('displacements', 'temperatures ', field == GLOBAL_DISPLACEMENT)
    if (size(frames) == 0) then
      call set_error(error, EXIT_SETUP, 'The file ' // results%path // ' has no ' // trim(what) // ': request them in the ' // &
        'global deck by *NODE FILE, ' // trim(merge('U ', 'NT', field == GLOBAL_DISPLACEMENT)) // '.')
      return
    end if
    if (step < 0) then
      chosen = pack([(k, k=1, size(frames))], frames%data_set == -step)
      if (size(chosen) > 0) chosen = chosen(1:1)
      if (size(chosen) == 0) call set_error(error, EXIT_SETUP, 'The file ' // results%path // ' has no data set ' // &
        to_text(-step) // ' with ' // trim(what) // '; its data sets are ' // to_text(frames(1)%data_set) // ' to ' // &
        to_text(frames(size(frames))%data_set) // '.')
      return
    end if
    allocate (chosen(0))
    before = 0
    last = 0
    do k = 1, size(frames)
      if (frames(k)%step < step) before = k
      if (frames(k)%step /= step) cycle
      if (frames(k)%step_time <= last * (1 + TOL_STOP_TIME)) cycle
      last = frames(k)%step_time
      chosen = [chosen, k]
    end do
    if (size(chosen) == 0) then
      call set_error(error, EXIT_SETUP, 'The file ' // results%path // ' has no ' // trim(what) // ' of step ' // to_text(step) // &
        '; its steps are ' // to_text(max(1, minval(frames%step))) // ' to ' // to_text(maxval(frames%step)) // '.')
      return
    end if
    if (is_last_alone) then
      chosen = chosen(size(chosen):)
      return
    end if
    if (before > 0) then
      if (frames(before)%step /= step - 1) before = 0
    end if
    if (before == 0 .and. step > 1) then
      call set_error(error, EXIT_SETUP, 'The file ' // results%path // ' has no ' // trim(what) // ' of step ' // &
        to_text(step - 1) // ', where step ' // to_text(step) // ' begins: request them in that step, too.')
      return
    end if
    chosen = [before, chosen]
  end subroutine choose_frames


  !> The field at the driven nodes in one increment.
  subroutine interpolate_frame(model, results, driven, field, frame, is_nlgeom, values, error)
    type(model_type), intent(in) :: model
    type(global_results_type), intent(inout) :: results
    type(driven_nodes_type), intent(in) :: driven
    integer, intent(in) :: field                     !< GLOBAL_...
    type(global_frame_type), intent(in) :: frame
    logical, intent(in) :: is_nlgeom                 !< rotations are finite
    real(DP), allocatable, intent(out) :: values(:, :)   !< (6 or 1, nodes) displacements and rotations, temperatures
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: nodal(:, :)
    logical, allocatable :: is_given(:)
    integer :: k, width
    call read_global_field(results, field, frame, nodal, is_given, error)
    if (allocated(error)) return
    width = merge(3, 1, field == GLOBAL_DISPLACEMENT)
    allocate (values(merge(6, 1, field == GLOBAL_DISPLACEMENT), size(driven%nodes)), source=0.0_DP)
    do k = 1, size(driven%nodes)
      associate (at => driven%located(k))
        if (.not. all(is_given(at%nodes(:at%n_nodes)))) then
          call set_error(error, EXIT_SETUP, 'The file ' // results%path // ' has the results of some nodes only, and the element ' &
            // 'around node ' // to_text(model%mesh%node_label(driven%nodes(k))) // ' has others: request them without NSET.')
          return
        end if
        values(:width, k) = matmul(nodal(:width, at%nodes(:at%n_nodes)), at%weights(:at%n_nodes))
        if (field == GLOBAL_DISPLACEMENT) call add_director_motion(driven%directors(k), nodal(:3, at%nodes(:at%n_nodes)), &
          is_nlgeom, values(:, k))
      end associate
    end do
  end subroutine interpolate_frame


  !> Lets the temperatures that follow driven ones start where these end.
  subroutine chain_temperatures(model)
    type(model_type), intent(inout) :: model
    real(DP), allocatable :: now(:)                  ! (nodes and field variables) [temperature]
    logical, allocatable :: is_driven(:)
    real(DP) :: total_time, period
    integer :: i, k, n
    if (.not. any([(any(model%steps(i)%temperatures%global_step /= 0), i=1, size(model%steps))])) return
    n = model%mesh%n_nodes
    do i = 1, size(model%steps)
      n = maxval([n, model%steps(i)%temperatures%node])
    end do
    allocate (now(n), source=0.0_DP)
    if (allocated(model%initial_temperature)) now(:size(model%initial_temperature)) = model%initial_temperature
    allocate (is_driven(size(now)), source=.false.)
    total_time = 0
    do i = 1, size(model%steps)
      period = model%steps(i)%period
      if (model%steps(i)%is_total_time_set) total_time = model%steps(i)%clock
      associate (origin => model%origin)
        if (allocated(origin%path) .and. origin%is_step_ended .and. origin%label%step == i) period = origin%label%step_time
      end associate
      total_time = total_time + period
      do k = 1, size(model%steps(i)%temperatures)
        associate (load => model%steps(i)%temperatures(k))
          if (load%global_step /= 0) is_driven(load%node) = .true.
          if (is_driven(load%node) .and. load%amplitude == 0) load%start = merge(now(load%node), load%end, &
            load%is_from_current .or. load%global_step /= 0)
          if (load%global_step /= 0 .and. load%amplitude > 0) call start_from(now(load%node), load, &
            model%amplitudes(load%amplitude))
          now(load%node) = load_value(load, model%amplitudes, period, total_time, model%steps(i)%period)
        end associate
      end do
    end do
  end subroutine chain_temperatures


  !> Sets the first value of a history.
  pure subroutine start_from(value, load, amplitude)
    real(DP), intent(in) :: value
    class(load_type), intent(inout) :: load
    type(amplitude_type), intent(inout) :: amplitude
    if (.not. abs(load%end) > 0) load%end = value    ! all others are 0
    if (abs(load%end) > 0) amplitude%factor(1) = value / load%end
  end subroutine start_from

end module amontons_submodel_results
