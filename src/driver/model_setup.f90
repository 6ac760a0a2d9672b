!> Model set-up: the last changes of a model after the deck is read; from the model check on it is frozen.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! User routines are opened; ties and distributing couplings become equations; tied nodes and those of ADJUST are moved onto their
!! masters; elements have the material of the first step. Nothing after this takes a model with intent(inout) (`make lint`).
module amontons_model_setup
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_text, only: to_text, plural
  use amontons_logger, only: logger_type
  use amontons_loads, only: equation_type
  use amontons_model, only: model_type, job_options_type
  use amontons_contact_initialization, only: find_adjustment
  use amontons_tie_generation, only: generate_ties
  use amontons_user_routine_setup, only: open_user_routines
  implicit none
  private
  public :: set_up_model

contains

  !> All changes, in their order. Errors: EXIT_IO, EXIT_SETUP, EXIT_USAGE (user routines, ties).
  subroutine set_up_model(model, options, journal, error)
    type(model_type), intent(inout) :: model       !< as the deck says it; out: as it stays
    type(job_options_type), intent(in) :: options
    type(logger_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    call open_user_routines(model, options, error)
    if (allocated(error)) return
    call add_ties(model, error)
    if (allocated(error)) return
    call adjust(model, journal, error)
    if (allocated(error)) return
    if (size(model%steps) == 0) return
    if (allocated(model%steps(1)%material)) model%mesh%material = model%steps(1)%material
  end subroutine set_up_model


  !> Tied surfaces and distributing couplings become equations.
  subroutine add_ties(model, error)
    type(model_type), intent(inout) :: model
    type(error_type), allocatable, intent(out) :: error
    type(equation_type), allocatable :: equations(:)
    real(DP), allocatable :: coordinates(:, :)
    if (.not. (allocated(model%ties) .or. allocated(model%distributing_couplings))) return
    call generate_ties(model, equations, coordinates, error)
    if (allocated(error)) return
    if (size(equations) > 0) model%equations = [model%equations, equations]
    call move_alloc(coordinates, model%mesh%coordinates)
  end subroutine add_ties


  !> ADJUST: slave nodes are moved onto their master; the log says how many and how far.
  subroutine adjust(model, journal, error)
    type(model_type), intent(inout) :: model
    type(logger_type), intent(inout) :: journal
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: way(:, :), length(:)
    if (.not. any(model%pairs%has_adjust)) return
    allocate (way(3, model%mesh%n_nodes))
    call find_adjustment(model, way, error)
    if (allocated(error)) return
    model%mesh%coordinates = model%mesh%coordinates + way
    length = norm2(way, dim=1)
    if (any(length > 0.0_DP)) call journal%say('ADJUST moved ' // plural(count(length > 0.0_DP), 'node') // &
      ' onto the master, at most by ' // to_text(maxval(length)) // '.')
  end subroutine adjust

end module amontons_model_setup
