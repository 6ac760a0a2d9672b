!> Loads and displacements set by a calling program during the run.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A value that is set is reached linearly, from the current value, at the end of the increments solved next, and stays
!! constant after that. Each driven degree of freedom or face has its own amplitude of two points, which replaces the load of the
!! deck. Start and target values refer to the last commit: a rollback needs no more.
!!
!! The model does not change. The solver uses the current step, `driven_loads%step`: the step of the model with the loads on driven
!! items replaced, with the coefficients of friction that were set, and with the current amplitudes (including those of UAMP).
module amontons_driven_loads
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_USAGE
  use amontons_text, only: to_text
  use amontons_loads, only: amplitude_type, amplitude_value, load_type, concentrated_type, &
    distributed_type, temperature_type, DISTRIBUTED_PRESSURE
  use amontons_steps, only: step_type
  use amontons_model, only: model_type, load_now
  implicit none
  private
  public :: driven_loads_type, create_driven_loads, select_step_loads, set_driven, friction_now, set_friction, current_loads, &
    activate_driven, finish_driven, list_driven, restore_driven
  public :: DRIVEN_FORCE, DRIVEN_DISPLACEMENT, DRIVEN_PRESSURE, DRIVEN_TEMPERATURE

  integer, parameter :: DRIVEN_FORCE = 1            !< item: 3 (node - 1) + dof
  integer, parameter :: DRIVEN_DISPLACEMENT = 2     !< item: the same
  integer, parameter :: DRIVEN_PRESSURE = 3         !< item: 6 (element - 1) + face
  integer, parameter :: DRIVEN_TEMPERATURE = 4      !< item: node
  integer, parameter :: N_DRIVEN_KINDS = 4
  integer, parameter :: N_ENTRY_NUMBERS = 8              !< per driven value in a checkpoint

  !> One driven value.
  type :: driven_entry_type
    integer :: kind = 0                            !< DRIVEN_...
    integer :: item = 0
    integer :: amplitude = 0                       !< index into step%amplitudes of the current step
    real(DP) :: target = 0                         !< [force], [length] or [stress]
    logical :: is_pending = .false.                !< the target is set and no increment towards it is committed
    logical :: is_active = .false.                  !< the amplitude leads to the target
  end type driven_entry_type

  !> All driven values of a job, and the current step.
  type :: driven_loads_type
    type(step_type) :: step                        !< current step; its amplitudes are allocated if any can be set
    type(driven_entry_type), allocatable :: entries(:)
    integer, allocatable :: entry_index(:, :)            !< (items, N_DRIVEN_KINDS) index into entries, 0: not driven
    real(DP), allocatable :: friction(:)           !< (n_interactions) coefficient that was set; negative: the deck's [-]
  end type driven_loads_type

  !> Position in a list of new items.
  interface order_of
    procedure :: order_of_item, order_of_items
  end interface order_of

