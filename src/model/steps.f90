!> Load steps: times, loads, and output requests.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_steps
  use amontons_kinds, only: DP
  use amontons_surfaces, only: interaction_type
  use amontons_controls, only: controls_type
  use amontons_loads, only: amplitude_type, prescribed_type, concentrated_type, distributed_type, temperature_type
  implicit none
  private
  public :: step_type, path_end_type, print_request_type, frd_request_type, is_output_due, next_time_point, TOL_STOP_TIME
  public :: LINE_SEARCH_NONE, LINE_SEARCH_ALL, LINE_SEARCH_GLOBAL, LINE_SEARCH_NODAL, LINE_SEARCH_AUTO
  public :: TANGENT_EXACT, TANGENT_SYMMETRIC, TANGENT_LAGGED
  public :: PRINT_NODE, PRINT_ELEMENT, PRINT_CONTACT, PRINT_SECTION
  public :: SOLVER_AUTO, SOLVER_ITERATIVE, SOLVER_GRADIENTS, SOLVER_GAMG, SOLVER_HYPRE, SOLVER_MUMPS, SOLVER_BDDC
  public :: INTERFACE_AUTO, INTERFACE_DENSE, INTERFACE_SKIN
  public :: N_FRD, FRD_DISP, FRD_FORC, FRD_NDTEMP, FRD_STRESS, FRD_TOSTRAIN, FRD_MESTRAIN, FRD_THSTRAIN, FRD_PE, FRD_ENER, &
    FRD_CONTACT, FRD_CELS, FRD_SDV, FRD_ERROR

  integer, parameter :: LINE_SEARCH_NONE = 0, LINE_SEARCH_ALL = 1, LINE_SEARCH_GLOBAL = 2, LINE_SEARCH_NODAL = 3, &
    LINE_SEARCH_AUTO = 4
  integer, parameter :: TANGENT_EXACT = 0        !< by the consistent tangent at the iterate
  integer, parameter :: TANGENT_SYMMETRIC = 1    !< without the linearised contact forces: C'K C alone
  integer, parameter :: TANGENT_LAGGED = 2       !< K is that of the start of the attempt at the increment
  integer, parameter :: SOLVER_AUTO = 0, SOLVER_ITERATIVE = 1
  integer, parameter :: SOLVER_GRADIENTS = 2       !< nonlinear conjugate gradients: residual evaluations only
  integer, parameter :: SOLVER_GAMG = 3, SOLVER_HYPRE = 4, SOLVER_MUMPS = 5, SOLVER_BDDC = 6   !< distributed over the ranks

  integer, parameter :: INTERFACE_AUTO = 0         !< contact subproblem: the cheaper of DENSE and SKIN
  integer, parameter :: INTERFACE_DENSE = 1        !< on the dense matrix of the interface
  integer, parameter :: INTERFACE_SKIN = 2         !< iteratively, with the contact skin as preconditioner
  integer, parameter :: PRINT_NODE = 1, PRINT_ELEMENT = 2, PRINT_CONTACT = 3, PRINT_SECTION = 4
  ! Fields of the .frd file, in the order of CalculiX.
  integer, parameter :: N_FRD = 13, FRD_DISP = 1, FRD_NDTEMP = 2, FRD_STRESS = 3, FRD_TOSTRAIN = 4, FRD_MESTRAIN = 5, &
    FRD_THSTRAIN = 6, FRD_FORC = 7, FRD_PE = 8, FRD_ENER = 9, FRD_CONTACT = 10, FRD_CELS = 11, FRD_SDV = 12, FRD_ERROR = 13

  real(DP), parameter :: TOL_STOP_TIME = 1.0e-6_DP     !< times within this fraction of the period are the same [-]

  !> One PRINT card.
  type :: print_request_type
    integer :: kind = PRINT_NODE           !< PRINT_...
    integer :: set = 0                     !< index of the node set, element set or surface; contact: the node set; 0: all
    integer :: slave = 0, master = 0       !< contact: indices of the surfaces of the pairs; 0 any
    character(4), allocatable :: variables(:)   !< e.g. 'U', 'RF', 'S', 'E', 'CDIS', 'CSTR', 'SCEN'
    logical :: is_totals = .false.         !< TOTALS=YES: rows and their sum
    logical :: is_only_totals = .false.    !< TOTALS=ONLY
    logical :: is_local = .false.          !< GLOBAL=NO: in the directions of TRANSFORM, or of ORIENTATION
  end type print_request_type

  !> The request of FILE and OUTPUT cards for one field of the .frd file.
  type :: frd_request_type
    logical :: is_wanted = .false.
    logical :: is_local = .false.          !< GLOBAL=NO: in the directions of TRANSFORM, or of ORIENTATION
    integer :: set = 0                     !< NSET: index of the node set; 0: all nodes
  end type frd_request_type

  !> Where a RIKS step ends.
  type :: path_end_type
    real(DP) :: load_factor = huge(1.0_DP)      !< with the increment that reaches it [-]
    integer, allocatable :: nodes(:)            !< that carry the monitored displacement, their mean; not allocated: none
    integer :: dof = 1                          !< of it, 1 to 3
    real(DP) :: displacement = 0                !< with the increment that crosses it [length]
  end type path_end_type

  !> One load step with all its loads and controls.
  type :: step_type
    character(:), allocatable :: title     !< text line after *STEP, may be empty
    integer :: number = 1                  !< its index among the steps
    logical :: is_nlgeom = .false.
    integer :: max_increments = 100        !< INC
    logical :: is_direct = .false.         !< DIRECT: fixed increments
    logical :: is_total_time_set = .false.      !< TIME RESET, TOTAL TIME AT START: the total time starts at clock
    real(DP) :: clock = 0                  !< total time at the start of the step [time]
    real(DP) :: dt_initial = 1             !< [time]
    real(DP) :: period = 1                 !< [time]
    real(DP) :: dt_min = 1.0e-6_DP         !< [time]
    real(DP) :: dt_max = 1                 !< [time]
    real(DP) :: dissipated_fraction = 0        !< STABILIZE: fraction of the strain energy to dissipate; 0: no damping [-]
    real(DP) :: damping_factor = 0         !< STABILIZE, FACTOR: given in place of the fraction; 0: not [force time/length^4]
    logical :: is_damping_continued = .false.   !< STABILIZE, CONTINUE: with the factor of the step before
    logical :: has_free_motion = .false.   !< STABILIZE alone holds a body: it damps from the first increment on
    integer :: line_search = LINE_SEARCH_AUTO   !< LINE_SEARCH_...
    integer :: direction = TANGENT_EXACT !< TANGENT_...
    integer :: solver = SOLVER_AUTO        !< SOLVER_...
    integer :: interface = INTERFACE_AUTO  !< INTERFACE_...
    type(controls_type) :: controls
    type(prescribed_type), allocatable :: prescribed(:)
    type(amplitude_type), allocatable :: amplitudes(:)       !< of its loads, where a user routine or calling program sets them;
                                           !< not allocated: those of the model
    type(concentrated_type), allocatable :: concentrated(:)
    type(distributed_type), allocatable :: distributed(:)
    type(temperature_type), allocatable :: temperatures(:)   !< nodes not in it keep their temperature
    logical :: has_creep = .false.       !< VISCO: materials creep
    real(DP) :: creep_tolerance = 0        !< CETOL: most difference of creep strains of an increment; 0: not given [-]
    logical :: is_long_term = .false.    !< STATIC, LONG TERM: viscoelastic materials are relaxed
    logical :: is_dynamic = .false.        !< DYNAMIC, APPLICATION=QUASI-STATIC: inertia, by backward Euler
    logical :: is_riks = .false.           !< RIKS: the loads follow the equilibrium path; times are lengths of its arc
    type(path_end_type) :: path_end
    logical :: is_perturbation = .false.   !< PERTURBATION: its loads alone, on the undeformed body
    type(print_request_type), allocatable :: prints(:)
    type(interaction_type), allocatable :: interactions(:)  !< those in force; allocated if this or an earlier step changes some
    logical, allocatable :: is_inactive(:)   !< (n_elements) elements removed; not allocated: none
    logical, allocatable :: is_reactivated(:)     !< (n_elements) elements added again in this step, free of strain; not allocated:
                                                  !! none
    logical, allocatable :: is_relieved(:)   !< (n_elements) elements whose stress goes as this step begins; not allocated: none
    integer, allocatable :: material(:)    !< (n_elements) materials from this step on; not allocated: those of the sections
    logical, allocatable :: is_removed(:)  !< (n_pairs) pairs removed; not allocated: none
    real(DP), allocatable :: interference(:)   !< (n_pairs) overclosure allowed, ramped down over the step [length]
    logical, allocatable :: is_shrink_fit(:)   !< (n_pairs) the same for each node's own overclosure at the start of the step
    integer :: restart_frequency = 0       !< RESTART, WRITE: every n-th increment, and the last of the step, is kept; 0: none
    logical :: is_restart_overlay = .false.   !< only the last of them
    integer :: print_frequency = 1         !< every n-th increment, and the last of the step, goes to the .dat file; 0: none
    integer :: file_frequency = 1          !< the same for the result file
    real(DP), allocatable :: print_times(:)   !< TIME POINTS of the prints, ascending, in place of print_frequency [step time]
    real(DP), allocatable :: file_times(:)    !< the same for the result file
    type(frd_request_type) :: frd(N_FRD)   !< the requests of FILE and OUTPUT cards
  end type step_type

