!> Deck loads: the cards BOUNDARY, CLOAD, DLOAD and DSLOAD to what acts in each step, with what earlier steps left.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! | case | start of the step | end of the step |
!! |---|---|---|
!! | new in this step | 0; a displacement: what the node has then | its value |
!! | given again in this step | value at the end of the step before | its new value; forces of one step add up |
!! | kept from the step before | value at the end of that step | the same |
!! | OP=NEW, not given again | displacement: released; load: value at the end of the step before | load: 0 |
!! | STEP, AMPLITUDE=STEP | the value at the end | |
!! | with an amplitude | reference value times amplitude; kept on only if it runs in total time | |
module amontons_deck_loads
  use amontons_kinds, only: DP
  use amontons_cards, only: parameter_type, row_type, next_row, field_text, field_integer
  use amontons_card_form, only: has_parameter, parameter_word
  use amontons_deck_model, only: face_number
  use amontons_deck_reader, only: reader_type, open_card, complain, note, need_real, need_integer, need_at_most, &
    nodes_of_field, elements_of_field, find_amplitude, is_card
  use amontons_lookup, only: name_table_type
  use amontons_loads, only: load_type, load_value, prescribed_type, concentrated_type, distributed_type, &
    DISTRIBUTED_PRESSURE, DISTRIBUTED_GRAVITY, DISTRIBUTED_SPIN, DISTRIBUTED_BODY
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_text, only: squeezed, text_of, plural, is_one_of, NUMBER_OK
  use amontons_topology, only: kind_type, element_kind, FAMILY_AXISYMMETRIC, FAMILY_SOLID
  implicit none
  private
  public :: standing_type, start_standing, begin_step, read_boundary, read_cload, read_dload, hand_over_loads, &
    cut_loads

  integer, parameter :: FAMILY_BOUNDARY = 1, FAMILY_CLOAD = 2, FAMILY_DLOAD = 3, FAMILY_VOLUME = 4

  !> A prescribed displacement that stands.
  type, extends(prescribed_type) :: held_type
    real(DP) :: before = 0                       !< value at the end of the step before
    logical :: was_active = .false.              !< it acted in the step before
    logical :: is_active = .true.                !< it acts in this step
    integer :: step = 0                          !< step that gave it last; 0: the model
  end type held_type

  !> A load that stands.
  type, extends(load_type) :: force_type
    integer :: key = 0                           !< what it acts on
    real(DP) :: before = 0                       !< value at the end of the step before
    logical :: is_active = .true.
    integer :: step = 0                          !< step that gave it last
    integer :: next = 0                          !< next load on the same thing
  end type force_type

  !> Loads by what they act on.
  type :: forces_type
    integer :: n = 0
    type(force_type), allocatable :: items(:)
    integer, allocatable :: head(:)              !< (keys) first load on it, 0 none
  end type forces_type

  !> Where a load on volumes acts, and how.
  type :: volume_type
    integer :: kind = DISTRIBUTED_GRAVITY        !< DISTRIBUTED_GRAVITY, _SPIN or _BODY
    character(:), allocatable :: region          !< squeezed name or number
    integer, allocatable :: elements(:)
    real(DP) :: direction(3) = 0                 !< unit vector
    real(DP) :: point(3) = 0                     !< of the axis of spin [length]
  end type volume_type

  !> All that stands at this point of the deck.
  type :: standing_type
    integer :: step = 0                          !< present step
    logical :: is_step = .false.                 !< STEP, AMPLITUDE=STEP
    logical :: has_new(4) = .false.              !< (FAMILY_...) OP=NEW has been seen in this step
    integer :: n_held = 0
    type(held_type), allocatable :: held(:)
    integer, allocatable :: held_at(:)           !< (3 n_nodes) index into held, 0 none
    type(forces_type) :: cloads                  !< key 3 (node - 1) + dof
    type(forces_type) :: pressures               !< key 6 (element - 1) + face
    type(forces_type) :: volumes                 !< key: index into places
    type(volume_type), allocatable :: places(:)
  end type standing_type

