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
module amontons_settle
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_model, only: model_type
  use amontons_steps, only: step_type, SEARCH_AUTO
  use amontons_state, only: state_type, slave_type
  use amontons_forensics, only: forensics_type, note_slaves, find_cycle, DEPTH
  use amontons_cycles, only: keep_to_edges
  use amontons_system, only: system_type, place_type, place_of, foresee, return_to, TROUBLE_NONE
  use amontons_direction, only: correct_direction
  implicit none
  private
  public :: settle_contact

  integer, parameter :: MOST_ROUNDS = 30           !< corrections of one direction
  integer, parameter :: MOST_HALVINGS = 4
  real(DP), parameter :: SETTLED = 1.0e-2_DP       !< part of the merit at u that may be left at u + du [-]
  real(DP), parameter :: NO_BETTER = 0.99_DP       !< of the merit before: not less [-]
  real(DP), parameter :: NEGLIGIBLE = 1.0e-2_DP    !< part of the residual that Newton allows that may be left in any case [-]
  real(DP), parameter :: ROUNDING = 1.0e-10_DP     !< part of the largest merit of the rounds: no less is left where u had none [-]

  real(DP), parameter :: LESS = 1.0_DP - 1.0e-9_DP   !< of a merit: what is not below this is the same but for rounding [-]

  !> The best place found.
  type :: best_type
    real(DP) :: merit = huge(1.0_DP)
    real(DP), allocatable :: du(:, :)
    type(slave_type), allocatable :: slaves(:)
  end type best_type

contains

  !> Corrects a direction until contact has settled at its end.
  !!
  !! Only AUTO does so, and only with the condensed interface: the slides' line searches are to be seen as they are.
  !! After: du, and the memory of the slave nodes with which u + du is to be evaluated; the state stands at u as before.
  subroutine settle_contact(system, model, step, state, du, slaves, n_rounds, error)
    type(system_type), intent(inout), target :: system   !< with the direction's factor
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< evaluated at u
    real(DP), intent(inout) :: du(:, :)            !< (3, n_nodes) [length]
    type(slave_type), allocatable, intent(out) :: slaves(:)
    integer, intent(out) :: n_rounds               !< corrections made
    type(error_type), allocatable, intent(out) :: error
    type(place_type) :: start
    type(best_type) :: best
    type(forensics_type) :: rounds
    real(DP), allocatable :: correction(:, :), first(:, :)
    integer, allocatable :: n_lost(:)              ! (n_slaves) times that a slave node ran off its master
    real(DP) :: largest
    logical :: is_kept, is_round
    integer :: trouble
    n_rounds = 0
    trouble = TROUBLE_NONE
    is_round = .false.
    largest = 0.0_DP
    slaves = state%new%slaves
    if (step%line_search /= SEARCH_AUTO .or. .not. system%is_condensed) return
    start = place_of(system, state)
    first = du
    best%du = du
    best%slaves = start%slaves
    allocate (correction, mold=du)
    allocate (n_lost(size(slaves)), source=0)
    call foresee(system, model, start, du, state)
    do
      call keep_to_edges(system%contact, start%slaves, state%new%slaves, n_lost, is_kept)
      if (is_kept .and. n_rounds < MOST_ROUNDS) then   ! from the start, with the nodes that keep to their edges
        du = first
        best = best_type(du=du, slaves=start%slaves)
        state%new%slaves = start%slaves
        n_rounds = n_rounds + 1
        call foresee(system, model, start, du, state)
      end if
      call note_best(system, state, du, best)
      call note_slaves(rounds, state%new%slaves, system%merit)
      largest = max(largest, system%merit)
      if (system%contact%n_changed == 0 .and. system%merit <= max(SETTLED * start%merit, ROUNDING * largest, &
        NEGLIGIBLE * step%controls%r_n * system%largest_force, system%rounding * sqrt(real(size(du), DP)))) exit
      is_round = comes_round(rounds)
      if (n_rounds == MOST_ROUNDS .or. is_round) exit
      n_rounds = n_rounds + 1
      call correct_direction(system, model, step, state, correction, trouble, error)
      if (allocated(error)) return
      if (trouble /= TROUBLE_NONE .or. all(correction == 0.0_DP)) exit   ! GMRES finds nothing worth correcting
      call advance(system, model, start, correction, state, du)
    end do
    du = best%du
    slaves = best%slaves
    system%is_settled = n_rounds < MOST_ROUNDS .and. .not. is_round .and. trouble == TROUBLE_NONE   ! else the factor may be gone
    call return_to(system, model, step, start, state, error)
  end subroutine settle_contact


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
    type(best_type), intent(inout) :: best
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

end module amontons_settle