contains

  !> Whether an increment is written: every n-th of the step or those of TIME POINTS, and the step's last.
  pure function is_output_due(step, frequency, increment, step_time, times, is_last) result(is_due)
    type(step_type), intent(in) :: step
    integer, intent(in) :: frequency       !< step%print_frequency or step%file_frequency; 0: nothing is written
    integer, intent(in) :: increment       !< number of the increment in the step
    real(DP), intent(in) :: step_time      !< at its end [time]
    real(DP), intent(in), optional :: times(:)   !< step%print_times or step%file_times
    logical, intent(in), optional :: is_last   !< the increment ends its step, whatever its time
    logical :: is_due
    is_due = .false.
    if (present(times)) then
      is_due = any(abs(times - step_time) <= TOL_STOP_TIME * step%period)
    else if (frequency > 0) then
      is_due = mod(increment, frequency) == 0
    else
      return
    end if
    if (step%is_riks) then
      if (present(is_last)) is_due = is_due .or. is_last
    else
      is_due = is_due .or. step_time >= step%period * (1 - 1.0e-9_DP)
    end if
  end function is_output_due


  !> The next time at which an increment has to end: one of TIME POINTS, or the end of the step.
  pure real(DP) function next_time_point(step, step_time) result(stop_time)
    type(step_type), intent(in) :: step
    real(DP), intent(in) :: step_time      !< where the last increment ended [time]
    real(DP) :: passed
    passed = step_time + TOL_STOP_TIME * step%period
    stop_time = step%period
    if (allocated(step%print_times)) stop_time = min(stop_time, minval(step%print_times, mask=step%print_times > passed))
    if (allocated(step%file_times)) stop_time = min(stop_time, minval(step%file_times, mask=step%file_times > passed))
  end function next_time_point

end module amontons_steps