contains

  !> The driven loads of a job, with the amplitudes of users and the loads of the first step.
  subroutine create_driven_loads(driven_loads, model)
    type(driven_loads_type), intent(inout) :: driven_loads
    type(model_type), intent(in) :: model
    if (any(model%amplitudes%is_user)) call own_amplitudes(driven_loads, model)
    if (size(model%steps) > 0) call select_step_loads(driven_loads, model, 1)
  end subroutine create_driven_loads


  !> Makes a step the current one, with its loads.
  subroutine select_step_loads(driven_loads, model, i_step)
    type(driven_loads_type), intent(inout) :: driven_loads
    type(model_type), intent(in) :: model
    integer, intent(in) :: i_step                  !< index into model%steps
    driven_loads%step = driven_step(driven_loads, model, i_step)
  end subroutine select_step_loads


  !> A step of the model with the driven loads.
  function driven_step(driven_loads, model, i_step) result(step)
    type(driven_loads_type), intent(in) :: driven_loads
    type(model_type), intent(in) :: model
    integer, intent(in) :: i_step                  !< index into model%steps
    type(step_type) :: step
    integer :: kind, i, k
    step = model%steps(i_step)
    if (allocated(driven_loads%step%amplitudes)) step%amplitudes = driven_loads%step%amplitudes
    if (allocated(driven_loads%friction)) then
      if (.not. allocated(step%interactions)) step%interactions = model%interactions
      do i = 1, size(driven_loads%friction)        ! a penalty at dependent slave nodes has the name of its law
        if (driven_loads%friction(i) < 0) cycle
        do k = 1, size(step%interactions)
          if (step%interactions(k)%name == step%interactions(i)%name) step%interactions(k)%friction = driven_loads%friction(i)
        end do
      end do
    end if
    if (.not. allocated(driven_loads%entries)) return
    do kind = 1, N_DRIVEN_KINDS
      call redirect_loads(step, kind, pack(driven_loads%entries%item, driven_loads%entries%kind == kind), &
        pack(driven_loads%entries%amplitude, driven_loads%entries%kind == kind))
    end do
  end function driven_step


  !> Makes the amplitudes settable: a copy of those of the model.
  subroutine own_amplitudes(driven_loads, model)
    type(driven_loads_type), intent(inout) :: driven_loads
    type(model_type), intent(in) :: model
    if (.not. allocated(driven_loads%step%amplitudes)) driven_loads%step%amplitudes = model%amplitudes
  end subroutine own_amplitudes


  !> Sets the values of some items.
  !!
  !! Errors (EXIT_USAGE): a displacement that the deck does not prescribe in the step that runs.
  subroutine set_driven(driven_loads, model, i_step, kind, items, values, now, error)
    type(driven_loads_type), intent(inout) :: driven_loads
    type(model_type), intent(in) :: model
    integer, intent(in) :: i_step                  !< current step, or the first
    integer, intent(in) :: kind                    !< DRIVEN_...
    integer, intent(in) :: items(:)                !< each once
    real(DP), intent(in) :: values(:)              !< one per item
    real(DP), intent(in) :: now(:)                 !< total and step time; displacements, temperatures: also current values
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    logical :: has_new
    call allocate_entries(driven_loads, model)
    if (kind == DRIVEN_TEMPERATURE) call check_temperature(model, error)
    if (kind == DRIVEN_DISPLACEMENT) call check_prescribed(model, model%steps(i_step), items, error)
    if (allocated(error)) return
    has_new = any(driven_loads%entry_index(items, kind) == 0)
    call add_entries(driven_loads, model, i_step, kind, pack(items, driven_loads%entry_index(items, kind) == 0), &
      pack([(i, i=1, size(items))], driven_loads%entry_index(items, kind) == 0), now)
    do i = 1, size(items)
      associate (entry => driven_loads%entries(driven_loads%entry_index(items(i), kind)))
        entry%target = values(i)
        entry%is_pending = .true.
        entry%is_active = .false.
      end associate
    end do
    if (has_new) call select_step_loads(driven_loads, model, driven_loads%step%number)
  end subroutine set_driven


  !> Allocates the index of driven values.
  subroutine allocate_entries(driven_loads, model)
    type(driven_loads_type), intent(inout) :: driven_loads
    type(model_type), intent(in) :: model
    if (allocated(driven_loads%entries)) return
    allocate (driven_loads%entries(0))
    allocate (driven_loads%entry_index(max(3 * model%mesh%n_nodes, 6 * model%mesh%n_elements), N_DRIVEN_KINDS), source=0)
  end subroutine allocate_entries


  !> Sets the coefficient of friction of an interaction, for the current and later steps.
  subroutine set_friction(driven_loads, model, i, mu)
    type(driven_loads_type), intent(inout) :: driven_loads
    type(model_type), intent(in) :: model
    integer, intent(in) :: i                       !< interaction
    real(DP), intent(in) :: mu                     !< [-]
    if (.not. allocated(driven_loads%friction)) allocate (driven_loads%friction(size(model%interactions)), source=-1.0_DP)
    driven_loads%friction(i) = mu
    if (size(model%steps) > 0) call select_step_loads(driven_loads, model, driven_loads%step%number)
  end subroutine set_friction


  !> The coefficient of friction of an interaction: the one that was set, else the deck's.
  pure real(DP) function friction_now(driven_loads, model, i) result(mu)
    type(driven_loads_type), intent(in) :: driven_loads
    type(model_type), intent(in) :: model
    integer, intent(in) :: i                       !< interaction
    mu = model%interactions(i)%friction
    if (.not. allocated(driven_loads%friction)) return
    if (driven_loads%friction(i) >= 0) mu = driven_loads%friction(i)
  end function friction_now


  !> All driven values as numbers for a checkpoint, valid after the current commit. (8, n): kind,
  !! item, target, whether it is pending, two times, two factors.
  pure subroutine list_driven(driven_loads, model, driven, friction)
    type(driven_loads_type), intent(in) :: driven_loads
    type(model_type), intent(in) :: model
    real(DP), allocatable, intent(inout) :: driven(:, :)  !< (8, n)
    real(DP), allocatable, intent(inout) :: friction(:)   !< (n_interactions) negative: the deck's
    integer :: i, n
    if (allocated(driven)) deallocate (driven)
    if (allocated(friction)) deallocate (friction)
    n = 0
    if (allocated(driven_loads%entries)) n = size(driven_loads%entries)
    allocate (driven(N_ENTRY_NUMBERS, n), friction(size(model%interactions)))
    friction = -1
    if (allocated(driven_loads%friction)) friction = driven_loads%friction
    do i = 1, n
      associate (entry => driven_loads%entries(i), amplitude => driven_loads%step%amplitudes(driven_loads%entries(i)%amplitude))
        driven(:, i) = [real([entry%kind, entry%item], DP), entry%target, &
          merge(1.0_DP, 0.0_DP, entry%is_pending .and. .not. entry%is_active), amplitude%time, amplitude%factor]
      end associate
    end do
  end subroutine list_driven


  !> Restores the driven values of a checkpoint, starting from the loads of the deck.
  subroutine restore_driven(driven_loads, model, driven, friction)
    type(driven_loads_type), intent(inout) :: driven_loads
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: driven(:, :)           !< (8, n) as list_driven gives it
    real(DP), intent(in) :: friction(:)            !< (n_interactions) negative: the deck's [-]
    integer, allocatable :: kinds(:), items(:)
    integer :: first, last, i
    do i = 1, size(friction)
      if (friction(i) >= 0) call set_friction(driven_loads, model, i, friction(i))
    end do
    if (size(driven, 2) == 0) return
    call allocate_entries(driven_loads, model)
    kinds = nint(driven(1, :))
    items = nint(driven(2, :))
    first = 1
    do while (first <= size(kinds))
      last = first
      do while (last < size(kinds))
        if (kinds(last + 1) /= kinds(first)) exit
        last = last + 1
      end do
      call add_entries(driven_loads, model, 1, kinds(first), items(first:last), [(i, i=1, last - first + 1)], &
        [(0.0_DP, i=1, last - first + 3)])
      first = last + 1
    end do
    do i = 1, size(kinds)
      associate (entry => driven_loads%entries(i), amplitude => driven_loads%step%amplitudes(driven_loads%entries(i)%amplitude))
        entry%target = driven(3, i)
        entry%is_pending = driven(4, i) > 0
        amplitude%time = driven(5:6, i)
        amplitude%factor = driven(7:8, i)
      end associate
    end do
  end subroutine restore_driven


  !> Temperatures can be set only if the deck has some: otherwise the materials have no thermal expansion.
  subroutine check_temperature(model, error)
    type(model_type), intent(in) :: model
    type(error_type), allocatable, intent(out) :: error
    if (.not. allocated(model%initial_temperature)) call set_error(error, EXIT_USAGE, 'Temperatures cannot be set: the ' // &
      'deck has none. Give it *INITIAL CONDITIONS, TYPE=TEMPERATURE.')
  end subroutine check_temperature


  !> Only displacements that the deck prescribes can be driven: the others are free unknowns of the equations.
  subroutine check_prescribed(model, step, items, error)
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    integer, intent(in) :: items(:)
    type(error_type), allocatable, intent(out) :: error
    logical, allocatable :: is_prescribed(:)
    integer :: i
    allocate (is_prescribed(3 * model%mesh%n_nodes), source=.false.)
    is_prescribed(3 * (step%prescribed%node - 1) + step%prescribed%dof) = .true.
    if (all(is_prescribed(items))) return
    i = findloc(is_prescribed(items), .false., dim=1)
    call set_error(error, EXIT_USAGE, 'The displacement of node ' // to_text(model%mesh%node_label((items(i) + 2) / 3)) // &
      ' in direction ' // to_text(mod(items(i) - 1, 3) + 1) // ' cannot be set: it is free. Prescribe it in the deck, ' // &
      'with *BOUNDARY and any value, in this step.')
  end subroutine check_prescribed


  !> Adds entries with constant amplitudes at the current values.
  subroutine add_entries(driven_loads, model, i_step, kind, items, positions, now)
    type(driven_loads_type), intent(inout) :: driven_loads
    type(model_type), intent(in) :: model
    integer, intent(in) :: i_step, kind
    integer, intent(in) :: items(:)                !< new ones
    integer, intent(in) :: positions(:)            !< their positions in the caller's list
    real(DP), intent(in) :: now(:)
    type(amplitude_type), allocatable :: amplitudes(:)
    real(DP), allocatable :: values(:)
    integer :: i, n
    if (size(items) == 0) return
    call own_amplitudes(driven_loads, model)
    n = size(driven_loads%step%amplitudes)
    allocate (amplitudes(n + size(items)))
    amplitudes(:n) = driven_loads%step%amplitudes
    if (kind == DRIVEN_DISPLACEMENT .or. kind == DRIVEN_TEMPERATURE) then
      values = now(2 + positions)
    else
      values = current_loads(driven_loads, model, i_step, kind, items, now)
    end if
    do i = 1, size(items)
      amplitudes(n + i)%name = ''
      amplitudes(n + i)%is_total_time = .true.
      amplitudes(n + i)%time = [now(1), now(1) + 1.0_DP]
      amplitudes(n + i)%factor = [values(i), values(i)]
      driven_loads%entry_index(items(i), kind) = size(driven_loads%entries) + i
    end do
    driven_loads%entries = [driven_loads%entries, [(driven_entry_type(kind=kind, item=items(i), amplitude=n + i), i=1, &
      size(items))]]
    call move_alloc(amplitudes, driven_loads%step%amplitudes)
  end subroutine add_entries


  !> Loads on some items at a time, summed: driven values, else those of the deck.
  function current_loads(driven_loads, model, i_step, kind, items, now) result(values)
    type(driven_loads_type), intent(in) :: driven_loads
    type(model_type), intent(in) :: model
    integer, intent(in) :: i_step                  !< index into model%steps
    integer, intent(in) :: kind
    integer, intent(in) :: items(:)
    real(DP), intent(in) :: now(:)                 !< total time, step time [time]
    real(DP), allocatable :: values(:)             !< [force] or [stress]
    real(DP), allocatable :: sums(:)
    type(step_type) :: step
    integer :: i, k
    step = driven_step(driven_loads, model, i_step)
    allocate (sums(max(3 * model%mesh%n_nodes, 6 * model%mesh%n_elements)), source=0.0_DP)
    if (kind == DRIVEN_FORCE) then
      do i = 1, size(step%concentrated)
        k = item_of_force(step%concentrated(i))
        if (k > 0) sums(k) = sums(k) + load_now(model, step, step%concentrated(i), now(2), now(1))
      end do
    else
      do i = 1, size(step%distributed)
        if (step%distributed(i)%kind /= DISTRIBUTED_PRESSURE) cycle
        k = item_of_pressure(step%distributed(i))
        sums(k) = sums(k) + load_now(model, step, step%distributed(i), now(2), now(1))
      end do
    end if
    values = sums(items)
  end function current_loads


  !> The item of a force; 0: it turns with its node.
  elemental integer function item_of_force(load)
    type(concentrated_type), intent(in) :: load
    item_of_force = merge(0, 3 * (load%node - 1) + load%dof, load%is_follower)
  end function item_of_force


  !> The item of a pressure.
  elemental integer function item_of_pressure(load)
    type(distributed_type), intent(in) :: load
    item_of_pressure = 6 * (load%element - 1) + load%face
  end function item_of_pressure


  !> Replaces the loads of a step on some items by driven ones with amplitudes; forces and pressures of the deck are removed.
  subroutine redirect_loads(step, kind, items, amplitudes)
    type(step_type), intent(inout) :: step
    integer, intent(in) :: kind                    !< DRIVEN_...
    integer, intent(in) :: items(:)                !< each once
    integer, intent(in) :: amplitudes(:)           !< of the items: index into step%amplitudes
    integer, allocatable :: order(:)
    integer :: i, k
    if (size(items) == 0) return
    if (kind == DRIVEN_TEMPERATURE) then
      if (.not. allocated(step%temperatures)) allocate (step%temperatures(0))
      step%temperatures = [step%temperatures, [(temperature_type(end=1.0_DP, amplitude=amplitudes(i), node=items(i)), &
        i=1, size(items))]]                        ! the last of several for a node counts
      return
    end if
    allocate (order(maxval(items)), source=0)
    order(items) = [(i, i=1, size(items))]
    select case (kind)
    case (DRIVEN_DISPLACEMENT)
      do i = 1, size(step%prescribed)
        associate (load => step%prescribed(i))
          k = order_of(order, 3 * (load%node - 1) + load%dof)
          if (k == 0) cycle
          load%load_type = load_type(end=1.0_DP, amplitude=amplitudes(k))
          load%is_held = .false.
          load%is_velocity = .false.
          load%is_from_current = .false.
        end associate
      end do
    case (DRIVEN_FORCE)
      step%concentrated = [pack(step%concentrated, order_of(order, item_of_force(step%concentrated)) == 0), &
        [(concentrated_type(end=1.0_DP, amplitude=amplitudes(i), node=(items(i) + 2) / 3, dof=mod(items(i) - 1, 3) + 1), &
        i=1, size(items))]]
    case default
      step%distributed = [pack(step%distributed, order_of(order, item_of_pressure(step%distributed)) == 0 .or. &
        step%distributed%kind /= DISTRIBUTED_PRESSURE), [(distributed_type(end=1.0_DP, amplitude=amplitudes(i), &
        kind=DISTRIBUTED_PRESSURE, element=(items(i) + 5) / 6, face=mod(items(i) - 1, 6) + 1), i=1, size(items))]]
    end select
  end subroutine redirect_loads


  !> Position of an item in the list of new ones; 0: not in it.
  pure integer function order_of_item(order, item) result(position)
    integer, intent(in) :: order(:), item
    position = 0
    if (item >= 1 .and. item <= size(order)) position = order(item)
  end function order_of_item


  !> The same for several items.
  pure function order_of_items(order, items) result(positions)
    integer, intent(in) :: order(:), items(:)
    integer :: positions(size(items)), i
    positions = [(order_of_item(order, items(i)), i=1, size(items))]
  end function order_of_items


  !> Before an attempt from t0 to t1: pending values get an amplitude linear to their target.
  pure subroutine activate_driven(driven_loads, t0, t1)
    type(driven_loads_type), intent(inout) :: driven_loads
    real(DP), intent(in) :: t0, t1                 !< total time [time]
    integer :: i
    if (.not. allocated(driven_loads%entries)) return
    do i = 1, size(driven_loads%entries)
      if (.not. driven_loads%entries(i)%is_pending) cycle
      associate (amplitude => driven_loads%step%amplitudes(driven_loads%entries(i)%amplitude))
        amplitude%factor = [amplitude_value(amplitude, t0), driven_loads%entries(i)%target]
        amplitude%time = [t0, t1]
        driven_loads%entries(i)%is_active = .true.
      end associate
    end do
  end subroutine activate_driven


  !> After a commit: pending values become active.
  pure subroutine finish_driven(driven_loads)
    type(driven_loads_type), intent(inout) :: driven_loads
    if (allocated(driven_loads%entries)) driven_loads%entries%is_pending = driven_loads%entries%is_pending &
      .and. .not. driven_loads%entries%is_active
  end subroutine finish_driven

end module amontons_driven_loads
