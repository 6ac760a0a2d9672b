!> Direction: the Newton direction from where the system was last evaluated: linearised, factorised, solved.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!!     K      stiffness of the elements and loads, symmetric; what the tangent has beside it is in assembly%skew
!!     C, c   du = C dv + c: boundary conditions, equations, followers, contact rows     (constraints)
!!     A      C' K C, factorised by Cholesky                                             (reduced, condensed)
!!     J      C' (K - d F_c) C, with the exact change of the contact forces, unsymmetric (contact_tangent)
!!
!! J dv = C' R is solved by GMRES with A as the preconditioner (doc/theory/solver.md).
module amontons_newton_step
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type
  use amontons_model, only: model_type, n_bonds
  use amontons_steps, only: step_type, DIRECTION_SYMMETRIC, DIRECTION_LAGGED
  use amontons_iteration_records, only: PHASE_ASSEMBLY, PHASE_CONTACT, PHASE_FACTOR, PHASE_KRYLOV
  use amontons_state, only: state_type, fields_type, DAMPING_NOW
  use amontons_sparse, only: sparse_type, multiply, multiply_transpose, multiply_symmetric, product_of, transpose_of, &
    full_of, sum_of
  use amontons_factorization, only: lu_type, lu_factorise, lu_solve, FACTOR_OK
  use amontons_reduced_system, only: factorise_reduced, apply_reduced, give_up_iterative
  use amontons_woodbury_interface, only: springs_type
  use amontons_schur_interface, only: is_analysed_for, analyse_bulk, factorise_bulk, factorise_interface, factorise_springs, &
    apply_condensed
  use amontons_krylov, only: operator_type, matrix_operator_type, krylov_options_type, krylov_report_type, gmres, &
    conjugate_gradients, KRYLOV_CONVERGED, KRYLOV_STAGNATED
  use amontons_constraints, only: finish_constraints, scale_offsets, condense_forces, condensation
  use amontons_nonlinear_mpc, only: add_curvatures
  use amontons_stabilization, only: brake, stiffen
  use amontons_unsymmetric_tangent, only: finish_skew, subtract_skew, with_skew
  use amontons_assembly, only: assemble_tangent
  use amontons_external_loads, only: assemble_loads
  use amontons_contact_linearization, only: linearise_contact, keep_symmetric, add_contact_rows
  use amontons_contact_operators, only: apply_contact_tangent, contact_matrices, contact_springs, spring_factors
  use amontons_equilibrium, only: system_type, prescribe, forget_bulk, interface_unknowns, start_clock, stop_clock, TROUBLE_NONE, &
    TROUBLE_ELEMENT, TROUBLE_SOLVER
  implicit none
  private
  public :: find_direction, correct_direction, linearise, carry_bodies, change_forces, tangent_matrix

  real(DP), parameter :: KRYLOV_TOLERANCE = 1.0e-9_DP    !< of a direction, relative to the right-hand side [-]
  real(DP), parameter :: KRYLOV_SHARE = 1.0e-3_DP        !< of the residual that Newton allows: what a direction may leave [-]
  integer, parameter :: KRYLOV_MOST = 200                !< Krylov iterations of one direction
  real(DP), parameter :: ITERATIVE_TOLERANCE = 1.0e-11_DP   !< of a direction without a factor: its error is seen less well [-]
  real(DP), parameter :: ROUNDED = 8.0_DP * epsilon(1.0_DP)   !< of stiffness times direction: what rounding leaves of it [-]
  integer, parameter :: MOST_OLD = 8                     !< Krylov iterations after which an old factor of the bulk is given up
  integer, parameter :: MOST_UNSTABLE = 3                !< such factorisations after which an attempt goes on without the interface
  integer, parameter :: MOST_INTERFACE = 6000            !< largest interface [unknowns]

  !> J: the exact tangent as an operator on the free unknowns.
  type, extends(operator_type) :: tangent_type
    type(system_type), pointer :: system => null()
  contains
    procedure :: apply => apply_tangent
  end type tangent_type

  !> inv(A): the factor as an operator.
  type, extends(operator_type) :: preconditioner_type
    type(system_type), pointer :: system => null()
  contains
    procedure :: apply => apply_preconditioner
  end type preconditioner_type

