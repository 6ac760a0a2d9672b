!> Estimate of a job: unknowns, contact interface, memory and processor time of the solvers, and which one will be chosen.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The job is prepared up to its first linear solve: model, contact at the start, stiffness, ordering, symbolic factorization. The
!! figures of cost are those by which the program chooses the solver (`solution_cost_type`). Times of factors are operations over
!! the speed of this machine in a product of dense matrices, those of iterations products with the stiffness, both measured. On
!! several ranks the preparation and a part of the preconditioner are repeated, the rest is divided.
module amontons_job_estimate
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_text, only: to_text, plural, NEWLINE
  use amontons_posix, only: peak_megabytes
  use amontons_logger, only: logger_type
  use amontons_model, only: job_options_type
  use amontons_steps, only: step_type, SOLVER_GRADIENTS
  use amontons_blas_lapack, only: dgemm
  use amontons_assembly, only: assemble_tangent
  use amontons_assembly_plan, only: multiply_stiffness
  use amontons_reduced_system, only: reduced_system_type, solution_cost_type, plan_reduced_solver, reason_of_iteration
  use amontons_schur_interface, only: analyse_bulk
  use amontons_equilibrium, only: equilibrium_type, n_interface_unknowns
  use amontons_newton_step, only: is_skin_chosen, configure_bulk_solver
  use amontons_job_files, only: analysis_type
  use amontons_analysis, only: start_analysis, enter_step, begin_trial
  implicit none
  private
  public :: estimate_job, job_estimate_type, describe_estimate

  real(DP), parameter :: FACTOR_EFFICIENCY = 0.5_DP       !< speed of a factorization over that of a dense product [-] |
                                                          !! doc/performance.md
  real(DP), parameter :: ITERATION_PRODUCTS = 4.8_DP      !< an iteration over a product with the stiffness [-] | doc/performance.md
  real(DP), parameter :: PRECONDITIONER_PRODUCTS = 85.0_DP   !< its preconditioner, likewise [-] | doc/performance.md
  integer, parameter :: LINEAR_ITERATIONS = 32            !< of a solution in a compact body | doc/theory/solver.md
  integer, parameter :: NEWTON_ITERATIONS = 20            !< of a direction of Newton's method there | doc/performance.md
  real(DP), parameter :: REPEATED_PRECONDITIONER = 0.5_DP !< its share that each rank repeats [-] | doc/performance.md
  real(DP), parameter :: RAGGED_BORDER = 1.3_DP           !< nodes on the border of a part over those of a cube as large [-]
  integer, parameter :: RANKS(4) = [2, 4, 8, 16]          !< numbers of ranks estimated
  integer, parameter :: CONTACT_NONE = 0, CONTACT_DENSE = 1, CONTACT_SKIN = 2, CONTACT_GRADIENTS = 3

  !> What a job will take, of its first step.
  type :: job_estimate_type
    integer :: n_nodes = 0, n_elements = 0, n_unknowns = 0, n_free = 0
    integer :: n_slaves = 0
    integer :: n_interface = 0                     !< unknowns of the contact interface
    integer :: contact_solver = CONTACT_NONE       !< CONTACT_...
    logical :: has_matrix = .true.                 !< .false.: conjugate gradients without a matrix
    logical :: is_iterative = .false.              !< the choice
    logical :: is_linear = .false.                 !< the stiffness is constant and there is no contact
    integer :: n_increments = 0                    !< of the first step if all are as long as the first
    type(solution_cost_type) :: cost
    real(DP) :: expected_iterations = 0            !< of the iterative solver in the choice
    real(DP) :: n_entries = 0                      !< of the stiffness, upper triangle
    integer :: min_ranks_shared = 0                !< ranks from which on they share a factor
    real(DP) :: operations_per_entry = 0           !< of a factorization in the time that a solve takes for an entry of the factor
    character(:), allocatable :: reason            !< of an iteration
    real(DP) :: megabytes = 0                      !< peak of the preparation
    real(DP) :: speed = 0                          !< operations of a factorization a second [1/s]
    real(DP) :: preparation_seconds = 0            !< reading, checks, ordering: processor time taken [s]
    real(DP) :: force_seconds = 0                  !< one evaluation of the forces: taken [s]
    real(DP) :: tangent_seconds = 0                !< one assembly of the stiffness: taken [s]
    real(DP) :: product_seconds = 0                !< one product with the stiffness: taken [s]
  end type job_estimate_type