contains

  !> Nothing stands yet.
  subroutine start_standing(model, standing)
    type(model_type), intent(in) :: model
    type(standing_type), intent(out) :: standing
    allocate (standing%held(256), standing%places(0))
    allocate (standing%held_at(3 * model%mesh%n_nodes), source=0)
    allocate (standing%cloads%head(3 * model%mesh%n_nodes), source=0)
    allocate (standing%pressures%head(6 * model%mesh%n_elements), source=0)
    allocate (standing%volumes%head(1024), source=0)
    allocate (standing%cloads%items(256), standing%pressures%items(256), standing%volumes%items(16))
  end subroutine start_standing


  !> Tells that CalculiX loads what a set names twice two times.
  subroutine tell_repeats(reader, row, names, has_repeats)
    type(reader_type), intent(inout) :: reader
    type(row_type), intent(in) :: row
    type(name_table_type), intent(in) :: names
    logical, intent(in) :: has_repeats(:)        !< (sets)
    character(:), allocatable :: name
    integer :: s
    if (reader%dialect /= DIALECT_CALCULIX) return
    name = field_text(reader%cards, row, 1)
    s = names%find(name)
    if (s == 0) return
    if (has_repeats(s)) call note(reader, row%line, 'The deck names some members of the set ''' // name // ''' more than ' // &
      'once. Here the load acts on each of them once; CalculiX applies it as often as they are named.')
  end subroutine tell_repeats


  !> Goes to the next step: everything keeps the value that it had at the end of the step before.
  subroutine begin_step(model, period, total_time, is_step, standing)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: period               !< length of the step before [time]
    real(DP), intent(in) :: total_time           !< total time at its end [time]
    logical, intent(in) :: is_step               !< the new step has AMPLITUDE=STEP
    type(standing_type), intent(inout) :: standing
    integer :: i
    standing%step = standing%step + 1
    standing%is_step = is_step
    standing%has_new = .false.
    do i = 1, standing%n_held
      associate (held => standing%held(i))
        held%was_active = held%is_active
        held%is_from_current = .false.
        if (standing%step == 1) cycle            ! of the model: it goes to its value over the first step
        call keep_value(model, period, total_time, held%load_type, held%before)
      end associate
    end do
    call keep_forces(model, period, total_time, standing%cloads)
    call keep_forces(model, period, total_time, standing%pressures)
    call keep_forces(model, period, total_time, standing%volumes)
  end subroutine begin_step


  !> What the loads of a step that ends early have reached: a fraction of the way of those that run straight.
  subroutine cut_loads(standing, fraction)
    type(standing_type), intent(inout) :: standing
    real(DP), intent(in) :: fraction             !< of the step that was done [-]
    integer :: i
    do i = 1, standing%n_held
      call cut_load(standing%held(i)%load_type)
    end do
    do i = 1, standing%cloads%n
      call cut_load(standing%cloads%items(i)%load_type)
    end do
    do i = 1, standing%pressures%n
      call cut_load(standing%pressures%items(i)%load_type)
    end do
    do i = 1, standing%volumes%n
      call cut_load(standing%volumes%items(i)%load_type)
    end do

  contains

    !> One of them.
    subroutine cut_load(load)
      type(load_type), intent(inout) :: load
      if (load%amplitude == 0) load%end = load%start + (load%end - load%start) * fraction
    end subroutine cut_load

  end subroutine cut_loads


  !> A load after its step: constant at its last value, unless its amplitude runs in total time.
  subroutine keep_value(model, period, total_time, load, before)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: period, total_time   !< [time]
    type(load_type), intent(inout) :: load
    real(DP), intent(out) :: before              !< the last value
    before = load%end
    if (load%amplitude > 0) then
      before = load_value(load, model%amplitudes, period, total_time, period)
      if (model%amplitudes(load%amplitude)%is_total_time) return
    end if
    load%amplitude = 0
    load%start = before
    load%end = before
  end subroutine keep_value


  !> Keeps the loads that are not zero, and closes the gaps in the list.
  subroutine keep_forces(model, period, total_time, forces)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: period, total_time   !< [time]
    type(forces_type), intent(inout) :: forces
    type(force_type) :: force
    integer :: i, n
    n = 0
    do i = 1, forces%n
      forces%head(forces%items(i)%key) = 0
    end do
    do i = 1, forces%n
      force = forces%items(i)
      if (.not. force%is_active) cycle
      call keep_value(model, period, total_time, force%load_type, force%before)
      if (.not. (abs(force%end) > 0 .or. force%is_user)) cycle
      n = n + 1
      force%next = forces%head(force%key)
      forces%head(force%key) = n
      forces%items(n) = force
    end do
    forces%n = n
  end subroutine keep_forces


  !> BOUNDARY in the model (step 0) or in the present step.
  subroutine read_boundary(reader, model, c, step, standing)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    integer, intent(in) :: step                  !< present step; 0: the model
    type(standing_type), intent(inout) :: standing
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    type(prescribed_type) :: common
    integer :: n_changed
    call open_card(reader, c, parameters, row)
    if (parameter_word(parameters, 'OP', 'MOD') == 'NEW') call release_held(step, standing)
    call find_amplitude(reader, c, parameters, common%amplitude)
    common%is_held = has_parameter(parameters, 'FIXED')
    common%is_user = has_parameter(parameters, 'USER')
    if (common%is_user .and. (common%is_held .or. has_parameter(parameters, 'AMPLITUDE'))) call complain(reader, &
      reader%cards%cards(c)%line, 'With USER the routine DISP gives the displacements, without AMPLITUDE or FIXED.')
    n_changed = 0
    do while (next_row(reader%cards, row))
      call read_boundary_row(reader, model, row, step, common, standing, n_changed)
    end do
    if (n_changed > 0) call note(reader, reader%cards%cards(c)%line, plural(n_changed, 'displacement') // &
      ' of this step had another value by an earlier line; the later one counts.')
  end subroutine read_boundary


  !> OP=NEW: what earlier steps prescribed is released, once in a step.
  subroutine release_held(step, standing)
    integer, intent(in) :: step
    type(standing_type), intent(inout) :: standing
    integer :: i
    if (standing%has_new(FAMILY_BOUNDARY) .or. step == 0) return
    standing%has_new(FAMILY_BOUNDARY) = .true.
    do i = 1, standing%n_held
      if (standing%held(i)%step < step) standing%held(i)%is_active = .false.
    end do
  end subroutine release_held


  !> One row of BOUNDARY.
  subroutine read_boundary_row(reader, model, row, step, common, standing, n_changed)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(row_type), intent(in) :: row
    integer, intent(in) :: step
    type(prescribed_type), intent(in) :: common  !< with amplitude and is_held
    type(standing_type), intent(inout) :: standing
    integer, intent(inout) :: n_changed          !< displacements given differently before in this step
    type(prescribed_type) :: new
    integer, allocatable :: nodes(:)
    logical :: is_fixed(6), is_ok
    integer :: i, dof, n_passed
    is_ok = .true.
    new = common
    new%line = reader%cards%line_number(row%line)
    call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
    call read_dofs(reader, row, is_fixed, new%end, is_ok)
    if (.not. is_ok) return
    n_passed = 0
    do i = 1, size(nodes)
      do dof = 1, 6
        if (.not. is_fixed(dof)) cycle
        call place_dof(model, nodes(i), dof, new%node, new%dof)
        if (new%node == 0) n_passed = n_passed + 1
        if (new%node > 0) call hold(new, step, standing, n_changed)
      end do
    end do
    if (n_passed == 0) return
    if (abs(new%end) > 0) then
      call complain(reader, row%line, 'The nodes of solids have no rotations; the degrees of freedom are 1 to 3 (4 to 6 ' // &
        'at reference nodes of rigid bodies and couplings).')
    else
      call note(reader, row%line, 'The nodes of solids have no rotations; the degrees of freedom 4 to 6 are passed over.')
    end if
  end subroutine read_boundary_row


  !> Where a degree of freedom is: 4 to 6 of a reference node are the displacements of its rotation node.
  subroutine place_dof(model, node, dof, place, dof_there)
    type(model_type), intent(in) :: model
    integer, intent(in) :: node, dof             !< 1 to 6
    integer, intent(out) :: place, dof_there     !< node and 1 to 3; node 0: there is none
    place = node
    dof_there = dof
    if (dof <= 3) return
    dof_there = dof - 3
    place = 0
    if (allocated(model%rotation_of)) place = model%rotation_of(node)
  end subroutine place_dof


  !> The degrees of freedom of a BOUNDARY row: first, last, value; or a word.
  subroutine read_dofs(reader, row, is_fixed, value, is_ok)
    type(reader_type), intent(inout) :: reader
    type(row_type), intent(in) :: row
    logical, intent(out) :: is_fixed(6)
    real(DP), intent(out) :: value               !< [length]
    logical, intent(inout) :: is_ok
    integer :: first, last, status
    is_fixed = .false.
    value = 0
    call field_integer(reader%cards, row, 2, first, status)
    if (status /= NUMBER_OK) then
      call read_support_word(reader, row, is_fixed, is_ok)
      return
    end if
    call need_at_most(reader, row, 4)
    call need_integer(reader, row, 3, 'last degree of freedom', last, is_ok, default=first)
    call need_real(reader, row, 4, 'displacement', value, is_ok, 0.0_DP)
    if (.not. is_ok) return
    if (first == 11 .and. last == 11) then
      call complain(reader, row%line, 'The degree of freedom 11 is the temperature, which belongs to a flow of heat; ' // &
        '*TEMPERATURE prescribes temperatures.')
      is_ok = .false.
    else if (first < 1 .or. last < first .or. last > 6) then
      call complain(reader, row%line, 'The degrees of freedom must be 1 to 3 (to 6 at reference nodes), the first not ' // &
        'above the last.')
      is_ok = .false.
    else
      is_fixed(first:last) = .true.
    end if
  end subroutine read_dofs


  !> A word such as PINNED or XSYMM.
  subroutine read_support_word(reader, row, is_fixed, is_ok)
    type(reader_type), intent(inout) :: reader
    type(row_type), intent(in) :: row
    logical, intent(out) :: is_fixed(6)
    logical, intent(inout) :: is_ok
    is_fixed = .false.
    call need_at_most(reader, row, 2)
    select case (squeezed(field_text(reader%cards, row, 2)))
    case ('ENCASTRE', 'PINNED')
      is_fixed(:3) = .true.
    case ('XSYMM')
      is_fixed(1) = .true.
    case ('YSYMM')
      is_fixed(2) = .true.
    case ('ZSYMM')
      is_fixed(3) = .true.
    case ('XASYMM')
      is_fixed(2:3) = .true.
    case ('YASYMM')
      is_fixed(1) = .true.
      is_fixed(3) = .true.
    case ('ZASYMM')
      is_fixed(1:2) = .true.
    case default
      is_ok = .false.
      call complain(reader, row%line, 'The second field must be the first degree of freedom, or ENCASTRE, PINNED, ' // &
        'XSYMM, YSYMM, ZSYMM, XASYMM, YASYMM or ZASYMM; it is ''' // field_text(reader%cards, row, 2) // '''.')
    end select
  end subroutine read_support_word


  !> Prescribes one degree of freedom.
  subroutine hold(new, step, standing, n_changed)
    type(prescribed_type), intent(in) :: new     !< with node, dof, end, amplitude, is_held, line
    integer, intent(in) :: step
    type(standing_type), intent(inout) :: standing
    integer, intent(inout) :: n_changed
    type(held_type), allocatable :: larger(:)
    integer :: i
    logical :: was_held, was_here
    i = standing%held_at(3 * new%node - 3 + new%dof)
    was_here = i > 0
    if (.not. was_here) then
      if (standing%n_held == size(standing%held)) then
        allocate (larger(2 * standing%n_held))
        larger(:standing%n_held) = standing%held
        call move_alloc(larger, standing%held)
      end if
      standing%n_held = standing%n_held + 1
      i = standing%n_held
      standing%held_at(3 * new%node - 3 + new%dof) = i
    end if
    associate (held => standing%held(i))
      if (was_here .and. held%step == step .and. held%is_active) then
        if (is_other(held, new)) n_changed = n_changed + 1
      end if
      was_held = held%is_held .and. held%was_active
      held%prescribed_type = new
      held%start = held%before
      held%is_from_current = step > 1 .and. (was_held .or. .not. held%was_active)
      if (standing%is_step .and. new%amplitude == 0) then
        held%start = held%end
        held%is_from_current = .false.
      end if
      if (new%is_held) held%is_from_current = .true.
      held%step = step
      held%is_active = .true.
    end associate
  end subroutine hold


  !> Whether a prescription differs from the one given before.
  pure function is_other(held, new) result(differs)
    type(held_type), intent(in) :: held
    type(prescribed_type), intent(in) :: new
    logical :: differs
    differs = abs(held%end - new%end) > 0 .or. held%amplitude /= new%amplitude .or. (held%is_held .neqv. new%is_held) &
      .or. (held%is_user .neqv. new%is_user)
  end function is_other


  !> CLOAD in the present step.
  subroutine read_cload(reader, model, c, standing)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(standing_type), intent(inout) :: standing
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    integer, allocatable :: nodes(:)
    real(DP) :: value
    integer :: amplitude, dof, i, place, dof_there
    logical :: is_ok
    call open_card(reader, c, parameters, row)
    if (parameter_word(parameters, 'OP', 'MOD') == 'NEW') call &
      fade_forces(standing%step, standing%is_step, standing%has_new(FAMILY_CLOAD), standing%cloads)
    call find_amplitude(reader, c, parameters, amplitude)
    do while (next_row(reader%cards, row))
      is_ok = .true.
      call need_at_most(reader, row, 3)
      call nodes_of_field(reader, model%mesh, row, 1, nodes, is_ok)
      call need_integer(reader, row, 2, 'degree of freedom', dof, is_ok)
      call need_real(reader, row, 3, 'force', value, is_ok, 0.0_DP)
      call tell_repeats(reader, row, reader%node_sets, reader%node_repeats)
      if (is_ok .and. (dof < 1 .or. dof > 6)) then
        call complain(reader, row%line, 'The degree of freedom of a force must be 1, 2 or 3, of a moment 4, 5 or 6.')
        is_ok = .false.
      end if
      if (.not. is_ok) cycle
      do i = 1, size(nodes)
        call place_dof(model, nodes(i), dof, place, dof_there)
        if (place == 0) then
          call complain(reader, row%line, 'The nodes of solids take no moments; only reference nodes of rigid bodies ' // &
            'and couplings do.')
          exit
        end if
        call add_force(3 * place - 3 + dof_there, value, amplitude, standing%step, standing%is_step, standing%cloads)
      end do
    end do
  end subroutine read_cload


  !> OP=NEW: the loads of earlier steps go to zero over this step, once in a step.
  subroutine fade_forces(step, is_step, has_new, forces)
    integer, intent(in) :: step                  !< present step
    logical, intent(in) :: is_step               !< STEP, AMPLITUDE=STEP
    logical, intent(inout) :: has_new            !< OP=NEW has been seen in this step
    type(forces_type), intent(inout) :: forces
    integer :: i
    if (has_new) return
    has_new = .true.
    do i = 1, forces%n
      associate (force => forces%items(i))
        if (force%step == step) cycle
        force%amplitude = 0
        force%start = merge(0.0_DP, force%before, is_step)
        force%end = 0
        if (force%is_user) force%is_active = .false.   ! DLOAD knows no way to zero
      end associate
    end do
  end subroutine fade_forces


  !> Adds a load: in place of those that earlier steps left there, and on top of those that this step gave.
  subroutine add_force(key, value, amplitude, step, is_step, forces, is_user)
    integer, intent(in) :: key                   !< what it acts on
    real(DP), intent(in) :: value
    integer, intent(in) :: amplitude             !< 0: none
    integer, intent(in) :: step
    logical, intent(in) :: is_step               !< STEP, AMPLITUDE=STEP
    type(forces_type), intent(inout) :: forces
    logical, intent(in), optional :: is_user     !< DLOAD gives the magnitude
    type(force_type), allocatable :: larger(:)
    type(force_type) :: new
    integer :: i
    if (present(is_user)) new%is_user = is_user
    i = forces%head(key)
    do while (i > 0)
      associate (old => forces%items(i))
        if (old%step == step .and. old%amplitude == amplitude .and. (old%is_user .eqv. new%is_user)) then
          old%end = old%end + value
          if (is_step .and. amplitude == 0) old%start = old%end
          return
        end if
        if (old%step < step .and. old%is_active) then
          new%start = new%start + old%before
          old%is_active = .false.
        end if
        i = old%next
      end associate
    end do
    if (forces%n == size(forces%items)) then
      allocate (larger(2 * forces%n))
      larger(:forces%n) = forces%items
      call move_alloc(larger, forces%items)
    end if
    new%key = key
    new%end = value
    new%amplitude = amplitude
    new%step = step
    if (is_step .and. amplitude == 0) new%start = value
    new%next = forces%head(key)
    forces%n = forces%n + 1
    forces%items(forces%n) = new
    forces%head(key) = forces%n
  end subroutine add_force


  !> DLOAD or DSLOAD in the present step.
  subroutine read_dload(reader, model, c, standing)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    integer, intent(in) :: c                     !< index of the card
    type(standing_type), intent(inout) :: standing
    type(row_type) :: row
    type(parameter_type), allocatable :: parameters(:)
    character(:), allocatable :: label
    integer :: amplitude
    call open_card(reader, c, parameters, row)
    if (parameter_word(parameters, 'OP', 'MOD') == 'NEW') then
      call fade_forces(standing%step, standing%is_step, standing%has_new(FAMILY_DLOAD), standing%pressures)
      call fade_forces(standing%step, standing%is_step, standing%has_new(FAMILY_VOLUME), standing%volumes)
    end if
    call find_amplitude(reader, c, parameters, amplitude)
    do while (next_row(reader%cards, row))
      label = squeezed(field_text(reader%cards, row, 2))
      if (is_by_user(label) .and. amplitude > 0) call complain(reader, row%line, &
        'The routine DLOAD gives the whole pressure; AMPLITUDE must not be given with ' // label // '.')
      if (label == 'P' .or. label == 'PNU') then
        call read_surface_pressure(reader, model, row, amplitude, standing)
      else if (is_card(reader, c, 'DSLOAD')) then
        call complain(reader, row%line, 'The second field must be P, a pressure, or PNU, one by the routine DLOAD; it is ''' // &
          label // '''.')
      else if (face_number(without_nu(label), 'P') > 0) then
        call read_face_pressure(reader, model, row, amplitude, standing)
      else if (is_one_of(label, 'GRAV|CENTRIF|BX|BY|BZ')) then
        call read_volume_load(reader, model, row, amplitude, standing)
      else
        call complain(reader, row%line, 'The second field must be P1 to P6 (pressure on a face), P (pressure on a ' // &
          'surface), each with NU for one by the routine DLOAD, GRAV (gravity), CENTRIF (rotation) or BX, BY, BZ (force per ' // &
          'volume); it is ''' // label // '''.')
      end if
    end do
  end subroutine read_dload


  !> Whether a label of DLOAD means that the routine DLOAD gives the pressure: it ends with NU.
  pure logical function is_by_user(label)
    character(*), intent(in) :: label            !< squeezed
    is_by_user = len(without_nu(label)) < len(label)
  end function is_by_user


  !> A label without NU at its end.
  pure function without_nu(label) result(short)
    character(*), intent(in) :: label
    character(:), allocatable :: short
    short = squeezed(label)
    if (len(short) < 3) return
    if (short(len(short) - 1:) == 'NU') short = short(:len(short) - 2)
  end function without_nu


  !> Tells faces of plane elements, which DLOAD does not know.
  subroutine need_solid(reader, model, row, e)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(row_type), intent(in) :: row
    integer, intent(in) :: e                     !< element
    type(kind_type) :: entry
    entry = element_kind(model%mesh%kind(e))
    if (entry%family /= FAMILY_SOLID) call complain(reader, row%line, 'The routine DLOAD is for the faces of solids in space.')
  end subroutine need_solid


  !> Row: surface, P, pressure.
  subroutine read_surface_pressure(reader, model, row, amplitude, standing)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(row_type), intent(in) :: row
    integer, intent(in) :: amplitude
    type(standing_type), intent(inout) :: standing
    real(DP) :: value
    integer :: s, i
    logical :: is_ok
    is_ok = .true.
    call need_at_most(reader, row, 3)
    call need_real(reader, row, 3, 'pressure', value, is_ok, 0.0_DP)
    s = reader%surfaces%find(field_text(reader%cards, row, 1))
    if (s == 0 .and. reader%element_sets%find(field_text(reader%cards, row, 1)) > 0) then
      call complain(reader, row%line, '''' // field_text(reader%cards, row, 1) // ''' is a set of elements, no surface. ' // &
        'Make one of its free faces, *SURFACE, NAME=name with the line ' // field_text(reader%cards, row, 1) // ', and load that.')
      return
    else if (s == 0) then
      call complain(reader, row%line, 'There is no surface ''' // field_text(reader%cards, row, 1) // '''' // &
        reader%surfaces%hint(field_text(reader%cards, row, 1)))
      return
    end if
    if (model%surfaces(s)%is_node_based) then
      call complain(reader, row%line, 'The surface ''' // model%surfaces(s)%name // &
        ''' is made of nodes; a pressure needs element faces.')
      return
    end if
    if (.not. is_ok) return
    do i = 1, size(model%surfaces(s)%element)
      call add_force(6 * model%surfaces(s)%element(i) - 6 + model%surfaces(s)%face(i), value, amplitude, &
        standing%step, standing%is_step, standing%pressures, is_by_user(field_text(reader%cards, row, 2)))
    end do
    if (is_by_user(field_text(reader%cards, row, 2)) .and. size(model%surfaces(s)%element) > 0) &
      call need_solid(reader, model, row, model%surfaces(s)%element(1))
  end subroutine read_surface_pressure


  !> Row: element or element set, P1 to P6, pressure.
  subroutine read_face_pressure(reader, model, row, amplitude, standing)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(row_type), intent(in) :: row
    integer, intent(in) :: amplitude
    type(standing_type), intent(inout) :: standing
    integer, allocatable :: elements(:)
    type(kind_type) :: entry
    real(DP) :: value
    integer :: face, i, n_without
    logical :: is_ok
    is_ok = .true.
    call need_at_most(reader, row, 3)
    call elements_of_field(reader, model%mesh, row, 1, elements, is_ok)
    call need_real(reader, row, 3, 'pressure', value, is_ok, 0.0_DP)
    if (.not. is_ok) return
    call tell_repeats(reader, row, reader%element_sets, reader%element_repeats)
    face = face_number(without_nu(field_text(reader%cards, row, 2)), 'P')
    if (is_by_user(field_text(reader%cards, row, 2)) .and. size(elements) > 0) call need_solid(reader, model, row, elements(1))
    n_without = 0
    do i = 1, size(elements)
      entry = element_kind(model%mesh%kind(elements(i)))
      if (face > entry%n_faces) then
        n_without = n_without + 1
      else
        call add_force(6 * elements(i) - 6 + face, value, amplitude, standing%step, standing%is_step, &
          standing%pressures, is_by_user(field_text(reader%cards, row, 2)))
      end if
    end do
    if (n_without > 0) call complain(reader, row%line, plural(n_without, 'element') // ' here have no face ' // &
      text_of(face) // '; tetrahedra have 4 faces, wedges 5, hexahedra 6.')
  end subroutine read_face_pressure


  !> Row: element or element set; GRAV, acceleration, direction; or CENTRIF, square of the angular velocity, point and
  !! direction of the axis; or BX, BY or BZ, force per volume.
  subroutine read_volume_load(reader, model, row, amplitude, standing)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(row_type), intent(in) :: row
    integer, intent(in) :: amplitude
    type(standing_type), intent(inout) :: standing
    type(volume_type) :: place
    real(DP) :: value
    integer :: i
    logical :: is_ok
    is_ok = .true.
    if (field_text(reader%cards, row, 1) == '') then      ! as Abaqus/CAE writes a load on the whole model
      place%elements = [(i, i=1, model%mesh%n_elements)]
    else
      call elements_of_field(reader, model%mesh, row, 1, place%elements, is_ok)
    end if
    call need_real(reader, row, 3, 'magnitude', value, is_ok, 0.0_DP)
    call read_axis(reader, model, row, place, is_ok)
    if (.not. is_ok) return
    if (place%kind == DISTRIBUTED_SPIN .and. value < 0) then
      call complain(reader, row%line, 'CENTRIF needs the square of the angular velocity, which is not negative.')
      return
    end if
    place%region = squeezed(field_text(reader%cards, row, 1))
    if (place%kind /= DISTRIBUTED_BODY) call need_density(reader, model, row, place%elements)
    do i = 1, size(standing%places)
      if (is_same_place(standing%places(i), place)) exit
    end do
    if (i > size(standing%places)) standing%places = [standing%places, place]
    if (i > size(standing%volumes%head)) then
      call complain(reader, row%line, 'More than ' // text_of(size(standing%volumes%head)) // &
        ' loads on volumes; gather the elements in sets.')
      return
    end if
    call add_force(i, value, amplitude, standing%step, standing%is_step, standing%volumes)
  end subroutine read_volume_load


  !> The direction of a load on volumes, and for CENTRIF a point of its axis before it.
  subroutine read_axis(reader, model, row, place, is_ok)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(row_type), intent(in) :: row
    type(volume_type), intent(inout) :: place    !< with elements
    logical, intent(inout) :: is_ok
    character(:), allocatable :: label
    integer :: i, first
    label = squeezed(field_text(reader%cards, row, 2))
    first = 4
    if (label(1:1) == 'B') then
      call need_at_most(reader, row, 3)
      place%kind = DISTRIBUTED_BODY
      place%direction(index('XYZ', label(2:2))) = 1
      return
    end if
    if (label == 'CENTRIF') then
      place%kind = DISTRIBUTED_SPIN
      first = 7
      do i = 1, 3
        call need_real(reader, row, i + 3, 'point of the axis', place%point(i), is_ok, 0.0_DP)
      end do
    end if
    call need_at_most(reader, row, first + 2)
    do i = 1, 3
      call need_real(reader, row, first + i - 1, 'direction', place%direction(i), is_ok, 0.0_DP)
    end do
    if (.not. is_ok) return
    is_ok = norm2(place%direction) > 0
    if (.not. is_ok) then
      call complain(reader, row%line, 'The direction must not be zero: region, GRAV, acceleration, x, y, z; or ' // &
        'region, CENTRIF, square of the angular velocity, x, y, z of a point and x, y, z along the axis.')
      return
    end if
    place%direction = place%direction / norm2(place%direction)
    if (place%kind /= DISTRIBUTED_SPIN) return
    do i = 1, size(place%elements)
      associate (kind => element_kind(model%mesh%kind(place%elements(i))))
        if (kind%family /= FAMILY_AXISYMMETRIC) cycle
      end associate
      if (abs(place%direction(2)) >= 1.0_DP - 1.0e-9_DP .and. .not. abs(place%point(1)) + abs(place%point(3)) > 0) cycle
      call complain(reader, row%line, 'Axisymmetric elements turn about the y axis: the point must be on it, and the ' // &
        'direction along it.')
      is_ok = .false.
      return
    end do
  end subroutine read_axis


  !> Whether two loads on volumes are of the same kind on the same region in the same directions.
  pure logical function is_same_place(a, b)
    type(volume_type), intent(in) :: a, b
    is_same_place = a%kind == b%kind .and. a%region == b%region .and. all(abs(a%direction - b%direction) < 1.0e-12_DP) &
      .and. .not. any(abs(a%point - b%point) > 0)
  end function is_same_place


  !> Tells materials without a density in elements that gravity or rotation acts on.
  subroutine need_density(reader, model, row, elements)
    type(reader_type), intent(inout) :: reader
    type(model_type), intent(in) :: model
    type(row_type), intent(in) :: row
    integer, intent(in) :: elements(:)
    logical :: is_told(size(model%materials))
    integer :: i, m
    is_told = .false.
    do i = 1, size(elements)
      m = model%mesh%material(elements(i))
      if (m == 0) cycle
      if (is_told(m) .or. model%materials(m)%has_density) cycle
      is_told(m) = .true.
      call complain(reader, row%line, 'Gravity and rotation need a density; the material ''' // model%materials(m)%name // &
        ''' has no *DENSITY card.')
    end do
  end subroutine need_density


  !> The complete lists of what acts in the present step.
  subroutine hand_over_loads(standing, prescribed, concentrated, distributed)
    type(standing_type), intent(in) :: standing
    type(prescribed_type), allocatable, intent(out) :: prescribed(:)
    type(concentrated_type), allocatable, intent(out) :: concentrated(:)
    type(distributed_type), allocatable, intent(out) :: distributed(:)
    integer :: i, n
    allocate (prescribed(count(standing%held(:standing%n_held)%is_active)))
    n = 0
    do i = 1, standing%n_held
      if (.not. standing%held(i)%is_active) cycle
      n = n + 1
      prescribed(n) = standing%held(i)%prescribed_type
    end do
    allocate (concentrated(count(standing%cloads%items(:standing%cloads%n)%is_active)))
    n = 0
    do i = 1, standing%cloads%n
      associate (force => standing%cloads%items(i))
        if (.not. force%is_active) cycle
        n = n + 1
        concentrated(n)%load_type = force%load_type
        concentrated(n)%node = (force%key - 1) / 3 + 1
        concentrated(n)%dof = modulo(force%key - 1, 3) + 1
      end associate
    end do
    call hand_over_distributed(standing, distributed)
  end subroutine hand_over_loads


  !> Pressures face by face and loads on volumes element by element.
  subroutine hand_over_distributed(standing, distributed)
    type(standing_type), intent(in) :: standing
    type(distributed_type), allocatable, intent(out) :: distributed(:)
    integer :: i, k, n
    n = count(standing%pressures%items(:standing%pressures%n)%is_active)
    do i = 1, standing%volumes%n
      if (standing%volumes%items(i)%is_active) n = n + size(standing%places(standing%volumes%items(i)%key)%elements)
    end do
    allocate (distributed(n))
    n = 0
    do i = 1, standing%pressures%n
      associate (force => standing%pressures%items(i))
        if (.not. force%is_active) cycle
        n = n + 1
        distributed(n)%load_type = force%load_type
        distributed(n)%kind = DISTRIBUTED_PRESSURE
        distributed(n)%element = (force%key - 1) / 6 + 1
        distributed(n)%face = modulo(force%key - 1, 6) + 1
      end associate
    end do
    do i = 1, standing%volumes%n
      associate (force => standing%volumes%items(i), place => standing%places(standing%volumes%items(i)%key))
        if (.not. force%is_active) cycle
        do k = 1, size(place%elements)
          n = n + 1
          distributed(n)%load_type = force%load_type
          distributed(n)%kind = place%kind
          distributed(n)%element = place%elements(k)
          distributed(n)%direction = place%direction
          distributed(n)%point = place%point
        end do
      end associate
    end do
  end subroutine hand_over_distributed

end module amontons_deck_loads