contains

  !> The Newton direction du at the configuration of the last evaluation.
  subroutine find_direction(system, model, step, state, du, trouble, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error   !< out of memory and the like
    integer(I64) :: clock
    call linearise(system, model, step, state, trouble, error)
    if (allocated(error) .or. trouble /= TROUBLE_NONE) return
    call start_clock(system, clock)
    call factorise_condensed(system, model, step, state, error)
    if (allocated(error)) return
    if (system%is_unheld) trouble = TROUBLE_SOLVER
    if (.not. (system%is_condensed .or. system%is_unheld)) call factorise_whole(system, model, trouble, error)
    if (allocated(error) .or. trouble /= TROUBLE_NONE) return
    call stop_clock(system, clock, PHASE_FACTOR)
    system%n_before = system%n_factorisations
    system%is_settled = .false.
    call solve_direction(system, floor_of(system, step), du, trouble, error)
    if (trouble == TROUBLE_SOLVER .and. .not. system%is_condensed .and. system%reduced%is_iterative) then
      call give_up_iterative(system%reduced)
      call factorise_whole(system, model, trouble, error)
      if (allocated(error) .or. trouble /= TROUBLE_NONE) return
      call solve_direction(system, floor_of(system, step), du, trouble, error)
    end if
    call stop_clock(system, clock, PHASE_KRYLOV)
  end subroutine find_direction


  !> The direction from a place that was foreseen, with the tangent of the bulk as it is.
  subroutine correct_direction(system, model, step, state, share, du, trouble, error)
    type(system_type), intent(inout), target :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    real(DP), intent(in) :: share                  !< of what is missing to the prescribed displacements that it is to go [-]
    real(DP), intent(out) :: du(:, :)              !< (3, n_nodes) [length]
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    integer(I64) :: clock
    call start_clock(system, clock)
    trouble = TROUBLE_SOLVER
    call constrain(system, model, step, state%old, state%new, share, error)
    if (allocated(error)) return
    call stop_clock(system, clock, PHASE_CONTACT)
    call factorise_condensed(system, model, step, state, error)
    if (allocated(error) .or. .not. system%is_condensed) return
    call stop_clock(system, clock, PHASE_FACTOR)
    call solve_direction(system, KRYLOV_SHARE * step%controls%r_n * system%largest_force, du, trouble, error)
    call stop_clock(system, clock, PHASE_KRYLOV)
  end subroutine correct_direction


  !> The residual that a direction may leave, where another Newton iteration follows and work can be saved.
  pure real(DP) function floor_of(system, step) result(floor)
    type(system_type), intent(in) :: system
    type(step_type), intent(in) :: step
    floor = 0
    if (system%is_condensed .or. (system%reduced%is_iterative .and. .not. system%is_constant)) &
      floor = KRYLOV_SHARE * step%controls%r_n * system%largest_force
  end function floor_of


  !> K, the linearised contact forces, and C with c, at the configuration of the last evaluation.
  subroutine linearise(system, model, step, state, trouble, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state
    integer, intent(out) :: trouble                !< TROUBLE_...
    type(error_type), allocatable, intent(out) :: error
    integer :: failed
    integer(I64) :: clock
    trouble = TROUBLE_NONE
    call start_clock(system, clock)
    if (.not. system%is_assembled) then
      system%reduced%is_current = .false.
      call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
      trouble = merge(TROUBLE_NONE, TROUBLE_ELEMENT, failed == 0)
      if (failed /= 0) return
      call assemble_loads(system%assembly, model, step, state%new, step%is_nlgeom, .true.)
      if (state%new%damping(DAMPING_NOW) > 0.0_DP) call brake(system%share, state)
      call finish_skew(system%assembly%skew, 3 * model%mesh%n_nodes, error)
      if (allocated(error)) return
      if (state%new%damping(DAMPING_NOW) > 0.0_DP) call stiffen(system%share, state, system%assembly%stiffness)
      system%is_assembled = system%is_constant .or. step%direction == DIRECTION_LAGGED
      system%is_bulk_new = system%is_constant .and. system%condensed%is_ready
      call add_carry(system)
      if (step%is_nlgeom .and. n_bonds(model) > 0) call add_curvatures(system%base, system%assembly, model, state%new)
    end if
    call scale_slaves(system, state%new)
    call stop_clock(system, clock, PHASE_ASSEMBLY)
    call constrain(system, model, step, state%old, state%new, 1.0_DP, error)
    call stop_clock(system, clock, PHASE_CONTACT)
  end subroutine linearise


  !> The scale c of the trial traction: the mean of the node's own stiffness, a diagonal block of K.
  subroutine scale_slaves(system, fields)
    type(system_type), intent(in) :: system
    type(fields_type), intent(inout) :: fields
    integer :: s, i
    do s = 1, size(fields%slaves)
      i = 3 * (fields%slaves(s)%node - 1)
      associate (K => system%assembly%stiffness)
        fields%slaves(s)%stiffness = (K%value(K%first(i + 1)) + K%value(K%first(i + 2)) + K%value(K%first(i + 3))) / 3.0_DP
      end associate
    end do
  end subroutine scale_slaves


  !> C and c of all constraints, contact rows included.
  subroutine constrain(system, model, step, old, fields, share, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(fields_type), intent(in) :: old           !< committed
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: share                  !< of what is missing to the prescribed displacements that c is to go [-]
    type(error_type), allocatable, intent(out) :: error
    call prescribe(system, model, step, fields, error)
    if (allocated(error)) return
    if (share < 1.0_DP) call scale_offsets(system%base, share)
    call linearise_contact(system%contact, model, old, fields, system%links)
    if (step%direction == DIRECTION_SYMMETRIC) call keep_symmetric(system%links)
    system%whole = system%base
    call add_contact_rows(system%contact, model, fields, system%links, system%whole, system%n_conflicts)
    call finish_constraints(system%whole)
  end subroutine constrain


  !> From now on K has so much more of its own diagonal; 0: as it is.
  subroutine carry_bodies(system, model, fields, part)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields
    real(DP), intent(in) :: part                   !< [-]
    logical, allocatable :: is_reached(:)
    system%carry = part
    if (part > 0.0_DP) then                        ! contact anywhere is what they are carried to
      is_reached = interface_unknowns(system, model, fields, .true.)
      if (any(is_reached .and. .not. system%is_contact)) system%condensed%is_analysed = .false.
      system%is_contact = system%is_contact .or. is_reached
    end if
    system%is_assembled = .false.
    system%is_dense_wanted = .true.
    call forget_bulk(system)
  end subroutine carry_bodies


  !> K with a part of its own diagonal.
  subroutine add_carry(system)
    type(system_type), intent(inout) :: system
    integer :: i, j
    real(DP) :: own                                ! [force/length]
    if (system%carry <= 0.0_DP) return
    associate (K => system%assembly%stiffness)
      do i = 1, K%n_rows, 3                        ! a node's own stiffness in the mean, so that axes do not matter
        own = sum(K%value(K%first(i:i + 2))) / 3.0_DP
        do j = i, i + 2
          K%value(K%first(j)) = K%value(K%first(j)) + system%carry * own
        end do
      end do
    end associate
  end subroutine add_carry


  !> Contact by the condensed interface: the bulk is factorised if its factor is gone, the interface always.
  !! After: is_condensed is .false. where the interface is too large or the bulk is not stable, and where is_unheld.
  subroutine factorise_condensed(system, model, step, state, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< not changed
    type(error_type), allocatable, intent(out) :: error
    logical :: is_complete
    integer :: attempt
    system%is_condensed = .false.
    system%is_unheld = .false.
    if (size(state%new%slaves) == 0 .or. .not. system%is_dense_wanted .or. system%reduced%is_iterative) return
    do attempt = 1, 2
      call provide_bulk(system, model, step, state, error)
      if (allocated(error) .or. .not. system%condensed%is_ready) return
      call factorise_contact(system, is_complete, error)
      if (allocated(error)) return
      system%is_unheld = is_complete .and. system%condensed%is_singular
      system%is_condensed = is_complete .and. .not. system%is_unheld
      if (is_complete) return
      system%is_contact = system%is_contact .or. interface_unknowns(system, model, state%new, .false.)
      system%condensed%is_analysed = .false.
      call forget_bulk(system)
    end do
  end subroutine factorise_condensed


  !> The interface for the present contact: by its springs where all contact is compliant and the bodies are held without it.
  subroutine factorise_contact(system, is_complete, error)
    type(system_type), intent(inout) :: system
    logical, intent(out) :: is_complete            !< .false.: contact reaches beyond the interface
    type(error_type), allocatable, intent(out) :: error
    type(springs_type) :: springs
    type(sparse_type) :: by_imbalance, by_displacement
    logical :: is_fit
    if (all(system%links%is_spring) .and. size(system%links) > 0 .and. 3 * size(system%links) < system%condensed%n_contact &
      .and. system%condensed%is_invertible) then
      call spring_factors(system%links, system%whole%n_unknowns, springs, error)
      if (allocated(error)) return
      call factorise_springs(system%condensed, system%base, system%whole, springs, is_complete, is_fit, error)
      if (allocated(error) .or. is_fit .or. .not. is_complete) return
    end if
    call contact_matrices(system%links, system%contact%passing, system%whole%n_unknowns, by_imbalance, by_displacement)
    call factorise_interface(system%condensed, system%base, system%whole, by_imbalance, by_displacement, is_complete, error)
  end subroutine factorise_contact


  !> The factor of the bulk: the one at hand, else that of bulk_u (of a job that was resumed), else a new one.
  subroutine provide_bulk(system, model, step, state, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    type(state_type), intent(inout) :: state       !< not changed
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: u(:, :)
    integer :: failed
    if (system%condensed%is_ready) return
    if (.not. allocated(system%bulk_u)) then
      call renew_bulk(system, error)
      if (system%condensed%is_ready) system%bulk_u = state%new%u
      system%is_bulk_new = .true.
      return
    end if
    system%is_bulk_new = system%is_constant        ! as in the job that ran on
    u = state%new%u
    state%new%u = system%bulk_u
    call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
    call renew_bulk(system, error)
    state%new%u = u
    if (allocated(error)) return
    if (system%condensed%is_ready) system%n_factorisations = system%n_factorisations - 1   ! the job that ran on had it
    call assemble_tangent(system%assembly, model, step%is_nlgeom, state, failed)
  end subroutine provide_bulk


  !> Factorises the bulk with the present stiffness, if the interface is small enough.
  subroutine renew_bulk(system, error)
    type(system_type), intent(inout) :: system
    type(error_type), allocatable, intent(out) :: error
    integer :: status
    system%is_dense_wanted = .false.
    if (system%base%n_free == 0) return            ! all is prescribed
    if (.not. is_analysed_for(system%condensed, system%base)) then
      if (count(system%is_contact) > MOST_INTERFACE) return
      call analyse_bulk(system%condensed, system%assembly%stiffness, system%base, system%is_contact, error)
      if (allocated(error) .or. .not. system%condensed%is_analysed) return
    end if
    if (system%condensed%n_contact == 0) return
    call factorise_bulk(system%condensed, system%assembly%stiffness, system%base, status, error)
    if (allocated(error)) return
    system%n_factorisations = system%n_factorisations + 1
    if (status /= FACTOR_OK) system%n_unstable = system%n_unstable + 1   ! the next iterate may be a better place
    system%is_dense_wanted = system%n_unstable < MOST_UNSTABLE
  end subroutine renew_bulk


  !> A and its factor, with the springs of compliant contact in K: they make it the better preconditioner.
  subroutine factorise_whole(system, model, trouble, error)
    type(system_type), intent(inout) :: system
    type(model_type), intent(in) :: model
    integer, intent(out) :: trouble
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: springs
    integer :: status
    trouble = TROUBLE_NONE
    if (any(system%links%is_spring)) then
      call contact_springs(system%links, system%whole%n_unknowns, springs, error)
      if (allocated(error)) return
      call factorise_reduced(system%reduced, sum_of(system%assembly%stiffness, 1.0_DP, springs), .true., system%whole, &
        model%mesh, status, error)
    else
      call factorise_reduced(system%reduced, system%assembly%stiffness, .false., system%whole, model%mesh, status, error)
    end if
    system%n_factorisations = system%n_factorisations + system%reduced%n_made
    system%n_shifted = system%n_shifted + system%reduced%n_shifted
    if (allocated(error)) return
    if (status /= FACTOR_OK) trouble = TROUBLE_SOLVER
  end subroutine factorise_whole


  !> Solves J dv = C' (R - (K - dF_c) c) and gives du = C dv + c.
  subroutine solve_direction(system, floor, du, trouble, error)
    type(system_type), intent(inout), target :: system
    real(DP), intent(in) :: floor                  !< residual that is small enough [force]
    real(DP), intent(out) :: du(:, :)
    integer, intent(out) :: trouble
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: b(:), v(:), start(:), flat(:)
    trouble = TROUBLE_NONE
    allocate (b(system%whole%n_free), v(system%whole%n_free), start(system%whole%n_unknowns), flat(system%whole%n_unknowns))
    v = 0.0_DP
    flat = system%whole%offset
    call right_hand_side(system, flat, b)
    if (system%whole%n_free > 0) then
      call iterate_direction(system, floor, b, v, trouble, error)
      if (allocated(error)) return
      call multiply(system%whole%map, v, start)
      flat = flat + start
    end if
    du = reshape(flat, shape(du))
  end subroutine solve_direction


  !> J v = b: by conjugate gradients where J is A and that is not factorised, else by GMRES.
  subroutine iterate_direction(system, floor, b, v, trouble, error)
    type(system_type), intent(inout), target :: system
    real(DP), intent(in) :: floor                  !< residual that is small enough [force]
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: trouble
    type(error_type), allocatable, intent(out) :: error
    type(tangent_type) :: tangent
    type(matrix_operator_type) :: matrix
    type(preconditioner_type) :: preconditioner
    type(krylov_options_type) :: options
    type(krylov_report_type) :: report
    logical :: is_iterative
    trouble = TROUBLE_NONE
    is_iterative = system%reduced%is_iterative .and. .not. system%is_condensed
    tangent%system => system
    matrix%matrix => system%reduced%matrix
    preconditioner%system => system
    options%tolerance = KRYLOV_TOLERANCE
    options%floor = floor
    options%max_iterations = merge(system%reduced%most_iterations, KRYLOV_MOST, is_iterative)
    if (is_iterative) options%tolerance = ITERATIVE_TOLERANCE
    system%condensed%allowed = max(options%tolerance, floor / max(norm2(b), tiny(floor)))
    if (is_iterative .and. size(system%links) == 0 .and. .not. allocated(system%assembly%skew%matrix%first)) then
      call conjugate_gradients(matrix, preconditioner, b, v, options, report)
    else
      call gmres(tangent, preconditioner, b, v, options, report, error)
      if (allocated(error)) return
    end if
    system%n_krylov = system%n_krylov + report%n_iterations
    if (system%is_condensed .and. report%n_iterations > MOST_OLD .and. .not. system%is_bulk_new) call forget_bulk(system)
    if (report%status == KRYLOV_CONVERGED) return
    if (report%status == KRYLOV_STAGNATED .and. is_to_rounding(system, report%residual * norm2(b), v)) return
    if (is_iterative .and. report%residual <= KRYLOV_TOLERANCE) return   ! to rounding: a slender body allows no more
    if (is_iterative) trouble = TROUBLE_SOLVER
    if (.not. is_iterative) call solve_whole(system, b, v, trouble, error)
  end subroutine iterate_direction


  !> Whether a direction solves its equations as well as numbers can: what it leaves is rounding of the products of the stiffness
  !! with it, as when bodies that hardly anything holds go far; no factorisation would give a better one (the backward error; N. J.
  !! Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., SIAM 2002, section 7.1).
  pure logical function is_to_rounding(system, residual, v)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: residual               !< norm of what is left [force]
    real(DP), intent(in) :: v(:)                   !< (n_free) [length]
    is_to_rounding = residual <= ROUNDED * maxval(abs(system%assembly%stiffness%value)) * norm2(v)
  end function is_to_rounding


  !> The fall-back when GMRES does not arrive: J as a matrix, factorised by UMFPACK with pivoting.
  subroutine solve_whole(system, b, v, trouble, error)
    type(system_type), intent(inout) :: system
    real(DP), intent(in) :: b(:)                   !< (n_free) [force]
    real(DP), intent(inout) :: v(:)                !< (n_free) [length]
    integer, intent(out) :: trouble
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: J
    type(lu_type) :: lu
    integer :: status
    trouble = TROUBLE_NONE
    call tangent_matrix(system, J, error)
    if (allocated(error)) return
    call lu_factorise(lu, J, status, error)
    if (allocated(error)) return
    system%n_factorisations = system%n_factorisations + 1
    system%n_whole = system%n_whole + 1
    if (status == FACTOR_OK) call lu_solve(lu, b, v)
    if (status /= FACTOR_OK .or. .not. all(abs(v) <= huge(1.0_DP))) trouble = TROUBLE_SOLVER
  end subroutine solve_whole


  !> J = C' (K + D_R E K - D_u) C, with dF_c = D_R dRhat + D_u du and dRhat = -E K du.
  subroutine tangent_matrix(system, J, error)
    type(system_type), intent(in) :: system
    type(sparse_type), intent(out) :: J            !< (n_free x n_free)
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: K, E, by_imbalance, by_displacement
    K = with_skew(full_of(system%assembly%stiffness), system%assembly%skew)
    call condensation(system%base, E, error)
    if (allocated(error)) return
    call contact_matrices(system%links, system%contact%passing, system%whole%n_unknowns, by_imbalance, by_displacement)
    K = sum_of(K, 1.0_DP, product_of(by_imbalance, product_of(E, K)))
    K = sum_of(K, -1.0_DP, by_displacement)
    J = product_of(transpose_of(system%whole%map), product_of(K, system%whole%map))
  end subroutine tangent_matrix


  !> b = C' (R + F_a - K c + dF_c(c)), with F_a what compliant laws, as they are linearised, give more where their nodes are.
  subroutine right_hand_side(system, offset, b)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: offset(:)              !< c [length]
    real(DP), intent(out) :: b(:)
    real(DP), allocatable :: change(:)
    allocate (change(size(offset)))
    change = 0.0_DP
    if (any(offset /= 0.0_DP)) call change_forces(system, offset, change)
    call multiply_transpose(system%whole%map, reshape(system%lawful, shape(change)) - change, b)
  end subroutine right_hand_side


  !> w = (K - dF_c) du over all unknowns: minus the change of the residual.
  subroutine change_forces(system, flat, w)
    type(system_type), intent(in) :: system
    real(DP), intent(in) :: flat(:)                !< du (n_unknowns) [length]
    real(DP), intent(out) :: w(:)                  !< (n_unknowns) [force]
    real(DP), allocatable :: du(:, :), d_imbalance(:, :), d_force(:, :)
    call multiply_symmetric(system%assembly%stiffness, flat, w)
    call subtract_skew(system%assembly%skew, flat, w)
    if (size(system%links) == 0) return
    allocate (d_imbalance(3, size(flat) / 3), d_force(3, size(flat) / 3))
    du = reshape(flat, [3, size(flat) / 3])
    call condense_forces(system%base, reshape(-w, shape(du)), d_imbalance)
    call apply_contact_tangent(system%links, system%contact%passing, du, d_imbalance, d_force)
    w = w - reshape(d_force, shape(w))
  end subroutine change_forces


  !> y = J x.
  subroutine apply_tangent(self, x, y)
    class(tangent_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [length]
    real(DP), intent(out) :: y(:)                  !< (n_free) [force]
    real(DP), allocatable :: flat(:), w(:)
    allocate (flat(self%system%whole%n_unknowns), w(self%system%whole%n_unknowns))
    call multiply(self%system%whole%map, x, flat)
    call change_forces(self%system, flat, w)
    call multiply_transpose(self%system%whole%map, w, y)
  end subroutine apply_tangent


  !> y = inv(A) x.
  subroutine apply_preconditioner(self, x, y)
    class(preconditioner_type), intent(inout) :: self
    real(DP), intent(in) :: x(:)                   !< (n_free) [force]
    real(DP), intent(out) :: y(:)                  !< (n_free) [length]
    if (self%system%is_condensed) then
      call apply_condensed(self%system%condensed, x, y)
    else
      call apply_reduced(self%system%reduced, x, y)
    end if
  end subroutine apply_preconditioner

end module amontons_newton_step
