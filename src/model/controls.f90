!> Controls of the solution: the numbers that steer Newton's method, contact and increments, with meaning, unit, default and reason.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A step has one `controls_type`; procedures get it, or the part for their task, by argument. The card CONTROLS sets the fields of
!! `controls_type` itself and no others. The source of a default stands after a `|`:
!!
!! - a module: its section of doc/theory; a number: the page of doc/developer/decisions. They give the derivation or the counts;
!! - `set`: a choice without a study of its own; all cases of verify/ run with it, and no other value is known to be better.
!!
!! Tolerances of rounding and of geometry are not controls: they stand where they are used.
module amontons_controls
  use amontons_kinds, only: DP
  implicit none
  private
  public :: controls_type, newton_controls_type, globalization_controls_type, subproblem_controls_type, &
    line_search_controls_type, cycling_controls_type, increment_controls_type, krylov_controls_type, interface_controls_type, &
    skin_controls_type, linear_solver_controls_type, contact_controls_type, gradient_controls_type
  public :: PRECONDITIONER_NODAL, PRECONDITIONER_DIAGONAL, PRECONDITIONER_TWO_LEVEL, PRECONDITIONER_FACTOR, PRECONDITIONER_AMG
  public :: calculix_controls

  integer, parameter :: PRECONDITIONER_NODAL = 0   !< of conjugate gradients: the 3 x 3 blocks of the nodes
  integer, parameter :: PRECONDITIONER_DIAGONAL = 1   !< the diagonal
  integer, parameter :: PRECONDITIONER_TWO_LEVEL = 2   !< incomplete factor and rigid motions of parts, of the assembled tangent
  integer, parameter :: PRECONDITIONER_FACTOR = 3   !< Cholesky factor of the assembled tangent
  integer, parameter :: PRECONDITIONER_AMG = 4     !< algebraic multigrid of the assembled tangent (PETSc)

  !> Newton's method within an increment: predictor, scale of forces, limits of displacements, early end.
  type :: newton_controls_type
    real(DP) :: max_predicted_sliding = 0.6_DP   !< facets: a node that the predictor slides farther may change its status [-] | set
    real(DP) :: max_displacement_ratio = 100.0_DP   !< largest displacement of an increment over the size of the model; beyond it
                                           !! a body counts as unsupported [-] | set: no supported body moves so far
    real(DP) :: max_proximal_ratio = 2.0_DP   !< the same where the last step was proximal or snap-through [-] | proximal_step
    real(DP) :: min_force_scale_ratio = 1.0e-3_DP   !< least force scale over the largest force of the job [-] | convergence
    real(DP) :: force_rounding = 1.0e-13_DP   !< rounding level of a residual over the largest force of the attempt [-] |
                                           !! convergence
    real(DP) :: min_forcing_term = 1.0e-6_DP   !< least forcing term; the largest is the tolerance of the subproblem [-] | 0021
    integer :: early_check_iteration = 4   !< first iteration that may end a hopeless attempt | 0022
    real(DP) :: min_lost_residual = 0.1_DP   !< least residual of a hopeless attempt over the largest force [-] | 0022
    real(DP) :: sufficient_decrease = 0.25_DP   !< ratio of residuals over two iterations that counts as convergence [-] | 0022
    real(DP) :: diverged_residual = 0.5_DP   !< over the largest force: the cut-back is that of divergence [-] | 0022
    integer :: max_stable_attempts = 2     !< attempts at an increment with damage; later ones may snap to another equilibrium | set
    integer :: max_snap_iterations = 100   !< iterations of an attempt that may snap | set
    real(DP) :: min_crossing_steepness = 0.25_DP   !< normal part of a path over its length; a flatter path that ends beyond the
                                           !! border slid over the border [-] | tunnelling_check
  end type newton_controls_type

  !> Choice of the step: proximal steps of unsupported bodies, snap-through steps at limit points.
  type :: globalization_controls_type
    integer :: max_unsolved = 2            !< unsolved subproblems in succession before a snap-through step, where a cut-back is
                                           !! possible; else 0 | 0017
    real(DP) :: initial_snap_shift = 1.0e-3_DP   !< first s of snap-through [-] | proximal_step
    real(DP) :: snap_shift_ratio = 6.0_DP   !< ratio of consecutive trial values of s [-] | proximal_step, 0017
    real(DP) :: min_proximal_shift = 1.0e-9_DP   !< least s, tried first [-] | set: far above rounding, far below any support
    real(DP) :: max_proximal_shift = 1.0_DP   !< largest s [-] | proximal_step
    real(DP) :: singular_shift_factor = 1.0e3_DP   !< on s where the factorization fails [-] | set: three trials to the largest
    integer :: max_shift_trials = 6        !< trial values of s in one proximal step | set
    real(DP) :: max_length_excess = 2.0_DP   !< factor by which a direction may exceed its limit before s grows [-] | set
    real(DP) :: max_step_edges = 0.5_DP    !< largest step in edges of the master while a slave node approaches it [-] |
                                           !! proximal_step
    real(DP) :: min_approach_gap = 1.0e-3_DP   !< least distance to first contact, over an edge of the master [-] | set
    real(DP) :: shift_rungs_per_octave = 1024.0_DP   !< of the proximal shift: steps of 7e-4, above the rounding of a flight [-] |
                                           !! proximal_step
  end type globalization_controls_type

  !> Contact subproblem: corrections of a direction, and substeps of the homotopy.
  type :: subproblem_controls_type
    integer :: max_iterations = 30         !< corrections of one direction | contact_subproblem
    real(DP) :: tolerance = 1.0e-2_DP      !< admissible merit at u + du over that at u; on the skin the largest forcing term [-] |
                                           !! contact_subproblem, 0021
    real(DP) :: stagnation_ratio = 0.99_DP   !< merit over that of the previous cycle at which a cycle ends the iteration [-] |
                                           !! contact_subproblem
    real(DP) :: newton_tolerance_share = 1.0e-2_DP   !< admissible merit over Newton's residual tolerance [-] | contact_subproblem
    real(DP) :: rounding = 1.0e-10_DP      !< admissible merit over the largest of the iterations [-] | contact_subproblem
    integer :: max_iterations_per_substep = 12   !< corrections of one substep | 0017
    integer :: max_iterations_all_substeps = 60   !< corrections of all substeps | 0017
    real(DP) :: initial_substep = 1.0_DP / 8.0_DP   !< first substep over the whole direction; a power of two [-] | 0017
    real(DP) :: min_substep = 1.0_DP / 64.0_DP   !< least substep over the whole direction; a power of two [-] | 0017
  end type subproblem_controls_type

  !> Line search. Its bounds s_max and s_min are slots of CONTROLS.
  type :: line_search_controls_type
    integer :: max_halvings = 4            !< of a length that inverts elements, or increases the merit | line_search
    real(DP) :: max_sliding = 1.2_DP       !< facets that a slave node slides at most in an iteration while supports move [-] | set
    real(DP) :: min_length_change = 1.0e-3_DP   !< a length nearer to 1 is not tried [-] | set: it saves an evaluation
    real(DP) :: natural_monotonicity_ratio = 0.75_DP   !< largest next correction over this one at which the merit may grow [-] |
                                           !! line_search (Deuflhard 2004, section 3.3)
    real(DP) :: rejected_merit_growth = 10.0_DP   !< no length is accepted if even the best one makes the merit so many times as
                                           !! large [-] | line_search
    real(DP) :: min_rejected_residual = 1.0e-2_DP   !< and larger than this fraction of the largest force [-] | line_search
  end type line_search_controls_type

  !> Krylov iterations of one direction, and how long a factor serves.
  type :: krylov_controls_type
    real(DP) :: tolerance = 1.0e-9_DP      !< residual of a direction over the right-hand side [-] | krylov
    real(DP) :: newton_tolerance_share = 1.0e-3_DP   !< admissible residual of a direction over Newton's residual tolerance [-] |
                                           !! krylov
    integer :: max_iterations = 200        !< iterations of a direction with a factor | set: a good factor needs fewer than 10
    integer :: max_unsymmetric_iterations = 40   !< iterations with the factor of the symmetric part, under an unsymmetric law; then
                                           !! the whole tangent is factorised | set: such a factor takes some ten solutions
    real(DP) :: iterative_tolerance = 1.0e-11_DP   !< residual without a factor, whose estimate of the error is less reliable [-] |
                                           !! two_level_preconditioner
    integer :: max_stale_iterations = 8    !< iterations after which an old factor of the bulk is discarded | 0004
    integer :: max_indefinite_factors = 3  !< such factors of the bulk after which an attempt continues without the interface | set
    real(DP) :: single_precision_share = 1.0e-3_DP   !< of the allowed residual: single precision has no effect [-] |
                                           !! schur_interface
    real(DP) :: bulk_share = 0.3_DP        !< of the allowed residual: a right-hand side on the bulk below it is zero [-] | set
    real(DP) :: max_reuse_increment = 0.3_DP   !< first increment over a linear step below which its factor counts as reused [-] |
                                           !! reduced_system: a factor pays from four uses on
  end type krylov_controls_type

  !> Contact on the dense interface, and the choice between it and the contact skin.
  type :: interface_controls_type
    integer :: max_unknowns = 6000         !< largest dense interface | 0004, 0021
    real(DP) :: max_gap = 0.5_DP           !< largest gap of an open node on the interface over the edge of its facet [-] | set
    real(DP) :: dense_work_ratio = 1.9e-6_DP   !< seconds of a round on the dense interface over n_c^3, over those on the skin
                                           !! over n, less the bulk's share of the dense round [-] | 0021
    real(DP) :: usual_skin_iterations = 14.0_DP   !< Krylov iterations of a round on the skin in that measurement | 0021
  end type interface_controls_type

  !> Contact by the skin: inexact rounds, its preconditioner, and free rigid motions.
  type :: skin_controls_type
    integer :: max_iterations = 150        !< Krylov iterations of one direction | 0021
    integer :: restart = 50                !< restart length of flexible GMRES: two vectors an iteration | set: memory
    real(DP) :: slow_iterations = 12.0_DP   !< iterations per decimal digit of a slow solve [-] | contact_preconditioner
    real(DP) :: two_level_ratio = 3.0_DP   !< Krylov iterations with a two-level bulk over those with a factor [-] | 0021
    integer :: max_slow_solves = 2         !< slow solves until the bulk is solved anew, doubled each time | contact_preconditioner
    real(DP) :: tolerance_changing = 1.0e-2_DP   !< relative residual of a direction while statuses change [-] | 0021
    real(DP) :: tolerance_halved = 1.0e-3_DP   !< the same where two corrections were halved [-] | 0021
    real(DP) :: tolerance_unchanged = 1.0e-4_DP   !< the same when no status changes [-] | contact_preconditioner
    real(DP) :: tolerance_origin = 1.0e-5_DP   !< the same where the direction sets origins of slip [-] | 0021
    real(DP) :: tolerance_single = 1.0e-7_DP   !< the same where no correction follows (not AUTO) [-] | set: below r_n
    real(DP) :: usual_r_n = 1.0e-6_DP      !< below it these tolerances are smaller in proportion [-] | 0021
    real(DP) :: tolerance_length = 0.1_DP   !< the same where only the length of a correction is used [-] | set
    real(DP) :: max_residual = 0.1_DP      !< a direction with a larger relative residual is rejected [-] | set
    real(DP) :: newton_tolerance_share = 1.0e-4_DP   !< merit over Newton's residual tolerance at which corrections stop [-] |
                                           !! contact_preconditioner
    integer :: slaves_per_tile = 64        !< slave nodes of a tile, at most | 0021
    integer :: max_coarse_patches = 64     !< patches of slave nodes in the coarse space, at most; 0: no coarse space | 0021
    integer :: min_coarse_patches = 32     !< the same, at least | 0021
    integer :: slaves_per_patch = 13       !< slave nodes of a patch, about, between these limits | 0021
    real(DP) :: spring_along = 1.0_DP      !< rho_n: Robin spring along the normal over the node's own stiffness [-] | 0021
    real(DP) :: spring_across = 0.1_DP     !< rho_t: the same across it [-] | 0021
    real(DP) :: max_motion_energy = 1.0e-2_DP   !< largest z'Kz over z'diag(K)z of a weakly restrained rigid motion [-] |
                                           !! contact_preconditioner
    real(DP) :: free_motion_ratio = 1.0e-12_DP   !< |J Z y| / |diag(K) Z y| of a singular tangent: far above rounding, far below the
                                           !! least proximal shift [-] | set
    integer :: max_motions = 240           !< such motions, at most: those of forty bodies | set: a product with J for each
  end type skin_controls_type

  !> Choice of the linear solver: a factor, or iteration where that is too large or takes too much work.
  type :: linear_solver_controls_type
    real(DP) :: max_factor_growth = 1.15_DP   !< growth of the factor at which the nodes are ordered anew [-] | set
    real(DP) :: initial_shift_ratio = 1.0e-4_DP   !< of the preconditioner's diagonal if A is not positive [-] | factorization
    real(DP) :: max_memory_share = 0.7_DP   !< of all memory that a factor may take [-] | reduced_system
    real(DP) :: max_free_memory_share = 0.9_DP   !< of the free memory that a factor may take [-] | reduced_system
    real(DP) :: operations_per_entry = 220.0_DP   !< operations of a factor in the time of an iteration, for each entry of A |
                                           !! reduced_system
    real(DP) :: expected_iterations = 140.0_DP   !< estimated iterations, the preconditioner included | reduced_system
    real(DP) :: operations_per_factor_entry = 20.0_DP   !< operations of a factorization in the time that a solve takes for an entry
                                           !! of the factor; it reads the factor twice [-] | doc/performance.md
    real(DP) :: old_factor_work_ratio = 0.5_DP   !< Krylov iterations with the factor of an earlier iteration may take so much of
                                           !! the work of a new one [-] | newton_step
    integer :: min_old_iterations = 4      !< a factor with fewer of them in that work is not reused | doc/theory/solver.md
    integer :: max_iteration_growth = 3    !< iterations with an earlier preconditioner over those that it took when it was new |
                                           !! newton_step
    real(DP) :: old_factor_tolerance = 1.0e-4_DP   !< largest residual of a direction with it over the right-hand side [-] |
                                           !! newton_step
    real(DP) :: energy_tolerance = 1.0e-4_DP   !< largest residual of an iterated direction of Newton's method, in the norm of the
                                           !! preconditioner, over the right-hand side [-] | doc/theory/solver.md
    real(DP) :: skin_solves = 650.0_DP     !< solutions with the bulk in a job with contact by the skin | 0021
    real(DP) :: skin_work_ratio = 2.0_DP   !< work of the iterations that two levels take for one with a factor, over that of one
                                           !! iteration [-] | 0021
    integer :: min_ranks_shared = 4        !< ranks from which they share a factor by default: on one rank MUMPS takes twice the
                                           !! time of the factor | doc/performance.md
    real(DP) :: max_iteration_work_ratio = 1.5_DP   !< iterations may take so many times the work of the factor [-] | reduced_system
    integer :: max_cg_iterations = 2000    !< where a factor does not fit into memory | set
    real(DP) :: factor_entries_ratio = 60.0_DP   !< entries of a factor over n^(4/3): more than a compact body has [-] |
                                           !! reduced_system
    integer :: min_unknowns_planned = 30000   !< unknowns below which memory and work are not checked | set
    integer :: min_unknowns_newton = 20000   !< the same for directions of Newton's method without contact | set
    real(DP) :: expected_newton_iterations = 25.0_DP   !< estimated iterations of such a direction, likewise | doc/theory/solver.md
    real(DP) :: newton_factors = 0.4_DP    !< factors in place of them | doc/theory/solver.md
    real(DP) :: newton_solves = 5.0_DP     !< solutions with a factor in place of them | doc/theory/solver.md
    integer :: min_unknowns_estimated = 150000   !< unknowns from which the factor is estimated before its analysis | reduced_system
    real(DP) :: separator_entries_ratio = 14.0_DP   !< entries of a factor over the square of its last separator [-] |
                                           !! reduced_system
    real(DP) :: separator_work_ratio = 6.0_DP   !< its operations over the cube [-] | reduced_system
    real(DP) :: estimate_safety_factor = 2.0_DP   !< an estimate must exceed the limit by this factor [-] | reduced_system
  end type linear_solver_controls_type

  !> Contact of a slave node: what keeps decisions from alternating. Search radii and tolerances of geometry are not here.
  type :: contact_controls_type
    real(DP) :: edge_extension = 0.5_DP    !< length of an extended facet beyond its edges, over its length [-] |
                                           !! active_set_cycling
    real(DP) :: min_force_ratio = 1.001_DP   !< a pair presses a shared node more than an earlier one if its force is larger by
                                           !! this factor [-] | set: far above rounding
  end type contact_controls_type

  !> Active-set cycling.
  type :: cycling_controls_type
    real(DP) :: stagnation_ratio = 0.5_DP   !< least ratio of merits over a cycle that counts as stagnation [-] | active_set_history
    integer :: max_master_losses = 3       !< times that a node leaves its master until the edge is extended | active_set_history
    integer :: max_edge_returns = 2        !< returns over an edge with a jump of the normal until the edge is extended | set
    real(DP) :: min_depth_in_facet = 0.1_DP   !< distance from the edge at which a node is well within the facet, over its length
                                           !! [-] | active_set_history
  end type cycling_controls_type

  !> Increments and cut-backs beside the slots of CONTROLS.
  type :: increment_controls_type
    integer :: max_quick_iterations = 4    !< iterations that count as few although statuses changed | 0022
    integer :: min_fast_increments = 2     !< fast increments in succession before the next one is longer | increment_control
    integer :: max_unsupported_attempts = 4   !< attempts, each shorter, with a free body before the job ends | proximal_step
  end type increment_controls_type

  !> Conjugate gradients and the rounds of contact around them. The card SOLVER CONTROLS sets the first four.
  type :: gradient_controls_type
    integer :: preconditioner = PRECONDITIONER_NODAL   !< PRECONDITIONER_...
    real(DP) :: reduction = 0.1_DP         !< residual at the end of a round over that at its start [-] | contact_rounds
    integer :: max_iterations = 20000      !< most iterations of an attempt | set
    integer :: max_rounds = 80             !< most rounds of an attempt | contact_rounds
    real(DP) :: first_reduction = 1.0e-3_DP   !< residual of a first round over the largest force [-] | contact_rounds
    real(DP) :: origin_reduction = 1.0e-5_DP   !< the same where it sets origins of slip [-] | contact_rounds
    real(DP) :: least_share = 0.5_DP       !< least residual of a round over r_l [-] | set: below it the correction is not tested
    integer :: max_portions = 64           !< portions in which a round moves the supports | set
    integer :: max_cuts = 12               !< cuts of a portion or length that inverts elements, repeats of a length | set
    real(DP) :: portion_reduction = 0.1_DP   !< residual after a portion over the largest force [-] | set
    real(DP) :: max_excess = 1.5_DP        !< largest accelerated friction over its limit [-] | set
    integer :: max_flips = 5               !< changes between stick and slip in an attempt; then the status is frozen |
                                           !! contact_rounds
    integer :: max_interpolated = 16       !< iterations in succession whose residual is interpolated | conjugate_gradients
    real(DP) :: interpolation_tolerance = 1.0e-2_DP   !< error of an interpolated residual at which fewer are interpolated [-] |
                                           !! conjugate_gradients
    real(DP) :: max_penetration = 0.1_DP   !< of an open node in a step, over the edge of the master [-] | conjugate_gradients
    real(DP) :: touching = 1.0e-3_DP       !< the same of a body that nothing resists, so that the node closes [-] | set
    real(DP) :: max_length = 10.0_DP       !< largest length of a slave node over that of the trial step [-] | set
    integer :: max_idle = 300              !< iterations in which the norm of the residual does not halve | set
  end type gradient_controls_type

  !> Controls of a step. The fields before the parts are CalculiX's slots (CONTROLS, PARAMETERS=...), with Amontons's defaults.
  type :: controls_type
    ! TIME INCREMENTATION, line 1
    integer :: i_0 = 8                     !< iteration after which the residuals must fall in two consecutive iterations
    integer :: i_r = 12                    !< iteration after which a logarithmic estimate decides to cut back
    integer :: i_p = 9                     !< iteration after which the weaker residual tolerance r_p is used
    integer :: i_c = 24                    !< most iterations of an increment
    integer :: i_l = 12                    !< more iterations than this: the next increment is smaller (d_b)
    integer :: i_g = 6                     !< at most this many iterations twice running: the next increment is larger (d_d)
    integer :: i_a = 8                     !< most cut-backs of an increment
    ! TIME INCREMENTATION, line 2
    real(DP) :: d_f = 0.25_DP              !< cut-back factor: divergence
    real(DP) :: d_c = 0.5_DP               !< cut-back factor: too slow
    real(DP) :: d_b = 0.75_DP              !< factor after slow convergence (i_l)
    real(DP) :: d_a = 0.85_DP              !< cut-back factor: CETOL, times what it allows over what was found
    real(DP) :: d_d = 1.5_DP               !< factor after fast convergence (i_g)
    ! FIELD
    real(DP) :: r_n = 1.0e-6_DP            !< residual over the largest force [-]
    real(DP) :: c_n = 1.0e-6_DP            !< correction over the largest increment of displacement [-]
    real(DP) :: r_p = 1.0e-6_DP            !< residual tolerance after i_p iterations [-]
    real(DP) :: r_l = 1.0e-8_DP            !< residual tolerance below which the correction is not checked [-]
    ! LINE SEARCH
    real(DP) :: s_max = 1.01_DP            !< largest step length of the line search [-]
    real(DP) :: s_min = 0.25_DP            !< smallest step length of the line search [-]
    ! Specific to Amontons: admissible penetration of a closed node over the edge length of its master facet
    real(DP) :: gap_tolerance = 1.0e-9_DP  !< [-]
    ! Parts that no card sets
    type(newton_controls_type) :: newton
    type(globalization_controls_type) :: globalization
    type(subproblem_controls_type) :: subproblem
    type(line_search_controls_type) :: line_search
    type(contact_controls_type) :: contact
    type(cycling_controls_type) :: cycling
    type(increment_controls_type) :: increments
    type(krylov_controls_type) :: krylov
    type(interface_controls_type) :: contact_interface
    type(skin_controls_type) :: skin
    type(linear_solver_controls_type) :: linear_solver
    type(gradient_controls_type) :: gradients   ! SOLVER CONTROLS
  end type controls_type

contains

  !> The defaults of CalculiX, for the calculix dialect. Its I_A, 5, is not taken: it cuts to a quarter where here half is often
  !! enough, so that five cut-backs do not lead as far.
  pure function calculix_controls() result(controls)
    type(controls_type) :: controls
    controls%i_0 = 4
    controls%i_r = 8
    controls%i_p = 9
    controls%i_c = 16
    controls%i_l = 10
    controls%i_g = 4
    controls%r_n = 0.0005_DP                     ! CalculiX: 0.005 of the mean force, which is far below the largest
    controls%c_n = 0.01_DP
    controls%r_p = 0.02_DP
  end function calculix_controls

end module amontons_controls
