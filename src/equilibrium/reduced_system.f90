!> Reduced system A = C' K C: fill-reducing order and Cholesky factor or, where that is too large, a two-level preconditioner.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The analysis is kept while the patterns of C and of the springs do not change. It gives the memory and the work of the
!! factor, which decide between the two (doc/theory/solver.md, "Too large for a factor").
!!
!! Of a divided K each rank has the part of its own elements, and A is the sum of C' K_r C over the ranks: the iteration over the
!! ranks takes its rows from these parts, and BDDC the parts themselves; nothing else can serve.
module amontons_reduced_system
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_text, only: to_text
  use amontons_posix, only: available_megabytes, total_megabytes, process_lock_type, acquire_lock
  use amontons_mesh, only: mesh_type
  use amontons_element_kinds, only: element_kind_type, facet_kind_type, element_kind, facet_kind, &
    has_midsides
  use amontons_controls, only: linear_solver_controls_type
  use amontons_steps, only: SOLVER_AUTO, SOLVER_ITERATIVE, SOLVER_GAMG, SOLVER_HYPRE, SOLVER_MUMPS, SOLVER_BDDC
  use amontons_sparse, only: sparse_type, is_same_pattern, sparse_product, sparse_transpose, rows_of
  use amontons_matrix_reduction, only: reduction_type, analyse_reduction, reduce_matrix
  use amontons_krylov, only: operator_type, matrix_operator_type, krylov_options_type, krylov_report_type, conjugate_gradients
  use amontons_factorization, only: cholesky_type, analyse, factorise, round_factor, solve, estimate_memory, FACTOR_OK
  use amontons_graph_partition, only: partition_mesh, aggregate_elements, order_unknowns, order_unknowns_by_node, &
    nodes_by_first_use, separator_size, graph_separator_size
  use amontons_two_level_preconditioner, only: two_level_preconditioner_type, build_coarse_space, offer_corner_space, &
    factorise_two_level, apply_preconditioner, apply_deflated, correct_in_coarse_space, discard_preconditioner, &
    choose_n_parts, elements_of_part, two_level_megabytes
  use amontons_mpi_ranks, only: this_rank, n_ranks, min_over_ranks
  use amontons_distributed_solver, only: distributed_solver_type, create_distributed, create_distributed_parts, &
    update_distributed, apply_distributed, solve_distributed, DISTRIBUTED_NONE, DISTRIBUTED_GAMG, DISTRIBUTED_HYPRE, &
    DISTRIBUTED_MUMPS, DISTRIBUTED_TWO_LEVEL, DISTRIBUTED_BDDC, DISTRIBUTED_NAMES
  use amontons_distributed_two_level, only: distributed_two_level_type, create_distributed_two_level, &
    update_distributed_two_level, renew_distributed_matrix, apply_distributed_two_level, solve_distributed_two_level, &
    solve_distributed_unsymmetric, own_unknowns, discard_domain
  use amontons_constraints, only: constraints_type
  implicit none
  private
  public :: reduced_system_type, solution_cost_type, plan_reduced_solver, reason_of_iteration, is_factor_small, &
    factorise_reduced_system, apply_reduced_inverse, apply_deflated_inverse, iterate_reduced_system, iterate_unsymmetric, &
    abandon_iteration, &
    discard_analysis, discard_iteration, old_factor_iterations, renew_matrix, choose_division

  !> What the solver of A serves: one direction; many; the iterations on the contact skin, as their preconditioner; directions of
  !! Newton's method, of which those of an increment share a factor or preconditioner.
  integer, parameter, public :: USE_ONCE = 1, USE_REPEATED = 2, USE_SKIN = 3, USE_NEWTON = 4

  !> What the two solvers of A take: the figures that the choice compares.
  type :: solution_cost_type
    real(DP) :: factor_megabytes = 0               !< 0: not known
    real(DP) :: factor_entries = 0                 !< of the factor; 0: not known
    real(DP) :: factor_operations = 0              !< multiplications and additions; 0: not known
    logical :: is_estimated = .false.              !< by the last separator, without an analysis
    real(DP) :: iteration_megabytes = 0            !< of the two-level preconditioner
    real(DP) :: iteration_operations = 0           !< operations of a factor in the time of one iteration
    logical :: is_factor_too_large = .false., is_factor_too_slow = .false.
  end type solution_cost_type

  !> A, and its factor or preconditioner.
  type :: reduced_system_type
    type(reduction_type) :: reduction
    logical, allocatable :: is_idle(:)             !< (n_unknowns) no element adds to its row and column of K
    type(sparse_type) :: matrix                    !< A, or its part of this rank
    logical :: is_divided = .false.                !< A is the sum of `matrix` over the ranks
    integer, allocatable :: rank_of(:)             !< (n_elements) of each element, from 0, if A is divided
    type(cholesky_type) :: factor                    !< of A, or of A with a shift
    type(two_level_preconditioner_type) :: iterative              !< in place of the factor
    type(distributed_two_level_type) :: divided    !< the same over the ranks
    type(distributed_solver_type) :: distributed   !< of PETSc, in place of these
    logical :: is_iterative = .false.              !< not a factor in this process: one of the others
    integer :: distributed_kind = DISTRIBUTED_NONE   !< DISTRIBUTED_...: over the ranks
    type(linear_solver_controls_type) :: controls
    integer :: requested_solver = SOLVER_AUTO                 !< SOLVER_... of the step
    integer :: max_iterations = 0             !< after which the iterative solver is abandoned
    logical :: is_iteration_abandoned = .false.               !< the iterative solver did not converge
    integer :: use = USE_ONCE                      !< USE_...; USE_SKIN: the factor is kept in single precision
    logical :: is_current = .false.                !< the factor is that of the present K and C
    logical :: is_reusable = .false.               !< it, or the preconditioner, is of an earlier iteration of the attempt
    character(:), allocatable :: message              !< the choice, for the log; not allocated: nothing to report
    type(sparse_type) :: analysed_map              !< C of the last factor; of its pattern reduction and factor were analysed
    type(sparse_type) :: analysed_with_springs           !< the pattern of K with springs; not allocated without springs
    integer, allocatable :: node_order(:)          !< (n_nodes) fill-reducing order, kept while the factor stays small
    real(DP) :: best_entries = 0                   !< entries of the factor when that order was computed
    type(solution_cost_type) :: cost               !< of the last analysis
    integer :: n_factorised = 0                          !< factorisations of the last call
    integer :: n_shifted = 0                       !< of them with a shift
    integer :: n_new_iterations = 0                !< iterations of the last direction with a preconditioner of its own A
    logical :: is_shift_allowed = .true.           !< where A is not positive; else it has no factor
  end type reduced_system_type

  !> inv(A), or what is near to it, as an operator.
  type, extends(operator_type) :: inverse_type
    type(reduced_system_type), pointer :: system => null()
  contains
    procedure :: apply => apply_inverse
    procedure :: correct => correct_by_inverse
  end type inverse_type

