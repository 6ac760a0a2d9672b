!> Slaves: what is done to the memory of slave nodes alone: let go, loaded by their status, looked at, committed.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_slave_nodes
  use amontons_kinds, only: DP
  use amontons_surfaces, only: interaction_type, is_compliant, ROUGH_FRICTION
  use amontons_local_equilibrium, only: local_solution_type
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP, FRICTION_ACTIVE, &
    FRICTION_SEPARATED_ONCE, &
    FRICTION_SUPPRESSED, FRICTION_ON_TRIAL, FRICTION_TRIAL_FAILED
  implicit none
  private
  public :: slip_data_type, detach_slave, suppress_friction_stepwise, is_friction_suppressed, is_rough, set_force, set_slip_data, &
    rounding_force, accumulate_slip

  !> What the slip procedure looks at, for all slave nodes at one configuration.
  type :: slip_data_type
    real(DP), allocatable :: imbalance_t(:, :)    !< (3, n_slaves) Rt [force]
    real(DP), allocatable :: normal_force(:)      !< (n_slaves) N [force]
    real(DP), allocatable :: slip(:, :)           !< (3, n_slaves) g since the start of the increment [length]
    real(DP), allocatable :: position(:, :)       !< (3, n_slaves) slave relative to the touching point of its master [length]
    integer, allocatable :: status(:)             !< (n_slaves) STATUS_...
  end type slip_data_type

contains

  !> The node has left its master: open, without force.
  subroutine detach_slave(slave)
    type(slave_state_type), intent(inout) :: slave
    slave%facet = 0
    slave%status = STATUS_OPEN
    slave%gap = 0.0_DP
    slave%force = 0.0_DP
    slave%shear = 0.0_DP
    slave%energy = 0.0_DP
  end subroutine detach_slave


  !> A node of surfaces that never slip, or of several pairs, is pulled off: the second time in an increment it has lost its grip,
  !! and after that was tried again for good.
  elemental subroutine suppress_friction_stepwise(slave)
    type(slave_state_type), intent(inout) :: slave
    select case (slave%friction_state)
    case (FRICTION_ACTIVE)
      slave%friction_state = FRICTION_SEPARATED_ONCE
    case (FRICTION_SEPARATED_ONCE)
      slave%friction_state = FRICTION_SUPPRESSED
    case (FRICTION_ON_TRIAL)
      slave%friction_state = FRICTION_TRIAL_FAILED
    end select
  end subroutine suppress_friction_stepwise


  !> Whether a node has lost its grip in this increment: on surfaces that never slip it slides without friction where it touches;
  !! of several pairs, those that still hold it do not rub along this one's normal.
  elemental logical function is_friction_suppressed(slave)
    type(slave_state_type), intent(in) :: slave
    is_friction_suppressed = slave%friction_state == FRICTION_SUPPRESSED .or. slave%friction_state == FRICTION_TRIAL_FAILED
  end function is_friction_suppressed


  !> Whether the surfaces of a law never slip.
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


  !> Notes for the slip procedure what it looks at.
  pure subroutine set_slip_data(slip_data, s, status, imbalance_t, normal_force, slip)
    type(slip_data_type), intent(inout) :: slip_data
    integer, intent(in) :: s, status
    real(DP), intent(in) :: imbalance_t(3), normal_force, slip(3)
    slip_data%status(s) = status
    slip_data%imbalance_t(:, s) = imbalance_t
    slip_data%normal_force(s) = normal_force
    slip_data%slip(:, s) = slip
    slip_data%position(:, s) = 0.0_DP
  end subroutine set_slip_data


  !> The largest force that the rounding of coordinates makes at a closed node, of a gap of one unit in their last place: by
  !! the law of its pair, or, where contact is exact, by the stiffness of the body.
  pure real(DP) function rounding_force(laws, met, slaves, coordinates) result(force)
    type(interaction_type), intent(in) :: laws(:)      !< (n_pairs)
    type(local_solution_type), intent(in) :: met(:)           !< (n_slaves)
    type(slave_state_type), intent(in) :: slaves(:)          !< (n_slaves)
    real(DP), intent(in) :: coordinates(:, :)          !< (3, n_nodes) [length]
    integer :: s
    force = 0.0_DP
    do s = 1, size(slaves)
      if (slaves(s)%status == STATUS_OPEN) cycle
      if (is_compliant(laws(slaves(s)%pair))) then
        force = max(force, met(s)%slope * slaves(s)%area)
      else
        force = max(force, slaves(s)%stiffness)
      end if
    end do
    force = force * epsilon(1.0_DP) * maxval(abs(coordinates))
  end function rounding_force


  !> At the end of a converged increment: gather the slip, and the work that friction took.
  subroutine accumulate_slip(old, fields)
    type(fields_type), intent(in) :: old           !< committed before
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
