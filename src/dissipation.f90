!> Dissipation: the work that plastic and creep strains took in an increment.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_dissipation
  use amontons_kinds, only: DP
  use amontons_tensor, only: double_dot, von_mises
  use amontons_materials, only: HISTORY_PEEQ, HISTORY_CEEQ, HISTORY_INELASTIC
  use amontons_model, only: model_type
  use amontons_state, only: fields_type
  implicit none
  private
  public :: inelastic_work

contains

  !> The work of the stresses on the plastic and creep strains between two states, by the trapezoidal rule: q (dp + dc) where the
  !! flow follows von Mises, T : d_eps_p with kinematic hardening, where rotations within the increment are taken as small [energy].
  !! Materials of the user and linear bodies give nothing. Cost: linear in the points.
  pure real(DP) function inelastic_work(model, old, new) result(work)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: old, new
    real(DP) :: change(size(old%history, 1))
    integer :: e, p
    work = 0.0_DP
    if (size(old%history, 1) < HISTORY_INELASTIC + 5) return
    do e = 1, model%mesh%n_elements
      if (model%mesh%material(e) == 0) cycle
      associate (material => model%materials(model%mesh%material(e)))
        if (material%is_user .or. material%is_plain) cycle
        do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
          change = new%history(:, p) - old%history(:, p)
          if (allocated(material%kinematic)) then
            work = work + 0.5_DP * new%volume(p) * double_dot(old%stress(:, p) + new%stress(:, p), &
              change(HISTORY_INELASTIC:HISTORY_INELASTIC + 5))
          else
            work = work + 0.5_DP * new%volume(p) * (von_mises(old%stress(:, p)) + von_mises(new%stress(:, p))) * &
              (change(HISTORY_PEEQ) + change(HISTORY_CEEQ))
          end if
        end do
      end associate
    end do
  end function inelastic_work

end module amontons_dissipation
