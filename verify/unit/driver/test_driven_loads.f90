!> Driven loads and model change: the current step has the values set by a calling program; the model does not change.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_driven_loads
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, diagnostic_list_type, EXIT_USAGE
  use amontons_deck, only: read_deck_text
  use amontons_model, only: model_type, job_options_type, is_out, absent_elements, material_in_step, load_now
  use amontons_driven_loads, only: driven_loads_type, create_driven_loads, select_step_loads, set_driven, set_friction, &
    friction_now, &
    current_loads, &
    activate_driven, finish_driven, list_driven, restore_driven, DRIVEN_FORCE, DRIVEN_DISPLACEMENT, DRIVEN_PRESSURE
  use check, only: suite_type
  implicit none
  character(*), parameter :: NL = new_line('a')
  character(*), parameter :: CUBES = '*NODE' // NL // '1, 0, 0, 0' // NL // '2, 1, 0, 0' // NL // '3, 1, 1, 0' // NL // &
    '4, 0, 1, 0' // NL // '5, 0, 0, 1' // NL // '6, 1, 0, 1' // NL // '7, 1, 1, 1' // NL // '8, 0, 1, 1' // NL // &
    '11, 0, 0, 1' // NL // '12, 1, 0, 1' // NL // '13, 1, 1, 1' // NL // '14, 0, 1, 1' // NL // '15, 0, 0, 2' // NL // &
    '16, 1, 0, 2' // NL // '17, 1, 1, 2' // NL // '18, 0, 1, 2' // NL // '*ELEMENT, TYPE=C3D8, ELSET=E' // NL // &
    '1, 1, 2, 3, 4, 5, 6, 7, 8' // NL // '2, 11, 12, 13, 14, 15, 16, 17, 18' // NL
  character(*), parameter :: PAIR = '*SURFACE, NAME=M' // NL // '1, S2' // NL // '*SURFACE, NAME=S' // NL // '2, S1' // NL // &
    '*MATERIAL, NAME=A' // NL // '*ELASTIC' // NL // '1000., 0.3' // NL // '*SOLID SECTION, ELSET=E, MATERIAL=A' // NL // &
    '*SURFACE INTERACTION, NAME=I' // NL // '*FRICTION' // NL // '0.3' // NL // '*CONTACT PAIR, INTERACTION=I' // NL // 'S, M' // NL
  character(*), parameter :: STEPS = '*STEP' // NL // '*STATIC' // NL // '*BOUNDARY' // NL // '1, 1, 3' // NL // &
    '2, 1, 3' // NL // '3, 1, 3' // NL // '4, 1, 3' // NL // '15, 3, 3, -0.1' // NL // '*CLOAD' // NL // '17, 3, -4.' // NL // &
    '18, 3, -6.' // NL // '*END STEP' // NL // '*STEP' // NL // '*STATIC' // NL // '*CLOAD' // NL // '17, 3, -8.' // NL // &
    '*END STEP' // NL
  type(suite_type) :: suite
  type(model_type) :: model
  call read_model(model)
  call check_forces()
  call check_displacements()
  call check_friction()
  call check_recall()
  call check_model_change()
  call suite%finish()

