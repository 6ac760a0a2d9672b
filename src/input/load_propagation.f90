!> Loads and boundary conditions that persist over steps (OP=MOD, OP=NEW).
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! | case | start of the step | end of the step |
!! |---|---|---|
!! | new in this step | 0; a displacement: its current value | its value |
!! | given again in this step | value at the end of the last step | its new value; forces of one step add up |
!! | a velocity: kept or given | the displacement at the start of the step | after its integral over the step |
!! | a displacement of a global model (SUBMODEL) | its current value | by the results; kept: as it is then |
!! | kept from the last step | value at the end of that step | the same |
!! | OP=NEW, not given again | displacement: released; load: value at the end of the last step, in the calculix dialect 0 if it |
!! | | has an amplitude of total time | load: 0 |
!! | STEP, AMPLITUDE=STEP | the value at the end | |
!! | a pressure of a node (PnNP) | that of the second displacement prescribed at the node | |
!! | with an amplitude | reference value times amplitude; continues only in total time | |
module amontons_load_propagation
  use amontons_kinds, only: DP
  use amontons_containers, only: name_table_type
  use amontons_loads, only: load_type, load_value, prescribed_type, concentrated_type, distributed_type, &
    DISTRIBUTED_PRESSURE, DISTRIBUTED_GRAVITY, DISTRIBUTED_CENTRIFUGAL
  use amontons_model, only: model_type, DIALECT_CALCULIX
  implicit none
  private
  public :: active_loads_type, load_region_type, init_active_loads, propagate_loads, &
    truncate_loads, release_prescribed, prescribe_dof, &
    ramp_down_loads, add_load, set_node_pressures, find_or_add_place, has_other_rotation, get_step_loads
  public :: LOAD_BOUNDARY, LOAD_CLOAD, LOAD_DLOAD, LOAD_VOLUME

  integer, parameter :: LOAD_BOUNDARY = 1, LOAD_CLOAD = 2, LOAD_DLOAD = 3, LOAD_VOLUME = 4

  !> An active prescribed displacement.
  type, extends(prescribed_type) :: active_prescribed_type
    real(DP) :: before = 0                       !< value at the end of the step before
    logical :: was_active = .false.              !< it acted in the step before
    logical :: is_active = .true.                !< it acts in this step
    integer :: step = 0                          !< step that gave it last; 0: the model
  end type active_prescribed_type

  !> An active load.
  type, extends(load_type) :: active_load_type
    integer :: key = 0                           !< what it acts on
    real(DP) :: before = 0                       !< value at the end of the step before
    logical :: is_active = .true.
    integer :: step = 0                          !< step that gave it last
    integer :: node = 0                          !< the pressure is the second prescribed displacement of this node; 0: none
    integer :: next = 0                          !< next load at the same place
  end type active_load_type

  !> Loads by their target.
  type :: load_list_type
    integer :: n = 0
    type(active_load_type), allocatable :: items(:)
    integer, allocatable :: head(:)              !< (keys) first load at it, 0 none
  end type load_list_type

  !> Region, type and direction of a load on volumes or of a traction.
  type :: load_region_type
    integer :: kind = DISTRIBUTED_GRAVITY        !< DISTRIBUTED_GRAVITY, _SPIN, _BODY or _TRACTION
    character(:), allocatable :: region          !< squeezed name or number
    integer, allocatable :: elements(:)
    integer, allocatable :: faces(:)             !< of a traction
    logical :: is_follower = .false.            !< default for a traction: rotates with its face, per current area
    logical :: is_user = .false.                 !< UTRACLOAD gives the traction
    logical :: is_shear = .false.                !< it acts along the faces; of UTRACLOAD
    integer :: surface = 0                       !< of UTRACLOAD; 0: on elements
    real(DP) :: direction(3) = 0                 !< unit vector
    real(DP), allocatable :: face_directions(:, :)   !< (3, faces) unit vectors of a shear traction
    real(DP) :: point(3) = 0                     !< of the axis of spin [length]
    integer :: previous = 0                      !< the place before on the same region, 0 none
  end type load_region_type

  !> All loads active at this point of the deck.
  type :: active_loads_type
    integer :: step = 0                          !< present step
    logical :: is_step = .false.                 !< STEP, AMPLITUDE=STEP
    logical :: has_new(4) = .false.              !< (FAMILY_...) OP=NEW occurred in this step
    integer :: n_held = 0
    type(active_prescribed_type), allocatable :: active_prescribed(:)
    integer, allocatable :: prescribed_index(:)           !< (3 n_nodes) index into active_prescribed, 0 none
    type(load_list_type) :: cloads                  !< key 3 (node - 1) + dof; plus 3 n_nodes with FOLLOWER
    type(load_list_type) :: pressures               !< key 6 (element - 1) + face
    type(load_list_type) :: volumes                 !< key: index into places
    integer :: n_places = 0                      !< the rest of the places is empty
    type(load_region_type), allocatable :: places(:)
    type(name_table_type) :: regions             !< names of the regions of places
    integer, allocatable :: last_place(:)        !< (regions) the last place on each
  end type active_loads_type

