!> Reduced: A = C' K C, its order, and its Cholesky factor or, where that is too large, an iterative preconditioner.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The analysis is kept while the pattern of C and that of the springs stand. After an analysis the memory and the work of
!! the factor are known, and with them the choice between the two (doc/theory/solver.md, "Too large for a factor").
module amontons_reduced_system
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_text, only: text_of
  use amontons_posix, only: available_megabytes, whole_megabytes, turn_type, take_turn
  use amontons_mesh, only: mesh_type
  use amontons_steps, only: SOLVER_AUTO, SOLVER_ITERATIVE
  use amontons_sparse, only: sparse_type, reduction_type, analyse_reduction, reduce_matrix, &
    is_same_pattern
  use amontons_factorization, only: factor_type, analyse, factorise, solve, estimate_memory, FACTOR_OK
  use amontons_partition, only: partition_mesh, order_unknowns, order_by_node, order_of_nodes, separator_of
  use amontons_two_level_preconditioner, only: iterative_type, prepare_parts, prepare_iterative, apply_iterative, parts_for, &
    iterative_megabytes
  use amontons_constraints, only: constraints_type
  implicit none
  private
  public :: reduced_type, plan_reduced, is_small, factorise_reduced, apply_reduced, give_up_iterative, forget_analysis

  real(DP), parameter :: ORDER_GROWTH = 1.15_DP          !< a factor this much larger wants a new order of the nodes [-]
  real(DP), parameter :: SHIFT = 1.0e-4_DP               !< of the preconditioner's diagonal if A is not positive [-]
  real(DP), parameter :: SHARE = 0.7_DP                  !< of all memory that a factor may take [-]
  real(DP), parameter :: SPARE = 0.9_DP                  !< of the memory at hand that a factor may take [-]
  real(DP), parameter :: ITERATION_WORK = 220.0_DP       !< of an iteration, an entry of A: operations of a factor in that time
  real(DP), parameter :: LIKELY = 140.0_DP               !< iterations that are thought of beforehand, the preconditioner included
  real(DP), parameter :: PATIENCE = 1.5_DP               !< iterations may take this times the work of the factor
  integer, parameter :: MOST_ITERATIONS = 2000           !< where there is no room for a factor
  real(DP), parameter :: ENTRIES_LAW = 60.0_DP           !< entries of a factor over n^(4/3): more than a compact body has [-]
  integer, parameter :: MANY = 30000                     !< unknowns below which no thought is given to memory
  integer, parameter :: VERY_MANY = 150000               !< unknowns from which the factor is guessed before it is analysed
  real(DP), parameter :: ENTRIES_GUESS = 14.0_DP         !< entries of a factor over the square of its last separator [-]
  real(DP), parameter :: WORK_GUESS = 6.0_DP             !< its operations over the cube [-]
  real(DP), parameter :: SURELY = 2.0_DP                 !< a guess must be so many times too large [-]

  !> A, and what its inverse is applied by.
  type :: reduced_type
    type(reduction_type) :: reduction
    type(sparse_type) :: matrix                    !< A
    type(factor_type) :: factor                    !< of A, or of A with a shift
    type(iterative_type) :: iterative              !< in its place
    logical :: is_iterative = .false.              !< the second
    integer :: asked = SOLVER_AUTO                 !< SOLVER_... of the step
    integer :: most_iterations = MOST_ITERATIONS   !< after which iterating is given up
    logical :: is_given_up = .false.               !< iterating was tried and did not arrive
    logical :: is_repeated = .false.               !< a factor will serve many times
    logical :: is_current = .false.                !< the factor is that of the present K and C
    character(:), allocatable :: news              !< what the choice was, to be told to the user
    type(sparse_type) :: analysed_map              !< C of the last factor; of its pattern reduction and factor were analysed
    type(sparse_type) :: analysed_sprung           !< the pattern of K with springs; not made without springs
    integer, allocatable :: node_order(:)          !< (n_nodes) fill-reducing order, kept while it serves
    real(DP) :: best_entries = 0                   !< entries of the factor when that order was made
    real(DP) :: guessed_megabytes = 0              !< of a factor that was not analysed because it is much too large; else 0
    integer :: n_made = 0                          !< factorisations of the last call
    integer :: n_shifted = 0                       !< of them with a shift
  end type reduced_type

