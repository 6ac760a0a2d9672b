!> Solution of the linearised equations: a direction by the present factor, exact tangent by a Krylov method, and along the path.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! J dv = C' R is solved by GMRES with A as the preconditioner, by conjugate gradients where J = A or A is not positive, or by
!! UMFPACK (doc/theory/solver.md). The symbols are those of newton_step.
module amontons_tangent_solution
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_steps, only: step_type, SOLVER_AUTO
  use amontons_state, only: state_type
  use amontons_sparse, only: sparse_type, multiply, multiply_transpose, sparse_product, sparse_transpose, &
    full_from_upper, sparse_sum
  use amontons_factorization, only: lu_type, lu_factorise, lu_solve, FACTOR_OK
  use amontons_reduced_system, only: apply_reduced_inverse, apply_deflated_inverse, iterate_reduced_system, &
    iterate_unsymmetric
  use amontons_contact_preconditioner, only: apply_bulk, apply_coarse_space, apply_tiles, subtract_contact
  use amontons_schur_interface, only: apply_schur_interface, is_factor_of, iterations_worth_factor
  use amontons_distributed_solver, only: DISTRIBUTED_TWO_LEVEL
  use amontons_krylov, only: operator_type, krylov_options_type, krylov_report_type, gmres, &
    conjugate_gradients, KRYLOV_CONVERGED, KRYLOV_STAGNATED
  use amontons_constraints, only: condense_forces, build_condensation_matrix
  use amontons_unsymmetric_tangent, only: subtract_skew_product, combine_with_skew, has_unsymmetric_law
  use amontons_contact_operators, only: apply_contact_tangent, assemble_contact_tangents
  use amontons_assembly_plan, only: multiply_stiffness, largest_stiffness
  use amontons_arc_length, only: close_arc
  use amontons_equilibrium, only: equilibrium_type, n_interface_unknowns, discard_bulk_factor, OUTCOME_OK, OUTCOME_LINEAR_SOLVER
  implicit none
  private
  public :: solve_constrained_system, follow_path, solve_roughly, apply_unconstrained_tangent, assemble_tangent_matrix
  public :: tangent_type, is_skin_cheaper

  real(DP), parameter :: TOL_BACKWARD_ERROR = 8.0_DP * epsilon(1.0_DP)   !< backward error at rounding level [-]

  !> J: the exact tangent as an operator on the free unknowns.
  type, extends(operator_type) :: tangent_type
    type(equilibrium_type), pointer :: system => null()
  contains
    procedure :: apply => apply_tangent
  end type tangent_type

  !> inv(A): the factor as an operator.
  type, extends(operator_type) :: preconditioner_type
    type(equilibrium_type), pointer :: system => null()
  contains
    procedure :: apply => apply_preconditioner
  end type preconditioner_type

