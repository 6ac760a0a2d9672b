!> Settle: contact is solved to the end while the bulk stays linear, so that a Newton step starts and ends with settled statuses.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/newton.md, "Contact settles ahead". A Newton direction du is right for the statuses that its rows
!! were made of. With the bulk linearised at u, its imbalance at u + du is known without the elements,
!!
!!     Rhat(u + du) = Rhat(u) - E K du,
!!
!! so gaps, trial tractions and statuses can be asked for there and the direction corrected, again and again, on the
!! condensed interface: the factor of the bulk stays. What is left for the next iteration is what the bulk does beyond K.
module amontons_contact_subproblem
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, SEARCH_AUTO
  use amontons_state, only: state_type, slave_type
  use amontons_active_set_history, only: forensics_type, note_slaves, find_cycle, DEPTH
  use amontons_active_set_cycling, only: keep_to_edges, walk_type
  use amontons_equilibrium, only: system_type, place_type, place_of, foresee, return_to, TROUBLE_NONE
  use amontons_newton_step, only: correct_direction
  implicit none
  private
  public :: settle_contact

  integer, parameter :: MOST_ROUNDS = 30           !< corrections of one direction
  integer, parameter :: MOST_HALVINGS = 4          !< of a correction
  real(DP), parameter :: SETTLED = 1.0e-2_DP       !< part of the merit at u that may be left at u + du [-]
  real(DP), parameter :: NO_BETTER = 0.99_DP       !< of the merit before: not less [-]
  real(DP), parameter :: NEGLIGIBLE = 1.0e-2_DP    !< part of the residual that Newton allows that may be left in any case [-]
  real(DP), parameter :: ROUNDING = 1.0e-10_DP     !< part of the largest merit of the rounds: no less is left where u had none [-]

  real(DP), parameter :: LESS = 1.0_DP - 1.0e-9_DP   !< of a merit: what is not below this is the same but for rounding [-]

  integer, parameter :: MOST_IN_PORTION = 12       !< corrections of one portion of the way
  integer, parameter :: FEW_IN_PORTION = 6         !< so many at most, and the next portion is twice as long
  integer, parameter :: MOST_IN_PORTIONS = 60      !< corrections of all portions
  real(DP), parameter :: FIRST_PORTION = 1.0_DP / 8.0_DP   !< of the way [-]
  real(DP), parameter :: LEAST_PORTION = 1.0_DP / 64.0_DP  !< of the way [-]

  !> Where a direction ends.
  type :: end_type
    real(DP) :: merit = huge(1.0_DP)
    real(DP), allocatable :: du(:, :)
    type(slave_type), allocatable :: slaves(:)
    integer :: n_rounds = 0                        !< corrections made
    integer :: trouble = TROUBLE_NONE              !< of the last of them
    logical :: is_settled = .false.
  end type end_type

