!> Reads the procedure of a step: STATIC, VISCO and DYNAMIC with their times, damping, and the path of RIKS.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_deck_procedures
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, data_row_type, next_row, field_text
  use amontons_card_schema, only: has_parameter, parameter_text, parameter_word
  use amontons_deck_reader, only: reader_type, open_card, report_error, report_note, read_real, read_integer, check_n_fields, &
    check_no_data, nodes_of_field
  use amontons_deck_loads, only: map_dof
  use amontons_materials, only: CREEP_NONE
  use amontons_distributed_solver, only: has_distributed_solvers
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_steps, only: step_type, path_end_type, SOLVER_AUTO, SOLVER_ITERATIVE, SOLVER_GRADIENTS, SOLVER_GAMG, SOLVER_HYPRE, &
    SOLVER_MUMPS, SOLVER_BDDC
  use amontons_structural_data, only: find_node_directors
  use amontons_text, only: to_text, parse_real, NUMBER_OK
  use amontons_element_kinds, only: KIND_SPRINGA
  implicit none
  private
  public :: read_static, read_creep_tolerance, read_riks, read_dynamic, read_damping, check_path_step, check_distributed_solvers

contains

  !> SOLVER=GAMG, HYPRE, MUMPS or BDDC, which only a program with PETSc has.
  subroutine read_distributed_solver(reader, c, name, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: name
    type(step_type), intent(inout) :: step
    select case (name)
    case ('GAMG')
      step%solver = SOLVER_GAMG
    case ('HYPRE')
      step%solver = SOLVER_HYPRE
    case ('MUMPS')
      step%solver = SOLVER_MUMPS
    case ('BDDC')
      step%solver = SOLVER_BDDC
    case default
      return
    end select
    call check_distributed_solvers(reader, c, 'SOLVER=' // name // ' is a solver', 'Without SOLVER the program chooses.')
  end subroutine read_distributed_solver


  !> An error of the deck that requests what PETSc does from a program without it.
  subroutine check_distributed_solvers(reader, c, what, instead)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(*), intent(in) :: what             !< begins the sentence
    character(*), intent(in) :: instead          !< what this program has, a sentence
    if (.not. has_distributed_solvers()) call report_error(reader, reader%cards%cards(c)%line, what // &
      ' of PETSc, which amontons-mpi has (make MPI=1) and this program has not. ' // instead)
  end subroutine check_distributed_solvers


  !> STATIC: first increment, period, least and largest increment.
  subroutine read_static(reader, c, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    logical :: is_ok, has_row
    call open_card(reader, c, parameters, row)
    step%is_direct = has_parameter(parameters, 'DIRECT') .and. parameter_word(parameters, 'DIRECT', 'YES') /= 'NO'
    step%is_long_term = .not. step%has_creep .and. has_parameter(parameters, 'LONG TERM')
    step%solver = merge(SOLVER_ITERATIVE, SOLVER_AUTO, index(parameter_word(parameters, 'SOLVER', ''), 'ITERATIVE') == 1)
    if (index(parameter_word(parameters, 'SOLVER', ''), 'CONJUGATEGRADIENT') == 1) step%solver = SOLVER_GRADIENTS
    call read_distributed_solver(reader, c, parameter_word(parameters, 'SOLVER', ''), step)
    is_ok = .true.
    has_row = next_row(reader%cards, row)
    if (.not. has_row) row%n = 0
    call check_n_fields(reader, row, merge(8, 5, has_parameter(parameters, 'RIKS')))   ! the fifth field of CalculiX is for flow
    call read_real(reader, row, 2, 'length of the step', step%period, is_ok, 0.0_DP)
    if (step%period <= 0 .and. row%n >= 2 .and. is_ok) call report_note(reader, row%line, &
      'The length of the step must be positive; 1 is taken.')
    if (step%period <= 0) step%period = 1
    call read_real(reader, row, 1, 'first increment', step%dt_initial, is_ok, 0.0_DP)
    if (.not. abs(step%dt_initial) > 0) step%dt_initial = step%period
    call read_real(reader, row, 3, 'least increment', step%dt_min, is_ok, 0.0_DP)
    if (.not. abs(step%dt_min) > 0) step%dt_min = min(step%dt_initial, 1.0e-6_DP * step%period)
    call read_real(reader, row, 4, 'largest increment', step%dt_max, is_ok, 0.0_DP)
    if (.not. abs(step%dt_max) > 0) step%dt_max = step%period
    if (is_ok) call check_times(reader, row%line, step)
    if (.not. has_row) return
    if (next_row(reader%cards, row)) call check_no_data(reader, row)
  end subroutine read_static


  !> CETOL of VISCO. Without it no increment is longer than the first where materials creep, unless the card gives a largest one.
  subroutine read_creep_tolerance(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step         !< in: of read_static; out: creep_tolerance, dt_max
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    logical :: is_ok
    real(DP) :: largest
    integer :: status
    step%creep_tolerance = 0
    if (.not. step%has_creep) return
    call open_card(reader, c, parameters, row)
    if (has_parameter(parameters, 'CETOL')) then
      call parse_real(parameter_text(parameters, 'CETOL'), step%creep_tolerance, status)
      if (status /= NUMBER_OK) return            ! the check of the cards reports it
      if (step%creep_tolerance <= 0) call report_error(reader, reader%cards%cards(c)%line, 'CETOL must be positive: the ' // &
        'difference of creep strains allowed in an increment, about the allowed error of the stress over Young''s modulus.')
      return
    end if
    if (step%is_direct .or. .not. any(model%materials%creep_law /= CREEP_NONE)) return
    largest = 0
    is_ok = .true.
    if (next_row(reader%cards, row)) call read_real(reader, row, 4, 'largest increment', largest, is_ok, 0.0_DP)
    if (largest > 0 .or. .not. step%dt_initial < step%dt_max) return
    step%dt_max = step%dt_initial
    call report_note(reader, reader%cards%cards(c)%line, 'Without CETOL nothing limits the error of creep, and no increment ' // &
      'is longer than the first one, ' // to_text(step%dt_initial) // '. CETOL lets them grow as far as creep allows.')
  end subroutine read_creep_tolerance


  !> DYNAMIC, APPLICATION=QUASI-STATIC: times as of STATIC; all elements need a density.
  subroutine read_dynamic(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer :: m
    call open_card(reader, c, parameters, row)
    step%has_creep = .false.
    step%is_dynamic = .true.
    call read_static(reader, c, step)
    call read_damping(reader, c, model%dialect, step)
    associate (line => reader%cards%cards(c)%line)
      if (.not. has_parameter(parameters, 'APPLICATION')) call report_error(reader, line, '*DYNAMIC needs ' // &
        'APPLICATION=QUASI-STATIC, which follows falls and snaps to rest. Waves and vibration are not resolved: they need a ' // &
        'program for dynamics; for slow loads use *STATIC with the same loads and amplitudes.')
      if (step%is_perturbation) call report_error(reader, line, 'A PERTURBATION step cannot be *DYNAMIC: use *STATIC.')
      do m = 1, size(model%materials)
        associate (material => model%materials(m))
          if (material%density > 0 .or. allocated(material%density_table%value)) cycle
          if (any(model%mesh%material == m .and. model%mesh%kind < KIND_SPRINGA)) call report_error(reader, line, &
            'Inertia needs the density of all bodies: give *DENSITY to the material ' // material%name // '.')
        end associate
      end do
    end associate
  end subroutine read_dynamic


  !> STABILIZE: damping by the volume, which the calculix dialect ignores.
  subroutine read_damping(reader, c, dialect, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: dialect               !< DIALECT_...
    type(step_type), intent(inout) :: step
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    step%dissipated_fraction = 0
    step%damping_factor = 0
    step%is_damping_continued = .false.
    call open_card(reader, c, parameters, row)
    if (.not. has_parameter(parameters, 'STABILIZE')) return
    if (dialect == DIALECT_CALCULIX) then
      call report_note(reader, reader%cards%cards(c)%line, 'STABILIZE has no effect: CalculiX does not know it. Under the ' // &
        'dialect ' // &
        'abaqus it adds damping.')
      return
    end if
    step%dissipated_fraction = 2.0e-4_DP
    step%is_damping_continued = has_parameter(parameters, 'CONTINUE') .and. &
      parameter_word(parameters, 'CONTINUE', 'YES') /= 'NO'
    call read_positive('STABILIZE', step%dissipated_fraction)
    call read_positive('FACTOR', step%damping_factor)

  contains

    !> The number of a parameter, if it has one.
    subroutine read_positive(name, number)
      character(*), intent(in) :: name
      real(DP), intent(inout) :: number
      real(DP) :: value
      integer :: status
      if (parameter_text(parameters, name) == '') return
      call parse_real(parameter_text(parameters, name), value, status)
      if (status /= NUMBER_OK) return            ! reported when the card was checked
      if (value < 0) call report_error(reader, reader%cards%cards(c)%line, 'The value of ' // name // ' must not be negative.')
      number = max(value, 0.0_DP)
    end subroutine read_positive

  end subroutine read_damping


  !> RIKS: arcs in place of times, and where the path ends.
  subroutine read_riks(reader, model, c, step)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(step_type), intent(inout) :: step       !< with the times of STATIC
    type(data_row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    real(DP) :: given
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    step%is_riks = has_parameter(parameters, 'RIKS')
    if (.not. step%is_riks) return
    associate (line => reader%cards%cards(c)%line)
      if (step%has_creep .or. step%is_perturbation) call report_error(reader, line, 'RIKS follows the path of a *STATIC step ' // &
        'without PERTURBATION.')
      if (has_parameter(parameters, 'STABILIZE')) call report_error(reader, line, 'RIKS and STABILIZE exclude each other: a ' // &
        'path of equilibria has no time in which to damp. Leave out one of them.')
      if (step%solver == SOLVER_GRADIENTS) call report_error(reader, line, 'RIKS needs the matrix, which CONJUGATE GRADIENTS ' // &
        'do not have: leave out SOLVER.')
    end associate
    is_ok = .true.
    if (.not. next_row(reader%cards, row)) row%n = 0
    call read_real(reader, row, 3, 'least arc', given, is_ok, 0.0_DP)
    if (.not. abs(given) > 0) step%dt_min = min(step%dt_initial, 1.0e-5_DP * step%period)
    call read_real(reader, row, 4, 'largest arc', given, is_ok, 0.0_DP)
    if (.not. abs(given) > 0) step%dt_max = huge(1.0_DP)
    call read_real(reader, row, 5, 'largest load proportionality factor', given, is_ok, 0.0_DP)
    if (given < 0) call report_error(reader, row%line, 'The largest load proportionality factor must be positive: it ends the ' // &
      'step when the factor exceeds it.')
    if (given > 0) step%path_end%load_factor = given
    call read_monitored_node(reader, model, row, step%path_end)
  end subroutine read_riks


  !> The node whose displacement ends the path: fields 6 to 8.
  subroutine read_monitored_node(reader, model, row, path_end)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(data_row_type), intent(in) :: row
    type(path_end_type), intent(inout) :: path_end
    integer, allocatable :: nodes(:)
    integer :: dof, place, first, last, i
    logical :: is_ok
    if (row%n < 6) return
    if (field_text(reader%cards, row, 6) == '') return
    is_ok = .true.
    call nodes_of_field(reader, model%mesh, row, 6, nodes, is_ok)
    call read_integer(reader, row, 7, 'degree of freedom of the monitored node', dof, is_ok, default=0)
    call read_real(reader, row, 8, 'displacement that ends the step', path_end%displacement, is_ok, 0.0_DP)
    if (.not. is_ok) return
    if (size(nodes) /= 1) then
      call report_error(reader, row%line, 'One node is monitored; the set has ' // to_text(size(nodes)) // '.')
      return
    end if
    place = 0
    if (dof >= 1 .and. dof <= 6) call map_dof(model, nodes(1), dof, place, path_end%dof)
    if (place == 0) then
      call report_error(reader, row%line, 'The monitored degree of freedom must be 1 to 3, or 4 to 6 at reference nodes of ' // &
        'rigid bodies and couplings.')
      return
    end if
    if (row%n < 8) then
      call report_error(reader, row%line, 'The monitored node needs its degree of freedom and the displacement that ends the step.')
      return
    end if
    path_end%nodes = [place]
    if (.not. allocated(model%structure) .or. dof > 3) return
    call find_node_directors(model%structure, place, first, last)
    if (last /= first) return
    associate (fibre => model%structure%directors(first)%nodes)   ! of a shell: the mean of its fibre
      path_end%nodes = [(fibre(i), i=1, count(fibre > 0))]
    end associate
  end subroutine read_monitored_node


  !> What a RIKS step cannot have, once all its cards are read.
  subroutine check_path_step(reader, line, is_step, is_after_path, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line                  !< of its STEP card
    logical, intent(in) :: is_step               !< STEP, AMPLITUDE=STEP
    logical, intent(in) :: is_after_path         !< the step before it is a RIKS step
    type(step_type), intent(in) :: step
    logical :: has_loads
    if (is_after_path) call report_error(reader, line, 'No step can follow a RIKS step: the loads at its end are part of its ' // &
      'solution. Make it the last one.')
    if (.not. step%is_riks) return
    if (is_step .and. .not. step%has_creep) call report_error(reader, line, 'The loads of a RIKS step are ' // &
      'proportional to its load factor: leave out AMPLITUDE=STEP.')
    if (any(step%concentrated%amplitude > 0) .or. any(step%distributed%amplitude > 0) .or. any(step%prescribed%amplitude > 0)) &
      call report_error(reader, line, 'A load of this RIKS step follows an AMPLITUDE. The loads of a RIKS step are all ' // &
      'proportional to its load factor, and those of earlier steps are constant: leave out AMPLITUDE, or give the load again.')
    if (any(step%distributed%is_user) .or. any(step%prescribed%is_user)) call report_error(reader, line, 'The loads of a RIKS ' // &
      'step are proportional to its load factor, which user routines do not get: give their values in the deck.')
    if (any(step%prescribed%global_step /= 0)) call report_error(reader, line, 'The loads of a RIKS step are proportional to ' // &
      'its load factor, which a global model does not give: use *STATIC for a submodel.')
    if (any([(abs(step%temperatures%end - step%temperatures%start) > 0)])) call report_error(reader, line, 'Temperatures ' // &
      'do not change in a RIKS step: give them in a step before it.')
    if (allocated(step%interference)) call report_error(reader, line, 'An interference that is resolved over the step needs a ' // &
      'time, which a RIKS step does not have: give *CONTACT INTERFERENCE in a step before it.')
    if (allocated(step%print_times) .or. allocated(step%file_times)) call report_error(reader, line, 'TIME POINTS have no ' // &
      'meaning in a RIKS step, whose increments are arcs: use FREQUENCY.')
    has_loads = any(abs(step%concentrated%end - step%concentrated%start) > 0) .or. &
      any(abs(step%distributed%end - step%distributed%start) > 0) .or. any(.not. step%prescribed%is_held .and. &
      (step%prescribed%is_velocity .or. abs(step%prescribed%end - step%prescribed%start) > 0 .or. step%prescribed%is_from_current))
    if (.not. (has_loads .or. is_step)) call report_error(reader, line, 'No load changes in this RIKS step: it ' // &
      'needs forces, pressures or displacements, which its load factor scales.')
  end subroutine check_path_step


  !> Reports inconsistent times.
  subroutine check_times(reader, line, step)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: line
    type(step_type), intent(inout) :: step
    if (step%dt_initial < 0 .or. step%dt_min < 0 .or. step%dt_max < 0) then
      call report_error(reader, line, 'The times of a step must be positive.')
      return
    end if
    if (step%dt_initial > step%period) call report_error(reader, line, 'The first increment ' // to_text(step%dt_initial) &
      // ' is longer than the step, ' // to_text(step%period) // '.')
    if (step%is_direct) return
    if (step%dt_min > step%dt_initial) then
      call report_note(reader, line, 'The least increment ' // to_text(step%dt_min) // ' is longer than the first one, ' // &
        to_text(step%dt_initial) // ', which is taken for it.')
      step%dt_min = step%dt_initial
    end if
    if (step%dt_max < step%dt_initial) then
      call report_note(reader, line, 'The first increment is cut to the largest one, ' // to_text(step%dt_max) // '.')
      step%dt_initial = step%dt_max
    end if
  end subroutine check_times

end module amontons_deck_procedures
