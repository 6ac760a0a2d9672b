!> Checks of contact at the end of an attempt: faces that met without a pair, crossings, driven slave nodes.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_contact_checks
  use amontons_kinds, only: DP
  use amontons_model, only: model_type
  use amontons_state, only: state_type, fields_type
  use amontons_constraints, only: constraints_type
  use amontons_contact_pairs, only: contact_type
  use amontons_unpaired_contact, only: model_faces_type, find_unpaired_contact, find_unpaired_self_contact
  use amontons_unpaired_crossing, only: find_unpaired_crossing, least_crossing
  use amontons_body_motion, only: displacement_span
  use amontons_driven_slaves, only: find_driven_slave
  implicit none
  private
  public :: find_contact_fault, find_avoidable_crossing

contains

  !> What ends the job after an increment: faces have come together that general contact does not know to be near, of two bodies
  !! under NLGEOM, or of one; bodies have passed through each other; supports drove slave nodes behind their master.
  subroutine find_contact_fault(model, contact, base, faces, now, step, message)
    type(model_type), intent(in) :: model
    type(contact_type), intent(in) :: contact
    type(constraints_type), intent(in) :: base     !< of the supports, and what depends on others
    type(model_faces_type), intent(inout) :: faces !< prepared here if needed
    type(fields_type), intent(in) :: now           !< committed
    integer, intent(in) :: step                    !< of the model, from 1
    character(:), allocatable, intent(out) :: message   !< '': none
    real(DP), allocatable :: motion(:, :)          ! of the increment, which contact follows under NLGEOM [length]
    message = ''
    associate (du => now%time_increment * now%v)
      motion = 0 * du
      if (model%steps(step)%is_nlgeom) motion = du
      call find_unpaired_contact(model, faces, now%u, motion, step, message)
      if (message == '') call find_unpaired_self_contact(model, faces, now%u, motion, step, message)
      if (message == '') call find_driven_slave(model, contact, base, now%slaves, now%u, message)
      if (message == '' .and. .not. faces%is_free_of_crossings) call find_unpaired_crossing(model, faces, now%slaves, now%u, du, &
        step, message)
    end associate
    faces%is_free_of_crossings = .false.
  end subroutine find_contact_fault


  !> Whether bodies have passed through each other in a converged attempt that can be repeated: under NLGEOM contact may act on a
  !! shorter way, unless the way was short already or supports prescribe the motion of both. After: the faces know of an attempt
  !! without a crossing.
  subroutine find_avoidable_crossing(model, faces, state, step, message)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces !< prepared here if needed
    type(state_type), intent(in) :: state          !< new: the attempt
    integer, intent(in) :: step                    !< of the model, from 1
    character(:), allocatable, intent(out) :: message   !< '': none
    logical :: is_driven
    message = ''
    faces%is_free_of_crossings = .false.
    if (.not. model%steps(step)%is_nlgeom) return
    associate (new => state%new, du => state%new%u - state%old%u)
      if (displacement_span(model, du) < least_crossing(model, faces)) return
      call find_unpaired_crossing(model, faces, new%slaves, new%u, du, step, message, is_driven)
    end associate
    faces%is_free_of_crossings = message == ''
    if (is_driven) message = ''                    ! no increment keeps them apart
  end subroutine find_avoidable_crossing

end module amontons_contact_checks
