!> Calls of the user routines at a contact point: UINTER for the whole law, FRIC for the friction.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Local directions: the master's outward normal n, and t_1, t_2 along the surface: in space t_1 is the global x axis projected on
!! the surface (z, where the normal is within 0.1 degrees of x) and t_2 = n x t_1; in the plane t_1 = e_z x n. Penetration is -g,
!! and a positive shear stress acts on the slave against its slip:
!!
!!     F = A (s_1 n - s_2 t_1 - s_3 t_2)
module amontons_user_contact
  use amontons_kinds, only: DP, PI
  use amontons_tensor, only: cross_product
  use amontons_user_routines, only: uinter_type, fric_type, call_uinter, call_fric, USER_NAME_LENGTH
  use amontons_surfaces, only: interaction_type
  use amontons_model, only: model_type
  use amontons_state, only: fields_type, slave_state_type, STATUS_OPEN, STATUS_STICK, STATUS_SLIP
  implicit none
  private
  public :: user_response_type, call_user_interaction, call_user_friction

  integer, parameter :: LM_SLIP = 0, LM_STICK = 1, LM_OPEN = 2   ! LM of FRIC
  real(DP), parameter :: MIN_X_COSINE = cos(0.1_DP * PI / 180.0_DP)   ! a normal nearer to x takes z instead [-]

  !> Derivatives of the force on a slave, from the last call.
  type :: user_response_type
    real(DP) :: d_force_d_gap(3) = 0                      !< d F / d g [force/length]
    real(DP) :: d_force_d_slip(3, 3) = 0                  !< d F / d (tangential slip) [force/length]
    real(DP) :: by_pressure(3) = 0                 !< FRIC: d F / d p [area]
    logical :: is_stuck = .false.                  !< FRIC: LM = 1, no motion
  end type user_response_type

