!> Standing: the loads that stand at a point of the deck, those that earlier steps left there among them.
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
module amontons_load_propagation
  use amontons_kinds, only: DP
  use amontons_loads, only: load_type, load_value, prescribed_type, concentrated_type, distributed_type, &
    DISTRIBUTED_PRESSURE, DISTRIBUTED_GRAVITY
  use amontons_model, only: model_type
  implicit none
  private
  public :: standing_type, forces_type, held_type, volume_type, start_standing, begin_step, cut_loads, release_held, hold, &
    fade_forces, add_force, is_same_place, hand_over_loads
  public :: FAMILY_BOUNDARY, FAMILY_CLOAD, FAMILY_DLOAD, FAMILY_VOLUME

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

  !> Where a load on volumes, or a traction, acts, and how.
  type :: volume_type
    integer :: kind = DISTRIBUTED_GRAVITY        !< DISTRIBUTED_GRAVITY, _SPIN, _BODY or _TRACTION
    character(:), allocatable :: region          !< squeezed name or number
    integer, allocatable :: elements(:)
    integer, allocatable :: faces(:)             !< of a traction
    logical :: is_following = .false.            !< a traction not told to keep direction and size
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


  !> Whether two loads on volumes are of the same kind on the same region in the same directions.
  pure logical function is_same_place(a, b)
    type(volume_type), intent(in) :: a, b
    is_same_place = a%kind == b%kind .and. a%region == b%region .and. (a%is_following .eqv. b%is_following) &
      .and. all(abs(a%direction - b%direction) < 1.0e-12_DP) .and. .not. any(abs(a%point - b%point) > 0)
  end function is_same_place


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
          if (allocated(place%faces)) distributed(n)%face = place%faces(k)
          distributed(n)%is_following = place%is_following
          distributed(n)%direction = place%direction
          distributed(n)%point = place%point
        end do
      end associate
    end do
  end subroutine hand_over_distributed

end module amontons_load_propagation