contains

  !> Prepares a job without solving it, and finds what it takes. No file is written. Errors: as of a job.
  subroutine estimate_job(options, logger, estimate, error)
    type(job_options_type), intent(in) :: options
    type(logger_type), intent(inout) :: logger
    type(job_estimate_type), intent(out) :: estimate
    type(error_type), allocatable, intent(out) :: error
    type(job_options_type) :: without_files
    type(analysis_type) :: analysis
    real(DP) :: start, now
    without_files = options
    without_files%has_files = .false.
    without_files%is_resumed = .false.
    call cpu_time(start)
    call start_analysis(analysis, without_files, logger, error)
    if (allocated(error) .or. .not. analysis%is_open) return
    call enter_step(analysis, error)
    if (allocated(error)) return
    call count_unknowns(analysis, estimate)
    call cpu_time(now)
    estimate%preparation_seconds = now - start
    call time_elements(analysis, estimate, error)
    if (allocated(error)) return
    call cpu_time(start)
    call plan_solvers(analysis%system, analysis, estimate, error)
    if (allocated(error)) return
    call cpu_time(now)
    estimate%preparation_seconds = estimate%preparation_seconds + now - start
    estimate%megabytes = peak_megabytes()
    estimate%speed = FACTOR_EFFICIENCY * dense_product_speed()
  end subroutine estimate_job


  !> Sizes of the model and of its first step.
  subroutine count_unknowns(analysis, estimate)
    type(analysis_type), intent(in) :: analysis
    type(job_estimate_type), intent(inout) :: estimate
    associate (step => analysis%driven_loads%step, system => analysis%system)
      estimate%n_nodes = analysis%model%mesh%n_nodes
      estimate%n_elements = analysis%model%mesh%n_elements
      estimate%n_unknowns = system%base%n_unknowns
      estimate%n_free = system%base%n_free
      estimate%n_slaves = size(analysis%state%old%slaves)
      estimate%is_linear = system%is_constant .and. estimate%n_slaves == 0
      estimate%n_increments = max(1, nint(min(step%period / max(step%dt_initial, tiny(1.0_DP)), 1.0e9_DP)))
      estimate%expected_iterations = step%controls%linear_solver%expected_iterations
      estimate%operations_per_entry = step%controls%linear_solver%operations_per_factor_entry
      estimate%min_ranks_shared = step%controls%linear_solver%min_ranks_shared
      estimate%has_matrix = .not. system%is_matrix_free
      if (step%solver == SOLVER_GRADIENTS) estimate%contact_solver = CONTACT_GRADIENTS
    end associate
  end subroutine count_unknowns


  !> Evaluates forces and stiffness once, at the start of the first increment, and times a product: the best of some trials.
  subroutine time_elements(analysis, estimate, error)
    type(analysis_type), intent(inout) :: analysis
    type(job_estimate_type), intent(inout) :: estimate
    type(error_type), allocatable, intent(out) :: error
    integer, parameter :: N_TRIALS = 3
    real(DP), allocatable :: u(:), w(:)
    real(DP) :: start, now
    integer :: failed, trial
    call cpu_time(start)
    call begin_trial(analysis, analysis%stepping%dt, error)
    if (allocated(error)) return
    call cpu_time(now)
    estimate%force_seconds = now - start
    if (.not. estimate%has_matrix) return
    call assemble_tangent(analysis%system%assembly, analysis%model, analysis%driven_loads%step%is_nlgeom, analysis%state, failed)
    call cpu_time(start)
    estimate%tangent_seconds = start - now
    estimate%n_entries = real(size(analysis%system%assembly%stiffness%column), DP)
    allocate (u(estimate%n_unknowns), source=1.0_DP)
    allocate (w(estimate%n_unknowns))
    estimate%product_seconds = huge(1.0_DP)
    do trial = 1, N_TRIALS
      call cpu_time(start)
      call multiply_stiffness(analysis%system%assembly, u, w)
      call cpu_time(now)
      estimate%product_seconds = min(estimate%product_seconds, now - start)
    end do
  end subroutine time_elements


  !> Analyses the solver that the first direction will use.
  subroutine plan_solvers(system, analysis, estimate, error)
    type(equilibrium_type), intent(inout) :: system      !< of the analysis
    type(analysis_type), intent(in) :: analysis
    type(job_estimate_type), intent(inout) :: estimate
    type(error_type), allocatable, intent(out) :: error
    if (.not. estimate%has_matrix .or. estimate%contact_solver == CONTACT_GRADIENTS .or. estimate%n_free == 0) return
    associate (model => analysis%model, step => analysis%driven_loads%step)
      if (estimate%n_slaves == 0) then
        call plan_reduced_solver(system%reduced_system, system%assembly%stiffness, system%base, model%mesh, error)
        call take_costs(system%reduced_system, estimate)
        return
      end if
      estimate%n_interface = n_interface_unknowns(system)
      estimate%contact_solver = merge(CONTACT_SKIN, CONTACT_DENSE, is_skin_chosen(system, step))
      if (estimate%contact_solver == CONTACT_SKIN) then
        call configure_bulk_solver(system%skin%robin, step)
        call plan_reduced_solver(system%skin%robin, system%assembly%stiffness, system%base, model%mesh, error)
        call take_costs(system%skin%robin, estimate)
        return
      end if
      call analyse_bulk(system%schur_interface, system%assembly%stiffness, system%base, system%is_interface_unknown, error)
      if (allocated(error)) return
      associate (factor => system%schur_interface%factor)
        estimate%cost%factor_megabytes = factor%megabytes
        estimate%cost%factor_entries = factor%n_entries
        estimate%cost%factor_operations = factor%n_operations
      end associate
    end associate
  end subroutine plan_solvers


  !> The costs of a reduced system and its choice.
  subroutine take_costs(reduced, estimate)
    type(reduced_system_type), intent(in) :: reduced
    type(job_estimate_type), intent(inout) :: estimate
    estimate%cost = reduced%cost
    estimate%is_iterative = reduced%is_iterative
    if (reduced%is_iterative) estimate%reason = reason_of_iteration(reduced)
  end subroutine take_costs


  !> Operations a second of a product of dense matrices on one thread: the best of some trials.
  real(DP) function dense_product_speed() result(speed)
    integer, parameter :: N = 384, N_TRIALS = 12
    real(DP), allocatable :: a(:, :), b(:, :), c(:, :)
    real(DP) :: start, now
    integer :: trial
    allocate (a(N, N), b(N, N), c(N, N), source=0.5_DP)
    speed = 0
    do trial = 1, N_TRIALS
      call cpu_time(start)
      call dgemm('N', 'N', N, N, N, 1.0_DP, a, N, b, N, 0.0_DP, c, N)
      call cpu_time(now)
      speed = max(speed, 2.0_DP * real(N, DP)**3 / max(now - start, 1.0e-6_DP))
    end do
  end function dense_product_speed


  !> The estimate in words, one line each.
  function describe_estimate(estimate, job) result(text)
    type(job_estimate_type), intent(in) :: estimate
    character(*), intent(in) :: job                !< its name
    character(:), allocatable :: text
    text = 'Estimate of ' // job // ', first step; processor seconds of one thread of this machine. Nothing is solved.' // &
      NEWLINE // entry('unknowns', to_text(estimate%n_unknowns) // ', of them ' // to_text(estimate%n_free) // ' free; ' // &
      plural(estimate%n_nodes, 'node') // ', ' // plural(estimate%n_elements, 'element'))
    text = text // NEWLINE // entry('contact', contact_words(estimate))
    if (estimate%cost%factor_operations > 0.0_DP) text = text // NEWLINE // entry('factor', factor_words(estimate))
    if (estimate%cost%iteration_operations > 0.0_DP) text = text // NEWLINE // entry('iteration', iteration_words(estimate))
    text = text // NEWLINE // entry('choice', choice_words(estimate)) // NEWLINE // &
      entry('memory', to_text(nint(chosen_megabytes(estimate))) // ' MB at the peak, ' // to_text(nint(estimate%megabytes)) // &
      ' of them taken so far') // NEWLINE // entry('preparation', seconds_text(estimate%preparation_seconds) // &
      ' s, taken: reading, checks, ordering') // NEWLINE // entry('elements', seconds_text(estimate%force_seconds) // &
      ' s, taken: forces and contact once; stiffness ' // seconds_text(estimate%tangent_seconds) // ' s') // NEWLINE // &
      entry('job', job_words(estimate))
    if (estimate%has_matrix .and. estimate%n_free > 0 .and. estimate%contact_solver /= CONTACT_GRADIENTS) &
      text = text // NEWLINE // entry('ranks', ranks_words(estimate))
  end function describe_estimate


  !> A line: name and words.
  pure function entry(name, words) result(line)
    character(*), intent(in) :: name, words
    character(:), allocatable :: line
    character(14) :: column
    column = name
    line = '  ' // column // words
  end function entry


  !> The contact interface and its solver.
  function contact_words(estimate) result(words)
    type(job_estimate_type), intent(in) :: estimate
    character(:), allocatable :: words
    if (estimate%n_slaves == 0) then
      words = 'none'
      return
    end if
    words = plural(estimate%n_slaves, 'slave node')
    select case (estimate%contact_solver)
    case (CONTACT_DENSE)
      words = words // ', interface of ' // to_text(estimate%n_interface) // ' unknowns at the start, dense: ' // &
        to_text(nint(dense_megabytes(estimate))) // ' MB and some ' // &
        seconds_text(2.0_DP / 3.0_DP * real(estimate%n_interface, DP)**3 / estimate%speed) // ' s a round'
    case (CONTACT_SKIN)
      words = words // ', interface of ' // to_text(estimate%n_interface) // ' unknowns at the start, by the contact skin'
    case default
      words = words // ', in rounds of conjugate gradients'
    end select
  end function contact_words


  !> Time and memory of the factor.
  function factor_words(estimate) result(words)
    type(job_estimate_type), intent(in) :: estimate
    character(:), allocatable :: words
    associate (cost => estimate%cost)
      words = seconds_text(factor_seconds(estimate)) // ' s, ' // to_text(nint(cost%factor_megabytes)) // ' MB, a solve ' // &
        seconds_text(solve_seconds(estimate)) // ' s'
      if (cost%is_estimated) words = 'some ' // words // ' (by the last separator: it is much more than the iteration)'
    end associate
  end function factor_words


  !> Time and memory of the iteration.
  function iteration_words(estimate) result(words)
    type(job_estimate_type), intent(in) :: estimate
    character(:), allocatable :: words
    associate (cost => estimate%cost)
      words = seconds_text(ITERATION_PRODUCTS * estimate%product_seconds) // ' s each, its preconditioner ' // &
        seconds_text(preconditioner_seconds(estimate)) // ' s, ' // to_text(nint(cost%iteration_megabytes)) // ' MB; some ' // &
        to_text(n_iterations(estimate)) // ' in a compact body, up to four times as many in a slender or nearly incompressible one'
    end associate
  end function iteration_words


  !> The solver that the job will take and the reason.
  function choice_words(estimate) result(words)
    type(job_estimate_type), intent(in) :: estimate
    character(:), allocatable :: words
    if (estimate%contact_solver == CONTACT_GRADIENTS) then
      words = 'conjugate gradients, as SOLVER requests; their number of iterations is not known in advance'
    else if (estimate%n_free == 0) then
      words = 'none: all unknowns are prescribed'
    else if (estimate%is_iterative) then
      words = 'iteration, ' // estimate%reason
    else if (estimate%contact_solver == CONTACT_DENSE) then
      words = 'factor of the bulk with the interface last, which serves all rounds of contact'
    else if (estimate%contact_solver == CONTACT_SKIN) then
      words = 'factor of the bulk, which fits into memory and serves many Krylov iterations'
    else if (estimate%expected_iterations * estimate%cost%iteration_operations > estimate%cost%factor_operations) then
      words = 'factor: it fits into memory and takes less time'
    else
      words = 'factor: it fits into memory and ' // merge('serves many increments      ', 'the equations are few enough', &
        estimate%is_linear .and. estimate%n_increments > 1)
    end if
    words = trim(words)
  end function choice_words


  !> What the job takes: a linear one altogether, another a Newton iteration.
  function job_words(estimate) result(words)
    type(job_estimate_type), intent(in) :: estimate
    character(:), allocatable :: words
    if (estimate%is_linear .and. estimate%has_matrix) then
      words = 'some ' // seconds_text(linear_job_seconds(estimate)) // ' s and the result files: ' // &
        plural(estimate%n_increments, 'increment') // ', linear'
    else if (estimate%contact_solver == CONTACT_GRADIENTS) then
      words = 'as many evaluations of the forces as it has iterations'
    else
      words = 'some ' // seconds_text(newton_seconds(estimate)) // ' s a Newton iteration with a new factor or preconditioner, ' &
        // to_text(estimate%n_increments) // merge(' increment ', ' increments', estimate%n_increments == 1) // &
        ' as long as the first; rounds of contact come on top'
    end if
  end function job_words


  !> Time and memory of each of several ranks, as long as each has its own factor or they share the iteration.
  function ranks_words(estimate) result(words)
    type(job_estimate_type), intent(in) :: estimate
    character(:), allocatable :: words
    integer :: k
    words = 'for such a Newton iteration:'
    if (estimate%is_linear) words = 'for the job:'
    do k = 1, size(RANKS)
      if (RANKS(k) >= estimate%min_ranks_shared .and. .not. estimate%is_iterative) then
        words = words // ' from ' // to_text(estimate%min_ranks_shared) // ' ranks on MUMPS may share the factor.'
        return
      end if
      words = words // ' ' // to_text(RANKS(k)) // ' take some ' // seconds_text(seconds_of_ranks(estimate, RANKS(k))) // &
        ' s and ' // to_text(nint(megabytes_of_rank(estimate, RANKS(k)))) // ' MB each' // merge('.', ';', k == size(RANKS))
    end do
  end function ranks_words


  !> Whether the ranks divide the iteration and what it needs.
  pure logical function is_divided(estimate)
    type(job_estimate_type), intent(in) :: estimate
    is_divided = estimate%is_iterative .and. estimate%contact_solver == CONTACT_NONE
  end function is_divided


  !> Seconds of a linear job without its files, or of a Newton iteration, on ranks that have a core each.
  pure real(DP) function seconds_of_ranks(estimate, n_ranks) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    integer, intent(in) :: n_ranks
    real(DP) :: repeated, divided
    if (estimate%is_linear) then
      seconds = linear_job_seconds(estimate)
      repeated = estimate%preparation_seconds
    else
      seconds = newton_seconds(estimate)
      repeated = 0
    end if
    if (is_divided(estimate)) then
      repeated = repeated + REPEATED_PRECONDITIONER * preconditioner_seconds(estimate)
    else
      repeated = repeated + setup_seconds(estimate) + use_seconds(estimate) * &
        merge(real(estimate%n_increments, DP), 1.0_DP, estimate%is_linear)
    end if
    divided = (seconds - repeated) / real(n_ranks, DP)
    if (is_divided(estimate)) divided = (1.0_DP + halo_share(estimate, n_ranks)) * divided
    seconds = repeated + divided
  end function seconds_of_ranks


  !> Unknowns of other ranks that a rank needs, over its own: one layer of nodes on as many faces of a cube as others touch.
  pure real(DP) function halo_share(estimate, n_ranks) result(share)
    type(job_estimate_type), intent(in) :: estimate
    integer, intent(in) :: n_ranks
    share = RAGGED_BORDER * 6.0_DP * (1.0_DP - real(n_ranks, DP)**(-1.0_DP / 3.0_DP)) / &
      (real(estimate%n_nodes, DP) / real(n_ranks, DP))**(1.0_DP / 3.0_DP)
  end function halo_share


  !> Peak of memory of one of several ranks [megabytes]: the preparation without the stiffness, and the rank's part of stiffness, A,
  !! A on its domain and preconditioner.
  pure real(DP) function megabytes_of_rank(estimate, n_ranks) result(megabytes)
    type(job_estimate_type), intent(in) :: estimate
    integer, intent(in) :: n_ranks
    real(DP), parameter :: OF_VALUE = 8.0e-6_DP, OF_ENTRY = 12.0e-6_DP    ! a value; with its column [megabytes]
    megabytes = chosen_megabytes(estimate)
    if (is_divided(estimate)) megabytes = estimate%megabytes - OF_VALUE * estimate%n_entries + &
      (1.0_DP + halo_share(estimate, n_ranks)) / real(n_ranks, DP) * &
      (3.0_DP * OF_ENTRY * estimate%n_entries + estimate%cost%iteration_megabytes)
  end function megabytes_of_rank


  !> Processor seconds of a linear first step without its files.
  pure real(DP) function linear_job_seconds(estimate) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    seconds = estimate%preparation_seconds + estimate%tangent_seconds + setup_seconds(estimate) + &
      real(estimate%n_increments, DP) * (2.0_DP * estimate%force_seconds + use_seconds(estimate))
  end function linear_job_seconds


  !> Processor seconds of a Newton iteration with a new factor or preconditioner.
  pure real(DP) function newton_seconds(estimate) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    seconds = estimate%force_seconds + estimate%tangent_seconds + setup_seconds(estimate) + use_seconds(estimate)
  end function newton_seconds


  !> Peak of memory with the chosen solver [megabytes].
  pure real(DP) function chosen_megabytes(estimate) result(megabytes)
    type(job_estimate_type), intent(in) :: estimate
    megabytes = estimate%megabytes + dense_megabytes(estimate)
    if (estimate%is_iterative) then
      megabytes = megabytes + estimate%cost%iteration_megabytes
    else
      megabytes = megabytes + estimate%cost%factor_megabytes
    end if
  end function chosen_megabytes


  !> The factor L_cc, the condensed stiffness and the tangent of a dense interface [megabytes].
  pure real(DP) function dense_megabytes(estimate) result(megabytes)
    type(job_estimate_type), intent(in) :: estimate
    megabytes = 0
    if (estimate%contact_solver == CONTACT_DENSE) megabytes = 3.0_DP * 8.0e-6_DP * real(estimate%n_interface, DP)**2
  end function dense_megabytes


  !> The factorization [s].
  pure real(DP) function factor_seconds(estimate) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    seconds = estimate%cost%factor_operations / estimate%speed
  end function factor_seconds


  !> One solve with the factor [s].
  pure real(DP) function solve_seconds(estimate) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    seconds = estimate%operations_per_entry * estimate%cost%factor_entries / estimate%speed
  end function solve_seconds


  !> Iterations of one solution in a compact body.
  pure integer function n_iterations(estimate)
    type(job_estimate_type), intent(in) :: estimate
    n_iterations = merge(LINEAR_ITERATIONS, NEWTON_ITERATIONS, estimate%is_linear)
  end function n_iterations


  !> The preconditioner [s].
  pure real(DP) function preconditioner_seconds(estimate) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    seconds = PRECONDITIONER_PRODUCTS * estimate%product_seconds
  end function preconditioner_seconds


  !> Its iterations [s].
  pure real(DP) function iteration_seconds(estimate) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    seconds = real(n_iterations(estimate), DP) * ITERATION_PRODUCTS * estimate%product_seconds
  end function iteration_seconds


  !> The chosen factor or the preconditioner [s].
  pure real(DP) function setup_seconds(estimate) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    seconds = merge(preconditioner_seconds(estimate), factor_seconds(estimate), estimate%is_iterative)
  end function setup_seconds


  !> One solve with the chosen solver [s].
  pure real(DP) function use_seconds(estimate) result(seconds)
    type(job_estimate_type), intent(in) :: estimate
    seconds = merge(iteration_seconds(estimate), solve_seconds(estimate), estimate%is_iterative)
  end function use_seconds


  !> Seconds with one decimal place, or two below one.
  function seconds_text(seconds) result(text)
    real(DP), intent(in) :: seconds
    character(:), allocatable :: text
    character(24) :: buffer
    if (seconds < 1.0_DP) then
      write (buffer, '(f0.3)') seconds
      text = '0' // trim(buffer)
    else
      write (buffer, '(f0.1)') min(seconds, 1.0e15_DP)
      text = trim(buffer)
    end if
  end function seconds_text

end module amontons_job_estimate