contains

  !> The model of the deck above.
  subroutine read_model(model)
    type(model_type), intent(out) :: model
    type(job_options_type) :: options
    type(diagnostic_list_type) :: complaints
    type(error_type), allocatable :: error
    options%job = 'unit'
    options%deck = 'unit.inp'
    call read_deck_text(CUBES // PAIR // STEPS, options, model, complaints, error)
    call suite%that('the deck is read', .not. allocated(error) .and. size(model%steps) == 2)
    call suite%that('steps know their places', all(model%steps%number == [1, 2]))
  end subroutine read_model


  !> The index of a node.
  integer function index_of(label)
    integer, intent(in) :: label
    index_of = findloc(model%mesh%node_label, label, dim=1)
  end function index_of


  !> The item of a force or displacement along z.
  integer function along_z(label)
    integer, intent(in) :: label
    along_z = 3 * (index_of(label) - 1) + 3
  end function along_z


  !> The force on an item in the current step at a time, summed over its loads.
  real(DP) function force(drive, item, time)
    type(driven_loads_type), intent(in) :: drive
    integer, intent(in) :: item
    real(DP), intent(in) :: time                   !< step and total time
    integer :: i
    force = 0
    do i = 1, size(drive%step%concentrated)
      associate (load => drive%step%concentrated(i))
        if (3 * (load%node - 1) + load%dof == item) force = force + load_now(model, drive%step, load, time, time)
      end associate
    end do
  end function force


  !> A force that is set varies linearly from its current value to its target and replaces the deck's in all steps; others remain.
  subroutine check_forces()
    type(driven_loads_type) :: drive
    type(error_type), allocatable :: error
    integer :: item
    item = along_z(17)
    call create_driven_loads(drive, model)
    call suite%that('nothing is driven: no amplitudes of its own', .not. allocated(drive%step%amplitudes))
    call suite%near('the ramp of the deck', force(drive, item, 0.5_DP), -2.0_DP, 1.0e-14_DP)
    call set_driven(drive, model, 1, DRIVEN_FORCE, [item], [10.0_DP], [0.5_DP, 0.5_DP], error)
    call suite%that('no error', .not. allocated(error))
    call suite%near('it stands before an increment is armed', force(drive, item, 0.5_DP), -2.0_DP, 1.0e-14_DP)
    call activate_driven(drive, 0.5_DP, 0.75_DP)
    call suite%near('at the start', force(drive, item, 0.5_DP), -2.0_DP, 1.0e-14_DP)
    call suite%near('half way', force(drive, item, 0.625_DP), 4.0_DP, 1.0e-13_DP)
    call suite%near('at the end', force(drive, item, 0.75_DP), 10.0_DP, 1.0e-13_DP)
    call suite%near('another force is the deck''s', force(drive, along_z(18), 0.5_DP), -3.0_DP, 1.0e-14_DP)
    call suite%that('as many loads as before', size(drive%step%concentrated) == size(model%steps(1)%concentrated))
    call finish_driven(drive)
    call select_step_loads(drive, model, 2)
    call suite%that('the second step is the present one', drive%step%number == 2)
    call suite%near('in the next step it stays', force(drive, item, 1.0_DP), 10.0_DP, 1.0e-13_DP)
    associate (values => current_loads(drive, model, 1, DRIVEN_FORCE, [item, along_z(18)], [0.75_DP, 0.75_DP]))
      call suite%near('what is requested of a step', values(1), 10.0_DP, 1.0e-13_DP)
      call suite%near('and of the deck''s', values(2), -4.5_DP, 1.0e-14_DP)
    end associate
    call suite%that('the model has no more amplitudes', size(model%amplitudes) == 0)
    call suite%that('the model has its loads', all(model%steps(1)%concentrated%amplitude == 0) .and. &
      all(abs(model%steps(1)%concentrated%end - [-4.0_DP, -6.0_DP]) < 1.0e-14_DP))
  end subroutine check_forces


  !> Prescribed displacements can be set, free ones cannot.
  subroutine check_displacements()
    type(driven_loads_type) :: drive
    type(error_type), allocatable :: error
    integer :: i
    call create_driven_loads(drive, model)
    call set_driven(drive, model, 1, DRIVEN_DISPLACEMENT, [along_z(16)], [0.1_DP], [0.0_DP, 0.0_DP, 0.0_DP], error)
    call suite%that('a free displacement is refused', allocated(error))
    if (allocated(error)) call suite%that('as a mistake of the caller', error%code == EXIT_USAGE)
    call set_driven(drive, model, 1, DRIVEN_DISPLACEMENT, [along_z(15)], [0.2_DP], [0.0_DP, 0.0_DP, 0.0_DP], error)
    call suite%that('a prescribed one is not', .not. allocated(error))
    call activate_driven(drive, 0.0_DP, 1.0_DP)
    i = findloc(drive%step%prescribed%node == index_of(15), .true., dim=1)
    call suite%near('it runs', load_now(model, drive%step, drive%step%prescribed(i), 0.5_DP, 0.5_DP), 0.1_DP, 1.0e-14_DP)
    call suite%near('the model has its own', model%steps(1)%prescribed(i)%end, -0.1_DP, 1.0e-14_DP)
  end subroutine check_displacements


  !> A coefficient of friction changes the current step, not the model.
  subroutine check_friction()
    type(driven_loads_type) :: drive
    call create_driven_loads(drive, model)
    call suite%that('the deck''s: no laws of its own', .not. allocated(drive%step%interactions))
    call suite%near('the deck''s', friction_now(drive, model, 1), 0.3_DP, 1.0e-15_DP)
    call set_friction(drive, model, 1, 0.0_DP)
    call suite%near('set to zero', friction_now(drive, model, 1), 0.0_DP, 0.0_DP)
    call suite%near('in the present step', drive%step%interactions(1)%friction, 0.0_DP, 0.0_DP)
    call select_step_loads(drive, model, 2)
    call suite%near('and in the next', drive%step%interactions(1)%friction, 0.0_DP, 0.0_DP)
    call suite%near('the model has its own', model%interactions(1)%friction, 0.3_DP, 1.0e-15_DP)
  end subroutine check_friction


  !> The numbers of a checkpoint restore the same loads.
  subroutine check_recall()
    type(driven_loads_type) :: drive, again
    type(error_type), allocatable :: error
    real(DP), allocatable :: driven(:, :), friction(:)
    call create_driven_loads(drive, model)
    call set_driven(drive, model, 1, DRIVEN_FORCE, [along_z(18), along_z(17)], [1.0_DP, 2.0_DP], [0.0_DP, 0.0_DP], error)
    call set_driven(drive, model, 1, DRIVEN_PRESSURE, [6 + 2], [5.0_DP], [0.0_DP, 0.0_DP], error)
    call set_friction(drive, model, 1, 0.7_DP)
    call activate_driven(drive, 0.0_DP, 0.5_DP)
    call list_driven(drive, model, driven, friction)
    call create_driven_loads(again, model)
    call restore_driven(again, model, driven, friction)
    call select_step_loads(again, model, 1)
    call suite%near('force', force(again, along_z(17), 0.25_DP), 1.0_DP, 1.0e-14_DP)
    call suite%near('the other force', force(again, along_z(18), 0.25_DP), 0.5_DP, 1.0e-14_DP)
    call suite%that('one pressure', size(again%step%distributed) == 1)
    call suite%near('pressure', load_now(model, again%step, again%step%distributed(1), 0.25_DP, 0.25_DP), 2.5_DP, 1.0e-14_DP)
    call suite%near('friction', again%step%interactions(1)%friction, 0.7_DP, 1.0e-15_DP)
    call suite%that('the order of the loads', all(again%step%concentrated%node == drive%step%concentrated%node))
  end subroutine check_recall


  !> Elements that a step removes, and their materials, follow from the number of the step.
  subroutine check_model_change()
    type(model_type) :: changed
    changed = model
    call suite%that('no step takes anything out', .not. any(absent_elements(changed, 2)))
    changed%steps(2)%is_inactive = [.false., .true.]
    changed%steps(2)%material = [1, 2]
    call suite%that('before the first step', .not. is_out(changed, 0, 2))
    call suite%that('in the first step', .not. is_out(changed, 1, 2))
    call suite%that('in the second', is_out(changed, 2, 2) .and. .not. is_out(changed, 2, 1))
    call suite%that('all at once', all(absent_elements(changed, 2) .eqv. [.false., .true.]))
    call suite%that('its material before', material_in_step(changed, 0, 2) == 1 .and. material_in_step(changed, 1, 2) == 1)
    call suite%that('its material then', material_in_step(changed, 2, 2) == 2 .and. material_in_step(changed, 2, 1) == 1)
    deallocate (changed%steps)
    call suite%that('a model without steps', .not. is_out(changed, 1, 2) .and. material_in_step(changed, 1, 2) == 1)
  end subroutine check_model_change

end program test_driven_loads