contains

  !> The local directions n, t_1, t_2.
  pure function local_axes(n, is_flat) result(axes)
    real(DP), intent(in) :: n(3)
    logical, intent(in) :: is_flat                 !< plane and axisymmetric elements
    real(DP) :: axes(3, 3), t(3)
    axes = 0.0_DP
    axes(:, 1) = n
    if (is_flat) then
      axes(:, 2) = [-n(2), n(1), 0.0_DP]
      return
    end if
    t = [1.0_DP, 0.0_DP, 0.0_DP]
    if (abs(n(1)) > MIN_X_COSINE) t = [0.0_DP, 0.0_DP, 1.0_DP]
    t = t - dot_product(t, n) * n
    axes(:, 2) = t / norm2(t)
    axes(:, 3) = cross_product(n, axes(:, 2))
  end function local_axes


  !> The names passed to both routines: interaction, slave surface, master surface.
  pure function call_names(model, pair) result(names)
    type(model_type), intent(in) :: model
    integer, intent(in) :: pair
    character(USER_NAME_LENGTH) :: names(3)
    names(1) = model%interactions(model%pairs(pair)%interaction)%name
    names(2) = model%surfaces(model%pairs(pair)%slave)%name
    names(3) = model%surfaces(model%pairs(pair)%master)%name
  end function call_names


  !> UINTER: force, energy and state of a slave node from its gap and slip; open if it returns neither stress nor stiffness.
  pure subroutine call_user_interaction(model, law, is_flat, d, old, committed_statev, s, fields, response)
    type(model_type), intent(in) :: model
    type(interaction_type), intent(in) :: law
    logical, intent(in) :: is_flat
    real(DP), intent(in) :: d(3)                   !< tangential: total slip [length]
    type(slave_state_type), intent(in) :: old            !< committed
    real(DP), intent(in) :: committed_statev(:)              !< committed STATEV of all
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields     !< in: position of the slave; out: its force, STATEV
    type(user_response_type), intent(out) :: response
    type(uinter_type) :: values
    real(DP) :: axes(3, 3), signed(3, 3)
    integer :: first
    associate (slave => fields%slaves(s))
      axes = local_axes(slave%normal, is_flat)
      signed = axes * spread([1.0_DP, -1.0_DP, -1.0_DP], 1, 3)
      values%ndir = merge(2, 3, is_flat)
      values%mcrd = values%ndir
      values%stress = matmul(old%force + old%shear, signed) / max(old%area, tiny(1.0_DP))
      values%rdisp = matmul(d, axes)
      values%drdisp = values%rdisp - matmul(old%elastic, axes)
      values%rdisp(1) = -slave%gap
      values%drdisp(1) = merge(old%gap - slave%gap, 0.0_DP, old%facet > 0)
      values%sed = old%energy / max(old%area, tiny(1.0_DP))
      values%temp = fields%temperature(slave%node)
      values%time = [fields%step_time, fields%total_time]
      values%dtime = fields%time_increment
      values%coords = model%mesh%coordinates(:, slave%node) + fields%u(:, slave%node)
      values%axes = axes
      values%area = slave%area
      values%node = model%mesh%node_label(slave%node)
      values%step = fields%step
      values%increment = fields%increment
      values%is_closed = merge(-1, merge(0, 1, old%status == STATUS_OPEN), fields%increment <= 1 .and. fields%step <= 1)
      first = slave%memory
      fields%user_memory(first + 1:first + law%n_statev) = committed_statev(first + 1:first + law%n_statev)
      call call_uinter(model%routines, call_names(model, slave%pair), law%props, &
        fields%user_memory(first + 1:first + law%n_statev), values)
      slave%force = slave%area * values%stress(1) * slave%normal
      slave%shear = slave%area * matmul(signed(:, 2:), values%stress(2:))
      slave%energy = slave%area * values%sed
      slave%elastic = d
      slave%slip_increment = 0.0_DP
      if (values%sfd > 0.0_DP .and. norm2(slave%shear) > 0.0_DP) &   ! the slip whose work that is
        slave%slip_increment = -values%sfd * slave%area / dot_product(slave%shear, slave%shear) * slave%shear
      slave%status = merge(STATUS_SLIP, STATUS_STICK, values%sfd > 0.0_DP)
      if (.not. (any(abs(values%stress) > 0.0_DP) .or. any(abs(values%ddsddr) > 0.0_DP))) slave%status = STATUS_OPEN
      response%d_force_d_gap = -slave%area * matmul(signed, values%ddsddr(:, 1))
      response%d_force_d_slip = slave%area * matmul(signed, matmul(values%ddsddr(:, 2:), transpose(axes(:, 2:))))
    end associate
  end subroutine call_user_interaction


  !> FRIC: the shear force on a closed slave node, or its sticking.
  pure subroutine call_user_friction(model, law, is_flat, d, required_traction, committed_statev, s, fields, response)
    type(model_type), intent(in) :: model
    type(interaction_type), intent(in) :: law
    logical, intent(in) :: is_flat
    real(DP), intent(in) :: d(3)                   !< slip in this increment [length]
    real(DP), intent(in) :: required_traction(3)  !< traction required from contact: -p n, and along the surface [stress]
    real(DP), intent(in) :: committed_statev(:)              !< committed STATEV of all
    integer, intent(in) :: s                       !< index of the slave
    type(fields_type), intent(inout) :: fields     !< in: position of the slave; out: its shear force, slip, STATEV
    type(user_response_type), intent(out) :: response
    type(fric_type) :: values
    real(DP) :: axes(3, 3), t(3, 2)
    integer :: first
    associate (slave => fields%slaves(s))
      axes = local_axes(slave%normal, is_flat)
      t = axes(:, 2:)
      values%nfdir = merge(1, 2, is_flat)
      values%mcrd = merge(2, 3, is_flat)
      values%lm = LM_STICK
      if (slave%status == STATUS_OPEN) values%lm = LM_OPEN
      if (slave%status == STATUS_SLIP) values%lm = LM_SLIP
      values%dgam = matmul(d, t)
      values%taulm = matmul(required_traction, t)
      values%press = -dot_product(required_traction, slave%normal)
      values%slip = matmul(slave%slip, t)
      values%temp = fields%temperature(slave%node)
      values%time = [fields%step_time, fields%total_time]
      values%dtime = fields%time_increment
      values%coords = model%mesh%coordinates(:, slave%node) + fields%u(:, slave%node)
      values%length = sqrt(slave%area)
      values%node = model%mesh%node_label(slave%node)
      values%step = fields%step
      values%increment = fields%increment
      first = slave%memory
      fields%user_memory(first + 1:first + law%n_statev) = committed_statev(first + 1:first + law%n_statev)
      call call_fric(model%routines, call_names(model, slave%pair), law%props, &
        fields%user_memory(first + 1:first + law%n_statev), values)
      response%is_stuck = values%lm == LM_STICK
      if (response%is_stuck) slave%shear = -slave%area * matmul(t, values%taulm)
      if (response%is_stuck) return
      if (values%lm == LM_OPEN) return             ! no friction
      slave%shear = -slave%area * matmul(t, values%tau)
      slave%slip_increment = matmul(t, values%dslip)
      response%d_force_d_slip = -slave%area * matmul(t, matmul(values%ddtddg, transpose(t)))
      response%by_pressure = -slave%area * matmul(t, values%ddtddp)
    end associate
  end subroutine call_user_friction

end module amontons_user_contact
