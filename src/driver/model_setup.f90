!> Model set-up: the last changes of the model after the deck is read; it is constant from the model check on.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Opens user routines; gives the nodes of submodels the results of the global model; converts ties, distributing couplings and
!! embedded elements to equations, general contact to contact pairs; gives pairs with dependent slave nodes a penalty; moves tied
!! nodes and those of ADJUST onto their masters; gives elements the material of the first step. No later procedure has a model with
!! intent(inout) (`make lint`).
module amontons_model_setup
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_text, only: to_text, plural
  use amontons_logger, only: logger_type
  use amontons_loads, only: equation_type, prescribed_type
  use amontons_balanced_bodies, only: balancing_support_type, find_balancing_supports, support_equation
  use amontons_model, only: model_type, job_options_type
  use amontons_contact_initialization, only: find_adjustment
  use amontons_knots, only: describe_oblique_turns
  use amontons_general_contact, only: general_pairs_type, find_general_pairs
  use amontons_self_contact_pairs, only: add_self_pairs
  use amontons_deck_structure, only: order_slave_terms
  use amontons_dependent_slaves, only: find_penalties, penalty_law
  use amontons_embedded_elements, only: embed_elements
  use amontons_submodel_results, only: drive_submodels
  use amontons_tie_generation, only: generate_ties
  use amontons_user_routine_setup, only: open_user_routines
  implicit none
  private
  public :: set_up_model, add_general_contact

