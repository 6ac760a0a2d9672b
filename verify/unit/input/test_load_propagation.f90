!> Unit test of load_propagation: each row of its table of cases, over steps, for displacements, forces and regions.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_load_propagation
  use amontons_kinds, only: DP
  use amontons_load_propagation, only: active_loads_type, load_region_type, init_active_loads, propagate_loads, truncate_loads, &
    release_prescribed, prescribe_dof, ramp_down_loads, add_load, find_or_add_place, get_step_loads, LOAD_CLOAD
  use amontons_loads, only: amplitude_type, prescribed_type, concentrated_type, distributed_type, DISTRIBUTED_TRACTION, &
    DISTRIBUTED_PRESSURE
  use amontons_model, only: model_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use amontons_text, only: to_text
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  type(model_type) :: model
  type(active_loads_type) :: active
  type(prescribed_type), allocatable :: held(:)
  type(concentrated_type), allocatable :: forces(:)
  type(distributed_type), allocatable :: spread_loads(:)
  call make_model()
  call check_displacements()
  call check_released()
  call check_forces()
  call check_amplitudes()
  call check_at_once()
  call check_regions()
  call check_early_end()
  call check_growth()
  call suite%finish()

contains

  !> Four nodes and two elements without coordinates; an amplitude in step time, and one in total time.
  subroutine make_model()
    model%mesh%n_nodes = 300
    model%mesh%n_elements = 2
    allocate (model%amplitudes(2))
    model%amplitudes(1)%time = [0.0_DP, 1.0_DP]
    model%amplitudes(1)%factor = [0.0_DP, 0.5_DP]
    model%amplitudes(2)%time = [0.0_DP, 10.0_DP]
    model%amplitudes(2)%factor = [0.0_DP, 1.0_DP]
    model%amplitudes(2)%is_total_time = .true.
  end subroutine make_model


  !> The next step; the one before it had length 1.
  subroutine next_step(is_step)
    logical, intent(in), optional :: is_step
    logical :: at_once
    at_once = .false.
    if (present(is_step)) at_once = is_step
    call propagate_loads(model, 1.0_DP, real(active%step, DP), at_once, active)
  end subroutine next_step


  !> Prescribes direction 1 of a node.
  subroutine prescribe(node, value, amplitude, is_held, n_changed)
    integer, intent(in) :: node
    real(DP), intent(in) :: value
    integer, intent(in), optional :: amplitude
    logical, intent(in), optional :: is_held
    integer, intent(out), optional :: n_changed
    type(prescribed_type) :: new
    integer :: n
    new%node = node
    new%dof = 1
    new%end = value
    if (present(amplitude)) new%amplitude = amplitude
    if (present(is_held)) new%is_held = is_held
    n = 0
    call prescribe_dof(new, active%step, active, n)
    if (present(n_changed)) n_changed = n
  end subroutine prescribe


  !> The displacement of a node in this step: start and end, and whether it begins where the node is.
  subroutine expect_held(name, i, start, end, is_from_current)
    character(*), intent(in) :: name
    integer, intent(in) :: i                       !< place in the list
    real(DP), intent(in) :: start, end
    logical, intent(in) :: is_from_current
    call get_step_loads(active, held, forces, spread_loads)
    call suite%that(name // ' is there', size(held) >= i)
    if (size(held) < i) return
    call suite%near(name // ': start', held(i)%start, start, 0.0_DP)
    call suite%near(name // ': end', held(i)%end, end, 0.0_DP)
    call suite%that(name // ': begins where it is', held(i)%is_from_current .eqv. is_from_current)
  end subroutine expect_held


  !> New, given again, kept.
  subroutine check_displacements()
    integer :: n
    call init_active_loads(model, active)
    call prescribe(3, 0.0_DP)                      ! in the model
    call next_step()
    call prescribe(1, 4.0_DP, n_changed=n)
    call suite%that('first value', n == 0)
    call prescribe(1, 5.0_DP, n_changed=n)
    call suite%that('another value in the same step', n == 1)
    call prescribe(1, 5.0_DP, n_changed=n)
    call suite%that('the same value again', n == 0)
    call expect_held('of the model', 1, 0.0_DP, 0.0_DP, .false.)
    call expect_held('new in step 1', 2, 0.0_DP, 5.0_DP, .false.)
    call suite%that('node and direction', held(2)%node == 1 .and. held(2)%dof == 1)
    call next_step()
    call prescribe(2, 7.0_DP)
    call expect_held('kept', 2, 5.0_DP, 5.0_DP, .false.)
    call expect_held('new in step 2', 3, 0.0_DP, 7.0_DP, .true.)
    call next_step()
    call prescribe(1, 1.0_DP, is_held=.true.)
    call expect_held('fixed where it is', 2, 5.0_DP, 1.0_DP, .true.)
    call next_step()
    call prescribe(1, 2.0_DP)
    call expect_held('after it was fixed', 2, 1.0_DP, 2.0_DP, .true.)
  end subroutine check_displacements


  !> OP=NEW: what earlier steps gave is released, what this one gave stays; once in a step.
  subroutine check_released()
    call init_active_loads(model, active)
    call release_prescribed(0, active)
    call prescribe(3, 0.0_DP)
    call next_step()
    call prescribe(1, 5.0_DP)
    call next_step()
    call prescribe(2, 7.0_DP)
    call release_prescribed(2, active)
    call prescribe(3, 0.5_DP)
    call release_prescribed(2, active)
    call get_step_loads(active, held, forces, spread_loads)
    call suite%that('two are left', size(held) == 2 .and. all(held%node == [3, 2]))
    call next_step()
    call prescribe(1, 6.0_DP)
    call expect_held('prescribed again', 2, 5.0_DP, 6.0_DP, .true.)
    call suite%that('three', size(held) == 3)
  end subroutine check_released


  !> Forces: those of one step add up, those of earlier ones are replaced, zero ones go; OP=NEW ramps to zero.
  subroutine check_forces()
    call init_active_loads(model, active)
    call next_step()
    call add_load(8, 2.0_DP, 0, active%step, .false., active%cloads)
    call add_load(8, 3.0_DP, 0, active%step, .false., active%cloads)
    call add_load(1, 9.0_DP, 0, active%step, .false., active%cloads)
    call expect_force('sum', 1, 0.0_DP, 5.0_DP)
    call suite%that('node and direction of the key', size(forces) == 2 .and. forces(1)%node == 3 .and. forces(1)%dof == 2)
    call next_step()
    call add_load(8, 1.0_DP, 0, active%step, .false., active%cloads)
    call expect_force('kept', 1, 9.0_DP, 9.0_DP)
    call expect_force('from the old value to the new one', 2, 5.0_DP, 1.0_DP)
    call suite%that('two', size(forces) == 2)
    call next_step()
    call add_load(8, 4.0_DP, 0, active%step, .false., active%cloads)
    call ramp_down_loads(active%step, .false., DIALECT_ABAQUS, active%has_new(LOAD_CLOAD), active%cloads)
    call ramp_down_loads(active%step, .false., DIALECT_ABAQUS, active%has_new(LOAD_CLOAD), active%cloads)
    call get_step_loads(active, held, forces, spread_loads)
    call suite%that('OP=NEW', size(forces) == 2)
    call suite%near('ramps to zero what was there', abs(forces(1)%start - 9) + abs(forces(1)%end) + abs(forces(2)%start - 1) + &
      abs(forces(2)%end - 4), 0.0_DP, 0.0_DP)
    call next_step()
    call expect_force('alone in the step after it', 1, 4.0_DP, 4.0_DP)
    call suite%that('one', size(forces) == 1)
    call check_total_time(DIALECT_ABAQUS, 1.0_DP)
    call check_total_time(DIALECT_CALCULIX, 0.0_DP)
  end subroutine check_forces


  !> OP=NEW of a force whose amplitude continues in total time: where it starts.
  subroutine check_total_time(dialect, start)
    integer, intent(in) :: dialect               !< DIALECT_...
    real(DP), intent(in) :: start
    call init_active_loads(model, active)
    call next_step()
    call add_load(8, 10.0_DP, 2, active%step, .false., active%cloads)
    call next_step()
    call ramp_down_loads(active%step, .false., dialect, active%has_new(LOAD_CLOAD), active%cloads)
    call expect_force('amplitude of total time and OP=NEW, dialect ' // to_text(dialect), 1, start, 0.0_DP)
  end subroutine check_total_time


  !> A force of this step: start and end.
  subroutine expect_force(name, i, start, end)
    character(*), intent(in) :: name
    integer, intent(in) :: i
    real(DP), intent(in) :: start, end
    call get_step_loads(active, held, forces, spread_loads)
    call suite%that(name // ' is there', size(forces) >= i)
    if (size(forces) < i) return
    call suite%near(name // ': start', forces(i)%start, start, 0.0_DP)
    call suite%near(name // ': end', forces(i)%end, end, 0.0_DP)
  end subroutine expect_force


  !> In step time the value at the end stays; in total time the amplitude continues. Two amplitudes are two loads.
  subroutine check_amplitudes()
    call init_active_loads(model, active)
    call next_step()
    call add_load(1, 8.0_DP, 1, active%step, .false., active%cloads)
    call add_load(1, 8.0_DP, 2, active%step, .false., active%cloads)
    call prescribe(1, 6.0_DP, amplitude=1)
    call get_step_loads(active, held, forces, spread_loads)
    call suite%that('two loads', size(forces) == 2 .and. all(forces%amplitude == [1, 2]))
    call next_step()
    call expect_force('half of it', 1, 4.0_DP, 4.0_DP)
    call suite%that('without an amplitude', forces(1)%amplitude == 0)
    call suite%that('in total time', forces(2)%amplitude == 2 .and. abs(forces(2)%end - 8) <= 0)
    call expect_held('half of the displacement', 1, 3.0_DP, 3.0_DP, .false.)
  end subroutine check_amplitudes


  !> AMPLITUDE=STEP: the value from the start.
  subroutine check_at_once()
    call init_active_loads(model, active)
    call next_step(.true.)
    call add_load(1, 8.0_DP, 0, active%step, .true., active%cloads)
    call add_load(1, 1.0_DP, 0, active%step, .true., active%cloads)
    call prescribe(1, 3.0_DP)
    call expect_force('at once', 1, 9.0_DP, 9.0_DP)
    call expect_held('displacement at once', 1, 3.0_DP, 3.0_DP, .false.)
    call next_step(.true.)
    call ramp_down_loads(active%step, .true., DIALECT_CALCULIX, active%has_new(LOAD_CLOAD), active%cloads)
    call expect_force('gone at once', 1, 0.0_DP, 0.0_DP)
  end subroutine check_at_once


  !> Expects the place of a load on a region.
  subroutine expect_place(what, region, expected)
    character(*), intent(in) :: what
    type(load_region_type), intent(in) :: region
    integer, intent(in) :: expected
    integer :: found
    call find_or_add_place(active, region, found)
    call suite%that(what, found == expected)
  end subroutine expect_place


  !> Pressures by face; loads on regions element by element.
  subroutine check_regions()
    type(load_region_type) :: region, other
    integer :: i
    region%kind = DISTRIBUTED_TRACTION
    region%region = 'TOP'
    region%elements = [1, 2]
    region%faces = [3, 5]
    region%direction = [0.0_DP, 0.0_DP, 1.0_DP]
    call init_active_loads(model, active)
    call next_step()
    call expect_place('the first', region, 1)
    other = region
    call expect_place('the same', other, 1)
    other%direction = [0.0_DP, 1.0_DP, 0.0_DP]
    call expect_place('another direction', other, 2)
    other = region
    other%is_follower = .true.
    call expect_place('turning', other, 3)
    other = region
    other%point(2) = 1.0_DP
    call expect_place('another axis', other, 4)
    other = region
    do i = 1, 40
      other%region = 'B' // to_text(i)
      call expect_place('another region', other, 4 + i)
    end do
    call expect_place('the first again', region, 1)
    call expect_place('the fortieth again', other, 44)
    call add_load(1, 4.0_DP, 0, active%step, .false., active%volumes)
    call add_load(6 * 2 - 6 + 4, 3.0_DP, 0, active%step, .false., active%pressures, is_user=.true.)
    call get_step_loads(active, held, forces, spread_loads)
    associate (d => spread_loads)
      call suite%that('three', size(d) == 3 .and. all(d%kind == [DISTRIBUTED_PRESSURE, DISTRIBUTED_TRACTION, &
        DISTRIBUTED_TRACTION]))
      call suite%that('faces', all(d%element == [2, 1, 2]) .and. all(d%face == [4, 3, 5]) .and. d(1)%is_user)
      call suite%near('values', maxval(abs(d%end - [3.0_DP, 4.0_DP, 4.0_DP])), 0.0_DP, 0.0_DP)
    end associate
  end subroutine check_regions


  !> A step that ends after a quarter: ramps have come a quarter of their way, amplitudes are untouched.
  subroutine check_early_end()
    call init_active_loads(model, active)
    call next_step()
    call add_load(1, 8.0_DP, 0, active%step, .false., active%cloads)
    call add_load(2, 8.0_DP, 2, active%step, .false., active%cloads)
    call prescribe(1, 4.0_DP)
    call truncate_loads(active, 0.25_DP)
    call expect_force('a quarter', 1, 0.0_DP, 2.0_DP)
    call expect_force('in total time', 2, 0.0_DP, 8.0_DP)
    call expect_held('displacement', 1, 0.0_DP, 1.0_DP, .false.)
  end subroutine check_early_end


  !> More loads than the first allocation holds.
  subroutine check_growth()
    integer :: i
    call init_active_loads(model, active)
    call next_step()
    do i = 1, 300
      call prescribe(i, real(i, DP))
      call add_load(3 * i, real(i, DP), 0, active%step, .false., active%cloads)
    end do
    call get_step_loads(active, held, forces, spread_loads)
    call suite%that('all of them', size(held) == 300 .and. size(forces) == 300)
    call suite%near('the last', held(300)%end + forces(299)%end, 599.0_DP, 0.0_DP)
  end subroutine check_growth

end program test_load_propagation
