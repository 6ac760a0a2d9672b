!> Reads the deck into the model: order of the readers, scope of the cards, dialect.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Linear models (no nonlinearity in motion, material, contact or constraints): CalculiX solves once, for the loads at the end of
!! the step, and prints once; a list of TIME POINTS is ignored. The calculix dialect does the same.
module amontons_deck
  use amontons_cards, only: data_row_type, parameter_type, deck_messages_type, open_cards, open_cards_text, publish_messages, &
    line_text, field_text, has_open_keyword_line, read_parameters, start_rows, next_row
  use amontons_card_schema, only: find_entry, has_parameter, list_parameters, suggest_card, match_parameters, parameter_text, &
    SCOPE_MODEL, SCOPE_STEP, SCOPE_BOTH, ENTRY_SUPPORTED, ENTRY_IGNORED, ENTRY_REJECTED
  use amontons_card_table, only: make_card_table
  use amontons_containers, only: name_table_type
  use amontons_element_drafts, only: element_draft_type
  use amontons_deck_cohesive, only: set_cohesive_sections
  use amontons_deck_mesh, only: read_nodes, read_elements, read_sections, select_elements
  use amontons_deck_imperfection, only: read_imperfections
  use amontons_deck_initial_conditions, only: read_orientations, read_initial_conditions
  use amontons_deck_named_laws, only: check_steps_of_law
  use amontons_deck_viscoelasticity, only: check_viscoelastic_steps
  use amontons_deck_materials, only: read_materials, finalize_materials
  use amontons_deck_surfaces, only: read_heading, read_amplitudes, read_surfaces, read_equations
  use amontons_deck_contact, only: read_interactions, read_pairs, read_clearances
  use amontons_deck_embedded, only: read_embedded_elements
  use amontons_deck_foundations, only: read_foundations
  use amontons_deck_general_contact, only: read_general_contact
  use amontons_deck_couplings, only: read_transforms, read_couplings
  use amontons_deck_parts, only: flatten_parts
  use amontons_deck_generate, only: generate_mesh
  use amontons_deck_parameters, only: substitute_parameters
  use amontons_deck_restart, only: join_decks
  use amontons_deck_reader, only: reader_type, report_error, report_note, check_no_data, is_card
  use amontons_explain, only: explain_cards
  use amontons_deck_mpc, only: read_distributing_couplings, read_cyclic_symmetry
  use amontons_deck_submodel, only: read_submodels
  use amontons_deck_springs, only: read_springs, read_distance_limits, stiffen_springs_on_rings
  use amontons_deck_sets, only: read_sets
  use amontons_deck_structure, only: read_structural_sections, read_structure, free_slave_nodes, &
    refine_thin_shells
  use amontons_deck_user_elements, only: read_user_kinds, read_user_properties, connect_user_elements
  use amontons_deck_output, only: read_time_points
  use amontons_deck_steps, only: read_steps
  use amontons_deck_plausibility, only: report_traps, report_mixed_units, &
    report_routines_of_shells
  use amontons_posix, only: checksum_of_text
  use amontons_errors, only: diagnostic_list_type, error_type, set_error, EXIT_DECK
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX, DIALECT_FROM_DECK
  use amontons_text, only: upper_case, is_one_of, name_key, plural, parse_integer, NUMBER_OK
  use amontons_materials, only: material_type, is_linear_elastic, CREEP_NONE, INELASTIC_NONE
  use amontons_mpc_data, only: MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE
  implicit none
  private
  public :: read_deck, read_deck_text, explain_deck