contains

  !> Makes all changes in order. Errors: EXIT_IO, EXIT_SETUP, EXIT_USAGE (user routines, ties).
  subroutine set_up_model(model, options, logger, error)
    type(model_type), intent(inout) :: model       !< in: from the deck; out: final
    type(job_options_type), intent(in) :: options
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    logical, allocatable :: is_bound(:)
    character(:), allocatable :: text
    call open_user_routines(model, options, error)
    if (allocated(error)) return
    !$omp critical (result_files)
    call drive_submodels(model, options, logger, error)      ! HDF5 serves one thread at a time
    !$omp end critical (result_files)
    if (allocated(error)) return
    call add_ties(model, logger, error)
    if (allocated(error)) return
    call embed(model, logger, error)
    if (allocated(error)) return
    call add_general_contact(model, logger, error)
    if (allocated(error)) return
    if (allocated(model%general_contact)) call order_slave_terms(model, is_bound)
    call soften_dependent_pairs(model, logger)
    call adjust(model, logger, error)
    if (allocated(error)) return
    text = describe_oblique_turns(model)
    if (text /= '') call logger%warn(text)
    call hold_balanced_bodies(model, logger)
    if (size(model%steps) == 0) return
    if (allocated(model%steps(1)%material)) model%mesh%material = model%steps(1)%material
  end subroutine set_up_model


  !> Holds free bodies whose loads balance each other: by supports, shells and beams by equations.
  subroutine hold_balanced_bodies(model, logger)
    type(model_type), intent(inout) :: model
    type(logger_type), intent(inout) :: logger
    type(balancing_support_type), allocatable :: supports(:)
    type(prescribed_type) :: held
    character(:), allocatable :: text
    integer :: i
    call find_balancing_supports(model, supports, text)
    if (text /= '') call logger%say(text)
    held%is_held = .true.
    held%is_balancing = .true.
    do i = 1, size(supports)
      if (supports(i)%director > 0) then
        model%equations = [model%equations, support_equation(model, supports(i))]
        cycle
      end if
      held%node = supports(i)%node
      held%dof = supports(i)%dof
      associate (step => model%steps(supports(i)%step))
        step%prescribed = [step%prescribed, held]
      end associate
    end do
  end subroutine hold_balanced_bodies


  !> Converts tied surfaces and distributing couplings to equations.
  subroutine add_ties(model, logger, error)
    type(model_type), intent(inout) :: model
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(equation_type), allocatable :: equations(:)
    real(DP), allocatable :: coordinates(:, :)
    character(:), allocatable :: text
    if (.not. (allocated(model%ties) .or. allocated(model%distributing_couplings))) return
    call generate_ties(model, equations, coordinates, text, error)
    if (allocated(error)) return
    if (text /= '') call logger%warn(text)
    if (size(equations) > 0) model%equations = [model%equations, equations]
    call move_alloc(coordinates, model%mesh%coordinates)
  end subroutine add_ties


  !> Converts embedded elements to equations.
  subroutine embed(model, logger, error)
    type(model_type), intent(inout) :: model
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(equation_type), allocatable :: equations(:)
    character(:), allocatable :: text
    if (.not. allocated(model%embeddings)) return
    call embed_elements(model, equations, text, error)
    if (allocated(error)) return
    if (text /= '') call logger%warn(text)
    model%equations = [model%equations, equations]
  end subroutine embed


  !> Converts general contact to contact pairs and says what was found. Errors: EXIT_SETUP (bodies that can meet without a pair).
  subroutine add_general_contact(model, logger, error)
    type(model_type), intent(inout) :: model
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    type(general_pairs_type) :: found
    character(:), allocatable :: text
    call find_general_pairs(model, found, text)
    call add_self_pairs(model, found, text)
    if (text /= '') call logger%say(text)
    if (found%warning /= '') call logger%warn(found%warning)
    if (found%obstacle /= '') call set_error(error, EXIT_SETUP, found%obstacle)
    if (size(found%pairs) == 0) return
    model%surfaces = [model%surfaces, found%surfaces]
    model%pairs = [model%pairs, found%pairs]
    call extend_steps(model)
  end subroutine add_general_contact


  !> Extends what the steps say of each pair.
  subroutine extend_steps(model)
    type(model_type), intent(inout) :: model
    integer :: i, n
    do i = 1, size(model%steps)
      associate (step => model%steps(i))
        if (i == 1 .and. any(model%pairs%is_shrink_fit) .and. .not. allocated(step%interference)) &
          allocate (step%interference(0), step%is_shrink_fit(0))
        if (allocated(step%is_removed)) then
          n = size(model%pairs) - size(step%is_removed)
          step%is_removed = [step%is_removed, spread(.false., 1, n)]
        end if
        if (allocated(step%interference)) then
          n = size(model%pairs) - size(step%interference)
          step%interference = [step%interference, spread(0.0_DP, 1, n)]
          step%is_shrink_fit = [step%is_shrink_fit, spread(.false., 1, n)]
          if (i == 1) step%is_shrink_fit = step%is_shrink_fit .or. model%pairs%is_shrink_fit
        end if
      end associate
    end do
  end subroutine extend_steps


  !> Gives exact pairs with dependent slave nodes a penalty, in all steps.
  subroutine soften_dependent_pairs(model, logger)
    type(model_type), intent(inout) :: model
    type(logger_type), intent(inout) :: logger
    real(DP), allocatable :: stiffness(:)          ! (n_pairs)
    character(:), allocatable :: text
    integer :: p, i
    if (size(model%pairs) == 0) return
    call find_penalties(model, stiffness, text)
    if (text /= '') call logger%warn(text)
    do p = 1, size(model%pairs)
      if (.not. stiffness(p) > 0.0_DP) cycle
      associate (pair => model%pairs(p))
        model%interactions = [model%interactions, penalty_law(model%interactions(pair%interaction), stiffness(p))]
        do i = 1, size(model%steps)
          if (allocated(model%steps(i)%interactions)) model%steps(i)%interactions = [model%steps(i)%interactions, &
            penalty_law(model%steps(i)%interactions(pair%interaction), stiffness(p))]
        end do
        pair%interaction = size(model%interactions)
      end associate
    end do
  end subroutine soften_dependent_pairs


  !> ADJUST: moves slave nodes onto their master and logs their number and the largest distance.
  subroutine adjust(model, logger, error)
    type(model_type), intent(inout) :: model
    type(logger_type), intent(inout) :: logger
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: way(:, :), length(:)
    if (.not. any(model%pairs%has_adjust)) return
    allocate (way(3, model%mesh%n_nodes))
    call find_adjustment(model, way, error)
    if (allocated(error)) return
    model%mesh%coordinates = model%mesh%coordinates + way
    length = norm2(way, dim=1)
    if (any(length > 0.0_DP)) call logger%say('ADJUST moved ' // plural(count(length > 0.0_DP), 'node') // &
      ' onto the master, at most by ' // to_text(maxval(length)) // '.')
  end subroutine adjust

end module amontons_model_setup