contains

  !> Corrects a direction until contact has settled at its end; where it does not, in portions of the way.
  !!
  !! Only AUTO does so, and only with the condensed interface: the slides' line searches are to be seen as they are.
  !! After: du, and the memory of the slave nodes with which u + du is to be evaluated; the state stands at u as before.
  subroutine settle_contact(system, model, step, state, du, slaves, error)
    type(system_type), intent(inout), target :: system   !< with the direction's factor
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< evaluated at u
    real(DP), intent(inout) :: du(:, :)            !< (3, n_nodes) [length]
    type(slave_type), allocatable, intent(out) :: slaves(:)
    type(error_type), allocatable, intent(out) :: error
    type(place_type) :: start
    type(end_type) :: best, there
    logical :: is_condensed, is_unheld             ! where the whole direction ends
    slaves = state%new%slaves
    if (step%line_search /= SEARCH_AUTO .or. .not. system%is_condensed) return
    start = place_of(system, state)
    call settle_at_once(system, model, step, start, state, du, best, error)
    if (allocated(error)) return
    system%n_rounds = system%n_rounds + best%n_rounds
    if (.not. best%is_settled .and. system%carry <= 0.0_DP) then
      is_condensed = system%is_condensed
      is_unheld = system%is_unheld
      call settle_in_portions(system, model, step, start, state, there, error)
      if (allocated(error)) return
      system%n_rounds = system%n_rounds + there%n_rounds
      if (there%is_settled) best = there
      system%is_condensed = is_condensed .or. there%is_settled   ! whatever trouble there was on the way
      system%is_unheld = is_unheld .and. .not. there%is_settled
    end if
    du = best%du
    slaves = best%slaves
    system%is_settled = best%is_settled            ! if not, the factor may be gone
    call return_to(system, model, step, start, state, error)
  end subroutine settle_contact


  !> All corrections at the end of the whole direction; the best of the places found.
  subroutine settle_at_once(system, model, step, start, state, du, best, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(place_type), intent(inout) :: start       !< u; out: nodes that keep to their edges are marked
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: du(:, :)            !< (3, n_nodes) [length]
    type(end_type), intent(out) :: best
    type(error_type), allocatable, intent(out) :: error
    type(forensics_type) :: rounds
    real(DP), allocatable :: correction(:, :), first(:, :)
    type(walk_type) :: walks(size(start%slaves))   ! of the slave nodes
    real(DP) :: largest
    logical :: is_kept, is_round
    is_round = .false.
    largest = 0.0_DP
    first = du
    best%du = du
    best%slaves = start%slaves
    allocate (correction, mold=du)
    call foresee(system, model, start, du, state)
    do
      call keep_to_edges(system%contact, start%slaves, state%new%slaves, walks, is_kept)
      if (is_kept .and. best%n_rounds < MOST_ROUNDS) then   ! from the start, with the nodes that keep to their edges
        du = first
        best%merit = huge(1.0_DP)                  ! the next place is the best one
        state%new%slaves = start%slaves
        best%n_rounds = best%n_rounds + 1
        call foresee(system, model, start, du, state)
      end if
      call note_best(system, state, du, best)
      call note_slaves(rounds, state%new%slaves, system%merit)
      largest = max(largest, system%merit)
      if (is_in_balance(system, step, start, largest)) exit
      is_round = comes_round(rounds)
      if (best%n_rounds == MOST_ROUNDS .or. is_round) exit
      best%n_rounds = best%n_rounds + 1
      call correct_direction(system, model, step, state, 1.0_DP, correction, best%trouble, error)
      if (allocated(error)) return
      if (best%trouble /= TROUBLE_NONE .or. all(correction == 0.0_DP)) exit   ! GMRES finds nothing worth correcting
      call advance(system, model, start, correction, state, du)
    end do
    best%is_settled = best%n_rounds < MOST_ROUNDS .and. .not. is_round .and. best%trouble == TROUBLE_NONE
  end subroutine settle_at_once


  !> The way in portions. At the part t of it the prescribed displacements have gone t of what they missed at u, and a force on
  !! every node makes up for the rest of what was not in balance there. Contact settles at the end of each portion and goes on from
  !! there; where it does not, the portion is halved.
  subroutine settle_in_portions(system, model, step, start, state, here, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(place_type), intent(in) :: start          !< u
    type(state_type), intent(inout) :: state
    type(end_type), intent(out) :: here            !< settled only if that is at the end of the way
    type(error_type), allocatable, intent(out) :: error
    type(end_type) :: there
    real(DP), allocatable :: applied(:, :)         ! (3, n_nodes) [force]
    real(DP) :: t, portion
    integer :: n_rounds
    applied = state%new%applied_force
    allocate (here%du(size(start%u, 1), size(start%u, 2)), source=0.0_DP)
    here%slaves = start%slaves
    t = 0.0_DP
    n_rounds = 0
    portion = FIRST_PORTION
    do while (t < 1.0_DP .and. portion >= LEAST_PORTION .and. n_rounds < MOST_IN_PORTIONS)
      there = here
      state%new%applied_force = applied - (1.0_DP - t - portion) * start%residual
      call settle_portion(system, model, step, start, portion / (1.0_DP - t), state, there, error)
      if (allocated(error)) return
      n_rounds = n_rounds + there%n_rounds
      if (there%is_settled) then
        here = there
        t = t + portion                            ! sums of powers of two: exact
        portion = min(1.0_DP - t, merge(2.0_DP, 1.0_DP, there%n_rounds <= FEW_IN_PORTION) * portion)
      else
        portion = 0.5_DP * portion
      end if
    end do
    state%new%applied_force = applied
    here%n_rounds = n_rounds
    here%is_settled = t >= 1.0_DP
  end subroutine settle_in_portions


  !> One portion: the whole of the first correction, which moves the supports, then as along the whole way.
  subroutine settle_portion(system, model, step, start, share, state, there, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(place_type), intent(in) :: start          !< u
    real(DP), intent(in) :: share                  !< the portion over what is left of the way [-]
    type(state_type), intent(inout) :: state       !< with the applied forces at its end
    type(end_type), intent(inout) :: there         !< in: where it begins; out: where it ends
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: correction(:, :)
    type(forensics_type) :: rounds
    real(DP) :: largest
    integer :: n
    there%is_settled = .false.
    largest = 0.0_DP
    allocate (correction, mold=there%du)
    state%new%slaves = there%slaves
    call foresee(system, model, start, there%du, state)
    do n = 1, MOST_IN_PORTION
      there%n_rounds = n
      call correct_direction(system, model, step, state, merge(share, 0.0_DP, n == 1), correction, there%trouble, error)
      if (allocated(error) .or. there%trouble /= TROUBLE_NONE) return
      if (n == 1) then
        there%du = there%du + correction
        call foresee(system, model, start, there%du, state)
      else
        call advance(system, model, start, correction, state, there%du)
      end if
      largest = max(largest, system%merit)
      call note_slaves(rounds, state%new%slaves, system%merit)
      there%is_settled = is_in_balance(system, step, start, largest) .or. all(correction == 0.0_DP)
      if (there%is_settled .or. comes_round(rounds)) exit
    end do
    there%slaves = state%new%slaves
  end subroutine settle_portion


  !> Whether no status changes and hardly anything is left of the merit.
  pure logical function is_in_balance(system, step, start, largest)
    type(system_type), intent(in) :: system        !< as foreseen
    type(step_type), intent(in) :: step
    type(place_type), intent(in) :: start          !< u
    real(DP), intent(in) :: largest                !< merit of the rounds [force]
    is_in_balance = system%contact%n_changed == 0 .and. system%merit <= max(SETTLED * start%merit, ROUNDING * largest, &
      NEGLIGIBLE * step%controls%r_n * system%largest_force, system%rounding * sqrt(real(size(start%u), DP)))
  end function is_in_balance


  !> Whether the rounds have gone twice through the same statuses and stand no better than before: they would go on so.
  pure logical function comes_round(rounds)
    type(forensics_type), intent(in) :: rounds
    integer :: k
    k = find_cycle(rounds)
    comes_round = k > 0 .and. 2 * k < min(rounds%n, DEPTH)
    if (comes_round) comes_round = rounds%hash(1 + 2 * k) == rounds%hash(1) .and. &
      rounds%merit(1) >= NO_BETTER * rounds%merit(1 + 2 * k)
  end function comes_round


  !> Keeps the place if its merit is the least so far; of equal ones the first.
  subroutine note_best(system, state, du, best)
    type(system_type), intent(in) :: system
    type(state_type), intent(in) :: state
    real(DP), intent(in) :: du(:, :)
    type(end_type), intent(inout) :: best
    if (.not. system%merit < LESS * best%merit) return
    best%merit = system%merit
    best%du = du
    best%slaves = state%new%slaves
  end subroutine note_best


  !> Goes along a correction as far as the merit does not grow, else to the best of the lengths tried; of equal ones to the longest.
  subroutine advance(system, model, start, correction, state, du)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(place_type), intent(in) :: start
    real(DP), intent(in) :: correction(:, :)
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: du(:, :)
    type(slave_type), allocatable :: slaves(:)
    real(DP) :: before, least, length, chosen
    integer :: halving
    before = system%merit
    slaves = state%new%slaves
    least = huge(1.0_DP)
    chosen = 1.0_DP
    length = 1.0_DP
    do halving = 0, MOST_HALVINGS
      length = 0.5_DP**halving
      state%new%slaves = slaves
      call foresee(system, model, start, du + length * correction, state)
      if (system%merit < LESS * least) chosen = length
      least = min(least, system%merit)
      if (LESS * system%merit <= before) exit
    end do
    if (chosen < length .or. chosen > length) then
      state%new%slaves = slaves
      call foresee(system, model, start, du + chosen * correction, state)
    end if
    du = du + chosen * correction
  end subroutine advance

end module amontons_contact_subproblem