contains

  !> Starts without active loads.
  subroutine init_active_loads(model, active_loads)
    type(model_type), intent(in) :: model
    type(active_loads_type), intent(out) :: active_loads
    allocate (active_loads%active_prescribed(256), active_loads%places(16), active_loads%last_place(16))
    allocate (active_loads%prescribed_index(3 * model%mesh%n_nodes), source=0)
    allocate (active_loads%cloads%head(6 * model%mesh%n_nodes), source=0)
    allocate (active_loads%pressures%head(6 * model%mesh%n_elements), source=0)
    allocate (active_loads%volumes%head(16), source=0)
    allocate (active_loads%cloads%items(256), active_loads%pressures%items(256), active_loads%volumes%items(16))
  end subroutine init_active_loads


  !> Advances to the next step: all loads keep their value at the end of the last step.
  subroutine propagate_loads(model, period, total_time, is_step, active_loads)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: period               !< length of the step before [time]
    real(DP), intent(in) :: total_time           !< total time at its end [time]
    logical, intent(in) :: is_step               !< AMPLITUDE=STEP holds in the new step
    type(active_loads_type), intent(inout) :: active_loads
    integer :: i
    active_loads%step = active_loads%step + 1
    active_loads%is_step = is_step
    active_loads%has_new = .false.
    do i = 1, active_loads%n_held
      associate (held => active_loads%active_prescribed(i))
        held%was_active = held%is_active
        held%is_from_current = .false.
        if (active_loads%step == 1) cycle            ! of the model: ramps to its value over the first step
        if (held%global_step /= 0) then              ! the global model no longer moves it
          held%global_step = 0
          held%is_held = .true.
        end if
        call freeze_load(model, period, total_time, held%load_type, held%before)
      end associate
    end do
    call freeze_load_list(model, period, total_time, active_loads%cloads)
    call freeze_load_list(model, period, total_time, active_loads%pressures)
    call freeze_load_list(model, period, total_time, active_loads%volumes)
  end subroutine propagate_loads


  !> Values of the loads of a step that ends early: the fraction of the ramps that was reached.
  subroutine truncate_loads(active_loads, fraction)
    type(active_loads_type), intent(inout) :: active_loads
    real(DP), intent(in) :: fraction             !< of the step that was done [-]
    integer :: i
    do i = 1, active_loads%n_held
      call truncate_load(active_loads%active_prescribed(i)%load_type)
    end do
    do i = 1, active_loads%cloads%n
      call truncate_load(active_loads%cloads%items(i)%load_type)
    end do
    do i = 1, active_loads%pressures%n
      call truncate_load(active_loads%pressures%items(i)%load_type)
    end do
    do i = 1, active_loads%volumes%n
      call truncate_load(active_loads%volumes%items(i)%load_type)
    end do

  contains

    !> The same for one load.
    subroutine truncate_load(load)
      type(load_type), intent(inout) :: load
      if (load%amplitude == 0) load%end = load%start + (load%end - load%start) * fraction
    end subroutine truncate_load

  end subroutine truncate_loads


  !> A load after its step: constant at its last value, unless its amplitude runs in total time.
  subroutine freeze_load(model, period, total_time, load, before)
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
  end subroutine freeze_load


  !> Removes the zero loads, and compacts the list.
  subroutine freeze_load_list(model, period, total_time, forces)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: period, total_time   !< [time]
    type(load_list_type), intent(inout) :: forces
    type(active_load_type) :: force
    integer :: i, n
    n = 0
    do i = 1, forces%n
      forces%head(forces%items(i)%key) = 0
    end do
    do i = 1, forces%n
      force = forces%items(i)
      if (.not. force%is_active) cycle
      call freeze_load(model, period, total_time, force%load_type, force%before)
      if (.not. (abs(force%end) > 0 .or. force%is_user .or. force%node > 0)) cycle
      n = n + 1
      force%next = forces%head(force%key)
      forces%head(force%key) = n
      forces%items(n) = force
    end do
    forces%n = n
  end subroutine freeze_load_list


  !> OP=NEW: releases the displacements prescribed by earlier steps, once in a step.
  subroutine release_prescribed(step, active_loads)
    integer, intent(in) :: step
    type(active_loads_type), intent(inout) :: active_loads
    integer :: i
    if (active_loads%has_new(LOAD_BOUNDARY) .or. step == 0) return
    active_loads%has_new(LOAD_BOUNDARY) = .true.
    do i = 1, active_loads%n_held
      if (active_loads%active_prescribed(i)%step < step) active_loads%active_prescribed(i)%is_active = .false.
    end do
  end subroutine release_prescribed


  !> Prescribes one degree of freedom.
  subroutine prescribe_dof(new, step, active_loads, n_changed)
    type(prescribed_type), intent(in) :: new     !< with node, dof, end, amplitude, is_held, line
    integer, intent(in) :: step
    type(active_loads_type), intent(inout) :: active_loads
    integer, intent(inout) :: n_changed
    type(active_prescribed_type), allocatable :: larger(:)
    integer :: i
    logical :: was_held, was_here
    i = active_loads%prescribed_index(3 * new%node - 3 + new%dof)
    was_here = i > 0
    if (.not. was_here) then
      if (active_loads%n_held == size(active_loads%active_prescribed)) then
        allocate (larger(2 * active_loads%n_held))
        larger(:active_loads%n_held) = active_loads%active_prescribed
        call move_alloc(larger, active_loads%active_prescribed)
      end if
      active_loads%n_held = active_loads%n_held + 1
      i = active_loads%n_held
      active_loads%prescribed_index(3 * new%node - 3 + new%dof) = i
    end if
    associate (held => active_loads%active_prescribed(i))
      if (was_here .and. held%step == step .and. held%is_active) then
        if (is_different(held, new)) n_changed = n_changed + 1
      end if
      was_held = (held%is_held .or. held%is_velocity) .and. held%was_active
      held%prescribed_type = new
      held%start = held%before
      held%is_from_current = step > 1 .and. (was_held .or. .not. held%was_active)
      if (active_loads%is_step .and. new%amplitude == 0) then
        held%start = held%end
        held%is_from_current = .false.
      end if
      if (new%is_velocity) held%start = new%end     ! the velocity is constant unless it has an amplitude
      if (new%is_held .or. new%global_step /= 0) held%is_from_current = .true.
      held%step = step
      held%is_active = .true.
    end associate
  end subroutine prescribe_dof


  !> Whether a prescription differs from the one given before.
  pure function is_different(held, new) result(differs)
    type(active_prescribed_type), intent(in) :: held
    type(prescribed_type), intent(in) :: new
    logical :: differs
    differs = abs(held%end - new%end) > 0 .or. held%amplitude /= new%amplitude .or. (held%is_held .neqv. new%is_held) &
      .or. held%global_step /= new%global_step &
      .or. (held%is_user .neqv. new%is_user) .or. (held%is_velocity .neqv. new%is_velocity)
  end function is_different


  !> OP=NEW: ramps the loads of earlier steps to zero over this step, once in a step. In CalculiX a load whose amplitude of total
  !! time continues is zero times that amplitude, which is zero from the start of the step.
  subroutine ramp_down_loads(step, is_step, dialect, has_new, forces)
    integer, intent(in) :: step                  !< present step
    logical, intent(in) :: is_step               !< STEP, AMPLITUDE=STEP
    integer, intent(in) :: dialect               !< DIALECT_...
    logical, intent(inout) :: has_new            !< OP=NEW occurred in this step
    type(load_list_type), intent(inout) :: forces
    integer :: i
    if (has_new) return
    has_new = .true.
    do i = 1, forces%n
      associate (force => forces%items(i))
        if (force%step == step) cycle
        force%start = merge(0.0_DP, force%before, is_step .or. (dialect == DIALECT_CALCULIX .and. force%amplitude > 0))
        force%amplitude = 0
        force%node = 0
        force%end = 0
        if (force%is_user) force%is_active = .false.   ! a magnitude by DLOAD cannot be ramped to zero
      end associate
    end do
  end subroutine ramp_down_loads


  !> Adds a load: replaces those of earlier steps, adds to those of this step.
  subroutine add_load(key, value, amplitude, step, is_step, forces, is_user, node)
    integer, intent(in) :: key                   !< what it acts on
    real(DP), intent(in) :: value
    integer, intent(in) :: amplitude             !< 0: none
    integer, intent(in) :: step
    logical, intent(in) :: is_step               !< STEP, AMPLITUDE=STEP
    type(load_list_type), intent(inout) :: forces
    logical, intent(in), optional :: is_user     !< DLOAD gives the magnitude
    integer, intent(in), optional :: node        !< a displacement prescribed at this node is the magnitude
    type(active_load_type), allocatable :: larger(:)
    type(active_load_type) :: new
    integer :: i
    if (present(is_user)) new%is_user = is_user
    if (present(node)) new%node = node
    i = forces%head(key)
    do while (i > 0)
      associate (old => forces%items(i))
        if (old%step == step .and. old%amplitude == amplitude .and. (old%is_user .eqv. new%is_user) .and. max(old%node, new%node) &
          == 0) then
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
  end subroutine add_load


  !> Gives the pressures of nodes the values of the step: those of the second displacement prescribed there.
  subroutine set_node_pressures(active_loads, missing)
    type(active_loads_type), intent(inout) :: active_loads
    integer, intent(out) :: missing              !< a node at which none is prescribed, or one without a value; 0: none
    integer :: i, p
    missing = 0
    do i = 1, active_loads%pressures%n
      associate (force => active_loads%pressures%items(i))
        if (force%node == 0 .or. .not. force%is_active) cycle
        p = active_loads%prescribed_index(3 * force%node - 1)
        if (p > 0) then
          associate (held => active_loads%active_prescribed(p))
            force%load_type = held%load_type
            if (held%is_active .and. .not. (held%is_held .or. held%is_velocity .or. held%is_user)) cycle
          end associate
        end if
        missing = force%node
      end associate
    end do
  end subroutine set_node_pressures


  !> The place of a load on volumes or of a traction, added if it is new. Cost: constant in the mean, but for the places on one
  !! region, which are compared.
  subroutine find_or_add_place(active_loads, place, found)
    type(active_loads_type), intent(inout) :: active_loads
    type(load_region_type), intent(in) :: place
    integer, intent(out) :: found                !< index into the places
    type(load_region_type), allocatable :: larger(:)
    integer :: region
    logical :: is_new
    call active_loads%regions%add('.' // place%region, region, is_new)
    if (region > size(active_loads%last_place)) active_loads%last_place = [active_loads%last_place, spread(0, 1, region)]
    if (is_new) active_loads%last_place(region) = 0
    found = active_loads%last_place(region)
    do while (found > 0)
      if (is_same_region(active_loads%places(found), place)) return
      found = active_loads%places(found)%previous
    end do
    associate (n => active_loads%n_places)
      if (n == size(active_loads%places)) then
        allocate (larger(2 * n))
        larger(:n) = active_loads%places
        call move_alloc(larger, active_loads%places)
        active_loads%volumes%head = [active_loads%volumes%head, spread(0, 1, n)]
      end if
      n = n + 1
      active_loads%places(n) = place
      active_loads%places(n)%previous = active_loads%last_place(region)
      active_loads%last_place(region) = n
      found = n
    end associate
  end subroutine find_or_add_place


  !> Whether elements of a rotation have another one, active or not: about another axis, or of another region.
  pure logical function has_other_rotation(active_loads, place) result(has)
    type(active_loads_type), intent(in) :: active_loads
    type(load_region_type), intent(in) :: place
    logical, allocatable :: is_loaded(:)
    integer :: i
    has = .false.
    if (place%kind /= DISTRIBUTED_CENTRIFUGAL .or. size(place%elements) == 0) return
    allocate (is_loaded(maxval(place%elements)), source=.false.)
    is_loaded(place%elements) = .true.
    do i = 1, active_loads%n_places
      associate (other => active_loads%places(i))
        if (other%kind /= DISTRIBUTED_CENTRIFUGAL .or. is_same_region(other, place)) cycle
        has = has .or. any(is_loaded(pack(other%elements, other%elements <= size(is_loaded))))
      end associate
    end do
  end function has_other_rotation


  !> Whether two loads on volumes are of the same kind on the same region in the same directions.
  pure logical function is_same_region(a, b)
    type(load_region_type), intent(in) :: a, b
    is_same_region = a%kind == b%kind .and. a%region == b%region .and. (a%is_follower .eqv. b%is_follower) &
      .and. (a%is_user .eqv. b%is_user) .and. (a%is_shear .eqv. b%is_shear) &
      .and. (allocated(a%face_directions) .eqv. allocated(b%face_directions)) &
      .and. all(abs(a%direction - b%direction) < 1.0e-12_DP) .and. .not. any(abs(a%point - b%point) > 0)
  end function is_same_region


  !> The complete lists of the loads active in the current step.
  subroutine get_step_loads(active_loads, prescribed, concentrated, distributed)
    type(active_loads_type), intent(in) :: active_loads
    type(prescribed_type), allocatable, intent(out) :: prescribed(:)
    type(concentrated_type), allocatable, intent(out) :: concentrated(:)
    type(distributed_type), allocatable, intent(out) :: distributed(:)
    integer :: i, n, key, n_keys
    n_keys = size(active_loads%cloads%head) / 2
    allocate (prescribed(count(active_loads%active_prescribed(:active_loads%n_held)%is_active)))
    n = 0
    do i = 1, active_loads%n_held
      if (.not. active_loads%active_prescribed(i)%is_active) cycle
      n = n + 1
      prescribed(n) = active_loads%active_prescribed(i)%prescribed_type
    end do
    allocate (concentrated(count(active_loads%cloads%items(:active_loads%cloads%n)%is_active)))
    n = 0
    do i = 1, active_loads%cloads%n
      associate (force => active_loads%cloads%items(i))
        if (.not. force%is_active) cycle
        n = n + 1
        concentrated(n)%load_type = force%load_type
        concentrated(n)%is_follower = force%key > n_keys
        key = modulo(force%key - 1, n_keys)
        concentrated(n)%node = key / 3 + 1
        concentrated(n)%dof = modulo(key, 3) + 1
      end associate
    end do
    call get_distributed_loads(active_loads, distributed)
  end subroutine get_step_loads


  !> Pressures face by face and loads on volumes element by element.
  subroutine get_distributed_loads(active_loads, distributed)
    type(active_loads_type), intent(in) :: active_loads
    type(distributed_type), allocatable, intent(out) :: distributed(:)
    integer :: i, k, n
    n = count(active_loads%pressures%items(:active_loads%pressures%n)%is_active)
    do i = 1, active_loads%volumes%n
      if (active_loads%volumes%items(i)%is_active) n = n + size(active_loads%places(active_loads%volumes%items(i)%key)%elements)
    end do
    allocate (distributed(n))
    n = 0
    do i = 1, active_loads%pressures%n
      associate (force => active_loads%pressures%items(i))
        if (.not. force%is_active) cycle
        n = n + 1
        distributed(n)%load_type = force%load_type
        distributed(n)%kind = DISTRIBUTED_PRESSURE
        distributed(n)%element = (force%key - 1) / 6 + 1
        distributed(n)%face = modulo(force%key - 1, 6) + 1
        distributed(n)%node = force%node
      end associate
    end do
    do i = 1, active_loads%volumes%n
      associate (force => active_loads%volumes%items(i), place => active_loads%places(active_loads%volumes%items(i)%key))
        if (.not. force%is_active) cycle
        do k = 1, size(place%elements)
          n = n + 1
          distributed(n)%load_type = force%load_type
          distributed(n)%kind = place%kind
          distributed(n)%element = place%elements(k)
          if (allocated(place%faces)) distributed(n)%face = place%faces(k)
          distributed(n)%is_follower = place%is_follower
          distributed(n)%is_shear = place%is_shear
          distributed(n)%surface = place%surface
          distributed(n)%direction = place%direction
          if (allocated(place%face_directions)) distributed(n)%direction = place%face_directions(:, k)
          distributed(n)%point = place%point
        end do
      end associate
    end do
  end subroutine get_distributed_loads

end module amontons_load_propagation