contains

  !> Analyses A for constraints, so that the choice of the solver is known before anything is computed.
  subroutine plan_reduced_solver(self, stiffness, constraints, mesh, error)
    type(reduced_system_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness     !< K: its pattern
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    if (constraints%n_free > 0) call analyse_reduced(self, stiffness, .false., constraints, mesh, error)
  end subroutine plan_reduced_solver


  !> Whether the iteration over the ranks shall serve, so that K may be divided: as the step requests, or by the estimate of the
  !! factor.
  subroutine choose_division(self, constraints, coupled, is_divided, error)
    type(reduced_system_type), intent(inout) :: self
    type(constraints_type), intent(in) :: constraints
    type(sparse_type), intent(in) :: coupled       !< nodes that elements couple: pattern, upper triangle
    logical, intent(out) :: is_divided
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: graph
    integer :: n_members(coupled%n_rows), node(constraints%n_free), i, k, n, n_separator
    logical :: is_decided
    is_divided = .false.
    n_members = 0
    node = nodes_of(constraints)
    do i = 1, size(node)
      n_members(node(i)) = n_members(node(i)) + 1
    end do
    graph = coupled
    n = 0
    self%cost = solution_cost_type()
    do i = 1, coupled%n_rows
      graph%first(i) = n + 1
      do k = coupled%first(i), coupled%first(i + 1) - 1
        associate (j => coupled%column(k))
          self%cost%iteration_operations = self%cost%iteration_operations + real(n_members(i) * n_members(j), DP)
          if (j == i .or. n_members(i) * n_members(j) == 0) cycle
          n = n + 1
          graph%column(n) = j
        end associate
      end do
    end do
    graph%first(coupled%n_rows + 1) = n + 1
    self%cost%iteration_operations = self%controls%operations_per_entry * (self%cost%iteration_operations - &
      0.5_DP * real(sum(n_members * (n_members - 1)), DP))
    call graph_separator_size(graph, n_members, n_separator, error)
    if (allocated(error)) return
    call judge_separator(self, n_separator, is_decided)
    is_divided = is_decided
  end subroutine choose_division


  !> Whether a factor is surely small enough, without an analysis.
  logical function is_factor_small(controls, n, is_repeated)
    type(linear_solver_controls_type), intent(in) :: controls
    integer, intent(in) :: n                       !< unknowns
    logical, intent(in) :: is_repeated             !< a factor will serve many times
    is_factor_small = n < controls%min_unknowns_planned
    if (is_repeated .and. .not. is_factor_small) &
      is_factor_small = controls%factor_entries_ratio * real(n, DP)**(4.0_DP / 3.0_DP) * 8.0e-6_DP < memory_limit(controls)
  end function is_factor_small


  !> A and its factor, or preconditioner; a factor of the same K and C is kept. `status` is FACTOR_OK, or says that A is not
  !! positive even with a shift. A divided A that is not positive has no solver: is_iteration_abandoned requires a whole K.
  subroutine factorise_reduced_system(self, stiffness, has_springs, constraints, mesh, status, error)
    type(reduced_system_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness     !< K, or K with springs
    logical, intent(in) :: has_springs               !< the second
    type(constraints_type), intent(in) :: constraints    !< C
    type(mesh_type), intent(in) :: mesh
    integer, intent(out) :: status                 !< FACTOR_...
    type(error_type), allocatable, intent(out) :: error
    logical :: is_broken
    status = FACTOR_OK
    self%n_factorised = 0
    self%n_shifted = 0
    if (constraints%n_free == 0) return
    if (self%is_current) self%is_current = .not. has_springs .and. is_same_pattern(constraints%transformation, self%analysed_map)
    if (self%is_current) self%is_current = all(abs(constraints%transformation%value - self%analysed_map%value) <= 0.0_DP)
    if (self%is_current) return
    self%is_reusable = .false.
    call analyse_reduced(self, stiffness, has_springs, constraints, mesh, error)
    if (allocated(error)) return
    call reduce_matrix(self%reduction, stiffness, constraints%transformation, self%matrix, error)
    if (allocated(error)) return
    self%analysed_map%value = constraints%transformation%value
    if (self%is_iterative) then
      call update_iteration(self, is_broken, error)
      if (allocated(error)) return
      if (self%is_divided) deallocate (self%matrix%value)
      self%is_current = .not. is_broken
      self%is_reusable = self%is_current .and. any(self%distributed_kind == [DISTRIBUTED_NONE, DISTRIBUTED_TWO_LEVEL])
      if (self%is_current) return
      call abandon_iteration(self)
      if (self%is_divided) return
      call analyse_reduced(self, stiffness, has_springs, constraints, mesh, error)
      if (allocated(error)) return
      call reduce_matrix(self%reduction, stiffness, constraints%transformation, self%matrix, error)
      if (allocated(error)) return
    end if
    call factorise(self%factor, self%matrix, status, error=error)
    if (allocated(error)) return
    self%n_factorised = 1
    self%is_current = status == FACTOR_OK
    self%is_reusable = self%is_current
    if (.not. self%is_current .and. self%is_shift_allowed) call factorise_shifted(self, status, error)
    if (allocated(error) .or. status /= FACTOR_OK) return
    if (self%use == USE_SKIN) call round_factor(self%factor)
  end subroutine factorise_reduced_system


  !> The preconditioner or distributed solver of new values of A.
  subroutine update_iteration(self, is_broken, error)
    type(reduced_system_type), intent(inout) :: self
    logical, intent(out) :: is_broken              !< A is far from positive definite
    type(error_type), allocatable, intent(out) :: error
    select case (self%distributed_kind)
    case (DISTRIBUTED_NONE)
      call factorise_two_level(self%iterative, self%matrix, is_broken, error)
    case (DISTRIBUTED_TWO_LEVEL)
      call update_distributed_two_level(self%divided, self%matrix, is_broken, error)
    case default
      call update_distributed(self%distributed, self%matrix, is_broken, error)
    end select
  end subroutine update_iteration


  !> A of a new K, with the preconditioner of an earlier one.
  subroutine renew_matrix(self, stiffness, constraints, error)
    type(reduced_system_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness     !< K, in the pattern of the earlier one
    type(constraints_type), intent(in) :: constraints    !< C, likewise
    type(error_type), allocatable, intent(out) :: error
    call reduce_matrix(self%reduction, stiffness, constraints%transformation, self%matrix, error)
    if (allocated(error)) return
    self%analysed_map%value = constraints%transformation%value
    if (self%distributed_kind /= DISTRIBUTED_TWO_LEVEL) return
    call renew_distributed_matrix(self%divided, self%matrix)
    if (self%is_divided) deallocate (self%matrix%value)
  end subroutine renew_matrix


  !> The iterations with the factor or the preconditioner of an earlier K before a new one is made; 0: there is none, or it does
  !! not pay.
  pure integer function old_factor_iterations(self, constraints) result(n)
    type(reduced_system_type), intent(in) :: self
    type(constraints_type), intent(in) :: constraints
    n = 0
    if (.not. self%is_reusable) return
    if (self%is_iterative) then
      n = self%controls%max_iteration_growth * self%n_new_iterations
    else if (self%factor%is_ready) then
      n = int(self%controls%old_factor_work_ratio * self%factor%n_operations / &
        (self%controls%operations_per_factor_entry * self%factor%n_entries))
    end if
    if (n < self%controls%min_old_iterations) n = 0
    if (.not. is_same_pattern(constraints%transformation, self%analysed_map)) n = 0
  end function old_factor_iterations


  !> Repeats the analysis if the pattern of C or of the springs has changed.
  subroutine analyse_reduced(self, stiffness, has_springs, constraints, mesh, error)
    type(reduced_system_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness
    logical, intent(in) :: has_springs
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    logical :: is_known
    is_known = is_same_pattern(constraints%transformation, self%analysed_map) &
      .and. (has_springs .eqv. allocated(self%analysed_with_springs%first))
    if (is_known .and. has_springs) is_known = is_same_pattern(stiffness, self%analysed_with_springs)
    if (is_known) return
    call analyse_reduction(stiffness, constraints%transformation, self%reduction, self%matrix, error, self%is_idle)
    if (allocated(error)) return
    call choose_solver(self, constraints, mesh, error)
    if (allocated(error)) return
    self%analysed_map = constraints%transformation
    self%analysed_with_springs = sparse_type()
    if (has_springs) self%analysed_with_springs = stiffness
  end subroutine analyse_reduced


  !> Invalidates the analysis.
  subroutine discard_analysis(self)
    type(reduced_system_type), intent(inout) :: self
    if (allocated(self%analysed_map%first)) deallocate (self%analysed_map%first)
    self%is_current = .false.
    self%is_reusable = .false.
  end subroutine discard_analysis


  !> Chooses factor or iteration: as the step requests; else a factor, unless it does not fit into memory or takes very much work
  !! for one use. The analysis of the factor gives both.
  subroutine choose_solver(self, constraints, mesh, error)
    type(reduced_system_type), intent(inout) :: self
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    logical :: was_iterative, has_subdomains
    was_iterative = self%is_iterative
    has_subdomains = .false.
    self%distributed_kind = requested_kind(self%requested_solver)
    self%is_iterative = (self%requested_solver == SOLVER_ITERATIVE .or. self%distributed_kind /= DISTRIBUTED_NONE) .and. &
      .not. self%is_iteration_abandoned
    self%max_iterations = self%controls%max_cg_iterations
    if (.not. self%is_divided) self%cost = solution_cost_type( &
      iteration_megabytes=two_level_megabytes(constraints%n_free, size(self%matrix%column), choose_n_parts(mesh%n_nodes), &
      any(has_midsides(mesh%kind))), &
      iteration_operations=self%controls%operations_per_entry * real(size(self%matrix%column), DP))
    if (self%is_divided) then
      self%is_iterative = .true.
      if (self%distributed_kind /= DISTRIBUTED_BDDC) self%distributed_kind = DISTRIBUTED_TWO_LEVEL
    else if (.not. self%is_iterative) then
      call find_factor_cost(self, constraints, mesh, has_subdomains, error)
      if (allocated(error)) return
      associate (cost => self%cost)
        self%is_iterative = (cost%is_factor_too_large .or. cost%is_factor_too_slow) .and. .not. self%is_iteration_abandoned
        if (.not. (cost%is_estimated .or. cost%is_factor_too_large)) self%max_iterations = nint(min(real(self%max_iterations, DP), &
          self%controls%max_iteration_work_ratio * cost%factor_operations / cost%iteration_operations))
      end associate
      call distribute_by_default(self, constraints%n_free)
    end if
    if (has_subdomains .and. .not. self%is_iterative) call discard_preconditioner(self%iterative)
    if (.not. self%is_iterative) return
    if (self%distributed_kind == DISTRIBUTED_NONE) then
      if (.not. has_subdomains) call create_subdomains(self%iterative, constraints, mesh, error)
    else
      call distribute(self, constraints, mesh, error)
    end if
    if (.not. (allocated(error) .or. was_iterative)) call report_choice(self, constraints)
  end subroutine choose_solver


  !> The distributed solver that a step requests.
  integer function requested_kind(requested_solver) result(kind)
    integer, intent(in) :: requested_solver        !< SOLVER_...
    kind = DISTRIBUTED_NONE
    if (n_ranks() > 1 .and. requested_solver == SOLVER_ITERATIVE) kind = DISTRIBUTED_TWO_LEVEL
    if (requested_solver == SOLVER_GAMG) kind = DISTRIBUTED_GAMG
    if (requested_solver == SOLVER_HYPRE) kind = DISTRIBUTED_HYPRE
    if (requested_solver == SOLVER_MUMPS) kind = DISTRIBUTED_MUMPS
    if (requested_solver == SOLVER_BDDC) kind = DISTRIBUTED_BDDC
  end function requested_kind


  !> Ranks share a large system: the iteration always; the factor, as MUMPS, only if they are many: few have each its own, which is
  !! faster and gives the bits of all. So has the contact skin, which solves with a factor many times.
  subroutine distribute_by_default(self, n_free)
    type(reduced_system_type), intent(inout) :: self
    integer, intent(in) :: n_free
    if (n_ranks() == 1 .or. n_free < self%controls%min_unknowns_planned .or. self%is_iteration_abandoned) return
    if (self%is_iterative) then
      self%distributed_kind = DISTRIBUTED_TWO_LEVEL
    else if (n_ranks() >= self%controls%min_ranks_shared .and. self%use /= USE_SKIN) then
      self%distributed_kind = DISTRIBUTED_MUMPS
      self%is_iterative = .true.
      self%max_iterations = self%controls%max_cg_iterations
    end if
  end subroutine distribute_by_default


  !> The unknowns of A on the ranks, by METIS parts of the mesh.
  subroutine distribute(self, constraints, mesh, error)
    type(reduced_system_type), intent(inout) :: self
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    type(two_level_preconditioner_type) :: coarse_space
    integer, allocatable :: of_element(:)
    integer :: of_node(mesh%n_nodes), unknown(constraints%n_free), e, i
    of_node = 0
    if (self%is_divided) then
      of_element = self%rank_of + 1
    else if (n_ranks() > 1) then
      call partition_mesh(mesh%n_elements, mesh%first, mesh%nodes, mesh%n_nodes, n_ranks(), of_element, error=error)
      if (allocated(error)) return
    end if
    do e = 1, merge(mesh%n_elements, 0, n_ranks() > 1)
      of_node(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) = of_element(e) - 1
    end do
    if (self%distributed_kind == DISTRIBUTED_TWO_LEVEL) then
      call create_subdomains(coarse_space, constraints, mesh, error)
      if (allocated(error)) return
      if (self%is_divided) then
        call create_distributed_two_level(self%divided, self%matrix, of_node(nodes_of(constraints)), coarse_space, &
          held_unknowns(self, constraints, mesh))
      else
        call create_distributed_two_level(self%divided, self%matrix, of_node(nodes_of(constraints)), coarse_space)
      end if
      return
    end if
    do i = 1, constraints%n_unknowns
      if (constraints%free_of(i) > 0) unknown(constraints%free_of(i)) = i
    end do
    if (self%distributed_kind == DISTRIBUTED_BDDC) then
      call create_distributed_parts(self%distributed, self%matrix, held_unknowns(self, constraints, mesh), &
        of_node(nodes_of(constraints)), unknown, mesh%coordinates, error)
    else
      call create_distributed(self%distributed, self%distributed_kind, self%matrix, unknown, of_node, mesh%coordinates, error)
    end if
  end subroutine distribute


  !> The free unknowns to which elements of this rank contribute: all of a whole matrix.
  function held_unknowns(self, constraints, mesh) result(is_held)
    type(reduced_system_type), intent(in) :: self
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    logical :: is_held(constraints%n_free)
    logical :: is_own(mesh%n_nodes)                ! a node of an element of this rank
    integer :: e, i
    is_held = .not. self%is_divided
    if (.not. self%is_divided) return
    is_own = .false.
    do e = 1, mesh%n_elements
      if (self%rank_of(e) == this_rank()) is_own(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) = .true.
    end do
    is_held = .false.
    associate (C => constraints%transformation)
      do i = 1, C%n_rows
        if (is_own((i + 2) / 3)) is_held(C%column(C%first(i):C%first(i + 1) - 1)) = .true.
      end do
    end associate
  end function held_unknowns


  !> Memory and work of the factor, and whether they are too much: by its analysis, or by an estimate where that suffices.
  subroutine find_factor_cost(self, constraints, mesh, has_subdomains, error)
    type(reduced_system_type), intent(inout) :: self
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    logical, intent(out) :: has_subdomains         !< the subdomains of the iterative solver are made, too
    type(error_type), allocatable, intent(out) :: error
    logical :: is_planned
    is_planned = constraints%n_free >= merge(self%controls%min_unknowns_newton, self%controls%min_unknowns_planned, &
      self%use == USE_NEWTON)
    call estimate_factor(self, constraints, mesh, has_subdomains, error)
    if (allocated(error) .or. self%cost%is_estimated) return
    call analyse_factor(self, constraints, error)
    associate (cost => self%cost)
      cost%is_factor_too_large = allocated(error)
      if (allocated(error)) then
        if (is_planned .and. .not. self%is_iteration_abandoned) deallocate (error)
        return
      end if
      cost%factor_megabytes = estimate_memory(self%factor)
      cost%factor_entries = self%factor%n_entries
      cost%factor_operations = self%factor%n_operations
      if (.not. is_planned) return
      cost%is_factor_too_large = cost%factor_megabytes > memory_limit(self%controls)
      cost%is_factor_too_slow = factor_work(self, cost%factor_operations, cost%factor_entries) > iteration_work(self)
    end associate
  end subroutine find_factor_cost


  !> Whether a factor is so much too large, or takes so much work, that it need not be analysed: then the cost is an estimate. METIS
  !! finds the last separator in a tenth of the time of the whole order; the estimate holds for a compact body and is a lower bound
  !! for a longer one. A second thread makes the subdomains of the iterative solver meanwhile, which most systems of this size need.
  subroutine estimate_factor(self, constraints, mesh, has_subdomains, error)
    type(reduced_system_type), intent(inout) :: self
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    logical, intent(out) :: has_subdomains
    type(error_type), allocatable, intent(out) :: error
    type(error_type), allocatable :: subdomain_error
    logical :: is_decided
    integer :: n_separator
    has_subdomains = .false.
    if (constraints%n_free < self%controls%min_unknowns_estimated .or. self%is_iteration_abandoned .or. &
      allocated(self%node_order)) return
    has_subdomains = n_ranks() == 1
    !$omp parallel sections
    !$omp section
    call separator_size(self%matrix, nodes_of(constraints), constraints%n_unknowns / 3, n_separator, error)
    !$omp section
    if (has_subdomains) call create_subdomains(self%iterative, constraints, mesh, subdomain_error)
    !$omp end parallel sections
    if (.not. allocated(error) .and. allocated(subdomain_error)) call move_alloc(subdomain_error, error)
    if (.not. allocated(error)) call judge_separator(self, n_separator, is_decided)
  end subroutine estimate_factor


  !> Whether a factor with such a last separator is so much too large or too slow. Then the cost is the estimate.
  subroutine judge_separator(self, n_separator, is_decided)
    type(reduced_system_type), intent(inout) :: self
    integer, intent(in) :: n_separator             !< unknowns
    logical, intent(out) :: is_decided
    real(DP) :: n, megabytes, entries, operations
    logical :: is_too_large, is_too_slow
    associate (limits => self%controls, cost => self%cost)
      n = real(n_separator, DP)
      entries = limits%separator_entries_ratio * n**2
      megabytes = 8.0e-6_DP * entries
      operations = limits%separator_work_ratio * n**3
      is_too_large = megabytes > limits%estimate_safety_factor * memory_limit(limits)
      is_too_slow = factor_work(self, operations, entries) > limits%estimate_safety_factor * iteration_work(self)
      is_decided = is_too_large .or. is_too_slow
      if (.not. is_decided) return
      cost = solution_cost_type(megabytes, entries, operations, .true., cost%iteration_megabytes, cost%iteration_operations, &
        is_too_large, is_too_slow)
    end associate
  end subroutine judge_separator


  !> Operations of a factor for what it serves, with its solutions where both solvers take many. Zero: a factor always pays.
  pure real(DP) function factor_work(self, operations, entries) result(work)
    type(reduced_system_type), intent(in) :: self
    real(DP), intent(in) :: operations             !< of the factorization
    real(DP), intent(in) :: entries                !< of the factor
    work = operations
    if (self%use == USE_REPEATED) work = 0.0_DP
    if (self%use == USE_SKIN) work = work + self%controls%skin_solves * self%controls%operations_per_factor_entry * entries
    if (self%use == USE_NEWTON) work = self%controls%newton_factors * work + &
      self%controls%newton_solves * self%controls%operations_per_factor_entry * entries
  end function factor_work


  !> Operations of a factor in the time of the iterations in its place.
  pure real(DP) function iteration_work(self) result(work)
    type(reduced_system_type), intent(in) :: self
    real(DP) :: n_iterations
    n_iterations = self%controls%expected_iterations
    if (self%use == USE_SKIN) n_iterations = self%controls%skin_solves * self%controls%skin_work_ratio
    if (self%use == USE_NEWTON) n_iterations = self%controls%expected_newton_iterations
    work = n_iterations * self%cost%iteration_operations
  end function iteration_work


  !> What a factor may take [megabytes]: a share of all memory, the same whenever a job runs, and no more than is free. Ranks may
  !! share a machine.
  real(DP) function memory_limit(controls)
    type(linear_solver_controls_type), intent(in) :: controls
    memory_limit = min(controls%max_memory_share * total_megabytes(), controls%max_free_memory_share * available_megabytes())
    memory_limit = min_over_ranks(memory_limit) / real(n_ranks(), DP)
  end function memory_limit


  !> The node of each free unknown.
  pure function nodes_of(constraints) result(node)
    type(constraints_type), intent(in) :: constraints
    integer :: node(constraints%n_free)
    integer :: i
    do i = 1, constraints%n_unknowns
      if (constraints%free_of(i) > 0) node(constraints%free_of(i)) = (i + 2) / 3
    end do
  end function nodes_of


  !> The message about an iterative solution.
  subroutine report_choice(self, constraints)
    type(reduced_system_type), intent(inout) :: self
    type(constraints_type), intent(in) :: constraints
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    if (self%distributed_kind /= DISTRIBUTED_NONE) then
      self%message = pending_message(self) // 'The ' // to_text(constraints%n_free) // ' equations are distributed and ' // &
        'solved by ' // trim(DISTRIBUTED_NAMES(self%distributed_kind)) // '.'
      return
    end if
    self%message = pending_message(self) // 'The ' // to_text(constraints%n_free) // ' equations are solved by iteration, ' &
      // reason_of_iteration(self) // '. The preconditioner takes ' // to_text(nint(self%cost%iteration_megabytes)) // ' megabytes.'
  end subroutine report_choice


  !> Why the equations are solved by iteration.
  function reason_of_iteration(self) result(reason)
    type(reduced_system_type), intent(in) :: self
    character(:), allocatable :: reason
    real(DP) :: whole_memory
    whole_memory = total_megabytes()
    associate (cost => self%cost)
      if (any(self%requested_solver == [SOLVER_ITERATIVE, SOLVER_GAMG, SOLVER_HYPRE, SOLVER_MUMPS, &
        SOLVER_BDDC])) then
        reason = 'as SOLVER requests'
      else if (cost%is_factor_too_large .and. cost%factor_megabytes <= 0.0_DP) then
        reason = 'because the factor would have more entries than can be counted (17 gigabytes)'
      else if (cost%is_factor_too_large .and. cost%factor_megabytes > self%controls%max_memory_share * whole_memory) then
        reason = 'because the factor would take ' // to_text(nint(cost%factor_megabytes)) // ' megabytes, too much of ' // &
          to_text(nint(whole_memory)) // ' in all'
      else if (cost%is_factor_too_large) then
        reason = 'because the factor would take ' // to_text(nint(cost%factor_megabytes)) // ' megabytes and ' // &
          to_text(nint(available_megabytes())) // &
          ' are free at the moment (with more, another run would take a factor, and differ in the last digits)'
      else if (cost%is_estimated) then
        reason = 'which takes less time than a factor of some ' // to_text(nint(cost%factor_megabytes)) // ' megabytes'
      else
        reason = 'which takes less time than a factor of ' // to_text(nint(cost%factor_operations / 1.0e9_DP)) // &
          ' thousand million operations and ' // to_text(nint(cost%factor_megabytes)) // ' megabytes'
      end if
    end associate
  end function reason_of_iteration


  !> The message that is not yet reported, with a space.
  pure function pending_message(self) result(news)
    type(reduced_system_type), intent(in) :: self
    character(:), allocatable :: news
    news = ''
    if (allocated(self%message)) news = self%message // ' '
  end function pending_message


  !> The iterative solver did not converge: use a factor from now on.
  subroutine abandon_iteration(self)
    type(reduced_system_type), intent(inout) :: self
    type(process_lock_type) :: turn
    call acquire_lock(turn)
    self%is_iteration_abandoned = .true.
    self%is_iterative = .false.
    call discard_iteration(self)
    self%divided = distributed_two_level_type()
    self%message = pending_message(self) // 'The iterative solver did not converge: a factor is used in its place.'
  end subroutine abandon_iteration


  !> Frees A and its preconditioner or distributed solver.
  subroutine discard_iteration(self)
    type(reduced_system_type), intent(inout) :: self
    self%matrix = sparse_type()
    call discard_preconditioner(self%iterative)
    self%distributed = distributed_solver_type()
    call discard_domain(self%divided)
    call discard_analysis(self)
  end subroutine discard_iteration


  !> The parts of the mesh whose rigid motions are the second level of the preconditioner.
  subroutine create_subdomains(coarse_space, constraints, mesh, error)
    type(two_level_preconditioner_type), intent(inout) :: coarse_space
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: of_node(:), part(:), axis(:)
    real(DP), allocatable :: position(:, :)
    integer :: ends_of_node(2, mesh%n_nodes), n_parts, i, f
    call divide_nodes(constraints, mesh, of_node, n_parts, error)
    if (allocated(error)) return
    allocate (part(constraints%n_free), axis(constraints%n_free), position(3, constraints%n_free))
    do i = 1, constraints%n_unknowns
      f = constraints%free_of(i)
      if (f == 0) cycle
      part(f) = of_node((i + 2) / 3)
      axis(f) = 1 + mod(i - 1, 3)
      position(:, f) = mesh%coordinates(:, (i + 2) / 3)
    end do
    call build_coarse_space(coarse_space, part, axis, position, n_parts)
    call find_edge_ends(mesh, ends_of_node)
    if (any(ends_of_node > 0)) call offer_corner_space(coarse_space, ends_of_unknowns(constraints, ends_of_node))
  end subroutine create_subdomains


  !> The part of each node: that of one of its elements. A node without elements that is free in all directions (a reference node,
  !! one of rotations) is a part of its own: what depends on it moves as it does. Parts without free unknowns do not count.
  subroutine divide_nodes(constraints, mesh, of_node, n_parts, error)
    type(constraints_type), intent(in) :: constraints
    type(mesh_type), intent(in) :: mesh
    integer, allocatable, intent(out) :: of_node(:)   !< (n_nodes) 0: no free unknown
    integer, intent(out) :: n_parts
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: of_element(:), number(:)
    logical :: is_free(mesh%n_nodes)
    integer :: e, i
    call aggregate_elements(mesh%n_elements, mesh%first, mesh%nodes, mesh%n_nodes, &
      elements_of_part(mesh%n_elements, mesh%n_nodes), of_element, n_parts, error)
    if (allocated(error)) return
    allocate (of_node(mesh%n_nodes), source=0)
    do e = 1, mesh%n_elements
      of_node(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) = of_element(e)
    end do
    is_free = [(any(constraints%free_of(3 * i - 2:3 * i) > 0), i=1, mesh%n_nodes)]
    do i = 1, mesh%n_nodes
      if (of_node(i) > 0 .or. .not. is_free(i)) cycle
      of_node(i) = 1
      if (any(constraints%free_of(3 * i - 2:3 * i) == 0)) cycle
      n_parts = n_parts + 1
      of_node(i) = n_parts
    end do
    where (.not. is_free) of_node = 0
    allocate (number(0:n_parts), source=0)
    number(of_node) = 1
    number(0) = 0
    do i = 1, n_parts
      number(i) = number(i - 1) + number(i)
    end do
    where (is_free) of_node = number(of_node)
    n_parts = number(n_parts)
  end subroutine divide_nodes


  !> The ends of the edge of each mid-side node; 0 for others. A node at the corner of any element is none.
  pure subroutine find_edge_ends(mesh, ends)
    type(mesh_type), intent(in) :: mesh
    integer, intent(out) :: ends(:, :)             !< (2, n_nodes)
    logical :: is_corner(mesh%n_nodes)
    type(element_kind_type) :: element
    type(facet_kind_type), allocatable :: facets(:)
    integer :: e, f, k, kind
    ends = 0
    is_corner = .false.
    kind = 0
    do e = 1, mesh%n_elements
      if (mesh%kind(e) /= kind) then
        kind = mesh%kind(e)
        element = element_kind(kind)
        facets = [(facet_kind(element%face_kind(f)), f=1, element%n_faces)]
      end if
      do f = 1, element%n_faces
        associate (facet => facets(f), nodes => mesh%nodes(mesh%first(e) - 1 + element%face_nodes(:facets(f)%n_nodes, f)))
          is_corner(nodes(:facet%n_corners)) = .true.
          do k = 1, facet%n_nodes - facet%n_corners
            ends(:, nodes(facet%n_corners + k)) = nodes([k, mod(k, facet%n_corners) + 1])
          end do
        end associate
      end do
    end do
    where (spread(is_corner, 1, 2)) ends = 0
  end subroutine find_edge_ends


  !> The same for the free unknowns: 0 for an end that is not free, twice itself for an unknown beside the middles of edges.
  pure function ends_of_unknowns(constraints, ends_of_node) result(ends)
    type(constraints_type), intent(in) :: constraints
    integer, intent(in) :: ends_of_node(:, :)      !< (2, n_nodes) 0: not in the middle of an edge
    integer :: ends(2, constraints%n_free)
    integer :: i, f
    do i = 1, constraints%n_unknowns
      f = constraints%free_of(i)
      if (f == 0) cycle
      ends(:, f) = f
      associate (nodes => ends_of_node(:, (i + 2) / 3))
        if (nodes(1) > 0) ends(:, f) = constraints%free_of(3 * nodes + mod(i - 1, 3) - 2)
      end associate
    end do
  end function ends_of_unknowns


  !> Analyses A in the present order of the nodes. METIS computes a new order only if the factor has grown too much.
  subroutine analyse_factor(self, constraints, error)
    type(reduced_system_type), intent(inout) :: self
    type(constraints_type), intent(in) :: constraints
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: node(:), order(:)
    integer :: n_nodes
    n_nodes = constraints%n_unknowns / 3
    node = nodes_of(constraints)
    if (allocated(self%node_order)) then
      call analyse(self%factor, self%matrix, order_unknowns_by_node(self%node_order, node), error)
      if (allocated(error)) return
      if (self%factor%n_entries <= self%controls%max_factor_growth * self%best_entries) return
    end if
    call order_unknowns(self%matrix, node, n_nodes, order, error)
    if (allocated(error)) return
    call analyse(self%factor, self%matrix, order, error)
    self%best_entries = self%factor%n_entries
    self%node_order = nodes_by_first_use(node(order), n_nodes)
  end subroutine analyse_factor


  !> A is singular or indefinite: factorise A plus a fraction of its diagonal. The solution does not change: the factor is then a
  !! preconditioner only.
  subroutine factorise_shifted(self, status, error)
    type(reduced_system_type), intent(inout) :: self
    integer, intent(out) :: status
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: diagonal(:), shift_by(:)
    integer :: attempt
    diagonal = abs(self%matrix%value(self%matrix%first(:self%matrix%n_rows)))
    do attempt = 0, 4
      shift_by = self%controls%initial_shift_ratio * 10.0_DP**attempt * diagonal
      call factorise(self%factor, self%matrix, status, shift_by, error)
      if (allocated(error)) return
      self%n_factorised = self%n_factorised + 1
      self%n_shifted = self%n_shifted + 1
      if (status == FACTOR_OK) return
    end do
  end subroutine factorise_shifted


  !> y = inv(A) x, or an approximation by the preconditioner.
  subroutine apply_reduced_inverse(self, x, y)
    type(reduced_system_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    if (.not. self%is_iterative) then
      call solve(self%factor, x, y)
      return
    end if
    select case (self%distributed_kind)
    case (DISTRIBUTED_NONE)
      call apply_preconditioner(self%iterative, self%matrix, x, y)
    case (DISTRIBUTED_TWO_LEVEL)
      call apply_distributed_two_level(self%divided, x, y)
    case default
      call apply_distributed(self%distributed, x, y)
    end select
  end subroutine apply_reduced_inverse


  !> Solves A x = b by conjugate gradients: in place of a factor, or with one of another matrix as preconditioner.
  subroutine iterate_reduced_system(self, b, x, options, report, error)
    type(reduced_system_type), intent(inout), target :: self
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: x(:)                !< (n_free) in: first guess; out: solution [length]
    type(krylov_options_type), intent(in) :: options
    type(krylov_report_type), intent(out) :: report
    type(error_type), allocatable, intent(out) :: error
    type(matrix_operator_type) :: matrix
    type(inverse_type) :: preconditioner
    select case (merge(self%distributed_kind, DISTRIBUTED_NONE, self%is_iterative))
    case (DISTRIBUTED_NONE)
      matrix%matrix => self%matrix
      preconditioner%system => self
      call conjugate_gradients(matrix, preconditioner, b, x, options, report)
    case (DISTRIBUTED_TWO_LEVEL)
      call solve_distributed_two_level(self%divided, self%is_current, b, x, options, report)
    case default
      call solve_distributed(self%distributed, b, x, options, report, error)
    end select
  end subroutine iterate_reduced_system


  !> Solves (A - C' W C) x = b by GMRES on the unknowns of each rank, from x = 0, where the iteration over the ranks serves.
  subroutine iterate_unsymmetric(self, skew, constraints, b, x, options, report, error)
    type(reduced_system_type), intent(inout) :: self
    type(sparse_type), intent(in) :: skew          !< W (n_unknowns x n_unknowns), in the pattern of K [force/length]
    type(constraints_type), intent(in) :: constraints    !< C
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(out) :: x(:)                  !< (n_free) [length]
    type(krylov_options_type), intent(in) :: options
    type(krylov_report_type), intent(out) :: report
    type(error_type), allocatable, intent(out) :: error
    associate (C => constraints%transformation)
      call solve_distributed_unsymmetric(self%divided, self%is_current, &
        sparse_product(sparse_product(rows_of(sparse_transpose(C), own_unknowns(self%divided)), skew), C), &
        b, x, options, report, error)
    end associate
  end subroutine iterate_unsymmetric


  !> y ~ inv(A) x, for Krylov methods on A or nearly A: the two levels one after the other where they are those of A.
  subroutine apply_deflated_inverse(self, x, y)
    type(reduced_system_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    if (has_current_levels(self)) then
      call apply_deflated(self%iterative, self%matrix, x, y)
    else
      call apply_reduced_inverse(self, x, y)
    end if
  end subroutine apply_deflated_inverse


  !> y ~ inv(A) x.
  subroutine apply_inverse(self, x, y)
    class(inverse_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    call apply_deflated_inverse(self%system, x, y)
  end subroutine apply_inverse


  !> The solution in the coarse space of A; 0 without one.
  subroutine correct_by_inverse(self, r, z)
    class(inverse_type), intent(inout) :: self
    real(DP), intent(in) :: r(:)                   !< (n_free) [force]
    real(DP), intent(out) :: z(:)                  !< (n_free) [length]
    z = 0
    if (has_current_levels(self%system)) call correct_in_coarse_space(self%system%iterative, r, z)
  end subroutine correct_by_inverse


  !> Whether the preconditioner on two levels serves, on this rank alone, and is that of the present A: the second level of a softer
  !! A would correct too much.
  pure logical function has_current_levels(self)
    type(reduced_system_type), intent(in) :: self
    has_current_levels = self%is_iterative .and. self%is_current .and. self%distributed_kind == DISTRIBUTED_NONE
  end function has_current_levels

end module amontons_reduced_system
