!> Reads the cards of the steps, STEP to END STEP, into the list of steps, each with all loads and settings in force.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! MODEL CHANGE, TYPE=ELEMENT, CHANGE SOLID SECTION, CHANGE MATERIAL and EQUATION, REMOVE: the changes of the model by a step.
module amontons_deck_steps
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, line_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word, ENTRY_REJECTED
  use amontons_deck_initial_conditions, only: active_temperatures_type, init_temperatures, propagate_temperatures, &
    read_temperature, &
    get_step_temperatures, truncate_temperatures
  use amontons_deck_loads, only: read_boundary, read_cload, read_dload
  use amontons_load_propagation, only: active_loads_type, init_active_loads, propagate_loads, set_node_pressures, &
    get_step_loads, truncate_loads
  use amontons_deck_contact, only: read_contact_change
  use amontons_deck_output, only: output_requests_type, begin_output, read_output_card, set_output_times
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, read_integer, check_n_fields, &
    check_no_data, is_card, nodes_of_field, elements_of_field
  use amontons_deck_procedures, only: read_static, read_creep_tolerance, read_riks, read_dynamic, read_damping, check_path_step, &
    check_distributed_solvers
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_controls, only: controls_type, calculix_controls, gradient_controls_type, PRECONDITIONER_NODAL, &
    PRECONDITIONER_DIAGONAL, PRECONDITIONER_TWO_LEVEL, PRECONDITIONER_FACTOR, PRECONDITIONER_AMG
  use amontons_steps, only: step_type, path_end_type, LINE_SEARCH_NONE, LINE_SEARCH_ALL, LINE_SEARCH_GLOBAL, &
    LINE_SEARCH_NODAL, LINE_SEARCH_AUTO, TANGENT_EXACT, TANGENT_SYMMETRIC, TANGENT_LAGGED, SOLVER_AUTO, SOLVER_ITERATIVE, &
    SOLVER_GRADIENTS, SOLVER_GAMG, SOLVER_HYPRE, SOLVER_MUMPS, &
    INTERFACE_AUTO, INTERFACE_DENSE, INTERFACE_SKIN
  use amontons_deck_user_elements, only: check_user_element_step
  use amontons_loads, only: concentrated_type
  use amontons_containers, only: integer_list_type
  use amontons_text, only: to_text, parse_integer, parse_real, is_one_of, NUMBER_OK, plural, verb
  use amontons_mpc_data, only: MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE
  use amontons_deck_materials, only: read_plastic
  use amontons_materials, only: material_type, is_linear_elastic, CREEP_NONE, INELASTIC_NONE
  use amontons_element_kinds, only: element_kind_type, element_kind, KIND_SPRINGA, FAMILY_SOLID, FAMILY_PLANE_STRAIN, &
    FAMILY_PLANE_STRESS, FAMILY_AXISYMMETRIC
  implicit none
  private
  public :: read_steps

  !> The state of the reader of the steps.
  type :: step_reader_type
    type(step_type) :: step                      !< present step; settings that persist stay in it for the next one
    type(active_temperatures_type) :: thermal
    type(active_loads_type) :: active_loads
    type(output_requests_type) :: output
    type(active_loads_type) :: base                  !< loads before the first PERTURBATION step
    type(active_temperatures_type) :: unperturbed_temperatures           !< temperatures before it
    integer :: n = 0                             !< steps begun
    real(DP) :: total_time = 0                   !< at the end of the step before [time]
    logical :: has_static = .false.
    logical :: has_rejected_card = .false.             !< a card of this step, possibly its procedure, is rejected
    logical :: is_open = .false.
    integer :: interaction = 0                   !< interaction of the last CHANGE card
    integer :: material = 0                      !< copy made by the last CHANGE MATERIAL
    integer :: follower_line = 0                 !< of the last *CLOAD, FOLLOWER; 0: none
  end type step_reader_type