contains

  !> Reads the deck of a job from its file.
  !!
  !! After: the model is complete if no error is allocated. All errors of the deck are in the list of complaints, in the
  !! order of the deck. Cost: linear in the size of the deck.
  subroutine read_deck(options, model, diagnostics, error)
    type(job_options_type), intent(in) :: options          !< with deck and dialect
    type(model_type), intent(out) :: model
    type(diagnostic_list_type), intent(inout) :: diagnostics
    type(error_type), allocatable, intent(out) :: error    !< EXIT_IO, EXIT_DECK
    type(reader_type) :: reader
    type(name_table_type) :: names
    call make_card_table(reader%table)
    call list_parameters(reader%table, names)
    call open_cards(options%deck, reader%cards, reader%messages, error, names)
    if (allocated(error)) return
    call read_model(reader, options, model, diagnostics, error)
  end subroutine read_deck


  !> The explanation of each card of a deck; also for a deck with errors. Errors: EXIT_IO, EXIT_DECK.
  subroutine explain_deck(options, model, text, error)
    type(job_options_type), intent(in) :: options          !< with deck and dialect
    type(model_type), intent(out) :: model                 !< complete if no error is allocated
    character(:), allocatable, intent(out) :: text
    type(error_type), allocatable, intent(out) :: error
    type(reader_type) :: reader
    type(name_table_type) :: names
    type(diagnostic_list_type) :: diagnostics
    call make_card_table(reader%table)
    call list_parameters(reader%table, names)
    call open_cards(options%deck, reader%cards, reader%messages, error, names)
    if (allocated(error)) then
      text = ''
      return
    end if
    call read_model(reader, options, model, diagnostics, error)
    call explain_cards(reader, model, text)
  end subroutine explain_deck


  !> Reads a deck from memory.
  subroutine read_deck_text(text, options, model, diagnostics, error)
    character(*), intent(in) :: text                       !< the whole deck, lines ended by newline
    type(job_options_type), intent(in) :: options          !< with dialect; deck names the deck in messages if allocated
    type(model_type), intent(out) :: model
    type(diagnostic_list_type), intent(inout) :: diagnostics
    type(error_type), allocatable, intent(out) :: error    !< EXIT_DECK
    type(reader_type) :: reader
    type(name_table_type) :: names
    call make_card_table(reader%table)
    call list_parameters(reader%table, names)
    if (allocated(options%deck)) then
      call open_cards_text(text, options%deck, reader%cards, reader%messages, names)
    else
      call open_cards_text(text, 'deck', reader%cards, reader%messages, names)
    end if
    call read_model(reader, options, model, diagnostics, error)
  end subroutine read_deck_text


  !> From cards to model. Names are collected before use: the order of the cards in the model does not matter.
  subroutine read_model(reader, options, model, diagnostics, error)
    type(reader_type), intent(inout) :: reader
    type(job_options_type), intent(in) :: options
    type(model_type), intent(inout) :: model
    type(diagnostic_list_type), intent(inout) :: diagnostics
    type(error_type), allocatable, intent(out) :: error
    type(element_draft_type) :: draft
    logical :: is_flat
    if (reader%messages%n_errors == 0) call join_decks(reader%cards, reader%messages, options, model%origin, error)
    if (allocated(error)) return
    model%deck_text = reader%cards%text(:reader%cards%text_length)
    model%deck_checksum = checksum_of_text(model%deck_text)
    call substitute_parameters(reader%cards, reader%messages)
    call generate_mesh(reader%cards, reader%messages)
    call check_assembly(reader)
    call flatten_parts(reader%cards, reader%messages, is_flat)
    is_flat = is_flat .and. reader%messages%n_errors == 0
    if (.not. is_flat) then
      call publish_messages(reader%cards, reader%messages, diagnostics)
      call set_error(error, EXIT_DECK, plural(reader%messages%n_errors, 'error') // ' in the deck.')
      return
    end if
    call choose_dialect(reader, options)
    if (allocated(model%origin%path)) then
      reader%dialect = model%origin%dialect
      reader%truncated_step = merge(model%origin%label%step, 0, model%origin%is_step_ended)
      reader%truncated_time = model%origin%label%step_time
    end if
    model%dialect = reader%dialect
    call check_cards(reader)
    call read_heading(reader, model)
    call read_nodes(reader, draft, model%mesh)
    call read_user_kinds(reader, model)
    call read_elements(reader, model%mesh, model%user_elements, draft)
    call read_sets(reader, draft, model%mesh)
    call read_imperfections(reader, model%mesh)
    call read_materials(reader, model)
    call read_sections(reader, model, draft)
    call read_structural_sections(reader, model, draft)
    call read_springs(reader, model, draft)
    call read_user_properties(reader, model, draft)
    call read_distance_limits(reader, model, draft)
    call select_elements(reader, model, draft)
    call set_cohesive_sections(reader, model)
    call read_structure(reader, model, draft)
    call read_amplitudes(reader, model)
    call read_time_points(reader)
    call read_surfaces(reader, model)
    call read_interactions(reader, model)
    call read_pairs(reader, model)
    call read_general_contact(reader, model)
    call read_transforms(reader, model)
    call read_submodels(reader, options, model)
    call read_couplings(reader, model)
    call free_slave_nodes(reader, model)
    call read_distributing_couplings(reader, model)
    call connect_user_elements(draft, model)
    call read_cyclic_symmetry(reader, model)
    call read_clearances(reader, model)
    call read_embedded_elements(reader, model)
    call read_foundations(reader, model)
    call read_equations(reader, model)
    call read_orientations(reader, model)
    call read_initial_conditions(reader, model)
    call read_steps(reader, model)
    call refine_thin_shells(reader, model)
    call finalize_materials(model)
    call check_perturbations(reader, model)
    call check_steps_of_law(reader, model)
    call check_viscoelastic_steps(reader, model)
    call report_traps(reader, model%mesh)
    if (reader%messages%n_errors == 0) call report_mixed_units(reader, model)
    if (reader%messages%n_errors == 0) call stiffen_springs_on_rings(reader, model)
    if (reader%messages%n_errors == 0) call report_nonlinear_springs(reader, model)
    if (reader%messages%n_errors == 0) call report_routines_of_shells(reader, model)
    if (reader%messages%n_errors == 0) call set_single_increments(model)
    call read_restart(reader, model)
    call publish_messages(reader%cards, reader%messages, diagnostics)
    if (reader%messages%n_errors > 0) call set_error(error, EXIT_DECK, plural(reader%messages%n_errors, 'error') // &
      ' in the deck.')
  end subroutine read_model


  !> RESTART, WRITE: which states are written, from the step of the card on; the checkpoint is kept when the job is done.
  subroutine read_restart(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(inout) :: model
    type(parameter_type), allocatable :: parameters(:)
    integer :: c, frequency, status, first
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'RESTART')) cycle
      call read_parameters(reader%cards, reader%cards%cards(c), parameters)
      if (has_parameter(parameters, 'READ') .and. reader%step_of_card(c) > 0) call report_error(reader, &
        reader%cards%cards(c)%line, '*RESTART, READ must be before the first step.')
      if (.not. has_parameter(parameters, 'WRITE')) cycle
      frequency = 1
      if (has_parameter(parameters, 'FREQUENCY')) then
        call parse_integer(parameter_text(parameters, 'FREQUENCY'), frequency, status)
        if (status == NUMBER_OK .and. frequency < 0) call report_error(reader, reader%cards%cards(c)%line, &
          'FREQUENCY must not be negative.')
      end if
      model%keeps_checkpoint = model%keeps_checkpoint .or. frequency > 0
      first = max(1, reader%step_of_card(c))
      model%steps(first:)%restart_frequency = frequency
      model%steps(first:)%is_restart_overlay = has_parameter(parameters, 'OVERLAY')
    end do
  end subroutine read_restart


  !> The dialect: from the job, else from a comment '** dialect: calculix' before the first card that is not HEADING.
  subroutine choose_dialect(reader, options)
    type(reader_type), intent(inout) :: reader
    type(job_options_type), intent(in) :: options
    character(:), allocatable :: key
    integer :: line, last, c
    last = reader%cards%n_lines
    do c = 1, reader%cards%n_cards
      if (reader%cards%cards(c)%key == 'HEADING') cycle
      last = reader%cards%cards(c)%line - 1
      exit
    end do
    reader%dialect = DIALECT_ABAQUS
    do line = 1, last
      key = name_key(line_text(reader%cards, line))
      if (len(key) < 10) cycle
      if (key(:10) /= '**DIALECT:') cycle
      if (key(11:) == 'CALCULIX') then
        reader%dialect = DIALECT_CALCULIX
      else if (key(11:) == 'ABAQUS') then
        reader%dialect = DIALECT_ABAQUS
      else
        call report_error(reader, line, 'The dialect must be abaqus or calculix.')
      end if
    end do
    if (options%dialect /= DIALECT_FROM_DECK) reader%dialect = options%dialect
  end subroutine choose_dialect


  !> Finds every card in the table, checks its place and parameters, and numbers the steps.
  subroutine check_cards(reader)
    type(reader_type), intent(inout) :: reader
    character(:), allocatable :: owner
    integer :: c, n_steps
    logical :: is_in_step
    allocate (reader%step_of_card(reader%cards%n_cards), source=0)
    call report_text_before_cards(reader)
    owner = ''
    n_steps = 0
    is_in_step = .false.
    do c = 1, reader%cards%n_cards
      call look_up_card(reader, c)
      if (is_card(reader, c, 'STEP')) then
        if (is_in_step) call report_error(reader, reader%cards%cards(c)%line, 'The step before this one has no *END STEP.')
        n_steps = n_steps + 1
        is_in_step = .true.
      end if
      if (is_in_step) reader%step_of_card(c) = n_steps
      call check_card_scope(reader, c, is_in_step, n_steps, owner)
      call check_parameters(reader, c)
      if (is_card(reader, c, 'ENDSTEP')) is_in_step = .false.
    end do
    if (is_in_step) call report_error(reader, 0, 'The last step has no *END STEP.')
  end subroutine check_cards


  !> Reports text before the first card.
  subroutine report_text_before_cards(reader)
    type(reader_type), intent(inout) :: reader
    character(:), allocatable :: text
    integer :: line, last
    last = reader%cards%n_lines
    if (reader%cards%n_cards > 0) last = reader%cards%first_card_line - 1
    do line = 1, last
      text = name_key(line_text(reader%cards, line))
      if (text == '') cycle
      if (text(1:1) == '*') cycle
      call report_note(reader, line, 'Text before the first card is passed over.')
      return
    end do
  end subroutine report_text_before_cards


  !> Finds the entry of a card in the table; reports a card that is unknown, rejected or noted.
  subroutine look_up_card(reader, c)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    logical :: is_abbreviated
    associate (card => reader%cards%cards(c))
      call find_entry(reader%table, card%key, card%entry, is_abbreviated)
      if (card%entry == 0) then
        if (reader%dialect == DIALECT_CALCULIX) then
          call report_note(reader, card%line, 'The card *' // written_name(reader, c) &
            // ' is not known, to CalculiX neither; it is passed over ' // &
            'as CalculiX does. amontons --cards lists all cards.')
        else
          call report_error(reader, card%line, 'The card *' // written_name(reader, c) // ' is not known' // &
            suggest_card(reader%table, card%key) // ' amontons --cards lists all cards.')
        end if
        return
      end if
      associate (entry => reader%table%entries(card%entry))
        if (is_abbreviated) call report_note(reader, card%line, 'The card *' // card%key // ' is taken as *' // entry%keyword &
          // '; abbreviations are better written out.')
        if (entry%status == ENTRY_REJECTED) call report_error(reader, card%line, 'The card *' // entry%keyword // &
          ' is not supported. ' // entry%description)
        if (entry%status == ENTRY_IGNORED) call report_note(reader, card%line, 'The card *' // entry%keyword // &
          ' is read past. ' // entry%description)
      end associate
    end associate
  end subroutine look_up_card


  !> The name of a card as the deck writes it, with its blanks, in upper case.
  pure function written_name(reader, c) result(name)
    type(reader_type), intent(in) :: reader
    integer, intent(in) :: c                     !< index of the card
    character(:), allocatable :: name
    name = upper_case(line_text(reader%cards, reader%cards%cards(c)%line))
    name = name(index(name, '*') + 1:)
    name = trim(adjustl(name(:scan(name // ',', ',') - 1)))
  end function written_name


  !> Reports a card in the wrong place. Unsupported cards do not end a block.
  subroutine check_card_scope(reader, c, is_in_step, n_steps, owner)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    logical, intent(in) :: is_in_step
    integer, intent(in) :: n_steps               !< steps begun
    character(:), allocatable, intent(inout) :: owner   !< key of the card whose block is open
    integer :: position
    logical :: is_abbreviated
    if (reader%cards%cards(c)%entry == 0) return
    associate (entry => reader%table%entries(reader%cards%cards(c)%entry), line => reader%cards%cards(c)%line)
      if (entry%status /= ENTRY_SUPPORTED) return
      if (entry%parent == '') then
        owner = entry%key
      else if (index('|' // entry%parent // '|', '|' // owner // '|') == 0) then
        call find_entry(reader%table, first_word(entry%parent), position, is_abbreviated)
        call report_error(reader, line, 'The card *' // entry%keyword // ' must be in the block of a *' // &
          reader%table%entries(position)%keyword // '.')
      end if
      if (entry%scope == SCOPE_STEP .and. .not. is_in_step) call report_error(reader, line, 'The card *' // entry%keyword // &
        ' must be in a step, between *STEP and *END STEP.')
      if (entry%scope == SCOPE_MODEL .and. n_steps > 0 .and. entry%key == 'CONTACT') then
        call report_error(reader, line, 'The card *CONTACT must be before the first step, with the cards of its block: ' // &
          'general contact holds in all steps. What a step begins or ends is a *CONTACT PAIR (*MODEL CHANGE, TYPE=CONTACT PAIR).')
      else if (entry%scope == SCOPE_MODEL .and. n_steps > 0) then
        call report_error(reader, line, 'The card *' // entry%keyword // ' must be before the first step.')
      end if
      if (entry%scope == SCOPE_BOTH .and. n_steps > 0 .and. .not. is_in_step .and. entry%key == 'BOUNDARY') call &
        report_error(reader, line, 'The card *BOUNDARY must be before the first step or in a step.')
    end associate
  end subroutine check_card_scope


  !> The first of words that are separated by |.
  pure function first_word(words) result(word)
    character(*), intent(in) :: words
    character(:), allocatable :: word
    word = words(:index(words // '|', '|') - 1)
  end function first_word


  !> Reports errors in the parameters of a card, and data lines of a card that takes none.
  subroutine check_parameters(reader, c)
    type(reader_type), intent(inout) :: reader
    integer, intent(in) :: c                     !< index of the card
    type(parameter_type), allocatable :: parameters(:)
    type(data_row_type) :: row
    associate (card => reader%cards%cards(c))
      if (card%entry == 0) return
      if (reader%table%entries(card%entry)%status /= ENTRY_SUPPORTED) return
      call read_parameters(reader%cards, card, parameters)
      call match_parameters(reader%table%entries(card%entry), parameters, card%line, &
        reader%dialect == DIALECT_CALCULIX, reader%messages)
      call start_rows(card, row)
      if (.not. next_row(reader%cards, row)) return
      if (reader%table%entries(card%entry)%data == '') then
        call check_no_data(reader, row)
      else if (has_open_keyword_line(reader%cards, card) .and. starts_with_name(field_text(reader%cards, row, 1))) then
        call report_note(reader, row%line, 'The keyword line above ends with a comma, but this line has no parameter of *' // &
          reader%table%entries(card%entry)%keyword // ': it is taken as data.')
      end if
    end associate
  end subroutine check_parameters


  !> Whether a field begins as a name does, not as a number.
  pure logical function starts_with_name(field)
    character(*), intent(in) :: field
    starts_with_name = verify(field, ' ') > 0
    if (starts_with_name) starts_with_name = scan(field(1:1), '0123456789+-.') == 0
  end function starts_with_name


  !> Checks the parameters of cards resolved before all others: errors are reported, notes are not.
  subroutine check_assembly(reader)
    type(reader_type), intent(inout) :: reader
    type(parameter_type), allocatable :: parameters(:)
    type(deck_messages_type) :: found
    character(:), allocatable :: text
    integer :: c, entry, line
    logical :: is_short, is_warning
    do c = 1, reader%cards%n_cards
      if (.not. is_one_of(reader%cards%cards(c)%key, 'PART|ASSEMBLY|INSTANCE')) cycle
      call find_entry(reader%table, reader%cards%cards(c)%key, entry, is_short)
      call read_parameters(reader%cards, reader%cards%cards(c), parameters)
      call match_parameters(reader%table%entries(entry), parameters, reader%cards%cards(c)%line, &
        .false., found)
    end do
    do c = 1, found%n
      call found%get(c, line, is_warning, text)
      if (.not. is_warning) call report_error(reader, line, text)
    end do
  end subroutine check_assembly


  !> PERTURBATION: a step with the response to its loads alone. A linear step from rest is equivalent. CalculiX continues from it
  !! differently; so under its dialect the step must be the only one.
  subroutine check_perturbations(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: trouble
    logical :: is_refused
    integer :: c, n
    do c = 1, reader%cards%n_cards
      if (.not. is_card(reader, c, 'STEP')) cycle
      call read_parameters(reader%cards, reader%cards%cards(c), parameters)
      if (.not. any([(parameters(n)%key == 'PERTURBATION', n=1, size(parameters))])) cycle
      n = reader%step_of_card(c)
      is_refused = .true.
      trouble = ''
      if (.not. all(model%steps(:n)%is_perturbation)) then
        trouble = 'after a general step: it would show the response of the loaded body alone'
      else if (reader%dialect == DIALECT_CALCULIX .and. size(model%steps) > 1) then
        trouble = 'with other steps: CalculiX continues them from a different state'
      else if (model%steps(n)%is_nlgeom .or. model%steps(n)%has_creep .or. .not. is_linear(model)) then
        trouble = 'where contact, a material, a constraint or NLGEOM makes the step nonlinear'
      else if (reader%dialect == DIALECT_CALCULIX .and. size(model%steps(n)%temperatures) > 0) then
        trouble = 'with *TEMPERATURE, which CalculiX ignores in such a step'
      else
        is_refused = .false.
      end if
      if (is_refused) call report_error(reader, reader%cards%cards(c)%line, 'PERTURBATION is not supported ' // trouble // &
        '. Write a general step: its loads, and all those of the step before.')
    end do
  end subroutine check_perturbations


  !> Solves each linear step of a linear model in one increment.
  pure subroutine set_single_increments(model)
    type(model_type), intent(inout) :: model
    integer :: i
    if (.not. is_linear(model)) return
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        if (model%dialect /= DIALECT_CALCULIX .and. .not. step%is_perturbation) cycle
        if (step%is_nlgeom .or. step%has_creep .or. allocated(step%is_inactive)) cycle
        step%dt_initial = step%period
        step%dt_max = step%period
        if (allocated(step%print_times)) deallocate (step%print_times)
        if (allocated(step%file_times)) deallocate (step%file_times)
      end associate
    end do
  end subroutine set_single_increments


  !> Reports springs that CalculiX takes as linear: those of a table, and gaps, in steps where nothing else is nonlinear.
  subroutine report_nonlinear_springs(reader, model)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer :: i
    if (model%dialect /= DIALECT_CALCULIX .or. all(model%steps%is_nlgeom) .or. .not. is_linear(model)) return
    if (.not. any([(allocated(model%springs(i)%force) .or. model%springs(i)%is_gap, i=1, size(model%springs))])) return
    call report_note(reader, 0, 'Nonlinear springs and gaps follow their laws in all steps. In a step where nothing else is ' // &
      'nonlinear CalculiX takes the stiffness at the start: springs are straight, and gaps never close. With NLGEOM both agree.')
  end subroutine report_nonlinear_springs


  !> Whether contact, materials and constraints are linear at small displacements.
  pure logical function is_linear(model)
    type(model_type), intent(in) :: model
    integer :: i
    is_linear = size(model%pairs) == 0 .and. .not. (allocated(model%general_contact) .or. allocated(model%user_elements))
    do i = 1, size(model%materials)
      is_linear = is_linear .and. has_linear_law(model%materials(i))
    end do
    if (.not. allocated(model%nonlinear_mpcs)) return
    do i = 1, size(model%nonlinear_mpcs)
      is_linear = is_linear .and. all(model%nonlinear_mpcs(i)%kind /= [MPC_PLANE, MPC_STRAIGHT, MPC_DISTANCE])
    end do
  end function is_linear


  !> Whether the stress is linear in the strain.
  pure logical function has_linear_law(material)
    type(material_type), intent(in) :: material
    has_linear_law = .not. (allocated(material%isotropic_hardening) .or. allocated(material%kinematic_hardening) &
      .or. material%is_user .or. material%inelastic_law /= INELASTIC_NONE .or. material%is_corotational .or. allocated( &
      material%prony) .or. material%has_deformation_plasticity .or. material%creep_law /= CREEP_NONE .or. &
      .not. is_linear_elastic(material))
  end function has_linear_law

end module amontons_deck