contains

  !> Solves J dv = C' (R - (K - dF_c) c) and gives du = C dv + c.
  subroutine solve_constrained_system(system, allowed_residual, du, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: allowed_residual                  !< residual that is small enough [force]
    real(DP), intent(out) :: du(:, :)
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: b(:), v(:), start(:), flat(:)
    outcome = OUTCOME_OK
    allocate (b(system%constraints%n_free), v(system%constraints%n_free), start(system%constraints%n_unknowns), &
      flat(system%constraints%n_unknowns))
    v = 0.0_DP
    flat = system%constraints%offset
    call right_hand_side(system, flat, b)
    if (system%constraints%n_free > 0) then
      call run_krylov(system, allowed_residual, .true., b, v, outcome, error)
      if (allocated(error)) return
      call multiply(system%constraints%transformation, v, start)
      flat = flat + start
    end if
    du = reshape(flat, shape(du))
  end subroutine solve_constrained_system


  !> Path following: the direction by the residual and that by the reference load add up to one that ends on the arc.
  subroutine follow_path(system, step, state, du, d_load, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(inout) :: du(:, :)            !< (3, n_nodes) in: by the residual [length]
    real(DP), intent(out) :: d_load                !< [-]
    integer, intent(out) :: outcome                !< OUTCOME_OK or OUTCOME_LINEAR_SOLVER
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: b(:), v(:), du_load(:), free_part(:)
    d_load = 0.0_DP
    outcome = OUTCOME_OK
    associate (n => system%constraints%n_unknowns, n_free => system%constraints%n_free)
      allocate (b(n_free), v(n_free), free_part(n), du_load(n), source=0.0_DP)
      if (allocated(system%reference_offset)) du_load = system%reference_offset
      call reference_side(system, du_load, b)
      if (n_free > 0) then
        call run_krylov(system, 0.0_DP, .false., b, v, outcome, error)
        if (allocated(error) .or. outcome /= OUTCOME_OK) return
        call multiply(system%constraints%transformation, v, free_part)
        du_load = du_load + free_part
      end if
    end associate
    call close_arc(state, state%new%time_increment / step%period, system%rotation_length, reshape(du_load, shape(du)), du, d_load)
    if (.not. (abs(d_load) <= huge(1.0_DP) .and. state%new%arc_scale > 0.0_DP)) outcome = OUTCOME_LINEAR_SOLVER
  end subroutine follow_path


  !> b = C' (F + dF_c(F) - (K - dF_c) c) for the reference load F and the change c of the supports with it.
  subroutine reference_side(system, offset, b)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: offset(:)              !< c (n_unknowns) [length]
    real(DP), intent(out) :: b(:)                  !< (n_free) [force]
    real(DP), allocatable :: w(:), condensed(:, :), d_force(:, :), zero(:, :)
    allocate (w(size(offset)), source=0.0_DP)
    allocate (condensed(3, size(offset) / 3), d_force(3, size(offset) / 3))
    if (any(offset /= 0.0_DP)) call apply_unconstrained_tangent(system, offset, w)
    call condense_forces(system%base, system%reference_force, condensed)
    w = reshape(condensed, shape(w)) - w
    if (size(system%contact_tangents) > 0) then
      allocate (zero(3, size(offset) / 3), source=0.0_DP)
      call apply_contact_tangent(system%contact_tangents, system%contact%force_condensation, zero, condensed, d_force)
      w = w + reshape(d_force, shape(w))
    end if
    call multiply_transpose(system%constraints%transformation, w, b)
  end subroutine reference_side


  !> Solves J v = b by conjugate gradients where J = A and A is not factorised, else by GMRES. After: OUTCOME_LINEAR_SOLVER and no
  !! factor of the bulk if may_renew and the present one, of other equations, costs more than a new one.
  subroutine run_krylov(system, allowed_residual, may_renew, b, v, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: allowed_residual                  !< residual that is small enough [force]
    logical, intent(in) :: may_renew               !< the caller repeats the direction where the interface was discarded
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(tangent_type) :: tangent
    type(preconditioner_type) :: preconditioner
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    logical :: is_iterative, is_symmetric
    logical :: is_outdated                         ! the factor is of an earlier bulk
    logical :: is_renewable                        ! and of other equations, so that a new one is a much better preconditioner
    logical :: is_divided                          ! vectors of GMRES, over the ranks
    outcome = OUTCOME_OK
    is_iterative = system%reduced_system%is_iterative .and. .not. system%has_interface_solver
    if (system%is_skin) then
      call solve_by_skin(system, allowed_residual, b, v, outcome, error)
      return
    end if
    if (system%is_indefinite) then
      call solve_by_umfpack(system, b, v, outcome, error)
      return
    end if
    tangent%system => system
    preconditioner%system => system
    options%tolerance = system%controls%krylov%tolerance
    options%absolute_tolerance = allowed_residual
    options%max_iterations = merge(system%reduced_system%max_iterations, system%controls%krylov%max_iterations, is_iterative)
    if (is_iterative) options%tolerance = system%controls%krylov%iterative_tolerance
    if (has_unsymmetric_law(system%assembly%skew) .and. .not. is_iterative) &
      options%max_iterations = system%controls%krylov%max_unsymmetric_iterations
    if (system%max_old_iterations > 0) options%max_iterations = system%max_old_iterations
    is_outdated = system%has_interface_solver .and. .not. system%is_bulk_factor_current
    is_renewable = is_outdated .and. may_renew
    if (is_renewable) is_renewable = .not. is_factor_of(system%schur_interface, system%base)
    if (is_renewable) options%max_iterations = min(options%max_iterations, max( &
      system%controls%krylov%max_stale_iterations, iterations_worth_factor(system%schur_interface, system%controls%linear_solver)))
    if (is_iterative .and. size(system%contact_tangents) == 0 .and. .not. system%is_constant) then
      options%energy_tolerance = min(system%forcing_term, system%controls%linear_solver%energy_tolerance)
    else if (system%max_old_iterations > 0) then
      options%tolerance = min(system%forcing_term, system%controls%linear_solver%old_factor_tolerance)
    end if
    if (system%seeks_descent .and. size(system%contact_tangents) == 0 .and. system%reduced_system%n_shifted > 0 .and. &
      .not. is_iterative) then
      call solve_for_descent(system, options, b, v, error)
      return
    end if
    system%schur_interface%allowed_residual = max(options%tolerance, allowed_residual / max(norm2(b), tiny(allowed_residual)))
    is_symmetric = size(system%contact_tangents) == 0 .and. .not. allocated(system%assembly%skew%matrix%first)
    is_divided = is_iterative .and. size(system%contact_tangents) == 0 .and. &
      system%reduced_system%distributed_kind == DISTRIBUTED_TWO_LEVEL
    if (is_iterative .and. is_symmetric) then
      call iterate_reduced_system(system%reduced_system, b, v, options, report, error)
      if (allocated(error)) return
    else if (is_divided) then
      call iterate_unsymmetric(system%reduced_system, system%assembly%skew%matrix, system%constraints, b, v, options, report, error)
      if (allocated(error)) return
    else if (system%max_old_iterations > 0 .and. is_symmetric) then
      call conjugate_gradients(tangent, preconditioner, b, v, options, report)
    else
      call gmres(tangent, preconditioner, b, v, options, report, error)
      if (allocated(error)) return
    end if
    system%n_krylov = system%n_krylov + report%n_iterations
    if (system%reduced_system%is_current) system%reduced_system%n_new_iterations = report%n_iterations
    if (is_outdated .and. (report%n_iterations > system%controls%krylov%max_stale_iterations .or. &
      (is_renewable .and. report%status /= KRYLOV_CONVERGED))) call discard_bulk_factor(system)
    if (report%status == KRYLOV_CONVERGED) return
    if (system%max_old_iterations > 0 .or. is_renewable) outcome = OUTCOME_LINEAR_SOLVER
    if (outcome /= OUTCOME_OK) return
    if (report%status == KRYLOV_STAGNATED) then
      if (is_at_rounding_level(system, report%residual * norm2(b), v)) return
    end if
    if (is_iterative .and. report%residual <= system%controls%krylov%tolerance) return   ! at rounding level for a slender body
    if (is_iterative) outcome = OUTCOME_LINEAR_SOLVER
    if (.not. is_iterative) call solve_by_umfpack(system, b, v, outcome, error)
  end subroutine run_krylov


  !> A direction that descends where A is not positive: conjugate gradients on A with the shifted factor as preconditioner, as far
  !! as they meet positive curvature; if the first direction has none, that direction. Where A is singular only, they converge.
  !! Source: T. Steihaug, SIAM J. Numer. Anal. 20 (1983) 626.
  subroutine solve_for_descent(system, options, b, v, error)
    type(equilibrium_type), intent(inout) :: system
    type(krylov_options_type), intent(in) :: options
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) in: 0 [length]
    type(error_type), allocatable, intent(out) :: error
    type(krylov_report_type) :: report
    call iterate_reduced_system(system%reduced_system, b, v, options, report, error)
    if (allocated(error)) return
    system%n_krylov = system%n_krylov + report%n_iterations
    if (all(v == 0.0_DP)) call apply_reduced_inverse(system%reduced_system, b, v)
  end subroutine solve_for_descent


  !> Solves J v = b with the contact skin. The linearised model includes the remaining residual, and the next correction reduces it.
  !! What remains on a free body in a proximal step moves it by the residual over the shift: it must be small beside the loads too,
  !! not only beside the forces that close the gaps.
  subroutine solve_by_skin(system, allowed_residual, b, v, outcome, error)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: allowed_residual                  !< residual that is small enough [force]
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(tangent_type) :: tangent
    type(preconditioner_type) :: preconditioner
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    outcome = OUTCOME_OK
    tangent%system => system
    preconditioner%system => system
    options%tolerance = system%skin_tolerance
    if (system%proximal_shift > 0.0_DP .and. norm2(b) > system%largest_force) options%tolerance = options%tolerance * &
      system%largest_force / norm2(b)
    options%absolute_tolerance = allowed_residual
    options%max_iterations = system%controls%skin%max_iterations
    options%restart = system%controls%skin%restart
    call gmres(tangent, preconditioner, b, v, options, report, error)
    if (allocated(error)) return
    system%n_krylov = system%n_krylov + report%n_iterations
    if (report%status /= KRYLOV_CONVERGED .and. report%residual > system%controls%skin%max_residual) outcome = OUTCOME_LINEAR_SOLVER
    call check_skin_convergence(system, report, outcome)
  end subroutine solve_by_skin


  !> After slow solves, or where no direction was found, the step continues with the dense interface if that is allowed and cheaper;
  !! else the bulk solver is recomputed, and two levels that stay slow give way to a factor.
  subroutine check_skin_convergence(system, report, outcome)
    type(equilibrium_type), intent(inout) :: system
    type(krylov_report_type), intent(in) :: report !< of a direction
    integer, intent(in) :: outcome                 !< OUTCOME_LINEAR_SOLVER: no direction was found
    real(DP) :: n_iterations, digits, slow_iterations
    logical :: is_lost, is_slow_again, is_replaced
    is_lost = outcome /= OUTCOME_OK
    n_iterations = real(report%n_iterations, DP)
    digits = -log10(max(report%residual, tiny(1.0_DP)))
    associate (memory => system%skin%memory)
      slow_iterations = system%controls%skin%slow_iterations * max(2.0_DP, digits)
      if (system%skin%robin%is_iterative) slow_iterations = slow_iterations * system%controls%skin%two_level_ratio
      if (n_iterations > slow_iterations) memory%n_slow = memory%n_slow + 1
      if (memory%n_slow <= memory%slow_limit .and. .not. is_lost) return
      is_slow_again = memory%slow_limit > system%controls%skin%max_slow_solves
      if (system%skin%robin%is_iterative) then
        if (.not. system%skin%robin%cost%is_factor_too_large) memory%is_factor_needed = is_lost .or. &
          (is_slow_again .and. system%skin%robin%requested_solver == SOLVER_AUTO)
      else
        memory%is_abandoned = n_interface_unknowns(system) <= system%controls%contact_interface%max_unknowns .and. &
          (is_lost .or. .not. is_skin_cheaper(system, n_iterations))
      end if
      is_replaced = memory%is_abandoned .or. (system%skin%robin%is_iterative .and. memory%is_factor_needed)
      if (is_replaced) call describe_replacement(is_lost, memory%is_abandoned, system%skin%message)
      if (is_lost .and. .not. is_replaced) return
      memory%is_outdated = .not. (system%is_constant .or. memory%is_abandoned .or. is_lost)
      if (.not. memory%is_outdated) call discard_bulk_factor(system)
      memory%n_slow = 0
      memory%slow_limit = 2 * memory%slow_limit        ! recompute it later next time
      if (is_replaced) memory%slow_limit = system%controls%skin%max_slow_solves
    end associate
  end subroutine check_skin_convergence


  !> What serves the rest of the step in place of the contact skin or of its bulk solver.
  pure subroutine describe_replacement(is_lost, is_dense, message)
    logical, intent(in) :: is_lost                 !< no direction was found
    logical, intent(in) :: is_dense                !< the dense interface serves, else a factor of the bulk
    character(:), allocatable, intent(out) :: message
    message = 'The contact skin converges slowly; in this step '
    if (is_lost) message = 'No direction was found with the contact skin; in this step '
    if (is_dense) then
      message = message // 'the dense interface replaces it.'
    else
      message = message // 'a factor of the bulk replaces the iteration.'
    end if
  end subroutine describe_replacement


  !> v ~ inv(J) b with the present factor. Cost: one solution; with the skin the Krylov iterations for one digit.
  subroutine solve_roughly(system, b, v)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(out) :: v(:)                  !< (n_free) [length]
    type(preconditioner_type) :: preconditioner
    type(error_type), allocatable :: error         ! out of memory: v keeps the initial guess
    integer :: outcome
    preconditioner%system => system
    v = 0.0_DP
    if (system%is_skin) then
      system%skin_tolerance = system%controls%skin%tolerance_length
      call solve_by_skin(system, 0.0_DP, b, v, outcome, error)
    else
      call preconditioner%apply(b, v)
    end if
  end subroutine solve_roughly


  !> Whether the residual of a direction is at rounding level of the product of stiffness and direction (backward error), as with
  !! large displacements of weakly supported bodies. No factorisation would give a better direction (N. J. Higham, Accuracy and
  !! Stability of Numerical Algorithms, 2nd ed., SIAM 2002, section 7.1).
  logical function is_at_rounding_level(system, residual, v)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: residual               !< norm of the residual [force]
    real(DP), intent(in) :: v(:)                   !< (n_free) [length]
    is_at_rounding_level = residual <= TOL_BACKWARD_ERROR * largest_stiffness(system%assembly) * norm2(v)
  end function is_at_rounding_level


  !> The fall-back when GMRES does not converge: J as a matrix, factorised by UMFPACK with pivoting. On a path beyond a limit point,
  !! where A is not positive, the factor serves all solutions of a direction.
  subroutine solve_by_umfpack(system, b, v, outcome, error)
    type(equilibrium_type), intent(inout) :: system
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: outcome
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: J
    integer :: status
    outcome = OUTCOME_OK
    status = FACTOR_OK
    if (.not. (system%is_indefinite .and. system%indefinite_factor%is_ready)) then
      call assemble_tangent_matrix(system, J, error)
      if (allocated(error)) return
      call lu_factorise(system%indefinite_factor, J, status, error)
      if (allocated(error)) return
      system%n_factorisations = system%n_factorisations + 1
      system%n_umfpack = system%n_umfpack + 1
    end if
    if (status == FACTOR_OK) call lu_solve(system%indefinite_factor, b, v)
    if (status /= FACTOR_OK .or. .not. all(abs(v) <= huge(1.0_DP))) outcome = OUTCOME_LINEAR_SOLVER
    if (.not. system%is_indefinite) system%indefinite_factor = lu_type()   ! its memory
  end subroutine solve_by_umfpack


  !> J = C' (K + D_R E K - D_u) C, with dF_c = D_R dRhat + D_u du and dRhat = -E K du.
  subroutine assemble_tangent_matrix(system, J, error)
    type(equilibrium_type), intent(in) :: system
    type(sparse_type), intent(out) :: J            !< (n_free x n_free)
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: K, E, imbalance_tangent, displacement_tangent
    K = combine_with_skew(full_from_upper(system%assembly%stiffness), system%assembly%skew)
    call build_condensation_matrix(system%base, E, error)
    if (allocated(error)) return
    call assemble_contact_tangents(system%contact_tangents, system%contact%force_condensation, system%constraints%n_unknowns, &
      imbalance_tangent, displacement_tangent)
    K = sparse_sum(K, 1.0_DP, sparse_product(imbalance_tangent, sparse_product(E, K)))
    K = sparse_sum(K, -1.0_DP, displacement_tangent)
    J = sparse_product(sparse_transpose(system%constraints%transformation), sparse_product(K, system%constraints%transformation))
  end subroutine assemble_tangent_matrix


  !> b = C' (R + F_a - K c + dF_c(c)), with F_a the force of the linearised compliant laws at the present gaps less that in R.
  subroutine right_hand_side(system, offset, b)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: offset(:)              !< c [length]
    real(DP), intent(out) :: b(:)
    real(DP), allocatable :: change(:)
    allocate (change(size(offset)))
    change = 0.0_DP
    if (any(offset /= 0.0_DP)) call apply_unconstrained_tangent(system, offset, change)
    call multiply_transpose(system%constraints%transformation, reshape(system%residual_at_gap, shape(change)) - change, b)
  end subroutine right_hand_side


  !> w = (K - dF_c) du over all unknowns: minus the change of the residual.
  subroutine apply_unconstrained_tangent(system, flat, w)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: flat(:)                !< du (n_unknowns) [length]
    real(DP), intent(out) :: w(:)                  !< (n_unknowns) [force]
    real(DP), allocatable :: du(:, :), d_imbalance(:, :), d_force(:, :)
    call multiply_stiffness(system%assembly, flat, w)
    call subtract_skew_product(system%assembly%skew, flat, w)
    if (size(system%contact_tangents) == 0) return
    allocate (d_imbalance(3, size(flat) / 3), d_force(3, size(flat) / 3))
    du = reshape(flat, [3, size(flat) / 3])
    call condense_forces(system%base, reshape(-w, shape(du)), d_imbalance)
    if (system%is_skin) then
      call subtract_contact(system%skin, flat, reshape(d_imbalance, shape(w)), w)
      return
    end if
    call apply_contact_tangent(system%contact_tangents, system%contact%force_condensation, du, d_imbalance, d_force)
    w = w - reshape(d_force, shape(w))
  end subroutine apply_unconstrained_tangent


  !> y = J x.
  subroutine apply_tangent(self, x, y)
    class(tangent_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [length]
    real(DP), intent(out) :: y(:)                  !< (n_free) [force]
    real(DP), allocatable :: flat(:), w(:)
    allocate (flat(self%system%constraints%n_unknowns), w(self%system%constraints%n_unknowns))
    call multiply(self%system%constraints%transformation, x, flat)
    call apply_unconstrained_tangent(self%system, flat, w)
    call multiply_transpose(self%system%constraints%transformation, w, y)
  end subroutine apply_tangent


  !> y = inv(A) x.
  subroutine apply_preconditioner(self, x, y)
    class(preconditioner_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    if (self%system%is_skin) then
      call apply_skin_preconditioner(self%system, x, y)
    else if (self%system%has_interface_solver) then
      call apply_schur_interface(self%system%schur_interface, x, y)
    else
      call apply_deflated_inverse(self%system%reduced_system, x, y)
    end if
  end subroutine apply_preconditioner


  !> y ~ inv(J) x by the bulk solver, then by the coarse space and the tiles.
  subroutine apply_skin_preconditioner(system, x, y)
    type(equilibrium_type), intent(inout), target :: system
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    type(tangent_type) :: tangent
    real(DP), allocatable :: rest(:)
    tangent%system => system
    allocate (rest(size(x)))
    call apply_bulk(system%skin, x, y)
    call tangent%apply(y, rest)
    rest = x - rest
    call apply_coarse_space(system%skin, rest, y)
    call apply_tiles(system%skin, rest, y)
  end subroutine apply_skin_preconditioner


  !> Whether a round with so many Krylov iterations on the skin costs less than one on the dense interface.
  pure logical function is_skin_cheaper(system, n_iterations)
    type(equilibrium_type), intent(in) :: system
    real(DP), intent(in) :: n_iterations
    associate (limits => system%controls%contact_interface)
      is_skin_cheaper = limits%dense_work_ratio * real(n_interface_unknowns(system), DP)**3 * limits%usual_skin_iterations > &
        n_iterations * real(system%base%n_free, DP)
    end associate
  end function is_skin_cheaper

end module amontons_tangent_solution