contains

  !> Reads all steps, and the BOUNDARY cards of the model, which are in force from the first step.
  subroutine read_steps(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(step_reader_type) :: progress
    integer :: c, n_steps
    n_steps = 0
    if (reader%cards%n_cards > 0) n_steps = maxval(reader%step_of_card)
    allocate (model%steps(n_steps))
    if (n_steps == 0) call report_error(reader, 0, 'The deck has no step: there is no *STEP card.')
    call init_active_loads(model, progress%active_loads)
    call init_temperatures(model, progress%thermal)
    progress%step%controls = default_controls(reader%dialect)
    if (reader%dialect == DIALECT_CALCULIX) call turn_on_nlgeom(reader, model, progress%step)
    allocate (progress%step%prints(0))
    do c = 1, reader%cards%n_cards
      if (reader%step_of_card(c) == 0) then
        if (progress%n == 0 .and. is_card(reader, c, 'BOUNDARY')) call read_boundary(reader, model, c, 0, &
          progress%active_loads)
        if (progress%n == 0 .and. is_card(reader, c, 'CONTROLS')) call read_controls(reader, c, progress%step%controls)
        cycle
      end if
      if (is_card(reader, c, 'STEP')) then
        call close_step(reader, model, c, progress)
        call open_step(reader, model, c, progress)
      else
        call read_step_card(reader, model, c, progress)
      end if
    end do
    call close_step(reader, model, reader%cards%n_cards, progress)
  end subroutine read_steps


  !> The calculix dialect: some cards make all steps geometrically nonlinear, as they do in CalculiX 2.20.
  subroutine turn_on_nlgeom(reader, model, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(step_type), intent(inout) :: step
    character(*), parameter :: NLGEOM_CARDS = 'HYPERELASTIC|HYPERFOAM|DEFORMATION PLASTICITY|GAP CONDUCTANCE'
    logical :: has_curved
    integer :: c
    has_curved = any(model%nonlinear_mpcs%kind == MPC_PLANE .or. model%nonlinear_mpcs%kind == MPC_STRAIGHT .or. &
      model%nonlinear_mpcs%kind == MPC_DISTANCE) .or. any(model%springs%is_distance_limit)
    do c = 1, reader%cards%n_cards
      if (.not. (is_one_of(reader%cards%cards(c)%key, NLGEOM_CARDS) .or. (has_curved .and. is_card(reader, c, 'MPC')))) cycle
      step%is_nlgeom = .true.
      call report_note(reader, reader%cards%cards(c)%line, 'This card turns NLGEOM on for all steps, as in CalculiX; *STEP, ' // &
        'NLGEOM=NO turns it off.')
      return
    end do
  end subroutine turn_on_nlgeom


  !> The controls of a dialect before any CONTROLS card.
  pure function default_controls(dialect) result(controls)
    integer, intent(in) :: dialect
    type(controls_type) :: controls
    if (dialect == DIALECT_CALCULIX) controls = calculix_controls()
  end function default_controls


  !> STEP: title, NLGEOM, INC, AMPLITUDE.
  subroutine open_step(reader, model, c, progress)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_reader_type), intent(inout) :: progress
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    real(DP) :: period
    integer :: status
    logical :: is_step
    call open_card(reader, c, parameters, row)
    period = progress%step%period                ! of the step before
    progress%n = progress%n + 1
    progress%is_open = .true.
    progress%has_static = .false.
    progress%has_rejected_card = .false.
    call begin_output(progress%output)
    progress%step%title = ''
    do while (next_row(reader%cards, row))
      if (progress%step%title /= '') progress%step%title = progress%step%title // ' '
      progress%step%title = progress%step%title // trim(adjustl(line_text(reader%cards, row%line)))
    end do
    if (has_parameter(parameters, 'NLGEOM')) progress%step%is_nlgeom = parameter_word(parameters, 'NLGEOM', 'YES') == &
      'YES'
    call begin_perturbation(parameters, progress)
    progress%step%max_increments = 100
    if (has_parameter(parameters, 'INC')) then
      call parse_integer(parameter_text(parameters, 'INC'), progress%step%max_increments, status)
      if (status == NUMBER_OK .and. progress%step%max_increments < 1) call report_error(reader, &
        reader%cards%cards(c)%line, 'INC must be at least 1.')
    end if
    progress%step%is_direct = .false.
    progress%step%is_total_time_set = .false.
    if (allocated(progress%step%is_reactivated)) deallocate (progress%step%is_reactivated)
    if (allocated(progress%step%is_relieved)) deallocate (progress%step%is_relieved)
    if (allocated(progress%step%interference)) deallocate (progress%step%interference, progress%step%is_shrink_fit)
    progress%interaction = 0
    progress%material = 0
    progress%step%dt_initial = 1
    progress%step%period = 1
    progress%step%dt_min = 1.0e-6_DP
    progress%step%dt_max = 1
    progress%step%has_creep = .false.
    progress%step%is_dynamic = .false.
    progress%step%is_riks = .false.
    progress%step%path_end = path_end_type()
    is_step = parameter_word(parameters, 'AMPLITUDE', default_amplitude(reader, c)) == 'STEP'
    call propagate_loads(model, period, progress%total_time, is_step, progress%active_loads)
    call propagate_temperatures(model, period, progress%total_time, is_step, progress%thermal)
  end subroutine open_step


  !> How loads without an amplitude act by default: in full at once in VISCO steps, where time is real, else linearly over the step.
  !! Sources: table of default amplitudes in Abaqus's manual; CalculiX's manual, section "*VISCO".
  pure function default_amplitude(reader, c) result(word)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the STEP card
    character(4) :: word
    integer :: i
    word = 'RAMP'
    do i = c + 1, reader%cards%n_cards
      if (is_card(reader, i, 'STEP') .or. is_card(reader, i, 'ENDSTEP')) return
      if (is_card(reader, i, 'VISCO')) word = 'STEP'
    end do
  end function default_amplitude


  !> PERTURBATION: the loads of such a step end with it.
  subroutine begin_perturbation(parameters, progress)
    type(parameter_type), intent(in) :: parameters(:)
    type(step_reader_type), intent(inout) :: progress
    if (progress%step%is_perturbation) then
      progress%active_loads = progress%base
      progress%thermal = progress%unperturbed_temperatures
      progress%active_loads%step = progress%n - 1
      progress%thermal%step = progress%n - 1
    else
      progress%base = progress%active_loads
      progress%unperturbed_temperatures = progress%thermal
    end if
    progress%step%is_perturbation = has_parameter(parameters, 'PERTURBATION')
  end subroutine begin_perturbation


  !> Adds the complete step to the model.
  subroutine close_step(reader, model, c, progress)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< a card after the step, or the last one
    type(step_reader_type), intent(inout) :: progress
    integer :: k, missing
    logical :: is_after_path
    if (.not. progress%is_open) return
    progress%is_open = .false.
    k = c
    do while (.not. (is_card(reader, k, 'STEP') .and. reader%step_of_card(k) == progress%n))
      k = k - 1
    end do
    if (.not. (progress%has_static .or. progress%has_rejected_card)) call report_error(reader, reader%cards%cards(k)%line, &
      'This step has no *STATIC, *VISCO or *DYNAMIC card.')
    call set_node_pressures(progress%active_loads, missing)
    if (missing > 0) call report_error(reader, reader%cards%cards(k)%line, 'In this step no displacement 2 with a value is ' // &
      'prescribed at the node ' // to_text(model%mesh%node_label(missing)) // ': it is the pressure of a load P1NP to P6NP.')
    call get_step_loads(progress%active_loads, progress%step%prescribed, progress%step%concentrated, &
      progress%step%distributed)
    if (progress%step%is_nlgeom .and. any(progress%step%concentrated%is_follower)) call check_follower_forces(reader, model, &
      progress%follower_line, progress%step%concentrated)
    if (progress%step%is_nlgeom .and. any(progress%step%distributed%is_follower)) call report_error(reader, &
      reader%cards%cards(k)%line, 'Under NLGEOM a traction keeps its direction and its size per undeformed area: its card ' // &
      'needs FOLLOWER=NO, CONSTANT RESULTANT=YES.')
    call get_step_temperatures(progress%thermal, progress%step%temperatures)
    call set_output_times(reader, progress%output, progress%total_time, progress%step)
    if (progress%n == reader%truncated_step) then
      call truncate_loads(progress%active_loads, reader%truncated_time / progress%step%period)
      call truncate_temperatures(progress%thermal, reader%truncated_time / progress%step%period)
      progress%step%period = reader%truncated_time
    end if
    is_after_path = progress%n > 1
    if (is_after_path) is_after_path = model%steps(progress%n - 1)%is_riks
    call check_path_step(reader, reader%cards%cards(k)%line, progress%active_loads%is_step, is_after_path, progress%step)
    if (allocated(model%user_elements)) call check_user_element_step(reader, &
      reader%cards%cards(k)%line, model%user_elements, progress%step)
    progress%step%number = progress%n
    model%steps(progress%n) = progress%step
    progress%total_time = progress%total_time + progress%step%period
  end subroutine close_step


  !> CLOAD: notes the line of a force with FOLLOWER, which persists in later steps.
  subroutine note_follower(reader, c, line)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(inout) :: line               !< of the last one; 0: none
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    call open_card(reader, c, parameters, row)
    if (has_parameter(parameters, 'FOLLOWER')) line = reader%cards%cards(c)%line
  end subroutine note_follower


  !> Reports the first node with a FOLLOWER force that has no finite rotation.
  subroutine check_follower_forces(reader, model, line, forces)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: line                  !< of the last card with FOLLOWER
    type(concentrated_type), intent(in) :: forces(:)
    logical :: has_rotation, is_mean
    integer :: i
    do i = 1, size(forces)
      if (.not. forces(i)%is_follower) cycle
      has_rotation = .false.
      if (allocated(model%rotation_of)) has_rotation = model%rotation_of(forces(i)%node) > 0
      is_mean = .false.
      if (allocated(model%distributing_couplings)) is_mean = any(model%distributing_couplings%reference == forces(i)%node)
      if (has_rotation .and. .not. is_mean) cycle
      if (is_mean) then
        call report_error(reader, line, 'FOLLOWER turns a force with its node under NLGEOM; the rotation of a *DISTRIBUTING ' // &
          'coupling is a small one. Use *KINEMATIC, or leave out FOLLOWER.')
      else
        call report_error(reader, line, 'FOLLOWER turns a force with its node under NLGEOM, which the node ' // &
          to_text(model%mesh%node_label(forces(i)%node)) // ' cannot: nodes of shells and beams and reference nodes of rigid ' // &
          'bodies and couplings have rotations. Leave out FOLLOWER, or give a pressure on faces, which turns with them.')
      end if
      return
    end do
  end subroutine check_follower_forces


  !> One card of a step.
  subroutine read_step_card(reader, model, c, progress)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_reader_type), intent(inout) :: progress
    if (reader%cards%cards(c)%entry == 0) return
    associate (entry => reader%table%entries(reader%cards%cards(c)%entry))
      if (entry%status == ENTRY_REJECTED) progress%has_rejected_card = .true.
      select case (entry%key)
      case ('STATIC', 'VISCO')
        progress%has_static = .true.
        progress%step%has_creep = entry%key == 'VISCO'
        call read_static(reader, c, progress%step)
        call read_creep_tolerance(reader, model, c, progress%step)
        call read_damping(reader, c, model%dialect, progress%step)
        call read_riks(reader, model, c, progress%step)
        call set_total_time(reader, c, progress)
      case ('DYNAMIC')
        progress%has_static = .true.
        call read_dynamic(reader, model, c, progress%step)
        call set_total_time(reader, c, progress)
      case ('NOANALYSIS')
        progress%has_static = .true.
        model%is_checked_only = .true.
      case ('CONTROLS')
        call read_controls(reader, c, progress%step%controls)
      case ('LINESEARCH')
        call read_line_search(reader, c, progress%step)
      case ('SOLVERCONTROLS')
        call read_gradient_controls(reader, c, progress%step%controls%gradients)
      case ('BOUNDARY')
        call read_boundary(reader, model, c, progress%n, progress%active_loads)
      case ('CLOAD')
        call read_cload(reader, model, c, progress%active_loads)
        call note_follower(reader, c, progress%follower_line)
      case ('TEMPERATURE', 'FIELD')
        call read_temperature(reader, model, c, progress%thermal)
      case ('DLOAD', 'DSLOAD')
        call read_dload(reader, model, c, progress%active_loads)
      case ('EQUATION')
        call read_equation_removal(reader, model, c, progress%n)
      case ('CHANGEMATERIAL')
        call read_material_change(reader, model, c, progress%step, progress%material)
      case ('CHANGEPLASTIC')
        call read_plastic_change(reader, c, model, progress%material)
      case ('CHANGESOLIDSECTION')
        call read_section_change(reader, model, c, progress%step)
      case ('CHANGEFRICTION', 'CHANGESURFACEBEHAVIOR', 'FRICTION', 'SURFACEBEHAVIOR', 'MODELCHANGE', &
        'CONTACTINTERFERENCE')
        if (is_element_change(reader, c)) then
          call read_element_change(reader, model, c, progress%step)
          return
        end if
        call read_contact_change(reader, model, c, progress%interaction, progress%step)
      case default
        call read_output_card(reader, model, c, progress%output, progress%step)
      end select
    end associate
  end subroutine read_step_card


  !> TIME RESET: the step ends at the total time at which it starts. TOTAL TIME AT START: it starts at this one.
  subroutine set_total_time(reader, c, progress)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(step_reader_type), intent(inout) :: progress
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    real(DP) :: clock
    integer :: status
    call open_card(reader, c, parameters, row)
    clock = progress%total_time
    if (has_parameter(parameters, 'TOTAL TIME AT START')) then
      call parse_real(parameter_text(parameters, 'TOTAL TIME AT START'), clock, status)
      if (status /= NUMBER_OK) return            ! reported when the card was checked
    end if
    if (has_parameter(parameters, 'TIME RESET')) clock = clock - progress%step%period
    progress%step%is_total_time_set = abs(clock - progress%total_time) > 0
    progress%step%clock = clock
    progress%total_time = clock
  end subroutine set_total_time


  !> CONTROLS: CalculiX's slots; a blank field keeps its value.
  subroutine read_controls(reader, c, controls)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(controls_type), intent(inout) :: controls
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(gradient_controls_type) :: gradients
    character(:), allocatable :: what
    logical :: is_row
    call open_card(reader, c, parameters, row)
    what = parameter_word(parameters, 'PARAMETERS', '')
    if (has_parameter(parameters, 'RESET')) then
      gradients = controls%gradients               ! of another card
      controls = default_controls(reader%dialect)
      controls%gradients = gradients
    end if
    if (what == '' .and. .not. (has_parameter(parameters, 'RESET') .or. has_parameter(parameters, 'ANALYSIS'))) call &
      report_error(reader, row%line, '*CONTROLS needs PARAMETERS=TIME INCREMENTATION/FIELD/LINE SEARCH/GAP/CONTACT or ' // &
      'RESET.')
    if (.not. is_one_of(parameter_word(parameters, 'FIELD', 'DISPLACEMENT'), 'DISPLACEMENT|GLOBAL')) return   ! no such field
    is_row = next_row(reader%cards, row)
    select case (what)
    case ('TIMEINCREMENTATION')
      if (is_row) call read_counts(reader, row, controls)
      if (is_row) is_row = next_row(reader%cards, row)
      if (is_row) call read_factors(reader, row, controls)
      if (is_row) is_row = next_row(reader%cards, row)
    case ('FIELD')
      if (is_row) call read_tolerances(reader, row, controls)
      if (is_row) is_row = next_row(reader%cards, row)   ! the second line of Abaqus and CalculiX is skipped
      if (is_row) is_row = next_row(reader%cards, row)
    case ('LINESEARCH')
      if (is_row) call read_step_lengths(reader, row, controls)
      if (is_row) is_row = next_row(reader%cards, row)
    case ('GAP')
      if (is_row) call read_gap_tolerance(reader, row, controls)
      if (is_row) is_row = next_row(reader%cards, row)
    case ('CONTACT')
      call report_note(reader, reader%cards%cards(c)%line, 'These numbers are for contact by springs; contact is exact ' // &
        'here and does not use them.')
      is_row = .false.
    case ('CONSTRAINTS')
      call report_note(reader, reader%cards%cards(c)%line, 'Constraints hold exactly; these tolerances have no effect.')
      is_row = .false.
    end select
    if (is_row) call check_no_data(reader, row)
  end subroutine read_controls


  !> I0, IR, IP, IC, IL, IG, -, IA: all at least 1.
  subroutine read_counts(reader, row, controls)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(controls_type), intent(inout) :: controls
    character(2), parameter :: NAMES(8) = ['I0', 'IR', 'IP', 'IC', 'IL', 'IG', 'IS', 'IA']
    integer :: counts(8), i
    logical :: is_ok
    is_ok = .true.
    counts = [controls%i_0, controls%i_r, controls%i_p, controls%i_c, controls%i_l, controls%i_g, 1, controls%i_a]
    call check_n_fields(reader, row, 10)
    do i = 1, 8
      call read_integer(reader, row, i, NAMES(i), counts(i), is_ok, default=(counts(i)))
    end do
    if (.not. is_ok) return
    if (any(counts([1, 2, 3, 4, 5, 6, 8]) < 1)) then
      call report_error(reader, row%line, 'The numbers of iterations and cut-backs must be at least 1.')
      return
    end if
    controls%i_0 = counts(1)
    controls%i_r = counts(2)
    controls%i_p = counts(3)
    controls%i_c = counts(4)
    controls%i_l = counts(5)
    controls%i_g = counts(6)
    controls%i_a = counts(8)
  end subroutine read_counts


  !> DF, DC, DB, DA, -, -, DD: the first four in (0, 1), DB and DA also 1; the last at least 1.
  subroutine read_factors(reader, row, controls)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(controls_type), intent(inout) :: controls
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 8)
    call read_real(reader, row, 1, 'DF', controls%d_f, is_ok, default=(controls%d_f))
    call read_real(reader, row, 2, 'DC', controls%d_c, is_ok, default=(controls%d_c))
    call read_real(reader, row, 3, 'DB', controls%d_b, is_ok, default=(controls%d_b))
    call read_real(reader, row, 4, 'DA', controls%d_a, is_ok, default=(controls%d_a))
    call read_real(reader, row, 7, 'DD', controls%d_d, is_ok, default=(controls%d_d))
    if (.not. is_ok) return
    if (any([controls%d_f, controls%d_c] <= 0) .or. any([controls%d_f, controls%d_c] >= 1) .or. any([controls%d_b, &
      controls%d_a] <= 0) .or. any([controls%d_b, controls%d_a] > 1) .or. controls%d_d < 1) call report_error(reader, row%line, &
      'The factors must be 0 < DF < 1, 0 < DC < 1, 0 < DB <= 1, 0 < DA <= 1, DD >= 1.')
  end subroutine read_factors


  !> Rn, Cn, -, -, Rp, -, -, Rl: all positive.
  subroutine read_tolerances(reader, row, controls)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(controls_type), intent(inout) :: controls
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 8)
    call read_real(reader, row, 1, 'Rn', controls%r_n, is_ok, default=(controls%r_n))
    call read_real(reader, row, 2, 'Cn', controls%c_n, is_ok, default=(controls%c_n))
    call read_real(reader, row, 5, 'Rp', controls%r_p, is_ok, default=max(controls%r_p, controls%r_n))
    call read_real(reader, row, 8, 'Rl', controls%r_l, is_ok, default=(controls%r_l))
    if (is_ok .and. any([controls%r_n, controls%c_n, controls%r_p, controls%r_l] <= 0)) call report_error(reader, &
      row%line, 'The tolerances must be positive.')
  end subroutine read_tolerances


  !> -, s max, s min: 0 < s min <= s max.
  subroutine read_step_lengths(reader, row, controls)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(controls_type), intent(inout) :: controls
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 5)
    call read_real(reader, row, 2, 's max', controls%s_max, is_ok, default=(controls%s_max))
    call read_real(reader, row, 3, 's min', controls%s_min, is_ok, default=(controls%s_min))
    if (is_ok .and. (controls%s_min <= 0 .or. controls%s_max < controls%s_min)) call report_error(reader, row%line, &
      'The step lengths must be 0 < s min <= s max.')
  end subroutine read_step_lengths


  !> The penetration allowed at a closed node over the edge length of its facet (specific to Amontons).
  subroutine read_gap_tolerance(reader, row, controls)
    type(reader_type), intent(inout) :: reader
    type(data_row_type), intent(in) :: row
    type(controls_type), intent(inout) :: controls
    logical :: is_ok
    is_ok = .true.
    call check_n_fields(reader, row, 1)
    call read_real(reader, row, 1, 'penetration over the edge length', controls%gap_tolerance, is_ok, &
      default=(controls%gap_tolerance))
    if (is_ok .and. controls%gap_tolerance <= 0) call report_error(reader, row%line, &
      'The penetration allowed must be positive.')
  end subroutine read_gap_tolerance


  !> LINE SEARCH, TYPE=..., DIRECTION=..., INTERFACE=...
  subroutine read_line_search(reader, c, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    call open_card(reader, c, parameters, row)
    select case (parameter_word(parameters, 'TYPE', ''))
    case ('NONE')
      step%line_search = LINE_SEARCH_NONE
    case ('ALL')
      step%line_search = LINE_SEARCH_ALL
    case ('GLOBAL')
      step%line_search = LINE_SEARCH_GLOBAL
    case ('NODAL')
      step%line_search = LINE_SEARCH_NODAL
    case ('AUTO')
      step%line_search = LINE_SEARCH_AUTO
    end select
    select case (parameter_word(parameters, 'DIRECTION', ''))
    case ('SYMMETRIC')
      step%direction = TANGENT_SYMMETRIC
    case ('LAGGED')
      step%direction = TANGENT_LAGGED
    case default
      step%direction = TANGENT_EXACT
    end select
    select case (parameter_word(parameters, 'INTERFACE', ''))
    case ('DENSE')
      step%interface = INTERFACE_DENSE
    case ('SKIN')
      step%interface = INTERFACE_SKIN
    case default
      step%interface = INTERFACE_AUTO
    end select
  end subroutine read_line_search


  !> SOLVER CONTROLS, PRECONDITIONER=...: of conjugate gradients.
  subroutine read_gradient_controls(reader, c, gradients)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(gradient_controls_type), intent(inout) :: gradients
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    if (has_parameter(parameters, 'RESET')) gradients = gradient_controls_type()
    select case (parameter_word(parameters, 'PRECONDITIONER', ''))
    case ('NODAL')
      gradients%preconditioner = PRECONDITIONER_NODAL
    case ('DIAGONAL')
      gradients%preconditioner = PRECONDITIONER_DIAGONAL
    case ('TWOLEVEL')
      gradients%preconditioner = PRECONDITIONER_TWO_LEVEL
    case ('FACTOR')
      gradients%preconditioner = PRECONDITIONER_FACTOR
    case ('AMG')
      gradients%preconditioner = PRECONDITIONER_AMG
      call check_distributed_solvers(reader, c, 'PRECONDITIONER=AMG is multigrid', &
        'TWO LEVEL is the preconditioner nearest to it.')
    end select
    if (.not. next_row(reader%cards, row)) return
    is_ok = .true.
    call read_real(reader, row, 1, 'residual of a round', gradients%reduction, is_ok, default=(gradients%reduction))
    call read_integer(reader, row, 2, 'most iterations', gradients%max_iterations, is_ok, default=(gradients%max_iterations))
    call read_integer(reader, row, 3, 'most rounds', gradients%max_rounds, is_ok, default=(gradients%max_rounds))
    if (.not. is_ok) return
    if (gradients%reduction <= 0.0_DP .or. gradients%reduction >= 1.0_DP) call report_error(reader, row%line, &
      'The residual of a round is a fraction of that at its start: between 0 and 1, without them.')
    if (gradients%max_iterations < 1 .or. gradients%max_rounds < 1) call report_error(reader, row%line, &
      'Iterations and rounds are counts: 1 or more.')
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
  end subroutine read_gradient_controls


  !> Whether a card is MODEL CHANGE, TYPE=ELEMENT.
  logical function is_element_change(reader, c)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    is_element_change = is_card(reader, c, 'MODELCHANGE')
    if (.not. is_element_change) return
    call open_card(reader, c, parameters, row)
    is_element_change = parameter_word(parameters, 'TYPE', 'ELEMENT') == 'ELEMENT'
  end function is_element_change


  !> MODEL CHANGE, TYPE=ELEMENT: removes elements or adds them again, from this step on.
  subroutine read_element_change(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: elements(:)
    integer :: k, n_same
    logical :: is_removal, is_free
    call open_card(reader, c, parameters, row)
    is_removal = has_parameter(parameters, 'REMOVE')
    if (has_parameter(parameters, 'MECHSTRAINTORESIDUAL') .and. .not. (has_parameter(parameters, 'ADD') .or. is_removal)) then
      call read_relief(reader, model, c, step)
      return
    else if (has_parameter(parameters, 'ADD') .eqv. is_removal) then
      call report_error(reader, reader%cards%cards(c)%line, '*MODEL CHANGE needs either ADD or REMOVE.')
      return
    end if
    is_free = parameter_word(parameters, 'ADD', 'STRAINFREE') == 'STRAINFREE'
    if (.not. allocated(step%is_inactive)) allocate (step%is_inactive(model%mesh%n_elements), source=.false.)
    if (.not. allocated(step%is_reactivated)) allocate (step%is_reactivated(model%mesh%n_elements), source=.false.)
    call read_changed_elements(reader, model, c, row, elements)
    n_same = 0
    do k = 1, size(elements)
      associate (e => elements(k))
        if (step%is_inactive(e) .eqv. is_removal) n_same = n_same + 1
        if (.not. is_removal .and. is_free) step%is_reactivated(e) = step%is_reactivated(e) .or. step%is_inactive(e)
        step%is_inactive(e) = is_removal
      end associate
    end do
    if (n_same > 0) call report_note(reader, reader%cards%cards(c)%line, plural(n_same, 'element') // trim(merge( &
      ' had been taken out before.          ', ' had not been taken out, or are back.', is_removal)))
    if (all(step%is_inactive)) call report_error(reader, reader%cards%cards(c)%line, 'No element is left in the model.')
  end subroutine read_element_change


  !> The elements that the rows of a MODEL CHANGE card name, one row after the other.
  subroutine read_changed_elements(reader, model, c, row, elements)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(data_row_type), intent(inout) :: row    !< as open_card gives it
    integer, allocatable, intent(out) :: elements(:)
    type(integer_list_type) :: list
    integer, allocatable :: named(:)
    integer :: i, k, n
    logical :: is_ok
    n = 0
    do while (next_row(reader%cards, row))
      do i = 1, row%n
        is_ok = .true.
        call elements_of_field(reader, model%mesh, row, i, named, is_ok)
        n = n + 1
        if (.not. is_ok) cycle
        do k = 1, size(named)
          call list%add(named(k))
        end do
      end do
    end do
    elements = list%trimmed()
    if (n == 0) call report_error(reader, reader%cards%cards(c)%line, '*MODEL CHANGE, TYPE=ELEMENT needs data lines with ' // &
      'elements or element sets.')
  end subroutine read_changed_elements


  !> MODEL CHANGE, TYPE=ELEMENT, MECHSTRAINTORESIDUAL: the stress of elements goes, the strain that they have stays without one.
  subroutine read_relief(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: elements(:)
    integer :: k, n_wrong
    call open_card(reader, c, parameters, row)
    if (.not. allocated(step%is_relieved)) allocate (step%is_relieved(model%mesh%n_elements), source=.false.)
    call read_changed_elements(reader, model, c, row, elements)
    step%is_relieved(elements) = .true.
    n_wrong = count([(.not. can_be_relieved(model, step, elements(k)), k=1, size(elements))])
    associate (line => reader%cards%cards(c)%line)
      if (reader%dialect /= DIALECT_CALCULIX) call report_error(reader, line, 'MECHSTRAINTORESIDUAL is a parameter of ' // &
        'CalculiX: give the calculix dialect, or ADD=STRAIN FREE to elements taken out before.')
      if (n_wrong > 0) call report_error(reader, line, 'MECHSTRAINTORESIDUAL is for solids with *ELASTIC alone; ' // &
        plural(n_wrong, 'element') // ' here ' // verb(n_wrong, 'is', 'are') // ' no such solid.')
      if (reader%step_of_card(c) == 1) return
      if (step%is_nlgeom .and. .not. model%steps(reader%step_of_card(c) - 1)%is_nlgeom) call report_error(reader, line, 'With ' // &
        'MECHSTRAINTORESIDUAL the step before must have NLGEOM as this one has it: their strains must be the same.')
    end associate
  end subroutine read_relief


  !> Whether an element is a solid whose law is between strain and stress alone.
  pure logical function can_be_relieved(model, step, e)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    integer, intent(in) :: e                     !< element
    type(element_kind_type) :: kind
    integer :: m
    kind = element_kind(model%mesh%kind(e))
    m = model%mesh%material(e)
    if (allocated(step%material)) m = step%material(e)
    can_be_relieved = m > 0 .and. any(kind%family == [FAMILY_SOLID, FAMILY_PLANE_STRAIN, FAMILY_PLANE_STRESS, FAMILY_AXISYMMETRIC])
    if (.not. can_be_relieved) return
    if (allocated(model%structure)) can_be_relieved = model%structure%section(e) == 0
    associate (material => model%materials(m))
      can_be_relieved = can_be_relieved .and. material%has_elastic .and. .not. (allocated(material%isotropic_hardening) .or. &
        allocated(material%kinematic_hardening) .or. material%creep_law /= CREEP_NONE .or. material%is_user .or. &
        material%inelastic_law /= INELASTIC_NONE .or. allocated(material%prony) .or. material%is_user_field .or. &
        material%is_corotational .or. material%has_deformation_plasticity .or. .not. &
        is_linear_elastic(material))
    end associate
  end function can_be_relieved


  !> CHANGE SOLID SECTION: the elements of a set get another material from this step on.
  subroutine read_section_change(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: set, material
    call open_card(reader, c, parameters, row)
    set = reader%element_sets%find(parameter_text(parameters, 'ELSET'))
    material = present_material(model, reader%materials%find(parameter_text(parameters, 'MATERIAL')))
    associate (line => reader%cards%cards(c)%line)
      if (set == 0) call report_error(reader, line, 'There is no element set ''' // parameter_text(parameters, 'ELSET') // '''.')
      if (material == 0) call report_error(reader, line, 'There is no material ''' // parameter_text(parameters, 'MATERIAL') // &
        '''.')
    end associate
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
    if (set == 0 .or. material == 0) return
    if (.not. allocated(step%material)) step%material = model%mesh%material
    associate (members => model%mesh%element_sets(set)%members)
      if (any(model%mesh%kind(members) >= KIND_SPRINGA)) then
        call report_error(reader, reader%cards%cards(c)%line, 'Springs and masses have no material; name solid elements only.')
      else
        step%material(members) = material
      end if
    end associate
  end subroutine read_section_change


  !> The present material of a name: the last copy made by CHANGE MATERIAL.
  pure integer function present_material(model, material) result(last)
    type(model_type), intent(in) :: model
    integer, intent(in) :: material              !< of the MATERIAL card; 0: none
    last = material
    if (material == 0) return
    do last = size(model%materials), material + 1, -1
      if (model%materials(last)%name == model%materials(material)%name) return
    end do
    last = material
  end function present_material


  !> CHANGE MATERIAL: the elements of a material get a copy of it, which the following cards change.
  subroutine read_material_change(reader, model, c, step, copy)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    integer, intent(out) :: copy                 !< index of the copy; 0: an error, already reported
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(material_type) :: changed
    integer :: old
    copy = 0
    call open_card(reader, c, parameters, row)
    old = present_material(model, reader%materials%find(parameter_text(parameters, 'NAME')))
    if (old == 0) then
      call report_error(reader, reader%cards%cards(c)%line, 'There is no material ''' // parameter_text(parameters, &
        'NAME') // '''.')
      return
    end if
    changed = model%materials(old)
    model%materials = [model%materials, changed]
    copy = size(model%materials)
    if (.not. allocated(step%material)) step%material = model%mesh%material
    where (step%material == old) step%material = copy
  end subroutine read_material_change


  !> CHANGE PLASTIC: the hardening curve of a changed material. The accumulated plastic strain is kept.
  subroutine read_plastic_change(reader, c, model, copy)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(model_type), intent(inout) :: model
    integer, intent(in) :: copy                  !< index of the changed material; 0: none
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    logical :: is_moving
    if (copy == 0) return                        ! reported with CHANGE MATERIAL, or for the position of the card
    if (allocated(model%materials(copy)%rate_curves)) then
      call report_error(reader, reader%cards%cards(c)%line, 'The material ''' // model%materials(copy)%name // ''' has *PLASTIC, ' &
        // 'RATE, whose curves cannot be changed; give another material by *CHANGE SOLID SECTION.')
      return
    end if
    call open_card(reader, c, parameters, row)
    is_moving = parameter_word(parameters, 'HARDENING', 'ISOTROPIC') /= 'ISOTROPIC'
    associate (material => model%materials(copy))
      if (merge(allocated(material%kinematic_hardening), allocated(material%isotropic_hardening) .and. .not. &
        allocated(material%cone%value), is_moving)) then
        call read_plastic(reader, c, material)
      else
        call report_error(reader, reader%cards%cards(c)%line, 'The material ''' // material%name // ''' has no *PLASTIC with ' // &
          'this HARDENING, which could be changed.')
      end if
    end associate
  end subroutine read_plastic_change


  !> EQUATION, REMOVE: deletes the equations whose first term is one of these degrees of freedom.
  subroutine read_equation_removal(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: step                  !< the present one
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    integer :: i, first, last, n
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    if (.not. has_parameter(parameters, 'REMOVE')) return   ! reported elsewhere
    if (parameter_word(parameters, 'REMOVE', '') == 'ALL') then
      where (model%equations%deck_dof > 0) model%equations%last_step = min(step - 1, model%equations%last_step)
      return
    end if
    do while (next_row(reader%cards, row))
      is_ok = .true.
      call check_n_fields(reader, row, 3)
      call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
      call read_integer(reader, row, 2, 'first degree of freedom', first, is_ok)
      call read_integer(reader, row, 3, 'last degree of freedom', last, is_ok, default=first)
      if (.not. is_ok) cycle
      n = 0
      do i = 1, size(model%equations)
        associate (equation => model%equations(i))
          if (equation%deck_dof < first .or. equation%deck_dof > last) cycle
          if (equation%deck_dof <= 3 .and. .not. any(nodes == equation%node(1))) cycle
          if (equation%deck_dof > 3 .and. .not. any(model%rotation_of(nodes) == equation%node(1))) cycle
          equation%last_step = min(step - 1, equation%last_step)
          n = n + 1
        end associate
      end do
      if (n == 0) call report_note(reader, row%line, 'No equation has its first term here; none is removed.')
    end do
  end subroutine read_equation_removal

end module amontons_deck_steps
