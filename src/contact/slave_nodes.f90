!> Operations on the state of single slave nodes: detach from the master, set forces by status, rounding force, commit of slip.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_slave_nodes
  use amontons_kinds, only: DP
  use amontons_surfaces, only: interaction_type, is_compliant, ROUGH_FRICTION
  use amontons_slave_node_equilibrium, only: local_solution_type
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  implicit none
  private
  public :: detach_slave, is_rough, set_force, contact_force_rounding, accumulate_slip

contains

  !> The node has lost contact with its master: open, without force.
  subroutine detach_slave(slave)
    type(slave_state_type), intent(inout) :: slave
    slave%facet = 0
    slave%status = STATUS_OPEN
    slave%is_bilateral = .false.
    slave%gap = 0.0_DP
    slave%force = 0.0_DP
    slave%shear = 0.0_DP
    slave%energy = 0.0_DP
  end subroutine detach_slave


  !> Whether a law never slips.
  elemental logical function is_rough(law)
    type(interaction_type), intent(in) :: law
    is_rough = law%friction >= ROUGH_FRICTION .and. .not. law%is_user_friction
  end function is_rough


  !> Normal and tangential contact force on the slave by its status.
  pure subroutine set_force(slave, imbalance, normal_force, friction)
    type(slave_state_type), intent(inout) :: slave
    real(DP), intent(in) :: imbalance(3)           !< Rhat [force]
    real(DP), intent(in) :: normal_force           !< N [force]
    real(DP), intent(in) :: friction(3)            !< mu N along the direction of friction [force]
    select case (slave%status)
    case (STATUS_OPEN)
      slave%force = 0.0_DP
      slave%shear = 0.0_DP
    case (STATUS_STICK)
      slave%force = normal_force * slave%normal
      slave%shear = -imbalance - slave%force
    case (STATUS_SLIP)
      slave%force = normal_force * slave%normal
      slave%shear = friction
    end select
  end subroutine set_force


  !> The largest rounding error of the force at a closed node, from a gap error of one unit in the last place of the coordinates: by
  !! the pressure-overclosure law of its pair or, for exact contact, by the stiffness of the body.
  pure real(DP) function contact_force_rounding(laws, solutions, slaves, coordinates) result(force)
    type(interaction_type), intent(in) :: laws(:)      !< (n_pairs)
    type(local_solution_type), intent(in) :: solutions(:)     !< (n_slaves)
    type(slave_state_type), intent(in) :: slaves(:)          !< (n_slaves)
    real(DP), intent(in) :: coordinates(:, :)          !< (3, n_nodes) [length]
    integer :: s
    force = 0.0_DP
    do s = 1, size(slaves)
      if (slaves(s)%status == STATUS_OPEN) cycle
      if (is_compliant(laws(slaves(s)%pair))) then
        force = max(force, solutions(s)%slope * slaves(s)%area)
      else
        force = max(force, slaves(s)%stiffness)
      end if
    end do
    force = force * epsilon(1.0_DP) * maxval(abs(coordinates))
  end function contact_force_rounding


  !> After a converged increment: accumulates slip and frictional work.
  subroutine accumulate_slip(old, fields)
    type(fields_type), intent(in) :: old           !< last committed fields
    type(fields_type), intent(inout) :: fields
    real(DP) :: work
    integer :: s
    work = 0.0_DP
    do s = 1, size(fields%slaves)
      associate (slave => fields%slaves(s))
        if (slave%status /= STATUS_SLIP) slave%slip_increment = 0.0_DP
        slave%slip = old%slaves(s)%slip + slave%slip_increment
        work = work - dot_product(slave%shear, slave%slip_increment)
      end associate
    end do
    fields%friction_work = old%friction_work + work
  end subroutine accumulate_slip

end module amontons_slave_nodes