contains

  !> Analyses A for constraints, so that the choice of the solver is known before anything is computed.
  subroutine plan_reduced(self, stiffness, whole, mesh, error)
    type(reduced_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness     !< K: its pattern
    type(constraints_type), intent(in) :: whole
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    if (whole%n_free > 0) call analyse_reduced(self, stiffness, .false., whole, mesh, error)
  end subroutine plan_reduced


  !> Whether a factor is surely small enough, without an analysis.
  logical function is_small(n, is_repeated)
    integer, intent(in) :: n                       !< unknowns
    logical, intent(in) :: is_repeated             !< a factor will serve many times
    is_small = n < MANY
    if (is_repeated .and. .not. is_small) &
      is_small = ENTRIES_LAW * real(n, DP)**(4.0_DP / 3.0_DP) * 8.0e-6_DP < room()
  end function is_small


  !> A and its factor, or preconditioner; a factor of the same K and C is kept. `status` is FACTOR_OK, or says that not even a shift
  !! made A positive.
  subroutine factorise_reduced(self, stiffness, is_sprung, whole, mesh, status, error)
    type(reduced_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness     !< K, or K with springs
    logical, intent(in) :: is_sprung               !< the second
    type(constraints_type), intent(in) :: whole    !< C
    type(mesh_type), intent(in) :: mesh
    integer, intent(out) :: status                 !< FACTOR_...
    type(error_type), allocatable, intent(out) :: error
    logical :: is_broken
    status = FACTOR_OK
    self%n_made = 0
    self%n_shifted = 0
    if (whole%n_free == 0) return
    if (self%is_current) self%is_current = .not. is_sprung .and. is_same_pattern(whole%map, self%analysed_map)
    if (self%is_current) self%is_current = all(abs(whole%map%value - self%analysed_map%value) <= 0.0_DP)
    if (self%is_current) return
    call analyse_reduced(self, stiffness, is_sprung, whole, mesh, error)
    if (allocated(error)) return
    call reduce_matrix(self%reduction, stiffness, whole%map, self%matrix, error)
    if (allocated(error)) return
    self%analysed_map%value = whole%map%value
    if (self%is_iterative) then
      call prepare_iterative(self%iterative, self%matrix, is_broken)
      self%is_current = .not. is_broken
      if (self%is_current) return
      call give_up_iterative(self)
      call analyse_reduced(self, stiffness, is_sprung, whole, mesh, error)
      if (allocated(error)) return
      call reduce_matrix(self%reduction, stiffness, whole%map, self%matrix, error)
      if (allocated(error)) return
    end if
    call factorise(self%factor, self%matrix, status, error=error)
    if (allocated(error)) return
    self%n_made = 1
    self%is_current = status == FACTOR_OK
    if (.not. self%is_current) call factorise_shifted(self, status, error)
  end subroutine factorise_reduced


  !> Analyses anew if the pattern of C, or that of the springs, is not the one analysed.
  subroutine analyse_reduced(self, stiffness, is_sprung, whole, mesh, error)
    type(reduced_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness
    logical, intent(in) :: is_sprung
    type(constraints_type), intent(in) :: whole
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    logical :: is_known
    is_known = is_same_pattern(whole%map, self%analysed_map) .and. (is_sprung .eqv. allocated(self%analysed_sprung%first))
    if (is_known .and. is_sprung) is_known = is_same_pattern(stiffness, self%analysed_sprung)
    if (is_known) return
    call analyse_reduction(stiffness, whole%map, self%reduction, self%matrix, error)
    if (allocated(error)) return
    call choose_solver(self, whole, mesh, error)
    if (allocated(error)) return
    self%analysed_map = whole%map
    self%analysed_sprung = sparse_type()
    if (is_sprung) self%analysed_sprung = stiffness
  end subroutine analyse_reduced


  !> The analysis does not count any more.
  subroutine forget_analysis(self)
    type(reduced_type), intent(inout) :: self
    if (allocated(self%analysed_map%first)) deallocate (self%analysed_map%first)
    self%is_current = .false.
  end subroutine forget_analysis


  !> Factor or iteration: as the step asks; else a factor, unless it does not fit into memory or takes very much work for one
  !! use. The analysis of the factor tells both.
  subroutine choose_solver(self, whole, mesh, error)
    type(reduced_type), intent(inout) :: self
    type(constraints_type), intent(in) :: whole
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: iterations                         ! that take as long as the factor
    logical :: was_iterative, is_too_large, is_much
    was_iterative = self%is_iterative
    self%is_iterative = self%asked == SOLVER_ITERATIVE .and. .not. self%is_given_up
    is_too_large = .false.
    self%most_iterations = MOST_ITERATIONS
    self%guessed_megabytes = 0.0_DP
    if (.not. self%is_iterative) then
      call guess_factor(self, whole, is_too_large, is_much, error)
      if (allocated(error)) return
      if (.not. (is_too_large .or. is_much)) then
        call analyse_factor(self, whole, error)
        is_too_large = allocated(error)
        if (is_too_large .and. (whole%n_free < MANY .or. self%is_given_up)) return
        if (allocated(error)) deallocate (error)
        if (.not. is_too_large .and. whole%n_free >= MANY) is_too_large = estimate_memory(self%factor) > room()
        iterations = self%factor%n_operations / (ITERATION_WORK * real(size(self%matrix%column), DP))
        is_much = iterations > LIKELY .and. whole%n_free >= MANY .and. .not. self%is_repeated
        if (.not. is_too_large) self%most_iterations = nint(min(PATIENCE * iterations, real(MOST_ITERATIONS, DP)))
      end if
      self%is_iterative = (is_too_large .or. is_much) .and. .not. self%is_given_up
    end if
    if (.not. self%is_iterative) return
    call cut_parts(self, whole, mesh, error)
    if (.not. (allocated(error) .or. was_iterative)) call tell_choice(self, whole, is_too_large)
  end subroutine choose_solver


  !> Whether a factor is so much too large, or takes so much work, that it need not be analysed. METIS finds the last separator in a
  !! tenth of the time of the whole order; a compact body has the entries and operations of the guess, a longer one more.
  subroutine guess_factor(self, whole, is_too_large, is_much, error)
    type(reduced_type), intent(inout) :: self
    type(constraints_type), intent(in) :: whole
    logical, intent(out) :: is_too_large, is_much
    type(error_type), allocatable, intent(out) :: error
    real(DP) :: n
    integer :: n_separating
    is_too_large = .false.
    is_much = .false.
    if (whole%n_free < VERY_MANY .or. self%is_given_up .or. allocated(self%node_order)) return
    call separator_of(self%matrix, nodes_of(whole), whole%n_unknowns / 3, n_separating, error)
    if (allocated(error)) return
    n = real(n_separating, DP)
    is_too_large = 8.0e-6_DP * ENTRIES_GUESS * n**2 > SURELY * room()
    is_much = WORK_GUESS * n**3 > SURELY * LIKELY * ITERATION_WORK * real(size(self%matrix%column), DP) .and. .not. self%is_repeated
    if (is_too_large .or. is_much) self%guessed_megabytes = 8.0e-6_DP * ENTRIES_GUESS * n**2
  end subroutine guess_factor


  !> What a factor may take [megabytes]: a share of all memory, the same whenever a job runs, and no more than is free.
  real(DP) function room()
    room = min(SHARE * whole_megabytes(), SPARE * available_megabytes())
  end function room


  !> The node of each free unknown.
  pure function nodes_of(whole) result(node)
    type(constraints_type), intent(in) :: whole
    integer :: node(whole%n_free)
    integer :: i
    do i = 1, whole%n_unknowns
      if (whole%free_of(i) > 0) node(whole%free_of(i)) = (i + 2) / 3
    end do
  end function nodes_of


  !> The sentence about an iterative solution.
  subroutine tell_choice(self, whole, is_too_large)
    type(reduced_type), intent(inout) :: self
    type(constraints_type), intent(in) :: whole
    logical, intent(in) :: is_too_large            !< the factor does not fit
    character(:), allocatable :: reason
    real(DP) :: megabytes, whole_memory
    type(turn_type) :: turn
    call take_turn(turn)
    whole_memory = whole_megabytes()
    megabytes = estimate_memory(self%factor)
    if (self%guessed_megabytes > 0.0_DP) megabytes = self%guessed_megabytes
    if (self%asked == SOLVER_ITERATIVE) then
      reason = 'as SOLVER asks'
    else if (is_too_large .and. megabytes <= 0.0_DP) then
      reason = 'because the factor would have more entries than can be counted (17 gigabytes)'
    else if (is_too_large .and. megabytes > SHARE * whole_memory) then
      reason = 'because the factor would take ' // text_of(nint(megabytes)) // ' megabytes, too much of ' // &
        text_of(nint(whole_memory)) // ' in all'
    else if (is_too_large) then
      reason = 'because the factor would take ' // text_of(nint(megabytes)) // ' megabytes and ' // &
        text_of(nint(available_megabytes())) // &
        ' are free at the moment (with more, another run would take a factor, and differ in the last digits)'
    else if (self%guessed_megabytes > 0.0_DP) then
      reason = 'which takes less time than a factor of some ' // text_of(nint(megabytes)) // ' megabytes'
    else
      reason = 'which takes less time than a factor of ' // text_of(nint(self%factor%n_operations / 1.0e9_DP)) // &
        ' thousand million operations and ' // text_of(nint(megabytes)) // ' megabytes'
    end if
    self%news = told(self) // 'The ' // text_of(whole%n_free) // ' equations are solved by iteration, ' // reason // &
      '. The preconditioner takes ' // &
      text_of(nint(iterative_megabytes(whole%n_free, size(self%matrix%column), self%iterative%n_parts))) // ' megabytes.'
  end subroutine tell_choice


  !> What is still to be told, with a space.
  pure function told(self) result(news)
    type(reduced_type), intent(in) :: self
    character(:), allocatable :: news
    news = ''
    if (allocated(self%news)) news = self%news // ' '
  end function told


  !> Iterating did not arrive: a factor from now on.
  subroutine give_up_iterative(self)
    type(reduced_type), intent(inout) :: self
    type(turn_type) :: turn
    call take_turn(turn)
    self%is_given_up = .true.
    self%is_iterative = .false.
    self%iterative = iterative_type()
    self%news = told(self) // 'The iterative solver did not arrive: a factor is made in its place.'
    call forget_analysis(self)
  end subroutine give_up_iterative


  !> The parts of the mesh whose rigid motions are the second level of the preconditioner.
  subroutine cut_parts(self, whole, mesh, error)
    type(reduced_type), intent(inout) :: self
    type(constraints_type), intent(in) :: whole
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: of_element(:), part(:), axis(:)
    real(DP), allocatable :: place(:, :)
    integer :: of_node(mesh%n_nodes), n_parts, e, i, f
    n_parts = parts_for(mesh%n_nodes)
    call partition_mesh(mesh%n_elements, mesh%first, mesh%nodes, mesh%n_nodes, n_parts, of_element, error=error)
    if (allocated(error)) return
    of_node = 1
    do e = 1, mesh%n_elements
      of_node(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) = of_element(e)
    end do
    allocate (part(whole%n_free), axis(whole%n_free), place(3, whole%n_free))
    do i = 1, whole%n_unknowns
      f = whole%free_of(i)
      if (f == 0) cycle
      part(f) = of_node((i + 2) / 3)
      axis(f) = 1 + mod(i - 1, 3)
      place(:, f) = mesh%coordinates(:, (i + 2) / 3)
    end do
    call prepare_parts(self%iterative, part, axis, place, n_parts)
  end subroutine cut_parts


  !> Analyses A in an order of the nodes. METIS makes a new order only if the last one has become too expensive.
  subroutine analyse_factor(self, whole, error)
    type(reduced_type), intent(inout) :: self
    type(constraints_type), intent(in) :: whole
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: node(:), order(:)
    integer :: n_nodes
    n_nodes = whole%n_unknowns / 3
    node = nodes_of(whole)
    if (allocated(self%node_order)) then
      call analyse(self%factor, self%matrix, order_by_node(self%node_order, node), error)
      if (allocated(error)) return
      if (self%factor%n_entries <= ORDER_GROWTH * self%best_entries) return
    end if
    call order_unknowns(self%matrix, node, n_nodes, order, error)
    if (allocated(error)) return
    call analyse(self%factor, self%matrix, order, error)
    self%best_entries = self%factor%n_entries
    self%node_order = order_of_nodes(node(order), n_nodes)
  end subroutine analyse_factor


  !> A is singular or indefinite: its diagonal grows by a share of itself. Only the preconditioner changes, not the answer.
  subroutine factorise_shifted(self, status, error)
    type(reduced_type), intent(inout) :: self
    integer, intent(out) :: status
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: diagonal(:), shift_by(:)
    integer :: attempt
    diagonal = abs(self%matrix%value(self%matrix%first(:self%matrix%n_rows)))
    do attempt = 0, 4
      shift_by = SHIFT * 10.0_DP**attempt * diagonal
      call factorise(self%factor, self%matrix, status, shift_by, error)
      if (allocated(error)) return
      self%n_made = self%n_made + 1
      self%n_shifted = self%n_shifted + 1
      if (status == FACTOR_OK) return
    end do
  end subroutine factorise_shifted


  !> y = inv(A) x, or nearly so.
  subroutine apply_reduced(self, x, y)
    type(reduced_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    if (self%is_iterative) then
      call apply_iterative(self%iterative, self%matrix, x, y)
    else
      call solve(self%factor, x, y)
    end if
  end subroutine apply_reduced

end module amontons_reduced_system
